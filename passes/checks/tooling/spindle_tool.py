"""The tool that is in the spindle: the entry of the machine's table with the diameter that the job has written since.

Takes a Machine and the ``State`` of rows. What a program (Eding ``#5501 = 16``, manual 3.4.12; WinCNC L500.2) or the
setup's variables state of a diameter comes with the state (``State.diameters``); everything that looks at how wide a
tool is asks here, so that zones, gouges, collisions and stock see one tool.
"""

from __future__ import annotations

from dataclasses import replace

from gproof.ir.machine import Machine, Tool
from gproof.ir.record import record
from gproof.ir.trace import State, ToolDiameter

_OTHERS = 1_000_000
"""More than any number of a tool: entries with other diameters have keys beyond it."""


@record(frozen=True, slots=True)
class Entry:
    """What is known of a tool. number: 0 none, -1 not known; tool: None where the table has none; doubt: why its
    diameter is left out, "" where it is not; ends: mm between which the diameter is, None where it is unknown."""

    number: int
    tool: Tool | None
    doubt: str
    ends: tuple[float, float] | None


def entry_of(machine: Machine, number: int, diameters: tuple[ToolDiameter, ...]) -> Entry:
    """The tool of a number with the diameter in force."""
    tool = machine.tool(number)
    stated = None if tool is None else tool.diameter
    written = next((each for each in diameters if each.tool == number), None)
    if written is None:
        # Controllers' files have 0 for tools that nobody filled in.
        return Entry(number, tool, "", (stated, stated) if stated is not None and stated > 0.0 else None)
    tool = Tool(number=number) if tool is None else tool
    if written.high <= 0.0:
        return Entry(number, tool, f"tool {number} is given a diameter of 0", None)
    if written.low == written.high:
        return Entry(number, replace(tool, diameter=written.low), "", (written.low, written.low))
    doubt = f"the diameter of tool {number}, set by the job or the setup, is unknown"
    return Entry(number, replace(tool, diameter=None), doubt, (written.low, written.high))


def entries(machine: Machine, state: State) -> tuple[Entry, ...]:
    """Of all tools that may be in the spindle: one, or where it is not known which, all that anybody states."""
    if state.tool >= 0:
        return (entry_of(machine, state.tool, state.diameters),)
    numbers = dict.fromkeys((*(tool.number for tool in machine.tools), *(each.tool for each in state.diameters)))
    return tuple(entry_of(machine, number, state.diameters) for number in numbers)


class SpindleTools:
    """Keys of the tools that a job uses: the tool's number, or another one for each further diameter of it."""

    def __init__(self, machine: Machine) -> None:
        self._machine = machine
        self._keys: dict[tuple[int, tuple[ToolDiameter, ...]], int] = {}
        self._entries: dict[int, Entry] = {}

    def key(self, state: State) -> int:
        """The tool of a state, -1 where it is not known which."""
        if state.tool < 0:
            return -1
        own = tuple(each for each in state.diameters if each.tool == state.tool)
        known = (state.tool, own)
        if known not in self._keys:
            key = state.tool + _OTHERS * len(self._keys) if own else state.tool
            self._keys[known] = key
            self._entries[key] = entry_of(self._machine, state.tool, own)
        return self._keys[known]

    def entry(self, key: int) -> Entry:
        """What is known of it."""
        return self._entries.get(key, Entry(key, self._machine.tool(key), "", None))
