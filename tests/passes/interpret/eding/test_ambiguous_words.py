"""A word that two codes of a line take is nobody's: the manual has no rule for it."""

from __future__ import annotations

from pathlib import Path

import pytest
from passes.interpret.core.programs import HEAD, LATHE, OFFSET, codes_of, run_whole, shown


@pytest.mark.parametrize(
    "line",
    [
        "M50 G4 P-1",
        "M52 G4 P1",
        "M53 M54 P1",
        "M91 G4 P1",
        "G64 G82 X1 Y1 Z-2 R2 P1",
        "G64 G83 X1 Y1 Z-2 R2 Q1",
        "G64 R2 G81 X1 Y1 Z-2",
        "G43.1 K2 G33 Z-5",
        "G43.1 I1 K-1 J1 G87 X1 Y1 Z-2 R2",
        "M26 G82 X1 Y1 Z-2 R2 P1",
    ],
)
def test_shared_words_are_unknown(tmp_path: Path, line: str) -> None:
    trace, findings = run_whole(tmp_path, f"{HEAD}S500 M3 F100\nG0 Z5\n{line}\nM5\n")
    assert codes_of(findings) == ["GP113"]
    assert not any(row[0] in ("feed", "sync") for row in shown(trace))


@pytest.mark.parametrize("before", ["G64 G76 P1 Q1", "G54 G43 H1 G76 P1", "G64 R2 G76 P1"])
def test_words_of_a_thread(tmp_path: Path, before: str) -> None:
    text = f"{LATHE}S500 M3\nG0 X20 Z20\n{before} Z10 I-5 J1 K1\nM5\n"
    _, findings = run_whole(tmp_path, text, machine=OFFSET)
    assert "GP113" in codes_of(findings)


@pytest.mark.parametrize("line", ["M48 G82 X1 Y1 Z-2 R2 P1", "G43 H1 G33 Z-5 K1", "M90 G4 P1"])
def test_words_that_one_code_takes(tmp_path: Path, line: str) -> None:
    _, findings = run_whole(tmp_path, f"{HEAD}S500 M3 F100\nG0 Z5\n{line}\nM5\n")
    assert codes_of(findings) == (["GP113"] if line.startswith("M90") else [])
