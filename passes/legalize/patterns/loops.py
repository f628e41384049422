"""Loops -> loops that the target has, or their passes one after the other."""

from __future__ import annotations

from dataclasses import replace

from gproof.ir.job import CountLoop, LoopWhile, Node, SetVariable
from gproof.ir.program import Binary, Number
from gproof.passes.legalize.context import Context
from gproof.passes.legalize.pattern import Pattern


def counted(node: Node, feature: str, context: Context) -> list[Node] | None:
    """A counted loop whose bound is a number, as one with its condition at the start."""
    if not isinstance(node, CountLoop):
        return None
    last = context.value(node.last)
    if last is None or "variable" not in context.target.legal:
        return None
    span = node.span
    step = Binary("-" if node.down else "+", node.variable, Number(1.0, span), span)
    condition = Binary(">=" if node.down else "<=", node.variable, Number(last, span), span)
    return [
        SetVariable(target=node.variable, value=node.first, span=span),
        LoopWhile(
            condition=condition, body=(*node.body, SetVariable(target=node.variable, value=step, span=span)), span=span
        ),
    ]


def unrolled_count(node: Node, feature: str, context: Context) -> list[Node] | None:
    """A counted loop between numbers, pass by pass."""
    if not isinstance(node, CountLoop):
        return None
    first, last = context.value(node.first), context.value(node.last)
    if first is None or last is None:
        return None
    found: list[Node] = []
    value = round(first)
    while value >= last if node.down else value <= last:
        found.append(SetVariable(target=node.variable, value=Number(float(value), node.span), span=node.span))
        found += node.body
        context.spend(len(node.body) + 1)
        value += -1 if node.down else 1
    return found


def first_question(node: Node, feature: str, context: Context) -> list[Node] | None:
    """A loop with its condition at the end, whose condition holds already when it begins."""
    if not isinstance(node, LoopWhile) or not node.first or not context.value(node.condition):
        return None
    return [replace(node, first=False)]


def first_pass(node: Node, feature: str, context: Context) -> list[Node] | None:
    """A loop with its condition at the end: a pass, then one with the condition at the start."""
    if not isinstance(node, LoopWhile) or not node.first:
        return None
    return [*node.body, LoopWhile(condition=node.condition, body=node.body, span=node.span)]


def unrolled(node: Node, feature: str, context: Context) -> list[Node] | None:
    """A loop whose condition is known each time that it is asked."""
    if not isinstance(node, LoopWhile) or node.first:
        return None
    condition = context.value(node.condition)
    if condition is None:
        return None
    return [*node.body, node] if condition != 0.0 else []


PATTERNS = (
    Pattern(name="counted loop -> loop with a condition", removes=("count_loop",), apply=counted),
    Pattern(name="counted loop -> its passes", removes=("count_loop",), apply=unrolled_count, unrolls=True),
    Pattern(name="condition at the end -> at the start", removes=("repeat",), apply=first_question),
    Pattern(name="loop -> a pass, then a loop", removes=("repeat",), apply=first_pass, unrolls=True),
    Pattern(name="loop -> its passes", removes=("while", "variable", "expression"), apply=unrolled, unrolls=True),
)
