"""The modal state of a running program: positions, offsets, modes, and the variables that show them."""

from __future__ import annotations

import copy
import math
import re
from collections.abc import Callable
from dataclasses import replace

from gproof.ir import codes
from gproof.ir.finding import Refusal, Span
from gproof.ir.intervals import widened
from gproof.ir.machine import AXES, AXIS_NAMES, Machine
from gproof.ir.modal_groups import MOTION, OF_ARCS, OF_FEEDS, OF_ORIGINS, OF_PLACES, SPINDLE
from gproof.ir.rules import LanguageRules, ParameterRange
from gproof.ir.setup import Interval, Setup
from gproof.ir.symbolic import NOWHERE, ORIGIN, Position, Unknown, Value, at_place, between, bounds
from gproof.ir.trace import (
    HEIGHT_MAP,
    OTHER_UNIT,
    UNKNOWN,
    Affine,
    Boundary,
    PathMode,
    Plane,
    State,
    TipOffset,
    ToolDiameter,
)
from gproof.passes.interpret.core.cutter_compensation import Compensation
from gproof.passes.interpret.core.plane_transform import NO_TRANSFORM
from gproof.passes.interpret.eding.heads import head_offset
from gproof.passes.interpret.eding.spindle import commanded_rpm
from gproof.passes.interpret.mcuwin import state as din_state
from gproof.passes.interpret.wincnc.state import SingleState, boundaries_of, linear_axes, machine_zero, prepare

INCH = 25.4
ZERO = Position(0.0)
NO_SINGLE_STATE = SingleState()
LENGTHS = (True, True, True, False, False, False)
NO_OFFSET = [ZERO] * AXES

_PARK_DEFAULTS = {"park_1": 5161, "park_2": 5181}
TOOL_LENGTH, TOOL_DIAMETER, TOOL_X_OFFSET, TOOL_ORIENTATION = 5400, 5500, 5600, 5700
_ARISING = re.compile(r"\b((?:probe|value|home)\.\d+\.[a-z])\b")
"""Unknowns that arise in a run (``Emitter.unknown_place``)."""
_CONSTANT = (
    "fixed",
    "texts",
    "rules",
    "setup",
    "machine",
    "axis_there",
    "linear",
    "ranges",
    "_tool_table",
    "zero_lengths",
)
_OTHER = frozenset((*_CONSTANT, "parameters"))
_OTHER_OR_PROBED = _OTHER | {"probed", "probed_work", "probe_hit"}
NO_NUMBERS = frozenset[int]()


class StateKey:
    """A part of a key that is hashed once."""

    __slots__ = ("_hash", "parts")

    def __init__(self, parts: tuple[object, ...]) -> None:
        self.parts = parts
        self._hash = hash(parts)

    def __hash__(self) -> int:
        return self._hash

    def __eq__(self, other: object) -> bool:
        return isinstance(other, StateKey) and self._hash == other._hash and self.parts == other.parts


class Modal:
    """Everything a line may read or change. Lengths in mm whatever the program's units are.

    feed: mm/min as programmed in G94, 1/min in G93, mm/rev in G95; feed_unit: mm of the unit F was given in.
    motion: Function number of the active motion mode, 0 for none. work: 1..9, 0 while not stated.
    following: see ``State``; height_map_known: the map in use is the setup's. unhomed: columns of axes that have had no
    reference run, by the setup and in the job. jumped: a refused line has moved the
    position, and no row.
    spindle_speed: as programmed: rpm, with surface_speed_mode m/min; spindle_limit: rpm, NaN for none; pitch: mm a
    revolution of the move that is being made, 0 for moves that do not follow the spindle; direction_output: 1 on,
    -1 off, 0 not known; spun: direction that the last row gave a spindle, and the head that turns, -1 for none;
    head: see ``Op.HEAD``; head_offsets: by (head, axis), what a program set or spoiled. offset_tool: the tool whose
    entry of the table is in force as the length, None for none of the table; length_tool: the tool whose length
    ``tool_offset`` is meant to be; lengths_used: the lengths of tools are in use, in the setup or by the job.
    """

    def __init__(self, rules: LanguageRules, setup: Setup, machine: Machine) -> None:
        # Containers as parts of a key, with what they were made of.
        self.fixed: dict[str, tuple[object, object]] = {}
        self.texts: dict[str, tuple[object, list[str]]] = {}
        self.rules = rules
        self.setup = setup
        self.machine = machine
        self.axis_there = tuple(machine.axis(name) is not None for name in AXIS_NAMES)
        self.linear = linear_axes(machine) if rules.one_command or rules.source_order else LENGTHS
        self._tool_table = next(((e.first, e.last) for e in rules.parameters if e.kind == "tool_diameter"), (0, -1))
        self.unit = 1.0
        self.absolute = True
        self.plane = Plane.XZ if machine.controller.turning else Plane.XY
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
        self.spun = (0, -1)
        self.surface_speed_mode = False
        self.spindle_limit = math.nan
        self.direction_output = 0
        self.pitch = 0.0
        self.feed_override = 1.0
        self.feed_input = False
        self.speed_override_known = True
        self.head = self.head_at_start()
        self.head_offsets: dict[tuple[int, int], Position] = {}
        self.mist = False
        self.flood = False
        self.overrides = True
        self.guards_off: tuple[str, ...] = ()
        self.tool: int | None = setup.tool
        self.selected_tool: int | None = setup.tool
        self.length_follows_tool = False
        self.offset_tool: int | None = None
        in_force = self._symbol("tool.0.z")
        # With none in force the tool stands out all the same; one that nobody states is taken for the tool's own.
        self.length_tool: int | None = 0 if in_force == ZERO else setup.tool
        self.lengths_used = any(not ends.exact or ends.low for ends in (*setup.measures.values(), *_length_now(setup)))
        self.stated: set[str] = {"spindle"} if zero else set()
        self.work = setup.active_work if setup.active_work is not None else self._stated_system()
        self.parameters: dict[int, Value] = {}
        # Tools of which no file states the length that the setup takes as 0.
        self.zero_lengths: dict[int, None] = {}
        self.work_offsets = {(n, a): self._symbol(f"work.{n}.{AXIS_NAMES[a]}") for n in range(10) for a in range(AXES)}
        self.written_work: dict[tuple[int, int], Position] = {}
        self.g92 = [self._symbol(f"g92.{name}") for name in AXIS_NAMES]
        self.g92_stored = self._stored_offsets()
        self.tool_offset = list(NO_OFFSET)
        if setup.default_offset is None:
            self.tool_offset[2] = self._symbol("tool.0.z")
        self.ranges: dict[str, Interval] = {}
        self.probed = [NOWHERE] * AXES
        # Before the first probing move: what an earlier job has left, where the setup states it.
        self.probed_work: list[Value] = [self._left(5061 + axis) for axis in range(AXES)]
        self.probe_hit: Value = self._left(5067)
        self.rendering = False
        self.position = [self._symbol(f"start.{name}") for name in AXIS_NAMES]
        self.cycle: dict[str, float] = {}
        self.cycle_code = 0
        self.compensation: Compensation | None = None
        self.transform = NO_TRANSFORM
        self.height_map_known = setup.height_map is not None
        self.following: tuple[str, ...] = ()
        if setup.height_map is not None and setup.height_map.on:
            self.following = (HEIGHT_MAP,)
        self.unhomed = setup.unhomed(machine)
        self.clamped = False
        self.drives_were_off = False
        self.jumped = False
        self.unknown_modes = frozenset[str]()
        """Modal groups that a refused line may have changed, and that no code has stated since (``refused_lines``)."""
        self.line_lost = False
        """A refused line may have moved the axes or changed what words count in."""
        self.refused_at: Span | None = None
        """That line, until a move that rests on it is told."""
        self.lost = ""
        """What nobody can follow has come: variables that nothing has set since are not known."""
        self.not_programmed: tuple[int, ...] = ()
        self.single = NO_SINGLE_STATE
        self.din = din_state.NO_DIN_STATE
        if rules.one_command:
            prepare(self)
        elif rules.source_order:
            din_state.prepare(self)

    def _symbol(self, symbol: str) -> Position:
        """The stated exact value of a symbol, or the symbol itself."""
        known = self.setup.interval(symbol)
        if known is not None and known.exact:
            kind, number, *_ = symbol.split(".")
            if kind == "tool" and number != "0" and int(number) not in self.setup.tool_lengths:
                self.zero_lengths[int(number)] = None
            return Position(known.low)
        return Position(0.0, ((symbol, 1),))

    @property
    def offset_is_stored(self) -> bool:
        """Whether #5211 to #5216 hold the G92 offset of the start: one that is in force, which G92 sets with them."""
        stated = [self.setup.interval(f"g92.{name}") for name in AXIS_NAMES]
        return any(ends is not None and (ends.low > 0.0 or ends.high < 0.0) for ends in stated)

    def _stored_offsets(self) -> list[Position]:
        """#5211 to #5216 at the start: G92.2 of an earlier job ends the offset and leaves them (3.4.23)."""
        entry = next((entry for entry in self.rules.parameters if entry.kind == "g92"), None)
        if entry is None:
            return list(self.g92)
        held = self.setup.default_offset is not None or self.offset_is_stored
        stated = [self.setup.parameters.get(entry.first + axis) for axis in range(AXES)]
        return [
            (self.g92[axis] if held else NOWHERE) if n is None else Position(n * self.machine_unit(axis))
            for axis, n in enumerate(stated)
        ]

    def _left(self, number: int) -> Value:
        """What the setup states of a variable, exactly or by bounds."""
        stated = self.setup.parameters.get(number)
        return self.stated_range(number, Unknown(f"#{number}")) if stated is None else stated

    def _stated_system(self) -> int:
        """The coordinate system that the setup states by its variable (3.1.3), 0 where it does not."""
        value = stated_system(self.rules, self.setup)
        whole = 0 if value is None else round(value)
        near = value is not None and abs(value - whole) <= self.rules.integer_tolerance
        return whole if near and 1 <= whole <= 9 else 0

    def head_at_start(self) -> int:
        """The head that the setup states: #5390 is 0 for M90, 1 for M91, 2 for M92 (3.1.1)."""
        selected = self.setup.parameters.get(5390, 0.0)
        return int(selected) if selected in (1.0, 2.0) else 0

    # -- offsets and positions

    def offset(self, axis: int) -> Position:
        """Where the program's zero of an axis lies in machine coordinates."""
        if axis in self.not_programmed or self.unknown_modes & OF_ORIGINS:
            return NOWHERE
        return self.work_offsets[self.work, axis].plus(self.g92[axis]).plus(self.beside_work(axis))

    def beside_work(self, axis: int) -> Position:
        """The offsets of what is in use, whatever the work's are: of the tool, of the head, and of machine zero."""
        if self.single.zeros:
            return self.tool_offset[axis].plus(machine_zero(self.single, axis))
        if self.head == 0:
            return self.tool_offset[axis]
        return self.tool_offset[axis].plus(head_offset(self, self.head, axis))

    def beside_tip(self, axis: int) -> Position:
        """What the position of an axis has more than the tip of the tool in the spindle, see ``State.tip``.

        Once a job uses lengths of tools its zero counts for their tips: a tool whose length is not in force then stands
        out by it all the same. Before that the zero was taken with the tool itself.
        """
        offset = self.tool_offset[axis]
        if not self.lengths_used:
            return offset
        if self.rules.one_command:
            stored = self.single.before
            return offset if stored is None or axis not in self.single.unmeasured else stored[axis]
        if axis != 2 or self.rules.source_order or self.length_tool == self.tool:
            return offset
        return NOWHERE if self.tool is None else self.length_of(self.tool)

    def zero_at_start(self, number: int, axis: int) -> Position:
        """Before anything has run: the zero of a coordinate system, local offsets included; 0: the one in force."""
        if self.rules.source_order:
            # What G54 to G58 select is the offset (McuWIN 3.19): one at a time.
            return self.work_offsets.get((number, axis), NOWHERE) if number else self.g92[axis]
        return self.work_offsets[number or self.work, axis].plus(self.g92[axis])

    def program_position(self, axis: int) -> Position:
        """The point the program is at in program coordinates, mm."""
        if axis < 2 and self.transform.on:
            return self.in_program([self.programmed(k) for k in range(AXES)])[axis]
        return self._unscaled(axis, self.programmed(axis).minus(self.offset(axis)))

    def _unscaled(self, axis: int, place: Position) -> Position:
        """A place from the zero of an axis beside X and Y, as the program has it: ``G51 P``."""
        now = self.transform
        if axis in now.loose and (place.form or place.value != 0.0):
            return NOWHERE
        if axis != 2 or now.upright == 1.0:
            return place
        return NOWHERE if place.form else Position(place.value / now.upright)

    def programmed(self, axis: int) -> Position:
        """The point the program is at, in machine coordinates: that of the contour while it is compensated."""
        comp = self.compensation
        if comp is None or comp.programmed is None or axis not in comp.axes:
            return self.position[axis]
        return comp.programmed[comp.axes.index(axis)]

    @property
    def xz_mirrored(self) -> bool:
        """True where G2 and G3 look at the active plane from its negative side (turning machines)."""
        return self.plane is Plane.XZ and self.machine.controller.xz_seen_from == "-y"

    @property
    def xz_view_open(self) -> bool:
        """True on a lathe where nobody stated from which side its arcs are seen (manual 3.4.3 against 3.4.11.2)."""
        controller = self.machine.controller
        return self.plane is Plane.XZ and controller.turning and controller.xz_seen_from is None

    @property
    def plain_motion(self) -> bool:
        """True where straight moves mean what ``run_lines`` makes of them, but for feeds (``open_feeds``); arcs do
        where ``arcs_known`` holds too."""
        return self.compensation is None and self._plain_ways and self.feeds_plain and self.modes_known

    @property
    def plain_contour(self) -> bool:
        """True where ``run_lines`` makes of lines what the program asks for, whether or not it is compensated."""
        return (
            self._plain_ways
            and not self.feed_unknown
            and self.refused_at is None
            and not self.unknown_modes - {SPINDLE}
            and self.arcs_known
        )

    @property
    def _plain_ways(self) -> bool:
        return not (
            self.xz_mirrored
            or self.xz_view_open
            or self.transform_in_doubt
            or self.drives_were_off
            or self.jumped
        )  # fmt: skip

    @property
    def modes_known(self) -> bool:
        """True where no refused line leaves open what straight moves mean, or waits to be told with a move."""
        return self.refused_at is None and not self.unknown_modes & (OF_PLACES | {MOTION})

    @property
    def arcs_known(self) -> bool:
        """True where no refused line leaves open what arcs mean besides, nor where they begin."""
        # From nowhere an arc goes nowhere: whether its ends fit nobody can say.
        return not self.unknown_modes & OF_ARCS and all(place.form != UNKNOWN for place in self.position)

    @property
    def feeds_plain(self) -> bool:
        """True where the feed of rows is that of their words, or not known for all of them (``feed_unknown``)."""
        return not self.feed_input and (not self.unknown_modes & OF_FEEDS or math.isnan(self.feed))

    @property
    def transform_in_doubt(self) -> bool:
        """True where nobody knows what G68 or G51 make of X and Y, or will not as soon as they move."""
        now = self.transform
        return now.on and (bool(now.open) or now.origin != (self.offset(0), self.offset(1)))

    def in_program(self, places: list[Position]) -> list[Position]:
        """Machine positions of all axes in program coordinates, mm."""
        found = [place.minus(self.offset(axis)) for axis, place in enumerate(places)]
        if self.transform.on:
            found[:2] = self.transform.program((places[0], places[1]), (self.offset(0), self.offset(1)))
        found[2:] = [self._unscaled(axis, found[axis]) for axis in range(2, AXES)]
        return found

    def scale(self, axis: int) -> float:
        """mm (or degrees) in one program unit of an axis; X numbers may be diameters (2.1.14)."""
        if axis == 0 and self.machine.controller.diameter_programming:
            return self.unit * 0.5
        return self.unit if self.linear[axis] else 1.0

    def _retimed(self) -> tuple[str, ...]:
        names = self.single.retimed
        in_words = not self.rules.one_command and not self.rules.source_order
        if in_words and self.feed_unit != self.unit and self.feed and self.feed_mode != 93:
            # The same number a minute, or the same length (Eding 3.4.7 has neither).
            names |= {OTHER_UNIT}
        return tuple(sorted(names))

    @property
    def feed_unknown(self) -> bool:
        """True while an override that the program set changes feeds by a factor nobody knows, or what they count in was
        lost with a refused line."""
        return self.feed_input or math.isnan(self.feed_override) or bool(self.unknown_modes & OF_FEEDS)

    def has_axis(self, axis: int) -> bool:
        """True when the machine has that axis."""
        return self.axis_there[axis]

    def row_state(self) -> State:
        """The slow columns of the rows that come now."""
        surface = 0.0
        if self.surface_speed_mode:
            surface = math.nan if isinstance(self.spindle_speed, Unknown) else self.spindle_speed
        comp = self.compensation
        return State(
            tool=-1 if self.tool is None else self.tool, spindle=commanded_rpm(self) * self.spindle_direction,
            feed_mode=self.feed_mode, synchronised=self.pitch != 0.0, surface_speed=surface,
            feed_override=math.nan if self.feed_unknown else self.feed_override, head=self.head,
            spindle_limit=self.spindle_limit, path_mode=self.path_mode, path_tolerance=self.path_tolerance,
            simplify=self.simplify, laf_angle=self.laf_angle, work=self.work, overrides=self.overrides,
            arc_tolerance=self.arc_tolerance(), guards_off=self.guards_off,
            compensation=0 if comp is None else comp.side * comp.plane,
            following=self.following, boundaries=self._boundaries(), tip=self._tip(), machine_tip=self._machine_tip(),
            diameters=self._diameters(), retimed=self._retimed(), backlash=self.single.backlash,
        )  # fmt: skip

    def _tip(self) -> tuple[TipOffset, ...]:
        if not self.lengths_used and self.tool_offset == NO_OFFSET:
            return ()
        places = [(axis, self.beside_tip(axis)) for axis in range(AXES)]
        return tuple(TipOffset(axis, place.value, place.form) for axis, place in places if place != ZERO)

    def _machine_tip(self) -> tuple[TipOffset, ...] | None:
        """See ``State.machine_tip``."""
        if not self.rules.measured_tools:
            return None
        if self.single.reference is None:
            return ()
        places = [(axis, self.beside_tip(axis).minus(there)) for axis, there in enumerate(self.single.reference)]
        return tuple(TipOffset(axis, place.value, place.form) for axis, place in places if place != ZERO)

    def _diameters(self) -> tuple[ToolDiameter, ...]:
        """What program and setup have written over the tool table, see ``State.diameters``."""
        if self.rules.one_command:
            return self.single.diameters if self.tool is None else tuple(
                each for each in self.single.diameters if each.tool == self.tool)  # fmt: skip
        first, last = self._tool_table
        found = []
        for number in range(1, last - first + 2) if self.tool is None else (self.tool,):
            variable = TOOL_DIAMETER + number
            if not first <= variable <= last:
                continue
            if not any(variable in those for those in
                       (self.parameters, self.setup.parameters, self.setup.parameter_ranges)):  # fmt: skip
                continue
            # A negative one is that of a tool on the other side of the contour (Eding manual 5.3).
            ends = bounds(self.tool_diameter(number))
            low, high = sorted(map(abs, ends))
            found.append(ToolDiameter(number, 0.0 if ends[0] < 0.0 < ends[1] else low, high))
        return tuple(found)

    def _boundaries(self) -> tuple[Boundary, ...]:
        """What rows carry of limits that a program may set."""
        if self.rules.one_command:
            return boundaries_of(self)
        return din_state.limits_of(self) if self.rules.source_order else ()

    def arc_tolerance(self) -> float:
        """mm by which the radii at start and end of an arc may differ, in the units that are active."""
        if self.rules.source_order:
            return din_state.din_of(self.machine).arc_tolerance
        stated = self.machine.settings.arc_tolerance
        if stated is not None:
            return stated * self.transform.arc_tolerance
        tolerance = self.rules.arc_tolerance_inch * INCH if self.unit == INCH else self.rules.arc_tolerance_mm
        return tolerance * self.transform.arc_tolerance

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

        Positions are in program units; offsets, limits and tools in the machine's own unit.
        """
        whole, entry = self.range_of(number, span)
        if entry.kind == "system":
            # Whatever a program puts there, the controller may change it.
            name = self.rules.name_of(whole)
            return Unknown(f"{name} of the controller")
        if whole in self.parameters:
            return self.parameters[whole]
        if self.lost and entry.kind in ("free", "persistent"):
            return Unknown(self.lost)
        if self.unknown_modes and entry.kind not in ("free", "persistent"):
            return Unknown(f"{self.rules.name_of(whole)} behind a refused line")
        show = _SHOWN.get(entry.kind)
        value: Value | None = self.setup.parameters.get(whole) if entry.kind in _STATED_FIRST else None
        if value is not None:
            pass
        elif entry.kind in _STATED_FIRST and whole in self.setup.parameter_ranges:
            value = self.stated_range(whole, Unknown(f"#{whole}"))
        elif show is not None:
            value = show(self, whole, whole - entry.first)
        elif entry.kind in ("free", "persistent", "park_1", "park_2", "rotation"):
            value = self.setup.parameter(whole)
        else:
            value = self.setup.parameters.get(whole)
        if value is None:
            value = self.stated_range(whole, Unknown(self.rules.name_of(whole)))
        return self._either_unit(whole, entry, value)

    def _either_unit(self, number: int, entry: ParameterRange, value: Value, written: bool = False) -> Value:
        """The value in the controller's own unit or in the program's, where these differ: no section says which.

        written: what a program writes; the result is in the controller's unit.
        """
        if self.unit == self.machine.unit or not _has_length(entry, number):
            return value
        factor = self.machine.unit / self.unit
        if written or entry.kind in _PROGRAM_UNIT:
            factor = 1.0 / factor
        low, high = bounds(value)
        ends = low, high, low * factor, high * factor
        cause = value.cause if isinstance(value, Unknown) else f"#{number}, in mm or in inches,"
        return between(cause, (min(ends), max(ends)))

    def machine_unit(self, axis: int) -> float:
        """mm (or degrees) in one of the controller's own units of an axis."""
        return self.machine.unit if axis < 3 else 1.0

    def plain(self, at: Position, unit: float, number: int) -> Value:
        """A position as a number, with the bounds of what it rests on."""
        if not at.form:
            return at.value / unit
        low = high = at.value
        largest = abs(at.value)
        for symbol, coefficient in at.form:
            known = self.ranges.get(symbol) or self.setup.interval(symbol)
            if known is None:
                return Unknown(f"#{number}")
            ends = (known.low * coefficient, known.high * coefficient)
            low, high = low + min(ends), high + max(ends)
            largest = max(largest, *map(abs, ends), abs(low), abs(high))
        # Another order of the same sums rounds differently.
        slack = 16 * math.ulp(largest)
        return Unknown(f"what #{number} shows", *widened((low - slack) / unit, (high + slack) / unit))

    def shown(self, number: int, axis: int, at: Position, origin: Position) -> Value:
        """What a variable shows of a machine place: its coordinate from an origin."""
        value = self.plain(at.minus(origin), self.scale(axis), number)
        if not isinstance(value, Unknown):
            return value
        found = at_place(value, axis, at, origin, self.scale(axis))
        return found if found.place is None or found.bounded else replace(found, cause=f"what #{number} shows")

    def shown_position(self, number: int, axis: int) -> Value:
        """What #5001 to #5006 show: the point the program is at."""
        now = self.transform
        if (axis < 2 and self.transform.on) or axis in now.loose or (axis == 2 and now.upright != 1.0):
            return self.plain(self.program_position(axis), self.scale(axis), number)
        return self.shown(number, axis, self.programmed(axis), self.offset(axis))

    def write(self, number: float, value: Value, span: Span) -> None:
        """Set a numbered variable; Refusal GP227 for one that shows the machine's state."""
        whole, entry = self.range_of(number, span)
        if not entry.writable:
            raise Refusal(codes.READ_ONLY_PARAMETER.at(span, number=whole, meaning=entry.meaning))
        value = self._either_unit(whole, entry, value, written=True)
        axis = whole - entry.first
        if entry.kind not in ("work", "g92"):
            self.parameters[whole] = value
            return
        place = NOWHERE if isinstance(value, Unknown) else Position(value * self.machine_unit(axis))
        if entry.kind == "g92":
            self.g92_stored[axis] = place
            return
        system = (entry.first - 5221) // 20 + 1
        self.written_work[system, axis] = place
        if self.work == 0:
            self.work_offsets[0, axis] = NOWHERE
        elif self.work != system:
            self.work_offsets[system, axis] = place

    def offset_in_use(self, number: int) -> bool:
        """True when a written number belongs to an offset that is on; the axis then counts as standing anywhere.

        A new zero of a coordinate system acts when a system is selected, a G92 offset with G92.3: whether it acts at
        once besides, no section says.
        """
        whole, entry = self.range_of(number, Span("", 0))
        axis = whole - entry.first
        if entry.kind == "g92":
            self.g92[axis] = NOWHERE
            return True
        if entry.kind == "work" and self.work == (entry.first - 5221) // 20 + 1:
            self.work_offsets[self.work, axis] = NOWHERE
            return True
        return False

    def use_written_work(self) -> None:
        """A coordinate system is selected: zeros that were written are in force."""
        self.work_offsets.update(self.written_work)
        self.written_work = {}

    def stated_range(self, number: int, otherwise: Unknown) -> Value:
        """What the setup says that a variable will hold when the machine has asked or measured it."""
        stated = self.setup.parameter_ranges.get(number)
        return otherwise if stated is None else between(otherwise.cause, (stated.low, stated.high))

    # -- the tool table (3.1.2): the setup's lengths, the machine file's entries, what the program has written

    def length_of(self, tool: int) -> Position:
        """The length of a tool by the table, the setup, or as an unknown of its own."""
        if tool == 0:
            return ZERO
        written = self.parameters.get(TOOL_LENGTH + tool)
        if written is not None:
            return NOWHERE if isinstance(written, Unknown) else Position(written * self.machine.unit)
        if tool in self.setup.tool_lengths:
            return self._symbol(f"tool.{tool}.z")
        stated = self.setup.parameters.get(TOOL_LENGTH + tool)
        if stated is not None:
            return Position(stated * self.machine.unit)
        if TOOL_LENGTH + tool in self.setup.parameter_ranges:
            return NOWHERE
        entry = self.machine.tool(tool)
        if entry is not None and entry.length is not None:
            return Position(entry.length)
        return self._symbol(f"tool.{tool}.z")

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

    # -- copies, for the outcomes of a branch

    def lose_all(self, what: str) -> None:
        """Behind what nobody can follow neither the places of axes nor the values of variables are known."""
        self.position = [NOWHERE if self.has_axis(axis) else place for axis, place in enumerate(self.position)]
        self.jumped = True
        self.lost = what
        self.parameters.update({number: Unknown(what) for number in self.parameters})

    def copy(self) -> Modal:
        """An independent copy; values are immutable, containers are copied one level deep."""
        other = copy.copy(self)
        for name, value in vars(self).items():
            if isinstance(value, dict | list | set) and name not in _CONSTANT:
                setattr(other, name, value.copy())
        return other

    def key(
        self, *, parameters: bool = True, probed: bool = True, position: bool = True,
        without: frozenset[int] = NO_NUMBERS,
    ) -> object:  # fmt: skip
        """Equal for equal states: all that can change in a run, in a fixed order; with or without (some of) the
        variables, what the last probing move has left, and where the axes are.

        Unknowns that arose in the run, each between the same ends, may have other names: what follows is the same.
        """
        left_out = _OTHER if probed else _OTHER_OR_PROBED
        left_out = left_out if position else left_out | {"position"}
        named = [(name, self._fixed(name, value)) for name, value in sorted(vars(self).items()) if name not in left_out]
        names: dict[str, str] = {}
        found = [self._renamed(name, value, names) for name, value in named]
        if parameters:
            for number in sorted(self.parameters):
                if number not in without:
                    found += (number, self.parameters[number])
        return StateKey(tuple(found))

    def _fixed(self, name: str, value: object) -> object:
        """A field as something that can be a part of a key: the same object for as long as it does not change."""
        if not isinstance(value, dict | list | set):
            return value
        known = self.fixed.get(name)
        if known is not None and known[0] == value:
            return known[1]
        made = _fixed(value)
        self.fixed[name] = value.copy(), made
        return made

    def spread(self, place: Position) -> tuple[Affine, float, float] | None:
        """Unknown offsets that a place rests on, and between what it lies beside them (mm or degrees) by the bounds of
        the unknowns that arose in the run; None where one of these has no bounds."""
        low = high = place.value
        rest = []
        for symbol, coefficient in place.form:
            ends = self.ranges.get(symbol)
            if ends is None:
                if _ARISING.fullmatch(symbol) or (symbol, coefficient) in UNKNOWN:
                    return None
                rest.append((symbol, coefficient))
                continue
            low += min(ends.low * coefficient, ends.high * coefficient)
            high += max(ends.low * coefficient, ends.high * coefficient)
        return tuple(rest), low, high

    def _renamed(self, name: str, value: object, names: dict[str, str]) -> object:
        """A field with the unknowns that arose in the run counted as they come; as it is where there are none."""
        known = self.texts.get(name)
        if known is None or known[0] is not value:
            # The order in a set is not always the same.
            text = repr(sorted(map(repr, value))) if isinstance(value, frozenset) else repr(value)
            known = self.texts[name] = value, _ARISING.split(text)
        parts = known[1]
        if len(parts) == 1:
            return value
        out = parts.copy()
        for n in range(1, len(parts), 2):
            kind, _, axis = parts[n].split(".")
            out[n] = names.setdefault(parts[n], f"{kind} {len(names)} {axis} {self.ranges.get(parts[n])!r}")
        return "".join(out)

    def park_position(self, kind: str, axis: int) -> Position:
        """The G28 or G30 point of an axis in machine coordinates; parameters are in the machine's unit."""
        value = self.read(float(_PARK_DEFAULTS[kind] + axis), Span("", 0))
        return NOWHERE if isinstance(value, Unknown) else Position(value * self.machine_unit(axis))


_STATED_FIRST = ("head_offset", "head_speed", "probe_input", "hand_wheel")
"""Kinds of which the setup's own statement counts before what follows from other places."""
_PROGRAM_UNIT = ("machine_position", "probe_machine")
"""Kinds whose values are made in the program's unit, and of which only the machine's would be another reading."""
_BY_AXIS = (
    "machine_position", "probe_machine", "park_1", "park_2", "g92", "work", "lower_limit", "upper_limit",
    "home_position", "area_lower", "area_upper",
)  # fmt: skip
_BY_TOOL = (
    "tool_radius", "tool_z", "tool_x", "offset_z", "offset_x", "tool_length", "tool_diameter", "tool_x_offset",
    "head_offset",
)  # fmt: skip


def stated_system(rules: LanguageRules, setup: Setup) -> float | None:
    """What the setup states of the variable that shows the active coordinate system (Eding #5220), None for nothing."""
    numbers = (entry.first for entry in rules.parameters if entry.kind == "work_number")
    return next((setup.parameters[n] for n in numbers if n in setup.parameters), None)


def _length_now(setup: Setup) -> tuple[Interval, ...]:
    """The length in force when the job begins, where it is stated."""
    return (setup.tool_lengths[0],) if 0 in setup.tool_lengths else ()


def _has_length(entry: ParameterRange, number: int) -> bool:
    """True when a variable holds a length in a unit that no section names."""
    return entry.kind in _BY_TOOL or (entry.kind in _BY_AXIS and number - entry.first < 3)


def _fixed(value: object) -> object:
    """A container as something that can be a key."""
    if isinstance(value, dict):
        return frozenset(value.items())
    if isinstance(value, set):
        return frozenset(value)
    return tuple(value) if isinstance(value, list) else value


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


_SHOWN: dict[str, Callable[[Modal, int, int], Value]] = {
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
    "work": lambda m, n, k: m.plain(m.work_offsets[(n - 5221) // 20 + 1, k], m.machine_unit(k), n),
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
