"""Rows of the Trace while they are made: a growing buffer handed out in chunks."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from gproof.ir.columns import Array, Columns
from gproof.ir.trace import TRACE_ROW, Chunk, Edge, Op, Trace

FIRST_CAPACITY = 256
CAPACITY = 1 << 15
_FED = (Op.FEED, Op.ARC)


class RowBuffer:
    """Collects rows of the current section; ``ready`` holds chunks that can be handed on.

    Sections may come in any order; ``sections`` is the highest number that was given out.
    expected: about how many rows the whole job has. The first chunk announces them, later ones what is beyond.
    """

    def __init__(self, trace: Trace, start: Sequence[float], start_frame: int, expected: int) -> None:
        self.trace = trace
        self.ready: list[Chunk] = []
        self.section = self.sections = 0
        self.begin = 0
        self.count = 0
        self.expected = expected
        self.announced = 0
        self.flushed = 0
        self.start = tuple(start)
        self.start_frame = start_frame
        self.arrays: dict[str, Array] = TRACE_ROW.empty(FIRST_CAPACITY)
        self.capacity = FIRST_CAPACITY

    def append(
        self, op: Op, *, file: int, line: int, call: int, to: Sequence[float], frame: int, state: int,
        feed: float = 0.0, center: Sequence[float] = (0.0, 0.0, 0.0), turns: int = 0, plane: int = 0,
        arg: tuple[float, float] = (0.0, 0.0), text: int = 0,
    ) -> None:  # fmt: skip
        """Add one row; see TRACE_ROW for the columns."""
        if self.count == self.capacity:
            self.flush()
        a, i = self.arrays, self.count
        a["op"][i] = op
        a["file"][i] = file
        a["line"][i] = line
        a["call"][i] = call
        a["to"][i] = to
        a["frame"][i] = frame
        a["state"][i] = state
        a["feed"][i] = feed
        a["center"][i] = center
        a["turns"][i] = turns
        a["plane"][i] = plane
        a["arg"][i] = arg
        a["text"][i] = text
        self.count += 1

    def forget_feeds(self, begin: int) -> None:
        """The feed of moves from row ``begin`` on is not known."""
        made = slice(begin, self.count)
        self.arrays["feed"][made][np.isin(self.arrays["op"][made], _FED)] = math.nan

    def flush(self, *, last: bool = False, edges: tuple[Edge, ...] = ()) -> None:
        """Hand out what is collected and go on in a fresh buffer."""
        if not self.count and not last:
            return
        rows = Columns(TRACE_ROW, {name: array[: self.count] for name, array in self.arrays.items()})
        self.flushed += self.count
        more = max(self.expected, self.flushed) - self.announced
        self.announced += more
        self.ready.append(
            Chunk(
                trace=self.trace, section=self.section, begin=self.begin, start=self.start,
                start_frame=self.start_frame, rows=rows, last=last, edges=edges, expected=more,
            )
        )  # fmt: skip
        if self.count:
            self.start = tuple(rows["to"][-1].tolist())
            self.start_frame = int(rows["frame"][-1])
        self.begin += self.count
        self.count = 0
        self.capacity = CAPACITY if self.begin and not last else FIRST_CAPACITY
        self.arrays = TRACE_ROW.empty(self.capacity)

    def new_section(self) -> int:
        """The number of a section that somebody will start."""
        self.sections += 1
        return self.sections

    def begin_section(self, number: int, start: Sequence[float], start_frame: int) -> None:
        """Go on in a section that starts at ``start``; the one before is closed."""
        self.section = number
        self.begin = 0
        self.start = tuple(start)
        self.start_frame = start_frame
