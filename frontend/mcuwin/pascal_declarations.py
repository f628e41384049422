"""Declarations of rw_SymPas and whole sections of it, between ``$DINEND`` and ``{$DINSTART}``.

Source: McuWIN manual 10 and 12; the form of ``label`` and ``procedure``, which 10 only names, is Pascal's.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Iterator
from dataclasses import fields, is_dataclass, replace
from typing import NamedTuple

from gproof.frontend.mcuwin.pascal_expressions import LARGEST_INTEGER
from gproof.frontend.mcuwin.pascal_lexer import PascalError, Token
from gproof.frontend.mcuwin.pascal_statements import DECLARING, StatementParser, label_name
from gproof.frontend.mcuwin.pascal_types import DECLARABLE, Parameter, Symbols, Type
from gproof.ir import codes
from gproof.ir.dialects.mcuwin.pascal import KEYWORDS
from gproof.ir.finding import Span
from gproof.ir.program import (
    Binary,
    Call,
    Constant,
    Declare,
    Expr,
    Jump,
    Number,
    Statement,
    Subprogram,
    Text,
    Unary,
    Unsupported,
    Variable,
    lost_jumps,
)


class Section(NamedTuple):
    """What a section holds. first_statement, first_declaration: where they start, None without any."""

    statements: tuple[Statement, ...]
    subprograms: tuple[Subprogram, ...]
    first_statement: Span | None
    first_declaration: Span | None


class SectionParser(StatementParser):
    """Reads declarations and statements in any order."""

    def section(self) -> Section:
        """The whole text; mistakes are reported, and the text after them is read."""
        found: list[Statement] = []
        subprograms: list[Subprogram] = []
        statement: Span | None = None
        declaration: Span | None = None
        while self.lexer.peek().kind != "end":
            token = self.lexer.peek()
            if token.low in DECLARING and token.kind == "name":
                declaration = declaration or self.lexer.span(token)
                found += self._declarations(subprograms)
                continue
            begin = self.lexer.index
            part = self.statements(*DECLARING)
            if part:
                statement = statement or self.lexer.span(token)
                found += part
            if self.lexer.index == begin:
                break
        return Section(tuple(found), tuple(subprograms), statement, declaration)

    def _declarations(self, subprograms: list[Subprogram]) -> list[Statement]:
        """What a word of DECLARING opens."""
        first = self.lexer.peek()
        before = self.lexer.index
        readers: dict[str, Callable[[], list[Statement]]] = {
            "var": self._var,
            "const": self._const,
            "label": self._label_names,
        }
        found: list[Statement] = []
        try:
            if first.low in readers:
                found = readers[first.low]()
            else:
                self._procedure(subprograms)
        except PascalError as error:
            self.symbols.report(error.finding)
            self.pass_mistake(before, DECLARING)
        return found

    def _name_to_declare(self) -> Token:
        token = self.lexer.peek()
        if token.kind != "name":
            at = self.lexer.last if token.kind == "end" else token
            raise self.lexer.error(codes.SYNTAX, at, what="a name is missing in this declaration")
        if token.low in KEYWORDS:
            raise self.lexer.error(codes.DECLARATION, token, what=f"{token.text!r} is a reserved word")
        return self.lexer.take()

    def _names(self) -> list[Token]:
        names = [self._name_to_declare()]
        while self.lexer.peek().text == ",":
            self.lexer.take()
            names.append(self._name_to_declare())
        return names

    def _type(self) -> tuple[Type, str]:
        """The type after a colon, and how it is written."""
        token = self.lexer.take()
        if token.low in DECLARABLE:
            return DECLARABLE[token.low], token.low
        if token.kind != "name" or (token.low in KEYWORDS and token.low != "function"):
            raise self.lexer.error(codes.SYNTAX, token, what="a type is missing", hint="use integer, double or boolean")
        hint = "use integer, double or boolean (the manual has no other type)"
        self.report(codes.PASCAL_OPEN, token, what=f"the type {token.text!r}", hint=hint)
        words = [token.low]
        while self.lexer.peek().text not in (";", ")") and self.lexer.peek().kind != "end":
            words.append(self.lexer.take().low)
        return Type.UNKNOWN, " ".join(words)

    def _goes_on(self, sign: str) -> bool:
        """Whether another group of names follows without a word before it."""
        token, after = self.lexer.peek(), self.lexer.peek(1)
        if token.kind != "name" or token.low in KEYWORDS:
            return False
        if sign == "=":
            return after.text == "="
        symbol = self.symbols.lookup(token.text)
        return after.text in (",", ":") and (symbol is None or symbol.kind != "label")

    def _var(self) -> list[Statement]:
        return self._groups(self._variables, ":")

    def _groups(self, read: Callable[[Token | None], Statement], sign: str) -> list[Statement]:
        """Declarations after one word; each may have a mistake of its own."""
        word: Token | None = self.lexer.take()
        found: list[Statement] = []
        while word is not None or self._goes_on(sign):
            before = self.lexer.index
            try:
                found.append(read(word))
                self.separator(())
            except PascalError as error:
                self.symbols.report(error.finding)
                self.pass_mistake(before, DECLARING)
            word = None
        return found

    def _variables(self, word: Token | None) -> Statement:
        """names : type; word: ``var`` where it is before them."""
        names = self._names()
        self.expect(":", f"after {names[-1].text!r}")
        type_, written = self._type()
        numbers = [self.symbols.add_var(name.text, type_, self.lexer.span(name)).number for name in names]
        span = self.lexer.span(word or names[0], self.lexer.last)
        return Declare(kind="var", names=tuple(n.text for n in names), span=span, type=written, number=numbers[0])

    def _const(self) -> list[Statement]:
        return self._groups(self._constant, "=")

    def _constant(self, word: Token | None) -> Statement:
        """name = value; word: ``const`` where it is before it."""
        name = self._name_to_declare()
        self.expect("=", f"after {name.text!r}")
        begin = self.lexer.peek()
        node, type_ = self.whole()
        value = None if isinstance(node, Text) else constant_value(node)
        if value is not None and type_ is Type.INTEGER and not -LARGEST_INTEGER <= value <= LARGEST_INTEGER:
            value = None
        if value is None and not isinstance(node, Text):
            what = f"the constant {name.text!r} is not a number that is known before the program runs"
            self.report(codes.PASCAL_OPEN, begin, self.lexer.last, what=what, hint="write its value")
        text = node.value if isinstance(node, Text) else None
        self.symbols.add_const(name.text, type_, value, self.lexer.span(name), text)
        return Declare(
            kind="const", names=(name.text,), span=self.lexer.span(word or name, self.lexer.last), value=node
        )

    def _label_names(self) -> list[Statement]:
        first = self.lexer.take()
        names: list[str] = []
        while True:
            token = self.lexer.peek()
            if token.kind != "number" or not token.text.isdigit():
                token = self._name_to_declare()
            else:
                self.lexer.take()
            self.symbols.add_label(
                label_name(token.text) if token.kind == "number" else token.text, self.lexer.span(token)
            )
            names.append(token.text)
            if self.lexer.peek().text != ",":
                break
            self.lexer.take()
        span = self.lexer.span(first, self.lexer.last)
        self.separator(())
        return [Declare(kind="label", names=tuple(names), span=span)]

    def _procedure(self, subprograms: list[Subprogram], within: str = "") -> None:
        """``procedure name (parameters); declarations, begin ... end``; within: name of the one around it, if any.

        Functions, procedures within procedures and ``forward`` are not in the manual: UNKNOWN, and read on.
        """
        first = self.lexer.take()
        name = self._name_to_declare()
        is_function = first.low == "function"
        if is_function or within:
            inside = f", declared within {within!r}" if within else ""
            self.report(codes.PASCAL_OPEN, first, name, what=f"the {first.low} {name.text!r}{inside}")
        made: Subprogram | None = None
        is_new = False
        self.symbols.enter()
        try:
            parameters = self._parameters()
            span = self.lexer.span(first, self.lexer.last)
            is_new = self.symbols.declare_around(name.text, parameters, self.lexer.span(name), first.low)
            made = Subprogram(
                name=name.text.lower(), body=(Unsupported(what=f"the procedure {name.text!r}", span=span),), span=span,
                parameters=tuple((p.name, p.written, p.number) for p in parameters), text=name.text,
            )  # fmt: skip
            if is_function:
                self.expect(":", "after the parameters")
                self._type()
            self.expect(";", "after the head")
            if self.lexer.peek().low == "forward":
                self.report(codes.PASCAL_OPEN, self.lexer.take(), what=f"a body of {name.text!r} that comes later")
                made = None
            else:
                made = self._body(made, name, subprograms)
        finally:
            self.symbols.leave()
            self.symbols.close_procedure(
                name.text, None if made is None else frozenset(_numbers(made.body, self.symbols))
            )
            if made is not None and is_new and not is_function and not within:
                subprograms.append(made)
        self.separator(())

    def _body(self, made: Subprogram, name: Token, subprograms: list[Subprogram]) -> Subprogram:
        """The declarations of a procedure, and its statements."""
        local: list[Statement] = []
        nested = False
        while self.lexer.peek().low in DECLARING:
            if self.lexer.peek().low in ("procedure", "function"):
                nested = True
                self._procedure(subprograms, name.text)
            else:
                local += self._declarations(subprograms)
        token = self.lexer.peek()
        if token.low != "begin":
            at = name if token.kind == "end" else token
            raise self.lexer.error(codes.SYNTAX, at, what=f"'begin' of {name.text!r} is missing")
        body, close = self.compound()
        lost = any(self._lost(body))
        if lost or nested:
            what = "a jump out of it" if lost else "another one in it"
            body = (Unsupported(what=f"the procedure {name.text!r}, with {what}", span=made.span),)
        return replace(made, body=(*local, *body), end_span=self.lexer.span(close))

    def _lost(self, body: tuple[Statement, ...]) -> Iterator[Jump]:
        """Jumps of a procedure that do not stay in it, or go into a block; each is reported."""
        for jump in lost_jumps(body):
            what = f"a jump to {jump.name!r}, which is not in this procedure outside of blocks"
            self.symbols.report(codes.PASCAL_OPEN.at(jump.span, what=what))
            yield jump

    def _parameters(self) -> tuple[Parameter, ...]:
        """( [var] names : type ; ... ), which may be missing."""
        found: list[Parameter] = []
        if self.lexer.peek().text != "(":
            return ()
        opening = self.lexer.take()
        while True:
            by_reference = self.lexer.peek().low == "var"
            if by_reference:
                self.lexer.take()
            names = self._names()
            self.expect(":", f"after {names[-1].text!r}")
            type_, _ = self._type()
            for name in names:
                symbol = self.symbols.add_var(name.text, type_, self.lexer.span(name))
                found.append(Parameter(name.text, type_, symbol.number, by_reference))
            if self.lexer.peek().text != ";":
                break
            self.lexer.take()
        self.closing(opening)
        return tuple(found)


_ARITHMETIC: dict[str, Callable[[float, float], float]] = {
    "+": operator.add, "-": operator.sub, "*": operator.mul, "/": operator.truediv,
    "div": lambda a, b: float(math.trunc(a / b)), "rem": lambda a, b: math.fmod(a, b) if a >= 0 < b else math.nan,
    "and": lambda a, b: float(bool(a) and bool(b)), "or": lambda a, b: float(bool(a) or bool(b)),
    "==": operator.eq, "<>": operator.ne, "<": operator.lt, "<=": operator.le, ">": operator.gt, ">=": operator.ge,
}  # fmt: skip


def _numbers(node: object, symbols: Symbols) -> Iterator[int]:
    """Numbers of the variables in a tree, and in the procedures that it calls."""
    if isinstance(node, Variable) and isinstance(node.number, Number):
        yield int(node.number.value)
    elif isinstance(node, tuple):
        for part in node:
            yield from _numbers(part, symbols)
    elif is_dataclass(node) and not isinstance(node, Span):
        if isinstance(node, Call):
            yield from symbols.uses(node.text)
        for one in fields(node):
            yield from _numbers(getattr(node, one.name), symbols)


def constant_value(node: Expr) -> float | None:
    """The value of an expression over literals and constants; None where it has none, or a function in it."""
    if isinstance(node, Number | Constant):
        return node.value
    if isinstance(node, Unary) and node.operator in ("neg", "pos", "not"):
        value = constant_value(node.operand)
        if value is None:
            return None
        return _in_range(node, {"neg": -value, "pos": value, "not": float(not value)}[node.operator])
    if isinstance(node, Binary) and node.operator in _ARITHMETIC:
        left, right = constant_value(node.left), constant_value(node.right)
        if left is None or right is None or (right == 0 and node.operator in ("/", "div", "rem")):
            return None
        try:
            return _in_range(node, float(_ARITHMETIC[node.operator](left, right)))
        except (ValueError, OverflowError):
            return None
    return None


def _in_range(node: Unary | Binary, value: float) -> float | None:
    """The value of a part of a constant; None for what is no number, and for a whole number of more than 32 bits."""
    limit = float(LARGEST_INTEGER) if node.whole else math.inf
    return value if math.isfinite(value) and abs(value) <= limit else None
