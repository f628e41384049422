"""The notes of an Eding file, read from its bytes when somebody prints it (Eding manual 3.2.1, 3.2.4).

Plain lines go through a kernel, the others through ``line_notes``. Both leave out blanks at the end of a line and
those between the digits of a line number; everything else of a comment is kept, byte for byte.
"""

from __future__ import annotations

import re
from typing import Any

import numpy as np

from gproof.frontend.common.source import UTF8_MARK, encoding_of
from gproof.frontend.eding import scan_kernels as k
from gproof.frontend.eding.prepare import FUNCTIONS, PIECE, LineError, prepare
from gproof.frontend.eding.scan import index
from gproof.ir.columns import Columns
from gproof.ir.dialects.eding.rules import EDING
from gproof.ir.notes import NOTE, NoteKind, Notes

_PREFIX = re.compile(r"(/?)(?:[nN]([0-9]+))?")


def annotate(data: bytes, begin: int, line: int, limit: int) -> tuple[Notes, int, int]:
    """Notes of the lines from byte ``begin``, which starts line ``line``; see ``Program.load_notes``.

    Stops at the first line end at or after ``begin + limit``.
    """
    if begin == 0 and data[:3] == UTF8_MARK:
        begin = len(UTF8_MARK)
    at = data.find(b"\n", begin + max(limit, 1) - 1)
    end = len(data) if at < 0 else at + 1
    found = index(data, begin, EDING.line_length, end)
    collector = _Collector(data, end - begin, 2 * len(found.line))
    number = line
    columns = (found.line, found.begin, found.end)
    for offset, first, after in zip(*(c.tolist() for c in columns), strict=True):
        collector.plain(begin, first, number)
        collector.special(line + offset - 1, data[first:after].rstrip(b"\r\n"))
        number, begin = line + offset, after
    collector.plain(begin, end, number)
    return collector.notes(), end, line + found.line_count


class _Collector:
    """Columns and text that fill up, line after line.

    size: bytes of the range; more: notes that lines which are not plain may have beyond one for two bytes.
    """

    def __init__(self, data: bytes, size: int, more: int) -> None:
        room = size // 2 + 2 + more
        self.columns = {c.name: np.empty(room, np.dtype(c.dtype)) for c in NOTE.columns}
        self.text: Any = bytearray(size + 16 * more)
        self.count = 0
        self.used = 0
        self.run = k.scan_notes.pick(size)
        self.data: Any = data
        self.out: Any = self.text
        if self.run is not k.scan_notes.python:
            self.data, self.out = np.frombuffer(data, np.uint8), np.frombuffer(self.text, np.uint8)

    def plain(self, begin: int, end: int, line: int) -> None:
        """The lines ``data[begin:end]``, all plain."""
        if begin < end:
            room: list[Any] = [*self.columns.values(), self.out]
            self.count, self.used = self.run(self.data, begin, end, line, self.count, self.used, *room)

    def special(self, line: int, raw: bytes) -> None:
        """A line that is not plain."""
        for place, kind, column, text in line_notes(raw):
            row = (line, place, kind, column, self.used, len(text))
            for cells, value in zip(self.columns.values(), row, strict=True):
                cells[self.count] = value
            self.text[self.used : self.used + len(text)] = text
            self.used += len(text)
            self.count += 1

    def notes(self) -> Notes:
        """What was collected, cut to size."""
        columns = {name: column[: self.count].copy() for name, column in self.columns.items()}
        return Notes(Columns(NOTE, columns), bytes(memoryview(self.text)[: self.used]))


Found = tuple[int, NoteKind, int, bytes]
"""Place, kind, column and text of a note."""


def line_notes(raw: bytes) -> list[Found]:
    """The notes in a line; none for a line with a mistake."""
    if raw.isascii() and b"(" not in raw and b";" not in raw and raw.lstrip()[:1] not in (b"/", b"n", b"N"):
        return []
    encoding = encoding_of(raw)
    text = raw.decode(encoding)
    try:
        line = prepare(text)
    except LineError:
        return []
    comments: list[Found] = []
    code = ""
    for piece in PIECE.finditer(text):
        kind, at = piece.lastgroup, piece.start()
        if kind in ("comment", "rest"):
            place = int(at > line.keyword_at) if line.keyword else count_items(code)
            column = _column(text[:at].encode(encoding)) if place else 0
            if kind == "comment":
                comments.append((place, NoteKind.COMMENT, column, piece.group()[1:-1].encode(encoding)))
            else:
                comments.append((place, NoteKind.REMARK, column, piece.group()[1:].rstrip(" \t").encode(encoding)))
        elif kind != "blank":
            code += piece.group()
    found: list[Found] = []
    if encoding != "utf-8":
        found.append((0, NoteKind.ENCODING, 0, encoding.encode()))
    prefix = _PREFIX.match(code)
    assert prefix is not None
    if prefix[1]:
        found.append((0, NoteKind.DELETE, 0, b""))
    if prefix[2]:
        found.append((0, NoteKind.LINE_NUMBER, 0, prefix[2].encode()))
    return found + comments


def _column(before: bytes) -> int:
    """The column after ``before``, when it ends in more than one blank, else 0; see NOTE."""
    column = len(before.expandtabs(8))
    return column if column - len(before.rstrip(b" \t").expandtabs(8)) > 1 else 0


def count_items(code: str) -> int:
    """How many words and parameter settings the code of a line has (blanks and comments left out)."""
    prefix = _PREFIX.match(code)
    assert prefix is not None
    at, count = prefix.end(), 0
    while at < len(code):
        begin = at
        if code[at].isalpha():
            at = _value_end(code, at + 1)
        elif code[at] == "#":
            at = _value_end(code, at + 1)
            at = _value_end(code, at + 1) if code[at : at + 1] == "=" else at
        if at == begin:
            break
        count += 1
    return count


_NUMBER = re.compile(r"[-+]?[0-9.]*")
_PARAMETER = re.compile(r"[-+]?#")
_NAME = re.compile(r"[-+]?([a-z]+)(?=\[)", re.IGNORECASE | re.ASCII)


def _value_end(code: str, at: int) -> int:
    """After the value that starts at ``at``; of any number of ``#`` before it, without the stack of Python."""
    while found := _PARAMETER.match(code, at):
        at = found.end()
    name = _NAME.match(code, at)
    if name and name[1].lower() in FUNCTIONS:
        after = _bracket_end(code, name.end())
        if name[1].lower() == "atan" and code[after : after + 1] == "/":
            after = _bracket_end(code, after + 1)
        return after
    sign = code[at : at + 1] in ("+", "-")
    if code[at + sign : at + sign + 1] == "[":
        return _bracket_end(code, at + sign)
    number = _NUMBER.match(code, at)
    assert number is not None
    return number.end()


def _bracket_end(code: str, at: int) -> int:
    """After the bracket that closes the one at ``at``."""
    depth = 0
    for i in range(at, len(code)):
        depth += (code[i] == "[") - (code[i] == "]")
        if depth == 0:
            return i + 1
    return len(code)
