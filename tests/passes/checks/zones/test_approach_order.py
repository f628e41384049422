"""How high Z is before a tool is changed, before the way to where that is done, and at the start."""

from __future__ import annotations

from pathlib import Path

from passes.checks.zones.test_zones import HEAD, MACHINE, found, run, stated
from support.judging import answer

from gproof.ir.verdict import Verdict

ASKED = "\n[tool_change]\nclear_z = 40.0\n"
AREA = "\n[areas.tool_change]\nx = [300.0, 400.0]\ny = [300.0, 400.0]\nz = [-200.0, 0.0]\n"
OPEN = 'schema = "gproof-setup/1"\nactive_work = 1\ntool = 2\ng92 = {x = 0.0, y = 0.0, z = 0.0}\n'


def test_z_is_up_before_the_change(tmp_path: Path) -> None:
    for z, expected in (("40", []), ("39.9999", [("GP339", 3)])):
        judgement = run(tmp_path, f"{HEAD}G0 Z{z}\nT1 M6\nM30\n", MACHINE + ASKED, stated())
        assert found(judgement) == expected
        assert found(run(tmp_path, f"{HEAD}G0 Z{z}\nT1 M6\nM30\n", MACHINE, stated())) == []


def test_the_way_into_the_area_is_high(tmp_path: Path) -> None:
    way = f"{HEAD}G0 Z{{}}\nTCAGuard off\nG0 X350 Y350\nG1 Z-20\nG0 X360\nG0 Z50\nX0\nTCAGuard on\nM30\n"
    for z, expected in (("40", []), ("39", [("GP339", 4)])):
        judgement = run(tmp_path, way.format(z), MACHINE + ASKED + AREA, stated())
        assert [one for one in found(judgement) if one[0] != "GP312"] == expected, z


def test_an_arc_into_the_area_is_high_between_its_ends(tmp_path: Path) -> None:
    """From X290 to X310 at Z50 in G18: G3 seen from +Y goes over the ends, G2 10 below them."""
    way = f"{HEAD}G0 Z{{}}\nTCAGuard off\nG0 X290 Y350\nG18\nG{{}} X310 I10 K0\nG0 Z80\nG0 X0\nM30\n"
    for z, code, expected in ((50, 2, []), (50, 3, []), (49.9, 3, []), (49.9, 2, [("GP339", 6)])):
        judgement = run(tmp_path, way.format(z, code), MACHINE + ASKED + AREA, stated())
        assert [one for one in found(judgement) if one[0] != "GP312"] == expected, (z, code)


def test_the_first_move_is_high_where_that_is_asked(tmp_path: Path) -> None:
    start = ASKED + "at_start = true\n"
    assert found(run(tmp_path, f"{HEAD}G53 G0 Z50\nG0 X5\nZ5\nX9\nM30\n", MACHINE + start, stated())) == []
    assert found(run(tmp_path, f"{HEAD}G0 X5\nG53 G0 Z50\nM30\n", MACHINE + start, stated())) == [("GP339", 2)]
    assert found(run(tmp_path, f"{HEAD}G0 X5 Z50\nM30\n", MACHINE + start, stated())) == [("GP339", 2)]
    assert found(run(tmp_path, f"{HEAD}G0 X5\nG53 G0 Z50\nM30\n", MACHINE + ASKED, stated())) == []


def test_unknown_heights_are_conditions(tmp_path: Path) -> None:
    """Z rests on the work offset: 30 above it must be 40 of the machine, so it is at least 10."""
    judgement = run(tmp_path, f"{HEAD}G0 Z30\nT1 M6\nM30\n", MACHINE + ASKED, OPEN)
    (condition,) = [c for c in answer(judgement, "areas").conditions if c.terms == (("work.1.z", 1),)]
    assert (condition.low, condition.high) == (10.0, 70.0)
    at_once = run(tmp_path, f"{HEAD}T1 M6\nM30\n", MACHINE + ASKED, OPEN)
    (condition,) = answer(at_once, "areas").conditions
    assert (condition.terms, condition.low) == ((("start.z", 1),), 40.0)
    assert any("start position of Z is between 40.000 and" in a for a in answer(at_once, "areas").assumptions)
    homed = run(tmp_path, f"{HEAD}home z\nT1 M6\nM30\n", MACHINE + ASKED, OPEN)
    assert found(homed) == [("GP341", 3)]
    assert answer(homed, "areas").verdict is Verdict.UNKNOWN


def test_what_a_range_leaves_open(tmp_path: Path) -> None:
    for z, verdict in (("[10.0, 12.0]", "SAFE"), ("[9.0, 12.0]", "UNKNOWN"), ("[1.0, 9.0]", "UNSAFE")):
        setup = OPEN + f"[work.1]\nx = 0.0\ny = 0.0\nz = {z}\n"
        judgement = run(tmp_path, f"{HEAD}G0 Z30\nT1 M6\nM30\n", MACHINE + ASKED, setup)
        assert answer(judgement, "areas").verdict.value == verdict, z


def test_without_a_height_the_table_is_a_mistake(tmp_path: Path) -> None:
    from gproof.driver.dialects import load_machine
    from gproof.ir.finding import Findings

    path = tmp_path / "machine.toml"
    path.write_text('schema = "gproof-machine/1"\nunits = "mm"\n[tool_change]\nat_start = true\n')
    findings = Findings()
    load_machine(path, findings)
    assert [f.code.label for f in findings.kept] == ["GP604"]
