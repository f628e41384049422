"""Shapes of tools in machine files."""

from __future__ import annotations

from pathlib import Path

import pytest

from gproof.driver.dialects import load_machine
from gproof.ir.finding import Findings
from gproof.ir.machine import Machine, Tool


def load(folder: Path, text: str, units: str = "mm") -> tuple[Machine | None, list[str]]:
    path = folder / "mill.toml"
    path.write_text(f'schema = "gproof-machine/1"\nunits = "{units}"\n{text}')
    findings = Findings()
    machine, _ = load_machine(path, findings)
    return machine, [f"{f.code.label} {f.span.line} {f.message}" for f in findings.kept]


def test_a_tool_with_all_that_can_be_stated(tmp_path: Path) -> None:
    text = """[tools.3]
diameter = 0.5
shape = "bull"
corner_radius = 0.125
flute_length = 1
shank_diameter = 0.5
stickout = 2
holder = [[1, 1.5, 0.5], [2, 2, 1]]
"""
    machine, found = load(tmp_path, text, "inch")
    assert found == []
    assert machine is not None
    assert machine.tool(3) == Tool(
        number=3, diameter=12.7, shape="bull", corner_radius=3.175, flute_length=25.4, shank_diameter=12.7,
        stickout=50.8, holder=((25.4, 38.1, 12.7), (50.8, 50.8, 25.4)),
    )  # fmt: skip


def test_a_base_file_gives_the_diameter(tmp_path: Path) -> None:
    (tmp_path / "cnc.ini").write_text("[TOOL_1]\ndiameter = 6\nzOffset = 30\n")
    machine, found = load(tmp_path, 'base = "cnc.ini"\n[tools.1]\nshape = "ball"\n')
    assert found == []
    assert machine is not None
    tool = machine.tool(1)
    assert tool is not None
    assert (tool.diameter, tool.shape, tool.length) == (6.0, "ball", 30.0)


def test_a_controllers_table_states_no_shape(tmp_path: Path) -> None:
    (tmp_path / "cnc.ini").write_text("[TOOL_1]\ndiameter = 6\n")
    machine, _ = load(tmp_path, 'base = "cnc.ini"\n')
    assert machine is not None
    tool = machine.tool(1)
    assert tool is not None and tool.shape is None


@pytest.mark.parametrize(
    ("text", "finding"),
    [
        ('shape = "flat"', "GP604 3 tools.1.diameter is missing"),
        ('diameter = 6\nshape = "round"', "GP603 5 tools.1.shape: 'round' is not one of flat, ball, bull, vee, drill"),
        ('diameter = 6\nshape = "bull"', "GP604 3 tools.1.corner_radius is missing"),
        ('diameter = 6\nshape = "vee"', "GP604 3 tools.1.tip_angle is missing"),
        ('diameter = 6\nshape = "bull"\ncorner_radius = 4', "GP603 6 tools.1.corner_radius: more than half of the"),
        ('diameter = 6\nshape = "ball"\ntip_angle = 60', "GP603 6 tools.1.tip_angle: a tool of shape 'ball' has none"),
        ('diameter = 6\nshape = "vee"\ntip_angle = 180', "GP603 6 tools.1.tip_angle: the angle of a tip"),
        ('diameter = 6\nshape = "vee"\ntip_angle = 60\ntip_diameter = 6', "GP603 7 tools.1.tip_diameter: the flat"),
        ("diameter = 6\ntip_angle = 60", "GP604 3 tools.1.shape is missing"),
        ('diameter = 6\nshape = "flat"\nholder = [[20, 20, 5]]', "GP604 3 tools.1.stickout is missing"),
        (
            'diameter = 6\nshape = "flat"\nstickout = 9\nholder = [[20, 5]]',
            "GP603 7 tools.1.holder: a part of a holder",
        ),
        ('diameter = 0\nshape = "flat"', "GP603 4 tools.1.diameter: 0 mm: a tool with a shape must have a width"),
        ('diameter = 6\nshape = "flat"\nflute_length = -1', "GP603 6 tools.1.flute_length"),
    ],
)
def test_mistakes(tmp_path: Path, text: str, finding: str) -> None:
    machine, found = load(tmp_path, f"[tools.1]\n{text}\n")
    assert machine is None
    assert len(found) == 1
    assert found[0].startswith(finding), found
