"""Work that an interrupt must not cut into pieces: it is heard, and raised when the work is done.

A ``KeyboardInterrupt`` inside numba's compiler is lost where it calls back from machine code, or frees what it made
twice. The handlers of signals run at once even so: a machine that moves is stopped at once. Only the exception waits.
"""

from __future__ import annotations

import contextlib
import signal
import threading
from collections.abc import Callable, Iterator
from types import FrameType
from typing import Any

Handler = Callable[[int, FrameType | None], Any]
SIGNALS = ("SIGINT", "SIGTERM", "SIGHUP")


@contextlib.contextmanager
def uninterrupted() -> Iterator[None]:
    """A ``KeyboardInterrupt`` of a signal is raised at the end of the block; a second one at once."""
    waiting: list[int] = []
    before: dict[int, Handler] = {}

    def heard(number: int, frame: FrameType | None) -> None:
        try:
            before[number](number, frame)
        except KeyboardInterrupt:
            if waiting:
                raise
            waiting.append(number)

    if threading.current_thread() is threading.main_thread():
        for name in SIGNALS:
            number = getattr(signal, name, None)
            handler = signal.getsignal(number) if number is not None else None
            if number is not None and callable(handler):
                before[number] = handler
                signal.signal(number, heard)
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
        if waiting:
            raise KeyboardInterrupt
