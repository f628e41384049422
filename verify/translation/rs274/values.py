"""Expressions of LinuxCNC with known values (G-Code Overview: Expressions, Binary Operators, Functions, Parameters)."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping

from gproof.verify.translation.rs274.language import Unread

SAME = 1e-4
"""EQ and NE call numbers equal that differ by less (Overview, Binary Operators, Equality)."""
FIRST_FREE, LAST_FREE = 31, 5000
"""Variables of the program: those below belong to calls, those above to the controller (Overview, Parameters)."""

_TOKEN = re.compile(r"\s*(?:(?P<number>\d+\.?\d*|\.\d+)|(?P<word>[A-Z]+)|(?P<sign>\*\*|[-+*/#\[\]=]))", re.IGNORECASE)
_LEVELS: tuple[tuple[str, ...], ...] = (
    ("AND", "OR", "XOR"), ("EQ", "NE", "GT", "GE", "LT", "LE"), ("+", "-"), ("*", "/", "MOD"), ("**",),
)  # fmt: skip
"""Weakest first (Overview, Binary Operators)."""


def _atan(_: float) -> float:
    raise Unread("ATAN with one argument")


_FUNCTIONS: dict[str, Callable[[float], float]] = {
    "ABS": abs, "ACOS": lambda v: math.degrees(math.acos(v)), "ASIN": lambda v: math.degrees(math.asin(v)),
    "COS": lambda v: math.cos(math.radians(v)), "EXP": math.exp, "FIX": math.floor, "FUP": math.ceil, "LN": math.log,
    "ROUND": lambda v: math.floor(v + 0.5) if v >= 0.0 else math.ceil(v - 0.5),
    "SIN": lambda v: math.sin(math.radians(v)), "SQRT": math.sqrt, "TAN": lambda v: math.tan(math.radians(v)),
    "ATAN": _atan,
}  # fmt: skip


def _binary(operator: str, left: float, right: float) -> float:
    match operator:
        case "+":
            return left + right
        case "-":
            return left - right
        case "*":
            return left * right
        case "/":
            return left / right
        case "**":
            return float(left**right)
        case "MOD":
            found = math.fmod(left, right)
            return found + abs(right) if found < 0.0 else found
        case "AND":
            return float(left != 0.0 and right != 0.0)
        case "OR":
            return float(left != 0.0 or right != 0.0)
        case "XOR":
            return float((left != 0.0) != (right != 0.0))
        case "EQ":
            return float(abs(left - right) < SAME)
        case "NE":
            return float(abs(left - right) >= SAME)
        case "GT":
            return float(left > right)
        case "GE":
            return float(left >= right)
        case "LT":
            return float(left < right)
        case _:
            return float(left <= right)


class Values:
    """Reads values from a text, from a place on."""

    def __init__(self, text: str, variables: Mapping[int, float]) -> None:
        self.text = text
        self.at = 0
        self.variables = variables

    def peek(self) -> str:
        """The next token, "" at the end; Unread where there is none."""
        if not self.text[self.at :].strip():
            return ""
        found = _TOKEN.match(self.text, self.at)
        if found is None:
            raise Unread(f"{self.text[self.at :].strip()[:20]!r}")
        return found.group().strip().upper()

    def next(self) -> str:
        """The same, and it is used."""
        token = self.peek()
        found = _TOKEN.match(self.text, self.at)
        if not token or found is None:
            raise Unread("an expression that ends too early")
        self.at = found.end()
        return token

    def need(self, token: str) -> None:
        """A token that must be next."""
        if self.next() != token:
            raise Unread(f"{token} is missing")

    def value(self) -> float:
        """After a letter or =: a number with its sign, ``#31``, ``[...]``."""
        token = self.next()
        if token in "+-" and token:
            number = self.next()
            if not (number[0].isdigit() or number[0] == "."):
                raise Unread("a sign before what is no number")
            return -float(number) if token == "-" else float(number)
        return self._operand(token)

    def variable(self) -> int:
        """The number after ``#``."""
        number = self._operand(self.next())
        if abs(number - round(number)) > SAME:
            raise Unread("a variable whose number is no integer")
        return round(number)

    def bracketed(self) -> float:
        """``[...]``."""
        self.need("[")
        found = self._chain(0)
        self.need("]")
        return found

    def _operand(self, token: str) -> float:
        if token[0].isdigit() or token[0] == ".":
            return float(token)
        if token == "[":
            found = self._chain(0)
            self.need("]")
            return found
        if token == "#":
            number = self.variable()
            if not FIRST_FREE <= number <= LAST_FREE or number not in self.variables:
                raise Unread(f"#{number}, whose value is unknown")
            return self.variables[number]
        if token in _FUNCTIONS:
            argument = self.bracketed()
            try:
                if token == "ATAN":
                    self.need("/")
                    return math.degrees(math.atan2(argument, self.bracketed()))
                return float(_FUNCTIONS[token](argument))
            except (ValueError, OverflowError) as error:
                raise Unread(f"{token} of {argument:g}") from error
        raise Unread(f"{token!r} in an expression")

    def _chain(self, level: int) -> float:
        """Operators of one level, from left to right."""
        if level == len(_LEVELS):
            token = self.next()
            if token == "-":
                number = self.next()
                if not (number[0].isdigit() or number[0] == "."):
                    raise Unread("a sign before what is no number")
                return -float(number)
            return self._operand(token)
        found = self._chain(level + 1)
        while self.peek() in _LEVELS[level] and self.peek():
            operator = self.next()
            right = self._chain(level + 1)
            try:
                found = _binary(operator, found, right)
            except (ZeroDivisionError, ValueError, OverflowError, TypeError) as error:
                raise Unread(f"{found:g} {operator} {right:g}") from error
        return found
