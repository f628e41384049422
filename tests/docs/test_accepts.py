"""The table of what a controller takes beyond its manual is what docs/machine-files.md shows."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from gproof.ir.codes import CODES
from gproof.ir.dialects.accepts import ACCEPTS

PAGE = Path(__file__).parents[2] / "docs" / "machine-files.md"
HEAD = "| entry | controllers | what the controller then does | source |\n|---|---|---|---|\n"
NAMES = {"eding": "Eding CNC", "wincnc": "WinCNC", "mcuwin": "McuWIN"}


def table() -> str:
    """The rows of the table."""
    rows = []
    for row in ACCEPTS.values():
        told = ", ".join(f"GP{number}" for number in row.codes)
        shops = ", ".join(NAMES[dialect] for dialect in row.dialects)
        rows.append(f"| `{row.name}` | {shops} | {row.means} ({told} otherwise) | {row.source} |\n")
    return "".join(rows)


def test_the_page_has_the_table(golden: Callable[[Path, str], None]) -> None:
    before, head, after = PAGE.read_text(encoding="utf-8").partition(HEAD)
    rest = after[after.index("\n## ") :]
    golden(PAGE, before + head + table() + rest)


def test_rows_are_in_order_and_their_codes_exist() -> None:
    for name, row in ACCEPTS.items():
        assert name == row.name == name.lower() and "_" not in name
        assert row.codes and all(number in CODES for number in row.codes)
        assert row.dialects and set(row.dialects) <= set(NAMES)
