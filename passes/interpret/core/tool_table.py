"""The tool table as a state knows it (Eding 3.1.2): what the program wrote, the setup, the machine file."""

from __future__ import annotations

from gproof.ir.machine import Machine
from gproof.ir.setup import Setup
from gproof.ir.symbolic import NOWHERE, Position, Unknown, Value, between

TOOL_LENGTH, TOOL_DIAMETER, TOOL_X_OFFSET, TOOL_ORIENTATION = 5400, 5500, 5600, 5700
"""Numbers of the variables of tool 0."""
ZERO = Position(0.0)


class ToolTable:
    """What is known of tools by their numbers."""

    parameters: dict[int, Value]
    setup: Setup
    machine: Machine

    def symbol(self, symbol: str) -> Position:
        """The stated exact value of a symbol, or the symbol itself."""
        raise NotImplementedError

    def length_of(self, tool: int) -> Position:
        """The length of a tool by the table, the setup, or as an unknown of its own."""
        if tool == 0:
            return ZERO
        written = self.parameters.get(TOOL_LENGTH + tool)
        if written is not None:
            return NOWHERE if isinstance(written, Unknown) else Position(written * self.machine.unit)
        if tool in self.setup.tool_lengths:
            return self.symbol(f"tool.{tool}.z")
        stated = self.setup.parameters.get(TOOL_LENGTH + tool)
        if stated is not None:
            return Position(stated * self.machine.unit)
        if TOOL_LENGTH + tool in self.setup.parameter_ranges:
            return NOWHERE
        entry = self.machine.tool(tool)
        if entry is not None and entry.length is not None:
            return Position(entry.length)
        return self.symbol(f"tool.{tool}.z")

    def tool_diameter(self, tool: int) -> Value:
        """mm; tool 0 is no tool and has none."""
        return self._tool_number(TOOL_DIAMETER, tool, "diameter", self.machine.unit)

    def tool_x_offset(self, tool: int) -> Value:
        """mm; what the table does not tell is 0, as on a mill."""
        value = self._tool_number(TOOL_X_OFFSET, tool, "x_offset", self.machine.unit)
        stated = TOOL_X_OFFSET + tool in {**self.parameters, **self.setup.parameter_ranges}
        return 0.0 if isinstance(value, Unknown) and not stated else value

    def tool_orientation(self, tool: int) -> Value:
        """1 to 9, for turning."""
        return self._tool_number(TOOL_ORIENTATION, tool, "orientation", 1.0)

    def _tool_number(self, base: int, tool: int, name: str, unit: float) -> Value:
        if tool == 0:
            return 0.0
        written = self.parameters.get(base + tool)
        if isinstance(written, Unknown):
            return between(written.cause, (written.low * unit, written.high * unit))
        if written is not None:
            return written * unit
        stated = self.setup.parameters.get(base + tool)
        if stated is not None:
            return stated * unit
        if base + tool in self.setup.parameter_ranges:
            ends = self.setup.parameter_ranges[base + tool]
            return between(f"the {name.replace('_', ' ')} of tool {tool}", (ends.low * unit, ends.high * unit))
        entry = self.machine.tool(tool)
        value = None if entry is None else getattr(entry, name)
        return Unknown(f"the {name.replace('_', ' ')} of tool {tool}") if value is None else float(value)
