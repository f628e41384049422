"""What ``gproof run`` requires before a board moves (``backend/boards/registry.py`` has the boards)."""

from __future__ import annotations

from pathlib import Path

from gproof.backend.boards.registry import VIRTUAL
from gproof.driver.errors import UsageError


def require_for(
    board: str, *, machine: Path | None, setup: str | None, trusted: bool, allow_untrusted: bool
) -> None:  # fmt: skip
    """UsageError where a board that is not virtual would have to believe the package alone."""
    if board == VIRTUAL:
        return
    if allow_untrusted:
        raise UsageError(f"--allow-untrusted works with --board {VIRTUAL} only")
    missing = [
        name
        for name, there in (
            ("--machine", machine is not None),
            ("--setup", setup is not None),
            ("a trusted key (--trust or gproof keys trust)", trusted),
        )
        if not there
    ]
    if missing:
        raise UsageError(f"--board {board} moves a machine and also needs {' and '.join(missing)}")
