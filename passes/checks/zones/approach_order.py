"""The order of approach: Z is up before a tool is changed, before the way to where that is done, and, where the machine
file requires it, before the first move in X or Y.

``[tool_change] clear_z`` of the machine file is the machine position that Z must have reached. Where it rests on
unknown offsets the answer is a condition on them.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from gproof.ir import codes
from gproof.ir.finding import Findings, Span
from gproof.ir.machine import Machine
from gproof.ir.setup import Setup
from gproof.ir.symbols import describe
from gproof.ir.trace import UNKNOWN, Affine, Chunk, Op, Trace
from gproof.ir.trace_rows import form_interval, row_span, split_form
from gproof.ir.verdict import Condition
from gproof.passes.checks.zones.face_conditions import Ranges
from gproof.passes.checks.zones.zone_check import row_box

ROUNDING = 1e-9
CHANGE, WAY, FIRST = "tool change", "path into the tool change area", "first move in X or Y"

Height = tuple[float, Affine]


class Clearance:
    """Findings GP339 and GP341; ``conditions`` after the last chunk. errors: places that are too low."""

    def __init__(self, machine: Machine, setup: Setup, findings: Findings) -> None:
        self._machine, self._setup, self._findings = machine, setup, findings
        self.errors = 0
        self._clear = machine.tool_change_clearance
        self._area = machine.tool_change_area
        self._begun = not machine.clearance_at_start
        self._asked: dict[Affine, tuple[float, Span, str]] = {}
        self._told: set[str] = set()
        self._trace = Trace()

    def feed(self, chunk: Chunk) -> None:
        """Some successive rows."""
        rows = chunk.rows
        if self._clear is None or not len(rows):
            return
        self._trace = chunk.trace
        before, frames = chunk.starts(), chunk.start_frames()
        across = (rows["op"] < 10) & (
            (rows["to"][:, :2] != before[:, :2]).any(axis=1) | (rows["frame"] != frames) | (rows["op"] == Op.ARC)
        )
        for row in np.flatnonzero(rows["op"] == Op.TOOL_CHANGE).tolist():
            at = float(rows["to"][row, 2]), chunk.trace.frames[int(rows["frame"][row])][2]
            self._judge([at], row_span(chunk.trace, rows, row), CHANGE)
        moves = np.flatnonzero(across)
        if not self._begun and len(moves):
            # A change of frame may be a move of Z alone.
            for row in moves.tolist():
                forms = [chunk.trace.frames[n][:2] for n in (int(frames[row]), int(rows["frame"][row]))]
                stays = forms[0] == forms[1] and (rows["to"][row, :2] == before[row, :2]).all()
                if stays and rows["op"][row] != Op.ARC:
                    continue
                self._judge(self._heights(chunk, row), row_span(chunk.trace, rows, row), FIRST)
                self._begun = True
                break
        if self._area is not None:
            for row in self._ways_in(chunk, moves):
                self._judge(self._heights(chunk, row), row_span(chunk.trace, rows, row), WAY)

    def _heights(self, chunk: Chunk, row: int) -> list[Height]:
        """Z at both ends of a move, of an arc where it is lowest."""
        trace, rows = chunk.trace, chunk.rows
        begin = float(chunk.starts()[row, 2]), trace.frames[int(chunk.start_frames()[row])][2]
        form = trace.frames[int(rows["frame"][row])][2]
        end = float(rows["to"][row, 2])
        if rows["op"][row] == Op.ARC:
            # In the planes of Z an arc may dip between its ends.
            end = min(end, float(row_box(rows, row, chunk.starts()[row])[0][2]))
        return [begin, (end, form)]

    def _ways_in(self, chunk: Chunk, moves: np.ndarray) -> Iterator[int]:
        """Moves from outside the tool change area, seen from above, to a place within it, or perhaps so."""
        assert self._area is not None
        rows, trace = chunk.rows, chunk.trace
        known = np.array([frame[:2] == ((), ()) for frame in trace.frames], dtype=bool)
        off = np.array(["tool_change_area" in state.guards_off for state in trace.states], dtype=bool)
        before = chunk.starts()
        (x0, x1), (y0, y1) = self._area.box[:2]

        def inside(at: np.ndarray) -> np.ndarray:
            return (at[:, 0] > x0) & (at[:, 0] < x1) & (at[:, 1] > y0) & (at[:, 1] < y1)

        frames = known[chunk.start_frames()[moves]] & known[rows["frame"][moves]]
        enters = inside(rows["to"][moves]) & ~inside(before[moves])
        # With the guard on, the area itself is kept clear by ``areas``; with it off, an unknown place may be in it.
        yield from moves[np.where(frames, enters, off[rows["state"][moves]])].tolist()

    def _judge(self, heights: list[Height], span: Span, what: str) -> None:
        assert self._clear is not None
        for value, form in heights:
            if form == ():
                if value < self._clear - ROUNDING:
                    self._low(span, what, value)
                    return
                continue
            low = self._clear - value
            if form not in self._asked or low > self._asked[form][0]:
                self._asked[form] = low, span, what

    def _low(self, span: Span, what: str, z: float) -> None:
        assert self._clear is not None
        self.errors += 1
        self._findings.add(codes.TOOL_CHANGE_TOO_LOW.at(span, what=what, z=z, under=self._clear - z, clear=self._clear))

    def conditions(self, given: Ranges) -> tuple[Condition, ...]:
        """What keeps Z up where it rests on unknowns; given: what is asked of these anyway."""
        out: dict[Affine, Condition] = {}
        if self._clear is None or self.errors:
            return ()
        for form, (low, span, what) in sorted(self._asked.items()):
            stated = None if form == UNKNOWN else form_interval(form, self._setup, self._trace)
            if stated is not None and stated.high < low - ROUNDING:
                self._low(span, what, self._clear - low + stated.high)
                continue
            if stated is not None and stated.low >= low - ROUNDING:
                continue
            arising, rest = ((), ()) if form == UNKNOWN else split_form(form)
            span_of = form_interval(arising, self._setup, self._trace)
            ends = given.get(rest, (-math.inf, math.inf))
            least = math.inf if span_of is None else max(ends[0], low - span_of.low)
            if rest in out:
                least = max(least, out[rest].low)
            if stated is not None or not rest or least > ends[1]:
                self._unknown(span, what, form)
                continue
            out[rest] = Condition(terms=rest, low=least, high=ends[1])
        return tuple(out.values())

    def _unknown(self, span: Span, what: str, form: Affine) -> None:
        cause = describe(form, self._machine)
        if cause not in self._told:
            self._told.add(cause)
            self._findings.add(codes.TOOL_CHANGE_HEIGHT_UNKNOWN.at(span, what=what, clear=self._clear, cause=cause))
