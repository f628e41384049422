"""Numbers that a program, or a dialog, puts into variables. Eding CNC manual 3.1.1, 3.2.3, 4.2.

A variable whose own number is only bounded (``#[5400 + #5016]``, where the operator has typed #5016) may be any of
several: each holds what it held or what was put there. #5008 and #5011, the tool in the spindle and the new one, are
shown by the manual, and macros of newer versions write them (``accepts`` of the machine file).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from gproof.ir import codes
from gproof.ir.dialects.accepts import WRITTEN_TOOLS, Accepted
from gproof.ir.finding import Refusal, Span
from gproof.ir.symbolic import NOWHERE, Unknown, Value, between, hull, is_whole

if TYPE_CHECKING:
    from gproof.passes.interpret.core.path_exploration import Branches
    from gproof.passes.interpret.core.trace_writer import Emitter

TOOL, NEW_TOOL = 5008, 5011
"""The tool in the spindle and the new tool (3.1.1)."""


def targets(ex: Emitter, number: Value, value: Value, span: Span) -> list[tuple[float, Value]]:
    """The variables that a setting may write, each with what it holds then; Refusal GP232 where that is open."""
    if not isinstance(number, Unknown):
        return [(number, value)]
    open_number = Refusal(codes.UNKNOWN_CONDITION.at(span, cause=number.cause))
    found: list[tuple[float, Value]] = []
    for one in map(float, ex.evaluator.numbers_between(number)):
        try:
            _, entry = ex.modal.range_of(one, span)
            held = ex.modal.read(one, span) if ex.knows_number(one, span) else Unknown(f"#{one:g}")
        except Refusal:
            raise open_number from None
        if not entry.writable:
            raise open_number
        cause = f"whether {ex.program.rules.name_of(round(one))} was set by #[..]"
        found.append((one, between(cause, hull(held, value), whole=is_whole(held) and is_whole(value))))
    if not found:
        raise open_number
    return found


def write_setting(ex: Branches, number: Value, value: Value, span: Span) -> None:
    """Put a value where it belongs; Refusal where a program can not."""
    for one, new in targets(ex, number, value, span):
        if round(one) in (TOOL, NEW_TOOL) and ex.modal.range_of(one, span)[1].kind in ("tool", "new_tool"):
            write_tool(ex, round(one), new, span, WRITTEN_TOOLS)
        else:
            new = new if ex.knows_number(one, span) else Unknown(f"#{one:g}")
            ex.modal.write(one, new, span)
            ex._table_written(round(one), span)


def write_tool(ex: Branches, number: int, value: Value, span: Span, entry: Accepted) -> None:
    """#5008 or #5011 is to hold a value, which the manual does not have: UNKNOWN unless the shop knows its controller.

    GP113 otherwise, behind which it is not known which tool that is; nothing moves by it.
    """
    s = ex.modal
    tool: int | None = None
    if ex.takes(entry):
        if not isinstance(value, Unknown) and value == round(value) and 0 <= value <= ex.program.rules.highest_tool:
            tool = round(value)
    else:
        shown = "actual tool" if number == TOOL else "new tool during tool change"
        what = f"a setting of #{number} ({shown}), which the manual does not have,"
        ex._fail(codes.UNSUPPORTED_CODE.at(span, code=what, hint=entry.hint))
    if number == NEW_TOOL:
        s.selected_tool = tool
        return
    s.tool = tool
    if s.length_follows_tool:
        # Whether G43 goes over to the other tool at once no section says.
        s.tool_offset[0] = s.tool_offset[2] = NOWHERE
    ex._state_changed()
