"""``gproof verify RECORD``: an execution record judged by its hash, its signature and the package that was run."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from gproof.cli.telling import warn
from gproof.driver.escape import in_one_line
from gproof.driver.files import require_file
from gproof.driver.key_ring import OWN as OWN_NAME
from gproof.driver.key_ring import trusted_with
from gproof.ir import codes
from gproof.ir.finding import Finding, Findings, Severity, Span
from gproof.ir.verdict import Verdict
from gproof.report.text import print_findings
from gproof.verify.certificate.signers import Signer, called, fingerprint, signed_by, today

if TYPE_CHECKING:
    from gproof.backend.record_data import ExecutionRecord

OWN, TRUSTED, UNKNOWN = "your own key", "trusted", "not trusted"

HOLDS = {Verdict.SAFE: "the record is valid", Verdict.UNSAFE: "the record is not valid", Verdict.UNKNOWN: "UNKNOWN"}


def is_no_package(path: Path) -> bool:
    """True for a file that begins as JSON does: a package is a zip file. A pipe is neither, and is not waited for."""
    try:
        if not path.is_file():
            return False
        with path.open("rb") as file:
            return file.read(64).lstrip()[:1] == b"{"
    except OSError:
        return False


def run_verify_record(path: Path, *, package: Path | None, trust: tuple[Path, ...]) -> int:
    """Print what holds of a record; exit 0 only for one that is whole, signed by who is trusted, and fits."""
    from gproof.backend.record_parse import LARGEST, parse_signed

    require_file(path, "record")
    if package is not None:
        require_file(package, "package")
    trusted = trusted_with(trust, warn)
    if path.stat().st_size > LARGEST:
        return _malformed(path, f"{path.stat().st_size} bytes, more than a record can have")
    try:
        record, signature = parse_signed(path.read_bytes())
    except ValueError as error:
        return _malformed(path, str(error))
    found, signer = _signed(path, record, signature, trusted)
    if package is not None:
        found += _compared(record, package)
    findings = Findings()
    for finding in found:
        findings.add(finding)
    print_findings(findings)
    verdict = Verdict.SAFE
    if findings.has(Severity.ERROR):
        verdict = Verdict.UNSAFE
    elif findings.has(Severity.UNKNOWN):
        verdict = Verdict.UNKNOWN
    click.echo(f"{in_one_line(str(path))}: {HOLDS[verdict]}")
    for line in _lines(record, signature, signer, package):
        click.echo(in_one_line(line))
    return verdict.exit_code


def _malformed(path: Path, what: str) -> int:
    findings = Findings()
    findings.add(codes.RECORD_MALFORMED.at(Span(str(path), 0), what=in_one_line(what)))
    print_findings(findings)
    click.echo(f"{in_one_line(str(path))}: {HOLDS[Verdict.UNSAFE]}")
    return Verdict.UNSAFE.exit_code


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


def _compared(record: ExecutionRecord, package: Path) -> list[Finding]:
    """What does not fit the package."""
    from gproof.backend.record import verify_record
    from gproof.verify.certificate.package import CertificateError, read_package

    try:
        read = read_package(package)
    except CertificateError as error:
        return [error.finding]
    try:
        return verify_record(record, read)
    except (ValueError, LookupError, TypeError, ArithmeticError) as error:
        what = f"the record cannot be of this package ({type(error).__name__}: {error})"
        return [codes.RECORD_MISMATCH.at(Span(record.job, 0), what=in_one_line(what))]


def _lines(record: ExecutionRecord, signature: dict[str, str] | None, signer: str, package: Path | None) -> list[str]:
    """What the record says, by who vouches for it."""
    label = signature or {}
    out = [f"  record      {record.sha256}, {record.schema}", f"  certificate {record.certificate}"]
    out.append(f"  signed by   {label['public_key']} ({signer})" if signature else "  signed by   nobody")
    if label.get("created"):
        out.append(f"  started     {label['created']}, according to the signer")
    of = f", signed by {label['package_signer']}" if label.get("package_signer") else ""
    out.append(f"  package     ran as {record.accepted}{of}")
    if package is None:
        out.append("  compared    with nothing; use --package FILE to compare with the package that was run")
    else:
        out.append(f"  compared    with {package}: sections, steps, positions, events")
    out.append(f"  job         {record.job}, on board {record.board.name}")
    out.append(f"  result      {record.result.value}" + (f": {record.reason}" if record.reason else ""))
    ends = "ends at" if record.position is not None else "position not known, last acknowledged at"
    for name, steps, position in zip(record.motors, record.steps, record.last_position, strict=False):
        out.append(f"  motor {name:<5} {steps} steps, {ends} step {position}")
    out.append("  not proved  what only the board knows: that these steps were made, when, and what it measured")
    return out
