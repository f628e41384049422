"""Plain lines of a program as text: WORD columns and notes in, bytes out."""

from __future__ import annotations

from typing import Any

import numpy as np

from gproof.backend.emit import plain_lines_kernels as k
from gproof.backend.emit.numbers import number_text
from gproof.ir.columns import Columns
from gproof.ir.notes import Notes
from gproof.ir.program import FLAG_POINT

_LONGEST_NUMBER = 24
_POWERS = [10**n for n in range(k.MOST_DECIMALS + 1)]
_FLOAT_POWERS = [10.0**n for n in range(k.MOST_DECIMALS + 1)]


def plain_lines(
    first: int,
    last: int,
    words: Columns,
    notes: Notes,
    *,
    indent: int,
    limit: int,
    newline: str,
    kept: bytes = b"",
    two_digits: bool = False,
) -> tuple[bytes, list[tuple[int, int, int]]]:
    """The lines first..last with these words and notes.

    limit: bytes that a line may have without its end; kept: bytes with which none may start; two_digits: codes
    below 10 have a zero before them. Returns the text and, of the lines that are longer or start so, the number, start
    and end (without the line's end) in the text.
    """
    lines = last - first + 1
    run = k.print_lines.pick(len(words) + len(notes.table) + lines)
    compiled = run is not k.print_lines.python
    decimals, hard_begin, hard_text = _decimals(words, compiled)
    room = len(words) * _LONGEST_NUMBER + len(hard_text) + int(notes.table["size"].sum())
    room += (len(notes.table) + lines) * (indent + 4) + int(notes.table["column"].sum())
    out = bytearray(room)
    long = [np.empty(lines, np.int64) for _ in range(3)]
    powers: Any = _POWERS
    texts: list[Any] = [hard_text, notes.text, kept, out]
    if compiled:
        powers = np.array(_POWERS)
        texts = [np.frombuffer(text or b"\0", np.uint8) for text in texts]
    hard, note_text, first_bytes, target = texts
    layout = k.Layout(indent, limit, int(newline == "\r\n"), int(two_digits), first_bytes, len(kept))
    printed = k.PrintedWords(
        words["line"], words["letter"], words["flags"], words["value"], decimals, powers, hard_begin, hard
    )
    table = notes.table
    noted = k.PrintedNotes(
        table["line"], table["place"], table["kind"], table["column"], table["begin"], table["size"], note_text
    )
    size, longs = run(first, last, layout, printed, noted, target, k.LongLines(*long))
    found = zip(*(column[:longs].tolist() for column in long), strict=True)
    return bytes(memoryview(out)[:size]), list(found)


def _decimals(words: Columns, compiled: bool) -> tuple[Any, Any, bytes]:
    """Decimals of each word's number; the texts of those that the kernel cannot print, and where each starts."""
    values, flags = words["value"], words["flags"]
    decimals = np.empty(len(words), np.int64)
    count = k.count_decimals.compiled() if compiled else k.count_decimals.python
    if not count(values, np.array(_FLOAT_POWERS), decimals):
        return decimals, np.zeros(1, np.int64), b""
    rows = np.flatnonzero(decimals < 0)
    texts = [number_text(float(values[row]), bool(flags[row] & FLAG_POINT)).encode() for row in rows.tolist()]
    decimals[rows] = -1 - np.arange(len(rows))
    begins = np.concatenate(([0], np.cumsum([len(text) for text in texts])))
    return decimals, begins.astype(np.int64), b"".join(texts)
