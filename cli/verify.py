"""``gproof verify``: a package judged again from its parts alone."""

from __future__ import annotations

from pathlib import Path

import click

from gproof.cli.conditions import SAFE_IF
from gproof.cli.files import require_file
from gproof.cli.main import UsageError
from gproof.cli.progress import progress
from gproof.cli.report import print_findings
from gproof.ir.finding import Findings, Severity
from gproof.ir.machine import Machine
from gproof.ir.verdict import Verdict


def run_verify(path: Path, *, machine: Path | None, trust: tuple[Path, ...]) -> int:
    """Print what holds; exit 0 only when the package may run."""
    from gproof.cli.summary import condition_of
    from gproof.verify.certificate import CertificateError, check_package, load_public_key, read_package

    require_file(path, "package")
    findings = Findings()
    given = load_given_machine(machine, findings)
    for key in trust:
        require_file(key, "trusted key")
    try:
        trusted = [load_public_key(key) for key in trust] if trust else None
    except (ValueError, OSError) as error:
        raise UsageError(str(error)) from None
    try:
        with progress("reading"):
            package = read_package(path)
    except CertificateError as error:
        findings.add(error.finding)
        print_findings(findings)
        refused = Verdict.UNKNOWN if error.finding.severity is Severity.UNKNOWN else Verdict.UNSAFE
        click.echo(f"{path}: {refused.value}")
        return refused.exit_code
    with progress("verifying every step") as shown:
        shown.phase("verifying every step", package.stream.steps())
        check = check_package(package, given, None, trusted, shown.done)
    against = [f for f in check.findings if not check.valid_if or f not in check.open]
    for finding in against:
        findings.add(finding)
    print_findings(findings)
    verdict = Verdict.SAFE if check.valid or check.valid_if else Verdict.UNSAFE
    if verdict is Verdict.UNSAFE and not any(f.severity is Severity.ERROR for f in against):
        verdict = Verdict.UNKNOWN
    click.echo(f"{path}: {SAFE_IF if check.valid_if else verdict.value}")
    for name, condition in check.conditions if check.valid_if else ():
        click.echo(f"  if          {condition_of(package.machine, condition)} ({name})")
    click.echo(f"  certificate {package.sha256}")
    click.echo(f"  job         {package.body.get('job')}, machine {package.machine.name}")
    click.echo(f"  signed by   {check.signer or 'nobody'}{'' if trusted is not None else ' (no --trust given)'}")
    click.echo(f"  steps       {check.stream.steps} checked")
    for result in check.stream.properties:
        click.echo(f"  {result.name:<20} {result.verdict.value}")
    return verdict.exit_code


def load_given_machine(path: Path | None, findings: Findings) -> Machine | None:
    """The machine of a file, None without one; UsageError when it can not be used."""
    if path is None:
        return None
    from gproof.frontend.machine_file import load_machine

    require_file(path, "machine file")
    machine, _ = load_machine(path, findings)
    if machine is None:
        print_findings(findings, err=True)
        raise UsageError("the machine file can not be used")
    return machine
