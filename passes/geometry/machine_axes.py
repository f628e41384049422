"""Which axes of a machine do what."""

from __future__ import annotations

from gproof.ir.machine import AxisKind, Machine


def vertical_axes(machine: Machine) -> tuple[int, ...]:
    """Columns of the axes that carry heads up and down."""
    return tuple(
        axis.index
        for axis in machine.axes
        if (axis.vertical if axis.vertical is not None else axis.word in "ZWUV" and axis.kind is AxisKind.LINEAR)
    )
