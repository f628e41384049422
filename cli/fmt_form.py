"""How ``gproof fmt`` reads and prints a file."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path

from gproof.ir.finding import Findings
from gproof.ir.machine import NO_MACHINE, Machine
from gproof.ir.program import Program
from gproof.ir.record import record


@record(frozen=True, slots=True)
class Form:
    """How the files of a folder are read and printed.

    load: (path, findings, name) -> program; None when refused. others: (file as it is, file as printed) -> what would
    be another program then, of the files that are read with this one's help; "" for nothing. emit_less: prints what
    changes none of them, as far as that can be. judge: (program, program of what was printed) -> what else shows that
    they are not the same; "" for nothing. instead: other ways to read a file that has mistakes in this one; what: what
    this way is, in words; said: what the reader of the file should know of how it was printed; machine: whose axes the
    lines move, which decides what lines are not understood and stay as they are.
    """

    load: Callable[[Path, Findings, str], Program | None]
    emit: Callable[[Program], Iterable[bytes]]
    others: Callable[[Path, Path], str] = lambda before, after: ""
    emit_less: Callable[[Program], Iterable[bytes]] | None = None
    judge: Callable[[Program, Program], str] = lambda before, after: ""
    instead: Callable[[], Iterable[Form]] = tuple
    what: str = ""
    said: Callable[[], str] = str
    machine: Machine = NO_MACHINE
