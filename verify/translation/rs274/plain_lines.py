"""Lines of literal moves, read as columns: no object a line.

A plain line has words of the letters G X Y Z A B C I J K R F alone, each at most once, with plain numbers, one blank at
most between words, G one of 0 to 3. All other lines are left to ``words.py``.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from gproof.ir.record import record

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Bytes = npt.NDArray[np.uint8]

LETTERS = "GXYZABCIJKRF"
"""Columns of ``PlainLines.values``."""
LONGEST = 15
"""Digits of a number that is read here: the digits as a whole number are exact, and so is a power of ten."""
MOST_CHARACTERS = 18
PIECE = 1 << 19
"""Bytes that are read at once."""

_SLOT = np.full(256, -1, np.int8)
for _place, _letter in enumerate(LETTERS):
    _SLOT[ord(_letter)] = _place
_NEWLINE, _BLANK, _POINT, _MINUS, _ZERO, _RETURN = (ord(c) for c in "\n .-0\r")
_POWERS = 10.0 ** np.arange(LONGEST + 8)
_ALLOWED = np.zeros(256, np.bool_)
_ALLOWED[[ord(c) for c in f"{LETTERS}0123456789.- \n"]] = True


@record(frozen=True, slots=True)
class PlainLines:
    """plain: (lines,) whether a line is one; starts: (lines + 1,) where each starts; values: (plain lines, 12), NaN for
    letters that it does not have; row: (lines,) its row in ``values``."""

    plain: npt.NDArray[np.bool_]
    starts: Ints
    values: Floats
    row: Ints


def plain_lines(text: bytes) -> PlainLines:
    """All lines of a text, which ends with a newline; in pieces that fit into a processor's cache."""
    parts, starts, begin = [], [], 0
    while begin < len(text):
        end = text.find(b"\n", min(begin + PIECE, len(text) - 1)) + 1
        parts.append(_piece(text[begin:end]))
        starts.append(parts[-1].starts[:-1] + begin)
        begin = end
    if not parts:
        return _piece(text)
    plain = np.concatenate([part.plain for part in parts])
    return PlainLines(
        plain, np.concatenate([*starts, [len(text)]]), np.concatenate([part.values for part in parts]),
        np.cumsum(plain) - 1,
    )  # fmt: skip


def _piece(text: bytes) -> PlainLines:
    data = np.frombuffer(text, np.uint8)
    ends = np.flatnonzero(data == _NEWLINE)
    starts = np.concatenate([[0], ends + 1])
    count = len(ends)
    plain = np.ones(count, np.bool_)
    line_of = np.searchsorted(ends, np.flatnonzero(~_ALLOWED[data]))
    plain[line_of[line_of < count]] = False
    at = np.flatnonzero(_SLOT[data] >= 0)
    line = np.searchsorted(ends, at)
    values, good = _numbers(data, at)
    plain[line[~good]] = False
    slot = _SLOT[data[at]].astype(np.int64)
    _spell(data, starts, at, line, plain)
    is_g = slot == 0
    plain[line[is_g & ~np.isin(values, (0.0, 1.0, 2.0, 3.0))]] = False
    key = line * len(LETTERS) + slot
    twice = np.bincount(key, minlength=count * len(LETTERS)) > 1
    plain[np.flatnonzero(twice) // len(LETTERS)] = False
    plain[np.bincount(line, minlength=count) == 0] = False
    row = np.cumsum(plain) - 1
    table = np.full((int(plain.sum()), len(LETTERS)), np.nan)
    kept = plain[line]
    table[row[line[kept]], slot[kept]] = values[kept]
    return PlainLines(plain, starts.astype(np.int64), table, row.astype(np.int64))


def _numbers(data: Bytes, at: Ints) -> tuple[Floats, npt.NDArray[np.bool_]]:
    """The numbers after letters, and whether each is a plain one that a blank, a letter or the line's end follows."""
    count = len(at)
    here = at + 1
    last = len(data) - 1
    sign = np.ones(count)
    negative = data[np.minimum(here, last)] == _MINUS
    sign[negative] = -1.0
    here = here + negative
    mantissa = np.zeros(count)
    digits = np.zeros(count, np.int64)
    decimals = np.zeros(count, np.int64)
    pointed = np.zeros(count, np.bool_)
    good = np.ones(count, np.bool_)
    todo = np.arange(count)
    for _ in range(MOST_CHARACTERS):
        char = data[np.minimum(here[todo], last)]
        digit = char - np.uint8(_ZERO)
        is_digit = digit < 10
        is_point = char == _POINT
        on = todo[is_digit]
        mantissa[on] = mantissa[on] * 10.0 + digit[is_digit]
        digits[on] += 1
        decimals[on] += pointed[on]
        dots = todo[is_point]
        good[dots] &= ~pointed[dots]
        pointed[dots] = True
        todo = todo[is_digit | is_point]
        if not len(todo):
            break
        here[todo] += 1
    good[todo] = False
    after = data[np.minimum(here, last)]
    good &= (digits > 0) & (digits <= LONGEST) & ((after == _BLANK) | (after == _NEWLINE) | (_SLOT[after] >= 0))
    return sign * mantissa / _POWERS[np.minimum(decimals, len(_POWERS) - 1)], good


def _spell(data: Bytes, starts: Ints, at: Ints, line: Ints, plain: npt.NDArray[np.bool_]) -> None:
    """A line starts with blanks and a letter: what comes before a first letter is no word."""
    first = np.full(len(plain), -1, np.int64)
    first[line[::-1]] = at[::-1]
    blank = np.concatenate([[0], np.cumsum(data == _BLANK)])
    begin = starts[:-1]
    has = first >= 0
    only = np.zeros(len(plain), np.bool_)
    only[has] = (blank[first[has]] - blank[begin[has]]) == first[has] - begin[has]
    plain &= only
    # Two blanks in a row, or a number without its letter: a blank has a letter, a blank or the end after it.
    gaps = np.flatnonzero(data == _BLANK)
    after = data[np.minimum(gaps + 1, len(data) - 1)]
    stray = gaps[(_SLOT[after] < 0) & (after != _BLANK) & (after != _NEWLINE)]
    stray_line = np.searchsorted(starts, stray, side="right") - 1
    plain[stray_line[stray_line < len(plain)]] = False
