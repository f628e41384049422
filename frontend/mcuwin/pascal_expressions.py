"""Expressions of rw_SymPas: recursive descent over tokens, by the precedence of Pascal, with static types.

Source: McuWIN manual 7, 10 to 12. Violations of types are reported and reading goes on; text that is no expression
raises ``PascalError``.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable

from gproof.frontend.mcuwin.pascal_lexer import Lexer, Token
from gproof.frontend.mcuwin.pascal_types import Symbols, Type, binary_type, function_type
from gproof.ir import codes
from gproof.ir.dialects.mcuwin.pascal import (
    COMMON_INTEGER,
    FIRST_USER,
    FUNCTIONS,
    KEYWORDS,
    LAST_COMMON,
    LAST_USER,
    PRODUCTS,
    QUALIFIERS,
    RELATIONS,
    SIGN_MATTERS,
    SUMS,
    SYSTEM_NAMES,
)
from gproof.ir.finding import Code
from gproof.ir.program import Binary, Constant, Expr, Input, Named, Number, Text, Unary, Variable

COMMON = re.compile(r"c([di])([0-9]+)\Z")
_MISREAD = re.compile(r"c1[0-9]{1,3}\Z")
MAX_NESTING = 60
MAX_OPERATORS = 200
LARGEST_INTEGER = 2**31 - 1
PREDEFINED = {"true": (1.0, Type.BOOLEAN), "false": (0.0, Type.BOOLEAN), "pi": (3.141592653589793, Type.DOUBLE)}


class ExpressionParser:
    """Reads expressions from tokens; statements are ``pascal_statements.py``."""

    def __init__(self, lexer: Lexer, symbols: Symbols) -> None:
        self.lexer = lexer
        self.symbols = symbols
        self.nesting = 0
        self.operators = 0

    def report(
        self, code: Code, first: Token, last: Token | None = None, /, *, hint: str = "", **values: object
    ) -> None:
        """A violation after which reading goes on."""
        self.symbols.report(self.lexer.finding(code, first, last, hint=hint, **values))

    def whole(self) -> tuple[Expr, Type]:
        """The longest expression from here."""
        self.operators = 0
        return self.expression()

    def condition(self) -> Expr:
        """An expression that must be boolean."""
        first = self.lexer.peek()
        node, type_ = self.whole()
        if type_ not in (Type.BOOLEAN, Type.UNKNOWN):
            self.report(
                codes.TYPE_MISMATCH, first, self.lexer.last, what=f"a condition must be boolean; this is {type_.value}",
                hint="compare it, or convert it: BOOLEAN(...)",
            )  # fmt: skip
        return node

    def number(self, what: str) -> tuple[Expr, Type]:
        """An expression that must be a number."""
        first = self.lexer.peek()
        node, type_ = self.whole()
        if not type_.numeric:
            self.report(
                codes.TYPE_MISMATCH, first, self.lexer.last, what=f"{what} must be a number; this is {type_.value}"
            )
        return node, type_

    def expression(self) -> tuple[Expr, Type]:
        """Sums, and at most one relation between two of them."""
        first = self.lexer.peek()
        left = self._sum()
        if self.lexer.peek().low in RELATIONS:
            left = self._joined(first, left, self._sum)
            again = self.lexer.peek()
            if again.low in RELATIONS:
                what = "a second comparison next to the first"
                raise self.lexer.error(
                    codes.BAD_EXPRESSION, again, what=what, hint="add brackets, or join them with and"
                )
        return left

    def _sum(self) -> tuple[Expr, Type]:
        """Products between + - or xor; a sign at the start is before the whole first product."""
        first = self.lexer.peek()
        if first.low not in ("+", "-") or first.kind != "op":
            left = self._product()
        else:
            self.lexer.take()
            if self.lexer.peek().kind == "number":
                left = self._product(self._number(first), first)
            else:
                left = self._with_sign(first, self._product(sign=first))
        while self.lexer.peek().low in SUMS:
            left = self._joined(first, left, self._product)
        return left

    def _product(self, start: tuple[Expr, Type] | None = None, sign: Token | None = None) -> tuple[Expr, Type]:
        """Factors between * / div mod and shl shr. sign: what is before; start: a number that was read with it."""
        first = sign if start is not None and sign is not None else self.lexer.peek()
        left = start or self._factor()
        inner_sign = False
        while self.lexer.peek().low in PRODUCTS:
            word = self.lexer.peek()
            sign_next = self.lexer.peek(1).text == "-"
            left = self._joined(first, left, self._factor, signed=sign is not None and sign.text == "-")
            if inner_sign and self._matters(left[0]):
                what = f"a sign within a product with {word.text}"
                self.report(codes.PASCAL_OPEN, word, what=what, hint="add brackets")
            inner_sign = inner_sign or sign_next
        return left

    @staticmethod
    def _matters(node: Expr) -> bool:
        return isinstance(node, Binary) and node.operator in SIGN_MATTERS

    def _joined(
        self, first: Token, left: tuple[Expr, Type], operand: Callable[[], tuple[Expr, Type]], *, signed: bool = False
    ) -> tuple[Expr, Type]:
        """left, an operator that comes next, and what ``operand`` reads after it."""
        word = self.lexer.take()
        self.operators += 1
        if self.operators > MAX_OPERATORS:
            what = f"an expression of more than {MAX_OPERATORS} operators"
            raise self.lexer.error(codes.PASCAL_OPEN, word, what=what, hint="use a variable for a part of it")
        right = operand()
        found = binary_type(word.low, left[1], right[1])
        span = self.lexer.span(first, self.lexer.last)
        if found is None:
            what = f"{word.text} between {left[1].value} and {right[1].value}"
            self.report(codes.TYPE_MISMATCH, first, self.lexer.last, what=what, hint=_hint(word.low, left[1], right[1]))
            found = binary_type(word.low, Type.UNKNOWN, Type.UNKNOWN)
            assert found is not None
        operator, type_ = found
        if signed and operator in SIGN_MATTERS:
            what = f"a minus before a product with {word.text}"
            self.report(codes.PASCAL_OPEN, word, what=what, hint="add brackets")
        doubtful = signed and operator in SIGN_MATTERS
        return Binary(operator, left[0], right[0], span, doubtful, type_ is Type.INTEGER), type_

    def _with_sign(self, sign: Token, value: tuple[Expr, Type]) -> tuple[Expr, Type]:
        node, type_ = value
        if not type_.numeric:
            self.report(codes.TYPE_MISMATCH, sign, self.lexer.last, what=f"a sign before a {type_.value}")
            type_ = Type.UNKNOWN
        operator, span = "neg" if sign.text == "-" else "pos", self.lexer.span(sign, self.lexer.last)
        return Unary(operator, node, span, type_ is Type.INTEGER), type_

    def _number(self, sign: Token | None = None) -> tuple[Expr, Type]:
        token = self.lexer.take()
        point = "." in token.text
        if "e" in token.low:
            self.report(
                codes.PASCAL_OPEN, token, what=f"{token.text} has an exponent", hint="write it without exponent"
            )
        value = float(token.text)
        if math.isinf(value):
            self.report(codes.BAD_EXPRESSION, token, what="a number that is too large for a double")
            value = 0.0
        type_ = Type.DOUBLE if point or "e" in token.low else Type.INTEGER
        if type_ is Type.INTEGER and value > LARGEST_INTEGER:
            what = f"the whole number {token.text} has more than 32 bits"
            self.report(codes.PASCAL_OPEN, token, what=what, hint=f"write {token.text}.0 for a double")
        value = -value if sign is not None and sign.text == "-" else value
        return Number(value, self.lexer.span(sign or token, token), point), type_

    def _factor(self) -> tuple[Expr, Type]:
        token = self.lexer.peek()
        self.nesting += 1
        if self.nesting > MAX_NESTING:
            what = f"brackets and operators nested deeper than {MAX_NESTING}"
            raise self.lexer.error(codes.PASCAL_OPEN, token, what=what, hint="use a variable for a part of it")
        try:
            return self._factor_of(token)
        finally:
            self.nesting -= 1

    def _factor_of(self, token: Token) -> tuple[Expr, Type]:
        if token.kind == "number":
            return self._number()
        if token.kind == "axis":
            return self._axis(self.lexer.take())
        if token.kind == "string":
            self.lexer.take()
            return Text(string_value(token.text), self.lexer.span(token)), Type.STRING
        if token.low == "not":
            return self._negated(self.lexer.take())
        if token.kind == "name" and (
            token.low not in KEYWORDS or token.low in ("true", "false", "boolean", "integer", "double")
        ):
            return self._name(self.lexer.take())
        if token.text == "(":
            return self._bracket()
        if token.text in ("+", "-"):
            self.lexer.take()
            return self._number(token) if self.lexer.peek().kind == "number" else self._with_sign(token, self._factor())
        raise self.missing(token)

    def missing(self, token: Token) -> Exception:
        """What to raise where a value is missing."""
        if token.kind == "end":
            return self.lexer.error(codes.BAD_EXPRESSION, self.lexer.last, what="a value is missing at the end")
        if token.text[0] in "\"'{":
            return self.lexer.error(codes.SYNTAX, token, what="this is not closed")
        return self.lexer.error(codes.BAD_EXPRESSION, token, what=f"a value is missing before {token.text!r}")

    def _bracket(self) -> tuple[Expr, Type]:
        opening = self.lexer.take()
        found = self.expression()
        self.closing(opening)
        return found

    def closing(self, opening: Token) -> None:
        """The bracket that belongs to ``opening``."""
        token = self.lexer.peek()
        if token.text != ")":
            what = (
                "this bracket is not closed"
                if token.kind == "end"
                else f"an operator or ) is missing before {token.text!r}"
            )
            raise self.lexer.error(codes.BAD_EXPRESSION, opening if token.kind == "end" else token, what=what)
        self.lexer.take()

    def _negated(self, word: Token) -> tuple[Expr, Type]:
        node, type_ = self._factor()
        span = self.lexer.span(word, self.lexer.last)
        if type_ in (Type.DOUBLE, Type.STRING):
            hint = "add brackets around the comparison: not (...)"
            self.report(codes.TYPE_MISMATCH, word, self.lexer.last, what=f"not of a {type_.value}", hint=hint)
            type_ = Type.UNKNOWN
        return Unary("bnot" if type_ is Type.INTEGER else "not", node, span), type_

    def _name(self, token: Token) -> tuple[Expr, Type]:
        """A variable, a constant or a function call."""
        span = self.lexer.span(token)
        self.no_element(token)
        if COMMON.match(token.low):
            return self.common(token)
        symbol = self.symbols.resolve(token.text, span)
        if symbol is not None and symbol.kind == "var":
            return Variable(Number(float(symbol.number), span), span, symbol.name), symbol.type
        if symbol is not None and symbol.kind == "const":
            if symbol.text is not None:
                return Text(symbol.text, span), Type.STRING
            if symbol.value is None:
                return Named(token.text.upper(), span), symbol.type
            return Constant(symbol.name, symbol.value, span), symbol.type
        if symbol is not None and symbol.kind != "function":
            self.report(codes.TYPE_MISMATCH, token, what=f"the {symbol.kind} {symbol.name!r} has no value")
            return Named(token.text.upper(), span), Type.UNKNOWN
        if symbol is None and token.low in PREDEFINED:
            value, type_ = PREDEFINED[token.low]
            return Constant(token.low, value, span), type_
        if self.lexer.peek().text == "(":
            return self._call(token, declared=symbol is not None)
        if symbol is None:
            self.undeclared(token)
        return Named(token.text.upper(), span), Type.UNKNOWN

    def no_element(self, token: Token) -> None:
        """Raises where a bracket follows a name: an element of a list, which the manual does not have."""
        bracket = self.lexer.peek()
        if bracket.text != "[":
            return
        what, hint = f"an element of {token.text!r}", ""
        if token.low in ("cd", "ci"):
            what, hint = (
                f"{token.text} with a calculated number",
                f"write {token.text.upper()}600 to {token.text.upper()}699",
            )
        raise self.lexer.error(codes.PASCAL_OPEN, token, bracket, what=what, hint=hint)

    def undeclared(self, token: Token) -> None:
        """Reports a name that nothing declares."""
        if token.low in SYSTEM_NAMES:
            self.report(codes.PASCAL_OPEN, token, what=f"{token.text} is a name of the system")
            return
        alike = self.symbols.alike(token.text)
        hint = "declare it before the first %, in a section after $DINEND"
        if _MISREAD.match(token.low):
            hint = f"check for CI{token.low[2:]}: the manual prints a capital I as a one (12)"
        elif token.low in ("cd", "ci"):
            hint = f"write the number without a blank: {token.text.upper()}600"
        elif alike is not None:
            hint = f"write it as declared, {alike!r}: the machine file is case-sensitive"
        self.report(codes.UNDECLARED_NAME, token, what=f"{token.text!r} is not declared", hint=hint)

    def _call(self, token: Token, *, declared: bool) -> tuple[Expr, Type]:
        """name ( expression )."""
        opening = self.lexer.take()
        node, type_ = self.expression()
        if declared or token.low not in FUNCTIONS:
            while self.lexer.peek().text == ",":
                self.lexer.take()
                self.expression()
        self.closing(opening)
        span = self.lexer.span(token, self.lexer.last)
        if declared:
            self.report(codes.PASCAL_OPEN, token, what=f"{token.text} is a function that the program declares")
            return Named(token.text.upper(), span), Type.UNKNOWN
        if token.low not in FUNCTIONS:
            hint = "use one of these functions: " + " ".join(sorted(FUNCTIONS))
            self.report(codes.UNDECLARED_NAME, token, what=f"there is no function {token.text!r}", hint=hint)
            return Named(token.text.upper(), span), Type.UNKNOWN
        found = function_type(token.low, type_, self.symbols.angle_unit)
        if found is None:
            self.report(codes.TYPE_MISMATCH, token, self.lexer.last, what=f"{token.text} of a {type_.value}")
            found = function_type(token.low, Type.UNKNOWN, self.symbols.angle_unit)
            assert found is not None
        return Unary(found[0], node, span, found[1] is Type.INTEGER), found[1]

    def common(self, token: Token) -> tuple[Expr, Type]:
        """CD n or CI n (11)."""
        found = COMMON.match(token.low)
        assert found is not None
        is_integer, digits = found[1] == "i", found[2]
        type_ = Type.INTEGER if is_integer else Type.DOUBLE
        span = self.lexer.span(token)
        number = int(digits) if len(digits) < 9 else LAST_COMMON + 1
        if number > LAST_COMMON:
            what = f"the numbers are 0 to {LAST_COMMON}; {FIRST_USER} to {LAST_USER} are for programs"
            self.report(codes.ILLEGAL_VALUE, token, word=token.text, what=what)
            return Named(token.text.upper(), span), type_
        if not FIRST_USER <= number <= LAST_USER:
            self.report(
                codes.SYSTEM_VARIABLE, token, name=token.text.upper(), prefix=token.text[:2].upper(),
                hint="use another variable: this one could make the controller unstable (McuWIN manual 11)",
            )  # fmt: skip
        where = float(number + (COMMON_INTEGER if is_integer else 0))
        return Variable(Number(where, span), span), type_

    def _axis(self, token: Token) -> tuple[Expr, Type]:
        """X.tp, X.digib.5."""
        span = self.lexer.span(token)
        axis, qualifier, *bit = token.low.split(".")
        index = self.symbols.axes.lower().find(axis) if len(axis) == 1 else -1
        if index < 0:
            axes = " ".join(self.symbols.axes.upper())
            hint = f"use one of the axes {axes}"
            self.report(codes.UNDECLARED_NAME, token, what=f"there is no axis {axis.upper()!r}", hint=hint)
            return Named(token.text.upper(), span), Type.UNKNOWN
        if qualifier == "digib" and bit:
            channel = int(bit[0]) if len(bit[0]) < 4 else 100
            if not 1 <= channel <= 99:
                self.report(codes.ILLEGAL_VALUE, token, word=token.text, what="digital inputs are numbered from 1")
            return Input("input", Number(float((index + 1) * 100 + channel), span), span), Type.BOOLEAN
        if qualifier not in QUALIFIERS or bit or qualifier == "digib":
            known = ", ".join(f"{axis.upper()}.{name}" for name in QUALIFIERS if name != "digib")
            hint = f"use {known} or {axis.upper()}.digib.1"
            self.report(codes.PASCAL_OPEN, token, what=f"{token.text} is not in the manual", hint=hint)
            return Named(token.text.upper(), span), Type.UNKNOWN
        return Named(token.text.upper(), span), Type.DOUBLE


def string_value(text: str) -> str:
    """What is between the quotes; two single ones are one."""
    return text[1:-1] if text[0] == '"' else text[1:-1].replace("''", "'")


def _hint(word: str, left: Type, right: Type) -> str:
    types = {left, right}
    if word in ("and", "or", "xor") and types != {Type.INTEGER, Type.BOOLEAN}:
        return "add brackets around each comparison: these operators come before comparisons"
    if word in ("and", "or", "xor"):
        return "convert the number: BOOLEAN(...)"
    if word in ("div", "mod", "shl", "shr") and Type.DOUBLE in types:
        return "use / or round(...): these are for integers"
    return ""
