"""One line of words, executed step by step in the order of the Eding CNC manual 3.7 (table 3-7)."""

from __future__ import annotations

import functools
import math

from gproof.ir import codes
from gproof.ir.dialects import accepts
from gproof.ir.finding import Finding, FollowsRefusal, Refusal, Span
from gproof.ir.machine import AXES
from gproof.ir.modal_groups import MOTION, OF_FEEDS
from gproof.ir.rules import CodeRule
from gproof.ir.rules import Function as F
from gproof.ir.symbolic import AXIS_INDEX, NOWHERE, Unknown, Value
from gproof.ir.trace import Op, PathMode, Plane, Wait
from gproof.passes.interpret.core import refused_lines
from gproof.passes.interpret.core.modal_state import INCH
from gproof.passes.interpret.core.open_numbers import number_or_open, width_or_open
from gproof.passes.interpret.core.parsed_line import Line, check_unused, gather
from gproof.passes.interpret.core.trace_writer import ProgramEnd
from gproof.passes.interpret.eding import compensation_codes as compensated
from gproof.passes.interpret.eding import heads, spindle
from gproof.passes.interpret.eding import overrides as feed_override
from gproof.passes.interpret.eding.canned_cycles import CYCLES
from gproof.passes.interpret.eding.outputs_and_waits import run_outputs
from gproof.passes.interpret.eding.transform_codes import frame_of, run_transform
from gproof.passes.interpret.eding.work_offsets import Origins

_FOR_HIGH = 1
"""L of M56: wait for high."""


class Blocks(Origins):
    """What the codes of a line do to the state, each step of the table a method."""

    def _line(self, span: Span, words: list[tuple[str, Value, Span]]) -> None:
        line: Line | None = None
        try:
            line = gather(self.program.rules, span, words)
            unsupported = line.find(F.UNSUPPORTED)
            if unsupported is None:
                self._execute(line)
            else:
                self._beside(line, unsupported)
        except Refusal as refusal:
            finding = self.as_accepted(refusal.finding)
            self._recover(words, line, refusal, finding)
            self._refuse(finding, told=isinstance(refusal, FollowsRefusal))

    def _beside(self, line: Line, unsupported: CodeRule) -> None:
        """GP113 for a code that is not modelled; what else the line says counts.

        Where such a code takes the axis words, nobody knows where the axes are after it.
        """
        what = f"{unsupported.text} ({unsupported.open})" if unsupported.open else unsupported.text
        self._fail(codes.UNSUPPORTED_CODE.at(line.where_code(unsupported), code=what))
        line.used.update(line.values)
        if not unsupported.uses_axes:
            self._execute(line)
            return
        if unsupported.group == "G1":
            self.modal.motion = F.UNSUPPORTED
        self._settings(line)
        for axis in line.axes():
            self.modal.position[axis] = NOWHERE
        self._stop(line)

    def _recover(
        self, words: list[tuple[str, Value, Span]], line: Line | None, refusal: Refusal, finding: Finding
    ) -> None:
        """After an error what the line may have changed is not known.

        A cycle that did not begin is in force nevertheless: the places of the lines behind it are holes.
        """
        aim = None if line is None or not line.find(F.ARC_CW, F.ARC_CCW) else functools.partial(self.aim, line)
        refused_lines.refuse_words(self, words, AXIS_INDEX, refusal, finding, aim)
        cycle = None if line is None else line.group("G1")
        if cycle is not None and cycle.function in CYCLES:
            self.modal.motion = F.UNSUPPORTED

    def _execute(self, line: Line) -> None:
        """The steps of table 3-7, in its order (the comment, step 1, is the frontend's)."""
        owner = self._axis_owner(line)
        if self.modal.unknown_modes and self._rests_on_lost(line):
            return
        before = frame_of(self.modal, line)
        self._settings(line)
        run_transform(self, line, before)
        refused_lines.restate(self, line.rules, bool(line.axes()))
        self._once(line)
        if owner is not None:
            self._motion(line, owner)
        elif (rule := line.group("G1")) is not None and rule.function is F.MOTION_CANCEL:
            self._set_motion(rule)
        if "E" in line.values and "E" not in line.used and self.machine.controller.extruder:
            line.used.add("E")
            self._fail(codes.UNSUPPORTED_CODE.at(line.where("E"), code="E, the extruder of a 3D printer (2.11)"))
        check_unused(line)
        self._stop(line)

    def _rests_on_lost(self, line: Line) -> bool:
        """A line with a code that counts in what a refused line may have changed: what it would change is lost too."""
        has_axes = bool(line.axes())
        found = [rule for rule in line.rules if refused_lines.is_lost(self, rule, has_axes, line.span)]
        if not found:
            return False
        line.used.update(line.values)
        kept = [(r, w) for r, w in zip(line.rules, line.code_spans, strict=True) if r not in found]
        line.rules, line.code_spans = [rule for rule, _ in kept], [where for _, where in kept]
        if not any(rule.uses_axes for rule in found):
            self._execute(line)
            return True
        self._settings(line)
        refused_lines.restate(self, line.rules, has_axes)
        self._stop(line)
        return True

    def _settings(self, line: Line) -> None:
        """Steps 2 to 18."""
        comp = self.modal.compensation
        offsets = [] if comp is None else [self.modal.beside_work(axis) for axis in range(AXES)]
        self._feed_mode(line)
        self._feed(line)
        spindle.speed_word(self, line)
        self._select_tool(line)
        if line.find(F.TOOL_CHANGE):
            self._change_tool(line)
        spindle.direction(self, line)
        heads.select(self, line)
        self._coolant(line)
        feed_override.overrides(self, line)
        run_outputs(self, line)
        self._input(line)
        self._dwell(line)
        self._plane(line)
        self._units(line)
        compensated.switch(self, line)
        if line.group("G7") is not None:
            self.modal.stated.add("side")
        self._length_offset(line)
        compensated.keep_tool_and_head(comp, offsets, self.modal, line)
        self._coordinate_system(line)
        self._path_mode(line)
        self._distance_and_retract(line)

    def _axis_owner(self, line: Line) -> CodeRule | None:
        """The motion code that takes the axis words of this line, None when none moves (3.3)."""
        motion, once = line.group("G1"), line.group("G0")
        axes = line.axes()
        takers = [rule for rule in line.rules if rule.uses_axes and rule.group != "G1"]
        if len(takers) > 1:
            first, second = takers[0], takers[1]
            raise Refusal(codes.TWO_AXIS_COMMANDS.at(line.where_code(second), first=first.text, second=second.text))
        if once is not None and once.function is F.AXIS_OFFSET_SET and not axes:
            raise Refusal(codes.G92_AXIS_MISSING.at(line.where_code(once)))
        if motion is not None and motion.uses_axes:
            if takers:
                taker = takers[0]
                raise Refusal(codes.TWO_AXIS_COMMANDS.at(line.where_code(taker), first=motion.text, second=taker.text))
            if not axes and motion.function in (F.TRAVERSE, F.FEED):
                if not self.takes(accepts.MOTION_ALONE) or once is not None:
                    where, hint = line.where_code(motion), accepts.MOTION_ALONE.hint
                    raise Refusal(codes.AXIS_WORDS_MISSING.at(where, code=motion.text, hint=hint))
                self._set_motion(motion)
                return None
            if not axes and motion.function not in (*CYCLES, F.THREADING):
                raise Refusal(codes.AXIS_WORDS_MISSING.at(line.where_code(motion), code=motion.text))
            return motion
        if takers:
            return None
        if not axes:
            if once is not None and once.function is F.MACHINE_COORDINATES:
                raise Refusal(codes.AXIS_WORDS_MISSING.at(line.where_code(once), code=once.text))
            return None
        if motion is not None:
            raise Refusal(codes.AXIS_WORDS_UNUSED.at(line.span, why=f"{motion.text} on this line"))
        if MOTION in self.modal.unknown_modes:
            return refused_lines.LOST_MOTION
        if self.modal.motion == F.UNSUPPORTED:
            # G33 and its like leave such a motion too, with nothing refused before.
            because = FollowsRefusal if self.refused else Refusal
            raise because(codes.UNSUPPORTED_CODE.at(line.span, code="the active motion"))
        active = self._motion_rules.get(self.modal.motion)
        if active is None and self.takes(accepts.KEPT_MOTION):
            return self._motion_rules[int(F.TRAVERSE)]
        if active is None or active.function is F.MOTION_CANCEL:
            why = "no motion code before" if active is None else "G80"
            hint = "G0 or G1 on this line says how to go there"
            if active is None:
                hint += f"; {accepts.KEPT_MOTION.hint}"
            raise Refusal(codes.AXIS_WORDS_UNUSED.at(line.span, why=why, hint=hint))
        return active

    # steps 2 to 5

    def _feed_mode(self, line: Line) -> None:
        rule = line.group("G5")
        if rule is None:
            return
        mode = rule.tenths // 10
        if mode != self.modal.feed_mode:
            # A number of one mode means nothing in another.
            self.modal.feed_mode, self.modal.feed = mode, 0.0
            self._state_changed()

    def _feed(self, line: Line) -> None:
        value = line.values.get("F")
        if value is None:
            return
        s = self.modal
        if isinstance(value, Unknown):
            self._feed_given(math.nan)
            return
        if value < 0:
            raise Refusal(codes.NEGATIVE_FEED.at(line.where("F"), value=value))
        units = line.group("G6")
        if units is not None and (units.function is F.UNITS_INCH) != (s.unit == INCH) and s.feed_mode != 93:
            self.findings.add(
                codes.FEED_IN_OLD_UNITS.at(
                    line.where("F"), value=value, code=units.text, units="inches" if s.unit == INCH else "mm"
                )
            )
        feed = value if s.feed_mode == 93 else value * s.unit
        self._feed_given(math.nan if s.unknown_modes & OF_FEEDS else feed)

    def _feed_given(self, feed: float) -> None:
        s = self.modal
        s.feed = feed
        if s.feed_unit != s.unit:
            s.feed_unit = s.unit
            self._state_changed()

    def _select_tool(self, line: Line) -> None:
        if "T" not in line.values:
            return
        highest = self.program.rules.highest_tool
        if isinstance(line.values["T"], Unknown):
            self.modal.selected_tool = None
        tool = line.whole("T", self.program.rules.integer_tolerance)
        if tool is None or not 0 <= tool <= highest:
            raise Refusal(codes.TOOL_NUMBER.at(line.where("T"), value=tool, highest=highest))
        self.modal.selected_tool = tool

    # steps 6 to 10

    def _change_tool(self, line: Line) -> None:
        s = self.modal
        s.stated.add("spindle")
        if s.spindle_direction:
            s.spindle_direction = 0
            self.spindle_row(line)
        s.tool = s.selected_tool
        self._state_changed()
        number = math.nan if s.tool is None else float(s.tool)
        self.event(Op.TOOL_CHANGE, line.span, arg=(number, 0.0))
        if s.length_follows_tool:
            self._use_length(line, s.tool)
        changer = self.program.overrides.get(("M", 60))
        if self.machine.controller.auto_tool_change and changer in self._depth:
            return
        if self.machine.controller.auto_tool_change:
            # The changer's own motion stands in a change_tool subprogram that was not given: not known.
            self._fail(codes.UNSUPPORTED_CODE.at(line.span, code="M6 on a machine that changes tools by itself"))
        else:
            if changer is None and len(self.program.files) == 1:
                self.assumed["no macro file is loaded with the job, so that M6 runs no change_tool (4.3)"] = None
            self._note_stop(line, "M6")
            self._end_section(Wait.TOOL_CHANGE, "tool changed", None, line.span)

    def _coolant(self, line: Line) -> None:
        s = self.modal
        for rule in line.rules:
            if rule.group != "M8":
                continue
            s.mist = rule.function is F.MIST_ON or (s.mist and rule.function is not F.COOLANT_OFF)
            s.flood = rule.function is F.FLOOD_ON or (s.flood and rule.function is not F.COOLANT_OFF)
            self.event(Op.COOLANT, line.span, arg=(float(s.mist), float(s.flood)))

    def _input(self, line: Line) -> None:
        """M56: an input into #5399, at once or when it has come or a time is over (3.5.9)."""
        rule = line.find(F.INPUT_READ)
        if rule is None:
            return
        tolerance = self.program.rules.integer_tolerance
        digital, analog = line.whole("P", tolerance), line.whole("E", tolerance)
        wait, timeout = line.whole("L", tolerance), number_or_open(self, line, "Q", rule.text)
        if (digital is None) == (analog is None):
            raise Refusal(codes.INPUT_CHANNEL.at(line.where_code(rule), what="M56 takes one input: P or E"))
        if wait not in (None, 0, 1, 2) or (wait and digital is None):
            raise Refusal(codes.INPUT_CHANNEL.at(line.where("L"), what="L is 0, 1 or 2, for an input in P"))
        if timeout is not None and timeout < 0:
            raise Refusal(codes.INPUT_CHANNEL.at(line.where("Q"), what=f"a timeout of {timeout:g} s"))
        channel = float(digital if digital is not None else analog or 0)
        if channel < 0:
            raise Refusal(codes.INPUT_CHANNEL.at(line.where_code(rule), what=f"there is no input {channel:g}"))
        wanted = math.nan if not wait else float(wait == 1)
        self.event(Op.INPUT_WAIT, line.span, arg=(channel, wanted))
        read = Unknown(f"input {channel:g}", 0.0, 1.0) if digital is not None else Unknown(f"analog input {channel:g}")
        # Without Q a wait may be endless or not: both answers are possible, as with it.
        self.modal.parameters[5399] = self.modal.stated_range(5399, read)
        stays = self.setup.inputs.get(digital) if digital is not None else None
        if stays is not None and wait != _FOR_HIGH:
            # Behind L2 the input's state and "timed out" are one number, behind L1 they are not.
            self.modal.parameters[5399] = stays
        self._end_section(Wait.INPUT, "read" if not wait else "come or timed out", None, line.span)

    def _dwell(self, line: Line) -> None:
        rule = line.find(F.DWELL)
        if rule is None:
            return
        seconds = number_or_open(self, line, "P", rule.text)
        if seconds is None:
            raise Refusal(codes.DWELL_MISSING.at(line.where_code(rule), code=rule.text))
        if seconds < 0:
            raise Refusal(codes.DWELL_NEGATIVE.at(line.where("P"), seconds=seconds))
        self.event(Op.DWELL, line.span, arg=(seconds, 0.0))

    # steps 11 to 18

    def _plane(self, line: Line) -> None:
        rule = line.group("G2")
        if rule is None:
            return
        plane = {F.PLANE_XY: Plane.XY, F.PLANE_XZ: Plane.XZ}.get(rule.function, Plane.YZ)
        compensated.keep_plane(self.modal, plane, line, rule)
        self.modal.plane = plane
        self.modal.stated.add("plane")
        self.event(Op.PLANE, line.span, arg=(float(self.modal.plane), 0.0))

    def _units(self, line: Line) -> None:
        rule = line.group("G6")
        if rule is None:
            return
        compensated.keep_units(self.modal, line, rule)
        self.modal.unit = INCH if rule.function is F.UNITS_INCH else 1.0
        self.modal.stated.add("units")
        self._state_changed()
        self.event(Op.UNITS, line.span, arg=(self.modal.unit, 0.0))

    def _path_mode(self, line: Line) -> None:
        rule = line.group("G13")
        if rule is None:
            return
        s = self.modal
        s.stated.add("path")
        s.path_mode = {F.EXACT_PATH: PathMode.EXACT_PATH, F.EXACT_STOP: PathMode.EXACT_STOP}.get(
            rule.function, PathMode.CONTINUOUS
        )
        tolerance = width_or_open(self, line, "P", rule.text) if rule.function is F.CONTINUOUS else None
        simplify, angle = width_or_open(self, line, "Q", rule.text), line.number("R")
        for letter, value in (("P", tolerance), ("Q", simplify)):
            if value is not None and value < 0.0:
                what = f"a path can not be kept within {value:g}"
                raise Refusal(codes.ILLEGAL_VALUE.at(line.where(letter), word=letter, what=what))
        if angle is not None and not 0.0 <= angle <= 180.0:
            what = f"a look-ahead angle of {angle:g} degrees; 0 to 180 make sense"
            raise Refusal(codes.ILLEGAL_VALUE.at(line.where("R"), word="R", what=what))
        s.path_tolerance = 0.0 if tolerance is None else tolerance * s.unit
        s.simplify = 0.0 if simplify is None else simplify * s.unit
        s.laf_angle = math.nan if angle is None else angle
        self._state_changed()
        self.event(Op.PATH_MODE, line.span, arg=(float(s.path_mode), s.path_tolerance))

    def _distance_and_retract(self, line: Line) -> None:
        rule = line.group("G3")
        if rule is not None:
            self.modal.absolute = rule.function is F.ABSOLUTE
            self.modal.stated.add("distance")
        rule = line.group("G10")
        if rule is not None:
            self.modal.stated.add("retract")
            self.modal.retract_initial = rule.function is F.RETRACT_INITIAL

    # step 21

    def _stop(self, line: Line) -> None:
        rule = line.group("M4")
        if rule is None:
            return
        s = self.modal
        if rule.function in (F.STOP, F.OPTIONAL_STOP, F.STOP_KEEP):
            optional = rule.function is F.OPTIONAL_STOP
            if optional and self.setup.optional_stop is False:
                return
            self.event(Op.STOP, line.span, arg=(float(optional), 0.0))
            self._note_stop(line, rule.text)
            self._end_section(Wait.OPERATOR, "cycle start", None, line.span)
            return
        if rule.function is F.END_RESET:
            if s.spindle_direction:
                s.spindle_direction = 0
                self.spindle_row(line)
            if s.mist or s.flood:
                s.mist = s.flood = False
                self.event(Op.COOLANT, line.span)
        self.event(Op.END, line.span)
        self._end = rule.text, line.span.line
        self._end_section(Wait.END, "end", -1, line.span)
        raise ProgramEnd
