"""Blocks on the line: length, sequence, payload, checksum, 7E; and a parser that finds them in whatever arrives.

The length (5 to 64) counts the whole block. The second byte is 0x10 and a sequence of four bits. The checksum is
the 16-bit CCITT one in its reflected form (polynomial 0x8408, first 0xFFFF, nothing applied at the end) over all before
it, its high byte first. A further 7E may precede a block. Source: Klipper's Protocol.md, "Message Blocks".
"""

from __future__ import annotations

from binascii import crc_hqx
from typing import NamedTuple

SYNC = 0x7E
SHORTEST, LONGEST = 5, 64
PAYLOAD = LONGEST - SHORTEST
"""Bytes of messages that one block holds."""

_SEQUENCE = 0x10
_REVERSED = bytes(int(f"{byte:08b}"[::-1], 2) for byte in range(256))


class Block(NamedTuple):
    """A block that arrived whole: its sequence, 0 to 15, and its messages."""

    sequence: int
    payload: bytes


def checksum(data: bytes) -> int:
    """The checksum of a block's header and payload; 0x6F91 for the nine digits from 1."""
    # The library has the same polynomial with the highest bit first: bits are reversed on the way in and out.
    turned = crc_hqx(data.translate(_REVERSED), 0xFFFF)
    return _REVERSED[turned & 0xFF] << 8 | _REVERSED[turned >> 8]


def block(sequence: int, payload: bytes) -> bytes:
    """A block ready to be sent."""
    if len(payload) > PAYLOAD:
        raise ValueError(f"{len(payload)} bytes in a block of {PAYLOAD}")
    head = bytes((SHORTEST + len(payload), _SEQUENCE | sequence & 0x0F)) + payload
    return head + checksum(head).to_bytes(2, "big") + bytes((SYNC,))


class Parser:
    """Finds blocks in a stream of bytes; keeps less than one block between calls.

    skipped: bytes that belonged to no block.
    """

    def __init__(self) -> None:
        self.skipped = 0
        self._held = b""
        self._lost = False

    def feed(self, data: bytes) -> list[Block]:
        """The blocks that end within ``data``."""
        self._held += data
        return self._parse()

    def give_up(self) -> list[Block]:
        """Nothing follows for a while: what waits for the rest of a block is none; the blocks after its start."""
        if not self._held:
            return []
        self._drop(1)
        return self._parse()

    def _drop(self, count: int) -> None:
        """Lose step: the next block can only start after a sync byte."""
        self.skipped += count
        self._held, self._lost = self._held[count:], True

    def _parse(self) -> list[Block]:
        found: list[Block] = []
        held, at, end = self._held, 0, len(self._held)
        while at < end:
            if self._lost:
                after = held.find(SYNC, at) + 1
                self.skipped += (after or end) - at
                at = after or end
                self._lost = not after
                continue
            if held[at] == SYNC:
                at += 1
                continue
            size = held[at]
            wrong = not SHORTEST <= size <= LONGEST or (at + 1 < end and held[at + 1] & 0xF0 != _SEQUENCE)
            if not wrong:
                if at + size > end:
                    break
                body = held[at : at + size - 3]
                wrong = held[at + size - 1] != SYNC or checksum(body) != held[at + size - 3] << 8 | held[at + size - 2]
            if wrong:
                self._lost = True
                continue
            found.append(Block(body[1] & 0x0F, body[2:]))
            at += size
        self._held = held[at:]
        return found
