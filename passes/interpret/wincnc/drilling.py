"""Drilling cycles of controllers of one command a line: G73, G81, G82, G83, until G80 or another motion.

WinCNC Users Guide, G Codes: G73 to G83; WINCNC.INI Settings: g81set=, g81dwell=. The axes go to X Y at the height they
have, down to R, drill, and back to R.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from gproof.ir import codes
from gproof.ir.dialects.wincnc.settings import wincnc_settings
from gproof.ir.finding import Refusal
from gproof.ir.rules import CodeRule
from gproof.ir.rules import Function as F
from gproof.ir.symbolic import NOWHERE, Position
from gproof.ir.trace import Op
from gproof.passes.interpret.core.open_numbers import low_of, number_or_open
from gproof.passes.interpret.wincnc.axis_targets import aim, is_absolute, mapped, place_of
from gproof.passes.interpret.wincnc.moves import feed_word, note_assumptions
from gproof.passes.interpret.wincnc.state import UNSCALED

if TYPE_CHECKING:
    from gproof.passes.interpret.wincnc.command import Command
    from gproof.passes.interpret.wincnc.state import WinCncRun

CYCLES = (F.DRILL, F.DRILL_DWELL, F.DRILL_PECK, F.DRILL_CHIP_BREAK)
_PECKS = (F.DRILL_PECK, F.DRILL_CHIP_BREAK)
_USES = {"Q": _PECKS, "P": (F.DRILL_DWELL,), "L": (F.DRILL_PECK,)}
"""Words that only some cycles have."""
APPROACH = 1.27
"""mm (0.05 inch): how near to the depth before the rapid of G83 goes, and how far G73 lifts."""
DRILL = 2
MAX_PECKS = 100_000


def drill(run: WinCncRun, line: Command, rule: CodeRule) -> None:
    """One hole; Refusal GP113, GP216, GP217, GP218, GP222 or GP223."""
    note_assumptions(run, line.span)
    s = run.modal
    if not is_absolute(run):
        raise Refusal(
            codes.UNSUPPORTED_CODE.at(line.span, code=f"{rule.text} with distances (G91): what Z and R count from")
        )
    if "autoaux" in s.own.flags:
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.span, code=f"the automatic output (L34) during {rule.text}"))
    if s.feed_mode == 93:
        raise Refusal(codes.CYCLE_INVERSE_TIME.at(line.span, code=rule.text))
    sticky = s.cycle if s.cycle_code == rule.tenths else {}
    words = {letter: line.number(letter) for letter in "ZRL"}
    # What a Q of 0 or less does the manual does not say: one that may be none above 0 is not followed.
    words["Q"] = None if low_of(line, "Q") > 0.0 else line.number("Q")
    if words["Q"] is None:
        words["Q"] = number_or_open(run, line, "Q", rule.text, positive=True)
    words["P"] = number_or_open(run, line, "P", rule.text)
    found = {letter: sticky.get(letter) if value is None else value for letter, value in words.items()}
    if any(axis > 2 for axis in mapped(run, line)):
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.span, code=f"{rule.text} with other axes than X, Y and Z"))
    depth_word, r_word, peck_word = found["Z"], found["R"], found["Q"]
    if depth_word is None:
        raise Refusal(codes.CYCLE_DEPTH_MISSING.at(line.span, code=rule.text, letter="Z"))
    if r_word is None:
        raise Refusal(codes.CYCLE_R_MISSING.at(line.span, code=rule.text))
    if rule.function in _PECKS and (peck_word is None or peck_word <= 0):
        given = "" if peck_word is None else f"; Q{peck_word:g} is given"
        raise Refusal(codes.CYCLE_PECK.at(line.where("Q"), code=rule.text, given=given))
    if (found["P"] or 0.0) < 0:
        raise Refusal(codes.CYCLE_DWELL_NEGATIVE.at(line.where("P"), code=rule.text, value=found["P"]))
    for letter in "QPL":
        if letter in line.values and rule.function not in _USES[letter]:
            where = line.where(letter)
            run.findings.add(codes.CYCLE_WORD_IGNORED.at(where, word=f"{letter}{words[letter]:g}", code=rule.text))
    _tell_settings(run, line, rule, found["P"])
    if any(axis != source and DRILL in (axis, source) for axis, source in enumerate(s.own.sources)):
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.span, code=f"{rule.text} while L11 or L12 maps Z"))
    factor = dict(s.own.scales).get(DRILL, UNSCALED)[0]
    r, depth = place_of(run, DRILL, r_word), place_of(run, DRILL, depth_word)
    if NOWHERE in (r, depth) or factor < 0.0:
        raise Refusal(codes.TRANSFORM_OPEN.at(line.span, what=f"where {rule.text} ends under G51"))
    if r.value <= depth.value:
        raise Refusal(
            codes.CYCLE_R_BELOW_DEPTH.at(line.where("R"), code=rule.text, r=r_word, letter="Z", depth=depth_word)
        )
    _doubt_kept(line, rule, s.own.cycle_at if sticky else None, depth, r)
    peck = (peck_word or 0.0) * s.scale(DRILL)
    if rule.function in _PECKS and (r.value - depth.value) / peck > MAX_PECKS:
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.span, code=f"a cycle of more than {MAX_PECKS} pecks"))
    feed_word(run, line, {DRILL})
    s.cycle_code = rule.tenths
    s.cycle = {letter: value for letter, value in found.items() if value is not None}
    s.own = s.own.but(cycle_at=(depth, r))
    target = list(s.position)
    aimed = aim(run, line)
    target[0], target[1] = aimed[0], aimed[1]
    run.move(Op.TRAVERSE, target, line.span)
    run.moved = True
    _go(run, line, Op.TRAVERSE, r)
    if rule.function is F.DRILL_PECK:
        _pecks(run, line, r, depth, peck, found["L"], open_=factor != 1.0 or math.isnan(peck))
    elif rule.function is F.DRILL_CHIP_BREAK:
        _chips(run, line, r, depth, peck, open_=factor != 1.0 or math.isnan(peck))
    else:
        _go(run, line, Op.FEED, depth)
    _dwell(run, line, rule, found["P"])
    _go(run, line, Op.TRAVERSE, r)


def _doubt_kept(
    line: Command, rule: CodeRule, before: tuple[Position, Position] | None, depth: Position, r: Position
) -> None:  # fmt: skip
    """Refusal GP113 for a Z or R of the hole before that would now be another place: number or place is not said."""
    for letter, now, old in zip("ZR", (depth, r), before or (depth, r), strict=True):
        if letter not in line.values and now != old:
            what = f"{letter} of the hole before, under another zero or scale"
            raise Refusal(codes.UNSUPPORTED_CODE.at(line.span, code=f"{rule.text} with {what}"))


def _tell_settings(run: WinCncRun, line: Command, rule: CodeRule, pause: float | None) -> None:
    """GP512, once a job, where two keys of the machine's file speak of one thing, or one of what the code says too."""
    s = run.modal
    settings = wincnc_settings(run.machine).drill
    told = []
    both = settings.dwell, settings.other_dwell
    if None not in both and both[0] != both[1] and not (rule.function is F.DRILL_DWELL and pause):
        told.append(f"g81set= D{both[0]:g} and g81dwell={both[1]:g}: the longer dwell is used")
    if rule.function is F.DRILL_PECK and settings.lift:
        told.append("g81set= L lifts above the top of the hole, G83 lifts to R: the lift above R is used")
    for what in told:
        name = f"noted {what[:12]}"
        if name not in s.own.flags:
            s.own = s.own.but(flags=s.own.flags | {name})
            run.findings.add(codes.DRILL_SETTING_OPEN.at(line.span, code=rule.text, what=what))


def _go(run: WinCncRun, line: Command, op: Op, place: Position) -> None:
    s = run.modal
    target = list(s.position)
    target[DRILL] = place
    if op is Op.FEED:
        s.feed, s.feed_unit = s.own.feeds[DRILL], 1.0
    if target != s.position:
        run.move(op, target, line.span)


def _pecks(
    run: WinCncRun, line: Command, r: Position, depth: Position, peck: float, lift_word: float | None, *, open_: bool
) -> None:  # fmt: skip
    """G83: back to R after each peck but the last, then rapid to just above where it was.

    With g81set=L the return ends so far above R: the top of the hole, from which it counts, is nowhere above R.
    open_: Q is not known, or whether G51 makes other pecks of it is not said: they end anywhere on the way.
    """
    settings = wincnc_settings(run.machine).drill
    approach = APPROACH if settings.approach is None else settings.approach
    if lift_word:
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.span, code="L together with R (G83)"))
    top = r
    if settings.lift is not None and settings.lift > 0.0:
        top = Position(r.value + settings.lift, r.form)
        run.assumed["a drill lifts no higher than g81set=L above R between pecks (G83)"] = None
    if open_:
        for op, place in (
            (Op.FEED, _between(run, r, depth)),
            (Op.TRAVERSE, top),
            (Op.TRAVERSE, _between(run, r, depth)),
        ):
            _go(run, line, op, place)
        _go(run, line, Op.FEED, depth)
        return
    at = r.value
    while at - peck > depth.value + 1e-9:
        at -= peck
        _go(run, line, Op.FEED, Position(at, r.form))
        _go(run, line, Op.TRAVERSE, top)
        _go(run, line, Op.TRAVERSE, Position(min(at + approach, r.value), r.form))
    _go(run, line, Op.FEED, depth)


def _between(run: WinCncRun, r: Position, depth: Position) -> Position:
    """Somewhere in the hole."""
    return run.unknown_place("value", DRILL, (depth.value - r.value, 0.0), r)


def _chips(
    run: WinCncRun, line: Command, r: Position, depth: Position, peck: float, *, open_: bool
) -> None:  # fmt: skip
    """G73: a little lift after each peck but the last. open_: see ``_pecks``."""
    if open_:
        top = run.unknown_place("value", DRILL, (depth.value - r.value, APPROACH), r)
        for op, place in ((Op.FEED, _between(run, r, depth)), (Op.TRAVERSE, top)):
            _go(run, line, op, place)
        _go(run, line, Op.FEED, depth)
        return
    at = r.value
    while at - peck > depth.value + 1e-9:
        at -= peck
        _go(run, line, Op.FEED, Position(at, r.form))
        _go(run, line, Op.TRAVERSE, Position(at + APPROACH, r.form))
    _go(run, line, Op.FEED, depth)


def _dwell(run: WinCncRun, line: Command, rule: CodeRule, word: float | None) -> None:
    """At the bottom: P of G82 in milliseconds, else the machine's setting, of two the longer."""
    settings = wincnc_settings(run.machine).drill
    stated = [value for value in (settings.dwell, settings.other_dwell) if value]
    seconds = word / 1000.0 if rule.function is F.DRILL_DWELL and word else max(stated, default=0.0)
    if seconds:
        run.event(Op.DWELL, line.span, arg=(seconds, 0.0))


def cancel(run: WinCncRun, line: Command, rule: CodeRule) -> None:
    """G80: lines without a command are no holes any more, but moves as they were before."""
    s = run.modal
    s.cycle, s.cycle_code = {}, 0
