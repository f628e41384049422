"""Boundaries: limits of the work, in workspace positions without local coordinates (WinCNC lobound=, hibound=).

WinCNC Users Guide, Soft Limit / Boundaries; L20 to L23.1. A boundary moves with workspace and tool measure, so that a
tool that was measured on the spoil board stays above it, however long it is: where the place of an axis and its
boundary rest on the same unknown, the unknown cancels. Extents are exact, arcs included; a place on a boundary is
inside. The answer belongs to the property ``limits``.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from gproof.ir import codes
from gproof.ir.columns import occurring
from gproof.ir.finding import Findings, Severity, Span
from gproof.ir.machine import AXES, Machine
from gproof.ir.record import record
from gproof.ir.setup import Setup
from gproof.ir.symbolic import add_forms
from gproof.ir.symbols import describe
from gproof.ir.trace import UNKNOWN, UNMEASURED, Affine, Boundary, Chunk, State, Trace
from gproof.ir.trace_rows import form_interval, row_span, split_form
from gproof.ir.verdict import Condition, PropertyResult, Verdict
from gproof.passes.checks.base import KEPT, Check, Like, apart, excluding, no_safe_offset, told_of
from gproof.passes.checks.first_moves import FirstMoves
from gproof.passes.geometry.extent_kernels import Beyond, Extents, boxed_rows, room_beyond, row_boxes
from gproof.passes.geometry.machine_axes import vertical_axes

GUARD = "boundaries"
"""Name of the guard in ``State.guards_off``."""
ROUNDING = 1e-9

Floats = npt.NDArray[np.float64]
Key = tuple[tuple[Boundary, ...], bool, bool]
"""Boundaries of a state, whether their guard is off, and whether low ones of vertical axes do not count yet; open ones
are on their own."""


class _Box:
    """What the rows under one set of boundaries reach, by frame and axis, machine mm."""

    def __init__(self) -> None:
        self.low = np.full((0, AXES), math.inf)
        self.high = np.full((0, AXES), -math.inf)
        self.low_span: dict[tuple[int, int], Span] = {}
        self.high_span: dict[tuple[int, int], Span] = {}

    def grow(self, slots: int) -> None:
        """Room for so many slots."""
        short = slots - len(self.low)
        if short > 0:
            self.low = np.vstack([self.low, np.full((short, AXES), math.inf)])
            self.high = np.vstack([self.high, np.full((short, AXES), -math.inf)])


@record(frozen=True, slots=True)
class _End:
    """A boundary's number, of its axis, and the line that comes nearest to it."""

    axis: int
    limit: float
    span: Span


class _Room:
    """What all rows leave of an unknown offset, mm.

    low, high: between them every row fits, whatever arises in the run; least, most: outside of them some row does not
    for certain, because of the ends ``below`` and ``above``.
    """

    def __init__(self) -> None:
        self.low = self.least = -math.inf
        self.high = self.most = math.inf
        self.below: _End | None = None
        self.above: _End | None = None

    def ask(
        self, ends: tuple[float, float], arising: tuple[float, float], below: _End | None, above: _End | None, *,
        open_: bool = False,
    ) -> None:  # fmt: skip
        """Rows that fit where the offset and what arises, between its two ends, lie between ``ends`` together.

        open_: whether that is asked of them is open: without it they may fit elsewhere too.
        """
        low, high = ends
        self.low, self.high = max(self.low, low - arising[0]), min(self.high, high - arising[1])
        if open_:
            return
        if low - arising[1] > self.least:
            self.least, self.below = low - arising[1], below
        if high - arising[0] < self.most:
            self.most, self.above = high - arising[0], above


class Boundaries(Check):
    """Part of the property ``limits`` on machines that have boundaries."""

    name = "limits"

    def __init__(self, machine: Machine, setup: Setup, findings: Findings) -> None:
        super().__init__(machine, setup, findings)
        self._boxes: dict[Key, _Box] = {}
        self._trace: Trace | None = None
        self._errors = 0
        self._is_open = False
        self._units = {axis.index: axis.unit for axis in machine.axes}
        self._vertical = vertical_axes(machine)
        self._unheld: set[int] = set()
        self._firsts = FirstMoves()
        self._first = Span("", 1)

    def feed(self, chunk: Chunk) -> None:
        """Rows under each set of boundaries that occurs."""
        trace, rows = chunk.trace, chunk.rows
        if self._trace is None:
            self._trace, self._first = trace, Span(trace.files[0], 1)
        if not len(rows):
            return
        self._firsts.feed(chunk)
        self._first = self._firsts.job or self._first
        keys = {key for index in occurring(rows["state"]) for key in _keys(trace.states[index])}
        for key in sorted(keys, key=repr):
            self._walk(chunk, key)

    def _walk(self, chunk: Chunk, key: Key) -> None:
        trace, rows = chunk.trace, chunk.rows
        box = self._boxes.setdefault(key, _Box())
        box.grow(2 * len(trace.frames))
        # Rows under other boundaries go into the second half of the slots, where nothing is beyond.
        others = np.array([key not in _keys(state) for state in trace.states], dtype=np.int64)
        lower, upper = np.full((2, AXES), -math.inf), np.full((2, AXES), math.inf)
        known = np.zeros((len(trace.frames), AXES), dtype=np.uint8)
        for edge in key[0]:
            lower[0, edge.axis] = -math.inf if edge.low is None else edge.low + edge.shift - ROUNDING
            upper[0, edge.axis] = math.inf if edge.high is None else edge.high + edge.shift + ROUNDING
            known[:, edge.axis] = [frame[edge.axis] == edge.form != UNKNOWN for frame in trace.frames]
        low_row, high_row = np.full(box.low.shape, -1, np.int64), np.full(box.low.shape, -1, np.int64)
        count, bad = self._beyond_rows(chunk, others, known, (lower, upper), box, (low_row, high_row), KEPT)
        for slot, axis in zip(*np.nonzero(low_row >= 0), strict=True):
            box.low_span[int(slot), int(axis)] = row_span(trace, rows, int(low_row[slot, axis]))
        for slot, axis in zip(*np.nonzero(high_row >= 0), strict=True):
            box.high_span[int(slot), int(axis)] = row_span(trace, rows, int(high_row[slot, axis]))
        if count > KEPT:
            _, bad = self._beyond_rows(chunk, others, known, (lower, upper), box, (low_row, high_row), count)
        if count:
            row, axes, reach = bad.row[:count], bad.axis[:count], bad.reach[:count]
            under, over = lower[0, axes] - reach, reach - upper[0, axes]
            kinds = np.column_stack([axes, under > over])
            for n, like in told_of(rows, row, kinds, np.maximum(under, over), self.kept):
                if key[0][0].open:
                    edges = trace.states[int(rows["state"][row[n]])].boundaries
                    self._past_open(row_span(trace, rows, int(row[n])), key[0][0], float(reach[n]), edges, like)
                    continue
                self._beyond(row_span(trace, rows, int(row[n])), key, int(axes[n]), float(reach[n]), like)
            if key[2]:
                count -= int((np.isin(axes, self._vertical) & (under > over)).sum())
        if key[0][0].open:
            self._is_open = self._is_open or count > 0
            return
        self._errors += 0 if key[1] else count

    def _beyond_rows(
        self, chunk: Chunk, others: npt.NDArray[np.int64], known: npt.NDArray[np.uint8], ends: tuple[Floats, Floats],
        box: _Box, extremes: tuple[npt.NDArray[np.int64], npt.NDArray[np.int64]], room: int,
    ) -> tuple[int, Beyond]:  # fmt: skip
        """Widen the box by the chunk's rows; how many of them are beyond its ends, and the first of these."""
        bad, start = room_beyond(room), np.array(chunk.start, dtype=np.float64)
        extents = Extents(box.low, box.high, *extremes)
        count = row_boxes.pick(chunk.work)(
            boxed_rows(chunk.rows), others, start, known, *ends, extents, bad, np.zeros((0, 2))
        )
        return int(count), bad

    def _beyond(self, span: Span, key: Key, axis: int, reach: float, like: Like | None = None) -> None:
        """GP330, or GP332 with the guard off: no more than a note where a command of the machine itself goes there."""
        edge = next(edge for edge in key[0] if edge.axis == axis)
        reached = reach - edge.shift
        below = edge.low is not None and reached < edge.low
        limit = edge.low if below else edge.high
        assert limit is not None
        unheld = key[2] and below and axis in self._vertical
        off = key[1] or unheld
        code = codes.BOUNDARY_GUARD_OFF if off else codes.SOFT_LIMIT if edge.limit else codes.BOUNDARY_EXCEEDED
        if unheld:
            self._nothing_holds(span, axis)
        if key[1] and self._trace is not None and span.file in self._trace.macro_files:
            code = code.as_note()
        why: dict[str, Any] = {"why": "with the guard off" if key[1] else "before a tool is measured"} if off else {}
        self.findings.add(
            code.at(
                span, **why, axis=self.machine.word(axis), reached=reached,
                unit=self._units.get(axis, "mm"), over=abs(reached - limit), side="lower" if below else "upper",
                limit=limit,
            ),
            **(like or {}),
        )  # fmt: skip

    def _past_open(
        self, span: Span, edge: Boundary, reach: float, edges: tuple[Boundary, ...], like: Like | None = None
    ) -> None:
        """GP302 for a row past a limit in one reading of it; not where it is past what holds in every reading."""
        for other in edges:
            if other.axis == edge.axis and not other.open and not (other.form or other.shift):
                low = edge.low is not None and other.low is not None and reach < other.low - ROUNDING
                high = edge.high is not None and other.high is not None and reach > other.high + ROUNDING
                if low or high:
                    return
        side = "upper" if edge.low is None else "lower"
        finding = codes.LIMIT_UNKNOWN.at(span, side=side, axis=self.machine.word(edge.axis), hint=edge.open)
        self.findings.add(finding, **(like or {}))

    def _nothing_holds(self, span: Span, axis: int) -> None:
        """GP302, once for an axis: its low boundary does not count yet, and no limit of the machine holds it there."""
        there = next(each for each in self.machine.axes if each.index == axis)
        if there.lower is None and axis not in self._unheld:
            self._unheld.add(axis)
            self.findings.add(codes.LIMIT_UNKNOWN.at(span, side="lower", axis=there.word))

    def finish(self) -> PropertyResult:
        """UNSAFE, UNKNOWN, or SAFE with conditions on unknown offsets."""
        rooms: dict[Affine, _Room] = {}
        for key, box in self._boxes.items():
            if not key[1]:
                for edge in key[0]:
                    self._judge(edge, box, rooms)
        conditions, needed = [], []
        for form, room in sorted(rooms.items(), key=lambda pair: pair[0]):
            low, high = room.low, room.high
            below, above = room.below, room.above
            places = None if below is None else below.span, None if above is None else above.span
            needed.append(Condition(terms=form, low=room.least, high=room.most, places=places))
            if room.least > room.most + 2 * ROUNDING:
                self._refuted(form, room)
            elif low > high + 2 * ROUNDING:
                asked = Condition(terms=form, low=low, high=high, places=places)
                mm = "mm" if room.below is None else self._units.get(room.below.axis, "mm")
                where, hint, related = apart(asked, self.machine, mm, self._first)
                name = describe(form, self.machine)
                cause = f"no {name} keeps the complete job within boundaries"
                self.findings.add(codes.POSITION_UNKNOWN.at(where, axis=name, cause=cause, hint=hint, related=related))
            else:
                low, high = min(low, high), max(low, high)
                if all(coefficient < 0 for _, coefficient in form):
                    # Reported for the offset itself, not of its negative.
                    form, low, high = tuple((symbol, -c) for symbol, c in form), -high, -low
                    places = places[1], places[0]
                conditions.append(Condition(terms=form, low=low, high=high, places=places))
        verdict = Verdict.SAFE
        if self._errors or self.findings.has(Severity.ERROR, (self.name,)):
            verdict = Verdict.UNSAFE
        elif self._is_open or self.findings.has(Severity.UNKNOWN, (self.name,)):
            verdict = Verdict.UNKNOWN
        return PropertyResult(name=self.name, verdict=verdict, conditions=tuple(conditions), needed=tuple(needed))

    def _refuted(self, form: Affine, room: _Room) -> None:
        """GP303: what one boundary asks of an offset and what another one does exclude each other."""
        lower, upper = room.below, room.above
        assert lower is not None and upper is not None
        free = max(0.0, upper.limit - lower.limit)
        mm = self._units.get(lower.axis, "mm")
        asks = f"at least {room.least:.3f} {mm}", f"at most {room.most:.3f} {mm}"
        if all(coefficient < 0 for _, coefficient in form):
            form = tuple((symbol, -c) for symbol, c in form)
            asks = f"at most {-room.least:.3f} {mm}", f"at least {-room.most:.3f} {mm}"
        where, hint, related = excluding(
            (lower.span, f"an offset of {asks[0]} above its lower boundary"),
            (upper.span, f"an offset of {asks[1]} below its upper boundary"),
            self._first,
        )
        self._errors += 1
        self.findings.add(
            codes.NO_SAFE_OFFSET.at(
                where, name=describe(form, self.machine), extent=free + room.least - room.most, unit=mm, room=free,
                hint=hint, related=related,
            )
        )  # fmt: skip

    def _judge(self, edge: Boundary, box: _Box, rooms: dict[Affine, _Room]) -> None:
        """Rows whose place rests on other unknowns than their boundary."""
        assert self._trace is not None
        for slot in range(0, len(box.low), 2):
            least, most = float(box.low[slot, edge.axis]), float(box.high[slot, edge.axis])
            if most < least:
                continue
            form = add_forms(self._trace.frames[slot // 2][edge.axis], edge.form, -1)
            if form == ():
                continue
            word = self.machine.word(edge.axis)
            span = box.high_span[slot, edge.axis]
            if form == UNKNOWN or UNKNOWN in (self._trace.frames[slot // 2][edge.axis], edge.form):
                self._is_open = True
                told = self.findings.has(Severity.UNKNOWN, (self.name, "language")) or self.findings.has(Severity.ERROR)
                if not told:
                    self._unknown(span, word, "something unknown")
                continue
            low = -math.inf if edge.low is None else edge.low + edge.shift - least
            high = math.inf if edge.high is None else edge.high + edge.shift - most
            stated = form_interval(form, self.setup, self._trace)
            if stated is not None:
                if low - ROUNDING <= stated.low and stated.high <= high + ROUNDING:
                    continue
                if edge.open:
                    self._is_open = True
                    below = stated.low < low - ROUNDING
                    span = (box.low_span if below else box.high_span)[slot, edge.axis]
                    self._past_open(span, edge, math.nan, ())
                    continue
                if stated.low < low - ROUNDING:
                    # The move that needs the lower side, not the one that goes highest.
                    span = box.low_span[slot, edge.axis]
                if stated.high < low or stated.low > high:
                    self._errors += 1
                    over = low - stated.high if stated.high < low else stated.low - high
                    reached = least + stated.high - edge.shift if stated.high < low else most + stated.low - edge.shift
                    below = stated.high < low
                    limit = edge.low if below else edge.high
                    self.findings.add(
                        (codes.SOFT_LIMIT if edge.limit else codes.BOUNDARY_EXCEEDED).at(
                            span, axis=word, reached=reached, unit=self._units.get(edge.axis, "mm"), over=over,
                            side="lower" if below else "upper", limit=limit,
                        )
                    )  # fmt: skip
                else:
                    self._unknown(span, word, f"{describe(form, self.machine)}, which may move it past a boundary")
                continue
            if low > high + 2 * ROUNDING and edge.low is not None and edge.high is not None:
                self._errors += 1
                mm = self._units.get(edge.axis, "mm")
                places = box.low_span[slot, edge.axis], box.high_span[slot, edge.axis]
                asked = Condition(terms=form, low=low, high=high, places=places)
                where, hint, related = apart(asked, self.machine, mm, span)
                self.findings.add(
                    no_safe_offset(
                        where, form, self.machine, extent=most - least, unit=mm, room=edge.high - edge.low, hint=hint,
                        related=related,
                    )
                )  # fmt: skip
                continue
            arising, rest = split_form(form)
            bounds = form_interval(arising, self.setup, self._trace) if arising else None
            if arising and (bounds is None or not rest):
                self._unknown(span, word, describe(form, self.machine))
                continue
            room = rooms.setdefault(rest, _Room())
            lowest = None if edge.low is None else _End(edge.axis, edge.low, box.low_span[slot, edge.axis])
            highest = None if edge.high is None else _End(edge.axis, edge.high, box.high_span[slot, edge.axis])
            room.ask(
                (low, high), (0.0, 0.0) if bounds is None else (bounds.low, bounds.high), lowest, highest,
                open_=bool(edge.open),
            )  # fmt: skip

    def _unknown(self, span: Span, axis: str, cause: str) -> None:
        self.findings.add(codes.POSITION_UNKNOWN.at(span, axis=axis, cause=cause))


def _keys(state: State) -> list[Key]:
    """What holds in a state: boundaries, and limits that the program has moved, which have a guard of their own."""
    own = tuple(edge for edge in state.boundaries if not edge.limit)
    held = [edge for edge in state.boundaries if edge.limit and not edge.open]
    moved = tuple(edge for edge in held if edge.low is not None or edge.high is not None)
    found: list[Key] = [(own, GUARD in state.guards_off, UNMEASURED in state.guards_off)] if own else []
    found += [(moved, False, False)] if moved else []
    return [*found, *(((edge,), False, False) for edge in state.boundaries if edge.open)]
