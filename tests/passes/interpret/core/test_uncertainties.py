"""What a tool may be beside its path, zones, part, fixtures and stock count alike: none is SAFE where another is not.

One body is stated as each of them, with a gap to the path that is smaller than the uncertainty. What is not looked
at has its reason in docs/reach.md, Uncertainties, whose rows are the cases here.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest
from corpus.expectations import ROOT
from reach.scenes import ROUTER
from reach.witness import m
from reach.worlds import EDING, WINCNC, World, answered, exactly

from gproof.ir.machine import Area, Axis, AxisKind, Slave, Tool
from gproof.ir.setup import HeightMap, Interval
from gproof.ir.workpiece import Box, Placed, Workpiece

TOOL = Tool(number=1, length=40.0, shape="flat", diameter=6.0, flute_length=200.0, shank_diameter=6.0, stickout=200.0)
Corners = tuple[tuple[float, float, float], tuple[float, float, float]]
WALL: Corners = ((200.0, 0.0, -140.0), (220.0, 380.0, -1.0))
"""Machine coordinates: the tool's side passes it by 1 mm where its axis is at X196."""
FLOOR: Corners = ((0.0, 0.0, -140.0), (600.0, 380.0, -60.0))
ROLES = ("zone", "part", "fixture", "stock")
PROPERTY = {"zone": "areas", "part": "gouges", "fixture": "collisions", "stock": "collisions"}


def with_body(world: World, role: str, corners: Corners) -> World:
    """The body as a zone, or on the table."""
    low, high = corners
    if role == "zone":
        box = ((low[0], high[0]), (low[1], high[1]), (low[2], high[2]))
        return world.with_setup(keep_out=(Area(name="body", box=box),))
    body = (Placed(name="body", body=Box(low=low, high=high), work=0),)
    name = {"part": "part", "fixture": "fixtures", "stock": "stock"}[role]
    return world.with_setup(workpiece=Workpiece(**{name: body}))


E = EDING.but(*m(("machine.tools", (TOOL,)))).with_setup(start=exactly(x=0.0, y=10.0, z=-50.0))
W = WINCNC.but(*m(("machine.tools", (TOOL,)))).with_setup(
    start=exactly(x=0.0, y=10.0, z=-50.0), measures=exactly(z=0.0)
)  # fmt: skip
LOW = E.with_setup(start=exactly(x=0.0, y=10.0, z=-10.0))
BESIDE = "G21 G53 G0 X196; G53 G0 Y100; M30"
OVER = "G21 G43 H1; G53 G0 Z-19; G53 G0 X100; M30"
AROUND = "G21 G90 G17 G54; G0 X23 Y10 Z60; G3 X23 Y50 I0 J20 F500; M30"
GRID = HeightMap(x=0.0, y=0.0, size=100.0, heights=((0.0, 0.0), (0.0, 0.0)), name="map")
TURNER = Axis(name="a", kind=AxisKind.ROTARY, lower=-400.0, upper=400.0, max_velocity=50.0, max_acceleration=100.0)

CASES: dict[str, tuple[World, str, Corners, list[tuple[str, Any]]]] = {
    "backlash of a motor": (E, BESIDE, WALL, [("machine.axes.0.backlash", 1.5)]),
    "backlash of a slave motor": (E, BESIDE, WALL, [("machine.axes.0.slaves", (Slave(joint="a", backlash=1.5),))]),
    "backlash of Z": (LOW, OVER, FLOOR, [("machine.axes.2.backlash", 1.5)]),
    "backlash that the job sets (L8)": (W, "G22; G53 X196; G53 Y100", WALL, [("state.backlash", ((0, 1.5),))]),
    "backlash that nothing compensates": (
        W, "G22; G53 X196; G53 Y100", WALL, [("machine.settings.backlash", (("x", 1.5),))]
    ),
    "corners that are rounded (P)": (E, "G64 P0.001; " + BESIDE, WALL, [("state.path_tolerance", 1.5)]),
    "lines that are joined (Q)": (E, BESIDE, WALL, [("state.simplify", 1.5)]),
    "chords of arcs": (
        E, AROUND, ((196.1, 0.0, -140.0), (220.0, 380.0, -1.0)), [("machine.controller.interpolation_time", 0.2)]
    ),
    "start": (E, "G91 G21 G0 X196; G0 Y90; M30", WALL, [("setup.start.x", Interval(0.0, 1.5))]),
    "work offset": (E, "G21 G54 G0 X46 Z60; G0 Y10; M30", WALL, [("setup.work", {
        (1, "x"): Interval(150.0, 151.5), (1, "y"): Interval(120.0, 120.0), (1, "z"): Interval(-110.0, -110.0)})]),
    "local offset": (E, "G21 G54 G0 X46 Z60; G0 Y10; M30", WALL, [("setup.g92.x", Interval(0.0, 1.5))]),
    "tool length": (LOW, OVER, FLOOR, [("setup.tool_lengths", {0: Interval(0.0, 0.0), 1: Interval(40.0, 41.5)})]),
    "tool diameter": (E, BESIDE, WALL, [("setup.parameter_ranges", {5501: Interval(6.0, 9.0)})]),
    "which tool": (E.but(*m(("machine.tools", (TOOL, Tool(number=2))))), BESIDE, WALL, [("setup.tool", None)]),
    "rapid moves that are no lines": (
        E.with_setup(start=exactly(x=0.0, y=390.0, z=-50.0)), "G53 G0 X230 Y10; M30",
        ((0.0, 0.0, -140.0), (60.0, 180.0, -1.0)), [("machine.controller.straight_traverse", False)],
    ),
    "height map": (
        E.with_setup(height_map=GRID), OVER.replace("G43 H1; ", "").replace("Z-19", "Z-59"), FLOOR,
        [("setup.height_map.heights", ((0.0, -1.5), (-1.5, -1.5)))],
    ),
    "another head": (E, BESIDE, WALL, [("state.head", 1)]),
}  # fmt: skip


def verdicts(
    world: World, program: str, corners: Corners, changes: list[tuple[str, Any]], folder: Path
) -> dict[str, str]:
    """By role, of the property that looks at it there."""
    text = program.replace("; ", "\n") + "\n"
    return {
        role: answered(with_body(world, role, corners), text, folder, m(*changes))[PROPERTY[role]].split("\n")[0]
        for role in ROLES
    }


def rows() -> dict[str, list[str]]:
    """The table of docs/reach.md: by uncertainty, the cells of what looks at the tool."""
    page = (ROOT / "docs" / "reach.md").read_text(encoding="utf-8")
    table = page.partition("## Uncertainties")[2].partition("\n## ")[0]
    cells = [[cell.strip() for cell in line.strip("|").split("|")] for line in re.findall(r"^\|.*\|$", table, re.M)]
    return {row[0]: row[1:] for row in cells[2:]}


def test_each_case_has_a_row() -> None:
    assert set(rows()) == set(CASES)
    assert all(len(cell) > 3 for row in rows().values() for cell in row)


@pytest.mark.parametrize("name", CASES)
def test_none_is_safe(name: str, tmp_path: Path) -> None:
    world, program, corners, changes = CASES[name]
    exact = verdicts(world, program, corners, [], tmp_path)
    unsure = verdicts(world, program, corners, changes, tmp_path)
    open_before = {"height map": {"part", "fixture", "stock"}}.get(name, set())
    assert {role for role in ROLES if exact[role] != "SAFE"} == open_before, exact
    counted = {role for role, cell in zip(ROLES, rows()[name], strict=False) if cell == "counts"}
    assert {role for role in ROLES if unsure[role] != "SAFE"} == counted, unsure


@pytest.mark.parametrize(("turn", "work", "expected"), [("A10", 1, "UNKNOWN"), ("A10", 0, "SAFE"), ("A0", 1, "SAFE")])
def test_zones_of_the_work_turn_with_it(turn: str, work: int, expected: str, tmp_path: Path) -> None:
    """A clamp on a rotary table goes with it, as part and fixtures do; what is bolted to the machine stays."""
    world = E.but(*m(("machine.axes", (*ROUTER, TURNER)))).with_setup(
        start=exactly(x=0.0, y=10.0, z=-50.0, a=0.0), homed=("x", "y", "z", "a"),
        g92=exactly(x=0.0, y=0.0, z=0.0, a=0.0),
        work={(1, n): Interval(v, v) for n, v in (("x", 0.0), ("y", 0.0), ("z", 0.0), ("a", 0.0))},
    )  # fmt: skip
    program = f"G21 G90 G54 G0 {turn}\nG0 X20\nM30\n"
    box = ((200.0, 220.0), (0.0, 380.0), (-140.0, -1.0))
    zoned = world.with_setup(keep_out=(Area(name="clamp", box=box, work=work),))
    assert answered(zoned, program, tmp_path, ())["areas"].split("\n")[0] == expected
    body = (Placed(name="clamp", body=Box(low=WALL[0], high=WALL[1]), work=work),)
    for name, answer in (("fixtures", "collisions"), ("part", "gouges"), ("stock", "collisions")):
        held = world.with_setup(workpiece=Workpiece(**{name: body}))
        found = answered(held, program, tmp_path, ())[answer].split("\n")[0]
        assert found == ("SAFE" if turn == "A0" else "UNKNOWN"), name


def test_backlash_is_named_where_it_makes_the_difference(tmp_path: Path) -> None:
    world, program, corners, changes = CASES["backlash of a motor"]
    text = program.replace("; ", "\n") + "\n"
    for role, hinted in (("part", True), ("fixture", False)):
        said = answered(with_body(world, role, corners), text, tmp_path, m(*changes))[PROPERTY[role]]
        assert "the controller and axis backlash may bring it 1.500 mm closer" in said
        assert "the backlash" not in answered(with_body(world, role, corners), text, tmp_path, ())[PROPERTY[role]]
        assert hinted or "tolerance of" not in said
