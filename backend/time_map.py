"""TimeMap: a strictly increasing map from ticks of a section to later ticks, in integers.

Breakpoints (source, target), straight lines between them, every slope at least one: nothing ever comes
sooner than planned. Two breakpoints with the same source are a rest: what is at or before the source tick
keeps the first target, what is after it is later by the difference. After the last breakpoint ticks are
shifted. Because the slopes are at least one and the division rounds down, two ticks are never nearer after
the map than before it (``docs/execution-record.md`` has the proof); so the order of all steps and events of
all motors is kept, and no interval becomes shorter.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from gproof.ir.record import record

Ints = npt.NDArray[np.int64]

LONGEST_CELL = 2**28
"""Source ticks of a cell that is not a mere shift, so that products stay within 64 bits."""


@record(frozen=True, slots=True)
class TimeMap:
    """See the module's text; both arrays start with 0."""

    source: Ints
    target: Ints

    def verify(self) -> None:
        """Starts at 0, slopes of at least one, products within 64 bits; ValueError otherwise."""
        if len(self.source) != len(self.target) or not len(self.source):
            raise ValueError("a time map needs breakpoints with two ticks each")
        if self.source[0] != 0 or self.target[0] != 0:
            raise ValueError("a time map starts at tick 0")
        width, height = np.diff(self.source), np.diff(self.target)
        if (width < 0).any() or (height < width).any():
            raise ValueError("a time map never runs backwards, nor faster than planned")
        if ((width > LONGEST_CELL) & (height > width)).any() or (height - width >= 2**33)[width > 1].any():
            raise ValueError("a cell of the time map is too long")

    def at(self, ticks: Ints) -> Ints:
        """Where these ticks come to lie."""
        cell = np.searchsorted(self.source, ticks, side="left") - 1
        return self._in_cells(ticks, np.maximum(cell, 0))

    def after(self, tick: int) -> int:
        """Where a tick comes to lie when the rest at it, if any, is over."""
        cell = np.searchsorted(self.source, tick, side="right") - 1
        return int(self._in_cells(np.array([tick], dtype=np.int64), np.array([cell]))[0])

    def _in_cells(self, ticks: Ints, cell: npt.NDArray[np.intp]) -> Ints:
        width = np.append(np.diff(self.source), 1)
        extra = np.append(np.diff(self.target) - width[:-1], 0)
        past = ticks - self.source[cell]
        found: Ints = self.target[cell] + past + past * extra[cell] // np.maximum(width[cell], 1)
        return found

    def pieces(self, end: int) -> list[tuple[int, int, bool]]:
        """``(begin, end, shifted)`` stretches of source ticks; ``shifted``: every tick there is equally late.

        Stretches are ``(begin, end]``; a rest ends one. The last reaches ``end``.
        """
        found: list[tuple[int, int, bool]] = []
        stops = [*zip(self.source.tolist(), self.target.tolist(), strict=True)]
        stops.append((max(end, stops[-1][0]), stops[-1][1] + max(0, end - stops[-1][0])))
        rested = True
        for (a, s), (b, t) in pairwise(stops):
            if a == b:
                rested = True
                continue
            shifted = b - a == t - s
            if found and not rested and found[-1][2] == shifted and not shifted:
                found[-1] = (found[-1][0], b, False)
            else:
                found.append((a, b, shifted))
            rested = False
        return found


class MapBuilder:
    """Breakpoints in the making."""

    def __init__(self) -> None:
        self.source = [0]
        self.target = [0]

    def to(self, source: int, target: int) -> None:
        """A straight line to this breakpoint; a slope below one becomes one."""
        width = source - self.source[-1]
        if width > 0:
            self.source.append(source)
            self.target.append(max(target, self.target[-1] + width))

    def shift(self, source: int) -> None:
        """To ``source`` in planned time."""
        self.to(source, 0)

    def slow(self, source: int, factor: Fraction) -> None:
        """To ``source`` at ``factor`` of the planned speed, rounded towards slower."""
        while self.source[-1] < source:
            width = min(source - self.source[-1], LONGEST_CELL)
            height = -(-width * factor.denominator // factor.numerator)
            self.to(self.source[-1] + width, self.target[-1] + height)

    def rest(self, ticks: int) -> None:
        """Stand still for so long."""
        if ticks > 0:
            self.source.append(self.source[-1])
            self.target.append(self.target[-1] + ticks)

    def done(self) -> TimeMap:
        """The map, verified."""
        found = TimeMap(np.array(self.source, dtype=np.int64), np.array(self.target, dtype=np.int64))
        found.verify()
        return found
