"""A Program that came from a McuWIN file as text again: line n stays line n, comments and order are kept.

Printed is the form of docs/fmt.md: words in upper case, one blank between them, codes of two digits as the manual has
them. Tables of plain lines go through kernels piece by piece; other lines are printed one by one. Expressions and lines
of rw_SymPas keep their words (``pascal_words.py``): whether names in another case are the same, and what brackets
are, the manual leaves to the machine. Source: McuWIN manual 3 to 12.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from gproof.backend.emit.line_printer import JOB, PIECE_LINES, UTF8_MARK, LinePrinter, Note, padded
from gproof.backend.emit.mcuwin.parts import WrittenParts
from gproof.backend.emit.mcuwin.pascal_words import (
    PascalWord,
    SectionLayout,
    Spelling,
    block_change,
    declared_names,
    joined_words,
    leaves_open,
    words_of,
)
from gproof.backend.emit.printer import Unprintable
from gproof.ir.columns import Columns
from gproof.ir.dialects.mcuwin.settings import McuWinSettings
from gproof.ir.finding import Span
from gproof.ir.notes import NoteKind, Notes
from gproof.ir.program import (
    WORD,
    BlockTable,
    Declare,
    DeferredBlock,
    For,
    If,
    Mistake,
    Program,
    Repeat,
    Statement,
    Unsupported,
    While,
)

LINE_LIMIT = 1000
"""Characters of a line that is read as a plain one at most: no line becomes longer, or shorter, than that."""
INDENT = "  "

_NUMBERED = re.compile(r"[ \t]*(?:[Nn][ \t]*(?P<digits>[0-9]+)[ \t]*)?", re.ASCII)


def emit(program: Program, din: McuWinSettings, *, as_is: frozenset[int] = frozenset()) -> Iterator[bytes]:
    """The text of the program's own file, piece by piece, each of whole lines.

    din: settings of the machine that the file was read with; as_is: lines that stay as they are. The file must have
    been read alone, the other lines without mistakes: one with a mistake is not in the Program. Refusal (GP702) where
    the Program holds what McuWIN has no text for.
    """
    yield from _Printer(program, din, as_is).run()


class _Printer(LinePrinter):
    two_digits = True

    def __init__(self, program: Program, din: McuWinSettings, as_is: frozenset[int]) -> None:
        super().__init__(program)
        self.limit = LINE_LIMIT
        self.depth = 0
        self.section: SectionLayout | None = None
        self.section_line = 0
        self.opened = False
        self.untouched = as_is
        self.as_is: set[int] = set()
        names: list[str] = []
        for node in self._statements():
            if isinstance(node, Declare):
                names += node.names
            elif isinstance(node, Unsupported) and node.text and node.span.file == self.source.name:
                self.as_is.add(node.span.line)
            elif isinstance(node, Mistake) and node.span.file == self.source.name:
                self.untouched |= {node.span.line}
        for sub in program.subprograms.values():
            names += [sub.text or sub.name, *(name for name, _, _ in sub.parameters)]
        known = declared_names(names) if din.case_sensitive is False else None
        self.spelling = Spelling(keeps=bool(din.case_sensitive), declared=known)

    def _statements(self) -> Iterator[Statement]:
        """Every statement of the file, of its procedures too."""
        yield from _flat(self.program.body)
        for sub in self.program.subprograms.values():
            yield from _flat(sub.body)

    def run(self) -> Iterator[bytes]:
        """The file: its mark, its lines, what comes after the last."""
        if self.source.mark:
            yield UTF8_MARK
        line: list[Statement] = []
        for node in _flat(self.program.body):
            if isinstance(node, BlockTable):
                if node.file == JOB:
                    yield from self._line(line)
                    line = []
                    yield from self.gap(node.first_line)
                    yield from self.table(node, len(INDENT) * self.depth)
                continue
            span = node.span
            if span.file != self.source.name or span.line < self.next:
                continue
            if line and _span(line[0]).line != span.line:
                yield from self._line(line)
                line = []
            line.append(node)
        yield from self._line(line)
        yield from self.gap(self.source.line_count + 1)

    def gap(self, line: int, indent: int = 0) -> Iterator[bytes]:
        """The lines before ``line``: they have notes, rw_SymPas or nothing."""
        while self.next < line:
            last = min(line - 1, self.next + PIECE_LINES - 1)
            notes = self.notes.take(self.next, last)
            kinds, numbers = notes.table["kind"], notes.table["line"]
            pascal = set(numbers[kinds == NoteKind.PASCAL].tolist())
            for number in sorted(pascal.union(n for n in self.untouched if self.next <= n <= last)):
                yield from self._quiet(number - 1, notes)
                text = self._pascal(number, list(notes.lines(number, number))) if number in pascal else b""
                whole = self._written(Span(self.source.name, number)) if number in self.untouched else text
                yield whole + self.newline
                self.next = number + 1
            yield from self._quiet(last, notes)

    def _quiet(self, last: int, notes: Notes) -> Iterator[bytes]:
        """Lines up to ``last`` without statements."""
        if self.next > last:
            return
        found = notes.lines(self.next, last)
        if (found.table["kind"] == NoteKind.MARK).any():
            self.depth = 0
        yield self.plain(self.next, last, Columns(WORD), len(INDENT) * self.depth, found)

    def _line(self, nodes: Sequence[Statement]) -> Iterator[bytes]:
        """One line of words, after the lines before it."""
        if not nodes or _span(nodes[0]).line < self.next:
            return
        span = _span(nodes[0])
        yield from self.gap(span.line)
        notes = self.notes.of_line(span.line)
        if any(kind == NoteKind.PASCAL for _, _, kind, _, _ in notes):
            return  # printed among the lines between those of words
        written = self._written(span)
        encoding = _encoding(notes)
        text = written.decode(encoding)
        found = WrittenParts(text, self.spelling)
        try:
            items = [item for node in sorted(nodes, key=lambda n: _span(n).column) for item in found.parts(node)]
        except Unprintable as error:
            raise self.refusal(span, str(error)) from error
        self.next = span.line + 1
        out = _composed(INDENT * self.depth, items, notes, encoding)
        if found.stays or len(out) > self.limit or len(written) > self.limit:
            out = written.rstrip(b" \t")
            if len(out) <= self.limit < len(written):
                out = written  # without the blanks at its end it would be a plain line
        yield (written if span.line in self.untouched else out) + self.newline

    def _written(self, span: Span) -> bytes:
        written = self.written.line(span.line)
        if written is None:
            raise self.refusal(span, "a program without its source")
        return written

    def as_written(self, line: int, length: int) -> bytes:
        """As it is in the source, without blanks at its end."""
        return super().as_written(line, length).rstrip(b" \t")

    # rw_SymPas

    def _pascal(self, line: int, notes: list[Note]) -> bytes:
        """A line of rw_SymPas, without its end."""
        encoding = _encoding(notes)
        written = self._written(Span(self.source.name, line))
        text = written.decode(encoding).rstrip(" \t")
        if self.section is not None and self.section_line != line - 1:
            self.section = None
        if self.section is None:
            self.opened = False
            found = _NUMBERED.match(text)
            assert found is not None
            if text.startswith("$", found.end()):
                return self._dollar(line, text, found.end(), found["digits"], encoding)
            self.section = SectionLayout(self.depth)
        self.section_line = line
        words = list(words_of(text, opened=self.opened))
        in_comment = self.opened
        self.opened = leaves_open(words)
        code = [word for word in words if word.kind != "comment"]
        indent = self.section.indent([word for word in code if word.kind != "sign"])
        sign = next((n for n, word in enumerate(code) if word.kind == "sign"), None)
        if sign is not None:
            self.section = None
            indent = self.depth if sign == 0 else indent
        stays = line in self.as_is or (sign is not None and code[sign].end < len(text))
        if in_comment:
            return (text if stays else self._with_comments("", words, text, encoding)).encode(encoding)
        head = INDENT * indent if words else ""
        body = head + text.strip(" \t") if stays else self._with_comments(head, words, text, encoding)
        return body.encode(encoding)

    def _dollar(self, line: int, text: str, at: int, digits: str | None, encoding: str) -> bytes:
        """A line whose ``$`` is at ``at``; digits: of its number."""
        words = list(words_of(text, at))
        code = [word for word in words if word.kind != "comment"]
        closes, opens = block_change([word for word in code if word.text != "$"])
        self.depth = max(0, self.depth - closes)
        head = INDENT * self.depth + (f"N{digits} " if digits is not None else "")
        self.depth += opens
        if code[0].kind == "sign":
            self.section, self.section_line = SectionLayout(self.depth), line
            self.section.indent(code[1:])
            self.opened = leaves_open(words)
            if any(word.kind == "sign" for word in code[1:]):
                self.section = None
                return (head + text[at:]).encode(encoding)
        if line in self.as_is:
            return (head + text[at:]).encode(encoding)
        return self._with_comments(head, words, text, encoding).encode(encoding)

    def _with_comments(self, head: str, words: Sequence[PascalWord], text: str, encoding: str) -> str:
        """Words and comments in their order; a comment that is set apart keeps its column."""
        out, run, has_code = head, [], False
        for word in [*words, None]:
            if word is not None and word.kind != "comment":
                run.append(word)
                continue
            if run:
                gap = " " if out.strip(" \t") and out[-1:] != " " else ""
                out += gap + joined_words(run, self.spelling)
                run, has_code = [], True
            if word is None:
                break
            if out.strip(" \t"):
                out = out if out[-1:] == " " else out + " "
                column = _column(text[: word.begin].encode(encoding)) if has_code else 0
                out = padded(out.encode(encoding), column).decode(encoding)
            out += word.text
        return out


def _flat(body: Sequence[Statement]) -> Iterator[Statement]:
    """Statements in the order of the source, those of blocks in the place of them."""
    for node in body:
        if isinstance(node, DeferredBlock):
            node = node.made()
        if isinstance(node, If):
            yield from _flat(node.then)
            yield from _flat(node.otherwise)
        elif isinstance(node, While | Repeat | For):
            yield from _flat(node.body)
        else:
            yield node


def _span(node: Statement) -> Span:
    assert not isinstance(node, BlockTable)
    return node.span


def _encoding(notes: Sequence[Note]) -> str:
    return next((note.decode() for _, _, kind, _, note in notes if kind == NoteKind.ENCODING), "utf-8")


def _column(before: bytes) -> int:
    """Of a comment after these bytes, when more than one blank sets it apart, else 0; as in NOTE."""
    column = len(before.expandtabs(8))
    return column if column - len(before.rstrip(b" \t").expandtabs(8)) > 1 else 0


def _composed(indent: str, items: Sequence[str], notes: Sequence[Note], encoding: str) -> bytes:
    """The parts of a line with its notes among them, each after as many parts as it had before it."""
    out, place = b"", 0
    for _, at, kind, column, note in notes:
        if kind == NoteKind.ENCODING:
            continue
        out = _joined(out, " ".join(items[place : max(at, place)]).encode(encoding))
        place = max(at, place)
        if kind == NoteKind.LINE_NUMBER:
            out = _joined(out, b"N" + note)
        elif kind == NoteKind.MARK:
            out = _joined(out, b"%" + note)
        elif out:
            lead = len(indent)
            out = padded(b" " * lead + out + b" ", column)[lead:] + note
        else:
            out = note
    out = _joined(out, " ".join(items[place:]).encode(encoding))
    return indent.encode() + out


def _joined(left: bytes, right: bytes) -> bytes:
    return left + b" " + right if left and right else left or right
