"""The command ``gproof resume``: its options. What it does is in ``resume.py``."""

from __future__ import annotations

from pathlib import Path

import click

from gproof.cli.help import Command, option
from gproof.cli.options import FILE, GIVEN, JOB, MOST, PROGRAM, REPORT, FileName, OneOf, dialects


@click.command(
    cls=Command, short_help="Write a program that goes on with a job in its middle",
    examples=(
        "gproof resume a.cnc --from-line 120 --machine m.toml --setup zero -o b.cnc",
        "gproof resume a.cnc --from-journal J --machine m.toml --setup zero -o b.cnc",
    ),
)  # fmt: skip
@JOB
@option("--machine", title=GIVEN, metavar=FILE, type=FileName(), required=True, help="Machine file")
@option("--setup", title=GIVEN, metavar=FILE, required=True, help='Setup file, or "zero"')
@option(
    "--dialect", title=GIVEN, metavar="NAME", type=OneOf(dialects),
    help="Controller of the program: {choices} [default: detected]",
)  # fmt: skip
@option("--from-line", title=PROGRAM, metavar="N", type=click.IntRange(1, MOST), help="The first line to execute again")
@option(
    "--from-journal", title=PROGRAM, metavar=FILE, type=FileName(),
    help="Journal of the run that was left (gproof status names it): go on at its earliest possible line",
)  # fmt: skip
@option(
    "-o", "--output", title=REPORT, metavar=FILE, type=FileName(), required=True, help="Write the program to a file"
)
@option(
    "--package", title=REPORT, metavar=FILE, type=FileName(),
    help="Compile it too, with every check and a new certificate",
)  # fmt: skip
def resume(
    job: Path, machine: Path, setup: str, dialect: str | None, from_line: int | None, from_journal: Path | None,
    output: Path, package: Path | None,
) -> int:  # fmt: skip
    """Write a new program that continues JOB in its middle.

    It takes up again the modes, tool, spindle and coolant, moves to its place from above, and then has the lines of
    the job. It is executed before it is written: what it does after the path there must be what the job does. For
    programs of Eding CNC.

    Exit code: 0 written, 1 UNSAFE or 2 UNKNOWN with --package, 3 the job cannot go on there, or the command could not
    run.
    """
    from gproof.cli.resume import run_resume

    return run_resume(
        job, machine=machine, setup=setup, dialect=dialect, from_line=from_line, from_journal=from_journal,
        output=output, package=package,
    )  # fmt: skip
