"""Calls of subprograms and procedures: how often they run, and what they are given (McuWIN 4.16, 4.21, 12)."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from gproof.ir import codes
from gproof.ir.dialects.mcuwin.rules import DECLARED
from gproof.ir.finding import Refusal, Span
from gproof.ir.program import Call, Declare, Variable
from gproof.ir.symbolic import Unknown, Value

if TYPE_CHECKING:
    from gproof.passes.interpret.mcuwin.state import McuWinRun


def count_of(run: McuWinRun, node: Call) -> tuple[int, Value]:
    """How often a call runs its subprogram at least, and how often (4.16).

    Refusal for what is no positive whole number, or may be none.
    """
    if node.count is None:
        return 1, 1.0
    value = run.evaluator.value(node.count)
    if isinstance(value, Unknown):
        if value.whole and value.low >= 1.0 and value.high <= run.max_branches:
            return round(value.low), value
        raise Refusal(codes.UNKNOWN_CONDITION.at(node.span, cause=value.cause))
    if math.isinf(value) or value != round(value):
        raise Refusal(codes.NOT_AN_INTEGER.at(node.span, word="O", value=value))
    if value < 0:
        raise Refusal(codes.ILLEGAL_VALUE.at(node.span, word="O", what=f"{value:g} cycles of a subprogram"))
    if value == 0:
        raise Refusal(codes.UNSUPPORTED_CODE.at(node.span, code="O0 (the subprogram runs once, or not at all)"))
    return round(value), value


def bind(run: McuWinRun, node: Call) -> tuple[tuple[int, int], ...]:
    """Arguments into the variables of a procedure's parameters, and its own variables without a value.

    Gives what the procedure hands back: (parameter, variable of the caller), by their numbers.
    """
    sub = run.program.subprograms.get(node.name)
    if sub is None or sub.is_module:
        return ()
    if sub.parameters and node.name in run.flow.called:
        raise Refusal(codes.UNSUPPORTED_CODE.at(node.span, code=f"procedure {node.name}, which calls itself,"))
    parameters = run.modal.parameters
    given: list[tuple[int, Value | None, Span]] = []
    back = []
    for (_, type_, number), word in zip(sub.parameters, node.arguments, strict=True):
        if type_.startswith("var "):
            if not isinstance(word.value, Variable):
                raise Refusal(codes.BAD_EXPRESSION.at(word.span, what="a variable is needed here"))
            target = run.flow.widening.number_of(word.value)
            back.append((number, target))
            # One that holds nothing yet is what the procedure may be there to set.
            empty = target >= DECLARED and target not in parameters
            given.append((number, None if empty else run.evaluator.value(word.value), word.span))
        else:
            given.append((number, run.evaluator.value(word.value), word.span))
    for number, value, span in given:
        if value is None:
            parameters.pop(number, None)
        else:
            run.modal.write(float(number), value, span)
    for one in sub.body:
        if isinstance(one, Declare) and one.kind == "var":
            for number in range(one.number, one.number + len(one.names)):
                parameters.pop(number, None)
    return tuple(back)
