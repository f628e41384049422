"""Requests to a running job from outside: another thread, a signal handler."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import TypeVar

T = TypeVar("T")


class Control:
    """Feed hold and emergency stop, asked for at any moment and heard by the runtime at the next."""

    def __init__(self) -> None:
        self._hold = threading.Event()
        self._stop = threading.Event()
        self._asking = False

    def hold(self) -> None:
        """Ask for a feed hold."""
        self._hold.set()

    def stop(self) -> None:
        """Ask for an emergency stop."""
        self._stop.set()

    def interrupt(self) -> None:
        """For signal handlers: a feed hold the first time, then an emergency stop.

        While the operator is being asked, at rest, it ends the question instead: KeyboardInterrupt.
        """
        if self._asking:
            raise KeyboardInterrupt
        if self._hold.is_set():
            self.stop()
        self.hold()

    @property
    def hold_asked(self) -> bool:
        """A feed hold was asked for and has not been answered."""
        return self._hold.is_set()

    @property
    def stop_asked(self) -> bool:
        """An emergency stop was asked for."""
        return self._stop.is_set()

    def answered(self) -> None:
        """The feed hold has been dealt with."""
        self._hold.clear()

    def ask(self, question: Callable[[], T]) -> T | None:
        """The operator's answer, or None when an interrupt came first."""
        try:
            self._asking = True
            return question()
        except KeyboardInterrupt:
            return None
        finally:
            self._asking = False
