"""The Eding CNC dialect: programs and controller files."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gproof.frontend.common.frontend import Files, Frontend, Marker, OwnTable, Read, Reading

if TYPE_CHECKING:
    from gproof.frontend.common.alone import Alone
    from gproof.frontend.common.resuming import Resumed, Start
    from gproof.frontend.common.toml_table import TomlTable
    from gproof.ir.finding import Findings
    from gproof.ir.job import Job
    from gproof.ir.machine import Machine
    from gproof.ir.program import Program
    from gproof.ir.settings import Settings
    from gproof.ir.setup import Setup


def _load_program(job: Reading) -> Read:
    from gproof.frontend.eding.job import load_job

    return load_job(job)


def _alone(machine: Machine, machine_file: Path | None, folder: Path | None, path: Path) -> Alone:
    from gproof.frontend.common.alone import Alone
    from gproof.frontend.eding.load import load_alone

    return Alone(load_alone)


def _load_machine(
    path: Path, findings: Findings, alone: bool, anew: frozenset[tuple[str, ...]]
) -> tuple[Machine | None, Files]:
    from gproof.frontend.eding.machine_ini import load_ini

    return load_ini(path, findings)


def _setup_fields(root: TomlTable) -> dict[str, Any]:
    from gproof.frontend.eding.setup_parameters import setup_fields

    return setup_fields(root)


def _controller_keys(table: TomlTable) -> dict[str, Any]:
    from gproof.frontend.eding.machine_table import keys_of

    return keys_of(table)


def _usual_settings() -> Settings:
    from gproof.ir.dialects.eding.settings import NO_EDING_SETTINGS

    return NO_EDING_SETTINGS


def _settings_from(root: TomlTable, machine: Machine, unit: Fraction, keys: dict[str, Any]) -> Settings:
    from gproof.frontend.eding.machine_table import settings_from

    return settings_from(machine, keys)


def _raise_program(program: Program, machine: Machine, setup: Setup | None = None) -> Job:
    from gproof.frontend.eding.raising import raise_program

    return raise_program(program, machine)


def _resumed(lines: Sequence[str], start: Start) -> Resumed:
    from gproof.frontend.eding.resuming import resumed

    return resumed(lines, start)


FRONTEND = Frontend(
    name="eding",
    title="Eding CNC",
    extensions=(".cnc", ".ngc", ".nc", ".gcode", ".gc", ".g", ".ncd", ".iso", ".txt", ".eia"),
    no_jobs=(".iso", ".txt"),
    never=("macro.cnc", "user_macro.cnc"),
    settings=(("cnc.ini", "the settings of Eding CNC; give it with --machine"),),
    markers=(
        Marker(rank=10, reason="nesting line", pattern=rb"(?mi)^[ \t]*%[ \t]*[mdo][ \t]*[xy][ \t]*="),
        Marker(rank=30, reason="flow control", pattern=rb"(?mi)^[ \t]*(?:end[ \t]*(?:if|while|sub)|gosub|sub)\b"),
        Marker(rank=31, reason="numbered parameter", pattern=rb"#\d|#\["),
        Marker(rank=32, reason="message statement", pattern=rb"(?mi)^[ \t]*(?:msg|errmsg|dlgmsg|tcaguard)\b"),
        Marker(
            rank=33,
            reason="command of this controller",
            pattern=rb"(?mi)^[ \t]*(?:(?:warn|log)msg|logfile|mcaguard|tanknife|zhc\w*|home(?:tandem)?[ \t]+[a-z])\b",
        ),
    ),
    load_program=_load_program,
    alone=_alone,
    lines_of_machine=False,
    load_machine=_load_machine,
    own_table=OwnTable(
        keys=("macro_file", "super_long_file", "thread_peak"),
        read_keys=_controller_keys,
        usual=_usual_settings,
        read=_settings_from,
    ),
    setup_table="parameters",
    setup_fields=_setup_fields,
    raise_program=_raise_program,
    resumed=_resumed,
)
