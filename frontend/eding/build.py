"""The actions of the grammar: from what its rules matched to the nodes of a Program.

``Builder`` has a method for each rule and alias of ``grammar.lark``; what a rule means is there.
"""

# ruff: noqa: D102

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

from gproof.frontend.eding.newer import meaning
from gproof.frontend.eding.prepare import Line, LineError
from gproof.frontend.eding.scan import WORD_LETTERS
from gproof.ir import codes
from gproof.ir.dialects.accepts import LONG_DIALOGS
from gproof.ir.dialects.eding.operators import LEVEL, SIGN, Tree, groupings, is_doubtful
from gproof.ir.finding import Code, Span
from gproof.ir.program import (
    Assign,
    Binary,
    Block,
    Call,
    Device,
    Expr,
    Guard,
    Message,
    Number,
    Statement,
    Text,
    Unary,
    Unsupported,
    Variable,
    Word,
)
from gproof.ir.record import record

if TYPE_CHECKING:
    from lark import Token

Tokens = Any
"""What lark hands to a rule's function: tokens and the values of inner rules."""


STRUCTURAL = frozenset("if else endif while endwhile sub endsub".split())


@record(frozen=True, slots=True)
class Structural:
    """A line that opens, divides or closes a block of lines.

    keyword: one of STRUCTURAL; condition of if and while; name of sub.
    """

    keyword: str
    span: Span
    condition: Expr | None = None
    name: str = ""


Parsed = Statement | Structural


class Part(NamedTuple):
    """An expression on its way up: node, ``begin`` and ``end`` in the code of the line.

    operator: its outermost operator when that is without brackets (``sign`` for a sign before
    something that is no number), else "".
    """

    node: Expr
    begin: int
    end: int
    operator: str = ""


def grouped(values: Sequence[Part], operators: Sequence[str], span: Callable[[int, int], Span]) -> Expr:
    """Values with operators between them: the tighter level first, within a level the left one first.

    span: the place of what is between two indices of the values.
    """
    done: list[Part] = [values[0]]
    waiting: list[str] = []
    doubt = False
    for operator, value in zip(operators, values[1:], strict=True):
        while waiting and LEVEL[waiting[-1]] >= LEVEL[operator]:
            doubt |= _combine(done, waiting.pop(), span)
        waiting.append(operator)
        done.append(value)
    while waiting:
        doubt |= _combine(done, waiting.pop(), span)
    node = done[0].node
    if doubt and isinstance(node, Binary):
        trees = groupings(tuple(operators), tuple(value.operator == SIGN for value in values))
        return replace(node, readings=tuple(_grown(tree, values, operators, span).node for tree in trees))
    return node


def _grown(
    tree: Tree, values: Sequence[Part], operators: Sequence[str], span: Callable[[int, int], Span]
) -> Part:  # fmt: skip
    """The nodes of a tree of places."""
    if isinstance(tree, int):
        if tree >= 0:
            return values[tree]
        signed = values[~tree]
        assert isinstance(signed.node, Unary)
        return Part(signed.node.operand, signed.begin, signed.end)
    operator, one, other = tree
    right = _grown(other, values, operators, span)
    if operator == SIGN:
        assert isinstance(one, int)
        signed = values[one]
        assert isinstance(signed.node, Unary)
        node: Expr = Unary(signed.node.operator, right.node, span(signed.begin, right.end))
        return Part(node, signed.begin, right.end, SIGN)
    assert isinstance(operator, int)
    left = _grown(one, values, operators, span)
    node = Binary(operators[operator], left.node, right.node, span(left.begin, right.end))
    return Part(node, left.begin, right.end, operators[operator])


def _combine(done: list[Part], operator: str, span: Callable[[int, int], Span]) -> bool:
    """The last two values become one; whether the manual leaves open that they do."""
    right, left = done.pop(), done.pop()
    doubtful = is_doubtful(operator, left.operator) or is_doubtful(operator, right.operator)
    node = Binary(operator, left.node, right.node, span(left.begin, right.end), doubtful)
    done.append(Part(node, left.begin, right.end, operator))
    return doubtful


ATAN_TAKES_TWO = "'atan' needs two values: atan[y]/[x]"

DIALOG_VALUES = 12  # 4.2


class Builder:
    """The actions of the grammar: each rule and alias of ``grammar.lark`` has the method of its name.

    Every method takes the tokens and values of its rule in order.
    """

    def __init__(self) -> None:
        self.file = ""
        self.row = 0
        self.line = Line("", "block", "", -1, "", [0], "")

    def span(self, begin: int, end: int) -> Span:
        """The place of ``code[begin:end]`` in the source."""
        places = self.line.places
        last = places[end - 1] + 1 if end > begin else places[begin]
        return Span(self.file, self.row, places[begin] + 1, last + 1)

    def error(self, code: Code, begin: int, end: int, **values: Any) -> LineError:
        """A mistake at ``code[begin:end]``."""
        places = self.line.places
        return LineError(code, places[begin], places[end - 1] + 1, **values)

    # ---- expressions: each gives a Part ----

    def number(self, tokens: Tokens) -> Part:
        begin, end = _range(tokens[0])
        return Part(Number(float(tokens[0]), self.span(begin, end), "." in tokens[0]), begin, end)

    def signed(self, tokens: Tokens) -> Part:
        begin, value = _range(tokens[0])[0], tokens[1]
        if value.operator == SIGN or self.line.code[value.begin] in "+-":
            raise self.error(codes.BAD_NUMBER, begin, value.end, text=self.line.code[begin : value.end])
        operator = "neg" if tokens[0] == "-" else "pos"
        return Part(Unary(operator, value.node, self.span(begin, value.end)), begin, value.end, SIGN)

    def parameter(self, tokens: Tokens) -> Part:
        begin, inner = _range(tokens[0])[0], tokens[1]
        return Part(Variable(inner.node, self.span(begin, inner.end)), begin, inner.end)

    def plain_parameter(self, tokens: Tokens) -> Part:
        begin, end = _range(tokens[0])
        return Part(Variable(self._literal(tokens[0]), self.span(begin, end)), begin, end)

    def _literal(self, token: Token) -> Number:
        """The number after the first character of a token."""
        begin, end = _range(token)
        text = token[1:]
        return Number(float(text), self.span(begin + 1, end), "." in text)

    def bracket(self, tokens: Tokens) -> Part:
        begin, end = _range(tokens[0])[0], _range(tokens[-1])[1]
        values, operators = tokens[1:-1:2], [token.lower() for token in tokens[2:-1:2]]
        return Part(grouped(values, operators, self.span), begin, end)

    def function(self, tokens: Tokens) -> Part:
        begin, inner = _range(tokens[0])[0], tokens[1]
        node = Unary(str(tokens[0]).lower(), inner.node, self.span(begin, inner.end))
        return Part(node, begin, inner.end)

    def arctangent(self, tokens: Tokens) -> Part:
        begin, left, right = _range(tokens[0])[0], tokens[1], tokens[3]
        if tokens[2] != "/":
            raise self.error(codes.BAD_EXPRESSION, *_range(tokens[2]), what=ATAN_TAKES_TWO)
        node = Binary("atan", left.node, right.node, self.span(begin, right.end))
        return Part(node, begin, right.end)

    # ---- items of a block ----

    def word(self, tokens: Tokens) -> Word:
        return self._word(_range(tokens[0])[0], tokens[1].node, tokens[1].end)

    def plain_word(self, tokens: Tokens) -> Word:
        begin, end = _range(tokens[0])
        return self._word(begin, self._literal(tokens[0]), end)

    def _word(self, begin: int, value: Expr, end: int) -> Word:
        letter = self.line.code[begin].upper()
        if letter == "N":
            raise self.error(codes.BAD_LINE_NUMBER, begin, end, text=self.line.code[begin + 1 : end])
        if letter not in WORD_LETTERS:
            what = f"{letter!r} is not the letter of a word of this controller"
            raise self.error(codes.SYNTAX, begin, begin + 1, what=what)
        return Word(letter, value, self.span(begin, end))

    def setting(self, tokens: Tokens) -> Assign:
        begin, inner, value = _range(tokens[0])[0], tokens[1], tokens[2]
        target = Variable(inner.node, self.span(begin, inner.end))
        return Assign(target, value.node, self.span(begin, value.end))

    def plain_setting(self, tokens: Tokens) -> Assign:
        target, value = self.plain_parameter(tokens[:1]), tokens[1]
        assert isinstance(target.node, Variable)
        return Assign(target.node, value.node, self.span(target.begin, value.end))

    def comment(self, tokens: Tokens) -> Comment:
        text = str(tokens[0])[1:-1]
        begin, end = _range(tokens[0])
        message = _MESSAGE.match(text)
        if message is None:
            return Comment(text.strip(), None)
        shown = text[message.end() :].strip()
        span = self.span(begin, end)
        return Comment(text.strip(), Message(kind="msg", parts=(Text(shown, span),), span=span, in_comment=True))

    def prefix(self, tokens: Tokens) -> bool:
        """Whether the line starts with a slash; its line number is checked and forgotten."""
        for token in tokens:
            if token.type == "LINE_NUMBER" and not 2 <= len(token) <= 6:
                begin, end = _range(token)
                raise self.error(codes.BAD_LINE_NUMBER, begin, end, text=str(token)[1:])
        return bool(tokens) and tokens[0].type == "SLASH"

    def block(self, tokens: Tokens) -> list[Parsed]:
        deleted, items = tokens[0], tokens[1:]
        words = tuple(item for item in items if isinstance(item, Word))
        assigns = tuple(item for item in items if isinstance(item, Assign))
        comments = [item for item in items if isinstance(item, Comment)]
        found: list[Parsed] = []
        if comments and comments[-1].message is not None:  # only the last comment counts (3.2.5)
            found.append(comments[-1].message)
        if words or assigns:
            comment = comments[-1].text if comments else self.line.comment
            span = self.span(0, len(self.line.code))
            found.append(Block(words=words, assigns=assigns, span=span, comment=comment, deleted=deleted))
        return found

    # ---- statements of chapter 4 ----

    def flow(self, tokens: Tokens) -> list[Parsed]:
        deleted = tokens[0]
        statement = next(item for item in tokens[1:] if not isinstance(item, Comment))
        if not deleted:
            return [statement]
        if isinstance(statement, Structural):
            what = f"a block delete slash before {statement.keyword!r}"
            raise self.error(codes.FLOW_WORD_MISPLACED, 0, 1, what=what)
        return [replace(statement, deleted=True)]

    def if_(self, tokens: Tokens) -> Structural:
        return Structural("if", _range_span(self, tokens), condition=tokens[1].node)

    def while_(self, tokens: Tokens) -> Structural:
        return Structural("while", _range_span(self, tokens), condition=tokens[1].node)

    def else_(self, tokens: Tokens) -> Structural:
        return Structural("else", _range_span(self, tokens))

    def endif(self, tokens: Tokens) -> Structural:
        return Structural("endif", _range_span(self, tokens))

    def endwhile(self, tokens: Tokens) -> Structural:
        return Structural("endwhile", _range_span(self, tokens))

    def endsub(self, tokens: Tokens) -> Structural:
        return Structural("endsub", _range_span(self, tokens))

    def sub(self, tokens: Tokens) -> Structural:
        return Structural("sub", _range_span(self, tokens), name=self._name(tokens[1]))

    def gosub(self, tokens: Tokens) -> Call:
        return Call(name=self._name(tokens[1]), span=_range_span(self, tokens))

    def _name(self, token: Token) -> str:
        """Any name; who collects the lines says which the controller has."""
        return str(token).lower()

    def text(self, tokens: Tokens) -> Part:
        begin, end = _range(tokens[0])
        return Part(Text(str(tokens[0])[1:-1], self.span(begin, end)), begin, end)

    def message(self, tokens: Tokens) -> Message:
        kind = _MESSAGE_KINDS[str(tokens[0]).lower()]
        parts = tuple(part.node for part in tokens[1:] if isinstance(part, Part))
        formats = tuple(str(part) for part in tokens[1:] if not isinstance(part, Part))
        return Message(kind=kind, parts=parts, span=_range_span(self, tokens), formats=formats)

    def dialog(self, tokens: Tokens) -> Message | Unsupported:
        """Parts: the title, then by turns the name of a value and the number of its parameter."""
        for token in tokens[3::2]:
            if not token.isdigit():
                what = f"{str(token)!r} is not the number of a parameter"
                raise self.error(codes.SYNTAX, *_range(token), what=what)
        if len(tokens) > 2 + 2 * DIALOG_VALUES:
            what = f"a dialog with {len(tokens) // 2 - 1} values (the manual has {DIALOG_VALUES})"
            span = _range_span(self, tokens)
            asks = Message(kind="dialog", parts=tuple(self._label(token) for token in tokens[1:]), span=span)
            entry = LONG_DIALOGS.name
            return Unsupported(what=what, span=span, text=self._written(), accepted=entry, means=(asks,))
        parts = tuple(self._label(token) for token in tokens[1:])
        return Message(kind="dialog", parts=parts, span=_range_span(self, tokens))

    def _label(self, token: Token) -> Expr:
        begin, end = _range(token)
        span = self.span(begin, end)
        if token.type == "NUMBER":
            return Number(float(token), span, "." in token)
        return Text(str(token)[1:-1] if token.type == "TEXT" else str(token), span)

    def guard(self, tokens: Tokens) -> Guard:
        name = "tool_change_area" if str(tokens[0]).lower() == "tcaguard" else "machine_area"
        return Guard(name=name, on=str(tokens[1]).lower() == "on", span=_range_span(self, tokens))

    # ---- commands to the controller ----

    def _device(self, name: str, tokens: Tokens, *arguments: Expr) -> Device:
        return Device(name=name, arguments=arguments, span=_range_span(self, tokens))

    def _lower(self, token: Token) -> Text:
        """The name of an axis or a setting."""
        return Text(str(token).lower(), self.span(*_range(token)))

    def _file(self, name: str, tokens: Tokens) -> Device:
        """A command with the name of a file and perhaps a value."""
        return self._device(name, tokens, self._label(tokens[1]), *(part.node for part in tokens[2:]))

    def log_file(self, tokens: Tokens) -> Device:
        return self._file("log_file", tokens)

    def store_position(self, tokens: Tokens) -> Device:
        return self._file("store_position", tokens)

    def height_map_save(self, tokens: Tokens) -> Device:
        return self._file("height_map_save", tokens)

    def home(self, tokens: Tokens) -> Device:
        return self._device("home", tokens, self._lower(tokens[1]))

    def tandem(self, tokens: Tokens) -> Device:
        return self._device(_TANDEM[str(tokens[0]).lower()], tokens, self._lower(tokens[1]))

    def home_is_stop(self, tokens: Tokens) -> Device:
        return self._device("home_is_stop", tokens, self._lower(tokens[1]))

    def laf_angle(self, tokens: Tokens) -> Device:
        return self._device("laf_angle", tokens, tokens[1].node)

    def knife(self, tokens: Tokens) -> Device:
        """On and off; after ``on`` the side to which a bent knife is bent (2.1.9)."""
        side = tokens[2:]
        if str(tokens[1]).lower() == "off":
            if side:
                raise self.error(codes.SYNTAX, side[0].begin, side[0].end, what="'tanknife off' must have no value")
            return self._device("knife_off", tokens)
        if side and isinstance(side[0].node, Number) and abs(side[0].node.value) != BENT_KNIFE_DEGREES:
            what = f"a bent knife must be bent to {BENT_KNIFE_DEGREES} or -{BENT_KNIFE_DEGREES} degrees"
            raise self.error(codes.SYNTAX, side[0].begin, side[0].end, what=what)
        return self._device("knife_on", tokens, *(part.node for part in side))

    def knife_setting(self, tokens: Tokens) -> Device:
        name = "knife_axis" if tokens[1].type == "KNIFE_AXIS" else "knife_calibrate"
        return self._device(name, tokens, self._lower(tokens[1]))

    def height_map_init(self, tokens: Tokens) -> Device:
        return self._device("height_map_init", tokens, *(part.node for part in tokens[1:]))

    def height_map_add(self, tokens: Tokens) -> Device:
        return self._device("height_map_add", tokens)

    def nesting(self, tokens: Tokens) -> Device:
        """A preset of the nesting dialog (2.2.4.4)."""
        name = Text(str(tokens[0])[1:].lower(), self.span(*_range(tokens[0])))
        return self._device("nesting", tokens, name, self._label(tokens[1]))

    def unsupported(self, tokens: Tokens) -> Unsupported:
        span, text = _range_span(self, tokens), self._written()
        entry, means = meaning(text, span) or (None, ())
        return Unsupported(
            what=self.line.keyword, span=span, text=text, accepted=entry.name if entry else "", means=means
        )

    def _written(self) -> str:
        return written(self.line)


def written(line: Line) -> str:
    """The statement of a line as written, without what is before and after it."""
    return _COMMENT.sub("", line.text[line.keyword_at : line.places[-1]]).strip()


@record(frozen=True, slots=True)
class Comment:
    """A comment in parentheses, and the message it holds."""

    text: str
    message: Message | None


_COMMENT = re.compile(r"\([^()]*\)(?=[^\"“”„]*(?:[\"“”„][^\"“”„]*[\"“”„][^\"“”„]*)*$)")
"""A comment in parentheses, not one inside a text."""
_MESSAGE = re.compile(r"[ \t]*m[ \t]*s[ \t]*g[ \t]*,", re.IGNORECASE)
_MESSAGE_KINDS = {"msg": "msg", "warnmsg": "warning", "errmsg": "error", "logmsg": "log"}
_TANDEM = {
    "hometandem": "home_tandem",
    "preparetandemhome": "prepare_tandem_home",
    "moveslavetomaster": "align_slave",
    "movestavetomaster": "align_slave",  # so printed once in 2.10.3
}
BENT_KNIFE_DEGREES = 90  # 2.1.9


def _range(token: Token) -> tuple[int, int]:
    """Start and end of a token in the code of its line."""
    assert token.start_pos is not None
    return token.start_pos, token.start_pos + len(token)


def _range_span(builder: Builder, tokens: Tokens) -> Span:
    """From the first to the last of a rule's tokens and values."""
    last = tokens[-1]
    end = last.end if isinstance(last, Part) else _range(last)[1]
    return builder.span(_range(tokens[0])[0], end)
