"""The parts of a DIN line of McuWIN: one text for each word, label, jump, call, message of a statement.

What a part looks like is here once. How values, names and texts are written comes from the line that the statement
was read from (``WrittenParts``: brackets and names stay as they are there), or from its tree (``TreeParts``).
Source: McuWIN manual 3 to 6.
"""

from __future__ import annotations

import re
from abc import ABC, abstractmethod
from collections.abc import Sequence
from itertools import pairwise

from gproof.backend.emit.mcuwin.pascal import Printer
from gproof.backend.emit.mcuwin.pascal_words import Spelling, joined_words, words_of
from gproof.backend.emit.numbers import number_text
from gproof.backend.emit.printer import Unprintable
from gproof.ir.program import (
    PARAMETER,
    Block,
    Call,
    Expr,
    Include,
    Jump,
    Label,
    Message,
    Number,
    Return,
    Statement,
    Text,
    Unsupported,
    Word,
)

_LITERAL = re.compile(r"[-+]?(?:[0-9]++(?:\.[0-9]*+)?|\.[0-9]+)", re.ASCII)
_CODE = re.compile(r"[Mm][ \t]*[0-9]+[ \t]*", re.ASCII)
_TARGET = re.compile(r"[Ll][ \t]*(?P<digits>[0-9]+)|(?P<name>[A-Za-z_][A-Za-z0-9_]*)", re.ASCII)
_MODULE = re.compile(r"[a-z_][a-z0-9_]*", re.ASCII)
_LIKE_A_LABEL = re.compile(r"l[0-9]", re.ASCII)
AXIS_ASSIGNMENT = "the assignment to "
"""How ``Unsupported.what`` starts for an assignment to a variable of an axis in a DIN line (3.26)."""


class Parts(ABC):
    """Texts of statements of DIN lines; Unprintable for what is none."""

    def parts(self, node: Statement) -> list[str]:
        """One text for each word, or one for the statement."""
        if isinstance(node, Block) and (node.words or node.assigns):
            return self.words(node.words) or [self._assignment(node)]
        if isinstance(node, Label):
            return [f"L{self._label(node)}"]
        if isinstance(node, Return):
            return ["M17"]
        if isinstance(node, Jump):
            return [f"M96 {self._target(node)}"]
        if isinstance(node, Call):
            count = "" if node.count is None else f" O{self._count(node)}"
            return [f"M98 {self._target(node)}{count}"]
        if isinstance(node, Message):
            return [self._message(node)]
        if isinstance(node, Include):
            return [f"$I {node.name}"]
        if isinstance(node, Unsupported):
            return [self._unsupported(node)]
        raise Unprintable(f"a {type(node).__name__} in a line of words")

    def words(self, words: Sequence[Word]) -> list[str]:
        """One text for each."""
        return [self.word(word) for word in words]

    def word(self, word: Word) -> str:
        """``G01``, ``X5.0``, ``X``, ``X(CD600 + 1)``, ``102``."""
        if word.letter in "GM" and isinstance(word.value, Number):
            code = word.value.value
            if code != int(code) or code < 0:
                raise Unprintable(f"the code {word.letter}{number_text(code, point=False)}")
            return f"{word.letter}{int(code):02d}"
        if word.bare:
            return word.letter
        return self._parameter(word) if word.letter == PARAMETER else word.letter + self._behind(word)

    @abstractmethod
    def _behind(self, word: Word) -> str:
        """What comes after a letter: what is no literal, in brackets."""

    @abstractmethod
    def _parameter(self, word: Word) -> str:
        """What comes after a code."""

    @abstractmethod
    def _assignment(self, node: Block) -> str: ...

    @abstractmethod
    def _label(self, node: Label) -> str:
        """Its digits."""

    @abstractmethod
    def _target(self, node: Jump | Call) -> str:
        """A label or a module."""

    @abstractmethod
    def _count(self, node: Call) -> str:
        """How often, after the letter O."""

    @abstractmethod
    def _message(self, node: Message) -> str: ...

    @abstractmethod
    def _unsupported(self, node: Unsupported) -> str: ...


class WrittenParts(Parts):
    """Of a line that was read. text: the line; stays: it holds what only the line itself can give again."""

    def __init__(self, text: str, spelling: Spelling) -> None:
        self.text = text
        self.spelling = spelling
        self.stays = False

    def _behind(self, word: Word) -> str:
        return self._text(self._own(word)[1:])

    def _parameter(self, word: Word) -> str:
        return self._text(self._own(word), bracketed=False)

    def _assignment(self, node: Block) -> str:
        return self._words(self._own(node))

    def _message(self, node: Message) -> str:
        return self._words(self._own(node))

    def _unsupported(self, node: Unsupported) -> str:
        return self._own(node).strip(" \t")

    def _label(self, node: Label) -> str:
        return self._own(node)[1:].strip(" \t")

    def _target(self, node: Jump | Call) -> str:
        found = self._match(node)
        return f"L{found['digits']}" if found["digits"] else found["name"]

    def _count(self, node: Call) -> str:
        return self._text(self._own(node)[self._match(node).end() :].strip(" \t")[1:])

    def _match(self, node: Jump | Call) -> re.Match[str]:
        own = self._own(node)
        code = _CODE.match(own)
        target = _TARGET.match(own, code.end()) if code is not None else None
        if target is None:
            raise Unprintable("a jump of another language")
        return target

    def _own(self, node: Word | Block | Label | Jump | Call | Message | Unsupported) -> str:
        """The characters of a node."""
        return self.text[node.span.column - 1 : node.span.end_column - 1]

    def _text(self, own: str, *, bracketed: bool = True) -> str:
        """A value, its words apart; bracketed: what is no literal gets brackets if it has none."""
        own = own.strip(" \t")
        if _LITERAL.fullmatch(own):
            return number_text(float(own), "." in own)
        text = self._words(own)
        return f"({text})" if bracketed and not _is_bracketed(own) else text

    def _words(self, own: str) -> str:
        words = list(words_of(own))
        # A comment of rw_SymPas within an expression is no note of the line.
        self.stays = self.stays or any(word.kind == "comment" for word in words)
        return joined_words(words, self.spelling)


class TreeParts(Parts):
    """Of a tree, whatever it came from. old: codes have no brackets after them (version 2.5.3.32)."""

    def __init__(self, printer: Printer, *, old: bool) -> None:
        self.printer = printer
        self.old = old

    def words(self, words: Sequence[Word]) -> list[str]:
        """A second value after a code gets brackets when it has a sign: the first would go on with it."""
        texts = super().words(words)
        for n, (before, word) in enumerate(pairwise(words), 1):
            if before.letter == word.letter == PARAMETER and texts[n][0] in "+-":
                texts[n] = f"({texts[n]})"
        return texts

    def _behind(self, word: Word) -> str:
        if word.braced or not (word.letter.isascii() and word.letter.isupper()):
            raise Unprintable(f"the word {word.letter!r}")
        return self._text(word.value)

    def _parameter(self, word: Word) -> str:
        text = self.printer.expression(word.value) if self.old else self.printer.grouped(word.value)
        if self.old and text[0] == "(":
            raise Unprintable("a bracket after a code, which is a comment in version 2.5.3.32,")
        return text

    def _assignment(self, node: Block) -> str:
        return self.printer.simple(node)

    def _label(self, node: Label) -> str:
        if not node.name.isdigit():
            raise Unprintable(f"the label {node.name!r}")
        return node.name

    def _target(self, node: Jump | Call) -> str:
        if isinstance(node, Call) and (node.arguments or node.line is not None):
            raise Unprintable(f"a call of {node.name!r} with words")
        return target_text(node.name)

    def _count(self, node: Call) -> str:
        assert node.count is not None
        return self._text(node.count)

    def _message(self, node: Message) -> str:
        if any(isinstance(part, Text) and '"' in part.value for part in node.parts):
            raise Unprintable("a text with a double quote in it in a line of words")
        return self.printer.simple(node)

    def _unsupported(self, node: Unsupported) -> str:
        if not node.text or not node.what.startswith(AXIS_ASSIGNMENT):
            raise Unprintable(node.what)
        return node.text

    def _text(self, node: Expr) -> str:
        return self.printer.expression(node) if isinstance(node, Number) else f"({self.printer.expression(node)})"


def target_text(name: str) -> str:
    """A label or a module as M96 and M98 name it: ``L114``, ``up114``, ``Ll5`` of the module l5 (5.1)."""
    if name.isascii() and name.isdigit():
        return f"L{name}"
    if not _MODULE.fullmatch(name):
        raise Unprintable(f"the name {name!r}")
    return f"L{name}" if _LIKE_A_LABEL.match(name) else name


def _is_bracketed(text: str) -> bool:
    """Whether one pair of brackets encloses all of it."""
    depth = 0
    for n, word in enumerate(found := list(words_of(text))):
        depth += {"(": 1, ")": -1}.get(word.text, 0)
        if depth == 0:
            return word.text == ")" and n == len(found) - 1
    return False
