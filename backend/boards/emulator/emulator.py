"""The emulator without a port: bytes in and out at nanoseconds of the world, the line's speed, faults, the chip.

The world's time is whatever the caller says, and never goes back. ``write`` gives bytes that the host sends now,
``advance`` lets time pass, ``taken`` gives what the host has received by then.
"""

from __future__ import annotations

import random
from collections import deque
from dataclasses import dataclass, replace

from gproof.backend.boards.emulator.chip import ChipState, World
from gproof.backend.boards.emulator.clock import SECOND, Clock
from gproof.backend.boards.emulator.dictionary import CHIPS, Language
from gproof.backend.boards.emulator.faults import QUIET, TO_BOARD, TO_HOST, Fault, Noise, Wire
from gproof.backend.boards.emulator.log import Log
from gproof.backend.boards.emulator.objects import Switch
from gproof.backend.boards.emulator.wire import Receiver, frame

BITS = 10
"""On the line for a byte: start, eight, stop."""

TO_SEND = 96
"""Bytes of answers that wait for the line; an answer that finds no room is lost, as on an AVR."""

BOOT = SECOND // 20
"""Nanoseconds from a reset until the chip listens."""

IN_FLIGHT = 1 << 16
"""Bytes on their way to the board that the emulator takes from a host."""


@dataclass(frozen=True, slots=True)
class Options:
    """What a board is like.

    frequency: Hz; drift, wander: parts in a thousand million; jitter: nanoseconds that an answer is late at most;
    window: bytes that it keeps while it is busy; busy: ticks of its main loop for a command; start: what its clock
    shows first.
    """

    chip: str = "atmega2560"
    frequency: int = 16_000_000
    certified: bool = True
    baud: int = 250_000
    window: int = 192
    busy: int = 0
    drift: int = 0
    wander: int = 0
    jitter: int = 0
    start: int = 0
    seed: int = 0
    noise: Noise = QUIET
    faults: tuple[Fault, ...] = ()
    switches: tuple[Switch, ...] = ()
    without: frozenset[str] = frozenset()


class Emulator:
    """See the module's text. ``connected``: the link is there; ``now``: nanoseconds."""

    def __init__(self, options: Options, log: Log | None = None) -> None:
        self.options = options
        self.log = log or Log()
        self.now = 0
        self.connected = True
        self._kind = replace(CHIPS[options.chip], frequency=options.frequency)
        self._language = Language(
            self._kind,
            certified=options.certified,
            baud=options.baud,
            window=options.window,
            without=options.without,
        )
        self._world = World(options.switches)
        self._clock = Clock(
            self._kind.frequency, drift=options.drift, wander=options.wander, seed=options.seed, start=options.start
        )
        self._byte = BITS * SECOND / options.baud
        self._jitter = random.Random(f"jitter {options.seed}")
        self._wires = {to: Wire(to, options.noise, options.seed) for to in (TO_BOARD, TO_HOST)}
        self._faults = deque(fault for fault in options.faults if not fault.motion)
        self._motion_faults = [fault for fault in options.faults if fault.motion]
        self._boots = 0
        self._open_at: int | None = None
        self._powered_at: int | None = None
        self._start_chip()
        self._chip.now = options.start

    # The chip.

    def _start_chip(self) -> None:
        self._chip = ChipState(self._kind, self._language, self.options.certified, self._world, self.log)
        self._receiver = Receiver(self.options.window)
        self._sequence = 0
        self._inbound: deque[tuple[float, float, bytes]] = deque()  # arrival of the first byte's end, apart, bytes
        self._inbound_bytes = 0
        self._line_free = float(self.now)
        self._outbound: deque[tuple[float, bytes]] = deque()
        self._send_free = float(self.now)
        self._busy_until = self.now
        self._boots += 1
        self.log.row(b"B", self.now)

    def _restart(self, off: int) -> None:
        """The chip loses its power, or is reset, for some nanoseconds."""
        self._chip.advance(self._clock.tick(self.now))
        self._chip.settle()
        outbound = self._outbound
        self._start_chip()
        self._outbound = outbound
        self._clock.restart(self.now + off)
        self._powered_at = self.now + off
        self._busy_until = self.now + off + BOOT

    @property
    def chip(self) -> ChipState:
        """The chip since its last reset."""
        return self._chip

    # The host's side.

    @property
    def room(self) -> int:
        """Bytes that may be written now."""
        return max(0, IN_FLIGHT - self._inbound_bytes)

    def write(self, data: bytes) -> None:
        """The host sends bytes; what is more than ``room`` is lost, and everything while there is no link."""
        if not self.connected:
            return
        wire = self._wires[TO_BOARD]
        arrived = wire.through(data)[: self.room]
        start = max(self.now + wire.late, self._line_free)
        self._line_free = start + len(data) * self._byte
        if arrived:
            apart = (self._line_free - start) / len(arrived)
            self._inbound.append((start + apart, apart, arrived))
            self._inbound_bytes += len(arrived)

    def taken(self) -> bytes:
        """What the host has received by now and not taken yet."""
        parts = []
        while self._outbound and self._outbound[0][0] <= self.now:
            parts.append(self._outbound.popleft()[1])
        return b"".join(parts)

    def next_received(self) -> int | None:
        """The nanosecond at which the host receives something next, of what is on its way."""
        return -int(-self._outbound[0][0] // 1) if self._outbound else None

    def set_input(self, pin: int, level: int) -> None:
        """Somebody pulls an input."""
        self._world.inputs[pin & 0xFF] = level

    # Time.

    def next_event(self) -> int | None:
        """The nanosecond of the next thing that happens if the host sends nothing more."""
        found = [at for at in (self._open_at,) if at is not None]
        if self._faults:
            found.append(self._faults[0].at)
        if (timer := self._chip.next_timer()) is not None and self._powered_at is None:
            found.append(self._clock.when(timer))
        if self._powered_at is not None:
            found.append(self._powered_at)
        if (listened := self._next_parsed()) is not None:
            found.append(listened)
        return max(self.now, min(found)) if found else None

    def _next_parsed(self) -> int | None:
        needs = self._receiver.needs
        if needs == 0:
            return self._busy_until
        for first, apart, data in self._inbound:
            if needs <= len(data):
                return max(self._busy_until, -int(-(first + (needs - 1) * apart) // 1))
            needs -= len(data)
        # The rest of it may never come; what is there already has to be kept, or lost, while the chip is busy.
        return None

    def advance(self, until: int, *, heard: bool = False) -> None:
        """Let time pass until a nanosecond; heard: only until the host has received something,
        or has no link any more."""
        while not heard or self.connected or self._outbound:
            at = self.next_event()
            received = self.next_received() if heard else None
            if received is not None and received <= until and (at is None or received <= at):
                self._pass(max(self.now, received))
                return
            if at is None or at > until:
                self._pass(max(self.now, until))
                return
            self._happen(at)

    def _pass(self, at: int) -> None:
        """Time passes in which nothing happens."""
        self.now = at
        self._chip.log_at = at
        if self._powered_at is None:
            self._chip.advance(self._clock.tick(at))
            self._collect()
        self._receive()

    def _happen(self, at: int) -> None:
        self._pass(at)
        if self._powered_at is not None and self._powered_at <= at:
            self._powered_at = None
            self._receiver.held.clear()
            self._answer(self._language.answer("starting"))
        if self._open_at is not None and self._open_at <= at:
            self._open_at, self.connected = None, True
            self.log.row(b"L", at, count=1)
        while self._faults and self._faults[0].at <= at:
            self._fault(self._faults.popleft())
        if at >= self._busy_until and self._powered_at is None and (block := self._receiver.next()) is not None:
            self._block(block.sequence, block.payload)

    def _receive(self) -> None:
        """Bytes that have arrived go into the chip's store; what finds no room is lost."""
        held = self._receiver.held
        while self._inbound:
            first, apart, data = self._inbound[0]
            if first > self.now:
                return
            count = len(data) if apart <= 0 else min(len(data), int((self.now - first) / apart) + 1)
            held += data[: max(0, min(count, self._receiver.room - len(held)))]
            self._inbound_bytes -= count
            if count < len(data):
                self._inbound[0] = (first + count * apart, apart, data[count:])
                return
            self._inbound.popleft()

    def _block(self, sequence: int, payload: bytes | None) -> None:
        if payload is None or sequence != self._sequence:
            self._answer()
            return
        self._sequence = sequence + 1 & 15
        began = self._chip.motion_began
        count = self._chip.block(payload)
        self._collect()
        self._answer()
        if self.options.busy:
            self._busy_until = self.now + count * self.options.busy * SECOND // self._kind.frequency
        if self._chip.motion_began and not began:
            self._schedule_motion_faults()
        if self._chip.wants_reset:
            self._restart(0)

    def _schedule_motion_faults(self) -> None:
        """Faults after motion began count from here, once."""
        more = [Fault(f.at + self.now, False, f.kind, f.amount, f.to) for f in self._motion_faults]
        self._motion_faults = []
        self._faults = deque(sorted([*self._faults, *more], key=lambda fault: fault.at))

    def _collect(self) -> None:
        answers = self._chip.answers
        while answers:
            self._answer(answers.pop(0))

    def _answer(self, payload: bytes = b"") -> None:
        """Send a block, if there is room for it."""
        data = frame(self._sequence, payload)
        start = max(float(self.now), self._send_free)
        if (start - self.now) / self._byte + len(data) > TO_SEND:
            return
        if self.options.jitter:
            start = max(start, self.now + self._jitter.randrange(self.options.jitter))
        self._send_free = start + len(data) * self._byte
        if self.connected:
            wire = self._wires[TO_HOST]
            if arrived := wire.through(data):
                late = max(self._send_free + wire.late, self._outbound[-1][0] if self._outbound else 0.0)
                self._outbound.append((late, arrived))

    # Faults.

    def _fault(self, fault: Fault) -> None:
        if fault.to:
            self._wires[fault.to].add(fault)
        elif fault.kind == "close":
            self.close_link(fault.amount)
        elif fault.kind == "stall":
            self._busy_until = max(self._busy_until, self.now + fault.amount)
        elif fault.kind == "shutdown":
            self._chip.shut_down("Requested by a fault schedule")
            self._collect()
        else:
            self._restart(fault.amount)

    def inject(self, fault: Fault) -> None:
        """A fault now."""
        self._fault(fault)

    def close_link(self, nanoseconds: int) -> None:
        """The link is gone for a time; what was on its way is lost."""
        self.connected = False
        self._open_at = self.now + nanoseconds
        self._inbound.clear()
        self._inbound_bytes = 0
        self._outbound.clear()
        self.log.row(b"L", self.now, count=0)

    def state(self) -> dict[str, object]:
        """What a harness may ask: the clock, the mechanics by step pin, why the chip is stopped, resets."""
        self._chip.settle()
        return {
            "now": self.now,
            "tick": self._chip.now,
            "mechanics": dict(self._world.mechanics),
            "stopped": self._chip.stop_reason,
            "boots": self._boots,
            "connected": self.connected,
        }

    def finish(self) -> None:
        """Put everything into the log."""
        self._chip.settle()
        self.log.flush()
