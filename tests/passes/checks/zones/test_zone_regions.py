"""Regions of offsets against brute force: an offset is left when no move, shifted by it, enters the zone.

Moves and zones are random; whether a shifted move enters is reckoned here, by cutting it with the zone's slabs and by
samples of arcs, never by the code under test.
"""

from __future__ import annotations

import itertools
import math
import random
from typing import Any

import numpy as np
import pytest
import shapely
from support.campaigns import seeds

from gproof.passes.checks.zones.offset_boxes import boxes_of, rectangles
from gproof.passes.checks.zones.offset_regions import Blocked, Move, Region, Solid, around_arc, joined, straight

ALL = np.ones((2, 3), dtype=bool)
RANGES = (-100.0, 100.0), (-80.0, 90.0), (-60.0, 40.0)


def rectangle(x: tuple[float, float], y: tuple[float, float]) -> np.ndarray:
    return np.array([[x[0], y[0]], [x[1], y[0]], [x[1], y[1]], [x[0], y[1]]])


def random_solid(rng: random.Random) -> Solid:
    x, y, z = (sorted(rng.uniform(-60, 60) for _ in range(2)) for _ in range(3))
    if rng.random() < 0.3:
        z = [-math.inf, math.inf]
    return Solid(parts=(rectangle((x[0], x[1]), (y[0], y[1])),), z=(z[0], z[1]))


def random_place(rng: random.Random) -> np.ndarray:
    return np.array([rng.uniform(-40, 40) for _ in range(3)])


def enters(start: np.ndarray, end: np.ndarray, solid: Solid) -> float:
    """How deep a segment goes into a box: the length of its part inside, -1 when it stays outside."""
    sides = solid.box()
    t0, t1 = 0.0, 1.0
    for axis in range(3):
        a, d, (low, high) = start[axis], end[axis] - start[axis], sides[axis]
        if abs(d) < 1e-12:
            if not low < a < high:
                return -1.0
            continue
        first, last = sorted(((low - a) / d, (high - a) / d))
        t0, t1 = max(t0, first), min(t1, last)
    return t1 - t0 if t1 > t0 else -1.0


def is_left(region: Region, at: np.ndarray, slack: float = 0.0) -> bool:
    """Whether an offset is left, or within ``slack`` of what is."""
    point = shapely.Point(at[0], at[1])
    return any(
        layer.z[0] - slack <= at[2] <= layer.z[1] + slack and layer.left.distance(point) <= slack
        for layer in region.layers
    )


def region_of(solids: list[Solid], moves: list[Move], fixed: tuple[bool, bool, bool] = (False,) * 3) -> Region:
    blocked = Blocked(RANGES, fixed)
    for solid in solids:
        blocked.add(solid, moves)
    return blocked.region()


def offsets(rng: random.Random, region: Region) -> list[np.ndarray]:
    """Random ones, and some just beside a corner or an edge of a layer."""
    out = [np.array([rng.uniform(*side) for side in RANGES]) for _ in range(60)]
    for layer in region.layers:
        corners = shapely.get_coordinates(layer.left)
        for _ in range(4):
            k = rng.randrange(len(corners))
            x, y = corners[k] if rng.random() < 0.5 else (corners[k] + corners[k - 1]) / 2
            near = [rng.choice((-1e-6, 1e-6, 0.01)) for _ in range(3)]
            z = rng.choice((layer.z[0], layer.z[1], rng.uniform(*layer.z)))
            out.append(np.array([x + near[0], y + near[1], z + near[2]]))
    return out


@pytest.mark.parametrize("seed", seeds(12, 1500))
def test_straight_moves_of_one_frame(seed: int) -> None:
    rng = random.Random(seed)
    solids = [random_solid(rng) for _ in range(rng.choice((1, 1, 2)))]
    places = [random_place(rng)]
    for _ in range(rng.randrange(1, 6)):
        place = random_place(rng)
        kept = rng.choice(((), (2,), (0, 1), (1, 2)))
        for axis in kept:
            place[axis] = places[-1][axis]
        places.append(place)
    lines = list(itertools.pairwise(places))
    region = region_of(solids, [m for a, b in lines for m in straight(a, b, ALL)])
    assert region.resolution is not None
    for at in offsets(rng, region):
        if any(not low - 1e-9 <= v <= high + 1e-9 for v, (low, high) in zip(at, RANGES, strict=True)):
            continue
        hit = any(enters(a + at, b + at, solid) > 0 for a, b in lines for solid in solids)
        clear = not any(enters(a + at, b + at, s) > 1e-9 for a, b in lines for s in solids)
        if is_left(region, at):
            assert clear, f"seed {seed}: {at} is blocked"
        elif not is_left(region, at, max(2e-7, 2 * region.resolution)):
            assert hit, f"seed {seed}: {at} is free"


@pytest.mark.parametrize("seed", seeds(8, 600))
def test_arcs_and_helices(seed: int) -> None:
    rng = random.Random(seed)
    solid = random_solid(rng)
    start = random_place(rng)
    pair = rng.choice(((0, 1), (0, 1), (2, 0), (1, 2)))
    radius, angle, sweep = rng.uniform(1, 30), rng.uniform(0, 6.28), rng.uniform(0.1, 6.2)
    turns = rng.choice((1, -1))
    center, end = start.copy(), start.copy()
    w = 3 - sum(pair)
    for axis, of in zip(pair, (math.cos, math.sin), strict=True):
        center[axis] = start[axis] - radius * of(angle)
        end[axis] = center[axis] + radius * of(angle + turns * sweep)
    if rng.random() < 0.5:
        end[w] = start[w] + rng.uniform(-8, 8)
    region = region_of([solid], around_arc(start, end, center, turns, pair, ALL))
    t = np.linspace(0.0, 1.0, 4001)
    path = np.empty((len(t), 3))
    path[:, pair[0]] = center[pair[0]] + radius * np.cos(angle + turns * sweep * t)
    path[:, pair[1]] = center[pair[1]] + radius * np.sin(angle + turns * sweep * t)
    path[:, w] = start[w] + (end[w] - start[w]) * t
    sides = np.array(solid.box())
    assert region.resolution is not None
    for at in offsets(rng, region):
        if any(not low - 1e-9 <= v <= high + 1e-9 for v, (low, high) in zip(at, RANGES, strict=True)):
            continue
        depth = np.minimum(path + at - sides[:, 0], sides[:, 1] - path - at).min(axis=1).max()
        if is_left(region, at):
            assert depth < 1e-7, f"seed {seed}: {at} is blocked by {depth}"
        elif not is_left(region, at, 3 * region.resolution + 1e-3):
            assert depth > -0.02, f"seed {seed}: {at} is free by {-depth}"


@pytest.mark.parametrize("seed", seeds(8, 600))
def test_moves_from_places_that_stay(seed: int) -> None:
    """From a machine position to a place that moves with the offset, and back."""
    rng = random.Random(seed)
    solid = random_solid(rng)
    a, b = random_place(rng), random_place(rng)
    moves = ALL.copy()
    end = rng.randrange(2)
    moves[end] = [False, False, False]
    level = rng.random() < 0.7
    if level:
        b[2] = a[2]
        moves[:, 2] = rng.random() < 0.5
    region = region_of([solid], straight(a, b, moves))
    for at in offsets(rng, region):
        if any(not low - 1e-9 <= v <= high + 1e-9 for v, (low, high) in zip(at, RANGES, strict=True)):
            continue
        p, q = (a, b) + at * moves
        if is_left(region, at):
            assert enters(p, q, solid) <= 1e-7, f"seed {seed}: {at} is blocked"
        elif region.resolution is not None and not is_left(region, at, 1e-6):
            assert enters(p, q, solid) > 0, f"seed {seed}: {at} is free"


@pytest.mark.parametrize("seed", seeds(15, 600))
def test_moves_along_an_axis_from_places_that_stay(seed: int) -> None:
    """One end of the moving axis stays, the other moves with the offset; what is left is exact, whatever the axis."""
    rng = random.Random(seed)
    axis, end = rng.randrange(3), rng.randrange(2)
    sides = [sorted(rng.uniform(-40, 40) for _ in range(2)) for _ in range(3)]
    solid = Solid(parts=(rectangle(tuple(sides[0]), tuple(sides[1])),), z=(sides[2][0], sides[2][1]))
    places = np.stack([random_place(rng)] * 2)
    places[end, axis] = rng.uniform(-60, 60)
    moves = ALL.copy()
    moves[1 - end, axis] = False
    region = region_of([solid], straight(places[0], places[1], moves))
    seen = set()
    for _ in range(150):
        # Half of the offsets bring the rest of the place into the zone's reach.
        at = np.array([rng.uniform(*side) for side in RANGES])
        if rng.random() < 0.7:
            for other in {0, 1, 2} - {axis}:
                at[other] = rng.uniform(*sides[other]) - places[0, other]
        if any(not low <= v <= high for v, (low, high) in zip(at, RANGES, strict=True)):
            continue
        p, q = places + at * moves
        blocked = enters(p, q, solid) > 0
        assert is_left(region, at) != blocked, f"seed {seed}: {at}"
        seen.add(blocked)
    assert seen


@pytest.mark.parametrize("turn", [0.01, 0.1, 0.3, 0.49, 0.51, 0.9, 1.3, 1.49, 1.51, 2.49, 2.6])
def test_what_is_round_is_blocked_whole(turn: float) -> None:
    """Corners of any angle, counted in steps of a quarter circle of 8: all places nearer than the tool's radius."""
    angle = turn * math.pi / 2 / 8
    corner = [(-40.0, 0.0), (0.0, 0.0), (-40.0 * math.cos(angle), -40.0 * math.sin(angle))]
    for grow in (0.001, 0.01, 0.05, 1.0, 3.0):
        solid = Solid(parts=(np.array(corner),), z=(-math.inf, math.inf), grow=grow)
        region = region_of([solid], straight(np.zeros(3), np.array([1e-9, 0.0, 0.0]), ALL))
        zone = shapely.Polygon(corner)
        for k in range(400):
            way = math.pi * (k / 200 - 1)
            at = np.array([math.cos(way), math.sin(way), -50.0]) * (grow - 2e-7, grow - 2e-7, 1.0)
            if zone.distance(shapely.Point(at[:2])) < grow - 1e-7:
                assert not is_left(region, at), (grow, way)


@pytest.mark.parametrize("seed", seeds(6, 300))
def test_zones_that_are_polygons_and_round_tools(seed: int) -> None:
    rng = random.Random(seed)
    ring = shapely.Polygon([(rng.uniform(5, 30) * math.cos(k), rng.uniform(5, 30) * math.sin(k)) for k in range(6)])
    triangles = shapely.constrained_delaunay_triangles(ring).geoms
    parts = tuple(np.asarray(t.exterior.coords)[:3] for t in triangles)
    grow = rng.choice((0.0, 3.0))
    a, b = random_place(rng), random_place(rng)
    b[2] = a[2]
    region = region_of([Solid(parts=parts, z=(-math.inf, math.inf), grow=grow)], straight(a, b, ALL))
    for at in offsets(rng, region):
        if any(not low - 1e-9 <= v <= high + 1e-9 for v, (low, high) in zip(at, RANGES, strict=True)):
            continue
        line = shapely.LineString([(a + at)[:2], (b + at)[:2]])
        gap = line.distance(ring) - grow
        deep = line.intersection(ring).length
        if is_left(region, at):
            assert gap > -1e-7, f"seed {seed}: {at} is blocked"
            assert grow or deep < 1e-5
        elif not is_left(region, at, 2e-3):
            assert gap < 1e-9, f"seed {seed}: {at} is free by {gap}"


@pytest.mark.parametrize("seed", seeds(5, 300))
def test_boxes_lie_in_their_region_and_cover_it(seed: int) -> None:
    rng = random.Random(seed)
    places = [random_place(rng)]
    for _ in range(3):
        place = places[-1].copy()
        axis = rng.randrange(3)
        place[axis] += rng.uniform(-40, 40)
        places.append(place)
    moves = [m for a, b in itertools.pairwise(places) for m in straight(a, b, ALL)]
    region = region_of([random_solid(rng)], moves)
    assert region.resolution == 0.0
    boxes = boxes_of(region)
    for _ in range(300):
        at = np.array([rng.uniform(*side) for side in RANGES])
        boxed = any(all(low <= v <= high for v, (low, high) in zip(at, box, strict=True)) for box in boxes)
        assert boxed == is_left(region, at), f"seed {seed}: {at}"
    for box in boxes:
        for corner in np.stack(np.meshgrid(*box), axis=-1).reshape(-1, 3):
            assert is_left(region, corner, 1e-9), f"seed {seed}: {box}"


def test_many_moves_are_joined_to_the_safe_side() -> None:
    rng = random.Random(3)
    places = [np.array([30 * math.cos(k / 40), 20 * math.sin(k / 30), -1.0]) for k in range(400)]
    moves = [m for a, b in itertools.pairwise(places) for m in straight(a, b, ALL)]
    solid = Solid(parts=(rectangle((-5.0, 5.0), (-5.0, 5.0)),), z=(-math.inf, math.inf))
    exact, coarse = region_of([solid], moves), region_of([solid], joined(moves, 50))
    assert exact.resolution == 0.0
    assert coarse.resolution is None
    for _ in range(300):
        at = np.array([rng.uniform(*side) for side in RANGES])
        assert is_left(exact, at) or not is_left(coarse, at)


def test_rectangles_of_cells() -> None:
    cells = np.array([[1, 1, 0], [1, 1, 1], [0, 1, 1]], dtype=bool)
    assert set(rectangles(cells)) == {(0, 2, 0, 2), (1, 3, 1, 3), (0, 3, 1, 2), (1, 2, 0, 3)}


def test_nothing_is_left() -> None:
    solid = Solid(parts=(rectangle((-1e3, 1e3), (-1e3, 1e3)),), z=(-math.inf, math.inf))
    region: Any = region_of([solid], straight(np.zeros(3), np.ones(3), ALL))
    assert region.empty
    assert boxes_of(region) == ()
