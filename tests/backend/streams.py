"""Small random streams for the backend's tests, and slow reference answers about them."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
from hypothesis import strategies as st

from gproof.ir.columns import Columns
from gproof.ir.stream import EVENT, RUN, Motor, StepStream, StreamSection
from gproof.ir.trace import Op

FREQUENCY = 1_000_000


def runs_of(rows: list[tuple[int, int, int, int]]) -> Columns:
    """A run table from (interval, count, add, direction) rows."""
    arrays = {c.name: np.array([r[k] for r in rows], dtype=c.dtype) for k, c in enumerate(RUN.columns)}
    return Columns(RUN, arrays)


def events_of(rows: list[tuple[int, int, int, tuple[int, int]]]) -> Columns:
    """An event table from (tick, row, op, arg) rows."""
    return Columns(
        EVENT,
        {
            "tick": np.array([r[0] for r in rows], dtype=np.int64),
            "row": np.array([r[1] for r in rows], dtype=np.int64),
            "op": np.array([r[2] for r in rows], dtype=np.uint8),
            "arg": np.array([r[3] for r in rows], dtype=np.int64).reshape(len(rows), 2),
        },
    )


def steps_of(runs: Columns) -> list[tuple[int, int]]:
    """(tick, direction) of every step, one by one."""
    tick, out = 0, []
    for interval, count, add, direction in runs.rows():
        for _ in range(count):
            tick += interval
            interval += add
            out.append((tick, direction))
    return out


def merged(section: StreamSection) -> list[tuple[int, int, int]]:
    """(tick, motor, direction) of every step in order."""
    return sorted((t, m, d) for m, runs in enumerate(section.runs) for t, d in steps_of(runs))


def section_of(
    tables: list[Columns], *, start: tuple[int, ...] | None = None, tail: int = 10
) -> StreamSection:
    """A section that ends ``tail`` ticks after its last step."""
    last = max((t for runs in tables for t, _ in steps_of(runs)), default=0)
    return StreamSection(
        number=0,
        start=start if start is not None else (0,) * len(tables),
        runs=tuple(tables),
        events=events_of([]),
        duration=last + tail,
    )


@st.composite
def run_rows(draw: st.DrawFn, *, least: int = 1, most: int = 3000) -> tuple[int, int, int, int]:
    """One run whose intervals lie within least..most."""
    count = draw(st.integers(1, 25))
    first = draw(st.integers(least, most))
    last = draw(st.integers(least, most))
    add = (last - first) // max(1, count - 1)
    if first + add * (count - 1) < least:
        add = 0
    return first, count, add, draw(st.sampled_from([1, -1]))


@st.composite
def sections(
    draw: st.DrawFn, *, motors: int | None = None, least: int = 1, most: int = 3000, rows: int = 12
) -> StreamSection:
    """A small random section with events; directions and intervals as they come."""
    n = motors or draw(st.integers(1, 3))
    tables = [runs_of(draw(st.lists(run_rows(least=least, most=most), max_size=rows))) for _ in range(n)]
    start = tuple(draw(st.integers(-1000, 1000)) for _ in range(n))
    section = section_of(tables, start=start, tail=draw(st.integers(0, 500)))
    ticks = sorted(draw(st.lists(st.integers(0, section.duration), max_size=3)))
    section.events = events_of([(t, k, int(Op.COOLANT), (0, 1000)) for k, t in enumerate(ticks)])
    return section


def stream_of(*parts: StreamSection, frequency: int = FREQUENCY) -> StepStream:
    """A stream of these sections, numbered as they stand."""
    motors = tuple(
        Motor(name="xyzabc"[m], axis=m, steps_per_unit=Fraction(100)) for m in range(len(parts[0].runs))
    )
    for number, section in enumerate(parts):
        section.number = number
    return StepStream(tick_frequency=frequency, motors=motors, sections=list(parts))
