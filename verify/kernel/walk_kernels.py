"""The walk over a section: all motors' steps in time order against the traced path.

Where a motor has backlash, what is compared with the path is the axis that it drives (``Backlash``): it stays while the
motor is between the two flanks of its backlash, and goes with it at either. path_kernels.py keeps the points that the
machine may be at.

docs/verification.md proves what follows from a run without a problem, and that a right stream gives none.
"""

from __future__ import annotations

import math

import numpy as np

from gproof.ir.kernel import kernel
from gproof.verify.kernel.path_kernels import (
    BEFORE,
    DONE,
    FROM,
    FRONT,
    HEAD,
    HERE,
    NOTED,
    ROW,
    SECONDS,
    TAIL,
    TIME,
    TO,
    axis_steps,
    extend,
    follow,
    from_rest,
    off_place,
    shrink,
)
from gproof.verify.kernel.walk_state import (
    Backlash,
    Cursor,
    Events,
    Floats,
    Ints,
    Motors,
    Problems,
    Rows,
    Runs,
    Times,
    Walk,
    Window,
)

PATH_TOLERANCE = 1.0
"""Steps that a motor may be away from the path point, all motors from the same path point."""

SPANS = (1, 4, 16)
"""Windows for velocity, acceleration and feed, in interpolation times."""

RING = 64
SETTLED = 2 * 16 + 1
"""Samples without a step after which all windows are still."""

FEED_SLACK = 1e-6
"""Seconds by which a window may seem shorter than its feed allows (float64)."""

NEVER = 1 << 62

# Problems, as they are reported.
P_LEFT, P_DENSE, P_EXTRA, P_RATE, P_PULSE, P_SETUP, P_SPEED, P_ACCELERATION, P_FEED = 1, 2, 3, 4, 5, 6, 7, 8, 9
P_EARLY, P_OFF_PLACE, P_WAIT_CUT, P_UNFINISHED, P_END = 10, 11, 12, 13, 14
P_LIMIT, P_TRAVEL, P_LIMIT_UNKNOWN, P_AFTER_END, P_SLACK = 15, 16, 17, 18, 19
PROBLEMS = 20

KEPT = 8
"""Places kept of each problem; all are counted."""

# What ``Cursor.now`` holds: 1: nothing more to follow; 1: an axis lags; 1: more is near than the window holds; place in
# the rings; samples without a step; steps made, and at the last sample; next event; tick up to which motors are
# at rest; tick of the last rest; tick of the next sample.
OVER, LAGGING, DENSE, AT, QUIET, STEPS, SAMPLED, EVENT, STILL, REST, EDGE = 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10
NOW = 11


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
    """Move the axis of motor ``m``, which made a step at ``t``; before: its last direction. True when it moved."""
    slack = motors.slack[m]
    upwards = 1 if slack > 0 else -1
    last = before if before != 0 else upwards
    if slack != 0 and direction != last:
        backlash.until[m] = t + motors.patience[m]
    here = min(max(backlash.at[m], min(n[m], n[m] + slack)), max(n[m], n[m] + slack))
    moved = here != backlash.at[m]
    backlash.at[m] = here
    return bool(moved)


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
    """At rest at a known path point: steps back and forth that the path does not need; feed since the last rest."""
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
