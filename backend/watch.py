"""How far a run is: source line, part, time left, position, for whoever watches. Nothing is decided by it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction

import numpy as np
import numpy.typing as npt

from gproof.backend.job import CertifiedJob
from gproof.ir.columns import Columns
from gproof.ir.record import record
from gproof.ir.stream import Motor, StreamSection
from gproof.ir.trace import Op, Plane, TraceSection

Floats = npt.NDArray[np.float64]

_IN_PLANE = {Plane.XY: [0, 1], Plane.XZ: [0, 2], Plane.YZ: [1, 2]}


@record(frozen=True, slots=True, kw_only=True)
class Moment:
    """Where a run is.

    section: its number; sections: how many there are; line, file: of the source, 0 and "" where none is known; part: of
    all motion, 0 to 1; left: seconds of motion that are left at least and at most, without waits for the operator;
    position: by motor, mm or degrees, as the board has certainly made it; steps: the same in steps.
    """

    section: int
    sections: int
    line: int
    file: str
    part: float
    left: tuple[float, float]
    position: tuple[float, ...]
    steps: tuple[int, ...]


class Watch:
    """Of one job; factor: the override it runs with."""

    def __init__(self, job: CertifiedJob, factor: Fraction) -> None:
        self._job = job
        self._factor = factor
        self._lines: dict[int, _Lines] = {}
        self._after = self._left_after()

    def override(self, factor: Fraction) -> None:
        """It runs with another override from now on."""
        self._factor = factor
        self._after = self._left_after()

    def prepare(self, number: int) -> None:
        """Get ready for a section: while nothing moves, because it takes a moment for a long one."""
        job = self._job
        if number not in self._lines:
            # Of one section at a time: a job can have thousands.
            self._lines = {number: _Lines(job.stream.sections[number], job.trace.sections[number], job.stream.motors)}

    def moment(self, section: StreamSection, now: int, part: float, made: int, steps: Sequence[int]) -> Moment:
        """now: tick of the section as it is run; made: steps of all motors in it; steps: where the motors are."""
        job, number = self._job, section.number
        self.prepare(number)
        row = self._lines[number].row(made)
        rows = job.trace.sections[number].rows
        file = int(rows["file"][row]) if row >= 0 else 0
        here = max(0, section.duration - max(0, now))
        least, most = self._after[number]
        hertz = job.stream.tick_frequency
        return Moment(
            section=number,
            sections=len(job.stream.sections),
            line=int(rows["line"][row]) if row >= 0 else 0,
            file=job.trace.files[file] if job.trace.files else "",
            part=part,
            left=((here + least) / hertz, (here + most) / hertz),
            position=tuple(float(k / m.steps_per_unit) for k, m in zip(steps, job.stream.motors, strict=True)),
            steps=tuple(int(k) for k in steps),
        )

    def _left_after(self) -> list[tuple[float, float]]:
        """Ticks of motion after each section, at least and at most: over the shortest and the longest way to the end.

        With an override a section takes as long as planned at least (a dwell stays), and that over the factor at most.
        """
        sections = self._job.trace.sections
        found: list[tuple[float, float] | None] = [None] * len(sections)
        stack = [0] if sections else []
        while stack:
            number = stack[-1]
            targets = [e.target for e in sections[number].edges if 0 <= e.target < len(sections)]
            missing = [target for target in targets if found[target] is None]
            if missing:
                stack += missing
                continue
            stack.pop()
            ways = [self._with(target, found[target]) for target in targets] or [(0.0, 0.0)]
            found[number] = min(least for least, _ in ways), max(most for _, most in ways)
        return [(0.0, 0.0) if pair is None else pair for pair in found]

    def _with(self, number: int, after: tuple[float, float] | None) -> tuple[float, float]:
        duration = self._job.stream.sections[number].duration
        least, most = after or (0.0, 0.0)
        return duration + least, duration / float(self._factor) + most


class _Lines:
    """Which row of a section its steps have reached: the steps that each row's path takes, added up.

    Compensation of backlash, pitch and heights adds steps that no row has; the sums are stretched to the stream's.
    """

    def __init__(self, section: StreamSection, trace: TraceSection, motors: Sequence[Motor]) -> None:
        rows = trace.rows
        self._moving = np.flatnonzero(rows["op"] < Op.DWELL)
        self._first = 0 if len(rows) else -1
        lengths = _steps_of_rows(rows, self._moving, trace.start, motors)
        total = sum(int(runs["count"].sum()) for runs in section.runs)
        ends = np.cumsum(lengths)
        self._ends = ends * (total / ends[-1]) if len(ends) and ends[-1] > 0 else ends

    def row(self, made: int) -> int:
        """The row of which step number ``made`` is the last that was made; -1: the section has none."""
        if not len(self._moving):
            return self._first
        place = int(np.searchsorted(self._ends, made - 0.5, side="left"))
        return int(self._moving[min(place, len(self._moving) - 1)])


def _steps_of_rows(
    rows: Columns, moving: npt.NDArray[np.intp], start: Sequence[float], motors: Sequence[Motor]
) -> Floats:
    """Steps of all motors on the path of each moving row, not rounded."""
    to: Floats = rows["to"]
    before: Floats = np.vstack([np.array(start, dtype=np.float64).reshape(1, -1), to])[:-1]
    # Rows that do not move are where the one before them ended.
    way: Floats = np.abs(to - before)[moving]
    _add_arcs(way, rows, moving, before[moving])
    steps = np.zeros(len(moving))
    for motor in motors:
        steps += np.nan_to_num(way[:, motor.axis]) * abs(float(motor.steps_per_unit))
    return steps


def _add_arcs(way: Floats, rows: Columns, moving: npt.NDArray[np.intp], starts: Floats) -> None:
    """What arcs go along each axis of their plane, there and back."""
    arcs = rows["op"][moving] == Op.ARC
    for plane, axes in _IN_PLANE.items():
        at = np.flatnonzero(arcs & (rows["plane"][moving] == int(plane)))
        if not len(at):
            continue
        row = moving[at]
        center, turns = rows["center"][row][:, axes], rows["turns"][row].astype(np.float64)
        here, there = starts[at][:, axes] - center, rows["to"][row][:, axes] - center
        radius = (np.hypot(here[:, 0], here[:, 1]) + np.hypot(there[:, 0], there[:, 1])) / 2
        first, last = np.arctan2(here[:, 1], here[:, 0]), np.arctan2(there[:, 1], there[:, 0])
        sweep = np.mod(np.where(turns > 0, last - first, first - last), math.tau)
        sweep = np.where(sweep == 0, math.tau, sweep) + math.tau * (np.abs(turns) - 1)
        begin = np.where(turns > 0, first, first - sweep)
        for axis, shift in zip(axes, (0.0, math.pi / 2), strict=True):
            way[at, axis] = radius * (_swing(begin + shift + sweep) - _swing(begin + shift))


def _swing(angle: Floats) -> Floats:
    """The integral of ``|sin|`` from 0: how far a point at an angle of the unit circle has gone along X."""
    half = np.floor(angle / math.pi)
    found: Floats = 2.0 * half + 1.0 - np.cos(angle - half * math.pi)
    return found
