"""Statements of a file put together: nested if and while, subprograms, tables of plain lines between them.

``Assembler`` takes what the lines hold, in order, and gives the body and the subprograms; a block that is not
closed, or closed without being open, is a finding, and what is inside it stays in the program.
"""

from __future__ import annotations

from collections.abc import Callable

from gproof.frontend.eding.build import Parsed, Structural
from gproof.ir import codes
from gproof.ir.finding import Finding, Related, Span
from gproof.ir.program import Call, Expr, If, Number, Statement, Subprogram, Unsupported, While
from gproof.ir.record import field, record


@record(slots=True)
class _Open:
    """A block that is open: ``file``, ``sub``, ``if`` or ``while``."""

    keyword: str
    span: Span
    condition: Expr
    name: str = ""
    body: list[Statement] = field(default_factory=list)
    otherwise: list[Statement] | None = None
    else_span: Span | None = None

    @property
    def current(self) -> list[Statement]:
        return self.body if self.otherwise is None else self.otherwise


NESTING = 100
"""Blocks within blocks that a Program holds; programs are walked by recursion."""

JOB, MACROS, OWN_MACROS = range(3)
"""What a file is: the job, the macro file, the shop's own macros next to it."""

_CLOSES = {"endif": "if", "endwhile": "while", "endsub": "sub"}


class Assembler:
    """Collects one program out of its files; see the module's text.

    mistake: takes a finding, the subprogram it is in, and (``sure``) whether it counts anyway; twice: takes one
    about two subprograms of a name, and the name.
    """

    def __init__(self, mistake: Callable[..., None], twice: Callable[[Finding, str], None]) -> None:
        self.mistake = mistake
        self.twice = twice
        self._place = JOB
        self._places: dict[str, int] = {}
        self.subprograms: dict[str, Subprogram] = {}
        self.calls: list[tuple[Call, str]] = []
        """Each call and the subprogram it is in ("" outside)."""
        self._stack: list[_Open] = []

    def begin_file(self, file: str, place: int = JOB) -> None:
        """Start with the first line of a file; place: JOB, MACROS or OWN_MACROS, which count before MACROS."""
        self._place = place
        start = Span(file, 1)
        self._stack = [_Open("file", start, Number(0.0, start))]

    def end_file(self) -> tuple[Statement, ...]:
        """The statements of the file outside its subprograms; what is still open is a finding."""
        while len(self._stack) > 1:
            self._unclosed(self._stack[-1])
            self._close()
        return tuple(self._stack[0].body)

    def add(self, parsed: Parsed) -> None:
        """The next statement, or the next line that opens, divides or closes a block."""
        if not isinstance(parsed, Structural):
            if isinstance(parsed, Call):
                self.calls.append((parsed, self.subprogram))
            self._stack[-1].current.append(parsed)
        elif parsed.keyword in _CLOSES:
            self._end(parsed)
        elif parsed.keyword == "else":
            self._else(parsed)
        else:
            self._open(parsed)

    @property
    def subprogram(self) -> str:
        """The name of the subprogram that is open, or ""."""
        return self._stack[1].name if len(self._stack) > 1 else ""

    def _open(self, line: Structural) -> None:
        if line.keyword == "sub":
            while len(self._stack) > 1:
                self._unclosed(self._stack[-1], f"before the next 'sub' in line {line.span.line}")
                self._close()
        if len(self._stack) == NESTING + 1:
            what = f"{line.keyword!r} inside more than {NESTING} others"
            self._stack[-1].current.append(Unsupported(what=what, span=line.span))
        condition = line.condition if line.condition is not None else Number(0.0, line.span)
        self._stack.append(_Open(line.keyword, line.span, condition, line.name))

    def _end(self, line: Structural) -> None:
        wanted = _CLOSES[line.keyword]
        if all(block.keyword != wanted for block in self._stack):
            self._unbalanced(line.span, f"{line.keyword!r} without {wanted!r}", sure=wanted == "sub")
            return
        while self._stack[-1].keyword != wanted:
            self._unclosed(self._stack[-1], f"before {line.keyword!r} in line {line.span.line}")
            self._close()
        self._close(line.span)

    def _else(self, line: Structural) -> None:
        innermost = self._stack[-1]
        if innermost.keyword != "if":
            self._unbalanced(line.span, "'else' without 'if'")
        elif innermost.otherwise is not None:
            first = (Related(innermost.span, "the 'if' is here"),)
            finding = codes.UNBALANCED_BLOCK.at(line.span, what="a second 'else' for one 'if'", related=first)
            self.mistake(finding, self.subprogram)
        else:
            innermost.otherwise = []
            innermost.else_span = line.span

    def _close(self, end: Span | None = None) -> None:
        """Make a statement or subprogram of the innermost block and put it where it belongs; end: its last line."""
        block = self._stack.pop()
        outer = self._stack[-1].current
        body = tuple(block.body)
        if len(self._stack) > NESTING:
            return  # an Unsupported is in its place
        if block.keyword == "if":
            otherwise = tuple(block.otherwise or ())
            outer.append(
                If(
                    condition=block.condition,
                    then=body,
                    otherwise=otherwise,
                    span=block.span,
                    else_span=block.else_span,
                    end_span=end,
                )
            )
        elif block.keyword == "while":
            outer.append(While(condition=block.condition, body=body, span=block.span, end_span=end))
        elif (self._place, self._places.get(block.name)) == (MACROS, OWN_MACROS):
            pass  # the one that is there counts
        elif block.name in self.subprograms and (self._place, self._places[block.name]) != (OWN_MACROS, MACROS):
            first = (Related(self.subprograms[block.name].span, "the first is here"),)
            finding = codes.DUPLICATE_SUBPROGRAM.at(block.span, name=block.name, related=first)
            self.twice(finding, block.name)
        elif block.name:
            self._places[block.name] = self._place
            self.subprograms[block.name] = Subprogram(name=block.name, body=body, span=block.span, end_span=end)

    def _unclosed(self, block: _Open, where: str = "before the end of the file") -> None:
        what = f"{block.keyword!r} has no 'end{block.keyword}' {where}"
        self._unbalanced(block.span, what, sure=block.keyword == "sub")

    def _unbalanced(self, span: Span, what: str, *, sure: bool = False) -> None:
        self.mistake(codes.UNBALANCED_BLOCK.at(span, what=what), self.subprogram, sure=sure)
