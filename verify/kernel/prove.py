"""Prove a stream: from the StepStream, the Trace and the Drives alone.

``prove`` re-expands every run, merges the motors in time order and follows the traced path with them. It takes nothing
from the passes that made the stream. The propositions it proves, their bounds and what they do not say are in
docs/verification.md; the loop is in walk_kernels.py.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection
from fractions import Fraction
from typing import NamedTuple

import numpy as np

from gproof.ir.columns import batches
from gproof.ir.drives import Drives
from gproof.ir.stream import StepStream
from gproof.ir.trace import Trace, Wait
from gproof.verify.kernel import section_graph, surface
from gproof.verify.kernel import walk_kernels as walks
from gproof.verify.kernel.events import Pairs, event_arrays, left_to_others, pairs_of, spindle_before
from gproof.verify.kernel.lifted_path import Lifted, Lifting, Unfollowed
from gproof.verify.kernel.motors import (
    drive_of_motors,
    machine_number_problems,
    machine_problems,
    motor_arrays,
    unfollowed,
)
from gproof.verify.kernel.path_kernels import HERE, INTS, PLACES, REALS, WINDOW
from gproof.verify.kernel.proof import Job, Proof
from gproof.verify.kernel.rows import Tables, row_arrays, rows_of, start_problems, tables_of
from gproof.verify.kernel.stream_numbers import Sums, number_problems, sums_of, ticks_up
from gproof.verify.kernel.walk_state import Cursor, Events, Ints, Motors, Problems, Rows, Runs, Times, Walk, Window

SLICE = 1 << 20
"""Steps that are followed before Ctrl-C and the progress are looked at: some hundredths of a second."""

SLOW_SLICE = 1 << 12
"""The same in plain Python."""

TOLD = 20
"""Problems of the form that are reported."""

MOVED_BY_OTHERS = (Wait.HOME, Wait.PROBE)
"""Waits after which the machine may be elsewhere than the section ended."""

REFUTES = {
    walks.P_LEFT: ("stream-position", "walk.left"),
    walks.P_DENSE: ("stream-position", "walk.dense"),
    walks.P_EXTRA: ("stream-order", "walk.extra"),
    walks.P_RATE: ("stream-step-rate", "walk.rate"),
    walks.P_PULSE: ("stream-pulse", "walk.pulse"),
    walks.P_SETUP: ("stream-pulse", "walk.setup"),
    walks.P_SPEED: ("stream-velocity", "walk.speed"),
    walks.P_ACCELERATION: ("stream-acceleration", "walk.acceleration"),
    walks.P_FEED: ("stream-velocity", "walk.feed"),
    walks.P_EARLY: ("stream-event", "walk.early"),
    walks.P_OFF_PLACE: ("stream-event", "walk.off-place"),
    walks.P_WAIT_CUT: ("stream-event", "walk.wait-cut"),
    walks.P_UNFINISHED: ("stream-end", "walk.unfinished"),
    walks.P_END: ("stream-end", "walk.end"),
    walks.P_SLACK: ("stream-position", "walk.slack"),
    walks.P_LIMIT: ("stream-limit", "walk.limit"),
    walks.P_TRAVEL: ("stream-limit", "walk.travel"),
    walks.P_AFTER_END: ("stream-end", "walk.after-end"),
}
"""By what the walk notes, the property that it refutes and its kind. P_LIMIT_UNKNOWN leaves one open."""

FATAL = (
    walks.P_LEFT,
    walks.P_DENSE,
    walks.P_EARLY,
    walks.P_OFF_PLACE,
    walks.P_UNFINISHED,
    walks.P_END,
    walks.P_SLACK,
)
"""Problems after which the rest of the section is not walked."""


def prove(
    stream: StepStream,
    trace: Trace,
    drives: Drives,
    *,
    override: float = 1.0,
    stretched: bool = False,
    sections: Collection[int] | None = None,
    beat: Callable[[int], None] | None = None,
    pure: bool = False,
) -> Proof:
    """Judge a stream; never raises for a bad one. The options are those of ``gproof.verify.stream.validate``."""
    for part in (drives, trace):
        try:
            part.verify()
        except ValueError as error:
            return refused(type(part).__name__, str(error))
    job, proof = Job(stream, trace, drives), Proof()
    if not _well_formed(job, override, proof):
        proof.leave_open("", "open.malformed")
        return proof
    proof.seen = job = surface.view(job)
    _Walker(job, proof, override, stretched, beat, pure).walk(sections)
    return proof


def refused(part: str, why: str) -> Proof:
    """The proof of a job of which a part is not of its form."""
    proof = Proof()
    proof.refute("stream-form", "form.part", -1, -1, part, why)
    proof.leave_open("", "open.malformed")
    return proof


def _well_formed(job: Job, override: float, proof: Proof) -> bool:
    stream, trace, drives = job
    problems = [*number_problems(stream), *machine_number_problems(drives, override)]
    if len(stream.sections) != len(trace.sections):
        problems.append(("form.sections", len(stream.sections), len(trace.sections)))
    if not problems:
        problems = [*machine_problems(stream, trace, drives), *unfollowed(trace, drives), *surface.problems(job)]
    if not problems:
        graph = list(section_graph.problems(trace, drives))
        for problem in graph[:TOLD]:
            proof.refute("stream-form", problem.kind, problem.section, problem.row, *problem.values)
        if graph:
            return False
    if not problems and drives.cylinder is not None:
        problems = list(machine_problems(*surface.view(job)))
    for kind, *values in problems[:TOLD]:
        proof.refute("stream-form", kind, -1, -1, *values)
    return not problems


class _Batch(NamedTuple):
    """Neighbouring sections, for the kernel; rows, pairs: None where one of them has to be looked at by itself."""

    rows: list[Rows] | None
    pairs: list[Pairs] | None
    runs: list[Runs]


class _Walker:
    """The walk over the sections of a well-formed job."""

    def __init__(
        self, job: Job, proof: Proof, override: float, stretched: bool, beat: Callable[[int], None] | None, pure: bool
    ) -> None:
        self.job, self.proof, self.beat, self.pure = job, proof, beat, pure
        stream, trace, drives = job
        self.times = _times(stream, drives, override)
        self.motors: Motors = motor_arrays(stream, drives, self.times.grid, proof, stretched=stretched)
        if drives.max_step_frequency is None:
            proof.assume("stream-step-rate", "assumed.no-step-frequency")
        self.tables: Tables = tables_of(stream, trace)
        self.sums: Sums = sums_of(stream)
        self.known = drive_of_motors(stream, drives)
        self.window = _window(len(stream.motors))
        self.lifting = Lifting(trace, drives.height_map, stream.motors)
        self.spindle = spindle_before(trace)
        left = left_to_others(trace)
        if left:
            proof.assume("stream-event", "assumed.left-to-others", left)

    def walk(self, sections: Collection[int] | None) -> None:
        """Judge these sections, all of them: None, and what leads from one to the next."""
        stream, trace, _ = self.job
        sizes = [len(t.rows) + sum(map(len, s.runs)) for t, s in zip(trace.sections, stream.sections, strict=True)]
        for begin, end in batches(sizes):
            asked = [number for number in range(begin, end) if sections is None or number in sections]
            if not asked:
                continue
            batch = self._batch(begin, end)
            for number in asked:
                self._one(number, batch, number - begin)
                self._edges(number)

    def _batch(self, begin: int, end: int) -> _Batch:
        """What is made of small sections at once costs what one of them costs by itself."""
        stream, trace, _ = self.job
        rows = rows_of(trace.sections[begin:end], self.tables, [])
        pairs = None if rows is None else pairs_of(stream, trace, begin, end)
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
            runs.append(Runs(interval[a:b], length[a:b], add[a:b], way[a:b], own - a))
        return _Batch(rows, pairs, runs)

    def _one(self, number: int, batch: _Batch, k: int) -> None:
        """Judge a section, the ``k``-th of its batch."""
        stream, trace, drives = self.job
        section, proof = trace.sections[number], self.proof
        rows = row_arrays(section, self.tables, proof) if batch.rows is None else batch.rows[k]
        good = start_problems(stream, trace, drives, self.known, number, self.lifting.rise(number), proof)
        pairs = None if batch.pairs is None else batch.pairs[k]
        events = event_arrays(stream, trace, number, self.spindle[number], drives.spindle_ramp_time, pairs, proof)
        if rows is None or events is None or not good:
            proof.leave_open("", "open.section", number)
            return
        try:
            path = self.lifting.section(number, rows)
        except Unfollowed as why:
            proof.refute("stream-form", why.kind, number, why.row, *why.values)
            proof.leave_open("", "open.section", number)
            return
        self._follow(number, path, events._replace(row=path.first[events.row]), batch.runs[k])

    def _follow(self, number: int, path: Lifted, events: Events, runs: Runs) -> None:
        """Walk a section whose arrays are what they have to be."""
        section, proof, window = self.job.stream.sections[number], self.proof, self.window
        rows, motors, times = path.rows, self.motors, self.times._replace(duration=section.duration)
        place = np.zeros((PLACES, 6))
        place[HERE] = path.start
        walk = Walk(
            ints=np.zeros(INTS, np.int64),
            reals=np.zeros(REALS),
            place=place,
            turns=np.zeros((6, len(section.start)), np.int64),
        )
        room = walks.PROBLEMS * walks.KEPT
        problems = Problems(
            counts=np.zeros(walks.PROBLEMS, np.int64),
            found=np.zeros((room, 4), np.int64),
            numbers=np.zeros((room, 2)),
        )
        position = np.array(section.start, np.int64)
        cursor = _cursor(position, runs)
        work = float(sum(self.sums.steps[number]) + len(rows.op))
        begin = walks.begin_section.python if self.pure else walks.begin_section.pick(1.0)
        begin(cursor, runs, rows, events, motors, times, window, walk)
        before = proof.steps
        while not cursor.now[walks.OVER]:
            check = walks.check_section.python if self.pure else walks.check_section.pick(work)
            most = SLOW_SLICE if self.pure else SLICE
            walked = check(most, cursor, position, runs, rows, events, motors, times, window, walk, problems)
            work = 0.0
            proof.steps = before + int(walked)
            if self.beat is not None:
                self.beat(proof.steps)
        self._noted(number, path, problems, position)

    def _noted(self, number: int, path: Lifted, problems: Problems, position: Ints) -> None:
        """Problems and remarks for everything that the walk over a section noted. position: where it ended."""
        proof = self.proof
        kept = np.minimum(problems.counts, walks.KEPT)
        total = int(kept.sum())
        for k in range(total):
            kind, motor, tick, at = problems.found[k].tolist()
            a, b = problems.numbers[k].tolist()
            row = path.row(at)
            if kind == walks.P_LIMIT_UNKNOWN:
                proof.leave_open("stream-limit", "open.travel", motor, number, row)
                continue
            if kind == walks.P_EARLY:
                a = path.row(int(a))
            times = 1
            if not (problems.found[k + 1 : total, 0] == kind).any():
                times += int(problems.counts[kind] - kept[kind])
            more = (at, path, position) if kind == walks.P_LEFT else ()
            proof.refute(*REFUTES[kind], number, row, motor, tick, a, b, *more, times=times)
        if any(problems.counts[kind] for kind in FATAL):
            proof.leave_open("", "open.section-end", number)

    def _edges(self, number: int) -> None:
        """What follows a section starts where it ended, and its first steps keep their distance from the last ones."""
        stream, trace, _ = self.job
        times, sums, proof = self.times, self.sums, self.proof
        here, rows = stream.sections[number], trace.sections[number].rows
        ended = tuple(float(x) for x in rows["to"][-1]) if len(rows) else trace.sections[number].start
        last = len(rows) - 1
        final = tuple(at + more for at, more in zip(here.start, sums.net[number], strict=True))
        for edge in trace.sections[number].edges:
            if edge.target < 0:
                continue
            there, next_ = stream.sections[edge.target], edge.target
            if edge.wait in MOVED_BY_OTHERS:
                proof.assume("stream-end", "assumed.moved-by-others", edge.wait)
            elif final != there.start or tuple(trace.sections[edge.target].start) != tuple(ended):
                proof.refute("stream-end", "edge.start", number, last, final, next_, there.start)
            for m, motor in enumerate(stream.motors):
                if not sums.steps[number][m] or not sums.steps[next_][m]:
                    continue
                ticks = here.duration - sums.last[number][m] + sums.first[next_][m]
                if sums.last_way[number][m] != sums.first_way[next_][m] and ticks < times.setup:
                    proof.refute("stream-pulse", "edge.setup", number, last, motor.name, ticks, next_, times.setup)
                needed = max(times.interval, times.pulse)
                if ticks < needed:
                    proof.refute("stream-step-rate", "edge.ticks", number, last, motor.name, ticks, next_, needed)


def _times(stream: StepStream, drives: Drives, override: float) -> Times:
    frequency = stream.tick_frequency
    most = drives.max_step_frequency
    # Both steps of a pair are rounded to ticks, so a step period may come out one tick short.
    interval = max(1, math.ceil(Fraction(frequency) / Fraction(most)) - 1) if most else 1
    return Times(
        interval=interval,
        pulse=ticks_up(2 * Fraction(drives.step_pulse), frequency),
        setup=ticks_up(Fraction(drives.direction_setup), frequency),
        grid=max(1, round(drives.interpolation_time * frequency)),
        duration=0,
        seconds=override / frequency,
    )


def _cursor(position: Ints, runs: Runs) -> Cursor:
    """At the section's start, for ``begin_section``."""
    count = len(position)

    def zeros() -> Ints:
        return np.zeros(count, np.int64)

    return Cursor(
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
        positions=np.zeros((walks.RING, count), np.int64),
        progress=np.zeros((walks.RING, 2)),
        now=np.zeros(walks.NOW, np.int64),
        began=np.zeros(1),
    )


def _window(motors: int) -> Window:
    room = 2 * WINDOW
    return Window(
        line=np.empty((room, motors, 3)),
        top=np.empty((room, motors)),
        reach=np.empty((room, 5)),
        row=np.zeros(room, np.int64),
    )
