"""Zeros in machine places -> the target's own way: a work offset that the job does not use otherwise.

What the spare work offset held before is lost, which is printed as an assumption. All axes of the job must have a
known zero then: one that keeps an unknown work offset has no number that could be stored.
"""

from __future__ import annotations

from dataclasses import replace

from gproof.ir.finding import Span
from gproof.ir.job import AxisPlace, Node, Quantity, SetFrame
from gproof.ir.machine import AXIS_NAMES
from gproof.ir.program import Binary, Expr, Number, Variable
from gproof.passes.legalize.context import Context
from gproof.passes.legalize.options import Zero
from gproof.passes.legalize.pattern import Pattern

_ACTIONS = {"frame_zero_at", "frame_zero_shift", "frame_zero_keep", "frame_zero_recall", "frame_select_axes"}


def zero(node: Node, feature: str, context: Context) -> list[Node] | None:
    """One operation on zeros in machine places, or on those of some axes."""
    if not isinstance(node, SetFrame) or not context.target.spare_offset:
        return None
    if node.action == "zero_keep":
        context.kept[_key(node, context)] = context.zero, context.local_off
        return []
    if node.action == "zero_recall":
        kept, was_off = context.kept.get(_key(node, context), (None, False))
        return None if kept is None or not was_off else put(kept, context, node.span)
    if node.action == "select":
        return _selected_for_some(node, context)
    moved = {place.axis: context.mm(place.at) for place in node.places}
    if any(value is None for value in moved.values()):
        return None
    by = {axis: value for axis, value in moved.items() if value is not None}
    if node.action == "zero_shift" and (not context.local_off or any(context.zero.place(a) is None for a in by)):
        return _shifted_here(node, by, context)
    local = {} if context.local_off else context.local
    if local is None:
        return None
    places = {
        axis: (place[0], place[1] + local.get(axis, 0.0))
        for axis in AXIS_NAMES if (place := context.zero.place(axis)) is not None
    }  # fmt: skip
    for axis, value in by.items():
        base, before = places.get(axis, (0, 0.0)) if node.action == "zero_shift" else (0, 0.0)
        places[axis] = base, before + value
    found = put(Zero(0, places), context, node.span)
    return _shifted_here(node, by, context) if found is None and node.action == "zero_shift" else found


def _selected_for_some(node: SetFrame, context: Context) -> list[Node] | None:
    """A work offset that only some axes count from: the others keep their zero, for the next job too."""
    number = None if node.number is None else context.value(node.number)
    local = {} if context.local_off else context.local
    places = {
        axis: (place[0], place[1] + local.get(axis, 0.0))
        for axis in AXIS_NAMES if local is not None and (place := context.zero.place(axis)) is not None
    }  # fmt: skip
    kept = {a for a in context.options.axes if a not in node.axes and places.get(a) != (number, 0.0)}
    if set(context.axes) <= set(node.axes) and not (kept and _readable("x", context)):
        return [replace(node, axes=())]
    if number is None or local is None:
        return None
    wanted = places | {axis: (round(number), 0.0) for axis in node.axes}
    bases = {wanted.get(axis) for axis in (*context.axes, *context.options.axes)}
    if len(bases) == 1:
        return [replace(node, axes=())]
    return put(Zero(0, wanted), context, node.span)


def _shifted_here(node: SetFrame, by: dict[str, float], context: Context) -> list[Node] | None:
    """A zero that is moved, by the name that the present place gets: it is so much less."""
    if "frame_local_here" not in context.target.legal or any(axis not in context.place for axis in by):
        return None
    places = tuple(
        AxisPlace(axis, Quantity(Number(context.place[axis] - value, node.span), "mm" if axis in "xyz" else "deg"))
        for axis, value in by.items()
    )
    context.borrowed = True
    return [SetFrame(action="local_here", places=places, span=node.span)]


def without_shift(node: Node, feature: str, context: Context) -> list[Node] | None:
    """A work offset ends shifts of the zero: those that are a local offset on the target are taken off first. A job
    with local offsets of its own keeps these: what is whose is not known."""
    if not isinstance(node, SetFrame) or not context.borrowed:
        return None
    if any(isinstance(one, SetFrame) and one.action.startswith("local") for one in context.nodes()):
        return None
    context.borrowed = False
    return [SetFrame(action="local_off", span=node.span), node]


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
    known = {axis: place for axis in AXIS_NAMES if (place := wanted.place(axis)) is not None}
    # An axis that the job does not move keeps its zero for the next job, where the target can read it.
    stored = {
        axis: place for axis, place in known.items()
        if axis in context.axes or place[0] == 0 or (axis in context.options.axes and _readable(axis, context))
    }  # fmt: skip
    if any(axis not in known for axis in context.axes) or not all(
        place[0] == 0 or _readable(axis, context) for axis, place in stored.items()
    ):
        return None
    spare = context.target.spare_offset
    context.assume(f"work offset {spare} of {context.target.title} is free: zeros in machine places are stored there")
    context.spare_used = True
    context.spare_places = stored
    number = Number(float(spare), span)
    places = tuple(
        AxisPlace(axis, Quantity(_value(axis, place, span), "mm" if axis in "xyz" else "deg"))
        for axis, place in stored.items()
    )
    store = SetFrame(action="store", number=number, places=places, span=span)
    return [*off, store, SetFrame(action="select", number=number, span=span)]


FIRST, STEP = 5221, 20
"""Numbers of the variables that hold work offsets (RS274): X of the first, and from one to the next."""


def _readable(axis: str, context: Context) -> bool:
    return "system_variable" in context.target.legal and "expression" in context.target.legal


def _value(axis: str, place: tuple[int, float], span: Span) -> Expr:
    """What is stored for an axis: a number, or one and the work offset that it counts from."""
    base, mm = place
    if not base:
        return Number(mm, span)
    held = Variable(Number(float(FIRST + STEP * (base - 1) + AXIS_NAMES.index(axis)), span), span)
    return Binary("+", held, Number(mm, span), span) if mm else held


PATTERNS = (
    Pattern(
        name="zero at a machine place -> spare work offset", removes=tuple(sorted(_ACTIONS)), apply=zero, unrolls=True
    ),
    Pattern(
        name="work offset after a shift -> shift off, work offset", removes=("frame_select_local",),
        apply=without_shift, unrolls=True,
    ),
)  # fmt: skip
