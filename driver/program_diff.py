"""Two programs of any controllers: whether they do the same, and where they part."""

from __future__ import annotations

from pathlib import Path

from gproof.driver.errors import UsageError
from gproof.driver.session import Running, Session, open_session
from gproof.driver.translation_terms import only_local, same_travel
from gproof.driver.translation_traces import own_devices, trace_of
from gproof.ir.finding import Findings, Severity
from gproof.ir.machine import AXIS_NAMES
from gproof.ir.record import field, record
from gproof.ir.trace import Trace
from gproof.ir.translation_terms import TranslationTerms
from gproof.ir.verdict import Verdict
from gproof.verify.translation.compare import compare
from gproof.verify.translation.comparison import Comparison


@record(frozen=True, slots=True, kw_only=True)
class Side:
    """One program and what it is read with: arguments of ``gproof diff``."""

    job: Path
    machine: Path | None = None
    setup: str | None = None
    dialect: str | None = None


@record(slots=True, kw_only=True)
class ProgramDiff:
    """sessions, traces: of both sides; comparison: None where one of them cannot be followed; findings: of both, by
    side, that leave the answer open or that no controller accepts."""

    sessions: tuple[Session, Session]
    verdict: Verdict = Verdict.UNKNOWN
    traces: tuple[Trace, Trace] | None = None
    comparison: Comparison | None = None
    assumed: list[str] = field(default_factory=list)
    findings: Findings = field(default_factory=Findings)


def program_diff(one: Side, other: Side, *, tolerance: float, running: Running) -> ProgramDiff:
    """Compare two programs for every work zero; tolerance: mm and degrees. UsageError for what cannot be read."""
    sides = one, other
    first, second = (
        open_session(side.job, machine=side.machine, setup=side.setup, dialect=side.dialect) for side in sides
    )
    done = ProgramDiff(sessions=(first, second))
    programs = []
    for session in done.sessions:
        if session.program is None:
            raise UsageError(f"{session.job}: cannot be read", session.findings)
        programs.append(own_devices(session.program, done.assumed))
        _keep(done, session.findings)
    rules = [session.program.rules for session in done.sessions if session.program is not None]
    outputs = [session.program.spindle_outputs for session in done.sessions if session.program is not None]
    terms = TranslationTerms(
        source=first.dialect, target=second.dialect, tolerance_mm=tolerance, tolerance_deg=tolerance,
        feed_relative=1e-6, seconds=1e-6, source_outputs=outputs[0], target_outputs=outputs[1],
        source_straight=rules[0].straight_traverse, target_straight=rules[1].straight_traverse, rapids_assumed=True,
        source_symbols=only_local(first.dialect, second.dialect),
        target_symbols=only_local(second.dialect, first.dialect),
        machine_zero_shared=same_travel(first.machine, second.machine),
        axes=frozenset(name for name in AXIS_NAMES if first.machine.axis(name) and second.machine.axis(name)),
    )  # fmt: skip
    for switch in _switches(done.sessions):
        traces = []
        for program, session in zip(programs, done.sessions, strict=True):
            own = Findings()
            traces.append(trace_of(program, session.setup, session.machine, own, running, session, block_delete=switch))
            _keep(done, own)
        done.traces = traces[0], traces[1]
        done.comparison = compare(*done.traces, terms)
        done.assumed += [one for one in done.comparison.assumptions if one not in done.assumed]
        done.verdict = done.comparison.verdict
        if done.verdict is not Verdict.SAFE:
            break
    if done.verdict is Verdict.SAFE and len(done.findings.kept):
        done.verdict = Verdict.UNKNOWN
    return done


def _keep(done: ProgramDiff, findings: Findings) -> None:
    """Mistakes and unknowns of one side."""
    for finding in findings.kept:
        if finding.severity in {Severity.ERROR, Severity.UNKNOWN}:
            done.findings.add(finding)


def _switches(sessions: tuple[Session, Session]) -> tuple[bool | None, ...]:
    """Positions of the switch for block delete: both, where a setup does not state it and a line may have a slash."""
    open_ = any(session.setup.block_delete is None for session in sessions)
    files = [file for session in sessions if session.program is not None for file in session.program.files]
    return (False, True) if open_ and any(b"/" in bytes(file.data) for file in files) else (None,)
