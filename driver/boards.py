"""What ``gproof run`` requires before a board moves (``backend/boards/registry.py`` has the boards)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from gproof.backend.boards.board import MODELLED, MOVES_NOTHING, Board, BoardError
from gproof.backend.boards.registry import BOARDS, REAL
from gproof.driver.errors import UsageError
from gproof.driver.files import require_other, require_place
from gproof.ir import codes
from gproof.ir.finding import Finding, Findings, Span
from gproof.ir.machine import Machine

VCD_START = b"$comment "
"""What the waveforms of ``backend/boards/models/vcd.py`` start with; an empty file is one that was not begun."""


def require_for(
    board: str, *, machine: Path | None, setup: str | None, trusted: bool, allow_untrusted: bool
) -> None:  # fmt: skip
    """UsageError where a board that moves something would have to believe the package alone."""
    if board in MOVES_NOTHING:
        return
    if allow_untrusted:
        raise UsageError(f"--allow-untrusted works with --board {', '.join(sorted(MOVES_NOTHING))} only")
    missing = [
        name
        for name, there in (
            ("--machine", machine is not None),
            ("--setup", setup is not None),
            ("a trusted key (--trust or gproof keys trust)", trusted),
        )
        if not there
    ]
    if missing:
        raise UsageError(f"--board {board} moves a machine and also needs {' and '.join(missing)}")


def require_port(board: str, port: str | None, baud: int | None) -> None:
    """UsageError for a port of a board that has none."""
    if port is not None and not port.strip():
        raise UsageError("--port is empty")  # and never the machine file's: another one was meant
    for option, given in (("--port", port), ("--baud", baud)):
        if given is not None and board not in REAL:
            raise UsageError(f"{option} is for boards on a port ({', '.join(sorted(REAL))}); {board} has none")


def require_pins(board: str, vcd: Path | None, inputs: tuple[Path | str | None, ...], record: Path | None) -> None:
    """UsageError for a waveform of a board that has no pins to show, and for where it cannot be written.

    Only a waveform is replaced; record: where the record of the run will be.
    """
    if vcd is None:
        return
    if board not in MODELLED:
        raise UsageError(f"--vcd is for modelled boards ({', '.join(MODELLED)}); {board} shows no pins")
    require_place(vcd, "--vcd", inputs)
    require_other(vcd, "--vcd", record, "--record")
    try:
        with vcd.open("rb") as there:
            known = there.read(len(VCD_START)) in (b"", VCD_START)
    except FileNotFoundError:
        return
    except OSError as error:
        raise UsageError(f"--vcd {vcd}: {error.strerror}") from None
    if not known:
        raise UsageError(f"--vcd {vcd}: this file exists and is not a waveform of gproof; choose another name")


def made(name: str, machine: Machine, motors: int, real_time: bool, vcd: Path | None) -> Board:
    """A board, which writes its pins to a file if one is given; UsageError where that cannot be written."""
    board = BOARDS[name](machine, motors, real_time)
    if vcd is not None:
        from gproof.backend.boards.models.model import ModelBoard

        assert isinstance(board, ModelBoard)
        try:
            board.record_vcd(vcd)
        except OSError as error:
            raise UsageError(f"--vcd {vcd}: {error.strerror or error}") from None
    return board


def plugged_in(machine: Machine, port: str | None, baud: int | None) -> Machine:
    """The machine with its board where the command line says that it is."""
    board = machine.board
    return replace(machine, board=replace(board, port=port or board.port, baud=baud or board.baud))


def unread(board: str, machine: Machine | None) -> Iterator[str]:
    """What a machine file has wired that nobody reads while a job runs on a real board."""
    if machine is None or board not in REAL:
        return
    limits = [motor.motor for motor in machine.board.motors if motor.limit is not None]
    named = [f"limit switches ({', '.join(limits)})"] * bool(limits) + ["the probe"] * (machine.board.probe is not None)
    if named:
        what = "of the machine file: not read while a job runs; they have to act without gproof"
        yield f"gproof: warning: {' and '.join(named)} {what}"


def wiring_finding(error: BoardError, files: Findings, machine: Path | None) -> Finding | None:
    """GP841 at the key of the machine file that an error of opening a board is about; None where it is about none."""
    where = getattr(error, "where", "")
    if not where or machine is None:
        return None
    return codes.BOARD_WIRING.at(files.where(f"machine.board.{where}", Span(str(machine), 0)), what=str(error))


def unusable_board(board: str, error: BoardError) -> UsageError:
    """What to say of a board that cannot be used, in one line."""
    return UsageError(f"board {board}: {error}; nothing was moved")
