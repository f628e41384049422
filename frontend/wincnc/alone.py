"""WinCNC files by themselves, to be printed again; and whether the programs that use a CNC.MAC stay the same.

What a definition stands for is joined with what follows its name in a job, so a definition that reads the same can
still make a line of a job longer than the controller takes. ``gproof fmt`` asks before it writes.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from gproof.frontend.common.alone import Alone
from gproof.frontend.wincnc.file_names import EXTENSIONS, MACRO_FILE
from gproof.frontend.wincnc.load import load_alone
from gproof.frontend.wincnc.mac_program import load_macro_file
from gproof.frontend.wincnc.machine import NO_SHOP
from gproof.ir.finding import Findings
from gproof.ir.machine import NO_MACHINE, Machine
from gproof.ir.program import Program
from gproof.ir.same import difference


def alone(machine: Machine, machine_file: Path | None, folder: Path | None, path: Path) -> Alone:
    """How the file ``path`` is read, which is in ``folder`` (None: nowhere): a program, or definitions."""
    known = NO_SHOP if machine is NO_MACHINE else machine
    if path.name.lower() == MACRO_FILE:
        return Alone(
            lambda path, findings, name: load_macro_file(path, findings, name, machine=machine),
            machine=known,
            others=lambda before, after: other_programs(folder, before, after, machine),
        )
    where = [one for one in (None if machine_file is None else machine_file.parent, folder) if one is not None]
    return Alone(
        lambda path, findings, name: load_alone(path, findings, name, machine=machine, folders=where), machine=known
    )


def other_programs(folder: Path | None, before: Path, after: Path, machine: Machine) -> str:
    """The first file of ``folder``, or of one in it, that the second CNC.MAC makes another program; "" when none is."""
    for path in _programs(folder):
        found = _difference(path, before, after, machine)
        if found is not None:
            return f"commands in this form: {path} would be another program ({found})"
    return ""


def _programs(folder: Path | None) -> Iterator[Path]:
    if folder is None:
        return
    for path in sorted(folder.iterdir()):
        if path.is_dir():
            yield from (file for file in sorted(path.iterdir()) if _is_program(file))
        elif _is_program(path):
            yield path


def _is_program(path: Path) -> bool:
    return path.suffix.lower() in EXTENSIONS and path.name.lower() != MACRO_FILE and path.is_file()


def _difference(path: Path, before: Path, after: Path, machine: Machine) -> str | None:
    sides: list[tuple[Program | None, list[tuple[str, int]]]] = []
    for macros in (before, after):
        findings = Findings()
        program = load_alone(path, findings, machine=machine, folders=[path.parent], macro_file=macros)
        # Findings in the macro file itself have other columns; those of the program are what counts.
        own = [(f.code.label, f.span.line) for f in findings.kept if f.span.file == str(path)]
        sides.append((program, own))
    (one, mine), (two, other) = sides
    if mine != other:
        code, line = next(iter(sorted(set(mine) ^ set(other))), ("", 0))
        return f"{code} in line {line}"
    return None if one is None or two is None else difference(one, two, notes=False)
