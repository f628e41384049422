"""Plain lines behind a refused one whose way rests on what is lost: when the kernel may run them, and what it leaves.

The kernel is ``lost_line_kernels.run_lost``; ``refused_lines.vague`` is what it makes of a line, one by one.
"""

from __future__ import annotations

import bisect
import math
from typing import TYPE_CHECKING, Any

import numpy as np

from gproof.ir import modal_groups as g
from gproof.ir.machine import AXES, AXIS_NAMES
from gproof.ir.symbolic import NOWHERE
from gproof.ir.trace import KNIFE, Op
from gproof.passes.interpret.core import lost_line_kernels as k
from gproof.passes.interpret.core import refused_lines
from gproof.passes.interpret.core.line_decoder_kernels import SLOTS, WordColumns, letter_slots, trace_rows
from gproof.passes.interpret.wincnc.state import letters_of

if TYPE_CHECKING:
    from gproof.passes.interpret.core.block_tables import Straight
    from gproof.passes.interpret.core.call_stack import Frame
    from gproof.passes.interpret.core.modal_state import Modal

assert (Op.TRAVERSE, Op.FEED) == (1, 2)


def are_vague(s: Modal) -> bool:
    """Whether axis words go nobody knows where, and a row says no more than that."""
    single = s.single
    return (
        (g.MOTION in s.unknown_modes or not refused_lines.words_count(s))
        and s.refused_at is None
        and not s.jumped
        and s.compensation is None
        and not s.transform.on
        and s.feed_mode == 94
        and s.pitch == 0.0
        and (s.feed_override == 1.0 or s.feed_unknown)
        and not s.cycle_code
        and KNIFE not in s.following
        and not (single.slaves or single.locked or single.cell_open)
        and single.absolute_once is None
        and not (s.clamped or s.drives_were_off or s.not_programmed)
    )


def run(ex: Straight, frame: Frame, count: int, at: int) -> int:
    """Run lines of a table from word ``at`` of ``count`` in the kernel; returns the first word it left over."""
    s, rows = ex.modal, ex.rows
    if not ex._moved or not are_vague(s):
        return at
    if s.rules.source_order:
        # As in ``din_manner``: words that mean something else stop it.
        stop = bisect.bisect_left(frame.stops, at)
        count = frame.stops[stop] if stop < len(frame.stops) else count
    words: WordColumns = frame.columns
    kernel: Any = k.run_lost.pick(count - at)
    if isinstance(words.line, list):
        kernel = k.run_lost.python
    ints, floats = _packed(ex, frame)
    slots: Any = _slots(ex)
    values: Any = [0.0] * SLOTS
    if kernel is not k.run_lost.python:
        slots, values = np.array(slots, dtype=np.int64), np.array(values)
        ints, floats = np.array(ints, dtype=np.int64), np.array(floats, dtype=np.float64)
    out: Any = rows.arrays
    before = rows.count
    stop_at, row = kernel(
        words, count, at, slots, ints, floats, values, math.nan, trace_rows(out), before, rows.capacity
    )
    rows.count = int(row)
    if rows.count > before:
        new = slice(before, rows.count)
        out["file"][new] = ex.trace.files.index(ex.trace.files[ex._file])
        out["call"][new], out["frame"][new], out["state"][new] = ex._call, ex._frame(), ex._state()
        out["to"][new] = [place.value for place in s.position]
        _taken(ex, frame, [int(n) for n in ints], [float(x) for x in floats], rows.count - before)
    return int(stop_at)


def _packed(ex: Straight, frame: Frame) -> tuple[Any, Any]:
    s = ex.modal
    rules = s.rules
    own_feeds = rules.one_command or rules.source_order
    open_feeds = bool(s.unknown_modes & g.OF_FEEDS)
    motion = s.motion
    if rules.source_order:
        # Only jobs of McuWIN load these.
        from gproof.passes.interpret.mcuwin.fast_path import MOTIONS

        motion = MOTIONS.get(frame.continued, 0)
    arcs = "arcs" not in ex.settings.waiting and (own_feeds or "plane" in s.stated)
    if rules.one_command:
        # One F is the feed of many axes; where none is known it leaves none known.
        takes_feed = open_feeds and not s.single.feed_doubt and all(map(math.isnan, s.single.feeds))
    else:
        takes_feed = rules.source_order or s.feed_unit == s.unit
    is_open = own_feeds or s.feed_unknown or s.feed_unit != s.unit or s.feed == 0.0
    if not own_feeds and s.feed == 0.0:
        takes_feed = False
    lost = sum(1 << axis for axis in range(AXES) if s.position[axis] == NOWHERE)
    there = sum(1 << axis.index for axis in ex.machine.axes)
    ints = [
        motion, int(g.MOTION in s.unknown_modes), int(arcs), int(takes_feed), lost, there, int(is_open),
        int(open_feeds), 0, 0,
    ]  # fmt: skip
    return ints, [s.unit, s.feed, 0.0]


def _slots(ex: Straight) -> list[int]:
    """By letter code what it is to ``read_line``: of axes those that the machine has."""
    letters = {name.upper(): axis for axis, name in enumerate(AXIS_NAMES)}
    if ex.modal.rules.one_command or ex.modal.rules.source_order:
        letters = letters_of(ex.machine)
    return letter_slots({letter: axis for letter, axis in letters.items() if ex.modal.has_axis(axis)})


def _taken(ex: Straight, frame: Frame, ints: list[int], floats: list[float], made: int) -> None:
    """Take over what the kernel has made of the state."""
    s = ex.modal
    ex.blocks += ints[k.LINES]
    ex._moves += made
    if ints[k.FED] and s.rules.source_order:
        from gproof.passes.interpret.mcuwin.outputs_and_waits import take_feed

        take_feed(s, floats[k.LAST])
    elif ints[k.FED] and not s.rules.one_command:
        s.feed = floats[k.FEED]
    if s.rules.one_command or s.rules.source_order:
        # The kernel has made a feed row where it went on in another motion than the fast one: see ``vague``.
        new = ex.rows.arrays["op"][ex.rows.count - made : ex.rows.count]
        if (new == Op.FEED).any():
            s.feed = math.nan
    if g.MOTION in s.unknown_modes:
        return
    if s.rules.source_order:
        frame.continued = f"G{ints[k.MOTION] - 1}"
    s.motion, s.cycle, s.cycle_code = 0 if s.rules.source_order else ints[k.MOTION], {}, 0
