"""Streams of machines whose motors go through pitch tables, and of gantries: right ones pass, damaged ones do not.

The streams come from the passes; the tables in the damage are other ones than the machine's, and the numbers in
the tests by hand come from the manual's example (2.3): where the motor is at 50 the axis is at 50.01.
"""

from __future__ import annotations

import dataclasses
import random
from fractions import Fraction

import numpy as np
import pytest
from passes.motion.traces import Path
from passes.motion.traces import machine as plain_machine
from support.campaigns import seeds

from gproof.ir.finding import Findings
from gproof.ir.machine import Machine, PitchTable, Slave
from gproof.ir.setup import NOTHING
from gproof.ir.stream import StepStream
from gproof.ir.trace import Plane, Trace
from gproof.ir.verdict import Verdict
from gproof.passes.motion.plan import plan
from gproof.passes.motion.step import step
from gproof.verify.kernel.motor_map import bend, knots_of, motor_at
from gproof.verify.stream import validate

MANUAL = PitchTable(
    machine=(0.0, 50.0, 200.0, 300.0, 400.0, 500.0), calibrated=(0.0, 50.01, 200.02, 300.03, 400.04, 500.05)
)


def lowered(trace: Trace, on: Machine) -> StepStream:
    findings = Findings()
    planned = plan(trace, on, findings)
    assert planned is not None, [f.message for f in findings.kept]
    stream = step(trace, planned, on, findings)
    assert stream is not None, [f.message for f in findings.kept]
    stream.verify()
    return stream


def with_x(**values: object) -> Machine:
    return with_axes(x=values)


def with_axes(**axes: dict[str, object]) -> Machine:
    on = plain_machine()
    made = dataclasses.replace(on, axes=tuple(dataclasses.replace(a, **axes.get(a.name, {})) for a in on.axes))
    made.verify()
    return made


def found(stream: StepStream, trace: Trace, on: Machine) -> set[str]:
    return {f.code.label for f in validate(stream, trace, on, NOTHING).findings}


def test_the_manuals_table_by_hand() -> None:
    assert motor_at(MANUAL, 50.01) == 50
    assert float(motor_at(MANUAL, 100.0)) == pytest.approx(50 + 49.99 * 150 / 150.01)
    assert float(motor_at(MANUAL, -5.0)) == -5.0
    assert float(motor_at(MANUAL, 510.05)) == pytest.approx(510.0)
    assert knots_of(MANUAL, -2.0)[0].tolist() == [-1000.0, -1000.1]
    # Slopes of motor over axis: 1, 50/50.01, 150/150.01, 100/100.01 (three times), 1.
    assert bend(MANUAL, 10.0) == pytest.approx(1 - 50 / 50.01, rel=1e-6)
    slopes = [1, 50 / 50.01, 150 / 150.01, 100 / 100.01, 1]
    whole = (slopes[0] - slopes[1]) + (slopes[2] - slopes[1]) + (slopes[2] - slopes[3]) + (slopes[4] - slopes[3])
    assert bend(MANUAL, 1e9) == pytest.approx(whole, rel=1e-6)


def test_the_motor_stays_short_of_an_axis_that_runs_ahead_of_it() -> None:
    on = with_x(pitch=MANUAL)
    trace = Path().feed(6000, x=50.01).feed(6000, x=0).whole()
    stream = lowered(trace, on)
    assert stream.sections[0].runs[0]["count"].sum() == 2 * 16000  # 50 mm of the motor, not 50.01
    assert validate(stream, trace, on, NOTHING).verdict is Verdict.SAFE
    assert found(stream, trace, plain_machine()) != set()
    assert found(lowered(trace, plain_machine()), trace, on) != set()


def test_a_table_read_the_other_way_round_is_refused() -> None:
    trace = Path().feed(6000, x=50.01).feed(6000, x=30, y=4).whole()
    turned = with_x(pitch=PitchTable(machine=MANUAL.calibrated, calibrated=MANUAL.machine))
    assert found(lowered(trace, turned), trace, with_x(pitch=MANUAL)) & {"GP801", "GP802", "GP808"}


def test_one_point_of_the_table_shifted_is_refused() -> None:
    # Start and end agree; halfway X is 6 steps beside where Y says that it should be.
    trace = Path().feed(6000, x=20.02, y=13).whole()
    other = PitchTable(machine=(0.0, 5.0, 20.0), calibrated=(0.0, 5.03, 20.02))
    mine = PitchTable(machine=(0.0, 5.0, 20.0), calibrated=(0.0, 5.01, 20.02))
    assert found(lowered(trace, with_x(pitch=other)), trace, with_x(pitch=mine)) <= {"GP801", "GP802", "GP808"}
    assert found(lowered(trace, with_x(pitch=other)), trace, with_x(pitch=mine))
    assert found(lowered(trace, with_x(pitch=mine)), trace, with_x(pitch=mine)) == set()


def test_a_steep_table_slows_the_axis_so_that_its_motor_keeps_its_velocity() -> None:
    steep = PitchTable(machine=(0.0, 60.0), calibrated=(0.0, 50.0))
    on = with_x(pitch=steep)
    trace = Path().traverse(x=50).whole()
    assert validate(lowered(trace, on), trace, on, NOTHING).verdict is Verdict.SAFE
    fast = with_x(pitch=steep, max_velocity=130.0)
    assert "GP805" in found(lowered(trace, fast), trace, on)


def a_table(rng: random.Random) -> PitchTable:
    machine = sorted({round(rng.uniform(-10, 15), 2) for _ in range(rng.randint(1, 12))})
    at, calibrated = machine[0] + rng.uniform(-0.05, 0.05), []
    for k, m in enumerate(machine):
        at += (m - machine[k - 1]) * rng.uniform(0.995, 1.005) if k else 0.0
        calibrated.append(at)
    return PitchTable(machine=tuple(machine), calibrated=tuple(calibrated))


def a_path(rng: random.Random) -> Trace:
    path = Path(x=rng.uniform(-5, 5), y=rng.uniform(-5, 5))
    for _ in range(rng.randint(1, 8)):
        x, y, z = (rng.uniform(-8, 12) for _ in range(3))
        kind = rng.random()
        if kind < 0.35:
            center = ((path.place[0] + x) / 2 + rng.uniform(-1, 1), (path.place[1] + y) / 2)
            path.arc(rng.choice([900, 4000]), rng.choice([1, -1, 2]), center, Plane.XY, x=x, y=y)
        elif kind < 0.7:
            path.feed(rng.choice([600, 4800]), x=x, y=y, z=z)
        elif kind < 0.8:
            path.dwell(0.1)
        else:
            path.traverse(x=x, z=z)
    return path.whole()


@pytest.mark.parametrize("seed", seeds(6, 16))
def test_streams_through_random_tables_pass(seed: int) -> None:
    rng = random.Random(seed)
    slave = Slave(
        steps_per_unit=Fraction(rng.choice([-160, 200, 333])), pitch=a_table(rng), max_velocity=80.0,
        max_acceleration=400.0,
    )  # fmt: skip
    on = with_axes(
        x={"pitch": a_table(rng), "slaves": (slave,)},
        y={"pitch": a_table(rng), "steps_per_unit": Fraction(-1600, 7)},
        z={"pitch": a_table(rng)},
    )
    trace = a_path(rng)
    stream = lowered(trace, on)
    report = validate(stream, trace, on, NOTHING)
    assert report.findings == (), [f.message for f in report.findings]
    assert report.verdict is Verdict.SAFE
    # Each motor's count, step by step, is within a step of where its own table puts it, at the sections' ends exactly.
    for number, (motor, drive) in enumerate(zip(stream.motors, [d for a in on.axes for d in a.drives()], strict=True)):
        for section, place in zip(stream.sections, [s.start for s in trace.sections], strict=True):
            steps = motor_at(drive.pitch, place[motor.axis]) * motor.steps_per_unit
            assert abs(section.start[number] - steps) <= Fraction(1, 2)


@pytest.mark.parametrize("seed", seeds(3, 8))
def test_damage_to_one_motor_of_many_is_refused(seed: int) -> None:
    rng = random.Random(1000 + seed)
    on = with_axes(x={"pitch": a_table(rng), "slaves": (Slave(pitch=a_table(rng)),)}, y={"pitch": a_table(rng)})
    trace = a_path(rng)
    stream = lowered(trace, on)
    section = stream.sections[0]
    moving = [m for m, runs in enumerate(section.runs) if len(runs)]
    motor = rng.choice(moving)
    runs = section.runs[motor]
    hurt = {name: runs[name].copy() for name in ("interval", "count", "add", "direction")}
    at = rng.randrange(len(runs))
    if rng.random() < 0.5:
        hurt["count"][at] += 3
    else:
        hurt["direction"][at] *= -1
    damaged = type(runs)(runs.schema, hurt)
    section.runs = tuple(damaged if m == motor else one for m, one in enumerate(section.runs))
    assert found(stream, trace, on)


def gantry(**slave: object) -> Machine:
    return with_x(lower=0.0, upper=100.0, slaves=(Slave(joint="a", **slave),))  # type: ignore[arg-type]


def test_a_second_motor_has_its_own_resolution_and_direction() -> None:
    on = gantry(steps_per_unit=Fraction(-160))
    trace = Path(x=1).feed(1200, x=11).whole()
    stream = lowered(trace, on)
    assert [(m.name, m.steps_per_unit) for m in stream.motors[:2]] == [("X", 320), ("X2", -160)]
    assert (stream.sections[0].start[:2], stream.sections[0].end()[:2]) == ((320, -160), (3520, -1760))
    assert validate(stream, trace, on, NOTHING).verdict is Verdict.SAFE
    assert "GP810" in found(stream, trace, gantry(steps_per_unit=Fraction(160)))


@pytest.mark.parametrize(
    ("slave", "code"),
    [
        ({"upper": 8.0}, "GP809"), ({"lower": 2.0}, "GP809"), ({"max_velocity": 10.0}, "GP805"),
        ({"max_acceleration": 20.0}, "GP806"),
    ],
)  # fmt: skip
def test_a_second_motor_is_held_to_its_own_bounds(slave: dict[str, object], code: str) -> None:
    trace = Path(x=1).traverse(x=11).whole()
    stream = lowered(trace, gantry())
    assert found(stream, trace, gantry()) == set()
    assert found(stream, trace, gantry(**slave)) == {code}


def test_the_plan_goes_as_fast_as_the_slower_motor() -> None:
    on = gantry(max_velocity=10.0, max_acceleration=20.0)
    trace = Path(x=1).traverse(x=11).whole()
    stream = lowered(trace, on)
    assert validate(stream, trace, on, NOTHING).verdict is Verdict.SAFE
    seconds = stream.sections[0].duration / stream.tick_frequency
    assert seconds == pytest.approx(10 / 10 + 10 / 20, abs=0.01)


def test_both_speeds_of_the_stepper_agree_through_a_table(monkeypatch: pytest.MonkeyPatch) -> None:
    from gproof.passes.motion.run_kernels import bounds, compress
    from gproof.passes.motion.step_kernels import step_times

    trace = a_path(random.Random(5))
    on = with_axes(x={"pitch": a_table(random.Random(1))}, y={"pitch": a_table(random.Random(2))})
    slow = lowered(trace, on)
    for one in (step_times, bounds, compress):
        monkeypatch.setattr(one, "pick", lambda work, one=one: one.compiled())
    fast = lowered(trace, on)
    assert np.array_equal(slow.sections[0].runs[0].arrays["interval"], fast.sections[0].runs[0].arrays["interval"])
    assert slow.sections[0].runs == fast.sections[0].runs
