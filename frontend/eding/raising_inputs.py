"""M56 and the choice or the loop after it -> choices by an input, and waits for one (3.5.9, 4.1).

M56 leaves the state of the input in #5399. Where nothing else reads that variable, the choice after M56 is one by the
input, and a loop that reads it until it is on or off is the wait for that.
"""

from __future__ import annotations

from dataclasses import replace

from gproof.ir.job import (
    Choice,
    CountLoop,
    Job,
    LoopWhile,
    Node,
    Nodes,
    OptionalPart,
    Remark,
    WaitFor,
    walk,
)
from gproof.ir.job_features import expressions, parts_of_expression
from gproof.ir.program import Binary, Expr, Input, Number, Unary, Variable

READ_INTO = 5399.0


def by_inputs(job: Job) -> Job:
    """The job with its choices and waits by inputs as such; as it is where #5399 is read elsewhere."""
    bodies = {name: _list(routine.body) for name, routine in job.routines.items()}
    body = _list(job.body)
    for nodes in (body, *bodies.values()):
        if any(_reads(node) for node in walk(nodes)):
            return job
    routines = {name: replace(routine, body=bodies[name]) for name, routine in job.routines.items()}
    return replace(job, body=body, routines=routines)


def _reads(node: Node) -> bool:
    return any(_is_held(part) for expr in expressions(node) for part in parts_of_expression(expr))


def _is_held(expr: Expr) -> bool:
    return isinstance(expr, Variable) and isinstance(expr.number, Number) and expr.number.value == READ_INTO


def _list(nodes: Nodes) -> Nodes:
    found: list[Node] = []
    for node in map(_inside, nodes):
        place = next((n for n in range(len(found) - 1, -1, -1) if not isinstance(found[n], Remark)), -1)
        read = found[place] if place >= 0 else None
        if isinstance(read, WaitFor) and read.on is None and isinstance(node, Choice | LoopWhile):
            instead = _asked(node, read)
            if instead is not None:
                del found[place]
                node = instead
        found.append(node)
    return tuple(found)


def _inside(node: Node) -> Node:
    if isinstance(node, Choice):
        return replace(node, then=_list(node.then), otherwise=_list(node.otherwise))
    if isinstance(node, OptionalPart | LoopWhile | CountLoop):
        return replace(node, body=_list(node.body))
    return node


def _asked(node: Choice | LoopWhile, read: WaitFor) -> Node | None:
    """A choice by the input, or the wait for it; None where it is neither."""
    on = _state(node.condition)
    if on is None or (isinstance(node, Choice) and node.question):
        return None
    if isinstance(node, Choice):
        asked: Expr = Input("input", read.channel, node.span)
        return replace(node, condition=asked if on else Unary("not", asked, node.span))
    inner = [one for one in node.body if not isinstance(one, Remark)]
    again = inner[0] if len(inner) == 1 else None
    is_wait = isinstance(again, WaitFor) and again.on is None and _same(again.channel, read.channel)
    return WaitFor(channel=read.channel, on=not on, span=read.span) if is_wait and not node.first else None


def _same(one: Expr, other: Expr) -> bool:
    return isinstance(one, Number) and isinstance(other, Number) and one.value == other.value


def _state(condition: Expr) -> bool | None:
    """Which state of the input a condition asks for; None where it asks for something else."""
    on = True
    while isinstance(condition, Unary) and condition.operator == "not":
        condition, on = condition.operand, not on
    if _is_held(condition):
        return on
    if not isinstance(condition, Binary) or condition.operator not in ("==", "<>"):
        return None
    held, wanted = condition.left, condition.right
    if _is_held(wanted):
        held, wanted = wanted, held
    if not _is_held(held) or not isinstance(wanted, Number) or wanted.value not in (0.0, 1.0):
        return None
    return on == ((wanted.value == 1.0) == (condition.operator == "=="))
