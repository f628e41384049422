"""Two paths side by side, move by move: does each run along the other, in the same order, at the same feed?

A path is a row of moves; where both paths have an event (``barriers``) both must have come to it. Moves need not be cut
at the same places: where one ends within the other, the rest of the other goes on. What is compared is always a part of
one move with a part of another that start and end at most a tolerance apart:

- two straight parts: then every point of one is within the tolerance of the point of the other at the same fraction,
  because both run linearly in all axes;
- two arcs in one plane, with the same sweep and centres within a tolerance: start, end and centre differ by no more
  than ``ARC`` tolerances, and the points at equal angles by no more than that. Where centres differ by more (large
  radii, short arcs), the distance is computed at many angles with a bound for what is between them (``arcs_apart``);
- an arc and a straight part, where chords are allowed: over the angle ``h`` of a part their distance is at most
  ``r (1 - cos(h / 2))`` in the plane, what the radius changes, and along the axis (the arc runs evenly with the angle,
  the chord with its length) at most ``h * h / 50`` of the part's rise.

A part that is shorter than the tolerance may be passed over, as long as both paths stay within it of each other.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from gproof.ir.kernel import kernel

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]


class Moves(NamedTuple):
    """The moves of a section, as columns.

    frame: number of the forms that both sides share, negative where a part is unknown; before: the same, of the place
    where the row starts; fact: number of the slow facts that both share; axes: how many may move.
    """

    op: Ints
    to: Floats
    frame: Ints
    before: Ints
    fact: Ints
    feed: Floats
    center: Floats
    turns: Ints
    plane: Ints
    axes: Ints


TRAVERSE, FEED, ARC_OP, PROBE = 1, 2, 3, 4
ARC = 4.0
SLIVER = 1e-9
QUARTER = math.pi / 2.0

# How ``align`` ends.
AGREES, KIND, PLACE, FORM, CENTER, SENSE, PLANE, FEEDS, FACT, MORE_IN_SOURCE, MORE_IN_TARGET, CHORD = range(12)

# Columns of ``notes``: how often, and source and target row of the first.
UNKNOWN_FEED, RAPID_PATH, UNKNOWN_PLACE, CHORDS = 0, 1, 2, 3
NOTES = 4

# What ``ints`` holds: rows that come next, the barrier ahead, whole matches in a row.
SOURCE, TARGET, BARRIER, CALM = 0, 1, 2, 3
STEPS = 1000  # parts that one call compares, at most

# What ``bounds`` holds.
MM, DEGREES, CHORD_MM, FEED_SHARE, STRAIGHT, CALM_ENOUGH, LEAST_RATE = 0, 1, 2, 3, 4, 5, 6
BOUNDS = 7

# What a piece holds: start and end of its row, how much of it is done, whether it may be cut; of an arc its numbers.
BEGIN, END, DONE, IS_ARC, CUTS, OPEN = 0, 6, 12, 13, 14, 23
FIRST, SECOND, R0, R1, ANGLE, SWEEP, C0, C1 = 15, 16, 17, 18, 19, 20, 21, 22
PIECE = 24


@kernel(seconds_per_unit=1e-5, borrows=True)
def open_piece(piece: Floats, row: int, moves: Moves, here: Floats) -> None:
    """Load a row into a piece; ``here``: where its path is."""
    for a in range(6):
        piece[BEGIN + a] = here[a]
        piece[END + a] = moves.to[row, a]
    piece[DONE] = 0.0
    piece[OPEN] = 1.0
    piece[CUTS] = 0.0
    if moves.before[row] == moves.frame[row] and moves.frame[row] >= 0 and moves.op[row] != PROBE:
        piece[CUTS] = 1.0
    piece[IS_ARC] = 0.0
    if moves.op[row] != ARC_OP:
        return
    first = 0
    second = 1
    if moves.plane[row] == 2:
        first = 2
        second = 0
    elif moves.plane[row] == 3:
        first = 1
        second = 2
    piece[IS_ARC] = 1.0
    piece[FIRST] = first
    piece[SECOND] = second
    piece[C0] = moves.center[row, first]
    piece[C1] = moves.center[row, second]
    x0 = here[first] - piece[C0]
    y0 = here[second] - piece[C1]
    x1 = moves.to[row, first] - piece[C0]
    y1 = moves.to[row, second] - piece[C1]
    piece[R0] = math.sqrt(x0 * x0 + y0 * y0)
    piece[R1] = math.sqrt(x1 * x1 + y1 * y1)
    piece[ANGLE] = math.atan2(y0, x0)
    sweep = math.atan2(y1, x1) - piece[ANGLE]
    full = 2.0 * math.pi
    if moves.turns[row] > 0:
        if sweep <= 0.0:
            sweep += full
        if sweep <= 0.0:
            sweep += full
        sweep += full * np.float64(moves.turns[row] - 1)
    else:
        if sweep >= 0.0:
            sweep -= full
        if sweep >= 0.0:
            sweep -= full
        sweep += full * np.float64(moves.turns[row] + 1)
    piece[SWEEP] = sweep


@kernel(seconds_per_unit=2e-6, borrows=True)
def coordinate(piece: Floats, u: float, a: int) -> float:
    """Axis ``a`` of a piece at the fraction ``u`` of its row."""
    if u >= 1.0:
        return np.float64(piece[END + a])
    if u <= 0.0:
        return np.float64(piece[BEGIN + a])
    if piece[IS_ARC] != 0.0:
        radius = piece[R0] + u * (piece[R1] - piece[R0])
        angle = piece[ANGLE] + u * piece[SWEEP]
        if a == int(piece[FIRST]):
            return np.float64(piece[C0] + radius * math.cos(angle))
        if a == int(piece[SECOND]):
            return np.float64(piece[C1] + radius * math.sin(angle))
    return np.float64(piece[BEGIN + a] + u * (piece[END + a] - piece[BEGIN + a]))


@kernel(seconds_per_unit=2e-5, borrows=True)
def apart(one: Floats, u: float, other: Floats, v: float, bounds: Floats) -> float:
    """The distance of two points in tolerances, the greatest of all axes."""
    most = 0.0
    for a in range(6):
        tolerance = bounds[MM] if a < 3 else bounds[DEGREES]
        most = max(most, abs(coordinate(one, u, a) - coordinate(other, v, a)) / tolerance)
    return most


@kernel(seconds_per_unit=2e-5, borrows=True)
def on_line(line: Floats, point: Floats, u: float, bounds: Floats) -> float:
    """The fraction, not below what is done, at which a straight piece comes by the point ``u`` of another; -1: it does
    not. The axis that moves most, in tolerances, says where."""
    axis = 0
    most = 0.0
    for a in range(6):
        tolerance = bounds[MM] if a < 3 else bounds[DEGREES]
        run = abs(line[END + a] - line[BEGIN + a]) / tolerance
        if run > most:
            most = run
            axis = a
    if most <= 0.0:
        return -1.0
    v = (coordinate(point, u, axis) - line[BEGIN + axis]) / (line[END + axis] - line[BEGIN + axis])
    v = min(max(v, np.float64(line[DONE])), 1.0)
    if apart(line, v, point, u, bounds) > 1.0:
        return -1.0
    return np.float64(v)


@kernel(seconds_per_unit=2e-5, borrows=True)
def on_arc(arc: Floats, point: Floats, u: float) -> float:
    """The fraction, beyond what is done, at which an arc next has the direction of the point ``u`` of another piece."""
    x = coordinate(point, u, int(arc[FIRST])) - arc[C0]
    y = coordinate(point, u, int(arc[SECOND])) - arc[C1]
    turn = math.atan2(y, x) - (arc[ANGLE] + arc[DONE] * arc[SWEEP])
    full = 2.0 * math.pi
    if arc[SWEEP] < 0.0:
        turn = -turn
    turn = turn - full * math.floor(turn / full)
    return min(1.0, np.float64(arc[DONE] + turn / abs(arc[SWEEP])))


@kernel(seconds_per_unit=2e-4, borrows=True)
def arcs_apart(one: Floats, u: float, other: Floats, v: float, bounds: Floats) -> float:
    """The greatest distance, in tolerances, of the parts of two arcs up to ``u`` and ``v`` at equal fractions.

    Between samples ``h`` apart (in fractions) a function is at most ``h * h / 8`` of its second derivative above them.
    That of the difference is at most ``sweep ** 2`` times (difference + centres apart), and what sweeps differ by.
    """
    from_one = one[DONE]
    from_other = other[DONE]
    sweep = abs((u - from_one) * one[SWEEP])
    rest = abs((v - from_other) * other[SWEEP])
    steps = 64 + int(16.0 * sweep)
    most = 0.0
    for n in range(steps + 1):
        f = np.float64(n) / np.float64(steps)
        most = max(most, apart(one, from_one + f * (u - from_one), other, from_other + f * (v - from_other), bounds))
    share = sweep * sweep / (8.0 * np.float64(steps) * np.float64(steps))
    away = max(abs(one[C0] - other[C0]), abs(one[C1] - other[C1])) / bounds[MM]
    radius = max(one[R0], one[R1], other[R0], other[R1]) / bounds[MM]
    uneven = 2.0 * (abs(one[R1] - one[R0]) + abs(other[R1] - other[R0])) / bounds[MM] / max(sweep, SLIVER)
    between = share * (away + uneven + radius * abs(sweep - rest) * (sweep + rest) / max(sweep * sweep, SLIVER))
    return np.float64((most + between) / (1.0 - min(0.5, share)))


@kernel(seconds_per_unit=2e-4, borrows=True)
def shape(one: Floats, u: float, other: Floats, v: float, bounds: Floats) -> int:
    """Whether parts of two pieces up to ``u`` and ``v`` are the same: AGREES or what is not; their ends are near."""
    if one[IS_ARC] == 0.0 and other[IS_ARC] == 0.0:
        return AGREES
    if one[IS_ARC] != 0.0 and other[IS_ARC] != 0.0:
        if one[FIRST] != other[FIRST]:
            return PLANE
        sweep = (u - one[DONE]) * one[SWEEP]
        rest = (v - other[DONE]) * other[SWEEP]
        radius = max(one[R0], one[R1])
        if abs(sweep - rest) > QUARTER and abs(sweep - rest) * radius > ARC * bounds[MM]:
            return SENSE
        away = max(abs(one[C0] - other[C0]), abs(one[C1] - other[C1]))
        if away <= bounds[MM] and abs(sweep - rest) * radius <= ARC * bounds[MM]:
            return AGREES
        if arcs_apart(one, u, other, v, bounds) > ARC:
            return CENTER
        return AGREES
    if bounds[CHORD_MM] <= 0.0:
        return KIND
    if one[IS_ARC] != 0.0:
        return chord(one, u, other, v, bounds)
    return chord(other, v, one, u, bounds)


@kernel(seconds_per_unit=5e-5, borrows=True)
def chord(arc: Floats, u: float, line: Floats, v: float, bounds: Floats) -> int:
    """Whether a straight part stays within the chord tolerance of a part of an arc."""
    part = u - arc[DONE]
    turn = abs(part * arc[SWEEP])
    if turn > QUARTER:
        return CHORD
    ends = 0.0
    rise = 0.0
    for a in range(6):
        unit = 1.0 if a < 3 else np.float64(bounds[MM] / bounds[DEGREES])
        start = abs(coordinate(arc, np.float64(arc[DONE]), a) - coordinate(line, np.float64(line[DONE]), a))
        stop = abs(coordinate(arc, u, a) - coordinate(line, v, a))
        ends = max(ends, unit * max(start, stop))
        if a != int(arc[FIRST]) and a != int(arc[SECOND]):
            rise = max(rise, unit * abs(part * (arc[END + a] - arc[BEGIN + a])))
    radius = max(arc[R0], arc[R1])
    aside = radius * (1.0 - math.cos(turn / 2.0)) + abs(part * (arc[R1] - arc[R0]))
    along = rise * turn * turn / 50.0
    if aside + along + ends > bounds[CHORD_MM] + bounds[MM]:
        return CHORD
    return AGREES


@kernel(seconds_per_unit=2e-5, borrows=True)
def bends(moves: Moves, row: int, bounds: Floats) -> bool:
    """Whether the path of a rapid move is open: it moves several axes, and rapids are not straight on both sides."""
    if moves.op[row] != TRAVERSE or bounds[STRAIGHT] != 0.0:
        return False
    return bool(moves.axes[row] > 1)


@kernel(seconds_per_unit=5e-6, borrows=True)
def note(notes: Ints, what: int, i: int, j: int) -> None:
    """Count what is open, and keep the first."""
    if notes[what, 0] == 0:
        notes[what, 1] = i
        notes[what, 2] = j
    notes[what, 0] += 1


@kernel(seconds_per_unit=2e-5, borrows=True)
def alike(source: Moves, i: int, target: Moves, j: int, bounds: Floats, notes: Ints) -> int:
    """What two moves are besides their path: feed and facts. The feed of a rapid is the fastest that its axes allow."""
    if source.fact[i] != target.fact[j]:
        return FACT
    if target.op[j] == TRAVERSE:
        return AGREES
    one = source.feed[i]
    other = target.feed[j]
    if math.isnan(one) or math.isnan(other):
        note(notes, UNKNOWN_FEED, i, j)
        return AGREES
    if source.op[i] == TRAVERSE:
        share = bounds[FEED_SHARE]
        if other > one * (1.0 + share) or other < bounds[LEAST_RATE] * (1.0 - share):
            return FEEDS
        return AGREES
    if abs(one - other) > bounds[FEED_SHARE] * max(one, other):
        return FEEDS
    return AGREES


@kernel(seconds_per_unit=1e-4, borrows=True)
def kinds(source: Moves, i: int, target: Moves, j: int, bounds: Floats) -> bool:
    """Whether both are rapids, feed moves or probe moves; an arc is a feed move where chords are allowed, and a rapid
    where the target may have a feed move for it."""
    one = source.op[i]
    other = target.op[j]
    if one == other:
        return True
    if one == TRAVERSE and other == FEED:
        return bool(bounds[LEAST_RATE] > 0.0)
    return bool(bounds[CHORD_MM] > 0.0 and one + other == FEED + ARC_OP and one != other)


@kernel(seconds_per_unit=5e-5, borrows=True)
def moved(here: Floats, piece: Floats, u: float) -> None:
    """The path is at the fraction ``u`` of a piece."""
    for a in range(6):
        here[a] = coordinate(piece, u, a)


@kernel(seconds_per_unit=2e-5, borrows=True)
def drifted(one: Floats, u: float, other: Floats, v: float, drift: Floats) -> None:
    """Keep the greatest distance of points that belong together: mm and degrees."""
    for a in range(6):
        away = abs(coordinate(one, u, a) - coordinate(other, v, a))
        k = 0 if a < 3 else 1
        drift[k] = max(drift[k], away)


@kernel(seconds_per_unit=2e-4, borrows=True)
def failure(source: Moves, i: int, target: Moves, j: int, pieces: Floats, bounds: Floats) -> int:
    """What is different between two rows that do not fit, the first of what a reader would look at."""
    if not kinds(source, i, target, j, bounds):
        return KIND
    if source.frame[i] != target.frame[j]:
        return FORM
    if apart(pieces[0], 1.0, pieces[1], 1.0, bounds) > 1.0:
        return PLACE
    found = shape(pieces[0], 1.0, pieces[1], 1.0, bounds)
    return found if found != AGREES else PLACE


@kernel(seconds_per_unit=2e-4, borrows=True)
def step(source: Moves, target: Moves, pieces: Floats, ints: Ints, bounds: Floats, notes: Ints, drift: Floats) -> int:
    """Compare what is left of two open pieces up to where the first of them ends; close those that end."""
    i = ints[SOURCE]
    j = ints[TARGET]
    one = pieces[0]
    other = pieces[1]
    u = 1.0
    v = 1.0
    same_kind = kinds(source, i, target, j, bounds)
    fits = same_kind and source.frame[i] == target.frame[j] and source.before[i] == target.before[j]
    fits = fits and apart(one, 1.0, other, 1.0, bounds) <= 1.0 and shape(one, 1.0, other, 1.0, bounds) == AGREES
    cuts = one[CUTS] != 0.0 and other[CUTS] != 0.0 and source.frame[i] == target.frame[j]
    # Only where rapids of the source are straight, a feed move may stand for one.
    bent = source.op[i] == target.op[j] and (bends(source, i, bounds) or bends(target, j, bounds))
    if not fits and cuts and same_kind and not bent:
        v = within(other, one, bounds)
        if v >= 0.0 and near(one, 1.0, other, v, bounds) and shape(one, 1.0, other, v, bounds) == AGREES:
            fits = True
        else:
            v = 1.0
            u = within(one, other, bounds)
            fits = u >= 0.0 and near(one, u, other, 1.0, bounds) and shape(one, u, other, 1.0, bounds) == AGREES
    found = AGREES
    if fits:
        if source.frame[i] < 0:
            note(notes, UNKNOWN_PLACE, i, j)
        if bent:
            note(notes, RAPID_PATH, i, j)
        if one[IS_ARC] != other[IS_ARC]:
            note(notes, CHORDS, i, j)
        found = alike(source, i, target, j, bounds, notes)
    if not fits or found != AGREES:
        # What is shorter than the tolerance may be passed over.
        if one[CUTS] != 0.0 and small(one, other, bounds):
            one[OPEN] = 0.0
            return AGREES
        if other[CUTS] != 0.0 and small(other, one, bounds):
            other[OPEN] = 0.0
            return AGREES
        return found if fits else failure(source, i, target, j, pieces, bounds)
    drifted(one, u, other, v, drift)
    if u >= 1.0 and v >= 1.0 and one[DONE] == 0.0 and other[DONE] == 0.0:
        ints[CALM] += 1
    else:
        ints[CALM] = 0
    one[DONE] = u
    other[DONE] = v
    if u >= 1.0:
        one[OPEN] = 0.0
    if v >= 1.0:
        other[OPEN] = 0.0
    return AGREES


@kernel(seconds_per_unit=2e-5, borrows=True)
def within(piece: Floats, ending: Floats, bounds: Floats) -> float:
    """The fraction of a piece at which it comes by the end of another one; -1: it does not."""
    if piece[IS_ARC] == 0.0:
        return on_line(piece, ending, 1.0, bounds)
    if ending[IS_ARC] != 0.0:
        v = piece[DONE] + abs((1.0 - ending[DONE]) * ending[SWEEP] / piece[SWEEP])
        return np.float64(v) if v < 1.0 else -1.0
    return on_arc(piece, ending, 1.0)


@kernel(seconds_per_unit=2e-5, borrows=True)
def near(one: Floats, u: float, other: Floats, v: float, bounds: Floats) -> bool:
    """Whether two points are so near that parts may be compared up to them; ends of chords: see ``chord``."""
    if one[IS_ARC] != other[IS_ARC]:
        return True
    return apart(one, u, other, v, bounds) <= 1.0


@kernel(seconds_per_unit=2e-5, borrows=True)
def long_arc(piece: Floats, bounds: Floats) -> bool:
    """Whether what is left of a piece is an arc longer than the tolerance; its ends may be near all the same."""
    if piece[IS_ARC] == 0.0:
        return False
    radius = max(piece[R0], piece[R1])
    return bool(radius * abs((1.0 - piece[DONE]) * piece[SWEEP]) > bounds[MM])


@kernel(seconds_per_unit=2e-5, borrows=True)
def small(piece: Floats, other: Floats, bounds: Floats) -> bool:
    """Whether what is left of a piece ends where the other path is, within the tolerance, and is shorter."""
    if long_arc(piece, bounds) or apart(piece, 1.0, piece, np.float64(piece[DONE]), bounds) > 1.0:
        return False
    return apart(piece, 1.0, other, np.float64(other[DONE]), bounds) <= 1.0


@kernel(seconds_per_unit=2e-4, compile_seconds=15.0)
def align(
    source: Moves, target: Moves, barriers: Ints, here: Floats, pieces: Floats, ints: Ints, bounds: Floats,
    notes: Ints, drift: Floats,
) -> int:  # fmt: skip
    """Go on with two paths until they differ, end, or have agreed row by row for a while, at most ``STEPS`` parts.

    barriers: (n, 2), rows before each event of both, the last one their numbers of rows; here: (2, 6), where both are;
    pieces: (2, PIECE); ints, bounds, notes, drift: see above. Returns AGREES, or what is different at the rows of ints.
    """
    for _ in range(STEPS):
        while (
            ints[BARRIER] < barriers.shape[0]
            and pieces[0, OPEN] == 0.0
            and pieces[1, OPEN] == 0.0
            and ints[SOURCE] == barriers[ints[BARRIER], 0]
            and ints[TARGET] == barriers[ints[BARRIER], 1]
        ):
            ints[BARRIER] += 1
        if ints[BARRIER] >= barriers.shape[0]:
            return AGREES
        if ints[CALM] >= bounds[CALM_ENOUGH]:
            ints[CALM] = 0
            if pieces[0, OPEN] == 0.0 and pieces[1, OPEN] == 0.0:
                return AGREES
        if pieces[0, OPEN] == 0.0 and ints[SOURCE] < barriers[ints[BARRIER], 0]:
            open_piece(pieces[0], ints[SOURCE], source, here[0])
        if pieces[1, OPEN] == 0.0 and ints[TARGET] < barriers[ints[BARRIER], 1]:
            open_piece(pieces[1], ints[TARGET], target, here[1])
        if pieces[0, OPEN] != 0.0 and pieces[1, OPEN] != 0.0:
            found = step(source, target, pieces, ints, bounds, notes, drift)
            if found != AGREES:
                return found
        else:
            # Only one path goes on before the event: what is shorter than the tolerance may be passed over.
            k = 0 if pieces[0, OPEN] != 0.0 else 1
            away = 0.0
            for a in range(6):
                tolerance = bounds[MM] if a < 3 else bounds[DEGREES]
                away = max(away, abs(pieces[k, END + a] - here[1 - k, a]) / tolerance)
                away = max(
                    away, abs(pieces[k, END + a] - coordinate(pieces[k], np.float64(pieces[k, DONE]), a)) / tolerance
                )
            if pieces[k, CUTS] == 0.0 or away > 1.0 or long_arc(pieces[k], bounds):
                return MORE_IN_SOURCE if k == 0 else MORE_IN_TARGET
            pieces[k, OPEN] = 0.0
        for k in range(2):
            if pieces[k, OPEN] == 0.0 and pieces[k, DONE] >= 0.0:
                moved(here[k], pieces[k], 1.0)
                pieces[k, DONE] = -1.0
                ints[k] += 1
    return AGREES
