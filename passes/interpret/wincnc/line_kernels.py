"""The hot loop for controllers of one command a line: successive plain lines of G0 to G3 in words, to trace rows.

``run_moves`` executes lines until one holds anything other, or something that needs a message, and hands that line back
before it has changed anything: the Python path (``moves.py``, whose rules these are and which uses the same
functions) then does it, errors included, and calls ``run_moves`` again.
Source: WinCNC Users Guide, G Codes: G0 to G3; Command Reference: Feedrates, Axis Specification.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from gproof.ir.kernel import kernel
from gproof.ir.program import FLAG_BARE
from gproof.passes.interpret.core.line_decoder_kernels import (
    AXIS_WORDS,
    HAS_DISTANCE,
    MOVE_WORDS,
    F,
    I,
    J,
    K,
    LineState,
    R,
    TraceRows,
    WordColumns,
    read_line,
)
from gproof.passes.interpret.core.line_kernels import SAME, ZERO_RADIUS, badly_conditioned, distance, radius_center

# Layout of the integer state; what a run leaves: RESET: a motion mode was set; USED: feeds of moves were taken;
# NOTED: a line with a motion was executed; LINES: how many lines were. KEPT: I and J of the arc
# before: 0 there are none, 1 known, 2 not known (after R, another unit, an arc of open words) until a line has both.
(
    MOTION, ABSOLUTE, CENTER_ABSOLUTE, CENTER_KNOWN, ARCS_MODAL, HELICAL, LINEAR, KEPT, RESET, USED, NOTED, LINES,
    DOUBT, SHARE, MODES,
) = range(15)  # fmt: skip
# Layout of the float state: mm in a unit; by column mm or degrees in a unit, positions, offsets, feeds; feed of the
# last move; I and J of the last arc; radius below which an arc is a line; room for feeds of the line that runs; mm that
# radii may differ; feed of arcs, below 0 before their first F, and what it is then, of lines in X; local zeros
# (G92). DOUBT: the last F was an arc's, and another one than that of lines. MODES: G90 and G91 only choose how words
# count.
UNIT, SCALE, POSITION, OFFSET, FEEDS, FEED, KEPT_I, KEPT_J, SMALLEST, NEXT = 0, 1, 7, 13, 19, 25, 26, 27, 28, 29
TOLERANCE, ARC_FEED, USUAL, LOCAL = 35, 36, 37, 38

ROUNDING = 1e-9
"""mm: next to a rotary axis a shorter move of X, Y or Z is not a move."""


class CellPlaces(NamedTuple):
    """Cells of an array. places: (cells, 2) X and Y at which the next one starts, in mm: after each cell a traverse
    moves there, which has line ``line``, unless the axes are there. zero_line: of the G92 that each cell starts with, 0
    for none; zeros: (6,) what it calls the place of each axis, mm or degrees, NaN for those that it does not name;
    work, ``beside``: (6,) offsets of the workspace, and of tool and head; zero_op: of its row."""

    places: Any
    line: int
    zeros: Any
    work: Any
    beside: Any
    zero_line: int
    zero_op: int


@kernel()
def agreed(feeds: Any, first: int, moving: int, linear: int) -> float:
    """The feed of a move: that of its linear axes, else of all, where they agree; NaN where they do not.

    feeds: by column from ``first`` on; moving, linear: columns as bits.
    """
    chosen = moving & linear
    if chosen == 0:
        chosen = moving
    rate = math.nan
    found = False
    for axis in range(6):
        if chosen & (1 << axis):
            if found and feeds[first + axis] != rate:
                return math.nan
            rate = feeds[first + axis]
            found = True
    return rate


@kernel(seconds_per_unit=2e-6, compile_seconds=4.0)
def run_moves(
    words: WordColumns, count: int, first_word: int, slots: Any, named: Any, lines: LineState, rows: TraceRows,
    row: int, capacity: int,
) -> tuple[int, int]:  # fmt: skip
    """Execute lines from word ``first_word`` on; returns (next word, next row).

    words: ``count`` of them are run; slots: see ``read_line``; named: (64,) by the columns that a line names (bits):
    those that its F gives a feed to (bits); lines: state, changed in place; rows: op, line, to, feed, center, turns and
    plane are written from ``row`` while below ``capacity``, the others are the caller's.
    """
    line, letter, value, flags = words
    ints, floats, form, offset_form, values = lines
    op, line_out, to, feed = rows.op, rows.line, rows.to, rows.feed
    center, turns, plane = rows.center, rows.turns, rows.plane
    word = first_word
    unit = floats[UNIT]
    taken = MOVE_WORDS | HAS_DISTANCE if ints[MODES] == 1 else MOVE_WORDS
    while word < count and row < capacity:
        here = line[word]
        end, seen, motion, mode, _, every = read_line(
            line, letter, value, flags, count, word, slots, ints[MOTION], ints[ABSOLUTE], values
        )
        # K of 0 says nothing next to I and J.
        if seen & ~taken or (seen & 256 and values[K] != 0.0):
            return word, row
        absolute = mode == 1
        all_bare = every & FLAG_BARE != 0
        vf = values[F]
        axes = seen & AXIS_WORDS
        command = seen & 2048
        has_feed = seen & 1024
        if has_feed and not vf > 0.0:
            return word, row
        if seen == 4096:
            ints[ABSOLUTE] = 1 if absolute else 0
            ints[LINES] += 1
            word = end
            continue
        if command == 0 and seen & ~4096 == 1024:
            for axis in range(6):
                if named[0] & (1 << axis):
                    floats[FEEDS + axis] = vf * floats[SCALE + axis]
            if named[0] & 3:
                ints[DOUBT] = 0
            ints[ABSOLUTE] = 1 if absolute else 0
            ints[LINES] += 1
            word = end
            continue
        if command == 0 and has_feed and ((all_bare and letter[word] == 70) or seen & 4096):
            # A feed for the axes that it names, or a move of them to 0.
            return word, row
        if motion < 1 or motion > 4:
            return word, row
        if motion <= 2 and seen & 960:
            return word, row
        moving = axes if motion <= 2 else axes | 3
        feeds = FEEDS
        doubt = ints[DOUBT]
        shares = ints[SHARE] == 1
        if has_feed and (motion <= 2 or shares):
            if named[moving] & 3:
                doubt = 0
            feeds = NEXT
            for axis in range(6):
                given = named[moving] & (1 << axis)
                floats[NEXT + axis] = vf * floats[SCALE + axis] if given else floats[FEEDS + axis]
        if motion <= 2 and axes == 0:
            if has_feed:
                for axis in range(6):
                    floats[FEEDS + axis] = floats[NEXT + axis]
            ints[DOUBT] = doubt
            ints[ABSOLUTE] = 1 if absolute else 0
            ints[MOTION] = motion
            ints[RESET] = 1
            ints[NOTED] = 1
            ints[LINES] += 1
            word = end
            continue
        rate = floats[FEED]
        arc_feed = floats[ARC_FEED]
        if motion == 2:
            rate = agreed(floats, feeds, axes, ints[LINEAR])
            if rate == 0.0:
                return word, row
            if doubt == 1 and axes & 3:
                rate = math.nan
        elif motion >= 3 and shares:
            rate = agreed(floats, feeds, 3, 3)
            if rate == 0.0:
                return word, row
        elif motion >= 3:
            if has_feed:
                rate = vf * unit
                arc_feed = rate
                doubt = 0 if ints[SHARE] == 0 or (floats[FEEDS] == rate and floats[FEEDS + 1] == rate) else 1
                if ints[SHARE] < 0:
                    # Of axes besides X and Y that the arc moves, or that share their feed: that F or the one of lines.
                    feeds = NEXT
                    for axis in range(6):
                        held = floats[FEEDS + axis]
                        other = axis > 1 and named[moving] & (1 << axis) and held != vf * floats[SCALE + axis]
                        floats[NEXT + axis] = math.nan if other else held
            else:
                rate = floats[USUAL] if arc_feed < 0.0 else arc_feed
                last_of_both = arc_feed >= 0.0 and doubt == 1
                if ints[SHARE] != 0 and not (last_of_both or (floats[FEEDS] == rate and floats[FEEDS + 1] == rate)):
                    rate = math.nan
        if absolute:
            # An axis that now gets another frame needs a new frame index: Python path.
            changes = False
            for axis in range(6):
                if axes & (1 << axis) and form[axis] != offset_form[axis]:
                    changes = True
            if changes:
                return word, row
        p0 = floats[POSITION]
        p1 = floats[POSITION + 1]
        p2 = floats[POSITION + 2]
        p3 = floats[POSITION + 3]
        p4 = floats[POSITION + 4]
        p5 = floats[POSITION + 5]
        t0, t1, t2, t3, t4, t5 = p0, p1, p2, p3, p4, p5
        if axes & 1:
            t0 = values[0] * floats[SCALE] + (floats[OFFSET] if absolute else p0)
        if axes & 2:
            t1 = values[1] * floats[SCALE + 1] + (floats[OFFSET + 1] if absolute else p1)
        if axes & 4:
            t2 = values[2] * floats[SCALE + 2] + (floats[OFFSET + 2] if absolute else p2)
        if axes & 8:
            t3 = values[3] * floats[SCALE + 3] + (floats[OFFSET + 3] if absolute else p3)
        if axes & 16:
            t4 = values[4] * floats[SCALE + 4] + (floats[OFFSET + 4] if absolute else p4)
        if axes & 32:
            t5 = values[5] * floats[SCALE + 5] + (floats[OFFSET + 5] if absolute else p5)
        c0 = c1 = c2 = 0.0
        turn = 0
        flat = 0
        kind = 1 if motion == 1 else 2
        kept = ints[KEPT]
        i = floats[KEPT_I]
        j = floats[KEPT_J]
        if motion >= 3:
            if ints[CENTER_KNOWN] == 0 or (ints[HELICAL] == 0 and axes & 60 == 4):
                return word, row
            if seen & 512:
                if seen & 448 or not values[R] > 0.0:
                    return word, row
                c0, c1, bad = radius_center(p0, p1, t0, t1, values[R] * unit, 1 if motion == 4 else 0)
                # Nearly half circles get a warning: Python path, as errors do.
                if bad != 0 or badly_conditioned(p0, p1, p2, t0, t1, t2, 1, values[R] * unit) == 1:
                    return word, row
                kept = 2
            else:
                if seen & 192 == 192:
                    kept = 1
                    i = values[I] * unit
                    j = values[J] * unit
                elif seen & 448 or kept != 1:
                    return word, row
                if ints[CENTER_ABSOLUTE] == 0:
                    c0 = p0 + i
                    c1 = p1 + j
                elif form[0] != offset_form[0] or form[1] != offset_form[1]:
                    return word, row
                else:
                    c0 = floats[OFFSET] + i
                    c1 = floats[OFFSET + 1] + j
            radius = distance(c0 - p0, c1 - p1)
            if radius < ZERO_RADIUS:
                return word, row
            if abs(distance(c0 - t0, c1 - t1) - radius) > floats[TOLERANCE] + SAME:
                return word, row
            if abs(p0 - t0) < SAME and abs(p1 - t1) < SAME:
                if axes & 3:
                    # A full circle that the words do not quite say: a warning.
                    return word, row
                t0, t1 = p0, p1
            if radius < floats[SMALLEST]:
                # A note says what the controller makes of it.
                return word, row
            kind = 3
            flat = 1
            c2 = p2
            turn = 1 if motion == 4 else -1
        if t3 != p3 or t4 != p4 or t5 != p5:
            if abs(t0 - p0) < ROUNDING:
                t0 = p0
            if abs(t1 - p1) < ROUNDING:
                t1 = p1
            if abs(t2 - p2) < ROUNDING:
                t2 = p2
        if motion <= 2 or ints[ARCS_MODAL]:
            ints[MOTION] = motion
            ints[RESET] = 1
        if feeds == NEXT:
            for axis in range(6):
                floats[FEEDS + axis] = floats[NEXT + axis]
        ints[DOUBT] = doubt
        ints[ABSOLUTE] = 1 if absolute else 0
        floats[ARC_FEED] = arc_feed
        if motion != 1:
            floats[FEED] = rate
            ints[USED] = 1
        ints[KEPT] = kept
        floats[KEPT_I] = i
        floats[KEPT_J] = j
        ints[NOTED] = 1
        ints[LINES] += 1
        floats[POSITION] = t0
        floats[POSITION + 1] = t1
        floats[POSITION + 2] = t2
        floats[POSITION + 3] = t3
        floats[POSITION + 4] = t4
        floats[POSITION + 5] = t5
        op[row] = kind
        line_out[row] = here
        to[row, 0] = t0
        to[row, 1] = t1
        to[row, 2] = t2
        to[row, 3] = t3
        to[row, 4] = t4
        to[row, 5] = t5
        feed[row] = rate if motion != 1 else 0.0
        center[row, 0] = c0
        center[row, 1] = c1
        center[row, 2] = c2
        turns[row] = turn
        plane[row] = flat
        row += 1
        word = end
    return word, row


@kernel(seconds_per_unit=6e-6, compile_seconds=4.5)
def run_cells(
    words: WordColumns, count: int, slots: Any, named: Any, lines: LineState, kept: LineState, rows: TraceRows,
    row: int, capacity: int, cells: CellPlaces,
) -> tuple[int, int]:  # fmt: skip
    """Cells of an array, each of them all ``count`` words; returns (cells, next row).

    kept: room for a copy of the state. A cell that ``run_moves`` does not run to its end, and that for which there is
    no room, is not started. The rest: ``run_moves``.
    """
    ints, floats = lines.ints, lines.floats
    kept_ints, kept_floats = kept.ints, kept.floats
    op, line_out, to, feed = rows.op, rows.line, rows.to, rows.feed
    center, turns, plane = rows.center, rows.turns, rows.plane
    places, array_line, zeros, work, beside, zero_line, zero_op = cells
    done = 0
    while done < len(places):
        for n in range(len(ints)):
            kept_ints[n] = ints[n]
        for n in range(len(floats)):
            kept_floats[n] = floats[n]
        begin = row
        if zero_line > 0 and row < capacity:
            for axis in range(6):
                if zeros[axis] == zeros[axis]:
                    local = floats[POSITION + axis] - (work[axis] + beside[axis]) - zeros[axis]
                    floats[LOCAL + axis] = local
                    floats[OFFSET + axis] = work[axis] + local + beside[axis]
            op[row] = zero_op
            line_out[row] = zero_line
            for axis in range(6):
                to[row, axis] = floats[POSITION + axis]
            feed[row] = 0.0
            center[row, 0] = 0.0
            center[row, 1] = 0.0
            center[row, 2] = 0.0
            turns[row] = 0
            plane[row] = 0
            ints[LINES] += 1
            begin = row + 1
        word, last = run_moves(words, count, 0, slots, named, lines, rows, begin, capacity)
        if word < count or last >= capacity:
            for n in range(len(ints)):
                ints[n] = kept_ints[n]
            for n in range(len(floats)):
                floats[n] = kept_floats[n]
            break
        x, y = places[done, 0], places[done, 1]
        if x != floats[POSITION] or y != floats[POSITION + 1]:
            floats[POSITION] = x
            floats[POSITION + 1] = y
            op[last] = 1
            line_out[last] = array_line
            for axis in range(6):
                to[last, axis] = floats[POSITION + axis]
            feed[last] = 0.0
            center[last, 0] = 0.0
            center[last, 1] = 0.0
            center[last, 2] = 0.0
            turns[last] = 0
            plane[last] = 0
            last += 1
        row = last
        done += 1
    return done, row
