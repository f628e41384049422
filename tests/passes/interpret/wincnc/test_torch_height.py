"""Torch height control of WinCNC: Z is its own while the torch burns, by L38 or by its output, unless L37 said so.

WinCNC Users Guide, L Codes: L36 to L39; WINCNC.INI Settings: thc=.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from gproof.driver.dialects import load_machine, load_setup
from gproof.driver.running import execute
from gproof.frontend.wincnc.load import load_program
from gproof.ir.finding import Findings
from gproof.ir.setup import ZERO

SHOP = Path(__file__).resolve().parents[4] / "corpus" / "wincnc" / "plasma"
CUT = "G1 X100 F3000"


def lines_with_height(folder: Path, lines: list[str], *, zero: bool = False) -> list[int]:
    """The lines of a program at which GP280 says that Z is not known from there."""
    job = folder / "job.tap"
    job.write_text("\n".join(["G90", "G53 Z-40", *lines, ""]), encoding="ascii")
    findings = Findings()
    machine, _ = load_machine(SHOP / "WINCNC.INI", findings)
    assert machine is not None
    setup, _ = load_setup(SHOP / "setup.toml", findings, machine)
    program = load_program(job, findings, machine, SHOP / "WINCNC.INI")
    assert program is not None
    assert setup is not None
    execute(program, ZERO if zero else setup, machine, findings)
    return [f.span.line for f in findings.kept if f.code.label == "GP280"]


@pytest.mark.parametrize(
    ("lines", "where"),
    [
        (["L36", "L38", CUT, "L39"], [4]),
        (["L36", "M11C1", CUT, "M12C1"], [4]),
        (["L36", "M13C1", CUT, "M14C1"], [4]),
        (["L38", CUT, "L39"], [3]),
        (["M11C1", CUT, "M12C1"], [3]),
        (["L37", "L38", "L36", CUT], [5]),
        (["L37", "L38", CUT, "L39"], []),
        (["L37", "M11C1", CUT, "M12C1"], []),
        (["L36", "L37", "L38", CUT], []),
        (["L36", "M11C2", CUT, "L37"], []),
        (["L37", "L38", CUT, "L39", "L36", "L37"], []),
    ],
)
def test_z_is_not_known_while_the_torch_may_be_guided(tmp_path: Path, lines: list[str], where: list[int]) -> None:
    assert lines_with_height(tmp_path, lines) == where


def test_setup_zero_begins_without_height_control(tmp_path: Path) -> None:
    assert lines_with_height(tmp_path, ["L38", CUT], zero=True) == []
    assert lines_with_height(tmp_path, ["L36", "L38", CUT], zero=True) == [4]
