"""What a move is in every language: a row of the trace, and the state at its end."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from gproof.ir import codes
from gproof.ir.finding import Refusal, Span
from gproof.ir.machine import AXIS_NAMES
from gproof.ir.symbolic import NOBODY, NOWHERE, Position
from gproof.ir.trace import Op, Plane, Wait
from gproof.passes.interpret.core import refused_lines
from gproof.passes.interpret.core.spindle_speed import true_rpm

if TYPE_CHECKING:
    from gproof.passes.interpret.core.run import Run

AXES_OF_PLANE = {Plane.XY: (0, 1, 2), Plane.XZ: (0, 2, 1), Plane.YZ: (1, 2, 0)}
"""Columns of the two axes of a plane, and of the one across it."""
CLAMPED = 3
"""The axis that M26 clamps (Eding 3.5.9): A."""
APART = "a motion that is not part of the contour"


def go(
    run: Run, op: Op, target: list[Position], span: Span, *, center: list[float] | None = None,
    turns: int = 0, plane: int = 0, length: float | None = None, programmed: tuple[float, float] | None = None,
) -> None:  # fmt: skip
    """Append a motion row and go there.

    length: mm that an inverse time feed counts, where the row is part of a longer move; programmed: the point of
    the contour that a compensated row belongs to; without it Refusal GP256 while compensation is on.
    """
    s = run.modal
    if s.compensation is not None and programmed is None:
        raise Refusal(codes.COMPENSATION_UNKNOWN.at(span, cause=APART, hint="program G40 before"))
    if s.refused_at is not None:
        refused_lines.tell(run, target, span)
    if s.jumped:
        # No row says how the axes came from the last one to here.
        s.jumped = False
        run.end_section(Wait.UNKNOWN, "line refused", None, span)
    if s.clamped or s.drives_were_off or s.not_programmed:
        _look_at(run, target, span)
    if any(a.value != b.value for a, b in zip(target[3:], s.position[3:], strict=True)):
        # Rounding is no motion: a rotary move next to it keeps its feed in degrees.
        for axis in range(3):
            if abs(target[axis].value - s.position[axis].value) < 1e-9:
                target[axis] = Position(s.position[axis].value, target[axis].form)
    start = [p.value for p in s.position]
    own, rotary = _length(op, start, [p.value for p in target], center, turns, plane)
    feed = 0.0
    if op is not Op.TRAVERSE:
        feed = _effective_feed(run, own if length is None or rotary else length, rotary)
    s.position = list(target)
    run.moves += 1
    run.rows.append(
        op, file=run.file_of(span), line=span.line, call=run.call, to=[p.value for p in target],
        frame=run.frame_number(), state=run.state_number(), feed=feed,
        center=(0.0, 0.0, 0.0) if center is None else center, turns=turns, plane=plane,
        arg=programmed or (0.0, 0.0),
    )  # fmt: skip


def _look_at(run: Run, target: list[Position], span: Span) -> None:
    """Before a move: GP279, GP281; what is not known of its end becomes NOWHERE in ``target``."""
    s = run.modal
    if s.clamped:
        way = target[CLAMPED].minus(s.position[CLAMPED])
        name = AXIS_NAMES[CLAMPED].upper()
        if way.form:
            cause = "the move of the clamped axis"
            raise Refusal(codes.UNKNOWN_VALUE.at(span, word=name, cause=cause, why=NOBODY))
        if abs(way.value) > 1e-9:
            raise Refusal(codes.AXIS_CLAMPED.at(span, axis=name, hint="program M27 before"))
    if s.drives_were_off and target != s.position:
        s.drives_were_off = False
        run.fail(codes.DRIVES_WERE_OFF.at(span))
    for axis in s.not_programmed:
        target[axis] = Position(target[axis].value, NOWHERE.form)


def _effective_feed(run: Run, length: float, rotary: bool) -> float:
    """mm/min (deg/min for rotary moves) of a feed move of this length; NaN when not known."""
    s = run.modal
    if s.pitch:
        return s.pitch * true_rpm(s)
    if s.feed_unknown:
        return math.nan
    if s.feed == 0.0:
        # No feed move comes here without F: the corner of a compensated traverse.
        return math.nan
    if s.feed_mode == 93:
        return s.feed * length * s.feed_override
    feed = (s.feed / s.feed_unit if rotary else s.feed) * s.feed_override
    if s.feed_mode == 95:
        return feed * (true_rpm(s) or math.nan)
    return feed


def _length(
    op: Op, start: list[float], end: list[float], center: list[float] | None, turns: int, plane: int
) -> tuple[float, bool]:
    """(path length in mm, or degrees for moves of rotary axes alone; whether it is such a move)."""
    linear = [b - a for a, b in zip(start[:3], end[:3], strict=True)]
    if op is Op.ARC and center is not None:
        first, second, third = AXES_OF_PLANE[Plane(plane)]
        if plane == Plane.XZ:
            first, second = second, first
        a0 = math.atan2(start[second] - center[second], start[first] - center[first])
        a1 = math.atan2(end[second] - center[second], end[first] - center[first])
        sweep = math.fmod((a1 - a0) * (1 if turns > 0 else -1), 2 * math.pi)
        if sweep <= 0:
            sweep += 2 * math.pi
        sweep += 2 * math.pi * (abs(turns) - 1)
        r0 = math.hypot(start[first] - center[first], start[second] - center[second])
        r1 = math.hypot(end[first] - center[first], end[second] - center[second])
        return math.hypot(sweep * (r0 + r1) / 2, linear[third]), False
    length = math.sqrt(sum(d * d for d in linear))
    if length > 0:
        return length, False
    turn = math.sqrt(sum((b - a) * (b - a) for a, b in zip(start[3:], end[3:], strict=True)))
    return turn, turn > 0.0
