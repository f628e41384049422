"""What every step of execution stands on: the run's state, its findings, and the rows it appends."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import replace

from gproof.ir import codes
from gproof.ir.dialects.accepts import TOOL_ZERO, Accepted
from gproof.ir.finding import Code, Finding, Findings, Refusal, Related, Severity, Span
from gproof.ir.intervals import Range
from gproof.ir.machine import AXIS_NAMES, Machine
from gproof.ir.prefetch import Ahead
from gproof.ir.program import Input, Named, Program, Statement
from gproof.ir.rules import CodeRule
from gproof.ir.setup import Interval, Setup
from gproof.ir.symbolic import FrameTable, Position, Unknown, Value, behind_loop, between
from gproof.ir.trace import Edge, Op, Trace, Wait
from gproof.passes.interpret.core.block_compiler import Condition, FastBlock
from gproof.passes.interpret.core.call_stack import Followed, Frame, Hot, Lap, Path, Pending, PlainCell, Stretch
from gproof.passes.interpret.core.consequences import Consequences
from gproof.passes.interpret.core.expressions import Evaluator
from gproof.passes.interpret.core.foreseen_lengths import lengths_foreseen
from gproof.passes.interpret.core.loop_acceleration import Leap
from gproof.passes.interpret.core.modal_state import Modal, stated_system
from gproof.passes.interpret.core.open_settings import OpenSettings
from gproof.passes.interpret.core.outcomes import Asked
from gproof.passes.interpret.core.parsed_line import Line
from gproof.passes.interpret.core.row_buffer import RowBuffer
from gproof.passes.interpret.core.semantics import manner_of
from gproof.passes.interpret.eding.spindle import commanded_rpm, own_ramp, told
from gproof.passes.interpret.eding.transform_codes import at_start
from gproof.passes.interpret.mcuwin.foreign_statements import foreign
from gproof.passes.interpret.mcuwin.state import fits, whole_numbers

DEFAULT_BUDGET = 100_000_000
FIRST_BEAT, MOST_BEAT, LEAST_BEAT = 1 << 8, 1 << 14, 1 << 4
"""Blocks between two signs of life: first, at most, and at least where each of them takes long."""
SOON, LATE = 0.05, 0.25
"""Seconds between two signs of life: where they take less, more blocks come between them, and the other way round."""
DEFAULT_BRANCHES = 4096
"""Outcomes that are explored, of conditions that rest on what nobody knows before the job runs."""


_NOT_LISTED = ("later", "tool_zero")
"""Kinds of variables that the list of the manual does not have."""
_ENDS = (codes.UNKNOWN_CONDITION.number, codes.RECURSION.number, codes.STEP_BUDGET.number)
"""Findings behind which nothing can be followed."""


class ProgramEnd(Exception):
    """The program has ended."""


class Emitter:
    """The state of one run of a program, and how it becomes rows of the Trace."""

    def __init__(
        self, program: Program, setup: Setup, machine: Machine, findings: Findings, *,
        block_delete: bool = False, budget: int = DEFAULT_BUDGET, stop_at_error: bool = False,
        max_branches: int = DEFAULT_BRANCHES, render: bool = False,
        accepted: frozenset[tuple[int, Span]] = frozenset(),
    ) -> None:  # fmt: skip
        self.program = program
        self.machine = machine
        self.setup = setup
        self.findings = findings
        self.block_delete = block_delete
        self.accepted = accepted
        self.budget = budget
        # Who wants to hear how far it is: (blocks executed, place).
        self.on_beat: Callable[[int, Span], None] | None = None
        self._beat, self._rang = FIRST_BEAT, time.monotonic()
        self._alarm = min(budget + 1, self._beat)
        self.stop_at_error = stop_at_error
        self.max_branches = max_branches
        self.modal = Modal(program.rules, setup, machine)
        self.settings = OpenSettings(machine, findings)
        self.modal.lengths_used = self.modal.lengths_used or lengths_foreseen(program)
        self.modal.transform = at_start(self.modal)
        self.modal.rendering = render
        self.trace = Trace(files=[f.name for f in program.files] or ["(program)"], macro_files=program.macro_files)
        self.frames = FrameTable(self.trace.frames)
        self.modal.ranges = self.trace.symbols
        self.evaluator = Evaluator(self._read, findings, self._read_other, self.takes, self.assume)
        # A motion mode is known by the first code of its function.
        g_codes = [rule for rule in program.rules.codes.values() if rule.letter == "G"]
        self._motion_rules: dict[int, CodeRule] = {int(rule.function): rule for rule in reversed(g_codes)}
        self.met_deleted = False
        self.blocks = 0
        self.charged = 0  # of these: what calls within calls count as, which nobody executed
        self.assumed: dict[str, None] = {}
        self._beyond_list: set[tuple[int, Span]] = set()
        self._listed = min((e.first for e in program.rules.parameters if e.kind in _NOT_LISTED), default=math.inf)
        self._consequences = Consequences(program, findings)
        self.failed: Finding | None = None
        self.refused = False
        self._file = 0
        self._call = 0
        self._depth: list[str] = []
        self._calls: dict[str, int] = {}
        self._ended = False
        self._states: dict[object, int] = {}
        self._texts: dict[str, int] = {}
        self._state_index = -1
        self._warned: set[int] = set()
        self._loop_variables: set[tuple[int, Span]] = set()
        self._moved = False
        self._moves = 0
        self._nesting = 0
        self._end: tuple[str, int] | None = None
        self._around: dict[str, tuple[Statement, ...]] = {}
        self._told_around = False
        self._unknowns = 0
        # Where cycles rise to from a place whose height beside their R is not known, by place and R.
        self.risen: dict[tuple[Position, Position], Position] = {}
        self._start_system(setup)
        if program.rules.source_order:
            for what, key in foreign(setup, machine):
                where = findings.where(key, Span(machine.name if key.startswith("machine.") else setup.name, 1))
                self._fail(codes.FOREIGN_FACT.at(where, what=what))
        # What is still to do, and what branches and loops keep of it: passes/interpret/core/path_exploration.py,
        # passes/interpret/core/hot_blocks.py.
        self.branches = 0
        # What led into a section that is one outcome of several.
        self.asked: dict[int, Asked] = {}
        self._stack: list[Frame] = [Frame(program.body)]
        # What ran to its end last.
        self._last: tuple[Statement, ...] | None = None
        self._seen: dict[object, tuple[Edge, ...]] = {}
        self._joins: dict[object, int] = {}
        self._waiting: list[Path] = []
        self._is_parked = False
        self._key: object = None
        self._fast: dict[int, FastBlock | None] = {}
        self._tests: dict[int, Condition | None] = {}
        self._stretches: dict[int, Stretch] = {}
        self._pending = Pending()
        self._hots: dict[object, Hot] = {}
        self._cells: dict[int, PlainCell | None] = {}
        self._loops = 0
        self._laps: dict[object, Lap] = {}
        self._counted: dict[object, Lap] = {}
        self._passes: dict[object, int] = {}
        self._followed: dict[object, Followed] = {}
        self._cover: Followed | None = None
        self._asks: dict[int, frozenset[int]] = {}
        self._set_by_program: frozenset[int] | None = None
        self._leaps: dict[int, Leap | None] = {}
        self._came_back = False
        self._places: dict[int, dict[str, int]] = {}
        self._whole = whole_numbers(program) if program.rules.source_order else frozenset[int]()
        self._manner = manner_of(program.rules)
        self._ahead = Ahead(program)
        self.rows = RowBuffer(self.trace, [p.value for p in self.modal.position], self._frame(), program.line_count)

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
        if self.blocks >= self._alarm:
            self._ring(span)

    def _ring(self, span: Span) -> None:
        if self.blocks > self.budget:
            laps = [*self._laps.values(), *self._counted.values()]
            longest = max(laps, key=lambda lap: lap.count, default=None)
            hint, related = "--max-blocks raises it", tuple[Related, ...]()
            if len(self._depth) > 1:
                hint = f"calls within calls: {' > '.join(self._depth)}; {hint}"
            if longest is not None:
                hint = f"the loop here has come to pass {longest.count}; {hint}"
                span, related = longest.span, (Related(span, "here the last one of them was executed"),)
            raise Refusal(codes.STEP_BUDGET.at(span, budget=self.budget, hint=hint, related=related))
        now = time.monotonic()
        if now - self._rang < SOON:
            self._beat = min(2 * self._beat, MOST_BEAT)
        elif now - self._rang > LATE:
            self._beat = max(self._beat // 2, LEAST_BEAT)
        self._rang = now
        self._alarm = min(self.budget + 1, self.blocks + self._beat)
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

    def _fail(self, finding: Finding, *, told: bool = False) -> None:
        """Report a finding, unless another one that says as much is ``told`` already, and end what it ends."""
        if not told and not self._consequences.follows(finding):
            self.findings.add(finding)
        if finding.severity in (Severity.ERROR, Severity.UNKNOWN):
            if self.failed is None:
                self.failed = finding
            if finding.code.number in _ENDS:
                self._tell_rest(finding)
                self._end_section(Wait.UNKNOWN, finding.message, -1, finding.span)
                raise ProgramEnd
            if self.stop_at_error:
                self._end_section(Wait.UNKNOWN, "error", -1, finding.span)
                raise ProgramEnd

    def as_accepted(self, finding: Finding) -> Finding:
        """The finding of a refusal; an error that somebody accepts as an unknown: the job is run in spite of it."""
        if finding.severity is Severity.ERROR and (finding.code.number, finding.span) in self.accepted:
            return replace(finding, code=finding.code.as_unknown())
        return finding

    def _tell_rest(self, finding: Finding) -> None:
        """GP304 for all that comes after an accepted error which ends the run."""
        if (finding.code.number, finding.span) in self.accepted:
            cause = f"line {finding.span.line}, after which nothing can be followed"
            self.findings.add(codes.POSITION_UNKNOWN.at(finding.span, axis="every axis", cause=cause))

    def _refuse(self, finding: Finding, *, told: bool = False) -> None:
        """The line or statement of a Refusal did nothing, or half: what follows is not the job's path any more."""
        self.refused = self.refused or finding.severity in (Severity.ERROR, Severity.UNKNOWN)
        self._fail(finding, told=told)

    def _leave_file(self, span: Span) -> None:
        """End the file that runs: back to its caller, or the end of the job."""
        raise NotImplementedError

    def aborted(self) -> bool:
        """The job aborts itself: go on with what the controller runs then; False where there is no such thing."""
        raise NotImplementedError

    def ends_here(self, code: Code) -> Code:
        """A code that tells that the program ends itself: a note where that is one outcome of several."""
        return code.as_note() if any(frame.group is not None for frame in self._stack) else code

    def _note_stop(self, line: Line, text: str) -> None:
        self.findings.add(codes.OPERATOR_STOP.at(line.span, code=text))

    def _edge(self, wait: Wait, outcome: str, target: int, span: Span) -> Edge:
        return Edge(wait=wait, outcome=outcome, target=target, line=span.line, file=self._file_of(span))

    def _end_section(self, wait: Wait, outcome: str, target: int | None, span: Span) -> None:
        """Close the section; target None: the next one."""
        if target is None:
            target = self.rows.new_section()
        self._close((self._edge(wait, outcome, target, span),))
        if target >= 0:
            self._begin(target)

    def _close(self, edges: tuple[Edge, ...]) -> None:
        """Hand out the rest of the section with its edges."""
        self._ended = True
        self.rows.flush(last=True, edges=edges)

    def _begin(self, section: int) -> None:
        """Go on in a section that starts here."""
        self._ended = False
        self.findings.section = section
        self.rows.begin_section(section, [p.value for p in self.modal.position], self._frame())

    def unknown_place(self, kind: str, axis: int, ends: Range, origin: Position) -> Position:
        """``origin`` plus an unknown of its own between ``ends`` (mm or degrees)."""
        self._unknowns += 1
        symbol = f"{kind}.{self._unknowns}.{AXIS_NAMES[axis]}"
        if math.isfinite(ends[0]) and math.isfinite(ends[1]):
            self.trace.symbols[symbol] = Interval(*ends)
        return origin.plus(Position(0.0, ((symbol, 1),)))

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
        return self.frames.frame(self.modal.position, self.modal.unhomed)

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

    def spindle_row(self, line: Line) -> None:
        """Append a row that tells the spindle its direction and speed, and where that takes time, a dwell (2.1.11)."""
        s = self.modal
        self._state_changed()
        self.event(Op.SPINDLE, line.span, arg=(float(s.spindle_direction), commanded_rpm(s)))
        wait = own_ramp(s)
        s.spun = told(s)
        if wait > 0.0:
            self.event(Op.DWELL, line.span, arg=(wait, 0.0))

    def _read_other(self, node: Named | Input) -> Value:
        if isinstance(node, Input):
            return self._manner.input(self, node)
        value = self._manner.named(self, node)
        if self.modal.unknown_modes and len(node.name) > 1:
            return Unknown(f"{node.name} behind a refused line")
        return value

    def _read(self, number: float, span: Span) -> Value:
        whole = round(number)
        return self._of_its_type(whole, self._told_of(number, whole, span))

    def _of_its_type(self, number: int, value: Value) -> Value:
        """What is known of a variable that is declared to hold whole numbers, or is one of those that do."""
        if not isinstance(value, Unknown) or value.whole or not self.program.rules.source_order:
            return value
        if fits(number, 0.5, self._whole):
            return value
        if not value.bounded:
            return Unknown(value.cause, value.low, value.high, whole=True)
        low, high = float(math.ceil(value.low)), float(math.floor(value.high))
        return between(value.cause, (low, high), whole=True) if low <= high else value

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
            what = f"#{whole}, which is not in the list of the manual,"
            self._fail(codes.UNSUPPORTED_CODE.at(span, code=what, hint=hint))
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
            self.findings.add(codes.LOOP_VARIABLE.at(span, name=name, hint="use a variable of its own behind the loop"))
        if value.cause != own:
            return value
        if whole in self.modal.setup.parameter_ranges:
            # Less of it where a condition has told more.
            return Unknown(name, value.low, value.high, value.whole)  # what the setup states of it
        if whole not in self._warned:
            self._warned.add(whole)
            self.findings.add(codes.UNSET_PARAMETER.at(span, name=name))
        return value if name == own else Unknown(name, value.low, value.high, value.whole)
