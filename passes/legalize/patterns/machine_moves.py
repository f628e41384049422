"""Moves in machine coordinates, and work zeros that are kept -> zeros in machine places, and what brings them back."""

from __future__ import annotations

from dataclasses import replace

from gproof.ir.finding import Span
from gproof.ir.job import AxisPlace, MoveTo, Node, Quantity, SetFrame, UseLength
from gproof.ir.machine import AXIS_NAMES
from gproof.ir.program import Expr, Number
from gproof.passes.legalize.context import Context
from gproof.passes.legalize.pattern import Pattern
from gproof.passes.legalize.transform import SAME

NEEDED = ("frame_zero_keep", "frame_zero_at", "frame_zero_recall")


def zero_in_between(node: Node, feature: str, context: Context) -> list[Node] | None:
    """The zero is put at machine zero for the move, and brought back: by its work offset where that is known, else by
    what the target keeps."""
    if not isinstance(node, MoveTo) or node.frame != "machine" or any(place.relative for place in node.to):
        return None
    if any(one not in context.target.legal for one in NEEDED) or not node.to:
        return None
    # A frame that is turned or scaled is none of the machine.
    own = {"frame_rotate", "frame_scale", "frame_mirror"} & context.target.legal.keys()
    if context.transform != SAME or any(
        isinstance(one, SetFrame) and f"frame_{one.action}" in own for one in context.nodes()
    ):
        context.why = "it has no such moves, and places of its frame are turned or scaled"
        return None
    span = node.span
    named = sorted(node.to, key=lambda place: AXIS_NAMES.index(place.axis))
    zeros = tuple(
        AxisPlace(place.axis, Quantity(Number(0.0, span), "mm" if place.axis in "xyz" else "deg")) for place in named
    )
    at_machine_zero = SetFrame(action="zero_at", places=zeros, span=span)
    context.as_is.append((at_machine_zero, False))  # without the tool's length, too
    there: list[Node] = [at_machine_zero, replace(node, frame="work")]
    measured = "length" in context.target.legal and any(place.axis == "z" for place in named)
    if measured and any(isinstance(one, UseLength) and one.on for one in context.nodes()):
        context.why = "it has no such moves, and a tool length would be in Z"
        return None
    known = _offset(context) if "frame_select" in context.target.legal else 0
    if known:
        back = SetFrame(action="select", number=Number(float(known), span), span=span)
        context.come_back(back, {place.axis for place in node.to})
        return [*there, back]
    before = _places(context, [place.axis for place in named], span)
    if before:
        back = SetFrame(action="zero_at", places=before, span=span)
        context.come_back(back, {place.axis for place in node.to})
        return [*there, back]
    if context.keeping:
        context.why = "it has no such moves, and the work zero, which has to be put back after it, is not known"
        return None
    keep = SetFrame(action="zero_keep", span=span)
    recall = SetFrame(action="zero_recall", span=span)
    context.as_is += [(keep, False), (recall, False)]
    return [keep, *there, recall]


def _offset(context: Context) -> int:
    """The work offset that is the whole work zero, 0 where it is not known."""
    number = context.zero.offset
    return number if number and context.local == {} and number not in context.offsets else 0


def _places(context: Context, axes: list[str], span: Span) -> tuple[AxisPlace, ...]:
    """Where the work zero of axes is, from machine zero; nothing where it is not known of one of them."""
    found = []
    for axis in axes:
        known = context.zero.place(axis)
        if known is None or known[0] or context.local is None or context.local.get(axis):
            return ()
        found.append(AxisPlace(axis, Quantity(Number(known[1], span), "mm" if axis in "xyz" else "deg")))
    return tuple(found)


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
        context.local = {}  # as it was when the zero was kept
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
    Pattern(
        name="machine coordinates -> zero there and back", removes=("machine_feed", "machine_move"),
        apply=zero_in_between,
    ),
    Pattern(
        name="zero in one of several places -> its work offset", removes=("frame_zero_register",), apply=kept_as_known,
        unrolls=True,
    ),
)  # fmt: skip
