"""The modal state of a running program: positions, offsets, modes, and the variables that show them."""

from __future__ import annotations

import math

from gproof.ir import codes
from gproof.ir.finding import Refusal, Span
from gproof.ir.machine import AXES, AXIS_NAMES, Machine
from gproof.ir.rules import LanguageRules, ParameterRange
from gproof.ir.setup import Setup
from gproof.ir.trace import PathMode, Plane, State
from gproof.passes.values import NOWHERE, Position, Unknown, Value

INCH = 25.4
ZERO = Position(0.0)
NO_OFFSET = [ZERO] * AXES

_PARK_DEFAULTS = {"park_1": 5161, "park_2": 5181}


class Modal:
    """Everything a line may read or change. Lengths in mm whatever the program's units are.

    feed: mm/min as programmed in G94, 1/min in G93, mm/rev in G95; feed_unit: mm of the unit F was given in.
    motion: Function number of the active motion mode, 0 for none. work: 1..9, 0 while not stated.
    """

    def __init__(self, rules: LanguageRules, setup: Setup, machine: Machine) -> None:
        self.rules = rules
        self.setup = setup
        self.machine = machine
        self.axis_there = tuple(machine.axis(name) is not None for name in AXIS_NAMES)
        self.unit = 1.0
        self.absolute = True
        self.plane = Plane.XY
        self.motion = 0
        self.feed = 0.0
        self.feed_unit = 1.0
        self.feed_mode = 94
        self.retract_initial = True
        self.path_mode = PathMode.EXACT_PATH
        self.path_tolerance = 0.0
        self.simplify = 0.0
        self.laf_angle = math.nan
        zero = setup.default_parameter is not None
        self.spindle_speed: Value = 0.0 if zero else Unknown("the spindle speed at the start")
        self.spindle_direction = 0
        self.mist = False
        self.flood = False
        self.overrides = True
        self.guards_off: tuple[str, ...] = ()
        self.tool: int | None = setup.tool
        self.selected_tool: int | None = setup.tool
        self.length_follows_tool = False
        self.stated: set[str] = set()
        self.work = setup.active_work if setup.active_work is not None else 0
        self.parameters: dict[int, Value] = {}
        self.work_offsets = {(n, a): self._symbol(f"work.{n}.{AXIS_NAMES[a]}") for n in range(10) for a in range(AXES)}
        self.g92 = [self._symbol(f"g92.{name}") for name in AXIS_NAMES]
        self.g92_stored = list(self.g92)
        self.tool_offset = list(NO_OFFSET)
        if setup.default_offset is None:
            self.tool_offset[2] = self._symbol("tool.0.z")
        self.tool_lengths: dict[int, Position] = {}
        self.position = [self._symbol(f"start.{name}") for name in AXIS_NAMES]
        self.cycle: dict[str, float] = {}
        self.cycle_code = 0

    def _symbol(self, symbol: str) -> Position:
        """The stated exact value of a symbol, or the symbol itself."""
        known = self.setup.interval(symbol)
        if known is not None and known.exact:
            return Position(known.low)
        return Position(0.0, ((symbol, 1),))

    # -- offsets and positions

    def offset(self, axis: int) -> Position:
        """Where the program's zero of an axis lies in machine coordinates."""
        return self.work_offsets[self.work, axis].plus(self.g92[axis]).plus(self.tool_offset[axis])

    def program_position(self, axis: int) -> Position:
        """The current point in program coordinates, mm."""
        return self.position[axis].minus(self.offset(axis))

    def scale(self, axis: int) -> float:
        """mm (or degrees) in one program unit of an axis."""
        return self.unit if axis < 3 else 1.0

    def length_of(self, tool: int) -> Position:
        """The length of a tool by the table, the setup, or as an unknown of its own."""
        if tool == 0:
            return ZERO
        if tool in self.tool_lengths:
            return self.tool_lengths[tool]
        if tool in self.setup.tool_lengths:
            return self._symbol(f"tool.{tool}.z")
        entry = self.machine.tool(tool)
        if entry is not None and entry.length is not None:
            return Position(entry.length)
        return self._symbol(f"tool.{tool}.z")

    def has_axis(self, axis: int) -> bool:
        """True when the machine has that axis."""
        return self.axis_there[axis]

    def row_state(self) -> State:
        """The slow columns of the rows that come now."""
        spindle = math.nan
        if self.spindle_direction == 0:
            spindle = 0.0
        elif not isinstance(self.spindle_speed, Unknown):
            spindle = self.spindle_speed * self.spindle_direction
        tolerance = self.rules.arc_tolerance_mm
        if self.unit == INCH:
            tolerance = self.rules.arc_tolerance_inch * INCH
        return State(
            tool=-1 if self.tool is None else self.tool, spindle=spindle, feed_mode=self.feed_mode,
            path_mode=self.path_mode, path_tolerance=self.path_tolerance, simplify=self.simplify,
            laf_angle=self.laf_angle, work=self.work, overrides=self.overrides, arc_tolerance=tolerance,
            guards_off=self.guards_off,
        )  # fmt: skip

    # -- numbered variables

    def range_of(self, number: float, span: Span) -> tuple[int, ParameterRange]:
        """The whole number and the table row of a variable; Refusal GP226."""
        whole = round(number)
        near = abs(number - whole) <= self.rules.integer_tolerance
        for entry in self.rules.parameters:
            if near and entry.first <= whole <= entry.last:
                return whole, entry
        raise Refusal(codes.PARAMETER_NUMBER.at(span, value=number, allowed="see the manual's list (3.1.1)"))

    def read(self, number: float, span: Span) -> Value:
        """The live value of a numbered variable, in the units the manual gives it.

        Positions are in program units; offsets and limits in the machine's own unit.
        """
        whole, entry = self.range_of(number, span)
        if whole in self.parameters:
            return self.parameters[whole]
        place = whole - entry.first
        stated = self.setup.parameters.get(whole)
        match entry.kind:
            case "position":
                return self._plain(self.program_position(place), self.scale(place), whole)
            case "machine_position":
                return self._plain(self.position[place], self.scale(place), whole)
            case "tool":
                return Unknown("the tool in the spindle") if self.tool is None else float(self.tool)
            case "g92":
                return self._plain(self.g92_stored[place], self._machine_unit(place), whole)
            case "work":
                coordinates = (entry.first - 5221) // 20 + 1
                return self._plain(self.work_offsets[coordinates, place], self._machine_unit(place), whole)
            case "work_number":
                return float(self.work) if self.work else Unknown("the active coordinate system")
            case "tool_length":
                return self._plain(self.length_of(place + 1), self.machine.unit, whole)
            case "lower_limit" | "upper_limit":
                axis = self.machine.axis(AXIS_NAMES[place])
                limit = None if axis is None else (axis.lower if entry.kind == "lower_limit" else axis.upper)
                return Unknown(f"#{whole}") if limit is None else limit / self._machine_unit(place)
            case "free" | "persistent" | "park_1" | "park_2":
                value = self.setup.parameter(whole)
                return Unknown(f"#{whole}") if value is None else value
        return Unknown(f"#{whole}") if stated is None else stated

    def _machine_unit(self, axis: int) -> float:
        return self.machine.unit if axis < 3 else 1.0

    def _plain(self, at: Position, unit: float, number: int) -> Value:
        return Unknown(f"#{number}") if at.form else at.value / unit

    def write(self, number: float, value: Value, span: Span) -> None:
        """Set a numbered variable; Refusal GP227 for one that shows the machine's state."""
        whole, entry = self.range_of(number, span)
        if not entry.writable:
            raise Refusal(codes.READ_ONLY_PARAMETER.at(span, number=whole, meaning=entry.meaning))
        self.parameters[whole] = value

    def park_position(self, kind: str, axis: int) -> Position:
        """The G28 or G30 point of an axis in machine coordinates; parameters are in the machine's unit."""
        value = self.read(float(_PARK_DEFAULTS[kind] + axis), Span("", 0))
        return NOWHERE if isinstance(value, Unknown) else Position(value * self._machine_unit(axis))
