"""What every command that reads a job does first: dialect, program, machine and setup, as findings or values."""

from __future__ import annotations

from pathlib import Path
from typing import TypedDict, TypeVar

from gproof.driver.dialects import DIALECTS, guess_dialect, load_machine
from gproof.driver.errors import UsageError
from gproof.driver.files import require_file, require_program
from gproof.frontend.common.frontend import Reading
from gproof.ir import codes
from gproof.ir.finding import Findings, Span
from gproof.ir.machine import NO_MACHINE, Machine
from gproof.ir.program import Call, Program
from gproof.ir.record import field, record
from gproof.ir.setup import NOTHING, ZERO, Setup

T = TypeVar("T")

PLAIN_SECONDS_A_BYTE = 1e-6
"""What ``check`` takes in plain Python for a byte of source, measured by bench/kernels.py."""


@record(frozen=True, slots=True)
class Running:
    """How far a program is executed: see the options of the command line."""

    max_blocks: int | None = None
    max_branches: int = 4096
    render: bool = False
    call: str | None = None


class Options(TypedDict):
    """Keyword arguments of an Executor."""

    budget: int
    max_branches: int
    render: bool


BUDGET = 5_000_000
"""Blocks that loops may add to the lines of a job: at 200,000 a second some 25 seconds, and a hundred times what the
longest macro of a shop runs (a thousand by a thousand probed points are 4 million). docs/codes/GP233.md says so too."""


@record(slots=True, kw_only=True)
class Session:
    """A job with its surroundings. program is None when nothing of it could be read.

    inputs: (name, sha256, role) of every file read; dialect_reason: how the dialect was found.
    """

    job: Path
    dialect: str
    dialect_reason: str
    program: Program | None
    machine: Machine
    setup: Setup
    machine_given: bool
    findings: Findings = field(default_factory=Findings)
    inputs: list[tuple[str, str, str]] = field(default_factory=list)

    def options(self, running: Running) -> Options:
        """Keyword arguments of an Executor; by default it executes so many blocks that only endless loops meet it."""
        lines = self.program.line_count if self.program is not None else 0
        budget = BUDGET + 4 * lines if running.max_blocks is None else running.max_blocks
        return {"budget": budget, "max_branches": running.max_branches, "render": running.render}


def open_session(
    job: Path, *, machine: Path | None, setup: str | None, dialect: str | None, call: str | None = None
) -> Session:
    """Read everything; UsageError (exit 3) for files that cannot be read at all."""
    require_program(job, "job")
    findings = Findings()
    inputs: list[tuple[str, str, str]] = []
    the_machine, the_setup = NO_MACHINE, NOTHING
    if machine is not None:
        require_file(machine, "machine file")
        the_machine = _loaded(load_machine(machine, findings), findings, inputs, "machine", machine)
    dialect, reason = dialect_of(job, dialect, the_machine, machine)
    if setup == "zero":
        the_setup = ZERO
    elif setup is not None:
        from gproof.driver.dialects import load_setup

        if setup.lower() == "zero" and not Path(setup).exists():
            raise UsageError(f"setup file {setup}: no such file; did you mean --setup zero?")
        require_file(Path(setup), "setup file")
        the_setup = _loaded(load_setup(Path(setup), findings, the_machine), findings, inputs, "setup", setup)
    from gproof.ir.kernel import Kernel

    Kernel.forecast(job.stat().st_size * PLAIN_SECONDS_A_BYTE)
    files = [Path(name) for name, _, role in inputs if role == "machine"]
    program, the_machine = DIALECTS[dialect].frontend.load_program(
        Reading(
            job=job, findings=findings, machine=the_machine, machine_file=machine, read=files, call=call or "",
        )
    )  # fmt: skip
    if program is not None and call is not None:
        _call_only(program, call, job)
    elif program is not None and not program.body and program.subprograms:
        inside = (sub.span for sub in program.subprograms.values() if sub.span.file == str(job))
        first = min(inside, key=lambda span: span.line, default=Span(str(job), 1))
        findings.add(codes.ONLY_SUBPROGRAMS.at(first, hint=f"check one of them with --call {min(program.subprograms)}"))
    if program is not None:
        settings = {name for name, _, role in inputs if role == "machine"}
        inputs += [(f.name, f.sha256, "source") for f in program.files if f.name not in settings]
    return Session(
        job=job, dialect=dialect, dialect_reason=reason, program=program, machine=the_machine, setup=the_setup,
        machine_given=machine is not None, findings=findings, inputs=inputs,
    )  # fmt: skip


def _call_only(program: Program, name: str, job: Path) -> None:
    """Make the program one call of a subprogram; UsageError when no subprogram has that name."""
    if name.lower() not in program.subprograms:
        known = ", ".join(sorted(program.subprograms))
        there = f"it has {known}" if known else "it has no subprograms"
        raise UsageError(f"{job}: no subprogram {name!r}; {there}")
    sub = program.subprograms[name.lower()]
    program.body = (Call(name=sub.name, span=sub.span),)


def dialect_of(
    job: Path, given: str | None, machine: Machine = NO_MACHINE, machine_file: Path | None = None
) -> tuple[str, str]:
    """The language and how it is known: the option, the machine file, else a guess from name and content.

    UsageError for a language that this version does not read.
    """
    if given is not None:
        dialect, reason = given, "given by --dialect"
    elif machine.controller.dialect is not None:
        dialect, reason = machine.controller.dialect, f"from machine file {machine_file}"
    else:
        dialect, guessed = guess_dialect(job)
        reason = f"detected: {guessed}"
    if dialect not in DIALECTS:
        known = ", ".join(DIALECTS)
        raise UsageError(f"{job}: cannot read {dialect} ({reason}); choose one of {known} with --dialect")
    return dialect, reason


def _loaded(
    result: tuple[T | None, list[tuple[str, str]]], findings: Findings, inputs: list[tuple[str, str, str]], role: str,
    name: Path | str,
) -> T:  # fmt: skip
    """Unpack (value or None, files); a file with errors stops the command with its findings."""
    value, files = result
    inputs += [(name, digest, role) for name, digest in files]
    if value is None:
        raise UsageError(f"{role} file {name}: cannot be used, see the errors above", findings)
    return value
