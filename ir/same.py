"""Whether two Programs are the same: every node, number, flag and note; only columns, bytes and names of files differ.

``difference`` is what ``gproof fmt`` asks before it writes. Tables and notes are read piece by piece, so that memory
stays bounded.
"""

from __future__ import annotations

import dataclasses
import functools
import struct
from collections.abc import Iterator
from typing import Any

import numpy as np

from gproof.ir.columns import Columns, concatenate
from gproof.ir.finding import Span
from gproof.ir.notes import Notes, joined
from gproof.ir.program import WORD, BlockTable, DeferredBlock, Program

PIECE_BYTES = 1 << 18
_COMPARED = ("line", "letter", "flags")


def difference(left: Program, right: Program, *, notes: bool = True) -> str | None:
    """The first difference in words, with its line; None when the Programs are the same.

    notes: also compare comments, line numbers and marks. Both have their job as file 0, in which notes are compared.
    """
    for name in ("dialect", "line_count", "overrides"):
        if getattr(left, name) != getattr(right, name):
            return f"{name.replace('_', ' ')}: {getattr(left, name)} and {getattr(right, name)}"
    if list(left.subprograms) != list(right.subprograms):
        return "other subprograms"
    pair = _Pair(left, right)
    found = pair.values(left.body, right.body) or pair.values(left.subprograms, right.subprograms)
    if found is not None or not notes:
        return found
    mine, other = left.files[0], right.files[0]
    if (mine.newline, mine.mark) != (other.newline, other.mark):
        return "ends of lines, or the mark of the encoding"
    return _notes(left, right)


_BITS = struct.Struct("<d")


@functools.cache
def _field_names(kind: type) -> tuple[str, ...]:
    """Of a dataclass, those that are part of its value; of another type, none."""
    fields = dataclasses.fields(kind) if dataclasses.is_dataclass(kind) else ()
    return tuple(field.name for field in fields if field.compare)


class _Pair:
    """Two Programs that are compared."""

    def __init__(self, left: Program, right: Program) -> None:
        self.left = left
        self.right = right
        self.line = 0

    def values(self, left: Any, right: Any) -> str | None:
        """The first difference of two values of the IR."""
        if isinstance(left, DeferredBlock):
            left = left.made()
        if isinstance(right, DeferredBlock):
            right = right.made()
        kind: Any = type(left)
        names = _field_names(kind)
        if kind is not type(right):
            return self._differs(f"{kind.__name__} and {type(right).__name__}")
        if kind is Span:
            self.line = left.line or self.line
            return None if left.line == right.line else self._differs(f"line {left.line} and line {right.line}")
        if kind is float:
            return None if _BITS.pack(left) == _BITS.pack(right) else self._differs_in(left, right)
        if kind is tuple or kind is list:
            if len(left) != len(right):
                return self._differs(f"{len(left)} and {len(right)} parts")
            return next(filter(None, map(self.values, left, right)), None)
        if kind is BlockTable:
            return self._tables(left, right)
        if kind is dict:
            return self.values(list(left.items()), list(right.items()))
        if not names:
            return None if left == right else self._differs_in(left, right)
        if "span" in names:
            self.line = left.span.line or self.line
        for name in names:
            if name == "written" and left.line is not None and right.line is not None:
                continue  # the same words, perhaps in another form
            found = self.values(getattr(left, name), getattr(right, name))
            if found is not None:
                return found
        return None

    def _differs_in(self, left: Any, right: Any) -> str:
        return self._differs(f"{left!r} and {right!r}")

    def _differs(self, what: str) -> str:
        return f"{what} (line {self.line})"

    def _tables(self, left: BlockTable, right: BlockTable) -> str | None:
        self.line = left.first_line
        if (left.first_line, left.last_line) != (right.first_line, right.last_line):
            return self._differs(f"lines to {left.last_line} and to {right.last_line}")
        if (left.continued, left.distances) != (right.continued, right.distances):
            return self._differs_in((left.continued, left.distances), (right.continued, right.distances))
        for mine, other in _side_by_side(_words(self.left, left), _words(self.right, right), left.last_line):
            if len(mine) != len(other):
                return self._differs(f"{len(mine)} and {len(other)} words")
            same = np.ones(len(mine), bool)
            for name in _COMPARED:
                same &= mine[name] == other[name]
            same &= mine["value"].view(np.int64) == other["value"].view(np.int64)
            if not same.all():
                row = int(np.argmin(same))
                self.line = int(mine["line"][row])
                first, second = ((chr(t["letter"][row]), float(t["value"][row])) for t in (mine, other))
                return self._differs_in(first, second)
        return None


def _words(program: Program, table: BlockTable) -> Iterator[tuple[int, Columns]]:
    """(last line, words) of the pieces of a table."""
    begin, line = table.begin, table.first_line
    while line <= table.last_line:
        words, begin, line = program.load(table, begin, line, PIECE_BYTES)
        yield line - 1, words


def _side_by_side(
    left: Iterator[tuple[int, Columns]], right: Iterator[tuple[int, Columns]], last: int
) -> Iterator[tuple[Columns, Columns]]:
    """Words of the same lines from two tables that are cut into pieces at different lines."""
    waiting = [Columns(WORD), Columns(WORD)]
    ends = [0, 0]
    sides = [left, right]
    while min(ends) < last:
        for side in (0, 1):
            if ends[side] <= ends[1 - side] and ends[side] < last:
                ends[side], words = next(sides[side])
                waiting[side] = concatenate(WORD, [waiting[side], words])
        both = min(ends)
        cuts = [int(np.searchsorted(words["line"], both + 1)) for words in waiting]
        yield waiting[0].slice(0, cuts[0]), waiting[1].slice(0, cuts[1])
        waiting = [words.slice(cut, len(words)) for words, cut in zip(waiting, cuts, strict=True)]


def _notes(left: Program, right: Program) -> str | None:
    """The first difference of the notes of both jobs; columns of comments may differ."""
    last = left.line_count
    sides = [_pieces(left), _pieces(right)]
    waiting: list[list[Notes]] = [[], []]
    ends = [0, 0]
    first = 1
    while min(ends) < last:
        for side in (0, 1):
            if ends[side] <= ends[1 - side] and ends[side] < last:
                ends[side], notes = next(sides[side])
                waiting[side].append(notes)
        both = min(ends)
        mine, other = (joined([notes.lines(first, both) for notes in held]) for held in waiting)
        found = _compare_notes(mine, other)
        if found is not None:
            return found
        first = both + 1
        waiting = [[n for n in held if len(n.table) and n.table["line"][-1] > both] for held in waiting]
    return None


def _compare_notes(left: Notes, right: Notes) -> str | None:
    columns = ("line", "place", "kind", "size")
    if len(left.table) == len(right.table) and all(
        np.array_equal(left.table[name], right.table[name]) for name in columns
    ):
        ranges = [notes.table["begin"] for notes in (left, right)]
        size = int(left.table["size"].sum())
        if len(left.table) == 0:
            return None
        if all(int(begin[-1] - begin[0] + left.table["size"][-1]) == size for begin in ranges):
            mine, other = (n.text[int(n.table["begin"][0]) :][:size] for n in (left, right))
            if mine == other:
                return None
    for one, two in zip(left, right, strict=False):
        if (one[:3], one[4]) != (two[:3], two[4]):
            return f"{one[4]!r} and {two[4]!r} next to the program (line {min(one[0], two[0])})"
    return None if len(left.table) == len(right.table) else "notes that are missing"


def _pieces(program: Program) -> Iterator[tuple[int, Notes]]:
    """(last line, notes) of the pieces of a job."""
    begin, line = 0, 1
    while line <= program.line_count:
        notes, begin, line = program.load_notes(0, begin, line, PIECE_BYTES)
        yield line - 1, notes
