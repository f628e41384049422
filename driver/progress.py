"""How far a job is: what compiling and fitting tell whoever watches. ``cli/progress.py`` draws it."""

from __future__ import annotations

from gproof.ir.finding import Span
from gproof.ir.trace import Chunk


class Watcher:
    """Nobody: every call does nothing. wanted: whether there is anybody to show it to."""

    wanted = False

    def phase(self, what: str, total: int | None = None) -> None:
        """What is done now; total: of what ``done`` counts, None: not known."""

    def done(self, completed: int, what: str = "") -> None:
        """How far it is."""

    def see(self, chunk: Chunk) -> None:
        """A job's chunk went by."""

    def beat(self, blocks: int, span: Span) -> None:
        """A loop goes round: where, and how many blocks that has come to."""
