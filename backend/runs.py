"""Runs of one motor as tables: when they end, how to cut them, which steps they hold.

A run table is ``ir.stream.RUN``; ticks count from the section's start, and the first run's interval from
tick 0. Nothing here rounds: every cut gives exactly the same steps.
"""

from __future__ import annotations

from bisect import bisect_right

import numpy as np
import numpy.typing as npt

from gproof.ir.columns import Columns
from gproof.ir.record import record
from gproof.ir.stream import RUN, StreamSection

Ints = npt.NDArray[np.int64]


def table(interval: Ints, count: Ints, add: Ints, direction: npt.NDArray[np.int8]) -> Columns:
    """A run table over these columns."""
    return Columns(RUN, {"interval": interval, "count": count, "add": add, "direction": direction})


def spans(runs: Columns) -> Ints:
    """Ticks from the step before each run to its last step."""
    n = runs["count"]
    found: Ints = n * runs["interval"] + runs["add"] * (n * (n - 1) // 2)
    return found


def ends(runs: Columns) -> Ints:
    """The tick of each run's last step."""
    return np.cumsum(spans(runs), dtype=np.int64)


def steps_within(first: int, add: int, count: int, span: int) -> int:
    """How many of ``count`` steps, the first after ``first`` ticks, fall within ``span`` ticks.

    Step k is due after k*first + add*k*(k-1)/2 ticks, which grows with k because all intervals are positive.
    """
    return bisect_right(range(1, count + 1), span, key=lambda k: k * first + add * (k * (k - 1) // 2))


@record(frozen=True, slots=True)
class Done:
    """What a motor has done by a tick: steps, their sum with direction, tick of the last (0: none)."""

    steps: int
    net: int
    last: int


def done_by(runs: Columns, tick: int) -> Done:
    """Steps due at or before ``tick``."""
    end = ends(runs)
    whole = int(np.searchsorted(end, tick, side="right"))
    count, direction = runs["count"][:whole], runs["direction"][:whole].astype(np.int64)
    steps, net = int(count.sum()), int((count * direction).sum())
    last = int(end[whole - 1]) if whole else 0
    if whole < len(runs):
        first, add = int(runs["interval"][whole]), int(runs["add"][whole])
        k = steps_within(first, add, int(runs["count"][whole]), tick - last)
        steps += k
        net += k * int(runs["direction"][whole])
        last += k * first + add * (k * (k - 1) // 2)
    return Done(steps, net, last)


def step_tick(runs: Columns, number: int) -> int:
    """The tick of a step, counted from 1; there must be so many."""
    counted = np.cumsum(runs["count"])
    k = int(np.searchsorted(counted, number))
    n = number - int(counted[k] - runs["count"][k])
    before = int(spans(runs)[:k].sum())
    return before + n * int(runs["interval"][k]) + int(runs["add"][k]) * (n * (n - 1) // 2)


def position_at(section: StreamSection, tick: int) -> tuple[int, ...]:
    """Positions in steps when everything due at or before ``tick`` is done."""
    return tuple(s + done_by(r, tick).net for s, r in zip(section.start, section.runs, strict=True))


def cut(runs: Columns, tick: int) -> tuple[Columns, Columns, int]:
    """Runs with the steps up to ``tick``, runs with those after it, and the tick of the last step before.

    The first interval of the second table counts from that last step.
    """
    end = ends(runs)
    whole = int(np.searchsorted(end, tick, side="right"))
    before, after = runs.slice(0, whole), runs.slice(whole, len(runs))
    last = int(end[whole - 1]) if whole else 0
    if not len(after):
        return before, after, last
    first, add, n = (int(after[name][0]) for name in ("interval", "add", "count"))
    k = steps_within(first, add, n, tick - last)
    if not k:
        return before, after, last
    head, tail = _copy(after.slice(0, 1)), _copy(after)
    head["count"][0] = k
    tail["count"][0] = n - k
    tail["interval"][0] = first + k * add
    return join([before, head]), tail, last + k * first + add * (k * (k - 1) // 2)


def _copy(runs: Columns) -> Columns:
    return Columns(RUN, {name: a.copy() for name, a in runs.arrays.items()})


def join(parts: list[Columns]) -> Columns:
    """Tables below one another."""
    return Columns(RUN, {c.name: np.concatenate([p[c.name] for p in parts]) for c in RUN.columns})


def expand(runs: Columns, after: int = 0) -> tuple[Ints, npt.NDArray[np.int8]]:
    """The tick and direction of every step; ``after``: tick from which the first interval counts."""
    count = runs["count"]
    place = np.arange(int(count.sum()), dtype=np.int64) - np.repeat(np.cumsum(count) - count, count)
    intervals = np.repeat(runs["interval"], count) + place * np.repeat(runs["add"], count)
    return after + np.cumsum(intervals, dtype=np.int64), np.repeat(runs["direction"], count)
