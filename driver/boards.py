"""The boards that ``gproof run`` knows, and what each of them asks for before it moves.

Only the one named ``virtual`` is virtual: an emulator, a model or a simulator behind a port is a board, since
what hangs on a port is known to nobody here. So the rule is about the name, and a board that is added falls under it.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from gproof.backend.boards.board import Board
    from gproof.ir.machine import Machine

VIRTUAL = "virtual"


def _virtual(machine: Machine, motors: int, real_time: bool) -> Board:
    from gproof.backend.boards.virtual import VirtualBoard

    return VirtualBoard.for_machine(machine, motors, real_time=real_time)


BOARDS: dict[str, Callable[[Machine, int, bool], Board]] = {VIRTUAL: _virtual}
"""How each board is made: of a machine, the number of its motors, and whether it keeps to real time."""


def require_for(
    board: str, *, machine: Path | None, setup: str | None, trusted: bool, allow_untrusted: bool
) -> None:  # fmt: skip
    """UsageError where a board that is not virtual would have to believe the package alone."""
    from gproof.cli.main import UsageError

    if board == VIRTUAL:
        return
    if allow_untrusted:
        raise UsageError(f"--allow-untrusted: is for --board {VIRTUAL} only")
    missing = [
        name
        for name, there in (
            ("--machine", machine is not None),
            ("--setup", setup is not None),
            ("a trusted key (--trust, or gproof keys trust)", trusted),
        )
        if not there
    ]
    if missing:
        raise UsageError(f"--board {board}: is a board that moves something, and asks for {' and '.join(missing)} too")
