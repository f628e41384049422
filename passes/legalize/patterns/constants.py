"""Variables and expressions -> numbers."""

from __future__ import annotations

from dataclasses import fields, replace
from typing import Any

from gproof.ir.job import AxisPlace, Feed, Node, Quantity, SetVariable
from gproof.ir.program import Binary, Constant, Input, Named, Number, Unary, Variable
from gproof.passes.legalize.context import Context
from gproof.passes.legalize.pattern import Pattern

_EXPRESSIONS = (Variable, Constant, Named, Input, Unary, Binary)


class _Unknown(Exception):
    """A value is not known."""


def _folded(value: Any, context: Context) -> Any:
    """A field with every expression in it as a number; _Unknown."""
    if isinstance(value, _EXPRESSIONS):
        found = context.value(value)
        if found is None:
            raise _Unknown
        return Number(found, value.span)
    if isinstance(value, Quantity):
        return Quantity(_folded(value.value, context), value.unit)
    if isinstance(value, AxisPlace):
        return AxisPlace(value.axis, _folded(value.at, context), value.relative)
    if isinstance(value, Feed):
        return Feed(_folded(value.amount, context), value.per)
    if isinstance(value, tuple) and not any(isinstance(one, Node) for one in value):
        return tuple(_folded(one, context) for one in value)
    return value


def fold(node: Node, feature: str, context: Context) -> list[Node] | None:
    """An operation whose expressions all have known values."""
    if isinstance(node, SetVariable):
        value = context.value(node.value) if feature == "system_variable" else None
        return None if value is None else [replace(node, value=Number(value, node.span))]
    try:
        found = {f.name: _folded(getattr(node, f.name), context) for f in fields(node)}
    except _Unknown:
        return None
    return [replace(node, **found)]


def settle(node: Node, feature: str, context: Context) -> list[Node] | None:
    """A setting of a variable, in a language without variables: the value is remembered."""
    if not isinstance(node, SetVariable) or feature not in {"variable", "indirect"}:
        return None
    number, value = context.value(node.target.number), context.value(node.value)
    if number is None:
        return None
    if value is None:
        # What needs it is refused; a variable that nothing needs is none.
        context.values.pop(round(number), None)
    else:
        context.values[round(number)] = value
    return []


PATTERNS = (
    Pattern(name="setting of a variable -> remembered value", removes=("variable", "indirect"), apply=settle),
    Pattern(
        name="expression -> number",
        removes=("indirect", "system_variable", "input_value", "variable", "expression"),
        apply=fold,
    ),
)
