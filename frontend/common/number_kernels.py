"""Which lines of a file are plain, at the speed of the disk: the steps of a dialect's automaton over its bytes.

Takes ``bytes`` (or a memory map) and Python lists in plain Python, and uint8 / uint16 arrays when compiled;
``frontend/common/lines.py`` makes the tables and chooses.
"""

from __future__ import annotations

from typing import Any

from gproof.ir.kernel import kernel

STOP = 0xFFFF
"""Entry of the pair table for two bytes of which one ends a line."""

HAS_WORDS = 1
NOT_PLAIN = 2
HAS_RETURN = 4
"""Bits of a verdict: what a line is when it ends in a state."""


@kernel(seconds_per_unit=1e-7, compile_seconds=0.7)
def index_lines(
    data: Any,
    begin: int,
    end: int,
    line: int,
    words: int,
    limit: int,
    row: Any,
    column: Any,
    pairs: Any,
    verdicts: Any,
    at_line: Any,
    at_begin: Any,
    at_end: Any,
    at_words: Any,
) -> tuple[int, int, int, int]:
    """Find the lines of data[begin:end] that are not plain; ``begin`` starts line number ``line``.

    words: whether a plain line before it has a word (0 at the top; what the call before returned);
    limit: characters a line may have; row, column, pairs, verdicts: the automaton of ``lines.py``.
    at_*: for each line found its number, first byte, byte behind its end, and whether a plain line between
    the one found before and it has a word. Stops early when they are full.
    Returns (lines found, next byte, its line number, whether a plain line since the last one has a word).
    """
    room = len(at_line)
    count = 0
    start = begin
    while start < end:
        state = 0
        i = start
        while i + 1 < end:
            after = pairs[state + row[data[i]] + column[data[i + 1]]]
            if after == STOP:
                break
            state = int(after)
            i += 2
        if i < end and data[i] != 10:
            state = int(pairs[state + row[data[i]]])
            i += 1
        # i is at the line feed or at the end
        verdict = int(verdicts[state])
        size = i - start
        if verdict & HAS_RETURN:
            size -= 1
        if i < end:
            i += 1
        if verdict & NOT_PLAIN or size > limit:
            if count == room:
                return count, start, line, words
            at_line[count] = line
            at_begin[count] = start
            at_end[count] = i
            at_words[count] = words
            words = 0
            count += 1
        else:
            words |= verdict & HAS_WORDS
        line += 1
        start = i
    return count, start, line, words
