"""Integers and byte strings as they travel: groups of seven bits, the highest first, 0x80 meaning that more follow.

A number is an int32; a uint32 travels as the int32 with the same bits. Where bits 5 and 6 of the first byte are both
set the number is negative, so one byte holds -32 to 95 and two hold -4096 to 12287. A byte string is its length and
its bytes. Source: Klipper's Protocol.md, "Variable Length Quantities" and "Variable length strings".
"""

from __future__ import annotations

from functools import cache

LONGEST = 5
"""Bytes of one number: 32 bits in groups of seven."""

_SMALL_LEAST, _SMALL_MOST = -(1 << 12), 3 << 12


class Malformed(ValueError):
    """Bytes that are no number or string of this kind."""


def signed(number: int) -> int:
    """The int32 with the bits of a uint32 or int32; ValueError for what has more than 32 bits."""
    if not -(1 << 31) <= number < 1 << 32:
        raise ValueError(f"{number} has more than 32 bits")
    return number - (1 << 32) if number >= 1 << 31 else number


def encoded(number: int) -> bytes:
    """A number, int32 or uint32, in as few bytes as hold it."""
    number = signed(number)
    groups = 1
    while not -(1 << (7 * groups - 2)) <= number < 3 << (7 * groups - 2):
        groups += 1
    out = bytearray((number >> (7 * place)) & 0x7F | 0x80 for place in range(groups - 1, -1, -1))
    out[-1] &= 0x7F
    return bytes(out)


@cache
def small() -> tuple[bytes, ...]:
    """The encodings of -4096 to 12287 by index: negative numbers count from the end of the table."""
    return tuple(encoded(n) for n in (*range(_SMALL_MOST), *range(_SMALL_LEAST, 0)))


def quick(number: int) -> bytes:
    """``encoded`` by the table where that holds the number."""
    return small()[number] if _SMALL_LEAST <= number < _SMALL_MOST else encoded(number)


def decoded(data: bytes, place: int) -> tuple[int, int]:
    """The int32 that starts at ``place``, and where the next value starts; Malformed."""
    end = min(len(data), place + LONGEST)
    if place >= end:
        raise Malformed("a number is missing")
    byte = data[place]
    number = byte & 0x7F
    if byte & 0x60 == 0x60:
        number -= 0x80
    while byte & 0x80:
        place += 1
        if place >= end:
            raise Malformed("a number does not end")
        byte = data[place]
        number = number << 7 | byte & 0x7F
    return signed(number & 0xFFFFFFFF), place + 1


def string_encoded(data: bytes) -> bytes:
    """A byte string: its length, then itself."""
    return encoded(len(data)) + data


def string_decoded(data: bytes, place: int) -> tuple[bytes, int]:
    """The byte string that starts at ``place``, and where the next value starts; Malformed."""
    length, place = decoded(data, place)
    if not 0 <= length <= len(data) - place:
        raise Malformed("a string does not end")
    return bytes(data[place : place + length]), place + length
