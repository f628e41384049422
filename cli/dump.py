"""``gproof dump``: a job as one of the compiler's stages, in its text form."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import click

from gproof.driver.errors import UsageError
from gproof.driver.session import Running, Session, open_session
from gproof.ir.finding import Findings, Severity
from gproof.ir.notes import Notes, joined
from gproof.ir.program import Array, BlockTable, If, Program, Replaced, Statement, While
from gproof.ir.text import print_lines
from gproof.ir.trace import Trace, chunks
from gproof.ir.verdict import Verdict
from gproof.report.escape import in_strings
from gproof.report.text import print_findings

PIECE_BYTES = 1 << 20


def run_dump(
    job: Path,
    *,
    machine: Path | None,
    setup: str | None,
    dialect: str | None,
    running: Running,
    stage: str,
    form: str,
) -> int:
    """Print the stage; findings go to standard error. Exit 0 when the stage was reached without error."""
    if form == "jsonl" and stage != "trace":
        raise UsageError("--format jsonl needs --stage trace")
    session = open_session(job, machine=machine, setup=setup, dialect=dialect, call=running.call)
    if session.program is None:
        print_findings(session.findings, err=True)
        return Verdict.UNSAFE.exit_code
    if stage == "program":
        _print(loaded(session.program))
        reached = True
    elif stage == "job":
        reached = _job(session)
    elif form == "jsonl":
        reached = _jsonl(session, running)
    else:
        reached = _stages(session, running, stage)
    print_findings(session.findings, err=True)
    if session.findings.has(Severity.ERROR):
        return Verdict.UNSAFE.exit_code
    return 0 if reached and not session.findings.has(Severity.UNKNOWN) else Verdict.UNKNOWN.exit_code


def _job(session: Session) -> bool:
    """The neutral form, if the language has one; whether every construct has."""
    from gproof.driver.dialects import DIALECTS
    from gproof.ir.job import NotRaised, walk

    assert session.program is not None
    raising = DIALECTS[session.dialect].frontend.raise_program
    if raising is None:
        raise UsageError(f"--stage job: {session.dialect} has no neutral form")
    job = raising(session.program, session.machine, session.setup)
    _print(job)
    bodies = (job.body, *(routine.body for routine in job.routines.values()))
    return not any(isinstance(node, NotRaised) for body in bodies for node in walk(body))


def _print(value: object) -> None:
    for line in print_lines(value):
        click.echo(in_strings(line))


def _jsonl(session: Session, running: Running) -> bool:
    from gproof.driver.running import begin
    from gproof.passes.checks.arc_radius import ArcRadius
    from gproof.passes.motion.knife_axis import follow_knife
    from gproof.report.trace_jsonl import error_line, marked_lines

    assert session.program is not None
    early = next((f for f in session.findings.kept if f.severity is Severity.ERROR), None)
    if early is not None:
        # A program that does not parse is not started.
        click.echo(error_line(early))
        return False
    run = begin(
        session.program, session.setup, session.machine, session.findings, stop_at_error=True,
        block_delete=bool(session.setup.block_delete), **session.options(running),
    )  # fmt: skip
    arcs = ArcRadius(session.machine, session.setup, session.findings)
    for chunk in follow_knife(run.chunks(), session.machine, session.findings):
        refused = arcs.first_mismatch(chunk)
        row = None if refused is None else refused[0]
        for line in marked_lines(chunk, session.machine, str(session.job), before=row):
            click.echo(line)
        if refused is not None:
            session.findings.add(refused[1])
            click.echo(error_line(refused[1]))
            return False
    if run.failed is not None:
        click.echo(error_line(run.failed))
    return run.failed is None


def _stages(session: Session, running: Running, stage: str) -> bool:
    from gproof.driver.pipeline import lower

    lowered = lower(session, running, stage)
    taken = _takes_arcs(session, lowered.trace)
    value = getattr(lowered, stage)
    if value is not None and (stage == "trace" or taken):
        # What errors make of the trace is worth a look; a plan of it is not.
        _print(value)
        return True
    return False


def _takes_arcs(session: Session, trace: Trace) -> bool:
    """Report arcs that no controller takes, as JSON Lines do; whether all are taken."""
    from gproof.passes.checks.arc_radius import ArcRadius

    own = Findings()
    arcs = ArcRadius(session.machine, session.setup, own)
    for chunk in chunks(trace):
        arcs.feed(chunk)
    for finding in own.kept:
        if finding.severity is Severity.ERROR:
            session.findings.add(finding)
    return not own.has(Severity.ERROR)


def loaded(program: Program) -> Program:
    """The program with the words of all its tables and the notes of all its files in it."""

    def body(nodes: tuple[Statement, ...]) -> tuple[Statement, ...]:
        return tuple(one(node) for node in nodes)

    def one(node: Statement) -> Statement:
        if isinstance(node, BlockTable) and node.words is None:
            words, _, _ = program.load(node, node.begin, node.first_line, node.end - node.begin + 1)
            return dataclasses.replace(node, words=words)
        if isinstance(node, If):
            return dataclasses.replace(node, then=body(node.then), otherwise=body(node.otherwise))
        if isinstance(node, While | Array | Replaced):
            return dataclasses.replace(node, body=body(node.body))
        return node

    subs = {name: dataclasses.replace(sub, body=body(sub.body)) for name, sub in program.subprograms.items()}
    files = [dataclasses.replace(file, notes=_notes(program, number)) for number, file in enumerate(program.files)]
    return dataclasses.replace(program, files=files, body=body(program.body), subprograms=subs)


def _notes(program: Program, file: int) -> Notes:
    parts, begin, line = [], 0, 1
    while line <= program.files[file].line_count:
        notes, begin, line = program.load_notes(file, begin, line, PIECE_BYTES)
        parts.append(notes)
    return joined(parts)
