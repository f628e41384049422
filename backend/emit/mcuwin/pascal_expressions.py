"""Expressions of rw_SymPas as text, with the fewest brackets.

A tree that the frontend made is printed so that it makes the same again, ``Binary.doubtful`` included.
Source: McuWIN manual 7, 10 to 12; the grouping of operators is in ``ir/dialects/mcuwin/pascal.py``.
"""

from __future__ import annotations

from typing import NamedTuple

from gproof.backend.emit.numbers import number_text
from gproof.backend.emit.printer import Unprintable
from gproof.ir.dialects.mcuwin.pascal import (
    ANGULAR,
    COMMON_INTEGER,
    FUNCTION_TEXT,
    LAST_COMMON,
    LEVEL,
    SIGN_MATTERS,
    WRITTEN,
)
from gproof.ir.program import (
    Binary,
    Constant,
    Expr,
    Input,
    Named,
    Number,
    Text,
    Unary,
    Variable,
)

RELATION, SUM, PRODUCT, FACTOR = 1, 2, 3, 4
_SIGNS = {"neg": "-", "pos": "+"}


class Style(NamedTuple):
    """What the text depends on apart from the tree: letters of the machine's axes, in its order; the unit of angles."""

    axes: str = "XYZ"
    angle_unit: str = "radians"


def _level(node: Expr) -> int:
    if isinstance(node, Binary):
        if node.operator not in LEVEL:
            raise Unprintable(f"the operator {node.operator!r}")
        return LEVEL[node.operator]
    return SUM if isinstance(node, Unary) and node.operator in _SIGNS else FACTOR


def _spine(node: Expr) -> list[Binary]:
    """A product and those at its left end, the outermost first."""
    found: list[Binary] = []
    while isinstance(node, Binary) and _level(node) == PRODUCT:
        found.append(node)
        node = node.left
    return found


def _negative(node: Expr) -> bool:
    return isinstance(node, Number) and repr(node.value).startswith("-")


class ExpressionPrinter:
    """Prints expressions with one style."""

    def __init__(self, style: Style | None = None) -> None:
        self.style = style or Style()

    def expression(self, node: Expr) -> str:
        """An expression, without brackets around it."""
        if isinstance(node, Binary) and _level(node) == RELATION:
            return f"{self._side(node.left)} {WRITTEN[node.operator]} {self._side(node.right)}"
        return self._sum(node)

    def grouped(self, node: Expr) -> str:
        """An expression as a value after a letter: in brackets unless it is a number or a name."""
        text = self.expression(node)
        plain = isinstance(node, Number | Variable | Constant | Named | Input)
        return text if plain else f"({text})"

    def _bracket(self, node: Expr) -> str:
        return f"({self.expression(node)})"

    def _side(self, node: Expr) -> str:
        """One side of a comparison."""
        return self._bracket(node) if _level(node) == RELATION else self._sum(node)

    def _sum(self, node: Expr) -> str:
        """From where a sign may be, up to a comparison."""
        if isinstance(node, Unary) and node.operator in _SIGNS:
            return self._signed(node)
        if not isinstance(node, Binary) or _level(node) != SUM:
            return self._first_product(node)
        left = self._bracket(node.left) if _level(node.left) == RELATION else self._sum(node.left)
        right = node.right
        plain = _level(right) >= PRODUCT and not _negative(right) and not self._wrong(right, False)
        text = self._product(right, False) if plain else self._bracket(right)
        return f"{left} {WRITTEN[node.operator]} {text}"

    def _signed(self, node: Unary) -> str:
        """A sign before a whole product; a number after it would become one with the sign."""
        inner, minus = node.operand, node.operator == "neg"
        if _level(inner) >= PRODUCT and not self._wrong(inner, minus):
            text = self._product(inner, minus)
            if not text[0].isdigit():
                return _SIGNS[node.operator] + text
            if any(one.doubtful for one in _spine(inner)):
                return _SIGNS[node.operator] + self._product(inner, minus, wrapped=True)
        return _SIGNS[node.operator] + self._bracket(inner)

    def _first_product(self, node: Expr) -> str:
        if _level(node) < PRODUCT:
            return self._bracket(node)
        spine = _spine(node)
        leaf = spine[-1].left if spine else node
        matters = [one.doubtful for one in spine if one.operator in SIGN_MATTERS]
        return self._product(node, False, bare=_negative(leaf) and all(matters))

    def _product(self, node: Expr, signed: bool, *, bare: bool = False, wrapped: bool = False) -> str:
        """Factors; signed: after a minus; bare: its first factor is a number with a sign, without brackets;
        wrapped: its first factor is a number that must not become one with the sign before it."""
        if not isinstance(node, Binary) or _level(node) != PRODUCT:
            if wrapped:
                return self._bracket(node)
            return self._number(node) if bare and isinstance(node, Number) else self._factor(node)
        left = node.left
        cut = _level(left) < PRODUCT or self._wrong(left, signed or bare)
        first = self._bracket(left) if cut else self._product(left, signed, bare=bare, wrapped=wrapped)
        return f"{first} {WRITTEN[node.operator]} {self._factor(node.right)}"

    @staticmethod
    def _wrong(node: Expr, signed: bool) -> bool:
        """Whether a product says something else about the sign before it than ``signed``."""
        return isinstance(node, Binary) and node.operator in SIGN_MATTERS and node.doubtful != signed

    def _factor(self, node: Expr) -> str:
        if isinstance(node, Binary) or _negative(node):
            return self._bracket(node)
        if isinstance(node, Unary):
            return self._function(node)
        return self._atom(node)

    def _function(self, node: Unary) -> str:
        if node.operator in _SIGNS:
            return self._bracket(node)
        if node.operator in ("not", "bnot"):
            return f"not {self._factor(node.operand)}"
        radians = node.operator not in FUNCTION_TEXT or node.operator[1:] in ANGULAR
        if node.operator not in FUNCTION_TEXT:
            raise Unprintable(f"the function {node.operator!r}")
        if node.operator.removeprefix("r") in ANGULAR and radians != (self.style.angle_unit == "radians"):
            raise Unprintable(f"{FUNCTION_TEXT[node.operator]} of another unit than {self.style.angle_unit}")
        return f"{FUNCTION_TEXT[node.operator]}({self.expression(node.operand)})"

    @staticmethod
    def _number(node: Number) -> str:
        return number_text(node.value, node.point)

    def _atom(self, node: Expr) -> str:
        if isinstance(node, Number):
            return self._number(node)
        if isinstance(node, Variable):
            return variable_text(node)
        if isinstance(node, Constant):
            return node.name
        if isinstance(node, Text):
            return self.text(node)
        if isinstance(node, Named):
            axis, dot, qualifier = node.name.partition(".")
            return f"{axis}.{qualifier.lower()}" if dot else node.name
        assert isinstance(node, Input)
        return self._input(node)

    def _input(self, node: Input) -> str:
        if node.kind != "input" or not isinstance(node.number, Number):
            raise Unprintable(f"the state of an {node.kind}")
        axis, channel = divmod(int(node.number.value), 100)
        if not 1 <= axis <= len(self.style.axes):
            raise Unprintable(f"input {channel} of axis {axis}")
        return f"{self.style.axes[axis - 1].upper()}.digib.{channel}"

    def text(self, node: Text) -> str:
        """A text in double quotes; in single ones where it has a double one in it."""
        if '"' not in node.value:
            return f'"{node.value}"'
        return "'" + node.value.replace("'", "''") + "'"


def variable_text(node: Variable) -> str:
    """The name, or CD n, CI n."""
    if node.name:
        return node.name
    number = node.number.value if isinstance(node.number, Number) else -1.0
    prefix, low = ("CI", COMMON_INTEGER) if number >= COMMON_INTEGER else ("CD", 0)
    if number != int(number) or not 0 <= number - low <= LAST_COMMON:
        raise Unprintable("a variable that is neither declared nor CD or CI")
    return f"{prefix}{int(number) - low}"
