"""StepStream: counts and times by hand, every step against the exact position, limits of the board, events."""

from __future__ import annotations

import dataclasses
import math
from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from passes.motion.reference_motion import Motion, expand, paths
from passes.motion.traces import Path, machine, validate
from support.campaigns import examples

from gproof.ir.columns import Columns
from gproof.ir.finding import Findings
from gproof.ir.machine import Board, Machine
from gproof.ir.plan import Plan
from gproof.ir.setup import NOTHING
from gproof.ir.stream import StepStream
from gproof.ir.trace import Op, Plane, Trace
from gproof.passes.motion import run_kernels
from gproof.passes.motion import step as module
from gproof.passes.motion.plan import plan, shortest_interval
from gproof.passes.motion.step import nearest_count, nearest_counts, step

RANDOM = examples(15, 500)
SECOND = 16_000_000
TURN = 128

MACHINES = [
    machine(),
    machine(
        steps=Fraction(-1600, 7), velocity=400.0, acceleration=2000.0, max_step_frequency=90e3, spindle_ramp_time=0.2
    ),
    machine(steps=1600, max_step_frequency=None, acceleration=3000.0, board=Board(tick_frequency=1_000_000)),
]  # fmt: skip


def lowered(trace: Trace, on: Machine | None = None) -> tuple[Plan, StepStream]:
    findings = Findings()
    on = on or machine()
    made = plan(trace, on, findings)
    assert made is not None, findings.kept
    stream = step(trace, made, on, findings)
    assert stream is not None, findings.kept
    stream.verify()
    return made, stream


def seconds(stream: StepStream, motor: int = 0) -> list[float]:
    return [tick / stream.tick_frequency for tick, _ in expand(stream, 0, motor)]


# --- by hand ------------------------------------------------------------------------------------------------


def test_steps_of_one_axis_come_when_it_passes_the_halves() -> None:
    _, stream = lowered(Path().feed(3000, x=100).done())
    at = seconds(stream)
    assert len(at) == 32_000
    for n in (0, 1, 5, 100, 400, 799, 800, 10_000, 31_000, 31_999):
        s = (n + 0.5) / 320
        if s < 2.5:
            exact = math.sqrt(2 * s / 500)
        elif s < 97.5:
            exact = 0.1 + (s - 2.5) / 50
        else:
            exact = 2.1 - math.sqrt(2 * (100 - s) / 500)
        assert abs(at[n] - exact) <= 25e-6 + 1 / SECOND
    assert stream.sections[0].duration == math.ceil(2.1 * SECOND)
    assert stream.sections[0].end() == (32_000, 0, 0, 0)


def test_a_full_circle_goes_four_radii_on_each_axis() -> None:
    _, stream = lowered(Path(x=10).arc(600, 1, (0, 0)).done())
    for motor in (0, 1):
        steps = expand(stream, 0, motor)
        assert len(steps) == 4 * 10 * 320
        assert sum(direction for _, direction in steps) == 0
        turns = sum(a[1] != b[1] for a, b in pairwise(steps))
        assert turns == (1 if motor == 0 else 2)
    # Counter-clockwise from (10, 0): X goes back first, Y forth.
    assert expand(stream, 0, 0)[0][1] == -1
    assert expand(stream, 0, 1)[0][1] == 1


@pytest.mark.parametrize(("plane", "first", "second"), [(Plane.XY, 0, 1), (Plane.XZ, 2, 0), (Plane.YZ, 1, 2)])
def test_arcs_turn_in_their_plane(plane: Plane, first: int, second: int) -> None:
    names = "xyz"
    start = {names[first]: 10.0}
    path = Path(**start).arc(600, 1, (0, 0), plane, **{names[first]: 0, names[second]: 10}).done()
    _, stream = lowered(path)
    assert {d for _, d in expand(stream, 0, first)} == {-1}
    assert {d for _, d in expand(stream, 0, second)} == {1}
    assert len(expand(stream, 0, first)) == len(expand(stream, 0, second)) == 3200
    assert expand(stream, 0, 3 - first - second) == []


def test_a_helix_runs_evenly_along_its_axis() -> None:
    _, stream = lowered(Path(x=10).arc(600, -2, (0, 0), z=5).done())
    at = seconds(stream, 2)
    assert len(at) == 1600
    assert max(np.diff(at[100:-100])) - min(np.diff(at[100:-100])) < 60e-6


def test_slaves_step_with_their_axis_and_signs_are_wiring() -> None:
    m = machine(slaves=1)
    m = dataclasses.replace(
        m, axes=(*m.axes[:1], dataclasses.replace(m.axes[1], steps_per_unit=Fraction(-320)), *m.axes[2:])
    )
    _, stream = lowered(Path(y=1).feed(600, x=10, y=11).done(), m)
    assert [motor.name for motor in stream.motors] == ["X", "X2", "Y", "Z", "A"]
    assert stream.sections[0].runs[0] == stream.sections[0].runs[1]
    assert stream.sections[0].start == (0, 0, -320, 0, 0)
    assert stream.sections[0].end() == (3200, 3200, -3520, 0, 0)


def test_sections_go_on_where_the_last_one_ended() -> None:
    _, stream = lowered(Path().feed(600, x=1.2345).end_section().feed(600, x=0.7).end_section().dwell(1).done())
    assert stream.sections[0].end() == stream.sections[1].start
    assert stream.sections[1].end() == stream.sections[2].start
    assert stream.sections[2].duration == SECOND


def test_events_have_their_ticks_and_dwells_their_time() -> None:
    path = Path().other(Op.COOLANT, 0, 1).feed(600, x=1).spindle(1, 12_345.6789).dwell(0.1).feed(600, x=2).other(Op.END)
    trace = path.other(Op.STOP, 1).done()
    _, stream = lowered(trace, machine(spindle_ramp_time=1.5))
    events = list(stream.sections[0].events.rows())
    assert [(row, Op(op), arg) for _, row, op, arg in events] == [
        (0, Op.COOLANT, [0, 1000]), (2, Op.SPINDLE, [1000, 12_345_679]), (3, Op.DWELL, [100, 0]),
        (6, Op.STOP, [1000, 0]),
    ]  # fmt: skip
    ticks = [tick for tick, *_ in events]
    steps = [tick for tick, _ in expand(stream, 0, 0)]
    assert ticks[0] == 0 < steps[0]
    assert steps[319] < ticks[1]
    assert ticks[2] - ticks[1] == 1.5 * SECOND
    assert steps[320] - ticks[2] > 0.1 * SECOND
    assert steps[639] < ticks[3] == stream.sections[0].duration


def test_a_dwell_is_rounded_up_to_ticks() -> None:
    m = machine(board=Board(tick_frequency=1_000_000))
    _, stream = lowered(Path().dwell(1 / 3).dwell(1e-9).done(), m)
    assert stream.sections[0].duration == 333_334 + 1


@given(st.floats(-1e6, 1e6), st.fractions(Fraction(1, 1000), 10**6), st.booleans())
def test_counts_are_the_nearest_exactly(position: float, steps: Fraction, negative: bool) -> None:
    steps = -steps if negative else steps
    exact = Fraction(position) * steps
    count = nearest_count(position, steps)
    assert abs(exact - count) <= Fraction(1, 2)
    assert abs(exact - count) < Fraction(1, 2) or count % 2 == 0


@given(
    st.lists(st.integers(-(10**7), 10**7), max_size=20),
    st.sampled_from([320, 500, Fraction(-1600, 7), Fraction(10**9, 3)]),
)
def test_counts_of_many_positions_are_those_of_each(places: list[int], steps: Fraction | int) -> None:
    exact = Fraction(steps)
    positions = np.array([n / 1280 for n in places] + [float((2 * n + 1) / (2 * exact)) for n in places])
    assert nearest_counts(positions, exact).tolist() == [nearest_count(p, exact) for p in positions.tolist()]


def test_a_peak_just_past_a_half_step_makes_no_pair() -> None:
    """X passes 320.5 steps by a hair and comes back: two steps in 10 us would be too fast for the driver."""
    top = 1.0 + 0.5 / 320
    for beyond, steps in ((1e-9, 640), (1e-4, 642)):
        _, stream = lowered(Path().feed(600, x=top + beyond).feed(600, x=0).done())
        made = expand(stream, 0, 0)
        assert len(made) == steps
        assert min(b - a for (a, _), (b, _) in pairwise(made)) >= TURN


def test_moves_too_short_to_plan_still_count() -> None:
    half = 0.5 / 320
    for trace in (
        Path(x=half).feed(600, x=half + 1e-12).done(),
        Path(x=half - 1).feed(600, x=half - 1e-12).feed(600, x=half + 1e-12).done(),
    ):
        _, stream = lowered(trace)
        assert stream.sections[0].end()[0] == 1


# --- findings -----------------------------------------------------------------------------------------------


def told(trace: Trace, on: Machine, given_plan: Plan | None = None) -> list[str]:
    findings = Findings()
    made = given_plan or plan(trace, on, findings)
    assert made is not None
    assert step(trace, made, on, findings) is None
    return [f"{f.span.line} {f.code.label} {f.message}" for f in findings.kept]


def test_an_axis_that_moves_needs_steps_per_unit() -> None:
    m = machine()
    m = dataclasses.replace(m, axes=(dataclasses.replace(m.axes[0], steps_per_unit=None), *m.axes[1:]))
    moved = told(Path().traverse(y=1).traverse(x=5).done(), m)
    assert moved == ["2 GP504 X moves, but the machine file has no steps per unit for it"]
    circle = told(Path().arc(600, 1, (10, 0)).done(), m)
    assert circle == ["1 GP504 X moves, but the machine file has no steps per unit for it"]
    _, stream = lowered(Path().traverse(y=1).done(), m)
    assert [motor.name for motor in stream.motors] == ["Y", "Z", "A"]


def test_a_motor_needs_to_know_where_it_stands() -> None:
    trace = Path().frame("start.x").dwell(1).done()
    assert told(trace, machine()) == ["1 GP503 steps need exact numbers: X depends on the start position of X"]


def test_event_arguments_must_be_known() -> None:
    trace = Path().other(Op.TOOL_CHANGE, math.nan).done()
    (message,) = told(trace, machine())
    assert message.startswith("1 GP503") and "tool change" in message


def test_positions_beyond_counting_are_refused() -> None:
    (message,) = told(Path(x=1e14).dwell(1).done(), machine())
    assert "GP503" in message
    (message,) = told(Path(x=9e12).traverse(x=9e12 + 1e8).done(), machine())
    assert message.startswith("1 GP503")


def test_times_beyond_counting_are_refused() -> None:
    (message,) = told(Path().feed(1e-4, x=1000).done(), machine())
    assert message.startswith("1 GP503 steps need exact numbers: the section takes 6e+08 s")
    (message,) = told(Path().dwell(1e9).done(), machine())
    assert message.startswith("1 GP503")


def test_a_plan_made_for_a_faster_board_is_refused() -> None:
    trace = Path().traverse(x=100, y=10).done()
    made = plan(trace, machine(), Findings())
    slow = machine(max_step_frequency=20_000.0)
    (message,) = told(trace, slow, made)
    assert message == "1 GP502 X at 100 mm/s needs 32000 steps/s; at most 20000 steps/s are allowed"


# --- properties ---------------------------------------------------------------------------------------------


def crossing_error(motion: Motion, axis: int, rate: float, level: float, t: float, slack: float) -> bool:
    """True when the axis is at ``level`` steps within ``slack`` seconds of t: it is on both sides of it there."""
    around = [motion.at(t + slack * n / 8)[axis] * rate - level for n in range(-8, 9)]
    return min(around) <= 1e-6 and max(around) >= -1e-6


@RANDOM
@given(paths(events=False, most=4), st.sampled_from(MACHINES))
def test_steps_come_when_the_axis_passes_the_halves(trace: Trace, on: Machine) -> None:
    made, stream = lowered(trace, on)
    motion = Motion(trace.sections[0], made.sections[0])
    section = stream.sections[0]
    near = shortest_interval(on)
    turn = max(near, math.ceil(on.board.direction_setup * stream.tick_frequency))
    for number, motor in enumerate(stream.motors):
        exact = motor.steps_per_unit
        assert section.start[number] == nearest_count(trace.sections[0].start[motor.axis], exact)
        rows = trace.sections[0].rows
        last = float(rows["to"][-1, motor.axis]) if len(rows) else trace.sections[0].start[motor.axis]
        assert section.end()[number] == nearest_count(last, exact)
        steps = expand(stream, 0, number)
        count, rate = section.start[number], float(exact)
        before, was = 0, 0
        for at, (tick, direction) in enumerate(steps):
            gap = near if direction == was else turn
            assert tick - before >= gap
            ahead = steps[at + 1][0] - tick if at + 1 < len(steps) else stream.tick_frequency
            # Half of the interval beside it, rounding, and room for a change of direction or a start from rest.
            slack = min(25e-6, 0.5 * max(tick - before, ahead) / stream.tick_frequency) + 2 / stream.tick_frequency
            slack += 2 * turn / stream.tick_frequency
            if at % (1 + len(steps) // 200) == 0 or (direction != was and at < 5000):
                level = count + 0.5 * direction
                assert crossing_error(motion, motor.axis, rate, level, tick / stream.tick_frequency, slack)
            count += direction
            before, was = tick, direction
        if steps:
            assert steps[-1][0] <= section.duration
    assert section.duration <= math.ceil(made.duration * stream.tick_frequency) + 4 * turn


@RANDOM
@given(paths(), st.sampled_from(MACHINES))
def test_the_independent_checker_agrees(trace: Trace, on: Machine) -> None:
    _, stream = lowered(trace, on)
    report = validate(stream, trace, on, NOTHING)
    assert not report.findings, [f.message for f in report.findings]


@RANDOM
@given(paths())
def test_motors_stand_still_at_events(trace: Trace) -> None:
    made, stream = lowered(trace)
    section, rows = stream.sections[0], trace.sections[0].rows
    expected = [r for r in range(len(rows)) if Op.DWELL <= rows["op"][r] <= Op.HOME]
    assert section.events["row"].tolist() == expected
    for number, motor in enumerate(stream.motors):
        steps = expand(stream, 0, number)
        for tick, row, op, arg in section.events.rows():
            count = section.start[number] + sum(d for t, d in steps if t <= tick)
            at = float(rows["to"][row, motor.axis])
            assert abs(Fraction(at) * motor.steps_per_unit - count) <= Fraction(1, 2) + Fraction(1, 10**6)
            if op == Op.DWELL:
                free = tick + math.ceil(Fraction(float(rows["arg"][row, 0])) * SECOND)
                assert arg[0] == round(rows["arg"][row, 0] * 1000)
                assert not any(tick <= t <= free for t, _ in steps)
    assert section.duration >= math.floor(made.duration * SECOND)


@settings(deadline=None, max_examples=15)
@given(paths(most=4), st.integers(200, 3000))
def test_a_small_buffer_gives_a_stream_as_good(trace: Trace, size: int) -> None:
    """The buffer holds what a longer run could cover; with less room the runs end earlier, the steps stay right."""
    _, whole = lowered(trace)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module, "BUFFER", size)
        patch.setattr(run_kernels, "MOST_COUNT", 64)
        _, pieces = lowered(trace)
    for number in range(len(whole.motors)):
        a, b = expand(whole, 0, number), expand(pieces, 0, number)
        assert [d for _, d in a] == [d for _, d in b]
        assert all(abs(s - t) <= 2 * 400 + TURN for (s, _), (t, _) in zip(a, b, strict=True))
    report = validate(pieces, trace, machine(), NOTHING)
    assert not report.findings, [f.message for f in report.findings]


def test_runs_fit_the_words_of_boards() -> None:
    _, stream = lowered(Path().feed(6000, x=900).dwell(20).feed(1, x=899).traverse(x=0).done())
    runs: Columns = stream.sections[0].runs[0]
    assert runs["count"].max() <= 65535
    assert np.abs(runs["add"]).max() <= 32767


def test_one_row_may_be_longer_than_the_buffer(monkeypatch: pytest.MonkeyPatch) -> None:
    trace = Path().feed(6000, x=30).arc(6000, -7, (30, 10.0004), x=30, z=5).feed(6000, y=-10).done()
    _, whole = lowered(trace)
    monkeypatch.setattr(module, "BUFFER", 1000)
    monkeypatch.setattr(run_kernels, "MOST_COUNT", 100)
    _, pieces = lowered(trace)
    for number in range(3):
        a, b = expand(whole, 0, number), expand(pieces, 0, number)
        assert [d for _, d in a] == [d for _, d in b]
        assert max(abs(s - t) for (s, _), (t, _) in zip(a, b, strict=True)) <= 800
    assert not validate(pieces, trace, machine(), NOTHING).findings
