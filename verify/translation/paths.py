"""Two rows of moves: the same path, or where they part. Whole columns at once while rows agree one by one, and the
kernel of ``align_kernels`` where they do not."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from gproof.ir.record import field, record
from gproof.ir.trace import Op
from gproof.ir.translation_terms import TranslationTerms
from gproof.verify.translation import align_kernels as k
from gproof.verify.translation.align_kernels import Moves

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

FIRST_BLOCK = 256
"""Rows that are compared at once first; twice as many each time that all agree."""
CALM, LONGEST_CALM, SHORT = 8, 1024, 64
"""Rows in a row that agree one by one before whole columns are compared again: at first, and at most. It gets longer
each time that fewer than ``SHORT`` rows agree then."""


_FURTHER = (k.KIND, k.PLACE, k.FORM, k.MORE_IN_SOURCE, k.MORE_IN_TARGET)
"""What is found where one of two moves goes further than the other, and something else comes there."""


@record(slots=True, kw_only=True)
class Alignment:
    """found: AGREES or what is different, at the rows ``source`` and ``target``; drift: mm and degrees.

    notes: see ``align_kernels``.
    """

    found: int = k.AGREES
    source: int = 0
    target: int = 0
    notes: Ints = field(default_factory=lambda: np.zeros((k.NOTES, 3), np.int64))
    drift: Floats = field(default_factory=lambda: np.zeros(2))


def bounds_of(terms: TranslationTerms) -> Floats:
    """The numbers that the kernel compares with."""
    bounds = np.zeros(k.BOUNDS)
    straight = terms.source_straight is True and terms.target_straight is True
    bounds[k.MM], bounds[k.DEGREES], bounds[k.CHORD_MM] = terms.tolerance_mm, terms.tolerance_deg, terms.chord_mm
    bounds[k.FEED_SHARE], bounds[k.STRAIGHT], bounds[k.CALM_ENOUGH] = terms.feed_relative, float(straight), CALM
    if terms.rapid_rates and terms.source_straight is True:
        bounds[k.LEAST_RATE] = min(rate for _, rate in terms.rapid_rates)
    return bounds


def aligned(source: Moves, target: Moves, barriers: Ints, start: Floats, bounds: Floats) -> Alignment:
    """Compare two paths. barriers: (n, 2), see ``align``; start: (2, 6), where both start."""
    result = Alignment()
    here = start.copy()
    pieces = np.zeros((2, k.PIECE))
    pieces[:, k.DONE] = -1.0
    ints = np.zeros(4, np.int64)
    # What the kernel will have to do until rows agree again nobody knows: as much as the last time.
    work, total, bounds = float(CALM), 0, bounds.copy()
    while ints[k.BARRIER] < len(barriers):
        if not pieces[:, k.OPEN].any() and (not total or ints[k.CALM] == 0):
            begun = int(ints[k.SOURCE])
            _whole_columns(source, target, barriers, here, ints, bounds, result)
            is_short = ints[k.SOURCE] - begun < SHORT
            bounds[k.CALM_ENOUGH] = min(2 * bounds[k.CALM_ENOUGH], LONGEST_CALM) if is_short else CALM
        done = int(ints[k.SOURCE] + ints[k.TARGET])
        found = k.align.pick(work)(source, target, barriers, here, pieces, ints, bounds, result.notes, result.drift)
        total += 1
        work = float(ints[k.SOURCE] + ints[k.TARGET] - done)
        if found != k.AGREES:
            result.found = int(found)
            break
    result.source, result.target = int(ints[k.SOURCE]), int(ints[k.TARGET])
    parts = [bool(pieces[n, k.OPEN] and pieces[n, k.DONE] > 0.0) for n in (0, 1)]
    if result.found in _FURTHER and parts[0] != parts[1]:
        # A part of the move was there on the other side, too: it goes further.
        result.found = k.PLACE
        result.source, result.target = result.source - parts[1], result.target - parts[0]
    return result


def _whole_columns(
    source: Moves, target: Moves, barriers: Ints, here: Floats, ints: Ints, bounds: Floats, result: Alignment
) -> None:
    """Go on from two rows that come next, as long as rows and events agree one by one."""
    block = FIRST_BLOCK
    while True:
        i, j = int(ints[k.SOURCE]), int(ints[k.TARGET])
        count = min(block, len(source.op) - i, len(target.op) - j)
        if count <= 0:
            return
        fits = _agree(source, i, target, j, count, here, bounds)
        good = count if fits.all() else int(np.argmin(fits))
        good = _before_uneven_event(barriers, ints, good)
        if good:
            _take(source, i, target, j, good, here, bounds, result)
            ints[k.SOURCE] += good
            ints[k.TARGET] += good
        _pass_events(barriers, ints)
        if good < count:
            return
        block *= 2


def _before_uneven_event(barriers: Ints, ints: Ints, good: int) -> int:
    """How many of the rows that agree come before an event that is not at the same row on both sides."""
    at = int(ints[k.BARRIER])
    i, j = int(ints[k.SOURCE]), int(ints[k.TARGET])
    until = at + int(np.searchsorted(barriers[at:, 0], i + good, side="right"))
    beyond = at + int(np.searchsorted(barriers[at:, 1], j + good, side="right"))
    ahead = barriers[at : max(until, beyond)] - np.array([i, j])
    uneven = np.flatnonzero(ahead[:, 0] != ahead[:, 1])
    if len(uneven):
        return min(good, max(0, int(ahead[uneven[0]].min())))
    return good


def _pass_events(barriers: Ints, ints: Ints) -> None:
    """Events that both paths have come to are over."""
    at = int(ints[k.BARRIER])
    come = (int(np.searchsorted(barriers[at:, n], ints[n], side="right")) for n in (k.SOURCE, k.TARGET))
    ints[k.BARRIER] += min(come)


def _agree(
    source: Moves, i: int, target: Moves, j: int, count: int, here: Floats, bounds: Floats
) -> npt.NDArray[np.bool_]:
    """Row by row: the same move, beyond doubt."""
    a, b = slice(i, i + count), slice(j, j + count)
    op = source.op[a]
    fits = (op == target.op[b]) & (source.frame[a] == target.frame[b]) & (source.before[a] == target.before[b])
    fits &= (source.fact[a] == target.fact[b]) & (source.turns[a] == target.turns[b])
    fits &= (source.plane[a] == target.plane[b]) & (source.frame[a] > 0)
    away = np.abs(source.to[a] - target.to[b])
    fits &= (away[:, :3] <= bounds[k.MM]).all(axis=1) & (away[:, 3:] <= bounds[k.DEGREES]).all(axis=1)
    feeds = source.feed[a], target.feed[b]
    with np.errstate(invalid="ignore"):
        even = np.abs(feeds[0] - feeds[1]) <= bounds[k.FEED_SHARE] * np.maximum(*feeds)
    fits &= even | (op == Op.TRAVERSE)
    if bounds[k.STRAIGHT] == 0.0:
        fits &= (op != Op.TRAVERSE) | ((source.axes[a] <= 1) & (target.axes[b] <= 1))
    arcs = np.flatnonzero(fits & (op == Op.ARC))
    if len(arcs):
        near = np.abs(source.center[a][arcs] - target.center[b][arcs]) <= bounds[k.MM]
        sweeps = sweeps_of(source, i, arcs, here[0]), sweeps_of(target, j, arcs, here[1])
        even = np.abs(sweeps[0][0] - sweeps[1][0]) * sweeps[0][1] <= k.ARC * bounds[k.MM]
        fits[arcs] &= near.all(axis=1) & even
    return np.asarray(fits)


def sweeps_of(moves: Moves, first: int, arcs: npt.NDArray[np.intp], here: Floats) -> tuple[Floats, Floats]:
    """Signed angles and radii of some arcs, numbered from ``first``, where the path is ``here``."""
    rows = arcs + first
    began = moves.to[rows - 1]
    if len(arcs) and arcs[0] == 0:
        began = began.copy()
        began[0] = here
    pairs = np.array([[0, 0], [0, 1], [2, 0], [1, 2]])[moves.plane[rows]]
    which = np.arange(len(rows))
    center = moves.center[rows]
    one = [began[which, pairs[:, n]] - center[which, pairs[:, n]] for n in (0, 1)]
    two = [moves.to[rows][which, pairs[:, n]] - center[which, pairs[:, n]] for n in (0, 1)]
    sweep = np.arctan2(two[1], two[0]) - np.arctan2(one[1], one[0])
    turns, full = moves.turns[rows], 2.0 * math.pi
    for _ in range(2):
        sweep = np.where((turns > 0) & (sweep <= 0.0), sweep + full, sweep)
        sweep = np.where((turns < 0) & (sweep >= 0.0), sweep - full, sweep)
    sweep += full * (turns - np.sign(turns))
    return sweep, np.hypot(one[0], one[1])


def _take(
    source: Moves, i: int, target: Moves, j: int, count: int, here: Floats, bounds: Floats, result: Alignment
) -> None:
    """Rows that agree: the path is at their end."""
    away = np.abs(source.to[i : i + count] - target.to[j : j + count]).max(axis=0)
    result.drift[0] = max(result.drift[0], float(away[:3].max()))
    result.drift[1] = max(result.drift[1], float(away[3:].max()))
    here[0], here[1] = source.to[i + count - 1], target.to[j + count - 1]
