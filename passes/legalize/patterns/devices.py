"""Coolant, tools, outputs, messages, ends."""

from __future__ import annotations

from dataclasses import replace

from gproof.ir.finding import Span
from gproof.ir.job import ChangeTool, EndJob, Node, PauseJob, Remark, ShowText, SwitchCoolant, TurnSpindle
from gproof.ir.program import Number, Text
from gproof.passes.legalize.context import SELECTED, Context
from gproof.passes.legalize.pattern import Pattern


def coolant_by_map(node: Node, feature: str, context: Context) -> list[Node] | None:
    """A coolant that the target does not have, as the other one, where the map says so."""
    if not isinstance(node, SwitchCoolant):
        return None
    other = context.options.coolant.get(feature)
    if other is None and (node.mist or node.flood):
        instead = "mist" if feature == "flood" else "flood"
        if instead in context.target.legal:
            context.why = f'it has no {feature}; [coolant] {feature} = "{instead}" of the map makes it the other one'
        return None
    if feature == "mist":
        flood = node.flood if other != "flood" or node.mist is None else bool(node.mist or node.flood)
        return [replace(node, mist=None, flood=flood)] if flood is not None else []
    mist = node.mist if other != "mist" or node.flood is None else bool(node.flood or node.mist)
    return [replace(node, flood=None, mist=mist)] if mist is not None else []


def selected_with_the_change(node: Node, feature: str, context: Context) -> list[Node] | None:
    """A tool that is selected before the change: with a change by hand it only matters then."""
    if not isinstance(node, ChangeTool) or node.change or node.number is None:
        return None
    number = context.value(node.number)
    if number is None:
        return None
    context.values[SELECTED] = number
    return []


def change_with_number(node: Node, feature: str, context: Context) -> list[Node] | None:
    """A change that does not name its tool, after one that was selected."""
    if not isinstance(node, ChangeTool) or not node.change or node.number is not None:
        return None
    number = context.values.get(SELECTED)
    return None if number is None else [replace(node, number=Number(number, node.span), select=True)]


def change_as_stop(node: Node, feature: str, context: Context) -> list[Node] | None:
    """A tool change by hand on a target without any: a stop, where the map says so."""
    if not isinstance(node, ChangeTool) or not node.change or node.rests or "tool_change" in context.target.legal:
        return None
    if context.options.tool_change != "stop":
        context.why = 'it has none; with tool_change = "stop" in the map it becomes a stop for the operator'
        return None
    number = context.values.get(SELECTED) if node.number is None else context.value(node.number)
    if number is None:
        return None
    context.assume("at a stop for a tool change the operator puts in the tool that the comment names")
    tool = Number(number, node.span)
    return [Remark(text=f"put in tool {number:g}", span=node.span), PauseJob(span=node.span, tool=tool)]


def rest_before_change(node: Node, feature: str, context: Context) -> list[Node] | None:
    """A tool change that stops the spindle: the spindle off, then the change, or the stop in place of it."""
    legal = context.target.legal
    if not isinstance(node, ChangeTool) or not node.rests:
        return None
    if "tool_change_running" not in legal and ("tool_change" in legal or not context.options.tool_change):
        return None
    if "spindle" in context.uneven and context.spindle != "off":
        return None
    change = replace(node, rests=False)
    return [*_spindle_off(node.span, context), change]


def _spindle_off(span: Span, context: Context) -> list[Node]:
    """Nothing where the spindle rests, or the job has not started it."""
    if context.spindle == "off":
        return []
    if "spindle" not in context.switched:
        context.assume("the spindle rests when the job starts")
        return []
    return [TurnSpindle(direction="off", span=span)]


def change_at_rest(node: Node, feature: str, context: Context) -> list[Node] | None:
    """A change that leaves the spindle as it is, on a target where it stops: the same where it rests."""
    if not isinstance(node, ChangeTool) or node.rests or "tool_change_rests" not in context.target.legal:
        return None
    change = replace(node, rests=True)
    return [change] if context.spindle == "off" or "spindle" not in context.switched else None


def rest_before_end(node: Node, feature: str, context: Context) -> list[Node] | None:
    """An end that stops spindle and coolant: both off, as far as the job may have switched them, then the end."""
    if not isinstance(node, EndJob):
        return None
    found = _spindle_off(node.span, context)
    if context.coolant and "coolant" in context.switched:
        found.append(SwitchCoolant(mist=False, flood=False, span=node.span))
    return [*found, replace(node, rests=False)]


def message_as_comment(node: Node, feature: str, context: Context) -> list[Node] | None:
    """A text for the operator moves nothing: as a comment it is at its place."""
    if not isinstance(node, ShowText):
        return None
    text = " ".join(part.value if isinstance(part, Text) else "..." for part in node.parts)
    context.assume("messages to the operator are comments")
    return [Remark(text=text.strip(), span=node.span)]


def plain_end(node: Node, feature: str, context: Context) -> list[Node] | None:
    """The one end that the target has."""
    if not isinstance(node, EndJob):
        return None
    return [replace(node, reset=not node.reset)]


def end_that_leaves_on(node: Node, feature: str, context: Context) -> list[Node] | None:
    """An end after which spindle or coolant stay on, where the target's codes for the end switch them off."""
    if not isinstance(node, EndJob):
        return None
    if node.reset and "end_running" in context.target.legal:
        return [replace(node, reset=False)]
    last = next((one for one in reversed(context.job.body) if not isinstance(one, Remark)), None)
    is_last = isinstance(last, EndJob) and last.span == node.span
    return [] if is_last and context.target.ends_with_file else None


PATTERNS = (
    Pattern(name="coolant -> the other coolant", removes=("mist", "flood"), apply=coolant_by_map, unrolls=True),
    Pattern(name="tool selected early -> at the change", removes=("tool_select",), apply=selected_with_the_change),
    Pattern(
        name="change -> change with a number", removes=("tool_change_selected", "tool_change"),
        apply=change_with_number, unrolls=True,
    ),
    Pattern(name="tool change -> stop", removes=("tool_change_running", "tool_change"), apply=change_as_stop),
    Pattern(
        name="message -> comment", removes=("message", "variable", "expression", "system_variable"),
        apply=message_as_comment,
    ),
    Pattern(
        name="change that stops the spindle -> spindle off, change", removes=("tool_change_rests",),
        apply=rest_before_change, unrolls=True,
    ),
    Pattern(
        name="change that leaves the spindle as it is -> change, where it rests", removes=("tool_change_running",),
        apply=change_at_rest, unrolls=True,
    ),
    Pattern(
        name="end that stops spindle and coolant -> both off, end", removes=("end_rests",), apply=rest_before_end,
        unrolls=True,
    ),
    Pattern(
        name="end that leaves spindle or coolant on -> end of the file", removes=("end_reset_running", "end_running"),
        apply=end_that_leaves_on,
    ),
    Pattern(name="end -> the end that there is", removes=("end", "end_reset"), apply=plain_end, unrolls=True),
)  # fmt: skip
