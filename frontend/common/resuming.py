"""What a new program needs to go on with a job in its middle: where it goes on, and why it cannot."""

from __future__ import annotations

from gproof.ir.record import record


class CannotResume(Exception):
    """A program cannot be continued at a line; the text names what is in the way, and its line."""


@record(frozen=True, slots=True, kw_only=True)
class Start:
    """Where a job goes on. line: the first one that is executed again, counted from 1; job: its name.

    at: axis letter -> machine position before that line, mm or degrees, for the axes of the machine; top: machine
    position of Z to which it is raised first; plane: down to which it goes at rapid, the rest at feed. plunge: mm/min,
    the slowest at which the job has gone down so far, None: it has not.
    """

    line: int
    job: str
    at: tuple[tuple[str, float], ...]
    top: float
    plane: float
    plunge: float | None = None


@record(frozen=True, slots=True)
class Resumed:
    """A new program: its lines before the first one of the job that it has again, and the text of all."""

    added: tuple[str, ...]
    text: str
