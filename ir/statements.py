"""Statements of a Program: blocks of words over expression trees, loops, calls, and tables of plain lines.

Straight-line code of literal words is a ``BlockTable`` (numpy columns), never objects.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any, get_args

from gproof.ir.columns import Column, Columns, Schema
from gproof.ir.finding import Span
from gproof.ir.record import field, record

WORD = Schema(
    "words",
    Column("line", "i4"),
    Column("offset", "i4"),
    Column("letter", "u1"),
    Column("flags", "u1"),
    Column("value", "f8"),
)
"""One word a row, in source order: line; byte offset in the line's file chunk; upper-case ASCII letter;
flags; value, equal to float(text) bit for bit. ``offset`` counts from the table's ``base``."""

FLAG_POINT = 1
"""The number had a decimal point."""
FLAG_DELETE = 2
"""The line started with a block delete slash."""
FLAG_BARE = 4
"""The letter is without a number, which counts as 0."""


@record(frozen=True, slots=True)
class Number:
    """A literal. point: it was written with a decimal point, which some controllers read as another unit."""

    value: float
    span: Span
    point: bool = False


@record(frozen=True, slots=True)
class Text:
    """A literal string in a message."""

    value: str
    span: Span


@record(frozen=True, slots=True)
class Variable:
    """A numbered controller variable; its number may be computed. name: what it is called where it has a name."""

    number: Expr
    span: Span
    name: str = ""


@record(frozen=True, slots=True)
class Constant:
    """A value with a name: ``true``, or one that the program declares."""

    name: str
    value: float
    span: Span


@record(frozen=True, slots=True)
class Named:
    """A variable of the controller with a name, in upper case, or the argument of the call with that letter.

    What a name means is in ``LanguageRules.variables``; a single letter is an argument of the subprogram.
    """

    name: str
    span: Span


@record(frozen=True, slots=True)
class Input:
    """The state of a channel of the machine: 1 on, 0 off.

    kind: ``input``, ``output`` (what the program or the setup made of it), ``virtual``, ``answer``: what the operator
    says to the question that ``number`` counts, ``outside``: what another device or program gives, any number, or
    ``given``: ``number`` is the state itself. simulated: what a
    simulation takes it to be, where the program says so; it has no bearing on what the machine does.
    """

    kind: str
    number: Expr
    span: Span
    simulated: float | None = None


@record(frozen=True, slots=True)
class Unary:
    """operator: ``neg``, ``abs``, ``acos`` ... , see ir/rules.py UNARY. whole: as of Binary."""

    operator: str
    operand: Expr
    span: Span
    whole: bool = field(default=False, compare=False)


@record(frozen=True, slots=True)
class Binary:
    """operator: ``+``, ``**``, ``mod``, ``atan`` (two-argument arc tangent, left over right) ..., see BINARY.

    doubtful: the grouping with its neighbours rests on a precedence that the manual does not state. readings: of the
    outermost operator of such a chain: every tree that may be meant, the usual one first, without doubtful operators.
    whole: its type is that of whole numbers of 32 bits; what no such number is has no value.
    """

    operator: str
    left: Expr
    right: Expr
    span: Span
    doubtful: bool = False
    whole: bool = field(default=False, compare=False)
    readings: tuple[Expr, ...] = field(default=(), compare=False, repr=False)


Expr = Number | Text | Variable | Constant | Named | Input | Unary | Binary

PARAMETER = "@"
"""Letter of a word that is a number without one: what the code before it is about (``G04 3``)."""


@record(frozen=True, slots=True)
class Word:
    """A letter and its value, in a block that is not plain.

    bare: the letter is without a number, which counts as 0; braced: the value is a number in braces.
    """

    letter: str
    value: Expr
    span: Span
    bare: bool = False
    braced: bool = False


@record(frozen=True, slots=True)
class Assign:
    """variable = value; takes effect after every value of its block is found."""

    target: Variable
    value: Expr
    span: Span


@record(frozen=True, slots=True, kw_only=True)
class Block:
    """One line of words and assignments with expressions in them.

    deleted: it started with a slash. own: its codes are the controller's own, whatever a subprogram replaces.
    texts: what its words have of text, by letter: names, file names. continued: the code that a line without one goes
    on with, in languages where the order of the source decides that: ``G1``, "" for
    none, "?" where the manual leaves it open. distances: ``G90`` or ``G91``, where the source decides that too.
    """

    words: tuple[Word, ...]
    assigns: tuple[Assign, ...]
    span: Span
    comment: str = ""
    deleted: bool = False
    own: bool = False
    texts: tuple[tuple[str, Text], ...] = ()
    continued: str = ""
    distances: str = ""


class DeferredBlock(Block):
    """A block that is made when a part of it is needed, and equal to it.

    A program of a million lines with expressions keeps these (a fifth of a kilobyte each) instead of their trees.
    make: (raw, file, line) -> the block; raw: the bytes of its line, without the end.
    """

    __slots__ = ("_file", "_line", "_make", "raw")

    def __init__(self, make: Callable[[bytes, str, int], Block], raw: bytes, file: str, line: int) -> None:
        keep = object.__setattr__
        keep(self, "_make", make)
        keep(self, "raw", raw)
        keep(self, "_file", file)
        keep(self, "_line", line)

    @property
    def place(self) -> tuple[str, int]:
        """File and line, without making the block."""
        return self._file, self._line

    def has_letter(self, letter: str) -> bool:
        """Whether its line has this letter anywhere, without making the block."""
        return letter.encode() in self.raw.upper()

    def made(self) -> Block:
        """The block itself."""
        block: Block = self._make(self.raw, self._file, self._line)
        return block

    def __getattr__(self, name: str) -> Any:
        """A field of the block: none is ever set here, so that Python looks for all of them."""
        if name in DeferredBlock.__slots__:
            raise AttributeError(name)
        return getattr(self.made(), name)

    def __eq__(self, other: object) -> bool:
        return self.made() == (other.made() if isinstance(other, DeferredBlock) else other)

    def __hash__(self) -> int:
        return hash(self.made())

    def __reduce__(self) -> Any:
        return self.made().__reduce_ex__(4)


@record(frozen=True, slots=True, kw_only=True)
class If:
    """condition is true when not zero.

    span: the line that opens it; else_span: the line that divides it, None without one (an empty ``otherwise`` may
    have one); end_span: the line that closes it. The latter two are None where nobody wrote them.
    head: the line that asks, where the language has one: the statement after it is what runs or is passed over.
    """

    condition: Expr
    then: tuple[Statement, ...]
    otherwise: tuple[Statement, ...]
    span: Span
    else_span: Span | None = None
    end_span: Span | None = None
    head: Statement | None = None


@record(frozen=True, slots=True, kw_only=True)
class Array:
    """Repeats what follows it over a grid of rows and columns (WinCNC L10).

    words: as written (R rows, C columns, X and Y distances, E: no way back at the end); body: everything up to the
    next array or the end of the file. Without words it ends the array before it, and has no body. line: see Call.
    """

    words: tuple[Word, ...]
    body: tuple[Statement, ...]
    span: Span
    comment: str = ""
    line: Block | None = None


@record(frozen=True, slots=True, kw_only=True)
class Replaced:
    """A line whose command the machine's macro file replaces (WinCNC, CNC.MAC).

    written: the line as it is, without comments; body: what it stands for, nothing for a code that is switched
    off, at the place of the line. line: see Call; None for a line that makes others be left out. length: the most
    characters that the line has while it is replaced; it hangs on blanks, and is no part of the value.
    """

    written: str
    body: tuple[Statement, ...]
    span: Span
    comment: str = ""
    line: Block | None = None
    length: int = field(default=0, compare=False)


@record(frozen=True, slots=True, kw_only=True)
class Definition:
    """A command that a machine's macro file defines, replaces or switches off (WinCNC, CNC.MAC).

    It is in a file of its own and does nothing when it runs: jobs have what it makes of their lines (``Replaced``).
    name: what lines are compared with, in upper case, a code without leading zeros; label: the name as written;
    written: the command as it is, without comments, "" for a code that is switched off. line: the command's words
    and texts, to be printed again (see Call); None for one that only the line of a job completes.
    """

    name: str
    label: str
    written: str
    span: Span
    line: Block | None = None


@record(frozen=True, slots=True, kw_only=True)
class While:
    """Repeats while the condition is not zero. end_span: the line that closes it."""

    condition: Expr
    body: tuple[Statement, ...]
    span: Span
    end_span: Span | None = None


@record(frozen=True, slots=True, kw_only=True)
class Repeat:
    """Runs its body until the condition is not zero, once at least. end_span: the line with the condition."""

    condition: Expr
    body: tuple[Statement, ...]
    span: Span
    end_span: Span | None = None


@record(frozen=True, slots=True, kw_only=True)
class For:
    """Runs its body for each whole number from first to last (down: falling), none when there are none.

    Both bounds are evaluated once, before the first pass. end_span: the line that closes it.
    """

    variable: Variable
    first: Expr
    last: Expr
    down: bool
    body: tuple[Statement, ...]
    span: Span
    end_span: Span | None = None


@record(frozen=True, slots=True, kw_only=True)
class Label:
    """A place that jumps go to; name in lower case, as its digits without leading zeros where it is a number."""

    name: str
    span: Span


@record(frozen=True, slots=True, kw_only=True)
class Jump:
    """Goes on after the label of that name: in the same list of statements or in one around it, never in another
    subprogram."""

    name: str
    span: Span


@record(frozen=True, slots=True, kw_only=True)
class Return:
    """Ends the subprogram that runs. code: as written."""

    span: Span
    code: str = ""


DECLARED = ("var", "const", "label")
MODES = ("din", "pascal")
TYPES = ("integer", "double", "boolean", "unknown")
"""Of parameters; ``var`` before one of them: what the procedure makes of it goes back into the variable it is given."""


@record(frozen=True, slots=True, kw_only=True)
class Declare:
    """Names with a type; does nothing when it runs, but that variables of a procedure start without a value.

    kind: one of DECLARED; value: of a constant; number: of the first variable, which the others follow.
    """

    kind: str
    names: tuple[str, ...]
    span: Span
    type: str = ""
    value: Expr | None = None
    number: int = 0


@record(frozen=True, slots=True, kw_only=True)
class Include:
    """The place of a file that is read in; its statements follow, with spans of their own file. name: as written."""

    name: str
    span: Span


@record(frozen=True, slots=True, kw_only=True)
class Mode:
    """Where the source goes over from one of its languages to the other. name: ``din`` or ``pascal``."""

    name: str
    span: Span


@record(frozen=True, slots=True, kw_only=True)
class Call:
    """Runs a subprogram by its (lower-case) name.

    count: how often, None: once. deleted: its line started with a slash. arguments: what its words are named by inside
    (``Named``). text: the name as written; counted: its lines count as lines of the job.
    line: the words and texts of its line, to be printed again, in languages whose statements are lines of words; a
    text without a letter is a name as written.
    """

    name: str
    span: Span
    deleted: bool = False
    arguments: tuple[Word, ...] = ()
    text: str = ""
    counted: bool = True
    line: Block | None = None
    count: Expr | None = None


DIALOG_ANSWER = 5398
"""The number of the variable that says how a dialog (``Message``) was closed."""


@record(frozen=True, slots=True, kw_only=True)
class Message:
    """Text for the operator. kind: ``msg``, ``warning``, ``error`` (stops the program), ``log``, ``dialog``, ``write``
    and ``writeln`` (a line of text is still open after it, or ends); a question
    with a button or two: ``ok``, ``abort`` and ``continue`` (yes aborts, yes goes on), ``run_next`` and ``skip_next``
    (the head of an If).

    question: its number among those of the program, 0 for what is none. in_comment: written as a comment of its line,
    where its text is among the notes too. deleted: the line started with a slash. line: see Call. formats: such as
    ``%d`` among its parts, which only shape its text.
    """

    kind: str
    parts: tuple[Expr, ...]
    span: Span
    formats: tuple[str, ...] = ()
    in_comment: bool = False
    deleted: bool = False
    question: int = 0
    line: Block | None = None


@record(frozen=True, slots=True, kw_only=True)
class Guard:
    """Switches a guard: name ``tool_change_area`` or ``machine_area``. deleted: its line started with a slash."""

    name: str
    on: bool
    span: Span
    deleted: bool = False


@record(frozen=True, slots=True, kw_only=True)
class Device:
    """A command to the controller that is no block of words: homing, height maps, a knife ...

    name: a key of ``rules.DEVICES``, which tells what it means and how many arguments it has; names of axes, files
    and switches are ``Text`` arguments (axes in lower case). deleted: its line started with a slash.
    """

    name: str
    arguments: tuple[Expr, ...]
    span: Span
    deleted: bool = False


@record(frozen=True, slots=True, kw_only=True)
class Unsupported:
    """A statement that the manual has and gproof does not model; what follows is unknown.

    text: the statement as written, without comments; "" when there is more of it than a line. deleted: the line
    started with a slash. line: see Call. ``told``: a frontend finding says already what is wrong here. accepted: the
    entry of ``accepts`` of a machine file by which a controller has it after all (``dialects/accepts.py``), and means
    what it does then; "": none.
    """

    what: str
    span: Span
    text: str = ""
    deleted: bool = False
    line: Block | None = None
    told: bool = False
    accepted: str = ""
    means: tuple[Statement, ...] = ()


@record(frozen=True, slots=True, kw_only=True)
class Mistake:
    """A line with a mistake that only matters when it runs. code: number of its finding; text: the line as written.

    ``told``: a frontend finding says already what is wrong here; the line may have changed anything all the same.
    """

    code: int
    message: str
    span: Span
    text: str = ""
    hint: str = ""
    told: bool = False


@record(frozen=True, slots=True, kw_only=True)
class BlockTable:
    """Successive plain lines of one file.

    The words are not held here but scanned when they run (``Program.load``), so that a table of millions of
    lines costs nothing before. first_line, last_line: inclusive; ``begin``, ``end``: byte range of the file;
    words: WORD columns with offsets from ``begin`` when the table is small or was loaded, else None.
    continued: see Block, for its first line; distances: see Block, for all of them.
    """

    file: int
    first_line: int
    last_line: int
    begin: int
    end: int
    words: Columns | None = None
    continued: str = ""
    distances: str = ""


Statement = (
    Block | If | While | Repeat | For | Array | Replaced | Definition | Call | Label | Jump | Return | Declare | Include
    | Mode | Message | Guard | Device | Unsupported | Mistake | BlockTable
)  # fmt: skip
STATEMENTS = frozenset(get_args(Statement)) | {DeferredBlock}


def parts_of(node: Statement) -> tuple[tuple[Statement, ...], ...]:
    """The lists of statements within a statement."""
    if isinstance(node, If):
        return node.then, node.otherwise
    if isinstance(node, While | Repeat | For | Array | Replaced):
        return (node.body,)
    return ()


def lost_jumps(body: tuple[Statement, ...], around: frozenset[str] = frozenset()) -> Iterator[Jump]:
    """Jumps whose label is neither in their list of statements nor in one around it; around: labels of those."""
    inner = around.union(node.name for node in body if isinstance(node, Label))
    for node in body:
        if isinstance(node, Jump) and node.name not in inner:
            yield node
        for part in parts_of(node):
            yield from lost_jumps(part, inner)
