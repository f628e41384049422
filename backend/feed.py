"""Feeding a section to a board: which runs fit now, what has been sent, what comes next.

Runs go out in the order in which their first steps are due, whatever their motor, and never a step beyond
the tick requested: long runs are cut there, and where a number is greater than a word of the board holds: no driver
cuts one. So everything not yet sent can still be retimed.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from gproof.backend.boards.board import Board, BoardError, Capabilities
from gproof.backend.runs import Ints, steps_within, table
from gproof.ir.columns import Columns
from gproof.ir.record import record
from gproof.ir.stream import StreamSection

_NEVER = 2**62


MOST_SPLIT = 10_000_000
"""Runs that those of one motor in one section may be split into."""


@record(frozen=True, slots=True, kw_only=True)
class Words:
    """The greatest numbers that a run may have on its way to a board: count, add (signs aside), interval; rest: the
    interval of a run of one step, where that may be greater; least: ticks between two steps of a motor (0: any)."""

    count: int = 2**31 - 1
    add: int = 2**61
    interval: int = 2**61
    rest: int = 0
    least: int = 0

    @classmethod
    def of(cls, board: Capabilities) -> Words:
        """Those of a board."""
        return cls(
            count=board.max_count, add=board.max_add, interval=board.max_interval, rest=board.max_rest,
            least=board.min_interval,
        )  # fmt: skip

    def problem(self, runs: Columns) -> str | None:
        """Why runs cannot be sent, split as they may be; None when they can."""
        interval, count, add = (runs[name].astype(np.int64) for name in ("interval", "count", "add"))
        longest = np.maximum(interval, interval + add * (count - 1))
        most = max(self.interval, self.rest)
        if len(longest) and int(longest.max()) > most:
            return f"an interval of {int(longest.max())} ticks, and the board can take {most}"
        if self.least and (near := nearest(interval, count, add)) < self.least:
            return f"steps {near} ticks apart, and the board needs {self.least}"
        parts = np.where(self.single(interval, count, add), count, count / self.count)
        if float(parts.sum()) > MOST_SPLIT:
            return f"runs that the board has to cut into more than {MOST_SPLIT}"
        return None

    def single(self, interval: Ints, count: Ints, add: Ints) -> npt.NDArray[np.bool_]:
        """Which runs have to be sent step by step."""
        longest = np.maximum(interval, interval + add * (count - 1))
        found: npt.NDArray[np.bool_] = (np.abs(np.where(count == 1, 0, add)) > self.add) | (longest > self.interval)
        return found


def nearest(interval: Ints, count: Ints, add: Ints) -> int:
    """The shortest time between two steps of a motor's runs in a section, ticks; 2⁶² where there are no two."""
    last = interval + add * (count - 1)
    first = interval.copy()
    # The first interval of all counts from the section's start.
    first[:1] = np.where(count[:1] > 1, first[:1] + add[:1], _NEVER)
    last[:1] = np.where(count[:1] > 1, last[:1], _NEVER)
    return int(np.minimum(first, last).min(initial=_NEVER))


class _Cursor:
    """One motor's runs and how far they have been sent."""

    def __init__(self, runs: Columns, words: Words) -> None:
        interval, count, add = (runs[name].astype(np.int64) for name in ("interval", "count", "add"))
        direction = runs["direction"].copy()
        if (wrong := words.problem(runs)) is not None:
            raise BoardError(wrong)
        single = words.single(interval, count, add)
        # Of one step ``add`` means nothing; it stays where it can, so that a run goes out as the same parts wherever
        # it is cut: a board's sum of executed runs takes them together.
        grows = np.where(single | ((count == 1) & (np.abs(add) > words.add)), 0, add)
        most = np.where(single, 1, words.count)
        if (count > most).any():
            parts = -(-count // most)
            most, grows = np.repeat(most, parts), np.repeat(grows, parts)
            place = np.arange(int(parts.sum())) - np.repeat(np.cumsum(parts) - parts, parts)
            skipped = place * most
            interval, add = np.repeat(interval, parts), np.repeat(add, parts)
            count = np.minimum(np.repeat(count, parts) - skipped, most)
            interval = interval + add * skipped
            direction = np.repeat(direction, parts)
        self.interval: Ints = interval
        self.count: Ints = count
        self.add: Ints = grows
        self.direction = direction
        span = count * interval + grows * (count * (count - 1) // 2)
        self.end: Ints = np.cumsum(span, dtype=np.int64)
        self.due: Ints = self.end - span + interval
        self.next = 0
        self.sent = 0
        self.sent_until = 0

    def all(self) -> Columns:
        """The runs as they are sent."""
        return self._table(0, len(self.due))

    def first_due(self) -> int:
        return int(self.due[self.next]) if self.next < len(self.due) else _NEVER

    def skip(self, steps: int) -> None:
        """Take so many steps as sent."""
        counted = np.cumsum(self.count)
        self.next = int(np.searchsorted(counted, steps, side="right"))
        before = int(counted[self.next - 1]) if self.next else 0
        self.sent_until = int(self.end[self.next - 1]) if self.next else 0
        self.sent = steps
        if steps > before:
            self._split(steps - before)

    def _split(self, k: int) -> None:
        """Drop the first ``k`` steps of the next run, which has more."""
        n, first, add = self.next, int(self.interval[self.next]), int(self.add[self.next])
        passed = k * first + add * (k * (k - 1) // 2)
        self.sent_until = int(self.due[n]) - first + passed
        self.interval[n] = first + k * add
        self.count[n] -= k
        self.due[n] = self.sent_until + self.interval[n]

    def take(self, until: int) -> Columns:
        """The steps due at or before ``until``, as runs, and count them as sent."""
        begin = self.next
        stop = int(np.searchsorted(self.due, until, side="right"))
        if stop <= begin:
            return self._table(begin, begin)
        whole = stop if int(self.end[stop - 1]) <= until else stop - 1
        taken = self._table(begin, stop)
        self.next = whole
        if whole > begin:
            self.sent_until = int(self.end[whole - 1])
        if whole < stop:
            first, add = int(self.interval[whole]), int(self.add[whole])
            before = int(self.due[whole]) - first
            k = steps_within(first, add, int(self.count[whole]), until - before)
            taken["count"][-1] = k
            self._split(k)
        self.sent += int(taken["count"].sum())
        return taken

    def _table(self, begin: int, stop: int) -> Columns:
        return table(
            self.interval[begin:stop].copy(),
            self.count[begin:stop].copy(),
            self.add[begin:stop].copy(),
            self.direction[begin:stop].copy(),
        )


def as_sent(runs: Columns, words: Words) -> Columns:
    """Runs as a board with these words gets them; BoardError for what it cannot hold."""
    return _Cursor(runs, words).all()


ANY = Words()
"""Of a board whose words hold what a certified stream may have."""


class Feeder:
    """The runs and events of one section on their way to a board; BoardError for what its words cannot hold."""

    def __init__(self, section: StreamSection, words: Words = ANY) -> None:
        self.section = section
        self._motors = [_Cursor(runs, words) for runs in section.runs]
        self._events = list(section.events.rows())
        self._event = 0

    def follow(self, other: Feeder) -> None:
        """Continue where ``other`` is; ValueError when what it has sent is not the start of this section."""
        for motor, sent in zip(self._motors, other._motors, strict=True):
            motor.skip(sent.sent)
            if motor.sent_until != sent.sent_until:
                raise ValueError(f"step {sent.sent} was sent for tick {sent.sent_until}, not for {motor.sent_until}")
        self._event = other._event

    @property
    def sent_until(self) -> int:
        """The tick of the last step sent."""
        return max((m.sent_until for m in self._motors), default=0)

    @property
    def next_due(self) -> int | None:
        """The tick of the first step or event that has not been sent; None when all have."""
        first = min((m.first_due() for m in self._motors), default=_NEVER)
        if self._event < len(self._events):
            first = min(first, int(self._events[self._event][0]))
        return None if first == _NEVER else first

    def fill(
        self, board: Board, free: int, until: int, before: Callable[[tuple[int, ...]], None] = lambda _: None
    ) -> None:  # fmt: skip
        """Send what is due up to ``until``, as far as ``free`` runs reach; earlier steps first.

        before: told how many steps of each motor are given out with this, before anything of it is.
        """
        waiting = [m.due[m.next : m.next + free + 1] for m in self._motors]
        due = np.concatenate([w[: np.searchsorted(w, until, side="right")] for w in waiting])
        if len(due) > free:
            due.partition(free)
            until = min(until, int(due[free]) - 1)
        taken = [motor.take(until) for motor in self._motors]
        if any(map(len, taken)):
            before(tuple(motor.sent for motor in self._motors))
        while self._event < len(self._events) and int(self._events[self._event][0]) <= until:
            tick, row, op, arg = self._events[self._event]
            board.queue_event(int(tick), int(row), int(op), (int(arg[0]), int(arg[1])))
            self._event += 1
        for number, runs in enumerate(taken):
            if len(runs):
                board.queue_runs(number, runs)
