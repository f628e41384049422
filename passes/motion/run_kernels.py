"""Steps of one motor into runs (interval, count, add): ``bounds`` says how far each step may move, ``compress`` covers
the steps with runs. docs/stream.md states the rules that are kept here.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from gproof.ir.kernel import kernel

Ints = npt.NDArray[np.int64]
Signs = npt.NDArray[np.int8]

MOST_COUNT = 65535
MOST_ADD = 32767
"""A run's count and add fit the u16 and i16 of common boards."""

# The encoder while the section is walked: last step as encoded, its direction.
E_TICK, E_SIGN = 0, 1
ENCODER_WIDTH = 4


@kernel(seconds_per_unit=1.2e-6, compile_seconds=0.3)
def bounds(
    ticks: Ints, signs: Signs, count: int, before: int, tolerance: int, near: int, turn: int, floor: int, ceiling: int,
    low: Ints, high: Ints,
) -> None:  # fmt: skip
    """Where each step may go: low, high (count,), so that the steps can always be placed ``near`` or ``turn`` apart.

    before: tick of the step before the first; floor, ceiling: no step moves before or after these, unless it is
    there. A step moves by 9/20 of the shorter of the two intervals next to it, and by ``tolerance``, at most.
    """
    later = 0
    for k in range(count - 1, -1, -1):
        tick = int(ticks[k])
        gap = tick - (int(ticks[k - 1]) if k > 0 else before)
        after = tolerance * 3
        if k + 1 < count:
            after = int(ticks[k + 1]) - tick
        room = min(tolerance, min(gap, after) * 9 // 20)
        low[k] = max(tick - room, min(floor, tick))
        most = min(tick + room, max(ceiling, tick))
        if k + 1 < count:
            most = min(most, later - (near if signs[k + 1] == signs[k] else turn))
        high[k] = most
        later = most


@kernel(seconds_per_unit=1e-6)
def adds(low: Ints, high: Ints, at: int, base: int, n: int) -> tuple[int, int]:
    """Least and most ``add`` with which a run from ``base`` could meet its n-th step and the one that binds it most.

    Between two parabolas through the same point that stay within the same bounds up to n, the difference is
    largest when they meet the bounds at n and at (sqrt(2) - 1) n.
    """
    m = max(1, int(n * 0.41421356 + 0.5))
    least = (low[at + n - 1] - base) / n - (high[at + m - 1] - base) / m
    most = (high[at + n - 1] - base) / n - (low[at + m - 1] - base) / m
    return math.ceil(2.0 * least / (n - m) - 1e-9), math.floor(2.0 * most / (n - m) + 1e-9)


@kernel(seconds_per_unit=1e-6)
def fit(low: Ints, high: Ints, at: int, base: int, n: int, add: int, gap: int, near: int) -> tuple[int, int, int]:
    """The longest run of at most n steps with this ``add``: its count, and the least and most interval of it.

    gap: least first interval; near: least interval of the others.
    """
    least = max(gap, low[at] - base)
    most = max(least, high[at] - base)
    shift = 0
    for k in range(2, n + 1):
        shift += add * (k - 1)
        early = low[at + k - 1] - base - shift
        late = high[at + k - 1] - base - shift
        up, down = least, most
        if up * k < early:
            up = -(-early // k)
        if down * k > late:
            down = late // k
        up = max(up, near - add * (k - 1))
        if up > down:
            return k - 1, least, most
        least, most = up, down
    return n, least, most


@kernel(seconds_per_unit=1e-6, compile_seconds=1.0)
def compress(
    ticks: Ints, signs: Signs, low: Ints, high: Ints, count: int, final: bool, near: int, turn: int, encoder: Ints,
    runs: Ints, filled: int,
) -> tuple[int, int]:  # fmt: skip
    """Cover steps with runs, each step within low..high; returns (steps covered, runs now).

    ticks: exact times, of which a run's last step is kept close; final: nothing comes after these steps,
    otherwise the last ones, which a longer run could still cover, are left for the next call; encoder: see E_*;
    runs: (n, 4) interval, count, add, direction. Stops early when ``runs`` is full.
    """
    at = 0
    same = 0
    while at < count and filled < len(runs) and (final or count - at > MOST_COUNT + 1):
        sign = int(signs[at])
        if same <= at:
            same = at + 1
            while same < count and signs[same] == sign:
                same += 1
        longest = min(same - at, MOST_COUNT)
        base = int(encoder[E_TICK])
        gap = near if int(encoder[E_SIGN]) == sign else turn

        # How long a run can be, and with which adds: as far as two points of it tell.
        good, bad, n = 1, longest + 1, 2
        first, last = -MOST_ADD, MOST_ADD
        while bad - good > 1 + good // 16:
            n = min(n, bad - 1)
            least, most = adds(low, high, at, base, n)
            least, most = max(least, first), min(most, last)
            if least > most:
                bad = n
                n = (good + bad) // 2
            else:
                good, first, last = n, least, most
                n = 2 * n if bad > longest else (good + bad) // 2

        # The adds that are left, tried on every step, from the middle outwards.
        best, best_add = 0, 0
        best_least, best_most = 1, 0
        middle = (first + last) // 2
        for k in range(5):
            add = middle + (k + 1) // 2 * (1 if k % 2 == 1 else -1)
            if first <= add <= last and best < longest:
                reach, least, most = fit(low, high, at, base, longest, add, gap, near)
                if reach > best:
                    best, best_add, best_least, best_most = reach, add, least, most
        shift = best_add * (best * (best - 1) // 2)
        wish = (2 * (int(ticks[at + best - 1]) - base - shift) + best) // (2 * best)
        interval = min(max(wish, best_least), best_most)
        runs[filled, 0] = interval
        runs[filled, 1] = best
        runs[filled, 2] = best_add
        runs[filled, 3] = sign
        filled += 1
        encoder[E_TICK] = base + interval * best + shift
        encoder[E_SIGN] = sign
        at += best
    return at, filled
