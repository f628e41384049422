"""The notes of McuWIN files: line numbers, percent signs with their names, comments with the signs that enclose them.

Notes of lines that are not plain are kept when the file is read, since what a bracket is depends on what was declared
before it (manual 6, 12); those of plain lines are read from the bytes when somebody prints the file.
"""

from __future__ import annotations

from bisect import bisect_left
from typing import Any

import numpy as np

from gproof.frontend.common.source import UTF8_MARK
from gproof.frontend.mcuwin import scan_kernels as k
from gproof.ir.columns import Columns
from gproof.ir.notes import NOTE, NoteKind, Notes
from gproof.ir.record import field, record

Found = tuple[int, NoteKind, int, str]
"""Place, kind, character where it starts (from 0) and text of a note."""
Row = tuple[int, int, int, int, bytes]
"""Line, place, kind, column and bytes of a note."""


@record(slots=True)
class FileNotes:
    """What one file has. plain: (first byte, end, number of the first line) of its plain lines, in order; rows: notes
    of all others, in order."""

    data: bytes
    plain: list[tuple[int, int, int]] = field(default_factory=list)
    rows: list[Row] = field(default_factory=list)

    def add(self, line: int, text: str, encoding: str, found: list[Found]) -> None:
        """The notes of a line."""
        if encoding != "utf-8" and not (self.rows and self.rows[-1][0] == line):
            self.rows.append((line, 0, int(NoteKind.ENCODING), 0, encoding.encode()))
        for place, kind, begin, written in found:
            column = column_of(text[:begin].encode(encoding)) if place else 0
            self.rows.append((line, place, int(kind), column, written.encode(encoding)))


def column_of(before: bytes) -> int:
    """The column after ``before``, when it ends in more than one blank, else 0; see NOTE."""
    column = len(before.expandtabs(8))
    return column if column - len(before.rstrip(b" \t").expandtabs(8)) > 1 else 0


@record(slots=True)
class Annotator:
    """Reads the notes of the files of a program."""

    files: list[FileNotes] = field(default_factory=list)

    def annotate(self, data: bytes, begin: int, line: int, limit: int) -> tuple[Notes, int, int]:
        """Notes of the lines from byte ``begin``, which starts line ``line``; see ``Program.load_notes``."""
        found = next(file for file in self.files if file.data is data)
        if begin == 0 and data[:3] == UTF8_MARK:
            begin = len(UTF8_MARK)
        at = data.find(b"\n", begin + max(limit, 1) - 1)
        end = len(data) if at < 0 else at + 1
        after = line + data[begin:end].count(b"\n") + (end > begin and data[end - 1 : end] != b"\n")
        rows = found.rows[bisect_left(found.rows, (line,)) : bisect_left(found.rows, (after,))]
        collector = _Collector(data, end - begin)
        for first, last, number in found.plain:
            if first >= end:
                break
            if last > begin:
                # A range that started before this chunk continues with the chunk's first line.
                collector.plain(max(first, begin), min(last, end), max(number, line))
        return collector.notes(rows), end, after


class _Collector:
    """Columns and text that fill up, line after line. size: bytes of the range."""

    def __init__(self, data: bytes, size: int) -> None:
        self.columns = {c.name: np.empty(size // 2 + 2, np.dtype(c.dtype)) for c in NOTE.columns}
        self.text: Any = bytearray(size + 1)
        self.count = 0
        self.used = 0
        self.run = k.scan_notes.pick(size)
        self.data: Any = data
        self.out: Any = self.text
        if self.run is not k.scan_notes.python:
            self.data, self.out = np.frombuffer(data, np.uint8), np.frombuffer(self.text, np.uint8)

    def plain(self, begin: int, end: int, line: int) -> None:
        """The lines ``data[begin:end]``, all plain."""
        room: list[Any] = [*self.columns.values(), self.out]
        self.count, self.used = self.run(self.data, begin, end, line, self.count, self.used, *room)

    def notes(self, rows: list[Row]) -> Notes:
        """What was collected, and the rows of the other lines, in order."""
        columns = {name: column[: self.count].copy() for name, column in self.columns.items()}
        text = bytes(memoryview(self.text)[: self.used])
        if rows:
            sizes = [len(row[4]) for row in rows]
            begins = (np.cumsum([0, *sizes[:-1]]) + self.used).tolist()
            more = zip(
                *((*row[:4], begin, size) for row, begin, size in zip(rows, begins, sizes, strict=True)), strict=True
            )
            columns = {
                name: np.concatenate((column, np.array(cells, column.dtype)))
                for (name, column), cells in zip(columns.items(), more, strict=True)
            }
            order = np.argsort(columns["line"], kind="stable")
            columns = {name: column[order] for name, column in columns.items()}
            text += b"".join(row[4] for row in rows)
        return Notes(Columns(NOTE, columns), text)
