"""The words of findings: each template says a sentence in the words of a shop, each hint says what to do."""

from __future__ import annotations

import ast
import functools
import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from support.each import each
from support.old_words import old_words

from gproof.ir.codes import CODES, SENTENCES
from gproof.ir.finding import Code

ROOT = Path(__file__).resolve().parents[2]
ALL = [*CODES.values(), *SENTENCES]
LONGEST = 115
"""Characters of a template beside its fields."""
FIELD = re.compile(r"\{(\w+)(?:![rs])?(?::[^{}]*)?\}")
NUMBER = re.compile(r"\{(\w+):[^{}]*[fg]\}")
UNIT = re.compile(r" \{unit\}| (?:mm|s|rpm|degrees|steps|times)\b|/min")
NO_UNIT = {
    (263, "value"), (306, "value"), (217, "depth"), (267, "depth"), (217, "r"), (267, "r"), (267, "top"),
    (277, "x"), (277, "y"), (406, "factor"), (282, "factor"), (213, "value"), (207, "value"), (263, "position"),
    (263, "offset"), (606, "allowed"),
}  # fmt: skip
"""Numbers as programs have them, and factors."""
FINER = {401, 403, 407, 408}
"""Arcs: their tolerances are of some micrometres."""
VERBS = frozenset(
    """
add align allow assign calculate change check choose clear compare compile convert correct declare define do draw end
explode export fix free get give home keep leave load make move name open program put raise read remove rename replace
report run save say see select set sign split start state stop switch treat try unlock use wait write zero
""".split()
)
OTHER_HINTS = ("did you mean",)
TABLES = ("ini_keys.py", "keys.py", "words.py", "messages.py")
"""Descriptions of keys and words for the pages; their forms say 'whole'."""
NOT_FOR_PEOPLE = ("[ \\t", "(?", "begin:end")


def plain(code: Code) -> str:
    return FIELD.sub("", code.template)


@each("code", ALL, ids=lambda code: code.label)
def test_templates(code: Code) -> None:
    """Sentences of their own, short, in the words of a shop, with a unit behind each number."""
    assert re.search(r"[a-z]{3}.*[a-z]{2}", plain(code)) or code.number == 603, code.template
    assert not old_words(FIELD.sub("x", code.template), message=True), code.template
    assert len(plain(code)) <= LONGEST, code.template
    assert not code.template.endswith("."), code.template
    for found in NUMBER.finditer(code.template):
        if "." in found[0] and found[0].endswith("f}") and "mm" in code.template:
            assert found[0].endswith((".3f}", ".2f}", ".0f}")) or code.number in FINER, code.template
        before, after = code.template[: found.start()], code.template[found.end() :]
        named = re.search(r"(?:[A-Z#]|\{letter\})$", before) is not None
        assert named or UNIT.match(after) or (code.number, found[1]) in NO_UNIT, f"{found[0]}: {code.template}"


def test_codes_with_more_than_one_sentence() -> None:
    """Each is another one, of a code that there is."""
    for code in SENTENCES:
        first = CODES[code.number]
        assert (first.name, first.severity, first.decides) == (code.name, code.severity, code.decides)
    assert len({(code.number, code.template) for code in ALL}) == len(ALL)


def begins_with_a_verb(hint: str) -> bool:
    return hint.split(" ", 1)[0].strip(":,'").lower() in VERBS or hint.startswith(OTHER_HINTS)


@each("code", [code for code in ALL if code.hint], ids=lambda code: code.label)
def test_hints_of_codes(code: Code) -> None:
    """What to do, first of all."""
    assert begins_with_a_verb(code.hint) and not old_words(code.hint, message=True), code.hint


def texts(node: ast.AST) -> Iterator[str]:
    """The texts that an expression can be; fields are an x."""
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        yield node.value
    elif isinstance(node, ast.JoinedStr):
        yield "".join(str(part.value) if isinstance(part, ast.Constant) else "x" for part in node.values)
    elif isinstance(node, ast.IfExp):
        yield from (*texts(node.body), *texts(node.orelse))


def sources(*folders: str) -> Iterator[tuple[Path, ast.Module]]:
    for folder in folders:
        yield from parsed(folder)


@functools.cache
def parsed(folder: str) -> list[tuple[Path, ast.Module]]:
    return [(path, ast.parse(path.read_text(encoding="utf-8"))) for path in sorted((ROOT / folder).rglob("*.py"))]


def test_hints_where_findings_arise() -> None:
    """Every hint that is written at its finding, or beside it."""
    wrong = []
    for path, tree in sources("frontend", "passes", "ir", "driver"):
        for node in ast.walk(tree):
            stated = [node.value] if isinstance(node, ast.keyword) and node.arg == "hint" else []
            if isinstance(node, ast.Assign) and any(isinstance(t, ast.Name) and t.id == "hint" for t in node.targets):
                stated = [node.value]
            wrong += [
                f"{path.relative_to(ROOT)}:{value.lineno}: {text}"
                for value in stated for text in texts(value)
                if text and not text.startswith("x") and not begins_with_a_verb(text)
            ]  # fmt: skip
    assert not wrong, "\n".join(wrong)


def of_people(tree: ast.Module) -> Iterator[tuple[int, str]]:
    """Every text with a blank that is no docstring: line and text."""
    no_text = {
        id(first.value)
        for node in ast.walk(tree)
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef)
        for first in node.body if isinstance(first, ast.Expr)
    }  # fmt: skip
    no_text |= {id(part) for node in ast.walk(tree) if isinstance(node, ast.JoinedStr) for part in node.values}
    for node in ast.walk(tree):
        if id(node) not in no_text and isinstance(node, ast.Constant | ast.JoinedStr):
            yield from ((node.lineno, text) for text in texts(node) if " " in text.strip())


@pytest.mark.parametrize("folder", ["frontend", "passes", "ir"])
def test_what_fills_the_templates(folder: str) -> None:
    """Reasons, causes and places, and whatever else is said there."""
    wrong = [
        f"{path.relative_to(ROOT)}:{line}: {text}: {old}"
        for path, tree in sources(folder) if path.name not in TABLES
        for line, text in of_people(tree) if not any(sign in text for sign in NOT_FOR_PEOPLE)
        if (old := old_words(text, message=True))
    ]  # fmt: skip
    assert not wrong, "\n".join(wrong)
