"""The registry of boards: one line each, under the name that ``gproof run --board`` takes.

A maker imports its board when it is called, so that a start of the command pays for none. The first line of its text
is what ``gproof boards list`` says of it; a maker takes the port from ``machine.board``.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from gproof.backend.boards.board import Board
    from gproof.ir.machine import Machine

VIRTUAL, EMULATOR, KLIPPER = "virtual", "emulator", "klipper"
REAL = frozenset({KLIPPER})
"""Boards that exist outside of this program. They have a port, and the machine file has to be written for them."""

Maker = Callable[["Machine", int, bool], "Board"]
"""Makes a board of a machine, the number of its motors, and whether it keeps to real time."""


def _virtual(machine: Machine, motors: int, real_time: bool) -> Board:
    """Moves nothing: a board inside gproof, exact to the tick, in simulated or in real time."""
    from gproof.backend.boards.virtual import VirtualBoard

    return VirtualBoard.for_machine(machine, motors, real_time=real_time)


def _emulator(machine: Machine, motors: int, real_time: bool) -> Board:
    """Moves nothing: a board with Klipper's protocol in a process of its own, which gproof starts and ends."""
    from gproof.backend.boards.emulated import EmulatedBoard

    return EmulatedBoard(machine, motors)


def _klipper(machine: Machine, motors: int, real_time: bool) -> Board:
    """A real board on a port: Klipper's micro-controller protocol, unmodified or gproof's reference firmware."""
    from gproof.backend.boards.klipper.from_machine import klipper_board

    return klipper_board(machine, motors)


def _pci7200(machine: Machine, motors: int, real_time: bool) -> Board:
    """Moves nothing: a model of the PCI-7200 timer card of WinCNC, with its pins (--vcd)."""
    from gproof.backend.boards.models.pci7200 import Pci7200

    return Pci7200.for_machine(machine, motors, real_time=real_time)


def _fifo_cpu(machine: Machine, motors: int, real_time: bool) -> Board:
    """Moves nothing: a model of a CPU of Eding CNC, with its pins (--vcd)."""
    from gproof.backend.boards.models.segment_cpu import SegmentCpu

    return SegmentCpu.for_machine(machine, motors, real_time=real_time)


def _apci8001(machine: Machine, motors: int, real_time: bool) -> Board:
    """Moves nothing: a model of the APCI-8001 of McuWIN, with its pins (--vcd)."""
    from gproof.backend.boards.models.apci import ApciSpooler

    return ApciSpooler.for_machine(machine, motors, real_time=real_time)


BOARDS: dict[str, Maker] = {
    VIRTUAL: _virtual,
    EMULATOR: _emulator,
    KLIPPER: _klipper,
    "pci7200": _pci7200,
    "eding-cpu": _fifo_cpu,
    "apci8001": _apci8001,
}
