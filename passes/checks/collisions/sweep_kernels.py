"""Many moves past many facets: the cells that facets lie over, arcs as segments, and the stretches that come too near.

``sweep`` asks ``separation`` only of facets that its short cuts do not prove to be further away.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from gproof.ir.kernel import kernel
from gproof.passes.checks.collisions.distance_kernels import ROUNDING, separation

GAP_ROWS = 64
"""Moves without contact that end a stretch."""


@kernel(seconds_per_unit=5e-5, compile_seconds=1.0)
def raster(
    corners: Any, disc: Any, x0: float, y0: float, cell: float, nx: int, ny: int, first: Any, items: Any, top: Any,
    fill: int,
) -> int:  # fmt: skip
    """Facets by the cells of a grid that they lie over.

    first: (nx * ny + 1,) with fill = 0 their number a cell, shifted by one; with fill = 1 where each cell's are in
    ``items`` (moved on by one cell each while they are filled in); top: (nx * ny,) the greatest height in a cell.
    Returns the number of items.
    """
    total = 0
    grain = 1e-6
    for f in range(len(corners)):
        xl = xh = corners[f, 0]
        yl = yh = corners[f, 1]
        zh = corners[f, 2]
        for k in range(1, 4):
            xl, xh = min(xl, corners[f, 3 * k]), max(xh, corners[f, 3 * k])
            yl, yh = min(yl, corners[f, 3 * k + 1]), max(yh, corners[f, 3 * k + 1])
            zh = max(zh, corners[f, 3 * k + 2])
        around = disc[f] + grain
        i0 = max(0, math.floor((xl - around - x0) / cell))
        i1 = min(nx - 1, math.floor((xh + around - x0) / cell))
        j0 = max(0, math.floor((yl - around - y0) / cell))
        j1 = min(ny - 1, math.floor((yh + around - y0) / cell))
        for j in range(j0, j1 + 1):
            for i in range(i0, i1 + 1):
                mx, my, half = x0 + (i + 0.5) * cell, y0 + (j + 0.5) * cell, 0.5 * cell + around
                meets = True
                if i1 > i0 and j1 > j0:
                    # A line along one of its edges may have the facet on one side and the cell on the other.
                    for k in range(4):
                        q = (k + 1) % 4
                        ex = corners[f, 3 * q] - corners[f, 3 * k]
                        ey = corners[f, 3 * q + 1] - corners[f, 3 * k + 1]
                        size = abs(ex) + abs(ey)
                        if size == 0.0:
                            continue
                        low = high = 0.0
                        for m in range(4):
                            side = ex * (corners[f, 3 * m + 1] - corners[f, 3 * k + 1]) - ey * (
                                corners[f, 3 * m] - corners[f, 3 * k]
                            )
                            low, high = min(low, side), max(high, side)
                        center = ex * (my - corners[f, 3 * k + 1]) - ey * (mx - corners[f, 3 * k])
                        if center - half * size > high or center + half * size < low:
                            meets = False
                            break
                if meets:
                    at = j * nx + i
                    if fill == 1:
                        items[first[at]] = f
                        first[at] += 1
                    else:
                        first[at + 1] += 1
                        top[at] = max(top[at], zh)
                    total += 1
    return total


class Segments(NamedTuple):
    """Moves. start, end: (n, 3) of the tip; slack: (n,) mm that the tip may be off the segment, sag: (n,) how much
    of it is the segment's own error; place: (n, 3) source (file and line as one number), row, and 1 where the path may
    be any within the box of start and end."""

    start: Any
    end: Any
    slack: Any
    sag: Any
    place: Any


class Facets(NamedTuple):
    """corners .. box: of facets; grid .. top: of cells, see ``Surface``; stamp: (facets,) when each was last met."""

    corners: Any
    disc: Any
    planes: Any
    beside: Any
    body: Any
    box: Any
    grid: Any
    size: Any
    first: Any
    items: Any
    top: Any
    stamp: Any


class Rungs(NamedTuple):
    """What must stay clear: see ``Ladder``."""

    rims: Any
    counts: Any
    rounds: Any
    levels: Any
    part: Any
    sure: int


class Stretches(NamedTuple):
    """What was found. now: (3,) stamps, moves, stretches so far; seen, opened: (keys,) by body, part, whether it is
    certain: last move, last stretch; whole: (room, 12), real: (room, 14): see ``Stretch``."""

    now: Any
    seen: Any
    opened: Any
    whole: Any
    real: Any


@kernel()
def _told(
    key: int, facet: int, piece: int, any_way: int, tip: Any, way: Any, slack: float, source: int, row: int, now: Any,
    seen: Any, opened: Any, whole: Any, real: Any,
) -> int:  # fmt: skip
    """Count this move to the stretch of a key, and open one where none goes on; its number, -1 without room for it.

    key: of body, part and whether it is certain; source, row: of the move; now .. real: see ``Stretches``.
    """
    if opened[key] == -2 or seen[key] < now[1] - GAP_ROWS:
        opened[key] = -1
        if now[2] < len(whole):
            new = now[2]
            opened[key] = new
            whole[new, 0], whole[new, 1], whole[new, 2] = key, source, row
            whole[new, 3], whole[new, 4], whole[new, 11] = facet, piece, any_way
            whole[new, 7], whole[new, 9] = -1, -1
            for axis in range(3):
                real[new, axis], real[new, 3 + axis] = tip[axis], way[axis]
            real[new, 6] = slack
        now[2] += 1
    seen[key] = now[1]
    stretch = opened[key]
    if stretch >= 0 and whole[stretch, 6] != row + 1:
        whole[stretch, 6] = row + 1
        whole[stretch, 10] += 1
    return int(stretch)


@kernel(seconds_per_unit=2e-4, compile_seconds=12.0)
def sweep(
    moves: Segments, facets: Facets, ladder: Rungs, gap: float, found: Stretches, scratch: Any
) -> int:  # fmt: skip
    """Moves that come nearer to facets than allowed, gathered by body, part of the tool and stretch of moves.

    gap: see ``separation``; scratch: (60,). Returns how many stretches there are, which may be more than there is room
    for.
    """
    start, end, slack, sag, place = moves
    corners, disc, planes, beside, body, box, grid, size, first, items, top, stamp = facets
    rims, counts, rounds, levels, part, sure = ladder
    now, seen, opened, whole, real = found
    points, weights, spare = scratch[0:36].reshape((4, 9)), scratch[36:40], scratch[40:44]
    witness, p, d = scratch[44:51], scratch[51:54], scratch[54:57]
    x0, y0, cell, summit, widest = grid[0], grid[1], grid[2], grid[3], grid[4]
    nx, ny = size[0], size[1]
    half = 0.7072 * cell
    for move in range(len(start)):
        for axis in range(3):
            p[axis] = start[move, axis]
            d[axis] = end[move, axis] - start[move, axis]
        now[1] += 1
        any_way = place[move, 2]
        lowest = min(p[2], p[2] + d[2])
        flat = d[0] * d[0] + d[1] * d[1]
        for j in range(len(levels)):
            if levels[j] == 0:
                continue
            n = counts[j, 0]
            most = rounds[j, 0] + slack[move] + widest + 1e-6
            bottom = rims[j, 0, 0, 1]
            if lowest + bottom - most > summit:
                continue
            if part[j] == 3:
                # Wider than everything: what is higher than its lower end may be met.
                highest = size[2]
                key = (body[highest] * 4 + 3) * 2
                _told(
                    key,
                    highest,
                    j,
                    0,
                    p,
                    d,
                    slack[move],
                    place[move, 0],
                    place[move, 1],
                    now,
                    seen,
                    opened,
                    whole,
                    real,
                )
                continue
            inner, broad = rims[j, 0, 0, 0], 0.0
            for k in range(n):
                broad = max(broad, rims[j, 0, k, 0])
            slope = 0.0
            if rims[j, 0, 1, 0] > inner:
                slope = (rims[j, 0, 1, 1] - bottom) / (rims[j, 0, 1, 0] - inner)
            lean = most * math.sqrt(1.0 + slope * slope)
            reach = broad + most
            now[0] += 1
            xl, xh = min(p[0], p[0] + d[0]) - reach, max(p[0], p[0] + d[0]) + reach
            yl, yh = min(p[1], p[1] + d[1]) - reach, max(p[1], p[1] + d[1]) + reach
            i0, i1 = max(0, math.floor((xl - x0) / cell)), min(nx - 1, math.floor((xh - x0) / cell))
            j0, j1 = max(0, math.floor((yl - y0) / cell)), min(ny - 1, math.floor((yh - y0) / cell))
            for v in range(j0, j1 + 1):
                for u in range(i0, i1 + 1):
                    at = v * nx + u
                    if first[at] == first[at + 1] or top[at] < lowest + bottom - most:
                        continue
                    # How near the cell comes to the axis, and how low the tool may be there.
                    mx, my = x0 + (u + 0.5) * cell - p[0], y0 + (v + 0.5) * cell - p[1]
                    if any_way == 1:
                        mx = max(0.0, abs(mx - 0.5 * d[0]) - 0.5 * abs(d[0]))
                        my = max(0.0, abs(my - 0.5 * d[1]) - 0.5 * abs(d[1]))
                    elif flat > 0.0:
                        t = min(1.0, max(0.0, (mx * d[0] + my * d[1]) / flat))
                        mx, my = mx - t * d[0], my - t * d[1]
                    rho = math.sqrt(mx * mx + my * my) - half
                    if rho > reach:
                        continue
                    if rho > inner:
                        low = bottom - most
                        if slope > 0.0:
                            low = max(low, bottom + (rho - inner) * slope - lean)
                        elif rho - inner < most:
                            low = bottom - math.sqrt(most * most - (rho - inner) * (rho - inner))
                        if top[at] < lowest + low:
                            continue
                    for item in range(first[at], first[at + 1]):
                        f = items[item]
                        if stamp[f] == now[0]:
                            continue
                        stamp[f] = now[0]
                        if (
                            box[f, 0] > xh or box[f, 1] < xl or box[f, 2] > yh or box[f, 3] < yl
                            or box[f, 4] < lowest + bottom - most
                        ):  # fmt: skip
                            continue
                        r = rounds[j, 0] + slack[move] + beside[f]
                        # Wholly on one side of the facet's plane?
                        a, b, c, e = planes[f, 0], planes[f, 1], planes[f, 2], planes[f, 3]
                        if disc[f] == 0.0:
                            tilt = planes[f, 4]
                            above = below = 0.0
                            for k in range(n):
                                radial, axial = rims[j, 0, k, 0] * tilt, rims[j, 0, k, 1] * c
                                if k == 0:
                                    above, below = axial - radial, axial + radial
                                else:
                                    above, below = min(above, axial - radial), max(below, axial + radial)
                            h = a * p[0] + b * p[1] + c * p[2] - e
                            ha, hb, hc = a * d[0], b * d[1], c * d[2]
                            if any_way == 1:
                                h0 = h + min(0.0, ha) + min(0.0, hb) + min(0.0, hc)
                                h1 = h + max(0.0, ha) + max(0.0, hb) + max(0.0, hc)
                            else:
                                h0, h1 = min(h, h + ha + hb + hc), max(h, h + ha + hb + hc)
                            if h0 + above > r + ROUNDING or h1 + below < -r - ROUNDING:
                                continue
                        base = (body[f] * 4 + part[j]) * 2
                        key = base + 1
                        level = 0
                        if seen[key] == now[1]:
                            # The move is reported; only a deeper place is news.
                            level = whole[opened[key], 9] + 1 if opened[key] >= 0 else levels[j]
                            if level >= levels[j]:
                                continue
                            met = separation(
                                corners, f, disc[f], p, d, rims[j, level], counts[j, level], rounds[j, level], gap, 0,
                                points, weights, spare, witness,
                            )  # fmt: skip
                            if met != 1:
                                continue
                        else:
                            met = separation(
                                corners,
                                f,
                                disc[f],
                                p,
                                d,
                                rims[j, 0],
                                n,
                                r,
                                gap,
                                any_way,
                                points,
                                weights,
                                spare,
                                witness,
                            )
                            if met == -1:
                                continue
                            level = 0 if sag[move] == 0.0 else sure
                            if met == 1 and (any_way == 1 or r > rounds[j, 0]):
                                met = -1
                                if any_way == 0 and level < levels[j]:
                                    met = separation(
                                        corners, f, disc[f], p, d, rims[j, level], counts[j, level], rounds[j, level],
                                        gap, 0, points, weights, spare, witness,
                                    )  # fmt: skip
                            if met != 1:
                                key, level = base, 0
                            if seen[key] == now[1]:
                                continue
                            s = _told(
                                key, f, j, any_way, p, d, slack[move], place[move, 0], place[move, 1], now, seen,
                                opened, whole, real,
                            )  # fmt: skip
                            if s >= 0 and whole[s, 9] >= level:
                                # A stretch that goes on: only a deeper place is news.
                                level = whole[s, 9] + 1
                                if key == base or level >= levels[j]:
                                    continue
                                met = separation(
                                    corners, f, disc[f], p, d, rims[j, level], counts[j, level], rounds[j, level], gap,
                                    0, points, weights, spare, witness,
                                )  # fmt: skip
                                if met != 1:
                                    continue
                        s = opened[key]
                        if s < 0:
                            continue
                        # The deepest level that is met: in steps that double, then halve.
                        step, rising = 1, True
                        while key > base and step > 0:
                            met = -1
                            if level + step < levels[j]:
                                met = separation(
                                    corners, f, disc[f], p, d, rims[j, level + step], counts[j, level + step],
                                    rounds[j, level + step], gap, 0, points, weights, spare, witness,
                                )  # fmt: skip
                            if met == 1:
                                level += step
                            else:
                                rising = False
                            step = 2 * step if rising else step // 2
                        whole[s, 9] = level
                        whole[s, 5], whole[s, 7], whole[s, 8] = place[move, 0], f, j
                        for axis in range(3):
                            real[s, 7 + axis], real[s, 10 + axis] = p[axis], d[axis]
                        real[s, 13] = slack[move]
    return int(now[2])


@kernel(seconds_per_unit=4e-6, compile_seconds=1.5)
def chords(
    op: Any, start: Any, end: Any, center: Any, turns: Any, plane: Any, most: float, begin: int, places: Any,
    points: Any, sag: Any, rows: Any,
) -> int:  # fmt: skip
    """Moves as straight segments: lines as they are, arcs in chords that lie within ``most`` mm of them.

    op, turns, plane: of Trace rows; start, end, center: (n, 3). ``begin``: first row to take; places: (1,) the first
    row that is left because there was no more room, (n,) when all are done. points: (room, 6) start and end of each,
    sag: (room,) mm that the path may be off it, rows: (room,) whose it is. Returns how many there are.
    The third axis, which runs with the angle, and a radius that changes are in ``sag``: docs/verification.md.
    """
    made = 0
    for row in range(begin, len(op)):
        places[0] = row
        if op[row] != 3:
            if made >= len(rows):
                return made
            for axis in range(3):
                points[made, axis], points[made, 3 + axis] = start[row, axis], end[row, axis]
            sag[made], rows[made] = 0.0, row
            made += 1
            continue
        w = plane[row]
        u = 0 if w == 1 else (2 if w == 2 else 1)
        v = 1 if w == 1 else (0 if w == 2 else 2)
        h = 3 - u - v
        cu, cv = center[row, u], center[row, v]
        u0, v0, u1, v1 = start[row, u] - cu, start[row, v] - cv, end[row, u] - cu, end[row, v] - cv
        r0, r1 = math.sqrt(u0 * u0 + v0 * v0), math.sqrt(u1 * u1 + v1 * v1)
        angle = math.atan2(v0, u0)
        sign = 1.0 if turns[row] > 0 else -1.0
        arc = (math.atan2(v1, u1) - angle) * sign
        if arc <= 0.0:
            arc += 2.0 * math.pi
        if arc <= 0.0 or (u0 == u1 and v0 == v1):
            arc = 2.0 * math.pi
        arc += (abs(turns[row]) - 1) * (2.0 * math.pi)
        r = max(r0, r1)
        rise = end[row, h] - start[row, h]
        step = math.sqrt(max(8.0 * most / max(r, most), 1e-12))
        pieces = max(1, math.ceil(arc / min(step, 0.5)))
        while True:
            delta = arc / pieces
            bow = r * delta * delta / 8.0
            beside = abs(rise) / pieces * delta * delta / 100.0
            off = math.sqrt(bow * bow + beside * beside) + abs(r1 - r0) / pieces * delta
            if off <= 2.0 * most or pieces > 10_000_000:
                break
            pieces *= 2
        if made + pieces > len(rows):
            if made == 0 and pieces > len(rows):
                places[0] = -pieces
            return made
        fu, fv = start[row, u], start[row, v]
        for k in range(1, pieces + 1):
            share = k / pieces
            turn = angle + sign * arc * share
            radius = r0 + (r1 - r0) * share
            tu, tv = cu + radius * math.cos(turn), cv + radius * math.sin(turn)
            if k == pieces:
                tu, tv = end[row, u], end[row, v]
            points[made, u], points[made, v] = fu, fv
            points[made, h] = start[row, h] + rise * ((k - 1) / pieces)
            points[made, 3 + u], points[made, 3 + v] = tu, tv
            points[made, 3 + h] = start[row, h] + rise * share
            fu, fv = tu, tv
            sag[made], rows[made] = off + 1e-9, row
            made += 1
    places[0] = len(op)
    return made
