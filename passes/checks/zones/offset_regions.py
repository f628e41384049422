"""Where unknown offsets keep a path out of zones: regions of X and Y between two heights, as polygons.

An offset moves the path; seen from it, each move blocks the offsets for which it enters a zone. For a straight move,
all of which moves with the offset, that is the zone taken from every place of the move: the hull of the zone's convex
parts set off from both ends. For a move from a place that stays to one that moves it is what is after the zone, seen
from there. What is left of the offsets' own ranges is the answer. Zones are open, so that touching is allowed.

Approximations are to the safe side, and how far is reported (``Region.resolution``): arcs are cut into chords with
their tangents, round edges (a tool's radius) and moves that climb into pieces. The polygons are shapely's.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from gproof.ir.record import record
from gproof.passes.geometry.extent_kernels import arc_extreme

if TYPE_CHECKING:
    import shapely

Floats = npt.NDArray[np.float64]
Pair = tuple[float, float]

FAR = 1e6
"""mm: what has no end is taken this long."""
ROUND = 1e-3
"""mm by which an arc or a round edge may be blocked too widely."""
WIDEST = 1.5
"""Steps that a chord of a round edge spans at most."""
CLIMB = 0.05
"""mm of height within which a climbing move is taken as level."""
THIN = 1e-7
"""mm: what is left between two blocked places and no wider is none."""
SAME = 1e-9
"""mm: heights that differ by less are one."""
MOST = 20_000
"""Moves that are taken one by one; of more, neighbours are joined."""
SLABS = 64
"""Layers of height that are told apart; with more, heights are rounded to the safe side."""


@record(frozen=True, slots=True, kw_only=True)
class Solid:
    """A zone: convex parts of its region, (k, 2) each; z: its heights; grow: mm around it in X and Y."""

    parts: tuple[Floats, ...]
    z: Pair
    grow: float = 0.0

    def box(self) -> tuple[Pair, Pair, Pair]:
        """Around all of it."""
        points = np.concatenate(self.parts)
        low, high = points.min(axis=0) - self.grow, points.max(axis=0) + self.grow
        return (float(low[0]), float(high[0])), (float(low[1]), float(high[1])), self.z


@record(frozen=True, slots=True, kw_only=True)
class Move:
    """One move, or a piece of one. low, high: of its two ends, (2, 3), where it is known with what is bounded.

    moves: (2, 3), whether the offset of an axis is in an end. points: places in X and Y whose hull has all of it, where
    both ends are known but for the offsets, else none. error: mm by which that is too much.
    """

    low: Floats
    high: Floats
    moves: npt.NDArray[np.bool_]
    points: Floats | None = None
    error: float = 0.0


@record(frozen=True, slots=True, kw_only=True)
class Layer:
    """Between two values of the offset in Z: the offsets in X and Y that are left (a shapely geometry)."""

    z: Pair
    left: Any


@record(frozen=True, slots=True, kw_only=True)
class Region:
    """What is left. resolution: mm beyond which nothing outside is free, None: more may be free anywhere.

    hopeless: nothing is left even clear of the moves that are blocked exactly.
    """

    layers: tuple[Layer, ...]
    resolution: float | None
    hopeless: bool = False

    @property
    def empty(self) -> bool:
        """Whether nothing is left."""
        return not self.layers


class Blocked:
    """Collects what moves block; ``region`` says what is left.

    ranges: of the offsets of X, Y and Z; fixed: an axis has none.
    """

    def __init__(self, ranges: tuple[Pair, Pair, Pair], fixed: tuple[bool, bool, bool]) -> None:
        x, y, z = ranges
        self.ranges = _finite(x), _finite(y), _finite(z)
        self.fixed = fixed
        self.resolution: float | None = 0.0
        self._shapes: dict[tuple[Pair, float], list[Any]] = {}
        self._exact: Blocked | None = None
        self._level: set[Pair] = set()

    def add(self, solid: Solid, moves: list[Move], *, sure: bool = True) -> None:
        """Block what these moves need. sure: what enters the solid does what is to be kept from."""
        rough = [move for move in moves if move.error or move.points is None or not sure]
        if not sure:
            self.resolution = None
        if (rough or solid.grow) and self._exact is None:
            self._exact = Blocked(self.ranges, self.fixed)
            self._exact._shapes = {z: list(shapes) for z, shapes in self._shapes.items()}
        if self._exact is not None and sure:
            alone = Solid(parts=solid.parts, z=solid.z)
            self._exact._block(alone, [move for move in moves if not move.error and move.points is not None])
        self._block(solid, moves)

    def _block(self, solid: Solid, moves: list[Move]) -> None:

        hulls: list[tuple[Pair, Floats]] = []
        for move in moves:
            z = self._heights(solid, move)
            if z is None:
                continue
            self._at_best(move.error)
            if not move.error:
                self._level.add(z)
            if move.points is None:
                box = self._box(solid, move)
                if box is not None:
                    self._shapes.setdefault((z, 0.0), []).append(box)
                    self._coarse(move)
            elif move.moves[:, :2].all():
                hulls.append((z, move.points))
            else:
                shape = self._seen(solid, move)
                if shape is not None:
                    self._shapes.setdefault((z, 0.0), []).append(shape)
        for part in solid.parts if hulls else ():
            for (z, _), shape in zip(hulls, _set_off(part, [points for _, points in hulls]), strict=True):
                self._shapes.setdefault((z, solid.grow), []).append(shape)

    def _coarse(self, move: Move) -> None:
        """A box around a move that is no box blocks more than the move does."""
        ends = move.low != move.high
        ways = (move.low[0] != move.low[1]) | (move.moves[0] != move.moves[1])
        if ends.any() or int(ways.sum()) > 1:
            self.resolution = None

    def _grown(self, shape: Any, grow: float) -> Any:
        if not grow:
            return shape
        # The circle's polygon around it, not in it. GEOS rounds the number of chords at a corner: one of them may span
        # half as much again as a step.
        steps = max(8, math.ceil(WIDEST * math.pi / 4 / math.acos(1 / (1 + ROUND / grow))))
        self._at_best(ROUND)
        return shape.buffer(grow / math.cos(WIDEST * math.pi / 4 / steps), quad_segs=steps)

    def _at_best(self, error: float) -> None:
        if self.resolution is not None:
            self.resolution = max(self.resolution, error) if math.isfinite(error) else None

    def _heights(self, solid: Solid, move: Move) -> Pair | None:
        """The open range of the Z offset for which the move is at the heights of the zone."""
        ends = _axis_range(solid.z, move, 2)
        if ends is None or self.fixed[2]:
            return ends
        low, high = self.ranges[2]
        return None if ends[0] >= high + THIN or ends[1] <= low - THIN else ends

    def _box(self, solid: Solid, move: Move) -> Any:
        """For moves of which only a box is known."""
        import shapely

        sides = solid.box()
        x, y = _axis_range(sides[0], move, 0), _axis_range(sides[1], move, 1)
        if x is None or y is None:
            return None
        if solid.grow:
            self.resolution = None
        (x0, x1), (y0, y1) = _finite(x), _finite(y)
        return shapely.box(x0, y0, x1, y1)

    def _seen(self, solid: Solid, move: Move) -> Any:
        """A straight move of which not all moves with the offsets of X and Y."""
        import shapely

        assert move.points is not None
        first, last = move.moves[0, :2], move.moves[1, :2]
        if (first == last).all():
            whole = shapely.union_all(np.concatenate([_set_off(part, [move.points]) for part in solid.parts]))
            return self._slice(self._grown(whole, solid.grow), first)
        if first.any() and last.any():
            self._coarse(move)
            return self._box(solid, move)
        stays, goes = (0, 1) if last.all() else (1, 0)
        if not move.moves[goes, :2].all():
            self._coarse(move)
            return self._box(solid, move)
        found = []
        for part in solid.parts:
            grown = self._grown(shapely.Polygon(part), solid.grow)
            found.append(_behind(np.asarray(grown.exterior.coords)[:-1], move.low[stays, :2]))
        if any(shape is None for shape in found):
            self.resolution = None
            return self._box(solid, move)
        from shapely.affinity import translate

        return translate(shapely.union_all(found), -move.low[goes, 0], -move.low[goes, 1])

    def _slice(self, shape: Any, moving: npt.NDArray[np.bool_]) -> Any:
        """Where the offset of only one of X and Y counts, or of none."""
        import shapely

        if not moving.any():
            inside = bool(shapely.contains_xy(shape, 0.0, 0.0)) if not shape.is_empty else False
            return shapely.box(-FAR, -FAR, FAR, FAR) if inside else None
        axis = 0 if moving[0] else 1
        line = [(-2 * FAR, 0.0), (2 * FAR, 0.0)] if axis == 0 else [(0.0, -2 * FAR), (0.0, 2 * FAR)]
        cut = shapely.intersection(shape, shapely.LineString(line))
        strips = []
        for part in getattr(cut, "geoms", [cut]):
            ends = part.bounds
            if part.is_empty or ends[axis + 2] - ends[axis] <= THIN:
                continue
            inner = (ends[axis] + ends[axis + 2]) / 2
            if not shapely.contains_xy(shape, *((inner, 0.0) if axis == 0 else (0.0, inner))):
                continue  # along an edge
            sides = (ends[0], -FAR, ends[2], FAR) if axis == 0 else (-FAR, ends[1], FAR, ends[3])
            strips.append(shapely.box(*sides))
        return shapely.union_all(strips) if strips else None

    def region(self) -> Region:
        """What is left of the ranges, layer by layer."""
        import shapely

        sides = [(-1.0, 1.0) if fixed else ends for ends, fixed in zip(self.ranges, self.fixed, strict=True)]
        thick = [(low - THIN, high + THIN) if high - low < THIN else (low, high) for low, high in sides]
        whole = shapely.box(thick[0][0], thick[1][0], thick[0][1], thick[1][1])
        by_height: dict[Pair, list[Any]] = {}
        for (z, grow), found in self._rounded(sides[2]).items():
            by_height.setdefault(z, []).append(self._grown(shapely.union_all(found), grow))
        shapes = {z: shapely.union_all(found) for z, found in by_height.items()}
        marks = sorted({sides[2][0], sides[2][1], *(v for z in shapes for v in z if sides[2][0] < v < sides[2][1])})
        pairs = list(itertools.pairwise(marks)) or [(marks[0], marks[0])]
        if self.fixed[2]:
            pairs = [(0.0, 0.0)]
        layers: list[Layer] = []
        for low, high in pairs:
            middle = (low + high) / 2
            active = [shape for (a, b), shape in shapes.items() if a < middle < b]
            left = _thick(shapely.difference(whole, shapely.union_all(active)) if active else whole)
            if left.is_empty:
                continue
            if layers and layers[-1].z[1] == low and left.equals(layers[-1].left):
                layers[-1] = Layer(z=(layers[-1].z[0], high), left=left)
            else:
                layers.append(Layer(z=(low, high), left=left))
        hopeless = not layers and (self.resolution == 0.0 or (self._exact is not None and self._exact.hopeless()))
        return Region(layers=tuple(layers), resolution=self.resolution, hopeless=hopeless)

    def hopeless(self) -> bool:
        """Whether nothing is left, and nothing was blocked that is free."""
        return self.region().empty and self.resolution == 0.0

    def _rounded(self, z: Pair) -> dict[tuple[Pair, float], list[Any]]:
        """Shapes by their heights; where these are too many, those of climbing moves are rounded outwards, then all."""

        def marks(heights: Iterable[Pair]) -> set[float]:
            return {value for ends in heights for value in ends if z[0] < value < z[1]}

        if len(marks(ends for ends, _ in self._shapes)) <= SLABS or self.fixed[2]:
            return self._shapes
        level = marks(self._level)
        level = level if len(level) <= SLABS else set()
        grid = [float(v) for v in np.linspace(z[0], z[1], SLABS + 1)]
        all_ = np.array(sorted({*level, *grid}))
        self._at_best((z[1] - z[0]) / SLABS)
        out: dict[tuple[Pair, float], list[Any]] = {}
        for ((low, high), grow), shapes in self._shapes.items():
            below, above = all_[all_ <= low + SAME], all_[all_ >= high - SAME]
            ends = float(below[-1]) if len(below) else -math.inf, float(above[0]) if len(above) else math.inf
            out.setdefault((ends, grow), []).extend(shapes)
        return out


def _finite(ends: Pair) -> Pair:
    return max(ends[0], -FAR), min(ends[1], FAR)


def _thick(shape: Any) -> Any:
    """Without parts that are only the rounding of two edges that meet."""
    import shapely

    parts = [part for part in getattr(shape, "geoms", [shape]) if part.geom_type == "Polygon"]
    kept = [part for part in parts if not part.buffer(-THIN / 4).is_empty]
    return shapely.union_all(kept)


def _axis_range(sides: Pair, move: Move, axis: int) -> Pair | None:
    """The open range of an axis's offset for which the box around the move meets the zone between ``sides``."""
    low, high = -math.inf, math.inf
    first, last = move.moves[0, axis], move.moves[1, axis]
    least, most = move.low[:, axis], move.high[:, axis]
    if first == last:
        if not first:
            return (low, high) if min(least) < sides[1] and max(most) > sides[0] else None
        return sides[0] - float(max(most)), sides[1] - float(min(least))
    stays, goes = (0, 1) if last else (1, 0)
    if not least[stays] < sides[1]:
        high = sides[1] - float(least[goes])
    if not most[stays] > sides[0]:
        low = sides[0] - float(most[goes])
    return (low, high) if low < high else None


def meets(solid: Solid, move: Move) -> bool:
    """Whether the box around a move that no offset moves meets the box around a zone."""
    return all(_axis_range(sides, move, axis) is not None for axis, sides in enumerate(solid.box()))


def _set_off(part: Floats, points: list[Floats]) -> npt.NDArray[Any]:
    """(n,): hulls of a convex part set off from all points of a move, for each move."""
    import shapely

    out = np.empty(len(points), dtype=object)
    by_count: dict[int, list[int]] = {}
    for number, one in enumerate(points):
        by_count.setdefault(len(one), []).append(number)
    for numbers in by_count.values():
        places = np.stack([points[number] for number in numbers])
        corners = (part[np.newaxis, np.newaxis] - places[:, :, np.newaxis]).reshape(len(places), -1, 2)
        hulls: Any = shapely.convex_hull(shapely.multipoints(corners))
        out[numbers] = hulls
    return out


def _behind(part: Floats, eye: Floats) -> shapely.Polygon | None:
    """A convex part and all that is after it, seen from ``eye``; None where that is nearly half of the plane."""
    import shapely

    way = part - eye
    length = np.hypot(way[:, 0], way[:, 1])
    if (length < 1e-6).any() or shapely.Polygon(part).buffer(1e-9).contains(shapely.Point(eye)):
        return None
    angles = np.arctan2(way[:, 1], way[:, 0])
    spread = (angles - angles[0] + math.pi) % (2 * math.pi) - math.pi
    half = float(spread.max() - spread.min()) / 2
    if math.cos(half) < 0.05:
        return None
    far = eye + way / length[:, np.newaxis] * (4 * FAR / math.cos(half))
    hull = shapely.convex_hull(shapely.multipoints(np.concatenate([part, far])))
    return hull if isinstance(hull, shapely.Polygon) else None


# -- rows as moves


def straight(start: Floats, end: Floats, moves: npt.NDArray[np.bool_], *, free: bool = False) -> list[Move]:
    """A move whose ends are known but for the offsets; in pieces where it climbs on its way. free: not straight."""
    both = np.stack([start, end])
    alike = bool((moves[0] == moves[1]).all())
    if free and alike:
        x, y = both[:, 0], both[:, 1]
        corners = np.array([[a, b] for a in x for b in y])
        return [
            Move(
                low=both,
                high=both,
                moves=moves,
                points=corners,
                error=0.0 if (moves[0] == moves[1]).all() else math.inf,
            )
        ]
    alike = bool((moves[0] == moves[1]).all())
    leans = start[2] != end[2] or bool(moves[0, 2] != moves[1, 2])
    leans = leans and (bool((start[:2] != end[:2]).any()) or bool((moves[0, :2] != moves[1, :2]).any()))
    if not leans or not alike:
        return [Move(low=both, high=both, moves=moves, points=both[:, :2], error=math.inf if leans else 0.0)]
    height = abs(float(end[2] - start[2]))
    count = min(400, math.ceil(height / CLIMB))
    marks = start + (end - start) * np.linspace(0.0, 1.0, count + 1)[:, np.newaxis]
    return [Move(low=marks[k : k + 2], high=marks[k : k + 2], moves=moves, points=marks[k : k + 2, :2],
                 error=height / count) for k in range(count)]  # fmt: skip


def around_arc(
    start: Floats, end: Floats, center: Floats, turns: int, pair: tuple[int, int], moves: npt.NDArray[np.bool_]
) -> list[Move]:  # fmt: skip
    """An arc in the plane ``pair``, all of which moves with its frame, in pieces with a hull around each."""
    u, v = pair
    w = 3 - u - v
    su, sv = float(start[u] - center[u]), float(start[v] - center[v])
    eu, ev = float(end[u] - center[u]), float(end[v] - center[v])
    r0, r1 = math.hypot(su, sv), math.hypot(eu, ev)
    biggest = max(r0, r1, 1e-9)
    sweep = math.copysign(arc_extreme(su, sv, eu, ev, turns)[4], turns)
    count = max(1, math.ceil(abs(sweep) / min(math.pi / 8, math.sqrt(8 * ROUND / biggest))))
    rise = abs(float(end[2] - start[2])) if w == 2 else 0.0
    count = max(count, min(400, math.ceil(rise / CLIMB)))
    part = np.linspace(0.0, 1.0, count + 1)
    angles, radii = math.atan2(sv, su) + sweep * part, r0 + (r1 - r0) * part
    # The chord between two places pushed out so far touches the arc, at the greater radius.
    outer = np.full(count + 1, biggest / math.cos(abs(sweep) / count / 2))
    marks, pushed = np.empty((count + 1, 3)), np.empty((count + 1, 3))
    for places, sizes in ((marks, radii), (pushed, outer)):
        places[:, u] = center[u] + sizes * np.cos(angles)
        places[:, v] = center[v] + sizes * np.sin(angles)
        places[:, w] = start[w] + (end[w] - start[w]) * part
    error = biggest * abs(sweep) / count if w != 2 else max(float(outer[0]) - min(r0, r1), rise / count)
    out = []
    for k in range(count):
        around = np.concatenate([marks[k : k + 2], pushed[k : k + 2]])
        low, high = around.min(axis=0), around.max(axis=0)
        out.append(
            Move(
                low=np.stack([low, low]), high=np.stack([high, high]), moves=moves, points=around[:, :2], error=error
            )
        )  # fmt: skip
    return out


def together(places: Floats, moves: npt.NDArray[np.bool_]) -> Move:
    """Straight moves from place to place, (n, 3), as one that has all of them in its hull."""
    low, high = places.min(axis=0), places.max(axis=0)
    return Move(
        low=np.stack([low, low]), high=np.stack([high, high]), moves=moves, points=places[:, :2], error=math.inf
    )


def around_box(
    start: Floats, end: Floats, center: Floats, turns: int, pair: tuple[int, int], moves: npt.NDArray[np.bool_]
) -> Move:  # fmt: skip
    """An arc as the box around it."""
    u, v = pair
    low, high = np.minimum(start, end), np.maximum(start, end)
    ends = [float(place[axis] - center[axis]) for place in (start, end) for axis in pair]
    found = arc_extreme(ends[0], ends[1], ends[2], ends[3], turns)
    for axis, least, most in ((u, found[0], found[1]), (v, found[2], found[3])):
        low[axis], high[axis] = min(low[axis], center[axis] + least), max(high[axis], center[axis] + most)
    corners = np.array([[x, y] for x in (low[0], high[0]) for y in (low[1], high[1])])
    return Move(low=np.stack([low, low]), high=np.stack([high, high]), moves=moves, points=corners, error=math.inf)


def joined(moves: list[Move], most: int = MOST) -> list[Move]:
    """So many moves at most: neighbours that move alike become one with the hull of both."""
    if len(moves) <= most:
        return moves
    size = math.ceil(len(moves) / most)
    out: list[Move] = []
    run: list[Move] = []

    def end() -> None:
        if len(run) == 1:
            out.append(run[0])
        elif run:
            low = np.min([m.low.min(axis=0) for m in run], axis=0)
            high = np.max([m.high.max(axis=0) for m in run], axis=0)
            points = np.concatenate([m.points for m in run if m.points is not None])
            out.append(
                Move(low=np.stack([low, low]), high=np.stack([high, high]), moves=run[0].moves, points=points,
                     error=math.inf)
            )  # fmt: skip
        run.clear()

    for move in moves:
        same = bool((move.moves[0] == move.moves[1]).all()) and move.points is not None
        if not same or (run and (run[0].moves != move.moves).any()) or len(run) == size:
            end()
        if same:
            run.append(move)
        else:
            out.append(move)
    end()
    return out
