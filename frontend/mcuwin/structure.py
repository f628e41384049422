"""The ``$`` lines of a McuWIN program put together, and its text cut into modules (manual 7 to 10, 4.16, 5.1).

A ``$`` line either opens, divides or closes a block (``$if … then begin``, ``$end else begin``, ``$end``) or is whole
statements of rw_SymPas. Percent signs cut the text: each starts a section, with or without a name, and ends the one
before it.
"""

from __future__ import annotations

from collections.abc import Sequence

from gproof.frontend.mcuwin.names import label_name
from gproof.frontend.mcuwin.pascal import (
    Dollar,
    Else,
    ElseIf,
    End,
    ForHead,
    IfHead,
    Place,
    RepeatHead,
    Simple,
    Symbols,
    Until,
    WhileHead,
    parse_dollar,
)
from gproof.frontend.mcuwin.pascal_lexer import Lexer
from gproof.ir import codes
from gproof.ir.dialects.mcuwin.persistence import Persistence
from gproof.ir.finding import Finding, Findings, Refusal, Span
from gproof.ir.program import (
    Declare,
    Expr,
    For,
    If,
    Include,
    Mistake,
    Mode,
    Number,
    Repeat,
    Statement,
    While,
)
from gproof.ir.record import field, record

_KINDS: dict[type, str] = {IfHead: "if", WhileHead: "while"}
_HEADS = ("if", "while", "for", "repeat")


@record(slots=True)
class Section:
    """The text after a percent sign. name: as labels have it, "" without; broken: a line of it was refused."""

    name: str
    span: Span
    body: list[Statement] = field(default_factory=list)
    end_span: Span | None = None
    broken: bool = False

    @property
    def says(self) -> bool:
        """There is more in it than declarations."""
        return any(does_something(node) for node in self.body)


def does_something(node: Statement) -> bool:
    """Whether a statement is more than a declaration, or the place of a file or a mode."""
    return not isinstance(node, Declare | Include | Mode)


@record(slots=True)
class _Open:
    """A block that is open. kind: its first word, "" where a mistake leaves it open; body: what is in it now;
    then: of an if, its first part.
    """

    kind: str
    span: Span
    body: list[Statement] = field(default_factory=list)
    condition: Expr | None = None
    then: list[Statement] | None = None
    else_span: Span | None = None
    head: ForHead | None = None
    outer: _Open | None = None
    depth: int = 0


MAX_DEPTH = 60
"""Blocks inside one another, the parts of a chain counted, that are followed."""


class Structure:
    """Takes the statements of a source in order. sections: the first is the text before any percent sign."""

    def __init__(self, symbols: Symbols, persistence: Persistence, findings: Findings, span: Span) -> None:
        self.symbols = symbols
        self.persistence = persistence
        self.findings = findings
        self.sections = [Section("", span)]
        self.open: list[_Open] = []
        self.unopened = 0
        """Heads with a mistake; whether they open a block is not known."""

    @property
    def section(self) -> Section:
        """The one that is being filled."""
        return self.sections[-1]

    @property
    def body(self) -> list[Statement]:
        """What the next statement is added to."""
        return self.open[-1].body if self.open else self.section.body

    def add(self, nodes: Sequence[Statement]) -> None:
        """Statements that follow."""
        self.body.extend(nodes)

    def refused(self, finding: Finding, text: str) -> None:
        """A line that cannot be read, in its place: it may have changed anything."""
        self.section.broken = True
        self.add((Mistake(
            code=finding.code.number, message=finding.message, span=finding.span, text=text.strip(), hint=finding.hint,
            told=True,
        ),))  # fmt: skip

    def module(self, name: str, span: Span) -> None:
        """A percent sign, with a name or without."""
        self.finish()
        self.section.end_span = span
        self.sections.append(Section(label_name(name), span))
        self.persistence.cut()

    def finish(self, depth: int = 0) -> None:
        """Close what is open beyond ``depth`` where the text ends: each is a finding."""
        while len(self.open) > depth:
            span = self.open[-1].span
            kind = self.open[-1].kind or "block"
            self.findings.add(codes.UNBALANCED_BLOCK.at(span, what=f"this {kind} is not closed before the text ends"))
            self._close(None)

    def pascal(self, text: str, at: int, file: str, line: int, known: Dollar | None = None) -> Dollar | None:
        """A ``$`` line, from after its sign; findings for its mistakes. known: what it is, when that is known.

        Returns what it is, None for a mistake. Whole statements the caller adds.
        """
        place = Place(file, line)
        found = None
        try:
            found = known or parse_dollar(text, at, place, self.symbols)
            self._line(found)
        except Refusal as refusal:
            self.findings.add(refusal.finding)
            self.refused(refusal.finding, text)
            self._keep_balance(Lexer([text], place, at))
            found = None
        return found

    def _line(self, found: Dollar) -> None:
        span = found.span
        match found:
            case Simple():
                pass
            case IfHead() | WhileHead():
                self._push(_Open(_KINDS[type(found)], span, condition=found.condition))
            case RepeatHead():
                self._push(_Open("repeat", span))
            case ForHead():
                self._push(_Open("for", span, head=found))
            case ElseIf() | Else():
                self._otherwise(found)
            case Until():
                self._innermost("until", span, ("repeat",)).condition = found.condition
                self._close(span)
            case End():
                self._innermost("end", span, ("if", "while", "for"))
                self._close(span)

    def _push(self, frame: _Open, around: int | None = None) -> None:
        """Open a block; around: depth of what is around it, that of the innermost open block unless it is given."""
        frame.depth = 1 + (around if around is not None else self.open[-1].depth if self.open else 0)
        self.open.append(frame)
        if frame.depth == MAX_DEPTH + 1:
            what = f"blocks nested deeper than {MAX_DEPTH}"
            self.findings.add(codes.PASCAL_OPEN.at(frame.span, what=what, hint="use subprograms"))

    def _innermost(self, word: str, span: Span, kinds: tuple[str, ...]) -> _Open:
        """The innermost block, which must be one that ``word`` closes."""
        if self.unopened and not (self.open and self.open[-1].kind in ("", *kinds)):
            self.unopened -= 1
            self._push(_Open("", span))
        if not self.open:
            what = f"there is no block that this {word} can close"
            raise Refusal(codes.UNBALANCED_BLOCK.at(span, what=what))
        frame = self.open[-1]
        if frame.kind and frame.kind not in kinds:
            what = f"this {word} does not close the {frame.kind} of line {frame.span.line}"
            raise Refusal(codes.UNBALANCED_BLOCK.at(span, what=what))
        return frame

    def _otherwise(self, found: ElseIf | Else) -> None:
        if not found.closes:
            self._reopen(found.span)
        frame = self._innermost("else", found.span, ("if",))
        if frame.then is not None:
            raise Refusal(codes.UNBALANCED_BLOCK.at(found.span, what="a second else for the same if"))
        frame.then, frame.body, frame.else_span = frame.body, [], found.span
        if isinstance(found, ElseIf):
            self.open.pop()
            self._push(_Open("if", found.span, condition=found.condition, outer=frame), frame.depth)

    def _reopen(self, span: Span) -> None:
        """``$else`` on a line of its own after the ``$end`` of an if."""
        node = self.body[-1] if self.body else None
        if not isinstance(node, If) or node.end_span is None or node.else_span is not None:
            raise Refusal(codes.UNBALANCED_BLOCK.at(span, what="this else has no if"))
        self.body.pop()
        self._push(_Open("if", node.span, list(node.then), node.condition))

    def _keep_balance(self, lexer: Lexer) -> None:
        """What a line with a mistake does to the blocks, so that the lines after it are still understood."""
        first = last = lexer.take()
        while lexer.peek().kind != "end":
            last = lexer.take()
        span = lexer.span(first, last)
        opens = last.low == "begin"
        if first.low in ("end", "until") and not opens and self.open:
            self._close(span)
        elif opens and first.low == "end" and self.open and self.open[-1].kind == "if":
            self.open[-1].then, self.open[-1].body = self.open[-1].body, []
        elif opens and first.low not in ("end", "else"):
            self._push(_Open(first.low if first.low in _HEADS else "", span))
        elif first.low in _HEADS:
            self.unopened += 1

    def _close(self, span: Span | None) -> None:
        """Make the node of the innermost block, and of those that it is an ``else if`` of."""
        frame = self.open.pop()
        node = self._made(frame, span)
        while frame.outer is not None:
            frame = frame.outer
            frame.body = list(node)
            node = self._made(frame, span)
        self.add(node)

    @staticmethod
    def _made(frame: _Open, span: Span | None) -> Sequence[Statement]:
        condition = frame.condition or Number(0.0, frame.span)
        if frame.depth > MAX_DEPTH:
            return [*(frame.then or ()), *frame.body]
        body = tuple(frame.body)
        if frame.kind == "if":
            then, otherwise = (body, ()) if frame.then is None else (tuple(frame.then), body)
            return [If(condition=condition, then=then, otherwise=otherwise, span=frame.span,
                       else_span=frame.else_span, end_span=span)]  # fmt: skip
        if frame.kind == "while":
            return [While(condition=condition, body=body, span=frame.span, end_span=span)]
        if frame.kind == "repeat":
            stop = frame.condition or Number(1.0, frame.span)
            return [Repeat(condition=stop, body=body, span=frame.span, end_span=span)]
        head = frame.head
        if head is not None and head.variable is not None:
            return [For(variable=head.variable, first=head.first, last=head.last, down=head.down, body=body,
                        span=frame.span, end_span=span)]  # fmt: skip
        return [*(frame.then or ()), *body]
