"""Operators that a target's expressions do not have -> others, with the same value but for rounding."""

from __future__ import annotations

import math

from gproof.ir.job import Node
from gproof.ir.program import Binary, Expr, Number, Unary
from gproof.passes.legalize.context import Context
from gproof.passes.legalize.expressions import with_expressions
from gproof.passes.legalize.pattern import Pattern

_RADIANS = {"rsin": "sin", "rcos": "cos", "rtan": "tan"}
_ARCS = {"rasin": "asin", "racos": "acos", "ratan": "atan"}


def others(node: Node, feature: str, context: Context) -> list[Node] | None:
    """The operation with every such operator replaced; None where one has no other."""
    lost = False

    def change(expr: Expr) -> Expr:
        nonlocal lost
        if isinstance(expr, Unary | Binary) and expr.operator not in context.target.operators:
            found = _unary(expr) if isinstance(expr, Unary) else _binary(expr)
            if found is None:
                lost = True
                context.why = f"its expressions have no {expr.operator} that gives the same for all numbers"
            return expr if found is None else found
        return expr

    found = with_expressions(node, change)
    return None if lost else [found]


def _unary(expr: Unary) -> Expr | None:
    x, span = expr.operand, expr.span
    if expr.operator in _RADIANS:
        return Unary(_RADIANS[expr.operator], Binary("*", x, Number(180.0 / math.pi, span), span), span)
    if expr.operator in _ARCS:
        return Binary("*", Unary(_ARCS[expr.operator], x, span), Number(math.pi / 180.0, span), span)
    if expr.operator == "sqr":
        return Binary("*", x, x, span)
    if expr.operator == "frac":
        return Binary("-", x, Unary("int", x, span), span)
    if expr.operator in {"trunc", "nearest"}:
        return Unary({"trunc": "int", "nearest": "round"}[expr.operator], x, span)
    if expr.operator == "bool":
        return Binary("<>", x, Number(0.0, span), span)
    if expr.operator == "not":
        return Binary("==", x, Number(0.0, span), span)
    return None


def _binary(expr: Binary) -> Expr | None:
    x, y, span = expr.left, expr.right, expr.span
    if expr.operator == "div":
        return Unary("int", Binary("/", x, y, span), span)
    if expr.operator == "rem":
        return Binary("-", x, Binary("*", y, Unary("int", Binary("/", x, y, span), span), span), span)
    return None


PATTERNS = (Pattern(name="operator -> others", removes=("operator",), apply=others, unrolls=True),)
