"""Program -> Job: what every dialect's raising shares: structure, modes by data flow, comments, routines.

A dialect's ``raising.py`` has a subclass of ``Raiser`` that says what a line means in the modes in force
(``line``), and what its own statements mean (``own``). Modes follow the structure: after a choice a mode is known
where both ways agree, at a loop where entry and every pass agree, and a routine that runs in two states of the modes
is raised for each. A word whose meaning depends on a mode that is not known gives a ``NotRaised``, never a guess.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from gproof.frontend.common.move_tables import MoveLetters, first_words, moves_of, simple_lines
from gproof.frontend.common.raising_comments import Comments
from gproof.frontend.common.raising_modes import UNKNOWN_MODE, LineWord, Modes
from gproof.ir.columns import Array, Columns
from gproof.ir.finding import Span
from gproof.ir.job import (
    Choice,
    CountLoop,
    GoTo,
    Job,
    LeaveRoutine,
    LoopWhile,
    Mark,
    Moves,
    Node,
    NotRaised,
    OptionalPart,
    Routine,
    RunRoutine,
    SetVariable,
    used_routines,
)
from gproof.ir.machine import Machine
from gproof.ir.program import (
    FLAG_BARE,
    FLAG_DELETE,
    FLAG_POINT,
    Binary,
    Block,
    BlockTable,
    Call,
    Declare,
    DeferredBlock,
    Expr,
    For,
    If,
    Include,
    Jump,
    Label,
    Mistake,
    Mode,
    Number,
    Program,
    Repeat,
    Return,
    Statement,
    Subprogram,
    Unary,
    Unsupported,
    Variable,
    While,
)
from gproof.ir.rules import CodeRule

PIECE_BYTES = 1 << 22
FEW_ROWS = 16
"""Rows that are tried as a table after one that ended early."""
MOST_PASSES = 20
"""Over a loop or a list with jumps until its modes are settled: each pass loses a mode at least."""


class Unraisable(Exception):
    """What a line says has no form in a Job: (construct, why)."""

    def __init__(self, construct: str, why: str) -> None:
        super().__init__(construct, why)
        self.construct = construct
        self.why = why


Line = Sequence[LineWord]


class Raiser:
    """Raises one program. machine: its settings say how words are read."""

    def __init__(self, program: Program, machine: Machine) -> None:
        self.program = program
        self.machine = machine
        self.modes: Modes | None = self.first_modes()
        self.routines: dict[str, Routine] = {}
        self.raised: dict[tuple[str, Modes], tuple[str, Modes | None]] = {}
        self.running: list[str] = []
        self.left: dict[str, Modes] = {}
        self.marks: dict[str, Modes] = {}
        self.comments = Comments(program, self.comment_text)
        self.file_numbers = {source.name: number for number, source in enumerate(program.files)}

    # ---- what a dialect decides

    def first_modes(self) -> Modes:
        """The modes in which a job starts."""
        return Modes()

    def line(self, words: Line, span: Span) -> list[Node]:
        """What a line does, in its order; Unraisable. It sets ``self.modes``."""
        raise NotImplementedError

    letters = MoveLetters()
    """Letters of lines that are rows of ``Moves``."""

    def plain_moves(self) -> bool:
        """Whether lines of axis words, centres and feeds are rows of ``Moves`` in the modes in force."""
        assert self.modes is not None
        modes = self.modes
        return UNKNOWN_MODE not in (modes.motion, modes.unit, modes.relative, modes.plane, modes.per)

    def moved(self, motion: int) -> None:
        """A row of ``Moves`` with this code (tenths) was the last one: what it leaves in force."""
        assert self.modes is not None
        self.modes = replace(self.modes, motion=motion)

    def table_moves(self, moves: Moves) -> list[Node]:
        """Rows of a table as this dialect means them; it may set ``self.modes``."""
        return [moves]

    def simple_rows(self, words: Columns, firsts: Array) -> Array:
        """For each line of a table, whether it may be a row of ``Moves``."""
        return simple_lines(words, firsts, self.letters)

    def moves(self, words: Columns, file: int, span: Span) -> tuple[Moves, int, int] | None:
        """Simple lines as a table, see ``moves_of``; it may set modes that only this dialect has."""
        assert self.modes is not None
        return moves_of(words, self.modes, self.letters, file, span)

    def own(self, node: Statement) -> list[Node]:
        """A statement that only this dialect has; Unraisable."""
        raise Unraisable(type(node).__name__, "this statement has no neutral form")

    def call(self, node: Call) -> list[Node]:
        """A call of a subprogram; the usual one has no arguments."""
        return [self.run_routine(node.name, node.span, count=node.count)]

    def at_end(self, sub: Subprogram | None) -> list[Node]:
        """What the end of a subprogram, or of the job (None), does where it is reached."""
        return []

    def parameters_of(self, sub: Subprogram) -> tuple[Variable, ...]:
        """The variables that a call gives values."""
        return ()

    def comment_text(self, kind: int, text: bytes) -> str:
        """The text of a comment without its signs."""
        try:
            return text.decode("utf-8").strip()
        except UnicodeDecodeError:
            return text.decode("cp1252", "replace").strip()

    def rule(self, letter: str, number: float) -> CodeRule | None:
        """The rule of a code."""
        return self.program.rules.codes.get((letter, round(number * 10)))

    # ---- the whole

    def job(self) -> Job:
        """The program as a Job, verified."""
        body = self.statements(self.program.body)
        body += self.at_end(None)
        body += self.comments.rest()
        job = Job(
            source=self.program.dialect, files=[source.name for source in self.program.files], body=tuple(body),
            routines=used_routines(tuple(body), self.routines),
        )  # fmt: skip
        job.verify()
        return job

    # ---- structure

    def statements(self, body: Sequence[Statement]) -> list[Node]:
        """A list of statements; with jumps in it until the modes at its labels are settled."""
        labels = [node.name for node in body if isinstance(node, Label)]
        if not labels:
            return self._once(body)
        entry, place = self.modes, dict(self.comments.next)
        for _ in range(MOST_PASSES):
            before = {name: self.marks.get(name) for name in labels}
            self.modes, self.comments.next = entry, dict(place)
            found = self._once(body)
            if all(self.marks.get(name) == before[name] for name in labels):
                break
        return found

    def _once(self, body: Sequence[Statement]) -> list[Node]:
        found: list[Node] = []
        for node in body:
            if type(node) is DeferredBlock:
                node = node.made()
            span = _span_of(node, self)
            if span is not None:
                found += self.comments.before(span.file, span.line)
            if self.modes is None and not isinstance(node, Label):
                continue  # nothing leads here
            try:
                nodes = self.statement(node)
            except Unraisable as error:
                nodes = [NotRaised(construct=error.construct, why=error.why, span=span or Span("", 1))]
            if getattr(node, "deleted", False):
                nodes = [OptionalPart(body=tuple(nodes), span=span or Span("", 1))]
            found += nodes
        return found

    def statement(self, node: Statement) -> list[Node]:
        """One statement; Unraisable."""
        if isinstance(node, BlockTable):
            return self.table(node)
        if isinstance(node, Block):
            return self.block(node)
        if isinstance(node, If) and node.head is None:
            return [self.choice(node)]
        if isinstance(node, While | Repeat | For):
            return [self.loop(node)]
        if isinstance(node, Call):
            return self.call(node)
        if isinstance(node, Label):
            return [self._mark(node)]
        if isinstance(node, Jump):
            self._meet(node.name)
            self.modes = None
            return [GoTo(name=node.name, span=node.span)]
        if isinstance(node, Return):
            self.leave()
            return [LeaveRoutine(span=node.span)]
        if isinstance(node, Declare | Include | Mode):
            return self.silent(node)
        if isinstance(node, Mistake):
            raise Unraisable("a line with a mistake", node.message)
        if isinstance(node, Unsupported):
            raise Unraisable(node.what.rstrip(","), "gproof does not model it")
        return self.own(node)

    def table(self, table: BlockTable) -> list[Node]:
        """Plain lines, piece by piece: runs of literal moves are tables, all others go line by line."""
        found: list[Node] = []
        begin, line = table.begin, table.first_line
        name = self.program.files[table.file].name
        while line <= table.last_line:
            words, begin, line = self.program.load(table, begin, line, PIECE_BYTES)
            if len(words):
                found += self._piece(words, table.file, name)
        return found

    def _piece(self, words: Columns, file: int, name: str) -> list[Node]:
        """Lines of a table whose words are here."""
        found: list[Node] = []
        firsts = first_words(words)
        simple = self.simple_rows(words, firsts)
        numbers = words["line"][firsts]
        at, count = 0, len(firsts)
        most = count
        while at < count:
            line = int(numbers[at])
            found += self.comments.before(name, line)
            if self.modes is None:
                break
            if simple[at] and self.plain_moves():
                stop = at + int(np.argmin(simple[at:])) if not simple[at:].all() else count
                following = self.comments.line_of_next(name)
                if following is not None:
                    # A comment at the end of a line comes after its move.
                    stop = min(stop, max(at + 1, int(np.searchsorted(numbers, following, "right"))))
                stop = min(stop, at + most)
                last = int(firsts[stop]) if stop < count else len(words)
                part = words.slice(int(firsts[at]), last)
                taken = self.moves(part, file, Span(name, line))
                # Lines that were looked at and not taken are few, however often that happens.
                most = max(FEW_ROWS, 4 * taken[2]) if taken is not None else FEW_ROWS
                if taken is not None:
                    moves, motion, lines = taken
                    self.moved(motion)
                    found += self.table_moves(moves)
                    at += lines
                    continue
            last = int(firsts[at + 1]) if at + 1 < count else len(words)
            found += self._row_line(words.slice(int(firsts[at]), last), Span(name, line))
            at += 1
        return found

    def _row_line(self, words: Columns, span: Span) -> list[Node]:
        """One line of a table, by its words."""
        letters, values, flags = words["letter"].tolist(), words["value"].tolist(), words["flags"].tolist()
        line = [
            LineWord(chr(letter), Number(value, span, bool(flag & FLAG_POINT)), span, bool(flag & FLAG_BARE))
            for letter, value, flag in zip(letters, values, flags, strict=True)
        ]
        deleted = bool(flags and flags[0] & FLAG_DELETE)
        try:
            nodes = self.line(line, span)
        except Unraisable as error:
            nodes = [NotRaised(construct=error.construct, why=error.why, span=span)]
        return [OptionalPart(body=tuple(nodes), span=span)] if deleted else nodes

    def silent(self, node: Statement) -> list[Node]:
        """A statement that does nothing when it runs."""
        return []

    def block(self, node: Block) -> list[Node]:
        """A line with expressions: settings take effect after every value of the line is found."""
        words = [LineWord(word.letter, word.value, word.span, word.bare) for word in node.words]
        found = self.line(words, node.span) if words else []
        if node.assigns:
            written = {_key(one.target) for one in node.assigns}
            if len(node.assigns) > 1 and any(_reads(one.value, written) for one in node.assigns):
                raise Unraisable("several settings in a line", "one of them reads what another one writes")
            settings = [SetVariable(target=one.target, value=one.value, span=node.span) for one in node.assigns]
            if words and any(_reads(word.value, written) for word in node.words):
                # The values of the words are those before the line's settings.
                found = [*found, *settings]
            else:
                found = [*settings, *found]
        return found

    def choice(self, node: If) -> Node:
        """A choice; what follows is raised in the modes that both ways agree on."""
        entry = self.modes
        then = tuple(self.statements(node.then))
        after_then, self.modes = self.modes, entry
        otherwise = tuple(self.statements(node.otherwise))
        self._join(after_then)
        return Choice(condition=node.condition, then=then, otherwise=otherwise, span=node.span)

    def _join(self, other: Modes | None) -> None:
        self.modes = other if self.modes is None else self.modes.joined(other)

    def loop(self, node: While | Repeat | For) -> Node:
        """A loop, raised in the modes that its entry and the end of each pass agree on."""
        entry, place = self.modes, dict(self.comments.next)
        for _ in range(MOST_PASSES):
            self.modes, self.comments.next = entry, dict(place)
            body = tuple(self.statements(node.body))
            after = self.modes
            if after is None or entry is None or entry.joined(after) == entry:
                break
            entry = entry.joined(after)
        if not isinstance(node, Repeat):
            self.modes = entry
        if isinstance(node, For):
            return CountLoop(
                variable=node.variable, first=node.first, last=node.last, body=body, span=node.span, down=node.down
            )
        condition = node.condition
        if isinstance(node, Repeat):
            return LoopWhile(condition=negated(condition), body=body, span=node.span, first=True)
        return LoopWhile(condition=condition, body=body, span=node.span)

    def _mark(self, node: Label) -> Node:
        self._meet(node.name)
        self.modes = self.marks.get(node.name)
        return Mark(name=node.name, span=node.span)

    def _meet(self, name: str) -> None:
        """The present modes are among those in which a label is reached."""
        if self.modes is not None:
            known = self.marks.get(name)
            self.marks[name] = self.modes if known is None else known.joined(self.modes)

    def leave(self) -> None:
        """Back from the routine: its modes there are among those after the call."""
        if self.running and self.modes is not None:
            key = self.running[-1]
            known = self.left.get(key)
            self.left[key] = self.modes if known is None else known.joined(self.modes)
        self.modes = None

    def run_routine(
        self, name: str, span: Span, *, arguments: tuple[tuple[Variable, Expr], ...] = (), count: Expr | None = None
    ) -> Node:
        """A call: the routine is raised for the modes in force, unless it was before; Unraisable."""
        sub = self.program.subprograms.get(name)
        if sub is None:
            raise Unraisable(f"a call of {name}", "there is no such subprogram")
        if self.modes is None:
            return RunRoutine(name=self._any_variant(name), span=span, arguments=arguments, count=count)
        key = (name, self.modes)
        if key not in self.raised:
            self._raise_routine(name, key)
        variant, after = self.raised[key]
        if count is not None:
            # After the first time it runs in the modes that it leaves.
            again = (name, after) if after is not None else None
            if again is not None and again != key:
                if again not in self.raised:
                    self._raise_routine(name, again)
                if self.raised[again] != (variant, after):
                    raise Unraisable(f"a call of {name} that repeats", "its passes run in different modes")
        self.modes = after
        return RunRoutine(name=variant, span=span, arguments=arguments, count=count)

    def _any_variant(self, name: str) -> str:
        for (known, _), (variant, _) in self.raised.items():
            if known == name:
                return variant
        raise Unraisable(f"a call of {name}", "it is never reached")

    def _raise_routine(self, name: str, key: tuple[str, Modes]) -> None:
        if name in self.running:
            raise Unraisable(f"a call of {name}", "it calls itself")
        sub = self.program.subprograms[name]
        marks, before = self.marks, self.modes
        self.marks, self.modes = {}, key[1]
        self.running.append(name)
        self.left.pop(name, None)
        scope = self.comments.enter(name)
        try:
            found = [*self.statements(sub.body), *self.at_end(sub)]
            is_left = bool(found) and isinstance(found[-1], LeaveRoutine)
            found[len(found) - is_left :] = [*self.comments.rest(), *found[len(found) - is_left :]]
            body = tuple(found)
        finally:
            self.running.pop()
            self.comments.scope = scope
        after = self.modes
        left = self.left.pop(name, None)
        if left is not None:
            after = left.joined(after)
        self.marks, self.modes = marks, before
        same = next(
            (known for known, routine in self.routines.items() if _stem(known) == name and routine.body == body), None
        )
        variant = same
        if variant is None:
            others = sum(_stem(known) == name for known in self.routines)
            variant = name if not others else f"{name}~{others + 1}"
            is_file = sub.is_file or (bool(self.file_numbers) and self.file_numbers.get(sub.span.file, 0) > 0)
            self.routines[variant] = Routine(
                name=variant, body=body, span=sub.span, file=sub.span.file if is_file else "",
                parameters=self.parameters_of(sub),
            )  # fmt: skip
        self.raised[key] = variant, after


def _stem(name: str) -> str:
    """The name of a routine without the number of its variant."""
    return name.partition("~")[0]


def negated(condition: Expr) -> Expr:
    """1 where a condition is 0."""
    return Binary("==", condition, Number(0.0, condition.span), condition.span)


def _key(target: Variable) -> object:
    return target.number.value if isinstance(target.number, Number) else None


def _reads(value: Expr, written: set[object]) -> bool:
    """Whether an expression reads one of these variables; a computed number may be any."""
    if isinstance(value, Variable):
        key = _key(value)
        return key is None or None in written or key in written or _reads(value.number, written)
    if isinstance(value, Unary):
        return _reads(value.operand, written)
    if isinstance(value, Binary):
        return _reads(value.left, written) or _reads(value.right, written)
    return False


def _span_of(node: Statement, raiser: Raiser) -> Span | None:
    """Where a statement starts."""
    if isinstance(node, BlockTable):
        return Span(raiser.program.files[node.file].name, node.first_line)
    return node.span
