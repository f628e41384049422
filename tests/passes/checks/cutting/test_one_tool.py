"""What a job, a setup or a table says of the tool reaches every property that looks at its width or its tip.

Expected results are those of the manuals by hand: Eding 3.1.1 (#5401, #5501), 3.4.12 (G43, G49); WinCNC M37, L500.2.
"""

from __future__ import annotations

from pathlib import Path

import pytest
from support.judging import UNBOUNDED, answer

from gproof.driver.judge import judge
from gproof.driver.session import Running, open_session
from gproof.ir.verdict import Verdict

SAFE, UNSAFE, UNKNOWN = Verdict.SAFE, Verdict.UNSAFE, Verdict.UNKNOWN
MACHINE = """schema = "gproof-machine/1"
units = "mm"
[axes.x]
min = -500.0
max = 500.0
[axes.y]
min = -500.0
max = 500.0
[axes.z]
min = -300.0
max = 300.0
[tools.1]
length = 70.0
diameter = 6.0
shape = "flat"
flute_length = 60.0
stickout = 60.0
holder = [[30, 30, 200]]
[tools.2]
length = 30.0
diameter = 20.0
shape = "flat"
flute_length = 60.0
stickout = 60.0
holder = [[30, 30, 200]]
"""
SETUP = """schema = "gproof-setup/1"
homed = ["x", "y", "z"]
active_work = 1
tool = 1
block_delete = false
optional_stop = false
start = {x = 0.0, y = 0.0, z = 200.0}
g92 = {x = 0.0, y = 0.0, z = 0.0}
[work.1]
x = 0.0
y = 0.0
z = 0.0
"""
BOX = (40.0, -10.0, -60.0, 60.0, 10.0, 0.0)


def bodies(work: str = "1") -> str:
    """The same box as a zone, a fixture, and the part."""
    low, high = list(BOX[:3]), list(BOX[3:])
    sides = "".join(f"{axis} = [{a}, {b}]\n" for axis, a, b in zip("xyz", low, high, strict=True))
    zone = f'[[keep_out]]\nname = "zone"\n{sides}'
    zone += "" if work == '"machine"' else f"work = {work}\n"
    tables = ("[[fixtures]]", "[[part]]")
    return zone + "".join(f"{table}\nbox = [{low}, {high}]\nwork = {work}\n" for table in tables)


def verdicts(
    tmp_path: Path, program: str, *, setup: str = SETUP + bodies(), machine: str = MACHINE, dialect: str = "eding",
    properties: tuple[str, ...] = ("areas", "collisions", "gouges"),
) -> dict[str, Verdict]:  # fmt: skip
    suffix = {"eding": "cnc", "wincnc": "tap", "mcuwin": "src"}[dialect]
    job = tmp_path / f"job.{suffix}"
    job.write_text(program)
    (tmp_path / "CNC.MAC").write_text("")
    (tmp_path / "machine.toml").write_text(machine)
    (tmp_path / "setup.toml").write_text(setup)
    session = open_session(job, machine=tmp_path / "machine.toml", setup=str(tmp_path / "setup.toml"), dialect=dialect)
    judgement = judge(session, running=Running(UNBOUNDED), properties=("language", *properties))
    found = {name: answer(judgement, name).verdict for name in properties}
    print(found, *(f"{f.span.line}: {f.code.label} {f.message}" for f in judgement.findings.kept), sep="\n")
    return found


def all_are(found: dict[str, Verdict], verdict: Verdict) -> bool:
    return set(found.values()) == {verdict}


HEAD = "G21 G90 G17 G94 G40 G49 G54 F600\n"


@pytest.mark.parametrize(
    ("written", "verdict"),
    [("", SAFE), ("#5501 = 16\n", UNSAFE), ("#5501 = -16\n", UNSAFE), ("#5501 = 5\n", SAFE), ("#5502 = 16\n", SAFE),
     ("#5501 = #4999\n", UNKNOWN), ("#100 = 16\n#5501 = [#100]\n", UNSAFE)],
)  # fmt: skip
def test_a_diameter_that_the_program_writes_is_the_tools(tmp_path: Path, written: str, verdict: Verdict) -> None:
    """Past the box at 5 mm from its side: tool 1 of 6 mm is clear, one of 16 mm goes 3 mm into it."""
    program = f"{HEAD}G0 Z150\nG0 X0 Y15\nG43 H1\n{written}G1 Z-20\nG1 X100\nG0 Z100\nM30\n"
    assert all_are(verdicts(tmp_path, program), verdict)


def test_it_is_the_tools_from_there_on(tmp_path: Path) -> None:
    program = f"{HEAD}G0 Z150\nG0 X0 Y15\nG43 H1\nG1 Z-20\nG1 X100\nG0 Z100\nG0 X0\n#5501 = 16\nM30\n"
    assert all_are(verdicts(tmp_path, program), SAFE)


@pytest.mark.parametrize(("stated", "verdict"), [("16.0", UNSAFE), ("[5.0, 16.0]", UNKNOWN), ("6.0", SAFE)])
def test_a_diameter_that_the_setup_states_is_the_tools(tmp_path: Path, stated: str, verdict: Verdict) -> None:
    program = f"{HEAD}G0 Z150\nG0 X0 Y15\nG43 H1\nG1 Z-20\nG1 X100\nG0 Z100\nM30\n"
    setup = SETUP + f"[parameters]\n5501 = {stated}\n" + bodies()
    assert all_are(verdicts(tmp_path, program, setup=setup), verdict)


def test_a_written_diameter_of_another_tool_counts_once_it_is_there(tmp_path: Path) -> None:
    program = f"{HEAD}#5502 = 16\nG0 Z150\nM6 T2\nG43\nG0 X0 Y19\nG1 Z-20\nG1 X100\nG0 Z100\nM30\n"
    assert all_are(verdicts(tmp_path, program), SAFE)
    assert all_are(verdicts(tmp_path, program.replace("#5502 = 16\n", "")), UNSAFE)


@pytest.mark.parametrize("work", ["1", '"machine"'])
@pytest.mark.parametrize(
    ("program", "verdict"),
    [
        # Without G43 the tip of tool 1 is 70 below the programmed Z: at -20 for Z50, and clear at Z75.
        ("G0 Z150\nG0 X0 Y0\nG1 Z50\nG1 X50\nG0 Z150\nG43 H1\nM30\n", UNSAFE),
        ("G0 Z150\nG0 X0 Y0\nG1 Z75\nG1 X50\nG0 Z150\nG43 H1\nM30\n", SAFE),
        ("G0 Z150\nG0 X0 Y0\nG1 Z50\nG1 X50\nG0 Z150\nM30\nsub never\nG43 H1\nendsub\n", SAFE),
        ("G0 Z150\nG0 X0 Y0\nG1 Z50\nG1 X50\nG0 Z150\ngosub on\nM30\nsub on\nG43 H1\nendsub\n", UNSAFE),
        ("G43 H1\nG0 Z150\nG0 X0 Y0\nG1 Z5\nG1 X50\nG0 Z150\nM30\n", SAFE),
        ("G43 H1\nG0 Z150\nG0 X0 Y0\nG1 Z-5\nG1 X50\nG0 Z150\nM30\n", UNSAFE),
        ("G43 H1\nG49\nG0 Z150\nG0 X0 Y0\nG1 Z50\nG1 X50\nG0 Z150\nM30\n", UNSAFE),
        ("G43.1 K60\nG0 Z150\nG0 X0 Y0\nG1 Z5\nG1 X50\nG0 Z150\nM30\n", SAFE),
        ("G43.1 K60\nG0 Z150\nG0 X0 Y0\nG1 Z-5\nG1 X50\nG0 Z150\nM30\n", UNSAFE),
    ],
)
def test_the_length_of_a_tool_is_there_without_g43_too(
    tmp_path: Path, program: str, verdict: Verdict, work: str
) -> None:
    assert all_are(verdicts(tmp_path, HEAD + program, setup=SETUP + bodies(work)), verdict)


def test_a_tool_that_the_table_lacks_may_be_anything(tmp_path: Path) -> None:
    """In zones and beside bodies alike: clear above them alone."""
    setup = (SETUP + bodies()).replace("tool = 1", "tool = 7")
    beside = f"{HEAD}G0 Z150\nG0 X0 Y15\nG1 Z-20\nG1 X100\nG0 Z100\nM30\n"
    assert all_are(verdicts(tmp_path, beside, setup=setup), UNKNOWN)
    above = f"{HEAD}G0 Z150\nG0 X0 Y15\nG1 Z0.5\nG1 X100\nG0 Z100\nM30\n"
    assert all_are(verdicts(tmp_path, above, setup=setup), SAFE)
    bare = MACHINE.replace('diameter = 6.0\nshape = "flat"\n', "")
    assert all_are(verdicts(tmp_path, beside, machine=bare), UNKNOWN)


@pytest.mark.parametrize(("line", "verdict"), [("", SAFE), ("L500.2 T1 N16 A16", UNSAFE), ("L500.2 T1 A5", SAFE),
                                               ("L500.2 T1 N16", UNSAFE), ("L500.2 T2 A16", SAFE)])  # fmt: skip
def test_a_diameter_of_the_tool_library(tmp_path: Path, line: str, verdict: Verdict) -> None:
    """WinCNC L500.2: A is the actual diameter of a tool, N the nominal one."""
    machine = MACHINE + '[controller]\ndialect = "wincnc"\nstraight_traverse = true\n'
    setup = SETUP.split("[work.1]", maxsplit=1)[0] + "measures = {z = 0.0}\n" + bodies()
    program = f"G90\n{line}\nG0 Z150\nG0 X0 Y15\nG1 Z-20 F600\nG1 X100\nG0 Z100\n"
    assert all_are(verdicts(tmp_path, program, setup=setup, machine=machine, dialect="wincnc"), verdict)


def test_stock_sees_the_diameter_too(tmp_path: Path) -> None:
    """A slot of 6 mm lets the same tool go back on its line, one of 16 mm runs into its walls."""
    setup = SETUP + "[[stock]]\nbox = [[20, -30, -60], [80, 30, 0]]\nwork = 1\n"
    program = f"{HEAD}G43 H1\nG0 Z50\nG0 X0 Y0\nG1 Z-5\nG1 X100\n{{}}G0 X0\nG0 Z100\nM30\n"
    for written, verdict in (("", SAFE), ("#5501 = 16\n", UNSAFE)):
        found = verdicts(tmp_path, program.format(written), setup=setup, properties=("collisions",))
        assert all_are(found, verdict), written


@pytest.mark.parametrize("body", ["zone", "fixture", "stock"])
@pytest.mark.parametrize(
    ("start", "verdict"),
    [
        ("x = [0.0, 100.0], y = 0.0, z = 3.0", SAFE),
        ("x = [0.0, 100.0], y = 0.0, z = -10.0", UNKNOWN),
        ("x = [0.0, 30.0], y = 0.0, z = -10.0", SAFE),
        ("x = 0.0, y = [0.0, 1.0], z = [-20.0, 0.0]", SAFE),
        ("x = 0.0, y = [0.0, 50.0], z = [-20.0, 0.0]", SAFE),
    ],
)
def test_the_first_move_comes_from_anywhere_in_the_stated_range(
    tmp_path: Path, start: str, verdict: Verdict, body: str
) -> None:
    """From there to X0 Y20: a move that may pass the box, or that is clear of it wherever it begins."""
    everything = bodies()
    one = {
        "zone": everything.split("[[fixtures]]", maxsplit=1)[0],
        "fixture": "[[fixtures]]" + everything.split("[[fixtures]]")[1].split("[[part]]")[0],
        "stock": "[[stock]]" + everything.split("[[part]]")[1],
    }[body]
    setup = SETUP.replace("x = 0.0, y = 0.0, z = 200.0", start) + one
    program = f"{HEAD}G0 X0 Y20\nG0 Z100\nM30\n"
    name = "areas" if body == "zone" else "collisions"
    assert all_are(verdicts(tmp_path, program, setup=setup, properties=(name,)), verdict)


@pytest.mark.parametrize("dialect", ["eding", "wincnc", "mcuwin"])
@pytest.mark.parametrize(("axes", "verdict"), [("x", UNKNOWN), ("y", SAFE), ("z", SAFE), ("x y z", UNKNOWN)])
def test_homing_goes_anywhere_along_its_axes(tmp_path: Path, axes: str, verdict: Verdict, dialect: str) -> None:
    """From X0 Y0 at a height where the box is: along X it may pass the box, along Y and Z it can not."""
    program = {
        "eding": f"{HEAD}home {axes.split(maxsplit=1)[0]}\nM30\n" if " " not in axes else f"{HEAD}homeall\nM30\n",
        "wincnc": f"G90\nG28 {axes.upper()}\n",
        "mcuwin": f"%P\nG90 G53\nG74 {axes.upper()}\nM30\n%\n",
    }[dialect]
    more = {"eding": "", "wincnc": '[controller]\ndialect = "wincnc"\n', "mcuwin": '[controller]\ndialect = "mcuwin"\n'}
    if dialect == "mcuwin":
        more["mcuwin"] += (
            '[din]\ncase_sensitive = false\ninterpolation_axes = "XYZ"\n[din.task0]\nG74 = "home"\nM30 = "end"\n'
        )
    setup = SETUP.replace("z = 200.0", "z = -20.0")
    if dialect != "eding":
        setup = setup.split("[work.1]", maxsplit=1)[0]
    if dialect == "wincnc":
        setup += "measures = {z = 0.0}\n"
    box = bodies() if dialect == "eding" else bodies('"machine"')
    found = verdicts(tmp_path, program, setup=setup + box, machine=MACHINE + more[dialect], dialect=dialect)
    assert all_are(found, verdict)


@pytest.mark.parametrize(
    ("lines", "longer"),
    [
        ("", 0.0),
        ("G49", 0.0),
        ("M37 Z0", 0.0),
        ("L101 T2", 40.0),
        ("L101 T2\nL101 T1", 0.0),
        ("M37 Z0\nL101 T2", -90.0),
    ],
)
@pytest.mark.parametrize("below", [False, True])
def test_machine_heights_where_measures_are_places(tmp_path: Path, lines: str, longer: float, below: bool) -> None:
    """WinCNC: machine heights are those of the tip of tool 1, measured or not; tool 2 is longer by what its measure is
    higher (-110 and -150, or -20 where M37 measures tool 1 at 20 less 0)."""
    machine = MACHINE + '[controller]\ndialect = "wincnc"\nstraight_traverse = true\n'
    setup = SETUP.split("[work.1]", maxsplit=1)[0].replace("z = 200.0", "z = -20.0").replace("x = 0.0, y", "x = 0.0, y")
    setup += "[measures]\nz = -150.0\n[tools.1]\nlength = -150.0\n[tools.2]\nlength = -110.0\n" + bodies('"machine"')
    z = (-1.0 if below else 1.0) + longer
    program = f"G90\n{lines}\nG53 Z250\nG53 X50 Y0\nG53 Z{z}\nG53 Z250\n"
    found = verdicts(tmp_path, program, setup=setup, machine=machine, dialect="wincnc")
    assert all_are(found, UNSAFE if below else SAFE)
