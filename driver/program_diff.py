"""Two programs of any controllers: whether they do the same, and where they part."""

from __future__ import annotations

from pathlib import Path

from gproof.driver.errors import UsageError
from gproof.driver.session import Running, Session, open_session
from gproof.driver.translation_traces import own_devices, trace_of
from gproof.ir.finding import Findings, Severity
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
    traces = []
    for session in done.sessions:
        if session.program is None:
            raise UsageError(f"{session.job}: cannot be read", session.findings)
        own = Findings()
        program = own_devices(session.program, done.assumed)
        traces.append(trace_of(program, session.setup, session.machine, own, running, session))
        for finding in (*session.findings.kept, *own.kept):
            if finding.severity in {Severity.ERROR, Severity.UNKNOWN}:
                done.findings.add(finding)
    done.traces = traces[0], traces[1]
    rules = [session.program.rules for session in done.sessions if session.program is not None]
    outputs = [session.program.spindle_outputs for session in done.sessions if session.program is not None]
    terms = TranslationTerms(
        source=first.dialect, target=second.dialect, tolerance_mm=tolerance, tolerance_deg=tolerance,
        feed_relative=1e-6, seconds=1e-6, source_outputs=outputs[0], target_outputs=outputs[1],
        source_straight=rules[0].straight_traverse, target_straight=rules[1].straight_traverse, rapids_assumed=True,
    )  # fmt: skip
    done.comparison = compare(*done.traces, terms)
    done.assumed += [one for one in done.comparison.assumptions if one not in done.assumed]
    done.verdict = done.comparison.verdict
    if done.verdict is Verdict.SAFE and len(done.findings.kept):
        done.verdict = Verdict.UNKNOWN
    return done
