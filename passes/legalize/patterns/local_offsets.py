"""Where work coordinates count from -> what the target has for it."""

from __future__ import annotations

from dataclasses import replace

from gproof.ir.job import (
    MM,
    ArcTo,
    AxisPlace,
    DrillHole,
    Moves,
    MoveTo,
    Node,
    Nodes,
    Quantity,
    RunRoutine,
    SetFrame,
    bodies,
)
from gproof.ir.machine import AXIS_NAMES
from gproof.ir.program import Number
from gproof.passes.legalize.context import Context
from gproof.passes.legalize.pattern import Pattern


def only_offset(node: Node, feature: str, context: Context) -> list[Node] | None:
    """The one work offset that a job selects: it is the only zero of the target, all the time."""
    if not isinstance(node, SetFrame) or node.action != "select" or node.number is None:
        return None
    number = context.value(node.number)
    if number is None or context.local != {} or (node.axes and not set(context.axes) <= set(node.axes)):
        return None
    for one in context.nodes():
        if isinstance(one, SetFrame) and one.action in {"select", "store", "store_here"}:
            same = one.number is not None and isinstance(one.number, Number) and one.number.value == number
            if one.action != "select" or not same or one.axes != node.axes:
                return None
    if number != 1.0 and _moves_before_select(context.job.body):
        return None
    context.only = dict.fromkeys(node.axes or AXIS_NAMES, round(number))
    if context.selected != number:
        context.place = {}
    context.selected = round(number)
    return _again(node, context)


def _moves_before_select(body: Nodes) -> bool:
    """Whether a job may move in the work offset of its start before it selects one."""
    for node in body:
        if isinstance(node, SetFrame) and node.action == "select":
            return False
        if isinstance(node, Moves | ArcTo | DrillHole | RunRoutine) or bodies(node):
            return True
        if isinstance(node, MoveTo) and node.frame == "work":
            return True
    return False


def local_as_shift(node: Node, feature: str, context: Context) -> list[Node] | None:
    """A local offset as a shift of the work zero, where it is known by how much."""
    if not isinstance(node, SetFrame) or "frame_zero_shift" not in context.target.legal:
        return None
    if context.local is None:
        return None
    wanted: dict[str, float] | None
    if node.action == "local_here":
        wanted = context.local_after(node)
        if wanted is None:
            return _at_machine(node, context)
    elif node.action in {"local_off", "local_suspend"}:
        wanted = {}
    elif node.action == "local_restore":
        if context.suspended is None:
            return None
        wanted = dict(context.suspended)
    else:
        return None
    return _shift(node, wanted, context)


def _at_machine(node: SetFrame, context: Context) -> list[Node] | None:
    """The name of a place that is known from machine zero, as the zero of its axes, where nothing takes it off."""
    back = {"select", "local_off", "local_suspend", "local_restore"}
    if context.length is None or any(isinstance(one, SetFrame) and one.action in back for one in context.nodes()):
        return None
    places: dict[str, float] = {}
    for place in node.places:
        at, named = context.machine_place(place.axis), context.mm(place.at)
        if at is None or named is None or place.relative:
            return None
        # With a length in force the zero is so much lower; it is added to every zero that is set.
        places[place.axis] = at - named - (context.length if place.axis == "z" else 0.0)
    return [SetFrame(action="zero_at", places=_at(places, node, context), span=node.span)]


def _unit(axis: str, context: Context) -> str:
    """That of the source, where the target has it."""
    if axis not in "xyz":
        return "deg"
    return context.unit if f"unit_{context.unit}" in context.target.legal else "mm"


def _shift(node: SetFrame, wanted: dict[str, float], context: Context) -> list[Node]:
    assert context.local is not None
    places = []
    for axis in AXIS_NAMES:
        by = wanted.get(axis, 0.0) - context.local.get(axis, 0.0)
        if by != 0.0:
            unit = _unit(axis, context)
            places.append(AxisPlace(axis, Quantity(Number(by / MM.get(unit, 1.0), node.span), unit)))
    context.suspended = dict(context.local) if node.action == "local_suspend" else None
    context.local = wanted
    context.assume("no local offset is in force at the start")
    return [SetFrame(action="zero_shift", places=tuple(places), span=node.span)] if places else []


def select_with_local(node: Node, feature: str, context: Context) -> list[Node] | None:
    """A work offset and the local one on it, as the work offset and the shift; and one that the job has stored, as the
    work offset and the zero of its axes."""
    if not isinstance(node, SetFrame):
        return None
    number = None if node.number is None else context.value(node.number)
    if number in context.doubtful:
        return None
    stored = {} if number is None else context.offsets.get(round(number), {})
    if stored and context.local == {}:
        context.settled = again = replace(node)
        return [again, SetFrame(action="zero_at", places=_at(stored, node, context), span=node.span)]
    if stored or not context.local:
        return None
    wanted = dict(context.local)
    context.settled = select = replace(node)
    context.local = {}
    return [select, *_shift(node, wanted, context)]


def stored_as_zero(node: Node, feature: str, context: Context) -> list[Node] | None:
    """Work offsets that the job itself stores, as places of the one zero that the target has."""
    if not isinstance(node, SetFrame) or "frame_zero_at" not in context.target.legal or node.number is None:
        return None
    number = context.value(node.number)
    if number is None or context.local or context.local is None:
        return None
    if number in context.doubtful:
        if node.action != "store" or not {place.axis for place in node.places} >= set(context.axes):
            return None
        context.doubtful.discard(round(number))
    if node.action == "store":
        places = {place.axis: context.mm(place.at) for place in node.places}
        if any(value is None for value in places.values()):
            return None
        known = context.offsets.setdefault(round(number), {})
        known |= {axis: value for axis, value in places.items() if value is not None}
        if number == context.selected:
            return _placed(SetFrame(action="zero_at", places=node.places, span=node.span), context)
        context.assume("work offsets that the job stores are for this job alone")
        return []
    if node.action == "store_here" and number == context.selected:
        context.offsets.pop(round(number), None)
        return [SetFrame(action="local_here", places=node.places, span=node.span)]
    if node.action == "store_here":
        return _stored_here(node, round(number), context)
    if node.action != "select" or node.axes:
        return None
    if number == context.selected:
        return _again(node, context)
    at = context.offsets.get(round(number), {})
    if any(axis not in at for axis in context.axes):
        return None
    context.selected = round(number)
    return _placed(SetFrame(action="zero_at", places=_at(at, node, context), span=node.span), context)


def _stored_here(node: SetFrame, number: int, context: Context) -> list[Node] | None:
    """The place where the axes are gets these names in another work offset than the one in force, which the job has
    stored: it is known from machine zero."""
    if any(isinstance(one, SetFrame) and one.action.startswith(("local", "zero")) for one in context.nodes()):
        return None
    zero = context.offsets.get(context.selected, {})
    found = {}
    for place in node.places:
        named, here = context.mm(place.at), context.place.get(place.axis)
        if named is None or here is None or place.axis not in zero or place.relative:
            return None
        found[place.axis] = zero[place.axis] + here - named
    context.offsets.setdefault(number, {}).update(found)
    context.assume("work offsets that the job stores are for this job alone")
    return []


def _at(places: dict[str, float], node: SetFrame, context: Context) -> tuple[AxisPlace, ...]:
    """Places in mm and degrees, in the unit of the job."""
    units = {axis: _unit(axis, context) for axis in places}
    return tuple(
        AxisPlace(axis, Quantity(Number(places[axis] / MM.get(units[axis], 1.0), node.span), units[axis]))
        for axis in AXIS_NAMES
        if axis in places
    )


def _placed(node: SetFrame, context: Context) -> list[Node]:
    """A zero that is the work offset in force from now on."""
    context.placed = node
    return [node]


NOTHING = 1e-9
"""mm or degrees that a shift and what takes it back differ by rounding."""
AT_THE_END = -1.0
"""The number under which the zero of the start is brought back: only the end of the job can do it."""


def _again(node: SetFrame, context: Context) -> list[Node] | None:
    """The work offset that is in force, without what the job has shifted it by."""
    if context.selected not in context.offsets:
        which = "the first work offset" if context.selected == 1 else f"work offset {context.selected} of the source"
        context.assume(f"the zero of {context.target.title} is set where {which} is")
    if context.shift == {}:
        return []
    if context.shift is None:
        if context.selected in context.offsets or "frame_zero_recall" not in context.target.legal:
            return None
        return [SetFrame(action="zero_recall", number=Number(AT_THE_END, node.span), span=node.span)]
    places = tuple(
        AxisPlace(axis, Quantity(Number(-by / MM.get(_unit(axis, context), 1.0), node.span), _unit(axis, context)))
        for axis, by in context.shift.items()
        if abs(by) > NOTHING
    )
    if not places:
        return []
    return _placed(SetFrame(action="zero_shift", places=places, span=node.span), context)


PATTERNS = (
    Pattern(
        name="work offset with a local offset -> with a shift", removes=("frame_select_local",),
        apply=select_with_local, unrolls=True,
    ),
    Pattern(
        name="stored work offset -> zero at its place",
        removes=("frame_beyond", "frame_store_here", "frame_store", "frame_select"),
        apply=stored_as_zero,
    ),
    Pattern(name="work offset -> the only one", removes=("frame_select_axes", "frame_select"), apply=only_offset),
    Pattern(
        name="local offset -> shift of the zero",
        removes=("frame_local_here", "frame_local_off", "frame_local_suspend", "frame_local_restore"),
        apply=local_as_shift,
    ),
)  # fmt: skip
