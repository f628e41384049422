"""The hot loop of the executor: successive plain lines of G0 to G3 in words, to trace rows.

``run_lines`` executes lines until one holds anything else (another code, a repeated word, a missing feed, an
axis whose frame changes ...) and hands that line back: the executor's Python path then does it, errors
included, and calls ``run_lines`` again. The Python path uses the same functions for motion, so that there is
one source. Order and rules: Eding CNC manual 3.4.1 to 3.4.3 and 3.7.
"""

from __future__ import annotations

import math
from typing import Any

from gproof.ir.kernel import kernel
from gproof.passes.interpret.core.line_decoder_kernels import (
    AXIS_WORDS,
    DWELL_WORDS,
    HAS_DISTANCE,
    MOVE_WORDS,
    TIME,
    F,
    I,
    J,
    K,
    LineState,
    R,
    TraceRows,
    WordColumns,
    read_line,
)

# Layout of the integer state
MOTION, PLANE, ABSOLUTE, FRAME, STATE, FILE, CALL, FEED_MODE, ENABLED, ARC_ABSOLUTE, ACTIVE_AXES, TURN_KIND = range(12)
# Whether G90, G91 and G4 are run here, and whether one of the first two was
DISTANCES = 12
INT_STATE = 13
NOT_HERE, HERE, MET = 0, 1, 2
# Layout of the float state: unit in mm, feed in mm/min, positions, offsets, mm in one unit of an X word, transform
UNIT, FEED, POSITION, OFFSET, X_UNIT, TURN = 0, 1, 2, 8, 14, 15
TURN_NUMBERS = 11
FLOAT_STATE = TURN + TURN_NUMBERS

# How program X and Y act on machine X and Y (passes/interpret/core/plane_transform.py): not at all beyond an offset;
# each on its own axis; each on the other's; both on both.
TURN_NONE, TURN_SEPARATE, TURN_SWAPPED, TURN_MIXED = range(4)

DWELL = 10
"""Op of ir/trace.py."""
RADIUS_OK, RADIUS_SAME_POINT, RADIUS_UNREACHABLE, RADIUS_ZERO = range(4)

SAME = 1e-6
"""mm: nearer than any drive can tell."""
ZERO_RADIUS = 1e-9


@kernel()
def distance(dx: float, dy: float) -> float:
    """mm between two places of a plane."""
    return math.sqrt(dx * dx + dy * dy)


@kernel()
def radius_center(x0: float, y0: float, x1: float, y1: float, radius: float, ccw: int) -> tuple[float, float, int]:
    """Center of an arc by its radius in a right-handed plane: (center x, center y, RADIUS_*).

    Positive radius: at most half a turn; negative: at least (manual 3.4.3.1). An end up to 1e-5 relative
    farther than the diameter counts as the half circle; the radius check then sees the difference.
    """
    dx, dy = x1 - x0, y1 - y0
    chord = math.sqrt(dx * dx + dy * dy)
    if radius == 0.0:
        return 0.0, 0.0, RADIUS_ZERO
    # The same distance that closes a full circle: what no drive can move.
    if abs(dx) < 1e-6 and abs(dy) < 1e-6:
        return 0.0, 0.0, RADIUS_SAME_POINT
    size = abs(radius)
    half = chord / 2.0
    if half > size:
        if half - size > 1e-5 * size:
            return 0.0, 0.0, RADIUS_UNREACHABLE
        size = half
    height = math.sqrt(size * size - half * half)
    # The center is left of the chord for a short counter-clockwise arc.
    side = 1.0 if (ccw == 1) == (radius > 0.0) else -1.0
    return x0 + dx / 2.0 - side * height * dy / chord, y0 + dy / 2.0 + side * height * dx / chord, RADIUS_OK


@kernel()
def step_xy(dx: float, dy: float, numbers: Any, at: int) -> tuple[float, float]:
    """A distance in program X and Y as one of the axes; numbers: a transform's, from ``at`` on."""
    return numbers[at + 2] * dx + numbers[at + 3] * dy, numbers[at + 4] * dx + numbers[at + 5] * dy


@kernel()
def program_xy(
    p0: float, p1: float, o0: float, o1: float, kind: int, numbers: Any, at: int
) -> tuple[float, float]:  # fmt: skip
    """Program X and Y of a place ``p`` under the offsets ``o``; numbers: a transform's, from ``at`` on."""
    d0, d1 = p0 - o0 - numbers[at], p1 - o1 - numbers[at + 1]
    if kind == TURN_SEPARATE:
        return numbers[at] + numbers[at + 6] * d0, numbers[at + 1] + numbers[at + 9] * d1
    if kind == TURN_SWAPPED:
        return numbers[at] + numbers[at + 7] * d1, numbers[at + 1] + numbers[at + 8] * d0
    return (
        numbers[at] + (numbers[at + 6] * d0 + numbers[at + 7] * d1),
        numbers[at + 1] + (numbers[at + 8] * d0 + numbers[at + 9] * d1),
    )


@kernel()
def place_xy(
    given: int, v0: float, v1: float, p0: float, p1: float, o0: float, o1: float, kind: int, numbers: Any, at: int
) -> tuple[float, float]:  # fmt: skip
    """Where the absolute X (bit 1 of ``given``) and Y (bit 2) words ``v`` send the axes from ``p``, offsets ``o``.

    A coordinate that is not given stays what it is in the program; an axis on which no given word acts stays.
    """
    c0, c1 = numbers[at], numbers[at + 1]
    if kind == TURN_SEPARATE:
        if given & 1:
            p0 = o0 + (c0 + numbers[at + 2] * (v0 - c0))
        if given & 2:
            p1 = o1 + (c1 + numbers[at + 5] * (v1 - c1))
        return p0, p1
    if kind == TURN_SWAPPED:
        x, y = p0, p1
        if given & 1:
            y = o1 + (c1 + numbers[at + 4] * (v0 - c0))
        if given & 2:
            x = o0 + (c0 + numbers[at + 3] * (v1 - c1))
        return x, y
    if given == 0:
        return p0, p1
    w0, w1 = v0, v1
    if given != 3:
        w0, w1 = program_xy(p0, p1, o0, o1, kind, numbers, at)
        if given & 1:
            w0 = v0
        else:
            w1 = v1
    d0, d1 = step_xy(w0 - c0, w1 - c1, numbers, at)
    return o0 + (c0 + d0), o1 + (c1 + d1)


@kernel(seconds_per_unit=3e-6, compile_seconds=1.5)
def run_lines(
    words: WordColumns, count: int, first_word: int, slots: Any, lines: LineState, rows: TraceRows, row: int,
    capacity: int,
) -> tuple[int, int]:  # fmt: skip
    """Execute lines from word ``first_word`` on; returns (next word, next row).

    words: ``count`` of them are run; slots: see ``read_line``; lines: state, changed in place; rows: written from
    ``row`` while below ``capacity``.
    """
    line, letter, value, flags = words
    ints, floats, form, offset_form, values = lines
    op, file, line_out, call, to, frame, state, feed, center, turns, plane, arg = rows
    word = first_word
    taken = MOVE_WORDS if ints[DISTANCES] == NOT_HERE else MOVE_WORDS | HAS_DISTANCE | DWELL_WORDS
    while word < count and row < capacity:
        here = line[word]
        end, seen, motion, mode, _, _ = read_line(
            line, letter, value, flags, count, word, slots, ints[MOTION], ints[ABSOLUTE], values
        )
        axes = seen & AXIS_WORDS
        if seen & ~taken or ints[ENABLED] == 0 or motion < 1 or motion > 4 or ints[FEED_MODE] != 94:
            return word, row
        if seen & DWELL_WORDS:
            # A dwell alone (3.4.4), of a time that is not negative: nothing of the state changes.
            if seen != DWELL_WORDS or values[TIME] < 0.0:
                return word, row
            op[row] = DWELL
            file[row] = ints[FILE]
            line_out[row] = here
            call[row] = ints[CALL]
            for axis in range(6):
                to[row, axis] = floats[POSITION + axis]
            frame[row] = ints[FRAME]
            state[row] = ints[STATE]
            arg[row, 0] = values[TIME]
            row += 1
            word = end
            continue
        if axes & ~ints[ACTIVE_AXES]:
            return word, row
        if axes & 56 and floats[UNIT] != 1.0:
            # Feed of a rotary move is in degrees: not scaled by the length unit.
            return word, row
        rate = floats[FEED]
        if seen & 1024:
            rate = values[F] * floats[UNIT]
            if not rate > 0.0:
                return word, row
        if axes == 0:
            # A feed word or a distance mode alone; anything else without axis words is for the Python path to judge.
            if seen & ~5120 != 0:
                return word, row
            floats[FEED] = rate
            if seen & 4096:
                ints[ABSOLUTE] = mode
                ints[DISTANCES] = 2
            word = end
            continue
        if motion != 1 and rate <= 0.0:
            # One that is not known (NaN) goes on.
            return word, row
        if motion <= 2 and seen & 960:
            return word, row
        unit = floats[UNIT]
        absolute = mode == 1
        if absolute:
            # An axis that now gets another frame needs a new frame index: Python path.
            changes = False
            for axis in range(6):
                if axes & (1 << axis) and form[axis] != offset_form[axis]:
                    changes = True
            if changes:
                return word, row
        turned = ints[TURN_KIND]
        crossed = form[0] != offset_form[0] or form[1] != offset_form[1]
        if turned != TURN_NONE and absolute and axes & 3 and crossed:
            return word, row
        p0 = floats[POSITION]
        p1 = floats[POSITION + 1]
        p2 = floats[POSITION + 2]
        p3 = floats[POSITION + 3]
        p4 = floats[POSITION + 4]
        p5 = floats[POSITION + 5]
        t0, t1, t2, t3, t4, t5 = p0, p1, p2, p3, p4, p5
        if axes & 1:
            t0 = values[0] * floats[X_UNIT] + (floats[OFFSET] if absolute else p0)
        if axes & 2:
            t1 = values[1] * unit + (floats[OFFSET + 1] if absolute else p1)
        if axes & 4:
            t2 = values[2] * unit + (floats[OFFSET + 2] if absolute else p2)
        if axes & 8:
            t3 = values[3] + (floats[OFFSET + 3] if absolute else p3)
        if axes & 16:
            t4 = values[4] + (floats[OFFSET + 4] if absolute else p4)
        if axes & 32:
            t5 = values[5] + (floats[OFFSET + 5] if absolute else p5)
        if turned != TURN_NONE and axes & 3:
            w0 = values[0] * floats[X_UNIT] if axes & 1 else 0.0
            w1 = values[1] * unit if axes & 2 else 0.0
            if absolute:
                t0, t1 = place_xy(
                    axes & 3, w0, w1, p0, p1, floats[OFFSET], floats[OFFSET + 1], turned, floats, TURN
                )  # fmt: skip
            else:
                w0, w1 = step_xy(w0, w1, floats, TURN)
                t0, t1 = p0 + w0, p1 + w1
        if axes & 56:
            # Rounding is no motion: a rotary move next to it keeps its feed in degrees.
            if abs(t0 - p0) < 1e-9:
                t0 = p0
            if abs(t1 - p1) < 1e-9:
                t1 = p1
            if abs(t2 - p2) < 1e-9:
                t2 = p2
        c0 = c1 = c2 = 0.0
        turn = 0
        flat = 0
        if motion >= 3:
            flat = ints[PLANE]
            sense = 1 if motion == 4 else 0
            if ints[ARC_ABSOLUTE] == 1:
                return word, row
            # Of other planes, and of factors that make ellipses, the Python path tells what is wrong.
            if turned != TURN_NONE and (flat != 1 or floats[TURN + 10] == 0.0):
                return word, row
            radius = values[R] * unit if turned == TURN_NONE else values[R] * unit * floats[TURN + 10]
            c0, c1, c2 = p0, p1, p2
            centered = seen & 448
            if seen & 512:
                if centered:
                    return word, row
                if flat == 1:
                    c0, c1, bad = radius_center(p0, p1, t0, t1, radius, sense)
                elif flat == 2:
                    c2, c0, bad = radius_center(p2, p0, t2, t0, radius, sense)
                else:
                    c1, c2, bad = radius_center(p1, p2, t1, t2, radius, sense)
                # Nearly half or full circles get a warning: Python path, as errors do.
                if bad != 0 or badly_conditioned(p0, p1, p2, t0, t1, t2, flat, radius) == 1:
                    return word, row
            elif flat == 1:
                if centered == 0 or centered & 256:
                    return word, row
                if seen & 64:
                    c0 = p0 + values[I] * unit
                if seen & 128:
                    c1 = p1 + values[J] * unit
                if turned != TURN_NONE:
                    w0 = values[I] * unit if seen & 64 else 0.0
                    w1 = values[J] * unit if seen & 128 else 0.0
                    w0, w1 = step_xy(w0, w1, floats, TURN)
                    c0, c1 = p0 + w0, p1 + w1
            elif flat == 2:
                if centered == 0 or centered & 128:
                    return word, row
                if seen & 64:
                    c0 = p0 + values[I] * unit
                if seen & 256:
                    c2 = p2 + values[K] * unit
            else:
                if centered == 0 or centered & 64:
                    return word, row
                if seen & 128:
                    c1 = p1 + values[J] * unit
                if seen & 256:
                    c2 = p2 + values[K] * unit
            needed = 3 if flat == 1 else (5 if flat == 2 else 6)
            if axes & needed == 0:
                return word, row
            # Arc geometry needs both ends in one frame.
            if absolute:
                for axis in range(3):
                    if needed & (1 << axis) and form[axis] != offset_form[axis]:
                        return word, row
            # An end on the start is a full circle (3.4.3.2); what is nearer than any drive can move is on it.
            if flat == 1 and abs(t0 - p0) < 1e-6 and abs(t1 - p1) < 1e-6:
                t0, t1 = p0, p1
            elif flat == 2 and abs(t0 - p0) < 1e-6 and abs(t2 - p2) < 1e-6:
                t0, t2 = p0, p2
            elif flat == 3 and abs(t1 - p1) < 1e-6 and abs(t2 - p2) < 1e-6:
                t1, t2 = p1, p2
            d0, d1, d2 = c0 - p0, c1 - p1, c2 - p2
            if d0 * d0 + d1 * d1 + d2 * d2 < 1e-18:
                return word, row
            turn = 1 if sense == 1 else -1
            op[row] = 3
        elif motion == 2:
            op[row] = 2
        else:
            op[row] = 1
        floats[FEED] = rate
        ints[MOTION] = motion
        if seen & 4096:
            ints[ABSOLUTE] = mode
            ints[DISTANCES] = 2
        floats[POSITION] = t0
        floats[POSITION + 1] = t1
        floats[POSITION + 2] = t2
        floats[POSITION + 3] = t3
        floats[POSITION + 4] = t4
        floats[POSITION + 5] = t5
        file[row] = ints[FILE]
        line_out[row] = here
        call[row] = ints[CALL]
        to[row, 0] = t0
        to[row, 1] = t1
        to[row, 2] = t2
        to[row, 3] = t3
        to[row, 4] = t4
        to[row, 5] = t5
        frame[row] = ints[FRAME]
        state[row] = ints[STATE]
        feed[row] = rate if motion != 1 else 0.0
        center[row, 0] = c0
        center[row, 1] = c1
        center[row, 2] = c2
        turns[row] = turn
        plane[row] = flat
        row += 1
        word = end
    return word, row


@kernel()
def badly_conditioned(
    x0: float, y0: float, z0: float, x1: float, y1: float, z1: float, plane: int, radius: float
) -> int:
    """1 for a radius arc within 15 degrees of a half circle or a full one (manual 3.4.3.1), else 0."""
    dx, dy, dz = x1 - x0, y1 - y0, z1 - z0
    if plane == 1:
        chord = math.sqrt(dx * dx + dy * dy)
    elif plane == 2:
        chord = math.sqrt(dx * dx + dz * dz)
    else:
        chord = math.sqrt(dy * dy + dz * dz)
    ratio = chord / (2.0 * abs(radius))
    # sin(82.5 degrees) and, for the long arc, sin(7.5 degrees)
    if ratio > 0.9914448613738104:
        return 1
    if radius < 0.0 and ratio < 0.13052619222005157:
        return 1
    return 0
