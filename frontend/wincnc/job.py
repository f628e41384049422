"""A job of WinCNC: a program, or the definitions of a CNC.MAC."""

from __future__ import annotations

from gproof.frontend.common.frontend import Read, Reading
from gproof.frontend.wincnc.file_names import MACRO_FILE
from gproof.frontend.wincnc.load import load_program
from gproof.frontend.wincnc.mac_program import load_macro_file
from gproof.frontend.wincnc.machine import NO_SHOP
from gproof.ir import codes
from gproof.ir.finding import Span


def load_job(job: Reading) -> Read:
    """The program with all it calls, and the machine; without a machine file one of which nothing is known."""
    machine = NO_SHOP if job.machine_file is None else job.machine
    if job.job.name.lower() != MACRO_FILE:
        return load_program(job.job, job.findings, machine, job.machine_file, job.read), machine
    program = load_macro_file(job.job, job.findings, machine=machine)
    if program is not None and not program.body:
        job.findings.add(codes.EMPTY_PROGRAM.at(Span(str(job.job), 1)))
    return program, machine
