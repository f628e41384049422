"""Which cells of a grid an outline or a mesh touches and fills, exactly or on the side that protects."""

from __future__ import annotations

import math
from typing import Any

from gproof.ir.kernel import kernel

HAIR = 1e-9
"""mm by which a cell is taken larger than it is."""


@kernel(seconds_per_unit=4e-6, compile_seconds=1.0)
def outline_cells(edges: Any, error: float, grid: Any, touched: Any, inside: Any) -> None:
    """Mark the cells that edges come within ``error`` of, and those whose middle is inside.

    edges: (n, 4) x, y, x, y of all outlines and holes; grid: (x0, y0, hx, hy, ...); touched, inside: (ny, nx) uint8,
    all 0 before. Inside is by an odd number of edges on the left.
    """
    x0, y0, hx, hy = grid[0], grid[1], grid[2], grid[3]
    ny, nx = touched.shape
    error += HAIR
    for n in range(len(edges)):
        ax, ay, bx, by = edges[n, 0], edges[n, 1], edges[n, 2], edges[n, 3]
        if ay > by:
            ax, ay, bx, by = bx, by, ax, ay
        first = max(math.floor((ay - error - y0) / hy), 0)
        last = min(math.floor((by + error - y0) / hy), ny - 1)
        for row in range(first, last + 1):
            low, high = min(ax, bx), max(ax, bx)
            bottom, top = y0 + row * hy - error, y0 + (row + 1) * hy + error
            if by > ay and (ay < bottom or by > top):
                p = ax + (bx - ax) * (max(bottom - ay, 0.0) / (by - ay))
                q = ax + (bx - ax) * min((top - ay) / (by - ay), 1.0)
                low, high = max(low, min(p, q)), min(high, max(p, q))
            left = max(math.floor((low - error - x0) / hx), 0)
            right = min(math.floor((high + error - x0) / hx), nx - 1)
            for i in range(left, right + 1):
                touched[row, i] = 1
            y = y0 + (row + 0.5) * hy
            if ay <= y < by:
                x = ax + (bx - ax) * ((y - ay) / (by - ay))
                i = max(math.ceil((x - x0) / hx - 0.5), 0)
                if i < nx:
                    inside[row, i] ^= 1
    for row in range(ny):
        odd = 0
        for i in range(nx):
            odd ^= inside[row, i]
            inside[row, i] = odd


@kernel(seconds_per_unit=2e-5, compile_seconds=1.5)
def triangle_cells(a: Any, b: Any, c: Any, grid: Any, upper: Any, lower: Any, open_below: Any) -> None:
    """Raise ``upper`` to what triangles reach in each cell, and let ``lower`` go down to the least of upward ones.

    a, b, c: (n, 3) corners, counter-clockwise as seen from outside; grid: (x0, y0, hx, hy, floor, ...); upper: -inf
    before, lower: +inf before; open_below: (ny, nx) uint8, 1 where a wall or an underside above the floor is.
    """
    x0, y0, hx, hy, floor = grid[0], grid[1], grid[2], grid[3], grid[4]
    ny, nx = upper.shape
    for n in range(len(a)):
        ux, uy, uz = b[n, 0] - a[n, 0], b[n, 1] - a[n, 1], b[n, 2] - a[n, 2]
        vx, vy, vz = c[n, 0] - a[n, 0], c[n, 1] - a[n, 1], c[n, 2] - a[n, 2]
        normal_x, normal_y, normal_z = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
        low_z, high_z = min(a[n, 2], b[n, 2], c[n, 2]), max(a[n, 2], b[n, 2], c[n, 2])
        steep = abs(normal_z) <= 1e-9 * (abs(normal_x) + abs(normal_y))
        slope_x = slope_y = 0.0
        if not steep:
            slope_x, slope_y = -normal_x / normal_z, -normal_y / normal_z
        half = 0.5 * (abs(slope_x) * hx + abs(slope_y) * hy) + HAIR
        low_y, high_y = min(a[n, 1], b[n, 1], c[n, 1]), max(a[n, 1], b[n, 1], c[n, 1])
        first = max(math.floor((low_y - HAIR - y0) / hy), 0)
        last = min(math.floor((high_y + HAIR - y0) / hy), ny - 1)
        for row in range(first, last + 1):
            bottom, top = y0 + row * hy - HAIR, y0 + (row + 1) * hy + HAIR
            left_x, right_x = math.inf, -math.inf
            for side in range(3):
                px, py = a[n, 0], a[n, 1]
                qx, qy = b[n, 0], b[n, 1]
                if side == 1:
                    px, py, qx, qy = b[n, 0], b[n, 1], c[n, 0], c[n, 1]
                elif side == 2:
                    px, py, qx, qy = c[n, 0], c[n, 1], a[n, 0], a[n, 1]
                if bottom <= py <= top:
                    left_x, right_x = min(left_x, px), max(right_x, px)
                if py != qy:
                    for y in (bottom, top):
                        if (y - py) * (y - qy) <= 0.0:
                            x = px + (qx - px) * ((y - py) / (qy - py))
                            left_x, right_x = min(left_x, x), max(right_x, x)
            if left_x > right_x:
                continue
            left = max(math.floor((left_x - HAIR - x0) / hx), 0)
            right = min(math.floor((right_x + HAIR - x0) / hx), nx - 1)
            for i in range(left, right + 1):
                middle = a[n, 2]
                middle += slope_x * (x0 + (i + 0.5) * hx - a[n, 0]) + slope_y * (y0 + (row + 0.5) * hy - a[n, 1])
                reach = high_z if steep else min(high_z, middle + half)
                upper[row, i] = max(upper[row, i], reach)
                if normal_z > 0.0 and not steep:
                    lower[row, i] = min(lower[row, i], max(low_z, middle - half))
                elif high_z > floor + HAIR or steep:
                    open_below[row, i] = 1
