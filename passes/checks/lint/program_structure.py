"""What is odd in a program as it is written: lines that nothing leads to, names that nothing uses, fixed conditions.

Only what is in the job's own file is reported: include files and macros of a machine serve other jobs too.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from gproof.ir import codes
from gproof.ir.finding import Finding, Findings, Refusal, Span
from gproof.ir.program import (
    FLAG_DELETE,
    Binary,
    Block,
    BlockTable,
    Call,
    Constant,
    Declare,
    DeferredBlock,
    Definition,
    Expr,
    If,
    Include,
    Input,
    Jump,
    Label,
    Message,
    Mode,
    Number,
    Program,
    Repeat,
    Return,
    Statement,
    Unary,
    While,
    parts_of,
)
from gproof.ir.rules import Function as F
from gproof.ir.setup import Setup
from gproof.ir.symbolic import Unknown, Value
from gproof.passes.checks.lint.unset_variables import UnsetReads, every, expressions, number_of, variables, written
from gproof.passes.interpret.core.expressions import Evaluator

MOST_STATEMENTS = 200_000
"""Of a program whose variables are followed; each line with an expression is read again for it."""
_SILENT = (Label, Declare, Include, Mode, Definition)
_MOVES = frozenset(
    (
        F.TRAVERSE, F.FEED, F.ARC_CW, F.ARC_CCW, F.DRILL, F.DRILL_DWELL, F.DRILL_PECK, F.DRILL_CHIP_BREAK, F.BORE,
        F.BORE_STOP, F.BORE_DWELL,
    )
)  # fmt: skip
_DISTANCES = (F.ABSOLUTE, F.INCREMENTAL)
_FIRST_BYTES = 1 << 16
_DEEPEST = 8
_MOST_LINES = 100_000
"""Of a table that is looked at for an end of the program."""


def place(program: Program, node: Statement) -> Span:
    """Where a statement is."""
    if isinstance(node, BlockTable):
        return Span(program.files[node.file].name, node.first_line)
    if isinstance(node, DeferredBlock):
        return Span(*node.place)
    return node.span


class Written:
    """The findings of this module for one program."""

    def __init__(self, program: Program, setup: Setup) -> None:
        self._program = program
        self._setup = setup
        self._job = program.files[0].name if program.files else ""
        self._bodies = [program.body, *(sub.body for sub in program.subprograms.values())]
        self._all = [node for body in self._bodies for node in _some(body)]
        self.too_long = len(self._all) > MOST_STATEMENTS

    def findings(self) -> Iterator[Finding]:
        """All of them, each place once."""
        seen: set[tuple[int, Span]] = set()
        for finding in self._findings():
            if finding.span.file == self._job and (finding.code.number, finding.span) not in seen:
                seen.add((finding.code.number, finding.span))
                yield finding

    def _findings(self) -> Iterator[Finding]:
        for n, body in enumerate(self._bodies):
            yield from self._dead(body, n > 0)
        yield from self._unused()
        yield from self._fixed()
        if not self.too_long:
            yield from self._never_read()
            for _, name, span in UnsetReads(self._program, self._setup).found():
                yield codes.READ_BEFORE_SET.at(span, name=name, hint="assign a value before, on every path to it")

    def _dead(self, body: tuple[Statement, ...], inner: bool) -> Iterator[Finding]:
        """GP153: after a jump, a return or, in an inner body, an end of the program, up to the next label.

        After the end of the body that runs first, GP123 reports it.
        """
        gone = ""
        for node in body:
            if isinstance(node, Jump | Return):
                what = "jump" if isinstance(node, Jump) else "return"
                gone = gone or f"the {what} in line {place(self._program, node).line}"
                continue
            if isinstance(node, Label):
                gone = ""
            elif gone and not isinstance(node, _SILENT) and not self._is_end(node):
                yield codes.DEAD_CODE.at(place(self._program, node), what=f"{gone} is before it")
                gone = ""
            ends, behind = self._end_in(node) if inner else (0, 0)
            if behind:
                assert isinstance(node, BlockTable)
                where = Span(self._program.files[node.file].name, behind)
                yield codes.DEAD_CODE.at(where, what=f"the end of the program in line {ends} is before it")
            elif ends:
                gone = gone or f"the end of the program in line {ends}"
            for part in parts_of(node):
                yield from self._dead(part, True)

    def _end_in(self, node: Statement) -> tuple[int, int]:
        """The first line in a statement that ends the program, and the first after it that does more; 0 for none."""
        table = self._program.rules.codes
        ends = [r for r in table.values() if r.function in (F.END, F.END_RESET) and r.letter == "M"]
        if type(node) is Block and not node.deleted and not node.own:
            found = [w for w in node.words if w.letter == "M" and isinstance(w.value, Number)]
            values = {round(w.value.value * 10) for w in found if isinstance(w.value, Number)}
            replaced = any(("M", value) in self._program.overrides for value in values)
            is_end = any(rule.tenths in values for rule in ends) and not replaced
            return (place(self._program, node).line, 0) if is_end else (0, 0)
        if not isinstance(node, BlockTable) or node.last_line - node.first_line > _MOST_LINES:
            return 0, 0
        words, _, _ = self._program.load(node, node.begin, node.first_line, node.end - node.begin)
        tenths = np.round(words["value"] * 10)
        is_end = (words["letter"] == ord("M")) & (words["flags"] & FLAG_DELETE == 0)
        is_end &= np.isin(tenths, [r.tenths for r in ends if ("M", r.tenths) not in self._program.overrides])
        if not is_end.any():
            return 0, 0
        line = int(words["line"][int(np.flatnonzero(is_end)[0])])
        behind = np.flatnonzero((words["line"] > line) & ~is_end & (words["letter"] != ord("N")))
        return line, int(words["line"][int(behind[0])]) if len(behind) else 0

    def _is_end(self, node: Statement) -> bool:
        """Whether a line only ends the program: compilers require one, whatever leads to it."""
        if not isinstance(node, Block) or node.assigns or not node.words:
            return False
        table = self._program.rules.codes
        words = [(w.letter, w.value.value if isinstance(w.value, Number) else math.inf) for w in node.words]
        rules = [table.get((letter, round(value * 10))) if abs(value) < 1e6 else None for letter, value in words]
        return all(rule is not None and rule.function in (F.END, F.END_RESET) for rule in rules)

    def _unused(self) -> Iterator[Finding]:
        """GP154 and GP155."""
        names = {node.name for node in self._all if isinstance(node, Jump | Call)}
        for node in self._all:
            if isinstance(node, Label) and node.name not in names:
                yield codes.UNUSED_LABEL.at(node.span, name=node.name)
        body = self._program.body
        if not body or (len(body) == 1 and isinstance(body[0], Call)):
            # Only subprograms, or one of them that is judged by itself.
            return
        reached, queue = set[str](), ["", *self._program.overrides.values()]
        while queue:
            name = queue.pop()
            sub = self._program.subprograms.get(name)
            if name in reached or (name and sub is None):
                continue
            reached.add(name)
            inside = body if sub is None else sub.body
            queue += [node.name for node in every(inside) if isinstance(node, Call | Jump)]
        for name, sub in self._program.subprograms.items():
            if name not in reached and not name.startswith("%") and sub.body:
                yield codes.UNCALLED_SUBPROGRAM.at(sub.span, name=sub.text or name)

    def _fixed(self) -> Iterator[Finding]:
        """GP158; a loop without an end of its own, left by a jump or a return, is a way to write a loop."""
        for node in self._all:
            if not isinstance(node, If | While | Repeat) or not _is_fixed(_stated(node.condition)):
                continue
            value = _value(_stated(node.condition))
            if value is None or (isinstance(node, While) and value) or (isinstance(node, Repeat) and not value):
                continue
            yield codes.CONSTANT_CONDITION.at(node.condition.span, value="true" if value else "false")

    def _never_read(self) -> Iterator[Finding]:
        """GP157, of variables that only the job knows."""
        read: set[int] = set()
        set_at: dict[int, tuple[str, Span]] = {}
        for node in self._all:
            for expr in expressions(node):
                for variable in variables(expr):
                    number = number_of(variable)
                    if number is None:
                        return  # which one is read is computed: it may be any
                    read.add(number)
            if isinstance(node, Repeat):
                read |= {n for v in variables(node.condition) if (n := number_of(v)) is not None}
            if isinstance(node, Block):
                for target in written(node):
                    number = number_of(target)
                    if number is not None:
                        name = target.name or self._program.rules.name_of(number)
                        set_at.setdefault(number, (name, target.span))
            if isinstance(node, Message) and node.kind == "dialog":
                read |= {round(part.value) for part in node.parts if isinstance(part, Number)}
        if self._program.overrides:
            base = self._program.rules.argument_base
            read |= set(range(base, base + 26))
        for number, (name, span) in set_at.items():
            if number not in read and self._is_private(number):
                yield codes.NEVER_READ.at(span, name=name)

    def _is_private(self, number: int) -> bool:
        """Whether nobody but the job has to do with a variable: cells of a shared range have a prefix and a base."""
        entries = [e for e in self._program.rules.parameters if e.first <= number <= e.last]
        return all(e.kind == "free" and not (e.prefix and e.base) for e in entries)

    def distances(self) -> Finding | None:
        """GP159, where the first motion comes before G90 and G91."""
        known = {rule.function for rule in self._program.rules.codes.values()}
        if not known.intersection(_DISTANCES):
            return None
        for line, functions in self._lines(self._program.body, 0):
            if functions.intersection(_DISTANCES):
                return None
            if functions & _MOVES:
                return codes.DISTANCES_NEVER_SET.at(line, hint="program G90 or G91 before")
        return None

    def _lines(self, body: tuple[Statement, ...], depth: int) -> Iterator[tuple[Span, set[F]]]:
        """Lines in about the order in which they run, with the functions of their codes; of tables the start."""
        table = self._program.rules.codes
        for node in body:
            if isinstance(node, BlockTable):
                words, _, _ = self._program.load(node, node.begin, node.first_line, _FIRST_BYTES)
                lines: dict[int, set[F]] = {}
                columns = (words[name].tolist() for name in ("line", "letter", "value"))
                for line, letter, value in zip(*columns, strict=True):
                    rule = table.get((chr(letter), round(value * 10))) if abs(value) < 1e6 else None
                    lines.setdefault(line, set()).update(() if rule is None else (rule.function,))
                for line, functions in lines.items():
                    yield Span(self._program.files[node.file].name, line), functions
            elif isinstance(node, Block):
                values = [(w.letter, w.value.value) for w in node.words if isinstance(w.value, Number)]
                rules = [table.get((letter, round(value * 10))) for letter, value in values if abs(value) < 1e6]
                yield node.span, {rule.function for rule in rules if rule is not None}
            elif isinstance(node, Call) and depth < _DEEPEST and node.name in self._program.subprograms:
                yield from self._lines(self._program.subprograms[node.name].body, depth + 1)
            for part in parts_of(node):
                yield from self._lines(part, depth)


def _some(body: tuple[Statement, ...]) -> Iterator[Statement]:
    for count, node in enumerate(every(body)):
        if count > MOST_STATEMENTS:
            return
        yield node


def _stated(expr: Expr) -> Expr:
    """A condition with the number that it states in place of an input: M17.4 and M18.4 of WinCNC."""
    if isinstance(expr, Input) and expr.kind == "given":
        return expr.number
    return Unary(expr.operator, _stated(expr.operand), expr.span) if isinstance(expr, Unary) else expr


def _is_fixed(expr: Expr) -> bool:
    if isinstance(expr, Number | Constant):
        return True
    if isinstance(expr, Unary):
        return _is_fixed(expr.operand)
    return isinstance(expr, Binary) and _is_fixed(expr.left) and _is_fixed(expr.right)


def _value(expr: Expr) -> bool | None:
    """Whether a condition without variables holds; None where it has no value."""

    def nothing(*_: object) -> Value:
        return Unknown("nothing")

    try:
        value = Evaluator(nothing, Findings(), nothing).value(expr)
    except Refusal:
        return None
    return None if isinstance(value, Unknown) else value != 0.0
