"""The lines of a program that are not plain, each in the cheapest way that gives what the grammar gives.

- Correct lines of words, settings and conditions are read directly (``direct.read_line``).
- A program holds so many blocks; those after are made when they run (``DeferredBlock``). Such a line is not even read
  when its *shape* was met before: two lines have one shape when they differ only in literal numbers and in the
  contents of comments, the *holes* of the line: ``G1 X[#1 + 2.5] (a)`` and ``G1 X[#7 + 10] (b)``. What is a correct
  block in one of them is one in the other: no token starts or ends elsewhere, whatever number is in a hole.
- Everything else goes through the grammar (``parse.parse_line``), which is the reference; what it gave for a line is
  kept letter by letter, for the next ``endif`` or ``gosub part``. Mistakes are never kept.
"""

from __future__ import annotations

import dataclasses
import functools
import re
from collections.abc import Sequence
from typing import Any

from gproof.frontend.common.source import decode
from gproof.frontend.eding.build import Parsed
from gproof.frontend.eding.fast_reader import read_line
from gproof.frontend.eding.parse import parse_line
from gproof.ir.finding import Span
from gproof.ir.program import Block, DeferredBlock

KEPT_SHAPES = 20_000
KEPT_LINES = 5_000
"""What a reader remembers; when there are more it starts again. A shape takes about a tenth of a kilobyte."""

HELD_BLOCKS = 2_000
"""Blocks of a program that are made at once; later ones are made when they run."""

_HOLE = re.compile(r"((?<=\()[^()]+(?=\))|(?<=;)(?!\)).+|[0-9]+\.?[0-9]*|\.[0-9]+)")
"""A hole: what is in parentheses, what is after a semicolon (but not one that ends a comment), a number.
The code around it tells which of them it is."""
_NOT_DIRECTLY = re.compile(r"[\x00-\x08\x0a-\x1f\x7f]|\([ \t]*m[ \t]*s[ \t]*g[ \t]*,", re.IGNORECASE)
_LINE_NUMBER = re.compile(r"[ \t]*/?[ \t]*[nN][ \t]*")
_LINE_NUMBER_DIGITS = 5  # 3.2.1


class Reader:
    """Reads the lines of a program that are not plain; gives what ``parse_line`` gives.

    held: how many blocks may be made at once.
    """

    def __init__(self, held: int = HELD_BLOCKS) -> None:
        self.held = held
        self._shapes: dict[str, bool] = {}
        """Shapes of blocks that are read directly; whether their first hole is a line number."""
        self._lines: dict[str, Sequence[Parsed]] = {}

    def read(self, raw: bytes, file: str, number: int) -> Sequence[Parsed]:
        """The statements of line ``number``, or LineError."""
        text = decode(raw)
        if _NOT_DIRECTLY.search(text):
            return self._by_letters(text, raw, file, number)
        if self.held <= 0 and self._is_known(text):
            return (DeferredBlock(_block, raw, file, number),)
        found: Sequence[Parsed] | None = read_line(text, file, number)
        is_direct = found is not None
        if found is None:
            found = self._by_letters(text, raw, file, number)
        if len(found) != 1 or not isinstance(found[0], Block):
            return found
        if self.held > 0:
            self.held -= 1
            return found
        if is_direct:
            self._remember(text)
        return (DeferredBlock(_block, raw, file, number),)

    def _is_known(self, text: str) -> bool:
        """Whether a line is surely a block, as others of its shape were."""
        pieces = _HOLE.split(text)
        is_numbered = self._shapes.get("\0".join(pieces[::2]))
        if is_numbered:
            return len(pieces[1]) <= _LINE_NUMBER_DIGITS and "." not in pieces[1]
        return is_numbered is not None

    def _remember(self, text: str) -> None:
        if len(self._shapes) >= KEPT_SHAPES:
            self._shapes.clear()
        code = _HOLE.split(text)[::2]
        self._shapes["\0".join(code)] = len(code) > 1 and _LINE_NUMBER.fullmatch(code[0]) is not None

    def _by_letters(self, text: str, raw: bytes, file: str, number: int) -> Sequence[Parsed]:
        """A line that the grammar reads, or has read."""
        found = self._lines.get(text)
        if found is not None:
            statements: Sequence[Parsed] = _moved(tuple(found), file, number)
        else:
            statements = parse_line(raw, file, number)
            if len(self._lines) >= KEPT_LINES:
                self._lines.clear()
            self._lines[text] = statements
        return statements


@functools.lru_cache(maxsize=1)
def _block(raw: bytes, file: str, line: int) -> Block:
    """The block of a line that holds one; remembers the last, as its user reads one field at a time."""
    found = read_line(decode(raw), file, line) or parse_line(raw, file, line)
    assert isinstance(found[0], Block)
    return found[0]


def _moved(value: Any, file: str, line: int) -> Any:
    """The same nodes on another line."""
    if isinstance(value, tuple):
        return tuple([_moved(item, file, line) for item in value])
    if isinstance(value, Span):
        return Span(file, line, value.column, value.end_column)
    if not dataclasses.is_dataclass(value):
        return value
    fields = {field.name: _moved(getattr(value, field.name), file, line) for field in dataclasses.fields(value)}
    return type(value)(**fields)  # type: ignore[misc]
