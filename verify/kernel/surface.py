"""Y mapped onto A as the stream checker sees it: the job with A's motors in the place of Y's.

A mm on the surface of a cylinder of radius r is 180 / (pi r) degrees; what is left of Y is the machine's own, which
rests at the axis of rotation. From the Setup's numbers alone, by this module's own arithmetic; docs/kinematics.md.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction
from typing import Any

from gproof.ir.columns import Columns
from gproof.ir.drives import CylinderMap, Drive, DrivenAxis, Interval, PitchTable
from gproof.ir.trace import HEIGHT_MAP, Frame
from gproof.verify.kernel.proof import Job
from gproof.verify.kernel.stream_numbers import Why

AROUND, TURNED = 1, 3
"""Columns of Y, which goes around, and A, which turns."""

DEGREES = 1e-6


def problems(job: Job) -> Iterator[Why]:
    """Why a mapping cannot be followed."""
    trace, drives = job.trace, job.drives
    cylinder = drives.cylinder
    if cylinder is None:
        return
    numbers = (cylinder.radius, cylinder.y, cylinder.zero)
    if any(value is None or not math.isfinite(value) for value in numbers) or not (cylinder.radius or 0.0) > 0.0:
        yield "cylinder.numbers", *numbers
        return
    if not {AROUND, TURNED} <= {axis.column for axis in drives.axes}:
        yield ("cylinder.axes",)
    on = drives.height_map is not None and drives.height_map.on
    if on or any(HEIGHT_MAP in state.following for state in trace.states):
        yield ("cylinder.height-map",)
    for section in trace.sections:
        if (section.rows["to"][:, TURNED] != section.start[TURNED]).any():
            yield "cylinder.turned", section.number
    stated = drives.start[TURNED]
    if stated is not None and trace.sections:
        angle = (trace.sections[0].start[AROUND] - (cylinder.zero or 0.0)) / _length_of_degree(cylinder)
        if angle < stated.low - DEGREES or angle > stated.high + DEGREES:
            yield "cylinder.start", angle, stated.low, stated.high


def view(job: Job) -> Job:
    """The job on the surface, unrolled, names and axes of the motors of Y and A exchanged; as it is without a
    mapping."""
    stream, trace, drives = job
    cylinder = drives.cylinder
    if cylinder is None:
        return job
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
    for axis in drives.axes:
        if axis.column == TURNED:
            axis = DrivenAxis(AROUND, tuple(_unrolled(drive, length) for drive in axis.drives), False)
        elif axis.column == AROUND:
            renamed = tuple(drive._replace(name="A" + drive.name[1:]) for drive in axis.drives)
            axis = axis._replace(column=TURNED, drives=renamed)
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
    start = list(drives.start)
    around = start[AROUND]
    start[AROUND] = None if around is None else Interval(around.low - zero, around.high - zero)
    start[TURNED] = Interval(across, across)
    return Job(
        replace(stream, motors=tuple(motors)),
        replace(trace, frames=frames, sections=sections),
        drives._replace(axes=tuple(axes), start=tuple(start), cylinder=None),
    )


def _length_of_degree(cylinder: CylinderMap) -> float:
    """mm of the surface that pass the tool in a degree of A."""
    return (cylinder.radius or 0.0) * math.pi / 180.0


def _unrolled(drive: Drive, length: float) -> Drive:
    """Limits, velocity, acceleration, backlash and pitch table in mm of the surface; exact steps per mm."""

    def scaled(values: tuple[float, ...]) -> tuple[float, ...]:
        return tuple(value * length for value in values)

    steps, pitch = drive.steps_per_unit, drive.pitch
    if pitch is not None:
        pitch = PitchTable(machine=scaled(pitch.machine), calibrated=scaled(pitch.calibrated))
    bounds = ("lower", "upper", "travel_lower", "travel_upper", "max_velocity", "max_acceleration", "backlash")
    stated: dict[str, Any] = {name: getattr(drive, name) for name in bounds}
    return drive._replace(
        name="Y" + drive.name[1:],
        steps_per_unit=None if steps is None else steps / Fraction(length),
        pitch=pitch,
        **{name: value * length for name, value in stated.items() if value is not None},
    )
