"""What files and errors have to say, on standard error: the driver hands it over, the command prints it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from gproof.driver.errors import UsageError
from gproof.driver.escape import in_one_line

if TYPE_CHECKING:
    from gproof.ir.finding import Findings


def tell(findings: Findings) -> None:
    """Findings of a file that is no program."""
    from gproof.report.text import print_findings

    print_findings(findings, err=True)


def tell_findings_of(error: UsageError) -> None:
    """What led to the error, where something did."""
    if error.findings is not None:
        tell(error.findings)


def warn(line: str) -> None:
    """A line of warning."""
    click.echo(in_one_line(line), err=True)


def tell_error(error: UsageError) -> None:
    """What led to it, then its line."""
    tell_findings_of(error)
    click.echo(f"gproof: error: {in_one_line(error.message)}", err=True)
