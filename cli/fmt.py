"""``gproof fmt``: programs in one form. What it prints is read again and compared before anything is written."""

from __future__ import annotations

import filecmp
import os
import shutil
import sys
import tempfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from itertools import zip_longest
from pathlib import Path

import click

from gproof.backend.emit.printer import Printer
from gproof.driver.dialects import DIALECTS, extensions, frontends, semantics_of
from gproof.driver.errors import UsageError
from gproof.driver.escape import in_one_line
from gproof.driver.files import require_file, require_program
from gproof.driver.session import dialect_of
from gproof.driver.source_text import line_text
from gproof.frontend.common.alone import Alone
from gproof.ir import codes
from gproof.ir.finding import Finding, Findings, Refusal, Severity, Span
from gproof.ir.kernel import Kernel
from gproof.ir.machine import NO_MACHINE, Machine
from gproof.ir.program import Program
from gproof.ir.record import record
from gproof.ir.same import difference
from gproof.passes.interpret.understood_lines import doubtful_lines
from gproof.report.escape import program_line
from gproof.report.text import print_findings

STANDARD_INPUT = Path("-")
SECONDS_A_BYTE = 2e-6
"""What reading, printing and reading again takes in plain Python for a byte of source."""
CONTEXT = 3
"""Lines around a change that ``--diff`` shows."""
LONGEST_RUN = 1000
"""Changed lines that ``--diff`` shows before their new forms."""


@record(frozen=True, slots=True)
class Form:
    """How a file is read and printed."""

    alone: Alone
    printer: Printer

    def emit(self, program: Program) -> Iterable[bytes]:
        """Its text."""
        return self.printer.emit(program, self.alone.machine, self.alone.as_is())

    def instead(self) -> Iterator[Form]:
        """Other ways to read a file that has mistakes in this one."""
        return (Form(other, self.printer) for other in self.alone.instead())


class Forms:
    """The language of each file, with the settings of its machine.

    Machines that read lines in their own way (WinCNC) are looked for in the folder of the file unless one is given.
    """

    def __init__(self, dialect: str | None, machine: Path | None) -> None:
        self.dialect = dialect
        self.machine_file = machine
        self.machines: dict[Path, Machine] = {}

    def of(self, source: Path, path: Path) -> Form:
        """For the file ``source``, which stands for ``path``; UsageError for a language not read."""
        folder = None if path == STANDARD_INPUT else path.parent
        beside = {} if folder is None else {one.name.lower(): one for one in folder.iterdir()}
        machine_file = self.machine_file or self._of_folder(beside)
        machine = NO_MACHINE if machine_file is None or not self._asks_machine() else self._machine(machine_file)
        dialect, known = self.dialect, machine.controller.dialect
        for one in frontends():
            if not one.definitions:
                continue
            if path.name.lower() == one.definitions:
                dialect = dialect or known or one.name
                if dialect != one.name:
                    raise UsageError(
                        f"file {path}: is a macro file of {one.title}, not of {dialect}; leave out --dialect"
                    )
            elif dialect is None and known is None and one.definitions in beside:
                dialect = one.name
        dialect, _ = dialect_of(source, dialect, machine, machine_file)
        found = DIALECTS[dialect]
        return Form(found.frontend.alone(machine, machine_file, folder, path), found.printer)

    def _asks_machine(self) -> bool:
        """Whether settings of a machine say how lines of the language are read that is given, or may be."""
        return self.dialect is None or DIALECTS[self.dialect].frontend.lines_of_machine

    def _of_folder(self, beside: dict[str, Path]) -> Path | None:
        """The machine file that a folder has for its programs."""
        names = (one.folder_machine for one in frontends() if one.folder_machine)
        return next((beside[name] for name in names if name in beside), None)

    def _machine(self, path: Path) -> Machine:
        """The machine of a file, read once; UsageError, with findings, for one with mistakes."""
        from gproof.driver.dialects import load_machine

        if path not in self.machines:
            require_file(path, "machine file")
            findings = Findings()
            machine, _ = load_machine(path, findings)
            if machine is None:
                print_findings(findings, err=True)
                raise UsageError(f"machine file {path}: cannot be used, see the errors above")
            self.machines[path] = machine
        return self.machines[path]


def run_fmt(
    files: tuple[Path, ...], *, only_check: bool, diff: bool, to_stdout: bool, dialect: str | None,
    machine: Path | None = None, stdin_name: Path | None = None,
) -> int:  # fmt: skip
    """Format every file; exit 1 when one has mistakes, or with ``--check`` would change.

    stdin_name: the file that standard input stands for: its name and folder say how it is read.
    """
    files = tuple(_with_folders(files))
    if stdin_name is not None and files != (STANDARD_INPUT,):
        raise UsageError("--stdin-name needs - (standard input) as the only file")
    if stdin_name is not None and not stdin_name.parent.is_dir():
        raise UsageError(f"--stdin-name {stdin_name}: no such folder: {stdin_name.parent}")
    forms = Forms(dialect, machine)
    _require(files, forms, only_check=only_check, diff=diff, to_stdout=to_stdout)
    to_stdout = to_stdout or (files == (STANDARD_INPUT,) and not (only_check or diff))
    in_place = not (only_check or diff or to_stdout)
    worst = 0
    for path in dict.fromkeys(files):
        named = stdin_name or path
        with _source(path, named) as source, _scratch(source, in_place) as scratch:
            name = str(named)
            form = forms.of(source, named)
            done = _format(form, source, scratch, name)
            if not done:
                click.echo(f"{in_one_line(name)}: not formatted", err=True)
                worst = 1
                continue
            changed = not filecmp.cmp(source, scratch, shallow=False)
            if to_stdout:
                _print_file(scratch)
                continue
            if diff and changed:
                _print_diff(source, scratch, name)
            if only_check and changed:
                worst = 1
            if in_place and changed:
                shutil.copymode(source, scratch)
                os.replace(scratch, os.path.realpath(source))
            state = "unchanged" if not changed else "formatted" if in_place else "would be formatted"
            click.echo(f"{in_one_line(name)}: {state}", err=diff)
    return worst


def _with_folders(files: tuple[Path, ...]) -> Iterator[Path]:
    """The files, and of each folder the programs in it, by their extensions; UsageError for one that has none.

    A macro file comes first: what a line of a program stands for, and how long it is then, is counted with its form.
    """
    first = {one.definitions for one in frontends()}
    for path in files:
        if path == STANDARD_INPUT or not path.is_dir():
            yield path
            continue
        programs = [
            file for file in sorted(path.iterdir(), key=lambda file: (file.name.lower() not in first, file))
            if file.suffix.lower() in extensions() and file.suffix.lower() != ".txt" and file.is_file()
        ]  # fmt: skip
        if not programs:
            raise UsageError(f"folder {path}: no programs in it; folders inside it are not searched")
        yield from programs


def _require(files: tuple[Path, ...], forms: Forms, *, only_check: bool, diff: bool, to_stdout: bool) -> None:
    """UsageError, before anything is done, for what cannot be read or written, and for options at odds."""
    if to_stdout and (only_check or diff):
        raise UsageError(f"--stdout and {'--check' if only_check else '--diff'} cannot be used together")
    if STANDARD_INPUT in files and sys.stdin is None:
        raise UsageError("standard input is closed")
    if STANDARD_INPUT in files and len(files) > 1:
        raise UsageError("- (standard input) cannot be combined with other files")
    if to_stdout and len(files) > 1:
        raise UsageError("--stdout takes one file")
    for path in files:
        if path == STANDARD_INPUT:
            continue
        require_program(path, "file")
        forms.of(path, path)
        folder = Path(os.path.realpath(path)).parent
        if not (only_check or diff or to_stdout) and not os.access(folder, os.W_OK):
            raise UsageError(f"file {path}: no permission to write in folder {folder}")


@contextmanager
def _source(path: Path, named: Path) -> Iterator[Path]:
    """The file to read: ``path``, or what standard input has, as a file with the extension of ``named``."""
    if path != STANDARD_INPUT:
        yield path
        return
    with tempfile.TemporaryDirectory(prefix="gproof-") as folder:
        copy = Path(folder) / f"standard-input{named.suffix or '.cnc'}"
        with copy.open("wb") as file:
            shutil.copyfileobj(sys.stdin.buffer, file)
        yield copy


@contextmanager
def _scratch(source: Path, in_place: bool) -> Iterator[Path]:
    """A new file for the text, gone afterwards unless it was renamed; in the folder of ``source`` when in place."""
    folder = os.path.dirname(os.path.realpath(source)) if in_place else None
    handle, name = tempfile.mkstemp(prefix=".gproof-", suffix=".cnc", dir=folder)
    os.close(handle)
    try:
        yield Path(name)
    finally:
        Path(name).unlink(missing_ok=True)


def _format(form: Form, source: Path, scratch: Path, name: str) -> bool:
    """Print the formatted text of ``source`` into ``scratch``; False, with findings shown, when there is none.

    Where the file has mistakes as it is, the other ways to read it count: each of them that finds none must give the
    same text.
    """
    Kernel.forecast(source.stat().st_size * SECONDS_A_BYTE)
    failed = _tried(form, source, scratch, name)
    if failed is None:
        return True
    done: Form | None = None
    others = form.instead() if all(f.code is not codes.FORMAT_DIFFERS for f in failed.kept) else ()
    for number, other in enumerate(others):
        with _scratch(source, in_place=False) as more:
            findings = _tried(other, source, more, name)
            if findings is not None:
                failed = findings if number == 0 else failed
            elif done is None:
                shutil.copyfile(more, scratch)
                done = other
            elif not filecmp.cmp(more, scratch, shallow=False):
                both = f"{done.alone.what} and {other.alone.what}"
                click.echo(f"{in_one_line(name)}: {both} read it in different ways", err=True)
                return False
    if done is None:
        print_findings(failed, err=True)
        return False
    if said := done.alone.said():
        click.echo(f"{in_one_line(name)}: {said}", err=True)
    return True


def _tried(form: Form, source: Path, scratch: Path, name: str) -> Findings | None:
    """Print ``source`` into ``scratch``; what was found when that cannot be done."""
    findings = Findings()
    program = form.alone.load(source, findings, name)
    if program is None or findings.has(Severity.ERROR):
        return findings
    try:
        finding = _printed(form, form.emit(program), program, source, scratch, name)
        less = form.printer.emit_less
        if finding is not None and finding.code is codes.NOT_PRINTABLE and less is not None:
            finding = _printed(form, less(program, form.alone.machine), program, source, scratch, name)
    except Refusal as refusal:
        finding = refusal.finding
    if finding is None:
        return None
    findings.add(finding)
    return findings


def _printed(
    form: Form, text: Iterable[bytes], program: Program, source: Path, scratch: Path, name: str
) -> Finding | None:
    """Print a program into ``scratch``, read it again and compare; a finding when something is not the same."""
    with scratch.open("wb") as file:
        for piece in text:
            file.write(piece)
    _keep(doubtful_lines(program, form.alone.machine, semantics_of(program)), source, scratch)
    if filecmp.cmp(source, scratch, shallow=False):
        return None
    findings = Findings()
    again = form.alone.load(scratch, findings, name)
    if again is None or findings.has(Severity.ERROR):
        what = next((f"{f.message} (line {f.span.line})" for f in findings.kept), "it cannot be read")
    else:
        what = difference(program, again) or form.printer.judge(program, again, form.alone.machine)
    if what:
        return codes.FORMAT_DIFFERS.at(Span(name, 1), what=what)
    others = form.alone.others(source, scratch)
    return codes.NOT_PRINTABLE.at(Span(name, 1), what=others) if others else None


def _keep(lines: frozenset[int], source: Path, scratch: Path) -> None:
    """Have lines that are not understood as they were, byte for byte."""
    if not lines:
        return
    copy = scratch.with_name(scratch.name + "-kept")
    try:
        with source.open("rb") as before, scratch.open("rb") as after, copy.open("wb") as out:
            for number, line in enumerate(after, 1):
                old = next(before, b"")
                out.write(old if number in lines else line)
        os.replace(copy, scratch)
    finally:
        copy.unlink(missing_ok=True)


def _print_file(path: Path) -> None:
    sys.stdout.flush()
    with path.open("rb") as file:
        while piece := file.readline() if sys.stdout.isatty() else file.read(1 << 20):
            _print_bytes(piece)


def _print_diff(before: Path, after: Path, name: str) -> None:
    """A unified diff; line n is compared with line n: only an end of DOS has a line of its own that goes."""
    click.echo(f"--- {in_one_line(name)}\n+++ {in_one_line(name)} (formatted)")
    counts = [_count_lines(path) for path in (before, after)]
    with before.open("rb") as old, after.open("rb") as new:
        pairs = enumerate(zip_longest(old, new, fillvalue=b""), 1)
        for first, last in _hunks(before, after):
            sizes = [min(last, count) - first + 1 for count in counts]
            click.echo(f"@@ -{first},{sizes[0]} +{first},{sizes[1]} @@")
            changed: list[tuple[bytes, bytes]] = []
            for number, pair in pairs:
                if number < first:
                    continue
                if pair[0] != pair[1]:
                    changed.append(pair)
                if pair[0] == pair[1] or number == last or len(changed) == LONGEST_RUN:
                    _print_changed(changed)
                    changed = []
                if pair[0] == pair[1]:
                    _print_diff_line(b" ", pair[0])
                if number == last:
                    break


def _count_lines(path: Path) -> int:
    with path.open("rb") as file:
        return sum(1 for _ in file)


def _hunks(before: Path, after: Path) -> Iterator[tuple[int, int]]:
    """First and last line of each place that changes, with the lines around it."""
    first, last, number = 0, 0, 0
    with before.open("rb") as old, after.open("rb") as new:
        for number, (left, right) in enumerate(zip_longest(old, new, fillvalue=b""), 1):
            if left == right:
                continue
            if last and number - CONTEXT > last + 1:
                yield first, last
                last = 0
            first = first if last else max(1, number - CONTEXT)
            last = number + CONTEXT
    if last:
        yield first, min(last, number)


def _print_changed(pairs: list[tuple[bytes, bytes]]) -> None:
    for left in (left for left, _ in pairs if left):
        _print_diff_line(b"-", left)
    for right in (right for _, right in pairs if right):
        _print_diff_line(b"+", right)


def _print_diff_line(sign: bytes, text: bytes) -> None:
    end = b"" if text.endswith(b"\n") else b"\n\\ No newline at end of file\n"
    _print_bytes(sign + text, end)


def _print_bytes(text: bytes, end: bytes = b"") -> None:
    """What a program says: byte for byte into a file or a pipe; on a terminal a line that nothing of it acts on."""
    shown = program_line(line_text(text)) if sys.stdout.isatty() else text
    click.echo(shown, nl=False)
    if end:
        click.echo(end, nl=False)
