"""Jumps to labels -> loops and choices, where a list of operations has that shape."""

from __future__ import annotations

from dataclasses import replace

from gproof.ir.job import (
    Choice,
    CountLoop,
    GoTo,
    Job,
    LoopWhile,
    Mark,
    Node,
    Nodes,
    OptionalPart,
    RepeatGrid,
    walk,
)
from gproof.ir.program import Binary, Expr, Number


def structured(job: Job) -> Job:
    """The job with every jump as a loop or a choice that can be; others stay."""
    routines = {name: replace(one, body=_list(one.body)) for name, one in job.routines.items()}
    return Job(source=job.source, files=job.files, body=_list(job.body), routines=routines)


def _list(nodes: Nodes) -> Nodes:
    """A list of operations: those within its operations first, then its own jumps until none has a shape."""
    found = [_inside(node) for node in nodes]
    while True:
        after = _back(found) or _forward(found) or _unused(found)
        if after is None:
            return tuple(found)
        found = after


def _inside(node: Node) -> Node:
    if isinstance(node, Choice):
        return replace(node, then=_list(node.then), otherwise=_list(node.otherwise))
    if isinstance(node, OptionalPart | LoopWhile | CountLoop | RepeatGrid):
        return replace(node, body=_list(node.body))
    return node


def _jump(node: Node) -> tuple[str, Expr] | None:
    """(label, condition) of an operation that only jumps."""
    if isinstance(node, Choice) and not node.question:
        for way, other, condition in (
            (node.then, node.otherwise, node.condition), (node.otherwise, node.then, _not(node.condition)),
        ):  # fmt: skip
            if len(way) == 1 and isinstance(way[0], GoTo) and not other:
                return way[0].name, condition
    return None


def _not(condition: Expr) -> Expr:
    return Binary("==", condition, Number(0.0, condition.span), condition.span)


def _jumps_to(nodes: list[Node], name: str) -> int:
    return sum(isinstance(one, GoTo) and one.name == name for one in walk(tuple(nodes)))


def _back(nodes: list[Node]) -> list[Node] | None:
    """``label ... if condition goto label``: a loop with the condition at its end."""
    for place, node in enumerate(nodes):
        if not isinstance(node, Mark) or _jumps_to(nodes, node.name) != 1:
            continue
        for end in range(place + 1, len(nodes)):
            jump = _jump(nodes[end])
            if jump is not None and jump[0] == node.name:
                body = tuple(nodes[place + 1 : end])
                if any(isinstance(one, Mark) for one in body):
                    break
                loop = LoopWhile(condition=jump[1], body=body, span=node.span, first=True)
                return [*nodes[:place], loop, *nodes[end + 1 :]]
    return None


def _forward(nodes: list[Node]) -> list[Node] | None:
    """``if condition goto label ... label``: what is between runs where the condition is 0, after a bare jump never."""
    for place, node in enumerate(nodes):
        name = node.name if isinstance(node, GoTo) else (_jump(node) or ("", None))[0]
        if not name:
            continue
        for end in range(place + 1, len(nodes)):
            mark = nodes[end]
            if isinstance(mark, Mark) and mark.name == name:
                between = tuple(nodes[place + 1 : end])
                if any(isinstance(one, Mark) for one in between):
                    break
                jump = _jump(node)
                skipped: list[Node] = []
                if jump is not None:
                    skipped = [Choice(condition=jump[1], then=(), otherwise=between, span=node.span)]
                return [*nodes[:place], *skipped, *nodes[end:]]
    return None


def _unused(nodes: list[Node]) -> list[Node] | None:
    """Without labels that nothing jumps to from this list; one around it cannot jump into it."""
    for place, node in enumerate(nodes):
        if isinstance(node, Mark) and not _jumps_to(nodes, node.name):
            return [*nodes[:place], *nodes[place + 1 :]]
    return None
