"""The registry of boards: one line each, under the name that ``gproof run --board`` takes.

A maker imports its board when it is called, so that a start of the command pays for none.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from gproof.backend.boards.board import Board
    from gproof.ir.machine import Machine

VIRTUAL = "virtual"
"""The one board that moves nothing: an emulator, a model or a simulator on a port is a board that does, since what
hangs on a port is known to nobody here. So rules are about this name, and a board that is added falls under them."""

Maker = Callable[["Machine", int, bool], "Board"]
"""Makes a board of a machine, the number of its motors, and whether it keeps to real time."""


def _virtual(machine: Machine, motors: int, real_time: bool) -> Board:
    from gproof.backend.boards.virtual import VirtualBoard

    return VirtualBoard.for_machine(machine, motors, real_time=real_time)


BOARDS: dict[str, Maker] = {VIRTUAL: _virtual}
