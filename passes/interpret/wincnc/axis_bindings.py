"""Which words move which axes, which axes follow others or are locked, and boundaries (L11 to L28, L300)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gproof.ir import codes
from gproof.ir.dialects.wincnc.settings import wincnc_settings
from gproof.ir.finding import FollowedRefusal, Refusal
from gproof.ir.machine import AXES, AXIS_NAMES
from gproof.ir.rules import CodeRule
from gproof.ir.rules import Function as F
from gproof.ir.symbolic import NOWHERE, Unknown
from gproof.ir.trace import Op
from gproof.passes.interpret.wincnc.state import (
    COUPLING_OPEN,
    guards_now,
)

if TYPE_CHECKING:
    from gproof.passes.interpret.wincnc.command import Command
    from gproof.passes.interpret.wincnc.state import (
        WinCncRun,
    )


def map_words(run: WinCncRun, line: Command, rule: CodeRule) -> None:
    """L11 and L12: which word moves an axis: the letters stand for X Y Z W, or Z W, in that order."""
    s = run.modal
    columns = line.columns
    letters = line.letters
    if rule.function is F.MAP_HEADS and "mapped" in s.own.flags and s.own.sources[:2] != (0, 1):
        run.lose_places()
        what = f"{rule.text} while L11 maps X or Y (the manual does not say whether it ends that)"
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.span, code=what))
    if not letters:
        s.own = s.own.but(sources=tuple(range(AXES)), flags=s.own.flags - {"mapped"})
        return
    order = "XYZW" if rule.function is F.MAP_WORDS else "ZW"
    if len(letters) > len(order) or any(letter not in columns for letter in order[: len(letters)]):
        raise Refusal(codes.ILLEGAL_VALUE.at(line.span, word=rule.text, what=f"axes for {order} in that order"))
    _doubt_mapping(line, rule, order[: len(letters)])
    sources = list(range(AXES))
    for target, source in zip(order, letters, strict=False):
        sources[columns[target]] = columns[source]
    flags = s.own.flags | {"mapped"} if rule.function is F.MAP_WORDS else s.own.flags - {"mapped"}
    s.own = s.own.but(sources=tuple(sources), flags=flags)


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
        what = f"{rule.text} {' '.join(letters)} (the manual does not say which axis takes which words)"
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.span, code=what))


def map_pulses(run: WinCncRun, line: Command, rule: CodeRule) -> None:
    """L13: the second axis follows the first step by step."""
    s = run.modal
    letters = line.letters
    if not letters:
        s.own = s.own.but(slaves=(), flags=s.own.flags - {COUPLING_OPEN})
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
            "of more than two axes (the manual does not say which follows which)",
        )
    elif set(s.own.slaves) - pairs:
        pairs, what = (
            pairs | set(s.own.slaves),
            ("while another one is active (the manual does not say whether that one ends)"),
        )
    elif not _same_steps(run, *columns):
        what = (
            "of axes with different steps (the manual does not say whether the follower makes as many steps or "
            "moves as far)"
        )
    flags = s.own.flags | {COUPLING_OPEN} if what else s.own.flags
    s.own = s.own.but(slaves=tuple(sorted(pairs)), flags=flags)
    if what:
        raise FollowedRefusal(codes.UNSUPPORTED_CODE.at(line.span, code=f"{rule.text} {' '.join(letters)} {what}"))


def _same_steps(run: WinCncRun, leader: int, follower: int) -> bool:
    """Whether a step of two axes is equally long; what no file says of it is assumed."""
    drives = [axis for axis in run.machine.axes if axis.index in (leader, follower)]
    if len({axis.kind for axis in drives}) > 1:
        return False
    steps = {None if axis.steps_per_unit is None else abs(axis.steps_per_unit) for axis in drives}
    if None in steps:
        run.assumed["axes that L13 couples have steps of the same length"] = None
    return len(steps - {None}) < 2


def lock(run: WinCncRun, line: Command, rule: CodeRule) -> None:
    """L300, L301: axes that do not move, whatever the program says."""
    s = run.modal
    axes = frozenset(line.axes())
    if not axes and (rule.function is F.LOCK_AXIS or s.own.locked):
        s.position = [NOWHERE if s.has_axis(axis) else place for axis, place in enumerate(s.position)]
        s.jumped = True
        raise Refusal(
            codes.UNSUPPORTED_CODE.at(
                line.span, code=f"{rule.text} without axes (the manual does not say whether it means all or none)"
            )
        )
    locked = s.own.locked | axes if rule.function is F.LOCK_AXIS else s.own.locked - axes
    s.own = s.own.but(locked=locked, held_back=s.own.held_back - axes)


def guards(run: WinCncRun, line: Command, rule: CodeRule) -> None:
    """L20 and L21: soft limits and boundaries."""
    s = run.modal
    controls = wincnc_settings(run.machine)
    which = line.number("X") if rule.function is F.LIMITS_ON else None
    if which not in (None, 1.0, 2.0):
        raise Refusal(codes.PARAMETER_RANGE.at(line.where("X"), code=rule.text, word="X", allowed="1 or 2"))
    if rule.function is F.LIMITS_ON and not controls.limits_available:
        raise Refusal(codes.NOT_ENABLED.at(line.where_code(rule), code=rule.text, device="soft limits", key="softlim="))
    on = rule.function is F.LIMITS_ON
    s.own = s.own.but(soft=on and which != 1.0, bound=on and which != 2.0)
    set_guards(run)
    for name, state in (("machine_area", s.own.soft), ("boundaries", s.own.bound)):
        run.event(Op.GUARD, line.span, arg=(float(state), 0.0), text=run.text_number(name))


def set_guards(run: WinCncRun) -> None:
    """The guards that rows carry."""
    run.modal.guards_off = guards_now(run.modal)
    run.state_changed()


def boundary(run: WinCncRun, line: Command, rule: CodeRule) -> None:
    """L22, L23: boundaries in workspace numbers; without words, and with .1, those of the machine's file."""
    s = run.modal
    low = rule.function in (F.LOW_BOUNDARY, F.LOW_BOUNDARY_RESTORE)
    restore = rule.function in (F.LOW_BOUNDARY_RESTORE, F.HIGH_BOUNDARY_RESTORE)
    values = list(s.own.lower if low else s.own.upper)
    words = line.axes()
    if restore or not words:
        for axis in words or range(AXES):
            there = run.machine.axis(AXIS_NAMES[axis])
            values[axis] = None if there is None else there.boundary_lower if low else there.boundary_upper
    else:
        for axis, value in words.items():
            if isinstance(value, Unknown):
                raise Refusal(codes.UNKNOWN_CONDITION.at(line.span, cause=value.cause))
            values[axis] = value * s.scale(axis)
    s.own = s.own.but(lower=tuple(values)) if low else s.own.but(upper=tuple(values))
    set_guards(run)
