"""A host that dies at a write, or whose disk takes no more: what it writes to its line, its journal and its mark.

A host that was killed does nothing more that anybody could see: each further write or look at the line ends it again.
"""

from __future__ import annotations

import contextlib
import errno
import os
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any
from unittest import mock

from gproof.backend.journal import Journal


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
