"""What the walk over a section notes, in words: motor, numbers, and where a step that is off the path belongs."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from gproof.ir.drives import Drive
from gproof.ir.machine import Machine
from gproof.ir.setup import Setup
from gproof.ir.stream import Motor
from gproof.ir.trace import Op, Plane, Trace
from gproof.verify.kernel.lifted_path import Lifted
from gproof.verify.kernel.motor_map import knots_of
from gproof.verify.kernel.motors import drive_of_motors
from gproof.verify.kernel.path_kernels import LAST_MOTION_OP, WINDOW, axis_steps
from gproof.verify.kernel.proof import Job, Problem
from gproof.verify.kernel.rows import PAIRS
from gproof.verify.kernel.surface import AROUND, TURNED
from gproof.verify.kernel.walk_kernels import PATH_TOLERANCE
from gproof.verify.kernel.walk_state import Rows

Floats = npt.NDArray[np.float64]

NEARBY = 200
"""Rows before and after that are searched for a position that left its row."""

SAMPLES = 200
ZOOMS = 6


class Noted:
    """One problem of the walk: which motor, and its two numbers. seen: what was followed, with Y and A exchanged where
    Y is mapped onto A."""

    def __init__(self, problem: Problem, seen: Job, machine: Machine, setup: Setup) -> None:
        motor, _, self.a, self.b, *self.more = problem.values
        self.seen, self.section = seen, problem.section
        self.motor: Motor | None = seen.stream.motors[motor] if motor >= 0 else None
        self.drive: Drive | None = drive_of_motors(seen.stream, seen.drives)[motor] if motor >= 0 else None
        self.unit = "" if self.motor is None else _unit(self.motor.axis, machine, setup)
        self.name = self.motor.name if self.motor is not None else ""
        frequency = seen.stream.tick_frequency
        self.interpolation = round(seen.drives.interpolation_time * frequency) / frequency
        self.duration = seen.stream.sections[problem.section].duration

    def at(self, steps: float) -> str:
        """A step count with its position."""
        assert self.motor is not None
        return f"step {steps:.0f} ({steps / float(self.motor.steps_per_unit):.4f} {self.unit})"

    def scale(self) -> float:
        """Steps in a unit."""
        assert self.motor is not None
        return abs(float(self.motor.steps_per_unit))


def _unit(axis: int, machine: Machine, setup: Setup) -> str:
    if setup.cylinder is not None and axis in (AROUND, TURNED):
        return "mm" if axis == AROUND else "deg"
    return next(one.unit for one in machine.axes if one.index == axis)


def _spacing(p: Noted) -> str:
    return f"{p.name} steps {p.a:.0f} ticks after its last step; {p.b:.0f} needed"


def _setup(p: Noted) -> str:
    return f"{p.name} changes direction {p.a:.0f} ticks after its last step; {p.b:.0f} needed"


def _speed(p: Noted) -> str:
    assert p.drive is not None
    h = p.b * p.interpolation
    limit = p.drive.max_velocity or math.inf
    return (
        f"{p.name} makes {p.a:.0f} steps in {h * 1000:g} ms, {abs(p.a) / p.scale() / h:.3f} {p.unit}/s; "
        f"{limit * h * p.scale() + 2:.1f} steps allowed at {limit:g} {p.unit}/s"
    )


def _acceleration(p: Noted) -> str:
    assert p.drive is not None
    h = p.b * p.interpolation
    limit = p.drive.max_acceleration or math.inf
    allowed = limit * h * (h + 2 * p.interpolation) * p.scale() + 4
    return (
        f"{p.name} makes {p.a:+.0f} steps from one window of {h * 1000:g} ms to the next, "
        f"{abs(p.a) / p.scale() / h / h:.1f} {p.unit}/s2; {allowed:.1f} allowed at {limit:g} {p.unit}/s2"
    )


def _feed(p: Noted) -> str:
    window = f"{p.b * p.interpolation * 1000:g} ms" if p.b else "the time since the last rest"
    return f"the path moves at {p.a:.4f} times its feed in {window}"


def _limit(p: Noted) -> str:
    assert p.drive is not None
    return f"{p.name} at {p.at(p.a)}; limits {p.drive.lower} to {p.drive.upper} {p.unit}"


def _travel(p: Noted) -> str:
    assert p.drive is not None
    return f"{p.name} at {p.at(p.a)}; travel {p.drive.travel_lower} to {p.drive.travel_upper} {p.unit}"


def _place(p: Noted) -> str:
    return f"{p.name} is at {p.at(p.a)} where the path is at step {p.b:.3f}"


WALK: dict[str, Callable[[Noted], str]] = {
    "walk.dense": lambda p: f"more than {WINDOW} pieces of path within one step of {p.name}: too dense to follow",
    "walk.extra": lambda p: (
        f"{p.name} changed direction {p.a:.0f} times since the last rest; the path does {p.b:.0f} times"
    ),
    "walk.rate": _spacing,
    "walk.pulse": _spacing,
    "walk.setup": _setup,
    "walk.speed": _speed,
    "walk.acceleration": _acceleration,
    "walk.feed": _feed,
    "walk.early": lambda p: f"the motion before this event has only reached row {p.a:.0f}",
    "walk.off-place": _place,
    "walk.wait-cut": lambda p: f"{p.name or 'what follows'} comes {p.a:.0f} ticks before the wait is over",
    "walk.unfinished": lambda p: "the steps end before the path",
    "walk.end": _place,
    "walk.slack": lambda p: (
        f"{p.name} has not taken up its backlash: the motor is at {p.at(p.a)}, its axis at {p.at(p.b)}"
    ),
    "walk.limit": _limit,
    "walk.travel": _travel,
    "walk.after-end": lambda p: f"{p.name} steps {p.a:.0f} ticks after the section's end at {p.duration}",
}
"""By kind, what is said of it."""


def left(p: Noted, trace: Trace) -> tuple[bool, str]:
    """Why no path point explains a step: another row's position (True), or none."""
    at, path, position = p.more
    assert isinstance(path, Lifted)
    rows, start = path.rows, path.start
    stream, drives = p.seen.stream, p.seen.drives
    spu = np.array([float(motor.steps_per_unit) for motor in stream.motors])
    axes = [motor.axis for motor in stream.motors]
    knots = [knots_of(drive.pitch, float(r)) for drive, r in zip(drive_of_motors(stream, drives), spu, strict=True)]
    first = np.cumsum([0, *(len(one) for one in knots)]).astype(np.int64)
    table = np.concatenate([np.zeros((0, 2)), *knots])
    aim = np.array([axis_steps(float(n), m, table, first) for m, n in enumerate(position.tolist())])

    def distance(row: int) -> float:
        low, high, best = 0.0, 1.0, math.inf
        for _ in range(ZOOMS):
            shares = np.linspace(low, high, SAMPLES)
            off = np.abs(_points(rows, row, start, shares)[:, axes] * spu - aim).max(axis=1)
            k = int(off.argmin())
            best = min(best, float(off[k]))
            low, high = float(shares[max(0, k - 1)]), float(shares[min(SAMPLES - 1, k + 1)])
        return best

    here = distance(at)

    def belongs(row: int) -> bool:
        return bool(rows.op[row] <= LAST_MOTION_OP) and distance(row) <= PATH_TOLERANCE and here > 1.5

    def named(row: int) -> str:
        own = path.row(row)
        return f"row {own} (line {int(trace.sections[p.section].rows['line'][own])})"

    for other in range(at + 1, min(at + NEARBY, len(rows.op))):
        if belongs(other):
            return True, f"{p.name} at {p.at(p.a)} belongs to {named(other)}; the path before it is missing"
    for other in range(at - 1, max(-1, at - NEARBY), -1):
        if belongs(other):
            return True, f"{p.name} at {p.at(p.a)} goes back to {named(other)}"
    return False, (
        f"{p.name} moves to {p.at(p.a)}; that is about {here:.2f} steps from this row's path, "
        f"or from the part of it that is due; {PATH_TOLERANCE:g} allowed"
    )


def _points(rows: Rows, row: int, start: Floats, shares: Floats) -> Floats:
    """Points along a row, for a message's number only."""
    begin = rows.to[row - 1] if row > 0 else start
    end = rows.to[row]
    points: Floats = begin + (end - begin) * shares[:, np.newaxis]
    if rows.op[row] == Op.ARC:
        first, second = PAIRS[Plane(int(rows.plane[row]))]
        center = rows.center[row]
        r0, r1 = (math.hypot(p[first] - center[first], p[second] - center[second]) for p in (begin, end))
        angle = math.atan2(begin[second] - center[second], begin[first] - center[first])
        sweep = math.atan2(end[second] - center[second], end[first] - center[first]) - angle
        turns = int(rows.turns[row])
        sign = 1 if turns > 0 else -1
        sweep += 2 * math.pi * (turns - sign + (sign if sweep * sign <= 0 else 0))
        radius, way = r0 + (r1 - r0) * shares, angle + sweep * shares
        points[:, first] = center[first] + radius * np.cos(way)
        points[:, second] = center[second] + radius * np.sin(way)
    return points
