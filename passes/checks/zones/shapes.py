"""Whether a move enters a zone: an open region of X and Y between two heights, grown by what is around the point.

Straight moves exactly: between the places where a move crosses an edge of the region, or passes a corner at least
distance, the depth has one sign. Arcs by chords whose distance from the arc is added to the region, halved until a
point of the arc itself is inside or the chord is next to it. Touching is outside; less than that counts as it.
"""

from __future__ import annotations

import itertools
import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence

import numpy as np
import numpy.typing as npt

from gproof.ir.machine import Area
from gproof.ir.record import record
from gproof.ir.trace import Plane
from gproof.passes.geometry.extent_kernels import arc_extreme

TOUCH = 1e-9
"""mm: a point no deeper than this touches."""
LEAF, LONG_LEAF = 1e-8, 1e-6
"""mm between an arc and its chord at which halving ends; the second where a long piece of it touches, whose depth is
that of the points on it."""
_LONG = 1000
_MARGIN = 1e-6
"""mm by which shapely's answers may be off."""
PIECES = 200_000
"""Of one arc; what is then still open counts as inside."""

IN_PLANE = {Plane.XY: (0, 1), Plane.XZ: (2, 0), Plane.YZ: (1, 2)}
"""The right-handed pair of each plane."""

Floats = npt.NDArray[np.float64]
Point = tuple[float, float, float]
Pair = tuple[float, float]
Box = tuple[Pair, Pair, Pair]


class Shape(ABC):
    """An open region of the X-Y plane."""

    @abstractmethod
    def distance(self, points: Floats) -> Floats:
        """(n,) of (n, 2): distance from the region's edge, negative inside."""

    @abstractmethod
    def crossings(self, start: Pair, way: Pair, grow: float) -> list[float]:
        """Where a line start + t · way may cross the edge of the region, grown or not, or is nearest to a corner."""

    @abstractmethod
    def in_box(self, x: Pair, y: Pair, grow: float) -> bool:
        """Whether the grown region has a point in a closed box, deeper than ``TOUCH``."""


class Rectangle(Shape):
    """low < x < high and the same for y; sides may be infinite."""

    def __init__(self, x: Pair, y: Pair) -> None:
        self.sides = x, y
        self.corners = [(a, b) for a in x for b in y if math.isfinite(a) and math.isfinite(b)]

    def distance(self, points: Floats) -> Floats:
        """See ``Shape``."""
        (x0, x1), (y0, y1) = self.sides
        dx = np.maximum(x0 - points[:, 0], points[:, 0] - x1)
        dy = np.maximum(y0 - points[:, 1], points[:, 1] - y1)
        outside = np.hypot(np.maximum(dx, 0.0), np.maximum(dy, 0.0))
        return np.where((dx <= 0.0) & (dy <= 0.0), np.maximum(dx, dy), outside)

    def crossings(self, start: Pair, way: Pair, grow: float) -> list[float]:
        """See ``Shape``."""
        out = []
        for axis, sides in enumerate(self.sides):
            if way[axis] != 0.0:
                for side in sides:
                    if math.isfinite(side):
                        out += [(side + g - start[axis]) / way[axis] for g in ({0.0, grow, -grow})]
        return out + _corner_crossings(self.corners, start, way, grow)

    def in_box(self, x: Pair, y: Pair, grow: float) -> bool:
        """See ``Shape``."""
        gaps = [max(low - b, a - high) for (low, high), (a, b) in zip(self.sides, (x, y), strict=True)]
        if max(gaps) < -TOUCH:
            return True
        return math.hypot(max(gaps[0], 0.0), max(gaps[1], 0.0)) < grow - TOUCH


class Polygon(Shape):
    """Inside an odd number of rings (without their last point, which is the first)."""

    def __init__(self, rings: Sequence[Sequence[Pair]]) -> None:
        self.rings = rings
        self.begin = np.array([p for ring in rings for p in ring], dtype=np.float64)
        self.end = np.array([p for ring in rings for p in (*ring[1:], ring[0])], dtype=np.float64)
        self.way = self.end - self.begin
        self.square = (self.way**2).sum(axis=1)

    def distance(self, points: Floats) -> Floats:
        """See ``Shape``."""
        rel = points[:, np.newaxis, :] - self.begin[np.newaxis]
        t = np.clip((rel * self.way).sum(axis=2) / self.square, 0.0, 1.0)
        near = np.hypot(rel[:, :, 0] - t * self.way[:, 0], rel[:, :, 1] - t * self.way[:, 1]).min(axis=1)
        found: Floats = np.where(self._inside(points), -near, near)
        return found

    def crossings(self, start: Pair, way: Pair, grow: float) -> list[float]:
        """See ``Shape``."""
        at, to = np.array(start), np.array(way)
        # Only edges whose box the line's box comes near to can be crossed or be the nearest ones of a point inside.
        low, high = np.minimum(at, at + to) - grow - TOUCH, np.maximum(at, at + to) + grow + TOUCH
        close = ((np.minimum(self.begin, self.end) <= high) & (np.maximum(self.begin, self.end) >= low)).all(axis=1)
        begin, edge = self.begin[close], self.way[close]
        length = np.sqrt(self.square[close])
        slope = (edge[:, 0] * to[1] - edge[:, 1] * to[0]) / length
        off = ((begin[:, 0] - at[0]) * edge[:, 1] - (begin[:, 1] - at[1]) * edge[:, 0]) / length
        some = slope != 0.0
        out = [((side - off[some]) / slope[some]).tolist() for side in {0.0, grow, -grow}]
        corners = [(float(x), float(y)) for x, y in np.concatenate([begin, self.end[close]])]
        return [t for part in out for t in part] + _corner_crossings(list(dict.fromkeys(corners)), start, way, grow)

    def near(self, lines: Floats, grow: float) -> npt.NDArray[np.bool_]:
        """(n,) of (n, 2, 2): lines that may come into the grown region, by shapely; the others do not for certain."""
        low, high = lines.min(axis=1) - grow - _MARGIN, lines.max(axis=1) + grow + _MARGIN
        beside = np.zeros(len(lines), dtype=np.bool_)
        for begin, end in zip(self.begin, self.end, strict=True):
            beside |= ((low <= np.maximum(begin, end)) & (high >= np.minimum(begin, end))).all(axis=1)
        # A line that no edge's box comes near to is inside from end to end, or outside.
        found: npt.NDArray[np.bool_] = np.zeros(len(lines), dtype=np.bool_)
        found[~beside] = self._inside(lines[~beside, 0])
        if beside.any():
            import shapely

            whole = shapely.Polygon(self.rings[0], self.rings[1:])
            shapely.prepare(whole)
            found[beside] = shapely.dwithin(whole, shapely.linestrings(lines[beside]), grow + _MARGIN)
        return found

    def _inside(self, points: Floats) -> npt.NDArray[np.bool_]:
        """(n,) of (n, 2): an odd number of edges to the right."""
        odd = np.zeros(len(points), dtype=np.bool_)
        x, y = points[:, 0], points[:, 1]
        for (ax, ay), (bx, by) in zip(self.begin.tolist(), self.end.tolist(), strict=True):
            if ay != by:
                odd ^= ((ay > y) != (by > y)) & (x < ax + (y - ay) / (by - ay) * (bx - ax))
        return odd

    def in_box(self, x: Pair, y: Pair, grow: float) -> bool:
        """See ``Shape``."""
        corners = [(x[0], y[0]), (x[1], y[0]), (x[1], y[1]), (x[0], y[1])]
        inner = (self.begin > [x[0], y[0]]).all(axis=1) & (self.begin < [x[1], y[1]]).all(axis=1)
        if inner.any():
            return True
        sides = zip(corners, corners[1:] + corners[:1], strict=True)
        zone = Zone(shape=self, z=(-math.inf, math.inf), grow=grow)
        return any(segment_enters(zone, (*p, 0.0), (*q, 0.0)) is not None for p, q in sides)


def _corner_crossings(corners: list[Pair], start: Pair, way: Pair, grow: float) -> list[float]:
    """Where a line is nearest to corners, and where it crosses circles around them."""
    square = way[0] ** 2 + way[1] ** 2
    if square == 0.0:
        return []
    out = []
    for x, y in corners:
        dx, dy = x - start[0], y - start[1]
        nearest = (dx * way[0] + dy * way[1]) / square
        out.append(nearest)
        off = (dx * way[1] - dy * way[0]) ** 2 / square
        if grow * grow > off:
            half = math.sqrt((grow * grow - off) / square)
            out += [nearest - half, nearest + half]
    return out


@record(frozen=True, slots=True, kw_only=True)
class Zone:
    """A region between two heights; grow: mm around it in X and Y that belong to it; rise: mm above and below."""

    shape: Shape
    z: Pair
    grow: float = 0.0
    rise: float = 0.0

    def wider(self, around: float, above: float) -> Zone:
        """Grown by more."""
        return Zone(shape=self.shape, z=self.z, grow=self.grow + around, rise=self.rise + above)

    def depths(self, points: Floats) -> Floats:
        """(n,) of (n, 3): mm to the nearest edge, positive inside."""
        depth = self.grow - self.shape.distance(points[:, :2])
        below = points[:, 2] - (self.z[0] - self.rise)
        return np.minimum(np.minimum(depth, below), self.z[1] + self.rise - points[:, 2])


@record(frozen=True, slots=True, kw_only=True)
class Entry:
    """Where a path enters a zone, and how deep it goes there at least, mm."""

    at: Point
    depth: float


def shape_of(area: Area) -> Shape:
    """The region of X and Y of an area."""
    return Polygon(area.rings) if area.rings else Rectangle(area.box[0], area.box[1])


def segment_enters(zone: Zone, start: Point, end: Point) -> Entry | None:
    """A straight move."""
    t0, t1 = 0.0, 1.0
    low, high = zone.z[0] - zone.rise, zone.z[1] + zone.rise
    dz = end[2] - start[2]
    if dz == 0.0:
        if not low < start[2] < high:
            return None
    else:
        enter, leave = sorted(((low - start[2]) / dz, (high - start[2]) / dz))
        t0, t1 = max(t0, enter), min(t1, leave)
        if t0 >= t1:
            return None
    way = end[0] - start[0], end[1] - start[1]
    ts = {t0, t1} | {t for t in zone.shape.crossings((start[0], start[1]), way, zone.grow) if t0 < t < t1}
    marks = sorted(ts)
    both = np.array([*marks, *((a + b) / 2 for a, b in itertools.pairwise(marks))])
    begin, finish = np.array(start), np.array(end)
    depths = zone.depths(begin + (finish - begin) * both[:, np.newaxis])
    if not (depths > TOUCH).any():
        return None
    first = float(both[depths > TOUCH].min())
    entry = max((t for t in marks if t <= first), default=first)
    at = (begin + (finish - begin) * entry).tolist()
    return Entry(at=(at[0], at[1], at[2]), depth=float(depths.max()))


def box_enters(zone: Zone, x: Pair, y: Pair, z: Pair) -> bool:
    """Whether a closed box, sides of which may be infinite, has a point inside."""
    if z[1] <= zone.z[0] - zone.rise + TOUCH or z[0] >= zone.z[1] + zone.rise - TOUCH:
        return False
    ends = [min(max(v, -1e9), 1e9) for v in (*x, *y)]
    return zone.shape.in_box((ends[0], ends[1]), (ends[2], ends[3]), zone.grow)


@record(frozen=True, slots=True, kw_only=True)
class Arc:
    """An arc row: its angle runs evenly, its radius and its third axis with the angle."""

    start: Point
    end: Point
    center: Point
    turns: int
    plane: int


def arc_enters(zone: Zone, arc: Arc) -> Entry | None:
    """An arc, a helix or a spiral."""
    u, v = IN_PLANE[Plane(arc.plane)]
    w = 3 - u - v
    du, dv = arc.start[u] - arc.center[u], arc.start[v] - arc.center[v]
    eu, ev = arc.end[u] - arc.center[u], arc.end[v] - arc.center[v]
    r0, r1 = math.hypot(du, dv), math.hypot(eu, ev)
    a0 = math.atan2(dv, du)
    sweep = math.copysign(arc_extreme(du, dv, eu, ev, arc.turns)[4], arc.turns)

    def at(t: float) -> Point:
        if t in (0.0, 1.0):
            return arc.end if t else arc.start
        angle, radius = a0 + sweep * t, r0 + (r1 - r0) * t
        out = [0.0, 0.0, 0.0]
        out[u], out[v] = arc.center[u] + radius * math.cos(angle), arc.center[v] + radius * math.sin(angle)
        out[w] = arc.start[w] + (arc.end[w] - arc.start[w]) * t
        return out[0], out[1], out[2]

    # At an equal part of the path a chord over dt is within dt² / 8 of the greatest second derivative of its arc.
    bend = (max(r0, r1) * abs(sweep) + 2.0 * abs(r1 - r0)) * abs(sweep) / 8.0
    flat = arc.plane == Plane.XY
    pieces = max(4, math.ceil(abs(sweep) / (math.pi / 4)))
    stack = [(k / pieces, (k + 1) / pieces) for k in reversed(range(pieces))]
    done = 0
    while stack:
        t0, t1 = stack.pop()
        p, q = at(t0), at(t1)
        bulge = bend * (t1 - t0) ** 2
        near = segment_enters(zone.wider(bulge, 0.0 if flat else bulge), p, q)
        if near is None:
            continue
        half = (t0 + t1) / 2
        done += 1
        depth = float(zone.depths(np.array([p, at(half), q])).max())
        # A chord's point deeper in the grown zone than twice the bulge has a point of the arc inside next to it.
        if depth > TOUCH or near.depth > 2 * bulge + TOUCH or done > PIECES:
            return _deepest(zone, at, near.at, t0, max(depth, near.depth - 2 * bulge))
        if bulge > (LEAF if done < _LONG else LONG_LEAF) and t0 < half < t1:
            stack += [(half, t1), (t0, half)]
    return None


def _deepest(zone: Zone, at: Callable[[float], Point], where: Point, first: float, depth: float) -> Entry:
    """The place of entry, and the deepest of some places after it: for the message only."""
    points = np.array([at(first + (1.0 - first) * k / 64) for k in range(65)])
    return Entry(at=where, depth=max(depth, float(zone.depths(points).max())))
