"""Straight-line code: tables of plain lines, in the kernel as far as it takes them, else line by line in Python."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from gproof.ir.columns import Columns
from gproof.ir.finding import Span
from gproof.ir.machine import AXES
from gproof.ir.modal_groups import OF_FEEDS
from gproof.ir.program import FLAG_BARE, FLAG_DELETE, BlockTable
from gproof.ir.symbolic import Position, Value
from gproof.ir.trace import TRACE_ROW
from gproof.passes.interpret.core import cutter_compensation_kernels as c
from gproof.passes.interpret.core import line_kernels as k
from gproof.passes.interpret.core import lost_lines
from gproof.passes.interpret.core.call_stack import Frame
from gproof.passes.interpret.core.line_decoder_kernels import SLOTS, LineState, WordColumns, letter_slots, trace_rows
from gproof.passes.interpret.eding import compensation_codes as compensated
from gproof.passes.interpret.eding.line_order import Blocks
from gproof.passes.interpret.eding.outputs_and_waits import CLAMPED
from gproof.passes.interpret.eding.transform_codes import noted

CHUNK_BYTES = 1 << 20
_LETTERS = letter_slots({letter: axis for axis, letter in enumerate("XYZABC")}, "IJKRFGP")
_LETTER_TABLE = np.array(_LETTERS, dtype=np.int64)
"""What words are to ``run_lines``: for plain Python, and compiled."""
_FIRST_BATCH, _BATCH = 4, 1 << 13
"""Programmed rows that are made at once while the path is compensated: few first, as the tool may not follow them."""

_UTF8_MARK = b"\xef\xbb\xbf"


class Straight(Blocks):
    """Executes the lines of a table."""

    def _table(self, frame: Frame) -> None:
        """Go on with the lines of a table until it ends, rows are ready, or a line has called a subprogram."""
        table = frame.node
        assert isinstance(table, BlockTable)
        run = self._manner.kernel.pick(table.last_line - table.first_line + 1)
        while self._stack[-1] is frame and not self.rows.ready:
            if frame.words is None:
                if frame.next_byte >= table.end:
                    self._stack.pop()
                    return
                self._load(frame, table)
            self._words(frame, table, run)

    def _load(self, frame: Frame, table: BlockTable) -> None:
        """The next piece of the table's words."""
        frame.base = frame.next_byte
        words, frame.next_byte, frame.line = self._ahead.load(table, frame.next_byte, frame.line, CHUNK_BYTES)
        if (words["flags"] & FLAG_DELETE).any():
            self.met_deleted = True
            if self.block_delete:
                keep = (words["flags"] & FLAG_DELETE) == 0
                words = Columns(words.schema, {n: a[keep] for n, a in words.arrays.items()})
        frame.words, frame.at = words, 0
        columns = WordColumns(*(words[name] for name in WordColumns._fields))
        kernel = self._manner.kernel
        is_python = kernel.pick(table.last_line - table.first_line + 1) is kernel.python
        frame.columns = WordColumns(*(c.tolist() for c in columns)) if is_python else columns
        frame.cold = self._manner.cold(self, frame, frame.columns, len(words))

    def _words(self, frame: Frame, table: BlockTable, run: object) -> None:
        assert frame.words is not None
        compiled = run is not self._manner.kernel.python
        if compiled and isinstance(frame.columns.line, list):
            # Picked plain when the table was opened, compiled now that it is entered again.
            frame.columns = WordColumns(*(frame.words[name] for name in WordColumns._fields))
        line = frame.words["line"]
        count = len(frame.words)
        while frame.at < count:
            if not frame.cold or int(line[frame.at]) not in frame.cold:
                if self.modal.line_lost:
                    frame.at = lost_lines.run(self, frame, count, frame.at)
                frame.at = self._manner.hot(self, run, frame.columns, count, frame.at, compiled)
            at = frame.at
            if at < count and self.rows.count < self.rows.capacity:
                end, here = at + 1, line[at]
                while end < count and line[end] == here:
                    end += 1
                frame.at = end
                self._cold(table, frame.words, at, end, frame.base)
                if self._stack[-1] is not frame:
                    return
            elif self.rows.count == self.rows.capacity:
                self.rows.flush()
            if self.rows.ready:
                return
        frame.words = None

    def _hot(
        self, run: Any, columns: WordColumns, count: int, at: int, compiled: bool, *, distances: bool = False
    ) -> int:  # fmt: skip
        """Run lines of many commands in the kernel from word ``at``; returns the first word it left over.

        distances: G90 and G91 too, which make no row that would count their blocks, and G4.
        """
        s = self.modal
        if not self._moved or s.feed_unit != s.unit or not 1 <= s.motion <= 4 or s.feed_mode != 94:
            # The first motion notes what it assumes; a motion mode must be set: Python path.
            return at
        if s.compensation is not None:
            return self._along_contour(run, columns, count, at, compiled)
        if not s.plain_motion:
            return at
        state = self._packed([p.value for p in s.position], compiled, distances=distances)
        if not s.arcs_known:
            state.ints[k.ARC_ABSOLUTE] = 1  # which leaves arcs to Python
        at = self.run_kernel(run, columns, state, count, at)
        self._unpack(state)
        if s.unknown_modes & OF_FEEDS:
            s.feed = math.nan
        return at

    def run_kernel(self, run: Any, columns: WordColumns, state: LineState, count: int, at: int) -> int:
        """Run ``run_lines`` on the words from ``at`` to ``count``; returns the first word it left over."""
        rows = self.rows
        before = rows.count
        at, rows.count = _run(run, columns, count, at, state, rows.arrays, before, rows.capacity)
        self.blocks += rows.count - before
        if self.modal.feed_unknown:
            rows.forget_feeds(before)
        return at

    def _along_contour(self, run: Any, columns: WordColumns, count: int, at: int, compiled: bool) -> int:
        """``_hot`` while the path is compensated: rows as programmed, and from them those of the tool."""
        s, rows = self.modal, self.rows
        comp = s.compensation
        if comp is None or not s.plain_contour or not compensated.is_plain(s):
            return at
        a, b = comp.axes
        goal = comp.programmed
        assert goal is not None and comp.radius is not None
        begin = [p.value for p in s.position]
        begin[a], begin[b] = goal[0].value, goal[1].value
        state = self._packed(begin, compiled)
        ints: Any = [a, b, comp.side, int(comp.plane), self._frame(), self._state(), self._file, self._call]
        floats: Any = [
            *(p.value for p in s.position), goal[0].value, goal[1].value, *comp.shift, comp.radius, s.arc_tolerance(),
        ]  # fmt: skip
        batch, going = _FIRST_BATCH, True
        while going:
            there = TRACE_ROW.empty(batch)
            before = _copied(state)
            stop, made = _run(run, columns, count, at, state, there, 0, batch)
            offset = c.offset_rows.pick(made)
            if offset is not c.offset_rows.python:
                ints, floats = np.array(ints, dtype=np.int64), np.array(floats, dtype=np.float64)
            done, row = offset(
                made, trace_rows(there), ints, floats, trace_rows(rows.arrays), rows.count, rows.capacity
            )
            done, rows.count = int(done), int(row)
            if done < made:
                # As far as the tool follows: the lines of these rows once more, from the same state.
                state = before
                if done:
                    stop, _ = _run(run, columns, count, at, state, there, 0, done)
                else:
                    stop = at
            self.blocks += done
            at, going = stop, done == batch
            batch = min(8 * batch, _BATCH)
        self._unpack(state)
        for axis in range(AXES):
            s.position[axis] = Position(float(floats[c.PLACE + axis]), s.position[axis].form)
        u, v = (Position(float(floats[c.GOAL + n]), goal[n].form) for n in (0, 1))
        s.compensation = replace(comp.at(u, v, placed=True), left=(s.position[a], s.position[b]))
        return at

    def _packed(self, position: list[float], compiled: bool, *, distances: bool = False) -> LineState:
        """The state of ``run_lines``: integers, floats, frames of the axes and of their offsets."""
        s = self.modal
        offsets = [s.offset(axis) for axis in range(AXES)]
        ints: object = [
            s.motion, int(s.plane), int(s.absolute), self._frame(), self._state(), self._file, self._call,
            s.feed_mode, 1, int(self.machine.controller.absolute_arc_centers), self._active_axes(), s.transform.kind,
            k.HERE if distances else k.NOT_HERE,
        ]  # fmt: skip
        floats: object = [
            s.unit, s.feed, *position, *(o.value for o in offsets), s.scale(0), *s.transform.numbers,
        ]  # fmt: skip
        form: object = [self.frames.form(p.form) for p in s.position]
        offset_form: object = [self.frames.form(o.form) for o in offsets]
        values: object = [0.0] * SLOTS
        if compiled:
            values = np.zeros(SLOTS)
            ints, floats = np.array(ints, dtype=np.int64), np.array(floats, dtype=np.float64)
            form, offset_form = np.array(form, dtype=np.int64), np.array(offset_form, dtype=np.int64)
        return LineState(ints, floats, form, offset_form, values)

    def _unpack(self, state: LineState) -> None:
        """Take over what ``run_lines`` has made of the state."""
        ints, floats, *_ = state
        s = self.modal
        if int(ints[k.MOTION]) != s.motion:
            s.motion, s.cycle, s.cycle_code = int(ints[k.MOTION]), {}, 0
        s.feed = float(floats[k.FEED])
        if int(ints[k.DISTANCES]) == k.MET:
            s.absolute = bool(ints[k.ABSOLUTE])
            s.stated.add("distance")
        for axis in range(AXES):
            s.position[axis] = Position(float(floats[k.POSITION + axis]), s.position[axis].form)

    def _active_axes(self) -> int:
        held = CLAMPED if self.modal.clamped else -1
        # Words of these take the other way under G51 P: Z, unless it is as it is written and that has been said.
        apart = self.modal.transform.loose if noted(self) else (2, *self.modal.transform.loose)
        return sum(
            1 << axis for axis in range(AXES) if self.modal.has_axis(axis) and axis != held and axis not in apart
        )

    def _cold(self, table: BlockTable, words: Columns, begin: int, end: int, base: int) -> None:
        """One plain line in Python."""
        span, line, bare = self._words_of(table, words, begin, end, base)
        self.spend(span)
        self._manner.line(self, span, line, bare)

    def _words_of(
        self, table: BlockTable, words: Columns, begin: int, end: int, base: int
    ) -> tuple[Span, list[tuple[str, Value, Span]], frozenset[str]]:
        """Words ``begin`` to ``end`` of a piece of a table as a line: its span, its words, letters without a number."""
        name, number = self.trace.files[table.file], int(words["line"][begin])
        data = self.program.files[table.file].data
        offsets = words["offset"][begin:end].tolist()
        first = base + offsets[0]
        start = data.rfind(b"\n", 0, first) + 1
        if start == 0 and data[:3] == _UTF8_MARK:
            start = len(_UTF8_MARK)
        spans = []
        for i, offset in enumerate(offsets, 1):
            column = base + offset - start + 1
            stop = base + offsets[i] - start + 1 if i < len(offsets) else 0
            spans.append(Span(name, number, column, _word_end(data, start, column, stop)))
        before = data[start : start + spans[-1].end_column - 1]
        if not before.isascii():
            spans = [_in_characters(span, before) for span in spans]
        letters = [chr(x) for x in words["letter"][begin:end].tolist()]
        values: list[Value] = words["value"][begin:end].tolist()
        span = Span(name, number, spans[0].column, spans[-1].end_column)
        flags = words["flags"][begin:end].tolist()
        bare = frozenset(letter for letter, flag in zip(letters, flags, strict=True) if flag & FLAG_BARE)
        return span, list(zip(letters, values, spans, strict=True)), bare


def _run(
    run: Any, words: WordColumns, count: int, at: int, state: LineState, rows: Mapping[str, Any], first: int,
    capacity: int,
) -> tuple[int, int]:  # fmt: skip
    """``run_lines`` into ``rows``; (next word, next row)."""
    slots = _LETTERS if isinstance(state.ints, list) else _LETTER_TABLE
    at, row = run(words, count, at, slots, state, trace_rows(rows), first, capacity)
    return int(at), int(row)


def _copied(state: LineState) -> LineState:
    return state._replace(ints=state.ints.copy(), floats=state.floats.copy())


def _word_end(data: bytes, start: int, column: int, stop: int) -> int:
    """Column behind a word: up to the next one, trailing blanks left out."""
    if stop == 0:
        stop = column + 1
        while start + stop - 1 < len(data) and chr(data[start + stop - 1]) in "0123456789.,+- \t":
            stop += 1
    while stop > column + 1 and start + stop - 2 < len(data) and data[start + stop - 2] in b" \t":
        stop -= 1
    return stop


def _in_characters(span: Span, raw: bytes) -> Span:
    """The span of a word in a line that begins with ``raw``: bytes to characters of its encoding."""
    try:
        column, end_column = (len(raw[: at - 1].decode("utf-8")) + 1 for at in (span.column, span.end_column))
    except UnicodeDecodeError:
        return span  # no UTF-8: each byte is a character
    return Span(span.file, span.line, column, end_column)
