"""Moves that follow the turns of the spindle: G33, G33.1, and what threading and tapping are made of.

Eding CNC manual 3.4.9. The nominal feed of such a move is its pitch times the spindle speed.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from gproof.ir import codes
from gproof.ir.finding import Refusal
from gproof.ir.machine import AXES, AXIS_NAMES
from gproof.ir.rules import CodeRule
from gproof.ir.rules import Function as F
from gproof.ir.symbolic import Position
from gproof.ir.trace import Op
from gproof.passes.interpret.core.open_numbers import number_or_open
from gproof.passes.interpret.core.parsed_line import Line
from gproof.passes.interpret.core.spindle_speed import true_rpm
from gproof.passes.interpret.eding.ambiguous_words import owned
from gproof.passes.interpret.eding.spindle import need_turning, note_speed_unknown

if TYPE_CHECKING:
    from gproof.passes.interpret.core.run import Run

SYNCHRONISED = (F.SYNCHRONISED, F.SYNCHRONISED_RETURN)
"""Functions that ``run_synchronised`` executes."""


def run_synchronised(run: Run, line: Line, rule: CodeRule, target: list[Position]) -> None:
    """G33: out; G33.1: out and, with the spindle reversed, back. Refusal with GP121, GP244, GP275, GP266, GP510.

    G68 turns the path like that of any other move; what G51 makes of the pitch is open (GP284).
    """
    s = run.modal
    for axis in line.axes():
        if axis >= 3:
            word = AXIS_NAMES[axis].upper()
            raise Refusal(codes.UNUSED_WORD.at(line.where(word), word=f"{word} together with {rule.text}"))
    owned(line, rule, "K")
    pitch = number_or_open(run, line, "K", rule.text, positive=True)
    if pitch is None or pitch <= 0:
        given = "" if pitch is None else f" greater than 0; K{pitch:g} is given"
        raise Refusal(codes.WORD_MISSING.at(line.where("K"), code=rule.text, needed=f"K{given}"))
    if math.isnan(pitch):
        # Whether an axis can follow (3.4.9) rests on it as the feed does.
        cause = "K, whose value is unknown"
        run.findings.add(codes.FEED_UNKNOWN.at(line.where("K"), code=rule.text, cause=cause))
    need_turning(run, line, rule)
    pitch *= s.unit
    if any(abs(factor) != 1.0 for factor in s.transform.factors) and (
        target[:2] != s.position[:2] or 2 in s.transform.loose or s.transform.upright != 1.0
    ):
        # 3.4.13 scales X and Y, and 3.4.9 calls K a distance: the path is known, the speed along it is not.
        pitch = math.nan
        run.fail(codes.SYNCHRONISED_PITCH.at(line.where("K"), code=rule.text))
    # Whether the code stays active for lines of axis words alone the manual does not say: no group of table 3-3.
    s.motion, s.cycle, s.cycle_code = F.UNSUPPORTED, {}, 0
    note_speed_unknown(run, line, rule.text)
    start = list(s.position)
    synchronised_move(run, line, rule, target, pitch)
    if rule.function is F.SYNCHRONISED:
        return
    reverse(run, line)
    synchronised_move(run, line, rule, start, pitch)
    reverse(run, line)


def reverse(run: Run, line: Line) -> None:
    """Turn the spindle the other way."""
    run.modal.spindle_direction = -run.modal.spindle_direction
    run.spindle_row(line)


def synchronised_move(run: Run, line: Line, rule: CodeRule, target: list[Position], pitch: float) -> None:
    """One move with ``pitch`` mm a revolution along the path; Refusal GP510 where an axis cannot follow."""
    s = run.modal
    _check_velocity(run, line, rule, target, pitch)
    s.pitch = pitch
    run.state_changed()
    run.move(Op.FEED, list(target), line.span)
    s.pitch = 0.0
    run.state_changed()


def _check_velocity(run: Run, line: Line, rule: CodeRule, target: list[Position], pitch: float) -> None:
    """3.4.9: an error when the move exceeds the machine's velocity; judged where lengths and speed are known."""
    moved = [b.minus(a) for a, b in zip(run.modal.position, target, strict=True)]
    rpm = true_rpm(run.modal)
    if any(distance.form for distance in moved) or math.isnan(rpm):
        return
    length = math.sqrt(sum(distance.value * distance.value for distance in moved[:3]))
    if length == 0.0:
        return
    for axis in range(AXES):
        there = run.machine.axis(AXIS_NAMES[axis])
        if there is None or there.max_velocity is None:
            continue
        needed = abs(moved[axis].value) / length * pitch * rpm
        allowed = there.max_velocity * 60.0
        if needed > allowed * (1.0 + 1e-9):
            raise Refusal(
                codes.SYNCHRONISED_TOO_FAST.at(
                    line.span, code=rule.text, axis=AXIS_NAMES[axis].upper(), needed=needed, allowed=allowed,
                    pitch=pitch, rpm=rpm, over=needed - allowed,
                )
            )  # fmt: skip
