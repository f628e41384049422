"""A package as the runtime uses it: checked again, then taken apart."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import replace

from gproof.backend.record_data import ALLOWED, ANY_SIGNER, TRUSTED
from gproof.ir import codes
from gproof.ir.finding import Finding, Severity
from gproof.ir.machine import Machine
from gproof.ir.record import record
from gproof.ir.setup import Setup
from gproof.ir.stream import StepStream
from gproof.ir.trace import Trace
from gproof.verify.certificate.check import check_package
from gproof.verify.certificate.measured import moved_to
from gproof.verify.certificate.package import Package
from gproof.verify.certificate.signers import Trusted


def identity_of(certificate: str) -> bytes:
    """32 bytes that stand for a certified stream: SHA-256 of its certificate's body, which names it."""
    try:
        found = bytes.fromhex(certificate)
    except ValueError:
        found = b""
    return found if len(found) == hashlib.sha256().digest_size else hashlib.sha256(certificate.encode()).digest()


class RunRefused(Exception):
    """Nothing was moved; ``findings`` say why."""

    def __init__(self, findings: Sequence[Finding]) -> None:
        super().__init__("; ".join(f.message for f in findings))
        self.findings = tuple(findings)


@record(frozen=True, slots=True, kw_only=True)
class CertifiedJob:
    """name: the source file; certificate: SHA-256 of the certificate's body; the rest is what it certifies.

    accepted: why it may run (``record_data.TRUSTED`` …); signer: the public key that signed it, in base64, or nobody;
    machine_at_hand, setup_at_hand: it was held against those, and not against what the package says of them alone.
    """

    name: str
    certificate: str
    trace: Trace
    machine: Machine
    setup: Setup
    stream: StepStream
    accepted: str = ANY_SIGNER
    signer: str = ""
    machine_at_hand: bool = False
    setup_at_hand: bool = False

    def overridable(self, number: int) -> bool:
        """False when a row of the section was programmed without overrides."""
        rows = self.trace.sections[number].rows
        used = set(rows["state"][rows["op"] < 10].tolist())
        return all(self.trace.states[state].overrides for state in used)


def job_of(package: Package) -> CertifiedJob:
    """The parts of a package, believed as they are; for a package that shall run see ``checked_job``."""
    return CertifiedJob(
        name=str(package.body.get("job", package.path)),
        certificate=package.sha256,
        trace=package.trace,
        machine=package.machine,
        setup=package.setup,
        stream=package.stream,
    )


def job_from(package: Package, start: Sequence[int]) -> CertifiedJob:
    """The same where the motors started at these steps, which are the measured offsets' doing where there are any."""
    job, moved = job_of(package), moved_to(package, start)
    return job if moved is None else replace(job, trace=moved.trace, stream=moved.stream)


def checked_job(
    package: Package,
    *,
    machine: Machine | None = None,
    setup: Setup | None = None,
    trusted_keys: Trusted = None,
    allow_untrusted: bool = False,
) -> CertifiedJob:
    """The parts of a package that holds here and now; RunRefused with all findings otherwise.

    machine, setup, trusted_keys: as for ``check_package``; allow_untrusted: that nobody trusted has signed it (GP827)
    is no reason against, and the job says that it was none. Of a job with open offsets Trace and stream are those at
    the offsets that the setup states.
    """
    check = check_package(package, machine, setup, trusted_keys)
    against = [f for f in check.findings if f.severity in (Severity.ERROR, Severity.UNKNOWN)]
    untrusted = [f for f in against if f.code is codes.CERTIFICATE_UNTRUSTED]
    if len(against) > len(untrusted) * allow_untrusted:
        raise RunRefused(check.findings)
    accepted = ANY_SIGNER if trusted_keys is None else ALLOWED if untrusted else TRUSTED
    job = replace(
        job_of(package), accepted=accepted, signer=check.signer or "", machine_at_hand=machine is not None,
        setup_at_hand=setup is not None,
    )  # fmt: skip
    return job if check.moved is None else replace(job, trace=check.moved.trace, stream=check.moved.stream)
