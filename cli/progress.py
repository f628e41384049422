"""How far a command is, on standard error, from one second on: a bar on a terminal, nothing elsewhere and under CI.

rich is imported by the time that there is something to show.
"""

from __future__ import annotations

import os
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from gproof.driver.escape import in_one_line
from gproof.driver.progress import Watcher
from gproof.ir.finding import Span
from gproof.ir.trace import Chunk

AFTER = 1.0
"""Seconds before anything is shown."""


class Progress(Watcher):
    """A bar, or where no end is known a pulse, with what is done. A thread starts it, whatever the command waits for.

    wanted: whether there is anybody to show it to.
    """

    def __init__(self, what: str, *, wanted: bool = True) -> None:
        self.wanted = wanted
        self._lock = threading.Lock()
        self._state: dict[str, Any] = {"description": what, "total": None, "completed": 0}
        self._bar: Any = None
        self._task: Any = None
        self._timer = threading.Timer(AFTER, self._show) if wanted else None
        if self._timer is not None:
            self._timer.daemon = True
            self._timer.start()

    def phase(self, what: str, total: int | None = None) -> None:
        """What is done now; total: of what ``done`` counts, None: not known."""
        self._update(description=what, total=total, completed=0)

    def done(self, completed: int, what: str = "") -> None:
        """How far it is."""
        self._update(completed=completed, **({"description": what} if what else {}))

    def see(self, chunk: Chunk) -> None:
        """A job's chunk went by: the bar moves to its last line."""
        if len(chunk.rows):
            self.done(int(chunk.rows["line"][-1]))

    def beat(self, blocks: int, span: Span) -> None:
        """A loop goes round: where, and how many blocks that has come to."""
        self.done(span.line, f"checking, {blocks:,} blocks executed")

    def stop(self) -> None:
        """Take the bar away."""
        if self._timer is not None:
            self._timer.cancel()
        with self._lock:
            self._timer = None
            if self._bar is not None:
                self._bar.stop()
            self._bar = None

    def _update(self, **state: Any) -> None:
        if "description" in state:
            state["description"] = in_one_line(state["description"])
        self._state.update(state)
        bar = self._bar
        if bar is not None:
            bar.update(self._task, **state)

    def _show(self) -> None:
        from rich.console import Console
        from rich.progress import BarColumn, TaskProgressColumn, TextColumn, TimeRemainingColumn
        from rich.progress import Progress as Bar

        with self._lock:
            if self._timer is None:  # it has come to its end meanwhile
                return
            said = TextColumn("{task.description}", style="progress.description", markup=False)  # a name is no markup
            columns = said, BarColumn(), TaskProgressColumn(), TimeRemainingColumn()
            bar = Bar(*columns, console=Console(stderr=True), transient=True)
            self._task = bar.add_task(**self._state)
            bar.start()
            self._bar = bar


@contextmanager
def progress(what: str) -> Iterator[Progress]:
    """Progress of what is done inside; it is gone when something is printed after that."""
    shown = Progress(what, wanted=sys.stderr.isatty() and not os.environ.get("CI"))
    try:
        yield shown
    finally:
        shown.stop()
