"""Boxes of rows and of whole jobs: they hold 10,000 samples of each move, and calculus reaches each face."""

from __future__ import annotations

import math
import random
from pathlib import Path as File

import numpy as np
import pytest
from passes.motion.traces import Path
from support.campaigns import seeds
from support.judging import UNBOUNDED, answer
from support.made_jobs import MAKERS, machine_of, opened

from gproof.driver.judge import judge
from gproof.driver.session import Running
from gproof.ir.trace import Plane
from gproof.ir.verdict import Verdict
from gproof.passes.geometry.extent_kernels import Extents, boxed_rows, room_beyond, row_boxes, rows_near

SAMPLES = np.linspace(0.0, 1.0, 10_000)
PAIR = {Plane.XY: (0, 1), Plane.XZ: (2, 0), Plane.YZ: (1, 2)}


def box_of(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """What the kernel says that the only row reaches, its start left out."""
    section = path.done().sections[0]
    rows = section.rows
    low, high = np.full((2, 6), math.inf), np.full((2, 6), -math.inf)
    index = np.zeros((2, 6), dtype=np.int64)
    row_boxes(
        boxed_rows(rows), np.zeros(1, dtype=np.int64), np.array(section.start), np.zeros((1, 6), dtype=np.uint8),
        np.full((2, 6), -math.inf), np.full((2, 6), math.inf), Extents(low, high, index, index.copy()), room_beyond(0),
        np.zeros((0, 2)),
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
        part = float(rng.choice([1e-6, rng.uniform(0.01, 6.28), math.pi / 2, math.pi, 1.5 * math.pi, 2 * math.pi]))
        sweep = math.copysign(part + (abs(turns) - 1) * 2 * math.pi, turns)
        center = rng.uniform(-100, 100, 3)
        begin, end = center.copy(), center.copy()
        begin[u], begin[v] = center[u] + radius * math.cos(first), center[v] + radius * math.sin(first)
        end[u], end[v] = center[u] + radius * math.cos(first + sweep), center[v] + radius * math.sin(first + sweep)
        if part == 2 * math.pi:
            end[u], end[v] = begin[u], begin[v]
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


@pytest.mark.parametrize("plane", list(PAIR))
@pytest.mark.parametrize("seed", seeds(1, 20))
def test_a_box_holds_a_spiral(plane: Plane, seed: int) -> None:
    """An arc whose radii differ, as far as a controller may accept: it runs evenly from one to the other."""
    rng = np.random.default_rng([seed, int(plane), 7])
    u, v = PAIR[plane]
    for case in range(40):
        first, turns = float(rng.uniform(-4, 4)), int(rng.choice([1, -1, 2, -3]))
        sweep = math.copysign(float(rng.uniform(0.01, 6.28)) + (abs(turns) - 1) * 2 * math.pi, turns)
        radius = float(rng.uniform(1, 100)) * (1.0 + SAMPLES * float(rng.uniform(-0.02, 0.02)))
        center = rng.uniform(-100, 100, 3)
        points = np.tile(center, (len(SAMPLES), 1))
        points[:, u] += radius * np.cos(first + sweep * SAMPLES)
        points[:, v] += radius * np.sin(first + sweep * SAMPLES)
        begin, end = points[0], points[-1]
        path = Path(x=begin[0], y=begin[1], z=begin[2])
        path.arc(100.0, turns, (center[u], center[v]), plane, x=end[0], y=end[1], z=end[2])
        low, high = box_of(path)
        near = 1e-9 * (1.0 + float(radius.max()))
        assert (points >= np.minimum(low, begin) - near).all(), (seed, case)
        assert (points <= np.maximum(high, begin) + near).all(), (seed, case)
        # No further out than the greater radius, and beside the quarters no further than it goes.
        for axis in (u, v):
            assert low[axis] >= center[axis] - radius.max() - near, (seed, case)
            assert high[axis] <= center[axis] + radius.max() + near, (seed, case)
            shift = 0.0 if axis == u else math.pi / 2
            turns_over = abs(math.floor((first + sweep - shift) / math.pi) - math.floor((first - shift) / math.pi))
            if not turns_over:
                coarse = 2.0 * float(radius.max()) * (sweep / len(SAMPLES)) ** 2 + near
                assert abs(min(low[axis], begin[axis]) - points[:, axis].min()) <= coarse, (seed, case)
                assert abs(max(high[axis], begin[axis]) - points[:, axis].max()) <= coarse, (seed, case)


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("backwards", [False, True])
def test_a_spiral_beside_a_quarter_goes_further_than_both_its_ends(sign: int, backwards: bool) -> None:
    """From radius 10 at 0.01 rad to 10.25 at 0.3: X = r cos a is greatest where tan a = r' / r, at 0.086 rad."""
    a, growth = 0.01, 0.25 / 0.29
    for _ in range(200):
        a = math.atan(growth / (10.0 + growth * (a - 0.01)))
    most = (10.0 + growth * (a - 0.01)) * math.cos(a)
    places = [(r * math.cos(angle), sign * r * math.sin(angle)) for r, angle in ((10.0, 0.01), (10.25, 0.3))]
    (x0, y0), (x1, y1) = reversed(places) if backwards else places
    low, high = box_of(Path(x=x0, y=y0, z=0.0).arc(100.0, -sign if backwards else sign, (0.0, 0.0), x=x1, y=y1, z=0.0))
    assert 10.028 < most < 10.029
    assert abs(high[0] - most) < 1e-12
    assert (min(low[1], y0), max(high[1], y0)) == pytest.approx((min(y0, y1), max(y0, y1)), abs=1e-12)


@pytest.mark.parametrize("name", [name for name in MAKERS if name != "eding"])
@pytest.mark.parametrize("seed", seeds(1, 40))
def test_the_box_of_a_whole_job_is_exact(name: str, seed: int, tmp_path: File) -> None:
    """Lines, arcs and helices as programs of three controllers have them, turned and scaled ones too."""
    for case in range(12):
        made = MAKERS[name](random.Random(f"box {name} {seed} {case}"))
        judgement = judge(opened(tmp_path, made, machine_of(made, np.array([[-1e4] * 3, [1e4] * 3]))),
                          running=Running(UNBOUNDED))  # fmt: skip
        where = f"{name} {seed} {case}\n{made.program}"
        assert answer(judgement, "limits").verdict is Verdict.SAFE, where
        least, most, near = np.full(3, math.inf), np.full(3, -math.inf), 1e-9
        for move in made.moves:
            ends = move.ends[1:]
            least, most = np.minimum(least, ends.min(axis=0)), np.maximum(most, ends.max(axis=0))
            if move.arc is None:
                continue
            middle, start, turn = move.arc
            first, radius = math.atan2(start.imag - middle.imag, start.real - middle.real), abs(start - middle)
            near = max(near, 1e-9 * (1.0 + radius))
            for axis, shift in ((0, middle.real), (1, middle.imag)):
                low, high = extremes(first, turn, radius, axis == 0)
                least[axis], most[axis] = min(least[axis], shift + low), max(most[axis], shift + high)
        points = np.concatenate([move.at(SAMPLES) for move in made.moves[1:]] or [made.moves[0].ends[1:]])
        found = {axis: (low, high) for axis, form, low, high in judgement.summary.box if form == ""}
        for n, axis in enumerate("xyz"):
            if axis not in found:
                continue  # it never moves
            assert abs(found[axis][0] - least[n]) <= near, (axis, where)
            assert abs(found[axis][1] - most[n]) <= near, (axis, where)
            ends = min(found[axis][0], made.moves[0].ends[0, n]), max(found[axis][1], made.moves[0].ends[0, n])
            assert (points[:, n] >= ends[0] - near).all(), (axis, where)
            assert (points[:, n] <= ends[1] + near).all(), (axis, where)


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
