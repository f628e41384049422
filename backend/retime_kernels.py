"""Runs for step ticks that have little room: each step may be anywhere in its own window.

Within a window any tick is as good as another (the caller made windows that keep order, shortest
intervals and direction set-up), so a run is as long as some (interval, add) passes through all windows.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from gproof.ir.kernel import kernel

Ints = npt.NDArray[np.int64]

LONGEST_RUN = 65_535


@kernel(seconds_per_unit=1e-6, compile_seconds=1.5)
def reach(low: Ints, high: Ints, begin: int, end: int, last: int, add: int) -> tuple[int, int, int]:
    """Steps from ``begin`` that one run with this ``add`` can hold; an interval for it; where it failed.

    The third value is +1 when a greater ``add`` may reach further, -1 a smaller one, 0 neither.
    Step k of the run is at last + k*interval + add*k*(k-1)/2, its window is low..high.
    """
    floor = 1
    ceiling = high[begin] - last
    k = 0
    missed = 0
    while begin + k < end:
        bent = last + add * (k * (k + 1) // 2)
        n = k + 1
        least = max(floor, -((bent - low[begin + k]) // n))
        if add < 0:
            least = max(least, 1 - add * k)
        most = min(ceiling, (high[begin + k] - bent) // n)
        if least > most:
            if ceiling * n + bent < low[begin + k]:
                missed = 1
            elif floor * n + bent > high[begin + k]:
                missed = -1
            break
        floor = least
        ceiling = most
        k = n
    return k, (floor + ceiling) // 2, missed


@kernel(seconds_per_unit=2e-5, compile_seconds=3.0)
def fit(low: Ints, high: Ints, direction: npt.NDArray[np.int8], last: int, out: Ints) -> int:
    """Write (interval, count, add, direction) rows that pass through all windows to ``out``; how many.

    ``last``: tick of the step before the first one. ``out`` has a row for every step, in case.
    """
    size = len(low)
    begin = 0
    turn = 0
    rows = 0
    while begin < size:
        facing = direction[begin]
        if turn <= begin:
            turn = begin + 1
            while turn < size and direction[turn] == facing:
                turn += 1
        end = min(turn, begin + LONGEST_RUN)
        best = 1
        interval = (low[begin] + high[begin]) // 2 - last
        add = 0
        if end - begin > 1:
            least = low[begin + 1] - last - 2 * (high[begin] - last)
            most = high[begin + 1] - last - 2 * (low[begin] - last)
            while least <= most:
                middle = (least + most) // 2
                count, first, missed = reach(low, high, begin, end, last, middle)
                if count > best:
                    best = count
                    interval = first
                    add = middle
                if missed > 0:
                    least = middle + 1
                elif missed < 0:
                    most = middle - 1
                else:
                    break
        if best == 1:
            add = 0
        out[rows, 0] = interval
        out[rows, 1] = best
        out[rows, 2] = add
        out[rows, 3] = facing
        rows += 1
        last += best * interval + add * (best * (best - 1) // 2)
        begin += best
    return rows
