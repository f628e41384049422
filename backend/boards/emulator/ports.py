"""Where a host finds the emulator: a pseudo-terminal, or a local TCP port where the system has none.

A port takes no more than one host. ``read`` gives None while no host is there.
"""

from __future__ import annotations

import contextlib
import os
import random
import socket
import struct
import sys
import time
from pathlib import Path
from typing import Protocol

LARGEST_READ = 4096

OVERLAP = 0.2
"""Seconds that a second host waits for the first to be gone."""

PATIENCE = 30.0
"""Seconds that a harness may leave answers unread."""


class Port(Protocol):
    """A port that can be closed and opened again."""

    def open(self) -> str:
        """Open it; the address for pyserial."""

    def close(self) -> None:
        """Take it away from whoever has it."""

    def waits_for(self) -> int | None:
        """The descriptor that becomes readable when something arrives; None: ask from time to time."""

    def read(self, most: int) -> bytes | None:
        """What has arrived, at most so many bytes."""

    def write(self, data: bytes) -> None:
        """Hand bytes to the host; what it does not take is lost."""


class Terminal:
    """A pseudo-terminal. link: a symbolic link to keep on it."""

    def __init__(self, baud: int, link: Path | None = None) -> None:
        self._baud = baud
        self._link = link
        self._made = False
        self._master: int | None = None
        self._here = False
        self._garbled = random.Random(0)

    def open(self) -> str:
        """See Port."""
        import tty

        self._master, slave = os.openpty()
        tty.setraw(slave)
        name = os.ttyname(slave)
        _set_speed(slave, self._baud)
        os.close(slave)
        os.set_blocking(self._master, False)
        if self._link is not None:
            # One of an emulator that was killed leads nowhere.
            if self._made or (self._link.is_symlink() and not self._link.exists()):
                self._link.unlink(missing_ok=True)
            self._link.symlink_to(name)
            self._made = True
        return name

    def close(self) -> None:
        """See Port."""
        if self._master is not None:
            os.close(self._master)
            self._master, self._here = None, False
        if self._made and self._link is not None:
            self._link.unlink(missing_ok=True)

    def waits_for(self) -> int | None:
        """See Port."""
        return self._master if self._here else None

    def read(self, most: int) -> bytes | None:
        """See Port."""
        if self._master is None:
            return None
        try:
            data = os.read(self._master, min(most, LARGEST_READ)) if most else b""
        except BlockingIOError:
            data = b""
        except OSError:
            data = None  # nobody has the other side open
        self._here = data is not None
        return self._heard(data) if data else data

    def write(self, data: bytes) -> None:
        """See Port."""
        if self._master is not None and self._here:
            with contextlib.suppress(OSError):
                os.write(self._master, self._heard(data))

    def _heard(self, data: bytes) -> bytes:
        """Bytes as they are understood where both sides do not agree on the speed."""
        speed = self._speed()
        if speed in (None, self._baud):
            return data
        return bytes(self._garbled.randrange(256) for _ in data)

    def _speed(self) -> int | None:
        """What the host has set, where the system tells it."""
        flags = None if self._master is None else _flags(self._master)
        return None if flags is None else int(struct.unpack_from("<I", flags, SPEEDS + 4)[0])


SPEEDS = 36
"""Where Linux's ``struct termios2`` has the speeds, in and out."""


def _flags(number: int) -> bytearray | None:
    """A terminal's ``struct termios2``; None where the system has none."""
    if not sys.platform.startswith("linux"):
        return None
    import fcntl

    flags = bytearray(SPEEDS + 8)
    try:
        fcntl.ioctl(number, 0x802C542A, flags)  # TCGETS2
    except OSError:
        return None
    return flags


def _set_speed(number: int, baud: int) -> None:
    """A host that sets no speed has that of the board."""
    flags = _flags(number)
    if flags is None:
        return
    import fcntl

    control = struct.unpack_from("<I", flags, 8)[0]
    struct.pack_into("<I", flags, 8, control & ~0o010017 | 0o010000)  # CBAUD: BOTHER
    struct.pack_into("<II", flags, SPEEDS, baud, baud)
    with contextlib.suppress(OSError):
        fcntl.ioctl(number, 0x402C542B, flags)  # TCSETS2


class Tcp:
    """A local TCP port, for pyserial's ``socket://``."""

    def __init__(self, number: int = 0) -> None:
        self._number = number
        self._listener: socket.socket | None = None
        self._host: socket.socket | None = None
        self._second: socket.socket | None = None
        self._second_until = 0.0

    def open(self) -> str:
        """See Port."""
        listener = socket.create_server(("127.0.0.1", self._number))
        listener.setblocking(False)
        self._number = listener.getsockname()[1]
        self._listener = listener
        return f"socket://127.0.0.1:{self._number}"

    def close(self) -> None:
        """See Port."""
        for part in (self._host, self._second, self._listener):
            if part is not None:
                part.close()
        self._host = self._second = self._listener = None

    def waits_for(self) -> int | None:
        """See Port."""
        part = self._host or self._listener
        return None if part is None else part.fileno()

    def read(self, most: int) -> bytes | None:
        """See Port."""
        self._accept()
        if self._host is None:
            return None
        try:
            data = self._host.recv(min(most, LARGEST_READ)) if most else b"-"
        except BlockingIOError:
            return b""
        except OSError:
            data = b""
        if not data:
            self._host.close()
            self._host = None
            return None
        return data if most else b""

    def _accept(self) -> None:
        """One host at a time: another is turned away, unless the first goes within a moment."""
        if self._second is None and self._listener is not None:
            with contextlib.suppress(OSError):
                self._second = self._listener.accept()[0]
                self._second_until = time.monotonic() + OVERLAP
        if self._second is None:
            return
        if self._host is None:
            self._second.setblocking(False)
            self._second.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            self._host, self._second = self._second, None
        elif time.monotonic() > self._second_until:
            self._second.close()
            self._second = None

    def drop(self) -> None:
        """Turn the present host away."""
        if self._host is not None:
            self._host.close()
            self._host = None

    def write_all(self, data: bytes) -> None:
        """Hand bytes to the host, and wait for it where it has to read others first."""
        if self._host is not None:
            try:
                self._host.settimeout(PATIENCE)
                self._host.sendall(data)
                self._host.setblocking(False)
            except OSError:
                self.drop()

    def write(self, data: bytes) -> None:
        """See Port."""
        if self._host is not None:
            with contextlib.suppress(OSError):
                self._host.send(data)
