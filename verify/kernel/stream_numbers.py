"""The stream's own integers: whether they can be added up, and what they come to.

Problems are tuples of a kind and its numbers.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from fractions import Fraction
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from gproof.ir.columns import Columns, batches, joined
from gproof.ir.stream import EVENT, RUN, StepStream

FEW = 1 << 52
LONG = 1 << 60
"""Steps and ticks that are never reached."""

TOUCH = Fraction(1, 10**6)
"""What a float64 adds to a round number does not count."""

Why = tuple[Any, ...]
"""A kind of problem and its numbers."""

Floats = npt.NDArray[np.float64]


def ticks_up(seconds: Fraction, tick_frequency: int) -> int:
    """Whole ticks that last at least ``seconds``."""
    return max(0, math.ceil(seconds * tick_frequency - TOUCH))


def number_problems(stream: StepStream) -> Iterator[Why]:
    """What keeps a stream's integers from being added up safely."""
    if not 1 <= stream.tick_frequency <= 10**12:
        yield "form.tick-frequency", stream.tick_frequency
    for begin, end in batches([sum(map(len, s.runs)) for s in stream.sections]):
        if not _numbers_fit(stream, begin, end):
            for place in range(begin, end):
                yield from _number_problems(stream, place)


def _numbers_fit(stream: StepStream, begin: int, end: int) -> bool:
    """True only where ``_number_problems`` finds nothing in any of these sections."""
    sections = stream.sections[begin:end]
    if any(_section_problem(stream, place) for place in range(begin, end)):
        return False
    tables = [r for s in sections for r in s.runs if len(r)]
    if not tables:
        return True
    interval, count, add, good = _good_runs(joined(RUN, tables))
    if not good.all():
        return False
    first = np.cumsum([0, *(len(r) for r in tables)])[:-1]
    ticks = np.add.reduceat(count * interval + add * (count - 1) * count / 2, first)
    # Sums of doubles come to the same within far less than this factor, in whatever order.
    return bool((np.add.reduceat(count, first) < FEW / 2).all() and (ticks < LONG / 2).all())


def _good_runs(runs: Columns) -> tuple[Floats, Floats, Floats, npt.NDArray[np.bool_]]:
    """Intervals, counts and what is added, as doubles; which runs can be added up."""
    interval, count, add = (runs[k].astype(np.float64) for k in ("interval", "count", "add"))
    grown = add * (count - 1)
    good = (interval >= 1) & (count >= 1) & (np.abs(grown) < FEW) & (interval + grown >= 1)
    good &= (interval * count < LONG) & (np.abs(grown) * count < LONG)
    good &= np.abs(runs["direction"]) == 1
    return interval, count, add, good


def _section_problem(stream: StepStream, place: int) -> Why:
    """What is wrong with a section apart from its runs' numbers; () for nothing."""
    s, motors = stream.sections[place], len(stream.motors)
    if len(s.start) != motors or len(s.runs) != motors:
        return "form.one-for-each-motor", s.number
    if s.events.schema is not EVENT or any(r.schema is not RUN for r in s.runs):
        return "form.table", s.number
    if any(abs(n) > FEW for n in s.start) or not 0 <= s.duration < LONG:
        return "form.start", s.number, s.start, s.duration
    return ("form.section-place", s.number, place) if s.number != place else ()


def _number_problems(stream: StepStream, place: int) -> Iterator[Why]:
    s = stream.sections[place]
    if s.number != place:
        yield "form.section-place", s.number, place
    wrong = _section_problem(stream, place)
    if wrong and wrong[0] != "form.section-place":
        yield wrong
        if wrong[0] != "form.start":
            return
    for motor, runs in zip(stream.motors, s.runs, strict=True):
        interval, count, add, good = _good_runs(runs)
        if not good.all():
            k = int(np.argmin(good))
            yield "form.run", s.number, k, motor.name, tuple(int(runs[c.name][k]) for c in RUN.columns)
        elif count.sum() > FEW or (count * interval + add * (count - 1) * count / 2).sum() > LONG:
            yield "form.too-long", s.number, motor.name


class Sums(NamedTuple):
    """By section and motor, as nested lists: steps made, and what they come to with their signs; first and last tick of
    a step, with their directions (0 where there is none)."""

    steps: list[list[int]]
    net: list[list[int]]
    first: list[list[int]]
    first_way: list[list[int]]
    last: list[list[int]]
    last_way: list[list[int]]


def sums_of(stream: StepStream) -> Sums:
    """Of a stream whose numbers can be added up."""
    shape = (len(stream.sections), len(stream.motors))
    steps, net, first, first_way, last, last_way = (np.zeros(shape, np.int64) for _ in range(6))
    for begin, end in batches([sum(map(len, s.runs)) for s in stream.sections]):
        tables = [r for s in stream.sections[begin:end] for r in s.runs]
        sizes = np.array([len(r) for r in tables], dtype=np.int64).reshape(end - begin, shape[1])
        if not sizes.any():
            continue
        runs = joined(RUN, tables)
        there = sizes > 0
        at = (np.cumsum(sizes) - sizes.ravel())[there.ravel()]
        until = at + sizes[there] - 1
        interval, count, add = runs["interval"], runs["count"], runs["add"]
        way = runs["direction"].astype(np.int64)
        steps[begin:end][there] = np.add.reduceat(count, at)
        net[begin:end][there] = np.add.reduceat(count * way, at)
        last[begin:end][there] = np.add.reduceat(interval * count + add * (count - 1) * count // 2, at)
        first[begin:end][there], first_way[begin:end][there] = interval[at], way[at]
        last_way[begin:end][there] = way[until]
    return Sums(*(array.tolist() for array in (steps, net, first, first_way, last, last_way)))
