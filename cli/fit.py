"""``gproof fit``: for which work offsets is the job SAFE, where are they now, and how large a machine does it need."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import click

from gproof.cli.progress import progress
from gproof.driver.errors import UsageError
from gproof.driver.files import require_picture, require_place
from gproof.driver.fit.fitting import Fitted, fit_session, of_machines
from gproof.driver.session import Running, open_session
from gproof.report.escape import json_text
from gproof.report.fit_report import print_fit, print_machines, report_json

SEVERAL = "gproof-fit-several/1"


def run_fit(
    job: Path, *, machines: Sequence[Path], setup: str | None, dialect: str | None, running: Running, form: str,
    units: str | None, picture: Path | None,
) -> int:  # fmt: skip
    """Judge the job with its work offsets open, and as they were stated; print the answer; returns the exit code."""
    if not machines:
        raise UsageError("fit needs --machine FILE: the travel limits are in the machine file")
    if picture is not None:
        if len(machines) > 1:
            raise UsageError("--picture draws one machine; give --machine once")
        require_place(picture, "picture", (job, machines[0], setup))
        require_picture(picture)
    answers = [_answer(job, machine=machine, setup=setup, dialect=dialect, running=running) for machine in machines]
    if len(answers) > 1:
        return _several(job, machines, answers, form, units)
    (fitted,) = answers
    if picture is not None:
        from gproof.report.picture.fit import draw

        draw(fitted, picture)
    if form == "json":
        click.echo(json_text(report_json(fitted), indent=2))
    else:
        print_fit(fitted, units)
    return fitted.fit.verdict.exit_code


def _answer(job: Path, *, machine: Path, setup: str | None, dialect: str | None, running: Running) -> Fitted:
    """The answer for one machine."""
    with progress("reading") as shown:
        session = open_session(job, machine=machine, setup=setup, dialect=dialect, call=running.call)
        return fit_session(session, running, shown)


def _several(job: Path, machines: Sequence[Path], answers: list[Fitted], form: str, units: str | None) -> int:
    """One table, or one object; 0 where some machine takes the job as it is stated."""
    best = of_machines(fitted.fit.verdict for fitted in answers)
    if form == "json":
        reports = [
            {"machine_file": str(file), **report_json(fitted)} for file, fitted in zip(machines, answers, strict=True)
        ]
        document = {"schema": SEVERAL, "job": str(job), "exit_code": best.exit_code, "machines": reports}
        click.echo(json_text(document, indent=2))
    else:
        print_machines(job, machines, answers, units)
    return best.exit_code
