"""The commands ``gproof run`` and ``gproof boards``: their options. What they do is in ``run.py`` and ``boards.py``."""

from __future__ import annotations

from pathlib import Path

import click

from gproof.cli.help import Command, Group, option
from gproof.cli.options import BOARD, FILE, RECORD, REQUIRED, FileName, Finite, OneOf, chips, package_options
from gproof.cli.options import boards as board_names
from gproof.cli.run_progress import AUTO, CHOICES

BAUD = click.IntRange(1200, 10_000_000)


@click.command(
    cls=Command, short_help="Run a certified step stream on a board",
    examples=(
        "gproof run part.gpx --board virtual",
        "gproof run part.gpx --board virtual --ask --record part.record.json",
        "gproof run part.gpx --board pci7200 --vcd part.vcd",
        "gproof run part.gpx --board klipper --port COM3 --machine m.toml --setup zero",
    ),
)  # fmt: skip
@click.argument("package", type=FileName())
@option(
    "--board",
    title=BOARD,
    metavar="BOARD",
    type=OneOf(board_names),
    required=True,
    help="Board to run on (gproof boards list)",
)
@option("--port", title=BOARD, metavar="PORT", help="Port of the board [default: that of the machine file]")
@option("--baud", title=BOARD, metavar="RATE", type=BAUD, help="Speed of the port")
@option("--ask", title=BOARD, is_flag=True, help="Ask at operator stops; a board that moves a machine always asks")
@option("--real-time", title=BOARD, is_flag=True, help="Virtual and modelled boards: take as long as the real machine")
@option(
    "--vcd", title=BOARD, metavar=FILE, type=FileName(), help="Modelled boards: write their pins to a waveform file"
)
@option("--override", title=BOARD, metavar="FACTOR", type=Finite(0.1, 1.0), help="Feed override, 0.1 to 1")
@option("--hold-at", title=BOARD, metavar="SECONDS", type=Finite(0), help="Feed hold at this time of the first section")
@option("--estop-at", title=BOARD, metavar="SECONDS", type=Finite(0), help="Emergency stop at this time")
@option(
    "--progress", title=BOARD, type=click.Choice(CHOICES), default=AUTO,
    help="Show how far it is: a line on a terminal, JSON lines on standard error, nothing [default: auto]",
)  # fmt: skip
@package_options
@option(
    "--allow-untrusted", title=REQUIRED, is_flag=True,
    help="Run a package that no trusted key has signed (boards that move nothing only)",
)  # fmt: skip
@option(
    "--record", title=RECORD, metavar=FILE, type=FileName(), help="Write the execution record (JSON) to a file"
)  # fmt: skip
@option("--replace-record", title=RECORD, is_flag=True, help="Replace the record of an earlier run")
@option(
    "--runs", title=RECORD, metavar="FOLDER", type=FileName(),
    help="Folder of journals and records [default: your own, for all runs]",
)  # fmt: skip
@option(
    "--after-interruption", title=RECORD, is_flag=True,
    help="Run although the last run was interrupted: you have checked the position of the axes",
)  # fmt: skip
def run(
    package: Path, board: str, machine: Path | None, setup: str | None, source: Path | None, trust: tuple[Path, ...],
    allow_untrusted: bool, record: Path | None, real_time: bool, hold_at: float | None, estop_at: float | None,
    override: float | None, ask: bool, replace_record: bool, runs: Path | None, after_interruption: bool,
    port: str | None, baud: int | None, progress: str, vcd: Path | None,
) -> int:  # fmt: skip
    """Run a certified step stream on a board.

    Every step is verified again before anything moves. The package must be signed with a key that you trust: your
    own, one that --trust names, or one added with "gproof keys trust".
    """
    from gproof.cli.run import run_run
    from gproof.cli.run_journal import alone

    with alone(runs, board):
        return run_run(
            package, board=board, record=record, real_time=real_time, hold_at=hold_at, estop_at=estop_at,
            override=override, ask=ask, replace_record=replace_record, runs=runs, after_interruption=after_interruption,
            trust=trust, machine=machine, setup=setup, source=source, allow_untrusted=allow_untrusted, port=port,
            baud=baud, progress=progress, vcd=vcd,
        )  # fmt: skip


@click.group(
    cls=Group, no_args_is_help=True, short_help="List boards and ports, ask a board what it is, get its firmware",
    examples=("gproof boards list", "gproof boards probe /dev/ttyACM0"),
)  # fmt: skip
def boards() -> None:
    """List boards and ports, ask a board what it is, and get the reference firmware."""


@boards.command(
    name="list", cls=Command, short_help="List the kinds of boards, and the ports of this computer",
    examples=("gproof boards list", "gproof boards list --json"),
)  # fmt: skip
@option("--json", "as_json", is_flag=True, help="Write JSON")
def list_(as_json: bool) -> int:
    """List the kinds of boards that "gproof run" knows, and the ports of this computer."""
    from gproof.cli.boards import run_list

    return run_list(as_json)


@boards.command(
    cls=Command, short_help="Ask the board on a port what it is; nothing moves",
    examples=("gproof boards probe /dev/ttyACM0", "gproof boards probe COM3 --baud 115200 --json"),
)  # fmt: skip
@click.argument("port")
@option("--baud", metavar="RATE", type=BAUD, help="Speed of the port [default: 250000]")
@option("--json", "as_json", is_flag=True, help="Write JSON")
def probe(port: str, baud: int | None, as_json: bool) -> int:
    """Ask the board on a port what it is: firmware, clock, pins, state.

    Nothing is configured, nothing moves. Opening its port resets some boards (Arduino Uno and Mega).
    """
    from gproof.cli.boards import run_probe

    return run_probe(port, baud, as_json)


@boards.command(
    cls=Command, short_help="Write the reference firmware for an AVR board",
    examples=(
        "gproof boards firmware --chip 2560 -o gproof-2560.hex",
        "gproof boards firmware --chip 328p -o gproof-328p.hex",
    ),
)  # fmt: skip
@option(
    "--chip",
    metavar="CHIP",
    type=OneOf(chips),
    required=True,
    help="Chip of the board (Arduino Uno, Nano: 328p; Mega, RAMPS: 2560)",
)
@option("-o", "--output", metavar=FILE, type=FileName(), required=True, help="Write the Intel hex file here")
def firmware(chip: str, output: Path) -> int:
    """Write the reference firmware, to be flashed with avrdude.

    \b
    Mega: avrdude -p m2560 -c wiring -P PORT -b 115200 -D -U flash:w:FILE
    Uno:  avrdude -p m328p -c arduino -P PORT -b 115200 -D -U flash:w:FILE
    """
    from gproof.cli.boards import run_firmware

    return run_firmware(chip, output)
