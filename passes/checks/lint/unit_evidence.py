"""Numbers that are plausible only in the other unit: a documented, careful score over a whole job.

Evidence that numbers which count as millimetres are inches: the path of feed moves fits into 1/25.4 of every
linear axis that moves (X and Y, with limits), and two of these hold: the machine's unit is the inch; no move takes
more than 0.005 mm a revolution; one way in five or more, of ten at least, is a whole number of 1/64 and not of 1/100.
Evidence that numbers which count as inches are millimetres, two of three: the path is longer than an axis, and 1/25.4
of it fits into all of them (longer than three of the axis: this alone is enough); the greatest feed is beyond every
axis, and 1/25.4 of it is not; a move takes more than 2 mm a revolution, and 1/25.4 of the feed would be less.
docs/cutting-sense.md says the same.
"""

from __future__ import annotations

import math

import numpy as np

from gproof.ir import codes
from gproof.ir.finding import Finding, Span
from gproof.ir.machine import Axis, AxisKind, Machine
from gproof.ir.trace import Affine, Chunk, Op
from gproof.ir.trace_rows import row_span
from gproof.passes.checks.tooling.cutting_rows import SOMEWHERE, Bools, Floats

INCH = 25.4
LEAST_MOVES, LEAST_SHARE = 10, 0.2
FAR = 3.0
"""Times the travel of an axis: no mistake but that of a unit makes a path so long."""
THIN, THICK = 0.005, 2.0
"""mm a revolution: what no cutter needs more of when the job is in inches, and more than any takes."""
_SAME = 1e-6


class UnitEvidence:
    """What rows tell of the unit a job is meant in; extents of ends of moves, by what an axis rests on."""

    def __init__(self, machine: Machine) -> None:
        self._machine = machine
        self._unit = 0.0
        self._mixed = False
        self._first: Span | None = None
        self._low: dict[tuple[int, Affine], float] = {}
        self._high: dict[tuple[int, Affine], float] = {}
        self._fastest = self._most = 0.0
        self._fractions = self._moves = 0

    def units(self, chunk: Chunk) -> None:
        """Rows that set units: a job that uses both says what it means."""
        for value in chunk.rows["arg"][chunk.rows["op"] == Op.UNITS, 0].tolist():
            self._mixed = self._mixed or self._unit not in (0.0, value)
            self._unit = float(value)

    def cuts(self, chunk: Chunk, cut: Bools, way: Floats, speed: Floats) -> None:
        """Rows that cut; speed: rpm of each."""
        rows = chunk.rows
        if not cut.any():
            return
        if self._first is None:
            self._first = row_span(chunk.trace, rows, int(np.argmax(cut)))
        frames = rows["frame"]
        for frame in np.unique(frames[cut]).tolist():
            places = rows["to"][cut & (frames == frame)]
            for axis in self._linear():
                key = axis.index, chunk.trace.frames[frame][axis.index]
                self._low[key] = min(self._low.get(key, math.inf), float(places[:, axis.index].min()))
                self._high[key] = max(self._high.get(key, -math.inf), float(places[:, axis.index].max()))
        feed = np.where(cut & ~(np.abs(way[:, :3]) < SOMEWHERE).all(axis=1), rows["feed"], np.nan)
        if not np.isnan(feed).all():
            self._fastest = max(self._fastest, float(np.nanmax(feed)))
            with np.errstate(invalid="ignore", divide="ignore"):
                bite = np.where((speed != 0.0) & ~np.isnan(speed), feed / np.abs(speed), np.nan)
            if not np.isnan(bite).all():
                self._most = max(self._most, float(np.nanmax(bite)))
        moved = way[cut & (rows["op"] == Op.FEED)][:, :3]
        moved = moved[np.isfinite(moved) & (np.abs(moved) > SOMEWHERE)]
        self._moves += moved.size
        self._fractions += int((_whole(moved * 64.0) & ~_whole(moved * 100.0)).sum())

    def finding(self) -> Finding | None:
        """GP151, or nothing."""
        unit = self._unit or (1.0 if self._machine.unit == 1.0 else 0.0)
        if self._mixed or self._first is None or unit not in (1.0, INCH):
            return None
        why = self._inches() if unit == 1.0 else self._millimetres()
        if not why:
            return None
        names = ("inches", "millimetres") if unit == 1.0 else ("millimetres", "inches")
        hint = "check the unit code of the program, and the setting of the post processor"
        return codes.UNIT_MIX_UP.at(self._first, other=names[0], unit=names[1], why="; ".join(why), hint=hint)

    def _inches(self) -> list[str]:
        extents = [(axis, size, room) for axis, size in self._extents() if (room := _room(axis)) is not None]
        across = [(axis, size, room) for axis, size, room in extents if axis.name in "xy"]
        if len(across) < 2 or any(size > room / INCH for _, size, room in extents):
            return []
        why = []
        if self._machine.unit == INCH:
            why.append("the machine works in inches")
        if 0.0 < self._most < THIN:
            why.append(f"no move is faster than {self._most:.4f} mm/rev")
        if self._moves >= LEAST_MOVES and self._fractions >= LEAST_SHARE * self._moves:
            why.append(f"{self._fractions} of {self._moves} paths are 64ths of an inch, and not hundredths")
        sizes = ", ".join(f"{axis.word} {size:.2f} mm of {room:g} mm" for axis, size, room in across)
        return [f"the path is {sizes}", *why] if len(why) > 1 else []

    def _millimetres(self) -> list[str]:
        why = []
        extents = [(axis, size, room) for axis, size in self._extents() if (room := _room(axis)) is not None]
        long = [f"{axis.word} {size:.1f} mm of {room:g} mm" for axis, size, room in extents if size > room]
        fits = all(size / INCH <= room for _, size, room in extents)
        if long and fits:
            why.append(f"the path is {', '.join(long)}")
        speeds = [axis.max_velocity for axis in self._linear()]
        known = [speed * 60.0 for speed in speeds if speed is not None]
        if len(known) == len(speeds) and known and self._fastest > max(known) >= self._fastest / INCH:
            why.append(f"F is up to {self._fastest:g} mm/min, and no axis is faster than {max(known):g} mm/min")
        if self._most > THICK >= self._most / INCH:
            why.append(f"a move is at {self._most:.2f} mm/rev")
        far = fits and any(size > FAR * room for _, size, room in extents)
        return why if len(why) > 1 or far else []

    def _linear(self) -> list[Axis]:
        return [axis for axis in self._machine.axes if axis.kind is AxisKind.LINEAR and axis.index < 3]

    def _extents(self) -> list[tuple[Axis, float]]:
        """By axis the longest of the ways that rest on one offset; axes that do not move are left out."""
        found = []
        for axis in self._linear():
            sizes = [self._high[key] - low for key, low in self._low.items() if key[0] == axis.index]
            if sizes and max(sizes) > SOMEWHERE:
                found.append((axis, max(sizes)))
        return found


def _room(axis: Axis) -> float | None:
    return None if axis.lower is None or axis.upper is None else axis.upper - axis.lower


def _whole(numbers: Floats) -> Bools:
    near: Bools = np.abs(numbers - np.round(numbers)) < _SAME
    return near
