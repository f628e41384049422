"""The notes of a WinCNC file, read from its bytes when somebody prints it (manual: Comment, comchars=, skipchars=).

Comments are at the end of a line. They are kept with the signs that start and end them, since a closing bracket may
be left out and a machine may have signs of its own. Lines that the controller leaves out are notes too.
Plain lines go through a kernel, the others through ``line_notes``.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from gproof.frontend.common.source import UTF8_MARK, encoding_of
from gproof.frontend.common.words import WordBytes
from gproof.frontend.wincnc import scan_kernels as k
from gproof.frontend.wincnc.line import LineError, LineReader, line_number
from gproof.frontend.wincnc.scan import CLOSING, Scanner, word_bytes_of
from gproof.ir.columns import Columns
from gproof.ir.dialects.wincnc.settings import Lexical
from gproof.ir.notes import NOTE, NoteKind, Notes
from gproof.ir.record import record

Found = tuple[int, NoteKind, int, bytes]
"""Place, kind, column and text of a note."""


def skip_count(text: str, lexical: Lexical) -> int:
    """How many lines are left out where a line starts like this one, itself counted; 0: none."""
    first = text[:1].upper()
    return next((count for signs, count in lexical.skips if first and first in signs.upper()), 0)


@record(frozen=True, slots=True)
class Annotator:
    """Reads notes with the settings of one machine. limit: bytes that a plain line may have."""

    scanner: Scanner
    reader: LineReader
    limit: int

    def annotate(self, data: bytes, begin: int, line: int, limit: int) -> tuple[Notes, int, int]:
        """Notes of the lines from byte ``begin``, which starts line ``line``; see ``Program.load_notes``.

        Stops at the first line end at or after ``begin + limit`` whose next line is not left out.
        """
        if begin == 0 and data[:3] == UTF8_MARK:
            begin = len(UTF8_MARK)
        at = data.find(b"\n", begin + max(limit, 1) - 1)
        end = len(data) if at < 0 else at + 1
        found = self.scanner.index(data, begin, self.limit, end)
        collector = _Collector(data, end - begin, word_bytes_of(self.scanner.lexical))
        number, first_line, after_line = line, line, line + found.line_count
        for offset, first, after, _ in found.rows():
            if first < begin:
                continue
            collector.plain(begin, first, number)
            number, begin = first_line + offset, after
            raw = data[first:after].rstrip(b"\r\n")
            text = raw.decode(encoding_of(raw))
            collector.special(number - 1, self.line_notes(raw, text))
            for _ in range(skip_count(text, self.scanner.lexical) - 1):
                if begin >= len(data):
                    break
                begin = _left_out(collector, data, begin, number)
                number += 1
        if begin >= end:
            return collector.notes(), begin, number
        collector.plain(begin, end, number)
        return collector.notes(), end, after_line

    def line_notes(self, raw: bytes, text: str) -> list[Found]:
        """The notes of a line that is not plain; text: ``raw`` decoded."""
        encoding = encoding_of(raw)
        found: list[Found] = [] if encoding == "utf-8" else [(0, NoteKind.ENCODING, 0, encoding.encode())]
        if skip_count(text, self.scanner.lexical):
            return found
        try:
            code, _ = self.reader.cut(text)
        except LineError:
            return [(0, NoteKind.LEFT_OUT, 0, raw.rstrip(b" \t\r"))]
        if not code.strip(" \t") and len(raw) > self.limit:
            return [(0, NoteKind.LEFT_OUT, 0, raw.rstrip(b" \t\r"))]
        number = line_number(code) if self.reader.numbered else None
        if number is not None:
            found.append((0, NoteKind.LINE_NUMBER, 0, number[1].encode()))
        return found + comments(text, len(code), encoding)


def comments(text: str, at: int, encoding: str) -> list[Found]:
    """The comments of a line, the first of which starts at ``at``."""
    found: list[Found] = []
    place = int(bool(text[:at].strip(" \t")))
    while at < len(text):
        closing = CLOSING.get(text[at])
        end = text.find(closing, at + 1) + 1 if closing is not None else 0
        written = text[at:end] if end > 0 else text[at:].rstrip(" \t\r")
        column = _column(text[:at].encode(encoding)) if place else 0
        found.append((place, NoteKind.SIGNED, column, written.encode(encoding)))
        at = end if end > 0 else len(text)
        at += len(text[at:]) - len(text[at:].lstrip(" \t"))
    return found


def _column(before: bytes) -> int:
    """The column after ``before``, when it ends in more than one blank, else 0; see NOTE."""
    column = len(before.expandtabs(8))
    return column if column - len(before.rstrip(b" \t").expandtabs(8)) > 1 else 0


def _left_out(collector: _Collector, data: bytes, begin: int, line: int) -> int:
    """Take a line that is left out; where the next one starts."""
    at = data.find(b"\n", begin)
    after = len(data) if at < 0 else at + 1
    raw = data[begin:after].rstrip(b"\n").rstrip(b" \t\r")
    if raw:
        collector.special(line, [(0, NoteKind.LEFT_OUT, 0, raw)])
    return after


class _Collector:
    """Columns and text that fill up, line after line. size: bytes of the range."""

    def __init__(self, data: bytes, size: int, table: WordBytes) -> None:
        self.columns = {c.name: np.empty(size // 2 + 2, np.dtype(c.dtype)) for c in NOTE.columns}
        self.text: Any = bytearray(size + 1)
        self.count = 0
        self.used = 0
        self.rows: list[tuple[int, int, int, int, int, int]] = []
        self.more = bytearray()
        self.run = k.scan_notes.pick(size)
        self.data: Any = data
        self.out: Any = self.text
        self.kinds: Any = table.kinds
        if self.run is not k.scan_notes.python:
            self.data, self.out = np.frombuffer(data, np.uint8), np.frombuffer(self.text, np.uint8)
            self.kinds = table.array

    def plain(self, begin: int, end: int, line: int) -> None:
        """The lines ``data[begin:end]``, all plain."""
        if begin < end:
            room: list[Any] = [*self.columns.values(), self.out]
            self.count, self.used = self.run(self.data, begin, end, line, self.kinds, self.count, self.used, *room)

    def special(self, line: int, found: list[Found]) -> None:
        """The notes of a line that is not plain."""
        for place, kind, column, text in found:
            self.rows.append((line, place, kind, column, len(self.more), len(text)))
            self.more += text

    def notes(self) -> Notes:
        """What was collected, in order."""
        columns = {name: column[: self.count].copy() for name, column in self.columns.items()}
        text = bytes(memoryview(self.text)[: self.used])
        if self.rows:
            rows = zip(columns.items(), zip(*self.rows, strict=True), strict=True)
            columns = {name: np.concatenate((column, np.array(cells, column.dtype))) for (name, column), cells in rows}
            columns["begin"][self.count :] += self.used
            order = np.argsort(columns["line"], kind="stable")
            columns = {name: column[order] for name, column in columns.items()}
        return Notes(Columns(NOTE, columns), text + bytes(self.more))
