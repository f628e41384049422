"""What the machines and languages of two programs say of each other: which zero is which, whether machine coordinates
are the same places."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from gproof.driver.dialects import DIALECTS
from gproof.driver.errors import UsageError
from gproof.driver.session import Session
from gproof.driver.targets import TARGETS
from gproof.ir.dialects import rules_named
from gproof.ir.job import Job, UseLength, walk
from gproof.ir.machine import AXIS_NAMES, AxisKind, Machine, Tool
from gproof.ir.program import Number
from gproof.ir.target import Target
from gproof.ir.translation_map import TranslationMap
from gproof.ir.translation_terms import SymbolMeaning


def measured(name: str, other: str, machine: Machine, numbers: Mapping[int, int]) -> tuple[SymbolMeaning, ...]:
    """Measures of tools where one controller has them instead of lengths, of tools whose length the other's file says.

    numbers: of tools of the other controller, as this one has them.
    """
    if not _measures(name) or _measures(other):
        return ()
    lengths = {numbers.get(tool.number, tool.number): tool.length for tool in machine.tools if tool.length is not None}
    return tuple(SymbolMeaning(symbol=f"tool.{number}.z", mm=length) for number, length in sorted(lengths.items()))


def _measures(name: str) -> bool:
    """Whether tools have measures in place of lengths, of a controller whose programs gproof reads."""
    return name in DIALECTS and rules_named(name).measured_tools


def straight_rapids(machine: Machine, manual: bool | None) -> bool | None:
    """Whether rapids of several axes are straight: as the machine file says, else as the manual does."""
    stated = machine.controller.straight_traverse
    return manual if stated is None else stated


def rapids_asked(session: Session, target: Target, machine: Machine, asked: bool) -> str:
    """On which side rapids of several axes, which are to be straight, are not: ``source``, ``target``, or neither."""
    if not asked:
        return ""
    if straight_rapids(session.machine, rules_named(session.dialect).straight_traverse) is not True:
        return "source"
    return "" if straight_rapids(machine, target.straight_rapids) is True else "target"


def rapid_rates(machine: Machine) -> dict[str, float]:
    """mm/min by axis that linear axes can go at, where the machine file says so."""
    return {
        axis.name: axis.max_velocity * 60.0 for axis in machine.axes
        if axis.kind is AxisKind.LINEAR and axis.max_velocity is not None
    }  # fmt: skip


def own_guards(dialect: str) -> frozenset[str]:
    """Names of the guards that programs of a controller switch."""
    return TARGETS[dialect].target().guards if dialect in TARGETS else frozenset()


def lengths_of(session: Session, machine: Machine, given: TranslationMap) -> dict[int, float]:
    """mm of tools of the target: of the map, of its machine file, of the files of the source, in this order."""
    stated = {number: one.low for number, one in session.setup.tool_lengths.items() if one.low == one.high}
    found = {tool.number: tool.length for tool in session.machine.tools if tool.length is not None} | stated
    found = {given.tools.get(number, number): length for number, length in found.items()}
    found |= {tool.number: tool.length for tool in machine.tools if tool.length is not None}
    return found | given.lengths


def with_lengths(machine: Machine, given: TranslationMap, place: object) -> Machine:
    """A machine with the tool lengths that the map says and its file does not; UsageError where they contradict."""
    tools = {tool.number: tool for tool in machine.tools}
    for number, length in given.lengths.items():
        tool = tools.get(number, Tool(number=number))
        if tool.length is not None and tool.length != length:
            known = f"the machine file says that tool {number} is {tool.length:g} mm long"
            raise UsageError(f"map file {place}: [lengths] {number} = {length:g}: {known}")
        tools[number] = replace(tool, length=length)
    return replace(machine, tools=tuple(tools.values())) if given.lengths else machine


def printed_lengths(job: Job, machine: Machine, target: Target) -> dict[int, float]:
    """mm of the tools whose lengths the job uses, for a target whose programs give them as numbers."""
    if not target.length_numbers:
        return {}
    bodies = (job.body, *(routine.body for routine in job.routines.values()))
    used = {
        round(node.tool.value) for body in bodies for node in walk(body)
        if isinstance(node, UseLength) and node.on and isinstance(node.tool, Number)
    }  # fmt: skip
    return {tool.number: tool.length for tool in machine.tools if tool.number in used and tool.length is not None}


def lengths_in_numbers(
    lengths: Mapping[int, float], numbers: Mapping[int, int], target: Target
) -> tuple[SymbolMeaning, ...]:  # fmt: skip
    """Tool lengths of the source that are in the work zero of a controller without any: as printed, none at the start
    and then what the files say. numbers: of tools of the target, as the source has them."""
    if not lengths:
        return ()
    known = {numbers.get(number, number): length for number, length in lengths.items()}
    if not target.length_numbers:
        known[0] = 0.0
    return tuple(SymbolMeaning(symbol=f"tool.{n}.z", mm=mm) for n, mm in sorted(known.items()))


def only_local(name: str, other: str, only: Mapping[str, int] | None = None) -> tuple[SymbolMeaning, ...]:
    """The zero of a controller whose only one is a local offset, set up where another one has a work offset.
    name: of that controller; other: of the one that its programs are compared with; only: by axis the number of the
    work offset, of others the first."""
    if not _has_only_local(name) or _has_only_local(other):
        return ()
    return tuple(
        SymbolMeaning(symbol=f"g92.{axis}", form=((f"work.{(only or {}).get(axis, 1)}.{axis}", 1),))
        for axis in AXIS_NAMES
    )


def _has_only_local(name: str) -> bool:
    return name in DIALECTS and "work" not in DIALECTS[name].frontend.open_offsets


def same_travel(one: Machine, other: Machine) -> bool:
    """Whether machine coordinates of two machines can count from the same place: their limits are the same."""
    return all(_limits(one, name) == _limits(other, name) for name in AXIS_NAMES)


def _limits(machine: Machine, name: str) -> tuple[float | None, float | None]:
    axis = machine.axis(name)
    return (None, None) if axis is None else (axis.lower, axis.upper)
