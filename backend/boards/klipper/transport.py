"""Blocks sent in a window, acknowledged, sent again; without a port, a thread or a clock of its own.

The board takes blocks in order and answers each with an empty block that carries the sequence it expects next; so do
the responses that it sends before. An empty block with the sequence of the empty block before it asks for a block
again. A board drops what comes after a block that it missed, so everything from there on is sent again. Blocks in
flight are at most 12 and hold no more bytes than the board's receive buffer. Source: Klipper's Protocol.md, "Message
flow"; window and times: docs/boards.md.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from typing import NamedTuple

from gproof.backend.boards.klipper.blocks import PAYLOAD, SYNC, Parser, block
from gproof.ir.record import record

MOST_BLOCKS = 12
"""In flight: four bits of sequence tell 15 from none, and some have to be left to tell old answers."""

WINDOW = 192
"""Bytes in flight to a board that does not state its receive buffer: an AVR's."""

SHORTEST_WAIT, LONGEST_WAIT = 0.025, 5.0
"""Seconds until what was not acknowledged is sent again."""

REMEMBERED = 16
"""Blocks whose sending time is kept: as many as a sequence can name."""


@record(slots=True)
class _Sent:
    sequence: int
    data: bytes
    messages: int
    first_sent: float
    again: bool = False


@record(slots=True)
class Counts:
    """What went over the line: blocks sent, sent again after a nak or for want of an answer, bytes out and in."""

    blocks: int = 0
    after_nak: int = 0
    after_wait: int = 0
    bytes_out: int = 0
    bytes_in: int = 0


class Received(NamedTuple):
    """Messages that arrived: the bytes; when the block before was sent for the first time: not later than they were
    made."""

    payload: bytes
    asked: float


class Transport:
    """One connection. Times are host seconds.

    window: bytes in flight at most. sequence: the next block's, counted on beyond its four bits.
    acknowledged: messages that the board has taken, of those given to ``send`` in order.
    """

    def __init__(self, sequence: int = 0, window: int = WINDOW) -> None:
        self.window = window
        self.counts = Counts()
        self.parser = Parser()
        self.acknowledged = 0
        self._given = 0
        self._expected = self._next = sequence
        self._last_empty = sequence
        self._stale_naks = 0
        self._nak = False
        self._waiting: deque[tuple[bytes, int | None]] = deque()
        self._hurry = False
        self._flying: deque[_Sent] = deque()
        self._bytes_flying = 0
        self._sent_at: deque[tuple[int, float]] = deque(maxlen=REMEMBERED)
        self._round_trip: float | None = None
        self._spread = 0.0
        self._wait = 4 * SHORTEST_WAIT
        self._deadline = 0.0

    # Sending.

    def send(self, message: bytes, due: int | None = None, *, now: bool = True) -> int:
        """Queue a message; its number. due: the board's tick before which it has to arrive; now: wait for no others."""
        if not 0 < len(message) <= PAYLOAD:
            raise ValueError(f"a message of {len(message)} bytes")
        self._waiting.append((message, due))
        self._hurry |= now
        self._given += 1
        return self._given

    def hurry(self) -> None:
        """Send what is queued even if it does not fill a block."""
        self._hurry = True

    def forget(self) -> None:
        """Drop what has not been sent yet."""
        self._given -= len(self._waiting)
        self._waiting.clear()

    @property
    def next_sequence(self) -> int:
        """Of the next block."""
        return self._next

    @property
    def sent(self) -> int:
        """Messages that have gone out, of those given to ``send`` in order."""
        return self._given - len(self._waiting)

    @property
    def due(self) -> int | None:
        """The tick before which the next message has to arrive."""
        return self._waiting[0][1] if self._waiting else None

    @property
    def idle(self) -> bool:
        """Whether everything has been acknowledged."""
        return not self._waiting and not self._flying

    @property
    def flying(self) -> bool:
        """Whether something has gone out and was not acknowledged."""
        return bool(self._flying)

    def out(self, now: float) -> bytes:
        """The bytes to write at this moment."""
        parts: list[bytes] = []
        if self._flying and (self._nak or now >= self._deadline):
            parts += self._repeat(now)
        while self._waiting and len(self._flying) < MOST_BLOCKS:
            payload, messages = self._filled()
            if not messages:
                break
            for _ in range(messages):
                self._waiting.popleft()
            if not self._waiting:
                self._hurry = False
            made = block(self._next & 0x0F, payload)
            if not self._flying:
                self._deadline = now + self._wait
            self._flying.append(_Sent(self._next, made, messages, now))
            self._bytes_flying += len(made)
            self._sent_at.append((self._next, now))
            self._next += 1
            self.counts.blocks += 1
            parts.append(made)
        data = b"".join(parts)
        self.counts.bytes_out += len(data)
        return data

    def _filled(self) -> tuple[bytes, int]:
        """The payload of the next block and how many messages it has: none where it has to wait."""
        room = min(PAYLOAD, self.window - self._bytes_flying - 5)
        parts: list[bytes] = []
        size = 0
        for message, _ in self._waiting:
            if size + len(message) > PAYLOAD:
                break
            parts.append(message)
            size += len(message)
        full = len(parts) < len(self._waiting)
        if size > room and self._flying:
            return b"", 0
        # A block that is not full may wait for others as long as an answer is on its way.
        if not full and self._flying and not self._hurry:
            return b"", 0
        return b"".join(parts), len(parts)

    def _repeat(self, now: float) -> Sequence[bytes]:
        """Everything in flight once more, after a sync byte for a board that has lost step."""
        if self._nak:
            self.counts.after_nak += len(self._flying)
        else:
            self.counts.after_wait += len(self._flying)
            self._wait = min(LONGEST_WAIT, 2 * self._wait)
        self._nak = False
        self._stale_naks = len(self._flying) - 1
        self._deadline = now + self._wait
        for sent in self._flying:
            sent.again = True
        return [bytes((SYNC,)), *(sent.data for sent in self._flying)]

    def next_time(self) -> float | None:
        """When ``out`` has something to say although nothing arrived; None: never."""
        return self._deadline if self._flying else None

    # Receiving.

    def feed(self, data: bytes, now: float) -> list[Received]:
        """Take what arrived; the messages in it."""
        self.counts.bytes_in += len(data)
        return self._take(self.parser.feed(data), now)

    def give_up(self, now: float) -> list[Received]:
        """Nothing has arrived for a while: half a block is none."""
        return self._take(self.parser.give_up(), now)

    def _take(self, blocks: Sequence[tuple[int, bytes]], now: float) -> list[Received]:
        found: list[Received] = []
        for low, payload in blocks:
            sequence = self._expected + ((low - self._expected) & 0x0F)
            if sequence > self._next:
                # An answer to what was before, or of a board that was reset: nothing in it can be placed.
                if payload:
                    found.append(Received(payload, self._asked(None)))
                continue
            if sequence > self._expected:
                self._acknowledge(sequence, now)
            if payload:
                found.append(Received(payload, self._asked(sequence - 1)))
            else:
                self._empty(sequence)
        return found

    def _asked(self, sequence: int | None) -> float:
        """When a block was sent for the first time; of one that is not remembered, the earliest that is."""
        return next((at for s, at in self._sent_at if s == sequence), self._sent_at[0][1] if self._sent_at else 0.0)

    def _empty(self, sequence: int) -> None:
        """An empty block: an acknowledgement, or a nak when the one before said the same."""
        again, self._last_empty = sequence == self._last_empty, sequence
        if not again or not self._flying:
            return
        if self._stale_naks:
            # Each block behind the one that was missed is answered so: they have been sent again already.
            self._stale_naks -= 1
        else:
            self._nak = True

    def _acknowledge(self, sequence: int, now: float) -> None:
        self._expected = sequence
        self._stale_naks, self._nak = 0, False
        while self._flying and self._flying[0].sequence < sequence:
            sent = self._flying.popleft()
            self._bytes_flying -= len(sent.data)
            self.acknowledged += sent.messages
            if not sent.again:
                self._measured(now - sent.first_sent)
        if self._round_trip is not None:
            self._wait = min(LONGEST_WAIT, max(SHORTEST_WAIT, self._round_trip + 4 * self._spread))
        self._deadline = now + self._wait

    def _measured(self, seconds: float) -> None:
        """Take a round trip into the mean and its spread, of blocks that were sent once."""
        if self._round_trip is None:
            self._round_trip, self._spread = seconds, seconds / 2
        else:
            self._spread += (abs(seconds - self._round_trip) - self._spread) / 4
            self._round_trip += (seconds - self._round_trip) / 8
