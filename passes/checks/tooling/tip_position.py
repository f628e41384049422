"""Where the tip of the tool is in the coordinates of a body: stock, part or fixture.

Takes a Machine, a Setup and rows of the Trace; gives positions of the tip (mm) from the zero that the body counts
from. A body does not move: its zero is where its coordinate system's was when the job started, local offsets (G92)
included. Positions of rows and zeros are sums of numbers and unknowns (``ir/trace.py``), so that an offset that is not
stated cancels, and one that the program sets itself is followed. What does not cancel, and is not stated exactly, is
not known, and ``Reason`` says why.

The tip is where a position is, less what ``State.tip`` takes for the tool: its length, in force or not, in a job that
uses lengths. In others the zero was taken with that very tool, which ``assumptions`` says. Cutter radius compensation
needs nothing: rows are the tool's own path.
"""

from __future__ import annotations

import enum
import math

import numpy as np
import numpy.typing as npt

from gproof.ir.columns import occurring
from gproof.ir.machine import AXIS_NAMES, AxisKind, Machine
from gproof.ir.record import record
from gproof.ir.setup import Setup
from gproof.ir.symbolic import Position, add_forms
from gproof.ir.symbols import describe
from gproof.ir.trace import HEIGHT_MAP, UNKNOWN, Affine, Chunk, Op, State, TipOffset, Trace
from gproof.ir.trace_rows import form_interval
from gproof.ir.workpiece import ACTIVE, MACHINE
from gproof.passes.checks.base import ZeroAt
from gproof.passes.checks.tooling.spindle_tool import SpindleTools
from gproof.passes.checks.tooling.tip_ranges import EVERYWHERE, NOWHERE_KNOWN, Span

Floats = npt.NDArray[np.float64]
Bools = npt.NDArray[np.bool_]

OWN_ZERO = "where no tool length is active, the work zero was set with the tool that is in the spindle"
SMOOTHED = "corners that the controller rounds do not reach a body"
"""Assumption: how far smoothing leaves the path is in no file (WinCNC accel=, g08=, g09=, vmatch=)."""
OWN_LENGTH = "the tool length at the start of the job is that of the tool in the spindle (not in the setup file)"
OTHER_HEADS = "heads other than the first one hit nothing: {axes} is not checked"


class Reason(enum.IntEnum):
    """Why a place is not known; the greatest one that holds."""

    KNOWN = 0
    START = 1
    """A traverse from where the axes are when the job starts, or a row that moves nothing there."""
    OFFSET = 2
    HEIGHT_MAP = 3
    ROTARY = 4
    HEAD = 5
    MAPPED = 6
    LATHE = 7


WHY = {
    Reason.KNOWN: "",
    Reason.START: "the start position of the axes is unknown",
    Reason.OFFSET: "it depends on offsets that are unknown",
    Reason.HEIGHT_MAP: "Z follows a height map, and the bodies do not",
    Reason.ROTARY: "a rotary axis is not where it was at the start of the job",
    Reason.HEAD: "another head than the first one is in use",
    Reason.MAPPED: "the axes of the machine do not move along X, Y and Z of the bodies",
    Reason.LATHE: "on a lathe the workpiece turns",
}
"""A reason in words; ``Placing.cause`` names the offsets too."""


@record(frozen=True, slots=True, eq=False)
class Tips:
    """Of n rows, where the tip of the tool is in the coordinates of a body, mm.

    start, end: (n, 3) before and after the row, NaN where it is not known; center: (n, 3) of arcs, 0 for other rows;
    axes: (n, 3) whether start and end are known of X, Y, Z; known: (n,) of all three; reason: (n,) ``Reason``;
    start_known, end_known: (n, 3) each end for itself; tool: (n,) the key of the tool in the spindle
    (``Placing.tools``).
    """

    start: Floats
    end: Floats
    center: Floats
    axes: Bools
    known: Bools
    reason: npt.NDArray[np.uint8]
    start_known: Bools
    end_known: Bools
    tool: npt.NDArray[np.int64]


class Placing:
    """``tips`` of one chunk after the other, for as many coordinate systems as bodies count from.

    ``tips`` may be asked several times of a chunk, and of systems ``MACHINE``, ``ACTIVE`` and 1 to 9. zero: see
    ``base.ZeroAt``.
    """

    def __init__(self, machine: Machine, setup: Setup, zero: ZeroAt) -> None:
        self.machine = machine
        self.setup = setup
        self._zero_at = zero
        self._zeros: dict[int, tuple[Position, ...]] = {}
        self.tools = SpindleTools(machine)
        self._turning = rotary_axes(machine)
        self._begin: tuple[tuple[float, ...], tuple[Affine, ...]] | None = None
        self._states: list[State] = []
        self._tips: dict[tuple[TipOffset, ...], int] = {(): 0}
        self._tip_of = {on_machine: np.zeros(0, dtype=np.int64) for on_machine in (False, True)}
        self._why_of = np.zeros(0, dtype=np.uint8)
        self._tool_of = np.zeros(0, dtype=np.int64)
        self._left: dict[tuple[int, int, int], tuple[Affine, Affine, Affine]] = {}
        self._assumed: dict[str, None] = {}
        self._always = Reason.KNOWN
        if setup.cylinder is not None or machine.kinematics != "trivial":
            self._always = Reason.MAPPED
        if machine.controller.turning or machine.controller.diameter_programming:
            self._always = Reason.LATHE
        heads = [axis for axis in machine.axes if axis.index > 2 and axis.vertical]
        self._heads = [axis.index for axis in heads]
        if heads:
            self._assumed[OTHER_HEADS.format(axes=" ".join(axis.word for axis in heads))] = None
        if machine.settings.smoothing:
            self._assumed[SMOOTHED] = None

    @property
    def assumptions(self) -> tuple[str, ...]:
        """What the places that were given rest on, after the chunks that were asked."""
        return tuple(self._assumed)

    def zero(self, work: int) -> tuple[Position, ...]:
        """X, Y, Z of the zero that bodies of a system count from, in machine coordinates."""
        if work not in self._zeros:
            if work == MACHINE:
                self._zeros[work] = (Position(0.0),) * 3
            else:
                number = 0 if work == ACTIVE else work
                self._zeros[work] = tuple(self._zero_at(number, axis) for axis in range(3))
        return self._zeros[work]

    def tips(self, chunk: Chunk, work: int) -> Tips:
        """Where the tip is; the rows' places are those of the tool's axis, so that its own radius comes on top."""
        trace, rows = chunk.trace, chunk.rows
        n = len(rows)
        if self._begin is None:
            frame = trace.frames[chunk.start_frame]
            self._begin = tuple(chunk.start), tuple(frame)
        self._learn(trace)
        states = rows["state"]
        starts, frames, start_frames = chunk.starts(), rows["frame"].astype(np.int64), chunk.start_frames()
        tips = self._tip_of[work == MACHINE][states]
        off = np.zeros((n, 3))
        before, behind = np.ones((n, 3), dtype=np.bool_), np.ones((n, 3), dtype=np.bool_)
        reason = np.full(n, int(self._always), dtype=np.uint8)
        feeds = (rows["op"] < Op.DWELL) & (rows["op"] != Op.TRAVERSE)
        at_start = (starts[:, :3] == np.array(self._begin[0][:3])).all(axis=1)
        for tip in occurring(tips):
            at = tips == tip
            off[at] = self._shift(tip, work)
            for column, known in ((frames, behind), (start_frames, before)):
                for index in occurring(column[at]):
                    left = self.rest(trace, tip, index, work)
                    if not any(left):
                        continue
                    spot = at & (column == index)
                    known[spot] = [form == () for form in left]
                    why = np.full(int(spot.sum()), _why(trace.frames[index], left))
                    if self._rests_on_length(trace.frames[index], left, work):
                        # The place is known, and how long the tool is there is not: only at the start that is no move.
                        why[~at_start[spot] if column is start_frames else slice(None)] = Reason.OFFSET
                    reason[spot] = np.maximum(reason[spot], np.where(feeds[spot], Reason.OFFSET, why))
        reason = np.maximum(reason, self._why_of[states])
        reason = np.maximum(reason, self._turned(chunk, starts))
        blind = reason >= Reason.HEIGHT_MAP
        if blind.any():
            before[blind], behind[blind] = False, False
        start, end = starts[:, :3] - off, rows["to"][:, :3] - off
        start[~before], end[~behind] = math.nan, math.nan
        arcs = rows["op"] == Op.ARC
        center = np.where(arcs[:, None], rows["center"] - off, 0.0)
        axes = before & behind
        self._note(rows["op"], states)
        return Tips(
            start, end, center, axes, np.asarray(axes.all(axis=1)), reason, before, behind, self._tool_of[states]
        )

    def _rests_on_length(self, frame: tuple[Affine, ...], left: tuple[Affine, Affine, Affine], work: int) -> bool:
        """Whether a place relative to a body is open by the length of the tool alone."""
        zero = self.zero(work)
        return not any(frame[axis] or zero[axis].form for axis in range(3) if left[axis])

    def rest(self, trace: Trace, tip: int, frame: int, work: int) -> tuple[Affine, Affine, Affine]:
        """What is left of the unknowns of X, Y, Z where positions of a frame are counted from a body's zero."""
        key = (tip, frame, work)
        found = self._left.get(key)
        if found is None:
            table = list(self._tips)[tip]
            zero = self.zero(work)
            forms = []
            for axis in range(3):
                form = add_forms(trace.frames[frame][axis], zero[axis].form, -1)
                for each in table:
                    if each.axis == axis:
                        form = add_forms(form, each.form, -1)
                forms.append(form)
            found = self._left[key] = (forms[0], forms[1], forms[2])
        return found

    def span(self, chunk: Chunk, row: int, work: int, *, behind: bool) -> Span:
        """Between what the tip is at one end of a row, mm; asked after ``tips`` of its chunk."""
        trace, rows = chunk.trace, chunk.rows
        state = int(rows["state"][row])
        if max(self._always, self._why_of[state]) >= Reason.HEIGHT_MAP:
            return NOWHERE_KNOWN
        if behind:
            place, frame = rows["to"][row], int(rows["frame"][row])
        else:
            place, frame = chunk.starts()[row], int(chunk.start_frames()[row])
        tip = int(self._tip_of[work == MACHINE][state])
        left, shift = self.rest(trace, tip, frame, work), self._shift(tip, work)
        found = []
        for axis in range(3):
            known = None if left[axis] == UNKNOWN else form_interval(left[axis], self.setup, trace)
            at = float(place[axis]) - shift[axis]
            found.append(EVERYWHERE if known is None else (at + known.low, at + known.high))
        return found[0], found[1], found[2]

    def machine_shift(self, chunk: Chunk, row: int, work: int) -> list[float | None]:
        """What machine positions of X, Y, Z have more than the tip at a row; None where that is not a number."""
        tip = int(self._tip_of[work == MACHINE][int(chunk.rows["state"][row])])
        open_ = {each.axis for each in list(self._tips)[tip] if each.form}
        zero, shift = self.zero(work), self._shift(tip, work)
        return [None if zero[axis].form or axis in open_ else shift[axis] for axis in range(3)]

    def _shift(self, tip: int, work: int) -> list[float]:
        own = list(self._tips)[tip]
        zero = self.zero(work)
        return [zero[axis].value + sum(each.mm for each in own if each.axis == axis) for axis in range(3)]

    def cause(self, chunk: Chunk, row: int, work: int) -> str:
        """Why the place of a row is not known, in words; asked after ``tips`` of its chunk."""
        reason = int(self.tips(_only(chunk, row), work).reason[0])
        if reason not in (Reason.START, Reason.OFFSET):
            return WHY[Reason(reason)]
        tip = int(self._tip_of[work == MACHINE][int(chunk.rows["state"][row])])
        names: dict[str, None] = {}
        ranged = False
        for frame in (int(chunk.start_frames()[row]), int(chunk.rows["frame"][row])):
            for axis, form in enumerate(self.rest(chunk.trace, tip, frame, work)):
                if form == UNKNOWN:
                    names[f"where {AXIS_NAMES[axis].upper()} is"] = None
                    continue
                for symbol, _ in form:
                    names[describe(((symbol, 1),), self.machine)] = None
                    ranged = ranged or self.setup.interval(symbol) is not None
        said = "not given exactly" if ranged else "unknown"
        return f"{', '.join(names)}: {said}" if names else WHY[Reason(reason)]

    def _learn(self, trace: Trace) -> None:
        """The states that have come since the last chunk."""
        have = len(self._states)
        new = trace.states[have:]
        if not new:
            return
        self._states = [*self._states, *new]
        why = [int(self._state_reason(state)) for state in new]
        for on_machine, those in self._tip_of.items():
            tips = [self._tips.setdefault(state.tip_beside(not on_machine), len(self._tips)) for state in new]
            self._tip_of[on_machine] = np.concatenate([those, np.array(tips, dtype=np.int64)])
        self._why_of = np.concatenate([self._why_of, np.array(why, dtype=np.uint8)])
        self._tool_of = np.concatenate([self._tool_of, np.array(list(map(self.tools.key, new)), dtype=np.int64)])

    def _state_reason(self, state: State) -> Reason:
        if state.head:
            return Reason.HEAD
        spaces = self.machine.settings.workspaces
        if state.work > 1 and any(space.number == state.work + 53 for space in spaces):
            # Another head, which these workspaces choose.
            return Reason.HEAD
        return Reason.HEIGHT_MAP if HEIGHT_MAP in state.following else Reason.KNOWN

    def _turned(self, chunk: Chunk, starts: Floats) -> npt.NDArray[np.uint8]:
        """By row: ROTARY where what may turn is not at its place of the start, HEAD where another head moves."""
        rows, trace = chunk.rows, chunk.trace
        reason = np.zeros(len(rows), dtype=np.uint8)
        assert self._begin is not None
        values, forms = self._begin
        frames, start_frames = rows["frame"], chunk.start_frames()
        for axis in self._turning:
            away = turned(chunk, axis, values[axis], forms[axis])
            reason[away] = np.maximum(reason[away], int(Reason.ROTARY))
        for axis in self._heads:
            away = starts[:, axis] != rows["to"][:, axis]
            away |= _differ(trace, axis, start_frames, frames)
            reason[away] = np.maximum(reason[away], int(Reason.HEAD))
        return reason

    def _note(self, op: npt.NDArray[np.uint8], states: npt.NDArray[np.int32]) -> None:
        """The assumptions that a move without a tool length, or with one that the job has not set, rests on."""
        moves = op < Op.DWELL
        if not moves.any() or (OWN_ZERO in self._assumed and OWN_LENGTH in self._assumed):
            return
        for index in occurring(states[moves]):
            state = self._states[index]
            if not any(each.axis == 2 for each in state.tip):
                self._assumed[OWN_ZERO] = None
            if rests_on_length_in_force(state):
                self._assumed[OWN_LENGTH] = None


def rotary_axes(machine: Machine) -> list[int]:
    """Columns of the axes that may turn what is on the table; a knife or saw turns itself."""
    controls = machine.settings
    own = {each.axis for each in (machine.knife, controls.knife, controls.saw) if each is not None}
    return [axis.index for axis in machine.axes if axis.kind is AxisKind.ROTARY and axis.name not in own]


def turned(chunk: Chunk, axis: int, value: float, form: Affine) -> Bools:
    """(n,): rows at one of whose ends an axis is not at a place, that of the start of the job."""
    rows, trace = chunk.rows, chunk.trace
    away: Bools = (chunk.starts()[:, axis] != value) | (rows["to"][:, axis] != value)
    for column in (chunk.start_frames(), rows["frame"]):
        for index in occurring(column) if len(column) else ():
            found = trace.frames[index][axis]
            if found != form or found == UNKNOWN:
                away |= column == index
    return away


def rests_on_length_in_force(state: State) -> bool:
    """Whether where the tip is rests on the length that was in force when the job started, which no setup gives."""
    return any(symbol.startswith("tool.0.") for each in state.tip for symbol, _ in each.form)


def _why(frame: tuple[Affine, ...], left: tuple[Affine, Affine, Affine]) -> int:
    """START where the axes whose place is open are at, or near, the place of the start."""
    begun = all(
        symbol.startswith("start.") for form, rest in zip(frame, left, strict=False) if rest for symbol, _ in form
    )
    return int(Reason.START if begun else Reason.OFFSET)


def _differ(trace: Trace, axis: int, one: npt.NDArray[np.int32], other: npt.NDArray[np.int32]) -> Bools:
    """Where the unknowns of an axis change along a row."""
    frames = np.zeros(len(trace.frames), dtype=np.int64)
    seen: dict[Affine, int] = {}
    for index, frame in enumerate(trace.frames):
        frames[index] = seen.setdefault(frame[axis], len(seen))
    changed: Bools = frames[one] != frames[other]
    return changed


def _only(chunk: Chunk, row: int) -> Chunk:
    """A chunk of a single row."""
    return Chunk(
        trace=chunk.trace, section=chunk.section, begin=chunk.begin + row,
        start=tuple(chunk.starts()[row].tolist()), start_frame=int(chunk.start_frames()[row]),
        rows=chunk.rows.slice(row, row + 1),
    )  # fmt: skip
