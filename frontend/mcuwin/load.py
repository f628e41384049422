"""A McuWIN job with its includes, from bytes to a Program.

The text goes over between DIN lines and sections of rw_SymPas (manual 10, 12); files that it includes are read in their
place, with what is in force. What stands before the first percent sign may be declarations without $DINEND.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

from gproof.frontend.mcuwin.expressions import Expressions
from gproof.frontend.mcuwin.include import DEEPEST, INCLUDE, differ, find
from gproof.frontend.mcuwin.lines import DinLine, Language, LineReader
from gproof.frontend.mcuwin.machine import NO_MCUWIN
from gproof.frontend.mcuwin.modules import assemble
from gproof.frontend.mcuwin.pascal import Place, Symbols, parse_section
from gproof.frontend.mcuwin.pascal_text import mode_sign
from gproof.frontend.mcuwin.persistence import Persistence
from gproof.frontend.mcuwin.structure import Structure
from gproof.frontend.source import UTF8_MARK, decode, read_source
from gproof.ir import codes
from gproof.ir.dialects import rules_named
from gproof.ir.din import NO_DIN
from gproof.ir.finding import Findings, Refusal, Span
from gproof.ir.machine import Machine
from gproof.ir.program import Include, Mode, Program, SourceFile, Statement, Subprogram, Unsupported

DECLARES = re.compile(r"[ \t]*(?:var|const|label|procedure|function)(?![A-Za-z0-9_])", re.IGNORECASE)
DINEND = re.compile(r"\$DINEND(?![A-Za-z0-9_])", re.IGNORECASE)
PERCENT = re.compile(r"[ \t]*%")


def load_program(
    path: Path, findings: Findings, machine: Machine = NO_MCUWIN, machine_file: Path | None = None
) -> Program | None:  # fmt: skip
    """The program in ``path`` with all it includes; None when the job's file is refused.

    machine: whose axes and settings say how lines are read; machine_file: beside which PreInclude and PostInclude lie.
    A line with a mistake is a finding and left out of the program.
    """
    loader = _Loader(path, findings, machine, machine_file)
    before = sum(findings.counts.values())
    try:
        program = loader.program_of(path)
    except Refusal as refusal:
        findings.add(refusal.finding)
        return None
    if sum(findings.counts.values()) == before and not program.body:
        findings.add(codes.EMPTY_PROGRAM.at(Span(str(path), 0)))
    return program


class _Loader:
    """Reads the files of one program in the order of the source."""

    def __init__(self, path: Path, findings: Findings, machine: Machine, machine_file: Path | None) -> None:
        din = machine.controller.din or NO_DIN
        self.findings = findings
        self.din = din
        self.machine_file = machine_file
        self.path = path
        self.program = Program(dialect="mcuwin", rules=rules_named("mcuwin"))
        axes = "".join(axis.word for axis in machine.axes)
        self.symbols = Symbols(
            findings, axes=axes, case_sensitive=din.case_sensitive, angle_unit=din.angle_unit
        )  # fmt: skip
        self.persistence = Persistence(din)
        language = Language(rules=self.program.rules, din=din, axes=axes, expressions=Expressions(self.symbols))
        self.language = language
        self.reader = LineReader(language, self.persistence)
        self.structure = Structure(self.symbols, self.persistence, findings, Span(str(path), 1))
        self.procedures: list[Subprogram] = []
        self.sources: dict[Path, SourceFile] = {}
        self.stack: list[Path] = []
        self.pascal = False
        self.implied = False
        self.lines: list[str] = []
        self.first: tuple[str, int] = ("", 0)
        self.opened = False

    def program_of(self, path: Path) -> Program:
        """Everything, put together."""
        program = self.program
        source = read_source(path)
        self._take_in(path, source)
        program.line_count = source.line_count
        job = Span(str(path), 0)
        if self.din.pre_include:
            self._include(self.din.pre_include, job, self._machine_folders())
        self._file(path, source)
        if self.din.post_include:
            self._include(self.din.post_include, job, self._machine_folders())
        self._end_section()
        self.structure.finish()
        made = assemble(self.structure.sections, str(path), self.findings, old=self.language.old)
        program.body = made.body
        program.subprograms = dict(made.subprograms)
        for sub in self.procedures:
            if sub.name in program.subprograms:
                self.findings.add(codes.DUPLICATE_SUBPROGRAM.at(sub.span, name=sub.name))
            program.subprograms[sub.name] = sub
        return program

    def _machine_folders(self) -> list[Path]:
        folders = [self.machine_file.parent] if self.machine_file is not None else []
        return [*folders, self.path.parent]

    def _take_in(self, path: Path, source: SourceFile) -> None:
        """Note a file among those of the program."""
        data = source.data
        begin = len(UTF8_MARK) if data[:3] == UTF8_MARK else 0
        source.mark = begin > 0
        first_end = data.find(b"\n")
        source.newline = "\r\n" if first_end > 0 and data[first_end - 1 : first_end] == b"\r" else "\n"
        source.line_count = bytes(data).count(b"\n") + (0 if not data or data[len(data) - 1 :] == b"\n" else 1)
        self.program.files.append(source)
        self.sources[path.resolve()] = source

    def _file(self, path: Path, source: SourceFile) -> None:
        """The lines of a file, in their place."""
        self.stack.append(path.resolve())
        depth = len(self.structure.open)
        data = bytes(source.data)
        begin = len(UTF8_MARK) if source.mark else 0
        lines = data[begin:].split(b"\n")
        if lines and not lines[-1]:
            lines.pop()
        for number, raw in enumerate(lines, 1):
            text = decode(raw.removesuffix(b"\r"))
            try:
                self._line(text, source.name, number, path)
            except Refusal as refusal:
                self.findings.add(refusal.finding)
                self.persistence.cut()
        self.structure.finish(depth)
        self.stack.pop()

    def _line(self, text: str, file: str, number: int, path: Path) -> None:
        if "\r" in text:
            at = text.index("\r")
            what = "a carriage return without a line feed within the line"
            raise Refusal(codes.SYNTAX.at(Span(file, number, at + 1, at + 2), what=what))
        if not self.pascal and self._may_declare() and DECLARES.match(text):
            self._begin_section(implied=True)
        if self.pascal:
            self._pascal_line(text, file, number, path)
        else:
            self._din(text, file, number, path)

    def _may_declare(self) -> bool:
        """Before the first percent sign, outside of blocks."""
        return len(self.structure.sections) == 1 and not self.structure.open

    def _begin_section(self, *, implied: bool) -> None:
        self.pascal, self.implied, self.lines, self.opened = True, implied, [], False

    def _pascal_line(self, text: str, file: str, number: int, path: Path) -> None:
        if self.lines and file != self.first[0]:
            self._flush_section()
        if not self.lines:
            self.first = (file, number)
        if not self.opened and PERCENT.match(text):
            if not self.implied:
                at = text.index("%")
                what = "a percent sign within rw_SymPas: {$DINSTART} is missing before it"
                self.findings.add(codes.SYNTAX.at(Span(file, number, at + 1, at + 2), what=what))
            self._end_section()
            self._din(text, file, number, path)
            return
        found, self.opened = mode_sign(text, self.opened)
        if found is None:
            self.lines.append(text)
            return
        begin, end = found
        self.lines.append(text[:begin])
        self._end_section()
        self._start(Span(file, number, begin + 1, end + 1))
        self._din(text, file, number, path, end)

    def _start(self, span: Span) -> None:
        self.structure.add([Mode(name="din", span=span)])
        self.persistence.mode()

    def _flush_section(self) -> None:
        """Read the lines of a section that were collected."""
        if self.lines:
            file, line = self.first
            section = parse_section(self.lines, Place(file, line), self.symbols)
            self.structure.add(section.statements)
            self.procedures += section.subprograms
        self.lines = []

    def _end_section(self) -> None:
        if self.pascal:
            self._flush_section()
        self.pascal = False

    def _din(self, text: str, file: str, number: int, path: Path, at: int = 0) -> None:
        line = self.reader.read(text, file, number, at)
        if self.din.line_numbers and not line.number and line.asks_number:
            self.findings.add(codes.LINE_NUMBER_MISSING.at(Span(file, number, 1, 2)))
        if line.module is not None and line.module_span is not None:
            self.structure.module(line.module, line.module_span)
        elif line.starts is not None:
            begin, end = line.starts
            self._start(Span(file, number, begin + 1, end + 1))
            self._din(text, file, number, path, end)
        elif line.pascal >= 0:
            self._dollar(text, line, file, number, path)
        self.structure.add(line.statements)

    def _dollar(self, text: str, line: DinLine, file: str, number: int, path: Path) -> None:
        at = line.pascal
        end = DINEND.match(text, at)
        include = INCLUDE.match(text, at)
        if end is not None:
            self.structure.add([Mode(name="pascal", span=Span(file, number, at + 1, end.end() + 1))])
            self.persistence.mode()
            self._begin_section(implied=False)
            self._pascal_line(" " * end.end() + text[end.end() :], file, number, path)
        elif include is not None:
            name = include["name"]
            span = Span(file, number, at + 1, include.end() + 1)
            rest = self.reader.read(text, file, number, include.end())
            if not name or rest.says:
                what = (
                    "$I needs the name of a file" if not name else "a file name without blanks stands alone behind $I"
                )
                raise Refusal(codes.SYNTAX.at(Span(file, number, at + 1, len(text.rstrip()) + 1), what=what))
            self.structure.add([Include(name=name, span=span)])
            self._include(name, span, self._folders(path))
            self.persistence.doubt()
        else:
            self.structure.pascal(text, at + 1, file, number)

    def _folders(self, path: Path) -> list[Path]:
        """Where a name is looked for (14, 2.5.3.52): beside the source, before that in the folder of McuWIN."""
        if self.language.old and self.machine_file is not None:
            return [self.machine_file.parent]
        return list(dict.fromkeys((path.parent, self.path.parent)))

    def _include(self, name: str, span: Span, folders: Sequence[Path]) -> None:
        """Read a file in its place; findings for one that is not there or includes itself."""
        found = find(name, folders)
        if not found:
            where = f" in {' or '.join(str(folder) for folder in folders)}"
            self.findings.add(codes.FILE_NOT_FOUND.at(span, name=name, where=where))
            return
        path = found[0]
        if path.resolve() in self.stack or len(self.stack) >= DEEPEST:
            chain = " -> ".join(p.name for p in (*self.stack, path))
            self.findings.add(codes.INCLUDE_CYCLE.at(span, name=name, chain=chain))
            return
        doubt: list[Statement] = []
        if len(found) > 1 and differ(found):
            doubt.append(Unsupported(what=f"which {name} is meant, {found[0]} or {found[1]}, which differ,", span=span))
        elif self.language.old and self.machine_file is None:
            doubt.append(Unsupported(what=f"which {name} this version reads, from the folder of McuWIN,", span=span))
        self.structure.add(doubt)
        source = self.sources.get(path.resolve())
        if source is None:
            try:
                source = read_source(path)
            except Refusal as refusal:
                self.findings.add(refusal.finding)
                return
            self._take_in(path, source)
        self._file(path, source)
