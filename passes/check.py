"""What a check is: rows of the Trace in, findings and one property's answer out, while the job streams by."""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np
import numpy.typing as npt

from gproof.ir.columns import Columns
from gproof.ir.finding import Findings, Span
from gproof.ir.machine import AXES, Machine
from gproof.ir.setup import Interval, Setup
from gproof.ir.trace import UNKNOWN, Affine, Chunk, Trace
from gproof.ir.verdict import PropertyResult


class Check(ABC):
    """One property of the Trace. ``feed`` gets every chunk in order, then ``finish`` answers."""

    name: str

    def __init__(self, machine: Machine, setup: Setup, findings: Findings) -> None:
        self.machine = machine
        self.setup = setup
        self.findings = findings

        self._known = np.zeros((0, AXES), dtype=np.uint8)

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


def row_span(trace: Trace, rows: Columns, row: int) -> Span:
    """The source line of a row."""
    return Span(trace.files[int(rows["file"][row])], int(rows["line"][row]))


def form_interval(form: Affine, setup: Setup, trace: Trace) -> Interval | None:
    """The range of a sum of unknowns by what setup and trace tell; None when some part is not bounded."""
    low = high = 0.0
    for symbol, coefficient in form:
        if form == UNKNOWN:
            return None
        known = trace.symbols.get(symbol) or setup.interval(symbol)
        if known is None:
            return None
        ends = (known.low * coefficient, known.high * coefficient)
        low, high = low + min(ends), high + max(ends)
    return Interval(low, high)


_STATED = ("start", "work", "g92", "tool", "head")


def split_form(form: Affine) -> tuple[Affine, Affine]:
    """(unknowns that arise in the run, those that a setup can state): only the second can be a condition of a verdict.

    Nobody can promise before the job runs where a probe will touch.
    """
    arising = tuple(term for term in form if term[0].split(".")[0] not in _STATED)
    return arising, tuple(term for term in form if term not in arising)
