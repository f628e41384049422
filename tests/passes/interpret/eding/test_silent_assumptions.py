"""What no file and no job says, and a verdict beside zones or bodies rests on, is printed as an assumption."""

from __future__ import annotations

from pathlib import Path

import pytest
from reach.worlds import EDING, WINCNC, World, exactly

from gproof.driver.judge import judge
from gproof.driver.session import Running, open_session
from gproof.ir.machine import Area, Axis, AxisKind
from gproof.ir.setup import Interval
from gproof.ir.symbols import describe
from gproof.ir.trace import Affine
from gproof.ir.workpiece import Box, Placed, Workpiece
from gproof.passes.checks.cutting.feeds import KNOB
from gproof.passes.checks.registry import every_property
from gproof.passes.checks.tooling.tip_position import OWN_LENGTH
from gproof.passes.geometry.off_path import NO_TOLERANCE

NO_ROUNDING = "no corner rounding (G64 P) and no joining of lines (Q) is active at the start"
ZONE = (Area(name="post", box=((300.0, 310.0), (0.0, 10.0), (-150.0, -100.0))),)
PART = Workpiece(part=(Placed(name="part", body=Box(low=(0.0, 0.0, -9.0), high=(9.0, 9.0, -5.0))),))
OPEN = EDING.with_setup(tool_lengths={})
LINES = "G21 G90 G17\nG0 X20 Y20 Z80\n"
BESIDE = {"zone": {"keep_out": ZONE}, "part": {"workpiece": PART}}


def assumed(world: World, text: str, folder: Path) -> set[str]:
    """All that is printed as an assumption of a job, whatever is judged."""
    from corpus.jobs import CORPUS
    from reach.changes import put

    job = folder / "job.cnc"
    job.write_text(text + "M30\n")
    session = open_session(job, machine=CORPUS / world.machine, setup=None, dialect=world.dialect)
    session.setup = world.setup
    for path, value in world.changes:
        session.machine = put(session.machine, path[1:], value)
    made = judge(session, running=Running(1000), properties=every_property())
    return {*made.assumptions, *(one for result in made.properties for one in result.assumptions)}


@pytest.mark.parametrize("beside", BESIDE)
@pytest.mark.parametrize(
    ("world", "text", "needed"),
    [
        (OPEN, LINES, True),
        (OPEN, "G49\n" + LINES, False),
        (OPEN, "G43 H1\n" + LINES, False),
        (EDING, LINES, False),
        (OPEN.with_setup(tool_lengths={0: Interval(40.0, 40.0)}), LINES, False),
    ],
)
def test_the_length_in_force_at_the_start(
    beside: str, world: World, text: str, needed: bool, tmp_path: Path
) -> None:  # fmt: skip
    assert (OWN_LENGTH in assumed(world.with_setup(**BESIDE[beside]), text, tmp_path)) == needed
    assert OWN_LENGTH not in assumed(world, text, tmp_path)


@pytest.mark.parametrize("beside", BESIDE)
@pytest.mark.parametrize(
    ("first", "rounding", "tolerance"),
    [("", True, False), ("G61\n", False, False), ("G64\n", False, True), ("G64 P0.1\n", False, False)],
)
def test_how_corners_are_taken(beside: str, first: str, rounding: bool, tolerance: bool, tmp_path: Path) -> None:
    found = assumed(EDING.with_setup(**BESIDE[beside]), first + LINES, tmp_path)
    assert (NO_ROUNDING in found, NO_TOLERANCE in found) == (rounding, tolerance)
    assert not {NO_ROUNDING, NO_TOLERANCE} & assumed(EDING, first + LINES, tmp_path)


@pytest.mark.parametrize(
    ("form", "said"),
    [
        ((("tool.0.z", 1),), "active tool length"),
        ((("tool.0.a", 1),), "active tool length of W"),
        ((("tool.3.a", 1), ("start.a", 1)), "length of W of tool 3 + the start position of W"),
    ],
)
def test_lengths_name_their_head(form: Affine, said: str) -> None:
    """Axis W of a WinCNC machine is column a."""
    head = Axis(name="a", letter="W", kind=AxisKind.LINEAR, vertical=True)
    from gproof.ir.machine import Machine

    assert describe(form, Machine(name="two heads", axes=(head,))) == said


def test_conditions_have_no_sign(tmp_path: Path) -> None:
    """A zone under the machine's zero asks for a tool that is short enough, not for less than nothing of it."""
    from corpus.jobs import CORPUS

    from gproof.report.summary import condition_text

    job = tmp_path / "job.cnc"
    job.write_text("G21 G90 G17\nG53 G0 Z0\nG53 G0 X305 Y5\nM30\n")
    session = open_session(job, machine=CORPUS / OPEN.machine, setup=None, dialect="eding")
    session.setup = OPEN.with_setup(start=exactly(x=0.0, y=0.0, z=0.0), keep_out=ZONE).setup
    made = judge(session, running=Running(1000))
    texts = [condition_text(session, one) for result in made.properties for one in result.conditions]
    assert texts == ["active tool length is at most 100.0000 mm"]


@pytest.mark.parametrize("limit", [None, 100.0])
def test_feeds_that_the_operator_may_change(limit: float | None, tmp_path: Path) -> None:
    """Only a tool that stands no more than so much asks where the knob stands."""
    world = EDING if limit is None else EDING.but((("machine", "tools", 0, "max_feed"), limit))
    found = assumed(world, LINES + "G1 X1 F100\n", tmp_path)
    assert (KNOB in found) == (limit is not None)


def test_what_a_job_before_may_have_left_on(tmp_path: Path) -> None:
    """WinCNC Users Guide: L11, L12, L13, L300 end with a command of their own, not with the job."""
    from corpus.jobs import CORPUS

    job = tmp_path / "job.tap"
    job.write_text("G90\nG0 X1 Y1\n")
    session = open_session(job, machine=CORPUS / WINCNC.machine, setup=None, dialect="wincnc")
    made = judge(session, running=Running(1000))
    assert any("mapped, coupled or locked" in one for one in made.assumptions), made.assumptions
