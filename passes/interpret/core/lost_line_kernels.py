"""The hot loop behind a refused line: plain lines whose way rests on what is lost, to rows that go nobody knows where.

What ``refused_lines.vague`` makes of a line: its axes are at places that are not known before and after it, so that a
row is its kind and its feed; all else is the same for all rows and the caller's. A line that holds anything else is
handed back before it has changed anything.
"""

from __future__ import annotations

from typing import Any

from gproof.ir.kernel import kernel
from gproof.ir.program import FLAG_BARE
from gproof.passes.interpret.core.line_kernels import LARGEST

# Layout of the integer state: motion (1 to 4 as G0 to G3, 0: none); whether it is not known; whether arcs and F are
# taken here; columns that are nowhere, and those of the machine, as bits; whether the feed of rows is not known, and
# whether that of an F is not; what a run leaves: lines, and how many of them had an F.
MOTION, PINNED, ARCS, FEEDS, LOST, ALL, OPEN, F_OPEN, LINES, FED = range(10)
# Layout of the float state: mm in a unit, feed in mm/min, number of the last F.
UNIT, FEED, LAST = range(3)


@kernel(seconds_per_unit=6e-7, compile_seconds=0.8)
def run_lost(
    line: Any,
    letter: Any,
    value: Any,
    flags: Any,
    count: Any,
    first_word: Any,
    columns: Any,
    ints: Any,
    floats: Any,
    unknown: Any,
    op: Any,
    line_out: Any,
    feed: Any,
    row: Any,
    capacity: Any,
) -> tuple[int, int]:
    """Execute lines from word ``first_word`` on; returns (next word, next row).

    line, letter, value, flags: WORD columns of ``count`` words; columns: (256,) column of a letter, -1 for none; ints,
    floats: state, changed in place; unknown: NaN; op, line_out, feed: TRACE_ROW columns, from ``row`` to ``capacity``.
    """
    word = first_word
    while word < count and row < capacity:
        here = line[word]
        end = word
        seen = 0
        motion = ints[MOTION]
        plain = True
        given = 0.0
        while end < count and line[end] == here:
            code = letter[end]
            number = value[end]
            if number > LARGEST or number < -LARGEST or flags[end] & FLAG_BARE:
                plain = False
            bit = 0
            if columns[code] >= 0:
                bit = 1 << columns[code]
            elif code == 71:
                bit = 2048
                if number == 0.0:
                    motion = 1
                elif number == 1.0:
                    motion = 2
                elif number == 2.0:
                    motion = 3
                elif number == 3.0:
                    motion = 4
                else:
                    plain = False
            elif code == 70:
                bit = 1024
                given = number
            elif code == 73:
                bit = 64
            elif code == 74:
                bit = 128
            elif code == 75:
                bit = 256
            elif code == 82:
                bit = 512
            else:
                plain = False
            if seen & bit:
                plain = False
            seen |= bit
            end += 1
        axes = seen & 63
        pinned = ints[PINNED] == 1
        if not plain or axes == 0 or (not pinned and (motion < 1 or motion > 4)):
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
            # Behind an F in front axis words may be those of the feed.
            if ints[FEEDS] == 0 or not given > 0.0 or letter[word] == 70:
                return word, row
            rate = unknown if ints[F_OPEN] == 1 else given * floats[UNIT]
            floats[LAST] = given
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
