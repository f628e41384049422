"""Every expression of an operation replaced by another one."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields, replace
from typing import Any

from gproof.ir.job import AxisPlace, Feed, Moves, Node, Quantity
from gproof.ir.program import Binary, Constant, Expr, Input, Named, Number, Unary, Variable

EXPRESSIONS = (Number, Variable, Constant, Named, Input, Unary, Binary)
Change = Callable[[Expr], Expr]


def changed(expr: Expr, change: Change) -> Expr:
    """An expression with ``change`` applied to each of its parts, the inner ones first."""
    if isinstance(expr, Variable | Input):
        number = changed(expr.number, change)
        expr = expr if number is expr.number else replace(expr, number=number)
    elif isinstance(expr, Unary):
        operand = changed(expr.operand, change)
        expr = expr if operand is expr.operand else replace(expr, operand=operand)
    elif isinstance(expr, Binary):
        left, right = changed(expr.left, change), changed(expr.right, change)
        same = left is expr.left and right is expr.right
        readings = tuple(changed(one, change) for one in expr.readings)
        expr = expr if same else replace(expr, left=left, right=right, readings=readings)
    return change(expr)


def with_expressions(node: Node, change: Change) -> Node:
    """An operation with its own expressions changed; those of operations within it stay."""
    if isinstance(node, Moves):
        return node
    found: dict[str, Any] = {}
    for one in fields(node):
        value = getattr(node, one.name)
        new = _of(value, change)
        if new is not value:
            found[one.name] = new
    return replace(node, **found) if found else node


def _of(value: Any, change: Change) -> Any:
    if isinstance(value, EXPRESSIONS):
        return changed(value, change)
    if isinstance(value, Quantity):
        inner = _of(value.value, change)
        return value if inner is value.value else Quantity(inner, value.unit)
    if isinstance(value, AxisPlace):
        inner = _of(value.at, change)
        return value if inner is value.at else AxisPlace(value.axis, inner, value.relative)
    if isinstance(value, Feed):
        inner = _of(value.amount, change)
        return value if inner is value.amount else Feed(inner, value.per)
    if isinstance(value, tuple) and not any(isinstance(one, Node) for one in value):
        new = tuple(_of(one, change) for one in value)
        return value if all(a is b for a, b in zip(value, new, strict=True)) else new
    return value
