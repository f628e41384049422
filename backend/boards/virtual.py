"""The virtual board: a FIFO of runs executed in simulated or in real time, without hardware.

It is exact to the tick: positions, pulses, shortest intervals, overlapping pulses and late direction changes
are those of a board that gives each pulse on its tick. In simulated time the clock moves only while the host
waits, as fast as the processor can; ``latency`` and hiccups make the host late. Model and limits:
``docs/boards.md``.
"""

from __future__ import annotations

import time
from collections import deque

import numpy as np

from gproof.backend.boards import virtual_kernels as vk
from gproof.backend.boards.board import (
    VIRTUAL,
    BoardError,
    BoardState,
    Capabilities,
    EventDone,
    Executed,
    Observed,
    Status,
    ticks_up,
)
from gproof.backend.runs import Ints, spans, table
from gproof.ir.columns import Columns
from gproof.ir.machine import Machine
from gproof.ir.record import record

FIFO_RUNS = 1024
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


class VirtualBoard:
    """See the module's text.

    motors: how many; fifo_runs: runs stored for all motors together; step_pulse, direction_setup: ticks;
    delay: how late the host is; guarded: stop all motors together at the last promised tick (False: like
    boards that notice an underrun only when the late run arrives); real_time: ticks follow the wall clock,
    ``speed`` times as fast.
    """

    def __init__(
        self,
        motors: int,
        *,
        tick_frequency: int = 16_000_000,
        fifo_runs: int = FIFO_RUNS,
        step_pulse: int = 32,
        direction_setup: int = 80,
        delay: HostDelay | None = None,
        guarded: bool = True,
        real_time: bool = False,
        speed: float = 1.0,
    ) -> None:
        if motors < 1 or fifo_runs < motors or tick_frequency < 1 or not speed > 0:
            raise ValueError("a board needs motors, at least one FIFO place for each, ticks and a speed")
        self._is = Capabilities(
            name=VIRTUAL,
            motors=motors,
            tick_frequency=tick_frequency,
            fifo_runs=fifo_runs,
            step_pulse=step_pulse,
            direction_setup=direction_setup,
            real_time=real_time,
        )
        self._delay = delay or HostDelay()
        self._guarded = guarded
        self._speed = speed
        self._rings = np.zeros((motors, fifo_runs, 4), dtype=np.int64)
        self._state = np.zeros((motors, vk.FIELDS), dtype=np.int64)
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
        self._events: deque[EventDone] = deque()
        self._done_events: list[EventDone] = []
        self._events_done = 0
        self._epoch = 0.0

    @classmethod
    def for_machine(
        cls,
        machine: Machine,
        motors: int,
        *,
        fifo_runs: int = FIFO_RUNS,
        delay: HostDelay | None = None,
        guarded: bool = True,
        real_time: bool = False,
        speed: float = 1.0,
    ) -> VirtualBoard:
        """A board with the tick frequency and pulse times that the machine file states."""
        ticks = machine.board.tick_frequency
        return cls(
            motors,
            tick_frequency=ticks,
            step_pulse=ticks_up(machine.board.step_pulse, ticks),
            direction_setup=ticks_up(machine.board.direction_setup, ticks),
            fifo_runs=fifo_runs,
            delay=delay,
            guarded=guarded,
            real_time=real_time,
            speed=speed,
        )

    # The protocol: set-up.

    def open(self) -> Capabilities:
        """Clear a stop; positions are kept from the last time."""
        self._board_state, self._reason, self._stopped_at = BoardState.IDLE, "", None
        self._clear()
        for field in (vk.STEPS, vk.RUNS, vk.SHORTEST, vk.OVERLAPS, vk.SETUPS):
            self._state[:, field] = 0
        self._accepted = [0] * self._is.motors
        self._events_done, self._done_events = 0, []
        self._waits = 0
        if self._is.real_time:
            # Compiled now rather than in the middle of motion.
            vk.advance.compiled()(self._rings, self._state, self._now, 0, 0)
        self._epoch = time.monotonic() - self._now / (self._is.tick_frequency * self._speed)
        return self._is

    def close(self) -> None:
        """Nothing is accepted until it is opened again."""
        self._board_state = BoardState.CLOSED

    def _clear(self) -> None:
        self._state[:, (vk.HEAD, vk.SIZE, vk.DONE)] = 0
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
        counted = tuple(self._state[:, vk.POSITION].tolist())
        if self._known and counted != tuple(start):
            raise BoardError(f"section {number} starts at {list(start)}, the board is at {list(counted)}")
        self._known = True
        self._clear()
        self._base = self._now + max(0, lead)
        self._state[:, vk.POSITION] = start
        self._state[:, vk.LAST] = self._state[:, vk.TAIL] = self._base
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
        due = int(state[vk.TAIL]) + int(first[0])
        if due <= self._now:
            self._stop(
                BoardState.UNDERRUN,
                f"motor {motor}: a step due at tick {due - self._base} arrived at {self._now - self._base}",
            )
            return
        places = (int(state[vk.HEAD] + state[vk.SIZE]) + np.arange(len(runs))) % self._is.fifo_runs
        for k, name in enumerate(("interval", "count", "add", "direction")):
            self._rings[motor, places, k] = runs[name]
        state[vk.SIZE] += len(runs)
        state[vk.TAIL] += int(spans(runs).sum())
        self._accepted[motor] += len(runs)

    def queue_event(self, tick: int, row: int, op: int, arg: tuple[int, int]) -> None:
        """See Board."""
        self._pass_time()
        if not self._accepts("event"):
            return
        due = self._base + tick
        if due < self._now or (self._events and due < self._events[-1].tick):
            self._stop(BoardState.FAULT, f"event of row {row} at tick {tick} came too late")
            return
        self._events.append(EventDone(due, row, op))

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
            self._run(max(self._now, tick) + late)
            return
        rate = self._is.tick_frequency * self._speed
        self._pass_time()
        rest = (tick + late - self._now) / rate
        if rest > 0:
            time.sleep(rest)
        self._pass_time()

    def _pass_time(self) -> None:
        if self._is.real_time and self._board_state is not BoardState.CLOSED:
            rate = self._is.tick_frequency * self._speed
            self._run(max(self._now, int((time.monotonic() - self._epoch) * rate)))

    def _run(self, until: int) -> None:
        """Execute what is due by ``until``; the clock then shows it, whether or not motion stopped before."""
        if self._board_state is BoardState.RUNNING:
            dry = self._horizon is not None and until > self._horizon
            limit = until if self._horizon is None else min(until, max(self._now, self._horizon))
            work = vk.advance.pick(float(self._state[:, vk.SIZE].sum()))
            work(self._rings, self._state, limit, 2 * self._is.step_pulse, self._is.direction_setup)
            while self._events and self._events[0].tick <= limit:
                self._done_events.append(self._events.popleft())
                self._events_done += 1
            if dry:
                self._now = limit
                self._stop(BoardState.UNDERRUN, f"nothing was promised past tick {limit - self._base}")
            elif self._end is not None and limit >= self._end and not self._pending():
                self._board_state, self._end = BoardState.IDLE, None
        self._now = max(self._now, until)

    def _pending(self) -> bool:
        return bool(self._events) or bool(self._state[:, vk.SIZE].any())

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
        return self._is.fifo_runs - int(self._state[:, vk.SIZE].sum())

    def status(self) -> Status:
        """See Board."""
        self._pass_time()
        return Status(
            tick=self._now,
            state=self._board_state,
            free=self._free(),
            accepted=tuple(self._accepted),
            steps=tuple(self._state[:, vk.STEPS].tolist()),
            position=tuple(self._state[:, vk.POSITION].tolist()),
            events=self._events_done,
            stopped_at=self._stopped_at,
            reason=self._reason,
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
            min_interval=tuple(self._state[:, vk.SHORTEST].tolist()),
            overlaps=tuple(self._state[:, vk.OVERLAPS].tolist()),
            setups=tuple(self._state[:, vk.SETUPS].tolist()),
        )
