"""Bodies as convex facets in a grid, for the kernels that ask how near a tool comes to them.

Takes ``ir.workpiece`` bodies that count from one zero; gives their surfaces: quadrilaterals of boxes and walls,
trapezia of the flat ends of prisms (cut at the heights of their corners, so that no new shape arises), triangles of
meshes, and an upright cylinder as its axis with a radius. A surface alone does not say what is inside: ``holds`` does.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from weakref import WeakValueDictionary

import numpy as np
import numpy.typing as npt

from gproof.ir.workpiece import Body, Box, Cylinder, Mesh, Placed, Point, Prism
from gproof.passes.checks.collisions.sweep_kernels import raster

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

_MOST_CELLS = 4_000_000
_MOST_ENTRIES = 50_000_000
"""Of facets in the lists of all cells; more only where each facet is in few. Facets that reach across everything would
fill the memory."""
_FLAT = 1e-10
"""mm that the corners of a facet may be off one plane."""


class Surface:
    """Facets of bodies as columns, and a grid over X and Y that says which lie where.

    corners: (n, 12) four corners, the third twice in a triangle; disc: (n,) mm around a facet; planes: (n, 5) unit
    normal, its product with the corners, its horizontal length; ``beside``: (n,) mm that the true surface may be off
    the facet; body: (n,) which of ``bodies``; box: (n, 5) least and greatest X, least and greatest Y, greatest Z.
    grid: X, Y of the first cell, its size, the greatest Z of all, the greatest ``beside``; size: cells in X and Y, and
    the highest facet; first, items: the facets over a cell, row by row; top: the greatest Z over it.
    Nobody writes into a surface that is made: checks share it.
    """

    def __init__(self, bodies: Sequence[Placed]) -> None:
        self.bodies = tuple(bodies)
        made = [facets_of(placed.body) for placed in bodies]
        self.corners: Floats = np.concatenate([corners for corners, _ in made]).reshape(-1, 12)
        self.disc = np.concatenate([np.full(len(corners), disc) for corners, disc in made])
        self.body: Ints = np.repeat(np.arange(len(made), dtype=np.int64), [len(corners) for corners, _ in made])
        errors = [getattr(placed.body, "error", 0.0) for placed in bodies]
        self.beside: Floats = np.array(errors, dtype=np.float64)[self.body]
        self.planes = _planes(self.corners)
        four = self.corners.reshape(-1, 4, 3)
        low, high = four.min(axis=1), four.max(axis=1)
        self.box: Floats = np.stack(
            [low[:, 0] - self.disc, high[:, 0] + self.disc, low[:, 1] - self.disc, high[:, 1] + self.disc, high[:, 2]],
            axis=1,
        )
        self.low = (float(self.box[:, 0].min()), float(self.box[:, 2].min()), float(low[:, 2].min()))
        self.high = (float(self.box[:, 1].max()), float(self.box[:, 3].max()), float(high[:, 2].max()))
        self._make_grid()

    def _make_grid(self) -> None:
        wide, deep = self.high[0] - self.low[0], self.high[1] - self.low[1]
        count = len(self.corners)
        cell = max(1.2 * math.sqrt(max(wide * deep, 1e-6) / count), max(wide, deep) / 4000.0, 0.05)
        cell = max(cell, math.sqrt(wide * deep / _MOST_CELLS))
        while self._entries(cell) > max(_MOST_ENTRIES, 40 * count):
            cell *= 2
        nx, ny = int(wide / cell) + 1, int(deep / cell) + 1
        self.grid: Floats = np.array([self.low[0], self.low[1], cell, self.high[2], float(self.beside.max())])
        self.size: Ints = np.array([nx, ny, int(np.argmax(self.box[:, 4]))], dtype=np.int64)
        first = np.zeros(nx * ny + 1, dtype=np.int64)
        self.top: Floats = np.full(nx * ny, -math.inf)
        fill = raster.pick(count)
        given = (self.corners, self.disc, self.low[0], self.low[1], cell, nx, ny)
        total = fill(*given, first, np.zeros(0, dtype=np.int64), self.top, 0)
        first = np.cumsum(first)
        self.items: Ints = np.zeros(total, dtype=np.int64)
        raster.pick(count)(*given, first, self.items, self.top, 1)
        self.first: Ints = np.concatenate([np.zeros(1, dtype=np.int64), first[:-1]])

    def _entries(self, cell: float) -> float:
        """How many facets all cells together would list at most."""
        across = (self.box[:, 1] - self.box[:, 0]) / cell + 2
        return float((across * ((self.box[:, 3] - self.box[:, 2]) / cell + 2)).sum())

    def holds(self, body: int, point: tuple[float, float, float]) -> bool | None:
        """Whether a point is in a body; None when its surface does not say."""
        return holds(self.bodies[body].body, point)


def surface_of(bodies: Sequence[Placed]) -> Surface:
    """The surface of bodies; of the very same ones the same, as long as somebody keeps it: several checks ask."""
    key = tuple(map(id, bodies))
    found = _KEPT.get(key)
    if found is None:
        # It keeps its bodies, so that no other body has their numbers as long as it is there.
        found = _KEPT[key] = Surface(bodies)
    return found


_KEPT: WeakValueDictionary[tuple[int, ...], Surface] = WeakValueDictionary()


def facets_of(body: Body) -> tuple[Floats, float]:
    """(n, 12) corners of a body's facets, and how far around them it goes."""
    match body:
        case Box(low=low, high=high):
            (x0, y0, z0), (x1, y1, z1) = low, high
            ring = ((x0, y0), (x1, y0), (x1, y1), (x0, y1))
            ends = [[c for x, y in ring for c in (x, y, z)] for z in (z0, z1)]
            return np.array([*_walls(ring, z0, z1), *ends], dtype=np.float64), 0.0
        case Cylinder():
            low, high = (body.x, body.y, body.low), (body.x, body.y, body.high)
            return np.array([[*low, *high, *low, *high]], dtype=np.float64), body.radius
        case Prism():
            rings = (body.outline, *body.holes)
            rows = [wall for ring in rings for wall in _walls(ring, body.low, body.high)]
            for (xa, xb, ya), (xc, xd, yb) in _trapezia(rings):
                for z in (body.low, body.high):
                    rows.append([xa, ya, z, xb, ya, z, xd, yb, z, xc, yb, z])
            return np.array(rows, dtype=np.float64), 0.0
        case Mesh():
            a, b, c = (np.asarray(body.triangles[name], dtype=np.float64) for name in "abc")
            return np.concatenate([a, b, c, c], axis=1), 0.0


def _walls(ring: Sequence[Point], low: float, high: float) -> list[list[float]]:
    out = []
    for (x0, y0), (x1, y1) in zip(ring, (*ring[1:], ring[0]), strict=True):
        out.append([x0, y0, low, x1, y1, low, x1, y1, high, x0, y0, high])
    return out


Side = tuple[float, float, float]
"""Two X at one Y."""


def _trapezia(rings: Sequence[Sequence[Point]]) -> list[tuple[Side, Side]]:
    """What is inside rings (outlines less holes), cut into trapezia at the Y of each corner."""
    edges = []
    for ring in rings:
        for (x0, y0), (x1, y1) in zip(ring, (*ring[1:], ring[0]), strict=True):
            if y0 < y1:
                edges.append((y0, y1, x0, x1))
            elif y1 < y0:
                edges.append((y1, y0, x1, x0))
    edges.sort()
    heights = sorted({y for ring in rings for _, y in ring})
    out = []
    active: list[tuple[float, float, float, float]] = []
    begin = 0
    for low, high in itertools.pairwise(heights):
        active = [edge for edge in active if edge[1] > low]
        while begin < len(edges) and edges[begin][0] <= low:
            active.append(edges[begin])
            begin += 1
        sides = []
        for y0, y1, x0, x1 in active:
            if y1 <= low:
                continue
            at = [x0 if y == y0 else x1 if y == y1 else x0 + (x1 - x0) * ((y - y0) / (y1 - y0)) for y in (low, high)]
            sides.append((at[0] + at[1], at[0], at[1]))
        sides.sort()
        for (_, xa, xc), (_, xb, xd) in zip(sides[::2], sides[1::2], strict=False):
            out.append(((xa, xb, low), (xc, xd, high)))
    return out


def _planes(corners: Floats) -> Floats:
    """(n, 5): see ``Surface``; all 0 for a facet that has no plane."""
    four = corners.reshape(-1, 4, 3)
    u, v = four[:, 2] - four[:, 0], four[:, 3] - four[:, 1]
    same = (four[:, 2] == four[:, 3]).all(axis=1)
    v = np.where(same[:, None], four[:, 1] - four[:, 0], v)
    x = u[:, 1] * v[:, 2] - u[:, 2] * v[:, 1]
    y = u[:, 2] * v[:, 0] - u[:, 0] * v[:, 2]
    z = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
    size = np.sqrt(x * x + y * y + z * z)
    with np.errstate(divide="ignore", invalid="ignore"):
        x, y, z = x / size, y / size, z / size
        at = x[:, None] * four[:, :, 0] + y[:, None] * four[:, :, 1] + z[:, None] * four[:, :, 2]
        good = (size > 0.0) & (at.max(axis=1) - at.min(axis=1) <= _FLAT)
    planes = np.stack([x, y, z, at[:, 0], np.sqrt(x * x + y * y)], axis=1)
    planes[~good] = 0.0
    return planes


def holds(body: Body, point: tuple[float, float, float]) -> bool | None:
    """Whether a point is in a body; None when its surface does not say. Cylinders are solid facets: never."""
    x, y, z = point
    match body:
        case Box(low=low, high=high):
            return all(a < p < b for a, p, b in zip(low, point, high, strict=True))
        case Cylinder():
            return False
        case Prism():
            if not body.low < z < body.high:
                return False
            crossings = 0
            for ring in (body.outline, *body.holes):
                for (x0, y0), (x1, y1) in zip(ring, (*ring[1:], ring[0]), strict=True):
                    if (y0 > y) != (y1 > y) and x < x0 + (x1 - x0) * ((y - y0) / (y1 - y0)):
                        crossings += 1
            return crossings % 2 == 1
        case Mesh():
            return _within_mesh(body, np.array(point, dtype=np.float64))


def _within_mesh(body: Mesh, point: Floats) -> bool | None:
    """By how often the surface goes around the point: the sum of the solid angles of its triangles."""
    a, b, c = (np.asarray(body.triangles[name], dtype=np.float64) for name in "abc")
    low, high = a.min(axis=0), a.max(axis=0)
    low, high = np.minimum(low, np.minimum(b.min(axis=0), c.min(axis=0))), np.maximum(high, b.max(axis=0))
    high = np.maximum(high, c.max(axis=0))
    if (point <= low).any() or (point >= high).any():
        return False
    if not body.closed:
        return None
    a, b, c = a - point, b - point, c - point
    la, lb, lc = (np.sqrt((v * v).sum(axis=1)) for v in (a, b, c))
    volume = (a * np.cross(b, c)).sum(axis=1)
    other = la * lb * lc + (a * b).sum(axis=1) * lc + (b * c).sum(axis=1) * la + (c * a).sum(axis=1) * lb
    around = float(np.arctan2(volume, other).sum()) / (2.0 * math.pi)
    turns = abs(around)
    if abs(turns - round(turns)) > 0.1:
        return None
    return round(turns) != 0
