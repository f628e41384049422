"""Small random streams for the backend's tests, and slow reference answers about them."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
from hypothesis import strategies as st

from gproof.ir.columns import Columns
from gproof.ir.machine import Axis, AxisKind, Board, Controller, Machine
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


def section_of(tables: list[Columns], *, start: tuple[int, ...] | None = None, tail: int = 10) -> StreamSection:
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
    motors = tuple(Motor(name="xyzabc"[m], axis=m, steps_per_unit=Fraction(100)) for m in range(len(parts[0].runs)))
    for number, section in enumerate(parts):
        section.number = number
    return StepStream(tick_frequency=frequency, motors=motors, sections=list(parts))


SPU = 200
"""Steps per mm of the planned sections' machine."""


def machine(axes: str = "xy", *, velocity: float = 120.0, acceleration: float = 600.0) -> Machine:
    """A machine with these axes."""
    return Machine(
        name="test",
        axes=tuple(
            Axis(
                name=name,
                kind=AxisKind.LINEAR,
                steps_per_unit=Fraction(SPU),
                lower=-1000.0,
                upper=1000.0,
                max_velocity=velocity,
                max_acceleration=acceleration,
            )
            for name in axes
        ),
        controller=Controller(max_step_frequency=100_000.0),
        board=Board(tick_frequency=FREQUENCY, step_pulse=2e-6, direction_setup=5e-6),
    )


def motors_of(of: Machine) -> tuple[Motor, ...]:
    scales = [(a.name.upper(), a.index, a.steps_per_unit or Fraction(1)) for a in of.axes]
    return tuple(Motor(name=name, axis=index, steps_per_unit=scale) for name, index, scale in scales)


def planned(points: list[tuple[float, ...]], of: Machine, *, feed: float = 60.0) -> StreamSection:
    """Straight moves from point to point, each from rest to rest at the machine's full acceleration."""
    times, places = [0.0], [np.zeros(len(of.axes))]
    for point in points:
        way = np.array(point) - places[-1]
        length = float(np.sqrt((way * way).sum()))
        if not length:
            continue
        unit = np.abs(way) / length
        a = min((ax.max_acceleration or 0) / u for ax, u in zip(of.axes, unit, strict=True) if u > 0)
        v = min(feed, *((ax.max_velocity or 0) / u for ax, u in zip(of.axes, unit, strict=True) if u > 0))
        v = min(v, (a * length) ** 0.5)
        ramp, cruise = v / a, (length - v * v / a) / v
        t = np.linspace(0.0, 2 * ramp + cruise, max(50, int(length * SPU * 3)))[1:]
        up, down = np.minimum(t, ramp), np.maximum(0.0, t - ramp - cruise)
        s = a * up * up / 2 + v * np.clip(t - ramp, 0, cruise) + v * down - a * down * down / 2
        times.extend((times[-1] + t).tolist())
        places.extend(list(places[-1] + np.outer(s / length, way)))
    grid, path = np.array(times), np.array(places) * SPU
    path[-1] = np.round(path[-1])
    tables = []
    for m in range(path.shape[1]):
        ticks: list[int] = []
        ways: list[int] = []
        count = 0
        for k in range(1, len(grid)):
            p, q = path[k - 1, m], path[k, m]
            while abs(q - count) > 0.5 + 1e-9:
                way = 1 if q > count else -1
                at = grid[k - 1] + (grid[k] - grid[k - 1]) * ((count + way / 2) - p) / (q - p)
                ticks.append(round(at * FREQUENCY))
                ways.append(way)
                count += way
        rows, last = [], 0
        for tick, way in zip(ticks, ways, strict=True):
            rows.append((tick - last, 1, 0, way))
            last = tick
        tables.append(runs_of(rows))
    section = section_of(tables)
    section.duration = max(section.duration, round(grid[-1] * FREQUENCY))
    return section


def windows_hold(section: StreamSection, of: Machine) -> list[str]:
    """What is wrong with a section's velocities and accelerations, over the windows that verify uses."""
    wrong = []
    period = of.controller.interpolation_time
    for m, (axis, runs) in enumerate(zip(of.axes, section.runs, strict=True)):
        steps = steps_of(runs)
        ticks = np.array([t for t, _ in steps])
        ways = np.array([d for _, d in steps])
        for h in (period, 4 * period, 16 * period):
            edges = np.arange(0, section.duration / FREQUENCY + h, h) * FREQUENCY
            n = np.histogram(ticks, edges, weights=ways)[0] if len(ticks) else np.zeros(1)
            most = (axis.max_velocity or 0) * h * SPU + 2
            if (np.abs(n) > most).any():
                wrong.append(f"motor {m}: velocity over {h}: {np.abs(n).max()} > {most}")
            change = (axis.max_acceleration or 0) * h * (h + 2 * period) * SPU + 4
            if len(n) > 1 and (np.abs(np.diff(n)) > change).any():
                wrong.append(f"motor {m}: acceleration over {h}: {np.abs(np.diff(n)).max()} > {change}")
    return wrong
