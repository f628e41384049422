"""A WinCNC job with its subprogram files and macros, from bytes to a Program.

One pass over each file finds the lines that are not plain; those are read one by one, everything between becomes block
tables. Which file M98 calls is looked up next to the job, then next to the machine's file. Manual: M98, Macro File
Configuration, L10, M17.1 and its relatives, WINCNC.INI Settings: skipchars=, cmdstart=, cmdend=.
"""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gproof.frontend.common.source import UTF8_MARK, decode, newline_of, read_source
from gproof.frontend.wincnc.called_files import AnyFiles, CalledFiles
from gproof.frontend.wincnc.file_names import MACRO_FILE
from gproof.frontend.wincnc.line import LineError, LineReader, NumberedLine
from gproof.frontend.wincnc.mac_file import Macro
from gproof.frontend.wincnc.machine import NO_SHOP
from gproof.frontend.wincnc.notes import Annotator, skip_count
from gproof.frontend.wincnc.scan import Scanner, scanner
from gproof.frontend.wincnc.statements import ArrayLine, Head, Lines, Parsed, text_codes
from gproof.ir import codes
from gproof.ir.columns import Columns
from gproof.ir.dialects import rules_named
from gproof.ir.dialects.accepts import LINE_NUMBERS, TEXT_AFTER_COMMENT
from gproof.ir.dialects.wincnc.settings import WinCncSettings, wincnc_settings
from gproof.ir.finding import Finding, Findings, Refusal, Severity, Span
from gproof.ir.machine import Machine
from gproof.ir.notes import NO_NOTES
from gproof.ir.program import (
    NO_OUTPUTS,
    Array,
    Block,
    BlockTable,
    Call,
    If,
    Mistake,
    Number,
    Program,
    Replaced,
    SourceFile,
    SpindleOutputs,
    Statement,
    Subprogram,
    Unsupported,
)
from gproof.ir.record import record

if TYPE_CHECKING:
    from gproof.frontend.wincnc.spindle_outputs import SpindleReader

_FILE_NAME = re.compile(r"[^\s=]*[A-Za-z_][^\s=]*\.[A-Za-z]\w{0,3}")
"""What can be nothing but the name of a file: a command has no letters after a point."""
MOST_IN_A_ROW = 8
"""Lines that decide about the next line, one after the other: each doubles what may run, and nobody writes three."""
HELD_LINES = 2000
HELD_IN_ALL = 200_000
"""A table of at most so many lines holds its words, until the tables of a program hold that many."""


def load_program(
    path: Path, findings: Findings, machine: Machine, machine_file: Path | None = None, beside: Sequence[Path] = ()
) -> Program | None:  # fmt: skip
    """The program in ``path`` with all it calls; None when the job's file is refused.

    machine: whose settings say how lines are read; machine_file: CNC.MAC and subprograms may be next to it,
    or next to the files that it refines (``beside``). A line with a mistake is a finding and left out of the program.
    """
    rules = rules_named("wincnc")
    controls = wincnc_settings(machine)
    program = Program(dialect="wincnc", rules=rules)
    folders = [path.parent, *([machine_file.parent] if machine_file is not None else []), *(f.parent for f in beside)]
    folders = list(dict.fromkeys(folders))
    loader = _Loader(program, findings, controls, folders, machine_file)
    before = sum(findings.counts.values())
    try:
        program.body = loader.job(path)
    except Refusal as refusal:
        findings.add(refusal.finding)
        return None
    if loader.reader.has_continued:
        program.assumed.append(TEXT_AFTER_COMMENT.assumption)
    if loader.reader.has_numbers:
        program.assumed.append(LINE_NUMBERS.assumption)
    if sum(findings.counts.values()) == before and not program.body:
        findings.add(codes.EMPTY_PROGRAM.at(Span(str(path), 1)))
    return program


def load_alone(
    path: Path, findings: Findings, name: str = "", *, machine: Machine = NO_SHOP, folders: Sequence[Path] = (),
    macro_file: Path | None = None,
) -> Program | None:  # fmt: skip
    """One file as a program to be printed again; None when it is refused.

    The macros of CNC.MAC still decide what a line is; files that it calls are not loaded, and missing ones are no
    mistakes. name: of the file in findings, when it is not ``path``; folders: where CNC.MAC and files are looked for,
    the file's own when there are none; macro_file: the CNC.MAC itself.
    """
    program = Program(dialect="wincnc", rules=rules_named("wincnc"))
    folders = list(folders) or [path.parent]
    loader = _Loader(program, findings, wincnc_settings(machine), folders, None)
    loader.files = AnyFiles(folders)
    loader.macro_path = macro_file
    try:
        loader.prepare()
        program.body = loader.load(path, name, is_job=True)
    except Refusal as refusal:
        findings.add(refusal.finding)
        return None
    return program


def one_way_next_to(files: Sequence[Path], machine: Machine) -> frozenset[str]:
    """Directions (``cw``, ``ccw``) whose command in the CNC.MAC next to the files of a machine leaves an output on
    with which the other one turns the spindle."""
    folders = list(dict.fromkeys(path.parent for path in files))
    program = Program(dialect="wincnc", rules=rules_named("wincnc"))
    loader = _Loader(program, Findings(), wincnc_settings(machine), folders, None)
    try:
        loader.prepare()
    except Refusal:
        return frozenset()
    return loader.spindle_reader().one_way()


class _Loader:
    """Loads the files of one program one after another."""

    def __init__(
        self, program: Program, findings: Findings, controls: WinCncSettings, folders: list[Path],
        machine_file: Path | None,
    ) -> None:  # fmt: skip
        self.program = program
        self.findings = findings
        self.controls = controls
        self.files = CalledFiles(folders)
        self.machine_file = machine_file
        self.held = 0
        self.told_of_numbers = False
        self.reader = LineReader(controls.lexical, text_codes(program.rules))
        self.macros: dict[str, Macro] = {}
        self.macro_source: SourceFile | None = None
        self.macro_path: Path | None = None
        self.scanner = Scanner(controls.lexical)

    def prepare(self) -> None:
        """Read the macro file; then lines can be read."""
        self._macro_file()
        self.scanner = scanner(self.controls.lexical, self.macros)
        if self.program.open_codes:
            self.scanner = dataclasses.replace(self.scanner, open_names=True)
        self.program.scan = self.scanner.scan
        self.program.annotate = Annotator(self.scanner, self.reader, self.program.rules.line_length).annotate
        self.lines = Lines(
            self.reader, self.program.rules, self.macros, self.files, len(self.controls.changers),
            self.program.open_codes, self.program.open_codes if self.macro_source is None else "",
        )  # fmt: skip

    def job(self, path: Path) -> tuple[Statement, ...]:
        """The statements of the job, with everything it calls loaded."""
        self.prepare()
        body = own = self.load(path, is_job=True)
        if self.macro_source is not None:
            self._add_settings(self.macro_source)
        self.program.tail = self._command("end", self.controls.end)
        self.program.abort = self._command("abort", self.controls.abort)
        self.program.head = self._command("start", self.controls.start)
        body = (*self.program.head, *body, *self.program.tail)
        while self.files.wanted:
            key = self.files.wanted.pop()
            path = self.files.paths[key]
            span = Span(str(path), 1)
            try:
                inner = self.load(path, is_job=False)
            except Refusal as refusal:
                self.findings.add(refusal.finding)
                inner = (Unsupported(what=f"the subprogram {path.name}, which cannot be read,", span=span),)
            other = self.files.other_of(path)
            if other is not None:
                what = f"{path.name}, which is {path} or {other} (they differ),"
                inner = (Unsupported(what=what, span=Span(str(path), 1)), *inner)
            self.program.subprograms[key] = Subprogram(name=key, body=inner, span=Span(str(path), 1), is_file=True)
        around = self.controls.around_files
        if around is None and self._only_switches((*self.program.head, *self.program.tail), frozenset()):
            around = False
        self.program.around_files = around
        self.program.spindle_outputs = self._spindle_outputs()
        self.program.macro_files = self._macro_files(own)
        return body

    def _spindle_outputs(self) -> SpindleOutputs:
        """What CNC.MAC tells of the spindle; the files that tell it are among those of the program."""
        if "M5" not in self.macros and "M9" not in self.macros:
            return NO_OUTPUTS
        reader = self.spindle_reader()
        found = reader.outputs()
        known = {file.name for file in self.program.files}
        if found != NO_OUTPUTS:
            for source in {file.name: file for file in reader.read if file.name not in known}.values():
                self._add_settings(source)
        return found

    def spindle_reader(self) -> SpindleReader:
        """Reads what the macros and the files that they call switch."""
        from gproof.frontend.wincnc.spindle_outputs import SpindleReader

        files = CalledFiles(self.files.folders)
        lines = Lines(self.reader, self.program.rules, self.macros, files, len(self.controls.changers))
        return SpindleReader(lines, files.paths, lambda path: files.other_of(path) is None, self.controls)

    def _macro_files(self, job: Sequence[Statement]) -> frozenset[str]:
        """Names of the files that no line of the job calls, nor one that it calls: commands of the machine run them."""
        called: set[str] = set()
        new = set(_calls(job))
        while new:
            called |= new
            known = [self.program.subprograms[name].body for name in new if name in self.program.subprograms]
            new = {name for body in known for name in _calls(body)} - called
        subs = self.program.subprograms.values()
        return frozenset(sub.span.file for sub in subs if sub.is_file and sub.name not in called)

    def _only_switches(self, body: Sequence[Statement], calls: frozenset[str]) -> bool:
        """Whether statements do no more than switch outputs: it then is all the same how often they run.

        calls: files that are looked at already.
        """
        torch = None if self.controls.torch is None else self.controls.torch.output
        for node in body:
            if isinstance(node, Replaced):
                same = self._only_switches(node.body, calls)
            elif isinstance(node, Call) and not node.arguments and node.name in self.program.subprograms:
                inner = self.program.subprograms[node.name].body
                same = node.name not in calls and self._only_switches(inner, calls | {node.name})
            elif isinstance(node, BlockTable):
                words, _, _ = self.program.load(node, node.begin, node.first_line, node.end - node.begin)
                same = _switch(zip(words["letter"].tolist(), words["value"].tolist(), strict=True), torch)
            elif isinstance(node, Block):
                pairs = [(ord(w.letter), w.value.value if isinstance(w.value, Number) else None) for w in node.words]
                same = not node.texts and _switch(pairs, torch)
            else:
                same = isinstance(node, Mistake)  # does nothing, however often
            if not same:
                return False
        return True

    def _macro_file(self) -> None:
        """CNC.MAC, next to the machine's file or the job."""
        # The shop's own comes before one that is next to a job in another folder.
        for folder in [*self.files.folders[1:], self.files.folders[0]]:
            found = self.macro_path or CalledFiles([folder]).below(folder, [MACRO_FILE])
            if found is not None:
                from gproof.frontend.wincnc.mac_file import read_macros

                source = read_source(found, dos=True)
                self.macros, unread = read_macros(source, self.findings, self.controls.lexical)
                self.macro_source = source
                if unread:
                    self.program.open_codes = f"line {unread[0]} of CNC.MAC was not understood, and may define it"
                return
        self.program.open_codes = "give --machine WINCNC.INI, with CNC.MAC and its files next to it"
        if self.machine_file is not None:
            name = self.machine_file.name
            self.program.open_codes = f"put CNC.MAC and the files that it names next to {name}"
            self.findings.add(
                codes.MACRO_FILE_MISSING.at(Span(str(self.machine_file), 1), name="CNC.MAC", machine=name)
            )

    def _command(self, name: str, text: str) -> tuple[Statement, ...]:
        """What a setting runs before or after the job, at its place in the machine's file."""
        if not text.strip():
            return ()
        file = str(self.machine_file) if self.machine_file is not None else "(machine file)"
        place = self.controls.place(name) or Span(file, 1)
        self._settings_file(place.file)
        try:
            parsed = self.lines.parse(" " * (place.column - 1) + text, place.file, place.line)
        except LineError as error:
            if _FILE_NAME.fullmatch(text.strip()):
                if name != "start" and self.files.find(text) is not None:
                    # The last thing that runs: that the file does is judged, that nothing does is the part before it.
                    call = self.lines.parse(f"{' ' * (place.column - 1)}M98 {text.strip()}", place.file, place.line)
                    assert isinstance(call, Call)
                    return (dataclasses.replace(call, span=place),)
                what = f"cmd{name}={text.strip()}, which names a file instead of a command,"
                return (Unsupported(what=what, span=place),)
            finding = error.finding(place.file, place.line)
            message = f"cmd{name}={text}: {finding.message}"
            # A mistake of the jobs that come to it alone. Columns of the value are those of WINCNC.INI only: a place
            # in TOML has none.
            span = finding.span if place.column else place
            return (_mistake(dataclasses.replace(finding, message=message, span=span), text),)
        if parsed is None:
            return ()
        if isinstance(parsed, Head | ArrayLine):
            return (Unsupported(what=f"cmd{name}={text}", span=place),)
        return (parsed,)

    def _settings_file(self, name: str) -> None:
        """Have the machine's file among those of the program, once, so that rows of the trace can name it."""
        if self.machine_file is None or any(file.name == name for file in self.program.files):
            return
        self._add_settings(read_source(Path(name)))

    def _add_settings(self, source: SourceFile) -> None:
        """Have a file among those of the program that decides about it and holds none of its lines."""
        source.newline, source.mark, source.notes = newline_of(source.data), source.data[:3] == UTF8_MARK, NO_NOTES
        source.line_count = source.data.count(b"\n") + (source.data[-1:] not in (b"", b"\n"))
        self.program.files.append(source)

    def load(self, path: Path, name: str = "", *, is_job: bool) -> tuple[Statement, ...]:
        """The statements of one file; name: of the file in findings, when it is not ``path``."""
        source = read_source(path, dos=True)
        source.name = name or source.name
        number = len(self.program.files)
        self.program.files.append(source)
        begin = len(UTF8_MARK) if source.data[:3] == UTF8_MARK else 0
        found = self.scanner.index(source.data, begin, self.program.rules.line_length)
        source.mark = begin > 0
        source.line_count = found.line_count
        source.newline = newline_of(source.data)
        if is_job:
            self.program.line_count = found.line_count
        special = list(found.rows())
        walk = _Walk(self, number, source, begin, special, found.words_after, is_job)
        return tuple(walk.body())

    def held_words(self, data: bytes, begin: int, end: int, first: int, lines: int) -> Columns | None:
        """The words of a small table, None for one whose words are read when it runs."""
        if lines > HELD_LINES or self.held + lines > HELD_IN_ALL:
            return None
        self.held += lines
        words, _, _ = self.scanner.scan(data, begin, end, first, end - begin)
        return words


def _calls(body: Sequence[Statement]) -> Iterator[str]:
    """Names that lines call themselves; not what macros and settings of the machine make of a line."""
    for node in body:
        if isinstance(node, Call):
            yield node.name
        elif isinstance(node, If):
            yield from _calls((*node.then, *node.otherwise))
        elif isinstance(node, Array):
            yield from _calls(node.body)


class _Walk:
    """The lines of one file in order."""

    def __init__(
        self, loader: _Loader, file: int, source: SourceFile, begin: int, special: list[tuple[int, int, int, int]],
        words_after: bool, is_job: bool,
    ) -> None:  # fmt: skip
        self.loader = loader
        self.file = file
        self.source = source
        self.data = source.data
        self.special = special
        self.words_after = words_after
        self.is_job = is_job
        self.next_special = 0
        self.byte = begin
        self.line = 1
        self.skip_until = 0
        self.in_array = False

    def body(self) -> Iterator[Statement]:
        """All statements; arrays take what follows them."""
        array: ArrayLine | None = None
        inside: list[Statement] = []
        for parsed in self._statements():
            if not isinstance(parsed, ArrayLine):
                if array is None:
                    yield parsed
                else:
                    inside.append(parsed)
                continue
            if not self.is_job:
                finding = codes.ARRAY_IN_SUBPROGRAM.at(parsed.span, code="L10")
                self.loader.findings.add(finding)
                yield _mistake(finding, "", told=True)
                continue
            if array is not None:
                yield _array(array, inside)
                array, inside = None, []
            if parsed.words:
                array = parsed
            else:
                yield _array(parsed, [])
            self.in_array = array is not None
        if array is not None:
            yield _array(array, inside)

    def _statements(self) -> Iterator[Statement | ArrayLine]:
        while self.byte < len(self.data):
            if self.next_special < len(self.special):
                number, first, _, has_words = self.special[self.next_special]
            else:
                number, first, has_words = self.source.line_count + 1, len(self.data), int(self.words_after)
            if self.byte < first:
                if has_words:
                    yield self._table(number - 1, first)
                self.byte, self.line = first, number
                continue
            line, raw = self._take()
            parsed = self._parse(line, raw)
            if isinstance(parsed, Head):
                yield from self._conditional(parsed, line)
            elif parsed is not None:
                yield parsed

    def _table(self, last: int, end: int) -> BlockTable:
        first, begin = self.line, self.byte
        words = self.loader.held_words(self.data, begin, end, first, last - first + 1)
        return BlockTable(file=self.file, first_line=first, last_line=last, begin=begin, end=end, words=words)

    def _take(self) -> tuple[int, bytes]:
        """The line that starts here, whether it is plain or not."""
        at = self.data.find(b"\n", self.byte)
        end = len(self.data) if at < 0 else at + 1
        if self.next_special < len(self.special) and self.special[self.next_special][1] == self.byte:
            self.next_special += 1
        line, raw = self.line, bytes(self.data[self.byte : end])
        self.byte, self.line = end, self.line + 1
        return line, raw.removesuffix(b"\n").removesuffix(b"\r")

    def _parse(self, line: int, raw: bytes, *, later: bool = False) -> Parsed | None:
        """One line; a finding for a mistake; later: a statement for it, as the line may never run."""
        text = decode(raw)
        limit = self.loader.program.rules.line_length
        try:
            if len(text) > limit:
                raise LineError(codes.LINE_TOO_LONG, limit, len(text), length=len(text), allowed=limit)
            if "\r" in text:
                # Within a comment it would hide what may be a line of its own.
                at = text.index("\r")
                raise LineError(codes.SYNTAX, at, at + 1, what="a carriage return without a line feed in the line")
            skipped = self._skip(text, line)
            return skipped if skipped is not None else self.loader.lines.parse(text, self.source.name, line)
        except LineError as error:
            finding = error.finding(self.source.name, line)
            alone = isinstance(self.loader.files, AnyFiles) and finding.severity is not Severity.ERROR
            told = not (later or alone)
            again = isinstance(error, NumberedLine) and self.loader.told_of_numbers
            if isinstance(error, NumberedLine) and not alone:
                # Each line of such a job has one: the first tells of all.
                told = self.loader.told_of_numbers = True
            if told and not again:
                self.loader.findings.add(finding)
            return _mistake(finding, text, told=told)

    def _skip(self, text: str, line: int) -> Statement | None:
        """A line that starts with a skip character: leave lines out; which, the manual leaves open by one."""
        count = skip_count(text, self.loader.controls.lexical)
        if not count:
            return None
        for _ in range(count - 1):
            if self.byte < len(self.data):
                self._take()
        span = Span(self.source.name, line, 1, 2)
        what = ""
        written = text.strip()
        if self.byte < len(self.data):
            save = self.byte, self.line, self.next_special
            number, raw = self._take()
            if self._says_something(raw):
                what = f"line {number}, which {text[0]!r} may leave out (it leaves out {count} lines)"
            self.byte, self.line, self.next_special = save
        if what:
            return Unsupported(what=what, span=span, text=written)
        return Replaced(written=written, body=(), span=span)

    def _says_something(self, raw: bytes) -> bool:
        """Whether a line is more than comments."""
        try:
            return bool(self.loader.reader.cut(decode(raw))[0].strip())
        except LineError:
            return True

    def _conditional(self, head: Head, line: int, before: int = 0) -> Iterator[Statement]:
        """A line that decides about the next one, and that line; before: lines that decide about this one."""
        span = Span(self.source.name, line)
        taken = self._next(before)
        code = getattr(head.statement, "written", None) or _code_of(head)
        if taken is None:
            if not self.is_job or self.in_array or self.loader.controls.end.strip():
                finding = codes.NEXT_LINE_OPEN.at(head.condition.span, code=code, what="no line follows in this file")
                self.loader.findings.add(finding)
            yield If(condition=head.condition, then=(), otherwise=(), span=head.condition.span, head=head.statement)
            return
        if taken.why:
            what = f"a line without a command follows ({taken.why})"
            self.loader.findings.add(codes.NEXT_LINE_OPEN.at(head.condition.span, code=code, what=what))
            yield Unsupported(what=f"the condition {code}", span=head.condition.span, line=_line_of(head.statement))
            yield from taken.then
            return
        then, otherwise = taken.then, taken.otherwise
        yield If(condition=head.condition, then=then, otherwise=otherwise, span=head.condition.span if line else span,
                 head=head.statement)  # fmt: skip

    def _next(self, before: int) -> _Taken | None:
        """The next line, as what a condition decides about; None at the end."""
        if self.byte >= len(self.data):
            return None
        line, raw = self._take()
        if not raw.strip():
            return _Taken(why=f"line {line} is empty")
        parsed = self._parse(line, raw, later=True)
        if parsed is None:
            return _Taken(why=f"line {line} is a comment")
        if isinstance(parsed, ArrayLine):
            node = Unsupported(what="L10 after a condition", span=parsed.span, line=parsed.line)
            return _Taken((node,), why=f"line {line} starts or ends an array")
        if isinstance(parsed, Unsupported):
            return _Taken((parsed,), why=f"line {line} starts with a character of skipchars=")
        if isinstance(parsed, Replaced) and not parsed.body:
            return _Taken((parsed,), why=f"line {line} is switched off or left out")
        if isinstance(parsed, Head) and before >= MOST_IN_A_ROW:
            node = Unsupported(what=f"the condition {_code_of(parsed)}", span=parsed.condition.span)
            return _Taken((node,), why=f"line {line} is the last of {before + 2} conditions in a row")
        if isinstance(parsed, Head):
            inner = tuple(self._conditional(parsed, line, before + 1))
            if len(inner) == 1 and isinstance(inner[0], If):
                return _Taken(inner, inner[0].then)
            return _Taken(inner, why=f"line {line} decides about a line that does not exist")
        return _Taken((parsed,))


@record(frozen=True, slots=True)
class _Taken:
    """A line after a condition: what runs when it does and when not; why: which line is meant is not known."""

    then: tuple[Statement, ...] = ()
    otherwise: tuple[Statement, ...] = ()
    why: str = ""


def _switch(words: Iterable[tuple[int, float | None]], torch: int | None) -> bool:
    """Whether words are M11 to M14 and channels of such; torch: the output whose switching moves an axis."""
    for number, value in words:
        letter = chr(number)
        switches = letter == "M" and value in (11.0, 12.0, 13.0, 14.0)
        if not switches and not (letter == "C" and value is not None and value != torch):
            return False
    return True


def _mistake(finding: Finding, text: str, *, told: bool = False) -> Mistake:
    """A line that cannot be read, in its place; ``told``: its finding is reported."""
    return Mistake(
        code=finding.code.number, message=finding.message, span=finding.span, text=text.strip(), hint=finding.hint,
        told=told,
    )  # fmt: skip


def _array(line: ArrayLine, body: list[Statement]) -> Array:
    return Array(words=line.words, body=tuple(body), span=line.span, comment=line.comment, line=line.line)


def _line_of(statement: Statement) -> Block | None:
    """The words of a line that decides about the next one."""
    return statement if isinstance(statement, Block) else getattr(statement, "line", None)


def _code_of(head: Head) -> str:
    words: Any = getattr(head.statement, "words", ())
    return next((f"{w.letter}{w.value.value:g}" for w in words if w.letter in "LM"), "G5")
