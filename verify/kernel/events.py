"""From the sections' events to the walk's arrays; what is not the event of its row is refused here."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from fractions import Fraction
from typing import NamedTuple

import numpy as np

from gproof.ir.columns import joined, occurring
from gproof.ir.stream import EVENT, StepStream
from gproof.ir.trace import TRACE_ROW, Op, Trace
from gproof.verify.kernel.proof import Proof
from gproof.verify.kernel.stream_numbers import LONG, TOUCH, Why, ticks_up
from gproof.verify.kernel.walk_state import Events, Ints

EVENT_OPS = (
    Op.DWELL,
    Op.SPINDLE,
    Op.COOLANT,
    Op.TOOL_CHANGE,
    Op.OUTPUT,
    Op.INPUT_WAIT,
    Op.STOP,
    Op.HOME,
    Op.SETPOINT,
)
"""Rows that cost time or switch something: motion is at rest there, and each has one event."""

SWITCHES = np.zeros(256, np.bool_)
SWITCHES[list(EVENT_OPS)] = True
"""By op, whether it is one of these."""

_TOLD = 8
"""Problems of a kind that are reported about a section's order."""


class Pairs(NamedTuple):
    """Events that are in the order of their rows, with these, as lists; ticks, rows: for the kernel."""

    op: list[int]
    arg: list[list[float]]
    given: list[int]
    values: list[list[int]]
    ticks: Ints
    rows: Ints


def pairs_of(stream: StepStream, trace: Trace, begin: int, end: int) -> list[Pairs] | None:
    """Of each section, when all events are those of its rows, in order and within it; else None."""
    sections = trace.sections[begin:end]
    rows = joined(TRACE_ROW, [section.rows for section in sections])
    given = joined(EVENT, [section.events for section in stream.sections[begin:end]])
    first = np.cumsum([0, *(len(section.rows) for section in sections)])
    ends = np.cumsum([0, *(len(section.events) for section in stream.sections[begin:end])])
    switching = np.flatnonzero(SWITCHES[rows["op"]])
    of = np.searchsorted(first, switching, side="right") - 1
    wanted = switching - first[of]
    if not np.array_equal(np.searchsorted(switching, first), ends) or not np.array_equal(wanted, given["row"]):
        return None
    ticks = given["tick"].astype(np.int64)
    duration = np.array([section.duration for section in stream.sections[begin:end]], dtype=np.int64)
    if ((ticks < 0) | (ticks > duration[of])).any() or ((np.diff(ticks) < 0) & (of[1:] == of[:-1])).any():
        return None
    ops, args = rows["op"][switching].tolist(), rows["arg"][switching].tolist()
    codes, values = given["op"].tolist(), given["arg"].tolist()
    wanted = wanted.astype(np.int64)
    return [
        Pairs(ops[a:b], args[a:b], codes[a:b], values[a:b], ticks[a:b], wanted[a:b])
        for a, b in itertools.pairwise(ends.tolist())
    ]


def event_arrays(
    stream: StepStream, trace: Trace, number: int, spindle: int | None, ramp: float, pairs: Pairs | None, proof: Proof
) -> Events | None:
    """The section's events, when they are those of its rows. spindle: direction before the section, None: unknown;
    ramp: seconds; pairs: what ``pairs_of`` gave."""
    good = True

    def refuse(row: int, tick: int, kind: str, *values: object) -> None:
        nonlocal good
        good = False
        proof.refute("stream-event", kind, number, row, tick, *values)

    if pairs is None:
        if not _in_order(stream, trace, number, refuse):
            return None
        found = pairs_of(stream, trace, number, number + 1)
        assert found is not None
        pairs = found[0]
    still = np.zeros(len(pairs.op), np.int64)
    for k, (code, arg, given_code, values) in enumerate(
        zip(pairs.op, pairs.arg, pairs.given, pairs.values, strict=True)
    ):
        op = Op(code)
        why = _event_problem(op, arg, given_code, values)
        if why:
            refuse(int(pairs.rows[k]), int(pairs.ticks[k]), *why)
            continue
        seconds = Fraction(0)
        if op is Op.DWELL:
            seconds = Fraction(arg[0])
        elif op is Op.SPINDLE:
            direction = int(arg[0])
            if direction and direction != spindle:
                seconds = Fraction(ramp)
            spindle = direction
        if seconds:
            still[k] = min(LONG, ticks_up(seconds, stream.tick_frequency))
    if not good:
        return None
    return Events(tick=pairs.ticks, row=pairs.rows, still=still)


def _in_order(stream: StepStream, trace: Trace, number: int, refuse: Callable[..., None]) -> bool:
    """Whether a section's events are those of its rows, each once, in their order and within it."""
    section = stream.sections[number]
    wanted = np.flatnonzero(SWITCHES[trace.sections[number].rows["op"]])
    rows, ticks = section.events["row"], section.events["tick"].astype(np.int64)
    if not np.array_equal(wanted, rows):
        _order_problems(wanted.tolist(), rows.tolist(), ticks.tolist(), refuse)
        return False
    outside = (ticks < 0) | (ticks > section.duration)
    early = np.diff(ticks, prepend=ticks[:1]) < 0
    if outside.any():
        k = int(np.argmax(outside))
        refuse(int(wanted[k]), int(ticks[k]), "event.outside", section.duration)
    elif early.any():
        k = int(np.argmax(early))
        refuse(int(wanted[k]), int(ticks[k]), "event.early")
    return not (outside | early).any()


def _order_problems(wanted: list[int], given: list[int], ticks: list[int], refuse: Callable[..., None]) -> None:
    """Say which events are missing, doubled, strange or out of order."""
    for row in sorted(set(wanted) - set(given))[:_TOLD]:
        refuse(row, -1, "event.missing")
    seen: set[int] = set()
    told = 0
    known = set(wanted)
    for row, tick in zip(given, ticks, strict=True):
        if told < _TOLD and (row not in known or row in seen):
            refuse(row, tick, "event.again" if row in known else "event.no-row")
            told += 1
        seen.add(row)
    if sorted(given) == wanted:
        k = next(k for k, row in enumerate(given) if row != wanted[k])
        refuse(given[k], ticks[k], "event.order")


def _event_problem(op: Op, arg: list[float], given: int, values: list[int]) -> Why:
    """Why an event is not that of its row; () where it is."""
    if given != op:
        return "event.other", given, op
    if op is Op.SPINDLE and arg[0] == 0.0 and math.isnan(arg[1]):
        arg = [arg[0], values[1] / 1000]  # a spindle that stops needs no speed
    for value, thousandths in zip(arg, values, strict=True):
        if not math.isfinite(value):
            return "event.unknown", op
        whole = value == int(value) and int(value) * 1000 == thousandths
        if not whole and abs(Fraction(value) * 1000 - thousandths) > Fraction(1, 2) + TOUCH:
            return "event.value", op, thousandths, value
    if op is Op.DWELL and not 0 <= arg[0] < math.inf:
        return "event.dwell", arg[0]
    if op is Op.SPINDLE and arg[0] not in (-1.0, 0.0, 1.0):
        return "event.spindle", arg[0]
    return ()


def left_to_others(trace: Trace) -> tuple[str, ...]:
    """Commands of the trace that no event carries out."""
    found: dict[str, None] = {}
    for section in trace.sections:
        rows = section.rows
        devices = rows["op"] == Op.DEVICE
        for text in occurring(rows["text"][devices]) if devices.any() else ():
            found[trace.texts[text]] = None
    return tuple(found)


def spindle_before(trace: Trace) -> list[int | None]:
    """The spindle's direction at each section's start; None where it depends on the way there.

    Off at section 0; only SPINDLE rows change it.
    """
    unseen = -2
    before: list[int | None] = [unseen] * len(trace.sections)
    todo: list[tuple[int, int | None]] = [(0, 0)] if before else []
    while todo:
        number, direction = todo.pop()
        if before[number] == direction or before[number] is None:
            continue
        direction = direction if before[number] == unseen else None
        before[number] = direction
        rows = trace.sections[number].rows
        spins = np.flatnonzero(rows["op"] == Op.SPINDLE)
        if len(spins):
            last = float(rows["arg"][spins[-1], 0])
            direction = int(last) if last in (-1.0, 0.0, 1.0) else None
        todo.extend((edge.target, direction) for edge in trace.sections[number].edges if edge.target >= 0)
    return [None if direction == unseen else direction for direction in before]
