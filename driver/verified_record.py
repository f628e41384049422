"""What ``gproof verify RECORD`` finds out about an execution record that is read, with its verdict."""

from __future__ import annotations

from pathlib import Path

from gproof.backend.job import job_from
from gproof.backend.record_data import ExecutionRecord
from gproof.backend.record_proof import MotorProof, proofs
from gproof.driver.escape import in_one_line
from gproof.driver.key_ring import OWN as OWN_NAME
from gproof.driver.verified import verdict_of
from gproof.ir import codes
from gproof.ir.finding import Finding, Span
from gproof.ir.record import record
from gproof.ir.verdict import Verdict
from gproof.verify.certificate.package import CertificateError, Package, read_package
from gproof.verify.certificate.signers import Signer, called, fingerprint, signed_by, today

OWN, TRUSTED, UNKNOWN = "your own key", "trusted", "not trusted"


@record(frozen=True, slots=True, kw_only=True)
class VerifiedRecord:
    """A record with its verdict.

    signer: what its key is to the user (OWN, TRUSTED or UNKNOWN)
    compared: whether there was a package that could be read to compare it with
    proofs: what is known of each section and motor, where it fits that package
    """

    verdict: Verdict
    findings: tuple[Finding, ...]
    signer: str
    compared: bool
    proofs: tuple[MotorProof, ...] = ()


def verified_record(
    path: Path, record: ExecutionRecord, signature: dict[str, str] | None, *,
    package: Path | None, trusted: tuple[Signer, ...],
) -> VerifiedRecord:  # fmt: skip
    """Judge the signature, and whether the record fits the package that was run."""
    found, signer = _signed(path, record, signature, trusted)
    against = None
    if package is not None:
        try:
            against = read_package(package)
        except CertificateError as error:
            found.append(error.finding)
    known: tuple[MotorProof, ...] = ()
    if against is not None:
        wrong = _compared(record, against)
        found += wrong
        known = () if wrong else tuple(proofs(record, job_from(against, record.start)))
    return VerifiedRecord(
        verdict=verdict_of(found), findings=tuple(found), signer=signer, compared=against is not None, proofs=known
    )


def _signed(
    path: Path, record: ExecutionRecord, signature: dict[str, str] | None, trusted: tuple[Signer, ...]
) -> tuple[list[Finding], str]:
    """What is wrong with the signature, and what its key is to the user."""
    from gproof.backend.record_signature import signer_of

    place = Span(str(path), 0)
    if signature is None:
        return [codes.RECORD_UNTRUSTED.at(place, what="the record has no signature")], UNKNOWN
    try:
        raw = signer_of(record, signature)
    except ValueError as error:
        return [codes.RECORD_SIGNATURE.at(place, what=in_one_line(str(error)))], UNKNOWN
    known = signed_by(raw, trusted)
    if known is None:
        what = f"signed by {fingerprint(raw)}, which is not a trusted key"
        return [codes.RECORD_UNTRUSTED.at(place, what=what)], UNKNOWN
    if known.revoked is not None:
        what = f"signed by {called(known)}, which was revoked on {known.revoked}"
        return [codes.RECORD_SIGNATURE.at(place, what=what)], UNKNOWN
    if known.expires is not None and today() > known.expires:
        what = f"signed by {called(known)}, which expired on {known.expires}"
        return [codes.RECORD_UNTRUSTED.at(place, what=what)], UNKNOWN
    return [], OWN if known.name == OWN_NAME else TRUSTED


def _compared(record: ExecutionRecord, package: Package) -> list[Finding]:
    """What does not fit the package."""
    from gproof.backend.record import verify_record

    try:
        return verify_record(record, package)
    except (ValueError, LookupError, TypeError, ArithmeticError) as error:
        what = f"the record cannot be of this package ({type(error).__name__}: {error})"
        return [codes.RECORD_MISMATCH.at(Span(record.job, 0), what=in_one_line(what))]
