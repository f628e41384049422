"""Lines of a McuWIN program that are not plain, each read once for all lines of its shape (see ``patterns.py``).

A shape whose second line was read without a finding has a pattern: further lines of it are not read at all. A program
holds so many blocks; those after are made when they run (``DeferredBlock``), by the pattern of their shape or, where
there is none, by reading the line again with the names that were declared where it is. Reading itself
(``lines.py``, ``pascal.py``) is the reference.
"""

from __future__ import annotations

import functools
import re
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

from gproof.frontend.common.source import decode
from gproof.frontend.mcuwin.expressions import Expressions
from gproof.frontend.mcuwin.language import DinLine, Language
from gproof.frontend.mcuwin.lines import LineReader
from gproof.frontend.mcuwin.notes import Found
from gproof.frontend.mcuwin.pascal import Dollar, Place, Simple, Symbols, parse_dollar
from gproof.frontend.mcuwin.patterns import Pattern, UnfitError, lengths, pattern_of, place_of
from gproof.frontend.mcuwin.size import size_of
from gproof.ir.dialects.mcuwin.persistence import Persistence
from gproof.ir.finding import Findings
from gproof.ir.notes import NoteKind
from gproof.ir.program import Block, DeferredBlock, Number, Statement
from gproof.ir.record import record

KEPT_PATTERNS = 4_000
"""Patterns that are remembered, of several kilobytes each; when there are more it starts again."""
KEPT_SHAPES = 50_000
"""Shapes of which it is remembered that they were met."""
LONGEST = 500
"""Characters of a line with a pattern."""
LONGEST_RUN = 9
"""Digits of a number that is surely one of 32 bits."""

State = tuple[str, str]
"""What the source has in force before or after a line: code and distances (``ir/dialects/mcuwin/persistence.py``)."""

_RUN = re.compile(r"([0-9]+)")
_COMMENT = re.compile(r"'|//")
_ENDS = (2.0, 30.0)


class Split(NamedTuple):
    """A line apart. shape: what is between its runs; comment: where the one at its end may start, -1: nowhere."""

    shape: str
    pieces: list[str]
    comment: int

    @property
    def runs(self) -> list[str]:
        """The digits."""
        return self.pieces[1::2]


def split(text: str) -> Split | None:
    """The shape of a line; None for one that has no pattern."""
    if len(text) > LONGEST:
        return None
    if "$" in text:
        comment = text.find("//")
    else:
        found = _COMMENT.search(text)
        comment = found.start() if found is not None else -1
    pieces = _RUN.split(text if comment < 0 else text[:comment])
    shape = "\0".join(pieces[::2])
    # The sign of a comment follows a mark that no line has.
    return Split(shape if comment < 0 else f"{shape}\0\0{text[comment]}", pieces, comment)


def comment_of(text: str, at: int) -> str:
    """What the comment that starts with a quote or two slashes says, as blocks have it; "" without one."""
    return "" if at < 0 else text[at + (1 if text[at] == "'" else 2) :].strip()


@record(frozen=True, slots=True)
class Known:
    """What lines of a shape are. after: what is in force after; letters: of their words; number: whether they have a
    line number; says: there are statements; dollar: "" for a line of blocks, ``simple`` for whole statements of
    rw_SymPas, ``head`` for another ``$`` line; notes: each with the place where it starts; blocks:
    which of the statements are blocks that can be made when they run; size: of these, see ``size.py``."""

    pattern: Pattern
    after: State
    letters: frozenset[str]
    number: bool
    says: bool
    dollar: str
    notes: tuple[tuple[int, NoteKind, tuple[int, int], str | None], ...]
    blocks: tuple[bool, ...]
    size: tuple[int, int]


class Line(NamedTuple):
    """A line of a shape that is known."""

    known: Known
    text: str
    before: list[int]
    comment: int
    runs: list[str]

    def nodes(self, file: str, line: int) -> list[Statement]:
        """Its statements."""
        return self._nodes(file, line)

    def dollar(self, file: str, line: int) -> Dollar:
        """What it is of rw_SymPas."""
        found: Dollar = self._nodes(file, line)[0]
        return found

    def _nodes(self, file: str, line: int) -> list[Any]:
        return self.known.pattern.nodes(self.text, file, line, self.before, comment_of(self.text, self.comment))

    def notes(self) -> list[Found]:
        """Its notes."""
        found: list[Found] = []
        for place, kind, (at, count), written in self.known.notes:
            begin = at + self.before[count]
            if kind == NoteKind.LINE_NUMBER:
                written = self.runs[0]
            found.append((place, kind, begin, self.text[begin:].rstrip(" \t") if written is None else written))
        return found


class Shapes:
    """The shapes of lines that were read with the same names declared."""

    def __init__(self, language: Language, symbols: Symbols) -> None:
        self.symbols = symbols.trial()
        self.language = replace(language, expressions=Expressions(self.symbols))
        self._met: set[int] = set()
        self._fixed: dict[str, tuple[int, ...]] = {}
        self._known: dict[tuple[str, tuple[str, ...], State], Known] = {}
        self._makers: dict[tuple[int, State], Callable[[bytes, str, int], Block]] = {}
        self._last: tuple[bytes, tuple[int, State, str, int], Block] | None = None

    def find(self, text: str, state: State) -> Line | None:
        """A line whose shape is known, where ``state`` is in force."""
        parts = split(text)
        fixed = self._fixed.get(parts.shape) if parts is not None else None
        if parts is None or fixed is None:
            return None
        runs = parts.runs
        known = self._known.get((parts.shape, tuple([runs[i] for i in fixed]), state))
        before = lengths(runs)
        if known is None or (runs and max(map(len, runs)) > LONGEST_RUN):
            return None
        return Line(known, text, before, parts.comment, runs)

    def learn(
        self, text: str, file: str, line: int, state: State, after: State, din: DinLine, dollar: Dollar | None,
        notes: Sequence[Found],
    ) -> None:  # fmt: skip
        """Remember a line that was read without a finding; state, after: in force before and after it."""
        parts = split(text)
        if parts is None or din.module is not None or din.starts is not None or (din.pascal >= 0 and dollar is None):
            return
        if len(self._met) >= KEPT_SHAPES:
            self._met.clear()
        mark = hash(parts.shape)
        if mark not in self._met:
            self._met.add(mark)
            return
        if len(self._known) >= KEPT_PATTERNS:
            self._known.clear()
            self._fixed.clear()
        try:
            known = _known(text, file, line, parts, state, after, din, dollar, notes)
        except UnfitError:
            return
        fixed = {i for i in range(len(parts.runs)) if i not in known.pattern.free}
        fixed.update(self._fixed.get(parts.shape, ()))
        self._fixed[parts.shape] = tuple(sorted(fixed))
        self._known[parts.shape, tuple([parts.runs[i] for i in sorted(fixed)]), state] = known

    def deferred(self, nodes: Sequence[Statement], raw: bytes, file: str, line: int, state: State) -> list[Statement]:
        """The statements of a line, those that are blocks to be made when they run."""
        return [
            DeferredBlock(self._maker(index, state), raw, file, line) if can_wait(node) else node
            for index, node in enumerate(nodes)
        ]

    def deferred_known(self, found: Line, raw: bytes, file: str, line: int, state: State) -> list[Statement]:
        """As ``deferred``, of a line whose shape is known."""
        blocks = found.known.blocks
        if len(blocks) == 1 and blocks[0]:
            return [DeferredBlock(self._maker(0, state), raw, file, line)]
        nodes = [] if all(blocks) else found.nodes(file, line)
        return [
            DeferredBlock(self._maker(index, state), raw, file, line) if is_block else nodes[index]
            for index, is_block in enumerate(blocks)
        ]

    def _maker(self, index: int, state: State) -> Callable[[bytes, str, int], Block]:
        key = index, state
        found = self._makers.get(key)
        if found is None:
            found = self._makers[key] = functools.partial(self._make, index, state)
        return found

    def _make(self, index: int, state: State, raw: bytes, file: str, line: int) -> Block:
        """The statement of that index in a line; remembers the last, as its user reads one field at a time."""
        key = index, state, file, line
        last = self._last
        if last is not None and last[0] is raw and last[1] == key:
            return last[2]
        text = decode(raw)
        found = self.find(text, state)
        if found is not None:
            comment = comment_of(text, found.comment)
            block = found.known.pattern.node(index, text, file, line, found.before, comment)
        else:
            block = self._read(text, file, line, state)[index]
        assert isinstance(block, Block)
        self._last = raw, key, block
        return block

    def _read(self, text: str, file: str, line: int, state: State) -> Sequence[Statement]:
        """The statements of a line, read again."""
        persistence = Persistence(self.language.din, *state)
        self.symbols.findings = Findings()
        din = LineReader(self.language, persistence).read(text, file, line)
        dollar = parse_dollar(text, din.pascal + 1, Place(file, line), self.symbols) if din.pascal >= 0 else None
        nodes: Sequence[Statement] = din.statements
        if isinstance(dollar, Simple):
            nodes = continued(dollar.statements, persistence.state)
        return nodes


def continued(nodes: Sequence[Statement], state: str) -> list[Statement]:
    """Statements of rw_SymPas with what is in force where they are."""
    return [replace(n, continued=state) if isinstance(n, Block) else n for n in nodes]


def can_wait(node: object) -> bool:
    """Whether a statement is a block that may be made when it runs: none that ends a module (see ``modules.py``)."""
    return isinstance(node, Block) and not any(
        word.letter == "M" and isinstance(word.value, Number) and word.value.value in _ENDS for word in node.words
    )


def _known(
    text: str, file: str, line: int, parts: Split, state: State, after: State, din: DinLine, dollar: Dollar | None,
    notes: Sequence[Found],
) -> Known:  # fmt: skip
    """What a line that was read says of its shape; UnfitError where another line of it could be different."""
    runs, at = [], 0
    for piece, digits in zip(parts.pieces[::2], parts.runs, strict=False):
        at += len(piece)
        runs.append((at, at + len(digits)))
        at += len(digits)
    if din.number and not (parts.pieces[0].strip(" \t") in ("n", "N") and parts.runs[0] == din.number):
        raise UnfitError
    comment = comment_of(text, parts.comment)
    if parts.comment >= 0:
        others = [note[3][1:-1].strip() for note in notes if note[1] == NoteKind.SIGNED and note[2] != parts.comment]
        is_one = any(note[1] == NoteKind.SIGNED and note[2] == parts.comment for note in notes)
        if not is_one or not comment or comment in others:
            raise UnfitError
    nodes: Sequence[object] = din.statements
    if dollar is not None:
        nodes = continued(dollar.statements, state[0]) if isinstance(dollar, Simple) else [dollar]
    pattern = pattern_of(
        nodes, text, file, line, runs, comment=comment, number=0 if din.number else -1, labels=dollar is None
    )
    blocks = [node for node in din.statements if isinstance(node, Block)]
    return Known(
        pattern=pattern,
        after=after,
        letters=frozenset(word.letter for block in blocks for word in block.words),
        number=bool(din.number),
        says=bool(din.statements),
        dollar="" if dollar is None else "simple" if isinstance(dollar, Simple) else "head",
        notes=tuple(
            (place, kind, place_of(begin, runs), None if begin == parts.comment else written)
            for place, kind, begin, written in notes
        ),
        blocks=tuple(can_wait(node) for node in nodes),
        size=size_of_deferred(nodes),
    )


def size_of_deferred(nodes: Sequence[object]) -> tuple[int, int]:
    """Words and nodes of the statements that are made when they run."""
    sizes = [size_of(node) for node in nodes if isinstance(node, Block) and can_wait(node)]
    return sum(words for words, _ in sizes), sum(count for _, count in sizes)
