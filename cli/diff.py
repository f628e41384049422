"""``gproof diff``: where two programs part."""

from __future__ import annotations

import json
from pathlib import Path

import click

from gproof.cli.help import Command, option
from gproof.cli.options import FILE, FORMAT, GIVEN, REPORT, FileName, Finite, once


@click.command(
    cls=Command, short_help="Compare what two programs do, whatever controllers they are for",
    examples=(
        "gproof diff part.tap part.cnc --machine WINCNC.INI --machine-to cnc.ini",
        "gproof diff before.cnc after.cnc --picture where.svg",
    ),
)  # fmt: skip
@click.argument("first", type=FileName())
@click.argument("second", type=FileName())
@once("--machine", title=GIVEN, metavar=FILE, type=FileName(), help="Machine file of the first program")
@once("--machine-to", title=GIVEN, metavar=FILE, type=FileName(), help="Machine file of the second program")
@once("--setup", title=GIVEN, metavar="FILE|zero", help="Setup of the first program")
@once("--setup-to", title=GIVEN, metavar="FILE|zero", help="Setup of the second program")
@option(
    "--tolerance",
    title=REPORT,
    metavar="MM",
    type=Finite(0.0, 10.0),
    default=0.001,
    help="How far places may be apart, mm and degrees [default: 0.001]",
)
@option("--picture", title=REPORT, metavar=FILE, type=FileName(), help="Draw both paths and where they part (SVG)")
@FORMAT
def diff(
    first: Path, second: Path, machine: Path | None, machine_to: Path | None, setup: str | None, setup_to: str | None,
    tolerance: float, picture: Path | None, form: str,
) -> int:  # fmt: skip
    """Compare what two programs make their machines do, move by move, wherever the work zero is.

    Exit code: 0 the same, 1 not the same, 2 unknown, 3 the command could not run.
    """
    from gproof.driver.files import require_picture, require_place, require_program, write_text
    from gproof.driver.program_diff import Side, program_diff
    from gproof.driver.session import Running
    from gproof.report.program_diff import diff_json, diff_lines, picture_of

    for job in (first, second):
        require_program(job, "program")
    if picture is not None:
        require_place(picture, "picture", (first, second, machine, machine_to, setup, setup_to))
        require_picture(picture)
    done = program_diff(
        Side(job=first, machine=machine, setup=setup), Side(job=second, machine=machine_to, setup=setup_to),
        tolerance=tolerance, running=Running(),
    )  # fmt: skip
    if form == "json":
        click.echo(json.dumps(diff_json(done), indent=2))
    else:
        for line in diff_lines(done):
            click.echo(line)
    if picture is not None:
        write_text(picture, picture_of(done), "picture")
    return done.verdict.exit_code
