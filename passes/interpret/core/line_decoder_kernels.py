"""One line of a table of words, decoded: for every kernel that runs plain lines, whatever the controller.

A table that the caller gives (``slots``) says what a letter is, so that dialects differ by data. What a line may
hold is the caller's to say too: it compares the bits that ``read_line`` has seen with those that it takes.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

from gproof.ir.kernel import kernel

LARGEST = 1e12
"""As in ``line``: numbers up to here cannot overflow in anything that is computed from them."""

# Slots of a line: the six axes, then these. G is a motion, DISTANCE is G90 or G91, DWELL is G4, TIME its P.
I, J, K, R, F, G, DISTANCE, DWELL, TIME = range(6, 15)
SLOTS = 15

# Bits in addition to 1 << slot: a letter or a G code that no slot has, a slot twice, a number above LARGEST.
OTHER, REPEATED, OVER = 1 << 15, 1 << 16, 1 << 17

AXIS_WORDS = (1 << I) - 1
HAS_F, HAS_G, HAS_DISTANCE = 1 << F, 1 << G, 1 << DISTANCE
CENTER_WORDS = 1 << I | 1 << J | 1 << K
DWELL_WORDS = 1 << DWELL | 1 << TIME
MOVE_WORDS = AXIS_WORDS | CENTER_WORDS | 1 << R | HAS_F | HAS_G
"""What a line of G0 to G3 has."""


class WordColumns(NamedTuple):
    """Columns of WORD, lists in plain Python: line i4, letter u1, value f8, flags u1."""

    line: Any
    letter: Any
    value: Any
    flags: Any


class LineState(NamedTuple):
    """What lines change, in place. ints, floats: laid out by each kernel; form, offset_form: (6,) i8, the frame of each
    axis now and under the active offsets; values: (SLOTS,) f8, room for the numbers of one line."""

    ints: Any
    floats: Any
    form: Any
    offset_form: Any
    values: Any


class TraceRows(NamedTuple):
    """Columns of TRACE_ROW, to be written."""

    op: Any
    file: Any
    line: Any
    call: Any
    to: Any
    frame: Any
    state: Any
    feed: Any
    center: Any
    turns: Any
    plane: Any
    arg: Any


def trace_rows(arrays: Mapping[str, Any]) -> TraceRows:
    """The columns of a table of TRACE_ROW."""
    return TraceRows(*(arrays[name] for name in TraceRows._fields))


def letter_slots(axes: Mapping[str, int], others: str = "IJKRFG") -> list[int]:
    """(256,) by letter code its slot, -1 for none. axes: by letter; others: which of I, J, K, R, F, G, P have one."""
    found = [-1] * 256
    slots = {"I": I, "J": J, "K": K, "R": R, "F": F, "G": G, "P": TIME}
    for letter, slot in [*((other, slots[other]) for other in others), *axes.items()]:
        found[ord(letter)] = slot
    return found


@kernel(inline=True)
def read_line(
    line: Any, letter: Any, value: Any, flags: Any, count: int, word: int, slots: Any, motion: int, absolute: int,
    values: Any,
) -> tuple[int, int, int, int, int, int]:  # fmt: skip
    """Decode the line that starts with ``word``.

    line .. flags: ``WordColumns``, ``count`` of them; slots: (256,) by letter; motion: 1 to 4 as G0 to G3, absolute: 1
    for G90, both as they are before the line; values: gets the number of each slot that has one, else keeps its own.
    Returns (first word of the next line, bits of slots seen with OTHER, REPEATED and OVER, motion, absolute, flags that
    any word has, flags that all axis words have).
    """
    here = line[word]
    end = word
    seen = 0
    some = 0
    every = 255
    while end < count and line[end] == here:
        slot = slots[letter[end]]
        number = value[end]
        flag = flags[end]
        some |= flag
        bit = OTHER
        if number > LARGEST or number < -LARGEST:
            seen |= OVER
        if slot == G:
            if number == 1.0:
                motion = 2
                bit = HAS_G
            elif number == 0.0:
                motion = 1
                bit = HAS_G
            elif number == 2.0:
                motion = 3
                bit = HAS_G
            elif number == 3.0:
                motion = 4
                bit = HAS_G
            elif number == 90.0:
                absolute = 1
                bit = HAS_DISTANCE
            elif number == 91.0:
                absolute = 0
                bit = HAS_DISTANCE
            elif number == 4.0:
                bit = 1 << DWELL
        elif slot >= 0:
            bit = 1 << slot
            values[slot] = number
            if slot < 6:
                every &= flag
        if seen & bit:
            seen |= REPEATED
        seen |= bit
        end += 1
    return end, seen, motion, absolute, some, every
