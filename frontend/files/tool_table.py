"""The shape of a tool: keys of ``[tools.N]`` in a machine file that gouge and collision checks need.

A tool table of a controller gives a diameter at most; what is not stated here stays not stated. docs/machine-files.md
lists the keys.
"""

from __future__ import annotations

from fractions import Fraction
from typing import Any

from gproof.frontend.common.toml_table import TomlTable
from gproof.ir.machine import SHAPES, Tool

_KEYS = {
    "corner_radius": ("bull",),
    "tip_angle": ("vee", "drill"),
    "tip_diameter": ("vee",),
}
"""Shapes that a key belongs to."""
_NEEDED = {"bull": "corner_radius", "vee": "tip_angle"}


def shape_keys(table: TomlTable, unit: Fraction) -> dict[str, Any]:
    """What a table says of a tool's shape, by field of ``Tool``; lengths in mm."""
    found: dict[str, Any] = {
        "shape": table.text("shape", SHAPES),
        "corner_radius": table.positive("corner_radius", unit=unit, zero=True),
        "tip_angle": table.positive("tip_angle"),
        "tip_diameter": table.positive("tip_diameter", unit=unit, zero=True),
        "flute_length": table.positive("flute_length", unit=unit),
        "shank_diameter": table.positive("shank_diameter", unit=unit),
        "stickout": table.positive("stickout", unit=unit),
        "holder": _holder(table, unit),
    }
    return {name: value for name, value in found.items() if value is not None}


def check_shape(table: TomlTable, tool: Tool) -> None:
    """Findings for keys that contradict one another; ``tool``: with what a base file says of it."""
    shape = tool.shape
    for key, shapes in _KEYS.items():
        if key in table.values and shape is not None and shape not in shapes:
            table.bad(key, f"a tool of shape {shape!r} has none; only {' and '.join(shapes)} have it")
    if shape is None:
        if any(key in table.values for key in _KEYS):
            table.missing("shape")
        return
    if tool.diameter is None:
        table.missing("diameter")
        return
    if tool.diameter <= 0.0:
        table.bad("diameter", f"{tool.diameter:g} mm: a tool with a shape must have a width")
        return
    needed = _NEEDED.get(shape)
    if needed is not None and getattr(tool, needed) is None:
        table.missing(needed)
    if tool.corner_radius is not None and tool.corner_radius > tool.diameter / 2.0:
        table.bad("corner_radius", f"more than half of the diameter, {tool.diameter:g} mm")
    if tool.tip_angle is not None and tool.tip_angle >= 180.0:
        table.bad("tip_angle", "the angle of a tip must be less than 180 degrees")
    if tool.tip_diameter is not None and tool.tip_diameter >= tool.diameter:
        table.bad("tip_diameter", f"the flat at the tip is as wide as the tool, {tool.diameter:g} mm")
    if tool.holder and tool.stickout is None:
        table.missing("stickout")


def _holder(table: TomlTable, unit: Fraction) -> tuple[tuple[float, float, float], ...] | None:
    """``holder = [[diameter below, diameter above, height], ...]``, from the tool upwards."""
    rows = table.grid("holder")
    if rows is None:
        return None
    if any(len(row) != 3 or row[0] < 0 or row[1] < 0 or row[2] <= 0 or not row[0] + row[1] for row in rows):
        table.bad("holder", "a part of a holder must have its diameter below, its diameter above and its height")
        return None
    return tuple((float(row[0] * unit), float(row[1] * unit), float(row[2] * unit)) for row in rows)
