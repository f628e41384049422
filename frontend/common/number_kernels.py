"""Plain lines at the speed of the disk: which lines are plain, their words and numbers, the columns of their notes.

Takes ``bytes`` (or a memory map) and Python lists in plain Python, and uint8 / uint16 / float64 arrays when compiled;
``lines.py`` and ``words.py`` next to it make the tables and choose. A dialect's own ``scan_kernels.py`` reads notes.
"""

from __future__ import annotations

from typing import Any

from gproof.ir.kernel import kernel
from gproof.ir.program import FLAG_BARE, FLAG_DELETE, FLAG_POINT

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
    """Find the lines of ``data[begin:end]`` that are not plain; ``begin`` starts line number ``line``.

    words: whether a plain line before it has a word (0 at the top; what the call before returned);
    limit: characters a line may have; row, column, pairs, verdicts: the automaton of ``lines.py``.
    at_*: for each line found its number, first byte, byte after its end, and whether a plain line between
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


FLAG_INEXACT = 128
"""Set by ``scan_words`` where integer / power of ten may differ from float(text); the caller then sets the value."""

MANTISSA_LIMIT = 9007199254740992
DECIMALS_LIMIT = 22
"""2**53 and the largest exact power of ten: below both, integer / power is correctly rounded."""

OTHER, DIGIT, POINT, MINUS, FEED, COMMENT, ROUND, DELETE, NUMBER = range(9)
"""What a byte of a plain line is; letters of words are their own upper-case code, 65 to 90.

OTHER: counts for nothing, in numbers too (blanks, a plus). COMMENT: goes on to the end of the line. ROUND: goes on to
the closing bracket; words may follow. DELETE: the block delete slash. NUMBER: the letter of a line number."""


@kernel(seconds_per_unit=1.8e-7, compile_seconds=0.7)
def scan_words(
    data: Any,
    begin: int,
    end: int,
    line: int,
    limit: int,
    kinds: Any,
    powers: Any,
    at_line: Any,
    at_offset: Any,
    at_letter: Any,
    at_flags: Any,
    at_value: Any,
) -> tuple[int, int, int]:
    """Read the words of the plain lines ``data[begin:end]``; ``begin`` starts line number ``line``. Checks nothing.

    kinds: what each byte is; powers: 10**0 .. 10**22; at_*: columns of WORD, offsets from ``begin``, with room for what
    the lines up to ``limit`` can hold. Stops at the first line end at or after ``begin + limit``.
    Returns (words read, next byte, its line number).
    """
    stop = begin + limit
    count = 0
    delete = 0
    i = begin
    while i < end:
        kind = kinds[data[i]]
        i += 1
        if kind >= 65:
            at_line[count] = line
            at_offset[count] = i - 1 - begin
            at_letter[count] = kind
            mantissa = 0
            decimals = 0
            digits = 0
            negative = False
            flags = delete
            while i < end:
                kind = kinds[data[i]]
                if kind == DIGIT:
                    digits += 1
                    if mantissa < MANTISSA_LIMIT:
                        mantissa = mantissa * 10 + (data[i] - 48)
                    else:
                        flags |= FLAG_INEXACT
                    if flags & FLAG_POINT:
                        decimals += 1
                elif kind == POINT:
                    flags |= FLAG_POINT
                elif kind == MINUS:
                    negative = True
                elif kind != OTHER:
                    break
                i += 1
            if mantissa > MANTISSA_LIMIT or decimals > DECIMALS_LIMIT:
                flags |= FLAG_INEXACT
                decimals = 0
            if digits == 0:
                flags |= FLAG_BARE
            value = mantissa / powers[decimals]
            if negative:
                value = -value
            at_flags[count] = flags
            at_value[count] = value
            count += 1
        elif kind == FEED:
            line += 1
            delete = 0
            if i >= stop:
                return count, i, line
        elif kind == COMMENT:
            while i < end and data[i] != 10:
                i += 1
        elif kind == ROUND:
            while i < end and data[i] != 41:
                i += 1
            i += 1
        elif kind == DELETE:
            delete = FLAG_DELETE
    if end > begin and data[end - 1] != 10:
        line += 1
    return count, i, line


@kernel(seconds_per_unit=1.6e-7, compile_seconds=0.2)
def note_column(data: Any, start: int, at: int) -> int:
    """The column of a note at byte ``at`` of a line that starts at ``start``, when words and two or more blanks are
    before it, otherwise 0; see NOTE. A tab moves to the next multiple of eight."""
    blank = at
    while blank > start and data[blank - 1] in (32, 9):
        blank -= 1
    column = 0
    before = 0
    for t in range(start, at):
        if t == blank:
            before = column
        column += 8 - column % 8 if data[t] == 9 else 1
    return 0 if blank == at or column - before < 2 else column
