"""The notes of plain WinCNC lines: a comment at the end.

Takes ``bytes`` (or a memory map) and a ``bytearray`` in plain Python, and uint8 arrays when compiled; ``notes.py``
chooses. The range holds plain lines only, so nothing is checked here.
"""

from __future__ import annotations

from typing import Any

from gproof.frontend.common.number_kernels import COMMENT, FEED, note_column
from gproof.ir.kernel import kernel

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
    """Read the comments of plain lines ``data[begin:end]``, with their signs; ``begin`` starts line number ``line``.

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
        at_line[count] = line
        at_place[count] = place
        at_kind[count] = SIGNED
        at_column[count] = note_column(data, start, at) if place > 0 else 0
        at_begin[count] = first
        at_size[count] = used - first
        count += 1
    return count, used
