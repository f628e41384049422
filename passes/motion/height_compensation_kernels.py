"""Rows over a height map, cut into lines that stay close to what Z does there: see ``height_compensation.py``.

Along a row the machine's Z is that of the program plus the map's height. ``lift_rows`` walks each row from vertex to
vertex of a fine polygon on that curve (``FINE``, or ``ROUND`` / 4 more on arcs), and keeps as few of its vertices as
leave all others within ``BEND`` of the lines between those kept. Vertices lie on the curve, so nothing adds up.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from gproof.ir.kernel import kernel

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Bytes = npt.NDArray[np.uint8]

ARC, DWELL = 3, 10
"""Ops of ir/trace.py that the loop must know; lift.py asserts it."""

FINE, BEND, ROUND = 0.01, 0.0275, 0.05
"""Steps: of the fine polygon from the curve, of what is kept from the fine polygon, of arcs in X and Y from theirs.

Z: FINE + BEND + ROUND / 4 (of arcs in a plane with Z) = 0.05 at most; X and Y: ROUND at most.
"""

JUMP = 5e-7
"""Steps that Z may seem to jump where the map ends or is switched (rounding)."""

MARGIN = 1e-9
"""Of a cell: what is so close outside the measured range counts as on its edge."""

WIDEST = math.pi / 8.0
"""rad: a chord of an arc, at most."""

# Columns of ``grid``.
G_X, G_Y, G_SIZE, G_STEEP_X, G_STEEP_Y, G_TWIST = 0, 1, 2, 3, 4, 5
"""X and Y of the first point, size of a cell; over the whole map the greatest |dh/dx|, |dh/dy|, |d2h/dxdy|."""
GRID_WIDTH = 6

# Columns of ``shapes``.
ANGLE, SWEEP, RADIUS, RADIUS_TO = 0, 1, 2, 3

# What ``lift_rows`` keeps from call to call.
K_ROW, K_USED, K_ON, K_ARC, K_JUMPED, K_FULL = 0, 1, 2, 3, 4, 5
"""Next row, lines made so far, 1: the map is on, arcs met so far; 1: stopped at a jump; 1: stopped for want of room."""
KEPT_WIDTH = 6

NEVER = 2.0
"""A share of a row that is beyond its end."""


@kernel(seconds_per_unit=1e-6)
def height(u: float, v: float, heights: Floats) -> float:
    """Bilinear at (u, v) cells from the first point, as on the edge for points outside; exact in a flat cell."""
    ny, nx = int(heights.shape[0]), int(heights.shape[1])
    u = min(max(u, 0.0), float(nx - 1))
    v = min(max(v, 0.0), float(ny - 1))
    i = min(int(u), nx - 2)
    j = min(int(v), ny - 2)
    s = u - i
    t = v - j
    h = float(heights[j, i])
    along = float(heights[j, i + 1]) - h
    return h + s * along + t * ((float(heights[j + 1, i]) - h) + s * (
        (float(heights[j + 1, i + 1]) - float(heights[j + 1, i])) - along
    ))  # fmt: skip


@kernel(seconds_per_unit=1e-6)
def cell(u: float, v: float, heights: Floats) -> int:
    """Number of the cell at (u, v), -1 outside the measured range."""
    ny, nx = int(heights.shape[0]), int(heights.shape[1])
    if not (-MARGIN <= u <= nx - 1 + MARGIN and -MARGIN <= v <= ny - 1 + MARGIN):
        return -1
    return min(max(int(v), 0), ny - 2) * nx + min(max(int(u), 0), nx - 2)


@kernel(seconds_per_unit=1e-6)
def lift_at(x: float, y: float, grid: Floats, heights: Floats) -> float:
    """What is added to Z at a machine position."""
    u = (x - float(grid[G_X])) / float(grid[G_SIZE])
    v = (y - float(grid[G_Y])) / float(grid[G_SIZE])
    if cell(u, v, heights) < 0:
        return 0.0
    return height(u, v, heights)


@kernel(seconds_per_unit=1e-6)
def stretch(u: float, du: float, last: int) -> tuple[float, float]:
    """Shares of a line, from u by du cells, between which it is in the range 0..last; (NEVER, -NEVER) for none."""
    low, high = -MARGIN, last + MARGIN
    if du == 0.0:
        return (-NEVER, NEVER) if low <= u <= high else (NEVER, -NEVER)
    enter, leave = (low - u) / du, (high - u) / du
    return (enter, leave) if du > 0.0 else (leave, enter)


@kernel(seconds_per_unit=1e-6)
def place_at(share: float, arc: bool, first: int, begin: Floats, end: Floats, center: Floats, shape: Floats,
             now: Floats) -> None:  # fmt: skip
    """The programmed point at a share of a row, into ``now``; first: of the arc's pair of axes."""
    for axis in range(6):
        now[axis] = begin[axis] + (end[axis] - begin[axis]) * share
    if arc:
        second = (first + 1) % 3
        angle = float(shape[ANGLE]) + float(shape[SWEEP]) * share
        radius = float(shape[RADIUS]) + (float(shape[RADIUS_TO]) - float(shape[RADIUS])) * share
        now[first] = center[first] + radius * math.cos(angle)
        now[second] = center[second] + radius * math.sin(angle)


# What ``keep_vertex`` knows of the line being made: its first vertex, the last one passed, slopes that are allowed.
V_SHARE, V_Z, V_LAST_SHARE, V_LAST_Z, V_LOW, V_HIGH = 0, 1, 2, 3, 4, 5
VERTEX_WIDTH = 6


@kernel(seconds_per_unit=1e-6)
def begin_line(share: float, z: float, line: Floats) -> None:
    """A line starts at a vertex."""
    line[V_SHARE] = line[V_LAST_SHARE] = share
    line[V_Z] = line[V_LAST_Z] = z
    line[V_LOW] = -math.inf
    line[V_HIGH] = math.inf


@kernel(seconds_per_unit=1e-6)
def keep_vertex(share: float, z: float, bend: float, widest: float, line: Floats) -> float:
    """Pass the next vertex; the share at which the line before it ends there, or -1 while it goes on.

    A line goes on while it passes all its vertices within ``bend`` and is not wider than ``widest``.
    """
    ended = -1.0
    wide = share - float(line[V_SHARE])
    if wide <= 0.0:
        return ended
    slope = (z - float(line[V_Z])) / wide
    if line[V_LAST_SHARE] > line[V_SHARE] and (wide > widest or not line[V_LOW] <= slope <= line[V_HIGH]):
        ended = float(line[V_LAST_SHARE])
        begin_line(ended, float(line[V_LAST_Z]), line)
        wide = share - ended
        if wide <= 0.0:
            return ended
    line[V_LOW] = max(float(line[V_LOW]), (z - bend - float(line[V_Z])) / wide)
    line[V_HIGH] = min(float(line[V_HIGH]), (z + bend - float(line[V_Z])) / wide)
    line[V_LAST_SHARE] = share
    line[V_LAST_Z] = z
    return ended


@kernel(seconds_per_unit=2.5e-5, compile_seconds=8.0)
def lift_rows(
    op: Any, to: Floats, center: Floats, plane: Any, on: Bytes, shapes: Floats, grid: Floats, heights: Floats,
    scale: Floats, place: Floats, kept: Ints, jump: Floats, out_to: Floats, out_row: Ints, out_chord: Bytes,
) -> None:  # fmt: skip
    """Rows from kept[K_ROW] on into lines, until they end, a row does not fit any more or Z would jump.

    on: by row, 1 where the map is on; shapes: of each arc row, see ``plan_kernels.arc_shapes``; scale: (3,) most steps
    per mm of X, Y, Z; place: (3, 6) the programmed position before the row, scratch; jump: (1,) mm that Z would jump
    at row kept[K_ROW]. out_to: (n, 6) ends; out_row: their rows; out_chord: 1 for a chord of an arc.
    """
    ny, nx = heights.shape
    steps_z = float(scale[2])
    bend = BEND / steps_z if steps_z > 0.0 else math.inf
    size = float(grid[G_SIZE])
    line = np.empty(VERTEX_WIDTH)
    place_before, now = place[0], place[1]
    no_shape = np.zeros(4)
    while kept[K_ROW] < len(op):
        row = int(kept[K_ROW])
        used = int(kept[K_USED])
        kind = int(op[row])
        arc = kind == ARC
        if used >= len(out_row):
            kept[K_FULL] = 1
            return
        here = lift_at(float(place_before[0]), float(place_before[1]), grid, heights)
        if int(on[row]) != int(kept[K_ON]):
            if abs(here) * steps_z > JUMP:
                kept[K_JUMPED] = 1
                jump[0] = here
                return
            kept[K_ON] = on[row]
        end = to[row]
        lifted = on[row] == 1
        there = lift_at(float(end[0]), float(end[1]), grid, heights) if lifted else 0.0
        if not lifted:
            here = 0.0
        first = 0
        if arc:
            first = 2 if plane[row] == 2 else (1 if plane[row] == 3 else 0)
        whole = not lifted or kind >= DWELL or (not arc and end[0] == place_before[0] and end[1] == place_before[1])
        shape = shapes[int(kept[K_ARC])] if arc else no_shape
        if arc and not whole:
            # The arc stays one where the map is flat all around it.
            wide_x = wide_y = max(float(shape[RADIUS]), float(shape[RADIUS_TO]))
            mid_x, mid_y = float(center[row, 0]), float(center[row, 1])
            if first == 2:
                mid_y, wide_y = 0.5 * (end[1] + place_before[1]), 0.5 * abs(end[1] - place_before[1])
            elif first == 1:
                mid_x, wide_x = 0.5 * (end[0] + place_before[0]), 0.5 * abs(end[0] - place_before[0])
            west = (mid_x - wide_x - float(grid[G_X])) / size - 1e-6
            east = (mid_x + wide_x - float(grid[G_X])) / size + 1e-6
            south = (mid_y - wide_y - float(grid[G_Y])) / size - 1e-6
            north = (mid_y + wide_y - float(grid[G_Y])) / size + 1e-6
            whole = east < 0.0 or north < 0.0 or west > nx - 1 or south > ny - 1
            if not whole and west >= 0.0 and south >= 0.0 and east <= nx - 1 and north <= ny - 1:
                i0, i1 = int(west), min(int(east) + 1, nx - 1)
                j0, j1 = int(south), min(int(north) + 1, ny - 1)
                level = heights[j0, i0]
                whole = True
                for j in range(j0, j1 + 1):
                    for i in range(i0, i1 + 1):
                        if heights[j, i] != level:
                            whole = False
                    if not whole:
                        break
        if not whole:
            z0, z1 = float(place_before[2]), float(end[2])
            begin_line(0.0, z0 + here, line)
            u0 = (float(place_before[0]) - float(grid[G_X])) / size
            v0 = (float(place_before[1]) - float(grid[G_Y])) / size
            if not arc:
                du = (float(end[0]) - float(place_before[0])) / size
                dv = (float(end[1]) - float(place_before[1])) / size
                enter, leave = stretch(u0, du, nx - 1)
                enter_v, leave_v = stretch(v0, dv, ny - 1)
                enter, leave = max(enter, enter_v), min(leave, leave_v)
                if enter > leave or enter > 1.0 or leave < 0.0:
                    enter = leave = NEVER
                if 0.0 < enter <= 1.0:
                    step = height(u0 + du * enter, v0 + dv * enter, heights)
                    if abs(step) * steps_z > JUMP:
                        kept[K_JUMPED] = 1
                        jump[0] = step
                        return
                if 0.0 <= leave < 1.0:
                    step = height(u0 + du * leave, v0 + dv * leave, heights)
                    if abs(step) * steps_z > JUMP:
                        kept[K_JUMPED] = 1
                        jump[0] = -step
                        return
                t = 0.0
                at = max(enter, 0.0)
                kx = max(1, math.floor(u0 + du * at)) if du > 0.0 else min(nx - 2, math.ceil(u0 + du * at))
                ky = max(1, math.floor(v0 + dv * at)) if dv > 0.0 else min(ny - 2, math.ceil(v0 + dv * at))
                while t < 1.0:
                    pieces = 1
                    inside = enter <= t < leave
                    if t < enter:
                        ahead = min(enter, 1.0)
                    elif not inside:
                        ahead = 1.0
                    else:
                        ahead = min(leave, 1.0)
                        if du != 0.0:
                            while 1 <= kx <= nx - 2 and (kx - u0) / du <= t:
                                kx += 1 if du > 0.0 else -1
                            if 1 <= kx <= nx - 2:
                                ahead = min(ahead, (kx - u0) / du)
                        if dv != 0.0:
                            while 1 <= ky <= ny - 2 and (ky - v0) / dv <= t:
                                ky += 1 if dv > 0.0 else -1
                            if 1 <= ky <= ny - 2:
                                ahead = min(ahead, (ky - v0) / dv)
                        # In a cell Z is a parabola: a chord of it over d is within |q| d2 / 4.
                        half = 0.5 * (t + ahead)
                        i = min(max(int(u0 + du * half), 0), nx - 2)
                        j = min(max(int(v0 + dv * half), 0), ny - 2)
                        twist = (heights[j + 1, i + 1] - heights[j + 1, i]) - (heights[j, i + 1] - heights[j, i])
                        wide = ahead - t
                        pieces = max(
                            1, math.ceil(math.sqrt(abs(twist * du * dv) * wide * wide * steps_z / (4.0 * FINE)))
                        )
                    for k in range(1, pieces + 1):
                        share = ahead if k == pieces else t + (ahead - t) * k / pieces
                        z = z0 + (z1 - z0) * share
                        if inside or share == enter:
                            z += height(u0 + du * share, v0 + dv * share, heights)
                        ended = keep_vertex(share, z, bend, NEVER, line)
                        if ended >= 0.0:
                            if used >= len(out_row):
                                kept[K_FULL] = 1
                                return
                            place_at(ended, False, 0, place_before, end, center[row], no_shape, now)
                            for axis in range(6):
                                out_to[used, axis] = now[axis]
                            out_to[used, 2] = line[V_Z]
                            out_row[used] = row
                            out_chord[used] = 0
                            used += 1
                    t = ahead
            else:
                second = (first + 1) % 3
                sweep = abs(float(shape[SWEEP]))
                radius = max(float(shape[RADIUS]), float(shape[RADIUS_TO]))
                slip = abs(float(shape[RADIUS_TO]) - float(shape[RADIUS])) / sweep
                fast_x = fast_y = radius + slip
                curve_x = curve_y = radius + 2.0 * slip
                if first == 2:
                    fast_y, curve_y = abs(float(end[1]) - float(place_before[1])) / sweep, 0.0
                elif first == 1:
                    fast_x, curve_x = abs(float(end[0]) - float(place_before[0])) / sweep, 0.0
                # A chord of a curve over the angle d is within |second derivative| d2 / 8.
                round_ = (radius + 2.0 * slip) * max(float(scale[first]), float(scale[second]))
                widest = WIDEST
                if round_ * WIDEST * WIDEST > 8.0 * ROUND:
                    widest = math.sqrt(8.0 * ROUND / round_)
                steep_x, steep_y = float(grid[G_STEEP_X]), float(grid[G_STEEP_Y])
                # Three times: also for what a chord cuts off where the arc crosses a grid line twice.
                steep = 3.0 * steps_z * (
                    steep_x * curve_x + steep_y * curve_y + 2.0 * float(grid[G_TWIST]) * fast_x * fast_y
                )  # fmt: skip
                fine = 0.5 * widest
                if steep * fine * fine > 8.0 * FINE:
                    fine = math.sqrt(8.0 * FINE / steep)
                pieces = max(1, math.ceil(sweep / fine))
                # Across a grid line the slope changes by twice the steepest at most, the chord is off by a quarter.
                climb = (steep_x * fast_x + steep_y * fast_y) * sweep * steps_z
                short = 2.0 * FINE / climb if climb > 2.0 * FINE else 1.0
                widest = widest / sweep * (1.0 + 1e-9)
                t = 0.0
                number = cell(u0, v0, heights)
                for k in range(1, pieces + 1):
                    regular = k / pieces
                    while t < regular:
                        ahead = regular
                        while True:
                            if ahead == 1.0:
                                for axis in range(6):
                                    now[axis] = end[axis]
                            else:
                                place_at(ahead, True, first, place_before, end, center[row], shape, now)
                            u = (float(now[0]) - float(grid[G_X])) / size
                            v = (float(now[1]) - float(grid[G_Y])) / size
                            other = cell(u, v, heights)
                            if other == number:
                                break
                            least = 1e-13 if other < 0 or number < 0 else short
                            if ahead - t <= least:
                                break
                            ahead = 0.5 * (t + ahead)
                        if (other < 0) != (number < 0):
                            step = height(u, v, heights)
                            if abs(step) * steps_z > JUMP:
                                kept[K_JUMPED] = 1
                                jump[0] = step if number < 0 else -step
                                return
                        z = float(now[2])
                        if other >= 0:
                            z += height(u, v, heights)
                        ended = keep_vertex(ahead, z, bend, widest, line)
                        if ended >= 0.0:
                            if used >= len(out_row):
                                kept[K_FULL] = 1
                                return
                            place_at(ended, True, first, place_before, end, center[row], shape, now)
                            for axis in range(6):
                                out_to[used, axis] = now[axis]
                            out_to[used, 2] = line[V_Z]
                            out_row[used] = row
                            out_chord[used] = 1
                            used += 1
                        t = ahead
                        number = other
        if used >= len(out_row):
            kept[K_FULL] = 1
            return
        for axis in range(6):
            out_to[used, axis] = end[axis]
        out_to[used, 2] = end[2] + there
        out_row[used] = row
        out_chord[used] = 1 if arc and not whole else 0
        kept[K_USED] = used + 1
        kept[K_ROW] = row + 1
        if arc:
            kept[K_ARC] += 1
        for axis in range(6):
            place_before[axis] = end[axis]
