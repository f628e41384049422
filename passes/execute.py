"""Execution: Program + Setup -> Trace, streamed in chunks.

The order of execution within a line is that of the Eding CNC manual 3.7 (table 3-7), step by step in
``_execute``. Straight-line code runs in ``execute_kernels.run_lines``; every other line comes here.
Errors are findings: the line that has one does nothing more, and execution goes on behind it so that one run
shows all of them; ``stop_at_error`` ends there instead, as the controller would.
"""

from __future__ import annotations

import contextlib
import math
from collections.abc import Iterator

import numpy as np

from gproof.ir import codes
from gproof.ir.columns import Columns
from gproof.ir.finding import Finding, Findings, Refusal, Severity, Span
from gproof.ir.machine import AXES, AXIS_NAMES, Machine
from gproof.ir.program import (
    FLAG_DELETE,
    Assign,
    Block,
    BlockTable,
    Call,
    Guard,
    If,
    Message,
    Program,
    Statement,
    Text,
    Unsupported,
    While,
)
from gproof.ir.rules import CodeRule
from gproof.ir.rules import Function as F
from gproof.ir.setup import Setup
from gproof.ir.trace import Chunk, Edge, Op, PathMode, Plane, Trace, TraceSection, Wait
from gproof.passes import execute_kernels as k
from gproof.passes.cycles import AXES_OF_PLANE, run_cycle
from gproof.passes.expressions import Evaluator, describe_parts
from gproof.passes.line import LARGEST, Line, check_unused, gather
from gproof.passes.modal import INCH, NO_OFFSET, Modal
from gproof.passes.rows import RowBuffer
from gproof.passes.values import NOWHERE, FrameTable, Position, Unknown, Value, describe

CHUNK_BYTES = 1 << 20
_UTF8_MARK = b"\xef\xbb\xbf"
MAX_NESTED = 200
"""Blocks within blocks, those of calls counted in; each takes a frame of Python's stack."""
DEFAULT_BUDGET = 100_000_000

_COLD = np.array([chr(letter) not in "XYZABCIJKRFG" for letter in range(256)])
"""Letters that ``run_lines`` hands back."""
_CYCLES = (F.DRILL, F.DRILL_DWELL, F.DRILL_PECK, F.DRILL_CHIP_BREAK, F.BORE, F.BORE_STOP, F.BORE_DWELL)
_OUT_OF_PLANE = {Plane.XY: "K", Plane.XZ: "J", Plane.YZ: "I"}
_CENTER_WORDS = {Plane.XY: ("I", "J"), Plane.XZ: ("I", "K"), Plane.YZ: ("J", "K")}


class _End(Exception):
    """The program has ended."""


class Executor:
    """One run of a program.

    block_delete: lines with a leading slash are skipped. ``met_deleted`` tells afterwards whether there were
    any; ``assumed`` lists what the run took for granted; ``blocks`` counts executed lines.
    """

    def __init__(
        self, program: Program, setup: Setup, machine: Machine, findings: Findings, *,
        block_delete: bool = False, budget: int = DEFAULT_BUDGET, stop_at_error: bool = False,
    ) -> None:  # fmt: skip
        self.program = program
        self.machine = machine
        self.findings = findings
        self.block_delete = block_delete
        self.budget = budget
        self.stop_at_error = stop_at_error
        self.modal = Modal(program.rules, setup, machine)
        self.trace = Trace(files=[f.name for f in program.files] or ["(program)"])
        self.frames = FrameTable(self.trace.frames)
        self.evaluator = Evaluator(self._read, findings)
        # A motion mode is known by the first code of its function.
        g_codes = [rule for rule in program.rules.codes.values() if rule.letter == "G"]
        self._motion_rules: dict[int, CodeRule] = {int(rule.function): rule for rule in reversed(g_codes)}
        self.met_deleted = False
        self.blocks = 0
        self.assumed: dict[str, None] = {}
        self.failed: Finding | None = None
        self._file = 0
        self._call = 0
        self._depth: list[str] = []
        self._ended = False
        self._states: dict[object, int] = {}
        self._texts: dict[str, int] = {}
        self._state_index = -1
        self._warned: set[int] = set()
        self._moved = False
        self._moves = 0
        self._nesting = 0
        self._end: tuple[str, int] | None = None
        self.rows = RowBuffer(self.trace, [p.value for p in self.modal.position], self._frame(), program.line_count)

    # -- running

    def run(self) -> Iterator[Chunk]:
        """Execute; yields chunks in order, the last one of each section with its edges."""
        try:
            yield from self._body(self.program.body)
        except _End:
            after = self._end and next((n for n in map(_first_line, self.program.body) if n > self._end[1]), 0)
            if after:
                self._text_after_end(after)
        except Refusal as refusal:
            with contextlib.suppress(_End):
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

    def spend(self, span: Span) -> None:
        """Count one executed block; Refusal GP233 when the budget is used up."""
        self.blocks += 1
        if self.blocks > self.budget:
            raise Refusal(codes.STEP_BUDGET.at(span, budget=self.budget, hint="--max-blocks raises it"))

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
                    raise _End
            elif isinstance(node, Guard):
                guards = set(self.modal.guards_off) - {node.name} | (set() if node.on else {node.name})
                self.modal.guards_off = tuple(sorted(guards))
                self._state_changed()
                self.event(Op.GUARD, node.span, arg=(float(node.on), 0.0), text=self._text(node.name))
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

    def _fail(self, finding: Finding) -> None:
        self.findings.add(finding)
        if finding.severity in (Severity.ERROR, Severity.UNKNOWN):
            if self.failed is None:
                self.failed = finding
            if finding.code in (codes.UNKNOWN_CONDITION, codes.RECURSION, codes.STEP_BUDGET):
                self._end_section(Wait.UNKNOWN, finding.message, -1, finding.span.line)
                raise _End
            if self.stop_at_error:
                self._end_section(Wait.UNKNOWN, "error", -1, finding.span.line)
                raise _End

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
                except _End:
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

    def _read(self, number: float, span: Span) -> Value:
        value = self.modal.read(number, span)
        whole = round(number)
        if isinstance(value, Unknown) and value.cause == f"#{whole}" and whole not in self._warned:
            self._warned.add(whole)
            self.findings.add(codes.UNSET_PARAMETER.at(span, number=whole))
        return value

    # -- one line

    def _line(self, span: Span, words: list[tuple[str, Value, Span]]) -> None:
        line: Line | None = None
        moves = self._moves
        try:
            self._overridden(words)
            line = gather(self.program.rules, span, words)
            unsupported = line.find(F.UNSUPPORTED, F.COMPENSATION_LEFT, F.COMPENSATION_RIGHT)
            if unsupported is None:
                self._execute(line)
            else:
                self._beside(line, unsupported)
        except Refusal as refusal:
            if line is not None and moves == self._moves:
                self._recover(line)
            self._fail(refusal.finding)

    def _beside(self, line: Line, unsupported: CodeRule) -> None:
        """GP113 for a code that is not modelled; what else the line says counts.

        Where such a code takes the axis words, nobody knows where the axes are after it.
        """
        self._fail(codes.UNSUPPORTED_CODE.at(line.where_code(unsupported), code=unsupported.text))
        line.used.update(line.values)
        if not unsupported.uses_axes:
            self._execute(line)
            return
        if unsupported.group == "G1":
            self.modal.motion = F.UNSUPPORTED
        self._settings(line)
        for axis in line.axes():
            self.modal.position[axis] = NOWHERE
        self._stop(line)

    def _overridden(self, words: list[tuple[str, Value, Span]]) -> None:
        """Refusal GP113 for an M code that a subprogram of its name replaces (manual 4.4)."""
        for letter, value, where in words:
            if letter == "M" and not isinstance(value, Unknown):
                name = f"m{round(value)}"
                if name in self.program.subprograms and name not in self._depth:
                    raise Refusal(codes.UNSUPPORTED_CODE.at(where, code=f"M{round(value)} with a subprogram {name}"))

    def _recover(self, line: Line) -> None:
        """After an error the axes of the line are taken to be where it sent them, else anywhere."""
        rule = line.group("G0")
        if rule is not None and rule.uses_axes:
            return
        machine = rule is not None and rule.function is F.MACHINE_COORDINATES
        for axis, value in line.axes().items():
            if machine and not isinstance(value, Unknown):
                self.modal.position[axis] = Position(value * self.modal.scale(axis))
            else:
                self.modal.position[axis] = self.target(axis, value)

    def _execute(self, line: Line) -> None:
        """The steps of table 3-7, in its order (the comment, step 1, is the frontend's)."""
        owner = self._axis_owner(line)
        self._settings(line)
        self._once(line)
        if owner is not None:
            self._motion(line, owner)
        elif (rule := line.group("G1")) is not None and rule.function is F.MOTION_CANCEL:
            self._set_motion(rule)
        check_unused(line)
        self._stop(line)

    def _settings(self, line: Line) -> None:
        """Steps 2 to 18."""
        self._feed_mode(line)
        self._feed(line)
        self._spindle_speed(line)
        self._select_tool(line)
        if line.find(F.TOOL_CHANGE):
            self._change_tool(line)
        self._spindle(line)
        self._coolant(line)
        self._overrides(line)
        self._outputs(line)
        self._dwell(line)
        self._plane(line)
        self._units(line)
        self._length_offset(line)
        self._coordinate_system(line)
        self._path_mode(line)
        self._distance_and_retract(line)

    def _axis_owner(self, line: Line) -> CodeRule | None:
        """The motion code that takes the axis words of this line, None when none moves (3.3)."""
        motion, once = line.group("G1"), line.group("G0")
        axes = line.axes()
        takes_once = once is not None and once.uses_axes
        if once is not None and once.function is F.AXIS_OFFSET_SET and not axes:
            raise Refusal(codes.G92_AXIS_MISSING.at(line.where_code(once)))
        if motion is not None and motion.uses_axes:
            if takes_once and once is not None:
                raise Refusal(codes.TWO_AXIS_COMMANDS.at(line.where_code(once), first=motion.text, second=once.text))
            if not axes and motion.function not in _CYCLES:
                raise Refusal(codes.AXIS_WORDS_MISSING.at(line.where_code(motion), code=motion.text))
            return motion
        if takes_once:
            return None
        if not axes:
            if once is not None and once.function is F.MACHINE_COORDINATES:
                raise Refusal(codes.AXIS_WORDS_MISSING.at(line.where_code(once), code=once.text))
            return None
        if motion is not None:
            raise Refusal(codes.AXIS_WORDS_UNUSED.at(line.span, why=f"{motion.text} on this line"))
        if self.modal.motion == F.UNSUPPORTED:
            raise Refusal(codes.UNSUPPORTED_CODE.at(line.span, code="the active motion"))
        active = self._motion_rules.get(self.modal.motion)
        if active is None or active.function is F.MOTION_CANCEL:
            why = "no motion code before" if active is None else "G80"
            raise Refusal(codes.AXIS_WORDS_UNUSED.at(line.span, why=why))
        return active

    # steps 2 to 5

    def _feed_mode(self, line: Line) -> None:
        rule = line.group("G5")
        if rule is None:
            return
        mode = rule.tenths // 10
        if mode != self.modal.feed_mode:
            # A number of one mode means nothing in another.
            self.modal.feed_mode, self.modal.feed = mode, 0.0
            self._state_changed()

    def _feed(self, line: Line) -> None:
        value = line.values.get("F")
        if value is None:
            return
        s = self.modal
        if isinstance(value, Unknown):
            s.feed, s.feed_unit = math.nan, s.unit
            return
        if value < 0:
            raise Refusal(codes.NEGATIVE_FEED.at(line.where("F"), value=value))
        units = line.group("G6")
        if units is not None and (units.function is F.UNITS_INCH) != (s.unit == INCH) and s.feed_mode != 93:
            self.findings.add(
                codes.FEED_IN_OLD_UNITS.at(
                    line.where("F"), value=value, code=units.text, units="inches" if s.unit == INCH else "mm"
                )
            )
        s.feed = value if s.feed_mode == 93 else value * s.unit
        s.feed_unit = s.unit

    def _spindle_speed(self, line: Line) -> None:
        value = line.values.get("S")
        if value is None:
            return
        if not isinstance(value, Unknown) and value < 0:
            raise Refusal(codes.SPINDLE_SPEED_NEGATIVE.at(line.where("S"), value=value))
        self.modal.spindle_speed = value
        self._state_changed()
        if self.modal.spindle_direction and line.group("M7") is None:
            self.spindle_row(line)

    def spindle_row(self, line: Line) -> None:
        """Append a row that tells the spindle its direction and speed."""
        s = self.modal
        rpm = math.nan if isinstance(s.spindle_speed, Unknown) else s.spindle_speed
        if s.spindle_direction == 0:
            rpm = 0.0
        self._state_changed()
        self.event(Op.SPINDLE, line.span, arg=(float(s.spindle_direction), rpm))

    def _select_tool(self, line: Line) -> None:
        if "T" not in line.values:
            return
        highest = self.program.rules.highest_tool
        tool = line.whole("T", self.program.rules.integer_tolerance)
        if tool is None or not 0 <= tool <= highest:
            raise Refusal(codes.TOOL_NUMBER.at(line.where("T"), value=tool, highest=highest))
        self.modal.selected_tool = tool

    # steps 6 to 10

    def _change_tool(self, line: Line) -> None:
        s = self.modal
        if "change_tool" in self.program.subprograms:
            raise Refusal(codes.UNSUPPORTED_CODE.at(line.span, code="M6 with a change_tool subprogram"))
        if s.spindle_direction:
            s.spindle_direction = 0
            self.spindle_row(line)
        s.tool = s.selected_tool
        self._state_changed()
        number = math.nan if s.tool is None else float(s.tool)
        self.event(Op.TOOL_CHANGE, line.span, arg=(number, 0.0))
        if s.length_follows_tool:
            self._use_length(line, s.tool)
        if not self.machine.controller.auto_tool_change:
            self._note_stop(line, "M6")
            self._end_section(Wait.TOOL_CHANGE, "tool changed", None, line.span.line)

    def _spindle(self, line: Line) -> None:
        rule = line.group("M7")
        if rule is None:
            return
        self.modal.spindle_direction = {F.SPINDLE_CW: 1, F.SPINDLE_CCW: -1}.get(rule.function, 0)
        self.spindle_row(line)

    def _coolant(self, line: Line) -> None:
        s = self.modal
        for rule in line.rules:
            if rule.group != "M8":
                continue
            s.mist = rule.function is F.MIST_ON or (s.mist and rule.function is not F.COOLANT_OFF)
            s.flood = rule.function is F.FLOOD_ON or (s.flood and rule.function is not F.COOLANT_OFF)
            self.event(Op.COOLANT, line.span, arg=(float(s.mist), float(s.flood)))

    def _overrides(self, line: Line) -> None:
        rule = line.find(F.OVERRIDES_ON, F.OVERRIDES_OFF)
        if rule is None:
            return
        self.modal.overrides = rule.function is F.OVERRIDES_ON
        self._state_changed()
        self.event(Op.OVERRIDE, line.span, arg=(float(self.modal.overrides), 0.0))

    def _outputs(self, line: Line) -> None:
        """M54 P and M55 P: a general purpose output (3.5.9); M54 E Q (pulse width) is not modelled."""
        rule = line.find(F.OUTPUT_ON, F.OUTPUT_OFF)
        if rule is None:
            return
        channel = line.whole("P", self.program.rules.integer_tolerance)
        if channel is None:
            raise Refusal(codes.UNSUPPORTED_CODE.at(line.where_code(rule), code=f"{rule.text} without P"))
        value = 1.0 if rule.function is F.OUTPUT_ON else 0.0
        self.event(Op.OUTPUT, line.span, arg=(float(channel), value))

    def _dwell(self, line: Line) -> None:
        rule = line.find(F.DWELL)
        if rule is None:
            return
        seconds = line.number("P")
        if seconds is None:
            raise Refusal(codes.DWELL_MISSING.at(line.where_code(rule), code=rule.text))
        if seconds < 0:
            raise Refusal(codes.DWELL_NEGATIVE.at(line.where("P"), seconds=seconds))
        self.event(Op.DWELL, line.span, arg=(seconds, 0.0))

    # steps 11 to 18

    def _plane(self, line: Line) -> None:
        rule = line.group("G2")
        if rule is None:
            return
        self.modal.plane = {F.PLANE_XY: Plane.XY, F.PLANE_XZ: Plane.XZ}.get(rule.function, Plane.YZ)
        self.modal.stated.add("plane")
        self.event(Op.PLANE, line.span, arg=(float(self.modal.plane), 0.0))

    def _units(self, line: Line) -> None:
        rule = line.group("G6")
        if rule is None:
            return
        self.modal.unit = INCH if rule.function is F.UNITS_INCH else 1.0
        self.modal.stated.add("units")
        self._state_changed()
        self.event(Op.UNITS, line.span, arg=(self.modal.unit, 0.0))

    def _length_offset(self, line: Line) -> None:
        rule = line.group("G8")
        if rule is None:
            return
        s = self.modal
        s.length_follows_tool = False
        if rule.function is F.TOOL_OFFSET_OFF:
            s.tool_offset = list(NO_OFFSET)
            self.event(Op.TOOL_OFFSET, line.span)
            return
        if rule.function is F.TOOL_OFFSET_DYNAMIC:
            x, z = line.number("I"), line.number("K")
            if x is None and z is None:
                raise Refusal(codes.MISSING_VALUE.at(line.where_code(rule), letter="G43.1 I or K"))
            s.tool_offset = list(NO_OFFSET)
            s.tool_offset[0], s.tool_offset[2] = Position((x or 0.0) * s.unit), Position((z or 0.0) * s.unit)
            self.event(Op.TOOL_OFFSET, line.span)
            return
        tool = line.whole("H", self.program.rules.integer_tolerance)
        if tool is not None and not 1 <= tool <= self.program.rules.highest_tool:
            raise Refusal(
                codes.TOOL_OFFSET_NUMBER.at(line.where("H"), value=tool, highest=self.program.rules.highest_tool)
            )
        s.length_follows_tool = tool is None
        self._use_length(line, s.tool if tool is None else tool)

    def _use_length(self, line: Line, tool: int | None) -> None:
        s = self.modal
        s.tool_offset = list(NO_OFFSET)
        if tool is None:
            s.tool_offset[2] = NOWHERE
            self._fail(codes.TOOL_OFFSET_UNKNOWN.at(line.span, hint="name the tool with T and M6, or in the setup"))
        else:
            s.tool_offset[2] = s.length_of(tool)
            entry = self.machine.tool(tool)
            if entry is not None and entry.x_offset:
                s.tool_offset[0] = Position(entry.x_offset)
        self.event(Op.TOOL_OFFSET, line.span, arg=(math.nan if tool is None else float(tool), 0.0))

    def _coordinate_system(self, line: Line) -> None:
        rule = line.group("G12")
        if rule is None:
            return
        self.modal.work = rule.value
        self._state_changed()
        self.event(Op.OFFSET, line.span, arg=(float(rule.value), 0.0))

    def _path_mode(self, line: Line) -> None:
        rule = line.group("G13")
        if rule is None:
            return
        s = self.modal
        s.path_mode = {F.EXACT_PATH: PathMode.EXACT_PATH, F.EXACT_STOP: PathMode.EXACT_STOP}.get(
            rule.function, PathMode.CONTINUOUS
        )
        tolerance = line.number("P") if rule.function is F.CONTINUOUS else None
        simplify, angle = line.number("Q"), line.number("R")
        s.path_tolerance = 0.0 if tolerance is None else tolerance * s.unit
        s.simplify = 0.0 if simplify is None else simplify * s.unit
        s.laf_angle = math.nan if angle is None else angle
        self._state_changed()
        self.event(Op.PATH_MODE, line.span, arg=(float(s.path_mode), s.path_tolerance))

    def _distance_and_retract(self, line: Line) -> None:
        rule = line.group("G3")
        if rule is not None:
            self.modal.absolute = rule.function is F.ABSOLUTE
            self.modal.stated.add("distance")
        rule = line.group("G10")
        if rule is not None:
            self.modal.retract_initial = rule.function is F.RETRACT_INITIAL

    # step 19

    def _once(self, line: Line) -> None:
        rule = line.group("G0")
        if rule is None:
            return
        s = self.modal
        if rule.function in (F.PARK_1, F.PARK_2):
            self._park(line, "park_1" if rule.function is F.PARK_1 else "park_2")
        elif rule.function is F.SET_COORDINATES:
            self._set_coordinates(line, rule)
        elif rule.function is F.AXIS_OFFSET_SET:
            for axis, value in line.axes().items():
                if isinstance(value, Unknown):
                    s.g92[axis] = NOWHERE
                    continue
                # The origin moves so that the current point gets the given number (3.4.23).
                wanted = s.position[axis].moved(-value * s.scale(axis))
                s.g92[axis] = wanted.minus(s.work_offsets[s.work, axis]).minus(s.tool_offset[axis])
            s.g92_stored = list(s.g92)
            self.event(Op.OFFSET, line.span)
        elif rule.function is F.AXIS_OFFSET_RESET:
            s.g92, s.g92_stored = list(NO_OFFSET), list(NO_OFFSET)
            self.event(Op.OFFSET, line.span)
        elif rule.function is F.AXIS_OFFSET_SUSPEND:
            s.g92 = list(NO_OFFSET)
            self.event(Op.OFFSET, line.span)
        elif rule.function is F.AXIS_OFFSET_RESTORE:
            s.g92 = list(s.g92_stored)
            self.event(Op.OFFSET, line.span)

    def _park(self, line: Line, kind: str) -> None:
        """Through the programmed point, if any, to the park position; every axis goes (3.4.8)."""
        axes = line.axes()
        if axes:
            target = list(self.modal.position)
            for axis, value in axes.items():
                target[axis] = self.target(axis, value)
            self.move(Op.TRAVERSE, target, line.span)
        home = list(self.modal.position)
        for axis in range(AXES):
            if self.modal.has_axis(axis):
                home[axis] = self.modal.park_position(kind, axis)
                if abs(home[axis].value) > LARGEST:
                    what = f"the park position of {AXIS_NAMES[axis].upper()} is beyond every machine"
                    raise Refusal(codes.ARITHMETIC.at(line.span, what=what))
        unknown = [AXIS_NAMES[a].upper() for a in range(AXES) if home[a].form == NOWHERE.form]
        if unknown:
            number = 5161 if kind == "park_1" else 5181
            self.findings.add(
                codes.UNKNOWN_VALUE.at(
                    line.span, word=f"the park position of {' '.join(unknown)}",
                    cause=f"parameters #{number} to #{number + 5}",
                    hint="state them under [parameters] in the setup file",
                )
            )  # fmt: skip
        self.move(Op.TRAVERSE, home, line.span)

    def _set_coordinates(self, line: Line, rule: CodeRule) -> None:
        """G10 L2: the origin is given; G10 L20: the current point gets the given numbers (3.4.5)."""
        s = self.modal
        key = line.whole("L", self.program.rules.integer_tolerance)
        if key not in (2, 20):
            given = "" if key is None else f", not L{key}"
            raise Refusal(codes.G10_KEY.at(line.where("L"), given=given))
        number = line.number("P")
        system = -1 if number is None else round(number)
        if number is None or abs(number - system) > self.program.rules.integer_tolerance or not 1 <= system <= 9:
            raise Refusal(
                codes.COORDINATE_SYSTEM_RANGE.at(line.where("P"), value=math.nan if number is None else number)
            )
        if s.work == 0:
            # Which system is active is not stated: it may be the one that changes here.
            for axis in line.axes():
                s.work_offsets[0, axis] = NOWHERE
        for axis, value in line.axes().items():
            if isinstance(value, Unknown):
                s.work_offsets[system, axis] = NOWHERE
            elif key == 2:
                s.work_offsets[system, axis] = Position(value * s.scale(axis))
            else:
                wanted = s.position[axis].moved(-value * s.scale(axis))
                s.work_offsets[system, axis] = wanted.minus(s.g92[axis]).minus(s.tool_offset[axis])
        self.event(Op.OFFSET, line.span, arg=(float(system), 0.0))

    # step 20

    def target(self, axis: int, value: Value) -> Position:
        """Where an axis word sends its axis, in machine coordinates."""
        s = self.modal
        if isinstance(value, Unknown):
            return NOWHERE
        origin = s.offset(axis) if s.absolute else s.position[axis]
        return Position(value * s.scale(axis) + origin.value, origin.form)

    def _motion(self, line: Line, rule: CodeRule) -> None:
        self._note_assumptions(line, rule)
        machine = line.find(F.MACHINE_COORDINATES)
        if machine is not None and rule.function not in (F.TRAVERSE, F.FEED):
            raise Refusal(codes.G53_NEEDS_G0_G1.at(line.where_code(machine), mode=rule.text))
        if rule.function in _CYCLES:
            run_cycle(self, line, rule)
            return
        self._set_motion(rule)
        if rule.function is not F.TRAVERSE:
            self.need_feed(line, rule)
        target = list(self.modal.position)
        for axis, value in line.axes().items():
            if isinstance(value, Unknown):
                word = AXIS_NAMES[axis].upper()
                self.findings.add(codes.UNKNOWN_VALUE.at(line.where(word), word=word, cause=value.cause))
                target[axis] = NOWHERE
            elif machine is not None:
                target[axis] = Position(value * self.modal.scale(axis))
            else:
                target[axis] = self.target(axis, value)
        if rule.function in (F.ARC_CW, F.ARC_CCW):
            self._arc(line, rule, target)
        else:
            self.move(Op.TRAVERSE if rule.function is F.TRAVERSE else Op.FEED, target, line.span)
        self._moved = True

    def _set_motion(self, rule: CodeRule) -> None:
        if self.modal.motion != rule.function or rule.function is F.MOTION_CANCEL:
            self.modal.cycle, self.modal.cycle_code = {}, 0
        self.modal.motion = int(rule.function)

    def _note_assumptions(self, line: Line, rule: CodeRule) -> None:
        stated = self.modal.stated
        if "units" not in stated:
            self.assumed["the job starts in millimetres (G21)"] = None
        if "distance" not in stated:
            self.assumed["the job starts in absolute distances (G90)"] = None
        if "plane" not in stated and rule.function not in (F.TRAVERSE, F.FEED):
            self.assumed["the job starts in the XY plane (G17)"] = None

    def need_feed(self, line: Line, rule: CodeRule) -> None:
        """Refusal GP204 or GP205 when a feed move has no feed rate."""
        s = self.modal
        if s.feed_mode == 93 and "F" not in line.values:
            raise Refusal(codes.INVERSE_TIME_FEED_MISSING.at(line.span))
        if s.feed == 0.0:
            raise Refusal(codes.FEED_MISSING.at(line.span, code=rule.text))
        if s.feed_mode == 95 and (isinstance(s.spindle_speed, Unknown) or s.spindle_direction == 0):
            self.findings.add(codes.SPINDLE_UNKNOWN.at(line.span, hint="give S and start the spindle before"))

    def _arc(self, line: Line, rule: CodeRule, target: list[Position]) -> None:
        """Radius and centre format, 3.4.3.1 and 3.4.3.2."""
        s = self.modal
        first, second, _ = AXES_OF_PLANE[s.plane]
        names = [AXIS_NAMES[first].upper(), AXIS_NAMES[second].upper()]
        if first not in line.axes() and second not in line.axes():
            raise Refusal(
                codes.AXIS_WORDS_MISSING.at(line.span, code=f"{rule.text} in this plane, {names[0]} or {names[1]},")
            )
        one, two = _CENTER_WORDS[s.plane]
        radius = line.number("R")
        center_words = (line.number(one), line.number(two))
        if radius is None and center_words == (None, None):
            raise Refusal(codes.ARC_CENTER_MISSING.at(line.span, code=rule.text, needed=f"{one} or {two}, or R"))
        wrong = _OUT_OF_PLANE[s.plane]
        if wrong in line.values:
            raise Refusal(codes.UNUSED_WORD.at(line.where(wrong), word=f"{wrong} (out of the arc's plane)"))
        if radius is not None and center_words != (None, None):
            raise Refusal(codes.UNUSED_WORD.at(line.where("R"), word="R beside a centre"))
        start = [s.position[first], s.position[second]]
        end = [target[first], target[second]]
        for a, b, name in zip(start, end, names, strict=True):
            difference = b.minus(a)
            if difference.form:
                raise Refusal(codes.ARC_UNKNOWN.at(line.span, cause=f"{name}: {describe(difference.form)}"))
        if radius is not None:
            center = self._radius_center(line, start, end, radius * s.unit, rule.function is F.ARC_CCW)
        elif self.machine.controller.absolute_arc_centers:
            center = self._absolute_center(line, center_words, (first, second), start)
        else:
            i, j = (0.0 if v is None else v * s.unit for v in center_words)
            center = [start[0].value + i, start[1].value + j]
        if all(abs(a.value - b.value) < 1e-6 for a, b in zip(start, end, strict=True)):
            target[first], target[second] = start
        whole = [p.value for p in s.position[:3]]
        whole[first], whole[second] = center
        if math.hypot(center[0] - start[0].value, center[1] - start[1].value) < 1e-9:
            raise Refusal(codes.ARC_RADIUS_ZERO.at(line.span))
        turns = 1 if rule.function is F.ARC_CCW else -1
        self.move(Op.ARC, target, line.span, center=whole, turns=turns, plane=s.plane)

    def _radius_center(
        self, line: Line, start: list[Position], end: list[Position], radius: float, ccw: bool
    ) -> list[float]:
        # Counter-clockwise is meant in a right-handed pair; XZ is listed as (X, Z), its pair is (Z, X).
        flip = self.modal.plane is Plane.XZ
        a, b = (1, 0) if flip else (0, 1)
        x, y, bad = k.radius_center(start[a].value, start[b].value, end[a].value, end[b].value, radius, int(ccw))
        chord = math.hypot(end[0].value - start[0].value, end[1].value - start[1].value)
        if bad == k.RADIUS_ZERO:
            raise Refusal(codes.ARC_RADIUS_ZERO.at(line.where("R")))
        if bad == k.RADIUS_SAME_POINT:
            raise Refusal(codes.ARC_SAME_POINT.at(line.span))
        if bad == k.RADIUS_UNREACHABLE:
            raise Refusal(codes.ARC_UNREACHABLE.at(line.where("R"), chord=chord, radius=abs(radius), unit="mm"))
        degrees = 2 * math.degrees(math.asin(min(1.0, chord / (2 * abs(radius)))))
        degrees = 360 - degrees if radius < 0 else degrees
        if abs(degrees - 180) < 15 or degrees > 345:
            self.findings.add(
                codes.ARC_ILL_CONDITIONED.at(line.span, degrees=degrees, hint="give its centre with I, J, K")
            )
        return [y, x] if flip else [x, y]

    def _absolute_center(
        self,
        line: Line,
        words: tuple[float | None, float | None],
        axes: tuple[int, int],
        start: list[Position],
    ) -> list[float]:
        center = []
        for value, axis, at in zip(words, axes, start, strict=True):
            if value is None:
                raise Refusal(codes.ARC_UNKNOWN.at(line.span, cause="a centre word left out with absolute centres on"))
            place = self.modal.offset(axis).moved(value * self.modal.scale(axis))
            if place.form != at.form:
                raise Refusal(codes.ARC_UNKNOWN.at(line.span, cause=describe(place.minus(at).form)))
            center.append(place.value)
        return center

    def move(
        self, op: Op, target: list[Position], span: Span, *, center: list[float] | None = None,
        turns: int = 0, plane: int = 0,
    ) -> None:  # fmt: skip
        """Append a motion row and go there."""
        s = self.modal
        if any(a.value != b.value for a, b in zip(target[3:], s.position[3:], strict=True)):
            # Rounding is no motion: a rotary move beside it keeps its feed in degrees.
            for axis in range(3):
                if abs(target[axis].value - s.position[axis].value) < 1e-9:
                    target[axis] = Position(s.position[axis].value, target[axis].form)
        start = [p.value for p in s.position]
        length, rotary = _length(op, start, [p.value for p in target], center, turns, plane)
        feed = 0.0
        if op is not Op.TRAVERSE:
            feed = self._effective_feed(length, rotary)
        s.position = list(target)
        self._moves += 1
        self.rows.append(
            op, file=self._file_of(span), line=span.line, call=self._call, to=[p.value for p in target],
            frame=self._frame(), state=self._state(), feed=feed,
            center=(0.0, 0.0, 0.0) if center is None else center, turns=turns, plane=plane,
        )  # fmt: skip

    def _effective_feed(self, length: float, rotary: bool) -> float:
        """mm/min (deg/min for rotary moves) of a feed move of this length; NaN when not known."""
        s = self.modal
        if s.feed_mode == 93:
            return s.feed * length
        feed = s.feed / s.feed_unit if rotary else s.feed
        if s.feed_mode == 95:
            if isinstance(s.spindle_speed, Unknown) or s.spindle_direction == 0 or s.spindle_speed == 0:
                return math.nan
            return feed * s.spindle_speed
        return feed

    # step 21

    def _stop(self, line: Line) -> None:
        rule = line.group("M4")
        if rule is None:
            return
        s = self.modal
        if rule.function in (F.STOP, F.OPTIONAL_STOP, F.STOP_KEEP):
            optional = rule.function is F.OPTIONAL_STOP
            self.event(Op.STOP, line.span, arg=(float(optional), 0.0))
            self._note_stop(line, rule.text)
            self._end_section(Wait.OPERATOR, "cycle start", None, line.span.line)
            return
        if rule.function is F.END_RESET:
            if s.spindle_direction:
                s.spindle_direction = 0
                self.spindle_row(line)
            if s.mist or s.flood:
                s.mist = s.flood = False
                self.event(Op.COOLANT, line.span)
        self.event(Op.END, line.span)
        self._end = rule.text, line.span.line
        self._end_section(Wait.END, "end", -1, line.span.line)
        raise _End

    def _note_stop(self, line: Line, text: str) -> None:
        self.findings.add(codes.OPERATOR_STOP.at(line.span, code=text))

    def _end_section(self, wait: Wait, outcome: str, target: int | None, number: int) -> None:
        """Close the section; target None: the next one."""
        if target is None:
            target = self.rows.section + 1
        edge = Edge(wait=wait, outcome=outcome, target=target, line=number)
        if target < 0:
            self._ended = True
            self.rows.flush(last=True, edges=(edge,))
            return
        self.rows.end_section((edge,), [p.value for p in self.modal.position], self._frame())

    # -- rows

    def event(self, op: Op, span: Span, *, arg: tuple[float, float] = (0.0, 0.0), text: int = 0) -> None:
        """Append a row that does not move."""
        self.rows.append(
            op, file=self._file_of(span), line=span.line, call=self._call,
            to=[p.value for p in self.modal.position], frame=self._frame(), state=self._state(),
            arg=arg, text=text,
        )  # fmt: skip

    def _file_of(self, span: Span) -> int:
        return self.trace.files.index(span.file) if span.file in self.trace.files else 0

    def _frame(self) -> int:
        return self.frames.frame(self.modal.position)

    def _state_changed(self) -> None:
        self._state_index = -1

    def _state(self) -> int:
        if self._state_index < 0:
            state = self.modal.row_state()
            # NaN is not equal to itself: the text of a state is its identity.
            key = repr(state)
            index = self._states.get(key)
            if index is None:
                index = self._states[key] = len(self.trace.states)
                self.trace.states.append(state)
            self._state_index = index
        return self._state_index

    def _text(self, text: str) -> int:
        index = self._texts.get(text)
        if index is None:
            index = self._texts[text] = len(self.trace.texts)
            self.trace.texts.append(text)
        return index


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


def _length(
    op: Op, start: list[float], end: list[float], center: list[float] | None, turns: int, plane: int
) -> tuple[float, bool]:
    """(path length in mm, or degrees for moves of rotary axes alone; whether it is such a move)."""
    linear = [b - a for a, b in zip(start[:3], end[:3], strict=True)]
    if op is Op.ARC and center is not None:
        first, second, third = AXES_OF_PLANE[Plane(plane)]
        if plane == Plane.XZ:
            first, second = second, first
        a0 = math.atan2(start[second] - center[second], start[first] - center[first])
        a1 = math.atan2(end[second] - center[second], end[first] - center[first])
        sweep = math.fmod((a1 - a0) * (1 if turns > 0 else -1), 2 * math.pi)
        if sweep <= 0:
            sweep += 2 * math.pi
        sweep += 2 * math.pi * (abs(turns) - 1)
        r0 = math.hypot(start[first] - center[first], start[second] - center[second])
        r1 = math.hypot(end[first] - center[first], end[second] - center[second])
        return math.hypot(sweep * (r0 + r1) / 2, linear[third]), False
    length = math.sqrt(sum(d * d for d in linear))
    if length > 0:
        return length, False
    return math.sqrt(sum((b - a) * (b - a) for a, b in zip(start[3:], end[3:], strict=True))), True


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
