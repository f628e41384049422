"""Stock between two height fields: never less than is there above, never more below, whatever the tool and its way."""

from __future__ import annotations

import random

import numpy as np
import pytest
from passes.stock_truth import SHAPES, Move, Shape, height_left, random_moves, sweep
from support.campaigns import seeds

from gproof.passes import stock_kernels as kernels


@pytest.mark.parametrize("seed", seeds(12, 400))
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
