"""Numbers that a program or a dialog puts into variables of the controller. Eding CNC manual 3.1.1, 3.2.3, 4.2.

#5008 and #5011, the tool in the spindle and the new one, are shown by the manual, and macros of newer versions write
them (``accepts`` of the machine file).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from gproof.ir import codes
from gproof.ir.dialects.accepts import WRITTEN_TOOLS, Accepted
from gproof.ir.finding import Span
from gproof.ir.symbolic import NOWHERE, Unknown, Value
from gproof.passes.interpret.core.assigned_numbers import targets
from gproof.passes.interpret.eding.work_offsets import table_written

if TYPE_CHECKING:
    from gproof.passes.interpret.core.run import Run

TOOL, NEW_TOOL = 5008, 5011
"""The tool in the spindle and the new tool (3.1.1)."""


def write_setting(run: Run, number: Value, value: Value, span: Span) -> None:
    """Put a value where it belongs; Refusal where a program cannot."""
    for one, new in targets(run, number, value, span):
        if round(one) in (TOOL, NEW_TOOL) and run.modal.range_of(one, span)[1].kind in ("tool", "new_tool"):
            write_tool(run, round(one), new, span, WRITTEN_TOOLS)
        else:
            new = new if run.knows_number(one, span) else Unknown(f"#{one:g}")
            run.modal.write(one, new, span)
            table_written(run, round(one), span)


def write_tool(run: Run, number: int, value: Value, span: Span, entry: Accepted) -> None:
    """#5008 or #5011 is to hold a value, which the manual does not have: UNKNOWN unless the shop knows its controller.

    GP113 otherwise, after which it is not known which tool that is; nothing moves by it.
    """
    s = run.modal
    tool: int | None = None
    if run.takes(entry):
        if not isinstance(value, Unknown) and value == round(value) and 0 <= value <= run.program.rules.highest_tool:
            tool = round(value)
    else:
        shown = "actual tool" if number == TOOL else "new tool during tool change"
        what = f"a setting of #{number} ({shown}), which is not in the manual,"
        run.fail(codes.UNSUPPORTED_CODE.at(span, code=what, hint=entry.hint))
    if number == NEW_TOOL:
        s.selected_tool = tool
        return
    s.tool = tool
    if s.length_follows_tool:
        # Whether G43 goes over to the other tool at once no section says.
        s.tool_offset[0] = s.tool_offset[2] = NOWHERE
    run.state_changed()
