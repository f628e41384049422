"""Where a job starts to rest on something: its first move, and the first one under each frame.

What is said of a whole job has a line too: that of the move with which it starts to matter.
"""

from __future__ import annotations

import numpy as np

from gproof.ir.columns import occurring
from gproof.ir.finding import Span
from gproof.ir.trace import Affine, Chunk, Op, Trace
from gproof.ir.trace_rows import row_span


class FirstMoves:
    """Rows in, first moves out. job: the first of all, None before it."""

    def __init__(self) -> None:
        self.job: Span | None = None
        self._of_frame: dict[int, Span] = {}
        self._of_symbol: dict[str, Span] = {}

    def feed(self, chunk: Chunk) -> None:
        """Some successive rows."""
        rows, trace = chunk.rows, chunk.trace
        if not len(rows):
            return
        found: list[tuple[int, int]] = []
        for frame in set(occurring(rows["frame"])) - self._of_frame.keys():
            moves = np.flatnonzero((rows["frame"] == frame) & (rows["op"] <= Op.PROBE))
            if len(moves):
                found.append((int(moves[0]), frame))
        for row, frame in sorted(found):
            self._note(trace, frame, row_span(trace, rows, row))

    def _note(self, trace: Trace, frame: int, span: Span) -> None:
        self.job = self.job or span
        self._of_frame[frame] = span
        for form in trace.frames[frame]:
            for symbol, _ in form:
                self._of_symbol.setdefault(symbol, span)

    def of_frame(self, frame: int) -> Span | None:
        """The first move under a frame."""
        return self._of_frame.get(frame)

    def of_terms(self, terms: Affine) -> Span | None:
        """The first move that rests on all of these unknowns, or the last of their first ones; the job's of none."""
        spans = [self._of_symbol[symbol] for symbol, _ in terms if symbol in self._of_symbol]
        return max(spans, key=lambda span: span.line, default=self.job)
