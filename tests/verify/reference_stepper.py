"""A slow, plain stepper for the tests: each row from rest to rest with a trapezoid, one step at a time.

Written from the definitions alone (trace rows, rounding of positions, events): it shares nothing with the
passes or with the checker. Steps are lists of (tick, direction), so that tests can spoil them easily.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import pairwise

import numpy as np

from gproof.ir.columns import Columns
from gproof.ir.machine import AXIS_NAMES, Axis, AxisKind, Board, Controller, Machine
from gproof.ir.stream import EVENT, RUN, Motor, StepStream, StreamSection
from gproof.ir.trace import TRACE_ROW, Edge, Op, State, Trace, TraceSection, Wait

Steps = list[tuple[int, int]]
PAIRS = {1: (0, 1, 2), 2: (2, 0, 1), 3: (1, 2, 0)}
EVENTS = {Op.DWELL, Op.SPINDLE, Op.COOLANT, Op.TOOL_CHANGE, Op.OUTPUT, Op.INPUT_WAIT, Op.STOP, Op.HOME, Op.SETPOINT}
WAITS = {
    Op.STOP: Wait.OPERATOR,
    Op.TOOL_CHANGE: Wait.TOOL_CHANGE,
    Op.INPUT_WAIT: Wait.INPUT,
    Op.HOME: Wait.HOME,
    Op.PROBE: Wait.PROBE,
}
"""Edges after rows that wait."""
NOTES = {Op.OFFSET, Op.TOOL_OFFSET, Op.UNITS, Op.PLANE, Op.OVERRIDE, Op.PATH_MODE, Op.GUARD, Op.MESSAGE}
"""Rows after which a wait is still the last thing."""


def machine(**changes: object) -> Machine:
    """Four axes, one of them rotary; Y is wired the other way round, Z has a resolution that is no whole number."""
    limits = {"lower": -100.0, "upper": 300.0, "max_velocity": 100.0, "max_acceleration": 500.0}
    axes = (
        Axis(name="x", kind=AxisKind.LINEAR, steps_per_unit=Fraction(80), **limits),
        Axis(name="y", kind=AxisKind.LINEAR, steps_per_unit=Fraction(-80), **limits),
        Axis(name="z", kind=AxisKind.LINEAR, steps_per_unit=Fraction(1600, 7), **limits),
        Axis(
            name="a",
            kind=AxisKind.ROTARY,
            steps_per_unit=Fraction(40, 3),
            max_velocity=360.0,
            max_acceleration=2000.0,
        ),
    )
    values: dict[str, object] = {
        "name": "test",
        "axes": axes,
        "controller": Controller(max_step_frequency=125_000.0),
        "board": Board(),
    }
    return Machine(**(values | changes))  # type: ignore[arg-type]


@dataclass
class Job:
    """A trace section in the making; positions in mm and degrees."""

    start: tuple[float, ...] = (0.0,) * 6
    rows: list[dict[str, object]] = field(default_factory=list)
    states: list[State] = field(default_factory=lambda: [State()])

    @property
    def here(self) -> tuple[float, ...]:
        return self.rows[-1]["to"] if self.rows else self.start  # type: ignore[return-value]

    def add(self, op: Op, **values: object) -> "Job":
        row: dict[str, object] = {"op": op, "to": self.here, "line": len(self.rows) + 1, "state": len(self.states) - 1}
        self.rows.append(row | values)
        return self

    def target(self, **axes: float) -> tuple[float, ...]:
        return tuple(axes.get(name, old) for name, old in zip(AXIS_NAMES, self.here, strict=True))

    def rapid(self, **axes: float) -> "Job":
        return self.add(Op.TRAVERSE, to=self.target(**axes))

    def line(self, feed: float = 1200.0, **axes: float) -> "Job":
        return self.add(Op.FEED, to=self.target(**axes), feed=feed)

    def arc(
        self, center: tuple[float, float], turns: int, plane: int = 1, feed: float = 1200.0, **axes: float
    ) -> "Job":
        place = list(self.here[:3])
        first, second, _ = PAIRS[plane]
        place[first], place[second] = center
        return self.add(Op.ARC, to=self.target(**axes), center=tuple(place), turns=turns, plane=plane, feed=feed)

    def event(self, op: Op, *arg: float) -> "Job":
        return self.add(op, arg=(*arg, 0.0, 0.0)[:2])

    def state(self, state: State) -> "Job":
        self.states.append(state)
        return self

    def columns(self) -> Columns:
        arrays = TRACE_ROW.empty(len(self.rows))
        for k, row in enumerate(self.rows):
            for name, value in row.items():
                arrays[name][k] = value
        return Columns(TRACE_ROW, arrays)

    def trace(self) -> Trace:
        """One section that ends the program, or in the wait of its last row."""
        acting = [row["op"] for row in self.rows if row["op"] not in NOTES]
        last = acting[-1] if acting else None
        waiting = WAITS.get(last)  # type: ignore[call-overload]
        job = self if last is Op.END or waiting else Job(self.start, list(self.rows), self.states).add(Op.END)
        edge = Edge(wait=waiting or Wait.END, outcome="go on" if waiting else "end", target=-1)
        section = TraceSection(number=0, start=self.start, start_frame=0, rows=job.columns(), edges=(edge,))
        return Trace(files=["job.cnc"], states=list(self.states), texts=["pwm"], sections=[section])


@dataclass
class Stepped:
    """A section as lists: steps by motor, events as (tick, row, op, arg)."""

    start: list[int]
    steps: list[Steps]
    events: list[tuple[int, int, int, tuple[int, int]]]
    duration: int

    def copy(self) -> "Stepped":
        return Stepped(list(self.start), [list(s) for s in self.steps], list(self.events), self.duration)

    def merged(self) -> list[tuple[int, int, int]]:
        """(tick, motor, direction) in time order."""
        return sorted((t, m, d) for m, steps in enumerate(self.steps) for t, d in steps)

    def section(self, number: int = 0) -> StreamSection:
        events = EVENT.empty(len(self.events))
        for k, (tick, row, op, arg) in enumerate(self.events):
            events["tick"][k], events["row"][k], events["op"][k], events["arg"][k] = tick, row, op, arg
        return StreamSection(
            number=number,
            start=tuple(self.start),
            runs=tuple(encode(steps) for steps in self.steps),
            events=Columns(EVENT, events),
            duration=self.duration,
        )


def encode(steps: Steps) -> Columns:
    """Runs of one direction and equally growing intervals; exact."""
    runs: list[list[int]] = []
    before = 0
    for tick, direction in steps:
        interval = tick - before
        before = tick
        if runs and runs[-1][3] == direction:
            first, count, add, _ = runs[-1]
            if count == 1:
                runs[-1] = [first, 2, interval - first, direction]
                continue
            if interval == first + add * count:
                runs[-1][1] = count + 1
                continue
        runs.append([interval, 1, 0, direction])
    table = np.array(runs, dtype=np.int64).reshape(-1, 4)
    names = [c.name for c in RUN.columns]
    return Columns(RUN, {n: table[:, k].astype(RUN.by_name[n].dtype) for k, n in enumerate(names)})


Place = Callable[[float, int], float]


def path_of(row: dict[str, object], start: tuple[float, ...]) -> tuple[Place, list[float], float]:
    """An axis' position at share u of the row's length, the shares where it may turn round, and its length."""
    to = row["to"]
    assert isinstance(to, tuple)
    delta = [b - a for a, b in zip(start, to, strict=True)]

    def straight(u: float, axis: int) -> float:
        return start[axis] + delta[axis] * u

    if row["op"] != Op.ARC:
        return straight, [0.0, 1.0], math.hypot(*delta[:3]) or math.hypot(*delta[3:])
    first, second, third = PAIRS[int(row["plane"])]  # type: ignore[call-overload]
    center, turns = row["center"], int(row["turns"])  # type: ignore[call-overload]
    assert isinstance(center, tuple)
    begin = (start[first] - center[first], start[second] - center[second])
    end = (to[first] - center[first], to[second] - center[second])
    r0, r1 = math.hypot(*begin), math.hypot(*end)
    angle = math.atan2(begin[1], begin[0])
    sweep = math.atan2(end[1], end[0]) - angle
    if turns > 0:
        sweep = sweep if sweep > 0 else sweep + 2 * math.pi
        sweep += 2 * math.pi * (turns - 1)
    else:
        sweep = sweep if sweep < 0 else sweep - 2 * math.pi
        sweep += 2 * math.pi * (turns + 1)

    def at(u: float, axis: int) -> float:
        if u < 1.0:
            if axis == first:
                return center[first] + (r0 + (r1 - r0) * u) * math.cos(angle + sweep * u)
            if axis == second:
                return center[second] + (r0 + (r1 - r0) * u) * math.sin(angle + sweep * u)
        return start[axis] + delta[axis] * u

    quarters = sorted((angle, angle + sweep))
    shares = [0.0, 1.0]
    for k in range(math.ceil(quarters[0] / (math.pi / 2)), math.floor(quarters[1] / (math.pi / 2)) + 1):
        shares.append(min(1.0, max(0.0, (k * math.pi / 2 - angle) / sweep)))
    return at, sorted(set(shares)), math.hypot(0.5 * (r0 + r1) * sweep, delta[third])


def limits_of(row: dict[str, object], start: tuple[float, ...], length: float, on: Machine) -> tuple[float, float]:
    """Velocity and acceleration along the row's path that no axis minds."""
    feed = float(row.get("feed", 0.0)) / 60 or 1e9  # type: ignore[arg-type]
    speed, acceleration = feed, 1e9
    to = row["to"]
    assert isinstance(to, tuple)
    for axis in on.axes:
        share = abs(to[axis.index] - start[axis.index]) / length
        if row["op"] == Op.ARC:
            share = max(share, 1.0 if axis.index < 3 else share)
        if share:
            speed = min(speed, (axis.max_velocity or 1e9) / share)
            acceleration = min(acceleration, (axis.max_acceleration or 1e9) / share)
    if row["op"] == Op.ARC:
        center = row["center"]
        assert isinstance(center, tuple)
        first, second, _ = PAIRS[int(row["plane"])]  # type: ignore[call-overload]
        radius = math.hypot(start[first] - center[first], start[second] - center[second])
        acceleration /= 2
        speed = min(speed, math.sqrt(acceleration * radius))
    return speed, acceleration


def crossings(at: Place, shares: list[float], axis: int, spu: Fraction, straight: bool) -> list[tuple[float, int]]:
    """(share, direction) of each half step that a motor passes."""
    scale = float(spu)
    found = []
    for low, high in pairwise(shares):
        a, b = at(low, axis) * scale, at(high, axis) * scale
        direction = 1 if b > a else -1
        edge = math.floor(a + 0.5) + 0.5 if direction > 0 else math.ceil(a - 0.5) - 0.5
        while edge < b if direction > 0 else edge > b:
            if straight:
                found.append(((edge - a) / (b - a), direction))
                edge += direction
                continue
            lo, hi = low, high
            for _ in range(45):
                middle = 0.5 * (lo + hi)
                if (at(middle, axis) * scale - edge) * direction < 0:
                    lo = middle
                else:
                    hi = middle
            found.append((hi, direction))
            edge += direction
    return found


def time_at(s: float, length: float, speed: float, acceleration: float) -> float:
    """When a trapezoid from rest to rest has come ``s`` far."""
    v = min(speed, math.sqrt(acceleration * length))
    ramp, total = v * v / (2 * acceleration), length / v + v / acceleration
    if s <= ramp:
        return math.sqrt(2 * s / acceleration)
    if s >= length - ramp:
        return total - math.sqrt(max(0.0, 2 * (length - s) / acceleration))
    return v / acceleration + (s - ramp) / v


def motors_of(on: Machine) -> tuple[Motor, ...]:
    return tuple(
        Motor(name=drive.name, axis=a.index, steps_per_unit=drive.steps_per_unit)
        for a in on.axes
        for drive in a.drives()
        if drive.steps_per_unit is not None
    )


def step(job: Job, on: Machine) -> Stepped:
    """The job's one section, step by step."""
    frequency = on.board.tick_frequency
    motors = motors_of(on)
    start = [round(Fraction(job.start[m.axis]) * m.steps_per_unit) for m in motors]
    done = Stepped(start, [[] for _ in motors], [], 0)
    clock, place = 0.0, job.start
    spinning = 0.0
    for number, row in enumerate(job.rows):
        op, to = row["op"], row["to"]
        assert isinstance(to, tuple)
        if op in EVENTS:
            arg = row.get("arg", (0.0, 0.0))
            assert isinstance(arg, tuple)
            tick = math.ceil(clock * frequency)
            done.events.append((tick, number, int(op), tuple(round(a * 1000) for a in arg)))  # type: ignore[arg-type, call-overload]
            wait = arg[0] if op == Op.DWELL else 0.0
            if op == Op.SPINDLE:
                wait = on.controller.spindle_ramp_time if arg[0] not in (0.0, spinning) else 0.0
                spinning = arg[0]
            clock = (tick + math.ceil(wait * frequency)) / frequency
            continue
        if op not in (Op.TRAVERSE, Op.FEED, Op.ARC, Op.PROBE) or (to == place and op != Op.ARC):
            continue
        at, shares, length = path_of(row, place)
        speed, acceleration = limits_of(row, place, length, on)
        for m, motor in enumerate(motors):
            for share, direction in crossings(at, shares, motor.axis, motor.steps_per_unit, op != Op.ARC):
                t = clock + time_at(share * length, length, speed, acceleration)
                done.steps[m].append((max(1, round(t * frequency)), direction))
        clock += time_at(length, length, speed, acceleration)
        place = to
    done.duration = math.ceil(clock * frequency) + 1
    return done


def stream_of(done: Stepped, on: Machine) -> StepStream:
    return StepStream(tick_frequency=on.board.tick_frequency, motors=motors_of(on), sections=[done.section()])
