"""Homing, machine zero, and homes that are stored (WinCNC Users Guide, G Codes: G28; L Codes: L2, L3, L26 to L28)."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from gproof.ir import codes
from gproof.ir.dialects.wincnc.settings import wincnc_settings
from gproof.ir.finding import Refusal
from gproof.ir.machine import AXIS_NAMES
from gproof.ir.rules import CodeRule
from gproof.ir.rules import Function as F
from gproof.ir.symbolic import NOWHERE, Position
from gproof.ir.trace import Op, Wait
from gproof.passes.interpret.core.modal_state import ZERO
from gproof.passes.interpret.wincnc.axis_targets import follow, turn_unsettled
from gproof.passes.interpret.wincnc.moves import note_assumptions
from gproof.passes.interpret.wincnc.state import (
    machine_zero,
)
from gproof.passes.interpret.wincnc.work_offsets import all_axes, distance, doubt_transform

if TYPE_CHECKING:
    from gproof.passes.interpret.wincnc.command import Command
    from gproof.passes.interpret.wincnc.state import WinCncRun


def _homing_order(run: WinCncRun, axes: list[int]) -> list[int]:
    """Axes as the lines of g28move= have them, others after."""
    listed = [AXIS_NAMES.index(name) for line in wincnc_settings(run.machine).homing for name, _ in line.distances]
    return sorted(axes, key=lambda axis: (listed.index(axis) if axis in listed else len(listed), axis))


def home(run: WinCncRun, line: Command, rule: CodeRule) -> None:
    """G28: axes run to their switches; there they count as machine zero, or what g28coord= says."""
    s = run.modal
    axes = _homing_order(run, list(line.axes()) or all_axes(run))
    held = s.own.locked & set(axes)
    held |= {axis for pair in s.own.slaves for axis in pair} & set(axes)
    if held:
        for axis in axes:
            s.position[axis] = NOWHERE
        s.jumped = True
        what = f"{rule.text} of an axis that L300 locks or L13 couples"
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.where_code(rule), code=what))
    turn_unsettled(s, axes)
    names = " ".join(AXIS_NAMES[axis] for axis in axes)
    run.event(Op.HOME, line.span, text=run.text_number(names))
    for axis in axes:
        there = run.machine.axis(AXIS_NAMES[axis])
        place = there.home_place if there is not None else None
        s.position[axis] = Position(0.0 if place is None else place)
    s.own = s.own.but(
        touched=s.own.touched - set(axes), drift=_without(s.own.drift, axes),
        zeros=_without(s.own.zeros, axes), found=s.own.found - set(axes),
    )  # fmt: skip
    run.state_changed()
    s.unhomed -= set(axes)
    _warn_kept(run, line, rule, axes)
    run.assumed["homing moves do not leave the machine"] = None
    if any(s.g92[axis] != ZERO for axis in axes):
        run.assumed["local coordinates (G92) stay active after homing"] = None
    letters = {axis.index: axis.word for axis in run.machine.axes}
    run.findings.add(codes.HOMING.at(line.span, axes=" ".join(letters.get(axis, "?") for axis in axes)))
    run.end_section(Wait.HOME, "homed", None, line.span)


def _without(
    pairs: tuple[tuple[int, Position], ...], axes: list[int]
) -> tuple[tuple[int, Position], ...]:  # fmt: skip
    return tuple(pair for pair in pairs if pair[0] not in axes)


def _warn_kept(run: WinCncRun, line: Command, rule: CodeRule, axes: list[int]) -> None:
    """GP335 for local coordinates and tool measures that the job has given to axes whose machine zero moves.

    A measure is there for being kept over G28, which then shows the tip above the table (Tool Length Offset).
    """
    s = run.modal
    kept = [(s.g92, "a local zero (G92) is")]
    if rule.function is not F.HOME:
        kept.append((s.tool_offset, "a tool measure (M37) is"))
    for places, what in kept:
        moved = [axis for axis in axes if not places[axis].form and places[axis] != ZERO]
        if moved:
            names = " ".join(run.machine.word(axis) for axis in moved)
            run.findings.add(codes.OFFSET_KEPT.at(line.span, code=rule.text, axes=names, what=what))


def set_machine(run: WinCncRun, line: Command, rule: CodeRule) -> None:
    """L28: the present place gets these machine coordinates.

    At a limit switch that the job has found, and after it, that is how machine zero comes about: positions count from
    there. Anywhere else the machine's ends stay where they are, and so do positions; what the controller counts from
    machine zero (words, G53, stored places, soft limits, boundaries) moves with it.
    """
    s = run.modal
    axes = line.axes()
    doubt_transform(run, line, rule, set(axes))
    _warn_kept(run, line, rule, list(axes))
    at_switch = [axis for axis in axes if axis in s.own.touched | s.own.found]
    zeros = dict(s.own.zeros)
    for axis, value in axes.items():
        place = distance(run, axis, value)
        if axis in at_switch:
            s.position[axis] = place
            zeros.pop(axis, None)
            continue
        before = machine_zero(s.own, axis)
        zeros[axis] = s.position[axis].minus(place)
        if axis in dict(s.own.drift):
            run.fail(codes.MACHINE_ZERO_MOVED.at(line.span, code=rule.text))
            zeros[axis] = NOWHERE
        if zeros[axis] != before and s.own.homes[axis] is not None:
            # What L3 stored: a number, or a place.
            s.own = s.own.but(homes=tuple(NOWHERE if n == axis else at for n, at in enumerate(s.own.homes)))
    turn_unsettled(s, axes)
    s.own = s.own.but(
        touched=s.own.touched - set(axes), found=s.own.found | set(at_switch),
        drift=_without(s.own.drift, list(axes)),
        zeros=tuple(sorted((axis, place) for axis, place in zeros.items() if place != ZERO)),
    )  # fmt: skip
    run.state_changed()
    if len(at_switch) < len(axes):
        run.assumed["L28 moves machine zero; positions in this report still count from the old one"] = None
    if at_switch:
        run.end_section(Wait.HOME, "position set", None, line.span)
    else:
        run.event(Op.OFFSET, line.span, arg=(0.0, 0.0))


def wrap_rotary(run: WinCncRun, line: Command, rule: CodeRule) -> None:
    """L28.1: rotary axes count between 0 and 360 degrees."""
    s = run.modal
    changed = False
    for axis in run.machine.axes:
        place = s.position[axis.index]
        if s.linear[axis.index]:
            continue
        new = NOWHERE if place.form else Position(math.fmod(math.fmod(place.value, 360.0) + 360.0, 360.0))
        changed = changed or new != place
        s.position[axis.index] = new
    if changed:
        run.end_section(Wait.HOME, "position set", None, line.span)


def store_home(run: WinCncRun, line: Command, rule: CodeRule) -> None:
    """L3: remembers where axes are."""
    s = run.modal
    homes = list(s.own.homes)
    for axis in line.axes() or all_axes(run):
        homes[axis] = s.position[axis]
    s.own = s.own.but(homes=tuple(homes))


def return_home(run: WinCncRun, line: Command, rule: CodeRule) -> None:
    """L4: rapid to where L3 was met."""
    s = run.modal
    note_assumptions(run, line.span)
    target = list(s.position)
    for axis in line.axes() or all_axes(run):
        stored = s.own.homes[axis]
        if stored is None:
            s.position[axis] = NOWHERE
            s.jumped = True
            what = f"{rule.text} for an axis that no L3 of this job stored"
            raise Refusal(codes.UNSUPPORTED_CODE.at(line.span, code=what))
        target[axis] = stored
    turn_unsettled(s, line.axes() or (0, 1))
    run.move(Op.TRAVERSE, follow(run, target, line.span), line.span)
    run.moved = True
