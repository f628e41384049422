"""Expressions as Eding text: brackets where the same tree needs them, and in no other place.

A tree is printed so that the frontend builds it again, ``Binary.doubtful`` included: a neighbour whose grouping the
manual leaves open (``ir/dialects/eding/operators.py``) is bracketed, unless the node says that it was not.
Source: Eding manual 3.2.2 (values), 3.2.2.3 (operators only inside brackets), 3.2.2.4 (functions), 4.2 (texts).
"""

from __future__ import annotations

from gproof.backend.emit.numbers import number_text
from gproof.backend.emit.printer import Unprintable
from gproof.ir.dialects.eding.operators import LEVEL, SIGN, is_doubtful
from gproof.ir.program import Assign, Binary, Expr, Number, Text, Unary, Variable, Word

_SIGNS = {"neg": "-", "pos": "+"}
_CURLY = "“”„"


def inside(node: Expr, *, keep: bool = False) -> str:
    """An expression as it is written between brackets.

    keep: it is part of a chain that groups in several ways, in which no bracket may go.
    """
    if isinstance(node, Binary) and node.operator != "atan":
        keep = keep or bool(node.readings)
        left = _operand(node, node.left, keep and node.span.column < node.left.span.column, keep, is_right=False)
        more = keep and node.right.span.end_column < node.span.end_column
        right = _operand(node, node.right, more, keep, is_right=True)
        return f"{left} {node.operator} {right}"
    if isinstance(node, Binary):
        return f"atan[{inside(node.left)}]/[{inside(node.right)}]"
    if isinstance(node, Unary) and node.operator in _SIGNS:
        return _SIGNS[node.operator] + _signed(node.operand)
    if isinstance(node, Unary):
        return f"{node.operator}[{inside(node.operand)}]"
    if isinstance(node, Variable):
        return variable(node)
    if isinstance(node, Number):
        return number_text(node.value, node.point)
    raise Unprintable("a text in an expression")


def _operand(outer: Binary, node: Expr, bracketed: bool, keep: bool, *, is_right: bool) -> str:
    """One side of a binary operator, in brackets where it would group otherwise or be doubtful without."""
    operator = outer.operator
    text = inside(node, keep=keep and not bracketed)
    if isinstance(node, Binary) and node.operator != "atan":
        inner = node.operator
        grouped = LEVEL[inner] <= LEVEL[operator] if is_right else LEVEL[inner] < LEVEL[operator]
    elif isinstance(node, Unary) and node.operator in _SIGNS:
        inner, grouped = SIGN, False
    else:
        return text
    doubt = is_doubtful(operator, inner) and not outer.doubtful
    return f"[{text}]" if grouped or bracketed or doubt else text


def _signed(node: Expr) -> str:
    """What comes after a sign: a number, or another sign, only in brackets."""
    if isinstance(node, Variable) or (isinstance(node, Unary) and node.operator not in _SIGNS):
        return inside(node)
    if isinstance(node, Binary) and node.operator == "atan":
        return inside(node)
    return f"[{inside(node)}]"


def variable(node: Variable) -> str:
    """``#5``, ``##5``, ``#[#1 + 2]``."""
    number = node.number
    plain = isinstance(number, Variable) or (isinstance(number, Number) and str(number.value)[0] != "-")
    return f"#{inside(number)}" if plain else f"#[{inside(number)}]"


def value(node: Expr, *, grouped: bool = False) -> str:
    """A value outside of brackets, after a letter or ``=``; grouped: a number in brackets all the same."""
    if isinstance(node, Number) and not grouped:
        return inside(node)
    if isinstance(node, Variable):
        return variable(node)
    if isinstance(node, Unary) and node.operator in _SIGNS and isinstance(node.operand, Variable):
        return inside(node)
    return f"[{inside(node)}]"


def word(node: Word, *, grouped: bool = False) -> str:
    """``X5.0``, ``X#1``, ``X[#1 + 2]``."""
    return f"{node.letter}{value(node.value, grouped=grouped)}"


def setting(node: Assign) -> str:
    """``#1 = [#1 + 1]``."""
    is_function = isinstance(node.value, Unary) and node.value.operator not in _SIGNS
    is_function = is_function or (isinstance(node.value, Binary) and node.value.operator == "atan")
    return f"{variable(node.target)} = {inside(node.value) if is_function else value(node.value)}"


def quoted(text: str) -> str:
    """A text in straight quotes; in curly ones when it has a straight quote in it."""
    if '"' not in text:
        return f'"{text}"'
    if any(quote in text for quote in _CURLY):
        raise Unprintable("a text with straight and with curly quotes")
    return f"“{text}”"


def part(node: Expr) -> str:
    """A part of a message: a text, a parameter, or an expression in brackets."""
    if isinstance(node, Text):
        return quoted(node.value)
    return variable(node) if isinstance(node, Variable) else f"[{inside(node)}]"
