"""Numbers that a program, or a dialog, puts into variables. Eding CNC manual 3.1.1, 3.2.3, 4.2.

A variable whose own number is only bounded (``#[5400 + #5016]``, where the operator has typed #5016) may be any of
several: each holds what it held or what was put there. #5008 and #5011, the tool in the spindle and the new one, are
shown by the manual, and macros of newer versions write them (``accepts`` of the machine file).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from gproof.ir import codes
from gproof.ir.finding import Refusal, Span
from gproof.ir.symbolic import Unknown, Value, between, hull, is_whole

if TYPE_CHECKING:
    from gproof.passes.interpret.core.run import Run


def targets(run: Run, number: Value, value: Value, span: Span) -> list[tuple[float, Value]]:
    """The variables that a setting may write, each with what it holds then; Refusal GP232 where that is open."""
    if not isinstance(number, Unknown):
        return [(number, value)]
    open_number = Refusal(codes.UNKNOWN_CONDITION.at(span, cause=number.cause))
    found: list[tuple[float, Value]] = []
    for one in map(float, run.evaluator.numbers_between(number)):
        try:
            _, entry = run.modal.range_of(one, span)
            held = run.modal.read(one, span) if run.knows_number(one, span) else Unknown(f"#{one:g}")
        except Refusal:
            raise open_number from None
        if not entry.writable:
            raise open_number
        cause = f"{run.program.rules.name_of(round(one))}, which #[..] may have set"
        found.append((one, between(cause, hull(held, value), whole=is_whole(held) and is_whole(value))))
    if not found:
        raise open_number
    return found
