"""Files, functions and the arguments of kernels stay so small that one can be read at a time, and files so few."""

from __future__ import annotations

import ast
import shutil
import subprocess
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest
from support.goldens import ROOT

FOLDERS = sorted(path.name for path in (ROOT / ".typing" / "gproof").iterdir() if path.name != "docs_codes")

MOST_LINES = 600
MOST_LINES_OF_A_FUNCTION = 80
"""Of kernels none is counted: a hot loop in parts is slower."""
MOST_ARGUMENTS = 19
"""Of a kernel. Columns that belong together are one named tuple."""

MOST_FILES = 2250
"""Of the checkout. Cases are sections of pages (support/bundles.py); jobs of the corpus share files."""

LONG_FILES: set[str] = set()
LONG_FUNCTIONS: set[str] = set()
"""What still breaks the rules. These lists only get shorter: what is short by now has to go from them."""

Function = ast.FunctionDef | ast.AsyncFunctionDef


@cache
def files() -> dict[str, str]:
    """Text of the product's files by their path."""
    found = [path for folder in FOLDERS for path in sorted((ROOT / folder).rglob("*.py"))]
    return {path.relative_to(ROOT).as_posix(): path.read_text(encoding="utf-8") for path in found}


def functions(node: ast.AST, within: str = "") -> Iterator[tuple[str, Function]]:
    """All functions of a file with their names, those inside others too."""
    for part in ast.iter_child_nodes(node):
        if isinstance(part, Function):
            yield within + part.name, part
        name = getattr(part, "name", "") if isinstance(part, Function | ast.ClassDef) else ""
        yield from functions(part, f"{within}{name}." if name else within)


@cache
def all_functions() -> list[tuple[str, Function]]:
    return [(f"{path}: {name}", node) for path, text in files().items() for name, node in functions(ast.parse(text))]


def is_kernel(node: Function) -> bool:
    called = (d.func for d in node.decorator_list if isinstance(d, ast.Call))
    return any(isinstance(function, ast.Name) and function.id == "kernel" for function in called)


def test_all_folders_are_read() -> None:
    assert {Path(path).parts[0] for path in files()} == set(FOLDERS) and len(files()) > 400


def test_no_file_is_longer_than_600_lines() -> None:
    long = {path for path, text in files().items() if text.count("\n") > MOST_LINES}
    assert long == LONG_FILES


def test_no_function_outside_kernels_is_longer_than_80_lines() -> None:
    long = {
        name
        for name, node in all_functions()
        if not is_kernel(node) and (node.end_lineno or 0) - node.lineno + 1 > MOST_LINES_OF_A_FUNCTION
    }
    assert long == LONG_FUNCTIONS


def test_no_kernel_takes_20_arguments() -> None:
    counts = {
        name: len(node.args.posonlyargs) + len(node.args.args) + len(node.args.kwonlyargs)
        for name, node in all_functions()
        if is_kernel(node)
    }
    assert len(counts) > 100
    assert {name: count for name, count in counts.items() if count > MOST_ARGUMENTS} == {}


@pytest.mark.skipif(not (ROOT / ".git").exists() or shutil.which("git") is None, reason="no git checkout")
def test_the_checkout_has_few_files() -> None:
    """A small case is a section of a page of its topic (tests/hand/README.md), no file of its own."""
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, check=True).stdout
    count = listed.count(b"\0")
    assert count <= MOST_FILES, f"{count} files; the largest folders: git ls-files | cut -d/ -f1-3 | sort | uniq -c"
