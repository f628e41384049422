"""How far from an arc a controller may bring the tool: its own chords, and arcs that it takes for lines."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from gproof.ir.machine import Machine

Floats = npt.NDArray[np.float64]


def chord_error(machine: Machine) -> float:
    """mm that the controller's own chords of an arc lie inside it: a T² / 8 (docs/dialects/eding.md)."""
    limits = [axis.max_acceleration for axis in machine.axes if axis.index < 3]
    if any(limit is None for limit in limits) or not limits:
        return 0.0
    total = math.sqrt(sum(limit * limit for limit in limits if limit is not None))
    return total * machine.controller.interpolation_time**2 / 8.0


def small_arcs(machine: Machine, start: Floats, center: Floats, plane: npt.NDArray[np.uint8]) -> Floats:
    """(n,) mm by which a line in place of an arc below the controller's smallest one may be off it.

    start, center: (n, 3); plane: (n,) as in the Trace. WinCNC, ``arc_min=``.
    """
    smallest = machine.settings.smallest_arc
    if smallest is None:
        return np.zeros(len(start))
    away = start - center
    away[np.arange(len(away)), np.select([plane == 1, plane == 2], [2, 1], 0)] = 0.0
    radius = np.sqrt((away * away).sum(axis=1))
    return np.where(radius <= smallest, 2.0 * radius, 0.0)
