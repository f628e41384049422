"""Plain lines of many commands: when the kernel of straight-line code may run them, compensated or not.

Eding CNC manual 3.4.11 for the path next to the contour.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from gproof.ir.machine import AXES
from gproof.ir.modal_groups import OF_FEEDS
from gproof.ir.symbolic import Position
from gproof.ir.trace import TRACE_ROW
from gproof.passes.interpret.core import cutter_compensation_kernels as c
from gproof.passes.interpret.core import line_kernels as k
from gproof.passes.interpret.core.line_decoder_kernels import LineState, WordColumns, trace_rows
from gproof.passes.interpret.core.line_runs import packed, run_kernel, run_words, unpack
from gproof.passes.interpret.eding import compensation_codes as compensated

if TYPE_CHECKING:
    from gproof.passes.interpret.core.run import Run

_FIRST_BATCH, _BATCH = 4, 1 << 13
"""Programmed rows that are made at once while the path is compensated: few first, as the tool may not follow them."""


def run_hot(
    run: Run, kernel: Any, columns: WordColumns, count: int, at: int, compiled: bool, *, distances: bool = False
) -> int:  # fmt: skip
    """Run lines of many commands in the kernel from word ``at``; returns the first word it left over.

    distances: G90 and G91 too, which make no row that would count their blocks, and G4.
    """
    s = run.modal
    if not run.moved or s.feed_unit != s.unit or not 1 <= s.motion <= 4 or s.feed_mode != 94:
        # The first motion notes what it assumes; a motion mode must be set: Python path.
        return at
    if s.compensation is not None:
        return _along_contour(run, kernel, columns, count, at, compiled)
    if not s.plain_motion:
        return at
    state = packed(run, [p.value for p in s.position], compiled, distances=distances)
    if not s.arcs_known:
        state.ints[k.ARC_ABSOLUTE] = 1  # which leaves arcs to Python
    at = run_kernel(run, kernel, columns, state, count, at)
    unpack(run, state)
    if s.unknown_modes & OF_FEEDS:
        s.feed = math.nan
    return at


def _along_contour(run: Run, kernel: Any, columns: WordColumns, count: int, at: int, compiled: bool) -> int:
    """``_hot`` while the path is compensated: rows as programmed, and from them those of the tool."""
    s, rows = run.modal, run.rows
    comp = s.compensation
    if comp is None or not s.plain_contour or not compensated.is_plain(s):
        return at
    a, b = comp.axes
    goal = comp.programmed
    assert goal is not None and comp.radius is not None
    begin = [p.value for p in s.position]
    begin[a], begin[b] = goal[0].value, goal[1].value
    state = packed(run, begin, compiled)
    ints: Any = [
        a,
        b,
        comp.side,
        int(comp.plane),
        run.frame_number(),
        run.state_number(),
        run.file,
        run.call,
    ]
    floats: Any = [
        *(p.value for p in s.position), goal[0].value, goal[1].value, *comp.shift, comp.radius, s.arc_tolerance(),
    ]  # fmt: skip
    batch, going = _FIRST_BATCH, True
    while going:
        there = TRACE_ROW.empty(batch)
        before = _copied(state)
        stop, made = run_words(kernel, columns, count, at, state, there, 0, batch)
        offset = c.offset_rows.pick(made)
        if offset is not c.offset_rows.python:
            ints, floats = np.array(ints, dtype=np.int64), np.array(floats, dtype=np.float64)
        done, row = offset(made, trace_rows(there), ints, floats, trace_rows(rows.arrays), rows.count, rows.capacity)
        done, rows.count = int(done), int(row)
        if done < made:
            # As far as the tool follows: the lines of these rows once more, from the same state.
            state = before
            if done:
                stop, _ = run_words(kernel, columns, count, at, state, there, 0, done)
            else:
                stop = at
        run.blocks += done
        at, going = stop, done == batch
        batch = min(8 * batch, _BATCH)
    unpack(run, state)
    for axis in range(AXES):
        s.position[axis] = Position(float(floats[c.PLACE + axis]), s.position[axis].form)
    u, v = (Position(float(floats[c.GOAL + n]), goal[n].form) for n in (0, 1))
    s.compensation = replace(comp.at(u, v, placed=True), left=(s.position[a], s.position[b]))
    return at


def _copied(state: LineState) -> LineState:
    return state._replace(ints=state.ints.copy(), floats=state.floats.copy())
