"""No old word is in what the program says: the help of its commands, and the strings of all that prints.

Strings are all those outside docstrings; what a string puts in ({name}) counts as 0. Findings have a test of their own.
"""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import click
import pytest
from support.old_words import old_words

from gproof.cli.main import cli

ROOT = Path(__file__).resolve().parents[2]
FOLDERS = ("cli", "report", "driver", "backend", "verify")
PRINTS = ("cli", "report")
"""Folders whose single words are labels of rows; elsewhere they are names of keys and kinds."""
ALLOWED = {
    "report/picture/sheet.py": {"traverse": "a class of lines, never shown"},
    "report/summary.py": {"begin": "a key of the JSON report"},
    "driver/suppressions.py": {"(?P<whole>-file)": "a group of a regular expression"},
    "verify/explain/earlier_words.py": {"stands at the start as": "certificates of earlier versions have it"},
    "backend/emit/mcuwin/pascal.py": {"begin": "a keyword of the language", "else": "a keyword of the language"},
    "backend/emit/mcuwin/tree.py": {"begin": "a keyword of the language", "else": "a keyword of the language"},
    "backend/emit/mcuwin/from_job.py": {"begin": "a keyword of the language", "else": "a keyword of the language"},
    "backend/emit/linuxcnc/from_job.py": {"else": "a keyword of the language"},
}
"""By file: parts of strings that are no words of ours, with the reason."""


def docstrings(tree: ast.AST) -> set[int]:
    """Strings that stand alone, by identity."""
    bodies = (body for node in ast.walk(tree) if isinstance(body := getattr(node, "body", None), list))
    return {id(one.value) for body in bodies for one in body if isinstance(one, ast.Expr)}


def strings(path: Path) -> Iterator[tuple[int, str]]:
    """Line and text of each string that is no docstring; a string that is put together is one."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    left_out = docstrings(tree)
    for node in ast.walk(tree):
        if isinstance(node, ast.JoinedStr):
            left_out |= {id(part) for part in node.values}
            yield node.lineno, "".join(str(p.value) if isinstance(p, ast.Constant) else "0" for p in node.values)
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in left_out:
            yield node.lineno, node.value


def commands(group: click.Group, path: tuple[str, ...] = ()) -> Iterator[tuple[str, click.Command]]:
    """Every command with its words."""
    yield " ".join(("gproof", *path)), group
    for name, command in group.commands.items():
        if isinstance(command, click.Group):
            yield from commands(command, (*path, name))
        else:
            yield " ".join(("gproof", *path, name)), command


@pytest.mark.parametrize(("words", "command"), list(commands(cli)), ids=lambda one: one if isinstance(one, str) else "")
def test_the_help_has_none(words: str, command: click.Command) -> None:
    context = click.Context(command, info_name=words)
    assert old_words(command.get_help(context), message=True) == []


@pytest.mark.parametrize("folder", FOLDERS)
def test_what_is_printed_has_none(folder: str) -> None:
    found = []
    for path in sorted((ROOT / folder).rglob("*.py")):
        name = path.relative_to(ROOT).as_posix()
        for line, text in strings(path):
            if folder not in PRINTS and re.fullmatch(r"\S*", text):
                continue
            for allowed in ALLOWED.get(name, {}):
                text = re.sub(rf"(?<!\w){re.escape(allowed)}(?!\w)", "", text)
            found += [f"{name}:{line}: {one} in {text!r}" for one in old_words(text, message=True)]
    assert found == []


def test_allowed_words_are_there() -> None:
    for name, allowed in ALLOWED.items():
        for part in allowed:
            assert any(part in text for _, text in strings(ROOT / name)), f"{name}: {part} needs no leave any more"
