"""The registry of dialects: one line each, the first where nothing says which one a job is in.

What a line names is light: a dialect's folder imports what it needs when something of it is asked for.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from gproof.frontend.common.frontend import Files, Frontend
from gproof.frontend.eding import FRONTEND as EDING
from gproof.frontend.mcuwin import FRONTEND as MCUWIN
from gproof.frontend.wincnc import FRONTEND as WINCNC
from gproof.ir.record import record

if TYPE_CHECKING:
    from gproof.ir.finding import Findings
    from gproof.ir.machine import Machine


@record(frozen=True, slots=True, kw_only=True)
class Dialect:
    """What gproof knows of a controller's language. frontend: reads its programs and its files."""

    frontend: Frontend


DIALECTS: dict[str, Dialect] = {
    "eding": Dialect(frontend=EDING),
    "wincnc": Dialect(frontend=WINCNC),
    "mcuwin": Dialect(frontend=MCUWIN),
}


def frontends() -> tuple[Frontend, ...]:
    """Of all dialects, in their order."""
    return tuple(dialect.frontend for dialect in DIALECTS.values())


def extensions() -> dict[str, str]:
    """The dialect of each extension that programs have."""
    return {extension: one.name for one in frontends() for extension in one.extensions}


def settings_files() -> dict[str, str]:
    """What files of controllers are that stand beside programs, by name in lower case."""
    return {name: what for one in frontends() for name, what in one.settings}


def guess_dialect(path: Path) -> tuple[str, str]:
    """The dialect of a program and why, by its name and its first lines."""
    from gproof.frontend.common.detect import guess_dialect as guess

    return guess(path, frontends())


def load_machine(path: Path, findings: Findings) -> tuple[Machine | None, Files]:
    """The machine in a TOML file or a controller's own file; None, with findings GP601-GP604, when it is bad."""
    from gproof.frontend.files.machine import load_machine as load

    return load(path, findings, frontends())
