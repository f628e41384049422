"""Axes that follow others (L13) or are locked (L300): what each move then is, whoever makes it.

WinCNC Users Guide, L Codes: L13, L300, L301.
"""

from __future__ import annotations

from gproof.ir import codes
from gproof.ir.finding import Refusal, Span
from gproof.ir.symbolic import NOWHERE, Position
from gproof.ir.trace import Op
from gproof.passes.interpret.core import moves
from gproof.passes.interpret.wincnc.state import COUPLING_OPEN, SAME_PLACE, STILL, WinCncModal, WinCncRun, WinCncState


def go(
    run: WinCncRun, op: Op, target: list[Position], span: Span, *, center: list[float] | None = None,
    turns: int = 0, plane: int = 0, length: float | None = None, programmed: tuple[float, float] | None = None,
) -> None:  # fmt: skip
    """``moves.go`` with what couplings and locks make of the target."""
    s = run.modal
    if s.own.slaves or s.own.locked:
        # Every move, whoever makes it: of a cycle, of an array, of a lift.
        bound = {*s.own.locked, *(axis for pair in s.own.slaves for axis in pair)}
        if op is Op.ARC and bound & {0, 1}:
            what = "an arc while L13 couples or L300 locks X or Y"
            raise Refusal(codes.UNSUPPORTED_CODE.at(span, code=what))
        tell_held_back(run, target, span)
        target = followed(s.own, s.position, target)
        if s.own.slaves:
            s.own = drifted(s.own, s.position, target)
    moves.go(run, op, target, span, center=center, turns=turns, plane=plane, length=length, programmed=programmed)


def followed(single: WinCncState, position: list[Position], target: list[Position]) -> list[Position]:
    """The target with what follows other axes step by step (L13), and without what is locked (L300).

    While a cutter is compensated by an amount other than 0, it is not known where X and Y move.
    """
    target = list(target)
    if "compensation" in single.flags:
        target[:2] = [NOWHERE, NOWHERE]
    for axis, leader in single.slaves:
        way = STILL if leader in single.locked else target[leader].minus(position[leader])
        is_open = COUPLING_OPEN in single.flags and way != STILL
        target[axis] = NOWHERE if is_open else position[axis].plus(way)
    for axis in single.locked:
        target[axis] = position[axis]
    return target


def own_way(run: WinCncRun, target: list[Position], span: Span, named: frozenset[int]) -> None:
    """Refusal GP113 for a follower (L13) that is sent somewhere itself: whether it goes, and how far, is not said.

    named: columns of the line's words.
    """
    s = run.modal
    for axis, leader in s.own.slaves:
        if target[axis] != s.position[axis] or (axis in named and target[leader] != s.position[leader]):
            what = f"a move of {run.machine.word(axis)}, which follows {run.machine.word(leader)} (L13),"
            raise Refusal(codes.UNSUPPORTED_CODE.at(span, code=what))


def went_along(s: WinCncModal, target: list[Position], named: frozenset[int]) -> list[int]:
    """Columns that are sent to a place and have followed another axis: where they go then rests on what is counted.

    A command without words for an axis sends it to a place of the machine.
    """
    absolute = s.absolute if s.own.absolute_once is None else s.own.absolute_once
    return [
        axis for axis, _ in s.own.drift if (absolute if axis in named else target[axis] != s.position[axis])
    ]  # fmt: skip


def drifted(single: WinCncState, position: list[Position], target: list[Position]) -> WinCncState:
    """The state after a move: how far followers went with their leaders."""
    ways = dict(single.drift)
    for axis, _ in single.slaves:
        way = ways.get(axis, STILL).plus(target[axis].minus(position[axis]))
        ways[axis] = STILL if not way.form and abs(way.value) < SAME_PLACE else way
    return single.but(drift=tuple(sorted((axis, way) for axis, way in ways.items() if way != STILL)))


def tell_held_back(run: WinCncRun, target: list[Position], span: Span) -> None:
    """GP200 at the first move of each axis since L300 locked it."""
    s = run.modal
    if not s.own.locked - s.own.held_back:
        return
    target = followed(s.own.but(locked=frozenset()), s.position, target)
    for axis in sorted(s.own.locked - s.own.held_back):
        wanted, there = target[axis], s.position[axis]
        if wanted.form == there.form and abs(wanted.value - there.value) < SAME_PLACE:
            continue
        s.own = s.own.but(held_back=s.own.held_back | {axis})
        what = f"{run.machine.word(axis)} is locked (L300), but from here on its moves are programmed"
        run.findings.add(codes.COMMAND_IGNORED.at(span, what=what, hint="unlock it with L301"))
