"""Edges of pins as a value change dump (IEEE 1364, clause on VCD), for any viewer of waveforms.

Time is exact: the unit is the longest in which a tick of the board's clock is whole; femtoseconds, rounded, where none
is, from which ``round(time · frequency / 10¹⁵)`` gives the tick again.
"""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING

from gproof.backend.boards.models.pins import PinNames
from gproof.backend.runs import Ints

if TYPE_CHECKING:
    from typing import IO

    from vcd.writer import Variable

UNITS = [
    (Fraction(magnitude, 10**power), f"{magnitude} {name}")
    for power, name in ((0, "s"), (3, "ms"), (6, "us"), (9, "ns"), (12, "ps"), (15, "fs"))
    for magnitude in (100, 10, 1)
]
"""Time units that a dump may have, the longest first."""


def time_unit(tick_frequency: int) -> tuple[str, Fraction]:
    """The unit for a clock, and how many of it a tick lasts."""
    tick = Fraction(1, tick_frequency)
    for length, name in UNITS:
        if (tick / length).denominator == 1:
            return name, tick / length
    length, name = UNITS[-1]
    return name, tick / length


class VcdRecorder:
    """Writes edges to a file; OSError when it cannot."""

    def __init__(self, path: Path, board: str, names: PinNames, idle: list[int], tick_frequency: int) -> None:
        from vcd import VCDWriter

        unit, self._ticks = time_unit(tick_frequency)
        self._file: IO[str] = path.open("w", encoding="ascii", newline="\n")
        self._writer = VCDWriter(
            self._file, timescale=unit, date="", comment=f"{tick_frequency} Hz", check_values=False
        )
        self._pins: list[Variable[str]] = [
            self._writer.register_var(board, name, "wire", size=1, init=level)
            for name, level in zip(names.all, idle, strict=True)
        ]

    def write(self, ticks: Ints, pins: Ints, levels: Ints) -> None:
        """See Recorder."""
        change, variables = self._writer.change, self._pins
        whole, over = self._ticks.numerator, self._ticks.denominator
        if over == 1:
            for tick, pin, level in zip(ticks.tolist(), pins.tolist(), levels.tolist(), strict=True):
                change(variables[pin], tick * whole, level)
            return
        for tick, pin, level in zip(ticks.tolist(), pins.tolist(), levels.tolist(), strict=True):
            change(variables[pin], (2 * tick * whole + over) // (2 * over), level)

    def close(self) -> None:
        """See Recorder."""
        self._writer.close()
        self._file.close()
