"""A Program that came from a WinCNC file as text again: line n stays line n, comments and order are kept.

Printed is the form of docs/fmt.md: words in upper case, one blank between them. ``emit`` streams: tables of plain lines
go through kernels piece by piece, everything else is printed line by line.
Source: WinCNC manual, Command Reference (lines, texts, braces, comments), Macro File Configuration.
"""

from __future__ import annotations

from collections.abc import Iterator

from gproof.backend.emit.line_printer import JOB, UTF8_MARK, LinePrinter, Note, padded
from gproof.backend.emit.numbers import number_text
from gproof.ir.dialects.wincnc.settings import Lexical
from gproof.ir.finding import Span
from gproof.ir.notes import NoteKind
from gproof.ir.program import (
    Array,
    Binary,
    Block,
    BlockTable,
    Call,
    DeferredBlock,
    Definition,
    Expr,
    If,
    Message,
    Mistake,
    Named,
    Number,
    Program,
    Replaced,
    Statement,
    Unsupported,
    Word,
)

PLAIN_LETTERS = "XYZWUVABCIJKRFS"
"""Letters with which a line without a command may start."""


class Unprintable(Exception):
    """WinCNC has no text for this; the argument says for what."""


def emit(program: Program, lexical: Lexical, *, same_length: bool = False) -> Iterator[bytes]:
    """The text of the program's own file, the job or CNC.MAC, piece by piece, each of whole lines.

    lexical: how the machine reads lines: one that starts with a sign of skipchars= makes others be left out. The
    percent sign is taken for one, as in the manual's example. same_length: a definition whose command would have
    another length keeps it as written: how long the lines of jobs are when they are replaced hangs on it.
    The job must have been read without mistakes: a line with one is not in the Program.
    Refusal (GP702) where the Program holds what WinCNC has no text for.
    """
    signs = "".join(signs.upper() + signs.lower() for signs, _ in lexical.skips)
    kept = {sign.encode(encoding, "ignore")[:1] for sign in f"%{signs}" for encoding in ("utf-8", "cp1252")}
    printer = _Printer(program, b"".join(sorted(kept)))
    printer.same_length = same_length
    printer.has_mistakes = any(isinstance(node, Mistake) for node in program.body)
    yield from printer.run()


class _Printer(LinePrinter):
    """Prints a WinCNC program. same_length: see ``emit``; has_mistakes: some lines stay as they are."""

    same_length = False
    has_mistakes = False

    def run(self) -> Iterator[bytes]:
        """The file: its mark, its lines, what comes after the last."""
        if self.source.mark:
            yield UTF8_MARK
        yield from self._body(self.program.body)
        yield from self.gap(self.source.line_count + 1)

    def _body(self, nodes: tuple[Statement, ...]) -> Iterator[bytes]:
        for node in nodes:
            yield from self._node(node)

    def _node(self, node: Statement) -> Iterator[bytes]:
        if isinstance(node, DeferredBlock):
            node = node.made()
        if isinstance(node, BlockTable):
            if node.file == JOB:
                yield from self.table(node)
            return
        if node.span.file != self.source.name or not node.span.line:
            return  # what a setting of the machine runs before and after the job
        if isinstance(node, If):
            # What runs when the condition does not hold is among the lines of what runs when it does.
            yield from self._line(node.span, self._text(node.head, node.span))
            yield from self._body(node.then)
            return
        ends_in_sign = isinstance(node, Definition) and not node.written
        yield from self._line(node.span, self._text(node, node.span), tight=ends_in_sign)
        if isinstance(node, Array):
            yield from self._body(node.body)

    def _is_known(self, block: Block) -> bool:
        """Whether a line is one of commands and words of WinCNC's own: anything else may be a macro of some machine.

        How a controller compares the names of macros is not documented: such a line stays as it is.
        """
        first = next(iter(block.words), None)
        if block.own or first is None or _begins_with_name(block):
            return True
        if len(block.words) > 1 and first.bare and block.words[1].span.column == first.span.column + 1:
            return False
        if first.letter not in PLAIN_LETTERS + "GLM":
            return False
        codes = self.program.rules.codes
        for word in block.words:
            if word.letter in "GLM" and isinstance(word.value, Number):
                return (word.letter, round(word.value.value * 10)) in codes
        return True

    def _text(self, node: Statement | None, span: Span) -> str | None:
        """A line without its comments; None for one that stays as it is."""
        if isinstance(node, Block):
            line: Block | None = node if self._is_known(node) else None
            if line is None:
                return None
        elif isinstance(node, Mistake):
            return None
        elif isinstance(node, Definition):
            return self._definition(node)
        elif isinstance(node, Array | Call | Message | Replaced | Unsupported):
            line = node.line
        else:
            line = None
        try:
            if line is not None:
                text = line_text(line)
                return None if self._outgrows(node, text) else text
        except Unprintable as error:
            raise self.refusal(span, str(error)) from None
        if isinstance(node, Replaced):
            return node.written
        if isinstance(node, Unsupported) and node.text:
            return node.text
        what = node.what if isinstance(node, Unsupported) else "a statement of another language"
        raise self.refusal(span, what)

    def _definition(self, node: Definition) -> str:
        """``NAME=command``; a command that is no line of WinCNC's own words stays as it is written."""
        try:
            known = node.line is not None and self._is_known(node.line)
            command = line_text(node.line) if node.line is not None and known else node.written
        except Unprintable as error:
            raise self.refusal(node.span, str(error)) from None
        if self.same_length and len(command) != len(node.written):
            command = node.written
        if self.has_mistakes:
            # One of them may define the same name: by the same command only where that is written alike.
            command = node.written
        return f"{node.label}={command}"

    def _outgrows(self, node: Statement | None, text: str) -> bool:
        """Whether a line that is replaced would become longer than the controller takes."""
        if not isinstance(node, Replaced) or len(text) <= len(node.written):
            return False
        return node.length + len(text) - len(node.written) > self.limit

    def _line(self, span: Span, text: str | None, *, tight: bool = False) -> Iterator[bytes]:
        """One line with code, after the lines before it. tight: no blank sets its first comment apart."""
        yield from self.gap(span.line)
        notes = self.notes.of_line(span.line)
        self.next = span.line + 1
        if any(kind == NoteKind.LINE_NUMBER for _, _, kind, _, _ in notes):
            text = None
        try:
            out = _composed(text or "", notes, tight=tight)
        except UnicodeEncodeError as error:
            raise self.refusal(span, str(error)) from None
        if text is None or self._stays(span.line, out, notes):
            out = self.as_written(span.line, len(out))
        yield out + self.newline

    def as_written(self, line: int, length: int) -> bytes:
        """As it is in the source, without blanks at its end where it is not too long."""
        text = super().as_written(line, length)
        return text.rstrip(b" \t") if len(text) <= self.limit else text

    def _stays(self, line: int, out: bytes, notes: list[Note]) -> bool:
        """Whether the printed line would be read otherwise than the one that was read."""
        if len(out) > self.limit or _reads_otherwise(out, notes):
            return True
        if not out.isascii():
            written = self.written.line(line)
            return written is not None and len(written) > self.limit
        return out[:1] in self.kept


def _composed(text: str, notes: list[Note], *, tight: bool) -> bytes:
    """The text of a line, with its comments after it."""
    if not notes:
        return text.encode()
    encoding = next((note.decode() for _, _, kind, _, note in notes if kind == NoteKind.ENCODING), "utf-8")
    out = text.encode(encoding)
    for _, _, kind, column, note in notes:
        if kind == NoteKind.SIGNED:
            out = out + note if tight else padded(out + b" " if out else out, column) + note
            tight = False
    return out


def _reads_otherwise(out: bytes, notes: list[Note]) -> bool:
    """Whether a line that was not UTF-8 would be taken for it now, its curly quotes being gone."""
    if not any(kind == NoteKind.ENCODING for _, _, kind, _, _ in notes):
        return False
    try:
        out.decode("utf-8")
    except UnicodeDecodeError:
        return False
    return True


def _begins_with_name(block: Block) -> bool:
    """Whether the line starts with the name of a macro: a text that is before all words."""
    name = next((text for letter, text in block.texts if not letter), None)
    return name is not None and all(name.span.column < word.span.column for word in block.words)


def line_text(block: Block) -> str:
    """Words and texts of a line in the order of the source."""
    items = [(word.span.column, _word(word)) for word in block.words]
    for letter, text in block.texts:
        items.append((text.span.column, f'{letter}"{text.value}"' if letter else text.value))
    line = " ".join(text for _, text in sorted(items, key=lambda item: item[0]))
    return f"~{line}" if block.own else line


def _word(word: Word) -> str:
    """``X5.0``, ``X``, ``X{TH1+2}``."""
    if word.bare:
        return word.letter
    value = word.value
    if isinstance(value, Number):
        text = number_text(value.value, value.point)
        return f"{word.letter}{{{text}}}" if word.braced else f"{word.letter}{text}"
    return f"{word.letter}{{{_inside(value)}}}"


def _inside(value: Expr) -> str:
    """What is between braces."""
    if isinstance(value, Binary) and isinstance(value.right, Number):
        return f"{_operand(value.left)}{value.operator}{_operand(value.right)}"
    return _operand(value)


def _operand(value: Expr) -> str:
    if isinstance(value, Named):
        return value.name
    if isinstance(value, Number):
        return number_text(value.value, value.point)
    raise Unprintable("an expression that does not fit into braces")
