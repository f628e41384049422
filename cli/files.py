"""Paths from the command line: one clear line for what can not be read or written, before any work is done."""

from __future__ import annotations

import os
from pathlib import Path

from gproof.cli.main import UsageError


def require_file(path: Path, what: str) -> None:
    """UsageError for what is not a readable file.

    Pipes and devices are refused: a job is read more than once, and half of one must not be judged.
    """
    if not path.exists():
        raise UsageError(f"{what} {path}: no such file")
    if path.is_dir():
        raise UsageError(f"{what} {path}: is a directory")
    if not path.is_file():
        raise UsageError(f"{what} {path}: is not a regular file")
    try:
        with path.open("rb"):
            pass
    except OSError as error:
        raise UsageError(f"{what} {path}: {error.strerror}") from None


def require_place(path: Path, what: str, inputs: tuple[Path | str | None, ...] = ()) -> None:
    """UsageError for where no file can be written: over a folder or an input, in a folder that is not there."""
    if path.is_dir():
        raise UsageError(f"{what} {path}: is a directory")
    if not path.parent.is_dir():
        raise UsageError(f"{what} {path}: there is no folder {path.parent}")
    if path.exists() and not path.is_file():
        raise UsageError(f"{what} {path}: is not a regular file")
    if not os.access(path.parent, os.W_OK):
        raise UsageError(f"{what} {path}: the folder {path.parent} can not be written")
    for name in inputs:
        if name is not None and path.exists() and Path(name).exists() and path.samefile(name):
            raise UsageError(f"{what} {path}: would overwrite an input")
