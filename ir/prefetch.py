"""Long jobs use a second processor: the next piece of a table is read, and the motion is timed, next to the main run.

Compiled kernels run without the interpreter's lock. What is done here depends on its arguments alone and is taken over
in the order of the job, so that the answer is the same byte for byte with one processor and with several; a mistake
arises where its result is used. Short jobs start no thread.
"""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from gproof.ir.columns import Columns
from gproof.ir.mapped import forget
from gproof.ir.program import BlockTable, Program

if TYPE_CHECKING:
    from concurrent.futures import Future, ThreadPoolExecutor

T = TypeVar("T")

LONG_TABLE = 4 << 20
"""Bytes of a table from which on its next piece is read in parallel with the one that runs."""
LONG_RUN = 1 << 16
"""Rows for which calls are made at once before later ones wait for a thread: by then kernels are compiled."""
MOST_WAITING = 2
"""Calls that wait, at most: each holds its chunk."""

Piece = tuple[Columns, int, int]
"""What ``Program.load`` gives: words, next byte, its line."""


def processors() -> int:
    """How many this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _one_thread() -> ThreadPoolExecutor:
    from concurrent.futures import ThreadPoolExecutor

    return ThreadPoolExecutor(max_workers=1)


class Ahead:
    """Pieces of a program's tables; of a long one the next piece is read while one runs."""

    def __init__(self, program: Program) -> None:
        self.program = program
        self._pool: ThreadPoolExecutor | None = None
        self._next: Future[Piece] | None = None
        self._next_of: tuple[Any, ...] = ()

    def load(self, table: BlockTable, begin: int, line: int, limit: int) -> Piece:
        """As ``Program.load``."""
        coming, self._next = self._next, None
        if coming is not None and self._next_of == (table, begin, line, limit):
            piece = coming.result()
        else:
            piece = self.program.load(table, begin, line, limit)
        _, after, next_line = piece
        if table.words is None:
            forget(self.program.files[table.file].data, begin, after)
        if table.words is None and after < table.end and table.end - table.begin >= LONG_TABLE and processors() > 1:
            if self._pool is None:
                self._pool = _one_thread()
            self._next_of = (table, after, next_line, limit)
            self._next = self._pool.submit(self.program.load, *self._next_of)
        return piece


class InOrder(Generic[T]):
    """Calls of a function that gives nothing back, one after another, in parallel with the run that makes them.

    ``wait`` comes before anybody looks at what they did.
    """

    def __init__(self, function: Callable[[T], None]) -> None:
        self.function = function
        self._rows = 0
        self._pool: ThreadPoolExecutor | None = None
        self._waiting: deque[Future[None]] = deque()

    def __call__(self, argument: T, rows: int) -> None:
        """Call it now or soon; rows: how large the argument is."""
        self._rows += rows
        if self._rows <= LONG_RUN or processors() == 1:
            self.function(argument)
            return
        if self._pool is None:
            self._pool = _one_thread()
        while len(self._waiting) >= MOST_WAITING:
            self._waiting.popleft().result()
        self._waiting.append(self._pool.submit(self.function, argument))

    def wait(self) -> None:
        """Until all calls are done; the first exception of any is raised here, or at a later call."""
        while self._waiting:
            self._waiting.popleft().result()
