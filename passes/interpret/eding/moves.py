"""Motion codes to rows: lines, arcs by centre or radius, feeds. Eding CNC manual 3.4.1 to 3.4.3, 3.4.24."""

from __future__ import annotations

import math

from gproof.ir import codes
from gproof.ir.finding import Refusal, Span
from gproof.ir.machine import AXES, AXIS_NAMES
from gproof.ir.rules import CodeRule
from gproof.ir.rules import Function as F
from gproof.ir.symbolic import NOWHERE, ORIGIN, Position, Unknown, Value, bounds, not_known, scaled
from gproof.ir.symbols import UNIFORM, describe
from gproof.ir.trace import KNIFE, Op, Plane, Wait
from gproof.passes.interpret.core import line_kernels as k
from gproof.passes.interpret.core import refused_lines
from gproof.passes.interpret.core.arc_condition import radius_arc_warning
from gproof.passes.interpret.core.parsed_line import Line
from gproof.passes.interpret.core.trace_writer import Emitter
from gproof.passes.interpret.eding import compensation_codes as compensated
from gproof.passes.interpret.eding.canned_cycles import AXES_OF_PLANE, CYCLES, run_cycle
from gproof.passes.interpret.eding.outputs_and_waits import look_at
from gproof.passes.interpret.eding.probing import run_probe
from gproof.passes.interpret.eding.spindle import note_speed_unknown, true_rpm
from gproof.passes.interpret.eding.spindle_synchronised import SYNCHRONISED, run_synchronised
from gproof.passes.interpret.eding.threading import run_threading
from gproof.passes.interpret.eding.transform_codes import check_arc, note_reading, settle
from gproof.passes.interpret.wincnc.state import drifted, followed, tell_held_back

_OUT_OF_PLANE = {Plane.XY: "K", Plane.XZ: "J", Plane.YZ: "I"}
_CENTER_WORDS = {Plane.XY: ("I", "J"), Plane.XZ: ("I", "K"), Plane.YZ: ("J", "K")}
X_OFFSET = "X offset of a tool (G43)"
_LEFT = (
    {"rotation": "rotation (G68)", "scaling": "scaling (G51)"},
    {"side": "cutter compensation (G41)", "length": X_OFFSET},
)
"""What the job before may have left on, by the name under which ``Modal.stated`` holds that this job says it."""


class Motion(Emitter):
    """Step 20 of the order of execution."""

    def aim(self, line: Line, words: dict[int, Value] | None = None, *, machine: bool = False) -> list[Position]:
        """Where axis words (those of the line) send the axes, in machine coordinates; machine: the words are such.

        The words of a line go together: under a rotation each of X and Y moves both axes.
        """
        s = self.modal
        words = line.axes() if words is None else words
        target = [s.programmed(axis) for axis in range(AXES)]
        for axis, value in words.items():
            if not machine:
                target[axis] = self.target(axis, value)
            elif isinstance(value, Unknown):
                target[axis] = self._named(axis, value, ORIGIN) or self._bounded(axis, value, ORIGIN)
            else:
                target[axis] = Position(value * s.scale(axis))
        if not machine and s.transform.on and (0 in words or 1 in words):
            settle(self, line.span)
            target[0], target[1] = self._transformed(words.get(0), words.get(1))
        return target

    def target(self, axis: int, value: Value) -> Position:
        """Where the word of one axis sends it; of X and Y nobody can say it for one alone while G68 or G51 is on."""
        s = self.modal
        if axis < 2 and s.transform.on:
            return NOWHERE
        if s.transform.uniform != 1.0 and value != 0.0:
            if axis in s.transform.loose:
                return self._either_scaled(axis, value)
            if axis == 2:
                note_reading(self)
                value = scaled(value, s.transform.upright)
        if isinstance(value, Unknown):
            named = self._named(axis, value, s.offset(axis)) if s.absolute else None
            return named or self._bounded(axis, value, None)
        origin = s.offset(axis) if s.absolute else s.programmed(axis)
        return Position(value * s.scale(axis) + origin.value, origin.form)

    def _either_scaled(self, axis: int, value: Value) -> Position:
        """By both readings of ``G51 P``: not scaled, which is the number of the row, or about the program's zero."""
        s = self.modal
        factor = s.transform.uniform
        if not isinstance(value, Unknown) and math.isfinite(factor):
            origin = s.offset(axis) if s.absolute else s.programmed(axis)
            plain, more = value * s.scale(axis), value * s.scale(axis) * (factor - 1.0)
            at = Position(plain + origin.value, origin.form)
            return self.unknown_place(UNIFORM, axis, (min(0.0, more), max(0.0, more)), at)
        ends = [end * by for end in bounds(value) for by in (1.0, factor)]
        if not all(map(math.isfinite, ends)):
            return NOWHERE
        return self._bounded(axis, Unknown(f"{self.machine.word(axis)} under G51 P", min(ends), max(ends)), None)

    def _named(self, axis: int, value: Unknown, origin: Position) -> Position | None:
        """The place whose coordinate from an origin a value is, whatever number that is: ``Z#5063`` behind a probe."""
        place = value.place
        if place is None or place.axis != axis or place.scale != self.modal.scale(axis) or place.origin != origin:
            return None
        return place.at

    def _bounded(self, axis: int, value: Unknown, origin: Position | None) -> Position:
        """A place that is only bounded, from ``origin`` or from where the axis words count."""
        if not value.bounded:
            return NOWHERE
        s = self.modal
        if origin is None:
            origin = s.offset(axis) if s.absolute else s.programmed(axis)
        scale = s.scale(axis)
        return self.unknown_place("value", axis, (value.low * scale, value.high * scale), origin)

    def _transformed(self, x: Value | None, y: Value | None) -> tuple[Position, Position]:
        """Where X and Y words send their axes under G68 and G51."""
        s = self.modal
        words = (
            x if x is None or isinstance(x, Unknown) else x * s.scale(0),
            y if y is None or isinstance(y, Unknown) else y * s.scale(1),
        )
        at = s.programmed(0), s.programmed(1)
        if s.absolute:
            return s.transform.absolute(words, at, (s.offset(0), s.offset(1)))
        return s.transform.incremental(words, at)

    def _motion(self, line: Line, rule: CodeRule) -> None:
        self._note_assumptions(line, rule)
        machine = line.find(F.MACHINE_COORDINATES)
        if refused_lines.vague(self, line, rule, machine=machine is not None):
            return
        if machine is not None and rule.function not in (F.TRAVERSE, F.FEED, F.PROBE):
            raise Refusal(codes.G53_NEEDS_G0_G1.at(line.where_code(machine), mode=rule.text))
        comp = self.modal.compensation
        if comp is not None and machine is not None:
            raise Refusal(codes.G53_WITH_COMPENSATION.at(line.where_code(machine), hint="G40 before"))
        if rule.function is F.PROBE:
            compensated.no_probing(self.modal, line, rule)
        if comp is not None and rule.function in (*CYCLES, F.THREADING):
            # 3.4.19 calls G76 a canned cycle too.
            raise Refusal(codes.CYCLE_WITH_COMPENSATION.at(line.span, code=rule.text, hint="G40 before"))
        if rule.function in CYCLES:
            run_cycle(self, line, rule)
            return
        if rule.function in SYNCHRONISED and comp is not None:
            what = f"whether {rule.text} follows the contour and still the spindle, of which no section speaks"
            raise Refusal(codes.COMPENSATION_UNKNOWN.at(line.where_code(rule), cause=what, hint="G40 before"))
        if rule.function is F.THREADING:
            run_threading(self, line, rule)
            return
        if rule.function not in SYNCHRONISED:
            self._set_motion(rule)
            if rule.function is not F.TRAVERSE:
                self.need_feed(line, rule)
        for axis, value in line.axes().items():
            if isinstance(value, Unknown):
                word = AXIS_NAMES[axis].upper()
                # Of a bounded value the position keeps the bounds, but not through a rotation.
                turned = axis < 2 and machine is None and self.modal.transform.on
                origin = ORIGIN if machine is not None else self.modal.offset(axis)
                named = machine is not None or self.modal.absolute
                if turned or not (value.bounded or (named and self._named(axis, value, origin))):
                    self.findings.add(not_known(line.where(word), word, value))
        target = self.aim(line, machine=machine is not None)
        if rule.function in SYNCHRONISED:
            run_synchronised(self, line, rule, target)
        elif rule.function in (F.ARC_CW, F.ARC_CCW):
            self._arc(line, rule, target)
        elif rule.function is F.PROBE:
            run_probe(self, line, rule, target)
        else:
            op = Op.TRAVERSE if rule.function is F.TRAVERSE else Op.FEED
            if comp is None:
                self.move(op, target, line.span)
            else:
                compensated.straight(self, line, op, target)
        self._moved = True

    def _set_motion(self, rule: CodeRule) -> None:
        if self.modal.motion != rule.function or rule.function is F.MOTION_CANCEL:
            self.modal.cycle, self.modal.cycle_code = {}, 0
        self.modal.motion = int(rule.function)

    def _note_assumptions(self, line: Line, rule: CodeRule) -> None:
        stated = self.modal.stated
        if "units" not in stated:
            self.assumed["the job starts in millimetres (G21)"] = None
        if self.machine.controller.diameter_programming:
            self.assumed["every X number is a diameter, in G10, G53 and G92 and in #5001 and #5071 as well"] = None
        # The zeroing menu can leave a rotation (2.2.4.3), the job before whatever it did not end: M2 ends nothing, M30
        # compensation (3.5.1). The zero setup says that there is nothing of that kind.
        if self.modal.setup.default_offset is None:
            for names in _LEFT:
                wanted = (text for key, text in names.items() if key not in stated)
                left = [text for text in wanted if text != X_OFFSET or self._x_offsets]
                if left:
                    self.assumed[f"no {' and no '.join(left)} is in force at the start"] = None
            if "path" not in stated and self._beside_bodies:
                self.assumed["no rounding of corners (G64 P) and no joining of lines (Q) is in force at the start"] = (
                    None
                )
        if "distance" not in stated:
            self.assumed["the job starts in absolute distances (G90)"] = None
        if "plane" not in stated and rule.group == "G1" and rule.function not in (F.TRAVERSE, F.FEED):
            plane = "XZ plane (G18)" if self.modal.plane is Plane.XZ else "XY plane (G17)"
            self.assumed[f"the job starts in the {plane}"] = None
        if "retract" not in stated and rule.function in CYCLES:
            self.assumed["the job starts with cycles that return to where they began (G98)"] = None
        if "head" not in stated and self._heads_apart and self.modal.setup.default_offset is None:
            self.assumed["the job starts with the first spindle (M90)"] = None

    @property
    def _beside_bodies(self) -> bool:
        """True where something is stated that the tool must keep clear of, whatever the controller does at corners."""
        return bool(self.machine.keep_out or self.setup.keep_out or self.setup.workpiece is not None)

    @property
    def _x_offsets(self) -> bool:
        """True on machines whose tools have offsets in X (3.4.12: for turning)."""
        return self.machine.controller.turning or any(tool.x_offset for tool in self.machine.tools)

    @property
    def _heads_apart(self) -> bool:
        """True where it matters for positions which spindle is selected, and the setup does not say it (3.5.2)."""
        setup = self.modal.setup
        others = [spindle for spindle in self.machine.spindles if spindle.number]
        apart = bool(setup.heads) or any(offset != 0.0 for spindle in others for offset in spindle.offset)
        return apart and 5390 not in setup.parameters

    def need_feed(self, line: Line, rule: CodeRule) -> None:
        """Refusal GP204 or GP205 when a feed move has no feed rate."""
        s = self.modal
        if s.feed_mode == 93 and "F" not in line.values:
            raise Refusal(codes.INVERSE_TIME_FEED_MISSING.at(line.span))
        if s.feed == 0.0:
            raise Refusal(codes.FEED_MISSING.at(line.span, code=rule.text))
        if s.feed_mode == 95 and s.spindle_direction == 0:
            hint = "give S and start the spindle before"
            self.findings.add(codes.SPINDLE_UNKNOWN.at(line.span, code="G95", hint=hint))
        elif s.feed_mode == 95:
            note_speed_unknown(self, line, "G95")

    def _arc(self, line: Line, rule: CodeRule, target: list[Position]) -> None:
        """Radius and centre format, 3.4.3.1 and 3.4.3.2."""
        s = self.modal
        first, second, _ = AXES_OF_PLANE[s.plane]
        names = [AXIS_NAMES[first].upper(), AXIS_NAMES[second].upper()]
        if first not in line.axes() and second not in line.axes():
            raise Refusal(
                codes.AXIS_WORDS_MISSING.at(line.span, code=f"{rule.text} in this plane, {names[0]} or {names[1]},")
            )
        one, two = _CENTER_WORDS[s.plane]
        radius = line.number("R")
        center_words = (line.number(one), line.number(two))
        if radius is None and center_words == (None, None):
            raise Refusal(codes.ARC_CENTER_MISSING.at(line.span, code=rule.text, needed=f"{one} or {two}, or R"))
        wrong = _OUT_OF_PLANE[s.plane]
        if wrong in line.values:
            raise Refusal(codes.UNUSED_WORD.at(line.where(wrong), word=f"{wrong} (out of the arc's plane)"))
        if radius is not None and center_words != (None, None):
            raise Refusal(codes.UNUSED_WORD.at(line.where("R"), word="R beside a centre"))
        if s.xz_view_open:
            cause = "the side from which arcs in the XZ plane are seen"
            raise Refusal(codes.ARC_UNKNOWN.at(line.span, cause=cause, hint=compensated.VIEW_HINT))
        turns = 1 if (rule.function is F.ARC_CCW) != s.xz_mirrored else -1
        factor = check_arc(self, line)
        if s.compensation is not None and s.compensation.radius is None:
            compensated.straight(self, line, Op.FEED, target)
            return
        start = [s.programmed(first), s.programmed(second)]
        end = [target[first], target[second]]
        for a, b, name in zip(start, end, names, strict=True):
            difference = b.minus(a)
            if difference.form:
                raise Refusal(codes.ARC_UNKNOWN.at(line.span, cause=f"{name}: {describe(difference.form)}"))
        if radius is not None:
            entry = compensated.entry_center(self, line, target, radius * s.unit * factor, turns)
            center = entry or self._radius_center(line, start, end, radius * s.unit * factor, turns > 0)
        elif self.machine.controller.absolute_arc_centers:
            center = self._absolute_center(line, center_words, (first, second), start)
        else:
            i, j = (0.0 if v is None else v * s.unit for v in center_words)
            if s.transform.on:
                i, j = s.transform.step(i, j)
            center = [start[0].value + i, start[1].value + j]
        if all(abs(a.value - b.value) < 1e-6 for a, b in zip(start, end, strict=True)):
            target[first], target[second] = start
        whole = [p.value for p in s.position[:3]]
        whole[first], whole[second] = center
        if math.hypot(center[0] - start[0].value, center[1] - start[1].value) < 1e-9:
            raise Refusal(codes.ARC_RADIUS_ZERO.at(line.span))
        if s.compensation is None:
            self.move(Op.ARC, target, line.span, center=whole, turns=turns, plane=s.plane)
        else:
            compensated.circular(self, line, target, whole, turns)

    def _radius_center(
        self, line: Line, start: list[Position], end: list[Position], radius: float, ccw: bool
    ) -> list[float]:
        # Counter-clockwise is meant in a right-handed pair; XZ is listed as (X, Z), its pair is (Z, X).
        flip = self.modal.plane is Plane.XZ
        a, b = (1, 0) if flip else (0, 1)
        x, y, bad = k.radius_center(start[a].value, start[b].value, end[a].value, end[b].value, radius, int(ccw))
        chord = math.hypot(end[0].value - start[0].value, end[1].value - start[1].value)
        if bad == k.RADIUS_ZERO:
            raise Refusal(codes.ARC_RADIUS_ZERO.at(line.where("R")))
        if bad == k.RADIUS_SAME_POINT:
            raise Refusal(codes.ARC_SAME_POINT.at(line.span))
        if bad == k.RADIUS_UNREACHABLE:
            raise Refusal(codes.ARC_UNREACHABLE.at(line.where("R"), chord=chord, radius=abs(radius), unit="mm"))
        warning = radius_arc_warning(line.span, chord, radius, self.modal.unit != 1.0)
        if warning is not None:
            self.findings.add(warning)
        return [y, x] if flip else [x, y]

    def _absolute_center(
        self,
        line: Line,
        words: tuple[float | None, float | None],
        axes: tuple[int, int],
        start: list[Position],
    ) -> list[float]:
        center = []
        if None in words:
            raise Refusal(codes.ARC_UNKNOWN.at(line.span, cause="a centre word left out with absolute centres on"))
        if self.machine.controller.diameter_programming and axes[0] == 0 and words[0]:
            raise Refusal(codes.ARC_UNKNOWN.at(line.span, cause="an absolute centre I with diameter programming"))
        s = self.modal
        i, j = (0.0 if word is None else word * s.scale(axis) for word, axis in zip(words, axes, strict=True))
        offset = s.offset(axes[0]), s.offset(axes[1])
        places = offset[0].moved(i), offset[1].moved(j)
        if s.transform.on:
            places = s.transform.absolute((i, j), (start[0], start[1]), offset)
        for place, at in zip(places, start, strict=True):
            if place.form != at.form:
                raise Refusal(codes.ARC_UNKNOWN.at(line.span, cause=describe(place.minus(at).form)))
            center.append(place.value)
        return center

    def move(
        self, op: Op, target: list[Position], span: Span, *, center: list[float] | None = None,
        turns: int = 0, plane: int = 0, length: float | None = None, programmed: tuple[float, float] | None = None,
    ) -> None:  # fmt: skip
        """Append a motion row and go there.

        length: mm that an inverse time feed counts, where the row is part of a longer move; programmed: the point of
        the contour that a compensated row belongs to; without it Refusal GP256 while compensation is on.
        """
        if KNIFE not in self.modal.following:
            self.go(op, target, span, center=center, turns=turns, plane=plane, length=length, programmed=programmed)
            return
        from gproof.passes.interpret.wincnc import tangential_knife as single_knife

        mode = single_knife.follows(self)
        if mode is None:
            self.go(op, target, span, center=center, turns=turns, plane=plane, length=length, programmed=programmed)
            return
        target, back = single_knife.turn_before(self, mode, op, target, span, center, turns)
        self.go(op, target, span, center=center, turns=turns, plane=plane, length=length, programmed=programmed)
        if back is not None:
            single_knife.lower(self, mode, span, back)

    def go(
        self, op: Op, target: list[Position], span: Span, *, center: list[float] | None = None,
        turns: int = 0, plane: int = 0, length: float | None = None, programmed: tuple[float, float] | None = None,
    ) -> None:  # fmt: skip
        """``move`` without what a knife adds to it."""
        s = self.modal
        if s.single.slaves or s.single.locked:
            # Every move, whoever makes it: of a cycle, of an array, of a lift.
            bound = {*s.single.locked, *(axis for pair in s.single.slaves for axis in pair)}
            if op is Op.ARC and bound & {0, 1}:
                what = "an arc while L13 couples or L300 locks X or Y"
                raise Refusal(codes.UNSUPPORTED_CODE.at(span, code=what))
            tell_held_back(self, target, span)
            target = followed(s.single, s.position, target)
            if s.single.slaves:
                s.single = drifted(s.single, s.position, target)
        if s.compensation is not None and programmed is None:
            raise Refusal(codes.COMPENSATION_UNKNOWN.at(span, cause=compensated.APART, hint="G40 before"))
        if s.refused_at is not None:
            refused_lines.tell(self, target, span)
        if s.jumped:
            # No row says how the axes came from the last one to here.
            s.jumped = False
            self._end_section(Wait.UNKNOWN, "line refused", None, span)
        if s.clamped or s.drives_were_off or s.not_programmed:
            look_at(self, target, span)
        if any(a.value != b.value for a, b in zip(target[3:], s.position[3:], strict=True)):
            # Rounding is no motion: a rotary move beside it keeps its feed in degrees.
            for axis in range(3):
                if abs(target[axis].value - s.position[axis].value) < 1e-9:
                    target[axis] = Position(s.position[axis].value, target[axis].form)
        start = [p.value for p in s.position]
        own, rotary = _length(op, start, [p.value for p in target], center, turns, plane)
        feed = 0.0
        if op is not Op.TRAVERSE:
            feed = self._effective_feed(own if length is None or rotary else length, rotary)
        s.position = list(target)
        self._moves += 1
        self.rows.append(
            op, file=self._file_of(span), line=span.line, call=self._call, to=[p.value for p in target],
            frame=self._frame(), state=self._state(), feed=feed,
            center=(0.0, 0.0, 0.0) if center is None else center, turns=turns, plane=plane,
            arg=programmed or (0.0, 0.0),
        )  # fmt: skip

    def _effective_feed(self, length: float, rotary: bool) -> float:
        """mm/min (deg/min for rotary moves) of a feed move of this length; NaN when not known."""
        s = self.modal
        if s.pitch:
            return s.pitch * true_rpm(s)
        if s.feed_unknown:
            return math.nan
        if s.feed == 0.0:
            # No feed move comes here without F: the corner of a compensated traverse.
            return math.nan
        if s.feed_mode == 93:
            return s.feed * length * s.feed_override
        feed = (s.feed / s.feed_unit if rotary else s.feed) * s.feed_override
        if s.feed_mode == 95:
            return feed * (true_rpm(s) or math.nan)
        return feed


def _length(
    op: Op, start: list[float], end: list[float], center: list[float] | None, turns: int, plane: int
) -> tuple[float, bool]:
    """(path length in mm, or degrees for moves of rotary axes alone; whether it is such a move)."""
    linear = [b - a for a, b in zip(start[:3], end[:3], strict=True)]
    if op is Op.ARC and center is not None:
        first, second, third = AXES_OF_PLANE[Plane(plane)]
        if plane == Plane.XZ:
            first, second = second, first
        a0 = math.atan2(start[second] - center[second], start[first] - center[first])
        a1 = math.atan2(end[second] - center[second], end[first] - center[first])
        sweep = math.fmod((a1 - a0) * (1 if turns > 0 else -1), 2 * math.pi)
        if sweep <= 0:
            sweep += 2 * math.pi
        sweep += 2 * math.pi * (abs(turns) - 1)
        r0 = math.hypot(start[first] - center[first], start[second] - center[second])
        r1 = math.hypot(end[first] - center[first], end[second] - center[second])
        return math.hypot(sweep * (r0 + r1) / 2, linear[third]), False
    length = math.sqrt(sum(d * d for d in linear))
    if length > 0:
        return length, False
    turn = math.sqrt(sum((b - a) * (b - a) for a, b in zip(start[3:], end[3:], strict=True)))
    return turn, turn > 0.0
