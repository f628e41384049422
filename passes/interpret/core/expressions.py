"""Evaluation of expression trees; unknown in, unknown out.

Semantics: Eding CNC manual 3.2.2.3, 3.2.2.4 and 4.2. Angles are degrees; logic takes zero as false.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace

from gproof.ir import codes
from gproof.ir import intervals as ranges
from gproof.ir.dialects.accepts import USUAL_PRECEDENCE, Accepted
from gproof.ir.finding import Findings, Refusal, Span
from gproof.ir.program import Binary, Constant, Expr, Input, Named, Number, Text, Unary, Variable
from gproof.ir.symbolic import Unknown, Value, between, bounds, is_whole

_COMPARISONS = ("==", "<>", ">", ">=", "<", "<=")
_TRUTHS = frozenset((*_COMPARISONS, "and", "or", "xor"))
_LARGEST = 2.0**53
LEAST_WHOLE, MOST_WHOLE = -(2.0**31), 2.0**31 - 1.0
"""Whole numbers of 32 bits."""
_BITS = 32.0
_SHOWN = {
    "rasin": "arcsin", "racos": "arccos", "ratan": "arctan", "rsin": "sin", "rcos": "cos", "rtan": "tan",
    "nearest": "round", "rem": "mod", "band": "and", "bor": "or", "bxor": "xor", "bnot": "not",
}  # fmt: skip
"""How messages name operators that have the name of another one in a program."""


def _fail(span: Span, what: str) -> Refusal:
    return Refusal(codes.ARITHMETIC.at(span, what=what))


def _whole(value: float, span: Span, operator: str) -> int:
    if value != math.floor(value) or abs(value) > _LARGEST:
        raise _fail(span, f"{operator} needs whole numbers; {value!r} is not one")
    return int(value)


def _round(x: float) -> float:
    """To the nearest whole number, halves away from zero."""
    whole = math.floor(abs(x))
    return math.copysign(whole + (abs(x) - whole >= 0.5), x)


def _nearest(x: float) -> float:
    """To the nearest whole number; ValueError for a half, of which it is not known where it goes."""
    if x - math.floor(x) == 0.5:
        raise ValueError
    return _round(x)


def _integer(x: float) -> int:
    """A whole number; ValueError for any other."""
    if x != math.floor(x) or abs(x) > _LARGEST:
        raise ValueError
    return int(x)


def _div(x: float, y: float) -> float:
    """Whole numbers, the quotient towards zero."""
    a, b = _integer(x), _integer(y)
    return float(abs(a) // abs(b) * (1 if (a < 0) == (b < 0) else -1))


def _rem(x: float, y: float) -> float:
    """Whole numbers, the remainder with the sign of the first."""
    a, b = _integer(x), _integer(y)
    return float(abs(a) % abs(b) * (-1 if a < 0 else 1))


def open_rem(x: float, y: float) -> tuple[float, float] | None:
    """The remainders between which that of a negative number, or by one, is; None where all rules give the same.

    With the sign of the first, with that of the second, or never negative: Pascals differ.
    """
    return _either_rest(x, y, _rem(x, y))


def open_mod(x: float, y: float) -> tuple[float, float] | None:
    """The same of numbers that need not be whole: which sign a remainder has no manual of RS274 says."""
    return None if not y or math.isinf(x) else _either_rest(x, y, math.fmod(x, y))


def _either_rest(x: float, y: float, rest: float) -> tuple[float, float] | None:
    if (x >= 0 and y > 0) or rest == 0:
        return None
    other = rest - math.copysign(abs(y), rest)
    return min(rest, other), max(rest, other)


UNARY_FUNCTIONS: dict[str, Callable[[float], float]] = {
    "neg": lambda x: -x,
    "pos": lambda x: x,
    "abs": abs,
    "acos": lambda x: math.degrees(math.acos(x)),
    "asin": lambda x: math.degrees(math.asin(x)),
    "atan": lambda x: math.degrees(math.atan(x)),
    "cos": lambda x: math.cos(math.radians(x)),
    "exp": math.exp,
    "fix": lambda x: float(math.floor(x)),
    "fup": lambda x: float(math.ceil(x)),
    "int": lambda x: float(math.trunc(x)),
    "ln": math.log,
    "round": _nearest,
    "sin": lambda x: math.sin(math.radians(x)),
    "sqrt": math.sqrt,
    "tan": lambda x: math.tan(math.radians(x)),
    "not": lambda x: float(x == 0),
    "rsin": math.sin,
    "rcos": math.cos,
    "rtan": math.tan,
    "rasin": math.asin,
    "racos": math.acos,
    "ratan": math.atan,
    "sqr": lambda x: x * x,
    "frac": lambda x: math.fmod(x, 1.0),
    "bnot": lambda x: float(~_integer(x)),
    "odd": lambda x: float(_integer(x) % 2),
    "bool": lambda x: float(x != 0),
    "trunc": lambda x: float(math.trunc(x)),
    "nearest": _nearest,
}


def _mod(x: float, y: float) -> float:
    """The remainder with the sign of the divisor, never negative for a positive one."""
    result = math.fmod(x, y)
    return result + abs(y) if result < 0 else result


BINARY_FUNCTIONS: dict[str, Callable[[float, float], float]] = {
    "+": lambda x, y: x + y,
    "-": lambda x, y: x - y,
    "*": lambda x, y: x * y,
    "/": lambda x, y: x / y,
    "mod": _mod,
    "div": _div,
    "rem": _rem,
    "atan": lambda x, y: math.degrees(math.atan2(x, y)),
    "and": lambda x, y: float(x != 0 and y != 0),
    "or": lambda x, y: float(x != 0 or y != 0),
    "xor": lambda x, y: float((x != 0) != (y != 0)),
    ">": lambda x, y: float(x > y),
    ">=": lambda x, y: float(x >= y),
    "<": lambda x, y: float(x < y),
    "<=": lambda x, y: float(x <= y),
    "==": lambda x, y: float(x == y),
    "<>": lambda x, y: float(x != y),
}


NEARLY = 1e-4
"""Numbers that are no farther apart may count as equal: what 3.2.2.1 (Eding) allows whole numbers to be off."""
_EXACT_DIGITS = 15
MOST_NUMBERS = 200
"""Variables among which one whose number is not known may be, at most: the tool table has 99 of a kind."""


def inexact(x: float, y: float) -> bool:
    """Whether rounding, or what a controller takes as near enough, decides if two numbers are equal.

    Not of whole numbers, and not of one decimal number of up to 15 digits with itself.
    """
    if abs(x - y) > NEARLY or (x == math.floor(x) and y == math.floor(y)):
        return False
    return x != y or float(f"{x:.{_EXACT_DIGITS}g}") != x


def _nothing(node: Named | Input) -> Value:
    raise Refusal(codes.BAD_EXPRESSION.at(node.span, what="there is no value here"))


def _beside(operator: str, x: Value, y: Value, result: Value) -> Value:
    """A coordinate and a number of its units as the operands: the result has a place where the coordinate has one."""
    if operator not in ("+", "-") or not isinstance(result, Unknown):
        return result
    if isinstance(x, Unknown) and x.place is not None and not isinstance(y, Unknown):
        return replace(result, place=x.place.moved(y if operator == "+" else -y))
    if operator == "+" and isinstance(y, Unknown) and y.place is not None and not isinstance(x, Unknown):
        return replace(result, place=y.place.moved(x))
    return result


class Evaluator:
    """Evaluates trees.

    read: gives the live value of a numbered variable; read_other: of a named one, and of a channel. names: what
    numbered variables are called that have a name. takes: whether the controller does this beyond its manual. assume:
    notes an assumption.
    """

    def __init__(
        self, read: Callable[[float, Span], Value], findings: Findings,
        read_other: Callable[[Named | Input], Value] | None = None,
        takes: Callable[[Accepted], bool] = lambda what: False, assume: Callable[[str], None] = lambda text: None,
    ) -> None:  # fmt: skip
        self.takes = takes
        self.assume = assume
        self.read = read
        self.read_other = read_other or _nothing
        self.findings = findings
        self.names: dict[int, str] = {}
        self._told: set[tuple[int, Span]] = set()

    def value(self, expr: Expr) -> Value:
        """The value of a tree; Refusal with GP226 or GP228 where there is none."""
        if isinstance(expr, Number | Constant):
            return expr.value
        if isinstance(expr, Variable):
            number = self.value(expr.number)
            if isinstance(number, Unknown):
                return self._one_of(number, expr)
            if expr.name:
                self.names[round(number)] = expr.name
            return self.read(number, expr.span)
        if isinstance(expr, Unary):
            return self._unary(expr)
        if isinstance(expr, Binary):
            return self._binary(expr)
        if isinstance(expr, Named | Input):
            return self.read_other(expr)
        raise Refusal(codes.BAD_EXPRESSION.at(expr.span, what="text where a number is needed"))

    def _one_of(self, number: Unknown, expr: Variable) -> Value:
        """What a variable holds whose number is not known: between what each of those that it may be holds."""
        numbers = self.numbers_between(number)
        try:
            held = [self.read(float(one), expr.span) for one in numbers]
        except Refusal:
            held = []
        if not held:
            # Whichever variable that is: its value has nothing to do with the bounds of its number.
            self._doubt(expr.span, f"# of {number.cause}", number.cause)
            return Unknown(number.cause)
        ends = [bounds(one) for one in held]
        span = min(low for low, _ in ends), max(high for _, high in ends)
        return between(f"one of #{numbers[0]} to #{numbers[-1]}", span, whole=all(map(is_whole, held)))

    def numbers_between(self, number: Unknown) -> range:
        """The variables that a number which is only bounded may mean; none where they are too many to look at."""
        if not number.bounded or number.high - number.low > MOST_NUMBERS:
            return range(0)
        if not number.whole:
            self.assume(f"{number.cause}, the number of a variable, is a whole number")
        # Sums of bounds are rounded outwards; a number that is nearly whole counts as it (3.2.2.1).
        return range(math.ceil(number.low - NEARLY), math.floor(number.high + NEARLY) + 1)

    def _unary(self, expr: Unary) -> Value:
        x = self.value(expr.operand)
        if isinstance(x, Unknown):
            if x.whole and expr.operator == "bnot":
                return between(x.cause, self._of_32_bits(expr, (-x.high - 1.0, -x.low - 1.0), x.cause), whole=True)
            if ranges.unary_may_fail(expr.operator, bounds(x)) and not (x.whole and expr.operator == "odd"):
                self._doubt(expr.span, expr.operator, x.cause)
            found = ranges.unary(expr.operator, bounds(x))
            whole = ranges.gives_whole(expr.operator, whole=x.whole) and math.isfinite(found[1] - found[0])
            return between(x.cause, self._of_32_bits(expr, found, x.cause), whole=whole)
        if expr.operator in ("nearest", "round") and x - math.floor(x) == 0.5:
            cause = "how a half is rounded"
            return between(cause, self._of_32_bits(expr, (math.floor(x), math.ceil(x)), cause))
        try:
            return self._result(expr, UNARY_FUNCTIONS[expr.operator](x))
        except (ValueError, OverflowError):
            shown = _SHOWN.get(expr.operator, expr.operator)
            raise _fail(expr.span, f"{shown} of {x:g} has no result") from None

    def _binary(self, expr: Binary) -> Value:
        if expr.readings:
            return self._readings(expr)
        # A chain of operators of one group is a deep left spine: walked, not recursed.
        spine = [expr]
        while isinstance(spine[-1].left, Binary):
            spine.append(spine[-1].left)
        value = self.value(spine[-1].left)
        for node in reversed(spine):
            value = self._apply(node, value, self._right(node, value))
        return value

    def _readings(self, expr: Binary) -> Value:
        """The value of a chain that the manual lets group in several ways: between all of theirs, where they differ."""
        usual, *others = expr.readings
        if not others or self.takes(USUAL_PRECEDENCE):
            return self.value(usual)
        values: list[Value] = []
        failed: list[Refusal] = []
        for tree in expr.readings:
            try:
                values.append(self.value(tree))
            except Refusal as refusal:
                if refusal.finding.code != codes.ARITHMETIC:
                    raise
                failed.append(refusal)
        if not values:
            raise failed[0]
        names = " and ".join(sorted({_SHOWN.get(one, one) for one in _operators(expr)}))
        cause = f"the undocumented order of {names}"
        if failed:
            self._doubt(expr.span, names, cause)
        low, high = min(bounds(value)[0] for value in values), max(bounds(value)[1] for value in values)
        if low == high and not failed:
            return values[0]
        ends = f" (the value is from {low:g} to {high:g})" if math.isfinite(high - low) and not failed else ""
        self._tell(codes.PRECEDENCE.number, expr.span, lambda: codes.PRECEDENCE.at(
            expr.span, operators=names, hint=f"add brackets{ends}, or {USUAL_PRECEDENCE.hint}",
        ))  # fmt: skip
        return Unknown(cause, low, high)

    def _right(self, node: Binary, left: Value) -> Value:
        """What is on the right. Where the left side decides, a controller may pass it over: no error then."""
        if isinstance(left, Unknown) or node.operator != ("or" if left else "and"):
            return self.value(node.right)
        try:
            return self.value(node.right)
        except Refusal as refusal:
            if refusal.finding.code != codes.ARITHMETIC:
                raise
            self._doubt(node.right.span, f"the right side of {node.operator}", "it")
            return 0.0

    def _of_32_bits(self, expr: Unary | Binary, found: ranges.Range, cause: str) -> ranges.Range:
        """The range of a result; where its type has 32 bits and some of the values do not, those that have them."""
        low, high = found
        if not expr.whole or LEAST_WHOLE <= low <= high <= MOST_WHOLE or not math.isfinite(high - low):
            return found
        self._doubt(expr.span, _SHOWN.get(expr.operator, expr.operator), cause)
        return LEAST_WHOLE, MOST_WHOLE

    def _apply(self, expr: Binary, x: Value, y: Value) -> Value:
        if expr.doubtful:
            # Too many ways to group, or a sign that Pascal takes either way: nothing is known of the value.
            names = " and ".join(sorted({_SHOWN.get(one, one) for one in _operators(expr)}))
            self._tell(codes.PRECEDENCE.number, expr.span, lambda: codes.PRECEDENCE.at(
                expr.span, operators=names, hint="add brackets",
            ))  # fmt: skip
            return Unknown(f"the undocumented order of {names}")
        if isinstance(x, Unknown) or isinstance(y, Unknown):
            cause = x.cause if isinstance(x, Unknown) else y.cause if isinstance(y, Unknown) else ""
            whole = is_whole(x) and is_whole(y)
            may_fail = ranges.whole_may_fail if whole else ranges.binary_may_fail
            if may_fail(expr.operator, bounds(x), bounds(y)):
                self._doubt(expr.span, expr.operator, cause)
            exact = ranges.whole_binary(expr.operator, bounds(x), bounds(y)) if whole else None
            if exact is not None:
                return between(cause, self._of_32_bits(expr, exact, cause), whole=True)
            found = ranges.binary(expr.operator, bounds(x), bounds(y))
            result = between(cause, self._of_32_bits(expr, found, cause), whole=expr.operator in _TRUTHS)
            return _beside(expr.operator, x, y, result)
        if expr.operator in ("==", "<>") and inexact(x, y):
            self._tell(codes.INEXACT_COMPARISON.number, expr.span, lambda: codes.INEXACT_COMPARISON.at(
                expr.span, left=x, right=y, operator=expr.operator,
                hint="compare with a range instead",
            ))  # fmt: skip
            return Unknown(f"whether {x!r} equals {y!r}", 0.0, 1.0)
        if expr.operator == "shr" and x < 0:
            return Unknown("the result of shr for a negative number")
        if expr.whole and expr.operator in ("<<", "shr") and y >= _BITS:
            return Unknown(f"a shift by {y:g} bits")
        result = self._result(expr, self._compute(expr, x, y))
        either = open_rem(x, y) if expr.operator == "rem" else open_mod(x, y) if expr.operator == "mod" else None
        return result if either is None else Unknown("mod with a negative number", *either)

    def _result(self, expr: Unary | Binary, x: float) -> float:
        x = self._finite(x, expr.span)
        if expr.whole and not LEAST_WHOLE <= x <= MOST_WHOLE:
            raise _fail(expr.span, f"{x:.15g}, which is not a whole number of 32 bits")
        return x

    def _compute(self, expr: Binary, x: float, y: float) -> float:
        operator = expr.operator
        if operator in ("band", "bor", "bxor", "<<", ">>", "shr"):
            return self._bits(expr, x, y)
        if operator in ("/", "mod", "div", "rem") and y == 0:
            raise _fail(expr.span, f"division of {x:g} by zero")
        try:
            if operator == "**":
                return math.pow(x, y)
            return BINARY_FUNCTIONS[operator](x, y)
        except (ValueError, OverflowError, ZeroDivisionError):
            raise _fail(expr.span, f"{x:g} {_SHOWN.get(operator, operator)} {y:g} has no result") from None

    def _bits(self, expr: Binary, x: float, y: float) -> float:
        a, b = _whole(x, expr.span, expr.operator), _whole(y, expr.span, expr.operator)
        if expr.operator in ("<<", ">>", "shr"):
            if not 0 <= b < 64:
                raise _fail(expr.span, f"shift by {b}")
            return float(a << b if expr.operator == "<<" else a >> b)
        return float({"band": a & b, "bor": a | b, "bxor": a ^ b}[expr.operator])

    def _doubt(self, span: Span, operator: str, cause: str) -> None:
        """The controller may stop here: for some of the possible values there is no result."""
        self._tell(codes.DOUBTFUL_ARITHMETIC.number, span, lambda: codes.DOUBTFUL_ARITHMETIC.at(
            span, operator=operator, cause=cause, hint="state its limits in the setup file, or test them before"
        ))  # fmt: skip

    def _finite(self, x: float, span: Span) -> float:
        if not math.isfinite(x):
            raise _fail(span, "the value is too large")
        return x

    def _tell(self, number: int, span: Span, make: Callable[[], object]) -> None:
        """A warning once for each place, however often a loop comes by."""
        if (number, span) not in self._told:
            self._told.add((number, span))
            self.findings.add(make())  # type: ignore[arg-type]


def _operators(expr: Binary) -> Iterator[str]:
    yield expr.operator
    for side in (expr.left, expr.right):
        if isinstance(side, Binary):
            yield side.operator


def describe_parts(parts: tuple[Expr, ...], evaluator: Evaluator) -> str:
    """The text of a message: strings as they are, numbers with up to six digits, unknown ones as ``?``."""
    out = []
    for part in parts:
        if isinstance(part, Text):
            out.append(part.value)
            continue
        value = evaluator.value(part)
        out.append("?" if isinstance(value, Unknown) else f"{value:g}")
    return "".join(out)
