"""Where the command starts: a signal while gproof is still imported ends it in one line, as later ones do.

Nothing is imported at the top that Python has not loaded by itself.
"""

from __future__ import annotations

import os
from typing import NoReturn

INTERRUPTED = 130
"""As in ``signals.py``, which is not there yet."""


def main(arguments: list[str] | None = None) -> int:
    """Import the command line and run it, as ``main.main`` does; the exit code."""
    try:
        import signal

        before = {}
        for name in ("SIGINT", "SIGTERM", "SIGHUP"):
            number = getattr(signal, name, None)
            # Those that somebody ignores (``nohup``) or has a handler for stay so.
            if number is not None and signal.getsignal(number) in (signal.SIG_DFL, signal.default_int_handler):
                before[number] = signal.signal(number, lambda *_: _over())
        from gproof.cli.main import main as run

        for number, handler in before.items():
            signal.signal(number, handler)
        return run(arguments)
    except KeyboardInterrupt:
        _over()


def _over() -> NoReturn:
    """End at once: nothing has been done, and an import that is cut off leaves nothing to tidy up."""
    os.write(2, b"gproof: interrupted\n")
    os._exit(INTERRUPTED)
