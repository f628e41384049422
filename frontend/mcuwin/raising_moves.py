"""Moves of McuWIN as operations: G00 to G03 of a line, and tables of plain lines (3.1 to 3.4).

G00 has the units of the axes, the others that of interpolation; centres are distances or places (3.3, 3.35, 3.36).
Sections are those of the manual of V 2.5.3.133.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from gproof.frontend.common.raising import Unraisable
from gproof.frontend.common.raising_modes import UNKNOWN_MODE, LineWord
from gproof.frontend.mcuwin.raising_codes import effective
from gproof.frontend.mcuwin.raising_state import BY_WAY, MINUTE, McuWinState
from gproof.frontend.mcuwin.raising_words import CENTERS
from gproof.ir.columns import Array, Columns
from gproof.ir.finding import Span
from gproof.ir.job import (
    ARC_CW,
    MM,
    MOVE,
    RAPID,
    ArcTo,
    AxisPlace,
    Feed,
    Moves,
    MoveTo,
    Node,
    NotRaised,
    Quantity,
    SetFeed,
)
from gproof.ir.program import Number
from gproof.ir.rules import CodeRule
from gproof.ir.rules import Function as F

IN_PLANE = {"xy": "IJ", "xz": "IK", "yz": "JK"}
"""Centre words by plane, as in DIN 66025 (3.3, 3.7, 3.8)."""
AXIS_OF = dict(zip(CENTERS, "xyz", strict=True))
MIRRORED_ARC = "an arc under different factors"
DIGITS = 12
"""After the point, of numbers that raising makes from two of the program: as many as any printer has."""


def move(
    state: McuWinState, rule: CodeRule, words: dict[str, LineWord], feed: Feed | None, span: Span
) -> list[Node]:  # fmt: skip
    """G00 to G03, given or going on."""
    arc = rule.function in (F.ARC_CW, F.ARC_CCW)
    rapid = rule.function is F.TRAVERSE
    alone: list[Node] = [] if feed is None else [SetFeed(feed=feed, span=span)]
    axes = {letter: word for letter, word in words.items() if letter in state.columns}
    given = [letter for letter in CENTERS if letter in words]
    if given and not arc:
        raise Unraisable(f"{given[0]} in this line", "it belongs to arcs (3.3)")
    if not rapid:
        _interpolated(state, rule, axes)
    if not axes and not (arc and given):
        return alone
    if not rapid and feed is None:
        _feed_in_force(state)
    to = state.places(axes, own=rapid, span=span)
    if arc:
        found = _arc(state, rule, to, words, feed, span)
        state.keep(began=True)
        return [found]
    state.keep(began=True)
    if rapid:
        return [*alone, MoveTo(to=to, kind="rapid", span=span)]
    return [MoveTo(to=to, feed=feed, span=span)]


def _interpolated(state: McuWinState, rule: CodeRule, axes: dict[str, LineWord]) -> None:
    known = state.mode("axes", rule.text)
    for letter in axes:
        if state.names[letter] not in known:
            raise Unraisable(f"{letter} in {rule.text}", "it is not one of the interpolation axes (3.20)")
        if letter in state.rotary:
            raise Unraisable(f"{letter} in {rule.text}", "how F counts while a rotary axis turns is open (3.17)")


def _feed_in_force(state: McuWinState) -> None:
    known = state.mode("feed", "the feed")
    if known == "asked":
        what = "whether its number or its speed is kept after G70, G71 or G94 is open (3.21, 3.28)"
        raise Unraisable("the feed in force", what)


def _arc(
    state: McuWinState, rule: CodeRule, to: tuple[AxisPlace, ...], words: dict[str, LineWord], feed: Feed | None,
    span: Span,
) -> Node:  # fmt: skip
    plane = state.now.plane
    if plane == UNKNOWN_MODE:
        raise Unraisable(f"{rule.text} in a plane", BY_WAY)
    if state.mode("plane_open", rule.text):
        raise Unraisable(f"{rule.text} after G18 or G19", "what they do without a tool table is open (2.7)")
    _even_factors(state, plane)
    letters = IN_PLANE[plane]
    axes = {AXIS_OF[letter] for letter in letters}
    if not axes <= set(state.mode("axes", rule.text)):
        raise Unraisable(rule.text, "an axis of its plane is not one of the interpolation axes (3.20)")
    for letter in CENTERS:
        if letter in words and letter not in letters:
            raise Unraisable(f"{letter} in {rule.text}", "it is not in the plane of the arc (3.3)")
    if not any(letter in words for letter in letters):
        raise Unraisable(rule.text, "it has no centre (3.3)")
    relative = not places_of_centers(state)
    zero_before = _zero_centers(state)
    zero_now = list(zero_before)
    center = []
    for letter in letters:
        n = CENTERS.index(letter)
        word = words.get(letter)
        if word is None:
            if not (relative and zero_before[n]):
                raise Unraisable(f"an arc without {letter}", "whether it is 0 or that of the arc before is open")
            word = LineWord(letter, Number(0.0, span), span)
        else:
            zero_now[n] = word.number == 0.0
        value = Quantity(state.plain(word.value), state.length_unit)
        center.append(AxisPlace(AXIS_OF[letter], value, relative))
    state.keep(center=tuple(zero_now))
    return ArcTo(to=to, plane=plane, clockwise=rule.function is F.ARC_CW, center=tuple(center), feed=feed, span=span)


def _zero_centers(state: McuWinState) -> tuple[bool, bool, bool]:
    """Whether I, J and K of the arc before were 0, or there was none: False where it depends on the path."""
    known = state.now.own("center")
    return known if isinstance(known, tuple) else (False, False, False)


def _even_factors(state: McuWinState, plane: str) -> None:
    """Unraisable for an ellipse (3.13)."""
    by = effective(state, MIRRORED_ARC)
    one, other = (abs(by.get(axis, 1.0)) for axis in plane)
    if one != other:
        raise Unraisable(MIRRORED_ARC, "an ellipse (3.13)")


def places_of_centers(state: McuWinState) -> bool:
    """Whether centres are places: in G90 by G161 or IniCfg (3.3, 3.35); Unraisable where no file says it."""
    if state.is_relative:
        return False
    absolute = state.mode("centers", "the centre of an arc")
    if absolute is None:
        raise Unraisable("the centre of an arc in G90", "whether it is a place is in no file (IniCfg, 3.3)")
    if absolute:
        for axis, letter in (("x", "X"), ("y", "Y"), ("z", "Z")):
            state.no_doubtful_mirror(axis, letter, False)
    return bool(absolute)


# ---- tables


USED = ("feed", "axes", "reflected", "factors", "zero", "centers")
"""Modes that rows of a table depend on."""


def is_plain(state: McuWinState, motion: object) -> bool:
    """Whether plain lines of a table are rows: no mode makes them mean something else, or nothing certain."""
    modes = state.now
    if not isinstance(motion, int) or motion not in (-1, 0, 10, 20, 30):
        return False
    if UNKNOWN_MODE in (modes.unit, modes.relative, modes.plane):
        return False
    own: dict[str, Any] = {name: modes.own(name) for name in USED}
    if UNKNOWN_MODE in own.values() or own["feed"] == "asked":
        return False
    letters = {letter for letter in state.columns if letter not in state.rotary}
    if not {state.names[letter] for letter in letters} <= set(own["axes"]):
        return False
    if len({state.own_units[letter] for letter in letters}) > 1 or state.own_units.get("X", 1.0) not in MM.values():
        return False
    reflected = set(own["reflected"])
    if reflected and any(by is None or abs(by) != 1.0 for by in own["factors"]):
        return False
    return modes.relative is True or reflected <= set(own["zero"])


def shaped(state: McuWinState, moves: Moves) -> list[Node]:
    """A table as the controller reads it: feeds a minute, centres from the start, G00 in the axes' own unit.

    What is open in it is a ``NotRaised`` in its place.
    """
    rows = moves.rows
    arrays = {column.name: rows[column.name].copy() for column in MOVE.columns}
    refused: dict[int, tuple[str, str]] = {}
    _feeds(state, arrays, refused)
    absolute = _centres(state, moves, arrays, refused)
    state.keep(began=True)
    whole = Columns(MOVE, arrays)
    cuts = np.zeros(len(rows), np.bool_)
    cuts[:1] = True
    rapid = arrays["kind"] == RAPID
    own = MM[moves.unit] != state.own_units.get("X", 1.0)
    if own:
        cuts[1:] |= rapid[1:] != rapid[:-1]
    for row in (*refused, *absolute):
        cuts[row] = True
        if row + 1 < len(rows):
            cuts[row + 1] = True
    if not refused and not absolute and not own:
        return [_table(moves, whole, moves.unit)]
    found: list[Node] = []
    starts = np.flatnonzero(cuts).tolist()
    for begin, end in zip(starts, [*starts[1:], len(rows)], strict=True):
        part = whole.slice(begin, end)
        span = Span(moves.span.file, int(arrays["line"][begin]))
        if begin in refused:
            found.append(NotRaised(construct=refused[begin][0], why=refused[begin][1], span=span))
        elif begin in absolute:
            found.append(_arc_row(state, moves, part, span))
        elif own and rapid[begin]:
            unit = next(name for name, mm in MM.items() if mm == state.own_units["X"])
            part["feed"][:] = np.round(part["feed"] * (MM[moves.unit] / MM[unit]), DIGITS)
            found.append(_table(moves, part, unit, span))
        else:
            found.append(_table(moves, part, moves.unit, span))
    return found


def _table(moves: Moves, rows: Columns, unit: str, span: Span | None = None) -> Moves:
    return Moves(
        rows=rows, unit=unit, span=span or moves.span, relative=moves.relative, plane=moves.plane, per=moves.per
    )


def _feeds(state: McuWinState, arrays: dict[str, Array], refused: dict[int, tuple[str, str]]) -> None:
    """F a minute (5.3, 3.28)."""
    given = np.flatnonzero(~np.isnan(arrays["feed"]))
    if not len(given):
        return
    time = state.now.own("time")
    if isinstance(time, float):
        if time != MINUTE:
            arrays["feed"][:] = np.round(arrays["feed"] * (MINUTE / time), DIGITS)
        state.keep(feed="given")
    else:
        refused[int(given[0])] = "F", "whether it counts a minute or a second is not known (IniCfg, 5.3)"
        arrays["feed"][:] = np.nan


def _centres(
    state: McuWinState, moves: Moves, arrays: dict[str, Array], refused: dict[int, tuple[str, str]]
) -> Sequence[int]:  # fmt: skip
    """Centres from the start; rows whose start the table does not say, which keep places."""
    arcs = np.flatnonzero(arrays["kind"] >= ARC_CW)
    if not len(arcs):
        return ()
    try:
        absolute = places_of_centers(state)
    except Unraisable as error:
        refused[int(arcs[0])] = error.construct, error.why
        return ()
    if absolute:
        missing = arcs[arrays["centred"][arcs] != 3]
        if len(missing):
            refused[int(missing[0])] = "an arc without I or J", "its centre is a place, and a word is missing (3.3)"
        return _from_start(arrays, arcs, state.own_units.get("X", 1.0) / MM[moves.unit])
    _missing(state, arrays, arcs, refused)
    return ()


def _missing(
    state: McuWinState, arrays: dict[str, Array], arcs: Array, refused: dict[int, tuple[str, str]]
) -> None:  # fmt: skip
    """A word that is left out is 0 where that of the arc before was 0 too, or there was none (3.3)."""
    zero = list(_zero_centers(state))
    for n in (0, 1):
        named = (arrays["centred"][arcs] >> n & 1).astype(np.bool_)
        values = np.where(named, arrays["center"][arcs, n], 0.0)
        before = np.concatenate(([0.0 if zero[n] else 1.0], values[:-1]))
        wrong = arcs[~named & (before != 0.0)]
        if len(wrong):
            what = f"an arc without {CENTERS[n]}"
            refused[int(wrong[0])] = what, "whether it is 0 or that of the arc before is open (3.3)"
        zero[n] = bool(values[-1] == 0.0)
    arrays["centred"][arcs] = 3
    state.keep(center=tuple(zero))


def _from_start(arrays: dict[str, Array], arcs: Array, own: float) -> list[int]:
    """Places of centres as distances from the start, where rows before say it; the others. own: units of the table in
    one of the axes, which G00 has (3.1)."""
    open_rows: set[int] = set()
    places = arrays["to"] * np.where(arrays["kind"] == RAPID, own, 1.0)[:, None]
    for n in (0, 1):
        named = np.flatnonzero(arrays["axes"] >> n & 1)
        last = np.searchsorted(named, arcs, "left") - 1
        known = last >= 0
        start = places[named[last[known]], n]
        at = arcs[known]
        arrays["center"][at, n] = np.round(arrays["center"][at, n] - start, DIGITS)
        open_rows.update(arcs[~known].tolist())
    for row in open_rows:
        # Both coordinates of such a row are places again.
        for n in (0, 1):
            named = np.flatnonzero(arrays["axes"][:row] >> n & 1)
            if len(named):
                arrays["center"][row, n] = np.round(arrays["center"][row, n] + places[named[-1], n], DIGITS)
    return sorted(open_rows)


def _arc_row(state: McuWinState, moves: Moves, row: Columns, span: Span) -> ArcTo:
    """A row whose centre is a place."""
    unit = moves.unit
    bits, to, center, feed = int(row["axes"][0]), row["to"][0], row["center"][0], float(row["feed"][0])
    return ArcTo(
        to=tuple(
            AxisPlace(axis, Quantity(Number(float(to[n]), span), unit)) for n, axis in enumerate("xyz") if bits >> n & 1
        ),
        plane=moves.plane,
        clockwise=int(row["kind"][0]) == ARC_CW,
        center=tuple(AxisPlace(axis, Quantity(Number(float(center[n]), span), unit)) for n, axis in enumerate("xy")),
        feed=None if np.isnan(feed) else Feed(Quantity(Number(feed, span), unit), moves.per),
        span=span,
    )
