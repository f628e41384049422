"""The stream checker's inner loop: all motors' steps in time order against the traced path.

Everything is in steps: a path point is ``q[m] = position[axis of m] * steps_per_unit[m]``, in steps of the axis. A
motor with a pitch table is compared there too: the step positions one step to either side of it are carried to the
axis (``axis_steps``), so that the path stays straight. Where a motor has backlash, what is compared is the axis
behind it (``Backlash``): it stays while the motor is between the two flanks of its backlash, and goes with it at
either. The path comes as straight pieces that are made when they are needed: a line row is one piece, an arc row many
chords whose distance from the arc, at equal parameter, is at most ``CHORD`` steps of any motor.

Which path points the machine may be at is kept exactly, not guessed: for each piece of a window the interval
of the piece's parameter that can be reached without ever being more than the tolerance away from the step
position and without going back (the free space of the Fréchet distance in the maximum norm). A step shrinks
the intervals to what is also near the new position; when none is left, no path point explains it.

docs/verification.md proves what follows from a run without a problem, and that a right stream gives none.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from gproof.ir.kernel import kernel

Ints = npt.NDArray[np.int64]
Floats = npt.NDArray[np.float64]
Bytes = npt.NDArray[np.uint8]

PATH_TOLERANCE = 1.0
"""Steps that a motor may be away from the path point, all motors from the same path point."""

ROUNDING = 1e-6
"""Steps: more than what float64 loses between a position of the trace and steps."""

CHORD = 1e-2
"""Steps between an arc and the chords it is followed with, at most."""

EXACT = 0.5 + ROUNDING
"""Steps between a position at rest and the traced position: the nearest step, either one at a tie."""

WINDOW = 8192
"""Pieces of path within one tolerance box that the checker is ready to hold."""

SPANS = (1, 4, 16)
"""Windows for velocity, acceleration and feed, in interpolation times."""

RING = 64
SETTLED = 2 * 16 + 1
"""Samples without a step after which all windows are still."""

FEED_SLACK = 1e-6
"""Seconds by which a window may seem shorter than its feed allows (float64)."""

NEVER = 1 << 62
TINY = 1e-9

# Rows of trace ops that the loop must know; stream.py asserts that they are those of ir/trace.py.
ARC_OP = 3
LAST_MOTION_OP = 4

# Problems, as they are reported.
P_LEFT, P_DENSE, P_EXTRA, P_RATE, P_PULSE, P_SETUP, P_SPEED, P_ACCELERATION, P_FEED = 1, 2, 3, 4, 5, 6, 7, 8, 9
P_EARLY, P_OFF_PLACE, P_WAIT_CUT, P_UNFINISHED, P_END = 10, 11, 12, 13, 14
P_LIMIT, P_TRAVEL, P_LIMIT_UNKNOWN, P_AFTER_END, P_SLACK = 15, 16, 17, 18, 19
PROBLEMS = 20

KEPT = 8
"""Places kept of each problem; all are counted."""

# What ``Walk.ints`` holds.
ROW, PIECE, PIECES, BARRIER = 0, 1, 2, 3  # row being made or next, next piece of it, pieces in it (0: none), next event
HEAD, TAIL, FRONT, DONE = 4, 5, 6, 7  # window begin and end, last reachable piece, 1: all that was made is reachable
FIRST, SECOND, NOTED = 8, 9, 10  # the row's arc axes (-1: a line); problems kept
INTS = 11

# What ``Cursor.now`` holds: 1: nothing more to follow; 1: an axis lags; 1: more is near than the window holds; place in
# the rings; samples without a step; steps made, and at the last sample; next event; tick up to which motors stand
# still; tick of the last rest; tick of the next sample.
OVER, LAGGING, DENSE, AT, QUIET, STEPS, SAMPLED, EVENT, STILL, REST, EDGE = 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10
NOW = 11

# What ``Walk.reals`` holds: of an arc radii, angles, centre, the last piece's direction; seconds at full feed of a
# piece of the row, and of all pieces made so far.
R0, R1, ANGLE, SWEEP, CENTER_0, CENTER_1, COS, SIN, SHARE, TIME = 0, 1, 2, 3, 4, 5, 6, 7, 8, 9
MORE = 10  # what the open row adds to the tolerance
REALS = 11

# What ``Walk.place`` holds: the path made so far, the end of the next piece, begin and end of the row.
HERE, NEXT, ORIGIN, GOAL = 0, 1, 2, 3
PLACES = 4

# Columns of ``Window``.
BEGIN, EXTENT, INVERSE = 0, 1, 2
FROM, TO, BEFORE, SECONDS, SLACK = 0, 1, 2, 3, 4
UNREACHED = 2.0


class Rows(NamedTuple):
    """Columns of a trace section; guard: 1 where the soft limits are off (one more row than the others); slack: steps
    that a row adds to the tolerance."""

    op: Bytes
    to: Floats
    center: Floats
    turns: Ints
    plane: Bytes
    feed: Floats
    guard: Bytes
    slack: Floats


class Motors(NamedTuple):
    """By motor; speed, acceleration: (3, motors) greatest counts in the windows of ``SPANS``; knots: of all pitch
    tables, motor m has those from first_knot[m] to first_knot[m + 1]; slack: steps from the flank at which the axis
    comes from below to the other one, signed as they are counted; patience: ticks for which the axis may lag behind
    the path after the motor turned round."""

    axis: Ints
    spu: Floats
    low: Ints
    high: Ints
    travel_low: Ints
    travel_high: Ints
    speed: Floats
    acceleration: Floats
    knots: Floats
    first_knot: Ints
    slack: Ints
    patience: Ints


class Runs(NamedTuple):
    """All motors' runs one after another, length in steps; motor m has those from first[m] to first[m + 1]."""

    interval: Ints
    length: Ints
    add: Ints
    direction: Ints
    first: Ints


class Events(NamedTuple):
    """Event rows: tick, row, ticks for which the motors stand still."""

    tick: Ints
    row: Ints
    still: Ints


class Times(NamedTuple):
    """Ticks between steps, between steps that must not merge, before a turn, in one window; section's length;
    seconds at full feed that pass in one tick."""

    interval: int
    pulse: int
    setup: int
    grid: int
    duration: int
    seconds: float


class Window(NamedTuple):
    """Pieces of path. line: (pieces, motors, 3) BEGIN, EXTENT, INVERSE; reach: (pieces, 5) FROM, TO: the
    reachable interval, BEFORE, SECONDS: at full feed before the piece and in it, SLACK: what rounding and chords add
    to the tolerance; top: (pieces, motors) of a reachable piece up to where each motor is near; row: of the trace."""

    line: Floats
    top: Floats
    reach: Floats
    row: Ints


class Walk(NamedTuple):
    """What changes along the way. place: (PLACES, 6) positions; turns: (6, motors) last direction and number of
    reversals since the last rest, of the path and of the axis; the same of a motor with backlash, the number first."""

    ints: Ints
    reals: Floats
    place: Floats
    turns: Ints


class Backlash(NamedTuple):
    """By motor. at: the step of the axis behind the backlash; until: the tick up to which it may lag, or -1."""

    at: Ints
    until: Ints


class Cursor(NamedTuple):
    """How far a section has been followed. By motor: n: its step; near: from ``surround``; at, until: ``Backlash``;
    run: the one it is in; due: tick of its next step; gap: before it; left: steps of the run; last: tick of the last
    step; way: its direction. positions, progress: the rings of ``sample``; now: see OVER; began: seconds at full feed
    up to the last rest."""

    n: Ints
    near: Floats
    at: Ints
    until: Ints
    run: Ints
    due: Ints
    gap: Ints
    left: Ints
    last: Ints
    way: Ints
    positions: Ints
    progress: Floats
    now: Ints
    began: Floats


class Problems(NamedTuple):
    """counts by kind; the first KEPT of each: (kind, motor, tick, row) and two numbers."""

    counts: Ints
    found: Ints
    numbers: Floats


@kernel(seconds_per_unit=5e-6, borrows=True)
def note(kind: int, motor: int, tick: int, row: int, a: float, b: float, walk: Walk, problems: Problems) -> None:
    """Count a problem and keep its place while there is room for its kind."""
    problems.counts[kind] += 1
    if problems.counts[kind] <= KEPT:
        k = walk.ints[NOTED]
        problems.found[k, 0] = kind
        problems.found[k, 1] = motor
        problems.found[k, 2] = tick
        problems.found[k, 3] = row
        problems.numbers[k, 0] = a
        problems.numbers[k, 1] = b
        walk.ints[NOTED] = k + 1


@kernel(seconds_per_unit=2e-6, borrows=True)
def axis_steps(at: float, m: int, knots: Floats, first_knot: Ints) -> float:
    """Where the axis is, in its steps, when motor ``m`` is at ``at``: linear between knots, shifted beside them."""
    a = first_knot[m]
    b = first_knot[m + 1]
    if a == b:
        return at
    if at <= knots[a, 0]:
        return at + np.float64(knots[a, 1] - knots[a, 0])
    if at >= knots[b - 1, 0]:
        return at + np.float64(knots[b - 1, 1] - knots[b - 1, 0])
    b -= 1
    while b - a > 1:
        k = (a + b) // 2
        if knots[k, 0] <= at:
            a = k
        else:
            b = k
    slope = (knots[b, 1] - knots[a, 1]) / (knots[b, 0] - knots[a, 0])
    return np.float64(knots[a, 1] + (at - knots[a, 0]) * slope)


@kernel(seconds_per_unit=2e-6, borrows=True)
def surround(m: int, n: Ints, backlash: Backlash, motors: Motors, near: Floats) -> None:
    """near[m]: where the path may be while motor ``m`` is at its step: one step to either side of the axis.

    While the axis may lag, the path may be wherever the motor could hold an axis that did not.
    """
    low = backlash.at[m]
    high = low
    if backlash.until[m] >= 0:
        low = min(n[m], n[m] + motors.slack[m])
        high = max(n[m], n[m] + motors.slack[m])
    near[m, 0] = axis_steps(np.float64(low) - PATH_TOLERANCE, m, motors.knots, motors.first_knot)
    near[m, 1] = axis_steps(np.float64(high) + PATH_TOLERANCE, m, motors.knots, motors.first_knot)


@kernel(seconds_per_unit=5e-6, borrows=True)
def catch_up(t: int, n: Ints, backlash: Backlash, motors: Motors, window: Window, walk: Walk, near: Floats) -> int:
    """End the lag of axes that had until before tick ``t``; the motor whose axis is not near the path then, or -1."""
    for m in range(n.shape[0]):
        if 0 <= backlash.until[m] < t:
            backlash.until[m] = -1
            surround(m, n, backlash, motors, near)
            shrink(m, near, walk.ints[HEAD], False, window.line, window.top, window.reach, walk.ints)
            if walk.ints[HEAD] == walk.ints[TAIL]:
                return m
    return -1


@kernel(seconds_per_unit=5e-6, borrows=True)
def drag(m: int, t: int, direction: int, before: int, n: Ints, backlash: Backlash, motors: Motors) -> bool:
    """The axis behind motor ``m``, which made a step at ``t``; before: its last direction. True when the axis moved."""
    slack = motors.slack[m]
    upwards = 1 if slack > 0 else -1
    last = before if before != 0 else upwards
    if slack != 0 and direction != last:
        backlash.until[m] = t + motors.patience[m]
    here = min(max(backlash.at[m], min(n[m], n[m] + slack)), max(n[m], n[m] + slack))
    moved = here != backlash.at[m]
    backlash.at[m] = here
    return bool(moved)


@kernel(seconds_per_unit=5e-6, inline=True, borrows=True)
def turned(way: float, m: int, turns: Ints) -> None:
    """The path moves motor ``m`` in the direction of ``way``: count it when that is a reversal."""
    sign = 0
    if way > 0.0:
        sign = 1
    elif way < 0.0:
        sign = -1
    if sign != 0:
        if turns[0, m] == -sign:
            turns[1, m] += 1
        turns[0, m] = sign


@kernel(seconds_per_unit=1e-5, borrows=True)
def open_arc(r: int, rows: Rows, motors: Motors, walk: Walk) -> float:
    """Prepare the arc row ``r``: its axes, angles, radii and number of pieces; gives its length."""
    # The right-handed pairs: XY, ZX, YZ.
    first = 0
    second = 1
    third = 2
    if rows.plane[r] == 2:
        first = 2
        second = 0
        third = 1
    elif rows.plane[r] == 3:
        first = 1
        second = 2
        third = 0
    here = walk.place[HERE]
    x0 = here[first] - rows.center[r, first]
    y0 = here[second] - rows.center[r, second]
    x1 = rows.to[r, first] - rows.center[r, first]
    y1 = rows.to[r, second] - rows.center[r, second]
    r0 = math.sqrt(x0 * x0 + y0 * y0)
    r1 = math.sqrt(x1 * x1 + y1 * y1)
    angle = math.atan2(y0, x0)
    sweep = math.atan2(y1, x1) - angle
    full = 2.0 * math.pi
    if rows.turns[r] > 0:
        if sweep <= 0.0:
            sweep += full
        if sweep <= 0.0:
            # From pi to -pi, the same direction: a full circle.
            sweep += full
        sweep += full * np.float64(rows.turns[r] - 1)
    else:
        if sweep >= 0.0:
            sweep -= full
        if sweep >= 0.0:
            sweep -= full
        sweep += full * np.float64(rows.turns[r] + 1)
    # A chord over the angle h is within h^2 / 8 * |second derivative| of its arc, parameter by parameter.
    scale = 0.0
    for m in range(motors.axis.shape[0]):
        if motors.axis[m] == first or motors.axis[m] == second:
            scale = max(scale, abs(motors.spu[m]))
    bend = (max(r0, r1) + 2.0 * abs((r1 - r0) / sweep)) * scale
    largest = math.pi / 8.0
    if bend > 0.0:
        largest = min(largest, math.sqrt(8.0 * CHORD / bend))
    walk.ints[PIECES] = max(1, math.ceil(abs(sweep) / largest))
    walk.ints[FIRST] = first
    walk.ints[SECOND] = second
    walk.reals[R0] = r0
    walk.reals[R1] = r1
    walk.reals[ANGLE] = angle
    walk.reals[SWEEP] = sweep
    walk.reals[CENTER_0] = rows.center[r, first]
    walk.reals[CENTER_1] = rows.center[r, second]
    walk.reals[COS] = math.cos(angle)
    walk.reals[SIN] = math.sin(angle)
    along = 0.5 * (r0 + r1) * sweep
    aside = rows.to[r, third] - here[third]
    return math.sqrt(along * along + aside * aside)


@kernel(seconds_per_unit=1e-5, borrows=True)
def open_row(rows: Rows, motors: Motors, walk: Walk) -> bool:
    """Prepare the next row that moves; False at the next event row or the section's end."""
    ints = walk.ints
    place = walk.place
    while ints[ROW] < ints[BARRIER]:
        r = ints[ROW]
        linear = 0.0
        rotary = 0.0
        for a in range(6):
            delta = rows.to[r, a] - place[HERE, a]
            if a < 3:
                linear += delta * delta
            else:
                rotary += delta * delta
        arc = rows.op[r] == ARC_OP
        if rows.op[r] > LAST_MOTION_OP or (linear == 0.0 and rotary == 0.0 and not arc):
            ints[ROW] = r + 1
            continue
        length = math.sqrt(linear) if linear > 0.0 else math.sqrt(rotary)
        ints[PIECE] = 0
        ints[PIECES] = 1
        ints[FIRST] = -1
        ints[SECOND] = -1
        for a in range(6):
            place[ORIGIN, a] = place[HERE, a]
            place[GOAL, a] = rows.to[r, a]
        if arc:
            length = open_arc(r, rows, motors, walk)
        walk.reals[MORE] = rows.slack[r]
        walk.reals[SHARE] = 0.0
        if rows.feed[r] > 0.0:
            walk.reals[SHARE] = length * 60.0 / rows.feed[r] / np.float64(ints[PIECES])
        return True
    return False


@kernel(seconds_per_unit=1e-5, inline=True, borrows=True)
def arc_piece(axis: Ints, spu: Floats, ints: Ints, reals: Floats, place: Floats, turns: Ints) -> None:
    """The end of the arc's next chord, and the arc's reversals along it."""
    first = ints[FIRST]
    second = ints[SECOND]
    sweep = reals[SWEEP]
    wider = reals[R1] - reals[R0]
    share = np.float64(ints[PIECE] + 1) / np.float64(ints[PIECES])
    radius0 = reals[R0] + wider * (np.float64(ints[PIECE]) / np.float64(ints[PIECES]))
    radius1 = reals[R0] + wider * share
    way = reals[ANGLE] + sweep * share
    cos0 = reals[COS]
    sin0 = reals[SIN]
    cos1 = math.cos(way)
    sin1 = math.sin(way)
    reals[COS] = cos1
    reals[SIN] = sin1
    if ints[PIECE] + 1 < ints[PIECES]:
        for a in range(6):
            place[NEXT, a] = place[ORIGIN, a] + (place[GOAL, a] - place[ORIGIN, a]) * share
        place[NEXT, first] = reals[CENTER_0] + radius1 * cos1
        place[NEXT, second] = reals[CENTER_1] + radius1 * sin1
    # Where the arc itself turns round counts, not where its chords do: signs of its derivative at both ends.
    slope = wider / sweep
    for m in range(axis.shape[0]):
        sense = sweep * spu[m]
        if axis[m] == first:
            turned((slope * cos0 - radius0 * sin0) * sense, m, turns)
            turned((slope * cos1 - radius1 * sin1) * sense, m, turns)
        elif axis[m] == second:
            turned((slope * sin0 + radius0 * cos0) * sense, m, turns)
            turned((slope * sin1 + radius1 * cos1) * sense, m, turns)
        else:
            turned((place[GOAL, axis[m]] - place[ORIGIN, axis[m]]) * spu[m], m, turns)


@kernel(seconds_per_unit=1e-5, inline=True, borrows=True)
def add_piece(axis: Ints, spu: Floats, window: Window, ints: Ints, reals: Floats, place: Floats, turns: Ints) -> None:
    """Append the open row's next piece at the window's tail."""
    for a in range(6):
        place[NEXT, a] = place[GOAL, a]
    arc = ints[FIRST] >= 0
    slack = ROUNDING + reals[MORE]
    if arc:
        arc_piece(axis, spu, ints, reals, place, turns)
        slack += CHORD
    t = ints[TAIL]
    for m in range(axis.shape[0]):
        a = axis[m]
        begin = place[HERE, a] * spu[m]
        extent = place[NEXT, a] * spu[m] - begin
        window.line[t, m, BEGIN] = begin
        window.line[t, m, EXTENT] = extent
        window.line[t, m, INVERSE] = 1.0 / extent if abs(extent) > TINY else 0.0
        if not arc:
            turned(extent, m, turns)
    window.row[t] = ints[ROW]
    window.reach[t, FROM] = UNREACHED
    window.reach[t, TO] = -1.0
    window.reach[t, BEFORE] = reals[TIME]
    window.reach[t, SECONDS] = reals[SHARE]
    window.reach[t, SLACK] = slack
    reals[TIME] += reals[SHARE]
    for a in range(6):
        place[HERE, a] = place[NEXT, a]
    ints[PIECE] += 1
    if ints[PIECE] == ints[PIECES]:
        ints[ROW] += 1
        ints[PIECES] = 0
    ints[TAIL] = t + 1


@kernel(seconds_per_unit=5e-6, borrows=True)
def make_room(window: Window, walk: Walk) -> bool:
    """Move the window to the arrays' beginning; False when it holds more than WINDOW pieces."""
    head = walk.ints[HEAD]
    count = walk.ints[TAIL] - head
    if count > WINDOW:
        return False
    for j in range(count):
        window.row[j] = window.row[head + j]
        for m in range(window.line.shape[1]):
            for c in range(3):
                window.line[j, m, c] = window.line[head + j, m, c]
            window.top[j, m] = window.top[head + j, m]
        for c in range(5):
            window.reach[j, c] = window.reach[head + j, c]
    walk.ints[HEAD] = 0
    walk.ints[TAIL] = count
    walk.ints[FRONT] -= head
    return True


@kernel(seconds_per_unit=5e-6, borrows=True)
def from_rest(row: int, barrier: int, near: Floats, motors: Motors, window: Window, walk: Walk) -> None:
    """Begin anew at the path point reached so far: the window holds that one point."""
    ints = walk.ints
    ints[ROW] = row
    ints[PIECES] = 0
    ints[BARRIER] = barrier
    ints[HEAD] = 0
    ints[TAIL] = 1
    ints[FRONT] = 0
    ints[DONE] = 1
    window.row[0] = max(0, row - 1)
    window.reach[0, FROM] = 0.0
    window.reach[0, TO] = 1.0
    window.reach[0, BEFORE] = walk.reals[TIME]
    window.reach[0, SECONDS] = 0.0
    window.reach[0, SLACK] = ROUNDING
    for m in range(motors.axis.shape[0]):
        begin = walk.place[HERE, motors.axis[m]] * motors.spu[m]
        # As ``shrink`` has it for a motor that does not move.
        outside = near[m, 0] - ROUNDING - begin > 0.0 or near[m, 1] + ROUNDING - begin < 0.0
        window.top[0, m] = -1.0 if outside else 1.0
        window.line[0, m, BEGIN] = begin
        window.line[0, m, EXTENT] = 0.0
        window.line[0, m, INVERSE] = 0.0
        for k in range(6):
            walk.turns[k, m] = 0


@kernel(seconds_per_unit=1e-5, inline=True, borrows=True)
def shrink(m: int, near: Floats, j: int, flows: bool, line: Floats, top: Floats, reach: Floats, ints: Ints) -> None:
    """From piece ``j`` on, keep what is reachable and near the motors, and follow the path while it is near.

    m: the only motor whose ``near`` has changed; near: (motors, 2) from ``surround``; flows: the end of the piece
    before is reachable. Sets HEAD (the tail when nothing is left), FRONT, DONE.

    In a piece that was reachable FROM is not before any motor's bound, and ``top`` holds all motors' other bounds, so
    motor ``m`` alone is looked at; where the path flows in, all are. No other piece can become reachable.
    """
    first = ints[HEAD] if flows else -1
    front = ints[FRONT]
    tail = ints[TAIL]
    farthest = front
    while j < tail and (flows or j <= farthest):
        begin = reach[j, FROM]
        if flows or begin <= 1.0:
            slack = reach[j, SLACK]
            low = 0.0
            high = 1.0
            for k in range(0 if flows else m, near.shape[0] if flows else m + 1):
                least = near[k, 0] - slack - line[j, k, BEGIN]
                most = near[k, 1] + slack - line[j, k, BEGIN]
                inverse = line[j, k, INVERSE]
                bound = 1.0
                if inverse != 0.0:
                    least *= inverse
                    most *= inverse
                    bound = most if most > least else least
                    least = least if most > least else most
                    low = least if least > low else low
                elif least > 0.0 or most < 0.0:
                    bound = -1.0
                top[j, k] = bound
            for k in range(near.shape[0]):
                high = top[j, k] if top[j, k] < high else high
            start = low if low > begin else begin
            last = reach[j, TO]
            if flows and low <= 0.0:
                start = 0.0
                last = 1.0
            flows = False
            if start <= high and start <= last:
                reach[j, FROM] = start
                reach[j, TO] = high
                flows = high >= 1.0
                front = j
                if first < 0:
                    first = j
            else:
                reach[j, FROM] = UNREACHED
                reach[j, TO] = -1.0
        j += 1
    ints[HEAD] = tail if first < 0 else first
    ints[FRONT] = front
    ints[DONE] = 1 if flows else 0


@kernel(seconds_per_unit=1e-5, inline=True, borrows=True)
def extend(near: Floats, rows: Rows, motors: Motors, window: Window, walk: Walk) -> bool:
    """While the path's end so far is reachable, make more of it; False when more than WINDOW pieces are near."""
    room = True
    while walk.ints[DONE] == 1:
        if walk.ints[TAIL] == window.row.shape[0] and not make_room(window, walk):
            room = False
            break
        if walk.ints[PIECES] == 0 and not open_row(rows, motors, walk):
            break
        add_piece(motors.axis, motors.spu, window, walk.ints, walk.reals, walk.place, walk.turns)
        shrink(0, near, walk.ints[TAIL] - 1, True, window.line, window.top, window.reach, walk.ints)
    return room


@kernel(seconds_per_unit=1e-5, borrows=True)
def follow(near: Floats, rows: Rows, motors: Motors, window: Window, walk: Walk) -> bool:
    """``extend`` as a call, for where it is rare."""
    return extend(near, rows, motors, window, walk)


@kernel(seconds_per_unit=5e-6, borrows=True)
def off_place(n: Ints, motors: Motors, walk: Walk) -> int:
    """The first motor that is not at the step nearest to the path point made last, or -1."""
    for m in range(n.shape[0]):
        here = walk.place[HERE, motors.axis[m]] * motors.spu[m]
        least = axis_steps(np.float64(n[m]) - EXACT, m, motors.knots, motors.first_knot)
        most = axis_steps(np.float64(n[m]) + EXACT, m, motors.knots, motors.first_knot)
        if here < least or here > most:
            return m
    return -1


@kernel(seconds_per_unit=2e-5, inline=True, borrows=True)
def sample(
    n: Ints,
    tick: int,
    at: int,
    positions: Ints,
    progress: Floats,
    motors: Motors,
    times: Times,
    window: Window,
    walk: Walk,
    problems: Problems,
) -> None:
    """Enter the position at a window's end into the ring at place ``at``, and check the windows that end here."""
    head = walk.ints[HEAD]
    front = walk.ints[FRONT]
    progress[at, 0] = window.reach[head, BEFORE] + window.reach[head, SECONDS] * window.reach[head, FROM]
    progress[at, 1] = window.reach[front, BEFORE] + window.reach[front, SECONDS] * window.reach[front, TO]
    for m in range(n.shape[0]):
        positions[at, m] = n[m]
    for s in range(3):
        width = SPANS[s]
        middle = (at - width) & (RING - 1)
        before = (at - 2 * width) & (RING - 1)
        row = window.row[head]
        for m in range(n.shape[0]):
            moved = np.float64(positions[at, m] - positions[middle, m])
            change = moved - np.float64(positions[middle, m] - positions[before, m])
            if abs(moved) > motors.speed[s, m]:
                note(P_SPEED, m, tick, row, moved, np.float64(width), walk, problems)
            if abs(change) > motors.acceleration[s, m]:
                note(P_ACCELERATION, m, tick, row, change, np.float64(width), walk, problems)
        seconds = progress[at, 0] - progress[middle, 1]
        allowed = np.float64(width * times.grid) * times.seconds
        if seconds > allowed + FEED_SLACK:
            note(P_FEED, -1, tick, row, seconds / allowed, np.float64(width), walk, problems)


@kernel(seconds_per_unit=2e-5, borrows=True)
def settle(
    n: Ints,
    tick: int,
    at: int,
    positions: Ints,
    progress: Floats,
    motors: Motors,
    times: Times,
    window: Window,
    walk: Walk,
    problems: Problems,
) -> int:
    """At rest: check the windows that reach into the stillness; the new place in the ring."""
    for _ in range(SETTLED):
        at = (at + 1) & (RING - 1)
        sample(n, tick, at, positions, progress, motors, times, window, walk, problems)
    return at


@kernel(seconds_per_unit=2e-5, borrows=True)
def rest_problems(
    n: Ints, tick: int, row: int, begin: int, began: float, times: Times, walk: Walk, problems: Problems
) -> None:
    """At rest at a known path point: steps back and forth that the path does not ask for; feed since the last rest."""
    for m in range(n.shape[0]):
        if walk.turns[4, m] > walk.turns[1, m] + 1:
            # One more than the path: the last one, with which a motor goes back to the flank of a section's end.
            note(P_EXTRA, m, tick, row, np.float64(walk.turns[4, m]), np.float64(walk.turns[1, m]), walk, problems)
        if walk.turns[3, m] > walk.turns[1, m]:
            note(P_EXTRA, m, tick, row, np.float64(walk.turns[3, m]), np.float64(walk.turns[1, m]), walk, problems)
    seconds = walk.reals[TIME] - began
    allowed = np.float64(tick - begin) * times.seconds
    if seconds > allowed + FEED_SLACK:
        ratio = seconds / allowed if allowed > 0.0 else math.inf
        note(P_FEED, -1, tick, row, ratio, 0.0, walk, problems)


@kernel(seconds_per_unit=2e-5, borrows=True)
def unmoved(began: float, progress: Floats, window: Window, walk: Walk) -> None:
    """Before the first step after a rest the path point may be anywhere that the resting position allows."""
    farthest = began
    front = walk.ints[FRONT]
    if walk.ints[HEAD] != walk.ints[TAIL]:
        farthest = window.reach[front, BEFORE] + window.reach[front, SECONDS] * window.reach[front, TO]
    for k in range(RING):
        progress[k, 0] = began
        progress[k, 1] = max(began, farthest)


@kernel(seconds_per_unit=2e-5, borrows=True)
def begin_section(
    cursor: Cursor,
    runs: Runs,
    rows: Rows,
    events: Events,
    motors: Motors,
    times: Times,
    window: Window,
    walk: Walk,
) -> None:
    """Before the first step of a section; the cursor's positions are where it starts.

    walk.place[HERE]: the section's traced start, which they round.
    """
    count = cursor.n.shape[0]
    for m in range(count):
        surround(m, cursor.n, Backlash(cursor.at, cursor.until), motors, cursor.near)
        cursor.due[m] = NEVER
        if cursor.run[m] < runs.first[m + 1]:
            cursor.gap[m] = runs.interval[cursor.run[m]]
            cursor.left[m] = runs.length[cursor.run[m]]
            cursor.due[m] = cursor.gap[m]
    for k in range(RING):
        for m in range(count):
            cursor.positions[k, m] = cursor.n[m]
    cursor.now[QUIET] = SETTLED
    cursor.now[EDGE] = times.grid
    from_rest(0, events.row[0] if events.row.shape[0] > 0 else rows.op.shape[0], cursor.near, motors, window, walk)
    cursor.now[DENSE] = 0 if follow(cursor.near, rows, motors, window, walk) else 1
    unmoved(0.0, cursor.progress, window, walk)


@kernel(seconds_per_unit=4e-5, compile_seconds=16.0, borrows=True)
def check_section(
    most: int,
    cursor: Cursor,
    start: Ints,
    runs: Runs,
    rows: Rows,
    events: Events,
    motors: Motors,
    times: Times,
    window: Window,
    walk: Walk,
    problems: Problems,
) -> int:
    """Follow the section's next steps, about ``most`` of them; the number of steps checked so far.

    cursor.now[OVER] is 1 when the section's end, or a problem that ends the walk, has been reached; start: where
    it ended then.
    """
    count = start.shape[0]
    now = cursor.now
    n = cursor.n
    near = cursor.near
    backlash = Backlash(cursor.at, cursor.until)
    ints = walk.ints
    line = window.line
    top = window.top
    reach = window.reach
    run = cursor.run
    due = cursor.due
    gap = cursor.gap
    left = cursor.left
    last = cursor.last
    way = cursor.way
    positions = cursor.positions
    progress = cursor.progress
    lagging = now[LAGGING] == 1
    dense = now[DENSE] == 1
    at = now[AT]
    quiet = now[QUIET]
    steps = int(now[STEPS])
    sampled = now[SAMPLED]
    e = now[EVENT]
    still = now[STILL]
    begin = now[REST]
    edge = now[EDGE]
    began = cursor.began[0]
    enough = steps + most
    while True:
        if steps >= enough:
            now[LAGGING] = 1 if lagging else 0
            now[DENSE] = 1 if dense else 0
            now[AT] = at
            now[QUIET] = quiet
            now[STEPS] = steps
            now[SAMPLED] = sampled
            now[EVENT] = e
            now[STILL] = still
            now[REST] = begin
            now[EDGE] = edge
            cursor.began[0] = began
            return steps
        t = NEVER
        m = -1
        for k in range(count):
            if due[k] < t:
                t = due[k]
                m = k
        if e < events.row.shape[0] and events.tick[e] <= t:
            tick = events.tick[e]
            row = events.row[e]
            ready = ints[DONE] == 1 and off_place(backlash.at, motors, walk) < 0
            if tick < t or ready:
                if lagging:
                    lagging = False
                    k = catch_up(NEVER, n, backlash, motors, window, walk, near)
                    if k >= 0:
                        note(P_SLACK, k, tick, row, np.float64(n[k]), np.float64(backlash.at[k]), walk, problems)
                        now[OVER] = 1
                        now[STEPS] = steps
                        return steps
                if tick < still:
                    note(P_WAIT_CUT, -1, tick, row, np.float64(still - tick), 0.0, walk, problems)
                if ints[DONE] != 1:
                    note(P_EARLY, -1, tick, row, np.float64(window.row[ints[FRONT]]), 0.0, walk, problems)
                    now[OVER] = 1
                    now[STEPS] = steps
                    return steps
                if not ready:
                    k = off_place(backlash.at, motors, walk)
                    aim = walk.place[HERE, motors.axis[k]] * motors.spu[k]
                    note(P_OFF_PLACE, k, tick, row, np.float64(backlash.at[k]), aim, walk, problems)
                    now[OVER] = 1
                    now[STEPS] = steps
                    return steps
                rest_problems(n, tick, row, begin, began, times, walk, problems)
                if steps != sampled or quiet < SETTLED:
                    at = settle(n, tick, at, positions, progress, motors, times, window, walk, problems)
                still = max(still, tick + events.still[e])
                begin = still
                began = walk.reals[TIME]
                edge = still + times.grid
                quiet = SETTLED
                sampled = steps
                e += 1
                barrier = events.row[e] if e < events.row.shape[0] else rows.op.shape[0]
                from_rest(row + 1, barrier, near, motors, window, walk)
                dense = not follow(near, rows, motors, window, walk)
                unmoved(began, progress, window, walk)
                continue
        if m < 0:
            break

        while edge < t:
            if steps == sampled and quiet >= SETTLED:
                edge += (t - edge + times.grid - 1) // times.grid * times.grid
                break
            quiet = quiet + 1 if steps == sampled else 0
            sampled = steps
            at = (at + 1) & (RING - 1)
            sample(n, edge, at, positions, progress, motors, times, window, walk, problems)
            edge += times.grid

        direction = runs.direction[run[m]]
        row = window.row[ints[HEAD]]
        if last[m] >= 0:
            ticks = t - last[m]
            if ticks < times.interval:
                note(P_RATE, m, t, row, np.float64(ticks), np.float64(times.interval), walk, problems)
            if ticks < times.pulse:
                note(P_PULSE, m, t, row, np.float64(ticks), np.float64(times.pulse), walk, problems)
            if direction != way[m] and ticks < times.setup:
                note(P_SETUP, m, t, row, np.float64(ticks), np.float64(times.setup), walk, problems)
        if t < still:
            note(P_WAIT_CUT, m, t, row, np.float64(still - t), 0.0, walk, problems)
        if t > times.duration:
            note(P_AFTER_END, m, t, row, np.float64(t - times.duration), 0.0, walk, problems)
        if lagging:
            k = catch_up(t, n, backlash, motors, window, walk, near)
            if k >= 0:
                note(P_SLACK, k, t, row, np.float64(n[k]), np.float64(backlash.at[k]), walk, problems)
                now[OVER] = 1
                now[STEPS] = steps
                return steps
            lagging = False
            for k in range(count):
                lagging = lagging or backlash.until[k] >= 0
        n[m] += direction
        moved = True
        if motors.slack[m] == 0:
            backlash.at[m] = n[m]
        else:
            if walk.turns[5, m] == -direction:
                walk.turns[4, m] += 1
            walk.turns[5, m] = direction
            moved = drag(m, t, direction, way[m], n, backlash, motors)
            lagging = lagging or backlash.until[m] >= 0
        if moved:
            if walk.turns[2, m] == -direction:
                walk.turns[3, m] += 1
            walk.turns[2, m] = direction
        way[m] = direction
        last[m] = t
        if motors.slack[m] == 0 and motors.first_knot[m] == motors.first_knot[m + 1]:
            # As ``surround`` has it for such a motor; a call with this many arrays takes longer than all else here.
            near[m, 0] = np.float64(n[m]) - PATH_TOLERANCE
            near[m, 1] = np.float64(n[m]) + PATH_TOLERANCE
        else:
            surround(m, n, backlash, motors, near)
        steps += 1

        shrink(m, near, ints[HEAD], False, line, top, reach, ints)
        if ints[HEAD] == ints[TAIL]:
            note(P_LEFT, m, t, row, np.float64(n[m]), np.float64(direction), walk, problems)
            for k in range(count):
                start[k] = backlash.at[k]
            now[OVER] = 1
            now[STEPS] = steps
            return steps
        if ints[DONE] == 1:
            dense = not extend(near, rows, motors, window, walk)
        if dense:
            note(P_DENSE, m, t, row, 0.0, 0.0, walk, problems)
            now[OVER] = 1
            now[STEPS] = steps
            return steps

        if n[m] < motors.low[m] or n[m] > motors.high[m]:
            guarded = True
            for j in range(ints[HEAD], ints[FRONT] + 1):
                if reach[j, FROM] <= 1.0 and rows.guard[window.row[j]] != 0:
                    guarded = False
            row = window.row[ints[HEAD]]
            if guarded:
                note(P_LIMIT, m, t, row, np.float64(n[m]), 0.0, walk, problems)
            elif motors.travel_low[m] > motors.travel_high[m]:
                note(P_LIMIT_UNKNOWN, m, t, row, np.float64(n[m]), 0.0, walk, problems)
            elif n[m] < motors.travel_low[m] or n[m] > motors.travel_high[m]:
                note(P_TRAVEL, m, t, row, np.float64(n[m]), 0.0, walk, problems)

        left[m] -= 1
        if left[m] > 0:
            gap[m] += runs.add[run[m]]
            due[m] = t + gap[m]
        else:
            run[m] += 1
            if run[m] < runs.first[m + 1]:
                gap[m] = runs.interval[run[m]]
                left[m] = runs.length[run[m]]
                due[m] = t + gap[m]
            else:
                due[m] = NEVER

    row = max(0, ints[ROW] - 1)
    k = catch_up(NEVER, n, backlash, motors, window, walk, near)
    if k >= 0:
        note(P_SLACK, k, times.duration, row, np.float64(n[k]), np.float64(backlash.at[k]), walk, problems)
        now[OVER] = 1
        now[STEPS] = steps
        return steps
    for m in range(count):
        start[m] = n[m]
    if ints[DONE] != 1:
        note(P_UNFINISHED, -1, times.duration, window.row[ints[FRONT]], 0.0, 0.0, walk, problems)
        now[OVER] = 1
        now[STEPS] = steps
        return steps
    # Not the axis alone, but the motor too is where the next section starts.
    for ended in (backlash.at, n):
        m = off_place(ended, motors, walk)
        if m >= 0:
            aim = walk.place[HERE, motors.axis[m]] * motors.spu[m]
            note(P_END, m, times.duration, row, np.float64(ended[m]), aim, walk, problems)
            now[OVER] = 1
            now[STEPS] = steps
            return steps
    rest_problems(n, times.duration, row, begin, began, times, walk, problems)
    settle(n, times.duration, at, positions, progress, motors, times, window, walk, problems)
    if times.duration < still:
        note(P_WAIT_CUT, -1, times.duration, row, np.float64(still - times.duration), 0.0, walk, problems)
    now[OVER] = 1
    now[STEPS] = steps
    return steps
