"""Lines that are no rows of ``Moves`` do not make the rows after them be looked at again and again."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from gproof.driver.session import open_session
from gproof.frontend.common import move_tables
from gproof.frontend.eding import FRONTEND
from gproof.ir.job import DrillHole, Moves

LINES = 3000
MACHINE = Path(__file__).resolve().parents[3] / "corpus" / "eding" / "drilled-plate" / "machine.toml"
TEXTS = {
    "holes": "G81 X0 Y0 Z-1 R2\n" + "".join(f"X{n % 50} Y{n % 40}\n" for n in range(LINES)) + "G80\n",
    "arcs by remembered centres": "".join("G1 X1\nG2 X2 Y2\n" for _ in range(LINES // 2)),
    "moves and others": "".join("G1 X1\nM8\n" for _ in range(LINES // 2)),
}


@pytest.mark.parametrize("about", TEXTS)
def test_each_row_is_looked_at_a_few_times(about: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    looked = 0
    first_words = move_tables.first_words

    def counted(words: Any) -> Any:
        nonlocal looked
        looked += len(words)
        return first_words(words)

    monkeypatch.setattr(move_tables, "first_words", counted)
    job = tmp_path / "job.cnc"
    job.write_text(f"G17 G21 G90 G94 G54\nF300\nG0 X0 Y0 Z9\n{TEXTS[about]}M30\n")
    session = open_session(job, machine=MACHINE, setup=None, dialect="eding")
    assert session.program is not None
    found = FRONTEND.raise_program(session.program, session.machine, session.setup)
    rows = sum(len(node.rows) for node in found.body if isinstance(node, Moves))
    assert rows + len(found.body) >= LINES
    if about == "holes":
        assert sum(isinstance(node, DrillHole) for node in found.body) == LINES + 1
    assert looked < 60 * LINES
