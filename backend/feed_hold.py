"""Feed hold: a TimeMap that brings a section to rest along its path and lets it go on later.

With playback rate f (1: as planned) an axis that is planned to move at v and accelerate at a moves at
v*f and accelerates at a*f**2 + v*df/ds, s being wall time. With q = f**2 and planned time t that is
a*q + v/2*dq/dt: linear in q and its slope. So the fastest fall of q that keeps every axis within its
acceleration is dq/dt = -min over axes of 2*(A + sign(v)*a*q)/|v|, integrated from the tick of the request;
the rise afterwards is the same with the other sign. Velocities only fall, since f never exceeds 1.
Where the plan already brakes as hard as it may there is nothing to gain, and q stays until that is over.

v and a are measured from the steps themselves, over a window in which half a step of rounding changes the
acceleration by less than a twentieth of what is allowed; ``margin`` is the part of the acceleration that is
used. The result is a proposal: the runtime validates what comes of it and tries smaller margins.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from gproof.backend.runs import cut, done_by, expand
from gproof.backend.time_map import MapBuilder, TimeMap
from gproof.ir.machine import Machine
from gproof.ir.record import record
from gproof.ir.stream import Motor, StreamSection

Floats = npt.NDArray[np.float64]

MARGINS = (0.9, 0.7, 0.45, 0.2)
"""Parts of the acceleration to try, in this order."""

QUICKEST_RAMP = 0.02
"""Seconds from full speed to rest at least, where no axis requires more."""

CELL = 0.001
"""Seconds of wall time in which the rate is constant: velocity changes in jumps of acceleration * CELL."""

_AHEAD = 1.0  # seconds of motion that are measured at a time
_NEAR = 4  # samples of the window on either side


@record(frozen=True, slots=True)
class Hold:
    """A feed hold in a section: the map, the tick at which rest starts after it, and how long it lasts."""

    times: TimeMap
    rest_begins: int
    rest: int


@record(frozen=True, slots=True)
class _Bounds:
    """Rates of change of q that all axes allow around each sample, times ``step`` apart from ``begin``.

    falling: (n,) constant part and (n,) part that grows with q of the fastest fall; rising alike.
    """

    begin: int
    step: float
    speed: Floats
    helps_fall: Floats
    helps_rise: Floats
    allowed: Floats


class _Motion:
    """Velocity and acceleration of each motor, in steps and seconds, measured from a section's steps."""

    def __init__(self, section: StreamSection, motors: tuple[Motor, ...], machine: Machine, frequency: int):
        self.section = section
        self.frequency = frequency
        drives = {axis.index: axis.drives() for axis in machine.axes}
        places = [sum(m.axis == other.axis for other in motors[:k]) for k, m in enumerate(motors)]
        most = [
            drives[m.axis][place].max_acceleration if place < len(drives.get(m.axis, ())) else None
            for m, place in zip(motors, places, strict=True)
        ]
        self.allowed = np.array(
            [(a or math.inf) * abs(float(m.steps_per_unit)) for a, m in zip(most, motors, strict=True)]
        )
        least = float(min(self.allowed, default=math.inf))
        window = math.sqrt(40.0 / least) if 0 < least < math.inf else 0.0
        self.window = min(0.05, max(machine.controller.interpolation_time, window))
        self.step = self.window / _NEAR * frequency  # ticks between samples

    def measure(self, begin: int, count: int) -> _Bounds:
        """Bounds at ``count`` samples from tick ``begin`` on."""
        pad = 2 * _NEAR + 1
        ticks: Floats = begin + self.step * (np.arange(count + 2 * pad, dtype=np.float64) - pad)
        n = len(self.allowed)
        speed, fall, rise = np.zeros((count, n)), np.zeros((count, n)), np.zeros((count, n))
        for m in range(n):
            p = self._positions(m, ticks)
            v = np.zeros(len(p))
            a = np.zeros(len(p))
            before, here, behind = p[: -2 * _NEAR], p[_NEAR:-_NEAR], p[2 * _NEAR :]
            v[_NEAR:-_NEAR] = (behind - before) / (2 * self.window)
            a[_NEAR:-_NEAR] = (behind - 2 * here + before) / (self.window * self.window)
            towards = np.where(v >= 0, a, -a)  # positive: the plan speeds up
            near = np.arange(count)[:, None] + pad + np.arange(-_NEAR, _NEAR + 2)[None, :]
            speed[:, m] = np.abs(v)[near].max(axis=1)
            fall[:, m] = towards[near].min(axis=1)
            rise[:, m] = (-towards[near]).min(axis=1)
        return _Bounds(begin, self.step, speed, fall, rise, self.allowed)

    def _positions(self, motor: int, ticks: Floats) -> Floats:
        """Where the motor is planned to be: halfway between two counts at each step."""
        runs = self.section.runs[motor]
        begin, end = int(ticks[0]) - 1, int(ticks[-1]) + 1
        done = done_by(runs, begin)
        _, later, last = cut(runs, begin)
        inside = cut(later, end - last)[0]
        at, direction = expand(inside, last)
        if not len(at):
            return np.full(len(ticks), float(done.net))
        counts = done.net + np.cumsum(direction, dtype=np.int64)
        middle = counts - direction / 2.0
        return np.interp(ticks, at, middle)


def hold(
    section: StreamSection,
    motors: tuple[Motor, ...],
    machine: Machine,
    tick_frequency: int,
    *,
    tick: int,
    rest: int,
    margin: float = MARGINS[0],
) -> Hold:
    """Start to slow down at ``tick``, rest for ``rest`` ticks, come back to the planned speed.

    When motion ends before the rate does, the rest follows the last step.
    """
    motion = _Motion(section, motors, machine, tick_frequency)
    last = max((done_by(runs, 2**62).last for runs in section.runs), default=0)
    build = MapBuilder()
    build.shift(min(tick, section.duration))
    if tick < last:
        _ramp(build, motion, _Ramp(tick, last, 1.0, -1.0, margin))
    end, begins = build.source[-1], build.target[-1]
    build.rest(rest)
    if end < last:
        _ramp(build, motion, _Ramp(end, last, 0.0, 1.0, margin))
    return Hold(build.done(), begins, rest)


def ramp_to(
    build: MapBuilder, section: StreamSection, motors: tuple[Motor, ...], machine: Machine, tick_frequency: int,
    *, rate: float, goal: float, margin: float,
) -> None:  # fmt: skip
    """From where a map ends, at ``rate`` of the planned speed, go on until it is ``goal``, or to the last step."""
    begin = build.source[-1]
    last = max((done_by(runs, 2**62).last for runs in section.runs), default=0)
    if rate == goal or begin >= last:
        return
    motion = _Motion(section, motors, machine, tick_frequency)
    _ramp(build, motion, _Ramp(begin, last, rate * rate, 1.0 if goal > rate else -1.0, margin, goal * goal))


@record(frozen=True, slots=True)
class _Ramp:
    """From tick ``begin`` at the latest to ``end``; q starts at ``q`` and moves in the direction of ``sign``."""

    begin: int
    end: int
    q: float
    sign: float
    margin: float
    goal: float | None = None


def _ramp(build: MapBuilder, motion: _Motion, ramp: _Ramp) -> None:
    """Draw q until it reaches its goal (0 or 1 where it has no other) or the last step."""
    line = _Line(build, motion.frequency)
    q, at = ramp.q, float(ramp.begin)
    goal = (0.0 if ramp.sign < 0 else 1.0) if ramp.goal is None else ramp.goal
    count = max(1, int(_AHEAD * motion.frequency / motion.step))
    while True:
        bounds = motion.measure(round(at), count)
        for k in range(count):
            slope = ramp.sign * _slope(bounds, k, q, ramp) / motion.frequency  # per tick
            width = motion.step
            if slope and (goal - q) / slope <= width:
                width, then = max(1.0, math.ceil((goal - q) / slope)), goal
            else:
                then = q + slope * width
            if at + width >= ramp.end:
                then = q + (then - q) * (ramp.end - at) / width
                line.to(at, q, float(ramp.end), then)
                return
            line.to(at, q, at + width, then)
            at, q = at + width, then
            if q == goal:
                return


def _slope(bounds: _Bounds, k: int, q: float, ramp: _Ramp) -> float:
    """How fast q may change here, per second of planned time."""
    helps = bounds.helps_fall[k] if ramp.sign < 0 else bounds.helps_rise[k]
    found = 2.0 / QUICKEST_RAMP
    for speed, help_, allowed in zip(bounds.speed[k].tolist(), helps.tolist(), bounds.allowed.tolist(), strict=True):
        if speed > 0:
            found = min(found, 2.0 * max(0.0, ramp.margin * allowed + help_ * q) / speed)
    return found


class _Line:
    """Draws pieces on which q is linear in planned time, that is f linear in wall time, as small cells."""

    def __init__(self, build: MapBuilder, frequency: int) -> None:
        self.build = build
        self.cell = CELL * frequency
        self.wall = float(build.target[-1])

    def to(self, at: float, q: float, end: float, then: float) -> None:
        """From planned tick ``at`` with ``q`` to ``end`` with ``then``."""
        f, g = math.sqrt(q), math.sqrt(then)
        total = 2.0 * (end - at) / max(f + g, 1e-12)
        parts = max(1, math.ceil(total / self.cell))
        change = (g - f) / total
        for k in range(1, parts + 1):
            passed = total * k / parts
            planned = at + f * passed + change * passed * passed / 2.0
            planned = end if k == parts else planned
            self.build.to(round(planned), round(self.wall + passed))
        self.wall += total
