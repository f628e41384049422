"""Notes of the stretches that a job runs with a guard off: from which line to which, and how far the axes go there.

Guards: soft limits (Eding MCAGuard, 4.2; WinCNC L21; McuWIN G98 and G99 beyond the limits of the machine's file),
boundaries (WinCNC L21), tool change area (Eding TCAGuard, 4.2). What passes a limit there has findings of its own.
"""

from __future__ import annotations

import itertools
import math

import numpy as np

from gproof.ir import codes
from gproof.ir.finding import Findings, Span
from gproof.ir.machine import AXES, Machine
from gproof.ir.trace import UNMEASURED, Chunk
from gproof.ir.trace_rows import row_span

NAMES = {"machine_area": "soft limits", "boundaries": "boundaries", "tool_change_area": "tool change area"}
"""Guards as messages name them."""

Guards = tuple[str, ...]


class GuardStretches:
    """GP338 for each stretch in which something moves. A row's guards are those of its state."""

    def __init__(self, machine: Machine, findings: Findings) -> None:
        self._machine, self._findings = machine, findings
        self._has_boundaries = any(
            axis.boundary_lower is not None or axis.boundary_upper is not None for axis in machine.axes
        )
        self._sets: dict[Guards, int] = {(): 0}
        self._of_state: list[int] = []
        self._off: Guards = ()
        self._first = self._last = Span("", 1)
        self._moves = 0
        self._open = False
        self._low, self._high = np.full(AXES, math.inf), np.full(AXES, -math.inf)

    def feed(self, chunk: Chunk) -> None:
        """Some successive rows."""
        for state in chunk.trace.states[len(self._of_state) :]:
            # Low boundaries that do not count yet nobody has switched off.
            off = tuple(name for name in state.guards_off if name != UNMEASURED)
            self._of_state.append(self._sets.setdefault(off, len(self._sets)))
        if not len(chunk.rows) or len(self._sets) == 1:
            return
        kinds = np.array(self._of_state)[chunk.rows["state"]]
        edges = [0, *(np.flatnonzero(kinds[1:] != kinds[:-1]) + 1).tolist(), len(kinds)]
        by_number = list(self._sets)
        for begin, end in itertools.pairwise(edges):
            self._run(chunk, begin, end, by_number[int(kinds[begin])])

    def finish(self) -> None:
        """After the last chunk."""
        self._close()

    def _run(self, chunk: Chunk, begin: int, end: int, off: Guards) -> None:
        rows, trace = chunk.rows, chunk.trace
        if off != self._off:
            self._close()
            self._off, self._first = off, row_span(trace, rows, begin)
        if not off:
            return
        moving = np.flatnonzero(rows["op"][begin:end] < 10) + begin
        if not len(moving):
            return
        self._last = row_span(trace, rows, int(moving[-1]))
        self._moves += len(moving)
        # Places at the ends of moves are enough for a note: arcs within them have the findings of their own.
        of_frame = np.array([[form == () for form in frame] for frame in trace.frames], dtype=bool)
        begins, ends = chunk.starts()[moving], rows["to"][moving]
        self._open = self._open or bool((~of_frame[rows["frame"][moving]] & (ends != begins)).any())
        for frames, places in ((chunk.start_frames()[moving], begins), (rows["frame"][moving], ends)):
            known = of_frame[frames]
            self._low = np.minimum(self._low, np.where(known, places, math.inf).min(axis=0))
            self._high = np.maximum(self._high, np.where(known, places, -math.inf).max(axis=0))

    def _close(self) -> None:
        if self._off and self._moves:
            names = [NAMES.get(name, name) for name in self._off if name != "boundaries" or self._has_boundaries]
            places = [
                f"{axis.word} {low + 0.0:.3f} ... {high + 0.0:.3f} {axis.unit}"
                for axis in self._machine.axes
                if (low := float(self._low[axis.index])) < (high := float(self._high[axis.index]))
            ]
            where = f", {', '.join(places)}" if places else ""
            if self._open:
                where += ", and unknown places"
            self._findings.add(
                codes.GUARD_OFF_STRETCH.at(
                    self._first, guards=" and ".join(names) or "guards", last=self._last.line,
                    moves=f"{self._moves} move{'' if self._moves == 1 else 's'}", where=where,
                )
            )  # fmt: skip
        self._moves, self._open = 0, False
        self._low, self._high = np.full(AXES, math.inf), np.full(AXES, -math.inf)
