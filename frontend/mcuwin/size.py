"""How large a compiled McuWIN program is, by estimate (manual 13.1.1.13).

The manual gives the largest size (100,000 bytes, SZTSK3) and not how a program is compiled. Between bounds: each word
needs 4 bytes at least (a number of single precision, nothing for its letter) and, with what adds, takes and finds
it, each node of an expression 40 at most; each line of the source 48 for its number and the call of its code.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from gproof.frontend.mcuwin.structure import Section
from gproof.ir import codes
from gproof.ir.finding import Finding, Span
from gproof.ir.program import (
    Binary,
    Block,
    BlockTable,
    DeferredBlock,
    Expr,
    For,
    If,
    Program,
    Repeat,
    Statement,
    Subprogram,
    Unary,
    While,
)

LEAST_WORD, MOST_NODE, MOST_LINE = 4, 40, 48
"""Bytes."""
CHUNK = 1 << 16


def judge_size(
    program: Program, sections: Sequence[Section], procedures: Sequence[Subprogram], allowed: int,
    deferred: tuple[int, int] = (0, 0),
) -> Finding | None:  # fmt: skip
    """A finding where the compiled program is, or may be, larger than what the controller loads.

    deferred: words and nodes of the blocks that are made when they run.
    """
    lines = sum(source.line_count for source in program.files)
    size = sum(len(source.data) for source in program.files)
    # A node takes a character of the source at least.
    if size * MOST_NODE + lines * MOST_LINE <= allowed:
        return None
    counter = _Counter(program, allowed)
    counter.words, counter.nodes = deferred
    for body in (*(section.body for section in sections), *(sub.body for sub in procedures)):
        counter.take(body)
    low, high = min(counter.words, counter.enough) * LEAST_WORD, counter.nodes * MOST_NODE + lines * MOST_LINE
    whole = Span(program.files[0].name, 1)
    hint = "state program_size if SZTSK3 is set to a higher value"
    if low > allowed:
        return codes.PROGRAM_TOO_LARGE.at(whole, low=low, allowed=allowed, hint=hint)
    if high > allowed:
        return codes.PROGRAM_SIZE.at(whole, low=low, high=high, allowed=allowed, hint=hint)
    return None


class _Counter:
    """Words, and nodes of their expressions; counting stops where there are too many already."""

    def __init__(self, program: Program, allowed: int) -> None:
        self.program = program
        self.enough = allowed // LEAST_WORD + 1
        self.words = 0
        self.nodes = 0

    def take(self, body: Iterable[Statement]) -> None:
        for node in body:
            if self.words > self.enough:
                return
            if isinstance(node, BlockTable):
                self._table(node)
                continue
            if isinstance(node, Block):
                words, nodes = (0, 0) if isinstance(node, DeferredBlock) else size_of(node)
                self.words += words
                self.nodes += nodes
                continue
            self.words += 1
            self.nodes += 1 + sum(_nodes(value) for value in _values(node))
            if isinstance(node, If):
                self.take(node.then)
                self.take(node.otherwise)
            elif isinstance(node, While | Repeat | For):
                self.take(node.body)

    def _table(self, table: BlockTable) -> None:
        at, line = table.begin, table.first_line
        while at < table.end and self.words <= self.enough:
            words, at, line = self.program.load(table, at, line, CHUNK)
            self.words += len(words)
            self.nodes += 2 * len(words)


def size_of(block: Block) -> tuple[int, int]:
    """Its words, and the nodes of their expressions."""
    values = [word.value for word in block.words] + [assign.value for assign in block.assigns]
    return len(values), sum(_nodes(value) + 1 for value in values)


def _values(node: Any) -> list[Expr]:
    """The expressions of a statement that is no block."""
    found: list[Expr] = []
    for name in ("condition", "first", "last", "count"):
        value = getattr(node, name, None)
        found += [value] if value is not None else []
    found += [getattr(argument, "value", argument) for argument in getattr(node, "arguments", ())]
    return found + list(getattr(node, "parts", ()))


def _nodes(value: Expr) -> int:
    if isinstance(value, Binary):
        return 1 + _nodes(value.left) + _nodes(value.right)
    return 1 + _nodes(value.operand) if isinstance(value, Unary) else 1
