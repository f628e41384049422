"""The control channel: frames on a local TCP connection, by which a test harness is the world of the emulator.

A frame is a letter, the length of what follows (u32) and that. Moments are nanoseconds (i64) since the start,
little-endian. In simulated time this channel is the line as well: time passes only in ``R`` and ``P``.

====  ===================  =========================================================================
W     bytes                the host writes (simulated time only); no answer
R     until                time passes until the host has received something, or until then; D or L
P     until                time passes until then, whatever arrives; D or L
I     pin, level (u8)      an input is set; K
F     text                 a fault now, without its moment (``drop to-board 3``); K
S     –                    the state, as JSON; S
Q     –                    the emulator ends; K
====  ===================  =========================================================================

Answers: ``D`` now and the bytes received; ``L`` now: there is no link; ``K`` now; ``E`` text: what was wrong.
"""

from __future__ import annotations

import json
import struct
from dataclasses import dataclass

from gproof.backend.boards.emulator.emulator import Emulator
from gproof.backend.boards.emulator.faults import parsed

HEAD = struct.Struct("<cI")
MOMENT = struct.Struct("<q")
LARGEST = 1 << 16
FURTHEST = 10**14


class Broken(Exception):
    """What came is no frame: the connection is of no use any more."""


def framed(letter: bytes, data: bytes = b"") -> bytes:
    """A frame."""
    return HEAD.pack(letter, len(data)) + data


@dataclass(slots=True)
class Control:
    """Frames in, answers out. simulated: time is the harness's."""

    emulator: Emulator
    simulated: bool
    ends: bool = False
    _held: bytes = b""

    def feed(self, data: bytes) -> bytes:
        """The answers to what came; Broken."""
        self._held += data
        answers = []
        while len(self._held) >= HEAD.size and not self.ends:
            letter, size = HEAD.unpack_from(self._held)
            if size > LARGEST:
                raise Broken
            if len(self._held) < HEAD.size + size:
                break
            body = self._held[HEAD.size : HEAD.size + size]
            self._held = self._held[HEAD.size + size :]
            try:
                answers.append(self._answer(letter, body))
            except (ValueError, struct.error) as error:
                answers.append(framed(b"E", str(error).encode()[:200]))
        return b"".join(answers)

    def _answer(self, letter: bytes, body: bytes) -> bytes:
        emulator = self.emulator
        match letter:
            case b"W" if self.simulated:
                emulator.write(body)
                return b""
            case b"R" | b"P" if self.simulated:
                (until,) = MOMENT.unpack(body)
                if until > emulator.now + FURTHEST:
                    raise ValueError("that is too far away")
                emulator.advance(until, heard=letter == b"R")
                data = emulator.taken()
                letter = b"D" if emulator.connected or data else b"L"
                return framed(letter, MOMENT.pack(emulator.now) + data)
            case b"I":
                pin, level = struct.unpack("<BB", body)
                emulator.set_input(pin, int(level != 0))
            case b"F":
                for fault in parsed("0 " + body.decode("ascii", "replace")):
                    emulator.inject(fault)
            case b"S":
                return framed(b"S", json.dumps(emulator.state()).encode())
            case b"Q":
                self.ends = True
            case _:
                raise ValueError("no such request")
        return framed(b"K", MOMENT.pack(emulator.now))
