"""Exact extents of trace rows: ends of lines, extremes of arcs and helices."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from gproof.ir.columns import Columns
from gproof.ir.kernel import kernel

TWO_PI = 2.0 * math.pi


@kernel()
def swelling(radius: float, growth: float, past: float, total: float) -> float:
    """The greatest (radius + growth t) cos(past + t) for t in 0 ... total: of a spiral that grows away from an extreme.

    growth: mm a radian, more than 0; past, total: radians, past less than a quarter turn. Of the values that Newton's
    steps find, which is right to the second order of their error.
    """
    t = 0.0
    best = radius * math.cos(past)
    for _ in range(40):
        now, cosine, sine = radius + growth * t, math.cos(past + t), math.sin(past + t)
        best = max(best, now * cosine)
        bend = 2.0 * growth * sine + now * cosine
        if bend <= 0.0:
            break
        onward = min(max(t + (growth * cosine - now * sine) / bend, 0.0), total)
        if abs(onward - t) <= 1e-15:
            break
        t = onward
    return best


@kernel()
def arc_extreme(u0: float, v0: float, u1: float, v1: float, turns: int) -> tuple[float, float, float, float, float]:
    """Extremes of an arc about the origin from (u0, v0) to (u1, v1): (low u, high u, low v, high v, sweep).

    The plane's pair is right-handed; counter-clockwise for positive turns. Where the two radii differ
    the larger one counts at the quarters that the arc passes. One that starts or ends next to a quarter and grows away
    from it goes further than its end (``swelling``), so the box is never too small.
    """
    start = math.atan2(v0, u0)
    sign = 1.0 if turns > 0 else -1.0
    sweep = (math.atan2(v1, u1) - start) * sign
    if sweep <= 0.0:
        sweep += TWO_PI
    if sweep <= 0.0:
        sweep += TWO_PI
    if u0 == u1 and v0 == v1:
        sweep = TWO_PI
    whole = abs(turns) > 1
    first, last = math.sqrt(u0 * u0 + v0 * v0), math.sqrt(u1 * u1 + v1 * v1)
    radius = max(first, last)
    growth = (last - first) / sweep
    low_u, high_u = min(u0, u1), max(u0, u1)
    low_v, high_v = min(v0, v1), max(v0, v1)
    for quarter in range(4):
        ahead = (quarter * (math.pi / 2.0) - start) * sign
        while ahead < 0.0:
            ahead += TWO_PI
        while ahead >= TWO_PI:
            ahead -= TWO_PI
        reach = radius
        if not whole and ahead > sweep:
            # How far after the quarter it starts, or before it ends, seen from that end.
            past = TWO_PI - ahead if growth > 0.0 else ahead - sweep
            own = first if growth > 0.0 else last
            if past * own >= abs(growth):
                continue
            reach = swelling(own, abs(growth), past, sweep)
        if quarter == 0:
            high_u = max(high_u, reach)
        elif quarter == 1:
            high_v = max(high_v, reach)
        elif quarter == 2:
            low_u = min(low_u, -reach)
        else:
            low_v = min(low_v, -reach)
    return low_u, high_u, low_v, high_v, sweep + (abs(turns) - 1) * TWO_PI


class BoxedRows(NamedTuple):
    """Columns of TRACE_ROW."""

    op: Any
    to: Any
    center: Any
    turns: Any
    plane: Any
    frame: Any
    state: Any


class Extents(NamedTuple):
    """low, high: (2 * frames, 6) at 2 * frame + guard off; low_row, high_row: rows of those extremes. All updated."""

    low: Any
    high: Any
    low_row: Any
    high_row: Any


class Beyond(NamedTuple):
    """Gets the first places beyond a limit: row, axis, reach."""

    row: Any
    axis: Any
    reach: Any


def boxed_rows(rows: Columns) -> BoxedRows:
    """The columns of a table of TRACE_ROW."""
    return BoxedRows(*(rows[name] for name in BoxedRows._fields))


def room_beyond(room: int) -> Beyond:
    """Room for so many places."""
    return Beyond(np.zeros(room, np.int64), np.zeros(room, np.int64), np.zeros(room))


@kernel(seconds_per_unit=6e-6, compile_seconds=0.6)
def row_boxes(
    rows: BoxedRows, guard_off: Any, position: Any, known: Any, lower: Any, upper: Any, extents: Extents,
    beyond: Beyond, added: Any,
) -> int:  # fmt: skip
    """Extents by frame and guard, and the rows beyond known limits.

    guard_off: of each state; position: (6,) before the first row, updated; known: (frames, 6) 1 where the axis is known
    in that frame; lower, upper: (2, 6) limits with guard on and off, infinite where there are none; added: (n, 2) least
    and most that is added to Z in each row, or (0, 2). Returns the number of offences, which may exceed the room for
    them.
    """
    op, to, center, turns, plane, frame, state = rows
    low, high, low_row, high_row = extents
    bad_row, bad_axis, bad_reach = beyond
    bad = 0
    for row in range(len(op)):
        if op[row] >= 10:
            continue
        off = guard_off[state[row]]
        f = frame[row]
        slot = 2 * f + off
        u = v = -1
        cu = cv = a = b = c = d = 0.0
        if op[row] == 3:
            p = plane[row]
            u = 0 if p == 1 else (2 if p == 2 else 1)
            v = 1 if p == 1 else (0 if p == 2 else 2)
            cu, cv = center[row, u], center[row, v]
            u0, v0, u1, v1 = position[u] - cu, position[v] - cv, to[row, u] - cu, to[row, v] - cv
            # A circle around all of the arc that widens nothing and passes no limit: no need of its angles.
            radius = max(math.sqrt(u0 * u0 + v0 * v0), math.sqrt(u1 * u1 + v1 * v1))
            a, b = min(u0, u1, -radius), max(u0, u1, radius)
            c, d = min(v0, v1, -radius), max(v0, v1, radius)
            if not (
                len(added) == 0
                and cu + a >= max(low[slot, u], lower[off, u])
                and cu + b <= min(high[slot, u], upper[off, u])
                and cv + c >= max(low[slot, v], lower[off, v])
                and cv + d <= min(high[slot, v], upper[off, v])
            ):
                a, b, c, d, _ = arc_extreme(u0, v0, u1, v1, turns[row])
        for axis in range(6):
            least = most = to[row, axis]
            if axis == u:
                least, most = min(least, cu + a), max(most, cu + b)
            elif axis == v:
                least, most = min(least, cv + c), max(most, cv + d)
            if axis == 2 and len(added) > 0:
                least, most = least + added[row, 0], most + added[row, 1]
            if least < low[slot, axis]:
                low[slot, axis] = least
                low_row[slot, axis] = row
            if most > high[slot, axis]:
                high[slot, axis] = most
                high_row[slot, axis] = row
            if known[f, axis] == 1:
                if least < lower[off, axis]:
                    if bad < len(bad_row):
                        bad_row[bad] = row
                        bad_axis[bad] = axis
                        bad_reach[bad] = least
                    bad += 1
                if most > upper[off, axis]:
                    if bad < len(bad_row):
                        bad_row[bad] = row
                        bad_axis[bad] = axis
                        bad_reach[bad] = most
                    bad += 1
        for axis in range(6):
            position[axis] = to[row, axis]
    return bad


ROUNDED = 0.005
"""mm: ends of an arc so near to each other may be one point, rounded differently."""
MEANT_CLOSED = 1e-4
"""mm: below every usual rounding; ends so near to each other were surely meant to be one point."""
HUGE = 1e6
"""mm: no machine tells an arc of such a radius from a line."""
MISMATCH, CLOSES, IS_HUGE = 0, 1, 2
"""What ``odd_arcs`` finds."""


@kernel(seconds_per_unit=1e-6, compile_seconds=0.25)
def odd_arcs(
    op: Any,
    to: Any,
    center: Any,
    turns: Any,
    plane: Any,
    state: Any,
    tolerance: Any,
    made: Any,
    position: Any,
    counts: Any,
    rows: Any,
    start: Any,
    end: Any,
    chord: Any,
) -> None:
    """Arcs to tell of, by kind.

    MISMATCH: start and end radius differ by more than ``tolerance[state]`` mm; CLOSES: an arc of one turn at most whose
    ends are not one point and nearer than rounding, in states with ``made`` 1 (the controller makes arcs) the long
    way round only; IS_HUGE: its radius. position: (6,) before the first row, updated;
    counts: (3,) how many of each kind, which may exceed the width of the other outputs; rows, start, end, chord: (3, n)
    rows, both radii and the distance of the ends, mm.
    """
    for row in range(len(op)):
        if op[row] == 3:
            p = plane[row]
            u = 0 if p == 1 else (2 if p == 2 else 1)
            v = 1 if p == 1 else (0 if p == 2 else 2)
            u0, v0 = position[u] - center[row, u], position[v] - center[row, v]
            u1, v1 = to[row, u] - center[row, u], to[row, v] - center[row, v]
            r0, r1 = math.sqrt(u0 * u0 + v0 * v0), math.sqrt(u1 * u1 + v1 * v1)
            apart = math.sqrt((u1 - u0) * (u1 - u0) + (v1 - v0) * (v1 - v0))
            for kind in range(3):
                if kind == 0:
                    odd = abs(r0 - r1) > tolerance[state[row]]
                elif kind == 1:
                    # The long way round where rounding may be why, and the short one where nobody means so little.
                    onward = (u0 * v1 - v0 * u1) * turns[row]
                    odd = (
                        0.0 < apart <= ROUNDED
                        and abs(turns[row]) == 1
                        and r0 > ROUNDED
                        and (onward < 0.0 or (apart <= MEANT_CLOSED and made[state[row]] == 0))
                    )
                else:
                    odd = r0 >= HUGE
                if odd:
                    found = counts[kind]
                    if found < len(rows[kind]):
                        rows[kind][found] = row
                        start[kind][found] = r0
                        end[kind][found] = r1
                        chord[kind][found] = apart
                    counts[kind] = found + 1
        if op[row] < 10:
            for axis in range(6):
                position[axis] = to[row, axis]


@kernel(seconds_per_unit=3e-6, compile_seconds=0.3)
def rows_near(
    op: Any,
    to: Any,
    center: Any,
    turns: Any,
    plane: Any,
    position: Any,
    box_low: Any,
    box_high: Any,
    rows: Any,
) -> int:
    """Moving rows whose X Y Z extent meets a box: their numbers into ``rows`` (as long as ``op``); returns how many."""
    found = 0
    least = [0.0, 0.0, 0.0]
    most = [0.0, 0.0, 0.0]
    for row in range(len(op)):
        if op[row] >= 10:
            continue
        for axis in range(3):
            least[axis] = min(position[axis], to[row, axis])
            most[axis] = max(position[axis], to[row, axis])
        if op[row] == 3:
            p = plane[row]
            u = 0 if p == 1 else (2 if p == 2 else 1)
            v = 1 if p == 1 else (0 if p == 2 else 2)
            cu, cv = center[row, u], center[row, v]
            a, b, c, d, _ = arc_extreme(
                position[u] - cu, position[v] - cv, to[row, u] - cu, to[row, v] - cv, turns[row]
            )
            least[u], most[u] = min(least[u], cu + a), max(most[u], cu + b)
            least[v], most[v] = min(least[v], cv + c), max(most[v], cv + d)
        meets = True
        for axis in range(3):
            if most[axis] <= box_low[axis] or least[axis] >= box_high[axis]:
                meets = False
        if meets:
            rows[found] = row
            found += 1
        for axis in range(6):
            position[axis] = to[row, axis]
    return found
