"""Signals while a job runs: Ctrl-C is a feed hold, then an emergency stop; SIGTERM and SIGHUP are emergency stops.

No signal ends the process between the start of a run and its record: handlers only ask, through ``Control``. Before
that they interrupt what is going on (KeyboardInterrupt), after it they find nothing left to stop: a process that ends
with its run stays deaf, so that a late Ctrl-C changes neither its exit code nor what it still prints.
"""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

from gproof.backend.control import Control


class _Heard:
    """A signal handler that asks a control."""

    def __init__(self, control: Control) -> None:
        self.control = control

    def __call__(self, number: int, _frame: FrameType | None) -> None:
        if not self.control.began:
            raise KeyboardInterrupt
        if number == signal.SIGINT:
            self.control.interrupt()
        else:
            self.control.terminate()


@contextmanager
def interrupts(control: Control, *, for_good: bool = False) -> Iterator[None]:
    """Signals ask ``control`` meanwhile; only the main thread can hear them. for_good: and are ignored after the run.

    Inside another of the same control nothing changes. SIGTERM and SIGHUP that the process ignores (``nohup``) stay so.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    heard = _Heard(control)
    before = {}
    inside = signal.getsignal(signal.SIGINT)
    if not (isinstance(inside, _Heard) and inside.control is control):
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            if number == signal.SIGINT or signal.getsignal(number) is not signal.SIG_IGN:
                before[number] = signal.signal(number, heard)
    try:
        yield
    finally:
        deaf = for_good and control.began
        for number, handler in before.items():
            signal.signal(number, signal.SIG_IGN if deaf else handler)
