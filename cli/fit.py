"""``gproof fit``: for which work offsets is the job SAFE, where are they now, and how large a machine does it need."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import click

from gproof.cli.progress import Progress, progress
from gproof.driver.errors import UsageError
from gproof.driver.files import require_picture, require_place
from gproof.driver.fit.answer import fit_of, travel_of
from gproof.driver.fit.open_offsets import opened
from gproof.driver.fit.zones import ZoneWatch
from gproof.driver.judge import judge
from gproof.driver.session import Running, Session, open_session
from gproof.ir.verdict import Verdict
from gproof.report.escape import json_text
from gproof.report.fit_report import Told, print_fit, print_machines, report_json

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
    (told,) = answers
    if picture is not None:
        from gproof.report.picture.fit import draw

        draw(told, picture)
    if form == "json":
        click.echo(json_text(report_json(told), indent=2))
    else:
        print_fit(told, units)
    return told.fit.verdict.exit_code


def _answer(job: Path, *, machine: Path, setup: str | None, dialect: str | None, running: Running) -> Told:
    """The answer for one machine."""
    with progress("reading") as shown:
        session = open_session(job, machine=machine, setup=setup, dialect=dialect, call=running.call)
        return fit_session(session, running, shown)


def fit_session(session: Session, running: Running, shown: Progress | None = None) -> Told:
    """The answer for a job that is read.

    Where no region beside zones is found, the one side of them that ``check`` finds is the answer, if it does.
    """
    seen: dict[str, Any] = {}
    if shown is not None and shown.wanted:
        shown.phase("fitting", None if session.program is None else session.program.line_count)
        seen = {"observe": shown.see, "beat": shown.beat}
    other, asked = opened(session)
    watch = ZoneWatch(asked)
    judged = judge(other, running=running, hears=watch, **seen)
    stated = judge(session, running=running, **seen) if asked.anything and session.program is not None else None
    if shown is not None:
        shown.phase("searching work zeros")
    fit = fit_of(session.machine, asked, judged, stated, watch)
    if fit.kind == "unknown" and fit.reason:
        again = judge(opened(session)[0], running=running)
        one_side = fit_of(session.machine, asked, again, stated, ZoneWatch(asked))
        if one_side.kind == "ranges":
            fit, judged = dataclasses.replace(one_side, complete=False), again
    travel = travel_of(session.machine, asked, judged)
    if travel is None and stated is not None:
        travel = travel_of(session.machine, asked, stated)
    return Told(session=session, judgement=judged, stated=stated, fit=fit, travel=travel)


def _several(job: Path, machines: Sequence[Path], answers: list[Told], form: str, units: str | None) -> int:
    """One table, or one object; 0 where some machine takes the job as it is stated."""
    verdicts = [told.fit.verdict for told in answers]
    best = next((v for v in (Verdict.SAFE, Verdict.UNKNOWN) if v in verdicts), Verdict.UNSAFE)
    if form == "json":
        reports = [
            {"machine_file": str(file), **report_json(told)} for file, told in zip(machines, answers, strict=True)
        ]
        document = {"schema": SEVERAL, "job": str(job), "exit_code": best.exit_code, "machines": reports}
        click.echo(json_text(document, indent=2))
    else:
        print_machines(job, machines, answers, units)
    return best.exit_code
