"""Text of rw_SymPas in its form, word by word: blanks between words, words of the language in lower case.

Brackets, names and the order of everything stay as written, so that the text means what it meant whatever the machine
makes of it. Source: McuWIN manual 5.7, 7, 8, 10 to 12.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from typing import NamedTuple

from gproof.backend.emit.numbers import number_text
from gproof.ir.dialects.mcuwin.pascal import FUNCTIONS, KEYWORDS

_WORD = re.compile(
    r"""[ \t]*(?:
        (?P<sign>\{[ \t]*\$[Dd][Ii][Nn][Ss][Tt][Aa][Rr][Tt][ \t]*\}|\$[Dd][Ii][Nn][Ee][Nn][Dd](?![A-Za-z0-9_]))
      | (?P<axis>[A-Za-z]+\.[A-Za-z_]\w*(?:\.[0-9]+)?)
      | (?P<name>[A-Za-z_]\w*)
      | (?P<number>(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?)
      | (?P<string>"[^"]*"|'(?:[^']|'')*')
      | (?P<comment>//.*|\{[^}]*\}|\{.*)
      | (?P<op>:=|<=|>=|<>|[-+*/=<>()\[\],;:])
      | (?P<other>\S)
    )""",
    re.VERBOSE | re.ASCII,
)
_COMMON = re.compile(r"c[di][0-9]+", re.IGNORECASE | re.ASCII)
_VALUES = frozenset(("end", "true", "false", "integer", "double", "boolean"))
"""Words of the language after which a sign is between two values."""

_TEXTS = frozenset(("axis", "name", "number"))


class PascalWord(NamedTuple):
    """kind: ``sign`` ($DINEND, {$DINSTART}), ``axis``, ``name``, ``number``, ``string``, ``comment``, ``op`` or
    ``other``; low: text in lower case; ``begin``, ``end``: its characters in the line, from 0."""

    kind: str
    text: str
    low: str
    begin: int
    end: int


class Spelling(NamedTuple):
    """How names are printed. keeps: names and words stay as they are written, since case matters; declared: names that
    the text declares, in lower case, each as it is declared, "" where it is in several ways; None: names stay as they
    are written, since nobody said whether case matters."""

    keeps: bool = False
    declared: Mapping[str, str] | None = None


def words_of(text: str, at: int = 0, *, opened: bool = False) -> Iterator[PascalWord]:
    """The words of a line from character ``at``; opened: a comment of an earlier line is open there."""
    if opened:
        close = text.find("}", at) + 1 or len(text)
        yield PascalWord("comment", text[at:close].rstrip(" \t"), "", at, close)
        at = close
    while (found := _WORD.match(text, at)) is not None:
        kind = found.lastgroup or ""
        begin, at = found.span(kind)
        written = text[begin:at].rstrip(" \t") if kind == "comment" else text[begin:at]
        yield PascalWord(kind, written, written.lower(), begin, at)


def leaves_open(words: Sequence[PascalWord]) -> bool:
    """Whether a comment is open after a line."""
    last = words[-1] if words else None
    return last is not None and last.kind == "comment" and last.text[:2] != "//" and last.text[-1:] != "}"


def joined_words(words: Sequence[PascalWord], spelling: Spelling) -> str:
    """Words that are no comments, with blanks between them."""
    parts: list[str] = []
    before: PascalWord | None = None
    binds = False
    for n, word in enumerate(words):
        after = words[n + 1] if n + 1 < len(words) else None
        if before is not None and not binds and _is_apart(before, word):
            parts.append(" ")
        glued = _is_glued(before, word) or _is_glued(word, after)
        parts.append(word.text if glued else _spelled(word, after, spelling))
        binds = word.text in ("(", "[", "$") or (word.text in ("+", "-") and _is_unary(before))
        before = word
    return "".join(parts)


def _is_apart(before: PascalWord, word: PascalWord) -> bool:
    """Whether a blank is between two words."""
    if "other" in (before.kind, word.kind) or {before.kind, word.kind} <= _TEXTS:
        return word.begin > before.end
    if word.text in (")", "]", ",", ";", ":"):
        return False
    if word.text in ("(", "["):
        return before.kind != "name" or (before.low in KEYWORDS and before.low != "boolean")
    return True


def _is_glued(before: PascalWord | None, word: PascalWord | None) -> bool:
    """Whether two words are together that no language has so: whatever they are, they stay."""
    if before is None or word is None or word.begin > before.end:
        return False
    return {before.kind, word.kind} <= _TEXTS


def _is_unary(before: PascalWord | None) -> bool:
    """Whether a sign after this word is before a value."""
    if before is None:
        return True
    if before.kind == "op":
        return before.text not in (")", "]")
    return before.kind == "name" and before.low in KEYWORDS - _VALUES


def _spelled(word: PascalWord, after: PascalWord | None, spelling: Spelling) -> str:
    if word.kind == "sign":
        return "$DINEND" if word.text[0] == "$" else "{$DINSTART}"
    if word.kind == "number":
        plain = "." in word.text and "e" not in word.low
        return number_text(float(word.text), point=True) if plain else word.text
    if spelling.keeps or word.kind not in ("name", "axis"):
        return word.text
    if word.kind == "axis":
        axis, _, rest = word.text.partition(".")
        return f"{axis.upper()}.{rest.lower()}"
    calls = after is not None and after.text == "("
    if word.low in KEYWORDS:
        return word.text.upper() if word.low in ("write", "writeln") or (word.low == "boolean" and calls) else word.low
    if _COMMON.fullmatch(word.text):
        return word.text.upper()
    if spelling.declared is None:
        return word.text
    if word.low in spelling.declared:
        return spelling.declared[word.low] or word.text
    return word.low if calls and (word.low in FUNCTIONS or word.low == "wt") else word.text


class SectionLayout:
    """Indents the lines of a section: two blanks for each block around them, for declarations after their word, and
    for what goes on with a statement of the line before."""

    def __init__(self, base: int) -> None:
        self.base = base
        self.depth = 0
        self.group = False
        self.last: PascalWord | None = None

    def indent(self, words: Sequence[PascalWord]) -> int:
        """Blocks before a line of these words, which are no comments; they count for the lines after it."""
        if not words:
            return self.base + self.depth + self.group
        first = words[0]
        heads = first.kind == "name" and first.low in ("var", "const", "label", "procedure", "function")
        goes_on = self._goes_on(first) and not heads
        self.group = self.group and not heads and (goes_on or _declares(words))
        depth = self.depth - (first.low in ("end", "until"))
        indent = self.base + max(0, depth) + (goes_on or self.group)
        self._pass(words)
        self.group = self.group or (heads and first.low in ("var", "const", "label"))
        return indent

    def _goes_on(self, first: PascalWord) -> bool:
        if self.last is None or first.low in ("begin", "end", "until", "else"):
            return False
        return self.last.text not in (";", ":") and self.last.low not in ("begin", "repeat", "of")

    def _pass(self, words: Sequence[PascalWord]) -> None:
        changes = {"begin": 1, "repeat": 1, "case": 1, "end": -1, "until": -1}
        for word in words:
            self.depth = max(0, self.depth + (changes.get(word.low, 0) if word.kind == "name" else 0))
        self.last = words[-1]


def _declares(words: Sequence[PascalWord]) -> bool:
    return words[0].low not in KEYWORDS and any(word.text in (":", "=", ",") for word in words[1:2])


def block_change(words: Sequence[PascalWord]) -> tuple[int, int]:
    """Of a ``$`` line, from after its sign: (blocks that it closes first, blocks that are open after it)."""
    lows = [word.low for word in words if word.text != ";"]
    closes = bool(lows) and lows[0] in ("end", "until")
    opens = bool(lows) and (lows[-1] == "begin" or lows == ["repeat"])
    return int(closes), int(opens)


def declared_names(names: Collection[str]) -> dict[str, str]:
    """Lower case -> name, "" for one that is declared in several ways."""
    found: dict[str, str] = {}
    for name in names:
        found[name.lower()] = name if found.get(name.lower(), name) == name else ""
    return found
