"""One section on a board: feeding ahead, feed hold, emergency stop, until the board is done or stopped."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from fractions import Fraction

from gproof.backend.boards.board import Board, BoardError, BoardState, Capabilities, Known, Status
from gproof.backend.control import Control
from gproof.backend.feed import Feeder, Words
from gproof.backend.manual_events import ManualWait
from gproof.backend.operators import HoldRequest, Operator
from gproof.backend.record_data import Result, Retiming
from gproof.ir.record import field, record
from gproof.ir.stream import StreamSection

SLICE = 0.05
"""Seconds that a real board is left alone at most, so that requests are heard."""

TRIES = 6
"""How often a rest is made longer because making it took longer than was left for that."""


@record(frozen=True, slots=True)
class Prepared:
    """A retimed section that the validator accepted; ``again`` makes the same hold with another rest."""

    section: StreamSection
    retiming: Retiming
    again: Callable[[int], Prepared | None] | None = None


Prepare = Callable[[StreamSection, int, int], Prepared | None]
"""A section, the tick of a feed hold and the ticks to rest; None: no retiming passed the validator. The same of a tick
at which nothing moves, and after which it rests."""


@record(frozen=True, slots=True, kw_only=True)
class Pace:
    """Ticks. lookahead: how far ahead runs are sent; lead: from opening a section to its tick 0;
    preparing: what working out a feed hold takes while a real board goes on."""

    lookahead: int
    lead: int
    preparing: int


@record(slots=True)
class Ended:
    """How a section ended, after ``ticks`` of the section that was last valid.

    known: the board said where its motors are after it had stopped.
    """

    outcome: Result
    ticks: int
    section: StreamSection
    retimings: list[Retiming] = field(default_factory=list)
    reason: str = ""
    known: bool = True


_Ready = tuple[Prepared, Feeder]

Change = Callable[[StreamSection, Sequence[Retiming], int, Fraction], Prepared | None]
"""A section, what was done to it since it started, a tick, and the override from there on."""


class SectionRun:
    """Runs one section; ``run`` is called once."""

    def __init__(
        self,
        board: Board,
        is_: Capabilities,
        section: StreamSection,
        *,
        pace: Pace,
        prepare: Prepare,
        operator: Operator,
        control: Control,
        estop_at: int | None,
        on_tick: Callable[[int], None],
        on_retimed: Callable[[list[Retiming]], None] = lambda _: None,
        rest: Prepare | None = None,
        waits: Sequence[ManualWait] = (),
    ) -> None:
        self.board = board
        self.is_ = is_
        self.pace = pace
        self.prepare = prepare
        self.operator = operator
        self.control = control
        self.estop_at = estop_at
        self.on_tick = on_tick
        self.on_retimed = on_retimed
        self.on_sending: Callable[[tuple[int, ...]], None] = lambda _: None
        self.on_lost: Callable[[Status, Status | None], None] = lambda _, __: None
        self.insert_rest = rest
        self.change: Change | None = None
        self.factor = Fraction(1)
        self.on_override: Callable[[Fraction, float | None], None] = lambda _, __: None
        self._changing: tuple[int, Fraction, StreamSection, Future[_Ready | None]] | None = None
        self._refused: Fraction | None = None
        self._waits = list(waits)
        self.ended = Ended(Result.FAULT, 0, section)
        self.base = 0
        self.seen: Status | None = None
        self._feeder = Feeder(section, Words.of(is_))
        self._held: Prepared | None = None
        self._asked: tuple[int, Future[_Ready | None]] | None = None
        self._patience = pace.preparing
        self._worker: ThreadPoolExecutor | None = None
        self._finished = self._unheld = False
        self._hold_at_wait = False

    def run(self) -> Ended:
        """To the end of the section, or to what stopped it."""
        try:
            self.base = self.board.start_section(self.ended.section.number, self.ended.section.start, self.pace.lead)
            while self._once():
                pass
        finally:
            if self._worker is not None:
                self._worker.shutdown(wait=False, cancel_futures=True)
        return self.ended

    def _once(self) -> bool:
        """One round: hear requests, feed, let time pass. False when the section is over."""
        self.seen = status = self.board.status()
        now = status.tick - self.base
        if status.state is not BoardState.RUNNING:
            self.end(self._found(status) if status.state is BoardState.LOST else status)
            return False
        self.on_tick(now)
        if self.control.stop_asked or (self.estop_at is not None and now >= self.estop_at):
            self.board.emergency_stop()
            return True
        self._hear(now)
        self._hear_override(now)
        stop = self._stop
        if stop is not None and self._held is None and now >= stop and not self._wait(stop):
            return False
        if self._held is not None and now >= self._held.retiming.rest_begins and not self._rest(now):
            return False
        self._feed(status, now)
        return True

    def _found(self, lost: Status) -> Status:
        """Look for a board that was lost; what it says, or what was known of it before."""
        self.on_lost(lost, None)
        found = self.board.find()
        if found.state is not BoardState.LOST:
            self.on_lost(lost, found)
        return found

    def interrupted(self) -> None:
        """An interrupt that nobody was ready to hear: an emergency stop."""
        try:
            self.board.emergency_stop()
            self.end(self.board.status())
        except BoardError as error:
            self.broken(str(error))

    def broken(self, why: str) -> None:
        """The board, or the line to it, failed: stop it if it still hears, and note what is known."""
        self.ended.known = False
        with contextlib.suppress(BoardError):
            self.board.emergency_stop()
            self.seen = self.board.status()
            self.ended.known = self.seen.state is not BoardState.RUNNING
        if self.seen is not None:
            self.end(self.seen)
        self.ended.outcome = Result.FAULT
        self.ended.reason = f"section {self.ended.section.number}, tick {self.ended.ticks}: {why}"

    def end(self, status: Status) -> None:
        """Note how the board left the section."""
        self.seen = status
        outcome = {
            BoardState.IDLE: Result.COMPLETED,
            BoardState.STOPPED: Result.EMERGENCY_STOP,
            BoardState.UNDERRUN: Result.UNDERRUN,
        }.get(status.state, Result.FAULT)
        self.ended.outcome = outcome
        self.ended.ticks = self.ended.section.duration
        if outcome is not Result.COMPLETED:
            stopped = status.tick if status.stopped_at is None else status.stopped_at
            self.ended.ticks = max(0, stopped - self.base)
            self.ended.known &= status.known is Known.EXACT
            why = "; ".join(text for text in (status.reason, self.ended.reason) if text)
            self.ended.reason = f"section {self.ended.section.number}, tick {self.ended.ticks}: {why}"

    # Feeding.

    @property
    def _stop(self) -> int | None:
        """The tick after which nothing is sent before the operator has done something; None: there is none."""
        if not self._waits:
            return None
        return max(0, int(self.ended.section.events["tick"][self._waits[0].event]) - 1)

    @property
    def _working(self) -> bool:
        """Whether a retiming is being worked out, before which nothing is sent from its tick on."""
        return self._asked is not None or self._changing is not None

    def _feed(self, status: Status, now: int) -> None:
        ahead = max(now, 0) + self.pace.lookahead
        goal = self.ended.section.duration
        until = ahead
        if self._held is not None:
            goal = self._held.retiming.rest_begins
            until = min(until, goal)
        elif self._asked is not None:
            until = min(until, self._asked[0])
        elif self._changing is not None:
            until = min(until, self._changing[0])
        if (stop := self._stop) is not None:
            goal, until = min(goal, stop), min(until, stop)
        rests = self._held is not None or stop is not None
        feeder = self._feeder
        if not self._finished:
            feeder.fill(self.board, status.free, until, self.on_sending)
        due = feeder.next_due
        if (rests and (due is None or due > goal)) or (due is None and self._working):
            # At rest, or all is sent and a hold may still come: nothing more is due.
            self.board.commit(None)
            due = None
        elif due is not None:
            self.board.commit(due - 1)
        elif not self._finished and not self._working and not rests:
            self.board.finish_section(goal)
            self._finished = True
        if due is None:
            target = min(max(goal, now + 1), now + self.pace.lookahead)
        else:
            target = now + max(1, (min(due - 1, ahead) - now) // 2)
        if self.estop_at is not None:
            target = min(target, max(self.estop_at, now))
        if self.is_.real_time:
            target = min(target, now + int(SLICE * self.is_.tick_frequency))
        self.board.wait(self.base + target)

    # Feed hold.

    def _hear(self, now: int) -> None:
        """Start or go on working out a feed hold."""
        if self._held is not None or self._finished or self._unheld or not self.control.hold_asked:
            return
        if self._hold_at_wait:
            return
        rest = self.is_.tick_frequency
        section = self.ended.section
        if not self.is_.real_time:
            # Simulated time stands still meanwhile.
            self._take(self._ready(section, max(now, self._feeder.sent_until), rest))
            return
        if self._asked is None:
            # The board goes on: the hold starts where its FIFO will be fed no further.
            self._worker = self._worker or ThreadPoolExecutor(max_workers=1)
            at = self._later(now)
            self._asked = (at, self._worker.submit(self._ready, section, at, rest))
            return
        at, future = self._asked
        if future.done():
            self._asked = None
            if now + self.pace.lookahead // 2 < at:
                self._take(future.result())
        elif now + self.pace.lookahead // 2 >= at:
            # Too slow: go on as planned and ask again with more time.
            self._asked = None
            self._patience *= 2

    # Feed override.

    def _hear_override(self, now: int) -> None:
        """Start or go on working out another override, to begin where nothing is sent yet."""
        wanted, section, ahead = self.control.override_asked, self.ended.section, self.pace.lookahead // 2
        if self.change is None or self._finished or self._held is not None or self.control.hold_asked:
            self._changing = None
            return
        if self._changing is not None:
            at, factor, of, future = self._changing
            if future.done() or now + ahead >= at:
                self._changing = None
                if future.done() and of is section and now + ahead < at:
                    self._changed(future.result(), factor, at - now)
                elif not future.done():
                    self._patience *= 2
            return
        if wanted is None or wanted in (self.factor, self._refused):
            return
        at = self._later(now) if self.is_.real_time else max(now, self._feeder.sent_until, 1)
        if at >= section.duration or any(at < r.rest_begins + r.rest for r in self.ended.retimings):
            return
        if not self.is_.real_time:
            self._changed(self._other(section, at, wanted), wanted, at - now)
            return
        self._worker = self._worker or ThreadPoolExecutor(max_workers=1)
        self._changing = at, wanted, section, self._worker.submit(self._other, section, at, wanted)

    def _other(self, section: StreamSection, at: int, factor: Fraction) -> _Ready | None:
        """The section with another override from a tick on, and its feeder."""
        assert self.change is not None
        made = self.change(section, list(self.ended.retimings), at, factor)
        return None if made is None else (made, Feeder(made.section, Words.of(self.is_)))

    def _changed(self, ready: _Ready | None, factor: Fraction, ticks: int) -> None:
        """Send the section with another override from now on; where there is none it goes on as it is."""
        if ready is None:
            self._refused = factor
            self.on_override(factor, None)
            return
        self._replace(*ready)
        self.factor, self._refused = factor, None
        self.on_override(factor, ticks / self.is_.tick_frequency)

    def _later(self, now: int) -> int:
        """The first tick that is not sent and can be left so until a retiming from there on is worked out and sent."""
        sending = self.pace.lookahead // 2 + int(SLICE * self.is_.tick_frequency)
        return max(self._feeder.sent_until, now + sending + self._patience, 1)

    def _ready(self, section: StreamSection, at: int, rest: int) -> _Ready | None:
        """A hold with its feeder, which takes a moment to make for a long section."""
        prepared = self.prepare(section, at, rest)
        if prepared is None:
            return None
        return prepared, Feeder(prepared.section, Words.of(self.is_))

    def _take(self, ready: _Ready | None) -> None:
        if ready is None and self.control.ending:
            # Nobody is in a hurry: on to the end of the section, which is at rest and loses no position.
            self._unheld = True
            return
        if ready is None:
            self.ended.reason = "no feed hold passed the stream checker"
            self.control.stop()
            return
        if self._waits:
            stop = int(ready[0].section.events["tick"][self._waits[0].event]) - 1
            if stop < ready[0].retiming.rest_begins:
                # It would come to rest later than it does anyway: there it holds.
                self._hold_at_wait = True
                return
        self._replace(*ready)
        self._held = ready[0]

    def _replace(self, prepared: Prepared, feeder: Feeder) -> None:
        feeder.follow(self._feeder)
        self._feeder = feeder
        if self._held is not None:
            self.ended.retimings.pop()
        self.ended.section = prepared.section
        self.ended.retimings.append(prepared.retiming)
        self.on_retimed(self.ended.retimings)

    def _settled(self, tick: int) -> Status:
        """What a board says whose section was finished at a tick that has passed: it counts once more."""
        status = self.board.status()
        while status.state is BoardState.RUNNING:
            self.board.wait(max(self.base + tick, status.tick + 1))
            status = self.board.status()
        return status

    def _rest(self, now: int) -> bool:
        """At rest in a feed hold: go on or end here. False when the section is over."""
        held = self._held
        assert held is not None
        begins = held.retiming.rest_begins
        number = self.ended.section.number
        request = HoldRequest(section=number, tick=begins)
        resume = bool(self.control.ask(lambda: self.operator.held(request)))
        self.control.answered()
        if resume:
            again = self._after_rest(held.again, begins) if held.again else None
            if again is not None:
                self._replace(again, Feeder(again.section, Words.of(self.is_)))
                self._held = None
                return True
        return self._ends_here(now, begins, "" if resume else self.control.ending or "ended in a feed hold")

    def _after_rest(self, make: Callable[[int], Prepared | None], begins: int) -> Prepared | None:
        """The section with a rest from ``begins`` until motion can go on: on a real board, whose clock goes on, with
        the time that making it takes. None: it did not pass the validator, or took too long each time."""
        spare = 0
        if self.is_.real_time:
            # Nobody has heard the board while somebody was asked: what its clock shows is known within what it may
            # have drifted since, and better after a moment.
            self.board.wait(self.board.status().tick + int(SLICE * self.is_.tick_frequency))
            spare = self.pace.preparing
        now = self.board.status().tick - self.base
        for _ in range(TRIES):
            rest = max(1, now + self.pace.lead + spare - begins)
            made, asked = make(rest), now
            now = self.board.status().tick - self.base
            if made is None or now + self.pace.lead <= begins + rest:
                return made
            spare = 2 * (now - asked) + self.pace.preparing
        return None

    def _ends_here(self, now: int, ticks: int, why: str) -> bool:
        """At rest: the section ends, because of ``why`` or, where that is empty, for want of a retiming. False."""
        number = self.ended.section.number
        self.board.finish_section(now)
        status = self._settled(now)
        if status.state is not BoardState.IDLE:
            self.end(self._found(status) if status.state is BoardState.LOST else status)
            return False
        self.seen = status
        self.ended.outcome = Result.STOPPED if why else Result.REFUSED
        self.ended.ticks = ticks
        self.ended.reason = f"section {number}: {why or 'the rest of the section did not pass the stream checker'}"
        return False

    # What no pin of the board does.

    def _wait(self, stop: int) -> bool:
        """At rest until the operator has done what is due next. False when the section is over."""
        now = self.board.status().tick - self.base
        if self.control.hold_asked:
            request = HoldRequest(section=self.ended.section.number, tick=stop)
            resume = bool(self.control.ask(lambda: self.operator.held(request)))
            self.control.answered()
            if not resume:
                return self._ends_here(now, stop, self.control.ending or "ended in a feed hold")
        self._asked, self._hold_at_wait = None, False
        wait = self._waits[0]
        if self.control.ask(lambda: self.operator.wait(wait.request)) is None:
            why = self.control.ending or f"ended while waiting for the operator ({wait.request.text})"
            return self._ends_here(now, stop, why)
        insert, section = self.insert_rest, self.ended.section
        made = None if insert is None else self._after_rest(lambda rest: insert(section, stop, rest), stop)
        if made is None:
            return self._ends_here(now, stop, "")
        self._replace(made, Feeder(made.section, Words.of(self.is_)))
        del self._waits[0]
        return True
