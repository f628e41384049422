"""[din] and the other keys of gproof's own machine file that a McuWIN machine needs."""

from __future__ import annotations

import math
import re
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given
from hypothesis import strategies as st
from support.campaigns import examples

from gproof.driver.dialects import load_machine
from gproof.ir.dialects.eding.settings import EdingSettings
from gproof.ir.dialects.mcuwin.settings import ACTIONS, McuWinSettings, RadiusTool, TaskCode, mcuwin_settings
from gproof.ir.finding import Findings
from gproof.ir.machine import Machine
from gproof.ir.text import parse_ir, print_ir

HEAD = 'schema = "gproof-machine/1"\nunits = "mm"\n'
AXES = "[axes.x]\n[axes.y]\n[axes.z]\n[axes.c]\n"


def load(text: str, tmp_path: Path, head: str = HEAD) -> tuple[Machine | None, Findings]:
    path = tmp_path / "mill.toml"
    path.write_text(head + text)
    findings = Findings()
    machine, files = load_machine(path, findings)
    assert Path(files[0][0]).name == "mill.toml"
    return machine, findings


def din_of(text: str, tmp_path: Path, head: str = HEAD) -> McuWinSettings:
    machine, findings = load(text, tmp_path, head)
    assert machine is not None, findings.kept
    assert not findings.kept
    assert parse_ir(print_ir(machine)) == machine
    return mcuwin_settings(machine)


def messages(text: str, tmp_path: Path, head: str = HEAD) -> list[str]:
    machine, findings = load(text, tmp_path, head)
    assert (machine is None) == any(f.code.label in ("GP601", "GP603", "GP604", "GP611") for f in findings.kept)
    return [f"{f.code.label} {f.span.line}: {f.message}" for f in findings.kept]


def test_every_key(tmp_path: Path) -> None:
    text = (
        AXES
        + """
[din]
version = "2.5.3.32"
case_sensitive = false
line_numbers = true
position_unit = "inch"
time_unit = "s"
absolute_centers = true
interpolation_axes = "XYc"
zero_offsets = [[1, 2, 3, 90], [-4.5, 0, 0, 0]]
angle_unit = "degrees"
wait_unit = "s"
arc_tolerance = 0.01
program_size = 500000
pre_include = "lib/init.src"
post_include = "end.src"
persistence = "keep"

[din.task0]
M03 = "spindle_cw"
t = { does = "tool_select", breaks = true, parameters = 1 }
G210 = { parameters = 2 }
"""
    )
    assert din_of(text, tmp_path) == McuWinSettings(
        version="2.5.3.32", case_sensitive=False, line_numbers=True, position_unit=25.4, time_unit=1.0,
        absolute_centers=True, interpolation_axes="XYC",
        zero_offsets=((1.0, 2.0, 3.0, 0.0, 0.0, 90.0), (-4.5, 0.0, 0.0, 0.0, 0.0, 0.0)),
        tasks=(
            TaskCode(code="M3", action="spindle_cw"),
            TaskCode(code="T", action="tool_select", breaks=True, parameters=1),
            TaskCode(code="G210", parameters=2),
        ),
        angle_unit="degrees", wait_unit=1.0, arc_tolerance=0.01, program_size=500_000,
        pre_include="lib/init.src", post_include="end.src", keeps_over_codes=True, tools=(),
        unstated=("shortest_path", "tool_file", "error_compensation"),
    )  # fmt: skip


def test_lengths_are_in_the_unit_of_the_file(tmp_path: Path) -> None:
    text = AXES + "[din]\narc_tolerance = 0.001\nzero_offsets = [[1, 0, 0, 30]]\n"
    din = din_of(text, tmp_path, HEAD.replace('"mm"', '"inch"'))
    assert din.arc_tolerance == 0.0254
    assert din.zero_offsets == ((25.4, 0.0, 0.0, 0.0, 0.0, 30.0),)


def test_the_table_makes_it_a_machine_of_this_dialect(tmp_path: Path) -> None:
    machine, _ = load("[din]\n", tmp_path)
    assert machine is not None
    assert machine.controller.dialect == "mcuwin"
    assert len(machine.axes) == 6
    machine, _ = load('[controller]\ndialect = "mcuwin"\n[axes.x]\n', tmp_path)
    assert machine is not None
    assert machine.settings == McuWinSettings(tools=())
    assert [axis.name for axis in machine.axes] == ["x"]
    machine, _ = load('[controller]\ndialect = "eding"\n', tmp_path)
    assert machine is not None
    assert machine.settings == EdingSettings()


@pytest.mark.parametrize("action", ACTIONS)
def test_every_action(action: str, tmp_path: Path) -> None:
    assert din_of(f'[din.task0]\nM299 = "{action}"\n', tmp_path).tasks == (TaskCode(code="M299", action=action),)


@pytest.mark.parametrize(
    "code", ["S", "T", "D", "G74", "G200", "G299", "M0", "M2", "M6", "M30", "M100", "M199", "m007"]
)
def test_codes_that_are_left_to_task_0(code: str, tmp_path: Path) -> None:
    tasks = din_of(f'[din.task0]\n{code} = "nothing"\n', tmp_path).tasks
    assert tasks is not None
    assert [task.code for task in tasks] == [{"m007": "M7"}.get(code, code)]


@pytest.mark.parametrize("code", ["G0", "G1", "G4", "G199", "G300", "M1", "M17", "M26", "M96", "M98", "M901", "F", "X",
                                  "M", "M1000", "G2000", "'M3.5'", "'M 3'", "'M٣'"])  # fmt: skip
def test_codes_that_are_not(code: str, tmp_path: Path) -> None:
    said = messages(f'[din]\n[din.task0]\n{code} = "nothing"\n', tmp_path)
    assert len(said) == 1
    assert said[0].startswith("GP603 ")
    assert "not a code for Task 0" in said[0]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ('[din]\nversion = "3"\n', "GP603 4: din.version: '3' is not one of 2.5.3.133, 2.5.3.32"),
        ("[din]\ncase_sensitive = 1\n", "GP603 4: din.case_sensitive: 1 is not true or false"),
        ('[din]\nposition_unit = "cm"\n', "GP603 4: din.position_unit: 'cm' is not one of mm, inch"),
        ('[din]\ntime_unit = "h"\n', "GP603 4: din.time_unit: 'h' is not one of min, s"),
        ('[din]\ninterpolation_axes = "XX"\n', "GP603 4: din.interpolation_axes: 'XX': letters of axes"),
        ('[axes.x]\n[din]\ninterpolation_axes = "XY"\n', "GP603 5: din.interpolation_axes: 'XY': letters of axes"),
        ('[axes.x]\n[din]\ninterpolation_axes = ""\n', "GP603 5: din.interpolation_axes"),
        ("[din]\nzero_offsets = [[], [], [], [], [], []]\n", "GP603 4: din.zero_offsets: 6 records; the table has 5"),
        ("[axes.x]\n[din]\nzero_offsets = [[1, 2]]\n", "GP603 5: din.zero_offsets: record 0 has 2 numbers; the"),
        ("[din]\nzero_offsets = [1]\n", "GP603 4: din.zero_offsets: 1 is not a list of numbers"),
        ("[din]\narc_tolerance = -1\n", "GP603 4: din.arc_tolerance: -1 is not 0 or greater than 0"),
        ("[din]\nprogram_size = 0\n", "GP603 4: din.program_size: 0 is not a whole number from 1 to 12582912"),
        ('[din]\npre_include = "a\\nb"\n', "GP603 4: din.pre_include: a file name must have no control characters"),
        ('[din]\npersistence = "loose"\n', "GP603 4: din.persistence: 'loose' is not one of strict, keep"),
        ('[din]\ntool_file = "no.ini"\n', "GP601 4: cannot read the file: there is no file 'no.ini'"),
        ("[din]\ntool_file = 3\n", "GP603 4: din.tool_file: 3 is not text"),
        ('[din]\ncolour = "red"\n', "GP611 4: there is no key 'din.colour'"),
        ("din = 3\n", "GP603 3: din: 3 is not a table"),
        ("[din]\ntask0 = 3\n", "GP603 4: din.task0: 3 is not a table"),
        ('[din.task0]\nM3 = "jump"\n', "GP603 4: din.task0.M3: 'jump' is not one of"),
        ("[din.task0]\nM3 = 1\n", "GP603 4: din.task0.M3: 1 is not text"),
        ('[din.task0]\nM3 = "stop"\nM03 = "end"\n', "GP603 5: din.task0.M03: M3 is the same code"),
        ("[din.task0]\nM3 = {colour = 1}\n", "GP611 4: there is no key 'din.task0.M3.colour'"),
        ("[din.task0]\nM3 = {parameters = -1}\n", "GP603 4: din.task0.M3.parameters"),
        ('[axes.x]\nposition_unit = "deg"\n', "GP603 4: axes.x.position_unit: 'deg' is not one of mm, cm, m, um, inch"),
        ('[axes.c]\nposition_unit = "mm"\n', "GP603 4: axes.c.position_unit: 'mm' is not one of deg, rev, rad"),
    ],
)
def test_mistakes(text: str, said: str, tmp_path: Path) -> None:
    found = messages(text, tmp_path)
    assert len(found) == 1
    assert found[0].startswith(said), found


def test_axis_data_of_mcfg(tmp_path: Path) -> None:
    machine, findings = load('[axes.x]\nposition_unit = "inch"\n[axes.c]\nposition_unit = "rad"\n[din]\n', tmp_path)
    assert machine is not None
    assert not findings.kept
    x, c = machine.axes
    assert (x.position_unit, c.position_unit) == (25.4, 180 / math.pi)


def test_the_tool_table_that_is_named_is_read_from_beside_the_file(tmp_path: Path) -> None:
    (tmp_path / "lib").mkdir()
    (tmp_path / "lib" / "Mill.INI").write_text("[ToolsZX]\nR3=1,5\n")
    (tmp_path / "ToolComp.INI").write_text("[ToolsXY]\nR1=9\n")
    found = RadiusTool(plane="zx", number=3, radius=1.5)
    assert din_of('[din]\ntool_file = "lib/Mill.INI"\n', tmp_path).tools == (found,)
    assert din_of('[din]\ntool_file = ""\n', tmp_path).tools == ()
    assert din_of("[din]\n", tmp_path).tools == (RadiusTool(plane="xy", number=1, radius=9.0),)


def test_without_the_usual_file_there_is_no_tool_table(tmp_path: Path) -> None:
    assert din_of("[din]\n", tmp_path).tools == ()


def test_the_unit_of_the_tool_table(tmp_path: Path) -> None:
    (tmp_path / "ToolComp.INI").write_text("[ToolsXY]\nR1=0,5\n")

    def radius(text: str) -> float | None:
        tools = din_of(f"[din]\n{text}", tmp_path).tools
        assert tools is not None
        return tools[0].radius

    assert radius("") == 0.5
    assert radius('position_unit = "inch"') is None
    assert radius('position_unit = "inch"\ntool_unit = "inch"') == 12.7
    assert radius('position_unit = "inch"\ntool_unit = "mm"') == 0.5


def test_a_mistake_in_the_tool_table_makes_the_machine_bad(tmp_path: Path) -> None:
    (tmp_path / "ToolComp.INI").write_text("[ToolsXY]\nR1=a\n")
    said = messages("[din]\n", tmp_path)
    assert len(said) == 1
    assert said[0].startswith("GP603 2: [ToolsXY] R1")


BASE = HEAD + 'base = "ctrl/McuWIN.ini"\n'


def folder(tmp_path: Path, ini: str) -> None:
    (tmp_path / "ctrl").mkdir(exist_ok=True)
    (tmp_path / "ctrl" / "McuWIN.ini").write_text(ini)
    (tmp_path / "ctrl" / "ToolComp.INI").write_text("[ToolsXY]\nR1=2\n")


def test_a_file_refines_mcuwin_ini(tmp_path: Path) -> None:
    folder(tmp_path, "[MCU]\nMessageTask1Continue=1\n")
    machine, findings = load("[axes.x]\nmin = 0\nmax = 300\n[axes.z]\n", tmp_path, BASE)
    assert machine is not None
    assert not findings.kept
    assert [axis.name for axis in machine.axes] == ["x", "z"]
    left = ("pre_include", "post_include", "shortest_path", "error_compensation")
    assert machine.settings == McuWinSettings(tools=(RadiusTool(plane="xy", number=1, radius=2.0),), unstated=left)
    assert machine.kept == (("[MCU] MessageTask1Continue", "1"),)
    machine, _ = load('[din]\ntool_file = "ctrl/ToolComp.INI"\nposition_unit = "inch"\n', tmp_path, BASE)
    assert machine is not None
    assert mcuwin_settings(machine).tools == (RadiusTool(plane="xy", number=1),)


def test_what_the_refining_file_states_is_no_longer_open(tmp_path: Path) -> None:
    folder(tmp_path, "[Desktop]\nColour=3\nPreInclude=x.src\n")
    machine, _ = load("", tmp_path, BASE)
    assert machine is not None
    assert len(machine.not_modelled) == 2
    machine, _ = load('[din]\npre_include = "ctrl/x.src"\npost_include = ""\n', tmp_path, BASE)
    assert machine is not None
    assert [one.stated_by for one in machine.not_modelled] == ["tool_file shortest_path line_numbers position_unit"]
    assert "pre_include" not in machine.not_modelled[0].text
    text = '[din]\npre_include = ""\npost_include = ""\ntool_file = ""\nline_numbers = false\nposition_unit = "mm"\n'
    machine, _ = load(text + "shortest_path = false\n", tmp_path, BASE)
    assert machine is not None
    assert not machine.not_modelled


def test_the_shortest_path_leaves_jobs_open_that_turn(tmp_path: Path) -> None:
    machine, _ = load(AXES + "[din]\nshortest_path = true\n", tmp_path)
    assert machine is not None
    assert [(one.axis, one.line) for one in machine.not_modelled] == [("c", 8)]
    machine, _ = load("[din]\nshortest_path = true\n", tmp_path)
    assert machine is not None
    assert [one.axis for one in machine.not_modelled] == ["a", "b", "c"]


def test_what_no_file_states_is_remembered(tmp_path: Path) -> None:
    assert din_of("[din]\n", tmp_path).unstated == (
        "pre_include", "post_include", "shortest_path", "tool_file", "error_compensation",
    )  # fmt: skip
    text = '[din]\npost_include = ""\nshortest_path = false\nerror_compensation = false\ntool_file = ""\n'
    assert din_of(text, tmp_path).unstated == ("pre_include",)


def test_compensated_errors_leave_every_axis_open(tmp_path: Path) -> None:
    machine, _ = load(AXES + "[din]\nerror_compensation = true\n", tmp_path)
    assert machine is not None
    assert [one.axis for one in machine.not_modelled] == [axis.name for axis in machine.axes]


def test_a_file_refines_another_one(tmp_path: Path) -> None:
    (tmp_path / "sub").mkdir()
    (tmp_path / "sub" / "base.toml").write_text(
        HEAD + '[din]\npre_include = "init.src"\ntool_file = "t.ini"\n[din.task0]\nM3 = "spindle_cw"\nM8 = "unknown"\n'
    )
    (tmp_path / "sub" / "t.ini").write_text("[ToolsXY]\nR1=2\n")
    (tmp_path / "ToolComp.INI").write_text("[ToolsXY]\nR1=7\n")
    head = HEAD + 'base = "sub/base.toml"\n'
    din = din_of('[din.task0]\nM8 = "coolant_on"\nM3 = { breaks = false }\n', tmp_path, head)
    assert din.pre_include == "sub/init.src"
    assert din.tools == (RadiusTool(plane="xy", number=1, radius=2.0),)
    assert din.tasks == (
        TaskCode(code="M3", action="spindle_cw", breaks=False), TaskCode(code="M8", action="coolant_on"),
    )  # fmt: skip
    said = messages('[din]\nposition_unit = "inch"\n', tmp_path, head)
    assert len(said) == 1
    assert "state tool_file here to read the tools again" in said[0]
    assert din_of('[din]\nposition_unit = "inch"\ntool_file = ""\n', tmp_path, head).tools == ()


KEYS = re.findall(
    r'\.(?:text|positive|whole|boolean|table|grid)\("(\w+)"',
    (Path(__file__).resolve().parents[3] / "frontend" / "mcuwin" / "machine_table.py").read_text("utf-8"),
)
VALUES = st.recursive(
    st.sampled_from(
        ["true", "0", "-1", "1", "1e400", "nan", '""', '"mm"', '"inch"', '"s"', '"XYZ"', '"ToolComp.INI"', '"\\u0000"',
         '"/"', '"home"', "0.5", "100000", "99999999999999999999", "1979-05-27"]
    ),
    lambda inner: st.one_of(
        st.lists(inner, max_size=3).map(lambda items: f"[{', '.join(items)}]"),
        st.dictionaries(st.sampled_from(["M3", "G74", "S", "does", "breaks", "x"]), inner, max_size=2).map(
            lambda table: "{" + ", ".join(f"{key} = {value}" for key, value in table.items()) + "}"
        ),
    ),
    max_leaves=6,
)  # fmt: skip


@examples(60, 600, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(table=st.dictionaries(st.sampled_from(KEYS), VALUES, max_size=5))
def test_any_values_give_a_machine_or_findings(table: dict[str, str], tmp_path: Path) -> None:
    text = "".join(f"{key} = {value}\n" for key, value in table.items())
    machine, findings = load(f"{AXES}[din]\n{text}", tmp_path)
    assert (machine is None) == any(f.code.label in ("GP601", "GP603", "GP604", "GP611") for f in findings.kept), text
    if machine is not None:
        machine.verify()
        assert parse_ir(print_ir(machine)) == machine
