"""The mark beside a journal: what a board has been given at most, written before anything of it is sent.

A journal says what a board has acknowledged; a process that is killed leaves no word of what it had sent since. The
mark is written before each sending, without a wait: it lies in a file system in memory, outlives its process, and is
gone with the computer's power, after which only the journal counts. Two places are written in turn, so that one is
whole wherever the process dies. ``docs/execution-record.md`` defines the file.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import stat
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

from gproof.backend.record_data import canonical
from gproof.backend.record_parse import int_of, ints_of
from gproof.ir.record import record

PLACE = 4096
"""Bytes of each of the two places."""

MEMORY = Path("/dev/shm")
"""A file system in memory, where the system has one."""

BOOT = Path("/proc/sys/kernel/random/boot_id")


@record(frozen=True, slots=True, kw_only=True)
class Given:
    """What a mark says.

    place: sections that were started, the last of which is the one meant; begun: the board has taken its start; tick:
    of it, when it was written; steps, accepted: acknowledged by then, by motor; given: steps that the board has then
    been sent at most, by motor.
    """

    place: int
    begun: bool
    tick: int
    steps: tuple[int, ...]
    accepted: tuple[int, ...]
    given: tuple[int, ...]


class Mark:
    """A mark that is being written; name: of its journal."""

    def __init__(self, folder: Path, name: str) -> None:
        """Make the file, which must not be there, with all the room that it needs; OSError."""
        self.path = folder / f"gproof-{name}.mark"
        self._name = name
        self._number = 0
        self._handle = os.open(self.path, os.O_RDWR | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW, 0o600)
        try:
            os.posix_fallocate(self._handle, 0, 2 * PLACE)
        except BaseException:
            self.remove()
            raise

    def write(self, fields: Mapping[str, Any]) -> None:
        """Replace the older of the two; OSError, and the mark is gone: an old one would say too little."""
        self._number += 1
        data = canonical({"boot": boot(), "journal": self._name, "number": self._number, **fields})
        data = hashlib.sha256(data).hexdigest().encode() + b" " + data + b"\n"
        try:
            if len(data) > PLACE or os.pwrite(self._handle, data, PLACE * (self._number % 2)) != len(data):
                raise OSError(0, "the mark does not fit its place")
        except OSError:
            self.remove()
            raise

    def remove(self) -> None:
        """Remove the file."""
        with contextlib.suppress(OSError):
            self.path.unlink()
        if self._handle >= 0:
            handle, self._handle = self._handle, -1
            with contextlib.suppress(OSError):
                os.close(handle)

    def let_go(self) -> None:
        """Close the file as it is."""
        if self._handle >= 0:
            handle, self._handle = self._handle, -1
            os.close(handle)


@cache
def boot() -> str:
    """What tells this start of the computer from others; empty where the system does not say."""
    try:
        return BOOT.read_text(encoding="ascii").strip()
    except (OSError, ValueError):
        return ""


def marks_folder() -> Path | None:
    """Where marks are kept; None where there is no place in memory."""
    return MEMORY if boot() and MEMORY.is_dir() and os.access(MEMORY, os.W_OK | os.X_OK) else None


def read_mark(path: Path, name: str) -> Given | None:
    """What the mark of a journal says; None when it is not there, not whole, of another, or of an earlier start."""
    try:
        handle = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK)
    except (OSError, ValueError):
        return None
    try:
        told = os.fstat(handle)
        if not stat.S_ISREG(told.st_mode) or told.st_uid != os.getuid() or told.st_size != 2 * PLACE:
            return None
        data = os.read(handle, 2 * PLACE)
    except OSError:
        return None
    finally:
        os.close(handle)
    places = [_parsed(data[k : k + PLACE], name) for k in (0, PLACE)]
    found = [place for place in places if place is not None]
    return max(found, key=lambda place: place[0])[1] if found else None


def _parsed(data: bytes, name: str) -> tuple[int, Given] | None:
    line = data.partition(b"\n")[0]
    if line[:65] != f"{hashlib.sha256(line[65:]).hexdigest()} ".encode():
        return None
    try:
        fields = json.loads(line[65:])
        if fields["boot"] != boot() or not boot() or fields["journal"] != name:
            return None
        return int_of(fields["number"]), Given(
            place=int_of(fields["place"]),
            begun=fields["begun"] is True,
            tick=int_of(fields["tick"]),
            steps=ints_of(fields["steps"]),
            accepted=ints_of(fields["accepted"]),
            given=ints_of(fields["given"]),
        )
    except (ValueError, LookupError, TypeError, AttributeError, RecursionError):
        return None
