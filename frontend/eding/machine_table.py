"""Keys of ``[controller]`` of gproof's own machine file that only Eding CNC has. docs/machine-files.md lists them."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from gproof.frontend.common.toml_table import TomlTable
from gproof.ir.dialects.eding.settings import EdingSettings, eding_settings
from gproof.ir.machine import Machine

THREAD_PEAKS = ("position", "offset")


def keys_of(table: TomlTable) -> dict[str, Any]:
    """What ``[controller]`` states."""
    stated = {
        "macro_file": table.text("macro_file"),
        "super_long_file": table.positive("super_long_file"),
        "thread_peak": table.text("thread_peak", THREAD_PEAKS),
    }
    return {key: value for key, value in stated.items() if value is not None}


def settings_from(machine: Machine, keys: dict[str, Any]) -> EdingSettings:
    """The machine's settings with what ``[controller]`` states."""
    return replace(eding_settings(machine), **keys)
