"""Random moves of random tools over hills, cones, domes, fins and tilted blocks, and what both have in common."""

from __future__ import annotations

import itertools
import random
import struct
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from manifold3d import Manifold

from .swept_tools import NOTHING, Floats, Solid, meets, solid_of, swept, triangles_of
from .table_jobs import Piece, ToolOf, a_tool, num

MACHINE = (
    'schema = "gproof-machine/1"\nunits = "mm"\n[axes.x]\n[axes.y]\n[axes.z]\n[controller]\nstraight_traverse = true\n'
)
HIGH = 300.0


def hills(rng: random.Random) -> Manifold:
    """A wavy surface over a square, closed below."""
    n, wide = rng.randint(4, 26), rng.uniform(10.0, 40.0)
    at = np.linspace(-wide / 2.0, wide / 2.0, n)
    x, y = np.meshgrid(at, at, indexing="ij")
    z = np.zeros_like(x)
    for _ in range(rng.randint(1, 6)):
        cx, cy, size = rng.uniform(-wide, wide) / 2, rng.uniform(-wide, wide) / 2, rng.uniform(1.0, wide / 2)
        z += rng.uniform(-4.0, 6.0) * np.exp(-((x - cx) ** 2 + (y - cy) ** 2) / size**2)
    low = float(z.min()) - 5.0
    top, base = np.stack([x, y, z], axis=2), np.stack([x, y, np.full_like(z, low)], axis=2)
    faces = []
    for grid, way in ((top, 1), (base, -1)):
        a, b, c, d = grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:], grid[:-1, 1:]
        for corners in ((a, b, c), (a, c, d)):
            faces.append(np.stack(corners[::way], axis=2).reshape(-1, 3, 3))
    around = [(k, 0) for k in range(n)] + [(n - 1, k) for k in range(1, n)]
    around += [(k, n - 1) for k in range(n - 2, -1, -1)] + [(0, k) for k in range(n - 2, 0, -1)]
    for one, two in zip(around, [*around[1:], around[0]], strict=True):
        a, b, c, d = base[one], base[two], top[two], top[one]
        faces.append(np.array([[a, b, c], [a, c, d]]))
    return solid_of(np.concatenate(faces))


def a_relief(rng: random.Random) -> Manifold:
    kind = rng.choice(["hills", "hills", "cone", "dome", "block", "fin", "ring", "spike", "shell", "tunnel"])
    size = rng.uniform(2.0, 15.0)
    tilt = (rng.uniform(-60, 60), rng.uniform(-60, 60), rng.uniform(0, 360))
    if kind == "hills":
        return hills(rng)
    if kind == "cone":
        made = Manifold.cylinder(
            size * rng.uniform(0.3, 2.0), size, size * rng.choice([0.0, 0.3, 0.8, 1.5]), rng.randint(3, 60)
        )
        return made.rotate(tilt) if rng.random() < 0.6 else made
    if kind == "dome":
        return Manifold.sphere(size, rng.randint(4, 48)).scale((1.0, rng.uniform(0.3, 1.0), rng.uniform(0.1, 1.0)))
    if kind == "block":
        return Manifold.cube((size, size * rng.uniform(0.2, 2.0), size * rng.uniform(0.05, 1.0)), True).rotate(tilt)
    if kind == "fin":
        return Manifold.cube((size * 2.0, rng.choice([0.3, 0.01, 0.001]), size), True).rotate(tilt)
    if kind == "spike":
        return Manifold.cylinder(size * 2.0, rng.uniform(0.05, 1.0), 0.0, 3).rotate((tilt[0] / 3, tilt[1] / 3, tilt[2]))
    if kind == "ring":
        whole = Manifold.cylinder(size * 0.4, size, size * 0.9, 40) - Manifold.cylinder(
            size, size * 0.6, size * 0.7, 30
        )
        return whole.rotate(tilt) if rng.random() < 0.5 else whole
    block = Manifold.cube((size * 2, size * 2, size), True)
    if kind == "shell":
        return block - Manifold.sphere(size * 0.4, 16)
    return (block - Manifold.cylinder(size * 4.0, size * 0.3, -1.0, 12, True).rotate((90.0, 0.0, 0.0))).rotate(tilt)


@dataclass
class Body:
    name: str
    corners: Floats

    @cached_property
    def solid(self) -> Manifold:
        return solid_of(self.corners)

    def save(self, folder: Path) -> None:
        out = b"\0" * 80 + struct.pack("<I", len(self.corners))
        rows = np.zeros(len(self.corners), dtype=[("n", "<f4", 3), ("c", "<f4", (3, 3)), ("x", "<u2")])
        rows["c"] = self.corners
        (folder / f"{self.name}.stl").write_bytes(out + rows.tobytes())


def up_by(z: float) -> Floats:
    """A way upwards."""
    return np.array([0.0, 0.0, z])


class Relief:
    """A job of a few moves, its tool, bodies of the part and fixtures, and what is true of them."""

    def __init__(self, seed: int, folder: Path) -> None:
        self.rng = rng = random.Random(f"relief {seed}")
        self.folder = folder
        self.tool: ToolOf = a_tool(rng, 1, 1.0)
        self.tolerance = rng.choice([1e-6, 0.001, 0.01, 0.1, 0.5])
        self.clearance = rng.choice([0.0, 0.0, 0.3, 2.0])
        self.part = [self._body(f"part{k}") for k in range(rng.randint(1, 2))]
        self.fixtures = [self._body(f"clamp{k}") for k in range(rng.randint(0, 1))]
        self.path = self._path()

    def _body(self, name: str) -> Body:
        rng = self.rng
        for _ in range(20):
            shift = (rng.uniform(-15, 15), rng.uniform(-15, 15), rng.uniform(-4, 4))
            corners = triangles_of(a_relief(rng).translate(shift))
            flat = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
            if float(np.abs(flat).max(axis=1).min()) > 1e-9:
                return Body(name, corners)
        raise AssertionError("no body")

    def _path(self) -> list[Floats]:
        """Down, a few lines and up again, so high that what is told of is near to what is allowed."""
        rng = self.rng
        low, high = (
            np.min([b.corners.min(axis=(0, 1)) for b in self.part], axis=0),
            np.max([b.corners.max(axis=(0, 1)) for b in self.part], axis=0),
        )
        aim = rng.choice(rng.choice(self.part).corners.reshape(-1, 3).tolist())
        places = []
        for k in range(rng.randint(1, 3)):
            near = np.array(aim) + rng.uniform(0.0, 1.0) * np.array([num(rng, -9, 9), num(rng, -9, 9), num(rng, -3, 3)])
            wide = np.array([rng.uniform(a, b) for a, b in zip(low, high, strict=True)])
            places.append(near if k == 0 or rng.random() < 0.6 else wide)
        if rng.random() < 0.15 and len(places) > 1:
            places[-1][2] = places[0][2]
        rough = Solid(steps=16).points(self.tool.cutter.outline, self.tool.cutter.corner, -1e-4)
        assert rough is not None
        lift = rng.choice([0.0, self.tolerance + 0.004, self.tolerance - 0.004, 0.2, 2.0, -0.01, -0.3])
        if rng.random() < 0.8:
            down, up = -30.0, 40.0
            for _ in range(16):
                middle = 0.5 * (down + up)
                way = self._moves([p + up_by(middle) for p in places])
                hit = any(meets(swept(rough, a, b), body.solid) > 0.0 for a, b in way for body in self.part)
                down, up = (middle, up) if hit else (down, middle)
            places = [p + up_by(down - lift) for p in places]
        return [np.round(p, 4) for p in places]

    def _moves(self, places: list[Floats]) -> list[tuple[Floats, Floats]]:
        first, last = places[0].copy(), places[-1].copy()
        first[2] = last[2] = HIGH
        stops = [first, *places, last]
        return list(itertools.pairwise(stops))

    @property
    def moves(self) -> list[tuple[Floats, Floats]]:
        """Start and end of the tip along each line."""
        return self._moves(self.path)

    def write(self) -> list[str]:
        (x, y, z), *more = self.path
        text = [
            "G21 G17 G90 G94 G54 G40 G49 G61",
            "T1 M6",
            "G43 H1",
            "M3 S1000",
            "F600",
            f"G0 Z{HIGH}",
            f"G0 X{x} Y{y}",
            f"G1 Z{z}",
        ]
        text += ["G1 X{} Y{} Z{}".format(*place) for place in more]
        (self.folder / "job.cnc").write_text("\n".join([*text, f"G0 Z{HIGH}", "M5", "M30", ""]))
        (self.folder / "machine.toml").write_text(MACHINE + "\n".join(self.tool.lines) + "\n")
        setup = [
            'schema = "gproof-setup/1"',
            "[workpiece]",
            f"tolerance = {self.tolerance:.6f}",
            f"clearance = {self.clearance}",
        ]
        for kind, bodies in (("part", self.part), ("fixtures", self.fixtures)):
            for body in bodies:
                body.save(self.folder)
                setup += [f"[[{kind}]]", f'name = "{body.name}"', f'stl = "{body.name}.stl"']
        (self.folder / "setup.toml").write_text("\n".join(setup) + "\n")
        names = [str(self.folder / name) for name in ("job.cnc", "machine.toml", "setup.toml")]
        words = [names[0], "--machine", names[1], "--setup", names[2], "--dialect", "eding", "--format", "json"]
        return ["check", *words, "--also", "gouges", "--also", "collisions"]

    def _common(self, piece: Piece, body: Body, by: float, *, outside: bool) -> Iterator[tuple[float, float]]:
        """For each line mm3 that a piece widened by ``by`` has in common with a body, and mm3 that it passes."""
        points = Solid(256 if piece.corner + max(by, 0.0) <= 0.0 else 96, outside).points(
            piece.outline, piece.corner, by
        )
        for start, end in self.moves if points is not None else ():
            assert points is not None
            whole = swept(points, start, end)
            yield meets(whole, body.solid), float(whole.volume())

    def meets(self, piece: Piece, body: Body, by: float, *, outside: bool) -> bool:
        """Whether a piece widened by ``by`` meets a body on its way."""
        none = 0.0 if outside else NOTHING
        return any(common > none for common, _ in self._common(piece, body, by, outside=outside))

    def crosses(self, piece: Piece, body: Body, by: float) -> bool:
        """The same of the body's surface: not where the piece is inside all along a line."""
        found = self._common(piece, body, by, outside=False)
        return any(NOTHING < common < whole * (1.0 - 1e-9) for common, whole in found)
