"""Runs of subprograms -> runs that the target has, or what they do."""

from __future__ import annotations

from dataclasses import replace

from gproof.ir.job import LeaveRoutine, Node, RunRoutine, SetVariable, walk
from gproof.passes.legalize.context import Context
from gproof.passes.legalize.pattern import Pattern


def repeated(node: Node, feature: str, context: Context) -> list[Node] | None:
    """Several runs, one after the other."""
    if not isinstance(node, RunRoutine) or node.count is None:
        return None
    count = context.value(node.count)
    if count is None or count != round(count) or count < 0:
        return None
    context.spend(round(count))
    return [replace(node, count=None)] * round(count)


def settings(node: Node, feature: str, context: Context) -> list[Node] | None:
    """Arguments as settings of variables before the run."""
    if not isinstance(node, RunRoutine) or not node.arguments or "variable" not in context.target.legal:
        return None
    before: list[Node] = [SetVariable(target=target, value=value, span=node.span) for target, value in node.arguments]
    return [*before, replace(node, arguments=())]


def inline(node: Node, feature: str, context: Context) -> list[Node] | None:
    """What the subprogram does, in place of its run."""
    if not isinstance(node, RunRoutine) or node.count is not None:
        return None
    body = context.job.routines[node.name].body
    last = len(body) - 1
    inside = [one for place, one in enumerate(body) if not (isinstance(one, LeaveRoutine) and place == last)]
    if any(isinstance(one, LeaveRoutine) for one in walk(tuple(inside))):
        return None
    context.spend(len(inside))
    values = [
        SetVariable(target=target, value=value, span=node.span) for target, value in node.arguments
    ]  # fmt: skip
    return [*values, *inside]


PATTERNS = (
    Pattern(name="several runs -> one after the other", removes=("routine_count",), apply=repeated),
    Pattern(name="arguments -> variables", removes=("routine_arguments",), apply=settings, unrolls=True),
    Pattern(
        name="subprogram -> what it does", removes=("routine_arguments", "routine"), apply=inline, unrolls=True
    ),
)  # fmt: skip
