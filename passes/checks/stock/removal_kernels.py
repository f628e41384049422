"""Height fields of the stock that is still there, and what a moving tool does to them.

A field is a pair of arrays over the cells of a grid in X and Y, (ny, nx): ``upper``, so that no stock of a cell stands
higher anywhere in it, and ``lower``, so that stock stands at least as high everywhere in it (both -inf: none). ``grid``
is (x0, y0, hx, hy, floor, top): corner, sizes of a cell, the lowest and the highest place of the body, mm.

The lower side of a tool is a function f of the distance r from its axis, convex and never falling up to its radius.
Where the tip moves on a straight line, the height of that side over a point is convex in point and time together, so
that its least value over the move, the envelope, is convex in the point: over a cell that the move covers whole it is
greatest at a corner. That is what is surely gone. What may be gone is bounded by the envelope of the tool widened by
half a diagonal, at the cell's middle. Arcs go by chords, with the tool made smaller and wider by what these leave.

Families of shapes (family, R, c, k): 0 flat; 1 ball; 2 bull with corners of radius c; 3 cone with a flat of radius c
at the tip and k mm outwards for each mm upwards (vee, drill).
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from gproof.ir.kernel import kernel

TRAVERSE, FEED, ARC, PROBE, TOOL_CHANGE, HOME = 1, 2, 3, 4, 13, 17
KINDS = 5
"""Columns of what is told by row: traverse, flutes, greatest depth, shank, holder."""
THROUGH, FLUTES, DEPTH, SHANK, HOLDER = range(KINDS)
CLEAR, MAYBE, SURE, NO_PLACE, NO_SHAPE, FROM_START = range(6)
"""What is told: nothing; may be; is; the place, or the tool's shape, is not known; the way from an unknown start."""
HEIGHT, PLACE, START, END = 1, 2, 4, 8
"""What is known of a row, bits: Z, X and Y, and that all else rests on where the axes stood at the beginning."""
LOOKED = 4096
"""After so many rows the highest place that is left is looked for again."""
MEMORY = 12
"""Numbers that are kept from chunk to chunk: see ``follow``."""
TOUCH = 1e-7
"""mm: a tool that is this deep in stock touches it."""
SAME, LEFT = 5e-10, 1e-8
"""mm: places that are one, as sums of offsets round; and ways that nothing leaves but for rounding."""
SHORTEST = 1e-6
"""mm of a move whose pieces are looked at no closer."""
FLAT, BALL, BULL, CONE = 0, 1, 2, 3
CHORD = 0.002
"""How far chords of an arc may be beside it, in cells; and how many there may be."""
CHORDS = 20000
INF = math.inf
TWO_PI = 2.0 * math.pi


@kernel(compile_seconds=0.2)
def lower_side(family: int, radius: float, c: float, k: float, r: float) -> float:
    """Height of the tool's lower side over its tip at distance r from the axis, r at most its radius."""
    if family == 0:
        return 0.0
    if family == 1:
        return radius - math.sqrt(max(radius * radius - r * r, 0.0))
    if family == 2:
        over = r - (radius - c)
        return 0.0 if over <= 0.0 else c - math.sqrt(max(c * c - over * over, 0.0))
    return max(r - c, 0.0) / k


@kernel(compile_seconds=0.2)
def smaller(family: int, radius: float, c: float, k: float, by: float) -> tuple[int, float, float, float]:
    """(family, radius, c, tip up): a tool within the given one wherever it stands up to ``by`` beside it in X-Y."""
    if family == 0:
        return 0, radius - by, 0.0, 0.0
    if family == 1:
        return 1, radius - by, radius - by, by
    if family == 2:
        if c > by:
            return 2, radius - by, c - by, by
        return 0, radius - by, 0.0, c
    if c >= by:
        return 3, radius - by, c - by, 0.0
    return 3, radius - by, 0.0, (by - c) / k


@kernel(compile_seconds=0.2)
def wider(family: int, radius: float, c: float, by: float) -> tuple[float, float, float]:
    """(radius, c, tip down) of a tool of that family that holds the given one wherever that stands ``by`` beside."""
    if family == 0:
        return radius + by, 0.0, 0.0
    if family == 3:
        return radius + by, c + by, 0.0
    return radius + by, c + by, by


@kernel(compile_seconds=0.5)
def envelope(family: int, radius: float, c: float, k: float, s: float, q: float, length: float, slope: float) -> float:
    """Least height of the tool's lower side, over the tip at the move's begin, over a point.

    s, q: the point along and across the move; slope: of the tip, mm up for each mm along; the move covers the point.
    Any place of the tool on its way bounds the least height from above; the one taken is the best.
    """
    q2 = q * q
    a = math.sqrt(max(radius * radius - q2, 0.0))
    w = 0.0
    if slope != 0.0:
        if family == 0:
            w = a
        elif family == 1:
            w = abs(slope) * a / math.sqrt(1.0 + slope * slope)
        elif family == 2:
            w = bull_shift(radius, c, q2, a, abs(slope))
        else:
            steep = abs(slope) * k
            w = a
            if steep < 1.0:
                w = max(steep * abs(q) / math.sqrt(1.0 - steep * steep), math.sqrt(max(c * c - q2, 0.0)))
                w = min(w, a)
        if slope > 0.0:
            w = -w
    at = min(max(s + w, 0.0), length)
    away = s - at
    return slope * at + lower_side(family, radius, c, k, math.sqrt(away * away + q2))


@kernel(compile_seconds=0.3)
def bull_shift(radius: float, c: float, q2: float, a: float, slope: float) -> float:
    """How far behind a point the lowest place of a bull on a slope is: where its side is as steep as the slope."""
    flat = radius - c
    low = math.sqrt(max(flat * flat - q2, 0.0))
    high = a
    for _ in range(44):
        w = 0.5 * (low + high)
        r = math.sqrt(q2 + w * w)
        over = r - flat
        # f'(r) w / r against the slope, without dividing.
        if over * w < slope * r * math.sqrt(max(c * c - over * over, 0.0)):
            low = w
        else:
            high = w
    return low


@kernel(compile_seconds=0.8)
def side_line(
    family: int, radius: float, c: float, k: float, s: float, step_s: float, q: float, step_q: float, length: float,
    slope: float, up: float, out: Any,
) -> None:  # fmt: skip
    """``up`` and the envelope at points in a row: s, q of the first and what they change by; simple loops are fast."""
    if family == 1:
        square = radius * radius
        shift = slope / math.sqrt(1.0 + slope * slope)
        up += radius
        for i in range(len(out)):
            across = q + i * step_q
            along = s + i * step_s
            left = square - across * across
            at = min(max(along - shift * math.sqrt(max(left, 0.0)), 0.0), length)
            away = along - at
            out[i] = up + slope * at - math.sqrt(max(left - away * away, 0.0))
    elif family == 0 and slope == 0.0:
        out[:] = up
    else:
        for i in range(len(out)):
            out[i] = up + envelope(family, radius, c, k, s + i * step_s, q + i * step_q, length, slope)


@kernel(compile_seconds=0.4)
def crossing(
    y: float, ax: float, ay: float, bx: float, by: float, ux: float, uy: float, radius: float
) -> tuple[float, float]:
    """Where a line of constant Y enters and leaves what lies within the radius of a segment; (inf, -inf): nowhere."""
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
    """So far behind the begin of a chord, and further, its begin leaves least: nothing new where it was cut before."""
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
    """What of a line of constant Y is not further than that behind a begin; (inf, -inf): nothing."""
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

    tool: as in ``follow``; chord: (ax, ay, az, bx, by, bz) of the tip; beside, beneath: mm
    that the tool may be off it in X-Y and in Z; again: the same tool has cut up to the begin, as far off; top: of all
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
    # Flutes cut what stands between the tip and their end at all times, in a plunge what they come by.
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


@kernel(compile_seconds=0.6)
def meets(
    box: Any, shape: Any, certain: float, chord: Any, loose: bool, clearance: float, beside: float, beneath: float,
    high: float, sure: float,
) -> tuple[int, float]:  # fmt: skip
    """Whether a body of revolution on a straight line enters what stands in a cell: (CLEAR, MAYBE or SURE, mm).

    box: (4,) low X, low Y, high X, high Y of the cell; shape: (family, R, c, k, up), its lower side ``up`` above the
    tip, for certain only within the radius ``certain``; loose: it may be anywhere in the box of the chord; high: no
    stock stands higher; sure: it is so high. The way is looked at in pieces, bounded by the box of each, halved where
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


@kernel(compile_seconds=0.5)
def arc_sweep(u0: float, v0: float, u1: float, v1: float, turns: int) -> float:
    """Radians, signed, that an arc about the origin turns; a full circle where its ends are one point."""
    sign = 1.0 if turns > 0 else -1.0
    sweep = (math.atan2(v1, u1) - math.atan2(v0, u0)) * sign
    while sweep <= 0.0:
        sweep += TWO_PI
    if u0 == u1 and v0 == v1:
        sweep = TWO_PI
    return sign * (sweep + (abs(turns) - 1) * TWO_PI)


@kernel(compile_seconds=0.2)
def visited(places: Any, tool: int, x: float, y: float, z: float) -> float:
    """Up to which height this tool has stood here at least as deep and nothing is over it; -inf: it has not."""
    free = -INF
    for n in range(len(places)):
        near = abs(places[n, 1] - x) <= SAME and abs(places[n, 2] - y) <= SAME
        if near and places[n, 0] == tool and places[n, 3] <= z + SAME:
            free = max(free, places[n, 4])
    return free


@kernel(compile_seconds=0.4)
def is_retraced(lines: Any, tool: int, chord: Any, up: float, clean: float) -> bool:
    """Whether the tip, so much further up, stays on, or over, lines that feeds of this tool have gone along.

    lines: (n, 8) tool, begin and end of each, 1 where surely nothing was left over it; clean: as that, at least. Where
    the tool has been it has cut, and so has all of it above the tip.
    """
    ax, ay, az = chord[0], chord[1], chord[2]
    dx, dy, dz = chord[3] - ax, chord[4] - ay, chord[5] - az
    done = 0.0
    for _ in range(len(lines)):
        best = done
        for n in range(len(lines)):
            if lines[n, 0] != tool or lines[n, 7] < clean:
                continue
            px, py, pz = lines[n, 1], lines[n, 2], lines[n, 3]
            vx, vy, vz = lines[n, 4] - px, lines[n, 5] - py, lines[n, 6] - pz
            length = math.sqrt(vx * vx + vy * vy)
            vx, vy, vz = vx / length, vy / length, vz / length
            # At t the place is at s0 + t s1 along the line, c0 + t c1 beside it and h0 + t h1 over it.
            s0, s1 = (ax - px) * vx + (ay - py) * vy, dx * vx + dy * vy
            c0, c1 = (ay - py) * vx - (ax - px) * vy, dy * vx - dx * vy
            h0, h1 = az + up - pz - s0 * vz, dz - s1 * vz
            last = 1.0
            if s1 > 0.0:
                last = min((length + SAME - s0) / s1, 1.0)
            elif s1 < 0.0:
                last = min((-SAME - s0) / s1, 1.0)
            here = s0 + done * s1
            if here < -SAME or here > length + SAME or last <= best:
                continue
            beside = max(abs(c0 + done * c1), abs(c0 + last * c1))
            over = min(h0 + done * h1, h0 + last * h1)
            if beside <= LEFT and over >= -LEFT:
                best = last
        if best >= 1.0:
            return True
        if best <= done:
            return False
        done = best
    return False


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


@kernel(compile_seconds=0.2)
def highest(upper: Any) -> float:
    """The highest place of a field, -inf when nothing is left."""
    top = -INF
    for row in range(upper.shape[0]):
        for i in range(upper.shape[1]):
            top = max(top, upper[row, i])
    return top


@kernel(compile_seconds=0.2)
def near(grid: Any, upper: Any, wide: float, chord: Any) -> bool:
    """Whether what is within ``wide`` of a chord may be over the field."""
    ny, nx = upper.shape
    beside_x = min(chord[0], chord[3]) - wide > grid[0] + nx * grid[2] or max(chord[0], chord[3]) + wide < grid[0]
    beside_y = min(chord[1], chord[4]) - wide > grid[1] + ny * grid[3] or max(chord[1], chord[4]) + wide < grid[1]
    return not (beside_x or beside_y)


@kernel(compile_seconds=0.3)
def enter_loose(
    upper: Any, lower: Any, grid: Any, shape: Any, certain: float, chord: Any, loose: bool, clearance: float,
    beside: float, beneath: float, box: Any,
) -> tuple[int, float]:  # fmt: skip
    """``enter``; of a way that may be any, its end is certain: what stands there was entered on whichever way."""
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
    """A traverse on a straight line: told and amount of its row, and what it may have cut."""
    answer, into = enter_loose(upper, lower, grid, tool, tool[10], chord, loose, clearance, beside, beneath, box)
    if answer == CLEAR:
        return
    told[THROUGH], amount[THROUGH] = answer, into
    if loose:
        lower[:, :] = -INF
    else:
        lessen(lower, grid, int(tool[0]), tool[1], tool[2], tool[3], chord, beside, beneath, False, line)


@kernel(seconds_per_unit=5e-6, compile_seconds=10.0)
def follow(
    op: Any, start: Any, end: Any, center: Any, turns: Any, plane: Any, known: Any, tool_of: Any, beside_of: Any,
    bow_of: Any, loose_of: Any, tools: Any, parts: Any, clearance: float, upper: Any, lower: Any, grid: Any,
    memory: Any, places: Any, lines: Any, told: Any, amount: Any,
) -> None:  # fmt: skip
    """Follow rows of the trace through a field, which is updated.

    start, end, center: (n, 3) of the tip in the field's coordinates; known: (n,) bits HEIGHT, PLACE, START, END;
    tool_of: (n,) index in ``tools``; beside_of, bow_of: (n,) mm that the controller may leave the path, and an arc in
    its plane; loose_of: (n,) 1 where a traverse may be anywhere between its ends; tools: (t, 11) family, R, c, k, 0,
    flutes, greatest depth, heights over the tip from which on nothing of the tool is known, up to which it cuts, and
    from which on it is thinner than R, and the radius within which its shape is certain; family -1: shape not known;
    parts: (t, p, 6) what does not cut: (family, R, c, k, up, column of ``told``), R 0 for none; clearance: of
    traverses; memory: (MEMORY,) where the tool is: (known, x, y, lowest z there, tool, index in places), the highest
    stock, rows so far, by how much the way of a feed to there may have been off, -1 for no feed, index in lines, 1
    behind a way straight down, up to which height nothing is over it; places: (m, 5) where it has stood: (tool, x, y,
    z, that height); lines: (m, 8) where feeds went: as in ``is_retraced``; told, amount: (n, KINDS), amounts in mm.
    """
    chord, box, most = np.zeros(6), np.zeros(4), np.zeros(4)
    line = np.zeros((2, upper.shape[1] + 1))
    for row in range(len(op)):
        o = op[row]
        t = tool_of[row]
        if memory[7] == 0.0 or memory[4] != t:
            memory[6] = highest(upper)
        memory[7] += 1.0
        if memory[7] >= LOOKED:
            memory[7] = 0.0
        top = memory[6]
        if memory[4] != t:
            memory[0], memory[4] = 0.0, t
        if o > ARC:
            if o in (PROBE, TOOL_CHANGE, HOME):
                memory[0] = 0.0
            continue
        ax, ay, az = start[row, 0], start[row, 1], start[row, 2]
        bx, by, bz = end[row, 0], end[row, 1], end[row, 2]
        slack = beside_of[row]
        if known[row] & 3 != 3:
            memory[0] = 0.0
            if known[row] & HEIGHT and o != ARC and min(az, bz) - slack - clearance >= top - TOUCH:
                continue
            answer, into = CLEAR, 0.0
            if known[row] & END and o == TRAVERSE and tools[t, 0] >= 0.0:
                # Wherever it comes from: what stands at its end, it enters.
                chord[0], chord[1], chord[2] = bx, by, bz
                chord[3], chord[4], chord[5] = bx, by, bz
                answer, into = enter(upper, lower, grid, tools[t], tools[t, 10], chord, False, 0.0, slack, slack, box)
            if answer == SURE:
                told[row, THROUGH], amount[row, THROUGH] = answer, into
                lower[:, :] = -INF
            elif known[row] & START and o == TRAVERSE:
                told[row, THROUGH] = FROM_START
            else:
                told[row, THROUGH] = NO_PLACE
                lower[:, :] = -INF
            continue
        upright = abs(ax - bx) <= SAME and abs(ay - by) <= SAME and o != ARC
        if upright:
            ax, ay = bx, by
        if memory[0] == 0.0 and az - slack < top:
            # Where the tool is found, it stands: what was there may be gone.
            chord[0] = chord[3] = ax
            chord[1] = chord[4] = ay
            chord[2] = chord[5] = az
            if tools[t, 0] < 0.0:
                lower[:, :] = -INF
            else:
                lessen(
                    lower,
                    grid,
                    int(tools[t, 0]),
                    tools[t, 1],
                    tools[t, 2],
                    tools[t, 3],
                    chord,
                    slack,
                    slack,
                    False,
                    line,
                )
        here = memory[0] != 0.0 and abs(memory[1] - ax) <= SAME and abs(memory[2] - ay) <= SAME
        deep = min(memory[3], az) if here else az
        chord[0], chord[1], chord[2] = ax, ay, az
        chord[3], chord[4], chord[5] = bx, by, bz
        # Straight up, or down to where this tool has been, or along there: nothing new is touched but what a thinner
        # part above the cutter may have left standing over it.
        neck = tools[t, 9]
        free = memory[11] if here else az + neck
        after = max(free, max(az, bz) + neck) if upright else bz + neck
        old = upright and bz >= deep
        under = free
        if upright and not old and bz < az:
            under = visited(places, t, bx, by, bz)
            old = under > -INF
        one_way = upright or loose_of[row] == 0 or (az == bz and (ax == bx or ay == by))
        if not old and o == TRAVERSE and slack <= LEFT and one_way and min(az, bz) < top:
            old = is_retraced(lines, t, chord, 0.0, 0.0)
            under = min(az, bz) + neck
            if old and under < top and is_retraced(lines, t, chord, 0.0, 1.0):
                under = INF
        if old and o == TRAVERSE and under < top:
            old = not is_under(upper, grid, tools[t, 1] + slack, chord, under)
        if old and o == TRAVERSE:
            after = INF
        as_before = here and az >= memory[3] and memory[8] == slack
        if not (upright and here):
            memory[1], memory[2] = bx, by
        memory[0] = 1.0
        memory[3] = min(deep, bz) if upright else bz
        # Where something may be left of the corner between two moves, a plunge counts when it is turned back from.
        turned = upright and here and bz > az and memory[8] > LEFT and memory[10] == 1.0
        memory[10] = 1.0 if upright and bz < az else 0.0
        memory[11] = after
        if (upright and bz < deep and o == FEED and slack <= LEFT) or turned:
            spot = int(memory[5])
            places[spot, 0], places[spot, 1], places[spot, 2] = t, bx, by
            places[spot, 3] = az + memory[8] if turned else bz
            places[spot, 4] = after
            memory[5] = (spot + 1) % len(places)
        if old:
            memory[8] = -1.0 if bz < az or not upright else memory[8]
            continue
        memory[8] = -1.0
        big, sweep, count, off = 0.0, 0.0, 1, 0.0
        u, v, w = 0, 1, 2
        first_r, last_r, angle = 0.0, 0.0, 0.0
        lowest = min(az, bz)
        if o == ARC:
            if plane[row] == 2:
                u, v, w = 2, 0, 1
            elif plane[row] == 3:
                u, v, w = 1, 2, 0
            ru, rv = start[row, u] - center[row, u], start[row, v] - center[row, v]
            su, sv = end[row, u] - center[row, u], end[row, v] - center[row, v]
            first_r, last_r = math.sqrt(ru * ru + rv * rv), math.sqrt(su * su + sv * sv)
            angle = math.atan2(rv, ru)
            sweep = arc_sweep(ru, rv, su, sv, turns[row])
            big = max(first_r, last_r)
            if w != 2:
                lowest = min(lowest, center[row, 2] - big)
        beneath = slack
        if lowest - beneath - clearance >= top - TOUCH:
            continue
        if o == FEED:
            memory[8] = slack
            if not upright and slack <= LEFT:
                spot = int(memory[9])
                lines[spot, 0] = t
                for n in range(6):
                    lines[spot, 1 + n] = chord[n]
                lines[spot, 7] = 0.0
                if lowest + neck >= top or is_retraced(lines, t, chord, neck, 1.0):
                    lines[spot, 7], memory[11] = 1.0, INF
                memory[9] = (spot + 1) % len(lines)
        if o != TRAVERSE and not upright and lowest + neck >= top:
            memory[11] = INF
        family = tools[t, 0]
        if family < 0.0:
            memory[8] = -1.0
            told[row, THROUGH] = NO_SHAPE
            lower[:, :] = -INF
            continue
        if o == ARC:
            fine = CHORD * min(grid[2], grid[3])
            count = min(max(math.ceil(abs(sweep) * math.sqrt(big / (8.0 * fine))), 1), CHORDS)
            part, grow = abs(sweep) / count, abs(last_r - first_r) / count
            off = (big * part * part + 2.0 * grow * part) / 8.0 + bow_of[row]
            if w != 2:
                beneath += off
        chord[0], chord[1], chord[2] = ax, ay, az
        most[0] = most[1] = most[2] = most[3] = -INF
        # On a level arc a cell is cut by one chord after the other, all of them as deep: what stood there before the
        # first of them says how deep.
        level = o == ARC and w == 2 and az == bz
        for piece in range(count):
            chord[3], chord[4], chord[5] = bx, by, bz
            if piece + 1 < count:
                done = (piece + 1) / count
                r = first_r + (last_r - first_r) * done
                chord[3 + u] = center[row, u] + r * math.cos(angle + sweep * done)
                chord[3 + v] = center[row, v] + r * math.sin(angle + sweep * done)
                chord[3 + w] = start[row, w] + (end[row, w] - start[row, w]) * done
            low_z = min(chord[2], chord[5]) - beneath
            if low_z + tools[t, 7] < top - TOUCH and told[row, HOLDER] != SURE:
                told[row, HOLDER], amount[row, HOLDER] = MAYBE, top - low_z - tools[t, 7]
            # One axis alone has one way.
            alone = (ax == bx and ay == by) or (az == bz and (ax == bx or ay == by))
            loose = loose_of[row] == 1 and o == TRAVERSE and not alone
            again = piece > 0 or (o == FEED and as_before)
            if o == TRAVERSE:
                if low_z - clearance < top and near(grid, upper, tools[t, 1] + slack + clearance, chord):
                    through(
                        upper, lower, grid, tools[t], chord, loose, clearance, slack, beneath, box,
                        line, told[row], amount[row],
                    )  # fmt: skip
            elif low_z < top and near(grid, upper, tools[t, 1] + slack + off, chord):
                remove(upper, lower, grid, tools[t], chord, slack + off, beneath, again, level, top, line, most)
            for n in range(parts.shape[1]):
                wide = parts[t, n, 1] + slack + off
                if parts[t, n, 1] <= 0.0 or low_z + parts[t, n, 4] >= top or not near(grid, upper, wide, chord):
                    continue
                answer, into = enter_loose(
                    upper, lower, grid, parts[t, n], parts[t, n, 1], chord, loose, 0.0, slack + off, beneath, box
                )
                kind = int(parts[t, n, 5])
                if answer > told[row, kind] or (answer == told[row, kind] and into > amount[row, kind]):
                    told[row, kind], amount[row, kind] = answer, into
            chord[0], chord[1], chord[2] = chord[3], chord[4], chord[5]
        if level and az - beneath < top:
            chord[0], chord[1], chord[2] = ax, ay, az
            for piece in range(count):
                chord[3], chord[4], chord[5] = bx, by, bz
                if piece + 1 < count:
                    done = (piece + 1) / count
                    r = first_r + (last_r - first_r) * done
                    chord[3] = center[row, 0] + r * math.cos(angle + sweep * done)
                    chord[4] = center[row, 1] + r * math.sin(angle + sweep * done)
                lessen(
                    lower, grid, int(tools[t, 0]), tools[t, 1], tools[t, 2], tools[t, 3], chord, slack + off, beneath,
                    piece > 0, line,
                )  # fmt: skip
                chord[0], chord[1], chord[2] = chord[3], chord[4], chord[5]
        if o == TRAVERSE and told[row, THROUGH] == CLEAR:
            memory[11] = INF
        for kind in range(2):
            if most[2 * kind + 1] > TOUCH:
                told[row, FLUTES + kind], amount[row, FLUTES + kind] = SURE, most[2 * kind + 1]
            elif most[2 * kind] > TOUCH:
                told[row, FLUTES + kind], amount[row, FLUTES + kind] = MAYBE, most[2 * kind]
