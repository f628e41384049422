"""Arithmetic on ranges of numbers: what an operator can give when its operands are only bounded.

A range is (low, high) with low <= high, ends included, infinite ends allowed. Results contain every value that the
operator gives for numbers of the ranges, the rounding of their ends included; ``None`` means that nothing is known.
"""

from __future__ import annotations

import math
from collections.abc import Callable

Range = tuple[float, float]

ANY: Range = (-math.inf, math.inf)
_LARGEST_EXPONENT = 700.0
_LARGE = 1e300
_EXACT = 2.0**53
_WORD = 32.0
"""Bits of a whole number."""
_LOGIC = ("and", "or", "xor", ">", ">=", "<", "<=", "==", "<>")


def widened(low: float, high: float) -> Range:
    """One step of rounding outwards on both sides; what is no number is unbounded."""
    if math.isnan(low) or math.isnan(high):
        return ANY
    return math.nextafter(low, -math.inf), math.nextafter(high, math.inf)


def unary_may_fail(operator: str, x: Range) -> bool:
    """Whether ``operator x`` has no value for some number of the range."""
    low, high = x
    match operator:
        case "acos" | "asin" | "racos" | "rasin":
            return low < -1.0 or high > 1.0
        case "sqrt":
            return low < 0.0
        case "ln":
            return low <= 0.0
        case "exp":
            return high > _LARGEST_EXPONENT
        case "bnot" | "odd":
            return True  # a range holds numbers that are not whole
    return False


def binary_may_fail(operator: str, x: Range, y: Range) -> bool:
    """Whether ``x operator y`` has no value for some numbers of the ranges, sums and products beyond 1e308 left out."""
    match operator:
        case "/" | "mod":
            return y[0] <= 0.0 <= y[1]
        case "**":
            return not (x[0] > 0.0 and x[1] < _LARGE and y[0] > -_LARGE and y[1] < _LARGE and _power_fits(x, y))
        case "band" | "bor" | "bxor" | "<<" | ">>" | "shr" | "div" | "rem":
            return True  # a range holds numbers that are not whole
    return False


def _power_fits(x: Range, y: Range) -> bool:
    return max(abs(math.log(b) * e) for b in x for e in y) < _LARGEST_EXPONENT


def _quotient(a: float, b: float) -> float:
    """a / b for ends of ranges; what no numbers of the ranges can decide is no number."""
    if math.isinf(b):
        return math.nan if math.isinf(a) else 0.0
    try:
        return a / b
    except OverflowError:
        return math.nan


def _corners(x: Range, y: Range, operate: Callable[[float, float], float]) -> Range:
    values = []
    for a in x:
        for b in y:
            if 0.0 in (a, b) and (math.isinf(a) or math.isinf(b)):
                values.append(0.0)
                continue
            values.append(operate(a, b))
    return widened(min(values), max(values))


def _truth(x: Range) -> bool | None:
    """Whether numbers of the range are true (not zero); None when both occur."""
    if x == (0.0, 0.0):
        return False
    return True if x[0] > 0 or x[1] < 0 else None


def _logic(operator: str, x: Range, y: Range) -> bool | None:
    a, b = _truth(x), _truth(y)
    if operator == "and":
        return False if a is False or b is False else (True if a and b else None)
    if operator == "or":
        return True if a or b else (False if a is False and b is False else None)
    return None if a is None or b is None else a != b


def _compare(operator: str, x: Range, y: Range) -> bool | None:
    if operator == "<":
        return True if x[1] < y[0] else (False if x[0] >= y[1] else None)
    if operator == "<=":
        return True if x[1] <= y[0] else (False if x[0] > y[1] else None)
    if operator == ">":
        return _compare("<", y, x)
    if operator == ">=":
        return _compare("<=", y, x)
    apart = x[1] < y[0] or y[1] < x[0]
    same = x[0] == x[1] == y[0] == y[1]
    equal = False if apart else (True if same else None)
    return equal if operator == "==" or equal is None else not equal


def _parts(y: Range) -> list[Range]:
    """A range of whole numbers without 0."""
    parts = [(y[0], min(y[1], -1.0)), (max(y[0], 1.0), y[1])]
    return [part for part in parts if part[0] <= part[1]]


def _truncated(a: float, b: float) -> float:
    whole = abs(int(a)) // abs(int(b))
    return float(whole if (a < 0) == (b < 0) else -whole)


def whole_may_fail(operator: str, x: Range, y: Range) -> bool:
    """``binary_may_fail`` for whole numbers."""
    if operator in ("/", "mod", "div", "rem"):
        return y[0] <= 0.0 <= y[1]
    if operator in ("<<", ">>", "shr"):
        return y[0] < 0.0 or y[1] >= _WORD or (operator == "shr" and x[0] < 0.0)
    return operator not in ("band", "bor", "bxor") and binary_may_fail(operator, x, y)


def whole_binary(operator: str, x: Range, y: Range) -> Range | None:
    """The range of ``x operator y`` for whole numbers, which is whole; None where that is not known.

    Of remainders of negative numbers every rule counts: with the sign of either number, or never negative.
    """
    (a, b), (c, d) = x, y
    if operator in ("rem", "mod") and max(abs(c), abs(d)) < _EXACT and not max(abs(a), abs(b)) < _EXACT:
        most = max(abs(c), abs(d), 1.0) - 1.0
        return (0.0 if a >= 0.0 and c > 0.0 else -most), most
    if not max(abs(a), abs(b), abs(c), abs(d)) < _EXACT:
        return None
    match operator:
        case "+":
            found = a + c, b + d
        case "-":
            found = a - d, b - c
        case "*":
            corners = [u * v for u in x for v in y]
            found = min(corners), max(corners)
        case "div":
            corners = [_truncated(u, v) for part in _parts(y) for u in x for v in part]
            if a <= 0.0 <= b:
                corners.append(0.0)
            found = (min(corners), max(corners)) if _parts(y) else ANY
        case "rem" | "mod":
            most = max(abs(c), abs(d)) - 1.0
            if a >= 0.0 and c > 0.0:
                found = (a, b) if b < c else (0.0, min(b, most))
            else:
                found = -max(most, 0.0), max(most, 0.0)
        case "<<" if c >= 0.0 and d < _WORD:
            corners = [u * 2.0**v for u in x for v in y]
            found = min(corners), max(corners)
        case ">>" | "shr" if c >= 0.0 and d < _WORD and (a >= 0.0 or operator == ">>"):
            shifted = [float(int(u) >> int(v)) for u in x for v in y]
            found = min(shifted), max(shifted)
        case "band" if a >= 0.0 and c >= 0.0:
            found = 0.0, min(b, d)
        case "bor" | "bxor" if a >= 0.0 and c >= 0.0:
            full = float((1 << int(max(b, d)).bit_length()) - 1)
            found = (max(a, c) if operator == "bor" else 0.0), full
        case _:
            return None
    return found if max(abs(found[0]), abs(found[1])) < _EXACT else None


def gives_whole(operator: str, *, whole: bool) -> bool:
    """Whether a unary operator gives a whole number; whole: its operand is one."""
    if operator in ("not", "odd", "bool", "fix", "fup", "int", "round", "trunc", "nearest"):
        return True
    return whole and operator in ("neg", "pos", "abs", "bnot")


def binary(operator: str, x: Range, y: Range) -> Range:
    """The range of ``x operator y``."""
    if operator in _LOGIC:
        decided = _logic(operator, x, y) if operator in ("and", "or", "xor") else _compare(operator, x, y)
        return (0.0, 1.0) if decided is None else (float(decided), float(decided))
    if operator == "+":
        return widened(x[0] + y[0], x[1] + y[1])
    if operator == "-":
        return widened(x[0] - y[1], x[1] - y[0])
    if operator == "*":
        return _corners(x, y, lambda a, b: a * b)
    if operator == "/" and not y[0] <= 0.0 <= y[1]:
        values = [_quotient(a, b) for a in x for b in y]
        return ANY if any(math.isnan(v) for v in values) else widened(min(values), max(values))
    if operator == "mod" and math.isfinite(y[0]) and math.isfinite(y[1]) and not y[0] <= 0.0 <= y[1]:
        # Whichever sign the remainder has where one of the two is negative.
        most = max(abs(y[0]), abs(y[1]))
        return (0.0 if x[0] >= 0.0 and y[0] > 0.0 else -most), most
    if operator == "atan":
        return -180.0, 180.0
    return ANY


def unary(operator: str, x: Range) -> Range:
    """The range of ``operator x``."""
    low, high = x
    match operator:
        case "neg":
            return -high, -low
        case "pos":
            return x
        case "abs":
            return (0.0 if low <= 0 <= high else min(abs(low), abs(high))), max(abs(low), abs(high))
        case "sin" | "cos" | "rsin" | "rcos":
            return -1.0, 1.0
        case "not":
            truth = _truth(x)
            return (0.0, 1.0) if truth is None else (float(not truth), float(not truth))
        case "sqrt" if low >= 0:
            return widened(math.sqrt(low), math.sqrt(high))
        case "fix" | "fup" | "int" | "round" | "trunc" | "nearest" if math.isfinite(low) and math.isfinite(high):
            return float(math.floor(low)), float(math.ceil(high))
        case "atan":
            return -90.0, 90.0
        case "ratan" | "rasin":
            return widened(-math.pi / 2, math.pi / 2)
        case "racos":
            return widened(0.0, math.pi)
        case "sqr":
            least, most = sorted((low * low, high * high))
            return (0.0 if low <= 0 <= high else max(0.0, widened(least, least)[0])), widened(most, most)[1]
        case "frac":
            return (-1.0 if low < 0 else 0.0), (1.0 if high > 0 else 0.0)
        case "odd":
            return 0.0, 1.0
        case "bool":
            truth = _truth(x)
            return (0.0, 1.0) if truth is None else (float(truth), float(truth))
    return ANY
