"""Reading plain lines of Eding G-code at the speed of the disk: the words of a range, and its notes.

A plain line has only literal words: an optional block delete slash, an optional line number, words of a
letter and a number, comments that are no messages and do not nest, a comment behind a semicolon, blanks
anywhere (Eding manual 3.2). Everything else (expressions, flow control, messages, every mistake) is left
to the grammar. ``frontend/common/number_kernels.py`` finds the lines that are not plain; ``scan_words`` reads the words
of a range that holds plain lines only, so it checks nothing, and ``scan_notes`` what stands in it beside the words:
comments, line numbers, slashes, marks.

All take ``bytes`` (or a memory map) and Python lists in plain Python, and uint8 / uint16 / float64 arrays
when compiled; ``eding/scan.py`` and ``eding/notes.py`` choose.
"""

from __future__ import annotations

from typing import Any

from gproof.ir.kernel import kernel
from gproof.ir.program import FLAG_DELETE, FLAG_POINT

FLAG_INEXACT = 128
"""Set by ``scan_words`` where integer / power of ten may differ from float(text); the caller then sets it."""

LINE_NUMBER = 1
DELETE = 2
MARK = 3
COMMENT = 4
REMARK = 5
"""Kinds of notes; equal to those of ``ir/notes.py`` NoteKind."""

MANTISSA_LIMIT = 9007199254740992
DECIMALS_LIMIT = 22
"""2**53 and the largest exact power of ten: below both, integer / power is correctly rounded."""


@kernel(seconds_per_unit=1.8e-7, compile_seconds=0.7)
def scan_words(
    data: Any,
    begin: int,
    end: int,
    line: int,
    limit: int,
    powers: Any,
    at_line: Any,
    at_offset: Any,
    at_letter: Any,
    at_flags: Any,
    at_value: Any,
) -> tuple[int, int, int]:
    """Read the words of the plain lines data[begin:end]; ``begin`` starts line number ``line``.

    powers: 10**0 .. 10**22; at_*: columns of WORD, offsets from ``begin``, room for half the bytes.
    Stops at the first line end at or behind ``begin + limit``.
    Returns (words read, next byte, its line number).
    """
    stop = begin + limit
    count = 0
    delete = 0
    i = begin
    while i < end:
        c = int(data[i])
        i += 1
        if c >= 65:  # a letter: nothing else of a plain line outside comments lies here
            letter = c & 0xDF
            at = i - 1
            mantissa = 0
            decimals = 0
            negative = False
            flags = delete
            while i < end:
                c = int(data[i])
                digit = c - 48
                if 0 <= digit <= 9:
                    if mantissa < MANTISSA_LIMIT:
                        mantissa = mantissa * 10 + digit
                    else:
                        flags |= FLAG_INEXACT
                    if flags & FLAG_POINT:
                        decimals += 1
                elif c == 46:
                    flags |= FLAG_POINT
                elif c == 45:
                    negative = True
                elif c not in (32, 9, 43):  # blank, tab, plus
                    break
                i += 1
            if letter == 78:  # a line number
                continue
            if mantissa > MANTISSA_LIMIT or decimals > DECIMALS_LIMIT:
                flags |= FLAG_INEXACT
                decimals = 0
            value = mantissa / powers[decimals]
            if negative:
                value = -value
            at_line[count] = line
            at_offset[count] = at - begin
            at_letter[count] = letter
            at_flags[count] = flags
            at_value[count] = value
            count += 1
        elif c == 10:
            line += 1
            delete = 0
            if i >= stop:
                return count, i, line
        elif c == 40:
            while i < end and data[i] != 41:
                i += 1
            i += 1
        elif c == 59:
            while i < end and data[i] != 10:
                i += 1
        elif c == 47:
            delete = FLAG_DELETE
    if end > begin and data[end - 1] != 10:
        line += 1
    return count, i, line


@kernel(seconds_per_unit=1.6e-7, compile_seconds=0.6)
def scan_notes(
    data: Any,
    begin: int,
    end: int,
    line: int,
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
    """Read the notes of the plain lines data[begin:end]; ``begin`` starts line number ``line``.

    at_*: columns of NOTE, of which ``count`` rows are in use; text: bytes of the notes, of which ``used`` are.
    Returns (rows in use, bytes in use).
    """
    place = 0
    start = begin
    i = begin
    while i < end:
        c = int(data[i])
        at = i
        i += 1
        if c >= 65:
            if c & 0xDF != 78:
                place += 1
                continue
            kind = LINE_NUMBER
            first = used
            while i < end:
                c = int(data[i])
                if 48 <= c <= 57:
                    text[used] = c
                    used += 1
                elif c not in (32, 9):
                    break
                i += 1
        elif c == 10:
            line += 1
            place = 0
            start = i
            continue
        elif c == 40:
            kind = COMMENT
            first = used
            while i < end and data[i] != 41:
                text[used] = data[i]
                used += 1
                i += 1
            i += 1
        elif c == 59:
            kind = REMARK
            first = used
            while i < end and data[i] != 10:
                text[used] = data[i]
                used += 1
                i += 1
            while used > first and text[used - 1] in (32, 9, 13):
                used -= 1
        elif c == 47:
            kind = DELETE
            first = used
        elif c == 37:
            kind = MARK
            first = used
        else:
            continue
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
        at_kind[count] = kind
        at_column[count] = column
        at_begin[count] = first
        at_size[count] = used - first
        count += 1
    return count, used
