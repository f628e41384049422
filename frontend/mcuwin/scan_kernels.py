"""The notes of plain lines of McuWIN: line numbers, and comments at the end.

Takes ``bytes`` (or a memory map) and a ``bytearray`` in plain Python, and uint8 arrays when compiled; ``notes.py``
chooses. The range holds plain lines only, so nothing is checked here.
"""

from __future__ import annotations

from typing import Any

from gproof.frontend.common.number_kernels import note_column
from gproof.ir.kernel import kernel

LINE_NUMBER = 1
SIGNED = 7
"""Kinds of notes; equal to those of ``ir/notes.py``."""


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
    """Read line numbers, and comments with their signs, of plain lines ``data[begin:end]``; ``begin`` starts ``line``.

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
        first = used
        if c == 10:
            line += 1
            place = 0
            start = i
            continue
        if c >= 65:
            if c & 0xDF != 78:
                place += 1
                continue
            kind = LINE_NUMBER
            while i < end:
                b = int(data[i])
                if 48 <= b <= 57:
                    text[used] = b
                    used += 1
                elif b not in (32, 9):
                    break
                i += 1
        elif c in (39, 40):
            kind = SIGNED
            closing = 41 if c == 40 else 10
            while i < end and data[i] != closing and data[i] != 10:
                i += 1
            if closing == 41:
                i += 1
            for j in range(at, i):
                text[used] = data[j]
                used += 1
            while closing == 10 and used > first + 1 and text[used - 1] in (32, 9, 13):
                used -= 1
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
