"""Height fields of the stock that is still there, and what a tool takes away on a straight line.

A field is a pair of arrays over the cells of a grid in X and Y, (ny, nx): ``upper``, so that no stock of a cell is
higher anywhere in it, and ``lower``, so that stock is at least as high everywhere in it (both -inf: none). ``grid``
is (x0, y0, hx, hy, floor, top): corner, sizes of a cell, the lowest and the highest place of the body, mm.

What is surely gone of a cell that the move covers whole is the greatest of the envelope at its corners
(``tool_side_kernels``). What may be gone is bounded by the envelope of the tool widened by half a diagonal, at the
cell's middle. Arcs go by chords, with the tool made smaller and wider by what these leave.
"""

from __future__ import annotations

import math
from typing import Any

from gproof.ir.kernel import kernel
from gproof.passes.checks.stock.tool_side_kernels import side_line, smaller, wider

INF = math.inf


@kernel(compile_seconds=0.4)
def crossing(
    y: float, ax: float, ay: float, bx: float, by: float, ux: float, uy: float, radius: float
) -> tuple[float, float]:
    """Where a line of constant Y enters and leaves what is within the radius of a segment; (inf, -inf): nowhere."""
    left, right = INF, -INF
    square = radius * radius - (y - ay) * (y - ay)
    if square >= 0.0:
        half = math.sqrt(square)
        left, right = ax - half, ax + half
    square = radius * radius - (y - by) * (y - by)
    if square >= 0.0:
        half = math.sqrt(square)
        left, right = min(left, bx - half), max(right, bx + half)
    for side in (-1.0, 1.0):
        py, qy = ay + side * ux * radius, by + side * ux * radius
        if py != qy and (y - py) * (y - qy) <= 0.0:
            x = ax - side * uy * radius + (y - py) / (qy - py) * (bx - ax)
            left, right = min(left, x), max(right, x)
    return left, right


@kernel(compile_seconds=0.2)
def behind(family: int, radius: float, slope: float, again: bool) -> float:
    """So far after the start of a chord, and further, its start leaves least: nothing new where it was cut before."""
    if not again:
        return INF
    if slope >= 0.0:
        return 0.0
    if family == 1:
        return radius * abs(slope) / math.sqrt(1.0 + slope * slope)
    return 0.0 if family == 0 and slope == 0.0 else radius


@kernel(compile_seconds=0.2)
def beyond(
    left: float, right: float, y: float, ax: float, ay: float, ux: float, uy: float, back: float
) -> tuple[float, float]:
    """What of a line of constant Y is not further than that after a start; (inf, -inf): nothing."""
    if back == INF:
        return left, right
    need = -back - (y - ay) * uy
    if ux > 1e-9:
        return max(left, ax + need / ux), right
    if ux < -1e-9:
        return left, min(right, ax + need / ux)
    if need > 1e-3 + (abs(left) + abs(right) + abs(ax)) * 1e-9:
        return INF, -INF
    return left, right


@kernel(compile_seconds=0.3)
def lower_line(a: Any, b: Any, upper: Any, floor: float) -> None:
    """Lower a row of cells to the highest of the envelope at their corners; -inf where the floor is reached."""
    for i in range(len(upper)):
        left = min(upper[i], max(max(a[i], a[i + 1]), max(b[i], b[i + 1])))  # noqa: PLW3301
        upper[i] = left if left > floor else -INF


@kernel(compile_seconds=0.2)
def less_line(line: Any, lower: Any, least: float) -> None:
    """Lower a row of cells to what a tool may leave, which is never below its tip."""
    for i in range(len(lower)):
        lower[i] = min(lower[i], max(line[i], least))


@kernel(compile_seconds=1.5)
def remove(
    upper: Any, lower: Any, grid: Any, tool: Any, chord: Any, beside: float, beneath: float, again: bool, later: bool,
    top: float, line: Any, most: Any,
) -> None:  # fmt: skip
    """Take away what a tool cuts on a straight line; later: ``lower`` goes down afterwards.

    tool: a row of ``ToolTables.shapes``; chord: (ax, ay, az, bx, by, bz) of the tip; ``beside``, ``beneath``: mm
    that the tool may be off it in X-Y and in Z; again: the same tool has cut up to the start, as far off; top: of all
    stock; line: (2, nx + 1) scratch; most: (4,) by how much the flutes may be and surely are too short and the depth
    may be and surely is too great, updated.
    """
    ny, nx = upper.shape
    x0, y0, hx, hy, floor = grid[0], grid[1], grid[2], grid[3], grid[4]
    family, k = int(tool[0]), tool[3]
    ax, ay, az = chord[0], chord[1], chord[2]
    bx, by, bz = chord[3], chord[4], chord[5]
    length = math.sqrt((bx - ax) * (bx - ax) + (by - ay) * (by - ay))
    low_z, high_z = min(az, bz), max(az, bz)
    ux, uy, slope, z = 1.0, 0.0, 0.0, low_z
    if length > 0.0:
        ux, uy, slope, z = (bx - ax) / length, (by - ay) / length, (bz - az) / length, az
    # Flutes cut what is between the tip and their end at all times, in a plunge what they come by.
    reach = (low_z if length > 0.0 else high_z) + tool[8] - beneath
    if tool[10] < tool[1]:
        # What its tip leaves is not known.
        reach = -INF
    kind, radius, c, up = smaller(family, tool[1], tool[2], k, beside)
    up += beneath
    if radius > 0.0:
        first = max(math.ceil((min(ay, by) - radius - y0) / hy), 0)
        last = min(math.floor((max(ay, by) + radius - y0) / hy), ny)
        easy = top - low_z + beneath <= min(tool[5], tool[6], tool[8]) and reach > -INF
        back = behind(kind, radius, slope, again and length > 0.0) + hx * abs(ux) + hy * abs(uy)
        before_low, before_high = 1, 0
        for row in range(first, last + 1):
            now = row & 1
            y = y0 + row * hy
            left, right = crossing(y, ax, ay, bx, by, ux, uy, radius)
            left, right = beyond(left, right, y, ax, ay, ux, uy, back)
            low, high = 1, 0
            if left <= right:
                low = max(math.ceil((left - x0) / hx), 0)
                high = min(math.floor((right - x0) / hx), nx)
            if low <= high:
                dx, dy = x0 + low * hx - ax, y - ay
                side_line(
                    kind, radius, c, k, dx * ux + dy * uy, hx * ux, dy * ux - dx * uy, -hx * uy, length, slope, z + up,
                    line[now, low : high + 1],
                )  # fmt: skip
            first_i, last_i = max(low, before_low), min(high, before_high)
            if first_i < last_i and easy:
                lower_line(line[0, first_i:], line[1, first_i:], upper[row - 1, first_i:last_i], floor)
            elif first_i < last_i:
                for i in range(first_i, last_i):
                    was = upper[row - 1, i]
                    gone = max(line[0, i], line[0, i + 1], line[1, i], line[1, i + 1])
                    if gone >= was:
                        continue
                    tip_low, tip_high = low_z, low_z
                    if slope != 0.0:
                        dx, dy = x0 + (i + 0.5) * hx - ax, y - 0.5 * hy - ay
                        s = dx * ux + dy * uy
                        wide = radius + hx + hy
                        p = min(max(s - wide, 0.0), length) * slope + az
                        n = min(max(s + wide, 0.0), length) * slope + az
                        tip_low, tip_high = max(min(p, n), low_z), min(max(p, n), high_z)
                    sure = lower[row - 1, i]
                    most[0] = max(most[0], was - tip_low - tool[5])
                    most[1] = max(most[1], sure - tip_high - tool[5] if reach > -INF else -INF)
                    most[2] = max(most[2], was - tip_low - tool[6])
                    most[3] = max(most[3], sure - tip_high - tool[6] if reach > -INF else -INF)
                    if was <= reach:
                        upper[row - 1, i] = gone if gone > floor else -INF
            before_low, before_high = low, high
    if not later:
        lessen(lower, grid, family, tool[1], tool[2], k, chord, beside, beneath, again, line)


@kernel(compile_seconds=0.8)
def lessen(
    lower: Any, grid: Any, family: int, radius: float, c: float, k: float, chord: Any, beside: float, beneath: float,
    again: bool, line: Any,
) -> None:  # fmt: skip
    """Let ``lower`` go down to what a tool may have cut on a straight line."""
    ny, nx = lower.shape
    x0, y0, hx, hy = grid[0], grid[1], grid[2], grid[3]
    ax, ay, az = chord[0], chord[1], chord[2]
    bx, by, bz = chord[3], chord[4], chord[5]
    length = math.sqrt((bx - ax) * (bx - ax) + (by - ay) * (by - ay))
    least = min(az, bz)
    ux, uy, slope, z = 1.0, 0.0, 0.0, least
    if length > 0.0:
        ux, uy, slope, z = (bx - ax) / length, (by - ay) / length, (bz - az) / length, az
    least -= beneath
    half = 0.5 * math.sqrt(hx * hx + hy * hy)
    radius, c, down = wider(family, radius, c, beside + half)
    z -= down + beneath
    # As for the tool that is wider sideways only, whose bottom is flat for half a diagonal.
    back = behind(family, radius, slope, again and length > 0.0) + half
    first = max(math.floor((min(ay, by) - radius - y0) / hy - 0.5), 0)
    last = min(math.ceil((max(ay, by) + radius - y0) / hy - 0.5), ny - 1)
    for row in range(first, last + 1):
        y = y0 + (row + 0.5) * hy
        left, right = crossing(y, ax, ay, bx, by, ux, uy, radius)
        left, right = beyond(left, right, y, ax, ay, ux, uy, back)
        if left > right:
            continue
        low = max(math.ceil((left - x0) / hx - 0.5), 0)
        high = min(math.floor((right - x0) / hx - 0.5), nx - 1)
        if low <= high:
            dx, dy = x0 + (low + 0.5) * hx - ax, y - ay
            side_line(
                family, radius, c, k, dx * ux + dy * uy, hx * ux, dy * ux - dx * uy, -hx * uy, length, slope, z,
                line[0, low : high + 1],
            )  # fmt: skip
            less_line(line[0, low:], lower[row, low : high + 1], least)
