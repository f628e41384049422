"""Outputs, inputs, tools and work offsets of the source as those of the target, by the map of the translation.

What needs an entry that the map lacks is refused by name; an entry that no operation needs is reported.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace

from gproof.ir.job import (
    ChangeTool,
    Choice,
    Compensate,
    CountLoop,
    Job,
    LoopWhile,
    Node,
    Nodes,
    NotRaised,
    OptionalPart,
    RepeatGrid,
    SetFrame,
    SwitchOutput,
    UseLength,
    WaitFor,
)
from gproof.ir.machine import Machine
from gproof.ir.program import Constant, Expr, Input, Number
from gproof.ir.record import field, record
from gproof.ir.target import Target
from gproof.ir.translation_map import TranslationMap
from gproof.passes.legalize.expressions import with_expressions


@record(slots=True, kw_only=True)
class Mapped:
    """job: with the target's numbers; unused: (table, number) of entries of the map that nothing in the job needs."""

    job: Job
    unused: list[tuple[str, int]] = field(default_factory=list)


def by_map(
    job: Job, given: TranslationMap, target: Target, machine: Machine, *, same: bool, own: Machine
) -> Mapped:  # fmt: skip
    """The job in the numbers of the target. same: both machines have one controller, so that numbers without an entry
    stay as they are; else outputs and inputs need one. own: the machine of the job."""
    mapper = _Mapper(given, target, machine, same)
    mapper.own_tools = frozenset(tool.number for tool in own.tools) if same else None
    routines = {
        name: replace(routine, body=mapper.body(routine.body)) for name, routine in job.routines.items()
    }  # fmt: skip
    mapped = Job(source=job.source, files=job.files, body=mapper.body(job.body), routines=routines)
    tables: dict[str, Iterable[int]] = {
        "outputs": given.outputs, "inputs": given.inputs, "tools": given.tools, "offsets": given.offsets,
        "lengths": given.lengths,
    }  # fmt: skip
    # What an operation with a channel that the target lacks would have needed besides is not known.
    unused = [] if mapper.has_refused else [
        (name, number) for name, table in tables.items() for number in table if (name, number) not in mapper.used
    ]  # fmt: skip
    return Mapped(job=mapped, unused=unused)


OFFSET_ACTIONS = frozenset(("select", "store", "store_here"))
"""Of frames whose number is that of a work offset."""


def _any_number(number: int) -> str:
    """Work offsets that the target does not have may have another form there."""
    return ""


class _Refused(Exception):
    """(construct, why)."""


class _Mapper:
    def __init__(self, given: TranslationMap, target: Target, machine: Machine, same: bool) -> None:
        self.given = given
        self.target = target
        self.machine = machine
        self.same = same
        self.own_tools: frozenset[int] | None = None
        self.used: set[tuple[str, int]] = set()
        self.has_refused = False

    def body(self, nodes: Nodes) -> Nodes:
        """A list of operations."""
        return tuple(self.node(node) for node in nodes)

    def node(self, node: Node) -> Node:
        """One operation, and what is within it."""
        try:
            node = with_expressions(node, self.value)
            if isinstance(node, Choice):
                return replace(node, then=self.body(node.then), otherwise=self.body(node.otherwise))
            if isinstance(node, OptionalPart | CountLoop | LoopWhile | RepeatGrid):
                return replace(node, body=self.body(node.body))
            return self._own(node)
        except _Refused as refused:
            construct, why = refused.args
            return NotRaised(construct=construct, why=why, span=node.span)

    def value(self, expr: Expr) -> Expr:
        """A part of an expression: inputs and outputs of the target, and names of constants as their values."""
        if isinstance(expr, Input) and expr.kind in {"input", "output"}:
            table = "inputs" if expr.kind == "input" else "outputs"
            return replace(expr, number=self.number(expr.number, table, expr.kind))
        return Number(expr.value, expr.span) if isinstance(expr, Constant) else expr

    def _own(self, node: Node) -> Node:
        if isinstance(node, SwitchOutput):
            return replace(node, channel=self.number(node.channel, "outputs", "output"))
        if isinstance(node, WaitFor):
            return replace(node, channel=self.number(node.channel, "inputs", "input"))
        if isinstance(node, ChangeTool) and node.number is not None:
            return replace(node, number=self.number(node.number, "tools", "tool", self.check_tool))
        if isinstance(node, UseLength | Compensate) and node.tool is not None:
            return replace(node, tool=self.number(node.tool, "tools", "tool", self.check_tool))
        if isinstance(node, SetFrame) and node.number is not None and node.action in OFFSET_ACTIONS:
            return replace(node, number=self.number(node.number, "offsets", "work offset", _any_number))
        return node

    def check_tool(self, number: int) -> str:
        """Why the target has no such tool, "" if it may have it."""
        if number > self.target.tools:
            return f"tools of {self.target.title} have numbers up to {self.target.tools}"
        known = [tool.number for tool in self.machine.tools]
        # A job for the same controller may use a tool that its own table lacks, too.
        is_listed = self.own_tools is None or number in self.own_tools
        if known and number and number not in known and is_listed:
            return f"the tool table of the target's machine has no tool {number}"
        return ""

    def check_channel(self, number: int) -> str:
        """Why the target has no such output or input, "" if it may have it."""
        section, most = self.target.channels
        return f"{self.target.title} has numbers from 0 to {most} ({section})" if section and number > most else ""

    def number(self, value: Expr, table: str, what: str, check: Callable[[int], str] | None = None) -> Expr:
        """The number of the target; _Refused."""
        entries: dict[int, int] = getattr(self.given, table)
        if not isinstance(value, Number):
            if entries:
                raise _Refused(f"{what} by a computed number", f"the map has [{table}], and which one it is, is open")
            return value
        number = round(value.value)
        if number in entries:
            self.used.add((table, number))
            found = entries[number]
        elif check is None and not self.same:
            raise _Refused(f"{what} {number}", f"the map has no entry for it: [{table}] {number} = ...")
        else:
            found = number
        why = self.check_channel(found) if check is None else check(found)
        if why:
            self.has_refused |= check is None
            raise _Refused(f"{what} {number}", why)
        if table == "tools":
            self.used.add(("lengths", found))
        return Number(float(found), value.span)
