"""Moves in machine coordinates, and work zeros that are kept -> zeros in machine places, and what brings them back."""

from __future__ import annotations

from dataclasses import replace

from gproof.ir.finding import Span
from gproof.ir.job import AxisPlace, MoveTo, Node, Quantity, SetFrame
from gproof.ir.machine import AXIS_NAMES
from gproof.ir.program import Expr, Number
from gproof.passes.legalize.context import Context
from gproof.passes.legalize.pattern import Pattern

NEEDED = ("frame_zero_keep", "frame_zero_at", "frame_zero_recall")


def zero_in_between(node: Node, feature: str, context: Context) -> list[Node] | None:
    """The zero is put at machine zero for the move, and brought back: by its work offset where that is known, else by
    what the target keeps."""
    if not isinstance(node, MoveTo) or node.frame != "machine" or any(place.relative for place in node.to):
        return None
    if any(one not in context.target.legal for one in NEEDED) or not node.to:
        return None
    # A frame that is turned or scaled is none of the machine.
    if any(isinstance(one, SetFrame) and one.action in {"rotate", "scale", "mirror"} for one in context.nodes()):
        return None
    span = node.span
    named = sorted(node.to, key=lambda place: AXIS_NAMES.index(place.axis))
    zeros = tuple(
        AxisPlace(place.axis, Quantity(Number(0.0, span), "mm" if place.axis in "xyz" else "deg")) for place in named
    )
    there: list[Node] = [SetFrame(action="zero_at", places=zeros, span=span), replace(node, frame="work")]
    known = _offset(context)
    if known:
        back = SetFrame(action="select", number=Number(float(known), span), span=span)
        context.come_back(back, {place.axis for place in node.to})
        return [*there, back]
    if any(isinstance(one, SetFrame) and one.action == "zero_keep" for one in context.nodes()):
        return None
    return [SetFrame(action="zero_keep", span=span), *there, SetFrame(action="zero_recall", span=span)]


def _offset(context: Context) -> int:
    """The work offset that is the whole work zero, 0 where it is not known."""
    number = context.zero.offset
    return number if number and context.local == {} and number not in context.offsets else 0


def kept_as_known(node: Node, feature: str, context: Context) -> list[Node] | None:
    """A zero that is kept in one of several places: nothing where it is a work offset, which is chosen again."""
    if not isinstance(node, SetFrame) or node.action not in {"zero_keep", "zero_recall"}:
        return None
    key = _key(node.number, context)
    if node.action == "zero_keep":
        known = _offset(context)
        if known:
            context.kept[key] = context.zero, context.local_off
            return []
        context.kept.pop(key, None)
    elif key in context.kept and context.kept[key][0].offset:
        return [_select(context.kept[key][0].offset, node.span)]
    kept = {_key(one.number, context) for one in context.nodes() if isinstance(one, SetFrame) and _keeps(one)}
    return [replace(node, number=None)] if len(kept) == 1 else None


def _keeps(node: SetFrame) -> bool:
    return node.action == "zero_keep"


def _select(number: int, span: Span) -> SetFrame:
    return SetFrame(action="select", number=Number(float(number), span), span=span)


def _key(number: Expr | None, context: Context) -> float:
    value = None if number is None else context.value(number)
    return -1.0 if number is None else -2.0 if value is None else value


PATTERNS = (
    Pattern(name="machine coordinates -> zero there and back", removes=("machine_move",), apply=zero_in_between),
    Pattern(
        name="zero in one of several places -> its work offset", removes=("frame_zero_register",), apply=kept_as_known,
        unrolls=True,
    ),
)  # fmt: skip
