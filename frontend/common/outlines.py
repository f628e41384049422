"""Rings to polygons, and polygons with floors to prisms on top of one another.

Takes closed rings of points (mm) as a drawing or a list has them, in any order and sense; gives ``Prism``s. Rings that
lie in one another are holes by turns (even-odd). A ring that crosses itself or another one is an ``OutlineError`` with
the place.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from gproof.ir.record import record
from gproof.ir.workpiece import Point, Prism

if TYPE_CHECKING:
    from shapely import Polygon
    from shapely.coords import CoordinateSequence
    from shapely.geometry.base import BaseGeometry

Ring = Sequence[Point]

NARROW = 1e-9
"""mm2: what overlaps by less than that has only touched."""
CUT = 1e-9
"""mm by which the corners of a pocket's outline move where it is cut at another outline."""


class OutlineError(ValueError):
    """What keeps rings from being outlines, in words with the place."""


@record(frozen=True, slots=True)
class Pocket:
    """What is taken away above a floor: rings, and the height of the floor in mm."""

    rings: tuple[tuple[Point, ...], ...]
    floor: float


def place(x: float, y: float) -> str:
    """A point in a message."""
    return f"X {x:.4f} Y {y:.4f}"


def prisms(
    rings: Sequence[Ring], low: float, high: float, pockets: Sequence[Pocket] = (), error: float = 0.0
) -> list[Prism]:
    """What is inside the rings from ``low`` to ``high``, less the pockets; OutlineError for bad rings."""
    whole = regions(rings)
    floors = sorted({min(max(pocket.floor, low), high) for pocket in pockets} | {low, high})
    cuts = [(pocket.floor, regions(pocket.rings)) for pocket in pockets]
    found: list[Prism] = []
    for bottom, top in itertools.pairwise(floors):
        left, cut = whole, error
        for floor, region in cuts:
            if floor <= bottom:
                left, cut = left.difference(region), error + CUT
        found += [_prism(piece, bottom, top, cut) for piece in _pieces(left)]
    if not found:
        raise OutlineError("the pockets leave nothing of it")
    return found


def regions(rings: Sequence[Ring]) -> BaseGeometry:
    """What the rings enclose by turns; OutlineError where they cross."""
    import shapely

    made = sorted((_checked(ring) for ring in rings), key=lambda polygon: -polygon.area)
    tree = shapely.STRtree(made)
    inside: list[list[int]] = [[] for _ in made]
    touching = False
    for one, other in tree.query(made, predicate="intersects").T.tolist():
        if one < other:
            clear = made[one].contains_properly(made[other])
            if not clear:
                _apart(made[one], made[other])
            if clear or made[one].contains(made[other].representative_point()):
                inside[other].append(one)
            touching = touching or not clear
    # The next ring around another is the one with one ring less around it.
    within: list[list[int]] = [[] for _ in made]
    for inner, around in enumerate(inside):
        for outer in around:
            if len(inside[outer]) == len(around) - 1:
                within[outer].append(inner)
    pieces = [
        shapely.Polygon(polygon.exterior.coords, [made[k].exterior.coords for k in within[n]])
        for n, polygon in enumerate(made)
        if len(inside[n]) % 2 == 0
    ]
    # What does not touch is whole as it is.
    return shapely.union_all(pieces) if touching else shapely.MultiPolygon(pieces)


def _checked(ring: Ring) -> Polygon:
    import shapely

    points = list(ring)
    if len(points) > 1 and points[0] == points[-1]:
        points.pop()
    if len(points) < 3:
        raise OutlineError(f"an outline of {len(points)} corners has no area")
    polygon = shapely.Polygon(np.array(points))
    if not all(map(math.isfinite, polygon.bounds)):
        raise OutlineError("a corner of an outline is not a finite number")
    if not polygon.is_valid:
        raise OutlineError(_reason(shapely.is_valid_reason(polygon)))
    if polygon.area <= NARROW:
        raise OutlineError(f"the outline at {place(*points[0])} has no area")
    return polygon


def _reason(text: str) -> str:
    """What GEOS says of a ring, in the words of the other messages."""
    what, _, at = text.partition("[")
    words = {"Self-intersection": "the outline crosses itself", "Ring Self-intersection": "the outline touches itself"}
    numbers = at.rstrip("]").split()
    said = words.get(what.strip(), what.strip())
    return f"{said} at {place(float(numbers[0]), float(numbers[1]))}" if len(numbers) >= 2 else said


def _apart(one: Polygon, other: Polygon) -> None:
    """OutlineError unless one polygon is inside the other or outside it."""
    if one.equals(other):
        raise OutlineError(f"an outline is drawn twice at {place(*other.exterior.coords[0])}")
    common = one.intersection(other)
    if common.area <= NARROW or other.area - common.area <= NARROW:
        return
    crossing = one.exterior.intersection(other.exterior)
    point = crossing.representative_point() if not crossing.is_empty else common.representative_point()
    raise OutlineError(f"two outlines cross at {place(point.x, point.y)}")


def _pieces(region: object) -> Iterable[Polygon]:
    import shapely

    if isinstance(region, shapely.Polygon):
        return [region] if region.area > NARROW else []
    parts = getattr(region, "geoms", ())
    return [piece for part in parts for piece in _pieces(part)]


def _prism(polygon: Polygon, low: float, high: float, error: float) -> Prism:
    from shapely.geometry.polygon import orient

    turned = orient(polygon)
    return Prism(
        outline=_points(turned.exterior.coords), holes=tuple(_points(ring.coords) for ring in turned.interiors),
        low=low, high=high, error=error,
    )  # fmt: skip


def _points(coords: CoordinateSequence) -> tuple[Point, ...]:
    return tuple((x, y) for x, y in np.asarray(coords)[:-1, :2].tolist())
