"""McuWIN files by themselves, to be printed again: what a file is read with.

A file that jobs include may use names that they declare: it is read within each of them.
"""

from __future__ import annotations

import mmap
import re
from collections.abc import Iterable
from pathlib import Path

from gproof.frontend.common.alone import Alone
from gproof.frontend.mcuwin.load import load_alone
from gproof.frontend.mcuwin.machine import NO_MCUWIN
from gproof.frontend.mcuwin.names import EXTENSIONS, INCLUDE_FILES
from gproof.ir import codes
from gproof.ir.finding import Findings, Severity
from gproof.ir.machine import NO_MACHINE, Machine
from gproof.ir.program import Program

NAMED = 5
"""Lines that a message names."""

_INCLUDE = re.compile(rb"^[^\r\n'(]*\$[Ii][ \t]+([^ \t('\"\r\n]+)", re.MULTILINE)
_LAST_PART = re.compile(r"[/\\:]")


def alone(machine: Machine, machine_file: Path | None, folder: Path | None, path: Path) -> Alone:
    """How the file ``path`` is read, which is in ``folder`` (None: nowhere)."""
    known = NO_MCUWIN if machine is NO_MACHINE else machine

    def within(job: Path | None) -> Alone:
        return Alone(
            lambda path, findings, name: load_alone(
                path, findings, name, machine=known, machine_file=machine_file, folder=folder, within=job
            ),
            machine=known,
            instead=instead if job is None else tuple,
            what=str(job or path),
        )

    def instead() -> Iterable[Alone]:
        if folder is None:
            return ()
        jobs = jobs_around(path)
        if not jobs and path.suffix.lower() in INCLUDE_FILES:
            return [_without_names(within(None))]
        return [within(job) for job in jobs]

    return within(None)


def _without_names(whole: Alone) -> Alone:
    """Reads an include file that nobody includes: lines with names that nothing declares stay as they are."""
    lines: set[int] = set()

    def load(path: Path, findings: Findings, name: str) -> Program | None:
        own = Findings(limit=1_000_000)
        program = whole.load(path, own, name)
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

    return Alone(load, machine=whole.machine, said=said, as_is=lambda: frozenset(lines))


def jobs_around(path: Path) -> list[Path]:
    """Files next to ``path`` or one folder up that include it, directly or through others, and that none includes."""
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
        return [file for file in files if file.suffix.lower() in EXTENSIONS and file.is_file()]
    except OSError:
        return []


def _included(path: Path) -> set[str]:
    """Names of the files that a file includes, without folders, in lower case."""
    try:
        with path.open("rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as data:
            return {_LAST_PART.split(found[1].decode("latin-1"))[-1].lower() for found in _INCLUDE.finditer(data)}
    except (OSError, ValueError):  # an empty file has no map
        return set()
