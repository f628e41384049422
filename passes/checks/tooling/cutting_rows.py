"""Which rows cut, and with what: columns that the properties feeds and cutting share.

A row counts as a cut when it is a feed move or an arc that goes somewhere, not straight up, with a head that holds a
tool (not the probe or the camera); without stock in the setup, it is unknown whether material is there.
Moves of the machine's own macros that fetch or measure tools (what replaces a code, changes or measures a tool, and
starts no spindle) are not cuts. Nor are moves with the guard of the tool change area off, where the job switches it on
again: what they would give is held back until then (``Guarded``).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable

import numpy as np
import numpy.typing as npt

from gproof.ir.machine import Machine, Tool
from gproof.ir.program import Block, BlockTable, Call, Number, Program, Replaced, Statement, parts_of
from gproof.ir.rules import Function as F
from gproof.ir.trace import KNIFE, Chunk, Op, State, Trace, Wait

Bools = npt.NDArray[np.bool_]
Floats = npt.NDArray[np.float64]
PROBE_HEAD = 4
SOMEWHERE = 1e-6
"""mm or degrees: less is no move."""
_CHANGE_GUARD = "tool_change_area"
LONG_MACRO = 2000
"""Lines that no macro of a tool change has."""
_TOOLS = frozenset(
    (F.TOOL_CHANGE, F.TOOL_NUMBER, F.PROBE, F.MEASURE_TOOL, F.MEASURE_SWITCH, F.MEASURE_SURFACE, F.MEASURE_DEPTH,
     F.STORE_TOOL)
)  # fmt: skip
_STARTS = frozenset((F.SPINDLE_CW, F.SPINDLE_CCW))


def macro_names(program: Program) -> frozenset[str]:
    """Names of the subprograms that codes of the machine's own stand for, where they fetch or measure tools.

    One that starts a spindle may cut, and does not count.
    """
    names = set(program.overrides.values())
    bodies = [program.body, *(sub.body for sub in program.subprograms.values())]
    names |= {call.name for body in bodies for call in _replacing(body)}
    done = {name: _functions(program, name, set()) for name in names}
    return frozenset(name for name, does in done.items() if does & _TOOLS and not does & _STARTS)


def _functions(program: Program, name: str, seen: set[str]) -> set[F]:
    """What a subprogram and those that it calls may do, as far as codes are written as numbers."""
    sub = program.subprograms.get(name)
    if sub is None or name in seen:
        return set()
    seen.add(name)
    found: set[F] = set()
    for node in _all(sub.body):
        words: list[tuple[str, float]] = []
        if isinstance(node, BlockTable):
            if node.last_line - node.first_line > LONG_MACRO:
                return set()  # a job, and no tool change
            table, _, _ = program.load(node, node.begin, node.first_line, max(1, node.end - node.begin))
            words = [(chr(c), v) for c, v in zip(table["letter"].tolist(), table["value"].tolist(), strict=True)]
        elif isinstance(node, Block):
            words = [(w.letter, w.value.value) for w in node.words if isinstance(w.value, Number)]
        elif isinstance(node, Call):
            found |= _functions(program, node.name, seen)
        rules = (program.rules.codes.get((letter, round(v * 10))) for letter, v in words if abs(v) < 1e6)
        found |= {rule.function for rule in rules if rule is not None}
    return found


def _all(body: Iterable[Statement]) -> Iterable[Statement]:
    for node in body:
        yield node
        for part in parts_of(node):
            yield from _all(part)


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
        if chunk.last and any(edge.wait is Wait.PROBE for edge in chunk.edges):
            # The move that a switch or a probe ends is the last one of its section.
            cut[np.flatnonzero(op < Op.DWELL)[-1:]] = False
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
    return float(state.head >= PROBE_HEAD or KNIFE in state.following)


class Guarded:
    """Which cuts run with the guard of the tool change area off, and when it is on again."""

    def __init__(self) -> None:
        self._off = StateColumn(lambda state: float(_CHANGE_GUARD in state.guards_off))

    def split(self, chunk: Chunk, cut: Bools) -> tuple[Bools, Bools, bool]:
        """Cuts with the guard on; those with it off after the last time it was switched on; whether it was."""
        off = self._off.rows(chunk) != 0.0
        rows = chunk.rows
        names = [k for k, text in enumerate(chunk.trace.texts) if text == _CHANGE_GUARD]
        on = (rows["op"] == Op.GUARD) & (rows["arg"][:, 0] == 1.0) & np.isin(rows["text"], names)
        held = cut & off
        again = bool(on.any())
        if again:
            held[: int(np.flatnonzero(on)[-1])] = False
        return cut & ~off, held, again


def tool_column(machine: Machine, of: Callable[[Tool], float | None]) -> StateColumn:
    """A limit of the tool in the spindle, NaN where there is none stated or the tool is not known."""

    def limit(state: State) -> float:
        tool = machine.tool(state.tool) if state.tool > 0 else None
        value = None if tool is None else of(tool)
        return np.nan if value is None else value

    return StateColumn(limit)
