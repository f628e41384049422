"""The path of a job as points for a picture, gathered while the job streams by.

Arcs become short chords here: for the eye only, no check reads them. Positions that are in different frames
(sums of unknown offsets) cannot be drawn in one picture; each point says which frame it is in.
"""

from __future__ import annotations

import math

import numpy as np

from gproof.ir.columns import occurring
from gproof.ir.machine import Machine
from gproof.ir.record import record
from gproof.ir.trace import Affine, Chunk, Op, Plane, State, TipOffset, Trace
from gproof.passes.checks.tooling.spindle_tool import entry_of

MOST = 60_000
"""Points that a picture shows; a longer path is thinned."""
_MOST_PLUNGES = 2_000
_ARC_STEP = math.radians(5)
_PAIRS = {Plane.XY: (0, 1), Plane.XZ: (2, 0), Plane.YZ: (1, 2)}

Forms = tuple[Affine, ...]


@record(frozen=True, slots=True, kw_only=True)
class Points:
    """Columns of equal length; the move to point i starts at point i - 1.

    at: (n, 3) mm; feed: cutting or rapid; line, file: where the move is (line 0: the start);
    diameter: of the tool in mm (0: not known); frame: index into ``forms``.
    """

    at: np.ndarray
    feed: np.ndarray
    line: np.ndarray
    file: np.ndarray
    diameter: np.ndarray
    frame: np.ndarray

    def only(self, keep: np.ndarray) -> Points:
        """Some of the points."""
        return Points(**{name: getattr(self, name)[keep] for name in _NAMES})

    def __len__(self) -> int:
        return len(self.at)


_NAMES = ("at", "feed", "line", "file", "diameter", "frame")


class PathPoints:
    """Gathers points; memory is bounded by thinning. tools: numbers of those that cut, tips: of the states."""

    def __init__(self, machine: Machine) -> None:
        self.machine = machine
        self.trace: Trace | None = None
        self.forms: dict[Forms, int] = {}
        self.plunges: dict[tuple[float, float, int], float] = {}
        self.tools: set[int] = set()
        self.tips: dict[tuple[TipOffset, ...], None] = {}
        self._parts: list[Points] = []
        self._count = 0

    def add(self, chunk: Chunk) -> None:
        """Remember the chunk's motion."""
        rows = chunk.rows
        moving = np.flatnonzero(rows["op"] < Op.DWELL)
        if not len(moving):
            return
        trace = self.trace = chunk.trace
        frames = np.array([self.forms.setdefault(f[:3], len(self.forms)) for f in trace.frames], dtype=np.int32)
        wide = np.array([_width(self.machine, state) for state in trace.states], dtype=np.float32)
        if not self._parts:
            self._append(np.array([chunk.start[:3]]), np.zeros(1, dtype=bool), np.zeros(1, dtype=np.int64),
                         rows["file"][:1], np.zeros(1), frames[[chunk.start_frame]])  # fmt: skip
        op, feed = rows["op"][moving], rows["op"][moving] != Op.TRAVERSE
        starts, ends = chunk.starts()[moving, :3], rows["to"][moving, :3]
        frame, before = frames[rows["frame"][moving]], frames[chunk.start_frames()[moving]]
        states = rows["state"][moving]
        cutting = [trace.states[i] for i in occurring(states[feed])]
        self.tools.update(state.tool for state in cutting)
        self.tips.update(dict.fromkeys(state.tip for state in cutting))
        diameter = wide[states]
        self._plunges(starts, ends, feed & (frame == before), diameter, frame)
        repeat = np.ones(len(moving), dtype=np.int64)
        points = ends
        if (op == Op.ARC).any():
            pieces = []
            for i, row in enumerate(moving.tolist()):
                if op[i] == Op.ARC:
                    pieces.append(_arc(starts[i], ends[i], rows["center"][row], int(rows["turns"][row]),
                                       Plane(int(rows["plane"][row]))))  # fmt: skip
                    repeat[i] = len(pieces[-1])
                else:
                    pieces.append(ends[i : i + 1])
            points = np.concatenate(pieces)
        self._append(points, *(np.repeat(c, repeat) for c in
                               (feed, rows["line"][moving], rows["file"][moving], diameter, frame)))  # fmt: skip

    def _append(self, *columns: np.ndarray) -> None:
        at, feed, line, file, diameter, frame = columns
        part = Points(at=at.astype(np.float32), feed=feed, line=line.astype(np.int32), file=file.astype(np.int32),
                      diameter=diameter.astype(np.float32), frame=frame.astype(np.int32))  # fmt: skip
        self._parts.append(part)
        self._count += len(part)
        if self._count > 4 * MOST:
            whole = self._whole()
            self._parts = [whole.only(np.arange(0, len(whole), 2))]
            self._count = len(self._parts[0])

    def _plunges(
        self, starts: np.ndarray, ends: np.ndarray, feed: np.ndarray, diameter: np.ndarray, frame: np.ndarray
    ) -> None:
        straight = feed & (starts[:, :2] == ends[:, :2]).all(axis=1) & (ends[:, 2] < starts[:, 2])
        for i in np.flatnonzero(straight).tolist():
            if len(self.plunges) < _MOST_PLUNGES:
                key = (float(ends[i, 0]), float(ends[i, 1]), int(frame[i]))
                self.plunges[key] = max(float(diameter[i]), self.plunges.get(key, 0.0))

    def _whole(self) -> Points:
        return Points(**{name: np.concatenate([getattr(p, name) for p in self._parts]) for name in _NAMES})

    def points(self) -> Points:
        """At most about ``MOST`` points of the whole path."""
        if not self._parts:
            nothing = np.zeros(0, dtype=np.int32)
            return Points(at=np.zeros((0, 3), dtype=np.float32), feed=nothing.astype(bool), line=nothing,
                          file=nothing, diameter=nothing.astype(np.float32), frame=nothing)  # fmt: skip
        whole = self._whole()
        stride = -(-len(whole) // MOST)
        return whole if stride == 1 else whole.only(np.unique([*range(0, len(whole), stride), len(whole) - 1]))


def _width(machine: Machine, state: State) -> float:
    """mm: the diameter that the checks take for the tool of a state, at most; 0 where it is unknown."""
    ends = entry_of(machine, state.tool, state.diameters).ends
    return ends[1] if ends is not None and math.isfinite(ends[1]) else 0.0


def _arc(start: np.ndarray, end: np.ndarray, center: np.ndarray, turns: int, plane: Plane) -> np.ndarray:
    """Points along an arc, its end included, its start not."""
    u, v = _PAIRS[plane]
    a0 = math.atan2(start[v] - center[v], start[u] - center[u])
    a1 = math.atan2(end[v] - center[v], end[u] - center[u])
    sign = 1 if turns > 0 else -1
    sweep = ((a1 - a0) * sign) % (2 * math.pi)
    if sweep < 1e-9:
        sweep = 2 * math.pi
    sweep += (abs(turns) - 1) * 2 * math.pi
    count = max(2, math.ceil(sweep / _ARC_STEP))
    t = np.linspace(0, 1, count + 1)[1:]
    angle = a0 + sign * sweep * t
    radius = math.hypot(start[u] - center[u], start[v] - center[v])
    out = start + np.outer(t, end - start)
    out[:-1, u] = center[u] + radius * np.cos(angle[:-1])
    out[:-1, v] = center[v] + radius * np.sin(angle[:-1])
    return out
