"""Numbers of files, exactly as they are written."""

from __future__ import annotations

import re
from decimal import Decimal
from fractions import Fraction
from typing import Any

MILLIMETRES = {"mm": Fraction(1), "inch": Fraction(127, 5)}
"""Millimetres in one length unit of a file."""

LARGEST = Fraction(10**12)
TINIEST = Fraction(1, 10**12)
"""Numbers outside have no meaning in a machine; they would only overflow later."""


def exact_number(value: Any) -> Fraction | None:
    """A TOML number as written, exactly; None for other values, infinities and absurd exponents."""
    if isinstance(value, bool):
        return None
    if isinstance(value, int):
        return Fraction(value)
    if isinstance(value, Decimal) and value.is_finite() and abs(value.adjusted()) <= 400:
        return Fraction(value)
    return None


_RATIO = re.compile(r"\s*([-+]?(?:\d++(?:\.\d*+)?|\.\d+))\s*(?:/\s*(\d++(?:\.\d*+)?|\.\d+)\s*)?", re.ASCII)


def exact_ratio(text: str) -> Fraction | None:
    """``"320.5"`` or ``"1600/5"``, exactly; None for other texts."""
    found = _RATIO.fullmatch(text) if len(text) <= 80 else None
    if found is None:
        return None
    divisor = Fraction(found[2]) if found[2] else Fraction(1)
    return Fraction(found[1]) / divisor if divisor else None
