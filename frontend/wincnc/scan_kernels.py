"""The words of plain WinCNC lines: axis letters with numbers or without, G0 to G3, a comment at the end.

Takes ``bytes`` (or a memory map) and Python lists in plain Python, and arrays when compiled; ``scan.py`` chooses. The
range holds plain lines only, so nothing is checked here.
"""

from __future__ import annotations

from typing import Any

from gproof.ir.kernel import kernel
from gproof.ir.program import FLAG_BARE, FLAG_POINT

FLAG_INEXACT = 128
"""Set where integer / power of ten may differ from float(text); the caller then sets the value."""

MANTISSA_LIMIT = 9007199254740992
DECIMALS_LIMIT = 22
"""2**53 and the largest exact power of ten: below both, integer / power is correctly rounded."""

OTHER, DIGIT, POINT, MINUS, FEED, COMMENT = range(6)
"""What a byte is; letters are their own upper-case code, 65 to 90."""


@kernel(seconds_per_unit=1.8e-7, compile_seconds=0.6)
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
    """Read the words of the plain lines data[begin:end]; ``begin`` starts line number ``line``.

    kinds: what each byte is; powers: 10**0 .. 10**22; at_*: columns of WORD, offsets from ``begin``, room for all
    bytes. Stops at the first line end at or behind ``begin + limit``.
    Returns (words read, next byte, its line number).
    """
    stop = begin + limit
    count = 0
    i = begin
    while i < end:
        kind = int(kinds[data[i]])
        i += 1
        if kind >= 65:
            at_line[count] = line
            at_offset[count] = i - 1 - begin
            at_letter[count] = kind
            mantissa = 0
            decimals = 0
            digits = 0
            negative = False
            flags = 0
            while i < end:
                kind = int(kinds[data[i]])
                if kind == DIGIT:
                    digits += 1
                    if mantissa < MANTISSA_LIMIT:
                        mantissa = mantissa * 10 + (int(data[i]) - 48)
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
            if i >= stop:
                return count, i, line
        elif kind == COMMENT:
            while i < end and data[i] != 10:
                i += 1
    if end > begin and data[end - 1] != 10:
        line += 1
    return count, i, line


SIGNED = 7
"""Kind of a note; equal to that of ``ir/notes.py``."""


@kernel(seconds_per_unit=1.6e-7, compile_seconds=0.6)
def scan_notes(
    data: Any,
    begin: int,
    end: int,
    line: int,
    kinds: Any,
    count: int,
    used: int,
    at_line: Any,
    at_place: Any,
    at_kind: Any,
    at_column: Any,
    at_begin: Any,
    at_size: Any,
    text: Any,
) -> tuple[int, int]:
    """Read the comments of the plain lines data[begin:end], with their signs; ``begin`` starts line number ``line``.

    kinds: what each byte is; at_*: columns of NOTE, of which ``count`` rows are in use; text: bytes of the notes, of
    which ``used`` are. Returns (rows in use, bytes in use).
    """
    place = 0
    start = begin
    i = begin
    while i < end:
        kind = int(kinds[data[i]])
        at = i
        i += 1
        if kind >= 65:
            place += 1
            continue
        if kind == FEED:
            line += 1
            place = 0
            start = i
            continue
        if kind != COMMENT:
            continue
        closing = 93 if data[at] == 91 else 41 if data[at] == 40 else 10
        first = used
        while i < end and data[i] != closing and data[i] != 10:
            i += 1
        closed = i < end and closing != 10 and data[i] == closing
        if closed:
            i += 1
        for j in range(at, i):
            text[used] = data[j]
            used += 1
        if not closed:
            while text[used - 1] in (32, 9, 13) and used > first + 1:
                used -= 1
        column = 0
        if place > 0:
            behind = at
            while behind > start and data[behind - 1] in (32, 9):
                behind -= 1
            before = 0
            for t in range(start, at):
                if t == behind:
                    before = column
                column += 8 - column % 8 if data[t] == 9 else 1
            if behind == at or column - before < 2:
                column = 0
        at_line[count] = line
        at_place[count] = place
        at_kind[count] = SIGNED
        at_column[count] = column
        at_begin[count] = first
        at_size[count] = used - first
        count += 1
    return count, used
