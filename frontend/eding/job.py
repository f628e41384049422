"""A job of Eding CNC with the macro files around it."""

from __future__ import annotations

import dataclasses
from pathlib import Path

from gproof.frontend.common.frontend import Read, Reading
from gproof.frontend.common.paths import is_file
from gproof.frontend.eding.load import MACRO_FILE, load_program, own_macros
from gproof.frontend.eding.long_file import judge_length
from gproof.ir.dialects.accepts import USER_MACRO_FILE
from gproof.ir.dialects.eding.settings import eding_settings
from gproof.ir.machine import Machine, Unmodelled


def load_job(job: Reading) -> Read:
    """The program, with the subprograms of its macro file, and the machine with what of them is left out."""
    macro, machine = _macro_file(job.machine, job.machine_file, job.job)
    accepts = machine.controller.accepts
    own = own_macros(job.job, macro)
    if own is not None and USER_MACRO_FILE.name not in accepts:
        why = f"{USER_MACRO_FILE.hint}: it is unknown whether this controller loads it"
        left_out = Unmodelled(own.name, why)
        machine = dataclasses.replace(machine, not_modelled=(*machine.not_modelled, left_out))
    program = load_program(job.job, job.findings, macro, call=job.call, accepts=accepts)
    if program is not None:
        judge_length(program, eding_settings(machine).super_long_file, job.findings)
    return program, machine


def _macro_file(machine: Machine, file: Path | None, job: Path) -> tuple[Path | None, Machine]:
    """The macro file that the machine names, next to its own file or the job; GP605 when it is not there.

    Without the usual one a job is judged as it is, whether the machine's file names it or not.
    """
    name = eding_settings(machine).macro_file
    if name is None or file is None:
        return None, machine
    for folder in (file.parent, job.parent):
        found = folder / name
        if is_file(found) and found.resolve() != job.resolve():
            return found, machine
    if name.lower() == MACRO_FILE:
        return None, machine
    missing = Unmodelled(f"macroFileName = {name}", "there is no such file")
    return None, dataclasses.replace(machine, not_modelled=(*machine.not_modelled, missing))
