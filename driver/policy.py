"""What a shop asks of its jobs beyond the defaults: which properties, how much a finding weighs, what fails a check."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable
from pathlib import Path

from gproof.driver.errors import Tell, UsageError
from gproof.driver.files import require_file
from gproof.driver.judge import Judgement
from gproof.frontend.common.toml_table import TomlFile, TomlTable
from gproof.ir import codes
from gproof.ir.codes import CODES
from gproof.ir.finding import Finding, Findings, Severity, Span
from gproof.ir.record import field, record
from gproof.ir.verdict import DEFAULT_POLICY, PropertyResult, Verdict, worst
from gproof.passes.checks.registry import decided, every_property

SCHEMA = "gproof-policy/1"
FAIL_ON = ("unknown", "warning", "note")
_WEIGHTS = ("note", "warning", "unknown", "error")
_OFF = "off"


@record(frozen=True, slots=True, kw_only=True)
class Policy:
    """properties: all of which must be SAFE; severity: by number of a code, "off": not reported.

    fail_on: findings of this weight or more fail the check, whatever the verdict; strict: a SAFE with conditions
    counts as UNKNOWN; name: of the file.
    """

    properties: tuple[str, ...] = DEFAULT_POLICY
    severity: dict[int, str] = field(default_factory=dict)
    fail_on: str = "unknown"
    warnings_are_errors: bool = False
    strict: bool = False
    name: str = ""

    def weight(self, finding: Finding) -> str:
        """What a finding weighs here."""
        own = self.severity.get(finding.code.number, finding.severity.value)
        return "error" if self.warnings_are_errors and own == "warning" else own

    def weighed(self, finding: Finding) -> Finding | None:
        """The finding as it counts here; None: it is not reported."""
        weight = self.weight(finding)
        if weight == _OFF:
            return None
        if weight == finding.severity.value:
            return finding
        return dataclasses.replace(finding, code=dataclasses.replace(finding.code, severity=Severity(weight)))


NO_POLICY = Policy()


def load_policy(path: Path, tell: Tell) -> Policy:
    """The policy of a file; docs/ci.md defines the keys. UsageError, with its findings, for a bad one.

    tell: takes those of one that can be used all the same.
    """
    require_file(path, "policy file")
    findings = Findings()
    file = TomlFile(path, SCHEMA, findings)
    policy = NO_POLICY
    if file.root is not None:
        policy = _read(file.root, str(path))
        file.root.finish()
    if file.errors:
        raise UsageError(f"policy file {path}: cannot be used, see the errors above", findings)
    if findings.kept:
        tell(findings)
    return policy


def _read(root: TomlTable, name: str) -> Policy:
    severity: dict[int, str] = {}
    table = root.table("severity")
    by_name = {code.name: code for code in CODES.values()} | {code.label: code for code in CODES.values()}
    for key in table.values if table is not None else ():
        assert table is not None
        code = by_name.get(key)
        if code is None:
            table.bad(key, f"there is no finding {key!r}")
            continue
        wanted = table.text(key, (*_WEIGHTS, _OFF))
        if wanted is None:
            continue
        own = code.severity
        if own in (Severity.ERROR, Severity.UNKNOWN) and _rank(wanted) < _rank(own.value):
            what = f"{code.label} is {_an(own.value)} and decides {code.decides}; it cannot count less"
            table.bad(key, what)
            continue
        severity[code.number] = wanted
    return Policy(
        properties=_properties(root), severity=severity, fail_on=root.text("fail_on", FAIL_ON) or NO_POLICY.fail_on,
        warnings_are_errors=bool(root.boolean("warnings_are_errors")), strict=bool(root.boolean("strict")), name=name,
    )  # fmt: skip


def _properties(root: TomlTable) -> tuple[str, ...]:
    value = root.take("properties")
    if value is None:
        return DEFAULT_POLICY
    if not isinstance(value, list) or not value or not all(isinstance(name, str) for name in value):
        root.bad("properties", "must be a list of names of properties")
        return DEFAULT_POLICY
    for name in value:
        if name not in every_property():
            root.bad("properties", f"{name!r} is not one of {', '.join(every_property())}")
    if "language" not in value:
        root.bad("properties", "language is missing; every other answer depends on it")
    return tuple(dict.fromkeys(value))


def _an(severity: str) -> str:
    return f"an {severity}"


def _rank(severity: str) -> int:
    return _WEIGHTS.index(severity) if severity in _WEIGHTS else -1


def under(policy: Policy, judgement: Judgement, job: Path) -> Judgement:
    """The judgement with the weights of a policy; nothing becomes SAFE by it.

    A finding that weighs more than its code says makes the property that it decides UNSAFE or UNKNOWN.
    """
    if policy == NO_POLICY:
        return judgement
    findings = judgement.findings.as_told(policy.weighed)
    results = [_judged_again(result, findings) for result in judgement.properties]
    for name in policy.properties:
        if not decided(name):
            what = f"{name}, which this version does not check"
            findings.add(
                codes.UNSUPPORTED_CODE.at(Span(str(job), 1), code=what, hint="check the policy that requires it")
            )
            results.append(PropertyResult(name=name, verdict=Verdict.UNKNOWN))
    verdict = worst(r.verdict for r in results if r.name in policy.properties)
    left_out = tuple(r.name for r in results if r.name not in policy.properties)
    return dataclasses.replace(judgement, verdict=verdict, properties=results, findings=findings, left_out=left_out)


def _judged_again(result: PropertyResult, findings: Findings) -> PropertyResult:
    own = (result.name, "files") if result.name == "language" else (result.name,)
    if findings.has(Severity.ERROR, own):
        return dataclasses.replace(result, verdict=Verdict.UNSAFE)
    if findings.has(Severity.UNKNOWN, own) and result.verdict is Verdict.SAFE:
        return dataclasses.replace(result, verdict=Verdict.UNKNOWN)
    return result


def fails(policy: Policy, findings: Iterable[Finding]) -> bool:
    """Whether one of them weighs so much that the check fails, though the verdict may be SAFE.

    What decides a property that the policy leaves out fails nothing.
    """
    least = _rank(policy.fail_on)
    left_out = set(every_property()) - set(policy.properties)
    return any(_rank(f.severity.value) >= least for f in findings if f.code.decides not in left_out)
