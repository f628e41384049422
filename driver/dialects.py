"""The registry of dialects: one line each, the first where it is unknown which one a job is in.

What a line names is light: a dialect's folder imports what it needs when something of it is requested.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gproof.backend.emit import eding as emit_eding
from gproof.backend.emit import mcuwin as emit_mcuwin
from gproof.backend.emit import wincnc as emit_wincnc
from gproof.backend.emit.printer import Printer
from gproof.frontend import eding, mcuwin, wincnc
from gproof.frontend.common.frontend import Files, Frontend
from gproof.ir.record import record
from gproof.passes.interpret import eding as run_eding
from gproof.passes.interpret import mcuwin as run_mcuwin
from gproof.passes.interpret import wincnc as run_wincnc

if TYPE_CHECKING:
    from gproof.ir.finding import Findings
    from gproof.ir.machine import Machine
    from gproof.ir.program import Program
    from gproof.ir.setup import Setup
    from gproof.passes.interpret.core.semantics import Dialect


@record(frozen=True, slots=True, kw_only=True)
class Language:
    """What gproof knows of a controller's language.

    frontend: reads its programs and files; printer: prints them; semantics: what decides how one program is executed.
    """

    frontend: Frontend
    printer: Printer
    semantics: Callable[[Program], Dialect[Any]]


DIALECTS: dict[str, Language] = {
    "eding": Language(frontend=eding.FRONTEND, printer=emit_eding.PRINTER, semantics=run_eding.semantics),
    "wincnc": Language(frontend=wincnc.FRONTEND, printer=emit_wincnc.PRINTER, semantics=run_wincnc.semantics),
    "mcuwin": Language(frontend=mcuwin.FRONTEND, printer=emit_mcuwin.PRINTER, semantics=run_mcuwin.semantics),
}


def frontends() -> tuple[Frontend, ...]:
    """Of all dialects, in their order."""
    return tuple(dialect.frontend for dialect in DIALECTS.values())


def extensions() -> dict[str, str]:
    """The dialect of each extension that programs have."""
    return {extension: one.name for one in frontends() for extension in one.extensions}


def settings_files() -> dict[str, str]:
    """The kinds of controllers' files that are not programs, by name in lower case."""
    return {name: what for one in frontends() for name, what in one.settings}


def guess_dialect(path: Path) -> tuple[str, str]:
    """The dialect of a program and why, by its name and its first lines."""
    from gproof.frontend.common.detect import guess_dialect as guess

    return guess(path, frontends())


def load_machine(path: Path, findings: Findings) -> tuple[Machine | None, Files]:
    """The machine in a TOML file or a controller's own file; None, with findings GP601-GP604, when it is bad."""
    from gproof.frontend.files.machine import load_machine as load

    return load(path, findings, frontends())


def load_setup(path: Path, findings: Findings, machine: Machine | None = None) -> tuple[Setup | None, Files]:
    """The setup in a file, lengths in mm; None, with findings GP601-GP604, when it is bad.

    machine: whose axes the file's letters name; None: one of which nothing is known.
    """
    from gproof.frontend.files.setup import load_setup as load
    from gproof.ir.machine import NO_MACHINE

    return load(path, findings, frontends(), NO_MACHINE if machine is None else machine)


def semantics_of(program: Program) -> Dialect[Any]:
    """What decides how a program is executed: one object a run."""
    return DIALECTS[program.rules.name].semantics(program)
