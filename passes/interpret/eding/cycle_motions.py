"""What each canned cycle does at its hole, from R down and out again. Eding CNC manual 3.4.21.2 to 3.4.21.12."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from typing import TYPE_CHECKING

from gproof.ir import codes
from gproof.ir.machine import AXIS_NAMES
from gproof.ir.record import record
from gproof.ir.rules import CodeRule
from gproof.ir.rules import Function as F
from gproof.ir.symbolic import NOWHERE, Position
from gproof.ir.trace import Op, Wait
from gproof.passes.interpret.core.parsed_line import Line
from gproof.passes.interpret.eding.spindle_synchronised import reverse, synchronised_move

if TYPE_CHECKING:
    from gproof.passes.interpret.core.run import Run


@record(frozen=True, slots=True, kw_only=True)
class Hole:
    """One line of a cycle, in machine coordinates.

    first, second: axes of the plane; drill: the axis across it; r, depth, clear: places on it (3.4.21); dwell:
    seconds; peck: mm (Q); entry: mm along first and second to where a back boring tool goes through; top: where
    its counter bore ends; pitch: mm a revolution of a tap.
    """

    rule: CodeRule
    first: int
    second: int
    drill: int
    r: Position
    depth: Position
    clear: Position
    dwell: float
    peck: float
    entry: tuple[float, float]
    top: Position
    pitch: float


def along(run: Run, line: Line, drill: int, to: Position, op: Op) -> None:
    """One move of the drilling axis alone; none when it is there already."""
    if run.modal.position[drill] == to:
        return
    target = list(run.modal.position)
    target[drill] = to
    run.move(op, target, line.span)


def _drill(run: Run, line: Line, hole: Hole) -> None:
    """G81, and G82 with its dwell: feed to the depth, traverse out."""
    along(run, line, hole.drill, hole.depth, Op.FEED)
    if hole.rule.function is F.DRILL_DWELL:
        _dwell(run, line, hole)
    along(run, line, hole.drill, hole.clear, Op.TRAVERSE)


def _bore(run: Run, line: Line, hole: Hole) -> None:
    """G85, and G89 with its dwell: feed in and out."""
    along(run, line, hole.drill, hole.depth, Op.FEED)
    if hole.rule.function is F.BORE_DWELL:
        _dwell(run, line, hole)
    along(run, line, hole.drill, hole.clear, Op.FEED)


def _peck(run: Run, line: Line, hole: Hole) -> None:
    """G83 and G73: feed a peck, out, back down to just above the bottom, until the depth.

    Out is the clear position (G83), or the length of a peck but not beyond R (G73).
    """
    r, depth, drill = hole.r, hole.depth, hole.drill
    if math.isnan(hole.peck):
        _open_pecks(run, line, hole)
        return
    back_off = min(run.modal.rules.peck_clearance_mm, hole.peck)
    for k in itertools.count(1):
        bottom = Position(max(r.value - k * hole.peck, depth.value), depth.form)
        along(run, line, drill, bottom, Op.FEED)
        if bottom.value <= depth.value:
            break
        out = hole.clear
        if hole.rule.function is F.DRILL_CHIP_BREAK:
            out = Position(min(bottom.value + hole.peck, r.value), bottom.form)
        along(run, line, drill, out, Op.TRAVERSE)
        along(run, line, drill, Position(min(bottom.value + back_off, r.value), bottom.form), Op.TRAVERSE)
    along(run, line, drill, hole.clear, Op.TRAVERSE)


def _open_pecks(run: Run, line: Line, hole: Hole) -> None:
    """The same where the length of a peck is not known: somewhere in the hole it turns round, or nowhere."""
    r, depth, drill = hole.r, hole.depth, hole.drill
    ends = depth.value - r.value, 0.0
    out = hole.clear
    along(run, line, drill, run.unknown_place("value", drill, ends, r), Op.FEED)
    if hole.rule.function is F.DRILL_CHIP_BREAK:
        out = run.unknown_place("value", drill, ends, r)
    along(run, line, drill, out, Op.TRAVERSE)
    along(run, line, drill, run.unknown_place("value", drill, ends, r), Op.TRAVERSE)
    along(run, line, drill, depth, Op.FEED)
    along(run, line, drill, hole.clear, Op.TRAVERSE)


def _bore_stop(run: Run, line: Line, hole: Hole) -> None:
    """G86: dwell, stop the spindle, traverse out, restart it."""
    turns = run.modal.spindle_direction
    along(run, line, hole.drill, hole.depth, Op.FEED)
    _dwell(run, line, hole)
    _turn(run, line, 0)
    along(run, line, hole.drill, hole.clear, Op.TRAVERSE)
    _turn(run, line, turns)


def _bore_manual(run: Run, line: Line, hole: Hole) -> None:
    """G88: dwell, stop the spindle, wait for the operator, who retracts; restart it.

    How far the operator retracts is not known: the drilling axis is nowhere until a line names its place.
    """
    turns = run.modal.spindle_direction
    along(run, line, hole.drill, hole.depth, Op.FEED)
    _dwell(run, line, hole)
    _turn(run, line, 0)
    run.event(Op.STOP, line.span)
    run.findings.add(codes.OPERATOR_STOP.at(line.span, code=hole.rule.text))
    run.modal.position[hole.drill] = NOWHERE
    axis = AXIS_NAMES[hole.drill].upper()
    run.assumed[f"{hole.rule.text}: the operator moves {axis} only, within its limits"] = None
    run.end_section(Wait.OPERATOR, "retracted by hand", None, line.span)
    _turn(run, line, turns)


def _back_bore(run: Run, line: Line, hole: Hole) -> None:
    """G87, its steps 2 to 13: through the hole with the spindle at rest, up to the counter bore, out again."""
    turns = run.modal.spindle_direction
    at = list(run.modal.position)
    beside = list(at)
    for axis, distance in zip((hole.first, hole.second), hole.entry, strict=True):
        beside[axis] = at[axis].moved(distance)
    spindle = run.modal.machine.spindle(run.modal.head)
    if spindle is None or not spindle.oriented_stop:
        hint = f"state oriented_stop under [spindles.{max(0, run.modal.head)}] of the machine file if it can"
        run.findings.add(codes.ORIENTED_STOP.at(line.span, code=hole.rule.text, hint=hint))
    _across(run, line, hole, beside)
    _orient(run, line)
    along(run, line, hole.drill, hole.depth, Op.TRAVERSE)
    _across(run, line, hole, at)
    _turn(run, line, turns)
    along(run, line, hole.drill, hole.top, Op.FEED)
    along(run, line, hole.drill, hole.depth, Op.FEED)
    _orient(run, line)
    _across(run, line, hole, beside)
    along(run, line, hole.drill, hole.clear, Op.TRAVERSE)
    _across(run, line, hole, at)
    _turn(run, line, turns)


def _tap(run: Run, line: Line, hole: Hole) -> None:
    """G84 and G74: in and out with the turns of the spindle, which is reversed at the bottom and again outside."""
    for to in (hole.depth, hole.clear):
        target = list(run.modal.position)
        target[hole.drill] = to
        synchronised_move(run, line, hole.rule, target, hole.pitch)
        reverse(run, line)


def _dwell(run: Run, line: Line, hole: Hole) -> None:
    run.event(Op.DWELL, line.span, arg=(hole.dwell, 0.0))


def _turn(run: Run, line: Line, direction: int) -> None:
    run.modal.spindle_direction = direction
    run.spindle_row(line)


def _orient(run: Run, line: Line) -> None:
    _turn(run, line, 0)
    run.event(Op.ORIENT, line.span)


def _across(run: Run, line: Line, hole: Hole, to: list[Position]) -> None:
    """Traverse in the plane of the cycle, the drilling axis where it is."""
    target = list(run.modal.position)
    target[hole.first], target[hole.second] = to[hole.first], to[hole.second]
    run.move(Op.TRAVERSE, target, line.span)


HOLES: dict[F, Callable[[Run, Line, Hole], None]] = {
    F.DRILL: _drill,
    F.DRILL_DWELL: _drill,
    F.DRILL_PECK: _peck,
    F.DRILL_CHIP_BREAK: _peck,
    F.TAP_RIGHT: _tap,
    F.TAP_LEFT: _tap,
    F.BORE: _bore,
    F.BORE_STOP: _bore_stop,
    F.BORE_BACK: _back_bore,
    F.BORE_MANUAL: _bore_manual,
    F.BORE_DWELL: _bore,
}
"""Cycles by their function: (run, line, hole)."""

CYCLES = tuple(HOLES)
"""Functions of canned cycles."""
