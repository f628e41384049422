"""The words of a line that is not plain: ``G10 L2 P1 X#101``."""

from __future__ import annotations

from collections.abc import Mapping

from gproof.ir.record import field, record
from gproof.verify.translation.rs274.language import GROUP_OF, M_GROUP_OF, Language, Unread
from gproof.verify.translation.rs274.values import Values

TEXTS = ("MSG", "DEBUG", "PRINT")
"""Comments that show a text, and do nothing else (Overview, Messages)."""
ACTIVE = ("LOG", "PROBE", "ABORT", "PY")
"""What comments that do something start with."""
LETTERS = "XYZABCIJKRPQLFSTH"


@record(slots=True)
class Words:
    """g, m: codes in tenths by group; values: of the other letters."""

    g: dict[str, int] = field(default_factory=dict)
    m: dict[str, int] = field(default_factory=dict)
    values: dict[str, float] = field(default_factory=dict)

    def take(self, letter: str) -> float | None:
        """The value of a letter, which is used by that."""
        return self.values.pop(letter, None)

    def need(self, letter: str, code: str) -> float:
        """The same, where a code must have it."""
        found = self.take(letter)
        if found is None:
            raise Unread(f"{code} without {letter}")
        return found


def without_comments(text: str, language: Language) -> str:
    """A line without its comments; Unread for a comment that does something, or a line that is too long."""
    if any(character in language.real_time or ord(character) > 126 for character in text) and language.real_time:
        raise Unread("a character that the controller takes as a command")
    found, at = [], 0
    while at < len(text):
        character = text[at]
        if character == ";":
            _inactive(text[at + 1 :])
            break
        if character == "(":
            end = text.find(")", at)
            if end < 0 or "(" in text[at + 1 : end]:
                raise Unread("a comment without its end")
            _inactive(text[at + 1 : end])
            found.append(" ")
            at = end + 1
            continue
        if character == ")":
            raise Unread("a bracket without its start")
        found.append(character)
        at += 1
    if language.line_length and len(text) > language.line_length:
        raise Unread("a line that is too long")
    return "".join(found).strip()


def _inactive(comment: str) -> None:
    first, comma, _ = comment.strip().upper().partition(",")
    if any(first.startswith(word) and (comma or first == comment.strip().upper()) for word in ACTIVE):
        raise Unread(f"the comment {comment.strip()[:20]!r}, which does something")


def words_of(text: str, language: Language, variables: Mapping[int, float]) -> Words:
    """The words of a line without comments; Unread."""
    reader = Values(text, variables)
    found = Words()
    while True:
        letter = reader.peek()
        if not letter:
            return found
        reader.next()
        if len(letter) != 1 or not letter.isalpha():
            raise Unread(f"{letter!r}")
        if not language.structured and reader.peek() in ("#", "["):
            raise Unread("an expression")
        value = reader.value()
        if letter in "GM":
            _code(letter, value, language, found)
        elif letter in found.values or letter not in LETTERS:
            raise Unread(f"{letter} in this line")
        elif letter in "XYZABC" and letter not in language.axes:
            raise Unread(f"the axis {letter}")
        else:
            found.values[letter] = value


def _code(letter: str, value: float, language: Language, found: Words) -> None:
    tenths = round(value * 10)
    known, groups, codes = (language.g, GROUP_OF, found.g) if letter == "G" else (language.m, M_GROUP_OF, found.m)
    if tenths != value * 10 and abs(tenths - value * 10) > 1e-6:
        raise Unread(f"{letter}{value:g}")
    if tenths not in known:
        raise Unread(f"{letter}{value:g}")
    group = groups[tenths]
    if group in codes:
        raise Unread(f"two codes of one group, the second is {letter}{value:g}")
    codes[group] = tenths
