"""From Trace, Machine and StepStream to the checker's arrays; what can not be judged is refused here.

Every function that refuses says so with findings and returns None (or False); nothing is corrected.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from fractions import Fraction
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from gproof.ir.codes import STREAM_END, STREAM_EVENT, STREAM_MALFORMED
from gproof.ir.columns import Columns, batches, joined, occurring
from gproof.ir.finding import Span
from gproof.ir.machine import AXES, AXIS_NAMES, Drive, Machine
from gproof.ir.setup import Setup
from gproof.ir.stream import EVENT, RUN, StepStream
from gproof.ir.trace import HEIGHT_MAP, TRACE_ROW, Op, Plane, Trace, TraceSection, Wait
from gproof.verify.explain.stream_report import Collector
from gproof.verify.kernel import stream_kernels as kernels
from gproof.verify.kernel.motor_map import bend, knots_of, motor_at

EVENT_OPS = (
    Op.DWELL,
    Op.SPINDLE,
    Op.COOLANT,
    Op.TOOL_CHANGE,
    Op.OUTPUT,
    Op.INPUT_WAIT,
    Op.STOP,
    Op.HOME,
    Op.SETPOINT,
)
"""Rows that cost time or switch something: motion is at rest there, and each has one event."""

MOTION_OPS = (Op.TRAVERSE, Op.FEED, Op.ARC, Op.PROBE)
assert kernels.ARC_OP == Op.ARC and kernels.LAST_MOTION_OP == Op.PROBE == max(MOTION_OPS)

MOVES, SWITCHES = np.zeros(256, np.bool_), np.zeros(256, np.bool_)
MOVES[list(MOTION_OPS)] = True
SWITCHES[list(EVENT_OPS)] = True
"""By op, whether it is one of these."""

PAIRS = {Plane.XY: (0, 1), Plane.XZ: (2, 0), Plane.YZ: (1, 2)}
"""The axes of an arc, in the order of a right-handed frame."""

Z = 2
"""The axis that a height map raises."""

GUARD = "machine_area"
"""The guard that stands for the soft limits in ``State.guards_off``."""

FARTHEST = 1 << 28
"""Steps: positions and lengths of arcs up to this keep float64's rounding far below ``kernels.ROUNDING``."""

Floats = npt.NDArray[np.float64]

_SURELY = 0.499
"""Steps: what float64 makes of a distance below this is below ``kernels.EXACT`` exactly too."""

_FEW = 1 << 52
_LONG = 1 << 60
_TOUCH = Fraction(1, 10**6)
_PATIENCE = 0.002
"""Seconds, beside twice the time that backlash needs: for starts and turns."""


def span_of(trace: Trace, section: int, row: int) -> Span:
    """The source line of a row; the file as a whole when there is none."""
    rows = trace.sections[section].rows if section < len(trace.sections) else ()
    if isinstance(rows, tuple) or not 0 <= row < len(rows):
        return Span(trace.files[0] if trace.files else "", 0)
    return Span(trace.files[int(rows["file"][row])], int(rows["line"][row]))


def ticks_up(seconds: Fraction, tick_frequency: int) -> int:
    """Whole ticks that last at least ``seconds``; what a float64 adds to a round number does not count."""
    return max(0, math.ceil(seconds * tick_frequency - _TOUCH))


# --- the stream's own numbers -------------------------------------------------------------------------------


def number_problems(stream: StepStream) -> Iterator[str]:
    """What keeps a stream's integers from being added up safely."""
    if not 1 <= stream.tick_frequency <= 10**12:
        yield f"tick frequency {stream.tick_frequency}"
    for begin, end in batches([sum(map(len, s.runs)) for s in stream.sections]):
        if not _numbers_fit(stream, begin, end):
            for place in range(begin, end):
                yield from _number_problems(stream, place)


def _numbers_fit(stream: StepStream, begin: int, end: int) -> bool:
    """True only where ``_number_problems`` finds nothing in any of these sections."""
    sections, motors = stream.sections[begin:end], len(stream.motors)
    for place, s in enumerate(sections, begin):
        if s.number != place or len(s.start) != motors or len(s.runs) != motors or s.events.schema is not EVENT:
            return False
        if not 0 <= s.duration < _LONG or any(abs(n) > _FEW for n in s.start):
            return False
    tables = [r for s in sections for r in s.runs if len(r)]
    if any(r.schema is not RUN for s in sections for r in s.runs):
        return False
    if not tables:
        return True
    interval, count, add, good = _good_runs(joined(RUN, tables))
    if not good.all():
        return False
    first = np.cumsum([0, *(len(r) for r in tables)])[:-1]
    ticks = np.add.reduceat(count * interval + add * (count - 1) * count / 2, first)
    # Sums of doubles come to the same within far less than this factor, in whatever order.
    return bool((np.add.reduceat(count, first) < _FEW / 2).all() and (ticks < _LONG / 2).all())


def _good_runs(runs: Columns) -> tuple[Floats, Floats, Floats, npt.NDArray[np.bool_]]:
    """Intervals, counts and what is added, as doubles; which runs can be added up."""
    interval, count, add = (runs[k].astype(np.float64) for k in ("interval", "count", "add"))
    grown = add * (count - 1)
    good = (interval >= 1) & (count >= 1) & (np.abs(grown) < _FEW) & (interval + grown >= 1)
    good &= (interval * count < _LONG) & (np.abs(grown) * count < _LONG)
    good &= np.abs(runs["direction"]) == 1
    return interval, count, add, good


def _number_problems(stream: StepStream, place: int) -> Iterator[str]:
    s = stream.sections[place]
    where = f"section {s.number}"
    if s.number != place:
        yield f"{where} stands at place {place}"
    if len(s.start) != len(stream.motors) or len(s.runs) != len(stream.motors):
        yield f"{where}: not one start position and one run table for each motor"
        return
    if s.events.schema is not EVENT or any(r.schema is not RUN for r in s.runs):
        yield f"{where}: a table is not one of runs or events"
        return
    if any(abs(n) > _FEW for n in s.start) or not 0 <= s.duration < _LONG:
        yield f"{where}: start {s.start}, duration {s.duration}"
    for motor, runs in zip(stream.motors, s.runs, strict=True):
        interval, count, add, good = _good_runs(runs)
        if not good.all():
            k = int(np.argmin(good))
            yield f"{where}: run {k} of {motor.name} is {tuple(int(runs[c.name][k]) for c in RUN.columns)}"
        elif count.sum() > _FEW or (count * interval + add * (count - 1) * count / 2).sum() > _LONG:
            yield f"{where}: {motor.name} has more steps or ticks than can be counted"


class Sums(NamedTuple):
    """By section and motor, as nested lists: steps made, and what they come to with their signs; first and last tick of
    a step, with their directions (0 where there is none)."""

    steps: list[list[int]]
    net: list[list[int]]
    first: list[list[int]]
    first_way: list[list[int]]
    last: list[list[int]]
    last_way: list[list[int]]


def sums_of(stream: StepStream) -> Sums:
    """Of a stream whose numbers can be added up."""
    shape = (len(stream.sections), len(stream.motors))
    steps, net, first, first_way, last, last_way = (np.zeros(shape, np.int64) for _ in range(6))
    for begin, end in batches([sum(map(len, s.runs)) for s in stream.sections]):
        tables = [r for s in stream.sections[begin:end] for r in s.runs]
        sizes = np.array([len(r) for r in tables], dtype=np.int64).reshape(end - begin, shape[1])
        if not sizes.any():
            continue
        runs = joined(RUN, tables)
        there = sizes > 0
        at = (np.cumsum(sizes) - sizes.ravel())[there.ravel()]
        until = at + sizes[there] - 1
        interval, count, add = runs["interval"], runs["count"], runs["add"]
        way = runs["direction"].astype(np.int64)
        steps[begin:end][there] = np.add.reduceat(count, at)
        net[begin:end][there] = np.add.reduceat(count * way, at)
        last[begin:end][there] = np.add.reduceat(interval * count + add * (count - 1) * count // 2, at)
        first[begin:end][there], first_way[begin:end][there] = interval[at], way[at]
        last_way[begin:end][there] = way[until]
    return Sums(*(array.tolist() for array in (steps, net, first, first_way, last, last_way)))


# --- stream against machine ---------------------------------------------------------------------------------


def machine_number_problems(machine: Machine, override: float) -> Iterator[str]:
    """Numbers of the machine file that the checker can not reckon with."""
    controller, board = machine.controller, machine.board
    for name, value, most in (
        ("interpolation time", controller.interpolation_time, 10.0),
        ("step pulse", board.step_pulse, 1.0),
        ("direction set-up", board.direction_setup, 1.0),
        ("spindle ramp time", controller.spindle_ramp_time, 1e6),
        ("greatest step frequency", controller.max_step_frequency or 1.0, 1e12),
        ("feed override", override, 1e3),
    ):
        if not 0 <= value <= most:
            yield f"{name} {value!r}"
    if not controller.interpolation_time * board.tick_frequency >= 1:
        yield f"interpolation time {controller.interpolation_time!r} is less than a tick"
    for axis in machine.axes:
        for drive in axis.drives():
            for edge in (drive.lower, drive.upper, drive.travel_lower, drive.travel_upper):
                if edge is not None and math.isnan(edge):
                    yield f"axis {drive.name.lower()}: a limit is not a number"
        if len(axis.slaves) > AXES:
            yield f"axis {axis.name}: {len(axis.slaves)} slaves"


def machine_problems(stream: StepStream, trace: Trace, machine: Machine) -> Iterator[str]:
    """Where the stream's motors are not those of the machine."""
    if stream.tick_frequency != machine.board.tick_frequency:
        yield (
            f"the stream counts {stream.tick_frequency} ticks a second, "
            f"the board {machine.board.name} {machine.board.tick_frequency}"
        )
    if len({motor.name for motor in stream.motors}) != len(stream.motors):
        yield f"two motors of one name: {', '.join(motor.name for motor in stream.motors)}"
    drives = {(axis.index, drive.name): drive for axis in machine.axes for drive in axis.drives()}
    for motor in stream.motors:
        drive = drives.get((motor.axis, motor.name))
        if drive is None:
            yield f"motor {motor.name} drives axis {motor.axis}: the machine has no such motor"
        elif drive.steps_per_unit != motor.steps_per_unit:
            yield (
                f"motor {motor.name} has {motor.steps_per_unit} steps per unit, "
                f"the machine's {drive.name} {drive.steps_per_unit}"
            )
        elif not motor.steps_per_unit or abs(motor.steps_per_unit) > _FEW or abs(1 / motor.steps_per_unit) > _FEW:
            yield f"motor {motor.name}: {motor.steps_per_unit} steps per unit"
    for index, name in enumerate(AXIS_NAMES):
        found = sum(motor.axis == index for motor in stream.motors)
        wanted = sum(axis == index for axis, _ in drives)
        if found != wanted and (found or any(moves(section, index) for section in trace.sections)):
            yield f"axis {name} has {found} motors in the stream, {wanted} on the machine"


def unfollowed(trace: Trace, machine: Machine, setup: Setup) -> Iterator[str]:
    """What moves motors in ways that this checker does not follow."""
    if setup.height_map is None and any(HEIGHT_MAP in state.following for state in trace.states):
        yield "Z follows a height map, and the setup has none"
    problem = setup.height_map.problem() if setup.height_map is not None else None
    if problem is not None:
        yield f"the height map: {problem}"
    for name in never_homed(trace, machine, setup):
        yield f"axis {name} moves, and the setup says that it has had no reference run"
    for axis in machine.axes:
        if axis.tip_feed and any(moves(section, axis.index) for section in trace.sections):
            yield f"the feed of axis {axis.name} is that of the tool over the material"


def never_homed(trace: Trace, machine: Machine, setup: Setup) -> list[str]:
    """Axes that move on some way through the sections before their reference run, and are stated to have had none."""
    if setup.homed is None or not trace.sections:
        return []
    lost = {axis.name for axis in machine.axes if axis.name not in setup.homed}
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


def motor_arrays(
    stream: StepStream, machine: Machine, grid: int, collector: Collector, *, stretched: bool
) -> kernels.Motors:
    """Limits in steps and window bounds; what the machine does not state is left open or assumed."""
    drives = drives_of(stream, machine)
    count = len(stream.motors)
    low, high = np.full(count, -_LONG, np.int64), np.full(count, _LONG, np.int64)
    travel_low, travel_high = np.ones(count, np.int64), np.zeros(count, np.int64)
    speed, acceleration = np.full((3, count), np.inf), np.full((3, count), np.inf)
    slack, patience = np.zeros(count, np.int64), np.zeros(count, np.int64)
    base = grid / stream.tick_frequency
    for m, motor in enumerate(stream.motors):
        drive, name = drives[m], motor.name.lower()
        scale = float(abs(motor.steps_per_unit))
        low[m], high[m] = _limits(motor.steps_per_unit, drive.lower, drive.upper)
        slack[m], patience[m] = _backlash(drive, stream.tick_frequency)
        if slack[m]:
            what = f"{name} stands at the start as when it came from below, with a backlash of {drive.backlash:g}"
            collector.assume("stream-position", what)
            # Rounded up, the backlash may ask for a step more than the limit of the axis leaves for it.
            more = int(abs(slack[m]) > abs(Fraction(drive.backlash) * motor.steps_per_unit))
            if machine.controller.limits_hold == "programmed":
                more = abs(int(slack[m]))
            low[m], high[m] = (low[m] - more, high[m]) if slack[m] > 0 else (low[m], high[m] + more)
        if None in (drive.lower, drive.upper):
            collector.assume("stream-limit", f"axis {name} needs no limit where the machine file states none")
        if drive.travel_lower is not None and drive.travel_upper is not None:
            travel_low[m], travel_high[m] = _limits(motor.steps_per_unit, drive.travel_lower, drive.travel_upper)
        for k, width in enumerate(kernels.SPANS):
            h = width * base
            if drive.max_velocity is not None:
                speed[k, m] = drive.max_velocity * h * scale + 2 + kernels.ROUNDING
            if drive.max_acceleration is not None:
                # Where a pitch table bends, the motor's velocity jumps; a jump counts with at most h.
                jumps = (drive.max_velocity or 0.0) * bend(drive.pitch, 2 * h * (drive.max_velocity or 0.0))
                steady = drive.max_acceleration * h * (h + 2 * base)
                acceleration[k, m] = (steady + jumps * h) * scale + 4 + kernels.ROUNDING
        for what, value in (("velocity", drive.max_velocity), ("acceleration", drive.max_acceleration)):
            if value is None:
                collector.leave_open(f"the machine file states no {what} for {name}", f"stream-{what}")
    knots = [knots_of(drive.pitch, float(drive.steps_per_unit or 0)) for drive in drives]
    return kernels.Motors(
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
        patience=np.full(count, _LONG, np.int64) if stretched else patience,
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


def drives_of(stream: StepStream, machine: Machine) -> list[Drive]:
    """The machine's motor for each motor of a well-formed stream."""
    drives = {(axis.index, drive.name): drive for axis in machine.axes for drive in axis.drives()}
    return [drives[motor.axis, motor.name] for motor in stream.motors]


def _limits(spu: Fraction, lower: float | None, upper: float | None) -> tuple[int, int]:
    """Whole steps from limit to limit: a limit's own nearest step still belongs to it, either one at a tie."""
    edges = [None if edge is None or math.isinf(edge) else Fraction(edge) * spu for edge in (lower, upper)]
    first, last = edges if spu > 0 else edges[::-1]
    half = Fraction(1, 2) + _TOUCH
    low = -_LONG if first is None else max(-_LONG, math.ceil(first - half))
    high = _LONG if last is None else min(_LONG, math.floor(last + half))
    return low, high


# --- stream against trace -----------------------------------------------------------------------------------


class Tables(NamedTuple):
    """What all sections share. driven: axes with a motor; reach: (6,) steps per unit of each; known: by frame, whether
    the driven axes are known in it; off: by state, 1 where the soft limits are off; idle: axes without a motor; planes:
    (256,) 0 no plane, 1 one whose axes have motors, 2 another one."""

    driven: list[int]
    reach: Floats
    known: npt.NDArray[np.bool_]
    off: npt.NDArray[np.uint8]
    idle: npt.NDArray[np.intp]
    planes: npt.NDArray[np.uint8]


def tables_of(stream: StepStream, trace: Trace) -> Tables:
    """For ``row_arrays``."""
    driven = sorted({motor.axis for motor in stream.motors})
    reach = np.zeros(AXES)
    for motor in stream.motors:
        reach[motor.axis] = abs(float(motor.steps_per_unit))
    planes = np.zeros(256, np.uint8)
    for plane, pair in PAIRS.items():
        planes[int(plane)] = 1 if set(pair) <= set(driven) else 2
    return Tables(
        driven=driven,
        reach=reach,
        known=np.array([all(frame[a] == () for a in driven) for frame in trace.frames], dtype=bool),
        off=np.array([GUARD in state.guards_off for state in trace.states], dtype=np.uint8),
        idle=np.array([a for a in range(AXES) if a not in driven], dtype=np.intp),
        planes=planes,
    )


def row_arrays(trace: Trace, section: TraceSection, tables: Tables, collector: Collector) -> kernels.Rows | None:
    """The section's rows for the kernel, when each of them can be followed."""
    problems: list[tuple[int, str]] = []
    rows = rows_of([section], tables, problems)
    for row, what in problems:
        where = f"section {section.number}, row {row}: {what}"
        collector.add(STREAM_MALFORMED.at(span_of(trace, section.number, row), what=where))
    return None if rows is None else rows[0]


def rows_of(
    sections: Sequence[TraceSection], tables: Tables, problems: list[tuple[int, str]]
) -> list[kernels.Rows] | None:
    """Each section's rows for the kernel; None, with the problems of one section (row, what), when one can not be
    followed. Of several sections they have no places."""
    known, reach, idle = tables.known, tables.reach, tables.idle
    if not known[[section.start_frame for section in sections]].all():
        problems.append((-1, "the section's start depends on something that is not known"))
    if any(section.rows.schema is not TRACE_ROW for section in sections):
        problems.append((-1, "the table is not one of trace rows"))
        return None
    rows = joined(TRACE_ROW, [section.rows for section in sections])
    sizes = [len(section.rows) for section in sections]
    first = np.cumsum([0, *sizes])
    n = len(rows)
    to = np.ascontiguousarray(rows["to"], dtype=np.float64)
    starts = np.array([section.start for section in sections], dtype=np.float64).reshape(-1, AXES)
    if not np.isfinite(starts).all():
        problems.append((-1, "the start is not finite"))
        return None
    before = np.empty((n, AXES))
    before[1:] = to[: max(0, n - 1)]
    there = np.flatnonzero(sizes)
    before[first[there]] = starts[there]
    of = np.repeat(np.arange(len(sections)), sizes) if len(sections) > 1 else np.zeros(1, np.intp)
    op = rows["op"]
    motion = MOVES[op]
    arcs = op == Op.ARC
    planes = tables.planes[rows["plane"]]
    extent = np.abs(to) * reach
    moved = (to != before).any(axis=1)
    needs_feed = motion & (op != Op.TRAVERSE) & (moved | arcs)
    for bad, what in (
        (~known[rows["frame"]], "the position depends on something that is not known"),
        (moved & ~motion, "the position jumps in a row that is no motion"),
        ((to[:, idle] != starts[:, idle][of]).any(axis=1), "an axis without a motor moves"),
        (arcs & (planes == 2), "an arc in an axis without a motor"),
        ((extent > FARTHEST).any(axis=1), f"a position of more than {FARTHEST} steps"),
        (arcs & (planes == 0), "an arc in no plane"),
        (needs_feed & ~(np.isfinite(rows["feed"]) & (rows["feed"] > 0)), "motion without a feed"),
    ):
        if bad.any():
            problems.append((int(np.argmax(bad)), what))
    if (np.abs(starts) * reach > FARTHEST).any():
        problems.append((-1, f"a start of more than {FARTHEST} steps"))
    if problems:
        return None
    for plane, pair in PAIRS.items():
        here = np.flatnonzero(arcs & (rows["plane"] == plane))
        problem = _arc_problems(rows["center"][here][:, pair], before[here][:, pair], to[here][:, pair],
                            rows["turns"][here], float(reach[list(pair)].max()))  # fmt: skip
        if problem is not None:
            problems.append((int(here[problem[0]]), problem[1]))
    if problems:
        return None
    guard = np.zeros(n + len(sections), np.uint8)
    if n:
        guard[np.arange(n) + of] = tables.off[rows["state"]]
    whole = kernels.Rows(
        op=np.ascontiguousarray(op, dtype=np.uint8),
        to=to,
        center=np.ascontiguousarray(rows["center"], dtype=np.float64),
        turns=rows["turns"].astype(np.int64),
        plane=np.ascontiguousarray(rows["plane"], dtype=np.uint8),
        feed=np.ascontiguousarray(rows["feed"], dtype=np.float64),
        guard=guard,
        slack=np.zeros(n),
    )
    ends = first.tolist()
    return [
        kernels.Rows(
            whole.op[a:b], to[a:b], whole.center[a:b], whole.turns[a:b], whole.plane[a:b], whole.feed[a:b],
            guard[a + k : b + k + 1], whole.slack[a:b],
        )
        for k, (a, b) in enumerate(itertools.pairwise(ends))
    ]  # fmt: skip


def _arc_problems(
    center: Floats, start: Floats, to: Floats, turns: Floats, steps_per_mm: float
) -> tuple[int, str] | None:
    """The first arc that can not be followed, and why; positions in the arcs' plane."""
    if not len(center):
        return None
    radii = np.hypot(*(start - center).T), np.hypot(*(to - center).T)
    small, large = np.minimum(*radii), np.maximum(*radii)
    length = (large * (np.abs(turns.astype(np.float64)) + 1) * 2 * math.pi + np.abs(center).max(axis=1)) * steps_per_mm
    for bad, what in (
        (~(small > 0), "an arc without a radius"),
        (~(length <= FARTHEST), f"an arc of more than {FARTHEST} steps"),
    ):
        if bad.any():
            return int(np.argmax(bad)), what
    return None


def start_problems(
    stream: StepStream, trace: Trace, drives: Sequence[Drive], number: int, setup: Setup, raised: float,
    collector: Collector,
) -> bool:  # fmt: skip
    """Add findings unless the section starts at the steps nearest to its traced start, and that where it is stated.

    drives: of ``drives_of``; raised: what a height map adds to Z there.
    """
    section, place = stream.sections[number], trace.sections[number].start
    good = True
    for motor, drive, steps in zip(stream.motors, drives, section.start, strict=True):
        at = place[motor.axis] + (raised if motor.axis == Z else 0.0)
        if drive.pitch is None and abs(steps - at * float(motor.steps_per_unit)) < _SURELY and abs(steps) < FARTHEST:
            continue
        exact = motor_at(drive.pitch, at) * motor.steps_per_unit
        if abs(steps - exact) > Fraction(kernels.EXACT):
            good = False
            what = (
                f"section {number}: {motor.name} starts at step {steps}, the trace at "
                f"{at:.6f}, which is step {float(exact):.3f}"
            )
            collector.add(STREAM_END.at(span_of(trace, number, 0), what=what))
    if number == 0:
        for axis in sorted({motor.axis for motor in stream.motors}):
            stated = setup.interval(f"start.{AXIS_NAMES[axis]}")
            if stated is not None and not stated.low <= place[axis] <= stated.high:
                good = False
                what = (
                    f"the trace starts at {AXIS_NAMES[axis]} {place[axis]:.6f}; "
                    f"the setup says {stated.low:.6f} to {stated.high:.6f}"
                )
                collector.add(STREAM_END.at(span_of(trace, 0, 0), what=what))
    return good


class Pairs(NamedTuple):
    """Events that stand in the order of their rows, with these, as lists; ticks, rows: for the kernel."""

    op: list[int]
    arg: list[list[float]]
    given: list[int]
    values: list[list[int]]
    ticks: npt.NDArray[np.int64]
    rows: npt.NDArray[np.int64]


def pairs_of(stream: StepStream, trace: Trace, begin: int, end: int) -> list[Pairs] | None:
    """Of each section, when all events are those of its rows, in order and within it; else None."""
    sections = trace.sections[begin:end]
    rows = joined(TRACE_ROW, [section.rows for section in sections])
    given = joined(EVENT, [section.events for section in stream.sections[begin:end]])
    first = np.cumsum([0, *(len(section.rows) for section in sections)])
    ends = np.cumsum([0, *(len(section.events) for section in stream.sections[begin:end])])
    switching = np.flatnonzero(SWITCHES[rows["op"]])
    of = np.searchsorted(first, switching, side="right") - 1
    wanted = switching - first[of]
    if not np.array_equal(np.searchsorted(switching, first), ends) or not np.array_equal(wanted, given["row"]):
        return None
    ticks = given["tick"].astype(np.int64)
    duration = np.array([section.duration for section in stream.sections[begin:end]], dtype=np.int64)
    if ((ticks < 0) | (ticks > duration[of])).any() or ((np.diff(ticks) < 0) & (of[1:] == of[:-1])).any():
        return None
    ops, args = rows["op"][switching].tolist(), rows["arg"][switching].tolist()
    codes, values = given["op"].tolist(), given["arg"].tolist()
    wanted = wanted.astype(np.int64)
    return [
        Pairs(ops[a:b], args[a:b], codes[a:b], values[a:b], ticks[a:b], wanted[a:b])
        for a, b in itertools.pairwise(ends.tolist())
    ]


def event_arrays(
    stream: StepStream,
    trace: Trace,
    number: int,
    spindle: int | None,
    ramp: float,
    pairs: Pairs | None,
    collector: Collector,
) -> kernels.Events | None:
    """The section's events, when they are those of its rows. spindle: direction before the section, None: unknown;
    pairs: what ``pairs_of`` gave."""
    good = True

    def refuse(row: int, tick: int, what: str) -> None:
        nonlocal good
        good = False
        where = f"section {number}, row {row}, tick {tick}: {what}"
        collector.add(STREAM_EVENT.at(span_of(trace, number, row), what=where))

    if pairs is None:
        given = stream.sections[number].events
        wanted = np.flatnonzero(SWITCHES[trace.sections[number].rows["op"]])
        if not np.array_equal(wanted, given["row"]):
            _order_problems(wanted.tolist(), given["row"].tolist(), given["tick"].tolist(), refuse)
            return None
        ticks = given["tick"].astype(np.int64)
        duration = stream.sections[number].duration
        outside = (ticks < 0) | (ticks > duration)
        if outside.any():
            k = int(np.argmax(outside))
            refuse(int(wanted[k]), int(ticks[k]), f"an event outside its section of {duration} ticks")
            return None
        if len(ticks) and (np.diff(ticks) < 0).any():
            k = int(np.argmax(np.diff(ticks) < 0)) + 1
            refuse(int(wanted[k]), int(ticks[k]), "an event before the one of an earlier row")
            return None
        found = pairs_of(stream, trace, number, number + 1)
        assert found is not None
        pairs = found[0]
    still = np.zeros(len(pairs.op), np.int64)
    for k, (code, arg, given_code, values) in enumerate(
        zip(pairs.op, pairs.arg, pairs.given, pairs.values, strict=True)
    ):
        op = Op(code)
        what = _event_problem(op, arg, given_code, values)
        if what:
            refuse(int(pairs.rows[k]), int(pairs.ticks[k]), what)
            continue
        seconds = Fraction(0)
        if op is Op.DWELL:
            seconds = Fraction(arg[0])
        elif op is Op.SPINDLE:
            direction = int(arg[0])
            if direction and direction != spindle:
                seconds = Fraction(ramp)
            spindle = direction
        if seconds:
            still[k] = min(_LONG, ticks_up(seconds, stream.tick_frequency))
    if not good:
        return None
    return kernels.Events(tick=pairs.ticks, row=pairs.rows, still=still)


def _order_problems(wanted: list[int], given: list[int], ticks: list[int], refuse: object) -> None:
    """Say which events are missing, doubled, strange or out of order."""
    assert callable(refuse)
    for row in sorted(set(wanted) - set(given))[:8]:
        refuse(row, -1, "the event of this row is missing")
    seen: set[int] = set()
    told = 0
    known = set(wanted)
    for row, tick in zip(given, ticks, strict=True):
        if told < 8 and row not in known:
            refuse(row, tick, "an event for a row that has none")
            told += 1
        elif told < 8 and row in seen:
            refuse(row, tick, "the event of this row a second time")
            told += 1
        seen.add(row)
    if sorted(given) == wanted:
        k = next(k for k, row in enumerate(given) if row != wanted[k])
        refuse(given[k], ticks[k], "an event out of the order of its rows")


def _event_problem(op: Op, arg: list[float], given: int, values: list[int]) -> str:
    if given != op:
        return f"the event is {given}, the row {op.name} ({int(op)})"
    if op is Op.SPINDLE and arg[0] == 0.0 and math.isnan(arg[1]):
        arg = [arg[0], values[1] / 1000]  # a spindle that stops needs no speed
    for value, thousandths in zip(arg, values, strict=True):
        if not math.isfinite(value):
            return f"{op.name} with a value that is not known"
        whole = value == int(value) and int(value) * 1000 == thousandths
        if not whole and abs(Fraction(value) * 1000 - thousandths) > Fraction(1, 2) + _TOUCH:
            return f"{op.name} with {thousandths} thousandths, the row says {value!r}"
    if op is Op.DWELL and not 0 <= arg[0] < math.inf:
        return f"a dwell of {arg[0]!r} seconds"
    if op is Op.SPINDLE and arg[0] not in (-1.0, 0.0, 1.0):
        return f"a spindle direction of {arg[0]!r}"
    return ""


def left_to_others(trace: Trace) -> str:
    """Commands of the trace that no event carries out, at most five by name; empty when there are none."""
    found: dict[str, None] = {}
    for section in trace.sections:
        rows = section.rows
        devices = rows["op"] == Op.DEVICE
        for text in occurring(rows["text"][devices]) if devices.any() else ():
            found[trace.texts[text]] = None
    names = list(found)
    return ", ".join(names[:5]) + (f" and {len(names) - 5} more" if len(names) > 5 else "")


def spindle_before(trace: Trace) -> list[int | None]:
    """The spindle's direction at each section's beginning; None where it depends on the way there.

    Off at section 0; only SPINDLE rows change it.
    """
    unseen = -2
    before: list[int | None] = [unseen] * len(trace.sections)
    todo: list[tuple[int, int | None]] = [(0, 0)] if before else []
    while todo:
        number, direction = todo.pop()
        if before[number] == direction or before[number] is None:
            continue
        direction = direction if before[number] == unseen else None
        before[number] = direction
        rows = trace.sections[number].rows
        spins = np.flatnonzero(rows["op"] == Op.SPINDLE)
        if len(spins):
            last = float(rows["arg"][spins[-1], 0])
            direction = int(last) if last in (-1.0, 0.0, 1.0) else None
        todo.extend((edge.target, direction) for edge in trace.sections[number].edges if edge.target >= 0)
    return [None if direction == unseen else direction for direction in before]
