"""What ``gproof verify`` finds out about a package that is read, with its verdict."""

from __future__ import annotations

from collections.abc import Iterable

from gproof.driver.at_hand import AtHand
from gproof.ir.finding import Finding, Findings, Severity
from gproof.ir.record import record
from gproof.ir.verdict import Verdict
from gproof.verify.certificate.check import Check
from gproof.verify.certificate.measured import taken
from gproof.verify.certificate.package import Package
from gproof.verify.certificate.signers import Signer


def verdict_of(findings: Iterable[Finding]) -> Verdict:
    """What findings come to: UNSAFE with an error, UNKNOWN with something that is not known, else SAFE."""
    severities = {finding.severity for finding in findings}
    if Severity.ERROR in severities:
        return Verdict.UNSAFE
    return Verdict.UNKNOWN if Severity.UNKNOWN in severities else Verdict.SAFE


@record(frozen=True, slots=True, kw_only=True)
class Verified:
    """A package with its verdict.

    findings: with those of the source at hand
    compared: what was at hand
    taken: what measured offsets are taken for
    pure: the steps were proved without compiled code
    """

    package: Package
    check: Check
    verdict: Verdict
    findings: tuple[Finding, ...]
    trusted: tuple[Signer, ...]
    compared: tuple[str, ...]
    taken: tuple[str, ...] = ()
    pure: bool = False

    @property
    def conditional(self) -> bool:
        """SAFE, while conditions hold of which no setup states anything."""
        return self.verdict is Verdict.SAFE and bool(self.check.conditions)


def verified(
    package: Package, check: Check, at_hand: AtHand, other: Iterable[Finding], findings: Findings, *,
    anew: bool, trusted: tuple[Signer, ...], pure: bool,
) -> Verified:  # fmt: skip
    """A package with its verdict: of what was found in it, and of what differs from the files at hand.

    A condition of which no setup states anything (``check.open``) decides nothing, and is a finding only where
    something else refutes the package.

    other: what differs from the source at hand, or from the source compiled again
    findings: those of the files at hand; the others are added
    anew: whether the source was compiled again
    """
    found = (*other, *check.findings)
    verdict = verdict_of(finding for finding in found if finding not in check.open)
    for finding in found:
        if verdict is Verdict.UNSAFE or finding not in check.open:
            findings.add(finding)
    compared = {
        "machine": at_hand.machine is not None, "setup": at_hand.setup is not None,
        "source": at_hand.source is not None, "source compiled again": anew,
    }  # fmt: skip
    return Verified(
        package=package, check=check, verdict=verdict, findings=tuple(findings.kept), trusted=trusted,
        compared=tuple(name for name, there in compared.items() if there), taken=tuple(taken(package, at_hand.setup)),
        pure=pure,
    )  # fmt: skip
