"""Literal moves of plain lines: WORD columns -> ``Moves``, without an object per line."""

from __future__ import annotations

import numpy as np

from gproof.frontend.common.raising_modes import Modes
from gproof.ir.columns import Array, Columns
from gproof.ir.finding import Span
from gproof.ir.job import ARC_CCW, ARC_CW, MOVE, RAPID, STRAIGHT, Moves
from gproof.ir.program import FLAG_BARE, FLAG_DELETE
from gproof.ir.record import record


@record(frozen=True, slots=True)
class MoveLetters:
    """Letters of lines that are moves. axes: in the order of columns, "" for a column that programs do not have;
    codes: (letter, number) of the codes of rapids, straight moves and arcs; arcs_stay: a line without a code goes on
    with the arc before it; bare: letters may be without a number, which counts as 0."""

    axes: tuple[str, ...] = ("X", "Y", "Z", "A", "B", "C")
    centers: str = "IJK"
    radius: str = "R"
    feed: str = "F"
    arcs_stay: bool = True
    bare: bool = False


_CODE = ord("G")
_SKIP = ord("N")


def first_words(words: Columns) -> Array:
    """Index of the first word of each line."""
    line = words["line"]
    starts = np.empty(len(line), np.bool_)
    starts[:1] = True
    np.not_equal(line[1:], line[:-1], out=starts[1:])
    return np.flatnonzero(starts)


def simple_lines(words: Columns, firsts: Array, letters: MoveLetters) -> Array:
    """For each line, whether it may be a row: one code of motion at most, axis words, centres, a radius and a feed."""
    letter, value, flags = words["letter"], words["value"], words["flags"]
    known = np.zeros(256, np.bool_)
    for one in "".join(letters.axes) + letters.centers + letters.radius + letters.feed:
        known[ord(one)] = True
    known[_SKIP] = True
    motion = (letter == _CODE) & (value >= 0.0) & (value <= 3.0) & (value == np.floor(value))
    good = known[letter] | motion
    good &= (flags & FLAG_DELETE) == 0
    if not letters.bare:
        good &= (flags & FLAG_BARE) == 0
    whole = np.logical_and.reduceat(good, firsts) if len(firsts) else good
    axes = np.zeros(256, np.bool_)
    for one in letters.axes:
        if one:
            axes[ord(one)] = True
    whole &= np.logical_or.reduceat(axes[letter], firsts)
    whole &= np.add.reduceat(motion.astype(np.int32), firsts) <= 1
    # A letter that comes twice is an error of the line: line by line says so.
    once = np.lexsort((letter, words["line"]))
    twice = (words["line"][once][1:] == words["line"][once][:-1]) & (letter[once][1:] == letter[once][:-1])
    if twice.any():
        lines = np.unique(words["line"][once][1:][twice])
        whole &= ~np.isin(words["line"][firsts], lines)
    return whole


def _says_motion(words: Columns) -> bool:
    """Whether the first line has a code; looked up without going through the others, which are tried one by one."""
    first = int(np.searchsorted(words["line"], words["line"][0], "right"))
    return bool((words["letter"][:first] == _CODE).any())


def moves_of(
    words: Columns, modes: Modes, letters: MoveLetters, file: int, span: Span
) -> tuple[Moves, int, int] | None:
    """(table, code in force after it in tenths, lines taken) of simple lines; None where the first is none.

    The table ends before a line that the motion in force makes no row: no motion yet, or an arc without a centre.
    """
    now = modes.motion
    assert isinstance(now, int)
    start = now // 10 if now % 10 == 0 and now // 10 <= 3 else -1
    if start < 0 and not _says_motion(words):
        return None
    firsts = first_words(words)
    letter, value = words["letter"], words["value"]
    rows = len(firsts)
    row = np.repeat(np.arange(rows), np.diff(np.append(firsts, len(letter))))
    arrays = MOVE.empty(rows)
    code = np.full(rows, -1, np.int64)
    is_code = letter == _CODE
    code[row[is_code]] = value[is_code].astype(np.int64)
    given = np.flatnonzero(code >= 0)
    filled = np.full(rows, start, np.int64)
    if len(given):
        place = np.searchsorted(given, np.arange(rows), "right") - 1
        inside = place >= 0
        filled[inside] = code[given[place[inside]]]
    arrays["file"][:] = file
    arrays["line"][:] = words["line"][firsts]
    for column, one in enumerate(letters.axes):
        if not one:
            continue
        here = letter == ord(one)
        at = row[here]
        arrays["to"][at, column] = value[here]
        arrays["axes"][at] |= np.uint8(1 << column)
    for column, one in enumerate(letters.centers):
        here = letter == ord(one)
        at = row[here]
        arrays["center"][at, column] = value[here]
        arrays["centred"][at] |= np.uint8(1 << column)
    arrays["feed"][:] = np.nan
    for name, one in (("radius", letters.radius), ("feed", letters.feed)):
        if one:
            here = letter == ord(one)
            arrays[name][row[here]] = value[here]
    arc = filled >= 2
    has_center = (arrays["centred"] != 0) | (arrays["radius"] != 0.0)
    good = (filled >= 0) & (arc == has_center)
    if not letters.arcs_stay:
        good &= ~arc | (code >= 0)
    stop = rows if good.all() else int(np.argmin(good))
    if stop == 0:
        return None
    arrays["kind"][:] = np.array([RAPID, STRAIGHT, ARC_CW, ARC_CCW], np.uint8)[np.clip(filled, 0, 3)]
    table = Columns(MOVE, arrays).slice(0, stop)
    assert isinstance(modes.relative, bool)
    moves = Moves(
        rows=table, unit=modes.unit, span=span, relative=modes.relative, plane=modes.plane, per=modes.per
    )  # fmt: skip
    return moves, int(filled[stop - 1]) * 10, stop
