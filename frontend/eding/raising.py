"""Program -> Job for Eding CNC (RS274/NGC). Sections are those of the Eding CNC manual 4.01."""

from __future__ import annotations

from dataclasses import replace

from gproof.frontend.common.raising import Line, Raiser, Unraisable
from gproof.frontend.common.raising_modes import UNKNOWN_MODE, LineWord, Modes
from gproof.frontend.eding.raising_inputs import by_inputs
from gproof.ir.finding import Span
from gproof.ir.job import (
    AllowOverrides,
    ArcTo,
    AxisPlace,
    ChangeTool,
    Compensate,
    DrillHole,
    DwellFor,
    EndJob,
    Feed,
    HomeAxes,
    Job,
    Moves,
    MoveTo,
    Node,
    ParkAt,
    PauseJob,
    Quantity,
    RunRoutine,
    SetFeed,
    SetFrame,
    SetPathMode,
    SetVariable,
    ShowText,
    SwitchCoolant,
    SwitchGuard,
    SwitchOutput,
    TurnSpindle,
    UseLength,
    WaitFor,
)
from gproof.ir.job_diameters import x_times
from gproof.ir.machine import AXIS_NAMES, Machine
from gproof.ir.program import Binary, Call, Device, Expr, Guard, Message, Number, Program, Statement, Text, Variable
from gproof.ir.rules import CodeRule
from gproof.ir.rules import Function as F

AXES = {name.upper(): name for name in AXIS_NAMES}
PLANES = {F.PLANE_XY: "xy", F.PLANE_XZ: "xz", F.PLANE_YZ: "yz"}
CYCLES = {
    F.DRILL: "drill", F.DRILL_DWELL: "dwell", F.DRILL_PECK: "peck", F.DRILL_CHIP_BREAK: "chip_break",
    F.BORE: "bore", F.BORE_DWELL: "bore_dwell", F.BORE_STOP: "bore_stop", F.TAP_RIGHT: "tap_right",
    F.TAP_LEFT: "tap_left",
}  # fmt: skip
"""Canned cycles (3.4.21); G87 and G88 need the operator, or a tool that no other controller describes."""
PER = {F.FEED_PER_MINUTE: "minute", F.FEED_PER_REVOLUTION: "revolution", F.FEED_INVERSE_TIME: "move"}
SPINDLE = {F.SPINDLE_CW: "cw", F.SPINDLE_CCW: "ccw", F.SPINDLE_OFF: "off"}
DEPTH = {"xy": "Z", "xz": "Y", "yz": "X"}
OWN_CODES = frozenset((F.TOOL_CHANGE, *SPINDLE, F.MIST_ON, F.FLOOD_ON, F.COOLANT_OFF))
"""Codes that a machine's macros may replace (4.4) and that mean the same device on any machine."""
OFFSETS = {
    F.AXIS_OFFSET_SET: "local_here", F.AXIS_OFFSET_RESET: "local_off", F.AXIS_OFFSET_SUSPEND: "local_suspend",
    F.AXIS_OFFSET_RESTORE: "local_restore",
}  # fmt: skip
PATHS = {F.EXACT_PATH: "exact_path", F.EXACT_STOP: "exact_stop", F.CONTINUOUS: "continuous"}


class Words:
    """The words of a line: codes by group, and all others by letter, each used once."""

    def __init__(self, line: Line, raiser: EdingRaiser) -> None:
        self.rules: list[CodeRule] = []
        self.values: dict[str, LineWord] = {}
        for word in line:
            if word.letter in raiser.program.rules.code_letters:
                number = word.number
                if number is None:
                    raise Unraisable(f"{word.letter} with a computed number", "which code it is, is not known")
                rule = raiser.rule(word.letter, number)
                if rule is None:
                    raise Unraisable(f"{word.letter}{number:g}", "the language has no such code")
                self.rules.append(rule)
            elif word.letter != "N":
                self.values[word.letter] = word

    def find(self, *functions: F) -> CodeRule | None:
        """The code with one of these functions."""
        return next((rule for rule in self.rules if rule.function in functions), None)

    def group(self, name: str) -> CodeRule | None:
        """The code of a modal group."""
        return next((rule for rule in self.rules if rule.group == name), None)

    def take(self, letter: str) -> Expr | None:
        """The value of a letter, which is used by that."""
        word = self.values.pop(letter, None)
        return None if word is None else word.value

    def need(self, letter: str, code: str) -> Expr:
        """The value of a letter that a code must have."""
        value = self.take(letter)
        if value is None:
            raise Unraisable(code, f"{letter} is missing")
        return value

    @property
    def has_axes(self) -> bool:
        """Whether an axis word is not used yet."""
        return any(letter in AXES for letter in self.values)


class EdingRaiser(Raiser):
    """Lines in the order of table 3-7."""

    def first_modes(self) -> Modes:
        """The modes at the start of a job (3.3, table 3-3: the first code of each group)."""
        return Modes(plane="xz" if self.machine.controller.turning else "xy")

    # ---- lines

    def line(self, words: Line, span: Span) -> list[Node]:
        """What a line does, in the order of table 3-7."""
        replaced = self._replaced(words, span)
        if replaced is not None:
            return replaced
        line = Words(words, self)
        known = line.find(F.UNSUPPORTED)
        if known is not None:
            raise Unraisable(known.text, known.open or "the manual does not describe it")
        found: list[Node] = []
        feed = self._feed(line)
        found += self._tool_and_spindle(line, span)
        found += self._outputs(line, span)
        if line.find(F.DWELL):
            found.append(DwellFor(time=Quantity(line.need("P", "G4"), "s"), span=span))
        self._plane_and_units(line)
        found += self._tool_geometry(line, span)
        found += self._frames(line, span)
        found += self._path(line, span)
        self._distances(line)
        found += self._transform(line, span)
        found += self._group_zero(line, span)
        found += self._motion(line, span, feed)
        found += self._stop(line, span)
        left = [letter for letter in line.values if letter not in "DH"]
        if left:
            raise Unraisable(f"{left[0]} in this line", "no code of the line takes it")
        return found

    def _replaced(self, words: Line, span: Span) -> list[Node] | None:
        """A line whose code a subprogram of the machine replaces (4.4); None where it is the controller's own."""
        for word in words:
            if word.number is None or word.letter not in "GM":
                continue
            name = self.program.overrides.get((word.letter, round(word.number * 10)))
            rule = self.rule(word.letter, word.number)
            if name is None or (rule is not None and rule.function in OWN_CODES):
                continue
            if len([w for w in words if w.letter in "GM"]) > 1:
                raise Unraisable(f"{word.letter}{word.number:g}", "other codes are on the line of a replaced code")
            base, missing = self.program.rules.argument_base, self.program.rules.argument_missing
            given = {w.letter: w.value for w in words if w.letter not in "GMN"}
            arguments: list[Node] = []
            for place in range(26):
                letter = chr(ord("A") + place)
                value = given.get(letter, Number(missing, span))
                target = Variable(Number(float(base + place), span), span)
                if letter in given or _mentions(self.program.subprograms[name].body, base + place):
                    arguments.append(SetVariable(target=target, value=value, span=span))
            return [*arguments, self.run_routine(name, span)]
        return None

    def _feed(self, line: Words) -> Feed | None:
        """F, read in the units and the feed mode before this line's units (steps 2 and 3)."""
        assert self.modes is not None
        rule = line.group("G5")
        if rule is not None:
            self.modes = replace(self.modes, per=PER[rule.function])
        value = line.take("F")
        if value is None:
            return None
        if UNKNOWN_MODE in {self.modes.per, self.modes.unit}:
            raise Unraisable("F", "what it is measured in depends on the way that the program took")
        unit = "1/min" if self.modes.per == "move" else self.modes.unit
        return Feed(Quantity(value, unit), self.modes.per)

    def _tool_and_spindle(self, line: Words, span: Span) -> list[Node]:
        """Steps 4 to 9: S, T, M6, the spindle, coolant, overrides."""
        found: list[Node] = []
        speed, tool = line.take("S"), line.take("T")
        change, turn = line.find(F.TOOL_CHANGE), line.find(*SPINDLE)
        if line.find(F.SURFACE_SPEED) is not None:
            raise Unraisable("G96", "constant surface speed is on no other controller")
        if tool is not None or change is not None:
            changes = change is not None
            found.append(
                ChangeTool(span=span, number=tool, select=tool is not None, change=changes, rests=changes)
            )  # 3.5.3
        amount = None if speed is None else Quantity(speed, "rpm")
        if turn is not None:
            found.append(TurnSpindle(direction=SPINDLE[turn.function], speed=amount, span=span))
        elif amount is not None:
            found.insert(0, TurnSpindle(direction="speed", speed=amount, span=span))
        if line.find(F.HEAD) is not None:
            raise Unraisable("M90 to M97", "another head, which the neutral form does not have")
        for rule in line.rules:
            if rule.group == "M8":
                off = rule.function is F.COOLANT_OFF
                mist = False if off else (True if rule.function is F.MIST_ON else None)
                flood = False if off else (True if rule.function is F.FLOOD_ON else None)
                found.append(SwitchCoolant(span=span, mist=mist, flood=flood))
        override = line.group("M9")
        if override is not None:
            if override.function not in (F.OVERRIDES_ON, F.OVERRIDES_OFF):
                raise Unraisable(override.text, "an override that the program sets")
            found.append(AllowOverrides(on=override.function is F.OVERRIDES_ON, span=span))
        return found

    def _outputs(self, line: Words, span: Span) -> list[Node]:
        """Step 10: M54, M55 (3.5.9), M56."""
        found: list[Node] = []
        rule = line.find(F.OUTPUT_ON, F.OUTPUT_OFF)
        if rule is not None:
            channel = line.take("P")
            if channel is None:
                raise Unraisable(f"{rule.text} E", "a pulse width output")
            on = 1.0 if rule.function is F.OUTPUT_ON else 0.0
            found.append(SwitchOutput(channel=channel, value=Number(on, span), span=span))
        if line.find(F.INPUT_READ) is not None:
            channel, wait, timeout = line.take("P"), line.take("L"), line.take("Q")
            if channel is None or not isinstance(wait, Number | None):
                raise Unraisable("M56", "an analog input, or a way of waiting that is computed")
            state = 0.0 if wait is None else wait.value
            wanted = {1.0: True, 2.0: False}.get(state)
            found.append(
                WaitFor(
                    channel=channel, on=wanted, span=span, open=wanted is not None and timeout is None,
                    timeout=None if timeout is None else Quantity(timeout, "s"),
                )
            )  # fmt: skip
        others = (
            F.HEIGHT_CONTROL, F.HEIGHT_SETPOINT, F.CLAMP_ON, F.CLAMP_OFF, F.DRIVES_ON, F.DRIVES_OFF, F.AXIS_RESOLUTION,
            F.TEMPERATURE, F.TEMPERATURE_WAIT, F.FAN_ON, F.FAN_OFF, F.FEED_HOLD_INPUT, F.DIRECTION_OUTPUT_ON,
            F.DIRECTION_OUTPUT_OFF, F.SPEED_OUTPUT_ON, F.SPEED_OUTPUT_OFF,
        )  # fmt: skip
        rule = line.find(*others)
        if rule is not None:
            raise Unraisable(rule.text, "a device of this controller")
        return found

    def _plane_and_units(self, line: Words) -> None:
        """Steps 11 and 12."""
        assert self.modes is not None
        rule = line.find(*PLANES)
        if rule is not None:
            self.modes = replace(self.modes, plane=PLANES[rule.function])
        rule = line.find(F.UNITS_INCH, F.UNITS_MM)
        if rule is not None:
            self.modes = replace(self.modes, unit="inch" if rule.function is F.UNITS_INCH else "mm")

    def _tool_geometry(self, line: Words, span: Span) -> list[Node]:
        """Steps 13 and 14: cutter compensation (3.4.11), length (3.4.12)."""
        found: list[Node] = []
        rule = line.group("G7")
        if rule is not None:
            if rule.function is F.COMPENSATION_OFF:
                found.append(Compensate(side="off", span=span))
            else:
                side = "left" if rule.function is F.COMPENSATION_LEFT else "right"
                value = line.take("D")
                diameter = None if value is None or not rule.value else self.length_of(value)
                tool = value if not rule.value else None
                found.append(Compensate(side=side, tool=tool, diameter=diameter, span=span))
        rule = line.group("G8")
        if rule is not None:
            if rule.function is F.TOOL_OFFSET_DYNAMIC:
                raise Unraisable("G43.1", "a tool length that the program states")
            on = rule.function is F.TOOL_OFFSET_ON
            found.append(UseLength(on=on, tool=line.take("H") if on else None, span=span))
        return found

    def _frames(self, line: Words, span: Span) -> list[Node]:
        """Step 15: G54 to G59.3."""
        rule = line.group("G12")
        return [] if rule is None else [SetFrame(action="select", number=Number(float(rule.value), span), span=span)]

    def _path(self, line: Words, span: Span) -> list[Node]:
        """Step 16."""
        rule = line.group("G13")
        if rule is None:
            return []
        value = line.take("P") if rule.function is F.CONTINUOUS else None
        simplify, angle = line.take("Q"), line.take("R")
        return [
            SetPathMode(
                mode=PATHS[rule.function], tolerance=None if value is None else self.length_of(value),
                simplify=None if simplify is None else self.length_of(simplify),
                angle=None if angle is None else Quantity(angle, "deg"), span=span,
            )
        ]  # fmt: skip

    def _distances(self, line: Words) -> None:
        """Steps 17 and 18."""
        assert self.modes is not None
        rule = line.group("G3")
        if rule is not None:
            self.modes = replace(self.modes, relative=rule.function is F.INCREMENTAL)
        rule = line.group("G10")
        if rule is not None:
            self.modes = replace(self.modes, back="before" if rule.function is F.RETRACT_INITIAL else "top")

    def _transform(self, line: Words, span: Span) -> list[Node]:
        """G68, G69 (3.4.18), G50, G51 (3.4.13)."""
        rule = line.find(F.ROTATION_ON, F.ROTATION_OFF, F.SCALING_ON, F.SCALING_OFF)
        if rule is None:
            return []
        if rule.function is F.ROTATION_OFF:
            return [SetFrame(action="rotate_off", span=span)]
        if rule.function is F.SCALING_OFF:
            return [SetFrame(action="scale_off", span=span)]
        if self.machine.controller.diameter_programming:
            raise Unraisable(rule.text, "whether its X counts as a diameter is open (2.1.14)")
        if rule.function is F.ROTATION_ON:
            angle = line.need("R", "G68")
            return [SetFrame(action="rotate", angle=Quantity(angle, "deg"), places=self._places(line), span=span)]
        if line.take("P") is not None:
            raise Unraisable("G51 P", "the manual does not say which axes it scales")
        factors = tuple(AxisPlace(axis, Quantity(line.need(axis.upper(), "G51"), "1")) for axis in "xy")
        about = zip("xy", "IJ", strict=True)
        places = tuple(AxisPlace(axis, self._at(axis, line.need(letter, "G51"))) for axis, letter in about)
        return [SetFrame(action="scale", factors=factors, places=places, span=span)]

    def _group_zero(self, line: Words, span: Span) -> list[Node]:
        """Step 19: G10, G28, G30, G92 (3.4.5, 3.4.8, 3.4.23)."""
        rule = line.group("G0")
        if rule is None or rule.function in (F.DWELL, F.MACHINE_COORDINATES):
            return []
        if rule.function in OFFSETS:
            places = self._places(line) if rule.function is F.AXIS_OFFSET_SET else ()
            return [SetFrame(action=OFFSETS[rule.function], places=places, span=span)]
        if rule.function in (F.PARK_1, F.PARK_2):
            number = 1 if rule.function is F.PARK_1 else 2
            return [ParkAt(number=number, to=self._places(line, motion=True), span=span)]
        key = line.need("L", "G10")
        if not isinstance(key, Number) or key.value not in (2.0, 20.0):
            raise Unraisable("G10", "L is not 2 or 20")
        action = "store" if key.value == 2.0 else "store_here"
        return [SetFrame(action=action, number=line.need("P", "G10"), places=self._places(line), span=span)]

    def length_of(self, value: Expr) -> Quantity:
        """A length in the unit in force."""
        assert self.modes is not None
        if self.modes.unit == UNKNOWN_MODE:
            raise Unraisable("a length", "whether it is in mm or inches depends on the way that the program took")
        return Quantity(value, self.modes.unit)

    def _at(self, axis: str, value: Expr) -> Quantity:
        if axis == "x" and self.machine.controller.diameter_programming:
            value = _half(value)
        return self.length_of(value) if axis in "xyz" else Quantity(value, "deg")

    def table_moves(self, moves: Moves) -> list[Node]:
        """X numbers may be diameters (2.1.14)."""
        return [x_times(moves, 0.5) if self.machine.controller.diameter_programming else moves]

    def _places(self, line: Words, *, motion: bool = False, only: str = "XYZABC") -> tuple[AxisPlace, ...]:
        """The axis words; motion: relative ones in G91."""
        assert self.modes is not None
        found = []
        for letter in only:
            value = line.take(letter)
            if value is None:
                continue
            if motion and self.modes.relative == UNKNOWN_MODE:
                raise Unraisable("axis words", "whether they are absolute depends on the way that the program took")
            found.append(AxisPlace(AXES[letter], self._at(AXES[letter], value), motion and self.modes.relative is True))
        return tuple(found)

    # ---- motion

    def _motion(self, line: Words, span: Span, feed: Feed | None) -> list[Node]:
        """Step 20."""
        assert self.modes is not None
        rule = line.group("G1")
        if rule is not None:
            self.modes = replace(self.modes, motion=rule.tenths)
            if rule.function is F.MOTION_CANCEL:
                self.modes = replace(self.modes, sticky=())
        moving = line.has_axes or (rule is not None and rule.uses_axes)
        alone: list[Node] = [] if feed is None else [SetFeed(feed=feed, span=span)]
        if not moving or (rule is not None and rule.function is F.MOTION_CANCEL):
            return alone
        if self.modes.motion == UNKNOWN_MODE:
            raise Unraisable("axis words alone", "which motion is in force depends on the way that the program took")
        assert isinstance(self.modes.motion, int)
        rule = self.rule("G", self.modes.motion / 10)
        if rule is None:
            raise Unraisable("axis words alone", "no motion is in force")
        if rule.function in CYCLES:
            return self._cycle(line, rule, span, feed)
        if rule.function in (F.ARC_CW, F.ARC_CCW):
            return [self._arc(line, rule, span, feed)]
        if rule.function is F.MOTION_CANCEL:
            raise Unraisable("axis words without a motion code", f"{rule.text} has ended the one before")
        if rule.function not in (F.TRAVERSE, F.FEED, F.PROBE):
            raise Unraisable(rule.text, "a cycle or a move that only this controller has")
        kind = {F.TRAVERSE: "rapid", F.FEED: "feed"}.get(rule.function, "probe")
        frame = "machine" if line.find(F.MACHINE_COORDINATES) else "work"
        to = self._places(line, motion=True)
        if not to:
            return alone
        if kind == "rapid" and feed is not None:
            return [*alone, MoveTo(to=to, kind=kind, frame=frame, span=span)]
        return [MoveTo(to=to, kind=kind, frame=frame, feed=feed, span=span)]

    def _arc(self, line: Words, rule: CodeRule, span: Span, feed: Feed | None) -> Node:
        """3.4.3: I, J, K from the start, or R."""
        assert self.modes is not None
        if self.modes.plane == UNKNOWN_MODE:
            raise Unraisable(rule.text, "the plane depends on the way that the program took")
        if self.machine.controller.turning or self.machine.controller.xz_seen_from == "-y":
            raise Unraisable(rule.text, "arcs of a lathe")
        to = self._places(line, motion=True)
        center = tuple(
            AxisPlace(axis, self.length_of(value), True)
            for axis, letter in zip("xyz", "IJK", strict=True) if (value := line.take(letter)) is not None
        )  # fmt: skip
        value = line.take("R")
        return ArcTo(
            to=to, plane=self.modes.plane, clockwise=rule.function is F.ARC_CW, center=center,
            radius=None if value is None else self.length_of(value), turns=line.take("P"), feed=feed, span=span,
        )  # fmt: skip

    def _cycle(self, line: Words, rule: CodeRule, span: Span, feed: Feed | None) -> list[Node]:
        """3.4.21: R stays from cycle to cycle, the other numbers within the same one."""
        assert self.modes is not None
        modes = self.modes
        for mode in (modes.sticky, modes.plane, modes.back, modes.relative):
            if mode == UNKNOWN_MODE:
                raise Unraisable(rule.text, "its numbers or modes depend on the way that the program took")
        depth = DEPTH[modes.plane]
        kept = dict(modes.sticky)  # type: ignore[arg-type]
        code = kept.get("G")
        if not isinstance(code, Number) or code.value != rule.tenths:
            kept = {letter: value for letter, value in kept.items() if letter == "R"}
        for letter in (depth, "R", "P", "Q"):
            value = line.take(letter)
            if value is not None:
                kept[letter] = value
        repeats = line.take("L")
        for letter in (depth, "R"):
            if letter not in kept:
                raise Unraisable(rule.text, f"{letter} is missing")
        at = self._places(line, motion=True)
        relative = modes.relative is True
        axis = AXES[depth]
        kind = CYCLES[rule.function]
        kept["G"] = Number(float(rule.tenths), span)
        self.modes = replace(modes, sticky=tuple(sorted(kept.items(), key=lambda item: item[0])))
        peck = kept.get("Q") if kind in ("peck", "chip_break") else None
        dwell = kept.get("P") if kind in ("dwell", "bore_stop", "bore_dwell") else None
        return [
            DrillHole(
                kind=kind, at=at, plane=modes.plane, back=modes.back, span=span, repeats=repeats, feed=feed,
                top=AxisPlace(axis, self._at(axis, kept["R"]), relative),
                bottom=AxisPlace(axis, self._at(axis, kept[depth]), relative),
                peck=None if peck is None else self.length_of(peck),
                clearance=None if peck is None else self._clearance(span),
                lift=self.length_of(peck) if peck is not None and kind == "chip_break" else None,
                dwell=None if dwell is None else Quantity(dwell, "s"),
            )
        ]  # fmt: skip

    def _clearance(self, span: Span) -> Quantity:
        """Above the last peck (3.4.21.4)."""
        assert self.modes is not None
        mm = self.program.rules.peck_clearance_mm
        return Quantity(Number(mm / 25.4 if self.modes.unit == "inch" else mm, span), self.modes.unit)

    def _stop(self, line: Words, span: Span) -> list[Node]:
        """Step 21."""
        rule = line.group("M4")
        if rule is None:
            return []
        if rule.function in (F.STOP, F.OPTIONAL_STOP, F.STOP_KEEP):
            return [PauseJob(optional=rule.function is F.OPTIONAL_STOP, span=span)]
        self.modes = None
        reset = rule.function is F.END_RESET
        return [EndJob(reset=reset, rests=reset, span=span)]

    # ---- statements

    def own(self, node: Statement) -> list[Node]:
        """Messages and devices (4.2)."""
        if isinstance(node, Message):
            if node.kind in ("msg", "log", "write", "writeln"):
                return [ShowText(kind="log" if node.kind == "log" else "msg", parts=node.parts, span=node.span)]
            raise Unraisable(f"{node.kind}msg" if node.kind != "dialog" else "dlgmsg", "it asks the operator")
        if isinstance(node, Guard):
            return [SwitchGuard(name=node.name, on=node.on, span=node.span)]
        if isinstance(node, Device) and node.name == "home":
            return [HomeAxes(axes=tuple(a.value for a in node.arguments if isinstance(a, Text)), span=node.span)]
        raise Unraisable(getattr(node, "name", type(node).__name__), "a command of this controller")

    def call(self, node: Call) -> list[Node]:
        """gosub (4.1)."""
        found = self.run_routine(node.name, node.span, count=node.count)
        assert isinstance(found, RunRoutine)
        return [found]


def _mentions(body: object, number: int) -> bool:
    """Whether statements may read a numbered variable."""
    text = repr(body)
    return f"Number(value={float(number)!r}" in text


def raise_program(program: Program, machine: Machine) -> Job:
    """A Program of Eding CNC as a Job."""
    return by_inputs(EdingRaiser(program, machine).job())


def _half(value: Expr) -> Expr:
    """The radius of a diameter."""
    if isinstance(value, Number):
        return replace(value, value=value.value / 2.0)
    return Binary("/", value, Number(2.0, value.span), value.span)
