"""Tables of moves as RS274 lines: ``Moves`` -> WORD columns -> text, without an object per line."""

from __future__ import annotations

import numpy as np

from gproof.backend.emit.job_numbers import decimals_of, rounded, rounded_feeds
from gproof.backend.emit.plain_lines import plain_lines
from gproof.ir.columns import Array, Columns
from gproof.ir.job import ARC_CW, Moves
from gproof.ir.notes import NO_NOTES
from gproof.ir.program import WORD
from gproof.ir.target import Style

PIECE_ROWS = 1 << 16


def table_text(
    moves: Moves, style: Style, axes: tuple[str, ...], first: list[float], motion: int | None, indent: int,
    *, two_digits: bool = False,
) -> tuple[bytes, int]:  # fmt: skip
    """(text, code of motion of the last row).

    axes: letters by column; first: G codes before the words of the first row; motion: the code in force, None: unknown;
    two_digits: codes are G00 to G03.
    """
    parts = []
    for begin in range(0, len(moves.rows), PIECE_ROWS):
        rows = moves.rows.slice(begin, min(begin + PIECE_ROWS, len(moves.rows)))
        words, motion = _words(rows, moves, style, axes, first if begin == 0 else [], motion)
        text, _ = plain_lines(
            1, len(rows), words, NO_NOTES, indent=indent, limit=1 << 30, newline=style.newline, two_digits=two_digits
        )
        parts.append(text)
    assert motion is not None
    return b"".join(parts), motion


def _words(
    rows: Columns, moves: Moves, style: Style, axes: tuple[str, ...], first: list[float], motion: int | None
) -> tuple[Columns, int]:
    count = len(rows)
    code = rows["kind"].astype(np.int64) - 1
    changed = np.empty(count, np.bool_)
    changed[0] = motion is None or code[0] != motion
    np.not_equal(code[1:], code[:-1], out=changed[1:])
    slots: list[tuple[str, Array, Array]] = []
    for value in first:
        only = np.zeros(count, np.bool_)
        only[0] = True
        slots.append(("G", np.full(count, value), only))
    slots.append(("G", code.astype(np.float64), changed))
    places = decimals_of(style, moves.unit)
    lengths, angles = (decimals_of(style, unit, summed=moves.relative) for unit in (moves.unit, "deg"))
    for column, letter in enumerate(axes):
        named = (rows["axes"] & np.uint8(1 << column)) != 0
        if letter and named.any():
            digits = lengths if column < 3 else angles
            slots.append((letter, rounded(rows["to"][:, column], digits), named))
    arcs = code + 1 >= ARC_CW
    if arcs.any():
        for column, letter in enumerate("IJK"):
            named = arcs & ((rows["centred"] & np.uint8(1 << column)) != 0)
            if named.any():
                slots.append((letter, rounded(rows["center"][:, column], places), named))
        by_radius = arcs & (rows["radius"] != 0.0)
        if by_radius.any():
            slots.append(("R", rounded(rows["radius"], places), by_radius))
    fed = ~np.isnan(rows["feed"])
    if fed.any():
        slots.append(("F", rounded_feeds(rows["feed"], style.decimals), fed))
    given = np.stack([named for _, _, named in slots], axis=1)
    values = np.stack([value for _, value, _ in slots], axis=1)
    letters = np.array([ord(letter) for letter, _, _ in slots], np.uint8)
    row, slot = np.nonzero(given)
    arrays = WORD.empty(len(row))
    arrays["line"][:] = row + 1
    arrays["letter"][:] = letters[slot]
    arrays["value"][:] = values[row, slot]
    return Columns(WORD, arrays), int(code[-1])
