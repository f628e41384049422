"""Plan: closed forms by hand, limits by sampling with independent code, the estimate against the plan."""

from __future__ import annotations

import dataclasses
import math
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st
from passes.motion.reference_motion import Motion, paths
from passes.motion.traces import Path, machine
from support.campaigns import examples

from gproof.ir.finding import Findings, Severity
from gproof.ir.machine import NO_MACHINE, Board, Machine
from gproof.ir.plan import Plan
from gproof.ir.trace import Chunk, Op, PathMode, Plane, Trace, chunks
from gproof.passes.motion import plan_kernels as k
from gproof.passes.motion.plan import MotionEstimate, plan, shortest_interval, step_rate

RANDOM = examples(40, 400)
PERIOD = 0.005


def planned(trace: Trace, on: Machine | None = None) -> Plan:
    findings = Findings()
    made = plan(trace, on or machine(), findings)
    assert made is not None, findings.kept
    made.verify()
    return made


def column(made: Plan, name: str) -> list[float]:
    return made.sections[0].rows[name].tolist()  # type: ignore[no-any-return]


def refused(trace: Trace, on: Machine | None = None) -> list[str]:
    findings = Findings()
    assert plan(trace, on or machine(), findings) is None
    assert findings.has(Severity.UNKNOWN)
    return [f"{f.code.label} {f.message}" for f in findings.kept]


def estimated(trace: Trace, on: Machine | None = None, size: int = 1 << 30) -> MotionEstimate:
    estimate = MotionEstimate(on or machine())
    for whole in chunks(trace):
        for begin in range(0, max(1, len(whole.rows)), size):
            end = min(begin + size, len(whole.rows))
            estimate.feed(
                Chunk(
                    trace=trace, section=whole.section, begin=begin, rows=whole.rows.slice(begin, end),
                    start=whole.start if begin == 0 else tuple(whole.rows["to"][begin - 1].tolist()),
                    start_frame=whole.start_frame if begin == 0 else int(whole.rows["frame"][begin - 1]),
                    last=end == len(whole.rows),
                )
            )  # fmt: skip
    estimate.finish()
    return estimate


# --- closed forms -------------------------------------------------------------------------------------------


def test_one_axis_trapezoid() -> None:
    made = planned(Path().feed(3000, x=100).done())
    assert made.duration == pytest.approx(100 / 50 + 50 / 500, rel=1e-12)
    assert column(made, "cruise") == [50.0]


def test_one_axis_triangle() -> None:
    made = planned(Path().feed(6000, x=1).done())
    assert made.duration == pytest.approx(2 * math.sqrt(1 / 500), rel=1e-12)
    assert column(made, "cruise") == pytest.approx([math.sqrt(500)])


def test_a_traverse_goes_at_what_the_axes_allow() -> None:
    made = planned(Path().traverse(x=300, y=300).done())
    speed, acceleration = 100 * math.sqrt(2), 500 * math.sqrt(2)
    assert column(made, "cruise") == pytest.approx([speed])
    assert made.duration == pytest.approx(300 * math.sqrt(2) / speed + speed / acceleration)


def test_the_weaker_axis_decides_in_its_share() -> None:
    m = machine()
    slow = dataclasses.replace(m.axes[2], max_velocity=10.0, max_acceleration=50.0)
    made = planned(Path().traverse(x=80, z=60).done(), dataclasses.replace(m, axes=(*m.axes[:2], slow)))
    assert column(made, "cruise") == pytest.approx([10 / 0.6])
    assert column(made, "acceleration") == pytest.approx([50 / 0.6])


def test_collinear_segments_pass_at_full_speed() -> None:
    path = Path()
    for n in range(1, 11):
        path.feed(3000, x=10 * n, y=20 * n)
    made = planned(path.done())
    length, a = 10 * math.hypot(10, 20), 500 / (20 / math.hypot(10, 20))
    assert made.duration == pytest.approx(length / 50 + 50 / a)
    assert column(made, "exit")[:-1] == pytest.approx([50] * 9)


def test_a_square_stops_at_its_corners() -> None:
    made = planned(Path().feed(3000, x=50).feed(3000, y=50).feed(3000, x=0).feed(3000, y=0).done())
    assert column(made, "exit") == [0.0] * 4
    assert made.duration == pytest.approx(4 * (50 / 50 + 50 / 500))


@pytest.mark.parametrize("mode", [PathMode.EXACT_PATH, PathMode.CONTINUOUS])
def test_collinear_segments_pass_without_a_look_ahead_angle(mode: PathMode) -> None:
    made = planned(Path().mode(mode).feed(3000, x=50).feed(3000, x=100).done(), machine(laf_angle=None))
    assert column(made, "exit") == pytest.approx([50, 0])


def test_exact_stop_stops_even_in_a_straight_line() -> None:
    made = planned(Path().feed(3000, x=50).mode(PathMode.EXACT_STOP).feed(3000, x=100).done())
    assert column(made, "exit") == [0, 0]


@pytest.mark.parametrize(
    ("degrees", "default", "given_angle", "passes"),
    [
        (2.9, 3.0, math.nan, True), (3.1, 3.0, math.nan, False), (3.1, 3.0, 4.0, True), (2.9, 3.0, 0.0, False),
        (2.9, None, math.nan, False), (90.0, 3.0, 180.0, True), (180.0, 3.0, 180.0, True),
    ],
)  # fmt: skip
def test_the_look_ahead_angle_decides(
    degrees: float, default: float | None, given_angle: float, passes: bool
) -> None:  # fmt: skip
    turn = math.radians(degrees)
    path = Path().mode(PathMode.EXACT_PATH, given_angle).feed(3000, x=50)
    path.feed(3000, x=50 + 50 * math.cos(turn), y=50 * math.sin(turn))
    speed = column(planned(path.done(), machine(laf_angle=default)), "exit")[0]
    if passes:
        jump = max(1 - math.cos(turn), math.sin(turn))  # of the axis that changes most
        assert speed == pytest.approx(min(50, 500 * PERIOD / jump))
    else:
        assert speed == 0


def test_the_state_of_the_later_row_decides() -> None:
    made = planned(Path().mode(PathMode.EXACT_STOP).feed(3000, x=50).mode(PathMode.EXACT_PATH).feed(3000, x=100).done())
    assert column(made, "exit") == pytest.approx([50, 0])


def test_look_ahead_reaches_over_many_rows() -> None:
    path = Path()
    for n in range(1, 1001):
        path.feed(6000, x=0.01 * n)
    made = planned(path.done())
    # 10 mm: 100 mm/s would need 20 mm, so the speed peaks in the middle.
    assert max(column(made, "cruise")) == pytest.approx(math.sqrt(500 * 10), rel=1e-3)
    assert made.duration == pytest.approx(2 * math.sqrt(10 / 500), rel=1e-6)


def test_short_segments_around_a_circle_go_no_faster_than_curvature_allows() -> None:
    path = Path()
    for n in range(1, 2001):
        path.feed(60000, x=10 * math.sin(n * 0.01), y=10 - 10 * math.cos(n * 0.01))
    speeds = column(planned(path.done()), "exit")[200:-200]
    # Each axis has its own acceleration, so more is left where two of them share.
    assert math.sqrt(0.74 * 500 * 10) < min(speeds)
    assert max(speeds) < math.sqrt(0.76 * 500 * 10 * math.sqrt(2))


def test_an_arc_goes_no_faster_than_its_curvature_allows() -> None:
    made = planned(Path().arc(60000, 1, (10, 0)).done())
    assert column(made, "cruise") == pytest.approx([math.sqrt(math.sqrt(0.75) * 500 * 10)])
    assert column(made, "length") == pytest.approx([20 * math.pi])
    slow = planned(Path().arc(600, 1, (10, 0)).done())
    assert column(slow, "cruise") == [10.0]
    assert column(slow, "acceleration") == pytest.approx([math.sqrt(500**2 - 10**2)])


def test_a_helix_is_as_long_as_it_is() -> None:
    path = Path().arc(600, -3, (10, 0), x=0, y=0, z=-12)
    assert column(planned(path.done()), "length") == pytest.approx([math.hypot(60 * math.pi, 12)])


def test_line_and_arc_that_touch_pass() -> None:
    path = Path().feed(600, x=20).arc(600, 1, (20, 10), x=20, y=20).feed(600, x=0)
    assert column(planned(path.done()), "exit") == pytest.approx([10, 10, 0], rel=1e-9)


@pytest.mark.parametrize("plane", [Plane.XY, Plane.XZ, Plane.YZ])
def test_arcs_turn_the_way_of_their_plane(plane: Plane) -> None:
    names = {Plane.XY: "xy", Plane.XZ: "zx", Plane.YZ: "yz"}[plane]
    # Along the first axis of the pair, then counter-clockwise: a tangent arc, so no stop.
    path = Path().feed(600, **{names[0]: 20}).arc(600, 1, (20, 10), plane, **{names[0]: 30, names[1]: 10})
    assert column(planned(path.done()), "exit")[0] == pytest.approx(10, rel=1e-9)
    other = Path().feed(600, **{names[0]: 20}).arc(600, -1, (20, 10), plane, **{names[0]: 30, names[1]: 10})
    assert column(planned(other.done()), "exit")[0] == 0


def test_rotary_moves_count_degrees() -> None:
    made = planned(Path().feed(600, a=90).feed(600, a=180).feed(600, x=10).done())
    assert column(made, "length") == pytest.approx([90, 90, 10])
    assert column(made, "exit") == pytest.approx([10, 0, 0])


def test_rotary_axes_ride_along_and_limit_the_speed() -> None:
    made = planned(Path().feed(6000, x=10, a=1000).done())
    assert column(made, "length") == [10]
    assert column(made, "cruise")[0] <= 1.0
    assert column(made, "acceleration") == pytest.approx([5.0])


def test_events_are_at_rest_and_states_are_not() -> None:
    path = Path().feed(3000, x=50).other(Op.COOLANT, 1).feed(3000, x=100).other(Op.GUARD).state(tool=3)
    path.feed(3000, x=150).dwell(0.25).dwell(0.0).feed(3000, x=200).spindle(1).feed(3000, x=250).spindle(
        1, 2000
    ).spindle(-1)
    made = planned(path.done(), machine(spindle_ramp_time=2.0))
    assert column(made, "row") == [0, 2, 4, 5, 7, 8, 9, 11]
    assert column(made, "exit") == pytest.approx([0, 50, 0, 0, 0, 0, 0, 0])
    assert [column(made, "duration")[n] for n in (3, 5, 7)] == [0.25, 2.0, 2.0]


def test_rows_of_no_length_take_no_time_and_stop_nothing() -> None:
    path = Path().feed(3000, x=50).feed(3000, x=50).feed(3000, y=1e-13).feed(3000, x=100)
    made = planned(path.done())
    assert column(made, "row") == [0, 3]
    assert column(made, "exit") == pytest.approx([50, 0])
    assert planned(Path().done()).duration == 0
    circle = Path().feed(600, x=1e-10).arc(600, 1, (10, 0))
    assert column(planned(circle.done()), "length") == pytest.approx([20 * math.pi])
    crumbs = Path()
    for n in range(1, 101):
        crumbs.feed(600, x=n * 0.9e-9)
    assert sum(column(planned(crumbs.done()), "length")) == pytest.approx(0.9e-7 / 2)


def test_each_section_begins_at_rest() -> None:
    path = Path().feed(3000, x=50).end_section().feed(3000, x=100)
    made = planned(path.done())
    assert [s.duration for s in made.sections] == pytest.approx([1.1, 1.1])
    assert [s.rows["begin"][0] for s in made.sections] == [0, 0]


# --- findings -----------------------------------------------------------------------------------------------


def messages(trace: Trace, on: Machine | None = None) -> list[str]:
    findings = Findings()
    assert plan(trace, on or machine(), findings) is not None
    return [f"{f.span.line} {f.code.label} {f.message}" for f in findings.kept]


def test_feed_over_maximum_is_told_once_for_each_feed() -> None:
    path = Path().feed(9000, x=50).feed(9000, x=100).feed(3000, x=150).feed(7000, x=200).feed(7000, a=90)
    told = messages(path.done())
    assert told == [
        "1 GP501 feed 9000 mm/min is more than the axes allow here",
        "4 GP501 feed 7000 mm/min is more than the axes allow here",
    ]
    assert messages(Path().feed(7000, a=90).done()) == ["1 GP501 feed 7000 deg/min is more than the axes allow here"]
    assert messages(Path().feed(6000, x=50).done()) == []
    many = Path()
    for n in range(100):
        many.feed(9000 + n, x=50 * (n % 2))
    findings = Findings()
    assert plan(many.done(), machine(), findings) is not None
    assert len(findings.kept) == 20
    assert findings.counts == {501: 99}


def test_step_frequency_caps_the_speed() -> None:
    m = machine(steps=3200)
    made = planned(Path().traverse(x=100).done(), m)
    assert column(made, "cruise")[0] == pytest.approx(0.95 * 125_000 / 3200)
    assert messages(Path().feed(3000, x=50).done(), m) == [
        "1 GP501 feed 3000 mm/min is more than the axes allow here",
        "1 GP502 X at 100 mm/s needs 320000 steps/s; at most 118750 steps/s are allowed",
    ]


def test_pulse_width_caps_the_speed() -> None:
    m = machine(max_step_frequency=None, board=Board(step_pulse=50e-6))
    assert column(planned(Path().traverse(x=100).done(), m), "cruise")[0] == pytest.approx(9500 / 320)


@given(st.integers(1, 10**8), st.floats(1.0, 1e6), st.floats(1e-7, 1e-3))
def test_step_rate_keeps_the_shortest_interval(ticks: int, frequency: float, pulse: float) -> None:
    m = machine(max_step_frequency=frequency, board=Board(tick_frequency=ticks, step_pulse=pulse))
    shortest = shortest_interval(m)
    assert Fraction(shortest, ticks) >= 1 / Fraction(frequency)
    assert Fraction(shortest, ticks) >= 2 * Fraction(pulse)
    assert ticks / step_rate(m) >= shortest * (1 - 1e-15)
    assert step_rate(m) <= 0.95 * frequency * (1 + 1e-15)


def test_unknown_positions_are_refused_by_name() -> None:
    told = refused(Path().frame("start.x").traverse(y=5).done())
    assert told == ["GP503 steps need exact numbers: X depends on the start position of X"]
    offset = Path().traverse(y=5).frame("work.1.z").traverse(z=5)
    assert refused(offset.done()) == ["GP503 steps need exact numbers: Z depends on G54 Z offset"]
    # An axis that the machine does not have, and a job that does not move.
    assert planned(Path().frame("start.a").traverse(y=5).done(), machine(axes="xyz")).duration > 0
    assert planned(Path().frame("start.x").dwell(1).done()).duration == 1


@pytest.mark.parametrize("feed", [0.0, math.nan])
def test_unknown_feed_is_refused(feed: float) -> None:
    (told,) = refused(Path().traverse(x=5).feed(feed, x=10).done())
    assert told.startswith("GP503") and "feed" in told
    assert len(refused(Path().feed(1e-12, x=10).done())) == 1
    assert len(refused(Path().feed(1e-310, x=10).done())) == 1


def test_unknown_dwell_is_refused() -> None:
    assert len(refused(Path().dwell(math.nan).done())) == 1


def test_a_length_that_is_no_number_is_refused() -> None:
    assert len(refused(Path().traverse(x=1e300).done())) == 1


def test_axes_without_data_are_refused_by_name() -> None:
    assert refused(Path().traverse(x=1, b=5).done()) == ["GP504 B moves, but the machine file has no axis for it"]
    bare = machine()
    axes = (dataclasses.replace(bare.axes[0], max_velocity=None, max_acceleration=None), *bare.axes[1:])
    told = refused(Path().traverse(y=1).traverse(x=1).done(), dataclasses.replace(bare, axes=axes))
    assert told == ["GP504 X moves, but the machine file has no maximum velocity and no maximum acceleration for it"]
    assert planned(Path().traverse(y=1).done(), dataclasses.replace(bare, axes=axes)).duration > 0


# --- properties ---------------------------------------------------------------------------------------------


@RANDOM
@given(paths())
def test_plans_of_random_paths_hold_their_invariants(trace: Trace) -> None:
    made = planned(trace)
    rows = trace.sections[0].rows
    timed = made.sections[0].rows
    shortest = 0.0
    for row, length, duration in zip(timed["row"], timed["length"], timed["duration"], strict=True):
        if length and rows["op"][row] != Op.TRAVERSE:
            assert duration >= length / (rows["feed"][row] / 60) * (1 - 1e-9)
        shortest += float(duration)
    assert made.duration == pytest.approx(shortest)
    still = sum(float(rows["arg"][r, 0]) for r in range(len(rows)) if rows["op"][r] == Op.DWELL)
    assert made.duration >= still


@RANDOM
@given(paths(most=5), st.floats(1e-4, 0.1), st.randoms(use_true_random=False))
def test_axes_keep_their_velocity_and_acceleration(trace: Trace, window: float, random: object) -> None:
    m = machine(laf_angle=20.0)
    made = planned(trace, m)
    motion = Motion(trace.sections[0], made.sections[0])
    times = [random.uniform(-window, made.duration) for _ in range(60)]  # type: ignore[attr-defined]
    # Around what is most likely to break: where rows meet.
    for begin in motion.begins[:40]:
        times += [begin - window, begin - 1.5 * window, begin - 0.1 * window]
    for t in times:
        a, b, c = motion.at(t), motion.at(t + window), motion.at(t + 2 * window)
        for i in range(4):
            assert abs(b[i] - a[i]) <= 100 * window * (1 + 1e-9) + 1e-8
            # The speed gained over w seconds is at most a (w + 2 T): docs/plan.md.
            assert abs(c[i] - 2 * b[i] + a[i]) <= 500 * window * (window + 2 * PERIOD) + 1e-8


@RANDOM
@given(paths())
def test_passing_corners_costs_at_most_twice_what_stopping_does(trace: Trace) -> None:
    """A row that pays for its corners keeps a quarter of its acceleration (docs/plan.md), and so at least half the
    mean speed. A way there and back over less than a millimetre, passed at 180 degrees, comes near to that."""
    everywhere = Path()
    everywhere.trace = dataclasses.replace(
        trace, states=[dataclasses.replace(s, path_mode=PathMode.EXACT_STOP) for s in trace.states]
    )
    assert planned(trace).duration <= planned(everywhere.trace).duration * 2 + 1e-9


@RANDOM
@given(paths(most=12), st.integers(1, 7))
def test_the_estimate_is_the_plan_in_any_chunks(trace: Trace, size: int) -> None:
    made = planned(trace)
    estimate = estimated(trace, size=size)
    assert estimate.seconds == made.duration
    assert estimate.unknown_rows == 0
    timed, rows = made.sections[0].rows, trace.sections[0].rows
    fast = [float(n) for n, r in zip(timed["length"], timed["row"], strict=True) if rows["op"][r] == Op.TRAVERSE]
    assert estimate.traverse_length_mm == pytest.approx(sum(fast))
    total = estimate.path_length_mm + estimate.rotary_deg
    assert total == pytest.approx(float(timed["length"].sum()))
    assert estimate.feed_length_mm + estimate.traverse_length_mm == estimate.path_length_mm


def test_the_estimate_adds_sections() -> None:
    trace = Path().feed(3000, x=50).end_section().dwell(0.5).feed(3000, x=100).done()
    assert estimated(trace).seconds == pytest.approx(planned(trace).duration)


def test_the_estimate_needs_no_offsets_that_stay() -> None:
    known = estimated(Path().traverse(x=10).feed(600, x=30).done())
    shifted = estimated(Path().frame("work.1.x", "start.y").traverse(x=10).feed(600, x=30).done())
    assert shifted.seconds == known.seconds
    assert shifted.path_length_mm == known.path_length_mm
    assert shifted.unknown_rows == 0


def test_the_estimate_is_a_lower_bound_where_something_is_unknown() -> None:
    whole = estimated(Path().feed(600, x=10).feed(6000, x=20).feed(600, x=30).done())
    part = estimated(Path().feed(600, x=10).frame("work.1.x").feed(6000, x=20).frame().feed(600, x=30).done())
    assert part.unknown_rows == 2
    assert part.seconds is not None and whole.seconds is not None
    assert part.seconds < whole.seconds
    assert part.path_length_mm == pytest.approx(10)
    fed = estimated(Path().feed(math.nan, x=10).done())
    assert fed.unknown_rows == 1
    assert fed.seconds == estimated(Path().feed(60000, x=10).done()).seconds
    nothing = estimated(Path().frame("?").feed(600, x=10).dwell(math.nan).done())
    assert (nothing.unknown_rows, nothing.seconds, nothing.path_length_mm) == (2, 0.0, 0.0)


@RANDOM
@given(paths(events=False, most=10), st.data())
def test_leaving_rows_out_of_the_estimate_never_adds_time(trace: Trace, data: st.DataObject) -> None:
    rows = trace.sections[0].rows
    whole = estimated(trace)
    hidden = data.draw(st.sets(st.integers(0, len(rows) - 1), max_size=3)) if len(rows) else set()
    trace.frames.append(Path().frame("?").trace.frames[-1])
    for row in hidden:
        rows["frame"][row] = 1
    part = estimated(trace, size=3)
    assert whole.seconds is not None and part.seconds is not None
    assert part.seconds <= whole.seconds * (1 + 1e-9)
    assert part.path_length_mm <= whole.path_length_mm * (1 + 1e-9)


def test_without_machine_data_the_estimate_has_lengths_only() -> None:
    estimate = estimated(Path().traverse(x=10).feed(600, x=30).done(), NO_MACHINE)
    assert estimate.seconds is None
    assert (estimate.traverse_length_mm, estimate.feed_length_mm) == pytest.approx((10, 20))
    assert estimated(Path().dwell(1).done(), NO_MACHINE).seconds == 1.0


def test_the_estimate_tells_of_feeds_when_asked() -> None:
    findings = Findings()
    trace = Path().feed(9000, x=50).done()
    estimate = MotionEstimate(machine(), findings)
    for chunk in chunks(trace):
        estimate.feed(chunk)
    assert [f.code.label for f in findings.kept] == ["GP501"]


def test_the_estimate_holds_back_no_more_than_the_braking_distance() -> None:
    path = Path()
    for n in range(1, 3001):
        path.feed(3000, x=0.05 * n)
    trace = path.done()
    estimate, most = MotionEstimate(machine()), 0
    rows = trace.sections[0].rows
    for begin in range(0, 3000, 50):
        start = (0.0,) * 6 if begin == 0 else tuple(rows["to"][begin - 1].tolist())
        estimate.feed(
            Chunk(
                trace=trace, section=0, begin=begin, start=start, start_frame=0, rows=rows.slice(begin, begin + 50),
                last=begin == 2950,
            )
        )  # fmt: skip
        most = max(most, estimate._measure.used)
    estimate.finish()
    # 50 mm/s brakes over 2.5 mm, 50 rows; the queue may double before it is looked at again.
    assert most <= 2 * (50 + 50) + 2
    assert estimate.seconds == planned(trace).duration


def test_queue_columns_are_as_many_as_named() -> None:
    assert k.Q_ROW + 1 == k.QUEUE_WIDTH
    assert k.P_ACCELERATION + 1 == k.OUT_WIDTH
    assert k.C_SKIPPED + 1 == k.CARRY_WIDTH
