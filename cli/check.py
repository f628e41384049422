"""``gproof check``: one job or several, as text or as a report for other programs."""

from __future__ import annotations

import contextlib
import io
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import click

from gproof.cli.many import How, judge_all, print_text, with_progress
from gproof.cli.progress import progress
from gproof.cli.telling import tell, tell_findings_of
from gproof.driver.conclude import Asked, conclude, with_options
from gproof.driver.errors import UsageError
from gproof.driver.escape import in_one_line
from gproof.driver.files import require_picture, require_place, write_text
from gproof.driver.jobs import find_jobs, is_several
from gproof.driver.outcome import Outcome, closing_line, counted, exit_code
from gproof.driver.policy import NO_POLICY, load_policy
from gproof.driver.session import Running, open_session
from gproof.driver.suppressions import read_baseline, write_baseline
from gproof.ir.trace import Chunk
from gproof.report.escape import json_text
from gproof.report.formats import DOCUMENTS
from gproof.report.summary import print_brief, print_summary, report_for_people, report_json
from gproof.report.text import coloured
from gproof.report.units import CHOICES


def run_check(
    names: Sequence[str], *, machine: Path | None, setup: str | None, dialect: str | None, running: Running, form: str,
    strict: bool, picture: Path | None, units: str | None, output: Path | None, quiet: bool, workers: int | None,
    exclude: Sequence[str], policy: Path | None, fail_on: str | None, warnings_are_errors: bool,
    baseline: Path | None, new_baseline: Path | None, also: tuple[str, ...] = (), reports: Sequence[str] = (),
    every: bool = False,
) -> int:  # fmt: skip
    """Judge jobs, print or write reports in ``units``, write picture and baseline; returns the exit code."""
    more = further_reports(reports, output)
    places = [(output, "report"), (new_baseline, "baseline"), *((place, "report") for _, place in more)]
    for place, what in places:
        if place is not None:
            require_place(place, what, (*names, machine, setup, policy))
    asked = Asked(
        policy=with_options(
            NO_POLICY if policy is None else load_policy(policy, tell),
            fail_on=fail_on,
            warnings_are_errors=warnings_are_errors,
            also=also,
        ),
        baseline=None if baseline is None else read_baseline(baseline),
        new_baseline=None if new_baseline is None else new_baseline.parent,
        fail_on=fail_on,
        strict=strict,
        also=also,
    )
    if form in ("text", "json") and new_baseline is None and not is_several(names) and not exclude:
        with _into(output), _written(more, names[0], every) as told:
            return _check_one(
                Path(names[0]), machine=machine, setup=setup, dialect=dialect, running=running, form=form,
                asked=asked, picture=picture, units=units, quiet=quiet, told=told,
                every=every,
            )  # fmt: skip
    if picture is not None:
        raise UsageError("--picture draws one program; it needs one JOB and --format text or json")
    if running.call is not None and is_several(names):
        raise UsageError("--call takes one program, not several jobs")
    how = How(
        running=running, asked=asked, form=form, units=units, quiet=quiet, tty=output is None and coloured(),
        every=every,
    )  # fmt: skip
    jobs = find_jobs(names, tell, machine=machine, setup=setup, dialect=dialect, exclude=exclude)
    outcomes = with_progress(judge_all(jobs, how, workers), len(jobs))
    kept = _told(outcomes, form, output, every)
    _write(more, kept, every)
    if new_baseline is None:
        return exit_code(kept)
    if any(outcome.problem for outcome in kept):
        raise UsageError(f"baseline {new_baseline}: not written, because some jobs could not be checked")
    count = write_baseline(new_baseline, [outcome.known for outcome in kept])
    click.echo(
        f"{in_one_line(str(new_baseline))}: {counted(count, 'finding')} written, known from now on (--baseline)",
        err=True,
    )
    return 0


def _told(outcomes: Iterator[Outcome], form: str, output: Path | None, every: bool) -> list[Outcome]:
    """Print the outcomes, or write them to a file; all of them."""
    if form == "text":
        with _into(output):
            kept = print_text(outcomes)
            if len(kept) > 1:
                click.echo(closing_line(kept))
        return kept
    kept = list(outcomes)
    for outcome in kept:
        if outcome.problem:
            for line in outcome.text:
                click.echo(line, err=True)
            click.echo(f"gproof: error: {in_one_line(outcome.problem)}", err=True)
    with _into(output):
        click.echo(DOCUMENTS[form](kept, every))
    return kept


def further_reports(names: Sequence[str], output: Path | None) -> list[tuple[str, Path]]:
    """What each ``--report FORMAT=FILE`` requests; UsageError for one that is none, and for a file named twice."""
    asked: list[tuple[str, Path]] = []
    for name in names:
        form, _, file = name.partition("=")
        if form not in DOCUMENTS or not file:
            raise UsageError(f"--report {name}: must be FORMAT=FILE; FORMAT is one of {', '.join(DOCUMENTS)}")
        place = Path(file)
        if place == output or any(place == other for _, other in asked):
            raise UsageError(f"--report {name}: another report is written to this file already")
        asked.append((form, place))
    return asked


def _write(
    reports: Sequence[tuple[str, Path]], outcomes: list[Outcome], every: bool, *, single: bool = False
) -> None:  # fmt: skip
    """Write further reports; single: of one job, as ``--format`` alone prints it."""
    for form, place in reports:
        (only, *_) = outcomes
        if single and form == "json" and only.report is not None:
            text = json_text(only.report, indent=2)
        else:
            text = DOCUMENTS[form](outcomes, every)
        write_text(place, text + "\n", "report")


@contextlib.contextmanager
def _written(reports: Sequence[tuple[str, Path]], job: str, every: bool) -> Iterator[list[Outcome] | None]:
    """Where the outcome of a single job goes; its reports are written at the end, those of one not judged too."""
    if not reports:
        yield None
        return
    told: list[Outcome] = []
    try:
        yield told
    except UsageError as error:
        tell_findings_of(error)
        _write(reports, [Outcome(job=job, problem=error.message)], every)
        raise UsageError(error.message) from None
    _write(reports, told, every, single=True)


@contextlib.contextmanager
def _into(output: Path | None) -> Iterator[None]:
    """What is printed inside goes to a file, whole or not at all."""
    if output is None:
        yield
        return
    text = io.StringIO()
    with contextlib.redirect_stdout(text):
        yield
    write_text(output, text.getvalue(), "report")


def _check_one(
    job: Path, *, machine: Path | None, setup: str | None, dialect: str | None, running: Running, form: str,
    asked: Asked, picture: Path | None, units: str | None, quiet: bool, told: list[Outcome] | None,
    every: bool,
) -> int:  # fmt: skip
    if picture is not None:
        require_place(picture, "picture", (job, machine, setup))
        require_picture(picture)
    drawing = None
    with progress("reading") as shown:
        session = open_session(job, machine=machine, setup=setup, dialect=dialect, call=running.call)
        if picture is not None:
            from gproof.report.picture.sheet import Drawing

            drawing = Drawing(session.machine)
        shown.phase("checking", None if session.program is None else session.program.line_count)
        observe = _observers(shown.see if shown.wanted else None, None if drawing is None else drawing.add)
        beat = shown.beat if shown.wanted else None
        judgement, code, _ = conclude(session, asked, running=running, observe=observe, beat=beat)
        if drawing is not None and picture is not None:
            shown.phase("drawing")
            drawing.write(picture, session, judgement, units)
    report = report_json(session, judgement, code) if form == "json" or told is not None else None
    if told is not None:
        read = report_for_people(session, judgement, code, units)
        told.append(Outcome(job=str(job), report=report, read=read, code=code))
    if form == "json":
        click.echo(json_text(report, indent=2))
    elif quiet:
        print_brief(session, judgement, code, units, quiet=True)
    else:
        print_summary(
            session, judgement, findings=True, unit=None if units is None else CHOICES[units], code=code, every=every
        )
    return code


def _observers(*wanted: Callable[[Chunk], None] | None) -> Callable[[Chunk], None] | None:
    parts = [f for f in wanted if f is not None]
    if not parts:
        return None

    def observe(chunk: Chunk) -> None:
        for part in parts:
            part(chunk)

    return observe
