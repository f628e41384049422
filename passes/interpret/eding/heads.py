"""Spindles and other heads, M90 to M97, and their offsets. Eding CNC manual 2.1.19, 2.1.20, 3.5.2, 3.5.6, table 3-6.

While a head is selected its offset is added to every programmed position, so that its tip, not that of the first
spindle, goes there. The functions take the state of a run (``Modal``) or the run itself (``Run``).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from gproof.ir import codes
from gproof.ir.machine import AXIS_NAMES
from gproof.ir.rules import CodeRule
from gproof.ir.rules import Function as F
from gproof.ir.symbolic import NOWHERE
from gproof.ir.trace import Op
from gproof.passes.interpret.core.heads import head_offset
from gproof.passes.interpret.core.parsed_line import Line
from gproof.passes.interpret.eding.ambiguous_words import owned

if TYPE_CHECKING:
    from gproof.passes.interpret.core.run import Run


def select(run: Run, line: Line) -> None:
    """M90 to M97: from here another head's tip is the controlled point. After step 7 of table 3-7, which lists none."""
    rule = line.find(F.HEAD)
    if rule is None:
        return
    owned(line, rule, "PQ")
    s = run.modal
    move, calibrate = line.number("P"), line.number("Q")
    before = [head_offset(s, s.head, axis) for axis in range(3)]
    if calibrate not in (None, 0.0):
        # The offset becomes that of the present place from the zero of the first spindle: a measurement.
        for axis in range(3):
            s.head_offsets[rule.value, axis] = NOWHERE
        what = f"Q{calibrate:g} measures the offset of the head, which is unknown from here on"
        run.fail(codes.HEAD_MOVE.at(line.where("Q"), code=rule.text, what=what))
    if s.head != rule.value and s.spindle_direction:
        run.findings.add(codes.HEAD_WHILE_TURNING.at(line.where_code(rule), code=rule.text))
        s.spun = s.spindle_direction, -1
        s.spindle_direction = 0
        s.stated.discard("spindle")
    changed = s.head != rule.value
    if changed and s.compensation is not None:
        what = f"{rule.text} while cutter radius compensation is on"
        run.fail(codes.UNSUPPORTED_CODE.at(line.where_code(rule), code=what))
    if "head" not in s.stated and 5390 not in s.setup.parameters:
        run.assumed["the job starts with the first spindle (M90)"] = None
    s.stated.add("head")
    s.head = rule.value
    after = [head_offset(s, s.head, axis) for axis in range(3)]
    if changed:
        _note_unsigned(run, line, rule)
    run.state_changed()
    run.event(Op.HEAD, line.span, arg=(float(rule.value), 0.0))
    if move not in (None, 0.0) and after != before:
        what = f"P{move:g} moves the head to where the other one was, on a path that is not in the manual"
        run.fail(codes.HEAD_MOVE.at(line.where("P"), code=rule.text, what=what))
        for axis in range(3):
            s.position[axis] = NOWHERE


def _note_unsigned(run: Run, line: Line, rule: CodeRule) -> None:
    n = rule.value
    there = run.machine.spindle(n)
    if there is None or not there.unsigned:
        return
    for axis, value in enumerate(there.offset):
        if value and (n, AXIS_NAMES[axis]) not in run.setup.heads:
            run.findings.add(
                codes.HEAD_OFFSET_OPEN.at(
                    line.where_code(rule), axis=AXIS_NAMES[axis].upper(), code=rule.text, value=value,
                    hint=f"state the offset of the head: [spindles.{n}] of the machine file or [heads.{n}] of the "
                         "setup file",
                )
            )  # fmt: skip
