"""Y mapped onto A: the job as its motors see it, with the motors of A in the place of those of Y.

On the surface of the cylinder Y is a straight axis like X: its motors are those of A, with as many steps per mm as A
has for the angle that a mm on the surface is; the machine's own Y rests where the axis of rotation is. ``plan`` and
``step`` work on that, and the stream gets the machine's motors back. Eding CNC manual 2.2.5.4; docs/kinematics.md.
"""

from __future__ import annotations

import dataclasses
import math
from fractions import Fraction

from gproof.ir import codes
from gproof.ir.columns import Columns
from gproof.ir.finding import Refusal, Span
from gproof.ir.machine import Axis, AxisKind, Machine, PitchTable, Slave
from gproof.ir.setup import CylinderMap, Setup
from gproof.ir.stream import Motor, StepStream, StreamSection
from gproof.ir.trace import Frame, Trace, TraceSection

Y, A = 1, 3
_ALIKE = 1e-6
"""Degrees between a start of A that is stated and the one that Y has there."""


def on_surface(trace: Trace, machine: Machine, setup: Setup, where: Span) -> tuple[Trace, Machine]:
    """Trace and machine with the surface's Y, less where A is 0; Refusal GP520 where the setup leaves it open.

    where: the setup states the cylinder.
    """
    cylinder = setup.cylinder
    assert cylinder is not None
    turned, across = machine.axis("a"), machine.axis("y")
    stated = "state {} of [cylinder] in the setup file"
    for missing, what, hint in (
        (not cylinder.radius, "the radius of the cylinder", stated.format("radius")),
        (cylinder.y is None, "the Y of its axis of rotation", stated.format("y")),
        (cylinder.zero is None, "the Y at which A is 0", stated.format("zero")),
        (
            turned is None or across is None,
            "an axis Y and an axis A",
            "state [axes.y] and [axes.a] in the machine file",
        ),
    ):
        if missing:
            what = f"Y is mapped onto A without {what}"
            raise Refusal(codes.NOT_STEPPED.at(where, what=what, hint=hint))
    assert turned is not None
    assert across is not None
    mm = mm_per_degree(cylinder)
    _refuse_another_start(trace, setup, cylinder, mm, where)
    axes = [axis for axis in machine.axes if axis.index not in (Y, A)]
    axes += [
        _scaled(turned, mm, name="y", kind=AxisKind.LINEAR, tip_feed=False),
        dataclasses.replace(across, name="a", kind=AxisKind.ROTARY),
    ]
    return _moved(trace, cylinder), dataclasses.replace(machine, axes=tuple(sorted(axes, key=lambda axis: axis.index)))


def with_machines_motors(stream: StepStream, machine: Machine) -> StepStream:
    """The stream of ``on_surface`` with the machine's motors, in the machine's order."""
    there = {Y: A, A: Y}
    drives = {axis.index: axis.drives() for axis in machine.axes}
    motors: list[tuple[int, Motor]] = []
    met: dict[int, int] = {}
    for place, motor in enumerate(stream.motors):
        axis = there.get(motor.axis, motor.axis)
        drive = drives[axis][met.setdefault(axis, 0)]
        met[axis] += 1
        assert drive.steps_per_unit is not None
        motors.append((place, Motor(name=drive.name, axis=axis, steps_per_unit=drive.steps_per_unit)))
    names = [drive.name for axis in machine.axes for drive in axis.drives()]
    motors.sort(key=lambda pair: names.index(pair[1].name))
    places = [place for place, _ in motors]
    sections = [
        StreamSection(
            number=s.number, start=tuple(s.start[p] for p in places), runs=tuple(s.runs[p] for p in places),
            events=s.events, duration=s.duration,
        )
        for s in stream.sections
    ]  # fmt: skip
    return dataclasses.replace(stream, motors=tuple(motor for _, motor in motors), sections=sections)


def mm_per_degree(cylinder: CylinderMap) -> float:
    """mm on the surface for a degree of A."""
    assert cylinder.radius is not None
    return math.radians(cylinder.radius)


def _refuse_another_start(trace: Trace, setup: Setup, cylinder: CylinderMap, mm: float, where: Span) -> None:
    """GP520 when the setup says that A starts elsewhere than the mapping has it."""
    stated = setup.interval("start.a")
    if stated is None or not trace.sections or trace.frames[trace.sections[0].start_frame][Y]:
        return
    assert cylinder.zero is not None
    angle = (trace.sections[0].start[Y] - cylinder.zero) / mm
    if not stated.low - _ALIKE <= angle <= stated.high + _ALIKE:
        what = f"A starts at {stated.low:g} degrees in the setup file, but the mapping puts it at {angle:.4f} degrees"
        hint = "make start and zero of [cylinder] in the setup file agree"
        raise Refusal(codes.NOT_STEPPED.at(where, what=what, hint=hint))


def _scaled(axis: Axis, mm: float, *, name: str, kind: AxisKind, tip_feed: bool) -> Axis:
    """A rotary axis as a straight one with ``mm`` for a degree."""
    lengths = "lower upper travel_lower travel_upper max_velocity max_acceleration backlash home_position home_velocity"

    def scaled(part: Axis | Slave) -> dict[str, object]:
        found: dict[str, object] = {n: getattr(part, n) for n in lengths.split()}
        found = {n: value if value is None else float(value) * mm for n, value in found.items()}  # type: ignore[arg-type]
        if part.steps_per_unit is not None:
            found["steps_per_unit"] = part.steps_per_unit / Fraction(mm)
        if part.pitch is not None:
            at, to = ([value * mm for value in side] for side in (part.pitch.machine, part.pitch.calibrated))
            found["pitch"] = PitchTable(machine=tuple(at), calibrated=tuple(to))
        return found

    slaves = tuple(dataclasses.replace(slave, **scaled(slave)) for slave in axis.slaves)  # type: ignore[arg-type]
    changes = scaled(axis) | {"name": name, "kind": kind, "tip_feed": tip_feed, "slaves": slaves}
    return dataclasses.replace(axis, **changes)  # type: ignore[arg-type]


def _moved(trace: Trace, cylinder: CylinderMap) -> Trace:
    assert cylinder.zero is not None
    assert cylinder.y is not None
    zero, across = cylinder.zero, cylinder.y

    def frame(old: Frame) -> Frame:
        return (old[0], old[1], old[2], (), old[4], old[5])

    def section(old: TraceSection) -> TraceSection:
        columns = {c.name: old.rows[c.name] for c in old.rows.schema.columns}
        columns["to"], columns["center"] = columns["to"].copy(), columns["center"].copy()
        columns["to"][:, Y] -= zero
        columns["to"][:, A] = across
        columns["center"][:, Y] -= zero
        start = list(old.start)
        start[Y], start[A] = start[Y] - zero, across
        return dataclasses.replace(old, start=tuple(start), rows=Columns(old.rows.schema, columns))

    return dataclasses.replace(
        trace, frames=[frame(old) for old in trace.frames], sections=[section(old) for old in trace.sections]
    )
