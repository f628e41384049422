"""An Eding job and the macro file next to it, from bytes to a Program.

One pass finds the lines that are not plain (``scan.index``); those go through the grammar, everything
between becomes block tables whose words are scanned when they run, so that a job of any length costs memory
only for its lines with expressions and flow control.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator
from pathlib import Path

from gproof.frontend.common.lines import LineIndex
from gproof.frontend.common.source import UTF8_MARK, decode, read_source
from gproof.frontend.eding.build import STRUCTURAL, Parsed, Structural
from gproof.frontend.eding.line_cache import Reader
from gproof.frontend.eding.notes import annotate
from gproof.frontend.eding.prepare import LineError, structure_of
from gproof.frontend.eding.scan import index, scan
from gproof.frontend.eding.structure import JOB, MACROS, OWN_MACROS, Assembler
from gproof.ir import codes
from gproof.ir.columns import Columns
from gproof.ir.dialects import accepts as known
from gproof.ir.dialects import rules_named
from gproof.ir.dialects.accepts import Accepted
from gproof.ir.finding import Finding, Findings, Refusal, Span
from gproof.ir.program import (
    Block,
    BlockTable,
    Call,
    DeferredBlock,
    If,
    Message,
    Mistake,
    Number,
    Program,
    SourceFile,
    Statement,
    Unsupported,
    While,
    Word,
)
from gproof.ir.rules import LanguageRules

MACRO_FILE = "macro.cnc"
"""Loaded with every job from the job's folder (manual 4.3)."""
USER_MACRO_FILE = "user_macro.cnc"
"""Loaded with it, where the shop says so (``accepts``)."""

HELD_LINES = 2000
HELD_IN_ALL = 200_000
"""A table of at most so many lines holds its words, until the tables of a program hold that many."""


def load_program(
    path: Path, findings: Findings, macro: Path | None = None, *, call: str = "", accepts: Collection[str] = ()
) -> Program | None:
    """The program in ``path``, with the subprograms of its macro file; None when a file is refused.

    macro: the macro file, instead of ``macro.cnc`` in the folder of ``path``. Mistakes go into ``findings``
    (GP101–GP124), one for each line; a line with a mistake is left out of the program. Where the job never runs such a
    line of the macro file, the finding is GP126.
    call: a subprogram that is run in place of the job's own lines: what it never runs is GP126 in the job too.
    accepts: what the controller takes beyond its manual (``ir/dialects/accepts.py``).
    """
    program = Program(dialect="eding", rules=rules_named("eding"), scan=scan, annotate=annotate)
    loader = _Loader(program, findings, call=call.lower(), accepts=accepts)
    before = sum(findings.counts.values())
    try:
        is_macros = path.name.lower() == MACRO_FILE
        program.body = loader.load(path, place=MACROS if is_macros else JOB)
        own = own_macros(path, macro)
        if own is not None and loader.takes(known.USER_MACRO_FILE):
            loader.load(own, place=OWN_MACROS)
        beside = macro_beside(path, macro)
        if beside is not None:
            loader.load(beside, place=MACROS)
    except Refusal as refusal:
        findings.add(refusal.finding)
        return None
    program.subprograms = loader.assembler.subprograms
    program.overrides = overrides_of(program.subprograms, program.rules)
    loader.settle()
    program.assumed += loader.assumed
    is_clean = sum(findings.counts.values()) == before
    if is_clean and not program.body and not loader.subprograms_in_job:
        findings.add(codes.EMPTY_PROGRAM.at(Span(str(path), 1)))
    return program


def macro_beside(path: Path, macro: Path | None = None) -> Path | None:
    """The macro file that is loaded with a job: the one that is named, else ``macro.cnc`` in its folder, if any."""
    beside = macro if macro is not None else path.with_name(MACRO_FILE)
    if macro is None and (not beside.is_file() or path.name.lower() == MACRO_FILE):
        return None
    return beside


def own_macros(path: Path, macro: Path | None = None) -> Path | None:
    """``user_macro.cnc`` next to the macro file of a job, which some controllers load too; None where there is none."""
    own = (macro or path).with_name(USER_MACRO_FILE)
    return own if own.is_file() and own.resolve() != path.resolve() else None


def load_alone(path: Path, findings: Findings, name: str = "") -> Program | None:
    """One file as a program, without a macro file, to be printed again; None when it is refused.

    Calls of subprograms that are in other files are no mistakes here, nor is a file without a program.
    name: of the file in findings, when it is not ``path``.
    """
    program = Program(dialect="eding", rules=rules_named("eding"), scan=scan, annotate=annotate)
    loader = _Loader(program, findings)
    try:
        program.body = loader.load(path, name)
    except Refusal as refusal:
        findings.add(refusal.finding)
        return None
    for finding, _ in loader.waiting:
        findings.add(finding)
    program.subprograms = loader.assembler.subprograms
    program.overrides = overrides_of(program.subprograms, program.rules)
    return program


def _is_name(name: str) -> bool:
    """Whether a name is one of the manual, or may be one with a digit first."""
    return bool(_PLAIN_NAME.fullmatch(name) or _DIGIT_NAME.fullmatch(name))


_NAMED_PARAMETER = re.compile(rb"#<[A-Za-z_][A-Za-z0-9_]*>")
_PLAIN_NAME = re.compile(r"[a-z_][a-z0-9_]*")
_DIGIT_NAME = re.compile(r"[0-9][a-z0-9_]*")
_M_NAME = re.compile(r"m(\d{1,3})")
CHANGE_TOOL = "change_tool"


def overrides_of(names: Iterable[str], rules: LanguageRules) -> dict[tuple[str, int], str]:
    """Codes that subprograms of these names replace: ``m3``, ``m100`` ... (4.4), ``change_tool`` for M6 (3.5.3)."""
    found = {("M", 10 * int(m[1])): m[0] for name in sorted(names) if (m := _M_NAME.fullmatch(name))}
    found = {code: name for code, name in found.items() if name == f"m{code[1] // 10}"}
    if CHANGE_TOOL in names:
        found.setdefault(("M", 60), CHANGE_TOOL)
    return found


def reachable(program: Program, call: str = "") -> set[str]:
    """Names of the subprograms that a job may run: those that it calls, and those that replace its codes (4.4).

    call: the subprogram that is run in place of the job's own lines.
    """
    found: set[str] = set()
    names = [call] if call else [*_called(program, program.body)]
    while names:
        name = names.pop()
        if name not in found and name in program.subprograms:
            found.add(name)
            names += _called(program, program.subprograms[name].body)
    return found


def _called(program: Program, body: Iterable[Statement]) -> Iterator[str]:
    """Names of the calls in statements and in the blocks inside them, and of what replaces their codes."""
    overrides = {tenths: name for (letter, tenths), name in program.overrides.items() if letter == "M"}
    for node in body:
        if isinstance(node, Call):
            yield node.name
        elif isinstance(node, If):
            yield from _called(program, node.then)
            yield from _called(program, node.otherwise)
        elif isinstance(node, While):
            yield from _called(program, node.body)
        elif overrides and isinstance(node, Block):
            if not isinstance(node, DeferredBlock) or node.has_letter("M"):
                yield from _replacing(overrides, node.words)
        elif overrides and isinstance(node, BlockTable):
            if node.words is None:
                yield from overrides.values()  # its words are not held: any code may be there
                continue
            values = node.words["value"][node.words["letter"] == ord("M")]
            yield from (name for value in set(values.tolist()) if (name := overrides.get(round(value * 10))))


def _replacing(overrides: dict[int, str], words: Iterable[Word]) -> Iterator[str]:
    """Names of the subprograms that may replace an M of these words."""
    for word in words:
        if word.letter == "M" and isinstance(word.value, Number):
            name = overrides.get(round(word.value.value * 10))
            yield from [name] if name else []
        elif word.letter == "M":
            yield from overrides.values()


def _unreached(finding: Finding, inside: str) -> Finding:
    where = f"in subprogram {inside!r}" if inside else "outside of subprograms"
    return codes.UNREACHED_MISTAKE.at(
        finding.span, message=finding.message, label=finding.code.label, where=where, related=finding.related
    )


class _Loader:
    """Loads the files of one program one after another.

    call: the subprogram that is run in place of the job; accepts: see ``load_program``.
    """

    def __init__(
        self, program: Program, findings: Findings, *, call: str = "", accepts: Collection[str] = ()
    ) -> None:  # fmt: skip
        self.program = program
        self.findings = findings
        self.call = call
        self.accepts = accepts
        self.assumed: list[str] = []
        self.assembler = Assembler(self.mistake, self.twice)
        self.reader = Reader()
        self.held = 0
        self.subprograms_in_job = 0
        self.waiting: list[tuple[Finding, str]] = []
        """Mistakes that count where the job runs their line, and the subprogram of each."""
        self.beyond: list[tuple[Accepted, str]] = []
        """What was met of what the controller takes beyond its manual, and the subprogram of each."""

    def load(self, path: Path, name: str = "", *, place: int = JOB) -> tuple[Statement, ...]:
        """Read a file; its statements outside subprograms. place: what it is (``structure.py``)."""
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
        self.assembler.begin_file(source.name, place)
        self._lines(number, source, begin, found)
        body = self.assembler.end_file()
        if number == 0:
            self.subprograms_in_job = len(self.assembler.subprograms)
        return body

    def takes(self, what: Accepted) -> bool:
        """Whether the controller takes this beyond its manual; an assumption where the job needs it."""
        if what.name in self.accepts:
            self.beyond.append((what, self.assembler.subprogram))
            return True
        return False

    def mistake(self, finding: Finding, inside: str = "", *, sure: bool = False) -> None:
        """A mistake in a subprogram, "" outside of all. sure: it counts, whether the job runs its line or not."""
        if not sure and (len(self.program.files) > 1 or self.call):
            self.waiting.append((finding, inside))
        else:
            self.findings.add(finding)

    def twice(self, finding: Finding, name: str) -> None:
        """Two subprograms of one name: a mistake where something calls it."""
        self.waiting.append((finding, name))

    def settle(self) -> None:
        """Findings that need every subprogram: missing ones, and mistakes that the job may never meet."""
        if not self.waiting and not self.assembler.calls and not self.beyond:
            return
        reached = reachable(self.program, self.call)
        reached |= set() if self.call else {""}
        job = self.program.files[0].name
        for call, inside in self.assembler.calls:
            if call.name not in self.program.subprograms and _is_name(call.name):
                finding = codes.UNKNOWN_SUBPROGRAM.at(call.span, name=call.name)
                if call.span.file == job and not self.call:
                    self.findings.add(finding)
                else:
                    self.waiting.append((finding, inside))
        of_macro = {file.name for file in self.program.files[1:]}
        for finding, inside in self.waiting:
            runs = inside in reached and (inside or finding.span.file not in of_macro)
            self.findings.add(finding if runs else _unreached(finding, inside))
        needed = (what.assumption for what, inside in self.beyond if inside in reached or not inside)
        self.assumed += dict.fromkeys(needed)

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
                self._beyond(statement)
                self.assembler.add(statement)
        except LineError as error:
            span = Span(source.name, number, error.begin + 1, error.end + 1)
            if _NAMED_PARAMETER.search(raw) and error.structure == "":
                what = "a parameter with a name, which is not in the manual,"
                self.assembler.add(Unsupported(what=what, span=span, text=decode(raw).strip()))
                return
            finding = error.code.at(span, **error.values)
            self.mistake(finding, self.assembler.subprogram, sure=error.structure in ("sub", "endsub"))
            line = Mistake(
                code=finding.code.number, message=finding.message, span=span, text=decode(raw).strip(),
                hint=finding.hint, told=True,
            )  # fmt: skip
            if error.structure not in STRUCTURAL:
                self.assembler.add(line)
                return
            opens = error.structure in ("if", "while")
            if opens:
                self.assembler.add(line)
            self.assembler.add(Structural(error.structure, span))
            if not opens and error.structure != "sub":
                self.assembler.add(line)

    def _beyond(self, statement: Parsed) -> None:
        """A finding for what only some controllers take, where no file says that this one does."""
        what: Accepted | None = None
        name = statement.name if isinstance(statement, Structural | Call) else ""
        if isinstance(statement, Structural | Call) and name and not _PLAIN_NAME.fullmatch(name):
            inside = name if isinstance(statement, Structural) else self.assembler.subprogram
            text = f"{name!r} does not follow the manual: a letter, then letters, digits and _"
            end = statement.span.end_column
            span = Span(statement.span.file, statement.span.line, end - len(name), end)
            what = known.DIGIT_NAMES if _DIGIT_NAME.fullmatch(name) else None
            finding = codes.UNDECODABLE_NAME.at(span, what=text, hint=what.hint if what else "")
            if what is None:
                self.mistake(finding, inside)
        elif isinstance(statement, Message) and statement.formats:
            what, inside = known.MESSAGE_FORMATS, self.assembler.subprogram
            text = f"{statement.formats[0]!r} is not expected here"
            finding = codes.SYNTAX.at(statement.span, what=text, hint=what.hint)
        if what is None:
            return
        if what.name in self.accepts:
            self.beyond.append((what, inside))
        else:
            self.mistake(finding, inside)
