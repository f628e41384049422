"""``gproof fmt``: programs in one form. What it prints is read again and compared before anything is written."""

from __future__ import annotations

import filecmp
import os
import shutil
import sys
import tempfile
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from itertools import zip_longest
from pathlib import Path

import click

from gproof.backend.emit.eding import emit
from gproof.cli.fmt_form import Form
from gproof.cli.main import UsageError
from gproof.cli.options import in_one_line
from gproof.driver.files import require_file, require_program
from gproof.driver.session import READ, dialect_of
from gproof.frontend.common.detect import EXTENSIONS
from gproof.frontend.eding.load import load_alone
from gproof.ir import codes
from gproof.ir.dialects.wincnc_settings import wincnc_settings
from gproof.ir.finding import Finding, Findings, Refusal, Severity, Span
from gproof.ir.kernel import Kernel
from gproof.ir.machine import NO_MACHINE, Machine
from gproof.ir.program import Program
from gproof.ir.same import difference
from gproof.passes.interpret.understood_lines import doubtful_lines
from gproof.report.escape import program_line
from gproof.report.text import line_text, print_findings

STANDARD_INPUT = Path("-")
MACROS = "cnc.mac"
"""WinCNC's macro file, which holds definitions."""
SECONDS_A_BYTE = 2e-6
"""What reading, printing and reading again takes in plain Python for a byte of source."""
CONTEXT = 3
"""Lines around a change that ``--diff`` shows."""
LONGEST_RUN = 1000
"""Changed lines that ``--diff`` shows before their new forms."""


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
        beside = self._beside(folder)
        machine_file = self.machine_file or beside.get("wincnc.ini")
        machine = NO_MACHINE if machine_file is None or self.dialect == "eding" else self._machine(machine_file)
        dialect = self.dialect
        if path.name.lower() == MACROS:
            dialect = dialect or machine.controller.dialect or "wincnc"
            if dialect != "wincnc":
                raise UsageError(f"file {path}: holds macros of WinCNC, not of {dialect}")
            return _macro_file(machine, folder)
        if dialect is None and machine.controller.dialect is None and "cnc.mac" in beside:
            dialect = "wincnc"
        dialect, _ = dialect_of(source, dialect, machine, machine_file)
        if dialect == "eding":
            return Form(load_alone, emit)
        if dialect == "mcuwin":
            from gproof.cli.fmt_mcuwin import mcuwin_form

            return mcuwin_form(machine, machine_file, folder, path)
        return _wincnc(machine, [file.parent for file in (machine_file,) if file is not None], folder)

    def _beside(self, folder: Path | None) -> dict[str, Path]:
        """The files of a folder that say how WinCNC reads lines, by name in lower case."""
        if folder is None:
            return {}
        return {path.name.lower(): path for path in folder.iterdir() if path.name.lower() in ("wincnc.ini", "cnc.mac")}

    def _machine(self, path: Path) -> Machine:
        """The machine of a file, read once; UsageError, with findings, for one with mistakes."""
        from gproof.frontend.files.machine import load_machine

        if path not in self.machines:
            require_file(path, "machine file")
            findings = Findings()
            machine, _ = load_machine(path, findings)
            if machine is None:
                print_findings(findings, err=True)
                raise UsageError(f"the machine file {path} can not be used")
            self.machines[path] = machine
        return self.machines[path]


def _wincnc(machine: Machine, folders: list[Path], own: Path | None) -> Form:
    from gproof.backend.emit.wincnc import emit as emit_wincnc
    from gproof.frontend.wincnc.load import load_alone as load_wincnc
    from gproof.frontend.wincnc.machine import NO_SHOP

    lexical = wincnc_settings(machine).lexical
    where = [*folders, *([own] if own is not None else [])]
    return Form(
        lambda path, findings, name: load_wincnc(path, findings, name, machine=machine, folders=where),
        lambda program: emit_wincnc(program, lexical),
        machine=machine if machine is not NO_MACHINE else NO_SHOP,
    )


def _macro_file(machine: Machine, folder: Path | None) -> Form:
    from gproof.backend.emit.wincnc import emit as emit_wincnc
    from gproof.cli.fmt_macros import other_programs
    from gproof.frontend.wincnc.mac_program import load_macro_file
    from gproof.frontend.wincnc.machine import NO_SHOP

    lexical = wincnc_settings(machine).lexical
    return Form(
        lambda path, findings, name: load_macro_file(path, findings, name, machine=machine),
        lambda program: emit_wincnc(program, lexical),
        lambda before, after: other_programs(folder, before, after, machine),
        lambda program: emit_wincnc(program, lexical, same_length=True),
        machine=machine if machine is not NO_MACHINE else NO_SHOP,
    )


def run_fmt(
    files: tuple[Path, ...], *, only_check: bool, diff: bool, to_stdout: bool, dialect: str | None,
    machine: Path | None = None, stdin_name: Path | None = None,
) -> int:  # fmt: skip
    """Format every file; exit 1 when one has mistakes, or with ``--check`` would change.

    stdin_name: the file that standard input stands for: its name and folder say how it is read.
    """
    files = tuple(_with_folders(files))
    if stdin_name is not None and files != (STANDARD_INPUT,):
        raise UsageError("--stdin-name goes with - alone")
    if stdin_name is not None and not stdin_name.parent.is_dir():
        raise UsageError(f"--stdin-name {stdin_name}: there is no folder {stdin_name.parent}")
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
    for path in files:
        if path == STANDARD_INPUT or not path.is_dir():
            yield path
            continue
        programs = [
            file for file in sorted(path.iterdir(), key=lambda file: (file.name.lower() != MACROS, file))
            if EXTENSIONS.get(file.suffix.lower()) in READ and file.suffix.lower() != ".txt" and file.is_file()
        ]  # fmt: skip
        if not programs:
            raise UsageError(f"folder {path}: there is no program in it; folders inside it are not searched")
        yield from programs


def _require(files: tuple[Path, ...], forms: Forms, *, only_check: bool, diff: bool, to_stdout: bool) -> None:
    """UsageError, before anything is done, for what can not be read or written, and for options at odds."""
    if to_stdout and (only_check or diff):
        raise UsageError(f"--stdout prints the text, {'--check' if only_check else '--diff'} does not: choose one")
    if STANDARD_INPUT in files and sys.stdin is None:
        raise UsageError("standard input is closed")
    if STANDARD_INPUT in files and len(files) > 1:
        raise UsageError("- stands for standard input and goes alone")
    if to_stdout and len(files) > 1:
        raise UsageError("--stdout prints one file")
    for path in files:
        if path == STANDARD_INPUT:
            continue
        require_program(path, "file")
        forms.of(path, path)
        folder = Path(os.path.realpath(path)).parent
        if not (only_check or diff or to_stdout) and not os.access(folder, os.W_OK):
            raise UsageError(f"file {path}: the folder {folder} can not be written")


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
                click.echo(f"{in_one_line(name)}: {done.what} and {other.what} read it in different ways", err=True)
                return False
    if done is None:
        print_findings(failed, err=True)
        return False
    if done.said():
        click.echo(f"{in_one_line(name)}: {done.said()}", err=True)
    return True


def _tried(form: Form, source: Path, scratch: Path, name: str) -> Findings | None:
    """Print ``source`` into ``scratch``; what was found when that can not be done."""
    findings = Findings()
    program = form.load(source, findings, name)
    if program is None or findings.has(Severity.ERROR):
        return findings
    try:
        finding = _printed(form, form.emit, program, source, scratch, name)
        if finding is not None and finding.code is codes.NOT_PRINTABLE and form.emit_less is not None:
            finding = _printed(form, form.emit_less, program, source, scratch, name)
    except Refusal as refusal:
        finding = refusal.finding
    if finding is None:
        return None
    findings.add(finding)
    return findings


def _printed(
    form: Form, emit: Callable[[Program], Iterable[bytes]], program: Program, source: Path, scratch: Path, name: str
) -> Finding | None:
    """Print a program into ``scratch``, read it again and compare; a finding when something is not the same."""
    with scratch.open("wb") as file:
        for piece in emit(program):
            file.write(piece)
    _keep(doubtful_lines(program, form.machine), source, scratch)
    if filecmp.cmp(source, scratch, shallow=False):
        return None
    findings = Findings()
    again = form.load(scratch, findings, name)
    if again is None or findings.has(Severity.ERROR):
        what = next((f"{f.message} (line {f.span.line})" for f in findings.kept), "it can not be read")
    else:
        what = difference(program, again) or form.judge(program, again)
    if what:
        return codes.FORMAT_DIFFERS.at(Span(name, 1), what=what)
    others = form.others(source, scratch)
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
