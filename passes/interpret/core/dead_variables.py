"""Variables that have no part in what a program does: counters that nothing but a message reads.

Two runs that are at one place in states that differ in such variables alone do the same from there on. Loops that
count their passes are therefore known as loops that come again (``passes/interpret/core/loop_widening.py``), and
outcomes that differ in a count go on as one.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import fields
from typing import cast

from gproof.ir.program import (
    PARAMETER,
    STATEMENTS,
    Assign,
    Binary,
    Block,
    BlockTable,
    Call,
    Constant,
    Declare,
    DeferredBlock,
    Expr,
    For,
    Input,
    Label,
    Message,
    Mode,
    Named,
    Number,
    Program,
    Statement,
    Text,
    Unary,
    Variable,
    Word,
)
from gproof.ir.record import record
from gproof.ir.rules import LanguageRules

MOST_STATEMENTS = 20_000
"""Programs with more are not looked through."""
MOST_STEP = 1000.0
"""What grows faster may leave its 32 bits while somebody looks on: that is an error, and a part in what happens."""
MOST_REAL_STEP = 1e200
"""The same of doubles, which stay finite with smaller ones."""
_KINDS = ("free", "persistent")


@record(frozen=True, slots=True)
class Idle:
    """By their numbers. unread: what they hold nobody ever sees; ``told``: those and what messages alone show.

    counters: those of them that hold whole numbers of 32 bits and grow; step: by how much at most at once.
    """

    unread: frozenset[int] = frozenset()
    told: frozenset[int] = frozenset()
    counters: frozenset[int] = frozenset()
    step: float = 0.0


class _NotKnown(Exception):
    """Which variables a program reads cannot be seen from its text."""


def idle_variables(
    program: Program, is_whole: Callable[[int], bool], by_number: Callable[[int], tuple[int, ...]],
    always_read: Iterable[int],
) -> Idle:  # fmt: skip
    """Those of a program; none where numbers of variables are computed.

    is_whole: whether the variable of a number holds whole numbers of 32 bits; by_number: variables that a code
    may take by a number; always_read: what codes read themselves.
    """
    reads = _Reads(program.rules, is_whole, by_number, always_read)
    try:
        bodies: list[Iterable[Statement]] = [program.body, program.abort]
        bodies += [sub.body for sub in program.subprograms.values()]
        for body in bodies:
            reads.body(body)
        # What a procedure is given and gives back goes through its call.
        for sub in program.subprograms.values():
            reads.seen.update(number for _, _, number in sub.parameters)
    except _NotKnown:
        return Idle()
    told = reads.rest(set())
    steps = {number: step for number, step in reads.steps.items() if number in told}
    return Idle(reads.rest(reads.shown), told, frozenset(steps), max(steps.values(), default=0.0))


class _Reads:
    """What is read: ``seen`` by what makes a difference, ``shown`` by messages, ``into`` to set other variables.

    steps: of variables of 32 bits that are set from others, what is added at most.
    """

    def __init__(
        self, rules: LanguageRules, is_whole: Callable[[int], bool], by_number: Callable[[int], tuple[int, ...]],
        always_read: Iterable[int],
    ) -> None:  # fmt: skip
        self.rules = rules
        self.is_whole = is_whole
        self.by_number_of = by_number
        self.steps: dict[int, float] = {}
        self.seen = set(always_read)
        self.shown: set[int] = set()
        self.into: dict[int, set[int]] = {}
        self.count = 0

    def rest(self, shown: set[int]) -> frozenset[int]:
        """Variables that are set and have no part in anything."""
        read = set(self.seen | shown)
        todo = list(read)
        while todo:
            for number in self.into.get(todo.pop(), ()):
                if number not in read:
                    read.add(number)
                    todo.append(number)
        return frozenset(self.into.keys() - read)

    def body(self, body: Iterable[Statement]) -> None:
        for node in body:
            self.count += 1
            if self.count > MOST_STATEMENTS:
                raise _NotKnown
            self.statement(node)

    def statement(self, node: Statement) -> None:
        if isinstance(node, BlockTable | Label | Mode | Declare):
            return
        if isinstance(node, DeferredBlock):
            node = node.made()
        if isinstance(node, Block):
            for word in node.words:
                self.see(word.value)
            if any(w.letter == "M" and not _is_plain_m(w.value) for w in node.words):
                self.by_number(node)
            for assign in node.assigns:
                self.assign(assign)
        elif isinstance(node, Message) and node.kind not in ("dialog", "abort", "continue"):
            for part in node.parts:
                self.shown.update(self.numbers(part))
        elif isinstance(node, For):
            self.into.setdefault(self.number(node.variable), set())
            self.see(node.first)
            self.see(node.last)
            self.body(node.body)
        else:
            self.other(node)

    def by_number(self, node: Block) -> None:
        """M901 and its like take variables by their numbers."""
        for word in node.words:
            if word.letter == PARAMETER:
                if not isinstance(word.value, Number):
                    raise _NotKnown
                self.seen.update(self.by_number_of(round(word.value.value)))

    def assign(self, node: Assign) -> None:
        target = self.number(node.target)
        reads = self.into.setdefault(target, set())
        step = _only_counts(node.value)
        is_whole = self.is_whole(target)
        sources = set(self.numbers(node.value))
        if step is not None and (step <= (MOST_STEP if is_whole else MOST_REAL_STEP) or not sources):
            reads.update(sources)
            if is_whole and sources:
                self.steps[target] = max(step, self.steps.get(target, 0.0))
        else:
            # Whether it has a value, or for how long, may hang on what it reads.
            self.see(node.value)

    def other(self, node: Statement) -> None:
        """Any other statement: each of its expressions makes a difference."""
        if isinstance(node, Call) and node.line is not None:
            self.statement(node.line)
        for field in fields(node):
            for value in _parts(getattr(node, field.name)):
                if isinstance(value, Expr):
                    self.see(value)
                elif isinstance(value, Word):
                    self.see(value.value)
                elif type(value) in STATEMENTS:
                    self.body((cast(Statement, value),))

    def see(self, expr: Expr) -> None:
        self.seen.update(self.numbers(expr))

    def numbers(self, expr: Expr) -> Iterator[int]:
        """Variables that an expression reads."""
        todo = [expr]
        while todo:
            node = todo.pop()
            if isinstance(node, Variable):
                yield self.number(node)
            elif isinstance(node, Binary):
                todo += [node.left, node.right]
            elif isinstance(node, Unary):
                todo.append(node.operand)
            elif isinstance(node, Input):
                todo.append(node.number)
            elif not isinstance(node, Number | Text | Constant | Named):
                raise _NotKnown

    def number(self, node: Variable) -> int:
        """The number of a variable; one that the controller itself does not look at."""
        if not isinstance(node.number, Number):
            raise _NotKnown
        number = round(node.number.value)
        if not any(e.first <= number <= e.last and e.kind in _KINDS for e in self.rules.parameters):
            self.seen.add(number)
        return number


def _parts(value: object) -> Iterable[object]:
    return value if isinstance(value, tuple) else (value,)


def _only_counts(expr: Expr) -> float | None:
    """What is added at most, where a value is that of one variable and literals: it grows alike every time."""
    variables, step, todo = 0, 0.0, [expr]
    while todo:
        node = todo.pop()
        if isinstance(node, Binary) and node.operator in ("+", "-"):
            todo += [node.left, node.right]
        elif isinstance(node, Variable):
            variables += 1
        elif isinstance(node, Number | Constant):
            step += abs(node.value)
        else:
            return None
    return step if variables <= 1 else None


def _is_plain_m(value: Expr) -> bool:
    return isinstance(value, Number) and value.value < 100
