"""Lines of words, settings and conditions read without the grammar: the same nodes, several times faster.

``read_line`` goes through a line once, from the left. It knows correct lines of values, words, settings, ``if`` and
``while`` (manual 3.2, 4.1, 4.2) in their usual spelling; everything else it gives back unread, mistakes too. The
grammar (``parse.parse_line``) is the reference: what is read here equals what it gives, places included, and tests
compare the two on random lines. Blanks need not be taken out first: taking out those between two tokens joins them to
another token only within a number, and such numbers are left to the grammar.
"""

from __future__ import annotations

import re

from gproof.frontend.eding.build import Parsed, Part, Structural, grouped
from gproof.frontend.eding.prepare import FUNCTIONS
from gproof.frontend.eding.scan import WORD_LETTERS
from gproof.ir.dialects.eding.operators import LEVEL, SIGN
from gproof.ir.finding import Span
from gproof.ir.program import Assign, Binary, Block, Expr, Number, Unary, Variable, Word

DEEPEST = 60
"""Brackets and parameters of a line, beyond which the grammar reads it: it needs no stack of Python's."""


def _any_of(words: frozenset[str] | dict[str, int]) -> str:
    return "|".join(map(re.escape, sorted(words, key=lambda word: (-len(word), word))))


_FLAGS = re.IGNORECASE | re.ASCII
_NUMBER = r"(?:[0-9]+\.?[0-9]*|\.[0-9]+)"
_HEAD = re.compile(r"[ \t]*(/)?[ \t]*(?:n[ \t]*[0-9]{1,5})?(?![0-9.])", _FLAGS)
_ITEM = re.compile(
    rf"[ \t]*(?:(?P<letter>[{WORD_LETTERS}])(?:[ \t]*(?P<number>[-+]?{_NUMBER}))?"
    r"|(?P<hash>(?=\#))|(?P<comment>\([^()]*\))|(?P<rest>;.*)|(?P<end>\Z))",
    _FLAGS,
)
_VALUE = re.compile(
    rf"[ \t]*(?:(?P<number>[-+]?{_NUMBER})|(?P<hash>\#)(?:[ \t]*(?P<parameter>{_NUMBER}))?|(?P<open>\[)"
    rf"|(?P<function>{_any_of(FUNCTIONS)})[ \t]*\[|(?P<sign>[-+])[ \t]*(?P<signed>{_NUMBER})?)",
    _FLAGS,
)
_BEHIND = re.compile(rf"[ \t]*(\]|{_any_of(LEVEL)})", _FLAGS)
_EQUALS = re.compile(r"[ \t]*=")
_DIVIDED = re.compile(r"[ \t]*/[ \t]*\[")
_CONDITION = re.compile(r"[ \t]*(?:n[ \t]*[0-9]{1,5}[ \t]*)?(?:\([^()]*\)[ \t]*)*(if|while)[ \t]*\[", _FLAGS)
_AFTER_IF = re.compile(r"[ \t]*(then)?[ \t]*(?:\([^()]*\)[ \t]*)*(?:;.*)?\Z", _FLAGS)
_AFTER_WHILE = re.compile(r"()[ \t]*(?:\([^()]*\)[ \t]*)*(?:;.*)?\Z", _FLAGS)


class _LeftError(Exception):
    """The line is left to the grammar."""


def read_line(text: str, file: str, line: int) -> tuple[Parsed, ...] | None:
    """The block or condition in a line (its text without end, control characters and messages); None: left unread."""
    if text.count("[") + text.count("#") > DEEPEST:
        return None
    reading = _Reading(text, file, line)
    try:
        condition = _CONDITION.match(text)
        return (reading.block(),) if condition is None else (reading.condition(condition),)
    except _LeftError:
        return None


class _Reading:
    """One line being read: its methods take where to start, and give what is there and where it ends."""

    __slots__ = ("file", "line", "text")

    def __init__(self, text: str, file: str, line: int) -> None:
        self.text = text
        self.file = file
        self.line = line

    def span(self, begin: int, end: int) -> Span:
        """The place of ``text[begin:end]``."""
        return Span(self.file, self.line, begin + 1, end + 1)

    def block(self) -> Block:
        """A line of words, settings and comments."""
        text, span = self.text, self.span
        head = _HEAD.match(text)
        if head is None:
            raise _LeftError
        words: list[Word] = []
        assigns: list[Assign] = []
        comment: str | None = None
        rest = ""
        end = at = head.end()
        while True:
            item = _ITEM.match(text, at)
            if item is None:
                raise _LeftError
            kind, at = item.lastgroup, item.end()
            if kind == "number":
                begin, number = item.start("letter"), item["number"]
                node = Number(float(number), span(at - len(number), at), "." in number)
                words.append(Word(text[begin].upper(), node, span(begin, at)))
            elif kind == "letter":
                value = self.value(at)
                begin, at = at - 1, value.end
                words.append(Word(text[begin].upper(), value.node, span(begin, at)))
            elif kind == "hash":
                target, value = self.setting(at)
                at = value.end
                assigns.append(Assign(target.node, value.node, span(target.begin, at)))  # type: ignore[arg-type]
            elif kind == "comment":
                comment = item["comment"][1:-1].strip()
            else:
                rest = item["rest"] or ""
                break
            end = at
        if not words and not assigns:
            raise _LeftError
        whole = span(len(text) - len(text.lstrip(" \t")), end)
        note = rest[1:].strip() if comment is None else comment
        return Block(words=tuple(words), assigns=tuple(assigns), span=whole, comment=note, deleted=head[1] is not None)

    def setting(self, at: int) -> tuple[Part, Part]:
        """What is set, and the value."""
        target = self.value(at)
        equals = _EQUALS.match(self.text, target.end)
        if equals is None:
            raise _LeftError
        return target, self.value(equals.end())

    def condition(self, head: re.Match[str]) -> Structural:
        """An ``if`` or ``while``; head: the line up to its first bracket."""
        keyword = head[1].lower()
        node, end = self.bracket(head.end())
        after = (_AFTER_IF if keyword == "if" else _AFTER_WHILE).match(self.text, end)
        if after is None:
            raise _LeftError
        return Structural(keyword, self.span(head.start(1), max(end, after.end(1))), condition=node)

    def value(self, at: int) -> Part:
        """A real value (3.2.2)."""
        found = _VALUE.match(self.text, at)
        if found is None:
            raise _LeftError
        kind, end, file, line = found.lastgroup, found.end(), self.file, self.line
        if kind == "parameter":
            number, begin = found["parameter"], found.start("hash")
            node = Number(float(number), Span(file, line, end - len(number) + 1, end + 1), "." in number)
            return Part(Variable(node, Span(file, line, begin + 1, end + 1)), begin, end)
        if kind == "number":
            number = found["number"]
            begin = end - len(number)
            return Part(Number(float(number), Span(file, line, begin + 1, end + 1), "." in number), begin, end)
        if kind == "open":
            inside, after = self.bracket(end)
            return Part(inside, end - 1, after)
        if kind == "function":
            return self.function(found["function"].lower(), found.start("function"), end)
        if kind == "signed":
            number, begin = found["signed"], found.start("sign")
            value = float(found["sign"] + number)
            return Part(Number(value, self.span(begin, end), "." in number), begin, end)
        inner = self.value(end)
        if kind == "hash":
            return Part(Variable(inner.node, self.span(end - 1, inner.end)), end - 1, inner.end)
        begin = found.start("sign")
        if self.text[inner.begin] in "+-":
            raise _LeftError
        operator = "neg" if self.text[begin] == "-" else "pos"
        return Part(Unary(operator, inner.node, self.span(begin, inner.end)), begin, inner.end, SIGN)

    def function(self, name: str, begin: int, at: int) -> Part:
        """A function, from after its opening bracket."""
        node, end = self.bracket(at)
        if name != "atan":
            return Part(Unary(name, node, self.span(begin, end)), begin, end)
        divided = _DIVIDED.match(self.text, end)
        if divided is None:
            raise _LeftError
        right, end = self.bracket(divided.end())
        return Part(Binary("atan", node, right, self.span(begin, end)), begin, end)

    def bracket(self, at: int) -> tuple[Expr, int]:
        """What is in brackets, from after the opening one; the end is after the closing one."""
        first, operator, at = self.operand(at)
        if operator == "]":
            return first.node, at
        values, operators = [first], [operator]
        while operators[-1] != "]":
            value, operator, at = self.operand(at)
            values.append(value)
            operators.append(operator)
        return grouped(values, operators[:-1], self.span), at

    def operand(self, at: int) -> tuple[Part, str, int]:
        """A value and what comes after it: an operator or the closing bracket."""
        value = self.value(at)
        behind = _BEHIND.match(self.text, value.end)
        if behind is None:
            raise _LeftError
        return value, behind[1].lower(), behind.end()
