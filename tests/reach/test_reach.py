"""docs/reach.md against the code: each field has a row, and what the row says can be seen."""

from __future__ import annotations

import ast
import functools
import re
from pathlib import Path

import pytest
from corpus.expectations import ROOT
from reach.answers import TARGETS
from reach.page import rows, run_fields, stated_fields, words_of_readers
from reach.witness import Witness
from reach.witnesses import WITNESSES
from reach.worlds import STATE, answered, moved
from support.campaigns import share
from support.each import each

ROWS = rows()
THROUGH = {"trace": set(TARGETS), "language": set(TARGETS)}
"""What rests on what: everything is made from the trace, and nothing is judged of what is not understood."""
SHOWN = sorted({witness.row for witness in WITNESSES})


def test_each_field_has_a_row() -> None:
    """A new field needs one: docs/reach.md says what it reaches."""
    fields = stated_fields() | run_fields()
    assert fields - ROWS.keys() == set()
    assert ROWS.keys() - fields == set()


UNSAID = {
    # The setup zero says them of any machine.
    "Setup.default_start", "Setup.default_offset", "Setup.default_parameter",
    # Made with the finding that it goes with.
    "Unmodelled.stated_by",
}  # fmt: skip


def test_files_can_state_each_field() -> None:
    """A field that no reader fills is a promise that nobody keeps."""
    words = words_of_readers()
    fields = {name for name in stated_fields() if not name.startswith("State.")}
    assert {name for name in fields if name.partition(".")[2] not in words} == UNSAID


@each("field", sorted(name for name in run_fields() if name in ROWS and ROWS[name].reaches))
def test_functions_read_what_a_run_carries(field: str) -> None:
    """What a program sets is read again by a function that its row names."""
    name = field.partition(".")[2]
    assert any(_reads(_part(file, part) or "", name) for file, part in ROWS[field].places), field


def _reads(source: str, name: str) -> bool:
    """Whether an attribute is read, other than to make a changed record of it."""
    lines = (line for line in source.splitlines() if not re.search(rf"but\(\s*{name}=with_pair\(", line))
    return any(re.search(rf"\.{name}\b(?!\s*=[^=])", line) for line in lines)


@functools.cache
def _source(file: str) -> str:
    return (ROOT / file).read_text(encoding="utf-8")


@functools.cache
def _tree(file: str) -> ast.Module:
    return ast.parse(_source(file))


@functools.cache
def _part(file: str, name: str) -> str | None:
    """The source of a function or class, ``Limits._beyond``; None: there is none of that name."""
    node: ast.AST = _tree(file)
    for step in filter(None, name.split(".")):
        inside = (n for n in ast.walk(node) if isinstance(n, (ast.FunctionDef, ast.ClassDef)) and n.name == step)
        found = next(inside, None)
        if found is None:
            return None
        node = found
    if not name:
        return _source(file)
    assert isinstance(node, ast.FunctionDef | ast.ClassDef)
    return "\n".join(_source(file).split("\n")[node.lineno - 1 : node.end_lineno])


@each("field", sorted(ROWS))
def test_rows_name_what_is_there(field: str) -> None:
    """Functions that a row names exist; a fact that reaches nothing has a reason."""
    row = ROWS[field]
    for file, name in row.places:
        assert (ROOT / file).is_file(), f"{field}: no file {file}"
        assert _part(file, name) is not None, f"{field}: no {name} in {file}"
    if not row.reaches:
        assert len(row.text) > 12, f"{field}: why?"


@functools.cache
def _base(number: int, folder: Path) -> dict[str, str]:
    return answered(WITNESSES[number].world, WITNESSES[number].program, folder, ())


def _moves(witness: Witness, folder: Path) -> tuple[set[str], set[str]]:
    """Targets whose answer the change of a fact moves, and those that it leaves UNKNOWN."""
    first = next(n for n, w in enumerate(WITNESSES) if w.world is witness.world and w.program == witness.program)
    base = _base(first, folder)
    other = answered(witness.world, witness.program, folder, ((witness.path, witness.value),))
    there = {name for name, text in other.items() if text.startswith("UNKNOWN")}
    # What a trace carries is another trace; whether anything reads it is seen in what is made from it.
    own = {"trace"} if witness.path[0] == STATE else set()
    return moved(base, other) - own, there


@pytest.fixture(scope="session")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """One folder for all programs."""
    return tmp_path_factory.mktemp("reach")


@pytest.mark.parametrize("field", share(SHOWN, 5))
def test_what_a_row_says_can_be_seen(field: str, folder: Path) -> None:
    """Each target of a row moves with one of the field's witnesses, and no other target does."""
    row = ROWS[field]
    seen: set[str] = set()
    unknown: set[str] = set()
    for witness in WITNESSES:
        if witness.row == field:
            changed, left = _moves(witness, folder)
            seen |= changed
            unknown |= changed & left
    allowed = set(row.reaches).union(*(THROUGH[name] for name in row.reaches & THROUGH.keys()))
    if row.unknown:
        allowed |= unknown
    assert seen - allowed == set(), f"{field} reaches more than its row says"
    assert row.reaches - seen == set(), f"{field}: nothing shows this"
    assert row.unknown - unknown == set(), f"{field}: this is not UNKNOWN"


def test_each_row_is_shown() -> None:
    """Facts that reach something have a witness, or the row names the test that shows them."""
    bare = [name for name, row in ROWS.items() if row.reaches and name not in SHOWN]
    assert not [name for name in bare if name.partition(".")[0] not in ("Modal", "WinCncState", "McuWinState")]


def test_the_page_is_listed() -> None:
    """The pages' list names it."""
    assert re.search(r"\(reach\.md\)", _source("docs/README.md"))
