"""The Trace as it grows: rows, sections, frames and states."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from gproof.ir.columns import Array, Columns, joined
from gproof.ir.drives import AXES
from gproof.ir.trace import TRACE_ROW, Affine, Edge, Op, State, Trace, TraceSection, Wait

MANY = 2048
"""Tables of few rows each that are kept before they become one."""
Forms = tuple[Affine, Affine, Affine, Affine, Affine, Affine]


class Rows:
    """trace: grows; place, forms: where the axes are."""

    def __init__(self, name: str, forms: Forms) -> None:
        self.trace = Trace(files=[name])
        self.place = [0.0] * AXES
        self.forms = forms
        self._frames = {self.trace.frames[0]: 0}
        self._states: dict[State, int] = {}
        self._single: list[tuple[object, ...]] = []
        self._done: list[Columns] = []
        self._parts: list[Columns] = []
        self._start = (tuple(self.place), self.frame(forms))

    def frame(self, forms: Forms) -> int:
        """The number of a frame."""
        found = self._frames.get(forms)
        if found is None:
            found = self._frames[forms] = len(self.trace.frames)
            self.trace.frames.append(forms)
        return found

    def state(self, state: State) -> int:
        """The number of a state."""
        found = self._states.get(state)
        if found is None:
            found = self._states[state] = len(self.trace.states)
            self.trace.states.append(state)
        return found

    def event(
        self, op: Op, line: int, state: int, arg: Sequence[float] = (0.0, 0.0), *, text: int = 0, feed: float = 0.0,
        center: Sequence[float] = (0.0, 0.0, 0.0), turns: int = 0, plane: int = 0,
    ) -> None:  # fmt: skip
        """One row; of a motion, after ``place`` and ``forms`` are those of its end."""
        self._single.append(
            (int(op), 0, line, 0, tuple(self.place), self.frame(self.forms), state, feed, tuple(center), turns, plane,
             tuple(arg), text)
        )  # fmt: skip

    def table(self, arrays: Mapping[str, Array]) -> None:
        """Many rows at once."""
        self._flush()
        if len(self._parts) >= MANY:
            self._done.append(joined(TRACE_ROW, self._parts))
            self._parts = []
        self._parts.append(Columns(TRACE_ROW, dict(arrays)))

    def last(self) -> dict[str, Array]:
        """The arrays of the last table."""
        return self._parts[-1].arrays

    def _flush(self) -> None:
        if not self._single:
            return
        arrays = TRACE_ROW.empty(len(self._single))
        for column, values in zip(TRACE_ROW.columns, zip(*self._single, strict=True), strict=True):
            arrays[column.name][:] = np.array(values)
        self._parts.append(Columns(TRACE_ROW, arrays))
        self._single = []

    def wait(self, wait: Wait, outcome: str, line: int) -> None:
        """A section ends with a wait that has one outcome, and the next one starts."""
        self._close((Edge(wait=wait, outcome=outcome, target=len(self.trace.sections) + 1, line=line),))

    def starts_here(self) -> None:
        """The section that starts now does so where the axes are by now: a wait has moved them."""
        self._start = (tuple(self.place), self.frame(self.forms))

    def end(self, wait: Wait, outcome: str, line: int) -> None:
        """The last section ends."""
        self._close((Edge(wait=wait, outcome=outcome, target=-1, line=line),))

    def _close(self, edges: tuple[Edge, ...]) -> None:
        self._flush()
        place, frame = self._start
        parts = [*self._done, *self._parts]
        rows = joined(TRACE_ROW, parts) if parts else Columns(TRACE_ROW)
        number = len(self.trace.sections)
        self.trace.sections.append(
            TraceSection(number=number, start=place, start_frame=frame, rows=rows, edges=edges)
        )  # fmt: skip
        self._done, self._parts = [], []
        self.starts_here()
