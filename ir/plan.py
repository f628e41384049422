"""Plan: a section of the Trace with time.

Each row is one trace row that takes time: motion with a trapezoidal velocity along its path (speeds are
along the path, mm/s; for moves of rotary axes alone deg/s), or a dwell.
"""

from __future__ import annotations

import numpy as np

from gproof.ir.columns import Column, Columns, Schema
from gproof.ir.record import field, record

PLAN_ROW = Schema(
    "plan",
    Column("row", "i8"),
    Column("begin", "f8"),
    Column("duration", "f8"),
    Column("length", "f8"),
    Column("entry", "f8"),
    Column("cruise", "f8"),
    Column("exit", "f8"),
    Column("acceleration", "f8"),
)
"""row: index in the trace section, in several lines where a row is followed in parts; ``begin``, duration: seconds from
the section's start; length: path length
(0 for a dwell); entry, cruise, exit: path velocities; acceleration: path acceleration of both ramps."""

TOLERANCE = 1e-6


@record(slots=True, kw_only=True)
class PlanSection:
    """The timed rows of trace section ``number``; it starts and ends at rest."""

    number: int
    rows: Columns
    duration: float


@record(slots=True, kw_only=True)
class Plan:
    """All sections, in the numbering of the Trace."""

    sections: list[PlanSection] = field(default_factory=list)

    @property
    def duration(self) -> float:
        """Seconds of all sections, waits not counted."""
        return sum(section.duration for section in self.sections)

    def verify(self) -> None:
        """Velocities continuous from rest to rest, ramps fit their lengths, time without gaps."""
        for s in self.sections:
            r, where = s.rows, f"plan section {s.number}"
            if not len(r):
                continue
            for name in ("duration", "length", "entry", "cruise", "exit"):
                if not (np.isfinite(r[name]).all() and (r[name] >= 0).all()):
                    raise ValueError(f"{where}: {name} negative or not finite")
            if (np.diff(r["row"]) < 0).any():
                raise ValueError(f"{where}: rows out of order")
            if r["entry"][0] != 0 or r["exit"][-1] != 0 or (r["entry"][1:] != r["exit"][:-1]).any():
                raise ValueError(f"{where}: velocity is not continuous from rest to rest")
            if (r["cruise"] < np.maximum(r["entry"], r["exit"])).any():
                raise ValueError(f"{where}: cruise below entry or exit")
            moving = r["length"] > 0
            v, u, w, a = r["cruise"][moving], r["entry"][moving], r["exit"][moving], r["acceleration"][moving]
            if not (a > 0).all():
                raise ValueError(f"{where}: motion without acceleration")
            ramps = (2 * v * v - u * u - w * w) / (2 * a)
            if (ramps > r["length"][moving] * (1 + TOLERANCE) + 1e-9).any():
                raise ValueError(f"{where}: ramps longer than the path")
            end = r["begin"] + r["duration"]
            if (np.abs(r["begin"][1:] - end[:-1]) > TOLERANCE * np.maximum(1.0, end[:-1])).any():
                raise ValueError(f"{where}: gaps in time")
