"""Moves against zones: exact fractions for straight moves, shapely and dense walks of the path for arcs."""

from __future__ import annotations

import itertools
import math
import random
from fractions import Fraction

import numpy as np
import pytest
import shapely
from support.campaigns import seeds

from gproof.ir.trace import Plane
from gproof.passes.checks.zones.shapes import (
    IN_PLANE,
    Arc,
    Point,
    Polygon,
    Rectangle,
    Zone,
    arc_enters,
    box_enters,
    segment_enters,
)

EVERYWHERE = (-math.inf, math.inf)
Exact = tuple[Fraction, Fraction]


def lattice_polygon(rng: random.Random, size: int) -> list[tuple[float, float]] | None:
    """A polygon with whole-numbered points, non-convex as a rule; None when it would cross itself."""
    angles = sorted(rng.uniform(0, 2 * math.pi) for _ in range(rng.randrange(3, 9)))
    points = [
        (float(round(r * math.cos(a))), float(round(r * math.sin(a))))
        for a, r in ((a, rng.uniform(0.25 * size, size)) for a in angles)
    ]
    whole = shapely.Polygon(points)
    twice = any(a == b for a, b in zip(points, points[1:] + points[:1], strict=True))
    return points if whole.is_valid and whole.area > 0 and not twice else None


def crosses_inside(p: Exact, q: Exact, ring: list[tuple[float, float]]) -> bool:
    """Whether a segment has a point strictly inside, in fractions: between all crossings one middle decides."""
    corners = [(Fraction(x), Fraction(y)) for x, y in ring]
    sides = list(zip(corners, corners[1:] + corners[:1], strict=True))
    d = q[0] - p[0], q[1] - p[1]
    ts = {Fraction(0), Fraction(1)}
    for a, b in sides:
        e = b[0] - a[0], b[1] - a[1]
        det = d[0] * e[1] - d[1] * e[0]
        for corner in (a, b):
            if d != (0, 0) and d[0] * (corner[1] - p[1]) == d[1] * (corner[0] - p[0]):
                k = 0 if d[0] else 1
                ts.add((corner[k] - p[k]) / d[k])
        if det:
            ts.add(((a[0] - p[0]) * e[1] - (a[1] - p[1]) * e[0]) / det)
    inside = sorted(t for t in ts if 0 <= t <= 1)
    for s, t in itertools.pairwise(inside):
        m = (s + t) / 2
        if strictly_inside((p[0] + d[0] * m, p[1] + d[1] * m), sides):
            return True
    return strictly_inside(p, sides)


def strictly_inside(point: Exact, sides: list[tuple[Exact, Exact]]) -> bool:
    x, y = point
    odd = False
    for (ax, ay), (bx, by) in sides:
        area = (bx - ax) * (y - ay) - (by - ay) * (x - ax)
        if area == 0 and min(ax, bx) <= x <= max(ax, bx) and min(ay, by) <= y <= max(ay, by):
            return False
        if (ay > y) != (by > y) and x < ax + (y - ay) / (by - ay) * (bx - ax):
            odd = not odd
    return odd


@pytest.mark.parametrize("seed", seeds(2, 40))
def test_straight_moves_enter_a_polygon_as_fractions_say(seed: int) -> None:
    """Whole numbers: moves along edges, through corners and from corner to corner are common."""
    rng = random.Random(seed)
    answers = {True: 0, False: 0}
    for _ in range(250):
        ring = lattice_polygon(rng, rng.choice((3, 6, 12)))
        if ring is None:
            continue
        ends = [(float(rng.randrange(-9, 10)), float(rng.randrange(-9, 10))) for _ in range(2)]
        if rng.random() < 0.4:
            ends[rng.randrange(2)] = rng.choice(ring)
        p, q = ((Fraction(x), Fraction(y)) for x, y in ends)
        expected = crosses_inside(p, q, ring)
        zone = Zone(shape=Polygon([ring]), z=EVERYWHERE)
        found = segment_enters(zone, (*ends[0], 0.0), (*ends[1], 0.0))
        assert (found is not None) == expected, (seed, ring, ends)
        answers[expected] += 1
    assert min(answers.values()) > 20


def moved(points: np.ndarray, arc: Arc | None, p: Point, q: Point) -> np.ndarray:
    """(n, 3): points of a move at parts of its way, by plain trigonometry."""
    t = points[:, np.newaxis]
    if arc is None:
        return np.array(p) + (np.array(q) - np.array(p)) * t
    u, v = IN_PLANE[Plane(arc.plane)]
    w = 3 - u - v
    start, end, center = np.array(arc.start), np.array(arc.end), np.array(arc.center)
    a0 = math.atan2(start[v] - center[v], start[u] - center[u])
    a1 = math.atan2(end[v] - center[v], end[u] - center[u])
    sign = 1 if arc.turns > 0 else -1
    sweep = (a1 - a0) * sign % (2 * math.pi)
    if sweep < 1e-12:
        sweep = 2 * math.pi
    sweep += (abs(arc.turns) - 1) * 2 * math.pi
    angle = a0 + sign * sweep * t[:, 0]
    r0 = math.hypot(start[u] - center[u], start[v] - center[v])
    r1 = math.hypot(end[u] - center[u], end[v] - center[v])
    radius = r0 + (r1 - r0) * t[:, 0]
    out = np.empty((len(points), 3))
    out[:, u], out[:, v] = center[u] + radius * np.cos(angle), center[v] + radius * np.sin(angle)
    out[:, w] = start[w] + (end[w] - start[w]) * t[:, 0]
    return out


def random_arc(rng: random.Random) -> Arc:
    plane = rng.choice((Plane.XY, Plane.XZ, Plane.YZ))
    u, v = IN_PLANE[plane]
    w = 3 - u - v
    center = [rng.uniform(-5, 5) for _ in range(3)]
    radius, a0 = rng.uniform(0.5, 15.0), rng.uniform(-4, 4)
    sweep = rng.choice((rng.uniform(0.01, 6.2), 2 * math.pi))
    turns = rng.choice((1, -1, 1, -1, 3))
    start, end = list(center), list(center)
    other = radius * (1 + rng.choice((0.0, 0.0, 1e-4, 0.02)))
    for point, r, a in ((start, radius, a0), (end, other, a0 + math.copysign(sweep, turns))):
        point[u], point[v] = center[u] + r * math.cos(a), center[v] + r * math.sin(a)
    if sweep == 2 * math.pi:
        end[u], end[v] = start[u], start[v]
    end[w] = start[w] + rng.choice((0.0, rng.uniform(-8, 8)))
    return Arc(start=tuple(start), end=tuple(end), center=tuple(center), turns=turns, plane=int(plane))


def star(rng: random.Random, x: float, y: float, size: float) -> list[tuple[float, float]]:
    count = rng.randrange(3, 12)
    shift = rng.uniform(0, 6)
    return [
        (x + r * math.cos(shift + a), y + r * math.sin(shift + a))
        for a, r in ((2 * math.pi * k / count, rng.uniform(0.2 * size, size)) for k in range(count))
    ]


@pytest.mark.parametrize("seed", seeds(3, 60))
def test_moves_enter_zones_where_shapely_says_that_their_points_are_inside(seed: int) -> None:
    rng = random.Random(1000 + seed)
    t = np.linspace(0.0, 1.0, 4_001)
    answers = {True: 0, False: 0}
    for _ in range(30):
        arc = random_arc(rng) if rng.random() < 0.8 else None
        p, q = (tuple(rng.uniform(-9, 9) for _ in range(3)) for _ in range(2))
        points = moved(t, arc, p, q)
        beside = points[rng.randrange(len(points))]
        size = rng.choice((0.05, 1.0, 6.0))
        x, y = beside[0] + rng.uniform(-1.5, 1.5) * size, beside[1] + rng.uniform(-1.5, 1.5) * size
        ring = star(rng, x, y, size)
        hole = [(x + (a - x) * 0.4, y + (b - y) * 0.4) for a, b in ring] if rng.random() < 0.4 else None
        if rng.random() < 0.3:
            shape, region = (
                Rectangle((x - size, x + size), (y - size / 3, y)),
                shapely.box(x - size, y - size / 3, x + size, y),
            )
        else:
            shape = Polygon([ring, hole] if hole else [ring])
            region = shapely.Polygon(ring, [hole] if hole else [])
        grow = rng.choice((0.0, 0.0, 0.3, 3.0))
        height = rng.choice((0.02, 1.0, 30.0))
        z = beside[2] - height * rng.random(), beside[2] + height * rng.random()
        zone = Zone(shape=shape, z=z, grow=grow)
        made = shapely.points(points[:, :2])
        away = shapely.distance(region, made)
        edge = shapely.distance(region.boundary, made)
        depth = np.where(away > 0, grow - away, grow + edge)
        depth = np.minimum(np.minimum(depth, points[:, 2] - z[0]), z[1] - points[:, 2])
        deepest, step = (
            float(depth.max()),
            float(np.hypot(*np.diff(points, axis=0).T[:2]).max()) + float(np.abs(np.diff(points[:, 2])).max()),
        )
        found = segment_enters(zone, p, q) if arc is None else arc_enters(zone, arc)
        where = f"seed {seed}: {arc or (p, q)} {zone} deepest {deepest}"
        if deepest > 1e-7:
            assert found is not None, where
        if found is not None:
            assert deepest > -step, where
            assert found.depth <= deepest + step, where
        answers[found is not None] += 1
    assert min(answers.values()) >= 3


@pytest.mark.parametrize("seed", seeds(3, 30))
def test_a_clamp_thinner_than_any_step_between_samples_is_found(seed: int) -> None:
    rng = random.Random(2000 + seed)
    for _ in range(40):
        arc = random_arc(rng) if rng.random() < 0.7 else None
        p, q = (tuple(rng.uniform(-9, 9) for _ in range(3)) for _ in range(2))
        (x, y, z), after = moved(np.array([0.4321, 0.43211]), arc, p, q)
        thin = rng.choice((1e-6, 1e-5, 1e-3))
        along = math.atan2(after[1] - y, after[0] - x)
        # A strip across the path, as thin as that along it.
        c, d = math.cos(along), math.sin(along)
        ring = [
            (x + a * thin / 2 * c - n * d, y + a * thin / 2 * d + n * c)
            for a, n in ((-1, -1), (1, -1), (1, 1), (-1, 1))
        ]
        shape = Polygon([ring]) if rng.random() < 0.5 else Rectangle((x - thin, x + thin), (y - thin, y + thin))
        zone = Zone(shape=shape, z=(z - thin, z + thin))
        found = segment_enters(zone, p, q) if arc is None else arc_enters(zone, arc)
        assert found is not None, (seed, thin, arc or (p, q))


@pytest.mark.parametrize("plane", [Plane.XY, Plane.XZ, Plane.YZ])
@pytest.mark.parametrize("grow", [0.0, 2.5])
def test_touching_is_outside_and_a_millionth_is_inside(plane: Plane, grow: float) -> None:
    """A circle of 10 beside a face that it touches with the middle of its arc, in whole numbers."""
    u, v = IN_PLANE[plane]
    for into, expected in ((0.0, False), (-1e-6, False), (1e-6, True)):
        start, end, center = [0.0] * 3, [0.0] * 3, [0.0] * 3
        start[v], end[v] = -10.0, 10.0
        arc = Arc(start=tuple(start), end=tuple(end), center=tuple(center), turns=1, plane=int(plane))
        around = grow if u != 2 else 0.0
        low = [-50.0, -50.0, -50.0]
        low[u] = 10.0 + around - into
        box = Zone(shape=Rectangle((low[0], 90.0), (low[1], 90.0)), z=(low[2], 90.0), grow=grow)
        ring = [(low[0], low[1]), (90.0, low[1]), (90.0, 90.0), (low[0], 90.0)]
        for zone in (box, Zone(shape=Polygon([ring]), z=(low[2], 90.0), grow=grow)):
            assert (arc_enters(zone, arc) is not None) == expected, (plane, into, zone)
        line_start, line_end = list(start), list(end)
        line_start[u] = line_end[u] = 10.0
        for zone in (box, Zone(shape=Polygon([ring]), z=(low[2], 90.0), grow=grow)):
            assert (segment_enters(zone, tuple(line_start), tuple(line_end)) is not None) == expected


def test_a_tool_around_a_corner_may_come_as_near_as_its_radius() -> None:
    square = Polygon([[(0.0, 0.0), (20.0, 0.0), (20.0, 20.0), (0.0, 20.0)]])
    for shape in (square, Rectangle((0.0, 20.0), (0.0, 20.0))):
        zone = Zone(shape=shape, z=EVERYWHERE, grow=3.0)
        for radius, expected in ((3.0, False), (2.999999, True)):
            arc = Arc(
                start=(-radius, 0.0, 0.0), end=(0.0, -radius, 0.0), center=(0.0, 0.0, 0.0), turns=1, plane=1
            )  # fmt: skip
            assert (arc_enters(zone, arc) is not None) == expected, radius
        # Past the corner as the crow flies: the box grown by 3 is entered, the corner is 3.0001 away.
        near = 3.0001 * math.sqrt(0.5)
        assert segment_enters(zone, (-near - 4, -near + 4, 0.0), (-near + 4, -near - 4, 0.0)) is None
        near = 2.9999 * math.sqrt(0.5)
        assert segment_enters(zone, (-near - 4, -near + 4, 0.0), (-near + 4, -near - 4, 0.0)) is not None


def test_a_move_through_a_reflex_corner_is_inside_on_both_sides_of_it() -> None:
    ell = [(0.0, 0.0), (20.0, 0.0), (20.0, 10.0), (10.0, 10.0), (10.0, 20.0), (0.0, 20.0)]
    zone = Zone(shape=Polygon([ell]), z=EVERYWHERE)
    found = segment_enters(zone, (5.0, 15.0, 0.0), (15.0, 5.0, 0.0))
    assert found is not None
    assert segment_enters(zone, (10.0, 20.0, 0.0), (20.0, 10.0, 0.0)) is None
    assert segment_enters(zone, (10.0, 10.0, 0.0), (30.0, 30.0, 0.0)) is None
    assert segment_enters(zone, (9.0, 11.0, 0.0), (11.0, 9.0, 0.0)) is not None


@pytest.mark.parametrize("seed", seeds(3, 30))
def test_boxes_meet_zones_as_shapely_says(seed: int) -> None:
    rng = random.Random(3000 + seed)
    answers = {True: 0, False: 0}
    for _ in range(150):
        ring = star(rng, 0.0, 0.0, 6.0)
        x = sorted(rng.uniform(-9, 9) for _ in range(2))
        y = sorted(rng.uniform(-9, 9) for _ in range(2))
        if rng.random() < 0.2:
            x[1] = x[0]
        grow = rng.choice((0.0, 0.5))
        zone = Zone(shape=Polygon([ring]), z=(0.0, 5.0), grow=grow)
        region = shapely.Polygon(ring)
        box = shapely.box(x[0], y[0], x[1], y[1]) if x[0] < x[1] else shapely.LineString([(x[0], y[0]), (x[0], y[1])])
        expected = region.distance(box) < grow if grow else region.intersects(box) and not region.touches(box)
        assert box_enters(zone, (x[0], x[1]), (y[0], y[1]), (2.0, 2.0)) == expected, (seed, ring, x, y, grow)
        answers[expected] += 1
        assert not box_enters(zone, (x[0], x[1]), (y[0], y[1]), (5.0, 9.0))
    assert min(answers.values()) > 20
