"""Plain lines of DIN blocks: when the kernel of straight-line code may run them, and what it leaves after.

The kernel is ``line_kernels.run_lines``, whose words have one unit under every code; what it does not know of
these languages (reflection, cylinders, feeds of rotary axes, centre words that are left out) keeps lines from it.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from gproof.ir import codes
from gproof.ir.finding import Span
from gproof.ir.machine import AXIS_NAMES
from gproof.ir.modal_groups import OF_FEEDS
from gproof.ir.symbolic import NOWHERE
from gproof.ir.trace import Op, Plane
from gproof.passes.interpret.core import line_filter_kernels as k
from gproof.passes.interpret.core.axis_words import letters_of
from gproof.passes.interpret.core.line_decoder_kernels import WordColumns, letter_slots
from gproof.passes.interpret.mcuwin.outputs_and_waits import F_LOST
from gproof.passes.interpret.mcuwin.radius_correction import is_beside, is_for_nothing
from gproof.passes.interpret.mcuwin.state import SAME, McuWinState, own_unit

if TYPE_CHECKING:
    from gproof.passes.interpret.mcuwin.state import McuWinModal, McuWinRun

assert (Op.TRAVERSE, Op.ARC) == (k.TRAVERSE, k.ARC)

_HOT = letter_slots({"X": 0, "Y": 1, "Z": 2}, "IJFG")
_I, _J = (ord(letter) for letter in "IJ")
MOTIONS = {"G0": 1, "G1": 2, "G2": 3, "G3": 4}


def hot_letters(din: McuWinState) -> list[int]:
    """(256,) slots of the letters that mean to the kernel what they mean here."""
    if din.time_unit == 60.0:
        return _HOT
    return [-1 if chr(letter) == "F" else slot for letter, slot in enumerate(_HOT)]


def is_plain(run: McuWinRun) -> bool:
    """Whether moves mean what ``run_lines`` makes of them."""
    s, machine = run.modal, run.machine
    din = s.own
    letters = letters_of(machine)
    own = {axis.index for axis in machine.axes if axis.index < 3}
    return (
        all(own_unit(machine, axis) == s.unit for axis in own)
        and s.modes_known
        and not din.mode_open
        and not din.reflected
        and not din.spline
        and not din.side
        and not is_for_nothing(din)
        and not din.constant_speed
        and not din.asked
        and _feed_is_plain(s)
        and not din.doubtful
        and own <= din.interpolating
        and all(s.linear[axis] for axis in own)
        and all(letters.get(AXIS_NAMES[axis].upper()) == axis for axis in own)
        and not any(letter in letters and letters[letter] > 2 for letter in "XYZ")
        and not any(place == NOWHERE or is_beside(place) for place in s.position)
        and not own & s.unhomed
    )


def _feed_is_plain(s: McuWinModal) -> bool:
    """Whether a feed is known, or it is already reported that it is not: in neither case does a row report anything."""
    din = s.own
    if s.unknown_modes & OF_FEEDS and din.feed_cause != F_LOST and hot_letters(din)[ord("F")] >= 0:
        return False  # an F would have another cause
    return din.feed > 0.0 or (math.isnan(din.feed) and f"feed {din.feed_cause}" in din.told)


def begin(run: McuWinRun, continued: str) -> bool:
    """Take over what a line goes on with; whether the kernel may run lines from here."""
    s = run.modal
    motion = MOTIONS.get(continued)
    if motion is None or not is_plain(run):
        return False
    s.motion = motion
    s.feed, s.feed_unit = s.own.feed, s.unit
    return True


def arcs_are_plain(run: McuWinRun) -> bool:
    """Whether centres count from the start of an arc, in X and Y."""
    s = run.modal
    return s.arcs_known and s.plane is Plane.XY and (not s.absolute or s.own.centers_absolute is False)


def taken(
    run: McuWinRun, start: list[float], before: int, words: WordColumns, at: int, stop: int,
    numbers: Any = None,
) -> str:  # fmt: skip
    """What the rows from ``before`` on leave, which the words from ``at`` to ``stop`` made; what goes on after them.

    start: where the axes were; numbers: lines of the source by those that the rows have, None where these are it.
    """
    s, rows = run.modal, run.rows
    continued = f"G{s.motion - 1}"
    din, lost = s.own, math.isnan(s.feed)
    if lost:
        s.feed = din.feed
    elif s.feed != din.feed:
        din = din.but(feed=s.feed, given=True)
    if rows.count > before:
        out, made = rows.arrays, rows.count - before
        if numbers is not None:
            new = out["line"][before : rows.count]
            new[:] = numbers[new]
        still, off, radii = np.empty(made, np.int64), np.empty(made, np.int64), np.empty((made, 2))
        allowed = run.modal.arc_tolerance()
        stills, offs, arcs = k.judge_moves.pick(made)(
            out["op"], out["to"], out["center"], before, rows.count, np.array(start), SAME, 5e-324, allowed + SAME,
            still, off, radii,
        )  # fmt: skip
        for n in still[:stills].tolist():
            code = "G0" if out["op"][before + n] == Op.TRAVERSE else "G1"
            span = Span(run.trace.files[run.file], int(out["line"][before + n]))
            run.findings.add(codes.NO_WAY.at(span, code=code))
        din = din.but(contour=bool(out["op"][rows.count - 1] != Op.TRAVERSE))
        for n, (first, last) in zip(off[:offs].tolist(), radii[:offs].tolist(), strict=True):
            _off_its_circle(run, int(out["line"][before + n]), first, last, allowed)
        if arcs:
            din = din.but(center=(_last(words, _I, at, stop) * s.unit, _last(words, _J, at, stop) * s.unit))
        run.moves += rows.count - before
    s.own = din
    return continued


def _off_its_circle(run: McuWinRun, line: int, first: float, last: float, allowed: float) -> None:
    """An arc whose end does not lie on the circle of its start (status 2000): ``arcs`` tells it of its row."""
    finding = codes.ARC_RADIUS_MISMATCH.at(
        Span(run.trace.files[run.file], line), start=first, end=last, off=abs(last - first), allowed=allowed, unit="mm"
    )
    run.fail(finding, told=True)


def _last(words: WordColumns, wanted: int, at: int, stop: int) -> float:
    """The last value of a letter."""
    letter, value = words.letter, words.value
    if isinstance(letter, list):
        place = next(n for n in range(stop - 1, at - 1, -1) if letter[n] == wanted)
    else:
        place = at + int(np.flatnonzero(letter[at:stop] == wanted)[-1])
    return float(value[place])
