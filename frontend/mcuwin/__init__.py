"""McuWIN (APCI-8001, APCI-8008): programs of DIN 66025 blocks with rw_SymPas inside, and their machine files."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gproof.frontend.common.frontend import Alike, Files, Frontend, Marker, OwnTable, Read, Reading
from gproof.frontend.mcuwin.names import EXTENSIONS, INCLUDE_FILES

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
    from gproof.frontend.mcuwin.job import load_job

    return load_job(job)


def _alone(machine: Machine, machine_file: Path | None, folder: Path | None, path: Path) -> Alone:
    from gproof.frontend.mcuwin.alone import alone

    return alone(machine, machine_file, folder, path)


def _load_machine(
    path: Path, findings: Findings, alone: bool, anew: frozenset[tuple[str, ...]]
) -> tuple[Machine | None, Files]:
    from gproof.frontend.mcuwin.machine_ini import load_mcuwin_ini

    return load_mcuwin_ini(path, findings, alone=alone)


def _knows_machine(path: Path) -> bool:
    from gproof.frontend.mcuwin.machine_ini import is_mcuwin_ini

    return is_mcuwin_ini(path)


def _completed(machine: Machine) -> Machine:
    from gproof.frontend.mcuwin.machine import with_axes

    return with_axes(machine)


def _setup_fields(root: TomlTable) -> dict[str, Any]:
    from gproof.frontend.mcuwin.resident import setup_fields

    return setup_fields(root)


def _usual_settings() -> Settings:
    from gproof.ir.dialects.mcuwin.settings import NO_MCUWIN_SETTINGS

    return NO_MCUWIN_SETTINGS


def _machine_from(root: TomlTable, machine: Machine, unit: Fraction, foreign: tuple[str, ...]) -> tuple[Machine, Files]:
    from gproof.frontend.mcuwin.machine_table import with_din

    return with_din(root, machine, unit, foreign)


def _raise_program(program: Program, machine: Machine, setup: Setup | None = None) -> Job:
    from gproof.frontend.mcuwin.raising import raise_program

    return raise_program(program, machine)


FRONTEND = Frontend(
    name="mcuwin",
    title="McuWIN",
    extensions=EXTENSIONS,
    no_jobs=INCLUDE_FILES,
    shop_files=("mcuwin.ini", "toolcomp.ini"),
    settings=(
        ("mcuwin.ini", "the settings of McuWIN; give it with --machine"),
        ("toolcomp.ini", "the tool table of McuWIN; name it in tool_file of a machine file"),
    ),
    markers=(
        Marker(rank=20, reason="program number after %", pattern=rb"(?m)^[ \t]*%[ \t]*\w+[ \t]*(?:['(]|\r?$)"),
        Marker(rank=21, reason="named variable or procedure", pattern=rb"(?mi)^[ \t]*(?:var|procedure|proc)\b"),
        Marker(rank=22, reason="$ statement", pattern=rb"(?mi)^[ \t]*(?:N\d+[ \t]*)?\$[A-Za-z]"),
        Marker(rank=23, reason="DIN section", pattern=rb"(?i)\{[ \t]*\$DINSTART[ \t]*\}"),
        Marker(rank=24, reason="calculation parameter", pattern=rb"(?i)\bC[DI]\d{1,3}[ \t]*:="),
        Marker(rank=25, reason="jump or call of a label", pattern=rb"(?mi)^[^'(;\[\n]*\bM9[68][ \t]*L[ \t]*\d"),
    ),
    # A label may look like an L code.
    alike=(Alike(reason="L code", by_extension=True),),
    open_offsets=("work", "g92"),
    load_program=_load_program,
    alone=_alone,
    load_machine=_load_machine,
    own_table=OwnTable(name="din", usual=_usual_settings, whole=_machine_from),
    setup_table="resident",
    setup_fields=_setup_fields,
    machine_files=("mcuwin.ini",),
    knows_machine=_knows_machine,
    completed=_completed,
    raise_program=_raise_program,
)
