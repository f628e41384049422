"""Execution: Program + Setup -> Trace, streamed in chunks.

One run is a chain of classes, each of which knows one thing: ``emitter`` (state and rows), ``motion`` (moves),
``origins`` (where numbers count from), ``blocks`` (a line in the order of the manual), ``straight`` (tables of plain
lines), ``loops`` (lines that come again), ``branches`` (conditions that nobody can decide), and here statements, calls
and messages. Errors are findings: the line that has one does nothing more, and execution goes on after it so that one
run shows all of them; ``stop_at_error`` ends there instead, as the controller would.
"""

from __future__ import annotations

import contextlib
import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from gproof.ir import codes
from gproof.ir.dialects.accepts import ACCEPTS
from gproof.ir.finding import Finding, Findings, FollowedRefusal, Refusal, Span
from gproof.ir.machine import Machine
from gproof.ir.program import (
    Array,
    Block,
    BlockTable,
    Call,
    Declare,
    DeferredBlock,
    Definition,
    Device,
    For,
    Guard,
    If,
    Include,
    Jump,
    Label,
    Message,
    Mistake,
    Mode,
    Program,
    Repeat,
    Replaced,
    Return,
    Statement,
    Subprogram,
    Unsupported,
    While,
)
from gproof.ir.setup import Setup
from gproof.ir.symbolic import Unknown
from gproof.ir.trace import Chunk, Edge, Op, Wait
from gproof.passes.interpret.core import refused_lines
from gproof.passes.interpret.core.block_tables import BlockTables
from gproof.passes.interpret.core.call_stack import Caller, Frame, Path
from gproof.passes.interpret.core.channels import with_pair
from gproof.passes.interpret.core.expressions import describe_parts
from gproof.passes.interpret.core.hot_blocks import HotBlocks
from gproof.passes.interpret.core.hot_passes import HotPasses
from gproof.passes.interpret.core.loop_widening import LoopWidening, call_blocks
from gproof.passes.interpret.core.outcomes import Asked
from gproof.passes.interpret.core.path_exploration import LOOPS, PathExploration
from gproof.passes.interpret.core.run import ProgramEnd
from gproof.passes.interpret.core.statement_order import StatementOrder

if TYPE_CHECKING:
    from gproof.passes.interpret.core.run import Run
    from gproof.passes.interpret.core.semantics import Dialect, Word


class ControlFlow:
    """What is still to do in a run, and its parts, each of which knows one thing.

    tables: lines of tables; order: jumps, loops and calls; hot_blocks: lines that come again; paths: outcomes of what
    nobody can decide; widening: loops that go on for longer than anybody follows; hot_passes: many passes at once.
    stack: what runs, innermost last; called: names of the subprograms that run; nesting: blocks within blocks; loops:
    of these, loops; came_back: a jump has led back. call_texts: numbers of ``Trace.calls`` by text; seen: edges of
    questions by the state in which they were asked; joins: sections by the state in which outcomes meet; waiting:
    outcomes that nobody has followed yet; is_parked: the one that runs waits for others.
    """

    def __init__(self, run: Run) -> None:
        self.run = run
        self.stack: list[Frame] = [Frame(run.program.body)]
        self.called: list[str] = []
        self.nesting = 0
        self.loops = 0
        self.came_back = False
        self.call_texts: dict[str, int] = {}
        self.seen: dict[object, tuple[Edge, ...]] = {}
        self.joins: dict[object, int] = {}
        self.waiting: list[Path] = []
        self.is_parked = False
        self._has_begun = False
        # What ran to its end last.
        self._last: tuple[Statement, ...] | None = None
        self._around: dict[str, tuple[Statement, ...]] = {}
        self._told_around = False
        self.tables = BlockTables(self)
        self.hot_blocks = HotBlocks(self)
        self.paths = PathExploration(self)
        self.widening = LoopWidening(self)
        self.hot_passes = HotPasses(self)
        self.order = StatementOrder(self)

    def chunks(self) -> Iterator[Chunk]:
        """Execute; yields chunks of successive rows, the last one of each section with its edges."""
        self.run.findings.section = self.run.rows.section
        while True:
            self.is_parked = False
            yield from self._path()
            yield from self._ready()
            if not self.is_parked:
                self.paths.arrived(self.stack, 1)
                yield from self._ready()
            if not self.waiting:
                return
            self.paths.resume(self.waiting.pop())

    def _path(self) -> Iterator[Chunk]:
        """Run what is on the stack to its end."""
        try:
            if not self._has_begun:
                self._has_begun = True
                self.run.dialect.begin(self.run)
            while self.stack:
                self._step()
                if self.run.rows.ready:
                    yield from self._ready()
            self.hot_blocks.run_pending()
        except ProgramEnd:
            self._warn_after_end()
        except Refusal as refusal:
            with contextlib.suppress(ProgramEnd):
                self.hot_blocks.run_pending()
                self.run.refuse(self.run.as_accepted(refusal.finding))
                self.run.tell_rest(refusal.finding)
                self.run.end_section(Wait.UNKNOWN, refusal.finding.message, -1, refusal.finding.span)
        if not self.run.is_section_over:
            if self.run.failed is None:
                span = Span(self.run.trace.files[self.run.file], max(1, self.run.program.line_count))
                self.run.event(Op.END, span, arg=(2.0 if self._last is self.run.program.abort else 1.0, 0.0))
            self.run.close_section((Edge(wait=Wait.END, outcome="end", target=-1),))

    def _warn_after_end(self) -> None:
        """Warn once of code after an end that every run reaches."""
        if not self.stack or self.order.labels(self.run.program.body):
            # After an end there may be something that labels lead to.
            return
        frame = self.stack[-1]
        in_table = isinstance(frame.node, BlockTable)
        if self.run.ended_by is None or len(self.stack) > 1 + in_table or self.run.branches:
            return
        (code, line), self.run.ended_by = self.run.ended_by, None
        if line <= 0 or self.stack[0].body is not self.run.program.body:
            return
        if not in_table and frame.at and not self._is_of_job(frame.body[frame.at - 1]):
            return
        if in_table and (after := frame.next_line()):
            self._text_after_end(code, after)
            return
        for node in self.run.program.body:
            if _first_line(node) > line and self._is_of_job(node):
                self._text_after_end(code, _first_line(node))
                return

    def _is_of_job(self, node: Statement) -> bool:
        """Whether a statement is in the job itself, not in a file of settings that runs something around it."""
        if isinstance(node, BlockTable):
            return node.file == 0
        file = node.place[0] if isinstance(node, DeferredBlock) else node.span.file
        return not self.run.program.files or file == self.run.program.files[0].name

    def _text_after_end(self, code: str, line: int) -> None:
        self.run.findings.add(codes.TEXT_AFTER_END.at(Span(self.run.trace.files[self.run.file], line), code=code))

    def _ready(self) -> Iterator[Chunk]:
        ready, self.run.rows.ready = self.run.rows.ready, []
        yield from ready

    def _step(self) -> None:
        """The next statement of the innermost frame, or its end."""
        frame = self.stack[-1]
        if isinstance(frame.node, BlockTable):
            self.tables.run_table(frame)
            return
        if frame.at >= len(frame.body):
            self._leave(frame)
            return
        node = frame.body[frame.at]
        frame.at += 1
        kind = type(node)
        if kind in _PASSED_OVER and node.deleted:  # type: ignore[union-attr]
            # A block looks after its slash itself.
            self.run.met_deleted = self.run.met_deleted or not _is_harmless(node)
            if self.run.block_delete:
                return
        if kind is BlockTable:
            assert isinstance(node, BlockTable)
            self.hot_blocks.run_pending()
            self.run.file = node.file
            if node.distances:
                self.run.modal.absolute = node.distances == "G90"
            self.stack.append(Frame((), node, next_byte=node.begin, line=node.first_line, continued=node.continued))
        elif kind is If:
            assert isinstance(node, If)
            self._if(node)
        elif kind in _SILENT:
            pass
        elif kind is Jump:
            assert isinstance(node, Jump)
            self.order.jump(node)
        elif kind is Return:
            assert isinstance(node, Return)
            self.order.go_back(node)
        elif kind is For:
            assert isinstance(node, For)
            self.order.begin_for(node)
        elif kind is Repeat:
            assert isinstance(node, Repeat)
            self.order.enter(node.span)
            self.loops += 1
            self.stack.append(Frame(node.body, node))
        elif kind is While:
            assert isinstance(node, While)
            self.order.enter(node.span)
            self.loops += 1
            self.stack.append(Frame(node.body, node, len(node.body)))
        elif kind is Call:
            assert isinstance(node, Call)
            self.run.spend(node.span)
            self.run.dialect.call(self.run, node)
        elif kind is Replaced:
            assert isinstance(node, Replaced)
            if node.body:
                self.order.enter(node.span)
                self.stack.append(Frame(node.body, node))
        elif kind is Array:
            assert isinstance(node, Array)
            self.hot_blocks.run_pending()
            self.run.spend(node.span)
            self.run.dialect.array(self.run, node)
        else:
            assert not isinstance(node, BlockTable)
            is_block = isinstance(node, Block)
            again = is_block and (self.loops or self.called or self.came_back)
            if not again or not self.hot_blocks.fast_block(node):  # type: ignore[arg-type]
                node = node.made() if isinstance(node, DeferredBlock) else node
                self.hot_blocks.run_pending()
                self.run.spend(node.span)
                self._guarded(node)

    def _leave(self, frame: Frame) -> None:
        """A frame is done: again, for a loop whose condition holds; else back to the one around it."""
        node = frame.node
        if isinstance(node, LOOPS):
            if self.order.loops_on(frame, node):
                return
        elif self.run.dialect.is_unended(self.run, frame):
            self.order.module_end(frame)
        if (frame.again or frame.more) and self.order.again(frame):
            return
        if frame.cells is not None and self.run.dialect.next_cell(self.run, frame):
            return
        self._last = self.stack.pop().body
        self.loops -= isinstance(node, LOOPS)
        if node is not None:
            self.nesting -= 1
        if isinstance(frame.caller, Caller):
            self.hot_blocks.run_pending()
            self.run.call, self.run.file = frame.caller.call, frame.caller.file
            self.called = self.called[:-1]
            self.run.dialect.back_from_file(self.run, frame.caller.before)
            self.order.give_back(frame.caller.back)
            if frame.caller.rest is not None:
                self.run.dialect.rest_of_line(self.run, *frame.caller.rest)
        if frame.group is not None:
            self.paths.await_others(frame.group)

    def _if(self, node: If) -> None:
        self.run.spend(node.span)
        if node.head is not None:
            self._ask(node.head)
        self.order.enter(node.span)
        holds = self.paths.holds(node.condition, ("if", id(node)))
        if holds is None:
            self.paths.split(node, None)
        else:
            self.stack.append(Frame(node.then if holds else node.otherwise, node))

    def _ask(self, head: Statement) -> None:
        """The line that asks, where it does something itself: a question on the screen."""
        self.hot_blocks.run_pending()
        if isinstance(head, Replaced):
            for node in head.body:
                self._ask(node)
        elif isinstance(head, Message):
            self._guarded(head)

    def _with_settings(self, sub: Subprogram, span: Span) -> tuple[Statement, ...]:
        """What runs for a subprogram: a file may have around it what the machine runs around the job."""
        program = self.run.program
        if not sub.is_file or program.around_files is False or self._in_settings():
            return sub.body
        if program.around_files is None:
            if not self._told_around:
                self._told_around = True
                what = f"a call of {sub.name}, with the commands before and after a job around it or not,"
                self.run.findings.add(codes.UNSUPPORTED_CODE.at(span, code=what))
            return sub.body
        if sub.name not in self._around:
            self._around[sub.name] = (*program.head, *sub.body, *program.tail)
        return self._around[sub.name]

    def _in_settings(self) -> bool:
        """Whether what runs was started by a command that runs around files: no such command runs around that."""
        head, tail = len(self.run.program.head), len(self.run.program.tail)
        for n, frame in enumerate(self.stack):
            if n == 0 and frame.body is not self.run.program.body:
                return True
            if (n == 0 or frame.around) and not head < frame.at <= len(frame.body) - tail:
                return True
        return False

    def leave_file(self, span: Span) -> None:
        """End the file that runs: back to its caller, or the end of the job."""
        place = next((n for n in reversed(range(len(self.stack))) if self.stack[n].caller is not None), -1)
        if place < 0:
            if any(frame.cells is not None for frame in self.stack):
                what = "M99 in an array of the job (the manual does not say whether the other places are still cut)"
                raise FollowedRefusal(codes.UNSUPPORTED_CODE.at(span, code=what))
            if self._is_more():
                what = (
                    "M99 in the job itself with lines after it (the manual does not say whether it ends more "
                    "than a subprogram)"
                )
                raise FollowedRefusal(codes.UNSUPPORTED_CODE.at(span, code=what))
            self.run.ended_by = "M99", span.line
            if self.run.program.tail and not self._is_behind():
                self._warn_after_end()
                self.end_with(self.run.program.tail)
                return
            self.run.event(Op.END, span)
            self.run.end_section(Wait.END, "end", -1, span)
            raise ProgramEnd
        gone = self.stack[place + 1 :]
        self.nesting -= sum(frame.node is not None and not isinstance(frame.node, BlockTable) for frame in gone)
        self.loops -= sum(isinstance(frame.node, LOOPS) for frame in gone)
        self.stack = self.stack[: place + 1]
        frame = self.stack[-1]
        end = len(frame.body) - (len(self.run.program.tail) if frame.around else 0)
        frame.at = end if frame.at <= end else len(frame.body)
        self.paths.arrived(gone, 1)

    def _is_more(self) -> bool:
        """Whether lines of the job are left to run."""
        if self._is_behind():
            return False
        for n, frame in enumerate(self.stack):
            if isinstance(frame.node, BlockTable):
                more = frame.next_line() > 0 or frame.next_byte < frame.node.end
            else:
                more = frame.at < len(frame.body) - (len(self.run.program.tail) if n == 0 else 0)
            if more:
                return True
        return False

    def _is_behind(self) -> bool:
        """Whether what runs is after the job, or after its abort."""
        first = self.stack[0]
        at_tail = first.body is self.run.program.body and first.at > len(first.body) - len(self.run.program.tail)
        return at_tail or (first.body is not self.run.program.body and first.caller is None)

    def aborted(self) -> bool:
        """The job aborts itself: go on with what the controller runs then; False where there is no such thing."""
        if not self.run.program.abort or self.stack[0].body is self.run.program.abort:
            return False
        self.end_with(self.run.program.abort)
        return True

    def end_with(self, body: tuple[Statement, ...]) -> None:
        """Leave all that runs; what is left to do is this, and then the job is over."""
        gone, self.stack = self.stack, [Frame(body)]
        self.nesting, self.loops, self.called = 0, 0, []
        self.run.call, self.run.file = 0, 0
        self.paths.arrived(gone, 1)

    def call_subprogram(self, name: str, span: Span, rest: tuple[Span, list[Word]] | None = None) -> None:
        """Run a subprogram next; ``rest``: what is left of the line that called it."""
        self.hot_blocks.run_pending()
        sub = self.run.program.subprograms.get(name)
        if sub is None:
            told = any(f.code is codes.UNKNOWN_SUBPROGRAM and f.span == span for f in self.run.findings.kept)
            if not told:
                self.run.fail(codes.UNKNOWN_SUBPROGRAM.at(span, name=name))
            return
        allowed = self.run.dialect.nesting(self.run.machine)
        again = self.called.count(name)
        asked = 0 < again <= sum(frame.group is not None for frame in self.stack)
        if asked and not self._counts(sub):
            # One more answer of the operator each time: the answer is UNKNOWN long before any controller's limit.
            allowed = min(allowed, self.called.index(name) + MOST_RETRIES)
        if len(self.called) >= allowed:
            chain = " > ".join([*self.called[-3:], name])
            # No manual says how deep calls may be; one that only an unknown outcome repeats need not come to that.
            asked = asked or any(frame.group is not None for frame in self.stack)
            kind = codes.RECURSION.as_unknown() if asked else codes.RECURSION
            raise Refusal(kind.at(span, allowed=allowed, chain=chain))
        charge = call_blocks(len(self.called))
        if charge:
            self.run.blocks += charge - 1
            self.run.charged += charge
            self.run.spend(span)
        self.order.enter(span)
        caller = Caller(self.run.call, self.run.file, rest, numbers=dict(self.run.modal.parameters) if again else None)
        self.called = [*self.called, name]
        text = f"{' > '.join(self.called)} (from line {span.line})"
        number = self.call_texts.get(text)
        if number is None:
            number = self.call_texts[text] = len(self.run.trace.calls)
            self.run.trace.calls.append(text)
        self.run.call = number
        body = self._with_settings(sub, span)
        self.stack.append(Frame(body, sub, caller=caller, around=body is not sub.body))

    def _counts(self, sub: Subprogram) -> bool:
        """Whether a variable is another number than at the call before: one that counts may end the calls."""
        callers = (frame.caller for frame in reversed(self.stack) if frame.node is sub and frame.caller is not None)
        before = next(callers, None)
        if before is None or before.numbers is None:
            return True
        now = self.run.modal.parameters
        return any(
            not isinstance(value, Unknown)
            and not isinstance(now.get(number, value), Unknown)
            and now.get(number, value) != value
            for number, value in before.numbers.items()
        )

    def _guarded(self, node: Statement) -> None:
        """One statement; a Refusal inside it becomes a finding and the next statement follows."""
        try:
            if isinstance(node, Block):
                self._block(node)
            elif isinstance(node, Message):
                self._message(node)
            elif isinstance(node, Guard):
                guards = set(self.run.modal.guards_off) - {node.name} | (set() if node.on else {node.name})
                self.run.modal.guards_off = tuple(sorted(guards))
                self.run.state_changed()
                self.run.event(Op.GUARD, node.span, arg=(float(node.on), 0.0), text=self.run.text_number(node.name))
            elif isinstance(node, Device) and node.name == OWN_TOOL_CHANGE:
                self._own_tool_change(node)
            elif isinstance(node, Device) and node.name == OWN_SPINDLE_OFF:
                self._own_spindle_off(node)
            elif isinstance(node, Device):
                self.run.dialect.device(self.run, node)
            elif isinstance(node, Mistake):
                finding = self.run.as_accepted(Finding(codes.CODES[node.code], node.span, node.message, node.hint))
                refused_lines.lose_everything(self.run, finding)
                raise Refusal(finding)
            elif isinstance(node, Unsupported):
                entry = ACCEPTS.get(node.accepted)
                if entry is not None and self.run.takes(entry):
                    for one in node.means:
                        self._guarded(one)
                    return
                hint = entry.hint if entry else ""
                finding = codes.UNSUPPORTED_CODE.at(node.span, code=node.what, hint=hint)
                self.run.dialect.unsupported(self.run, node)
                refused_lines.lose_everything(self.run, finding)
                raise Refusal(finding)
            elif isinstance(node, Definition):
                what = f"the definition of {node.name} in a file that runs as a job"
                raise Refusal(codes.UNSUPPORTED_CODE.at(node.span, code=what))
            else:
                # Nothing that a program may hold is passed over because nobody has thought of it here.
                raise Refusal(codes.UNSUPPORTED_CODE.at(node.span, code=type(node).__name__.lower()))  # type: ignore[union-attr]
        except Refusal as refusal:
            finding = self.run.as_accepted(refusal.finding)
            self.run.refuse(finding, told=isinstance(node, Unsupported | Mistake) and node.told)

    def _own_tool_change(self, node: Device) -> None:
        """The machine's own tool change, in comparisons of two machines: the section ends at it."""
        run = self.run
        number = run.evaluator.value(node.arguments[0])
        run.modal.tool = None if isinstance(number, Unknown) else round(number)
        run.state_changed()
        run.event(Op.TOOL_CHANGE, node.span, arg=(math.nan if isinstance(number, Unknown) else number, 0.0))
        run.end_section(Wait.TOOL_CHANGE, "tool changed", None, node.span)

    def _own_spindle_off(self, node: Device) -> None:
        """Before that tool change, outputs of the spindle that are on: off, or that is open."""
        run = self.run
        tool, when, *channels = (run.evaluator.value(one) for one in node.arguments)
        on = {number for number, value in run.modal.outputs if value}
        turning = [one for one in channels if not isinstance(one, Unknown) and round(one) in on]
        before = run.modal.tool
        if not turning or (when == 1.0 and before is not None and tool == float(before)):
            return
        if when == 2.0 or (when == 1.0 and (before is None or isinstance(tool, Unknown))):
            raise Refusal(codes.UNSUPPORTED_CODE.at(node.span, code="a tool change that may leave the spindle on"))
        for channel in turning:
            run.modal.outputs = with_pair(run.modal.outputs, round(channel), 0.0)
            run.event(Op.OUTPUT, node.span, arg=(channel, 0.0))

    def _message(self, node: Message) -> None:
        text = describe_parts(node.parts, self.run.evaluator)
        self.run.event(Op.MESSAGE, node.span, text=self.run.text_number(text))
        if node.kind in ("ok", "run_next", "skip_next"):
            self.run.findings.add(codes.OPERATOR_STOP.at(node.span, code="a question"))
            self.run.end_section(Wait.OPERATOR, "answered", None, node.span)
        if node.kind in ("abort", "continue"):
            self.run.findings.add(codes.OPERATOR_STOP.at(node.span, code="a question"))
            going, ending = ("no", "yes") if node.kind == "abort" else ("yes", "no")
            stated = self.run.setup.answers.get(node.question)
            if stated is not None:
                ends = (stated != 0) == (ending == "yes")
                outcome = ending if ends else going
                behind = bool(self.run.program.abort)
                self.run.end_section(Wait.OPERATOR, outcome, -1 if ends and not behind else None, node.span)
                if ends and not self.aborted():
                    raise ProgramEnd
                return
            target = self.run.rows.new_section()
            end = self.run.rows.new_section() if self.run.program.abort else -1
            for section, answer in ((target, going), (end, ending)):
                self.run.asked[section] = Asked(
                    span=node.span, what=f"the question '{text}'", answer=f"is answered {answer}"
                )
            self.run.close_section((
                self.run.edge(Wait.OPERATOR, going, target, node.span),
                self.run.edge(Wait.OPERATOR, ending, end, node.span),
            ))  # fmt: skip
            if end >= 0:
                self.waiting.append(
                    Path([Frame(self.run.program.abort)], self.run.modal.copy(), end, (0, 0, [], False, 0))
                )
            self.run.begin_section(target)
        if node.kind == "dialog":
            self.run.dialect.dialog(self.run, node)
        if node.kind == "warning":
            # The manual's tool setter waits after each of its warnings until RUN is pressed (2.13).
            self.run.end_section(Wait.OPERATOR, "warning read", None, node.span)
        if node.kind == "error":
            self.run.findings.add(self.run.ends_here(codes.ERROR_MESSAGE).at(node.span, text=text))
            self.run.end_section(Wait.OPERATOR, "error message", -1, node.span)
            raise ProgramEnd

    def _block(self, node: Block) -> None:
        if node.deleted:
            self.run.met_deleted = True
            if self.run.block_delete:
                return
        words = [(w.letter, self.run.evaluator.value(w.value), w.span) for w in node.words]
        self.run.dialect.block(self.run, node, words)


MOST_RETRIES = 8
"""Calls of a subprogram within itself, when an outcome says so and nothing counts them: so many are followed."""
_SILENT = frozenset((Label, Declare, Include, Mode))
"""Statements that do nothing when they run."""
OWN_TOOL_CHANGE = "own_tool_change"
OWN_SPINDLE_OFF = "own_spindle_off"
_PASSED_OVER = frozenset((Call, Message, Guard, Device, Unsupported))


def _is_harmless(node: Statement) -> bool:
    """Whether it makes no difference to the machine if a block delete switch passes over the statement."""
    if isinstance(node, Device):
        return node.name == "log_file"
    return isinstance(node, Message) and node.kind in ("msg", "log")


def _first_line(node: Statement) -> int:
    if isinstance(node, BlockTable):
        return node.first_line
    # A block that is made on demand knows its line without being made.
    return node.place[1] if isinstance(node, DeferredBlock) else node.span.line


def begin(
    program: Program, setup: Setup, machine: Machine, findings: Findings, dialect: Dialect[Any], **options: Any
) -> Run:  # fmt: skip
    """A run that has not done anything yet; options: keyword arguments of ``Run``."""
    run = dialect.run_type(program, setup, machine, findings, dialect, **options)
    run.flow = ControlFlow(run)
    return run
