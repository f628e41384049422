"""What was given to a board and how much of it is done: by motor, from ticks and acknowledgements alone.

The board does not say how many places it has left; whoever sends has to count. A run has a place until its last step.
A step counts as made when its run was acknowledged and the clock has passed its tick.
"""

from __future__ import annotations

from collections import deque

from gproof.backend.boards.klipper.executed import RunSum
from gproof.backend.runs import steps_within
from gproof.ir.record import field, record


@record(slots=True)
class Run:
    """A run that was given to the board: clock ticks of the step before its first one and of its last; message: its
    number among those sent (0: not yet); base: tick of the clock base that it got (None: it goes on from the last).
    """

    before: int
    interval: int
    count: int
    add: int
    direction: int
    end: int
    message: int = 0
    base: int | None = None

    @property
    def due(self) -> int:
        """The tick of its first step."""
        return self.before + self.interval

    def by(self, tick: int) -> int:
        """Its steps that are due at or before a tick."""
        if tick >= self.end:
            return self.count
        return steps_within(self.interval, self.add, self.count, tick - self.before)

    def tick(self, step: int) -> int:
        """The tick of its step number ``step``, counted from 1."""
        return self.before + step * self.interval + self.add * (step * (step - 1) // 2)


@record(slots=True)
class MotorLedger:
    """One motor: place and steps by all runs that are done, and the runs that are not, in order.

    tail: tick of the last step given; direction: of the last run given (0: not stated since the board was opened);
    passed: runs on the list that have no place on the board any more. sum: of the runs that are off the list, in this
    section; bare: that before its first clock base; origin: clock tick of the section's tick 0; inverted: the direction
    pin is low for steps that count up.
    """

    position: int = 0
    steps: int = 0
    accepted: int = 0
    tail: int = 0
    direction: int = 0
    passed: int = 0
    inverted: bool = False
    origin: int = 0
    sum: RunSum | None = None
    bare: int = 0
    runs: deque[Run] = field(default_factory=deque)

    def add(self, interval: int, count: int, add: int, direction: int) -> Run:
        """A run that is given to the board now."""
        end = self.tail + count * interval + add * (count * (count - 1) // 2)
        run = Run(self.tail, interval, count, add, direction, end)
        self.runs.append(run)
        self.tail = end
        return run

    def settle(self, tick: int, acknowledged: int) -> int:
        """Take runs off the list that are done by a tick; how many."""
        freed = 0
        runs = self.runs
        while runs and runs[0].end <= tick and 0 < runs[0].message <= acknowledged:
            done = runs.popleft()
            self.position += done.direction * done.count
            self.steps += done.count
            self._summed(done, done.count)
            freed += 1
        self.passed = max(0, self.passed - freed)
        return freed

    def stored(self, tick: int, acknowledged: int) -> int:
        """Places that its runs take on the board when the clock shows a tick."""
        runs = self.runs
        while self.passed < len(runs):
            run = runs[self.passed]
            if run.end > tick or not 0 < run.message <= acknowledged:
                break
            self.passed += 1
        return len(runs) - self.passed

    def section(self, start: int, origin: int, identity: bytes, number: int) -> None:
        """A section starts at ``start`` steps and clock tick ``origin``."""
        self.position, self.tail, self.origin, self.direction = start, origin, origin, 0
        self.sum = RunSum(identity, number)
        self.bare = self.sum.crc
        self.sum.base(0)

    def _summed(self, run: Run, count: int) -> None:
        if self.sum is not None:
            if run.base is not None:
                self.sum.base(run.base - self.origin)
            interval = run.interval if run.base is None else run.due - run.base
            self.sum.run(interval, count, run.add, int((run.direction > 0) is not self.inverted))

    def all_made(self, steps: int) -> int:
        """Steps since the board was opened, when it states those of this section."""
        return self.steps + steps - (self.sum.steps if self.sum is not None else 0)

    def sums(self, steps: int) -> set[int]:
        """CRCs that a board may state that has made ``steps`` of this section; it may have taken the next base."""
        if self.sum is None or steps < self.sum.steps:
            return set()
        found: set[int] = set() if steps else {self.bare}
        for run in self.runs:
            rest = steps - self.sum.steps
            if not rest:
                found.add(self.sum.crc)
                if run.base is not None:
                    self.sum.base(run.base - self.origin)
                break
            self._summed(run, min(rest, run.count))
        if steps == self.sum.steps:
            found.add(self.sum.crc)
        return found

    def due(self, steps: int) -> int:
        """The tick of step number ``steps`` since the board was opened, where it is of a run on the list; else 0."""
        rest = steps - self.steps
        for run in self.runs:
            if rest <= run.count:
                return run.tick(rest) if rest > 0 else 0
            rest -= run.count
        return 0

    def stop(self) -> None:
        """Nothing is stored any more."""
        self.runs.clear()
        self.passed = 0

    def by(self, tick: int, message: int) -> tuple[int, int]:
        """Position and steps when all steps due by ``tick`` are made, of runs sent up to that message."""
        position, steps = self.position, self.steps
        for run in self.runs:
            if not 0 < run.message <= message:
                break
            made = run.by(tick)
            position += run.direction * made
            steps += made
            if made < run.count:
                break
        return position, steps

    def taken(self, acknowledged: int) -> int:
        """Runs on the list that the board has acknowledged."""
        return sum(0 < run.message <= acknowledged for run in self.runs)

    def stopped(self, position: int, tick: int, sent: int) -> tuple[int, int] | None:
        """The least and most steps made when the board counts ``position`` after a stop at ``tick``; None: no number.

        Steps are made in order, so what was made is a beginning of the runs sent, and none was due after the stop. A
        motor that turns back passes the position more than once.
        """
        at, steps = self.position, self.steps
        found = [steps] if at == position else []
        for run in self.runs:
            if not 0 < run.message <= sent or run.due > tick:
                break
            needed = (position - at) * run.direction
            if 0 < needed <= run.count and run.tick(needed) <= tick:
                found.append(steps + needed)
            at += run.direction * run.count
            steps += run.count
        return (found[0], found[-1]) if found else None
