"""A Program that came from Eding text as Eding text again: line n stays line n, notes and order are kept.

Printed is the form of docs/fmt.md: words in upper case, one blank between them, statements and functions in lower
case, blocks indented. ``emit`` streams: tables of plain lines go through kernels piece by piece, everything else is
printed line by line.
Source: Eding manual 3.2 (lines), 4.1 (flow control), 4.2 (messages, special commands).
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import groupby

from gproof.backend.emit.eding_expressions import Unprintable, inside, setting, word
from gproof.backend.emit.eding_statements import statement_text
from gproof.backend.emit.plain_lines import plain_lines
from gproof.ir import codes
from gproof.ir.columns import Columns
from gproof.ir.finding import Refusal, Span
from gproof.ir.notes import NoteKind, Notes, joined
from gproof.ir.program import (
    WORD,
    Array,
    Block,
    BlockTable,
    DeferredBlock,
    If,
    Message,
    Mistake,
    Number,
    Program,
    Replaced,
    Statement,
    Subprogram,
    Text,
    While,
)

INDENT = 2
"""Blanks for each block around a line."""
PIECE_BYTES = 1 << 18
"""Source bytes that are read and printed at a time."""
PIECE_LINES = 1 << 16
UTF8_MARK = b"\xef\xbb\xbf"

Item = str | Block
"""What a line holds beside its notes: a statement, or words and settings."""
Note = tuple[int, int, int, int, bytes]
"""Line, place, kind, column and text of a note."""

_MESSAGE = re.compile(rb"[ \t]*m[ \t]*s[ \t]*g[ \t]*,", re.IGNORECASE)


JOB = 0
"""The file that is printed: of a macro file a Program holds the subprograms only."""


def emit(program: Program) -> Iterator[bytes]:
    """The text of the job's file, piece by piece, each of whole lines; a macro file is loaded as a job to be printed.

    The job must have been read without mistakes: a line with one is not in the Program.
    Refusal (GP702) where the Program holds what Eding has no text for.
    """
    yield from _Printer(program).run()


class _Printer:
    """Prints the lines of a file from the top; ``next`` is the first that is not printed yet."""

    def __init__(self, program: Program) -> None:
        self.program = program
        self.source = program.files[JOB]
        self.newline = self.source.newline.encode()
        self.limit = program.rules.line_length
        self.notes = _NoteReader(program)
        self.written = _Written(self.source.data)
        self.next = 1

    def run(self) -> Iterator[bytes]:
        """The file: its mark, statements and subprograms by their lines, what stands behind the last."""
        if self.source.mark:
            yield UTF8_MARK
        nodes: list[Statement | Subprogram] = [node for node in self.program.body if self._is_here(node)]
        nodes += [sub for sub in self.program.subprograms.values() if self._is_here(sub)]
        nodes.sort(key=_line)
        yield from self._body(nodes, 0)
        yield from self._gap(self.source.line_count + 1, 0)

    def _is_here(self, node: Statement | Subprogram) -> bool:
        if isinstance(node, BlockTable):
            return node.file == JOB
        if isinstance(node, DeferredBlock):
            return node.place[0] == self.source.name
        return node.span.file == self.source.name

    def _body(self, nodes: list[Statement | Subprogram], depth: int) -> Iterator[bytes]:
        for _, group in groupby(nodes, _line):
            for node, more in _with_message(list(group)):
                yield from self._node(node, depth, more)

    def _node(self, node: Statement | Subprogram, depth: int, message: Message | None) -> Iterator[bytes]:
        if isinstance(node, DeferredBlock):
            node = node.made()
        if isinstance(node, BlockTable):
            yield from self._gap(node.first_line, depth)
            yield from self._table(node, depth)
        elif isinstance(node, If):
            yield from self._line(node.span, f"if [{self._inside(node)}]", depth)
            yield from self._body(list(node.then), depth + 1)
            if node.else_span is not None or node.otherwise:
                yield from self._line(node.else_span, "else", depth, inner=1)
                yield from self._body(list(node.otherwise), depth + 1)
            yield from self._line(node.end_span, "endif", depth, inner=1)
        elif isinstance(node, While):
            yield from self._line(node.span, f"while [{self._inside(node)}]", depth)
            yield from self._body(list(node.body), depth + 1)
            yield from self._line(node.end_span, "endwhile", depth, inner=1)
        elif isinstance(node, Subprogram):
            yield from self._line(node.span, f"sub {node.name}", depth)
            yield from self._body(list(node.body), depth + 1)
            yield from self._line(node.end_span, "endsub", depth, inner=1)
        elif isinstance(node, Block):
            yield from self._line(node.span, node, depth, message=message)
        elif isinstance(node, Message) and node.in_comment:
            yield from self._line(node.span, "", depth, message=node)
        elif isinstance(node, Array | Replaced | Mistake):
            raise self._refusal(node.span, f"a statement of another controller ({type(node).__name__})")
        else:
            try:
                text = statement_text(node)
            except Unprintable as error:
                raise self._refusal(node.span, str(error)) from None
            yield from self._line(node.span, text, depth, deleted=node.deleted)

    def _inside(self, node: If | While) -> str:
        try:
            return inside(node.condition)
        except Unprintable as error:
            raise self._refusal(node.span, str(error)) from None

    def _refusal(self, span: Span, what: str) -> Refusal:
        return Refusal(codes.NOT_PRINTABLE.at(span, what=what))

    def _gap(self, line: int, depth: int) -> Iterator[bytes]:
        """The lines before ``line``: they have notes or nothing."""
        while self.next < line:
            last = min(line - 1, self.next + PIECE_LINES - 1)
            yield self._plain(self.next, last, Columns(WORD), depth)

    def _table(self, table: BlockTable, depth: int) -> Iterator[bytes]:
        begin, line = table.begin, table.first_line
        while line <= table.last_line:
            words, after, next_line = self.program.load(table, begin, line, PIECE_BYTES)
            self.written.go_on(line, begin)
            yield self._plain(line, next_line - 1, words, depth)
            begin, line = after, next_line

    def _plain(self, first: int, last: int, words: Columns, depth: int) -> bytes:
        """Lines of literal words and notes."""
        notes = self.notes.take(first, last)
        self.next = last + 1
        text, long = plain_lines(
            first, last, words, notes, indent=depth * INDENT, limit=self.limit, newline=self.source.newline
        )
        if not long:
            return text
        parts, at = [], 0
        for line, begin, end in long:
            parts += [text[at:begin], self._as_written(line, end - begin)]
            at = end
        return b"".join([*parts, text[at:]])

    def _line(
        self, span: Span | None, item: Item, depth: int, *, inner: int = 0, message: Message | None = None,
        deleted: bool = False,
    ) -> Iterator[bytes]:  # fmt: skip
        """One line with a statement or a block, after the lines before it; inner: 1 where those are in a block."""
        line = max(self.next, span.line if span is not None else 0)
        yield from self._gap(line, depth + inner)
        notes = self.notes.of_line(line)
        try:
            text = _composed(item, notes, depth * INDENT, message, deleted)
        except (Unprintable, UnicodeEncodeError) as error:
            place = span if span is not None else Span(self.source.name, line)
            raise self._refusal(place, str(error)) from None
        self.next = line + 1
        if len(text) > self.limit or _reads_otherwise(text, notes):
            text = self._as_written(line, len(text))
        yield text + self.newline

    def _as_written(self, line: int, length: int) -> bytes:
        """A line that would be too long for the controller stays as it is."""
        text = self.written.line(line)
        if text is None:
            what = f"a line of {length} characters"
            raise self._refusal(Span(self.source.name, line), what)
        return text


def _line(node: Statement | Subprogram) -> int:
    if isinstance(node, DeferredBlock):
        return node.place[1]
    return node.first_line if isinstance(node, BlockTable) else node.span.line


def _with_message(
    nodes: list[Statement | Subprogram],
) -> Iterator[tuple[Statement | Subprogram, Message | None]]:
    """The nodes of a line, the message in a comment of a block together with its block."""
    waiting: Message | None = None
    for node in nodes:
        if isinstance(node, Block):
            yield node, waiting
            waiting = None
            continue
        if waiting is not None:
            yield waiting, None
            waiting = None
        if isinstance(node, Message) and node.in_comment and node is not nodes[-1]:
            waiting = node
        else:
            yield node, None


def _composed(item: Item, notes: list[Note], indent: int, message: Message | None, deleted: bool) -> bytes:
    """The text of a line, without its end. deleted: it begins with a slash, whatever its notes say."""
    if not notes and not deleted and isinstance(item, str) and message is None:
        return (" " * indent + item).encode()
    encoding = next((text.decode() for _, _, kind, _, text in notes if kind == NoteKind.ENCODING), "utf-8")
    numbers = [b"N" + text for _, _, kind, _, text in notes if kind == NoteKind.LINE_NUMBER]
    comments = [note[1:] for note in notes if note[2] in (NoteKind.COMMENT, NoteKind.REMARK)]
    if message is not None and not _has_message(comments):
        shown = "".join(part.value for part in message.parts if isinstance(part, Text))
        comments.insert(0, (0, NoteKind.COMMENT, 0, f"MSG, {shown}".encode(encoding)))
    deleted = deleted or any(kind == NoteKind.DELETE for _, _, kind, _, _ in notes)
    if isinstance(item, Block):
        deleted = deleted or item.deleted
        items = _items(item, _has_message(comments))
        if not notes and item.comment:
            comments.append((len(items), NoteKind.COMMENT, 0, item.comment.encode(encoding)))
    else:
        items = [item] if item else []
    line = b" " * indent + b"/" * deleted + b" ".join(numbers)
    begun = bool(numbers)
    pieces = [(place + 0.5, 0, text.encode(encoding)) for place, text in enumerate(items)]
    pieces += [(place, column, _delimited(kind, text)) for place, kind, column, text in comments]
    pieces.sort(key=lambda piece: piece[0])
    for place, column, text in pieces:
        if begun:
            line += b" "
            line = line.ljust(column if 0 < len(items) <= place else 0)
        line += text
        begun = True
    return line


def _reads_otherwise(text: bytes, notes: list[Note]) -> bool:
    """Whether a line that was not UTF-8 would be taken for it now, its curly quotes being gone."""
    if not any(kind == NoteKind.ENCODING for _, _, kind, _, _ in notes):
        return False
    try:
        text.decode("utf-8")
    except UnicodeDecodeError:
        return False
    return True


def _delimited(kind: int, text: bytes) -> bytes:
    return b"(" + text + b")" if kind == NoteKind.COMMENT else b";" + text


def _has_message(comments: list[tuple[int, int, int, bytes]]) -> bool:
    return any(kind == NoteKind.COMMENT and _MESSAGE.match(text) for _, kind, _, text in comments)


def _items(block: Block, has_message: bool) -> list[str]:
    """Words and settings in the order of the source.

    A block of numbers alone would be a plain line, which is another node: one of its numbers is in brackets.
    """
    words, grouped = list(block.words), []
    if not has_message and not block.assigns and all(isinstance(w.value, Number) for w in words):
        grouped = [w for w in words if w.span.end_column > w.value.span.end_column] or words[:1]
    texts = [(w.span.column, word(w, grouped=any(w is g for g in grouped))) for w in words]
    texts += [(a.span.column, setting(a)) for a in block.assigns]
    return [text for _, text in sorted(texts, key=lambda pair: pair[0])]


class _NoteReader:
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
        """The notes of one line, and of the next ones when asked for one after the other."""
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


class _Written:
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
