"""Y mapped onto A in streams: motors by hand, through the checker, and streams made for other cylinders."""

from __future__ import annotations

import dataclasses
import math
from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from passes.motion.reference_motion import Motion, expand
from passes.motion.traces import Path, machine, validate

from gproof.ir.finding import Findings
from gproof.ir.machine import Machine, PitchTable, Slave
from gproof.ir.plan import Plan
from gproof.ir.setup import CylinderMap, HeightMap, Interval, Setup
from gproof.ir.stream import StepStream
from gproof.ir.trace import Trace
from gproof.ir.verdict import Verdict
from gproof.passes.motion.height_compensation import follow
from gproof.passes.motion.plan import plan
from gproof.passes.motion.step import step

CUP = CylinderMap(radius=20.0, y=120.0, z=0.0, zero=-4.0)
ON_CUP = Setup(cylinder=CUP)
MM = math.pi * 20 / 180
"""mm on the surface for a degree."""


def lowered(trace: Trace, on: Machine, setup: Setup = ON_CUP) -> tuple[Plan, StepStream]:
    findings = Findings()
    path = follow(trace, setup, on, findings)
    assert path is not None, [f.message for f in findings.kept]
    path.trace.verify()
    planned = plan(path.trace, path.machine, findings)
    assert planned is not None, [f.message for f in findings.kept]
    stream = step(path.trace, planned, path.machine, findings)
    assert stream is not None, [f.message for f in findings.kept]
    stream = path.on_machine(stream, on)
    stream.verify()
    return planned, stream


def told(trace: Trace, on: Machine, setup: Setup) -> list[str]:
    findings = Findings()
    assert follow(trace, setup, on, findings) is None
    return [f"{f.code.label} {f.message}" for f in findings.kept]


def found(stream: StepStream, trace: Trace, on: Machine, setup: Setup = ON_CUP) -> set[str]:
    return {f.code.label for f in validate(stream, trace, on, setup).findings}


def with_axes(base: Machine, **axes: dict[str, object]) -> Machine:
    made = dataclasses.replace(
        base,
        axes=tuple(dataclasses.replace(a, **axes.get(a.name, {})) for a in base.axes),  # type: ignore[arg-type]
    )
    made.verify()
    return made


def test_a_turns_by_the_arc_on_the_surface_and_y_stays_on_the_axis_of_rotation() -> None:
    on = with_axes(machine(), a={"steps_per_unit": Fraction(400, 9)})
    trace = Path(x=5, y=0, z=3).feed(600, y=4 + MM * 90).feed(600, x=8, y=-4).done()
    _, stream = lowered(trace, on)
    assert [(m.name, m.axis, m.steps_per_unit) for m in stream.motors] == [
        ("X", 0, 320), ("Y", 1, 320), ("Z", 2, 320), ("A", 3, Fraction(400, 9)),
    ]  # fmt: skip
    at = round(4 / MM * 400 / 9)
    assert stream.sections[0].start == (1600, 120 * 320, 960, at)
    assert stream.sections[0].end() == (2560, 120 * 320, 960, 0)
    steps = expand(stream, 0, 3)
    assert max(at + sum(d for _, d in steps[:k]) for k in range(len(steps))) == round((8 / MM + 90) * 400 / 9)
    assert expand(stream, 0, 1) == []
    assert found(stream, trace, on) == set()


def test_a_gives_its_velocity_and_acceleration() -> None:
    """90 degrees of A at 36 deg/s, 72 deg/s2: 2.5 s + 0.5 s, and the feed on the surface does not bind."""
    on = with_axes(machine(), a={"max_velocity": 36.0, "max_acceleration": 72.0})
    planned, stream = lowered(Path(y=-4).feed(60000, y=-4 + 90 * MM).done(), on)
    assert planned.sections[0].duration == pytest.approx(3.0)
    assert stream.sections[0].duration == pytest.approx(3.0 * 16e6)


TABLE = PitchTable(machine=(0.0, 90.0, 200.0), calibrated=(0.0, 90.3, 199.8))
MACHINES = [
    with_axes(machine(), a={"steps_per_unit": Fraction(400, 9)}),
    with_axes(
        machine(), a={"steps_per_unit": Fraction(-1000, 3), "backlash": 0.2, "slaves": (Slave(backlash=0.0),)},
        y={"steps_per_unit": Fraction(-640)}, x={"backlash": 0.02},
    ),
    with_axes(machine(), a={"steps_per_unit": Fraction(100), "pitch": TABLE}),
]  # fmt: skip

numbers = st.floats(-30, 30).map(lambda x: round(x, 3))


@st.composite
def jobs(draw: st.DrawFn) -> Trace:
    path = Path(x=draw(numbers), y=draw(numbers))
    for _ in range(draw(st.integers(1, 5))):
        if draw(st.booleans()):
            path.feed(draw(st.sampled_from([600.0, 6000.0])), x=draw(numbers), y=draw(numbers), z=draw(numbers))
        else:
            center = path.place[0] + draw(st.floats(1, 20)), path.place[1]
            path.arc(3000, draw(st.sampled_from([-1, 1])), center)
    return path.done()


@settings(deadline=None, max_examples=25)
@given(jobs(), st.sampled_from(MACHINES))
def test_the_independent_checker_agrees(trace: Trace, on: Machine) -> None:
    _, stream = lowered(trace, on)
    report = validate(stream, trace, on, ON_CUP)
    assert not report.findings, [f.message for f in report.findings]


@settings(deadline=None, max_examples=15)
@given(jobs())
def test_a_is_where_y_is_at_all_times(trace: Trace) -> None:
    on = MACHINES[0]
    planned, stream = lowered(trace, on)
    motion = Motion(trace.sections[0], planned.sections[0])
    count = stream.sections[0].start[3]
    steps = expand(stream, 0, 3)
    for k, (tick, direction) in enumerate(steps):
        count += direction
        if k % (1 + len(steps) // 200) == 0:
            y = motion.at(tick / stream.tick_frequency)[1]
            assert abs((y + 4.0) / MM * 400 / 9 - count) <= 1.0


def test_a_stream_for_another_cylinder_is_refused() -> None:
    on = MACHINES[0]
    trace = Path(x=5, y=0, z=3).feed(600, y=20, x=9).done()
    _, stream = lowered(trace, on)
    for change in ({"radius": 20.5}, {"zero": -4.5}, {"y": 120.1}):
        other = Setup(cylinder=dataclasses.replace(CUP, **change))  # type: ignore[arg-type]
        assert found(stream, trace, on, other) & {"GP801", "GP808"}, change
    assert found(stream, trace, on, Setup()) != set()
    for gap in ({"radius": None}, {"zero": None}, {"y": None}, {"radius": 0.0}, {"radius": math.nan}):
        other = Setup(cylinder=dataclasses.replace(CUP, **gap))  # type: ignore[arg-type]
        assert found(stream, trace, on, other) == {"GP810"}, gap


def test_limits_of_a_are_proved_on_the_steps() -> None:
    on = with_axes(MACHINES[0], a={"lower": -10.0, "upper": 60.0})
    inside, outside = (Path(y=-4).feed(600, y=-4 + angle * MM).done() for angle in (59.9, 60.1))
    assert validate(lowered(inside, on)[1], inside, on, ON_CUP).verdict is Verdict.SAFE
    assert found(lowered(outside, on)[1], outside, on) == {"GP809"}


def test_what_is_open_is_refused() -> None:
    trace = Path(y=0).feed(600, y=20).done()
    for gap, word in (("radius", "radius"), ("y", "axis of rotation"), ("zero", "A is 0")):
        setup = Setup(cylinder=dataclasses.replace(CUP, **{gap: None}))  # type: ignore[arg-type]
        (message,) = told(trace, machine(), setup)
        assert message.startswith("GP520") and word in message
    elsewhere = Setup(cylinder=CUP, start={"a": Interval(10.0, 10.0)})
    (message,) = told(trace, machine(), elsewhere)
    assert message.startswith("GP520") and "the mapping puts it at 11.4592" in message
    assert "GP810" in found(lowered(trace, machine())[1], trace, machine(), elsewhere)
    a_map = HeightMap(x=0.0, y=0.0, size=10.0, heights=((0.0, 1.0), (0.0, 1.0)), on=True)
    (message,) = told(trace, machine(), Setup(cylinder=CUP, height_map=a_map))
    assert message.startswith("GP520") and "height map" in message


def test_a_that_moves_while_y_is_mapped_onto_it_is_refused() -> None:
    trace = Path(y=0).feed(600, y=20).done()
    _, stream = lowered(trace, machine())
    both = Path(y=0).feed(600, y=20, a=3).done()
    assert found(stream, both, machine()) == {"GP810"}
