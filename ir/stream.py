"""StepStream: integers only. What the board gets, to the tick.

A motor's run is (interval, count, add, direction): the first step comes ``interval`` ticks after the
motor's last step (after tick 0 of the section for the first run); then the interval grows by ``add``
before each further step. Directions are +1 or -1 in steps. Sections start at rest; tick 0 is their start.
"""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from gproof.ir.columns import Column, Columns, Schema, batches, joined
from gproof.ir.record import field, record

RUN = Schema("runs", Column("interval", "i8"), Column("count", "i8"), Column("add", "i8"), Column("direction", "i1"))

EVENT = Schema("events", Column("tick", "i8"), Column("row", "i8"), Column("op", "u1"), Column("arg", "i8", 2))
"""I/O events: tick; row of the trace section; op: trace Op; arg: the row's arguments in thousandths, rounded."""


@record(frozen=True, slots=True, kw_only=True)
class Motor:
    """A motor and the axis it drives; ``steps_per_unit`` is exact, its sign is the wiring."""

    name: str
    axis: int
    steps_per_unit: Fraction


@record(slots=True, kw_only=True)
class StreamSection:
    """One section: start position in steps by motor, one run table a motor, events, duration in ticks."""

    number: int
    start: tuple[int, ...]
    runs: tuple[Columns, ...]
    events: Columns
    duration: int

    def end(self) -> tuple[int, ...]:
        """The position in steps after the last run."""
        return tuple(
            int(s) + int((r["count"] * r["direction"].astype(np.int64)).sum())
            for s, r in zip(self.start, self.runs, strict=True)
        )


@record(slots=True, kw_only=True)
class StepStream:
    """The whole stream; sections in the numbering of the Trace."""

    tick_frequency: int
    motors: tuple[Motor, ...]
    sections: list[StreamSection] = field(default_factory=list)

    def steps(self) -> int:
        """The number of step pulses."""
        return sum(int(r["count"].sum()) for s in self.sections for r in s.runs)

    def verify(self) -> None:
        """Shapes, positive intervals and counts, directions of one step, events in order; ValueError."""
        if self.tick_frequency <= 0:
            raise ValueError("tick frequency must be positive")
        for s in self.sections:
            if len(s.start) != len(self.motors) or len(s.runs) != len(self.motors):
                raise ValueError(f"stream section {s.number}: not one run table a motor")
        for begin, end in batches([sum(map(len, s.runs)) + len(s.events) for s in self.sections]):
            sections = self.sections[begin:end]
            if not self._fits(sections):
                for s in sections:
                    self._verify(s)
                raise ValueError(f"stream sections {begin} to {end - 1} do not fit")

    def _fits(self, sections: list[StreamSection]) -> bool:
        """Whether ``_verify`` finds nothing in any of them."""
        runs = joined(RUN, [r for s in sections for r in s.runs] or [Columns(RUN)])
        first, count = runs["interval"], runs["count"]
        last = first + runs["add"] * (count - 1)
        if (count < 1).any() or (first < 1).any() or (last < 1).any() or (np.abs(runs["direction"]) != 1).any():
            return False
        ticks = np.concatenate([s.events["tick"] for s in sections])
        of = np.repeat(np.arange(len(sections)), [len(s.events) for s in sections])
        until = np.array([s.duration for s in sections], dtype=np.int64)
        back = (np.diff(ticks) < 0) & (of[1:] == of[:-1])
        return not (back.any() or (ticks < 0).any() or (ticks > until[of]).any())

    def _verify(self, s: StreamSection) -> None:
        """ValueError unless runs and events of a section can be what they say."""
        where = f"stream section {s.number}"
        for motor, runs in zip(self.motors, s.runs, strict=True):
            first, count, add = runs["interval"], runs["count"], runs["add"]
            last = first + add * (count - 1)
            if (count < 1).any() or (first < 1).any() or (last < 1).any():
                raise ValueError(f"{where}: {motor.name} has a run with no steps or no interval")
            if (np.abs(runs["direction"]) != 1).any():
                raise ValueError(f"{where}: {motor.name} has a direction that is not +1 or -1")
        ticks = s.events["tick"]
        if len(ticks) and (ticks[0] < 0 or (np.diff(ticks) < 0).any() or ticks[-1] > s.duration):
            raise ValueError(f"{where}: events out of order")
