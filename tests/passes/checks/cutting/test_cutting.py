"""The properties feeds and cutting: mistakes that machinists know, put into good jobs: each is found.

No good job gives one, those of the corpus included.

Expected codes are reasoned out from docs/cutting-sense.md; numbers (feeds along a slope, times of spin-up) by hand.
"""

from __future__ import annotations

import json
import math
import re
import shutil
from collections.abc import Sequence
from pathlib import Path

import pytest
from corpus.expectations import around, expectation, jobs
from support.campaigns import share
from support.command import in_this_process
from support.goldens import ROOT

CORPUS = ROOT / "corpus"
OWN = frozenset(f"GP{n}" for n in range(530, 550)) | {"GP501"}
AXES = "".join(
    f"[axes.{axis}]\nmin = {low}\nmax = {high}\nmax_velocity = {velocity}\nmax_acceleration = 500.0\n"
    for axis, low, high, velocity in (("x", 0, 600, 100), ("y", 0, 400, 100), ("z", -150, 0, 60), ("a", -9e4, 9e4, 180))
)
HEAD = "G21 G17 G90 G94 G40 G49 G54\n"


def codes_of(found: Sequence[dict[str, object]]) -> set[str]:
    return {str(one["code"]) for one in found} & OWN


def judged(
    folder: Path, text: str, *, machine: str = "", setup: str = "", name: str = "job.cnc", dialect: str = "eding"
) -> tuple[dict[str, str], list[dict[str, object]]]:
    """Verdicts by property, and the findings, of a job on a machine that is AXES and ``machine``."""
    (folder / name).write_text(text, encoding="utf-8")
    (folder / "CNC.MAC").write_text("", encoding="utf-8")
    top = machine.split("[", maxsplit=1)[0]
    (folder / "m.toml").write_text(
        f'schema = "gproof-machine/1"\nunits = "mm"\n{top}\n{AXES}{machine[len(top) :]}\n', encoding="utf-8"
    )
    state = 'schema = "gproof-setup/1"\nhomed = ["x", "y", "z", "a"]\nstart = {x = 0.0, y = 0.0, z = 0.0, a = 0.0}\n'
    work = "g92 = {x = 0, y = 0, z = 0, a = 0}\nactive_work = 1\n"
    (folder / "s.toml").write_text(
        f"{state}{work}{setup}\n[work.1]\nx = 100.0\ny = 50.0\nz = -60.0\na = 0.0\n", encoding="utf-8"
    )
    words = ["check", name, "--machine", "m.toml", "--setup", "s.toml", "--also", "feeds", "--also", "cutting"]
    done = in_this_process([*words, "--format", "json", "--dialect", dialect], folder)
    report = json.loads(done.out)
    return {k: v["verdict"] for k, v in report["properties"].items()}, report["findings"]


GOOD = (
    HEAD
    + "T1 M6\nS12000 M3\nM8\nG0 Z20\nG0 X10 Y10\nZ2\nG1 Z-3 F250\nX60 F900\nG3 X60 Y30 I0 J10\nG1 X10\nG0 Z20\n"
    + "M9\nT2 M6\nS9000 M3\nM8\nG0 X30 Y20\nG0 Z2\nG1 Z-3 F200\nG1 Z2 F600\nG0 Z20\nM9\nM5\nM30\n"
)
TOOLS = (
    "[tools.1]\nmax_rpm = 18000\nmin_rpm = 8000\nmax_feed = 20.0\nmax_plunge = 5.0\n"
    "[tools.2]\nmax_rpm = 10000\nmax_plunge = 4.0\n"
)


def test_the_good_job_is_good(tmp_path: Path) -> None:
    for machine in ("", TOOLS, "spindle = true\n[spindles.0]\nmax_rpm = 24000\n"):
        verdicts, found = judged(tmp_path, GOOD, machine=machine)
        assert (verdicts["feeds"], verdicts["cutting"], codes_of(found)) == ("SAFE", "SAFE", set())


MUTANTS: dict[str, tuple[str, str, int, str, str]] = {
    "the first M3 is dropped": ("S12000 M3", "S12000", 1, "GP530", "UNSAFE"),
    "the second M3 is dropped behind a stop": ("M9\nT2", "M9\nM5\nT2", 1, "GP530", "UNSAFE"),
    "M3 behind the first cut": ("G1 Z-3 F250", "G1 Z-3 F250\nM3", 1, "GP530", "UNSAFE"),
    "S is forgotten": ("S12000 M3", "M3", 1, "GP532", "UNKNOWN"),
    "the tool is put away before the cut": ("T2 M6", "T0 M6", 1, "GP533", "UNSAFE"),
    "S of a small cutter for a large one": ("S9000", "S14000", 1, "GP534", "UNSAFE"),
    "S has a digit less": ("S12000", "S1200", 1, "GP535", "SAFE"),
    "M4 for M3": ("S9000 M3", "S9000 M4", 1, "GP537", "SAFE"),
    "the second M8 is forgotten": ("S9000 M3\nM8", "S9000 M3", 1, "GP538", "SAFE"),
    "no retract at the end": ("G1 Z2 F600\nG0 Z20\n", "", 1, "GP539", "SAFE"),
    "M2 for M5 and M30": ("M5\nM30", "M2", 1, "GP540", "SAFE"),
    "the end was cut off": ("M5\nM30\n", "M5\n", 1, "GP541", "SAFE"),
    "F of the contour for the plunge": ("F250\nX60 F900", "F900\nX60", 1, "GP546", "UNSAFE"),
    "a digit too much in F": ("X60 F900", "X60 F9000", 1, "GP545", "UNSAFE"),
}
TOO = {
    "the second M3 is dropped behind a stop": ("S9000 M3", "S9000"),
    "M3 behind the first cut": ("S12000 M3", "S12000"),
}


@pytest.mark.parametrize("name", MUTANTS)
def test_a_mistake_is_found(name: str, tmp_path: Path) -> None:
    old, new, count, code, verdict = MUTANTS[name]
    text = GOOD.replace(old, new, count)
    if name in TOO:
        text = text.replace(*TOO[name])
    assert text != GOOD
    verdicts, found = judged(tmp_path, text, machine=TOOLS)
    assert code in codes_of(found)
    prop = "feeds" if code > "GP543" else "cutting"
    assert verdicts[prop] == verdict


def test_one_finding_a_cause_with_its_number_and_the_last_place(tmp_path: Path) -> None:
    cuts = "".join(f"G1 X{10 + n % 50} F500\n" for n in range(500))
    _, found = judged(tmp_path, HEAD + "G0 Z5\n" + cuts + "G0 Z20\nM5\nM30\n")
    (one,) = [f for f in found if f["code"] == "GP530"]
    assert one["line"] == 3
    assert str(one["message"]).endswith("feed moves while the spindle is stopped (moves: 500)")
    assert [r["line"] for r in one["related"]] == [502]  # type: ignore[attr-defined]


@pytest.mark.parametrize(
    ("text", "machine", "code", "verdict"),
    [
        ("G0 Z5\nG1 X50 F500\nG0 Z20\nM30\n", "", "GP531", "UNKNOWN"),
        ("G0 Z5\nG1 X50 F500\nG0 Z20\nM30\n", "spindle = true\n", "GP530", "UNSAFE"),
        ("G0 Z5\nG1 X50 F500\nG0 Z20\nM30\n", "spindle = false\n", "", "SAFE"),
        # A code of the language starts a spindle whatever the machine file says of outputs.
        ("S9000 M3\nG0 Z5\nG1 X50 F500\nG0 Z20\nM30\n", "[spindles.0]\noutput = 4\n", "", "SAFE"),
        # A laser on a pulse width output: the job itself shows what it works with.
        ("M54 E1 Q500\nG1 X50 F500\nM54 E1 Q0\nG0 X0\nM30\n", "", "", "SAFE"),
        # ... and a job that stops a spindle has one.
        ("M54 E1 Q500\nG1 X50 F500\nM54 E1 Q0\nG0 X0\nM5\nM30\n", "", "GP530", "UNSAFE"),
        # A retract at feed behind M5, a probe, and a tap, which goes back with the spindle reversed.
        ("S9000 M3\nG0 Z5\nG1 Z-2 F200\nM5\nG1 Z20 F800\nM30\n", "", "", "SAFE"),
        ("G0 Z5\nG38.2 Z-2 F50\nS9000 M3\nG0 Z5\nG1 X9 F300\nG0 Z20\nM5\nM30\n", "", "", "SAFE"),
        ("S300 M3\nG0 Z5\nG95\nG84 X10 Y10 Z-8 R2 F1\nG80\nG94\nG0 Z20\nM30\n", "", "", "SAFE"),
    ],
)  # fmt: skip
def test_what_proves_that_there_is_a_spindle(text: str, machine: str, code: str, verdict: str, tmp_path: Path) -> None:
    verdicts, found = judged(tmp_path, HEAD + text, machine=machine)
    assert codes_of(found) == ({code} if code else set())
    assert verdicts["cutting"] == verdict


def test_moves_of_a_rack_are_no_cuts(tmp_path: Path) -> None:
    """The way into a holder at feed with the spindle off: the guard of the tool change area tells it from a cut."""
    rack = "tcaguard off\nG0 X300 Y100\nG1 Z-50 F400\nG1 Y150\nG0 Z20\ntcaguard on\n"
    text = HEAD + rack + "M6 T1\nS9000 M3\nG0 Z5\nG1 X50 F500\nG0 Z20\nM30\n"
    assert codes_of(judged(tmp_path, text)[1]) == set()
    # A guard that nobody switches on again is no tool change.
    assert codes_of(judged(tmp_path, text.replace("tcaguard on\n", ""))[1]) == {"GP530"}
    without = text.replace("tcaguard off\n", "").replace("tcaguard on\n", "")
    assert codes_of(judged(tmp_path, without)[1]) == {"GP530"}


@pytest.mark.parametrize(
    ("between", "seconds", "found"),
    [
        ("G4 P3\n", 3.0, True),
        ("G4 P4\n", 4.0, False),
        # 300 mm at 100 mm/s at the most, and 40 mm of Z at 60 mm/s at the same time: 3 s; a dwell of 1 s behind it.
        ("G0 X300 Z-20\nG4 P1\n", 4.0, False),
        ("G0 X200 Z-20\nG4 P1\n", 3.0, True),
        # Whoever changes something by hand takes long enough.
        ("M0\n", math.inf, False),
    ],
)
def test_time_for_the_spindle(between: str, seconds: float, found: bool, tmp_path: Path) -> None:
    text = HEAD + f"G0 X0 Y0 Z20\nS9000 M3\n{between}G1 Z-30 F300\nG0 Z20\nM30\n"
    _, told = judged(tmp_path, text, machine="[spindles.0]\nspin_up = 4.0\n")
    assert codes_of(told) == ({"GP536"} if found else set())
    if found:
        message = next(str(one["message"]) for one in told if one["code"] == "GP536")
        assert f"a feed move starts as early as {seconds:.2f} s after" in message
    # The wait of the controller itself counts, as far as the machine file says that there is one.
    waits = "[spindles.0]\nspin_up = 4.0\n[controller]\nspindle_ramp_time = 4.0\n"
    assert codes_of(judged(tmp_path, text, machine=waits)[1]) == set()


@pytest.mark.parametrize(
    ("move", "feed", "plunge"),
    [
        ("G1 Z-4", 300.0, 300.0),
        # 3 down and 4 across: 3/5 of the feed goes down.
        ("G1 X4 Z-3", 600.0, 360.0),
        # A turn of radius 5 and 2 down: 2 / sqrt((10 pi)^2 + 4) of the feed.
        ("G2 X0 Y0 I5 J0 Z-2", 900.0, 900.0 * 2 / math.sqrt((10 * math.pi) ** 2 + 4)),
        # A quarter of a circle in the XZ plane from the top outwards ends straight down.
        ("G18 G2 X5 Z-5 I0 K-5", 250.0, 250.0),
        # ... and one that begins at 30 degrees from the top and goes to the top only rises.
        ("G93 G1 Z-3 F100", 300.0, 300.0),
    ],
)
def test_how_fast_it_goes_down(move: str, feed: float, plunge: float, tmp_path: Path) -> None:
    word = "" if "F" in move else f" F{feed}"
    text = HEAD + f"T1 M6 S9000 M3\nG0 X0 Y0 Z0\n{move}{word}\nG94 G17\nG0 Z20\nM30\n"
    for limit, found in ((plunge * (1 + 1e-6), False), (plunge * (1 - 1e-6), True)):
        _, told = judged(tmp_path, text, machine=f"[tools.1]\nmax_plunge = {limit / 60.0!r}\n")
        assert codes_of(told) == ({"GP546"} if found else set()), limit


def test_feed_a_revolution_is_judged_as_it_is_made(tmp_path: Path) -> None:
    """0.1 mm a revolution at 9000 rpm is 900 mm a minute."""
    text = HEAD + "T1 M6 S9000 M3\nG0 Z0\nG95\nG1 X50 F0.1\nG94\nG0 Z20\nM30\n"
    for limit, found in ((901.0, set[str]()), (899.0, {"GP545"})):
        assert codes_of(judged(tmp_path, text, machine=f"[tools.1]\nmax_feed = {limit / 60!r}\n")[1]) == found


def test_a_tool_that_nobody_stated(tmp_path: Path) -> None:
    text = HEAD + "S9000 M3\nG0 Z5\nG1 X50 F500\nG0 Z20\nM30\n"
    verdicts, found = judged(tmp_path, text, machine=TOOLS)
    assert (verdicts["feeds"], verdicts["cutting"]) == ("UNKNOWN", "UNKNOWN")
    assert codes_of(found) == {"GP542", "GP548"}
    verdicts, found = judged(tmp_path, text, machine=TOOLS, setup="tool = 1\n")
    assert (verdicts["feeds"], verdicts["cutting"], codes_of(found)) == ("SAFE", "SAFE", set())


def test_a_spindle_on_an_output(tmp_path: Path) -> None:
    """WinCNC: the machine file names the output; S is the speed; what is not named is unknown."""
    text = "G0 X100 Y100 Z-10\nS9000\nM11C1\nG1 Z-20 F300\nX150 F900\nG0 Z-5\nM12C1\n"
    named = "[spindles.0]\noutput = 1\nmax_rpm = 24000\n"
    for job, machine, code, verdict in (
        (text, named, "", "SAFE"),
        (text, "", "GP531", "UNKNOWN"),
        (text.replace("M11C1\n", ""), named, "GP530", "UNSAFE"),
        (text.replace("M11C1", "M11C2"), named, "GP530", "UNSAFE"),
        (text.replace("S9000\n", ""), named, "GP532", "UNKNOWN"),
        (text.replace("M12C1\n", ""), named, "GP540", "SAFE"),
        (text.replace("M11C1\nG1 Z-20 F300\n", "G1 Z-20 F300\nM11C1\n"), named, "GP530", "UNSAFE"),
    ):
        verdicts, found = judged(tmp_path, job, machine=machine, name="job.tap", dialect="wincnc")
        assert codes_of(found) == ({code} if code else set()), job
        assert verdicts["cutting"] == verdict


def test_task_0_runs_the_spindle(tmp_path: Path) -> None:
    """McuWIN: M3 is what the machine file says that Task 0 does for it."""
    text = "%P\nN10 G90 F300\nN20 S9000\nN30 M03\nN40 G00 Z-10\nN50 G01 Z-20\nN60 G00 Z-5\nN70 M05\nN80 M30\n%\n"
    tasks = '[din]\ntime_unit = "min"\nposition_unit = "mm"\ncase_sensitive = false\n[din.task0]\n'
    names = {"M3": "spindle_cw", "M5": "spindle_off", "M30": "end", "S": "spindle_speed"}
    machine = tasks + "".join(f'{code} = "{does}"\n' for code, does in names.items())
    for job, code in ((text, ""), (text.replace("N30 M03\n", ""), "GP530"), (text.replace("N20 S9000\n", ""), "GP532")):
        _, found = judged(tmp_path, job, machine=machine, name="job.src", dialect="mcuwin")
        assert codes_of(found) & {"GP530", "GP531", "GP532"} == ({code} if code else set())


# ---- the corpus: what is told of good jobs was looked at by hand, and is right

ALLOWED = {
    # Tool 6 of the rack cuts wood without the coolant that the others have.
    "rack-change": {"GP538"},
}


def corpus_report(folder: Path, text: str | None = None, scratch: Path | None = None) -> dict[str, object]:
    job = folder / "job.cnc"
    options = around(job)
    if text is not None:
        assert scratch is not None
        job = scratch / "job.cnc"
        job.write_text(text, encoding="utf-8")
    words = ["check", str(job), *options, "--also", "feeds", "--also", "cutting", "--format", "json"]
    report: dict[str, object] = json.loads(in_this_process(words, folder).out)
    return report


SAFE = [job.parent for job in jobs("eding") if expectation(job)["verdict"] == "SAFE"]


@pytest.mark.parametrize("folder", share(SAFE, 3), ids=lambda folder: folder.name)
def test_good_jobs_of_the_corpus(folder: Path) -> None:
    report = corpus_report(folder)
    found: list[dict[str, object]] = report["findings"]  # type: ignore[assignment]
    assert codes_of(found) == ALLOWED.get(folder.name, set())
    verdicts: dict[str, dict[str, str]] = report["properties"]  # type: ignore[assignment]
    assert {verdicts[name]["verdict"] for name in ("feeds", "cutting")} == {"SAFE"}


_STARTS = re.compile(r"\bm0?[34]\b", re.I)
TURNED_ON = [
    folder
    for folder in SAFE
    if _STARTS.search((folder / "job.cnc").read_text(encoding="utf-8", errors="replace"))
    # G33 and its kin refuse to run with the spindle at rest; what is cut there begins with the laser's own subprogram.
    and folder.name not in {"tapped-flange", "threading-g76", "back-bored", "turning-diameter", "user-m-codes"}
]


@pytest.mark.parametrize("folder", TURNED_ON, ids=lambda folder: folder.name)
def test_the_corpus_without_its_spindle_starts(folder: Path, tmp_path: Path) -> None:
    """Every M3 and M4 of a good job left out: the first cut is found."""
    text = _STARTS.sub("", (folder / "job.cnc").read_text(encoding="utf-8"))
    for extra in folder.iterdir():
        if extra.name != "job.cnc" and extra.is_file():
            (tmp_path / extra.name).write_bytes(extra.read_bytes())
    report = corpus_report(folder, text, tmp_path)
    found: list[dict[str, object]] = report["findings"]  # type: ignore[assignment]
    assert codes_of(found) & {"GP530", "GP531"}


# ---- workshops of the other controllers, told how their spindles run

ROUTER = CORPUS / "wincnc" / "router-atc"
ENGRAVER = CORPUS / "mcuwin" / "engraver"
RUNS = 'schema = "gproof-machine/1"\nunits = "inch"\nbase = "WINCNC.INI"\n'
RIGHT = {
    # Feeds that the arcs of these jobs do not allow.
    "cabinet-door": {"GP501"}, "tray": {"GP501"}, "turned-plates": {"GP501"},
}  # fmt: skip


def shop_jobs(shop: Path, starts: str) -> list[Path]:
    """Good jobs of a workshop that start a spindle."""
    return [
        job
        for job in jobs(shop.parent.name)
        if job.parents[1] == shop
        and expectation(job)["verdict"] == "SAFE"
        and re.search(starts, job.read_text(encoding="latin-1"), re.M)
    ]


def in_the_shop(shop: Path, job: str, machine: str, setup: str) -> tuple[str, set[str]]:
    words = ["check", f"jobs/{job}", "--machine", machine, "--setup", setup, "--format", "json"]
    report = json.loads(in_this_process([*words, "--also", "feeds", "--also", "cutting"], shop).out)
    return report["properties"]["cutting"]["verdict"], codes_of(report["findings"])


@pytest.fixture(scope="module")
def router(tmp_path_factory: pytest.TempPathFactory) -> Path:
    shop = tmp_path_factory.mktemp("shop") / "router"
    shutil.copytree(ROUTER, shop)
    (shop / "m.toml").write_text(RUNS + "[controls]\narcs_share_feed = true\n", encoding="utf-8")
    return shop


ROUTED = [job for job in shop_jobs(ROUTER, r"^M3\b") if job.stem != "relief"]  # 5000 lines show no more


@pytest.mark.parametrize("job", share(ROUTED, 3), ids=lambda job: job.stem)
def test_the_router(job: Path, router: Path) -> None:
    """As it is, and without the M3 of its jobs; the rack, the tool setter and the park position are no cuts."""
    text = job.read_text(encoding="latin-1")
    setup = Path(expectation(job)["setup"]).name
    assert in_the_shop(router, job.name, "m.toml", setup) == ("SAFE", RIGHT.get(job.stem, set()))
    (router / "jobs" / "mutant.tap").write_text(re.sub(r"(?m)^M3\b.*$", "", text), encoding="latin-1")
    verdict, found = in_the_shop(router, "mutant.tap", "m.toml", setup)
    assert verdict == "UNSAFE"
    assert "GP530" in found


@pytest.mark.parametrize("job", shop_jobs(ENGRAVER, r"\bM03\b"), ids=lambda job: job.stem)
def test_the_engraver(job: Path, tmp_path: Path) -> None:
    shutil.copytree(ENGRAVER, tmp_path / "engraver")
    shop = tmp_path / "engraver"
    assert in_the_shop(shop, job.name, "machine.toml", "setup.toml") == ("SAFE", set())
    text = job.read_text(encoding="latin-1")
    (shop / "jobs" / job.name).write_text(re.sub(r"\bM03\b", "", text), encoding="latin-1")
    assert in_the_shop(shop, job.name, "machine.toml", "setup.toml")[1] & {"GP530", "GP531"}


def test_a_whole_job_behind_a_code_is_judged(tmp_path: Path) -> None:
    """What replaces a code is a job of its own where it changes no tool, or starts a spindle."""
    part = "G1 X50 F500\nM5\n"
    for body, code in ((part, "GP530"), ("M6 T1\n" + part, ""), ("M6 T1\nM3 S900\nG0 Z5\nM5\n" + part, "GP530")):
        text = f"sub m110\n{body}endsub\n" + HEAD + "M110\nS9000 M3\nG0 Z20\nM30\n"
        _, found = judged(tmp_path, text)
        assert codes_of(found) & {"GP530"} == ({code} if code else set()), text


def test_a_move_that_a_switch_ends_is_no_cut(tmp_path: Path) -> None:
    """WinCNC: the tool goes down at feed onto the measuring switch, and does not turn."""
    named = "[spindles.0]\noutput = 1\n"
    job = "G0 X100 Y100 Z-10\n{touch}\nG0 Z-5\nS9000\nM11C1\nG1 Z-20 F300\nG0 Z-5\nM12C1\n"
    for touch, found in (("M28 G1 Z-40 F60", set[str]()), ("G1 Z-40 F60", {"GP530"})):
        text = job.format(touch=touch)
        _, told = judged(tmp_path, text, machine=named, name="job.tap", dialect="wincnc")
        assert codes_of(told) == found, text


# ---- WinCNC: which output runs the spindle, CNC.MAC says

CUT = "G0 X100 Y100 Z-10\n{on}\nG1 X120 F300\n{then}G1 X140\nG0 Z0\nM5\n"


def by_macros(folder: Path, job: str, definitions: str, machine: str = "") -> tuple[str, set[str], list[str]]:
    """Verdict, codes and assumptions of a job in a shop with these definitions."""
    (folder / "CNC.MAC").write_text(definitions, encoding="ascii")
    ini = "unit=MM\ntimertype=7200\naxischar=XYZ\n" + "".join(
        f"axisspec=p0 s{n} d{n} r80 a30000 t{n + 1}\naxisvel=r6000 f2000\n" for n in range(3)
    )
    ini += "".join(f"auxout=c{n} p7 b{n} o0\n" for n in (1, 2, 4, 7))
    (folder / "WINCNC.INI").write_text(f"{ini}softlim=T1\nnmode=90\n{machine}", encoding="ascii")
    (folder / "TWO.MAC").write_text("M11C1\nM11C7\n", encoding="ascii")
    (folder / "OFF.MAC").write_text("M12C1\nM12C7\n", encoding="ascii")
    (folder / "job.tap").write_text(f"G90\n{job}", encoding="ascii")
    words = ["check", "job.tap", "--machine", "WINCNC.INI", "--also", "cutting", "--format", "json"]
    report = json.loads(in_this_process(words, folder).out)
    answer = report["properties"]["cutting"]
    return answer["verdict"], codes_of(report["findings"]), [a for a in answer["assumptions"] if "spindle" in a]


ONE, BOTH = "M3=M11C1\nM5=M12C1\n", "M3=M98 TWO.MAC\nM5=M98 OFF.MAC\n"
SPEED = "spindle=T1 R18000\n"
RUNS_IT = "output 1 runs the spindle: the shop's own start code switches it on, and its stop off"


@pytest.mark.parametrize(
    ("on", "then", "definitions", "verdict", "found"),
    [
        ("S9000\nM3", "", ONE, "SAFE", set()),
        ("S9000\nM11C1", "", ONE, "SAFE", set()),
        ("S9000\nM3", "M5\n", ONE, "UNSAFE", {"GP530"}),
        ("S9000\nM3", "M14C1\n", ONE, "UNSAFE", {"GP530"}),
        ("S9000\nM11C2", "", ONE, "UNSAFE", {"GP530"}),
        ("M3", "", ONE, "UNKNOWN", {"GP532"}),
        # Two that are switched together: one of them alone may be the dust collector, or the spindle.
        ("S9000\nM3", "", BOTH, "SAFE", set()),
        ("S9000\nM3", "M12C7\n", BOTH, "UNKNOWN", {"GP531"}),
        ("S9000\nM3", "M12C1\n", BOTH, "UNKNOWN", {"GP531"}),
        ("S9000\nM3", "M12C1\nM12C7\n", BOTH, "UNSAFE", {"GP530"}),
        # The other direction by another output.
        ("S9000\nM4", "", ONE.replace("C1\nM5=M12C1", "C2\nM4=M11C1\nM5=M98 OFF.MAC"), "SAFE", {"GP537"}),
        # Nothing tells.
        ("S9000\nM11C1", "", "M5=M12C1\n", "UNKNOWN", {"GP531"}),
    ],
)
def test_the_shop_s_own_codes(
    on: str, then: str, definitions: str, verdict: str, found: set[str], tmp_path: Path
) -> None:  # fmt: skip
    answer = by_macros(tmp_path, CUT.format(on=on, then=then), definitions, SPEED)
    assert answer[:2] == (verdict, found)
    assert definitions is not ONE or answer[2] == [RUNS_IT]


def test_a_speed_that_is_set_by_hand(tmp_path: Path) -> None:
    """Without spindle= no S sets the speed (manual, spindle=), and whoever turns the knob is trusted, said so."""
    for speed in ("", "S9000\n"):
        answer = by_macros(tmp_path, CUT.format(on=f"{speed}M3", then=""), ONE)
        assert answer == ("SAFE", set(), [RUNS_IT, "the spindle speed is set by hand"])


def test_a_hint_names_the_outputs(tmp_path: Path) -> None:
    by_macros(tmp_path, CUT.format(on="M11C4\nM13C2", then=""), "M5=M12C1\n")
    shown = in_this_process(["check", "job.tap", "--machine", "WINCNC.INI", "--also", "cutting"], tmp_path).out
    hint = (
        "state output = ... under [spindles.0] in the machine file, the output that runs the spindle (this job "
        "switches on 2, 4)"
    )
    assert hint in shown


TWO_TOOLS = (
    "S9000\nL110 T1\nM3\n{wet}\nG0 X100 Y100 Z-10\nG1 X120 F300\nG0 Z0\n{dry}\n"
    "L110 T2\n{then}G0 X100\nG1 X120 F300\nG0 Z0\nM5\n"
)
CHANGER = SPEED + "atc1=H-10 O0 Z0 A2 M1\n"


@pytest.mark.parametrize(
    ("wet", "dry", "then", "definitions", "found"),
    [
        ("M8", "M9", "", "M8=M11C4\nM9=M12C4\n", {"GP538"}),
        ("M8", "M9", "M8\n", "M8=M11C4\nM9=M12C4\n", set()),
        ("M11C4", "M12C4", "", "M7=M11C4\nM9=M12C4\n", {"GP538"}),
        # It stays on.
        ("M8", "", "", "M8=M11C4\nM9=M12C4\n", set()),
        # One of two is coolant too.
        ("M7", "M9", "M8\n", "M7=M11C2\nM8=M11C4\nM9=M98 DRY.MAC\n", set()),
        # Nothing tells what output 4 is: no M9 switches it off.
        ("M8", "M12C4", "", "M8=M11C4\n", set()),
    ],
)
def test_the_shop_s_own_coolant(
    wet: str, dry: str, then: str, definitions: str, found: set[str], tmp_path: Path
) -> None:  # fmt: skip
    (tmp_path / "DRY.MAC").write_text("M12C2\nM12C4\n", encoding="ascii")
    job = TWO_TOOLS.format(wet=wet, dry=dry, then=then)
    assert by_macros(tmp_path, job, ONE + definitions, CHANGER)[1] == found


def test_coolant_that_the_machine_file_names(tmp_path: Path) -> None:
    job = TWO_TOOLS.format(wet="M11C4", dry="M12C4", then="")
    assert by_macros(tmp_path, job, ONE, CHANGER)[1] == set()
    (tmp_path / "m.toml").write_text(
        'schema = "gproof-machine/1"\nunits = "mm"\nbase = "WINCNC.INI"\n[controls]\ncoolant = [4]\n', encoding="ascii"
    )
    words = ["check", "job.tap", "--machine", "m.toml", "--also", "cutting", "--format", "json"]
    assert codes_of(json.loads(in_this_process(words, tmp_path).out)["findings"]) == {"GP538"}
