"""Whether motors ever step faster together than a board's processor takes: step by step, in the order of the ticks.

Each step is worth ``frequency``, and every tick takes ``rate`` away: a level is the greatest excess of steps over the
rate in any time that ends now. ``places[motor]`` to ``places[motor + 1]`` are the rows of a motor's runs.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from gproof.ir.kernel import kernel

TICK, MOTOR, BEGIN, STEPS = 0, 1, 2, 3
"""Of ``found``: the step that is too many, its motor (-1: of all together), and where the crowded time begins and how
many steps are in it."""

Ints = npt.NDArray[np.int64]


@kernel(seconds_per_unit=3e-6, compile_seconds=2.0)
def crowded(
    interval: Ints, count: Ints, add: Ints, places: Ints, rate: int, frequency: int, state: Ints, found: Ints
) -> bool:
    """True when there is such a step; state: 7 columns a motor and one row for all, of zeros."""
    motors = places.shape[0] - 1
    longest = 16 * frequency  # ticks after which no level is left, so that no product grows without bound
    slack = frequency // 4
    # Columns: 0 row of the run, 1 steps of it made, 2 next tick, 3 level, 4 tick of the last step, 5 begin, 6 steps.
    for m in range(motors):
        state[m, 0] = places[m]
        if places[m] < places[m + 1]:
            state[m, 2] = interval[places[m]]
    while True:
        chosen = -1
        for m in range(motors):
            if state[m, 0] < places[m + 1] and (chosen < 0 or state[m, 2] < state[chosen, 2]):
                chosen = m
        if chosen < 0:
            return False
        now = state[chosen, 2]
        for turn in range(2):
            at = chosen if turn == 0 else motors
            passed = min(now - state[at, 4], longest)
            level = state[at, 3] - passed * rate
            if level <= 0:
                level = 0
                state[at, 5] = now
                state[at, 6] = 0
            level += frequency
            state[at, 3] = level
            state[at, 4] = now
            state[at, 6] += 1
            most = frequency if turn == 0 else frequency * motors
            if level > most + slack:
                found[0] = now
                found[1] = chosen if turn == 0 else -1
                found[2] = state[at, 5]
                found[3] = state[at, 6]
                return True
        row = state[chosen, 0]
        state[chosen, 1] += 1
        if state[chosen, 1] < count[row]:
            state[chosen, 2] = now + interval[row] + add[row] * state[chosen, 1]
        else:
            state[chosen, 0] = row + 1
            state[chosen, 1] = 0
            if row + 1 < places[chosen + 1]:
                state[chosen, 2] = now + interval[row + 1]
