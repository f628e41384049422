"""Names of files that files state: whatever they are, asking for them is no error."""

from __future__ import annotations

from pathlib import Path


def is_file(path: Path) -> bool:
    """True for a regular file; False for what cannot even be a name."""
    try:
        return path.is_file()
    except (OSError, ValueError):
        return False


def is_there(path: Path) -> bool:
    """True for a file or folder of any kind; False for what cannot even be a name."""
    try:
        return path.exists()
    except (OSError, ValueError):
        return False
