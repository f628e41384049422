"""The stream's motors against the machine's: whether they are the same, and what bounds each of them.

Problems are tuples of a kind and its numbers.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from fractions import Fraction

import numpy as np

from gproof.ir.drives import AXES, AXIS_NAMES, Drive, Drives
from gproof.ir.stream import StepStream
from gproof.ir.trace import HEIGHT_MAP, Op, Trace, TraceSection, Wait
from gproof.verify.kernel.motor_map import bend, knots_of
from gproof.verify.kernel.path_kernels import ROUNDING
from gproof.verify.kernel.proof import Proof
from gproof.verify.kernel.stream_numbers import FEW, LONG, TOUCH, Why, ticks_up
from gproof.verify.kernel.walk_kernels import SPANS
from gproof.verify.kernel.walk_state import Motors

_PATIENCE = 0.002
"""Seconds, in addition to twice the time that backlash needs: for starts and turns."""


def machine_number_problems(drives: Drives, override: float) -> Iterator[Why]:
    """Numbers of the machine file that the checker cannot reckon with."""
    for name, value, most in (
        ("interpolation time", drives.interpolation_time, 10.0),
        ("step pulse", drives.step_pulse, 1.0),
        ("direction set-up", drives.direction_setup, 1.0),
        ("spindle ramp time", drives.spindle_ramp_time, 1e6),
        ("maximum step frequency", drives.max_step_frequency or 1.0, 1e12),
        ("feed override", override, 1e3),
    ):
        if not 0 <= value <= most:
            yield "form.machine-number", name, value
    if not drives.interpolation_time * drives.tick_frequency >= 1:
        yield "form.interpolation-time", drives.interpolation_time
    for axis in drives.axes:
        for drive in axis.drives:
            for edge in (drive.lower, drive.upper, drive.travel_lower, drive.travel_upper):
                if edge is not None and math.isnan(edge):
                    yield "form.limit", drive.name
        if len(axis.drives) > AXES + 1:
            yield "form.slaves", AXIS_NAMES[axis.column], len(axis.drives) - 1


def machine_problems(stream: StepStream, trace: Trace, drives: Drives) -> Iterator[Why]:
    """Where the stream's motors are not those of the machine."""
    if stream.tick_frequency != drives.tick_frequency:
        yield "form.board-frequency", stream.tick_frequency, drives.tick_frequency
    if len({motor.name for motor in stream.motors}) != len(stream.motors):
        yield "form.motor-names", tuple(motor.name for motor in stream.motors)
    known = {(axis.column, drive.name): drive for axis in drives.axes for drive in axis.drives}
    for motor in stream.motors:
        drive = known.get((motor.axis, motor.name))
        if drive is None:
            yield "form.no-such-motor", motor.name, motor.axis
        elif drive.steps_per_unit != motor.steps_per_unit:
            yield "form.other-steps", motor.name, motor.steps_per_unit, drive.name, drive.steps_per_unit
        elif not motor.steps_per_unit or abs(motor.steps_per_unit) > FEW or abs(1 / motor.steps_per_unit) > FEW:
            yield "form.steps-per-unit", motor.name, motor.steps_per_unit
    for index, name in enumerate(AXIS_NAMES):
        found = sum(motor.axis == index for motor in stream.motors)
        wanted = sum(axis == index for axis, _ in known)
        if found != wanted and (found or any(moves(section, index) for section in trace.sections)):
            yield "form.motors-of-axis", name, found, wanted


def unfollowed(trace: Trace, drives: Drives) -> Iterator[Why]:
    """What moves motors in ways that this checker does not follow."""
    if drives.height_map is None and any(HEIGHT_MAP in state.following for state in trace.states):
        yield ("form.no-height-map",)
    problem = drives.height_map.problem() if drives.height_map is not None else None
    if problem is not None:
        yield "form.height-map", problem
    for name in never_homed(trace, drives):
        yield "form.never-homed", name
    for axis in drives.axes:
        if axis.tip_feed and any(moves(section, axis.column) for section in trace.sections):
            yield "form.tip-feed", AXIS_NAMES[axis.column]


def never_homed(trace: Trace, drives: Drives) -> list[str]:
    """Axes that move on some path through the sections before their reference run, and are stated to have had none."""
    if drives.homed is None or not trace.sections:
        return []
    lost = {AXIS_NAMES[axis.column] for axis in drives.axes} - set(drives.homed)
    if not lost:
        return []
    at: dict[int, set[str]] = {0: lost}
    moving: set[str] = set()
    waiting = [0]
    while waiting:
        number = waiting.pop()
        section = trace.sections[number]
        moving |= {name for name in at[number] if moves(section, AXIS_NAMES.index(name))}
        left = set(at[number])
        for row in np.flatnonzero(section.rows["op"] == Op.HOME).tolist():
            if any(edge.wait is Wait.HOME and edge.outcome == "homed" for edge in section.edges):
                left -= set(trace.texts[int(section.rows["text"][row])].split())
        for edge in section.edges:
            if 0 <= edge.target < len(trace.sections) and (edge.target not in at or left - at[edge.target]):
                at[edge.target] = at.get(edge.target, set()) | left
                waiting.append(edge.target)
    return sorted(moving)


def moves(section: TraceSection, axis: int) -> bool:
    """True when a row ends elsewhere on that axis than the section starts."""
    return bool((section.rows["to"][:, axis] != section.start[axis]).any())


def drive_of_motors(stream: StepStream, drives: Drives) -> list[Drive]:
    """The machine's motor for each motor of a well-formed stream."""
    known = {(axis.column, drive.name): drive for axis in drives.axes for drive in axis.drives}
    return [known[motor.axis, motor.name] for motor in stream.motors]


def motor_arrays(stream: StepStream, drives: Drives, grid: int, proof: Proof, *, stretched: bool) -> Motors:
    """Limits in steps and window bounds; what the machine does not state is left open or assumed."""
    count = len(stream.motors)
    low, high = np.full(count, -LONG, np.int64), np.full(count, LONG, np.int64)
    travel_low, travel_high = np.ones(count, np.int64), np.zeros(count, np.int64)
    speed, acceleration = np.full((3, count), np.inf), np.full((3, count), np.inf)
    slack, patience = np.zeros(count, np.int64), np.zeros(count, np.int64)
    base = grid / stream.tick_frequency
    known = drive_of_motors(stream, drives)
    for m, (motor, drive) in enumerate(zip(stream.motors, known, strict=True)):
        scale = float(abs(motor.steps_per_unit))
        low[m], high[m] = _limits(motor.steps_per_unit, drive.lower, drive.upper)
        slack[m], patience[m] = _backlash(drive, stream.tick_frequency)
        if slack[m]:
            proof.assume("stream-position", "assumed.backlash", motor.name, drive.backlash)
            # Rounded up, the backlash may need a step more than the limit of the axis leaves for it.
            more = int(abs(slack[m]) > abs(Fraction(drive.backlash) * motor.steps_per_unit))
            if drives.limits_programmed:
                more = abs(int(slack[m]))
            low[m], high[m] = (low[m] - more, high[m]) if slack[m] > 0 else (low[m], high[m] + more)
        if None in (drive.lower, drive.upper):
            proof.assume("stream-limit", "assumed.no-limit", motor.name)
        if drive.travel_lower is not None and drive.travel_upper is not None:
            travel_low[m], travel_high[m] = _limits(motor.steps_per_unit, drive.travel_lower, drive.travel_upper)
        for k, width in enumerate(SPANS):
            h = width * base
            if drive.max_velocity is not None:
                speed[k, m] = drive.max_velocity * h * scale + 2 + ROUNDING
            if drive.max_acceleration is not None:
                # Where a pitch table bends, the motor's velocity jumps; a jump counts with at most h.
                jumps = (drive.max_velocity or 0.0) * bend(drive.pitch, 2 * h * (drive.max_velocity or 0.0))
                steady = drive.max_acceleration * h * (h + 2 * base)
                acceleration[k, m] = (steady + jumps * h) * scale + 4 + ROUNDING
        if drive.max_velocity is None:
            proof.leave_open("stream-velocity", "open.no-velocity", motor.name)
        if drive.max_acceleration is None:
            proof.leave_open("stream-acceleration", "open.no-acceleration", motor.name)
    knots = [knots_of(drive.pitch, float(drive.steps_per_unit or 0)) for drive in known]
    return Motors(
        axis=np.array([motor.axis for motor in stream.motors], np.int64),
        spu=np.array([float(motor.steps_per_unit) for motor in stream.motors], np.float64),
        low=low,
        high=high,
        travel_low=travel_low,
        travel_high=travel_high,
        speed=speed,
        acceleration=acceleration,
        knots=np.concatenate([np.zeros((0, 2)), *knots]),
        first_knot=np.cumsum([0, *(len(one) for one in knots)]).astype(np.int64),
        slack=slack,
        patience=np.full(count, LONG, np.int64) if stretched else patience,
    )


def _backlash(drive: Drive, tick_frequency: int) -> tuple[int, int]:
    """Steps from flank to flank, signed, and ticks in which they are to be made: twice what half of the motor's
    acceleration needs, and then some for an axis that turns round meanwhile."""
    exact = Fraction(drive.backlash) * (drive.steps_per_unit or 0)
    velocity, acceleration = drive.max_velocity, drive.max_acceleration
    if not round(exact) or not velocity or not acceleration:
        return 0, 0
    half = acceleration / 2
    fastest = min(math.sqrt(half * drive.backlash), velocity / 2)
    seconds = 2 * (fastest / half + drive.backlash / fastest) + _PATIENCE
    return round(exact), ticks_up(Fraction(seconds), tick_frequency)


def _limits(spu: Fraction, lower: float | None, upper: float | None) -> tuple[int, int]:
    """Whole steps from limit to limit: a limit's own nearest step still belongs to it, either one at a tie."""
    edges = [None if edge is None or math.isinf(edge) else Fraction(edge) * spu for edge in (lower, upper)]
    first, last = edges if spu > 0 else edges[::-1]
    half = Fraction(1, 2) + TOUCH
    low = -LONG if first is None else max(-LONG, math.ceil(first - half))
    high = LONG if last is None else min(LONG, math.floor(last + half))
    return low, high
