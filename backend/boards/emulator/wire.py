"""Blocks and numbers as the board sends and takes them.

A block is length, 0x10 with four bits of sequence, payload, checksum (high byte first), 0x7E. Numbers are groups of
seven bits, the highest first. Source: Klipper's Protocol.md; docs/boards.md.
"""

from __future__ import annotations

from typing import NamedTuple

SYNC = 0x7E
LEAST, MOST = 5, 64
MASK = 0xFFFFFFFF


def _table() -> tuple[int, ...]:
    rows = []
    for byte in range(256):
        for _ in range(8):
            byte = byte >> 1 ^ (0x8408 if byte & 1 else 0)
        rows.append(byte)
    return tuple(rows)


_CRC = _table()


def crc16(data: bytes | bytearray) -> int:
    """CRC-16 of a block's header and payload: reflected, from 0xFFFF, not inverted at the end."""
    crc = 0xFFFF
    for byte in data:
        crc = crc >> 8 ^ _CRC[(crc ^ byte) & 0xFF]
    return crc


def frame(sequence: int, payload: bytes = b"") -> bytes:
    """The block of a payload of at most 59 bytes."""
    head = bytes((len(payload) + LEAST, 0x10 | sequence & 15)) + payload
    crc = crc16(head)
    return head + bytes((crc >> 8, crc & 0xFF, SYNC))


def number(value: int) -> bytes:
    """A number of 32 bits, signed or not, in the fewest groups."""
    value &= MASK
    if value >> 31:
        value -= 1 << 32
    groups = [value & 0x7F]
    # A group of seven bits leads when its sign rule gives the value back: -32 … 95.
    while not -32 <= value < 96:
        value >>= 7
        groups.append(value & 0x7F | 0x80)
    return bytes(reversed(groups))


class Short(Exception):
    """A payload ends within a message."""


def take_number(data: bytes, place: int) -> tuple[int, int]:
    """The number at a place, as its image of 32 bits without sign, and the place after it; Short."""
    try:
        byte = data[place]
        value = byte & 0x7F
        if byte & 0x60 == 0x60:
            value -= 0x80
        place += 1
        while byte & 0x80:
            byte = data[place]
            value = value << 7 | byte & 0x7F
            place += 1
    except IndexError:
        raise Short from None
    return value & MASK, place


def signed(value: int, bits: int = 32) -> int:
    """The lowest ``bits`` of a number, with sign."""
    value &= (1 << bits) - 1
    return value - (1 << bits) if value >> (bits - 1) else value


class Block(NamedTuple):
    """What was found in received bytes: a payload, or None for one that asks for a nak; sequence: 0 to 15."""

    sequence: int
    payload: bytes | None


class Receiver:
    """Finds blocks as an AVR does: one block is answered at a time, one nak until something is right again."""

    def __init__(self, room: int) -> None:
        self.room = room
        self.held = bytearray()
        self._lost = False
        self._blamed = False

    @property
    def needs(self) -> int:
        """Bytes that have to come before ``next`` can find more; 0: it may find something now."""
        held = self.held
        if not held or self._lost or held[0] == SYNC:
            return 0 if held else 1
        if not LEAST <= held[0] <= MOST:
            return 0
        if len(held) > 1 and held[1] & 0xF0 != 0x10:
            return 0
        return max(0, (held[0] if len(held) > 1 else 2) - len(held))

    def next(self) -> Block | None:
        """The next block or request for a nak; None: more bytes have to come."""
        held = self.held
        while held:
            if self._lost:
                place = held.find(SYNC)
                if place < 0:
                    held.clear()
                    return None
                del held[: place + 1]
                self._lost = False
                if not self._blamed:
                    self._blamed = True
                    return Block(0, None)
                continue
            if held[0] == SYNC:
                del held[0]
                continue
            if self.needs:
                return None
            size = held[0]
            if (
                LEAST <= size <= MOST
                and held[1] & 0xF0 == 0x10
                and held[size - 1] == SYNC
                and crc16(held[: size - 3]) == held[size - 3] << 8 | held[size - 2]
            ):
                block = Block(held[1] & 15, bytes(held[2 : size - 3]))
                del held[:size]
                self._blamed = False
                return block
            self._lost = True
        return None
