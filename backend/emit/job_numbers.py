"""Numbers of a Job as text, in the unit and with the decimals of a target's style."""

from __future__ import annotations

import math

import numpy as np

from gproof.backend.emit.numbers import number_text
from gproof.ir.columns import Array
from gproof.ir.job import MM
from gproof.ir.target import Style

SUMMED = 3
"""More decimals for what is added up: distances, zeros, pecks. Their rounding would be added up too."""
MOST_DECIMALS = 12


def decimals_of(style: Style, unit: str, *, summed: bool = False) -> int:
    """Most decimals of a quantity in this unit. summed: places count from it, or it from a place."""
    most = {
        "mm": style.decimals_mm,
        "cm": style.decimals_mm,
        "inch": style.decimals_inch,
        "deg": style.decimals_deg,
    }.get(unit, style.decimals)
    return min(most + SUMMED, max(most, MOST_DECIMALS)) if summed else most


def rounded(values: Array, decimals: int) -> Array:
    """The nearest numbers with so many decimals; no zero has a sign."""
    found: Array = np.round(values, decimals) + 0.0
    return found


def text_of(value: float, decimals: int) -> str:
    """A number with at most so many decimals."""
    return number_text(float(np.round(value, decimals)) + 0.0, False)


def feed_decimals(value: float, decimals: int) -> int:
    """Decimals of a feed: at least so many, and five digits that count where it is below 1."""
    return decimals if not 0.0 < value < 1.0 else max(decimals, 4 - math.floor(math.log10(value)))


def rounded_feeds(values: Array, decimals: int) -> Array:
    """Feeds as they are printed, NaN as 0."""
    known = np.nan_to_num(values)
    found = rounded(known, decimals)
    for row in np.flatnonzero((known > 0.0) & (known < 1.0)).tolist():
        found[row] = np.round(known[row], feed_decimals(float(known[row]), decimals))
    return found


def factor(unit: str, other: str) -> float:
    """By what a number in ``unit`` is multiplied to be in ``other``; 1 where they are not both lengths."""
    return MM[unit] / MM[other] if unit in MM and other in MM and unit != other else 1.0
