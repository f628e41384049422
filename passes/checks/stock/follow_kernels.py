"""Rows of the trace through a field of stock: what they take away, and what they enter that they should not.

A tool that goes back where it has been meets nothing: places and lines of feeds are remembered for that.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from gproof.ir.kernel import kernel
from gproof.passes.checks.stock.entry_kernels import (
    CLEAR,
    FLUTES,
    FROM_START,
    HOLDER,
    MAYBE,
    NO_PLACE,
    NO_SHAPE,
    SURE,
    THROUGH,
    TOUCH,
    enter,
    enter_loose,
    is_under,
    near,
    through,
)
from gproof.passes.checks.stock.removal_kernels import INF, lessen, remove

TRAVERSE, FEED, ARC, PROBE, TOOL_CHANGE, HOME = 1, 2, 3, 4, 13, 17
"""Ops of ir/trace.py."""
HEIGHT, PLACE, START, END = 1, 2, 4, 8
"""What is known of a row, bits: Z, X and Y, and that all else rests on where the axes were at the start."""
LOOKED = 4096
"""After so many rows the highest place that is left is looked for again."""
MEMORY = 12
"""Numbers that are kept from chunk to chunk: see ``FieldAhead``."""
SAME, LEFT = 5e-10, 1e-8
"""mm: places that are one, as sums of offsets round; and ways that nothing leaves but for rounding."""
CHORD = 0.002
"""How far chords of an arc may be off it, in cells; and how many there may be."""
CHORDS = 20000
TWO_PI = 2.0 * math.pi


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
    """Up to which height this tool has been here at least as deep and nothing is over it; -inf: it has not."""
    free = -INF
    for n in range(len(places)):
        near = abs(places[n, 1] - x) <= SAME and abs(places[n, 2] - y) <= SAME
        if near and places[n, 0] == tool and places[n, 3] <= z + SAME:
            free = max(free, places[n, 4])
    return free


@kernel(compile_seconds=0.4)
def is_retraced(lines: Any, tool: int, chord: Any, up: float, clean: float) -> bool:
    """Whether the tip, so much further up, stays on, or over, lines that feeds of this tool have gone along.

    lines: (n, 8) tool, start and end of each, 1 where surely nothing was left over it; clean: as that, at least. Where
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
            # At t the place is at s0 + t s1 along the line, c0 + t c1 to its side and h0 + t h1 over it.
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


@kernel(compile_seconds=0.2)
def highest(upper: Any) -> float:
    """The highest place of a field, -inf when nothing is left."""
    top = -INF
    for row in range(upper.shape[0]):
        for i in range(upper.shape[1]):
            top = max(top, upper[row, i])
    return top


class TipRows(NamedTuple):
    """Rows of the trace. op, turns, plane: columns of TRACE_ROW; start, end, center: (n, 3) of the tip in the field's
    coordinates; known: (n,) bits HEIGHT, PLACE, START, END; tool: (n,) index in ``ToolTables``; beside, bow: (n,) mm
    that the controller may leave the path, and an arc in its plane; loose: (n,) 1 where a traverse may be anywhere
    between its ends."""

    op: Any
    start: Any
    end: Any
    center: Any
    turns: Any
    plane: Any
    known: Any
    tool: Any
    beside: Any
    bow: Any
    loose: Any


class ToolTables(NamedTuple):
    """shapes: (t, 11) family, R, c, k, 0, flutes, greatest depth, heights over the tip from which on nothing of the
    tool is known, up to which it cuts, and from which on it is thinner than R, and the radius within which its shape is
    certain; family -1: shape not known. parts: (t, p, 6) what does not cut: (family, R, c, k, up, column of ``told``),
    R 0 for none."""

    shapes: Any
    parts: Any


class FieldAhead(NamedTuple):
    """A field and what is remembered with it, updated. upper, lower, grid: see ``removal_kernels``; memory: (MEMORY,)
    where the tool is: (known, x, y, lowest z there, tool, index in places), the highest stock, rows so far, by how much
    the path of a feed to there may have been off, -1 for no feed, index in lines, 1 after a path straight down, up to
    which height nothing is over it; places: (m, 5) where it has been: (tool, x, y, z, that height); lines: (m, 8)
    where feeds went: as in ``is_retraced``."""

    upper: Any
    lower: Any
    grid: Any
    memory: Any
    places: Any
    lines: Any


@kernel(seconds_per_unit=5e-6, compile_seconds=10.0)
def follow(rows: TipRows, tables: ToolTables, clearance: float, field: FieldAhead, told: Any, amount: Any) -> None:
    """Follow rows of the trace through a field, which is updated.

    clearance: mm, of traverses; ``told``, amount: (n, KINDS), amounts in mm.
    """
    op, start, end, center, turns, plane, known, tool_of, beside_of, bow_of, loose_of = rows
    tools, parts = tables
    upper, lower, grid, memory, places, lines = field
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
                # Wherever it comes from: what is at its end, it enters.
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
            # Where the tool is found, what was there may be gone.
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
        # On a level arc a cell is cut by one chord after the other, all of them as deep: what was there before the
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
