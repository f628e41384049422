"""Jobs of which the start or offsets are not stated: judged for what is known, and what is not is said. By hand."""

from __future__ import annotations

from pathlib import Path

import pytest
from passes.checks.zones.test_zones import CLAMP, HEAD, MACHINE, found, run
from support.judging import answer

from gproof.driver.judge import Judgement
from gproof.ir.verdict import Verdict

SETUP = 'schema = "gproof-setup/1"\nactive_work = 1\ntool = 2\ng92 = {x = 0.0, y = 0.0, z = 0.0}\n'
WORK = "[work.1]\nx = 0.0\ny = 0.0\nz = 0.0\n"


def ranges(judgement: Judgement, name: str) -> dict[str, tuple[float, float]]:
    found = answer(judgement, name).conditions
    return {" + ".join(symbol for symbol, _ in c.terms): (round(c.low, 6), round(c.high, 6)) for c in found}


def said(judgement: Judgement) -> list[tuple[str, int]]:
    wanted = ("error", "unknown")
    return [(f.code.label, f.span.line) for f in judgement.findings.kept if f.severity.value in wanted]


def test_an_axis_that_is_known_is_judged_beside_one_that_is_not(tmp_path: Path) -> None:
    """Y leaves the machine at 501; nobody knows where X begins, and it only has to fit."""
    judgement = run(tmp_path, f"{HEAD}G91\nG1 X100\nG90\nY501\nM30\n", MACHINE, SETUP + WORK)
    assert said(judgement) == [("GP301", 5)]
    fits = run(tmp_path, f"{HEAD}G91\nG1 X100\nG90\nY499\nM30\n", MACHINE, SETUP + WORK)
    assert fits.verdict is Verdict.SAFE
    # X moves from its start to 100 beyond: -500 to 400. Z never moves.
    assert ranges(fits, "limits")["start.x"] == (-500.0, 400.0)
    assert "start.z" not in ranges(fits, "limits")


def test_the_way_from_an_unknown_start_past_a_clamp(tmp_path: Path) -> None:
    """The clamp is 40 to 60 in X, -10 to 10 in Y, below -50. The job stands still nowhere but at known places."""
    high = run(tmp_path, f"{HEAD}G53 G0 Z0\nG0 X0 Y0\nG1 Z-60\nX30\nM30\n", MACHINE + CLAMP, SETUP + WORK)
    assert high.verdict is Verdict.SAFE
    # Left of the clamp, or above it, or beside it: the side that leaves the start the most room is asked for.
    assert ranges(high, "areas") == {"start.x": (-500.0, 40.0)}
    asked = "the start position of X is between -500.000 and 40.000 mm (machine coordinates)"
    assert asked in answer(high, "areas").assumptions
    later = run(tmp_path, f"{HEAD}G53 G0 Z0\nG0 X0 Y0\nG1 Z-60\nX50\nM30\n", MACHINE + CLAMP, SETUP + WORK)
    assert found(later) == [("GP336", 5)]


def test_a_start_beside_the_clamp_at_its_height(tmp_path: Path) -> None:
    """Z is known to be low: the way in X and Y from an unknown place to X0 Y0 must keep left of 40."""
    setup = SETUP.replace("tool = 2", "tool = 2\nstart = {z = -60.0}") + WORK
    low = run(tmp_path, f"{HEAD}G0 X0 Y0\nM30\n", MACHINE + CLAMP, setup)
    assert low.verdict is Verdict.SAFE
    assert ranges(low, "areas") == {"start.x": (-500.0, 40.0)}
    # Across all of X at the Y of the start: that has to be beside the clamp, and may be nearer where a range is stated.
    across = f"{HEAD}G0 X-400\nX400\nY400\nM30\n"
    beside = run(tmp_path, across, MACHINE + CLAMP, setup)
    assert ranges(beside, "areas") in ({"start.y": (10.0, 500.0)}, {"start.y": (-500.0, -10.0)})
    for y, verdict in (("[10.001, 20.0]", "SAFE"), ("[9.0, 20.0]", "UNKNOWN"), ("0.0", "UNSAFE")):
        judgement = run(tmp_path, across, MACHINE + CLAMP, setup.replace("{z =", f"{{y = {y}, z ="))
        assert answer(judgement, "areas").verdict.value == verdict, y
    near = run(tmp_path, across, MACHINE + CLAMP, setup.replace("{z =", "{y = [9.0, 20.0], z ="))
    assert "the start position of Y" in next(f.message for f in near.findings.kept if f.code.number == 337)


@pytest.mark.parametrize(
    ("dialect", "program"),
    [
        ("wincnc", "G90\nG22\nG91\nG0 X100\nG90\nG53 Y{}\n"),
        ("mcuwin", "%\nG53\nG91\nG00 X100\nG90\nG00 Y{}\nM30\n%\n"),
    ],
)
def test_the_other_dialects_too(tmp_path: Path, dialect: str, program: str) -> None:
    machine = MACHINE.replace('"eding"', f'"{dialect}"')
    if dialect == "mcuwin":
        machine = machine.replace("max = ", 'position_unit = "mm"\nmax = ')
    setup = 'schema = "gproof-setup/1"\nhomed = ["x", "y", "z"]\ng92 = {x = 0.0, y = 0.0, z = 0.0}\n'
    fits = run(tmp_path, program.format(499), machine, setup, dialect)
    assert answer(fits, "limits").verdict is Verdict.SAFE, said(fits)
    assert ranges(fits, "limits")["start.x"] == (-500.0, 400.0)
    beyond = run(tmp_path, program.format(501), machine, setup, dialect)
    assert [label for label, _ in said(beyond)] == ["GP301"]


def test_moves_that_are_clear_each_for_itself_need_no_common_face(tmp_path: Path) -> None:
    """Around the clamp from a start that nobody states: up first, then beside it at its height, on two sides of it."""
    setup = 'schema = "gproof-setup/1"\nhomed = ["x", "y", "z"]\nactive_work = 1\ntool = 2\n'
    setup += "start = {x = 0.0, z = 0.0}\ng92 = {x = 0.0, y = 0.0, z = 0.0}\n[work.1]\nx = 0.0\ny = 0.0\nz = 0.0\n"
    # Y is open until line 8: over the clamp, and left and right of it.
    program = f"{HEAD}G1 X20\nZ-60\nZ0\nX80\nZ-60\nX90\nY30\nX0\nM30\n"
    around = run(tmp_path, program, MACHINE + CLAMP, setup)
    assert answer(around, "areas").verdict is Verdict.SAFE
    assert not answer(around, "areas").conditions
    through = run(tmp_path, program.replace("Z0\nX80\nZ-60\n", "X80\n"), MACHINE + CLAMP, setup)
    assert answer(through, "areas").conditions or answer(through, "areas").verdict is not Verdict.SAFE


def test_what_can_not_be_decided_is_told_at_its_move(tmp_path: Path) -> None:
    """GP337 and GP304 at the first move that rests on what is open, not at the first line."""
    setup = 'schema = "gproof-setup/1"\nhomed = ["x", "y", "z"]\nactive_work = 1\ntool = 2\n'
    setup += "start = {x = [0.0, 70.0], y = 0.0, z = 0.0}\ng92 = {x = 0.0, y = 0.0, z = 0.0}\n"
    setup += "[work.1]\nx = 0.0\ny = 0.0\nz = 0.0\n"
    judgement = run(tmp_path, f"{HEAD}G1 Y1\nZ-60\nG1 X-90\nM30\n", MACHINE + CLAMP, setup)
    assert ("GP337", 3) in found(judgement)
    work = setup.replace("x = [0.0, 70.0]", "x = 0.0").replace(
        "x = 0.0\ny = 0.0\nz = 0.0\n", "x = [0.0, 450.0]\ny = 0.0\nz = 0.0\n"
    )
    limits = run(tmp_path, f"{HEAD}G1 Y1\nX10\nX100\nX20\nM30\n", MACHINE, work)
    told = [f.span.line for f in limits.findings.kept if f.code.number == 304]
    assert told == [4]
