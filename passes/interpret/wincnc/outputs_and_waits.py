"""Outputs, waits, tools, guards, devices of controllers of one command a line, and what their variables hold.

WinCNC Users Guide, Command Reference: G4, G40 to G42, L11 to L13, L20 to L23.1, L30 to L61, L101 to L120, L300, L301,
L500, M11 to M18, M99, and the variables of braces.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from gproof.ir import codes
from gproof.ir.dialects.wincnc_settings import wincnc_settings
from gproof.ir.finding import FollowedRefusal, Refusal, Span
from gproof.ir.machine import AXES, AXIS_NAMES
from gproof.ir.program import Input, Named
from gproof.ir.rules import CodeRule
from gproof.ir.rules import Function as F
from gproof.ir.setup import Interval
from gproof.ir.symbolic import NOWHERE, Position, Unknown, Value, between, bounds
from gproof.ir.trace import KNIFE, Op, ToolDiameter, Wait
from gproof.passes.interpret.core.expressions import Evaluator
from gproof.passes.interpret.core.open_numbers import number_or_open
from gproof.passes.interpret.core.trace_writer import ProgramEnd
from gproof.passes.interpret.wincnc import tangential_knife as single_knife
from gproof.passes.interpret.wincnc.moves import (
    Handler,
    follow,
    lose_places,
    note_assumptions,
    spindle_range,
    switch_output,
)
from gproof.passes.interpret.wincnc.state import (
    COUPLING_OPEN,
    LEANING,
    REGISTERS_OPEN,
    KnifeNow,
    arm_low_boundaries,
    guards_now,
    machine_zero,
    value_of,
    vertical_axes,
    with_pair,
)

if TYPE_CHECKING:
    from gproof.passes.interpret.core.trace_writer import Emitter
    from gproof.passes.interpret.eding.moves import Motion
    from gproof.passes.interpret.wincnc.line import Command


def note(ex: Motion, line: Command, rule: CodeRule) -> None:
    """What moves nothing and changes no place: an event with the command's text."""
    words = " ".join(f"{k}{'?' if isinstance(v, Unknown) else format(v, 'g')}" for k, v in line.values.items())
    texts = " ".join(text.value for text in line.texts.values())
    ex.event(Op.DEVICE, line.span, text=ex._text(" ".join(f"{rule.text} {words} {texts}".split())))


def dwell(ex: Motion, line: Command, rule: CodeRule) -> None:
    """G4 X: seconds; alone: until the operator goes on."""
    letter = "D" if rule.letter == "L" else "X"
    seconds = number_or_open(ex, line, letter, rule.text)
    if seconds is None:
        if line.comment:
            ex.event(Op.MESSAGE, line.span, text=ex._text(line.comment))
        ex.event(Op.STOP, line.span)
        ex.findings.add(codes.OPERATOR_STOP.at(line.span, code=rule.text))
        ex._end_section(Wait.OPERATOR, "cycle start", None, line.span)
        return
    if seconds < 0:
        raise Refusal(codes.DWELL_NEGATIVE.at(line.where(letter), seconds=seconds))
    ex.event(Op.DWELL, line.span, arg=(seconds, 0.0))


# ---- outputs and inputs


def channel(ex: Motion, line: Command, rule: CodeRule, known: tuple[int, ...] | None, kind: str) -> int:
    """The channel in C; Refusal GP128 for one that is not there."""
    number = line.whole("C", ex.program.rules.integer_tolerance)
    assert number is not None
    stated = wincnc_settings(ex.machine).highest_channel
    highest = math.inf if stated is None else stated
    if number < 0 or number > highest or (known is not None and number not in known):
        allowed = (
            f"{highest} is the highest channel" if number > highest else f"the machine's file has no {kind} {number}"
        )
        raise Refusal(codes.PARAMETER_RANGE.at(line.where("C"), code=rule.text, word="C", allowed=allowed))
    return number


def output(ex: Motion, line: Command, rule: CodeRule) -> None:
    """M11 to M14: an output on or off; M13 and M14 without a stop."""
    s = ex.modal
    controls = wincnc_settings(ex.machine)
    on = rule.function in (F.OUTPUT_ON, F.OUTPUT_ON_MOVING)
    if "C" not in line.values:
        if "D" not in line.values:
            raise Refusal(codes.WORD_MISSING.at(line.where_code(rule), code=rule.text, needed="C"))
        _bank(ex, line, rule, on)
        return
    number = channel(ex, line, rule, controls.outputs, "output")
    s.single = s.single.but(outputs=with_pair(s.single.outputs, number, float(on)))
    passing = rule.function in (F.OUTPUT_ON_MOVING, F.OUTPUT_OFF_MOVING)
    ex.event(Op.OUTPUT, line.span, arg=(float(number), float(on)), text=int(passing))
    if controls.torch is not None and number == controls.torch.output:
        ex.settings.meet("torch", line.span)
        _burning(ex, line, rule, on=on)


def _bank(ex: Motion, line: Command, rule: CodeRule, on: bool) -> None:
    """M11 D: drills of a bank by the bits of a number."""
    banks = wincnc_settings(ex.machine).drill_banks
    ex.settings.meet("drills", line.span)
    if len(banks) != 1:
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.span, code=f"{rule.text} with D, and not one drillbank="))
    bits = line.whole("D", ex.program.rules.integer_tolerance) or 0
    first, count = banks[0]
    if not 0 <= bits < 1 << count:
        allowed = f"the bank has {count} drills"
        raise Refusal(codes.PARAMETER_RANGE.at(line.where("D"), code=rule.text, word="D", allowed=allowed))
    s = ex.modal
    for n in range(count):
        if bits >> n & 1:
            s.single = s.single.but(outputs=with_pair(s.single.outputs, first + n, float(on)))
            ex.event(Op.OUTPUT, line.span, arg=(float(first + n), float(on)))


def analog(ex: Motion, line: Command, rule: CodeRule) -> None:
    """L51: the D/A output by volts, percent or spindle speed, one of them."""
    if len(line.values) > 1:
        second = list(line.values)[1]
        raise Refusal(codes.OUTPUT_VALUE.at(line.where(second), code=rule.text, what="only one of V, P and S"))
    if "S" in line.values:
        spindle_range(ex, line)
    note(ex, line, rule)


def wait(ex: Motion, line: Command, rule: CodeRule) -> None:
    """M17 and M18: until an input is on or off."""
    number = channel(ex, line, rule, wincnc_settings(ex.machine).inputs, "input")
    ex.event(Op.INPUT_WAIT, line.span, arg=(float(number), float(rule.function is F.WAIT_ON)))
    ex._end_section(Wait.INPUT, "come", None, line.span)


def virtual(ex: Motion, line: Command, rule: CodeRule) -> None:
    """L60, L61: a virtual input."""
    number = line.whole("C", ex.program.rules.integer_tolerance)
    if number is None or not 1 <= number <= 64:
        raise Refusal(codes.PARAMETER_RANGE.at(line.where("C"), code=rule.text, word="C", allowed="1 to 64"))
    s = ex.modal
    swapped = wincnc_settings(ex.machine).virtual_on == 60
    on = float((rule.function is F.VIRTUAL_ON) != swapped)
    s.single = s.single.but(virtual=with_pair(s.single.virtual, number, on))


# ---- what braces and conditions read


def read_named(ex: Emitter, node: Named) -> Value:
    """The value of a name in braces, in the program's unit; Refusal GP107 for one that is none."""
    s = ex.modal
    name = node.name
    if len(name) == 1:
        found = next((value for letter, value in s.single.arguments if letter == name), None)
        if found is None:
            raise Refusal(codes.BAD_EXPRESSION.at(node.span, what=f"{{{name}}}: the call gave no {name}"))
        return found
    if name not in ex.program.rules.variables:
        raise Refusal(codes.BAD_EXPRESSION.at(node.span, what=f"{name} is no variable of WinCNC"))
    value = _internal(ex, name)
    if name[:2] in ("TH", "TM", "LZ") and s.unit != ex.machine.unit and not _turns(ex, name):
        # In the unit of the program or in that of the file: of which, the manual says nothing.
        low, high = bounds(value)
        factor = s.unit / ex.machine.unit
        ends = low, high, low * factor, high * factor
        cause = f"{name}, in the unit of the job or of the machine's file,"
        return between(
            value.cause if isinstance(value, Unknown) and not value.bounded else cause, (min(ends), max(ends))
        )
    return value


def _turns(ex: Emitter, name: str) -> bool:
    """Whether a local zero is that of an axis that turns."""
    number = int(name[2]) if name[:2] == "LZ" else 0
    axes = ex.machine.axes
    return name[:2] == "LZ" and number < len(axes) and not ex.modal.linear[axes[number].index]


def _internal(ex: Emitter, name: str) -> Value:
    """The value of a variable of the controller, lengths in the program's unit."""
    s = ex.modal
    controls = wincnc_settings(ex.machine)
    if name in ("TP1", "TP2"):
        return s.single.tools[int(name[2]) - 1]
    if name in ("TN1", "TN2"):
        tool, add = s.single.tools[int(name[2]) - 1], 10.0 * int(name[2])
        return tool if isinstance(tool, Unknown) else tool + add
    if name in ("TM1", "TM2"):
        return s.single.switch_heights[int(name[2]) - 1]
    if name[:2] == "LZ":
        axis = int(name[2])
        there = ex.machine.axes[axis].index if axis < len(ex.machine.axes) else axis
        return s.plain(s.g92[there], s.scale(there), 0)
    if name in ("TH1", "TH2"):
        return _tool_height(ex, int(name[2]))
    switch = controls.measure
    if switch is not None and name[:2] == "TM":
        value = {"X": switch.x, "Y": switch.y, "I": switch.i, "J": switch.j, "D": switch.descent,
                 "F": None if switch.feed is None else switch.feed * 60.0}.get(name[2])  # fmt: skip
        if value is not None:
            return value / s.unit
    return Unknown(name)


def _tool_height(ex: Emitter, number: int) -> Value:
    """TH1, TH2: the height of atc1= or that of the tool in the library; a number where the two agree."""
    s = ex.modal
    changer = next((c for c in wincnc_settings(ex.machine).changers if c.number == number), None)
    tool = s.single.tools[number - 1]
    name = f"TH{number}"
    if changer is None or changer.height is None or isinstance(tool, Unknown):
        return Unknown(name)
    measured = dict(s.single.heights).get(round(tool))
    if measured is None:
        known = ex.setup.interval(f"tool.{round(tool)}.z")
        measured = Position(known.low) if known is not None and known.exact else NOWHERE
    if measured.form or abs(measured.value - changer.height) > 1e-9:
        return Unknown(f"{name}, the changer's height or the tool's")
    return changer.height / s.unit


def read_input(ex: Emitter, node: Input, evaluator: Evaluator) -> Value:
    """The state of a channel: by the program, else by the setup, else unknown; Refusal GP128 for one not there."""
    value = evaluator.value(node.number)
    if isinstance(value, Unknown):
        return Unknown(value.cause, 0.0, 1.0)
    if node.kind == "given":
        if value not in (0.0, 1.0):
            raise Refusal(codes.PARAMETER_RANGE.at(node.span, code="a condition", word="C", allowed="0 or 1"))
        return value
    number = round(value)
    controls = wincnc_settings(ex.machine)
    there = {"input": controls.inputs, "output": controls.outputs, "virtual": range(1, 65)}.get(node.kind)
    highest = math.inf if controls.highest_channel is None else controls.highest_channel
    beyond = node.kind in ("input", "output") and number > highest
    missing = there is not None and (number not in there or abs(number - value) > ex.program.rules.integer_tolerance)
    if missing or beyond:
        allowed = f"there is no {node.kind} channel {value:g}"
        raise Refusal(codes.PARAMETER_RANGE.at(node.span, code="a condition", word="C", allowed=allowed))
    s, setup = ex.modal, ex.setup
    known: Value | None = None
    if node.kind == "output" and number in controls.unsteady_outputs:
        known = None
    elif node.kind == "output":
        known = value_of(s.single.outputs, number)
        known = setup.outputs.get(number) if known is None else known
    elif node.kind == "virtual":
        known = value_of(s.single.virtual, number)
        known = setup.virtual.get(number) if known is None else known
    elif node.kind == "input":
        known = setup.inputs.get(number)
    else:
        known = setup.answers.get(number)
    if known is not None:
        return known
    names = {"output": "output", "virtual": "virtual input", "input": "input", "answer": "the operator's answer"}
    axes = ex.machine.axes
    if ex.program.rules.source_order and 0 < number // 100 <= len(axes):
        return Unknown(f"input {axes[number // 100 - 1].word}.digib.{number % 100}", 0.0, 1.0)
    return Unknown(f"{names[node.kind]} {number}", 0.0, 1.0)


# ---- tools


def tool_number(ex: Motion, line: Command, rule: CodeRule) -> None:
    """L101, L102, L110, L120: which tool is in a changer's spindle, and its measure."""
    s = ex.modal
    number = line.whole("T", ex.program.rules.integer_tolerance)
    assert number is not None
    if not 0 <= number <= ex.program.rules.highest_tool:
        raise Refusal(codes.PARAMETER_RANGE.at(line.where("T"), code=rule.text, word="T", allowed="0 to 999"))
    tools = list(s.single.tools)
    tools[rule.value - 1] = float(number)
    s.single = s.single.but(tools=(tools[0], tools[1]))
    if rule.value == 1 and s.tool != number and s.single.reference is None:
        s.lengths_used = True
        s.single = s.single.but(reference=tuple(s.beside_tip(axis) for axis in range(AXES)))
    changers = {changer.number: changer for changer in wincnc_settings(ex.machine).changers}
    changer = changers.get(rule.value)
    axis = AXIS_NAMES.index(changer.axis) if changer is not None else 2
    register = line.whole("R", ex.program.rules.integer_tolerance) if "R" in line.values else number
    offset = dict(s.single.heights).get(register if register is not None else number)
    if offset is None and REGISTERS_OPEN in s.single.flags:
        offset = NOWHERE
    if offset is None:
        offset = s._symbol(f"tool.{register}.{AXIS_NAMES[axis]}") if number else s._symbol(
            f"tool.{number}.{AXIS_NAMES[axis]}")  # fmt: skip
    if axis in s.single.unmeasured:
        # G49 is in force: whether the new tool's measure is, the manual does not say; G43 and G49 settle it.
        stored = list(s.single.before or s.tool_offset)
        stored[axis] = offset
        s.single = s.single.but(before=tuple(stored))
        if offset != s.tool_offset[axis]:
            s.tool_offset[axis] = NOWHERE
    else:
        s.tool_offset[axis] = offset
    s.lengths_used = True
    if rule.value == 1:
        s.tool = number
    arm_low_boundaries(s)
    ex._state_changed()
    ex.event(Op.TOOL_CHANGE, line.span, arg=(float(number), 0.0))


def store_tool(ex: Motion, line: Command, rule: CodeRule) -> None:
    """L500.2: an entry of the tool library."""
    number = line.whole("T", ex.program.rules.integer_tolerance) or 0
    s = ex.modal
    nominal, actual, added = (line.values.get(letter) for letter in "NAC")
    same = nominal is not None and nominal == actual and not isinstance(nominal, Unknown) and added == 0.0
    s.single = s.single.but(unworn=s.single.unworn | {number} if same else s.single.unworn - {number})
    if {"H", "O", "C"} & line.values.keys():
        heights = {**dict(s.single.heights), number: NOWHERE}
        s.single = s.single.but(heights=tuple(sorted(heights.items(), key=lambda pair: pair[0])))
    given = nominal if actual is None else actual
    if given is not None:
        # In which unit the library has them is not said: in the job's, or the machine's.
        scales = (s.unit, ex.machine.unit)
        ends = [abs(end * scale) for end in bounds(given) for scale in scales]
        others = tuple(each for each in s.single.diameters if each.tool != number)
        s.single = s.single.but(diameters=(*others, ToolDiameter(number, min(ends), max(ends))))
        ex._state_changed()
    note(ex, line, rule)


def load_registers(ex: Motion, line: Command, rule: CodeRule) -> None:
    """L1.2: what registers hold then, a file says that nobody knows."""
    s = ex.modal
    s.single = s.single.but(heights=(), flags=s.single.flags | {REGISTERS_OPEN})
    what = f"{rule.text} (which file the registers are loaded from is not said)"
    raise Refusal(codes.UNSUPPORTED_CODE.at(line.span, code=what))


# ---- compensation


def compensation(ex: Motion, line: Command, rule: CodeRule) -> None:
    """G40 to G42: for differences of tool diameters; how the path lies beside the programmed one is not described.

    Nothing moves aside for O0 on a machine without a tool changer, and on one with a changer for a tool to which the
    job's own L500.2 gave one diameter, nominal and actual. Else X and Y are not known until G40 and their next words:
    an amount bounds no corner, which may be mitred.
    """
    s = ex.modal
    if rule.function is F.COMPENSATION_OFF:
        s.single = s.single.but(flags=s.single.flags - {"compensation"})
        return
    controls = wincnc_settings(ex.machine)
    amount = line.number("O")
    if not controls.changers and amount == 0.0:
        if controls.devices is None:
            ex.assumed["the machine has no tool changer: O of G41 and G42 counts"] = None
        return
    tool = s.single.tools[0]
    known = len(controls.changers) == 1 and controls.changers[0].number == 1 and not isinstance(tool, Unknown)
    if not amount and known and tool in s.single.unworn:
        return
    s.single = s.single.but(flags=s.single.flags | {"compensation"})
    for axis in (0, 1):
        s.position[axis] = NOWHERE
    s.jumped = True
    what = f"{rule.text} with an amount other than 0 (half of it or all, entry and corners are not described)"
    if controls.changers:
        what = f"{rule.text} on a machine with a tool changer, by what the library says of the tool"
    elif amount is None:
        what = f"{rule.text} without O"
    raise Refusal(codes.UNSUPPORTED_CODE.at(line.span, code=what))


# ---- mapping, locking


def map_words(ex: Motion, line: Command, rule: CodeRule) -> None:
    """L11 and L12: which word moves an axis: the letters stand for X Y Z W, or Z W, in that order."""
    s = ex.modal
    columns = line.columns
    letters = line.letters
    if rule.function is F.MAP_HEADS and "mapped" in s.single.flags and s.single.sources[:2] != (0, 1):
        lose_places(ex)
        what = f"{rule.text} while L11 maps X or Y (whether it ends that)"
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.span, code=what))
    if not letters:
        s.single = s.single.but(sources=tuple(range(AXES)), flags=s.single.flags - {"mapped"})
        return
    order = "XYZW" if rule.function is F.MAP_WORDS else "ZW"
    if len(letters) > len(order) or any(letter not in columns for letter in order[: len(letters)]):
        raise Refusal(codes.ILLEGAL_VALUE.at(line.span, word=rule.text, what=f"axes for {order} in that order"))
    _doubt_mapping(line, rule, order[: len(letters)])
    sources = list(range(AXES))
    for target, source in zip(order, letters, strict=False):
        sources[columns[target]] = columns[source]
    flags = s.single.flags | {"mapped"} if rule.function is F.MAP_WORDS else s.single.flags - {"mapped"}
    s.single = s.single.but(sources=tuple(sources), flags=flags)


def _doubt_mapping(line: Command, rule: CodeRule, order: str) -> None:
    """Refusal for mappings of a kind of which the manual has no example: axes in a ring, letters that are not in order.

    There the rule (these axes receive the words of ``order``) and what examples do (an axis of ``order`` moves by these
    words) are two things.
    """
    letters = line.letters
    is_shared = len(set(letters)) < len(letters)
    sources = dict(zip(order, letters, strict=True))
    is_swap = all(sources.get(source) == target for target, source in sources.items())
    if not is_swap and not (is_shared and set(letters) <= set(order)):
        what = f"{rule.text} {' '.join(letters)} (which axis takes which words is not said)"
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.span, code=what))


def map_pulses(ex: Motion, line: Command, rule: CodeRule) -> None:
    """L13: the second axis follows the first step by step."""
    s = ex.modal
    letters = line.letters
    if not letters:
        s.single = s.single.but(slaves=(), flags=s.single.flags - {COUPLING_OPEN})
        return
    if len(letters) == 1 or len(set(letters)) != len(letters):
        raise Refusal(codes.ILLEGAL_VALUE.at(line.span, word=rule.text, what="two axes"))
    columns = [line.columns[letter] for letter in letters]
    pairs = {(columns[1], columns[0])}
    what = ""
    if len(columns) > 2:
        # Any of them may follow any other.
        pairs, what = (
            {(a, b) for a in columns for b in columns if a != b},
            "of more than two axes (which follows which)",
        )
    elif set(s.single.slaves) - pairs:
        pairs, what = pairs | set(s.single.slaves), "while another one is in force (whether that one ends)"
    elif not _same_steps(ex, *columns):
        what = "of axes that differ in their steps (whether the follower goes as many steps or as far)"
    flags = s.single.flags | {COUPLING_OPEN} if what else s.single.flags
    s.single = s.single.but(slaves=tuple(sorted(pairs)), flags=flags)
    if what:
        raise FollowedRefusal(codes.UNSUPPORTED_CODE.at(line.span, code=f"{rule.text} {' '.join(letters)} {what}"))


def _same_steps(ex: Motion, leader: int, follower: int) -> bool:
    """Whether a step of two axes is equally long; what no file says of it is assumed."""
    drives = [axis for axis in ex.machine.axes if axis.index in (leader, follower)]
    if len({axis.kind for axis in drives}) > 1:
        return False
    steps = {None if axis.steps_per_unit is None else abs(axis.steps_per_unit) for axis in drives}
    if None in steps:
        ex.assumed["axes that L13 couples have equally long steps"] = None
    return len(steps - {None}) < 2


def lock(ex: Motion, line: Command, rule: CodeRule) -> None:
    """L300, L301: axes that do not move, whatever the program says."""
    s = ex.modal
    axes = frozenset(line.axes())
    if not axes and (rule.function is F.LOCK_AXIS or s.single.locked):
        s.position = [NOWHERE if s.has_axis(axis) else place for axis, place in enumerate(s.position)]
        s.jumped = True
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.span, code=f"{rule.text} without axes (all of them, or none)"))
    locked = s.single.locked | axes if rule.function is F.LOCK_AXIS else s.single.locked - axes
    s.single = s.single.but(locked=locked, held_back=s.single.held_back - axes)


# ---- guards


def guards(ex: Motion, line: Command, rule: CodeRule) -> None:
    """L20 and L21: soft limits and boundaries."""
    s = ex.modal
    controls = wincnc_settings(ex.machine)
    which = line.number("X") if rule.function is F.LIMITS_ON else None
    if which not in (None, 1.0, 2.0):
        raise Refusal(codes.PARAMETER_RANGE.at(line.where("X"), code=rule.text, word="X", allowed="1 or 2"))
    if rule.function is F.LIMITS_ON and not controls.limits_available:
        raise Refusal(codes.NOT_ENABLED.at(line.where_code(rule), code=rule.text, device="soft limits", key="softlim="))
    on = rule.function is F.LIMITS_ON
    s.single = s.single.but(soft=on and which != 1.0, bound=on and which != 2.0)
    set_guards(ex)
    for name, state in (("machine_area", s.single.soft), ("boundaries", s.single.bound)):
        ex.event(Op.GUARD, line.span, arg=(float(state), 0.0), text=ex._text(name))


def set_guards(ex: Motion) -> None:
    """The guards that rows carry."""
    ex.modal.guards_off = guards_now(ex.modal)
    ex._state_changed()


def boundary(ex: Motion, line: Command, rule: CodeRule) -> None:
    """L22, L23: boundaries in workspace numbers; without words, and with .1, those of the machine's file."""
    s = ex.modal
    low = rule.function in (F.LOW_BOUNDARY, F.LOW_BOUNDARY_RESTORE)
    restore = rule.function in (F.LOW_BOUNDARY_RESTORE, F.HIGH_BOUNDARY_RESTORE)
    values = list(s.single.lower if low else s.single.upper)
    words = line.axes()
    if restore or not words:
        for axis in words or range(AXES):
            there = ex.machine.axis(AXIS_NAMES[axis])
            values[axis] = None if there is None else there.boundary_lower if low else there.boundary_upper
    else:
        for axis, value in words.items():
            if isinstance(value, Unknown):
                raise Refusal(codes.UNKNOWN_CONDITION.at(line.span, cause=value.cause))
            values[axis] = value * s.scale(axis)
    s.single = s.single.but(lower=tuple(values)) if low else s.single.but(upper=tuple(values))
    set_guards(ex)


# ---- devices that move axes in ways that nobody can follow


def _device(name: str, on: bool, *, moves: bool = False) -> Handler:
    def handler(ex: Motion, line: Command, rule: CodeRule) -> None:
        s = ex.modal
        flags = s.single.flags | {name} if on else s.single.flags - {name}
        s.single = s.single.but(flags=flags)
        note(ex, line, rule)
        if on and moves:
            lose_places(ex)
            raise Refusal(codes.UNSUPPORTED_CODE.at(line.span, code=f"{rule.text}, which moves axes on its own,"))

    return handler


def knife(ex: Motion, line: Command, rule: CodeRule) -> None:
    """L30 and L31: the knife's axis follows the path (``passes/interpret/wincnc/tangential_knife.py``)."""
    s = ex.modal
    note(ex, line, rule)
    if rule.function is F.KNIFE_OFF:
        if KNIFE in s.following:
            single_knife.switched(ex, line.span)
        s.following = tuple(name for name in s.following if name != KNIFE)
        s.single = s.single.but(flags=s.single.flags - {LEANING})
        ex._state_changed()
        return
    mode = wincnc_settings(ex.machine).knife
    if ex.machine.knife is None:
        problem = "without knifemode=" if mode is None else single_knife.problem_of(ex, mode)
        if problem:
            lose_places(ex)
            if mode is not None and (mode.blade or mode.both_ways):
                s.single = s.single.but(flags=s.single.flags | {LEANING})
            raise FollowedRefusal(codes.UNSUPPORTED_CODE.at(line.span, code=f"{rule.text} {problem}"))
    s.following = tuple(sorted({*s.following, KNIFE}))
    ex._state_changed()
    single_knife.switched(ex, line.span)


def knife_settings(ex: Motion, line: Command, rule: CodeRule) -> None:
    """L30.1: lift angle, lift position and plunge depth, in the unit in force."""
    s = ex.modal
    mode = wincnc_settings(ex.machine).knife
    angle, up, down = (line.number(letter) for letter in "AZP")
    if angle is not None and angle < 0:
        raise Refusal(codes.ILLEGAL_VALUE.at(line.where("A"), word="A", what=f"a lift angle of {angle:g}"))
    note(ex, line, rule)
    if mode is None:
        return
    scale = s.scale(AXIS_NAMES.index(mode.vertical)) if mode.vertical else s.unit
    now = s.single.knife or single_knife.settings(mode)
    s.single = s.single.but(
        knife=KnifeNow(
            now.angle if angle is None else angle,
            now.lifted if up is None else up * scale,
            now.lowered if down is None else down * scale,
        )
    )


def saw(ex: Motion, line: Command, rule: CodeRule) -> None:
    """L32: the blade turns with the path; what it does to lifts and to the ends of cuts the manual does not say."""
    s = ex.modal
    s.single = s.single.but(flags=s.single.flags | {"saw"})
    note(ex, line, rule)
    lose_places(ex)
    what = (
        f"{rule.text} (which way O of sawmode= counts, before which turns it lifts by Z, and what its radius R does to "
        "the ends of cuts is not said)"
    )
    raise Refusal(codes.UNSUPPORTED_CODE.at(line.span, code=what))


def torch(ex: Motion, line: Command, rule: CodeRule) -> None:
    """L38 and L39: the torch's output; with height control on, Z goes where the arc's voltage sends it."""
    s = ex.modal
    controls = wincnc_settings(ex.machine)
    on = rule.function is F.TORCH_ON
    if "A" in line.values:
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.span, code=f"{rule.text} with a bevel angle"))
    control = controls.torch
    number = None if control is None else control.output
    if number is not None:
        s.single = s.single.but(outputs=with_pair(s.single.outputs, number, float(on)))
        ex.event(Op.OUTPUT, line.span, arg=(float(number), float(on)))
    delay = None if control is None else control.start_delay if on else control.end_delay
    if delay:
        ex.event(Op.DWELL, line.span, arg=(delay, 0.0))
    axis = AXIS_NAMES.index(control.axis) if control is not None and control.axis else 2
    lift = 0.0 if control is None or control.lift is None else control.lift
    _burning(ex, line, rule, on=on)
    if not on and lift:
        known = not _height_acts(ex)
        s.position[axis] = ex.unknown_place("value", axis, (0.0, lift), s.position[axis]) if known else NOWHERE
        s.jumped = True


def _height_acts(ex: Motion) -> bool:
    """Whether height control may move Z: after L36, and before the job's first L37, as nobody says how it begins."""
    flags = ex.modal.single.flags
    return "height" in flags or ("height off" not in flags and ex.setup.default_offset is None)


def _burning(ex: Motion, line: Command, rule: CodeRule, *, on: bool) -> None:
    """The torch burns, by L38 or by its output, or goes out: Z goes where the arc's voltage sends it."""
    s = ex.modal
    s.single = s.single.but(flags=s.single.flags | {"torch"} if on else s.single.flags - {"torch"})
    if on and _height_acts(ex):
        control = wincnc_settings(ex.machine).torch
        s.position[AXIS_NAMES.index(control.axis) if control is not None and control.axis else 2] = NOWHERE
        ex._fail(codes.HEIGHT_CONTROL.at(line.span, code=rule.text))
        s.jumped = True


def height(ex: Motion, line: Command, rule: CodeRule) -> None:
    """L36 and L37: torch height control."""
    s = ex.modal
    on = rule.function is F.HEIGHT_ON
    flags = s.single.flags - {"height", "height off"} | {"height" if on else "height off"}
    s.single = s.single.but(flags=flags)
    ex.event(Op.SETPOINT, line.span, arg=(0.0, float(on)), text=ex._text("height_control"))
    if on and "torch" in flags:
        _burning(ex, line, rule, on=True)


def auto_output(ex: Motion, line: Command, rule: CodeRule) -> None:
    """L34 and L35: the output that is on while the job cuts; with D only its dwell is set."""
    s = ex.modal
    on = rule.function is F.AUTO_OUTPUT_ON
    if "D" in line.values:
        seconds = number_or_open(ex, line, "D", rule.text) or 0.0
        first, second = s.single.auto_dwell
        s.single = s.single.but(auto_dwell=(seconds, second) if on else (first, seconds))
    else:
        if not on:
            switch_output(ex, line, cutting=False)
        s.single = s.single.but(flags=s.single.flags | {"autoaux"} if on else s.single.flags - {"autoaux"})
    note(ex, line, rule)


def store_position(ex: Motion, line: Command, rule: CodeRule) -> None:
    """L500 stores machine places under a number; L501 local ones, whose recall is not described."""
    s = ex.modal
    letter = next((letter for letter in "PHT" if letter in line.values), None)
    if letter is None:
        raise Refusal(codes.WORD_MISSING.at(line.where_code(rule), code=rule.text, needed="P, H or T"))
    number = line.whole(letter, ex.program.rules.integer_tolerance)
    lift = line.number("L")
    axes = sorted(line.axes()) or sorted(axis.index for axis in ex.machine.axes)
    local = rule.function is F.STORE_LOCAL_POSITION
    places = tuple((axis, NOWHERE if local else s.position[axis].minus(machine_zero(s.single, axis))) for axis in axes)
    lifted = lift is None or lift != 0.0
    others = tuple(known for known in s.single.places if known[0] != f"{letter}{number}")
    s.single = s.single.but(places=(*others, (f"{letter}{number}", places, lifted)))
    note(ex, line, rule)


def level_heads(ex: Motion, line: Command, rule: CodeRule) -> None:
    """L53: vertical heads as high as possible with their tools at one height."""
    s = ex.modal
    heads = vertical_axes(ex.machine)
    stored = s.single.before or s.tool_offset
    aside = {axis for axis in set(heads) & s.single.unmeasured if stored[axis] != s.tool_offset[axis]}
    moved = [axis for axis in heads if axis in dict(s.single.zeros)]
    if moved or aside or any(s.tool_offset[axis].form for axis in heads):
        for axis in heads:
            s.position[axis] = NOWHERE
        s.jumped = True
        why = "while G49 puts measures aside (whether they count)" if aside else "with tools that are not measured"
        why = "behind an L28 of a head (how high it can go)" if moved else why
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.span, code=f"{rule.text} {why}"))
    note_assumptions(ex, line.span)
    target = list(s.position)
    if heads:
        # At machine zero the tip of an axis stands at minus its measure: the lowest of them all can reach.
        height = min(-s.tool_offset[axis].value for axis in heads)
        for axis in heads:
            target[axis] = Position(height + s.tool_offset[axis].value)
    ex.move(Op.TRAVERSE, follow(ex, target, line.span), line.span)
    ex._moved = True


def measured(ex: Motion, line: Command, rule: CodeRule) -> None:
    """L82, L83: the probe goes down until it touches: the height, and what counts from it, is not known before.

    L82 where the setup states the contact of the probe's axis: the surface is there, and gets the number of Z. How far
    the probe rises again is not said: between the surface and where it came from.
    """
    s = ex.modal
    controls = wincnc_settings(ex.machine)
    axis = AXIS_NAMES.index(controls.probe_axis)
    contact = ex.setup.contacts.get(controls.probe_axis)
    if axis in s.single.locked or any(axis in pair for pair in s.single.slaves):
        # Whether a probe that L300 locks goes down, and how far what follows it comes back, is not said.
        contact = None
        for follower, leader in s.single.slaves:
            if leader == axis:
                s.position[follower] = NOWHERE
    if rule.function is F.MEASURE_SURFACE and contact is not None and not s.position[axis].form:
        _surface(ex, line, axis, contact)
        return
    for axis in vertical_axes(ex.machine):
        s.position[axis] = NOWHERE
        if rule.function is F.MEASURE_SURFACE:
            s.g92[axis] = NOWHERE
    for axis in line.axes():
        s.position[axis] = NOWHERE
    s.jumped = True
    raise Refusal(codes.UNSUPPORTED_CODE.at(line.span, code=f"{rule.text}, which measures with the probe,"))


def _surface(ex: Motion, line: Command, axis: int, contact: Interval) -> None:
    """L82 down to a contact that the setup states, in machine coordinates."""
    s = ex.modal
    start = s.position[axis]
    if contact.low > start.value:
        what = f"L82 from below the contact that the setup states of {ex.machine.word(axis)}"
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.span, code=what))
    note_assumptions(ex, line.span)
    word = ex.machine.word(axis)
    ex.assumed[f"the setup says where the probe of {word} touches, and it rises no higher than it came from"] = None
    down = list(s.position)
    down[axis] = Position(contact.low)
    s.feed = math.nan
    ex.move(Op.FEED, down, line.span)
    ex._moved = True
    high = min(contact.high, start.value)
    known = contact.low == high
    place = Position(high) if known else ex.unknown_place("home", axis, (contact.low, high), Position(0.0))
    value = line.values.get("Z", 0.0)
    base = s.work_offsets[s.work, axis].plus(s.beside_work(axis))
    s.g92[axis] = NOWHERE if isinstance(value, Unknown) else place.minus(base).moved(-value * s.scale(axis))
    ex._state_changed()
    ex.event(Op.OFFSET, line.span, arg=(0.0, 0.0))
    ends = contact.low, start.value
    s.position[axis] = ex.unknown_place("home", axis, ends, Position(0.0)) if ends[0] < ends[1] else place
    ex._end_section(Wait.PROBE, "touched", None, line.span)


def map_adjustment(ex: Motion, line: Command, rule: CodeRule) -> None:
    """L600, L601: adjustments of axismap= off and on: nothing on a machine that has no map."""
    devices = wincnc_settings(ex.machine).devices
    if devices is not None and "axismap" not in devices:
        note(ex, line, rule)
        return
    if not line.axes():
        lose_places(ex)
    for axis in line.axes():
        ex.modal.position[axis] = NOWHERE
    ex.modal.jumped = True
    raise Refusal(codes.UNSUPPORTED_CODE.at(line.where_code(rule), code=f"{rule.text} ({rule.open})"))


def recall(ex: Motion, line: Command, rule: CodeRule) -> None:
    """L401: to where all axes were before the last file ran, which this job does not say."""
    lose_places(ex)
    raise Refusal(codes.UNSUPPORTED_CODE.at(line.span, code=f"{rule.text}, to a place that an earlier file left,"))


def feed_override(ex: Motion, line: Command, rule: CodeRule) -> None:
    """L40 P: percent of the programmed feed; GP200 outside of what override= allows (1 to 200: Feed Rate Override).

    Where override= E0 switches overrides off, or nobody knows P, feeds are not known any more (GP270).
    """
    s = ex.modal
    controls = wincnc_settings(ex.machine)
    percent = line.values.get("P", 0.0)
    low, high = controls.override or (None, None)
    low, high = 1.0 if low is None else low, 200.0 if high is None else high
    least, most = bounds(percent)
    if most < low or least > high:
        what = f"{rule.text} P{least:g} is not within {low:g} to {high:g} percent"
        ex.findings.add(codes.COMMAND_IGNORED.at(line.where("P"), what=what, hint="L and H of override= set the range"))
        ex.event(Op.MESSAGE, line.span, text=ex._text(f"L40 P{least:g} is ignored"))
        return
    cause = (
        "override= E0 switches overrides off (whether L40 acts is not said)" if not controls.override_enabled else ""
    )
    if isinstance(percent, Unknown):
        cause = f"P depends on {percent.cause}, which is not known"
    factor = math.nan if isinstance(percent, Unknown) else percent / 100.0
    if cause and factor != s.feed_override:
        ex.findings.add(codes.OVERRIDE_FACTOR.at(line.where("P"), code=rule.text, what=cause))
        factor = math.nan
    s.feed_override = factor
    # With rapid_lock=0 rapids can be changed too: how much L40 does is not said, but where it leaves them alone.
    held = not controls.rapids_unlocked or factor == 1.0
    s.single = s.single.but(retimed=s.single.retimed - {rule.text} if held else s.single.retimed | {rule.text})
    ex._state_changed()


def smoothing(ex: Motion, line: Command, rule: CodeRule) -> None:
    """G9: how much the controller rounds corners from here on; how far that is beside the path, no manual says."""
    factor = line.values.get("S", 0.0)
    if isinstance(factor, Unknown) or factor:
        ex.assumed["the controller rounds corners (G9) nowhere as far as a zone or a body"] = None
    note(ex, line, rule)


def dynamics(ex: Motion, line: Command, rule: CodeRule) -> None:
    """L5, L6, L7: velocities and accelerations that the machine's file does not have; L6 and L7 alone: as before.

    Times, plans and streams by the file's do not hold while one is in force. What L5 sets may be the feed itself.
    """
    s = ex.modal
    restores = rule.text != "L5" and not line.values
    if rule.text == "L7" and line.values.get("P") == 100.0 and rule.text not in s.single.retimed:
        restores = True  # all of what is in force
    names = s.single.retimed - {rule.text} if restores else s.single.retimed | {rule.text}
    s.single = s.single.but(retimed=names)
    ex._state_changed()
    note(ex, line, rule)


def backlash(ex: Motion, line: Command, rule: CodeRule) -> None:
    """L8, L9: compensation of backlash on, with the file's amounts or new ones, or off.

    What is in force is kept as the most that it may be: whether L8 of some axes switches it on for others, and whether
    a motor goes back when it is switched off, is not said.
    """
    s = ex.modal
    controls = wincnc_settings(ex.machine)
    stated = {AXIS_NAMES.index(name): amount for name, amount in controls.backlash}
    most = dict(s.single.backlash)
    if rule.text == "L9":
        changed = {axis.index for axis in ex.machine.axes if axis.backlash or axis.index in most}
        most |= {axis: most.get(axis, 0.0) for axis in changed}
    else:
        for axis in ex.machine.axes:
            amount = stated.get(axis.index, axis.backlash)
            if amount != axis.backlash or axis.index in most:
                most[axis.index] = max(most.get(axis.index, 0.0), amount)
        for column, value in line.axes().items():
            if ex.machine.word(column) in line.bare:
                continue
            if not isinstance(value, Unknown) and value < 0.0:
                raise Refusal(codes.ILLEGAL_VALUE.at(line.span, word=rule.text, what=f"a backlash of {value:g}"))
            amount = math.inf if isinstance(value, Unknown) else value * s.scale(column)
            most[column] = max(most.get(column, 0.0), amount)
    s.single = s.single.but(backlash=tuple(sorted(most.items())))
    ex._state_changed()
    note(ex, line, rule)


def abort(ex: Motion, line: Command, rule: CodeRule) -> None:
    """M99.1: the program aborts itself."""
    ex.findings.add(ex.ends_here(codes.ABORTED_BY_PROGRAM).at(line.span, code=rule.text))
    if ex.aborted():
        return
    ex.event(Op.END, line.span)
    ex._end = rule.text, line.span.line
    ex._end_section(Wait.END, "aborted", -1, line.span)
    raise ProgramEnd


def subprogram_end(ex: Motion, line: Command, rule: CodeRule) -> None:
    """M99: back to the caller; in the job itself its end."""
    ex._leave_file(Span(line.span.file, line.span.line))


HANDLERS: dict[F, Handler] = {
    F.DWELL: dwell,
    F.ANALOG: analog,
    F.OUTPUT_ON: output,
    F.OUTPUT_OFF: output,
    F.OUTPUT_ON_MOVING: output,
    F.OUTPUT_OFF_MOVING: output,
    F.WAIT_ON: wait,
    F.WAIT_OFF: wait,
    F.VIRTUAL_ON: virtual,
    F.VIRTUAL_OFF: virtual,
    F.TOOL_NUMBER: tool_number,
    F.LOAD_REGISTERS: load_registers,
    F.STORE_TOOL: store_tool,
    F.STORE_POSITION: store_position,
    F.STORE_LOCAL_POSITION: store_position,
    F.AUTO_OUTPUT_ON: auto_output,
    F.AUTO_OUTPUT_OFF: auto_output,
    F.COMPENSATION_OFF: compensation,
    F.COMPENSATION_LEFT: compensation,
    F.COMPENSATION_RIGHT: compensation,
    F.MAP_WORDS: map_words,
    F.MAP_HEADS: map_words,
    F.MAP_PULSES: map_pulses,
    F.LOCK_AXIS: lock,
    F.UNLOCK_AXIS: lock,
    F.LIMITS_ON: guards,
    F.LIMITS_OFF: guards,
    F.LOW_BOUNDARY: boundary,
    F.HIGH_BOUNDARY: boundary,
    F.LOW_BOUNDARY_RESTORE: boundary,
    F.HIGH_BOUNDARY_RESTORE: boundary,
    F.KNIFE_ON: knife,
    F.KNIFE_OFF: knife,
    F.KNIFE_SETTING: knife_settings,
    F.SAW_ON: saw,
    F.SAW_OFF: _device("saw", False),
    F.HEIGHT_ON: height,
    F.HEIGHT_OFF: height,
    F.TORCH_ON: torch,
    F.TORCH_OFF: torch,
    F.LEVEL_HEADS: level_heads,
    F.MEASURE_SURFACE: measured,
    F.MEASURE_DEPTH: measured,
    F.RECALL_POSITIONS: recall,
    F.MAP_ADJUSTMENT: map_adjustment,
    F.FEED_OVERRIDE: feed_override,
    F.DYNAMICS: dynamics,
    F.SMOOTHING: smoothing,
    F.BACKLASH: backlash,
    F.PROBE_ON: _device("probe", True, moves=True),
    F.PROBE_OFF: _device("probe", False),
    F.ABORT: abort,
    F.RETURN: subprogram_end,
}
