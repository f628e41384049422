"""Lines of a program that no controller of its language would take as they stand: what they mean is not known.

Told from the words of a line alone (two codes of a group, a word that nobody takes, an unknown code), by the functions
that gather lines when a job runs; nothing is executed, and lines that never run count. ``gproof fmt`` leaves such lines
as they are.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import Any

import numpy as np

from gproof.ir import codes
from gproof.ir.columns import Columns
from gproof.ir.finding import Refusal, Span
from gproof.ir.machine import Machine
from gproof.ir.program import Block, BlockTable, DeferredBlock, Number, Program, Replaced, Statement, Word
from gproof.ir.symbolic import Unknown, Value
from gproof.passes.interpret.core.parsed_line import LARGEST
from gproof.passes.interpret.core.semantics import Dialect

PIECE_BYTES = 1 << 18
OPEN = Unknown("its expression")
_CODES = "GLM"
_HELD = ("then", "otherwise", "body")
"""What a statement may hold of others."""
_MIX = np.uint64(0x9E3779B97F4A7C15)
_LETTER = np.uint64(0x100000001B3)


def doubtful_lines(program: Program, machine: Machine, dialect: Dialect[Any]) -> frozenset[int]:
    """Numbers of the lines of the program's own file that are not understood; machine: whose axes they move."""
    return frozenset(_Lines(program, machine, dialect).numbers())


class _Lines:
    def __init__(self, program: Program, machine: Machine, dialect: Dialect[Any]) -> None:
        self.program = program
        self.machine = machine
        self.name = program.files[0].name if program.files else ""
        self.dialect = dialect
        self.known: dict[int, bool] = {}

    def numbers(self) -> Iterator[int]:
        yield from self._body(self.program.body)
        for sub in self.program.subprograms.values():
            yield from self._body(sub.body)

    def _body(self, nodes: Iterable[Statement]) -> Iterator[int]:
        for node in nodes:
            made: Any = node.made() if isinstance(node, DeferredBlock) else node
            if isinstance(made, BlockTable):
                if made.file == 0:
                    yield from self._table(made)
                continue
            for line in (made, getattr(made, "line", None), getattr(made, "head", None)):
                if isinstance(line, Block) and line.span.file == self.name and self._is_doubtful(line):
                    yield made.span.line if line is made else line.span.line
            if isinstance(made, Replaced):
                continue  # what stands for the line is another file's
            for held in _HELD:
                inner = getattr(made, held, ())
                if isinstance(inner, tuple):
                    yield from self._body(inner)

    def _is_doubtful(self, block: Block) -> bool:
        if any(not letter for letter, _ in block.texts):
            return False  # the name of a macro or a file, and what comes after it
        words = [(w.letter, w.value.value if isinstance(w.value, Number) else OPEN, w.span) for w in block.words]
        return self._problem(words, _bare(block.words), block.span)

    def _problem(self, words: Sequence[tuple[str, Value, Span]], bare: frozenset[str], span: Span) -> bool:
        try:
            self.dialect.judge_line(self.machine, span, words, bare)
        except Refusal as refusal:
            if refusal.finding.code is not codes.UNKNOWN_CONDITION:
                return True
            # A code by a number that is computed is no mistake; the rest of the line may have one.
            rest = [word for word in words if word[2] != refusal.finding.span]
            return len(rest) < len(words) and self._problem(rest, bare, span)
        return False

    # -- plain lines: those with the same letters and codes are judged once

    def _table(self, table: BlockTable) -> Iterator[int]:
        begin, line = table.begin, table.first_line
        while line <= table.last_line:
            words, begin, line = self.program.load(table, begin, line, PIECE_BYTES)
            yield from self._words(words)

    def _words(self, words: Columns) -> Iterator[int]:
        lines, letters, values = words["line"], words["letter"], words["value"]
        if not len(lines):
            return
        starts = np.flatnonzero(np.r_[True, lines[1:] != lines[:-1]])
        place = np.arange(len(lines)) - np.repeat(starts, np.diff(np.r_[starts, len(lines)]))
        is_code = np.isin(letters, [ord(letter) for letter in _CODES])
        told = np.where(is_code, np.nan_to_num(values * 1000.0).astype(np.int64), np.abs(values) > LARGEST)
        keys = letters.astype(np.uint64) * _LETTER + told.astype(np.int64).view(np.uint64) * _MIX
        keys = (keys ^ (keys >> np.uint64(29))) * (place.astype(np.uint64) * np.uint64(2) + np.uint64(1)) * _MIX
        sums = np.add.reduceat(keys ^ (keys >> np.uint64(31)), starts)
        kinds, first, of = np.unique(sums, return_index=True, return_inverse=True)
        ends = np.r_[starts[1:], len(lines)]
        bad = np.zeros(len(kinds), dtype=bool)
        for n, (kind, at) in enumerate(zip(kinds.tolist(), first.tolist(), strict=True)):
            if kind not in self.known:
                self.known[kind] = self._plain(words, int(starts[at]), int(ends[at]))
            bad[n] = self.known[kind]
        if bad.any():
            yield from lines[starts[bad[of]]].tolist()

    def _plain(self, words: Columns, begin: int, end: int) -> bool:
        span = Span(self.name, int(words["line"][begin]))
        cut = slice(begin, end)
        pairs = zip(words["letter"][cut].tolist(), words["value"][cut].tolist(), strict=True)
        return self._problem([(chr(letter), value, span) for letter, value in pairs], frozenset(), span)


def _bare(words: Sequence[Word]) -> frozenset[str]:
    return frozenset(word.letter for word in words if word.bare)
