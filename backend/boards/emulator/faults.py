"""Faults on request: a schedule, a line each, and noise on the line. Seeded: the same again for the same seed.

A schedule's line is a moment and a fault; ``#`` starts a comment. Moments are seconds since the start, or after the
first run was queued (``motion+0.25``)::

    0.5         drop to-board 3       the next 3 bytes are lost
    0.6         flip to-host 1        one bit of each of the next n bytes
    0.7         double to-board 2     each of the next n bytes comes twice
    0.8         delay to-host 0.05    what comes from now on comes so many seconds late, in order
    motion+0.1  close 0.5             the link is closed, and open again after so many seconds
    motion+0.2  stall 0.3             the chip's main loop takes nothing from the line; its timers go on
    motion+0.3  shutdown              the chip shuts down by itself
    motion+0.3  reset                 the chip starts again: clock 0, nothing configured
    motion+0.4  brown-out 0.2         the same, and it is without power for so many seconds first
"""

from __future__ import annotations

import random
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass

from gproof.backend.boards.emulator.clock import SECOND

TO_BOARD, TO_HOST = "to-board", "to-host"
BYTES = ("drop", "flip", "double")
TIMED = ("close", "stall", "brown-out")
PLAIN = ("shutdown", "reset")
MOST_LINES = 100_000
LONGEST = 1e6


@dataclass(frozen=True, slots=True)
class Fault:
    """at: nanoseconds since the start, or after motion began; amount: bytes, or nanoseconds."""

    at: int
    motion: bool
    kind: str
    amount: int = 0
    to: str = ""


def parsed(text: str) -> list[Fault]:
    """A schedule, in order of time; ValueError with the line's number."""
    faults: list[Fault] = []
    for number, line in enumerate(text.splitlines(), 1):
        words = line.partition("#")[0].split()
        if not words:
            continue
        if len(faults) >= MOST_LINES:
            raise ValueError(f"a schedule has at most {MOST_LINES} faults")
        try:
            faults.append(_fault(words))
        except (ValueError, IndexError):
            raise ValueError(f"line {number}: no fault: {' '.join(words)[:60]}") from None
    return sorted(faults, key=lambda fault: fault.at)


def _seconds(word: str) -> int:
    value = float(word)
    if not 0 <= value <= LONGEST:
        raise ValueError
    return round(value * SECOND)


def _fault(words: Sequence[str]) -> Fault:
    motion = words[0].startswith("motion+")
    at, kind = _seconds(words[0].removeprefix("motion+")), words[1]
    length = 4 if kind in BYTES or kind == "delay" else 3 if kind in TIMED else 2
    if len(words) != length:
        raise ValueError
    if kind in TIMED:
        return Fault(at, motion, kind, _seconds(words[2]))
    if kind in PLAIN:
        return Fault(at, motion, kind)
    if words[2] not in (TO_BOARD, TO_HOST) or kind not in (*BYTES, "delay"):
        raise ValueError
    amount = _seconds(words[3]) if kind == "delay" else int(words[3])
    if amount < 0:
        raise ValueError
    return Fault(at, motion, kind, amount, words[2])


@dataclass(frozen=True, slots=True)
class Noise:
    """How likely a byte is lost, has a bit flipped or comes twice, and a burst of ``burst`` bytes is lost."""

    drop: float = 0.0
    flip: float = 0.0
    double: float = 0.0
    bursts: float = 0.0
    burst: int = 20

    @property
    def any(self) -> bool:
        """Whether there is some."""
        return bool(self.drop or self.flip or self.double or self.bursts)


QUIET = Noise()


def noise(text: str) -> Noise:
    """``drop=1e-4,flip=1e-4,bursts=1e-5,burst=30``; ValueError."""
    values: dict[str, float] = {}
    for part in filter(None, text.split(",")):
        name, _, value = part.partition("=")
        if name not in ("drop", "flip", "double", "bursts", "burst") or name in values:
            raise ValueError(f"noise: {part[:40]!r} is not drop, flip, double, bursts or burst with a number")
        values[name] = float(value)
        if not 0 <= values[name] <= (10_000 if name == "burst" else 1):
            raise ValueError(f"noise: {part[:40]!r} is out of range")
    burst = int(values.pop("burst", 20))
    return Noise(**values, burst=burst)


class Wire:
    """What happens to bytes in one direction."""

    def __init__(self, to: str, noise: Noise, seed: int) -> None:
        self._noise = noise
        self._random = random.Random(f"{to} {seed}")
        self._pending: deque[list[str | int]] = deque()
        self.late = 0  # nanoseconds that everything is late from now on

    def add(self, fault: Fault) -> None:
        """A fault that has come up."""
        if fault.kind == "delay":
            self.late = fault.amount
        elif fault.amount:
            self._pending.append([fault.kind, fault.amount])

    def through(self, data: bytes) -> bytes:
        """What arrives of bytes."""
        if not self._pending and not self._noise.any:
            return data
        made = bytearray()
        for byte in data:
            kind = self._kind()
            if kind == "drop":
                continue
            if kind == "flip":
                byte ^= 1 << self._random.randrange(8)
            made.append(byte)
            if kind == "double":
                made.append(byte)
        return bytes(made)

    def _kind(self) -> str:
        if self._pending:
            first = self._pending[0]
            left = int(first[1]) - 1
            if left:
                first[1] = left
            else:
                self._pending.popleft()
            return str(first[0])
        if not self._noise.any:
            return ""
        chance, noise = self._random.random(), self._noise
        for kind, share in (("drop", noise.drop), ("flip", noise.flip), ("double", noise.double)):
            if chance < share:
                return kind
            chance -= share
        if chance < noise.bursts:
            self._pending.append(["drop", max(1, noise.burst - 1)])
            return "drop"
        return ""
