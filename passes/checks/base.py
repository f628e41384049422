"""What a check is: rows of the Trace in, findings and one property's answer out, while the job streams by."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from typing import TypedDict

import numpy as np
import numpy.typing as npt

from gproof.ir import codes
from gproof.ir.columns import Columns
from gproof.ir.finding import Finding, Findings, Related, Span
from gproof.ir.machine import AXES, Machine
from gproof.ir.record import record
from gproof.ir.setup import Interval, Setup
from gproof.ir.symbolic import Position
from gproof.ir.symbols import describe
from gproof.ir.trace import Affine, Chunk, Trace
from gproof.ir.trace_rows import split_form
from gproof.ir.verdict import Condition, PropertyResult

KEPT = 64
"""Offences of a chunk that are reported one by one at least, and for which there is room at first."""


class Like(TypedDict, total=False):
    """For how many of its kind a finding is: keyword arguments of ``Findings.add``."""

    times: int
    first_line: int
    last_line: int


@record(frozen=True, slots=True, eq=False)
class Remains:
    """What is left of a body, by larger cells: (ny, nx) heights that nothing of it is above, -inf for nothing.

    body: its place among those of the setup; grid: (x0, y0, hx, hy, floor, top), mm; before: what was there
    before the job.
    """

    body: int
    grid: npt.NDArray[np.float64]
    upper: npt.NDArray[np.float64]
    before: npt.NDArray[np.float64]


ZeroAt = Callable[[int, int], Position]
"""(coordinate system, 0 for the one in force; column) -> its zero when the job starts, in machine coordinates."""


class Check(ABC):
    """One property of the Trace. ``feed`` gets every chunk in order, then ``finish`` answers."""

    name: str

    def __init__(self, machine: Machine, setup: Setup, findings: Findings) -> None:
        self.machine = machine
        self.setup = setup
        self.findings = findings

        self._known = np.zeros((0, AXES), dtype=np.uint8)

    @property
    def kept(self) -> int:
        """Offences of a chunk that are reported one by one, as many as ``findings`` takes; others come together.

        Where somebody may accept findings each has to be there by itself, or none is known again.
        """
        return max(KEPT, self.findings.limit)

    def known(self, trace: Trace) -> npt.NDArray[np.uint8]:
        """(frames, 6): 1 where an axis rests on nothing unknown. Frames are added while a job streams by."""
        have = len(self._known)
        if have < len(trace.frames):
            new = [[form == () for form in frame] for frame in trace.frames[have:]]
            self._known = np.concatenate([self._known, np.array(new, dtype=np.uint8).reshape(-1, AXES)])
        return self._known

    @abstractmethod
    def feed(self, chunk: Chunk) -> None:
        """Look at some successive rows."""

    @abstractmethod
    def finish(self) -> PropertyResult:
        """The answer, after the last chunk."""

    def remains(self) -> tuple[Remains, ...]:
        """What is left of stock where the job ended last; nothing from checks that do not look at stock."""
        return ()


def of_one_kind(
    rows: Columns, found: npt.NDArray[np.int64], kinds: npt.NDArray[np.int64], far: npt.NDArray[np.float64]
) -> Iterator[tuple[int, Like]]:
    """Offences put together by file and kind: the first of each, and the one that goes furthest with all others.

    found: rows of the chunk; kinds: (n, ...) what tells one kind from another; far: how far each goes. Yields an
    index into found and what ``Findings.add`` takes.
    """
    if not len(found):
        return
    keys = np.column_stack([rows["file"][found].astype(np.int64), kinds])
    lines = rows["line"][found]
    names, kind = np.unique(keys, axis=0, return_inverse=True)
    for n in range(len(names)):
        own = np.flatnonzero(kind.reshape(-1) == n)
        most = int(own[np.argmax(far[own])])
        first_line, last_line = int(lines[own].min()), int(lines[own].max())
        others = len(own)
        if most != own[0]:
            yield int(own[0]), Like(times=1)
            others -= 1
        yield most, Like(times=others, first_line=first_line, last_line=last_line)


def told_of(
    rows: Columns, found: npt.NDArray[np.int64], kinds: npt.NDArray[np.int64], far: npt.NDArray[np.float64], kept: int
) -> Iterator[tuple[int, Like]]:
    """The first ``kept`` offences one by one, the others as ``of_one_kind`` puts them together."""
    yield from ((n, Like()) for n in range(min(len(found), kept)))
    for n, like in of_one_kind(rows, found[kept:], kinds[kept:], far[kept:]):
        yield n + kept, like


Asking = tuple[Span | None, str]
"""A move, None where none is known, and what it requires."""


def excluding(below: Asking, above: Asking, otherwise: Span) -> tuple[Span, str, tuple[Related, ...]]:
    """Where two moves that exclude each other are reported: (place of the later one, what it asks, the other one).

    A file that is called has no place before or after the job's lines: the second one counts there.
    """
    there = [(span, asks) for span, asks in (below, above) if span is not None]
    if not there:
        return otherwise, "", ()
    if len(there) == 1 or there[0][0] == there[1][0]:
        return there[0][0], f"check this line: it needs {' and '.join(asks for _, asks in there)}", ()
    (one, asks), (other, others) = there
    if one.file == other.file and one.line > other.line:
        (one, asks), (other, others) = (other, others), (one, asks)
    return other, f"check both lines: this line needs {others}", (Related(one, f"this line needs {asks}"),)


def apart(asked: Condition, machine: Machine, unit: str, otherwise: Span) -> tuple[Span, str, tuple[Related, ...]]:
    """The same for a condition that nothing satisfies; unit: of its ends."""
    name = describe(asked.terms, machine)
    below = asked.places[0], f"{name} of at least {asked.low + 0.0:.3f} {unit}"
    above = asked.places[1], f"{name} of at most {asked.high + 0.0:.3f} {unit}"
    return excluding(below, above, otherwise)


def no_safe_offset(
    span: Span, form: Affine, machine: Machine, *, extent: float, room: float, unit: str, hint: str = "",
    related: tuple[Related, ...] = (),
) -> Finding:  # fmt: skip
    """GP303 of unknowns that nothing bounds; extent: what the job spans on the axis, room: what the axis has."""
    name = describe(form, machine)
    code = codes.NEVER_FITS if split_form(form)[0] else codes.NO_SAFE_OFFSET
    return code.at(span, name=name, extent=extent, unit=unit, room=room, hint=hint, related=related)


def inward(low: float, high: float, to: str = " to ") -> str:
    """A range that is safe, in words: with three decimals, rounded to the side on which it still holds."""
    least = math.ceil(round(low * 1e3, 3)) / 1e3 if math.isfinite(low) else low
    most = math.floor(round(high * 1e3, 3)) / 1e3 if math.isfinite(high) else high
    return f"{least + 0.0:.3f}{to}{most + 0.0:.3f}" if least <= most else f"{low:.6f}{to}{high:.6f}"


def none_suits(span: Span, form: Affine, machine: Machine, *, known: Interval, safe: Interval, unit: str) -> Finding:
    """GP303 of unknowns whose whole range is on one side of what is safe."""
    above = known.low > safe.high
    ends = (known.low, safe.high) if above else (known.high, safe.low)
    said = f"{round(known.low, 6) + 0.0:g} to {round(known.high, 6) + 0.0:g}"
    code = codes.OFFSET_TOO_LARGE if above else codes.OFFSET_TOO_SMALL
    return code.at(
        span, name=describe(form, machine), extent=ends[0] + 0.0, unit=unit, room=ends[1] + 0.0,
        hint=f"set it from {inward(safe.low, safe.high)} {unit}; it is {said} {unit}",
    )  # fmt: skip
