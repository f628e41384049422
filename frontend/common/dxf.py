"""Closed outlines of a DXF drawing, by layer.

Takes a file and a chord error (drawing units); gives rings of points. LWPOLYLINE and POLYLINE with bulges, LINE, ARC,
CIRCLE, ELLIPSE, SPLINE, and these in blocks; what is open is joined end to end within a tolerance. Curves become chords
whose distance from the curve is bounded: a circle's by its sagitta, an ellipse's and a spline's by their second
derivatives. ``DxfError`` says what is wrong and where.
"""

from __future__ import annotations

import itertools
import logging
import math
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gproof.frontend.common.outlines import place
from gproof.ir.record import field, record
from gproof.ir.workpiece import Point

if TYPE_CHECKING:
    from ezdxf.document import Drawing

LARGEST_FILE = 256_000_000
MOST_POINTS = 4_000_000
MOST_COPIES = 30_000
"""Copies of blocks in all: an array has up to 10^9 of them in one line, and each may hold others."""
MOST_CHORDS = 100_000
"""Of one curve: a circle of two kilometres within a micrometre."""
DEEPEST_BLOCK = 16
_BESIDE = frozenset(
    "TEXT MTEXT DIMENSION ARC_DIMENSION POINT LEADER MULTILEADER MLEADER ATTRIB ATTDEF IMAGE VIEWPORT HATCH "
    "TOLERANCE XLINE RAY WIPEOUT ACAD_TABLE".split()
)
"""Kinds of entities that are no outlines: labels, hatches, construction lines."""
MILLIMETRES = {1: 25.4, 2: 304.8, 4: 1.0, 5: 10.0, 6: 1000.0, 8: 25.4e-6, 9: 0.0254, 13: 0.001, 14: 100.0}
"""mm in a drawing unit by $INSUNITS: inch, foot, mm, cm, m, microinch, mil, micrometre, decimetre."""
_NAMES = {1: "inch", 4: "mm"}


NO_READER = "to read a DXF drawing, install ezdxf: pip install 'gproof[dxf]', or pipx inject gproof ezdxf"
"""The one library that only drawings need is an extra of its own; pipx is for those whose system keeps pip away."""


class DxfError(ValueError):
    """What keeps a drawing from being outlines, in words with the place."""


@record(slots=True)
class Layer:
    """rings: closed outlines; gap: the widest gap (drawing units) that was closed to make them."""

    rings: list[list[Point]] = field(default_factory=list)
    gap: float = 0.0


@record(slots=True)
class Chain:
    """Points in order, and what they were drawn as."""

    points: list[Point]
    what: str
    closed: bool = False


@record(slots=True)
class Sheet:
    """A drawing that was read. unit: mm in a drawing unit, None where it does not say; names: of its layers."""

    document: Drawing
    unit: float | None
    unit_name: str
    names: tuple[str, ...]


def open_drawing(path: Path) -> Sheet:
    """The drawing in a file; DxfError when it is none, its unit is no length of ours, or ezdxf is not installed."""
    if path.stat().st_size > LARGEST_FILE:
        raise DxfError(f"{path.stat().st_size / 1e6:.0f} MB; gproof reads drawings up to {LARGEST_FILE / 1e6:.0f} MB")
    logging.getLogger("ezdxf").setLevel(logging.CRITICAL)
    try:
        from ezdxf.filemanagement import readfile
    except ModuleNotFoundError:
        raise DxfError(NO_READER) from None

    try:
        document = readfile(path)
        unit = int(document.header.get("$INSUNITS", 0))
        names = sorted({entity.dxf.layer for entity in document.modelspace() if entity.dxftype() not in _BESIDE})
    except OSError:
        raise DxfError("this is not a DXF file") from None
    except Exception as error:
        # What a broken file makes of a reader of 300 kinds of records is not to be listed.
        raise DxfError(f"this DXF file cannot be read: {' '.join(str(error).split())[:200]}") from None
    if unit and unit not in MILLIMETRES:
        raise DxfError(f"$INSUNITS is {unit}, which is not a unit of a workpiece")
    return Sheet(document, MILLIMETRES.get(unit), _NAMES.get(unit, f"$INSUNITS {unit}"), tuple(names))


def layers(sheet: Sheet, names: Iterable[str] | None, error: float, join: float) -> dict[str, Layer]:
    """The outlines of some layers, of all for None; error, join: drawing units. DxfError with the place."""
    wanted = None if names is None else {name.lower(): name for name in names}
    chains: dict[str, list[Chain]] = {name: [] for name in (wanted or {}).values()}
    total = 0
    try:
        for layer, chain in _chains(sheet.document.modelspace(), error, "0", 0, [0]):
            name = layer if wanted is None else wanted.get(layer.lower())
            if name is None:
                continue
            total += len(chain.points)
            if total > MOST_POINTS:
                raise DxfError(f"more than {MOST_POINTS} corners")
            chains.setdefault(name, []).append(chain)
    except DxfError:
        raise
    except MemoryError:
        raise
    except Exception as failed:
        # As of a file: what a broken entity makes of its reader is not to be listed.
        raise DxfError(f"an entity cannot be read: {' '.join(str(failed).split())[:200]}") from None
    return {name: joined(found, join, name) for name, found in chains.items()}


def _chains(
    entities: Iterable[Any], error: float, block_layer: str, depth: int, copies: list[int]
) -> Iterator[tuple[str, Chain]]:
    for entity in entities:
        kind = entity.dxftype()
        layer = entity.dxf.layer if entity.dxf.layer != "0" or depth == 0 else block_layer
        if kind in _BESIDE or entity.dxf.get("paperspace", 0):
            continue
        if kind == "INSERT":
            if depth >= DEEPEST_BLOCK:
                raise DxfError("blocks are nested too deep")
            copies[0] += entity.mcount
            if copies[0] > MOST_COPIES:
                raise DxfError(f"more than {MOST_COPIES} copies of blocks")
            for copy in entity.multi_insert() if entity.mcount > 1 else (entity,):
                yield from _chains(copy.virtual_entities(), error, layer, depth + 1, copies)
            continue
        make = _MAKERS.get(kind)
        if make is None:
            raise DxfError(
                f"{kind} on layer {layer!r} is not an outline that gproof reads; explode it to lines and arcs"
            )
        try:
            points, closed = make(entity, error)
        except DxfError:
            raise
        except _UNREADABLE as failed:
            said = " ".join(str(failed).split())[:200]
            raise DxfError(f"{kind} on layer {layer!r} cannot be read: {said}; explode it to lines and arcs") from None
        if not all(math.isfinite(value) for point in points for value in point):
            raise DxfError(f"{kind} on layer {layer!r}: a coordinate is not a finite number")
        if len(points) > 1:
            yield layer, Chain(points, f"{kind} on layer {layer!r}", closed)


_UNREADABLE = (ArithmeticError, LookupError, AttributeError, TypeError, RecursionError, ValueError)
"""What numbers that fit no curve make of its making; a ``DxfError``, which is one of them, says it itself."""


# ---- entities to points


def _world(entity: Any, points: Iterable[tuple[float, float]], height: float) -> list[Point]:
    """Points of an entity's own coordinates in those of the drawing; DxfError unless it is flat."""
    normal = entity.dxf.get("extrusion", (0.0, 0.0, 1.0))
    if tuple(normal) == (0.0, 0.0, 1.0):
        return [(float(x), float(y)) for x, y in points]
    if abs(normal[0]) > 1e-9 or abs(normal[1]) > 1e-9:
        raise DxfError(f"{entity.dxftype()} on layer {entity.dxf.layer!r} is not in the X-Y plane")
    ocs = entity.ocs()
    return [(float(p.x), float(p.y)) for p in (ocs.to_wcs((x, y, height)) for x, y in points)]


def arc_points(center: Point, radius: float, begin: float, sweep: float, error: float) -> list[Point]:
    """Points on an arc from angle ``begin`` over ``sweep`` (radians), whose chords are within ``error`` of it."""
    if radius <= 0.0:
        return []
    # The sagitta of a chord over the angle t is r (1 - cos(t/2)).
    half = math.acos(max(-1.0, 1.0 - error / radius)) if error < radius else math.pi / 4
    count = _chords(abs(sweep) / (2.0 * half) if half else math.inf, 2)
    return [
        (
            center[0] + radius * math.cos(begin + sweep * k / count),
            center[1] + radius * math.sin(begin + sweep * k / count),
        )
        for k in range(count + 1)
    ]


def _chords(needed: float, least: int) -> int:
    """So many chords; DxfError for a curve that no workpiece has."""
    if not needed <= MOST_CHORDS:
        raise DxfError("a curve is too large, or its numbers are not finite")
    return max(least, math.ceil(needed))


def _line(entity: Any, error: float) -> tuple[list[Point], bool]:
    one, other = entity.dxf.start, entity.dxf.end
    return [(float(one.x), float(one.y)), (float(other.x), float(other.y))], False


def _arc(entity: Any, error: float) -> tuple[list[Point], bool]:
    begin, end = math.radians(entity.dxf.start_angle), math.radians(entity.dxf.end_angle)
    sweep = math.fmod(end - begin, math.tau)
    sweep += math.tau if sweep <= 0.0 else 0.0
    center = entity.dxf.center
    made = arc_points((center.x, center.y), entity.dxf.radius, begin, sweep, error)
    return _world(entity, made, center.z), False


def _circle(entity: Any, error: float) -> tuple[list[Point], bool]:
    center = entity.dxf.center
    made = arc_points((center.x, center.y), entity.dxf.radius, 0.0, math.tau, error)
    return _world(entity, made[:-1], center.z), True


def _bulged(corners: Sequence[tuple[float, float, float]], closed: bool, error: float) -> list[Point]:
    """Corners with bulges: the tangent of a quarter of the arc to the next one, above 0 counter-clockwise."""
    points: list[Point] = []
    pairs = zip(corners, [*corners[1:], corners[0]] if closed else corners[1:], strict=False)
    for (x, y, bulge), (u, v, _) in pairs:
        points.append((x, y))
        chord = math.hypot(u - x, v - y)
        if bulge == 0.0 or chord == 0.0:
            continue
        sweep = 4.0 * math.atan(bulge)
        radius = chord * (1.0 + bulge * bulge) / (4.0 * abs(bulge))
        # From the middle of the chord to the centre, to the left of the path for a bulge below 1.
        away = chord * (1.0 - bulge * bulge) / (4.0 * bulge)
        center = ((x + u) / 2.0 - (v - y) / chord * away, (y + v) / 2.0 + (u - x) / chord * away)
        points += arc_points(center, radius, math.atan2(y - center[1], x - center[0]), sweep, error)[1:-1]
    if not closed and corners:
        points.append((corners[-1][0], corners[-1][1]))
    return points


def _lwpolyline(entity: Any, error: float) -> tuple[list[Point], bool]:
    corners = [(float(x), float(y), float(b)) for x, y, b in entity.get_points("xyb")]
    closed = bool(entity.closed)
    return _world(entity, _bulged(corners, closed, error), entity.dxf.elevation), closed


def _polyline(entity: Any, error: float) -> tuple[list[Point], bool]:
    if not (entity.is_2d_polyline or entity.is_3d_polyline):
        raise DxfError(f"POLYLINE on layer {entity.dxf.layer!r} is a mesh, not an outline")
    if entity.dxf.flags & 6:
        raise DxfError(f"POLYLINE on layer {entity.dxf.layer!r} is fitted by a curve; explode it to lines and arcs")
    corners = [
        (float(v.dxf.location.x), float(v.dxf.location.y), float(v.dxf.get("bulge", 0.0))) for v in entity.vertices
    ]
    closed = bool(entity.is_closed)
    made = _bulged(corners, closed, error)
    return (_world(entity, made, 0.0) if entity.is_2d_polyline else made), closed


def _ellipse(entity: Any, error: float) -> tuple[list[Point], bool]:
    normal = entity.dxf.extrusion
    if abs(normal.x) > 1e-9 or abs(normal.y) > 1e-9:
        raise DxfError(f"ELLIPSE on layer {entity.dxf.layer!r} is not in the X-Y plane")
    center, major, minor = entity.dxf.center, entity.dxf.major_axis, entity.minor_axis
    begin, end = entity.dxf.start_param, entity.dxf.end_param
    sweep = math.fmod(end - begin, math.tau)
    sweep += math.tau if sweep <= 1e-12 else 0.0
    # A chord over t leaves a curve by at most max |second derivative| t*t/8, which is the longer half axis.
    longest = max(math.hypot(major.x, major.y), math.hypot(minor.x, minor.y))
    count = _chords(sweep * math.sqrt(longest / (8.0 * error)), 8)
    points = []
    for k in range(count + 1):
        t = begin + sweep * k / count
        points.append((
            center.x + major.x * math.cos(t) + minor.x * math.sin(t),
            center.y + major.y * math.cos(t) + minor.y * math.sin(t),
        ))  # fmt: skip
    closed = sweep >= math.tau - 1e-9
    return (points[:-1] if closed else points), closed


def _spline(entity: Any, error: float) -> tuple[list[Point], bool]:
    what = f"SPLINE on layer {entity.dxf.layer!r}"
    if not entity.control_point_count():
        raise DxfError(
            f"{what} has no control points, and several curves pass through others; explode it to lines and arcs"
        )
    knots = [float(knot) for knot in entity.knots]
    if len(knots) != entity.control_point_count() + entity.dxf.degree + 1 or knots != sorted(knots):
        raise DxfError(f"{what} has knots that do not fit its control points")
    if len(set(knots[: entity.dxf.degree + 1])) > 1 or len(set(knots[-entity.dxf.degree - 1 :])) > 1:
        raise DxfError(f"{what} does not start and end at its outer control points; explode it to lines and arcs")
    curve = entity.construction_tool()
    if curve.is_rational and len({round(w, 12) for w in curve.weights()}) > 1:
        raise DxfError(f"{what} has weights, which gproof does not read; explode it to lines and arcs")
    points: list[Point] = []
    for piece in curve.bezier_decomposition():
        made = _bezier([(float(p.x), float(p.y)) for p in piece], error)
        points += made[1:] if points else made
    if not points:
        raise DxfError(f"{what} has no points")
    closed = math.hypot(points[0][0] - points[-1][0], points[0][1] - points[-1][1]) <= error
    return (points[:-1] if closed else points), closed


def _bezier(controls: Sequence[Point], error: float) -> list[Point]:
    """A Bezier curve of degree d: its second derivative is at most d (d - 1) times the largest second difference."""
    degree = len(controls) - 1
    bend = max(
        (
            math.hypot(a[0] - 2.0 * b[0] + c[0], a[1] - 2.0 * b[1] + c[1])
            for a, b, c in zip(controls, controls[1:], controls[2:], strict=False)
        ),
        default=0.0,
    )
    count = _chords(math.sqrt(degree * (degree - 1) * bend / (8.0 * error)), 1)
    found = []
    for k in range(count + 1):
        t, level = k / count, list(controls)
        while len(level) > 1:
            level = [(a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t) for a, b in itertools.pairwise(level)]
        found.append(level[0])
    return found


_MAKERS = {
    "LINE": _line, "ARC": _arc, "CIRCLE": _circle, "LWPOLYLINE": _lwpolyline, "POLYLINE": _polyline,
    "ELLIPSE": _ellipse, "SPLINE": _spline,
}  # fmt: skip


# ---- chains to rings


def joined(chains: Sequence[Chain], join: float, layer: str) -> Layer:
    """Rings of what is closed, and of open pieces whose ends lie within ``join``; DxfError for ends that are left."""
    found = Layer(rings=[chain.points for chain in chains if chain.closed])
    loose = []
    for chain in chains:
        if chain.closed:
            continue
        gap = _gap(chain.points[0], chain.points[-1])
        length = sum(_gap(a, b) for a, b in zip(chain.points, chain.points[1:], strict=False))
        if length <= join:
            continue
        if gap <= join and len(chain.points) > 3:
            found.rings.append(chain.points[:-1])
            found.gap = max(found.gap, gap)
        else:
            loose.append(chain)
    ends = _Ends(join)
    for number, chain in enumerate(loose):
        ends.add(chain.points[0], number, 0)
        ends.add(chain.points[-1], number, -1)
    used = [False] * len(loose)
    for first in range(len(loose)):
        ring: list[Point] = []
        number, side = first, 0
        while not used[number]:
            used[number] = True
            points = loose[number].points if side == 0 else loose[number].points[::-1]
            # The next piece goes on from its own end, which is within the gap of this one.
            ring += points[:-1]
            number, side, gap = ends.next(points[-1], number, -1 if side == 0 else 0, loose, layer)
            found.gap = max(found.gap, gap)
        if not ring:
            continue
        if number != first or side != 0:
            raise DxfError(
                f"layer {layer!r}: pieces meet at {place(*loose[number].points[side])} and do not make a closed outline"
            )
        found.rings.append(ring)
    return found


class _Ends:
    """Ends of open pieces, found by place."""

    def __init__(self, join: float) -> None:
        self.join = max(join, 1e-12)
        self._cells: dict[tuple[int, int], list[tuple[Point, int, int]]] = {}

    def _cell(self, at: Point) -> tuple[int, int]:
        return math.floor(at[0] / self.join), math.floor(at[1] / self.join)

    def add(self, at: Point, number: int, side: int) -> None:
        """An end: of which piece, and whether it is the first (0) or last (-1) point."""
        self._cells.setdefault(self._cell(at), []).append((at, number, side))

    def next(
        self, at: Point, number: int, side: int, chains: Sequence[Chain], layer: str
    ) -> tuple[int, int, float]:  # fmt: skip
        """The one other end within reach of an end; DxfError for none and for more than one."""
        i, j = self._cell(at)
        near = [
            (other, its, _gap(at, there))
            for u in (i - 1, i, i + 1)
            for v in (j - 1, j, j + 1)
            for there, other, its in self._cells.get((u, v), ())
            if (other, its) != (number, side) and _gap(at, there) <= self.join
        ]
        if not near:
            raise DxfError(
                f"layer {layer!r} is open at {place(*at)}: nothing continues within {self.join:g} of the end of "
                f"{chains[number].what.partition(' on ')[0]}{self._nearest(at, number, side)}"
            )
        if len(near) > 1:
            raise DxfError(
                f"layer {layer!r}: {len(near) + 1} ends meet at {place(*at)}; it is not clear which belong together"
            )
        return near[0]

    def _nearest(self, at: Point, number: int, side: int) -> str:
        others = [
            (_gap(at, there), there)
            for cell in self._cells.values()
            for there, other, its in cell
            if (other, its) != (number, side)
        ]
        if not others:
            return ""
        gap, there = min(others)
        return f"; the nearest other end is {gap:.4f} away at {place(*there)}"


def _gap(one: Point, other: Point) -> float:
    return math.hypot(one[0] - other[0], one[1] - other[1])
