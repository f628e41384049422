"""Proofs of distance against distances that were found another way, and against themselves in the other speed."""

from __future__ import annotations

import inspect
import math
import types
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.campaigns import seeds

from gproof.ir.columns import Columns
from gproof.ir.machine import Tool
from gproof.ir.workpiece import TRIANGLES, Box, Cylinder, Mesh, Placed
from gproof.passes.checks.collisions import distance_kernels, sweep_kernels
from gproof.passes.checks.collisions import scene as distance_scene
from gproof.passes.checks.collisions.distance_kernels import separation
from gproof.passes.checks.collisions.facets import Surface
from gproof.passes.checks.collisions.scene import GAP, Ladder, Scene
from gproof.passes.checks.collisions.sweep_kernels import chords, raster
from gproof.passes.checks.tooling import tool_shape
from gproof.passes.checks.tooling.tool_shape import CUTTER, HOLDER, SHANK, UNSTATED, Piece, Shape, grown, shape_of

from .tool_distances import Case, random_case, random_piece, random_tool, signed_distance, wrong


@pytest.mark.parametrize("seed", seeds(1, 40))
def test_answers_are_proofs(seed: int) -> None:
    """Clear is never said of what is nearer; what is said to be near has a point of the triangle that is."""
    rng = np.random.default_rng(seed)
    ask, opened = separation.compiled(), 0
    for n in range(150):
        case = random_case(rng)
        problem = wrong(case, ask, grown)
        opened += problem == "open"
        assert problem in ("", "open"), f"seed {seed}, case {n}: {problem}\n{case}"
    assert opened <= 2


def cases(count: int, seed: int) -> list[Case]:
    rng = np.random.default_rng(seed)
    return [random_case(rng) for _ in range(count)]


def test_both_speeds_agree_bit_for_bit() -> None:
    for case in cases(120, 7):
        body = grown(case.piece, case.limit)
        if body is None:
            continue
        rims = np.zeros((3, 2))
        rims[: len(body[0])] = body[0]
        corners = np.concatenate([case.triangle, case.triangle[2:]]).reshape(1, 12)
        seen = []
        for ask in (separation.python, separation.compiled()):
            work = (np.zeros((4, 9)), np.zeros(4), np.zeros(4), np.zeros(7))
            answer = ask(corners, 0, 0.5, case.tip, case.way, rims, len(body[0]), body[1], 1e-6, case.boxed, *work)
            seen.append((answer, work[3].tobytes()))
        assert seen[0] == seen[1]


MUTATIONS = [
    (distance_kernels, "vz -= min(max(vz, rims[0, 1]), rims[count - 1, 1])", "vz -= rims[0, 1]", False),
    (distance_kernels, "/ size > r + ROUNDING", "> r + ROUNDING", True),
    (distance_kernels, "size < r + gap - ROUNDING", "size < r + 0.01", True),
    (distance_kernels, "elif vx * dx + vy * dy + vz * dz > 0.0", "elif vx * dx + vy * dy + vz * dz < 0.0", True),
    (distance_kernels, "ty = dy if vy * dy > 0.0 else 0.0", "ty = 0.0", True),
    (distance_kernels, "along = rims[k, 0] * flat + rims[k, 1] * vz", "along = rims[k, 0] + rims[k, 1] * vz", True),
    (distance_kernels, "bx, by = rims[rim, 0] * (vx / flat)", "bx, by = -rims[rim, 0] * (vx / flat)", True),
    (distance_kernels, "if k == 0 or along < best", "if k == 0 or along > best", True),
    (
        distance_kernels,
        "for k in range(4):\n            along = vx",
        "for k in range(2):\n            along = vx",
        True,
    ),
    (distance_kernels, "t = min(1.0, max(0.0, -(ax", "t = min(1.0, max(0.0, (ax", True),
    (distance_kernels, "fz - pz - tz - bz", "fz - pz - tz + bz", True),
    (distance_kernels, "+= weights[k] * points[k, 3 + m]", "+= points[k, 3 + m]", True),
    (tool_shape, "- depth * math.sqrt(1.0 + slope * slope)", "- depth", True),
    (tool_shape, "depth = -by - piece.rounding", "depth = -by", True),
    (tool_shape, "piece.rounding + by", "piece.rounding - by", True),
    (tool_shape, "piece.rims[-1][1] - depth", "piece.rims[-1][1] + depth", True),
    (tool_shape, "cross = (a1 - a0) / (s0 - s1)", "cross = (a1 - a0) / (s1 - s0)", True),
    (tool_shape, "bottom = max(bottom, -at / slope)", "bottom = bottom", True),
]


def mutated(module: types.ModuleType, old: str, new: str) -> dict[str, Any]:
    """The names of a module with one piece of its text replaced."""
    text = inspect.getsource(module)
    assert text.count(old) == 1, f"{old!r} stands {text.count(old)} times in {module.__name__}"
    names: dict[str, Any] = {"__name__": module.__name__, "__file__": str(Path(module.__file__ or ""))}
    exec(compile(text.replace(old, new), "mutated", "exec"), names)
    return names


def test_mutated_formulas_are_caught() -> None:
    """Each changed formula gives an answer that one of the cases refutes; where it only costs steps, none does."""
    given = cases(120, 11)
    plain = [case for case in given if not wrong(case, separation.python, grown)]
    assert len(plain) >= len(given) - 1
    for module, old, new, counts in MUTATIONS:
        names = mutated(module, old, new)
        ask = names["separation"].python if "separation" in names else separation.python
        make = names.get("grown", grown)
        with np.errstate(all="ignore"):
            caught = any(_refuted(case, ask, make) for case in plain) or body_problem(make) != ""
        assert caught == counts, old


def _refuted(case: Case, ask: Any, make: Any) -> bool:
    try:
        return bool(wrong(case, ask, make))
    except (ZeroDivisionError, ValueError, IndexError, FloatingPointError):
        return True


def soup(rng: np.random.Generator) -> Surface:
    """A hundred triangles below and beside a table, a cylinder and a box among them."""
    corners = rng.normal(size=(100, 1, 3)) * [40.0, 40.0, 6.0] + rng.normal(size=(100, 3, 3)) * rng.uniform(0.5, 8.0)
    corners[:20, :, 2] = corners[:20, :1, 2]
    columns = Columns(TRIANGLES, {name: corners[:, k] for k, name in enumerate("abc")})
    bodies = (
        Mesh(triangles=columns), Cylinder(x=20.0, y=-10.0, radius=7.0, low=-20.0, high=3.0),
        Box(low=(-60.0, -60.0, -30.0), high=(-50.0, 20.0, 1.0)),
    )  # fmt: skip
    return Surface([Placed(name=f"body {n}", body=body) for n, body in enumerate(bodies)])


def contacts(scene: Scene, shape: Shape, moves: Any) -> list[bool]:
    """Whether each move alone is found to be too near to anything."""
    out, zero = [], np.zeros(1)
    for start, end, slack, boxed in moves:
        before = int(scene._now[2])
        scene._tool = None
        scene.sweep(1, shape, start[None], end[None], np.array([slack]), zero, np.array([[0, 0, boxed]]))
        out.append(int(scene._now[2]) > before)
    return out


def scenes(seed: int) -> Any:
    """Random scenes, the moves in them, and whether any facet at all is too near, asked one by one."""
    rng = np.random.default_rng(seed)
    surface = soup(rng)
    for _ in range(6):
        shape = shape_of(random_tool(rng))
        if shape.problem:
            continue
        limit = float(rng.choice([-0.5, -0.01, 0.0, 2.0]))
        parts = (CUTTER, SHANK, HOLDER)
        ladder = Scene(1, parts, limit, surface).ladder(1, shape)
        moves, expected = [], []
        for _ in range(25):
            start = rng.normal(size=3) * 40.0
            start[2] = rng.uniform(-5.0, 25.0)
            end = start + rng.normal(size=3) * rng.choice([0.5, 10.0, 60.0]) * [1.0, 1.0, rng.choice([0.0, 0.3])]
            slack = float(rng.choice([0.0, 4.0]))
            boxed = int(rng.random() < 0.2)
            moves.append((start, end, slack, boxed))
            expected.append(any(touches(surface, ladder, start, end, slack, boxed)))
        yield surface, parts, limit, shape, moves, expected


def touches(surface: Surface, ladder: Ladder, start: Any, end: Any, slack: float, boxed: int) -> Iterator[bool]:
    ask, work = separation.compiled(), (np.zeros((4, 9)), np.zeros(4), np.zeros(4), np.zeros(7))
    for j in range(len(ladder.pieces)):
        for f in range(len(surface.corners) if ladder.levels[j] else 0):
            yield ask(
                surface.corners, f, surface.disc[f], start, end - start, ladder.rims[j, 0], ladder.counts[j, 0],
                ladder.rounds[j, 0] + slack, GAP, boxed, *work,
            ) != -1  # fmt: skip


CULLING = [
    ("half = 0.7072 * cell", "half = 0.0"),
    ("reach = broad + most", "reach = inner + most"),
    ("most = rounds[j, 0] + slack[move] + widest", "most = rounds[j, 0] + widest"),
    ("lowest = min(p[2], p[2] + d[2])", "lowest = p[2]"),
    ("min(h, h + ha + hb + hc)", "h"),
    ("min(above, axial - radial)", "max(above, axial - radial)"),
    ("max(p[0], p[0] + d[0]) + reach", "max(p[0], p[0] + d[0])"),
    ("low = bottom - math.sqrt(", "low = bottom + math.sqrt("),
    ("abs(my - 0.5 * d[1])", "abs(my)"),
    ("min(0.0, ha) + min(0.0, hb)", "min(0.0, ha + hb)"),
    ("if stamp[f] == now[0]:", "if stamp[f] != now[0] - 1 and f > 3:"),
]


@pytest.mark.parametrize("seed", seeds(1, 15))
def test_nothing_is_overlooked_by_the_cells(seed: int) -> None:
    """The kernel with its grid finds what asking of every facet finds, no more and no less."""
    seen = 0
    for surface, parts, limit, shape, moves, expected in scenes(seed):
        scene = Scene(1, parts, limit, surface)
        assert contacts(scene, shape, moves) == expected, (seed, shape)
        seen += sum(expected)
    assert 20 < seen < 130


def test_mutated_short_cuts_are_caught(monkeypatch: pytest.MonkeyPatch) -> None:
    given = [case for seed in (1, 3, 6) for case in scenes(seed)]
    for old, new in CULLING:
        monkeypatch.setattr(distance_scene, "sweep", mutated(sweep_kernels, old, new)["sweep"])
        monkeypatch.setenv("GPROOF_KERNELS", "python")
        caught = any(
            contacts(Scene(1, parts, limit, surface), shape, moves) != expected
            for surface, parts, limit, shape, moves, expected in given
        )
        assert caught, old


def test_both_speeds_of_the_sweep_find_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    for surface, parts, limit, shape, moves, _ in scenes(4):
        start, end = (np.array([move[k] for move in moves]) for k in (0, 1))
        slack = np.array([move[2] for move in moves])
        place = np.array([[n, 10 * n, move[3]] for n, move in enumerate(moves)])
        seen = []
        for speed in ("python", "numba"):
            monkeypatch.setenv("GPROOF_KERNELS", speed)
            scene = Scene(1, parts, limit, surface)
            scene.sweep(1, shape, start, end, slack, np.zeros(len(moves)), place)
            seen.append((scene._whole.tobytes(), scene._real.tobytes()))
        assert seen[0] == seen[1]


def body_problem(make: Any) -> str:
    """Points of the body that lies ``by`` inside are at least that deep, and those of its rims exactly so."""
    rng = np.random.default_rng(3)
    for _ in range(400):
        piece = random_piece(rng)
        by = -float(rng.uniform(0.0, 0.4)) * max(r + piece.rounding for r, _ in piece.rims)
        body = make(piece, by)
        if body is None:
            continue
        rims, rounding = body
        if [z for _, z in rims] != sorted(z for _, z in rims):
            return f"{by} inside {piece}: {rims}"
        turn = rng.uniform(0.0, 2.0 * math.pi, len(rims))
        points = np.array([(r * math.cos(a), r * math.sin(a), z) for (r, z), a in zip(rims, turn, strict=True)])
        depth = -signed_distance(piece, points)
        if (depth < -by + rounding - 1e-9).any() or (by < -piece.rounding and (depth > -by + 1e-9).any()):
            return f"{by} inside {piece}: {depth}"
        points = rng.uniform(-1.0, 1.0, (200, 3)) * [rims[-1][0] + rounding, rims[-1][0] + rounding, 0.0]
        points[:, 2] = rng.uniform(rims[0][1] - rounding, rims[-1][1] + rounding, 200)
        deep = points[signed_distance(piece, points) < by - 1e-9]
        if len(deep) and signed_distance(Piece(part=CUTTER, rims=rims, rounding=rounding), deep).max() > 1e-9:
            return f"{by} inside {piece}: something is missing"
    return ""


def test_bodies_within_a_piece() -> None:
    assert body_problem(grown) == ""


def test_shapes_by_hand() -> None:
    flat = shape_of(Tool(number=1, shape="flat", diameter=6.0, flute_length=20.0, shank_diameter=4.0, stickout=30.0))
    cutter, shank, bridge, rest = flat.pieces
    assert (cutter.part, cutter.rims, cutter.rounding) == (CUTTER, ((3.0, 0.0), (3.0, 20.0)), 0.0)
    assert (shank.part, shank.rims) == (SHANK, ((2.0, 20.0), (2.0, 30.0)))
    assert (bridge.part, bridge.rims, bridge.joint) == (SHANK, ((2.0, 0.0), (2.0, 30.0)), 20.0)
    assert (rest.part, rest.rims[0][1]) == (UNSTATED, 30.0)
    assert grown(cutter, -0.5) == (((2.5, 0.5), (2.5, 19.5)), 0.0)
    assert grown(cutter, 0.5) == (cutter.rims, 0.5)
    assert grown(cutter, -3.01) is None
    ball = shape_of(Tool(number=1, shape="ball", diameter=6.0, flute_length=20.0)).pieces[0]
    assert (ball.rims, ball.rounding, ball.tip) == (((0.0, 3.0), (0.0, 20.0)), 3.0, 0.0)
    assert grown(ball, -3.1) is None
    # 90 degrees: the cone is as high as wide; a body 1 mm inside begins 1.4142 mm above the tip.
    vee = shape_of(Tool(number=1, shape="vee", diameter=6.0, tip_angle=90.0, flute_length=20.0)).pieces[0]
    assert vee.rims == ((0.0, 0.0), (3.0, pytest.approx(3.0)), (3.0, 20.0))
    inner = grown(vee, -1.0)
    assert inner is not None
    root = math.sqrt(2.0)
    assert [v for rim in inner[0] for v in rim] == pytest.approx([0.0, root, 2.0, 2.0 + root, 2.0, 19.0])
    assert "shape" in shape_of(Tool(number=4, diameter=6.0)).problem
    assert "corner radius" in shape_of(Tool(number=4, shape="bull", diameter=6.0)).problem
    assert "tip angle" in shape_of(Tool(number=4, shape="vee", diameter=6.0)).problem
    drill = shape_of(Tool(number=4, shape="drill", diameter=6.0, flute_length=30.0))
    assert drill.pieces[0].rims[0] == (3.0, 0.0) and "flat end" in drill.assumed[0]
    # Nothing is stated of what is above the tip.
    bare = shape_of(Tool(number=4, shape="flat", diameter=6.0))
    assert bare.pieces[-1].part == UNSTATED and bare.pieces[-1].tip == 0.0
    assert Piece(part=CUTTER, rims=((1.0, 0.0), (1.0, 1.0))) != bare.pieces[0]


def test_what_lies_across_a_joint() -> None:
    """A sheet deep in shank and holder, in neither as deep as allowed; and nothing of a clearance is the other's."""
    tool = Tool(
        number=1, shape="flat", diameter=6.0, flute_length=10.0, shank_diameter=20.0, stickout=30.0,
        holder=((20.0, 20.0, 10.0),),
    )  # fmt: skip
    shape = shape_of(tool)
    for depth, height in ((0.0, 30.0), (0.001, 30.0), (0.7, 30.4), (3.0, 29.0), (3.0, 31.0)):
        sheet = Box(low=(0.0, -1.0, height), high=(50.0, 1.0, height + 1e-6))
        table = Scene(1, (SHANK, HOLDER, UNSTATED), -depth, Surface([Placed(name="sheet", body=sheet)]))
        assert contacts(table, shape, [(np.array([9.0 - depth, 0.0, 0.0]), np.array([9.0 - depth, 0.0, 0.0]), 0.0, 0)])
        outside = np.array([-10.0 + 0.999 * depth, 0.0, 0.0])
        assert contacts(table, shape, [(outside, outside, 0.0, 0)]) == [False]
    plate = Box(low=(0.0, 0.0, 0.0), high=(1.0, 1.0, 9.9))
    table = Scene(1, (CUTTER, SHANK), 0.5, Surface([Placed(name="plate", body=plate)]))
    assert all(piece.joint is None for piece in table.ladder(1, shape).pieces)


def arcs(rng: np.random.Generator, count: int) -> tuple[Any, ...]:
    """Random arcs and helices in all planes, with ends that are a little off their radius."""
    plane = rng.integers(1, 4, count).astype(np.uint8)
    turns = (rng.integers(1, 4, count) * rng.choice([-1, 1], count)).astype(np.int32)
    center = rng.normal(size=(count, 3)) * 20.0
    radius, a, b = 10.0 ** rng.uniform(-2.0, 2.0, count), rng.uniform(0, 7, count), rng.uniform(0, 7, count)
    start, end = center.copy(), center.copy()
    for n in range(count):
        u, v, h = ((0, 1, 2), (2, 0, 1), (1, 2, 0))[plane[n] - 1]
        start[n, [u, v]] += radius[n] * np.array([math.cos(a[n]), math.sin(a[n])])
        end[n, [u, v]] += (radius[n] + rng.uniform(-0.002, 0.002)) * np.array([math.cos(b[n]), math.sin(b[n])])
        end[n, h] += rng.choice([0.0, 5.0, -40.0])
    return np.full(count, 3, dtype=np.uint8), start, end, center, turns, plane


def test_chords_lie_beside_their_arcs_by_no_more_than_they_say() -> None:
    """Points of the arc, by its definition, and the chords of the kernel; both speeds give the same bytes."""
    rng = np.random.default_rng(5)
    op, start, end, center, turns, plane = arcs(rng, 60)
    for n in range(len(op)):
        one = slice(n, n + 1)
        made = []
        for run in (chords.python, chords.compiled()):
            places, points, sag, rows = (
                np.zeros(1, np.int64),
                np.zeros((20000, 6)),
                np.zeros(20000),
                np.zeros(20000, np.int64),
            )
            count = run(
                op[one], start[one], end[one], center[one], turns[one], plane[one], 1e-3, 0, places, points, sag, rows
            )
            assert places[0] == 1
            made.append((count, points[:count].tobytes(), sag[:count].tobytes()))
        assert made[0] == made[1]
        points, sag = points[:count], sag[:count]
        assert (points[0, :3] == start[n]).all() and (points[-1, 3:] == end[n]).all()
        assert (points[1:, :3] == points[:-1, 3:]).all() and sag.max() <= 2.0e-3 + 1e-8
        u, v, h = ((0, 1, 2), (2, 0, 1), (1, 2, 0))[plane[n] - 1]
        first, last = start[n, [u, v]] - center[n, [u, v]], end[n, [u, v]] - center[n, [u, v]]
        sign = 1.0 if turns[n] > 0 else -1.0
        sweep = (math.atan2(last[1], last[0]) - math.atan2(first[1], first[0])) * sign % (2.0 * math.pi)
        sweep += (abs(int(turns[n])) - 1) * 2.0 * math.pi
        for share in rng.uniform(0.0, 1.0, 300):
            angle = math.atan2(first[1], first[0]) + sign * sweep * share
            r = math.hypot(*first) * (1.0 - share) + math.hypot(*last) * share
            at = np.zeros(3)
            at[u], at[v] = center[n, u] + r * math.cos(angle), center[n, v] + r * math.sin(angle)
            at[h] = start[n, h] + (end[n, h] - start[n, h]) * share
            k = min(int(share * count), count - 1)
            a, way = points[k, :3], points[k, 3:] - points[k, :3]
            t = min(1.0, max(0.0, float((at - a) @ way) / max(float(way @ way), 1e-300)))
            assert math.dist(at, a + t * way) <= sag[k], (n, share)


def test_every_facet_is_in_the_cells_that_it_lies_over() -> None:
    rng = np.random.default_rng(9)
    corners = rng.normal(size=(80, 4, 3)) * 12.0
    corners[:, 3] = corners[:, 2]
    flat = np.ascontiguousarray(corners.reshape(-1, 12))
    disc = np.zeros(80)
    cells = []
    for run in (raster.python, raster.compiled()):
        first, top = np.zeros(31 * 29 + 1, dtype=np.int64), np.full(31 * 29, -np.inf)
        total = run(flat, disc, -31.0, -29.0, 2.0, 31, 29, first, np.zeros(0, dtype=np.int64), top, 0)
        first, items = np.cumsum(first), np.zeros(total, dtype=np.int64)
        ends = first.copy()
        run(flat, disc, -31.0, -29.0, 2.0, 31, 29, ends, items, top, 1)
        cells.append([items[first[c] : first[c + 1]].tolist() for c in range(31 * 29)])
    assert cells[0] == cells[1]
    for f in range(80):
        weights = rng.dirichlet([1.0, 1.0, 1.0], 200)
        for x, y, z in weights @ corners[f, :3]:
            i, j = math.floor((x + 31.0) / 2.0), math.floor((y + 29.0) / 2.0)
            if 0 <= i < 31 and 0 <= j < 29:
                assert f in cells[0][j * 31 + i] and top[j * 31 + i] >= z - 1e-12
