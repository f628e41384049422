"""A connection to a board: in step with its sequence, its dictionary read, commands by name and answers to queries."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from gproof.backend.boards.board import BoardError
from gproof.backend.boards.klipper.blocks import Parser, block
from gproof.backend.boards.klipper.dictionary import BARE, Collected, Dictionary
from gproof.backend.boards.klipper.lines import Line, LineLost
from gproof.backend.boards.klipper.messages import IDENTIFIED, IDENTIFY, Fields, Value
from gproof.backend.boards.klipper.transport import Transport

PART = 40
"""Bytes of the dictionary asked for at once: an answer with its block holds no more than 64."""

PROBE_TIME, PROBES = 0.1, 30
"""Seconds that a probe waits for its answer, and how many are made: a board that was reset by opening its port needs
two seconds to start."""

QUERY_TIME = 0.25
QUERIES = 8
"""Seconds until a question is put again whose answer may have been lost, and how often."""

GONE = 2.0
"""Seconds of listening without any acknowledgement after which a board counts as lost."""

LISTENED = 0.25
"""Seconds that count as listened between two looks at the line: a host that slept for longer has heard nothing."""

HALF_BLOCK = 0.02
"""Seconds of silence after which half a block is none."""

WAIT = 0.05

NOBODY = "no board found: nobody answers, or at another baud rate"


class Answer(NamedTuple):
    """A message that arrived, between which moments it was made: host seconds."""

    name: str
    fields: Fields
    asked: float
    answered: float


Handler = Callable[[Answer], None]


ANSWERED_ALWAYS = frozenset(
    ("identify_response", "config", "clock", "uptime", "cert_state", "cert_motor", "cert_identity")
)
"""Answers that come in a shutdown too. What is said of one meanwhile may be meant for a host before this one."""


class Shutdown(BoardError):
    """The board is in a shutdown and answers nothing else."""


class Connection:
    """A board at the other end of a line.

    handler: called with every message that is no answer to the present question. listened: seconds in which the line
    was watched, without those in which the host slept.
    """

    def __init__(self, line: Line, handler: Handler) -> None:
        self.line = line
        self.dictionary: Dictionary = BARE
        self.handler = handler
        self.transport = Transport(window=64)
        self.listened = 0.0
        self._looked: float | None = None
        self._heard = 0.0
        self._answers: list[Answer] | None = None
        self._awaited = ""

    # Getting in step.

    def synchronise(self) -> None:
        """Find the sequence that the board expects next; BoardError when nobody answers as a board does.

        A probe with sequence q is taken when the board expects q, and refused when it does not; either answer
        carries what it expects then. Two answers in a row have to be q + 1: one alone can be an old one.
        """
        self._drain()
        sequence, agreed, heard = 0, 0, False
        probe = IDENTIFY.encoded({"offset": 0, "count": 1})
        for _ in range(PROBES):
            self.line.write(b"\x7e" + block(sequence, probe))
            parser, until = Parser(), self.line.now() + PROBE_TIME
            answered: int | None = None
            # What never stops is no board either.
            while answered is None and self.line.now() < until and (data := self.line.read(until)):
                heard = True
                # The empty block is the last that a board says to a probe.
                answered = next((b.sequence for b in reversed(parser.feed(data)) if not b.payload), None)
            if answered is None:
                agreed = 0
                continue
            agreed = agreed + 1 if answered == (sequence + 1) & 0x0F else 0
            sequence = answered
            if not agreed:
                # A board that had lost step answers a probe twice: without a pause each answer read is the one before.
                self._drain()
            if agreed > 1:
                self._drain()
                self.transport = Transport(sequence, window=64)
                return
        if not heard:
            raise BoardError(NOBODY)
        raise BoardError("no board found: what answers does not speak Klipper's protocol, or at another baud rate")

    def _drain(self) -> None:
        """Drop what is still on its way."""
        until = self.line.now() + HALF_BLOCK
        while self.line.now() < until and self.line.read(until):
            pass

    def identify(self) -> Dictionary:
        """Read the dictionary; BoardError."""
        self.dictionary = BARE
        collected = Collected()
        while True:
            # An answer for another offset is one to an earlier question, or of a board that would never end.
            answer = self.query(IDENTIFY.name, IDENTIFIED.name, key="offset", offset=collected.offset, count=PART)
            if collected.add(answer.fields):
                break
        self.dictionary = collected.dictionary()
        window = self.dictionary.constants.get("RECEIVE_WINDOW")
        self.transport.window = window if isinstance(window, int) and 64 <= window <= 1 << 16 else 192
        return self.dictionary

    # Talking.

    def command(self, name: str, **fields: Value) -> bytes:
        """A command as bytes; BoardError where the firmware has none with these fields."""
        return self.dictionary.command(name, tuple(fields)).encoded(fields)

    def send(self, name: str, **fields: Value) -> int:
        """Queue a command; its number among the messages."""
        return self.transport.send(self.command(name, **fields))

    def query(self, name: str, answer: str, /, *, key: str = "", **fields: Value) -> Answer:
        """Ask until there is an answer; key: a field that has to be as in the question. Shutdown, BoardError."""
        self._answers, self._awaited = [], answer
        try:
            for _ in range(QUERIES):
                number = self.send(name, **fields)
                until = self.line.now() + QUERY_TIME
                while self.line.now() < until:
                    self.pump(until)
                    for found in self._answers:
                        if not key or found.fields[key] == fields[key]:
                            return found
                    self._answers.clear()
                    if self.transport.acknowledged < number:
                        # Not taken yet: sent again by the transport, asked again by nobody.
                        until = self.line.now() + QUERY_TIME
        finally:
            self._answers = None
        raise LineLost(f"the board does not answer {name}")

    def settle(self) -> None:
        """Let everything queued be taken; LineLost."""
        while not self.transport.idle:
            self.pump(self.line.now() + WAIT)

    def pump(self, until: float) -> None:
        """One round: write what is due, and read what arrives ``until`` then. LineLost."""
        transport, now = self.transport, self.line.now()
        taken = transport.acknowledged
        if not transport.flying:
            self._heard, self._looked = self.listened, now
        if data := transport.out(now):
            self.line.write(data)
        again = transport.next_time()
        if again is not None:
            until = min(until, again)
        data = self.line.read(until)
        now = self.line.now()
        received = transport.feed(data, now) if data else []
        if not data and again is not None and now >= again:
            received = transport.give_up(now)
        for payload, asked in received:
            for name, fields in self.dictionary.read(payload):
                self._dispatch(Answer(name, fields, asked, now))
        self._listen(now, taken)

    def _listen(self, now: float, taken: int) -> None:
        """Count what was listened; LineLost after too long without an acknowledgement.

        A host that slept reads first what came meanwhile, and then judges.
        """
        before, self._looked = self._looked, now
        self.listened += 0.0 if before is None else min(now - before, LISTENED)
        if not self.transport.flying or self.transport.acknowledged != taken:
            self._heard = self.listened
        elif self.listened > self._heard + GONE:
            raise LineLost(f"the board has acknowledged nothing for {GONE:g} s")

    def _dispatch(self, answer: Answer) -> None:
        if self._answers is not None and answer.name == self._awaited:
            self._answers.append(answer)
        else:
            self.handler(answer)
            over = answer.name in ("shutdown", "is_shutdown")
            if over and self._answers is not None and self._awaited not in ANSWERED_ALWAYS:
                raise Shutdown("the board is in a shutdown")
