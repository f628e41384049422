"""Rotation, scaling and mirroring -> numbers: the operations after them have the places that come of it."""

from __future__ import annotations

from gproof.ir.job import Node, SetFrame
from gproof.passes.legalize.context import Context
from gproof.passes.legalize.pattern import Pattern
from gproof.passes.legalize.transform import SAME, Transform, before, factors, rotation


def into_numbers(node: Node, feature: str, context: Context) -> list[Node] | None:
    """A transform whose numbers are known is remembered; one of each kind, and a rotation only alone."""
    if not isinstance(node, SetFrame):
        return None
    kind, _, off = node.action.partition("_")
    found = SAME
    if not off:
        about = {place.axis: context.mm(place.at) for place in node.places}
        made = _made(node, about, context)
        if made is None:
            return None
        found = made
    context.turns[kind] = found
    active = [name for name, one in context.turns.items() if one != SAME]
    if len(active) > 1 and "rotate" in active:
        return None
    context.program_place = before(context.transform, context.place)
    return []


def _made(node: SetFrame, about: dict[str, float | None], context: Context) -> Transform | None:
    known = {axis: value for axis, value in about.items() if value is not None}
    if len(known) < len(about):
        return None
    if node.action == "mirror":
        return factors(dict.fromkeys(known, -1.0), known)
    if node.action == "scale":
        by = {one.axis: context.mm(one.at) for one in node.factors}
        numbers = {axis: value for axis, value in by.items() if value is not None}
        return factors(numbers, known) if len(numbers) == len(by) and all(numbers.values()) else None
    angle = None if node.angle is None else context.mm(node.angle)
    return None if angle is None else rotation(angle, known.get("x", 0.0), known.get("y", 0.0))


PATTERNS = (
    Pattern(
        name="rotation, scaling, mirroring -> numbers", apply=into_numbers,
        removes=("frame_rotate", "frame_scale_axis", "frame_scale", "frame_mirror"),
    ),
)  # fmt: skip
