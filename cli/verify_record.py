"""``gproof verify RECORD``: an execution record judged by its hash, its signature and the package that was run."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from gproof.cli.telling import warn
from gproof.driver.escape import in_one_line
from gproof.driver.files import require_file
from gproof.driver.key_ring import trusted_with
from gproof.ir import codes
from gproof.ir.finding import Findings, Span
from gproof.ir.verdict import Verdict
from gproof.report.text import print_findings

if TYPE_CHECKING:
    from gproof.backend.record_data import ExecutionRecord
    from gproof.driver.verified_record import VerifiedRecord

HOLDS = {Verdict.SAFE: "the record is valid", Verdict.UNSAFE: "the record is not valid", Verdict.UNKNOWN: "UNKNOWN"}


def is_no_package(path: Path) -> bool:
    """True for a file that starts as JSON does: a package is a zip file. A pipe is neither, and is not waited for."""
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
    from gproof.driver.verified_record import verified_record

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
    of = verified_record(path, record, signature, package=package, trusted=trusted)
    findings = Findings()
    for finding in of.findings:
        findings.add(finding)
    print_findings(findings)
    click.echo(f"{in_one_line(str(path))}: {HOLDS[of.verdict]}")
    for line in _lines(record, signature, of, package):
        click.echo(in_one_line(line))
    return of.verdict.exit_code


def _proved(of: VerifiedRecord) -> list[str]:
    """Which steps are proved by the board's own counts, which are only acknowledged, and what is not known."""
    from gproof.backend.record_proof import Proof

    if not of.proofs:
        return []
    out = []
    words = {
        Proof.PROVED: "the board's count and CRC-32 are those of the stream",
        Proof.ACKNOWLEDGED: "the board took them and its clock passed them",
        Proof.UNKNOWN: "at least",
    }
    for proof, word in words.items():
        some = [one for one in of.proofs if one.proof is proof]
        if not some:
            continue
        sections = sorted({one.section for one in some})
        of_sections = f"in section{'s' * (len(sections) > 1)} {', '.join(map(str, sections[:8]))}"
        more = ", …" if len(sections) > 8 else ""
        out.append(f"  {proof.value:<12}{sum(one.steps for one in some)} steps {of_sections}{more}: {word}")
        if proof is Proof.UNKNOWN:
            for one in some:
                most = "how many it made is not known" if one.most is None else f"at most {one.most}"
                out.append(f"    section {one.section}, motor {one.motor}: at least {one.steps} steps, {most}")
    return out


def _malformed(path: Path, what: str) -> int:
    findings = Findings()
    findings.add(codes.RECORD_MALFORMED.at(Span(str(path), 0), what=in_one_line(what)))
    print_findings(findings)
    click.echo(f"{in_one_line(str(path))}: {HOLDS[Verdict.UNSAFE]}")
    return Verdict.UNSAFE.exit_code


def _lines(
    record: ExecutionRecord, signature: dict[str, str] | None, of: VerifiedRecord, package: Path | None
) -> list[str]:
    """What the record says, by who vouches for it."""
    label = signature or {}
    out = [f"  record      {record.sha256}, {record.schema}", f"  certificate {record.certificate}"]
    out.append(f"  signed by   {label['public_key']} ({of.signer})" if signature else "  signed by   nobody")
    if label.get("created"):
        out.append(f"  started     {label['created']}, according to the signer")
    ran = f", signed by {label['package_signer']}" if label.get("package_signer") else ""
    out.append(f"  package     ran as {record.accepted}{ran}")
    if package is None:
        out.append("  compared    with nothing; use --package FILE to compare with the package that was run")
    elif not of.compared:
        out.append(f"  compared    with nothing; {package} cannot be compared with")
    else:
        out.append(f"  compared    with {package}: sections, steps, positions, events")
    board = f"{record.board.name} {record.board.identity}".rstrip()
    firmware = f", firmware {record.board.firmware}" if record.board.firmware else ""
    out.append(f"  job         {record.job}, on board {board}{firmware}")
    out.append(f"  result      {record.result.value}" + (f": {record.reason}" if record.reason else ""))
    ends = "ends at" if record.position is not None else "position not known, last acknowledged at"
    for name, steps, position in zip(record.motors, record.steps, record.last_position, strict=False):
        out.append(f"  motor {name:<5} {steps} steps, {ends} step {position}")
    for section in record.sections:
        for loss in section.losses:
            after = f"found again, position {loss.known.value}" if loss.found else "not found again"
            out.append(f"  lost        in section {section.number} at tick {loss.tick}: {loss.reason}; {after}")
    out += _proved(of)
    out.append("  not proved  what only the board knows: that these steps were made, when, and what it measured")
    return out
