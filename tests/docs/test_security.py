"""docs/security.md: every attack of its table has a test that shows what stops it."""

from __future__ import annotations

import ast
import re

from corpus.expectations import ROOT
from support.each import each

PAGE = ROOT / "docs" / "security.md"
ROWS = [line for line in PAGE.read_text("utf-8").splitlines() if line.startswith("|") and "::" in line]
HELD = re.compile(r"`(tests/[\w/]+\.py)::(test_\w+)`")


def test_there_are_rows() -> None:
    """As many as the table under "Attacks" has."""
    table = PAGE.read_text("utf-8").split("## Attacks", 1)[1].split("## Not stopped", 1)[0]
    rows = [line for line in table.splitlines() if line.startswith("|")][2:]
    assert rows == ROWS
    assert len(ROWS) > 25


@each("row", ROWS, ids=lambda row: row.split("|")[1].strip()[:60])
def test_the_test_that_a_row_names_exists(row: str) -> None:
    named = HELD.findall(row)
    assert named
    for file, name in named:
        tree = ast.parse((ROOT / file).read_text("utf-8"))
        assert name in {node.name for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)}, f"{file}::{name}"


def test_codes_of_the_page_are_documented() -> None:
    for code in set(re.findall(r"GP\d{3}", PAGE.read_text("utf-8"))):
        assert (ROOT / "docs" / "codes" / f"{code}.md").is_file(), code
