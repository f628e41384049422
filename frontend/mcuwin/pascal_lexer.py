"""Tokens of rw_SymPas, over one line or several, each with its place.

Comments are ``//`` to the end of the line and ``{ }`` over any number of lines (McuWIN manual 7). Nothing raises here:
what is no token has the kind ``other``, so that an expression can end where text of another language goes on.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any, NamedTuple

from gproof.ir.finding import Code, Finding, Refusal, Span

_TOKEN = re.compile(
    r"""[ \t\r\f\v\n]*(?:
        (?P<axis>[A-Za-z]+\.[A-Za-z_]\w*(?:\.[0-9]+)?)
      | (?P<name>[A-Za-z_]\w*)
      | (?P<number>(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?)
      | (?P<string>"[^"]*"|'(?:[^']|'')*')
      | (?P<comment>//.*|\{[^}]*\}|\{.*)
      | (?P<op>:=|<=|>=|<>|[-+*/=<>()\[\],;:])
      | (?P<other>\S)
    )""",
    re.VERBOSE | re.ASCII,
)
_BLANK = re.compile(r"[ \t\r\f\v\n]*")


class Place(NamedTuple):
    """Where a text is: file, line, and how many characters of its line are before it."""

    file: str
    line: int
    column: int = 0


class Token(NamedTuple):
    """kind: ``axis`` (X.tp), ``name``, ``number``, ``string``, ``op``, ``other`` or ``end``; low: text in lower case;
    row: line of the text from 0; ``begin``, ``end``: its characters, from 0."""

    kind: str
    text: str
    low: str
    row: int
    begin: int
    end: int


class Comment(NamedTuple):
    """A comment (or the part of one that is in this line), with its signs."""

    text: str
    row: int
    begin: int
    end: int


class PascalError(Refusal):
    """A mistake after which reading does not go on: carries its finding."""


class Lexer:
    """Tokens of ``lines`` from character ``at`` of the first, made as they are requested."""

    def __init__(self, lines: Sequence[str], place: Place, at: int = 0) -> None:
        self.lines = lines
        self.place = place
        self.comments: list[Comment] = []
        self.index = 0
        self._tokens: list[Token] = []
        self._row, self._at = 0, at
        self._opened = self._ended = False

    def peek(self, ahead: int = 0) -> Token:
        """The token that many after the next one; the last has the kind ``end``."""
        index = self.index + ahead
        while index >= len(self._tokens):
            if self._ended:
                return self._tokens[-1]
            self._scan()
        return self._tokens[index]

    def take(self) -> Token:
        """The next token, which is passed."""
        token = self.peek()
        if token.kind != "end":
            self.index += 1
        return token

    @property
    def last(self) -> Token:
        """The token that was taken last."""
        return self._tokens[max(self.index - 1, 0)]

    def _scan(self) -> None:
        """Make one more token."""
        lines = self.lines
        while self._row < len(lines):
            found = _TOKEN.match(lines[self._row], self._at)
            if found is None:
                self._next_row()
                continue
            kind = found.lastgroup or ""
            begin, self._at = found.span(kind)
            text = found[kind]
            if kind != "comment":
                self._tokens.append(Token(kind, text, text.lower(), self._row, begin, self._at))
                return
            if text.startswith("{$") or (text[0] == "{" and text[-1] != "}" and self._row == len(lines) - 1):
                self._tokens.append(Token("other", text, text.lower(), self._row, begin, self._at))
                return
            self.comments.append(Comment(text, self._row, begin, self._at))
            self._opened = text[0] == "{" and text[-1] != "}"
        last = len(lines) - 1
        size = len(lines[last].rstrip()) if lines else 0
        if self._opened:
            self._opened = False
            self._tokens.append(Token("other", "{", "{", last, max(size - 1, 0), size))
            return
        self._tokens.append(Token("end", "", "", max(last, 0), size, size))
        self._ended = True

    def _next_row(self) -> None:
        """Go on with the next line, after a comment that is open."""
        self._row, self._at = self._row + 1, 0
        if self._opened and self._row < len(self.lines):
            line = self.lines[self._row]
            close = line.find("}")
            self._at = len(line) if close < 0 else close + 1
            self._opened = close < 0
            self.comments.append(Comment(line[: self._at], self._row, 0, self._at))

    def span(self, first: Token, last: Token | None = None) -> Span:
        """From a token to another; to the end of its own line when the other is in a further one."""
        last = last or first
        place = self.place
        shift = place.column if first.row == 0 else 0
        end = last.end if last.row == first.row else len(self.lines[first.row].rstrip())
        return Span(
            place.file,
            place.line + first.row,
            first.begin + shift + 1,
            max(end, first.end, first.begin + 1) + shift + 1,
        )

    def error(
        self, code: Code, first: Token, last: Token | None = None, /, *, hint: str = "", **values: Any
    ) -> PascalError:
        """A mistake at a token, to be raised."""
        return PascalError(self.finding(code, first, last, hint=hint, **values))

    def finding(
        self, code: Code, first: Token, last: Token | None = None, /, *, hint: str = "", **values: Any
    ) -> Finding:
        """A finding at a token; at the end of a text, of one column."""
        return code.at(self.span(first, last), hint=hint, **values)
