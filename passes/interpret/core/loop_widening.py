"""Programs that never end, and loops that go on for longer than anybody follows.

A run that comes by a place in the state in which it was there before never ends: the section that began in that state
is where its edge leads. States are compared in Brent's way, so that a loop of a million passes keeps one of them;
counters that have no part in anything (``passes/interpret/core/dead_variables.py``) may differ. A counted loop whose
passes begin in one state, and whose end is farther than what may be followed, is left open (GP522): it may end behind
any of its passes, and one more of them stands for all.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from gproof.ir import codes
from gproof.ir.finding import Refusal, Span
from gproof.ir.machine import Axis
from gproof.ir.program import For, Repeat, Variable, While
from gproof.ir.symbolic import Unknown, bounds
from gproof.ir.trace import Wait
from gproof.passes.interpret.core.call_stack import Frame, Lap
from gproof.passes.interpret.core.dead_variables import MOST_STEP
from gproof.passes.interpret.core.expressions import LEAST_WHOLE, MOST_WHOLE
from gproof.passes.interpret.core.loop_acceleration import leap_of
from gproof.passes.interpret.core.modal_state import NO_NUMBERS
from gproof.passes.interpret.core.path_exploration import FEW, Branches
from gproof.passes.interpret.core.trace_writer import ProgramEnd
from gproof.passes.interpret.mcuwin.state import fits

AWAY_PASSES = 64
"""So many passes of a loop between two looks at whether it leads out of the machine."""
SPARSE = 64
"""After so many passes a state is compared at each ``SPARSE``th of them only."""
FIRST_LOOK = 16
"""Passes of a loop before it is asked whether it goes on for too long."""

CALL_BLOCKS = (0, 20, 50, 100, 200)
"""Blocks that a call counts as, by how many others it is within; the last of them where there are more.

What is said once at each level is done a thousand times a thousand times at the third: calls that multiply come to an
end in seconds. A call within a call costs as much time as some fifty blocks of a loop do.
"""


def call_blocks(depth: int) -> int:
    """Blocks that a call within so many others counts as, beside that of the line which calls."""
    return CALL_BLOCKS[min(depth, len(CALL_BLOCKS) - 1)]


class Endless(Branches):
    """What is known of loops by having come by."""

    def _lap(self, place: object, span: Span) -> None:
        """The run comes by a place again: ProgramEnd where it is in the state of an earlier time."""
        self._pass_by(place, span)
        lap = self._laps.get(place)
        if lap is None:
            lap = self._laps[place] = Lap(span)
        if not self._as_before(lap, place):
            return
        if lap.section >= 0:
            self.findings.add(codes.ENDLESS_LOOP.at(span, hint=self._full_counters(lap)))
            self._close((self._edge(Wait.BRANCH, "", lap.section, span),))
            raise ProgramEnd
        # Once more round, from a section that an edge can lead to.
        lap.full = next(self._growing(lap), None) if lap.count >= FEW else None
        self._let_go(lap)
        lap.section, lap.until = self.rows.new_section(), 2 * lap.count - lap.saved
        self._close((self._edge(Wait.BRANCH, "", lap.section, span),))
        self._begin(lap.section)

    def _as_before(self, lap: Lap, place: object, counter: int | None = None) -> bool:
        """Whether the run is at a place in the state that is remembered of it; if not, this one may be from now on.

        counter: the number of a variable that may differ, and with it how often the innermost frame runs.
        """
        lap.count += 1
        if lap.count > SPARSE and lap.count % SPARSE:
            return False
        if lap.modal is not None and self._variables_as(lap, counter):
            self._run_pending()
            here = zip(lap.modal.position, self.modal.position, strict=True)
            if all(a.value == b.value for a, b in here) and lap.key == self._key_of(lap, place, counter):
                return True
        if lap.section >= 0 and lap.count > lap.until:
            lap.section, lap.next = -1, lap.count
        if lap.count >= lap.next and lap.section < 0:
            self._run_pending()
            lap.saved, lap.next = lap.count, 2 * lap.count
            lap.modal, lap.key, lap.witness = self.modal.copy(), self._key_of(lap, place, counter), None
        return False

    def _variables_as(self, lap: Lap, counter: int | None) -> bool:
        """Whether variables are as they were, idle ones left out; most often one look at one of them is enough."""
        assert lap.modal is not None
        now, before = self.modal.parameters, lap.modal.parameters
        if lap.witness is not None and now.get(lap.witness) != before.get(lap.witness):
            return False
        if now == before:
            return True
        for number in before.keys() | now.keys():
            differs = now.get(number) != before.get(number)
            if differs and number != counter and (lap.count < FEW or not self._may_differ(lap, number)):
                lap.witness = number
                return False
        return True

    def _may_differ(self, lap: Lap, number: int) -> bool:
        """Whether it makes no difference what a variable holds."""
        if number not in self._idle.told:
            return False
        if number not in self._idle.counters:
            return True
        assert lap.modal is not None
        now, before = self.modal.parameters.get(number), lap.modal.parameters.get(number)
        passes = lap.count - lap.saved
        fast = isinstance(now, float) and isinstance(before, float) and abs(now - before) > MOST_STEP * passes
        return not fast and not self._is_far(number)

    def _key_of(self, lap: Lap, place: object, counter: int | None) -> object:
        """``_state_key`` without what may differ."""
        without = self._without(self._idle.told) if lap.count >= FEW else NO_NUMBERS
        if counter is None:
            return self._state_key(place, without)
        frame = self._stack[-1]
        own = frame.counter, frame.again
        frame.counter, frame.again = 0.0, 0
        key = self._state_key(place, without | {counter})
        frame.counter, frame.again = own
        return key

    def _let_go(self, lap: Lap) -> None:
        """Variables that only messages show: what they hold in one pass is not what they hold in another."""
        assert lap.modal is not None
        if lap.count < FEW:
            return
        now, before = self.modal.parameters, lap.modal.parameters
        for number in self._told():
            if number in now and now[number] != before.get(number) and not self._is_far(number):
                now[number] = self._any(number)

    def _told(self) -> frozenset[int]:
        """Variables that messages show at most, those left out that count loops now."""
        counting = (frame.node.variable for frame in self._stack if isinstance(frame.node, For))
        return self._idle.told - frozenset(map(self._number, counting))

    def _growing(self, lap: Lap) -> Iterator[tuple[int, float, float]]:
        """Idle variables of 32 bits that a pass changes: (number, value, change in a pass)."""
        assert lap.modal is not None
        now, before = self.modal.parameters, lap.modal.parameters
        for number in sorted(self._idle.told):
            value, old = now.get(number), before.get(number)
            if not isinstance(value, float) or not isinstance(old, float) or value == old:
                continue
            if self._is_whole(number):
                yield number, value, (value - old) / (lap.count - lap.saved)

    def _any(self, number: int) -> Unknown:
        return Unknown(f"{self._name(number)}, which counts passes,")

    def _full_counters(self, lap: Lap) -> str:
        """What becomes of a counter in a loop without an end, as a hint."""
        if lap.full is None:
            return ""
        number, value, each = lap.full
        passes = (math.copysign(MOST_WHOLE, each) - value) // each
        return f"{self._name(number)} counts passes, and leaves its 32 bits after {passes:.0f} of them"

    def _number(self, variable: Variable) -> int:
        number = self.evaluator.value(variable.number)
        if isinstance(number, Unknown):
            raise Refusal(codes.UNKNOWN_CONDITION.at(variable.span, cause=number.cause))
        return round(number)

    # ---- loops whose count is known or bounded

    def _is_alike(self, place: object, span: Span, counter: int, passes: float, *, sure: bool) -> bool:
        """Whether what a counted loop does is the same in every pass, and so many more of them are too many.

        counter: the number of the variable that counts, -1 without one; sure: that many will be, not that many at most.
        GP522 is told, and the state has what it needs to stand for those of all passes.
        """
        if passes < FIRST_LOOK:
            return False
        lap = self._counted.get(place)
        if lap is None:
            lap = self._counted[place] = Lap(span, self.blocks, self.branches)
        if not self._as_before(lap, place, counter) or lap.count < FIRST_LOOK:
            return False
        blocks, branches = self.blocks - lap.blocks, self.branches - lap.branches
        is_long = blocks * passes > lap.count * (self.budget - self.blocks)
        is_wide = branches * passes > lap.count * (self.max_branches - self.branches)
        if not (is_long or is_wide):
            return False
        if sure and any(abs(value + each * passes) > MOST_WHOLE for _, value, each in self._growing(lap)):
            # A counter leaves its 32 bits before the loop is over.
            return False
        if sure and branches and self._idle.step * passes * blocks > lap.count * MOST_WHOLE:
            # One may: what outcomes that have joined have counted is not known of each.
            return False
        self._let_go(lap)
        self.findings.add(codes.ALIKE_PASSES.at(span, done=lap.count))
        return True

    def _ends(self, frame: Frame, node: For) -> tuple[float, float]:
        """The least and the greatest that the last value of the variable may be; both negative where it falls."""
        low, high = bounds(frame.last)
        if isinstance(frame.last, Unknown) and frame.last.bounded:
            # Bounds are whole numbers, and rounding has widened the range.
            low, high = float(math.ceil(low)), float(math.floor(high))
        return (-high, -low) if node.down else (low, high)

    # ---- loops that only count

    def _leap(self, node: While | Repeat | For, passes: float = math.inf) -> float:
        """Over how many passes of a loop that only counts it goes at once, of at most ``passes``."""
        key = id(node)
        if key not in self._leaps:
            self._leaps[key] = leap_of(node, self.program.rules)
        leap = self._leaps[key]
        if leap is None or passes < FIRST_LOOK:
            return 0.0
        held = self.modal.parameters
        ends = {number: (LEAST_WHOLE, MOST_WHOLE) for number, _ in leap.steps if self._is_whole(number)}
        count = min(leap.passes(held, ends), passes)
        if count < FIRST_LOOK or math.isinf(count):
            return 0.0
        for number, step in leap.steps:
            value = held[number]
            assert isinstance(value, float)
            held[number] = value + count * step
        return count

    def _is_whole(self, number: int) -> bool:
        """Whether a variable holds whole numbers of 32 bits."""
        return self.program.rules.source_order and not fits(number, MOST_WHOLE + 1.0, self._whole)

    # ---- loops that lead away

    def _pass_by(self, place: object, span: Span) -> None:
        """One more pass of a loop that may go on and on."""
        count = self._passes[place] = self._passes.get(place, 0) + 1
        if count % FIRST_LOOK == 0 and self.branches > 2 * FIRST_LOOK:
            # Outcomes of the passes are to come together: what is told of counts would keep them apart.
            now = self.modal.parameters
            shown = self._told() - self._idle.unread
            now.update({number: self._any(number) for number in shown if number in now and not self._is_far(number)})
        if count % AWAY_PASSES == 0:
            self._stop_away(span)

    def _stop_away(self, span: Span) -> None:
        """ProgramEnd where a loop has led an axis out of the machine by its whole length, and goes on with it."""
        self._run_pending()
        for axis in self.machine.axes:
            low, high = _outermost(axis)
            place = self.modal.position[axis.index]
            if low is None or high is None or place.form:
                continue
            if low - (high - low) <= place.value <= high + (high - low):
                continue
            # The rows that led there are told past their limits; those to come would say the same for ever.
            what = f"a loop that leads {axis.word} further and further out of the machine"
            finding = codes.UNSUPPORTED_CODE.at(span, code=what)
            self.refused = True
            self._fail(finding)
            self._end_section(Wait.UNKNOWN, finding.message, -1, span)
            raise ProgramEnd


def _outermost(axis: Axis) -> tuple[float | None, float | None]:
    """As far as an axis goes, end stops counted in."""
    lows = [value for value in (axis.lower, axis.travel_lower) if value is not None]
    highs = [value for value in (axis.upper, axis.travel_upper) if value is not None]
    return min(lows, default=None), max(highs, default=None)
