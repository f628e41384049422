"""Straight-line code: tables of plain lines, in the kernel as far as it takes them, else line by line in Python."""

from __future__ import annotations

from gproof.ir.columns import Columns
from gproof.ir.finding import Span
from gproof.ir.program import FLAG_BARE, FLAG_DELETE, BlockTable
from gproof.ir.symbolic import Value
from gproof.passes.interpret.core import lost_lines
from gproof.passes.interpret.core.call_stack import Frame
from gproof.passes.interpret.core.flow_part import FlowPart
from gproof.passes.interpret.core.line_decoder_kernels import WordColumns

CHUNK_BYTES = 1 << 20
_UTF8_MARK = b"\xef\xbb\xbf"


class BlockTables(FlowPart):
    """Executes the lines of a table."""

    def run_table(self, frame: Frame) -> None:
        """Go on with the lines of a table until it ends, rows are ready, or a line has called a subprogram."""
        table = frame.node
        assert isinstance(table, BlockTable)
        kernel = self.run.dialect.kernel.pick(table.last_line - table.first_line + 1)
        while self.flow.stack[-1] is frame and not self.run.rows.ready:
            if frame.words is None:
                if frame.next_byte >= table.end:
                    self.flow.stack.pop()
                    return
                self._load(frame, table)
            self._words(frame, table, kernel)

    def _load(self, frame: Frame, table: BlockTable) -> None:
        """The next piece of the table's words."""
        frame.base = frame.next_byte
        words, frame.next_byte, frame.line = self.run.ahead.load(table, frame.next_byte, frame.line, CHUNK_BYTES)
        if (words["flags"] & FLAG_DELETE).any():
            self.run.met_deleted = True
            if self.run.block_delete:
                keep = (words["flags"] & FLAG_DELETE) == 0
                words = Columns(words.schema, {n: a[keep] for n, a in words.arrays.items()})
        frame.words, frame.at = words, 0
        columns = WordColumns(*(words[name] for name in WordColumns._fields))
        kernel = self.run.dialect.kernel
        is_python = kernel.pick(table.last_line - table.first_line + 1) is kernel.python
        frame.columns = WordColumns(*(c.tolist() for c in columns)) if is_python else columns
        frame.cold = self.run.dialect.cold(self.run, frame, frame.columns, len(words))

    def _words(self, frame: Frame, table: BlockTable, kernel: object) -> None:
        assert frame.words is not None
        compiled = kernel is not self.run.dialect.kernel.python
        if compiled and isinstance(frame.columns.line, list):
            # Picked plain when the table was opened, compiled now that it is entered again.
            frame.columns = WordColumns(*(frame.words[name] for name in WordColumns._fields))
        line = frame.words["line"]
        count = len(frame.words)
        while frame.at < count:
            if not frame.cold or int(line[frame.at]) not in frame.cold:
                if self.run.modal.line_lost:
                    frame.at = lost_lines.run(self.run, frame, count, frame.at)
                frame.at = self.run.dialect.hot(self.run, kernel, frame.columns, count, frame.at, compiled)
            at = frame.at
            if at < count and self.run.rows.count < self.run.rows.capacity:
                end, here = at + 1, line[at]
                while end < count and line[end] == here:
                    end += 1
                frame.at = end
                self._cold(table, frame.words, at, end, frame.base)
                if self.flow.stack[-1] is not frame:
                    return
            elif self.run.rows.count == self.run.rows.capacity:
                self.run.rows.flush()
            if self.run.rows.ready:
                return
        frame.words = None

    def _cold(self, table: BlockTable, words: Columns, begin: int, end: int, base: int) -> None:
        """One plain line in Python."""
        span, line, bare = self.words_of(table, words, begin, end, base)
        self.run.spend(span)
        self.run.dialect.line(self.run, span, line, bare)

    def words_of(
        self, table: BlockTable, words: Columns, begin: int, end: int, base: int
    ) -> tuple[Span, list[tuple[str, Value, Span]], frozenset[str]]:
        """Words ``begin`` to ``end`` of a piece of a table as a line: its span, its words, letters without a number."""
        name, number = self.run.trace.files[table.file], int(words["line"][begin])
        data = self.run.program.files[table.file].data
        offsets = words["offset"][begin:end].tolist()
        first = base + offsets[0]
        start = data.rfind(b"\n", 0, first) + 1
        if start == 0 and data[:3] == _UTF8_MARK:
            start = len(_UTF8_MARK)
        spans = []
        for i, offset in enumerate(offsets, 1):
            column = base + offset - start + 1
            stop = base + offsets[i] - start + 1 if i < len(offsets) else 0
            spans.append(Span(name, number, column, _word_end(data, start, column, stop)))
        before = data[start : start + spans[-1].end_column - 1]
        if not before.isascii():
            spans = [_in_characters(span, before) for span in spans]
        letters = [chr(x) for x in words["letter"][begin:end].tolist()]
        values: list[Value] = words["value"][begin:end].tolist()
        span = Span(name, number, spans[0].column, spans[-1].end_column)
        flags = words["flags"][begin:end].tolist()
        bare = frozenset(letter for letter, flag in zip(letters, flags, strict=True) if flag & FLAG_BARE)
        return span, list(zip(letters, values, spans, strict=True)), bare


def _word_end(data: bytes, start: int, column: int, stop: int) -> int:
    """Column after a word: up to the next one, trailing blanks left out."""
    if stop == 0:
        stop = column + 1
        while start + stop - 1 < len(data) and chr(data[start + stop - 1]) in "0123456789.,+- \t":
            stop += 1
    while stop > column + 1 and start + stop - 2 < len(data) and data[start + stop - 2] in b" \t":
        stop -= 1
    return stop


def _in_characters(span: Span, raw: bytes) -> Span:
    """The span of a word in a line that starts with ``raw``: bytes to characters of its encoding."""
    try:
        column, end_column = (len(raw[: at - 1].decode("utf-8")) + 1 for at in (span.column, span.end_column))
    except UnicodeDecodeError:
        return span  # no UTF-8: each byte is a character
    return Span(span.file, span.line, column, end_column)
