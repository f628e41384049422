"""From a judgement to what a check says in the end: the shop's policy, what somebody accepts, the exit code."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from gproof.driver.judge import Beat, Judgement, Observer, in_spite_of, judge
from gproof.driver.policy import NO_POLICY, Policy, fails, under
from gproof.driver.session import Running, Session
from gproof.driver.suppressions import MANY, Baseline, Known, accept_comments, known_findings, may_accept
from gproof.ir.finding import Finding, Severity
from gproof.ir.record import record
from gproof.ir.verdict import Verdict
from gproof.passes.checks.registry import every_property


@record(frozen=True, slots=True, kw_only=True)
class Asked:
    """What the user asks of a job besides its verdict.

    also: properties that the command line requires, which are in the policy already;
    new_baseline: the folder of a baseline that will be written, None: of none; fail_on: as the command line
    says, which is in the policy already; strict: as the command line or the job file says, in addition to the policy's.
    """

    policy: Policy = NO_POLICY
    baseline: Baseline | None = None
    new_baseline: Path | None = None
    fail_on: str | None = None
    strict: bool = False
    also: tuple[str, ...] = ()


def conclude(
    session: Session, asked: Asked, *, running: Running, observe: Observer | None = None, beat: Beat | None = None
) -> tuple[Judgement, int, Known]:
    """Judge a job; the judgement with what is accepted, the exit code, and what a new baseline says of the job.

    0 is SAFE without findings that fail the policy, or all that speaks against it is accepted. What an accepted error
    leaves open is found too, and is accepted by itself or not at all.
    """
    limit = session.findings.limit
    if asked.baseline is not None or asked.new_baseline is not None or may_accept(session.program):
        session.findings.limit = MANY
    judgement = judge(
        session, running=running, properties=asked.policy.properties, strict=asked.strict or asked.policy.strict,
        observe=observe, beat=beat,
    )  # fmt: skip
    judgement = under(asked.policy, judgement, session.job)
    if session.program is not None:
        for finding in accept_comments(session.program, judgement):
            weighed = asked.policy.weighed(finding)
            if weighed is not None:
                judgement.findings.add(weighed)
    if asked.baseline is not None:
        asked.baseline.accept(judgement)
        errors = [finding for finding in judgement.accepted if finding.severity is Severity.ERROR]
        more = in_spite_of(session, judgement, errors, running=running, properties=asked.policy.properties, beat=beat)
        for weighed in filter(None, map(asked.policy.weighed, more)):
            judgement.findings.add(weighed)
        if more:
            asked.baseline.accept(judgement)
    code = _exit_code(judgement, asked.policy)
    known = {} if asked.new_baseline is None else known_findings(judgement, asked.new_baseline)
    judgement.findings = judgement.findings.shortened(limit, judgement.accepted)
    return judgement, code, known


def _exit_code(judgement: Judgement, policy: Policy) -> int:
    findings, accepted = judgement.findings, judgement.accepted
    left = [finding for finding in findings.kept if finding not in accepted]
    if judgement.verdict is Verdict.SAFE:
        return Verdict.UNSAFE.exit_code if fails(policy, left) else 0
    if not accepted or not _all_accepted(judgement, policy, left):
        return _left_verdict(judgement, policy, left).exit_code
    return Verdict.UNSAFE.exit_code if fails(policy, left) else 0


def _left_verdict(judgement: Judgement, policy: Policy, left: list[Finding]) -> Verdict:
    """The verdict, UNKNOWN where all that makes it UNSAFE is accepted: what follows an accepted error is not known."""
    findings = judgement.findings
    errors = [finding for finding in judgement.accepted if finding.severity is Severity.ERROR]
    said = {"language" if finding.code.decides == "files" else finding.code.decides for finding in errors}
    refuted = {r.name for r in judgement.properties if r.verdict is Verdict.UNSAFE and r.name in policy.properties}
    fails = any(finding.severity is Severity.ERROR for finding in left) or not refuted <= said
    fails = fails or any(findings.hidden(finding.code) for finding in errors)
    return judgement.verdict if fails else Verdict.UNKNOWN


def _all_accepted(judgement: Judgement, policy: Policy, left: list[Finding]) -> bool:
    """Whether all that keeps the verdict from SAFE is accepted: each finding, and no answer without one."""
    weighty = (Severity.ERROR, Severity.UNKNOWN)
    if any(finding.severity in weighty for finding in left):
        return False
    findings = judgement.findings
    if any(findings.hidden(f.code) for f in judgement.accepted if f.severity in weighty):
        return False
    language = next(result for result in judgement.properties if result.name == "language")
    if language.verdict is not Verdict.SAFE or judgement.summary.open_path:
        # The others rest on it, or on the finding that leaves open where the tool goes.
        return True
    said = {finding.code.decides for finding in judgement.accepted if finding.severity in weighty}
    return all(
        result.verdict is Verdict.SAFE or result.name in said
        for result in judgement.properties
        if result.name in policy.properties
    )


def with_options(
    policy: Policy, *, fail_on: str | None, warnings_are_errors: bool, also: Sequence[str] = ()
) -> Policy:  # fmt: skip
    """A policy with what the command line, or a job file, says; also: properties beyond the policy's."""
    return replace(
        policy,
        properties=tuple(dict.fromkeys((*policy.properties, *(every_property() if "all" in also else also)))),
        fail_on=fail_on or policy.fail_on,
        warnings_are_errors=warnings_are_errors or policy.warnings_are_errors,
    )
