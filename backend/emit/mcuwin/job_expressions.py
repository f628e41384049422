"""Expressions of a Job as rw_SymPas: types, angles, conditions; sections of the manual of V 2.5.3.133.

A Job's variables have no types. Here each is a double, but those that only ever hold whole numbers because a counted
loop counts with them (8.3). Conditions are Booleans (7): a number is one where it is not 0.
"""

from __future__ import annotations

import math
from collections.abc import Iterable

from gproof.backend.emit.mcuwin.pascal_expressions import ExpressionPrinter
from gproof.backend.emit.mcuwin.pascal_expressions import Style as ExpressionStyle
from gproof.backend.emit.printer import Unprintable
from gproof.ir.dialects.mcuwin.pascal import ANGULAR, COMMON_INTEGER, FUNCTION_TEXT, RELATIONS, WRITTEN
from gproof.ir.dialects.mcuwin.rules import COMMON, DECLARED, PROTECTED
from gproof.ir.job import CountLoop, Node, SetVariable
from gproof.ir.job_features import expressions, parts_of_expression
from gproof.ir.program import Binary, Constant, Expr, Input, Number, Unary, Variable

NEGATED = {"<": ">=", ">=": "<", ">": "<=", "<=": ">", "==": "<>", "<>": "=="}
IS_RELATION = frozenset(RELATIONS.values())
LOGICAL = frozenset(("and", "or", "xor"))
WHOLE = frozenset(("+", "-", "*", "div", "rem", "band", "bor", "bxor", "<<", "shr"))
ONLY_WHOLE = WHOLE - {"+", "-", "*"}
TO_WHOLE = frozenset(("trunc", "nearest"))
MOST_POWER = 8
"""Powers that are written as products."""
DEGREE = math.pi / 180.0


class Variables:
    """What the variables of a job are called. whole: numbers of those that are integers; declared: name, integer."""

    def __init__(self, nodes: Iterable[Node], source: str) -> None:
        self.own = source == "mcuwin"
        found = list(nodes)
        self.whole = _whole_variables(found, self.own)
        self.names: dict[int, str] = {}
        self.declared: dict[str, bool] = {}
        for node in found:
            for expr in expressions(node):
                for part in parts_of_expression(expr):
                    if isinstance(part, Variable):
                        self._name(part)

    def _name(self, variable: Variable) -> None:
        number = number_of(variable)
        if number in self.names:
            return
        if self.own and variable.name:
            name = variable.name
            while name in self.declared:
                name += "_"
        elif self.own and number < DECLARED and number % COMMON >= PROTECTED:
            self.names[number] = f"CI{number - COMMON_INTEGER}" if number >= COMMON_INTEGER else f"CD{number}"
            return
        else:
            # Names have no digits (10).
            name = "v_" + "".join(chr(ord("a") + int(digit)) for digit in str(number))
        self.names[number] = name
        self.declared[name] = number in self.whole

    def text(self, variable: Variable) -> str:
        """What it is called."""
        return self.names[number_of(variable)]

    def is_whole(self, variable: Variable) -> bool:
        """Whether it is an integer."""
        number = number_of(variable)
        return number in self.whole or (self.own and COMMON_INTEGER <= number < DECLARED)


def number_of(variable: Variable) -> int:
    """Its number; Unprintable where that is computed."""
    if not isinstance(variable.number, Number) or variable.number.value < 0.0:
        raise Unprintable("a variable whose number is computed")
    return round(variable.number.value)


def _whole_variables(nodes: list[Node], own: bool) -> set[int]:
    """Those that counted loops count with or to, or that are set into CI, and that nothing else than whole numbers is
    set to. own: a program of this controller."""
    settings = [node for node in nodes if isinstance(node, SetVariable)]
    found: set[int] = set()
    rest = [one for node in nodes if isinstance(node, CountLoop) for one in (node.variable, node.first, node.last)]
    for node in nodes:
        inside = (part for expr in expressions(node) for part in parts_of_expression(expr))
        rest += [one for one in inside if isinstance(one, Binary) and one.operator in ONLY_WHOLE]
    rest += [node.value for node in settings if COMMON_INTEGER <= number_of(node.target) < DECLARED] if own else []
    while rest:
        for part in parts_of_expression(rest.pop()):
            if isinstance(part, Variable) and number_of(part) not in found:
                found.add(number_of(part))
                rest += [node.value for node in settings if number_of(node.target) == number_of(part)]
    while True:
        lost = {
            number_of(node.target) for node in settings
            if number_of(node.target) in found and not _is_whole(node.value, found)
        }  # fmt: skip
        if not lost:
            return found
        found -= lost


def _is_whole(expr: Expr, whole: set[int], *, common: bool = True) -> bool:
    if isinstance(expr, Number):
        return expr.value == round(expr.value) and not expr.point
    if isinstance(expr, Constant):
        return expr.value == round(expr.value)
    if isinstance(expr, Variable):
        number = number_of(expr)
        return number in whole or (common and COMMON_INTEGER + PROTECTED <= number < DECLARED)
    if isinstance(expr, Unary):
        return expr.operator in TO_WHOLE or (expr.operator in ("neg", "pos", "abs") and _is_whole(expr.operand, whole))
    if isinstance(expr, Binary):
        return expr.operator in WHOLE and _is_whole(expr.left, whole) and _is_whole(expr.right, whole)
    return False


class PascalWriter:
    """Texts of expressions. axes: letters of the machine, for inputs; angle_unit: of its functions."""

    def __init__(self, variables: Variables, axes: str, angle_unit: str) -> None:
        self.variables = variables
        self.angle_unit = angle_unit
        self.printer = ExpressionPrinter(ExpressionStyle(axes, angle_unit))

    def value(self, expr: Expr) -> str:
        """A number, after ``:=`` or in a text; Unprintable."""
        return self.printer.expression(self.number(expr))

    def word(self, expr: Expr) -> str:
        """A number after a letter or a code: what is no literal in brackets."""
        return f"({self.value(expr)})"

    def whole(self, expr: Expr) -> str:
        """A bound of a counted loop (8.3), or what an integer is set to."""
        if not _is_whole(expr, self.variables.whole):
            raise Unprintable("a number that may be no integer, where an integer is needed (8.3, 11)")
        return self.value(expr)

    def condition(self, expr: Expr, *, negated: bool = False) -> str:
        """A Boolean in brackets (7)."""
        return f"({self.printer.expression(self.boolean(expr, negated))})"

    # ---- trees

    def boolean(self, expr: Expr, negated: bool = False) -> Expr:
        """A condition as rw_SymPas has it."""
        if isinstance(expr, Binary) and expr.operator in ("==", "<>") and _is_zero(expr.right) and _is_bool(expr.left):
            # 1 where a condition is 0.
            return self.boolean(expr.left, negated != (expr.operator == "=="))
        if isinstance(expr, Binary) and expr.operator in IS_RELATION:
            operator = NEGATED[expr.operator] if negated else expr.operator
            return Binary(operator, self.number(expr.left), self.number(expr.right), expr.span)
        if isinstance(expr, Binary) and expr.operator in LOGICAL:
            found: Expr = Binary(expr.operator, self.boolean(expr.left), self.boolean(expr.right), expr.span)
            return Unary("not", found, expr.span) if negated else found
        if isinstance(expr, Unary) and expr.operator == "not":
            return self.boolean(expr.operand, not negated)
        if isinstance(expr, Unary) and expr.operator == "bool":
            return self.boolean(expr.operand, negated)
        if isinstance(expr, Input):
            return Unary("not", expr, expr.span) if negated else expr
        operator = "==" if negated else "<>"
        return Binary(operator, self.number(expr), Number(0.0, expr.span), expr.span)

    def number(self, expr: Expr) -> Expr:
        """A number as rw_SymPas has it; Unprintable."""
        if isinstance(expr, Number):
            return expr
        if isinstance(expr, Constant):
            return Number(expr.value, expr.span)
        if isinstance(expr, Variable):
            return Constant(self.variables.text(expr), 0.0, expr.span)
        if isinstance(expr, Unary):
            return self._function(expr)
        if isinstance(expr, Binary):
            return self._operation(expr)
        raise Unprintable("a state or a name of the controller, as a number")

    def _operation(self, expr: Binary) -> Expr:
        if expr.operator == "**":
            return self._power(expr)
        if expr.operator in IS_RELATION or expr.operator in LOGICAL or expr.operator not in WRITTEN:
            raise Unprintable(f"the operator {expr.operator!r} in a number")
        if expr.operator in ONLY_WHOLE and not _is_whole(expr, self.variables.whole):
            raise Unprintable(f"the operator {expr.operator!r} of numbers that may be no integers")
        return Binary(expr.operator, self.number(expr.left), self.number(expr.right), expr.span)

    def _power(self, expr: Binary) -> Expr:
        times = expr.right.value if isinstance(expr.right, Number) else 0.0
        if times != round(times) or not 1 <= times <= MOST_POWER:
            raise Unprintable("a power whose exponent is no small whole number")
        base = found = self.number(expr.left)
        for _ in range(round(times) - 1):
            found = Binary("*", found, base, expr.span)
        return found

    def _function(self, expr: Unary) -> Expr:
        name, inner = expr.operator, self.number(expr.operand)
        plain = name.removeprefix("r") if name != "round" else name
        if plain in ANGULAR:
            return self._angular(name, plain, inner, expr)
        if name not in FUNCTION_TEXT and name not in ("neg", "pos"):
            raise Unprintable(f"the function {name!r}")
        if name in ("odd", "bool"):
            raise Unprintable(f"the function {name!r} in a number")
        return Unary(name, inner, expr.span)

    def _angular(self, name: str, plain: str, inner: Expr, expr: Unary) -> Expr:
        """A function of angles, in the unit of the machine."""
        radians = name != plain
        own = f"r{plain}" if self.angle_unit == "radians" else plain
        if radians == (self.angle_unit == "radians"):
            return Unary(own, inner, expr.span)
        factor = 1.0 / DEGREE if radians else DEGREE
        inverse = plain.startswith("a")
        if inverse:
            return Binary("*", Unary(own, inner, expr.span), Number(1.0 / factor, expr.span), expr.span)
        return Unary(own, Binary("*", inner, Number(factor, expr.span), expr.span), expr.span)


def _is_zero(expr: Expr) -> bool:
    return isinstance(expr, Number) and expr.value == 0.0


def _is_bool(expr: Expr) -> bool:
    """Whether it is a Boolean in rw_SymPas."""
    if isinstance(expr, Binary):
        return expr.operator in IS_RELATION or expr.operator in LOGICAL
    return isinstance(expr, Input) or (isinstance(expr, Unary) and expr.operator in ("not", "bool"))
