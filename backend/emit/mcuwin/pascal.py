"""rw_SymPas as text: statements, declarations and whole sections.

A tree that the frontend made is printed so that it makes the same again, ``Binary.doubtful`` included. Nothing here
requires the text that a tree came from: the numbers of their variables say where procedures are.
Source: McuWIN manual 5.7, 7, 8, 10 to 12; the grouping of operators is in ``ir/dialects/mcuwin/pascal.py``.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

from gproof.backend.emit.mcuwin.pascal_expressions import ExpressionPrinter, Style, variable_text
from gproof.backend.emit.printer import Unprintable
from gproof.ir.program import (
    Assign,
    Block,
    Call,
    Declare,
    Device,
    Expr,
    For,
    If,
    Jump,
    Label,
    Message,
    Repeat,
    Statement,
    Subprogram,
    Unsupported,
    While,
)


class Piece(NamedTuple):
    """A part of a statement that is on one line. depth: how many blocks are open there."""

    depth: int
    text: str


class Printer(ExpressionPrinter):
    """Prints with one style. labels: as declared, by their names; those of declarations that are printed are added."""

    def __init__(self, style: Style | None = None) -> None:
        super().__init__(style)
        self.labels: dict[str, str] = {}

    def pieces(self, statements: Sequence[Statement], depth: int = 0) -> Iterator[Piece]:
        """Statements one after the other, each with its semicolon."""
        before: Statement | None = None
        for node in statements:
            again = isinstance(node, Declare) and isinstance(before, Declare) and before.kind == node.kind != "label"
            yield from self._pieces(node, depth, ";", again=again)
            before = node

    def procedure(self, node: Subprogram) -> Iterator[Piece]:
        """``procedure name(parameters); declarations; begin ... end;``"""
        texts = []
        for name, type_, _ in node.parameters:
            word = "var " if type_.startswith("var ") else ""
            texts.append(f"{word}{name}: {type_.removeprefix('var ')}")
        brackets = f"({'; '.join(texts)})" if texts else ""
        yield Piece(0, f"procedure {node.text or node.name}{brackets};")
        count = next((n for n, one in enumerate(node.body) if not isinstance(one, Declare)), len(node.body))
        yield from self.pieces(node.body[:count], 1)
        yield Piece(0, "begin")
        yield from self.pieces(node.body[count:], 1)
        yield Piece(0, "end;")

    def _pieces(self, node: Statement, depth: int, end: str, *, again: bool = False) -> Iterator[Piece]:
        """One statement; end: the semicolon after it, or nothing; again: a declaration that goes on."""
        if isinstance(node, If):
            yield from self._if(node, depth, end)
        elif isinstance(node, While | For):
            yield from self._loop(node, depth, end)
        elif isinstance(node, Repeat):
            yield Piece(depth, "repeat")
            yield from self.pieces(node.body, depth + 1)
            yield Piece(depth, f"until {self.condition(node.condition)}{end}")
        elif isinstance(node, Label):
            yield Piece(depth, f"{self.labels.get(node.name, node.name)}:")
        elif isinstance(node, Declare):
            word, text = self._declaration(node)
            yield Piece(depth + again, text + end if again else f"{word} {text}{end}")
        else:
            yield Piece(depth, self.simple(node) + end)

    def condition(self, node: Expr) -> str:
        """A condition in brackets, as the manual writes each of them (7, 8)."""
        return f"({self.expression(node)})"

    def head(self, node: If | While | For) -> str:
        """``if ... then``, ``while ... do``, ``for ... do``."""
        if isinstance(node, If):
            return f"if {self.condition(node.condition)} then"
        if isinstance(node, While):
            return f"while {self.condition(node.condition)} do"
        way = "downto" if node.down else "to"
        bounds = f"{self.expression(node.first)} {way} {self.expression(node.last)}"
        return f"for {variable_text(node.variable)} := {bounds} do"

    def _loop(self, node: While | For, depth: int, end: str) -> Iterator[Piece]:
        if node.end_span is None and _is_single(node.body):
            yield Piece(depth, self.head(node))
            yield from self._single(node.body, depth + 1, end)
            return
        yield Piece(depth, f"{self.head(node)} begin")
        yield from self.pieces(node.body, depth + 1)
        yield Piece(depth, f"end{end}")

    def _if(self, node: If, depth: int, end: str) -> Iterator[Piece]:
        has_else = bool(node.otherwise) or node.else_span is not None
        chained = len(node.otherwise) == 1 and isinstance(node.otherwise[0], If)
        plain = node.end_span is None and _is_single(node.then) and (chained or _is_single(node.otherwise))
        if has_else and _takes_else(node.then):
            plain = False
        yield Piece(depth, self.head(node) if plain else f"{self.head(node)} begin")
        if plain:
            yield from self._single(node.then, depth + 1, "" if has_else else end)
        else:
            yield from self.pieces(node.then, depth + 1)
        if not has_else:
            if not plain:
                yield Piece(depth, f"end{end}")
            return
        closing = "" if plain else "end "
        if chained:
            yield Piece(depth, f"{closing}else")
            yield from self._pieces(node.otherwise[0], depth, end)
        elif plain:
            yield Piece(depth, "else")
            yield from self._single(node.otherwise, depth + 1, end)
        else:
            yield Piece(depth, "end else begin")
            yield from self.pieces(node.otherwise, depth + 1)
            yield Piece(depth, f"end{end}")

    def _single(self, body: Sequence[Statement], depth: int, end: str) -> Iterator[Piece]:
        """A statement without ``begin``: labels and one more, or none at all."""
        last = body[-1] if body and not isinstance(body[-1], Label) else None
        for node in body[: len(body) - (last is not None)]:
            yield from self._pieces(node, depth, "")
        if last is not None:
            yield from self._pieces(last, depth, end)
        elif end:
            yield Piece(depth, end)

    def simple(self, node: Statement) -> str:
        """A statement that has no others in it, without its semicolon; Unprintable for what is in no rw_SymPas."""
        if isinstance(node, Block) and len(node.assigns) == 1 and not node.words:
            return self.assignment(node.assigns[0])
        if isinstance(node, Jump):
            return f"goto {self.labels.get(node.name, node.name)}"
        if isinstance(node, Call):
            values = ", ".join(self.expression(word.value) for word in node.arguments)
            name = node.text or node.name
            return f"{name}({values})" if values else name
        if isinstance(node, Message) and node.kind in ("write", "writeln"):
            return " ".join([node.kind.upper(), *self._values(node.parts)])
        if isinstance(node, Device) and node.name == "wait":
            return f"wt({self.expression(node.arguments[0])})"
        if isinstance(node, Unsupported) and node.text:
            return node.text
        raise Unprintable(node.what if isinstance(node, Unsupported) else f"a {type(node).__name__} in rw_SymPas")

    def _values(self, parts: Sequence[Expr]) -> Iterator[str]:
        """Values of WRITE, apart by blanks: one that starts with a sign would go on with the one before it."""
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


def layout(pieces: Iterable[Piece], indent: str = "  ") -> list[str]:
    """Each piece on its own line."""
    return [indent * piece.depth + piece.text for piece in pieces]


def first_number(node: Statement | Subprogram) -> int | None:
    """The lowest number of the variables that a procedure, or a declaration outside of them, makes; None without any.

    Numbers are given in the order of the text, so that they tell where a procedure is.
    """
    if isinstance(node, Declare):
        return node.number if node.kind == "var" else None
    if not isinstance(node, Subprogram):
        return None
    inner = [first_number(one) for one in node.body]
    return min((n for n in (*(number for _, _, number in node.parameters), *inner) if n is not None), default=None)


def _is_single(body: Sequence[Statement]) -> bool:
    """Whether a list can be written without ``begin`` and ``end``: labels, and at most one statement after them."""
    return all(isinstance(node, Label) for node in body[:-1])


def _takes_else(body: Sequence[Statement]) -> bool:
    """Whether an else after this statement would become a part of it."""
    node = body[-1] if body else None
    if isinstance(node, If):
        if not node.otherwise and node.else_span is None:
            return True
        chained = len(node.otherwise) == 1 and isinstance(node.otherwise[0], If)
        return (chained or node.end_span is None) and _takes_else(node.otherwise)
    return isinstance(node, While | For) and node.end_span is None and _takes_else(node.body)
