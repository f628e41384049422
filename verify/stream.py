"""Stream validation: from the StepStream, the Trace, the Machine and the Setup alone.

``validate`` re-expands every run, merges the motors in time order and follows the traced path with them. It
takes nothing from the passes that made the stream. The propositions it proves, their bounds and what they do
not say are in docs/verification.md; the loop is in stream_kernels.py.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection
from fractions import Fraction
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from gproof.ir.codes import STREAM_END, STREAM_MALFORMED, STREAM_PULSE, STREAM_STEP_RATE
from gproof.ir.columns import batches
from gproof.ir.finding import Span
from gproof.ir.machine import Machine
from gproof.ir.setup import Setup
from gproof.ir.stream import StepStream
from gproof.ir.trace import Trace, Wait
from gproof.verify.explain.stream_explain import explain
from gproof.verify.explain.stream_report import Collector, StreamReport
from gproof.verify.kernel import section_graph, surface
from gproof.verify.kernel import stream_inputs as inputs
from gproof.verify.kernel import stream_kernels as kernels
from gproof.verify.kernel.lifted_path import Lifting, Unfollowed

SLICE = 1 << 20
"""Steps that are followed before Ctrl-C and the progress are looked at: some hundredths of a second."""

MOVED_BY_OTHERS = (Wait.HOME, Wait.PROBE)
"""Waits after which the machine may stand elsewhere than the section ended."""


def validate(
    stream: StepStream,
    trace: Trace,
    machine: Machine,
    setup: Setup,
    *,
    override: float = 1.0,
    stretched: bool = False,
    sections: Collection[int] | None = None,
    beat: Callable[[int], None] | None = None,
) -> StreamReport:
    """Judge a stream; never raises for a bad one.

    override: the highest feed override the stream may contain; stretched: the time in which backlash is taken up is
    not bounded, as in a section whose time the runtime has stretched; sections: only those (None: all), as when it
    has retimed one of them; beat: called now and then with the number of steps checked so far, and may raise.
    """
    collector = Collector()
    if not _well_formed(stream, trace, machine, setup, override, collector):
        collector.leave_open("the stream is malformed")
        return collector.report()
    stream, trace, machine, setup = surface.view(stream, trace, machine, setup)
    times = _times(stream, machine, override)
    motors = inputs.motor_arrays(stream, machine, times.grid, collector, stretched=stretched)
    if machine.controller.max_step_frequency is None:
        collector.assume("stream-step-rate", "the machine file states no greatest step frequency")
    tables = inputs.tables_of(stream, trace)
    sums = inputs.sums_of(stream)
    drives = inputs.drives_of(stream, machine)
    window = _window(len(stream.motors))
    lifting = Lifting(trace, setup, stream.motors)
    spindle = inputs.spindle_before(trace)
    left = inputs.left_to_others(trace)
    if left:
        collector.assume("stream-event", f"no board carries out {left}: who runs the stream sees to it")
    ramp = machine.controller.spindle_ramp_time
    rows_and_runs = [len(t.rows) + sum(map(len, s.runs)) for t, s in zip(trace.sections, stream.sections, strict=True)]
    for begin, end in batches(rows_and_runs):
        asked = [number for number in range(begin, end) if sections is None or number in sections]
        batch = _batch(stream, trace, begin, end, tables) if asked else None
        for number in asked:
            assert batch is not None
            k = number - begin
            rows = (
                inputs.row_arrays(trace, trace.sections[number], tables, collector)
                if batch.rows is None
                else batch.rows[k]
            )
            good = inputs.start_problems(stream, trace, drives, number, setup, lifting.rise(number), collector)
            pairs = None if batch.pairs is None else batch.pairs[k]
            events = inputs.event_arrays(stream, trace, number, spindle[number], ramp, pairs, collector)
            if rows is None or events is None or not good:
                collector.leave_open(f"section {number} could not be followed")
            else:
                steps = sum(sums.steps[number])
                _section(
                    stream, trace, machine, number, rows, events, batch.runs[k], steps, lifting, times, motors, window,
                    collector, beat,
                )  # fmt: skip
            _edges(stream, trace, number, times, sums, collector)
    return collector.report()


def _well_formed(
    stream: StepStream, trace: Trace, machine: Machine, setup: Setup, override: float, collector: Collector
) -> bool:
    span = Span(trace.files[0] if trace.files else "", 0)
    for part in (machine, trace):
        try:
            part.verify()
        except ValueError as error:
            collector.add(STREAM_MALFORMED.at(span, what=f"{type(part).__name__}: {error}"))
            return False
    problems = [*inputs.number_problems(stream), *inputs.machine_number_problems(machine, override)]
    if len(stream.sections) != len(trace.sections):
        problems.append(f"the stream has {len(stream.sections)} sections, the trace {len(trace.sections)}")
    if not problems:
        problems = [*inputs.machine_problems(stream, trace, machine), *inputs.unfollowed(trace, machine, setup)]
        problems += surface.problems(trace, machine, setup)
    if not problems:
        graph = list(section_graph.problems(trace, machine, setup))
        for section, row, what in graph[:20]:
            where = f"section {section}" + (f", row {row}" if row >= 0 else "") + ": " if section >= 0 else ""
            collector.add(STREAM_MALFORMED.at(inputs.span_of(trace, max(section, 0), row), what=where + what))
        if graph:
            return False
    if not problems and setup.cylinder is not None:
        seen = surface.view(stream, trace, machine, setup)
        problems = list(inputs.machine_problems(seen.stream, seen.trace, seen.machine))
    for what in problems[:20]:
        collector.add(STREAM_MALFORMED.at(span, what=what))
    return not problems


def _times(stream: StepStream, machine: Machine, override: float) -> kernels.Times:
    frequency = stream.tick_frequency
    most = machine.controller.max_step_frequency
    # Both steps of a pair are rounded to ticks, so a step period may come out one tick short.
    interval = max(1, math.ceil(Fraction(frequency) / Fraction(most)) - 1) if most else 1
    return kernels.Times(
        interval=interval,
        pulse=inputs.ticks_up(2 * Fraction(machine.board.step_pulse), frequency),
        setup=inputs.ticks_up(Fraction(machine.board.direction_setup), frequency),
        grid=max(1, round(machine.controller.interpolation_time * frequency)),
        duration=0,
        seconds=override / frequency,
    )


def _cursor(position: npt.NDArray[np.int64], runs: kernels.Runs) -> kernels.Cursor:
    """At the section's start, for ``begin_section``."""
    count = len(position)

    def zeros() -> npt.NDArray[np.int64]:
        return np.zeros(count, np.int64)

    return kernels.Cursor(
        n=position.copy(),
        near=np.empty((count, 2)),
        at=position.copy(),
        until=np.full(count, -1, np.int64),
        run=runs.first[:-1].copy(),
        due=zeros(),
        gap=zeros(),
        left=zeros(),
        last=np.full(count, -1, np.int64),
        way=zeros(),
        positions=np.zeros((kernels.RING, count), np.int64),
        progress=np.zeros((kernels.RING, 2)),
        now=np.zeros(kernels.NOW, np.int64),
        began=np.zeros(1),
    )


def _window(motors: int) -> kernels.Window:
    room = 2 * kernels.WINDOW
    return kernels.Window(
        line=np.empty((room, motors, 3)),
        top=np.empty((room, motors)),
        reach=np.empty((room, 5)),
        row=np.zeros(room, np.int64),
    )


class _Batch(NamedTuple):
    """Neighbouring sections, for the kernel; rows, pairs: None where one of them has to be looked at by itself."""

    rows: list[kernels.Rows] | None
    pairs: list[inputs.Pairs] | None
    runs: list[kernels.Runs]


def _batch(stream: StepStream, trace: Trace, begin: int, end: int, tables: inputs.Tables) -> _Batch:
    """What is made of small sections at once costs what one of them costs by itself."""
    rows = inputs.rows_of(trace.sections[begin:end], tables, [])
    pairs = None if rows is None else inputs.pairs_of(stream, trace, begin, end)
    count = len(stream.motors)
    given = [table for section in stream.sections[begin:end] for table in section.runs]
    names = ("interval", "count", "add", "direction")
    empty = np.zeros(0, np.int64)
    interval, length, add, way = (
        np.concatenate([empty, *(table[name] for table in given)]).astype(np.int64, copy=False) for name in names
    )
    first = np.cumsum([0, *map(len, given)]).astype(np.int64)
    runs = []
    for k in range(end - begin):
        own = first[k * count : (k + 1) * count + 1]
        a, b = int(own[0]), int(own[-1])
        runs.append(kernels.Runs(interval[a:b], length[a:b], add[a:b], way[a:b], own - a))
    return _Batch(rows, pairs, runs)


def _section(
    stream: StepStream,
    trace: Trace,
    machine: Machine,
    number: int,
    rows: kernels.Rows,
    events: kernels.Events,
    given: kernels.Runs,
    steps: int,
    lifting: Lifting,
    times: kernels.Times,
    motors: kernels.Motors,
    window: kernels.Window,
    collector: Collector,
    beat: Callable[[int], None] | None = None,
) -> None:
    """Judge one section. given, steps: its runs, and how many steps they make."""
    try:
        path = lifting.section(number, rows)
    except Unfollowed as reason:
        what = f"section {number}, row {reason.row}: {reason.why}"
        collector.add(STREAM_MALFORMED.at(inputs.span_of(trace, number, reason.row), what=what))
        collector.leave_open(f"section {number} could not be followed")
        return
    rows, events = path.rows, events._replace(row=path.first[events.row])
    section = stream.sections[number]
    count = len(stream.motors)
    place = np.zeros((kernels.PLACES, 6))
    place[kernels.HERE] = path.start
    walk = kernels.Walk(
        ints=np.zeros(kernels.INTS, np.int64),
        reals=np.zeros(kernels.REALS),
        place=place,
        turns=np.zeros((6, count), np.int64),
    )
    room = kernels.PROBLEMS * kernels.KEPT
    problems = kernels.Problems(
        counts=np.zeros(kernels.PROBLEMS, np.int64),
        found=np.zeros((room, 4), np.int64),
        numbers=np.zeros((room, 2)),
    )
    position = np.array(section.start, np.int64)
    times = times._replace(duration=section.duration)
    cursor = _cursor(position, given)
    work = float(steps + len(rows.op))
    kernels.begin_section.pick(1.0)(cursor, given, rows, events, motors, times, window, walk)
    before = collector.steps
    while not cursor.now[kernels.OVER]:
        walked = kernels.check_section.pick(work)(
            SLICE, cursor, position, given, rows, events, motors, times, window, walk, problems
        )
        work = 0.0
        collector.steps = before + int(walked)
        if beat is not None:
            beat(collector.steps)
    explain(stream, trace, machine, number, path, problems, position, collector)


def _edges(
    stream: StepStream,
    trace: Trace,
    number: int,
    times: kernels.Times,
    sums: inputs.Sums,
    collector: Collector,
) -> None:
    """What follows a section starts where it ended, and its first steps keep their distance from the last ones."""
    here, rows = stream.sections[number], trace.sections[number].rows
    ended = tuple(float(x) for x in rows["to"][-1]) if len(rows) else trace.sections[number].start
    span = inputs.span_of(trace, number, len(rows) - 1)
    final = tuple(at + more for at, more in zip(here.start, sums.net[number], strict=True))
    for edge in trace.sections[number].edges:
        if edge.target < 0:
            continue
        there, next_ = stream.sections[edge.target], edge.target
        if edge.wait in MOVED_BY_OTHERS:
            collector.assume("stream-end", f"{edge.wait.value} leaves the machine where the trace goes on")
        elif final != there.start or tuple(trace.sections[edge.target].start) != tuple(ended):
            what = f"section {number} ends at {final}, section {edge.target} starts at {there.start}"
            collector.add(STREAM_END.at(span, what=what))
        for m, motor in enumerate(stream.motors):
            if not sums.steps[number][m] or not sums.steps[next_][m]:
                continue
            ticks = here.duration - sums.last[number][m] + sums.first[next_][m]
            if ticks >= max(times.setup, times.interval, times.pulse):
                continue
            what = f"{motor.name}: {ticks} ticks between the steps of sections {number} and {edge.target}"
            if sums.last_way[number][m] != sums.first_way[next_][m] and ticks < times.setup:
                collector.add(STREAM_PULSE.at(span, what=f"{what}; {times.setup} needed for the new direction"))
            if ticks < max(times.interval, times.pulse):
                collector.add(STREAM_STEP_RATE.at(span, what=f"{what}; {max(times.interval, times.pulse)} needed"))
