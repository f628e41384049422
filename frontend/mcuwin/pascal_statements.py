"""Statements of rw_SymPas as nodes of the Program.

Source: McuWIN manual 5.7, 7, 8, 10 to 12; statements that it only implies (if, loops and ``goto`` without ``$`` and
``begin``) are those of Pascal. What is no statement of the manual is ``Unsupported``.
"""

from __future__ import annotations

from collections.abc import Callable

from gproof.frontend.mcuwin.pascal_commands import ENDS, CommandParser, Statements
from gproof.frontend.mcuwin.pascal_lexer import PascalError, Token
from gproof.frontend.mcuwin.pascal_types import Type
from gproof.ir import codes
from gproof.ir.dialects.mcuwin.pascal import KEYWORDS
from gproof.ir.program import (
    Expr,
    For,
    If,
    Jump,
    Label,
    Repeat,
    Statement,
    Unsupported,
    Variable,
    While,
)

MAX_DEPTH = 40
DECLARING = ("var", "const", "label", "procedure", "function")
"""Words that start declarations: no statement does."""


class StatementParser(CommandParser):
    """Reads statements from tokens; declarations are ``pascal_declarations.py``."""

    depth = 0

    def statements(self, *ends: str) -> Statements:
        """Everything up to one of ``ends`` (which is left) or the end of the text; mistakes are reported."""
        found: list[Statement] = []
        while True:
            token = self.lexer.peek()
            if token.kind == "end" or token.low in ends:
                return tuple(found)
            if token.text == ";":
                self.lexer.take()
                continue
            before = self.lexer.index
            try:
                found += self.statement()
                self.separator(ends)
            except PascalError as error:
                self.symbols.report(error.finding)
                self.pass_mistake(before, ends)

    def line_statements(self) -> Statements:
        """Statements up to the end of the text; the first mistake is raised."""
        found: list[Statement] = []
        while self.lexer.peek().kind != "end":
            found += self.statement()
            self.separator(())
        return tuple(found)

    def separator(self, ends: tuple[str, ...]) -> None:
        """The semicolon after a statement, which may be missing before one of ``ends`` and at the end of the text."""
        token = self.lexer.peek()
        if token.text == ";":
            self.lexer.take()
        elif token.kind != "end" and token.low not in ends:
            what = f"a semicolon is missing before {token.text!r}"
            if token.text[0] in "\"'{":
                what = "this is not closed"
            raise self.lexer.error(codes.SYNTAX, token, what=what)

    def pass_mistake(self, before: int, ends: tuple[str, ...]) -> None:
        """Goes on after the next semicolon, or before what may close the block."""
        if self.lexer.index == before:
            self.lexer.take()
        while True:
            token = self.lexer.peek()
            if token.kind == "end" or token.low in ends:
                return
            if self.lexer.take().text == ";":
                return

    def statement(self) -> Statements:
        """One statement, without the semicolon after it; a compound gives its statements."""
        token = self.lexer.peek()
        self.depth += 1
        if self.depth > MAX_DEPTH:
            what = f"statements nested deeper than {MAX_DEPTH}"
            raise self.lexer.error(codes.PASCAL_OPEN, token, what=what, hint="use a procedure")
        try:
            return self._statement(token)
        finally:
            self.depth -= 1

    def _statement(self, token: Token) -> Statements:
        readers: dict[str, Callable[[], Statements]] = {
            "begin": lambda: self.compound()[0],
            "if": self._if,
            "while": self._while,
            "repeat": self._repeat,
            "for": self._for,
            "goto": self._goto,
            "case": self._case,
            "write": self.write,
            "writeln": self.write,
        }
        if token.low in readers and token.kind == "name":
            return readers[token.low]()
        after = self.lexer.peek(1)
        if token.kind == "name" and after.text == ":=" and token.low not in KEYWORDS:
            return self.assignment_statement()
        if token.kind == "axis":  # in any case of letters it is the same one
            return self.unknown(f"the command '{token.text[0].upper()}{token.low[1:]}'")
        if token.kind == "name" and after.text == "[" and token.low not in KEYWORDS:
            return self.unknown(f"an element of {token.text!r}")
        if token.kind in ("name", "number") and after.text == ":" and token.low not in KEYWORDS:
            return self._label()
        if token.kind == "name" and token.low not in KEYWORDS:
            return self.command()
        if token.text == ";" or token.low in ENDS or token.kind == "end":
            return ()
        what = "this is not closed" if token.text[0] in "\"'{" else f"{token.text!r} does not start a statement"
        raise self.lexer.error(codes.SYNTAX, token, what=what)

    def compound(self) -> tuple[Statements, Token]:
        """``begin ... end``, and its ``end``."""
        opening = self.lexer.take()
        body = self.statements("end", *DECLARING)
        if self.lexer.peek().low != "end":
            raise self.lexer.error(codes.UNBALANCED_BLOCK, opening, what=f"{opening.text!r} has no end")
        return body, self.lexer.take()

    def body(self) -> tuple[Statements, Token | None]:
        """What a condition or a loop holds: a statement, or a compound with its ``end``."""
        if self.lexer.peek().low == "begin":
            return self.compound()
        return self.statement(), None

    def _if(self) -> Statements:
        first = self.lexer.take()
        condition = self.condition()
        head = self.lexer.span(first, self.expect("then", "after the condition"))
        then, close = self.body()
        otherwise: Statements = ()
        divider = self.lexer.peek() if self.lexer.peek().low == "else" else None
        if divider is not None:
            self.lexer.take()
            otherwise, other_close = self.body()
            close = other_close or (close and self.lexer.last)
        return (
            If(
                condition=condition, then=then, otherwise=otherwise, span=head,
                else_span=None if divider is None else self.lexer.span(divider),
                end_span=None if close is None else self.lexer.span(close),
            ),
        )  # fmt: skip

    def _while(self) -> Statements:
        first = self.lexer.take()
        condition = self.condition()
        span = self.lexer.span(first, self.expect("do", "after the condition"))
        body, close = self.body()
        end = None if close is None else self.lexer.span(close)
        return (While(condition=condition, body=body, span=span, end_span=end),)

    def _repeat(self) -> Statements:
        first = self.lexer.take()
        body = self.statements("until", "end", "else")
        word = self.expect("until", "after repeat")
        condition = self.condition()
        end = self.lexer.span(word, self.lexer.last)
        return (Repeat(condition=condition, body=body, span=self.lexer.span(first), end_span=end),)

    def for_head(self) -> tuple[Variable | None, Expr, Expr, bool, Token]:
        """for v := a to b do: (variable, first, last, falling, the word do), after ``for``."""
        name = self.lexer.peek()
        variable, type_ = self.target("counted")
        if type_ not in (Type.INTEGER, Type.UNKNOWN):
            what = f"the variable of a for loop must be an integer; {name.text} is {type_.value}"
            self.report(codes.TYPE_MISMATCH, name, what=what, hint="use CI600 to CI699, or declare it as integer")
        self.expect(":=", f"after {name.text!r}")
        first = self._bound()
        word = self.lexer.peek()
        if word.low not in ("to", "downto"):
            at = self.lexer.last if word.kind == "end" else word
            raise self.lexer.error(codes.SYNTAX, at, what="'to' or 'downto' is missing after the start value")
        self.lexer.take()
        last = self._bound()
        return variable, first, last, word.low == "downto", self.expect("do", "after the end value")

    def _bound(self) -> Expr:
        first = self.lexer.peek()
        node, type_ = self.whole()
        if type_ not in (Type.INTEGER, Type.UNKNOWN):
            what = f"a bound of a for loop must be an integer; this is {type_.value}"
            hint = "use round(...) or trunc(...)" if type_ is Type.DOUBLE else ""
            self.report(codes.TYPE_MISMATCH, first, self.lexer.last, what=what, hint=hint)
        return node

    def _for(self) -> Statements:
        opening = self.lexer.take()
        variable, first, last, down, word = self.for_head()
        body, close = self.body()
        if variable is None:
            return ()
        return (
            For(
                variable=variable, first=first, last=last, down=down, body=body,
                span=self.lexer.span(opening, word), end_span=None if close is None else self.lexer.span(close),
            ),
        )  # fmt: skip

    # jumps

    def _goto(self) -> Statements:
        first = self.lexer.take()
        token = self.lexer.peek()
        if token.kind not in ("name", "number") or token.low in KEYWORDS:
            raise self.lexer.error(codes.SYNTAX, first, what="a label is missing after goto")
        self.lexer.take()
        self._declared_label(token)
        return (Jump(name=label_name(token.text), span=self.lexer.span(first, token)),)

    def _label(self) -> Statements:
        token = self.lexer.take()
        colon = self.lexer.take()
        self._declared_label(token)
        label = Label(name=label_name(token.text), span=self.lexer.span(token, colon))
        return (label, *self.statement())

    def _declared_label(self, token: Token) -> None:
        name = label_name(token.text) if token.kind == "number" else token.text
        symbol = self.symbols.resolve(name, self.lexer.span(token))
        if symbol is None or symbol.kind != "label":
            what = f"{token.text!r} is not declared as a label"
            self.report(
                codes.UNDECLARED_NAME, token, what=what, hint=f"declare 'label {token.text};' before the first %"
            )

    def _case(self) -> Statements:
        """case ... end, which the manual does not have."""
        first = self.lexer.take()
        depth = 1
        while depth:
            token = self.lexer.take()
            if token.kind == "end":
                raise self.lexer.error(codes.UNBALANCED_BLOCK, first, what="'case' has no end")
            depth += {"begin": 1, "case": 1, "end": -1}.get(token.low, 0)
        return (Unsupported(what="the statement 'case'", span=self.lexer.span(first, self.lexer.last)),)


def label_name(text: str) -> str:
    """A label as ``Label`` and ``Jump`` name it: lower case, digits without leading zeros."""
    return str(int(text)) if text.isdigit() else text.lower()
