"""The traced path in steps, piece by piece, and which of its points the machine may be at.

A motor with a pitch table is compared on its axis: the step positions one step to either side of it are carried there
(``axis_steps``), so that the path stays straight. The path comes as straight pieces that are made when they are needed:
a line row is one piece, an arc row many chords whose distance from the arc, at equal parameter, is at most ``CHORD``
steps of any motor.

Which path points the machine may be at is kept exactly, not guessed: for each piece of a window the interval
of the piece's parameter that can be reached without ever being more than the tolerance away from the step
position and without going back (the free space of the Fréchet distance in the maximum norm). A step shrinks
the intervals to what is also near the new position; when none is left, no path point explains it.
"""

from __future__ import annotations

import math

import numpy as np

from gproof.ir.kernel import kernel
from gproof.verify.kernel.walk_state import Floats, Ints, Motors, Rows, Walk, Window

ROUNDING = 1e-6
"""Steps: more than what float64 loses between a position of the trace and steps."""

CHORD = 1e-2
"""Steps between an arc and the chords it is followed with, at most."""

EXACT = 0.5 + ROUNDING
"""Steps between a position at rest and the traced position: the nearest step, either one at a tie."""

WINDOW = 8192
"""Pieces of path within one tolerance box that the checker is ready to hold."""

TINY = 1e-9

# Rows of trace ops that the loop must know; rows.py asserts that they are those of ir/trace.py.
ARC_OP = 3
LAST_MOTION_OP = 4

# What ``Walk.ints`` holds.
ROW, PIECE, PIECES, BARRIER = 0, 1, 2, 3  # row being made or next, next piece of it, pieces in it (0: none), next event
HEAD, TAIL, FRONT, DONE = 4, 5, 6, 7  # window start and end, last reachable piece, 1: all that was made is reachable
FIRST, SECOND, NOTED = 8, 9, 10  # the row's arc axes (-1: a line); problems kept
INTS = 11

# What ``Walk.reals`` holds: of an arc radii, angles, centre, the last piece's direction; seconds at full feed of a
# piece of the row, and of all pieces made so far.
R0, R1, ANGLE, SWEEP, CENTER_0, CENTER_1, COS, SIN, SHARE, TIME = 0, 1, 2, 3, 4, 5, 6, 7, 8, 9
MORE = 10  # what the open row adds to the tolerance
REALS = 11

# What ``Walk.place`` holds: the path made so far, the end of the next piece, start and end of the row.
HERE, NEXT, ORIGIN, GOAL = 0, 1, 2, 3
PLACES = 4

# Columns of ``Window``.
BEGIN, EXTENT, INVERSE = 0, 1, 2
FROM, TO, BEFORE, SECONDS, SLACK = 0, 1, 2, 3, 4
UNREACHED = 2.0


@kernel(seconds_per_unit=2e-6, borrows=True)
def axis_steps(at: float, m: int, knots: Floats, first_knot: Ints) -> float:
    """Where the axis is, in its steps, when motor ``m`` is at ``at``: linear between knots, shifted outside them."""
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
    """Move the window to the arrays' start; False when it holds more than WINDOW pieces."""
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
    """Start again at the path point reached so far: the window holds that one point."""
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
