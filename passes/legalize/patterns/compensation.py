"""Cutter compensation: that it is off says nothing where a job never switches it on."""

from __future__ import annotations

from gproof.ir.job import Compensate, Node, walk
from gproof.passes.legalize.context import Context
from gproof.passes.legalize.pattern import Pattern


def never_on(node: Node, feature: str, context: Context) -> list[Node] | None:
    """Off, in a job that has no compensation at all, for a target that has none."""
    if not isinstance(node, Compensate) or node.side != "off":
        return None
    bodies = (context.job.body, *(routine.body for routine in context.job.routines.values()))
    if any(isinstance(one, Compensate) and one.side != "off" for body in bodies for one in walk(body)):
        return None
    return []


PATTERNS = (Pattern(name="compensation off -> never on", removes=("compensation",), apply=never_on),)
