"""Operators of rw_SymPas: values by hand, and ranges that hold every value of numbers within them."""

from __future__ import annotations

import math
import random

import pytest
from passes.interpret.mcuwin.mcuwin_programs import labels, moves, run

from gproof.ir import intervals as ranges
from gproof.ir.dialects.mcuwin.rules import MCUWIN
from gproof.ir.finding import Findings, Refusal, Span
from gproof.ir.program import Binary, Constant, Expr, Number, Unary, Variable
from gproof.ir.rules import BINARY, UNARY
from gproof.ir.setup import Interval, Setup
from gproof.ir.symbolic import Unknown
from gproof.passes.interpret.core.block_compiler import Slow, compile_condition
from gproof.passes.interpret.core.expressions import BINARY_FUNCTIONS, UNARY_FUNCTIONS, Evaluator

HERE = Span("job.src", 1)


def value(expr: Expr) -> object:
    return Evaluator(lambda number, span: 0.0, Findings()).value(expr)


def one(operator: str, x: float) -> object:
    return value(Unary(operator, Number(x, HERE), HERE))


def two(x: float, operator: str, y: float) -> object:
    return value(Binary(operator, Number(x, HERE), Number(y, HERE), HERE))


@pytest.mark.parametrize(
    ("operator", "x", "result"),
    [("rsin", math.pi / 6, 0.5), ("rcos", math.pi / 3, 0.5), ("rtan", math.pi / 4, 1.0), ("rasin", 1.0, math.pi / 2),
     ("racos", 0.0, math.pi / 2), ("ratan", -1.0, -math.pi / 4), ("sqr", -3.0, 9.0), ("frac", 2.75, 0.75),
     ("frac", -2.75, -0.75), ("int", -2.75, -2.0), ("bnot", 5.0, -6.0), ("bnot", -1.0, 0.0), ("odd", 7.0, 1.0),
     ("odd", -4.0, 0.0), ("odd", -3.0, 1.0), ("bool", 0.0, 0.0), ("bool", -0.5, 1.0)],
)  # fmt: skip
def test_functions(operator: str, x: float, result: float) -> None:
    found = one(operator, x)
    assert isinstance(found, float)
    assert math.isclose(found, result, abs_tol=1e-15)


@pytest.mark.parametrize(("x", "y", "div", "rem"), [(7, 2, 3, 1), (-7, 2, -3, -1), (7, -2, -3, 1), (-7, -2, 3, -1),
                                                    (6, 3, 2, 0)])  # fmt: skip
def test_division_of_whole_numbers_is_towards_zero(x: float, y: float, div: float, rem: float) -> None:
    assert two(x, "div", y) == div
    rest = two(x, "rem", y)
    if x < 0 or y < 0:  # Pascals differ in its sign: both are followed.
        assert isinstance(rest, Unknown)
        assert (rest.low, rest.high) == (-abs(rem), abs(y) - abs(rem))
    else:
        assert rest == rem


NO_VALUE = [
    lambda: two(1, "div", 0), lambda: two(1, "rem", 0), lambda: two(1.5, "div", 1), lambda: one("odd", 1.5),
    lambda: one("bnot", 0.5), lambda: one("rasin", 2),
]  # fmt: skip


@pytest.mark.parametrize("make", NO_VALUE)
def test_what_has_no_value_is_an_error(make: object) -> None:
    with pytest.raises(Refusal):
        make()  # type: ignore[operator]


def test_constants_are_numbers_everywhere() -> None:
    half = Constant("half", 0.5, HERE)
    assert value(Binary("+", half, Number(1, HERE), HERE)) == 1.5

    made = compile_condition(Binary("*", half, Variable(Number(2000.0, HERE), HERE, "step"), HERE), MCUWIN)
    assert made is not None
    assert made[0]({2000: 3.0}) == 1.5


def test_compiled_functions_give_the_same() -> None:

    rand = random.Random(1)
    v, w = (Variable(Number(float(n), HERE), HERE) for n in (600, 601))
    for _ in range(400):
        x, y = (rand.choice([rand.uniform(-9, 9), float(rand.randint(-9, 9))]) for _ in "xy")
        binary = rand.random() < 0.5
        expr: Expr = Binary(rand.choice(["div", "rem"]), v, w, HERE)
        if not binary:
            expr = Unary(rand.choice(UNARY[17:]), v, HERE)
        made = compile_condition(expr, MCUWIN)
        assert made is not None
        known = {600: x, 601: y}
        evaluator = Evaluator(lambda number, span, known=known: known[round(number)], Findings())
        try:
            wanted = evaluator.value(expr)
        except Refusal:
            with pytest.raises((ValueError, ZeroDivisionError, OverflowError, TypeError, KeyError)):
                made[0](known)
            continue
        if isinstance(wanted, Unknown):
            with pytest.raises((ValueError, Slow)):
                made[0](known)
            continue
        assert made[0](known) == wanted


def test_ranges_hold_every_value() -> None:
    rand = random.Random(2)
    for _ in range(4000):
        ends = sorted(rand.choice([rand.uniform(-4, 4), 0.0, 1.0, -1.0, rand.uniform(-1, 1)]) for _ in "lh")
        operator = rand.choice(UNARY)
        low, high = ranges.unary(operator, (ends[0], ends[1]))
        for x in (*ends, rand.uniform(*ends)):
            try:
                found = UNARY_FUNCTIONS[operator](x)
            except (ValueError, OverflowError):
                assert ranges.unary_may_fail(operator, (ends[0], ends[1])), (operator, x)
                continue
            assert low <= found <= high, (operator, x, ends)


def test_ranges_of_two_hold_every_value() -> None:
    rand = random.Random(3)
    for _ in range(4000):
        operator = rand.choice([o for o in BINARY if o in BINARY_FUNCTIONS])
        one_range, other = (tuple(sorted(float(rand.randint(-5, 5)) for _ in "lh")) for _ in "xy")
        low, high = ranges.binary(operator, one_range, other)  # type: ignore[arg-type]
        x, y = rand.randint(*map(int, one_range)), rand.randint(*map(int, other))
        try:
            found = BINARY_FUNCTIONS[operator](x, y)
        except (ValueError, OverflowError, ZeroDivisionError):
            assert ranges.binary_may_fail(operator, one_range, other), (operator, x, y)  # type: ignore[arg-type]
            continue
        assert low <= found <= high, (operator, x, y)


def test_variables_are_named_as_programs_name_them() -> None:
    trace, findings = run(["G00 X(CI650)", "G00 X(CD651)", "G00 X(V3)", "G00 X(CD7)"], setup=Setup())
    texts = [f.message for f in findings.kept if f.code.label == "GP234"]
    assert texts == [f"{name} is read before it is set" for name in ("CI650", "CD651", "V3")]
    assert "GP225" in labels(findings)
    assert moves(trace)


def test_a_stated_range_is_no_unset_variable() -> None:
    """CD600 between 20 and 40, CI601 (1601 of a setup) 1 or 2: nothing is unset, and a feed needs one number."""
    setup = Setup(parameter_ranges={600: Interval(20.0, 40.0), 1601: Interval(1.0, 2.0)})
    _, findings = run(["CD605 := CD600 * CI601", "G00 X(CD605) Y(CD600)"], setup=setup)
    assert not {"GP225", "GP234"} & set(labels(findings))
    _, findings = run(["G01 X0 F(CD600)"], setup=setup)
    assert not [f.message for f in findings.kept if "nobody stated" in f.message or f.code.label == "GP234"]


def test_whole_number_variables_have_32_bits() -> None:
    assert labels(run(["CI601 := 2147483647 + 1"])[1]) == ["GP228"]
    assert labels(run(["CI601 := 1 / 2"])[1]) == ["GP228"]
    assert labels(run(["CD601 := 2147483647 + 1"])[1]) == []


def test_resident_variables() -> None:
    trace, findings = run(["CI600 := 7", "M901 600", "CI600 := 1", "M902 600", "G00 X(CI600)"])
    assert moves(trace) == [("TRAVERSE", 7, 0, 0)]
    assert labels(findings) == []
    assert "GP225" in labels(run(["M904 601", "G00 X(CD601)"])[1])
    assert labels(run(["M902 599"])[1]) == ["GP128"]


def test_offsets_read_and_written_back() -> None:
    trace, findings = run(["G54", "G153", "G53", "CD50 := CD50 + 5", "G154", "G90 G00 X0 Y0 Z0"])
    assert moves(trace) == [("TRAVERSE", 15, 20, 30)]
    assert labels(findings) == []
    unknown, _ = run(["G153", "G91 G92 X5", "G154", "G90 G00 X0"], setup=Setup())
    rows = unknown.sections[-1].rows
    last = max(n for n in range(len(rows)) if rows["op"][n] == 1)
    assert unknown.frames[int(rows["frame"][last])][0] == (("g92.x", 1),)
