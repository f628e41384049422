"""Where the files of ``$I``, PreInclude and PostInclude are (McuWIN manual 9, 12, 14 (2.5.3.52, .90))."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

INCLUDE = re.compile(r"\$[Ii](?=[ \t]|\Z)[ \t]*(?P<name>[^ \t('\"]*)")
DEEPEST = 64
"""Files within one another that are read."""
MOST = 1000
"""Inclusions that are followed in a job: a few files that each include the next one twice would never end."""


def find(name: str, folders: Sequence[Path]) -> list[Path]:
    """The files that a name may mean, one a folder, in any case of letters.

    A drive or a path from the root is the controller's own disk: the file of that name next to the source is taken.
    """
    text = name.replace("\\", "/")
    absolute = text.startswith("/") or text[1:2] == ":"
    candidates = [text.rpartition("/")[2].rpartition(":")[2]] if absolute else [text, text.rpartition("/")[2]]
    found: list[Path] = []
    for candidate in candidates:
        for folder in folders:
            path = _below(folder, candidate.split("/"))
            if path is not None and all(path.resolve() != other.resolve() for other in found):
                found.append(path)
        if found:
            break
    return found


def differ(paths: Sequence[Path]) -> bool:
    """Whether files are not the same bytes; one that cannot be read differs from all."""
    try:
        return len({path.read_bytes() for path in paths}) > 1
    except OSError:
        return True


def _below(folder: Path, parts: Sequence[str]) -> Path | None:
    at = folder
    for part in parts:
        if part in ("", "."):
            continue
        if part == "..":
            at = at / ".."
            continue
        try:
            entries = {entry.name.lower(): entry for entry in sorted(at.iterdir(), reverse=True)}
        except OSError:
            return None
        found = entries.get(part.lower())
        if found is None:
            return None
        at = found
    try:
        return at if at.is_file() else None
    except OSError:
        return None
