"""``gproof compile``: a job to a certified step stream (``driver/pipeline.py``), and what is said of it."""

from __future__ import annotations

import contextlib
import io
from collections.abc import Iterator

import click

from gproof.cli.progress import progress
from gproof.driver.conditions import conditions_of
from gproof.driver.errors import UsageError
from gproof.driver.escape import in_one_line
from gproof.driver.files import require_file, require_place
from gproof.driver.pipeline import Compiled, NewPackage, Request, compile_job
from gproof.ir.symbols import describe
from gproof.report.summary import condition_text, print_summary, unit_of_report
from gproof.report.text import print_findings


def run_compile(request: Request) -> int:
    """Compile, print what came of it; returns the exit code."""
    require_place(request.output, "output", (request.job, request.machine, request.setup, request.key))
    if request.key is not None and request.unsigned:
        raise UsageError("--key and --unsigned cannot be used together")
    if request.key is not None:
        require_file(request.key, "key")
    with progress("reading") as shown:
        made = compile_job(request, shown)
    if made.package is None:
        _print_refused(made)
        click.echo(f"gproof: nothing was written: {made.why}", err=True)
        return made.verdict.exit_code
    print_findings(made.session.findings, unit=unit_of_report(made.session, made.judgement))
    for line in _lines(request, made, made.package):
        click.echo(in_one_line(line))
    return 0


def _print_refused(made: Compiled) -> None:
    """What keeps the job from being compiled."""
    print_findings(made.session.findings, unit=unit_of_report(made.session, made.judgement))
    print_summary(made.session, made.judgement)


def first_line(made: Compiled) -> str:
    """The first line of that, for ``gproof verify --against``."""
    said = io.StringIO()
    with contextlib.redirect_stdout(said):
        _print_refused(made)
    return next((line for line in said.getvalue().splitlines() if line.strip()), "")


def _lines(request: Request, made: Compiled, package: NewPackage) -> Iterator[str]:
    """What was written, under which conditions, and who signed it."""
    stream = package.stream
    seconds = sum(s.duration for s in stream.sections) / stream.tick_frequency
    count = len(stream.sections)
    sections = f"{count} section{'s' if count > 1 else ''}"
    yield f"{request.output}: certified, {package.steps} steps in {sections}, {seconds:.1f} s"
    unit = unit_of_report(made.session, made.judgement)
    for name, conditions in conditions_of(made.judgement).items():
        for condition in conditions:
            yield f"  if          {condition_text(made.session, condition, unit)} ({name})"
    for text in _measured_later(made, package):
        yield f"  to measure  {text}"
    yield f"  certificate {package.digest}"
    yield f"  signed by   {package.signer}"


def _measured_later(made: Compiled, package: NewPackage) -> Iterator[str]:
    """What the setup at hand must give when the package runs, and where the axes must be."""
    machine, left_open = made.session.machine, package.lowered.left_open
    unit = unit_of_report(made.session, made.judgement)
    for place in left_open.places.values() if left_open is not None else ():
        form = describe(place.form, machine) or "machine zero"
        if place.start is None:
            yield form
            continue
        own = next(axis.unit for axis in machine.axes if axis.index == place.axis)
        at = f"{unit.place(place.start, own)} {unit.named(own)} from {form}"
        yield f"{form}, with {machine.word(place.axis)} {at} at the start of the job"
