"""The tables of the McuWIN page are what the code gives, and the code has everything that the manuals name."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import pytest
from docs.mcuwin_examples import EXAMPLES, OPEN
from docs.mcuwin_tables import PAGE, ROOT, page, run

from gproof.ir.codes import CODES as FINDINGS
from gproof.ir.dialects.mcuwin.rules import MCUWIN
from gproof.ir.dialects.mcuwin.words import G_CODES, M_CODES, TABLES

DIALECT = ROOT / "docs" / "dialects" / "mcuwin.md"


def test_the_page_is_what_the_code_gives(tmp_path: Path, golden: Callable[[Path, str], None]) -> None:
    golden(PAGE, page(tmp_path))


def test_the_rules_have_the_codes_of_the_manual_and_no_others() -> None:
    written = {f"{e.name[0]}{int(e.name[1:])}" for e in (*G_CODES, *M_CODES)}
    assert {rule.text for rule in MCUWIN.codes.values()} == written


def test_everything_has_an_example_that_uses_it() -> None:
    entries = [entry for table in TABLES.values() for entry in table]
    assert list(EXAMPLES) == [entry.name for entry in entries]
    for entry in entries:
        name = re.sub(r"[)}]+$|<n>$", "", entry.name) if entry.name != "{$DINSTART}" else entry.name
        name = "(" if name.startswith("(") else name.split()[0]
        example = EXAMPLES[entry.name]
        assert name.upper() in (example.text + "".join(example.files.values())).upper(), entry.name


@pytest.mark.parametrize("name", OPEN)
def test_what_is_open_of_something_supported_is_never_safe(name: str, tmp_path: Path) -> None:
    for what, example in OPEN[name]:
        assert run(example, tmp_path).verdict != "SAFE", what


def test_the_settings_of_the_page_are_settings_of_machine_files() -> None:
    text = (ROOT / "docs" / "machine-files.md").read_text("utf-8")
    known = set(re.findall(r"^(\w+) = ", text, re.M)) | set(re.findall(r"^\[din\.(\w+)\]", text, re.M))
    header = r"^\| question \| what gproof does \| setting \| section \|\n"
    tables = re.findall(header + r"(?:\|.*\n?)+", DIALECT.read_text("utf-8"), re.M)
    rows = [line.split(" | ") for table in tables for line in table.splitlines()[2:]]
    assert {len(row) for row in rows} == {4}
    cells = [row[2] for row in rows if row[2] != "–"]
    named = {name.split(" of ")[0] for cell in cells for name in cell.split(":")[0].split(", ")}
    assert named
    assert named <= known


def test_the_codes_of_the_page_are_finding_codes() -> None:
    text = DIALECT.read_text("utf-8")
    assert {int(number) for number in re.findall(r"\bGP(\d{3})\b", text)} <= set(FINDINGS)
