"""Variables that are read before anything sets them, on the ways through a program; read without running it.

A forward pass over the structured Program keeps which numbered variables are set on every way to a statement. A label
takes the meet over all jumps to it and what falls into it, until nothing changes; a subprogram is summed up as what it
needs and what it surely sets. What can set anything (a computed number, a statement nobody models) sets everything, and
after an end nothing is read: neither makes a false alarm. Variables of the controller, those that outlive a job, and
those that the setup states are left out.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from gproof.ir.finding import Span
from gproof.ir.program import (
    DIALOG_ANSWER,
    Array,
    Binary,
    Block,
    BlockTable,
    Call,
    Declare,
    Device,
    Expr,
    For,
    If,
    Input,
    Jump,
    Label,
    Message,
    Mistake,
    Number,
    Program,
    Repeat,
    Replaced,
    Return,
    Statement,
    Subprogram,
    Unary,
    Unsupported,
    Variable,
    While,
    parts_of,
)
from gproof.ir.record import field, record
from gproof.ir.rules import Function as F
from gproof.ir.setup import Setup

Known = frozenset[int] | None
"""Variables that are set on every way here; None: no way leads here, or nothing is known to be unset."""
Need = tuple[int, str, Span]
"""Number and name of a variable, and where it is read."""

SHORT_TABLE = 200
"""Lines of a table that are looked through for an end of the program."""
_ENDS = (F.END, F.END_RESET, F.ABORT, F.RETURN)
_SETS_SOME = (F.RESTORE_VARIABLE, F.ZERO_OFFSET_READ, F.ZERO_OFFSET_RESTORE, F.APPLICATION, F.INPUT_READ, F.PROBE)
"""Functions that give variables a value."""


@record(slots=True)
class Summary:
    """What a subprogram reads that it has not set, and what is set after it."""

    needs: dict[int, Need] = field(default_factory=dict)
    sets: Known = frozenset()


def variables(expr: Expr) -> Iterator[Variable]:
    """Every variable of an expression, those that compute a number first."""
    if isinstance(expr, Variable):
        yield from variables(expr.number)
        yield expr
    elif isinstance(expr, Unary):
        yield from variables(expr.operand)
    elif isinstance(expr, Binary):
        yield from variables(expr.left)
        yield from variables(expr.right)
    elif isinstance(expr, Input):
        yield from variables(expr.number)


def number_of(variable: Variable) -> int | None:
    """Its number; None when it is computed."""
    return round(variable.number.value) if isinstance(variable.number, Number) else None


def expressions(node: Statement) -> Iterator[Expr]:
    """The expressions that a statement itself reads, not those of the statements within it."""
    if isinstance(node, Block):
        for word in node.words:
            yield word.value
        for assign in node.assigns:
            yield assign.target.number
            yield assign.value
    elif isinstance(node, If | While):
        yield node.condition
    elif isinstance(node, For):
        yield node.first
        yield node.last
    elif isinstance(node, Call):
        yield from (word.value for word in node.arguments)
        if node.count is not None:
            yield node.count
    elif isinstance(node, Message):
        yield from node.parts
    elif isinstance(node, Device):
        yield from node.arguments
    elif isinstance(node, Array):
        yield from (word.value for word in node.words)


def written(node: Statement) -> tuple[Variable, ...]:
    """The variables that a statement itself sets."""
    if isinstance(node, Block):
        return tuple(assign.target for assign in node.assigns)
    return (node.variable,) if isinstance(node, For) else ()


def asked(node: Message) -> list[int] | None:
    """Variables that the operator's answer sets; None: any."""
    if node.kind != "dialog":
        return []
    numbers = [part for part in node.parts[1:] if not isinstance(part, Number)]
    found = [DIALOG_ANSWER, *(round(part.value) for part in node.parts[1:] if isinstance(part, Number))]
    return found if all(type(part).__name__ == "Text" for part in numbers) else None


class UnsetReads:
    """See the module's text; ``found`` gives what is read too early, one for each variable."""

    def __init__(self, program: Program, setup: Setup) -> None:
        self._program = program
        self._summaries: dict[str, Summary] = {}
        self._labels: dict[str, Known] = {}
        self._changed = False
        self._needs: dict[int, Need] = {}
        self._exit: Known = None
        base = program.rules.argument_base
        stated = {*setup.parameters, *setup.parameter_ranges}
        self._outside = stated | (set(range(base, base + 26)) if program.overrides else set())
        for name in program.overrides.values():
            # What a code of the machine's own sets may run before any line.
            self._outside |= {n for n in _all_written(program, name, set()) if n is not None}

    def found(self) -> list[Need]:
        """Number, name and place of each variable that the job reads before it is set on every way there."""
        return list(self._run_root(self._program.body, frozenset()).needs.values())

    def _run_root(self, body: tuple[Statement, ...], known: Known) -> Summary:
        kept = self._labels, self._needs, self._exit, self._changed
        self._labels, self._exit = {}, None
        while True:
            self._changed, self._needs, self._exit = False, {}, None
            end = self._body(body, known)
            if not self._changed:
                break
        summary = Summary(self._needs, _meet(end, self._exit))
        self._labels, self._needs, self._exit, self._changed = kept
        return summary

    def _body(self, body: tuple[Statement, ...], known: Known) -> Known:
        for node in body:
            known = self._statement(node, known)
        return known

    def _statement(self, node: Statement, known: Known) -> Known:
        if isinstance(node, Label):
            return _meet(known, self._labels.get(node.name))
        if known is None:
            # No way leads here but through labels within.
            for part in parts_of(node):
                self._body(part, None)
            return None
        self._read(expressions(node), known)
        if isinstance(node, Block):
            return self._block(node, known)
        if isinstance(node, If):
            return _meet(self._body(node.then, known), self._body(node.otherwise, known))
        if isinstance(node, While | For):
            if isinstance(node, For):
                known = _with(known, written(node))
            self._body(node.body, known)
            return known
        if isinstance(node, Repeat):
            known = self._body(node.body, known)
            self._read([node.condition], known)
            return known
        if isinstance(node, Replaced | Array):
            return self._body(node.body, known)
        if isinstance(node, Call):
            return self._call(node, known)
        if isinstance(node, Jump):
            before = self._labels.get(node.name, None)
            met = known if before is None else before & known
            if met != before:
                self._labels[node.name], self._changed = met, True
            return None
        if isinstance(node, Return):
            self._exit = _meet(self._exit, known)
            return None
        if isinstance(node, Unsupported | Mistake):
            return None
        if isinstance(node, Message):
            numbers = asked(node)
            return None if numbers is None or node.kind == "error" else known | set(numbers)
        if isinstance(node, Declare):
            return known - set(range(node.number, node.number + len(node.names))) if node.kind == "var" else known
        return None if isinstance(node, BlockTable) and self._ends(node) else known

    def _block(self, node: Block, known: frozenset[int]) -> Known:
        for word in node.words:
            if isinstance(word.value, Number) and abs(word.value.value) < 1e6:
                rule = self._program.rules.codes.get((word.letter, round(word.value.value * 10)))
                if rule is not None and (rule.function in _ENDS or rule.function in _SETS_SOME):
                    return None
        return _with(known, written(node))

    def _call(self, node: Call, known: frozenset[int]) -> Known:
        sub = self._program.subprograms.get(node.name)
        if sub is None:
            return None
        summary = self._summary(sub)
        for number, need in summary.needs.items():
            if number not in known:
                self._needs.setdefault(number, need)
        for word in node.arguments:
            # What a procedure may give back.
            known = known | {n for v in variables(word.value) if (n := number_of(v)) is not None}
        if node.count is not None and not isinstance(node.count, Number):
            return known
        return None if summary.sets is None else known | summary.sets

    def _summary(self, sub: Subprogram) -> Summary:
        known = self._summaries.get(sub.name)
        if known is None:
            # A subprogram that calls itself: nothing is asked of the inner call.
            self._summaries[sub.name] = Summary()
            known = self._run_root(sub.body, frozenset(number for _, _, number in sub.parameters))
            self._summaries[sub.name] = known
        return known

    def _read(self, exprs: Iterable[Expr], known: Known) -> None:
        if known is None:
            return
        for expr in exprs:
            for variable in variables(expr):
                number = number_of(variable)
                if number is not None and number not in known and self._is_own(number):
                    name = variable.name or self._program.rules.name_of(number)
                    self._needs.setdefault(number, (number, name, variable.span))

    def _is_own(self, number: int) -> bool:
        """Whether only the job gives a variable its value."""
        if number in self._outside:
            return False
        kinds = [e.kind for e in self._program.rules.parameters if e.first <= number <= e.last]
        return kinds == ["free"]

    def _ends(self, table: BlockTable) -> bool:
        """Whether a short table has a line that ends the program."""
        if table.last_line - table.first_line > SHORT_TABLE:
            return False
        words, _, _ = self._program.load(table, table.begin, table.first_line, max(1, table.end - table.begin))
        codes = self._program.rules.codes
        for letter, value in zip(words["letter"].tolist(), words["value"].tolist(), strict=True):
            rule = codes.get((chr(letter), round(value * 10))) if abs(value) < 1e6 else None
            if rule is not None and rule.function in _ENDS:
                return True
        return False


def _with(known: frozenset[int], targets: tuple[Variable, ...]) -> Known:
    numbers = [number_of(target) for target in targets]
    if any(number is None for number in numbers):
        return None
    return known | {number for number in numbers if number is not None}


def _meet(one: Known, other: Known) -> Known:
    if one is None or other is None:
        return other if one is None else one
    return one & other


def _all_written(program: Program, name: str, seen: set[str]) -> Iterator[int | None]:
    """Numbers of the variables that a subprogram, or what it calls, may set."""
    sub = program.subprograms.get(name)
    if sub is None or name in seen:
        return
    seen.add(name)
    for node in every(sub.body):
        yield from (number_of(target) for target in written(node))
        if isinstance(node, Message):
            yield from asked(node) or ()
        if isinstance(node, Call):
            yield from _all_written(program, node.name, seen)


def every(body: Iterable[Statement]) -> Iterator[Statement]:
    """All statements, those within others included, in the order of the source."""
    for node in body:
        yield node
        for part in parts_of(node):
            yield from every(part)
