"""``gproof verify``: a package judged again from its parts alone."""

from __future__ import annotations

import json
from pathlib import Path

import click

from gproof.cli.compile import first_line
from gproof.cli.progress import progress
from gproof.cli.telling import warn
from gproof.driver.against import Against, other_than_anew
from gproof.driver.at_hand import other_source, read_at_hand, require_files
from gproof.driver.errors import UsageError
from gproof.driver.escape import shown
from gproof.driver.files import require_file, require_program
from gproof.driver.key_ring import trusted_with
from gproof.driver.session import Running
from gproof.ir.finding import Finding, Findings
from gproof.report.text import print_findings


def run_verify(
    path: Path, *, machine: Path | None, trust: tuple[Path, ...], setup: str | None = None, source: Path | None = None,
    form: str = "text", against: Path | None = None, dialect: str | None = None, running: Running | None = None,
    pure: bool = False,
) -> int:  # fmt: skip
    """Print what holds; exit 0 only when the package may run. pure: the steps are proved by no compiled code."""
    from gproof.driver.verified import verified
    from gproof.report.verify_report import print_verified, verified_json
    from gproof.verify.certificate.check import check_package
    from gproof.verify.certificate.package import CertificateError, read_package

    require_file(path, "package")
    require_files(machine, setup, source)
    anew = _against(against, machine, setup, dialect, running or Running())
    trusted = trusted_with(trust, warn)
    findings = Findings()
    try:
        with progress("reading"):
            package = read_package(path)
    except CertificateError as error:
        return _unread(path, error.finding, form)
    at_hand = read_at_hand(package, findings, machine=machine, setup=setup, source=source)
    with progress("verifying every step") as bar:
        bar.phase("verifying every step", package.stream.steps())
        check = check_package(package, at_hand.machine, at_hand.setup, trusted, bar.done, pure=pure)
    other = other_source(package, at_hand)
    if anew is not None:
        with progress("compiling the source again"):
            other = [*other, *other_than_anew(package, anew, first_line)]
    of = verified(package, check, at_hand, other, findings, anew=anew is not None, trusted=trusted, pure=pure)
    if form == "json":
        click.echo(json.dumps(verified_json(str(path), of), indent=2, allow_nan=False))
    else:
        print_findings(findings)
        print_verified(str(path), of)
    return of.verdict.exit_code


def _against(
    against: Path | None, machine: Path | None, setup: str | None, dialect: str | None, running: Running
) -> Against | None:
    """UsageError for a source that cannot be compiled again."""
    if against is None:
        if dialect is not None:
            raise UsageError("--dialect needs --against: it says how that program is read")
        return None
    require_program(against, "source")
    if machine is None:
        raise UsageError("--against needs --machine FILE, the machine file that the package was made with")
    return Against(source=against, machine=machine, setup=setup, dialect=dialect, running=running)


def _unread(path: Path, finding: Finding, form: str) -> int:
    """A package of which nothing can be said but why."""
    from gproof.driver.verified import verdict_of

    verdict = verdict_of([finding])
    if form == "json":
        from gproof.report.verify_report import unread_json

        click.echo(json.dumps(unread_json(str(path), verdict, finding), indent=2))
        return verdict.exit_code
    findings = Findings()
    findings.add(finding)
    print_findings(findings)
    click.echo(f"{shown(path)}: {verdict.value}")
    return verdict.exit_code
