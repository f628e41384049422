"""Only a dialect's own folders, and the registry with one line a dialect, name a controller in code.

Texts for people may: what counts is names of modules, functions and variables, and strings that are the name of a
dialect and nothing else.
"""

from __future__ import annotations

import io
import re
import tokenize
from pathlib import Path

import pytest
from support.goldens import ROOT

from gproof.driver.dialects import DIALECTS

REGISTRIES = {"driver/dialects.py", "driver/targets.py"}
ROOMS = (
    *(f"{room}/{name}/" for room in ("frontend", "passes/interpret", "backend/emit") for name in DIALECTS),
    "ir/dialects/",
)
"""Folders of one dialect, and of the tables of facts: some tables have a row for each."""
FOLDERS = [link.resolve() for link in (ROOT / ".typing" / "gproof").iterdir() if link.name != "docs_codes"]
FILES = sorted(path.relative_to(ROOT).as_posix() for folder in FOLDERS for path in folder.rglob("*.py"))

_NAME = re.compile("|".join(DIALECTS), re.IGNORECASE)


def named_in(text: str) -> set[str]:
    """The words of a module's code that name a controller."""
    found = set()
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        is_word = token.type == tokenize.NAME and _NAME.search(token.string)
        is_name = token.type == tokenize.STRING and token.string.strip("rbfRBF\"'") in DIALECTS
        if is_word or is_name:
            found.add(token.string)
    return found


def outside() -> dict[str, set[str]]:
    found = {
        name: named_in(Path(ROOT / name).read_text(encoding="utf-8"))
        for name in FILES
        if name not in REGISTRIES and not name.startswith(ROOMS)
    }
    return {name: words for name, words in found.items() if words}


def test_no_other_file_names_a_controller() -> None:
    assert outside() == {}


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("from gproof.ir.dialects.eding.rules import EDING\n", {"eding", "EDING"}),
        ('"""Eding CNC manual 4.01."""\nx = 1  # WinCNC\n', set()),
        ('if dialect == "mcuwin":\n    pass\n', {'"mcuwin"'}),
        ('x = "the settings of WinCNC"\n', set()),
    ],
)
def test_what_counts(text: str, found: set[str]) -> None:
    assert named_in(text) == found
