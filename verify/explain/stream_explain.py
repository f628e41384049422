"""The stream checker's problems in words: code, place in the source, motor, tick, and the numbers."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from gproof.ir.codes import (
    STREAM_ACCELERATION,
    STREAM_END,
    STREAM_EVENT,
    STREAM_LIMIT,
    STREAM_ORDER,
    STREAM_POSITION,
    STREAM_PULSE,
    STREAM_STEP_RATE,
    STREAM_VELOCITY,
)
from gproof.ir.finding import Code
from gproof.ir.machine import Axis, Drive, Machine
from gproof.ir.stream import Motor, StepStream
from gproof.ir.trace import Op, Plane, Trace
from gproof.verify.explain.stream_report import Collector
from gproof.verify.kernel import stream_kernels as kernels
from gproof.verify.kernel.lifted_path import Lifted
from gproof.verify.kernel.motor_map import knots_of
from gproof.verify.kernel.stream_inputs import PAIRS, drives_of, span_of

Floats = npt.NDArray[np.float64]

NEARBY = 200
"""Rows before and after that are searched for a position that left its row."""

SAMPLES = 200
ZOOMS = 6

FATAL = (
    kernels.P_LEFT,
    kernels.P_DENSE,
    kernels.P_EARLY,
    kernels.P_OFF_PLACE,
    kernels.P_UNFINISHED,
    kernels.P_END,
    kernels.P_SLACK,
)
"""Problems after which the rest of the section is not walked."""


class _Place:
    """One kept problem: where, which motor, and its two numbers."""

    def __init__(
        self, stream: StepStream, machine: Machine, found: list[int], numbers: list[float], duration: int
    ) -> None:
        self.kind, motor, self.tick, self.row = found
        self.motor: Motor | None = stream.motors[motor] if motor >= 0 else None
        self.axis: Axis | None = None
        self.drive: Drive | None = None
        if self.motor is not None:
            self.axis = next(axis for axis in machine.axes if axis.index == stream.motors[motor].axis)
            self.drive = drives_of(stream, machine)[motor]
        self.name = self.motor.name if self.motor is not None else ""
        self.a, self.b = numbers
        self.frequency = stream.tick_frequency
        self.interpolation = round(machine.controller.interpolation_time * self.frequency) / self.frequency
        self.duration = duration

    def at(self, steps: float) -> str:
        """A step count with its position."""
        assert self.motor is not None and self.axis is not None
        return f"step {steps:.0f} ({steps / float(self.motor.steps_per_unit):.4f} {self.axis.unit})"

    def scale(self) -> float:
        assert self.motor is not None
        return abs(float(self.motor.steps_per_unit))


def _spacing(p: _Place) -> str:
    return f"{p.name}: {p.a:.0f} ticks after the step before; {p.b:.0f} needed"


def _setup(p: _Place) -> str:
    return f"{p.name} turns round {p.a:.0f} ticks after the step before; {p.b:.0f} needed"


def _speed(p: _Place) -> str:
    assert p.axis is not None and p.drive is not None
    h = p.b * p.interpolation
    limit = p.drive.max_velocity or math.inf
    return (
        f"{p.name} makes {p.a:.0f} steps in {h * 1000:g} ms, {abs(p.a) / p.scale() / h:.3f} {p.axis.unit}/s; "
        f"{limit * h * p.scale() + 2:.1f} steps allowed at {limit:g} {p.axis.unit}/s"
    )


def _acceleration(p: _Place) -> str:
    assert p.axis is not None and p.drive is not None
    h = p.b * p.interpolation
    limit = p.drive.max_acceleration or math.inf
    allowed = limit * h * (h + 2 * p.interpolation) * p.scale() + 4
    return (
        f"{p.name} makes {p.a:+.0f} steps from one window of {h * 1000:g} ms to the next, "
        f"{abs(p.a) / p.scale() / h / h:.1f} {p.axis.unit}/s2; {allowed:.1f} allowed at {limit:g} {p.axis.unit}/s2"
    )


def _feed(p: _Place) -> str:
    window = f"{p.b * p.interpolation * 1000:g} ms" if p.b else "the time since the last rest"
    return f"the path goes at {p.a:.4f} times its feed in {window}"


def _limit(p: _Place) -> str:
    assert p.axis is not None and p.drive is not None
    return f"{p.name} at {p.at(p.a)}; limits {p.drive.lower} to {p.drive.upper} {p.axis.unit}"


def _travel(p: _Place) -> str:
    assert p.axis is not None and p.drive is not None
    return f"{p.name} at {p.at(p.a)}; travel {p.drive.travel_lower} to {p.drive.travel_upper} {p.axis.unit}"


def _place(p: _Place) -> str:
    return f"{p.name} is at {p.at(p.a)} where the path is at step {p.b:.3f}"


TEXTS: dict[int, tuple[Code, Callable[[_Place], str]]] = {
    kernels.P_DENSE: (
        STREAM_POSITION,
        lambda p: f"more than {kernels.WINDOW} pieces of path within one step of {p.name}: too dense to follow",
    ),
    kernels.P_EXTRA: (
        STREAM_ORDER,
        lambda p: f"{p.name} turned round {p.a:.0f} times since the last rest; the path does {p.b:.0f} times",
    ),
    kernels.P_RATE: (STREAM_STEP_RATE, _spacing),
    kernels.P_PULSE: (STREAM_PULSE, _spacing),
    kernels.P_SETUP: (STREAM_PULSE, _setup),
    kernels.P_SPEED: (STREAM_VELOCITY, _speed),
    kernels.P_ACCELERATION: (STREAM_ACCELERATION, _acceleration),
    kernels.P_FEED: (STREAM_VELOCITY, _feed),
    kernels.P_EARLY: (STREAM_EVENT, lambda p: f"the motion before this event has only come to row {p.a:.0f}"),
    kernels.P_OFF_PLACE: (STREAM_EVENT, _place),
    kernels.P_WAIT_CUT: (
        STREAM_EVENT,
        lambda p: f"{p.name or 'what follows'} comes {p.a:.0f} ticks before the wait is over",
    ),
    kernels.P_UNFINISHED: (STREAM_END, lambda p: "the steps end before the path does"),
    kernels.P_END: (STREAM_END, _place),
    kernels.P_SLACK: (
        STREAM_POSITION,
        lambda p: f"{p.name} has not taken up its backlash: the motor is at {p.at(p.a)}, its axis at {p.at(p.b)}",
    ),
    kernels.P_LIMIT: (STREAM_LIMIT, _limit),
    kernels.P_TRAVEL: (STREAM_LIMIT, _travel),
    kernels.P_AFTER_END: (
        STREAM_END,
        lambda p: f"{p.name} steps {p.a:.0f} ticks after the section's end at {p.duration}",
    ),
}


def explain(
    stream: StepStream,
    trace: Trace,
    machine: Machine,
    number: int,
    path: Lifted,
    problems: kernels.Problems,
    position: npt.NDArray[np.int64],
    collector: Collector,
) -> None:
    """Findings for everything the walk over section ``number`` noted. position: where the walk ended."""
    duration = stream.sections[number].duration
    kept = np.minimum(problems.counts, kernels.KEPT)
    for k in range(int(kept.sum())):
        p = _Place(stream, machine, problems.found[k].tolist(), problems.numbers[k].tolist(), duration)
        at, p.row = p.row, _row(path, p.row)
        if p.kind == kernels.P_EARLY:
            p.a = _row(path, int(p.a))
        times = 1
        if k + 1 == int(kept.sum()) or not (problems.found[k + 1 :, 0] == p.kind).any():
            times += int(problems.counts[p.kind] - kept[p.kind])
        span = span_of(trace, number, p.row)
        if p.kind == kernels.P_LIMIT_UNKNOWN:
            collector.leave_open(
                f"{p.name} passes its soft limit with the guard off in line {span.line}; its travel is not stated",
                "stream-limit",
            )
            continue
        if p.kind == kernels.P_LEFT:
            code, what = _left(stream, trace, machine, number, path, at, p, position)
        else:
            code, say = TEXTS[p.kind]
            what = say(p)
        collector.add(code.at(span, what=f"section {number}, row {p.row}, tick {p.tick}: {what}"), times)
    if any(problems.counts[kind] for kind in FATAL):
        collector.leave_open(f"section {number} was not followed to its end")


def _row(path: Lifted, at: int) -> int:
    """The trace's row for one of the rows that were walked."""
    return int(path.origin[min(at, len(path.origin) - 1)]) if at >= 0 and len(path.origin) else at


def _left(
    stream: StepStream,
    trace: Trace,
    machine: Machine,
    number: int,
    path: Lifted,
    at: int,
    p: _Place,
    position: npt.NDArray[np.int64],
) -> tuple[Code, str]:
    """Why no path point explains a step: another row's position (order), or nobody's. at: its row of ``path``."""
    rows, start = path.rows, path.start
    spu = np.array([float(motor.steps_per_unit) for motor in stream.motors])
    axes = [motor.axis for motor in stream.motors]
    knots = [knots_of(drive.pitch, float(r)) for drive, r in zip(drives_of(stream, machine), spu, strict=True)]
    first = np.cumsum([0, *(len(one) for one in knots)]).astype(np.int64)
    table = np.concatenate([np.zeros((0, 2)), *knots])
    aim = np.array([kernels.axis_steps(float(n), m, table, first) for m, n in enumerate(position.tolist())])

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
    for other in range(at + 1, min(at + NEARBY, len(rows.op))):
        if rows.op[other] <= kernels.LAST_MOTION_OP and distance(other) <= kernels.PATH_TOLERANCE and here > 1.5:
            row = _row(path, other)
            line = span_of(trace, number, row).line
            return (
                STREAM_ORDER,
                f"{p.name} at {p.at(p.a)} belongs to row {row} (line {line}); what lies before is missing",
            )
    for other in range(at - 1, max(-1, at - NEARBY), -1):
        if rows.op[other] <= kernels.LAST_MOTION_OP and distance(other) <= kernels.PATH_TOLERANCE and here > 1.5:
            row = _row(path, other)
            line = span_of(trace, number, row).line
            return STREAM_ORDER, f"{p.name} at {p.at(p.a)} goes back to row {row} (line {line})"
    return STREAM_POSITION, (
        f"{p.name} goes to {p.at(p.a)}; that is about {here:.2f} steps from this row's path, "
        f"or from the part of it that is due; {kernels.PATH_TOLERANCE:g} allowed"
    )


def _points(rows: kernels.Rows, row: int, start: Floats, shares: Floats) -> Floats:
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
