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
