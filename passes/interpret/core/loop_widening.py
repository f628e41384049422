"""Programs that never end, and loops that go on for longer than anybody follows.

A run that comes by a place in the state in which it was there before never ends: the section that started in that state
is where its edge leads. States are compared in Brent's way, so that a loop of a million passes keeps one of them;
counters that have no part in anything (``passes/interpret/core/dead_variables.py``) may differ. A counted loop whose
passes start in one state, and whose end is farther than what may be followed, is left open (GP522): it may end after
any of its passes, and one more of them stands for all.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

from gproof.ir import codes
from gproof.ir.finding import Refusal, Span
from gproof.ir.machine import Axis
from gproof.ir.program import For, Repeat, Variable, While
from gproof.ir.symbolic import Unknown, bounds
from gproof.ir.trace import Wait
from gproof.passes.interpret.core.call_stack import Frame, Lap
from gproof.passes.interpret.core.dead_variables import MOST_STEP
from gproof.passes.interpret.core.expressions import LEAST_WHOLE, MOST_WHOLE
from gproof.passes.interpret.core.flow_part import FlowPart
from gproof.passes.interpret.core.loop_acceleration import Leap, leap_of
from gproof.passes.interpret.core.path_exploration import FEW
from gproof.passes.interpret.core.run import ProgramEnd
from gproof.passes.interpret.core.state_key import NO_NUMBERS

if TYPE_CHECKING:
    from gproof.passes.interpret.core.control_flow import ControlFlow

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
    """Blocks that a call within so many others counts as, in addition to that of the line which calls."""
    return CALL_BLOCKS[min(depth, len(CALL_BLOCKS) - 1)]


class LoopWidening(FlowPart):
    """What is known of loops by having come by.

    laps: of places that the run comes by; counted: of loops and calls whose passes are counted; pass_counts: how often
    a place was passed; leaps: by loop what a leap over its passes does, None where there is none.
    """

    def __init__(self, flow: ControlFlow) -> None:
        super().__init__(flow)
        self.laps: dict[object, Lap] = {}
        self.counted: dict[object, Lap] = {}
        self.pass_counts: dict[object, int] = {}
        self.leaps: dict[int, Leap | None] = {}

    def come_by(self, place: object, span: Span) -> None:
        """The run comes by a place again: ProgramEnd where it is in the state of an earlier time."""
        self.pass_by(place, span)
        lap = self.laps.get(place)
        if lap is None:
            lap = self.laps[place] = Lap(span)
        if not self._as_before(lap, place):
            return
        if lap.section >= 0:
            self.run.findings.add(codes.ENDLESS_LOOP.at(span, hint=self._full_counters(lap)))
            self.run.close_section((self.run.edge(Wait.BRANCH, "", lap.section, span),))
            raise ProgramEnd
        # Once more round, from a section that an edge can lead to.
        lap.full = next(self._growing(lap), None) if lap.count >= FEW else None
        self._let_go(lap)
        lap.section, lap.until = self.run.rows.new_section(), 2 * lap.count - lap.saved
        self.run.close_section((self.run.edge(Wait.BRANCH, "", lap.section, span),))
        self.run.begin_section(lap.section)

    def _as_before(self, lap: Lap, place: object, counter: int | None = None) -> bool:
        """Whether the run is at a place in the state that is remembered of it; if not, this one may be from now on.

        counter: the number of a variable that may differ, and with it how often the innermost frame runs.
        """
        lap.count += 1
        if lap.count > SPARSE and lap.count % SPARSE:
            return False
        if lap.modal is not None and self._variables_as(lap, counter):
            self.flow.hot_blocks.run_pending()
            here = zip(lap.modal.position, self.run.modal.position, strict=True)
            if all(a.value == b.value for a, b in here) and lap.key == self._key_of(lap, place, counter):
                return True
        if lap.section >= 0 and lap.count > lap.until:
            lap.section, lap.next = -1, lap.count
        if lap.count >= lap.next and lap.section < 0:
            self.flow.hot_blocks.run_pending()
            lap.saved, lap.next = lap.count, 2 * lap.count
            lap.modal, lap.key, lap.witness = self.run.modal.copy(), self._key_of(lap, place, counter), None
        return False

    def _variables_as(self, lap: Lap, counter: int | None) -> bool:
        """Whether variables are as they were, idle ones left out; most often one look at one of them is enough."""
        assert lap.modal is not None
        now, before = self.run.modal.parameters, lap.modal.parameters
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
        if number not in self.flow.paths.idle.told:
            return False
        if number not in self.flow.paths.idle.counters:
            return True
        assert lap.modal is not None
        now, before = self.run.modal.parameters.get(number), lap.modal.parameters.get(number)
        passes = lap.count - lap.saved
        fast = isinstance(now, float) and isinstance(before, float) and abs(now - before) > MOST_STEP * passes
        return not fast and not self.flow.paths.is_far(number)

    def _key_of(self, lap: Lap, place: object, counter: int | None) -> object:
        """``_state_key`` without what may differ."""
        without = self.flow.paths.without(self.flow.paths.idle.told) if lap.count >= FEW else NO_NUMBERS
        if counter is None:
            return self.flow.paths.state_key(place, without)
        frame = self.flow.stack[-1]
        own = frame.counter, frame.again
        frame.counter, frame.again = 0.0, 0
        key = self.flow.paths.state_key(place, without | {counter})
        frame.counter, frame.again = own
        return key

    def _let_go(self, lap: Lap) -> None:
        """Variables that only messages show: what they hold in one pass is not what they hold in another."""
        assert lap.modal is not None
        if lap.count < FEW:
            return
        now, before = self.run.modal.parameters, lap.modal.parameters
        for number in self._told():
            if number in now and now[number] != before.get(number) and not self.flow.paths.is_far(number):
                now[number] = self._any(number)

    def _told(self) -> frozenset[int]:
        """Variables that messages show at most, those left out that count loops now."""
        counting = (frame.node.variable for frame in self.flow.stack if isinstance(frame.node, For))
        return self.flow.paths.idle.told - frozenset(map(self.number_of, counting))

    def _growing(self, lap: Lap) -> Iterator[tuple[int, float, float]]:
        """Idle variables of 32 bits that a pass changes: (number, value, change in a pass)."""
        assert lap.modal is not None
        now, before = self.run.modal.parameters, lap.modal.parameters
        for number in sorted(self.flow.paths.idle.told):
            value, old = now.get(number), before.get(number)
            if not isinstance(value, float) or not isinstance(old, float) or value == old:
                continue
            if self.run.dialect.is_whole(number):
                yield number, value, (value - old) / (lap.count - lap.saved)

    def _any(self, number: int) -> Unknown:
        return Unknown(f"{self.flow.paths.name(number)}, which counts passes,")

    def _full_counters(self, lap: Lap) -> str:
        """What becomes of a counter in a loop without an end, as a hint."""
        if lap.full is None:
            return ""
        number, value, each = lap.full
        passes = (math.copysign(MOST_WHOLE, each) - value) // each
        name = self.flow.paths.name(number)
        return f"check {name}: it counts passes and exceeds 32 bits after {passes:.0f} passes"

    def number_of(self, variable: Variable) -> int:
        """The number of a variable; Refusal GP232 where that is not known."""
        number = self.run.evaluator.value(variable.number)
        if isinstance(number, Unknown):
            raise Refusal(codes.UNKNOWN_CONDITION.at(variable.span, cause=number.cause))
        return round(number)

    # ---- loops whose count is known or bounded

    def is_alike(self, place: object, span: Span, counter: int, passes: float, *, sure: bool) -> bool:
        """Whether what a counted loop does is the same in every pass, and so many more of them are too many.

        counter: the number of the variable that counts, -1 without one; sure: that many will be, not that many at most.
        GP522 is reported, and the state has what it needs to stand for those of all passes.
        """
        if passes < FIRST_LOOK:
            return False
        lap = self.counted.get(place)
        if lap is None:
            lap = self.counted[place] = Lap(span, self.run.blocks, self.run.branches)
        if not self._as_before(lap, place, counter) or lap.count < FIRST_LOOK:
            return False
        blocks, branches = self.run.blocks - lap.blocks, self.run.branches - lap.branches
        is_long = blocks * passes > lap.count * (self.run.budget - self.run.blocks)
        is_wide = branches * passes > lap.count * (self.run.max_branches - self.run.branches)
        if not (is_long or is_wide):
            return False
        if sure and any(abs(value + each * passes) > MOST_WHOLE for _, value, each in self._growing(lap)):
            # A counter leaves its 32 bits before the loop is over.
            return False
        if sure and branches and self.flow.paths.idle.step * passes * blocks > lap.count * MOST_WHOLE:
            # One may: what outcomes that have joined have counted is not known of each.
            return False
        self._let_go(lap)
        self.run.findings.add(codes.ALIKE_PASSES.at(span, done=lap.count))
        return True

    def ends_of(self, frame: Frame, node: For) -> tuple[float, float]:
        """The least and the greatest that the last value of the variable may be; both negative where it falls."""
        low, high = bounds(frame.last)
        if isinstance(frame.last, Unknown) and frame.last.bounded:
            # Bounds are whole numbers, and rounding has widened the range.
            low, high = float(math.ceil(low)), float(math.floor(high))
        return (-high, -low) if node.down else (low, high)

    # ---- loops that only count

    def leap_over(self, node: While | Repeat | For, passes: float = math.inf) -> float:
        """Over how many passes of a loop that only counts it goes at once, of at most ``passes``."""
        key = id(node)
        if key not in self.leaps:
            self.leaps[key] = leap_of(node, self.run.program.rules)
        leap = self.leaps[key]
        if leap is None or passes < FIRST_LOOK:
            return 0.0
        held = self.run.modal.parameters
        ends = {number: (LEAST_WHOLE, MOST_WHOLE) for number, _ in leap.steps if self.run.dialect.is_whole(number)}
        count = min(leap.passes(held, ends), passes)
        if count < FIRST_LOOK or math.isinf(count):
            return 0.0
        for number, step in leap.steps:
            value = held[number]
            assert isinstance(value, float)
            held[number] = value + count * step
        return count

    # ---- loops that lead away

    def pass_by(self, place: object, span: Span) -> None:
        """One more pass of a loop that may go on and on."""
        count = self.pass_counts[place] = self.pass_counts.get(place, 0) + 1
        if count % FIRST_LOOK == 0 and self.run.branches > 2 * FIRST_LOOK:
            # Outcomes of the passes are to come together: what is reported of counts would keep them apart.
            now = self.run.modal.parameters
            shown = self._told() - self.flow.paths.idle.unread
            now.update(
                {number: self._any(number) for number in shown if number in now and not self.flow.paths.is_far(number)}
            )
        if count % AWAY_PASSES == 0:
            self._stop_away(span)

    def _stop_away(self, span: Span) -> None:
        """ProgramEnd where a loop has led an axis out of the machine by its whole length, and goes on with it."""
        self.flow.hot_blocks.run_pending()
        for axis in self.run.machine.axes:
            low, high = _outermost(axis)
            place = self.run.modal.position[axis.index]
            if low is None or high is None or place.form:
                continue
            if low - (high - low) <= place.value <= high + (high - low):
                continue
            # The rows that led there are reported as past their limits; those to come would say the same for ever.
            what = f"a loop that moves {axis.word} further and further out of the machine"
            finding = codes.UNSUPPORTED_CODE.at(span, code=what)
            self.run.refused = True
            self.run.fail(finding)
            self.run.end_section(Wait.UNKNOWN, finding.message, -1, span)
            raise ProgramEnd


def _outermost(axis: Axis) -> tuple[float | None, float | None]:
    """As far as an axis goes, end stops included."""
    lows = [value for value in (axis.lower, axis.travel_lower) if value is not None]
    highs = [value for value in (axis.upper, axis.travel_upper) if value is not None]
    return min(lows, default=None), max(highs, default=None)
