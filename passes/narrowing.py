"""What a condition says of the variables in it, where it holds or does not: guards.

``narrowed`` takes a condition and its truth and gives bounds of variables that hold there. Each of them contains every
value for which the condition has that truth, whatever the other unknown values are: rounding of what is computed is
counted in, and equality of numbers that need not be whole says no more than that they are close. Variables whose
number is computed are left alone. Source: Eding CNC manual 4.1; McuWIN 4.15, 8.3 (conditions are evaluated as written).
"""

from __future__ import annotations

import math
from collections.abc import Callable

from gproof.ir.finding import Findings, Refusal, Span
from gproof.ir.program import Binary, Expr, Number, Unary, Variable
from gproof.passes.expressions import NEARLY, Evaluator
from gproof.passes.ranges import ANY, Range
from gproof.passes.values import Unknown, Value, bounds, is_whole

_PAD = 4.0 * 2.0**-52
"""Of the numbers of a sum: more than its rounding, and that of taking it back."""
_DEEPEST = 20
_TURNED = {"<": ">", "<=": ">=", ">": "<", ">=": "<=", "==": "==", "<>": "<>"}
_NOT = {"<": ">=", "<=": ">", ">": "<=", ">=": "<", "==": "<>", "<>": "=="}

Bounds = dict[int, Value]
"""By the numbers of variables: what they are where a condition has a truth."""


class Narrowing:
    """What conditions say.

    read: the value of a variable, without a word about it; may: whether its bounds may be set.
    """

    def __init__(self, read: Callable[[float, Span], Value], may: Callable[[int], bool]) -> None:
        self.read = read
        self.may = may

    def narrowed(self, condition: Expr, truth: bool) -> Bounds:
        """Variables of which less is possible where a condition is true, or where it is not."""
        found = self._of(condition, truth, {}, 0)
        return {} if found is None else found

    def _of(self, node: Expr, truth: bool, known: Bounds, depth: int) -> Bounds | None:
        """With what is known already; None where nothing fits."""
        if depth > _DEEPEST:
            return known
        if isinstance(node, Unary) and node.operator == "not":
            return self._of(node.operand, not truth, known, depth + 1)
        if isinstance(node, Binary) and not node.doubtful:
            if node.operator in ("and", "or"):
                return self._of_two(node, truth, known, depth)
            if node.operator in _NOT:
                operator = node.operator if truth else _NOT[node.operator]
                left, right = self._value(node.left, known), self._value(node.right, known)
                first = self._side(node.left, operator, right, known, depth)
                return None if first is None else self._side(node.right, _TURNED[operator], left, first, depth)
            return known
        if isinstance(node, Variable):
            return self._side(node, "<>" if truth else "==", 0.0, known, depth)
        return known

    def _of_two(self, node: Binary, truth: bool, known: Bounds, depth: int) -> Bounds | None:
        both = (node.operator == "and") is truth
        first = self._of(node.left, truth, known, depth + 1)
        if both:
            return None if first is None else self._of(node.right, truth, first, depth + 1)
        # The left one, or the right one where the left one is not.
        other = self._of(node.left, not truth, known, depth + 1)
        second = None if other is None else self._of(node.right, truth, other, depth + 1)
        if first is None or second is None:
            return second if first is None else first
        united: Bounds = {}
        for number in first.keys() & second.keys():
            (a, b), (c, d) = bounds(first[number]), bounds(second[number])
            united[number] = _between(first[number], second[number], (min(a, c), max(b, d)))
        return known | united

    def _value(self, node: Expr, known: Bounds) -> Value:
        """What an expression may be."""

        def read(number: float, span: Span) -> Value:
            return known[round(number)] if round(number) in known else self.read(number, span)

        try:
            return Evaluator(read, Findings()).value(node)
        except Refusal:
            return Unknown("")

    def _side(self, node: Expr, operator: str, other: Value, known: Bounds, depth: int) -> Bounds | None:
        """What ``node operator other`` says of the variables in ``node``."""
        low, high = ANY
        least, most = bounds(other)
        whole = is_whole(other) and is_whole(self._value(node, known))
        if operator in ("<", "<="):
            high = most if operator == "<=" else _below(most, whole=whole)
        elif operator in (">", ">="):
            low = least if operator == ">=" else _above(least, whole=whole)
        elif operator == "==":
            low, high = (least, most) if whole else (least - NEARLY, most + NEARLY)
        elif whole and least == most:
            low, high = bounds(self._value(node, known))
            low = low + 1.0 if low == least else low
            high = high - 1.0 if high == least else high
        return self._within(node, (low, high), known, depth)

    def _within(self, node: Expr, ends: Range, known: Bounds, depth: int) -> Bounds | None:
        """What is known where a value lies in a range."""
        low, high = ends
        if depth > _DEEPEST or math.isnan(low) or math.isnan(high) or ends == ANY:
            return known
        if isinstance(node, Variable):
            return self._variable(node, ends, known)
        if isinstance(node, Unary):
            if node.operator == "neg":
                return self._within(node.operand, (-high, -low), known, depth + 1)
            if node.operator == "pos":
                return self._within(node.operand, ends, known, depth + 1)
            if node.operator == "abs" and high < math.inf:
                return self._within(node.operand, (-high, high), known, depth + 1)
            return known
        if isinstance(node, Binary) and not node.doubtful and not node.whole and node.operator in ("+", "-"):
            left, right = bounds(self._value(node.left, known)), bounds(self._value(node.right, known))
            if node.operator == "+":
                ends_left, ends_right = _less(ends, right), _less(ends, left)
            else:
                ends_left, ends_right = _less(ends, (-right[1], -right[0])), _less((-high, -low), (-left[1], -left[0]))
            first = self._within(node.left, ends_left, known, depth + 1)
            return None if first is None else self._within(node.right, ends_right, first, depth + 1)
        return known

    def _variable(self, node: Variable, ends: Range, known: Bounds) -> Bounds | None:
        if not isinstance(node.number, Number) or node.number.value != round(node.number.value):
            return known
        number = round(node.number.value)
        if not self.may(number):
            return known
        value = known[number] if number in known else self.read(float(number), node.span)
        if not isinstance(value, Unknown):
            return known
        low, high = max(value.low, ends[0]), min(value.high, ends[1])
        if value.whole:
            low = float(math.ceil(low)) if math.isfinite(low) else low
            high = float(math.floor(high)) if math.isfinite(high) else high
        if low > high:
            return None
        if (low, high) == (value.low, value.high):
            return known
        return known | {number: low if low == high else Unknown(value.cause, low, high, value.whole)}


def _between(one: Value, other: Value, ends: Range) -> Value:
    cause = one.cause if isinstance(one, Unknown) else other.cause if isinstance(other, Unknown) else "earlier inputs"
    if ends[0] == ends[1]:
        return ends[0]
    return Unknown(cause, *ends, is_whole(one) and is_whole(other))


def _below(value: float, *, whole: bool) -> float:
    return value - 1.0 if whole and abs(value) < 2.0**52 else math.nextafter(value, -math.inf)


def _above(value: float, *, whole: bool) -> float:
    return value + 1.0 if whole and abs(value) < 2.0**52 else math.nextafter(value, math.inf)


def _less(ends: Range, term: Range) -> Range:
    """The range of x where x + term, rounded, lies between ends."""
    low, high = ends[0] - term[1], ends[1] - term[0]
    low = -math.inf if math.isnan(low) else low - _pad(ends[0], term[1])
    high = math.inf if math.isnan(high) else high + _pad(ends[1], term[0])
    return low, high


def _pad(end: float, term: float) -> float:
    return _PAD * (abs(end) + abs(term)) + 5e-324 if math.isfinite(end) and math.isfinite(term) else 0.0
