"""Folders that nobody but their owner can write: what is kept in them is run, or decides how text is read.

Whoever can put a file there makes the checker say what he likes. So a folder counts as private when it is a folder of
the user's own without write permission for other users, no symbolic link, and when nobody else can put another one in
its place: each folder above it, up to the root, belongs to the user or to the system's administrator and is not
writable by others, or is sticky (as ``/tmp``), where only owners move what is theirs. Symbolic links above it are
followed when they and where they lie pass the same. Access control lists are not looked at.

Systems without such permissions (Windows): every folder counts; profiles are private there.
"""

from __future__ import annotations

import contextlib
import functools
import os
import stat
import sys
from pathlib import Path

_OTHERS_WRITE = stat.S_IWGRP | stat.S_IWOTH
_LINKS = 40
"""Symbolic links followed at most, as Linux has it."""


@functools.cache
def private_or_other(wanted: str) -> Path:
    """``wanted`` where it is private; else one below the temporary folder, kept or of this process, said once."""
    why = not_private(Path(wanted))
    if not why:
        return Path(wanted)
    other = _of_the_user()
    if "multiprocessing" not in sys.modules or sys.modules["multiprocessing"].parent_process() is None:
        print(f"gproof: note: compiled code is kept in {other}: {wanted} is not private: {why}", file=sys.stderr)
    return other


def _of_the_user() -> Path:
    """A private folder in the temporary folder; a new one that goes with the process where somebody holds its name."""
    import atexit
    import shutil
    import tempfile

    kept = Path(tempfile.gettempdir()) / f"gproof-{os.getuid()}"
    if not not_private(kept):
        return kept
    try:
        fresh = tempfile.mkdtemp(prefix="gproof-")
    except OSError:  # Nowhere to write: nothing is kept.
        return Path(os.devnull) / "gproof"
    atexit.register(shutil.rmtree, fresh, ignore_errors=True)
    return Path(fresh)


def not_private(folder: Path) -> str:
    """Why somebody else could write there, or an empty text; what does not exist yet is private if it would be.

    A folder that is still missing in a shared (sticky) one is made, so that nobody else makes it first.
    """
    if os.name != "posix":
        return ""
    path = os.path.abspath(folder)
    try:
        if os.path.islink(path):
            return f"{path} is a symbolic link"
        return _walk(path)
    except OSError as error:
        return f"{path}: {error.strerror}"


def _walk(path: str) -> str:
    left = [part for part in path.split(os.sep) if part][::-1]
    here, sticky, links = os.sep, False, 0
    why = _above(here, os.lstat(here))
    while left and not why:
        part = left.pop()
        if part == os.pardir:
            here = os.path.dirname(here)
            continue
        place = os.path.join(here, part)
        try:
            found = os.lstat(place)
        except FileNotFoundError:
            if not sticky:
                return ""
            with contextlib.suppress(FileExistsError):
                os.mkdir(place, 0o700)
            found = os.lstat(place)
        if stat.S_ISLNK(found.st_mode):
            links += 1
            if found.st_uid not in (0, os.geteuid()) or links > _LINKS:
                return (
                    f"{place} is a symbolic link that belongs to another user"
                    if links <= _LINKS
                    else f"{place}: links in a circle"
                )
            target = os.readlink(place)
            left += [p for p in target.split(os.sep) if p and p != os.curdir][::-1]
            here = os.sep if os.path.isabs(target) else here
            sticky = bool(os.lstat(here).st_mode & stat.S_ISVTX)
            continue
        here, sticky = place, bool(found.st_mode & stat.S_ISVTX)
        why = _above(place, found) if left else _own(place, found)
    return why


def _above(place: str, found: os.stat_result) -> str:
    if found.st_uid not in (0, os.geteuid()):
        return f"{place} belongs to another user"
    if found.st_mode & _OTHERS_WRITE and not found.st_mode & stat.S_ISVTX:
        return f"others can write {place}"
    return ""


def _own(place: str, found: os.stat_result) -> str:
    if not stat.S_ISDIR(found.st_mode):
        return f"{place} is not a folder"
    if found.st_uid != os.geteuid():
        return f"{place} belongs to another user"
    return f"others can write {place}" if found.st_mode & _OTHERS_WRITE else ""


def make_private(folder: Path) -> None:
    """Make a folder and those above it that are missing, each for the user alone; OSError."""
    missing = []
    while not folder.exists():
        missing.append(folder)
        folder = folder.parent
    for place in reversed(missing):
        with contextlib.suppress(FileExistsError):
            place.mkdir(mode=0o700)


def read_own(path: Path) -> bytes | None:
    """The bytes of a file of the user's own that nobody else can write, in a private folder; None for any other."""
    if not_private(path.parent):
        return None
    try:
        handle = os.open(path, os.O_RDONLY | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_BINARY", 0))
        with os.fdopen(handle, "rb") as file:
            found = os.fstat(handle)
            foreign = os.name == "posix" and (found.st_uid != os.geteuid() or found.st_mode & _OTHERS_WRITE)
            return None if foreign or not stat.S_ISREG(found.st_mode) else file.read()
    except OSError:
        return None
