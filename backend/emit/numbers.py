"""Numbers as text that reads back bit for bit: the shortest digits, no exponent, a leading zero.

``X.50`` becomes ``X0.5``, ``X5.`` becomes ``X5.0``: whether a number had a decimal point is kept.
"""

from __future__ import annotations

from decimal import Decimal


def number_text(value: float, point: bool) -> str:
    """``value`` in decimal digits; point: with a decimal point also when it is whole."""
    text = repr(value)
    if "e" in text:
        text = format(Decimal(text), "f")
    whole, _, decimals = text.partition(".")
    if decimals.strip("0") or point:
        return f"{whole}.{decimals or '0'}"
    return whole
