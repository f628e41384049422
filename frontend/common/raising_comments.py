"""Comments of a program as operations of its Job, each where its line is."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from gproof.ir.finding import Span
from gproof.ir.job import Node, Remark
from gproof.ir.notes import NoteKind
from gproof.ir.program import Program

PIECE_BYTES = 1 << 22


class Comments:
    """The comments of the program, handed out line by line: to each subprogram those between its first line and its
    last one, to the job all others of its file."""

    KINDS = frozenset({NoteKind.COMMENT, NoteKind.REMARK, NoteKind.SIGNED})
    JOB = ""
    """The scope of the job itself; the others are names of subprograms."""

    def __init__(self, program: Program, text_of: Callable[[int, bytes], str]) -> None:
        self.program = program
        self.text_of = text_of
        self.next: dict[str, int] = {}
        self.scope = self.JOB
        self.numbers = {source.name: number for number, source in enumerate(program.files)}
        self.rows: dict[str, list[tuple[int, str, bool]]] = {}
        self.read: set[str] = set()
        self.files = {name: sub.span.file for name, sub in program.subprograms.items()}
        if program.files:
            self.files[self.JOB] = program.files[0].name
            self._load(self.files[self.JOB])

    def enter(self, scope: str) -> str:
        """Those of a subprogram are next, from its first line on; gives the scope before it."""
        before, self.scope = self.scope, scope
        self.next[scope] = 0
        self._load(self.files.get(scope, ""))
        return before

    def before(self, file: str, line: int) -> list[Node]:
        """Those of lines before ``line`` that nobody took; none in a file that the scope is not in."""
        if file != self.files.get(self.scope):
            return []
        rows, begin = self.rows.get(self.scope, []), self.next.get(self.scope, 0)
        end = begin
        while end < len(rows) and rows[end][0] < line:
            end += 1
        self.next[self.scope] = end
        return [Remark(text=text, span=Span(file, at), trailing=trailing) for at, text, trailing in rows[begin:end]]

    def rest(self) -> list[Node]:
        """All those of the scope that nobody took."""
        return self.before(self.files.get(self.scope, ""), 1 << 31)

    def line_of_next(self, file: str) -> int | None:
        """The line of the first that nobody took."""
        rows, at = self.rows.get(self.scope, []), self.next.get(self.scope, 0)
        return rows[at][0] if file == self.files.get(self.scope) and at < len(rows) else None

    def _load(self, file: str) -> None:
        """Read the comments of a file, once, into the rows of its scopes."""
        number = self.numbers.get(file)
        if number is None or file in self.read:
            return
        self.read.add(file)
        owners = sorted(self._owners(file))
        begin, line, count = 0, 1, self.program.files[number].line_count
        while line <= count:
            notes, begin, after = self.program.load_notes(number, begin, line, PIECE_BYTES)
            for at, place, kind, _, text in notes:
                if kind in self.KINDS:
                    within = [name for first, last, name in owners if first <= at <= last]
                    scope = within[-1] if within else self.JOB
                    if scope != self.JOB or number == 0:
                        self.rows.setdefault(scope, []).append((at, self.text_of(kind, text), place > 0))
            if after <= line:
                break
            line = after

    def _owners(self, file: str) -> Iterator[tuple[int, int, str]]:
        """(first line, last line, name) of the subprograms that are in a file."""
        for name, sub in self.program.subprograms.items():
            if sub.span.file != file:
                continue
            if sub.is_file:
                yield 1, 1 << 31, name
            elif sub.end_span is not None:
                yield sub.span.line, sub.end_span.line, name
