"""Functions, files and pages that the pages name exist: `file.py: name`, relative links, images, finding codes."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

from support.each import each
from support.goldens import ROOT

from gproof.ir.codes import CODES

PAGES = [
    *(ROOT / name for name in ("README.md", "CONTRIBUTING.md", "CHANGELOG.md", "SECURITY.md", "corpus/README.md")),
    *sorted(path for path in (ROOT / "docs").glob("**/*.md") if "codes" not in path.parts),
]
_NAMED = re.compile(r"`([a-z_/0-9]+\.py): ([A-Za-z_0-9.]+)`")
_LINK = re.compile(r"\]\(([^)#\s]+)(?:#[^)]*)?\)")
_PATH = re.compile(r"`((?:ir|frontend|passes|verify|backend|cli|tests|scripts|bench)/[a-z_/0-9]+\.(?:py|sh|lark))")


def name_of(page: Path) -> str:
    return page.relative_to(ROOT).as_posix()


@cache
def defined(file: str) -> frozenset[str]:
    """Functions, classes and their methods in a file."""

    def names(body: list[ast.stmt], outer: str) -> Iterator[str]:
        for node in body:
            if isinstance(node, ast.FunctionDef | ast.ClassDef):
                yield outer + node.name
                yield from names(node.body, f"{outer}{node.name}.")

    return frozenset(names(ast.parse((ROOT / file).read_text(encoding="utf-8")).body, ""))


@each("page", PAGES, ids=name_of)
def test_named_functions_exist(page: Path) -> None:
    missing = [
        f"{file}: {name}"
        for file, name in _NAMED.findall(page.read_text(encoding="utf-8"))
        if not (ROOT / file).is_file() or name not in defined(file)
    ]
    assert missing == []


@each("page", PAGES, ids=name_of)
def test_links_and_paths_lead_somewhere(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    links = [link for link in _LINK.findall(text) if "://" not in link]
    assert [link for link in links if not (page.parent / link).exists()] == []
    assert [path for path in _PATH.findall(text) if not (ROOT / path).exists()] == []


@each("page", PAGES, ids=name_of)
def test_codes_exist(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    assert {code for code in re.findall(r"\bGP(\d{3})\b", text) if int(code) not in CODES} == set()


def test_the_walk_names_every_stage() -> None:
    named = _NAMED.findall((ROOT / "docs" / "walk-of-a-line.md").read_text(encoding="utf-8"))
    assert len(named) > 30
    assert {file.split("/")[0] for file, _ in named} == {
        "ir",
        "frontend",
        "passes",
        "verify",
        "backend",
        "driver",
        "report",
        "cli",
    }


def test_index_lists_every_page() -> None:
    index = ROOT / "docs" / "README.md"
    linked = {(index.parent / link).resolve() for link in _LINK.findall(index.read_text(encoding="utf-8"))}
    pages = {path.resolve() for path in (ROOT / "docs").glob("**/*.md") if "codes" not in path.parts}
    assert pages - {index.resolve()} <= linked
