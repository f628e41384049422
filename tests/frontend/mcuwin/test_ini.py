"""McuWIN.ini and ToolComp.INI by hand from the APCI-8001 G-code manual, McuWIN V 2.5.3.133, 2.7 and 14."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given
from hypothesis import strategies as st
from support.campaigns import examples

from gproof.driver.dialects import load_machine
from gproof.frontend.mcuwin.ini_text import IniText, decimal
from gproof.frontend.mcuwin.machine import NO_MCUWIN
from gproof.frontend.mcuwin.tool_comp import load_tools
from gproof.ir.dialects.mcuwin.settings import NO_MCUWIN_SETTINGS, RadiusTool, mcuwin_settings
from gproof.ir.finding import Finding, Findings
from gproof.ir.machine import AXIS_NAMES, Machine
from gproof.ir.text import parse_ir, print_ir

OWN = """\
[MCU]
ProtocolFileName=C:\\Logs\\mcu.txt
MessageTask0Continue = 1
[EDITOR]
EditorFontSize=12
[Project data]
SelectedCardNr=2
[FEHLERTEXTE_EXT]
8=Achse prüfen
[FEHLERTEXTE48]
1=Vakuum fehlt
"""


def own(text: str, tmp_path: Path, name: str = "McuWIN.ini") -> tuple[Machine | None, list[Finding]]:
    path = tmp_path / name
    path.write_bytes(text.encode("cp1252"))
    findings = Findings()
    machine, files = load_machine(path, findings)
    assert files[0][0] == str(path)
    return machine, findings.kept


def tools(text: str, tmp_path: Path, unit: Fraction | None = Fraction(1)) -> tuple[object, list[tuple[str, int, str]]]:
    path = tmp_path / "ToolComp.INI"
    path.write_bytes(text.encode("cp1252"))
    findings = Findings()
    found, files = load_tools(path, findings, unit)
    assert [name for name, _ in files] == [str(path)]
    return found, [(f.code.label, f.span.line, f.message) for f in findings.kept]


def tool(plane: str, number: int, radius: float | None, length: float | None) -> RadiusTool:
    return RadiusTool(plane=plane, number=number, radius=radius, length=length)


def test_the_file_of_the_manual_has_two_tools(tmp_path: Path) -> None:
    found, said = tools("[ToolsXY]\nR0=0.0\nL0=0.0\nR1=5,0\nL1=2,0\n", tmp_path)
    assert found == (tool("xy", 0, 0.0, 0.0), tool("xy", 1, 5.0, 2.0))
    assert not said


def test_tools_of_three_planes_in_any_case_and_order(tmp_path: Path) -> None:
    text = """
; tools of the engraver
[TOOLSZX]
  r2 = 1,25
[ toolsyz ]
L2=-3
R2= +.5
[ToolsXY]
R2=3.
'
R1=0,2
L1=0
"""
    found, said = tools(text, tmp_path)
    assert found == (
        tool("xy", 1, 0.2, 0.0), tool("xy", 2, 3.0, None), tool("yz", 2, 0.5, -3.0), tool("zx", 2, 1.25, None),
    )  # fmt: skip
    assert not said


def test_a_file_without_tools_is_an_empty_table(tmp_path: Path) -> None:
    assert tools("", tmp_path) == ((), [])
    assert tools("[ToolsXY]\n", tmp_path) == ((), [])


def test_of_a_file_in_an_unknown_unit_only_zeros_are_known(tmp_path: Path) -> None:
    found, said = tools("[ToolsXY]\nR0=0\nL0=0,0\nR1=5\nL1=-2\n", tmp_path, None)
    assert found == (tool("xy", 0, 0.0, 0.0), tool("xy", 1, None, None))
    assert not said


def test_inches_are_rounded_once(tmp_path: Path) -> None:
    found, _ = tools("[ToolsXY]\nR1=0,1\n", tmp_path, Fraction(127, 5))
    assert found == (tool("xy", 1, 2.54, None),)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("[ToolsXY]\nR1=-5\n", ("GP603", 2, "the radius -5 is below 0")),
        ("[ToolsXY]\nR1=1,234.5\n", ("GP603", 2, "'1,234.5' is not a number")),
        ("[ToolsXY]\nR1=1.000,5\n", ("GP603", 2, "is not a number")),
        ("[ToolsXY]\nR1=5 mm\n", ("GP603", 2, "'5 mm' is not a number")),
        ("[ToolsXY]\nR1=5 ; end mill\n", ("GP603", 2, "is not a number")),
        ("[ToolsXY]\nR1=\n", ("GP603", 2, "there is no number")),
        ("[ToolsXY]\nR1=1e-3\n", ("GP603", 2, "is not a number")),
        ("[ToolsXY]\nR1=5\nr1=5,1\n", ("GP603", 3, "another value than in line 2")),
        ("[ToolsXY]\nR1=5\n[ToolsYZ]\n[TOOLSXY]\nR2=1\n", ("GP603", 4, "is already in line 1")),
        ("[ToolsXY]\nR10000=5\n", ("GP603", 2, "numbered from 0 to 9999")),
        ("[ToolsXY]\nR1 5\n", ("GP601", 2, "neither [section] nor key=value")),
        ("[ToolsXY\nR1=5\n", ("GP601", 1, "neither [section] nor key=value")),
        ("[ToolsXY]\n=5\n", ("GP601", 2, "neither [section] nor key=value")),
        ("[ToolsXY]\nR1=\x0b5\n", ("GP601", 2, "control character U+000B")),
    ],
)
def test_a_mistake_in_the_tool_table_stands_at_its_line(text: str, said: tuple[str, int, str], tmp_path: Path) -> None:
    found, told = tools(text, tmp_path)
    assert found is None
    assert (told[0][:2], said[2] in told[0][2]) == (said[:2], True), told


@pytest.mark.parametrize(
    ("text", "line", "key"),
    [
        ("R1=5\n", 1, "R1"),
        ("[Tools]\nR1=5\n[ToolsXY]\n", 1, "[Tools]"),
        ("[ToolsXZ]\nR1=5\n", 1, "[ToolsXZ]"),
        ("[ToolsXY]\nD1=5\n", 2, "[ToolsXY] D1"),
        ("[ToolsXY]\nR01=5\n", 2, "[ToolsXY] R01"),
        ("[ToolsXY]\nR=5\n", 2, "[ToolsXY] R"),
        ("[ToolsXY]\nName1=end mill\n", 2, "[ToolsXY] Name1"),
    ],
)
def test_what_the_layout_does_not_have_is_told_and_is_no_tool(text: str, line: int, key: str, tmp_path: Path) -> None:
    found, told = tools(text, tmp_path)
    assert found == ()
    assert [(label, at) for label, at, _ in told] == [("GP602", line)]
    assert f"{key!r}" in told[0][2]


def test_the_same_value_twice_is_no_mistake(tmp_path: Path) -> None:
    assert tools("[ToolsXY]\nR1=5\nR1=5\n", tmp_path) == ((tool("xy", 1, 5.0, None),), [])


def test_a_table_that_is_no_text_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "t.ini"
    for raw in (b"\xff\xfe[\0T\0", b"[ToolsXY]\0"):
        path.write_bytes(raw)
        findings = Findings()
        assert load_tools(path, findings, Fraction(1))[0] is None
        assert [f.code.label for f in findings.kept] == ["GP601"]
    findings = Findings()
    assert load_tools(tmp_path / "none.ini", findings, Fraction(1)) == (None, [])
    assert findings.kept


def test_without_a_file_six_axes_have_their_places_and_nothing_is_known_of_them() -> None:
    assert tuple(axis.name for axis in NO_MCUWIN.axes) == AXIS_NAMES
    assert all(axis.lower is None and axis.position_unit is None for axis in NO_MCUWIN.axes)
    assert (NO_MCUWIN.controller.dialect, NO_MCUWIN.settings) == ("mcuwin", NO_MCUWIN_SETTINGS)
    NO_MCUWIN.verify()
    assert parse_ir(print_ir(NO_MCUWIN)) == NO_MCUWIN


def test_keys_that_the_manual_names_are_kept(tmp_path: Path) -> None:
    machine, said = own(OWN, tmp_path)
    assert machine is not None
    assert not said
    assert machine.axes == NO_MCUWIN.axes
    assert machine.settings == replace(NO_MCUWIN_SETTINGS, tools=())
    assert ("[MCU] ProtocolFileName", "C:\\Logs\\mcu.txt") in machine.kept
    assert ("[FEHLERTEXTE_EXT] 8", "Achse prüfen") in machine.kept
    assert len(machine.kept) == 6
    assert not machine.not_modelled
    assert parse_ir(print_ir(machine)) == machine


def test_settings_that_are_not_known_when_nobody_states_them_are_kept(tmp_path: Path) -> None:
    machine, said = own("[MCU]\nLookAhead=50\nNoTriangle=1\nFreeingVelFactor=0,1\nCaseInsensitive=1\n", tmp_path)
    assert machine is not None
    assert not said
    assert len(machine.kept) == 4
    assert not machine.not_modelled
    assert mcuwin_settings(machine).case_sensitive is None


@pytest.mark.parametrize(
    ("line", "key"),
    [
        ("PreIncludeFile=init.src", "pre_include"),
        ("PostInclude=", "post_include"),
        ("ToolFile=Tools.INI", "tool_file"),
        ("ShortestWay=1", "shortest_path"),
        ("LineNumbers=0", "line_numbers"),
        ("PositionUnit=1", "position_unit"),
    ],
)
def test_a_key_that_may_hold_a_setting_makes_jobs_unknown(line: str, key: str, tmp_path: Path) -> None:
    machine, said = own(f"[MCU]\n{line}\n", tmp_path)
    assert machine is not None
    assert not said
    assert [(one.stated_by, one.line, one.file, one.axis) for one in machine.not_modelled] == [
        (key, 2, "McuWIN.ini", "")
    ]
    assert f"{key} in [din]" in machine.not_modelled[0].why


def test_a_key_of_an_unknown_name_may_hold_any_of_them(tmp_path: Path) -> None:
    machine, said = own("[Desktop]\nColour=3\nPreInclude=a.src\n", tmp_path)
    assert machine is not None
    assert [(f.code.label, f.span.line) for f in said] == [("GP602", 2)]
    assert machine.unknown_keys == (("McuWIN.ini", "[Desktop] Colour"),)
    assert [(one.stated_by, one.line) for one in machine.not_modelled] == [
        ("pre_include", 3), ("tool_file post_include shortest_path line_numbers position_unit", 2),
    ]  # fmt: skip


def test_the_tool_table_lies_beside_the_file(tmp_path: Path) -> None:
    (tmp_path / "toolcomp.ini").write_text("[ToolsXY]\nR1=2\n")
    machine, said = own(OWN, tmp_path)
    assert machine is not None
    assert mcuwin_settings(machine).tools == (tool("xy", 1, 2.0, None),)
    assert not said
    (tmp_path / "toolcomp.ini").write_text("[ToolsXY]\nR1=-2\n")
    assert own(OWN, tmp_path)[0] is None


@pytest.mark.parametrize(
    ("name", "text", "dialect"),
    [
        ("anything.ini", "[Project data]\nSelectedCardNr=1\n", "mcuwin"),
        ("anything.ini", "[editor]\n[mcu]\n", "mcuwin"),
        ("anything.ini", "[FEHLERTEXTE48]\n", "mcuwin"),
        ("anything.ini", "unit=mm\naxischar=XYZ\naxisspec=r1000a100\naxisspec=r1a1\naxisspec=r1a1\n", "wincnc"),
        ("anything.ini", "[JOINT_0]\nvisible=1\n", "eding"),
        ("MCUWIN.INI", "", "mcuwin"),
    ],
)
def test_whose_file_it_is_says_its_content(name: str, text: str, dialect: str, tmp_path: Path) -> None:
    machine, _ = own(text, tmp_path, name)
    assert machine is not None
    assert machine.controller.dialect == dialect


def test_a_tool_table_is_no_machine(tmp_path: Path) -> None:
    machine, said = own("[ToolsXY]\nR1=5\n", tmp_path, "ToolComp.INI")
    assert machine is None
    assert [(f.code.label, f.span.line) for f in said] == [("GP601", 1)]
    assert "McuWIN.ini" in said[0].message


@pytest.mark.parametrize(
    ("text", "value"),
    [("5", 5), ("5,0", 5), ("5.25", Fraction(21, 4)), (",5", Fraction(1, 2)), ("-3.", -3), ("+1", 1)],
)
def test_decimals(text: str, value: Fraction) -> None:
    assert decimal(text) == value


@pytest.mark.parametrize("text", ["", ",", ".", "1,2,3", "1.2.3", "1 2", "0x1", "1e3", "inf", "٣", "9" * 41, "9" * 14])
def test_no_decimals(text: str) -> None:
    assert decimal(text) is None


PIECES = st.sampled_from(
    ["[", "]", "=", ";", "'", "\n", "\r\n", "\r", " ", "\t", "R1", "L1", "ToolsXY", "toolsYZ", "MCU", "PreInclude", "5",
     "5,0", "-1", ".", ",", "é", "\x00", "\x1a", "\x0b", "[ToolsXY]\n", "[MCU]\n", "R2=1\n", "\ufeff", "=" * 9]
)  # fmt: skip


@examples(75, 1200, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(raw=st.one_of(st.binary(max_size=200), st.lists(PIECES, max_size=30).map(lambda p: "".join(p).encode("utf-8"))))
def test_any_bytes_give_tools_a_machine_or_findings(raw: bytes, tmp_path: Path) -> None:
    for name in ("ToolComp.INI", "McuWIN.ini"):
        (tmp_path / name).write_bytes(raw)
    findings = Findings()
    found, _ = load_tools(tmp_path / "ToolComp.INI", findings, Fraction(1))
    assert (found is None) == any(f.code.label in ("GP601", "GP603") for f in findings.kept)
    for one in found or ():
        assert one.radius is None or one.radius >= 0
    findings = Findings()
    machine, _ = load_machine(tmp_path / "McuWIN.ini", findings)
    assert (machine is None) == any(f.code.label in ("GP601", "GP603") for f in findings.kept)
    if machine is not None:
        machine.verify()
        assert parse_ir(print_ir(machine)) == machine
    lines = raw.replace(b"\r\n", b"\n").replace(b"\r", b"\n").count(b"\n") + 1
    assert all(0 <= f.span.line <= lines for f in findings.kept)


def test_sections_without_a_header_belong_to_no_section(tmp_path: Path) -> None:
    (tmp_path / "a.ini").write_text("a=1\n[]\nb=2\n")
    file = IniText(tmp_path / "a.ini", Findings())
    assert {name: list(table) for name, table in file.sections.items()} == {"": ["a", "b"]}
