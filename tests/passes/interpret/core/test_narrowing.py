"""Guards by brute force: what a condition says of its variables holds for each of their values that satisfies it."""

from __future__ import annotations

import itertools
import math
import random
from collections.abc import Callable

import pytest
from support.campaigns import seeds

from gproof.ir.finding import Span
from gproof.ir.program import Binary, Expr, Number, Unary, Variable
from gproof.ir.symbolic import Unknown, Value, bounds
from gproof.passes.interpret.core.narrowing import Narrowing

HERE = Span("job", 1)
LOW, HIGH = -9, 9
Numbers = dict[int, float]
Read = Callable[[Numbers], float]


def cut(a: float, b: float) -> float:
    """A quotient without its fraction."""
    return float(math.trunc(a / b))


TWO: dict[str, tuple[Callable[[float, float], float], ...]] = {
    "+": (lambda a, b: a + b,), "-": (lambda a, b: a - b,), "*": (lambda a, b: a * b,), "/": (lambda a, b: a / b,),
    "div": (cut,), "<<": (lambda a, b: float(int(a) << int(b)),), ">>": (lambda a, b: float(int(a) >> int(b)),),
    "shr": (lambda a, b: float(int(a) >> int(b)) if a >= 0 else math.nan,),
}  # fmt: skip
ONE: dict[str, tuple[Callable[[float], float], ...]] = {
    "neg": (lambda a: -a,), "pos": (lambda a: a,), "abs": (abs,), "sqr": (lambda a: a * a,),
    "sqrt": (lambda a: math.sqrt(a) if a >= 0 else math.nan,), "fix": (lambda a: float(math.floor(a)),),
    "fup": (lambda a: float(math.ceil(a)),), "int": (lambda a: float(math.trunc(a)), lambda a: float(math.floor(a))),
    "round": (lambda a: float(math.floor(a + 0.5)), lambda a: float(math.ceil(a - 0.5)), lambda a: float(round(a))),
}  # fmt: skip
COMPARED: dict[str, Callable[[float, float], bool]] = {
    "<": lambda a, b: a < b, "<=": lambda a, b: a <= b, ">": lambda a, b: a > b, ">=": lambda a, b: a >= b,
    "==": lambda a, b: a == b, "<>": lambda a, b: a != b,
}  # fmt: skip


def number(value: float) -> Number:
    return Number(float(value), HERE)


def variable(which: int) -> Variable:
    return Variable(number(which), HERE)


def made(rng: random.Random, depth: int, whole: bool) -> tuple[Expr, list[Read]]:
    """An expression of #1 and #2, and what it may be for numbers of them."""
    if depth == 0 or rng.random() < 0.25:
        which = rng.choice((1, 1, 2))
        return variable(which), [lambda at: at[which]]
    if rng.random() < 0.3:
        operator = rng.choice(["neg", "pos", "abs"] if whole else list(ONE))
        inner, reads = made(rng, depth - 1, whole)
        return Unary(operator, inner, HERE), [
            lambda at, f=f, r=r: math.nan if math.isnan(v := r(at)) else f(v) for f in ONE[operator] for r in reads
        ]
    operator = rng.choice(["+", "-", "*", "div", "<<", ">>", "shr"] if whole else ["+", "-", "*", "/"])
    inner, reads = made(rng, depth - 1, whole)
    shifts = operator in ("<<", ">>", "shr")
    value = rng.randrange(0, 5) if shifts else rng.choice([-7, -3, -2, -1, 1, 2, 3, 5] + ([] if whole else [0.3, -2.5]))
    swapped = operator in ("+", "-", "*") and rng.random() < 0.4
    left, right = (number(value), inner) if swapped else (inner, number(value))

    def read(f: Callable[[float, float], float], r: Read) -> Read:
        def at(numbers: Numbers) -> float:
            v = r(numbers)
            return math.nan if math.isnan(v) else f(value, v) if swapped else f(v, value)

        return at

    node = Binary(operator, left, right, HERE, whole=whole)
    return node, [read(f, r) for f in TWO[operator] for r in reads]


def condition(rng: random.Random, whole: bool, depth: int = 2) -> tuple[Expr, list[Callable[[Numbers], bool | None]]]:
    """A condition and its readings: true, false, or None where it has no value."""
    if depth and rng.random() < 0.4:
        operator = rng.choice(["and", "or", "not"])
        one, reads = condition(rng, whole, depth - 1)
        if operator == "not":
            return Unary("not", one, HERE), [lambda at, r=r: None if (v := r(at)) is None else not v for r in reads]
        two, others = condition(rng, whole, depth - 1)

        def both(r: Callable[[Numbers], bool | None], s: Callable[[Numbers], bool | None]):
            def at(numbers: Numbers) -> bool | None:
                a, b = r(numbers), s(numbers)
                return None if a is None or b is None else (a and b) if operator == "and" else (a or b)

            return at

        return Binary(operator, one, two, HERE), [both(r, s) for r, s in itertools.product(reads, others)]
    node, reads = made(rng, 3, whole)
    operator, limit = rng.choice(list(COMPARED)), rng.choice([-20, -6, -3, -1, 0, 1, 2, 4, 9, 30])
    compared = COMPARED[operator]
    return Binary(operator, node, number(limit), HERE), [
        lambda at, r=r: None if math.isnan(v := r(at)) else compared(v, limit) for r in reads
    ]


def narrowed(node: Expr, truth: bool, whole: bool) -> tuple[bool, dict[int, Value]]:
    """Whether anything fits, and the bounds."""
    held = {n: Unknown(f"#{n}", float(LOW), float(HIGH), whole) for n in (1, 2)}
    says = Narrowing(lambda n, _: held[round(n)], lambda _: True)
    found = says._of(node, truth, {}, 0)
    return found is not None, found or {}


@pytest.mark.parametrize("whole", [True, False], ids=["whole", "real"])
@pytest.mark.parametrize("seed", seeds(4, 400))
def test_each_number_that_satisfies_a_guard_is_in_what_it_says(seed: int, whole: bool) -> None:
    rng = random.Random(seed)
    steps = [float(n) for n in range(LOW, HIGH + 1)] if whole else [LOW + n * 0.375 for n in range(49)]
    for _ in range(30):
        node, reads = condition(rng, whole)
        for truth in (True, False):
            fits, found = narrowed(node, truth, whole)
            for one, two in itertools.product(steps, steps):
                at = {1: one, 2: two}
                if all(read(at) is not truth for read in reads):
                    continue
                assert fits, (seed, node, truth, at)
                for which, value in found.items():
                    low, high = bounds(value)
                    assert low <= at[which] <= high, (seed, node, truth, at, (low, high))


X = variable(1)


@pytest.mark.parametrize(
    ("node", "whole", "expected"),
    [
        (Binary("<", Binary("div", X, number(3), HERE, whole=True), number(2), HERE), True, (LOW, 5)),
        (Binary(">=", Binary("div", X, number(2), HERE, whole=True), number(2), HERE), True, (4, HIGH)),
        (Binary("==", Binary("div", X, number(4), HERE, whole=True), number(1), HERE), True, (4, 7)),
        (Binary("<", Binary("div", X, number(-2), HERE, whole=True), number(-2), HERE), True, (6, HIGH)),
        (Binary("<=", Binary("<<", X, number(2), HERE, whole=True), number(15), HERE), True, (LOW, 3)),
        (Binary(">", Binary(">>", X, number(1), HERE, whole=True), number(2), HERE), True, (6, HIGH)),
        (Binary(">", Binary("*", X, number(3), HERE, whole=True), number(10), HERE), True, (4, HIGH)),
        (Binary("<", Binary("+", X, number(3), HERE, whole=True), number(5), HERE), True, (LOW, 1)),
        (Binary("<", Binary("-", number(3), X, HERE, whole=True), number(0), HERE), True, (4, HIGH)),
        (Binary("<", Binary("*", X, number(2), HERE), number(8), HERE), False, (LOW, 4)),
        (Binary(">", Binary("/", X, number(-2), HERE), number(2), HERE), False, (LOW, -4)),
        (Binary("<=", Unary("abs", X, HERE), number(3), HERE), False, (-3, 3)),
        (Binary("<=", Unary("sqrt", X, HERE), number(2), HERE), False, (0, 4)),
        (Binary(">", Unary("fix", X, HERE), number(3), HERE), False, (3, HIGH)),
    ],
)  # fmt: skip
def test_what_operators_say(node: Expr, whole: bool, expected: tuple[float, float]) -> None:
    """Bounds by hand; rounding may leave a hair around them."""
    fits, found = narrowed(node, True, whole)
    assert fits
    low, high = bounds(found[1])
    assert (low, high) == pytest.approx(expected, abs=0.0 if whole else 1e-9)
