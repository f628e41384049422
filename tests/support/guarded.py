"""Bounds on what a random case may take: time and memory of this process, for as long as the case runs."""

from __future__ import annotations

import resource
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType

_PAGE = resource.getpagesize()

WAITS = 20


class TookTooLongError(BaseException):
    """A case still runs after its time; no reader catches it, which a TimeoutError is no exception for."""


@contextmanager
def alarm(seconds: int) -> Iterator[None]:
    """TookTooLongError in whatever still runs after so much time of the processor, which no neighbour lengthens.

    What waits and computes nothing is ended as well, after WAITS times as long by the clock.
    """

    def ring(number: int, frame: FrameType | None) -> None:
        raise TookTooLongError(f"still running after {seconds} s")

    before = {number: signal.signal(number, ring) for number in (signal.SIGPROF, signal.SIGALRM)}
    signal.setitimer(signal.ITIMER_PROF, seconds)
    signal.setitimer(signal.ITIMER_REAL, WAITS * seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.setitimer(signal.ITIMER_REAL, 0)
        for number, handler in before.items():
            signal.signal(number, handler)


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
