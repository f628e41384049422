"""The notes of plain lines of Eding G-code: comments, line numbers, slashes, marks.

A plain line has only literal words: an optional block delete slash, an optional line number, words of a
letter and a number, comments that are no messages and do not nest, a comment after a semicolon, blanks
anywhere (Eding manual 3.2). Everything else (expressions, flow control, messages, every mistake) is left
to the grammar. ``frontend/common/number_kernels.py`` finds the lines that are not plain and reads the words of those
that are.

Takes ``bytes`` (or a memory map) and a ``bytearray`` in plain Python, and uint8 arrays when compiled;
``eding/notes.py`` chooses. The range holds plain lines only, so nothing is checked here.
"""

from __future__ import annotations

from typing import Any

from gproof.frontend.common.number_kernels import note_column
from gproof.ir.kernel import kernel

LINE_NUMBER = 1
DELETE = 2
MARK = 3
COMMENT = 4
REMARK = 5
"""Kinds of notes; equal to those of ``ir/notes.py`` NoteKind."""


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
    """Read the notes of the plain lines ``data[begin:end]``; ``begin`` starts line number ``line``.

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
        at_line[count] = line
        at_place[count] = place
        at_kind[count] = kind
        at_column[count] = note_column(data, start, at) if place > 0 else 0
        at_begin[count] = first
        at_size[count] = used - first
        count += 1
    return count, used
