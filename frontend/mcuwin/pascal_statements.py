"""Statements of rw_SymPas as nodes of the Program.

Source: McuWIN manual 5.7, 7, 8, 10 to 12; statements that it only implies (if, loops and ``goto`` without ``$`` and
``begin``) are those of Pascal. What is no statement of the manual is ``Unsupported``.
"""

from __future__ import annotations

from collections.abc import Callable

from gproof.frontend.mcuwin.pascal_expressions import COMMON, ExpressionParser
from gproof.frontend.mcuwin.pascal_lexer import PascalError, Token
from gproof.frontend.mcuwin.pascal_types import Parameter, Symbol, Type, assignable
from gproof.ir import codes
from gproof.ir.dialects.mcuwin_pascal import KEYWORDS, SYSTEM_NAMES
from gproof.ir.program import (
    Assign,
    Block,
    Call,
    Device,
    Expr,
    For,
    If,
    Jump,
    Label,
    Message,
    Number,
    Repeat,
    Statement,
    Unsupported,
    Variable,
    While,
    Word,
)

ENDS = frozenset(("end", "until", "else"))
MAX_DEPTH = 40
_SYSTEM_POSITIONS = range(60, 68)
Statements = tuple[Statement, ...]


class StatementParser(ExpressionParser):
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
                self._pass_mistake(before, ends)

    def line_statements(self) -> Statements:
        """Statements up to the end of the text; the first mistake is raised."""
        found: list[Statement] = []
        while self.lexer.peek().kind != "end":
            found += self.statement()
            self.separator(())
        return tuple(found)

    def separator(self, ends: tuple[str, ...]) -> None:
        """The semicolon behind a statement, which may be missing before one of ``ends`` and at the end of the text."""
        token = self.lexer.peek()
        if token.text == ";":
            self.lexer.take()
        elif token.kind != "end" and token.low not in ends:
            what = f"a semicolon is missing before {token.text!r}"
            if token.text[0] in "\"'{":
                what = "this is not closed"
            raise self.lexer.error(codes.SYNTAX, token, what=what)

    def _pass_mistake(self, before: int, ends: tuple[str, ...]) -> None:
        """Goes on behind the next semicolon, or before what may close the block."""
        if self.lexer.index == before:
            self.lexer.take()
        while True:
            token = self.lexer.peek()
            if token.kind == "end" or token.low in ends:
                return
            if self.lexer.take().text == ";":
                return

    def statement(self) -> Statements:
        """One statement, without the semicolon behind it; a compound gives its statements."""
        token = self.lexer.peek()
        self.depth += 1
        if self.depth > MAX_DEPTH:
            what = f"more than {MAX_DEPTH} statements inside one another"
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
            "write": self._write,
            "writeln": self._write,
        }
        if token.low in readers and token.kind == "name":
            return readers[token.low]()
        after = self.lexer.peek(1)
        if token.kind == "name" and after.text == ":=" and token.low not in KEYWORDS:
            return self._assignment()
        if token.kind == "axis":
            return self._unknown(f"the command {token.text!r}")
        if token.kind in ("name", "number") and after.text == ":" and token.low not in KEYWORDS:
            return self._label()
        if token.kind == "name" and token.low not in KEYWORDS:
            return self._command()
        if token.text == ";" or token.low in ENDS or token.kind == "end":
            return ()
        what = "this is not closed" if token.text[0] in "\"'{" else f"{token.text!r} does not begin a statement"
        raise self.lexer.error(codes.SYNTAX, token, what=what)

    def expect(self, word: str, what: str) -> Token:
        """A token that must come next."""
        token = self.lexer.peek()
        if token.low != word:
            at = self.lexer.last if token.kind == "end" else token
            raise self.lexer.error(codes.SYNTAX, at, what=f"{word!r} is missing {what}")
        return self.lexer.take()

    def compound(self) -> tuple[Statements, Token]:
        """begin ... end, and its ``end``."""
        opening = self.lexer.take()
        body = self.statements("end")
        if self.lexer.peek().low != "end":
            raise self.lexer.error(codes.UNBALANCED_BLOCK, opening, what=f"{opening.text!r} has no end")
        return body, self.lexer.take()

    def body(self) -> tuple[Statements, Token | None]:
        """What a condition or a loop holds: a statement, or a compound with its ``end``."""
        if self.lexer.peek().low == "begin":
            return self.compound()
        return self.statement(), None

    # assignments and conditions

    def target(self, what: str) -> tuple[Variable | None, Type]:
        """A variable that is written; None (reported) for what is none."""
        token = self.lexer.peek()
        if token.kind != "name" or token.low in KEYWORDS:
            at = self.lexer.last if token.kind == "end" else token
            raise self.lexer.error(codes.SYNTAX, at, what=f"a variable that can be {what} is missing here")
        self.lexer.take()
        if COMMON.match(token.low):
            node, type_ = self.common(token)
            if isinstance(node, Variable) and type_ is Type.DOUBLE and int(token.text[2:]) in _SYSTEM_POSITIONS:
                what = f"{token.text.upper()} holds a reference position of the system, and is written"
                self.report(codes.PASCAL_OPEN, token, what=what, hint="McuWIN manual 14 (2.5.3.40): use CD600 to CD699")
            return (node, type_) if isinstance(node, Variable) else (None, type_)
        symbol = self.symbols.resolve(token.text, self.lexer.span(token))
        if symbol is None:
            self.undeclared(token)
            return None, Type.UNKNOWN
        if symbol.kind != "var":
            self.report(
                codes.TYPE_MISMATCH,
                token,
                what=f"the {symbol.kind} {symbol.name!r} is no variable and can not be {what}",
            )
            return None, Type.UNKNOWN
        span = self.lexer.span(token)
        return Variable(Number(float(symbol.number), span), span, symbol.name), symbol.type

    def _assignment(self) -> Statements:
        first = self.lexer.peek()
        if not COMMON.match(first.low) and self.symbols.lookup(first.text) is None and first.low in SYSTEM_NAMES:
            return self._unknown(f"writing the system's {first.text!r}")
        assign = self.assignment()
        if assign is None:
            return ()
        return (Block(words=(), assigns=(assign,), span=assign.span),)

    def assignment(self) -> Assign | None:
        """variable := expression, from here; None where the variable is none (reported)."""
        first = self.lexer.peek()
        variable, type_ = self.target("assigned to")
        self.expect(":=", f"behind {first.text!r}")
        begin = self.lexer.peek()
        value, value_type = self.whole()
        if not assignable(type_, value_type):
            what = f"{first.text} is {type_.value} and can not hold {value_type.value}"
            self.report(codes.TYPE_MISMATCH, begin, self.lexer.last, what=what, hint=_conversion(type_, value_type))
        span = self.lexer.span(first, self.lexer.last)
        return None if variable is None else Assign(variable, value, span)

    def _if(self) -> Statements:
        first = self.lexer.take()
        condition = self.condition()
        head = self.lexer.span(first, self.expect("then", "behind the condition"))
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
        span = self.lexer.span(first, self.expect("do", "behind the condition"))
        body, close = self.body()
        end = None if close is None else self.lexer.span(close)
        return (While(condition=condition, body=body, span=span, end_span=end),)

    def _repeat(self) -> Statements:
        first = self.lexer.take()
        body = self.statements("until", "end", "else")
        word = self.expect("until", "behind repeat")
        condition = self.condition()
        end = self.lexer.span(word, self.lexer.last)
        return (Repeat(condition=condition, body=body, span=self.lexer.span(first), end_span=end),)

    def for_head(self) -> tuple[Variable | None, Expr, Expr, bool, Token]:
        """for v := a to b do: (variable, first, last, falling, the word do), behind ``for``."""
        name = self.lexer.peek()
        variable, type_ = self.target("counted")
        if type_ not in (Type.INTEGER, Type.UNKNOWN):
            what = f"the variable of a for loop is an integer; {name.text} is {type_.value}"
            self.report(codes.TYPE_MISMATCH, name, what=what, hint="use CI600 to CI699, or declare it as integer")
        self.expect(":=", f"behind {name.text!r}")
        first = self._bound()
        word = self.lexer.peek()
        if word.low not in ("to", "downto"):
            at = self.lexer.last if word.kind == "end" else word
            raise self.lexer.error(codes.SYNTAX, at, what="'to' or 'downto' is missing behind the start value")
        self.lexer.take()
        last = self._bound()
        return variable, first, last, word.low == "downto", self.expect("do", "behind the end value")

    def _bound(self) -> Expr:
        first = self.lexer.peek()
        node, type_ = self.whole()
        if type_ not in (Type.INTEGER, Type.UNKNOWN):
            what = f"a bound of a for loop is an integer; this is {type_.value}"
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
            raise self.lexer.error(codes.SYNTAX, first, what="a label is missing behind goto")
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
            self.report(codes.UNDECLARED_NAME, token, what=what, hint=f"label {token.text}; before the first %")

    # commands

    def _write(self) -> Statements:
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
                        raise self.lexer.error(codes.SYNTAX, comma, what="a value is missing behind this comma")
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

    def _command(self) -> Statements:
        """A call of a procedure, wt, or what the manual does not know."""
        token = self.lexer.peek()
        symbol = None if COMMON.match(token.low) else self.symbols.resolve(token.text, self.lexer.span(token))
        if symbol is not None and symbol.kind == "procedure":
            return self._call_procedure(symbol)
        if (symbol is not None and symbol.kind != "function") or COMMON.match(token.low):
            what = f"{token.text!r} alone is no statement"
            raise self.lexer.error(codes.SYNTAX, token, what=what, hint=f"{token.text} := ...")
        if token.low == "wt" and symbol is None:
            self.lexer.take()
            opening = self.expect("(", "behind wt")
            value, _ = self.number("a time")
            self.closing(opening)
            return (Device(name="wait", arguments=(value,), span=self.lexer.span(token, self.lexer.last)),)
        return self._unknown(f"the command {token.text!r}")

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
                self.report(codes.PASCAL_OPEN, token, self.lexer.last, what=what, hint="use a further variable")
            given.add(number)

    def _argument(self, parameter: Parameter | None) -> Word:
        first = self.lexer.peek()
        value, type_ = self.whole()
        span = self.lexer.span(first, self.lexer.last)
        if parameter is None:
            return Word("", value, span)
        if parameter.by_reference and (not isinstance(value, Variable) or type_ != parameter.type):
            what = f"{parameter.name!r} is a var parameter: it takes a variable of type {parameter.type.value}"
            self.report(codes.TYPE_MISMATCH, first, self.lexer.last, what=what)
        elif not assignable(parameter.type, type_):
            what = f"{parameter.name} is {parameter.type.value} and can not hold {type_.value}"
            hint = _conversion(parameter.type, type_)
            self.report(codes.TYPE_MISMATCH, first, self.lexer.last, what=what, hint=hint)
        return Word(parameter.name, value, span)

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

    def _unknown(self, what: str) -> Statements:
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


def label_name(text: str) -> str:
    """A label as ``Label`` and ``Jump`` name it: lower case, digits without leading zeros."""
    return str(int(text)) if text.isdigit() else text.lower()


def _conversion(target: Type, value: Type) -> str:
    if target is Type.INTEGER and value is Type.DOUBLE:
        return "use round(...) or trunc(...)"
    return "convert it: BOOLEAN(...)" if target is Type.BOOLEAN and value.numeric else ""
