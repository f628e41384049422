"""A McuWIN job with its includes, from bytes to a Program.

One pass over each file finds the lines that are not plain; those are read one by one, everything between becomes block
tables. The text goes over between DIN lines and sections of rw_SymPas (manual 10, 12); files that it includes are read
in their place, with what is in force there.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from gproof.frontend.common.source import UTF8_MARK, decode, encoding_of, read_source
from gproof.frontend.mcuwin.include import DEEPEST, MOST, differ, find
from gproof.frontend.mcuwin.machine import NO_MCUWIN
from gproof.frontend.mcuwin.modules import assemble
from gproof.frontend.mcuwin.notes import Annotator, FileNotes
from gproof.frontend.mcuwin.scan import Scanner
from gproof.frontend.mcuwin.size import judge_size
from gproof.frontend.mcuwin.structure import does_something
from gproof.frontend.mcuwin.text import HELD_BLOCKS, Text
from gproof.ir import codes
from gproof.ir.columns import Columns
from gproof.ir.dialects import rules_named
from gproof.ir.dialects.mcuwin.settings import mcuwin_settings
from gproof.ir.finding import Finding, Findings, Refusal, Span
from gproof.ir.machine import Machine
from gproof.ir.program import BlockTable, Mistake, Program, SourceFile, Statement, Unsupported

HELD_LINES = 2000
HELD_IN_ALL = 200_000
"""A table of at most so many lines holds its words, until the tables of a program hold that many."""
CHUNK = 1 << 16


def load_program(
    path: Path, findings: Findings, machine: Machine = NO_MCUWIN, machine_file: Path | None = None, *,
    tables: bool = True, held: int | None = HELD_BLOCKS,
) -> Program | None:  # fmt: skip
    """The program in ``path`` with all it includes; None when the job's file is refused.

    machine: whose axes and settings say how lines are read; machine_file: PreInclude and PostInclude are next to
    it; tables: plain lines become tables, otherwise blocks like all others; held: see ``text.Text``. A line with
    a mistake is a finding and left out of the program.
    """
    loader = _Loader(path, findings, machine, machine_file, tables=tables, held=held)
    before = sum(findings.counts.values())
    try:
        program = loader.job()
    except Refusal as refusal:
        findings.add(refusal.finding)
        return None
    if sum(findings.counts.values()) == before and not any(does_something(node) for node in program.body):
        findings.add(codes.EMPTY_PROGRAM.at(Span(str(path), 1)))
    return program


def load_alone(
    path: Path, findings: Findings, name: str = "", *, machine: Machine = NO_MCUWIN, machine_file: Path | None = None,
    folder: Path | None = None, within: Path | None = None,
) -> Program | None:  # fmt: skip
    """One file as a program to be printed again; None when it is refused.

    Its body has the statements of all its modules as they are, its subprograms are the declared procedures: labels,
    calls and ends of modules are not judged, and jumps may have no target. Files that it includes give only the names
    that they declare, and missing ones are no mistakes. name: of the file in findings, when it is not
    ``path``; folder: where its includes are, when that is not its own; within: a job that includes it, of which the
    names count that it declares before that.
    """
    loader = _Loader(
        path, findings, machine, machine_file, tables=True, alone=True, name=name, folder=folder, within=within
    )
    try:
        return loader.file_alone()
    except Refusal as refusal:
        findings.add(refusal.finding)
        return None


class _ReachedError(Exception):
    """The place of the file that is read within a job."""


class _Loader:
    """Reads the files of one program in the order of the source. alone: see ``load_alone``."""

    def __init__(
        self, path: Path, findings: Findings, machine: Machine, machine_file: Path | None, *, tables: bool,
        held: int | None = HELD_BLOCKS, alone: bool = False, name: str = "", folder: Path | None = None,
        within: Path | None = None,
    ) -> None:  # fmt: skip
        self.path = path
        self.alone = alone
        self.name = name or str(path)
        self.folder = folder or path.parent
        self.itself = (self.folder / Path(self.name).name).resolve()
        self.within = within
        self.awaited = False
        self.findings = findings
        self.machine_file = machine_file
        self.din = mcuwin_settings(machine)
        self.tables = tables
        axes = "".join(axis.word for axis in machine.axes)
        self.program = Program(dialect="mcuwin", rules=rules_named("mcuwin"))
        self.scanner = Scanner(axes, small=not self.din.case_sensitive, numbered=self.din.line_numbers)
        self.annotator = Annotator()
        self.program.scan = self.scanner.scan
        self.program.annotate = self.annotator.annotate
        first = Span(self.name, 1)
        self.text = Text(self.program.rules, self.din, axes, findings, self._include_from, first, held=held)
        self.files: dict[Path, int] = {}
        self.stack: list[Path] = []
        self.held = 0
        self.included = 0

    def job(self) -> Program:
        """Everything, put together."""
        program = self.program
        self._read_all()
        made = assemble(
            self.text.structure.sections, self.text.procedures, self.name, self.findings, old=self.text.old
        )  # fmt: skip
        program.body, program.subprograms, program.unended = made.body, made.subprograms, made.unended
        size = judge_size(
            program, self.text.structure.sections, self.text.procedures, self.din.program_size, self.text.deferred
        )
        if size is not None:
            self.findings.add(size)
        return program

    def file_alone(self) -> Program:
        """The job's file as it is."""
        self._read_all()
        program, text = self.program, self.text
        del program.files[1:]
        program.body = tuple(node for section in text.structure.sections for node in section.body)
        program.subprograms = {procedure.name: procedure for procedure in text.procedures}
        return program

    def _read_all(self) -> None:
        """The text of the job, and of what the machine's settings put before and after it."""
        program = self.program
        number = self._take_in(self.path)
        program.files[number].name = self.name
        whole = Span(self.name, 1)
        if self.din.pre_include:
            self._include(self.din.pre_include, whole, self._machine_folders())
        if self.within is not None:
            self._names_before(self.within)
        self._file(self.path, number)
        program.line_count = program.files[number].line_count
        if self.din.post_include:
            self._include(self.din.post_include, whole, self._machine_folders())
        self.text.finish()

    def _names_before(self, job: Path) -> None:
        """Read a job up to the place where it includes this file, for the names that it declares."""
        folder, self.folder, self.awaited = self.folder, job.parent, True
        try:
            with self.text.aside():
                self._read(job)
        except _ReachedError:
            self.text.pascal = False
        self.folder, self.awaited = folder, False
        self.stack.clear()

    def _machine_folders(self) -> list[Path]:
        folders = [self.machine_file.parent] if self.machine_file is not None else []
        return list(dict.fromkeys((*folders, self.folder)))

    def _take_in(self, path: Path) -> int:
        """Read a file and note it among those of the program; its number there. Refusal when it is none."""
        key = path.resolve()
        if key in self.files:
            return self.files[key]
        source = read_source(path, dos=True)
        source.mark = source.data[:3] == UTF8_MARK
        first_end = source.data.find(b"\n")
        source.newline = "\r\n" if first_end > 0 and source.data[first_end - 1 : first_end] == b"\r" else "\n"
        self.files[key] = len(self.program.files)
        self.program.files.append(source)
        self.annotator.files.append(FileNotes(source.data))
        return self.files[key]

    def _file(self, path: Path, number: int) -> None:
        """The lines of a file, in their place."""
        self.stack.append(path.resolve())
        depth = len(self.text.structure.open)
        walk = _Walk(self, path, number)
        walk.run()
        self.text.leave_file(depth)
        self.stack.pop()

    def _include_from(self, name: str, span: Span) -> None:
        """``$I`` in a file: next to it, or next to the job (14, 2.5.3.52); the older version looked next to McuWIN."""
        if self.text.old and self.machine_file is not None:
            folders = [self.machine_file.parent]
        else:
            own = self.stack[-1].parent if len(self.stack) > 1 else self.folder
            around = [self.within.parent] if self.within is not None else []
            folders = list(dict.fromkeys((own, self.folder, *around)))
        self._include(name, span, folders)

    def _include(self, name: str, span: Span, folders: Sequence[Path]) -> None:
        """Read a file in its place; findings for one that is not there or includes itself."""
        found = find(name, folders)
        self.included += 1
        if self.alone and self.included > MOST:
            return
        if self.alone:
            if self.awaited and found and found[0].resolve() == self.itself:
                raise _ReachedError
            if found and len(self.stack) < DEEPEST and found[0].resolve() not in (self.itself, *self.stack):
                with self.text.aside():
                    self._read(found[0])
            return
        if not found:
            where = f" in {' or '.join(str(folder) for folder in folders)}"
            self._left_out(codes.FILE_NOT_FOUND.at(span, name=name, where=where))
            return
        path = found[0]
        if path.resolve() in self.stack or len(self.stack) >= DEEPEST:
            chain = [p.name for p in (*self.stack, path)]
            what = "includes itself"
            if path.resolve() not in self.stack:
                what = f"would be include number {len(chain) - 1} inside another; gproof reads {DEEPEST - 1}"
                chain = [*chain[:3], "...", *chain[-2:]]
            self._left_out(codes.INCLUDE_CYCLE.at(span, name=name, what=what, chain=" -> ".join(chain)))
            return
        if self.included > MOST:
            what = f"a job with more than {MOST} inclusions"
            self.text.structure.add([Unsupported(what=what, span=span)])
            return
        what = ""
        if len(found) > 1 and differ(found):
            what = f"{name}, which is {found[0]} or {found[1]} (they differ),"
        elif self.text.old and self.machine_file is None:
            what = f"{name}, which may also be in the folder of McuWIN,"
        if what:
            self.text.structure.add([Unsupported(what=what, span=span)])
        self._read(path)

    def _left_out(self, finding: Finding) -> None:
        """An include that is not read: its lines may have changed anything."""
        self.findings.add(finding)
        what, hint = finding.message, finding.hint
        node = Mistake(code=finding.code.number, message=what, span=finding.span, text="", hint=hint, told=True)
        # The end that its module lacks may be in the file.
        self.text.structure.section.broken = True
        self.text.structure.add([node])

    def _read(self, path: Path) -> None:
        try:
            number = self._take_in(path)
        except Refusal as refusal:
            self.text.findings.add(refusal.finding)
            return
        self._file(path, number)


class _Walk:
    """The lines of one file in order: tables of plain ones, and every other by itself."""

    def __init__(self, loader: _Loader, path: Path, number: int) -> None:
        self.loader = loader
        self.text = loader.text
        self.path = path
        self.number = number
        self.source: SourceFile = loader.program.files[number]
        self.data = self.source.data
        self.notes = loader.annotator.files[number]
        self.fresh = not self.source.line_count
        self.byte = len(UTF8_MARK) if self.source.mark else 0
        self.line = 1

    def run(self) -> None:
        """Read all of it."""
        found = self.loader.scanner.index(self.data, self.byte)
        self.source.line_count = found.line_count
        for number, begin, end, has_words in found.rows():
            self._before(number, begin, bool(has_words))
            self._single(end)
        self._before(found.line_count + 1, len(self.data), found.words_after)

    def _before(self, number: int, begin: int, has_words: bool) -> None:
        """The plain lines up to byte ``begin``, which starts line ``number``."""
        while self.byte < begin and (self.text.pascal or self.text.doubtful or not self.loader.tables):
            at = self.data.find(b"\n", self.byte)
            self._single(begin if at < 0 else at + 1)
        if self.byte >= begin:
            return
        if self.fresh:
            self.notes.plain.append((self.byte, begin, self.line))
        if has_words:
            self._table(number - 1, begin)
        self.byte, self.line = begin, number

    def _single(self, end: int) -> None:
        raw = self.data[self.byte : end].rstrip(b"\n").removesuffix(b"\r")
        text, line = decode(raw), self.line
        self.byte, self.line = end, line + 1
        for number, written, found in self.text.line(text, self.source.name, line):
            if self.fresh:
                self.notes.add(number, written, encoding_of(raw), found)

    def _table(self, last: int, end: int) -> None:
        first, begin = self.line, self.byte
        words: Columns | None = None
        if last - first < HELD_LINES and self.loader.held + last - first < HELD_IN_ALL:
            self.loader.held += last - first + 1
            words, _, _ = self.loader.scanner.scan(self.data, begin, end, first, end - begin)
        if words is not None and not len(words):
            return
        persistence = self.text.persistence
        table: Statement = BlockTable(
            file=self.number, first_line=first, last_line=last, begin=begin, end=end, words=words,
            continued=persistence.state, distances=persistence.distances_of(()),
        )  # fmt: skip
        self.text.structure.add([table])
        motion = _last_motion(words) if words is not None else self._search_motion(begin, end)
        if motion is not None:
            self.text.persistence.code("G", motion)

    def _search_motion(self, begin: int, end: int) -> int | None:
        """The last code of plain lines whose words are not held, looked for from their end."""
        size, stop = CHUNK, end
        while stop > begin:
            at = max(begin, stop - size)
            if at > begin:
                at = self.data.find(b"\n", at, stop) + 1 or begin
            words, _, _ = self.loader.scanner.scan(self.data, at, stop, 1, stop - at)
            motion = _last_motion(words)
            if motion is not None:
                return motion
            if at == begin or at >= stop:
                break
            stop, size = at, size * 2
        return None


def _last_motion(words: Columns) -> int | None:
    """The number of the last G code among words."""
    rows = (words["letter"] == ord("G")).nonzero()[0]
    return int(words["value"][rows[-1]]) if len(rows) else None
