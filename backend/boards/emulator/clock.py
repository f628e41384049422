"""The board's crystal: which tick the clock shows at a nanosecond of the world; whole numbers, exact.

The rate is off by ``drift`` and, second by second, by up to ``wander`` more, both in parts in a thousand million.
"""

from __future__ import annotations

import random

SECOND = 10**9
_UNIT = 10**18
"""Parts of a tick that are counted: so a rate in parts in a thousand million is whole."""


class Clock:
    """Ticks since the last reset, not cut to 32 bits. start: what it shows at nanosecond ``at``."""

    def __init__(self, frequency: int, *, drift: int = 0, wander: int = 0, seed: int = 0, start: int = 0) -> None:
        self._frequency = frequency
        self._drift = drift
        self._wander = wander
        self._random = random.Random(f"clock {seed}")
        self._since = 0
        self._shown = start * _UNIT
        self._rate = self._next_rate()

    def _next_rate(self) -> int:
        off = self._random.randint(-self._wander, self._wander) if self._wander else 0
        return self._frequency * (SECOND + self._drift + off)

    def restart(self, at: int) -> None:
        """The clock shows 0 at a nanosecond."""
        self._since, self._shown = at, 0

    def tick(self, at: int) -> int:
        """The tick shown at a nanosecond; moments may not go back by more than the last second."""
        if self._wander:
            while at - self._since >= SECOND:
                self._shown += SECOND * self._rate
                self._since += SECOND
                self._rate = self._next_rate()
        return (self._shown + (at - self._since) * self._rate) // _UNIT

    def when(self, tick: int) -> int:
        """The first nanosecond at which the clock shows a tick, at the present rate."""
        return self._since - (self._shown - tick * _UNIT) // self._rate
