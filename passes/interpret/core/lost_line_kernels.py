"""The hot loop after a refused line: plain lines whose path rests on what is lost, to rows whose ends are not known.

What ``refused_lines.vague`` makes of a line: its axes are at places that are not known before and after it, so that a
row is its kind and its feed; all else is the same for all rows and the caller's. A line that holds anything else is
handed back before it has changed anything.
"""

from __future__ import annotations

from typing import Any

from gproof.ir.kernel import kernel
from gproof.ir.program import FLAG_BARE
from gproof.passes.interpret.core.line_decoder_kernels import (
    AXIS_WORDS,
    MOVE_WORDS,
    F,
    TraceRows,
    WordColumns,
    read_line,
)

# Layout of the integer state: motion (1 to 4 as G0 to G3, 0: none); whether it is not known; whether arcs and F are
# taken here; columns that are nowhere, and those of the machine, as bits; whether the feed of rows is not known, and
# whether that of an F is not; what a run leaves: lines, and how many of them had an F.
MOTION, PINNED, ARCS, FEEDS, LOST, ALL, OPEN, F_OPEN, LINES, FED = range(10)
# Layout of the float state: mm in a unit, feed in mm/min, number of the last F.
UNIT, FEED, LAST = range(3)


@kernel(seconds_per_unit=6e-7, compile_seconds=0.8)
def run_lost(
    words: WordColumns, count: int, first_word: int, slots: Any, ints: Any, floats: Any, values: Any, unknown: float,
    rows: TraceRows, row: int, capacity: int,
) -> tuple[int, int]:  # fmt: skip
    """Execute lines from word ``first_word`` on; returns (next word, next row).

    words: ``count`` of them are run; slots, values: see ``read_line``; ints, floats: state, changed in place; unknown:
    NaN; rows: op, line and feed are written from ``row`` while below ``capacity``.
    """
    line, letter, value, flags = words
    op, line_out, feed = rows.op, rows.line, rows.feed
    word = first_word
    while word < count and row < capacity:
        here = line[word]
        end, seen, motion, _, some, _ = read_line(
            line, letter, value, flags, count, word, slots, ints[MOTION], 0, values
        )
        axes = seen & AXIS_WORDS
        pinned = ints[PINNED] == 1
        if seen & ~MOVE_WORDS or some & FLAG_BARE or axes == 0 or (not pinned and (motion < 1 or motion > 4)):
            return word, row
        if pinned:
            if seen & 2048 or ints[LOST] & ints[ALL] != ints[ALL]:
                return word, row
        elif motion >= 3:
            if ints[ARCS] == 0 or ints[LOST] & ints[ALL] != ints[ALL]:
                return word, row
        elif seen & 960 or axes & ~ints[LOST]:
            return word, row
        rate = floats[FEED]
        if seen & 1024:
            # After an F in front axis words may be those of the feed.
            if ints[FEEDS] == 0 or not values[F] > 0.0 or letter[word] == 70:
                return word, row
            rate = unknown if ints[F_OPEN] == 1 else values[F] * floats[UNIT]
            floats[LAST] = values[F]
            ints[FED] += 1
        floats[FEED] = rate
        if not pinned:
            ints[MOTION] = motion
        ints[LINES] += 1
        fast = not pinned and motion == 1
        op[row] = 1 if fast else 2
        line_out[row] = here
        feed[row] = 0.0 if fast else unknown if ints[OPEN] == 1 else rate
        row += 1
        word = end
    return word, row
