"""Canned cycles G73, G81 to G83, G85, G86 and G89 as the moves they make. Eding CNC manual 3.4.21."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING

from gproof.ir import codes
from gproof.ir.finding import Refusal
from gproof.ir.machine import AXIS_NAMES
from gproof.ir.rules import CodeRule, Function
from gproof.ir.trace import Op, Plane
from gproof.passes.line import Line
from gproof.passes.transform_codes import check_cycle
from gproof.passes.values import Position, Unknown

if TYPE_CHECKING:
    from gproof.passes.motion import Motion

AXES_OF_PLANE = {Plane.XY: (0, 1, 2), Plane.XZ: (0, 2, 1), Plane.YZ: (1, 2, 0)}
"""The two axes of a plane and the one a cycle drills along."""

CYCLES = (
    Function.DRILL, Function.DRILL_DWELL, Function.DRILL_PECK, Function.DRILL_CHIP_BREAK, Function.BORE,
    Function.BORE_STOP, Function.BORE_DWELL,
)  # fmt: skip
"""Functions that ``run_cycle`` executes."""

_DWELLS = (Function.DRILL_DWELL, Function.BORE_STOP, Function.BORE_DWELL)
_FED_OUT = (Function.BORE, Function.BORE_DWELL)
MAX_MOVES = 100_000
"""Moves of one line; more are not followed, because a line's rows are held until it is done."""


def run_cycle(ex: Motion, line: Line, rule: CodeRule) -> None:
    """Execute one cycle line; Refusal with GP215 to GP223, GP242 or GP244."""
    s = ex.modal
    first, second, drill = AXES_OF_PLANE[s.plane]
    letters = AXIS_NAMES[drill].upper()
    axes = line.axes()
    if not any(axis in axes for axis in (0, 1, 2)):
        raise Refusal(codes.CYCLE_AXIS_MISSING.at(line.span, code=rule.text))
    check_cycle(ex, line, rule, drill)
    if s.feed_mode == 93:
        raise Refusal(codes.CYCLE_INVERSE_TIME.at(line.span, code=rule.text))
    # R stays from cycle to cycle, the other numbers only within the same one.
    sticky = {k: v for k, v in s.cycle.items() if k == "R" or s.cycle_code == rule.tenths}
    depth_word = _sticky(line, sticky, letters)
    if depth_word is None:
        raise Refusal(codes.CYCLE_DEPTH_MISSING.at(line.span, code=rule.text, letter=letters))
    r_word = _sticky(line, sticky, "R")
    if r_word is None:
        raise Refusal(codes.CYCLE_R_MISSING.at(line.span, code=rule.text))
    dwell = _dwell(line, rule, sticky)
    peck = _peck(line, rule, sticky)
    repeats = _repeats(line, rule)
    _check_rotary(ex, line, rule)
    if rule.function is Function.BORE_STOP and s.spindle_direction == 0:
        raise Refusal(codes.CYCLE_SPINDLE_STOPPED.at(line.span, code=rule.text))
    ex.need_feed(line, rule)
    unit, absolute = s.unit, s.absolute
    if absolute:
        r, depth = s.offset(drill).moved(r_word * unit), s.offset(drill).moved(depth_word * unit)
    else:
        r = s.position[drill].moved(r_word * unit)
        depth = r.moved(depth_word * unit)
    if r.minus(depth).value < 0:
        raise Refusal(
            codes.CYCLE_R_BELOW_DEPTH.at(line.where("R"), code=rule.text, r=r_word, letter=letters, depth=depth_word)
        )
    pecks = 1 if peck is None else (r.value - depth.value) / (peck * unit)
    if repeats * (3 * pecks + 4) > MAX_MOVES:
        s.motion = Function.UNSUPPORTED
        what = f"a cycle of more than {MAX_MOVES} moves"
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.span, code=what))
    s.cycle = {"R": r_word, letters: depth_word} | ({"P": dwell} if dwell is not None else {})
    if peck is not None:
        s.cycle["Q"] = peck
    s.cycle_code = rule.tenths
    s.motion = rule.function
    clear = _preliminary(ex, line, drill, r)
    for _ in range(repeats):
        ex.spend(line.span)
        ex.move(Op.TRAVERSE, ex.aim(line, {a: axes[a] for a in (first, second) if a in axes}), line.span)
        _along(ex, line, drill, r, Op.TRAVERSE)
        if peck is not None:
            back = clear if rule.function is Function.DRILL_PECK else None
            _pecks(ex, line, drill, r, depth, peck * unit, back)
        else:
            _along(ex, line, drill, depth, Op.FEED)
        if dwell is not None:
            ex.event(Op.DWELL, line.span, arg=(dwell, 0.0))
        direction = s.spindle_direction
        if rule.function is Function.BORE_STOP:
            s.spindle_direction = 0
            ex.spindle_row(line)
        _along(ex, line, drill, clear, Op.FEED if rule.function in _FED_OUT else Op.TRAVERSE)
        if rule.function is Function.BORE_STOP:
            s.spindle_direction = direction
            ex.spindle_row(line)


def _sticky(line: Line, sticky: dict[str, float], letter: str) -> float | None:
    given = line.number(letter)
    return sticky.get(letter) if given is None else given


def _dwell(line: Line, rule: CodeRule, sticky: dict[str, float]) -> float | None:
    if rule.function not in _DWELLS:
        return None
    seconds = _sticky(line, sticky, "P")
    if seconds is None:
        raise Refusal(codes.CYCLE_DWELL_MISSING.at(line.span, code=rule.text))
    if seconds < 0:
        raise Refusal(codes.CYCLE_DWELL_NEGATIVE.at(line.where("P"), code=rule.text, value=seconds))
    return seconds


def _peck(line: Line, rule: CodeRule, sticky: dict[str, float]) -> float | None:
    if rule.function not in (Function.DRILL_PECK, Function.DRILL_CHIP_BREAK):
        return None
    peck = _sticky(line, sticky, "Q")
    if peck is None or peck <= 0:
        given = "" if peck is None else f"; Q{peck:g} is given"
        raise Refusal(codes.CYCLE_PECK.at(line.where("Q"), code=rule.text, given=given))
    return peck


def _repeats(line: Line, rule: CodeRule) -> int:
    value = line.number("L")
    if value is None:
        return 1
    if value < 1 or value != round(value):
        raise Refusal(codes.CYCLE_REPEATS.at(line.where("L"), code=rule.text, value=value))
    return round(value)


def _check_rotary(ex: Motion, line: Line, rule: CodeRule) -> None:
    for axis, value in line.axes().items():
        if axis < 3:
            continue
        if isinstance(value, Unknown):
            raise Refusal(codes.UNKNOWN_VALUE.at(line.span, word=AXIS_NAMES[axis].upper(), cause=value.cause))
        moved = ex.target(axis, value).minus(ex.modal.position[axis])
        if moved.form or abs(moved.value) > 1e-9:
            raise Refusal(codes.CYCLE_ROTARY_MOTION.at(line.span, code=rule.text, axis=AXIS_NAMES[axis].upper()))


def _preliminary(ex: Motion, line: Line, drill: int, r: Position) -> Position:
    """Up to R when below it, once; returns the clear position (3.4.21, 3.4.21.1, 3.4.26)."""
    s = ex.modal
    above = s.position[drill].minus(r)
    if above.form:
        raise Refusal(
            codes.POSITION_UNKNOWN.at(
                line.span, axis=AXIS_NAMES[drill].upper(), cause="where the tool is before the cycle",
                hint=f"move {AXIS_NAMES[drill].upper()} to a programmed height first",
            )
        )  # fmt: skip
    if above.value < 0:
        _along(ex, line, drill, r, Op.TRAVERSE)
        return r
    return s.position[drill] if s.retract_initial else r


def _along(ex: Motion, line: Line, drill: int, to: Position, op: Op) -> None:
    """One move of the drilling axis alone; none when it is there already."""
    if ex.modal.position[drill] == to:
        return
    target = list(ex.modal.position)
    target[drill] = to
    ex.move(op, target, line.span)


def _pecks(
    ex: Motion, line: Line, drill: int, r: Position, depth: Position, peck: float, clear: Position | None
) -> None:
    """Feed a peck, out, back down to just above the bottom, until the depth.

    Out is the clear position (G83), or the length of a peck but not beyond R (G73, clear None).
    """
    back_off = min(ex.modal.rules.peck_clearance_mm, peck)
    for k in itertools.count(1):
        bottom = Position(max(r.value - k * peck, depth.value), depth.form)
        _along(ex, line, drill, bottom, Op.FEED)
        if bottom.value <= depth.value:
            return
        out = Position(min(bottom.value + peck, r.value), bottom.form) if clear is None else clear
        _along(ex, line, drill, out, Op.TRAVERSE)
        _along(ex, line, drill, Position(min(bottom.value + back_off, r.value), bottom.form), Op.TRAVERSE)
