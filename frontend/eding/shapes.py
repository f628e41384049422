"""Lines whose shape was met before, without the grammar.

Two lines have one shape when they differ only in literal numbers and in the contents of comments, the *holes* of the
line: ``G1 X[#1 + 2.5] (a)`` and ``G1 X[#7 + 10] (b)``. When a shape comes for the first and second time, its line is
read directly (``direct.read_line``) where that can be, else by the grammar. Then a ``Shape`` makes the nodes of further
lines out of their holes: equal to what the grammar gives, places included. The grammar (``parse.parse_line``) stays the
reference; what a shape can not be sure of goes there:

- mistakes, and lines with control characters or a message in a comment;
- lines with numbers that are no ``Number`` of their own (with blanks inside, in names, in texts): these are only kept
  letter by letter.
"""

from __future__ import annotations

import dataclasses
import functools
import re
from bisect import bisect_right
from collections.abc import Callable, Sequence
from itertools import accumulate
from typing import Any, TypeVar

from gproof.frontend.eding.build import Parsed
from gproof.frontend.eding.direct import read_line
from gproof.frontend.eding.parse import parse_line
from gproof.frontend.eding.prepare import LineError, decode, prepare
from gproof.ir.finding import Span
from gproof.ir.program import Assign, Binary, Block, DeferredBlock, Number, Unary, Variable, Word

KEPT = 20_000
"""Shapes and lines that a reader remembers; when there are more it starts again."""

HELD_BLOCKS = 5_000
"""Blocks of a program that are made at once; later ones are made when they run."""

_HOLE = re.compile(r"((?<=\()[^()]+(?=\))|(?<=;)(?!\)).+|[0-9]+\.?[0-9]*|\.[0-9]+)")
"""A hole: what is in parentheses, what is behind a semicolon (but not one that ends a comment), a number.
The code around it tells which of them it is."""
_NOT_HERE = re.compile(r"[\x00-\x08\x0a-\x1f\x7f]|\([ \t]*m[ \t]*s[ \t]*g[ \t]*,", re.IGNORECASE)
_LINE_NUMBER = re.compile(r"[ \t]*/?[ \t]*[nN][ \t]*")
_QUOTES = re.compile(r"[\"“”„]")
_LINE_NUMBER_DIGITS = 5  # 3.2.1
_MARKS = 0xE000  # private use characters, which stand for the contents of comments

Make = Callable[[Sequence[str], Sequence[int], str, int], Any]
"""(holes, shifts, file, line) -> value; shifts: by how much what stands behind so many holes moves."""


class _NoShapeError(Exception):
    """The line has a hole that is no number of its own."""


class Shape:
    """Makes the statements of the lines of one shape.

    make: makes them; sizes: of the holes that its places stand on; line_number: whether the first hole is one;
    comments: those of its holes; is_block: whether a line holds one block and nothing else.
    """

    def __init__(
        self, make: Make, sizes: tuple[int, ...], line_number: bool, comments: tuple[int, ...], is_block: bool
    ) -> None:
        self.make = make
        self.sizes = sizes
        self.line_number = line_number
        self.comments = comments
        self.is_block = is_block
        self.block = functools.lru_cache(maxsize=1)(self._block)
        """(raw, file, line) -> the block of that line; remembers the last, as its user asks for one field at a time."""

    def accepts(self, holes: Sequence[str]) -> bool:
        """Whether a line with these holes is one that the grammar accepts with the same result."""
        if self.line_number and (len(holes[0]) > _LINE_NUMBER_DIGITS or "." in holes[0]):
            return False
        return not self.comments or all(holes[n].strip() for n in self.comments)

    def statements(self, holes: Sequence[str], file: str, line: int) -> Sequence[Parsed]:
        """What a line with these holes holds."""
        shifts = tuple(accumulate((len(h) - size for h, size in zip(holes, self.sizes, strict=True)), initial=0))
        found: Sequence[Parsed] = self.make(holes, shifts, file, line)
        return found

    def _block(self, raw: bytes, file: str, line: int) -> Block:
        (found,) = self.statements(_HOLE.split(decode(raw))[1::2], file, line)
        assert isinstance(found, Block)
        return found


ONCE = "met once"
LETTERS = "kept letter by letter"
GRAMMAR = "left to the grammar"


class Reader:
    """Reads the lines of a program that are not plain; gives what ``parse_line`` gives."""

    def __init__(self, held: int = HELD_BLOCKS) -> None:
        self.held = held
        self._shapes: dict[str, Shape | str] = {}
        self._lines: dict[str, Shape | str] = {}

    def read(self, raw: bytes, file: str, number: int) -> Sequence[Parsed]:
        """The statements of line ``number``, or LineError."""
        text = decode(raw)
        if _NOT_HERE.search(text):
            return parse_line(raw, file, number)
        pieces = _HOLE.split(text)
        key, holes = "\0".join(pieces[::2]), pieces[1::2]
        shape = self._shapes.get(key)
        if shape is ONCE:
            shape = _remember(self._shapes, key, _shape(text, pieces))
        if isinstance(shape, Shape):
            if not shape.accepts(holes):
                return parse_line(raw, file, number)
            if shape.is_block and self._is_full():
                return (DeferredBlock(shape.block, raw, file, number),)
            return shape.statements(holes, file, number)
        if shape is LETTERS:
            return self._by_letters(text, raw, file, number)
        if shape is None:
            _remember(self._shapes, key, ONCE)
        found = read_line(text, file, number)
        if found is None:
            return parse_line(raw, file, number)
        if isinstance(found[0], Block) and self._is_full():
            return (DeferredBlock(_directly, raw, file, number),)
        return found

    def _is_full(self) -> bool:
        """Whether the program holds no further block, which this asks for."""
        self.held -= 1
        return self.held < 0

    def _by_letters(self, text: str, raw: bytes, file: str, number: int) -> Sequence[Parsed]:
        shape = self._lines.get(text)
        if isinstance(shape, Shape):
            return shape.statements((), file, number)
        found = parse_line(raw, file, number)
        _remember(self._lines, text, ONCE if shape is None else _Maker((), ()).shape(found, ()))
        return found


@functools.lru_cache(maxsize=1)
def _directly(raw: bytes, file: str, line: int) -> Block:
    """The block of a line that is read directly; remembers the last, as its user asks for one field at a time."""
    found = read_line(decode(raw), file, line)
    assert found is not None
    assert isinstance(found[0], Block)
    return found[0]


_T = TypeVar("_T", bound=Shape | str)


def _remember(kept: dict[str, Shape | str], key: str, value: _T) -> _T:
    if len(kept) >= KEPT:
        kept.clear()
    kept[key] = value
    return value


def _shape(text: str, pieces: Sequence[str]) -> Shape | str:
    """The shape of a line: ``pieces`` are its code and its holes by turns."""
    code, holes = pieces[::2], list(pieces[1::2])
    try:
        keyword = prepare(text).keyword
        if holes and (keyword not in ("", "if", "while") or any(map(_QUOTES.search, code))):
            return LETTERS
        comments = tuple(n for n in range(len(holes)) if _is_comment(code[n], code[n + 1]))
        for n in comments:
            holes[n] = f"\t{chr(_MARKS + n)}\t"  # tabs: whether a comment is taken with the blanks around it
        marked = "".join(part for pair in zip(code, [*holes, ""], strict=True) for part in pair)
        found = read_line(marked, "", 1) or parse_line(marked.encode(), "", 1)
        return _Maker(holes, code).shape(found, comments)
    except _NoShapeError:
        return LETTERS
    except LineError:
        return GRAMMAR


def _is_comment(before: str, behind: str) -> bool:
    """Whether a hole between these pieces of code is a comment."""
    return (before.endswith("(") and behind.startswith(")")) or (before.endswith(";") and not behind)


class _Maker:
    """From the statements of one line of a shape to functions that make those of any."""

    def __init__(self, holes: Sequence[str], code: Sequence[str]) -> None:
        self.holes = holes
        self.begins: list[int] = []
        self.ends: list[int] = []
        at = 0
        for before, hole in zip(code, holes, strict=False):
            at += len(before)
            self.begins.append(at)
            at += len(hole)
            self.ends.append(at)
        self.marked = False
        self.line_number = bool(holes) and _LINE_NUMBER.fullmatch(code[0]) is not None
        self.used = {0} if self.line_number else set()

    def shape(self, statements: Sequence[Parsed], comments: tuple[int, ...]) -> Shape:
        """The shape of the line that these are the statements of."""
        self.marked = bool(comments)
        make = self._value(tuple(statements))
        if self.used | set(comments) != set(range(len(self.holes))):
            raise _NoShapeError
        is_block = len(statements) == 1 and isinstance(statements[0], Block)
        return Shape(make, tuple(map(len, self.holes)), self.line_number, comments, is_block)

    def _value(self, value: Any) -> Make:
        if isinstance(value, tuple):
            return _tuple_of([self._value(item) for item in value])
        if isinstance(value, str):
            return self._text(value)
        if not dataclasses.is_dataclass(value) or isinstance(value, type):
            return lambda holes, shifts, file, line: value
        special = _SPECIAL.get(type(value))
        if special is not None:
            return special(self, value)
        cls = type(value)
        fields = [(f.name, self._value(getattr(value, f.name))) for f in dataclasses.fields(cls)]
        return lambda holes, shifts, file, line: cls(**{name: make(holes, shifts, file, line) for name, make in fields})

    def _place(self, column: int) -> tuple[int, int]:
        """A column and how many holes stand before it."""
        n = bisect_right(self.ends, column - 1)
        if n < len(self.begins) and self.begins[n] < column - 1:
            raise _NoShapeError
        return column, n

    def span(self, span: Span) -> Make:
        begin, i = self._place(span.column)
        end, j = self._place(span.end_column)
        return lambda holes, shifts, file, line: Span(file, line, begin + shifts[i], end + shifts[j])

    def _text(self, text: str) -> Make:
        """A text, in which marks stand for the contents of comments."""
        parts = _MARKED.split(text) if self.marked else [text]
        if len(parts) == 1:
            return lambda holes, shifts, file, line: text
        if parts[0] or parts[-1] or len(parts) != 3:
            raise _NoShapeError
        n = ord(parts[1].strip("\t")) - _MARKS
        if len(parts[1]) == 1:
            return lambda holes, shifts, file, line: holes[n].strip()
        if len(parts[1]) == 3:
            return lambda holes, shifts, file, line: holes[n]
        raise _NoShapeError

    def number(self, node: Number) -> Make:
        if not self.holes:
            value, point, span = node.value, node.point, self.span(node.span)
            return lambda h, s, f, l: Number(value, span(h, s, f, l), point)
        n = bisect_right(self.ends, node.span.end_column - 2)
        if n >= len(self.ends) or self.ends[n] != node.span.end_column - 1 or n in self.used:
            raise _NoShapeError
        if abs(node.value) != float(self.holes[n]) or node.span.column - 1 > self.begins[n]:
            raise _NoShapeError
        self.used.add(n)
        sign = -1.0 if str(node.value).startswith("-") else 1.0
        begin, i = self._place(node.span.column)
        end, j = node.span.end_column, n + 1

        def make(holes: Sequence[str], shifts: Sequence[int], file: str, line: int) -> Number:
            text = holes[n]
            return Number(sign * float(text), Span(file, line, begin + shifts[i], end + shifts[j]), "." in text)

        return make

    def variable(self, node: Variable) -> Make:
        number, span = self._value(node.number), self.span(node.span)
        return lambda h, s, f, l: Variable(number(h, s, f, l), span(h, s, f, l))

    def unary(self, node: Unary) -> Make:
        operator, operand, span = node.operator, self._value(node.operand), self.span(node.span)
        return lambda h, s, f, l: Unary(operator, operand(h, s, f, l), span(h, s, f, l))

    def binary(self, node: Binary) -> Make:
        operator, doubtful = node.operator, node.doubtful
        left, right, span = self._value(node.left), self._value(node.right), self.span(node.span)
        return lambda h, s, f, l: Binary(operator, left(h, s, f, l), right(h, s, f, l), span(h, s, f, l), doubtful)

    def word(self, node: Word) -> Make:
        letter, value, span = node.letter, self._value(node.value), self.span(node.span)
        return lambda h, s, f, l: Word(letter, value(h, s, f, l), span(h, s, f, l))

    def assign(self, node: Assign) -> Make:
        target, value, span = self.variable(node.target), self._value(node.value), self.span(node.span)
        return lambda h, s, f, l: Assign(target(h, s, f, l), value(h, s, f, l), span(h, s, f, l))


_MARKED = re.compile(r"(\t?[\ue000-\uf8ff]\t?)")
_SPECIAL: dict[type, Callable[[_Maker, Any], Make]] = {
    Span: _Maker.span,
    Number: _Maker.number,
    Variable: _Maker.variable,
    Unary: _Maker.unary,
    Binary: _Maker.binary,
    Word: _Maker.word,
    Assign: _Maker.assign,
}
"""Nodes that expressions and blocks are made of, with their fields in order; every other is made by name."""


def _tuple_of(makes: Sequence[Make]) -> Make:
    if not makes:
        return lambda h, s, f, l: ()
    return lambda h, s, f, l: tuple([make(h, s, f, l) for make in makes])
