"""What files of WinCNC are called, in lower case."""

from __future__ import annotations

EXTENSIONS = (".tap", ".mac", ".wnc")
"""Of programs and subprograms."""
MACRO_FILE = "cnc.mac"
"""The file of definitions."""
SETTINGS = "wincnc.ini"
