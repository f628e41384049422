"""One file by itself, to be printed again: how ``gproof fmt`` reads it."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path

from gproof.ir.finding import Findings
from gproof.ir.machine import NO_MACHINE, Machine
from gproof.ir.program import Program
from gproof.ir.record import record


@record(frozen=True, slots=True)
class Alone:
    """A way to read a file.

    load: (path, findings, name) -> program; None when refused. machine: whose settings say how lines are read, and
    whose axes they move, which decides what lines are not understood and stay as they are. others: (file as it is, file
    as printed) -> what would be another program then, of the files that are read with this one's help; "" for nothing.
    instead: other ways to read a file that has mistakes in this one; what: what this way is, in words; said: what the
    reader of the file should know of how it was printed; as_is: lines that stay as they are, once it has been read.
    """

    load: Callable[[Path, Findings, str], Program | None]
    machine: Machine = NO_MACHINE
    others: Callable[[Path, Path], str] = lambda before, after: ""
    instead: Callable[[], Iterable[Alone]] = tuple
    what: str = ""
    said: Callable[[], str] = str
    as_is: Callable[[], frozenset[int]] = frozenset
