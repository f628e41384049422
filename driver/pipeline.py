"""A job down to a certified step stream: judged, lowered, checked, signed and written. ``cli/compile.py`` says how it
went; ``dump`` shows the stages, ``verify --against`` compares what comes of it."""

from __future__ import annotations

import datetime
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from gproof.driver.conclude import with_options
from gproof.driver.conditions import conditions_of
from gproof.driver.errors import UsageError
from gproof.driver.judge import Judgement, judge
from gproof.driver.key_ring import own_key_path
from gproof.driver.policy import NO_POLICY, under
from gproof.driver.progress import Watcher
from gproof.driver.session import Running, Session, open_session
from gproof.ir.finding import Findings, Severity
from gproof.ir.plan import Plan
from gproof.ir.record import record
from gproof.ir.stream import StepStream
from gproof.ir.trace import Trace
from gproof.ir.verdict import Condition, Verdict
from gproof.passes.checks.registry import not_judged

if TYPE_CHECKING:
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

    conditions: those on open offsets: the stream is then made for a reference in the middle of it.
    """
    from gproof.driver.running import execute

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


STATED = "put these offsets, lengths and positions into a setup file and compile with --setup FILE"
"""What to do about a job that cannot be put where its offsets are measured later."""


@record(frozen=True, slots=True, kw_only=True)
class Request:
    """What to compile and where to write it: the arguments of ``gproof compile``. also: properties beyond the default
    policy; key: None for the user's own."""

    job: Path
    machine: Path | None
    setup: str | None
    dialect: str | None
    running: Running
    output: Path
    key: Path | None = None
    unsigned: bool = False
    also: tuple[str, ...] = ()


@record(frozen=True, slots=True, kw_only=True)
class NewPackage:
    """What was written: its stages, the steps that were checked, its identity and who signed it."""

    lowered: Lowered
    stream: StepStream
    steps: int
    digest: str
    signer: str


@record(frozen=True, slots=True, kw_only=True)
class Compiled:
    """How it went; the findings are those of the session. package: None where nothing was written, ``why`` says why
    then, and verdict is not SAFE."""

    session: Session
    judgement: Judgement
    verdict: Verdict
    package: NewPackage | None = None
    why: str = ""


def compile_job(request: Request, shown: Watcher) -> Compiled:
    """Judge, lower, validate, sign and write; a file appears only for a job that is SAFE all the way.

    UsageError (exit 3) for files that cannot be read or written at all.
    """
    session = open_session(
        request.job, machine=request.machine, setup=request.setup, dialect=request.dialect, call=request.running.call
    )
    for name, _, role in session.inputs:
        if name.encode("utf-8", "replace").decode("utf-8") != name:
            raise UsageError(f"{role} {name}: the file name is not UTF-8, which a certificate needs; rename the file")
    judgement = _judged(session, request, shown)
    if judgement.verdict is not Verdict.SAFE:
        return Compiled(session=session, judgement=judgement, verdict=judgement.verdict, why="the job is not SAFE")
    shown.phase("planning the motion and its steps")
    conditions = [condition for result in judgement.properties for condition in result.conditions]
    lowered = _quiet_lower(session, request.running, conditions)
    findings, stream = session.findings, lowered.stream
    if stream is None or findings.has(Severity.UNKNOWN) or findings.has(Severity.ERROR):
        verdict = Verdict.UNSAFE if findings.has(Severity.ERROR) else Verdict.UNKNOWN
        safe = "SAFE under conditions" if conditions_of(judgement) else "SAFE"
        why = f": {lowered.not_placed}; {STATED}" if lowered.not_placed else ""
        why = f"the job is {safe}, but it cannot be compiled to steps{why}"
        return Compiled(session=session, judgement=judgement, verdict=verdict, why=why)
    from gproof.verify.stream import validate

    shown.phase("verifying every step", stream.steps())
    report = validate(stream, lowered.followed or lowered.trace, session.machine, session.setup, beat=shown.done)
    for finding in report.findings:
        findings.add(finding)
    if report.verdict is not Verdict.SAFE:
        why = "the stream checker refused the stream"
        return Compiled(session=session, judgement=judgement, verdict=report.verdict, why=why)
    shown.phase("writing")
    digest, signer = _write(session, judgement, lowered, stream, report, request)
    made = NewPackage(lowered=lowered, stream=stream, steps=report.steps, digest=digest, signer=signer)
    return Compiled(session=session, judgement=judgement, verdict=Verdict.SAFE, package=made)


def _judged(session: Session, request: Request, shown: Watcher) -> Judgement:
    """The judgement of the default policy and what is requested in addition; its findings are the session's then."""
    policy = with_options(NO_POLICY, fail_on=None, warnings_are_errors=False, also=request.also)
    shown.phase("checking", None if session.program is None else session.program.line_count)
    judged = judge(
        session, running=request.running, properties=policy.properties, observe=shown.see if shown.wanted else None,
        beat=shown.beat if shown.wanted else None,
    )  # fmt: skip
    judgement = under(policy, judged, request.job)
    for finding in judgement.findings.kept:
        if finding not in session.findings.times:
            session.findings.add(finding)
    return judgement


def _quiet_lower(session: Session, running: Running, conditions: Sequence[Condition]) -> Lowered:
    """Lower with a collector of its own: judging reported what executing finds already."""
    told = session.findings
    session.findings = Findings(limit=told.limit, stated=told.stated)
    lowered = lower(session, running, "stream", conditions)
    known = {(f.code.number, f.span) for f in told.kept}
    for finding in session.findings.kept:
        if (finding.code.number, finding.span) not in known:
            told.add(finding)
    session.findings = told
    return lowered


def _write(
    session: Session, judgement: Judgement, lowered: Lowered, stream: StepStream, report: StreamReport, request: Request
) -> tuple[str, str]:  # fmt: skip
    """Sign and write the package; returns its identity and who signed it."""
    from importlib.metadata import version

    from gproof.verify.certificate.keys import load_or_create_key
    from gproof.verify.certificate.package import TooLarge
    from gproof.verify.certificate.write import write_package

    key, signer = None, "nobody (--unsigned)"
    if not request.unsigned:
        place = request.key or own_key_path()
        try:
            key = load_or_create_key(place)
        except ValueError as error:
            raise UsageError(str(error)) from None
        signer = f"the key in {place}"
    now = datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds")
    try:
        digest = write_package(
            request.output, job=session.job.name, version=version("gproof"), inputs=session.inputs,
            properties=judgement.properties, not_judged=not_judged(r.name for r in judgement.properties),
            assumptions=judgement.assumptions,
            machine=session.machine, setup=session.setup, trace=lowered.trace, stream=stream, report=report,
            key=key, created=now, left_open=lowered.left_open,
        )  # fmt: skip
    except TooLarge as why:
        raise UsageError(f"{request.output}: nothing was written: {why}") from None
    return digest, signer
