"""Height fields of bodies of stock before the job: what fills each cell for certain, and what may be in it.

A cell is all of a rectangle in X and Y. ``upper``: no stock of the body is higher anywhere in the cell; ``lower``:
from the floor of the body up to there all of the cell is stock; -inf where there is none. Cells fit into the
body's extent a whole number of times, so that they are at most as large as required. Boxes are exact; cylinders and
prisms are but in the cells that their outline passes, where ``lower`` is -inf. A mesh gives the highest place of its
triangles in a cell, and the lowest of those that look upwards, where nothing else is over the floor: cells with a
wall or an underside have no ``lower``.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from gproof.ir.columns import Columns
from gproof.ir.record import record
from gproof.ir.workpiece import Body, Cylinder, Mesh, Prism, extent
from gproof.passes.checks.base import Remains
from gproof.passes.checks.stock.rasterize_kernels import outline_cells, triangle_cells

Floats = npt.NDArray[np.float64]

MOST_CELLS = 16_000_000
"""Of one body: 256 MB. Larger ones get larger cells."""
SHOWN_CELLS = 240
"""Along a side of what pictures show."""


@record(slots=True, eq=False)
class Field:
    """grid: (x0, y0, hx, hy, floor, top), mm; upper, lower: (ny, nx)."""

    grid: Floats
    upper: Floats
    lower: Floats

    @property
    def cell(self) -> float:
        """The longer side of a cell."""
        return float(max(self.grid[2], self.grid[3]))

    def copy(self) -> Field:
        """Another one that changes by itself."""
        return Field(self.grid, self.upper.copy(), self.lower.copy())


def remains_of(body: int, before: Field, after: Field) -> Remains:
    """A field as pictures show it."""
    ny, nx = after.upper.shape
    by = math.ceil(ny / SHOWN_CELLS), math.ceil(nx / SHOWN_CELLS)
    grid = after.grid.copy()
    grid[2], grid[3] = grid[2] * by[1], grid[3] * by[0]
    return Remains(body, grid, _highest(after.upper, by), _highest(before.upper, by))


def _highest(upper: Floats, by: tuple[int, int]) -> Floats:
    """The highest of so many cells by so many."""
    short = [-size % step for size, step in zip(upper.shape, by, strict=True)]
    padded = np.pad(upper, ((0, short[0]), (0, short[1])), constant_values=-math.inf)
    ny, nx = padded.shape[0] // by[0], padded.shape[1] // by[1]
    found: Floats = padded.reshape(ny, by[0], nx, by[1]).max(axis=(1, 3))
    return found


def field_of(body: Body, cell: float, most: int = MOST_CELLS) -> Field:
    """The field of a body that nothing has cut yet, with cells of at most ``cell`` mm where ``most`` of them do."""
    low_x, low_y, floor, high_x, high_y, top = extent(body)
    width, depth = max(high_x - low_x, 1e-6), max(high_y - low_y, 1e-6)
    if math.ceil(width / cell) * math.ceil(depth / cell) > most:
        cell = max(math.sqrt(width * depth / most) * 1.001, width / most, depth / most)
        while math.ceil(width / cell) * math.ceil(depth / cell) > most:
            cell *= 1.01
    nx, ny = max(1, math.ceil(width / cell - 1e-9)), max(1, math.ceil(depth / cell - 1e-9))
    grid = np.array([low_x, low_y, width / nx, depth / ny, floor, top])
    upper, lower = np.full((ny, nx), top), np.full((ny, nx), top)
    if isinstance(body, Cylinder):
        _round(body, grid, upper, lower)
    elif isinstance(body, Prism):
        _outlined(body, grid, upper, lower)
    elif isinstance(body, Mesh):
        _meshed(body, grid, upper, lower)
    return Field(grid, upper, lower)


def _round(body: Cylinder, grid: Floats, upper: Floats, lower: Floats) -> None:
    ny, nx = upper.shape
    near, far = [], []
    for low, size, count, middle in ((grid[0], grid[2], nx, body.x), (grid[1], grid[3], ny, body.y)):
        left = low + np.arange(count) * size - middle
        right = left + size
        near.append(np.maximum(np.maximum(left, -right), 0.0))
        far.append(np.maximum(np.abs(left), np.abs(right)))
    square = body.radius * body.radius
    upper[near[0][None, :] ** 2 + near[1][:, None] ** 2 > square * (1 + 1e-12)] = -math.inf
    lower[far[0][None, :] ** 2 + far[1][:, None] ** 2 > square * (1 - 1e-12)] = -math.inf


def _outlined(body: Prism, grid: Floats, upper: Floats, lower: Floats) -> None:
    edges = []
    for ring in (body.outline, *body.holes):
        points = np.array(ring, dtype=np.float64).reshape(-1, 2)
        edges.append(np.hstack([points, np.roll(points, -1, axis=0)]))
    touched, inside = np.zeros(upper.shape, dtype=np.uint8), np.zeros(upper.shape, dtype=np.uint8)
    every = np.concatenate(edges)
    outline_cells.pick(upper.size + len(every) * 4)(every, body.error, grid, touched, inside)
    upper[(touched == 0) & (inside == 0)] = -math.inf
    lower[(touched == 1) | (inside == 0)] = -math.inf


def _meshed(body: Mesh, grid: Floats, upper: Floats, lower: Floats) -> None:
    triangles: Columns = body.triangles
    upper[:], lower[:] = -math.inf, math.inf
    open_below = np.zeros(upper.shape, dtype=np.uint8)
    triangle_cells.pick(upper.size + len(triangles))(
        triangles["a"], triangles["b"], triangles["c"], grid, upper, lower, open_below
    )
    lower[(open_below == 1) | (lower == math.inf) | (not body.closed)] = -math.inf
    np.minimum(lower, upper, out=lower)
