"""Canned cycles G73, G74 and G81 to G89 as the moves they make. Eding CNC manual 3.4.21.

What a cycle does at a hole, between the move down to R and the end, is in ``passes/interpret/eding/cycle_motions.py``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from gproof.ir import codes
from gproof.ir.finding import Refusal
from gproof.ir.machine import AXIS_NAMES
from gproof.ir.rules import CodeRule, Function
from gproof.ir.symbolic import Position, Unknown, not_known
from gproof.ir.symbols import RISEN
from gproof.ir.trace import Op
from gproof.ir.trace_rows import form_interval
from gproof.passes.geometry.motor_limits import reach_of
from gproof.passes.interpret.core.moves import AXES_OF_PLANE
from gproof.passes.interpret.core.open_numbers import number_or_open
from gproof.passes.interpret.core.parsed_line import Line
from gproof.passes.interpret.eding.ambiguous_words import owned
from gproof.passes.interpret.eding.axis_targets import aim, need_feed, place_of
from gproof.passes.interpret.eding.cycle_motions import HOLES, Hole, along
from gproof.passes.interpret.eding.spindle import need_turning, note_speed_unknown
from gproof.passes.interpret.eding.transform_codes import check_cycle

if TYPE_CHECKING:
    from gproof.passes.interpret.core.run import Run

_DWELLS = (Function.DRILL_DWELL, Function.BORE_STOP, Function.BORE_DWELL, Function.BORE_MANUAL)
_SPINDLE = (
    Function.BORE_STOP, Function.BORE_MANUAL, Function.BORE_BACK, Function.TAP_RIGHT, Function.TAP_LEFT,
)  # fmt: skip
_TAPS = {Function.TAP_RIGHT: 1, Function.TAP_LEFT: -1}
_LETTERS = ("I", "J", "K")
MAX_MOVES = 100_000
"""Moves of one line; more are not followed, because a line's rows are held until it is done."""


def run_cycle(run: Run, line: Line, rule: CodeRule) -> None:
    """Execute one cycle line; Refusal with GP215 to GP223, GP242 or GP244."""
    s = run.modal
    first, second, drill = AXES_OF_PLANE[s.plane]
    letters = AXIS_NAMES[drill].upper()
    axes = line.axes()
    if not any(axis in axes for axis in (0, 1, 2)):
        raise Refusal(codes.CYCLE_AXIS_MISSING.at(line.span, code=rule.text))
    check_cycle(run, line, rule, drill)
    if s.feed_mode == 93:
        raise Refusal(codes.CYCLE_INVERSE_TIME.at(line.span, code=rule.text))
    owned(line, rule, _letters(rule))
    # R stays from cycle to cycle, the other numbers only within the same one.
    sticky = {k: v for k, v in s.cycle.items() if k == "R" or s.cycle_code == rule.tenths}
    depth_word = _sticky(line, sticky, letters)
    if depth_word is None:
        raise Refusal(codes.CYCLE_DEPTH_MISSING.at(line.span, code=rule.text, letter=letters))
    r_word = _sticky(line, sticky, "R")
    if r_word is None:
        raise Refusal(codes.CYCLE_R_MISSING.at(line.span, code=rule.text))
    words = {"R": r_word, letters: depth_word} | _dwell(run, line, rule, sticky) | _peck(run, line, rule, sticky)
    words |= _back_bore(run, line, rule, sticky)
    repeats = _repeats(line, rule)
    _check_rotary(run, line, rule)
    _need_feed(run, line, rule)
    unit, absolute = s.unit, s.absolute
    along_z = unit * (s.transform.upright if drill == 2 else 1.0)
    if absolute:
        r, depth = s.offset(drill).moved(r_word * along_z), s.offset(drill).moved(depth_word * along_z)
    else:
        r = s.position[drill].moved(r_word * along_z)
        depth = r.moved(depth_word * along_z)
    if r.minus(depth).value < 0:
        raise Refusal(
            codes.CYCLE_R_BELOW_DEPTH.at(line.where("R"), code=rule.text, r=r_word, letter=letters, depth=depth_word)
        )
    peck = words.get("Q", 0.0) * unit
    pecks = (r.value - depth.value) / peck if peck else 1
    if repeats * (3 * pecks + 8) > MAX_MOVES:
        s.motion = Function.UNSUPPORTED
        what = f"a cycle of more than {MAX_MOVES} moves"
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.span, code=what))
    entry = tuple(words.get(_LETTERS[axis], 0.0) * unit for axis in (first, second))
    top = depth
    if rule.function is Function.BORE_BACK:
        top = _top(run, line, rule, words, drill, depth, r)
    s.cycle = words
    s.cycle_code = rule.tenths
    s.motion = rule.function
    # Where it is not known whether the spindle turns, the controller stops here or the cycle is in force from now on:
    # lines of words alone after it are holes too, no mistakes.
    if rule.function in _SPINDLE:
        need_turning(run, line, rule)
    _check_tap(run, line, rule)
    clear = _preliminary(run, line, drill, r)
    hole = Hole(
        rule=rule, first=first, second=second, drill=drill, r=r, depth=depth, clear=clear, dwell=words.get("P", 0.0),
        peck=peck, entry=(entry[0], entry[1]), top=top, pitch=s.feed,
    )  # fmt: skip
    for _ in range(repeats):
        run.spend(line.span)
        run.move(Op.TRAVERSE, aim(run, line, {a: axes[a] for a in (first, second) if a in axes}), line.span)
        along(run, line, drill, r, Op.TRAVERSE)
        HOLES[rule.function](run, line, hole)


def _letters(rule: CodeRule) -> str:
    """The argument words of a cycle."""
    if rule.function is Function.BORE_BACK:
        return "RLIJK"
    if rule.function in _DWELLS:
        return "RLP"
    return "RLQ" if rule.function in (Function.DRILL_PECK, Function.DRILL_CHIP_BREAK) else "RL"


def _sticky(line: Line, sticky: dict[str, float], letter: str) -> float | None:
    given = line.number(letter)
    return sticky.get(letter) if given is None else given


def _dwell(run: Run, line: Line, rule: CodeRule, sticky: dict[str, float]) -> dict[str, float]:
    """P; NaN where it is not known: the path is the same."""
    if rule.function not in _DWELLS:
        return {}
    given = number_or_open(run, line, "P", rule.text)
    seconds = sticky.get("P") if given is None else given
    if seconds is None:
        raise Refusal(codes.CYCLE_DWELL_MISSING.at(line.span, code=rule.text))
    if seconds < 0:
        raise Refusal(codes.CYCLE_DWELL_NEGATIVE.at(line.where("P"), code=rule.text, value=seconds))
    return {"P": seconds}


def _peck(run: Run, line: Line, rule: CodeRule, sticky: dict[str, float]) -> dict[str, float]:
    """Q; NaN where it is not known: how often the tool turns round on the way between depth and clear position."""
    if rule.function not in (Function.DRILL_PECK, Function.DRILL_CHIP_BREAK):
        return {}
    now = number_or_open(run, line, "Q", rule.text, positive=True)
    peck = sticky.get("Q") if now is None else now
    if peck is None or peck <= 0:
        given = "" if peck is None else f"; Q{peck:g} is given"
        raise Refusal(codes.CYCLE_PECK.at(line.where("Q"), code=rule.text, given=given))
    return {"Q": peck}


def _back_bore(run: Run, line: Line, rule: CodeRule, sticky: dict[str, float]) -> dict[str, float]:
    """I, J and K of G87 (3.4.21.10): by the axis they belong to, whatever the plane."""
    if rule.function is not Function.BORE_BACK:
        return {}
    found = {letter: _sticky(line, sticky, letter) for letter in _LETTERS}
    missing = [letter for letter, value in found.items() if value is None]
    if missing:
        raise Refusal(codes.WORD_MISSING.at(line.span, code=rule.text, needed=" and ".join(missing)))
    # Where the tool enters next to the hole: of a distance of 0 every reading is the same.
    if run.modal.transform.on and (found["I"] or found["J"]):
        raise Refusal(codes.TRANSFORM_OPEN.at(line.span, what=f"whether I and J of {rule.text} turn with G68 or G51"))
    if run.machine.controller.diameter_programming and found["I"]:
        what = f"I of {rule.text} with diameter programming (along X: a diameter or a radius)"
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.where("I"), code=what))
    return {letter: value for letter, value in found.items() if value is not None}


def _top(
    run: Run, line: Line, rule: CodeRule, words: dict[str, float], drill: int, depth: Position, r: Position
) -> Position:
    """Where the counter bore of G87 ends: absolute, or in incremental mode from the depth (3.4.21.10)."""
    letter, s = _LETTERS[drill], run.modal
    length = words[letter] * s.unit
    top = s.offset(drill).moved(length) if s.absolute else depth.moved(length)
    if not depth.value <= top.value <= r.value:
        raise Refusal(
            codes.BACK_BORE_TOP.at(
                line.where(letter), code=rule.text, letter=letter, top=top.value, depth=depth.value, r=r.value
            )
        )
    return top


def _check_tap(run: Run, line: Line, rule: CodeRule) -> None:
    """A right-hand tap goes in clockwise, a left-hand one counter-clockwise (3.4.21.6, 3.4.21.7)."""
    needed = _TAPS.get(rule.function)
    if needed is not None and run.modal.spindle_direction != needed:
        names = {1: "clockwise (M3)", -1: "counter-clockwise (M4)"}
        turns = names[run.modal.spindle_direction]
        raise Refusal(codes.TAP_DIRECTION.at(line.where_code(rule), code=rule.text, needed=names[needed], turns=turns))


def _need_feed(run: Run, line: Line, rule: CodeRule) -> None:
    """F as in any cutting move; for a tap it is per revolution, whatever the feed mode (3.4.21.6)."""
    if rule.function not in _TAPS:
        need_feed(run, line, rule)
        return
    if run.modal.feed == 0.0:
        raise Refusal(codes.FEED_MISSING.at(line.span, code=rule.text))
    note_speed_unknown(run, line, rule.text)


def _repeats(line: Line, rule: CodeRule) -> int:
    value = line.number("L")
    if value is None:
        return 1
    if value < 1 or value != round(value):
        raise Refusal(codes.CYCLE_REPEATS.at(line.where("L"), code=rule.text, value=value))
    return round(value)


def _check_rotary(run: Run, line: Line, rule: CodeRule) -> None:
    for axis, value in line.axes().items():
        if axis < 3:
            continue
        if isinstance(value, Unknown):
            raise Refusal(not_known(line.span, AXIS_NAMES[axis].upper(), value))
        if axis in run.modal.transform.loose and value != 0.0:
            what = f"whether G51 P scales {AXIS_NAMES[axis].upper()}, which must not move with {rule.text},"
            raise Refusal(codes.TRANSFORM_OPEN.at(line.span, what=what))
        moved = place_of(run, axis, value).minus(run.modal.position[axis])
        if moved.form or abs(moved.value) > 1e-9:
            raise Refusal(codes.CYCLE_ROTARY_MOTION.at(line.span, code=rule.text, axis=AXIS_NAMES[axis].upper()))


def _preliminary(run: Run, line: Line, drill: int, r: Position) -> Position:
    """Up to R when below it, once; returns the clear position (3.4.21, 3.4.21.1, 3.4.26)."""
    s = run.modal
    above = s.position[drill].minus(r)
    if above.form:
        _rise(run, line, drill, r)
    elif above.value < 0:
        along(run, line, drill, r, Op.TRAVERSE)
        return r
    return s.position[drill] if s.retract_initial else r


def _rise(run: Run, line: Line, drill: int, r: Position) -> None:
    """Up to R where it is not known whether R is above: to somewhere between here and the upper limit. Refusal GP304.

    R is a place of the path, and the check of the limits asks that it is within them: nothing rises from a place at the
    upper limit, and what rises from one below it stays between the two. The same place and R mean the same height.
    """
    s = run.modal
    at = s.position[drill]
    height = run.risen.get((at, r))
    if height is None:
        ends = _heights(run, drill, at)
        if ends is None:
            raise Refusal(
                codes.POSITION_UNKNOWN.at(
                    line.span, axis=AXIS_NAMES[drill].upper(), cause="the tool position before the cycle",
                    hint=f"move {AXIS_NAMES[drill].upper()} to a programmed height first",
                )
            )  # fmt: skip
        height = at if ends[0] >= ends[1] else run.unknown_place(RISEN, drill, ends, Position(0.0))
        run.risen[at, r] = run.risen[height, r] = height
        run.assumed["R of canned cycles is within the limits of its axis"] = None
    along(run, line, drill, height, Op.TRAVERSE)


def _heights(run: Run, drill: int, at: Position) -> tuple[float, float] | None:
    """Between what a place within the limits is that is not below ``at``; None where something of it is not known."""
    limits = reach_of(run.machine, AXIS_NAMES[drill])
    top = None if limits is None else limits.stated[False][1]
    here = form_interval(at.form, run.setup, run.trace)
    lifted = run.setup.height_map is not None or (drill == 1 and run.setup.cylinder is not None)
    if top is None or here is None or lifted or "machine_area" in run.modal.guards_off:
        return None
    return at.value + here.low, top
