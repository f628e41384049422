"""What waits to be sent in one go, put in the order in which it is due, whatever its motor.

A board whose line is slow would otherwise get all runs of the first motor before the first one of the second. A run
after a long rest gets a new clock base: the board takes no interval of 2**31 ticks or more (docs/boards.md).
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator, Sequence

from gproof.backend.boards.board import BoardError, EventDone
from gproof.backend.boards.klipper.connection import Connection
from gproof.backend.boards.klipper.ledger import MotorLedger, Run
from gproof.backend.boards.klipper.wiring import Wiring
from gproof.ir.record import record

REBASE = 1 << 30
"""Ticks of rest from which a motor gets a new clock base."""

PROMISED = 32
"""Runs after which firmware that watches gets a promise: a line needs longer for all that is sent ahead than the
promise before lasts."""

FROM_BASE = 1 << 16
"""Ticks from a new base to the step."""

_WORD = 0xFFFFFFFF


@record(slots=True)
class _Event:
    done: EventDone
    outputs: int
    message: int = 0


class Outbox:
    """Runs and events that were queued and not sent, and events that were sent and are not done."""

    def __init__(self, wiring: Wiring, motors: Sequence[MotorLedger]) -> None:
        self._wiring = wiring
        self._motors = motors
        self._runs: list[tuple[int, int, Run]] = []
        self._new: list[tuple[int, _Event, tuple[tuple[str, bool], ...]]] = []
        self._sent: deque[_Event] = deque()

    def clear(self) -> None:
        """Forget everything that is not done."""
        for _, motor, run in reversed(self._runs):
            if self._motors[motor].runs and self._motors[motor].runs[-1] is run:
                self._motors[motor].runs.pop()
        self._runs.clear()
        self._new.clear()
        self._sent.clear()

    @property
    def pending(self) -> bool:
        """Whether an event is not done."""
        return bool(self._new) or bool(self._sent)

    @property
    def switching(self) -> int:
        """Places that outputs take on the board."""
        return sum(event.outputs for event in self._sent) + sum(event.outputs for _, event, _ in self._new)

    def add_run(self, motor: int, interval: int, count: int, add: int, direction: int) -> None:
        """Queue a run."""
        run = self._motors[motor].add(interval, count, add, direction)
        self._runs.append((run.due, motor, run))

    def add_event(self, tick: int, row: int, op: int, arg: tuple[int, int]) -> None:
        """Queue an event for a clock tick."""
        switched = self._wiring.switched(op, arg)
        self._new.append((tick, _Event(EventDone(tick, row, op), len(switched)), switched))

    def switch(self, link: Connection, name: str, *, on: bool, tick: int) -> int:
        """Send one change of an output; the number of the message."""
        wiring = self._wiring
        number = link.transport.send(
            link.command(
                "queue_digital_out", oid=wiring.oid(name), clock=tick & _WORD, on_ticks=wiring.level(name, on)
            ),
            tick,
            now=False,
        )
        return number

    def send(self, link: Connection, now: int, *, promises: bool = False) -> None:
        """Send everything queued; now: a tick that the clock shows; promises: of what was sent so far, in between.

        BoardError.
        """
        transport = link.transport
        events = iter(self._new)
        event = next(events, None)
        self._runs.sort(key=lambda entry: entry[0])
        for k, (due, motor, run) in enumerate(self._runs):
            if promises and k % PROMISED == PROMISED - 1:
                transport.send(link.command("cert_commit", clock=(due - 1) & _WORD), due, now=False)
            while event is not None and event[0] <= due:
                self._send_event(link, event)
                event = next(events, None)
            for message in self._run_commands(link, motor, run, now):
                run.message = transport.send(message, due, now=False)
        while event is not None:
            self._send_event(link, event)
            event = next(events, None)
        self._runs.clear()
        self._new.clear()

    def _send_event(self, link: Connection, queued: tuple[int, _Event, tuple[tuple[str, bool], ...]]) -> None:
        tick, event, switched = queued
        for name, on in switched:
            event.message = self.switch(link, name, on=on, tick=tick)
        self._sent.append(event)

    def _run_commands(self, link: Connection, motor: int, run: Run, now: int) -> Iterator[bytes]:
        ledger, pins = self._motors[motor], self._wiring.motors[motor]
        interval = run.interval
        if interval >= REBASE:
            if run.before > now:
                raise BoardError(f"motor {motor}: a run after a rest of {interval} ticks was sent before the rest")
            interval, run.base = FROM_BASE, run.due - FROM_BASE
            yield link.command("reset_step_clock", oid=motor, clock=run.base & _WORD)
        if run.direction != ledger.direction:
            ledger.direction = run.direction
            yield link.command(
                "set_next_step_dir", oid=motor, dir=int((run.direction > 0) is not pins.inverted_direction)
            )
        yield link.command("queue_step", oid=motor, interval=interval, count=run.count, add=run.add)

    def done(self, now: int, acknowledged: int) -> Iterator[EventDone]:
        """Events whose tick has passed and that the board has taken."""
        while self._sent and self._sent[0].done.tick <= now and self._sent[0].message <= acknowledged:
            yield self._sent.popleft().done
