"""The words of plain lines in any dialect: a table of what each byte is, and the kernel after a plain function.

A value equals float(text) bit for bit: the kernel is exact up to 2**53 and 22 decimals, and what goes beyond is read
here with ``float``.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from gproof.frontend.common import number_kernels as k
from gproof.ir.columns import Columns
from gproof.ir.program import WORD
from gproof.ir.record import record

LONGEST_LINE = 1024
"""More bytes than a plain line has in any dialect: a longer one is not plain."""

_POWERS = [10.0**n for n in range(k.DECIMALS_LIMIT + 1)]


@record(frozen=True, slots=True)
class WordBytes:
    """What each byte is to ``scan_words``.

    kinds, array: of the 256 bytes, for plain Python and for compiled code.
    number: matches the text of a number, with all that counts for nothing in it.
    signs, left_out: for ``bytes.translate``, which makes of that text one that ``float`` takes.
    shortest: bytes that a word has at least.
    """

    kinds: list[int]
    array: npt.NDArray[np.uint8]
    number: re.Pattern[bytes]
    signs: bytes
    left_out: bytes
    shortest: int


def word_bytes(kinds: Sequence[int], shortest: int) -> WordBytes:
    """The tables of a dialect; kinds: of the 256 bytes, as in ``number_kernels.py``; shortest: see WordBytes."""
    inside = bytes(byte for byte in range(256) if kinds[byte] in (k.OTHER, k.DIGIT, k.POINT, k.MINUS))
    left_out = bytes(byte for byte in inside if kinds[byte] == k.OTHER)
    signs = bytes({k.POINT: ord("."), k.MINUS: ord("-")}.get(kind, byte) for byte, kind in enumerate(kinds))
    number = re.compile(b"[" + re.escape(inside) + b"]*")
    return WordBytes(list(kinds), np.array(kinds, np.uint8), number, signs, left_out, shortest)


def scan(table: WordBytes, data: bytes, begin: int, end: int, line: int, limit: int) -> tuple[Columns, int, int]:
    """Words of the plain lines ``data[begin:end]`` whose first has number ``line``; see ``Program.load``.

    Stops at the first line end at or after ``begin + limit``. Returns (WORD columns with offsets from ``begin``, next
    byte, number of the next line).
    """
    room = min(end - begin, limit + LONGEST_LINE) // table.shortest + 1
    columns = {c.name: np.empty(room, np.dtype(c.dtype)) for c in WORD.columns}
    run = k.scan_words.pick(min(end - begin, limit))
    source: Any = data
    kinds: Any = table.kinds
    powers: Any = _POWERS
    if run is not k.scan_words.python:
        source, kinds, powers = np.frombuffer(data, np.uint8), table.array, np.array(_POWERS)
    count, after, next_line = run(source, begin, end, line, limit, kinds, powers, *columns.values())
    columns = {name: column[:count] for name, column in columns.items()}
    _fix_inexact(table, data, begin, columns)
    return Columns(WORD, columns), after, next_line


def _fix_inexact(table: WordBytes, data: bytes, begin: int, columns: dict[str, npt.NDArray[Any]]) -> None:
    """Give the values that the kernel's exact path does not cover the value of float(text)."""
    flags = columns["flags"]
    for row in np.flatnonzero(flags & k.FLAG_INEXACT).tolist():
        found = table.number.match(data, begin + int(columns["offset"][row]) + 1)
        assert found is not None
        columns["value"][row] = float(found.group().translate(table.signs, table.left_out))
        flags[row] &= ~k.FLAG_INEXACT & 0xFF
