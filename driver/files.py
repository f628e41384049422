"""Paths from the command line: one clear line for what cannot be read or written, before any work is done."""

from __future__ import annotations

import contextlib
import os
from pathlib import Path

from gproof.driver.dialects import settings_files
from gproof.driver.errors import UsageError

OTHER_PICTURES = (".png", ".jpg", ".jpeg", ".gif", ".pdf", ".webp", ".bmp")


LONGEST = 300
"""Characters of a name that can be none, in the message."""


def require_file(path: Path, what: str) -> None:
    """UsageError for what is not a readable file.

    Pipes and devices are refused: a job is read more than once, and half of one must not be judged.
    """
    try:
        path.exists()
    except OSError as error:
        raise UsageError(f"{what} {str(path)[:LONGEST]}: {error.strerror}") from None
    if str(path) == "-" and not path.exists():
        raise UsageError(f"{what} -: give a file; standard input is not read")
    if not path.exists():
        raise UsageError(f"{what} {path}: no such file")
    if path.is_dir():
        raise UsageError(f"{what} {path}: is a folder, not a file")
    if not path.is_file():
        raise UsageError(f"{what} {path}: is not a regular file")
    try:
        with path.open("rb"):
            pass
    except OSError as error:
        raise UsageError(f"{what} {path}: {error.strerror}") from None


def require_program(path: Path, what: str) -> None:
    """UsageError for what is no readable file, or by its name is one of settings: it would fail line by line."""
    require_file(path, what)
    is_settings = settings_files().get(path.name.lower())
    if is_settings is not None:
        raise UsageError(f"{what} {path}: is not a program but {is_settings}")
    if path.suffix.lower() == ".toml":
        raise UsageError(f"{what} {path}: is not a program; .toml files belong to --machine and --setup")


def require_picture(path: Path) -> None:
    """UsageError for the extension of another kind of picture: what is written is SVG."""
    if path.suffix.lower() in OTHER_PICTURES:
        raise UsageError(f"picture {path}: pictures are SVG; name it {path.with_suffix('.svg').name}")


def require_place(path: Path, what: str, inputs: tuple[Path | str | None, ...] = ()) -> None:
    """UsageError for where no file can be written: over a folder or an input, in a folder that is not there."""
    if path.is_dir():
        raise UsageError(f"{what} {path}: is a folder, not a file")
    if not path.parent.is_dir():
        raise UsageError(f"{what} {path}: no such folder: {path.parent}")
    if path.exists() and not path.is_file():
        raise UsageError(f"{what} {path}: is not a regular file")
    if not os.access(path.parent, os.W_OK):
        raise UsageError(f"{what} {path}: no permission to write in folder {path.parent}")
    for name in inputs:
        if name is not None and path.exists() and Path(name).exists() and path.samefile(name):
            raise UsageError(f"{what} {path}: would overwrite an input")


def require_other(path: Path, what: str, other: Path | None, what_other: str) -> None:
    """UsageError where two outputs would be the same file, which need not be there yet."""
    if other is not None and path.resolve() == other.resolve():
        raise UsageError(f"{what} {path}: the same file as {what_other}")


def write_text(path: Path, text: str, what: str) -> None:
    """Write a file in one step; UsageError, and no part of it, when that cannot be done.

    Names of files that are no UTF-8 are in it as on standard output: ``\\udcff`` for a byte 0xFF.
    """
    write_bytes(path, text.encode("utf-8", "backslashreplace"), what)


def write_bytes(path: Path, text: bytes, what: str) -> None:
    """The same of bytes."""
    draft = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        draft.write_bytes(text)
        os.replace(draft, path)
    except BaseException as error:
        with contextlib.suppress(OSError):
            draft.unlink()
        if not isinstance(error, OSError):
            raise
        raise UsageError(f"{what} {path}: {error.strerror or error}") from None
