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

from gproof.backend.emit.eding.expressions import inside, setting, word
from gproof.backend.emit.eding.statements import statement_text
from gproof.backend.emit.line_printer import JOB, UTF8_MARK, LinePrinter, Note, padded
from gproof.backend.emit.printer import Unprintable
from gproof.ir.finding import Span
from gproof.ir.notes import NoteKind
from gproof.ir.program import (
    Array,
    Block,
    BlockTable,
    Declare,
    DeferredBlock,
    Definition,
    For,
    If,
    Include,
    Jump,
    Label,
    Message,
    Mistake,
    Mode,
    Number,
    Program,
    Repeat,
    Replaced,
    Return,
    Statement,
    Subprogram,
    Text,
    While,
)

INDENT = 2
"""Blanks for each block around a line."""

Item = str | Block
"""What a line holds apart from its notes: a statement, or words and settings."""

_MESSAGE = re.compile(rb"[ \t]*m[ \t]*s[ \t]*g[ \t]*,", re.IGNORECASE)


def emit(program: Program) -> Iterator[bytes]:
    """The text of the job's file, piece by piece, each of whole lines; a macro file is loaded as a job to be printed.

    The job must have been read without mistakes: a line with one is not in the Program.
    Refusal (GP702) where the Program holds what Eding has no text for.
    """
    yield from _Printer(program).run()


class _Printer(LinePrinter):
    """Prints an Eding program."""

    def run(self) -> Iterator[bytes]:
        """The file: its mark, statements and subprograms by their lines, what comes after the last."""
        if self.source.mark:
            yield UTF8_MARK
        nodes: list[Statement | Subprogram] = [node for node in self.program.body if self._is_here(node)]
        nodes += [sub for sub in self.program.subprograms.values() if self._is_here(sub)]
        nodes.sort(key=_line)
        yield from self._body(nodes, 0)
        yield from self.gap(self.source.line_count + 1)

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
            yield from self.table(node, depth * INDENT)
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
        elif isinstance(
            node,
            Array | Replaced | Definition | Mistake | Repeat | For | Label | Jump | Return | Declare | Include | Mode,
        ):
            raise self.refusal(node.span, f"a statement of another controller ({type(node).__name__})")
        else:
            try:
                text = statement_text(node)
            except Unprintable as error:
                raise self.refusal(node.span, str(error)) from None
            yield from self._line(node.span, text, depth, deleted=node.deleted)

    def _inside(self, node: If | While) -> str:
        try:
            return inside(node.condition)
        except Unprintable as error:
            raise self.refusal(node.span, str(error)) from None

    def _line(
        self, span: Span | None, item: Item, depth: int, *, inner: int = 0, message: Message | None = None,
        deleted: bool = False,
    ) -> Iterator[bytes]:  # fmt: skip
        """One line with a statement or a block, after the lines before it; inner: 1 where those are in a block."""
        line = max(self.next, span.line if span is not None else 0)
        yield from self.gap(line, (depth + inner) * INDENT)
        notes = self.notes.of_line(line)
        try:
            text = _composed(item, notes, depth * INDENT, message, deleted)
        except (Unprintable, UnicodeEncodeError) as error:
            place = span if span is not None else Span(self.source.name, line)
            raise self.refusal(place, str(error)) from None
        self.next = line + 1
        if len(text) > self.limit or _reads_otherwise(text, notes):
            text = self.as_written(line, len(text))
        yield text + self.newline


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
    """The text of a line, without its end. deleted: it starts with a slash, whatever its notes say."""
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
            line = padded(line, column if 0 < len(items) <= place else 0)
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
