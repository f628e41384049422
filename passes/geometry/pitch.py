"""Pitch tables: where a motor has to be for its axis to be at a position, and the other way round.

A table pairs motor positions with measured ("calibrated") axis positions; between the points the map is linear,
outside the correction of the nearest end stays. Eding CNC manual 2.3; docs/kinematics.md has the readings.
"""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import numpy.typing as npt

from gproof.ir.machine import PitchTable

Floats = npt.NDArray[np.float64]


def motor_position(table: PitchTable, axis: float) -> float:
    """Where the motor is when the axis is at ``axis``."""
    return float(motor_positions(table, np.array([axis]))[0])


def axis_position(table: PitchTable, motor: float) -> float:
    """Where the axis is when the motor is at ``motor``."""
    return float(_map(np.array([motor]), table.machine, table.calibrated)[0])


def motor_positions(table: PitchTable, axis: Floats) -> Floats:
    """``motor_position`` of many positions."""
    return _map(axis, table.calibrated, table.machine)


def _map(at: Floats, source: tuple[float, ...], target: tuple[float, ...]) -> Floats:
    """Linear between points, outside them shifted as the nearest end is."""
    x, y = np.array(source), np.array(target)
    inside = np.interp(at, x, y)
    inside = np.where(at < x[0], at + (y[0] - x[0]), inside)
    result: Floats = np.where(at > x[-1], at + (y[-1] - x[-1]), inside)
    return result


def exact_motor_position(table: PitchTable, axis: float) -> Fraction:
    """``motor_position`` without rounding."""
    at = Fraction(axis)
    x, y = [Fraction(v) for v in table.calibrated], [Fraction(v) for v in table.machine]
    if at <= x[0]:
        return at + y[0] - x[0]
    for k in range(1, len(x)):
        if at <= x[k]:
            return y[k - 1] + (at - x[k - 1]) * (y[k] - y[k - 1]) / (x[k] - x[k - 1])
    return at + y[-1] - x[-1]


def steepest(table: PitchTable) -> float:
    """Motor travel for one unit of axis travel, at most; at least 1, which holds outside the table."""
    x, y = np.array(table.calibrated), np.array(table.machine)
    slopes: list[float] = (np.diff(y) / np.diff(x)).tolist()
    return max([1.0, *slopes])
