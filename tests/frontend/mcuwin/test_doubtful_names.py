"""McuWIN: a declared name that is the letter of a word is in doubt where a DIN line has that word, and only there."""

from __future__ import annotations

from pathlib import Path

import pytest

from gproof.frontend.mcuwin.load import load_program
from gproof.ir.finding import Findings


def labels(tmp_path: Path, text: str) -> list[tuple[str, int]]:
    job = tmp_path / "job.din"
    job.write_text(text)
    findings = Findings()
    load_program(job, findings)
    return [(f.code.label, f.span.line) for f in findings.kept]


@pytest.mark.parametrize("letter", "ijkfstdn")
def test_a_counter_with_the_letter_of_a_word(tmp_path: Path, letter: str) -> None:
    head = f"$DINEND\nvar {letter} : integer;\n{{$DINSTART}}\n%\nG90\n"
    text = f"{head}$for {letter} := 1 to 2 do begin\nG00 X({letter})\n$end\n"
    assert labels(tmp_path, f"{text}M30\n%\n") == []
    word = letter.upper()
    line = f"G02 X1 Y0 {word}1" if letter in "ijk" else f"{word}1 G90" if letter == "n" else f"{word}1"
    assert ("GP139", 9) in labels(tmp_path, f"{text}{line}\nM30\n%\n")


@pytest.mark.parametrize("letter", "xyzgmlo")
def test_letters_that_are_everywhere(tmp_path: Path, letter: str) -> None:
    text = f"$DINEND\nvar {letter} : integer;\n{{$DINSTART}}\n%\nG90\nM30\n%\n"
    assert labels(tmp_path, text) == [("GP139", 2)]
