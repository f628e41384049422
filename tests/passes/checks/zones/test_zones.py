"""Keep-out zones in whole jobs: what is judged, what is added to the path, and what rests on unknown offsets."""

from __future__ import annotations

import random
from pathlib import Path

import pytest
from support.judging import answer

from gproof.driver.judge import Judgement, judge
from gproof.driver.session import Running, open_session
from gproof.ir.verdict import Verdict

MACHINE = """schema = "gproof-machine/1"
units = "mm"
[axes.x]
min = -500.0
max = 500.0
[axes.y]
min = -500.0
max = 500.0
[axes.z]
min = -200.0
max = 100.0
[tools.1]
length = 30.0
diameter = 6.0
[tools.2]
length = 0.0
diameter = 1e-9
[controller]
dialect = "eding"
"""
CLAMP = """
[[keep_out]]
name = "clamp"
x = [40.0, 60.0]
y = [-10.0, 10.0]
z = [-inf, -50.0]
"""
SETUP = """schema = "gproof-setup/1"
homed = ["x", "y", "z"]
active_work = 1
tool = {tool}
start = {{x = 0.0, y = 0.0, z = 0.0}}
g92 = {{x = 0.0, y = 0.0, z = 0.0}}
[work.1]
x = {x}
y = {y}
z = {z}
"""


def run(
    tmp_path: Path, program: str, machine: str = MACHINE + CLAMP, setup: str | None = None, dialect: str = "eding"
) -> Judgement:
    suffix = {"eding": "cnc", "wincnc": "tap", "mcuwin": "src"}[dialect]
    job = tmp_path / f"job.{suffix}"
    job.write_text(program)
    (tmp_path / "machine.toml").write_text(machine)
    (tmp_path / "CNC.MAC").write_text("")
    (tmp_path / "setup.toml").write_text(setup or "")
    session = open_session(
        job, machine=tmp_path / "machine.toml", setup=str(tmp_path / "setup.toml") if setup else None, dialect=dialect
    )
    return judge(session, running=Running(10**9))


def found(judgement: Judgement) -> list[tuple[str, int]]:
    return [(f.code.label, f.span.line) for f in judgement.findings.kept if f.code.decides == "areas"]


def stated(x: float = 0.0, y: float = 0.0, z: float = 0.0, tool: int = 2) -> str:
    return SETUP.format(x=x, y=y, z=z, tool=tool)


HEAD = "G21 G90 G17 G94 G40 G49 G54 F600\n"


def test_a_point_touches_a_face_and_enters_behind_it(tmp_path: Path) -> None:
    for y, expected in (("10", []), ("9.999999", [("GP336", 4)]), ("-10", []), ("0", [("GP336", 4)])):
        program = f"{HEAD}G1 Z-60\nY{y}\nX100\nY300\nM30\n".replace("G1 Z-60\nY", "G1 X0 Z-60\nY")
        judgement = run(tmp_path, program, setup=stated())
        assert found(judgement) == expected, y
        assert (answer(judgement, "areas").verdict is Verdict.SAFE) == (not expected)
    above = run(tmp_path, f"{HEAD}G1 Z-50\nX100\nM30\n", setup=stated())
    assert found(above) == []
    message = next(
        f.message
        for f in run(tmp_path, f"{HEAD}G1 Z-60\nX100\nM30\n", setup=stated()).findings.kept
        if f.code.number == 336
    )
    assert message.startswith('the path enters the keep-out zone "clamp" by 10.000 mm at X40.000 Y0.000 Z-60.000')


def test_a_tool_with_a_diameter_needs_room_for_its_radius(tmp_path: Path) -> None:
    """Tool 1 has a radius of 3; without a length offset in use Z is that of the machine."""
    for y, expected in (("13", []), ("12.999999", [("GP336", 4)])):
        program = f"{HEAD}G1 Y{y}\nZ-60\nX100\nM30\n"
        assert found(run(tmp_path, program, setup=stated(tool=1))) == expected, y
        assert found(run(tmp_path, program, setup=stated(tool=2))) == []


def test_a_tool_that_nobody_states_may_be_the_widest(tmp_path: Path) -> None:
    setup = stated().replace("tool = 2\n", "")
    for y, expected in (("13", []), ("12", [("GP337", 4)]), ("9", [("GP336", 4)])):
        assert found(run(tmp_path, f"{HEAD}G1 Y{y}\nZ-60\nX100\nM30\n", setup=setup)) == expected, y


def test_a_tool_reaches_down_to_its_tip(tmp_path: Path) -> None:
    """With G43 the tip of tool 1 is 30 below the machine position: at machine Z-20 it touches -50."""
    for z, expected in (("-50", []), ("-50.001", [("GP336", 4)])):
        assert found(run(tmp_path, f"{HEAD}G43 H1\nG1 Z{z}\nX100\nM30\n", setup=stated(tool=1))) == expected, z
    # The same zone from the work zero: the tip itself.
    machine = MACHINE + CLAMP.replace("z =", "work = 1\nz =")
    for z, expected in (("-50", []), ("-50.001", [("GP336", 4)])):
        setup = stated(x=7.0, y=-3.0, z=55.0, tool=1)
        assert found(run(tmp_path, f"{HEAD}G43 H1\nG1 Z{z}\nX100\nM30\n", machine, setup)) == expected, z


def test_a_zone_from_an_unknown_work_zero_moves_with_the_job(tmp_path: Path) -> None:
    """Where the zero is cancels out: the answer needs no offset at all, but for where the job comes from."""
    setup = 'schema = "gproof-setup/1"\nactive_work = 1\ntool = 2\ng92 = {x = 0.0, y = 0.0, z = 0.0}\n'
    clamp = CLAMP.replace("z =", "work = 1\nz =")
    program = f"{HEAD}G53 G0 Z100\nG0 X0 Y0\nG1 Z-60\nY{{y}}\nX100\nM30\n"
    near = run(tmp_path, program.format(y=9), MACHINE, setup + clamp)
    assert ("GP336", 6) in found(near)
    beside = run(tmp_path, program.format(y=10), MACHINE, setup + clamp)
    assert ("GP336", 6) not in found(beside)


def test_unknown_offsets_get_a_condition_or_no_answer(tmp_path: Path) -> None:
    beside = run(
        tmp_path,
        f"{HEAD}G53 G0 Z0\nG0 X0 Y0\nG1 Z-10\nX30\nM30\n",
        setup='schema = "gproof-setup/1"\ntool = 2\nactive_work = 1\n',
    )
    assert answer(beside, "areas").verdict is Verdict.SAFE
    assert any(c.terms[-1][0] in ("work.1.x", "work.1.y", "work.1.z") for c in answer(beside, "areas").conditions)
    column = MACHINE + CLAMP.replace("z = [-inf, -50.0]\n", "")
    around = f"{HEAD}G53 G0 Z0\nG0 X-400 Y-400\nG1 Y400\nX400\nY-400\nM30\n"
    open_ = run(tmp_path, around, column, 'schema = "gproof-setup/1"\ntool = 2\nactive_work = 1\n')
    assert answer(open_, "areas").verdict is Verdict.UNKNOWN
    assert [label for label, _ in found(open_)] == ["GP337"]


def test_offsets_within_the_conditions_keep_out_and_others_need_not(tmp_path: Path) -> None:
    """Random jobs with unknown offsets: for each work zero the conditions allow, the same job stated is SAFE."""
    conditional = 0
    for seed in range(25):
        rng = random.Random(seed)
        moves = "".join(
            f"G1 X{rng.uniform(-60, 60):.3f} Y{rng.uniform(-60, 60):.3f} Z{rng.uniform(-9, 9):.3f}\n" for _ in range(5)
        )
        program = f"{HEAD}G53 G0 Z100\n{moves}M30\n"
        ring = [[round(rng.uniform(-80, 80), 2) for _ in range(2)] for _ in range(3)]
        zone = (
            f'\n[[keep_out]]\nname = "part"\npolygon = {ring}\nz = [{rng.uniform(-90, 0)!r}, {rng.uniform(1, 60)!r}]\n'
        )
        unknown = 'schema = "gproof-setup/1"\nactive_work = 1\ntool = 1\n'
        unknown += "g92 = {x = 0.0, y = 0.0, z = 0.0}\nstart = {x = 0.0, y = 0.0, z = 100.0}\n"
        judgement = run(tmp_path, program, MACHINE + zone, unknown)
        areas = answer(judgement, "areas")
        if judgement.verdict is not Verdict.SAFE or not areas.conditions:
            continue
        conditional += 1
        both = {c.terms: (c.low, c.high) for c in answer(judgement, "limits").conditions}
        for c in areas.conditions:
            low, high = both.get(c.terms, (c.low, c.high))
            both[c.terms] = max(low, c.low), min(high, c.high)
        for _ in range(3):
            at = {terms[0][0][-1]: rng.uniform(*ends) for terms, ends in both.items()}
            again = run(tmp_path, program, MACHINE + zone, stated(**at, tool=1).replace("z = 0.0}", "z = 100.0}", 1))
            assert answer(again, "areas").verdict is Verdict.SAFE, (seed, at, found(again))
    assert conditional >= 5


def test_backlash_is_what_may_be(tmp_path: Path) -> None:
    machine = MACHINE.replace("[axes.y]\n", "[axes.y]\nbacklash = 0.05\n") + CLAMP
    for y, expected in (("10.05", []), ("10.01", [("GP337", 4)]), ("9.99", [("GP336", 4)])):
        judgement = run(tmp_path, f"{HEAD}G1 Y{y}\nZ-60\nX100\nM30\n", machine, stated())
        assert found(judgement) == expected, y


def test_rounded_corners_are_what_may_be(tmp_path: Path) -> None:
    """The path goes around the clamp's corner at 0.1; with P0.2 the controller may cut through it."""
    around = f"{HEAD}G1 X39.9 Y-30\nZ-60\n{{}}\nY10.1\nX80\nG1 Z0\nM30\n"
    for word, expected in (("G61", []), ("G64 P0.05", []), ("G64 P0.2", "GP337"), ("G64 Q0.2", "GP337")):
        labels = {label for label, _ in found(run(tmp_path, around.format(word), setup=stated()))}
        assert labels == ({expected} if expected else set()), word


def test_a_free_traverse_counts_with_its_whole_box(tmp_path: Path) -> None:
    """From X0 Y0 to X100 Y100 past a clamp below the diagonal: on the line it is missed by far."""
    program = f"{HEAD}G1 Z-60\nG0 X100 Y100\nM30\n"
    for text, expected in (("true", []), ("false", [("GP337", 3)])):
        machine = MACHINE + f"straight_traverse = {text}\n" + CLAMP
        assert found(run(tmp_path, program, machine, stated())) == expected
        # A feed move is a line on every controller.
        assert found(run(tmp_path, program.replace("G0", "G1"), machine, stated())) == []
        # One axis after the other goes along lines; across the clamp it is certain.
        assert found(run(tmp_path, f"{HEAD}G1 Z-60\nG0 X100\nM30\n", machine, stated())) == [("GP336", 3)]
        assert found(run(tmp_path, f"{HEAD}G1 Z-60\nG0 X50 Y5\nM30\n", machine, stated())) == [("GP336", 3)]


def test_the_tool_change_area_has_the_same_traverses(tmp_path: Path) -> None:
    area = "\n[areas.tool_change]\nx = [40.0, 60.0]\ny = [-10.0, 10.0]\nz = [-200.0, -50.0]\n"
    for text, expected in (("true", []), ("false", [("GP311", 3)])):
        machine = MACHINE + f"straight_traverse = {text}\n" + area
        assert found(run(tmp_path, f"{HEAD}G1 Z-60\nG0 X100 Y100\nM30\n", machine, stated())) == expected


def test_each_dialect_has_its_own_traverse(tmp_path: Path) -> None:
    zone = '\n[[keep_out]]\nname = "clamp"\nx = [40.0, 60.0]\ny = [-10.0, 10.0]\nz = [-inf, 50.0]\n'
    start = 'schema = "gproof-setup/1"\nhomed = ["x", "y", "z"]\nstart = {x = 0.0, y = 0.0, z = 0.0}\ntool = 0\n'
    start += "g92 = {x = 0.0, y = 0.0, z = 0.0}\n"
    wincnc = MACHINE.replace('"eding"', '"wincnc"') + zone
    judgement = run(tmp_path, "G90\nG22\nG0 X100 Y100\n", wincnc, start, "wincnc")
    assert found(judgement) == [("GP337", 3)]
    mcuwin = (
        MACHINE.replace('"eding"', '"mcuwin"')
        .replace("[axes.", "[axes.")
        .replace("max = ", 'position_unit = "mm"\nmax = ')
        + zone
    )
    judgement = run(tmp_path, "%\nG90\nG00 X100 Y100\nM30\n%\n", mcuwin, start, "mcuwin")
    assert found(judgement) == [("GP337", 3)]


def test_another_head_is_not_followed(tmp_path: Path) -> None:
    machine = MACHINE + CLAMP + "\n[spindles.1]\nx = 50.0\ny = 0.0\nz = 0.0\n"
    program = f"{HEAD}G1 X1\n{{}}\nG1 Y3\nY4\nM30\n"
    assert found(run(tmp_path, program.format("G1 X2"), machine, stated())) == []
    assert ("GP337", 4) in found(run(tmp_path, program.format("M91"), machine, stated()))


def test_homing_may_go_anywhere_along_its_axes(tmp_path: Path) -> None:
    program = f"{HEAD}G1 Z-60\nhome {{}}\nM30\n"
    for axes, expected in (("x", [("GP337", 3)]), ("y", []), ("z", [])):
        assert found(run(tmp_path, program.format(axes), setup=stated())) == expected, axes


@pytest.mark.parametrize(
    ("text", "label"),
    [
        ('[[keep_out]]\nx = [0.0, 1.0]\n', "GP604"),
        ('[[keep_out]]\nname = "a"\n', "GP604"),
        ('[[keep_out]]\nname = "a"\nx = [1.0, 1.0]\n', "GP603"),
        ('[[keep_out]]\nname = "a"\nx = [1.0]\n', "GP603"),
        ('[[keep_out]]\nname = "a"\npolygon = [[0, 0], [1, 1]]\n', "GP603"),
        ('[[keep_out]]\nname = "a"\npolygon = [[0, 0], [9, 9], [9, 0], [0, 9]]\n', "GP603"),
        ('[[keep_out]]\nname = "a"\npolygon = [[0, 0], [9, 0], [9, 9]]\nx = [0.0, 1.0]\n', "GP603"),
        ('[[keep_out]]\nname = "a"\nx = [0.0, 1.0]\n[[keep_out]]\nname = "a"\nx = [0.0, 1.0]\n', "GP603"),
        ('[[keep_out]]\nname = "a"\nx = [0.0, 1.0]\nhigh = 3\n', "GP611"),
    ],
)  # fmt: skip
def test_mistakes_in_zones_have_their_finding(tmp_path: Path, text: str, label: str) -> None:
    from gproof.driver.dialects import load_machine
    from gproof.ir.finding import Findings

    path = tmp_path / "machine.toml"
    path.write_text(f'schema = "gproof-machine/1"\nunits = "mm"\n{text}')
    findings = Findings()
    load_machine(path, findings)
    assert [f.code.label for f in findings.kept] == [label], [f.message for f in findings.kept]


def test_many_lines_beside_a_polygon_are_sorted_out_alike(tmp_path: Path) -> None:
    """More rows than from which on shapely sorts: the same findings as each row by itself."""
    rng = random.Random(5)
    zone = '\n[[keep_out]]\nname = "ell"\nz = [-99, 99]\n'
    zone += "polygon = [[0, 0], [90, 0], [90, 20], [20, 20], [20, 90], [0, 90]]\n"
    lines = []
    for _ in range(700):
        x, y = rng.uniform(0, 110), rng.uniform(0, 110)
        lines.append(
            f"G53 G0 Z100\nX{x:.4f} Y{y:.4f}\nG1 Z50\nX{x + rng.uniform(-4, 4):.4f} Y{y + rng.uniform(-4, 4):.4f}\n"
        )
    text = HEAD + "G0\n" + "".join(lines).replace("\nX", "\nG0 X").replace("G1 Z50\nG0 X", "G1 Z50\nX") + "M30\n"
    whole = run(tmp_path, text, MACHINE + zone, stated(tool=1))
    from gproof.passes.checks.zones import zone_check

    before, zone_check._MANY = zone_check._MANY, 10**9
    try:
        singly = run(tmp_path, text, MACHINE + zone, stated(tool=1))
    finally:
        zone_check._MANY = before
    assert found(whole) == found(singly)
    assert whole.findings.counts == singly.findings.counts
    assert whole.findings.counts[336] > 100
