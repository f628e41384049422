"""Whether a part of a tool enters stock on a straight line: for certain, perhaps, or not, and how deep.

Fields and grid: see ``removal_kernels``.
"""

from __future__ import annotations

import math
from typing import Any

from gproof.ir.kernel import kernel
from gproof.passes.checks.stock.removal_kernels import INF, lessen
from gproof.passes.checks.stock.tool_side_kernels import lower_side

KINDS = 5
"""Columns of what is reported by row: traverse, flutes, greatest depth, shank, holder."""
THROUGH, FLUTES, DEPTH, SHANK, HOLDER = range(KINDS)
CLEAR, MAYBE, SURE, NO_PLACE, NO_SHAPE, FROM_START = range(6)
"""What is said: nothing; may be; is; the place, or the tool's shape, is not known; the path from an unknown start."""
TOUCH = 1e-7
"""mm: a tool that is this deep in stock touches it."""
SHORTEST = 1e-6
"""mm of a move whose pieces are looked at no closer."""


@kernel(compile_seconds=0.6)
def meets(
    box: Any, shape: Any, certain: float, chord: Any, loose: bool, clearance: float, beside: float, beneath: float,
    high: float, sure: float,
) -> tuple[int, float]:  # fmt: skip
    """Whether a body of revolution on a straight line enters the stock of a cell: (CLEAR, MAYBE or SURE, mm).

    box: (4,) low X, low Y, high X, high Y of the cell; shape: (family, R, c, k, up), its lower side ``up`` above the
    tip, for certain only within the radius ``certain``; loose: it may be anywhere in the box of the chord; high: no
    stock is higher; sure: it is so high. The path is looked at in pieces, bounded by the box of each, halved where
    that does not do.
    """
    family, radius, c, k = int(shape[0]), shape[1], shape[2], shape[3]
    spare = clearance + beside
    wide = radius + spare
    need = high + clearance + beneath - shape[4]
    low_x, low_y, high_x, high_y = box[0], box[1], box[2], box[3]
    dx, dy, dz = chord[3] - chord[0], chord[4] - chord[1], chord[5] - chord[2]
    long = max(abs(dx), abs(dy), abs(dz))
    shortest = 1.0 if loose or long <= SHORTEST else SHORTEST / long
    t, step = 0.0, 1.0
    while t < 1.0:
        end = min(t + step, 1.0)
        px, qx = chord[0] + t * dx, chord[0] + end * dx
        py, qy = chord[1] + t * dy, chord[1] + end * dy
        z = min(chord[2] + t * dz, chord[2] + end * dz)
        gap_x = max(low_x - max(px, qx), min(px, qx) - high_x, 0.0)
        gap_y = max(low_y - max(py, qy), min(py, qy) - high_y, 0.0)
        gap = math.sqrt(gap_x * gap_x + gap_y * gap_y)
        into = need - z - lower_side(family, radius, c, k, min(max(gap - spare, 0.0), radius))
        if gap >= wide - TOUCH or into <= TOUCH:
            t, step = end, 2.0 * (end - t)
            continue
        if end - t <= shortest:
            break
        step = 0.5 * (end - t)
    if t >= 1.0:
        return CLEAR, 0.0
    if loose:
        return MAYBE, into
    # The deepest of a few places; one that is surely in it is enough, and can only be missed.
    deepest, perhaps = -INF, into
    for n in range(33):
        t = n / 32.0
        x, y, z = chord[0] + t * dx, chord[1] + t * dy, chord[2] + t * dz
        gap_x = max(low_x - x, x - high_x, 0.0)
        gap_y = max(low_y - y, y - high_y, 0.0)
        gap = math.sqrt(gap_x * gap_x + gap_y * gap_y)
        if gap < wide:
            side = lower_side(family, radius, c, k, min(max(gap - spare, 0.0), radius))
            perhaps = max(perhaps, need - z - side)
        gap += beside
        if gap < certain:
            deepest = max(deepest, sure - beneath - shape[4] - z - lower_side(family, radius, c, k, gap))
    if deepest > TOUCH:
        return SURE, deepest
    return MAYBE, perhaps


@kernel(compile_seconds=1.0)
def enter(
    upper: Any, lower: Any, grid: Any, shape: Any, certain: float, chord: Any, loose: bool, clearance: float,
    beside: float, beneath: float, box: Any,
) -> tuple[int, float]:  # fmt: skip
    """The same for all cells of a field: the worst answer, and by how much. box: (4,) scratch."""
    ny, nx = upper.shape
    x0, y0, hx, hy, floor = grid[0], grid[1], grid[2], grid[3], grid[4]
    wide = shape[1] + clearance + beside
    tip = min(chord[2], chord[5])
    free = tip + shape[4] - clearance - beneath + TOUCH
    left = max(math.floor((min(chord[0], chord[3]) - wide - x0) / hx), 0)
    right = min(math.floor((max(chord[0], chord[3]) + wide - x0) / hx), nx - 1)
    first = max(math.floor((min(chord[1], chord[4]) - wide - y0) / hy), 0)
    last = min(math.floor((max(chord[1], chord[4]) + wide - y0) / hy), ny - 1)
    worst, amount = CLEAR, 0.0
    for row in range(first, last + 1):
        for i in range(left, right + 1):
            high = upper[row, i]
            if high <= free or high <= floor:
                continue
            sure = lower[row, i] if lower[row, i] > floor + TOUCH else -INF
            if worst == SURE and sure - tip - shape[4] <= amount:
                continue
            if worst == MAYBE and sure <= -INF and high - free <= amount:
                continue
            box[0], box[1] = x0 + i * hx, y0 + row * hy
            box[2], box[3] = box[0] + hx, box[1] + hy
            answer, into = meets(box, shape, certain, chord, loose, clearance, beside, beneath, high, sure)
            if answer > worst or (answer == worst and into > amount):
                worst, amount = answer, into
    return worst, amount


@kernel(compile_seconds=0.3)
def enter_loose(
    upper: Any, lower: Any, grid: Any, shape: Any, certain: float, chord: Any, loose: bool, clearance: float,
    beside: float, beneath: float, box: Any,
) -> tuple[int, float]:  # fmt: skip
    """``enter``; of a path that may be any, its end is certain: what is there was entered on whichever path."""
    answer, into = enter(upper, lower, grid, shape, certain, chord, loose, clearance, beside, beneath, box)
    if not loose or answer != MAYBE:
        return answer, into
    x, y, z = chord[0], chord[1], chord[2]
    chord[0], chord[1], chord[2] = chord[3], chord[4], chord[5]
    at_end, deep = enter(upper, lower, grid, shape, certain, chord, False, clearance, beside, beneath, box)
    chord[0], chord[1], chord[2] = x, y, z
    if at_end == SURE:
        return at_end, deep
    return answer, into


@kernel(compile_seconds=0.3)
def through(
    upper: Any, lower: Any, grid: Any, tool: Any, chord: Any, loose: bool, clearance: float, beside: float,
    beneath: float, box: Any, line: Any, told: Any, amount: Any,
) -> None:  # fmt: skip
    """A traverse on a straight line: ``told`` and ``amount`` of its row, and what it may have cut."""
    answer, into = enter_loose(upper, lower, grid, tool, tool[10], chord, loose, clearance, beside, beneath, box)
    if answer == CLEAR:
        return
    told[THROUGH], amount[THROUGH] = answer, into
    if loose:
        lower[:, :] = -INF
    else:
        lessen(lower, grid, int(tool[0]), tool[1], tool[2], tool[3], chord, beside, beneath, False, line)


@kernel(compile_seconds=0.2)
def near(grid: Any, upper: Any, wide: float, chord: Any) -> bool:
    """Whether what is within ``wide`` of a chord may be over the field."""
    ny, nx = upper.shape
    beside_x = min(chord[0], chord[3]) - wide > grid[0] + nx * grid[2] or max(chord[0], chord[3]) + wide < grid[0]
    beside_y = min(chord[1], chord[4]) - wide > grid[1] + ny * grid[3] or max(chord[1], chord[4]) + wide < grid[1]
    return not (beside_x or beside_y)


@kernel(compile_seconds=0.3)
def is_under(upper: Any, grid: Any, wide: float, chord: Any, height: float) -> bool:
    """Whether a cell that is within ``wide`` of a chord's box has stock above a height."""
    ny, nx = upper.shape
    left = max(math.floor((min(chord[0], chord[3]) - wide - grid[0]) / grid[2]), 0)
    right = min(math.floor((max(chord[0], chord[3]) + wide - grid[0]) / grid[2]), nx - 1)
    first = max(math.floor((min(chord[1], chord[4]) - wide - grid[1]) / grid[3]), 0)
    last = min(math.floor((max(chord[1], chord[4]) + wide - grid[1]) / grid[3]), ny - 1)
    for row in range(first, last + 1):
        for i in range(left, right + 1):
            if upper[row, i] > height:
                return True
    return False
