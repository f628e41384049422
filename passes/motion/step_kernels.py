"""Step times of one motor from its planned rows. Used by ``step``.

``step_times`` inverts position over time exactly: on lines in closed form, on arcs by monotone pieces between the
extremes of the axis. ``take_up`` adds the steps that a motor makes to take up its backlash. docs/stream.md states the
rules that are kept here.

All loops work on one motor; times are ticks (int64) of one section.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from gproof.ir.kernel import kernel

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Signs = npt.NDArray[np.int8]

# Columns of the profile of a planned row.
R_BEGIN, R_DURATION, R_LENGTH, R_ENTRY, R_CRUISE, R_EXIT, R_ACCELERATION = 0, 1, 2, 3, 4, 5, 6
PROFILE_WIDTH = 7

# Columns of what a planned row means for the motor, in steps; the arc's are those of its cosine.
M_FROM, M_TO, M_ANGLE, M_SWEEP, M_RADIUS, M_RADIUS_TO, M_CENTER = 0, 1, 2, 3, 4, 5, 6
MOTOR_WIDTH = 7

# The motor while the section is walked: its count; the last step and the last one before the buffer; the first
# tick that is free; whether the last thing done was to leave a pair out; what steps had to give way, and pairs
# that were left out inside others; pieces that are done of an arc that did not fit into the buffer.
S_COUNT, S_TICK, S_SIGN, S_OLD_TICK, S_OLD_SIGN, S_FLOOR, S_OMITTED, S_LATE, S_NESTED, S_PIECES = range(10)
STATE_WIDTH = 10

# Backlash on its way: what is added to the motor's position, in steps, its velocity (steps a tick), where it goes;
# up to which tick that is worked out, and where the axis was then; counts of axis and motor; the axis's last step.
B_ADDED, B_VELOCITY, B_GOAL, B_TICK, B_AXIS, B_COUNT, B_MOTOR, B_LAST = range(8)
BACKLASH_WIDTH = 8

REACHED = 1e-6
"""Steps: backlash is taken up when no more than this is left."""

CLOSE = 1e-12
"""Relative difference of an arc's radii that is none."""


@kernel(seconds_per_unit=1e-6)
def time_at(s: float, length: float, duration: float, entry: float, cruise: float, leave: float, a: float,
            up: float, down: float) -> float:  # fmt: skip
    """Seconds after the row's start at which its path is ``s`` long; up, down: where the ramps end and start."""
    if s <= 0.0:
        return 0.0
    if s >= length:
        return duration
    if s < up:
        return min(duration, 2.0 * s / (entry + math.sqrt(entry * entry + 2.0 * a * s)))
    if s <= down:
        return min(duration, (cruise - entry) / a + (s - up) / cruise)
    rest = length - s
    return max(0.0, duration - 2.0 * rest / (leave + math.sqrt(leave * leave + 2.0 * a * rest)))


@kernel(seconds_per_unit=1e-6)
def put_step(tick: int, sign: int, near: int, turn: int, state: Ints, ticks: Ints, signs: Signs, count: int) -> int:
    """Append a step; the new number of steps.

    near, turn: least ticks between two steps in one direction, and across a change of direction. A step that
    is undone within ``turn`` is left out together with the one that undoes it; other steps give way.
    """
    last = int(state[S_TICK])
    if int(state[S_SIGN]) == sign:
        first = last + near
    else:
        first = last + turn
        if tick < first and count > 0 and int(state[S_SIGN]) == -sign:
            state[S_NESTED] += state[S_OMITTED]
            state[S_OMITTED] = 1
            count -= 1
            if count > 0:
                state[S_TICK] = ticks[count - 1]
                state[S_SIGN] = signs[count - 1]
            else:
                state[S_TICK] = state[S_OLD_TICK]
                state[S_SIGN] = state[S_OLD_SIGN]
            return count
    first = max(first, int(state[S_FLOOR]))
    if tick < first:
        state[S_LATE] = max(int(state[S_LATE]), first - tick)
        tick = first
    ticks[count] = tick
    signs[count] = sign
    state[S_TICK] = tick
    state[S_SIGN] = sign
    state[S_OMITTED] = 0
    return count + 1


@kernel(seconds_per_unit=1e-6)
def extreme(near: float, angle: float, radius: float, drift: float) -> float:
    """The angle near ``near`` (a multiple of pi) where r * cos has an extreme; r runs linearly with the angle.

    r' cos = r sin, so angle - atan(r' / r) is that multiple of pi: a function with a slope of 1 to 2.
    """
    x = near
    for _ in range(8):
        r = radius + drift * (x - angle)
        slope = 1.0 + drift * drift / (r * r + drift * drift) if r > 0.0 else 1.0
        step = (x - math.atan2(drift, r) - near) / slope
        x -= step
        if abs(step) < 1e-15 * (1.0 + abs(x)):
            break
    return x


@kernel(seconds_per_unit=3e-6)
def crossing(level: float, rate: float, center: float, angle: float, radius: float, drift: float,
             low: float, high: float, guess: float, rising: bool) -> float:  # fmt: skip
    """The angle between low and high where center + rate * r * cos is ``level``; the function is monotone there."""
    x = min(max(guess, low), high)
    for _ in range(80):
        r = radius + drift * (x - angle)
        cosine = math.cos(x)
        sine = math.sin(x)
        over = center + rate * r * cosine - level
        if (over < 0.0) == rising:
            low = x
        else:
            high = x
        slope = rate * (drift * cosine - r * sine)
        ahead = x - over / slope if abs(slope) > 1e-9 else low - 1.0
        if not low <= ahead <= high:
            ahead = 0.5 * (low + high)
        if abs(ahead - x) < 1e-10:
            return ahead
        x = ahead
    return x


@kernel(seconds_per_unit=1e-6)
def through(at: float, knots: Floats, source: int) -> float:
    """A position in steps through a pitch map, from column ``source`` of its knots to the other one.

    knots: (k, 2) the motor's and the axis's position at each point, both rising; outside them the shift stays. Without
    knots the motor is where its axis is.
    """
    last = len(knots) - 1
    if last < 0:
        return at
    target = 1 - source
    if at <= knots[0, source]:
        return at + float(knots[0, target] - knots[0, source])
    if at >= knots[last, source]:
        return at + float(knots[last, target] - knots[last, source])
    low, high = 0, last
    while high - low > 1:
        middle = (low + high) // 2
        if knots[middle, source] <= at:
            low = middle
        else:
            high = middle
    share = (at - knots[low, source]) / (knots[high, source] - knots[low, source])
    return float(knots[low, target] + share * (knots[high, target] - knots[low, target]))


@kernel(seconds_per_unit=4e-6, compile_seconds=1.2)
def step_times(
    first: int, last: int, profile: Floats, motor: Floats, target: Ints, rate: float, frequency: float, origin: int,
    near: int, turn: int, state: Ints, ticks: Ints, signs: Signs, count: int, knots: Floats,
) -> tuple[int, int]:  # fmt: skip
    """Steps of rows first..last-1; returns (the row that did not fit any more, the number of steps now).

    What fitted of that row is done and kept in ``state``: the next call, with room in ``ticks``, goes on there.

    profile: (n, 7) R_*, start relative to tick ``origin``; motor: (n, 7) M_*; target: (n,) count at the end of
    each row; rate: steps a unit, signed; frequency: ticks a second; state: S_*, kept from call to call; knots: the
    pitch map, see ``through``. What ``motor`` holds are steps of the axis.
    """
    for k in range(first, last):
        n = int(state[S_COUNT])
        end = int(target[k])
        sweep = float(motor[k, M_SWEEP])
        length = float(profile[k, R_LENGTH])
        if sweep == 0.0 and end == n:
            continue
        size = len(ticks)
        begin = float(profile[k, R_BEGIN])
        duration = float(profile[k, R_DURATION])
        entry = float(profile[k, R_ENTRY])
        cruise = float(profile[k, R_CRUISE])
        leave = float(profile[k, R_EXIT])
        a = float(profile[k, R_ACCELERATION])
        up = (cruise * cruise - entry * entry) / (2.0 * a)
        down = length - (cruise * cruise - leave * leave) / (2.0 * a)
        if sweep == 0.0:
            q = float(motor[k, M_FROM])
            distance = float(motor[k, M_TO]) - q
            each = length / distance if abs(distance) > 1e-9 else 0.0
            sign = 1 if end > n else -1
            # Once the motor steps in this direction, what ``put_step`` does to further steps is done here: faster.
            least = -1
            while n != end and count < size:
                level = n + 0.5 * sign
                if len(knots) > 0:
                    level = through(level, knots, 0)
                s = (level - q) * each
                t = begin + time_at(s, length, duration, entry, cruise, leave, a, up, down)
                tick = origin + int(t * frequency + 0.5)
                n += sign
                if least < 0:
                    count = put_step(tick, sign, near, turn, state, ticks, signs, count)
                    if state[S_OMITTED] == 0:
                        least = int(state[S_TICK]) + near
                    continue
                if tick < least:
                    state[S_LATE] = max(int(state[S_LATE]), least - tick)
                    tick = least
                ticks[count] = tick
                signs[count] = sign
                state[S_TICK] = tick
                least = tick + near
                count += 1
            state[S_COUNT] = n
            if n != end:
                return k, count
        else:
            angle = float(motor[k, M_ANGLE])
            radius = float(motor[k, M_RADIUS])
            center = float(motor[k, M_CENTER])
            drift = (float(motor[k, M_RADIUS_TO]) - radius) / sweep
            even = abs(float(motor[k, M_RADIUS_TO]) - radius) <= CLOSE * radius
            if even:
                drift = 0.0
            ahead = 1 if sweep > 0.0 else -1
            finish = angle + sweep
            # The next extreme is at angle = half * pi + atan(drift / r).
            g0 = (angle - math.atan2(drift, radius)) / math.pi
            g1 = (finish - math.atan2(drift, float(motor[k, M_RADIUS_TO]))) / math.pi
            half = math.floor(g0) + 1 if ahead > 0 else math.ceil(g0) - 1
            here = angle
            done = int(state[S_PIECES])
            if done > 0:
                half += ahead * done
                here = extreme((half - ahead) * math.pi, angle, radius, drift)
            going = True
            while going:
                stop = finish
                to = end
                if (half - g1) * ahead < 0.0:
                    stop = extreme(half * math.pi, angle, radius, drift)
                    stop = min(max(stop, here), finish) if ahead > 0 else max(min(stop, here), finish)
                    r = radius + drift * (stop - angle)
                    farthest = center + rate * r * math.cos(stop)
                    if len(knots) > 0:
                        farthest = through(farthest, knots, 1)
                    to = math.floor(farthest + 0.5)
                else:
                    going = False
                if abs(to - n) > size - count:
                    state[S_COUNT] = n
                    state[S_PIECES] = done
                    return k, count
                sign = 1 if to > n else -1
                low, high = min(here, stop), max(here, stop)
                # Between half - 1 and half (half + 1 when going back) the cosine falls from an even multiple of pi.
                base = half - 1 if ahead > 0 else half
                flip = 1.0 if base % 2 == 0 else -1.0
                rising = (sign > 0) == (ahead > 0)
                least = -1
                while n != to:
                    level = n + 0.5 * sign
                    if len(knots) > 0:
                        level = through(level, knots, 0)
                    r = radius + drift * (here - angle)
                    y = flip * (level - center) / (rate * r) if r > 0.0 else 0.0
                    x = base * math.pi + math.acos(min(max(y, -1.0), 1.0))
                    if even:
                        x = min(max(x, low), high)
                    else:
                        x = crossing(level, rate, center, angle, radius, drift, low, high, x, rising)
                    if ahead > 0:
                        low = x
                    else:
                        high = x
                    here = x
                    s = (x - angle) / sweep * length
                    t = begin + time_at(s, length, duration, entry, cruise, leave, a, up, down)
                    tick = origin + int(t * frequency + 0.5)
                    n += sign
                    if least < 0:
                        count = put_step(tick, sign, near, turn, state, ticks, signs, count)
                        if state[S_OMITTED] == 0:
                            least = int(state[S_TICK]) + near
                        continue
                    if tick < least:
                        state[S_LATE] = max(int(state[S_LATE]), least - tick)
                        tick = least
                    ticks[count] = tick
                    signs[count] = sign
                    state[S_TICK] = tick
                    least = tick + near
                    count += 1
                here = stop
                half += ahead
                done += 1
            state[S_COUNT] = end
            state[S_PIECES] = 0
    return last, count


@kernel(seconds_per_unit=1e-6)
def take_up_phase(left: float, velocity: float, fastest: float, a: float) -> tuple[float, float]:
    """Acceleration and its time on the quickest way to rest ``left`` steps ahead: steps a tick squared, ticks."""
    ahead = 1.0 if left > 0.0 or (left == 0.0 and velocity < 0.0) else -1.0
    speed = velocity * ahead
    distance = abs(left)
    braking = speed * speed / (2.0 * a)
    if speed < 0.0:
        return ahead * a, -speed / a
    if braking >= distance * (1.0 - 1e-9):
        return -ahead * a, speed / a
    if speed < fastest * (1.0 - 1e-12):
        peak = min(fastest, math.sqrt(0.5 * speed * speed + a * distance))
        return ahead * a, (peak - speed) / a
    return 0.0, (distance - braking) / speed


@kernel(seconds_per_unit=3e-6)
def add_steps(begin: float, from_: float, velocity: float, a: float, duration: float, backlash: Floats, near: int,
              turn: int, state: Ints, ticks: Ints, signs: Signs, count: int) -> int:  # fmt: skip
    """Steps of a motor that moves from ``from_`` with a velocity and an acceleration; the new number of steps.

    A step comes when the position passes a half: in each of the two parts in which it goes one way.
    """
    middle = duration
    if a != 0.0 and 0.0 < -velocity / a < duration:
        middle = -velocity / a
    done = 0.0
    for part in range(2):
        until = middle if part == 0 else duration
        if until <= done:
            break
        here = from_ + done * (velocity + 0.5 * a * done)
        there = from_ + until * (velocity + 0.5 * a * until)
        speed = velocity + a * done
        sign = 1 if there > here else -1
        while True:
            level = backlash[B_MOTOR] + 0.5 * sign
            if (there - level) * sign <= 0.0:
                break
            root = sign * math.sqrt(max(0.0, speed * speed + 2.0 * a * (level - here)))
            at = done
            if (level - here) * sign > 0.0 and speed + root != 0.0:
                at = min(until, done + 2.0 * (level - here) / (speed + root))
            count = put_step(int(begin + at + 0.5), sign, near, turn, state, ticks, signs, count)
            backlash[B_MOTOR] += sign
        done = until
    return count


@kernel(seconds_per_unit=5e-6)
def move_on(
    until: float, axis: float, fastest: float, a: float, backlash: Floats, near: int, turn: int, state: Ints,
    ticks: Ints, signs: Signs, count: int,
) -> int:  # fmt: skip
    """Carry the motor to tick ``until``, its axis evenly to ``axis``, while backlash is taken up."""
    while backlash[B_TICK] < until:
        left = backlash[B_GOAL] - backlash[B_ADDED]
        speed = backlash[B_VELOCITY]
        if abs(left) <= REACHED and speed * speed <= 8.0 * a * REACHED:
            backlash[B_ADDED] = backlash[B_GOAL]
            backlash[B_VELOCITY] = 0.0
            # Rounding may have left the motor's last step out.
            while abs(axis + backlash[B_GOAL] - backlash[B_MOTOR]) > 0.5 + REACHED:
                sign = 1 if axis + backlash[B_GOAL] > backlash[B_MOTOR] else -1
                count = put_step(int(backlash[B_TICK] + 0.5), sign, near, turn, state, ticks, signs, count)
                backlash[B_MOTOR] += sign
            backlash[B_TICK] = until
            backlash[B_AXIS] = axis
            break
        force, time = take_up_phase(left, speed, fastest, a)
        begin = float(backlash[B_TICK])
        rate = (axis - backlash[B_AXIS]) / (until - begin)
        cut = time >= until - begin
        if cut:
            time = until - begin
        count = add_steps(
            begin, backlash[B_AXIS] + backlash[B_ADDED], rate + speed, force, time, backlash, near, turn, state, ticks,
            signs, count,
        )  # fmt: skip
        backlash[B_ADDED] += time * (speed + 0.5 * force * time)
        backlash[B_VELOCITY] = speed + force * time
        backlash[B_AXIS] = axis if cut else backlash[B_AXIS] + rate * time
        backlash[B_TICK] = until if cut else begin + time
    return count


@kernel(seconds_per_unit=2e-6, compile_seconds=0.8)
def take_up(
    ticks_in: Ints, signs_in: Signs, first: int, last: int, amount: int, up: int, fastest: float, a: float,
    near: int, turn: int, backlash: Floats, state: Ints, ticks: Ints, signs: Signs, count: int,
) -> tuple[int, int]:  # fmt: skip
    """Steps of a motor with backlash from those of its axis; returns (axis steps done, the number of steps now).

    ticks_in, signs_in: the axis's, of which first..last-1 are taken as far as there is room; amount: steps of
    backlash; up: the direction in which none is to be taken up; fastest, a: how that is done, in steps a tick and a
    tick squared; backlash: B_*, state: S_* of the motor, both kept from call to call. Where the axis turns round, the
    motor's additional steps start so early that they are done in time if the axis was at rest for long enough, and
    otherwise as soon as the axis has made its last step.
    """
    whole = 2.0 * math.sqrt(amount / a)
    if amount * a > fastest * fastest:
        whole = fastest / a + amount / fastest
    for k in range(first, last):
        if len(ticks) - count < 4 * amount + 16:
            return k, count
        tick = int(ticks_in[k])
        sign = int(signs_in[k])
        n = float(backlash[B_COUNT])
        before = float(backlash[B_LAST])
        half = 0.5 * (before + tick)
        goal = 0.0 if sign == up else float(sign * amount)
        at = tick - 1.0
        if goal != backlash[B_GOAL]:
            at = max(before + turn, float(state[S_FLOOR]), tick - whole)
        for part in range(2):
            # By the middle of its cell to the half step that it passes at ``tick``.
            to = half if part == 0 else float(tick)
            axis = n if part == 0 else n + 0.5 * sign
            if goal != backlash[B_GOAL] and at < to:
                share = (at - backlash[B_TICK]) / (to - backlash[B_TICK]) if to > backlash[B_TICK] else 0.0
                if share > 0.0:
                    between = backlash[B_AXIS] + share * (axis - backlash[B_AXIS])
                    count = move_on(at, between, fastest, a, backlash, near, turn, state, ticks, signs, count)
                backlash[B_GOAL] = goal
            if backlash[B_ADDED] == backlash[B_GOAL] and backlash[B_VELOCITY] == 0.0:
                backlash[B_TICK] = max(float(backlash[B_TICK]), to)
                backlash[B_AXIS] = axis
            else:
                count = move_on(to, axis, fastest, a, backlash, near, turn, state, ticks, signs, count)
        backlash[B_GOAL] = goal
        backlash[B_COUNT] = n + sign
        backlash[B_LAST] = float(tick)
        idle = backlash[B_ADDED] == backlash[B_GOAL] and backlash[B_VELOCITY] == 0.0
        if idle and backlash[B_MOTOR] != n + sign + backlash[B_GOAL]:
            count = put_step(tick, sign, near, turn, state, ticks, signs, count)
            backlash[B_MOTOR] += sign
    return last, count


@kernel(seconds_per_unit=1e-4)
def take_up_rest(
    begin: int, fastest: float, a: float, near: int, turn: int, backlash: Floats, state: Ints, ticks: Ints,
    signs: Signs, count: int,
) -> int:  # fmt: skip
    """What is left to take up while the axis rests, from tick ``begin`` on; the number of steps now."""
    backlash[B_TICK] = max(float(backlash[B_TICK]), float(begin))
    if backlash[B_ADDED] != backlash[B_GOAL] or backlash[B_VELOCITY] != 0.0:
        # From the half step that it passed last, the axis has gone on towards the middle of its cell.
        rest = float(backlash[B_COUNT])
        count = move_on(
            float(backlash[B_TICK]) + 8.0 * turn, rest, fastest, a, backlash, near, turn, state, ticks, signs, count
        )
        far = float(backlash[B_TICK])
        while backlash[B_ADDED] != backlash[B_GOAL] or backlash[B_VELOCITY] != 0.0:
            far = 2.0 * far + 1e6
            count = move_on(far, rest, fastest, a, backlash, near, turn, state, ticks, signs, count)
        backlash[B_LAST] = float(state[S_TICK])
        backlash[B_TICK] = float(state[S_TICK])
    backlash[B_AXIS] = backlash[B_COUNT]
    return count
