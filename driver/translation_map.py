"""A map for a translation, proposed from the job: ``gproof translate --map init``."""

from __future__ import annotations

from gproof.driver.targets import TARGETS
from gproof.ir.job import ChangeTool, Job, Node, SwitchCoolant, SwitchOutput, WaitFor, walk
from gproof.ir.job_features import expressions, parts_of_expression
from gproof.ir.program import Input, Number
from gproof.ir.target import Target
from gproof.ir.translation_map import TranslationMap


def proposed(job: Job, target: Target) -> TranslationMap:
    """The numbers that the job uses, each as itself, and a coolant that the target has."""
    outputs: set[int] = set()
    inputs: set[int] = set()
    tools: set[int] = set()
    coolant: dict[str, str] = {}
    for node in _all(job):
        if isinstance(node, SwitchOutput) and isinstance(node.channel, Number):
            outputs.add(round(node.channel.value))
        elif isinstance(node, WaitFor) and isinstance(node.channel, Number):
            inputs.add(round(node.channel.value))
        elif isinstance(node, ChangeTool) and isinstance(node.number, Number):
            tools.add(round(node.number.value))
        elif isinstance(node, SwitchCoolant):
            for word, other, wanted in (("mist", "flood", node.mist), ("flood", "mist", node.flood)):
                if wanted and word not in target.legal and other in target.legal:
                    coolant[word] = other
        for expr in expressions(node):
            for part in parts_of_expression(expr):
                if isinstance(part, Input) and part.kind in {"input", "output"} and isinstance(part.number, Number):
                    (inputs if part.kind == "input" else outputs).add(round(part.number.value))
    by_axis = job.source in TARGETS and TARGETS[job.source].target().axis_channels
    return TranslationMap(
        outputs=_channels(outputs, target, by_axis), inputs=_channels(inputs, target, by_axis),
        tools={n: n for n in sorted(tools)}, coolant=coolant,
        tool_change="stop" if tools and "tool_change" not in target.legal else "", given=True,
    )  # fmt: skip


AXIS_CHANNEL = 100
"""Channels that belong to axes are the number of the axis and two digits: 104 is the fourth of the first axis."""


def _channels(numbers: set[int], target: Target, by_axis: bool) -> dict[int, int]:
    """Each channel as itself; to axes as one of the first axis, from axes as its number there, if no two are the same,
    else one after the other where the target has no such numbers.

    by_axis: those of the source belong to axes.
    """
    if by_axis and not target.axis_channels and len({n % AXIS_CHANNEL for n in numbers}) == len(numbers):
        return {n: n % AXIS_CHANNEL for n in sorted(numbers)}
    if by_axis and target.channels[0] and max(numbers, default=0) > target.channels[1]:
        return {n: place for place, n in enumerate(sorted(numbers), 1)}
    first = AXIS_CHANNEL if target.axis_channels and not by_axis else 0
    return {n: n if n > first else first + n for n in sorted(numbers)}


def _how(found: TranslationMap) -> str:
    """What is proposed for the numbers."""
    channels = {**found.outputs, **found.inputs}
    if all(old == new for old, new in channels.items()):
        return "Each is proposed as itself"
    if any(new > old for old, new in channels.items()):
        return "Outputs and inputs are proposed as those of the first axis"
    return "Outputs and inputs are proposed as numbers without their axes"


def _all(job: Job) -> list[Node]:
    return [node for body in (job.body, *(r.body for r in job.routines.values())) for node in walk(body)]


def toml_of(found: TranslationMap, source: str, target: str) -> str:
    """A map as a file, to be completed by hand."""
    lines = [
        'schema = "gproof-translation/1"',
        "",
        f"# {source} -> {target}: the number of the source = the number of the target.",
        f"# {_how(found)}: compare with the wiring of both machines.",
    ]
    for name in ("outputs", "inputs", "tools"):
        table: dict[int, int] = getattr(found, name)
        if table:
            lines += ["", f"[{name}]", *(f"{old} = {new}" for old, new in table.items())]
    if found.coolant:
        lines += ["", "[coolant]", *(f'{old} = "{new}"' for old, new in found.coolant.items())]
    if found.tool_change:
        lines.insert(1, f'tool_change = "{found.tool_change}"')
    return "\n".join(lines) + "\n"
