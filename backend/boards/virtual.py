"""The virtual board: runs executed to the tick in simulated or in real time, without hardware or pins.

``simulated.py`` is what it does; ``docs/boards.md`` what it models and what not.
"""

from __future__ import annotations

from gproof.backend.boards.board import VIRTUAL, Capabilities, ticks_up
from gproof.backend.boards.simulated import HostDelay, SimulatedBoard
from gproof.ir.machine import Machine

__all__ = ["HostDelay", "VirtualBoard"]

FIFO_RUNS = 1024


class VirtualBoard(SimulatedBoard):
    """See the module's text.

    motors: how many; fifo_runs: runs stored for all motors together; step_pulse, direction_setup: ticks;
    delay: how late the host is; guarded: stop all motors together at the last promised tick (False: like
    boards that notice an underrun only when the late run arrives); real_time: ticks follow the wall clock,
    ``speed`` times as fast.
    """

    def __init__(
        self,
        motors: int,
        *,
        tick_frequency: int = 16_000_000,
        fifo_runs: int = FIFO_RUNS,
        step_pulse: int = 32,
        direction_setup: int = 80,
        delay: HostDelay | None = None,
        guarded: bool = True,
        real_time: bool = False,
        speed: float = 1.0,
    ) -> None:
        is_ = Capabilities(
            name=VIRTUAL,
            motors=motors,
            tick_frequency=tick_frequency,
            fifo_runs=fifo_runs,
            step_pulse=step_pulse,
            direction_setup=direction_setup,
            real_time=real_time,
        )
        super().__init__(is_, delay=delay, guarded=guarded, speed=speed)

    @classmethod
    def for_machine(
        cls,
        machine: Machine,
        motors: int,
        *,
        fifo_runs: int = FIFO_RUNS,
        delay: HostDelay | None = None,
        guarded: bool = True,
        real_time: bool = False,
        speed: float = 1.0,
    ) -> VirtualBoard:
        """A board with the tick frequency and pulse times that the machine file states."""
        ticks = machine.board.tick_frequency
        return cls(
            motors,
            tick_frequency=ticks,
            step_pulse=ticks_up(machine.board.step_pulse, ticks),
            direction_setup=ticks_up(machine.board.direction_setup, ticks),
            fifo_runs=fifo_runs,
            delay=delay,
            guarded=guarded,
            real_time=real_time,
            speed=speed,
        )
