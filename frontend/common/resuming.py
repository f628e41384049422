"""What a new program needs to go on with a job in its middle: where it goes on, and why it cannot."""

from __future__ import annotations

from collections.abc import Callable

from gproof.ir.record import record


class CannotResume(Exception):
    """A program cannot be continued at a line; the text names what is in the way, and its line.

    line: of what is in the way; 0: no one line.
    """

    def __init__(self, why: str, line: int = 0) -> None:
        super().__init__(why)
        self.line = line


@record(frozen=True, slots=True, kw_only=True)
class Start:
    """Where a job goes on. line: the first one that is executed again, counted from 1; job: its name.

    at: axis letter -> machine position before that line, mm or degrees, for the axes of the machine; top: machine
    position of Z to which it is raised first; plane: down to which it goes at rapid, the rest at feed. plunge: mm/min,
    the slowest at which the job has gone down so far, None: it has not. before: line -> machine position before it, by
    axis letter, None: not known. work: where places rest on an offset that is not known, the known part of the zero, in
    the order of at, so that they can be said in work coordinates; else empty.
    """

    line: int
    job: str
    at: tuple[tuple[str, float], ...]
    top: float
    plane: float
    plunge: float | None = None
    before: Callable[[int], dict[str, float] | None] | None = None
    work: tuple[float, ...] = ()


@record(frozen=True, slots=True)
class Resumed:
    """A new program: its lines before the first one of the job that it has again, the text of all, and what the
    operator has to know."""

    added: tuple[str, ...]
    text: str
    notes: tuple[str, ...] = ()
