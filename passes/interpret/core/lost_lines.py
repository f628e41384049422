"""Plain lines after a refused one whose way rests on what is lost: when the kernel may run them, and what it leaves.

The kernel is ``lost_line_kernels.run_lost``; ``refused_lines.vague`` is what it makes of a line, one by one.
"""

from __future__ import annotations

import bisect
import math
from typing import TYPE_CHECKING, Any

import numpy as np

from gproof.ir import modal_groups as g
from gproof.ir.machine import AXES
from gproof.ir.symbolic import NOWHERE
from gproof.ir.trace import KNIFE, Op
from gproof.passes.interpret.core import lost_line_kernels as k
from gproof.passes.interpret.core import refused_lines
from gproof.passes.interpret.core.line_decoder_kernels import SLOTS, WordColumns, letter_slots, trace_rows

if TYPE_CHECKING:
    from gproof.passes.interpret.core.call_stack import Frame
    from gproof.passes.interpret.core.modal_state import Modal
    from gproof.passes.interpret.core.run import Run

assert (Op.TRAVERSE, Op.FEED) == (1, 2)


def are_vague(s: Modal) -> bool:
    """Whether axis words go to places that are not known, and a row says no more than that."""
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
        and not s.axes_are_bound
        and not (s.clamped or s.drives_were_off or s.not_programmed)
    )


def run(run: Run, frame: Frame, count: int, at: int) -> int:
    """Run lines of a table from word ``at`` of ``count`` in the kernel; returns the first word it left over."""
    s, rows = run.modal, run.rows
    if not run.moved or not are_vague(s):
        return at
    # Words that mean something else to the language stop it.
    stop = bisect.bisect_left(frame.stops, at)
    count = frame.stops[stop] if stop < len(frame.stops) else count
    words: WordColumns = frame.columns
    kernel: Any = k.run_lost.pick(count - at)
    if isinstance(words.line, list):
        kernel = k.run_lost.python
    ints, floats = _packed(run, frame)
    slots: Any = _slots(run)
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
        out["file"][new] = run.trace.files.index(run.trace.files[run.file])
        out["call"][new], out["frame"][new], out["state"][new] = run.call, run.frame_number(), run.state_number()
        out["to"][new] = [place.value for place in s.position]
        _taken(run, frame, [int(n) for n in ints], [float(x) for x in floats], rows.count - before)
    return int(stop_at)


def _packed(run: Run, frame: Frame) -> tuple[Any, Any]:
    s, dialect = run.modal, run.dialect
    own_feeds = dialect.has_own_feeds
    open_feeds = bool(s.unknown_modes & g.OF_FEEDS)
    arcs = "arcs" not in run.settings.waiting and (own_feeds or "plane" in s.stated)
    is_open = own_feeds or s.feed_unknown or s.feed_unit != s.unit or s.feed == 0.0
    lost = sum(1 << axis for axis in range(AXES) if s.position[axis] == NOWHERE)
    there = sum(1 << axis.index for axis in run.machine.axes)
    ints = [
        dialect.motion_of_frame(run, frame), int(g.MOTION in s.unknown_modes), int(arcs),
        int(dialect.takes_lost_feed(run, open_feeds)), lost, there, int(is_open),
        int(open_feeds), 0, 0,
    ]  # fmt: skip
    return ints, [s.unit, s.feed, 0.0]


def _slots(run: Run) -> list[int]:
    """By letter code what it is to ``read_line``: of axes those that the machine has."""
    letters = run.dialect.letters(run.machine)
    return letter_slots({letter: axis for letter, axis in letters.items() if run.modal.has_axis(axis)})


def _taken(run: Run, frame: Frame, ints: list[int], floats: list[float], made: int) -> None:
    """Take over what the kernel has made of the state."""
    s = run.modal
    run.blocks += ints[k.LINES]
    run.moves += made
    if ints[k.FED]:
        run.dialect.take_lost_feed(run, floats[k.FEED], floats[k.LAST])
    if run.dialect.has_own_feeds:
        # The kernel has made a feed row where it went on in another motion than the fast one: see ``vague``.
        new = run.rows.arrays["op"][run.rows.count - made : run.rows.count]
        if (new == Op.FEED).any():
            s.feed = math.nan
    if g.MOTION in s.unknown_modes:
        return
    if run.dialect.keeps_motion:
        s.motion = ints[k.MOTION]
    else:
        s.motion, frame.continued = 0, f"G{ints[k.MOTION] - 1}"
    s.cycle, s.cycle_code = {}, 0
