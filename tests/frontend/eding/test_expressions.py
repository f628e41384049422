"""Expressions: what is written is what is read, blanks and case mean nothing, doubt is marked."""

from __future__ import annotations

import random
from decimal import Decimal

import pytest
from frontend.eding.programs import NOWHERE, without_places
from hypothesis import given
from hypothesis import strategies as st
from support.campaigns import examples

from gproof.frontend.eding.parse import parse_line
from gproof.ir.program import Assign, Binary, Block, Expr, Number, Unary, Variable, Word

FUNCTIONS = "abs acos asin cos exp fix fup int ln round sin sqrt tan not".split()
# Weakest first, each from left to right: manual 3.2.2.3, then the choice for the operators that only 4.2 lists.
LEVELS = [
    [">", ">=", "<", "<=", "==", "<>"],
    ["<<", ">>"],
    ["+", "-", "and", "or", "xor", "band", "bor", "bxor"],
    ["*", "/", "mod"],
    ["**"],
]
OPERATORS = [operator for level in LEVELS for operator in level]


def level_of(operator: str) -> int:
    return next(n for n, level in enumerate(LEVELS) if operator in level)


def number(value: float) -> Number:
    return Number(value, NOWHERE)


LEAVES: st.SearchStrategy[Expr] = st.floats(min_value=0, max_value=1e15).map(number)


def grow(inner: st.SearchStrategy[Expr]) -> st.SearchStrategy[Expr]:
    return st.one_of(
        st.builds(lambda e: Variable(e, NOWHERE), inner),
        st.builds(lambda name, e: Unary(name, e, NOWHERE), st.sampled_from(["neg", "pos", *FUNCTIONS]), inner),
        st.builds(lambda o, a, b: Binary(o, a, b, NOWHERE), st.sampled_from([*OPERATORS, "atan"]), inner, inner),
    )


EXPRESSIONS = st.recursive(LEAVES, grow, max_leaves=12)


def bracketed(node: Expr) -> str:
    return f"[{render(node)}]"


def operand(node: Expr) -> str:
    """A real value: what stands behind a letter, ``#`` or an operator without brackets of its own."""
    if isinstance(node, Number):
        return format(Decimal(repr(node.value)), "f")
    if isinstance(node, Variable):
        return "#" + operand(node.number)
    if isinstance(node, Unary) and node.operator in ("neg", "pos"):
        inner = (
            bracketed(node.operand)
            if isinstance(node.operand, Number) or signed(node.operand)
            else operand(node.operand)
        )
        return ("-" if node.operator == "neg" else "+") + inner
    if isinstance(node, Unary):
        return node.operator + bracketed(node.operand)
    if isinstance(node, Binary) and node.operator == "atan":
        return f"atan{bracketed(node.left)}/{bracketed(node.right)}"
    return bracketed(node)


def signed(node: Expr) -> bool:
    return isinstance(node, Unary) and node.operator in ("neg", "pos")


def render(node: Expr) -> str:
    """Inside brackets, with no more brackets than the levels need."""
    if not isinstance(node, Binary) or node.operator == "atan":
        return operand(node)
    level = level_of(node.operator)
    left = isinstance(node.left, Binary) and node.left.operator != "atan" and level_of(node.left.operator) >= level
    right = isinstance(node.right, Binary) and node.right.operator != "atan" and level_of(node.right.operator) > level
    texts = [render(side) if free else operand(side) for side, free in ((node.left, left), (node.right, right))]
    return f"{texts[0]} {node.operator} {texts[1]}"


def block(text: str) -> Block:
    (found,) = parse_line(text.encode(), "job.cnc", 1)
    assert isinstance(found, Block)
    return found


def value(text: str) -> Expr:
    """The value of X in a line ``x…``."""
    return block("x" + text).words[0].value


@examples(125, 2000)
@given(EXPRESSIONS)
def test_a_written_expression_reads_back_as_the_same_tree(expression: Expr) -> None:
    assert without_places(value(f"[{render(expression)}]")) == expression
    assert without_places(value(operand(expression))) == expression
    assert without_places(block(f"#{operand(expression)}={operand(expression)}").assigns[0]) == Assign(
        Variable(expression, NOWHERE), expression, NOWHERE
    )


@examples(75, 1200)
@given(EXPRESSIONS, st.integers(0, 2**32))
def test_blanks_and_case_change_nothing(expression: Expr, seed: int) -> None:
    rng = random.Random(seed)  # one choice of hypothesis, not two a character
    text = f"n10g1x{operand(expression)}#3=[{render(expression)}](c)y#3"
    spaced = "".join(c + rng.choice(["", "", "", " ", "\t", "  "]) for c in text)
    assert without_places(block(spaced.swapcase()))  # no error
    assert without_places(block(spaced)).words == without_places(block(text)).words
    assert without_places(block(spaced)).assigns == without_places(block(text)).assigns
    assert without_places(block(text.upper())).words == without_places(block(text)).words


@examples(75, 1200)
@given(EXPRESSIONS)
def test_places_cover_what_they_name(expression: Expr) -> None:
    text = f"[{render(expression)}]"

    def check(node: Expr) -> None:
        written = ("x" + text)[node.span.column - 1 : node.span.end_column - 1]
        assert without_places(value(f"[{written}]")) == without_places(node)
        for inner in (getattr(node, name, None) for name in ("number", "operand", "left", "right")):
            if inner is not None:
                check(inner)

    check(value(text))


@pytest.mark.parametrize(
    ("text", "same"),
    [
        ("[2.0 / 3 * 1.5 - 5.5 / 11.0]", "[[[2.0 / 3] * 1.5] - [5.5 / 11.0]]"),
        ("[1 + acos[0] - [#3 ** [4.0/2]]]", "[[1 + acos[0]] - [#3 ** [4.0/2]]]"),
        ("[2 ** 3 ** 2]", "[[2 ** 3] ** 2]"),
        ("[-2 ** 2]", "[[-2] ** 2]"),
        ("[2 ** -1]", "[2 ** [-1]]"),
        ("[1 and 2 + 3 or 4]", "[[[1 and 2] + 3] or 4]"),
        ("[10 mod 4 * 2]", "[[10 mod 4] * 2]"),
        ("[#1+2]", "[[#1] + 2]"),
        ("[##2]", "[#[#2]]"),
        ("[1 < 2 + 3 << 1]", "[1 < [[2 + 3] << 1]]"),
        ("[1 band 3 + 4]", "[[1 band 3] + 4]"),
        ("[atan[1]/[2] * 3]", "[[atan[1]/[2]] * 3]"),
        ("#-1", "#[-1]"),
        ("-#1", "-[#1]"),
        ("sqrt[4]", "[sqrt[4]]"),
        ("#sin[90]", "#[sin[90]]"),
    ],
)
def test_how_operators_group(text: str, same: str) -> None:
    assert without_places(value(text)) == without_places(value(same))


def doubts(node: Expr) -> list[str]:
    found = [node.operator] if isinstance(node, Binary) and node.doubtful else []
    for name in ("number", "operand", "left", "right"):
        inner = getattr(node, name, None)
        if inner is not None:
            found += doubts(inner)
    return found


@pytest.mark.parametrize(
    ("text", "operators"),
    [
        ("[1 + 2 * 3 ** 4 mod 5 and 6]", []),
        ("[1 < 2]", []),
        ("[[1 + 2] < 3]", []),
        ("[1 + 2 < 3]", ["<"]),
        ("[1 < 2 + 3]", ["<"]),
        ("[1 < 2 and 3 < 4]", ["<", "<"]),
        ("[[1 < 2] and [3 < 4]]", []),
        ("[1 < 2 < 3]", ["<"]),
        ("[1 band 2 band 3]", []),
        ("[1 band 2 bor 3]", ["bor"]),
        ("[1 band 2 and 3]", ["and"]),
        ("[1 band 2 * 3]", ["band"]),
        ("[1 << 2 + 3]", ["<<"]),
        ("[1 << 2 << 3]", ["<<"]),
        ("[-#1 ** 2]", ["**"]),
        ("[-1 ** 2]", []),
        ("[-#1 * 2]", []),
        ("[-#1 mod 2]", ["mod"]),
        ("[-#1 < 2]", []),
        ("[sin[1 < 2 + 3] + 1]", ["<"]),
        ("[atan[1]/[2] < 3]", []),
    ],
)
def test_doubt_is_marked_where_the_manual_states_no_precedence(text: str, operators: list[str]) -> None:
    assert doubts(value(text)) == operators


@pytest.mark.parametrize(
    ("text", "number"),
    [("+0. 12 34", 0.1234), ("-.5", -0.5), ("5.", 5.0), ("-0", -0.0), ("[-0]", -0.0), ("99999999999999999999.5", 1e20)],
)
def test_numbers(text: str, number: float) -> None:
    found = value(text)
    assert isinstance(found, Number)
    assert repr(found.value) == repr(number)


@pytest.mark.parametrize("before", ["", "n10", "/", "/ N5 ", "(c)", "g1", "#1=2"])
@pytest.mark.parametrize("blank", ["", " "])
def test_a_function_behind_a_letter_is_its_value(before: str, blank: str) -> None:
    """Whatever the two spell together: ``i fix[2.5]`` begins like an ``if``."""
    for letter in "abcdefghijklmpqrstxyz":
        for function in FUNCTIONS:
            found = block(f"{before}{letter}{blank}{function}{blank}[2.5]")
            expected = Word(letter.upper(), Unary(function, Number(2.5, NOWHERE), NOWHERE), NOWHERE)
            assert without_places(found.words[-1]) == expected
