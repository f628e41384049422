"""Program -> Job for WinCNC. The manual has no section numbers: headings and codes are named instead.

What a command is in a Job is in ``HANDLERS``; one that is not there has no form, and gives a ``NotRaised`` with its
name. docs/dialects/wincnc.md says how what the manual leaves open is read; where it leaves open what a line does, the
line is not raised.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping
from dataclasses import replace

from gproof.frontend.common.move_tables import moves_of, simple_lines
from gproof.frontend.common.raising import MOST_PASSES, Line, Unraisable
from gproof.frontend.common.raising_modes import UNKNOWN_MODE
from gproof.frontend.wincnc import raising_cycles as cycles
from gproof.frontend.wincnc import raising_devices as devices
from gproof.frontend.wincnc import raising_frames as frames
from gproof.frontend.wincnc import raising_motion as motion
from gproof.frontend.wincnc.plain_devices import device_switches, spindle_off
from gproof.frontend.wincnc.raising_feeds import after_table, say_feeds, table_feeds, unknown
from gproof.frontend.wincnc.raising_line import Command, LineRaiser
from gproof.ir.columns import Array as Numbers
from gproof.ir.columns import Columns
from gproof.ir.dialects.accepts import KEPT_MOTION
from gproof.ir.finding import Span
from gproof.ir.job import (
    ARC_CW,
    ChangeTool,
    Choice,
    EndJob,
    Job,
    LeaveRoutine,
    Moves,
    Node,
    NotRaised,
    PauseJob,
    RepeatGrid,
    SetFrame,
    ShowText,
    TurnSpindle,
    UseLength,
    walk,
)
from gproof.ir.machine import Machine
from gproof.ir.program import (
    FLAG_BARE,
    Array,
    Block,
    Call,
    Expr,
    If,
    Input,
    Message,
    Named,
    Number,
    Program,
    Replaced,
    Statement,
    Subprogram,
    Text,
    Unary,
    Variable,
)
from gproof.ir.rules import CodeRule
from gproof.ir.rules import Function as F
from gproof.ir.setup import StoredPosition

Handler = Callable[[LineRaiser, Command, CodeRule], list[Node]]

HANDLERS: dict[F, Handler] = {
    F.TRAVERSE: motion.straight,
    F.FEED: motion.straight,
    F.ARC_CW: motion.arc,
    F.ARC_CCW: motion.arc,
    F.MACHINE_TRAVERSE: motion.machine_rapid,
    **dict.fromkeys(cycles.KINDS, cycles.hole),
    F.MOTION_CANCEL: cycles.end_of_cycle,
    F.UNITS_INCH: frames.units,
    F.UNITS_CM: frames.units,
    F.UNITS_MM: frames.units,
    F.UNITS_LAST: frames.units,
    F.FEED_INVERSE_TIME: frames.feed_mode,
    F.FEED_PER_MINUTE: frames.feed_mode,
    F.LOCAL_SET: frames.local_set,
    F.LOCAL_SHIFT_MACHINE: frames.local_at,
    F.LOCAL_SHIFT: frames.local_shift,
    F.LOCAL_SWITCH: frames.local_switch,
    F.KEEP_LOCAL: frames.keep_local,
    F.WORKSPACE: frames.workspace,
    F.TOOL_OFFSET_ON: frames.lengths,
    F.TOOL_OFFSET_OFF: frames.lengths,
    F.HOME: frames.home,
    F.LIMITS_ON: frames.limit_guards,
    F.LIMITS_OFF: frames.limit_guards,
    F.SCALING_ON: frames.scaling,
    F.ROTATION_ON: frames.rotation,
    F.TRANSFORM_OFF: frames.transform_off,
    F.DWELL: devices.dwell,
    F.WAIT_ON: devices.wait,
    F.WAIT_OFF: devices.wait,
}
OUTPUTS = (F.OUTPUT_ON, F.OUTPUT_OFF, F.OUTPUT_ON_MOVING, F.OUTPUT_OFF_MOVING)
WHY = {
    F.TRAVERSE_LIFTED: "how high it lifts the manual does not say",
    F.PROBE_ON: "a probe",
    F.CONDITION: "a state that only this controller has",
}
"""Why a command has no form in a Job; others are something that only this controller has."""
DEVICES = ("M3", "M4", "M5", "M7", "M8", "M9")
"""Codes of the spindle and coolant on other controllers, which shops define (Macro File Configuration)."""
JOB = ""


class WinCncRaiser(LineRaiser):
    """Lines of one command. comment: of the line that is raised."""

    def __init__(self, program: Program, machine: Machine) -> None:
        super().__init__(program, machine)
        self.comment = ""
        self.channels = devices.channels_of(program)

    # ---- the whole

    def job(self) -> Job:
        """The program as a Job, with what a file does to the zero of its caller; verified."""
        job = super().job()
        job.body = self._with_zero(job.body, JOB)
        job.routines = {
            name: replace(routine, body=self._with_zero(routine.body, name.partition("~")[0]))
            for name, routine in job.routines.items()
        }
        if self.controls.auto_output_on and self.controls.auto_output is not None:
            why = "an output that every feed move switches"
            span = Span(job.files[0] if job.files else "", 1)
            job.body = (NotRaised(construct="autoaux=", why=why, span=span), *job.body)
        job.verify()
        return job

    def _with_zero(self, body: tuple[Node, ...], name: str) -> tuple[Node, ...]:
        """A file that gives its caller's zero back keeps it at the start."""
        slots: dict[str, int] = self.__dict__.get("slots", {})
        if name not in slots:
            return body
        number = float(slots[name])
        back = (
            node for node in walk(body)
            if isinstance(node, SetFrame) and node.action == "zero_recall" and _is(node.number, number)
        )  # fmt: skip
        found = next(back, None)
        if found is None:
            return body
        first = body[0].span
        return (SetFrame(action="zero_keep", number=found.number, span=first), *body)

    def at_end(self, sub: Subprogram | None) -> list[Node]:
        """The zero of the caller, or of the operator, is back (M98, L92)."""
        name = JOB if sub is None else sub.name
        span = Span(self.program.files[0].name, max(1, self.program.files[0].line_count)) if sub is None else sub.span
        try:
            return frames.zero_back(self, name, span)
        except Unraisable as error:
            return [NotRaised(construct=error.construct, why=error.why, span=span)]

    def parameters_of(self, sub: Subprogram) -> tuple[Variable, ...]:
        """The words of a call that a file uses."""
        letters = sorted({name for node in sub.body for name in _arguments(node)})
        return tuple(_variable(letter, sub.span) for letter in letters)

    def comment_text(self, kind: int, text: bytes) -> str:
        """The text of a comment without its signs."""
        return devices.strip_signs(super().comment_text(kind, text))

    # ---- tables

    def plain_moves(self) -> bool:
        """Whether lines of axis words, centres and feeds are rows of ``Moves`` in the modes in force."""
        return super().plain_moves() and motion.is_plain(self)

    def simple_rows(self, words: Columns, firsts: Numbers) -> Numbers:
        """Lines with letters alone next to an F are read one by one: a feed for them, or a move to 0."""
        import numpy as np

        good = simple_lines(words, firsts, self.letters)
        bare = (words["flags"] & FLAG_BARE) != 0
        if bare.any():
            both = np.logical_or.reduceat(words["letter"] == ord("F"), firsts)
            good &= ~(np.logical_or.reduceat(bare, firsts) & both)
        return good

    def moves(self, words: Columns, file: int, span: Span) -> tuple[Moves, int, int] | None:
        """Simple lines as a table: each row has its feed where it differs from that of the move before."""
        import numpy as np

        taken = moves_of(words, self.now, self.letters, file, span)
        if taken is None:
            return None
        table, _, _ = taken
        rows = table.rows
        rate, good, _ = table_feeds(rows, self.now, self.feeds)
        good &= motion.good_arcs(self, rows)
        count = len(rows) if good.all() else int(np.argmin(good))
        if not count:
            return None
        rows, rate = rows.slice(0, count), rate[:count]
        said, last = say_feeds(rows, rate, self.now)
        _, _, filled = table_feeds(rows, self.now, self.feeds)
        modes = after_table(rows, filled, self.now, self.feeds, last)
        modes = motion.after_arcs(rows, modes)
        modes = motion.height_after(rows, modes)
        self.modes = replace(modes, sticky=())
        arrays = {name: rows[name] for name in (column.name for column in rows.schema.columns)} | {"feed": said}
        made = dataclasses.replace(table, rows=Columns(rows.schema, arrays))
        # The motion stays, that of an arc only where arcs are modal (arcs= M).
        kinds = rows["kind"] if self.controls.arcs_modal else rows["kind"][rows["kind"] < ARC_CW]
        now = self.now.motion
        assert isinstance(now, int)
        return made, (int(kinds[-1]) - 1) * 10 if len(kinds) else now, count

    # ---- lines

    def block(self, node: Block) -> list[Node]:
        """A line with braces, texts or codes that are no moves."""
        self.comment = node.comment
        if any(word.braced for word in node.words) and self.now.unit != self.unit:
            raise Unraisable("a number in braces", "its unit is not the one of WINCNC.INI")
        return super().block(node)

    def line(self, words: Line, span: Span) -> list[Node]:
        """What a line does."""
        line = self.command(words, span)
        line.comment, self.comment = self.comment, ""
        for one in line.companions:
            if one.function in (F.ABSOLUTE, F.INCREMENTAL):
                self.modes = replace(self.now, relative=one.function is F.INCREMENTAL)
        rule = line.command
        if rule is None:
            return self._without_command(line)
        if rule.function is F.UNSUPPORTED:
            raise Unraisable(rule.text, rule.open or "the manual does not describe it")
        stop = line.find(F.LIMIT_STOPS_AXIS, F.LIMIT_STOPS_LINE, F.STOP_PARSING)
        if stop is not None and rule.function not in (F.TRAVERSE, F.FEED):
            raise Unraisable(f"{rule.text} with {stop.text}", "a switch may end the move")
        if rule.function in OUTPUTS:
            return devices.output(self, line, rule, self.channels)
        if rule.function in (F.RETURN, F.ABORT):
            return self._end(rule, span)
        if rule.function in (F.MAP_WORDS, F.MAP_HEADS, F.MAP_PULSES) and not line.words:
            return []  # alone it ends a map, and none was raised
        if rule.function is F.COMPENSATION_OFF:
            return []  # none was raised
        handler = HANDLERS.get(rule.function)
        if handler is None:
            raise Unraisable(rule.text, WHY.get(rule.function, "something that only this controller has"))
        return handler(self, line, rule)

    def _without_command(self, line: Command) -> list[Node]:
        """A feed, a speed, or the motion in force."""
        letters = set(line.words)
        if letters == {"S"}:
            return devices.speed(self, line)
        if "S" in letters:
            raise Unraisable("S next to other words", "no command takes it")
        stop = line.find(F.LIMIT_STOPS_AXIS, F.LIMIT_STOPS_LINE, F.STOP_PARSING)
        if stop is not None:
            raise Unraisable(stop.text, "a switch may end the move")
        if not letters:
            return []
        if letters == {"F"}:
            motion.take_feed(self, line, 0)
            return []
        motion.need_no_places(line)
        now, cycle = self.now.motion, self.own_mode("cycle", 0)
        if now == UNKNOWN_MODE or unknown(cycle):
            raise Unraisable("axis words alone", "which motion is in force depends on the way that the program took")
        code = cycle or now
        if code == -1:
            if KEPT_MOTION.name not in self.machine.controller.accepts:
                raise Unraisable("axis words alone", "no motion is in force")
            code = 0
        rule = self.program.rules.codes["G", int(str(code))]
        for letter in sorted(letters - set(self.columns) - set(rule.takes)):
            raise Unraisable(f"{letter} in a line of {rule.text}", "no command takes it")
        return HANDLERS[rule.function](self, line, rule)

    def _end(self, rule: CodeRule, span: Span) -> list[Node]:
        """M99: back from a file, or the end of the job; M99.1: the job is aborted."""
        if rule.function is F.RETURN and self.running:
            nodes = self.at_end(self.program.subprograms[self.running[-1]])
            self.leave()
            return [*nodes, LeaveRoutine(span=span)]
        if rule.function is F.ABORT:
            return self._abort(span)
        nodes = [*self.statements(self.program.tail), *self.at_end(None)]
        self.modes = None
        return [*nodes, EndJob(span=span)]

    def _abort(self, span: Span) -> list[Node]:
        if self.own_mode("moved", False) is not False:
            raise Unraisable("M99.1", "whether the zero of the start is back then the manual does not say")
        nodes = self.statements(self.program.abort)
        self.modes = None
        return [*nodes, EndJob(span=span)]

    # ---- statements

    def own(self, node: Statement) -> list[Node]:
        """Lines that CNC.MAC replaces, conditions on the next line, arrays, questions."""
        if isinstance(node, Replaced):
            return self._replaced(node)
        if isinstance(node, If):
            return self._decides(node)
        if isinstance(node, Array):
            return self._array(node)
        if isinstance(node, Message):
            return self._message(node)
        raise Unraisable(type(node).__name__, "this statement has no neutral form")

    def _replaced(self, node: Replaced) -> list[Node]:
        """A tool change that the shop defines is one; else what stands in CNC.MAC."""
        given = {word.letter: word.value for word in node.line.words} if node.line is not None else {}
        name = devices.name_of(node)
        if name in DEVICES:
            # What the shop's macro does besides is its machine's own: it waits, or switches what belongs to it.
            switches = device_switches(node.body, self.program)
            if switches is not None:
                return devices.together(self.statements(switches))
        is_change = name == "M6" and "T" in given
        if not is_change or not devices.changes_tool(node.body, self.program):
            return devices.inlined(self.statements(node.body), self.routines)
        number = self.expression(given["T"], "M6")
        inner = self.statements(node.body)
        if self.modes is None:
            raise Unraisable("M6", "it does not come back")
        self.forget_height()
        self.set_own("settled", False)
        left = devices.left_by(inner, self.routines, node.span)
        rests = bool(spindle_off(node.body, self.program).channels)
        left = [one for one in left if not (rests and isinstance(one, TurnSpindle))]
        change = ChangeTool(number=number, select=True, change=True, rests=rests, span=node.span)
        lengths = self.own_mode("lengths", True)
        if unknown(lengths):
            raise Unraisable("M6", "whether G49 is in force depends on the way that the program took")
        if lengths and not any(isinstance(one, UseLength) for one in left):
            # The measure of a tool counts from its L101 on.
            left.insert(0, UseLength(on=True, span=node.span))
        return [change, *left]

    def call(self, node: Call) -> list[Node]:
        """M98: a file with its words as arguments; the caller's zero is back after it."""
        if (self.program.head or self.program.tail) and self.program.around_files is not False:
            raise Unraisable("M98", "whether cmdstart= and cmdend= run around it too")
        arguments = tuple(
            (_variable(word.letter, word.span), self.expression(word.value, "M98")) for word in node.arguments
        )
        moved, keep = self.own_mode("moved", False), self.own_mode("keep", False)
        inner = self.now
        for name, value in (("moved", False), ("keep", False), ("said", None)):
            inner = inner.with_own(name, value)
        self.modes = inner
        found = self.run_routine(node.name, node.span, arguments=arguments)
        if self.modes is not None:
            again = self.own_mode("moved", False)
            self.set_own("moved", True if again is True else UNKNOWN_MODE if unknown(again) else moved)
            self.set_own("keep", keep)
        return [found]

    def _decides(self, node: If) -> list[Node]:
        """A line that decides whether the next one runs."""
        question: tuple[Expr, ...] = ()
        head: Statement | None = node.head
        while isinstance(head, Replaced) and head.body:
            head = head.body[0]
        if isinstance(head, Message):
            question = head.parts
        why: Unraisable | None = None
        condition: Expr = Number(1.0, node.span)
        try:
            condition = self._condition(node.condition)
        except Unraisable as error:
            why = error
        # What follows is raised in the modes that both ways agree on, whatever becomes of the choice.
        found = self.choice(dataclasses.replace(node, head=None))
        assert isinstance(found, Choice)
        if why is not None:
            return [NotRaised(construct=why.construct, why=why.why, span=node.span), found]
        return [dataclasses.replace(found, condition=condition, question=question)]

    def _condition(self, condition: Expr) -> Expr:
        """A condition on inputs, outputs and answers; Unraisable for another one."""
        if isinstance(condition, Input):
            if condition.kind == "given":
                return self.expression(condition.number, "M17.4")
            if condition.kind not in ("input", "output", "answer"):
                raise Unraisable("M17.3", "a virtual input")
            number = self.expression(condition.number, "a condition")
            return Input(condition.kind, number, condition.span)
        if isinstance(condition, Unary) and condition.operator == "not":
            return dataclasses.replace(condition, operand=self._condition(condition.operand))
        raise Unraisable("L111 to L113", "the tool in a changer, or another value of this controller, as a condition")

    def _message(self, node: Message) -> list[Node]:
        """G5: a text, or a question whose answer ends the job."""
        shown = ShowText(kind="msg", parts=node.parts, span=node.span)
        if node.kind == "ok":
            return [shown, PauseJob(span=node.span)]
        if node.kind not in ("abort", "continue"):
            raise Unraisable("G5", "a question without a line that it decides about")
        entry = self.modes
        ending = tuple(self._abort(node.span))
        self.modes = entry
        answer = Input("answer", Number(float(node.question), node.span), node.span)
        condition: Expr = answer if node.kind == "abort" else Unary("not", answer, node.span)
        return [Choice(condition=condition, then=ending, otherwise=(), span=node.span, question=node.parts)]

    def _array(self, node: Array) -> list[Node]:
        """L10: what follows again at each place of a row, a column, or a grid whose order the machine's file says."""
        if not node.words and not node.body:
            return []
        values = {word.letter: word.value for word in node.words}
        counts = []
        for letter in "RC":
            value = values.get(letter, Number(1.0, node.span))
            if not isinstance(value, Number) or value.value < 1 or value.value != round(value.value):
                return self._no_array(node, f"{letter} is no number of rows or columns")
            counts.append(round(value.value))
        rows, columns = counts
        zero = Number(0.0, node.span)
        dx, dy = (self.expression(values.get(letter, zero), "L10") for letter in "XY")
        order = self.controls.array_order
        across = dy if columns > 1 else dx
        if not order and rows > 1 and columns > 1:
            return self._no_array(node, "in which order rows and columns are cut the manual does not say")
        if not order and rows * columns > 1 and not (isinstance(across, Number) and across.value == 0.0):
            return self._no_array(node, "whether the distance across is used the manual does not say")
        if self.own_mode("turn", "") != "":
            return self._no_array(node, "the way to a cell while G51 or G52 is on is not described")
        body = self._cells(node, many=rows * columns > 1)
        return [
            RepeatGrid(
                rows=rows, columns=columns, dx=self.length(dx), dy=self.length(dy), body=body, span=node.span,
                back="E" not in values, by_rows=order != "columns",
            )
        ]  # fmt: skip

    def _no_array(self, node: Array, why: str) -> list[Node]:
        """An array that is not raised, and what follows it once."""
        lost = NotRaised(construct="L10", why=why, span=node.span)
        return [lost, *self.statements(node.body)]

    def _cells(self, node: Array, *, many: bool) -> tuple[Node, ...]:
        """The body, in the modes that the array's start and the end of each cell agree on."""
        entry, place = self.modes, dict(self.comments.next)
        for _ in range(MOST_PASSES):
            self.modes, self.comments.next = entry, dict(place)
            self.set_own("cell", many)
            self.set_own("said", None)
            body = tuple(self.statements(node.body))
            after = self.modes
            if after is None or entry is None:
                break
            after = after.with_own("cell", entry.own("cell", False)).with_own("said", None)
            entry = entry.with_own("said", None)
            if not many or entry.joined(after) == entry:
                break
            entry = entry.joined(after)
        if self.modes is not None:
            self.set_own("cell", False)
        return body


def _is(number: Expr | None, value: float) -> bool:
    return isinstance(number, Number) and number.value == value


def _variable(letter: str, span: Span) -> Variable:
    """The variable of an argument of a called file."""
    return Variable(Number(float(ord(letter) - 64), span), span, letter)


def _arguments(value: object) -> set[str]:
    """Letters of the call's words in statements."""
    if isinstance(value, Named):
        return {value.name} if len(value.name) == 1 else set()
    if isinstance(value, tuple):
        return {name for part in value for name in _arguments(part)}
    if isinstance(value, Text | Number | Span) or not dataclasses.is_dataclass(value) or isinstance(value, type):
        return set()
    return {name for one in dataclasses.fields(value) for name in _arguments(getattr(value, one.name))}


def raise_program(program: Program, machine: Machine, stored: Mapping[str, StoredPosition] | None = None) -> Job:
    """A Program of WinCNC as a Job. stored: where stored positions are."""
    raiser = WinCncRaiser(program, machine)
    raiser.stored = stored or {}
    return raiser.job()
