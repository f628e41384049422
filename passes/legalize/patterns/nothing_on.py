"""Ends of what the job never starts -> nothing: what earlier jobs left on is no part of it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from gproof.ir.job import Compensate, Node, UseLength, walk
from gproof.passes.legalize.context import Context
from gproof.passes.legalize.pattern import Pattern


def _never(context: Context, kind: type, started: Callable[[Any], bool]) -> bool:
    bodies = (context.job.body, *(routine.body for routine in context.job.routines.values()))
    return not any(isinstance(node, kind) and started(node) for body in bodies for node in walk(body))


def no_compensation(node: Node, feature: str, context: Context) -> list[Node] | None:
    """G40 of a job that never corrects a path."""
    if not isinstance(node, Compensate) or node.side != "off":
        return None
    if not _never(context, Compensate, lambda one: one.side != "off"):
        return None
    context.assume("no cutter compensation is on when the job starts")
    return []


def no_length(node: Node, feature: str, context: Context) -> list[Node] | None:
    """G49 of a job that never uses a tool length."""
    if not isinstance(node, UseLength) or node.on or not _never(context, UseLength, lambda one: one.on):
        return None
    context.assume("no tool length offset is on when the job starts")
    return []


PATTERNS = (
    Pattern(
        name="end of a compensation that never starts -> nothing", removes=("compensation",), apply=no_compensation
    ),
    Pattern(name="end of a tool length that is never used -> nothing", removes=("length",), apply=no_length),
)  # fmt: skip
