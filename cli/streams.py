"""Standard streams as a command needs them: open, and able to print any text."""

from __future__ import annotations

import contextlib
import io
import os
import sys
from typing import Any

import click

_STDERR = 2


def standard_streams() -> bool:
    """Make the streams fit for use; False, with a line on standard error, when nothing can be printed."""
    handle = os.open(os.devnull, os.O_RDWR)
    while handle <= _STDERR:  # The number of a closed stream must not become that of a job or a package.
        handle = os.open(os.devnull, os.O_RDWR)
    os.close(handle)
    if sys.stderr is None:
        sys.stderr = os.fdopen(_STDERR, "w", encoding="utf-8", closefd=False)
    if sys.stdout is None:
        click.echo("gproof: error: standard output is closed", err=True)
        return False
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            # File names may hold bytes that are no text, and messages what the terminal cannot show.
            stream.reconfigure(errors="backslashreplace")
    return True


def discard(stream: Any) -> None:
    """What a stream still holds and could not write is given up, or the interpreter tries again when it ends."""
    if isinstance(stream, io.TextIOWrapper):
        with contextlib.suppress(OSError, ValueError):
            stream.flush()
            return
        with contextlib.suppress(OSError, ValueError):
            handle = os.open(os.devnull, os.O_WRONLY)
            os.dup2(handle, stream.fileno())
            os.close(handle)
