"""A board from outside; not being the virtual one it asks for more. Importing it registers it."""

from __future__ import annotations

import dataclasses

from gproof.backend.boards import registry
from gproof.backend.boards.board import Board, Capabilities
from gproof.backend.boards.virtual import VirtualBoard
from gproof.ir.machine import Machine

FILES = ("backend/boards/toy.py", "backend/boards/registry.py", "tests/backend/test_toy_board.py")
REGISTRY = "backend/boards/registry.py"


class Toy(VirtualBoard):
    """Moves what a virtual board moves."""

    def open(self) -> Capabilities:
        return dataclasses.replace(super().open(), name="toy")


def make(machine: Machine, motors: int, real_time: bool) -> Board:
    return Toy.for_machine(machine, motors, real_time=real_time)


registry.BOARDS["toy"] = make
