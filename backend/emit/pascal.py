"""rw_SymPas as text: expressions with the fewest brackets, statements, declarations and whole sections.

A tree that the frontend made is printed so that it makes the same again, ``Binary.doubtful`` included. Statements are
printed as pieces, each with the line that it belongs to, so that a caller can keep the lines of the source.
Source: McuWIN manual 5.7, 7, 8, 10 to 12; the grouping of operators stands in ``ir/dialects/mcuwin_pascal.py``.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

from gproof.backend.emit.eding_expressions import Unprintable
from gproof.backend.emit.numbers import number_text
from gproof.ir.dialects.mcuwin_pascal import (
    ANGULAR,
    COMMON_INTEGER,
    FUNCTION_TEXT,
    LAST_COMMON,
    LEVEL,
    SIGN_MATTERS,
    WRITTEN,
)
from gproof.ir.finding import Span
from gproof.ir.program import (
    Assign,
    Binary,
    Block,
    BlockTable,
    Call,
    Constant,
    Declare,
    Device,
    Expr,
    For,
    If,
    Input,
    Jump,
    Label,
    Message,
    Named,
    Number,
    Repeat,
    Statement,
    Subprogram,
    Text,
    Unary,
    Unsupported,
    Variable,
    While,
)

RELATION, SUM, PRODUCT, FACTOR = 1, 2, 3, 4
_SIGNS = {"neg": "-", "pos": "+"}


class Style(NamedTuple):
    """What the text depends on beside the tree: letters of the machine's axes, in its order; the unit of angles;
    single_quotes: texts may stand in them (where they do not begin a comment)."""

    axes: str = "XYZ"
    angle_unit: str = "radians"
    single_quotes: bool = True


class Piece(NamedTuple):
    """A part of a statement that stands on one line. line: of the source; depth: how many blocks are open there."""

    line: int
    depth: int
    text: str


def _level(node: Expr) -> int:
    if isinstance(node, Binary):
        if node.operator not in LEVEL:
            raise Unprintable(f"the operator {node.operator!r}")
        return LEVEL[node.operator]
    return SUM if isinstance(node, Unary) and node.operator in _SIGNS else FACTOR


def _spine(node: Expr) -> list[Binary]:
    """A product and those at its left end, the outermost first."""
    found: list[Binary] = []
    while isinstance(node, Binary) and _level(node) == PRODUCT:
        found.append(node)
        node = node.left
    return found


def _negative(node: Expr) -> bool:
    return isinstance(node, Number) and repr(node.value).startswith("-")


class Printer:
    """Prints with one style. labels: as declared, by their names; those of declarations that are printed are added."""

    def __init__(self, style: Style | None = None) -> None:
        self.style = style or Style()
        self.labels: dict[str, str] = {}

    # expressions

    def expression(self, node: Expr) -> str:
        """An expression, without brackets around it."""
        if isinstance(node, Binary) and _level(node) == RELATION:
            return f"{self._side(node.left)} {WRITTEN[node.operator]} {self._side(node.right)}"
        return self._sum(node)

    def grouped(self, node: Expr) -> str:
        """An expression as a value behind a letter: in brackets unless it is a number or a name."""
        text = self.expression(node)
        plain = isinstance(node, Number | Variable | Constant | Named | Input)
        return text if plain else f"({text})"

    def _bracket(self, node: Expr) -> str:
        return f"({self.expression(node)})"

    def _side(self, node: Expr) -> str:
        """One side of a comparison."""
        return self._bracket(node) if _level(node) == RELATION else self._sum(node)

    def _sum(self, node: Expr) -> str:
        """From where a sign may stand, up to a comparison."""
        if isinstance(node, Unary) and node.operator in _SIGNS:
            return self._signed(node)
        if not isinstance(node, Binary) or _level(node) != SUM:
            return self._first_product(node)
        left = self._bracket(node.left) if _level(node.left) == RELATION else self._sum(node.left)
        right = node.right
        plain = _level(right) >= PRODUCT and not _negative(right) and not self._wrong(right, False)
        text = self._product(right, False) if plain else self._bracket(right)
        return f"{left} {WRITTEN[node.operator]} {text}"

    def _signed(self, node: Unary) -> str:
        """A sign before a whole product; a number behind it would become one with the sign."""
        inner, minus = node.operand, node.operator == "neg"
        if _level(inner) >= PRODUCT and not self._wrong(inner, minus):
            text = self._product(inner, minus)
            if not text[0].isdigit():
                return _SIGNS[node.operator] + text
            if any(one.doubtful for one in _spine(inner)):
                return _SIGNS[node.operator] + self._product(inner, minus, wrapped=True)
        return _SIGNS[node.operator] + self._bracket(inner)

    def _first_product(self, node: Expr) -> str:
        if _level(node) < PRODUCT:
            return self._bracket(node)
        spine = _spine(node)
        leaf = spine[-1].left if spine else node
        matters = [one.doubtful for one in spine if one.operator in SIGN_MATTERS]
        return self._product(node, False, bare=_negative(leaf) and all(matters))

    def _product(self, node: Expr, signed: bool, *, bare: bool = False, wrapped: bool = False) -> str:
        """Factors; signed: behind a minus; bare: its first factor is a number with a sign, without brackets;
        wrapped: its first factor is a number that must not become one with the sign before it."""
        if not isinstance(node, Binary) or _level(node) != PRODUCT:
            if wrapped:
                return self._bracket(node)
            return self._number(node) if bare and isinstance(node, Number) else self._factor(node)
        left = node.left
        cut = _level(left) < PRODUCT or self._wrong(left, signed or bare)
        first = self._bracket(left) if cut else self._product(left, signed, bare=bare, wrapped=wrapped)
        return f"{first} {WRITTEN[node.operator]} {self._factor(node.right)}"

    @staticmethod
    def _wrong(node: Expr, signed: bool) -> bool:
        """Whether a product says something else about the sign before it than ``signed``."""
        return isinstance(node, Binary) and node.operator in SIGN_MATTERS and node.doubtful != signed

    def _factor(self, node: Expr) -> str:
        if isinstance(node, Binary) or _negative(node):
            return self._bracket(node)
        if isinstance(node, Unary):
            return self._function(node)
        return self._atom(node)

    def _function(self, node: Unary) -> str:
        if node.operator in _SIGNS:
            return self._bracket(node)
        if node.operator in ("not", "bnot"):
            return f"not {self._factor(node.operand)}"
        radians = node.operator not in FUNCTION_TEXT or node.operator[1:] in ANGULAR
        if node.operator not in FUNCTION_TEXT:
            raise Unprintable(f"the function {node.operator!r}")
        if node.operator.removeprefix("r") in ANGULAR and radians != (self.style.angle_unit == "radians"):
            raise Unprintable(f"{FUNCTION_TEXT[node.operator]} of another unit than {self.style.angle_unit}")
        return f"{FUNCTION_TEXT[node.operator]}({self.expression(node.operand)})"

    @staticmethod
    def _number(node: Number) -> str:
        return number_text(node.value, node.point)

    def _atom(self, node: Expr) -> str:
        if isinstance(node, Number):
            return self._number(node)
        if isinstance(node, Variable):
            return variable_text(node)
        if isinstance(node, Constant):
            return node.name
        if isinstance(node, Text):
            return self.text(node)
        if isinstance(node, Named):
            axis, dot, qualifier = node.name.partition(".")
            return f"{axis}.{qualifier.lower()}" if dot else node.name
        assert isinstance(node, Input)
        return self._input(node)

    def _input(self, node: Input) -> str:
        if node.kind != "input" or not isinstance(node.number, Number):
            raise Unprintable(f"the state of an {node.kind}")
        axis, channel = divmod(int(node.number.value), 100)
        if not 1 <= axis <= len(self.style.axes):
            raise Unprintable(f"input {channel} of axis {axis}")
        return f"{self.style.axes[axis - 1].upper()}.digib.{channel}"

    def text(self, node: Text) -> str:
        """A text in double quotes; in single ones where it has a double one in it."""
        if '"' not in node.value:
            return f'"{node.value}"'
        if not self.style.single_quotes:
            raise Unprintable("a text with a double quote in it")
        return "'" + node.value.replace("'", "''") + "'"

    # statements

    def line(self, statements: Sequence[Statement]) -> str:
        """Statements on one line, as behind ``$``."""
        return " ".join(piece.text for piece in self.pieces(statements))

    def pieces(self, statements: Sequence[Statement], depth: int = 0) -> Iterator[Piece]:
        """Statements one after the other, each with its semicolon."""
        before: Statement | None = None
        for node in statements:
            again = isinstance(node, Declare) and isinstance(before, Declare) and before.kind == node.kind != "label"
            yield from self._pieces(node, depth, ";", again=again)
            before = node

    def section(self, statements: Sequence[Statement], procedures: Iterable[Subprogram]) -> Iterator[Piece]:
        """A whole section: its procedures stand among the statements by their lines."""
        waiting = sorted(procedures, key=lambda sub: (sub.span.line, sub.span.column))
        run: list[Statement] = []
        for node in statements:
            span = _span(node)
            while waiting and (waiting[0].span.line, waiting[0].span.column) < (span.line, span.column):
                yield from self.pieces(run)
                yield from self.procedure(waiting.pop(0))
                run = []
            run.append(node)
        yield from self.pieces(run)
        for sub in waiting:
            yield from self.procedure(sub)

    def procedure(self, node: Subprogram) -> Iterator[Piece]:
        """procedure name(parameters); declarations; begin ... end;"""
        texts = []
        for name, type_, _ in node.parameters:
            word = "var " if type_.startswith("var ") else ""
            texts.append(f"{word}{name}: {type_.removeprefix('var ')}")
        brackets = f"({'; '.join(texts)})" if texts else ""
        yield Piece(node.span.line, 0, f"procedure {node.text or node.name}{brackets};")
        count = next((n for n, one in enumerate(node.body) if not isinstance(one, Declare)), len(node.body))
        line = node.span.line
        for piece in self.pieces(node.body[:count], 1):
            yield piece
            line = piece.line
        yield Piece(line, 0, "begin")
        yield from self.pieces(node.body[count:], 1)
        yield Piece(node.end_span.line if node.end_span else line, 0, "end;")

    def _pieces(self, node: Statement, depth: int, end: str, *, again: bool = False) -> Iterator[Piece]:
        """One statement; end: the semicolon behind it, or nothing; again: a declaration that goes on."""
        if isinstance(node, If):
            yield from self._if(node, depth, end)
        elif isinstance(node, While | For):
            yield from self._loop(node, depth, end)
        elif isinstance(node, Repeat):
            yield Piece(node.span.line, depth, "repeat")
            yield from self.pieces(node.body, depth + 1)
            last = node.end_span or node.span
            yield Piece(last.line, depth, f"until {self.expression(node.condition)}{end}")
        elif isinstance(node, Label):
            yield Piece(node.span.line, depth, f"{self.labels.get(node.name, node.name)}:")
        elif isinstance(node, Declare):
            word, text = self._declaration(node)
            line = node.value.span.line if node.value is not None else node.span.line
            if word and not again:
                text = f"{word} {text}" if line == node.span.line else text
                if line != node.span.line:
                    yield Piece(node.span.line, depth, word)
            yield Piece(line, depth, text + end)
        else:
            yield Piece(_span(node).line, depth, self._simple(node) + end)

    def head(self, node: If | While | For) -> str:
        """``if ... then``, ``while ... do``, ``for ... do``."""
        if isinstance(node, If):
            return f"if {self.expression(node.condition)} then"
        if isinstance(node, While):
            return f"while {self.expression(node.condition)} do"
        way = "downto" if node.down else "to"
        bounds = f"{self.expression(node.first)} {way} {self.expression(node.last)}"
        return f"for {variable_text(node.variable)} := {bounds} do"

    def _loop(self, node: While | For, depth: int, end: str) -> Iterator[Piece]:
        if node.end_span is None and _is_single(node.body):
            yield Piece(node.span.line, depth, self.head(node))
            yield from self._single(node.body, depth + 1, end, node.span.line)
            return
        yield Piece(node.span.line, depth, f"{self.head(node)} begin")
        yield from self.pieces(node.body, depth + 1)
        yield Piece((node.end_span or node.span).line, depth, f"end{end}")

    def _if(self, node: If, depth: int, end: str) -> Iterator[Piece]:
        has_else = bool(node.otherwise) or node.else_span is not None
        chained = len(node.otherwise) == 1 and isinstance(node.otherwise[0], If)
        plain = node.end_span is None and _is_single(node.then) and (chained or _is_single(node.otherwise))
        if has_else and _takes_else(node.then):
            plain = False
        line, last = node.span.line, (node.end_span or node.span).line
        divider = (node.else_span or node.span).line
        yield Piece(line, depth, self.head(node) if plain else f"{self.head(node)} begin")
        if plain:
            yield from self._single(node.then, depth + 1, "" if has_else else end, line)
        else:
            yield from self.pieces(node.then, depth + 1)
        if not has_else:
            if not plain:
                yield Piece(last, depth, f"end{end}")
            return
        closing = "" if plain else "end "
        if chained:
            yield Piece(divider, depth, f"{closing}else")
            yield from self._pieces(node.otherwise[0], depth, end)
        elif plain:
            yield Piece(divider, depth, "else")
            yield from self._single(node.otherwise, depth + 1, end, divider)
        else:
            yield Piece(divider, depth, "end else begin")
            yield from self.pieces(node.otherwise, depth + 1)
            yield Piece(last, depth, f"end{end}")

    def _single(self, body: Sequence[Statement], depth: int, end: str, line: int) -> Iterator[Piece]:
        """A statement without ``begin``: labels and one more, or none at all."""
        last = body[-1] if body and not isinstance(body[-1], Label) else None
        for node in body[: len(body) - (last is not None)]:
            yield from self._pieces(node, depth, "")
        if last is not None:
            yield from self._pieces(last, depth, end)
        elif end:
            yield Piece(_span(body[-1]).line if body else line, depth, end)

    def _simple(self, node: Statement) -> str:
        if isinstance(node, Block) and node.assigns and not node.words:
            return "; ".join(self.assignment(one) for one in node.assigns)
        if isinstance(node, Jump):
            return f"goto {self.labels.get(node.name, node.name)}"
        if isinstance(node, Call):
            values = ", ".join(self.expression(word.value) for word in node.arguments)
            name = node.text or node.name
            return f"{name}({values})" if values else name
        if isinstance(node, Message) and node.kind in ("write", "writeln"):
            return " ".join([node.kind.upper(), *self._parts(node.parts)])
        if isinstance(node, Device) and node.name == "wait":
            return f"wt({self.expression(node.arguments[0])})"
        if isinstance(node, Unsupported) and node.text:
            return node.text
        raise Unprintable(node.what if isinstance(node, Unsupported) else f"a {type(node).__name__} in rw_SymPas")

    def _parts(self, parts: Sequence[Expr]) -> Iterator[str]:
        """Values of WRITE, apart by blanks: one that begins with a sign would go on with the one before it."""
        for node in parts:
            text = self.expression(node)
            yield f"({text})" if text[0] in "+-" else text

    def assignment(self, node: Assign) -> str:
        """variable := expression"""
        return f"{variable_text(node.target)} := {self.expression(node.value)}"

    def _declaration(self, node: Declare) -> tuple[str, str]:
        """The word before a declaration, and the declaration."""
        if node.kind == "label":
            self.labels.update((str(int(name)) if name.isdigit() else name.lower(), name) for name in node.names)
        if node.kind == "const":
            assert node.value is not None
            return node.kind, f"{node.names[0]} = {self.expression(node.value)}"
        return node.kind, f"{', '.join(node.names)}{f': {node.type}' if node.type else ''}"


def variable_text(node: Variable) -> str:
    """The name, or CD n, CI n."""
    if node.name:
        return node.name
    number = node.number.value if isinstance(node.number, Number) else -1.0
    prefix, low = ("CI", COMMON_INTEGER) if number >= COMMON_INTEGER else ("CD", 0)
    if number != int(number) or not 0 <= number - low <= LAST_COMMON:
        raise Unprintable("a variable that is neither declared nor CD or CI")
    return f"{prefix}{int(number) - low}"


def _span(node: Statement) -> Span:
    """The span of a statement; tables of plain lines do not stand in rw_SymPas."""
    if isinstance(node, BlockTable):
        raise Unprintable("lines of words in rw_SymPas")
    return node.span


def layout(pieces: Iterable[Piece], indent: str = "  ") -> list[str]:
    """Each piece on its own line."""
    return [indent * piece.depth + piece.text for piece in pieces]


def at_lines(pieces: Iterable[Piece], first: int, last: int) -> list[str]:
    """The text of each line from ``first`` to ``last``, where the pieces stand on the lines of the source.

    Unprintable where a piece would have to stand before the one that precedes it.
    """
    lines: list[list[str]] = [[] for _ in range(first, last + 1)]
    before = first
    for piece in pieces:
        if not before <= piece.line <= last:
            raise Unprintable("a statement that lies before another one, and stands behind it")
        lines[piece.line - first].append(piece.text)
        before = piece.line
    return [" ".join(texts) for texts in lines]


def _is_single(body: Sequence[Statement]) -> bool:
    """Whether a list can stand without begin and end: labels, and at most one statement behind them."""
    return all(isinstance(node, Label) for node in body[:-1])


def _takes_else(body: Sequence[Statement]) -> bool:
    """Whether an else behind this statement would become a part of it."""
    node = body[-1] if body else None
    if isinstance(node, If):
        if not node.otherwise and node.else_span is None:
            return True
        chained = len(node.otherwise) == 1 and isinstance(node.otherwise[0], If)
        return (chained or node.end_span is None) and _takes_else(node.otherwise)
    return isinstance(node, While | For) and node.end_span is None and _takes_else(node.body)
