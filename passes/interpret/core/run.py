"""A run of a program: its state, its findings, its budget, and the rows that it writes. Every part of execution has it.

``Run`` is what a language's own code works with; what is still to do (statements, loops, branches) is its ``flow``
(``control_flow.py``), what the language decides its ``dialect`` (``semantics.py``).
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from gproof.ir import codes
from gproof.ir.dialects.accepts import TOOL_ZERO, Accepted
from gproof.ir.finding import Code, Finding, Findings, Refusal, Related, Severity, Span
from gproof.ir.intervals import Range
from gproof.ir.machine import AXIS_NAMES, Machine
from gproof.ir.prefetch import Ahead
from gproof.ir.program import Assign, Input, Named, Program
from gproof.ir.rules import CodeRule
from gproof.ir.setup import Interval, Setup
from gproof.ir.symbolic import NOWHERE, FrameTable, Position, Unknown, Value, behind_loop
from gproof.ir.trace import Chunk, Edge, Op, Trace, Wait
from gproof.passes.interpret.core.consequences import Consequences
from gproof.passes.interpret.core.expressions import Evaluator
from gproof.passes.interpret.core.foreseen_lengths import lengths_foreseen
from gproof.passes.interpret.core.modal_state import Modal
from gproof.passes.interpret.core.open_settings import OpenSettings
from gproof.passes.interpret.core.outcomes import Asked
from gproof.passes.interpret.core.parsed_line import Line
from gproof.passes.interpret.core.plane_transform import at_start
from gproof.passes.interpret.core.row_buffer import RowBuffer
from gproof.passes.interpret.core.shown_variables import stated_system
from gproof.passes.interpret.core.spindle_speed import commanded_rpm, own_ramp, told

if TYPE_CHECKING:
    from gproof.passes.interpret.core.control_flow import ControlFlow
    from gproof.passes.interpret.core.semantics import Dialect

DEFAULT_BUDGET = 100_000_000
FIRST_BEAT, MOST_BEAT, LEAST_BEAT = 1 << 8, 1 << 14, 1 << 4
"""Blocks between two signs of life: first, at most, and at least where each of them takes long."""
SOON, LATE = 0.05, 0.25
"""Seconds between two signs of life: where they take less, more blocks come between them, and the other way round."""
DEFAULT_BRANCHES = 4096
"""Outcomes that are explored, of conditions that rest on what is not known before the job runs."""


_NOT_LISTED = ("later", "tool_zero")
"""Kinds of variables that the list of the manual does not have."""
_ENDS = (codes.UNKNOWN_CONDITION.number, codes.RECURSION.number, codes.STEP_BUDGET.number)
"""Findings after which nothing can be followed."""


class ProgramEnd(Exception):
    """The program has ended."""


class Run:
    """One run of a program.

    block_delete: lines with a leading slash are skipped; met_deleted: there were any. stop_at_error: end at the first
    error, as the controller would. accepted: (code, place) of errors in spite of which the run goes on. on_beat: hears
    how far it is, (blocks executed, place).
    blocks: executed so far; charged: of these, what calls within calls count as, which nobody executed; branches:
    outcomes that were followed; moves: rows that move.
    inputs_read: values that are the state of an input, by identity: value, channel, section that starts then.
    assumed: what the run took for granted; asked: what led into a section that is one outcome of several; failed: the
    first finding that stops a controller; refused: the trace lacks what a line of the job would do.
    file, call: of the line that runs, as indices of the trace; moved: something has moved; ended_by: code and line of
    the end that was met.
    """

    modal: Modal

    def __init__(
        self, program: Program, setup: Setup, machine: Machine, findings: Findings, dialect: Dialect[Any], *,
        block_delete: bool = False, budget: int = DEFAULT_BUDGET, stop_at_error: bool = False,
        max_branches: int = DEFAULT_BRANCHES, render: bool = False,
        accepted: frozenset[tuple[int, Span]] = frozenset(),
    ) -> None:  # fmt: skip
        self.program = program
        self.machine = machine
        self.setup = setup
        self.findings = findings
        self.dialect = dialect
        self.flow: ControlFlow
        self.block_delete = block_delete
        self.accepted = accepted
        self.stop_at_error = stop_at_error
        self.max_branches = max_branches
        self._begin_budget(budget)
        self._begin_trace()
        self.modal = self._first_state(render)
        self.settings = OpenSettings(machine, findings)
        self.evaluator = Evaluator(self._read, findings, self._read_other, self.takes, self.assume)
        # A motion mode is known by the first code of its function.
        g_codes = [rule for rule in program.rules.codes.values() if rule.letter == "G"]
        self.motion_rules: dict[int, CodeRule] = {int(rule.function): rule for rule in reversed(g_codes)}
        self.met_deleted = False
        self.assumed: dict[str, None] = {}
        self._beyond_list: set[tuple[int, Span]] = set()
        self._listed = min((e.first for e in program.rules.parameters if e.kind in _NOT_LISTED), default=math.inf)
        self._consequences = Consequences(program, findings)
        self.failed: Finding | None = None
        self.refused = False
        self.moved = False
        self.moves = 0
        self.ended_by: tuple[str, int] | None = None
        self._warned: set[int] = set()
        self._loop_variables: set[tuple[int, Span]] = set()
        self.unknowns = 0
        # Where cycles rise to from a place whose height relative to their R is not known, by place and R.
        self.risen: dict[tuple[Position, Position], Position] = {}
        self._start_system(setup)
        self.asked: dict[int, Asked] = {}
        self.inputs_read: dict[int, tuple[Unknown, int, int]] = {}
        self.ahead = Ahead(program)
        self.trace.first = self.modal.row_state()
        self.rows = RowBuffer(
            self.trace, [p.value for p in self.modal.position], self.frame_number(), program.line_count
        )

    def _begin_budget(self, budget: int) -> None:
        self.budget = budget
        self.on_beat: Callable[[int, Span], None] | None = None
        self._beat, self._rang = FIRST_BEAT, time.monotonic()
        self.alarm = min(budget + 1, self._beat)
        self.blocks = 0
        self.charged = 0
        self.branches = 0

    def _begin_trace(self) -> None:
        program = self.program
        self.trace = Trace(files=[f.name for f in program.files] or ["(program)"], macro_files=program.macro_files)
        self.frames = FrameTable(self.trace.frames)
        self.file = 0
        self.call = 0
        self.is_section_over = False
        self._states: dict[object, int] = {}
        self._texts: dict[str, int] = {}
        self._state_index = -1

    def _first_state(self, render: bool) -> Modal:
        modal = self.dialect.first_state(self.program, self.setup, self.machine)
        modal.lengths_used = modal.lengths_used or lengths_foreseen(self.program)
        modal.transform = at_start(modal)
        modal.rendering = render
        modal.ranges = self.trace.symbols
        return modal

    def _start_system(self, setup: Setup) -> None:
        """The coordinate system at the start, where the setup states its variable (3.1.3): GP235."""
        value = stated_system(self.program.rules, setup)
        if value is None:
            return
        whole = round(value)
        if abs(value - whole) > self.program.rules.integer_tolerance or not 1 <= whole <= 9:
            where = self.findings.where("setup.parameters.5220", Span(setup.name, 1))
            self.findings.add(codes.STARTUP_COORDINATE_SYSTEM.at(where, value=value))

    def spend(self, span: Span) -> None:
        """Count one executed block; Refusal GP233 when the budget is used up."""
        self.blocks += 1
        if self.blocks >= self.alarm:
            self._ring(span)

    def _ring(self, span: Span) -> None:
        if self.blocks > self.budget:
            laps = [*self.flow.widening.laps.values(), *self.flow.widening.counted.values()]
            longest = max(laps, key=lambda lap: lap.count, default=None)
            hint, related = "raise it with --max-blocks", tuple[Related, ...]()
            if len(self.flow.called) > 1:
                hint = f"check the nested calls: {' > '.join(self.flow.called)}; {hint}"
            if longest is not None:
                hint = f"check the loop here, at pass {longest.count}; {hint}"
                span, related = longest.span, (Related(span, "the last block was executed here"),)
            raise Refusal(codes.STEP_BUDGET.at(span, budget=self.budget, hint=hint, related=related))
        now = time.monotonic()
        if now - self._rang < SOON:
            self._beat = min(2 * self._beat, MOST_BEAT)
        elif now - self._rang > LATE:
            self._beat = max(self._beat // 2, LEAST_BEAT)
        self._rang = now
        self.alarm = min(self.budget + 1, self.blocks + self._beat)
        if self.on_beat is not None:
            self.on_beat(self.blocks, span)

    def assume(self, text: str) -> None:
        """Note an assumption of every answer about this job."""
        self.assumed[text] = None

    def takes(self, what: Accepted) -> bool:
        """Whether the shop says that its controller takes this beyond its manual; then it is an assumption."""
        if what.name not in self.machine.controller.accepts:
            return False
        self.assumed[what.assumption] = None
        return True

    def fail(self, finding: Finding, *, told: bool = False) -> None:
        """Report a finding, unless another one that says as much is ``told`` already, and end what it ends."""
        if not told and not self._consequences.follows(finding):
            self.findings.add(finding)
        if finding.severity in (Severity.ERROR, Severity.UNKNOWN):
            if self.failed is None:
                self.failed = finding
            if finding.code.number in _ENDS:
                self.tell_rest(finding)
                self.end_section(Wait.UNKNOWN, finding.message, -1, finding.span)
                raise ProgramEnd
            if self.stop_at_error:
                self.end_section(Wait.UNKNOWN, "error", -1, finding.span)
                raise ProgramEnd

    def as_accepted(self, finding: Finding) -> Finding:
        """The finding of a refusal; an error that somebody accepts as an unknown: the job is run in spite of it."""
        if finding.severity is Severity.ERROR and (finding.code.number, finding.span) in self.accepted:
            return replace(finding, code=finding.code.as_unknown())
        return finding

    def tell_rest(self, finding: Finding) -> None:
        """GP304 for all that comes after an accepted error which ends the run."""
        if (finding.code.number, finding.span) in self.accepted:
            cause = f"line {finding.span.line}, after which gproof cannot follow the job"
            self.findings.add(codes.POSITION_UNKNOWN.at(finding.span, axis="every axis", cause=cause))

    def refuse(self, finding: Finding, *, told: bool = False) -> None:
        """The line or statement of a Refusal did nothing, or half: what follows is not the job's path any more."""
        self.refused = self.refused or finding.severity in (Severity.ERROR, Severity.UNKNOWN)
        self.fail(finding, told=told)

    def ends_here(self, code: Code) -> Code:
        """A code that tells that the program ends itself: a note where that is one outcome of several."""
        return code.as_note() if any(frame.group is not None for frame in self.flow.stack) else code

    def note_stop(self, line: Line, text: str, *, tool: bool = False) -> None:
        """GP243: the job waits here for the operator; tool: who changes the tool."""
        code = codes.TOOL_CHANGE_STOP if tool else codes.OPERATOR_STOP
        self.findings.add(code.at(line.span, code=text))

    def edge(self, wait: Wait, outcome: str, target: int, span: Span) -> Edge:
        """An edge of the section that runs, from the line of a span."""
        return Edge(wait=wait, outcome=outcome, target=target, line=span.line, file=self.file_of(span))

    def end_section(self, wait: Wait, outcome: str, target: int | None, span: Span) -> None:
        """Close the section; target None: the next one."""
        if target is None:
            target = self.rows.new_section()
        self.close_section((self.edge(wait, outcome, target, span),))
        if target >= 0:
            self.begin_section(target)

    def close_section(self, edges: tuple[Edge, ...]) -> None:
        """Hand out the rest of the section with its edges."""
        self.is_section_over = True
        if any(edge.wait is Wait.END for edge in edges):
            self.trace.ends[self.rows.section] = self.dialect.end_state(self)
        self.rows.flush(last=True, edges=edges)

    def begin_section(self, section: int) -> None:
        """Go on in a section that starts here."""
        self.is_section_over = False
        self.findings.section = section
        self.rows.begin_section(section, [p.value for p in self.modal.position], self.frame_number())

    def unknown_place(self, kind: str, axis: int, ends: Range, origin: Position) -> Position:
        """``origin`` plus an unknown of its own between ``ends`` (mm or degrees)."""
        self.unknowns += 1
        symbol = f"{kind}.{self.unknowns}.{AXIS_NAMES[axis]}"
        if math.isfinite(ends[0]) and math.isfinite(ends[1]):
            self.trace.symbols[symbol] = Interval(*ends)
        return origin.plus(Position(0.0, ((symbol, 1),)))

    def event(self, op: Op, span: Span, *, arg: tuple[float, float] = (0.0, 0.0), text: int = 0) -> None:
        """Append a row that does not move."""
        self.rows.append(
            op, file=self.file_of(span), line=span.line, call=self.call,
            to=[p.value for p in self.modal.position], frame=self.frame_number(), state=self.state_number(),
            arg=arg, text=text,
        )  # fmt: skip

    def file_of(self, span: Span) -> int:
        """The index of the file that a span names."""
        return self.trace.files.index(span.file) if span.file in self.trace.files else 0

    def frame_number(self) -> int:
        """The index of the frame that positions are measured in now."""
        return self.frames.frame(self.modal.position, self.modal.unhomed)

    def state_changed(self) -> None:
        """Something changed that rows carry in their state."""
        self._state_index = -1

    def state_number(self) -> int:
        """The index of the state that rows carry now."""
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

    def text_number(self, text: str) -> int:
        """The index of a text among those of the trace."""
        index = self._texts.get(text)
        if index is None:
            index = self._texts[text] = len(self.trace.texts)
            self.trace.texts.append(text)
        return index

    def spindle_row(self, line: Line) -> None:
        """Append a row that tells the spindle its direction and speed, and where that takes time, a dwell (2.1.11)."""
        s = self.modal
        self.state_changed()
        self.event(Op.SPINDLE, line.span, arg=(float(s.spindle_direction), commanded_rpm(s)))
        wait = own_ramp(s)
        s.spun = told(s)
        if wait > 0.0:
            self.event(Op.DWELL, line.span, arg=(wait, 0.0))

    def _read_other(self, node: Named | Input) -> Value:
        if isinstance(node, Input):
            return self.dialect.input(self, node)
        value = self.dialect.named(self, node)
        if self.modal.unknown_modes and len(node.name) > 1:
            return Unknown(f"{node.name} after a refused line")
        return value

    def _read(self, number: float, span: Span) -> Value:
        whole = round(number)
        return self.dialect.of_its_type(whole, self._told_of(number, whole, span))

    def knows_number(self, number: float, span: Span) -> bool:
        """Whether the manual has a variable, or the shop says that its controller has it; GP113 otherwise."""
        if number < self._listed - 1:
            return True
        whole, entry = self.modal.range_of(number, span)
        if entry.kind not in _NOT_LISTED:
            return True
        if entry.kind == "tool_zero" and self.takes(TOOL_ZERO):
            return True
        if (whole, span) not in self._beyond_list:
            self._beyond_list.add((whole, span))
            hint = TOOL_ZERO.hint if entry.kind == "tool_zero" else ""
            what = f"#{whole}, which is not in the manual's list,"
            self.fail(codes.UNSUPPORTED_CODE.at(span, code=what, hint=hint))
        return False

    def _told_of(self, number: float, whole: int, span: Span) -> Value:
        value = self.modal.read(number, span)
        if not self.knows_number(number, span):
            return Unknown(f"#{whole}")
        if not isinstance(value, Unknown):
            return value
        own = self.program.rules.name_of(whole)
        name = self.evaluator.names.get(whole, own)
        if value.cause == behind_loop(name) and (whole, span) not in self._loop_variables:
            self._loop_variables.add((whole, span))
            self.findings.add(codes.LOOP_VARIABLE.at(span, name=name, hint="use another variable after the loop"))
        if value.cause != own:
            return value
        if whole in self.modal.setup.parameter_ranges:
            # Less of it where a condition has shown more.
            return Unknown(name, value.low, value.high, value.whole)  # what the setup states of it
        if whole not in self._warned:
            self._warned.add(whole)
            self.findings.add(codes.UNSET_PARAMETER.at(span, name=name))
        return value if name == own else Unknown(name, value.low, value.high, value.whole)

    def move(
        self, op: Op, target: list[Position], span: Span, *, center: list[float] | None = None,
        turns: int = 0, plane: int = 0, length: float | None = None, programmed: tuple[float, float] | None = None,
    ) -> None:  # fmt: skip
        """Append a motion row and go there: see ``moves.go``; with what the language adds to each move."""
        more: dict[str, Any] = {"center": center, "turns": turns, "plane": plane}
        self.dialect.move(self, op, target, span, length=length, programmed=programmed, **more)

    def lose_places(self) -> None:
        """The places of the axes that the machine has are no longer known."""
        for axis in self.machine.axes:
            self.modal.position[axis.index] = NOWHERE
        self.modal.jumped = True

    def setting(self, node: Assign) -> tuple[Value, Value, Span]:
        """What an assignment writes: number of the variable, value, place."""
        number = self.evaluator.value(node.target.number)
        if node.target.name and not isinstance(number, Unknown):
            self.evaluator.names[round(number)] = node.target.name
        return number, self.evaluator.value(node.value), node.target.span

    def chunks(self) -> Iterator[Chunk]:
        """Execute; yields chunks of successive rows, the last one of each section with its edges."""
        return self.flow.chunks()
