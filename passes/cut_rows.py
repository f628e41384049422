"""Which rows cut, and with what: columns that the properties feeds and cutting share.

A row counts as a cut when it is a feed move or an arc that goes somewhere, not straight up, with a head that holds a
tool (not the probe or the camera); where nothing is stated of the stock, whether material is there nobody knows.
Moves of the machine's own macros (what replaces a code of its own) and moves with the guard of the tool change area
off are not cuts: they fetch tools, measure them, or park.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable

import numpy as np
import numpy.typing as npt

from gproof.ir.machine import Machine, Tool
from gproof.ir.program import Call, Program, Replaced, Statement, parts_of
from gproof.ir.trace import KNIFE, Chunk, Op, State, Trace

Bools = npt.NDArray[np.bool_]
Floats = npt.NDArray[np.float64]
PROBE_HEAD = 4
SOMEWHERE = 1e-6
"""mm or degrees: less is no move."""
_CHANGE_GUARD = "tool_change_area"


def macro_names(program: Program) -> frozenset[str]:
    """Names of the subprograms that codes of the machine's own stand for, and of what these call."""
    names = set(program.overrides.values())
    bodies = [program.body, *(sub.body for sub in program.subprograms.values())]
    names |= {call.name for body in bodies for call in _replacing(body)}
    return frozenset(names)


def _replacing(body: Iterable[Statement]) -> Iterable[Call]:
    for node in body:
        if isinstance(node, Replaced):
            yield from (inner for inner in node.body if isinstance(inner, Call))
        for part in parts_of(node):
            yield from _replacing(part)


class StateColumn:
    """A number for each state of a trace; states are added while a job streams by."""

    def __init__(self, of: Callable[[State], float]) -> None:
        self._of = of
        self._values = np.zeros(0)

    def rows(self, chunk: Chunk) -> Floats:
        """(n,): that of the state of each row."""
        states = chunk.trace.states
        if len(self._values) < len(states):
            more = [self._of(state) for state in states[len(self._values) :]]
            self._values = np.concatenate([self._values, np.array(more, dtype=np.float64)])
        taken: Floats = self._values[chunk.rows["state"]]
        return taken


class CutRows:
    """Tells of each row of a chunk whether it cuts."""

    def __init__(self, program: Program) -> None:
        self._macros = macro_names(program)
        self._excused = StateColumn(_excused)
        self._of_macro = np.zeros(0, dtype=bool)

    def ways(self, chunk: Chunk) -> Floats:
        """(n, 6): how far each row goes; NaN in an axis whose offset changes on the way."""
        way: Floats = chunk.rows["to"] - chunk.starts()
        other = chunk.rows["frame"] != chunk.start_frames()
        if other.any():
            way[other] = np.nan
        return way

    def cuts(self, chunk: Chunk, way: Floats) -> Bools:
        """(n,): True for rows that cut, by the rule of this module."""
        rows = chunk.rows
        op = rows["op"]
        arcs: Bools = op == Op.ARC
        moves: Bools = (op == Op.FEED) | arcs
        # What is not known to be nowhere, or straight up, is taken for a cut: comparisons with NaN do not hold.
        beside = ~((np.abs(way[:, :2]) < SOMEWHERE).all(axis=1) & (np.abs(way[:, 3:]) < SOMEWHERE).all(axis=1))
        cut: Bools = moves & (arcs | beside | ~(way[:, 2] > -SOMEWHERE))
        cut &= (self._excused.rows(chunk) == 0.0) & ~self._in_macro(chunk.trace)[rows["call"]]
        return cut

    def _in_macro(self, trace: Trace) -> Bools:
        """By number of a call, whether it runs within a macro of the machine."""
        if len(self._of_macro) < len(trace.calls):
            chains = (text.split(" (from line ")[0].split(" > ") for text in trace.calls[len(self._of_macro) :])
            more = [not self._macros.isdisjoint(chain) for chain in chains]
            self._of_macro = np.concatenate([self._of_macro, np.array(more, dtype=bool)])
        return self._of_macro


def _excused(state: State) -> float:
    """1 where feed moves are not those of a turning tool."""
    return float(state.head >= PROBE_HEAD or KNIFE in state.following or _CHANGE_GUARD in state.guards_off)


def tool_column(machine: Machine, of: Callable[[Tool], float | None]) -> StateColumn:
    """A limit of the tool in the spindle, NaN where there is none stated or the tool is not known."""

    def limit(state: State) -> float:
        tool = machine.tool(state.tool) if state.tool > 0 else None
        value = None if tool is None else of(tool)
        return np.nan if value is None else value

    return StateColumn(limit)
