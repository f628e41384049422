"""Jobs that both gproof and the public peer ``gcode-collision-check`` 0.1.0 understand, and what the peer says of them.

    python tests/differential/collision_peer.py COUNT    writes expected/collisions.json anew, from the peer itself

The peer is not needed to run the tests: its answers about scenes by number are kept (``pip install -e .[peers]``).

The peer stands its tool, meshes of 32 or more faces inside the true one, at points along each move, and asks a library
for contacts with meshes of the scene. So all that it finds is there; what lies between its points, or between its faces
and the true tool, it does not find.
"""

from __future__ import annotations

import json
import struct
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path

import numpy as np

Corner = tuple[float, float, float]
EXPECTED = Path(__file__).parent / "expected" / "collisions.json"
PARTS = ("flute", "shank", "holder")
"""The peer's names of what a tool is made of, from the tip upwards."""


@dataclass(frozen=True)
class Tool:
    """As the peer's ToolConfig: an end mill or a ball, shank and holder as cylinders above one another, mm."""

    kind: str
    diameter: float
    flute_length: float
    shank_diameter: float
    shank_length: float = 20.0
    holder_diameter: float = 40.0
    holder_length: float = 30.0


@dataclass(frozen=True)
class Scene:
    """Boxes by name, and a program in Fanuc's style that begins at 0, 0, 0."""

    boxes: dict[str, tuple[Corner, Corner]]
    moves: tuple[str, ...]
    tool: Tool
    files: dict[str, Path] = field(default_factory=dict)

    @property
    def program(self) -> str:
        return "\n".join(("G21 G90 G17 G49", *self.moves, "M30", ""))

    def write(self, folder: Path) -> Path:
        """The program and an STL file for each box; the path of the program."""
        for name, (low, high) in self.boxes.items():
            self.files[name] = folder / f"{name}.stl"
            self.files[name].write_bytes(box_stl(low, high))
        job = folder / "job.nc"
        job.write_text(self.program, encoding="utf-8")
        return job


def box_stl(low: Corner, high: Corner) -> bytes:
    """A box as binary STL: twelve triangles, counter-clockwise from outside."""
    corners = [tuple((low, high)[n >> axis & 1][axis] for axis in range(3)) for n in range(8)]
    faces = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))
    triangles = [t for a, b, c, d in faces for t in ((a, b, c), (a, c, d))]
    out = [b"\0" * 80, struct.pack("<I", len(triangles))]
    for triangle in triangles:
        out.append(struct.pack("<12fH", 0.0, 0.0, 0.0, *(v for n in triangle for v in corners[n]), 0))
    return b"".join(out)


def peer_hits(job: Path, scene: Scene) -> dict[tuple[int, str, str], float]:
    """By line, part of the tool and box: how deep the peer finds the one in the other, mm; contacts are left out."""
    from gcode_collision_check.collision import checker
    from gcode_collision_check.types import ToolConfig

    files = {name: str(path) for name, path in scene.files.items()}
    result = checker.verify(str(job), files, ToolConfig(**asdict(scene.tool)))
    hits: dict[tuple[int, str, str], float] = {}
    for event in result.events:
        for a, b in event.pairs:
            part, box = (a, b) if a in PARTS else (b, a)
            key = (event.line_no, part, box)
            hits[key] = max(hits.get(key, 0.0), event.penetration_depth)
    return {key: depth for key, depth in hits.items() if depth > 1e-4}


def scene_of(number: int) -> Scene:
    """One to three boxes beside or under a path of lines and arcs, seldom far from them; always the same one."""
    random = np.random.default_rng([620, number])
    kind = str(random.choice(["flat", "ball"]))
    diameter = float(random.choice([3.0, 6.0, 10.0, 16.0]))
    flute = float(random.choice([12.0, 20.0]))
    tool = Tool(kind, diameter, flute, float(random.choice([diameter, diameter + 2.0])))
    boxes = {}
    for n in range(int(random.integers(1, 4))):
        low = random.uniform(-45, 30, 3).round(2)
        size = random.choice([0.5, 5.0, 20.0, 35.0], 3)
        low[2] = -30.0 + float(random.uniform(0, 25))
        boxes[f"clamp{n}"] = (_corner(low), _corner(low + size))
    at = tuple(random.uniform(-50, 50, 2).round(3).tolist())
    moves = ["G0 Z50", f"G0 X{at[0]:.3f} Y{at[1]:.3f}"]
    for _ in range(int(random.integers(1, 7))):
        move, at = _move(random, at)
        moves.append(move)
    return Scene(boxes, tuple(moves), tool)


def _move(random: np.random.Generator, at: tuple[float, ...]) -> tuple[str, tuple[float, ...]]:
    """A move, and the X and Y where it ends."""
    x, y, z = random.uniform((-50, -50, -30), (50, 50, 15)).round(3).tolist()
    choice = random.integers(4)
    if choice == 0:
        return f"G0 X{x:.3f} Y{y:.3f} Z{z:.3f}", (x, y)
    if choice == 1:
        return f"G1 X{x:.3f} Y{y:.3f} Z{z:.3f} F600", (x, y)
    if choice == 2:
        return f"G1 Z{z:.3f} F200", at
    # A full circle: its end can not miss the radius of its start.
    return f"{random.choice(['G2', 'G3'])} X{at[0]:.3f} Y{at[1]:.3f} I{x / 3:.3f} J{y / 3:.3f} F600", at


def _corner(values: Sequence[float]) -> Corner:
    x, y, z = (round(float(v), 3) for v in values)
    return x, y, z


def main(count: int) -> None:
    """Ask the peer about so many scenes and keep what it finds."""
    kept = []
    for number in range(count):
        with tempfile.TemporaryDirectory() as folder:
            scene = scene_of(number)
            hits = peer_hits(scene.write(Path(folder)), scene)
        kept.append([[*key, round(depth, 4)] for key, depth in sorted(hits.items())])
    text = ",\n".join(json.dumps(hits) for hits in kept)
    EXPECTED.write_text(f"[\n{text}\n]\n", encoding="utf-8")


if __name__ == "__main__":
    main(int(sys.argv[1]))
