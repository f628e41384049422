"""WinCNC: drilling cycles as holes of a Job. Manual: G Codes, G73, G80 to G83; WINCNC.INI Settings: g81set=, g81dwell=.

The axes go to X Y at the height that they have, down to R, drill, and back to R. Bottom, R and Q stay for lines with
only X and Y, until G80 or another motion.
"""

from __future__ import annotations

from dataclasses import replace

from gproof.frontend.common.raising import Unraisable
from gproof.frontend.common.raising_modes import UNKNOWN_MODE
from gproof.frontend.wincnc.raising_feeds import feed_of_line, give_feed
from gproof.frontend.wincnc.raising_line import Command, LineRaiser
from gproof.frontend.wincnc.raising_motion import feed_value, need_cell
from gproof.ir.job import AxisPlace, DrillHole, MoveTo, Node, Quantity
from gproof.ir.program import Expr, Number
from gproof.ir.rules import CodeRule
from gproof.ir.rules import Function as F

KINDS = {F.DRILL: "drill", F.DRILL_DWELL: "dwell", F.DRILL_PECK: "peck", F.DRILL_CHIP_BREAK: "chip_break"}
_PECKS = (F.DRILL_PECK, F.DRILL_CHIP_BREAK)
APPROACH = 1.27
"""mm (0.05 inch): how near to the last peck the rapid of G83 goes (else g81set= R), and how far G73 lifts."""
_Z = 4
"""The column of Z as bits."""


def hole(raiser: LineRaiser, line: Command, rule: CodeRule) -> list[Node]:
    """One hole."""
    _judge(raiser, line, rule)
    depth, top, peck, pause = _kept(raiser, line, rule)
    value = feed_value(line)
    if value is not None:
        raiser.modes = give_feed(raiser.now, raiser.feeds, _Z, value)
    raiser.set_own("cycle", rule.tenths)
    raiser.settle_turn(line.mask, line)
    at = raiser.places(line, only=3)
    found: list[Node] = []
    if at and not _is_above(raiser, top):
        # Another controller may lift to R before it goes there.
        found.append(MoveTo(to=at, kind="rapid", span=line.span))
    feed = raiser.say_feed(feed_of_line(raiser.now, raiser.feeds, _Z), line)
    dwell = _dwell(raiser, rule, pause, line)
    kind = "dwell" if dwell is not None and rule.function is F.DRILL else KINDS[rule.function]
    kind = "drill" if kind == "dwell" and dwell is None else kind
    found.append(
        DrillHole(
            kind=kind, at=at, top=AxisPlace("z", raiser.length(top)), bottom=AxisPlace("z", raiser.length(depth)),
            back="top", peck=None if peck is None else raiser.length(peck), clearance=_clearance(raiser, rule, line),
            dwell=dwell, feed=feed, span=line.span,
        )
    )  # fmt: skip
    raiser.set_own("z", (top.value, raiser.now.unit) if isinstance(top, Number) else None)
    return found


def _judge(raiser: LineRaiser, line: Command, rule: CodeRule) -> None:
    """Unraisable for what the manual leaves open about a cycle."""
    if raiser.is_relative(line):
        raise Unraisable(f"{rule.text} with distances", "what Z and R count from the manual does not say")
    if raiser.now.per != "minute":
        raise Unraisable(f"{rule.text} while G93 is on", "what its F counts the manual does not say")
    if raiser.now.sticky == UNKNOWN_MODE:
        raise Unraisable(rule.text, "its numbers depend on the way that the program took")
    if "L" in line.words:
        raise Unraisable(f"L of {rule.text}", "from where it counts the manual does not say")
    if line.mask & ~7:
        raise Unraisable(f"{rule.text} with other axes than X, Y and Z", "what they do the manual does not say")
    if raiser.own_mode("turn", "") not in ("", "rotate"):
        raise Unraisable(f"{rule.text} while G51 is on", "whether pecks are scaled the manual does not say")
    if raiser.controls.drill.lift and rule.function is F.DRILL_PECK:
        raise Unraisable("g81set= L with G83", "where the top of the hole is the manual does not say")
    if line.command is None and not line.mask & 3:
        raise Unraisable(f"a line without X and Y after {rule.text}", "a hole here, a move, or neither")
    need_cell(raiser, line.mask or 3)


def _kept(raiser: LineRaiser, line: Command, rule: CodeRule) -> tuple[Expr, Expr, Expr | None, Expr | None]:
    """Bottom, R, Q and P of a hole: its own, or those of the hole before by the same code."""
    sticky = raiser.now.sticky
    assert not isinstance(sticky, str)
    kept = dict(sticky) if raiser.own_mode("cycle") == rule.tenths else {}
    for letter in "ZRQP":
        value = line.value(letter)
        if value is not None:
            kept[letter] = value
    for letter in "ZR":
        if letter not in kept:
            raise Unraisable(rule.text, f"{letter} is missing")
    peck = kept.get("Q") if rule.function in _PECKS else None
    if rule.function in _PECKS and (peck is None or (isinstance(peck, Number) and peck.value <= 0.0)):
        raise Unraisable(rule.text, "Q is missing, or not above 0")
    raiser.modes = replace(raiser.now, sticky=tuple(sorted(kept.items(), key=lambda pair: pair[0])))
    return kept["Z"], kept["R"], peck, kept.get("P") if rule.function is F.DRILL_DWELL else None


def _is_above(raiser: LineRaiser, top: Expr) -> bool:
    """Whether Z is known to be at R or above it."""
    z = raiser.own_mode("z")
    return isinstance(z, tuple) and isinstance(top, Number) and z[1] == raiser.now.unit and z[0] >= top.value


def _clearance(raiser: LineRaiser, rule: CodeRule, line: Command) -> Quantity | None:
    if rule.function is F.DRILL_CHIP_BREAK:
        return Quantity(Number(APPROACH, line.span), "mm")
    if rule.function is not F.DRILL_PECK:
        return None
    stated = raiser.controls.drill.approach
    return Quantity(Number(APPROACH if stated is None else stated, line.span), "mm")


def _dwell(raiser: LineRaiser, rule: CodeRule, pause: Expr | None, line: Command) -> Quantity | None:
    """P of G82 in milliseconds, else the machine's setting, of two the longer."""
    if rule.function is F.DRILL_DWELL and pause is not None and not (isinstance(pause, Number) and pause.value == 0.0):
        return Quantity(pause, "ms")
    settings = raiser.controls.drill
    seconds = max((value for value in (settings.dwell, settings.other_dwell) if value), default=0.0)
    return Quantity(Number(seconds, line.span), "s") if seconds else None


def end_of_cycle(raiser: LineRaiser, line: Command, rule: CodeRule) -> list[Node]:
    """G80: lines without a command are moves again."""
    raiser.modes = replace(raiser.now, sticky=()).with_own("cycle", 0)
    return []
