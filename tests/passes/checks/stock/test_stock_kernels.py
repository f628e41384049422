"""Stock between two height fields: never less than is there above, never more below, whatever the tool and its way."""

from __future__ import annotations

import random

import numpy as np
import pytest
from passes.checks.stock.stock_truth import SHAPES, Move, Shape, height_left, random_moves, sweep
from support.campaigns import seeds

from gproof.passes.checks.stock import entry_kernels
from gproof.passes.checks.stock import follow_kernels as kernels


@pytest.mark.parametrize("seed", seeds(5, 400))
def test_what_is_left_lies_between_the_fields(seed: int) -> None:
    rng = random.Random(seed)
    shape = rng.choice(SHAPES)
    moves = random_moves(rng, rng.choice((1, 2, 6)))
    cell = rng.choice((0.2, 0.5, 1.3))
    swept = sweep(shape, moves, cell=cell)
    many = np.random.default_rng(seed)
    points = many.uniform((0.0, 0.0), (12.0, 10.0), (600, 2))
    # As many on the edges of cells, where a cell's worst place is.
    points[::2, 0] = np.round(points[::2, 0] / swept.grid[2]) * swept.grid[2] + many.choice((-1e-9, 1e-9), 300)
    points = np.clip(points, 0.0, (12.0 - 1e-9, 10.0 - 1e-9))
    left = height_left(shape, moves, points, 0.0)
    left[left <= -10.0] = -np.inf
    i = np.floor(points[:, 0] / swept.grid[2]).astype(int)
    j = np.floor(points[:, 1] / swept.grid[3]).astype(int)
    upper, lower = swept.upper[j, i], swept.lower[j, i]
    told = f"seed {seed}: {shape} {moves}"
    assert (upper >= left - 1e-7).all(), told
    assert ((lower <= left + 1e-7) | (lower <= -10.0)).all(), told
    assert (swept.lower <= np.maximum(swept.upper, -10.0)).all() or (swept.upper == -np.inf).any()


@pytest.mark.parametrize("shape", SHAPES[:5], ids=lambda s: s.name)
def test_the_gap_shrinks_with_the_cell(shape: Shape) -> None:
    moves = [
        Move(kernels.FEED, (2.0, 3.0, -1.0), (9.0, 6.0, -3.0)),
        Move(kernels.FEED, (9.0, 6.0, -3.0), (4.0, 8.0, -2.0)),
    ]
    gaps = []
    for cell in (0.4, 0.1, 0.025):
        swept = sweep(shape, moves, cell=cell)
        gaps.append(float((swept.upper - swept.lower).mean()))
    assert gaps[1] < 0.4 * gaps[0]
    assert gaps[2] < 0.4 * gaps[1]


def traverse_behind(rng: random.Random, moves: list[Move]) -> Move:
    """A traverse from where the moves end, often low or along what they cut."""
    at = moves[-1].end
    kind = rng.random()
    to = (rng.uniform(-3, 15), rng.uniform(-3, 13), rng.uniform(-3, 2))
    if kind < 0.2:
        to = (at[0], at[1], to[2])
    elif kind < 0.5:
        to = moves[-1].start
    elif kind < 0.7:
        to = (to[0], to[1], at[2])
    return Move(kernels.TRAVERSE, at, to)


@pytest.mark.parametrize("seed", seeds(3, 400))
def test_traverses_are_told_what_is_true(seed: int) -> None:
    rng = random.Random(1000 + seed)
    shape = rng.choice(SHAPES)
    moves = [Move(kernels.FEED, (6.0, 5.0, 2.0), (6.0, 5.0, 1.0)), *random_moves(rng, rng.choice((1, 3)))]
    moves[1:1] = [Move(kernels.FEED, (6.0, 5.0, 1.0), moves[1].start)]
    last = traverse_behind(rng, moves)
    swept = sweep(shape, [*moves, last], cell=rng.choice((0.2, 0.5)))
    many = np.random.default_rng(seed)
    points = many.uniform((0.0, 0.0), (12.0, 10.0), (1500, 2))
    # Where the tool is at most its radius away.
    t = many.uniform(0.0, 1.0, 1500)
    way = last.at(t)[:, :2] + shape.radius * many.uniform(-0.99, 0.99, (1500, 2))
    points = np.concatenate([points, way[((way >= 0.0) & (way <= (12.0, 10.0))).all(axis=1)]])
    left = height_left(shape, moves, points, 0.0)
    side = height_left(shape, [Move(kernels.FEED, last.start, last.end)], points, np.inf)
    into = np.where(left > -10.0, left - np.maximum(side, -10.0), -np.inf).max()
    answer, amount = swept.told[-1, entry_kernels.THROUGH], swept.amount[-1, entry_kernels.THROUGH]
    told = f"seed {seed}: {shape} {moves} {last}: {answer} {amount}, {into} deep"
    if into > 1e-6:
        assert answer != entry_kernels.CLEAR, told
    if answer == entry_kernels.SURE and amount > 0.2:
        assert into > 0.0, told


def test_a_rib_thinner_than_a_cell_is_found() -> None:
    """Two slots beside one another leave a rib of a hundredth of a millimetre; points a cell apart miss it."""
    shape = Shape("flat", 2.0)
    feeds = [
        Move(kernels.FEED, (-3.0, 2.0, -2.0), (15.0, 2.0, -2.0)),
        Move(kernels.FEED, (15.0, 2.0, -2.0), (15.0, 2.0, 1.0)),
        Move(kernels.FEED, (15.0, 2.0, 1.0), (15.0, 6.01, 1.0)),
        Move(kernels.FEED, (15.0, 6.01, 1.0), (15.0, 6.01, -2.0)),
        Move(kernels.FEED, (15.0, 6.01, -2.0), (-3.0, 6.01, -2.0)),
    ]
    for cell in (0.1, 0.37, 1.0):
        over = [Move(kernels.TRAVERSE, (-3.0, 6.01, z), (12.0, 2.0, z)) for z in (0.0, -1e-6)]
        for move, clear in zip(over, (True, False), strict=True):
            up = Move(kernels.TRAVERSE, (-3.0, 6.01, -2.0), move.start)
            swept = sweep(shape, [*feeds, up, move], cell=cell)
            assert (swept.told[-1, entry_kernels.THROUGH] == entry_kernels.CLEAR) == clear


def test_the_clearance_holds_beside_and_below() -> None:
    """Of 0.5 mm: beside the block at X 12 with a radius of 2, and above it."""
    shape = Shape("flat", 2.0)
    for x, z, clear in ((14.5, -1.0, True), (14.499, -1.0, False), (5.0, 0.5, True), (5.0, 0.499, False)):
        move = Move(kernels.TRAVERSE, (x, 12.6, z), (x, 5.0, z))
        swept = sweep(shape, [move], clearance=0.5)
        assert (swept.told[0, entry_kernels.THROUGH] == entry_kernels.CLEAR) == clear, (x, z)


@pytest.mark.parametrize("seed", seeds(3, 60))
def test_both_speeds_and_pieces_of_any_size_give_the_same(seed: int) -> None:
    rng = random.Random(seed)
    shape = rng.choice(SHAPES)
    moves = random_moves(rng, 5)
    moves.append(traverse_behind(rng, moves))
    moves += [Move(kernels.FEED, moves[-1].end, (3.0, 3.0, -2.0))]
    one = sweep(shape, moves, cell=1.3)
    for other in (sweep(shape, moves, cell=1.3, run=kernels.follow.python), sweep(shape, moves, cell=1.3, pieces=1)):
        for name in ("upper", "lower", "told", "amount"):
            assert getattr(one, name).tobytes() == getattr(other, name).tobytes(), name
