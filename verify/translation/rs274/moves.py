"""Moves as rows of a Trace: whole tables of lines at once.

Sources: LinuxCNC user manual, G-Codes G0 to G3, G17 to G19, G90, G91; NIST IR 6556 3.5.1 to 3.5.3.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from gproof.ir.drives import AXES
from gproof.ir.record import record
from gproof.ir.trace import TRACE_ROW, Op, Plane
from gproof.verify.translation.rs274.language import Language, Unread
from gproof.verify.translation.rs274.offsets import Place
from gproof.verify.translation.rs274.rows import Rows

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

IN_PLANE = {17: (0, 1), 18: (2, 0), 19: (1, 2)}
"""Columns of the axes of a plane, so that the third one is towards who looks at it."""
PLANES = {17: Plane.XY, 18: Plane.XZ, 19: Plane.YZ}
STILL = 1e-9
"""mm or degrees: an axis that goes no farther rests."""


@record(frozen=True, slots=True, kw_only=True)
class Manner:
    """How words count: unit: mm; absolute: G90; plane: 17 to 19; machine: G53; state: number of the Trace's state."""

    language: Language
    unit: float
    absolute: bool
    plane: int
    state: int
    machine: bool = False


def go(
    rows: Rows, zero: list[Place], manner: Manner, lines: Ints, code: Ints, words: Floats, radius: Floats, feed: Floats,
    turns: int = 1,
) -> None:  # fmt: skip
    """Append a row for each line.

    zero: by axis the machine place of 0; code: (n,) 0 to 3; words: (n, 9) X Y Z A B C I J K, NaN where missing; radius:
    (n,) of R, NaN; feed: (n,) as in force, in program units a minute. Unread where a line cannot be done.
    """
    count = len(lines)
    named = ~np.isnan(words[:, :AXES])
    scale = np.array([manner.unit] * 3 + [1.0] * 3)
    given = np.where(named, words[:, :AXES], 0.0) * scale
    start = np.array(rows.place)
    to = np.empty((count, AXES))
    numbers = np.zeros(count, np.int64)
    for axis in range(AXES):
        if not manner.absolute:
            to[:, axis] = start[axis] + np.cumsum(given[:, axis])
            continue
        last = np.maximum.accumulate(np.where(named[:, axis], np.arange(count), -1))
        to[:, axis] = np.where(last >= 0, given[np.maximum(last, 0), axis] + zero[axis].value, start[axis])
        if rows.forms[axis] != zero[axis].form:
            numbers |= (last >= 0).astype(np.int64) << axis
    frames = _frames(rows, zero, numbers)
    before = np.concatenate([start[None], to[:-1]])
    arrays = TRACE_ROW.empty(count)
    arcs = code >= 2
    moved = np.abs(to - before) > STILL
    linear = moved[:, :3].any(axis=1) | ~moved[:, 3:].any(axis=1)
    speed = np.where(linear, feed * manner.unit, feed)
    if (np.isnan(speed) & (code > 0)).any():
        raise Unread("a move without a feed", int(lines[np.flatnonzero(np.isnan(speed) & (code > 0))[0]]))
    if arcs.any():
        _arcs(arrays, manner, lines, np.flatnonzero(arcs), code, words, radius, before, to, rows, numbers, turns)
    arrays["op"][:] = np.where(code == 0, int(Op.TRAVERSE), np.where(arcs, int(Op.ARC), int(Op.FEED)))
    arrays["line"][:] = lines
    arrays["to"][:] = to
    arrays["frame"][:] = frames
    arrays["state"][:] = manner.state
    arrays["feed"][:] = np.where(code == 0, 0.0, speed)
    rows.table(arrays)
    rows.place = to[-1].tolist()
    rows.forms = rows.trace.frames[int(frames[-1])]


def _frames(rows: Rows, zero: list[Place], numbers: Ints) -> Ints:
    """Number of the frame of each row; numbers: bits of the axes that are in the new frame by then."""
    frames = np.zeros(len(numbers), np.int64)
    for mask in np.flatnonzero(np.bincount(numbers)).tolist():
        forms = tuple(zero[a].form if mask >> a & 1 else rows.forms[a] for a in range(AXES))
        frames[numbers == mask] = rows.frame(forms)  # type: ignore[arg-type]
    return frames


def _arcs(
    arrays: dict[str, npt.NDArray[np.generic]], manner: Manner, lines: Ints, which: Ints, code: Ints, words: Floats,
    radius: Floats, before: Floats, to: Floats, rows: Rows, numbers: Ints, turns: int,
) -> None:  # fmt: skip
    """Centres, senses and planes; Unread for an arc that the controller refuses, or that is nowhere."""
    first, second = IN_PLANE[manner.plane]
    across = 3 - first - second
    pair = [first, second]
    language = manner.language
    bits = (1 << first) | (1 << second)
    came = np.concatenate([[0], numbers[:-1]])
    lost = (came[which] ^ numbers[which]) & bits
    if lost.any():
        raise Unread("an arc from a place that is unknown", int(lines[which[np.flatnonzero(lost)[0]]]))
    begin, end = before[which][:, pair], to[which][:, pair]
    closed = (np.abs(end - begin) <= STILL).all(axis=1)
    end[closed] = begin[closed]
    to[which[:, None], np.array(pair)] = end
    offsets = words[which][:, [6 + first, 6 + second]]
    stray = ~np.isnan(words[which, 6 + across])
    by_radius = ~np.isnan(radius[which])
    named = ~np.isnan(words[which][:, pair]).all(axis=1)
    bad = stray | (by_radius & ~np.isnan(offsets).all(axis=1)) | (~by_radius & np.isnan(offsets).all(axis=1))
    if language.arc_needs_axis:
        bad |= ~named
    center = begin + np.nan_to_num(offsets) * manner.unit
    if by_radius.any():
        n = np.flatnonzero(by_radius)
        r = radius[which[n]] * manner.unit
        found, wrong = _by_radius(begin[n], end[n], r, code[which[n]] == 2, language.chord_slack)
        center[n] = found
        bad[n] |= wrong | (turns != 1)
    one, other = np.hypot(*(begin - center).T), np.hypot(*(end - center).T)
    apart = np.abs(one - other)
    bad |= (one <= 0.0) | (apart > language.arc_most)
    bad |= (apart > language.arc_slack) & (apart > language.arc_share * np.maximum(one, other))
    if bad.any():
        raise Unread("an arc that the controller does not accept", int(lines[which[np.flatnonzero(bad)[0]]]))
    arrays["center"][which, first] = center[:, 0]
    arrays["center"][which, second] = center[:, 1]
    arrays["center"][which, across] = before[which, across]
    sense = np.where(code[which] == 2, -1, 1)
    arrays["turns"][which] = sense * (turns + _all_round(begin - center, end - center, sense, language.circle_fuzz))
    arrays["plane"][which] = int(PLANES[manner.plane])


def _all_round(one: Floats, other: Floats, sense: Ints, fuzz: float) -> npt.NDArray[np.bool_]:
    """Arcs that end so little behind their start that the controller goes all round, as it does at the start itself."""
    cross = one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]
    ahead: Floats = np.arctan2(cross * sense, (one * other).sum(axis=1))
    return (ahead > 0.0) & (ahead <= fuzz)


def _by_radius(
    begin: Floats, end: Floats, radius: Floats, clockwise: npt.NDArray[np.bool_], slack: float
) -> tuple[Floats, npt.NDArray[np.bool_]]:
    """Centres, and which arcs no circle makes (G-Codes G2 G3, radius format)."""
    along = end - begin
    half = np.hypot(along[:, 0], along[:, 1]) / 2.0
    size = np.abs(radius)
    wrong = (half <= 0.0) | (half > size + slack)
    rise = np.sqrt(np.maximum(size**2 - half**2, 0.0))
    # Seen along the chord, the centre of a short arc is on the left where it goes counter-clockwise.
    left = np.stack([-along[:, 1], along[:, 0]], axis=1) / np.where(half > 0.0, 2.0 * half, 1.0)[:, None]
    side = np.where(clockwise, -1.0, 1.0) * np.sign(radius)
    return (begin + end) / 2.0 + left * (rise * side)[:, None], wrong


def length_of(before: Floats, to: Floats, center: Floats | None, plane: int, clockwise: bool, turns: int) -> float:
    """The length of one move for inverse time: of X Y Z where they move, else of the rotary axes."""
    if center is None:
        linear = math.dist(before[:3], to[:3])
        return linear if linear > STILL else math.dist(before[3:], to[3:])
    first, second = IN_PLANE[plane]
    across = 3 - first - second
    a = np.array([before[first], before[second]]) - center[[first, second]]
    b = np.array([to[first], to[second]]) - center[[first, second]]
    sweep = math.atan2(b[1], b[0]) - math.atan2(a[1], a[0])
    sweep = (-sweep if clockwise else sweep) % (2.0 * math.pi)
    sweep = (sweep if sweep > 1e-9 else 2.0 * math.pi) + (turns - 1) * 2.0 * math.pi
    return math.hypot(sweep * math.hypot(*a), to[across] - before[across])
