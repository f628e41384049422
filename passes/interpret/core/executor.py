"""Execution: Program + Setup -> Trace, streamed in chunks.

One run is a chain of classes, each of which knows one thing: ``emitter`` (state and rows), ``motion`` (moves),
``origins`` (where numbers count from), ``blocks`` (a line in the order of the manual), ``straight`` (tables of plain
lines), ``loops`` (lines that come again), ``branches`` (conditions that nobody can decide), and here statements, calls
and messages. Errors are findings: the line that has one does nothing more, and execution goes on behind it so that one
run shows all of them; ``stop_at_error`` ends there instead, as the controller would.
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterator

from gproof.ir import codes
from gproof.ir.columns import Columns
from gproof.ir.dialects.accepts import ACCEPTS
from gproof.ir.finding import Finding, Findings, FollowedRefusal, Refusal, Span
from gproof.ir.machine import Machine
from gproof.ir.program import (
    Array,
    Assign,
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
from gproof.ir.symbolic import Unknown, Value
from gproof.ir.trace import Chunk, Edge, Op, Trace, TraceSection, Wait
from gproof.passes.interpret.core import refused_lines
from gproof.passes.interpret.core.call_stack import Caller, Frame, Path
from gproof.passes.interpret.core.control_flow import Flow
from gproof.passes.interpret.core.expressions import describe_parts
from gproof.passes.interpret.core.loop_widening import call_blocks
from gproof.passes.interpret.core.outcomes import Asked
from gproof.passes.interpret.core.path_exploration import LOOPS
from gproof.passes.interpret.core.trace_writer import DEFAULT_BRANCHES, DEFAULT_BUDGET, ProgramEnd
from gproof.passes.interpret.eding.commands import run_command
from gproof.passes.interpret.eding.dialogs import run_dialog
from gproof.passes.interpret.eding.remapped_codes import Words, replaced
from gproof.passes.interpret.wincnc.part_arrays import back_from_file, begin_array, next_cell
from gproof.passes.motion.knife_axis import follow_knife


class Executor(Flow):
    """One run of a program.

    block_delete: lines with a leading slash are skipped. ``met_deleted`` tells afterwards whether there were
    any; ``assumed`` lists what the run took for granted; ``blocks`` counts executed lines; ``branches`` counts
    outcomes that were followed; ``refused``: the trace lacks what a line of the job would do.
    """

    def run(self) -> Iterator[Chunk]:
        """Execute; yields chunks of successive rows, the last one of each section with its edges."""
        self.findings.section = self.rows.section
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
                self._refuse(self.as_accepted(refusal.finding))
                self._tell_rest(refusal.finding)
                self._end_section(Wait.UNKNOWN, refusal.finding.message, -1, refusal.finding.span)
        if not self._ended:
            if self.failed is None:
                span = Span(self.trace.files[self._file], max(1, self.program.line_count))
                self.event(Op.END, span, arg=(2.0 if self._last is self.program.abort else 1.0, 0.0))
            self._close((Edge(wait=Wait.END, outcome="end", target=-1),))

    def _warn_after_end(self) -> None:
        """Warn once of code behind an end that every run reaches."""
        if not self._stack or (self.program.rules.source_order and self._labels(self.program.body)):
            # Behind an end there may be what labels lead to.
            return
        frame = self._stack[-1]
        in_table = isinstance(frame.node, BlockTable)
        if self._end is None or len(self._stack) > 1 + in_table or self.branches:
            return
        (code, line), self._end = self._end, None
        if line <= 0 or self._stack[0].body is not self.program.body:
            return
        if not in_table and frame.at and not self._is_of_job(frame.body[frame.at - 1]):
            return
        if in_table and (after := frame.next_line()):
            self._text_after_end(code, after)
            return
        for node in self.program.body:
            if _first_line(node) > line and self._is_of_job(node):
                self._text_after_end(code, _first_line(node))
                return

    def _is_of_job(self, node: Statement) -> bool:
        """Whether a statement stands in the job itself, not in a file of settings that runs something around it."""
        if isinstance(node, BlockTable):
            return node.file == 0
        file = node.place[0] if isinstance(node, DeferredBlock) else node.span.file
        return not self.program.files or file == self.program.files[0].name

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
        if frame.at >= len(frame.body):
            self._leave(frame)
            return
        node = frame.body[frame.at]
        frame.at += 1
        kind = type(node)
        if kind in _PASSED_OVER and node.deleted:  # type: ignore[union-attr]
            # A block looks after its slash itself.
            self.met_deleted = self.met_deleted or not _is_harmless(node)
            if self.block_delete:
                return
        if kind is BlockTable:
            assert isinstance(node, BlockTable)
            self._run_pending()
            self._file = node.file
            if node.distances:
                self.modal.absolute = node.distances == "G90"
            self._stack.append(Frame((), node, next_byte=node.begin, line=node.first_line, continued=node.continued))
        elif kind is If:
            assert isinstance(node, If)
            self._if(node)
        elif kind in _SILENT:
            pass
        elif kind is Jump:
            assert isinstance(node, Jump)
            self._jump(node)
        elif kind is Return:
            assert isinstance(node, Return)
            self._return(node)
        elif kind is For:
            assert isinstance(node, For)
            self._begin_for(node)
        elif kind is Repeat:
            assert isinstance(node, Repeat)
            self._enter(node.span)
            self._loops += 1
            self._stack.append(Frame(node.body, node))
        elif kind is While:
            assert isinstance(node, While)
            self._enter(node.span)
            self._loops += 1
            self._stack.append(Frame(node.body, node, len(node.body)))
        elif kind is Call:
            assert isinstance(node, Call)
            self.spend(node.span)
            self._manner.call(self, node)
        elif kind is Replaced:
            assert isinstance(node, Replaced)
            if node.body:
                self._enter(node.span)
                self._stack.append(Frame(node.body, node))
        elif kind is Array:
            assert isinstance(node, Array)
            self._run_pending()
            self.spend(node.span)
            begin_array(self, node)
        else:
            assert not isinstance(node, BlockTable)
            is_block = isinstance(node, Block)
            again = is_block and (self._loops or self._depth or self._came_back)
            if not again or not self._fast_block(node):  # type: ignore[arg-type]
                node = node.made() if isinstance(node, DeferredBlock) else node
                self._run_pending()
                self.spend(node.span)
                self._guarded(node)

    def _leave(self, frame: Frame) -> None:
        """A frame is done: again, for a loop whose condition holds; else back to the one around it."""
        node = frame.node
        if isinstance(node, LOOPS):
            if self._loops_on(frame, node):
                return
        elif self._falls_off(frame):
            self._module_end(frame)
        if (frame.again or frame.more) and self._again(frame):
            return
        if frame.cells is not None and next_cell(self, frame):
            return
        self._last = self._stack.pop().body
        self._loops -= isinstance(node, LOOPS)
        if node is not None:
            self._nesting -= 1
        if isinstance(frame.caller, Caller):
            self._run_pending()
            self._call, self._file = frame.caller.call, frame.caller.file
            self._depth = self._depth[:-1]
            back_from_file(self, frame.caller.before)
            self._give_back(frame.caller.back)
            if frame.caller.rest is not None:
                super()._line(*frame.caller.rest)
        if frame.group is not None:
            self._await_others(frame.group)

    def _if(self, node: If) -> None:
        self.spend(node.span)
        if node.head is not None:
            self._ask(node.head)
        self._enter(node.span)
        holds = self._holds(node.condition, ("if", id(node)))
        if holds is None:
            self._split(node, None)
        else:
            self._stack.append(Frame(node.then if holds else node.otherwise, node))

    def _ask(self, head: Statement) -> None:
        """The line that asks, where it does something itself: a question on the screen."""
        self._run_pending()
        if isinstance(head, Replaced):
            for node in head.body:
                self._ask(node)
        elif isinstance(head, Message):
            self._guarded(head)

    def _with_settings(self, sub: Subprogram, span: Span) -> tuple[Statement, ...]:
        """What runs for a subprogram: a file may have around it what the machine runs around the job."""
        program = self.program
        if not sub.is_file or program.around_files is False or self._in_settings():
            return sub.body
        if program.around_files is None:
            if not self._told_around:
                self._told_around = True
                what = f"a call of {sub.name}, around which the commands before and behind a job may run too,"
                self.findings.add(codes.UNSUPPORTED_CODE.at(span, code=what))
            return sub.body
        if sub.name not in self._around:
            self._around[sub.name] = (*program.head, *sub.body, *program.tail)
        return self._around[sub.name]

    def _in_settings(self) -> bool:
        """Whether what runs was begun by a command that runs around files: no such command runs around that."""
        head, tail = len(self.program.head), len(self.program.tail)
        for n, frame in enumerate(self._stack):
            if n == 0 and frame.body is not self.program.body:
                return True
            if (n == 0 or frame.around) and not head < frame.at <= len(frame.body) - tail:
                return True
        return False

    def _leave_file(self, span: Span) -> None:
        """End the file that runs: back to its caller, or the end of the job."""
        place = next((n for n in reversed(range(len(self._stack))) if self._stack[n].caller is not None), -1)
        if place < 0:
            if any(frame.cells is not None for frame in self._stack):
                what = "M99 in an array of the job (whether the other places are still cut is not said)"
                raise FollowedRefusal(codes.UNSUPPORTED_CODE.at(span, code=what))
            if self._is_more():
                what = "M99 in the job itself with lines behind it (whether it ends more than a subprogram is not said)"
                raise FollowedRefusal(codes.UNSUPPORTED_CODE.at(span, code=what))
            self._end = "M99", span.line
            if self.program.tail and not self._is_behind():
                self._warn_after_end()
                self.end_with(self.program.tail)
                return
            self.event(Op.END, span)
            self._end_section(Wait.END, "end", -1, span)
            raise ProgramEnd
        gone = self._stack[place + 1 :]
        self._nesting -= sum(frame.node is not None and not isinstance(frame.node, BlockTable) for frame in gone)
        self._loops -= sum(isinstance(frame.node, LOOPS) for frame in gone)
        self._stack = self._stack[: place + 1]
        frame = self._stack[-1]
        end = len(frame.body) - (len(self.program.tail) if frame.around else 0)
        frame.at = end if frame.at <= end else len(frame.body)
        self._arrived(gone, 1)

    def _is_more(self) -> bool:
        """Whether lines of the job are left to run."""
        if self._is_behind():
            return False
        for n, frame in enumerate(self._stack):
            if isinstance(frame.node, BlockTable):
                more = frame.next_line() > 0 or frame.next_byte < frame.node.end
            else:
                more = frame.at < len(frame.body) - (len(self.program.tail) if n == 0 else 0)
            if more:
                return True
        return False

    def _is_behind(self) -> bool:
        """Whether what runs is behind the job, or behind its abort."""
        first = self._stack[0]
        at_tail = first.body is self.program.body and first.at > len(first.body) - len(self.program.tail)
        return at_tail or (first.body is not self.program.body and first.caller is None)

    def aborted(self) -> bool:
        """The job aborts itself: go on with what the controller runs then; False where there is no such thing."""
        if not self.program.abort or self._stack[0].body is self.program.abort:
            return False
        self.end_with(self.program.abort)
        return True

    def end_with(self, body: tuple[Statement, ...]) -> None:
        """Leave all that runs; what is left to do is this, and then the job is over."""
        gone, self._stack = self._stack, [Frame(body)]
        self._nesting, self._loops, self._depth = 0, 0, []
        self._call, self._file = 0, 0
        self._arrived(gone, 1)

    def _called(self, name: str, span: Span, rest: tuple[Span, list[Words]] | None = None) -> None:
        """Run a subprogram next; ``rest``: what is left of the line that called it."""
        self._run_pending()
        sub = self.program.subprograms.get(name)
        if sub is None:
            told = any(f.code is codes.UNKNOWN_SUBPROGRAM and f.span == span for f in self.findings.kept)
            if not told:
                self._fail(codes.UNKNOWN_SUBPROGRAM.at(span, name=name))
            return
        own = self.machine.settings.nesting
        allowed = self.program.rules.call_depth if own is None else own
        again = self._depth.count(name)
        asked = 0 < again <= sum(frame.group is not None for frame in self._stack)
        if asked and not self._counts(sub):
            # One more answer of the operator each time: the answer is UNKNOWN long before any controller's limit.
            allowed = min(allowed, self._depth.index(name) + MOST_RETRIES)
        if len(self._depth) >= allowed:
            chain = " > ".join([*self._depth[-3:], name])
            # No manual says how deep calls may be; one that only an unknown outcome repeats need not come to that.
            asked = asked or any(frame.group is not None for frame in self._stack)
            kind = codes.RECURSION.as_unknown() if asked else codes.RECURSION
            raise Refusal(kind.at(span, allowed=allowed, chain=chain))
        charge = call_blocks(len(self._depth))
        if charge:
            self.blocks += charge - 1
            self.charged += charge
            self.spend(span)
        self._enter(span)
        caller = Caller(self._call, self._file, rest, numbers=dict(self.modal.parameters) if again else None)
        self._depth = [*self._depth, name]
        text = f"{' > '.join(self._depth)} (from line {span.line})"
        number = self._calls.get(text)
        if number is None:
            number = self._calls[text] = len(self.trace.calls)
            self.trace.calls.append(text)
        self._call = number
        body = self._with_settings(sub, span)
        self._stack.append(Frame(body, sub, caller=caller, around=body is not sub.body))

    def _counts(self, sub: Subprogram) -> bool:
        """Whether a variable is another number than at the call before: one that counts may end the calls."""
        callers = (frame.caller for frame in reversed(self._stack) if frame.node is sub and frame.caller is not None)
        before = next(callers, None)
        if before is None or before.numbers is None:
            return True
        now = self.modal.parameters
        return any(
            not isinstance(value, Unknown)
            and not isinstance(now.get(number, value), Unknown)
            and now.get(number, value) != value
            for number, value in before.numbers.items()
        )

    def _line(self, span: Span, words: list[Words]) -> None:
        """One line: by the subprogram that replaces a code of it (4.4, 3.5.3), else as the controller's own."""
        try:
            found = replaced(self.program, self._depth, words, span)
        except Refusal as refusal:
            self._refuse(self.as_accepted(refusal.finding))
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
            elif isinstance(node, Mistake):
                finding = self.as_accepted(Finding(codes.CODES[node.code], node.span, node.message, node.hint))
                refused_lines.lose_everything(self, finding)
                raise Refusal(finding)
            elif isinstance(node, Unsupported):
                entry = ACCEPTS.get(node.accepted)
                if entry is not None and self.takes(entry):
                    for one in node.means:
                        self._guarded(one)
                    return
                hint = entry.hint if entry else ""
                finding = codes.UNSUPPORTED_CODE.at(node.span, code=node.what, hint=hint)
                self._manner.unsupported(self, node)
                refused_lines.lose_everything(self, finding)
                raise Refusal(finding)
            elif isinstance(node, Definition):
                what = f"the definition of {node.name} in a file that is run as a job"
                raise Refusal(codes.UNSUPPORTED_CODE.at(node.span, code=what))
            else:
                # Nothing that a program may hold is passed over because nobody has thought of it here.
                raise Refusal(codes.UNSUPPORTED_CODE.at(node.span, code=type(node).__name__.lower()))  # type: ignore[union-attr]
        except Refusal as refusal:
            finding = self.as_accepted(refusal.finding)
            self._refuse(finding, told=isinstance(node, Unsupported | Mistake) and node.told)

    def _message(self, node: Message) -> None:
        text = describe_parts(node.parts, self.evaluator)
        self.event(Op.MESSAGE, node.span, text=self._text(text))
        if node.kind in ("ok", "run_next", "skip_next"):
            self.findings.add(codes.OPERATOR_STOP.at(node.span, code="a question"))
            self._end_section(Wait.OPERATOR, "answered", None, node.span)
        if node.kind in ("abort", "continue"):
            self.findings.add(codes.OPERATOR_STOP.at(node.span, code="a question"))
            going, ending = ("no", "yes") if node.kind == "abort" else ("yes", "no")
            stated = self.setup.answers.get(node.question)
            if stated is not None:
                ends = (stated != 0) == (ending == "yes")
                outcome = ending if ends else going
                behind = bool(self.program.abort)
                self._end_section(Wait.OPERATOR, outcome, -1 if ends and not behind else None, node.span)
                if ends and not self.aborted():
                    raise ProgramEnd
                return
            target = self.rows.new_section()
            end = self.rows.new_section() if self.program.abort else -1
            for section, answer in ((target, going), (end, ending)):
                self.asked[section] = Asked(
                    span=node.span, what=f"the question '{text}'", answer=f"is answered {answer}"
                )
            self._close((
                self._edge(Wait.OPERATOR, going, target, node.span),
                self._edge(Wait.OPERATOR, ending, end, node.span),
            ))  # fmt: skip
            if end >= 0:
                self._waiting.append(Path([Frame(self.program.abort)], self.modal.copy(), end, (0, 0, [], False, 0)))
            self._begin(target)
        if node.kind == "dialog":
            run_dialog(self, node)
        if node.kind == "warning":
            # The manual's tool setter waits behind each of its warnings until RUN is pressed (2.13).
            self._end_section(Wait.OPERATOR, "warning read", None, node.span)
        if node.kind == "error":
            self.findings.add(self.ends_here(codes.ERROR_MESSAGE).at(node.span, text=text))
            self._end_section(Wait.OPERATOR, "error message", -1, node.span)
            raise ProgramEnd

    def _block(self, node: Block) -> None:
        if node.deleted:
            self.met_deleted = True
            if self.block_delete:
                return
        words = [(w.letter, self.evaluator.value(w.value), w.span) for w in node.words]
        self._manner.block(self, node, words)

    def _setting(self, node: Assign) -> tuple[Value, Value, Span]:
        number = self.evaluator.value(node.target.number)
        if node.target.name and not isinstance(number, Unknown):
            self.evaluator.names[round(number)] = node.target.name
        return number, self.evaluator.value(node.value), node.target.span


MOST_RETRIES = 8
"""Calls of a subprogram within itself, when an outcome says so and nothing counts them: so many are followed."""
_SILENT = frozenset((Label, Declare, Include, Mode))
"""Statements that do nothing when they run."""
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
