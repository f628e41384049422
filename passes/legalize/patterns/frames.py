"""Zeros in machine places -> the target's own way: a work offset that the job does not use otherwise.

What the spare work offset held before is lost, which is printed as an assumption. All axes of the job must have a
known zero then: one that keeps an unknown work offset has no number that could be stored.
"""

from __future__ import annotations

from dataclasses import replace

from gproof.ir.finding import Span
from gproof.ir.job import AxisPlace, Node, Quantity, SetFrame
from gproof.ir.machine import AXIS_NAMES
from gproof.ir.program import Number
from gproof.passes.legalize.context import Context, Zero
from gproof.passes.legalize.pattern import Pattern

_ACTIONS = {"frame_zero_at", "frame_zero_shift", "frame_zero_keep", "frame_zero_recall", "frame_select_axes"}


def zero(node: Node, feature: str, context: Context) -> list[Node] | None:
    """One operation on zeros in machine places, or on those of some axes."""
    if not isinstance(node, SetFrame) or not context.target.spare_offset:
        return None
    if node.action == "zero_keep":
        context.kept[_key(node, context)] = context.zero
        return []
    if node.action == "zero_recall":
        kept = context.kept.get(_key(node, context))
        return None if kept is None else put(kept, context, node.span)
    if node.action == "select":
        return [replace(node, axes=())] if set(context.axes) <= set(node.axes) else None
    places = dict(context.zero.places)
    for place in node.places:
        value = context.mm(place.at)
        if value is None:
            return None
        if node.action == "zero_shift":
            before = places.get(place.axis)
            if before is None:
                return None
            value += before
        places[place.axis] = value
    return put(Zero(0, places), context, node.span)


def _key(node: SetFrame, context: Context) -> float:
    if node.number is None:
        return -1.0
    value = context.value(node.number)
    return -2.0 if value is None else value


def put(wanted: Zero, context: Context, span: Span) -> list[Node] | None:
    """What brings a zero into force; None where one of the job's axes has none that is known."""
    off: list[Node] = [] if context.local_off else [SetFrame(action="local_off", span=span)]
    if wanted.offset:
        number = Number(float(wanted.offset), span)
        return [*off, SetFrame(action="select", number=number, span=span)]
    if any(axis not in wanted.places for axis in context.axes):
        return None
    spare = context.target.spare_offset
    context.assume(
        f"work offset {spare} of {context.target.title} is free: zeros in machine places are stored there"
    )  # fmt: skip
    context.spare_used = True
    number = Number(float(spare), span)
    places = tuple(
        AxisPlace(axis, Quantity(Number(wanted.places[axis], span), "mm" if axis in "xyz" else "deg"))
        for axis in AXIS_NAMES if axis in wanted.places and (axis in context.axes or axis in context.target.axes)
    )  # fmt: skip
    store = SetFrame(action="store", number=number, places=places, span=span)
    return [*off, store, SetFrame(action="select", number=number, span=span)]


PATTERNS = (
    Pattern(
        name="zero at a machine place -> spare work offset", removes=tuple(sorted(_ACTIONS)), apply=zero, unrolls=True
    ),
)  # fmt: skip
