"""Lines of many words in the kernel of straight-line code: what it is given of a run's state, and what it leaves."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from gproof.ir.machine import AXES
from gproof.ir.symbolic import Position
from gproof.passes.interpret.core import line_kernels as k
from gproof.passes.interpret.core.line_decoder_kernels import SLOTS, LineState, WordColumns, letter_slots, trace_rows
from gproof.passes.interpret.core.moves import CLAMPED
from gproof.passes.interpret.core.plane_transform import noted

if TYPE_CHECKING:
    from gproof.passes.interpret.core.run import Run

_LETTERS = letter_slots({letter: axis for axis, letter in enumerate("XYZABC")}, "IJKRFGP")
_LETTER_TABLE = np.array(_LETTERS, dtype=np.int64)
"""What words are to ``run_lines``: for plain Python, and compiled."""


def run_kernel(run: Run, kernel: Any, columns: WordColumns, state: LineState, count: int, at: int) -> int:
    """Run ``run_lines`` on the words from ``at`` to ``count``; returns the first word it left over."""
    rows = run.rows
    before = rows.count
    at, rows.count = run_words(kernel, columns, count, at, state, rows.arrays, before, rows.capacity)
    run.blocks += rows.count - before
    if run.modal.feed_unknown:
        rows.forget_feeds(before)
    return at


def packed(run: Run, position: list[float], compiled: bool, *, distances: bool = False) -> LineState:
    """The state of ``run_lines``: integers, floats, frames of the axes and of their offsets."""
    s = run.modal
    offsets = [s.offset(axis) for axis in range(AXES)]
    ints: object = [
        s.motion, int(s.plane), int(s.absolute), run.frame_number(), run.state_number(), run.file, run.call,
        s.feed_mode, 1, int(run.machine.controller.absolute_arc_centers), active_axes(run), s.transform.kind,
        k.HERE if distances else k.NOT_HERE,
    ]  # fmt: skip
    floats: object = [
        s.unit, s.feed, *position, *(o.value for o in offsets), s.scale(0), *s.transform.numbers,
    ]  # fmt: skip
    form: object = [run.frames.form(p.form) for p in s.position]
    offset_form: object = [run.frames.form(o.form) for o in offsets]
    values: object = [0.0] * SLOTS
    if compiled:
        values = np.zeros(SLOTS)
        ints, floats = np.array(ints, dtype=np.int64), np.array(floats, dtype=np.float64)
        form, offset_form = np.array(form, dtype=np.int64), np.array(offset_form, dtype=np.int64)
    return LineState(ints, floats, form, offset_form, values)


def unpack(run: Run, state: LineState) -> None:
    """Take over what ``run_lines`` has made of the state."""
    ints, floats, *_ = state
    s = run.modal
    if int(ints[k.MOTION]) != s.motion:
        s.motion, s.cycle, s.cycle_code = int(ints[k.MOTION]), {}, 0
    s.feed = float(floats[k.FEED])
    if int(ints[k.DISTANCES]) == k.MET:
        s.absolute = bool(ints[k.ABSOLUTE])
        s.stated.add("distance")
    for axis in range(AXES):
        s.position[axis] = Position(float(floats[k.POSITION + axis]), s.position[axis].form)


def active_axes(run: Run) -> int:
    """Bits of the columns whose words the kernel may follow."""
    held = CLAMPED if run.modal.clamped else -1
    # Words of these take the other way under G51 P: Z, unless it is as it is written and that has been said.
    apart = run.modal.transform.loose if noted(run) else (2, *run.modal.transform.loose)
    return sum(1 << axis for axis in range(AXES) if run.modal.has_axis(axis) and axis != held and axis not in apart)


def run_words(
    kernel: Any, words: WordColumns, count: int, at: int, state: LineState, rows: Mapping[str, Any], first: int,
    capacity: int,
) -> tuple[int, int]:  # fmt: skip
    """``run_lines`` into ``rows``; (next word, next row)."""
    slots = _LETTERS if isinstance(state.ints, list) else _LETTER_TABLE
    at, row = kernel(words, count, at, slots, state, trace_rows(rows), first, capacity)
    return int(at), int(row)
