"""Where numbers count from: tool length offsets, coordinate systems, G92, G10, and the park positions.

Eding CNC manual 3.4.5 (G10), 3.4.8 (G28, G30), 3.4.12 (G43), 3.4.15 (G54 to G59.3) and 3.4.23 (G92), in the order of
table 3-7.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from gproof.ir import codes
from gproof.ir.dialects.accepts import MACHINE_POSITION, SHOWN_POSITION
from gproof.ir.finding import Refusal, Span
from gproof.ir.intervals import ANY
from gproof.ir.machine import AXES, AXIS_NAMES
from gproof.ir.rules import CodeRule
from gproof.ir.rules import Function as F
from gproof.ir.symbolic import NOBODY, NOWHERE, ORIGIN, Position, Unknown, Value
from gproof.ir.symbols import ACTUAL, STORED
from gproof.ir.trace import Op
from gproof.passes.interpret.core.modal_state import NO_OFFSET
from gproof.passes.interpret.core.parsed_line import LARGEST, Line
from gproof.passes.interpret.core.tool_table import TOOL_LENGTH, TOOL_X_OFFSET
from gproof.passes.interpret.eding import compensation_codes as compensated
from gproof.passes.interpret.eding.axis_targets import aim, bounded, named_place, note_assumptions
from gproof.passes.interpret.eding.transform_codes import shifts

if TYPE_CHECKING:
    from gproof.passes.interpret.core.run import Run

_AXIS_OFFSETS = (F.AXIS_OFFSET_SET, F.AXIS_OFFSET_RESET, F.AXIS_OFFSET_SUSPEND, F.AXIS_OFFSET_RESTORE)


def length_offset(run: Run, line: Line) -> None:
    """G43, G43.1 and G49 (3.4.12)."""
    rule = line.group("G8")
    if rule is None:
        return
    s = run.modal
    s.stated.add("length")
    s.length_follows_tool, s.offset_tool = False, None
    if rule.function is F.TOOL_OFFSET_OFF:
        s.tool_offset, s.length_tool = list(NO_OFFSET), 0
        run.state_changed()
        run.event(Op.TOOL_OFFSET, line.span)
        return
    if rule.function is F.TOOL_OFFSET_DYNAMIC:
        x, z = line.number("I"), line.number("K")
        if x is None and z is None:
            raise Refusal(codes.MISSING_VALUE.at(line.where_code(rule), letter="G43.1 I or K"))
        s.tool_offset = list(NO_OFFSET)
        s.tool_offset[0], s.tool_offset[2] = Position((x or 0.0) * s.unit), Position((z or 0.0) * s.unit)
        s.length_tool, s.lengths_used = s.tool, True
        run.state_changed()
        run.event(Op.TOOL_OFFSET, line.span)
        return
    tool = line.whole("H", run.program.rules.integer_tolerance)
    if tool is not None and not 1 <= tool <= run.program.rules.highest_tool:
        raise Refusal(codes.TOOL_OFFSET_NUMBER.at(line.where("H"), value=tool, highest=run.program.rules.highest_tool))
    s.length_follows_tool = tool is None
    use_length(run, line, s.tool if tool is None else tool)


def use_length(run: Run, line: Line, tool: int | None) -> None:
    """The length of a tool by the table is in force; None: of a tool that is not known."""
    s = run.modal
    s.tool_offset, s.offset_tool = list(NO_OFFSET), tool
    s.length_tool, s.lengths_used = tool, True
    run.state_changed()
    if tool is None:
        s.tool_offset[2] = NOWHERE
        run.fail(codes.TOOL_OFFSET_UNKNOWN.at(line.span, hint="program T and M6, or state tool in the setup file"))
    else:
        s.tool_offset[2] = _table_length(run, s.length_of(tool), s.parameters.get(TOOL_LENGTH + tool))
        x = s.tool_x_offset(tool)
        s.tool_offset[0] = NOWHERE if isinstance(x, Unknown) else Position(x)
    run.event(Op.TOOL_OFFSET, line.span, arg=(math.nan if tool is None else float(tool), 0.0))


def _table_length(run: Run, length: Position, written: Value | None) -> Position:
    """A length that is only bounded, as one that was measured, is an unknown of its own."""
    if not isinstance(written, Unknown) or not written.bounded:
        return length
    unit = run.machine.unit
    return run.unknown_place("length", 2, (written.low * unit, written.high * unit), Position(0.0))


def table_written(run: Run, number: int, span: Span) -> None:
    """GP298 when the program writes the length or X offset that is in use: whether it acts at once is open."""
    s = run.modal
    if TOOL_LENGTH < number < TOOL_X_OFFSET + 100:
        run.state_changed()  # rows carry what is known of the tool
    if s.offset_in_use(number):
        what, hint = f"#{number}", "program G10 L2, G92 or the coordinate system again: then it is clear when it acts"
        run.findings.add(codes.OFFSET_IN_USE.at(span, what=what, hint=hint))
        return
    if not s.offset_tool:
        return
    for base, axis in ((TOOL_LENGTH, 2), (TOOL_X_OFFSET, 0)):
        if number == base + s.offset_tool:
            s.tool_offset[axis] = NOWHERE
            run.state_changed()
            what = f"#{number} of tool {s.offset_tool}"
            run.findings.add(codes.OFFSET_IN_USE.at(span, what=what, hint="program G43 after it"))


def coordinate_system(run: Run, line: Line) -> None:
    """G54 to G59.3 (3.4.15)."""
    rule = line.group("G12")
    if rule is None:
        return
    compensated.keep_offsets(run.modal, line, rule)
    run.modal.work = rule.value
    run.modal.use_written_work()
    run.state_changed()
    run.event(Op.OFFSET, line.span, arg=(float(rule.value), 0.0))


def once(run: Run, line: Line) -> None:
    """The codes of group 0: park positions, G10, G92 (3.4.5, 3.4.8, 3.4.23)."""
    rule = line.group("G0")
    if rule is None:
        return
    s = run.modal
    if rule.uses_axes and line.axes():
        note_assumptions(run, line, rule)
    if rule.function in _AXIS_OFFSETS:
        compensated.keep_offsets(s, line, rule)
        _note_stored(run, line, rule)
    if rule.function in (F.PARK_1, F.PARK_2):
        compensated.no_parking(s, line, rule)
        _park(run, line, "park_1" if rule.function is F.PARK_1 else "park_2")
    elif rule.function is F.SET_COORDINATES:
        _set_coordinates(run, line, rule)
    elif rule.function is F.AXIS_OFFSET_SET:
        for axis, value in line.axes().items():
            # The origin moves so that the current point gets the given number (3.4.23).
            wanted = _back(run, axis, value)
            s.g92[axis] = wanted.minus(s.work_offsets[s.work, axis]).minus(s.beside_work(axis))
        if shifts(run, line, rule):
            s.g92[0] = s.g92[1] = NOWHERE
        s.g92_stored = list(s.g92)
        run.event(Op.OFFSET, line.span)
    elif rule.function is F.AXIS_OFFSET_RESET:
        s.g92, s.g92_stored = list(NO_OFFSET), list(NO_OFFSET)
        run.event(Op.OFFSET, line.span)
    elif rule.function is F.AXIS_OFFSET_SUSPEND:
        s.g92 = list(NO_OFFSET)
        run.event(Op.OFFSET, line.span)
    elif rule.function is F.AXIS_OFFSET_RESTORE:
        s.g92 = list(s.g92_stored)
        run.event(Op.OFFSET, line.span)


def _note_stored(run: Run, line: Line, rule: CodeRule) -> None:
    """G92.3 brings back what #5211 to #5216 hold, which G92.2 leaves when it ends the offset itself (3.4.23)."""
    s = run.modal
    if rule.function is F.AXIS_OFFSET_RESTORE and "stored" not in s.stated and s.setup.default_offset is None:
        if s.offset_is_stored:
            run.assumed["#5211 to #5216 hold the G92 offset that is active at the start"] = None
        # Each axis has its own: what is not known is an unknown of its own, wherever the axis goes with it.
        for axis in range(AXES):
            if s.g92_stored[axis] == NOWHERE:
                s.g92_stored[axis] = run.unknown_place(STORED, axis, ANY, ORIGIN)
    if rule.function in (F.AXIS_OFFSET_SET, F.AXIS_OFFSET_RESET):
        s.stated.add("stored")


def _park(run: Run, line: Line, kind: str) -> None:
    """Through the programmed point, if any, to the park position; every axis goes (3.4.8)."""
    axes = line.axes()
    if axes:
        run.move(Op.TRAVERSE, aim(run, line), line.span)
    home = list(run.modal.position)
    for axis in range(AXES):
        if run.modal.has_axis(axis):
            home[axis] = run.modal.park_position(kind, axis)
            if abs(home[axis].value) > LARGEST:
                what = f"the park position of {AXIS_NAMES[axis].upper()} is too far away for any machine"
                raise Refusal(codes.ARITHMETIC.at(line.span, what=what))
    unknown = [AXIS_NAMES[a].upper() for a in range(AXES) if home[a].form == NOWHERE.form]
    if unknown:
        number = 5161 if kind == "park_1" else 5181
        run.findings.add(
            codes.UNKNOWN_VALUE.at(
                line.span, word=f"the park position of {' '.join(unknown)}",
                cause=f"parameters #{number} to #{number + 5}", why=NOBODY,
                hint="state them under [parameters] in the setup file",
            )
        )  # fmt: skip
    run.move(Op.TRAVERSE, home, line.span)


def _back(run: Run, axis: int, value: Value) -> Position:
    """The place that is so far before the present one that this gets the number ``value``."""
    at = run.modal.position[axis]
    if axis in run.modal.transform.loose or (axis == 2 and run.modal.transform.upright != 1.0):
        # Of X and Y it is open whether the number is one before or after scaling (GP276), and no less of these.
        return NOWHERE
    if isinstance(value, Unknown):
        return bounded(run, axis, Unknown(value.cause, -value.high, -value.low), at)
    return at.moved(-value * run.modal.scale(axis))


def _from_actual(run: Run, axis: int, wanted: Position) -> Position:
    """G10 L20's zero, ``wanted`` when nothing but the work's offset is in force.

    "Actual machine position, similar to G92" (3.4.5): what G92 and the tool's length have shifted is taken out, or
    not. What a head has shifted always is.
    """
    s = run.modal
    g92, length = s.g92[axis], s.tool_offset[axis]
    wanted = wanted.minus(s.beside_work(axis)).plus(length)
    aside = [more for more in (g92, length) if more != ORIGIN]
    if not aside or (not run.takes(SHOWN_POSITION) and run.takes(MACHINE_POSITION)):
        return wanted
    if SHOWN_POSITION.name in run.machine.controller.accepts:
        return wanted.minus(g92).minus(length)
    if any(more.form for more in aside):
        return run.unknown_place(ACTUAL, axis, ANY, ORIGIN)
    low = sum(min(0.0, -more.value) for more in aside)
    high = sum(max(0.0, -more.value) for more in aside)
    return run.unknown_place(ACTUAL, axis, (low, high), wanted)


def _set_coordinates(run: Run, line: Line, rule: CodeRule) -> None:
    """G10 L2: the origin is given; G10 L20: the current point gets the given numbers (3.4.5)."""
    s = run.modal
    key = line.whole("L", run.program.rules.integer_tolerance)
    if key not in (2, 20):
        given = "" if key is None else f", not L{key}"
        raise Refusal(codes.G10_KEY.at(line.where("L"), given=given))
    number = line.number("P")
    system = -1 if number is None else round(number)
    if number is None or abs(number - system) > run.program.rules.integer_tolerance or not 1 <= system <= 9:
        raise Refusal(codes.COORDINATE_SYSTEM_RANGE.at(line.where("P"), value=math.nan if number is None else number))
    if s.work == system:
        compensated.keep_offsets(s, line, rule)
    if s.work == 0:
        # Which system is active is not stated: it may be the one that changes here.
        for axis in line.axes():
            s.work_offsets[0, axis] = NOWHERE
    for axis, value in line.axes().items():
        s.written_work.pop((system, axis), None)
        if key == 20:
            s.work_offsets[system, axis] = _from_actual(run, axis, _back(run, axis, value))
        elif isinstance(value, Unknown):
            s.work_offsets[system, axis] = named_place(run, axis, value, ORIGIN) or bounded(run, axis, value, ORIGIN)
        else:
            s.work_offsets[system, axis] = Position(value * s.scale(axis))
    if key == 20 and shifts(run, line, rule):
        s.work_offsets[system, 0] = s.work_offsets[system, 1] = NOWHERE
    run.event(Op.OFFSET, line.span, arg=(float(system), 0.0))
