"""What a height map adds to Z along each row: exact bounds over the row's X-Y extent.

A bilinear function over a rectangle inside a cell is least and greatest at the rectangle's corners; so over any
rectangle at its own corners, where its sides cross grid lines, and at the points inside it.
"""

from __future__ import annotations

import math
from typing import Any

from gproof.ir.kernel import kernel
from gproof.passes.geometry.extent_kernels import arc_extreme

MARGIN = 1e-9
"""Of a cell: by so much a row's extent is taken larger than it is."""


@kernel(seconds_per_unit=1e-6)
def height_at(u: float, v: float, heights: Any) -> float:
    """Bilinear between the four points around (u, v), which are cells from the first point."""
    ny, nx = heights.shape
    i = min(int(u), nx - 2)
    j = min(int(v), ny - 2)
    s, t = u - i, v - j
    low = heights[j, i] * (1.0 - s) + heights[j, i + 1] * s
    high = heights[j + 1, i] * (1.0 - s) + heights[j + 1, i + 1] * s
    return float(low * (1.0 - t) + high * t)


@kernel(seconds_per_unit=8e-6, compile_seconds=0.6)
def height_spans(
    op: Any,
    to: Any,
    center: Any,
    turns: Any,
    plane: Any,
    frame: Any,
    state: Any,
    position: Any,
    frame_before: int,
    on: Any,
    known: Any,
    grid: Any,
    heights: Any,
    spans: Any,
) -> None:
    """Least and most that is added to Z in each row, into ``spans`` (n, 2).

    position: (6,) before the first row, updated; frame_before: its frame; on: by state, 1 where the map is on; known:
    (frames, 6) 1 where an axis is known; grid: (3,) X, Y of the first point, size; heights: (ny, nx), that of the
    first point subtracted. A row whose X or Y is not known may be anywhere.
    """
    ny, nx = heights.shape
    least_of_all = 0.0
    most_of_all = 0.0
    for j in range(ny):
        for i in range(nx):
            least_of_all = min(least_of_all, heights[j, i])
            most_of_all = max(most_of_all, heights[j, i])
    before = frame_before
    least = [0.0, 0.0, 0.0]
    most = [0.0, 0.0, 0.0]
    for row in range(len(op)):
        spans[row, 0] = 0.0
        spans[row, 1] = 0.0
        here = frame[row]
        if on[state[row]] == 1:
            if known[here, 0] * known[here, 1] * known[before, 0] * known[before, 1] == 0:
                spans[row, 0] = least_of_all
                spans[row, 1] = most_of_all
            else:
                for axis in range(3):
                    least[axis] = min(position[axis], to[row, axis])
                    most[axis] = max(position[axis], to[row, axis])
                if op[row] == 3:
                    p = plane[row]
                    u = 0 if p == 1 else (2 if p == 2 else 1)
                    v = 1 if p == 1 else (0 if p == 2 else 2)
                    cu, cv = center[row, u], center[row, v]
                    a, b, c, d, _ = arc_extreme(
                        position[u] - cu, position[v] - cv, to[row, u] - cu, to[row, v] - cv, turns[row]
                    )
                    least[u], most[u] = min(least[u], cu + a), max(most[u], cu + b)
                    least[v], most[v] = min(least[v], cv + c), max(most[v], cv + d)
                x0 = (least[0] - grid[0]) / grid[2] - MARGIN
                x1 = (most[0] - grid[0]) / grid[2] + MARGIN
                y0 = (least[1] - grid[1]) / grid[2] - MARGIN
                y1 = (most[1] - grid[1]) / grid[2] + MARGIN
                low = math.inf
                high = -math.inf
                if x0 < 0.0 or y0 < 0.0 or x1 > nx - 1 or y1 > ny - 1:
                    low = 0.0
                    high = 0.0
                if x1 >= 0.0 and y1 >= 0.0 and x0 <= nx - 1 and y0 <= ny - 1:
                    x0, x1 = max(x0, 0.0), min(x1, nx - 1.0)
                    y0, y1 = max(y0, 0.0), min(y1, ny - 1.0)
                    for j in range(int(y1) - int(y0) + 2):
                        v = min(max(y0, math.floor(y0) + j), y1)
                        for i in range(int(x1) - int(x0) + 2):
                            h = height_at(min(max(x0, math.floor(x0) + i), x1), v, heights)
                            low = min(low, h)
                            high = max(high, h)
                spans[row, 0] = low
                spans[row, 1] = high
        if op[row] < 10:
            before = here
            for axis in range(6):
                position[axis] = to[row, axis]
