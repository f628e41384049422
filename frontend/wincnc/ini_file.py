"""The lines of a WINCNC.INI: ``key=value``, comments in square brackets anywhere, with findings at line and column.

Source: WinCNC manual, "System Configuration" (the file is text without formatting), "WINCNC.INI Settings"; comments
as in programs ("Parameters: Comment": the closing bracket is optional). ``ini_keys`` says what a key's value is
made of; this module cuts texts into letters with numbers (``axislo=p2 b6 o1``, blanks or none, any case), and
into letters with texts in quotes (``M"Door open"``).
"""

from __future__ import annotations

import re
from fractions import Fraction
from pathlib import Path
from typing import Any

from gproof.frontend.common.exact_numbers import LARGEST
from gproof.frontend.wincnc.replaced import is_replaced
from gproof.ir import codes
from gproof.ir.finding import Code, Findings, Severity, Span
from gproof.ir.record import record

ENDS_OF_QUOTES = {'"': '"', "“": '”“"', "”": '”“"', "„": '”“"'}
"""What ends a text that starts with this mark: straight quotes, and those that editors make of them."""

_END_OF_LINE = re.compile(r"\r\n|\r|\n")
_SETTING = re.compile(r"\s*(?P<key>[A-Za-z0-9_]+)\s*=\s*(?P<value>.*)", re.ASCII | re.DOTALL)
_EDING_SECTION = re.compile(r"^[ \t]*\[joint_\d+\]", re.IGNORECASE | re.MULTILINE)
_CONTROL = re.compile(r"[\x00-\x08\x0b-\x1f\x7f]")
_LETTER = re.compile(r"\s*(?P<letter>[A-Za-z])\s*", re.ASCII)
_NUMBER = re.compile(r"[-+]?(?:\d++(?:\.\d*+)?|\.\d+)", re.ASCII)
_MOST_DIGITS = 60
LONGEST_LINE = 256
"""Characters that the controller reads of a line (Line Too Long)."""


@record(frozen=True, slots=True)
class Word:
    """A letter and what comes after it. letter: upper case; value: the number exactly, None for a text.

    text: as written, a quoted text without its quotes; column, end_column: from 1, of all of it.
    """

    letter: str
    value: Fraction | None
    text: str
    column: int
    end_column: int


@record(frozen=True, slots=True)
class Setting:
    """A line. key: lower case; shown: as written; text: its value without comments; value_column: where it starts.

    column, end_column: of the key; words: its letters, for keys that have some; first: no other one is above it.
    """

    key: str
    shown: str
    text: str
    line: int
    column: int
    end_column: int
    value_column: int
    first: bool
    words: tuple[Word, ...] = ()

    def word(self, letter: str) -> Word | None:
        """The word with that letter."""
        return next((word for word in self.words if word.letter == letter), None)


class IniFile:
    """The settings of a file in order, and the findings about it.

    stated: what a machine file that refines this one states again (``replaced``); columns: of axes by letter, axis_of:
    by the line of a setting that belongs to one.
    """

    def __init__(self, name: str, findings: Findings, stated: frozenset[tuple[str, ...]] = frozenset()) -> None:
        self.stated = stated
        self.columns: dict[str, str] = {}
        self.axis_of: dict[int, str] = {}
        self.name = name
        self.findings = findings
        self.errors = 0
        self.unknown: list[tuple[str, str]] = []
        self.settings: list[Setting] = []
        self.hint = ""

    def add(self, code: Code, line: int, column: int = 0, end_column: int = 0, **values: Any) -> None:
        """A finding at a place; an error makes the file bad."""
        self.errors += code.severity is Severity.ERROR
        self.findings.add(code.at(Span(self.name, line, column, end_column), **values))

    def bad(self, setting: Setting, what: str, word: Word | None = None) -> None:
        """A finding for the value of a setting, or for one letter of it, unless it is stated again."""
        if self.is_replaced(setting, "" if word is None else word.letter):
            return
        if word is not None:
            key = f"{setting.shown}= {word.letter}"
            self.add(codes.BAD_VALUE, setting.line, word.column, word.end_column, key=key, what=what)
            return
        begin = setting.value_column if setting.text else setting.column
        end = begin + len(setting.text) if setting.text else setting.end_column
        self.add(codes.BAD_VALUE, setting.line, begin, end, key=f"{setting.shown}=", what=what)

    def is_replaced(self, setting: Setting, letter: str) -> bool:
        """Whether a file that refines this one states what a letter of a setting says, "" its only value."""
        return is_replaced(self.stated, setting.key, letter, self.axis_of.get(setting.line, ""), self.columns)

    def report_unknown(self, setting: Setting, word: Word | None = None, what: str = "") -> None:
        """A warning for a key, or a letter of one, that gproof has never heard of."""
        shown = f"{setting.shown}=" + (f" {word.letter}" if word is not None else "") + (f" ({what})" if what else "")
        self.unknown.append((Path(self.name).name, shown))
        place = (setting.column, setting.end_column) if word is None else (word.column, word.end_column)
        self.add(codes.UNKNOWN_KEY, setting.line, *place, key=shown)

    def parse(self, text: str) -> None:
        """Read the lines of the whole file; the values stay texts. hint: what else the file may be."""
        if _EDING_SECTION.search(text) is not None:
            self.hint = "rename it: this looks like the cnc.ini of Eding CNC, not WINCNC.INI"
        for number, line in enumerate(_END_OF_LINE.split(text.removesuffix("\x1a")), 1):
            control = _CONTROL.search(line)
            if control is not None:
                what = f"control character U+{ord(control.group()):04X} in the line"
                self.add(codes.FILE_UNREADABLE, number, control.start() + 1, control.end() + 1, what=what)
                continue
            bare = without_comments(line).rstrip()
            if not bare:
                continue
            found = _SETTING.fullmatch(bare)
            if found is None:
                begin = len(bare) - len(bare.lstrip())
                what = "neither key=value nor a comment in square brackets"
                self.add(codes.FILE_UNREADABLE, number, begin + 1, len(bare) + 1, what=what)
                continue
            shown, value, begin = found["key"], found["value"], found.start("value")
            if shown.lower() == "comchars":
                behind = line[bare.index("=") + 1 :]
                begin = len(line) - len(behind.lstrip())
                value = _signs(behind.strip())
            self.settings.append(
                Setting(
                    key=shown.lower(),
                    shown=shown,
                    text=value,
                    line=number,
                    column=found.start("key") + 1,
                    end_column=found.end("key") + 1,
                    value_column=begin + 1,
                    first=not self.settings,
                )
            )

    def words(self, setting: Setting) -> tuple[Word, ...] | None:
        """The letters of a value in order; None, with a finding, when it has any other part."""
        found: list[Word] = []
        at, text = 0, setting.text
        while at < len(text):
            word = self._word(setting, at)
            if word is None:
                return None
            before = next((one for one in found if one.letter == word.letter), None)
            if before is not None:
                self.bad(setting, f"{word.letter} is given twice", word)
                return None
            found.append(word)
            at = word.end_column - setting.value_column
            while at < len(text) and text[at].isspace():
                at += 1
        return tuple(found)

    def _word(self, setting: Setting, at: int) -> Word | None:
        """The word at an index of the value."""
        text, base = setting.text, setting.value_column
        letter = _LETTER.match(text, at)
        if letter is None:
            self._bad_part(setting, at, f"{text[at]!r} instead of a letter with a number")
            return None
        begin, mark = letter.end(), text[letter.end() : letter.end() + 1]
        if mark in ENDS_OF_QUOTES and mark:
            end = next((i for i in range(begin + 1, len(text)) if text[i] in ENDS_OF_QUOTES[mark]), -1)
            if end < 0:
                self._bad_part(setting, begin, "a text has no closing quote")
                return None
            name = letter["letter"].upper()
            return Word(name, None, text[begin + 1 : end], base + letter.start("letter"), base + end + 1)
        number = _NUMBER.match(text, begin)
        value = None if number is None else exact(number.group())
        if number is None or value is None:
            what = "it has no number" if number is None else f"{number.group()[:20]} is too large"
            word = Word(letter["letter"].upper(), None, "", base + letter.start("letter"), base + letter.end("letter"))
            self.bad(setting, what, word)
            return None
        return Word(letter["letter"].upper(), value, number.group(), base + letter.start("letter"), base + number.end())

    def _bad_part(self, setting: Setting, at: int, what: str) -> None:
        column = setting.value_column + at
        self.add(codes.BAD_VALUE, setting.line, column, column + 1, key=f"{setting.shown}=", what=what)


def _signs(text: str) -> str:
    """The value of comchars=. A bracket in it that is not closed, or after which another one opens, is a sign.

    After a blank it starts a comment, as in all other places.
    """
    if len(text) > LONGEST_LINE:
        return without_comments(text).rstrip()
    found, at = "", 0
    while at < len(text):
        closing, following = text.find("]", at), text.find("[", at + 1)
        if text[at] == "[" and closing >= 0 and (following < 0 or closing < following):
            at = closing
        elif text[at] == "[" and found[-1:].isspace():
            break
        else:
            found += text[at]
        at += 1
    return found.rstrip()


def without_comments(line: str) -> str:
    """The line with blanks in place of what is in square brackets, so that columns stay.

    A bracket within quotes belongs to the text; one that is not closed reaches to the end of the line.
    """
    found = list(line)
    at = 0
    while at < len(line):
        sign = line[at]
        if sign in ENDS_OF_QUOTES:
            closing = next((i for i in range(at + 1, len(line)) if line[i] in ENDS_OF_QUOTES[sign]), -1)
            at = max(closing, at) + 1
        elif sign == "[":
            closing = line.find("]", at)
            end = len(line) if closing < 0 else closing + 1
            found[at:end] = " " * (end - at)
            at = end
        else:
            at += 1
    return "".join(found)


def exact(text: str) -> Fraction | None:
    """A decimal number as written, exactly; None for anything else and for what is absurdly large."""
    if len(text) > _MOST_DIGITS or _NUMBER.fullmatch(text) is None:
        return None
    value = Fraction(text)
    return value if abs(value) <= LARGEST else None
