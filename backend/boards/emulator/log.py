"""The board's own log: every step made, every output, every stop; the judge of what a host claims.

The file is ``MAGIC`` and rows of 32 bytes, little-endian: kind (one letter), index, direction, 0, count (u32), tick
(i64), interval (u32), add (i32), nanosecond of the world (i64). Ticks are those of the board's clock since the reset
before, not cut to 32 bits; ``boot`` counts the resets. Kinds:

S  steps of the motor with this step pin (index): ``count`` steps, the first ``interval`` ticks after ``tick``, the
   interval growing by ``add``, in ``direction``
O  an output pin (index) is set to ``count``
X  shutdown; index: bytes of the reason, which follows in as many rows as it needs
B  the chip starts (again)
C  a section starts: ``count`` is its number, ``tick`` its tick 0
E  a section is over
L  the link is closed (count 0) or open (1)
"""

from __future__ import annotations

import struct
from typing import BinaryIO

MAGIC = b"gproof-emulator-log/1\n"
ROW = struct.Struct("<cBbxIqIiq")
HELD = 1 << 16
"""Bytes that wait in memory before they are written."""


class Log:
    """Writes rows. file: None keeps them in memory, for tests; keep: no: nowhere."""

    def __init__(self, file: BinaryIO | None = None, *, keep: bool = True) -> None:
        self._file = file
        self._keep = keep or file is not None
        self.held = bytearray(MAGIC)

    def row(
        self, kind: bytes, at: int, *, index: int = 0, direction: int = 0, count: int = 0, tick: int = 0,
        interval: int = 0, add: int = 0,
    ) -> None:  # fmt: skip
        """Write a row."""
        if not self._keep:
            return
        self.held += ROW.pack(kind, index, direction, count, tick, interval, add, at)
        if self._file is not None and len(self.held) > HELD:
            self.flush()

    def stop(self, at: int, tick: int, reason: str) -> None:
        """Write why the board stopped."""
        if not self._keep:
            return
        text = reason.encode()[:255]
        self.row(b"X", at, index=len(text), tick=tick)
        self.held += text + bytes(-len(text) % ROW.size)
        self.flush()

    def flush(self) -> None:
        """Hand everything to the system."""
        if self._file is not None:
            self._file.write(self.held)
            self._file.flush()
            self.held.clear()
