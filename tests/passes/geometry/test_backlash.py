"""Motors that take up their backlash: by hand, beside a model of the play, through the checker, and damaged.

The model is the mechanics in floats, written from docs/kinematics.md: the axis stays while its motor is between the two
flanks and goes with it at either. It shares nothing with the passes or with the checker.
"""

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

from gproof.ir.columns import Columns
from gproof.ir.finding import Findings
from gproof.ir.machine import Machine, PitchTable, Slave
from gproof.ir.plan import Plan
from gproof.ir.setup import NOTHING
from gproof.ir.stream import RUN, StepStream
from gproof.ir.trace import Op, Trace, chunks
from gproof.ir.verdict import Verdict
from gproof.passes.motion import run_kernels
from gproof.passes.motion import step as module
from gproof.passes.motion.plan import MotionEstimate, plan
from gproof.passes.motion.step import step

RANDOM = settings(deadline=None, max_examples=15)


def loose(base: Machine | None = None, **backlash: float) -> Machine:
    """A machine with backlash on some axes, in mm."""
    base = base or machine()
    axes = tuple(dataclasses.replace(a, backlash=backlash.get(a.name, 0.0)) for a in base.axes)
    made = dataclasses.replace(base, axes=axes)
    made.verify()
    return made


def lowered(trace: Trace, on: Machine) -> tuple[Plan, StepStream]:
    findings = Findings()
    planned = plan(trace, on, findings)
    assert planned is not None, [f.message for f in findings.kept]
    stream = step(trace, planned, on, findings)
    assert stream is not None, [f.message for f in findings.kept]
    stream.verify()
    return planned, stream


def found(stream: StepStream, trace: Trace, on: Machine) -> list[str]:
    return [f"{f.code.label} {f.message}" for f in validate(stream, trace, on, NOTHING).findings]


def counts(stream: StepStream, motor: int = 0) -> list[tuple[int, int]]:
    """Steps in one direction after one another: (direction, how many)."""
    made: list[tuple[int, int]] = []
    for _, direction in expand(stream, 0, motor):
        if made and made[-1][0] == direction:
            made[-1] = (direction, made[-1][1] + 1)
        else:
            made.append((direction, 1))
    return made


# --- by hand ------------------------------------------------------------------------------------------------


def test_each_turn_costs_the_backlash_once() -> None:
    # 0.05 mm are 16 steps of 1/320 mm.
    there_and_back = Path().feed(600, x=10).feed(600, x=4).feed(600, x=7).done()
    assert counts(lowered(there_and_back, loose(x=0.05))[1]) == [(1, 3200), (-1, 1920 + 16), (1, 960 + 16)]


def test_a_section_ends_as_it_begins_with_the_axis_as_come_from_below() -> None:
    path = Path(x=10).feed(600, x=4).end_section().feed(600, x=2).done()
    _, stream = lowered(path, loose(x=0.05))
    assert counts(stream) == [(-1, 1920 + 16), (1, 16)]
    assert stream.sections[0].end() == stream.sections[1].start == (1280, 0, 0, 0)
    assert found(stream, path, loose(x=0.05)) == []


def test_an_event_waits_until_the_backlash_is_taken_up() -> None:
    # X goes back by one step only and rests: its backlash takes 2 sqrt(0.05 / 250) s, which is 28 ms.
    path = Path(x=10).feed(600, x=10 - 1 / 320).other(Op.COOLANT, 0, 1).feed(600, y=1).done()
    _, stream = lowered(path, loose(x=0.05))
    (tick,) = stream.sections[0].events["tick"].tolist()
    steps = expand(stream, 0, 0)
    assert [d for t, d in steps if t <= tick] == [-1] * 17
    assert 0.02 < tick / stream.tick_frequency < 0.04


def test_an_axis_that_rests_long_enough_takes_it_up_before_it_goes_back() -> None:
    path = Path().feed(600, x=1).feed(600, y=10).feed(600, x=0, y=11).done()
    planned, stream = lowered(path, loose(x=0.05))
    turn = planned.sections[0].rows["begin"][2] * stream.tick_frequency
    early = [t for t, d in expand(stream, 0, 0) if d < 0 and t < turn]
    assert len(early) in (15, 16)  # the last of them comes as the axis is about to move


def test_motors_wired_the_other_way_round_and_slaves_with_another_backlash() -> None:
    base = machine(slaves=1, steps=-320)
    x = dataclasses.replace(base.axes[0], slaves=(Slave(backlash=0.1),))
    on = loose(dataclasses.replace(base, axes=(x, *base.axes[1:])), x=0.05)
    path = Path().feed(600, x=1).feed(600, x=0).done()
    _, stream = lowered(path, on)
    assert counts(stream, 0) == [(-1, 320), (1, 336), (-1, 16)]
    assert counts(stream, 1) == [(-1, 320), (1, 352), (-1, 32)]
    assert found(stream, path, on) == []


def test_less_than_half_a_step_is_none() -> None:
    path = Path().feed(600, x=1).feed(600, x=0).done()
    assert lowered(path, loose(x=0.0015))[1] == lowered(path, machine())[1]


def test_the_axis_leaves_its_motor_the_acceleration_that_backlash_needs() -> None:
    """1 mm from rest to rest with a / 2: 2 sqrt(2 * 1 / 500); the estimate of a check uses all of it, sqrt(2) less."""
    path = Path().feed(60000, x=1).done()
    planned, _ = lowered(path, loose(x=0.05))
    assert planned.sections[0].duration == pytest.approx(2 * math.sqrt(1 / 250))
    estimate = MotionEstimate(loose(x=0.05))
    for chunk in chunks(path):
        estimate.feed(chunk)
    estimate.finish()
    assert estimate.seconds == pytest.approx(2 * math.sqrt(1 / 500))


# --- beside a model of the play -----------------------------------------------------------------------------

MACHINES = [
    loose(x=0.05, y=0.1, z=0.004, a=0.02),
    loose(
        machine(steps=Fraction(-1600, 7), velocity=400.0, acceleration=2000.0, max_step_frequency=90e3),
        x=0.03, y=0.01, a=0.05,
    ),
    loose(machine(steps=40, acceleration=150.0, laf_angle=30.0), x=0.3, y=0.02, z=0.1),
]  # fmt: skip


@RANDOM
@given(paths(events=False, most=5), st.sampled_from(MACHINES))
def test_the_axis_follows_its_path(trace: Trace, on: Machine) -> None:
    planned, stream = lowered(trace, on)
    motion = Motion(trace.sections[0], planned.sections[0])
    for number, motor in enumerate(stream.motors):
        axis = next(axis for axis in on.axes if axis.index == motor.axis)
        rate = float(motor.steps_per_unit)
        play = axis.backlash * rate  # from the flank of an axis that came from below to the other one
        allowed = 1.5 + 60e-6 * on.axes[0].max_velocity * abs(rate)  # type: ignore[operator]
        need = 2 * math.sqrt(2 * axis.backlash / axis.max_acceleration)  # type: ignore[operator]
        n = at = float(stream.sections[0].start[number])
        turned, was = -math.inf, 1 if rate > 0 else -1
        steps = expand(stream, 0, number)
        for k, (tick, direction) in enumerate(steps):
            t = tick / stream.tick_frequency
            if direction != was:
                turned = t
            was = direction
            n += direction
            at = min(max(at, min(n, n + play)), max(n, n + play))
            if k % (1 + len(steps) // 300) == 0 or t - turned < 3 * need:
                exact = motion.at(t)[motor.axis] * rate
                lag = abs(play) if t - turned < 2 * need + 0.002 else 0.0
                assert abs(at - exact) <= allowed + lag
        assert abs(at - motion.at(motion.duration)[motor.axis] * rate) <= 1.0, (motor.name, at, n)


@RANDOM
@given(paths(), st.sampled_from(MACHINES))
def test_the_independent_checker_agrees(trace: Trace, on: Machine) -> None:
    _, stream = lowered(trace, on)
    assert found(stream, trace, on) == []


@settings(deadline=None, max_examples=15)
@given(paths(most=4), st.integers(100, 600))
def test_a_small_buffer_gives_a_stream_as_good(trace: Trace, size: int) -> None:
    on = loose(x=0.05, y=0.02)
    _, whole = lowered(trace, on)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module, "BUFFER", size)
        patch.setattr(run_kernels, "MOST_COUNT", 64)
        _, pieces = lowered(trace, on)
    for number in range(len(whole.motors)):
        assert [d for _, d in expand(whole, 0, number)] == [d for _, d in expand(pieces, 0, number)]
    assert found(pieces, trace, on) == []


@settings(deadline=None, max_examples=10)
@given(paths(most=4), st.sampled_from(MACHINES))
def test_both_speeds_agree(trace: Trace, on: Machine) -> None:
    made = []
    for mode in ("python", "numba"):
        with pytest.MonkeyPatch.context() as patch:
            patch.setenv("GPROOF_KERNELS", mode)
            made.append(lowered(trace, on)[1])
    assert made[0] == made[1]


def test_backlash_beside_a_pitch_table() -> None:
    table = PitchTable(machine=(0.0, 50.0, 100.0), calibrated=(0.0, 50.1, 99.9))
    base = machine()
    x = dataclasses.replace(base.axes[0], pitch=table)
    on = loose(dataclasses.replace(base, axes=(x, *base.axes[1:])), x=0.05)
    path = Path(x=20).feed(3000, x=60, y=3).feed(3000, x=10, y=9).arc(3000, 1, (20, 9)).done()
    _, stream = lowered(path, on)
    assert found(stream, path, on) == []
    # 10.02 mm of the axis are 10 of its motor: 49.9 / 0.998 and 50.1 / 1.002.
    ends = [3200 * Fraction(10, 10) * Fraction(500, 501), 3200 * 2 * Fraction(500, 501)]
    assert stream.sections[0].end()[0] == round(ends[0])
    assert stream.sections[0].start[0] == round(ends[1])


# --- damage -------------------------------------------------------------------------------------------------

ZIGZAG = Path().feed(3000, x=10, y=7).feed(3000, x=4, y=12).feed(3000, x=8, y=14).done()


def with_steps(stream: StepStream, steps: list[tuple[int, int]]) -> StepStream:
    """The stream with other steps of its first motor."""
    ticks = [0, *(tick for tick, _ in steps)]
    arrays = {
        "interval": np.diff(ticks),
        "count": np.ones(len(steps), np.int64),
        "add": np.zeros(len(steps), np.int64),
        "direction": np.array([d for _, d in steps]),
    }
    runs = Columns(RUN, {c.name: np.asarray(arrays[c.name]).astype(c.dtype) for c in RUN.columns})
    section = dataclasses.replace(stream.sections[0], runs=(runs, *stream.sections[0].runs[1:]))
    return dataclasses.replace(stream, sections=[section])


def turns(steps: list[tuple[int, int]]) -> list[int]:
    return [k for k, (a, b) in enumerate(pairwise(steps), 1) if a[1] != b[1]]


def test_a_stream_for_another_backlash_is_refused() -> None:
    for made, on in ((0.0, 0.05), (0.05, 0.0), (0.05, 0.06), (0.06, 0.05)):
        _, stream = lowered(ZIGZAG, loose(x=made))
        codes = {line[:5] for line in found(stream, ZIGZAG, loose(x=on))}
        assert codes & {"GP801", "GP802", "GP808"}, (made, on)


@pytest.mark.parametrize("missing", [2, 8, 16])
def test_steps_left_out_of_the_backlash_are_refused(missing: int) -> None:
    on = loose(x=0.05)
    _, stream = lowered(ZIGZAG, on)
    steps = expand(stream, 0, 0)
    first, second = turns(steps)
    spoilt = steps[: first + 1] + steps[first + 1 + missing : second + 1] + steps[second + 1 + missing :]
    assert found(with_steps(stream, spoilt), ZIGZAG, on)


def test_backlash_that_is_taken_up_too_late_is_refused() -> None:
    """X goes back by 32 steps in 2 s; the last six steps of its backlash come 0.2 s late, still in order."""
    on = loose(x=0.05)
    path = Path().feed(600, x=1).feed(600, x=0.9, y=20).done()
    _, stream = lowered(path, on)
    steps = expand(stream, 0, 0)
    first, last = turns(steps)
    back = [t for t, _ in steps[first:last]]
    for late, refused in ((0, False), (3_200_000, True)):
        ticks = sorted([*back[:10], *(t + late for t in back[10:16]), *back[16:]])
        assert len({b - a for a, b in pairwise(ticks)} & set(range(200))) == 0
        spoilt = [*steps[:first], *((t, -1) for t in ticks), *steps[last:]]
        told = found(with_steps(stream, spoilt), path, on)
        assert any("has not taken up its backlash" in line for line in told) == refused, told


def test_a_motor_that_trembles_within_its_backlash_is_refused() -> None:
    """The axis does not move, but each turn would excuse another lag."""
    on = loose(x=0.05)
    path = Path().feed(600, x=1).feed(600, x=0.99, y=20).feed(600, x=0.5).done()
    _, stream = lowered(path, on)
    steps = expand(stream, 0, 0)
    first = turns(steps)[0]
    middle = next(k for k, (a, b) in enumerate(pairwise(steps[first:]), first) if b[0] - a[0] > 4_000_000)
    tick = steps[middle][0]
    added = [(tick + 400_000 * n, 1 if n % 2 else -1) for n in range(1, 7)]
    assert found(with_steps(stream, [*steps[: middle + 1], *added, *steps[middle + 1 :]]), path, on)


def test_the_start_is_an_assumption() -> None:
    on = loose(x=0.05)
    report = validate(lowered(ZIGZAG, on)[1], ZIGZAG, on, NOTHING)
    assert report.verdict is Verdict.SAFE
    position = next(p for p in report.properties if p.name == "stream-position")
    assert position.assumptions == ("x reached its start position from below (backlash 0.05)",)
