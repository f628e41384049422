"""What McuWIN programs do besides moving, as operations: waits, outputs, stops, what Task 0 does, S, T and D.

Sections are those of the manual of V 2.5.3.133: 3.5, 3.23, chapters 4 and 5. Task 0 is application code: a code does
what the machine's file says; of one about which it says nothing, that which the manual says can move no axis does what
the manual calls it.
"""

from __future__ import annotations

from collections.abc import Callable

from gproof.frontend.common.raising import Unraisable
from gproof.frontend.common.raising_modes import LineWord
from gproof.frontend.mcuwin.raising_state import McuWinState
from gproof.frontend.mcuwin.raising_words import Part
from gproof.ir.finding import Span
from gproof.ir.job import (
    ChangeTool,
    DwellFor,
    EndJob,
    HomeAxes,
    Node,
    PauseJob,
    Quantity,
    Remark,
    SwitchCoolant,
    SwitchOutput,
    TurnSpindle,
)
from gproof.ir.program import PARAMETER, Number
from gproof.ir.rules import CodeRule
from gproof.ir.rules import Function as F

Handler = Callable[[McuWinState, Part, Span], list[Node]]
BY_NAME = {
    F.SPINDLE_CW: "spindle_cw", F.SPINDLE_CCW: "spindle_ccw", F.SPINDLE_OFF: "spindle_off", F.FLOOD_ON: "coolant_on",
    F.COOLANT_OFF: "coolant_off", F.STOP: "stop", F.END: "end", F.END_RESET: "end",
}  # fmt: skip
"""What the manual calls a code (4.1 to 4.9, 4.13), where it can move no axis."""
DIRECTIONS = {"spindle_cw": "cw", "spindle_ccw": "ccw", "spindle_off": "off"}
NO_MOVE = "Task 0 does something that moves no axis; what, is not in the machine file (4)"


def task(state: McuWinState, part: Part, span: Span) -> list[Node]:
    """A code that Task 0 executes."""
    rule = part.rule
    stated = state.din.task(rule.text)
    action = stated.action if stated is not None else BY_NAME.get(rule.function, "unknown")
    if stated is not None and stated.parameters not in (None, len(part.values)):
        raise Unraisable(rule.text, f"the machine file says that it takes {stated.parameters} parameters")
    if action == "home":
        named = tuple(axis for letter, axis in state.names.items() if letter in part.values)
        return [HomeAxes(axes=named or tuple(state.names.values()), span=span)]
    if part.values:
        raise Unraisable(rule.text, "only Task 0 knows its parameters (4)")
    if action in DIRECTIONS:
        return [TurnSpindle(direction=DIRECTIONS[action], span=span)]
    if action == "coolant_on":
        return [SwitchCoolant(flood=True, span=span)]
    if action == "coolant_off":
        return [SwitchCoolant(mist=False, flood=False, span=span)]
    if action == "tool_change":
        return [ChangeTool(span=span)]
    if action == "stop":
        return [PauseJob(optional=rule.function is F.OPTIONAL_STOP, span=span)]
    if action == "end":
        return _end(state, rule, span)
    if action == "unknown":
        raise Unraisable(rule.text, "what Task 0 does for it is not in the machine file (4)")
    raise Unraisable(rule.text, NO_MOVE)


def _end(state: McuWinState, rule: CodeRule, span: Span) -> list[Node]:
    modes = state.now
    state.modes = None
    plane = modes.plane if modes.plane in ("xz", "yz") else ""
    unit = modes.unit if modes.unit == "inch" else ""
    return [EndJob(reset=rule.function is F.END_RESET, plane=plane, unit=unit, span=span)]


def end(state: McuWinState, part: Part, span: Span) -> list[Node]:
    """M02, M30: Task 0 is called after it, in V 2.5.3.32 not for M02 (4.3, 5.3 there)."""
    stated = state.din.task(part.rule.text)
    if stated is not None and stated.action == "unknown" and not (part.rule.function is F.END and state.old):
        raise Unraisable(part.rule.text, "what Task 0 does after it is not in the machine file (4.13)")
    return _end(state, part.rule, span)


def stop(state: McuWinState, part: Part, span: Span) -> list[Node]:
    """M00, M01 (4.1, 4.2)."""
    stated = state.din.task(part.rule.text)
    optional = part.rule.function is F.OPTIONAL_STOP
    if not optional and stated is not None and stated.action == "unknown":
        raise Unraisable(part.rule.text, "what Task 0 does for it is not in the machine file (4.1)")
    return [PauseJob(optional=optional, span=span)]


def dwell(state: McuWinState, part: Part, span: Span) -> list[Node]:
    """G04: seconds (3.5)."""
    return [DwellFor(time=Quantity(state.plain(part.values[PARAMETER].value), "s"), span=span)]


def output(state: McuWinState, part: Part, span: Span) -> list[Node]:
    """M26, M27: axis and output; motion goes on (4.11, 4.12)."""
    word = part.values[PARAMETER]
    number = word.number
    channels = state.din.channels or len(state.columns)
    if number is not None and not (100 <= number <= 999 and number == round(number) and number // 100 <= channels):
        raise Unraisable(f"{part.rule.text} {number:g}", "no channel of this machine (4.11)")
    if number is not None and number % 100 == 0:
        raise Unraisable(f"{part.rule.text} {number:g}", "all outputs of an axis at once (4.11)")
    on = Number(float(part.rule.function is F.OUTPUT_ON), span)
    return [SwitchOutput(channel=state.plain(word.value), value=on, moving=True, span=span)]


def _refused(why: str) -> Handler:
    def handler(state: McuWinState, part: Part, span: Span) -> list[Node]:
        raise Unraisable(part.rule.text, why)

    return handler


_RESIDENT = "variables that the controller keeps from job to job (4.19 to 4.22)"

EVENTS: dict[F, Handler] = {
    F.DWELL: dwell,
    F.HOME: task,
    F.STOP: stop,
    F.OPTIONAL_STOP: stop,
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
    F.OUTPUT_WORD: _refused("all outputs of a group of axes at once (4.14)"),
    F.DEVICE: _refused("a service of this controller (4.18, 4.23, 4.24)"),
    F.APPLICATION: task,
    F.SAVE_VARIABLE: _refused(_RESIDENT),
    F.RESTORE_VARIABLE: _refused(_RESIDENT),
}
"""What a code that acts where it is in its line means."""
ENDS = (F.END, F.END_RESET)


# ---- S, T, D


def speed(state: McuWinState, word: LineWord, span: Span) -> list[Node]:
    """S, by Task 0 (5.4)."""
    stated = state.din.task("S")
    if stated is not None and stated.action == "unknown":
        raise Unraisable("S", "what Task 0 does for it is not in the machine file (5.4)")
    if stated is not None and stated.action == "nothing":
        return [_without_effect(word, span)]
    return [TurnSpindle(direction="speed", speed=Quantity(state.plain(word.value), "rpm"), span=span)]


def tool(state: McuWinState, word: LineWord, span: Span) -> list[Node]:
    """T: by Task 0, and the record of the tool table (5.5)."""
    stated = state.din.task("T")
    if stated is None or stated.action == "unknown":
        raise Unraisable("T", "what Task 0 does for it is not in the machine file (5.5)")
    number = word.number
    lengths = [one.length for one in state.din.tools or () if number is None or one.number == number]
    if any(length != 0.0 for length in lengths):
        raise Unraisable("T", "its record has a length, and when and where that acts is open (2.7)")
    value = state.plain(word.value)
    return [ChangeTool(number=value, select=True, change=stated.action == "tool_change", span=span)]


def table(state: McuWinState, word: LineWord, span: Span) -> list[Node]:
    """D: nothing, unless Task 0 does something (5.6)."""
    stated = state.din.task("D")
    if stated is not None and stated.action != "nothing":
        raise Unraisable("D", "what Task 0 does for it is not in the machine file (5.6)")
    return [_without_effect(word, span)]


def _without_effect(word: LineWord, span: Span) -> Node:
    number = "" if word.number is None else f"{word.number:g}"
    return Remark(text=f"{word.letter}{number} had no effect", span=span)


SETTINGS: dict[str, Callable[[McuWinState, LineWord, Span], list[Node]]] = {"S": speed, "T": tool, "D": table}
