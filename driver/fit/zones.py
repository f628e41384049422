"""Where offsets may be near the zones of a machine: what ``gproof fit`` adds to the ranges that the limits leave.

Rows whose places are known are judged as ``check`` does; those that rest on open offsets are taken while the job
streams by and become regions (``passes/checks/zones/zones_under_unknown_offsets.py``).
"""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from gproof.driver.condition_feasibility import contradiction
from gproof.driver.fit.open_offsets import Asked
from gproof.ir.record import record
from gproof.ir.setup import Interval
from gproof.ir.symbols import describe
from gproof.ir.trace import Affine, Chunk
from gproof.ir.verdict import Condition
from gproof.passes.checks.zones.face_conditions import View
from gproof.passes.checks.zones.offset_regions import FAR, Layer, Pair, Solid
from gproof.passes.checks.zones.shapes import Polygon, Rectangle, Shape
from gproof.passes.checks.zones.zones_under_unknown_offsets import OpenZones, Place, Ranges, Resolve, Stand

_STATED = ("work", "g92", "tool", "head")
_SIDE = 1e-3
"""mm by which the nearest place that is reported is inside."""
_SIDES = 3
"""Sides of all zones at which an unknown start is tried."""
_TRIED = 20_000
"""Choices of boxes of several groups that are looked at for one that all agree on."""


class ZoneWatch:
    """Takes the rows of the open job that rest on something unknown near zones (``passes/checks/zones/zones.py``:
    hears)."""

    def __init__(self, asked: Asked) -> None:
        self._asked = asked
        self._rows = OpenZones()
        self._symbols: dict[str, Interval] = {}
        self._stands: dict[int, tuple[View, Stand]] = {}
        self.assumed = ""
        """What the places depend on of an unknown start, in words."""

    def __call__(
        self, name: str, view: View, chunk: Chunk, mine: npt.NDArray[np.bool_], is_straight: bool | None
    ) -> None:  # fmt: skip
        """Take some rows of a chunk."""
        self._symbols.update(chunk.trace.symbols)
        _, stand = self._stands.setdefault(id(view), (view, _stand(name, view)))
        self._rows.add(chunk, stand, mine, is_straight=is_straight)

    def places(self, ranges: Ranges, starts: Ranges) -> tuple[Place, ...] | None:
        """What the zones leave of the ranges, where they leave not all of it; None: not known. starts: of the start."""
        if self._rows.empty:
            return ()

        def resolve(form: Affine) -> tuple[Affine, Pair]:
            own: list[tuple[str, int]] = []
            low = high = 0.0
            for symbol, count in form:
                kind = symbol.split(".", maxsplit=1)[0]
                known = None if self._asked.is_open(symbol) else self._symbols.get(symbol) or self._asked.stated(symbol)
                if known is None and kind in _STATED:
                    own.append((symbol, count))
                    continue
                ends = starts.get(((symbol, 1),), (-math.inf, math.inf)) if known is None else (known.low, known.high)
                least, most = sorted((ends[0] * count, ends[1] * count))
                low, high = low + least, high + most
            return tuple(own), (low, high)

        # A zone that moves with the work is, for moves in machine coordinates, at the negative of the offset.
        ranges = ranges | {negated(form): (-high, -low) for form, (low, high) in ranges.items()}
        found = self._rows.places(resolve, ranges)
        if found is None or any(place.region.empty and not place.region.hopeless for place in found):
            found = self._from_elsewhere(resolve, ranges, starts) or found
        if found is None:
            return None
        return tuple(upright(place) for place in found if not _is_all(place, ranges))

    def _from_elsewhere(self, resolve: Resolve, ranges: Ranges, starts: Ranges) -> tuple[Place, ...] | None:
        """What is left where the job starts clear of all zones: above them, or at the side with most room for it.

        ``starts`` is narrowed for that, so that ``resolve`` knows; None where no side of them helps.
        """
        sides: list[tuple[bool, float, Affine, Pair]] = []
        low, high = self._rows.faces()
        for axis, name in enumerate("xyz"):
            own: Affine = ((f"start.{name}", 1),)
            if own not in starts or self._asked.stated(f"start.{name}") is not None:
                continue
            least, most = starts[own]
            for ends in ((least, min(most, low[axis])), (max(least, high[axis]), most)):
                if ends[0] < ends[1]:
                    above = axis == 2 and ends[1] == most
                    sides.append((not above, -min(ends[1] - ends[0], FAR), own, ends))
        for _, _, own, ends in sorted(sides)[:_SIDES]:
            before, starts[own] = starts[own], ends
            found = self._rows.places(resolve, ranges)
            if found is not None and all(not place.region.empty for place in found):
                where = f"between {ends[0]:.4f} and {ends[1]:.4f} mm (machine coordinates)"
                self.assumed = f"{describe(own)} is {where}, clear of all zones"
                return found
            starts[own] = before
        return None


def negated(form: Affine) -> Affine:
    """The negative of a sum."""
    return tuple((symbol, -count) for symbol, count in form)


def upright(place: Place) -> Place:
    """The same place, given for offsets themselves instead of for their negatives."""
    signs = [-1 if form and all(count < 0 for _, count in form) else 1 for form in place.terms]
    if signs == [1, 1, 1]:
        return place
    import shapely.affinity

    def ends(pair: tuple[float, float], sign: int) -> tuple[float, float]:
        return pair if sign > 0 else (-pair[1], -pair[0])

    x, y, z = (form if sign > 0 else negated(form) for form, sign in zip(place.terms, signs, strict=True))
    layers = [
        Layer(z=ends(one.z, signs[2]), left=shapely.affinity.scale(one.left, signs[0], signs[1], origin=(0.0, 0.0)))
        for one in place.region.layers
    ]
    region = replace(place.region, layers=tuple(sorted(layers, key=lambda one: one.z)))
    boxes = tuple((ends(a, signs[0]), ends(b, signs[1]), ends(c, signs[2])) for a, b, c in place.boxes)
    return replace(place, terms=(x, y, z), region=region, boxes=boxes)


def _is_all(place: Place, ranges: Ranges) -> bool:
    """Whether nothing is taken from the ranges."""
    (x, y, z) = (ranges.get(form, (-FAR, FAR)) if form else (-1.0, 1.0) for form in place.terms)
    sizes = [max(min(high, FAR) - max(low, -FAR), 1e-9) for low, high in (x, y)]
    layers = place.region.layers
    if len(layers) != 1 or place.region.empty:
        return False
    whole = math.isclose(layers[0].left.area, sizes[0] * sizes[1], rel_tol=1e-9, abs_tol=1e-5)
    height = layers[0].z[1] - layers[0].z[0] if place.terms[2] else 0.0
    return whole and math.isclose(height, min(z[1], FAR) - max(z[0], -FAR) if place.terms[2] else 0.0, abs_tol=1e-9)


def _stand(name: str, view: View) -> Stand:
    """The zone of a view as something solid; where only its reach is certain, all of that."""
    zone = view.outer
    z = zone.z[0] - zone.rise, zone.z[1] + zone.rise
    if view.tip is not None:
        # From the tip of a tool of unknown length up to the head: at any height.
        z = -math.inf, math.inf
    parts = convex_parts(zone.shape)
    return Stand(
        name=name, solid=Solid(parts=parts, z=z, grow=zone.grow), shift=view.shift, form=view.form,
        sure=view.tip is None and view.inner == zone,
    )  # fmt: skip


def convex_parts(shape: Shape) -> tuple[npt.NDArray[np.float64], ...]:
    """A region as convex polygons, (k, 2) each."""
    if isinstance(shape, Rectangle):
        (x0, x1), (y0, y1) = ((max(low, -FAR), min(high, FAR)) for low, high in shape.sides)
        return (np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]]),)
    import shapely

    assert isinstance(shape, Polygon)
    whole = shapely.Polygon(shape.rings[0], shape.rings[1:])
    triangles = shapely.constrained_delaunay_triangles(whole)
    return tuple(shapely.get_coordinates(triangle)[:3] for triangle in triangles.geoms)


@record(frozen=True, slots=True, kw_only=True)
class Beside:
    """Where some sums of offsets may be together. place: the region; now: what was stated, by axis, None: not exactly.

    inside: whether that is in it; nearest: the place in it that is least far from there.
    """

    place: Place
    now: tuple[float, float, float] | None
    inside: bool | None
    nearest: tuple[float, float, float] | None

    @property
    def names(self) -> tuple[str, ...]:
        """Of X, Y and Z, "" for an axis that does not count."""
        return tuple(describe(form).replace(" offset", "") for form in self.place.terms)


def beside(place: Place, asked: Asked) -> Beside:
    """A place with what was stated of it."""
    known = [asked.interval(form) if form else Interval(0.0, 0.0) for form in place.terms]
    if any(one is None or not one.exact for one in known):
        return Beside(place=place, now=None, inside=None, nearest=None)
    x, y, z = (one.low for one in known if one is not None)
    return Beside(place=place, now=(x, y, z), inside=_inside(place, (x, y, z)), nearest=_nearest(place, (x, y, z)))


def _inside(place: Place, at: tuple[float, float, float]) -> bool:
    import shapely

    point = shapely.Point(at[0], at[1])
    return any(
        layer.z[0] - 1e-9 <= at[2] <= layer.z[1] + 1e-9 and layer.left.distance(point) <= 1e-9
        for layer in place.region.layers
    )


def _nearest(place: Place, at: tuple[float, float, float]) -> tuple[float, float, float] | None:
    """By the way there, a little inside where there is room for it."""
    import shapely
    from shapely.ops import nearest_points

    best: tuple[float, tuple[float, float, float]] | None = None
    for layer in place.region.layers:
        left = layer.left.buffer(-_SIDE)
        left = layer.left if left.is_empty else left
        low, high = layer.z
        if high - low > 2 * _SIDE:
            low, high = low + _SIDE, high - _SIDE
        z = min(max(at[2], low), high) if place.terms[2] else 0.0
        found = nearest_points(left, shapely.Point(at[0], at[1]))[0]
        way = math.hypot(found.x - at[0], found.y - at[1], z - at[2])
        if best is None or way < best[0]:
            best = way, (found.x, found.y, z)
    return None if best is None else best[1]


def agree(places: tuple[Place, ...], ranges: Ranges) -> bool:
    """Whether some offsets suit all places and ranges: a choice of boxes that do not exclude each other."""
    if any(not place.boxes for place in places):
        return False
    others = [Condition(terms=terms, low=low, high=high) for terms, (low, high) in ranges.items()]
    for choice in itertools.islice(itertools.product(*(place.boxes for place in places)), _TRIED):
        asked = [
            Condition(terms=form, low=low, high=high)
            for place, box in zip(places, choice, strict=True)
            for form, (low, high) in zip(place.terms, box, strict=True)
            if form
        ]
        if not contradiction([*others, *asked]):
            return True
    return False
