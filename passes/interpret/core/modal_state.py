"""The modal state of a running program: positions, offsets, modes, and the variables that show them."""

from __future__ import annotations

import math
from dataclasses import replace

from gproof.ir import codes
from gproof.ir.finding import Refusal, Span
from gproof.ir.intervals import widened
from gproof.ir.machine import AXES, AXIS_NAMES, Machine
from gproof.ir.modal_groups import MOTION, OF_ARCS, OF_FEEDS, OF_ORIGINS, OF_PLACES, SPINDLE
from gproof.ir.rules import LanguageRules, ParameterRange
from gproof.ir.setup import Interval, Setup
from gproof.ir.symbolic import NOWHERE, Position, Unknown, Value, at_place, between, bounds
from gproof.ir.trace import (
    HEIGHT_MAP,
    OTHER_UNIT,
    UNKNOWN,
    Boundary,
    PathMode,
    Plane,
    State,
    TipOffset,
    ToolDiameter,
)
from gproof.passes.interpret.core.cutter_compensation import Compensation
from gproof.passes.interpret.core.heads import head_offset
from gproof.passes.interpret.core.plane_transform import NO_TRANSFORM
from gproof.passes.interpret.core.shown_variables import PROGRAM_UNIT, SHOWN, STATED_FIRST, has_length, stated_system
from gproof.passes.interpret.core.spindle_speed import commanded_rpm
from gproof.passes.interpret.core.state_key import Keyed
from gproof.passes.interpret.core.tool_table import TOOL_DIAMETER, ToolTable

INCH = 25.4
ZERO = Position(0.0)
LENGTHS = (True, True, True, False, False, False)
NO_OFFSET = [ZERO] * AXES

_PARK_DEFAULTS = {"park_1": 5161, "park_2": 5181}


class Modal(Keyed, ToolTable):
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
        self.linear = self._linear_axes()
        self._tool_table = next(((e.first, e.last) for e in rules.parameters if e.kind == "tool_diameter"), (0, -1))
        self._begin_modes()
        self._begin_tool_and_spindle()
        self._begin_offsets()
        self._begin_places()
        self._begin_doubts()

    def _begin_modes(self) -> None:
        machine = self.machine
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

    def _begin_tool_and_spindle(self) -> None:
        setup = self.setup
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
        self.head: int = self.head_at_start()
        self.head_offsets: dict[tuple[int, int], Position] = {}
        self.mist = False
        self.flood = False
        self.overrides = True
        self.guards_off: tuple[str, ...] = ()
        self.tool: int | None = setup.tool
        self.selected_tool: int | None = setup.tool
        self.length_follows_tool = False
        self.offset_tool: int | None = None

    def _begin_offsets(self) -> None:
        setup = self.setup
        in_force = self.symbol("tool.0.z")
        # With none in force the tool is out all the same; one that is not stated is taken for the tool's own.
        self.length_tool: int | None = 0 if in_force == ZERO else setup.tool
        self.lengths_used = any(not ends.exact or ends.low for ends in (*setup.measures.values(), *_length_now(setup)))
        self.stated: set[str] = {"spindle"} if setup.default_parameter is not None else set()
        self.work: int = setup.active_work if setup.active_work is not None else self._stated_system()
        self.parameters: dict[int, Value] = {}
        # Outputs whose states are known: (channel, state).
        self.outputs: tuple[tuple[int, Value], ...] = ()
        # Tools of which no file states the length that the setup takes as 0.
        self.zero_lengths: dict[int, None] = {}
        self.work_offsets: dict[tuple[int, int], Position] = {
            (n, a): self.symbol(f"work.{n}.{AXIS_NAMES[a]}") for n in range(10) for a in range(AXES)
        }
        self.written_work: dict[tuple[int, int], Position] = {}
        self.g92 = [self.symbol(f"g92.{name}") for name in AXIS_NAMES]
        self.g92_stored: list[Position] = self._stored_offsets()
        self.tool_offset: list[Position] = list(NO_OFFSET)
        if setup.default_offset is None:
            self.tool_offset[2] = self.symbol("tool.0.z")
        self.ranges: dict[str, Interval] = {}

    def _begin_places(self) -> None:
        setup = self.setup
        self.probed: list[Position] = [NOWHERE] * AXES
        # Before the first probing move: what an earlier job has left, where the setup states it.
        self.probed_work: list[Value] = [self._left(5061 + axis) for axis in range(AXES)]
        self.probe_hit: Value = self._left(5067)
        self.rendering: bool = False
        self.position: list[Position] = [self.symbol(f"start.{name}") for name in AXIS_NAMES]
        self.cycle: dict[str, float] = {}
        self.cycle_code = 0
        self.compensation: Compensation | None = None
        self.transform = NO_TRANSFORM
        self.height_map_known = setup.height_map is not None
        self.following: tuple[str, ...] = ()
        if setup.height_map is not None and setup.height_map.on:
            self.following = (HEIGHT_MAP,)

    def _begin_doubts(self) -> None:
        self.unhomed = self.setup.unhomed(self.machine)
        self.clamped = False
        self.drives_were_off = False
        self.jumped = False
        self.unknown_modes = frozenset[str]()
        """Modal groups that a refused line may have changed, and that no code has stated since (``refused_lines``)."""
        self.line_lost = False
        """A refused line may have moved the axes or changed what words are measured in."""
        self.refused_at: Span | None = None
        """That line, until a move that rests on it is reported."""
        self.lost = ""
        """What nobody can follow has come: variables that nothing has set since are not known."""
        self.not_programmed: tuple[int, ...] = ()

    def _linear_axes(self) -> tuple[bool, ...]:
        """By column: whether the axis is measured in lengths."""
        return LENGTHS

    def symbol(self, symbol: str) -> Position:
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
        """Where the program's zero of an axis is in machine coordinates."""
        if axis in self.not_programmed or self.unknown_modes & OF_ORIGINS:
            return NOWHERE
        return self.work_offsets[self.work, axis].plus(self.g92[axis]).plus(self.beside_work(axis))

    def beside_work(self, axis: int) -> Position:
        """The offsets of what is in use, whatever the work's are: of the tool, of the head, and of machine zero."""
        if self.head == 0:
            return self.tool_offset[axis]
        return self.tool_offset[axis].plus(head_offset(self, self.head, axis))

    def beside_tip(self, axis: int) -> Position:
        """What the position of an axis has more than the tip of the tool in the spindle, see ``State.tip``.

        Once a job uses lengths of tools its zero counts for their tips: a tool whose length is not in force then is
        out by it all the same. Before that the zero was taken with the tool itself.
        """
        offset = self.tool_offset[axis]
        if not self.lengths_used:
            return offset
        if axis != 2 or self.length_tool == self.tool:
            return offset
        return NOWHERE if self.tool is None else self.length_of(self.tool)

    def zero_at_start(self, number: int, axis: int) -> Position:
        """Before anything has run: the zero of a coordinate system, local offsets included; 0: the one in force."""
        return self.work_offsets[number or self.work, axis].plus(self.g92[axis])

    def program_position(self, axis: int) -> Position:
        """The point the program is at in program coordinates, mm."""
        if axis < 2 and self.transform.on:
            return self.in_program([self.programmed(k) for k in range(AXES)])[axis]
        return self._unscaled(axis, self.programmed(axis).minus(self.offset(axis)))

    def _unscaled(self, axis: int, place: Position) -> Position:
        """A place from the zero of an axis other than X and Y, as the program has it: ``G51 P``."""
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
        """True on a lathe where it is not stated from which side its arcs are seen (manual 3.4.3 against 3.4.11.2)."""
        controller = self.machine.controller
        return self.plane is Plane.XZ and controller.turning and controller.xz_seen_from is None

    @property
    def plain_motion(self) -> bool:
        """True where straight moves mean what ``run_lines`` makes of them, but for feeds (``open_feeds``); arcs do
        where ``arcs_known`` holds too."""
        return self.compensation is None and self._plain_ways and self.feeds_plain and self.modes_known

    @property
    def plain_contour(self) -> bool:
        """True where ``run_lines`` makes of lines what the program requires, whether or not it is compensated."""
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
        """True where no refused line leaves open what straight moves mean, or waits to be reported with a move."""
        return self.refused_at is None and not self.unknown_modes & (OF_PLACES | {MOTION})

    @property
    def arcs_known(self) -> bool:
        """True where no refused line leaves open what arcs mean besides, nor where they start."""
        # From nowhere an arc goes nowhere: whether its ends fit nobody can say.
        return not self.unknown_modes & OF_ARCS and all(place.form != UNKNOWN for place in self.position)

    @property
    def feeds_plain(self) -> bool:
        """True where the feed of rows is that of their words, or not known for all of them (``feed_unknown``)."""
        return not self.feed_input and (not self.unknown_modes & OF_FEEDS or math.isnan(self.feed))

    @property
    def transform_in_doubt(self) -> bool:
        """True where it is not known what G68 or G51 make of X and Y, or will not be as soon as they move."""
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
        # The same number a minute, or the same length (Eding 3.4.7 has neither).
        open_unit = self.feed_unit != self.unit and self.feed and self.feed_mode != 93
        return (OTHER_UNIT,) if open_unit else ()

    @property
    def feed_unknown(self) -> bool:
        """True while an override that the program set changes feeds by an unknown factor, or what they are measured in
        was lost with a refused line."""
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
            diameters=self._diameters(), retimed=self._retimed(), backlash=self._backlash(),
        )  # fmt: skip

    def _tip(self) -> tuple[TipOffset, ...]:
        if not self.lengths_used and self.tool_offset == NO_OFFSET:
            return ()
        places = [(axis, self.beside_tip(axis)) for axis in range(AXES)]
        return tuple(TipOffset(axis, place.value, place.form) for axis, place in places if place != ZERO)

    def _machine_tip(self) -> tuple[TipOffset, ...] | None:
        """See ``State.machine_tip``."""
        return None

    def _backlash(self) -> tuple[tuple[int, float], ...]:
        """See ``State.backlash``."""
        return ()

    def _diameters(self) -> tuple[ToolDiameter, ...]:
        """What program and setup have written over the tool table, see ``State.diameters``."""
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
        return ()

    def arc_tolerance(self) -> float:
        """mm by which the radii at start and end of an arc may differ, in the units that are active."""
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
        allowed = "use a parameter of the manual's list (3.1.1)"
        raise Refusal(codes.PARAMETER_NUMBER.at(span, value=number, allowed=allowed))

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
            return Unknown(f"{self.rules.name_of(whole)} after a refused line")
        show = SHOWN.get(entry.kind)
        value: Value | None = self.setup.parameters.get(whole) if entry.kind in STATED_FIRST else None
        if value is not None:
            pass
        elif entry.kind in STATED_FIRST and whole in self.setup.parameter_ranges:
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
        if self.unit == self.machine.unit or not has_length(entry, number):
            return value
        factor = self.machine.unit / self.unit
        if written or entry.kind in PROGRAM_UNIT:
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

    # -- copies, for the outcomes of a branch

    def lose_all(self, what: str) -> None:
        """After something that cannot be followed, neither the places of axes nor the values of variables are known."""
        self.position = [NOWHERE if self.has_axis(axis) else place for axis, place in enumerate(self.position)]
        self.jumped = True
        self.lost = what
        self.parameters.update({number: Unknown(what) for number in self.parameters})

    # -- what a language keeps besides (its own class of this one)

    @property
    def has_offset_path(self) -> bool:
        """True while the tool is offset from the programmed contour."""
        return self.compensation is not None

    @property
    def axes_are_bound(self) -> bool:
        """True where axes do more or less than their words say, though these are known."""
        return False

    @property
    def feeds_known(self) -> bool:
        """True where no feed that the language keeps besides is lost."""
        return True

    def forget(self, lost: frozenset[str], cause: str) -> None:
        """Leave nothing of these modal groups in what the language keeps besides."""

    def park_position(self, kind: str, axis: int) -> Position:
        """The G28 or G30 point of an axis in machine coordinates; parameters are in the machine's unit."""
        value = self.read(float(_PARK_DEFAULTS[kind] + axis), Span("", 0))
        return NOWHERE if isinstance(value, Unknown) else Position(value * self.machine_unit(axis))


def _length_now(setup: Setup) -> tuple[Interval, ...]:
    """The length in force when the job starts, where it is stated."""
    return (setup.tool_lengths[0],) if 0 in setup.tool_lengths else ()
