"""The options of ``gproof translate``."""

from __future__ import annotations

from pathlib import Path

import click

from gproof.cli.help import Command, option
from gproof.cli.options import FILE, JOB, REPORT, TRANSLATION, FileName, Finite, job_options, once


@click.command(
    cls=Command, short_help="Translate a program to another controller, and prove that it is the same",
    examples=(
        "gproof translate a.tap --machine WINCNC.INI --to eding --map init",
        "gproof translate a.cnc --machine cnc.ini --to grbl --machine-to m.toml -o a.nc",
    ),
)  # fmt: skip
@JOB
@job_options
@once("--to", title=TRANSLATION, metavar="NAME", type=str, required=True, help="Controller to translate to")
@once("--machine-to", title=TRANSLATION, metavar=FILE, type=FileName(), help="Machine file of that controller")
@once("-o", "--output", title=TRANSLATION, metavar=FILE, type=FileName(), help="Program to write, or folder")
@option(
    "--chord-tolerance", title=TRANSLATION, metavar="MM", type=Finite(0.0001, 10.0), default=0.01,
    help="How far chords may be from an arc that the controller does not have [default: 0.01]",
)  # fmt: skip
@option("--exact", title=TRANSLATION, is_flag=True, help="Print all digits of numbers")
@option(
    "--rapids", title=TRANSLATION, metavar="[assumed|straight]", type=click.Choice(["assumed", "straight"]),
    default="assumed", help="Rapids of several axes: the same path is assumed, or they must be straight on both",
)  # fmt: skip
@once(
    "--map", "map_file", title=TRANSLATION, metavar="FILE|init", type=FileName(),
    help="Which output, input and tool of one machine is which of the other (TOML); init: propose one",
)  # fmt: skip
@option("--partial", title=TRANSLATION, is_flag=True, help="Write what comes before the first refused construct")
@option("--allow-unproven", title=TRANSLATION, is_flag=True, help="Write it even if it is not proven")
@option(
    "--format", "form", title=REPORT, metavar="[text|json|markdown]", type=click.Choice(["text", "json", "markdown"]),
    default="text", help="Format of the report [default: text]",
)  # fmt: skip
def translate(
    job: Path, machine: Path | None, setup: str | None, dialect: str | None, max_blocks: int | None,
    max_branches: int, call: str | None, render: bool, to: str, machine_to: Path | None, output: Path | None,
    chord_tolerance: float, exact: bool, rapids: str, map_file: Path | None, partial: bool,
    allow_unproven: bool, form: str,
) -> int:  # fmt: skip
    """Write JOB for another controller, and prove that it makes the machine do the same, wherever the work zero is.

    Exit code: 0 written and proven, 1 not the same (nothing is written), 2 refused or not proven, 3 the command could
    not run.
    """
    from gproof.cli.translate import run_translate
    from gproof.driver.session import Running
    from gproof.driver.translation import Wanted

    wanted = Wanted(
        job=job, to=to, machine=machine, machine_to=machine_to, setup=setup, dialect=dialect,
        chord_tolerance=chord_tolerance, exact=exact, straight_rapids=rapids == "straight", map=map_file,
        partial=partial,
        running=Running(max_blocks, max_branches, render, call),
    )  # fmt: skip
    return run_translate(wanted, output=output, allow_unproven=allow_unproven, form=form)
