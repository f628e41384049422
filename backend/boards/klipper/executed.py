"""The CRC-32 of what a motor executed in a section, as firmware with the certification extension counts it.

Of the stream's identity and the section's number, then of each new clock base and each run in order, with the steps
that were made. Runs that go on where the one before ended count as one, so it does not matter where the host cut them.
Source: docs/boards.md, "Count and CRC".
"""

from __future__ import annotations

import struct
import zlib

_BASE, _RUN = struct.Struct("<cI"), struct.Struct("<cIIhB")
_WORD = 0xFFFFFFFF


class RunSum:
    """One motor in one section. steps: made so far."""

    def __init__(self, identity: bytes, section: int) -> None:
        self.steps = 0
        self._closed = zlib.crc32(identity + struct.pack("<I", section))
        self._open: tuple[int, int, int, int] | None = None

    def base(self, tick: int) -> None:
        """A new clock base, in ticks of the section."""
        self._close()
        self._closed = zlib.crc32(_BASE.pack(b"B", tick & _WORD), self._closed)

    def run(self, interval: int, count: int, add: int, level: int) -> None:
        """Steps that were made, ``interval`` after the one before, growing by ``add``; level: of the direction pin."""
        if not count:
            return
        self.steps += count
        if self._open is not None:
            first, made, grows, before = self._open
            if (before, grows) == (level, add) and (first + made * grows - interval) & _WORD == 0:
                self._open = first, made + count, grows, level
                return
        self._close()
        self._open = interval, count, add, level

    @property
    def crc(self) -> int:
        """The CRC-32 now."""
        if self._open is None:
            return self._closed
        interval, count, add, level = self._open
        return zlib.crc32(_RUN.pack(b"R", interval, count, add, level), self._closed)

    def _close(self) -> None:
        self._closed, self._open = self.crc, None
