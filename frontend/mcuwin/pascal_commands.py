"""Commands of rw_SymPas: assignments, calls of procedures, waits, text output, and what the manual does not know.

Source: McuWIN manual 5.7, 10 to 12. Statements with others in them are ``pascal_statements.py``.
"""

from __future__ import annotations

from gproof.frontend.mcuwin.pascal_expressions import COMMON, ExpressionParser
from gproof.frontend.mcuwin.pascal_lexer import Token
from gproof.frontend.mcuwin.pascal_types import Parameter, Symbol, Type, assignable
from gproof.ir import codes
from gproof.ir.dialects.mcuwin.pascal import FUNCTIONS, KEYWORDS, SYSTEM_NAMES
from gproof.ir.dialects.mcuwin.rules import OFFSETS_AT, PROTECTED
from gproof.ir.program import (
    Assign,
    Block,
    Call,
    Device,
    Expr,
    Message,
    Number,
    Statement,
    Unsupported,
    Variable,
    Word,
)

_SYSTEM_POSITIONS = range(60, 68)
_ERROR_BITS = 48
ENDS = frozenset(("end", "until", "else"))
Statements = tuple[Statement, ...]


def _is_system(number: int, type_: Type) -> bool:
    """Whether a common variable belongs to the controller, so that writing it may change anything (4.20, 11).

    Not the offsets of G153 and G154 (CD50 and on, 3.33) and the error bits that are the application's (CI48).
    """
    own = OFFSETS_AT <= number < OFFSETS_AT + 10 if type_ is Type.DOUBLE else number == _ERROR_BITS
    return number < PROTECTED and not own


class CommandParser(ExpressionParser):
    """Reads statements that have no others in them."""

    def expect(self, word: str, what: str) -> Token:
        """A token that must come next."""
        token = self.lexer.peek()
        if token.low != word:
            at = self.lexer.last if token.kind == "end" else token
            raise self.lexer.error(codes.SYNTAX, at, what=f"{word!r} is missing {what}")
        return self.lexer.take()

    def target(self, what: str) -> tuple[Variable | None, Type]:
        """A variable that is written; None (reported) for what is none."""
        token = self.lexer.peek()
        if token.kind != "name" or token.low in KEYWORDS:
            at = self.lexer.last if token.kind == "end" else token
            raise self.lexer.error(codes.SYNTAX, at, what=f"a variable that can be {what} is missing here")
        self.lexer.take()
        self.no_element(token)
        if COMMON.match(token.low):
            node, type_ = self.common(token)
            if isinstance(node, Variable) and type_ is Type.DOUBLE and int(token.text[2:]) in _SYSTEM_POSITIONS:
                what = f"{token.text.upper()} holds a reference position of the system, but is written"
                self.report(codes.PASCAL_OPEN, token, what=what, hint="use CD600 to CD699 (McuWIN manual 14, 2.5.3.40)")
            elif isinstance(node, Variable) and _is_system(int(token.text[2:]), type_):
                what = f"{token.text.upper()} belongs to the controller, but is written"
                self.report(
                    codes.PASCAL_OPEN, token, what=what, hint="use CI600 to CI699, CD600 to CD699 (McuWIN manual 11)"
                )
            return (node, type_) if isinstance(node, Variable) else (None, type_)
        symbol = self.symbols.resolve(token.text, self.lexer.span(token))
        if symbol is None:
            self.undeclared(token)
            return None, Type.UNKNOWN
        if symbol.kind != "var":
            if not (symbol.kind == "function" and symbol.open):  # its value, and its head has a finding
                wrong = f"the {symbol.kind} {symbol.name!r} is not a variable and cannot be {what}"
                self.report(codes.TYPE_MISMATCH, token, what=wrong)
            return None, Type.UNKNOWN
        span = self.lexer.span(token)
        return Variable(Number(float(symbol.number), span), span, symbol.name), symbol.type

    def assignment_statement(self) -> Statements:
        """variable := expression, as a statement."""
        first = self.lexer.peek()
        if not COMMON.match(first.low) and self.symbols.lookup(first.text) is None and first.low in SYSTEM_NAMES:
            return self.unknown(f"writing the system's {first.text!r}")
        assign = self.assignment()
        if assign is None:
            return ()
        return (Block(words=(), assigns=(assign,), span=assign.span),)

    def assignment(self) -> Assign | None:
        """variable := expression, from here; None where the variable is none (reported)."""
        first = self.lexer.peek()
        variable, type_ = self.target("assigned to")
        self.expect(":=", f"after {first.text!r}")
        begin = self.lexer.peek()
        value, value_type = self.whole()
        if not assignable(type_, value_type):
            what = f"{first.text} is {type_.value} and cannot hold {value_type.value}"
            self.report(codes.TYPE_MISMATCH, begin, self.lexer.last, what=what, hint=_conversion(type_, value_type))
        span = self.lexer.span(first, self.lexer.last)
        return None if variable is None else Assign(variable, value, span)

    def write(self) -> Statements:
        """``write`` and ``writeln``: a message."""
        first = self.lexer.take()
        parts: list[Expr] = []
        if self._is_list():
            opening = self.lexer.take()
            if self.lexer.peek().text != ")":
                parts.append(self.whole()[0])
            while self.lexer.peek().text == ",":
                self.lexer.take()
                parts.append(self.whole()[0])
            self.closing(opening)
        else:
            while self._begins_value():
                parts.append(self.whole()[0])
                if self.lexer.peek().text == ",":
                    comma = self.lexer.take()
                    if not self._begins_value():
                        raise self.lexer.error(codes.SYNTAX, comma, what="a value is missing after this comma")
        return (Message(kind=first.low, parts=tuple(parts), span=self.lexer.span(first, self.lexer.last)),)

    def _is_list(self) -> bool:
        """Whether what follows is a list in brackets: the bracket closes at the end of the statement."""
        if self.lexer.peek().text != "(":
            return False
        depth, ahead = 0, 0
        while True:
            token = self.lexer.peek(ahead)
            if token.kind == "end":
                return False
            depth += {"(": 1, ")": -1}.get(token.text, 0)
            ahead += 1
            if depth == 0:
                after = self.lexer.peek(ahead)
                return after.kind == "end" or after.text == ";" or after.low in ENDS

    def _begins_value(self) -> bool:
        token = self.lexer.peek()
        if token.kind in ("number", "string", "axis") or token.text in ("(", "+", "-") or token.low == "not":
            return True
        return token.kind == "name" and (token.low not in KEYWORDS or token.low in ("true", "false", "boolean"))

    def command(self) -> Statements:
        """A call of a procedure, wt, or what the manual does not know."""
        token = self.lexer.peek()
        symbol = None if COMMON.match(token.low) else self.symbols.resolve(token.text, self.lexer.span(token))
        if symbol is not None and symbol.kind == "procedure":
            return self._call_procedure(symbol)
        if (symbol is not None and symbol.kind != "function") or COMMON.match(token.low):
            what = f"{token.text!r} alone is not a statement"
            raise self.lexer.error(codes.SYNTAX, token, what=what, hint=f"assign it: {token.text} := ...")
        if token.low == "wt" and symbol is None:
            self.lexer.take()
            opening = self.expect("(", "after wt")
            value, _ = self.number("a time")
            self.closing(opening)
            return (Device(name="wait", arguments=(value,), span=self.lexer.span(token, self.lexer.last)),)
        # Names of the language's own functions are printed in lower case.
        return self.unknown(f"the command {(token.low if token.low in FUNCTIONS else token.text)!r}")

    def _call_procedure(self, symbol: Symbol) -> Statements:
        token = self.lexer.take()
        arguments: list[Word] = []
        if self.lexer.peek().text == "(":
            opening = self.lexer.take()
            while self.lexer.peek().text != ")" or arguments:
                index = len(arguments)
                arguments.append(self._argument(symbol.parameters[index] if index < len(symbol.parameters) else None))
                if self.lexer.peek().text != ",":
                    break
                self.lexer.take()
            self.closing(opening)
        if len(arguments) != len(symbol.parameters):
            wanted = len(symbol.parameters)
            what = f"{symbol.name!r} takes {wanted} value{'' if wanted == 1 else 's'}, {len(arguments)} given"
            raise self.lexer.error(codes.TYPE_MISMATCH, token, self.lexer.last, what=what)
        self._by_reference(symbol, token, arguments)
        span = self.lexer.span(token, self.lexer.last)
        return (Call(name=symbol.name.lower(), span=span, arguments=tuple(arguments), text=symbol.name),)

    def _by_reference(self, symbol: Symbol, token: Token, arguments: list[Word]) -> None:
        """What a call does not mean when parameters and local variables are variables as the others are."""
        if symbol.open:
            self.report(codes.PASCAL_OPEN, token, self.lexer.last, what=f"the procedure {symbol.name!r} calls itself")
        given: set[int] = set()
        for parameter, word in zip(symbol.parameters, arguments, strict=True):
            value = word.value
            if not (parameter.by_reference and isinstance(value, Variable) and isinstance(value.number, Number)):
                continue
            number = int(value.number.value)
            if number in given or number in symbol.uses:
                what = f"{symbol.name!r} gets a variable as {parameter.name!r} that it also uses under another name"
                self.report(codes.PASCAL_OPEN, token, self.lexer.last, what=what, hint="use another variable")
            given.add(number)

    def _argument(self, parameter: Parameter | None) -> Word:
        first = self.lexer.peek()
        value, type_ = self.whole()
        span = self.lexer.span(first, self.lexer.last)
        if parameter is None:
            return Word("", value, span)
        if parameter.by_reference and (not isinstance(value, Variable) or type_ != parameter.type):
            what = f"{parameter.name!r} is a var parameter: it needs a variable of type {parameter.type.value}"
            self.report(codes.TYPE_MISMATCH, first, self.lexer.last, what=what)
        elif not assignable(parameter.type, type_):
            what = f"{parameter.name} is {parameter.type.value} and cannot hold {type_.value}"
            hint = _conversion(parameter.type, type_)
            self.report(codes.TYPE_MISMATCH, first, self.lexer.last, what=what, hint=hint)
        return Word(parameter.name, value, span)

    def unknown(self, what: str) -> Statements:
        """A command that is not in the manual, up to the semicolon."""
        first = self.lexer.take()
        words, depth, previous = [first.text], 0, first
        while True:
            token = self.lexer.peek()
            if token.kind == "end" or (depth <= 0 and (token.text == ";" or token.low in ENDS)):
                break
            depth += {"(": 1, "[": 1, ")": -1, "]": -1}.get(token.text, 0)
            gap = token.begin > previous.end or token.row != previous.row
            words.append(f" {token.text}" if gap else token.text)
            previous = self.lexer.take()
        text = "".join(words) if previous.row == first.row else ""
        return (Unsupported(what=what, span=self.lexer.span(first, previous), text=text),)


def _conversion(target: Type, value: Type) -> str:
    if target is Type.INTEGER and value is Type.DOUBLE:
        return "use round(...) or trunc(...)"
    return "convert it: BOOLEAN(...)" if target is Type.BOOLEAN and value.numeric else ""
