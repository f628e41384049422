"""Boxes of rows: they hold 10,000 samples of each move, and each face is reached where calculus says so."""

from __future__ import annotations

import math

import numpy as np
import pytest
from passes.traces import Path
from support.campaigns import seeds

from gproof.ir.trace import Plane
from gproof.passes.extent_kernels import row_boxes, rows_near

SAMPLES = np.linspace(0.0, 1.0, 10_000)
PAIR = {Plane.XY: (0, 1), Plane.XZ: (2, 0), Plane.YZ: (1, 2)}


def box_of(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """What the kernel says that the only row reaches, its start left out."""
    section = path.done().sections[0]
    rows = section.rows
    low, high = np.full((2, 6), math.inf), np.full((2, 6), -math.inf)
    index, none = np.zeros((2, 6), dtype=np.int64), np.zeros(0, dtype=np.int64)
    row_boxes(
        rows["op"], rows["to"], rows["center"], rows["turns"], rows["plane"], rows["frame"],
        np.zeros(1, dtype=np.int64), rows["state"], np.array(section.start), np.zeros((1, 6), dtype=np.uint8),
        np.full((2, 6), -math.inf), np.full((2, 6), math.inf), low, high, index, index.copy(), none, none,
        np.zeros(0), np.zeros((0, 2)),
    )  # fmt: skip
    return low[0, :3], high[0, :3]


def extremes(first: float, sweep: float, radius: float, cosine: bool) -> tuple[float, float]:
    """Least and greatest of radius · cos (or sin) over the angles from ``first`` on, from where its slope is 0."""
    low, high = sorted((first, first + sweep))
    shift = 0.0 if cosine else math.pi / 2
    angles = [low, high]
    angles += [
        k * math.pi + shift for k in range(math.ceil((low - shift) / math.pi), math.floor((high - shift) / math.pi) + 1)
    ]
    values = [radius * (math.cos(a) if cosine else math.sin(a)) for a in angles]
    return min(values), max(values)


@pytest.mark.parametrize("plane", list(PAIR))
@pytest.mark.parametrize("seed", seeds(2, 20))
def test_a_box_holds_its_arc_and_touches_it_on_every_side(plane: Plane, seed: int) -> None:
    rng = np.random.default_rng([seed, int(plane)])
    u, v = PAIR[plane]
    w = 3 - u - v
    for case in range(120):
        radius = float(10.0 ** rng.uniform(-3, 4))
        first = float(rng.uniform(-4, 4))
        if case % 4 == 0:
            first = float(rng.integers(-4, 5)) * math.pi / 2  # begins where it turns round
        turns = int(rng.choice([1, -1, 2, -3]))
        part = float(rng.choice([1e-6, rng.uniform(0.01, 6.28), math.pi / 2, math.pi]))
        sweep = math.copysign(part + (abs(turns) - 1) * 2 * math.pi, turns)
        center = rng.uniform(-100, 100, 3)
        begin, end = center.copy(), center.copy()
        begin[u], begin[v] = center[u] + radius * math.cos(first), center[v] + radius * math.sin(first)
        end[u], end[v] = center[u] + radius * math.cos(first + sweep), center[v] + radius * math.sin(first + sweep)
        end[w] = begin[w] + float(rng.choice([0.0, rng.uniform(-50, 50)]))
        path = Path(x=begin[0], y=begin[1], z=begin[2])
        path.arc(100.0, turns, (center[u], center[v]), plane, x=end[0], y=end[1], z=end[2])
        low, high = box_of(path)
        low, high = np.minimum(low, begin), np.maximum(high, begin)
        angles = first + sweep * SAMPLES
        points = np.empty((len(SAMPLES), 3))
        points[:, u], points[:, v] = center[u] + radius * np.cos(angles), center[v] + radius * np.sin(angles)
        points[:, w] = begin[w] + (end[w] - begin[w]) * SAMPLES
        near = 1e-9 * (1.0 + radius)
        where = (seed, case, radius, first, sweep, center)
        assert (points >= low - near).all(), where
        assert (points <= high + near).all(), where
        for axis, cosine in ((u, True), (v, False)):
            least, most = extremes(first, sweep, radius, cosine)
            assert abs(low[axis] - (center[axis] + least)) <= near, where
            assert abs(high[axis] - (center[axis] + most)) <= near, where
        assert (low[w], high[w]) == (min(begin[w], end[w]), max(begin[w], end[w]))


@pytest.mark.parametrize("seed", seeds(2, 20))
def test_a_line_has_the_box_of_its_ends(seed: int) -> None:
    rng = np.random.default_rng(100 + seed)
    for _ in range(50):
        begin, end = rng.uniform(-1e3, 1e3, (2, 3))
        path = Path(x=begin[0], y=begin[1], z=begin[2]).feed(100.0, x=end[0], y=end[1], z=end[2])
        low, high = box_of(path)
        points = begin + (end - begin) * SAMPLES[:, np.newaxis]
        assert (points >= np.minimum(low, begin) - 1e-12 * 1e3).all()
        assert (points <= np.maximum(high, begin) + 1e-12 * 1e3).all()
        assert (low == end).all()
        assert (high == end).all()


@pytest.mark.parametrize("seed", seeds(1, 10))
def test_no_row_that_comes_into_a_box_is_left_out(seed: int) -> None:
    """The rows that zones look at: each with a sample inside the box is among them."""
    rng = np.random.default_rng(200 + seed)
    for _ in range(60):
        path = Path(x=0.0, y=0.0, z=0.0)
        moved: list[np.ndarray] = []
        at = np.zeros(3)
        for _ in range(8):
            end = rng.uniform(-20, 20, 3)
            if rng.random() < 0.5:
                plane = Plane(int(rng.integers(1, 4)))
                u, v = PAIR[plane]
                center = (at + end) / 2
                path.arc(100.0, int(rng.choice([1, -1])), (center[u], center[v]), plane, x=end[0], y=end[1], z=end[2])
                radius = math.hypot(at[u] - center[u], at[v] - center[v])
                first = math.atan2(at[v] - center[v], at[u] - center[u])
                sign = 1 if path._rows[-1]["turns"] == 1 else -1
                angle = first + sign * math.pi * SAMPLES[::50]
                points = at + (end - at) * SAMPLES[::50, np.newaxis]
                points[:, u], points[:, v] = center[u] + radius * np.cos(angle), center[v] + radius * np.sin(angle)
            else:
                path.feed(100.0, x=end[0], y=end[1], z=end[2])
                points = at + (end - at) * SAMPLES[::50, np.newaxis]
            moved.append(points)
            at = end
        low = rng.uniform(-25, 20, 3)
        high = low + rng.choice([0.01, 3.0, 20.0], 3)
        section = path.done().sections[0]
        rows = section.rows
        found = np.zeros(len(rows), dtype=np.int64)
        count = rows_near(
            rows["op"], rows["to"], rows["center"], rows["turns"], rows["plane"], np.array(section.start), low, high,
            found,
        )  # fmt: skip
        inside = {n for n, p in enumerate(moved) if ((p > low) & (p < high)).all(axis=1).any()}
        assert inside <= set(found[:count].tolist())
