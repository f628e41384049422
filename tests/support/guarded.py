"""Bounds on what a random case may take: time and memory of this process, for as long as the case runs."""

from __future__ import annotations

import resource
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType

_PAGE = resource.getpagesize()


class TookTooLongError(BaseException):
    """A case still runs after its time; no reader catches it, which a TimeoutError is no exception for."""


@contextmanager
def alarm(seconds: int) -> Iterator[None]:
    """TookTooLongError in whatever still runs after that time."""

    def ring(number: int, frame: FrameType | None) -> None:
        raise TookTooLongError(f"still running after {seconds} s")

    before = signal.signal(signal.SIGALRM, ring)
    signal.alarm(seconds)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)


@contextmanager
def memory(more: int) -> Iterator[None]:
    """This process may take so many bytes beyond what it has; after that there is a MemoryError."""
    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    now = int(Path("/proc/self/statm").read_text().split()[0]) * _PAGE
    resource.setrlimit(resource.RLIMIT_AS, (now + more, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, (soft, hard))
