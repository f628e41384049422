"""Arcs whose start and end lie at different distances from their centre.

Eding CNC manual 3.4.3.2: more than 0.002 mm (0.0002 inch while inches are active) is an error.
"""

from __future__ import annotations

import numpy as np

from gproof.ir import codes
from gproof.ir.finding import Severity
from gproof.ir.trace import Chunk
from gproof.ir.verdict import PropertyResult, Verdict
from gproof.passes.check import Check, row_span
from gproof.passes.extent_kernels import radius_errors

_KEPT = 64


class ArcRadius(Check):
    """The property ``arcs``."""

    name = "arcs"
    _errors = 0

    def feed(self, chunk: Chunk) -> None:
        """GP401 for each arc beyond its tolerance."""
        rows = chunk.rows
        if not len(rows):
            return
        tolerance = np.array([s.arc_tolerance for s in chunk.trace.states], dtype=np.float64)
        found = np.zeros(_KEPT, dtype=np.int64)
        start, end = np.zeros(_KEPT), np.zeros(_KEPT)
        count = radius_errors.pick(chunk.work)(
            rows["op"], rows["to"], rows["center"], rows["turns"], rows["plane"], rows["state"], tolerance,
            np.array(chunk.start, dtype=np.float64), found, start, end,
        )  # fmt: skip
        self._errors += int(count)
        for n in range(min(int(count), _KEPT)):
            row = int(found[n])
            self.findings.add(
                codes.ARC_RADIUS_MISMATCH.at(
                    row_span(chunk.trace, rows, row), start=float(start[n]), end=float(end[n]), unit="mm",
                    off=abs(float(start[n] - end[n])), allowed=float(tolerance[rows["state"][row]]),
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
