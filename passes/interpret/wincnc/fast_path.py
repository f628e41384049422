"""Plain lines of controllers of one command a line: when the kernel may run them, its state, and what it leaves.

The kernel is ``single_kernels.run_moves``; what holds for a whole run of lines and is not in its state is asked here.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from gproof.ir.dialects.wincnc_settings import wincnc_settings
from gproof.ir.finding import Span
from gproof.ir.machine import AXES
from gproof.ir.modal_groups import OF_FEEDS
from gproof.ir.rules import Function as F
from gproof.ir.symbolic import Position
from gproof.ir.trace import Op
from gproof.passes.interpret.core import refused_lines
from gproof.passes.interpret.wincnc import line_kernels as k
from gproof.passes.interpret.wincnc.moves import feed_columns, note_assumptions, usual_feed
from gproof.passes.interpret.wincnc.state import LEANING, letters_of

if TYPE_CHECKING:
    from gproof.passes.interpret.core.call_stack import PlainCell
    from gproof.passes.interpret.core.modal_state import Modal
    from gproof.passes.interpret.eding.moves import Motion

_AXES = "XYZWUVABC"
_ALL = tuple(range(AXES))


def is_plain(s: Modal) -> bool:
    """Whether moves mean what ``run_moves`` makes of them."""
    single = s.single
    return (
        s.feed_mode == 94
        and s.modes_known
        and single.sources == _ALL
        and not single.slaves
        and not single.locked
        and not single.scales
        and not single.flags & {"autoaux", "mapped", "compensation", LEANING}
        and not s.cycle_code
        and not (wincnc_settings(s.machine).adjust_boundary or wincnc_settings(s.machine).adjust_vertical)
        and single.absolute_once is None
        and not single.cell_open
        and not single.drift
        and not s.transform.on
        and s.compensation is None
        and not s.jumped
        and _feeds_are_plain(s)
        and s.pitch == 0.0
        and not s.following
        and not (s.clamped or s.drives_were_off or s.not_programmed)
    )


def _feeds_are_plain(s: Modal) -> bool:
    """Whether feeds are those of the words, or not known for any move."""
    if s.unknown_modes & OF_FEEDS and not all(map(math.isnan, s.single.feeds)):
        return False
    return not s.feed_input and (s.feed_override == 1.0 or s.feed_unknown)


class PlainLines:
    """What ``run_moves`` needs of a machine, once for a run of a program.

    columns: by letter code, -1: no axis; named: see there.
    """

    def __init__(self, ex: Motion) -> None:
        controls = wincnc_settings(ex.machine)
        columns = [-1] * 256
        for letter, column in letters_of(ex.machine).items():
            if letter in _AXES and ex.modal.has_axis(column):
                columns[ord(letter)] = column
        named = [
            _bits(feed_columns(controls, {axis for axis in _ALL if mask >> axis & 1})) for mask in range(1 << AXES)
        ]
        self.columns, self.named = columns, named
        self.arrays = np.array(columns, dtype=np.int64), np.array(named, dtype=np.int64)
        rules = [ex.program.rules.codes.get(("G", tenths)) for tenths in (900, 910)]
        self.modes = [rule is not None and rule.companion and rule.function for rule in rules] == [
            F.ABSOLUTE, F.INCREMENTAL,
        ]  # fmt: skip
        self.linear = _bits({axis for axis in _ALL if ex.modal.linear[axis]})

    def run(
        self, ex: Motion, kernel: Any, words: tuple[Any, ...], count: int, at: int, compiled: bool
    ) -> int:  # fmt: skip
        """Run lines in the kernel from word ``at``; returns the first word it left over. words: see ``run_moves``."""
        s, rows = ex.modal, ex.rows
        if s.line_lost:
            refused_lines.settle(s)
        if not is_plain(s):
            return at
        state = self._packed(ex, compiled)
        tables = self.arrays if compiled else (self.columns, self.named)
        out: Mapping[str, Any] = rows.arrays
        before = rows.count
        stop, row = kernel(
            *words, count, at, *tables, *state, out["op"], out["line"], out["to"], out["feed"], out["center"],
            out["turns"], out["plane"], before, rows.capacity,
        )  # fmt: skip
        self._taken(ex, state, int(row))
        return int(stop)

    def cells(self, ex: Motion, cell: PlainCell, places: Any, line: int) -> int:
        """Run cells of an array in the kernel; returns how many. places, line: see ``run_cells``."""
        s, rows = ex.modal, ex.rows
        zeros = [math.nan] * AXES
        for letter, value in cell.zeros:
            column = self.columns[ord(letter)]
            if column < 0 or s.offset(column).form != s.position[column].form:
                return 0
            zeros[column] = value * s.scale(column)
        open_cell = s.single.cell_open
        if cell.zero_line:
            # The cell names its local zero itself.
            s.single = s.single.but(cell_open=False)
        plain = is_plain(s)
        if s.single.cell_open != open_cell:
            s.single = s.single.but(cell_open=open_cell)
        if not plain:
            return 0
        words: tuple[Any, ...] = cell.columns
        count = len(words[0])
        kernel: Any = k.run_cells.pick(len(places) * (count + len(cell.zeros)) / 3)
        compiled = kernel is not k.run_cells.python
        state = self._packed(ex, compiled)
        tables = self.arrays if compiled else (self.columns, self.named)
        work: Any = [s.work_offsets[s.work, axis].value for axis in _ALL]
        beside: Any = [s.beside_work(axis).value for axis in _ALL]
        named: Any = zeros
        if compiled:
            work, beside, named = np.array(work), np.array(beside), np.array(zeros)
        else:
            words = tuple(column.tolist() for column in words)
        ints, floats, *forms = state
        out: Mapping[str, Any] = rows.arrays
        done, row = kernel(
            *words, count, *tables, ints, floats, ints.copy(), floats.copy(), *forms, out["op"], out["line"],
            out["to"], out["feed"], out["center"], out["turns"], out["plane"], rows.count, rows.capacity, places,
            len(places), line, named, work, beside, cell.zero_line, int(Op.OFFSET),
        )  # fmt: skip
        local = [float(value) for value in floats[k.LOCAL : k.LOCAL + AXES]]
        self._taken(ex, state, int(row), int(done) if cell.zero_line else 0)
        for axis, zero in enumerate(zeros):
            if done and not math.isnan(zero):
                s.g92[axis] = Position(local[axis], s.g92[axis].form)
        return int(done)

    def _taken(self, ex: Motion, state: tuple[Any, Any, Any, Any], row: int, events: int = 0) -> None:
        """Take over the rows up to ``row``, of which so many do not move, and what they leave."""
        rows = ex.rows
        out: Mapping[str, Any] = rows.arrays
        before, rows.count = rows.count, row
        if rows.count > before:
            new = slice(before, rows.count)
            # As a span finds its file: by name.
            out["file"][new] = ex.trace.files.index(ex.trace.files[ex._file])
            out["call"][new] = ex._call
            # The same for all of these lines, and made only where there are rows.
            out["frame"][new], out["state"][new] = ex._frame(), ex._state()
            if ex.modal.feed_unknown:
                rows.forget_feeds(before)
        first = Span(ex.trace.files[ex._file], int(out["line"][before])) if rows.count > before else None
        _unpack(ex, state, rows.count - before - events, first)

    def _packed(self, ex: Motion, compiled: bool) -> tuple[Any, Any, Any, Any]:
        """The state of ``run_moves``: integers, floats, frames of the axes and of their offsets."""
        s = ex.modal
        controls = wincnc_settings(ex.machine)
        offsets = [s.offset(axis) for axis in _ALL]
        known = not any(s.position[axis].minus(s.position[axis]).form for axis in (0, 1))
        if s.line_lost:
            # Of arcs that a refused line leaves open Python says what is known.
            known = known and s.arcs_known and not s.feed_unknown and not math.isnan(s.single.arc_feed or 0.0)
        kept = s.single.center
        ints: Any = [
            s.motion, int(s.absolute),
            int(ex.machine.controller.absolute_arc_centers), int(known), int(controls.arcs_modal),
            int(controls.helical_arcs), self.linear, _known(kept), 0, 0, 0, 0, int(s.single.feed_doubt),
            -1 if controls.arcs_share_feed is None else int(controls.arcs_share_feed),
            int(self.modes and "distance" in s.stated),
        ]  # fmt: skip
        smallest = -math.inf if controls.smallest_arc is None else controls.smallest_arc
        floats: Any = [
            s.unit, *(s.scale(axis) for axis in _ALL), *(p.value for p in s.position), *(o.value for o in offsets),
            *s.single.feeds, s.feed, *(kept or (0.0, 0.0)), smallest, *(0.0 for _ in _ALL), s.arc_tolerance(),
            -1.0 if s.single.arc_feed is None else s.single.arc_feed, usual_feed(ex), *(p.value for p in s.g92),
        ]  # fmt: skip
        form: Any = [ex.frames.form(p.form) for p in s.position]
        offset_form: Any = [ex.frames.form(o.form) for o in offsets]
        if compiled:
            ints, floats = np.array(ints, dtype=np.int64), np.array(floats, dtype=np.float64)
            form, offset_form = np.array(form, dtype=np.int64), np.array(offset_form, dtype=np.int64)
        return ints, floats, form, offset_form


def _known(kept: tuple[float, float] | None) -> int:
    """KEPT of the kernels: 0 none, 1 known, 2 not known."""
    return 0 if kept is None else 2 if math.isnan(kept[0]) else 1


def _unpack(ex: Motion, state: tuple[Any, Any, Any, Any], rows: int, first: Span | None) -> None:
    """Take over what ``run_moves`` has made of the state; first: of its rows that move."""
    ints, floats = (part if isinstance(part, list) else part.tolist() for part in state[:2])
    s = ex.modal
    open_feeds = bool(s.unknown_modes & OF_FEEDS)
    ex.blocks += ints[k.LINES]
    s.absolute = bool(ints[k.ABSOLUTE])
    if ints[k.LINES]:
        feeds = s.single.feeds if open_feeds else tuple(floats[k.FEEDS : k.FEEDS + AXES])
        # One object for what is not known: states are compared.
        lost = (math.nan, math.nan) if ints[k.KEPT] == 2 else None
        center = (floats[k.KEPT_I], floats[k.KEPT_J]) if ints[k.KEPT] == 1 else lost
        arc_feed = None if floats[k.ARC_FEED] < 0 else floats[k.ARC_FEED]
        s.single = s.single.but(feeds=feeds, center=center, arc_feed=arc_feed, feed_doubt=bool(ints[k.DOUBT]))
    if ints[k.NOTED]:
        note_assumptions(ex, first)
    if ints[k.RESET]:
        s.motion, s.cycle = ints[k.MOTION], {}
    if ints[k.USED]:
        s.feed, s.feed_unit = math.nan if open_feeds else floats[k.FEED], 1.0
    if rows:
        ex._moves += rows
        ex._moved = True
        for axis in _ALL:
            s.position[axis] = Position(floats[k.POSITION + axis], s.position[axis].form)


def _bits(columns: set[int]) -> int:
    return sum(1 << column for column in columns)
