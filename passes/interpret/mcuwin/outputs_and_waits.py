"""Dwells, outputs, stops, ends, application codes and settings of controllers of DIN blocks with Pascal inside.

APCI-8001 G-code manual 3.5 (G04), 3.23 (G74), chapter 4 (M codes), 5.3 to 5.6 (F, S, T, D), 11 and 12 (what programs
read). Task 0 is application code: a code does what the machine's file states. Of one about which it states nothing,
that which the manual says can move no axis does what the manual calls it; after any other the places are not known.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from gproof.ir import codes
from gproof.ir.dialects.mcuwin.rules import COMMON, DECLARED, PROTECTED
from gproof.ir.dialects.mcuwin.settings import VERSIONS, TaskCode
from gproof.ir.finding import FollowedRefusal, Refusal, Span
from gproof.ir.modal_groups import OF_FEEDS
from gproof.ir.program import PARAMETER, Input, Named
from gproof.ir.rules import CodeRule
from gproof.ir.rules import Function as F
from gproof.ir.symbolic import NOWHERE, Position, Unknown, Value, between
from gproof.ir.trace import Op, Wait
from gproof.passes.interpret.core.axis_words import letters_of
from gproof.passes.interpret.core.channels import value_of, with_pair
from gproof.passes.interpret.core.modal_state import ZERO
from gproof.passes.interpret.core.open_numbers import number_or_open, or_open
from gproof.passes.interpret.core.run import ProgramEnd
from gproof.passes.interpret.mcuwin.moves import Handler, tell_once
from gproof.passes.interpret.mcuwin.radius_correction import correct, note_no_table, unfollowed
from gproof.passes.interpret.mcuwin.state import din_of, has_tools, own_unit
from gproof.passes.interpret.mcuwin.zero_offsets import end_contour

if TYPE_CHECKING:
    from gproof.passes.interpret.mcuwin.parts import Part
    from gproof.passes.interpret.mcuwin.state import McuWinModal, McuWinRun

_BY_NAME = {
    F.SPINDLE_CW: "spindle_cw", F.SPINDLE_CCW: "spindle_ccw", F.SPINDLE_OFF: "spindle_off", F.FLOOD_ON: "coolant_on",
    F.COOLANT_OFF: "coolant_off", F.STOP: "stop", F.END: "end", F.END_RESET: "end",
}  # fmt: skip
"""What the manual calls a code (4.1 to 4.9, 4.13), where it can move no axis."""


# ---- Task 0


def task(run: McuWinRun, line: Part, rule: CodeRule) -> None:
    """A code that Task 0 executes."""
    stated = din_of(run.machine).task(rule.text)
    action = stated.action if stated is not None else _BY_NAME.get(rule.function, "unknown")
    if stated is None and action != "unknown":
        run.assumed[f"{rule.text} does what its name in the manual says, and moves no axis ({rule.source})"] = None
    act(run, line, rule, stated, action)


def _as_many_as_stated(run: McuWinRun, line: Part, stated: TaskCode | None, text: str, where: Span) -> None:
    """Refusal GP514 for a code with another number of parameters than the machine file states (14 (2.5.3.90))."""
    if stated is None or stated.parameters is None or len(line.values) == stated.parameters:
        return
    run.lose_places()
    given = f"{text} with {len(line.values)} parameter{'' if len(line.values) == 1 else 's'}"
    hint = f"check parameters of {text} under [din.task0] of the machine file: it is {stated.parameters}"
    raise Refusal(codes.TASK_UNKNOWN.at(where, code=given, hint=hint))


def act(run: McuWinRun, line: Part, rule: CodeRule, stated: TaskCode | None, action: str) -> None:
    """What a code does, by one of ``mcuwin_settings.ACTIONS``."""
    s = run.modal
    _as_many_as_stated(run, line, stated, rule.text, line.code_span())
    if stated is None or stated.breaks is not False:
        end_contour(run, line, rule.text)
    match action:
        case "spindle_cw" | "spindle_ccw" | "spindle_off":
            s.spindle_direction = {"spindle_cw": 1, "spindle_ccw": -1}.get(action, 0)
            s.stated.add("spindle")
            run.spindle_row(line)
        case "coolant_on" | "coolant_off":
            s.flood = action == "coolant_on"
            run.event(Op.COOLANT, line.span, arg=(0.0, float(s.flood)))
        case "tool_change":
            tool = s.selected_tool
            s.tool = tool
            run.state_changed()
            run.event(Op.TOOL_CHANGE, line.span, arg=(math.nan if tool is None else float(tool), 0.0))
            run.note_stop(line, rule.text, tool=True)
            run.end_section(Wait.TOOL_CHANGE, "tool changed", None, line.span)
        case "stop":
            _stop(run, line, rule)
        case "end":
            _end(run, line, rule)
        case "home":
            _home(run, line)
        case "nothing" | "tool_select" | "spindle_speed":
            run.event(Op.DEVICE, line.span, text=run.text_number(_as_written(line, rule)))
        case _:
            run.event(Op.DEVICE, line.span, text=run.text_number(_as_written(line, rule)))
            run.lose_places()
            shared = [number for number in s.parameters if number < DECLARED]
            s.parameters.update({number: Unknown(f"the state after {rule.text}") for number in shared})
            hint = f'state [din.task0] {rule.text} = "..." in the machine file'
            raise FollowedRefusal(codes.TASK_UNKNOWN.at(line.code_span(), code=rule.text, hint=hint))


def _as_written(line: Part, rule: CodeRule) -> str:
    words = (f"{'' if k == PARAMETER else k}{'?' if isinstance(v, Unknown) else format(v, 'g')}"
             for k, v in line.values.items())  # fmt: skip
    return " ".join([rule.text, *words])


def _stop(run: McuWinRun, line: Part, rule: CodeRule) -> None:
    optional = rule.function is F.OPTIONAL_STOP
    run.event(Op.STOP, line.span, arg=(float(optional), 0.0))
    run.note_stop(line, rule.text)
    run.end_section(Wait.OPERATOR, "cycle start", None, line.span)


def _end(run: McuWinRun, line: Part, rule: CodeRule) -> None:
    tell_mirrored(run)
    run.event(Op.END, line.span)
    run.ended_by = rule.text, line.span.line
    run.end_section(Wait.END, "end", -1, line.span)
    raise ProgramEnd


def tell_mirrored(run: McuWinRun) -> None:
    """GP169 for a job that is a mirror image as a whole: G21 to G23 are units and zones elsewhere (3.9 to 3.11)."""
    s = run.modal
    if s.own.mirrored is not None and run.moves:
        code, span = s.own.mirrored
        axes = " and ".join(run.machine.word(axis) for axis in sorted(s.own.reflected))
        hint = "leave it out if millimetres are meant (G71); program G24 before the end if mirroring is meant"
        if tell_once(run, "mirrored job"):
            run.findings.add(codes.MIRRORED_JOB.at(span, code=code, axes=axes, hint=hint))


def _home(run: McuWinRun, line: Part) -> None:
    """A reference run of the named axes, or of all: they are where the machine's file says, otherwise anywhere."""
    s = run.modal
    named = set(line.axes()) or {axis.index for axis in run.machine.axes}
    axes = [axis for axis in run.machine.axes if axis.index in named]
    unfollowed(run, line, "the reference run")
    run.event(Op.HOME, line.span, text=run.text_number(" ".join(axis.name for axis in axes)))
    for axis in axes:
        s.position[axis.index] = NOWHERE if axis.home_place is None else Position(axis.home_place)
    s.unhomed -= {axis.index for axis in axes}
    run.assumed["homing moves do not leave the machine"] = None
    run.findings.add(codes.HOMING.at(line.span, axes=" ".join(axis.word for axis in axes)))
    run.end_section(Wait.HOME, "homed", None, line.span)


def optional_stop(run: McuWinRun, line: Part, rule: CodeRule) -> None:
    """M01: a stop where the operator has switched it on (4.2); nothing where the setup states that it is off."""
    end_contour(run, line, rule.text)
    if run.setup.optional_stop is not False:
        _stop(run, line, rule)


def end(run: McuWinRun, line: Part, rule: CodeRule) -> None:
    """M02, M30: nothing of the job comes after; Task 0 is called, in V 2.5.3.32 not for M02 (4.3, 5.3 there)."""
    stated = din_of(run.machine).task(rule.text)
    quiet = rule.function is F.END and din_of(run.machine).version == VERSIONS[1]
    if stated is not None and stated.action == "unknown" and not quiet:
        hint = f'state [din.task0] {rule.text} = "..." in the machine file'
        run.fail(codes.TASK_UNKNOWN.at(line.code_span(), code=rule.text, hint=hint))
    _end(run, line, rule)


def stop(run: McuWinRun, line: Part, rule: CodeRule) -> None:
    """M00: the operator goes on; what Task 0 does besides may be stated."""
    stated = din_of(run.machine).task(rule.text)
    if stated is not None and stated.action == "unknown":
        act(run, line, rule, stated, "unknown")
    if stated is None:
        run.assumed[f"{rule.text} does what its name in the manual says, and moves no axis ({rule.source})"] = None
    end_contour(run, line, rule.text)
    _stop(run, line, rule)


def device(run: McuWinRun, line: Part, rule: CodeRule) -> None:
    """What moves nothing and changes no place."""
    run.event(Op.DEVICE, line.span, text=run.text_number(_as_written(line, rule)))


def application(run: McuWinRun, line: Part, rule: CodeRule) -> None:
    """G200 to G299, M200 to M299, M100 (4.17), and what else the machine's file declares."""
    task(run, line, rule)


def lose_all(run: McuWinRun, what: str) -> None:
    """After what nobody can follow: neither the places of axes nor the values of variables are known."""
    run.lose_places()
    s = run.modal
    s.parameters.update({number: Unknown(what) for number in s.parameters})


# ---- dwell and outputs


def dwell(run: McuWinRun, line: Part, rule: CodeRule) -> None:
    """G04: seconds."""
    seconds = number_or_open(run, line, PARAMETER, rule.text)
    assert seconds is not None
    if seconds < 0:
        raise Refusal(codes.DWELL_NEGATIVE.at(line.where(PARAMETER), seconds=seconds))
    run.modal.own = run.modal.own.but(contour=False)
    run.event(Op.DWELL, line.span, arg=(seconds, 0.0))


def _whole(run: McuWinRun, line: Part, rule: CodeRule, low: int, high: int) -> int:
    number = line.whole(PARAMETER, run.program.rules.integer_tolerance)
    assert number is not None
    if not low <= number <= high:
        raise Refusal(codes.PARAMETER_RANGE.at(
            line.where(PARAMETER), code=rule.text, word=str(number), allowed=f"{low} to {high}"))  # fmt: skip
    return number


def _channel_there(run: McuWinRun, line: Part, rule: CodeRule, channel: int) -> None:
    """GP296 for an axis channel that the board is stated not to have; GP113 where the machine's axes do not show it."""
    channels = din_of(run.machine).channels
    if channels is not None and channel > channels:
        raise Refusal(codes.AXIS_NOT_THERE.at(line.where(PARAMETER), axis=f"channel {channel} ({rule.text})"))
    if channels is None and channel > len(run.machine.axes):
        what = f"{rule.text} of axis {channel}; the machine file has {len(run.machine.axes)} axes"
        hint = "state channels under [din] of the machine file: how many the board has"
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.where(PARAMETER), code=what, hint=hint))


def output(run: McuWinRun, line: Part, rule: CodeRule) -> None:
    """M26, M27: axis number and output; 00: all outputs of the axis. Motion does not stop for it."""
    number = _whole(run, line, rule, 100, 999)
    _channel_there(run, line, rule, number // 100)
    on = float(rule.function is F.OUTPUT_ON)
    channels = range(number + 1, number + 100) if number % 100 == 0 else (number,)
    s = run.modal
    outputs = s.outputs
    for channel in channels:
        outputs = with_pair(outputs, channel, on)
    s.outputs = outputs
    run.event(Op.OUTPUT, line.span, arg=(float(number), on), text=1)


def output_word(run: McuWinRun, line: Part, rule: CodeRule) -> None:
    """M80: all outputs of an axis by the bits of a number; of its group, what the other axes have then is not known."""
    words = {letter: line.values[letter] for letter in line.columns if letter in line.values}
    if len(words) != 1:
        raise Refusal(codes.WORD_MISSING.at(line.code_span(), code=rule.text, needed="one axis with a number"))
    (letter,) = words
    bits = line.whole(letter, run.program.rules.integer_tolerance)
    assert bits is not None
    if not 0 <= bits < 1 << 32:
        raise Refusal(codes.PARAMETER_RANGE.at(
            line.where(letter), code=rule.text, word=letter, allowed="0 to 4294967295"))  # fmt: skip
    s = run.modal
    first = 100 * (1 + list(letters_of(run.machine)).index(letter))
    outputs = tuple((n, Unknown(f"output {n}, of the same group", 0.0, 1.0)) for n, _ in s.outputs)
    for k in range(1, 100):
        outputs = tuple(with_pair(outputs, first + k, float(bits >> (k - 1) & 1)))  # type: ignore[arg-type]
    s.outputs = outputs
    run.event(Op.OUTPUT, line.span, arg=(float(first), float(bits)), text=-1 - line.columns[letter])


# ---- resident variables


def save(run: McuWinRun, line: Part, rule: CodeRule) -> None:
    """M901, M903: a common variable is kept for later."""
    index = _whole(run, line, rule, 0, COMMON - 1)
    number = index + COMMON * rule.value
    s = run.modal
    s.own = s.own.but(saved=with_pair(s.own.saved, number, s.read(float(number), line.span)))
    device(run, line, rule)


def restore(run: McuWinRun, line: Part, rule: CodeRule) -> None:
    """M902, M904: what was kept, by this job or an earlier one."""
    index = _whole(run, line, rule, PROTECTED, COMMON - 1)
    number = index + COMMON * rule.value
    s = run.modal
    kept = value_of(s.own.saved, number)
    name = run.program.rules.name_of(number)
    if kept is None:
        stated, cause = run.setup.resident.get(number), f"what an earlier job kept of {name}"
        kept = Unknown(cause) if stated is None else between(cause, (stated.low, stated.high))
    s.parameters[number] = kept
    device(run, line, rule)


# ---- F, S, T, D

F_LOST = "the unit of F after a refused line"
"""Why the feed is not known of an F whose unit or mode is lost."""


def feed(run: McuWinRun, line: Part) -> None:
    """F: in interpolation units by the time unit that is in force (5.3, 3.28)."""
    value = line.values["F"]
    if not isinstance(value, Unknown) and value < 0:
        raise Refusal(codes.NEGATIVE_FEED.at(line.where("F"), value=value))
    take_feed(run.modal, value)


def take_feed(s: McuWinModal, value: Value) -> None:
    """``feed`` of a number that is not below 0."""
    if isinstance(value, Unknown):
        s.own = s.own.but(feed=math.nan, feed_cause=value.cause, asked="", given=True)
    elif s.own.time_unit is None and value != 0.0:
        cause = "whether F counts per minute or per second, which is unknown (IniCfg, 5.3)"
        s.own = s.own.but(feed=math.nan, feed_cause=cause, asked="", given=True)
    else:
        s.own = s.own.but(feed=value * s.unit * 60.0 / (s.own.time_unit or 60.0), asked="", given=True)
        if s.unknown_modes & OF_FEEDS:
            s.own = s.own.but(feed=math.nan, feed_cause=F_LOST)


def speed(run: McuWinRun, line: Part) -> None:
    """S: speed of the main spindle, by Task 0, which ends the contour (5.4)."""
    value = line.values["S"]
    s = run.modal
    stated = din_of(run.machine).task("S")
    if not isinstance(value, Unknown) and value < 0:
        raise Refusal(codes.ILLEGAL_VALUE.at(line.where("S"), word="S", what=f"a speed of {value:g}"))
    if stated is None or stated.breaks is not False:
        end_contour(run, line, "S")
    if stated is not None and stated.action == "unknown":
        run.lose_places()
        raise FollowedRefusal(codes.TASK_UNKNOWN.at(line.where("S"), code="S"))
    if stated is None:
        run.assumed["S sets the spindle speed and moves no axis (5.4)"] = None
    if stated is not None and stated.action == "nothing":
        run.event(Op.DEVICE, line.span, text=run.text_number("S"))
        return
    spindle = run.machine.spindle(0)
    least, most = (None, None) if spindle is None else (spindle.min_rpm, spindle.max_rpm)
    known = math.nan if isinstance(value, Unknown) else value
    if known > (math.inf if most is None else most) or 0.0 < known < (least or 0.0):
        # Error 4000 (13.1.1.25); a speed of 0 is a spindle that rests.
        high = "..." if most is None else f"{most:g}"
        run.findings.add(codes.SPINDLE_RANGE.at(line.where("S"), value=known, low=f"{least or 0.0:g}", high=high))
    s.spindle_speed = value
    rpm = math.nan if isinstance(value, Unknown) else value
    if s.spindle_direction:
        run.spindle_row(line)
    else:
        run.state_changed()
        run.event(Op.SETPOINT, line.span, arg=(0.0, rpm), text=run.text_number("spindle_speed"))


def tool(run: McuWinRun, line: Part) -> None:
    """T: the application's tool change, and the record of the radius table (5.5)."""
    s = run.modal
    number = line.whole("T", run.program.rules.integer_tolerance)
    assert number is not None
    if not 0 <= number <= run.program.rules.highest_tool:
        raise Refusal(codes.TOOL_NUMBER.at(line.where("T"), value=number, highest=run.program.rules.highest_tool))
    s.selected_tool = number
    stated = din_of(run.machine).task("T")
    note_no_table(run)
    if has_tools(run.machine) is not False:
        _record(run, line, number)
    action = "unknown" if stated is None else stated.action
    if action == "unknown":
        run.lose_places()
        hint = 'state [din.task0] T = "tool_select" or another function in the machine file'
        raise FollowedRefusal(codes.TASK_UNKNOWN.at(line.where("T"), code="T", hint=hint))
    if stated is None or stated.breaks is not False:
        end_contour(run, line, "T")
    if action == "tool_change":
        s.tool = number
        run.state_changed()
        run.event(Op.TOOL_CHANGE, line.span, arg=(float(number), 0.0))
        run.note_stop(line, "T", tool=True)
        run.end_section(Wait.TOOL_CHANGE, "tool changed", None, line.span)
    else:
        run.event(Op.DEVICE, line.span, text=run.text_number(f"T{number}"))


def _record(run: McuWinRun, line: Part, number: int) -> None:
    """The record that is in force; how a length in it acts, and when, is not described (2.7)."""
    s = run.modal
    tools = din_of(run.machine).tools
    s.own = s.own.but(tool=number, chosen=True)

    if s.own.idle:
        correct(run, line, s.own.idle)
    elif s.own.side:
        s.own = s.own.but(corrected=None)
        what = f"T{number} while the tool radius is corrected"
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.where("T"), code=what))
    if tools is None:
        lengths: list[float | None] = [None]
    else:
        lengths = [record.length for record in tools if record.number == number] or [None]
    before = list(s.tool_offset)
    if all(length == 0.0 for length in lengths) and all(place == ZERO for place in before):
        return
    if tools is not None and number == 0 and lengths == [None] and all(place == ZERO for place in before):
        return
    for axis in range(3):
        s.tool_offset[axis] = NOWHERE
    run.state_changed()
    what = (
        f"T{number}, whose length is not 0 or unknown (the manual does not say when it acts and along which axis, 2.7)"
    )
    run.fail(codes.UNSUPPORTED_CODE.at(line.where("T"), code=what))


def correction_table(run: McuWinRun, line: Part) -> None:
    """D: ignored unless Task 0 does something with it (5.6)."""
    stated = din_of(run.machine).task("D")
    value = line.values["D"]
    if stated is not None and stated.action == "unknown":
        run.lose_places()
        raise FollowedRefusal(codes.TASK_UNKNOWN.at(line.where("D"), code="D"))
    if stated is None:
        run.assumed["D does nothing (5.6)"] = None
        hint = (
            'select the record of the tool table with T; state what Task 0 does in [din.task0] D = "..." of the '
            "machine file"
        )
        run.findings.add(
            codes.COMMAND_IGNORED.at(
                line.where("D"), what="D, without a function of Task 0 in the machine file", hint=hint
            )
        )
    run.event(
        Op.DEVICE, line.span, text=run.text_number(f"D{'?' if isinstance(value, Unknown) else format(value, 'g')}")
    )


SETTINGS = {"F": feed, "S": speed, "T": tool, "D": correction_table}
"""What a word next to the codes of a line does: (run, words)."""


# ---- what programs read


def read_named(run: McuWinRun, node: Named) -> Value:
    """An axis qualifier: ``X.TP`` (target), ``X.RP`` (real place), ``X.ZEROOFFSET``; unknown where readings differ.

    A name without a qualifier is one whose value is not known, a finding of the frontend.
    """
    s = run.modal
    letter, point, what = node.name.upper().partition(".")
    if not point:
        return Unknown(node.name)
    axis = letters_of(run.machine).get(letter)
    if axis is None:
        raise Refusal(codes.BAD_EXPRESSION.at(node.span, what=f"{node.name}: the machine has no axis {letter}"))
    shaped = axis in s.own.reflected or axis in dict(s.own.radii)
    plain = s.unit == own_unit(run.machine, axis) == 1.0 and not shaped
    if what == "ZEROOFFSET" and (plain or s.g92[axis] == ZERO) and not s.g92[axis].form:
        return s.g92[axis].value
    if what == "TP" and plain and s.offset(axis) == ZERO and not s.own.side and not s.position[axis].form:
        return s.position[axis].value
    return Unknown(node.name)


def read_input(run: McuWinRun, node: Input) -> Value:
    """The state of a digital input, of which the number of its axis is in front (4.11, 7): the setup's, or open."""
    value = run.evaluator.value(node.number)
    if isinstance(value, Unknown):
        return Unknown(value.cause, 0.0, 1.0)
    number, axes = round(value), run.machine.axes
    known = run.setup.inputs.get(number)
    if known is not None:
        return known
    if 0 < number // 100 <= len(axes):
        return Unknown(f"input {axes[number // 100 - 1].word}.digib.{number % 100}", 0.0, 1.0)
    return Unknown(f"input {number}", 0.0, 1.0)


def wait(run: McuWinRun, seconds: Value, span: Span) -> None:
    """wt: in the unit of the machine's file."""
    number = or_open(run, seconds, "wt")
    if number < 0:
        raise Refusal(codes.DWELL_NEGATIVE.at(span, seconds=number))
    unit = din_of(run.machine).wait_unit
    run.assumed[f"wt counts {'milliseconds' if unit == 0.001 else 'seconds'}"] = None
    run.modal.own = run.modal.own.but(contour=False)
    run.event(Op.DWELL, span, arg=(number * unit, 0.0))


HANDLERS: dict[F, Handler] = {
    F.DWELL: dwell,
    F.HOME: task,
    F.STOP: stop,
    F.OPTIONAL_STOP: optional_stop,
    F.END: end,
    F.END_RESET: end,
    F.SPINDLE_CW: task,
    F.SPINDLE_CCW: task,
    F.SPINDLE_OFF: task,
    F.TOOL_CHANGE: task,
    F.FLOOD_ON: task,
    F.COOLANT_OFF: task,
    F.OUTPUT_ON: output,
    F.OUTPUT_OFF: output,
    F.OUTPUT_WORD: output_word,
    F.DEVICE: device,
    F.APPLICATION: application,
    F.SAVE_VARIABLE: save,
    F.RESTORE_VARIABLE: restore,
}
