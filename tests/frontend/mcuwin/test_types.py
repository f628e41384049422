"""Static types of rw_SymPas: random expressions of any types, against a checker of a few lines written from the manual.

7: a condition is boolean; 8.3: a loop counts in whole numbers; 11: CD is floating point and CI whole. Between types as
Pascal has it: whole numbers become floating point by themselves, nothing else becomes anything.
"""

from __future__ import annotations

import random
from typing import Any

import pytest

from gproof.frontend.mcuwin.pascal import (
    PascalError,
    Place,
    Symbols,
    Type,
    parse_dollar,
    parse_expression,
    parse_section,
)
from gproof.ir.finding import Findings

Tree = tuple[Any, ...]
LEAVES = {"i": ["n", "3", "CI600", "K"], "d": ["x", "2.5", "CD600", "pi", "X.tp"], "b": ["q", "true", "X.digib.5"]}
NAMES = {Type.INTEGER: "i", Type.DOUBLE: "d", Type.BOOLEAN: "b"}


class Wrong(Exception):
    """Types that do not go together."""


def tree(random_: random.Random, depth: int) -> Tree:
    """Any tree, its leaves with their type."""
    if depth == 0 or random_.random() < 0.1:
        kind = random_.choice("iiddb")
        return ("leaf", kind, random_.choice(LEAVES[kind]))
    way = random_.random()
    if way < 0.15:
        return ("unary", random_.choice(("-", "not ")), tree(random_, depth - 1))
    if way < 0.3:
        name = random_.choice(
            ("abs", "sqr", "sqrt", "sin", "round", "trunc", "int", "frac", "odd", "BOOLEAN", "ln", "exp")
        )
        return ("call", name, tree(random_, depth - 1))
    words = "+ - * / div mod and or xor shl shr = <> < <= > >=".split()
    return ("binary", random_.choice(words), tree(random_, depth - 1), tree(random_, depth - 1))


def written(node: Tree) -> str:
    match node:
        case ("leaf", _, text):
            return str(text)
        case ("unary", word, operand):
            return f"({word}{written(operand)})"
        case ("call", name, operand):
            return f"{name}({written(operand)})"
    return f"({written(node[2])} {node[1]} {written(node[3])})"


def type_of(node: Tree) -> str:
    """Its type; Wrong where its parts do not go together."""
    match node:
        case ("leaf", kind, _):
            return str(kind)
        case ("unary", word, operand):
            kind = type_of(operand)
            if kind == ("b" if word == "-" else "d"):
                raise Wrong
            return kind
        case ("call", name, operand):
            kind = type_of(operand)
            if name == "BOOLEAN":
                return "b"
            if kind == "b" or (name == "odd" and kind == "d"):
                raise Wrong
            return {"abs": kind, "sqr": kind, "round": "i", "trunc": "i", "odd": "b"}.get(name, "d")
    _, word, left, right = node
    one, other = type_of(left), type_of(right)
    if word in ("and", "or", "xor"):
        if one != other or one == "d":
            raise Wrong
        return one
    if (one == "b") != (other == "b"):
        raise Wrong
    if word in ("=", "<>", "<", "<=", ">", ">="):
        return "b"
    if one == "b" or (word in ("div", "mod", "shl", "shr") and "d" in (one, other)):
        raise Wrong
    return "d" if word == "/" or "d" in (one, other) else "i"


def names() -> Symbols:
    symbols = Symbols(Findings(limit=10_000))
    parse_section(["var n: integer; x: double; q: boolean;", "const K = 5;"], Place("job", 1), symbols)
    assert symbols.findings.kept == []
    return symbols


def labels(symbols: Symbols) -> set[str]:
    return {finding.code.label for finding in symbols.findings.kept}


def wanted(node: Tree) -> str:
    try:
        return type_of(node)
    except Wrong:
        return ""


@pytest.mark.parametrize("seed", range(2))
def test_types_of_random_expressions(seed: int) -> None:
    random_ = random.Random(seed)
    right = 0
    for _ in range(500):
        node = tree(random_, random_.randint(1, 3))
        text, kind = written(node), wanted(node)
        symbols = names()
        _, found, end = parse_expression(text, 0, Place("job", 1), symbols)
        assert end == len(text), text
        assert ("GP135" in labels(symbols)) == (not kind), text
        if kind:
            right += 1
            assert NAMES[found] == kind, text
    assert right > 100


@pytest.mark.parametrize("seed", range(2))
def test_types_that_statements_ask_for(seed: int) -> None:
    random_ = random.Random(50 + seed)
    for _ in range(60):
        node = tree(random_, random_.randint(0, 2))
        text, kind = written(node), wanted(node)
        for line, allowed in (
            (f"n := {text};", "i"), (f"CI600 := {text};", "i"), (f"x := {text};", "id"), (f"CD600 := {text};", "id"),
            (f"q := {text};", "b"), (f"if {text} then begin", "b"), (f"while {text} do begin", "b"),
            (f"end until {text};", "b"), (f"end else if {text} begin", "b"), (f"for n := {text} to 5 do begin", "i"),
            (f"for CI600 := 1 downto {text} do begin", "i"), (f"wt({text});", "id"),
        ):  # fmt: skip
            symbols = names()
            try:
                parse_dollar(line, 0, Place("job", 1), symbols)
            except PascalError as error:
                raise AssertionError((line, error.finding)) from None
            assert ("GP135" in labels(symbols)) == (kind == "" or kind not in allowed), line
