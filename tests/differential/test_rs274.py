"""Every program means the same to gproof and to LinuxCNC's interpreter, move by move.

The pages `programs.*.md` say what each exercises and where the manual has it. `compare.py` lists the rules by
which the two may differ.
"""

from __future__ import annotations

from pathlib import Path

import pytest
from differential import gproof_side
from differential.compare import first_difference, normal
from differential.rs274_peer import run_peer, situation_of
from differential.traces import EXPECTED, PROGRAMS, cases, gproof_rows, peer_run, report


@pytest.mark.usefixtures("peer", "gproof")
@pytest.mark.parametrize("program", PROGRAMS, ids=lambda path: path.stem)
def test_gproof_agrees_with_peer(program: Path) -> None:
    """The program is in the language the two share, the peer's two halves agree on it, and gproof with them."""
    run = peer_run(program)
    assert run.accepted, f"{program.name}: {run.error}"
    assert run.rows[-1]["op"] == "end"
    difference = first_difference(gproof_rows(program), run.rows)
    assert difference is None, report(program, difference)


@pytest.mark.usefixtures("peer")
@pytest.mark.parametrize(("units", "factor"), [("G20", 25.4), ("G21", 1.0)])
def test_peer_has_full_precision(units: str, factor: float, tmp_path: Path) -> None:
    """`rs274` prints four decimals, a hair of 2.5e-3 mm in inches; the rows come from the module `gcode`."""
    program = tmp_path / "third.ngc"
    program.write_text(f"{units} G17 G40 G49 G54 G80 G90 G94 G98\nG0 X[1/3]\nG2 X[2/3] I[1/6] F10\nM2\n")
    line, arc = (row for row in run_peer(program, situation_of(None)).rows if "to" in row)
    assert line["to"]["x"] == pytest.approx(factor / 3, abs=1e-9)
    assert arc["to"]["x"] == pytest.approx(factor * 2 / 3, abs=1e-9)
    assert arc["center"][0] == pytest.approx(factor / 2, abs=1e-9)


@pytest.mark.usefixtures("gproof")
@pytest.mark.parametrize("name", ["long-program", "block-delete-on"])
def test_command_and_function_say_the_same(name: str) -> None:
    """The other tests call the command's function, which is far faster than to start the command."""
    program = PROGRAMS[0].with_name(f"{name}.ngc")
    assert gproof_rows(program, by_command=True) == gproof_rows(program)


@pytest.mark.usefixtures("gproof")
def test_machine_file_names_the_language(tmp_path: Path) -> None:
    program = tmp_path / "origin.ngc"
    program.write_text("G21 G17 G40 G49 G54 G80 G90 G94 G98\nL2 G10 P1 X5\nG0 X1\nM2\n")
    arguments = [word for word in gproof_side.dump_arguments(program, None) if word not in {"--dialect", "eding"}]
    assert [row["op"] for row in normal(gproof_side.in_process(arguments).rows())] == ["traverse", "end"]


def test_pages_hold_every_program() -> None:
    assert sorted(cases("programs")) == sorted(path.stem for path in PROGRAMS)
    assert len(PROGRAMS) >= 300


def test_every_setup_and_expectation_has_its_program() -> None:
    stems = {path.stem for path in PROGRAMS}
    assert {path.name.removesuffix(".setup.toml") for path in PROGRAMS[0].parent.glob("*.toml")} <= stems
    assert {path.stem for path in EXPECTED} <= stems
