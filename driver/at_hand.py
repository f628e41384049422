"""What a package is compared with: machine, setup and source as they are at hand."""

from __future__ import annotations

import hashlib
from pathlib import Path, PurePosixPath, PureWindowsPath

from gproof.driver.errors import UsageError
from gproof.driver.escape import shown
from gproof.driver.files import require_file
from gproof.ir import codes
from gproof.ir.finding import Finding, Findings, Span
from gproof.ir.machine import Machine
from gproof.ir.record import record
from gproof.ir.setup import ZERO, Setup
from gproof.verify.certificate.package import Package


@record(frozen=True, slots=True, kw_only=True)
class AtHand:
    """Machine and setup as read, None where none is named; source: the name and the SHA-256 of a file, or None."""

    machine: Machine | None = None
    setup: Setup | None = None
    source: tuple[Path, str] | None = None


def require_files(machine: Path | None, setup: str | None, source: Path | None) -> None:
    """UsageError for what cannot be read, before any work is done."""
    if machine is not None:
        require_file(machine, "machine file")
    if setup is not None and setup != "zero":
        require_file(Path(setup), "setup file")
    if source is not None:
        require_file(source, "source")


def read_at_hand(
    package: Package, findings: Findings, *, machine: Path | None, setup: str | None, source: Path | None
) -> AtHand:  # fmt: skip
    """Read what is named; UsageError where it cannot be used. A setup is one of the machine at hand, else of that
    of the package."""
    the_machine = _machine(machine, findings)
    the_setup = _setup(setup, the_machine or package.machine, findings)
    digest = None
    if source is not None:
        try:
            with source.open("rb") as file:
                digest = (source, hashlib.file_digest(file, "sha256").hexdigest())
        except OSError as error:
            raise UsageError(f"source {source}: {error.strerror}") from None
    return AtHand(machine=the_machine, setup=the_setup, source=digest)


def _machine(path: Path | None, findings: Findings) -> Machine | None:
    if path is None:
        return None
    from gproof.driver.dialects import load_machine

    machine, _ = load_machine(path, findings)
    if machine is None:
        raise UsageError(f"machine file {path}: cannot be used, see the errors above", findings)
    return machine


def _setup(name: str | None, machine: Machine, findings: Findings) -> Setup | None:
    if name is None:
        return None
    if name == "zero":
        return ZERO
    from gproof.driver.dialects import load_setup

    setup, _ = load_setup(Path(name), findings, machine)
    if setup is None:
        raise UsageError(f"setup file {name}: cannot be used, see the errors above", findings)
    return setup


def other_source(package: Package, at_hand: AtHand) -> list[Finding]:
    """GP829 where the certificate names another source than the file at hand, or none."""
    if at_hand.source is None:
        return []
    file, digest = at_hand.source
    named = sources_of(package)
    if digest in named:
        return []
    said = f"{named[0][:16]}..." if named and named[0] else "none"
    what = f"the SHA-256 of {shown(file)} is {digest[:16]}..., in the certificate it is {shown(said)}"
    return [codes.CERTIFICATE_SOURCE.at(Span(package.path, 0), what=what)]


def sources_of(package: Package) -> list[str]:
    """The SHA-256 of the job itself, not of what it includes: as the body says."""
    job, inputs = package.body.get("job"), package.body.get("inputs")
    out = []
    for one in inputs if isinstance(inputs, list) else ():
        if isinstance(one, dict) and one.get("role") == "source" and job in _bases(str(one.get("name"))):
            out.append(str(one.get("sha256")))
    return out


def _bases(name: str) -> tuple[str, str]:
    """The last part of a path, as either system cuts it."""
    return PurePosixPath(name).name, PureWindowsPath(name).name
