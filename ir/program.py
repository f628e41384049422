"""Program: a job as structured, dialect-neutral statements with source spans.

What its statements are is in ``ir/statements.py``; whoever takes a Program takes them from here. What a code means
is in ``Program.rules``: a table that the dialect gives as data, so that the executor never asks where a program
came from.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from gproof.ir.columns import Columns
from gproof.ir.finding import Span
from gproof.ir.notes import Annotate, Notes
from gproof.ir.record import field, record
from gproof.ir.rules import DEVICES, LanguageRules
from gproof.ir.statements import (
    DECLARED,
    DIALOG_ANSWER,
    FLAG_BARE,
    FLAG_DELETE,
    FLAG_POINT,
    MODES,
    PARAMETER,
    STATEMENTS,
    TYPES,
    WORD,
    Array,
    Assign,
    Binary,
    Block,
    BlockTable,
    Call,
    Constant,
    Declare,
    DeferredBlock,
    Definition,
    Device,
    Expr,
    For,
    Guard,
    If,
    Include,
    Input,
    Jump,
    Label,
    Message,
    Mistake,
    Mode,
    Named,
    Number,
    Repeat,
    Replaced,
    Return,
    Statement,
    Text,
    Unary,
    Unsupported,
    Variable,
    While,
    Word,
    lost_jumps,
    parts_of,
)

__all__ = [
    "DECLARED",
    "DIALOG_ANSWER",
    "FLAG_BARE",
    "FLAG_DELETE",
    "FLAG_POINT",
    "MODES",
    "NO_OUTPUTS",
    "PARAMETER",
    "STATEMENTS",
    "TYPES",
    "WORD",
    "Array",
    "Assign",
    "Binary",
    "Block",
    "BlockTable",
    "Call",
    "Constant",
    "Declare",
    "DeferredBlock",
    "Definition",
    "Device",
    "Expr",
    "For",
    "Guard",
    "If",
    "Include",
    "Input",
    "Jump",
    "Label",
    "Message",
    "Mistake",
    "Mode",
    "Named",
    "Number",
    "Program",
    "Repeat",
    "Replaced",
    "Return",
    "Scan",
    "SourceFile",
    "SpindleOutputs",
    "Statement",
    "Subprogram",
    "Text",
    "Unary",
    "Unsupported",
    "Variable",
    "While",
    "Word",
    "lost_jumps",
    "parts_of",
    "words_equal",
]


@record(frozen=True, slots=True, kw_only=True)
class Subprogram:
    """A named list of statements; name in lower case; end_span: the line that closes it; text: the name of a procedure
    as written.

    is_file: it is a whole file, which local coordinates do not outlive (``LanguageRules.local_in_files``).
    parameters: (name, type as in TYPES, number of the variable that holds it) of a procedure. is_module: it is in
    the source under its name; another one is a procedure, or a label within a module, with what follows that.
    """

    name: str
    body: tuple[Statement, ...]
    span: Span
    end_span: Span | None = None
    is_file: bool = False
    parameters: tuple[tuple[str, str, int], ...] = ()
    is_module: bool = False
    text: str = ""


@record(slots=True, kw_only=True)
class SourceFile:
    """A file as read. name: as the user gave it; sha256: of ``data``; data: its bytes (may be a memory map).

    line_count: its lines; newline: what ends the first of them; mark: it starts with a UTF-8 mark;
    notes: what is in its lines apart from the program, when it was loaded (``Program.load_notes``), else None.
    """

    name: str
    sha256: str
    data: bytes = field(default=b"", compare=False, repr=False)
    line_count: int = 0
    newline: str = "\n"
    mark: bool = False
    notes: Notes | None = None


Scan = Callable[[bytes, int, int, int, int], tuple[Columns, int, int]]
"""``(data, begin, end, first line, limit)`` -> (words, next byte, next line); see ``Program.load``."""


@record(frozen=True, slots=True)
class SpindleOutputs:
    """Channels of outputs that run a spindle together, in either direction, as a shop's own definitions have it.

    They are on after the definition of its start (M3; backward: M4) and off after that of its stop (M5). coolant:
    channels of outputs that M7 or M8 switches on and M9 off; mist: those of them that M7 switches on and M8 does not.
    """

    forward: tuple[int, ...] = ()
    backward: tuple[int, ...] = ()
    coolant: tuple[int, ...] = ()
    mist: tuple[int, ...] = ()


NO_OUTPUTS = SpindleOutputs()


@record(slots=True, kw_only=True)
class Program:
    """A whole job. body runs from the top; subprograms are called by name.

    overrides: (letter, tenths) of codes that a subprogram replaces -> its name. The words of such a line are its
    arguments (``LanguageRules.argument_base``); inside of it the code is the controller's own.
    A macro file alone is a Program of ``Definition`` nodes, which are in no other Program.
    head, tail: the first and the last statements of the body, which the machine's settings put there; the tail also
    runs where the job ends itself before; abort: what runs where it aborts itself. around_files: head and tail run
    around each subprogram that is a file, too; None: nobody said so, and it would make a difference. open_codes: where
    a file that was not given, or that was not understood, may define codes that the language does not have, what to do
    about it. spindle_outputs: those that run the spindle
    where no code of the language does and the shop's definitions tell. unended: subprograms, "" for the body, of which
    a finding of the frontend says that they have no end. macro_files: names of those files that run only where a
    command that the machine defines (a macro, a setting) calls them. assumed: what reading the files took for granted.
    """

    dialect: str
    rules: LanguageRules
    files: list[SourceFile] = field(default_factory=list)
    body: tuple[Statement, ...] = ()
    subprograms: dict[str, Subprogram] = field(default_factory=dict)
    overrides: dict[tuple[str, int], str] = field(default_factory=dict)
    line_count: int = 0
    head: tuple[Statement, ...] = ()
    tail: tuple[Statement, ...] = ()
    around_files: bool | None = False
    open_codes: str = ""
    abort: tuple[Statement, ...] = ()
    spindle_outputs: SpindleOutputs = NO_OUTPUTS
    unended: frozenset[str] = field(default=frozenset(), compare=False, repr=False)
    macro_files: frozenset[str] = field(default=frozenset(), compare=False, repr=False)
    assumed: list[str] = field(default_factory=list, compare=False, repr=False)
    scan: Scan | None = field(default=None, compare=False, repr=False)
    annotate: Annotate | None = field(default=None, compare=False, repr=False)

    def load(self, table: BlockTable, begin: int, line: int, limit: int) -> tuple[Columns, int, int]:
        """Words of ``table`` from byte ``begin`` (which starts line ``line``), at most about ``limit`` bytes.

        Returns (WORD columns with offsets from ``begin``, byte and line where the next call goes on).
        """
        if table.words is not None:
            return table.words, table.end, table.last_line + 1
        if self.scan is None:
            raise ValueError("this program has neither words nor a scanner for its tables")
        return self.scan(self.files[table.file].data, begin, table.end, line, limit)

    def load_notes(self, file: int, begin: int, line: int, limit: int) -> tuple[Notes, int, int]:
        """Notes of a file from byte ``begin`` (which starts line ``line``), of at most about ``limit`` bytes.

        Returns (notes, byte and line where the next call goes on); start with byte 0 and line 1, end after line
        ``line_count``. They are read when somebody asks, so that a program which is only executed costs nothing.
        """
        source = self.files[file]
        if source.notes is not None:
            return source.notes, len(source.data), source.line_count + 1
        if self.annotate is None:
            raise ValueError("this program has neither notes nor a way to read them")
        return self.annotate(source.data, begin, line, limit)

    def verify(self) -> None:
        """Tables lie within their files and follow the order of lines; jumps have labels that they can go to, loops
        that count a variable that is written by its number; declarations, modes and parameters are of known kinds."""
        for source in self.files:
            if source.notes is not None:
                source.notes.verify()
        for sub in self.subprograms.values():
            if sub.name != sub.name.lower():
                raise ValueError(f"subprogram name {sub.name!r} is not lower case")
            for name, type_, _ in sub.parameters:
                if type_.removeprefix("var ") not in TYPES:
                    raise ValueError(f"parameter {name!r} of {sub.name!r} has the type {type_!r}")
            self._verify_body(sub.body)
            _verify_jumps(sub.body)
        for code, name in self.overrides.items():
            if name not in self.subprograms:
                raise ValueError(f"{code} is replaced by {name!r}, which is not a subprogram")
        self._verify_body(self.body)
        _verify_jumps(self.body)
        self._verify_definitions()

    def _verify_definitions(self) -> None:
        """Definitions have names that lines are compared with, and are only among definitions and mistakes."""
        definitions = [node for node in self.body if isinstance(node, Definition)]
        if definitions and (self.subprograms or not all(isinstance(n, Definition | Mistake) for n in self.body)):
            raise ValueError("definitions are next to what is not a definition")
        for node in definitions:
            if not node.name or node.name != node.name.upper() or not node.label or "=" in node.label:
                raise ValueError(
                    f"{node.label!r} is not a name of a definition, or {node.name!r} not its name in upper case"
                )
            if any(c in part for c in "\r\n" for part in (node.label, node.written)) or (
                node.line and not node.written
            ):
                raise ValueError(f"the definition of {node.name} is not a command of one line")

    def _verify_body(self, body: tuple[Statement, ...]) -> None:
        for node in body:
            if type(node) not in STATEMENTS:
                raise ValueError(f"{type(node).__name__} is not a statement")
            if isinstance(node, Device):
                least, most, _ = DEVICES.get(node.name, (1, 0, ""))
                if not least <= len(node.arguments) <= most:
                    raise ValueError(f"{node.name!r} with {len(node.arguments)} arguments is not a command of DEVICES")
            elif isinstance(node, Definition) and body is not self.body:
                raise ValueError(f"the definition of {node.name} is within another statement")
            elif isinstance(node, BlockTable):
                size = len(self.files[node.file].data) or node.end
                if not (0 <= node.begin <= node.end <= size and 1 <= node.first_line <= node.last_line):
                    raise ValueError(f"block table {node} is outside its file")
            elif isinstance(node, Declare):
                if node.kind not in DECLARED or not node.names or (node.kind == "const") != (node.value is not None):
                    raise ValueError(f"{node} declares nothing")
            elif isinstance(node, Mode):
                if node.name not in MODES:
                    raise ValueError(f"{node} is not a language")
            elif isinstance(node, For) and not isinstance(node.variable.number, Number):
                raise ValueError(f"{node.variable} is computed, and a loop counts it")
            for part in parts_of(node):
                self._verify_body(part)


def _verify_jumps(body: tuple[Statement, ...]) -> None:
    lost = next(lost_jumps(body), None)
    if lost is not None:
        raise ValueError(f"{lost} jumps to a label that it cannot reach")


def words_equal(left: Columns, right: Columns) -> bool:
    """Bit-for-bit equality of two word tables, values included (so -0.0 differs from 0.0)."""
    return left == right and bool(np.array_equal(left["value"].view(np.int64), right["value"].view(np.int64)))
