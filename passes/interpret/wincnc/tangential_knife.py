"""A knife that turns with the path on controllers of one command a line: rows before and after each cut.

WinCNC Users Guide, L Codes: L30, L30.1, L31; WINCNC.INI Settings: knifemode=, knifeangle=. What the manual defines: an
axis turns the knife; where the direction changes by more than the lift angle, the head goes up to the lift position,
turns, and goes down to the lower position. What it leaves open becomes a place between the readings, so that limits and
boundaries see both (docs/dialects/wincnc.md, Knife and saw); where there is no bound, GP323. Directions count as in
``passes/motion/knife_axis.py``: at 0 along +X, counter-clockwise seen from above, the shorter way, not in G0.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from gproof.ir import codes
from gproof.ir.dialects.wincnc.settings import wincnc_settings
from gproof.ir.finding import Span
from gproof.ir.machine import AXES, AXIS_NAMES
from gproof.ir.settings import KnifeMode
from gproof.ir.symbolic import NOWHERE, Position
from gproof.ir.trace import KNIFE, Affine, Op
from gproof.passes.interpret.wincnc.coupling import go
from gproof.passes.interpret.wincnc.state import KnifeNow, machine_zero

if TYPE_CHECKING:
    from gproof.passes.interpret.wincnc.state import WinCncRun

SAME = 1e-6
"""Degrees: a turn that is none."""
_STILL = 1e-9
"""mm: a move of X and Y that has no direction."""
_ROUNDING = 1e-12
"""mm, degrees: what arithmetic adds to a place that is another one's."""


def settings(mode: KnifeMode) -> KnifeNow:
    """Those of the machine's file."""
    return KnifeNow(mode.angle, mode.lifted, mode.lowered)


class Turning:
    """One move while the knife follows the path: what comes before it, and where it then ends."""

    def __init__(self, run: WinCncRun, mode: KnifeMode, span: Span) -> None:
        self.run, self.mode, self.span = run, mode, span
        self.now = run.modal.own.knife or settings(mode)
        self.axis = AXIS_NAMES.index(mode.axis)
        self.up = AXIS_NAMES.index(mode.vertical) if mode.vertical else -1

    # -- places

    def _tell(self, axis: int, what: str, hint: str = "") -> Position:
        """GP323, unless the axis is lost already; the axis may then be anywhere."""
        if self.run.modal.position[axis] != NOWHERE:
            self.run.refuse(codes.KNIFE_UNKNOWN.at(self.span, what=what, hint=hint))
        return NOWHERE

    def _reach(self, place: Position) -> tuple[float, float, Affine]:
        """The values that a place may have, and the unknowns it rests on that nobody bounds."""
        low = high = place.value
        rest = []
        for symbol, times in place.form:
            known = self.run.trace.symbols.get(symbol)
            if known is None:
                rest.append((symbol, times))
                continue
            ends = known.low * times, known.high * times
            low, high = low + min(ends), high + max(ends)
        return low, high, tuple(rest)

    def between(self, axis: int, *places: Position) -> Position:
        """A place somewhere between others; the same one for the same ends."""
        if any(place == NOWHERE for place in places):
            return NOWHERE
        if all(place == places[0] for place in places):
            return places[0]
        found = [self._reach(place) for place in places]
        rest = found[0][2]
        if any(other != rest for _, _, other in found):
            return NOWHERE
        low, high = min(one[0] for one in found), max(one[1] for one in found)
        if high - low < _STILL:
            return Position(low, rest)
        for place in (*places, self.run.modal.position[axis]):
            least, most, other = self._reach(place)
            if other == rest and abs(least - low) < _ROUNDING and abs(most - high) < _ROUNDING:
                return place
        s = self.run.modal
        key = axis, low, high
        unknown = next((known for name, known in s.own.spans if name == key), None)
        if unknown is None:
            unknown = self.run.unknown_place("value", axis, (low, high), Position(0.0))
            s.own = s.own.but(spans=(*s.own.spans[-_KEPT:], (key, unknown)))
        return Position(0.0, rest).plus(unknown)

    def _place(self, value: float | None, what: str) -> Position:
        """Where a lift or a plunge ends: of the machine or as words count, which the manual does not say."""
        if value is None:
            return self._tell(self.up, f"{what} is not in the manual (knifemode=, L30.1)")
        s = self.run.modal
        said = wincnc_settings(self.run.machine).knife_positions
        machine, work = machine_zero(s.own, self.up).moved(value), s.offset(self.up).moved(value)
        if said is not None:
            return work if said == "work" else machine
        without_local = s.work_offsets[s.work, self.up].plus(s.beside_work(self.up)).moved(value)
        found = self.between(self.up, machine, work, without_local)
        if found == NOWHERE:
            what = f"{what} counts from machine zero or from an unknown zero"
            return self._tell(self.up, what, "state [controls] knife_positions in the machine file")
        return found

    def _top(self) -> Position:
        return self._place(self.now.lifted, "the lift height")

    def _bottom(self) -> Position:
        return self._place(self.now.lowered, "the cutting depth")

    def _raised(self, sure: bool) -> Position:
        """Up from here: to the lift position, or, not surely, somewhere on the way; what is above it may stay."""
        here, top = self.run.modal.position[self.up], self._top()
        if NOWHERE in (here, top):
            return NOWHERE
        (_, high, rest), (low, _, other) = self._reach(here), self._reach(top)
        if sure and rest == other and high <= low + _STILL:
            return top
        return self.between(self.up, here, top)

    # -- rows

    def _go(self, op: Op, axis: int, place: Position) -> None:
        """One axis to a place; at the feed of its group where that counts."""
        run, s = self.run, self.run.modal
        if place == s.position[axis]:
            return
        target = list(s.position)
        target[axis] = place
        before = s.feed, s.feed_unit, s.feed_mode
        s.feed, s.feed_unit, s.feed_mode = s.own.feeds[axis], 1.0, 94
        if s.feed_mode != before[2]:
            run.state_changed()
        go(run, op, target, self.span)
        s.feed, s.feed_unit, s.feed_mode = before
        if s.feed_mode != 94:
            run.state_changed()

    def lift_by_itself(self) -> None:
        """M1: it may go up here, when exactly is not said."""
        if self.mode.automatic and self.up >= 0:
            self._go(Op.TRAVERSE, self.up, self._raised(sure=False))

    def traverse(self, target: list[Position]) -> list[Position]:
        """Before a rapid move, of whatever length; where that ends."""
        s = self.run.modal
        if self.mode.target and self._has_direction(target):
            # "During the XY move": of which kind is not said.
            target[self.axis] = self._on_the_way(target)
        if not self.mode.automatic or self.up < 0:
            return target
        here = s.position[self.up]
        self.lift_by_itself()
        named = target[self.up] != here
        target[self.up] = self.between(self.up, target[self.up], self._top()) if named else s.position[self.up]
        return target

    def _on_the_way(self, target: list[Position]) -> Position:
        """T1 in a rapid move: where it was, or pointing along it, or between."""
        s = self.run.modal
        problem = self._problem(target)
        if problem:
            return self._tell(self.axis, problem)
        here = s.position
        direction = math.degrees(math.atan2(target[1].value - here[1].value, target[0].value - here[0].value))
        low, high, _ = self._reach(here[self.axis])
        ends = low, high, _nearest(low, direction, up=False), _nearest(high, direction, up=True)
        return self.between(self.axis, Position(min(ends)), Position(max(ends)))

    def _has_direction(self, target: list[Position]) -> bool:
        here = self.run.modal.position
        ways = [target[n].minus(here[n]) for n in (0, 1)]
        return any(way.form for way in ways) or math.hypot(ways[0].value, ways[1].value) > _STILL

    def cut(
        self, op: Op, target: list[Position], center: list[float] | None, turns: int
    ) -> tuple[list[Position], Position | None]:  # fmt: skip
        """Before a cut; where it ends, and where the vertical axis goes after it, None: nowhere."""
        s = self.run.modal
        arc = op is Op.ARC and center is not None
        if not arc and not self._has_direction(target):
            if self.mode.automatic and self.up >= 0:
                target[self.up] = self.between(self.up, target[self.up], self._bottom())
            return target, None
        problem = self._problem(target)
        if problem:
            target[self.axis] = self._tell(self.axis, problem)
            self._lose_height(target)
            return target, None
        start = s.position[0].value, s.position[1].value
        end = target[0].value, target[1].value
        along = 0.0
        if arc:
            assert center is not None
            direction, along = _arc_direction(start, end, (center[0], center[1]), turns)
        else:
            direction = math.degrees(math.atan2(end[1] - start[1], end[0] - start[0]))
        low, high, _ = self._reach(s.position[self.axis])
        first, last = _nearest(low, direction, up=False), _nearest(high, direction, up=True)
        if low == high:
            first = last
        lifts = self._lifts(low, high, first, last, arc=arc)
        here = s.position[self.up] if self.up >= 0 else NOWHERE
        self._turn(lifts, first, last, low, high)
        back = None
        if self.up >= 0:
            back = self._height(target, here, lifts, within_arc=arc and self.mode.lifts_in_arcs)
        if self.mode.target:
            # It follows an arc, or turns to where that ends, the shorter way again.
            least, most = min(low, first), max(high, last)
            straight = _nearest(least, direction + along, up=False), _nearest(most, direction + along, up=True)
            ends = (least, most, first + along, last + along, *straight)
            target[self.axis] = self.between(self.axis, Position(min(ends)), Position(max(ends)))
        else:
            target[self.axis] = s.position[self.axis] if not along else s.position[self.axis].moved(along)
        return target, back

    def _problem(self, target: list[Position]) -> str:
        """Why the knife cannot be followed along this move, "" where it can."""
        s = self.run.modal
        word = self.run.machine.word(self.axis)
        if s.compensation is not None or "compensation" in s.own.flags:
            return "with cutter radius compensation"
        if s.own.sources != tuple(range(AXES)):
            return "while L11 or L12 maps axes"
        if any(axis == self.up for axis, _ in s.own.scales):
            return "while G51 scales the axis that lifts it"
        if self.axis in s.own.locked or self.up in s.own.locked:
            return "while L300 locks an axis of it"
        if any(axis in (self.axis, self.up) for axis, _ in s.own.slaves):
            return "while L13 couples an axis of it"
        if any(target[n].minus(s.position[n]).form for n in (0, 1)):
            return "the direction of a move is unknown"
        if self._reach(s.position[self.axis])[2]:
            return f"the position of {word} when it starts to follow is unknown"
        return ""

    def _lose_height(self, target: list[Position]) -> None:
        if self.up < 0:
            return
        here = self.run.modal.position[self.up]
        lost = self.between(self.up, here, self._top(), self._bottom())
        self._go(Op.TRAVERSE, self.up, lost)
        if target[self.up] == here:
            target[self.up] = lost

    def _lifts(self, low: float, high: float, first: float, last: float, *, arc: bool) -> bool | None:
        """Whether the turn lifts the knife; None: one cannot say."""
        if first == last:
            least = 0.0 if low <= last <= high else min(abs(last - low), abs(last - high))
            most = max(abs(last - low), abs(last - high))
        else:
            least, most = 0.0, 180.0
        if most <= SAME:
            return False
        if self.up < 0:
            # Which output it is and how long it takes counts, not where axes go.
            return self.now.angle is not None and least > self.now.angle + SAME
        if self.now.angle is not None and most <= self.now.angle + SAME:
            return False
        sure = self.now.angle is not None and least > self.now.angle + SAME
        # R0 takes the lift of arcs away, of the corner before them or of what is within them; of T1, A corrects angles.
        return True if sure and not self.mode.target and (not arc or self.mode.lifts_in_arcs) else None

    def _turn(self, lifts: bool | None, first: float, last: float, low: float, high: float) -> None:
        """Up, and the turn at rest; on its way (T1) it turns later."""
        run = self.run
        if lifts is not False and self.up >= 0:
            self._go(Op.TRAVERSE, self.up, self._raised(sure=lifts is True))
        if self.mode.target:
            return
        if low == high:
            place = Position(last)
        else:
            place = self.between(self.axis, Position(first), Position(last))
        if max(abs(first - low), abs(last - high)) <= SAME and low == high:
            return
        waits = lifts is True and self.up < 0 and self.mode.dwell > 0.0
        if waits:
            run.event(Op.DWELL, self.span, arg=(self.mode.dwell, 0.0))
        self._go(Op.TRAVERSE, self.axis, place)
        if waits:
            run.event(Op.DWELL, self.span, arg=(self.mode.dwell, 0.0))

    def _height(
        self, target: list[Position], before: Position, lifts: bool | None, *, within_arc: bool
    ) -> Position | None:  # fmt: skip
        """Down again, and the height of the cut; where it goes after an arc in which it may be lifted."""
        s = self.run.modal
        named = target[self.up] != before
        down = before
        if lifts is not False or self.mode.automatic:
            # M0: where it was, or the lower position; M1: the same, after a rapid move too.
            down = self.between(self.up, before, self._bottom())
            self._go(Op.FEED, self.up, down)
        if not named:
            target[self.up] = s.position[self.up]
        elif self.mode.automatic:
            target[self.up] = self.between(self.up, target[self.up], self._bottom())
        if not within_arc:
            return None
        back = target[self.up]
        self._go(Op.TRAVERSE, self.up, self._raised(sure=False))
        target[self.up] = self.between(self.up, s.position[self.up], target[self.up], self._top())
        return back


_KEPT = 64
"""Places between readings that are remembered."""


def follows(run: WinCncRun) -> KnifeMode | None:
    """How the knife turns, where ``turn_before`` makes its rows: gproof's own [knife] is that of ``knife_axis.py``."""
    return wincnc_settings(run.machine).knife if run.machine.knife is None else None


def problem_of(run: WinCncRun, mode: KnifeMode) -> str:
    """Why nobody can say where the axes go while the knife of this machine is on, "" where one can."""
    axis = run.machine.axis(mode.axis)
    word = run.machine.word(AXIS_NAMES.index(mode.axis))
    if axis is None or mode.axis in ("x", "y", mode.vertical):
        return f"with N of knifemode= on {word}, which is not an axis of its own"
    if run.modal.linear[axis.index]:
        return f"with N of knifemode= on {word}, which counts lengths"
    if mode.vertical and run.machine.axis(mode.vertical) is None:
        return "with V of knifemode= on an axis that is not there"
    if mode.blade or mode.both_ways:
        return (
            "with a tilted blade (A and M of knifeangle=; the manual does not say in which direction, and from "
            "where it cuts)"
        )
    if mode.x or mode.y:
        return "with a blade off its axis (X and Y of knifeangle=; the manual does not say how the axes correct for it)"
    return ""


def switched(run: WinCncRun, span: Span) -> None:
    """After L30 and before L31."""
    mode = follows(run)
    if mode is not None:
        Turning(run, mode, span).lift_by_itself()


def turn_before(
    run: WinCncRun, mode: KnifeMode, op: Op, target: list[Position], span: Span, center: list[float] | None, turns: int
) -> tuple[list[Position], Position | None]:  # fmt: skip
    """The rows before a move; where it ends, and where the vertical axis goes after it, None: nowhere."""
    turning = Turning(run, mode, span)
    target = list(target)
    if target[turning.axis] != run.modal.position[turning.axis]:
        what = f"the program turns {run.machine.word(turning.axis)} itself"
        target[turning.axis] = turning._tell(turning.axis, what)
        return target, None
    if op is Op.TRAVERSE:
        return turning.traverse(target), None
    return turning.cut(op, target, center, turns)


def lower(run: WinCncRun, mode: KnifeMode, span: Span, place: Position) -> None:
    """After an arc in which it may have been lifted."""
    turning = Turning(run, mode, span)
    turning._go(Op.FEED, turning.up, place)


def _arc_direction(
    start: tuple[float, float], end: tuple[float, float], center: tuple[float, float], turns: int
) -> tuple[float, float]:  # fmt: skip
    """(direction at the start, degrees by which it turns along the arc)."""
    (x0, y0), (x1, y1), (cx, cy) = start, end, center
    sign = 1 if turns > 0 else -1
    first, last = math.atan2(y0 - cy, x0 - cx), math.atan2(y1 - cy, x1 - cx)
    sweep = (last - first) * sign % (2 * math.pi)
    if sweep < 1e-12 or (x0, y0) == (x1, y1):
        sweep = 2 * math.pi
    sweep += (abs(turns) - 1) * 2 * math.pi
    return math.degrees(first) + 90.0 * sign, math.degrees(sweep) * sign


def _nearest(at: float, direction: float, *, up: bool) -> float:
    """The angle that points along a direction and is nearest to another; of two, the greater or the smaller one."""
    turn = (direction - at + 180.0) % 360.0 - 180.0
    if up and turn == -180.0:
        turn = 180.0
    return at if abs(turn) <= SAME else at + turn


def move(
    run: WinCncRun, op: Op, target: list[Position], span: Span, *, center: list[float] | None, turns: int, plane: int,
    length: float | None, programmed: tuple[float, float] | None,
) -> None:  # fmt: skip
    """A move of the job with the turns and lifts of a knife that follows the path."""
    mode = follows(run) if KNIFE in run.modal.following else None
    if mode is None:
        go(run, op, target, span, center=center, turns=turns, plane=plane, length=length, programmed=programmed)
        return
    target, back = turn_before(run, mode, op, target, span, center, turns)
    go(run, op, target, span, center=center, turns=turns, plane=plane, length=length, programmed=programmed)
    if back is not None:
        lower(run, mode, span, back)
