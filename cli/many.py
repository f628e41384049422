"""``gproof check`` of several jobs: each in turn or some at once, always in the order they were named."""

from __future__ import annotations

import contextlib
import io
import os
import signal
from collections.abc import Iterator, Sequence
from dataclasses import replace

import click

from gproof.cli.progress import progress
from gproof.cli.telling import tell, tell_findings_of
from gproof.driver.conclude import Asked, conclude, with_options
from gproof.driver.errors import UsageError
from gproof.driver.escape import in_one_line
from gproof.driver.jobs import ListedJob
from gproof.driver.outcome import Outcome
from gproof.driver.policy import load_policy
from gproof.driver.session import Running
from gproof.ir.record import record

WORTH_A_PROCESS = 3_000_000
"""Bytes of programs below which another process costs more than it saves: it imports everything first."""


@record(frozen=True, slots=True, kw_only=True)
class How:
    """How jobs are judged and shown. form: of the report; units: of a text; tty: whether text goes to a terminal;
    every: repeats one by one."""

    running: Running
    asked: Asked
    form: str = "text"
    units: str | None = None
    quiet: bool = False
    tty: bool = False
    every: bool = False


class _Text(io.StringIO):
    """A text that is a terminal where the standard output is one, so that it is coloured alike."""

    def __init__(self, tty: bool) -> None:
        super().__init__()
        self._tty = tty

    def isatty(self) -> bool:
        return self._tty


def judge_one(job: ListedJob, how: How) -> Outcome:
    """Judge a job; one that cannot be judged is an outcome too."""
    from gproof.driver.session import open_session
    from gproof.report.summary import print_brief, report_for_people, report_json

    text, errors = _Text(how.tty), _Text(False)
    try:
        with contextlib.redirect_stdout(text), contextlib.redirect_stderr(errors):
            session = open_session(job.path, machine=job.machine, setup=job.setup, dialect=job.dialect)
            judgement, code, known = conclude(session, _asked(job, how.asked), running=how.running)
            if how.form == "text":
                print_brief(session, judgement, code, how.units, quiet=how.quiet, every=how.every)
    except UsageError as error:
        with contextlib.redirect_stderr(errors):
            tell_findings_of(error)
        told = errors.getvalue().strip()
        named = "" if job.source is None else f" (named in job file {job.source})"
        return Outcome(job=str(job.path), problem=error.message + named, text=tuple(told.splitlines()))
    return Outcome(
        job=str(job.path), report=report_json(session, judgement, code),
        read=report_for_people(session, judgement, code, how.units), text=tuple(text.getvalue().splitlines()),
        code=code, known=known,
    )  # fmt: skip


def _asked(job: ListedJob, asked: Asked) -> Asked:
    """What is asked of a job: a policy of the command line goes before that of its job file; ``also`` and ``strict``
    add up."""
    asked = replace(asked, strict=asked.strict or job.strict)
    own = job.policy is not None and not asked.policy.name
    if not own and not job.also:
        return asked
    policy = with_options(
        load_policy(job.policy, tell) if own and job.policy is not None else asked.policy, fail_on=asked.fail_on,
        warnings_are_errors=asked.policy.warnings_are_errors, also=(*asked.also, *job.also),
    )  # fmt: skip
    return replace(asked, policy=policy)


def judge_all(jobs: Sequence[ListedJob], how: How, workers: int | None) -> Iterator[Outcome]:
    """The outcome of each job, in order, as soon as it and those before it are there.

    workers: processes at most; None: as many as there are processors, where the jobs are worth it.
    """
    count = _workers(jobs) if workers is None else min(workers, len(jobs))
    if count <= 1:
        yield from (judge_one(job, how) for job in jobs)
        return
    from concurrent.futures import ProcessPoolExecutor
    from concurrent.futures.process import BrokenProcessPool
    from multiprocessing import get_context

    # Forked children would share whatever threads and locks this process has.
    # Ctrl-C reaches every process of the terminal: this one ends the others.
    deaf = signal.SIGINT, signal.SIG_IGN
    with ProcessPoolExecutor(count, mp_context=get_context("spawn"), initializer=signal.signal, initargs=deaf) as pool:
        waiting = [pool.submit(judge_one, job, how) for job in jobs]
        try:
            for job, future in zip(jobs, waiting, strict=True):
                try:
                    yield future.result()
                except BrokenProcessPool:
                    problem = f"{job.path}: the worker process ended without an answer (out of memory?); try --jobs 1"
                    yield Outcome(job=str(job.path), problem=problem)
        except KeyboardInterrupt:
            for process in list(pool._processes.values()):
                process.terminate()
            raise
        finally:
            for future in waiting:
                future.cancel()


def _workers(jobs: Sequence[ListedJob]) -> int:
    size = 0
    for job in jobs:
        with contextlib.suppress(OSError):
            size += job.path.stat().st_size
    most = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return max(1, min(most, len(jobs), 1 + size // WORTH_A_PROCESS))


def with_progress(outcomes: Iterator[Outcome], count: int) -> Iterator[Outcome]:
    """The outcomes, with a bar on standard error where that is a terminal and it takes longer than a second."""
    with progress("checking") as shown:
        shown.phase("checking", count)
        for done, outcome in enumerate(outcomes, 1):
            shown.done(done, f"checking {outcome.job}")
            yield outcome


def print_text(outcomes: Iterator[Outcome]) -> list[Outcome]:
    """Print each outcome as it comes; all of them."""
    kept = []
    for outcome in outcomes:
        for line in outcome.text:
            click.echo(line)
        if outcome.problem:
            click.echo(f"gproof: error: {in_one_line(outcome.problem)}", err=True)
        kept.append(outcome)
    return kept
