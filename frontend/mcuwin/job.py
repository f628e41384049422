"""A job of McuWIN with all that it includes."""

from __future__ import annotations

from gproof.frontend.common.frontend import Read, Reading
from gproof.frontend.mcuwin.load import load_program
from gproof.frontend.mcuwin.machine import NO_MCUWIN


def load_job(job: Reading) -> Read:
    """The program, and the machine; without a machine file one of which nothing is known."""
    machine = NO_MCUWIN if job.machine_file is None else job.machine
    return load_program(job.job, job.findings, machine, job.machine_file), machine
