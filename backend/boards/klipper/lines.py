"""Lines to a board: what the connection needs of one, and a serial port by pyserial.

``socket://host:port`` and ``rfc2217://host:port`` work too; of pyserial's other addresses some write files or start
other things, and a port can come from a machine file. A port that cannot be opened, vanishes or belongs to another
program is a BoardError with one clear line.
"""

from __future__ import annotations

import contextlib
import errno
import select
import time
from typing import Any, Protocol
from urllib.parse import urlsplit

from gproof.backend.boards.board import BoardError

BAUD = 250_000
"""What Klipper's firmware is built with unless somebody chose otherwise."""

ADDRESSES = ("socket://", "rfc2217://")

_LARGEST_READ = 4096
_WRITE_LIMIT = 2.0
_DOZE = 0.001


class LineLost(BoardError):
    """The line was there and has gone."""


class Line(Protocol):
    """Bytes there and back, with the clock that waits are measured by: seconds, of the wall or simulated."""

    def now(self) -> float:
        """The present moment."""

    def read(self, until: float) -> bytes:
        """What has arrived, at once when something has; nothing when nothing came ``until`` then. LineLost."""

    def write(self, data: bytes) -> None:
        """Send bytes; LineLost."""

    def close(self) -> None:
        """Let go of it."""


class SerialLine:
    """A port of pyserial, held alone where the system can do that. BoardError when it cannot be opened."""

    def __init__(self, port: str, baud: int = BAUD) -> None:
        import serial

        self.port = port
        if "://" in port and not port.startswith(ADDRESSES):
            raise BoardError(f"{port}: not a port; an address starts with {' or '.join(ADDRESSES)}")
        if "://" in port and not _has_number(port):
            raise BoardError(f"{port}: the address has no port number from 1 to 65535, as in {ADDRESSES[0]}host:5000")
        # Only a device can be held alone; an address of pyserial takes no such request.
        alone: dict[str, Any] = {} if "://" in port else {"exclusive": True}
        try:
            self._serial = serial.serial_for_url(
                port, baudrate=baud, timeout=0, write_timeout=_WRITE_LIMIT, **alone
            )  # fmt: skip
        except (OSError, ValueError) as error:
            raise BoardError(f"{port}: {_refused(error)}") from None
        try:
            self._number: int | None = self._serial.fileno()
        except (OSError, AttributeError):
            self._number = None
        if alone and self._number is not None:
            _keep_alone(self._number)

    def now(self) -> float:
        """See Line."""
        return time.monotonic()

    def read(self, until: float) -> bytes:
        """See Line."""
        try:
            rest = max(0.0, until - time.monotonic())
            if self._number is None:
                return self._polled(until)
            if not select.select([self._number], [], [], rest)[0]:
                return b""
            return self._serial.read(_LARGEST_READ)
        except (OSError, TypeError, ValueError, AttributeError) as error:
            raise self._lost(error) from None

    def _polled(self, until: float) -> bytes:
        """Of a port that cannot be waited for."""
        while not (data := self._serial.read(_LARGEST_READ)) and time.monotonic() < until:
            time.sleep(_DOZE)
        return data

    def write(self, data: bytes) -> None:
        """See Line."""
        try:
            self._serial.write(data)
        except (OSError, TypeError, ValueError, AttributeError) as error:
            raise self._lost(error) from None

    def _lost(self, error: Exception) -> LineLost:
        # pyserial's own errors are OSErrors; of a port that somebody closed it raises whatever comes first.
        return LineLost(f"{self.port}: the line is lost ({error})")

    def close(self) -> None:
        """See Line."""
        with contextlib.suppress(OSError):
            self._serial.close()


def _has_number(address: str) -> bool:
    """Whether an address names host and port; pyserial's own texts about it are of its code."""
    try:
        parts = urlsplit(address)
        return bool(parts.hostname) and bool(parts.port)
    except ValueError:
        return False


def _keep_alone(number: int) -> None:
    """Ask the system to refuse the port to programs that know nothing of locks."""
    with contextlib.suppress(ImportError, AttributeError, OSError):
        import fcntl
        import termios

        fcntl.ioctl(number, termios.TIOCEXCL)


def _refused(error: Exception) -> str:
    """Why a port cannot be opened, in one line."""
    number = getattr(error, "errno", None)
    text = str(error)
    if number == errno.ENOENT or "No such file" in text:
        return "there is no such port"
    if number in (errno.EACCES, errno.EPERM):
        return "no permission to open it (on Linux the user has to be in the group that owns it, often dialout)"
    if number == errno.EBUSY or "lock" in text:
        return "another program uses it"
    if number in (errno.EISDIR, errno.ENOTTY) or "Inappropriate ioctl" in text:
        return "it is not a serial port"
    return f"it cannot be opened ({text.splitlines()[0] if text else type(error).__name__})"
