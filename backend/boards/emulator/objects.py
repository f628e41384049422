"""What a board is configured with besides motors: outputs, limit inputs, triggers. Ticks as in ``motors``."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field

from gproof.backend.boards.emulator.motors import Motor, Refused
from gproof.backend.boards.emulator.wire import signed

QUICKEST = 320
"""Ticks between two samples or reports that a chip can keep up with."""

MISSED = "Missed scheduling of next digital out event"


@dataclass(slots=True)
class Output:
    """An output pin. safe: its level in a shutdown; most: ticks that it may have another without news, 0: for ever."""

    pin: int
    value: int
    safe: int
    most: int
    queue: deque[tuple[int, int]] = field(default_factory=deque)
    deadline: int | None = None

    def schedule(self, now: int, clock: int, value: int) -> None:
        """Change to a value at a clock; Refused where that has passed or is before a change that is queued."""
        due = now + signed(clock - now)
        if due <= now or (self.queue and due < self.queue[-1][0]):
            raise Refused("Timer too close")
        self.queue.append((due, value))

    def due(self) -> int | None:
        """The tick of the next change, or by which there has to be one."""
        if self.queue:
            return self.queue[0][0] if self.deadline is None else min(self.queue[0][0], self.deadline)
        return self.deadline

    def set(self, now: int, value: int) -> None:
        """Change now."""
        self.value = value
        self.deadline = now + self.most if self.most and value != self.safe else None


@dataclass(slots=True)
class Trigger:
    """What stops motors: by an input, by the host, or when the host is silent for too long."""

    oid: int
    motors: list[Motor] = field(default_factory=list)
    can: bool = False
    reason: int = 0
    report_at: int | None = None
    report_every: int = 0
    expires: int | None = None
    expire_reason: int = 0

    def due(self) -> int | None:
        """The tick of the next report or of the end of patience."""
        if self.report_at is None or self.expires is None:
            return self.expires if self.report_at is None else self.report_at
        return min(self.report_at, self.expires)


@dataclass(slots=True)
class Endstop:
    """A limit input. at: tick of the next sample, None: nobody asked; left: samples that still have to agree."""

    pin: int
    pull_up: int
    at: int | None = None
    every: int = 0
    sample: int = 0
    count: int = 0
    left: int = 0
    wanted: int = 0
    first: int = 0
    fired: int = 0
    trigger: Trigger | None = None
    reason: int = 0

    def take(self, level: int) -> bool:
        """A sample; True: enough agreed, it fires."""
        assert self.at is not None
        tick = self.at
        if level != self.wanted:
            self.left = self.count
            # A sample that disagrees goes back to the slow pace, counted from the first that agreed.
            self.at = (self.first if self.first else tick) + self.every
            if self.at <= tick:
                self.at = tick + self.every
            self.first = 0
            return False
        if self.left == self.count:
            self.first = tick
        self.left -= 1
        if self.left <= 0:
            self.fired, self.at = self.first + self.every, None
            return True
        self.at = tick + max(1, self.sample)
        return False


@dataclass(frozen=True, slots=True)
class Switch:
    """A limit switch: its pin has ``level`` where the motor of ``step_pin`` is at or beyond ``position``.

    above: beyond is upwards. position: of the mechanics: steps since the emulator was started, whatever was reset.
    """

    pin: int
    step_pin: int
    above: bool
    position: int
    level: int = 1
