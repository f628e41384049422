"""The map of a translation (TOML, schema ``gproof-translation/1``): docs/translation.md lists every key."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from gproof.frontend.common.toml_table import TomlFile, TomlTable
from gproof.ir.finding import Findings
from gproof.ir.translation_map import STYLE_KEYS, TranslationMap

SCHEMA = "gproof-translation/1"
HIGHEST = 9999
NEWLINES = {"lf": "\n", "crlf": "\r\n"}


def load_translation_map(path: Path, findings: Findings) -> TranslationMap | None:
    """The map in a file; None, with findings GP601-GP604, when it is bad."""
    file = TomlFile(path, SCHEMA, findings)
    root = file.root
    if root is None:
        return None
    found = TranslationMap(
        outputs=_numbers(root, "outputs"), inputs=_numbers(root, "inputs"), tools=_numbers(root, "tools"),
        offsets=_numbers(root, "offsets"), coolant=_coolant(root), style=_style(root), lengths=_lengths(root),
        tool_change=root.text("tool_change", ("stop",)) or "", given=True,
    )  # fmt: skip
    root.finish()
    file.finish()
    return None if findings.kept else found


def _numbers(root: TomlTable, name: str) -> dict[int, int]:
    """``4 = 1``: number of the source, number of the target."""
    table = root.table(name)
    found: dict[int, int] = {}
    if table is None:
        return found
    for key in list(table.values):
        if not key.isascii() or not key.isdigit() or int(key) > HIGHEST:
            table.bad(key, f"a number from 0 to {HIGHEST} is expected before the sign")
            continue
        value = table.whole(key, 0, HIGHEST)
        if value is not None:
            if value in found.values():
                table.bad(key, f"{value} is there twice: two of the source would be one")
            found[int(key)] = value
    table.finish()
    return found


def _lengths(root: TomlTable) -> dict[int, float]:
    """``4 = 62.5``: number of a tool of the target, mm that it is long."""
    table = root.table("lengths")
    found: dict[int, float] = {}
    if table is None:
        return found
    for key in list(table.values):
        if not key.isascii() or not key.isdigit() or int(key) > HIGHEST:
            table.bad(key, f"a number from 0 to {HIGHEST} is expected before the sign")
            continue
        value = table.number(key)
        if value is not None:
            found[int(key)] = value
    table.finish()
    return found


def _coolant(root: TomlTable) -> dict[str, str]:
    table = root.table("coolant")
    if table is None:
        return {}
    found = {}
    for key in ("mist", "flood"):
        value = table.text(key, ("mist", "flood"))
        if value is not None and value != key:
            found[key] = value
    table.finish()
    return found


def _style(root: TomlTable) -> dict[str, object]:
    table = root.table("style")
    if table is None:
        return {}
    found: dict[str, Any] = {key: table.whole(key, 0, 12) for key in STYLE_KEYS}
    found["extension"] = table.text("extension")
    newline = table.text("newline", tuple(NEWLINES))
    found["newline"] = None if newline is None else NEWLINES[newline]
    for key in ("header", "footer"):
        found[key] = table.texts(key)
    table.finish()
    return {key: value for key, value in found.items() if value is not None}
