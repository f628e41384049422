"""Motors: runs executed by arithmetic, exact to the tick; their log, counts and CRC-32.

Ticks are those since the last reset, not cut to 32 bits. Run: the first step ``interval`` ticks after ``last``, and the
interval grows by ``add`` before each further one. A step due at tick t has been made when the clock shows t.
"""

from __future__ import annotations

import struct
import zlib
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass

from gproof.backend.boards.emulator.wire import MASK, signed

HALF = 1 << 31

Logged = Callable[["Motor", int, int, int, int, int], None]
"""Takes executed steps: motor, last (tick that the first interval counts from), interval, add, count, direction."""


class Refused(Exception):
    """The board shuts down for this reason."""


@dataclass(slots=True)
class Run:
    """A run in the queue; count: steps until its intervals are none any more; end: tick of the last."""

    last: int
    interval: int
    add: int
    count: int
    direction: int
    end: int

    def made(self, tick: int) -> int:
        """Steps due at or before a tick."""
        span = tick - self.last
        if span < self.interval:
            return 0
        if tick >= self.end:
            return self.count
        low, high = 1, self.count
        while high - low > 1:
            middle = (low + high) // 2
            if self.at(middle) <= span:
                low = middle
            else:
                high = middle
        return low

    def at(self, step: int) -> int:
        """Ticks from ``last`` to a step, counted from 1."""
        return step * self.interval + self.add * (step * (step - 1) // 2)


class Proof:
    """Count and CRC-32 of the executed runs, merged where one goes on where the one before ended (docs/boards.md)."""

    def __init__(self, head: bytes = b"") -> None:
        self.steps = 0
        self._crc = zlib.crc32(head)
        self._interval = self._count = self._add = self._direction = 0

    def base(self, offset: int) -> None:
        """A new base, ``offset`` ticks after the section's clock."""
        self._close()
        self._crc = zlib.crc32(struct.pack("<BI", 0x42, offset & MASK), self._crc)

    def run(self, interval: int, add: int, count: int, direction: int) -> None:
        """Executed steps of one run."""
        self.steps += count
        if (
            self._count
            and add == self._add
            and direction == self._direction
            and interval == (self._interval + self._count * add) & MASK
        ):
            self._count += count
            return
        self._close()
        self._interval, self._add, self._count, self._direction = interval, add, count, direction

    def _record(self) -> bytes:
        if not self._count:
            return b""
        return struct.pack("<BIIhB", 0x52, self._interval, self._count & MASK, self._add, self._direction)

    def _close(self) -> None:
        self._crc = zlib.crc32(self._record(), self._crc)
        self._count = 0

    @property
    def crc(self) -> int:
        """Of everything so far, the open record with it."""
        return zlib.crc32(self._record(), self._crc)


class Motor:
    """One stepper. pins: of step and direction; index: its place in the log."""

    def __init__(self, index: int, step_pin: int, direction_pin: int, logged: Logged) -> None:
        self.index = index
        self.step_pin = step_pin
        self.direction_pin = direction_pin
        self.proof = Proof()
        self.position = 0  # of closed runs
        self.direction = 0
        self.needs_reset = False
        self.dead_at: int | None = None  # tick at which the next interval is none: the board shuts down
        self._logged = logged
        self._queue: deque[Run] = deque()
        self._behind = 0  # runs after one whose intervals end
        self._last = 0
        self._head_made = 0  # steps of the first run that are closed already

    @property
    def active(self) -> bool:
        """Whether something is queued."""
        return bool(self._queue)

    @property
    def stored(self) -> int:
        """Places that it holds."""
        return len(self._queue) + self._behind

    @property
    def end(self) -> int:
        """Tick of the last step queued."""
        return self._queue[-1].end if self._queue else self._last

    def reset_clock(self, tick: int) -> None:
        """The next interval counts from a tick; Refused while it steps."""
        if self._queue:
            raise Refused("Can't reset time when stepper active")
        self._last = tick
        self.needs_reset = False

    def queue(self, now: int, interval: int, count: int, add: int) -> None:
        """Store a run; dropped where it waits for a new base. Refused."""
        if not count:
            raise Refused("Invalid count parameter")
        if self.needs_reset:
            return
        if self.dead_at is not None:
            self._behind += 1
            return
        if self._queue:
            last = self._queue[-1].end
            if not 0 < interval < HALF:
                self.dead_at = last
                self._behind += 1
                return
        else:
            # The chip compares words of 32 bits: what is more than half of that ahead counts as past.
            wait = signed(self._last + interval - now)
            if wait <= 0:
                raise Refused("Timer too close")
            last = now + wait - interval
        good = count
        if interval >= HALF:
            good = 1
        elif add < 0:
            good = min(count, (interval - 1) // -add + 1)
        elif add > 0:
            good = min(count, (HALF - 1 - interval) // add + 1)
        run = Run(last, interval, add, good, self.direction, 0)
        run.end = last + run.at(good)
        self._queue.append(run)
        if good < count:
            self.dead_at = run.end

    def run(self, tick: int) -> None:
        """Close all runs whose last step is due by a tick."""
        while self._queue and self._queue[0].end <= tick:
            run = self._queue.popleft()
            self._close(run, run.count)
            self._last, self._head_made = run.end, 0

    def _close(self, run: Run, made: int) -> None:
        skip = self._head_made
        count = made - skip
        if count:
            last, interval = run.last + run.at(skip), run.interval + skip * run.add
            self.position += count if run.direction else -count
            self.proof.run(interval & MASK, run.add, count, run.direction)
            self._logged(self, last, interval, run.add, count, run.direction)
            self._head_made = made

    def settle(self, tick: int) -> None:
        """Close the steps due by a tick, those of a run that goes on too: for the log and for answers."""
        self.run(tick)
        if self._queue:
            self._close(self._queue[0], self._queue[0].made(tick))

    def position_at(self, tick: int) -> int:
        """The count at a tick that ``run`` has reached."""
        if not self._queue:
            return self.position
        head = self._queue[0]
        count = head.made(tick) - self._head_made
        return self.position + (count if head.direction else -count)

    def start_proof(self, head: bytes) -> None:
        """A section starts: count and CRC start again."""
        self.proof = Proof(head)

    def stop(self, tick: int) -> None:
        """Nothing after this tick is made; what was queued is forgotten, and a new base is needed."""
        self.settle(tick)
        self._queue.clear()
        self._behind = self._head_made = 0
        self._last = 0
        self.direction = 0
        self.needs_reset = True
        self.dead_at = None
