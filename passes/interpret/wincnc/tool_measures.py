"""Measures of tools: taken, stored, shifted, in force or not (WinCNC Users Guide, Tool Length Offset)."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from gproof.ir import codes
from gproof.ir.finding import Refusal
from gproof.ir.machine import AXES
from gproof.ir.rules import CodeRule
from gproof.ir.rules import Function as F
from gproof.ir.symbolic import NOWHERE, Position, Unknown
from gproof.ir.trace import Op
from gproof.passes.geometry.machine_axes import vertical_axes
from gproof.passes.interpret.core.modal_state import ZERO
from gproof.passes.interpret.wincnc.axis_targets import scaled_axes
from gproof.passes.interpret.wincnc.state import (
    REGISTERS_OPEN,
    arm_low_boundaries,
    machine_zero,
)
from gproof.passes.interpret.wincnc.work_offsets import all_axes, distance

if TYPE_CHECKING:
    from gproof.passes.interpret.wincnc.command import Command
    from gproof.passes.interpret.wincnc.state import WinCncRun


def lengths(run: WinCncRun, line: Command, rule: CodeRule) -> None:
    """G43 and G49: measures on and off, of all vertical axes or of those named."""
    s = run.modal
    axes = set(line.axes()) or set(vertical_axes(run.machine))
    off = set(s.own.unmeasured)
    stored = dict(enumerate(s.own.before or s.tool_offset))
    if rule.function is F.TOOL_OFFSET_OFF:
        for axis in axes - off:
            stored[axis] = s.tool_offset[axis]
        for axis in axes:
            s.tool_offset[axis] = ZERO
        off |= axes
    else:
        for axis in axes & off:
            s.tool_offset[axis] = stored[axis]
        s.lengths_used = True
        arm_low_boundaries(s)
        off -= axes
    s.own = s.own.but(unmeasured=frozenset(off), before=tuple(stored[axis] for axis in range(AXES)))
    run.state_changed()
    run.event(Op.TOOL_OFFSET, line.span, arg=(0.0, 0.0))


def set_measure(run: WinCncRun, axis: int, offset: Position) -> None:
    """A tool measure of an axis: in force from here."""
    s = run.modal
    s.tool_offset[axis] = offset
    s.lengths_used = True
    s.own = s.own.but(unmeasured=s.own.unmeasured - {axis})
    arm_low_boundaries(s)


def measure_tool(run: WinCncRun, line: Command, rule: CodeRule) -> None:
    """M37: the present place of a vertical axis reads as this, without local coordinates."""
    s = run.modal
    axes = line.axes()
    if "O" in line.values or not axes:
        for axis in vertical_axes(run.machine):
            set_measure(run, axis, NOWHERE)
        run.state_changed()
        what = f"{rule.text} with O" if "O" in line.values else f"{rule.text} without an axis"
        raise Refusal(
            codes.UNSUPPORTED_CODE.at(line.span, code=f"{what} (the manual does not say in which direction it counts)")
        )
    if axes.keys() & {axis for axis, _ in scaled_axes(s)}:
        for axis in axes:
            set_measure(run, axis, NOWHERE)
        run.state_changed()
        raise Refusal(
            codes.TRANSFORM_OPEN.at(line.span, what=f"which length {rule.text} means while G51 scales its axis")
        )
    for axis, value in axes.items():
        base = s.work_offsets[s.work, axis].plus(machine_zero(s.own, axis))
        offset = s.position[axis].minus(base).minus(distance(run, axis, value))
        if s.g92[axis] != ZERO:
            # The place reads so with local coordinates or without them: which, is not said.
            local = s.g92[axis]
            known = not local.form and offset != NOWHERE
            ends = min(0.0, -local.value), max(0.0, -local.value)
            offset = run.unknown_place("value", axis, ends, offset) if known else NOWHERE
        set_measure(run, axis, offset)
        for letter in "HT":
            if letter in line.values:
                number = line.whole(letter, run.program.rules.integer_tolerance) or 0
                heights = {**dict(s.own.heights), number: offset}
                s.own = s.own.but(heights=tuple(sorted(heights.items(), key=lambda pair: pair[0])))
    for axis in s.own.unmeasured - axes.keys():
        # M37 "turns on G43 mode": of its own axis, or of all that G49 put aside. G43 and G49 settle it.
        if (s.own.before or s.tool_offset)[axis] != s.tool_offset[axis]:
            s.tool_offset[axis] = NOWHERE
    run.state_changed()
    run.event(Op.TOOL_OFFSET, line.span, arg=(math.nan, 0.0))


def measure_switch(run: WinCncRun, line: Command, rule: CodeRule) -> None:
    """M37.1, M37.2: the height of a measure switch, which TM1 and TM2 show."""
    s = run.modal
    heights = list(s.own.switch_heights)
    heights[rule.value - 1] = Unknown(f"TM{rule.value}")
    s.own = s.own.but(switch_heights=(heights[0], heights[1]))


def shift_measures(run: WinCncRun, line: Command, rule: CodeRule) -> None:
    """M37.3: measures, H registers and workspaces are shifted; whether what is stored is shifted is then not known."""
    s = run.modal
    axes = line.axes()
    if line.values.keys() & set("HTM"):
        s.own = s.own.but(
            heights=(), switch_heights=(Unknown("TM1"), Unknown("TM2")),
            flags=s.own.flags | {REGISTERS_OPEN},
        )  # fmt: skip
        for axis in vertical_axes(run.machine):
            set_measure(run, axis, NOWHERE)
    for axis in axes:
        s.work_offsets[s.work, axis] = NOWHERE
    run.state_changed()
    if axes or line.values.keys() & set("HTM"):
        what = f"{rule.text} (the manual does not say in which direction the shift counts)"
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.span, code=what))


def store_register(run: WinCncRun, line: Command, rule: CodeRule) -> None:
    """L1 N V: an H register."""
    number = line.whole("N", run.program.rules.integer_tolerance)
    if number is None or not 0 <= number < 30:
        raise Refusal(codes.PARAMETER_RANGE.at(line.where("N"), code=rule.text, word="N", allowed="0 to 29"))
    s = run.modal
    # Whether L101 and home positions (H) of that number are the same register, and how V counts there, is not said.
    heights = {**dict(s.own.heights), number: NOWHERE}
    places = tuple((known, where, lift) for known, where, lift in s.own.places if known != f"H{number}")
    s.own = s.own.but(
        heights=tuple(sorted(heights.items(), key=lambda pair: pair[0])),
        places=(*places, (f"H{number}", tuple((axis, NOWHERE) for axis in all_axes(run)), False)),
    )
