"""One line of words, executed step by step in the order of the Eding CNC manual 3.7 (table 3-7)."""

from __future__ import annotations

import functools
import math
from typing import TYPE_CHECKING

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
from gproof.passes.interpret.core.run import ProgramEnd
from gproof.passes.interpret.eding import compensation_codes as compensated
from gproof.passes.interpret.eding import heads, spindle
from gproof.passes.interpret.eding import overrides as feed_override
from gproof.passes.interpret.eding.axis_targets import aim
from gproof.passes.interpret.eding.cycle_motions import CYCLES
from gproof.passes.interpret.eding.moves import motion, set_motion
from gproof.passes.interpret.eding.outputs_and_waits import run_outputs
from gproof.passes.interpret.eding.remapped_codes import Words, replaced
from gproof.passes.interpret.eding.transform_codes import frame_of, run_transform
from gproof.passes.interpret.eding.work_offsets import coordinate_system, length_offset, once, use_length

if TYPE_CHECKING:
    from gproof.passes.interpret.core.run import Run

_FOR_HIGH = 1
"""L of M56: wait for high."""


def execute_line(run: Run, span: Span, words: list[Words]) -> None:
    """One line: by the subprogram that replaces a code of it (4.4, 3.5.3), else as the controller's own."""
    try:
        found = replaced(run.program, run.flow.called, words, span)
    except Refusal as refusal:
        run.refuse(run.as_accepted(refusal.finding))
        return
    if found is None:
        execute_own(run, span, words)
        return
    if found.before:
        execute_own(run, span, found.before)
    for number, value in found.arguments:
        run.modal.parameters[number] = value
    run.flow.call_subprogram(found.name, span, (span, found.after) if found.after else None)


def execute_own(run: Run, span: Span, words: list[Words]) -> None:
    """One line as the controller's own, whatever a subprogram replaces."""
    line: Line | None = None
    try:
        line = gather(run.program.rules, span, words)
        unsupported = line.find(F.UNSUPPORTED)
        if unsupported is None:
            _execute(run, line)
        else:
            _beside(run, line, unsupported)
    except Refusal as refusal:
        finding = run.as_accepted(refusal.finding)
        _recover(run, words, line, refusal, finding)
        run.refuse(finding, told=isinstance(refusal, FollowsRefusal))


def _beside(run: Run, line: Line, unsupported: CodeRule) -> None:
    """GP113 for a code that is not modelled; what else the line says counts.

    Where such a code takes the axis words, it is not known where the axes are after it.
    """
    what = f"{unsupported.text} ({unsupported.open})" if unsupported.open else unsupported.text
    run.fail(codes.UNSUPPORTED_CODE.at(line.where_code(unsupported), code=what))
    line.used.update(line.values)
    if not unsupported.uses_axes:
        _execute(run, line)
        return
    if unsupported.group == "G1":
        run.modal.motion = F.UNSUPPORTED
    _settings(run, line)
    for axis in line.axes():
        run.modal.position[axis] = NOWHERE
    _stop(run, line)


def _recover(
    run: Run, words: list[tuple[str, Value, Span]], line: Line | None, refusal: Refusal, finding: Finding
) -> None:
    """After an error what the line may have changed is not known.

    A cycle that did not start is in force nevertheless: the places of the lines after it are holes.
    """
    where = None if line is None or not line.find(F.ARC_CW, F.ARC_CCW) else functools.partial(aim, run, line)
    refused_lines.refuse_words(run, words, AXIS_INDEX, refusal, finding, where)
    cycle = None if line is None else line.group("G1")
    if cycle is not None and cycle.function in CYCLES:
        run.modal.motion = F.UNSUPPORTED


def _execute(run: Run, line: Line) -> None:
    """The steps of table 3-7, in its order (the comment, step 1, is the frontend's)."""
    owner = _axis_owner(run, line)
    if run.modal.unknown_modes and _rests_on_lost(run, line):
        return
    before = frame_of(run.modal, line)
    _settings(run, line)
    run_transform(run, line, before)
    refused_lines.restate(run, line.rules, bool(line.axes()))
    once(run, line)
    if owner is not None:
        motion(run, line, owner)
    elif (rule := line.group("G1")) is not None and rule.function is F.MOTION_CANCEL:
        set_motion(run, rule)
    if "E" in line.values and "E" not in line.used and run.machine.controller.extruder:
        line.used.add("E")
        run.fail(codes.UNSUPPORTED_CODE.at(line.where("E"), code="E, the extruder of a 3D printer (2.11)"))
    check_unused(line)
    _stop(run, line)


def _rests_on_lost(run: Run, line: Line) -> bool:
    """A line with a code that depends on what a refused line may have changed: what it would change is lost too."""
    has_axes = bool(line.axes())
    found = [rule for rule in line.rules if refused_lines.is_lost(run, rule, has_axes, line.span)]
    if not found:
        return False
    line.used.update(line.values)
    kept = [(r, w) for r, w in zip(line.rules, line.code_spans, strict=True) if r not in found]
    line.rules, line.code_spans = [rule for rule, _ in kept], [where for _, where in kept]
    if not any(rule.uses_axes for rule in found):
        _execute(run, line)
        return True
    _settings(run, line)
    refused_lines.restate(run, line.rules, has_axes)
    _stop(run, line)
    return True


def _settings(run: Run, line: Line) -> None:
    """Steps 2 to 18."""
    comp = run.modal.compensation
    offsets = [] if comp is None else [run.modal.beside_work(axis) for axis in range(AXES)]
    _feed_mode(run, line)
    _feed(run, line)
    spindle.speed_word(run, line)
    _select_tool(run, line)
    if line.find(F.TOOL_CHANGE):
        _change_tool(run, line)
    spindle.direction(run, line)
    heads.select(run, line)
    _coolant(run, line)
    feed_override.overrides(run, line)
    run_outputs(run, line)
    _input(run, line)
    _dwell(run, line)
    _plane(run, line)
    _units(run, line)
    compensated.switch(run, line)
    if line.group("G7") is not None:
        run.modal.stated.add("side")
    length_offset(run, line)
    compensated.keep_tool_and_head(comp, offsets, run.modal, line)
    coordinate_system(run, line)
    _path_mode(run, line)
    _distance_and_retract(run, line)


def _axis_owner(run: Run, line: Line) -> CodeRule | None:
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
            if not run.takes(accepts.MOTION_ALONE) or once is not None:
                where, hint = line.where_code(motion), accepts.MOTION_ALONE.hint
                raise Refusal(codes.AXIS_WORDS_MISSING.at(where, code=motion.text, hint=hint))
            set_motion(run, motion)
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
    if MOTION in run.modal.unknown_modes:
        return refused_lines.LOST_MOTION
    if run.modal.motion == F.UNSUPPORTED:
        # G33 and its like leave such a motion too, with nothing refused before.
        because = FollowsRefusal if run.refused else Refusal
        raise because(codes.UNSUPPORTED_CODE.at(line.span, code="the active motion"))
    active = run.motion_rules.get(run.modal.motion)
    if active is None and run.takes(accepts.KEPT_MOTION):
        return run.motion_rules[int(F.TRAVERSE)]
    if active is None or active.function is F.MOTION_CANCEL:
        why = "no motion code comes before" if active is None else "G80"
        hint = "program G0 or G1 on this line"
        if active is None:
            hint += f"; {accepts.KEPT_MOTION.hint}"
        raise Refusal(codes.AXIS_WORDS_UNUSED.at(line.span, why=why, hint=hint))
    return active


# steps 2 to 5


def _feed_mode(run: Run, line: Line) -> None:
    rule = line.group("G5")
    if rule is None:
        return
    mode = rule.tenths // 10
    if mode != run.modal.feed_mode:
        # A number of one mode means nothing in another.
        run.modal.feed_mode, run.modal.feed = mode, 0.0
        run.state_changed()


def _feed(run: Run, line: Line) -> None:
    value = line.values.get("F")
    if value is None:
        return
    s = run.modal
    if isinstance(value, Unknown):
        _feed_given(run, math.nan)
        return
    if value < 0:
        raise Refusal(codes.NEGATIVE_FEED.at(line.where("F"), value=value))
    units = line.group("G6")
    if units is not None and (units.function is F.UNITS_INCH) != (s.unit == INCH) and s.feed_mode != 93:
        run.findings.add(
            codes.FEED_IN_OLD_UNITS.at(
                line.where("F"), value=value, code=units.text, units="inches" if s.unit == INCH else "mm"
            )
        )
    feed = value if s.feed_mode == 93 else value * s.unit
    _feed_given(run, math.nan if s.unknown_modes & OF_FEEDS else feed)


def _feed_given(run: Run, feed: float) -> None:
    s = run.modal
    s.feed = feed
    if s.feed_unit != s.unit:
        s.feed_unit = s.unit
        run.state_changed()


def _select_tool(run: Run, line: Line) -> None:
    if "T" not in line.values:
        return
    highest = run.program.rules.highest_tool
    if isinstance(line.values["T"], Unknown):
        run.modal.selected_tool = None
    tool = line.whole("T", run.program.rules.integer_tolerance)
    if tool is None or not 0 <= tool <= highest:
        raise Refusal(codes.TOOL_NUMBER.at(line.where("T"), value=tool, highest=highest))
    run.modal.selected_tool = tool


# steps 6 to 10


def _change_tool(run: Run, line: Line) -> None:
    s = run.modal
    s.stated.add("spindle")
    if s.spindle_direction:
        s.spindle_direction = 0
        run.spindle_row(line)
    s.tool = s.selected_tool
    run.state_changed()
    number = math.nan if s.tool is None else float(s.tool)
    run.event(Op.TOOL_CHANGE, line.span, arg=(number, 0.0))
    if s.length_follows_tool:
        use_length(run, line, s.tool)
    changer = run.program.overrides.get(("M", 60))
    if run.machine.controller.auto_tool_change and changer in run.flow.called:
        return
    if run.machine.controller.auto_tool_change:
        # The changer's own motion is in a change_tool subprogram that was not given: not known.
        run.fail(codes.UNSUPPORTED_CODE.at(line.span, code="M6 on a machine with automatic tool change"))
    else:
        if changer is None and len(run.program.files) == 1:
            run.assumed["no macro file is loaded with the job, so that M6 runs no change_tool (4.3)"] = None
        run.note_stop(line, "M6", tool=True)
        run.end_section(Wait.TOOL_CHANGE, "tool changed", None, line.span)


def _coolant(run: Run, line: Line) -> None:
    s = run.modal
    for rule in line.rules:
        if rule.group != "M8":
            continue
        s.mist = rule.function is F.MIST_ON or (s.mist and rule.function is not F.COOLANT_OFF)
        s.flood = rule.function is F.FLOOD_ON or (s.flood and rule.function is not F.COOLANT_OFF)
        run.event(Op.COOLANT, line.span, arg=(float(s.mist), float(s.flood)))


def _input(run: Run, line: Line) -> None:
    """M56: an input into #5399, at once or when it has come or a time is over (3.5.9)."""
    rule = line.find(F.INPUT_READ)
    if rule is None:
        return
    tolerance = run.program.rules.integer_tolerance
    digital, analog = line.whole("P", tolerance), line.whole("E", tolerance)
    wait, timeout = line.whole("L", tolerance), number_or_open(run, line, "Q", rule.text)
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
    run.event(Op.INPUT_WAIT, line.span, arg=(channel, wanted))
    read = Unknown(f"input {channel:g}", 0.0, 1.0) if digital is not None else Unknown(f"analog input {channel:g}")
    # Without Q a wait may be endless or not: both answers are possible, as with it.
    run.modal.parameters[5399] = run.modal.stated_range(5399, read)
    if digital is not None and not wait:
        run.inputs_read[id(read)] = read, digital, run.rows.sections + 1
    stays = run.setup.inputs.get(digital) if digital is not None else None
    if stays is not None and wait != _FOR_HIGH:
        # After L2 the input's state and "timed out" are one number, after L1 they are not.
        run.modal.parameters[5399] = stays
    run.end_section(Wait.INPUT, "read" if not wait else "come or timed out", None, line.span)


def _dwell(run: Run, line: Line) -> None:
    rule = line.find(F.DWELL)
    if rule is None:
        return
    seconds = number_or_open(run, line, "P", rule.text)
    if seconds is None:
        raise Refusal(codes.DWELL_MISSING.at(line.where_code(rule), code=rule.text))
    if seconds < 0:
        raise Refusal(codes.DWELL_NEGATIVE.at(line.where("P"), seconds=seconds))
    run.event(Op.DWELL, line.span, arg=(seconds, 0.0))


# steps 11 to 18


def _plane(run: Run, line: Line) -> None:
    rule = line.group("G2")
    if rule is None:
        return
    plane = {F.PLANE_XY: Plane.XY, F.PLANE_XZ: Plane.XZ}.get(rule.function, Plane.YZ)
    compensated.keep_plane(run.modal, plane, line, rule)
    run.modal.plane = plane
    run.modal.stated.add("plane")
    run.event(Op.PLANE, line.span, arg=(float(run.modal.plane), 0.0))


def _units(run: Run, line: Line) -> None:
    rule = line.group("G6")
    if rule is None:
        return
    compensated.keep_units(run.modal, line, rule)
    run.modal.unit = INCH if rule.function is F.UNITS_INCH else 1.0
    run.modal.stated.add("units")
    run.state_changed()
    run.event(Op.UNITS, line.span, arg=(run.modal.unit, 0.0))


def _path_mode(run: Run, line: Line) -> None:
    rule = line.group("G13")
    if rule is None:
        return
    s = run.modal
    s.stated.add("path")
    s.path_mode = {F.EXACT_PATH: PathMode.EXACT_PATH, F.EXACT_STOP: PathMode.EXACT_STOP}.get(
        rule.function, PathMode.CONTINUOUS
    )
    tolerance = width_or_open(run, line, "P", rule.text) if rule.function is F.CONTINUOUS else None
    simplify, angle = width_or_open(run, line, "Q", rule.text), line.number("R")
    for letter, value in (("P", tolerance), ("Q", simplify)):
        if value is not None and value < 0.0:
            what = f"a path tolerance of {value:g} is not possible"
            raise Refusal(codes.ILLEGAL_VALUE.at(line.where(letter), word=letter, what=what))
    if angle is not None and not 0.0 <= angle <= 180.0:
        what = f"a look-ahead angle of {angle:g} degrees; 0 to 180 degrees make sense"
        raise Refusal(codes.ILLEGAL_VALUE.at(line.where("R"), word="R", what=what))
    s.path_tolerance = 0.0 if tolerance is None else tolerance * s.unit
    s.simplify = 0.0 if simplify is None else simplify * s.unit
    s.laf_angle = math.nan if angle is None else angle
    run.state_changed()
    run.event(Op.PATH_MODE, line.span, arg=(float(s.path_mode), s.path_tolerance))


def _distance_and_retract(run: Run, line: Line) -> None:
    rule = line.group("G3")
    if rule is not None:
        run.modal.absolute = rule.function is F.ABSOLUTE
        run.modal.stated.add("distance")
    rule = line.group("G10")
    if rule is not None:
        run.modal.stated.add("retract")
        run.modal.retract_initial = rule.function is F.RETRACT_INITIAL


# step 21


def _stop(run: Run, line: Line) -> None:
    rule = line.group("M4")
    if rule is None:
        return
    s = run.modal
    if rule.function in (F.STOP, F.OPTIONAL_STOP, F.STOP_KEEP):
        optional = rule.function is F.OPTIONAL_STOP
        if optional and run.setup.optional_stop is False:
            return
        run.event(Op.STOP, line.span, arg=(float(optional), 0.0))
        run.note_stop(line, rule.text)
        run.end_section(Wait.OPERATOR, "cycle start", None, line.span)
        return
    if rule.function is F.END_RESET:
        if s.spindle_direction:
            s.spindle_direction = 0
            run.spindle_row(line)
        if s.mist or s.flood:
            s.mist = s.flood = False
            run.event(Op.COOLANT, line.span)
    run.event(Op.END, line.span, arg=(0.0, float(rule.function is F.END_RESET)))
    run.ended_by = rule.text, line.span.line
    run.end_section(Wait.END, "end", -1, line.span)
    raise ProgramEnd
