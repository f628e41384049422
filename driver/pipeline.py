"""``gproof compile``: a job to a certified step stream, and the lowering that ``dump`` shows."""

from __future__ import annotations

import datetime
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from gproof.cli.main import UsageError
from gproof.cli.options import in_one_line
from gproof.cli.progress import Progress, progress
from gproof.driver.conclude import with_options
from gproof.driver.conditions import conditions_of
from gproof.driver.files import require_file, require_place
from gproof.driver.judge import Judgement, judge
from gproof.driver.key_ring import own_key_path
from gproof.driver.policy import NO_POLICY, under
from gproof.driver.session import Running, Session, open_session
from gproof.ir.finding import Severity
from gproof.ir.plan import Plan
from gproof.ir.record import record
from gproof.ir.stream import StepStream
from gproof.ir.symbols import describe
from gproof.ir.trace import Trace
from gproof.ir.verdict import Condition, Verdict
from gproof.passes.checks.registry import not_judged
from gproof.report.summary import condition_text, print_summary, unit_of_report
from gproof.report.text import print_findings

if TYPE_CHECKING:
    from gproof.report.units import LengthUnit
    from gproof.verify.certificate.measured import Open
    from gproof.verify.explain.stream_report import StreamReport


@record(slots=True, kw_only=True)
class Lowered:
    """The stages of a job; None from the first one that could not be reached.

    left_open: the offsets that are measured later, None for none; followed: what plan and stream then follow, the trace
    at their reference; not_placed: why there is no such reference, though the job rests on open offsets.
    """

    trace: Trace
    plan: Plan | None = None
    stream: StepStream | None = None
    left_open: Open | None = None
    followed: Trace | None = None
    not_placed: str = ""


def lower(
    session: Session, running: Running, stage: str, conditions: Sequence[Condition] | None = None
) -> Lowered:  # fmt: skip
    """Trace, then plan, then stream, as far as ``stage``; every stage verified.

    conditions: what open offsets are asked for: the stream is then made for a reference in the middle of it.
    """
    from gproof.passes.interpret.core.executor import execute

    assert session.program is not None
    trace = execute(
        session.program, session.setup, session.machine, session.findings, **session.options(running),
        block_delete=bool(session.setup.block_delete),
    )  # fmt: skip
    trace.verify()
    lowered = Lowered(trace=trace)
    if stage == "trace" or session.findings.has(Severity.ERROR):
        return lowered
    from gproof.passes.motion.height_compensation import follow

    if conditions is not None:
        _leave_open(session, lowered, conditions)
    followed = follow(lowered.followed or trace, session.setup, session.machine, session.findings)
    if followed is None:
        return lowered
    followed.trace.verify()
    from gproof.passes.motion.plan import plan

    planned = plan(followed.trace, followed.machine, session.findings, followed.joined, session.program.rules)
    if planned is None:
        return lowered
    planned.verify()
    lowered.plan = followed.of_job(planned)
    if stage == "plan":
        return lowered
    from gproof.passes.motion.step import step

    stream = step(followed.trace, planned, followed.machine, session.findings, followed.origin)
    if stream is not None:
        lowered.stream = followed.on_machine(stream, session.machine)
        lowered.stream.verify()
    return lowered


def _leave_open(session: Session, lowered: Lowered, conditions: Sequence[Condition]) -> None:
    """Find what the places of the job rest on, and a reference for it."""
    from gproof.verify.certificate.measured import NotPlaced, Open, places_of, put, reference

    try:
        places = places_of(lowered.trace, session.machine, session.setup)
        if places:
            values = reference(places, conditions, session.setup)
            lowered.followed = put(lowered.trace, places, values)
            lowered.left_open = Open(places=places, reference=values)
    except NotPlaced as error:
        lowered.not_placed = str(error)


STATED = "state these offsets, lengths and positions in a setup file (--setup) and compile the job with it"
"""What to do about a job that can not be put where its offsets are measured later."""


def run_compile(
    job: Path, *, machine: Path | None, setup: str | None, dialect: str | None, running: Running, output: Path,
    key: Path | None, unsigned: bool, also: tuple[str, ...] = (),
) -> int:  # fmt: skip
    """Judge, lower, validate, sign and write; a file appears only for a job that is SAFE all the way."""
    require_place(output, "output", (job, machine, setup, key))
    if key is not None and unsigned:
        raise UsageError("--key and --unsigned exclude each other")
    if key is not None:
        require_file(key, "key")
    with progress("reading") as shown:
        return _run(
            job, machine=machine, setup=setup, dialect=dialect, running=running, output=output, key=key,
            unsigned=unsigned, also=also, shown=shown,
        )  # fmt: skip


def _run(
    job: Path, *, machine: Path | None, setup: str | None, dialect: str | None, running: Running, output: Path,
    key: Path | None, unsigned: bool, also: tuple[str, ...], shown: Progress,
) -> int:  # fmt: skip
    session = open_session(job, machine=machine, setup=setup, dialect=dialect, call=running.call)
    for name, _, role in session.inputs:
        if name.encode("utf-8", "replace").decode("utf-8") != name:
            raise UsageError(f"{role} {name}: a certificate names its files in UTF-8, which this name is not")
    policy = with_options(NO_POLICY, fail_on=None, warnings_are_errors=False, also=also)
    shown.phase("checking", None if session.program is None else session.program.line_count)
    judged = judge(
        session, running=running, properties=policy.properties, observe=shown.see if shown.wanted else None,
        beat=shown.beat if shown.wanted else None,
    )  # fmt: skip
    judgement = under(policy, judged, job)
    for finding in judgement.findings.kept:
        if finding not in session.findings.times:
            session.findings.add(finding)
    if judgement.verdict is not Verdict.SAFE:
        shown.stop()
        return _refuse(session, judgement, judgement.verdict, "the job is not SAFE")
    shown.phase("planning the motion and its steps")
    asked = [condition for result in judgement.properties for condition in result.conditions]
    lowered = _quiet_lower(session, running, asked)
    findings = session.findings
    if lowered.stream is None or findings.has(Severity.UNKNOWN) or findings.has(Severity.ERROR):
        verdict = Verdict.UNSAFE if findings.has(Severity.ERROR) else Verdict.UNKNOWN
        shown.stop()
        safe = "SAFE under conditions" if conditions_of(judgement) else "SAFE"
        why = f": {lowered.not_placed}; {STATED}" if lowered.not_placed else ""
        return _refuse(session, judgement, verdict, f"the job is {safe}, but no step stream can be made of it{why}")
    from gproof.verify.stream import validate

    shown.phase("verifying every step", lowered.stream.steps())
    report = validate(
        lowered.stream, lowered.followed or lowered.trace, session.machine, session.setup, beat=shown.done
    )
    for finding in report.findings:
        findings.add(finding)
    if report.verdict is not Verdict.SAFE:
        shown.stop()
        return _refuse(session, judgement, report.verdict, "the stream checker refuses the stream")
    shown.phase("writing")
    digest, signer = _write(session, judgement, lowered, report, output, key, unsigned)
    shown.stop()
    print_findings(findings, unit=unit_of_report(session, judgement))
    seconds = sum(s.duration for s in lowered.stream.sections) / lowered.stream.tick_frequency
    count = len(lowered.stream.sections)
    sections = f"{count} section{'s' if count > 1 else ''}"
    click.echo(f"{in_one_line(str(output))}: certified, {report.steps} steps in {sections}, {seconds:.1f} s")
    for name, conditions in conditions_of(judgement).items():
        for condition in conditions:
            text = condition_text(session, condition, unit_of_report(session, judgement))
            click.echo(in_one_line(f"  if          {text} ({name})"))
    for text in _measured_later(session, lowered, unit_of_report(session, judgement)):
        click.echo(in_one_line(f"  to measure  {text}"))
    click.echo(f"  certificate {digest}")
    click.echo(in_one_line(f"  signed by   {signer}"))
    return 0


def _measured_later(session: Session, lowered: Lowered, unit: LengthUnit) -> Iterator[str]:
    """What the setup at hand has to state when the package runs, and where the axes have to stand."""
    machine = session.machine
    for place in lowered.left_open.places.values() if lowered.left_open is not None else ():
        form = describe(place.form, machine) or "machine zero"
        if place.start is None:
            yield form
            continue
        own = next(axis.unit for axis in machine.axes if axis.index == place.axis)
        at = f"{unit.place(place.start, own)} {unit.named(own)} from {form}"
        yield f"{form}, and {machine.word(place.axis)} stands {at} when the job begins"


def _quiet_lower(session: Session, running: Running, conditions: Sequence[Condition]) -> Lowered:
    """Lower with a collector of its own: judging told what executing finds already."""
    from gproof.ir.finding import Findings

    told = session.findings
    session.findings = Findings(limit=told.limit, stated=told.stated)
    lowered = lower(session, running, "stream", conditions)
    known = {(f.code.number, f.span) for f in told.kept}
    for finding in session.findings.kept:
        if (finding.code.number, finding.span) not in known:
            told.add(finding)
    session.findings = told
    return lowered


def _refuse(session: Session, judgement: Judgement, verdict: Verdict, why: str) -> int:
    print_findings(session.findings, unit=unit_of_report(session, judgement))
    print_summary(session, judgement)
    click.echo(f"gproof: nothing was written: {why}", err=True)
    return verdict.exit_code


def _write(
    session: Session, judgement: Judgement, lowered: Lowered, report: StreamReport, output: Path,
    key_path: Path | None, unsigned: bool,
) -> tuple[str, str]:  # fmt: skip
    """Sign and write the package; returns its identity and who signed it."""
    from importlib.metadata import version

    from gproof.verify.certificate.keys import load_or_create_key
    from gproof.verify.certificate.package import TooLarge
    from gproof.verify.certificate.write import write_package

    assert lowered.stream is not None
    key, signer = None, "nobody (--unsigned)"
    if not unsigned:
        place = key_path or own_key_path()
        try:
            key = load_or_create_key(place)
        except ValueError as error:
            raise UsageError(str(error)) from None
        signer = f"the key in {place}"
    now = datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds")
    try:
        digest = write_package(
            output, job=session.job.name, version=version("gproof"), inputs=session.inputs,
            properties=judgement.properties, not_judged=not_judged(r.name for r in judgement.properties),
            assumptions=judgement.assumptions,
            machine=session.machine, setup=session.setup, trace=lowered.trace, stream=lowered.stream, report=report,
            key=key, created=now, left_open=lowered.left_open,
        )  # fmt: skip
    except TooLarge as why:
        raise UsageError(f"{output}: nothing was written: {why}") from None
    return digest, signer
