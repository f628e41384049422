"""The board's clock as the host knows it: a line through readings, and bounds that hold.

A reading of the clock was made between the moment when the question was sent and the moment when the answer was there.
The board counts at its own rate: a crystal is off by up to 200 parts in a million, a ceramic resonator by 0.5 %. So
the line gives the best guess, and the bounds rest on the readings alone and on how far the rate may be off. The clock
has 32 bits; readings are at most 2**30 ticks apart, or are made with the high word. Source: Klipper's
MCU_Commands.md, ``get_clock``; ``get_uptime`` gives the high word.
"""

from __future__ import annotations

from collections import deque
from typing import NamedTuple

from gproof.backend.boards.board import BoardError
from gproof.ir.record import record

WORD = 1 << 32
DRIFT = 200e-6
"""How far the rate moves from what it was on average since the first reading."""

RATE_LIMIT = 0.01
"""How far a board's rate may be off what it states."""

DECAY = 1 / 30
"""Weight that a new reading has in the line at least."""

KEPT = 16
"""Readings that the bounds rest on."""


class Reading(NamedTuple):
    """A reading: host seconds when asked and when answered; the board's tick."""

    asked: float
    answered: float
    tick: int


class ClockError(BoardError):
    """The clock is not the one that it was: the board was reset, or is another."""


@record(frozen=True, slots=True)
class Steadiness:
    """How far a clock may be off: of what the board states, and from its own average; parts of one."""

    limit: float = RATE_LIMIT
    drift: float = DRIFT


CRYSTAL = Steadiness()
"""Of real boards. A simulation that shares its processor is less steady."""


class BoardClock:
    """The clock of a board that states ``frequency`` ticks a second."""

    def __init__(self, frequency: int, steadiness: Steadiness = CRYSTAL) -> None:
        self.frequency = frequency
        self._limit, self._drift = steadiness.limit, steadiness.drift
        self._readings: deque[Reading] = deque(maxlen=KEPT)
        self._first: Reading | None = None
        self._count = 0
        # Weighted means and moments of the line, in seconds and ticks since the first reading.
        self._mean_time = self._mean_tick = self._time_square = self._product = 0.0

    @property
    def last(self) -> Reading:
        """The latest reading."""
        return self._readings[-1]

    @property
    def known(self) -> bool:
        """Whether there is a reading."""
        return bool(self._readings)

    def read(self, asked: float, answered: float, tick: int) -> None:
        """Take a reading of all bits; ClockError when it is not of the clock that there was."""
        reading = Reading(asked, answered, tick)
        if self._first is None:
            self._first = reading
        elif tick < self.lower(asked, self._limit) or tick > self.upper(answered, self._limit):
            raise ClockError(
                f"the board's clock shows {tick} and not {self.lower(asked)} to {self.upper(answered)}: "
                "it was reset, or runs at another rate than it states"
            )
        self._readings.append(reading)
        self._fit(reading)

    def read_word(self, asked: float, answered: float, word: int) -> None:
        """Take a reading of the lower 32 bits, at most 2**30 ticks after the one before; ClockError."""
        guess = (self.lower(asked) + self.upper(answered)) // 2
        self.read(asked, answered, self.widened(word, guess))

    def widened(self, word: int, near: int) -> int:
        """The tick nearest to ``near`` whose lower 32 bits are these."""
        off = (word - near) % WORD
        return near + (off - WORD if off >= WORD // 2 else off)

    def stale(self, now: float) -> bool:
        """Whether the lower 32 bits alone are not enough any more."""
        return (now - self.last.answered) * self.frequency > 1 << 30

    def _fit(self, reading: Reading) -> None:
        """A decayed least-squares line through the middles of the readings."""
        assert self._first is not None
        self._count += 1
        seconds = (reading.asked + reading.answered) / 2 - self._first.asked
        ticks = reading.tick - self._first.tick
        weight = max(DECAY, 1 / self._count)
        time_off, tick_off = seconds - self._mean_time, ticks - self._mean_tick
        self._mean_time += weight * time_off
        self._mean_tick += weight * tick_off
        self._time_square = (1 - weight) * (self._time_square + weight * time_off * time_off)
        self._product = (1 - weight) * (self._product + weight * time_off * tick_off)

    @property
    def rate(self) -> float:
        """Ticks a second: of the line, within what the readings allow."""
        low, high = self.rates()
        guess = self._product / self._time_square if self._time_square > 0 else float(self.frequency)
        return min(max(guess, low), high)

    def rates(self) -> tuple[float, float]:
        """The least and greatest rate that the clock can have from the last reading on, ticks a second."""
        low, high = self.frequency * (1 - self._limit), self.frequency * (1 + self._limit)
        if self._first is not None and self._count > 1:
            ticks = self.last.tick - self._first.tick
            longest, shortest = self.last.answered - self._first.asked, self.last.asked - self._first.answered
            if longest > 0:
                low = max(low, ticks / longest * (1 - self._drift))
            if shortest > 0:
                high = min(high, ticks / shortest * (1 + self._drift))
        return low, max(low, high)

    def lower(self, now: float, slack: float = 0.0) -> int:
        """A tick that the clock shows already at host second ``now``."""
        rate = self.rates()[0] * (1 - slack)
        return max(r.tick + int((now - r.answered) * rate) - 1 if now >= r.answered else r.tick - 1 - int(
            (r.answered - now) * self.frequency * (1 + self._limit + slack)) for r in self._readings)  # fmt: skip

    def upper(self, now: float, slack: float = 0.0) -> int:
        """A tick that the clock does not show yet at host second ``now``."""
        rate = self.rates()[1] * (1 + slack)
        return min(r.tick + int(max(0.0, now - r.asked) * rate) + 2 for r in self._readings)

    def host_second(self, tick: int) -> float:
        """The host second at which ``lower`` reaches a tick."""
        rate = self.rates()[0]
        return min(r.answered + (tick + 2 - r.tick) / rate for r in self._readings)
