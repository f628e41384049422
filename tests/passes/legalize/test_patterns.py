"""Each pattern of legalising: a job that needs it for some target, what becomes of it, and one that must not have it.

What becomes of a job follows from what the operations mean (docs/job.md), worked out by hand.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np
from support.each import each
from support.jobs_by_hand import PLACE, at, cut, job, mm, number, rapid, run, said, variable

from gproof.driver.targets import TARGETS
from gproof.ir.columns import Columns
from gproof.ir.job import (
    MOVE,
    AllowOverrides,
    ArcTo,
    ChangeTool,
    Choice,
    Compensate,
    CountLoop,
    DrillHole,
    DwellFor,
    EndJob,
    Feed,
    Job,
    LoopWhile,
    Moves,
    MoveTo,
    Node,
    OptionalPart,
    PauseJob,
    RepeatGrid,
    SetFrame,
    SetPathMode,
    SetVariable,
    ShowText,
    SwitchCoolant,
    SwitchGuard,
    SwitchOutput,
    TurnSpindle,
    UseLength,
    WaitFor,
)
from gproof.ir.program import Binary, Input, Text, Unary
from gproof.ir.target import Target
from gproof.passes.legalize.legalize import legalize
from gproof.passes.legalize.options import Options
from gproof.passes.legalize.registry import PATTERNS


def frame(action: str, which: float | None = None, **axes: float) -> SetFrame:
    """Where work coordinates count from."""
    return SetFrame(action=action, number=None if which is None else number(which), places=at(**axes), span=PLACE)


def hole(kind: str = "drill", *, back: str = "top", relative: bool = False, **more: object) -> DrillHole:
    """A hole at X1 Y2 from Z1 down to Z-3."""
    (top,), (bottom,) = at(z=1), at(z=-3)
    places = at(x=1, y=2, relative=relative)
    return DrillHole(kind=kind, at=places, top=top, bottom=bottom, back=back, span=PLACE, **more)  # type: ignore[arg-type]


def change(which: float | None = None, *, select: bool = True, now: bool = True, rests: bool = False) -> ChangeTool:
    """A tool change."""
    tool = None if which is None else number(which)
    return ChangeTool(number=tool, select=select, change=now, rests=rests, span=PLACE)


def spindle(direction: str) -> TurnSpindle:
    """The spindle starts or stops."""
    return TurnSpindle(direction=direction, speed=None, span=PLACE)


def without(name: str, *features: str) -> Target:
    """A target that lacks features besides."""
    target = TARGETS[name].target()
    assert set(features) <= set(target.legal)
    return replace(target, legal={one: source for one, source in target.legal.items() if one not in features})


N, TWICE = variable(1), Binary("<", variable(1), number(2), PLACE)
ONE_MORE = SetVariable(target=N, value=Binary("+", N, number(1), PLACE), span=PLACE)
ZERO = SetVariable(target=N, value=number(0), span=PLACE)
PASSES: tuple[Node, ...] = (cut(x=N), ONE_MORE)
LOOP = LoopWhile(condition=TWICE, body=PASSES, span=PLACE)
REPEAT = LoopWhile(condition=TWICE, body=PASSES, first=True, span=PLACE)
COUNT = CountLoop(variable=N, first=number(1), last=number(2), body=(cut(x=N),), span=PLACE)
GRID = RepeatGrid(rows=1, columns=2, dx=mm(10), dy=mm(0), body=(cut(z=-1),), back=False, span=PLACE)
INPUT = Choice(condition=Input("input", number(3), PLACE), then=(cut(x=1),), otherwise=(), span=PLACE)
CHOICE = Choice(condition=number(1), then=(cut(x=1),), otherwise=(cut(x=2),), span=PLACE)
PART = OptionalPart(body=(cut(x=1),), span=PLACE)
HALF = ArcTo(to=at(x=10, y=0), plane="xy", clockwise=True, radius=mm(5), span=PLACE)
AT_PLACE = ArcTo(to=at(x=10, y=0), plane="xy", clockwise=True, center=at(x=6, y=3), span=PLACE)
CENTRED = replace(AT_PLACE, center=at(x=5, y=0, relative=True))
CIRCLE = replace(CENTRED, to=())
ACROSS = ArcTo(to=at(x=2, z=0), plane="xz", clockwise=True, center=at(x=1, z=0, relative=True), span=PLACE)
TURN = SetFrame(action="rotate", places=at(x=0, y=0), angle=mm(90, "deg"), span=PLACE)
CORNERS = SetPathMode(mode="continuous", tolerance=mm(0.1), simplify=mm(0.2), span=PLACE)
ROUNDED = replace(CORNERS, simplify=None)
MESSAGE = ShowText(kind="msg", parts=(Text("turn it", PLACE),), span=PLACE)
MIST = SwitchCoolant(mist=True, span=PLACE)
DIVIDED = cut(x=Binary("div", number(7), variable(1), PLACE))
ENDS = EndJob(reset=False, span=PLACE)


@dataclass(frozen=True)
class Case:
    """target: that needs the pattern for ``job``, which becomes ``result`` ("...": not compared); other: a job that
    must not have it, or the same one for ``other_target``, or without what ``options`` say."""

    target: str | Target
    job: Job
    result: str
    other: Job | None = None
    other_target: str = ""
    options: Options = field(default_factory=Options)


LENGTH = UseLength(on=True, tool=number(4), span=PLACE)
LONG = Options(lengths={4: 50.0, 5: 60.0})
STRAIGHT = Options(straight_rapids="target", rapid_rates={"x": 6000.0, "y": 5000.0, "z": 3000.0})

CASES = {
    "array -> its cells": Case(
        "eding", job(rapid(x=0, y=0), GRID), "rapid x0 y0; cut z-1; rapid x10 y0; cut z-1", other_target="wincnc"
    ),
    "several runs -> one after the other": Case(
        "eding", job(run(count=2), a=[cut(x=1)]), "run a; run a", other_target="mcuwin"
    ),
    "arguments -> variables": Case("eding", job(run(v5=2), a=[cut(x=1)]), "#5 = 2; run a", other_target="grbl"),
    "subprogram -> what it does": Case("grbl", job(run(), a=[cut(x=1)]), "cut x1", other_target="eding"),
    "input in a condition -> read before": Case(
        "eding", job(INPUT), "read 3; if (#5399 == 1) {cut x1} else {}", other_target="mcuwin"
    ),
    "wait for an input -> loop that looks": Case(
        "eding", job(WaitFor(channel=number(3), on=True, span=PLACE)), "read 3; while (#5399 == 0) {read 3}",
        other_target="linuxcnc",
    ),
    "choice -> the way that is taken": Case("grbl", job(CHOICE), "cut x1", other_target="eding"),
    "block delete -> what its switch says": Case("eding", job(PART), "", options=Options(block_delete=True)),
    "optional stop -> what its switch says": Case(
        "grbl", job(PauseJob(optional=True, span=PLACE), cut(x=1)), "PauseJob; cut x1",
        options=Options(optional_stop=True),
    ),
    "counted loop -> loop with a condition": Case(
        "eding", job(COUNT), "#1 = 1; while (#1 <= 2) {cut x#1; #1 = (#1 + 1)}", other_target="mcuwin"
    ),
    "counted loop -> its passes": Case("grbl", job(COUNT), "cut x1; cut x2", other_target="eding"),
    "condition at the end -> at the start": Case(
        "eding", job(ZERO, REPEAT), "#1 = 0; while (#1 < 2) {cut x#1; #1 = (#1 + 1)}", other=job(REPEAT)
    ),
    "loop -> a pass, then a loop": Case(
        "eding", job(REPEAT), "cut x#1; #1 = (#1 + 1); while (#1 < 2) {cut x#1; #1 = (#1 + 1)}", other_target="linuxcnc"
    ),
    "loop -> its passes": Case("grbl", job(ZERO, LOOP), "cut x0; cut x1", other_target="eding"),
    "setting of a variable -> remembered value": Case("grbl", job(ZERO, cut(x=N)), "cut x0", other_target="eding"),
    "expression -> number": Case("grbl", job(ZERO, cut(x=N)), "cut x0", other=job(cut(x=N))),
    "operator -> others": Case("eding", job(DIVIDED), "cut xint((7 / #1))", other_target="mcuwin"),
    "repeated hole -> single holes": Case(
        "linuxcnc", job(hole(repeats=number(2))),
        "drill x1 y2 z1 to z-3 back to top; drill x1 y2 z1 to z-3 back to top", other_target="eding",
    ),
    "straight rapid -> feed move": Case(
        "mcuwin", job(replace(cut(x=1), feed=Feed(mm(100))), rapid(x=9, y=5)), "cut x1 f100; cut x9 y5 f5000; SetFeed",
        options=STRAIGHT,
    ),
    "drilling cycle -> a move to the hole before it": Case(
        "wincnc", job(rapid(x=0), rapid(y=0), rapid(z=5), hole()),
        "rapid x0; rapid y0; rapid z5; cut x1 y2 f5000; drill x1 y2 z1 to z-3 back to top",
        options=STRAIGHT,
    ),
    "relative hole -> absolute hole": Case(
        "linuxcnc", job(rapid(x=10, y=20, z=5), hole(relative=True)),
        "rapid x10 y20 z5; drill x11 y22 z1 to z-3 back to top", other_target="eding",
    ),
    "hole that returns -> hole, and back": Case(
        "wincnc", job(rapid(z=5), hole(back="before")), "rapid z5; drill x1 y2 z1 to z-3 back to top; rapid z5",
        other_target="linuxcnc",
    ),
    "drilling cycle -> moves": Case(
        "grbl", job(rapid(z=5), hole(back="before")), "rapid z5; rapid x1 y2; rapid z1; cut z-3; rapid z5",
        other_target="eding",
    ),
    "centre at a place -> from the start": Case(
        "eding", job(cut(x=2, y=0), AT_PLACE), "cut x2 y0; cw x10 y0 about +x4 +y3", other_target="mcuwin"
    ),
    "radius -> centre": Case(
        "wincnc", job(cut(x=0, y=0), HALF), "cut x0 y0; cw x10 y0 about +x5 +y0", other_target="eding"
    ),
    "full circle -> its end by name": Case(
        "grbl", job(cut(x=1, y=2), CIRCLE), "cut x1 y2; cw x1 y2 about +x5 +y0", other_target="wincnc"
    ),
    "arc -> chords": Case("wincnc", job(cut(x=0, z=0), ACROSS), "...", other_target="eding"),
    "rotation, scaling, mirroring -> numbers": Case(
        "grbl", job(TURN, cut(x=10, y=0)), "cut x0 y10", other_target="eding"
    ),
    "zero at a machine place -> spare work offset": Case(
        "eding", job(frame("zero_at", x=1, y=2, z=3), cut(x=0, y=0, z=0)),
        "store 9 x1 y2 z3; select 9; cut x0 y0 z0", other_target="mcuwin",
    ),
    "stored work offset -> zero at its place": Case(
        "wincnc", job(frame("store", 2, x=5), frame("select", 2), cut(x=0)), "zero_at x5; cut x0", other_target="eding"
    ),
    "work offset -> the only one": Case(
        "wincnc", job(frame("select", 3), cut(x=0), frame("select", 3), cut(x=1)), "cut x0; cut x1",
        other=job(frame("select", 3), frame("select", 2), cut(x=0)),
    ),
    "work offset with a local offset -> with a shift": Case(
        "mcuwin", job(rapid(x=10), frame("local_here", x=0), frame("select", 2), cut(x=0)),
        "rapid x10; zero_shift x10; select 2; zero_shift x10; cut x0", other_target="eding",
    ),
    "work offset after a shift -> shift off, work offset": Case(
        "grbl", job(rapid(x=10), frame("zero_shift", x=4), frame("select", 2), cut(x=0)),
        "rapid x10; local_here x6; local_off; select 2; cut x0",
        other=job(rapid(x=10), frame("local_here", x=4), frame("select", 2), cut(x=0)),
    ),
    "local offset -> shift of the zero": Case(
        "mcuwin", job(rapid(x=10), frame("local_here", x=4), cut(x=0)), "rapid x10; zero_shift x6; cut x0",
        other_target="eding",
    ),
    "unit -> another unit": Case("mcuwin", job(rapid("inch", x=2)), "rapid x50.8", other_target="eding"),
    "relative places -> absolute places": Case(
        without("grbl", "relative"), job(rapid(x=3), rapid(x=2, relative=True)), "rapid x3; rapid x5",
        other=job(rapid(x=3), rapid(y=2)),
    ),
    "path mode -> a setting of the controller": Case("grbl", job(ROUNDED), "", other_target="linuxcnc"),
    "filter of a path mode -> every place": Case("linuxcnc", job(CORNERS), "continuous", other_target="eding"),
    "guard -> none": Case(
        "linuxcnc", job(SwitchGuard(name="tool_change_area", on=False, span=PLACE)), "", other_target="eding"
    ),
    "continuous path -> exact path": Case(
        without("linuxcnc", "path_tolerance"), job(ROUNDED), "exact_path", other=job(replace(ROUNDED, tolerance=None))
    ),
    "overrides allowed -> as always": Case(
        "mcuwin", job(AllowOverrides(on=True, span=PLACE)), "", other=job(AllowOverrides(on=False, span=PLACE))
    ),
    "coolant -> the other coolant": Case(
        "mcuwin", job(MIST), "mist None flood True", options=Options(coolant={"mist": "flood"})
    ),
    "tool selected early -> at the change": Case(
        "wincnc", job(change(2, now=False), change(2)), "change 2", other_target="eding"
    ),
    "change -> change with a number": Case(
        "wincnc", job(change(2, now=False), change(select=False)), "change 2", other=job(change(2))
    ),
    "tool change -> stop": Case(
        "grbl", job(spindle("cw"), change(1, rests=True)), "spindle cw; spindle off; (put in tool 1); PauseJob",
        options=Options(tool_change="stop"),
    ),
    "message -> comment": Case("grbl", job(MESSAGE), "(turn it)", other_target="eding"),
    "change that stops the spindle -> spindle off, change": Case(
        "wincnc", job(spindle("cw"), change(1, rests=True)), "spindle cw; spindle off; change 1", other_target="eding"
    ),
    "change that leaves the spindle as it is -> change, where it rests": Case(
        "eding", job(spindle("cw"), spindle("off"), change(1)), "spindle cw; spindle off; change 1 at rest",
        other_target="wincnc",
    ),
    "end that stops spindle and coolant -> both off, end": Case(
        "mcuwin", job(spindle("cw"), replace(ENDS, rests=True)), "spindle cw; spindle off; EndJob", other_target="eding"
    ),
    "end that leaves spindle or coolant on -> end of the file": Case(
        "linuxcnc", job(spindle("cw"), ENDS), "spindle cw", other=job(spindle("cw"), spindle("off"), ENDS)
    ),
    "end -> the end that there is": Case(
        without("grbl", "end_reset"), job(replace(ENDS, reset=True)), "EndJob", other=job(ENDS)
    ),
    "machine coordinates -> zero there and back": Case(
        "mcuwin", job(rapid(z=0, frame="machine")), "zero_at z0; rapid z0; select 1", other_target="eding"
    ),
    "inverse time -> a feed a move": Case(
        "mcuwin", job(cut(x=0), replace(cut(x=10), feed=Feed(mm(2, "1/min"), per="move"))), "cut x0; cut x10 f20",
        other_target="eding",
    ),
    "zero in one of several places -> its work offset": Case(
        "mcuwin", job(frame("zero_keep", 1), frame("zero_at", x=5), cut(x=0), frame("zero_recall", 1), cut(x=1)),
        "zero_at x5; cut x0; select 1; cut x1", other_target="wincnc",
    ),
    "end of a compensation that never starts -> nothing": Case(
        "grbl", job(Compensate(side="off", span=PLACE), cut(x=1)), "cut x1",
        other=job(Compensate(side="left", span=PLACE), cut(x=1), Compensate(side="off", span=PLACE)),
    ),
    # A length of 50 lifts the zero by 50; the next tool is 10 longer.
    "tool length -> shift of the zero": Case(
        "mcuwin", job(LENGTH, cut(z=1), replace(LENGTH, tool=number(5)), cut(z=1)),
        "zero_shift z50; cut z1; zero_shift z10; cut z1", options=LONG,
    ),
    "zero while a tool length is in force -> moved by it": Case(
        "mcuwin", job(LENGTH, frame("select", 2), cut(z=1), frame("zero_at", z=3), cut(z=1)),
        "zero_shift z50; select 2; zero_shift z50; cut z1; zero_at z53; cut z1", options=LONG,
    ),
    "end of a tool length that is never used -> nothing": Case(
        "mcuwin", job(UseLength(on=False, span=PLACE), cut(x=1)), "cut x1",
        other=job(UseLength(on=True, span=PLACE), cut(x=1), UseLength(on=False, span=PLACE)),
    ),
}  # fmt: skip


def test_every_pattern_has_a_case_and_every_case_a_pattern() -> None:
    assert sorted(CASES) == sorted(pattern.name for pattern in PATTERNS)
    assert len({pattern.name for pattern in PATTERNS}) == len(PATTERNS)


def target_of(given: str | Target) -> Target:
    return TARGETS[given].target() if isinstance(given, str) else given


@each("name", CASES)
def test_a_pattern_does_what_it_is_for(name: str) -> None:
    case = CASES[name]
    legal = legalize(case.job, target_of(case.target), case.options)
    assert not legal.refused
    assert name in {one.pattern for one in legal.lowered}
    assert case.result in ("...", said(legal.job.body))


@each("name", CASES)
def test_a_pattern_stays_away_from_what_does_not_need_it(name: str) -> None:
    case = CASES[name]
    needs_options = case.options != Options()
    assert (case.other is not None) + bool(case.other_target) + needs_options == 1, "one way that it differs"
    target = target_of(case.other_target or case.target)
    legal = legalize(case.other or case.job, target, Options())
    assert name not in {one.pattern for one in legal.lowered}


def test_feed_moves_in_machine_coordinates_are_moves_with_the_zero_put_away() -> None:
    """WinCNC: G53 is rapid; a length in force would be in Z."""
    down = MoveTo(to=at(z=-20), kind="feed", frame="machine", span=PLACE)
    legal = legalize(job(cut(z=1), down), TARGETS["wincnc"].target(), Options())
    assert said(legal.job.body) == "cut z1; zero_keep; zero_at z0; cut z-20; zero_recall"
    refused = legalize(job(LENGTH, down), TARGETS["wincnc"].target(), Options())
    assert [one.why for one in refused.refused] == ["it has no such moves, and a tool length would be in Z"]


def test_a_wait_of_mcuwin_looks_at_the_input_with_the_axes_at_rest() -> None:
    wait = WaitFor(channel=number(104), on=True, span=PLACE)
    legal = legalize(job(cut(x=1), wait), TARGETS["mcuwin"].target(), Options())
    _, rest, loop = legal.job.body
    assert isinstance(rest, DwellFor) and rest.time.number == 0.0
    assert isinstance(loop, LoopWhile) and not loop.first
    assert loop.condition == Unary("not", Input("input", number(104), PLACE), PLACE)


def test_where_a_straight_subprogram_ends_is_known() -> None:
    """LinuxCNC: after X2 the zero is moved by 5: the present place is X-3 then."""
    nodes = (frame("local_here", x=0), run(), frame("zero_shift", x=5), cut(x=1))
    legal = legalize(job(*nodes, a=[rapid(x=2)]), TARGETS["linuxcnc"].target(), Options())
    assert said(legal.job.body) == "local_here x0; run a; local_here x-3; cut x1"


def test_a_coolant_that_stands_for_another_goes_off_with_it() -> None:
    off = SwitchCoolant(mist=False, span=PLACE)
    legal = legalize(job(MIST, off), TARGETS["mcuwin"].target(), Options(coolant={"mist": "flood"}))
    assert said(legal.job.body) == "mist None flood True; mist None flood False"


def test_a_zero_while_a_measured_tool_may_be_in_force_is_refused() -> None:
    """Its measure counts from the start on, whatever it is; with a length that the job sets, none is taken to be."""
    lone = legalize(job(frame("zero_at", z=0)), TARGETS["mcuwin"].target(), Options(measured_tools=True))
    assert [one.why for one in lone.refused] == ["which tool length is in force is not known"]
    used = Options(measured_tools=True, lengths=LONG.lengths)
    assert not legalize(job(frame("zero_at", z=0), LENGTH), TARGETS["mcuwin"].target(), used).refused


def test_outputs_stop_motion_where_the_axes_rest_anyway() -> None:
    """Eding CNC: M54 and M55 let the axes come to rest (3.5.9); next to a dwell they do."""
    valve = [SwitchOutput(channel=number(1), value=number(on), moving=True, span=PLACE) for on in (1, 0)]
    rest = DwellFor(time=mm(0.5, "s"), span=PLACE)
    legal = legalize(job(cut(x=1), valve[0], rest, valve[1], cut(x=2)), TARGETS["eding"].target(), Options())
    outputs = [node for node in legal.job.body if isinstance(node, SwitchOutput)]
    assert len(outputs) == 2 and not any(one.moving for one in outputs)
    refused = legalize(job(cut(x=1), valve[0], cut(x=2), rest), TARGETS["eding"].target(), Options()).refused
    assert [one.construct for one in refused] == ["output without stopping motion"]


def test_a_loop_by_the_state_of_an_input_reads_it_each_time() -> None:
    loop = LoopWhile(condition=Input("input", number(3), PLACE), body=(cut(x=1),), span=PLACE)
    legal = legalize(job(loop), TARGETS["eding"].target(), Options())
    assert said(legal.job.body) == "read 3; while (#5399 == 1) {cut x1; read 3}"


def test_the_name_of_a_place_in_machine_coordinates_is_a_zero_there() -> None:
    """At machine X50 the present place becomes X2: the zero is at 48; after a move of X that is no place any more."""
    go, name = rapid(x=50, frame="machine"), frame("local_here", x=2)
    target = TARGETS["mcuwin"].target()
    legal = legalize(job(go, name, cut(x=1)), target, Options())
    assert said(legal.job.body) == "zero_at x0; rapid x50; select 1; zero_at x48; cut x1"
    assert legalize(job(go, cut(x=N), name), target, Options()).refused
    assert legalize(job(go, name, frame("local_off")), target, Options()).refused


def test_a_guard_that_only_one_controller_has_is_left_out_and_others_are_kept() -> None:
    """Eding CNC guards the machine's area (4.2), and has no boundaries."""
    off = [SwitchGuard(name=name, on=False, span=PLACE) for name in ("machine_area", "boundaries")]
    legal = legalize(job(*off), TARGETS["eding"].target(), Options())
    assert [node.name for node in legal.job.body if isinstance(node, SwitchGuard)] == ["machine_area"]
    assert "Eding CNC has no guard that the program switches: boundaries" in legal.assumed
    assert legalize(job(*off), TARGETS["wincnc"].target(), Options()).refused


def test_the_feed_before_a_rapid_that_becomes_a_feed_move_counts_after_it() -> None:
    """A table: F100, a rapid of X and Y at their rate, one of X alone, and a move that goes on with F100."""
    arrays = MOVE.empty(4)
    arrays["kind"][:] = [2, 1, 1, 2]
    arrays["axes"][:] = [1, 3, 1, 1]
    arrays["to"][:, 0], arrays["to"][:, 1] = [1, 2, 3, 4], [0, 7, 0, 0]
    arrays["feed"][:] = [100.0, np.nan, np.nan, np.nan]
    table = Moves(rows=Columns(MOVE, arrays), unit="mm", span=PLACE)
    (found,) = legalize(job(table), TARGETS["mcuwin"].target(), STRAIGHT).job.body
    assert isinstance(found, Moves)
    assert found.rows["kind"].tolist() == [2, 2, 1, 2]
    assert np.array_equal(found.rows["feed"], [100.0, 5000.0, np.nan, 100.0], equal_nan=True)
    # At the end of a table it is said after it; where it is not known, nothing is written.
    nodes = legalize(job(replace(table, rows=table.rows.slice(0, 2)), cut(x=5)), TARGETS["mcuwin"].target(), STRAIGHT)
    assert said(nodes.job.body).endswith("SetFeed; cut x5")
    open_feed = replace(cut(x=1), feed=Feed(mm(variable(7))))
    refused = legalize(job(open_feed, rapid(x=9, y=5), cut(x=2)), TARGETS["mcuwin"].target(), STRAIGHT).refused
    assert [one.why.endswith("say F here") for one in refused] == [True]
    again = replace(cut(x=2), feed=Feed(mm(50)))
    legal = legalize(job(open_feed, rapid(x=9, y=5), again), TARGETS["mcuwin"].target(), STRAIGHT)
    assert said(legal.job.body) == "cut x1 f#7; cut x9 y5 f5000; cut x2 f50"


def test_a_loop_whose_feed_is_said_after_each_rapid_stays_one() -> None:
    fed = replace(cut(z=-1), feed=Feed(mm(50)))
    loop = LoopWhile(condition=TWICE, body=(rapid(x=N, y=5), fed, ONE_MORE), span=PLACE)
    legal = legalize(job(ZERO, loop), TARGETS["mcuwin"].target(), STRAIGHT)
    assert said(legal.job.body) == "#1 = 0; while (#1 < 2) {cut x#1 y5 f5000; cut z-1 f50; #1 = (#1 + 1)}"
    # Where the feed is that of the pass before, each pass has another one.
    body = (rapid(x=N, y=5), cut(z=0), fed, ONE_MORE)
    first = replace(cut(x=1), feed=Feed(mm(100)))
    opened = legalize(job(first, ZERO, replace(loop, body=body)), TARGETS["mcuwin"].target(), STRAIGHT)
    assert not opened.refused
    one = "cut x#1 y5 f5000; SetFeed; cut z0; cut z-1 f50; #1 = (#1 + 1)"
    two = "rapid x#1 y5; cut z0; cut z-1 f50; #1 = (#1 + 1)"  # Y is at 5 already
    assert said(opened.job.body) == f"cut x1 f100; #1 = 0; {one}; {two}"


def test_rapids_that_are_straight_on_neither_side_are_refused_and_why() -> None:
    both = replace(STRAIGHT, straight_rapids="source")
    turned = job(rapid(x=1, a=5))
    for options, body, why in (
        (both, job(rapid(x=1, y=2)), "leave out --rapids straight"),
        (STRAIGHT, turned, "a rotary axis moves along"),
        (replace(STRAIGHT, rapid_rates={"x": 6000.0}), job(rapid(x=1, y=2)), "no velocity of Y"),
        (STRAIGHT, job(rapid(x=1, y=2, frame="machine")), "move one axis at a time"),
    ):
        (refused,) = legalize(body, without("wincnc", "frame_zero_keep"), options).refused
        assert why in refused.why, refused.why
    alone = job(rapid(x=1), rapid(y=2), rapid(x=1, y=3), rapid(z=5), rapid(x=1), rapid(y=2), hole())
    legal = legalize(alone, TARGETS["wincnc"].target(), both)
    assert not legal.refused and not legal.lowered


def test_a_variable_that_holds_a_place_is_that_place_where_it_is_known() -> None:
    """#5001 is X in work coordinates (RS274)."""
    keep = SetVariable(target=variable(7), value=variable(5001), span=PLACE)
    legal = legalize(job(rapid(x=3), keep, cut(x=variable(7))), TARGETS["mcuwin"].target(), Options())
    assert said(legal.job.body) == "rapid x3; #7 = 3; cut x#7"
    assert legalize(job(keep), TARGETS["mcuwin"].target(), Options()).refused


def test_an_offset_that_is_set_from_another_one_that_the_job_has_stored() -> None:
    """X12 of offset 2, which is at 30, becomes X2 of offset 1: that is at 40."""
    nodes = (frame("store", 2, x=30), frame("select", 2), rapid(x=12), frame("store_here", 1, x=2), frame("select", 1))
    legal = legalize(job(*nodes, cut(x=5)), TARGETS["wincnc"].target(), Options())
    assert said(legal.job.body) == "zero_at x30; rapid x12; zero_at x40; cut x5"


def test_a_length_that_no_file_says_is_refused_and_why() -> None:
    legal = legalize(job(LENGTH, cut(z=1)), TARGETS["mcuwin"].target(), Options())
    (refused,) = legal.refused
    assert refused.construct == "tool length offset"
    assert refused.why == "it has no tool lengths, and no file says what tool 4 is long: [lengths] of the map"


def test_machine_coordinates_have_no_length_and_the_zero_after_them_has_it() -> None:
    """Z0 of the machine is reached without the length; after it G54 has it again."""
    nodes = (LENGTH, rapid(z=0, frame="machine"), cut(z=1))
    legal = legalize(job(*nodes), TARGETS["mcuwin"].target(), LONG)
    assert not legal.refused
    assert said(legal.job.body) == "zero_shift z50; zero_at z0; rapid z0; select 1; zero_shift z50; cut z1"


def test_a_length_that_only_one_way_of_a_choice_sets_is_refused() -> None:
    way = replace(INPUT, then=(LENGTH,))
    legal = legalize(job(way, replace(LENGTH, tool=number(5))), TARGETS["mcuwin"].target(), LONG)
    assert [one.why for one in legal.refused] == ["which tool length is in force before it is not known"]


def test_subprograms_and_loops_are_opened_where_what_is_in_force_differs_from_run_to_run() -> None:
    """A turn by 90 degrees, then by 180: X10 becomes Y10, then X-10."""
    by = SetFrame(action="rotate", places=at(x=0, y=0), angle=mm(Binary("*", N, number(90), PLACE), "deg"), span=PLACE)
    loop = replace(COUNT, body=(by, cut(x=10, y=0)))
    legal = legalize(job(loop), TARGETS["mcuwin"].target(), Options())
    assert not legal.refused
    assert said(legal.job.body) == "#1 = 1; cut x0 y10; #1 = (#1 + 1); cut x-10 y0; #1 = (#1 + 1)"
    # From which height a hole in a subprogram starts is known where it is run, not within it.
    deep = job(rapid(z=5), run(), a=[hole(back="before")])
    legal = legalize(deep, TARGETS["mcuwin"].target(), Options())
    assert said(legal.job.body) == "rapid z5; rapid x1 y2; rapid z1; cut z-3; rapid z5"


def test_chords_are_as_close_to_the_arc_as_they_should_be() -> None:
    """Half a circle of 1 mm about X1 Z0, from X0 to X2, clockwise seen from +Y: by way of Z-1 or Z1."""
    legal = legalize(CASES["arc -> chords"].job, TARGETS["wincnc"].target(), Options(chord_tolerance=0.01))
    (rows,) = (node.rows for node in legal.job.body if type(node).__name__ == "Moves")
    ends = [(0.0, 0.0), *zip(rows["to"][:, 0].tolist(), rows["to"][:, 2].tolist(), strict=True)]
    assert ends[-1] == (2.0, 0.0)
    for (x, z), (u, w) in pairwise(ends):
        assert abs(((u - 1) ** 2 + w**2) ** 0.5 - 1.0) < 1e-12
        middle = (((x + u) / 2 - 1) ** 2 + ((z + w) / 2) ** 2) ** 0.5
        assert 1.0 - 0.01 <= middle < 1.0
    # Seen from +Y, X points to the left when Z points up: clockwise from X0 to X2 is by way of Z-1.
    assert min(z for _, z in ends) < -0.99 and max(z for _, z in ends) <= 1e-12


@each(
    "node,target,why",
    [
        (change(3), "grbl", 'it has none; with tool_change = "stop" in the map it becomes a stop for the operator'),
        (SwitchCoolant(mist=True, flood=None, span=PLACE), "mcuwin",
         'it has no mist; [coolant] mist = "flood" of the map makes it the other one'),
        (ArcTo(to=(), plane="xy", clockwise=True, center=at(x=5, y=0, relative=True), feed=None, span=PLACE), "eding",
         "it has to name its end, and where it starts is not known"),
    ],
)  # fmt: skip
def test_a_refusal_says_what_would_help(node: Node, target: str, why: str) -> None:
    (refused,) = legalize(job(node), TARGETS[target].target(), Options()).refused
    assert refused.why == why
