"""The path under a height map as the stream checker follows it, by its own arithmetic: the Trace's rows, raised.

What is added to Z at X, Y is bilinear between the map's points, less the height of the first point, and nothing outside
the measured range (Eding manual 2.2.5.5; docs/kinematics.md). A row over cells that are not level is cut where X or Y
turn round, where it crosses grid lines, into chords within ``CHORD`` steps of what each motor does, and where Z turns
round; so the chords turn as often as the path does. The checker follows them with ``SLACK`` more than its tolerance:
``ALLOWANCE`` is what the maker of a stream may be off the raised path, the rest is what the chords are.

Where Z would have to jump no stream can follow, and none is accepted. A stretch's time at full feed is that of the
shortest length that anything within the allowance can have (``_lengths``), so that no right stream is too fast.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from gproof.ir.drives import HeightMap
from gproof.ir.stream import Motor
from gproof.ir.trace import HEIGHT_MAP, Trace
from gproof.verify.kernel.path_kernels import ARC_OP, LAST_MOTION_OP
from gproof.verify.kernel.rows import FARTHEST
from gproof.verify.kernel.walk_state import Floats, Ints, Rows

Bools = npt.NDArray[np.bool_]

ALLOWANCE = 0.05
"""Steps that a stream's own path may be off the raised one, at equal share of a row."""

CHORD = 0.03
"""Steps that a chord of a raised row may be off it in any axis, at equal share."""

SLACK = ALLOWANCE + CHORD
"""Steps that the tolerance is wider on chords of a raised row."""

JUMP = 1e-6
"""Steps: what Z may seem to jump (rounding)."""

EDGE = 1e-9
"""Of a cell: what is so close outside the measured range counts as on its edge."""

WIDEST = math.pi / 8.0
"""rad: a chord of an arc, at most; also of a stream's own chords."""

MOST = 1 << 25
"""Chords of a section that the checker is ready to hold."""

HALVINGS = 60
PAIRS = {1: (0, 1), 2: (2, 0), 3: (1, 2)}


class Unfollowed(Exception):
    """A row's Z cannot be followed: row, kind and values."""

    def __init__(self, row: int, kind: str, *values: float) -> None:
        super().__init__(row, kind, *values)
        self.row, self.kind, self.values = row, kind, values


class Lifting:
    """A job's height map: where it is on, and the rows of a section with it."""

    def __init__(self, trace: Trace, height_map: HeightMap | None, motors: Sequence[Motor]) -> None:
        self._trace = trace
        self._on = np.array([HEIGHT_MAP in state.following for state in trace.states], dtype=bool)
        self._scale = np.zeros(3)
        for motor in motors:
            if motor.axis < 3:
                self._scale[motor.axis] = max(self._scale[motor.axis], abs(float(motor.steps_per_unit)))
        surface = None if height_map is None else Surface(height_map)
        self._surface = None if surface is None or surface.level() else surface
        self._before = self._on_before(height_map is not None and height_map.on)

    def _on_before(self, first: bool) -> list[bool | None]:
        """By section, whether the map is on where it starts; None where that depends on the way there."""
        ways: list[set[bool]] = [set() for _ in self._trace.sections]
        todo = [(0, first)] if ways else []
        while todo:
            number, on = todo.pop()
            if on in ways[number]:
                continue
            ways[number].add(on)
            section = self._trace.sections[number]
            after = bool(self._on[section.rows["state"][-1]]) if len(section.rows) else on
            todo.extend((edge.target, after) for edge in section.edges if edge.target >= 0)
        return [next(iter(way)) if len(way) == 1 else None if way else False for way in ways]

    def rise(self, number: int) -> float:
        """What is added to Z where a section starts."""
        if self._surface is None or not self._before[number]:
            return 0.0
        return float(self._surface.added(np.array([self._trace.sections[number].start]))[0])

    def section(self, number: int, rows: Rows) -> Lifted:
        """The section's rows, raised; Unfollowed where that cannot be."""
        section = self._trace.sections[number]
        on = self._on[section.rows["state"]] if len(section.rows) else np.zeros(0, dtype=bool)
        start = np.array(section.start, dtype=np.float64)
        if self._surface is None or (self._before[number] is False and not on.any()):
            whole = np.arange(len(on) + 1)
            return Lifted(rows, start, whole[:-1], whole)
        return lifted(rows, start, on, self._before[number], self._surface, self._scale)


class Lifted(NamedTuple):
    """rows: for the kernel; start: raised (6,); origin: row of the trace for each of them; first: index of the first of
    them for each row of the trace."""

    rows: Rows
    start: Floats
    origin: Ints
    first: Ints

    def row(self, at: int) -> int:
        """The trace's row for one of the rows that were walked."""
        return int(self.origin[min(at, len(self.origin) - 1)]) if at >= 0 and len(self.origin) else at


class Surface:
    """A height map as a function of X and Y."""

    def __init__(self, height_map: HeightMap) -> None:
        given = np.array(height_map.heights, dtype=np.float64)
        self.h: Floats = given - given[0, 0]
        self.corner = np.array([height_map.x, height_map.y])
        self.size = height_map.size
        self.last = np.array([given.shape[1] - 1, given.shape[0] - 1])

    def level(self) -> bool:
        """True when nothing is added anywhere."""
        return bool((self.h == 0.0).all())

    def cells(self, points: Floats) -> Floats:
        """(n, 2): X and Y in cells from the first point."""
        found: Floats = (points[:, :2] - self.corner) / self.size
        return found

    def inside(self, uv: Floats) -> Bools:
        """Which places are in the measured range."""
        return np.asarray(((uv >= -EDGE) & (uv <= self.last + EDGE)).all(axis=1))

    def cell(self, uv: Floats) -> Ints:
        """(n, 2) indices of the cells that places in the range belong to."""
        found: Ints = np.clip(np.floor(uv).astype(np.int64), 0, self.last - 1)
        return found

    def corners(self, ij: Ints) -> tuple[Floats, Floats, Floats, Floats]:
        """Of cells: the height of the first corner, what X adds, what Y adds, what both add beyond that."""
        i, j = ij[:, 0], ij[:, 1]
        base = self.h[j, i]
        along, up = self.h[j, i + 1] - base, self.h[j + 1, i] - base
        return base, along, up, (self.h[j + 1, i + 1] - self.h[j + 1, i]) - along

    def height(self, uv: Floats, ij: Ints) -> Floats:
        """The bilinear height of cells ``ij`` at places in them."""
        base, along, up, twist = self.corners(ij)
        s, t = np.clip(uv - ij, 0.0, 1.0).T
        found: Floats = base + s * along + t * (up + s * twist)
        return found

    def added(self, points: Floats) -> Floats:
        """(n,) what is added to Z at machine positions."""
        uv = self.cells(points)
        return np.where(self.inside(uv), self.height(np.clip(uv, 0, self.last), self.cell(uv)), 0.0)

    def steep(self, ij: Ints) -> tuple[Floats, Floats, Floats]:
        """Of cells: the greatest |dh/dx|, |dh/dy| and the |d2h/dxdy|, per mm."""
        _, along, up, twist = self.corners(ij)
        each = 1.0 / self.size
        x = np.maximum(np.abs(along), np.abs(along + twist)) * each
        y = np.maximum(np.abs(up), np.abs(up + twist)) * each
        return x, y, np.abs(twist) * each * each


class _Curves:
    """Rows as functions of a share 0..1; ``k`` is which of them, ``t`` the share."""

    def __init__(self, rows: Rows, before: Floats, at: Ints) -> None:
        self.at, self.begin, self.end = at, before[at], rows.to[at]
        self.arc: Bools = rows.op[at] == ARC_OP
        self.pair = np.array([PAIRS.get(int(plane), (0, 1)) for plane in rows.plane[at]], dtype=np.int64).reshape(-1, 2)
        n = np.arange(len(at))
        self.center = rows.center[at][n[:, np.newaxis], self.pair]
        first, last = (p[n[:, np.newaxis], self.pair] - self.center for p in (self.begin, self.end))
        self.r0, self.r1 = np.hypot(*first.T), np.hypot(*last.T)
        self.angle = np.arctan2(first[:, 1], first[:, 0])
        turns = rows.turns[at]
        sign = np.where(turns > 0, 1.0, -1.0)
        ahead = (np.arctan2(last[:, 1], last[:, 0]) - self.angle) * sign
        ahead = np.where(ahead <= 0.0, ahead + 2 * math.pi, ahead)
        ahead = np.where(ahead <= 0.0, ahead + 2 * math.pi, ahead)
        self.sweep = sign * (ahead + 2 * math.pi * (np.abs(turns) - 1))
        self.sweep[~self.arc] = 1.0

    def point(self, k: Ints, t: Floats) -> Floats:
        """(n, 6) without what the map adds."""
        found: Floats = self.begin[k] + (self.end[k] - self.begin[k]) * t[:, np.newaxis]
        a = np.flatnonzero(self.arc[k] & (t > 0.0) & (t < 1.0))
        r, way = self._polar(k[a], t[a])
        found[a, self.pair[k[a], 0]] = self.center[k[a], 0] + r * np.cos(way)
        found[a, self.pair[k[a], 1]] = self.center[k[a], 1] + r * np.sin(way)
        last = t >= 1.0
        found[last] = self.end[k[last]]
        return found

    def slope(self, k: Ints, t: Floats) -> Floats:
        """(n, 3) derivatives of X, Y, Z by the share."""
        found: Floats = (self.end[k] - self.begin[k])[:, :3]
        a = np.flatnonzero(self.arc[k])
        r, way = self._polar(k[a], t[a])
        wider, sweep = (self.r1 - self.r0)[k[a]], self.sweep[k[a]]
        found[a, self.pair[k[a], 0]] = wider * np.cos(way) - r * sweep * np.sin(way)
        found[a, self.pair[k[a], 1]] = wider * np.sin(way) + r * sweep * np.cos(way)
        return found

    def _polar(self, k: Ints, t: Floats) -> tuple[Floats, Floats]:
        return self.r0[k] + (self.r1[k] - self.r0[k]) * t, self.angle[k] + self.sweep[k] * t

    def most(self) -> tuple[Floats, Floats]:
        """(n, 3), (n, 3): bounds of first and second derivatives of X, Y, Z by the share, over whole rows."""
        first = np.abs(self.end - self.begin)[:, :3]
        second = np.zeros_like(first)
        a = np.flatnonzero(self.arc)
        wide, slip = np.maximum(self.r0, self.r1)[a], np.abs(self.r1 - self.r0)[a]
        sweep = np.abs(self.sweep[a])
        for which in (0, 1):
            first[a, self.pair[a, which]] = wide * sweep + slip
            second[a, self.pair[a, which]] = (wide * sweep + 2.0 * slip) * sweep
        return first, second

    def box(self) -> tuple[Floats, Floats]:
        """(n, 2), (n, 2): X and Y never leave this."""
        low, high = np.minimum(self.begin, self.end)[:, :2], np.maximum(self.begin, self.end)[:, :2]
        wide = np.maximum(self.r0, self.r1)
        for which in (0, 1):
            for axis in (0, 1):
                k = np.flatnonzero(self.arc & (self.pair[:, which] == axis))
                low[k, axis] = np.minimum(low[k, axis], self.center[k, which] - wide[k])
                high[k, axis] = np.maximum(high[k, axis], self.center[k, which] + wide[k])
        return low, high


def lifted(rows: Rows, start: Floats, on: Bools, on_before: bool | None, surface: Surface, scale: Floats) -> Lifted:
    """The rows with the map's height; Unfollowed where Z would jump or there is too much to hold.

    on: by row, the map is on; on_before: it is on at the section's start (None: that depends on the way there);
    scale: (3,) most steps per mm of X, Y and Z.
    """
    n = len(rows.op)
    before = np.vstack([start[np.newaxis, :], rows.to])[:n]
    moves = (before[:, :2] != rows.to[:, :2]).any(axis=1) | (rows.op == ARC_OP)
    candidate = np.flatnonzero(on & moves & (rows.op <= LAST_MOTION_OP))
    curves = _Curves(rows, before, candidate)
    low, high = curves.box()
    near = (surface.cells(high) >= -2 * EDGE).all(axis=1) & (surface.cells(low) <= surface.last + 2 * EDGE).all(axis=1)
    curves = _Curves(rows, before, candidate[near])
    cut = np.zeros(n, dtype=bool)
    cut[curves.at] = True

    # Rows that stay whole: raised alike at both ends.
    rise = np.where(on & ~cut, surface.added(rows.to), 0.0)
    rise[on & ~cut & moves] = 0.0
    pieces = _pieces(curves, surface, scale)
    count = np.ones(n, np.int64)
    count[curves.at] = np.bincount(pieces.k, minlength=len(curves.at))
    first = np.concatenate([np.zeros(1, np.int64), np.cumsum(count)])
    total = int(first[-1])
    origin = np.repeat(np.arange(n), count)
    place = np.arange(total)[cut[origin]]

    begin_rise, end_rise = rise[origin], rise[origin]
    begin_rise[place], end_rise[place] = pieces.begin_rise, pieces.end_rise
    start_rise = float(surface.added(start[np.newaxis, :])[0])
    if on_before is None and abs(start_rise) * scale[2] > JUMP:
        raise Unfollowed(-1, "raised.on-or-off")
    start_rise = start_rise if on_before else 0.0
    jumps = np.abs(begin_rise - np.concatenate([[start_rise], end_rise])[:total])
    if (jumps * scale[2] > JUMP).any():
        worst = int(np.argmax(jumps * scale[2] > JUMP))
        raise Unfollowed(int(origin[worst]), "raised.jump", float(jumps[worst]))

    to = rows.to[origin].copy()
    to[place] = pieces.end
    to[:, 2] += end_rise
    if (np.abs(to[:, 2]) * scale[2] > FARTHEST).any():
        worst = int(np.argmax(np.abs(to[:, 2]) * scale[2] > FARTHEST))
        raise Unfollowed(int(origin[worst]), "raised.far", FARTHEST)
    raised = start.copy()
    raised[2] += start_rise
    op, feed = rows.op[origin].copy(), rows.feed[origin].copy()
    whole_arc = (op == ARC_OP) & ~cut[origin]
    center = rows.center[origin].copy()
    center[whole_arc, 2] += end_rise[whole_arc]
    op[place] = np.where(op[place] == ARC_OP, 2, op[place])
    here = np.vstack([raised[np.newaxis, :], to])[:total]
    with np.errstate(divide="ignore", invalid="ignore"):
        length = np.sqrt(((to - here)[place, :3] ** 2).sum(axis=1))
        faster = length / (_lengths(curves, pieces, surface, scale)[pieces.k] * (pieces.t1 - pieces.t0))
    feed[place] *= np.where(faster >= 1.0, np.minimum(faster, 1e9), 1.0) * (1.0 + 1e-12)
    slack = np.zeros(total)
    slack[place] = SLACK
    guard = np.zeros(total + 1, np.uint8)
    guard[:total] = rows.guard[origin]
    made = Rows(
        op=op, to=to, center=center, turns=rows.turns[origin], plane=rows.plane[origin], feed=feed, guard=guard,
        slack=slack,
    )  # fmt: skip
    return Lifted(made, raised, origin, first)


class _Pieces(NamedTuple):
    """Chords in order. k: of which curve; t0, t1: shares; ij: cell, inside: False where nothing is added; end: (n, 6)
    without what the map adds; begin_rise, end_rise: what it adds."""

    k: Ints
    t0: Floats
    t1: Floats
    ij: Ints
    inside: Bools
    end: Floats
    begin_rise: Floats
    end_rise: Floats


def _pieces(curves: _Curves, surface: Surface, scale: Floats) -> _Pieces:
    every = np.arange(len(curves.at))
    k, t = np.concatenate([every, every]), np.concatenate([np.zeros(len(every)), np.ones(len(every))])
    k, t = _sorted(k, t, *_turning_shares(curves))
    # Now X and Y do not turn in a stretch, so that each crosses a grid line once at most.
    k, t = _sorted(k, t, *_crossing_shares(curves, surface, k, t))
    k, t0, t1 = _stretches(k, t)
    middle = surface.cells(curves.point(k, 0.5 * (t0 + t1)))
    inside, ij = surface.inside(middle), surface.cell(middle)
    _check_cells(curves, surface, k, t0, t1, ij, inside)
    count = _chord_counts(curves, surface, scale, k, t1 - t0, ij, inside)
    if count.sum() > MOST:
        raise Unfollowed(int(curves.at[0]), "raised.chords", MOST)
    k, t0, t1, ij, inside = _divided(count, k, t0, t1, ij, inside)
    # Where Z is nearly level, small hills are looked for once more.
    middle_slope = _rising(curves, surface, k, 0.5 * (t0 + t1), ij, inside)
    bound = _z_second(curves, surface, k, ij, inside) * (t1 - t0)
    k, t0, t1, ij, inside = _divided(
        np.where(curves.arc[k] & (np.abs(middle_slope) < bound), 16, 1), k, t0, t1, ij, inside
    )
    k, t0, t1, ij, inside = _without_hills(curves, surface, k, t0, t1, ij, inside)
    begin, end = curves.point(k, t0), curves.point(k, t1)
    begin_rise, end_rise = (np.where(inside, surface.height(surface.cells(points), ij), 0.0) for points in (begin, end))
    return _Pieces(k, t0, t1, ij, inside, end, begin_rise, end_rise)


def _sorted(k: Ints, t: Floats, more_k: Ints, more_t: Floats) -> tuple[Ints, Floats]:
    k, t = np.concatenate([k, more_k]), np.concatenate([t, more_t])
    order = np.lexsort((t, k))
    k, t = k[order], t[order]
    keep = np.ones(len(k), dtype=bool)
    keep[1:] = (k[1:] != k[:-1]) | (t[1:] > t[:-1])
    return k[keep], t[keep]


def _stretches(k: Ints, t: Floats) -> tuple[Ints, Floats, Floats]:
    """From the sorted shares of each curve to what is between them."""
    same = np.flatnonzero(k[1:] == k[:-1])
    return k[same], t[same], t[same + 1]


def _turning_shares(curves: _Curves) -> tuple[Ints, Floats]:
    """Where X or Y of an arc turn round: angles a with a - atan(r'/r) a multiple of pi for the cosine."""
    found_k, found_t = [np.zeros(0, np.int64)], [np.zeros(0)]
    arcs = np.flatnonzero(curves.arc)
    sweep, drift = curves.sweep[arcs], (curves.r1 - curves.r0)[arcs] / curves.sweep[arcs]
    for which, shift in ((0, 0.0), (1, 0.5 * math.pi)):
        # One more on either side: r'/r is small, but moves the place a little.
        low = np.ceil(np.minimum(curves.angle[arcs], curves.angle[arcs] + sweep) / math.pi - 1.0).astype(np.int64)
        high = np.floor(np.maximum(curves.angle[arcs], curves.angle[arcs] + sweep) / math.pi + 1.0).astype(np.int64)
        if (high - low).sum() > MOST:
            raise Unfollowed(int(curves.at[0]), "raised.chords", MOST)
        count = np.maximum(high - low + 1, 0)
        place = np.repeat(np.arange(len(arcs)), count)
        number = np.arange(len(place)) - np.repeat(np.cumsum(count) - count, count) + low[place]
        base = number * math.pi + shift
        angle = base.copy()
        for _ in range(20):
            r = curves.r0[arcs[place]] + drift[place] * (angle - curves.angle[arcs[place]])
            angle = base + np.arctan2(drift[place], r)
        share = (angle - curves.angle[arcs[place]]) / sweep[place]
        good = (share > 0.0) & (share < 1.0) & (curves.pair[arcs[place], which] < 2)
        found_k.append(arcs[place[good]])
        found_t.append(share[good])
    return np.concatenate(found_k), np.concatenate(found_t)


def _crossing_shares(curves: _Curves, surface: Surface, k: Ints, t: Floats) -> tuple[Ints, Floats]:
    """Where stretches on which X and Y do not turn cross grid lines, the edges of the range included."""
    sk, t0, t1 = _stretches(k, t)
    uv0, uv1 = surface.cells(curves.point(sk, t0)), surface.cells(curves.point(sk, t1))
    found_k, found_t = [np.zeros(0, np.int64)], [np.zeros(0)]
    for axis in (0, 1):
        least, most = np.minimum(uv0, uv1)[:, axis], np.maximum(uv0, uv1)[:, axis]
        low = np.clip(np.floor(least) + 1, 0, surface.last[axis] + 1).astype(np.int64)
        high = np.clip(np.ceil(most) - 1, -1, surface.last[axis]).astype(np.int64)
        count = np.maximum(high - low + 1, 0)
        if count.sum() > MOST:
            raise Unfollowed(int(curves.at[0]), "raised.chords", MOST)
        place = np.repeat(np.arange(len(sk)), count)
        line = (np.arange(len(place)) - np.repeat(np.cumsum(count) - count, count) + low[place]).astype(np.float64)
        u0, u1 = uv0[place, axis], uv1[place, axis]
        a, b = t0[place], t1[place]
        share = a + (b - a) * np.clip((line - u0) / (u1 - u0), 0.0, 1.0)
        bent = np.flatnonzero(curves.arc[sk[place]])
        if len(bent):
            share[bent] = _root(
                lambda x, j=bent, axis=axis, place=place, line=line: (
                    surface.cells(curves.point(sk[place[j]], x))[:, axis] - line[j]
                ),
                a[bent], b[bent], u0[bent] < u1[bent],
            )  # fmt: skip
        found_k.append(sk[place])
        found_t.append(share)
    return np.concatenate(found_k), np.concatenate(found_t)


def _root(function: object, low: Floats, high: Floats, rising: Bools) -> Floats:
    """Where functions change their sign between ``low`` and ``high``."""
    assert callable(function)
    low, high = low.copy(), high.copy()
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        below = (function(middle) < 0.0) == rising
        low, high = np.where(below, middle, low), np.where(below, high, middle)
    return 0.5 * (low + high)


def _check_cells(
    curves: _Curves, surface: Surface, k: Ints, t0: Floats, t1: Floats, ij: Ints, inside: Bools
) -> None:  # fmt: skip
    """Both ends of a stretch that was found to lie in a cell do lie in it; so does all between, which does not turn."""
    for t in (t0, t1):
        uv = surface.cells(curves.point(k, t))
        off = np.maximum(np.maximum(ij - uv, uv - ij - 1), 0.0).max(axis=1)
        out = inside & (off > 4 * EDGE)
        if out.any():
            raise Unfollowed(int(curves.at[k[int(np.argmax(out))]]), "raised.grid-lines")


def _z_second(curves: _Curves, surface: Surface, k: Ints, ij: Ints, inside: Bools) -> Floats:
    """A bound of Z's second derivative by the share, on stretches in one cell."""
    first, second = curves.most()
    x, y, twist = surface.steep(ij)
    added = x * second[k, 0] + y * second[k, 1] + 2.0 * twist * first[k, 0] * first[k, 1]
    found: Floats = second[k, 2] + np.where(inside, added, 0.0)
    return found


def _chord_counts(
    curves: _Curves, surface: Surface, scale: Floats, k: Ints, wide: Floats, ij: Ints, inside: Bools
) -> Ints:
    """Into how many chords a stretch goes, so that each is within CHORD of it in every axis."""
    _, second = curves.most()
    bend = np.maximum(second[k, 0] * scale[0], second[k, 1] * scale[1])
    bend = np.maximum(bend, _z_second(curves, surface, k, ij, inside) * scale[2])
    count = np.sqrt(bend * wide * wide / (8.0 * CHORD))
    turn = np.where(curves.arc[k], np.abs(curves.sweep[k]) * wide / WIDEST, 0.0)
    found: Ints = np.maximum(1, np.ceil(np.minimum(np.maximum(count, turn), float(MOST)))).astype(np.int64)
    return found


def _divided(
    count: Ints, k: Ints, t0: Floats, t1: Floats, ij: Ints, inside: Bools
) -> tuple[Ints, Floats, Floats, Ints, Bools]:
    """Each stretch in ``count`` equal parts."""
    place = np.repeat(np.arange(len(k)), count)
    part = np.arange(len(place)) - np.repeat(np.cumsum(count) - count, count)
    wide = (t1 - t0)[place] / count[place]
    begin = t0[place] + wide * part
    end = np.where(part + 1 == count[place], t1[place], t0[place] + wide * (part + 1))
    return k[place], begin, end, ij[place], inside[place]


def _rising(curves: _Curves, surface: Surface, k: Ints, t: Floats, ij: Ints, inside: Bools) -> Floats:
    """The derivative of Z by the share, the map's height with it."""
    slope = curves.slope(k, t)
    _, along, up, twist = surface.corners(ij)
    u, v = np.clip(surface.cells(curves.point(k, t)) - ij, 0.0, 1.0).T
    added = ((along + v * twist) * slope[:, 0] + (up + u * twist) * slope[:, 1]) / surface.size
    found: Floats = slope[:, 2] + np.where(inside, added, 0.0)
    return found


def _without_hills(
    curves: _Curves, surface: Surface, k: Ints, t0: Floats, t1: Floats, ij: Ints, inside: Bools
) -> tuple[Ints, Floats, Floats, Ints, Bools]:
    """Cut where Z turns round."""
    a, b = _rising(curves, surface, k, t0, ij, inside), _rising(curves, surface, k, t1, ij, inside)
    hill = np.flatnonzero(a * b < 0.0)
    if not len(hill):
        return k, t0, t1, ij, inside
    top = _root(
        lambda t: _rising(curves, surface, k[hill], t, ij[hill], inside[hill]), t0[hill], t1[hill], a[hill] < 0.0
    )
    count = np.ones(len(k), np.int64)
    good = (top > t0[hill]) & (top < t1[hill])
    count[hill[good]] = 2
    place = np.repeat(np.arange(len(k)), count)
    begin, end = t0[place], t1[place]
    second = np.flatnonzero(np.concatenate([[False], place[1:] == place[:-1]]))
    begin[second] = end[second - 1] = top[good]
    return k[place], begin, end, ij[place], inside[place]


def _lengths(curves: _Curves, pieces: _Pieces, surface: Surface, scale: Floats) -> Floats:
    """(curves,) mm that each row is long at least, whatever lines of up to ``ALLOWANCE`` follow it.

    X and Y go as far as the row says, arcs less what chords cut off; Z less than the row says by what the map adds.
    """
    first, _ = curves.most()
    x, y, _ = surface.steep(pieces.ij)
    slope = np.where(pieces.inside, x * first[pieces.k, 0] + y * first[pieces.k, 1], 0.0)
    climb = np.zeros(len(curves.at))
    np.maximum.at(climb, pieces.k, slope)
    delta = np.abs(curves.end - curves.begin)[:, :3]
    lines = np.hypot(np.hypot(delta[:, 0], delta[:, 1]), np.maximum(0.0, delta[:, 2] - climb))
    small = np.minimum(curves.r0, curves.r1)
    most = np.maximum(scale[curves.pair[:, 0]], scale[curves.pair[:, 1]])
    with np.errstate(divide="ignore"):
        wide = np.minimum(WIDEST * WIDEST, 8.0 * ALLOWANCE / (small * most))
    round_ = small * np.abs(curves.sweep) * (1.0 - wide / 24.0)
    third = np.take_along_axis(delta, (3 - curves.pair.sum(axis=1))[:, np.newaxis], axis=1)[:, 0]
    flat = curves.pair[:, 0] + curves.pair[:, 1] == 1
    arcs = np.where(
        flat, np.hypot(round_, np.maximum(0.0, third - climb)), np.hypot(np.maximum(0.0, round_ - climb), third)
    )
    found: Floats = np.where(curves.arc, arcs, lines)
    return found
