"""The machine files of both sides of a translation. Each side has its own: none stands in for another one."""

from __future__ import annotations

from pathlib import Path

from gproof.driver.dialects import DIALECTS, load_machine
from gproof.driver.errors import UsageError
from gproof.driver.files import require_file, require_program
from gproof.driver.targets import TARGETS
from gproof.ir.finding import Findings
from gproof.ir.machine import Machine
from gproof.ir.record import record

OWN_FILE = "gproof's own machine file (docs/machine-files.md)"


@record(frozen=True, slots=True, kw_only=True)
class MachineTo:
    """The machine that a program is written for. files: that it was read from, the one that was given first."""

    machine: Machine
    files: tuple[Path, ...]


def require_source(job: Path, machine: Path | None) -> None:
    """UsageError where a job, or the machine file that it is read with, is missing."""
    require_program(job, "job")
    if machine is None:
        kinds = ", ".join(TARGETS[name].machine_file for name in DIALECTS)
        raise UsageError(f"--machine FILE is missing: the machine that {job} is for ({kinds}, or {OWN_FILE})")


def machine_to(to: str, path: Path | None) -> MachineTo:
    """UsageError where there is none, or that of another controller."""
    entry = TARGETS[to]
    title = entry.target().title
    if path is None:
        kinds = f"{entry.machine_file}, or {OWN_FILE}" if entry.machine_file else OWN_FILE
        raise UsageError(f"--machine-to FILE is missing: the machine with {title} ({kinds})")
    require_file(path, "machine file")
    if not entry.machine_file and path.suffix.lower() == ".ini":
        raise UsageError(f"machine file {path}: is another controller's; {title} takes {OWN_FILE}")
    findings = Findings()
    machine, files = load_machine(path, findings)
    if machine is None:
        raise UsageError(f"machine file {path}: cannot be used, see the errors above", findings)
    stated = machine.controller.dialect
    if to in DIALECTS and stated is not None and stated != to:
        raise UsageError(f"machine file {path}: the machine has {TARGETS[stated].target().title}, not {title}")
    if machine.controller.diameter_programming and not entry.diameters:
        raise UsageError(f"machine file {path}: diameter_programming: programs for {title} have no diameters here")
    return MachineTo(machine=machine, files=tuple(dict.fromkeys((path, *(Path(name) for name, _ in files)))))
