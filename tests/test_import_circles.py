"""No file imports itself by way of others, and no folder its neighbour by way of it; types count as imports do."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import cache

import grimp
import pytest
from support.goldens import ROOT

FOLDERS = sorted(path.name for path in (ROOT / ".typing" / "gproof").iterdir() if path.name != "docs_codes")
CORE = "gproof.passes.interpret.core."
"""Files that may be in one circle: control flow, the stack and the writer of the Trace are one machine."""

FILES_IN_CIRCLES = ""
"""Beside those of the core. These lists only get shorter: what is in no circle any more has to go from them."""
FOLDERS_IN_CIRCLES: set[str] = set()


@cache
def imports() -> Mapping[str, frozenset[str]]:
    """By file the files of gproof that it imports."""
    graph = grimp.build_graph(*(f"gproof.{name}" for name in FOLDERS), include_external_packages=False, cache_dir=None)
    return {name: frozenset(graph.find_modules_directly_imported_by(name)) for name in graph.modules}


def circles(edges: Mapping[str, Iterable[str]]) -> list[set[str]]:
    """Whatever reaches itself, by circle (Tarjan, SIAM J. Comput. 1972)."""
    number: dict[str, int] = {}
    low: dict[str, int] = {}
    stack: list[str] = []
    found = []

    def visit(one: str) -> None:
        number[one] = low[one] = len(number)
        stack.append(one)
        for other in sorted(edges[one]):
            if other not in number:
                visit(other)
                low[one] = min(low[one], low[other])
            elif other in stack:
                low[one] = min(low[one], number[other])
        if low[one] == number[one]:
            at = stack.index(one)
            circle = set(stack[at:])
            del stack[at:]
            if len(circle) > 1:
                found.append(circle)

    for one in sorted(edges):
        if one not in number:
            visit(one)
    return found


def listed() -> set[str]:
    folder, names = "", set()
    for word in FILES_IN_CIRCLES.split():
        if word.endswith(":"):
            folder = word.removesuffix(":")
        else:
            names.add(f"{folder}.{word}")
    return names


def test_no_file_is_in_a_circle_of_imports() -> None:
    found = {name for circle in circles(imports()) for name in circle if not name.startswith(CORE)}
    assert sorted(found - listed()) == []
    assert sorted(listed() - found) == [], "in no circle any more: take them from the list"


def test_no_folders_are_in_a_circle_of_imports() -> None:
    folders = {name.rpartition(".")[0] for name in imports()} - {"gproof"}
    edges: dict[str, set[str]] = {folder: set() for folder in folders}
    for one, others in imports().items():
        for other in others:
            for side, neighbour in neighbours(one, other):
                if side in edges and neighbour in edges:
                    edges[side].add(neighbour)
    found = {name for circle in circles(edges) for name in circle}
    assert sorted(found - FOLDERS_IN_CIRCLES) == []
    assert sorted(FOLDERS_IN_CIRCLES - found) == [], "in no circle any more: take them from the list"


def neighbours(one: str, other: str) -> list[tuple[str, str]]:
    """The folders below the last one that both files share; none where one of the files is in that itself."""
    ours, theirs = one.split("."), other.split(".")
    common = next((n for n, (a, b) in enumerate(zip(ours, theirs, strict=False)) if a != b), 0)
    if min(len(ours), len(theirs)) <= common + 1:
        return []
    return [(".".join(ours[: common + 1]), ".".join(theirs[: common + 1]))]


@pytest.mark.parametrize(
    ("edges", "found"),
    [({"a": "b", "b": "a", "c": "a"}, ["ab"]), ({"a": "b", "b": "c", "c": "a", "d": "d"}, ["abc"]), ({"a": ""}, [])],
)
def test_circles_are_found(edges: dict[str, str], found: list[str]) -> None:
    assert circles(edges) == [set(one) for one in found]
