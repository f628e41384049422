"""A finding stands at the line that a person would look at: of what is said of a whole job, the move that makes it so.

Lines are worked out by hand: of two moves that exclude each other the later one, with the other one beside it.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from gproof.cli.main import main

MACHINE = 'schema = "gproof-machine/1"\nunits = "mm"\n[axes.x]\nmin = 0\nmax = 300\n[axes.y]\nmin = 0\nmax = 300\n' + (
    "[axes.z]\nmin = -100\nmax = 0\n"
)
EDING = "(a plate)\nG21 G90 G94 G17 G40 G49 G54\n"


def found(
    folder: Path, program: str, capsys: pytest.CaptureFixture[str], setup: str = "", machine: str = MACHINE
) -> list[dict[str, Any]]:
    (folder / "machine.toml").write_text(machine)
    (folder / "job.cnc").write_text(program)
    words = ["check", str(folder / "job.cnc"), "--machine", str(folder / "machine.toml"), "--format", "json"]
    if setup:
        (folder / "setup.toml").write_text('schema = "gproof-setup/1"\n' + setup)
        words += ["--setup", str(folder / "setup.toml")]
    main(words)
    told = json.loads(capsys.readouterr().out)["findings"]
    return [f for f in told if f["severity"] in ("error", "unknown")]


def lines(finding: dict[str, Any]) -> tuple[str, int, list[int]]:
    return finding["code"], finding["line"], [other["line"] for other in finding.get("related", [])]


@pytest.mark.parametrize(
    ("moves", "at", "beside"),
    [
        ("G0 X0\nG0 Y1\nG0 X400\nG0 Y0\nM30\n", 5, 3),
        ("G0 X400\nG0 Y1\nG0 X0\nG0 Y0\nM30\n", 5, 3),
        ("G0 X100\nG0 X50\nG0 X400\nG0 X0\nG0 X60\nM30\n", 6, 5),
    ],
)
def test_a_job_longer_than_its_axis_stands_at_the_later_of_two_moves(
    moves: str, at: int, beside: int, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (one,) = found(tmp_path, EDING + moves, capsys)
    assert lines(one) == ("GP303", at, [beside])
    low, high = ("this line needs G54 X offset + G92 X offset of at " + end for end in ("least 0.", "most -100."))
    said = [one["hint"], one["related"][0]["message"]]
    assert any(low in text for text in said), said
    assert any(high in text for text in said), said


def test_both_settings_of_block_delete(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Executed, X250 leaves 0 to 50 of the offset; left out, X-200 asks for 200 at the least."""
    program = EDING + "G0 X0\n/G91\n/G0 X250\nG0 Y1\nG0 X-200\nG0 Y2\nM30\n"
    (one,) = [f for f in found(tmp_path, program, capsys) if "block delete" in f["message"]]
    assert lines(one) == ("GP304", 7, [5])


def test_no_value_for_the_whole_job(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Z0 asks for an offset of 0 at most; 90 below a contact that may be at Z-20, for 10 at the least."""
    program = EDING + "F100\nG0 Z0\nG38.2 Z-20\nG91\nG0 Z-90\nG0 Z1\nG90\nG0 Z0\nM30\n"
    assert [lines(one) for one in found(tmp_path, program, capsys)] == [("GP304", 7, [4])]


MCUWIN = (Path(__file__).parents[2] / "docs" / "codes" / "mcuwin" / "machine.toml").read_text()
HOMED = 'homed = ["x", "y", "z"]\n'


@pytest.mark.parametrize(
    ("stated", "line"),
    [
        ("\n[transform]\nangle = 30.0\nfactor = 1.0\nx = 0.0\ny = 0.0\n", 4),
        ("active_work = 6\n", 3),
        ("[work.1]\nx = 0.0\n\n[work.7]\nx = 5.0\n", 6),
        ("[tools.3]\nlength = 30.0\n", 3),
        ("tool-length = 30.0\n", 3),
        ("[measures]\nz = -5.0\n", 3),
        ('[inputs]\n"X.digib.1" = 1\n5 = 1\n', 5),
        ("[parameters]\n601 = 1.0\n2000 = 5.0\n", 5),
        ("active_work = 1\n[g92]\nx = 77.0\n", 5),
    ],
)
def test_what_a_setup_states_of_another_controller_stands_there(
    stated: str, line: int, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """GP630; the schema is line 1 of the file, ``homed`` line 2."""
    (tmp_path / "setup.toml").write_text(f'schema = "gproof-setup/1"\n{HOMED}{stated}')
    (tmp_path / "machine.toml").write_text(MCUWIN)
    (tmp_path / "job.src").write_text("%A\nG90 G53\nG00 X1\nM30\n")
    words = [str(tmp_path / name) for name in ("job.src", "machine.toml", "setup.toml")]
    main(["check", words[0], "--machine", words[1], "--setup", words[2], "--format", "json"])
    told = [f for f in json.loads(capsys.readouterr().out)["findings"] if f["code"] == "GP630"]
    assert [(f["file"], f["line"]) for f in told] == [(words[2], line)]


@pytest.mark.parametrize("refined", [False, True])
def test_what_a_machine_file_states_of_another_controller_stands_there(
    refined: bool, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    stated = MCUWIN.replace('dialect = "mcuwin"\n', 'dialect = "mcuwin"\nturning = true\n')
    line = stated.splitlines().index("turning = true") + 1
    (tmp_path / "machine.toml").write_text(stated)
    (tmp_path / "refined.toml").write_text('schema = "gproof-machine/1"\nunits = "mm"\nbase = "machine.toml"\n')
    (tmp_path / "job.src").write_text("%A\nG90 G53\nG00 X1\nM30\n")
    job, machine = (str(tmp_path / n) for n in ("job.src", "refined.toml" if refined else "machine.toml"))
    main(["check", job, "--machine", machine, "--setup", "zero", "--format", "json"])
    told = [f for f in json.loads(capsys.readouterr().out)["findings"] if f["code"] == "GP630"]
    assert [(Path(f["file"]).name, f["line"]) for f in told] == [("machine.toml", line)]


@pytest.mark.parametrize(
    ("setup", "code", "line"),
    [
        ("active_work = 1\n[start]\ny = 5.0\nx = -20.0\n", "GP306", 5),
        ("start = {x = -20.0}\n", "GP306", 2),
        ("\n[parameters]\n5220 = 12\n", "GP235", 4),
        ("\n[cylinder]\nz = 0.0\ny = 5.0\n", "GP321", 3),
        ("\n[cylinder]\nradius = 5.0\ny = 500.0\n", "GP306", 5),
    ],
)
def test_what_a_setup_states_wrongly_stands_there(
    setup: str, code: str, line: int, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    told = found(tmp_path, EDING + "G0 X10\nG0 Y1\nM30\n", capsys, setup)
    assert {(Path(f["file"]).name, f["line"]) for f in told if f["code"] == code} == {("setup.toml", line)}


ZONE = '[[keep_out]]\nname = "clamp"\nx = [100, 120]\ny = [100, 120]\nz = [-100, -20]\n'
CHANGE = "[areas.tool_change]\nx = [100, 120]\ny = [100, 120]\nz = [-100, -20]\n"
LONG = "".join(f"G1 X{n % 7} F900\n" for n in range(300))


@pytest.mark.parametrize(("area", "code"), [(ZONE, "GP337"), (CHANGE, "GP311")])
@pytest.mark.parametrize(
    ("moves", "line"),
    [
        # From Z0 down to Z-90 on an axis of 100 no offset keeps Z above -20, and X and Y are on both sides.
        ("G0 Z0\nG0 X0 Y0\nG0 X10 Y10\nG0 X250 Y250\nG0 Z-90\nG0 X10\nG0 Z-1\n", 7),
        ("G0 Z0\nG0 X0 Y0\nG0 Z-90\nG0 X10\nG0 X250 Y250\nG0 Z-1\nG0 X10\n", 7),
        (f"G0 Z0\nG0 X0 Y0\n{LONG}G0 Z-90\nG0 X250 Y250\nG0 Z-1\n{LONG}", 306),
    ],
)
def test_a_zone_that_no_offset_keeps_clear_stands_at_the_move_that_leaves_none(
    moves: str, line: int, area: str, code: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Every move is beside some face of the zone until this one; the tool is a point, its length 0."""
    setup = 'homed = ["x", "y", "z"]\ntool = 1\ntool_length = 0.0\nstart = {x = 0.0, y = 0.0, z = 0.0}\n'
    whole = MACHINE + "[tools.1]\nlength = 0.0\ndiameter = 0.001\n" + area
    told = found(tmp_path, EDING + moves + "M30\n", capsys, setup, whole)
    assert [(f["code"], f["line"]) for f in told] == [(code, line)]
