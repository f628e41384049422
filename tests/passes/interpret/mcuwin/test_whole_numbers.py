"""Whole numbers of rw_SymPas have 32 bits, within expressions too: what they make is never passed on beyond them."""

from __future__ import annotations

from pathlib import Path

import pytest

from gproof.driver.running import execute
from gproof.frontend.mcuwin.load import load_program
from gproof.ir.finding import Findings
from gproof.ir.setup import ZERO
from passes.interpret.mcuwin import mcuwin_programs as din


def found(tmp_path: Path, lines: str) -> list[str]:
    """Findings of a job."""
    job = tmp_path / "job.din"
    job.write_text(f"%\nG90 F100\n{lines}\nG00 X5\nM30\n%\n")
    findings = Findings()
    program = load_program(job, findings, din.machine())
    trace = execute(program, ZERO, din.machine(), findings)
    trace.verify()
    return din.labels(findings)


@pytest.mark.parametrize(
    "lines",
    [
        "CI600 := 100000\nCD601 := CI600 * CI600",
        "CI600 := 2147483647\nCD601 := CI600 + 1",
        "CI600 := -2147483647\nCD601 := CI600 - 2",
        "CI600 := -2147483647\nCI600 := CI600 - 1\nCD601 := -CI600",
        "CI600 := 50000\nCD601 := sqr(CI600)",
        "CD601 := round(5000000000.0)",
        "CD601 := trunc(-5000000000.0)",
        "CI600 := 100000\n$if (CI600 * CI600 > 5) then begin\nG00 X1\n$end",
        "CI600 := 100000\nG01 X(CI600 * CI600 / 1000000000.0)",
        "CI600 := 1\n$for CI601 := 1 to 40 do begin\nCD601 := CI600 * 2\nCI600 := CI600 + CI600\n$end;",
    ],
)
def test_what_whole_numbers_make_beyond_32_bits_is_refused(tmp_path: Path, lines: str) -> None:
    assert "GP228" in found(tmp_path, lines)


@pytest.mark.parametrize(
    "lines",
    [
        "CI600 := 2147483646\nCD601 := CI600 + 1",
        "CI600 := -2147483647\nCD601 := CI600 - 1",
        "CI600 := 100000\nCD601 := CI600 * 100000.0",
        "CI600 := 46340\nCD601 := sqr(CI600)",
        "CI600 := 1\n$for CI601 := 1 to 30 do begin\nCI600 := CI600 * 2\n$end;",
        "CI600 := 0\n$while (CI600 < 3000) do begin\nCI600 := CI600 + 1\n$end;",
    ],
)
def test_what_they_make_within_them_is_a_value(tmp_path: Path, lines: str) -> None:
    assert found(tmp_path, lines) == []


def test_what_nobody_knows_stays_within_them(tmp_path: Path) -> None:
    # An input is 0 or 1: nothing here is beyond 32 bits, whichever it is.
    lines = "$if (X.digib.1) then begin\nCI600 := 40000\n$end else begin\nCI600 := 2\n$end\nCD601 := CI600 * 2"
    assert "GP228" not in found(tmp_path, lines)


HUGE = "9" * 400
"""Larger than every double."""


@pytest.mark.parametrize(
    ("lines", "codes"),
    [
        (f"CD600 := {HUGE}.0", {"GP107"}),
        (f"CI600 := {HUGE}", {"GP107"}),
        (f"$for CI600 := 1 to {HUGE} do begin\n$end;", {"GP107"}),
        (f"G01 X{HUGE}", {"GP228"}),
        (f"G01 X({HUGE}.5 - 1)", {"GP107"}),
        (f"M98 L5 O{HUGE}\nL5 M30", {"GP229"}),
        (f"G04 {HUGE}", {"GP228"}),
        (f"$wt({HUGE}.0);", {"GP107"}),
        (f"M26 {HUGE}", {"GP228"}),
        (f"S{HUGE}", {"GP228"}),
    ],
)
def test_numbers_that_no_computer_holds(tmp_path: Path, lines: str, codes: set[str]) -> None:
    assert codes & set(found(tmp_path, lines)) == codes


def test_rounding_just_beside_a_half(tmp_path: Path) -> None:
    """0.49999999999999994 + 0.5 is 1 in floating point, and the nearest whole number is 0 all the same."""
    assert "GP228" in found(tmp_path, "CI601 := 1 div round(0.49999999999999994)")
    assert "GP228" not in found(tmp_path, "CI601 := 1 div round(0.50000000000000011)")
