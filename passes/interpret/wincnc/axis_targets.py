"""Words to places: where the words of a line send the axes (WinCNC Users Guide, Command Reference)."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import TYPE_CHECKING

from gproof.ir import codes
from gproof.ir.finding import Refusal, Span
from gproof.ir.machine import AXES
from gproof.ir.symbolic import NOWHERE, Position, Unknown, Value
from gproof.passes.interpret.wincnc.coupling import followed, own_way, tell_held_back, went_along
from gproof.passes.interpret.wincnc.state import (
    TURN_SETTLED,
    UNSCALED,
    machine_zero,
)

if TYPE_CHECKING:
    from gproof.passes.interpret.wincnc.command import Command
    from gproof.passes.interpret.wincnc.state import (
        WinCncModal,
        WinCncRun,
    )


def is_absolute(run: WinCncRun) -> bool:
    """Whether the words of the line that runs are places."""
    once = run.modal.own.absolute_once
    return run.modal.absolute if once is None else once


def mapped(run: WinCncRun, line: Command) -> dict[int, Value]:
    """Axis words by the column that they move (L11, L12): an axis takes the word of its source."""
    words = line.axes()
    sources = run.modal.own.sources
    for column in words.keys() - set(sources):
        # The rule gives this word to the axis that is named twice, the example gives that axis another's words.
        what = f"a word of {run.machine.word(column)} while two axes use the words of another letter (L11, L12)"
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.span, code=what))
    return {axis: words[sources[axis]] for axis in range(AXES) if sources[axis] in words and run.modal.has_axis(axis)}


def aim(run: WinCncRun, line: Command, *, machine: bool = False) -> list[Position]:
    """Where the axis words send all axes, in machine coordinates; machine: the words are such."""
    s = run.modal
    words = mapped(run, line)
    if s.own.cell_open and words.keys() & {0, 1}:
        what = "an array without G92 X Y after its L10, which the manual requires,"
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.span, code=what))
    target = list(s.position)
    if machine:
        _doubt_machine(run, line, words)
        for axis, value in words.items():
            target[axis] = bounded(run, axis, value, machine_zero(s.own, axis))
        return follow(run, target, line.span, frozenset(words))
    for axis, value in words.items():
        if s.own.sources[axis] != axis:
            _doubt_source(run, line, axis)
        target[axis] = place_of(run, axis, value)
    if s.transform.on and (0 in words or 1 in words):
        _doubt_turning(run, line)
        pair = tuple(in_mm(run, axis, words.get(axis)) for axis in (0, 1))
        at = s.position[0], s.position[1]
        if is_absolute(run):
            _doubt_other(run, line, words)
            target[0], target[1] = s.transform.absolute((pair[0], pair[1]), at, (s.offset(0), s.offset(1)))
        else:
            target[0], target[1] = s.transform.incremental((pair[0], pair[1]), at)
    return follow(run, target, line.span, frozenset(words))


def _doubt_machine(run: WinCncRun, line: Command, words: dict[int, Value]) -> None:
    """Refusal where more than tool measures and local coordinates, which G53 ignores, is between words and places."""
    s = run.modal
    if not is_absolute(run) and words:
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.span, code="G53 with distances (G91, L91)"))
    if (s.transform.on and words.keys() & {0, 1}) or words.keys() & {axis for axis, _ in scaled_axes(s)}:
        raise Refusal(codes.TRANSFORM_OPEN.at(line.span, what="whether G53 is scaled and turned by G51 and G52"))


def _doubt_turning(run: WinCncRun, line: Command) -> None:
    """Refusal where X or Y is scaled or turned and mapped: which comes first is not said."""
    for axis, source in enumerate(run.modal.own.sources):
        if axis != source and {axis, source} & {0, 1}:
            raise Refusal(codes.TRANSFORM_OPEN.at(line.span, what="whether L11 maps words before or after they turn"))


def _doubt_other(run: WinCncRun, line: Command, words: dict[int, Value]) -> None:
    """Refusal GP276 for one of X and Y alone while G52 turns both, where the other one of the program is not known.

    It is the one that was programmed last, or what the place of the machine is when it is turned back: the same once
    both were named after G52, or where the axes were at the middle of the turn.
    """
    s = run.modal
    if {0, 1} <= words.keys():
        if {0, 1} & (s.own.locked | {axis for axis, _ in s.own.slaves}):
            turn_unsettled(s)
        else:
            s.own = s.own.but(flags=s.own.flags | {TURN_SETTLED})
    elif s.transform.rotated and TURN_SETTLED not in s.own.flags:
        what = "the programmed position of the other axis of X and Y after G52, before a line names both"
        raise Refusal(codes.TRANSFORM_OPEN.at(line.span, what=what))


def turn_unsettled(s: WinCncModal, axes: Iterable[int] = (0, 1)) -> None:
    """X or Y, if among ``axes``, went to a place of the machine: while G52 turns them the program's is open again."""
    if TURN_SETTLED in s.own.flags and not {0, 1}.isdisjoint(axes):
        s.own = s.own.but(flags=s.own.flags - {TURN_SETTLED})


def place_of(run: WinCncRun, axis: int, value: Value) -> Position:
    """Where a word sends an axis by itself, as G51 scales it; of X and Y nobody can say that while G51 or G52 is on."""
    s = run.modal
    absolute = is_absolute(run)
    origin = s.offset(axis) if absolute else s.position[axis]
    factor, center, zero = dict(s.own.scales).get(axis, UNSCALED)
    if factor == 1.0:
        return bounded(run, axis, value, origin)
    if isinstance(value, Unknown) or math.isnan(factor) or (absolute and zero != origin):
        return NOWHERE
    about = center / s.scale(axis)
    return bounded(run, axis, about + factor * (value - about) if absolute else factor * value, origin)


def _doubt_source(run: WinCncRun, line: Command, axis: int) -> None:
    """Where L11 or L12 has another axis's words move one: whose zero and scale count, that axis's or its own?

    A tool's measure is that of the head that moves (Head Swap, Tool Length Offset). GP304, once for each axis, where
    local coordinates differ, the row having its own; GP276 where the scales do.
    """
    s = run.modal
    source = s.own.sources[axis]
    scales = dict(s.own.scales)
    if {scales.get(axis, UNSCALED)[0], scales.get(source, UNSCALED)[0]} != {1.0} or s.scale(axis) != s.scale(source):
        what = (
            f"whether {run.machine.word(axis)}, which L11 or L12 maps, is scaled as itself or as the axis of the letter"
        )
        raise Refusal(codes.TRANSFORM_OPEN.at(line.span, what=what))
    zeros = [s.g92[n].plus(s.work_offsets[s.work, n]).plus(machine_zero(s.own, n)) for n in (axis, source)]
    if zeros[0] != zeros[1] and is_absolute(run):
        what = "which local zero counts for words that L11 or L12 maps"
        tell_open(run, line.span, axis, what)


def tell_open(run: WinCncRun, span: Span, axis: int, cause: str) -> None:
    """GP304 for a place that another reading has elsewhere, once for each axis and cause; nothing is proved then."""
    s = run.modal
    name = f"open {axis} {cause[:12]}"
    if name in s.own.flags:
        return
    s.own = s.own.but(flags=s.own.flags | {name})
    run.refuse(codes.POSITION_UNKNOWN.at(span, axis=run.machine.word(axis), cause=cause))


def scaled_axes(s: WinCncModal) -> list[tuple[int, float]]:
    """Columns other than X and Y that G51 scales, and their factors, NaN where it is not known."""
    return [(axis, factor) for axis, (factor, _, _) in s.own.scales if factor != 1.0]


def in_mm(run: WinCncRun, axis: int, value: Value | None) -> Value | None:
    """The value of a word in mm or degrees."""
    return value if value is None or isinstance(value, Unknown) else value * run.modal.scale(axis)


def bounded(run: WinCncRun, axis: int, value: Value, origin: Position) -> Position:
    """Where a word sends its axis, from ``origin``; a value that is only bounded gives an unknown place."""
    scale = run.modal.scale(axis)
    if not isinstance(value, Unknown):
        return Position(value * scale + origin.value, origin.form)
    if not value.bounded or origin == NOWHERE:
        return NOWHERE
    return run.unknown_place("value", axis, (value.low * scale, value.high * scale), origin)


def follow(
    run: WinCncRun, target: list[Position], span: Span, named: frozenset[int] = frozenset()
) -> list[Position]:  # fmt: skip
    """The target with what follows other axes step by step (L13), and without what is locked (L300): GP200.

    named: columns of the line's words. Refusal GP113 for a follower that is sent somewhere itself.
    """
    own_way(run, target, span, named)
    for axis in went_along(run.modal, target, named):
        tell_open(run, span, axis, "whether the steps that it made with another axis (L13) count")
    tell_held_back(run, target, span)
    return followed(run.modal.own, run.modal.position, target)
