"""Gouges and collisions of whole jobs against shapely, brute force and values by hand."""

from __future__ import annotations

import dataclasses
import math
import random
import re
from pathlib import Path

import numpy as np
import pytest
import shapely
from support.campaigns import seeds

from gproof.driver.judge import Judgement, judge
from gproof.driver.session import Running, open_session
from gproof.ir.columns import Columns
from gproof.ir.finding import Finding
from gproof.ir.machine import Tool
from gproof.ir.verdict import Verdict
from gproof.ir.workpiece import TRIANGLES, Body, Box, Cylinder, Mesh, Placed, Prism, Workpiece
from gproof.passes.checks.collisions import facets as surfaces
from gproof.passes.checks.collisions.collisions import PROBES
from gproof.passes.checks.collisions.facets import facets_of, holds
from gproof.passes.geometry.off_path import NO_TOLERANCE

from .tool_distances import least_distance

MACHINE = 'schema = "gproof-machine/1"\nunits = "mm"\n[axes.x]\n[axes.y]\n[axes.z]\n'
FLAT = Tool(number=1, length=40.0, shape="flat", diameter=6.0, flute_length=20.0, shank_diameter=6.0, stickout=50.0)
START = "G21 G17 G90 G94 G54 G40\nT1 M6\nG43\nM3 S1000\nF600\nG0 Z80\n"


def answer(
    folder: Path,
    text: str,
    given: Workpiece | None,
    *,
    name: str = "gouges",
    tool: Tool = FLAT,
    machine: str = MACHINE,
) -> tuple[Verdict, list[Finding], Judgement]:
    """The verdict of one property, its findings, and the judgement; the job begins above everything."""
    (folder / "machine.toml").write_text(machine)
    (folder / "setup.toml").write_text('schema = "gproof-setup/1"\n')
    job = folder / "job.cnc"
    job.write_text(START + text + "\nM30\n")
    session = open_session(job, machine=folder / "machine.toml", setup=str(folder / "setup.toml"), dialect="eding")
    session.setup = dataclasses.replace(session.setup, workpiece=given)
    session.machine = dataclasses.replace(session.machine, tools=(tool,))
    made = judge(session, running=Running(10**9), properties=("language", "limits", "areas", "arcs", name))
    verdict = next(result.verdict for result in made.properties if result.name == name)
    return verdict, [f for f in made.findings.kept if f.code.decides == name], made


def part(*bodies: Body, tolerance: float = 0.01) -> Workpiece:
    return Workpiece(part=tuple(Placed(name=f"part {n}", body=b) for n, b in enumerate(bodies)), tolerance=tolerance)


def fixture(*bodies: Body, clearance: float = 0.0) -> Workpiece:
    return Workpiece(
        fixtures=tuple(Placed(name=f"clamp {n}", body=b) for n, b in enumerate(bodies)), clearance=clearance
    )


def line(finding: Finding) -> int:
    return finding.span.line - START.count("\n")


def number(finding: Finding) -> float:
    """How deep, less than 0: how near."""
    values = dict(finding.values)
    near = float(str(values.get("depth", 0.0))) - float(str(values.get("distance", 0.0)))
    shown = re.search(r"(?:hits .* by|comes within|its path is) (\d+\.\d+) mm", finding.message)
    assert shown is not None and abs(float(shown[1]) - abs(near)) < 6e-4, finding.message
    return near


PLATE = Box(low=(0.0, 0.0, -10.0), high=(100.0, 50.0, 0.0))


def test_touching_is_not_cutting(tmp_path: Path) -> None:
    """The contour of a plate, floor and walls of a pocket, all at exactly the tool's radius; no depth is allowed."""
    around = (
        "G0 X-3 Y-3\nG1 Z-10\nY50\nG2 X0 Y53 R3\nG1 X100\nG2 X103 Y50 R3\nG1 Y0\nG2 X100 Y-3 R3\nG1 X0\n"
        "G2 X-3 Y0 R3\nG0 Z0\nX50 Y25"
    )
    verdict, found, _ = answer(tmp_path, around, part(PLATE, tolerance=0.0))
    assert (verdict, found) == (Verdict.UNKNOWN, found) and {f.code.number for f in found} <= {423}
    # Arcs lie beside their chords by a known amount, so that they need a depth of half a micrometre.
    verdict, found, _ = answer(tmp_path, around, part(PLATE, tolerance=0.0005))
    assert (verdict, found) == (Verdict.SAFE, [])
    straight = "G0 X-3 Y-3\nG1 Z-10\nY53\nX103\nY-3\nX-3\nG0 Z0\nX50 Y25\nX20"
    assert answer(tmp_path, straight, part(PLATE, tolerance=0.0))[0] is Verdict.SAFE
    verdict, found, _ = answer(tmp_path, straight.replace("Y53", "X-2.9999 Y53"), part(PLATE, tolerance=0.0))
    assert verdict is Verdict.UNSAFE and number(found[0]) == pytest.approx(0.000095, abs=1e-5)


def test_a_pocket_of_prisms_that_touch(tmp_path: Path) -> None:
    """Faces that two bodies share are inside the part: floor and walls are no gouge, the corner of the wall is."""
    floor = Prism(outline=((0, 0), (60, 0), (60, 60), (0, 60)), low=-10.0, high=-5.0)
    ring = Prism(
        outline=((0, 0), (60, 0), (60, 60), (0, 60)),
        holes=(((20, 20), (20, 40), (40, 40), (40, 20)),),
        low=-5.0,
        high=0.0,
    )
    inside = "G0 X30 Y30\nG1 Z-5\nX23 Y23\nX37\nY37\nX23\nY23\nG0 Z5\nX-20"
    assert answer(tmp_path, inside, part(floor, ring, tolerance=0.0))[0] is Verdict.SAFE
    verdict, found, _ = answer(tmp_path, inside.replace("Y37", "X37.02 Y37"), part(floor, ring))
    assert verdict is Verdict.UNSAFE and [line(f) for f in found] == [5]
    assert number(found[0]) == pytest.approx(0.02, abs=1e-5)
    verdict, found, _ = answer(tmp_path, inside.replace("Z-5", "Z-5.5"), part(floor, ring))
    assert verdict is Verdict.UNSAFE and line(found[0]) == 2 and number(found[0]) == pytest.approx(0.5, abs=1e-5)
    assert (found[0].span.line, len(found)) == (8, 1) and "6 more moves" in found[0].hint


@pytest.mark.parametrize("seed", seeds(5, 400))
def test_a_clamp_thinner_than_any_step_is_found(tmp_path: Path, seed: int) -> None:
    """A sheet of a micrometre, anywhere across a long move, is met; one that ends just before it is not."""
    rng = random.Random(seed)
    x0, y0, x1, y1 = (rng.uniform(-300.0, 300.0) for _ in range(4))
    share = rng.uniform(0.02, 0.98)
    length, along = math.hypot(x1 - x0, y1 - y0), math.atan2(y1 - y0, x1 - x0)
    cx, cy = x0 + share * (x1 - x0), y0 + share * (y1 - y0)
    wide = rng.uniform(1.0, 40.0)
    turn = along + rng.uniform(0.2, 3.0)
    across, thin = (math.cos(turn), math.sin(turn)), 1e-6
    begin = rng.choice([-0.5, 0.0]) * wide
    corner = [
        (cx + a * across[0] - b * across[1], cy + a * across[1] + b * across[0])
        for a, b in ((begin, 0.0), (begin + wide, 0.0), (begin + wide, thin), (begin, thin))
    ]
    clamp = Prism(outline=tuple(corner), low=0.0, high=20.0)
    way = shapely.LineString([(round(x0, 4), round(y0, 4)), (round(x1, 4), round(y1, 4))])
    move = f"G0 X{x0:.4f} Y{y0:.4f}\nZ10\nX{x1:.4f} Y{y1:.4f}\nZ80"
    verdict, found, _ = answer(tmp_path, move, fixture(clamp), name="collisions")
    assert (verdict is Verdict.UNSAFE) == (way.distance(shapely.Polygon(corner)) < 3.0), seed
    if length > 20.0:
        assert verdict is Verdict.UNSAFE and 2 <= line(found[0]) <= 4
    # Beside the way by a radius and a little.
    offset = 3.0 + rng.choice([-1e-4, 1e-4])
    aside = (-math.sin(along) * offset, math.cos(along) * offset)
    near = [
        (
            cx + aside[0] - a * math.sin(along) + b * math.cos(along),
            cy + aside[1] + a * math.cos(along) + b * math.sin(along),
        )
        for a, b in ((0.0, 0.0), (5.0, 0.0), (5.0, -thin), (0.0, -thin))
    ]
    verdict, found, _ = answer(
        tmp_path, move, fixture(Prism(outline=tuple(near), low=0.0, high=20.0)), name="collisions"
    )
    expected = way.distance(shapely.Polygon(near))
    assert (verdict is Verdict.UNSAFE) == (expected < 3.0), (seed, expected)


def star(rng: random.Random, corners: int) -> tuple[tuple[float, float], ...]:
    turns = sorted(rng.uniform(0.0, 2.0 * math.pi) for _ in range(corners))
    return tuple((r * math.cos(a), r * math.sin(a)) for a in turns for r in [rng.uniform(8.0, 30.0)])


@pytest.mark.parametrize("seed", seeds(6, 500))
def test_depth_in_prisms_is_that_of_shapely(tmp_path: Path, seed: int) -> None:
    """Lines and arcs (4096 segments) of a flat tool beside and through a prism with a hole, deep in its height."""
    rng = random.Random(seed)
    outline = star(rng, rng.randint(3, 25))
    hole = tuple((x * 0.3, y * 0.3) for x, y in reversed(outline)) if rng.random() < 0.5 else ()
    solid = shapely.Polygon(outline, [hole] if hole else None)
    if not solid.is_valid or abs(solid.area) < 1.0:
        return
    body = Prism(outline=outline, holes=(hole,) if hole else (), low=-40.0, high=30.0)
    radius, (cx, cy) = rng.uniform(2.0, 30.0), (rng.uniform(-25.0, 25.0), rng.uniform(-25.0, 25.0))
    a, sweep = rng.uniform(0.0, 6.0), rng.uniform(0.3, 6.0)
    turns = [a + sweep * k / 4096 for k in range(4097)]
    path = [(cx + radius * math.cos(t), cy + radius * math.sin(t)) for t in turns]
    (x0, y0), (x1, y1) = path[0], path[-1]
    beyond = (rng.uniform(-40.0, 40.0), rng.uniform(-40.0, 40.0))
    text = (
        f"G0 X{x0:.6f} Y{y0:.6f}\nG0 Z40\nG0 Z-20\n"
        f"G3 X{x1:.6f} Y{y1:.6f} I{cx - round(x0, 6):.6f} J{cy - round(y0, 6):.6f}\n"
        f"G1 X{beyond[0]:.6f} Y{beyond[1]:.6f}"
    )
    depth = 3.0 - shapely.LineString([*path, beyond]).distance(solid)
    verdict, found, _ = answer(tmp_path, text, part(body, tolerance=0.01))
    assert verdict is (Verdict.UNSAFE if depth > 0.01 else Verdict.SAFE), (seed, depth)
    if depth > 0.012:
        most = max(number(finding) for finding in found if finding.code.number == 420)
        # Where the axis itself goes into the body, its surface tells a part of the depth.
        assert most == pytest.approx(depth, rel=0.031, abs=5e-4) or depth == 3.0 >= most, (seed, found)


def mesh(points: np.ndarray) -> Mesh:  # type: ignore[type-arg]
    return Mesh(
        triangles=Columns(TRIANGLES, {name: points[:, k].copy() for k, name in enumerate("abc")}), source="a.stl"
    )


@pytest.mark.parametrize("seed", seeds(2, 200))
def test_depth_in_meshes_is_that_of_brute_force(tmp_path: Path, seed: int) -> None:
    """A wavy surface of triangles and tools of each shape; the greatest depth over all triangles, each searched."""
    rng = np.random.default_rng(seed)
    x = np.linspace(0.0, 20.0, 6)
    grid = np.stack([*np.meshgrid(x, x, indexing="ij"), rng.uniform(-1.0, 1.0, (6, 6))], axis=2)
    a, b, c, d = grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:], grid[:-1, 1:]
    triangles = np.concatenate([np.stack(t, axis=2).reshape(-1, 3, 3) for t in ((a, b, c), (a, c, d))])
    shape = ("flat", "ball", "bull", "vee", "drill")[seed % 5]
    tool = dataclasses.replace(
        FLAT, shape=shape, corner_radius=1.0, tip_angle=float(rng.uniform(30.0, 140.0)), tip_diameter=0.5,
        flute_length=45.0, stickout=60.0,
    )  # fmt: skip
    start, end = np.round(rng.uniform([2, 2, -0.2], [18, 18, 1.2], (2, 3)), 4)
    text = "G0 X{} Y{}\nG0 Z{}\nG1 X{} Y{} Z{}\nG0 Z80".format(*start, *end)
    surface = dataclasses.replace(mesh(triangles), closed=False)
    verdict, found, _ = answer(tmp_path, text, part(surface, tolerance=0.01), tool=tool)
    from gproof.passes.checks.tooling.tool_shape import shape_of

    piece = shape_of(tool).pieces[0]
    up = np.array([0.0, 0.0, 80.0])
    moves = [(start, end - start), (start, up - [0, 0, start[2]]), (end, up - [0, 0, end[2]])]
    least = min(least_distance(piece, one, tip, way) for one in triangles for tip, way in moves)
    assert (verdict is Verdict.UNSAFE) == (least < -0.01), (seed, least)
    if least < -0.011:
        assert max(number(f) for f in found) == pytest.approx(-least, rel=0.031, abs=2e-5), seed


def test_the_worst_move_is_the_one_that_is_told(tmp_path: Path) -> None:
    """Each move meets the same face first; the third of them goes deepest."""
    text = "G0 X20 Y20\nG1 Z-0.1\nX30 Z-0.2\nX40 Z-2.9\nX50 Z-0.1\nG0 Z80"
    big = Box(low=(-100.0, -100.0, -50.0), high=(200.0, 200.0, 0.0))
    verdict, found, _ = answer(tmp_path, text, part(big, tolerance=0.001))
    assert verdict is Verdict.UNSAFE and len(found) == 1 and line(found[0]) == 2
    assert number(found[0]) == pytest.approx(2.9, rel=0.03) and f"in line {START.count(chr(10)) + 4}" in found[0].hint


def test_a_way_from_nobody_knows_where_ends_somewhere(tmp_path: Path) -> None:
    """The first move is taken to be free, its end is not; nor is a place that only one tool stands at."""
    clamp = fixture(Box(low=(0.0, 0.0, 0.0), high=(20.0, 20.0, 20.0)))
    for text in ("G0 X{} Y10 Z5", "G0 X{} Y10 Z5\nM0", "G0 X{} Y10\nZ5", "G1 X{} Y10 Z5", "G0 X{} Y10 Z5\nT2 M6"):
        for x, verdict in ((10.0, Verdict.UNSAFE), (-3.01, Verdict.SAFE)):
            job = tmp_path / "job.cnc"
            (tmp_path / "machine.toml").write_text(MACHINE)
            (tmp_path / "setup.toml").write_text('schema = "gproof-setup/1"\ntool = 1\n')
            job.write_text("G21 G17 G90 G94 G54 G40 F600 M3 S1000\n" + text.format(x) + "\nM30\n")
            session = open_session(
                job, machine=tmp_path / "machine.toml", setup=str(tmp_path / "setup.toml"), dialect="eding"
            )
            session.setup = dataclasses.replace(session.setup, workpiece=clamp)
            session.machine = dataclasses.replace(
                session.machine, tools=(dataclasses.replace(FLAT, holder=((40.0, 40.0, 30.0),)),)
            )
            made = judge(session, running=Running(10**9), properties=("language", "collisions"))
            said = next(result.verdict for result in made.properties if result.name == "collisions")
            if "G1" in text and verdict is Verdict.SAFE:
                verdict = Verdict.UNKNOWN  # a feed from nobody knows where
            assert said is verdict, (text, x)


def test_a_surface_is_made_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Both properties ask of the part; what each finds is its own."""
    made: list[int] = []
    original = surfaces.facets_of
    monkeypatch.setattr(surfaces, "facets_of", lambda body: (made.append(id(body)), original(body))[1])
    post = fixture(Cylinder(x=20.0, y=20.0, radius=4.0, low=0.0, high=30.0))
    given = dataclasses.replace(part(PLATE, cube(-6.0, 5.5)), fixtures=post.fixtures)
    (tmp_path / "machine.toml").write_text(MACHINE)
    (tmp_path / "setup.toml").write_text('schema = "gproof-setup/1"\n')
    job = tmp_path / "job.cnc"
    job.write_text(START + "G0 X20 Y20\nG1 Z-1\nX30\nG0 Z80\nM30\n")
    told = []
    for names in (("gouges", "collisions"), ("gouges",), ("collisions",)):
        made.clear()
        session = open_session(
            job, machine=tmp_path / "machine.toml", setup=str(tmp_path / "setup.toml"), dialect="eding"
        )
        session.setup = dataclasses.replace(session.setup, workpiece=given)
        session.machine = dataclasses.replace(session.machine, tools=(FLAT,))
        found = judge(session, running=Running(10**9), properties=names).findings.kept
        assert len(made) == len(set(made)) > 0
        told.append({f.message for f in found if f.code.decides in ("gouges", "collisions")})
    assert told[0] == told[1] | told[2] and told[1] and told[2]


def cube(low: float, high: float) -> Mesh:
    corners, _ = facets_of(Box(low=(low, low, low), high=(high, high, high)))
    four = corners.reshape(-1, 4, 3)
    four[4] = four[4, ::-1].copy()
    return mesh(np.concatenate([four[:, [0, 1, 2]], four[:, [0, 2, 3]]]))


def test_a_tool_that_begins_inside_is_found(tmp_path: Path) -> None:
    """It crosses no surface; the place where it begins tells."""
    ball = Tool(number=1, length=40.0, shape="ball", diameter=2.0, flute_length=6.0, shank_diameter=2.0, stickout=8.0)
    text = "G0 X0 Y0\nM0\nG0 X1"
    for body in (
        Box(low=(-50.0, -50.0, 40.0), high=(50.0, 50.0, 120.0)), cube(-130.0, 130.0),
        Prism(outline=((-50, -50), (50, -50), (50, 50), (-50, 50)), low=40.0, high=130.0),
        Cylinder(x=0.0, y=0.0, radius=50.0, low=40.0, high=130.0),
    ):  # fmt: skip
        verdict, found, _ = answer(tmp_path, text, part(body), tool=ball)
        assert verdict is Verdict.UNSAFE and found, body
        assert any("inside" in f.message for f in found) or isinstance(body, Cylinder)
    opened = dataclasses.replace(cube(-130.0, 130.0), closed=False)
    assert answer(tmp_path, text, part(opened), tool=ball)[0] is Verdict.UNKNOWN


def test_points_in_bodies(tmp_path: Path) -> None:
    rng = np.random.default_rng(1)
    ring = Prism(
        outline=((0, 0), (9, 0), (9, 9), (4, 3), (0, 9)), holes=(((1, 1), (1, 2), (3, 2), (3, 1)),), low=0.0, high=2.0
    )
    area = shapely.Polygon(ring.outline, ring.holes)
    for x, y, z in rng.uniform(-1.0, 10.0, (400, 3)):
        assert holds(ring, (x, y, z)) == (area.contains(shapely.Point(x, y)) and 0.0 < z < 2.0)
        assert holds(cube(2.0, 6.0), (x, y, z)) == all(2.0 < v < 6.0 for v in (x, y, z))
    corners, _ = facets_of(ring)
    flat = [shapely.Polygon(four[:, :2]) for four in corners.reshape(-1, 4, 3) if (four[:, 2] == 2.0).all()]
    assert shapely.unary_union(flat).symmetric_difference(area).area < 1e-9


def test_shank_and_holder(tmp_path: Path) -> None:
    """A thick shank beside a wall that the cutter only touches; the holder over a plate that is higher."""
    wall = Box(low=(10.0, -50.0, -60.0), high=(20.0, 50.0, 0.0))
    thick = dataclasses.replace(FLAT, shank_diameter=8.0, holder=((40.0, 40.0, 30.0),))
    far = Placed(name="far", body=Box(low=(900.0, 0.0, 0.0), high=(901.0, 1.0, 1.0)))
    given = dataclasses.replace(part(wall), fixtures=(far,))
    text = "G0 X7 Y-60\nG1 Z-30\nY60\nG0 Z80"
    assert answer(tmp_path, text, part(wall), tool=thick)[0] is Verdict.SAFE
    verdict, found, _ = answer(tmp_path, text, given, name="collisions", tool=thick)
    assert verdict is Verdict.UNSAFE and [f.code.number for f in found] == [422]
    assert "shank" in found[0].message and number(found[0]) == pytest.approx(1.0, abs=1e-5)
    verdict, found, _ = answer(tmp_path, text.replace("Z-30", "Z-51"), given, name="collisions", tool=thick)
    assert {("shank" in f.message, "holder" in f.message) for f in found} == {(True, False), (False, True)}
    thin = dataclasses.replace(thick, shank_diameter=6.0)
    assert answer(tmp_path, text, given, name="collisions", tool=thin)[0] is Verdict.SAFE


def test_what_is_not_stated_of_a_tool(tmp_path: Path) -> None:
    """All of space above what is stated may be tool: nothing is said to be clear of it."""
    clamp = Box(low=(10.0, -50.0, 0.0), high=(20.0, 50.0, 60.0))
    text = "G0 X0 Y0\nZ5\nY10\nG0 Z80"
    assert answer(tmp_path, text, fixture(clamp), name="collisions")[0] is Verdict.UNKNOWN
    lower = dataclasses.replace(clamp, high=(20.0, 50.0, 79.0))
    stated = dataclasses.replace(FLAT, holder=((10.0, 10.0, 30.0),))
    assert answer(tmp_path, text, fixture(lower), name="collisions", tool=stated)[0] is Verdict.SAFE
    bare = Tool(number=1, length=40.0)
    verdict, found, _ = answer(tmp_path, text, fixture(clamp), name="collisions", tool=bare)
    assert verdict is Verdict.UNKNOWN and "gives no shape" in found[0].message
    assert (
        answer(tmp_path, text.replace("Z5", "Z60.1"), fixture(clamp), name="collisions", tool=bare)[0] is Verdict.SAFE
    )
    assert answer(tmp_path, text, part(clamp), tool=bare)[0] is Verdict.UNKNOWN


def test_clearance(tmp_path: Path) -> None:
    """0.9 mm beside a post of 2 mm radius; the arc around it at 1.1 mm."""
    post = Cylinder(x=0.0, y=0.0, radius=2.0, low=0.0, high=20.0)
    text = "G0 X-5.9 Y-30\nZ10\nY30\nZ80"
    assert answer(tmp_path, text, fixture(post, clearance=0.89), name="collisions")[0] is Verdict.SAFE
    verdict, found, _ = answer(tmp_path, text, fixture(post, clearance=1.0), name="collisions")
    assert verdict is Verdict.UNSAFE and number(found[0]) == pytest.approx(-0.9, abs=1e-5)
    assert [v for k, v in found[0].values if k in "xyz"] == pytest.approx([-5.9, 0.0, 10.0], abs=1e-2)
    around = "G0 X6.1 Y0\nZ10\nG3 X6.1 Y0 I-6.1\nG0 Z80"
    assert answer(tmp_path, around, fixture(post, clearance=1.099), name="collisions")[0] is Verdict.SAFE
    assert answer(tmp_path, around, fixture(post, clearance=1.101), name="collisions")[0] is Verdict.UNSAFE


def test_what_the_controller_may_do_is_charged(tmp_path: Path) -> None:
    """Beside a wall by 0.05 mm; with G64 P0.1 the tool may leave its path by 0.1."""
    text = "G64 P{}\nG0 X-3.05 Y-20\nZ-5\nG1 Y70\nG0 Z80"
    assert answer(tmp_path, text.format(0.055), part(PLATE))[0] is Verdict.SAFE
    verdict, found, _ = answer(tmp_path, text.format(0.1), part(PLATE))
    assert verdict is Verdict.UNKNOWN and [f.code.number for f in found] == [423]
    assert answer(tmp_path, text.format(0.1).replace("3.05", "2.9"), part(PLATE))[0] is Verdict.UNSAFE
    drawn = Prism(outline=((0, 0), (100, 0), (100, 50), (0, 50)), low=-10.0, high=0.0, error=0.1)
    assert answer(tmp_path, text.format(0), part(drawn))[0] is Verdict.UNKNOWN


def test_traverses_that_are_no_straight_lines(tmp_path: Path) -> None:
    """A clamp in the corner of the box between the ends of a traverse: UNKNOWN; at its end: UNSAFE."""
    corner = Box(low=(40.0, -2.0, 0.0), high=(52.0, 2.0, 20.0))
    text = "G0 X0 Y0\nZ10\nX50 Y50\nZ80"
    assert answer(tmp_path, text, fixture(corner), name="collisions")[0] is Verdict.SAFE
    any_way = MACHINE + "[controller]\nstraight_traverse = false\n"
    verdict, found, _ = answer(tmp_path, text, fixture(corner), name="collisions", machine=any_way)
    assert verdict is Verdict.UNKNOWN and [line(f) for f in found] == [3] and "straight" in found[0].message
    moved = Box(low=(49.0, 49.0, 0.0), high=(52.0, 52.0, 20.0))
    assert answer(tmp_path, text, fixture(moved), name="collisions", machine=any_way)[0] is Verdict.UNSAFE
    one = text.replace("X50 Y50", "X50\nY50")
    assert answer(tmp_path, one, fixture(corner), name="collisions", machine=any_way)[0] is Verdict.UNSAFE


def test_both_speeds_tell_the_same(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Lines, arcs and a helix through a mesh, a prism and a cylinder: every number of every finding."""
    ring = Prism(outline=star(random.Random(3), 9), low=-20.0, high=2.0, error=0.01)
    post = fixture(Cylinder(x=20.0, y=20.0, radius=4.0, low=0.0, high=30.0))
    given = dataclasses.replace(part(ring, cube(-6.0, 5.5)), fixtures=post.fixtures, clearance=1.0)
    text = "G64 P0.02\nG0 X30 Y0\nG0 Z3\nG2 X-20 Y10 Z-3 R30\nG1 X0 Y-10\nG3 X10 Y0 I5 J8\nG1 X22 Y22 Z2\nG0 Z80"
    for name in ("gouges", "collisions"):
        told = []
        for speed in ("python", "numba"):
            monkeypatch.setenv("GPROOF_KERNELS", speed)
            verdict, found, _ = answer(tmp_path, text, given, name=name)
            told.append((verdict, [(f.code.label, f.span.line, f.message, f.hint, f.values) for f in found]))
        assert told[0] == told[1] and len(told[0][1]) > 1


def test_what_the_answer_stands_on(tmp_path: Path) -> None:
    """A probe that goes for the plate; G64 without P."""
    verdict, _, made = answer(tmp_path, "G64\nG0 X50 Y25\nG0 Z5\nG38.2 Z-5 F100\nG0 Z80", part(PLATE))
    result = next(r for r in made.properties if r.name == "gouges")
    assert {PROBES, NO_TOLERANCE} <= set(result.assumptions)
    assert verdict is not Verdict.UNSAFE
    assert answer(tmp_path, "G0 X50 Y25\nG0 Z5\nG1 Z-5 F100\nG0 Z80", part(PLATE))[0] is Verdict.UNSAFE


def test_what_is_not_known_is_said(tmp_path: Path) -> None:
    """No part, no fixtures; a place that is not known and not high enough."""
    verdict, found, _ = answer(tmp_path, "G0 X0 Y0", None)
    assert verdict is Verdict.UNKNOWN and "gives no finished part" in found[0].message
    assert answer(tmp_path, "G0 X0 Y0", None, name="collisions")[0] is Verdict.UNKNOWN
    unknown = "G0 X0 Y0\nG55\nG0 Z-1\nX1\nG54\nG0 X0 Y0"
    verdict, found, _ = answer(tmp_path, unknown, part(PLATE))
    assert verdict is Verdict.UNKNOWN and "unknown" in found[0].message
    verdict, _, made = answer(tmp_path, "G0 X0 Y0\nG0 X1", part(PLATE))
    assert verdict is Verdict.SAFE
    result = next(r for r in made.properties if r.name == "gouges")
    assert any("start position of the axes" in text for text in result.assumptions)
