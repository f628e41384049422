"""Soft limits: every position of the path, arcs and helices by their exact extents.

An axis with an unknown offset gives a condition: the range of that offset for which the whole job fits.
Limits: Eding CNC manual 2.1.3 (positive and negative limit), 4.2 (MCAGuard); the answer is a closed interval,
positions on a limit are inside. With the guard off the physical travel decides. What compensations add to an axis,
and what mappings make of it, comes from ``reach`` and ``height_map``: inside a limit, but not certain to stay there
with them, is GP320.
"""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import numpy.typing as npt

from gproof.ir import codes
from gproof.ir.columns import occurring
from gproof.ir.finding import Findings, Severity, Span
from gproof.ir.machine import AXES, AXIS_NAMES, NO_MACHINE, Axis, AxisKind, Machine, Unmodelled
from gproof.ir.setup import Setup
from gproof.ir.symbols import RISEN, UNHOMED, describe
from gproof.ir.trace import HEIGHT_MAP, KNIFE, UNKNOWN, Affine, Chunk, Op, Plane, Trace
from gproof.ir.trace_rows import form_interval, row_span, split_form
from gproof.ir.verdict import Condition, PropertyResult, Verdict
from gproof.passes.checks.base import KEPT, Check, Like, told_of
from gproof.passes.checks.first_moves import FirstMoves
from gproof.passes.checks.limits.machine_limits import with_backlash, with_forced
from gproof.passes.checks.limits.offset_ranges import ROUNDING, OffsetRange, OffsetRanges
from gproof.passes.geometry.extent_kernels import Extents, boxed_rows, room_beyond, row_boxes
from gproof.passes.geometry.height_map import heights_of
from gproof.passes.geometry.motor_limits import Range, reach_of, reaches
from gproof.passes.interpret.core.open_settings import note

Floats = npt.NDArray[np.float64]

FOLLOWED = {
    HEIGHT_MAP: "the height map was measured on the work that is on the table",
    KNIFE: "the knife points along +X where its axis is at 0, turns counter-clockwise, the shorter way, and not in G0",
}
"""What an answer about positions depends on while the controller adds to the path."""
_ACROSS = (Plane.YZ, Plane.XZ, Plane.XY)
"""Of X, Y and Z, the plane whose arcs do not move it by themselves."""
HOMING_HINT = "home the axes before the job, and state homed = [...] in the setup file"
PROGRAMMED = "soft limits are for programmed positions: backlash is added to them (limits_hold)"
HOLD_HINT = 'set limits_hold = "programmed" under [controller] if the controller leaves backlash out there'


def _where_stated(machine: Machine, axis: str, off: bool) -> str:
    """Where limits of an axis are stated; off: the ends of its way."""
    if machine.name == NO_MACHINE.name:
        return "give the machine file with --machine FILE: it has the travel limits"
    keys = "travel_min and travel_max" if off else "min and max"
    return f"state {keys} under [axes.{axis}] of a TOML machine file"


def _is_lost(form: Affine) -> bool:
    """Whether a place is that of an axis that has had no reference run."""
    return any(symbol.startswith(f"{UNHOMED}.") for symbol, _ in form)


class Limits(Check):
    """The property ``limits``; also gathers the box of the job for the summary.

    low, high: (6,) extents in machine coordinates of axes that are known throughout, NaN for others.
    """

    name = "limits"

    def __init__(self, machine: Machine, setup: Setup, findings: Findings) -> None:
        machine = with_forced(machine)
        super().__init__(machine, setup, findings)
        self._low = np.full((2, AXES), math.inf)
        self._high = np.full((2, AXES), -math.inf)
        self._low_span: dict[tuple[int, int], Span] = {}
        self._high_span: dict[tuple[int, int], Span] = {}
        self._judged_states = 0
        self.reaches = reaches(machine, setup)
        self._stated = self._limit_arrays(sure=False)
        self._sure = self._limit_arrays(sure=True)
        own = reach_of(machine, "y")
        self._own_y: Range = (None, None) if own is None else own.sure[False]
        self._told_mapping = False
        self._followed: set[str] = set()
        self._moved = np.zeros(AXES, dtype=bool)
        self._heights = heights_of(setup.height_map)
        self._plain = self._heights is None and all(reach.plain for reach in self.reaches.values())
        self._trace: Trace | None = None
        # Axes that are stated to have had no reference run, for which that is not reported yet.
        self._unhomed = setup.unhomed(machine)
        self._used = [False] * AXES
        self._errors = 0
        self._is_open = False
        self._needed: dict[Affine, Condition] = {}
        self._firsts = FirstMoves()
        self._first: Span | None = None
        self._assumptions: list[str] = []
        self.noted: list[Unmodelled] = []

    def _limit_arrays(self, *, sure: bool) -> tuple[Floats, Floats]:
        """(2, 6) with the guard on and off: what is past for certain, or what is not sure to be inside."""
        lower, upper = np.full((2, AXES), -math.inf), np.full((2, AXES), math.inf)
        for reach in self.reaches.values():
            for guard, (low, high) in enumerate(reach.sure if sure else reach.stated):
                lower[guard, reach.axis.index] = -math.inf if low is None else low - ROUNDING
                upper[guard, reach.axis.index] = math.inf if high is None else high + ROUNDING
        return lower, upper

    def _grow(self, frames: int) -> None:
        short = 2 * frames - len(self._low)
        if short > 0:
            self._low = np.vstack([self._low, np.full((short, AXES), math.inf)])
            self._high = np.vstack([self._high, np.full((short, AXES), -math.inf)])

    def feed(self, chunk: Chunk) -> None:
        """Widen the extents by the chunk's rows; findings for rows beyond known limits."""
        trace, rows = chunk.trace, chunk.rows
        self._firsts.feed(chunk)
        if self._trace is None:
            self._trace = trace
            self._begin(chunk)
        self._first = self._firsts.job or self._first
        if not len(rows):
            return
        if self.setup.cylinder is not None:
            self._mapping(chunk)
        for name in {name for state in trace.states for name in state.following} - self._followed:
            self._followed.add(name)
            if name == HEIGHT_MAP and self.setup.cylinder is not None:
                what = "with Y mapped onto A, Y counts degrees of A, and a height map of X and Y does not fit"
                self.findings.add(codes.HEIGHT_MAP_UNKNOWN.at(row_span(trace, rows, 0), what=what))
            self._assumptions.append(FOLLOWED[name])
        if self._unhomed:
            self._never_homed(chunk)
        self._grow(len(trace.frames))
        self._backlash(trace)
        known = self.known(trace)
        guards = np.array(["machine_area" in s.guards_off for s in trace.states], dtype=np.int64)
        count = self._walk(chunk, known, guards, self._stated, np.zeros((0, 2)))
        self._errors += count
        if count:
            self._all_beyond(chunk, known, guards, count)
        if not self._plain:
            self._compensated(chunk, known, guards)

    def _backlash(self, trace: Trace) -> None:
        """Leave what backlash takes that the program itself sets (WinCNC L8), from here on."""
        new, self._judged_states = trace.states[self._judged_states :], len(trace.states)
        most: dict[int, float] = {}
        for axis, amount in (pair for state in new for pair in state.backlash):
            most[axis] = max(most.get(axis, 0.0), amount)
        axes = tuple(with_backlash(axis, most.get(axis.index, 0.0)) for axis in self.machine.axes)
        if axes == self.machine.axes:
            return
        self.machine = dataclasses.replace(self.machine, axes=axes)
        self.reaches = reaches(self.machine, self.setup)
        self._sure = self._limit_arrays(sure=True)
        self._plain = self._heights is None and all(reach.plain for reach in self.reaches.values())

    def _walk(
        self, chunk: Chunk, known: npt.NDArray[np.uint8], guards: npt.NDArray[np.int64], limits: tuple[Floats, Floats],
        added: Floats, room: int = KEPT,
    ) -> int:  # fmt: skip
        """Widen the extents by the chunk's rows; how many of them are beyond ``limits``."""
        trace, rows = chunk.trace, chunk.rows
        low_row = np.full(self._low.shape, -1, dtype=np.int64)
        high_row = np.full(self._low.shape, -1, dtype=np.int64)
        self._bad = room_beyond(room)
        extents = Extents(self._low, self._high, low_row, high_row)
        start = np.array(chunk.start, dtype=np.float64)
        count = row_boxes.pick(chunk.work)(boxed_rows(rows), guards, start, known, *limits, extents, self._bad, added)
        for slot, axis in zip(*np.nonzero(low_row >= 0), strict=True):
            self._low_span[int(slot), int(axis)] = row_span(trace, rows, int(low_row[slot, axis]))
        for slot, axis in zip(*np.nonzero(high_row >= 0), strict=True):
            self._high_span[int(slot), int(axis)] = row_span(trace, rows, int(high_row[slot, axis]))
        return int(count)

    def _all_beyond(
        self, chunk: Chunk, known: npt.NDArray[np.uint8], guards: npt.NDArray[np.int64], count: int
    ) -> None:
        """Findings for the rows beyond: the first ones, and of each axis and side the furthest for all others."""
        if count > KEPT:
            self._walk(chunk, known, guards, self._stated, np.zeros((0, 2)), count)
        row, axis, reach = (column[:count] for column in self._bad)
        off = guards[chunk.rows["state"][row]]
        under, over = self._stated[0][off, axis] - reach, reach - self._stated[1][off, axis]
        kinds = np.column_stack([axis, off, under > over])
        for n, like in told_of(chunk.rows, row, kinds, np.maximum(under, over), self.kept):
            self._beyond(chunk.trace, chunk, int(row[n]), int(axis[n]), float(reach[n]), like)

    def _compensated(self, chunk: Chunk, known: npt.NDArray[np.uint8], guards: npt.NDArray[np.int64]) -> None:
        """The same rows with what compensation may add to them."""
        added = self._heights.spans(chunk, known) if self._heights is not None else np.zeros((0, 2))
        count = self._walk(chunk, known, guards, self._sure, added)
        if count > KEPT:
            self._walk(chunk, known, guards, self._sure, added, count)
        # An axis that is still where it was when the job started is not the fault of the job.
        since = self._first_moves(chunk)[self._bad.axis[:count]]
        for n in np.flatnonzero(self._bad.row[:count] >= since)[: self.kept].tolist():
            row, index, reach = int(self._bad.row[n]), int(self._bad.axis[n]), float(self._bad.reach[n])
            axis = self.reaches[AXIS_NAMES[index]]
            off = "machine_area" in chunk.trace.states[int(chunk.rows["state"][row])].guards_off
            (low, high), inner = axis.stated[off], axis.sure[off][0]
            below = inner is not None and reach < inner
            limit = low if below else high
            assert limit is not None
            span = 0.0 if index != 2 or not len(added) else float(added[row, 0 if below else 1])
            plain = reach - span
            if (limit - plain if below else plain - limit) > ROUNDING:
                continue  # reported already, as an error
            if span and self._heights is not None and self._lifted_beyond(chunk, row, limit, below):
                continue
            what = " and ".join(w for w in (axis.what, "the height map" if span else "") if w)
            self.findings.add(
                codes.MOTOR_LIMIT.at(
                    row_span(chunk.trace, chunk.rows, row), axis=axis.axis.word, reached=plain,
                    unit=axis.axis.unit, side="lower" if below else "upper", limit=limit, what=what,
                    hint=HOLD_HINT if axis.what == "backlash compensation" and not off else "",
                )
            )  # fmt: skip

    def _first_moves(self, chunk: Chunk) -> npt.NDArray[np.int64]:
        """(6,): the chunk's first row at whose end an axis has moved since the job started; its length when none."""
        rows = chunk.rows
        moved = rows["to"] != np.array(self._start)
        moved[:, :3] |= (rows["op"] == Op.ARC)[:, np.newaxis]
        used = [chunk.trace.frames[frame] for frame in occurring(rows["frame"])]
        for index in range(AXES):
            if all(frame[index] == self._start_forms[index] for frame in used):
                continue
            others = np.array([frame[index] != self._start_forms[index] for frame in chunk.trace.frames], dtype=bool)
            moved[:, index] |= others[rows["frame"]]
        if self._heights is not None:
            moved[:, 2] = True  # Z goes up and down with X and Y
        moved[:1] |= self._moved
        self._moved |= moved.any(axis=0)
        return np.where(moved.any(axis=0), np.argmax(moved, axis=0), len(rows))

    def _lifted_beyond(self, chunk: Chunk, row: int, limit: float, below: bool) -> bool:
        """GP301 when the row's end, with the height that is known there, is past the limit for certain."""
        assert self._heights is not None
        x, y, z = (float(v) for v in chunk.rows["to"][row][:3])
        reached = z + self._heights.at(x, y)
        frame = chunk.trace.frames[int(chunk.rows["frame"][row])]
        if frame[:3] != ((), (), ()) or (limit - reached if below else reached - limit) <= ROUNDING:
            return False
        self._errors += 1
        self.findings.add(
            codes.SOFT_LIMIT.at(
                row_span(chunk.trace, chunk.rows, row), axis="Z", reached=reached, unit="mm",
                over=abs(reached - limit), side="lower" if below else "upper", limit=limit,
                hint=f"check the height map: it is added to Z{z:.3f}",
            )
        )  # fmt: skip
        return True

    def _never_homed(self, chunk: Chunk) -> None:
        """GP304 at the first move of an axis whose machine positions are unknown: no limit is watched there."""
        rows, starts, frames = chunk.rows, chunk.starts(), chunk.start_frames()
        goes = rows["op"] <= Op.PROBE
        for axis in sorted(self._unhomed):
            there = self.machine.axis(AXIS_NAMES[axis])
            if there is not None and self._endless(axis, there):
                continue  # one that turns without end may be anywhere
            symbol = f"{UNHOMED}.{AXIS_NAMES[axis]}"
            forms = [frame[axis] for frame in chunk.trace.frames]
            lost = np.array([any(name == symbol for name, _ in form) for form in forms], dtype=bool)
            kinds = np.array([forms.index(form) for form in forms])
            moves = (rows["to"][:, axis] != starts[:, axis]) | (kinds[rows["frame"]] != kinds[frames])
            if axis < 3:
                moves |= (rows["op"] == Op.ARC) & (rows["plane"] != _ACROSS[axis])
            found = np.flatnonzero(goes & moves & lost[rows["frame"]])
            if len(found):
                self._unhomed -= {axis}
                known = self.machine.axis(AXIS_NAMES[axis])
                cause = describe(((symbol, 1),), self.machine)
                where = row_span(chunk.trace, rows, int(found[0]))
                word = AXIS_NAMES[axis].upper() if known is None else known.word
                self.findings.add(codes.POSITION_UNKNOWN.at(where, axis=word, cause=cause, hint=HOMING_HINT))

    def _begin_mapping(self) -> None:
        """GP321 for what a mapping of Y onto A needs and the setup does not give."""
        self._assumptions.append("Y is mapped onto A for the complete job; times are those of the flat drawing")
        cylinder = self.setup.cylinder
        assert cylinder is not None and self._first is not None
        missing = [
            what
            for what, lacks in (
                ("the setup file gives no radius of the cylinder", cylinder.radius is None),
                ("the setup file gives no Y of the axis of rotation", cylinder.y is None),
                ("the machine has no axis A", "a" not in self.reaches),
            )
            if lacks
        ]
        if cylinder.y is not None:
            low, high = self._own_y
            if (low is not None and cylinder.y < low - ROUNDING) or (high is not None and cylinder.y > high + ROUNDING):
                self._errors += 1
                where = self.findings.where("setup.cylinder.y", self._first)
                self.findings.add(codes.START_OUTSIDE_LIMITS.at(where, axis="Y", value=cylinder.y, unit="mm"))
        for what in missing:
            self.findings.add(codes.MAPPED_AXIS.at(self.findings.where("setup.cylinder", self._first), what=what))

    def _mapping(self, chunk: Chunk) -> None:
        """GP321 when the program turns A by itself while Y does."""
        rows = chunk.rows
        before, frames = chunk.starts()[:, 3], chunk.start_frames()
        forms = chunk.trace.frames
        pairs, which = np.unique(np.stack([rows["frame"], frames]), axis=1, return_inverse=True)
        other = np.array([forms[a][3] != forms[b][3] for a, b in pairs.T.tolist()], dtype=bool)
        turns = (rows["op"] < 10) & ((rows["to"][:, 3] != before) | other[which.reshape(-1)])
        if turns.any() and not self._told_mapping:
            self._told_mapping = True
            where = row_span(chunk.trace, rows, int(np.argmax(turns)))
            self.findings.add(codes.MAPPED_AXIS.at(where, what="the program turns A itself"))

    def _begin(self, chunk: Chunk) -> None:
        self._start = chunk.start
        self._start_forms = chunk.trace.frames[chunk.start_frame]
        self._first = self._firsts.job or Span(chunk.trace.files[0], 1)
        if self.setup.cylinder is not None:
            self._begin_mapping()
        for reach in self.reaches.values():
            axis, (low, high) = reach.axis, reach.stated[False]
            at, form = chunk.start[axis.index], self._start_forms[axis.index]
            below = low is not None and at < low - ROUNDING
            above = high is not None and at > high + ROUNDING
            if form == () and (below or above):
                where = self.findings.where(f"setup.start.{axis.word.lower()}", self._first)
                self.findings.add(codes.START_OUTSIDE_LIMITS.at(where, axis=axis.word, value=at, unit=axis.unit))
                self._errors += 1

    def _beyond(
        self, trace: Trace, chunk: Chunk, row: int, index: int, reach: float, like: Like | None = None
    ) -> None:  # fmt: skip
        axis = self.reaches[AXIS_NAMES[index]].axis
        off = "machine_area" in trace.states[int(chunk.rows["state"][row])].guards_off
        low, high = self.reaches[axis.name].stated[off]
        below = low is not None and reach < low
        limit = low if below else high
        assert limit is not None
        side = ("travel's lower" if off else "lower") if below else ("travel's upper" if off else "upper")
        if below and self._is_forced(index, limit):
            where = row_span(trace, chunk.rows, row)
            self.findings.add(
                codes.FORCED_LIMIT_EXCEEDED.at(
                    where, axis=axis.word, reached=reach, unit=axis.unit, over=limit - reach, side="lower", limit=limit
                ),
                **(like or {}),
            )
            return
        bounds = [(d.name, (d.travel_lower, d.travel_upper) if off else (d.lower, d.upper)) for d in axis.drives()]
        own, second = bounds[0][1], next((name for name, sides in bounds[1:] if limit in sides), "")
        self.findings.add(
            codes.SOFT_LIMIT.at(
                row_span(trace, chunk.rows, row), axis=axis.word, reached=reach, unit=axis.unit,
                over=abs(reach - limit), side=side, limit=limit,
                hint=f"check the travel limit of its motor {second}" if second and limit not in own else "",
            ),
            **(like or {}),
        )  # fmt: skip

    def _is_forced(self, index: int, limit: float) -> bool:
        """Whether a lower limit is a forced one."""
        forced = self.machine.settings.forced
        return forced is not None and index < len(forced) and forced[index][0] == limit

    def finish(self) -> PropertyResult:
        """SAFE, with conditions on unknown offsets; UNSAFE; or UNKNOWN when a limit or a position is."""
        if self._trace is None:
            return PropertyResult(name=self.name, verdict=Verdict.SAFE)
        offsets: dict[Affine, OffsetRange] = {}
        for index in range(AXES):
            self._judge_lost(index)
            if self._moves(index):
                self._note_settings(AXIS_NAMES[index])
                self._judge_axis(index, offsets)
        if self.machine.controller.limits_hold == "programmed" and any(
            self._moves(axis.index) and any(drive.backlash for drive in axis.drives()) for axis in self.machine.axes
        ):
            self._assumptions.append(PROGRAMMED)
        judged = OffsetRanges(self._trace, self.machine, self.setup, self.findings, self._first)
        results = judged.conditions(offsets)
        self._errors += judged.errors
        self._assumptions += judged.assumptions
        needed = tuple(self._needed[form] for form in sorted(self._needed))
        verdict = Verdict.SAFE
        if self._errors or self.findings.has(Severity.ERROR, (self.name,)):
            verdict = Verdict.UNSAFE
        elif self._is_open or self.findings.has(Severity.UNKNOWN, (self.name,)):
            verdict = Verdict.UNKNOWN
        return PropertyResult(
            name=self.name, verdict=verdict, assumptions=tuple(self._assumptions), conditions=results, needed=needed
        )

    def _note_settings(self, name: str) -> None:
        """GP605 for settings that make the place of this axis, or of every one, unknown once it moves."""
        for setting in self.machine.not_modelled:
            if setting not in self.noted and (setting.axis == name or setting.touches in ("moves", "limits")):
                note(setting, self.machine, self.findings)
                self.noted.append(setting)

    def _moves(self, index: int) -> bool:
        """True when any row brings the axis to a place that is not that of the start, as far as that is known."""
        assert self._trace is not None
        for slot in range(len(self._low)):
            if self._high[slot, index] < self._low[slot, index]:
                continue
            form = self._trace.frames[slot // 2][index]
            if form == UNKNOWN:
                continue
            moved = self._low[slot, index] != self._high[slot, index] or self._low[slot, index] != self._start[index]
            if form != self._start_forms[index] or moved:
                return True
        return False

    def _judge_lost(self, index: int) -> None:
        """GP304 for an axis whose path is unknown, unless its cause is reported."""
        assert self._trace is not None
        for slot in range(len(self._low)):
            there = self._low[slot, index] <= self._high[slot, index]
            if not there or self._trace.frames[slot // 2][index] != UNKNOWN:
                continue
            self._is_open = True
            if self.findings.has(Severity.UNKNOWN, (self.name,)) or self.findings.has(Severity.ERROR):
                continue
            known = self.reaches.get(AXIS_NAMES[index])
            word = AXIS_NAMES[index].upper() if known is None else known.axis.word
            where = self._low_span[slot, index]
            self.findings.add(codes.POSITION_UNKNOWN.at(where, axis=word, cause="something unknown"))

    def _judge_axis(self, index: int, offsets: dict[Affine, OffsetRange]) -> None:
        assert self._trace is not None and self._first is not None
        name = AXIS_NAMES[index]
        known = self.reaches.get(name)
        axis = None if known is None else known.axis
        word = name.upper() if axis is None else axis.word
        if axis is not None and self._endless(index, axis):
            self._assumptions.append(f"{word} turns without end and has no travel limits")
            return
        told: set[bool] = set()
        for slot in range(len(self._low)):
            least, most = float(self._low[slot, index]), float(self._high[slot, index])
            if most < least:
                continue
            form, off = self._trace.frames[slot // 2][index], slot % 2 == 1
            if form == UNKNOWN or _is_lost(form):
                continue  # reported already, or at its first move
            low, high = self._sides(axis, off)
            if off and axis is not None:
                low, high = self._guard_off(axis, form, slot, least, most)
            missing = [side for side, limit in (("lower", low), ("upper", high)) if limit is None]
            missing = [side for side in missing if not self._is_bounded(index, side)]
            if missing and off not in told:
                told.add(off)
                what = ("physical " if off else "") + " or ".join(missing)
                where = self._low_span if missing[0] == "lower" else self._high_span
                lost = "add the axis to the machine file: it is not there"
                hint = lost if axis is None else _where_stated(self.machine, name, off)
                code = codes.LIMIT_WITHOUT_MACHINE if self.machine.name == NO_MACHINE.name else codes.LIMIT_UNKNOWN
                self.findings.add(code.at(where[slot, index], side=what, axis=word, hint=hint))
            if form == () or axis is None:
                continue
            room = -math.inf if low is None else low - least, math.inf if high is None else high - most
            if not off:
                self._need(axis, form, slot)
            first = self._firsts.of_frame(slot // 2) or self._low_span[slot, index]
            offset = offsets.setdefault(form, OffsetRange(axis, first))
            offset.within(room, least, most, (self._low_span[slot, index], self._high_span[slot, index]))
        form, at = self._start_forms[index], float(self._start[index])
        if axis is not None and form not in ((), UNKNOWN) and not _is_lost(form):
            # The path starts at the start: what GP306 says of a stated one is a condition on an unknown one.
            low, high = self.reaches[axis.name].stated[False]
            room = -math.inf if low is None else low - at, math.inf if high is None else high - at
            offset = offsets.setdefault(form, OffsetRange(axis, self._first))
            offset.within(room, at, at, (self._first, self._first))

    def _endless(self, index: int, axis: Axis) -> bool:
        """Whether an axis turns and its machine's file gives it no limit of any kind: it may go to any position."""
        assert self._trace is not None
        if axis.kind is not AxisKind.ROTARY or self.machine.axes == NO_MACHINE.axes:
            return False
        ends = {getattr(d, end) for d in axis.drives() for end in ("lower", "upper", "travel_lower", "travel_upper")}
        edges = (edge for state in self._trace.states for edge in state.boundaries if edge.axis == index)
        held = any(edge.low is not None or edge.high is not None for edge in edges)
        return ends == {None} and not held

    def _need(self, axis: Axis, form: Affine, slot: int) -> None:
        """The rows of a slot, with the guard on: outside of what they leave a limit is passed for certain."""
        assert self._trace is not None
        least, most = float(self._low[slot, axis.index]), float(self._high[slot, axis.index])
        arising, rest = split_form(form)
        span = form_interval(arising, self.setup, self._trace)
        if span is None or not rest or not self._plain or self.setup.cylinder is not None:
            return
        lower, upper = self.reaches[axis.name].stated[False]
        low = -math.inf if lower is None else lower - least - span.high
        high = math.inf if upper is None else upper - most - span.low
        places = self._low_span[slot, axis.index], self._high_span[slot, axis.index]
        asked = Condition(terms=rest, low=low, high=high, places=places)
        self._needed[rest] = asked.within(self._needed[rest]) if rest in self._needed else asked

    def _is_bounded(self, index: int, side: str) -> bool:
        """Whether a boundary holds the axis on this side in every state: ``boundaries`` then judges it."""
        assert self._trace is not None
        for state in self._trace.states:
            ends = [edge.low if side == "lower" else edge.high for edge in state.boundaries if edge.axis == index]
            if not any(end is not None for end in ends) or "boundaries" in state.guards_off:
                return False
        return bool(self._trace.states)

    def _guard_off(
        self, axis: Axis, form: Affine, slot: int, least: float, most: float
    ) -> tuple[float | None, float | None]:
        """What holds with the guard off: the soft limit as far as the path stays within it, then the travel.

        A crossing is always reported (GP307). Where the offset is unknown, the travel, or the soft limit where
        the travel is unknown.
        """
        sides: list[float | None] = []
        (lower, upper), (travel_lower, travel_upper) = self.reaches[axis.name].sure
        for side, reach, soft, travel, sign in (
            ("lower", least, lower, travel_lower, -1.0), ("upper", most, upper, travel_upper, 1.0)
        ):  # fmt: skip
            if form != ():
                sides.append(soft if travel is None else travel)
                continue
            if soft is None or sign * (reach - soft) <= ROUNDING:
                sides.append(travel if soft is None else soft)
                continue
            if side == "lower" and self._is_forced(axis.index, soft):
                sides.append(travel)
                continue
            where = self._low_span if side == "lower" else self._high_span
            self.findings.add(
                codes.SOFT_LIMIT_GUARD_OFF.at(
                    where[slot, axis.index],
                    axis=axis.word,
                    reached=reach,
                    unit=axis.unit,
                    side=side,
                    limit=soft,
                )
            )
            sides.append(travel)
        return sides[0], sides[1]

    def _sides(self, axis: Axis | None, off: bool) -> Range:
        """What the axis may surely use; with offsets unknown, what they may make it use."""
        return (None, None) if axis is None else self.reaches[axis.name].sure[off]

    def extents(self) -> list[tuple[int, Affine, float, float]]:
        """(axis, unknown offsets the numbers are relative to, low, high) of each axis that moves."""
        out: list[tuple[int, Affine, float, float]] = []
        if self._trace is None:
            return out
        for index in range(AXES):
            if not self._moves(index):
                continue
            by_form: dict[Affine, list[float]] = {}
            for slot in range(len(self._low)):
                least, most = float(self._low[slot, index]), float(self._high[slot, index])
                if most < least:
                    continue
                form = self._trace.frames[slot // 2][index]
                if any(symbol.startswith(f"{RISEN}.") for symbol, _ in form):
                    continue  # the greater of two places that are here themselves
                arose = tuple(term for term in form if term[0] in self._trace.symbols)
                if arose:
                    # What arose in the run and is bounded shows as all the places it may mean.
                    known = form_interval(arose, self.setup, self._trace)
                    assert known is not None
                    form = tuple(term for term in form if term not in arose)
                    least, most = least + known.low, most + known.high
                seen = by_form.setdefault(form, [math.inf, -math.inf])
                seen[0], seen[1] = min(seen[0], least), max(seen[1], most)
            out += [(index, form, least, most) for form, (least, most) in by_form.items()]
        return out

    def box(self) -> list[tuple[str, str, float, float]]:
        """The same for the summary: (letter of the axis, what the numbers are relative to, low, high)."""
        return [
            (self.machine.word(n).lower(), describe(form, self.machine), low, high)
            for n, form, low, high in self.extents()
        ]
