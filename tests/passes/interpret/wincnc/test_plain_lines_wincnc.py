"""A plain line of WinCNC means what the same line means with a value in braces, which is no plain one."""

from __future__ import annotations

from pathlib import Path

import pytest

from gproof.driver.dialects import load_machine, load_setup
from gproof.driver.running import execute
from gproof.frontend.wincnc.load import load_program
from gproof.ir.finding import Findings

SHOP = Path(__file__).resolve().parents[4] / "docs" / "codes" / "wincnc"

PLACED = "G90\nG92\nG0 X100 Y60\n"
PAIRS = [
    ("F1200 X Y", "F{1200} X Y"),
    ("F1200 X130", "F{1200} X130"),
    ("G2 X120 R-12 F600", "G2 X{120} R-12 F600"),
    ("G2 X120 R12 F600", "G2 X{120} R12 F600"),
    ("G2 X120 I10 J0 F600\nX140", "G2 X{120} I10 J0 F600\nX{140}"),
    ("G2 X120 I10 J0 F600\nG2 X140 I10", "G2 X{120} I10 J0 F600\nG2 X{140} I10"),
    ("L11 Y X\nG1 X120 F600", "L11 Y X\nG1 X{120} F600"),
    ("L11 Y X\nG2 X120 I10 J0 F600", "L11 Y X\nG2 X{120} I10 J0 F600"),
    ("L13 X Y\nG1 X120 F600", "L13 X Y\nG1 X{120} F600"),
    ("L300 Y\nG1 X120 Y90 F600", "L300 Y\nG1 X{120} Y90 F600"),
    ("G51 X2 Y2 I100 J60\nG2 X110 I5 J0 F600", "G51 X2 Y2 I100 J60\nG2 X{110} I5 J0 F600"),
    ("G1 Z-5 F300\nG1 X120", "G1 Z{0-5} F300\nG1 X{120}"),
    ("G1 X", "G1 X{0}"),
]


def trace(text: str, folder: Path) -> tuple[list[tuple[str, int]], list[list[float]]]:
    """Codes and lines of the findings, and of each row what it does, where it goes and how fast."""
    path = folder / "job.tap"
    path.write_text(PLACED + text + "\n", "utf-8")
    findings = Findings()
    machine, _ = load_machine(SHOP / "WINCNC.INI", findings)
    assert machine is not None
    setup, _ = load_setup(SHOP / "setup.toml", findings, machine)
    program = load_program(path, findings, machine, SHOP / "WINCNC.INI")
    assert setup is not None and program is not None
    done = execute(program, setup, machine, findings)
    made = []
    for section in done.sections:
        rows = section.rows
        columns = [rows["op"], *rows["to"].T, rows["feed"], rows["turns"], rows["line"]]
        made += [[round(float(column[n]), 9) for column in columns] for n in range(len(rows))]
    return [(f.code.label, f.span.line) for f in findings.kept], made


@pytest.mark.parametrize(("plain", "braced"), PAIRS)
def test_a_plain_line_means_what_it_means_with_braces(plain: str, braced: str, tmp_path: Path) -> None:
    assert repr(trace(plain, tmp_path)) == repr(trace(braced, tmp_path))
