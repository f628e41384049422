"""``gproof verify``: a package judged again from its parts alone."""

from __future__ import annotations

import base64
from pathlib import Path

import click

from gproof.cli.at_hand import other_source, read_at_hand, require_files
from gproof.cli.conditions import SAFE_IF
from gproof.cli.files import require_file
from gproof.cli.key_ring import name_of, trusted_with
from gproof.cli.progress import progress
from gproof.cli.report import print_findings
from gproof.ir.finding import Findings, Severity
from gproof.ir.verdict import Verdict


def run_verify(
    path: Path, *, machine: Path | None, trust: tuple[Path, ...], setup: str | None = None, source: Path | None = None
) -> int:  # fmt: skip
    """Print what holds; exit 0 only when the package may run."""
    from gproof.cli.summary import condition_of
    from gproof.verify.certificate import CertificateError, check_package, read_package
    from gproof.verify.measured import taken

    require_file(path, "package")
    require_files(machine, setup, source)
    trusted = trusted_with(trust)
    findings = Findings()
    try:
        with progress("reading"):
            package = read_package(path)
    except CertificateError as error:
        findings.add(error.finding)
        print_findings(findings)
        refused = Verdict.UNKNOWN if error.finding.severity is Severity.UNKNOWN else Verdict.UNSAFE
        click.echo(f"{path}: {refused.value}")
        return refused.exit_code
    at_hand = read_at_hand(package, findings, machine=machine, setup=setup, source=source)
    with progress("verifying every step") as shown:
        shown.phase("verifying every step", package.stream.steps())
        check = check_package(package, at_hand.machine, at_hand.setup, trusted, shown.done)
    found = (*other_source(package, at_hand), *check.findings)
    against = [f for f in found if f.severity in (Severity.ERROR, Severity.UNKNOWN) and f not in check.open]
    verdict = Verdict.UNKNOWN if against else Verdict.SAFE
    if any(f.severity is Severity.ERROR for f in against):
        verdict = Verdict.UNSAFE
    for finding in found:
        if verdict is Verdict.UNSAFE or finding not in check.open:
            findings.add(finding)
    print_findings(findings)
    conditional = verdict is Verdict.SAFE and bool(check.conditions)
    click.echo(f"{path}: {SAFE_IF if conditional else verdict.value}")
    for name, condition in check.conditions if verdict is not Verdict.UNSAFE else ():
        click.echo(f"  if          {condition_of(package.machine, condition)} ({name})")
    for said in taken(package, at_hand.setup):
        click.echo(f"  taken       {said}")
    click.echo(f"  certificate {package.sha256}")
    click.echo(f"  job         {package.body.get('job')}, machine {package.machine.name}")
    signer = "nobody" if check.signer is None else name_of(base64.b64decode(check.signer), trusted)
    click.echo(f"  signed by   {signer}")
    click.echo(f"  steps       {check.stream.steps} checked")
    for result in check.stream.properties:
        click.echo(f"  {result.name:<20} {result.verdict.value}")
    return verdict.exit_code
