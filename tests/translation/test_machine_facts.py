"""Facts of machine and setup files that change what a program means: diameters, cylinders, height maps, memory."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import pytest
from support.target_machines import machine_like
from support.traps import machine_files

from gproof.driver.errors import UsageError
from gproof.driver.translation import Translation, Wanted, translate
from gproof.ir.verdict import Verdict

MODES = "G18 G21 G90 G94 G40 G49 G80 G54\n"
DIAMETERS = "diameter_programming = true\n"
HEIGHTS = "[height_map]\nfile = 'heights.txt'\non = true\n"
CYLINDER = "[cylinder]\nradius = 20.0\ny = 0.0\nz = 0.0\nzero = 0.0\n"


def eding(folder: Path, text: str, to: str, machine: str = "", setup: str = "", machine_to: str = "") -> Translation:
    """A program of Eding CNC for the machine of the traps, with more lines in its file and in the other one."""
    file = folder / "machine.toml"
    file.write_text(machine_files("eding")["machine.toml"].decode() + machine, encoding="utf-8")
    (folder / "job.cnc").write_text(text, encoding="utf-8")
    (folder / "setup.toml").write_text(f'schema = "gproof-setup/1"\n{setup}', encoding="utf-8")
    other = machine_like(file, to, folder / to)
    other.write_text(other.read_text(encoding="utf-8") + machine_to, encoding="utf-8")
    wanted = Wanted(
        job=folder / "job.cnc", to=to, machine=file, machine_to=other, dialect="eding", setup=str(folder / "setup.toml")
    )
    return translate(wanted)


TURNED = f"{MODES}G0 X40 Z2\nG1 Z-10 F100\nG2 X50 Z-15 R5\nG91 G1 X2\nG90\n#1 = 30\nG0 X[#1 * 2]\nM30\n"


@pytest.mark.parametrize("to", ["linuxcnc", "grbl"])
def test_diameters_are_places_on_other_controllers(to: str, tmp_path: Path) -> None:
    """X40 is 20 from the centre line, X2 in G91 is 1 (Eding CNC 2.1.14); radii of arcs stay."""
    done = eding(tmp_path, TURNED, to, DIAMETERS)
    assert done.verdict is Verdict.SAFE, [one.message for one in done.findings.kept]
    text = done.files[""].decode()
    assert "X20 Z2" in text and "X25 Z-15 R5" in text and "X1\n" in text and "X40" not in text


def test_diameters_stay_on_a_machine_that_has_them_too(tmp_path: Path) -> None:
    done = eding(tmp_path, TURNED, "eding", DIAMETERS)
    assert done.verdict is Verdict.SAFE, [one.message for one in done.findings.kept]
    text = done.files[""].decode()
    assert "X40 Z2" in text and "X50 Z-15 R5" in text and "X2\n" in text


def test_a_machine_with_diameters_is_none_of_linuxcnc(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="diameter_programming"):
        eding(tmp_path, TURNED, "linuxcnc", machine_to=DIAMETERS)


@pytest.mark.parametrize("to", ["linuxcnc", "wincnc", "mcuwin", "grbl"])
def test_what_only_the_setup_states_of_the_path_is_refused(to: str, tmp_path: Path) -> None:
    """No line of the job has it, and no line of the other one could."""
    (tmp_path / "heights.txt").write_text("0 0 0\n10 0 0.1\n0 10 0.1\n10 10 0.1\n")
    for setup, name in ((CYLINDER, "Y mapped onto A"), (HEIGHTS, "height compensation")):
        try:
            done = eding(tmp_path, f"{MODES}G0 X40 Y10 Z2\nM30\n", to, setup=setup)
        except UsageError as error:
            raise AssertionError([one.message for one in error.findings.kept] if error.findings else error) from None
        assert done.verdict is Verdict.UNKNOWN and not done.files
        assert [one.code.label for one in done.findings.kept] == ["GP703"] and name in done.findings.kept[0].message


PARKING = "[parameters]\n" + "".join(f"{first + n} = {5.0 + n}\n" for first in (5161, 5181) for n in range(3))


@pytest.mark.parametrize("to", ["linuxcnc", "grbl"])
def test_parking_places_are_those_of_the_setup(to: str, tmp_path: Path) -> None:
    """G28 of Eding CNC goes on with every axis (3.4.8), that of LinuxCNC with those that are named (G-Codes G28)."""
    text = f"{MODES.replace('G18', 'G17')}G0 X40 Y10 Z2\nG28 Z9\nG0 X1\nG30\nM30\n"
    done = eding(tmp_path, text, to, setup=PARKING)
    assert done.verdict is Verdict.SAFE, [one.message for one in done.findings.kept]
    lines = done.files[""].decode().splitlines()
    assert lines[lines.index("G28") - 1] == "Z9" and "G30" in lines
    assert "the parking place (G28) of the target program is 7 mm (Z)" in done.assumed
    # Where nobody states them, the job itself is open.
    assert eding(tmp_path, text, to).verdict is Verdict.UNKNOWN


@pytest.mark.parametrize("to", ["linuxcnc", "mcuwin", "wincnc", "grbl"])
def test_a_variable_that_the_job_does_not_set_has_the_value_of_the_setup(to: str, tmp_path: Path) -> None:
    """On its own controller the operator has set #100 (Eding CNC 3.1.1); another one has nothing there."""
    text = f"{MODES.replace('G18', 'G17')}G0 X[#100 * 2] Y1\nif [#100 > 3]\nG0 X1\nendif\nM30\n"
    done = eding(tmp_path, text, to, setup="[parameters]\n100 = 5.0\n")
    assert done.verdict is Verdict.SAFE, [one.message for one in done.findings.kept]
    done = eding(tmp_path, text, to)
    assert done.verdict is Verdict.UNKNOWN and not done.files
    assert "variable #100 cannot be translated" in done.findings.kept[0].message


def test_a_program_that_is_too_long_for_the_controller_is_refused(tmp_path: Path) -> None:
    """SZTSK3 of McuWIN (13.1.1.13): 100 lines of moves are more than 500 bytes."""
    moves = "".join(f"X{n % 7} Y{n}\n" for n in range(100))
    text = f"{MODES.replace('G18', 'G17')}G0 X0 Y0\nG1 X1 F100\n{moves}M30\n"
    assert eding(tmp_path, text, "mcuwin").verdict is Verdict.SAFE
    folder = tmp_path / "small"
    folder.mkdir()
    file = folder / "machine.toml"
    file.write_bytes(machine_files("eding")["machine.toml"])
    other = machine_like(file, "mcuwin", folder / "mcuwin")
    other.write_text(other.read_text().replace("program_size = 500000", "program_size = 500"))
    wanted = Wanted(job=tmp_path / "job.cnc", to="mcuwin", machine=file, machine_to=other, dialect="eding")
    done = translate(dataclasses.replace(wanted))
    assert done.verdict is Verdict.UNKNOWN and not done.files
    assert "a program of this length cannot be translated to McuWIN" in done.findings.kept[0].message


def test_a_tool_that_the_other_machine_does_not_have_is_refused_on_the_same_controller_too(tmp_path: Path) -> None:
    """The machine of the traps has tools 1 to 3; tool 9 is in neither table, and the job says what it means by it."""
    text = f"{MODES.replace('G18', 'G17')}M6 T{{}}\nG0 X1\nM30\n"
    for tool, is_refused in ((3, True), (2, False), (9, False)):
        folder = tmp_path / str(tool)
        folder.mkdir()
        (folder / "job.cnc").write_text(text.format(tool))
        table = machine_files("eding")["machine.toml"].decode()
        (folder / "machine.toml").write_text(table)
        begin, end = table.index("[tools.3]"), table.index("[controller]")
        (folder / "other.toml").write_text(table[:begin] + table[end:])
        wanted = Wanted(
            job=folder / "job.cnc", to="eding", machine=folder / "machine.toml", machine_to=folder / "other.toml",
            dialect="eding",
        )  # fmt: skip
        said = [one.message for one in translate(wanted).findings.kept]
        assert any("has no tool 3" in text for text in said) == is_refused, said
