"""The command ``gproof status``: its options. What it does is in ``status.py``."""

from __future__ import annotations

from pathlib import Path

import click

from gproof.cli.board_commands import BAUD
from gproof.cli.help import Command, option
from gproof.cli.options import BOARD, FILE, READ, REPORT, FileName


@click.command(
    cls=Command, short_help="Say what was executed of a run, also after a crash",
    examples=("gproof status", "gproof status part.gpx --port COM3", "gproof status runs/ --json"),
)  # fmt: skip
@click.argument("of", metavar="[FOLDER|PACKAGE|JOURNAL]", required=False, type=FileName())
@option(
    "--package", title=READ, metavar=FILE, type=FileName(),
    help="The package that was run [default: where it was when it ran]",
)  # fmt: skip
@option(
    "--runs", title=READ, metavar="FOLDER", type=FileName(),
    help="Folder of journals and records [default: your own, for all runs]",
)  # fmt: skip
@option("--port", title=BOARD, metavar="PORT", help="Ask the board on this port what it executed; nothing moves")
@option("--baud", title=BOARD, metavar="RATE", type=BAUD, help="Speed of the port")
@option("--json", "as_json", title=REPORT, is_flag=True, help="Print JSON")
def status(
    of: Path | None, package: Path | None, runs: Path | None, port: str | None, baud: int | None, as_json: bool
) -> int:
    """Say what was executed of a run, also after a crash, a pulled cable, a reset or a full disk.

    It reads the journal of the run, and changes nothing. Without an argument it is about the runs in your own folder:
    those that did not end, and the last one that did. Firmware with gproof's extension can be asked what it executed
    (--port).

    Exit code: 0 what was executed is known to the step, 1 the journal is damaged or contradicts the board, 2 it is
    known between bounds or not at all, 3 the command could not run.
    """
    from gproof.cli.status import run_status

    return run_status(of, package=package, runs=runs, port=port, baud=baud, as_json=as_json)
