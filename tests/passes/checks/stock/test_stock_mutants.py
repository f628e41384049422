"""Kernels of stock that are wrong in one place are caught: what the other tests look at is looked at."""

from __future__ import annotations

import random
import types
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from passes.checks.stock.stock_truth import SHAPES, Move, Shape, height_left, random_moves, sweep

from gproof.ir.kernel import Kernel
from gproof.passes.checks.stock import entry_kernels, removal_kernels, tool_side_kernels
from gproof.passes.checks.stock import follow_kernels as kernels

SOURCES = [
    Path(module.__file__).read_text(encoding="utf-8")
    for module in (tool_side_kernels, removal_kernels, entry_kernels, kernels)
]
"""In the order in which one imports the other."""

MUTANTS = {
    "upper at one corner": ("max(max(a[i], a[i + 1]), max(b[i], b[i + 1]))", "a[i]"),
    "upper at the least corner": ("max(max(a[i], a[i + 1]), max(b[i], b[i + 1]))", "min(a[i], a[i + 1], b[i])"),
    "cells that are cut in part": (
        "first_i, last_i = max(low, before_low), min(high, before_high)",
        "first_i, last_i = max(low, before_low, 1) - 1, min(high, before_high)",
    ),
    "a ball that is flat": (
        "out[i] = up + slope * at - math.sqrt(max(left - away * away, 0.0))",
        "out[i] = up - radius",
    ),
    "lower without the diagonal": ("c, beside + half)", "c, beside)"),
    "lower above the tip": ("max(line[i], least)", "max(line[i], least + 0.5)"),
    "nothing behind the begin": ("return radius * abs(slope) / math.sqrt(1.0 + slope * slope)", "return 0.0"),
    "behind the begin of a first move": ("if not again:\n        return INF", "if not again:\n        return 0.0"),
    "the wrong way down a slope": (
        "        if slope > 0.0:\n            w = -w\n",
        "        if slope < 0.0:\n            w = -w\n",
    ),
    "half of an arc": ("return sign * (sweep + (abs(turns) - 1) * TWO_PI)", "return sign * (sweep / 2)"),
    "traverses where they begin": ("px, qx = chord[0] + t * dx, chord[0] + end * dx", "px, qx = chord[0], chord[0]"),
    "a clearance that is not there": ("need = high + clearance + beneath", "need = high + beneath"),
    "stock that is not asked": ("if high <= free or high <= floor:", "if high <= free + 0.1 or high <= floor:"),
    "a retract that is never looked at": ("old = upright and bz >= deep", "old = upright and bz >= deep - 1.0"),
    "lines that are wide": ("beside <= LEFT and over >= -LEFT", "over >= -LEFT"),
    "lines that are deep": ("beside <= LEFT and over >= -LEFT", "beside <= LEFT"),
    "lines without an end": ("last = min((-SAME - s0) / s1, 1.0)", "last = 1.0"),
}


def mutant(old: str, new: str) -> Any:
    """``follow`` of the kernels with one piece of text replaced, in plain Python."""
    assert any(old in source for source in SOURCES), old
    made: dict[str, Any] = {}
    for source in SOURCES:
        module = types.ModuleType("mutant_kernels")
        exec(compile(source.replace(old, new), "mutant_kernels", "exec"), module.__dict__)
        names = module.__dict__
        names.update({name: made[name] for name in names if name in made})
        made.update({name: value for name, value in names.items() if isinstance(value, Kernel)})
    return made["follow"].python


def between(run: Any, seed: int) -> bool:
    """Whether the stock that is left lies between the fields behind a random path."""
    rng = random.Random(seed)
    shape = SHAPES[seed % len(SHAPES)]
    moves = random_moves(rng, 4)
    cell = 0.9
    swept = sweep(shape, moves, cell=cell, run=run)
    points = np.random.default_rng(seed).uniform((0.0, 0.0), (12.0, 10.0), (500, 2))
    left = height_left(shape, moves, points, 0.0)
    i, j = (points[:, 0] / swept.grid[2]).astype(int), (points[:, 1] / swept.grid[3]).astype(int)
    above, below = swept.upper[j, i] >= left - 1e-7, swept.lower[j, i] <= left + 1e-7
    return bool((above | (left <= -10.0)).all() and below.all())


def told(run: Any) -> bool:
    """Whether some traverses are told what is true of them."""
    flat = Shape("flat", 2.0)
    feed = Move(kernels.FEED, (6.0, 5.0, -2.0), (9.0, 5.0, -2.0))
    cases = (
        ([Move(kernels.TRAVERSE, (-5.0, 5.0, -1.0), (17.0, 5.0, -1.0))], 0.0, False),
        ([Move(kernels.TRAVERSE, (-5.0, 5.0, 0.4), (17.0, 5.0, 0.4))], 0.5, False),
        ([Move(kernels.TRAVERSE, (-5.0, 5.0, -0.05), (17.0, 5.0, -0.05))], 0.0, False),
        ([Move(kernels.TRAVERSE, (-5.0, 5.0, 0.5), (17.0, 5.0, 0.5))], 0.5, True),
        ([feed, Move(kernels.TRAVERSE, (9.0, 5.0, -2.0), (9.0, 5.0, -2.5))], 0.0, False),
        ([feed, Move(kernels.TRAVERSE, (9.0, 5.0, -2.0), (9.0, 5.0, 2.0))], 0.0, True),
        ([feed, Move(kernels.TRAVERSE, (9.0, 5.0, -2.0), (6.0, 5.0, -2.0))], 0.0, True),
        ([feed, Move(kernels.TRAVERSE, (9.0, 5.0, -2.0), (6.0, 5.001, -2.0))], 0.0, False),
        ([feed, Move(kernels.TRAVERSE, (9.0, 5.0, -2.0), (6.0, 5.0, -2.001))], 0.0, False),
        ([feed, Move(kernels.TRAVERSE, (9.0, 5.0, -2.0), (5.999, 5.0, -2.0))], 0.0, False),
    )
    for moves, clearance, clear in cases:
        swept = sweep(flat, moves, cell=0.9, run=run, clearance=clearance)
        if (swept.told[-1, entry_kernels.THROUGH] == entry_kernels.CLEAR) != clear:
            return False
    return True


def is_caught(run: Any) -> bool:
    return not told(run) or not all(between(run, seed) for seed in range(6))


def test_the_kernels_themselves_are_not_caught() -> None:
    assert not is_caught(kernels.follow.python)


@pytest.mark.parametrize("name", MUTANTS)
def test_a_mutant_is_caught(name: str) -> None:
    assert is_caught(mutant(*MUTANTS[name]))
