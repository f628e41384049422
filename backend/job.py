"""A package as the runtime uses it: checked again, then taken apart."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

from gproof.backend.record_data import ANY_SIGNER, TRUSTED
from gproof.ir.finding import Finding
from gproof.ir.machine import Machine
from gproof.ir.record import record
from gproof.ir.setup import Setup
from gproof.ir.stream import StepStream
from gproof.ir.trace import Trace
from gproof.verify.certificate import check_package
from gproof.verify.package import Package


class RunRefused(Exception):
    """Nothing was moved; ``findings`` say why."""

    def __init__(self, findings: Sequence[Finding]) -> None:
        super().__init__("; ".join(f.message for f in findings))
        self.findings = tuple(findings)


@record(frozen=True, slots=True, kw_only=True)
class Job:
    """name: the source file; certificate: SHA-256 of the certificate's body; the rest is what it certifies.

    accepted: why it may run (``record_data.TRUSTED`` …); signer: the public key that signed it, in base64, or nobody.
    """

    name: str
    certificate: str
    trace: Trace
    machine: Machine
    setup: Setup
    stream: StepStream
    accepted: str = ANY_SIGNER
    signer: str = ""


def job_of(package: Package) -> Job:
    """The parts of a package, believed as they are; for a package that shall run see ``checked_job``."""
    return Job(
        name=str(package.body.get("job", package.path)),
        certificate=package.sha256,
        trace=package.trace,
        machine=package.machine,
        setup=package.setup,
        stream=package.stream,
    )


def checked_job(
    package: Package,
    *,
    machine: Machine | None = None,
    setup: Setup | None = None,
    trusted_keys: Iterable[bytes] | None = None,
) -> Job:
    """The parts of a package that holds here and now; RunRefused with all findings otherwise.

    machine, setup, trusted_keys: as for ``check_package``.
    """
    check = check_package(package, machine, setup, trusted_keys)
    if not check.valid:
        raise RunRefused(check.findings)
    accepted = ANY_SIGNER if trusted_keys is None else TRUSTED
    return replace(job_of(package), accepted=accepted, signer=check.signer or "")
