"""The certification extension: whose steps are made, and up to which tick nothing is missing. docs/boards.md."""

from __future__ import annotations

import struct

from gproof.backend.boards.emulator.motors import Refused

NEVER_STARTED = 0xFFFFFFFF
IDENTITY = 32
"""Bytes of a stream's identity: SHA-256."""

NOBODY, READY, RUNNING = 0, 1, 2


class Sections:
    """Identity, section and promise since the last reset. Ticks are not cut to 32 bits."""

    def __init__(self) -> None:
        self.state = NOBODY
        self.identity = b""
        self.number = NEVER_STARTED
        self.base = 0
        self.last_promise = 0
        self._promise: int | None = None
        self._end: int | None = None

    def begin(self, identity: bytes, active: bool) -> None:
        """The host says which stream it runs; Refused."""
        if len(identity) != IDENTITY or active or self.state == RUNNING:
            raise Refused("Not certified")
        self.identity, self.state = identity, READY

    def start(self, number: int, tick: int, active: bool) -> bytes:
        """A section starts; what the CRC of each motor starts with. Refused."""
        if self.state != READY or active:
            raise Refused("Not certified")
        self.state, self.number, self.base = RUNNING, number, tick
        self._promise = self.last_promise = tick
        self._end = None
        return self.identity + struct.pack("<I", number)

    def check_step(self) -> None:
        """Refused where no step may be queued."""
        if self.state != RUNNING or self._end is not None:
            raise Refused("Not certified")

    def commit(self, tick: int | None) -> None:
        """A promise, or (None) that there is none until the next."""
        self.check_step()
        self._promise = tick
        if tick is not None:
            self.last_promise = tick

    def finish(self, tick: int) -> None:
        """Nothing follows; the section is over at a tick."""
        self.check_step()
        self._promise, self._end = None, tick

    def due(self) -> int | None:
        """The first tick past the promise, or the end of the section."""
        if self.state != RUNNING:
            return None
        if self._end is not None:
            return self._end
        return None if self._promise is None else self._promise + 1

    def expired(self, tick: int) -> bool:
        """Whether the promise has passed at a tick."""
        return self.state == RUNNING and self._promise is not None and tick > self._promise

    def over(self, tick: int, last: int) -> bool:
        """Whether the section ends at this tick; where motors still move it ends with their last step."""
        if self.state != RUNNING or self._end is None or tick < self._end:
            return False
        if last > tick:
            self._end = last
            return False
        self.state, self._end = READY, None
        return True

    def forget(self) -> None:
        """A shutdown: the host has to say again which stream it runs; which one it was stays readable."""
        self.state = NOBODY
        self._promise = self._end = None
