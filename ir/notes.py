"""Notes: what is in the lines of a file apart from the program: comments, line numbers, marks.

Nothing here changes what a program does; a printer needs it to give a file back. Texts are without the delimiters
of their dialect: a comment in the middle of a line is a ``COMMENT`` whether a controller encloses it in ``( )`` or
``[ ]``, one that goes on to the end of the line a ``REMARK`` whether it starts with ``;`` or a quote. Where a dialect
has several signs for the same thing, or lets the closing one be left out, comments are ``SIGNED``: with their signs.
A line without notes and without statements is blank.
"""

from __future__ import annotations

import enum
from collections.abc import Callable, Iterator

import numpy as np

from gproof.ir.columns import Column, Columns, Schema
from gproof.ir.record import record


class NoteKind(enum.IntEnum):
    """Kinds of notes.

    LINE_NUMBER: the digits, as written; DELETE: the block delete sign of the line (no text); MARK: the sign that
    some controllers have at the start or end of a program, alone on its line, whose text is the name
    after it where the language has such names; COMMENT: enclosed; REMARK: to the end of the line; ENCODING: of the
    line's bytes, where it is not UTF-8 and the line has texts; SIGNED: a comment with the signs that start and end it;
    LEFT_OUT: a whole line that the controller, or gproof, does not read; PASCAL: the line has text of the language that
    is among the blocks of the controller (no text).
    """

    LINE_NUMBER = 1
    DELETE = 2
    MARK = 3
    COMMENT = 4
    REMARK = 5
    ENCODING = 6
    SIGNED = 7
    LEFT_OUT = 8
    PASCAL = 9


NOTE = Schema(
    "notes",
    Column("line", "i4"),
    Column("place", "i4"),
    Column("kind", "u1"),
    Column("column", "i4"),
    Column("begin", "i8"),
    Column("size", "i4"),
)
"""One note a row, in source order: line; how many words, settings or statements of the line are before it;
NoteKind; how many bytes of the line are before it (tabs to the next multiple of 8) when it is set apart from them by
more than one blank, else 0: comments below one another; place of its bytes in ``Notes.text``."""


@record(frozen=True, slots=True)
class Notes:
    """Notes of successive lines. table: NOTE columns; text: the bytes they point into, as in the file."""

    table: Columns
    text: bytes

    def __iter__(self) -> Iterator[tuple[int, int, int, int, bytes]]:
        """Each note as (line, place, kind, column, bytes of its text)."""
        for line, place, kind, column, begin, size in self.table.rows():
            yield line, place, kind, column, self.text[begin : begin + size]

    def lines(self, first: int, last: int) -> Notes:
        """The notes of the lines first..last, over the same text."""
        column = self.table["line"]
        start, stop = np.searchsorted(column, (first, last + 1)).tolist()
        return Notes(self.table.slice(start, stop), self.text)

    def verify(self) -> None:
        """In order of lines and places, and within the text; ValueError otherwise."""
        line, place = self.table["line"].astype(np.int64), self.table["place"].astype(np.int64)
        order = line * (1 << 32) + place
        begin, size = self.table["begin"], self.table["size"]
        if np.any(np.diff(order) < 0) or np.any(line < 1) or np.any(place < 0):
            raise ValueError("notes are not in order")
        if np.any(begin < 0) or np.any(size < 0) or np.any(begin + size > len(self.text)):
            raise ValueError("a note is outside its text")


NO_NOTES = Notes(Columns(NOTE), b"")


def joined(parts: list[Notes]) -> Notes:
    """All parts after one another; the only part itself when there is one."""
    if not parts:
        return NO_NOTES
    if len(parts) == 1:
        return parts[0]
    arrays = {c.name: np.concatenate([p.table[c.name] for p in parts]) for c in NOTE.columns}
    sizes = np.array([len(part.text) for part in parts])
    shifts = np.repeat(np.cumsum(sizes) - sizes, [len(part.table) for part in parts])
    arrays["begin"] = arrays["begin"] + shifts
    return Notes(Columns(NOTE, arrays), b"".join(part.text for part in parts))


Annotate = Callable[[bytes, int, int, int], tuple[Notes, int, int]]
"""``(data, begin, line, limit)`` -> (notes, next byte, next line); see ``Program.load_notes``."""
