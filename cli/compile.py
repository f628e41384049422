"""``gproof compile``: a job to a certified step stream, and the lowering that ``dump`` shows."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import click

from gproof.cli.judge import NOT_JUDGED, judge
from gproof.cli.main import UsageError
from gproof.cli.report import print_findings
from gproof.cli.session import Session, open_session
from gproof.ir.finding import Severity
from gproof.ir.plan import Plan
from gproof.ir.stream import StepStream
from gproof.ir.trace import Trace
from gproof.ir.verdict import Verdict


@dataclass(slots=True, kw_only=True)
class Lowered:
    """The stages of a job; None from the first one that could not be reached."""

    trace: Trace
    plan: Plan | None = None
    stream: StepStream | None = None


def lower(session: Session, budget: int, stage: str) -> Lowered:
    """Trace, then plan, then stream, as far as ``stage``; every stage verified."""
    from gproof.passes.execute import execute

    assert session.program is not None
    trace = execute(
        session.program, session.setup, session.machine, session.findings, budget=budget,
        block_delete=bool(session.setup.block_delete),
    )  # fmt: skip
    trace.verify()
    lowered = Lowered(trace=trace)
    if stage == "trace" or session.findings.has(Severity.ERROR):
        return lowered
    from gproof.passes.plan import plan

    lowered.plan = plan(trace, session.machine, session.findings)
    if lowered.plan is None or stage == "plan":
        return lowered
    lowered.plan.verify()
    from gproof.passes.step import step

    lowered.stream = step(trace, lowered.plan, session.machine, session.setup, session.findings)
    if lowered.stream is not None:
        lowered.stream.verify()
    return lowered
