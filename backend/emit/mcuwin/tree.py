"""A Program as McuWIN text, from its statements alone: what it came from is no matter.

Each statement has its own line, ``if`` and loops between lines of words are ``$`` lines with ``begin`` and ``$end`` as
the manual writes them (7, 8), declared procedures are where the numbers of their variables say, modules after ``%``.
What a line without a code goes on with is followed as the controller does (3.1); where the Program says otherwise, the
code is written, or there is a refusal.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from gproof.backend.emit.line_printer import PIECE_BYTES
from gproof.backend.emit.mcuwin.parts import AXIS_ASSIGNMENT, TreeParts
from gproof.backend.emit.mcuwin.pascal import Piece, Printer, first_number, layout
from gproof.backend.emit.mcuwin.pascal_expressions import Style
from gproof.backend.emit.numbers import number_text
from gproof.backend.emit.plain_lines import plain_lines
from gproof.backend.emit.printer import Unprintable
from gproof.ir import codes
from gproof.ir.columns import Columns
from gproof.ir.dialects.mcuwin.persistence import MOTIONS, OPEN, Persistence
from gproof.ir.dialects.mcuwin.settings import VERSIONS, McuWinSettings
from gproof.ir.finding import Refusal, Span
from gproof.ir.notes import NOTE, Notes
from gproof.ir.program import (
    FLAG_BARE,
    FLAG_DELETE,
    FLAG_POINT,
    Block,
    BlockTable,
    Call,
    Declare,
    DeferredBlock,
    Device,
    For,
    If,
    Include,
    Jump,
    Label,
    Message,
    Mode,
    Number,
    Program,
    Repeat,
    Return,
    Statement,
    Subprogram,
    Text,
    Unsupported,
    While,
    Word,
)

INDENT = "  "
LIMIT = 1 << 30
"""No line of a table is too long to be printed."""
LINE_NUMBER_STEP = 10
NO_NOTES = Notes(Columns(NOTE), b"")
_MODAL = frozenset((17, 18, 19, 70, 71, 90, 91, 94, 161, 162))
"""G codes with which axis words are those of the motion in force."""


def text_of(program: Program, din: McuWinSettings, axes: str, *, includes: bool = True) -> Iterator[bytes]:
    """The text of a Program, piece by piece, each of whole lines, in UTF-8 with LF.

    din, axes: settings and axis letters of the machine that is to read it; names and case are those of the Program.
    includes: ``$I`` lines are printed, without what they stand for (a file that was read alone); otherwise all is one
    text, as the statements of a whole job have it. Refusal (GP702) for what McuWIN has no text for.
    """
    yield from _Tree(program, din, axes, includes=includes).run()


class _Tree:
    """Prints with ``out`` as the lines that are not handed over yet.

    other: the ``$`` form of the last of them, where it has one; pascal: inside a section; implied: which no $DINEND
    opened; marked: a percent sign is above; says: what is no declaration does; name: of the first module.
    """

    def __init__(self, program: Program, din: McuWinSettings, axes: str, *, includes: bool) -> None:
        self.program = program
        self.din = din
        self.includes = includes
        old = din.version == VERSIONS[1]
        self.printer = Printer(Style(axes, din.angle_unit))
        self.words = TreeParts(self.printer, old=old)
        self.persistence = Persistence(din)
        self.out: list[str] = []
        self.other = ""
        self.depth = 0
        self.number = 0
        self.pascal = self.implied = self.marked = self.says = False
        self.name = ""
        self.declared: Declare | None = None
        self.waiting = [sub for sub in program.subprograms.values() if sub.text]
        self.procedures = {sub.name for sub in self.waiting}
        bodies = [program.body, *(sub.body for sub in program.subprograms.values() if sub.is_module)]
        inside = {node.name for body in bodies for node in body if isinstance(node, Label)}
        self.modules = [
            sub for name, sub in program.subprograms.items()
            if not sub.text and (sub.is_module or name not in inside) and self._says_something(sub)
        ]  # fmt: skip

    def _says_something(self, sub: Subprogram) -> bool:
        """Whether a module is more than the place of a file whose text follows."""
        places = () if self.includes else (Include,)
        return not sub.name.startswith("%") or not all(isinstance(node, places) for node in sub.body)

    def run(self) -> Iterator[bytes]:
        """The program that runs first, then the modules."""
        program = self.program
        if program.overrides or program.head or program.tail or program.abort:
            raise self._refusal(None, "what the machine's files put around a program")
        body = program.body
        if body and isinstance(body[0], Label) and not body[0].name.isdigit():
            self.name, body = body[0].name, body[1:]  # of the module that runs first
        yield from self._body(body, main=True)
        if self.waiting and not self.marked:
            self._procedures(None)
        if (self.implied or self.modules or self.name) and not self.marked:
            self._percent(self.name)
        for sub in self.modules:
            yield from self._module(sub)
        yield self._taken(0)

    def _module(self, sub: Subprogram) -> Iterator[bytes]:
        named = not sub.name.startswith("%")
        begin = 1 if named and self._starts(sub.body, sub.name) else 0
        self._percent(sub.name if named else "")
        yield from self._body(sub.body[begin:])
        if not sub.is_module and not (sub.body and isinstance(sub.body[-1], Return)):
            self._put("M17")  # its text ends, which is no end of a module here (14, 2.5.3.90)

    @staticmethod
    def _starts(body: Sequence[Statement], name: str) -> bool:
        return bool(body) and isinstance(body[0], Label) and body[0].name == name and not name.isdigit()

    def _refusal(self, node: Statement | Subprogram | None, what: str) -> Refusal:
        span = node.span if node is not None and not isinstance(node, BlockTable) else Span("", 0)
        return Refusal(codes.NOT_PRINTABLE.at(span, what=what))

    def _taken(self, left: int = 1) -> bytes:
        """The lines that are done; left: how many may still change."""
        cut = max(0, len(self.out) - left)
        done, self.out = self.out[:cut], self.out[cut:]
        return "".join(f"{line}\n" for line in done).encode()

    def _put(self, text: str, other: str = "", *, numbered: bool = True) -> None:
        """A line; other: its form after ``$``; numbered: it is one of words."""
        if self.din.line_numbers and numbered:
            self.number += LINE_NUMBER_STEP
            text = f"N{self.number} {text}"
        if "\n" in text or "\r" in text:
            raise Unprintable("a text of several lines")
        self.out.append(INDENT * self.depth + text)
        self.other = INDENT * self.depth + other if other else ""

    def _percent(self, name: str) -> None:
        self._put(f"%{name}", numbered=False)
        self.marked, self.pascal, self.implied = True, False, False
        self.persistence.cut()

    # statements in their order

    def _body(self, body: Sequence[Statement], *, main: bool = False) -> Iterator[bytes]:
        """main: of the program that runs first, which declares names."""
        for index, node in enumerate(body):
            if isinstance(node, DeferredBlock):
                node = node.made()
            try:
                if main:
                    self._before(body, index)
                yield from self._statement(node)
            except Unprintable as error:
                raise self._refusal(node, str(error)) from error
            yield self._taken()

    def _before(self, body: Sequence[Statement], index: int) -> None:
        """What must be before a statement: procedures, and the percent sign that ends the declarations."""
        node = body[index]
        number = first_number(node) if isinstance(node, Declare) else None
        if self.waiting and isinstance(node, Declare) and number is not None:
            self._procedures(number)
        elif self.waiting and not isinstance(node, Declare | Include):
            is_last = not any(isinstance(one, Declare) for one in body[index:])
            opens = isinstance(node, Mode) and node.name == "pascal"
            if not opens and (is_last or not isinstance(node, Mode)):
                self._procedures(None)
        if isinstance(node, Declare | Include | Mode):
            return
        if self.implied or ((self.modules or self.name) and not (self.says or self.pascal or self.marked)):
            self._percent(self.name)
        self.says = True

    def _procedures(self, before: int | None) -> None:
        """Those that are before the variable of that number; all, when there is none."""
        numbers = [first_number(sub) for sub in self.waiting]
        count = len(numbers)
        if before is not None:
            count = max((n for n, number in enumerate(numbers, 1) if number is not None and number < before), default=0)
        if count and not self.pascal:
            self.pascal = self.implied = True
        for sub in self.waiting[:count]:
            self._pieces(self.printer.procedure(sub))
        if count:
            self.declared = None
        del self.waiting[:count]

    def _pieces(self, pieces: Iterator[Piece]) -> None:
        for line in layout(pieces, INDENT):
            self._put(line, numbered=False)

    def _statement(self, node: Statement) -> Iterator[bytes]:
        if isinstance(node, Mode):
            self._mode(node)
        elif isinstance(node, Declare):
            self._declare(node)
        elif self.pascal:
            self._pieces(self.printer.pieces([node]))
        elif isinstance(node, BlockTable):
            yield from self._table(node)
        elif isinstance(node, If):
            yield from self._if(node)
        elif isinstance(node, While | For | Repeat):
            yield from self._loop(node)
        else:
            self._line(node)
        if not isinstance(node, Declare):
            self.declared = None

    def _mode(self, node: Mode) -> None:
        if node.name == "din":
            self._put("{$DINSTART}", numbered=False)
            self.pascal = self.implied = False
        else:
            self._put("$DINEND", numbered=False)
            self.pascal, self.implied = True, False
        self.persistence.mode()

    def _declare(self, node: Declare) -> None:
        if not self.pascal:
            if self.marked:
                raise Unprintable("a declaration after a percent sign")
            self.pascal = self.implied = True
        nodes = [node] if self.declared is None else [self.declared, node]
        self._pieces(iter(list(self.printer.pieces(nodes))[len(nodes) - 1 :]))
        self.declared = node

    def _dollar(self, text: str) -> None:
        self._put(f"${text}", numbered=False)
        self.persistence.doubt()

    def _inner(self, body: Sequence[Statement]) -> Iterator[bytes]:
        self.depth += 1
        yield from self._body(body)
        self.depth -= 1

    def _if(self, node: If) -> Iterator[bytes]:
        if node.head is not None:
            raise Unprintable("a question to the operator")
        self._dollar(f"{self.printer.head(node)} begin")
        yield from self._inner(node.then)
        while len(node.otherwise) == 1 and isinstance(node.otherwise[0], If) and node.otherwise[0].head is None:
            node = node.otherwise[0]
            self._dollar(f"end else if {self.printer.condition(node.condition)} begin")
            yield from self._inner(node.then)
        if node.otherwise:
            self._dollar("end else begin")
            yield from self._inner(node.otherwise)
        self._dollar("end")

    def _loop(self, node: While | For | Repeat) -> Iterator[bytes]:
        head = "repeat" if isinstance(node, Repeat) else self.printer.head(node)
        self._dollar(f"{head} begin")
        yield from self._inner(node.body)
        self._dollar(f"end until {self.printer.condition(node.condition)};" if isinstance(node, Repeat) else "end;")

    # lines of words

    def _line(self, node: Statement) -> None:
        if getattr(node, "deleted", False):
            raise Unprintable("a line that a switch leaves out")
        if isinstance(node, Block):
            self._block(node)
        elif isinstance(node, Include):
            if self.includes:
                self._put(f"$I {node.name}", numbered=False)
                self.persistence.doubt()
        elif self._is_pascal(node):
            text = self.printer.simple(node) if not isinstance(node, Label) else f"{self.printer.labels[node.name]}:"
            self._dollar(text if isinstance(node, Label) else f"{text};")
        else:
            dollar = isinstance(node, Jump) and node.name in self.printer.labels
            self._put(" ".join(self.words.parts(node)), f"${self.printer.simple(node)};" if dollar else "")
            if isinstance(node, Jump | Call | Return):
                self.persistence.code("M", 17)
            elif isinstance(node, Message):
                self.persistence.doubt()

    def _is_pascal(self, node: Statement) -> bool:
        """Whether a statement is after ``$``, since lines of words have none of its kind."""
        if isinstance(node, Message):
            return any(isinstance(part, Text) and '"' in part.value for part in node.parts)
        if isinstance(node, Label | Jump):
            return not node.name.isdigit() and node.name in self.printer.labels
        if isinstance(node, Call):
            return bool(node.text) and node.name in self.procedures
        return isinstance(node, Device) or (isinstance(node, Unsupported) and not node.what.startswith(AXIS_ASSIGNMENT))

    def _block(self, node: Block) -> None:
        if node.own or node.texts:
            raise Unprintable("words of another language")
        if not node.words:
            text = self.printer.simple(node)
            self._put(text, f"${text};")
            return
        self._agree(node.continued)
        words = node.words
        state = self.persistence.state
        if node.continued != state and _goes_on(node):
            if node.continued not in MOTIONS or any(word.letter == "G" for word in words):
                raise Unprintable(f"a line that goes on with {node.continued or 'nothing'} after {state or 'nothing'}")
            words = (Word("G", Number(float(node.continued[1:]), node.span), node.span), *words)
        comment = f" ' {node.comment}" if node.comment else ""
        self._put(" ".join(self.words.words(words)) + comment)
        for word in words:
            if word.letter in "GM" and isinstance(word.value, Number):
                self.persistence.code(word.letter, int(word.value.value))
        self.persistence.distances_of(words)

    def _agree(self, wanted: str) -> None:
        """Where it is unknown whether a line goes on, it does not start to do so: the line before it gets a ``$``."""
        if wanted != OPEN or self.persistence.state in ("", OPEN):
            return
        if self.other:
            self.out[-1] = self.other
        else:
            self._put("$", numbered=False)
        self.persistence.doubt()

    def _table(self, table: BlockTable) -> Iterator[bytes]:
        """Plain lines; those without words are kept between them."""
        self._agree(table.continued)
        begin, line, first = table.begin, table.first_line, True
        while line <= table.last_line:
            words, begin, after = self.program.load(table, begin, line, PIECE_BYTES)
            if first and len(words):
                self._table_head(table, words)
                first = False
            yield self._taken(0)
            self.other = ""
            if self.din.line_numbers:
                self._numbered(words)
            else:
                indent = len(INDENT) * self.depth
                text, _ = plain_lines(
                    line, after - 1, words, NO_NOTES, indent=indent, limit=LIMIT, newline="\n", two_digits=True
                )
                yield text
            rows = (words["letter"] == ord("G")).nonzero()[0]
            if len(rows):
                self.persistence.code("G", int(words["value"][rows[-1]]))
            line = after

    def _table_head(self, table: BlockTable, words: Columns) -> None:
        if (words["flags"] & FLAG_DELETE).any():
            raise Unprintable("a line that a switch leaves out")
        own = words["letter"][words["line"] == words["line"][0]]
        goes_on = any(chr(letter) not in "GMFSTD" for letter in own.tolist()) and ord("G") not in own
        if goes_on and table.continued != self.persistence.state:
            raise Unprintable(f"lines that go on with {table.continued or 'nothing'}")

    def _numbered(self, words: Columns) -> None:
        """Plain lines on a machine that wants a number on each."""
        held: list[str] = []
        before = -1
        for line, _, letter, flags, value in words.rows():
            if line != before and held:
                self._put(" ".join(held))
                held = []
            before = line
            text = f"{int(value):02d}" if letter == ord("G") else number_text(value, bool(flags & FLAG_POINT))
            held.append(chr(letter) + ("" if flags & FLAG_BARE else text))
        if held:
            self._put(" ".join(held))


def _goes_on(node: Block) -> bool:
    """Whether axis words of a block are those of the code in force."""
    numbers = {word.value.value for word in node.words if word.letter == "G" and isinstance(word.value, Number)}
    return numbers <= _MODAL and any(word.letter not in "GMFSTD@" for word in node.words)
