"""Execution: Program + Setup -> Trace, streamed in chunks.

A line is executed by ``passes/blocks.py`` in the order of the manual, its motion by ``passes/motion.py``, its
rows are appended by ``passes/emitter.py``. Straight-line code runs in ``execute_kernels.run_lines``; every
other line comes here.
Errors are findings: the line that has one does nothing more, and execution goes on behind it so that one run
shows all of them; ``stop_at_error`` ends there instead, as the controller would.
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterator

import numpy as np

from gproof.ir import codes
from gproof.ir.columns import Columns
from gproof.ir.finding import Findings, Refusal, Span
from gproof.ir.machine import AXES, Machine
from gproof.ir.program import (
    FLAG_DELETE,
    Assign,
    Block,
    BlockTable,
    Call,
    Device,
    Guard,
    If,
    Message,
    Program,
    Statement,
    Text,
    Unsupported,
    While,
)
from gproof.ir.setup import Setup
from gproof.ir.trace import Chunk, Edge, Op, Trace, TraceSection, Wait
from gproof.passes import execute_kernels as k
from gproof.passes.blocks import Blocks
from gproof.passes.emitter import DEFAULT_BUDGET, ProgramEnd
from gproof.passes.expressions import describe_parts
from gproof.passes.values import Position, Unknown, Value

CHUNK_BYTES = 1 << 20
_UTF8_MARK = b"\xef\xbb\xbf"
MAX_NESTED = 200
"""Blocks within blocks, those of calls counted in; each takes a frame of Python's stack."""

_COLD = np.array([chr(letter) not in "XYZABCIJKRFG" for letter in range(256)])
"""Letters that ``run_lines`` hands back."""


class Executor(Blocks):
    """One run of a program.

    block_delete: lines with a leading slash are skipped. ``met_deleted`` tells afterwards whether there were
    any; ``assumed`` lists what the run took for granted; ``blocks`` counts executed lines.
    """

    def run(self) -> Iterator[Chunk]:
        """Execute; yields chunks in order, the last one of each section with its edges."""
        try:
            yield from self._body(self.program.body)
        except ProgramEnd:
            after = self._end and next((n for n in map(_first_line, self.program.body) if n > self._end[1]), 0)
            if after:
                self._text_after_end(after)
        except Refusal as refusal:
            with contextlib.suppress(ProgramEnd):
                self._fail(refusal.finding)
                self._end_section(Wait.UNKNOWN, refusal.finding.message, -1, refusal.finding.span.line)
        if not self._ended:
            if self.failed is None:
                self.event(Op.END, Span(self.trace.files[self._file], self.program.line_count))
            self.rows.flush(last=True, edges=(Edge(wait=Wait.END, outcome="end", target=-1),))
        yield from self._ready()

    def _text_after_end(self, line: int) -> None:
        """Warn once of code behind an end that every run reaches."""
        if self._end is not None and not self._nesting and not self._depth:
            code, _ = self._end
            self._end = None
            self.findings.add(codes.TEXT_AFTER_END.at(Span(self.trace.files[self._file], line), code=code))

    def _ready(self) -> Iterator[Chunk]:
        ready, self.rows.ready = self.rows.ready, []
        yield from ready

    def _body(self, body: tuple[Statement, ...]) -> Iterator[Chunk]:
        for node in body:
            if isinstance(node, BlockTable):
                yield from self._table(node)
            elif isinstance(node, If):
                self.spend(node.span)
                self._enter(node.span)
                yield from self._body(node.then if self._condition(node.condition) else node.otherwise)
                self._nesting -= 1
            elif isinstance(node, While):
                self._enter(node.span)
                while True:
                    self.spend(node.span)
                    if not self._condition(node.condition):
                        break
                    yield from self._body(node.body)
                self._nesting -= 1
            elif isinstance(node, Call):
                yield from self._called(node)
            else:
                self.spend(node.span)
                self._guarded(node)
            if self.rows.ready:
                yield from self._ready()

    def _enter(self, span: Span) -> None:
        """One block or call deeper; Refusal GP113 when that goes on for too long."""
        if self._nesting >= MAX_NESTED:
            raise Refusal(codes.UNSUPPORTED_CODE.at(span, code=f"a nesting of more than {MAX_NESTED} blocks"))
        self._nesting += 1

    def _condition(self, condition: object) -> bool:
        value = self.evaluator.value(condition)  # type: ignore[arg-type]
        if isinstance(value, Unknown):
            span: Span = condition.span  # type: ignore[attr-defined]
            raise Refusal(codes.UNKNOWN_CONDITION.at(span, cause=value.cause))
        return value != 0

    def _called(self, node: Call) -> Iterator[Chunk]:
        self.spend(node.span)
        sub = self.program.subprograms.get(node.name)
        if sub is None:
            told = any(f.code is codes.UNKNOWN_SUBPROGRAM and f.span == node.span for f in self.findings.kept)
            if not told:
                self._fail(codes.UNKNOWN_SUBPROGRAM.at(node.span, name=node.name))
            return
        if len(self._depth) >= self.program.rules.call_depth:
            chain = " > ".join([*self._depth[-3:], node.name])
            raise Refusal(codes.RECURSION.at(node.span, allowed=self.program.rules.call_depth, chain=chain))
        outer = self._call, self._file
        self._depth.append(node.name)
        name = f"{' > '.join(self._depth)} (from line {node.span.line})"
        if name not in self.trace.calls:
            self.trace.calls.append(name)
        self._call = self.trace.calls.index(name)
        self._enter(node.span)
        yield from self._body(sub.body)
        self._nesting -= 1
        self._depth.pop()
        self._call, self._file = outer

    def _guarded(self, node: Statement) -> None:
        """One statement; a Refusal inside it becomes a finding and the next statement follows."""
        try:
            if isinstance(node, Block):
                self._block(node)
            elif isinstance(node, Message):
                text = describe_parts(node.parts, self.evaluator)
                self.event(Op.MESSAGE, node.span, text=self._text(text))
                if node.kind == "dialog":
                    self._dialog(node)
                if node.kind == "error":
                    self.findings.add(codes.ERROR_MESSAGE.at(node.span, text=text))
                    self._end_section(Wait.OPERATOR, "error message", -1, node.span.line)
                    raise ProgramEnd
            elif isinstance(node, Guard):
                guards = set(self.modal.guards_off) - {node.name} | (set() if node.on else {node.name})
                self.modal.guards_off = tuple(sorted(guards))
                self._state_changed()
                self.event(Op.GUARD, node.span, arg=(float(node.on), 0.0), text=self._text(node.name))
            elif isinstance(node, Device):
                raise Refusal(codes.UNSUPPORTED_CODE.at(node.span, code=node.name))
            elif isinstance(node, Unsupported):
                raise Refusal(codes.UNSUPPORTED_CODE.at(node.span, code=node.what))
        except Refusal as refusal:
            self._fail(refusal.finding)

    def _dialog(self, node: Message) -> None:
        """What the operator typed is not known: the dialog's variables and its answer #5398 (4.2.4)."""
        self.modal.parameters[5398] = Unknown("the answer of a dialog")
        for part in node.parts[1:]:
            if not isinstance(part, Text):
                number = self.evaluator.value(part)
                if isinstance(number, Unknown):
                    raise Refusal(codes.UNKNOWN_CONDITION.at(node.span, cause=number.cause))
                self.modal.write(number, Unknown(f"the operator's answer in #{number:g}"), node.span)
        self._end_section(Wait.OPERATOR, "dialog answered", None, node.span.line)

    # -- straight-line code

    def _table(self, table: BlockTable) -> Iterator[Chunk]:
        self._file = table.file
        run = k.run_lines.pick(table.last_line - table.first_line + 1)
        at, line = table.begin, table.first_line
        while at < table.end:
            words, following, line_after = self.program.load(table, at, line, CHUNK_BYTES)
            if (words["flags"] & FLAG_DELETE).any():
                self.met_deleted = True
                if self.block_delete:
                    keep = (words["flags"] & FLAG_DELETE) == 0
                    words = Columns(words.schema, {n: a[keep] for n, a in words.arrays.items()})
            yield from self._words(table, words, at, run)
            at, line = following, line_after

    def _words(self, table: BlockTable, words: Columns, base: int, run: object) -> Iterator[Chunk]:
        compiled = run is not k.run_lines.python
        line, letter, value = words["line"], words["letter"], words["value"]
        lines = line.tolist() if not compiled else line
        letters = letter.tolist() if not compiled else letter
        values = value.tolist() if not compiled else value
        count, at, cold = len(words), 0, _cold_lines(words)
        while at < count:
            if not cold or int(line[at]) not in cold:
                at = self._hot(run, lines, letters, values, count, at, compiled)
            if at < count and self.rows.count < self.rows.capacity:
                end = at + 1
                here = line[at]
                while end < count and line[end] == here:
                    end += 1
                try:
                    self._cold(table, words, at, end, base)
                except ProgramEnd:
                    if end < count:
                        self._text_after_end(int(line[end]))
                    raise
                at = end
            elif self.rows.count == self.rows.capacity:
                self.rows.flush()
            if self.rows.ready:
                yield from self._ready()

    def _hot(
        self, run: object, line: object, letter: object, value: object, count: int, at: int, compiled: bool
    ) -> int:
        """Run lines in the kernel from word ``at``; returns the first word it left over."""
        s, a = self.modal, self.rows.arrays
        if not self._moved or s.feed_unit != s.unit or not 1 <= s.motion <= 4 or s.feed_mode != 94:
            # The first motion notes what it assumes; a motion mode must be set: Python path.
            return at
        offsets = [s.offset(axis) for axis in range(AXES)]
        ints: object = [
            s.motion, int(s.plane), int(s.absolute), self._frame(), self._state(), self._file, self._call,
            s.feed_mode, 1, int(self.machine.controller.absolute_arc_centers), self._active_axes(),
        ]  # fmt: skip
        floats: object = [s.unit, s.feed, *(p.value for p in s.position), *(o.value for o in offsets)]
        form: object = [self.frames.form(p.form) for p in s.position]
        offset_form: object = [self.frames.form(o.form) for o in offsets]
        if compiled:
            ints, floats = np.array(ints, dtype=np.int64), np.array(floats, dtype=np.float64)
            form, offset_form = np.array(form, dtype=np.int64), np.array(offset_form, dtype=np.int64)
        before = self.rows.count
        at, self.rows.count = run(  # type: ignore[operator]
            line, letter, value, count, at, ints, floats, form, offset_form,
            a["op"], a["file"], a["line"], a["call"], a["to"], a["frame"], a["state"], a["feed"], a["center"],
            a["turns"], a["plane"], before, self.rows.capacity,
        )  # fmt: skip
        self.blocks += self.rows.count - before
        if int(ints[k.MOTION]) != s.motion:  # type: ignore[index]
            s.motion, s.cycle, s.cycle_code = int(ints[k.MOTION]), {}, 0  # type: ignore[index]
        s.feed = float(floats[k.FEED])  # type: ignore[index]
        for axis in range(AXES):
            s.position[axis] = Position(
                float(floats[k.POSITION + axis]),  # type: ignore[index]
                s.position[axis].form,
            )
        return int(at)

    def _active_axes(self) -> int:
        return sum(1 << axis for axis in range(AXES) if self.modal.has_axis(axis))

    def _cold(self, table: BlockTable, words: Columns, begin: int, end: int, base: int) -> None:
        """One plain line in Python."""
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
        values: list[float] = words["value"][begin:end].tolist()
        span = Span(name, number, spans[0].column, spans[-1].end_column)
        self.spend(span)
        self._line(span, list(zip(letters, values, spans, strict=True)))

    def _block(self, node: Block) -> None:
        if node.deleted:
            self.met_deleted = True
            if self.block_delete:
                return
        words = [(w.letter, self.evaluator.value(w.value), w.span) for w in node.words]
        settings = [self._setting(a) for a in node.assigns]
        # Settings take effect once every value of the line is found, before anything moves (3.2.3).
        for number, value, span in settings:
            self.modal.write(number, value, span)
        if words:
            self._line(node.span, words)

    def _setting(self, node: Assign) -> tuple[float, Value, Span]:
        number = self.evaluator.value(node.target.number)
        if isinstance(number, Unknown):
            raise Refusal(codes.UNKNOWN_CONDITION.at(node.target.span, cause=number.cause))
        return number, self.evaluator.value(node.value), node.target.span


def _first_line(node: Statement) -> int:
    return node.first_line if isinstance(node, BlockTable) else node.span.line


def _cold_lines(words: Columns) -> set[int]:
    """Lines with a word that the kernel certainly leaves to the Python path: not worth a call."""
    letter, value = words["letter"], words["value"]
    cold = _COLD[letter]
    g = np.flatnonzero(letter == ord("G"))
    cold[g] = ~np.isin(value[g], (0.0, 1.0, 2.0, 3.0))
    return set(words["line"][cold].tolist())


def _word_end(data: bytes, start: int, column: int, stop: int) -> int:
    """Column behind a word: up to the next one, trailing blanks left out."""
    if stop == 0:
        stop = column + 1
        while start + stop - 1 < len(data) and chr(data[start + stop - 1]) in "0123456789.+- \t":
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


def execute(
    program: Program, setup: Setup, machine: Machine, findings: Findings, *,
    block_delete: bool = False, stop_at_error: bool = False, budget: int = DEFAULT_BUDGET,
) -> Trace:  # fmt: skip
    """The whole Trace at once, for stages that need all of it."""
    ex = Executor(
        program,
        setup,
        machine,
        findings,
        block_delete=block_delete,
        stop_at_error=stop_at_error,
        budget=budget,
    )
    return collect(ex)


def collect(ex: Executor) -> Trace:
    """Run an executor to its end and put its chunks together."""
    from gproof.ir.columns import concatenate
    from gproof.ir.trace import TRACE_ROW

    parts: list[Columns] = []
    first: Chunk | None = None
    for chunk in ex.run():
        first = first or chunk
        parts.append(chunk.rows)
        if chunk.last:
            ex.trace.sections.append(
                TraceSection(
                    number=chunk.section, start=first.start, start_frame=first.start_frame,
                    rows=concatenate(TRACE_ROW, parts), edges=chunk.edges,
                )
            )  # fmt: skip
            parts, first = [], None
    return ex.trace
