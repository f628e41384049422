"""Which letter moves which axis, and in what it counts, on machines whose file names its axes."""

from __future__ import annotations

from gproof.ir.machine import AXES, AxisKind, Machine


def letters_of(machine: Machine) -> dict[str, int]:
    """Column of each letter that moves an axis."""
    return {axis.word: axis.index for axis in machine.axes}


def linear_axes(machine: Machine) -> tuple[bool, ...]:
    """By column: whether the axis is measured in lengths; X, Y and Z where there is no such axis."""
    kinds = {axis.index: axis.kind is AxisKind.LINEAR for axis in machine.axes}
    return tuple(kinds.get(n, n < 3) for n in range(AXES))
