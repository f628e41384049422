"""Mutated setups, machine files, drawings and meshes in the whole command: an answer or one mistake, never a crash."""

from __future__ import annotations

import itertools
import random
import re
import struct
import time
from pathlib import Path

import ezdxf
import numpy as np
import pytest
from support.campaigns import seeds

from gproof.cli.main import main

JOB = """G21 G17 G90 G94 G54 G40 G49 G61
T1 M6
G43 H1
M3 S1000
F600
G0 Z50
G0 X5 Y5
G1 Z-2
G1 X30 Y20
G2 X40 Y30 I5 J5
G0 Z50
M5
M30
"""
MACHINE = """schema = "gproof-machine/1"
units = "mm"
[axes.x]
min = -100.0
max = 400.0
[axes.y]
[axes.z]
[controller]
straight_traverse = true
[tools.1]
length = 40.0
diameter = 6.0
shape = "bull"
corner_radius = 1.0
flute_length = 12.0
shank_diameter = 6.0
stickout = 30.0
holder = [[20.0, 30.0, 10.0], [40.0, 40.0, 30.0]]
[tools.2]
diameter = 3.0
shape = "vee"
tip_angle = 60.0
tip_diameter = 0.2
flute_length = 8.0
"""
SETUP = """schema = "gproof-setup/1"
units = "mm"
active_work = 1
tool = 0
start = {x = 0.0, y = 0.0, z = 60.0}
[work.1]
x = 10.0
y = [5.0, 8.0]
z = 0.0
[tools.1]
length = [38.1, 38.3]
[workpiece]
tolerance = 0.01
clearance = 0.5
cell = 0.5
[stock]
box = [[0, 0, -20], [60, 50, 0]]
[[part]]
name = "plate"
dxf = "plate.dxf"
layers = { OUTLINE = { bottom = -20, top = -3 }, POCKET = { floor = -5 } }
join = 0.01
units = "mm"
rotate = 90
shift = [100, 0, 0]
[[part]]
polygon = [[10, 10], [50, 10], [50, 40], [10, 40]]
holes = [[[30, 20], [40, 20], [40, 30]]]
bottom = -20
top = -5
pockets = [{ polygon = [[12, 12], [20, 12], [20, 20]], holes = [], floor = -8 }]
[[fixtures]]
cylinder = { x = 5, y = 45, diameter = 6, bottom = -25, top = 8 }
work = 1
[[fixtures]]
name = "vise"
stl = "vise.stl"
work = "machine"
shift = [-100, 0, 0]
[[fixtures]]
stl = "block.stl"
"""
NUMBERS = (
    "nan", "inf", "-inf", "0", "-0.0", "-1", "1e308", "-1e300", "1e-300", "1e12", "1e11", "1000000000000", "0.1e-6",
    "9223372036854775808", "1e999999", "360.0", "1e5", "-1e5",
)  # fmt: skip
VALUES = (
    *NUMBERS, '""', '"a"', '"' + "x" * 400 + '"', "true", "[]", "{}", "[[]]", "[nan]", "[1, 2]", "[2, 1]",
    "[[1, 2], [3]]",
    "[[0, 0], [10, 10], [10, 0], [0, 10]]", "[[0, 0], [0, 0], [0, 0]]", "[[0, 0], [1, 0], [2, 0]]", "1979-05-27",
    '"../../etc"', '"\\u0000"', '"vise.stl"', '"plate.dxf"', '"setup.toml"', '"."', "[[[[[[[[1]]]]]]]]",
    "{ a = 1 }", "[{}]", '["x"]',
)  # fmt: skip
CUBE = [(0, 2, 1), (0, 3, 2), (4, 5, 6), (4, 6, 7), (0, 1, 5), (0, 5, 4), (1, 2, 6), (1, 6, 5), (2, 3, 7), (2, 7, 6),
        (3, 0, 4), (3, 4, 7)]  # fmt: skip
PLACES = [(x, y, z) for z in (0.0, 6.0) for x, y in ((0.0, 0.0), (8.0, 0.0), (8.0, 8.0), (0.0, 8.0))]
FACETS = [[PLACES[k] for k in face] for face in CUBE]
_KEY = re.compile(r"^(\s*)([A-Za-z_]+)( = )(.*)$")
_INNER = re.compile(r"([A-Za-z_]+) = ([^,{}\[\]]+)")
_NUMBER = re.compile(r"-?\d+(?:\.\d+)?")


def binary(facets: list[list[tuple[float, float, float]]]) -> bytes:
    out = b"\0" * 80 + struct.pack("<I", len(facets))
    for facet in facets:
        out += struct.pack("<12fH", 0, 0, 0, *itertools.chain(*facet), 0)
    return out


def text(facets: list[list[tuple[float, float, float]]]) -> bytes:
    lines = ["solid block"]
    for facet in facets:
        lines += [
            "facet normal 0 0 0",
            "outer loop",
            *("vertex {} {} {}".format(*p) for p in facet),
            "endloop",
            "endfacet",
        ]
    return "\n".join([*lines, "endsolid block", ""]).encode()


def drawing(path: Path) -> None:
    made = ezdxf.new("R2000")
    made.units = 4
    space = made.modelspace()
    for a, b in itertools.pairwise([(0, 0), (50, 0), (50, 40), (0, 40), (0, 0)]):
        space.add_line(a, b, dxfattribs={"layer": "OUTLINE"})
    space.add_circle((40, 30), 4, dxfattribs={"layer": "OUTLINE"})
    space.add_lwpolyline([(10, 10, 0.3), (20, 10, 0), (20, 20, -0.3), (10, 20, 0)], format="xyb", close=True,
                         dxfattribs={"layer": "POCKET"})  # fmt: skip
    space.add_arc((30, 20), 3, 0, 180, dxfattribs={"layer": "POCKET"})
    space.add_line((27, 20), (33, 20), dxfattribs={"layer": "POCKET"})
    space.add_ellipse((10, 30), (4, 1), 0.5, dxfattribs={"layer": "OUTLINE"})
    space.add_open_spline([(30, 30), (34, 34), (36, 28), (30, 30)], dxfattribs={"layer": "POCKET"})
    block = made.blocks.new("B")
    block.add_circle((0, 0), 1)
    space.add_blockref("B", (45, 5), dxfattribs={"layer": "OUTLINE", "xscale": 2})
    made.saveas(path)


def some_bytes(rng: random.Random, raw: bytes) -> bytes:
    for _ in range(rng.randint(1, 5)):
        at = rng.randrange(len(raw) + 1)
        what = rng.randrange(5)
        if what == 0:
            raw = raw[:at] + bytes([rng.randrange(256)]) + raw[at + 1 :]
        elif what == 1:
            raw = raw[:at] + raw[at + rng.randint(1, 20) :]
        elif what == 2:
            raw = (
                raw[:at] + rng.choice([b"\0", b"\xff\xfe", b"\r", b"\n", b"nan", b"1e999", b"-", b"[", b'"']) + raw[at:]
            )
        elif what == 3:
            raw = raw[:at]
        else:
            other = rng.randrange(len(raw) + 1)
            raw = raw[:at] + raw[other : other + 40] + raw[at:]
        raw = raw or b"\0"
    return raw


def toml(rng: random.Random, given: str) -> tuple[str, str]:
    """A changed file, and the name of a key that nobody knows, if it has one."""
    lines = given.splitlines()
    for _ in range(rng.choice([1, 1, 1, 2, 3])):
        at = rng.randrange(1, len(lines))
        found, what = _KEY.match(lines[at]), rng.randrange(8)
        if what == 0 and found:
            lines[at] = f"{found[2]} = {rng.choice(VALUES)}"
        elif what in (1, 2):
            spots = list(_NUMBER.finditer(lines[at]))
            if spots:
                spot = rng.choice(spots)
                lines[at] = lines[at][: spot.start()] + rng.choice(NUMBERS) + lines[at][spot.end() :]
        elif what == 3:
            del lines[at]
        elif what == 4:
            lines.insert(rng.randrange(1, len(lines)), lines[at])
        elif what == 5:
            other = rng.randrange(1, len(lines))
            lines[at], lines[other] = lines[other], lines[at]
        elif what == 6:
            table = [k for k, line in enumerate(lines) if line.startswith("[")]
            first = rng.choice(table)
            last = min((k for k in table if k > first), default=len(lines))
            lines += lines[first:last]
        elif what == 7:
            spots = list(_INNER.finditer(lines[at]))
            if spots:
                spot = rng.choice(spots)
                lines[at] = lines[at][: spot.start()] + f"{spot[1]} = {rng.choice(VALUES)}" + lines[at][spot.end() :]
    strange = ""
    if rng.random() < 0.35:
        at = rng.randrange(len(lines))
        spots = [*_INNER.finditer(lines[at])]
        if spots and not lines[at].startswith(("#", "[")):
            spot, strange = rng.choice(spots), f"quaint{rng.randrange(100)}"
            lines[at] = lines[at][: spot.start(1)] + strange + lines[at][spot.end(1) :]
    return "\n".join(lines) + "\n", strange


def dxf(rng: random.Random, raw: bytes) -> bytes:
    lines = raw.decode("latin-1").split("\n")
    begin = next(k for k, line in enumerate(lines) if line.strip() == "ENTITIES")
    for _ in range(rng.randint(1, 4)):
        at = rng.randrange(begin if rng.random() < 0.8 else 0, len(lines) - 1) // 2 * 2
        what = rng.randrange(6)
        if what in (0, 1):
            lines[at + 1] = rng.choice(
                [*NUMBERS, "", "LINE", "SPLINE", "INSERT", "OUTLINE", "\xff", str(rng.uniform(-60, 60))]
            )
        elif what == 2:
            lines[at] = rng.choice(["0", "8", "10", "40", "-1", "9999", "x", "70", "210", "230"])
        elif what == 3:
            del lines[at : at + 2 * rng.randint(1, 6)]
        elif what == 4:
            lines[at:at] = lines[max(at - 20, 0) : at]
        else:
            digits = [k for k in range(begin, len(lines)) if re.fullmatch(r"\s*-?\d+\.\d+\s*", lines[k])]
            if digits:
                lines[rng.choice(digits)] = str(rng.choice([rng.uniform(-60, 60), 0.0, 1e9, -1e-9, 1e15]))
        lines = lines if len(lines) > begin + 4 else [*lines, "0", "EOF", "", ""]
    return "\n".join(lines).encode("latin-1")


def stl(rng: random.Random) -> bytes:
    facets = [list(facet) for facet in FACETS]
    for _ in range(rng.randint(1, 3)):
        at, what = rng.randrange(len(facets)) if facets else 0, rng.randrange(8)
        if not facets:
            break
        if what == 0:
            facets[at] = facets[at][::-1]
        elif what == 1:
            del facets[at]
        elif what == 2:
            facets.append(facets[at])
        elif what == 3:
            k = rng.randrange(3)
            facets[at][k] = tuple(float(v) for v in rng.choice([
                ("nan", 0, 0), ("inf", 1, 1), (1e30, 0, 0), (3e38, 0, 0), (1e7, 1, 1), (-0.0, 0.0, 0.0), (1e-40, 0, 0),
            ]))  # fmt: skip
        elif what == 4:
            facets = [facet[::-1] for facet in facets]
        elif what == 5:
            facets[at] = [facets[at][0]] * 3
        elif what == 6:
            facets = [] if rng.random() < 0.3 else [[(x, y, 0.0) for x, y, _ in facet] for facet in facets]
        else:
            facets += [[(x + 20.0, y, z) for x, y, z in facet[:: rng.choice([1, -1])]] for facet in FACETS]
    return (binary if rng.random() < 0.5 else text)(facets)


@pytest.mark.parametrize("seed", seeds(4, 100))
def test_mutated_files_give_an_answer_or_one_mistake(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], seed: int
) -> None:
    drawing(tmp_path / "plate.dxf")
    plate = (tmp_path / "plate.dxf").read_bytes()
    for number in range(10):
        rng = random.Random(f"workpiece {seed} {number}")
        which, strange = rng.choice(["setup", "setup", "setup", "machine", "dxf", "dxf", "stl", "bytes"]), ""
        files = {
            "job.cnc": JOB.encode(), "machine.toml": MACHINE.encode(), "setup.toml": SETUP.encode(), "plate.dxf": plate,
            "vise.stl": binary(FACETS), "block.stl": text(FACETS),
        }  # fmt: skip
        if which == "setup":
            changed, strange = toml(rng, SETUP)
            files["setup.toml"] = changed.encode()
        elif which == "machine":
            changed, strange = toml(rng, MACHINE)
            files["machine.toml"] = changed.encode()
        elif which == "dxf":
            files["plate.dxf"] = dxf(rng, plate)
        elif which == "stl":
            files[rng.choice(["vise.stl", "block.stl"])] = stl(rng)
        else:
            name = rng.choice(["machine.toml", "setup.toml", "plate.dxf", "vise.stl", "block.stl"])
            files[name] = some_bytes(rng, files[name])
        for name, raw in files.items():
            (tmp_path / name).write_bytes(raw)
        words = ["check", str(tmp_path / "job.cnc"), "--machine", str(tmp_path / "machine.toml"), "--setup"]
        words += [str(tmp_path / "setup.toml"), "--dialect", "eding", "--also", "gouges", "--also", "collisions"]
        begin = time.process_time()
        with np.errstate(all="ignore"):
            code = main(words)
        took = time.process_time() - begin
        out, err = capsys.readouterr()
        case = f"seed {seed}, number {number} ({which})\n{out[-2000:]}\n{err[-2000:]}"
        assert code in (0, 1, 2, 3), case
        assert "Traceback" not in out + err and took < 20.0, case
        assert (code == 3) == bool(re.search(r"^gproof: ", err, re.MULTILINE)), case
        if strange and code != 3:
            assert strange in out + err, case
