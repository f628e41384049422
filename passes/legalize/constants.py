"""Values of expressions whose variables are known, by the interpreter's own evaluator: both agree bit for bit."""

from __future__ import annotations

from collections.abc import Mapping

from gproof.ir.finding import Findings, Refusal, Span
from gproof.ir.program import Expr, Number
from gproof.ir.symbolic import Unknown, Value
from gproof.passes.interpret.core.expressions import Evaluator

Values = Mapping[int, float]
"""Known variables by number."""


def constant(expr: Expr, values: Values) -> float | None:
    """The value; None where it rests on what is not known, or the manual leaves open what it is."""
    if isinstance(expr, Number):
        return expr.value

    def read(number: float, span: Span) -> Value:
        whole = round(number)
        if abs(number - whole) > 1e-9 or whole not in values:
            return Unknown(f"#{number:g}")
        return values[whole]

    findings = Findings()
    try:
        found = Evaluator(read, findings).value(expr)
    except Refusal:
        return None
    return None if isinstance(found, Unknown) or findings.kept else found


def number(value: float, span: Span) -> Number:
    """A literal."""
    return Number(value, span)
