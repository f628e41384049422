"""docs/translation-traps.md: its tables have lines of the worked cases, in their order, and no others."""

from __future__ import annotations

import re
from collections.abc import Iterator

import pytest
from support.bundles import ROOT
from support.traps import Case, cases

PAGE = (ROOT / "docs" / "translation-traps.md").read_text("utf-8")
NAMES = {"WinCNC": "wincnc", "Eding CNC": "eding", "McuWIN": "mcuwin", "LinuxCNC": "linuxcnc", "grbl": "grbl"}
_TABLE = re.compile(
    r"^\| (?P<head>.+) \|\n\|(?:---\|)+\n(?P<rows>(?:\|.*\|\n)+)\n"
    r"\[Worked case\]\(\S+/(?P<page>\w+)\.md#(?P<case>\S+)\)",
    re.MULTILINE,
)


def tables() -> Iterator[tuple[str, list[str], list[list[str]]]]:
    """Each table: its case as page/heading, the names of its columns, and the lines of each column."""
    for found in _TABLE.finditer(PAGE):
        columns = found["head"].split(" | ")
        rows = [[cell.strip() for cell in row[1:-1].split("|")] for row in found["rows"].splitlines()]
        yield (
            f"{found['page']}/{found['case']}",
            columns,
            [[line for row in rows for line in re.findall(r"`([^`]+)`", row[n])] for n in range(len(columns))],
        )


TABLES = list(tables())


def test_every_table_has_a_case() -> None:
    assert len(re.findall(r"^\|---", PAGE, re.MULTILINE)) == len(TABLES) > 40


@pytest.mark.parametrize("name, columns, lines", TABLES, ids=[name for name, _, _ in TABLES])
def test_lines_are_of_the_case(name: str, columns: list[str], lines: list[list[str]]) -> None:
    case = {case.name.replace(".", ""): case for case in cases()}[name]  # as headings become anchors
    for column, shown in zip(columns, lines, strict=True):
        assert shown, column
        written = iter(_lines(case, NAMES[column]))
        for line in shown:
            assert line in written, (column, line)


def _lines(case: Case, dialect: str) -> list[str]:
    programs = [name for role in ("source", "target") for name in case.programs(role) if case.dialect(name) == dialect]
    called = f"{case.side(programs[0])}/"
    files = [programs[0], *(name for name in case.section.files if name.startswith(called))]
    return [line for name in files for line in case.section.files[name].decode().splitlines()]
