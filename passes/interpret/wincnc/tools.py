"""Tools by number, what is stored of them, and the compensation of their wear (WinCNC Users Guide, L Codes)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gproof.ir import codes
from gproof.ir.dialects.wincnc.settings import wincnc_settings
from gproof.ir.finding import Refusal
from gproof.ir.machine import AXES, AXIS_NAMES
from gproof.ir.rules import CodeRule
from gproof.ir.rules import Function as F
from gproof.ir.symbolic import NOWHERE, Unknown, bounds
from gproof.ir.trace import Op, ToolDiameter
from gproof.passes.interpret.wincnc.events import note
from gproof.passes.interpret.wincnc.state import (
    REGISTERS_OPEN,
    arm_low_boundaries,
)

if TYPE_CHECKING:
    from gproof.passes.interpret.wincnc.command import Command
    from gproof.passes.interpret.wincnc.state import (
        WinCncRun,
    )


def tool_number(run: WinCncRun, line: Command, rule: CodeRule) -> None:
    """L101, L102, L110, L120: which tool is in a changer's spindle, and its measure."""
    s = run.modal
    number = line.whole("T", run.program.rules.integer_tolerance)
    assert number is not None
    if not 0 <= number <= run.program.rules.highest_tool:
        raise Refusal(codes.PARAMETER_RANGE.at(line.where("T"), code=rule.text, word="T", allowed="0 to 999"))
    tools = list(s.own.tools)
    tools[rule.value - 1] = float(number)
    s.own = s.own.but(tools=(tools[0], tools[1]))
    if rule.value == 1 and s.tool != number and s.own.reference is None:
        s.lengths_used = True
        s.own = s.own.but(reference=tuple(s.beside_tip(axis) for axis in range(AXES)))
    changers = {changer.number: changer for changer in wincnc_settings(run.machine).changers}
    changer = changers.get(rule.value)
    axis = AXIS_NAMES.index(changer.axis) if changer is not None else 2
    register = line.whole("R", run.program.rules.integer_tolerance) if "R" in line.values else number
    offset = dict(s.own.heights).get(register if register is not None else number)
    if offset is None and REGISTERS_OPEN in s.own.flags:
        offset = NOWHERE
    if offset is None:
        offset = s.symbol(f"tool.{register}.{AXIS_NAMES[axis]}") if number else s.symbol(
            f"tool.{number}.{AXIS_NAMES[axis]}")  # fmt: skip
    if axis in s.own.unmeasured:
        # G49 is in force: whether the new tool's measure is, the manual does not say; G43 and G49 settle it.
        stored = list(s.own.before or s.tool_offset)
        stored[axis] = offset
        s.own = s.own.but(before=tuple(stored))
        if offset != s.tool_offset[axis]:
            s.tool_offset[axis] = NOWHERE
    else:
        s.tool_offset[axis] = offset
    s.lengths_used = True
    if rule.value == 1:
        s.tool = number
    arm_low_boundaries(s)
    run.state_changed()
    run.event(Op.TOOL_CHANGE, line.span, arg=(float(number), 0.0))


def store_tool(run: WinCncRun, line: Command, rule: CodeRule) -> None:
    """L500.2: an entry of the tool library."""
    number = line.whole("T", run.program.rules.integer_tolerance) or 0
    s = run.modal
    nominal, actual, added = (line.values.get(letter) for letter in "NAC")
    same = nominal is not None and nominal == actual and not isinstance(nominal, Unknown) and added == 0.0
    s.own = s.own.but(unworn=s.own.unworn | {number} if same else s.own.unworn - {number})
    if {"H", "O", "C"} & line.values.keys():
        heights = {**dict(s.own.heights), number: NOWHERE}
        s.own = s.own.but(heights=tuple(sorted(heights.items(), key=lambda pair: pair[0])))
    given = nominal if actual is None else actual
    if given is not None:
        # In which unit the library has them is not said: in the job's, or the machine's.
        scales = (s.unit, run.machine.unit)
        ends = [abs(end * scale) for end in bounds(given) for scale in scales]
        others = tuple(each for each in s.own.diameters if each.tool != number)
        s.own = s.own.but(diameters=(*others, ToolDiameter(number, min(ends), max(ends))))
        run.state_changed()
    note(run, line, rule)


def load_registers(run: WinCncRun, line: Command, rule: CodeRule) -> None:
    """L1.2: what registers hold then is in a file that is not known."""
    s = run.modal
    s.own = s.own.but(heights=(), flags=s.own.flags | {REGISTERS_OPEN})
    what = f"{rule.text} (the manual does not say from which file the registers are loaded)"
    raise Refusal(codes.UNSUPPORTED_CODE.at(line.span, code=what))


def compensation(run: WinCncRun, line: Command, rule: CodeRule) -> None:
    """G40 to G42: for differences of tool diameters; how the path differs from the programmed one is not described.

    Nothing moves aside for O0 on a machine without a tool changer, and on one with a changer for a tool to which the
    job's own L500.2 gave one diameter, nominal and actual. Else X and Y are not known until G40 and their next words:
    an amount bounds no corner, which may be mitred.
    """
    s = run.modal
    if rule.function is F.COMPENSATION_OFF:
        s.own = s.own.but(flags=s.own.flags - {"compensation"})
        return
    controls = wincnc_settings(run.machine)
    amount = line.number("O")
    if not controls.changers and amount == 0.0:
        if controls.devices is None:
            run.assumed["the machine has no tool changer: O of G41 and G42 is used"] = None
        return
    tool = s.own.tools[0]
    known = len(controls.changers) == 1 and controls.changers[0].number == 1 and not isinstance(tool, Unknown)
    if not amount and known and tool in s.own.unworn:
        return
    s.own = s.own.but(flags=s.own.flags | {"compensation"})
    for axis in (0, 1):
        s.position[axis] = NOWHERE
    s.jumped = True
    what = (
        f"{rule.text} with an amount other than 0 (the manual does not say whether half or all of it counts, and "
        "does not describe entry and corners)"
    )
    if controls.changers:
        what = f"{rule.text} on a machine with a tool changer, which uses the tool library"
    elif amount is None:
        what = f"{rule.text} without O"
    raise Refusal(codes.UNSUPPORTED_CODE.at(line.span, code=what))
