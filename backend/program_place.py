"""Where in the program a section has come with so many steps: rows of the Trace, and the program lines behind them.

Events have the tick at which they happen, and steps of later rows come after it, so that they bracket the row. Within
that, a row counts as possible where its box holds the position. A retimed section has the same steps in the same order,
so the planned one is asked.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

import numpy as np
import numpy.typing as npt

from gproof.backend.runs import ends, position_at, spans
from gproof.ir.columns import Columns
from gproof.ir.machine import Machine
from gproof.ir.record import record
from gproof.ir.stream import Motor, StreamSection
from gproof.ir.trace import Op, Trace, TraceSection

SLACK = 2.0
"""Steps by which a motor may be off the path that is traced; docs/stream.md: less than one."""


@record(frozen=True, slots=True, kw_only=True)
class Place:
    """first, last: the rows of the trace section between which the program is; from_line, to_line: their lines, with
    the file; begin, end: planned ticks."""

    first: int
    last: int
    from_line: tuple[str, int]
    to_line: tuple[str, int]
    begin: int
    end: int


def tick_of_step(runs: Columns, step: int) -> int:
    """The tick of step number ``step``, counted from 1; 0 for none."""
    if step < 1:
        return 0
    counted = np.cumsum(runs["count"])
    row = int(np.searchsorted(counted, step))
    if row >= len(runs):
        raise ValueError(f"step {step} of {int(counted[-1]) if len(runs) else 0}")
    before = int(counted[row - 1]) if row else 0
    start = int(ends(runs)[row] - spans(runs)[row])
    k, first, add = step - before, int(runs["interval"][row]), int(runs["add"][row])
    return start + k * first + add * (k * (k - 1) // 2)


def window(section: StreamSection, least: Sequence[int], most: Sequence[int] | None) -> tuple[int, int]:
    """Planned ticks between which a section is that has made at least and at most so many steps, by motor."""
    begin, end = 0, section.duration
    for motor, runs in enumerate(section.runs):
        whole = int(runs["count"].sum())
        begin = max(begin, tick_of_step(runs, min(least[motor], whole)))
        if most is not None and most[motor] < whole:
            end = min(end, tick_of_step(runs, most[motor] + 1))
    return begin, max(begin, end)


def place_of(
    section: StreamSection, trace: Trace, machine: Machine, motors: Sequence[Motor], *, least: Sequence[int],
    most: Sequence[int] | None,
) -> Place | None:  # fmt: skip
    """Where the program is; None for a section without rows."""
    traced = trace.sections[section.number]
    rows = traced.rows
    if not len(rows):
        return None
    begin, end = window(section, least, most)
    ticks, of_row = section.events["tick"], section.events["row"]
    done = of_row[ticks < begin]
    coming = of_row[ticks >= end]
    first = int(done.max()) if len(done) else 0
    last = int(coming.min()) if len(coming) else len(rows) - 1
    last = max(first, last)
    boxes = _Boxes.of(traced, machine, motors, section)
    if boxes is not None:
        first = boxes.possible(position_at(section, begin), first, last, earliest=True)
        last = boxes.possible(position_at(section, end), first, last, earliest=False)
    return Place(
        first=first, last=last, from_line=_line(trace, rows, first), to_line=_line(trace, rows, last), begin=begin,
        end=end,
    )  # fmt: skip


def _line(trace: Trace, rows: Columns, row: int) -> tuple[str, int]:
    number = int(rows["file"][row])
    return (trace.files[number] if 0 <= number < len(trace.files) else ""), int(rows["line"][row])


class _Boxes:
    """The box of each row in steps of each motor, wide enough for arcs and backlash."""

    def __init__(self, low: npt.NDArray[np.float64], high: npt.NDArray[np.float64]) -> None:
        self._low, self._high = low, high

    @classmethod
    def of(
        cls, traced: TraceSection, machine: Machine, motors: Sequence[Motor], section: StreamSection
    ) -> _Boxes | None:  # fmt: skip
        """None where motors do not simply follow the axes: a height map, a pitch table, Y on a turning axis."""
        rows = traced.rows
        to = rows["to"].astype(np.float64)
        here = np.vstack([np.array(traced.start, dtype=np.float64), to[:-1]])
        arc = rows["op"] == Op.ARC
        reach = np.where(arc, 2 * np.abs(to[:, :3] - rows["center"]).max(axis=1) + np.abs(to - here).max(axis=1), 0.0)
        low = np.empty((len(rows), len(motors)))
        high = np.empty_like(low)
        places = ((0, section.start), (len(rows) - 1, section.end()))
        for k, motor in enumerate(motors):
            scale = float(Fraction(motor.steps_per_unit))
            axis = next((one for one in machine.axes if one.index == motor.axis), None)
            slack = SLACK + abs(scale) * (axis.backlash if axis is not None else 0.0)
            a, b = here[:, motor.axis] * scale, to[:, motor.axis] * scale
            wide = slack + reach * abs(scale)
            low[:, k], high[:, k] = np.minimum(a, b) - wide, np.maximum(a, b) + wide
            for row, steps in places:
                meant = (a if row == 0 and steps is section.start else b)[row]
                if not abs(meant - steps[k]) <= slack:
                    return None
        return cls(low, high)

    def possible(self, position: Sequence[int], first: int, last: int, *, earliest: bool) -> int:
        """The earliest or last of these rows that holds a position; the end of the range where none does."""
        at = np.array(position, dtype=np.float64)
        part = slice(first, last + 1)
        held = np.flatnonzero(((self._low[part] <= at) & (at <= self._high[part])).all(axis=1))
        if not len(held):
            return first if earliest else last
        return first + int(held[0] if earliest else held[-1])
