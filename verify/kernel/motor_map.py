"""Pitch tables as the stream checker reads them: by its own arithmetic, from the Machine's numbers.

A table pairs motor positions with the axis positions that were measured there; linear between points, outside them
the shift of the nearest end (Eding manual 2.3; docs/kinematics.md). Both columns rise, so the map has an inverse and
keeps directions: turning points of a motor are those of its axis.
"""

from __future__ import annotations

import bisect
from fractions import Fraction

import numpy as np
import numpy.typing as npt

from gproof.ir.drives import PitchTable

Floats = npt.NDArray[np.float64]


def motor_at(table: PitchTable | None, axis: float) -> Fraction:
    """The exact motor position at which the axis is at ``axis``."""
    at = Fraction(axis)
    if table is None:
        return at
    k = bisect.bisect_right(table.calibrated, axis)
    low, high = max(k - 1, 0), min(k, len(table.machine) - 1)
    a, b = Fraction(table.calibrated[low]), Fraction(table.calibrated[high])
    u, v = Fraction(table.machine[low]), Fraction(table.machine[high])
    slope = Fraction(1) if low == high else (v - u) / (b - a)
    return u + (at - a) * slope


def knots_of(table: PitchTable | None, steps_per_unit: float) -> Floats:
    """(k, 2) motor and axis positions of the table's points in steps, rising; (0, 2) without a table."""
    if table is None:
        return np.zeros((0, 2))
    pairs = sorted(
        (m * steps_per_unit, c * steps_per_unit) for m, c in zip(table.machine, table.calibrated, strict=True)
    )
    return np.array(pairs, dtype=np.float64)


def bend(table: PitchTable | None, reach: float) -> float:
    """How much the slope of the motor over the axis can change, in sum, over any ``reach`` of axis travel."""
    if table is None:
        return 0.0
    at, to = table.calibrated, table.machine
    slopes = [1.0, *((to[k + 1] - to[k]) / (at[k + 1] - at[k]) for k in range(len(at) - 1)), 1.0]
    changes = [abs(slopes[k + 1] - slopes[k]) for k in range(len(at))]
    most = total = 0.0
    first = 0
    for k, change in enumerate(changes):
        total += change
        while at[k] - at[first] > reach:
            total -= changes[first]
            first += 1
        most = max(most, sum(changes[first : k + 1]) if total < 0.0 else total)
    return most
