"""Arcs as the controller will take them: start and end radius that differ, ends that rounding brought together, lines.

Eding CNC manual 3.4.3.2: more than 0.002 mm (0.0002 inch while inches are active) between the radii is an error; WinCNC
Users Guide, arc_err=; McuWIN, status 2000. ``State.arc_tolerance`` has what is allowed.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from gproof.ir import codes
from gproof.ir.finding import Finding, Severity
from gproof.ir.trace import Chunk
from gproof.ir.trace_rows import row_span
from gproof.ir.verdict import PropertyResult, Verdict
from gproof.passes.checks.base import KEPT, Check, told_of
from gproof.passes.geometry.extent_kernels import MISMATCH, odd_arcs

Floats = npt.NDArray[np.float64]
Integers = npt.NDArray[np.int64]
_CLOSES_HINT = "end a full circle exactly at its start; write a short arc as a straight line"


class ArcRadius(Check):
    """The property ``arcs``."""

    name = "arcs"
    _errors = 0

    def feed(self, chunk: Chunk) -> None:
        """GP401 for each arc beyond its tolerance, GP408 and GP409 for those that rounding may change."""
        rows = chunk.rows
        if not len(rows):
            return
        tolerance = np.array([s.arc_tolerance for s in chunk.trace.states], dtype=np.float64)
        made = np.array([s.compensation != 0 for s in chunk.trace.states], dtype=np.int64)
        counts, found, start, end, chord = self._odd(chunk, tolerance, made, KEPT)
        if counts.max() > KEPT:
            counts, found, start, end, chord = self._odd(chunk, tolerance, made, int(counts.max()))
        self._errors += int(counts[MISMATCH])
        tell = (
            (self._mismatch, np.abs(start - end)),
            (self._closes, -chord),
            (self._huge, chord**2 / np.maximum(8 * start, 1.0)),
        )
        for kind, (say, far) in enumerate(tell):
            count = int(counts[kind])
            one = np.zeros((count, 1), dtype=np.int64)
            for n, like in told_of(rows, found[kind, :count], one, far[kind, :count], self.kept):
                radii, allowed = (float(start[kind, n]), float(end[kind, n])), tolerance[rows["state"][found[kind, n]]]
                self.findings.add(say(chunk, int(found[kind, n]), radii, float(chord[kind, n]), float(allowed)), **like)

    def first_mismatch(self, chunk: Chunk) -> tuple[int, Finding] | None:
        """The row of the first arc that no controller takes, and its GP401."""
        if not len(chunk.rows):
            return None
        states = chunk.trace.states
        tolerance = np.array([s.arc_tolerance for s in states], dtype=np.float64)
        made = np.array([s.compensation != 0 for s in states], dtype=np.int64)
        counts, found, start, end, chord = self._odd(chunk, tolerance, made, 1)
        if not counts[MISMATCH]:
            return None
        row = int(found[MISMATCH, 0])
        radii, allowed = (float(start[MISMATCH, 0]), float(end[MISMATCH, 0])), tolerance[chunk.rows["state"][row]]
        return row, self._mismatch(chunk, row, radii, float(chord[MISMATCH, 0]), float(allowed))

    def _odd(
        self, chunk: Chunk, tolerance: Floats, made: Integers, room: int
    ) -> tuple[Integers, Integers, Floats, Floats, Floats]:
        """Of each kind how many there are; of the first their rows, both radii and the distance of the ends, mm."""
        rows = chunk.rows
        counts, found = np.zeros(3, dtype=np.int64), np.zeros((3, room), dtype=np.int64)
        start, end, chord = np.zeros((3, room)), np.zeros((3, room)), np.zeros((3, room))
        odd_arcs.pick(chunk.work)(
            rows["op"], rows["to"], rows["center"], rows["turns"], rows["plane"], rows["state"], tolerance,
            made, np.array(chunk.start, dtype=np.float64), counts, found, start, end, chord,
        )  # fmt: skip
        return counts, found, start, end, chord

    def _mismatch(self, chunk: Chunk, row: int, radii: tuple[float, float], _: float, allowed: float) -> Finding:
        """GP401."""
        return codes.ARC_RADIUS_MISMATCH.at(
            row_span(chunk.trace, chunk.rows, row), start=radii[0], end=radii[1], unit="mm",
            off=abs(radii[0] - radii[1]), allowed=allowed,
        )  # fmt: skip

    def _closes(self, chunk: Chunk, row: int, radii: tuple[float, float], chord: float, _: float) -> Finding:
        """GP408: an arc between two ends that may be one."""
        rows, radius = chunk.rows, radii[0]
        short = math.degrees(2.0 * math.asin(min(1.0, chord / (2.0 * radius))))
        before = rows["to"][row - 1] if row else np.array(chunk.start)
        degrees = _onward(
            before, rows["to"][row], rows["center"][row], int(rows["plane"][row]), int(rows["turns"][row])
        )
        long = 360.0 - short
        turned, other = (short, long) if degrees else (long, short)
        return codes.ARC_CLOSES.at(
            row_span(chunk.trace, rows, row), chord=chord, unit="mm", degrees=turned, other=other, hint=_CLOSES_HINT
        )

    def _huge(self, chunk: Chunk, row: int, radii: tuple[float, float], chord: float, _: float) -> Finding:
        """GP409."""
        radius = radii[0]
        return codes.ARC_HUGE.at(
            row_span(chunk.trace, chunk.rows, row), radius=radius, chord=chord, unit="mm",
            off=chord * chord / (8.0 * radius), hint="program a straight move instead",
        )  # fmt: skip

    def finish(self) -> PropertyResult:
        """UNSAFE with an error of this or the executor's on arcs, UNKNOWN with an unknown one, else SAFE."""
        verdict = Verdict.SAFE
        if self._errors or self.findings.has(Severity.ERROR, (self.name,)):
            verdict = Verdict.UNSAFE
        elif self.findings.has(Severity.UNKNOWN, (self.name,)):
            verdict = Verdict.UNKNOWN
        return PropertyResult(name=self.name, verdict=verdict)


def _onward(before: np.ndarray, to: np.ndarray, center: np.ndarray, plane: int, turns: int) -> bool:
    """Whether the end is a little ahead of the start, so that the arc is the short one."""
    u, v = {1: (0, 1), 2: (2, 0), 3: (1, 2)}[plane]
    u0, v0, u1, v1 = before[u] - center[u], before[v] - center[v], to[u] - center[u], to[v] - center[v]
    return bool((u0 * v1 - v0 * u1) * turns > 0.0)
