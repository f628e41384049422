"""The host's line to a firmware on a simulated chip, by pyserial, and what the pins have to do for a stream.

The bytes go over a pseudo-terminal as they go over a cable. The time is that of the chip's cycles, and passes only
while the host waits: a run is the same on a busy machine as on one that has nothing else to do.
"""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from typing import Protocol

import numpy as np
from support.simulated_board import HZ, Simulation

from gproof.backend.boards.klipper.driver import KlipperBoard
from gproof.backend.boards.klipper.from_machine import ticks_of, wiring_of
from gproof.backend.boards.klipper.lines import SerialLine
from gproof.ir.columns import Columns
from gproof.ir.machine import Machine, Pin, WiredOutput
from gproof.ir.stream import Motor, StreamSection
from gproof.ir.trace import Op

LOOK = 1600
"""Cycles that a look at the line takes at least: a host that only looks does not stop the time."""

ARRIVES = 10.0
"""Seconds of this machine in which a byte that was sent has to be there."""

UART_RATE = 227_270
"""Bits a second of simavr's UART at 250,000 baud, ten a byte: it counts eleven."""

EARLIEST, LATEST = -64, 640
"""Cycles in which an edge comes about its tick, at up to 20,000 steps a second of all motors."""


class SimulatedLine(SerialLine):
    """A port of pyserial in the time of the chip at its other end."""

    def __init__(self, chip: Simulation) -> None:
        super().__init__(chip.port)
        self._chip = chip
        # Opening a port drops what came before.
        self._cycle, self._heard = chip.until(1, chip.written)

    def now(self) -> float:
        return self._cycle / HZ

    def write(self, data: bytes) -> None:
        super().write(data)
        self._chip.written += len(data)

    def read(self, until: float) -> bytes:
        wanted = max(self._cycle + LOOK, math.ceil(until * HZ))
        self._cycle, said = self._chip.until(wanted, self._chip.written)
        data, limit = b"", time.monotonic() + ARRIVES
        while self._heard + len(data) < said:
            assert time.monotonic() < limit, "bytes that the board said do not come"
            data += super().read(limit)
        self._heard = said
        return data


class Recorded(KlipperBoard):
    """The driver on a simulated chip; ``bases``: the clock tick 0 of each section that it started."""

    def __init__(self, chip: Simulation, machine: Machine) -> None:
        pulse, setup = ticks_of(machine)
        super().__init__(
            lambda: SimulatedLine(chip), wiring_of(machine), pulse=pulse, direction_setup=setup, baud=UART_RATE,
            frequency=HZ,
        )  # fmt: skip
        self.bases: list[int] = []

    def start_section(self, number: int, start: tuple[int, ...], lead: int) -> int:
        base = super().start_section(number, start, lead)
        self.bases.append(base)
        return base


def number_of(pin: Pin) -> int:
    """A pin's number in the simulation: 8 for each port letter, and its bit."""
    return 8 * (ord(pin.name[1]) - ord("A")) + int(pin.name[2])


def steps_of(runs: Columns) -> tuple[np.ndarray, np.ndarray]:
    """Tick of the section and direction of every step, worked out from what a run means."""
    interval, count, add, direction = (
        runs[name].astype(np.int64) for name in ("interval", "count", "add", "direction")
    )
    k = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
    return np.cumsum(np.repeat(interval, count) + np.repeat(add, count) * k), np.repeat(direction, count)


class Edges(Protocol):
    """What was seen at pins."""

    def edges(self) -> np.ndarray:
        """Rows (tick, pin, level)."""


def judge(
    chip: Edges, machine: Machine, motors: Sequence[Motor], sections: Sequence[tuple[int, StreamSection]]
) -> tuple[int, int]:  # fmt: skip
    """All steps of these sections, each with its clock tick 0, are on their pins in time and direction, and no more.

    Gives how early and how late the earliest and the latest were, cycles. AssertionError.
    """
    edges, board = chip.edges(), machine.board
    pulse, setup = ticks_of(machine)
    wired = {motor.motor: motor for motor in board.motors}
    lowest, highest = 0, 0
    others = np.ones(len(edges), dtype=bool)
    for k, motor in enumerate(motors):
        pins = wired[motor.name]
        parts = [(base, *steps_of(section.runs[k])) for base, section in sections]
        ticks = np.concatenate([base + tick for base, tick, _ in parts])
        direction = np.concatenate([way for *_, way in parts])
        of_step, of_direction = (edges[:, 1] == number_of(pin) for pin in (pins.step, pins.direction))
        others &= ~of_step & ~of_direction
        begins = edges[of_step & (edges[:, 2] == int(not pins.step.inverted)), 0]
        ends = edges[of_step & (edges[:, 2] == int(pins.step.inverted)), 0]
        ends = ends[len(ends) - len(begins) :]  # an inverted pin goes high once when it is configured
        assert len(begins) == len(ticks), f"{motor.name}: {len(begins)} steps, and {len(ticks)} are in the stream"
        if not len(ticks):
            continue
        late = begins - ticks
        lowest, highest = min(lowest, int(late.min())), max(highest, int(late.max()))
        assert late.min() >= EARLIEST and late.max() <= LATEST, (
            f"{motor.name}: {late.min()} to {late.max()} cycles late"
        )
        assert (ends - begins).min() >= pulse, f"{motor.name}: a pulse of {(ends - begins).min()} cycles"
        turns = edges[of_direction]
        before = np.searchsorted(turns[:, 0], begins)
        level = np.concatenate(([0], turns[:, 2]))[before]
        assert ((level == 1) == ((direction > 0) != pins.direction.inverted)).all(), f"{motor.name}: a wrong direction"
        if len(turns):
            held = begins - np.concatenate(([-(2**40)], turns[:, 0]))[before]
            assert held.min() >= setup, f"{motor.name}: the direction changed {held.min()} cycles before a step"
    known = [number_of(output.pin) for output in board.outputs]
    known += [number_of(motor.enable) for motor in board.motors if motor.enable is not None]
    assert set(edges[others, 1].tolist()) <= set(known), "pins changed that are not wired"
    for output in board.outputs:
        _judge_output(edges, output, sections)
    return lowest, highest


def _judge_output(edges: np.ndarray, output: WiredOutput, sections: Sequence[tuple[int, StreamSection]]) -> None:
    """From its first section to its last an output changes when the stream says so, and at no other time."""
    ticks, ways, now = [], [], output.idle
    for base, section in sections:
        for tick, _, op, arg in section.events.rows():
            on = now
            if op == Op.SPINDLE and output.output in ("spindle", "spindle_reverse"):
                on = arg[0] > 0 if output.output == "spindle" else arg[0] < 0
            elif op == Op.COOLANT and output.output in ("mist", "flood"):
                on = arg[("mist", "flood").index(output.output)] != 0
            elif op == Op.OUTPUT and output.output == str(arg[0] // 1000):
                on = arg[1] != 0
            if on != now:
                now = on
                ticks.append(base + tick)
                ways.append(on)
    begin, end = sections[0][0] + EARLIEST, sections[-1][0] + sections[-1][1].duration + LATEST
    made = edges[(edges[:, 1] == number_of(output.pin)) & (edges[:, 0] >= begin) & (edges[:, 0] <= end)]
    assert len(made) == len(ticks), f"{output.output}: {len(made)} changes, and {len(ticks)} are in the stream"
    late = made[:, 0] - np.array(ticks, dtype=np.int64)
    assert ((late >= EARLIEST) & (late <= LATEST)).all(), f"{output.output}: {late} cycles late"
    assert [level != int(output.pin.inverted) for level in made[:, 2].tolist()] == ways, (
        f"{output.output}: the wrong way"
    )
