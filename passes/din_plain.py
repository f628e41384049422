"""Plain lines of DIN blocks: when the kernel of straight-line code may run them, and what it leaves behind.

The kernel is ``execute_kernels.run_lines``, whose words count in one unit under every code; what it does not know of
these languages (reflection, cylinders, feeds of rotary axes, centre words that are left out) keeps lines from it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from gproof.ir import codes
from gproof.ir.columns import Columns
from gproof.ir.finding import Span
from gproof.ir.machine import AXES, AXIS_NAMES
from gproof.ir.trace import Op, Plane
from gproof.passes.din_compensation import is_beside
from gproof.passes.din_state import SAME, DinState, own_unit
from gproof.passes.single_state import letters_of
from gproof.passes.values import NOWHERE

if TYPE_CHECKING:
    from gproof.passes.emitter import Emitter

_HOT = np.array([chr(letter) in "XYZIJGF" for letter in range(256)])
_I, _J, _G, _F = (ord(letter) for letter in "IJGF")
_MOTIONS = {"G0": 1, "G1": 2, "G2": 3, "G3": 4}


def cold_lines(words: Columns, din: DinState) -> set[int]:
    """Lines that the kernel would take for something else, or certainly hand back."""
    letter, value, line = words["letter"], words["value"], words["line"]
    cold = ~_HOT[letter]
    g = np.flatnonzero(letter == _G)
    cold[g] = ~np.isin(value[g], (0.0, 1.0, 2.0, 3.0))
    if din.time_unit != 60.0:
        cold |= letter == _F
    found = set(line[cold].tolist())
    # One centre word alone: what the other one is rests on the arc before.
    return found | set(np.setxor1d(line[letter == _I], line[letter == _J]).tolist())


def is_plain(ex: Emitter) -> bool:
    """Whether moves mean what ``run_lines`` makes of them."""
    s, machine = ex.modal, ex.machine
    din = s.din
    letters = letters_of(machine)
    own = {axis.index for axis in machine.axes if axis.index < 3}
    return (
        all(own_unit(machine, axis) == s.unit for axis in own)
        and not din.mode_open
        and not din.reflected
        and not din.spline
        and not din.side
        and not din.constant_speed
        and not din.asked
        and din.feed > 0.0
        and not din.doubtful
        and own <= din.interpolating
        and all(s.linear[axis] for axis in own)
        and all(letters.get(AXIS_NAMES[axis].upper()) == axis for axis in own)
        and not any(letter in letters and letters[letter] > 2 for letter in "XYZ")
        and not any(place == NOWHERE or is_beside(place) for place in s.position)
        and (not ex.setup.homed or all(AXIS_NAMES[axis] in ex.setup.homed for axis in own))
    )


def begin(ex: Emitter, continued: str) -> bool:
    """Take over what a line goes on with; whether the kernel may run lines from here."""
    s = ex.modal
    motion = _MOTIONS.get(continued)
    if motion is None or not is_plain(ex):
        return False
    s.motion = motion
    s.feed, s.feed_unit = s.din.feed, s.unit
    return True


def arcs_are_plain(ex: Emitter) -> bool:
    """Whether centres count from the start of an arc, in X and Y."""
    s = ex.modal
    return s.plane is Plane.XY and (not s.absolute or s.din.centers_absolute is False)


def taken(ex: Emitter, start: list[float], before: int, words: tuple[Any, Any, Any], at: int, stop: int) -> str:
    """What the rows from ``before`` on leave, which the words from ``at`` to ``stop`` made; what goes on behind them.

    start: where the axes stood.
    """
    s, rows = ex.modal, ex.rows
    continued = f"G{s.motion - 1}"
    din = s.din if s.feed == s.din.feed else s.din.but(feed=s.feed, given=True)
    if rows.count > before:
        op, to = rows.arrays["op"][before : rows.count], rows.arrays["to"][before : rows.count]
        way = np.abs(to - np.vstack([np.array(start).reshape(1, AXES), to[:-1]])).max(axis=1)
        for n in np.flatnonzero((way < np.where(op == Op.TRAVERSE, 5e-324, SAME)) & (op != Op.ARC)).tolist():
            code = "G0" if op[n] == Op.TRAVERSE else "G1"
            span = Span(ex.trace.files[ex._file], int(rows.arrays["line"][before + n]))
            ex.findings.add(codes.NO_WAY.at(span, code=code))
        din = din.but(contour=bool(op[-1] != Op.TRAVERSE))
        if (op == Op.ARC).any():
            _judge_radii(ex, start, before)
            din = din.but(center=(_last(words, _I, at, stop) * s.unit, _last(words, _J, at, stop) * s.unit))
        ex._moves += rows.count - before
    s.din = din
    return continued


def _judge_radii(ex: Emitter, start: list[float], before: int) -> None:
    """GP401 for arcs whose end does not lie on the circle of their start (status 2000)."""
    rows, allowed = ex.rows, ex.modal.arc_tolerance()
    to = rows.arrays["to"][before : rows.count]
    begins = np.vstack([np.array(start).reshape(1, AXES), to[:-1]])
    center = rows.arrays["center"][before : rows.count, :2]
    d0, d1 = begins[:, :2] - center, to[:, :2] - center
    first, last = np.sqrt((d0 * d0).sum(axis=1)), np.sqrt((d1 * d1).sum(axis=1))
    is_arc = rows.arrays["op"][before : rows.count] == Op.ARC
    for n in np.flatnonzero(is_arc & (np.abs(last - first) > allowed + SAME)).tolist():
        span = Span(ex.trace.files[ex._file], int(rows.arrays["line"][before + n]))
        off = abs(float(last[n] - first[n]))
        ex._fail(
            codes.ARC_RADIUS_MISMATCH.at(
                span, start=float(first[n]), end=float(last[n]), off=off, allowed=allowed, unit="mm",
                hint="the controller stops with status 2000",
            )
        )  # fmt: skip


def _last(words: tuple[Any, Any, Any], wanted: int, at: int, stop: int) -> float:
    """The last value of a letter."""
    _, letter, value = words
    if isinstance(letter, list):
        place = next(n for n in range(stop - 1, at - 1, -1) if letter[n] == wanted)
    else:
        place = at + int(np.flatnonzero(letter[at:stop] == wanted)[-1])
    return float(value[place])
