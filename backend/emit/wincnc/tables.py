"""Tables of moves as lines of WinCNC: ``Moves`` -> WORD columns -> text, without an object per line."""

from __future__ import annotations

import numpy as np

from gproof.backend.emit.job_numbers import decimals_of, rounded, rounded_feeds
from gproof.backend.emit.plain_lines import plain_lines
from gproof.backend.emit.wincnc.feeds import State, table_feeds
from gproof.ir.columns import Array, Columns
from gproof.ir.job import ARC_CW, RAPID, Moves
from gproof.ir.notes import NO_NOTES
from gproof.ir.program import WORD
from gproof.ir.target import Style

PIECE_ROWS = 1 << 16


def table_text(
    moves: Moves, style: Style, axes: tuple[str, ...], state: State, groups: tuple[int, ...], start: float
) -> bytes:
    """The lines of a table; axes: letters by column; state: the modes of the text, as after it; start: the feed in
    force, NaN for one that is not known."""
    parts = []
    for begin in range(0, len(moves.rows), PIECE_ROWS):
        rows = moves.rows.slice(begin, min(begin + PIECE_ROWS, len(moves.rows)))
        words, start = _words(rows, moves, style, axes, state, groups, start)
        text, _ = plain_lines(1, len(rows), words, NO_NOTES, indent=0, limit=1 << 30, newline=style.newline)
        parts.append(text)
    return b"".join(parts)


def _words(
    rows: Columns, moves: Moves, style: Style, axes: tuple[str, ...], state: State, groups: tuple[int, ...],
    start: float,
) -> tuple[Columns, float]:  # fmt: skip
    count = len(rows)
    code = rows["kind"].astype(np.int64) - 1
    arcs = code + 1 >= ARC_CW
    # Whether a line goes on with an arc is a setting of the controller: arcs, and what follows them, say their code.
    changed = np.empty(count, np.bool_)
    changed[0] = code[0] != state.get("motion")
    np.not_equal(code[1:], code[:-1], out=changed[1:])
    slots: list[tuple[str, Array, Array]] = [("G", code.astype(np.float64), changed | arcs)]
    places = decimals_of(style, moves.unit)
    lengths, angles = (decimals_of(style, unit, summed=moves.relative) for unit in (moves.unit, "deg"))
    for column, letter in enumerate(axes):
        named = (rows["axes"] & np.uint8(1 << column)) != 0
        if letter and named.any():
            digits = lengths if column < 3 else angles
            slots.append((letter, rounded(rows["to"][:, column], digits), named))
    if arcs.any():
        # A centre word that is missing may be that of the arc before.
        for column, letter in enumerate("IJ"):
            slots.append((letter, rounded(rows["center"][:, column], places), arcs))
    rate, said = table_feeds(rows, state, groups, start)
    if moves.per == "move":
        said = (rows["kind"] != RAPID) & ~np.isnan(rate)
    if said.any():
        slots.append(("F", rounded_feeds(rate, style.decimals), said))
    given = np.stack([named for _, _, named in slots], axis=1)
    values = np.stack([value for _, value, _ in slots], axis=1)
    letters = np.array([ord(letter) for letter, _, _ in slots], np.uint8)
    row, slot = np.nonzero(given)
    arrays = WORD.empty(len(row))
    arrays["line"][:] = row + 1
    arrays["letter"][:] = letters[slot]
    arrays["value"][:] = values[row, slot]
    state["motion"] = None if arcs[-1] else float(code[-1])
    return Columns(WORD, arrays), float(rate[-1])
