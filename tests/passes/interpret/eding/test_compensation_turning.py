"""Compensation in the XZ plane: the manual's example for turning, the tool's orientation, what must be stated.

Eding CNC manual 4.01: 3.1.2.1, 3.4.11.2.
"""

from __future__ import annotations

import dataclasses
import math
import re
from pathlib import Path

import numpy as np
import pytest
from passes.interpret.eding.compensated_jobs import Move, machine, moves, run

from gproof.ir.machine import Tool
from gproof.ir.trace import Op, Plane

HEAD = "G21 G18 G90 G94 G54 G40 G49 G80 F600\n"
FRONT = machine(Tool(number=1, diameter=5.0, orientation=9), Tool(number=2, diameter=5.0, orientation=2), view="-y")
BACK = machine(Tool(number=1, diameter=5.0, orientation=9), Tool(number=2, diameter=5.0, orientation=2), view="+y")

# 3.4.11.2, radius programming: a line and an arc to enter, a face, a convex and a concave quarter.
BY_RADIUS = """M6 T{tool}
G0 X-10 Z20
G41.1 D5
G1 X-10 Z10
G3 X0 Z0 R10
G1 X10
G2 X20 Z-10 R10
G1 Z-20
G3 X30 Z-30 R10
G40
M30
"""
BY_CENTER = BY_RADIUS.replace("X0 Z0 R10", "X0 Z0 I10 K0").replace("X20 Z-10 R10", "X20 Z-10 I0 K-10")
BY_CENTER = BY_CENTER.replace("X30 Z-30 R10", "X30 Z-30 I10 K0")
# (x, z) of the centre of a nose of radius 2.5, drawn with X to the right and Z upwards: left of the contour.
NOSE = [(0, 2.5), (10, 2.5), (22.5, -10), (22.5, -20), (30, -27.5)]


def other_side(text: str) -> str:
    """The same program as a machine reads it that looks at the plane from the other end of Y."""
    swapped = {"G2 ": "G3 ", "G3 ": "G2 ", "G41.1": "G42.1"}
    lines = []
    for line in text.splitlines():
        code = next((c for c in swapped if line.startswith(c)), "")
        lines.append(swapped[code] + line.removeprefix(code) if code else line)
    return "\n".join(lines) + "\n"


def places(path: list[Move]) -> list[tuple[float, float]]:
    return [(m.to[0], m.to[2]) for m in path]


@pytest.mark.parametrize("text", [BY_RADIUS, BY_CENTER], ids=["R", "I K"])
def test_the_manuals_example(text: str, tmp_path: Path) -> None:
    """Orientation 9: the centre of the nose is the controlled point."""
    trace, told, _ = run(tmp_path, HEAD + text.format(tool=1), on=FRONT)
    assert told == []
    got = moves(trace, Plane.XZ)
    # The first move ends at the right angle of the triangle over the 10 mm to (-10, 10).
    entry = (-10 + 2.5 * math.sqrt(15) / 4, 10.625)
    assert np.allclose(places(got), [(-10, 20), entry, (-7.5, 10), *NOSE], atol=1e-9)
    # Seen from positive Y, as rows of the trace are, everything is the other way round.
    assert [m.turns for m in got] == [0, 0, 1, -1, 0, 1, 0, -1]
    assert {m.compensation for m in got[1:]} == {-2}
    assert np.allclose([m.programmed for m in got[3:]], [(0, 0), (0, 10), (-10, 20), (-20, 20), (-30, 30)])


@pytest.mark.parametrize("text", [BY_RADIUS, BY_CENTER], ids=["R", "I K"])
def test_the_manuals_example_with_diameters(text: str, tmp_path: Path) -> None:
    """The same contour in X words twice as large; I, R and D are what they were."""
    lathe = dataclasses.replace(FRONT, controller=dataclasses.replace(FRONT.controller, diameter_programming=True))
    doubled = re.sub(r"X(-?\d+)", lambda word: f"X{2 * int(word[1])}", text)
    radii, _, _ = run(tmp_path, HEAD + text.format(tool=1), on=FRONT)
    trace, told, _ = run(tmp_path, HEAD + doubled.format(tool=1), on=lathe)
    assert told == []
    assert np.allclose(places(moves(trace, Plane.XZ)), places(moves(radii, Plane.XZ)), atol=1e-9)


def test_orientation_2_controls_a_point_one_radius_off_both_ways(tmp_path: Path) -> None:
    """3.1.2.1: X and Z minus the tool's radius. From (-7.5, 22.5) the nose goes straight down to (-7.5, 10)."""
    trace, told, _ = run(tmp_path, HEAD + BY_RADIUS.format(tool=2), on=FRONT)
    assert told == []
    shifted = [(x - 2.5, z - 2.5) for x, z in [(-7.5, 10), *NOSE]]
    assert np.allclose(places(moves(trace, Plane.XZ)), [(-10, 20), *shifted], atol=1e-9)


@pytest.mark.parametrize("tool", [1, 2])
def test_the_view_swaps_arcs_and_sides_alike(tool: int, tmp_path: Path) -> None:
    one, _, _ = run(tmp_path, HEAD + BY_CENTER.format(tool=tool), on=FRONT)
    other, told, _ = run(tmp_path, HEAD + other_side(BY_CENTER.format(tool=tool)), on=BACK)
    assert told == []
    assert moves(one, Plane.XZ) == moves(other, Plane.XZ)


def test_plain_arcs_follow_the_view_too(tmp_path: Path) -> None:
    """Uncompensated, in both speeds of the executor's loop: G3 from +Z to -X seen from negative Y."""
    text = HEAD + "G0 X0 Z10\nG1 Z10\nG3 X-10 Z0 K-10\nG3 X0 Z-10 R10\n" + "G1 Z-10\n" * 3 + "M30\n"
    trace, told, _ = run(tmp_path, text, on=FRONT)
    assert told == []
    arcs = [m for m in moves(trace, Plane.XZ) if m.op is Op.ARC]
    assert [m.turns for m in arcs] == [-1, -1]
    assert np.allclose([m.center or () for m in arcs], 0)
    assert all(math.isclose(abs(m.sweep()), math.pi / 2) for m in arcs)


ORIENTATIONS = {1: (1, -1), 2: (-1, -1), 3: (-1, 1), 4: (1, 1), 5: (1, 0), 6: (0, -1), 7: (-1, 0), 8: (0, 1), 9: (0, 0)}
"""(Z, X) in radii. 2 and 9 are the manual's words; the others LinuxCNC's table (``lathe_shapes`` in its glcanon.py)."""


@pytest.mark.parametrize("number", ORIENTATIONS)
def test_orientations(number: int, tmp_path: Path) -> None:
    """Behind the first two moves the nose is at (x, z) = (10, 2.5); #5701 is the orientation of tool 1."""
    on = machine(Tool(number=1, diameter=5.0), view="-y")
    text = f"#5701 = {number}\nM6 T1\nG0 X-20 Z-30\nG41\nG1 X0 Z0\nG1 X10\nG40\nM30\n"
    trace, told, _ = run(tmp_path, HEAD + text, on=on)
    assert told == []
    z, x = ORIENTATIONS[number]
    assert np.allclose(places(moves(trace, Plane.XZ))[-1], (10 + 2.5 * x, 2.5 + 2.5 * z))


@pytest.mark.parametrize(
    ("tools", "view", "code"),
    [
        ((Tool(number=1, diameter=5.0, orientation=2),), None, "G41"),
        ((Tool(number=1, diameter=5.0),), "-y", "G41"),
        ((Tool(number=1, diameter=5.0, orientation=0),), "-y", "G41"),
        ((Tool(number=1, diameter=5.0),), "-y", "G41.1 D5"),
        ((Tool(number=1, diameter=-5.0, orientation=2),), "-y", "G41"),
        ((Tool(number=1, diameter=5.0, orientation=2), Tool(number=2, diameter=5.0, orientation=3)), "-y", "G41 D2"),
    ],
    ids=["view", "orientation", "orientation 0", "diameter given", "negative", "two orientations"],
)
def test_what_nobody_stated_is_unknown(tools: tuple[Tool, ...], view: str | None, code: str, tmp_path: Path) -> None:
    text = f"M6 T1\nG0 X-20 Z-30\n{code}\nG1 X0 Z0\nG1 X10\nG40\nM30\n"
    _, told, _ = run(tmp_path, HEAD + text, on=machine(*tools, view=view))
    assert set(told) == {"GP257:4"}


def test_a_tool_offset_in_x_can_not_change_within_a_contour(tmp_path: Path) -> None:
    """5.4 (1): Z is a compensated axis here, so a tool length moves the origin."""
    _, told, _ = run(tmp_path, HEAD + BY_RADIUS.format(tool=1).replace("G40\n", "G43.1 K3\nG40\n"), on=FRONT)
    assert told == ["GP246:11"]


@pytest.mark.parametrize(("turning", "view", "code"), [
    (True, None, ["GP405:4"]), (True, "+y", []), (True, "-y", []), (False, None, []),
])  # fmt: skip
def test_arcs_of_a_lathe_need_the_view(turning: bool, view: str | None, code: list[str], tmp_path: Path) -> None:
    """3.4.3 and 3.4.11.2 contradict each other; on a mill only the first counts."""
    on = machine(view=view)
    on = dataclasses.replace(on, controller=dataclasses.replace(on.controller, turning=turning))
    _, told, _ = run(tmp_path, HEAD + "G0 X0 Z10\nG1 Z10\nG3 X-10 Z0 K-10\nG1 X0\nM30\n", on=on)
    assert told == code


def test_a_whole_circle_in_the_lathes_plane_is_whole(tmp_path: Path) -> None:
    """With a shifted controlled point too, begin and end are the same numbers."""
    text = "M6 T2\nG0 X-20.1 Z-30.7\nG41\nG1 X0.3 Z0.7\nG1 X10.3\nG3 X10.3 Z0.7 K7.3\nG40\nM30\n"
    trace, told, _ = run(tmp_path, HEAD + text, on=FRONT)
    assert told == []
    circle = moves(trace, Plane.XZ)[-1]
    assert (circle.op, circle.begin) == (Op.ARC, circle.end)
    assert abs(circle.turns) == 1
