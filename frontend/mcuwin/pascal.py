"""rw_SymPas for the frontend of McuWIN: expressions in blocks, ``$`` lines, and sections after ``$DINEND``.

Text comes as whole lines, of which other comments than ``//`` and ``{ }`` are blanked out; places count from there.
Violations of types and declarations go to ``Symbols.report`` and reading goes on; a text that cannot be read raises
``PascalError``, which carries its finding. Source: McuWIN manual 5.7, 7, 8, 10 to 12.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from gproof.frontend.mcuwin.pascal_declarations import Section, SectionParser
from gproof.frontend.mcuwin.pascal_expressions import COMMON, PREDEFINED
from gproof.frontend.mcuwin.pascal_lexer import Lexer, PascalError, Place, Token
from gproof.frontend.mcuwin.pascal_types import Symbol, Symbols, Type
from gproof.ir import codes
from gproof.ir.dialects.mcuwin.pascal import FUNCTIONS
from gproof.ir.finding import Span
from gproof.ir.program import Assign, Expr, Statement, Unsupported, Variable

__all__ = [
    "Dollar", "Else", "ElseIf", "End", "ForHead", "IfHead", "PascalError", "Place", "RepeatHead", "Section",
    "Simple", "Symbol", "Symbols", "Type", "Until", "WhileHead", "begins_expression", "parse_assignment",
    "parse_dollar", "parse_expression", "parse_section",
]  # fmt: skip


class IfHead(NamedTuple):
    """``if (...) then begin``"""

    condition: Expr
    span: Span


class ElseIf(NamedTuple):
    """``end else if (...) begin``, with or without ``then``; closes: ``end`` is before it on this line."""

    condition: Expr
    span: Span
    closes: bool


class Else(NamedTuple):
    """``end else begin``; closes: see ElseIf."""

    span: Span
    closes: bool


class End(NamedTuple):
    """end"""

    span: Span


class Until(NamedTuple):
    """end until (...), with or without ``end``."""

    condition: Expr
    span: Span


class WhileHead(NamedTuple):
    """``while (...) do begin``"""

    condition: Expr
    span: Span


class RepeatHead(NamedTuple):
    """``repeat``, with or without ``begin``."""

    span: Span


class ForHead(NamedTuple):
    """``for v := a to b do begin``; variable: None where it is none that can be written (reported)."""

    variable: Variable | None
    first: Expr
    last: Expr
    down: bool
    span: Span


class Simple(NamedTuple):
    """Whole statements, which open and close nothing."""

    statements: tuple[Statement, ...]
    span: Span


Dollar = IfHead | ElseIf | Else | End | Until | WhileHead | RepeatHead | ForHead | Simple
"""What a ``$`` line is."""


def parse_expression(text: str, at: int, place: Place, symbols: Symbols) -> tuple[Expr, Type, int]:
    """The longest expression of a line from character ``at``: (tree, type, character after it)."""
    parser = _parser([text], place, symbols, at)
    node, type_ = parser.whole()
    return node, type_, parser.lexer.last.end


def parse_assignment(text: str, at: int, place: Place, symbols: Symbols) -> tuple[Assign | None, int]:
    """variable := expression from character ``at``, with its end; None where what is written is no variable."""
    parser = _parser([text], place, symbols, at)
    assign = parser.assignment()
    return assign, parser.lexer.last.end


def parse_section(lines: Sequence[str], place: Place, symbols: Symbols) -> Section:
    """The lines of a section, from the one of ``place``; every mistake is reported, nothing raised."""
    return _parser(lines, place, symbols, 0).section()


def begins_expression(text: str, at: int, symbols: Symbols) -> bool:
    """Whether an expression may start at character ``at``: a number, sign, bracket, or a name that means a value."""
    lexer = Lexer([text], Place("", 1), at)
    token = lexer.peek()
    if token.kind in ("number", "axis") or token.text in ("(", "+", "-") or token.low == "not":
        return True
    if token.kind != "name":
        return False
    if COMMON.match(token.low) or token.low in PREDEFINED:
        return True
    symbol = symbols.lookup(token.text)
    if symbol is not None:
        return symbol.kind in ("var", "const", "function")
    return token.low in FUNCTIONS and lexer.peek(1).text == "("


def parse_dollar(text: str, at: int, place: Place, symbols: Symbols) -> Dollar:
    """A whole line after its ``$``, from character ``at``."""
    parser = _parser([text], place, symbols, at)
    first = parser.lexer.peek()
    found = _DollarLine(parser, first).read()
    token = parser.lexer.peek()
    if token.text == ";" and not isinstance(found, Simple):
        parser.lexer.take()
        token = parser.lexer.peek()
    if token.kind != "end":
        what = "this is not closed" if token.text[0] in "\"'{" else f"{token.text!r} after a complete $ line"
        raise parser.lexer.error(codes.SYNTAX, token, what=what, hint="put it on its own line")
    return found


def _parser(lines: Sequence[str], place: Place, symbols: Symbols, at: int) -> SectionParser:
    return SectionParser(Lexer(lines, place, at), symbols)


class _DollarLine:
    """Reads one line after ``$``."""

    def __init__(self, parser: SectionParser, first: Token) -> None:
        self.parser = parser
        self.lexer = parser.lexer
        self.first = first

    @property
    def span(self) -> Span:
        return self.lexer.span(self.first, self.lexer.last)

    def read(self) -> Dollar:
        word = self.first.low if self.first.kind == "name" else ""
        if word == "end":
            self.lexer.take()
            return self._behind_end()
        if word == "else":
            return self._else(closes=False)
        if word == "until":
            return self._until()
        if word in ("var", "const", "label"):
            return self._declared()
        if word == "begin" and self.lexer.peek(1).kind == "end":
            what = "a block without a condition, of the lines after this one"
            raise self.lexer.error(codes.PASCAL_OPEN, self.first, what=what, hint="remove it, and its end")
        if word in ("if", "while", "for", "repeat") and self._is_head(word):
            return {"if": self._if, "while": self._while, "for": self._for, "repeat": self._repeat}[word]()
        statements = self.parser.line_statements()
        return Simple(statements, self.span)

    def _declared(self) -> Dollar:
        """Declarations after one ``$``: the manual has them in sections only (10), so the names alone are taken."""
        text = self.lexer.lines[0][self.first.begin :].rstrip()
        self.parser.section()
        what = "a declaration after a single $ (declare between $DINEND and {$DINSTART}, 10)"
        return Simple((Unsupported(what=what, span=self.span, text=text),), self.span)

    def _is_head(self, word: str) -> bool:
        """Whether the line ends with what opens a block: all that it opens is then on further lines."""
        tokens: list[Token] = []
        while self.lexer.peek(len(tokens)).kind != "end":
            tokens.append(self.lexer.peek(len(tokens)))
        words = [token.low for token in tokens if token.text != ";"]
        if word == "repeat":
            return words in (["repeat"], ["repeat", "begin"])
        return words[-1] == "begin" or (words[-1] in ("then", "do") and tokens[-1].text != ";")

    def _begin(self) -> None:
        """``begin`` at the end of a head."""
        token = self.lexer.peek()
        if token.low != "begin":
            what = "a $ line without 'begin', which may or may not include the next line"
            raise self.lexer.error(codes.PASCAL_OPEN, self.lexer.last, what=what, hint="end the line with 'begin'")
        self.lexer.take()

    def _if(self) -> Dollar:
        self.lexer.take()
        condition = self.parser.condition()
        self.parser.expect("then", "after the condition")
        self._begin()
        return IfHead(condition, self.span)

    def _while(self) -> Dollar:
        self.lexer.take()
        condition = self.parser.condition()
        self.parser.expect("do", "after the condition")
        self._begin()
        return WhileHead(condition, self.span)

    def _for(self) -> Dollar:
        self.lexer.take()
        variable, first, last, down, _ = self.parser.for_head()
        self._begin()
        return ForHead(variable, first, last, down, self.span)

    def _repeat(self) -> Dollar:
        self.lexer.take()
        if self.lexer.peek().low == "begin":
            self.lexer.take()
        return RepeatHead(self.span)

    def _behind_end(self) -> Dollar:
        word = self.lexer.peek().low
        if word == "else":
            return self._else(closes=True)
        if word == "until":
            return self._until()
        return End(self.span)

    def _else(self, *, closes: bool) -> Dollar:
        self.lexer.take()
        if self.lexer.peek().low != "if":
            self._begin()
            return Else(self.span, closes)
        self.lexer.take()
        condition = self.parser.condition()
        if self.lexer.peek().low == "then":
            self.lexer.take()
        self._begin()
        return ElseIf(condition, self.span, closes)

    def _until(self) -> Dollar:
        self.lexer.take()
        condition = self.parser.condition()
        return Until(condition, self.span)
