"""Moves in machine coordinates -> moves in coordinates whose zero is there for so long."""

from __future__ import annotations

from dataclasses import replace

from gproof.ir.job import AxisPlace, MoveTo, Node, Quantity, SetFrame
from gproof.ir.machine import AXIS_NAMES
from gproof.ir.program import Number
from gproof.passes.legalize.context import Context
from gproof.passes.legalize.pattern import Pattern

NEEDED = ("frame_zero_keep", "frame_zero_at", "frame_zero_recall")


def zero_in_between(node: Node, feature: str, context: Context) -> list[Node] | None:
    """The zero is kept, put at machine zero for the move, and brought back; in a job that keeps no zero itself."""
    if not isinstance(node, MoveTo) or node.frame != "machine" or any(place.relative for place in node.to):
        return None
    if any(one not in context.target.legal for one in NEEDED) or not node.to:
        return None
    if any(isinstance(one, SetFrame) and one.action == "zero_keep" for one in context.nodes()):
        return None
    span = node.span
    # A frame that is turned or scaled is none of the machine.
    if any(isinstance(one, SetFrame) and one.action in {"rotate", "scale", "mirror"} for one in context.nodes()):
        return None
    named = sorted(node.to, key=lambda place: AXIS_NAMES.index(place.axis))
    zeros = tuple(
        AxisPlace(place.axis, Quantity(Number(0.0, span), "mm" if place.axis in "xyz" else "deg")) for place in named
    )
    return [
        SetFrame(action="zero_keep", span=span),
        SetFrame(action="zero_at", places=zeros, span=span),
        replace(node, frame="work"),
        SetFrame(action="zero_recall", span=span),
    ]


PATTERNS = (
    Pattern(name="machine coordinates -> zero there and back", removes=("machine_move",), apply=zero_in_between),
)
