"""Where reading is in a line of DIN 66025 blocks of McuWIN: blanks, comments, values (manual 3, 6, 11)."""

from __future__ import annotations

import re
from typing import Any

from gproof.frontend.mcuwin.comments import QUOTE, round_comment
from gproof.frontend.mcuwin.language import DinLine, Language
from gproof.ir import codes
from gproof.ir.dialects.mcuwin.settings import FIRST_USER_CODE, LAST_USER_CODE
from gproof.ir.finding import Code, Refusal, Span
from gproof.ir.notes import NoteKind
from gproof.ir.program import PARAMETER, Expr, Number, Word

_BLANKS = re.compile(r"[ \t]*")
_ASSIGNED = re.compile(r"[A-Za-z_][A-Za-z0-9_]*+(?:\.[A-Za-z0-9_]++)*+(?=[ \t]*(?:\[[^\]]*\][ \t]*)?:=)", re.ASCII)
QUALIFIER = re.compile(r"[A-Za-z]++\.[A-Za-z_]", re.ASCII)
_LITERAL = re.compile(
    r"[-+]?(?:[0-9]+(?P<point>\.[0-9]*)?|(?P<bare>\.[0-9]+))"
    r"(?![0-9.]|[eE][-+0-9])(?=[ \t]*(?:\Z|['(]|//|(?!(?:div|mod|and|or|xor|shl|shr)(?![A-Za-z0-9_]))[A-Za-z]))",
    re.ASCII | re.IGNORECASE,
)


class LineCursor:
    """A line and the character that is next in it. code: the letter and number that a parameter would belong to;
    comment: the last one that was passed; items: how many words and statements were."""

    def __init__(self, language: Language, text: str, file: str, line: int, at: int) -> None:
        self.language = language
        self.text = text
        self.file = file
        self.line = line
        self.at = at
        self.found = DinLine()
        self.words: list[Word] = []
        self.code: tuple[str, int] | None = None
        self.comment = ""
        self.items = 0
        self._last_sign = text.rfind(":=")

    def blanks(self) -> None:
        """Go on after blanks and comments."""
        self.at = self._behind_blanks(self.at)

    def span(self, begin: int, end: int | None = None) -> Span:
        """The place from a column (0 is the first) to another one, None: to here."""
        return Span(self.file, self.line, begin + 1, (self.at if end is None else end) + 1)

    def error(self, code: Code, begin: int, end: int, /, *, hint: str = "", **values: Any) -> Refusal:
        """A refusal at these columns."""
        end = max(begin + 1, begin + len(self.text[begin:end].rstrip()))
        return Refusal(code.at(self.span(begin, end), hint=hint, **values))

    def note(self, kind: NoteKind, begin: int, text: str) -> None:
        """Keep a text for the printer: what it is, where it starts."""
        self.found.notes.append((self.items, kind, begin, text))

    def comments(self) -> bool:
        """Pass blanks and comments; True when something follows."""
        while True:
            self.blanks()
            if self.at >= len(self.text):
                return False
            sign = self.text[self.at]
            if sign == QUOTE or (self.language.old and self.text.startswith("//", self.at)):
                self.comment = self.text[self.at + (1 if sign == QUOTE else 2) :].strip()
                self.note(NoteKind.SIGNED, self.at, self.text[self.at :].rstrip(" \t"))
                self.at = len(self.text)
            elif sign == "(" and not self._is_parameter():
                end = round_comment(self.text, self.at, self.file, self.line, nests=self.language.old)
                self.comment = self.text[self.at + 1 : end - 1].strip()
                self.note(NoteKind.SIGNED, self.at, self.text[self.at : end])
                self.at = end
            else:
                return True

    def _is_parameter(self) -> bool:
        """Whether a bracket here is one of a parameter: after codes that may have one (4, 6)."""
        if self.code is None or self.language.old:
            return False
        letter, number = self.code
        if letter == "M":
            return True
        has_one = bool(self.words) and self.words[-1].letter == PARAMETER
        return (number == 4 and not has_one) or FIRST_USER_CODE <= number <= LAST_USER_CODE

    def behind_comments(self) -> int:
        """Where the line goes on; only the older version has comments in brackets after codes (7 of its manual)."""
        at = self._behind_blanks(self.at)
        while self.language.old and self.text.startswith("(", at):
            at = self._behind_blanks(round_comment(self.text, at, self.file, self.line, nests=True))
        return at

    def _behind_blanks(self, at: int) -> int:
        found = _BLANKS.match(self.text, at)
        assert found is not None
        return found.end()

    def assigned(self, at: int) -> re.Match[str] | None:
        """The name that starts at ``at`` and is assigned to; no name is looked for after the last ``:=``."""
        return _ASSIGNED.match(self.text, at) if at < self._last_sign else None

    def begins_value(self, at: int) -> bool:
        """Whether a value starts at ``at``, not the next word."""
        at = self._behind_blanks(at)
        char = self.text[at : at + 1]
        if char and (char in "0123456789+-(" or (char == "." and self.text[at + 1 : at + 2].isdigit())):
            return True
        if self.assigned(at):
            return False
        if QUALIFIER.match(self.text, at):
            return True
        return self.language.expressions.begins(self.text, at)

    def value(self) -> Expr:
        """The expression at the next character that is not blank."""
        self.blanks()
        literal = _LITERAL.match(self.text, self.at)
        begin = self.at
        if literal is not None:
            self.at = literal.end()
            point = literal["point"] is not None or literal["bare"] is not None
            return Number(float(literal[0]), self.span(begin), point)
        value, self.at = self.language.expressions.number(self.text, begin, self.file, self.line)
        return value

    def no_comment(self, code: str) -> None:
        """A bracket where a parameter can be must hold an expression (6)."""
        if self.text[self.at : self.at + 1] == "(" and not self.language.expressions.fits(self.text, self.at):
            hint = "start a comment with a single quote"
            raise self.error(codes.BRACKET_PARAMETER, self.at, len(self.text), code=code, hint=hint)
