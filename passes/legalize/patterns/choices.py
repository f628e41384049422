"""Choices -> the way that is taken, where that is known."""

from __future__ import annotations

from dataclasses import replace

from gproof.ir.job import Choice, Node, OptionalPart, PauseJob
from gproof.passes.legalize.context import Context
from gproof.passes.legalize.pattern import Pattern


def decided(node: Node, feature: str, context: Context) -> list[Node] | None:
    """A choice by a condition whose value is known."""
    if not isinstance(node, Choice):
        return None
    condition = context.value(node.condition)
    if condition is None:
        return None
    return list(node.then if condition != 0.0 else node.otherwise)


def switched(node: Node, feature: str, context: Context) -> list[Node] | None:
    """What block delete leaves out, where the position of its switch is stated."""
    if not isinstance(node, OptionalPart) or context.options.block_delete is None:
        return None
    on = context.options.block_delete
    context.assume(f"the switch for block delete is {'on' if on else 'off'}")
    return [] if on else list(node.body)


def stop_switched(node: Node, feature: str, context: Context) -> list[Node] | None:
    """An optional stop, where the position of its switch is stated: a stop, or none."""
    if not isinstance(node, PauseJob) or not node.optional:
        return None
    on = context.options.optional_stop
    if on is None:
        context.why = "it has no stop that a switch turns off, and the setup file does not state optional_stop"
        return None
    context.assume(f"the switch for optional stops is {'on' if on else 'off'}")
    return [replace(node, optional=False)] if on else []


PATTERNS = (
    Pattern(
        name="choice -> the way that is taken", removes=("choice_else", "choice", "variable", "expression"),
        apply=decided, unrolls=True,
    ),
    Pattern(
        name="block delete -> what its switch says", removes=("optional_part",), apply=switched, unrolls=True
    ),
    Pattern(
        name="optional stop -> what its switch says", removes=("optional_stop",), apply=stop_switched, unrolls=True
    ),
)  # fmt: skip
