"""Plain lines of controllers of one command a line: when the kernel may run them, its state, and what it leaves.

The kernel is ``line_kernels.run_moves``; what holds for a whole run of lines and is not in its state is asked here.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from gproof.ir.dialects.wincnc.settings import wincnc_settings
from gproof.ir.finding import Span
from gproof.ir.machine import AXES
from gproof.ir.modal_groups import OF_FEEDS
from gproof.ir.rules import Function as F
from gproof.ir.symbolic import Position
from gproof.ir.trace import Op
from gproof.passes.interpret.core import refused_lines
from gproof.passes.interpret.core.axis_words import letters_of
from gproof.passes.interpret.core.line_decoder_kernels import SLOTS, LineState, WordColumns, letter_slots, trace_rows
from gproof.passes.interpret.wincnc import line_kernels as k
from gproof.passes.interpret.wincnc.arcs import usual_feed
from gproof.passes.interpret.wincnc.moves import feed_columns, note_assumptions
from gproof.passes.interpret.wincnc.state import LEANING

if TYPE_CHECKING:
    from gproof.passes.interpret.core.call_stack import PlainCell
    from gproof.passes.interpret.wincnc.state import WinCncModal, WinCncRun

_AXES = "XYZWUVABC"
_ALL = tuple(range(AXES))


def is_plain(s: WinCncModal) -> bool:
    """Whether moves mean what ``run_moves`` makes of them."""
    single = s.own
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


def _feeds_are_plain(s: WinCncModal) -> bool:
    """Whether feeds are those of the words, or not known for any move."""
    if s.unknown_modes & OF_FEEDS and not all(map(math.isnan, s.own.feeds)):
        return False
    return not s.feed_input and (s.feed_override == 1.0 or s.feed_unknown)


class PlainLines:
    """What ``run_moves`` needs of a machine, once for a run of a program.

    axes: columns by letter; slots, named: see there.
    """

    def __init__(self, run: WinCncRun) -> None:
        controls = wincnc_settings(run.machine)
        axes = {
            letter: column
            for letter, column in letters_of(run.machine).items()
            if letter in _AXES and run.modal.has_axis(column)
        }
        named = [
            _bits(feed_columns(controls, {axis for axis in _ALL if mask >> axis & 1})) for mask in range(1 << AXES)
        ]
        self.axes, self.slots, self.named = axes, letter_slots(axes), named
        self.arrays = np.array(self.slots, dtype=np.int64), np.array(named, dtype=np.int64)
        rules = [run.program.rules.codes.get(("G", tenths)) for tenths in (900, 910)]
        self.modes = [rule is not None and rule.companion and rule.function for rule in rules] == [
            F.ABSOLUTE, F.INCREMENTAL,
        ]  # fmt: skip
        self.linear = _bits({axis for axis in _ALL if run.modal.linear[axis]})

    def run(
        self, run: WinCncRun, kernel: Any, words: WordColumns, count: int, at: int, compiled: bool
    ) -> int:  # fmt: skip
        """Run lines in the kernel from word ``at``; returns the first word it left over. words: see ``run_moves``."""
        s, rows = run.modal, run.rows
        if s.line_lost:
            refused_lines.settle(s)
        if not is_plain(s):
            return at
        state = self._packed(run, compiled)
        slots, named = self.arrays if compiled else (self.slots, self.named)
        stop, row = kernel(words, count, at, slots, named, state, trace_rows(rows.arrays), rows.count, rows.capacity)
        self._taken(run, state, int(row))
        return int(stop)

    def cells(self, run: WinCncRun, cell: PlainCell, places: Any, line: int) -> int:
        """Run cells of an array in the kernel; returns how many. places, line: see ``run_cells``."""
        s, rows = run.modal, run.rows
        zeros = [math.nan] * AXES
        for letter, value in cell.zeros:
            column = self.axes.get(letter, -1)
            if column < 0 or s.offset(column).form != s.position[column].form:
                return 0
            zeros[column] = value * s.scale(column)
        open_cell = s.own.cell_open
        if cell.zero_line:
            # The cell names its local zero itself.
            s.own = s.own.but(cell_open=False)
        plain = is_plain(s)
        if s.own.cell_open != open_cell:
            s.own = s.own.but(cell_open=open_cell)
        if not plain:
            return 0
        words = WordColumns(*cell.columns)
        count = len(words.line)
        kernel: Any = k.run_cells.pick(len(places) * (count + len(cell.zeros)) / 3)
        compiled = kernel is not k.run_cells.python
        state = self._packed(run, compiled)
        slots, table = self.arrays if compiled else (self.slots, self.named)
        work: Any = [s.work_offsets[s.work, axis].value for axis in _ALL]
        beside: Any = [s.beside_work(axis).value for axis in _ALL]
        named: Any = zeros
        if compiled:
            work, beside, named = np.array(work), np.array(beside), np.array(zeros)
        else:
            words = WordColumns(*(column.tolist() for column in words))
        kept = state._replace(ints=state.ints.copy(), floats=state.floats.copy())
        cells = k.CellPlaces(places, line, named, work, beside, cell.zero_line, int(Op.OFFSET))
        done, row = kernel(
            words, count, slots, table, state, kept, trace_rows(rows.arrays), rows.count, rows.capacity, cells
        )
        local = [float(value) for value in state.floats[k.LOCAL : k.LOCAL + AXES]]
        self._taken(run, state, int(row), int(done) if cell.zero_line else 0)
        for axis, zero in enumerate(zeros):
            if done and not math.isnan(zero):
                s.g92[axis] = Position(local[axis], s.g92[axis].form)
        return int(done)

    def _taken(self, run: WinCncRun, state: LineState, row: int, events: int = 0) -> None:
        """Take over the rows up to ``row``, of which so many do not move, and what they leave."""
        rows = run.rows
        out: Mapping[str, Any] = rows.arrays
        before, rows.count = rows.count, row
        if rows.count > before:
            new = slice(before, rows.count)
            # As a span finds its file: by name.
            out["file"][new] = run.trace.files.index(run.trace.files[run.file])
            out["call"][new] = run.call
            # The same for all of these lines, and made only where there are rows.
            out["frame"][new], out["state"][new] = run.frame_number(), run.state_number()
            if run.modal.feed_unknown:
                rows.forget_feeds(before)
        first = Span(run.trace.files[run.file], int(out["line"][before])) if rows.count > before else None
        _unpack(run, state, rows.count - before - events, first)

    def _packed(self, run: WinCncRun, compiled: bool) -> LineState:
        """The state of ``run_moves``."""
        s = run.modal
        controls = wincnc_settings(run.machine)
        offsets = [s.offset(axis) for axis in _ALL]
        known = not any(s.position[axis].minus(s.position[axis]).form for axis in (0, 1))
        if s.line_lost:
            # Of arcs that a refused line leaves open Python says what is known.
            known = known and s.arcs_known and not s.feed_unknown and not math.isnan(s.own.arc_feed or 0.0)
        kept = s.own.center
        ints: Any = [
            s.motion, int(s.absolute),
            int(run.machine.controller.absolute_arc_centers), int(known), int(controls.arcs_modal),
            int(controls.helical_arcs), self.linear, _known(kept), 0, 0, 0, 0, int(s.own.feed_doubt),
            -1 if controls.arcs_share_feed is None else int(controls.arcs_share_feed),
            int(self.modes and "distance" in s.stated),
        ]  # fmt: skip
        smallest = -math.inf if controls.smallest_arc is None else controls.smallest_arc
        floats: Any = [
            s.unit, *(s.scale(axis) for axis in _ALL), *(p.value for p in s.position), *(o.value for o in offsets),
            *s.own.feeds, s.feed, *(kept or (0.0, 0.0)), smallest, *(0.0 for _ in _ALL), s.arc_tolerance(),
            -1.0 if s.own.arc_feed is None else s.own.arc_feed, usual_feed(run), *(p.value for p in s.g92),
        ]  # fmt: skip
        form: Any = [run.frames.form(p.form) for p in s.position]
        offset_form: Any = [run.frames.form(o.form) for o in offsets]
        values: Any = [0.0] * SLOTS
        if compiled:
            values = np.zeros(SLOTS)
            ints, floats = np.array(ints, dtype=np.int64), np.array(floats, dtype=np.float64)
            form, offset_form = np.array(form, dtype=np.int64), np.array(offset_form, dtype=np.int64)
        return LineState(ints, floats, form, offset_form, values)


def _known(kept: tuple[float, float] | None) -> int:
    """KEPT of the kernels: 0 none, 1 known, 2 not known."""
    return 0 if kept is None else 2 if math.isnan(kept[0]) else 1


def _unpack(run: WinCncRun, state: LineState, rows: int, first: Span | None) -> None:
    """Take over what ``run_moves`` has made of the state; first: of its rows that move."""
    ints, floats = (part if isinstance(part, list) else part.tolist() for part in (state.ints, state.floats))
    s = run.modal
    open_feeds = bool(s.unknown_modes & OF_FEEDS)
    run.blocks += ints[k.LINES]
    s.absolute = bool(ints[k.ABSOLUTE])
    if ints[k.LINES]:
        # One object for what is not known: states are compared.
        feeds = tuple(math.nan if math.isnan(one) else one for one in floats[k.FEEDS : k.FEEDS + AXES])
        feeds = s.own.feeds if open_feeds else feeds
        lost = (math.nan, math.nan) if ints[k.KEPT] == 2 else None
        center = (floats[k.KEPT_I], floats[k.KEPT_J]) if ints[k.KEPT] == 1 else lost
        arc_feed = None if floats[k.ARC_FEED] < 0 else floats[k.ARC_FEED]
        s.own = s.own.but(feeds=feeds, center=center, arc_feed=arc_feed, feed_doubt=bool(ints[k.DOUBT]))
    if ints[k.NOTED]:
        note_assumptions(run, first)
    if ints[k.RESET]:
        s.motion, s.cycle = ints[k.MOTION], {}
    if ints[k.USED]:
        s.feed, s.feed_unit = math.nan if open_feeds else floats[k.FEED], 1.0
    if rows:
        run.moves += rows
        run.moved = True
        for axis in _ALL:
            s.position[axis] = Position(floats[k.POSITION + axis], s.position[axis].form)


def _bits(columns: set[int]) -> int:
    return sum(1 << column for column in columns)
