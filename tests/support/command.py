"""gproof's command line run twice: inside this process, where a run costs what it computes, or in one of its own.

A process of its own costs half a second before it reads its job. What depends on being one (streams, signals,
encodings, imports) is tested with `in_own_process`; what a job's answer is, with `in_this_process`. Tests that use
the latter for many jobs also compare both on a few of them.
"""

from __future__ import annotations

import contextlib
import io
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from gproof.cli.main import main

COMMAND = [sys.executable, "-m", "gproof.cli.main"]


@dataclass(frozen=True)
class Done:
    """How a command ended: exit code, standard output, standard error."""

    exit: int
    out: str
    err: str


def in_this_process(words: Sequence[str], folder: Path) -> Done:
    """`gproof words` in a folder, by a call; an exception that it lets out is the test's failure."""
    streams = [io.TextIOWrapper(io.BytesIO(), encoding="utf-8") for _ in range(2)]
    with contextlib.chdir(folder), contextlib.redirect_stdout(streams[0]), contextlib.redirect_stderr(streams[1]):
        code = main(list(words))
    for stream in streams:
        stream.seek(0)
    return Done(code, streams[0].read(), streams[1].read())


def in_own_process(words: Sequence[str], folder: Path) -> Done:
    """The same in a fresh Python."""
    done = subprocess.run(
        [*COMMAND, *words], cwd=folder, stdin=subprocess.DEVNULL, capture_output=True, encoding="utf-8", check=False
    )
    return Done(done.returncode, done.stdout, done.stderr)
