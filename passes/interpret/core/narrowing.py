"""What a condition says of the variables in it, where it holds or does not: guards.

``narrowed`` takes a condition and its truth and gives bounds of variables that hold there. Each of them contains every
value for which the condition has that truth, whatever the other unknown values are: rounding of what is computed is
included, and equality of numbers that need not be whole says no more than that they are close. Variables whose
number is computed are left alone. Source: Eding CNC manual 4.1; McuWIN 4.15, 8.3 (conditions are evaluated as written).
"""

from __future__ import annotations

import math
from collections.abc import Callable

from gproof.ir import intervals as ranges
from gproof.ir.finding import Findings, Refusal, Span
from gproof.ir.intervals import ANY, Range
from gproof.ir.program import Binary, Expr, Number, Unary, Variable
from gproof.ir.symbolic import Unknown, Value, bounds, is_whole
from gproof.passes.interpret.core.expressions import LEAST_WHOLE, MOST_WHOLE, NEARLY, Evaluator

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
        """What is known where a value is in a range."""
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
            if node.whole and node.operator == "sqr":
                return known  # its square may not fit 32 bits
            inner = _of_unary(node.operator, ends, bounds(self._value(node.operand, known)))
            return known if inner is None else self._within(node.operand, inner, known, depth + 1)
        if isinstance(node, Binary) and not node.doubtful and not node.whole and node.operator in ("+", "-"):
            left, right = bounds(self._value(node.left, known)), bounds(self._value(node.right, known))
            if node.operator == "+":
                ends_left, ends_right = _less(ends, right), _less(ends, left)
            else:
                ends_left, ends_right = _less(ends, (-right[1], -right[0])), _less((-high, -low), (-left[1], -left[0]))
            first = self._within(node.left, ends_left, known, depth + 1)
            return None if first is None else self._within(node.right, ends_right, first, depth + 1)
        if isinstance(node, Binary) and not node.doubtful:
            return self._of_product(node, ends, known, depth)
        return known

    def _of_product(self, node: Binary, ends: Range, known: Bounds, depth: int) -> Bounds | None:
        """What is known where a product, a quotient or a shift is in a range; one of its operands is a number."""
        left, right = self._value(node.left, known), self._value(node.right, known)
        operator = node.operator
        if node.whole and (operator not in ("div", "shr") or right == -1.0):
            # What does not fit 32 bits has no value here, and may have another one at the controller.
            exact = ranges.whole_binary(operator, bounds(left), bounds(right))
            if exact is None or not LEAST_WHOLE <= exact[0] <= exact[1] <= MOST_WHOLE:
                return known
        if operator in ("+", "-") and node.whole:
            (a, b), (c, d), (low, high) = bounds(left), bounds(right), ends
            if operator == "-":
                c, d = -d, -c
            first = self._within(node.left, (low - d, high - c), known, depth + 1)
            other = (low - b, high - a) if operator == "+" else (a - high, b - low)
            return None if first is None else self._within(node.right, other, first, depth + 1)
        if operator == "*" and not isinstance(left, Unknown):
            left, right, of = right, left, node.right
        else:
            of = node.left
        if isinstance(right, Unknown) or not math.isfinite(right):
            return known
        inner = _of_binary(operator, ends, right, least=bounds(left)[0], whole=is_whole(left) and is_whole(right))
        return known if inner is None else self._within(of, inner, known, depth + 1)

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


def _of_unary(operator: str, ends: Range, now: Range) -> Range | None:
    """Where x is when ``operator x`` is between ends and x is known to lie in ``now``; None: nothing is said."""
    low, high = ends
    match operator:
        case "abs" if now[0] >= 0.0:
            return low, high
        case "abs" if now[1] <= 0.0:
            return -high, -low
        case "abs" if high < math.inf:
            return -high, high
        case "fix" | "fup" | "int" | "round" | "trunc" | "nearest":
            return low - 1.0, high + 1.0  # whichever way it rounds
        case "sqr" if 0.0 <= high < math.inf:
            most = math.nextafter(math.sqrt(high), math.inf) * (1.0 + _PAD)
            return -most, most
        case "sqrt" if 0.0 <= high < _LARGE_ROOT:
            return max(0.0, low) ** 2 * (1.0 - _PAD), high * high * (1.0 + _PAD)
    return None


_LARGE_ROOT = 1e150


def _of_binary(operator: str, ends: Range, number: float, *, least: float, whole: bool) -> Range | None:
    """Where x is when ``x operator number`` is between ends; None: nothing is said.

    least: x is known to be no less; whole: both are whole numbers. The bounds of a quotient hold whether it
    is cut towards 0, as of ``div``, or rounded down, as by a shift.
    """
    low, high = ends
    if operator in ("<<", ">>", "shr"):
        if not whole or not 0.0 <= number < 32.0 or (operator == "shr" and least < 0.0):
            return None
        operator, number = ("*" if operator == "<<" else "div"), 2.0**number
    if operator == "div" and whole and number != 0.0:
        if number < 0.0:
            low, high, number = -high, -low, -number
        low = low if math.isinf(low) else float(math.ceil(low))
        high = high if math.isinf(high) else float(math.floor(high))
        return (low * number if low > 0.0 else (low - 1.0) * number + 1.0), (high + 1.0) * number - 1.0
    if operator not in ("*", "/") or number == 0.0 or not 1e-100 < abs(number) < 1e100:
        return None
    found = [end / number if operator == "*" else end * number for end in (low, high)]
    if any(math.isnan(end) for end in found):
        return None
    first, last = min(found), max(found)
    pads = [_PAD * abs(end) + 1e-200 if math.isfinite(end) else 0.0 for end in (first, last)]
    return first - pads[0], last + pads[1]


def _less(ends: Range, term: Range) -> Range:
    """The range of x where x + term, rounded, is between ends."""
    low, high = ends[0] - term[1], ends[1] - term[0]
    low = -math.inf if math.isnan(low) else low - _pad(ends[0], term[1])
    high = math.inf if math.isnan(high) else high + _pad(ends[1], term[0])
    return low, high


def _pad(end: float, term: float) -> float:
    return _PAD * (abs(end) + abs(term)) + 5e-324 if math.isfinite(end) and math.isfinite(term) else 0.0
