"""Every ordered pair of WinCNC commands that change what numbers mean, then a move: where it ends, or UNKNOWN.

Expected places come from `wincnc_states`, a model of the guide that shares nothing with gproof. Where the model has a
place gproof has the same one, and the same answer about limits; where the guide is open gproof is not SAFE, or has no
place of the axis. The reason is a row of docs/dialects/wincnc.md. The whole table runs in `make soak`.
"""

from __future__ import annotations

import json
import random
import re
from pathlib import Path

import pytest
from second_reading import wincnc_states as states
from second_reading.wincnc_states import Model, Open
from support.campaigns import sizes
from support.command import in_this_process

CODES = (
    "G20", "G21", "G22", "G23", "G90", "G91", "G92", "G92 X Y", "G92 Z10", "G92 W-5", "G92.1 X4 Y6", "G92.1 Z-5",
    "G92.2 X1 Z2", "G92.3", "G92.4 A1 B2 C3 D4", "G50", "G51 X2 Y2 I3 J4", "G51 Z2 K5", "G51 X2 Y2 Z2 C3", "G51 X-1",
    "G51 W0.5", "G52 I3 J4 A90", "G52 I0 J0 A30", "G52.1 A3 B4", "G53", "G53 X10 Y5", "G53 Z-7", "P5", "G54", "G55",
    "G56", "G57", "G58", "M37 Z3", "M37 W2", "G43", "G43 Z", "G49", "G49 Z", "L110 T2", "L101 T1 R2", "L11 YXZW",
    "L11 XYWZ", "L11 XYZZ", "L11", "L12 WZ", "L12 ZZ", "L12", "L13 XY", "L13 ZW", "L13 WX", "L13", "L20", "L20 X1",
    "L20 X2", "L21", "L22 X8", "L22 Z-4", "L22", "L22.1 X", "L23 Y4", "L23", "L23.1 XY", "G28", "G28 X", "G28 Z",
    "L3 XY\nG0 X1 Y1\nL4 XY", "L3 Z\nG0 X1 Z-9\nL4 Z", "L53", "L92", "L28 X2 Y3", "L28 Z-4", "L300 X",
    "L300 Z", "L301 X", "L301 ZY",
    "G81 X1 Y2 Z-5 R-2", "G0 X-3 Y-2", "M98 local.tap", "M98 kept.tap", "M98 turned.tap",
    "L10 R1 C2 X30 E1\nG92 XY",
)  # fmt: skip
PROBES = ("G0 X7 Z-3", "G0 Y5 W-2", "G0 X7 Y5 Z-3 W-2", "G91\nG0 X3 Y-4 Z-1 W-2", "G0 X7 Y5\nG0 X6")
INI = (
    "unit=mm\ntimertype=7200\naxischar=XYZW\n"
    + "".join(
        f"axisspec=p0s{n}d{n}r100a400t{kind}\naxisvel=r6000f1500s50m200h450\n" for n, kind in enumerate((1, 2, 3, 3))
    )
    + "vgroup=FXY\nvgroup=XY\nvgroup=Z\nvgroup=W\nsoftlim=t1\nlolim=X-200Y-200Z-150W-150\nhilim=X200Y200Z0W0\n"
    "lobound=X-190Y-190\nhibound=X190Y190\nnmode=90\ng54=x0y0t0m0\ng55=x20y10t0m0\ng56=x20y-10t0m1\ng57=x15y5t0\n"
    "g58=x0y0t3r30\natc1=H0 O0 Z0 A2 M0\npositions=p20h20t10\n"
)
PAGE = Path(__file__).parents[2] / "docs/dialects/wincnc.md"
MACHINE = 'schema = "gproof-machine/1"\nunits = "mm"\nbase = "WINCNC.INI"\n[controls]\nshift_sign = 1\n'


def _row(place: object) -> str:
    assert isinstance(place, dict)
    return "".join(f"{axis.lower()} = {value}\n" for axis, value in place.items())


SETUP = (
    'schema = "gproof-setup/1"\nunits = "mm"\nhomed = ["x", "y", "z", "w"]\nactive_work = 1\ntool = 0\n'
    f"[start]\n{_row(states.START)}[g92]\nx = 0.0\ny = 0.0\nz = 0.0\nw = 0.0\n[measures]\nz = 0.0\nw = 0.0\n"
    + "".join(f"[positions.P{n}]\nlift = false\n{_row(place)}" for n, place in states.POSITIONS.items())
    + "".join(f"[tools.{n}]\nlength = {length}\n" for n, length in states.MEASURES.items())
)


@pytest.fixture
def shop(tmp_path: Path) -> Path:
    files = {"WINCNC.INI": INI, "CNC.MAC": "", "machine.toml": MACHINE, "setup.toml": SETUP, **states.FILES}
    for name, text in files.items():
        (tmp_path / name).write_text(text, "utf-8")
    return tmp_path


def expected(program: str) -> tuple[str, dict[str, float | None], str]:
    """SAFE or UNSAFE with places by axis, or UNKNOWN and why."""
    model = Model()
    try:
        model.run(program)
    except Open as why:
        return "UNKNOWN", {}, str(why)
    verdict = "UNSAFE" if model.over else "UNKNOWN" if model.unheld else "SAFE"
    return verdict, model.at, "; ".join([*model.over, *model.unheld])


def answered(shop: Path, program: str) -> tuple[str, dict[str, float | None], str]:
    """gproof's: verdict of language and limits, places at the end, findings."""
    (shop / "job.tap").write_text(program + "\n", "utf-8")
    words = ["check", "job.tap", "--machine", "machine.toml", "--setup", "setup.toml", "--format", "json"]
    report = json.loads(in_this_process(words, shop).out)
    verdicts = [report["properties"][name]["verdict"] for name in ("language", "limits")]
    verdict = next((v for v in ("UNSAFE", "UNKNOWN") if v in verdicts), "SAFE")
    conditions = report["properties"]["limits"]["conditions"]
    told = "; ".join(f"{f['line']}: {f['code']} {f['message']}" for f in report["findings"])
    end = {axis: report["summary"]["end"].get(axis.lower()) for axis in states.AXES}
    return verdict, end, f"{told} {conditions or ''}"


def difference(shop: Path, program: str) -> str:
    """How gproof's answer differs from the model's; empty where it does not."""
    verdict, places, why = expected(program)
    found, end, told = answered(shop, program)
    if verdict == "UNKNOWN" and not places:
        return f"SAFE, though open: {why}" if found == "SAFE" else ""
    wrong = []
    for axis, place in places.items():
        here = end[axis]
        if place is None:
            wrong += [f"{axis} at {here}, though open"] if here is not None else []
        elif here is None:
            wrong += [f"{axis} lost, is {place:g}"]
        elif abs(here - place) > 1e-6:
            wrong += [f"{axis} at {here:g}, is {place:g}"]
    if found != verdict and None not in places.values():
        wrong.append(f"{found}, is {verdict} ({why})")
    return ", ".join(wrong) + (f" [{told}]" if wrong else "")


OPEN_ROWS = re.findall(r'Open\("([^"]+)"\)', Path(states.__file__).read_text("utf-8"))


@pytest.mark.parametrize("first", CODES)
@pytest.mark.parametrize("count", sizes(2, len(CODES) * len(PROBES)))
def test_after_two_commands_every_axis_is_where_the_guide_says(first: str, count: int, shop: Path) -> None:
    programs = [f"{first}\n{second}\n{probe}" for second in CODES for probe in PROBES]
    chosen = random.Random(first).sample(programs, count)
    wrong = {program: found for program in chosen if (found := difference(shop, program))}
    assert not wrong, "\n\n".join(f"{program}\n=> {found}" for program, found in wrong.items())


@pytest.mark.parametrize("count", sizes(50, 6000))
@pytest.mark.parametrize("length", [3, 4])
def test_after_more_commands(length: int, count: int, shop: Path) -> None:
    rng = random.Random(f"rows of {length}")
    rows = ["\n".join([*(rng.choice(CODES) for _ in range(length)), rng.choice(PROBES)]) for _ in range(count)]
    wrong = {program: found for program in rows if (found := difference(shop, program))}
    assert not wrong, "\n\n".join(f"{program}\n=> {found}" for program, found in wrong.items())


def test_what_is_open_has_a_row() -> None:
    page = PAGE.read_text("utf-8")
    missing = [row for row in OPEN_ROWS if f"| {row}" not in page]
    assert OPEN_ROWS and not missing


BEFORE = {
    # A low boundary of Z counts once M37 is used (Soft Limit / Boundaries): a warning before.
    "L22 Z-4\nG0 Z-6": "SAFE",
    "L22 Z-4\nG92.1 Z-1\nG0 Z-6": "SAFE",
    "L22 X8\nG0 X7": "UNSAFE",
    "L23 Z-9\nG0 Z-6": "UNSAFE",
    "L22 Z-4\nM37 Z0\nG0 Z-3": "SAFE",
    "L22 Z-4\nM37 Z0\nG0 Z-6": "UNSAFE",
    "L22 Z-4\nM37 W0\nG0 Z-26": "UNSAFE",
    "M37 Z0\nL22 Z-4\nG0 Z-6": "UNSAFE",
    "L22 Z-4\nL110 T2\nG0 Z-6": "UNSAFE",
    "L22 Z-4\nG43\nG0 Z-6": "UNSAFE",
    "L22 Z-4\nG0 Z-6\nM37 Z0\nG0 Z1": "SAFE",
}


@pytest.mark.parametrize("program", BEFORE)
def test_low_boundaries_of_heads_count_once_m37_is_used(program: str, shop: Path) -> None:
    (shop / "setup.toml").write_text(SETUP.replace("[measures]\nz = 0.0\nw = 0.0\n", ""), "utf-8")
    verdict, _, told = answered(shop, program)
    assert verdict == BEFORE[program], told
    assert ("GP332" in told) == ("Z-6" in program and verdict == "SAFE"), told


def test_without_a_low_limit_a_boundary_that_does_not_count_holds_nothing(shop: Path) -> None:
    (shop / "WINCNC.INI").write_text(INI.replace("lolim=X-200Y-200Z-150W-150", "lolim=X-200Y-200"), "utf-8")
    (shop / "setup.toml").write_text(SETUP.replace("[measures]\nz = 0.0\nw = 0.0\n", ""), "utf-8")
    assert answered(shop, "L22 Z-40 W-40\nG0 Z-6")[0] == "SAFE"
    verdict, _, told = answered(shop, "L22 Z-4 W-40\nG0 Z-6")
    assert (verdict, "GP302" in told, "GP332" in told) == ("UNKNOWN", True, True), told


MOVED_ZERO = {
    # X stands at 10 and is called 0: what counts from machine zero moves by 10, the machine's ends (200) do not.
    "L28 X0\nG0 X185": ("SAFE", 195.0),
    "L28 X0\nG0 X195": ("UNSAFE", 205.0),
    "L28 X0\nL21\nG0 X-205": ("SAFE", -195.0),
    "L28 X0\nL20 X2\nG0 X-205": ("UNSAFE", -195.0),
    "L28 X0\nG0 X-195": ("UNSAFE", -185.0),
    "L28 X20\nG0 X195": ("UNSAFE", 185.0),
    "L28 X0\nG53 X5": ("SAFE", 15.0),
    "L28 X0\nP5": ("SAFE", 18.0),
    "L28 X0\nL500 X P7 L0\nG0 X9\nP7": ("SAFE", 10.0),
    "L500 X P7 L0\nL28 X0\nG0 X9\nP7": ("SAFE", 20.0),
    "L28 X0\nG92 X5\nG0 X6": ("SAFE", 11.0),
    "L28 X0\nG92.1 X5\nG0 X6": ("SAFE", 21.0),
    "L28 X0\nG20\nG0 X1": ("SAFE", 35.4),
    "G20\nL28 X1\nG0 X2": ("SAFE", 35.4),
    "L28 X0\nL28 X3\nG0 X6": ("SAFE", 13.0),
    "L28 X0\nG28 X\nG0 X6": ("SAFE", 6.0),
    "L28 X10\nG0 X6": ("SAFE", 6.0),
    "L91 G1 X-2 F20 M28 G31\nL28 X0\nL91 G1 X5\nL28 X0\nG0 X7": ("SAFE", 7.0),
    "L3 X\nL28 X0\nL4 X": ("UNKNOWN", None),
    "L28 X0\nL3 X\nG0 X5\nL4 X": ("SAFE", 10.0),
    "L28 X0\nG51 X2 Y2 I0 J0\nG0 X6 Y1": ("SAFE", 22.0),
    "L28 X0\nG52 I0 J20 A90\nG0 X6 Y20": ("SAFE", 10.0),
    "L28 X0\nL10 R1 C2 X30 E1\nG92XY\nG0 X1": ("SAFE", 41.0),
}


@pytest.mark.parametrize("program", MOVED_ZERO)
def test_what_counts_from_machine_zero_moves_with_it(program: str, shop: Path) -> None:
    verdict, place = MOVED_ZERO[program]
    found, end, told = answered(shop, program)
    assert (found, end["X"]) == (verdict, place if place is None else pytest.approx(place)), told


def test_a_zone_stays_where_it_is(shop: Path) -> None:
    zone = '[[keep_out]]\nname = "post"\nx = [100, 110]\ny = [-300, 300]\n'
    (shop / "setup.toml").write_text(SETUP + zone, "utf-8")
    for x, verdict in (("85", "SAFE"), ("91", "UNSAFE")):
        (shop / "job.tap").write_text(f"L28 X0\nG0 X{x}\n", "utf-8")
        words = ["check", "job.tap", "--machine", "machine.toml", "--setup", "setup.toml", "--format", "json"]
        report = json.loads(in_this_process(words, shop).out)
        assert report["properties"]["areas"]["verdict"] == verdict, report["findings"]


def test_an_unknown_start_is_a_condition(shop: Path) -> None:
    """Where X stands at L28 nobody states: 0 is there, and 50 is as far from it."""
    (shop / "setup.toml").write_text(SETUP.replace("x = 10.0\n", "", 1), "utf-8")
    verdict, _, told = answered(shop, "L28 X0\nG0 X50")
    assert verdict == "SAFE", told
    assert "start.x" in told and "150" in told, told
