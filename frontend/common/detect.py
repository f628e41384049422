"""Which controller a job is for, by its name and its first lines."""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from pathlib import Path

from gproof.frontend.common.frontend import Frontend

HEAD = 65536
"""Bytes of the job that are looked at."""


def _shop_file(path: Path, frontends: Sequence[Frontend]) -> tuple[Frontend, Path] | None:
    """A file next to the job or one folder up that only the folder of one controller has, and whose."""
    for folder in (path.parent, path.parent / ".."):
        try:
            names = {name.lower(): name for name in os.listdir(folder)}
        except OSError:
            continue
        for frontend in frontends:
            for name in frontend.shop_files:
                if name in names:
                    return frontend, folder / names[name]
    return None


def of_extension(suffix: str, frontends: Sequence[Frontend]) -> Frontend | None:
    """Whose programs have this extension, in any case of letters."""
    return next((one for one in frontends if suffix.lower() in one.extensions), None)


def guess_dialect(path: Path, frontends: Sequence[Frontend]) -> tuple[str, str]:
    """(dialect, reason), the first of ``frontends`` where no file says otherwise; of a file that cannot be read, by
    name alone."""
    try:
        with open(path, "rb") as file:
            head = file.read(HEAD)
    except OSError:
        head = b""
    beside = _shop_file(path, frontends)
    shop = None if beside is None else beside[0]
    named = of_extension(path.suffix, frontends)
    markers = sorted(((mark.rank, one.name, mark) for one in frontends for mark in one.markers), key=lambda m: m[0])
    for _, dialect, marker in markers:
        found = re.search(marker.pattern, head)
        if found and not _is_alike(marker.reason, shop, named):
            line = head.count(b"\n", 0, found.start()) + 1
            return dialect, f"{marker.reason} in line {line}"
    if beside is not None:
        return beside[0].name, f"{beside[1].name} in {beside[1].parent}"
    if named is not None:
        return named.name, f"extension {path.suffix.lower()}"
    return frontends[0].name, "the default"


def _is_alike(reason: str, shop: Frontend | None, named: Frontend | None) -> bool:
    """Whether programs of the dialect that the folder or the name speaks for have such texts too."""
    by_folder = shop is not None and any(one.reason == reason for one in shop.alike)
    by_name = shop is None and named is not None and any(a.reason == reason and a.by_extension for a in named.alike)
    return by_folder or by_name
