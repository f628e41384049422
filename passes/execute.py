"""Execution: Program + Setup -> Trace, streamed in chunks.

A line is executed by ``passes/blocks.py`` in the order of the manual, its motion by ``passes/motion.py``, its
rows are appended by ``passes/emitter.py``. Straight-line code runs in ``execute_kernels.run_lines``; every
other line comes here.
Errors are findings: the line that has one does nothing more, and execution goes on behind it so that one run
shows all of them; ``stop_at_error`` ends there instead, as the controller would.
"""

from __future__ import annotations

import contextlib
import copy
from collections.abc import Iterable, Iterator
from typing import Any

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
    DeferredBlock,
    Device,
    Expr,
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
from gproof.passes.commands import run_command
from gproof.passes.compiled import FALLS_BACK, Condition, FastBlock, compile_block, compile_condition
from gproof.passes.emitter import DEFAULT_BRANCHES, DEFAULT_BUDGET, ProgramEnd
from gproof.passes.expressions import describe_parts
from gproof.passes.frames import EXACT, Caller, Frame, Group, Path, Pending, merged
from gproof.passes.knife import follow_knife
from gproof.passes.outputs import CLAMPED
from gproof.passes.overrides import Words, replaced
from gproof.passes.values import Position, Unknown, Value

_ONCE = FastBlock(lambda _: (), (), (), (), False, None)  # type: ignore[arg-type]
"""A block that was executed once."""
CHUNK_BYTES = 1 << 20
PENDING_LINES = 1 << 14
"""Lines of motion that wait at most before they are executed together."""
_UTF8_MARK = b"\xef\xbb\xbf"
MAX_NESTED = 200
"""Blocks within blocks, those of calls counted in; each takes a frame of Python's stack."""

_COLD = np.array([chr(letter) not in "XYZABCIJKRFG" for letter in range(256)])
"""Letters that ``run_lines`` hands back."""


class Executor(Blocks):
    """One run of a program.

    What is still to do is a stack of frames, not Python's own: where a condition rests on what nobody knows before the
    job runs (an answer, an input, a probe contact), the run splits, each outcome goes on with its own stack and state
    in a section of its own, and outcomes that come back to the same place in the same state are joined.
    block_delete: lines with a leading slash are skipped. ``met_deleted`` tells afterwards whether there were
    any; ``assumed`` lists what the run took for granted; ``blocks`` counts executed lines; ``branches`` counts
    outcomes that were followed.
    """

    def run(self) -> Iterator[Chunk]:
        """Execute; yields chunks of successive rows, the last one of each section with its edges."""
        self.branches = 0
        self._seen: dict[object, tuple[Edge, ...]] = {}
        self._joins: dict[object, int] = {}
        self._waiting: list[Path] = []
        self._fast: dict[int, FastBlock | None] = {}
        self._tests: dict[int, Condition | None] = {}
        self._pending = Pending()
        self._key: object = None
        self._loops = 0
        self._stack: list[Frame] = [Frame(self.program.body)]
        while True:
            self._is_parked = False
            yield from self._path()
            yield from self._ready()
            if not self._is_parked:
                self._arrived(self._stack, 1)
                yield from self._ready()
            if not self._waiting:
                return
            self._resume(self._waiting.pop())

    def _path(self) -> Iterator[Chunk]:
        """Run what is on the stack to its end."""
        try:
            while self._stack:
                self._step()
                if self.rows.ready:
                    yield from self._ready()
            self._run_pending()
        except ProgramEnd:
            self._warn_after_end()
        except Refusal as refusal:
            with contextlib.suppress(ProgramEnd):
                self._run_pending()
                self._fail(refusal.finding)
                self._end_section(Wait.UNKNOWN, refusal.finding.message, -1, refusal.finding.span.line)
        if not self._ended:
            if self.failed is None:
                self.event(Op.END, Span(self.trace.files[self._file], self.program.line_count))
            self._close((Edge(wait=Wait.END, outcome="end", target=-1),))

    def _resume(self, path: Path) -> None:
        """Take up an outcome that waits."""
        self.modal, self._stack = path.modal, path.stack
        self._pending = Pending()
        self._loops = sum(isinstance(frame.node, While) for frame in self._stack)
        self._file, self._call, self._depth, self._moved, self._nesting = path.place
        self._end = None
        self._state_changed()
        self._begin(path.section)

    def _warn_after_end(self) -> None:
        """Warn once of code behind an end that every run reaches."""
        frame = self._stack[-1]
        in_table = isinstance(frame.node, BlockTable)
        if self._end is None or len(self._stack) > 1 + in_table or self.branches:
            return
        (code, line), self._end = self._end, None
        if in_table and (after := frame.next_line()):
            self._text_after_end(code, after)
            return
        for node in self.program.body:
            if _first_line(node) > line:
                self._text_after_end(code, _first_line(node))
                return

    def _text_after_end(self, code: str, line: int) -> None:
        self.findings.add(codes.TEXT_AFTER_END.at(Span(self.trace.files[self._file], line), code=code))

    def _ready(self) -> Iterator[Chunk]:
        ready, self.rows.ready = self.rows.ready, []
        yield from ready

    def _step(self) -> None:
        """The next statement of the innermost frame, or its end."""
        frame = self._stack[-1]
        if isinstance(frame.node, BlockTable):
            self._table(frame)
            return
        if frame.at == len(frame.body):
            self._leave(frame)
            return
        node = frame.body[frame.at]
        frame.at += 1
        kind = type(node)
        if kind is BlockTable:
            assert isinstance(node, BlockTable)
            self._run_pending()
            self._file = node.file
            self._stack.append(Frame((), node, next_byte=node.begin, line=node.first_line))
        elif kind is If:
            assert isinstance(node, If)
            self._if(node)
        elif kind is While:
            assert isinstance(node, While)
            self._enter(node.span)
            self._loops += 1
            self._stack.append(Frame(node.body, node, len(node.body)))
        elif kind is Call:
            assert isinstance(node, Call)
            self.spend(node.span)
            self._called(node.name, node.span)
        else:
            assert not isinstance(node, BlockTable)
            is_block = isinstance(node, Block)
            again = is_block and (self._loops or self._depth)
            if not again or not self._fast_block(node):  # type: ignore[arg-type]
                node = node.made() if isinstance(node, DeferredBlock) else node
                self._run_pending()
                self.spend(node.span)
                self._guarded(node)

    def _leave(self, frame: Frame) -> None:
        """A frame is done: again, for a loop whose condition holds; else back to the one around it."""
        node = frame.node
        if isinstance(node, While):
            self.spend(node.span)
            holds = self._holds(node.condition, ("while", id(node)))
            if holds is None:
                self._split(node, frame)
                return
            if holds:
                frame.at = 0
                return
        self._stack.pop()
        self._loops -= isinstance(node, While)
        if node is not None:
            self._nesting -= 1
        if isinstance(frame.caller, Caller):
            self._run_pending()
            self._call, self._file = frame.caller.call, frame.caller.file
            self._depth = self._depth[:-1]
            if frame.caller.rest is not None:
                super()._line(*frame.caller.rest)
        if frame.group is not None:
            self._await_others(frame.group)

    def _if(self, node: If) -> None:
        self.spend(node.span)
        self._enter(node.span)
        holds = self._holds(node.condition, ("if", id(node)))
        if holds is None:
            self._split(node, None)
        else:
            self._stack.append(Frame(node.then if holds else node.otherwise, node))

    def _enter(self, span: Span) -> None:
        """One block or call deeper; Refusal GP113 when that goes on for too long."""
        if self._nesting >= MAX_NESTED:
            raise Refusal(codes.UNSUPPORTED_CODE.at(span, code=f"a nesting of more than {MAX_NESTED} blocks"))
        self._nesting += 1

    # -- conditions that nobody can decide before the job runs

    def _holds(self, condition: Expr, place: tuple[str, int]) -> bool | None:
        """Whether a condition is true; None when the outcomes are to be explored. ProgramEnd where that is done."""
        known = self._fast_condition(condition)
        if known is not None:
            return known != 0
        self._run_pending()
        value = self.evaluator.value(condition)
        if not isinstance(value, Unknown):
            return value != 0
        if value.low > 0 or value.high < 0:
            return True
        key = self._state_key(place)
        if key in self._seen:
            # The same question in the same state: its outcomes are followed already.
            self._close(self._seen[key])
            raise ProgramEnd
        if self.branches + 2 > self.max_branches:
            hint = "--max-branches follows more outcomes" if self.max_branches else ""
            raise Refusal(codes.UNKNOWN_CONDITION.at(condition.span, cause=value.cause, hint=hint))
        self._key = key
        return None

    def _state_key(self, place: object) -> object:
        stack = tuple((id(f.body), f.at, id(f.node), f.position()) for f in self._stack)
        return place, stack, tuple(self._depth), self.modal.key()

    def _split(self, node: If | While, loop: Frame | None) -> None:
        """Follow the outcome "true" now and "false" later, each in a section of its own."""
        self.branches += 2
        yes, no = self.rows.new_section(), self.rows.new_section()
        edges = tuple(
            Edge(wait=Wait.BRANCH, outcome=outcome, target=target, line=node.span.line)
            for outcome, target in (("true", yes), ("false", no))
        )
        self._seen[self._key] = edges
        self._close(edges)
        if loop is not None and loop.group is None:
            loop.group = Group(1)
        for frame in self._stack:
            if frame.group is not None:
                frame.group.open += 1
        other = [copy.copy(frame) for frame in self._stack]
        if loop is None:
            assert isinstance(node, If)
            group = Group(2)
            self._stack.append(Frame(node.then, node, group=group))
            other.append(Frame(node.otherwise, node, group=group))
            nesting = self._nesting
        else:
            loop.at = 0
            other[-1] = Frame((), group=loop.group)
            nesting = self._nesting - 1
        place = self._file, self._call, list(self._depth), self._moved, nesting
        self._waiting.append(Path(other, self.modal.copy(), no, place))
        self._begin(yes)

    def _await_others(self, group: Group) -> None:
        """Behind a block whose outcomes are explored: wait for the others, unless somebody was here in this state."""
        self._run_pending()
        key = self._state_key("join")
        target = self._joins.get(key)
        if target is None:
            target = self._joins[key] = self.rows.new_section()
            place = self._file, self._call, list(self._depth), self._moved, self._nesting
            group.parked.append(Path(self._stack, self.modal, target, place))
            self._is_parked = True
        self._close((Edge(wait=Wait.BRANCH, outcome="", target=target),))
        if self._is_parked:
            group.open -= 1
            if not group.open:
                self._release(group)
        else:
            # One outcome less: it goes on as the other one.
            self._stack = [*self._stack, Frame((), group=group)]
        raise ProgramEnd

    def _arrived(self, stack: list[Frame], count: int) -> None:
        """So many outcomes fewer are on their way within the blocks of a stack."""
        for frame in reversed(stack):
            group = frame.group
            if group is not None:
                group.open -= count
                if not group.open:
                    self._release(group)

    def _release(self, group: Group) -> None:
        """All outcomes of a question have arrived or ended: those that arrived go on."""
        parked, group.parked = group.parked, []
        for path, same in merged(parked, exact=self.branches <= EXACT):
            if path.section < 0:
                path.section = self.rows.new_section()
                for one in same:
                    # From where each arrived, without a move, to where all go on.
                    self._resume(one)
                    self._close((Edge(wait=Wait.BRANCH, outcome="", target=path.section),))
                self._arrived(path.stack, len(same) - 1)
            self._waiting.append(path)

    # -- the fast way through blocks and conditions that come again

    def _fast_condition(self, condition: Expr) -> float | None:
        """The value of a condition that was evaluated before; None when the evaluator must do it."""
        key = id(condition)
        if not self._loops and not self._depth:
            return None
        if key not in self._tests:
            # As for blocks.
            self._tests[key] = compile_condition(condition, self.program.rules)
            return None
        test = self._tests[key]
        if test is None:
            return None
        try:
            return test[0](self.modal.parameters)
        except FALLS_BACK:
            self._settle(test[1])
            return None

    def _fast_block(self, node: Block) -> bool:
        """Evaluate a block that was executed before, and keep its motion for later; False: not possible this time."""
        key = id(node)
        if key not in self._fast:
            # The first time is the evaluator's: it tells what is to be told once.
            self._fast[key] = _ONCE
            return False
        fast = self._fast[key]
        if fast is _ONCE:
            fast = None if node.deleted else compile_block(node, self.program.rules)
            self._fast[key] = fast
        if fast is None or not (fast.is_motion or not fast.letters):
            return False
        parameters = self.modal.parameters
        try:
            values = fast.run(parameters)
        except FALLS_BACK:
            self._settle(fast.reads)
            return False
        self.spend(fast.node.span)
        words = len(fast.letters)
        if words:
            p = self._pending
            number = len(p.nodes)
            p.nodes.append(fast.node)
            p.line.extend([number] * words)
            p.letter.extend(map(ord, fast.letters))
            p.value.extend(values[:words])
        for target, value in zip(fast.targets, values[words:], strict=True):
            parameters[target] = value
        if len(self._pending.nodes) >= PENDING_LINES:
            self._run_pending()
        return True

    def _settle(self, numbers: Iterable[int]) -> None:
        """Variables that the setup states and nobody has set: from now on as if they were set."""
        for number in numbers:
            if number not in self.modal.parameters:
                stated = self.setup.parameter(number)
                if stated is not None:
                    self.modal.parameters[number] = stated

    def _run_pending(self) -> None:
        """Execute the lines that wait, in the kernel as far as it takes them."""
        pending = self._pending
        if not pending.nodes:
            return
        self._pending = Pending()
        nodes, count, at = pending.nodes, len(pending.line), 0
        run = k.run_lines.pick(len(nodes))
        compiled = run is not k.run_lines.python
        columns: Any = pending.line, pending.letter, pending.value
        if compiled:
            types = np.int32, np.uint8, np.float64
            columns = tuple(np.array(c, dtype=t) for c, t in zip(columns, types, strict=True))
        file, self._file = self._file, self._file_of(nodes[0].span)
        lines = np.array([node.span.line for node in nodes], dtype=np.int32)
        while at < count:
            before = self.rows.count
            blocks = self.blocks
            at = self._hot(run, columns[0], columns[1], columns[2], count, at, compiled)
            self.blocks = blocks  # they are counted already
            made = self.rows.arrays["line"][before : self.rows.count]
            made[:] = lines[made]
            if self.rows.count == self.rows.capacity:
                self.rows.flush()
            elif at < count:
                node = nodes[pending.line[at]]
                end = at + len(node.words)
                words = zip(node.words, pending.value[at:end], strict=True)
                self._line(node.span, [(word.letter, value, word.span) for word, value in words])
                at = end
        self._file = file

    # -- calls

    def _called(self, name: str, span: Span, rest: tuple[Span, list[Words]] | None = None) -> None:
        """Run a subprogram next; ``rest``: what is left of the line that called it."""
        self._run_pending()
        sub = self.program.subprograms.get(name)
        if sub is None:
            told = any(f.code is codes.UNKNOWN_SUBPROGRAM and f.span == span for f in self.findings.kept)
            if not told:
                self._fail(codes.UNKNOWN_SUBPROGRAM.at(span, name=name))
            return
        if len(self._depth) >= self.program.rules.call_depth:
            chain = " > ".join([*self._depth[-3:], name])
            raise Refusal(codes.RECURSION.at(span, allowed=self.program.rules.call_depth, chain=chain))
        self._enter(span)
        caller = Caller(self._call, self._file, rest)
        self._depth = [*self._depth, name]
        text = f"{' > '.join(self._depth)} (from line {span.line})"
        if text not in self.trace.calls:
            self.trace.calls.append(text)
        self._call = self.trace.calls.index(text)
        self._stack.append(Frame(sub.body, sub, caller=caller))

    def _line(self, span: Span, words: list[Words]) -> None:
        """One line: by the subprogram that replaces a code of it (4.4, 3.5.3), else as the controller's own."""
        try:
            found = replaced(self.program, self._depth, words, span)
        except Refusal as refusal:
            self._fail(refusal.finding)
            return
        if found is None:
            super()._line(span, words)
            return
        if found.before:
            super()._line(span, found.before)
        for number, value in found.arguments:
            self.modal.parameters[number] = value
        self._called(found.name, span, (span, found.after) if found.after else None)

    def _guarded(self, node: Statement) -> None:
        """One statement; a Refusal inside it becomes a finding and the next statement follows."""
        try:
            if isinstance(node, Block):
                self._block(node)
            elif isinstance(node, Message):
                self._message(node)
            elif isinstance(node, Guard):
                guards = set(self.modal.guards_off) - {node.name} | (set() if node.on else {node.name})
                self.modal.guards_off = tuple(sorted(guards))
                self._state_changed()
                self.event(Op.GUARD, node.span, arg=(float(node.on), 0.0), text=self._text(node.name))
            elif isinstance(node, Device):
                run_command(self, node)
            elif isinstance(node, Unsupported):
                raise Refusal(codes.UNSUPPORTED_CODE.at(node.span, code=node.what))
        except Refusal as refusal:
            self._fail(refusal.finding)

    def _message(self, node: Message) -> None:
        text = describe_parts(node.parts, self.evaluator)
        self.event(Op.MESSAGE, node.span, text=self._text(text))
        if node.kind == "dialog":
            self._dialog(node)
        if node.kind == "warning":
            # The manual's tool setter waits behind each of its warnings until RUN is pressed (2.13).
            self._end_section(Wait.OPERATOR, "warning read", None, node.span.line)
        if node.kind == "error":
            self.findings.add(codes.ERROR_MESSAGE.at(node.span, text=text))
            self._end_section(Wait.OPERATOR, "error message", -1, node.span.line)
            raise ProgramEnd

    def _dialog(self, node: Message) -> None:
        """What the operator typed is not known: the dialog's variables and its answer #5398 (4.2.4)."""
        if self.modal.rendering:
            self.modal.parameters[5398] = 1.0
            return
        self.modal.parameters[5398] = self.modal.stated_range(5398, Unknown("the answer of a dialog", -1.0, 1.0))
        for part in node.parts[1:]:
            if not isinstance(part, Text):
                number = self.evaluator.value(part)
                if isinstance(number, Unknown):
                    raise Refusal(codes.UNKNOWN_CONDITION.at(node.span, cause=number.cause))
                answer = Unknown(f"the operator's answer in #{number:g}")
                self.modal.write(number, self.modal.stated_range(round(number), answer), node.span)
        self._end_section(Wait.OPERATOR, "dialog answered", None, node.span.line)

    # -- straight-line code

    def _table(self, frame: Frame) -> None:
        """Go on with the lines of a table until it ends, rows are ready, or a line has called a subprogram."""
        table = frame.node
        assert isinstance(table, BlockTable)
        run = k.run_lines.pick(table.last_line - table.first_line + 1)
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
        words, frame.next_byte, frame.line = self.program.load(table, frame.next_byte, frame.line, CHUNK_BYTES)
        if (words["flags"] & FLAG_DELETE).any():
            self.met_deleted = True
            if self.block_delete:
                keep = (words["flags"] & FLAG_DELETE) == 0
                words = Columns(words.schema, {n: a[keep] for n, a in words.arrays.items()})
        frame.words, frame.at, frame.cold = words, 0, _cold_lines(words)
        columns = words["line"], words["letter"], words["value"]
        is_python = k.run_lines.pick(table.last_line - table.first_line + 1) is k.run_lines.python
        frame.columns = tuple(c.tolist() for c in columns) if is_python else columns

    def _words(self, frame: Frame, table: BlockTable, run: object) -> None:
        assert frame.words is not None
        compiled = run is not k.run_lines.python
        line = frame.words["line"]
        lines, letters, values = frame.columns
        count = len(frame.words)
        while frame.at < count:
            if not frame.cold or int(line[frame.at]) not in frame.cold:
                frame.at = self._hot(run, lines, letters, values, count, frame.at, compiled)
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
        self, run: object, line: object, letter: object, value: object, count: int, at: int, compiled: bool
    ) -> int:
        """Run lines in the kernel from word ``at``; returns the first word it left over."""
        s, a = self.modal, self.rows.arrays
        if (
            not s.plain_motion
            or not self._moved
            or s.feed_unit != s.unit
            or not 1 <= s.motion <= 4
            or s.feed_mode != 94
        ):
            # The first motion notes what it assumes; a motion mode must be set: Python path.
            return at
        offsets = [s.offset(axis) for axis in range(AXES)]
        ints: object = [
            s.motion, int(s.plane), int(s.absolute), self._frame(), self._state(), self._file, self._call,
            s.feed_mode, 1, int(self.machine.controller.absolute_arc_centers), self._active_axes(), s.transform.kind,
        ]  # fmt: skip
        floats: object = [
            s.unit, s.feed, *(p.value for p in s.position), *(o.value for o in offsets), s.scale(0),
            *s.transform.numbers,
        ]  # fmt: skip
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
        held = CLAMPED if self.modal.clamped else -1
        return sum(1 << axis for axis in range(AXES) if self.modal.has_axis(axis) and axis != held)

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
            self._table_written(round(number), span)
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
    max_branches: int = DEFAULT_BRANCHES, render: bool = False,
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
        max_branches=max_branches,
        render=render,
    )
    return collect(ex)


def collect(ex: Executor) -> Trace:
    """Run an executor to its end and put its chunks together."""
    from gproof.ir.columns import concatenate
    from gproof.ir.trace import TRACE_ROW

    parts: list[Columns] = []
    first: Chunk | None = None
    for chunk in follow_knife(ex.run(), ex.machine, ex.findings):
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
    ex.trace.sections.sort(key=lambda section: section.number)
    return ex.trace
