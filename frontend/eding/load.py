"""An Eding job and the macro file beside it, from bytes to a Program.

One pass finds the lines that are not plain (``scan.index``); those go through the grammar, everything
between becomes block tables whose words are scanned when they run, so that a job of any length costs memory
only for its lines with expressions and flow control.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from pathlib import Path

from gproof.frontend.eding.build import STRUCTURAL, Structural
from gproof.frontend.eding.notes import annotate
from gproof.frontend.eding.prepare import LineError, structure_of
from gproof.frontend.eding.scan import index, scan
from gproof.frontend.eding.shapes import Reader
from gproof.frontend.eding.structure import Assembler
from gproof.frontend.lines import LineIndex
from gproof.frontend.source import UTF8_MARK, decode, read_source
from gproof.ir import codes
from gproof.ir.columns import Columns
from gproof.ir.dialects import rules_named
from gproof.ir.finding import Finding, Findings, Refusal, Span
from gproof.ir.program import BlockTable, Call, If, Program, SourceFile, Statement, While
from gproof.ir.rules import LanguageRules

MACRO_FILE = "macro.cnc"
"""Loaded with every job from the job's folder (manual 4.3)."""

HELD_LINES = 2000
HELD_IN_ALL = 200_000
"""A table of at most so many lines holds its words, until the tables of a program hold that many."""


def load_program(path: Path, findings: Findings, macro: Path | None = None) -> Program | None:
    """The program in ``path``, with the subprograms of its macro file; None when a file is refused.

    macro: the macro file, instead of ``macro.cnc`` in the folder of ``path``. Mistakes go into ``findings``
    (GP101–GP124), one for each line; a line with a mistake is left out of the program. Where the job never runs such a
    line of the macro file, the finding is GP126.
    """
    program = Program(dialect="eding", rules=rules_named("eding"), scan=scan, annotate=annotate)
    loader = _Loader(program, findings)
    before = sum(findings.counts.values())
    try:
        program.body = loader.load(path)
        beside = path.with_name(MACRO_FILE)
        if macro is not None:
            loader.load(macro)
        elif beside.is_file() and path.name.lower() != MACRO_FILE:
            loader.load(beside)
    except Refusal as refusal:
        findings.add(refusal.finding)
        return None
    program.subprograms = loader.assembler.subprograms
    program.overrides = overrides_of(program.subprograms, program.rules)
    loader.settle()
    is_clean = sum(findings.counts.values()) == before
    if is_clean and not program.body and not loader.subprograms_in_job:
        findings.add(codes.EMPTY_PROGRAM.at(Span(str(path), 0)))
    return program


def load_alone(path: Path, findings: Findings, name: str = "") -> Program | None:
    """One file as a program, without a macro file, to be printed again; None when it is refused.

    Calls of subprograms that stand in other files are no mistakes here, nor is a file without a program.
    name: of the file in findings, when it is not ``path``.
    """
    program = Program(dialect="eding", rules=rules_named("eding"), scan=scan, annotate=annotate)
    loader = _Loader(program, findings)
    try:
        program.body = loader.load(path, name)
    except Refusal as refusal:
        findings.add(refusal.finding)
        return None
    program.subprograms = loader.assembler.subprograms
    program.overrides = overrides_of(program.subprograms, program.rules)
    return program


_M_NAME = re.compile(r"m(\d{1,3})")
CHANGE_TOOL = "change_tool"


def overrides_of(names: Iterable[str], rules: LanguageRules) -> dict[tuple[str, int], str]:
    """Codes that subprograms of these names replace: ``m3``, ``m100`` ... (4.4), ``change_tool`` for M6 (3.5.3)."""
    found = {("M", 10 * int(m[1])): m[0] for name in sorted(names) if (m := _M_NAME.fullmatch(name))}
    found = {code: name for code, name in found.items() if name == f"m{code[1] // 10}"}
    if CHANGE_TOOL in names:
        found.setdefault(("M", 60), CHANGE_TOOL)
    return found


def reachable(program: Program) -> set[str]:
    """Names of the subprograms that a job may run: from its statements, and those that replace a code."""
    found: set[str] = set()
    names = [*program.overrides.values(), *_called(program.body)]
    while names:
        name = names.pop()
        if name not in found and name in program.subprograms:
            found.add(name)
            names += _called(program.subprograms[name].body)
    return found


def _called(body: Iterable[Statement]) -> Iterator[str]:
    """Names of the calls in statements and in the blocks inside them."""
    for node in body:
        if isinstance(node, Call):
            yield node.name
        elif isinstance(node, If):
            yield from _called(node.then)
            yield from _called(node.otherwise)
        elif isinstance(node, While):
            yield from _called(node.body)


def _unreached(finding: Finding, inside: str) -> Finding:
    where = f"in subprogram {inside!r}" if inside else "outside of subprograms"
    return codes.UNREACHED_MISTAKE.at(
        finding.span, message=finding.message, label=finding.code.label, where=where, related=finding.related
    )


class _Loader:
    """Loads the files of one program one after another."""

    def __init__(self, program: Program, findings: Findings) -> None:
        self.program = program
        self.findings = findings
        self.assembler = Assembler(findings)
        self.reader = Reader()
        self.held = 0
        self.subprograms_in_job = 0
        self.waiting: list[tuple[Finding, str]] = []
        """Mistakes in lines of the macro file, and the subprogram of each."""

    def load(self, path: Path, name: str = "") -> tuple[Statement, ...]:
        """Read a file; its statements outside subprograms."""
        source = read_source(path)
        source.name = name or source.name
        number = len(self.program.files)
        self.program.files.append(source)
        limit = self.program.rules.line_length
        begin = len(UTF8_MARK) if source.data[:3] == UTF8_MARK else 0
        found = index(source.data, begin, limit)
        source.mark = begin > 0
        source.line_count = found.line_count
        first_end = source.data.find(b"\n")
        source.newline = "\r\n" if first_end > 0 and source.data[first_end - 1 : first_end] == b"\r" else "\n"
        self.program.line_count = self.program.line_count or found.line_count
        self.assembler.begin_file(source.name)
        self._lines(number, source, begin, found)
        body = self.assembler.end_file()
        if number == 0:
            self.subprograms_in_job = len(self.assembler.subprograms)
        return body

    def settle(self) -> None:
        """Findings that need every subprogram: missing ones, and mistakes that the job may never meet."""
        reached = reachable(self.program)
        job = self.program.files[0].name
        for call, inside in self.assembler.calls:
            if call.name not in self.program.subprograms:
                finding = codes.UNKNOWN_SUBPROGRAM.at(call.span, name=call.name)
                if call.span.file == job:
                    self.findings.add(finding)
                else:
                    self.waiting.append((finding, inside))
        for finding, inside in self.waiting:
            self.findings.add(finding if inside in reached else _unreached(finding, inside))

    def _lines(self, file: int, source: SourceFile, begin: int, found: LineIndex) -> None:
        """Tables and statements of a file in order."""
        line = 1
        for number, first, after, has_words in found.rows():
            if has_words:
                self._table(file, source, line, number - 1, begin, first)
            self._special(source, number, source.data[first:after])
            line, begin = number + 1, after
        if found.words_after:
            self._table(file, source, line, found.line_count, begin, len(source.data))

    def _table(self, file: int, source: SourceFile, first: int, last: int, begin: int, end: int) -> None:
        lines = last - first + 1
        words: Columns | None = None
        if lines <= HELD_LINES and self.held + lines <= HELD_IN_ALL:
            self.held += lines
            words, _, _ = scan(source.data, begin, end, first, end - begin)
            words = Columns(words.schema, {name: column.copy() for name, column in words.arrays.items()})
        table = BlockTable(file=file, first_line=first, last_line=last, begin=begin, end=end, words=words)
        self.assembler.add(table)

    def _special(self, source: SourceFile, number: int, raw: bytes) -> None:
        """A line that is not plain: statements, or a finding."""
        limit = self.program.rules.line_length
        raw = raw.removesuffix(b"\n").removesuffix(b"\r")
        try:
            if len(raw) > limit:
                structure = structure_of(decode(raw[:limit]))
                raise LineError(
                    codes.LINE_TOO_LONG, limit, len(raw), structure=structure, length=len(raw), allowed=limit
                )
            for statement in self.reader.read(raw, source.name, number):
                self.assembler.add(statement)
        except LineError as error:
            span = Span(source.name, number, error.begin + 1, error.end + 1)
            finding = error.code.at(span, **error.values)
            if len(self.program.files) > 1 and error.structure not in ("sub", "endsub"):
                self.waiting.append((finding, self.assembler.subprogram))
            else:
                self.findings.add(finding)
            if error.structure in STRUCTURAL:
                self.assembler.add(Structural(error.structure, span))
