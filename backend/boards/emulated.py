"""A board emulator in a process of its own, started with the run and ended with it: ``--board emulator``.

The driver is that of a real board, and so is the line: a pseudo-terminal, or a local TCP port where the system has
none. The process ends when it is told to, when its host has gone, and when the process that started it is gone.
"""

from __future__ import annotations

import contextlib
import re
import subprocess
import sys
import threading
from dataclasses import replace

from gproof.backend.boards.board import EMULATOR, BoardError, Capabilities
from gproof.backend.boards.klipper.driver import KlipperBoard
from gproof.backend.boards.klipper.from_machine import NotWired, own_pins, require_motors, ticks_of, wiring_of
from gproof.backend.boards.klipper.lines import BAUD, Line, SerialLine
from gproof.ir.machine import Machine, Pin, WiredMotor, WiredOutput

MODULE = "gproof.backend.boards.emulator"
START_TIME, END_TIME = 20.0, 5.0
"""Seconds that it has to say where its port is, and to end."""

_PORTS = "ABCDEFGHJKL"
_PIN = re.compile(rf"P[{_PORTS}][0-7]")
"""Pins of the emulated ATmega2560."""


class EmulatedBoard(KlipperBoard):
    """A board with Klipper's protocol whose other side is an emulator."""

    def __init__(self, machine: Machine, motors: int) -> None:
        board = machine.board
        wired = as_wired(machine)
        wiring = wiring_of(wired)
        require_motors(wiring, motors)
        self._baud_rate = board.baud or BAUD
        self._arguments = ["--frequency", str(board.tick_frequency), "--baud", str(self._baud_rate)]
        self._emulator: subprocess.Popen[str] | None = None
        self._address = ""
        pulse, setup = ticks_of(machine)
        super().__init__(
            self._open_line, wiring, pulse=pulse, direction_setup=setup, baud=self._baud_rate,
            frequency=board.tick_frequency, name=EMULATOR,
        )  # fmt: skip

    def _open_line(self) -> Line:
        if self._emulator is None or self._emulator.poll() is not None:
            self._start_process()
        return SerialLine(self._address, self._baud_rate)

    def _start_process(self) -> None:
        # A session of its own: a Ctrl-C at the terminal is for the host, which brings the board to rest first.
        self._emulator = subprocess.Popen(
            [sys.executable, "-m", MODULE, *self._arguments], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
            stderr=subprocess.PIPE, text=True, start_new_session=True,
        )  # fmt: skip
        assert self._emulator.stdout is not None and self._emulator.stderr is not None
        late = threading.Timer(START_TIME, self._emulator.kill)
        late.start()
        try:
            line = self._emulator.stdout.readline()
        finally:
            late.cancel()
        if not line.startswith("port: "):
            why = self._emulator.stderr.read().strip().splitlines()
            self._end_process()
            raise BoardError(f"the board emulator did not start{': ' if why else ''}{why[-1] if why else ''}")
        self._address = line.removeprefix("port: ").strip()

    def open(self) -> Capabilities:
        """See Board; starts the process."""
        try:
            return super().open()
        except BaseException:
            self._end_process()
            raise

    def close(self) -> None:
        """See Board; the process ends."""
        super().close()
        self._end_process()

    def _end_process(self) -> None:
        process, self._emulator = self._emulator, None
        if process is None:
            return
        with contextlib.suppress(OSError):
            process.terminate()
        try:
            process.wait(END_TIME)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
        for stream in (process.stdout, process.stderr):
            if stream is not None:
                stream.close()


def as_wired(machine: Machine) -> Machine:
    """The machine with its own pins where the emulated chip has all of them; else with pins in order."""
    if all(_PIN.fullmatch(pin.name) for pin in own_pins(machine)):
        with contextlib.suppress(NotWired):
            wiring_of(machine)
            return machine
    pins = (Pin(name=f"P{port}{bit}") for port in _PORTS for bit in range(8))
    board = machine.board
    before = {motor.motor: motor for motor in board.motors}
    motors = []
    for axis in machine.axes:
        for drive in axis.drives():
            known = before.get(drive.name)
            step, direction = next(pins), next(pins)
            if known is not None:
                step = replace(step, inverted=known.step.inverted)
                direction = replace(direction, inverted=known.direction.inverted)
            motors.append(WiredMotor(motor=drive.name, step=step, direction=direction))
    outputs = tuple(
        WiredOutput(output=one.output, pin=replace(next(pins), inverted=one.pin.inverted), idle=one.idle)
        for one in board.outputs
    )
    return replace(machine, board=replace(board, motors=tuple(motors), outputs=outputs, probe=None))
