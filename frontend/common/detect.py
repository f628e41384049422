"""Which controller a job is for, by its name and its first lines."""

from __future__ import annotations

import re
from pathlib import Path

HEAD = 65536
"""Bytes of the job that are looked at."""

_MODULE, _L_CODE = "program number behind %", "L code"
_MARKERS: tuple[tuple[str, str, re.Pattern[bytes]], ...] = (
    ("eding", "nesting line", re.compile(rb"^[ \t]*%[ \t]*[mdo][ \t]*[xy][ \t]*=", re.M | re.I)),
    ("mcuwin", _MODULE, re.compile(rb"^[ \t]*%[ \t]*\w+[ \t]*(?:['(]|\r?$)", re.M)),
    ("mcuwin", "named variable or procedure", re.compile(rb"^[ \t]*(?:var|procedure|proc)\b", re.M | re.I)),
    ("mcuwin", "$ statement", re.compile(rb"^[ \t]*(?:N\d+[ \t]*)?\$[A-Za-z]", re.M | re.I)),
    ("mcuwin", "DIN section", re.compile(rb"\{[ \t]*\$DINSTART[ \t]*\}", re.I)),
    ("mcuwin", "calculation parameter", re.compile(rb"\bC[DI]\d{1,3}[ \t]*:=", re.I)),
    ("mcuwin", "jump or call of a label", re.compile(rb"^[^'(;\[\n]*\bM9[68][ \t]*L[ \t]*\d", re.M | re.I)),
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
    ("wincnc", _L_CODE, re.compile(rb"^[ \t]*L\d+\b", re.M | re.I)),
    ("wincnc", "bracketed comment or macro call", re.compile(rb"^[ \t]*\[", re.M)),
    ("wincnc", "M98 with a file name", re.compile(rb"\bM98[ \t]+[A-Za-z_]+\.", re.I)),
)
EXTENSIONS = {
    ".cnc": "eding", ".ngc": "eding", ".nc": "eding", ".gcode": "eding", ".gc": "eding", ".g": "eding",
    ".ncd": "eding", ".iso": "eding", ".txt": "eding", ".eia": "eding",
    ".tap": "wincnc", ".mac": "wincnc", ".wnc": "wincnc",
    ".pim": "mcuwin", ".din": "mcuwin", ".src": "mcuwin", ".inc": "mcuwin",
}  # fmt: skip
"""What an extension says when the text says nothing."""


_SHOP_FILES = {"wincnc.ini": "wincnc", "cnc.mac": "wincnc", "mcuwin.ini": "mcuwin", "toolcomp.ini": "mcuwin"}
"""Files that only the folder of one controller has; a job lies beside them or in a folder below."""


def _shop_file(path: Path) -> Path | None:
    """A file of _SHOP_FILES beside the job or one folder up."""
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
    shop = _SHOP_FILES[beside.name.lower()] if beside is not None else None
    by_name = shop or EXTENSIONS.get(extension)
    for dialect, reason, marker in _MARKERS:
        found = marker.search(head)
        # A comment of WinCNC may look like the name of a module, and a label of McuWIN like an L code.
        doubtful = (reason == _MODULE and shop == "wincnc") or (reason == _L_CODE and by_name == "mcuwin")
        if found and not doubtful:
            line = head.count(b"\n", 0, found.start()) + 1
            return dialect, f"{reason} in line {line}"
    if beside is not None:
        return _SHOP_FILES[beside.name.lower()], f"{beside.name} in {beside.parent}"
    if extension in EXTENSIONS:
        return EXTENSIONS[extension], f"extension {extension}"
    return "eding", "nothing says otherwise"
