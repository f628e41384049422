"""What printers of every dialect share: the lines of the job's file from the top, tables and gaps piece by piece.

A printer gives the text of the lines that have statements; plain lines go through kernels, and lines that have to stay
as they are come from the source.
"""

from __future__ import annotations

from collections.abc import Iterator

from gproof.backend.emit.plain_lines import plain_lines
from gproof.ir import codes
from gproof.ir.columns import Columns
from gproof.ir.finding import Refusal, Span
from gproof.ir.notes import Notes, joined
from gproof.ir.program import WORD, BlockTable, Program

PIECE_BYTES = 1 << 18
"""Source bytes that are read and printed at a time."""
PIECE_LINES = 1 << 16
UTF8_MARK = b"\xef\xbb\xbf"

JOB = 0
"""The file that is printed: of a macro file a Program holds the subprograms only."""

Note = tuple[int, int, int, int, bytes]
"""Line, place, kind, column and text of a note."""


def padded(line: bytes, column: int) -> bytes:
    """A line with blanks up to a column; tabs in its texts go to the next multiple of 8, as NOTE counts them."""
    return line + b" " * (column - len(line.expandtabs(8)))


class LinePrinter:
    """Prints the lines of a file from the top; ``next`` is the first that is not printed yet.

    kept: bytes with which no line may start that did not start so: it stays as it is. two_digits: G codes of plain
    lines have two digits at least.
    """

    two_digits = False

    def __init__(self, program: Program, kept: bytes = b"") -> None:
        self.program = program
        self.source = program.files[JOB]
        self.newline = self.source.newline.encode()
        self.limit = program.rules.line_length
        self.notes = NoteReader(program)
        self.written = Written(self.source.data)
        self.kept = kept
        self.next = 1

    def refusal(self, span: Span, what: str) -> Refusal:
        """GP702: there is no text for something."""
        return Refusal(codes.NOT_PRINTABLE.at(span, what=what))

    def gap(self, line: int, indent: int = 0) -> Iterator[bytes]:
        """The lines before ``line``: they have notes or nothing. indent: blanks before each of them."""
        while self.next < line:
            last = min(line - 1, self.next + PIECE_LINES - 1)
            yield self.plain(self.next, last, Columns(WORD), indent)

    def table(self, table: BlockTable, indent: int = 0) -> Iterator[bytes]:
        """The lines before a table, and its own."""
        yield from self.gap(table.first_line, indent)
        begin, line = table.begin, table.first_line
        while line <= table.last_line:
            words, after, next_line = self.program.load(table, begin, line, PIECE_BYTES)
            self.written.go_on(line, begin)
            yield self.plain(line, next_line - 1, words, indent)
            begin, line = after, next_line

    def plain(self, first: int, last: int, words: Columns, indent: int, notes: Notes | None = None) -> bytes:
        """Lines of literal words and notes; notes: theirs, when they are taken already."""
        notes = self.notes.take(first, last) if notes is None else notes
        self.next = last + 1
        text, kept = plain_lines(
            first,
            last,
            words,
            notes,
            indent=indent,
            limit=self.limit,
            newline=self.source.newline,
            kept=self.kept,
            two_digits=self.two_digits,
        )
        if not kept:
            return text
        parts, at = [], 0
        for line, begin, end in kept:
            parts += [text[at:begin], self.as_written(line, end - begin)]
            at = end
        return b"".join([*parts, text[at:]])

    def as_written(self, line: int, length: int) -> bytes:
        """A line that would be too long for the controller, or have another meaning, stays as it is."""
        text = self.written.line(line)
        if text is None:
            raise self.refusal(Span(self.source.name, line), f"a line of {length} characters")
        return text


class NoteReader:
    """The notes of the job, line after line."""

    def __init__(self, program: Program) -> None:
        self.program = program
        self.held: list[Notes] = []
        self.rows: list[Note] | None = None
        self.row = 0
        self.begin = 0
        self.line = 1

    def take(self, first: int, last: int) -> Notes:
        """The notes of the lines first..last; those before are dropped."""
        self._read(last)
        found = joined([notes.lines(first, last) for notes in self.held])
        self.held = [notes for notes in self.held if len(notes.table) and int(notes.table["line"][-1]) > last]
        return found

    def of_line(self, line: int) -> list[Note]:
        """The notes of one line, and of the next ones when requested one after the other."""
        self._read(line)
        if self.rows is None:
            self.held = [notes for notes in self.held if len(notes.table) and int(notes.table["line"][-1]) >= line]
            self.rows = [note for notes in self.held for note in notes.lines(line, self.line)]
            self.row = 0
        while self.row < len(self.rows) and self.rows[self.row][0] < line:
            self.row += 1
        begin = self.row
        while self.row < len(self.rows) and self.rows[self.row][0] == line:
            self.row += 1
        return self.rows[begin : self.row]

    def _read(self, last: int) -> None:
        """Have the notes of the lines up to ``last``, or to the end of the file."""
        count = self.program.files[JOB].line_count
        while self.line <= min(last, count):
            notes, self.begin, self.line = self.program.load_notes(JOB, self.begin, self.line, PIECE_BYTES)
            self.held.append(notes)
            self.rows = None


class Written:
    """The lines of the source, read from the top."""

    def __init__(self, data: bytes) -> None:
        self.data = data
        self.at_line = 1
        self.at = len(UTF8_MARK) if data[:3] == UTF8_MARK else 0

    def go_on(self, line: int, begin: int) -> None:
        """Byte ``begin`` starts line ``line``."""
        self.at_line, self.at = line, begin

    def line(self, line: int) -> bytes | None:
        """A line without its end, or None when there is no source."""
        if not self.data:
            return None
        while self.at_line < line:
            self.at = self.data.find(b"\n", self.at) + 1
            self.at_line += 1
        end = self.data.find(b"\n", self.at)
        return self.data[self.at : end if end >= 0 else len(self.data)].removesuffix(b"\r")
