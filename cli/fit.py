"""``gproof fit``: for which work offsets is the job SAFE, where are they now, and how large a machine does it need."""

from __future__ import annotations

import json
from pathlib import Path

import click

from gproof.cli.files import require_picture, require_place
from gproof.cli.fit_answer import fit_of, travel_of
from gproof.cli.fit_open import opened
from gproof.cli.fit_report import Told, print_fit, report_json
from gproof.cli.fit_zones import ZoneWatch
from gproof.cli.judge import judge
from gproof.cli.main import UsageError
from gproof.cli.session import Running, open_session


def run_fit(
    job: Path, *, machine: Path | None, setup: str | None, dialect: str | None, running: Running, form: str,
    units: str | None, picture: Path | None,
) -> int:  # fmt: skip
    """Judge the job with its work offsets open, and as they were stated; print the answer; returns the exit code."""
    if machine is None:
        raise UsageError("fit needs a machine: --machine FILE says what limits there are")
    if picture is not None:
        require_place(picture, "picture", (job, machine, setup))
        require_picture(picture)
    session = open_session(job, machine=machine, setup=setup, dialect=dialect, call=running.call)
    other, asked = opened(session)
    watch = ZoneWatch(asked)
    judged = judge(other, running=running, hears=watch)
    stated = judge(session, running=running) if asked.anything and session.program is not None else None
    fit = fit_of(session.machine, asked, judged, stated, watch)
    travel = travel_of(session.machine, asked, judged)
    if travel is None and stated is not None:
        travel = travel_of(session.machine, asked, stated)
    told = Told(session=session, judgement=judged, stated=stated, fit=fit, travel=travel)
    if picture is not None:
        from gproof.cli.fit_picture import draw

        draw(told, picture)
    if form == "json":
        click.echo(json.dumps(report_json(told), indent=2, ensure_ascii=False))
    else:
        print_fit(told, units)
    return fit.verdict.exit_code
