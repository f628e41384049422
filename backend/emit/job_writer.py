"""A legal Job as the text of a target: what all targets share.

The writer walks the Job, keeps what modes the text is in, and prints a mode's word only where it changes. Modes that
no operation of the job changes are set once, in the header, and hold in subprograms and loops as well; in these, all
others are taken as unknown until they are printed. A target's writer says what words its operations have.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Iterator
from typing import Any

from gproof.backend.emit.printer import Unprintable
from gproof.ir.finding import Span
from gproof.ir.job import (
    LENGTHS,
    ArcTo,
    Choice,
    CountLoop,
    DrillHole,
    Job,
    LoopWhile,
    Moves,
    MoveTo,
    Node,
    Nodes,
    OptionalPart,
    ParkAt,
    Remark,
    RepeatGrid,
    Routine,
    bodies,
    quantities,
    walk,
)
from gproof.ir.machine import Machine
from gproof.ir.record import field, record
from gproof.ir.target import Style, Target

State = dict[str, Any]
"""Modes that the text is in; one that is not there is not known."""


@record(slots=True, kw_only=True)
class Naming:
    """What stands for names of the source: of routines, and of variables by number."""

    routines: dict[str, str] = field(default_factory=dict)
    variables: dict[int, int] = field(default_factory=dict)


@record(slots=True, kw_only=True)
class Written:
    """The files of a translated job: text by name, "" for the job itself."""

    files: dict[str, bytes] = field(default_factory=dict)


class JobWriter:
    """See the module's text. machine: the target's; exact: numbers with all their digits."""

    def __init__(self, job: Job, target: Target, machine: Machine, style: Style) -> None:
        self.job = job
        self.target = target
        self.machine = machine
        self.style = style
        self.out: list[bytes] = []
        self.depth = 0
        self.state: State = {}
        self.constant = self.constant_modes()
        self.pending: list[tuple[int, str]] = []
        self.pending_at: Span | None = None
        self.names = self.routine_names()

    # ---- what a target decides

    def node(self, node: Node) -> None:
        """Print one operation that holds no others; Unprintable."""
        raise NotImplementedError

    def moves(self, node: Moves) -> None:
        """Print a table of moves."""
        raise NotImplementedError

    def header(self) -> Iterable[str]:
        """Lines before the first operation; they set ``self.state``."""
        return self.style.header

    def footer(self) -> Iterable[str]:
        """Lines after the last operation."""
        return self.style.footer

    def comment(self, text: str) -> str:
        """A comment with its signs."""
        raise NotImplementedError

    def routine_name(self, name: str) -> str:
        """The name of a routine in the target; two may have the same one here."""
        return self.plain_name(name)

    def plain_name(self, name: str) -> str:
        """A routine's name without the number of its variant and the extension of its file."""
        stem = name.partition("~")[0]
        return stem.rpartition(".")[0] or stem if self.job.routines[name].file else stem

    def open(self, node: Node) -> None:
        """The line that opens a loop or a choice; Unprintable."""
        raise Unprintable(type(node).__name__)

    def divide(self, node: Choice) -> None:
        """The line between the two ways of a choice."""
        raise Unprintable("a choice")

    def close(self, node: Node) -> None:
        """The line that closes a loop or a choice."""
        raise Unprintable(type(node).__name__)

    def routine(self, routine: Routine) -> None:
        """A routine with its first and last lines."""
        raise Unprintable("a subprogram")

    # ---- the whole

    def write(self) -> bytes:
        """The text of the job; Unprintable."""
        body = list(self.job.body)
        first = next((place for place, node in enumerate(body) if not isinstance(node, Remark)), len(body))
        self.body(tuple(body[:first]))
        for line in self.header():
            self.line(line)
        for routine in self.job.routines.values():
            self.state = dict(self.constant)
            self.routine(routine)
            self.flush()
        self.state = dict(self.constant)
        self.body(tuple(body[first:]))
        for line in self.footer():
            self.line(line)
        return b"".join(self.out)

    def constant_modes(self) -> State:
        """Modes that all operations of the job share: unit, distances, plane, what feeds are per."""
        units, relative, planes, per = set[str](), set[bool](), set[str](), set[str]()
        for node in self.all_nodes():
            if isinstance(node, Moves):
                units.add(node.unit)
                relative.add(node.relative)
                planes |= {node.plane} if (node.rows["kind"] > 2).any() else set()
                per |= {node.per}
                continue
            units |= {amount.unit for amount in quantities(node) if amount.unit in LENGTHS}
            if isinstance(node, MoveTo | ArcTo | ParkAt):
                relative |= {place.relative for place in node.to}
            if isinstance(node, DrillHole):
                relative |= {place.relative for place in (*node.at, node.top)}
            if isinstance(node, ArcTo | DrillHole):
                planes.add(node.plane)
            feed = getattr(node, "feed", None)
            if feed is not None:
                per.add(feed.per)
        found: State = {}
        for name, values in (("unit", units), ("relative", relative), ("plane", planes), ("per", per)):
            if len(values) == 1:
                found[name] = next(iter(values))
        return found

    def all_nodes(self) -> Iterator[Node]:
        """Every operation of the job."""
        for body in (self.job.body, *(routine.body for routine in self.job.routines.values())):
            yield from walk(body)

    def routine_names(self) -> dict[str, str]:
        """Names of the target that no two routines share; a second one gets a number, before its extension."""
        found: dict[str, str] = {}
        taken = set(self.style.taken)
        for name in self.job.routines:
            wanted = own = self.routine_name(name)
            stem, dot, extension = wanted.partition(".")
            for count in itertools.count(2):
                if own.upper() not in taken:
                    break
                own = f"{stem}_{count}{dot}{extension}"
            taken.add(own.upper())
            found[name] = own
        return found

    # ---- lists of operations

    def body(self, nodes: Nodes) -> None:
        """A list of operations."""
        for node in nodes:
            if isinstance(node, Remark):
                self.remark(node)
            elif isinstance(node, Moves):
                self.flush()
                self.moves(node)
            elif bodies(node):
                self.flush()
                self.structure(node)
            else:
                self.node(node)
        self.flush()

    def structure(self, node: Node) -> None:
        """A loop or a choice; what it leaves of the modes is what all its ways leave."""
        if isinstance(node, Choice):
            self.open(node)
            entry = dict(self.state)
            self.indented(node.then)
            after = self.state
            self.state = entry
            if node.otherwise:
                self.divide(node)
                self.indented(node.otherwise)
            self.close(node)
            self.state = joined(self.state, after)
        elif isinstance(node, OptionalPart):
            raise Unprintable("block delete")
        else:
            assert isinstance(node, LoopWhile | CountLoop | RepeatGrid)
            self._loop(node)

    def _loop(self, node: LoopWhile | CountLoop | RepeatGrid) -> None:
        """Printed again until the modes at its start are those that each pass starts in."""
        entry = dict(self.state)
        while True:
            mark = len(self.out)
            self.state = dict(entry)
            self.open(node)
            self.indented(node.body)
            both = joined(entry, self.state)
            if both == entry:
                self.close(node)
                self.state = both
                return
            del self.out[mark:]
            entry = both

    def indented(self, nodes: Nodes) -> None:
        """A list of operations within another one."""
        self.depth += 1
        self.body(nodes)
        self.depth -= 1

    # ---- lines

    def line(self, text: str) -> None:
        """A line of its own."""
        self.flush()
        blanks = " " * (self.style.indent * self.depth) if text else ""
        self.out.append(f"{blanks}{text}".encode() + self.style.newline.encode())

    def remark(self, node: Remark) -> None:
        """A comment, at the end of the line before it where it is one of that line."""
        text = self.comment(node.text)
        if node.trailing and self.pending:
            self.flush(f" {text}")
        elif node.trailing and self.out and self.last_line_of == node.span.line and not self.commented:
            end = self.style.newline.encode()
            self.out[-1] = self.out[-1].removesuffix(end) + f" {text}".encode() + end
            self.commented = True
        else:
            self.line(text)

    last_line_of = 0
    commented = False

    def put(self, rank: int, words: Iterable[str], span: Span) -> None:
        """Words of an operation; those of one line of the source share a line where their order allows it."""
        words = list(words)
        same = self.pending_at is not None and (self.pending_at.file, self.pending_at.line) == (span.file, span.line)
        letters = {word[0] for _, word in self.pending if word[0] not in "GM"}
        clash = any(word[0] in letters for word in words)
        if self.pending and (not same or rank <= self.pending[-1][0] or clash or not self.joins(rank, words)):
            self.flush()
        self.pending += [(rank, word) for word in words]
        self.pending_at = span

    def joins(self, rank: int, words: list[str]) -> bool:
        """Whether words may be on the line of those before them."""
        return True

    def flush(self, tail: str = "") -> None:
        """Print the line that is pending."""
        if not self.pending:
            return
        words = self.in_order([word for _, word in self.pending])
        line = self.pending_at.line if self.pending_at is not None else 0
        self.pending, self.pending_at = [], None
        blanks = " " * (self.style.indent * self.depth)
        self.out.append(f"{blanks}{words}{tail}".encode() + self.style.newline.encode())
        self.last_line_of, self.commented = line, bool(tail)

    def in_order(self, words: list[str]) -> str:
        """The words of a line as people write them."""
        return " ".join(words)


def joined(left: State, right: State) -> State:
    """What is the same in both."""
    return {name: value for name, value in left.items() if name in right and right[name] == value}


Handler = Callable[[Any], None]
