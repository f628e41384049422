"""What is left of stock in the picture: areas measured in the drawing against outlines worked out with shapely."""

from __future__ import annotations

import math
import re
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest
from shapely import LineString, Point, box, unary_union
from support.campaigns import seeds

from gproof.cli.main import main
from gproof.report.picture.relief import COLOURS

SVG = "{http://www.w3.org/2000/svg}"
HEAD = "G21 G17 G90 G94 G40 G49 G80 G54\nT1 M6\nG43 H1\nS5000 M3\nF600\nG0 Z5\n"
END = "G0 Z5\nM5\nM30\n"
MACHINE = """schema = "gproof-machine/1"
name = "Router"
units = "mm"
[axes.x]
min = -200.0
max = 400.0
[axes.y]
min = -200.0
max = 400.0
[axes.z]
min = -200.0
max = 100.0
[controller]
dialect = "eding"
[tools.1]
shape = "flat"
diameter = 6.0
length = 0.0
flute_length = 30.0
shank_diameter = 6.0
stickout = 40.0
holder = [[20.0, 20.0, 20.0]]
"""
SETUP = """schema = "gproof-setup/1"
homed = ["x", "y", "z"]
active_work = 1
tool = 1
start = {x = 0.0, y = 0.0, z = 50.0}
g92 = {x = 0.0, y = 0.0, z = 0.0}
[work.1]
x = 20.0
y = -30.0
z = -12.0
[workpiece]
cell = 0.25
[[stock]]
box = [[0.0, 0.0, -10.0], [50.0, 40.0, 0.0]]
"""
CELL = 0.25


def drawn(folder: Path, job: str, *words: str, setup: str = SETUP) -> ET.Element:
    """The picture of a job with its collisions."""
    for name, text in (("machine.toml", MACHINE), ("setup.toml", setup), ("job.cnc", HEAD + job + END)):
        (folder / name).write_text(text, encoding="utf-8")
    picture = folder / "job.svg"
    files = [str(folder / name) for name in ("job.cnc", "machine.toml", "setup.toml")]
    main(["check", files[0], "--machine", files[1], "--setup", files[2], *words, "--picture", str(picture)])
    return ET.parse(picture).getroot()


def areas(root: ET.Element, width: float = 50.0) -> dict[int, float]:
    """mm² by level; the stock is ``width`` mm wide."""
    found: dict[int, list[tuple[float, float, float, float]]] = {}
    for path in root.iter(f"{SVG}path"):
        if path.get("shape-rendering") == "crispEdges":
            rects = re.findall(r"M([-\d.]+) ([-\d.]+)H([-\d.]+)V([-\d.]+)H[-\d.]+z", path.get("d", ""))
            found[COLOURS.index(path.get("fill", ""))] = [tuple(map(float, rect)) for rect in rects]
    every = [rect for rects in found.values() for rect in rects]
    if not every:
        return {}
    scale = (max(r[2] for r in every) - min(r[0] for r in every)) / width
    return {n: sum((r[2] - r[0]) * (r[3] - r[1]) for r in rects) / scale**2 for n, rects in found.items()}


def said(root: ET.Element) -> list[str]:
    return [element.text or "" for element in root.iter(f"{SVG}text")]


def test_a_slot_and_a_hole_through(tmp_path: Path) -> None:
    job = "G0 X10 Y20\nG1 Z-2\nX30\nG0 Z5\nG0 X40 Y10\nG1 Z-10.5\n"
    root = drawn(tmp_path, job, "--also", "collisions")
    slot, hole = LineString([(10, 20), (30, 20)]).buffer(3, 4096), Point(40, 10).buffer(3, 4096)
    found = areas(root)
    # 2 of 10 mm are in the second of seven steps.
    assert set(found) == {0, 2, 8}
    for level, outline in ((2, slot), (8, hole)):
        # Cells are shown at their highest place: those that the outline passes are not cut.
        assert outline.area - outline.length * CELL * math.sqrt(2) <= found[level] <= outline.area + 0.5
    assert sum(found.values()) == pytest.approx(50 * 40, rel=5e-3)
    told = said(root)
    assert [text for text in told if text in ("not cut", "2 mm deep", "cut through")] == [
        "not cut", "2 mm deep", "cut through",
    ]  # fmt: skip
    assert "What is left of the stock, at most" in told


@pytest.mark.parametrize("seed", seeds(3, 6))
def test_random_slots(seed: int, tmp_path: Path) -> None:
    """Slots at the same depth, one over the other."""
    import random

    dice = random.Random(seed)
    lines, outlines = [], []
    for _ in range(4):
        (x, y), (u, v) = ((dice.uniform(0, 50), dice.uniform(0, 40)) for _ in range(2))
        lines.append(f"G0 X{x:.3f} Y{y:.3f}\nG1 Z-5\nG1 X{u:.3f} Y{v:.3f}\nG0 Z5\n")
        outlines.append(LineString([(x, y), (u, v)]).buffer(3, 1024))
    cut = unary_union(outlines).intersection(box(0, 0, 50, 40))
    found = areas(drawn(tmp_path, "".join(lines), "--also", "collisions"))
    assert set(found) == {0, 4}
    room = sum(outline.length for outline in outlines) * CELL * math.sqrt(2)
    assert cut.area - room <= found[4] <= cut.area + 0.01 * 2000


def test_there_is_none_without_the_question_or_with_several_ends(tmp_path: Path) -> None:
    job = "G0 X10 Y20\nG1 Z-2\nX30\nG0 Z5\n"
    assert areas(drawn(tmp_path, job)) == {}
    assert areas(drawn(tmp_path, job + "/G0 X10\n/G1 Z-4\n", "--also", "collisions")) == {}
    two = "if [#4001 == 1]\nG0 X10 Y20\nG1 Z-2\nG0 Z5\nM30\nendif\n"
    assert areas(drawn(tmp_path, two + job, "--also", "collisions")) == {}


def test_round_stock(tmp_path: Path) -> None:
    setup = SETUP.replace("box = [[0.0, 0.0, -10.0], [50.0, 40.0, 0.0]]",
                          "cylinder = {x = 25.0, y = 25.0, diameter = 50.0, bottom = -10.0, top = 0.0}")  # fmt: skip
    root = drawn(tmp_path, "G0 X-5 Y25\nG1 Z-3\nX55\nG0 Z5\n", "--also", "collisions", setup=setup)
    found = areas(root)
    disc = Point(25, 25).buffer(25, 4096)
    slot = box(-5, 22, 55, 28).intersection(disc)
    assert slot.area - slot.length * CELL * 2 <= found[3] <= slot.area + slot.length * CELL
    assert disc.area - 0.5 <= sum(found.values()) <= disc.area + disc.length * CELL * 2
