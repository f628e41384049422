"""What a job leaves of its stock, and what its tools meet, found another way: by columns of stock over many points.

Nothing of the checks is used. Over each point stock is a few stretches of Z. A feed takes away what the cutter passes
between its lower side and the end of its flutes; whatever else of a tool, or the cutter in a traverse, shares more than
a hair with what is left is in stock. Lines are exact but for a search on a convex function, level arcs are exact, other
arcs go by chords: the solid is followed twice, for what certainly happens and for what may.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
THROUGH, FLUTES, DEPTH, PARTS, NEAR = "through", "flutes", "depth", "parts", "near"
SLOTS = 6
HAIR = 1e-6
"""mm by which pieces are made smaller for what certainly happens, and larger for what may."""
DEEP = 1e-5
"""mm of stock that a piece has to share to be in it."""
FINE = 2e-3
"""mm that chords may lie beside an arc."""
STEPS = 8


@dataclass(frozen=True)
class Piece:
    """A body of revolution: its lower side over the tip by distance from the axis, its radius, its upper end."""

    name: str
    radius: float
    side: Callable[[Floats], Floats]
    top: float
    up: float = 0.0
    level: bool = False
    """Whether its lower side is flat."""


@dataclass(frozen=True)
class Truth:
    """A tool as it is, whatever the table says of it; flutes: where it stops cutting; depth: that the table allows."""

    number: int
    cutter: Piece
    others: tuple[Piece, ...]
    flutes: float
    depth: float = math.inf


@dataclass(frozen=True)
class Step:
    """A straight way of the tip, or a level arc (center x, y, radius, begin and sweep in radians); beside: mm off."""

    start: Floats
    end: Floats
    arc: tuple[float, float, float, float, float] | None = None
    beside: float = 0.0

    def at(self, t: Floats) -> Floats:
        if self.arc is None:
            return self.start + t[:, None] * (self.end - self.start)
        x, y, r, begin, sweep = self.arc
        return np.stack(
            [x + r * np.cos(begin + sweep * t), y + r * np.sin(begin + sweep * t), 0 * t + self.start[2]], 1
        )


@dataclass
class Way:
    """A move of the job: its tool, the line that it stands in, the steps of its tip one after another."""

    tool: Truth
    line: int
    feed: bool
    steps: list[Step]
    asked: bool = True
    """False: from where the axes stood at the beginning, which is taken to be free."""

    @property
    def ends(self) -> tuple[Floats, Floats]:
        return self.steps[0].start, self.steps[-1].end


def line(a: Floats, b: Floats, pieces: int = 1) -> list[Step]:
    """A straight way in as many steps."""
    places = [a + (b - a) * (n / pieces) for n in range(pieces)] + [b]
    return [Step(p, q) for p, q in itertools.pairwise(places)]


def arc(a: Floats, b: Floats, center: Floats, sweep: float, plane: tuple[int, int, int] = (0, 1, 2)) -> list[Step]:
    """An arc or helix in a plane; the end is where it is, though a little beside the circle."""
    u, v, w = plane
    r = math.hypot(a[u] - center[u], a[v] - center[v])
    r_end = math.hypot(b[u] - center[u], b[v] - center[v])
    begin = math.atan2(a[v] - center[v], a[u] - center[u])
    if w == 2 and a[2] == b[2]:
        off = abs(r - r_end)
        cuts = [begin + sweep * n / STEPS for n in range(STEPS)]
        out = []
        for angle in cuts:
            step = Step(a, b, (float(center[0]), float(center[1]), r, angle, sweep / STEPS), off)
            p, q = step.at(np.array([0.0, 1.0]))
            out.append(Step(p, q, step.arc, off))
        out[0] = Step(a, out[0].end, out[0].arc, off)
        out[-1] = Step(out[-1].start, b, out[-1].arc, off)
        return out
    count = max(8, math.ceil(abs(sweep) / math.sqrt(8 * FINE / max(r, r_end))))
    t = np.linspace(0.0, 1.0, count + 1)
    turned = begin + sweep * t
    reach = r + (r_end - r) * t
    places = np.zeros((count + 1, 3))
    places[:, u], places[:, v] = center[u] + reach * np.cos(turned), center[v] + reach * np.sin(turned)
    places[:, w] = a[w] + (b[w] - a[w]) * t
    places[0], places[-1] = a, b
    off = FINE + abs(r - r_end) / 4
    return [Step(p, q, None, off) for p, q in itertools.pairwise(places)]


def passes(points: Floats, step: Step, piece: Piece, grow: float) -> tuple[NDArray[np.int64], Floats, Floats]:
    """Of the points that a piece passes over: which, the lowest and the highest place of its body over them.

    grow: mm that the piece is made wider and longer by, less than 0: smaller.
    """
    radius = piece.radius + grow
    if radius <= 0.0:
        none = np.zeros(0)
        return np.zeros(0, dtype=np.int64), none, none

    def side(r: Floats) -> Floats:
        return piece.side(np.clip(r - grow, 0.0, piece.radius)) - grow

    low_z = min(step.start[2], step.end[2])
    if step.arc is not None:
        x, y, r, begin, sweep = step.arc
        away = points - (x, y)
        turned = np.arctan2(away[:, 1], away[:, 0]) - begin
        turned = turned % (2 * math.pi) if sweep > 0 else -((-turned) % (2 * math.pi))
        within = np.abs(turned) <= abs(sweep)
        near = np.abs(np.hypot(away[:, 0], away[:, 1]) - r)
        ends = np.minimum(np.hypot(*(points - step.start[:2]).T), np.hypot(*(points - step.end[:2]).T))
        gap = np.where(within, near, ends)
        at = np.flatnonzero(gap <= radius)
        lowest = low_z + piece.up + side(gap[at])
        return at, lowest, np.full(len(at), low_z + piece.top + grow)
    a, b = step.start, step.end
    low = np.minimum(a[:2], b[:2]) - radius
    high = np.maximum(a[:2], b[:2]) + radius
    at = np.flatnonzero(((points >= low) & (points <= high)).all(axis=1))
    way = b[:2] - a[:2]
    away = points[at] - a[:2]
    square = float(way @ way)
    if square < 1e-24:
        gap = np.hypot(away[:, 0], away[:, 1])
        kept = gap <= radius
        at, gap = at[kept], gap[kept]
        highest = max(a[2], b[2]) + piece.top + grow
        return at, low_z + piece.up + side(gap), np.full(len(at), highest)
    along = away @ way
    rest = along * along - square * ((away * away).sum(axis=1) - radius * radius)
    root = np.sqrt(np.maximum(rest, 0.0))
    begin, end = (along - root) / square, (along + root) / square
    kept = (rest >= 0.0) & (end >= 0.0) & (begin <= 1.0)
    at, away, begin, end = at[kept], away[kept], np.clip(begin[kept], 0.0, 1.0), np.clip(end[kept], 0.0, 1.0)
    rise = b[2] - a[2]

    def over(t: Floats) -> Floats:
        return a[2] + t * rise + side(np.hypot(away[:, 0] - t * way[0], away[:, 1] - t * way[1]))

    if rise == 0.0:
        lowest = over(np.clip((away @ way) / square, 0.0, 1.0))
    else:
        left, right = begin.copy(), end.copy()
        lowest = np.minimum(over(left), over(right))
        for _ in range(0 if piece.level else 26):
            p, q = left + (right - left) * 0.382, left + (right - left) * 0.618
            less = over(p) <= over(q)
            left, right = np.where(less, left, p), np.where(less, q, right)
        lowest = np.minimum(lowest, over((left + right) / 2))
    highest = a[2] + np.maximum(begin * rise, end * rise) + piece.top + grow
    return at, lowest + piece.up, highest


@dataclass
class Columns:
    """Stretches of stock over points: (n, SLOTS) lower and upper ends, equal where a slot is empty."""

    low: Floats
    high: Floats

    @classmethod
    def of(cls, low: Floats, high: Floats) -> Columns:
        """One stretch over each point; none where low >= high."""
        full = high > low
        lows, highs = np.zeros((len(low), SLOTS)), np.zeros((len(low), SLOTS))
        lows[:, 0], highs[:, 0] = np.where(full, low, 0.0), np.where(full, high, 0.0)
        return cls(lows, highs)

    def cut(self, at: NDArray[np.int64], low: Floats, high: Floats) -> None:
        """Take a stretch away."""
        was_low, was_high = self.low[at], self.high[at]
        below = np.stack([was_low, np.minimum(was_high, low[:, None])])
        above = np.stack([np.maximum(was_low, high[:, None]), was_high])
        both = np.concatenate([below, above], axis=2)
        both[:, both[0] >= both[1]] = 0.0
        order = np.argsort(both[0] - both[1], axis=1, kind="stable")
        lows, highs = (np.take_along_axis(each, order, axis=1) for each in both)
        assert (highs[:, SLOTS:] - lows[:, SLOTS:] < 1e-3).all()
        self.low[at], self.high[at] = lows[:, :SLOTS], highs[:, :SLOTS]

    def shared(self, at: NDArray[np.int64], low: Floats, high: Floats) -> Floats:
        """mm of a stretch that are stock."""
        both = np.minimum(self.high[at], high[:, None]) - np.maximum(self.low[at], low[:, None])
        total: Floats = np.maximum(both, 0.0).sum(axis=1)
        return total

    def top(self, at: NDArray[np.int64] | slice) -> Floats:
        """The highest stock, -inf: none."""
        highest: Floats = np.where(self.high[at] > self.low[at], self.high[at], -math.inf).max(axis=1)
        return highest


Told = dict[tuple[str, int], float]
"""(kind, line) -> mm."""
Body = Callable[[Floats], tuple[Floats, Floats]]
"""Points (n, 2) -> lower and upper end of the stock over them."""


def follow(
    ways: list[Way], body: Body, points: Floats, cell: float, clearance: float = 0.0, *, certain: bool,
    only: set[int] | None = None,
) -> Told:  # fmt: skip
    """What the tools meet over some points in the lines ``only``.

    certain: what happens whatever chords leave, else all that may. cell: how wide a cut has to be whose depth is told.
    """
    met: Told = {}
    low, high = body(points)
    left = Columns.of(low, high)
    highest = float(high.max()) if len(high) else -math.inf
    sign, enough = (-1.0, DEEP) if certain else (1.0, 0.0)

    def note(kind: str, way: Way, mm: Floats, from_: float = enough) -> None:
        if len(mm) and mm.max() > from_:
            met[kind, way.line] = max(met.get((kind, way.line), 0.0), float(mm.max()))

    for way in ways:
        asked = way.asked and (only is None or way.line in only)
        cutter = way.tool.cutter
        first = left.top(slice(None)) if asked and way.feed and not certain else None
        for number, step in enumerate(way.steps):
            lowest_tip = min(step.start[2], step.end[2]) - 2 * HAIR - step.beside
            if lowest_tip - clearance > highest:
                continue
            grow = sign * (HAIR + step.beside)

            def meets(piece: Piece, grow: float = grow, down: float = 0.0, step: Step = step) -> Floats:
                at, lowest, upmost = passes(points, step, piece, grow)
                return left.shared(at, lowest - down, upmost)

            if not way.feed and asked:
                note(THROUGH, way, meets(cutter))
                if clearance > 0.0 and certain:
                    note(NEAR, way, meets(cutter, down=clearance - HAIR))
                    note(NEAR, way, meets(cutter, clearance - HAIR, HAIR - clearance))
            parts = [p for p in way.tool.others if asked and lowest_tip + p.up < highest]
            if not certain:
                for part in parts:
                    note(PARTS, way, meets(part))
            if way.feed:
                if asked and (len(way.steps) <= STEPS or number % 16 == 0):
                    for kind, mm in depths(way, step, points, left, cell, first):
                        note(kind, way, mm)
                at, lowest, upmost = passes(points, step, cutter, -grow)
                left.cut(at, lowest, upmost)
            if certain:
                for part in parts:
                    note(PARTS, way, meets(part))
    return met


def depths(
    way: Way, step: Step, points: Floats, left: Columns, cell: float, first: Floats | None
) -> Iterator[tuple[str, Floats]]:  # fmt: skip
    """How far stock over points stands higher than what the tool may cut.

    first: stock before all of the move, for all that may be told; None: where all around a point is cut too.
    """
    cutter = way.tool.cutter
    limits = ((FLUTES, way.tool.flutes), (DEPTH, way.tool.depth))
    for place in step.at(np.array([0.3, 1.0])):
        at = np.flatnonzero(np.abs(points[:, 0] - place[0]) <= cutter.radius + HAIR)
        away = np.abs(points[at] - place[:2])
        certain = first is None
        if certain:
            away += cell
            gap = np.hypot(*away.T)
            kept = gap <= cutter.radius - 1e-3 - step.beside
        else:
            gap = np.hypot(*away.T)
            kept = gap <= cutter.radius + HAIR + step.beside
        at, side = at[kept], cutter.side(np.minimum(gap[kept], cutter.radius))
        top = left.top(at) if first is None else first[at]
        cut = top > place[2] + side + (1e-3 + step.beside if certain else -HAIR - step.beside)
        for kind, limit in limits:
            spare = -1e-3 - step.beside if certain else HAIR + step.beside
            yield kind, np.where(cut, top - place[2] - limit + spare, -math.inf)
