"""States of inputs in conditions -> inputs that are read first."""

from __future__ import annotations

from dataclasses import fields, replace
from typing import Any

from gproof.ir.job import Choice, DwellFor, LoopWhile, Node, Quantity, WaitFor
from gproof.ir.job_features import parts_of_expression
from gproof.ir.program import Binary, Expr, Input, Number, Unary, Variable
from gproof.passes.legalize.context import Context
from gproof.passes.legalize.pattern import Pattern

READ_INTO = 5399
"""The variable that holds an input that was read (RS274)."""


def read_first(node: Node, feature: str, context: Context) -> list[Node] | None:
    """A choice or a loop by the state of one input: it is read, then the variable decides; in a loop each time."""
    if not isinstance(node, Choice | LoopWhile) or "input_read" not in context.target.legal:
        return None
    inputs = {part for part in parts_of_expression(node.condition) if isinstance(part, Input)}
    if len(inputs) != 1:
        return None
    only = next(iter(inputs))
    if isinstance(node, LoopWhile) and node.first:
        return None
    if only.kind != "input":
        return None
    held = Variable(Number(float(READ_INTO), node.span), node.span)
    condition = _asked(node.condition, only, held)
    read = WaitFor(channel=only.number, on=None, span=node.span)
    if isinstance(node, LoopWhile):
        return [read, replace(node, condition=condition, body=(*node.body, read), first=False)]
    return [read, replace(node, condition=condition)]


def _asked(condition: Expr, only: Expr, held: Expr) -> Expr:
    """A condition on what was read: 1 where the input is on."""
    wanted, inner = 1.0, condition
    while isinstance(inner, Unary) and inner.operator == "not":
        wanted, inner = 1.0 - wanted, inner.operand
    if inner == only:
        return Binary("==", held, Number(wanted, condition.span), condition.span)
    return _replaced(condition, only, held)


def looks(node: Node, feature: str, context: Context) -> list[Node] | None:
    """A wait without a limit, as a loop that looks at the input until it has the state."""
    legal, span = context.target.legal, node.span
    if not isinstance(node, WaitFor) or node.on is None or node.timeout is not None or "while" not in legal:
        return None
    if "input_read" in legal:
        held = Variable(Number(float(READ_INTO), span), span)
        waits = Binary("==" if node.on else "<>", held, Number(0.0, span), span)
        read = replace(node, on=None)
        return [read, LoopWhile(condition=waits, body=(read,), span=span)]
    if "input_value" not in legal:
        return None
    state = Input("input", node.channel, span)
    condition: Expr = Unary("not", state, span) if node.on else state
    pause = DwellFor(time=Quantity(Number(BETWEEN_LOOKS, span), "s"), span=span)
    # The first dwell lets the axes come to rest, which a condition does not.
    rest = replace(pause, time=Quantity(Number(0.0, span), "s"))
    return [rest, LoopWhile(condition=condition, body=(pause,), span=span)]


BETWEEN_LOOKS = 0.01
"""Seconds."""


def _replaced(expr: Expr, old: Expr, new: Expr) -> Expr:
    """An expression with a part replaced."""
    if expr == old:
        return new
    found: dict[str, Any] = {}
    for one in fields(expr):
        value = getattr(expr, one.name)
        if isinstance(value, Expr):
            found[one.name] = _replaced(value, old, new)
    return replace(expr, **found) if found else expr


PATTERNS = (
    Pattern(name="input in a condition -> read before", removes=("input_value",), apply=read_first),
    Pattern(name="wait for an input -> loop that looks", removes=("wait",), apply=looks),
)  # fmt: skip
