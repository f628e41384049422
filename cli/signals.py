"""Signals that end a command: SIGTERM and SIGHUP as Ctrl-C does, and none of them is lost."""

from __future__ import annotations

import contextlib
import signal
import sys
import threading
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from sys import UnraisableHookArgs

INTERRUPTED = 130
"""128 and the number of SIGINT, as shells have it."""
PROCESS = "process"
"""The object of click's context where the command line is that of the process."""
_SOON = 0.001
"""Seconds."""


def ends_with_its_command() -> bool:
    """True where the process ends with the command that is running: the command line itself, not a program's call."""
    context = click.get_current_context(silent=True)
    return context is not None and context.find_root().obj is PROCESS


@contextlib.contextmanager
def ended_by_signals() -> Iterator[None]:
    """What a command started to write is removed, and so do its processes; only the main thread hears signals."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = {}
    for name in ("SIGTERM", "SIGHUP"):
        number = getattr(signal, name, None)
        # Those that somebody ignores (``nohup``) or has a handler for stay so.
        if number is not None and signal.getsignal(number) is signal.SIG_DFL:
            before[number] = signal.signal(number, _interrupt)
    try:
        with _heard_again():
            yield
    finally:
        for number, handler in before.items():
            if signal.getsignal(number) is _interrupt:  # A run that is over ignores them to the end.
                signal.signal(number, handler)


def _interrupt(_number: int, _frame: Any) -> None:
    raise KeyboardInterrupt


@contextlib.contextmanager
def _heard_again() -> Iterator[None]:
    """Python drops what is raised in a callback (``__del__``, the locks of imports): the signal comes once more."""
    alarm = getattr(signal, "SIGALRM", None)
    if alarm is None or signal.getsignal(alarm) is not signal.SIG_DFL:
        yield
        return
    hook = sys.unraisablehook

    def lost(told: UnraisableHookArgs) -> None:
        if issubclass(told.exc_type, KeyboardInterrupt):
            signal.setitimer(signal.ITIMER_REAL, _SOON)
        else:
            hook(told)

    signal.signal(alarm, lambda *_: signal.raise_signal(signal.SIGINT))
    sys.unraisablehook = lost
    try:
        yield
    finally:
        sys.unraisablehook = hook
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(alarm, signal.SIG_DFL)
