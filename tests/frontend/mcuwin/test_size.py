"""The size of compiled programs: bounds by hand, and what of them is a finding (manual 13.1.1.13)."""

from __future__ import annotations

from pathlib import Path

import pytest
from frontend.mcuwin.mcuwin_programs import load, machine

TEXT = "G0 X1 Y2\nX(CD600 + 1)\nM30\n"
"""Three words in the first line, one of three nodes in the second, one in the third: 5 words, low 20 bytes; nodes with
their words 6 + 4 + 2 = 12, three lines: high 12 * 40 + 3 * 48 = 624 bytes."""


@pytest.mark.parametrize(
    ("allowed", "code", "numbers"),
    [
        (19, "GP147", "at least 20 bytes"),
        (20, "GP146", "20 to 624 bytes"),
        (623, "GP146", "20 to 624 bytes"),
        (624, None, ""),
        (100_000, None, ""),
    ],
)
@pytest.mark.parametrize("tables", [False, True])
def test_bounds(tmp_path: Path, allowed: int, code: str | None, numbers: str, tables: bool) -> None:
    _, findings = load(tmp_path, TEXT, machine(program_size=allowed), tables=tables)
    assert [f.code.label for f in findings.kept] == ([] if code is None else [code])
    assert all(numbers in f.message for f in findings.kept)


def test_a_large_file(tmp_path: Path) -> None:
    text = "G1 F100\n" + "".join(f"X{n}.125 Y{n}\n" for n in range(20_000)) + "M30\n"
    _, findings = load(tmp_path, text)
    assert [f.code.label for f in findings.kept] == ["GP147"]
    _, findings = load(tmp_path, text, machine(program_size=12_000_000))
    assert findings.kept == []
