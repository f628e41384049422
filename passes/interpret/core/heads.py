"""Offsets of spindles and other heads, which the state of a run adds to positions. Eding CNC manual 2.1.19, 3.5.2."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gproof.ir.machine import AXIS_NAMES
from gproof.ir.symbolic import Position

if TYPE_CHECKING:
    from gproof.passes.interpret.core.modal_state import Modal

_NONE = Position(0.0)


def head_offset(s: Modal, head: int, axis: int) -> Position:
    """What is added to positions of an axis while that head is selected, mm; a symbol where it was not stated."""
    if head == 0 or axis >= 3:
        return _NONE
    changed = s.head_offsets.get((head, axis))
    if changed is not None:
        return changed
    measured = s.setup.heads.get((head, AXIS_NAMES[axis]))
    if measured is not None and measured.exact:
        return Position(measured.low)
    if measured is not None:
        return Position(0.0, ((f"head.{head}.{AXIS_NAMES[axis]}", 1),))
    there = s.machine.spindle(head)
    stated = None if there is None else there.offset[axis]
    if stated is not None and there is not None and (stated == 0.0 or not there.unsigned):
        return Position(stated)
    if stated is None and s.setup.default_offset is not None:
        return Position(s.setup.default_offset)
    return Position(0.0, ((f"head.{head}.{AXIS_NAMES[axis]}", 1),))
