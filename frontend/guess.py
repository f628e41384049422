"""Which controller a job is for, by its name and its first lines."""

from __future__ import annotations

import re
from pathlib import Path

HEAD = 65536
"""Bytes of the job that are looked at."""

_MARKERS: tuple[tuple[str, str, re.Pattern[bytes]], ...] = (
    ("eding", "nesting line", re.compile(rb"^[ \t]*%[ \t]*[mdo][ \t]*[xy][ \t]*=", re.M | re.I)),
    ("mcuwin", "program number behind %", re.compile(rb"^[ \t]*%[ \t]*\w", re.M)),
    ("mcuwin", "named variable or procedure", re.compile(rb"^[ \t]*(?:var|procedure|proc)\b", re.M | re.I)),
    ("mcuwin", "$ statement", re.compile(rb"^[ \t]*\$\w", re.M)),
    ("eding", "flow control", re.compile(rb"^[ \t]*(?:end[ \t]*(?:if|while|sub)|gosub|sub)\b", re.M | re.I)),
    ("eding", "numbered parameter", re.compile(rb"#\d|#\[")),
    ("eding", "message statement", re.compile(rb"^[ \t]*(?:msg|errmsg|dlgmsg|tcaguard)\b", re.M | re.I)),
    (
        "eding",
        "command of this controller",
        re.compile(
            rb"^[ \t]*(?:(?:warn|log)msg|logfile|mcaguard|tanknife|zhc\w*|home(?:tandem)?[ \t]+[a-z])\b", re.M | re.I
        ),
    ),
    ("wincnc", "L code", re.compile(rb"^[ \t]*L\d+\b", re.M | re.I)),
    ("wincnc", "bracketed comment or macro call", re.compile(rb"^[ \t]*\[", re.M)),
    ("wincnc", "M98 with a file name", re.compile(rb"\bM98[ \t]+[A-Za-z_]+\.", re.I)),
)
EXTENSIONS = {
    ".cnc": "eding", ".ngc": "eding", ".nc": "eding", ".gcode": "eding", ".gc": "eding", ".g": "eding",
    ".ncd": "eding", ".iso": "eding", ".txt": "eding", ".eia": "eding",
    ".tap": "wincnc", ".mac": "wincnc", ".wnc": "wincnc", ".pim": "mcuwin", ".din": "mcuwin",
}  # fmt: skip
"""What an extension says when the text says nothing."""


_SHOP_FILES = ("wincnc.ini", "cnc.mac")
"""Files of a WinCNC folder; a job lies beside them or in a folder below."""


def _shop_file(path: Path) -> Path | None:
    """A file that only a WinCNC folder has, beside the job or one folder up."""
    for folder in (path.parent, path.parent / ".."):
        try:
            names = {entry.name.lower(): entry for entry in folder.iterdir()}
        except OSError:
            continue
        for name in _SHOP_FILES:
            if name in names:
                return names[name]
    return None


def guess_dialect(path: Path) -> tuple[str, str]:
    """(dialect, reason): ``eding``, ``wincnc`` or ``mcuwin``; of a file that can not be read, by name alone."""
    try:
        with open(path, "rb") as file:
            head = file.read(HEAD)
    except OSError:
        head = b""
    extension = path.suffix.lower()
    beside = _shop_file(path)
    for dialect, reason, marker in _MARKERS:
        found = marker.search(head)
        if found:
            line = head.count(b"\n", 0, found.start()) + 1
            return dialect, f"{reason} in line {line}"
    if beside is not None:
        return "wincnc", f"{beside.name} in {beside.parent}"
    if extension in EXTENSIONS:
        return EXTENSIONS[extension], f"extension {extension}"
    return "eding", "nothing says otherwise"
