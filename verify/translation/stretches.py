"""The moves of one side between two waits, as columns that can be compared, with the events between them.

Moves of no length are left out: nothing moves, and what they might switch is an event of its own. Sections that follow
each other without a question (an edge without outcome) are one stretch: such an edge is a place of the evaluation,
where outcomes come together, and the machine goes on.
"""

from __future__ import annotations

import math
import re
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from gproof.ir.columns import Columns
from gproof.ir.machine import AXIS_NAMES
from gproof.ir.record import record
from gproof.ir.trace import Edge, Op, TraceSection, Wait
from gproof.verify.translation.align_kernels import Moves
from gproof.verify.translation.comparison import Place
from gproof.verify.translation.events import Devices, Event, EventReader
from gproof.verify.translation.sides import Side

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

_TOOL = re.compile(r"\btool (\d+)\b", re.IGNORECASE)
NO_LENGTH = 1e-12
"""mm or degrees: what two roundings of one number differ by is no move."""
LONGEST_LOOK = 0.1
"""Seconds between two looks of a loop that waits for an input: with more it goes on late, or misses a pulse."""


@record(slots=True, kw_only=True)
class Stretch:
    """moves: its moves; start, start_frame: where it starts, position and number of its frame; places: (n, 2) file
    and line of each move; events, rests: see ``events``; devices: their state at its end; edges: of its last section;
    jumps: moves before which the place changed without a move; sections: their numbers; kept: by section the rows that
    are moves; before: file and line of what came before it; at_machine: the first move to a number in
    machine coordinates, -1: none.
    """

    moves: Moves
    start: Floats
    start_frame: int
    places: Ints
    events: list[Event]
    rests: set[int]
    devices: Devices
    edges: tuple[Edge, ...]
    jumps: Ints
    sections: tuple[int, ...]
    side: Side
    kept: dict[int, Ints]
    before: Place | None = None
    at_machine: int = -1

    def place(self, row: int) -> Place | None:
        """File and line of a move; of one that is not there, of the last."""
        if not len(self.places):
            return self.before
        file, line = self.places[min(row, len(self.places) - 1)].tolist()
        return self.side.trace.files[file], line

    @property
    def question(self) -> str:
        """The last text that the operator reads before the wait, in letters and digits."""
        return "".join(filter(str.isalnum, self.said.casefold()))

    @property
    def said(self) -> str:
        """The last text that the operator reads before the wait; "" for none."""
        rows = self.side.trace.sections[self.sections[-1]].rows
        texts = rows["text"][rows["op"] == Op.MESSAGE]
        return self.side.trace.texts[int(texts[-1])] if len(texts) else ""

    @property
    def ends_at_rest(self) -> bool:
        """Whether it ends the program by a code that switches spindle and coolant off."""
        rows = self.side.trace.sections[self.sections[-1]].rows
        return bool(((rows["op"] == Op.END) & (rows["arg"][:, 1] == 1.0)).any())

    @property
    def last_place(self) -> Place | None:
        """File and line of what ends it, as far as known."""
        edge = self.edges[0] if self.edges else None
        if edge is not None and edge.line:
            return self.side.trace.files[edge.file], edge.line
        rows = self.side.trace.sections[self.sections[-1]].rows
        if not len(rows):
            return self.place(len(self.places))
        return self.side.trace.files[int(rows["file"][-1])], int(rows["line"][-1])


def is_joint(edges: tuple[Edge, ...]) -> bool:
    """Whether a section ends where nothing is asked."""
    return len(edges) == 1 and edges[0].wait is Wait.BRANCH and not edges[0].outcome


def stretch_from(side: Side, number: int, devices: Devices, ends_of: set[int]) -> Stretch:
    """The stretch that starts with a section; ends_of: sections before which it ends although nothing is asked.

    A loop that does nothing until an input has a state is the wait for that input (``_poll``).
    """
    found = _stretch(side, number, devices, ends_of)
    if side.which == 1 and side.terms.tool_by_stop:
        _as_tool_change(side, found)
    awaited = _poll(side, found)
    if awaited is None:
        return found
    side.polls = True
    edge, channel, value = awaited
    place = side.trace.files[edge.file], edge.line
    found.events.append(Event("input", (float(side.inputs.get(channel, channel)), value), len(found.moves.op), place))
    found.edges = (Edge(wait=Wait.INPUT, outcome="come", target=edge.target, line=edge.line, file=edge.file),)
    return found


def agree_on_stops(one: Stretch, other: Stretch) -> None:
    """The stop that ends one stretch, where the other one waits for the operator too: who answers a message, waits."""
    stops = [_final_stop(stretch) for stretch in (one, other)]
    if stops == [True, False] and _waits_for_operator(other):
        one.events.pop()
    elif stops == [False, True] and _waits_for_operator(one):
        other.events.pop()


def agree_on_ends(one: Stretch, other: Stretch) -> None:
    """Spindle and coolant off right before the end of one program, where the code for the end of the other one switches
    them off anyway: the Trace of that one has no command for what is off there already, as far as it knows."""
    for stretch, by_end in ((one, other), (other, one)):
        if not by_end.ends_at_rest:
            continue
        own = {event.kind for event in _last_offs(by_end)}
        for event in _last_offs(stretch):
            if event.kind not in own:
                stretch.events.remove(event)


def _last_offs(found: Stretch) -> list[Event]:
    """Commands at the end of a program that switch spindle or coolant off."""
    offs: list[Event] = []
    if len(found.edges) != 1 or found.edges[0].wait is not Wait.END:
        return offs
    for event in reversed(found.events):
        is_off = event.kind in {"spindle", "coolant"} and not any(event.values)
        if not is_off or event.at != len(found.moves.op):
            break
        offs.append(event)
    return offs


def _final_stop(found: Stretch) -> bool:
    stop = found.events[-1] if found.events else None
    if stop is None or stop.kind != "stop" or stop.values != (0.0,):
        return False
    return stop.at == len(found.moves.op) and _waits_for_operator(found)


def _waits_for_operator(found: Stretch) -> bool:
    """Whether nothing but a word of the operator ends a stretch, whatever it is."""
    is_wait = len(found.edges) == 1 and found.edges[0].wait is Wait.OPERATOR
    return is_wait and not (found.events and found.events[-1].kind == "stop" and found.events[-1].values != (0.0,))


def _as_tool_change(side: Side, found: Stretch) -> None:
    """A stop that names a tool is a change to it: by the number that comes first after it, or by its text."""
    stop = found.events[-1] if found.events else None
    if stop is None or stop.kind != "stop" or stop.values != (0.0,) or stop.at != len(found.moves.op):
        return
    if len(found.edges) != 1 or found.edges[0].wait is not Wait.OPERATOR or found.edges[0].target < 0:
        return
    after = _stretch(side, found.edges[0].target, Devices(), set())
    named = _TOOL.findall(found.said)
    numbered = bool(after.events) and after.events[0].kind == "tool" and after.events[0].at == 0
    if numbered and len(after.events) == 1 and any(edge.wait is Wait.TOOL_CHANGE for edge in after.edges):
        numbered = False  # that is a change with a wait of its own
    if numbered:
        value = after.events[0].values[0]
    elif len(named) == 1:
        value = float(named[0])
    else:
        return
    assert isinstance(value, float)
    found.events[-1] = stop._replace(kind="tool", values=(value,))
    found.devices = found.devices._replace(changed=value)
    found.edges = (replace(found.edges[0], wait=Wait.TOOL_CHANGE, outcome="tool changed"),)


def _poll(side: Side, found: Stretch) -> tuple[Edge, int, float] | None:
    """The outcome that ends a loop which only waits, with channel and state of the input; None where it is none.

    One outcome of the question leads to a section that moves and switches nothing, dwells at most for a moment, and
    asks the same with the same outcomes.
    """
    question = side.trace.questions.get(found.sections[-1])
    if question is None or question.kind != "input" or len(found.edges) != 2:
        return None
    for n, edge in enumerate(found.edges):
        if edge.target < 0:
            continue
        again = _stretch(side, edge.target, found.devices, set())
        quiet = not len(again.moves.op) and all(event.kind == "dwell" for event in again.events)
        quiet = quiet and sum(float(event.values[0]) for event in again.events) <= LONGEST_LOOK
        same = side.trace.questions.get(again.sections[-1]) == question
        if quiet and same and [e.target for e in again.edges] == [e.target for e in found.edges]:
            ending = found.edges[1 - n]
            return ending, question.channel, float((ending.outcome == "true") == question.on)
    return None


def _stretch(side: Side, number: int, devices: Devices, ends_of: set[int]) -> Stretch:
    """The stretch that starts with a section, as the Trace has it."""
    sections = [side.trace.sections[number]]
    while is_joint(sections[-1].edges) or _is_read(sections[-1]) or _goes_on(side, sections[-1]):
        target = sections[-1].edges[0].target
        if target < 0 or target in ends_of or any(section.number == target for section in sections):
            break
        sections.append(side.trace.sections[target])
    reader = EventReader(side, devices)
    parts = [_Part(side, section) for section in sections]
    count = 0
    for part in parts:
        reader.read(part.section.rows, part.before + count)
        count += len(part.kept)
    jumps = np.concatenate([part.jumps for part in parts]) if len(parts) > 1 else parts[0].jumps
    start, shift = side.placed(np.array([sections[0].start_frame]), np.array([sections[0].start]))
    return Stretch(
        moves=_joined([part.moves for part in parts]), start=shift[0], start_frame=int(start[0]),
        places=np.concatenate([part.places for part in parts]) if len(parts) > 1 else parts[0].places,
        events=reader.found, rests=reader.rests | {0, count}, devices=reader.devices, edges=sections[-1].edges,
        jumps=np.flatnonzero(jumps), at_machine=_first([part.to_machine for part in parts]), side=side,
        sections=tuple(section.number for section in sections),
        kept={part.section.number: part.kept for part in parts},
    )  # fmt: skip


def _first(parts: list[npt.NDArray[np.bool_]]) -> int:
    """The number of the first row that is marked, -1: none is."""
    count = 0
    for part in parts:
        if part.any():
            return count + int(np.argmax(part))
        count += len(part)
    return -1


def _is_read(section: TraceSection) -> bool:
    """Whether a section ends with an input that is read at once: that takes no time and asks nothing."""
    edges = section.edges
    return len(edges) == 1 and edges[0].wait is Wait.INPUT and edges[0].outcome == "read"


def _goes_on(side: Side, section: TraceSection) -> bool:
    """Whether a section ends with a tool change that counts as done, whoever does it."""
    edges = section.edges
    return not side.terms.tool_change_waits and len(edges) == 1 and edges[0].wait is Wait.TOOL_CHANGE


class _Part:
    """The moves of one section."""

    def __init__(self, side: Side, section: TraceSection) -> None:
        self.section = section
        rows = section.rows
        op, raw = rows["op"], rows["frame"]
        frame, to = side.placed(raw, rows["to"])
        start, start_to = side.placed(np.array([section.start_frame]), np.array([section.start]))
        came_frame = np.concatenate([start, frame[:-1]]) if len(frame) else frame
        moving = _moving(side, section, raw, to, start_to)
        axes = np.add.reduce(moving, axis=1, dtype=np.int64)
        kept = (op < 10) & ((axes > 0) | (op == Op.ARC) | (op == Op.PROBE))
        self.kept = np.flatnonzero(kept)
        number = np.cumsum(kept)
        self.before: Ints = (number - kept).astype(np.int64)
        take = slice(None) if len(self.kept) == len(op) else self.kept
        known = side.at_known(raw)
        there = np.any(moving & known, axis=1) if known.any() else np.zeros(len(op), np.bool_)
        self.to_machine: npt.NDArray[np.bool_] = np.asarray(there)[take]
        self.places = np.empty((len(self.kept), 2), np.int64)
        self.places[:, 0], self.places[:, 1] = rows["file"][take], rows["line"][take]
        before = came_frame[take]
        # The frame changes with rows that do not move: nobody says how the axes got there.
        ends = np.concatenate([start, frame[take][:-1]]) if len(self.kept) else before
        self.jumps = before != ends
        self.moves = Moves(
            op=op[take].astype(np.int64), to=np.ascontiguousarray(to[take]), frame=frame[take], before=before,
            fact=side.facts(rows["state"])[take], feed=_rates(side, rows, moving)[take],
            center=side.shifted(rows["center"][take], raw[take]), turns=rows["turns"][take].astype(np.int64),
            plane=rows["plane"][take].astype(np.int64), axes=axes[take],
        )  # fmt: skip


def _rates(side: Side, rows: Columns, moving: npt.NDArray[np.bool_]) -> Floats:
    """The feed of each row; of a rapid of the source the fastest that the target's axes which move allow, NaN where
    that of one is not known."""
    feed: Floats = rows["feed"]
    if side.which != 0 or not side.terms.rapid_rates:
        return feed
    given = dict(side.terms.rapid_rates)
    rates = np.array([given.get(axis, math.nan) for axis in AXIS_NAMES])
    most = np.where(moving, rates, math.inf).min(axis=1, initial=math.inf)
    return np.where(rows["op"] == Op.TRAVERSE, most, feed)


def _moving(side: Side, section: TraceSection, raw: Ints, to: Floats, start_to: Floats) -> npt.NDArray[np.bool_]:
    """(n, 6): whether an axis may move in a row: another number, or another form."""
    way = np.empty_like(to)
    if len(to):
        np.subtract(to[:1], start_to, out=way[:1])
        np.subtract(to[1:], to[:-1], out=way[1:])
    moving = np.asarray(np.abs(way, out=way) > NO_LENGTH)
    came = np.concatenate([[section.start_frame], raw[:-1]])
    changed = np.flatnonzero(raw != came[: len(raw)])
    if len(changed):
        moving[changed] |= side.forms_of(raw[changed]) != side.forms_of(came[changed])
    return moving


def _joined(parts: list[Moves]) -> Moves:
    if len(parts) == 1:
        return parts[0]
    return Moves(*(np.concatenate([part[k] for part in parts]) for k in range(len(Moves._fields))))
