"""Expressions as LinuxCNC text: brackets around each operation within another one.

MOD is never negative and FIX rounds down: they stand for operations that go towards zero, and the same values come of
that only where none is negative; the comparison of the whole translation says whether it is so.

Source: LinuxCNC user manual, G-Code Overview: Expressions, Binary Operators, Functions, Parameters.
"""

from __future__ import annotations

from collections.abc import Callable

from gproof.backend.emit.numbers import number_text
from gproof.backend.emit.printer import Unprintable
from gproof.ir.program import Binary, Constant, Expr, Number, Unary, Variable

BINARY = {
    "+": "+", "-": "-", "*": "*", "/": "/", "**": "**", "mod": "MOD", "and": "AND", "or": "OR", "xor": "XOR",
    "rem": "MOD",
    "==": "EQ", "<>": "NE", ">": "GT", ">=": "GE", "<": "LT", "<=": "LE",
}  # fmt: skip
DEGREES = "57.29577951308232"
"""Of a radian: angles of functions are degrees (Overview, Functions)."""
FUNCTIONS = frozenset("abs acos asin cos exp fix fup ln round sin sqrt tan".split())

Naming = Callable[[int], int]
"""Number of a variable of the job -> that in the text."""


def inside(node: Expr, naming: Naming) -> str:
    """An expression as it is between brackets; Unprintable."""
    if isinstance(node, Number | Constant):
        return number_text(node.value, False)
    if isinstance(node, Variable):
        return variable(node, naming)
    if isinstance(node, Unary):
        return _unary(node, naming)
    if isinstance(node, Binary) and node.operator == "atan":
        return f"ATAN[{inside(node.left, naming)}]/[{inside(node.right, naming)}]"
    if isinstance(node, Binary) and node.operator == "div":
        return f"FIX[{_operand(node.left, naming)} / {_operand(node.right, naming)}]"
    if isinstance(node, Binary) and node.operator in BINARY:
        return f"{_operand(node.left, naming)} {BINARY[node.operator]} {_operand(node.right, naming)}"
    raise Unprintable("an operation that LinuxCNC does not have")


def _unary(node: Unary, naming: Naming) -> str:
    within = inside(node.operand, naming)
    if node.operator in FUNCTIONS:
        return f"{node.operator.upper()}[{within}]"
    if node.operator == "atan":
        return f"ATAN[{within}]/[1]"
    if node.operator in ("rsin", "rcos", "rtan"):
        return f"{node.operator[1:].upper()}[{_operand(node.operand, naming)} * {DEGREES}]"
    if node.operator in ("rasin", "racos"):
        return f"{node.operator[1:].upper()}[{within}] / {DEGREES}"
    if node.operator == "ratan":
        return f"ATAN[{within}]/[1] / {DEGREES}"
    if node.operator in ("int", "trunc"):
        return f"FIX[{within}]"
    if node.operator == "nearest":
        return f"ROUND[{within}]"
    if node.operator == "frac":
        return f"{_operand(node.operand, naming)} - FIX[{within}]"
    if node.operator == "odd":
        return f"{_operand(node.operand, naming)} MOD 2"
    if node.operator == "sqr":
        return f"{_operand(node.operand, naming)} ** 2"
    if node.operator == "bool":
        return f"{_operand(node.operand, naming)} NE 0"
    if node.operator == "neg":
        return f"0 - {_operand(node.operand, naming)}"
    if node.operator == "pos":
        return within
    if node.operator == "not":
        return f"{_operand(node.operand, naming)} EQ 0"
    raise Unprintable(f"the function {node.operator}")


def _operand(node: Expr, naming: Naming) -> str:
    """One side of an operator: a value, or anything else in brackets."""
    text = inside(node, naming)
    is_value = isinstance(node, Variable | Constant) or (isinstance(node, Number) and node.value >= 0.0)
    is_value = is_value or (isinstance(node, Unary) and node.operator in FUNCTIONS)
    return text if is_value else f"[{text}]"


def variable(node: Variable, naming: Naming) -> str:
    """``#31``, ``#[#31 + 1000]``."""
    if isinstance(node.number, Number):
        if node.number.value != round(node.number.value):
            raise Unprintable("a variable whose number is no integer")
        return f"#{naming(round(node.number.value))}"
    shift = naming(0)
    text = inside(node.number, naming)
    return f"#[{text}]" if not shift else f"#[[{text}] + {shift}]"


def value(node: Expr, naming: Naming) -> str:
    """A value after a letter or ``=``: ``5``, ``#31``, ``[#31 + 2]``."""
    text = inside(node, naming)
    return text if isinstance(node, Number | Constant | Variable) else f"[{text}]"
