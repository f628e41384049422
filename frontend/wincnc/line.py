"""One line of a WinCNC program that is not plain: its items, as written.

A line is words (a letter with a number, an expression in braces, or nothing, which counts as 0), texts in double
quotes after a letter, a name after some commands, and comments at its end (manual: Command Reference, Axis
Specification, Comment, Braces; Macro File Configuration for the tilde). What the items mean is ``statements.py``'s.
"""

from __future__ import annotations

import re
from typing import Any

from gproof.frontend.common.comment_hints import comment_hint
from gproof.frontend.wincnc.comment_style import COMMENTS
from gproof.frontend.wincnc.scan import CLOSING, COMMENT_SIGNS
from gproof.ir import codes
from gproof.ir.dialects.accepts import LINE_NUMBERS, TEXT_AFTER_COMMENT
from gproof.ir.dialects.wincnc.settings import Lexical
from gproof.ir.finding import Code, Finding, Span
from gproof.ir.program import Binary, Expr, Named, Number, Text, Word
from gproof.ir.record import field, record

LARGEST = 1e300
"""What a number may be: codes are looked up by their tenfold, which has to be one too."""
TOO_LARGE = "a number that is too large for a double"
OPERATORS = "*/+-"
_NUMBER = re.compile(r"[-+]?(?:[0-9]++(?:\.[0-9]*+)?|\.[0-9]+)")
_COMMA_NUMBER = re.compile(r"[-+]?(?:[0-9]+[.,]?[0-9]*|[.,][0-9]+)")
_NAME = re.compile(r"[A-Za-z][A-Za-z0-9]*")
_BLANKS = re.compile(r"[ \t]*")
_LINE_NUMBER = re.compile(r"[ \t]*[Nn][ \t]*([0-9]+)(?![0-9.,])")
_INSIDE = re.compile(
    r"[ \t]*(?:(?P<name>[A-Za-z][A-Za-z0-9]*)|(?P<first>[-+]?(?:[0-9]++(?:\.[0-9]*+)?|\.[0-9]+)))[ \t]*"
    r"(?:(?P<operator>[-+*/])[ \t]*(?P<second>[-+]?(?:[0-9]++(?:\.[0-9]*+)?|\.[0-9]+)))?[ \t]*\Z"
)


class LineError(Exception):
    """A mistake in a line: where its characters start and end, from 0."""

    def __init__(self, code: Code, begin: int, end: int, /, **values: Any) -> None:
        super().__init__(code.name)
        self.code = code
        self.begin = begin
        self.end = end
        self.values = values

    def finding(self, file: str, line: int) -> Finding:
        """As a finding in a file."""
        return self.code.at(Span(file, line, self.begin + 1, self.end + 1), **self.values)


class NumberedLine(LineError):
    """A line with a number of its own, on a controller of which nobody said that it takes them."""

    def __init__(self, code: Code, begin: int, end: int, /, **values: Any) -> None:
        what = {"code": "an N at the start of a line, which is not in the manual,", "hint": LINE_NUMBERS.hint}
        super().__init__(code, begin, end, **{**what, **values})


@record(slots=True)
class Items:
    """A line that was read.

    words: in order; texts: those in quotes, by the letter before; own: it starts with a tilde; rest: the text after
    the word that ``rest_after`` requested, and where it starts; comment: the last one's text, "" for none; end: of the
    code, in characters.
    """

    words: list[Word] = field(default_factory=list)
    texts: list[tuple[str, Text]] = field(default_factory=list)
    own: bool = False
    rest: str | None = None
    rest_at: int = 0
    comment: str = ""
    begin: int = 0
    end: int = 0


_CONTINUED = TEXT_AFTER_COMMENT.hint


class LineReader:
    """Reads lines with the settings of one machine. text_codes: letter and tenths of codes with a text after them."""

    def __init__(self, lexical: Lexical, text_codes: frozenset[tuple[str, int]]) -> None:
        self.signs = COMMENT_SIGNS + lexical.comment_signs
        self.number = _COMMA_NUMBER if lexical.comma else _NUMBER
        self.text_codes = text_codes
        self.continued = lexical.continued
        self.has_continued = False
        """Whether words after a closed comment were met, where they are executed."""
        self.numbered = lexical.numbered
        self.has_numbers = False
        """Whether numbers of lines were met, where they do nothing."""

    def cut(self, text: str) -> tuple[str, str]:
        """A line without its comments, and the last comment; LineError GP134 for text after a closed one."""
        at, quoted = 0, False
        while at < len(text) and (quoted or text[at] not in self.signs):
            quoted ^= text[at] == '"'
            at += 1
        code, comment = text[:at], ""
        while at < len(text):
            closing = CLOSING.get(text[at])
            end = text.find(closing, at + 1) if closing is not None else -1
            comment = text[at + 1 : end if end >= 0 else len(text)].strip()
            at = len(text) if end < 0 else _skip(text, end + 1)
            if at < len(text) and text[at] not in self.signs:
                if not self.continued:
                    raise LineError(codes.TEXT_BEHIND_COMMENT, at, len(text), text=text[at:].strip(), hint=_CONTINUED)
                self.has_continued = True
                more, last = self.cut(" " * at + text[at:])
                return code + more[len(code) :], last or comment
        return code, comment

    def read(self, text: str, file: str, line: int) -> Items:
        """The items of a line; LineError for a mistake."""
        code, comment = self.cut(text)
        items = Items(comment=comment)
        at = _skip(code, 0)
        items.begin = at
        if code[at : at + 1] == "~":
            items.own, at = True, _skip(code, at + 1)
        while at < len(code):
            begin = at
            letter = code[at].upper()
            if not ("A" <= letter <= "Z" and code[at].isascii()):
                what = "this is not a command, word or file name of WinCNC"
                hint = comment_hint(COMMENTS, code, at)
                raise LineError(codes.SYNTAX, at, len(code.rstrip()), what=what, hint=hint)
            at = _skip(code, at + 1)
            if code[at : at + 1] in ('"', "“", "”") and code[at : at + 1]:
                at = self._quoted(items, letter, code, at, file, line)
                continue
            value, end = self._value(code, begin, at, file, line)
            bare, braced = end == begin + 1, code[end - 1] == "}"
            items.words.append(Word(letter, value, Span(file, line, begin + 1, end + 1), bare, braced))
            items.end = end
            at = _skip(code, end)
            if isinstance(value, Number) and (letter, round(value.value * 10)) in self.text_codes:
                rest = code[at:].rstrip()
                items.rest, items.rest_at = rest, at
                items.end = at + len(rest) if rest else items.end
                break
        return items

    def _quoted(self, items: Items, letter: str, code: str, at: int, file: str, line: int) -> int:
        ends = '"“”'
        end = next((i for i in range(at + 1, len(code)) if code[i] in ends), -1)
        if end < 0:
            raise LineError(codes.SYNTAX, at, len(code), what="this text has no closing quote")
        items.texts.append((letter, Text(code[at + 1 : end], Span(file, line, at + 1, end + 2))))
        items.end = end + 1
        return _skip(code, end + 1)

    def _value(self, code: str, begin: int, at: int, file: str, line: int) -> tuple[Expr, int]:
        """The number or braces after a letter, which ends at ``at`` (blanks passed); where it ends."""
        if code[at : at + 1] == "{":
            end = code.find("}", at)
            if end < 0:
                raise LineError(codes.BAD_EXPRESSION, at, len(code), what="this brace is not closed")
            return self.braces(code, at, end, file, line), end + 1
        found = self.number.match(code, at)
        if found is None:
            return Number(0.0, Span(file, line, begin + 1, begin + 2)), begin + 1
        text = found.group()
        span = Span(file, line, at + 1, found.end() + 1)
        return _literal(text, span), found.end()

    def braces(self, code: str, begin: int, end: int, file: str, line: int) -> Expr:
        """What is in ``code[begin + 1:end]``: a name or number, and at most one operator with a number."""
        found = _INSIDE.match(code, begin + 1, end)
        span = Span(file, line, begin + 1, end + 2)
        if found is None:
            what = "braces must hold a name or a number, then at most one of * / + - and a number"
            raise LineError(codes.BAD_EXPRESSION, begin, end + 1, what=what)
        first: Expr
        if found["name"]:
            first = Named(found["name"].upper(), span)
        else:
            first = _literal(found["first"], span)
        if not found["operator"]:
            return first
        second = _literal(found["second"], span)
        return Binary(found["operator"], first, second, span)


def _literal(text: str, span: Span) -> Number:
    """A number as it is written; LineError for one beyond doubles: lines of a macro may be of any length."""
    value = float(text.replace(",", "."))
    if abs(value) > LARGEST:
        raise LineError(codes.BAD_EXPRESSION, span.column - 1, span.end_column - 1, what=TOO_LARGE)
    return Number(value, span, "." in text or "," in text)


def line_number(code: str) -> re.Match[str] | None:
    """What may number a line, at its start: an N with a whole number, its digits the group."""
    return _LINE_NUMBER.match(code)


def _skip(text: str, at: int) -> int:
    found = _BLANKS.match(text, at)
    assert found is not None
    return found.end()
