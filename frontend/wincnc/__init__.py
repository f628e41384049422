"""The WinCNC dialect: programs, subprogram files, CNC.MAC and WINCNC.INI."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gproof.frontend.common.frontend import Alike, Files, Frontend, Marker, OwnTable, Read, Reading
from gproof.frontend.wincnc.file_names import EXTENSIONS, MACRO_FILE, SETTINGS

if TYPE_CHECKING:
    from gproof.frontend.common.alone import Alone
    from gproof.frontend.common.toml_table import TomlTable
    from gproof.ir.finding import Findings
    from gproof.ir.job import Job
    from gproof.ir.machine import Machine
    from gproof.ir.program import Program
    from gproof.ir.settings import Settings
    from gproof.ir.setup import Setup


def _load_program(job: Reading) -> Read:
    from gproof.frontend.wincnc.job import load_job

    return load_job(job)


def _alone(machine: Machine, machine_file: Path | None, folder: Path | None, path: Path) -> Alone:
    from gproof.frontend.wincnc.alone import alone

    return alone(machine, machine_file, folder, path)


def _load_machine(
    path: Path, findings: Findings, alone: bool, anew: frozenset[tuple[str, ...]]
) -> tuple[Machine | None, Files]:
    from gproof.frontend.wincnc.machine_ini import load_wincnc_ini

    return load_wincnc_ini(path, findings, anew)


def _knows_machine(path: Path) -> bool:
    from gproof.frontend.wincnc.machine_ini import is_wincnc_ini

    return is_wincnc_ini(path)


def _usual_settings() -> Settings:
    from gproof.ir.dialects.wincnc.settings import NO_WINCNC_SETTINGS

    return NO_WINCNC_SETTINGS


def _settings_from(root: TomlTable, machine: Machine, unit: Fraction, keys: dict[str, Any]) -> Settings:
    from gproof.frontend.wincnc.machine_table import settings_from

    return settings_from(root, machine, unit)


def _raise_program(program: Program, machine: Machine, setup: Setup | None = None) -> Job:
    from gproof.frontend.wincnc.raising import raise_program

    return raise_program(program, machine, {} if setup is None else setup.positions)


def _plain_devices(program: Program) -> Program:
    from gproof.frontend.wincnc.plain_devices import plain_devices

    return plain_devices(program)


FRONTEND = Frontend(
    name="wincnc",
    title="WinCNC",
    extensions=EXTENSIONS,
    no_jobs=(".mac",),
    shop_files=(SETTINGS, MACRO_FILE),
    settings=((SETTINGS, "the settings of WinCNC; give it with --machine"),),
    markers=(
        Marker(rank=40, reason="L code", pattern=rb"(?mi)^[ \t]*L\d+\b"),
        Marker(rank=41, reason="bracketed comment or macro call", pattern=rb"(?m)^[ \t]*\["),
        Marker(rank=42, reason="M98 with a file name", pattern=rb"(?i)\bM98[ \t]+[A-Za-z_]+\."),
    ),
    # A comment may look like the name of a module.
    alike=(Alike(reason="program number after %"),),
    open_offsets=("g92",),
    load_program=_load_program,
    alone=_alone,
    definitions=MACRO_FILE,
    folder_machine=SETTINGS,
    load_machine=_load_machine,
    own_table=OwnTable(name="controls", usual=_usual_settings, read=_settings_from),
    machine_files=(SETTINGS,),
    knows_machine=_knows_machine,
    raise_program=_raise_program,
    plain_devices=_plain_devices,
)
