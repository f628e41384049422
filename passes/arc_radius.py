"""Arcs as the controller will take them: start and end radius that differ, ends that rounding brought together, lines.

Eding CNC manual 3.4.3.2: more than 0.002 mm (0.0002 inch while inches are active) between the radii is an error; WinCNC
Users Guide, arc_err=; McuWIN, status 2000. ``State.arc_tolerance`` has what is allowed.
"""

from __future__ import annotations

import math

import numpy as np

from gproof.ir import codes
from gproof.ir.finding import Severity
from gproof.ir.trace import Chunk
from gproof.ir.verdict import PropertyResult, Verdict
from gproof.passes.check import Check, row_span
from gproof.passes.extent_kernels import CLOSES, IS_HUGE, MISMATCH, odd_arcs

_KEPT = 64
_CODES = codes.ARC_RADIUS_MISMATCH, codes.ARC_CLOSES, codes.ARC_HUGE
_CLOSES_HINT = "a full circle ends exactly where it begins; a short arc is better written as a line"


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
        counts, found = np.zeros(3, dtype=np.int64), np.zeros((3, _KEPT), dtype=np.int64)
        start, end, chord = np.zeros((3, _KEPT)), np.zeros((3, _KEPT)), np.zeros((3, _KEPT))
        odd_arcs.pick(chunk.work)(
            rows["op"], rows["to"], rows["center"], rows["turns"], rows["plane"], rows["state"], tolerance,
            made, np.array(chunk.start, dtype=np.float64), counts, found, start, end, chord,
        )  # fmt: skip
        self._errors += int(counts[MISMATCH])
        for code, count in zip(_CODES, counts.tolist(), strict=True):
            if count > _KEPT:
                self.findings.counts[code.number] = self.findings.counts.get(code.number, 0) + count - _KEPT
        for n in range(min(int(counts[MISMATCH]), _KEPT)):
            row = int(found[MISMATCH, n])
            r0, r1 = float(start[MISMATCH, n]), float(end[MISMATCH, n])
            allowed = float(tolerance[rows["state"][row]])
            self.findings.add(
                codes.ARC_RADIUS_MISMATCH.at(
                    row_span(chunk.trace, rows, row), start=r0, end=r1, unit="mm", off=abs(r0 - r1), allowed=allowed
                )
            )
        for n in range(min(int(counts[CLOSES]), _KEPT)):
            self._closes(chunk, int(found[CLOSES, n]), float(start[CLOSES, n]), float(chord[CLOSES, n]))
        for n in range(min(int(counts[IS_HUGE]), _KEPT)):
            radius, ends = float(start[IS_HUGE, n]), float(chord[IS_HUGE, n])
            self.findings.add(
                codes.ARC_HUGE.at(
                    row_span(chunk.trace, rows, int(found[IS_HUGE, n])), radius=radius, chord=ends, unit="mm",
                    off=ends * ends / (8.0 * radius), hint="a straight move says the same",
                )
            )  # fmt: skip

    def _closes(self, chunk: Chunk, row: int, radius: float, chord: float) -> None:
        """GP408: an arc between two ends that may be one."""
        rows = chunk.rows
        short = math.degrees(2.0 * math.asin(min(1.0, chord / (2.0 * radius))))
        before = rows["to"][row - 1] if row else np.array(chunk.start)
        degrees = _onward(
            before, rows["to"][row], rows["center"][row], int(rows["plane"][row]), int(rows["turns"][row])
        )
        long = 360.0 - short
        turned, other = (short, long) if degrees else (long, short)
        self.findings.add(
            codes.ARC_CLOSES.at(
                row_span(chunk.trace, rows, row), chord=chord, unit="mm", degrees=turned, other=other,
                hint=_CLOSES_HINT,
            )
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
    """Whether the end lies a little ahead of the start, so that the arc is the short one."""
    u, v = {1: (0, 1), 2: (2, 0), 3: (1, 2)}[plane]
    u0, v0, u1, v1 = before[u] - center[u], before[v] - center[v], to[u] - center[u], to[v] - center[v]
    return bool((u0 * v1 - v0 * u1) * turns > 0.0)
