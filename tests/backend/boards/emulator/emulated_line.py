"""The host's line to an emulated board in simulated time: time passes only while the host waits, or is stalled; and a
host that dies at a write, or whose disk takes no more: what it writes to its line, its journal and its mark.

A host that was killed does nothing more that anybody could see: each further write or look at the line ends it again.
"""

from __future__ import annotations

import contextlib
import errno
import os
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any
from unittest import mock

from gproof.backend.boards.board import BoardError
from gproof.backend.boards.emulator.emulator import Emulator
from gproof.backend.boards.klipper.lines import Line, LineLost
from gproof.backend.journal import Journal

LOOK = 200_000
"""Nanoseconds that a look at the line takes at least: a host that only looks does not stop the time."""


@dataclass
class EmulatedLine:
    """stalls: host seconds and how long the host does nothing there, in order; taken: host seconds between which
    another program has the port, when nobody else has it; write_through: how bytes of the host go out; alive: raises
    when the host is not; visitor: called at each look at the line."""

    board: Emulator
    stalls: list[tuple[float, float]] = field(default_factory=list)
    taken: tuple[float, float] = (0.0, 0.0)
    write_through: Callable[[Callable[[bytes], object], bytes], object] = lambda write, data: write(data)
    alive: Callable[[], None] = lambda: None
    visitor: Callable[[], None] | None = None
    held: bool = False

    def connect(self) -> Line:
        """Opens it; while there is no link, a tenth of a second passes and nobody is there."""
        self.alive()
        if self.held:
            raise BoardError("another program uses it")
        busy = self.taken[0] <= self.now() < self.taken[1]
        if busy or not self.board.connected:
            self.board.advance(self.board.now + 10**8)
        if busy:
            raise BoardError("another program uses it")
        if not self.board.connected:
            raise BoardError("there is no such port")
        self.held = True
        return self

    def now(self) -> float:
        return self.board.now / 1e9

    def _stall(self) -> None:
        while self.stalls and self.stalls[0][0] <= self.now():
            self.board.advance(self.board.now + round(self.stalls.pop(0)[1] * 1e9))

    def read(self, until: float) -> bytes:
        self.alive()
        if self.visitor is not None:
            self.visitor()
        self._stall()
        self.board.advance(max(self.board.now + LOOK, round(until * 1e9) + 1), heard=True)
        data = self.board.taken()
        self._stall()
        if not data and not self.board.connected:
            raise LineLost("the line is lost")
        return data

    def write(self, data: bytes) -> None:
        self._stall()
        if not self.board.connected:
            raise LineLost("the line is lost")
        self.write_through(self.board.write, data)

    def close(self) -> None:
        self.board.taken()
        self.held = False


class Killed(BaseException):
    """SIGKILL: nobody catches it."""


@dataclass
class FrailHost:
    """kill_at: the write at which it dies (0: none), counted over everything; half: that write goes out by half first;
    full: the writes of the journal, counted on their own, for which there is no room."""

    kill_at: int = 0
    half: bool = False
    full: range = range(0)
    count: int = 0
    notes: int = 0
    dead: bool = False

    def check(self) -> None:
        if self.dead:
            raise Killed

    def write(self, call: Callable[[bytes], Any], data: bytes) -> Any:
        """Write, unless it is dead or dies of it."""
        self.check()
        self.count += 1
        if self.count == self.kill_at:
            self.dead = True
            if self.half:
                call(data[: len(data) // 2])
            raise Killed
        return call(data)

    @contextlib.contextmanager
    def writing(self, journal: Journal) -> Iterator[None]:
        """What it writes into a journal and its mark goes through here; no other file does."""
        mine = {journal._handle, journal._mark._handle if journal._mark is not None else -1}
        write, pwrite, sync = os.write, os.pwrite, os.fsync

        def noted(handle: int, data: bytes) -> Any:
            if handle not in mine:
                return write(handle, data)
            self._room(lambda: write(handle, data[: len(data) // 2]))
            return self.write(lambda part: write(handle, part), data)

        def marked(handle: int, data: bytes, place: int) -> Any:
            if handle not in mine:
                return pwrite(handle, data, place)
            return self.write(lambda part: pwrite(handle, part, place), data)

        def synced(handle: int) -> None:
            if handle not in mine:
                sync(handle)
                return
            self._room(lambda: None)
            self.write(lambda _: None, b"")

        with (
            mock.patch.object(os, "write", noted),
            mock.patch.object(os, "pwrite", marked),
            mock.patch.object(os, "fsync", synced),
        ):
            yield

    def _room(self, half: Callable[[], Any]) -> None:
        """No room: half of it is written at most."""
        self.check()
        self.notes += 1
        if self.notes in self.full:
            half()
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
