"""What numbered variables show of the state of a run, by their kinds. Eding CNC manual 3.1.1, 3.1.2."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING

from gproof.ir.machine import AXIS_NAMES
from gproof.ir.symbolic import ORIGIN, Unknown, Value, at_place, between, bounds
from gproof.ir.trace import (
    HEIGHT_MAP,
)
from gproof.passes.interpret.core.heads import head_offset

if TYPE_CHECKING:
    from gproof.ir.rules import LanguageRules, ParameterRange
    from gproof.ir.setup import Setup
    from gproof.passes.interpret.core.modal_state import Modal


STATED_FIRST = ("head_offset", "head_speed", "probe_input", "hand_wheel")
"""Kinds of which the setup's own statement counts before what follows from other places."""
PROGRAM_UNIT = ("machine_position", "probe_machine")
"""Kinds whose values are made in the program's unit, and of which only the machine's would be another reading."""
_BY_AXIS = (
    "machine_position", "probe_machine", "park_1", "park_2", "g92", "work", "lower_limit", "upper_limit",
    "home_position", "area_lower", "area_upper",
)  # fmt: skip
_BY_TOOL = (
    "tool_radius", "tool_z", "tool_x", "offset_z", "offset_x", "tool_length", "tool_diameter", "tool_x_offset",
    "head_offset",
)  # fmt: skip


def has_length(entry: ParameterRange, number: int) -> bool:
    """True when a variable holds a length in a unit that no section names."""
    return entry.kind in _BY_TOOL or (entry.kind in _BY_AXIS and number - entry.first < 3)


def _area(modal: Modal, number: int, axis: int, side: int) -> Value:
    area = modal.machine.tool_change_area
    value = math.inf if area is None else area.box[axis][side]
    return value / modal.machine.unit if math.isfinite(value) else Unknown(f"#{number}")


def _limit(modal: Modal, number: int, axis: int, name: str) -> Value:
    there = modal.machine.axis(AXIS_NAMES[axis])
    value = None if there is None else getattr(there, name, None)
    return Unknown(f"#{number}") if value is None else value / modal.machine_unit(axis)


def _spindle_tool(modal: Modal, number: int, what: str) -> Value:
    """A value of the tool in the spindle, in the machine's unit."""
    tool = modal.tool
    if tool is None:
        return Unknown("the tool in the spindle")
    unit = modal.machine.unit
    if what == "length":
        return modal.plain(modal.length_of(tool), unit, number)
    value = modal.tool_diameter(tool) if what == "radius" else modal.tool_x_offset(tool)
    unit *= 2.0 if what == "radius" else 1.0
    if isinstance(value, Unknown):
        return Unknown(value.cause, value.low / unit, value.high / unit)
    return value / unit


def _known_tool(tool: int | None, what: str) -> Value:
    return Unknown(what) if tool is None else float(tool)


def _of_tool(value: Value, unit: float) -> Value:
    return value if isinstance(value, Unknown) else value / unit


def _head_offset(m: Modal, number: int, axis: int) -> Value:
    """#5391 to #5393: of which alternate head, with which sign, or 0 for the first one, the table does not say."""
    readings = [bounds(m.plain(head_offset(m, head, axis), m.machine.unit, number)) for head in (1, 2)]
    reach = max(abs(end) for ends in readings for end in ends)
    return (
        between(f"#{number}, of M91 or M92 and without a sign,", (-reach, reach))
        if reach < math.inf
        else Unknown(f"#{number}")
    )


def _head_speed(m: Modal, number: int, head: int) -> Value:
    """#5394 to #5396: the table names three numbers for "M90-M91"; they are taken for M90, M91, M92."""
    there = m.machine.spindle(head)
    return Unknown(f"#{number}") if there is None or there.max_rpm is None else there.max_rpm


def _kinematics(m: Modal) -> Value:
    """#5150: 1 trivial, 2 Y mapped onto A (Eding manual 3.1.1)."""
    if m.machine.kinematics != "trivial":
        return Unknown("#5150")
    return 1.0 if m.setup.cylinder is None else 2.0


def _work_offset(m: Modal, number: int, axis: int) -> Value:
    """#5221 to #5386: the zero of a coordinate system, from machine zero."""
    at, unit = m.work_offsets[(number - 5221) // 20 + 1, axis], m.machine_unit(axis)
    value = m.plain(at, unit, number)
    return at_place(value, axis, at, ORIGIN, unit) if isinstance(value, Unknown) else value


SHOWN: dict[str, Callable[[Modal, int, int], Value]] = {
    "position": lambda m, n, k: m.shown_position(n, k),
    "machine_position": lambda m, n, k: m.shown(n, k, m.position[k], ORIGIN),
    "tool": lambda m, n, k: _known_tool(m.tool, "the tool in the spindle"),
    "tool_radius": lambda m, n, k: _spindle_tool(m, n, "radius"),
    "tool_z": lambda m, n, k: _spindle_tool(m, n, "length"),
    "new_tool": lambda m, n, k: _known_tool(m.selected_tool, "the tool that is selected"),
    "tool_x": lambda m, n, k: _spindle_tool(m, n, "x"),
    "offset_z": lambda m, n, k: m.plain(m.tool_offset[2], m.machine.unit, n),
    "offset_x": lambda m, n, k: m.plain(m.tool_offset[0], m.machine.unit, n),
    "probe_machine": lambda m, n, k: m.shown(n, k, m.probed[k], ORIGIN),
    "probe_work": lambda m, n, k: m.probed_work[k],
    "probe_hit": lambda m, n, k: m.probe_hit,
    "probe_input": lambda m, n, k: Unknown("the probe input", 0.0, 1.0),
    "hand_wheel": lambda m, n, k: Unknown("the hand wheel"),
    "lower_limit": lambda m, n, k: _limit(m, n, k, "lower"),
    "upper_limit": lambda m, n, k: _limit(m, n, k, "upper"),
    "home_position": lambda m, n, k: _limit(m, n, k, "home_position"),
    "area_lower": lambda m, n, k: _area(m, n, k, 0),
    "area_upper": lambda m, n, k: _area(m, n, k, 1),
    "kinematics": lambda m, n, k: _kinematics(m),
    "height_map": lambda m, n, k: float(HEIGHT_MAP in m.following),
    "g92": lambda m, n, k: m.plain(m.g92_stored[k], m.machine_unit(k), n),
    "work": _work_offset,
    "work_number": lambda m, n, k: float(m.work) if m.work else Unknown("the active coordinate system"),
    "head_offset": _head_offset,
    "head_speed": _head_speed,
    "head": lambda m, n, k: float(m.head) if m.head < 3 else Unknown(f"#{n}"),
    "simulation": lambda m, n, k: 0.0,
    "rendering": lambda m, n, k: float(m.rendering),
    "tool_length": lambda m, n, k: m.plain(m.length_of(k + 1), m.machine.unit, n),
    "tool_diameter": lambda m, n, k: _of_tool(m.tool_diameter(k + 1), m.machine.unit),
    "tool_x_offset": lambda m, n, k: _of_tool(m.tool_x_offset(k + 1), m.machine.unit),
    "tool_orientation": lambda m, n, k: m.tool_orientation(k + 1),
}
"""How a kind of variable is read: (state, its number, its place in the range) -> value."""


def stated_system(rules: LanguageRules, setup: Setup) -> float | None:
    """What the setup states of the variable that shows the active coordinate system (Eding #5220), None for nothing."""
    numbers = (entry.first for entry in rules.parameters if entry.kind == "work_number")
    return next((setup.parameters[n] for n in numbers if n in setup.parameters), None)
