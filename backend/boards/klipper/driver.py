"""A board with Klipper's micro-controller protocol behind the ``Board`` protocol.

Unmodified firmware does. What such a board cannot do the host does: it counts free places, keeps bounds of the board's
clock, watches its own promises, and asks for the positions when a section is over. Unmodified firmware cannot watch
``commit``: a step that comes too late is a shutdown there, and motors end apart. With the certification extension the
board is given the stream's identity and the promises. A section is over only when the board counts what was sent.
"""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable

import numpy as np

from gproof.backend.boards.board import (
    BoardError,
    BoardState,
    Capabilities,
    Counting,
    EventDone,
    Executed,
    Known,
    Observed,
    Status,
)
from gproof.backend.boards.klipper.clock import CRYSTAL, BoardClock, ClockError, Steadiness
from gproof.backend.boards.klipper.connection import Shutdown
from gproof.backend.boards.klipper.ledger import MotorLedger
from gproof.backend.boards.klipper.lines import Line, LineLost
from gproof.backend.boards.klipper.outbox import FROM_BASE, REBASE, Outbox
from gproof.backend.boards.klipper.session import Session
from gproof.backend.boards.klipper.wire_size import LONGEST, MOST_ADD, MOST_COUNT, holds, run_bytes
from gproof.backend.boards.klipper.wiring import Wiring
from gproof.backend.runs import Ints, table
from gproof.ir.columns import Columns

KLIPPER = "klipper"

LATE = ("Timer too close", "too far in past", "in the past", "Promise expired")
"""Texts of shutdowns that mean that something came too late."""

LONGEST_REST = 1 << 61
"""A rest of any length is a new clock base."""

FURTHEST = 1 << 30
"""Ticks ahead that a promise may be: 32 bits tell 2**31 from the past."""

START = 0.1
"""Seconds before tick 0 of a section for the line, beside the lead that the runtime asks for."""

MOST_EVENT = 24
"""Bytes of the change of one output at most, with its part of a block."""

RESERVE = 8
"""Places of the board that are left for outputs."""

SLACK = 2000
"""Ticks that a board takes to stop after the clock that it states: a step may still be made in them."""

FIND_TRIES, FIND_PAUSE = 50, 0.1
"""How often a board that was lost is looked for, seconds apart."""

_MOMENT, _PAUSE = 0.0005, 0.2
_NEVER, _WORD = 1 << 62, 0xFFFFFFFF


class KlipperBoard:
    """See the module's text.

    connect: opens the line; wiring: pins; pulse, direction_setup: ticks, as the machine file has them; baud: of the
    line, 0 where it has none; frequency: Hz that the clock has to count, 0: whatever it counts; steadiness: of the
    board's clock; name: of the kind of board. Tick frequency and places are the board's own.
    """

    def __init__(
        self,
        connect: Callable[[], Line],
        wiring: Wiring,
        *,
        pulse: int = 32,
        direction_setup: int = 80,
        baud: int = 0,
        frequency: int = 0,
        steadiness: Steadiness = CRYSTAL,
        name: str = KLIPPER,
    ) -> None:
        self._connect = connect
        self._wiring = wiring
        self._pulse, self._setup, self._baud = pulse, direction_setup, baud
        self._steadiness = steadiness
        self._frequency, self._name = frequency, name
        self._live: Session | None = None
        self._past: BoardClock | None = None
        self._identity = b""
        self._executed: tuple[Executed, ...] = ()
        self._section, self._section_sent, self._section_taken = 0, 0, False
        self._sent = 0
        self._state, self._reason = BoardState.CLOSED, ""
        self._known = Known.UNKNOWN
        self._stopped_at: int | None = None
        self._offsets: list[int] | None = None
        self._motors = [MotorLedger() for _ in wiring.motors]
        self._outbox = Outbox(wiring, self._motors)
        self._places = 0
        self._now = 0
        self._base = 0
        self._horizon: int | None = None
        self._end: int | None = None
        self._renew_at: int | None = None
        self._done: list[EventDone] = []
        self._events = 0
        self._bounds: tuple[list[tuple[int, int]], tuple[int, ...]] | None = None

    # Opening.

    def open(self) -> Capabilities:
        """See Board; a board that has the right configuration already keeps it, and its positions."""
        self.close()
        try:
            live = self._reach()
            if self._frequency not in (0, live.clock.frequency):
                counts = f"the board counts {live.clock.frequency} ticks a second"
                raise BoardError(f"{counts}, the machine file says {self._frequency} (tick_frequency)")
            self._places = live.configure(self._pulse) - (RESERVE if self._wiring.outputs else 0)
            if self._places < len(self._motors):
                raise BoardError(f"the board stores {self._places} runs, too few for {len(self._motors)} motors")
            self._switch(live, on=True)
            self._begin(live)
        except BoardError:
            self._release()
            raise
        dictionary = live.link.dictionary
        levels = tuple(0 if pins.inverted_direction else 1 for pins in self._wiring.motors)
        return Capabilities(
            name=self._name,
            motors=len(self._motors),
            motor_names=self._wiring.names,
            acts_alone=False,
            tick_frequency=live.clock.frequency,
            fifo_runs=self._places,
            step_pulse=self._pulse,
            direction_setup=self._setup,
            max_count=MOST_COUNT,
            max_add=MOST_ADD,
            max_interval=LONGEST,
            max_rest=LONGEST_REST,
            link_rate=self._baud // 10,
            step_rate=live.step_rate,
            step_ticks=live.step_ticks,
            run_ticks=live.run_ticks,
            event_bytes=MOST_EVENT * max(1, len(self._wiring.outputs)),
            watched=live.certified,
            identity=str(dictionary.constants.get("MCU", "")),
            firmware=dictionary.version,
            counting=Counting(levels=levels, rest=REBASE, lead=FROM_BASE) if live.certified else None,
        )

    def _reach(self) -> Session:
        """A new session; what the board counted before holds where it is the same power-up."""
        self._live = live = Session(self._connect(), self._wiring, self._steadiness)
        live.reach()
        past, first = self._past, live.clock.last
        slack = live.clock.frequency // 500
        if past is None or not past.lower(first.asked) - slack <= first.tick <= past.upper(first.answered) + slack:
            self._offsets = None
        self._past = live.clock
        return live

    def _switch(self, live: Session, *, on: bool) -> None:
        """Outputs that are on as long as a host has the board, and at the end all others: as they are at rest."""
        tick = live.tick_in(START)
        for name, output in self._wiring.outputs.items():
            if output.while_open or not on:
                self._outbox.switch(live.link, name, on=on if output.while_open else output.idle, tick=tick)
        live.link.settle()

    def _begin(self, live: Session) -> None:
        """Nothing is stored, and counting starts anew; where the motors are stays as it was."""
        raw = live.positions()
        self._outbox.clear()
        offsets = self._offsets or [0] * len(raw)
        self._motors[:] = [
            MotorLedger(position=k + off, inverted=pins.inverted_direction)
            for k, off, pins in zip(raw, offsets, self._wiring.motors, strict=True)
        ]
        self._executed = ()
        self._state, self._reason, self._stopped_at = BoardState.IDLE, "", None
        self._known, self._bounds = Known.EXACT, None
        self._done, self._events = [], 0
        self._horizon = self._end = None
        self._now = live.clock.lower(live.now())

    def close(self) -> None:
        """See Board; outputs go to their idle state, so that nothing is left on by a host that has gone."""
        if self._live is not None and self._state in (BoardState.IDLE, BoardState.RUNNING):
            with contextlib.suppress(BoardError):
                self._switch(self._live, on=False)
        self._release()

    def _release(self) -> None:
        if self._live is not None:
            self._live.link.line.close()
        self._live, self._state = None, BoardState.CLOSED

    def _session(self) -> Session:
        if self._live is None:
            raise BoardError("the board is closed")
        return self._live

    def present(self, identity: bytes) -> None:
        """See Board; asked for by firmware with the extension, which forgets it in a shutdown."""
        self._identity = identity

    # Sections.

    def start_section(self, number: int, start: tuple[int, ...], lead: int) -> int:
        """See Board; the first section after power-up tells where the motors are."""
        # What the board counts is of the section before until it has taken this one.
        self._executed, self._section, self._section_taken, self._section_sent = (), number, False, _NEVER
        self._round()
        if self._state is not BoardState.IDLE:
            raise BoardError(f"section {number}: the board is {self._state.value} {self._reason}".rstrip())
        if len(start) != len(self._motors):
            raise BoardError(f"section {number}: {len(start)} positions for {len(self._motors)} motors")
        live = self._session()
        live.read_clock()
        raw = live.positions()
        if self._offsets is None:
            self._offsets = [there - counted for there, counted in zip(start, raw, strict=True)]
        counted = [k + off for k, off in zip(raw, self._offsets, strict=True)]
        if counted != list(start):
            raise BoardError(f"section {number} starts at {list(start)}, the board is at {counted}")
        self._base = live.tick_in(START) + max(0, lead)
        if live.certified:
            live.link.send("cert_begin", identity=self._identity)
            self._section_sent = live.link.send("cert_section", number=number, clock=self._base & _WORD)
        for oid, motor in enumerate(self._motors):
            motor.section(start[oid], self._base, self._identity, number)
            live.link.send("reset_step_clock", oid=oid, clock=self._base & _WORD)
        self._outbox.clear()
        self._horizon, self._end, self._renew_at = self._base, None, None
        self._state = BoardState.RUNNING
        self._settled(live)
        self._round()
        return self._base

    def _settled(self, live: Session) -> None:
        """Let the board take what starts a section: from here on it counts this one."""
        try:
            live.link.settle()
        except (LineLost, ClockError) as error:
            self._lose(str(error))

    def queue(self, motor: int, interval: int, count: int, add: int, direction: int) -> None:
        """See Board."""
        one = [np.array([number], dtype=np.int64) for number in (interval, count, add)]
        self.queue_runs(motor, table(one[0], one[1], one[2], np.array([direction], dtype=np.int8)))

    def queue_runs(self, motor: int, runs: Columns) -> None:
        """See Board; what is queued goes out with the next promise, in the order in which it is due."""
        if not self._takes("run"):
            return
        if len(runs) > self._free():
            self.emergency_stop()
            if self._state is BoardState.STOPPED:
                self._state = BoardState.FAULT
            self._reason = f"FIFO overflow: {len(runs)} runs, {self._free()} places free"
            return
        rows = zip(*(runs[name].tolist() for name in ("interval", "count", "add", "direction")), strict=True)
        for interval, count, add, direction in rows:
            if not holds(interval, count, add, direction):
                raise BoardError(f"motor {motor}: a run ({interval}, {count}, {add}, {direction}) that no word holds")
            self._outbox.add_run(motor, interval, count, add, direction)

    def wire_bytes(self, motor: int, runs: Columns) -> Ints:
        """See Board."""
        return run_bytes(motor, runs, self._session().link.dictionary.commands)

    def queue_event(self, tick: int, row: int, op: int, arg: tuple[int, int]) -> None:
        """See Board; one that switches no wired output is acknowledged at its tick and does nothing."""
        if self._takes("event"):
            self._outbox.add_event(self._base + tick, row, op, arg)

    def commit(self, tick: int | None) -> None:
        """See Board; the host watches too, so that one that was asleep sends nothing late."""
        if self._takes("promise"):
            self._horizon = None if tick is None else self._base + tick
            self._flush(promise=True)

    def finish_section(self, duration: int) -> None:
        """See Board."""
        if self._takes("end of section"):
            self._end, self._horizon = self._base + duration, None
            self._flush(promise=True)

    def _takes(self, what: str) -> bool:
        if self._state is BoardState.RUNNING and self._end is None:
            return True
        if self._state.over and self._state is not BoardState.CLOSED:
            return False
        raise BoardError(f"a {what} outside a section")

    def _flush(self, *, promise: bool = False) -> None:
        """Send what is queued, then what is promised to firmware that watches."""
        live = self._session()
        self._outbox.send(live.link, self._now, promises=live.certified)
        if promise and live.certified:
            self._promise(live)
        self._round()

    def _promise(self, live: Session) -> None:
        """Tell the board up to when nothing is missing, or that nothing follows; as far ahead as it can be told."""
        near = self._now + FURTHEST
        if self._end is not None and self._end <= near:
            name, tick = "cert_finish", self._end
            self._renew_at = None
        elif self._end is None and self._horizon is None:
            name, tick = "cert_rest", None
            self._renew_at = None
        else:
            name, tick = "cert_commit", min(near, _NEVER if self._horizon is None else self._horizon)
            self._renew_at = tick - FURTHEST // 2 if tick == near else None
        fields = {} if tick is None else {"clock": tick & _WORD}
        live.link.transport.send(live.link.command(name, **fields), now=False)

    # Time.

    def wait(self, tick: int) -> None:
        """See Board."""
        if self._state is BoardState.RUNNING:
            self._flush()
        live = self._session()
        if not self._state.over:
            # At least a moment, so that a host that waits for an answer does not spin.
            self._round(live.now() + _MOMENT)
        while not self._state.over and self._now < tick:
            now = live.now()
            self._round(min(max(now + _MOMENT, live.clock.host_second(tick)), now + _PAUSE))

    def _round(self, until: float | None = None) -> None:
        """Hear the line, ask the clock, look after promises; what ends everything is a state and no error."""
        live = self._live
        if live is None or self._state.over:
            return
        try:
            if self._renew_at is not None and self._now >= self._renew_at and self._state is BoardState.RUNNING:
                self._promise(live)
            live.poll(moving=any(motor.runs for motor in self._motors))
            now = live.now()
            if self._late(live, now):
                return
            live.link.pump(now if until is None else until)
        except (LineLost, ClockError) as error:
            self._lose(str(error))
            return
        if live.shutdown is not None:
            text = live.shutdown[1]
            late = any(part in text for part in LATE)
            self._after_stop(live, BoardState.UNDERRUN if late else BoardState.FAULT, f"the board shut down: {text}")
        elif live.was_reset:
            self._lose("the board was reset")
        else:
            self._now = max(self._now, live.clock.lower(live.now()))
            self._settle(live)

    def _late(self, live: Session, now: float) -> bool:
        """Stop rather than send what would come too late, or go on after a promise that was not kept."""
        if self._state is not BoardState.RUNNING:
            return False
        lower, due = live.clock.lower(now), live.link.transport.due
        why = ""
        if self._horizon is not None and lower > self._horizon:
            why = f"nothing was promised past tick {self._horizon - self._base}"
        elif due is not None and live.clock.upper(now) >= due:
            why = f"a step due at tick {due - self._base} was still to be sent at {lower - self._base}"
        if why:
            self._halt(BoardState.UNDERRUN, why)
        return bool(why)

    def _settle(self, live: Session) -> None:
        """Count what is done; a section that is over is compared with what the board counts."""
        self._count(live)
        over = self._state is BoardState.RUNNING and self._end is not None and self._now >= self._end
        if over and live.link.transport.idle:
            self._compare(live)

    def _count(self, live: Session) -> None:
        """Count what was done by the last reading of the clock: nothing else shows that the board still went on."""
        self._hear_section(live)
        seen, acknowledged = live.clock.last.tick, live.link.transport.acknowledged
        for motor in self._motors:
            motor.accepted += motor.settle(seen, acknowledged)
        for event in self._outbox.done(seen, acknowledged):
            self._done.append(event)
            self._events += 1

    def _hear_section(self, live: Session) -> None:
        """Note that the board has taken the start of the section: what it counts is of this one from then on."""
        self._section_taken |= live.certified and live.link.transport.acknowledged >= self._section_sent

    def _compare(self, live: Session) -> None:
        """At the end of a section: IDLE when the board counts what was sent, and a fault when not."""
        assert self._offsets is not None
        try:
            live.read_clock()
            raw, self._executed = live.positions(), live.executed(self._section)
        except Shutdown:
            return
        except (LineLost, ClockError) as error:
            self._lose(str(error))
            return
        self._count(live)
        counted = [k + off for k, off in zip(raw, self._offsets, strict=True)]
        self._end = None
        sent = [motor.position for motor in self._motors]
        other = self._other_runs()
        if live.certified and not self._executed:
            other = f"the board does not count section {self._section}"
        if counted == sent and not other:
            self._state = BoardState.IDLE
            return
        self._state, self._stopped_at = BoardState.FAULT, self._now
        self._known = Known.EXACT if counted == sent else Known.UNKNOWN
        self._reason = other or f"the board counts {counted} at the end, and {sent} was sent"

    def _counted(self, live: Session) -> tuple[Executed, ...]:
        """What the board executed of this section; nothing where it may mean an earlier one of the same number."""
        return live.executed(self._section) if self._section_taken else ()

    def _other_runs(self) -> str:
        """Which motors executed other runs than were sent, where the board counts them; "" for none."""
        pairs = enumerate(zip(self._executed, self._motors, strict=False))
        wrong = [str(k) for k, (made, motor) in pairs if made.crc not in motor.sums(made.steps)]
        return f"the board executed other runs than were sent to motor {', '.join(wrong)}" if wrong else ""

    # Stopping.

    def emergency_stop(self) -> None:
        """See Board."""
        if not self._state.over:
            self._halt(BoardState.STOPPED, "emergency stop")

    def _halt(self, state: BoardState, reason: str) -> None:
        live = self._session()
        self._outbox.clear()
        self._hear_section(live)
        try:
            live.halt()
        except (LineLost, ClockError) as error:
            self._lose(f"{reason}; {error}")
            return
        self._after_stop(live, state, reason)

    def _after_stop(self, live: Session, state: BoardState, reason: str) -> None:
        """The one path through a shutdown: leave it, ask where the motors are, count what was made."""
        assert live.shutdown is not None
        self._hear_section(live)
        answer, _ = live.shutdown
        word = answer.fields.get("clock")
        near = live.clock.lower(answer.answered)
        # The message that has the clock can be lost; the answers to all others only say that it stopped before.
        stated = live.clock.widened(word, near) if isinstance(word, int) else None
        self._stopped_at = near if stated is None else stated
        latest = live.clock.upper(answer.answered) if stated is None else stated
        self._outbox.clear()
        live.link.transport.forget()
        try:
            live.leave_shutdown()
            raw, self._executed = live.positions(), self._counted(live)
        except BoardError as error:
            self._lose(f"{reason}; {error}")
            return
        self._state, self._reason = state, reason
        self._place(raw, latest, live.link.transport.sent)

    def _place(self, raw: list[int], tick: int, sent: int) -> None:
        """Take what the board counts after a stop at a tick for what was made; sent: messages that it can have."""
        self._known, self._horizon, self._end, self._bounds = Known.EXACT, None, None, None
        if self._offsets is None:
            return
        least, most = [], []
        made = [motor.all_made(one.steps) for motor, one in zip(self._motors, self._executed, strict=False)]
        if other := self._other_runs():
            # Counts of other runs say nothing of these.
            self._known, self._executed, self._reason = Known.UNKNOWN, (), f"{self._reason}; {other}"
        for k, (motor, counted, off) in enumerate(zip(self._motors, raw, self._offsets, strict=True)):
            position = counted + off
            bounds = motor.stopped(position, tick + SLACK, sent)
            if bounds is None:
                self._known = Known.UNKNOWN
                self._reason += f"; the board counts {position}, where no step of the section leads"
                bounds = motor.by(0, 0)[1], motor.by(_NEVER, sent)[1]
            if k < len(self._executed):
                bounds = made[k], made[k]
            motor.position = position
            # It had not stopped before the last step that it made was due.
            self._stopped_at = max(self._stopped_at or 0, motor.due(bounds[0]))
            least.append((position, bounds[0]))
            most.append(bounds[1])
        for motor in self._motors:
            motor.stop()
        self._bounds = least, tuple(most)

    def _lose(self, reason: str) -> None:
        """Nothing is heard: steps lie between what was certainly made and all that was sent."""
        self._state, self._reason, self._known = BoardState.LOST, reason, Known.BETWEEN
        self._outbox.clear()
        self._horizon = self._end = None
        live = self._session()
        self._hear_section(live)
        transport = live.link.transport
        self._sent = transport.sent
        self._stopped_at = live.clock.last.tick
        most = tuple(motor.by(_NEVER, transport.sent)[1] for motor in self._motors)
        self._bounds = [m.by(self._stopped_at, transport.acknowledged) for m in self._motors], most
        live.link.line.close()

    def find(self) -> Status:
        """See Board; the same power-up and configuration mean that its counts are those of this run."""
        offsets, reason = self._offsets, self._reason
        sent = self._sent
        for _ in range(FIND_TRIES):
            if self._state is not BoardState.LOST:
                break
            try:
                live = self._reach()
                if self._offsets is None and offsets is not None:
                    self._known, self._reason = Known.UNKNOWN, f"{reason}; found again, but it was reset"
                    break
                self._await_rest(live)
                raw, self._executed = live.positions(), self._counted(live)
            except BoardError:
                self._session().link.line.close()
                time.sleep(FIND_PAUSE)
                continue
            self._state, self._reason = BoardState.STOPPED, f"{reason}; found again"
            self._place(raw, live.clock.last.tick, sent)
        return self.status()

    def _await_rest(self, live: Session) -> None:
        """Stop a board that may still carry out what it has stored."""
        if any(motor.runs for motor in self._motors):
            live.halt()
            live.leave_shutdown()
        live.read_clock()

    # Answers.

    def _free(self) -> int:
        acknowledged = self._live.link.transport.acknowledged if self._live is not None else 0
        used = sum(motor.stored(self._now, acknowledged) for motor in self._motors)
        return max(0, self._places - used - max(0, self._outbox.switching - RESERVE))

    def status(self) -> Status:
        """See Board; in a section the steps are those that were certainly made."""
        self._round()
        transport = self._live.link.transport if self._live is not None else None
        acknowledged, sent = (transport.acknowledged, transport.sent) if transport is not None else (0, 0)
        if self._bounds is not None:
            least, most = self._bounds
        else:
            seen = self._live.clock.last.tick if self._live is not None and self._live.clock.known else 0
            least = [motor.by(seen, acknowledged) for motor in self._motors]
            running = self._state is BoardState.RUNNING
            most = tuple(motor.by(_NEVER, sent)[1] for motor in self._motors) if running else ()
        if most == tuple(steps for _, steps in least):
            most = ()
        return Status(
            tick=self._now,
            state=self._state,
            free=self._free(),
            accepted=tuple(motor.accepted + motor.taken(acknowledged) for motor in self._motors),
            steps=tuple(steps for _, steps in least),
            position=tuple(position for position, _ in least),
            events=self._events,
            stopped_at=self._stopped_at,
            reason=self._reason,
            known=Known.BETWEEN if self._state is BoardState.RUNNING else self._known,
            most=most,
        )

    def take_events(self) -> list[EventDone]:
        """See Board."""
        done, self._done = self._done, []
        return done

    @property
    def bytes_sent(self) -> int:
        """Bytes written to the line since the board was opened."""
        return self._live.link.transport.counts.bytes_out if self._live is not None else 0

    def executed(self) -> tuple[Executed, ...]:
        """See Board; of firmware with the certification extension."""
        return self._executed

    def observed(self) -> Observed:
        """See Board; such a board measures nothing."""
        return Observed()
