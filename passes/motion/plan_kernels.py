"""Velocity along the path: limits of each row, corners, look-ahead, time. Used by ``plan`` and ``MotionEstimate``.

``measure`` walks the rows of a trace once and fills a queue; ``settle`` turns the queue's finished part into
velocities and times. Between the two is the look-ahead: a forward pass, which ``measure`` makes as it
goes, and a backward pass in ``settle``. Speeds are kept as squares, so that both passes only add and compare:
over a length L with acceleration a the square of the speed changes by at most 2 a L.

docs/plan.md states the limits that are kept here and shows why they are kept.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from gproof.ir.kernel import kernel

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

TRAVERSE, ARC, PROBE, DWELL, SPINDLE, HOME, OFFSET, SETPOINT = 1, 3, 4, 10, 11, 17, 18, 29
"""Ops of ir/trace.py that the loop must know; plan.py asserts it. DWELL to HOME and SETPOINT happen at rest, an OFFSET
where its second argument says so."""

SHORTEST = 1e-9
"""mm or deg: rows that together stay below this take no time."""

LONGEST = 1e9
"""mm, deg or s: what is longer, or not a number, is no length and no time."""

CORNER_SHARE = 0.75
"""Of an axis's acceleration, what the corners at the two ends of a row may use; the rest is for its ramps."""

NORMAL_SHARE = 0.8660254037844386
"""Of an axis's acceleration, what the curvature of an arc may use: sqrt(3)/2 leaves half for the ramps."""

FREE = 1e150
"""A speed without a limit; its square is a number."""

# Columns of the queue: one line for each row that takes time.
Q_REACH, Q_GAIN, Q_SPEED, Q_ACCELERATION, Q_LENGTH, Q_WAIT, Q_KIND, Q_ROW = 0, 1, 2, 3, 4, 5, 6, 7
QUEUE_WIDTH = 8
ROTARY = 32.0
"""Added to the kind of a row that moves rotary axes alone; a kind of 0 is a gap that takes no time."""

# What ``measure`` remembers from row to row: the pending row, whose end is not known yet, and what came before it.
(
    C_PENDING, C_LENGTH, C_SPEED, C_CURVE, C_INERTIA, C_CORNERS, C_ENTRY, C_KIND, C_ROW, C_BEFORE, C_REACH, C_STOP,
    C_FRAME, C_FED, C_FED_STATE, C_SPINDLE, C_SKIPPED,
) = range(17)  # fmt: skip
CARRY_WIDTH = 17

SPINDLE_UNSEEN = 2.0
"""The spindle's direction where a section starts: none that a start could not be a change from."""

# Kinds of notes; N_COUNT of them are counted, the first ones kept with their row and axis.
N_UNKNOWN, N_FEED, N_OVER, N_DWELL = 0, 1, 2, 3
N_COUNT = 4
KEPT = 32

# Totals of ``settle``.
T_TIME, T_FEED_LENGTH, T_TRAVERSE_LENGTH, T_FEED_ANGLE, T_TRAVERSE_ANGLE, T_ROWS = 0, 1, 2, 3, 4, 5
TOTALS_WIDTH = 8

# Columns of ``settle``'s output.
P_ROW, P_BEGIN, P_DURATION, P_LENGTH, P_ENTRY, P_CRUISE, P_EXIT, P_ACCELERATION = 0, 1, 2, 3, 4, 5, 6, 7
OUT_WIDTH = 8

TWO_PI = 2.0 * math.pi
HALF_PI = 0.5 * math.pi


@kernel(seconds_per_unit=2e-6)
def arc_shape(u0: float, v0: float, u1: float, v1: float, turns: int) -> tuple[float, float, float, float]:
    """An arc about the origin of its plane: start angle, signed sweep, radius at the start and at the end.

    Beyond whole turns the sweep is above 0 and at most a full circle, also where one of the angles is pi and the
    other -pi.
    """
    begin = math.atan2(v0, u0)
    sweep = math.atan2(v1, u1) - begin
    if turns > 0:
        if sweep <= 0.0:
            sweep += TWO_PI
        if sweep <= 0.0:
            sweep = TWO_PI
        sweep += TWO_PI * (turns - 1)
    else:
        if sweep >= 0.0:
            sweep -= TWO_PI
        if sweep >= 0.0:
            sweep = -TWO_PI
        sweep += TWO_PI * (turns + 1)
    return begin, sweep, math.sqrt(u0 * u0 + v0 * v0), math.sqrt(u1 * u1 + v1 * v1)


@kernel(seconds_per_unit=4e-6, compile_seconds=0.3)
def arc_shapes(start: Floats, to: Floats, center: Floats, turns: Any, plane: Any, out: Floats) -> None:
    """``arc_shape`` of arc rows; start, to: (n, 6); out: (n, 4)."""
    for k in range(len(out)):
        p = (int(plane[k]) + 1) % 3 if int(plane[k]) != 1 else 0
        if int(plane[k]) == 2:
            p = 2
        elif int(plane[k]) == 3:
            p = 1
        q = (p + 1) % 3
        cu, cv = float(center[k, p]), float(center[k, q])
        begin, sweep, r0, r1 = arc_shape(
            float(start[k, p]) - cu, float(start[k, q]) - cv, float(to[k, p]) - cu, float(to[k, q]) - cv, int(turns[k])
        )
        out[k, 0] = begin
        out[k, 1] = sweep
        out[k, 2] = r0
        out[k, 3] = r1


@kernel(seconds_per_unit=1e-6)
def most_sine(low: float, high: float) -> float:
    """The largest ``|sin|`` between two angles, low <= high."""
    if math.floor(low / math.pi - 0.5) != math.floor(high / math.pi - 0.5):
        return 1.0
    return max(abs(math.sin(low)), abs(math.sin(high)))


@kernel(seconds_per_unit=3e-6)
def finish_row(carry: Floats, queue: Floats, used: int) -> int:
    """Put the pending row, now that both its corners are known, into the queue; the queue's new length."""
    if carry[C_PENDING] == 0.0:
        return used
    speed = float(carry[C_SPEED])
    corners = float(carry[C_CORNERS])
    curve = float(carry[C_CURVE])
    if corners * speed > CORNER_SHARE:
        speed = CORNER_SHARE / corners
    if curve > 0.0:
        # corners * speed + curve * speed² / NORMAL_SHARE <= 1
        speed = min(speed, 2.0 / (corners + math.sqrt(corners * corners + 4.0 * curve / NORMAL_SHARE)))
        rest = 1.0 - corners * speed
        normal = curve * speed * speed
        share = math.sqrt(max(rest * rest - normal * normal, 0.0625 * rest * rest))
    else:
        share = 1.0 - corners * speed
    acceleration = share / float(carry[C_INERTIA])
    entry = min(float(carry[C_ENTRY]), float(carry[C_BEFORE]), speed)
    reach = min(entry * entry, float(carry[C_REACH]))
    gain = 2.0 * acceleration * float(carry[C_LENGTH])
    queue[used, Q_REACH] = reach
    queue[used, Q_GAIN] = gain
    queue[used, Q_SPEED] = speed
    queue[used, Q_ACCELERATION] = acceleration
    queue[used, Q_LENGTH] = carry[C_LENGTH]
    queue[used, Q_WAIT] = 0.0
    queue[used, Q_KIND] = carry[C_KIND]
    queue[used, Q_ROW] = carry[C_ROW]
    carry[C_PENDING] = 0.0
    carry[C_BEFORE] = speed
    carry[C_REACH] = reach + gain
    return used + 1


@kernel(seconds_per_unit=2e-6)
def put_rest(carry: Floats, queue: Floats, used: int, kind: float, row: int, wait: float) -> int:
    """Queue a time of rest (kind 10 or 11), or a gap (kind 0) that any speed may enter and leave."""
    gap = kind == 0.0
    before = float(carry[C_BEFORE])
    queue[used, Q_REACH] = min(before * before, float(carry[C_REACH])) if gap else 0.0
    queue[used, Q_GAIN] = FREE * FREE if gap else 0.0
    queue[used, Q_SPEED] = 0.0
    queue[used, Q_ACCELERATION] = 0.0
    queue[used, Q_LENGTH] = 0.0
    queue[used, Q_WAIT] = wait
    queue[used, Q_KIND] = kind
    queue[used, Q_ROW] = row
    carry[C_BEFORE] = FREE if gap else 0.0
    carry[C_REACH] = FREE * FREE if gap else 0.0
    return used + 1


@kernel(seconds_per_unit=1e-6)
def note(kind: int, row: int, counts: Ints, notes: Ints) -> None:
    """Count a note and keep the first ones of its kind."""
    if counts[kind] < KEPT:
        notes[kind, counts[kind]] = row
    counts[kind] += 1


class PlannedRows(NamedTuple):
    """Columns of TRACE_ROW."""

    op: Any
    to: Floats
    frame: Any
    state: Any
    feed: Floats
    center: Floats
    turns: Any
    plane: Any
    arg: Floats


class PlanRules(NamedTuple):
    """What holds for all rows. forms: what stands for each frame, equal numbers for equal unknowns, -1 where a
    difference cannot be known; chords: for each state the square of the largest change of direction that passes
    without a stop, -1 for none; limits: (2, 6) 1 / velocity and 1 / acceleration; period: the interpolation time; ramp:
    seconds after a spindle start or reversal."""

    forms: Ints
    chords: Floats
    limits: Floats
    period: float
    ramp: float


class PlanMemory(NamedTuple):
    """What is kept from call to call. place: (3, 6) position, direction at the end of the pending row, scratch; carry:
    see C_*; moved: (6,) set to 1 for axes that move; counts, notes: see N_*."""

    place: Floats
    carry: Floats
    moved: Ints
    counts: Ints
    notes: Ints


@kernel(seconds_per_unit=2e-5, compile_seconds=2.5)
def measure(
    rows: PlannedRows,
    begin: int,
    joined: Any,
    rules: PlanRules,
    kept: PlanMemory,
    queue: Floats,
    used: int,
    closing: bool,
) -> int:
    """Rows of a section into the queue; returns the queue's new length.

    ``begin``: section's row number of the first row; joined: 1 for rows that go on with the one before, at any turn,
    or empty; closing: the section ends with the rows.
    """
    op, to, frame, state, feed, center, turns, plane, arg = rows
    forms, chords, limits, period, ramp = rules
    place, carry, moved, counts, notes = kept
    for k in range(len(op)):
        kind = int(op[k])
        form = int(forms[int(frame[k])])
        if kind >= DWELL:
            if form != int(carry[C_FRAME]) or kind == HOME:
                carry[C_FRAME] = form
                for i in range(6):
                    place[0, i] = to[k, i]
            if kind > HOME and kind != SETPOINT and not (kind == OFFSET and float(arg[k, 1]) != 0.0):
                continue
            used = finish_row(carry, queue, used)
            carry[C_STOP] = 1.0
            wait = 0.0
            if kind == DWELL:
                wait = float(arg[k, 0])
                if not 0.0 <= wait <= LONGEST:
                    note(N_DWELL, begin + k, counts, notes)
                    wait = 0.0
            elif kind == SPINDLE:
                if float(arg[k, 0]) != 0.0 and float(arg[k, 0]) != float(carry[C_SPINDLE]):
                    wait = ramp
                carry[C_SPINDLE] = arg[k, 0]
            if wait > 0.0:
                used = put_rest(carry, queue, used, float(kind), begin + k, wait)
            continue

        known = form >= 0 and form == int(carry[C_FRAME])
        carry[C_FRAME] = form
        dx = float(to[k, 0]) - float(place[0, 0])
        dy = float(to[k, 1]) - float(place[0, 1])
        dz = float(to[k, 2]) - float(place[0, 2])
        da = float(to[k, 3]) - float(place[0, 3])
        db = float(to[k, 4]) - float(place[0, 4])
        dc = float(to[k, 5]) - float(place[0, 5])
        rotary = 0.0
        fast = 0.0
        inertia = 0.0
        curve = 0.0
        p, q, third = 0, 1, 2
        sine0, cosine0, sine1, cosine1, turn, drift = 0.0, 1.0, 0.0, 1.0, 0.0, 0.0
        r0, r1 = 0.0, 0.0
        if kind == ARC:
            if int(plane[k]) == 2:
                p, q, third = 2, 0, 1
            elif int(plane[k]) == 3:
                p, q, third = 1, 2, 0
            u0 = float(place[0, p]) - float(center[k, p])
            v0 = float(place[0, q]) - float(center[k, q])
            u1 = float(to[k, p]) - float(center[k, p])
            v1 = float(to[k, q]) - float(center[k, q])
            start, sweep, r0, r1 = arc_shape(u0, v0, u1, v1, int(turns[k]))
            flat = 0.5 * (r0 + r1) * sweep
            along = float(to[k, third]) - float(place[0, third])
            # What the radius drifts (0.002 mm at most) is path too: all there is of an arc without an angle.
            length = math.sqrt(flat * flat + along * along + (r1 - r0) * (r1 - r0))
            if length < SHORTEST:
                length = max(length, math.sqrt(da * da + db * db + dc * dc))
        else:
            length = math.sqrt(dx * dx + dy * dy + dz * dz)
            if length < SHORTEST:
                angle = math.sqrt(da * da + db * db + dc * dc)
                if angle > length:
                    length = angle
                    rotary = ROTARY
        if not (known and length < LONGEST):
            note(N_UNKNOWN, begin + k, counts, notes)
            used = finish_row(carry, queue, used)
            if carry[C_STOP] != 0.0:
                carry[C_BEFORE] = 0.0
                carry[C_STOP] = 0.0
            used = put_rest(carry, queue, used, 0.0, begin + k, 0.0)
            for i in range(6):
                place[0, i] = to[k, i]
            continue
        skipped = float(carry[C_SKIPPED]) + length
        if skipped < SHORTEST:
            carry[C_SKIPPED] = skipped
            for i in range(6):
                place[0, i] = to[k, i]
            continue
        carry[C_SKIPPED] = 0.0

        # Directions: axis velocity is path velocity times ``place[2]`` at the start, ``place[1]`` at the end.
        each = 1.0 / length
        place[2, 0] = dx * each
        place[2, 1] = dy * each
        place[2, 2] = dz * each
        place[2, 3] = da * each
        place[2, 4] = db * each
        place[2, 5] = dc * each
        arc_fast = 0.0
        if kind == ARC:
            turn = sweep * each
            drift = (r1 - r0) / sweep
            if r0 > 0.0:
                cosine0, sine0 = u0 / r0, v0 / r0
            if r1 > 0.0:
                cosine1, sine1 = u1 / r1, v1 / r1
            place[2, p] = 0.0
            place[2, q] = 0.0
            wide = max(r0, r1)
            slip = abs(drift)
            rate = abs(turn)
            low, high = min(start, start + sweep), max(start, start + sweep)
            fast_p = rate * (slip + wide * most_sine(low, high)) * float(limits[0, p])
            fast_q = rate * (slip + wide * most_sine(low + HALF_PI, high + HALF_PI)) * float(limits[0, q])
            arc_fast = max(fast_p, fast_q)
            weak = max(float(limits[1, p]), float(limits[1, q]))
            curve = rate * rate * (wide + 2.0 * slip) * weak
            inertia = rate * (wide + slip) * weak
            moved[p] = 1
            moved[q] = 1
        fast = arc_fast
        for i in range(6):
            t = abs(float(place[2, i]))
            if t > 0.0:
                moved[i] = 1
                fast = max(fast, t * float(limits[0, i]))
                inertia = max(inertia, t * float(limits[1, i]))
        if kind == ARC:
            place[2, p] = (drift * cosine0 - r0 * sine0) * turn
            place[2, q] = (drift * sine0 + r0 * cosine0) * turn
        speed = 1.0 / fast if fast * FREE > 1.0 else FREE
        if curve > 0.0:
            speed = min(speed, math.sqrt(NORMAL_SHARE / curve))
        if kind != TRAVERSE:
            wanted = float(feed[k]) / 60.0
            if wanted * LONGEST > length:
                if speed < wanted * (1.0 - 1e-9):
                    if float(carry[C_FED]) != wanted or float(carry[C_FED_STATE]) != float(state[k]):
                        note(N_OVER, begin + k, counts, notes)
                        carry[C_FED] = wanted
                        carry[C_FED_STATE] = state[k]
                else:
                    speed = wanted
            else:
                note(N_FEED, begin + k, counts, notes)

        # The corner between the pending row and this one.
        entry = FREE
        corners = 0.0
        if carry[C_STOP] != 0.0:
            entry = 0.0
        elif carry[C_PENDING] != 0.0:
            entry = 0.0
            before = float(carry[C_KIND])
            if (before >= ROTARY) == (rotary > 0.0) and before != float(PROBE) and before != PROBE + ROTARY:
                chord = 0.0
                worst = 0.0
                for i in range(6):
                    d = abs(float(place[2, i]) - float(place[1, i]))
                    if d > 0.0:
                        worst = max(worst, d * float(limits[1, i]))
                        if (i >= 3) == (rotary > 0.0):
                            chord += d * d
                if (len(joined) > 0 and joined[k] == 1) or chord <= float(chords[int(state[k])]):
                    entry = min(speed, float(carry[C_SPEED]))
                    if worst > 0.0:
                        both = float(carry[C_LENGTH]) + length
                        if worst * entry > period:
                            entry = period / worst
                        if 2.0 * worst * entry * entry > CORNER_SHARE * both:
                            entry = math.sqrt(CORNER_SHARE * both / (2.0 * worst))
                        corners = entry * worst / both
                        carry[C_CORNERS] += corners
        used = finish_row(carry, queue, used)
        carry[C_PENDING] = 1.0
        carry[C_LENGTH] = length
        carry[C_SPEED] = speed
        carry[C_CURVE] = curve
        carry[C_INERTIA] = inertia
        carry[C_CORNERS] = corners
        carry[C_ENTRY] = entry
        carry[C_KIND] = kind + rotary
        carry[C_ROW] = begin + k
        carry[C_STOP] = 0.0
        for i in range(6):
            place[0, i] = to[k, i]
            place[1, i] = place[2, i]
        if kind == ARC:
            place[1, p] = (drift * cosine1 - r1 * sine1) * turn
            place[1, q] = (drift * sine1 + r1 * cosine1) * turn
    if closing:
        used = finish_row(carry, queue, used)
        carry[C_STOP] = 1.0
    return used


@kernel(seconds_per_unit=6e-6, compile_seconds=0.5)
def settle(queue: Floats, used: int, closed: bool, totals: Floats, out: Floats) -> int:
    """Final speeds and times of the queue's lines that can be final; returns how many those are.

    closed: what follows the last line starts at rest. Otherwise a line is final when a stop right after the
    queue would not change it: the backward pass from rest has then met the forward pass, which is the most
    that is possible. totals: see T_*, added to. out: (used, 8) see P_*, or no lines when only totals are wanted.
    """
    done = used
    after = 0.0
    if not closed:
        done = 0
        square = 0.0
        for k in range(used - 1, 0, -1):
            square += float(queue[k, Q_GAIN])
            if square >= float(queue[k, Q_REACH]):
                done = k
                after = float(queue[k, Q_REACH])
                break
    last = after
    for k in range(done - 1, -1, -1):
        after = min(float(queue[k, Q_REACH]), after + float(queue[k, Q_GAIN]))
        queue[k, Q_REACH] = after
    time = float(totals[T_TIME])
    entry = math.sqrt(float(queue[0, Q_REACH])) if done > 0 else 0.0
    for k in range(done):
        ahead = float(queue[k + 1, Q_REACH]) if k + 1 < done else last
        leave = math.sqrt(ahead)
        duration = float(queue[k, Q_WAIT])
        cruise = 0.0
        length = float(queue[k, Q_LENGTH])
        if length > 0.0:
            square = float(queue[k, Q_REACH])
            acceleration = float(queue[k, Q_ACCELERATION])
            cruise = float(queue[k, Q_SPEED])
            peak = 0.5 * (square + ahead + float(queue[k, Q_GAIN]))
            if peak < cruise * cruise:
                cruise = math.sqrt(peak)
            cruise = max(cruise, entry, leave)
            ramps = (2.0 * cruise * cruise - square - ahead) / (2.0 * acceleration)
            duration = (2.0 * cruise - entry - leave) / acceleration + max(0.0, length - ramps) / cruise
            kind = float(queue[k, Q_KIND])
            if kind == TRAVERSE:
                totals[T_TRAVERSE_LENGTH] += length
            elif kind < ROTARY:
                totals[T_FEED_LENGTH] += length
            elif kind == TRAVERSE + ROTARY:
                totals[T_TRAVERSE_ANGLE] += length
            else:
                totals[T_FEED_ANGLE] += length
        if len(out) > 0:
            out[k, P_ROW] = queue[k, Q_ROW]
            out[k, P_BEGIN] = time
            out[k, P_DURATION] = duration
            out[k, P_LENGTH] = length
            out[k, P_ENTRY] = entry
            out[k, P_CRUISE] = cruise
            out[k, P_EXIT] = leave
            out[k, P_ACCELERATION] = queue[k, Q_ACCELERATION]
        time += duration
        entry = leave
    totals[T_TIME] = time
    totals[T_ROWS] += done
    return done
