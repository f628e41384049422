"""What every board without hardware is: a FIFO of runs executed in simulated or in real time.

It is exact to the tick: positions, pulses, shortest intervals, overlapping pulses and late direction changes
are those of a board that gives each pulse on its tick. In simulated time the clock moves only while the host
waits, as fast as the processor can; ``latency`` and hiccups make the host late. The virtual board is no more than
this (``virtual.py``); modelled boards add what ends motion on them, and their pins (``models/``). Limits:
``docs/boards.md``.
"""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable

import numpy as np

from gproof.backend.boards import run_kernels as rk
from gproof.backend.boards.board import (
    BoardError,
    BoardState,
    Capabilities,
    EventDone,
    Executed,
    Known,
    Observed,
    Status,
)
from gproof.backend.runs import Ints, spans, table
from gproof.ir.columns import Columns
from gproof.ir.record import record

LONGEST = 2**61
"""Ticks that a run may last: sums stay within 64 bits."""


@record(frozen=True, slots=True, kw_only=True)
class HostDelay:
    """How late the host is: every wait ends ``latency`` ticks late, each ``every``-th one ``hiccup`` more."""

    latency: int = 0
    hiccup: int = 0
    every: int = 0

    def ticks(self, wait: int) -> int:
        """The delay of wait number ``wait``, counted from 1."""
        return self.latency + (self.hiccup if self.every and wait % self.every == 0 else 0)


@record(frozen=True, slots=True)
class Halt:
    """Something that happens by itself: no step after ``tick``, and at tick ``at`` the board acts.

    If it is still in motion then, it goes on; the next ``Halt`` is another one.
    """

    tick: int
    at: int
    act: Callable[[], None]


class SimulatedBoard:
    """See the module's text.

    is_: what it is; delay: how late the host is; guarded: stop all motors together at the last promised tick (False:
    like boards that notice an underrun only when the late run arrives); speed: of its clock, in real time.
    """

    def __init__(
        self, is_: Capabilities, *, delay: HostDelay | None = None, guarded: bool = True, speed: float = 1.0
    ) -> None:
        motors, fifo_runs = is_.motors, is_.fifo_runs
        if motors < 1 or fifo_runs < motors or is_.tick_frequency < 1 or not speed > 0:
            raise ValueError("a board needs motors, at least one FIFO place for each, ticks and a speed")
        self._is = is_
        self._delay = delay or HostDelay()
        self._guarded = guarded
        self._speed = speed
        self._rings = np.zeros((motors, fifo_runs, 4), dtype=np.int64)
        self._state = np.zeros((motors, rk.FIELDS), dtype=np.int64)
        self._accepted = [0] * motors
        self._known = False
        self._now = 0
        self._waits = 0
        self._board_state = BoardState.CLOSED
        self._reason = ""
        self._stopped_at: int | None = None
        self._base = 0
        self._horizon: int | None = None
        self._end: int | None = None
        self._events: deque[tuple[EventDone, tuple[int, int]]] = deque()
        self._done_events: list[EventDone] = []
        self._events_done = 0
        self._epoch = 0.0
        self._well = Known.EXACT

    # The protocol: set-up.

    def open(self) -> Capabilities:
        """Clear a stop; positions are kept from the last time."""
        self._board_state, self._reason, self._stopped_at = BoardState.IDLE, "", None
        self._well = Known.EXACT
        self._clear()
        for field in (rk.STEPS, rk.RUNS, rk.SHORTEST, rk.OVERLAPS, rk.SETUPS):
            self._state[:, field] = 0
        self._accepted = [0] * self._is.motors
        self._events_done, self._done_events = 0, []
        self._waits = 0
        if self._is.real_time:
            # Compiled now rather than in the middle of motion.
            rk.advance.compiled()(self._rings, self._state, self._now, 0, 0)
        self._epoch = time.monotonic() - self._now / (self._is.tick_frequency * self._speed)
        return self._is

    def close(self) -> None:
        """Nothing is accepted until it is opened again."""
        self._board_state = BoardState.CLOSED

    def _clear(self) -> None:
        self._state[:, (rk.HEAD, rk.SIZE, rk.DONE)] = 0
        self._events.clear()
        self._horizon = self._end = None

    def present(self, identity: bytes) -> None:
        """See Board; this one does not ask."""

    def start_section(self, number: int, start: tuple[int, ...], lead: int) -> int:
        """See Board; the first section after power-up tells the board where the motors are."""
        self._pass_time()
        if self._board_state is not BoardState.IDLE:
            raise BoardError(f"section {number}: the board is {self._board_state.value}")
        if len(start) != self._is.motors:
            raise BoardError(f"section {number}: {len(start)} positions for {self._is.motors} motors")
        counted = tuple(self._state[:, rk.POSITION].tolist())
        if self._known and counted != tuple(start):
            raise BoardError(f"section {number} starts at {list(start)}, the board is at {list(counted)}")
        self._known = True
        self._clear()
        self._base = self._now + max(0, lead)
        self._state[:, rk.POSITION] = start
        self._state[:, rk.LAST] = self._state[:, rk.TAIL] = self._base
        self._horizon = self._base if self._guarded else None
        self._board_state = BoardState.RUNNING
        return self._base

    # The protocol: motion.

    def queue(self, motor: int, interval: int, count: int, add: int, direction: int) -> None:
        """See Board."""
        one = np.array([[interval], [count], [add]], dtype=np.int64)
        self.queue_runs(motor, table(one[0], one[1], one[2], np.array([direction], dtype=np.int8)))

    def wire_bytes(self, motor: int, runs: Columns) -> Ints:
        """See Board; there is no link."""
        return np.zeros(len(runs), dtype=np.int64)

    def queue_runs(self, motor: int, runs: Columns) -> None:
        """See Board. A run that comes too late ends the motion: an underrun."""
        self._pass_time()
        if not self._accepts("run") or not len(runs):
            return
        count, first, add = runs["count"], runs["interval"], runs["add"]
        last = first + add * (count - 1)
        lengths = np.abs(count.astype(np.float64)) * np.maximum(np.abs(first), np.abs(last))
        if (
            (count < 1).any()
            or (first < 1).any()
            or (last < 1).any()
            or (np.abs(runs["direction"]) != 1).any()
            or float(lengths.sum()) > LONGEST
        ):
            self._stop(BoardState.FAULT, f"motor {motor}: malformed run")
            return
        if len(runs) > self._free():
            self._stop(BoardState.FAULT, f"FIFO overflow: {len(runs)} runs, {self._free()} places free")
            return
        state = self._state[motor]
        due = int(state[rk.TAIL]) + int(first[0])
        if due <= self._now:
            self._stop(
                BoardState.UNDERRUN,
                f"motor {motor}: a step due at tick {due - self._base} arrived at {self._now - self._base}",
            )
            return
        places = (int(state[rk.HEAD] + state[rk.SIZE]) + np.arange(len(runs))) % self._rings.shape[1]
        for k, name in enumerate(("interval", "count", "add", "direction")):
            self._rings[motor, places, k] = runs[name]
        state[rk.SIZE] += len(runs)
        state[rk.TAIL] += int(spans(runs).sum())
        self._accepted[motor] += len(runs)

    def queue_event(self, tick: int, row: int, op: int, arg: tuple[int, int]) -> None:
        """See Board."""
        self._pass_time()
        if not self._accepts("event"):
            return
        due = self._base + tick
        if due < self._now or (self._events and due < self._events[-1][0].tick):
            self._stop(BoardState.FAULT, f"event of row {row} at tick {tick} came too late")
            return
        self._events.append((EventDone(due, row, op), arg))

    def commit(self, tick: int | None) -> None:
        """See Board; a board that is not guarded ignores it."""
        self._pass_time()
        if self._accepts("promise"):
            self._horizon = None if tick is None or not self._guarded else self._base + tick

    def finish_section(self, duration: int) -> None:
        """See Board."""
        self._pass_time()
        if self._accepts("end of section"):
            self._end, self._horizon = self._base + duration, None
            self._run(self._now)

    def _accepts(self, what: str) -> bool:
        """After a stop everything is dropped silently, as on the wire; without a section it is an error."""
        if self._board_state is BoardState.RUNNING and self._end is None:
            return True
        if self._board_state.over and self._board_state is not BoardState.CLOSED:
            return False
        raise BoardError(f"a {what} outside a section")

    # The protocol: time.

    def wait(self, tick: int) -> None:
        """Let time pass; in simulated time this is the only thing that takes any."""
        self._waits += 1
        late = self._delay.ticks(self._waits)
        if not self._is.real_time:
            self._attended(max(self._now, tick))
            if late:
                self._run(self._now + late)
            return
        self._pass_time()
        asked = max(self._now, tick)
        self._sleep(asked + late)
        now = self._clock()
        self._attended(min(asked, now))
        self._run(now)

    def _clock(self) -> int:
        """The tick that the clock shows."""
        if not self._is.real_time:
            return self._now
        return max(self._now, int((time.monotonic() - self._epoch) * self._is.tick_frequency * self._speed))

    def _sleep(self, until: int) -> None:
        """Real time: leave the processor to others until a tick."""
        rest = (until - self._clock()) / (self._is.tick_frequency * self._speed)
        if rest > 0:
            time.sleep(rest)

    def _pass_time(self) -> None:
        if self._is.real_time and self._board_state is not BoardState.CLOSED:
            self._run(self._clock())

    def _attended(self, until: int) -> None:
        """Time that passes while the host has time for the board."""
        self._run(until)

    def _run(self, until: int) -> None:
        """Execute what is due by ``until``; the clock then shows it, whether or not motion stopped before."""
        while self._board_state is BoardState.RUNNING:
            halt = self._halt(until)
            limit = until if halt is None else min(until, max(self._now, halt.tick))
            self._execute(limit)
            if halt is not None and until >= halt.at and self._board_state is BoardState.RUNNING:
                self._now = limit
                halt.act()
                continue
            if self._end is not None and limit >= self._end and not self._pending():
                self._board_state, self._end = BoardState.IDLE, None
            break
        self._now = max(self._now, until)

    def _halt(self, until: int) -> Halt | None:
        """What ends motion first, by ``until`` or later."""
        if self._horizon is None:
            return None
        horizon = self._horizon
        what = f"nothing was promised past tick {max(self._now, horizon) - self._base}"
        return Halt(horizon, horizon + 1, lambda: self._stop(BoardState.UNDERRUN, what))

    def _execute(self, until: int) -> None:
        """Steps and events due by ``until``."""
        self._advance(until)
        for event, arg in self._events_by(until):
            self._done(event, arg)

    def _advance(self, until: int) -> None:
        work = rk.advance.pick(float(self._state[:, rk.SIZE].sum()))
        work(self._rings, self._state, until, 2 * self._is.step_pulse, self._is.direction_setup)

    def _events_by(self, until: int) -> list[tuple[EventDone, tuple[int, int]]]:
        """Take the events due by ``until`` out of the store."""
        found = []
        while self._events and self._events[0][0].tick <= until:
            found.append(self._events.popleft())
        return found

    def _done(self, event: EventDone, arg: tuple[int, int]) -> None:
        """Note an event as carried out; arg: of the stream's event."""
        self._done_events.append(event)
        self._events_done += 1

    def _pending(self) -> bool:
        return bool(self._events) or bool(self._state[:, rk.SIZE].any())

    def _stop(self, state: BoardState, reason: str) -> None:
        self._clear()
        self._board_state, self._reason, self._stopped_at = state, reason, self._now

    def emergency_stop(self) -> None:
        """See Board. Steps due at this very tick have been given."""
        self._pass_time()
        if not self._board_state.over:
            self._stop(BoardState.STOPPED, "emergency stop")

    # The protocol: answers.

    def _free(self) -> int:
        return self._is.fifo_runs - int(self._state[:, rk.SIZE].sum())

    def status(self) -> Status:
        """See Board."""
        self._pass_time()
        return Status(
            tick=self._now,
            state=self._board_state,
            free=self._free(),
            accepted=tuple(self._accepted),
            steps=tuple(self._state[:, rk.STEPS].tolist()),
            position=tuple(self._state[:, rk.POSITION].tolist()),
            events=self._events_done,
            stopped_at=self._stopped_at,
            reason=self._reason,
            known=self._well,
        )

    def find(self) -> Status:
        """See Board; this one is never lost."""
        return self.status()

    def executed(self) -> tuple[Executed, ...]:
        """See Board; this one does not count it."""
        return ()

    def take_events(self) -> list[EventDone]:
        """See Board."""
        done, self._done_events = self._done_events, []
        return done

    def observed(self) -> Observed:
        """See Board."""
        return Observed(
            min_interval=tuple(self._state[:, rk.SHORTEST].tolist()),
            overlaps=tuple(self._state[:, rk.OVERLAPS].tolist()),
            setups=tuple(self._state[:, rk.SETUPS].tolist()),
        )
