"""The host's line to an emulated board in simulated time: time passes only while the host waits, or is stalled."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from gproof.backend.boards.board import BoardError
from gproof.backend.boards.emulator.emulator import Emulator
from gproof.backend.boards.klipper.lines import Line, LineLost

LOOK = 200_000
"""Nanoseconds that a look at the line takes at least: a host that only looks does not stop the time."""


@dataclass
class EmulatedLine:
    """stalls: host seconds and how long the host does nothing there, in order; taken: host seconds between which
    another program has the port, when nobody else has it; write_through: how bytes of the host go out; alive: raises
    when the host is not; visitor: called at each look at the line."""

    board: Emulator
    stalls: list[tuple[float, float]] = field(default_factory=list)
    taken: tuple[float, float] = (0.0, 0.0)
    write_through: Callable[[Callable[[bytes], object], bytes], object] = lambda write, data: write(data)
    alive: Callable[[], None] = lambda: None
    visitor: Callable[[], None] | None = None
    held: bool = False

    def connect(self) -> Line:
        """Opens it; while there is no link, a tenth of a second passes and nobody is there."""
        self.alive()
        if self.held:
            raise BoardError("another program uses it")
        busy = self.taken[0] <= self.now() < self.taken[1]
        if busy or not self.board.connected:
            self.board.advance(self.board.now + 10**8)
        if busy:
            raise BoardError("another program uses it")
        if not self.board.connected:
            raise BoardError("there is no such port")
        self.held = True
        return self

    def now(self) -> float:
        return self.board.now / 1e9

    def _stall(self) -> None:
        while self.stalls and self.stalls[0][0] <= self.now():
            self.board.advance(self.board.now + round(self.stalls.pop(0)[1] * 1e9))

    def read(self, until: float) -> bytes:
        self.alive()
        if self.visitor is not None:
            self.visitor()
        self._stall()
        self.board.advance(max(self.board.now + LOOK, round(until * 1e9) + 1), heard=True)
        data = self.board.taken()
        self._stall()
        if not data and not self.board.connected:
            raise LineLost("the line is lost")
        return data

    def write(self, data: bytes) -> None:
        self._stall()
        if not self.board.connected:
            raise LineLost("the line is lost")
        self.write_through(self.board.write, data)

    def close(self) -> None:
        self.board.taken()
        self.held = False
