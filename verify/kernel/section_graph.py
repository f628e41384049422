"""The section graph: what waits ends its section, every section is reached, and nothing runs in a circle.

The steps of a section say nothing of what comes between two sections. A stop that was merged into a longer section, an
end that was put in the middle or an edge that leads back leave all steps as they are, so they are judged here, from the
Trace's rows and edges alone. docs/verification.md states the proposition.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from gproof.ir.columns import Columns, batches, joined
from gproof.ir.drives import Drives
from gproof.ir.trace import HEIGHT_MAP, KNIFE, SETPOINTS, TRACE_ROW, Op, State, Trace, TraceSection, Wait

WAITS = {
    Op.STOP: Wait.OPERATOR,
    Op.TOOL_CHANGE: Wait.TOOL_CHANGE,
    Op.INPUT_WAIT: Wait.INPUT,
    Op.PROBE: Wait.PROBE,
    Op.HOME: Wait.HOME,
    Op.END: Wait.END,
}
"""Rows that wait, and the edge that leads on from each."""

WITHOUT_A_ROW = frozenset({Wait.OPERATOR})
"""Edges that need no row of their own: dialogs and messages ask the operator too."""

UNDECIDED = frozenset({Wait.BRANCH, Wait.UNKNOWN})
"""Edges that a run cannot choose from: what they depend on is not known to whoever sends steps."""

NOTES = frozenset({Op.OFFSET, Op.TOOL_OFFSET, Op.UNITS, Op.PLANE, Op.OVERRIDE, Op.PATH_MODE, Op.GUARD, Op.MESSAGE})
"""Rows that may follow a wait in its section: they take no time, move nothing and switch nothing."""

LAST_MOTION = Op.PROBE

_WAITING, _ACTING = np.zeros(256, np.bool_), np.ones(256, np.bool_)
_WAITING[list(WAITS)] = True
_ACTING[list(NOTES)] = False


class Problem(NamedTuple):
    """section, row: where (-1: the whole); kind, values: what."""

    section: int
    row: int
    kind: str
    values: tuple[Any, ...] = ()


def problems(trace: Trace, drives: Drives) -> Iterator[Problem]:
    """What keeps the sections from being run one after the other as the rows say."""
    if not trace.sections:
        yield Problem(-1, -1, "graph.no-section")
        return
    moves = [*_OPEN_LOOP, *(_KNIFE if drives.knife_turned else ())]
    by_state = [(np.array([true(state) for state in trace.states], dtype=np.bool_), kind) for true, kind in moves]
    by_state = [(found, kind) for found, kind in by_state if found.any()]
    setting = False
    for begin, end in batches([len(section.rows) for section in trace.sections]):
        sections = trace.sections[begin:end]
        rows = joined(TRACE_ROW, [section.rows for section in sections])
        open_loop = any(True for _ in _open_loop(-1, rows, by_state))
        setting = setting or bool((rows["op"] == Op.SETPOINT).any())
        for section in sections:
            yield from _edges(section)
            yield from _waits(section, drives.auto_tool_change)
            if open_loop:
                yield from _open_loop(section.number, section.rows, by_state)
    if setting:
        yield from _setpoints(trace)
    yield from _ways(trace)
    yield from _height_map(trace, drives)


def _edges(section: TraceSection) -> Iterator[Problem]:
    """A section is left in one way, by distinct outcomes."""
    edges, number = section.edges, section.number
    if not edges:
        yield Problem(number, -1, "graph.no-edge")
        return
    kinds = {edge.wait for edge in edges}
    if len(kinds) > 1:
        yield Problem(number, -1, "graph.two-waits", (tuple(kinds),))
    for kind in sorted(kinds & UNDECIDED, key=lambda k: k.value):
        yield Problem(number, -1, "graph.undecided", (kind,))
    outcomes = [edge.outcome for edge in edges]
    if len(set(outcomes)) < len(outcomes):
        yield Problem(number, -1, "graph.one-outcome", (tuple(outcomes),))
    if Wait.END in kinds and (len(edges) > 1 or edges[0].target != -1):
        yield Problem(number, -1, "graph.end-goes-on", (edges[0].target,))


def _waits(section: TraceSection, auto_tool_change: bool) -> Iterator[Problem]:
    """What waits is the last of its section, and row and edge are of one kind."""
    rows, number = section.rows, section.number
    op = rows["op"]
    kinds = {edge.wait for edge in section.edges}
    waiting = _WAITING[op]
    if auto_tool_change:
        # The changer's own cycle is in the job's rows; the motors stand for the change and go on.
        waiting &= op != Op.TOOL_CHANGE
    acting = np.flatnonzero(_ACTING[op])
    last = int(acting[-1]) if len(acting) else -1
    for row in np.flatnonzero(waiting).tolist():
        kind = Op(int(op[row]))
        if row != last:
            yield Problem(number, row, "graph.goes-on", (kind,))
        elif WAITS[kind] not in kinds:
            yield Problem(number, row, "graph.other-wait", (kind, *kinds))
    ends = Op(int(op[last])) if last >= 0 else None
    for wait in kinds - WITHOUT_A_ROW - UNDECIDED:
        if ends is None or WAITS.get(ends) is not wait:
            yield Problem(number, last, "graph.wait-without-row", (wait,))


def _setpoints(trace: Trace) -> Iterator[Problem]:
    """What a row sets is something that a board can set."""
    for section in trace.sections:
        rows = np.flatnonzero(section.rows["op"] == Op.SETPOINT)
        for text in np.unique(section.rows["text"][rows]).tolist():
            name = trace.texts[text] if 0 <= text < len(trace.texts) else ""
            if name not in SETPOINTS:
                row = int(rows[section.rows["text"][rows] == text][0])
                yield Problem(section.number, row, "graph.setpoint", (name,))


def _ways(trace: Trace) -> Iterator[Problem]:
    """Every section is reached from the first one, and no way leads back to where it has been."""
    count = len(trace.sections)
    targets = [[e.target for e in s.edges if 0 <= e.target < count] for s in trace.sections]
    NEW, OPEN, DONE = 0, 1, 2
    seen = [NEW] * count
    stack: list[tuple[int, int]] = [(0, 0)]
    seen[0] = OPEN
    while stack:
        number, place = stack.pop()
        if place == len(targets[number]):
            seen[number] = DONE
            continue
        stack.append((number, place + 1))
        target = targets[number][place]
        if seen[target] == OPEN:
            yield Problem(number, -1, "graph.back", (target,))
        elif seen[target] == NEW:
            seen[target] = OPEN
            stack.append((target, 0))
    for number in range(count):
        if seen[number] == NEW:
            yield Problem(number, -1, "graph.no-way")


_OPEN_LOOP: tuple[tuple[Callable[[State], bool], str], ...] = (
    (lambda s: s.synchronised, "graph.synchronised"),
    (lambda s: s.surface_speed != 0.0, "graph.surface-speed"),
    (lambda s: s.head != 0, "graph.head"),
    (lambda s: bool(s.retimed or s.backlash), "graph.retimed"),
)
"""By state, moves that depend on where the spindle is, or on what the job itself changed of its axes."""


_KNIFE: tuple[tuple[Callable[[State], bool], str], ...] = ((lambda s: KNIFE in s.following, "graph.knife"),)
"""Moves with a knife that the controller turns, not these rows."""


def _open_loop(
    number: int, rows: Columns, by_state: list[tuple[npt.NDArray[np.bool_], str]]
) -> Iterator[Problem]:  # fmt: skip
    """What moves motors, or turns the spindle, in ways that the steps do not have."""
    moving = rows["op"] <= LAST_MOTION
    for found, kind in (
        *((moving & states[rows["state"]], kind) for states, kind in by_state),
        (rows["op"] == Op.ORIENT, "graph.orientation"),
        ((rows["op"] == Op.HEAD) & (rows["arg"][:, 0] != 0), "graph.head"),
    ):
        if found.any():
            yield Problem(number, int(np.argmax(found)), kind)


def _height_map(trace: Trace, drives: Drives) -> Iterator[Problem]:
    """A map that is on when the job starts, and that none of its moves follows."""
    if drives.height_map is None or not drives.height_map.on:
        return
    moves = False
    follows = np.array([HEIGHT_MAP in state.following for state in trace.states], dtype=np.bool_)
    for section in trace.sections:
        moving = section.rows["op"] <= LAST_MOTION
        moves = moves or bool(moving.any())
        if follows.any() and (moving & follows[section.rows["state"]]).any():
            return
    if moves:
        yield Problem(-1, -1, "graph.unused-height-map")
