"""Steps of boards without hardware: whole runs consumed by arithmetic, exact to the tick.

``rings[motor, place]`` holds (interval, count, add, direction); ``state[motor]`` the columns below.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from gproof.ir.kernel import kernel

HEAD = 0  # place of the oldest run in the ring
SIZE = 1  # runs in the ring
DONE = 2  # steps done of the oldest run
LAST = 3  # tick from which the next interval counts: the last step, or the section's start
TAIL = 4  # tick of the last step queued
POSITION = 5
STEPS = 6  # pulses given
RUNS = 7  # runs finished
EDGE = 8  # tick of the last pulse, whatever section it belonged to
FACING = 9  # direction of the last pulse, 0 before the first
SHORTEST = 10  # shortest time between two pulses, 0 before there are two
OVERLAPS = 11
SETUPS = 12
FIELDS = 13

Ints = npt.NDArray[np.int64]


@kernel(seconds_per_unit=2e-6, compile_seconds=1.0)
def steps_due(first: int, add: int, count: int, span: int) -> int:
    """How many of ``count`` steps, the first after ``first`` ticks, fall within ``span`` ticks."""
    if span < first:
        return 0
    if count * first + add * (count * (count - 1) // 2) <= span:
        return count
    low = 1
    high = count
    while high - low > 1:
        middle = (low + high) // 2
        if middle * first + add * (middle * (middle - 1) // 2) <= span:
            low = middle
        else:
            high = middle
    return low


@kernel(seconds_per_unit=1e-6, compile_seconds=1.0)
def below(first: int, add: int, count: int, limit: int) -> int:
    """How many of ``count`` intervals first, first + add, ... are shorter than ``limit``."""
    if count <= 0:
        return 0
    if add < 0:
        first = first + add * (count - 1)
        add = -add
    if first >= limit:
        return 0
    if add == 0:
        return count
    return min(count, (limit - first + add - 1) // add)


@kernel(seconds_per_unit=6e-6, compile_seconds=3.0)
def advance(rings: Ints, state: Ints, until: int, pulse_gap: int, setup: int) -> None:
    """Give every pulse due at or before ``until`` and measure: intervals, overlaps, direction set-up."""
    for m in range(rings.shape[0]):
        depth = rings.shape[1]
        while state[m, SIZE] > 0:
            head = state[m, HEAD]
            done = state[m, DONE]
            add = rings[m, head, 2]
            first = rings[m, head, 0] + add * done
            count = rings[m, head, 1] - done
            direction = rings[m, head, 3]
            last = state[m, LAST]
            k = steps_due(first, add, count, until - last)
            if k == 0:
                break
            facing = state[m, FACING]
            if facing != 0:
                gap = last + first - state[m, EDGE]
                shortest = gap
                if facing != direction and gap < setup:
                    state[m, SETUPS] += 1
                if gap < pulse_gap:
                    state[m, OVERLAPS] += 1
            else:
                shortest = state[m, SHORTEST]
            if k > 1:
                inner = min(first + add, first + add * (k - 1))
                shortest = inner if shortest == 0 else min(shortest, inner)
                state[m, OVERLAPS] += below(first + add, add, k - 1, pulse_gap)
            if shortest > 0 and (state[m, SHORTEST] == 0 or shortest < state[m, SHORTEST]):
                state[m, SHORTEST] = shortest
            state[m, LAST] = last + k * first + add * (k * (k - 1) // 2)
            state[m, EDGE] = state[m, LAST]
            state[m, FACING] = direction
            state[m, POSITION] += k * direction
            state[m, STEPS] += k
            if k < count:
                state[m, DONE] = done + k
                break
            state[m, DONE] = 0
            state[m, HEAD] = (head + 1) % depth
            state[m, SIZE] -= 1
            state[m, RUNS] += 1
