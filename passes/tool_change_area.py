"""The tool change area: a box in machine coordinates that a job's path must not enter while its guard is on.

Eding CNC manual 2.1.8 (area), 4.2 (TCAGuard). Touching a face is outside. Lines are cut against the box
exactly, arcs by halving with exact extents down to ``RESOLUTION``; what is then still open counts as inside.
Where offsets are unknown, one face of the box that all of the path stays beyond gives the condition.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from gproof.ir import codes
from gproof.ir.columns import Columns, occurring
from gproof.ir.finding import Findings, Severity, Span
from gproof.ir.machine import AXIS_NAMES, NO_MACHINE, Machine
from gproof.ir.setup import Setup
from gproof.ir.trace import HEIGHT_MAP, UNKNOWN, Affine, Chunk, Op, Plane
from gproof.ir.verdict import Condition, PropertyResult, Verdict
from gproof.passes.check import Check, form_interval, row_span, split_form
from gproof.passes.extent_kernels import arc_extreme, row_boxes, rows_near
from gproof.passes.height_map import heights_of
from gproof.passes.values import describe

RESOLUTION = 1e-6
"""mm: an arc piece this small that can not be told from the box is inside."""

_IN_PLANE = {Plane.XY: (0, 1), Plane.XZ: (2, 0), Plane.YZ: (1, 2)}
"""The right-handed pair of each plane."""

Point = tuple[float, float, float]
Box = tuple[tuple[float, float], tuple[float, float], tuple[float, float]]


class ToolChangeArea(Check):
    """The property ``areas``."""

    name = "areas"

    def __init__(self, machine: Machine, setup: Setup, findings: Findings) -> None:
        super().__init__(machine, setup, findings)
        self._area = machine.tool_change_area
        self._heights = heights_of(setup.height_map)
        self._box, self._inner = self._boxes()
        self._errors = 0
        self._low: dict[int, np.ndarray] = {}
        self._high: dict[int, np.ndarray] = {}
        self._symbolic: Span | None = None
        self._frames: list[tuple[Affine, ...]] = []
        self._given: dict[Affine, tuple[float, float]] = {}

    def _boxes(self) -> tuple[Box, Box]:
        """The area for programmed positions: outside the first nothing enters it, inside the second all does.

        With Y mapped onto A the machine's Y stays where the axis of rotation is (Eding manual 2.2.5.4); a height map
        lifts and lowers Z (2.2.5.5).
        """
        everywhere = (-math.inf, math.inf)
        if self._area is None:
            return (everywhere,) * 3, (everywhere,) * 3
        x, y, z = self._area.box
        outer, inner = z, z
        if self._heights is not None:
            low, high = self._heights.least(), self._heights.most()
            outer, inner = (z[0] - high, z[1] - low), (z[0] - low, z[1] - high)
        cylinder = self.setup.cylinder
        if cylinder is not None:
            if cylinder.y is not None and not y[0] < cylinder.y < y[1]:
                self._area = None
            y = everywhere
        return (x, y, outer), (x, y, inner)

    def given(self, conditions: tuple[Condition, ...]) -> None:
        """Conditions that hold anyway (those of the limits), so that the answer does not contradict them."""
        self._given = {c.terms: (c.low, c.high) for c in conditions}

    def feed(self, chunk: Chunk) -> None:
        """GP310 for each line of the job that enters the area, GP312 with the guard off."""
        if self._area is None or not len(chunk.rows):
            return
        known: npt.NDArray[np.bool_] = np.asarray(self.known(chunk.trace)[:, :3].all(axis=1))
        self._frames += [frame[:3] for frame in chunk.trace.frames[len(self._frames) :]]
        self._trace = chunk.trace
        if known.all():
            self._near(chunk, self._box)
        else:
            self._collect(chunk, known)

    def _near(self, chunk: Chunk, box: Box) -> None:
        rows = chunk.rows
        found = np.zeros(len(rows), dtype=np.int64)
        count = rows_near.pick(chunk.work)(
            rows["op"], rows["to"], rows["center"], rows["turns"], rows["plane"],
            np.array(chunk.start, dtype=np.float64), np.array([b[0] for b in box]),
            np.array([b[1] for b in box]), found,
        )  # fmt: skip
        for row in found[:count].tolist():
            self._row(chunk, row, box)

    def _row(self, chunk: Chunk, row: int, box: Box) -> None:
        rows = chunk.rows
        state = chunk.trace.states[int(rows["state"][row])]
        assert self.machine.tool_change_area is not None
        plain = self.machine.tool_change_area.box[2]
        lifted = HEIGHT_MAP in state.following
        inside = self._enters(chunk, row, (box[0], box[1], box[2] if lifted else plain))
        if inside is None:
            return
        sure = (self._inner[0], self._inner[1], self._inner[2] if lifted else plain)
        lost = self.setup.cylinder is not None and self.setup.cylinder.y is None
        if lost or (sure != box and self._enters(chunk, row, sure) is None):
            cause = "where the axis of rotation of A is" if lost else "the height map"
            self.findings.add(codes.TOOL_CHANGE_AREA_UNKNOWN.at(row_span(chunk.trace, rows, row), cause=cause))
            return
        span = row_span(chunk.trace, rows, row)
        if "tool_change_area" in chunk.trace.states[int(rows["state"][row])].guards_off:
            self.findings.add(codes.TOOL_CHANGE_AREA_GUARD_OFF.at(span))
            return
        self._errors += 1
        where = " ".join(f"{n.upper()}{v:.3f}" for n, v in zip(AXIS_NAMES, inside, strict=False))
        self.findings.add(codes.TOOL_CHANGE_AREA.at(span, where=where))

    def _enters(self, chunk: Chunk, row: int, box: Box) -> Point | None:
        rows = chunk.rows
        start = chunk.start if row == 0 else tuple(rows["to"][row - 1].tolist())
        return enters(
            (start[0], start[1], start[2]), _point(rows["to"][row]), box,
            int(rows["op"][row]) == Op.ARC, _point(rows["center"][row]), int(rows["turns"][row]),
            int(rows["plane"][row]),
        )  # fmt: skip

    def _collect(self, chunk: Chunk, known: npt.NDArray[np.bool_]) -> None:
        """Rows in known frames exactly; extents by frame for the others."""
        rows, trace = chunk.rows, chunk.trace
        frames = len(trace.frames)
        low, high = np.full((2 * frames, 6), math.inf), np.full((2 * frames, 6), -math.inf)
        index = np.zeros((2 * frames, 6), dtype=np.int64)
        none = np.zeros(0, dtype=np.int64)
        guards = np.array(["tool_change_area" in s.guards_off for s in trace.states], dtype=np.int64)
        row_boxes.pick(chunk.work)(
            rows["op"], rows["to"], rows["center"], rows["turns"], rows["plane"], rows["frame"], guards,
            rows["state"], np.array(chunk.start, dtype=np.float64), np.zeros((frames, 6), dtype=np.uint8),
            np.full((2, 6), -math.inf), np.full((2, 6), math.inf), low, high, index, index.copy(), none,
            none, np.zeros(0), np.zeros((0, 2)),
        )  # fmt: skip
        assert self._area is not None
        before, befores = chunk.start_frames(), chunk.starts()
        op = rows["op"]
        for row in np.flatnonzero(op < 10).tolist():
            here, was = int(rows["frame"][row]), int(before[row])
            if known[here] and known[was]:
                self._row(chunk, row, self._box)
            elif guards[rows["state"][row]] == 0:
                self._widen(was, befores[row, :3], befores[row, :3])
        for frame in occurring(rows["frame"]):
            if not known[frame] and high[2 * frame, 0] >= low[2 * frame, 0]:
                self._widen(frame, low[2 * frame, :3], high[2 * frame, :3])
        # A known frame that meets an unknown one needs its own extent beside the same face, arcs their bulge as well.
        mixed = (op < 10) & (guards[rows["state"]] == 0) & ~known[before] & known[rows["frame"]]
        for row in np.flatnonzero(mixed).tolist():
            self._widen(int(rows["frame"][row]), *_row_box(rows, row, befores[row]))
        if self._symbolic is None and self._low:
            self._symbolic = row_span(trace, rows, 0)

    def _widen(self, frame: int, low: np.ndarray, high: np.ndarray) -> None:
        if frame in self._low:
            self._low[frame] = np.minimum(self._low[frame], low)
            self._high[frame] = np.maximum(self._high[frame], high)
        else:
            self._low[frame], self._high[frame] = low.copy(), high.copy()

    def finish(self) -> PropertyResult:
        """SAFE (with conditions where offsets are unknown), UNSAFE, or UNKNOWN."""
        conditions: tuple[Condition, ...] = ()
        if self._low and not self._errors:
            found = self._best_face()
            if found is None:
                assert self._symbolic is not None
                causes = {form for frame in self._low for form in self._frames[frame] if form != ()}
                self.findings.add(
                    codes.TOOL_CHANGE_AREA_UNKNOWN.at(
                        self._symbolic, cause=", ".join(sorted(describe(form) for form in causes))
                    )
                )
            else:
                conditions = found
        verdict = Verdict.SAFE
        if self._errors:
            verdict = Verdict.UNSAFE
        elif self.findings.has(Severity.UNKNOWN, (self.name,)):
            verdict = Verdict.UNKNOWN
        assumptions: tuple[str, ...] = ()
        if self.machine.name == NO_MACHINE.name:
            assumptions = ("no tool change area is stated",)
        elif self.machine.tool_change_area is None:
            assumptions = ("the machine file names no tool change area",)
        return PropertyResult(name=self.name, verdict=verdict, assumptions=assumptions, conditions=conditions)

    def _best_face(self) -> tuple[Condition, ...] | None:
        """The face of the area that leaves the most room to the unknown offsets, as conditions."""
        best: tuple[float, tuple[Condition, ...]] | None = None
        for axis in range(3):
            for below in (True, False):
                found = self._face(axis, below)
                if found is None:
                    continue
                room = min((c.high - c.low for c in found), default=math.inf)
                if best is None or room > best[0]:
                    best = (room, found)
        return None if best is None else best[1]

    def _face(self, axis: int, below: bool) -> tuple[Condition, ...] | None:
        face = self._box[axis][0 if below else 1]
        limits = self.machine.axis(AXIS_NAMES[axis]) if axis != 1 or self.setup.cylinder is None else None
        bounds: dict[Affine, list[float]] = {}
        for frame, low in self._low.items():
            form, high = self._frames[frame][axis], self._high[frame]
            if form == UNKNOWN:
                return None
            if form == ():
                if (high[axis] > face) if below else (low[axis] < face):
                    return None
                continue
            bound = bounds.setdefault(form, [-math.inf, math.inf])
            if limits is not None and limits.lower is not None:
                bound[0] = max(bound[0], limits.lower - float(low[axis]))
            if limits is not None and limits.upper is not None:
                bound[1] = min(bound[1], limits.upper - float(high[axis]))
            if below:
                bound[1] = min(bound[1], face - float(high[axis]))
            else:
                bound[0] = max(bound[0], face - float(low[axis]))
        out = []
        rooms: dict[Affine, list[float]] = {}
        for form, (low_bound, high_bound) in sorted(bounds.items()):
            stated = form_interval(form, self.setup, self._trace)
            if stated is not None:
                if not (low_bound <= stated.low and stated.high <= high_bound):
                    return None
                continue
            arising, rest = split_form(form)
            span = form_interval(arising, self.setup, self._trace)
            if span is None or not rest:
                return None
            room = rooms.setdefault(rest, list(self._given.get(rest, (-math.inf, math.inf))))
            room[0], room[1] = max(room[0], low_bound - span.low), min(room[1], high_bound - span.high)
        for form, (least, most) in sorted(rooms.items()):
            if least > most:
                return None
            out.append(Condition(terms=form, low=least, high=most))
        return tuple(out)


def _row_box(rows: Columns, row: int, start: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """((3,), (3,)): what one row reaches of X, Y and Z, its start left out."""
    end, center = _point(rows["to"][row]), _point(rows["center"][row])
    low, high = list(end), list(end)
    if int(rows["op"][row]) == Op.ARC:
        u, v = _IN_PLANE[Plane(int(rows["plane"][row]))]
        found = arc_extreme(
            float(start[u]) - center[u], float(start[v]) - center[v], end[u] - center[u], end[v] - center[v],
            int(rows["turns"][row]),
        )  # fmt: skip
        low[u], high[u] = center[u] + found[0], center[u] + found[1]
        low[v], high[v] = center[v] + found[2], center[v] + found[3]
    return np.array(low), np.array(high)


def _point(values: np.ndarray) -> Point:
    x, y, z = values[:3].tolist()
    return x, y, z


def enters(
    start: Point, end: Point, box: Box, arc: bool, center: Point = (0, 0, 0), turns: int = 0, plane: int = 0
) -> Point | None:
    """A point of the path that lies inside the open box, or None when there is none."""
    if not arc:
        return _line_enters(start, end, box)
    u, v = _IN_PLANE[Plane(plane)]
    w = 3 - u - v
    r0 = math.hypot(start[u] - center[u], start[v] - center[v])
    r1 = math.hypot(end[u] - center[u], end[v] - center[v])
    a0 = math.atan2(start[v] - center[v], start[u] - center[u])
    sweep = arc_extreme(start[u] - center[u], start[v] - center[v], end[u] - center[u], end[v] - center[v], turns)[4]
    sweep = math.copysign(sweep, turns)

    def at(t: float) -> Point:
        angle, radius = a0 + sweep * t, r0 + (r1 - r0) * t
        out = [0.0, 0.0, 0.0]
        out[u], out[v] = center[u] + radius * math.cos(angle), center[v] + radius * math.sin(angle)
        out[w] = start[w] + (end[w] - start[w]) * t
        return out[0], out[1], out[2]

    pieces = max(4, math.ceil(abs(sweep) / (math.pi / 4)))
    stack = [(k / pieces, (k + 1) / pieces) for k in range(pieces)]
    biggest = max(r0, r1)
    while stack:
        t0, t1 = stack.pop()
        p, q, middle = at(t0), at(t1), at((t0 + t1) / 2)
        if all(low < x < high for x, (low, high) in zip(middle, box, strict=True)):
            return middle
        # A piece lies within the bulge of its chord's box: the sagitta, and what the radius changes on the way.
        bulge = biggest * (1 - math.cos(min(math.pi, abs(sweep) * (t1 - t0) / 2))) + abs(r1 - r0) * (t1 - t0)
        meets = True
        for k in range(3):
            widen = 0.0 if k == w else bulge
            if max(p[k], q[k]) + widen <= box[k][0] or min(p[k], q[k]) - widen >= box[k][1]:
                meets = False
        if not meets:
            continue
        half = (t0 + t1) / 2
        if max(abs(x - y) for x, y in zip(p, q, strict=True)) + bulge < RESOLUTION or not t0 < half < t1:
            return middle
        stack += [(t0, half), (half, t1)]
    return None


def _line_enters(start: Point, end: Point, box: Box) -> Point | None:
    """Cut the segment by the three slabs; a segment that only touches a face stays outside."""
    t0, t1 = 0.0, 1.0
    for a, b, (low, high) in zip(start, end, box, strict=True):
        d = b - a
        if d == 0:
            if not low < a < high:
                return None
            continue
        enter, leave = sorted(((low - a) / d, (high - a) / d))
        t0, t1 = max(t0, enter), min(t1, leave)
        if t0 >= t1 and start != end:
            return None
    middle = (t0 + t1) / 2
    return tuple(a + (b - a) * middle for a, b in zip(start, end, strict=True))  # type: ignore[return-value]
