"""Cutter radius compensation row by row: the geometry of lines and arcs, and the hot loop over programmed rows.

``offset_rows`` takes rows as the program requires them (what ``run_lines`` makes of plain lines) and gives those of the
tool, up to a row that is not simply part of a contour: a traverse, a rotary axis, anything the manual calls an error.
That line is the Python path's (``passes/interpret/eding/compensation_codes.py``), which uses the same geometry. Eding
CNC manual 5.4.

Points are (u, v) in a right-handed pair of the plane, mm; side, sense: see
``passes/interpret/core/cutter_compensation.py``.
"""

from __future__ import annotations

import math
from typing import Any

from gproof.ir.kernel import kernel
from gproof.passes.interpret.core.line_decoder_kernels import TraceRows

CORNER = 0.01
"""Radians: up to here a corner counts as none, convex or concave. That of RS274/NGC; the manual gives no number."""

HAIR = 1e-9
"""mm below which two points are one."""

TWO_PI = 2.0 * math.pi

REST, SMOOTH, CONVEX, CONCAVE, TOO_SMALL = range(5)
"""What a move is after the one before it: no way at all; straight on; around a corner; errors of 5.4."""

# Layout of the integers of ``offset_rows``: axes of the pair, side, and columns that are the same in every row
FIRST, SECOND, SIDE, PLANE, FRAME, STATE, FILE, CALL = range(8)
# Layout of its floats: position of the axes, programmed point, shift, radius, tolerance of arcs
PLACE, GOAL, SHIFT, RADIUS, TOLERANCE = 0, 6, 8, 10, 11
FLOATS = 12


@kernel()
def distance(u0: float, v0: float, u1: float, v1: float) -> float:
    """mm between two points."""
    return math.sqrt((u1 - u0) * (u1 - u0) + (v1 - v0) * (v1 - v0))


@kernel()
def radial(u: float, v: float, cu: float, cv: float, sign: float) -> tuple[float, float]:
    """Unit vector from a centre to a point, times a sign; along u where they are one."""
    away = distance(cu, cv, u, v)
    if away == 0.0:
        return sign, 0.0
    return sign * (u - cu) / away, sign * (v - cv) / away


@kernel()
def corner_angle(tu: float, tv: float, su: float, sv: float, nu: float, nv: float, side: int) -> float:
    """By how much the contour turns away from the tool at a corner, radians from -pi/2 to 3 pi/2.

    t: the tool touches the end of the move before; s: the corner; n: unit vector to the tool at the start of the next.
    Above pi the corner is concave by more than a quarter turn.
    """
    u, v = tu - su, tv - sv
    angle = side * math.atan2(nu * v - nv * u, nu * u + nv * v)
    return angle + TWO_PI if angle < -math.pi / 2.0 else angle


@kernel()
def swept(u0: float, v0: float, u1: float, v1: float, cu: float, cv: float, sense: int) -> float:
    """The angle of an arc as rows of a trace mean it: above 0, a full turn when the ends are one."""
    a, b = u0 - cu, v0 - cv
    c, d = u1 - cu, v1 - cv
    angle = math.atan2(a * d - b * c, a * c + b * d) * sense
    return angle + TWO_PI if angle <= 0.0 else angle


@kernel()
def line_start(
    tu: float, tv: float, su: float, sv: float, eu: float, ev: float, side: int
) -> tuple[int, float, float, float]:  # fmt: skip
    """(REST to CONCAVE, unit vector to the tool, angle of the corner) of a line from s to e, the tool touching s."""
    length = distance(su, sv, eu, ev)
    if length == 0.0:
        return REST, 0.0, 0.0, 0.0
    nu, nv = -side * (ev - sv) / length, side * (eu - su) / length
    angle = corner_angle(tu, tv, su, sv, nu, nv, side)
    if angle < -CORNER or angle > math.pi + CORNER:
        return CONCAVE, nu, nv, angle
    return (SMOOTH if angle <= CORNER else CONVEX), nu, nv, angle


@kernel()
def arc_start(
    tu: float, tv: float, su: float, sv: float, cu: float, cv: float, outward: float, side: int, radius: float,
    tolerance: float,
) -> tuple[int, float, float, float]:  # fmt: skip
    """(SMOOTH to CONCAVE, unit vector to the tool, angle of the corner) of an arc from s about c, the tool touching s.

    outward: 1 for a tool outside of the arc, -1 inside. A corner within ``CORNER`` that would throw the arc more
    than half its tolerance off its circle counts as one.
    """
    nu, nv = radial(su, sv, cu, cv, outward)
    angle = corner_angle(tu, tv, su, sv, nu, nv, side)
    if angle < -CORNER or angle > math.pi + CORNER:
        return CONCAVE, nu, nv, angle
    off = abs(distance(tu, tv, cu, cv) - distance(su + nu * radius, sv + nv * radius, cu, cv))
    if abs(angle) <= CORNER and off <= tolerance / 2.0:
        return SMOOTH, nu, nv, angle
    return (CONCAVE if angle < 0.0 else CONVEX), nu, nv, angle


@kernel()
def arc_turns(
    u0: float, v0: float, u1: float, v1: float, cu: float, cv: float, sense: int, sweep: float
) -> tuple[float, float, int]:  # fmt: skip
    """(its end, its signed turns) of the arc of about ``sweep`` radians; no turns: so short that its ends changed."""
    if sweep > math.pi and distance(u0, v0, u1, v1) < HAIR:
        u1, v1 = u0, v0
    turns = 1 + math.floor((sweep - swept(u0, v0, u1, v1, cu, cv, sense)) / TWO_PI + 0.5)
    return u1, v1, sense * turns if turns >= 1 else 0


@kernel(seconds_per_unit=4e-5, compile_seconds=6.0)
def offset_rows(
    count: int, programmed: TraceRows, ints: Any, floats: Any, made: TraceRows, row: int, capacity: int
) -> tuple[int, int]:  # fmt: skip
    """Rows of the tool from the first ``count`` programmed ones; returns (rows used up, next row).

    ints, floats: state (floats changed in place); made: written from ``row`` while two rows fit below ``capacity``.
    """
    op, to, center, turns = programmed.op, programmed.to, programmed.center, programmed.turns
    feed, line = programmed.feed, programmed.line
    out_op, out_file, out_line, out_call, out_to, out_frame, out_state = made[:7]
    out_feed, out_center, out_turns, out_plane, out_arg = made[7:]
    a, b, side, flat = ints[FIRST], ints[SECOND], ints[SIDE], ints[PLANE]
    across = 3 - a - b
    radius, tolerance = floats[RADIUS], floats[TOLERANCE]
    done = 0
    while done < count and row + 2 <= capacity:
        kind = op[done]
        if kind < 2 or kind > 3:
            return done, row
        if to[done, 3] != floats[3] or to[done, 4] != floats[4] or to[done, 5] != floats[5]:
            return done, row
        su, sv = floats[GOAL], floats[GOAL + 1]
        eu, ev = to[done, a], to[done, b]
        tu, tv = floats[PLACE + a] - floats[SHIFT], floats[PLACE + b] - floats[SHIFT + 1]
        # Where the arc around the corner ends; where the move ends, about which centre, in how many turns
        ku, kv = tu, tv
        cu = cv = 0.0
        turn = 0
        corner = False
        if kind == 2:
            begins, nu, nv, _ = line_start(tu, tv, su, sv, eu, ev, side)
            if begins == CONCAVE:
                return done, row
            zu, zv = tu, tv
            if begins != REST:
                zu, zv = eu + nu * radius, ev + nv * radius
        else:
            sense = turns[done]
            cu, cv = center[done, a], center[done, b]
            r0, r1 = distance(su, sv, cu, cv), distance(eu, ev, cu, cv)
            inward = side * sense > 0
            if abs(r0 - r1) > tolerance or (inward and min(r0, r1) <= radius + HAIR):
                return done, row
            outward = -1.0 if inward else 1.0
            begins, nu, nv, _ = arc_start(tu, tv, su, sv, cu, cv, outward, side, radius, tolerance)
            if begins == CONCAVE:
                return done, row
            mu, mv = radial(eu, ev, cu, cv, outward)
            bu, bv = su + nu * radius, sv + nv * radius
            zu, zv = eu + mu * radius, ev + mv * radius
            if su == eu and sv == ev:
                zu, zv = bu, bv
            sweep = swept(su, sv, eu, ev, cu, cv, sense)
            if begins == SMOOTH:
                sweep -= between(bu, bv, tu, tv, cu, cv) * sense
                bu, bv = tu, tv
            zu, zv, turn = arc_turns(bu, bv, zu, zv, cu, cv, sense, sweep)
        level = floats[PLACE + across]
        if begins == CONVEX:
            corner = True
            ku, kv = su + nu * radius, sv + nv * radius
            if not (ku == tu and kv == tv):
                floats[PLACE + a] = ku + floats[SHIFT]
                floats[PLACE + b] = kv + floats[SHIFT + 1]
            out_op[row] = 3
            for axis in range(6):
                out_to[row, axis] = floats[PLACE + axis]
            out_center[row, a] = su + floats[SHIFT]
            out_center[row, b] = sv + floats[SHIFT + 1]
            out_center[row, across] = level
            out_turns[row] = -side
            out_plane[row] = flat
            out_arg[row, 0] = su
            out_arg[row, 1] = sv
            row += 1
        if not (zu == ku and zv == kv):
            floats[PLACE + a] = zu + floats[SHIFT]
            floats[PLACE + b] = zv + floats[SHIFT + 1]
        floats[PLACE + across] = to[done, across]
        out_op[row] = 3 if turn != 0 else 2
        for axis in range(6):
            out_to[row, axis] = floats[PLACE + axis]
        out_center[row, 0] = out_center[row, 1] = out_center[row, 2] = 0.0
        if turn != 0:
            out_center[row, a] = cu + floats[SHIFT]
            out_center[row, b] = cv + floats[SHIFT + 1]
            out_center[row, across] = level
        out_turns[row] = turn
        out_plane[row] = flat if turn != 0 else 0
        out_arg[row, 0] = eu
        out_arg[row, 1] = ev
        row += 1
        for n in range(row - 2 if corner else row - 1, row):
            out_file[n] = ints[FILE]
            out_line[n] = line[done]
            out_call[n] = ints[CALL]
            out_frame[n] = ints[FRAME]
            out_state[n] = ints[STATE]
            out_feed[n] = feed[done]
        floats[GOAL], floats[GOAL + 1] = eu, ev
        done += 1
    return done, row


@kernel()
def between(u0: float, v0: float, u1: float, v1: float, cu: float, cv: float) -> float:
    """From one point to the other about a centre, radians, within half a turn either way."""
    a, b = u0 - cu, v0 - cv
    c, d = u1 - cu, v1 - cv
    return math.atan2(a * d - b * c, a * c + b * d)
