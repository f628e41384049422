"""Pages for people use the words of a machine shop: none has an old word of ``support/old_words.py``."""

from __future__ import annotations

import re
from pathlib import Path

from support.each import each
from support.goldens import ROOT
from support.old_words import old_words, prose

PAGES = [
    *(ROOT / name for name in ("README.md", "CHANGELOG.md", "CONTRIBUTING.md", "SECURITY.md")),
    *(ROOT / name for name in ("corpus/README.md", "bench/README.md")),
    *sorted((ROOT / "docs").rglob("*.md")),
]
GLOSSARY = re.compile(r"^## Glossary$.*?(?=^## )", re.MULTILINE | re.DOTALL)
"""Of CONTRIBUTING.md, which names the old words."""


def faults(page: str) -> list[str]:
    """The old words of a page, each with its line."""
    text = prose(GLOSSARY.sub(lambda found: "\n" * found[0].count("\n"), page))
    return [f"line {at}: {word}" for at, line in enumerate(text.splitlines(), 1) for word in old_words(line)]


@each("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_a_page_has_no_old_word(page: Path) -> None:
    found = faults(page.read_text(encoding="utf-8"))
    assert found == [], "write it in plain English, see the glossary of CONTRIBUTING.md"


def test_faults_have_their_lines_and_code_has_none() -> None:
    page = "# A\n\n```\nbehind\n```\nwhat `stands` [there](behind.md)\nis told\n"
    page += "## Glossary\n\n| told |\n\n## B\n\nbegins\n"
    assert faults(page) == ["line 7: told: reported, said", "line 14: begins: start"]


def test_the_glossary_has_forty_words() -> None:
    text = GLOSSARY.search((ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8"))
    assert text is not None
    rows = [line for line in text[0].splitlines() if line.startswith("| ")][1:]
    assert len(rows) == 40
    assert [row.lower() for row in rows] == sorted(row.lower() for row in rows)
