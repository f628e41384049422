"""Fields of stock that nothing has cut: shapely and ray casting say what fills a cell."""

from __future__ import annotations

import math
import random

import numpy as np
import pytest
from shapely import Point, Polygon, box
from support.campaigns import seeds

from gproof.ir.columns import Columns
from gproof.ir.workpiece import TRIANGLES, Body, Box, Cylinder, Mesh, Prism
from gproof.passes.checks.stock.height_fields import field_of


def cells(body: Body, cell: float) -> list[tuple[Polygon, float, float]]:
    """Each cell with its upper and lower height."""
    field = field_of(body, cell)
    x0, y0, hx, hy = field.grid[:4]
    ny, nx = field.upper.shape
    return [
        (box(x0 + i * hx, y0 + j * hy, x0 + (i + 1) * hx, y0 + (j + 1) * hy), field.upper[j, i], field.lower[j, i])
        for j in range(ny)
        for i in range(nx)
    ]


def agree(body: Body, shape: Polygon, cell: float, low: float, high: float, error: float = 0.0) -> None:
    """Cells inside the outline are full, those outside empty, the others undecided between the two.

    The error may be taken along X and Y: half as much again askew.
    """
    hair = 1e-6
    inside, near = shape.buffer(-1.5 * error - hair), shape.buffer(error - hair)
    sure = shape.buffer(-error + hair)
    for square, upper, lower in cells(body, cell):
        assert upper in (high, -math.inf)
        assert lower in (high, -math.inf)
        if near.intersects(square):
            assert upper == high
        if not shape.buffer(1.5 * error + hair).intersects(square):
            assert upper == -math.inf
        if lower == high:
            assert sure.contains(square)
        if inside.contains(square):
            assert lower == high


def test_a_box_is_exact() -> None:
    field = field_of(Box(low=(1.0, 2.0, -5.0), high=(8.3, 4.9, 1.5)), 0.4)
    assert (field.upper == 1.5).all()
    assert (field.lower == 1.5).all()
    ny, nx = field.upper.shape
    assert field.cell <= 0.4
    assert (field.grid[0] + nx * field.grid[2], field.grid[1] + ny * field.grid[3]) == pytest.approx(
        (8.3, 4.9), abs=1e-12
    )


def test_too_many_cells_get_larger() -> None:
    field = field_of(Box(low=(0.0, 0.0, 0.0), high=(1000.0, 10.0, 1.0)), 0.01, most=20_000)
    assert field.upper.size <= 20_000
    assert field.upper.size > 10_000
    assert field.cell < 1.1


@pytest.mark.parametrize("cell", [0.3, 1.7])
def test_a_cylinder(cell: float) -> None:
    """By the nearest and the furthest place of a cell."""
    for square, upper, lower in cells(Cylinder(x=3.0, y=-2.0, radius=5.0, low=-1.0, high=2.0), cell):
        corners = [math.hypot(x - 3.0, y + 2.0) for x, y in square.exterior.coords]
        near = square.distance(Point(3.0, -2.0))
        if abs(max(corners) - 5.0) > 1e-9:
            assert lower == (2.0 if max(corners) < 5.0 else -math.inf)
        if abs(near - 5.0) > 1e-9:
            assert upper == (2.0 if near < 5.0 else -math.inf)
        assert upper >= lower


@pytest.mark.parametrize("seed", seeds(3, 200))
def test_outlines_with_holes(seed: int) -> None:
    rng = random.Random(seed)
    count = rng.choice((3, 5, 12))
    angles = sorted(rng.uniform(0, 2 * math.pi) for _ in range(count))
    ring = [(rng.uniform(2, 8) * math.cos(a) + 3, rng.uniform(2, 8) * math.sin(a) - 1) for a in angles]
    hole = [(3.2 + 0.9 * math.cos(a), -0.7 + 0.9 * math.sin(a)) for a in (0.0, -1.0, -3.0, -4.5)]
    shape = Polygon(ring)
    if not shape.is_valid or shape.area < 1.0:
        ring = [(0.0, 0.0), (9.0, 1.0), (7.0, 8.0), (4.0, 3.0)]
        shape = Polygon(ring)
    holes = (tuple(hole),) if shape.contains(Polygon(hole)) else ()
    shape = Polygon(ring, holes)
    error = rng.choice((0.0, 0.2))
    body = Prism(outline=tuple(ring), holes=holes, low=-3.0, high=0.5, error=error)
    agree(body, shape, rng.choice((0.25, 0.8)), -3.0, 0.5, error)


def mesh(triangles: list[tuple[tuple[float, float, float], ...]], *, closed: bool = True) -> Mesh:
    a, b, c = (np.array([t[k] for t in triangles], dtype=np.float64) for k in range(3))
    return Mesh(triangles=Columns(TRIANGLES, {"a": a, "b": b, "c": c}), closed=closed)


def hull(points: np.ndarray) -> list[tuple[tuple[float, float, float], ...]]:
    """Triangles of a convex body, outwards: planes that have all points on one side."""
    middle = points.mean(axis=0)
    out = []
    n = len(points)
    for i in range(n):
        for j in range(i + 1, n):
            for k in range(j + 1, n):
                normal = np.cross(points[j] - points[i], points[k] - points[i])
                side = (points - points[i]) @ normal
                if (side <= 1e-9).all() or (side >= -1e-9).all():
                    ring = (i, j, k) if (points[i] - middle) @ normal > 0 else (i, k, j)
                    out.append(tuple(tuple(points[m].tolist()) for m in ring))
    return out


@pytest.mark.parametrize("seed", seeds(4, 100))
def test_meshes_by_rays(seed: int) -> None:
    """A convex body on a plate: its highest place over a point by the planes of its triangles."""
    many = np.random.default_rng(seed)
    points = many.uniform((0, 0, 0), (6, 5, 4), (9, 3))
    if seed % 2:
        points[:5, 2] = 0.0
    triangles = hull(points)
    field = field_of(mesh(triangles), 0.35)
    x0, y0, hx, hy, floor, _ = field.grid
    spots = many.uniform((x0, y0), (x0 + hx * field.upper.shape[1], y0 + hy * field.upper.shape[0]), (3000, 2))
    high, low = np.full(3000, math.inf), np.full(3000, -math.inf)
    inside = np.ones(3000, dtype=bool)
    for a, b, c in (np.array(t) for t in triangles):
        normal = np.cross(b - a, c - a)
        at = (normal[0] * (spots[:, 0] - a[0]) + normal[1] * (spots[:, 1] - a[1])) if normal[2] == 0 else None
        if at is not None:
            inside &= at <= 0
            continue
        z = a[2] - (normal[0] * (spots[:, 0] - a[0]) + normal[1] * (spots[:, 1] - a[1])) / normal[2]
        if normal[2] > 0:
            high = np.minimum(high, z)
        else:
            low = np.maximum(low, z)
    inside &= high > low + 1e-9
    i, j = ((spots[:, 0] - x0) / hx).astype(int), ((spots[:, 1] - y0) / hy).astype(int)
    upper, lower = field.upper[j, i], field.lower[j, i]
    assert (upper[inside] >= high[inside] - 1e-9).all()
    said = lower > floor + 1e-6
    assert inside[said].all()
    assert (lower[said] <= high[said] + 1e-9).all()
    assert (low[said] <= floor + 1e-6).all()
    if seed % 2:
        assert said.any()
    assert not np.isfinite(field_of(mesh(triangles, closed=False), 0.35).lower).any()
