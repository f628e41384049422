"""Reading the notes of plain lines (comments, line numbers, slashes, marks); what is plain: ``scan_kernels.py``."""

from __future__ import annotations

from typing import Any

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
