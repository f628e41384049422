"""Trace to Plan: a trapezoidal velocity for every row, with look-ahead over whole sections.

``plan`` takes a complete Trace whose positions are known; ``MotionEstimate`` takes chunks while a job
streams by and gives time and path length. Both use ``plan_kernels``. docs/plan.md states the rules and why
they hold; they come from the Eding CNC manual 4.01: 2.1.2, 2.1.3 (velocity, acceleration, step frequency), 2.1.6,
2.1.7 (look-ahead feed, interpolation time), and the text on G61 and G64.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from fractions import Fraction

import numpy as np
import numpy.typing as npt

from gproof.ir import codes
from gproof.ir.columns import Columns
from gproof.ir.finding import Findings, Span
from gproof.ir.machine import AXES, AXIS_NAMES, Axis, Machine
from gproof.ir.plan import PLAN_ROW, Plan, PlanSection
from gproof.ir.rules import LanguageRules
from gproof.ir.symbolic import BESIDE
from gproof.ir.trace import UNKNOWN, Chunk, Frame, Op, PathMode, State, Trace
from gproof.ir.trace_rows import row_span
from gproof.passes.geometry.backlash import left_for_axis
from gproof.passes.geometry.pitch import steepest
from gproof.passes.motion import plan_kernels as k
from gproof.passes.motion.plan_refusals import Refusals

assert (Op.TRAVERSE, Op.ARC, Op.PROBE, Op.DWELL) == (k.TRAVERSE, k.ARC, k.PROBE, k.DWELL)
assert (Op.SPINDLE, Op.HOME, Op.OFFSET, Op.SETPOINT) == (k.SPINDLE, k.HOME, k.OFFSET, k.SETPOINT)

STEP_RATE_SHARE = 0.95
"""Of the highest step frequency, what motion may use: rounding of step times to ticks takes the rest at most."""

STRAIGHT = 1e-9
"""rad: a change of direction that is none."""

NOTHING_JOINED = np.zeros(0, dtype=np.uint8)

_NOT_LIMITED = 1e-9
"""1 / velocity and 1 / acceleration of an axis for which they are not stated."""


def shortest_interval(machine: Machine) -> int:
    """Ticks between two steps of a motor, at least: the controller's step frequency and two pulse widths."""
    board = machine.board
    ticks = Fraction(board.step_pulse) * 2 * board.tick_frequency
    if machine.controller.max_step_frequency is not None:
        ticks = max(ticks, board.tick_frequency / Fraction(machine.controller.max_step_frequency))
    return max(1, math.ceil(ticks))


def step_rate(machine: Machine) -> float:
    """Steps a second that a motor may have to make."""
    board = machine.board
    seconds = 2.0 * board.step_pulse
    if machine.controller.max_step_frequency is not None:
        seconds = max(seconds, 1.0 / machine.controller.max_step_frequency)
    return board.tick_frequency / max(shortest_interval(machine), seconds * board.tick_frequency / STEP_RATE_SHARE)


def allowed_velocity(axis: Axis, machine: Machine, *, stepped: bool = False) -> float | None:
    """unit/s: as fast as all motors of the axis may go, or less where one could not be stepped that fast.

    Where a pitch table is steeper than 1, a motor goes faster than its axis; stepped: leave what backlash needs.
    """
    if axis.max_velocity is None:
        return None
    allowed = [axis.max_velocity]
    for drive in axis.drives():
        share = left_for_axis(drive, _interpolation_time(machine))[0] if stepped else 1.0
        share /= 1.0 if drive.pitch is None else steepest(drive.pitch)
        if drive.max_velocity is not None:
            allowed.append(drive.max_velocity * share)
        if drive.steps_per_unit is not None:
            allowed.append(step_rate(machine) / abs(float(drive.steps_per_unit)) * share)
    return min(allowed)


def allowed_acceleration(axis: Axis, machine: Machine, *, stepped: bool = False) -> float | None:
    """unit/s2: what all motors of the axis can give it; stepped: without what backlash needs."""
    if axis.max_acceleration is None:
        return None
    allowed: list[float] = []
    for drive in axis.drives():
        share = left_for_axis(drive, _interpolation_time(machine))[1] if stepped else 1.0
        share /= 1.0 if drive.pitch is None else steepest(drive.pitch)
        if drive.max_acceleration is not None:
            allowed.append(drive.max_acceleration * share)
    return min(allowed)


def _limits(machine: Machine, *, stepped: bool) -> tuple[npt.NDArray[np.float64], list[tuple[str, ...]]]:
    """(2, 6) 1 / velocity and 1 / acceleration, and for each axis what the machine file does not say."""
    limits = np.full((2, AXES), _NOT_LIMITED)
    missing: list[tuple[str, ...]] = [("axis",)] * AXES
    for axis in machine.axes:
        velocity = allowed_velocity(axis, machine, stepped=stepped)
        acceleration = allowed_acceleration(axis, machine, stepped=stepped)
        if velocity is not None:
            limits[0, axis.index] = 1.0 / velocity
        if acceleration is not None:
            limits[1, axis.index] = 1.0 / acceleration
        absent = [("maximum velocity", velocity), ("maximum acceleration", axis.max_acceleration)]
        missing[axis.index] = tuple(name for name, value in absent if value is None)
    return limits, missing


def _interpolation_time(machine: Machine) -> float:
    return max(machine.controller.interpolation_time, 1e-6)


class _Tables:
    """Frames and states of a trace as arrays for the kernels; they grow while the job streams by."""

    def __init__(self, machine: Machine) -> None:
        self._default_angle = machine.controller.laf_angle or 0.0
        self._trace: Trace | None = None
        self._numbers: dict[Frame, int] = {}
        self.forms = np.empty(0, dtype=np.int64)
        self.chords = np.empty(0)

    def update(self, trace: Trace) -> None:
        if trace is not self._trace:
            self._trace, self._numbers = trace, {}
            self.forms, self.chords = self.forms[:0], self.chords[:0]
        if len(self.forms) < len(trace.frames):
            new = [self._number(frame) for frame in trace.frames[len(self.forms) :]]
            self.forms = np.concatenate([self.forms, np.array(new, dtype=np.int64)])
        if len(self.chords) < len(trace.states):
            more = [self._chord(state) for state in trace.states[len(self.chords) :]]
            self.chords = np.concatenate([self.chords, np.array(more, dtype=np.float64)])

    def _number(self, frame: Frame) -> int:
        # Places next to a contour do not differ by as much as their contours do.
        if any(symbol == UNKNOWN[0][0] or symbol.startswith(BESIDE) for form in frame for symbol, _ in form):
            return -1
        return self._numbers.setdefault(frame, len(self._numbers))

    def _chord(self, state: State) -> float:
        """The square of the change of a unit direction at the look-ahead feed angle."""
        if state.path_mode is PathMode.EXACT_STOP:
            return -1.0
        degrees = self._default_angle if math.isnan(state.laf_angle) else state.laf_angle
        radians = min(max(math.radians(degrees), STRAIGHT), math.pi)
        return float((2.0 * math.sin(0.5 * radians)) ** 2)


class _Measure:
    """``measure`` with what it keeps from call to call. ``queue[:used]`` waits for ``settle``.

    stepped: for a stream, whose motors take up their backlash.
    """

    def __init__(self, machine: Machine, *, stepped: bool) -> None:
        self.machine = machine
        self.limits, self.missing = _limits(machine, stepped=stepped)
        self.tables = _Tables(machine)
        self.place = np.zeros((3, AXES))
        self.carry = np.zeros(k.CARRY_WIDTH)
        self.moved = np.zeros(AXES, dtype=np.int64)
        self.queue = np.empty((0, k.QUEUE_WIDTH))
        self.used = 0
        self.counts = np.zeros(k.N_COUNT, dtype=np.int64)
        self.notes = np.zeros((k.N_COUNT, k.KEPT), dtype=np.int64)

    def feed(self, chunk: Chunk, joined: npt.NDArray[np.uint8] = NOTHING_JOINED) -> None:
        rows = chunk.rows
        self.tables.update(chunk.trace)
        if chunk.begin == 0:
            self.place[0] = chunk.start
            self.carry[k.C_STOP] = 1.0
            self.carry[k.C_SPINDLE] = k.SPINDLE_UNSEEN
            self.carry[k.C_SKIPPED] = 0.0
            self.carry[k.C_FRAME] = self.tables.forms[chunk.start_frame]
        room = self.used + len(rows) + 2
        if room > len(self.queue):
            larger = np.empty((room + room // 4, k.QUEUE_WIDTH))
            larger[: self.used] = self.queue[: self.used]
            self.queue = larger
        self.counts[:] = 0
        planned = k.PlannedRows(*(rows[name] for name in k.PlannedRows._fields))
        period, ramp = _interpolation_time(self.machine), self.machine.controller.spindle_ramp_time
        rules = k.PlanRules(self.tables.forms, self.tables.chords, self.limits, period, ramp)
        kept = k.PlanMemory(self.place, self.carry, self.moved, self.counts, self.notes)
        self.used = k.measure.pick(chunk.work)(
            planned, chunk.begin, joined, rules, kept, self.queue, self.used, chunk.last
        )

    def noted(self, kind: int) -> Iterator[int]:
        """The first rows of the section with a note of that kind, from the last ``feed``."""
        yield from self.notes[kind, : min(int(self.counts[kind]), k.KEPT)].tolist()

    def lacking(self) -> list[tuple[str, tuple[str, ...]]]:
        """(axis name, what the machine file does not say) of axes that moved."""
        return [(AXIS_NAMES[i], self.missing[i]) for i in range(AXES) if self.moved[i] and self.missing[i]]

    def report_feeds(self, chunk: Chunk, findings: Findings) -> None:
        """GP501 for each feed that the axes could not follow, once for each change of feed or state."""
        rows = chunk.rows
        for row in self.noted(k.N_OVER):
            at = row - chunk.begin
            before = chunk.start if at == 0 else tuple(rows["to"][at - 1].tolist())
            linear = rows["op"][at] == Op.ARC or max(abs(rows["to"][at][:3] - before[:3])) > k.SHORTEST
            feed, unit = float(rows["feed"][at]), "mm" if linear else "deg"
            findings.add(codes.FEED_OVER_MAXIMUM.at(row_span(chunk.trace, rows, at), feed=feed, unit=unit))
        hidden = int(self.counts[k.N_OVER]) - k.KEPT
        if hidden > 0:
            number = codes.FEED_OVER_MAXIMUM.number
            findings.counts[number] = findings.counts.get(number, 0) + hidden


class MotionEstimate:
    """Time and path length of a job while it streams by; the look-ahead is exact, memory bounded by braking distance.

    ``feed`` gets every chunk in order, then ``finish``. Unknown offsets do not matter where start and end of a
    row have the same ones. unknown_rows counts moves whose length is not known, which are left out, moves
    whose feed is not known, which go as fast as the axes allow, and dwells of unknown time: when it is
    not 0, time and length are lower bounds. With ``findings``, GP501 is reported there.
    """

    def __init__(self, machine: Machine, findings: Findings | None = None) -> None:
        self._measure = _Measure(machine, stepped=False)
        self._findings = findings
        self._totals = np.zeros(k.TOTALS_WIDTH)
        self._nothing = np.empty((0, k.OUT_WIDTH))
        self._waiting = 0
        self._retimed = False
        self.unknown_rows = 0

    def feed(self, chunk: Chunk) -> None:
        """Some successive rows."""
        m = self._measure
        m.feed(chunk)
        changed = {n for n, state in enumerate(chunk.trace.states) if state.retimed}
        if changed and not self._retimed:
            moved = chunk.rows["state"][chunk.rows["op"] < Op.DWELL]
            self._retimed = bool(np.isin(moved, list(changed)).any())
        self.unknown_rows += int(m.counts[k.N_UNKNOWN] + m.counts[k.N_FEED] + m.counts[k.N_DWELL])
        if self._findings is not None and m.counts[k.N_OVER]:
            m.report_feeds(chunk, self._findings)
        if chunk.last or m.used >= 2 * self._waiting:
            self._settle(chunk.work, closed=chunk.last)

    def finish(self) -> None:
        """After the last chunk: the machine comes to rest."""
        m = self._measure
        m.used = k.finish_row(m.carry, m.queue, m.used)
        m.carry[k.C_STOP] = 1.0
        self._settle(m.used, closed=True)

    def _settle(self, work: int, *, closed: bool) -> None:
        m = self._measure
        done = k.settle.pick(work)(m.queue, m.used, closed, self._totals, self._nothing)
        rest = m.used - done
        if done:
            m.queue[:rest] = m.queue[done : m.used].copy()
        m.used = self._waiting = rest

    @property
    def seconds(self) -> float | None:
        """Time of motion, dwells and spindle starts.

        None when a moving axis has no velocity or acceleration, or the program has changed those of the machine file.
        """
        return None if self._retimed or self._measure.lacking() else float(self._totals[k.T_TIME])

    @property
    def feed_length_mm(self) -> float:
        """Path length at feed (probing included)."""
        return float(self._totals[k.T_FEED_LENGTH])

    @property
    def traverse_length_mm(self) -> float:
        """Path length of traverses."""
        return float(self._totals[k.T_TRAVERSE_LENGTH])

    @property
    def path_length_mm(self) -> float:
        """Path length, moves of rotary axes alone not counted."""
        return self.feed_length_mm + self.traverse_length_mm

    @property
    def rotary_deg(self) -> float:
        """Degrees of moves of rotary axes alone."""
        return float(self._totals[k.T_FEED_ANGLE] + self._totals[k.T_TRAVERSE_ANGLE])


def plan(
    trace: Trace, machine: Machine, findings: Findings, joined: Sequence[npt.NDArray[np.uint8]] = (),
    rules: LanguageRules | None = None,
) -> Plan | None:  # fmt: skip
    """The Trace with time; None after findings GP503 (positions or feeds unknown) or GP504 (no data of an axis).

    joined: by section, 1 for rows that are one move with the row before them (``lift.Followed``): no stop between.
    rules: of the job's language, for the hints of findings.
    """
    measure = _Measure(machine, stepped=True)
    expected = sum(len(section.rows) for section in trace.sections)
    sections = []
    refusals = Refusals(trace, machine, findings, rules)
    sound = True
    slow: set[str] = set()
    for section in trace.sections:
        chunk = Chunk(
            trace=trace, section=section.number, begin=0, start=section.start, start_frame=section.start_frame,
            rows=section.rows, last=True, expected=expected,
        )  # fmt: skip
        measure.used = 0
        measure.moved[:] = 0
        measure.carry[:] = 0.0
        measure.feed(chunk, joined[section.number] if joined else NOTHING_JOINED)
        sound = refusals.section(chunk, section, measure) and sound
        slow |= {AXIS_NAMES[i] for i in range(AXES) if measure.moved[i]}
        if not sound:
            continue
        measure.report_feeds(chunk, findings)
        totals, out = np.zeros(k.TOTALS_WIDTH), np.zeros((measure.used, k.OUT_WIDTH))
        k.settle.pick(expected)(measure.queue, measure.used, True, totals, out)
        columns = {c.name: np.ascontiguousarray(out[:, at]) for at, c in enumerate(PLAN_ROW.columns)}
        columns["row"] = columns["row"].astype(np.int64)
        rows = Columns(PLAN_ROW, columns)
        sections.append(PlanSection(number=section.number, rows=rows, duration=float(totals[k.T_TIME])))
    refusals.finish()
    _report_rates(machine, slow, Span(trace.files[0], 1), findings)
    return Plan(sections=sections) if sound else None


def _report_rates(machine: Machine, moved: set[str], where: Span, findings: Findings) -> None:
    """GP502 for axes whose greatest velocity needs more steps a second than are allowed."""
    for axis in machine.axes:
        allowed = allowed_velocity(axis, machine)
        if axis.name not in moved or allowed is None:
            continue
        for drive in axis.drives():
            if drive.steps_per_unit is None or drive.max_velocity is None:
                continue
            needed = drive.max_velocity * abs(float(drive.steps_per_unit))
            if needed > step_rate(machine):
                place = findings.where(f"machine.axes.{axis.name}.max_velocity", where)
                findings.add(
                    codes.STEP_FREQUENCY.at(
                        place, axis=drive.name, velocity=drive.max_velocity, unit=axis.unit, needed=needed,
                        allowed=step_rate(machine), hint=f"program a lower feed; it is planned with {allowed:g} "
                                                         f"{axis.unit}/s",
                    )
                )  # fmt: skip
