"""Y mapped onto A as the stream checker sees it: stream, trace, machine and setup with A's motors in the place of Y's.

A mm on the surface of a cylinder of radius r is 180 / (pi r) degrees; what is left of Y is the machine's own, which
rests at the axis of rotation. From the Setup's numbers alone, by this module's own arithmetic; docs/kinematics.md.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction
from typing import NamedTuple

from gproof.ir.columns import Columns
from gproof.ir.machine import Axis, AxisKind, Machine, PitchTable, Slave
from gproof.ir.setup import CylinderMap, Interval, Setup
from gproof.ir.stream import StepStream
from gproof.ir.trace import HEIGHT_MAP, Frame, Trace

AROUND, TURNED = 1, 3
"""Columns of Y, which goes around, and A, which turns."""

DEGREES = 1e-6


class View(NamedTuple):
    """What the checker follows; names and axes of the motors of Y and A are exchanged."""

    stream: StepStream
    trace: Trace
    machine: Machine
    setup: Setup


def problems(trace: Trace, machine: Machine, setup: Setup) -> Iterator[str]:
    """Why a mapping can not be followed."""
    cylinder = setup.cylinder
    if cylinder is None:
        return
    numbers = (cylinder.radius, cylinder.y, cylinder.zero)
    if any(value is None or not math.isfinite(value) for value in numbers) or not (cylinder.radius or 0.0) > 0.0:
        yield f"Y is mapped onto A with radius {cylinder.radius}, axis of rotation {cylinder.y}, zero {cylinder.zero}"
        return
    if machine.axis("y") is None or machine.axis("a") is None:
        yield "Y is mapped onto A, and the machine lacks one of them"
    on = setup.height_map is not None and setup.height_map.on
    if on or any(HEIGHT_MAP in state.following for state in trace.states):
        yield "a height map is followed on a cylinder"
    for section in trace.sections:
        if (section.rows["to"][:, TURNED] != section.start[TURNED]).any():
            yield f"section {section.number} moves A while Y is mapped onto it"
    stated = setup.interval("start.a")
    if stated is not None and trace.sections:
        angle = (trace.sections[0].start[AROUND] - (cylinder.zero or 0.0)) / _length_of_degree(cylinder)
        if angle < stated.low - DEGREES or angle > stated.high + DEGREES:
            yield f"the trace starts with A at {angle:.6f}; the setup says {stated.low:.6f} to {stated.high:.6f}"


def view(stream: StepStream, trace: Trace, machine: Machine, setup: Setup) -> View:
    """The job on the surface, unrolled; as it is without a mapping."""
    cylinder = setup.cylinder
    if cylinder is None:
        return View(stream, trace, machine, setup)
    length = _length_of_degree(cylinder)
    zero, across = cylinder.zero or 0.0, cylinder.y or 0.0
    motors = []
    for motor in stream.motors:
        if motor.axis == TURNED:
            rate = motor.steps_per_unit / Fraction(length)
            motor = replace(motor, name="Y" + motor.name[1:], axis=AROUND, steps_per_unit=rate)
        elif motor.axis == AROUND:
            motor = replace(motor, name="A" + motor.name[1:], axis=TURNED)
        motors.append(motor)
    axes = []
    for axis in machine.axes:
        if axis.index == TURNED:
            axis = replace(_unrolled(axis, length), name="y", kind=AxisKind.LINEAR, tip_feed=False)
        elif axis.index == AROUND:
            axis = replace(axis, name="a", kind=AxisKind.ROTARY)
        axes.append(axis)
    sections = []
    for section in trace.sections:
        columns = dict(section.rows.arrays)
        to, center = columns["to"].copy(), columns["center"].copy()
        to[:, AROUND] = to[:, AROUND] - zero
        to[:, TURNED] = across
        center[:, AROUND] = center[:, AROUND] - zero
        columns |= {"to": to, "center": center}
        x, y, z, _, b, c = section.start
        rows = Columns(section.rows.schema, columns)
        sections.append(replace(section, start=(x, y - zero, z, across, b, c), rows=rows))
    frames: list[Frame] = [(x, y, z, (), b, c) for x, y, z, _, b, c in trace.frames]
    start = {name: value for name, value in setup.start.items() if name not in ("y", "a")}
    around = setup.interval("start.y")
    if around is not None:
        start["y"] = Interval(around.low - zero, around.high - zero)
    start["a"] = Interval(across, across)
    return View(
        replace(stream, motors=tuple(motors)),
        replace(trace, frames=frames, sections=sections),
        replace(machine, axes=tuple(axes)),
        replace(setup, start=start, cylinder=None),
    )


def _length_of_degree(cylinder: CylinderMap) -> float:
    """mm of the surface that pass the tool in a degree of A."""
    return (cylinder.radius or 0.0) * math.pi / 180.0


def _unrolled(axis: Axis, length: float) -> Axis:
    """Limits, velocity, acceleration, backlash and pitch table in mm of the surface; exact steps per mm."""

    def one(value: float | None) -> float | None:
        return None if value is None else value * length

    def table(pitch: PitchTable | None) -> PitchTable | None:
        if pitch is None:
            return None
        return PitchTable(
            machine=tuple(at * length for at in pitch.machine), calibrated=tuple(at * length for at in pitch.calibrated)
        )

    def rate(steps: Fraction | None) -> Fraction | None:
        return None if steps is None else steps / Fraction(length)

    def slave(s: Slave) -> Slave:
        return replace(
            s, steps_per_unit=rate(s.steps_per_unit), lower=one(s.lower), upper=one(s.upper),
            travel_lower=one(s.travel_lower), travel_upper=one(s.travel_upper), max_velocity=one(s.max_velocity),
            max_acceleration=one(s.max_acceleration), backlash=one(s.backlash), pitch=table(s.pitch),
        )  # fmt: skip

    return replace(
        axis, steps_per_unit=rate(axis.steps_per_unit), lower=one(axis.lower), upper=one(axis.upper),
        travel_lower=one(axis.travel_lower), travel_upper=one(axis.travel_upper), max_velocity=one(axis.max_velocity),
        max_acceleration=one(axis.max_acceleration), backlash=axis.backlash * length, pitch=table(axis.pitch),
        slaves=tuple(slave(s) for s in axis.slaves),
    )  # fmt: skip
