"""``gproof resume``: a new program that goes on with a job in its middle, and its package."""

from __future__ import annotations

from pathlib import Path

import click

from gproof.driver.errors import UsageError
from gproof.driver.escape import in_one_line
from gproof.driver.files import require_file, require_other, require_place
from gproof.driver.session import Running


def run_resume(
    job: Path, *, machine: Path, setup: str, dialect: str | None, from_line: int | None, from_journal: Path | None,
    output: Path, package: Path | None,
) -> int:  # fmt: skip
    """Write the program, say what it does, and compile it where a package is wanted."""
    from gproof.cli.compile import run_compile
    from gproof.driver.pipeline import Request
    from gproof.driver.resume import resume

    if (from_line is None) == (from_journal is None):
        raise UsageError("give one of --from-line and --from-journal")
    require_file(job, "job")
    for place, what in ((output, "output"), (package, "package")):
        if place is not None:
            require_place(place, what, (job, machine))
            if place.exists():
                raise UsageError(f"{what} {place}: already exists; choose another name")
    require_other(output, "output", package, "--package")
    notes: list[str] = []
    if from_journal is not None:
        from_line = _line_of(from_journal, job, notes)
    assert from_line is not None
    made = resume(job, from_line, output, machine=machine, setup=setup, dialect=dialect, running=Running())
    at = ", ".join(f"{letter} {value:.4f}" for letter, value in made.start.at)
    lines = [
        f"{output}: goes on with {job} at line {from_line}",
        f"  again       {made.rows} of {made.of} steps of execution, the same as in the job",
        f"  way there   up to Z {made.start.top:g}, across, down to Z {made.start.plane:g} at rapid, the rest at feed",
        f"  starts at   {at} ({'from a zero that is not known' if made.start.work else 'machine coordinates'})",
        *(f"  {note}" for note in (*notes, *made.resumed.notes)),
    ]
    for line in lines:
        click.echo(in_one_line(line))
    if package is None:
        click.echo(in_one_line(f"  next        gproof compile {output}: every check, and a certificate of its own"))
        return 0
    request = Request(
        job=output, machine=machine, setup=setup, dialect=dialect, running=Running(), output=package, key=None,
        unsigned=False, also=(),
    )  # fmt: skip
    return run_compile(request)


def _line_of(journal: Path, job: Path, notes: list[str]) -> int:
    """The line at which a run was left, by its journal; UsageError where that is not known."""
    from gproof.backend.journal import read_journal
    from gproof.driver.at_hand import other_source, read_at_hand
    from gproof.driver.run_status import RUNNING, status_of
    from gproof.ir.finding import Findings
    from gproof.verify.certificate.package import CertificateError, read_package

    require_file(journal, "journal")
    try:
        found = read_journal(journal)
        if not found.entries and found.damaged:
            raise UsageError(f"{journal}: not a journal, or damaged from its start; use --from-line")
        status = status_of(journal, None)
        package = read_package(Path(found.field("package"))) if found.entries else None
    except (OSError, CertificateError) as error:
        raise UsageError(f"{journal}: {error}; use --from-line") from None
    record, place = status.record, status.place
    if package is None or record is None or not record.sections:
        raise UsageError(f"{journal}: nothing was executed; run the job from its start")
    if status.state == RUNNING:
        raise UsageError(f"{journal}: the run goes on")
    if status.contradiction:
        raise UsageError(f"{journal}: {status.contradiction}; use --from-line")
    if record.result.value == "completed":
        raise UsageError(f"{journal}: the program's end was reached; nothing is left")
    if place is None:
        raise UsageError(f"{journal}: the line is not known ({'; '.join(status.notes)}); use --from-line")
    if other_source(package, read_at_hand(package, Findings(), machine=None, setup=None, source=job)):
        raise UsageError(f"{job}: not the program that was run; use --from-line")
    first, last = place.from_line[1], place.to_line[1]
    again = f"line {first}" if first == last else f"lines {first} to {last}"
    notes.append(f"overlap     {again}: may have been executed already, in part or completely")
    known = "where the axes are is not known: " if status.position is None else ""
    notes.append(f"first       {known}home the machine")
    return first
