"""McuWIN files for ``gproof fmt``: what a file is read with, and what decides that a text still means the same.

A file that jobs include may use names that they declare: it is read within each of them.
"""

from __future__ import annotations

import hashlib
import mmap
import re
from collections.abc import Iterable, Iterator
from itertools import zip_longest
from pathlib import Path

from gproof.backend.emit.mcuwin import emit
from gproof.backend.emit.mcuwin_tree import text_of
from gproof.cli.fmt_form import Form
from gproof.frontend.common.detect import EXTENSIONS
from gproof.frontend.mcuwin.load import load_alone
from gproof.frontend.mcuwin.machine import NO_MCUWIN
from gproof.ir import codes
from gproof.ir.dialects.mcuwin_settings import mcuwin_settings
from gproof.ir.finding import Findings, Refusal, Severity
from gproof.ir.machine import NO_MACHINE, Machine
from gproof.ir.program import Program

INCLUDE_FILES = (".inc",)
"""Extensions of files that are no jobs."""
NAMED = 5
"""Lines that a message names."""

_INCLUDE = re.compile(rb"^[^\r\n'(]*\$[Ii][ \t]+([^ \t('\"\r\n]+)", re.MULTILINE)
_LAST_PART = re.compile(r"[/\\:]")


def mcuwin_form(machine: Machine, machine_file: Path | None, folder: Path | None, path: Path) -> Form:
    """Of the file ``path``, which stands in ``folder`` (None: nowhere)."""
    known = NO_MCUWIN if machine is NO_MACHINE else machine
    din = mcuwin_settings(known)

    def within(job: Path | None) -> Form:
        return Form(
            lambda path, findings, name: load_alone(
                path, findings, name, machine=known, machine_file=machine_file, folder=folder, within=job
            ),
            lambda program: emit(program, din),
            judge=lambda before, after: said_otherwise(before, after, known),
            instead=instead if job is None else tuple,
            what=str(job or path),
            machine=known,
        )

    def instead() -> Iterable[Form]:
        if folder is None:
            return ()
        jobs = jobs_around(path)
        if not jobs and path.suffix.lower() in INCLUDE_FILES:
            return [_without_names(within(None), machine)]
        return [within(job) for job in jobs]

    return within(None)


def _without_names(form: Form, machine: Machine) -> Form:
    """Reads an include file that nobody includes: lines with names that nothing declares stay as they are."""
    lines: set[int] = set()

    def load(path: Path, findings: Findings, name: str) -> Program | None:
        own = Findings(limit=1_000_000)
        program = form.load(path, own, name)
        errors = [finding for finding in own.kept if finding.severity is Severity.ERROR]
        if program is None or any(finding.code is not codes.UNDECLARED_NAME for finding in errors):
            for finding in own.kept:
                findings.add(finding)
        lines.update(finding.span.line for finding in errors)
        return program

    def said() -> str:
        some = ", ".join(map(str, sorted(lines)[:NAMED])) + (" ..." if len(lines) > NAMED else "")
        stay = f"line {some} stays as it is" if len(lines) == 1 else f"lines {some} stay as they are"
        return f"{stay}, with names that only a job which includes the file can declare; no file here does"

    return Form(
        load,
        lambda program: emit(program, mcuwin_settings(machine), as_is=frozenset(lines)),
        judge=form.judge,
        said=said,
        machine=form.machine,
    )


def jobs_around(path: Path) -> list[Path]:
    """The files beside ``path``, or one folder up, that include it, also by way of others, and that nobody includes."""
    own = path.resolve()
    beside = [file for folder in (own.parent, own.parent.parent) for file in _programs(folder)]
    includes = {file: _included(file) for file in dict.fromkeys(beside)}
    found, waiting = {own: 0}, [own]
    roots = []
    while waiting:
        file = waiting.pop()
        around = [other for other in includes if other != file and file.name.lower() in includes[other]]
        if not around and file != own:
            roots.append(file)
        new = [other for other in around if other not in found]
        found.update(dict.fromkeys(new, 0))
        waiting += new
    return sorted(roots)


def _programs(folder: Path) -> list[Path]:
    try:
        files = sorted(folder.iterdir())
        return [file for file in files if EXTENSIONS.get(file.suffix.lower()) == "mcuwin" and file.is_file()]
    except OSError:
        return []


def _included(path: Path) -> set[str]:
    """Names of the files that a file includes, without folders, in lower case."""
    try:
        with path.open("rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as data:
            return {_LAST_PART.split(found[1].decode("latin-1"))[-1].lower() for found in _INCLUDE.finditer(data)}
    except (OSError, ValueError):  # an empty file has no map
        return set()


def said_otherwise(before: Program, after: Program, machine: Machine) -> str:
    """What a second printer, which never looks at the text of a file, makes of one Program and not of the other; ""."""
    sums = []
    for program in (before, after):
        found = hashlib.sha256()
        for piece in _pieces(program, machine):
            found.update(piece)
        sums.append(found.digest())
    if sums[0] == sums[1]:
        return ""
    pairs = zip_longest(*(_lines(program, machine) for program in (before, after)), fillvalue="nothing")
    return next(f"{one!r} and {two!r}" for one, two in pairs if one != two)


def _pieces(program: Program, machine: Machine) -> Iterator[bytes]:
    """The text of a Program, up to what has none: that is compared as a node."""
    axes = "".join(axis.word for axis in machine.axes)
    try:
        yield from text_of(program, mcuwin_settings(machine), axes)
    except Refusal as refusal:
        yield str(refusal.finding.message).encode()


def _lines(program: Program, machine: Machine) -> Iterator[str]:
    held = b""
    for piece in _pieces(program, machine):
        *lines, held = (held + piece).split(b"\n")
        yield from (line.decode() for line in lines)
    if held:
        yield held.decode()
