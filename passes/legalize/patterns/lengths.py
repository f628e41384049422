"""Tool lengths -> the work zero moved by them, for a controller without tool lengths.

What a tool is long, the map or a machine file says (``Options.lengths``). Every zero that the job sets anew is moved
by the length in force; a length that the job leaves in force for the next one stays in the zero.
"""

from __future__ import annotations

from dataclasses import replace

from gproof.ir.finding import Span
from gproof.ir.job import AxisPlace, ChangeTool, Node, Nodes, Quantity, SetFrame, UseLength
from gproof.ir.program import Number
from gproof.passes.legalize.context import IN_SPINDLE, Context
from gproof.passes.legalize.pattern import Pattern


def as_shift(node: Node, feature: str, context: Context) -> list[Node] | None:
    """A tool length on or off: the zero moves by the difference."""
    if not isinstance(node, UseLength) or "frame_zero_shift" not in context.target.legal:
        return None
    if not node.on:
        context.measuring = False
        return _off(node.span, context)
    number = context.values.get(IN_SPINDLE) if node.tool is None else context.value(node.tool)
    if number is None:
        context.why = "which tool is in the spindle is not known, and its length would be in the work zero"
        return None
    if round(number) not in context.options.lengths:
        context.why = f"it has no tool lengths, and no file says what tool {number:g} is long: [lengths] of the map"
        return None
    wanted = context.options.lengths[round(number)]
    context.lengths_used[round(number)] = wanted
    context.measuring = node.tool is None and context.options.measured_tools
    title = context.target.title
    context.assume(f"tool {number:g} is {wanted:g} mm long: {title} has no tool lengths, the work zero is moved by it")
    return _shifted(wanted, node.span, context)


def _off(span: Span, context: Context) -> list[Node] | None:
    """The zero without the length that is in it."""
    context.assume("no tool length offset is on when the job starts")
    return _shifted(0.0, span, context)


def _shifted(wanted: float, span: Span, context: Context) -> list[Node] | None:
    if context.length is None:
        context.why = "which tool length is in force before it is not known"
        return None
    by, context.length = wanted - context.length, wanted
    return [_shift(by, span, context, moves=True)] if by else []


def _shift(by: float, span: Span, context: Context, *, moves: bool) -> SetFrame:
    found = SetFrame(action="zero_shift", places=(AxisPlace("z", Quantity(Number(by, span), "mm")),), span=span)
    context.as_is.append((found, moves))
    return found


def zero_with_length(node: Node, feature: str, context: Context) -> list[Node] | None:
    """A zero that is set while a length is in force has it too; a tool's own length counts from its change on, where
    the source has it so."""
    if context.length is None or not context.length_known:
        context.why = "which tool length is in force is not known"
        return None
    # Not the operation itself: a subprogram that is opened twice has it twice.
    if isinstance(node, ChangeTool):
        changed = replace(node)
        context.as_is.append((changed, False))
        return [changed, UseLength(on=True, span=node.span)]
    assert isinstance(node, SetFrame)
    node = context.copied(node)
    context.as_is.append((node, False))
    by = context.length
    if node.action == "zero_recall":
        if context.kept_length is None:
            context.why = "which tool length was in force when the zero was kept is not known"
            return None
        by -= context.kept_length
    return [node, _shift(by, node.span, context, moves=node.action == "zero_recall")] if by else [node]


def merged(body: Nodes, context: Context) -> Nodes:
    """A list of operations with zeros that are set, and moved by a length at once, as one."""
    found: list[Node] = []
    for node in body:
        if isinstance(node, SetFrame) and context.is_as_is(node) and node.action == "zero_shift":
            before = found[-1] if found else None
            (by,) = (context.mm(place.at) or 0.0 for place in node.places)
            if isinstance(before, SetFrame) and before.action in {"zero_at", "zero_shift"} and _z(before, context):
                found[-1] = _added(before, by)
                if before.action == "zero_shift" and len(before.places) == 1 and not _z(found[-1], context)[0]:
                    found.pop()
                continue
        found.append(node)
    return tuple(found)


def _z(node: Node, context: Context) -> tuple[float, ...]:
    """mm of Z that an operation names as a literal."""
    assert isinstance(node, SetFrame)
    return tuple(
        context.mm(place.at) or 0.0 for place in node.places if place.axis == "z" and place.at.number is not None
    )


def _added(node: SetFrame, by: float) -> SetFrame:
    places = []
    for place in node.places:
        if place.axis == "z" and place.at.number is not None:
            scale = {"inch": 25.4, "cm": 10.0}.get(place.at.unit, 1.0)
            sum_mm = place.at.number * scale + by
            sum_mm = 0.0 if abs(sum_mm) < SAME else sum_mm
            place = AxisPlace("z", Quantity(Number(sum_mm, node.span), "mm"))
        places.append(place)
    return replace(node, places=tuple(places))


SAME = 1e-9
"""mm that two lengths differ by rounding."""


PATTERNS = (
    Pattern(name="tool length -> shift of the zero", removes=("length",), apply=as_shift),
    Pattern(
        name="zero while a tool length is in force -> moved by it", removes=("frame_length",), apply=zero_with_length,
        unrolls=True,
    ),
)  # fmt: skip
