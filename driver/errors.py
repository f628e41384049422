"""Why a command could not run, for every face of gproof: one line, and the findings that led to it."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from gproof.ir.finding import Findings

COULD_NOT_RUN = 3
"""The exit code of a command that could not run; 0, 1 and 2 are those of verdicts."""

Tell = Callable[["Findings"], None]
"""What takes the findings of a file that can be used all the same: the driver itself prints nothing."""


class UsageError(Exception):
    """Arguments or files that cannot be used. findings: what was found in them, said before the line."""

    def __init__(self, message: str, findings: Findings | None = None) -> None:
        super().__init__(message)
        self.message = message
        self.findings = findings
