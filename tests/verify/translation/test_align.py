"""The kernel that lays two paths side by side, against points of both: what agrees is near everywhere, in order.

The oracle walks both paths in steps and asks for a discrete Fréchet distance: the shortest leash with which two walkers
get along both paths without turning back. It knows nothing of moves, cuts or arcs.
"""

from __future__ import annotations

import math
import random

import numpy as np
import pytest
from support.campaigns import seeds

from gproof.ir.translation_terms import TranslationTerms
from gproof.verify.translation import align_kernels as k
from gproof.verify.translation.align_kernels import Moves
from gproof.verify.translation.paths import Alignment, aligned, bounds_of

TOLERANCE = 0.01
START = (0.0, 0.0)
Row = tuple[float, float, int, float, float]
"""X, Y, turns (0: a line), and the centre of an arc."""


def moves(rows: list[Row], feeds: list[float] | None = None) -> Moves:
    n = len(rows)
    to, center = np.zeros((n, 6)), np.zeros((n, 3))
    to[:, :2] = np.array([row[:2] for row in rows]).reshape(n, 2)
    turns = np.array([row[2] for row in rows], np.int64)
    center[:, :2] = np.array([row[3:] for row in rows]).reshape(n, 2)
    ones = np.ones(n, np.int64)
    return Moves(
        op=np.where(turns != 0, k.ARC_OP, k.FEED).astype(np.int64), to=to, frame=ones, before=ones, fact=ones,
        feed=np.array(feeds or [100.0] * n), center=center, turns=turns, plane=(turns != 0).astype(np.int64), axes=ones,
    )  # fmt: skip


def run(one: Moves, other: Moves, chord: float = 0.0) -> Alignment:
    barriers = np.array([[len(one.op), len(other.op)]], np.int64)
    return aligned(one, other, barriers, np.zeros((2, 6)), bounds_of(
        TranslationTerms(tolerance_mm=TOLERANCE, chord_mm=chord, source_straight=True, target_straight=True)
    ))  # fmt: skip


def arc(at: tuple[float, float], center: tuple[float, float], angle: float) -> Row:
    x, y = at[0] - center[0], at[1] - center[1]
    c, s = math.cos(angle), math.sin(angle)
    return center[0] + x * c - y * s, center[1] + x * s + y * c, 1 if angle > 0 else -1, *center


def path(rng: random.Random, count: int) -> list[Row]:
    at, rows = START, list[Row]()
    for _ in range(count):
        if rng.random() < 0.5:
            rows.append((at[0] + rng.uniform(-9, 9), at[1] + rng.uniform(-9, 9), 0, 0.0, 0.0))
        else:
            center = at[0] + rng.uniform(1, 9), at[1] + rng.uniform(1, 9)
            rows.append(arc(at, center, rng.choice([-1, 1]) * rng.uniform(0.2, 5.5)))
        at = rows[-1][:2]
    return rows


def cut(rng: random.Random, rows: list[Row]) -> list[Row]:
    """The same path in more moves."""
    at, found = START, list[Row]()
    for row in rows:
        for part in sorted(rng.random() for _ in range(rng.choice([0, 0, 1, 2]))):
            if row[2] == 0:
                x, y = at[0] + part * (row[0] - at[0]), at[1] + part * (row[1] - at[1])
                found.append((x, y, 0, 0.0, 0.0))
            else:
                found.append(arc(at, row[3:], part * angle_of(at, row)))
        found.append(row)
        at = row[:2]
    return found


def angle_of(at: tuple[float, float], row: Row) -> float:
    a = math.atan2(at[1] - row[4], at[0] - row[3])
    b = math.atan2(row[1] - row[4], row[0] - row[3])
    turn = (b - a) % (2 * math.pi)
    return (turn or 2 * math.pi) if row[2] > 0 else (turn - 2 * math.pi)


def points(rows: list[Row], step: float) -> list[tuple[float, float]]:
    at, found = START, [START]
    for row in rows:
        if row[2] == 0:
            n = max(1, math.ceil(math.dist(at, row[:2]) / step))
            found += [(at[0] + i / n * (row[0] - at[0]), at[1] + i / n * (row[1] - at[1])) for i in range(1, n + 1)]
        else:
            angle = angle_of(at, row)
            r0, r1 = math.dist(at, row[3:]), math.dist(row[:2], row[3:])
            n = max(1, math.ceil(math.hypot(angle * max(r0, r1), r1 - r0) / step))
            for i in range(1, n + 1):
                x, y, *_ = arc(at, row[3:], angle * i / n)
                wider = 1.0 + (r1 / r0 - 1.0) * i / n  # from start to end the radius changes evenly (docs/trace.md)
                found.append((row[3] + (x - row[3]) * wider, row[4] + (y - row[4]) * wider))
        at = row[:2]
    return found


def leash(one: list[tuple[float, float]], other: list[tuple[float, float]]) -> float:
    """The discrete Fréchet distance, by the recurrence of Eiter and Mannila (1994)."""
    a, b = np.array(one), np.array(other)
    apart = np.hypot(a[:, None, 0] - b[None, :, 0], a[:, None, 1] - b[None, :, 1])
    best = np.full(apart.shape, np.inf)
    for i in range(len(a)):
        for j in range(len(b)):
            before = min(
                best[i - 1, j] if i else math.inf, best[i, j - 1] if j else math.inf,
                best[i - 1, j - 1] if i and j else math.inf,
            )  # fmt: skip
            best[i, j] = apart[i, j] if i == j == 0 else max(before, apart[i, j])
    return float(best[-1, -1])


@pytest.mark.parametrize("seed", seeds(40, 2000))
def test_the_same_path_cut_elsewhere(seed: int) -> None:
    rng = random.Random(seed)
    rows = path(rng, 6)
    assert run(moves(cut(rng, rows)), moves(cut(rng, rows))).found == k.AGREES


@pytest.mark.parametrize("seed", seeds(25, 1000))
def test_what_agrees_is_near(seed: int) -> None:
    """A path with one number changed by up to twice the tolerance."""
    rng = random.Random(1000 + seed)
    rows = path(rng, 3)
    wrong = [list(row) for row in cut(rng, rows)]
    place = rng.choice([(n, m) for n, row in enumerate(wrong) for m in ((0, 1) if row[2] == 0 else (0, 1, 3, 4))])
    wrong[place[0]][place[1]] += rng.choice([-1, 1]) * rng.uniform(0.1, 2.0) * TOLERANCE
    other = [(r[0], r[1], int(r[2]), r[3], r[4]) for r in wrong]
    found = run(moves(rows), moves(other))
    step, near = 0.35, k.ARC * math.sqrt(2) * TOLERANCE
    if found.found == k.AGREES:
        assert leash(points(rows, step), points(other, step)) <= near + step
    # A far larger one: what agrees all the same (a cut that slides along its line, the centre of a short arc) is near.
    wrong[place[0]][place[1]] += 1.5
    other = [(r[0], r[1], int(r[2]), r[3], r[4]) for r in wrong]
    if run(moves(rows), moves(other)).found == k.AGREES:
        assert leash(points(rows, step), points(other, step)) <= near + step


@pytest.mark.parametrize("chords", [12, 40])
def test_chords(chords: int) -> None:
    """Radius 10 over 4 radians: 12 chords are 10 (1 - cos(1 / 6)) = 0.139 mm away, 40 are 0.0125 mm."""
    one = arc(START, (10.0, 0.0), 4.0)
    other = [(*arc(START, (10.0, 0.0), 4.0 * n / chords)[:2], 0, 0.0, 0.0) for n in range(1, chords + 1)]
    away = 10.0 * (1.0 - math.cos(2.0 / chords))
    for chord, expected in ((away + 1e-3, True), (away - TOLERANCE - 1e-3, False)):
        assert (run(moves([one]), moves(other), chord).found == k.AGREES) is expected
        assert (run(moves(other), moves([one]), chord).found == k.AGREES) is expected
    assert run(moves([one]), moves(other)).found == k.KIND


def test_a_full_circle_is_no_short_arc() -> None:
    """An end that is a rounding away from the start: a circle on one side, nothing on the other."""
    circle = (0.0, 0.0, 1, 5.0, 0.0)
    short = arc(START, (5.0, 0.0), 1e-6)
    nearly = arc(START, (5.0, 0.0), 2 * math.pi - 1e-6)
    assert run(moves([circle]), moves([short])).found != k.AGREES
    assert run(moves([circle]), moves([nearly])).found == k.AGREES
    twice = (0.0, 0.0, 2, 5.0, 0.0)
    assert run(moves([circle]), moves([twice])).found != k.AGREES
    assert run(moves([circle, circle]), moves([twice])).found == k.AGREES


def test_back_and_forth_is_not_once() -> None:
    line = (5.0, 0.0, 0, 0.0, 0.0)
    home = (0.0, 0.0, 0, 0.0, 0.0)
    half = (2.5, 0.0, 0, 0.0, 0.0)
    assert run(moves([line, home, line]), moves([line])).found != k.AGREES
    assert run(moves([line, half, line]), moves([line])).found != k.AGREES
    assert run(moves([half, line, home]), moves([line, half, home])).found == k.AGREES


def test_a_feed_of_a_part() -> None:
    rows = [(2.5, 0.0, 0, 0.0, 0.0), (5.0, 0.0, 0, 0.0, 0.0)]
    assert run(moves(rows, [100.0, 100.0]), moves(rows[1:], [100.0])).found == k.AGREES
    assert run(moves(rows, [100.0, 101.0]), moves(rows[1:], [100.0])).found == k.FEEDS
    assert run(moves(rows, [math.nan, 100.0]), moves(rows[1:], [100.0])).notes[k.UNKNOWN_FEED, 0] == 1


def test_slivers() -> None:
    """Moves below the tolerance may be missing, but not many of them in one direction."""
    step = 0.6 * TOLERANCE
    sliver = [(step, 0.0, 0, 0.0, 0.0), (5.0, 0.0, 0, 0.0, 0.0)]
    assert run(moves(sliver, [50.0, 100.0]), moves(sliver[1:])).found == k.AGREES
    many = [(n * step, 0.0, 0, 0.0, 0.0) for n in range(1, 6)]
    assert run(moves([*many, sliver[1]], [50.0] * 5 + [100.0]), moves(sliver[1:])).found == k.FEEDS
    assert run(moves(many), moves([])).found == k.MORE_IN_SOURCE


def test_both_speeds_agree() -> None:
    rng = random.Random(7)
    for _ in range(10):
        rows = path(rng, 5)
        one, other = moves(cut(rng, rows)), moves(cut(rng, rows))
        barriers = np.array([[len(one.op), len(other.op)]], np.int64)
        results = []
        for kernel in (k.align.python, k.align.compiled()):
            pieces, ints, drift = np.zeros((2, k.PIECE)), np.zeros(4, np.int64), np.zeros(2)
            pieces[:, k.DONE] = -1.0
            notes, here = np.zeros((k.NOTES, 3), np.int64), np.zeros((2, 6))
            bounds = bounds_of(TranslationTerms(tolerance_mm=TOLERANCE))
            bounds[k.CALM_ENOUGH] = 1e9
            found = kernel(one, other, barriers, here, pieces, ints, bounds, notes, drift)
            results.append((int(found), pieces.tobytes(), ints.tobytes(), drift.tobytes(), here.tobytes()))
        assert results[0] == results[1]
