"""Requests to a running job from outside: another thread, a signal handler."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import TypeVar

T = TypeVar("T")

LEAST_FACTOR, GREATEST_FACTOR = Fraction(1, 10), Fraction(1)
"""Feed overrides: more than the planned speed would need a new plan."""


class Control:
    """Feed hold, feed override and emergency stop, requested at any moment and heard by the runtime at the next.

    ``began``: the run has started; signalled: a signal interrupted it; ending: why it ends at the next rest, or empty.
    """

    def __init__(self) -> None:
        # Plain flags: a lock, even that of an Event, would hang a signal that comes while another one is handled.
        self._hold = self._stop = False
        self._asking = False
        self._closing = False
        self.began = False
        self.signalled = False
        self.ending = ""
        self._override: Fraction | None = None

    def hold(self) -> None:
        """Request a feed hold."""
        self._hold = True

    def stop(self) -> None:
        """Request an emergency stop."""
        self._stop = True

    def override(self, factor: float | Fraction) -> Fraction:
        """Request another part of the planned speed, from where nothing was sent yet; what it is, within 0.1 to 1."""
        wanted = Fraction(factor).limit_denominator(1000)
        self._override = min(max(wanted, LEAST_FACTOR), GREATEST_FACTOR)
        return self._override

    @property
    def override_asked(self) -> Fraction | None:
        """The override that was requested last; None: none was."""
        return self._override

    def interrupt(self) -> None:
        """For signal handlers: a feed hold the first time, then an emergency stop.

        While the operator is being asked, at rest, it ends the question instead: KeyboardInterrupt.
        """
        if self._closing:
            return
        before, self.signalled = self.signalled, True
        if self._asking:
            raise KeyboardInterrupt
        if self._hold and (before or not self.ending):
            self.stop()
        self.hold()

    def terminate(self) -> None:
        """For signal handlers: an emergency stop; it ends a question as ``interrupt`` does."""
        if self._closing:
            return
        self.signalled = True
        self.stop()
        if self._asking:
            raise KeyboardInterrupt

    def end_at_rest(self, why: str) -> None:
        """Request a feed hold that nobody is asked about: the job ends there, because of ``why``."""
        self.ending = self.ending or why
        self.hold()

    def running(self) -> None:
        """The run starts: signals are requests from now on; until then they end what prepares it."""
        self.began, self._closing = True, False

    def closing(self) -> None:
        """The run is over: what interrupts it from now on has nothing left to stop."""
        self._closing = True

    @property
    def hold_asked(self) -> bool:
        """A feed hold was requested and has not been answered."""
        return self._hold

    @property
    def stop_asked(self) -> bool:
        """An emergency stop was requested."""
        return self._stop

    def answered(self) -> None:
        """The feed hold has been dealt with."""
        self._hold = False

    def ask(self, question: Callable[[], T]) -> T | None:
        """The operator's answer, or None when an interrupt came first, or nobody can be asked: a closed terminal."""
        if self.ending or self.stop_asked:
            return None
        try:
            try:
                self._asking = True
                return question()
            finally:
                self._asking = False
        except (KeyboardInterrupt, OSError):
            return None
