"""Plan to StepStream: when each motor steps, to the tick.

A motor's count is its position times steps per unit, rounded to the nearest whole number (a half to the even
one); its position is its axis's, through its pitch table where it has one. It steps from n to n + 1 when it passes
(n + 1/2) / steps per unit, and ``step_kernels`` finds those times exactly. Sections, and in them the stretches
between events, are walked one after the other; steps wait in a buffer of bounded size until they are runs, and
backlash is taken up there (``run_encoder``). docs/stream.md states the rules that the stream keeps.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction

import numpy as np
import numpy.typing as npt

from gproof.ir import codes
from gproof.ir.columns import Columns
from gproof.ir.finding import Finding, Findings, Refusal, Span
from gproof.ir.machine import AXIS_NAMES, Axis, Drive, Machine, PitchTable
from gproof.ir.plan import Plan, PlanSection
from gproof.ir.stream import EVENT, Motor, StepStream, StreamSection
from gproof.ir.symbols import describe
from gproof.ir.trace import HEIGHT_MAP, KNIFE, Op, Plane, Trace, TraceSection
from gproof.ir.trace_rows import row_span
from gproof.passes.geometry.backlash import backlash_steps
from gproof.passes.geometry.pitch import exact_motor_position, motor_positions
from gproof.passes.motion import step_kernels as k
from gproof.passes.motion.plan import shortest_interval
from gproof.passes.motion.plan_kernels import SPINDLE_UNSEEN, arc_shapes
from gproof.passes.motion.refusal_hints import ON_ITS_CONTROLLER, TOO_FAR, TOO_FAST, of_forms, of_motor
from gproof.passes.motion.run_encoder import ANY, BUFFER, PLAIN, BacklashEncoder, Encoder, Loops, Spacing

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

TOLERANCE = 25e-6
"""Seconds that compression may move a step, at most; also at most 9/20 of the intervals next to it."""

_FARTHEST = 1e15
"""Steps or ticks: beyond this a float64 does not tell halves apart."""


_KNIFE = (
    "an output lifts the knife at each turn", "the knife turns as fast as it can while X and Y move",
    "the knife's turns are blended at both sides of a corner",
)  # fmt: skip
"""What of a knife has no place of its own in the rows."""


def step(
    trace: Trace, plan: Plan, machine: Machine, findings: Findings, origin: Sequence[Ints] = ()
) -> StepStream | None:
    """The planned job as a stream; None after a finding GP502, GP503, GP504 or GP520.

    trace, machine: what the motors follow (``lift.follow``); origin: by section, the row that an event of a row names;
    not given: the row itself.
    """
    try:
        _refuse_what_has_no_steps(trace, machine)
        stream = _Stepper(trace, plan, machine, findings).stream()
    except Refusal as refusal:
        findings.add(refusal.finding)
        return None
    for section in stream.sections if origin else ():
        events = {c.name: section.events[c.name] for c in EVENT.columns}
        events["row"] = origin[section.number][events["row"]]
        section.events = Columns(EVENT, events)
    return stream


def _refuse_what_has_no_steps(trace: Trace, machine: Machine) -> None:
    """GP520 for what moves motors in ways that only the checks follow."""
    lifted = np.array([HEIGHT_MAP in state.following for state in trace.states], dtype=bool)
    knife = machine.settings.knife
    why = "" if knife is None else _KNIFE[0] if knife.output is not None else _KNIFE[1] if knife.target else ""
    why = why or (_KNIFE[2] if knife is not None and knife.blend else "")
    switched = np.array([bool(why) and KNIFE in state.following for state in trace.states], dtype=bool)
    turned = [axis for axis in machine.axes if axis.tip_feed]
    for section in trace.sections:
        rows = section.rows
        moving = rows["op"] < Op.DWELL
        found = moving & lifted[rows["state"]] if len(lifted) else np.zeros(len(rows), dtype=bool)
        what = "Z follows a height map here"
        if not found.any() and len(switched):
            found, what = moving & switched[rows["state"]], why
        for axis in turned:
            if not found.any():
                found = moving & (rows["to"][:, axis.index] != section.start[axis.index])
                what = f"the feed of {axis.word} is the feed of the tool over the material"
        if found.any():
            where = row_span(trace, rows, int(np.argmax(found)))
            raise Refusal(codes.NOT_STEPPED.at(where, what=what, hint=ON_ITS_CONTROLLER))


def nearest_count(position: float, steps_per_unit: Fraction, pitch: PitchTable | None = None) -> int:
    """The motor's count at a position of its axis: exact, a half rounds to the even neighbour."""
    motor = Fraction(position) if pitch is None else exact_motor_position(pitch, position)
    return round(motor * steps_per_unit)


def nearest_counts(positions: Floats, steps_per_unit: Fraction, pitch: PitchTable | None = None) -> Ints:
    """``nearest_count`` of many positions: in float64, exactly again where that is close to a half."""
    steps = (positions if pitch is None else motor_positions(pitch, positions)) * float(steps_per_unit)
    counts = np.rint(steps).astype(np.int64)
    rounding = 1e-15 if pitch is None else 1e-14
    doubtful = np.abs(np.abs(steps - counts) - 0.5) < 1e-9 + rounding * np.abs(steps)
    values, place = np.unique(positions[doubtful], return_inverse=True)
    exact = np.array([nearest_count(value, steps_per_unit, pitch) for value in values.tolist()], dtype=np.int64)
    counts[doubtful] = exact[place]
    return counts


class _Stepper:
    """What all sections share: motors and the machine's times in ticks."""

    def __init__(self, trace: Trace, plan: Plan, machine: Machine, findings: Findings) -> None:
        self.findings = findings
        self.trace = trace
        self.plan = plan
        self.machine = machine
        board = machine.board
        self.frequency = board.tick_frequency
        near = shortest_interval(machine)
        turn = max(near, math.ceil(Fraction(board.direction_setup) * board.tick_frequency))
        self.spacing = Spacing(near, turn, int(TOLERANCE * board.tick_frequency))
        self.axes = self._axes()

    def _axes(self) -> list[Axis]:
        """Axes with a motor: those with steps per unit; GP504 for each that moves and has none."""
        lacking: dict[int, Finding] = {}
        for section, planned in zip(self.trace.sections, self.plan.sections, strict=True):
            rows, moving = section.rows, planned.rows["row"][planned.rows["length"] > 0]
            for index, name in enumerate(AXIS_NAMES):
                axis = self.machine.axis(name)
                stepped = axis is not None and all(drive.steps_per_unit is not None for drive in axis.drives())
                if stepped or index in lacking:
                    continue
                moves = (rows["to"][moving, index] != section.start[index]) | _in_plane(rows, moving, index)
                if moves.any():
                    missing = "axis" if axis is None else "steps per unit"
                    lacking[index] = codes.NO_MOTOR_DATA.at(
                        row_span(self.trace, rows, int(moving[np.argmax(moves)])), axis=name.upper(),
                        missing=missing, hint=of_motor(axis, name, [missing]),
                    )  # fmt: skip
        if lacking:
            *others, last = lacking.values()
            for finding in others:
                self.findings.add(finding)
            raise Refusal(last)
        return [axis for axis in self.machine.axes if all(d.steps_per_unit is not None for d in axis.drives())]

    def stream(self) -> StepStream:
        motors = []
        for axis in self.axes:
            for drive in axis.drives():
                assert drive.steps_per_unit is not None
                motors.append(Motor(name=drive.name, axis=axis.index, steps_per_unit=drive.steps_per_unit))
        sections = [
            _Section(self, section, planned).walk()
            for section, planned in zip(self.trace.sections, self.plan.sections, strict=True)
        ]
        return StepStream(tick_frequency=self.frequency, motors=tuple(motors), sections=sections)


def _in_plane(rows: Columns, at: Ints, axis: int) -> npt.NDArray[np.bool_]:
    """Which of the rows are arcs with this axis in their plane."""
    plane = rows["plane"][at]
    normal = {0: Plane.YZ, 1: Plane.XZ, 2: Plane.XY}.get(axis, Plane.NONE)
    return np.asarray((plane != 0) & (plane != normal) & (axis < 3))


def _as_stepped(drive: Drive) -> Drive:
    """The drive without what does not matter to when it steps."""
    return drive._replace(name="", lower=None, upper=None, travel_lower=None, travel_upper=None)


class _Section:
    """One section: events in row order, the motion between two of them at a time."""

    def __init__(self, stepper: _Stepper, section: TraceSection, planned: PlanSection) -> None:
        self.stepper = stepper
        self.section = section
        self.rows = section.rows
        trace = stepper.trace
        for axis in stepper.axes:
            form = trace.frames[section.start_frame][axis.index]
            if form:
                cause = f"{axis.word} depends on {describe(form)}"
                where = row_span(trace, self.rows, 0) if len(self.rows) else Span(trace.files[0], 1)
                raise Refusal(codes.PLAN_NEEDS_NUMBERS.at(where, cause=cause, hint=of_forms([form])))
        self._open_loop()
        if planned.duration * stepper.frequency > _FARTHEST:
            at = int(planned.rows["row"][np.argmax(planned.rows["duration"])])
            cause = f"the section takes {planned.duration:.3g} s, more than the board's ticks can count"
            where = row_span(trace, self.rows, at)
            raise Refusal(codes.PLAN_NEEDS_NUMBERS.at(where, cause=cause, hint="program a higher F or a shorter dwell"))
        op = self.rows["op"]
        self.events = np.flatnonzero(((op >= Op.DWELL) & (op <= Op.HOME)) | (op == Op.SETPOINT))
        timed = planned.rows
        moving = timed["length"] > 0
        self.moving: Ints = timed["row"][moving]
        names = ("begin", "duration", "length", "entry", "cruise", "exit", "acceleration")
        self.profile = np.column_stack([timed[name][moving] for name in names])
        before = np.vstack([np.array(section.start).reshape(1, -1), self.rows["to"]])
        self.starts = np.ascontiguousarray(before[self.moving])
        self.ends = np.ascontiguousarray(self.rows["to"][self.moving])
        self.arcs = np.flatnonzero(self.rows["op"][self.moving] == Op.ARC)
        self.shapes = self._shapes()
        self.spindle = SPINDLE_UNSEEN
        motion = np.flatnonzero(self.rows["op"] < Op.DWELL)
        self.last = tuple(self.rows["to"][motion[-1]].tolist()) if len(motion) else section.start

    def _open_loop(self) -> None:
        """Refusal GP511 for what depends on where the spindle is, or on which head turns."""
        trace, rows = self.stepper.trace, self.rows
        follows = np.array([state.synchronised for state in trace.states], dtype=np.bool_)
        synchronised = (rows["op"] < Op.DWELL) & follows[rows["state"]]
        for found, what in (
            (synchronised, "this move follows the turns of the spindle"),
            (rows["op"] == Op.ORIENT, "the spindle stops at a fixed angle"),
            ((rows["op"] == Op.HEAD) & (rows["arg"][:, 0] != 0), "another head is selected"),
        ):
            if found.any():
                where = row_span(trace, rows, int(np.argmax(found)))
                raise Refusal(codes.SYNCHRONISED_STREAM.at(where, what=what, hint=ON_ITS_CONTROLLER))

    def _shapes(self) -> Floats:
        """(arcs, 4): start angle, sweep, start radius, end radius."""
        shapes = np.zeros((len(self.arcs), 4))
        at = self.moving[self.arcs]
        if len(at):
            arc_shapes.pick(len(at))(
                self.starts[self.arcs], self.ends[self.arcs], self.rows["center"][at], self.rows["turns"][at],
                self.rows["plane"][at], shapes,
            )  # fmt: skip
        return shapes

    def walk(self) -> StreamSection:
        """All motion and events of the section."""
        stepper, f = self.stepper, self.stepper.frequency
        places: list[int] = []
        motors: list[_Steps] = []
        for axis in stepper.axes:
            alike: dict[Drive, int] = {}
            for drive in axis.drives():
                # Motors of one axis that step alike are worked out once.
                place = alike.setdefault(_as_stepped(drive), len(motors))
                if place == len(motors):
                    motors.append(_Steps(self, axis, drive))
                places.append(place)
        loops = Loops.pick(sum(motor.expected for motor in motors))
        for motor in motors:
            motor.loops = motor.encoder.loops = loops
        pieces = [*np.searchsorted(self.moving, self.events).tolist(), len(self.moving)]
        ticks = np.zeros(len(self.events), dtype=np.int64)
        now = first = 0
        for number, last in enumerate(pieces):
            end = now
            if last > first:
                base = self.profile[first, k.R_BEGIN]
                close = self.profile[last - 1, k.R_BEGIN] + self.profile[last - 1, k.R_DURATION] - base
                self.profile[first:last, k.R_BEGIN] -= base
                end = now + math.ceil(close * f)
                floor = now + 1 if number else stepper.spacing.turn
                # An event follows the last step, never at the same tick.
                end = max([end, *(motor.run(first, last, now, floor, end) + 1 for motor in motors)])
            if number < len(self.events):
                ticks[number] = end
                end += self._wait(int(self.events[number]))
            now, first = end, last
        for motor in motors:
            now = max(now, motor.settle(now))
        columns = [motor.columns() for motor in motors]
        return StreamSection(
            number=self.section.number, start=tuple(motors[place].start for place in places),
            runs=tuple(columns[place] for place in places), events=self._events(ticks), duration=now,
        )  # fmt: skip

    def _wait(self, row: int) -> int:
        """Ticks of rest after an event: a dwell's time, a spindle's start or reversal."""
        seconds = 0.0
        if self.rows["op"][row] == Op.DWELL:
            seconds = float(self.rows["arg"][row, 0])
        elif self.rows["op"][row] == Op.SPINDLE:
            direction = float(self.rows["arg"][row, 0])
            if direction not in (0.0, self.spindle):
                seconds = self.stepper.machine.controller.spindle_ramp_time
            self.spindle = direction
        return math.ceil(Fraction(seconds) * self.stepper.frequency)

    def _events(self, ticks: Ints) -> Columns:
        arguments = self.rows["arg"][self.events]
        unknown = np.flatnonzero(~(np.abs(arguments) < _FARTHEST).all(axis=1))
        if len(unknown):
            row = int(self.events[unknown[0]])
            name = Op(int(self.rows["op"][row])).name.lower().replace("_", " ")
            where = row_span(self.stepper.trace, self.rows, row)
            hint = "use a plain number in the job, or state what it depends on in [parameters] of the setup file"
            cause = f"an argument of this {name} is unknown"
            raise Refusal(codes.PLAN_NEEDS_NUMBERS.at(where, cause=cause, hint=hint))
        arrays = {
            "tick": ticks,
            "row": self.events.astype(np.int64),
            "op": self.rows["op"][self.events],
            "arg": np.rint(arguments * 1000.0).astype(np.int64),
        }
        return Columns(EVENT, arrays)


class _Steps:
    """One motor in one section: its steps, then its runs."""

    def __init__(self, section: _Section, axis: Axis, drive: Drive) -> None:
        self.section = section
        self.stepper = section.stepper
        self.axis = axis
        self.drive = drive
        assert drive.steps_per_unit is not None
        exact, index = drive.steps_per_unit, axis.index
        self.rate = float(exact)
        ends = np.array([section.section.start[index], *section.ends[:, index], section.last[index]]) * self.rate
        far = np.flatnonzero(~(np.abs(ends) < _FARTHEST))
        if len(far):
            at = min(max(int(far[0]) - 1, 0), len(section.moving) - 1)
            where = row_span(self.stepper.trace, section.rows, int(section.moving[at]) if at >= 0 else 0)
            cause = "the position is too far away to count steps"
            raise Refusal(codes.PLAN_NEEDS_NUMBERS.at(where, cause=cause, hint=TOO_FAR))
        self.start = nearest_count(section.section.start[index], exact, drive.pitch)
        self.end = nearest_count(section.last[index], exact, drive.pitch)
        self.knots = np.zeros((0, 2))
        if drive.pitch is not None:
            knots = np.column_stack([drive.pitch.machine, drive.pitch.calibrated]) * self.rate
            self.knots = np.ascontiguousarray(knots if self.rate > 0 else knots[::-1])
        self.motor = np.zeros((len(section.moving), k.MOTOR_WIDTH))
        self.motor[:, k.M_FROM] = section.starts[:, index] * self.rate
        self.motor[:, k.M_TO] = section.ends[:, index] * self.rate
        self._fill_arcs()
        self.target = nearest_counts(section.ends[:, index], exact, drive.pitch)
        self.target[-1:] = self.end  # with moves after it that are too short to be planned
        self.expected = self._expected()
        self.loops = PLAIN
        size = min(BUFFER, int(self.expected) + 64)
        spacing = self.stepper.spacing
        self.encoder = Encoder(spacing, size)
        if backlash_steps(drive):
            self.encoder = BacklashEncoder(spacing, size, drive, self.start, self.stepper.frequency)
        self.encoder.steps.state[k.S_COUNT] = self.start

    def _fill_arcs(self) -> None:
        section, index = self.section, self.axis.index
        if index >= section.rows["center"].shape[1]:
            return
        turning = _in_plane(section.rows, section.moving[section.arcs], index)
        at, shapes = section.arcs[turning], section.shapes[turning]
        plane = section.rows["plane"][section.moving[at]]
        # The pairs are X Y, Z X and Y Z: the second of a pair follows the sine, a cosine a quarter turn earlier.
        second = ((plane == Plane.XY) & (index == 1)) | ((plane == Plane.XZ) & (index == 0)) | (
            (plane == Plane.YZ) & (index == 2)
        )  # fmt: skip
        self.motor[at, k.M_ANGLE] = shapes[:, 0] - np.where(second, 0.5 * math.pi, 0.0)
        self.motor[at, k.M_SWEEP] = shapes[:, 1]
        self.motor[at, k.M_RADIUS] = shapes[:, 2]
        self.motor[at, k.M_RADIUS_TO] = shapes[:, 3]
        self.motor[at, k.M_CENTER] = section.rows["center"][section.moving[at], index] * self.rate

    def _expected(self) -> float:
        """About how many steps, for the choice of kernels."""
        lines = np.abs(self.motor[:, k.M_TO] - self.motor[:, k.M_FROM]).sum()
        turns = np.abs(self.motor[:, k.M_SWEEP]) / math.pi + 1.0
        return float(lines + (2.0 * turns * self.motor[:, k.M_RADIUS] * abs(self.rate)).sum())

    def run(self, first: int, last: int, origin: int, floor: int, end: int) -> int:
        """Motion rows first..last-1, which start at tick ``origin`` at rest; returns the tick of the last step."""
        near, turn, _ = self.stepper.spacing
        self.encoder.begin(floor)
        while True:
            steps = self.encoder.steps
            first, steps.count = self.loops.step_times(
                first, last, self.section.profile, self.motor, self.target, self.rate, float(self.stepper.frequency),
                origin, near, turn, steps.state, steps.ticks, steps.signs, steps.count, self.knots,
            )  # fmt: skip
            if first == last:
                break
            self.encoder.make_room(floor)
        self.encoder.flush(floor, end)
        self._refuse_if_late(first - 1)
        return self.encoder.last

    def settle(self, now: int) -> int:
        """At the section's end: a last step where moves too short to be planned ended past a half step."""
        near, turn, _ = self.stepper.spacing
        while (at := int(self.encoder.steps.state[k.S_COUNT])) != self.end:
            sign, steps = (1 if self.end > at else -1), self.encoder.steps
            steps.count = k.put_step(now, sign, near, turn, steps.state, steps.ticks, steps.signs, steps.count)
            steps.state[k.S_COUNT] += sign
            self.encoder.flush(0, ANY)
        self.encoder.rest(now)
        return self.encoder.last

    def _refuse_if_late(self, row: int) -> None:
        """GP502 when steps had to give way by more than what rounding and starts from rest explain."""
        s = self.stepper
        if not self.encoder.late:
            return
        profile = self.section.profile
        distance = np.abs(self.motor[:, k.M_TO] - self.motor[:, k.M_FROM]) + np.abs(
            self.motor[:, k.M_SWEEP] * self.motor[:, k.M_RADIUS] * self.rate
        )
        speeds = distance / profile[:, k.R_LENGTH] * profile[:, k.R_CRUISE]
        at = int(np.argmax(speeds[: row + 1]))
        needed = float(speeds[at])
        where = row_span(s.trace, self.section.rows, int(self.section.moving[at]))
        raise Refusal(
            codes.STEP_FREQUENCY.at(
                where, axis=self.drive.name, velocity=needed / abs(self.rate), unit=self.axis.unit,
                needed=needed, allowed=s.frequency / s.spacing.near, hint=TOO_FAST,
            )
        )  # fmt: skip

    def columns(self) -> Columns:
        """The motor's runs."""
        return self.encoder.columns()
