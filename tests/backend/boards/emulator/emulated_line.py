"""The host's line to an emulated board in simulated time: time passes only while the host waits, or is stalled."""

from __future__ import annotations

from dataclasses import dataclass, field

from gproof.backend.boards.board import BoardError
from gproof.backend.boards.emulator.emulator import Emulator
from gproof.backend.boards.klipper.lines import Line, LineLost

LOOK = 200_000
"""Nanoseconds that a look at the line takes at least: a host that only looks does not stop the time."""


@dataclass
class EmulatedLine:
    """stalls: host seconds and how long the host does nothing there; in order."""

    board: Emulator
    stalls: list[tuple[float, float]] = field(default_factory=list)

    def connect(self) -> Line:
        """Opens it; while there is no link, a tenth of a second passes and nobody is there."""
        if not self.board.connected:
            self.board.advance(self.board.now + 10**8)
        if not self.board.connected:
            raise BoardError("there is no such port")
        return self

    def now(self) -> float:
        return self.board.now / 1e9

    def _stall(self) -> None:
        while self.stalls and self.stalls[0][0] <= self.now():
            self.board.advance(self.board.now + round(self.stalls.pop(0)[1] * 1e9))

    def read(self, until: float) -> bytes:
        self._stall()
        self.board.advance(max(self.board.now + LOOK, round(until * 1e9) + 1), heard=True)
        data = self.board.taken()
        if not data and not self.board.connected:
            raise LineLost("the line is lost")
        return data

    def write(self, data: bytes) -> None:
        self._stall()
        if not self.board.connected:
            raise LineLost("the line is lost")
        self.board.write(data)

    def close(self) -> None:
        self.board.taken()
