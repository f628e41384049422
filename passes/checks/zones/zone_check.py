"""One zone that a job's path must keep out of: the tool change area with its guard, or a stated keep-out zone.

Eding CNC manual 2.1.8 (area), 4.2 (TCAGuard). Touching a face is outside; lines and arcs are exact (``zone_shapes``).
Where offsets are unknown, one face of the zone's box that all of the path stays beyond gives the condition.
What is judged: in the tool change area the controller's machine position, as the controller does it. In a keep-out zone
the tool: as thick as the tool table says, a point where it does not; in machine coordinates from its tip, below the
machine position by a positive length offset, up to there; relative to a work offset from its tip as high as the table
says. Shanks and holders that are wider have a check each (``zone_tool``).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from gproof.ir import codes
from gproof.ir.columns import Columns, occurring
from gproof.ir.finding import Findings, Severity, Span
from gproof.ir.machine import AXIS_NAMES, Area, Machine
from gproof.ir.setup import ZERO, Setup
from gproof.ir.symbolic import Position, add_forms
from gproof.ir.trace import HEIGHT_MAP, UNKNOWN, Affine, Chunk, Op, Plane, State, Trace
from gproof.ir.trace_rows import form_interval, row_span
from gproof.ir.verdict import Condition
from gproof.passes.checks.tooling.spindle_tool import entries
from gproof.passes.checks.tooling.tip_position import rotary_axes, turned
from gproof.passes.checks.tooling.tip_ranges import homing
from gproof.passes.checks.zones.face_conditions import EVERYWHERE, OpenPlaces, Ranges, View
from gproof.passes.checks.zones.shapes import (
    IN_PLANE,
    Arc,
    Entry,
    Point,
    Polygon,
    Rectangle,
    Zone,
    arc_enters,
    box_enters,
    segment_enters,
    shape_of,
)
from gproof.passes.checks.zones.tool_profile import CUTTER, TIP, Pair, Part, Told, part_of
from gproof.passes.geometry.arc_tolerance import chord_error, small_arcs
from gproof.passes.geometry.extent_kernels import (
    Extents,
    arc_extreme,
    boxed_rows,
    room_beyond,
    row_boxes,
    rows_near,
)
from gproof.passes.geometry.height_map import Heights
from gproof.passes.geometry.off_path import OffPath, off_path

GUARD = "tool_change_area"
MOST = 10_000
"""Of lines that enter one zone: the rest of the job is not looked at for it."""
TURNED = "a rotary axis, which is not where it was at the start of the job"
_MANY = 256
"""Rows near a polygon from which on shapely sorts out those that are far from it."""
_FEW_PLACES = 64
"""Among so many extents the move that leaves no face is looked for; of a job with more its first open move counts."""


Hears = Callable[[str, View, Chunk, npt.NDArray[np.bool_], bool | None], None]
"""Takes rows whose places rest on something unknown: name of the zone, how they are judged, the chunk, which of its
rows, whether traverses of several axes are straight lines."""


class ZoneCheck:
    """Findings of one zone; ``conditions`` after the last chunk. errors: rows that enter it; hears: see ``Areas``.

    part: of the tool, by its number (``zone_tool``); ``told``: of the checks of all parts, None where there is one.
    """

    def __init__(
        self, area: Area, machine: Machine, setup: Setup, findings: Findings, *, heights: Heights | None,
        straight: bool | None, origin: tuple[Position, Position, Position] | None = None,
        change: bool = False, hears: Hears | None = None, part: int = CUTTER, told: Told | None = None,
    ) -> None:  # fmt: skip
        self.area, self.machine, self.setup, self.findings = area, machine, setup, findings
        self.errors = 0
        self.is_open = False
        """It is not decided, for a reason that is reported elsewhere."""
        self._heights, self._straight, self._origin, self._change = heights, straight, origin, change
        self._hears, self._number, self._told = hears, part, told
        self._views: list[View] = []
        self._of_key: dict[object, int] = {}
        self._of_state: list[int] = []
        self._symbolic: Span | None = None
        # The first of them that leaves no face beyond which all may stay.
        self._blocked: Span | None = None
        self._open = OpenPlaces(machine, setup, self._views)
        # A zone of the work turns with it; one of the machine stays.
        self._turning = [] if change or origin is None else rotary_axes(machine)
        self._begin: tuple[tuple[float, ...], tuple[Affine, ...]] | None = None
        self._turned_told = False
        # In the tool change area the controller looks at its own positions.
        self._bow = 0.0 if change else chord_error(machine)
        # Chords, and lines in place of arcs, lie within ends and bulge of the arc: what it goes around is nearer then.
        self._near = 0.0 if change else self._bow + 2.0 * (machine.settings.smallest_arc or 0.0)

    # -- views

    def _view_of(self, state: State) -> int:
        following = HEIGHT_MAP in state.following and self._heights is not None
        part = self._part(state)
        if part is None:
            return -1
        tip = state.tip_beside(self.area.work)
        if self._change:
            key: object = GUARD in state.guards_off, following
        else:
            key = following, tip, part, self._other_head(state), off_path(self.machine, state)
        if key not in self._of_key:
            if self._beside_cylinder(part):
                return -1
            self._of_key[key] = len(self._views)
            self._views.append(self._make(state, following, part))
        return self._of_key[key]

    def _part(self, state: State) -> Part | None:
        """What of the tool in the spindle is judged; None: nothing of it."""
        if self._change:
            return Part("", TIP, TIP, TIP)
        # The setup "zero" says tool 0 of any machine: what is in its spindle is unknown.
        known = state.tool > 0 or (state.tool == 0 and self.setup.name != ZERO.name)
        those = entries(self.machine, state if known else replace(state, tool=-1))
        return part_of(those, self._number, known=known)

    def _make(self, state: State, following: bool, part: Part) -> View:
        x, y, _ = self.area.box
        causes: list[str] = []
        zero = Position(0.0)
        tips = {} if self._change else {one.axis: one for one in state.tip_beside(self.area.work)}
        offsets = [Position(tips[axis].mm, tips[axis].form) if axis in tips else zero for axis in range(3)]
        origin = self._origin or (zero, zero, zero)
        base = tuple(o.plus(t) for o, t in zip(origin, offsets, strict=True))
        tip: Position | None = None
        # How far the tool surely goes up beyond what is stated of it: in machine coordinates to the controlled point.
        up = 0.0
        if self._origin is None and offsets[2].form:
            base, tip = (*base[:2], zero), offsets[2]
        elif self._origin is None:
            up = max(0.0, offsets[2].value)
        wide = self._heights_of(part.heights, up)
        narrow = None if part.sure is None else self._heights_of(part.sure, up)
        if following:
            assert self._heights is not None
            least, most = self._heights.least(), self._heights.most()
            wide = wide[0] - most, wide[1] - least
            narrow = None if narrow is None else (narrow[0] - least, narrow[1] - most)
            causes.append("the height map")
        beside = OffPath() if self._change else off_path(self.machine, state)
        around, above = beside.around, beside.above
        if part.doubt:
            causes.append(part.doubt)
        causes += beside.causes
        shape = outer_shape = shape_of(self.area)
        grow = part.width[1] / 2 + around
        if math.isinf(grow):
            outer_shape, x, y, grow = Rectangle(EVERYWHERE, EVERYWHERE), EVERYWHERE, EVERYWHERE, 0.0
        cylinder = self.setup.cylinder
        if cylinder is not None:
            # With Y mapped onto A the machine's Y stays where the axis of rotation is (Eding manual 2.2.5.4).
            at = cylinder.y
            sides = self.area.box[1]
            if at is None or not sides[0] < at < sides[1] or self.area.rings or self._origin is not None:
                narrow = None
                causes.append("the position of the axis of rotation of A")
            shape, outer_shape, y = Rectangle(self.area.box[0], EVERYWHERE), Rectangle(x, EVERYWHERE), EVERYWHERE
        outer = Zone(shape=outer_shape, z=wide, grow=grow, rise=above)
        inner = None if narrow is None else Zone(shape=shape, z=narrow, grow=part.width[0] / 2)
        shift = base[0].value, base[1].value, base[2].value
        box = tuple(
            (low - by + at, high + by + at)
            for (low, high), by, at in zip((x, y, wide), (grow, grow, above), shift, strict=True)
        )
        return View(
            shift=shift, form=(base[0].form, base[1].form, base[2].form), outer=outer, inner=inner,
            lost=not self._change and self._other_head(state), cause=" and ".join(causes),
            box=(box[0], box[1], box[2]), tip=tip, off=self._change and GUARD in state.guards_off,
            part="" if self._number == CUTTER else f"check its {part.name}, {part.width[1]:g} mm wide",
        )  # fmt: skip

    def _heights_of(self, heights: Pair, up: float) -> Pair:
        """Where the tip must be so that what has these heights above it is as high as the zone."""
        low, high = self.area.box[2]
        return low - max(heights[1], up if self._number == CUTTER else 0.0), high - heights[0]

    def _other_head(self, state: State) -> bool:
        """Whether what moves is not the head of X, Y and Z; a preconfigured workspace may choose another one."""
        spaces = self.machine.settings.workspaces
        return state.head != 0 or (state.work > 1 and any(space.number == state.work + 53 for space in spaces))

    def _beside_cylinder(self, part: Part) -> bool:
        """With Y mapped onto A: whether the machine's Y, which then stays, is clear of the zone."""
        at = None if self.setup.cylinder is None else self.setup.cylinder.y
        if at is None or self._origin is not None:
            return False
        low, high = self.area.box[1]
        return not low - part.width[1] / 2 < at < high + part.width[1] / 2

    # -- rows

    def feed(self, chunk: Chunk) -> None:
        """Findings for lines of the chunk that enter the zone; extents of those whose place is not known."""
        if not len(chunk.rows) or self.errors > MOST:
            return
        self._open.trace = chunk.trace
        self._of_state += [self._view_of(state) for state in chunk.trace.states[len(self._of_state) :]]
        of_state = np.array(self._of_state)
        here = of_state[chunk.rows["state"]]
        if self._turning:
            here = self._without_turned(chunk, here)
        for view in occurring(here[here >= 0]):
            self._judge(chunk, view, here == view)
        if not self._change:
            self._homing(chunk)

    def _without_turned(self, chunk: Chunk, here: npt.NDArray[np.int64]) -> npt.NDArray[np.int64]:
        """Views of rows, -1 where what the zone counts from is turned away: where the zone is then is not known."""
        if self._begin is None:
            self._begin = tuple(chunk.start), tuple(chunk.trace.frames[chunk.start_frame])
        away = np.zeros(len(here), dtype=bool)
        for axis in self._turning:
            away |= turned(chunk, axis, self._begin[0][axis], self._begin[1][axis])
        lost = np.flatnonzero(away & (chunk.rows["op"] < Op.DWELL) & (here >= 0))
        if len(lost) and not self._turned_told:
            self._turned_told = True
            row = int(lost[0])
            self._doubt(row_span(chunk.trace, chunk.rows, row), TURNED, self._views[int(here[row])])
        return np.where(away, -1, here)

    def _judge(self, chunk: Chunk, number: int, mine: npt.NDArray[np.bool_]) -> None:
        view, rows, trace = self._views[number], chunk.rows, chunk.trace
        mine = mine & (rows["op"] < 10)
        if not mine.any():
            return
        if view.lost:
            span = row_span(trace, rows, int(np.argmax(mine)))
            self._doubt(span, "the position of another head than the first one", view)
            return
        sure = view.tip is None and UNKNOWN not in view.form
        known = np.array([sure and frame[:3] == view.form for frame in trace.frames], dtype=bool)
        both = known[rows["frame"]] & known[chunk.start_frames()]
        found = np.zeros(len(rows), dtype=np.int64)
        count = rows_near.pick(chunk.work)(
            rows["op"], rows["to"], rows["center"], rows["turns"], rows["plane"],
            np.array(chunk.start, dtype=np.float64), np.array([b[0] - self._near for b in view.box]),
            np.array([b[1] + self._near for b in view.box]), found,
        )  # fmt: skip
        near = found[:count]
        near = near[(mine & both)[near]]
        for row in self._sorted_out(chunk, view, near).tolist():
            self._row(chunk, row, view)
        open_ = mine & ~both
        if view.off or not open_.any():
            return
        if self._hears is not None:
            name = "the tool change area" if self._change else f"the zone {self.area.name}"
            self._hears(name, view, chunk, open_, self._straight)
            return
        open_ &= ~self._clear(chunk, view, open_)
        if open_.any():
            self._collect(chunk, number, known, open_)

    def _sorted_out(self, chunk: Chunk, view: View, near: npt.NDArray[np.int64]) -> npt.NDArray[np.int64]:
        """Rows without the straight ones that are far from a polygon, where there are many."""
        if len(near) < _MANY or not isinstance(view.outer.shape, Polygon):
            return near
        rows = chunk.rows
        straight = rows["op"][near] != Op.ARC
        if self._straight is not True:
            straight &= rows["op"][near] != Op.TRAVERSE
        # One that stands still in X and Y is a point, which shapely takes for no line at all.
        straight &= (chunk.starts()[near, :2] != rows["to"][near, :2]).any(axis=1)
        lines = near[straight]
        ends = np.stack([chunk.starts()[lines, :2], rows["to"][lines, :2]], axis=1) - np.array(view.shift[:2])
        kept = straight.copy()
        kept[straight] = view.outer.shape.near(ends, view.outer.grow)
        found: npt.NDArray[np.int64] = near[kept | ~straight]
        return found

    def _row(self, chunk: Chunk, row: int, view: View) -> None:
        if self.errors > MOST:
            return
        rows = chunk.rows
        p = _point(chunk.start if row == 0 else rows["to"][row - 1], view.shift)
        q = _point(rows["to"][row], view.shift)
        op = int(rows["op"][row])
        free = op == Op.TRAVERSE and self._straight is not True and sum(a != b for a, b in zip(p, q, strict=True)) > 1
        outer = view.outer
        bow = self._bow_of(rows, row, p, view.shift) if op == Op.ARC else 0.0
        entry = self._entry(rows, row, outer.wider(bow, bow) if bow else outer, view.shift, p, q)
        span = row_span(chunk.trace, rows, row)
        if bow and entry is not None and self._entry(rows, row, outer, view.shift, p, q) is None:
            self._doubt(span, "the chords that the controller cuts instead of this arc", view)
            return
        if entry is None:
            if free and box_enters(view.outer, *[(min(a, b), max(a, b)) for a, b in zip(p, q, strict=True)]):
                self._doubt(span, "the path of this rapid move, which may not be a straight line", view)
            return
        if view.inner is None:
            self._doubt(span, view.cause, view)
            return
        sure = entry if view.inner == view.outer else self._entry(rows, row, view.inner, view.shift, p, q)
        if sure is None:
            self._doubt(span, view.cause, view)
            return
        if free and not (view.inner.depths(np.array([p, q])) > 0.0).any():
            self._doubt(span, "the path of this rapid move, which may not be a straight line", view)
            return
        self._entered(span, sure, view)

    def _bow_of(self, rows: Columns, row: int, p: Point, shift: Point) -> float:
        """mm that the controller's own path along an arc may be off it."""
        if self._change:
            return 0.0
        center = np.array([_point(rows["center"][row], shift)])
        return self._bow + float(small_arcs(self.machine, np.array([p]), center, rows["plane"][row : row + 1])[0])

    def _entry(self, rows: Columns, row: int, zone: Zone, shift: Point, p: Point, q: Point) -> Entry | None:
        if int(rows["op"][row]) != Op.ARC:
            return segment_enters(zone, p, q)
        center = _point(rows["center"][row], shift)
        arc = Arc(start=p, end=q, center=center, turns=int(rows["turns"][row]), plane=int(rows["plane"][row]))
        return arc_enters(zone, arc)

    def _entered(self, span: Span, entry: Entry, view: View) -> None:
        place = zip(AXIS_NAMES, entry.at, view.shift, strict=False)
        where = " ".join(f"{name.upper()}{value + shift + 0.0:.3f}" for name, value, shift in place)
        if view.off:
            self.findings.add(codes.TOOL_CHANGE_AREA_GUARD_OFF.at(span))
            return
        self.errors += 1
        if self._change:
            self.findings.add(codes.TOOL_CHANGE_AREA.at(span, where=where, depth=entry.depth))
        elif self._told is None or not self._told.again(span, certain=True):
            name = self.area.name
            self.findings.add(codes.KEEP_OUT_ZONE.at(span, name=name, where=where, depth=entry.depth, hint=view.part))

    def _is_told(self) -> bool:
        """Whether lost places are reported elsewhere: with a line that is refused, or at the move after it."""
        counts = self.findings.counts
        return codes.POSITION_UNKNOWN.number in counts or self.findings.has(Severity.ERROR)

    def _doubt(self, span: Span, cause: str, view: View) -> None:
        if view.off:
            self.findings.add(codes.TOOL_CHANGE_AREA_GUARD_OFF.at(span))
        elif self._change:
            self.findings.add(codes.TOOL_CHANGE_AREA_UNKNOWN.at(span, cause=cause))
        elif self._told is None or not self._told.again(span, certain=False):
            self.findings.add(codes.KEEP_OUT_UNKNOWN.at(span, name=self.area.name, cause=cause, hint=view.part))

    def _homing(self, chunk: Chunk) -> None:
        """Homing moves go anywhere along their axes, group after group where the machine's file has an order."""
        rows = chunk.rows
        for row in np.flatnonzero(rows["op"] == Op.HOME).tolist():
            number = self._of_state[int(rows["state"][row])]
            if number < 0:
                continue
            view = self._views[number]
            frame = chunk.trace.frames[int(rows["frame"][row])]
            place = _point(rows["to"][row], view.shift)
            ranges = [(v, v) if f == g != UNKNOWN else EVERYWHERE
                      for v, f, g in zip(place, frame, view.form, strict=False)]  # fmt: skip
            if view.tip is not None:
                ranges[2] = EVERYWHERE
            names = chunk.trace.texts[int(rows["text"][row])].split()
            shift = [by if form == () else None for by, form in zip(view.shift, view.form, strict=True)]
            start = ranges[0], ranges[1], ranges[2]
            if any(box_enters(view.outer, *spans) for spans in homing(self.machine, names, start, shift)):
                self._doubt(row_span(chunk.trace, rows, row), "the path of homing moves", view)

    # -- unknown places

    def _clear(self, chunk: Chunk, view: View, open_: npt.NDArray[np.bool_]) -> npt.NDArray[np.bool_]:
        """(n,): rows that stay beyond a face of the zone's box for all values of what they rest on."""
        rows, trace = chunk.rows, chunk.trace
        clear = np.zeros(len(rows), dtype=bool)
        at = np.flatnonzero(open_)
        ends = rows["to"][at, :3], chunk.starts()[at, :3]
        frames = rows["frame"][at], chunk.start_frames()[at]
        low, high = np.full((len(at), 3), math.inf), np.full((len(at), 3), -math.inf)
        for places, numbers in zip(ends, frames, strict=True):
            for frame in occurring(numbers):
                spot = numbers == frame
                for axis, (least, most) in enumerate(self._spread(trace, view, frame)):
                    low[spot, axis] = np.minimum(low[spot, axis], places[spot, axis] + least)
                    high[spot, axis] = np.maximum(high[spot, axis], places[spot, axis] + most)
        # A circle around all of an arc, which is more than it needs.
        arcs = np.flatnonzero(rows["op"][at] == Op.ARC)
        if len(arcs):
            off = np.maximum(*(np.abs(one[arcs] - rows["center"][at[arcs]]) for one in ends))
            radius = np.hypot(np.hypot(off[:, 0], off[:, 1]), off[:, 2])[:, np.newaxis]
            low[arcs], high[arcs] = low[arcs] - 2.0 * radius, high[arcs] + 2.0 * radius
        face_low, face_high = np.array([b[0] for b in view.box]), np.array([b[1] for b in view.box])
        clear[at] = ((high <= face_low) | (low >= face_high)).any(axis=1)
        return clear

    def _spread(self, trace: Trace, view: View, frame: int) -> list[Pair]:
        """By axis, between what positions of a frame are clear of the zone, less their numbers."""
        found: list[Pair] = []
        for axis, (own, base) in enumerate(zip(trace.frames[frame][:3], view.form, strict=True)):
            ends = self._range_of(trace, own, base)
            if axis == 2 and view.tip is not None:
                low, high = self._range_of(trace, own, view.tip.form)
                ends = min(ends[0], low - view.tip.value), max(ends[1], high - view.tip.value)
            found.append(ends)
        return found

    def _range_of(self, trace: Trace, own: Affine, base: Affine) -> Pair:
        if UNKNOWN in (own, base):
            return EVERYWHERE
        known = form_interval(add_forms(own, base, -1), self.setup, trace)
        return EVERYWHERE if known is None else (known.low, known.high)

    def _collect(
        self, chunk: Chunk, number: int, known: npt.NDArray[np.bool_], open_: npt.NDArray[np.bool_]
    ) -> None:  # fmt: skip
        """Extents by frame of the rows that do not lie in known frames from end to end, and the first of them that
        leaves no face of the zone beyond which all may stay."""
        at = np.flatnonzero(open_)
        if self._symbolic is None:
            self._symbolic = row_span(chunk.trace, chunk.rows, int(at[0]))
        searched = self._blocked is None and len(self._open.low) <= _FEW_PLACES
        before = self._open.copy() if searched else self._open
        self._extend(chunk, number, known, open_)
        if not searched or self._open.best_face({}) is not None:
            return
        fits, blocks = 0, len(at)
        while blocks - fits > 1:
            half = (fits + blocks) // 2
            tried, whole = before.copy(), self._open
            self._open = tried
            self._extend(chunk, number, known, np.isin(np.arange(len(open_)), at[:half]))
            self._open = whole
            fits, blocks = (fits, half) if tried.best_face({}) is None else (half, blocks)
        self._blocked = row_span(chunk.trace, chunk.rows, int(at[blocks - 1]))

    def _extend(
        self, chunk: Chunk, number: int, known: npt.NDArray[np.bool_], open_: npt.NDArray[np.bool_]
    ) -> None:  # fmt: skip
        """Widen the extents by these rows."""
        rows, trace = chunk.rows, chunk.trace
        frames = len(trace.frames)
        low, high = np.full((2 * frames, 6), math.inf), np.full((2 * frames, 6), -math.inf)
        index = np.zeros((2 * frames, 6), dtype=np.int64)
        # What is clear, or known, goes to the extents that nobody looks at: the next row starts where it ends.
        aside = np.where(open_, 0, 1).astype(rows["state"].dtype)
        row_boxes.pick(chunk.work)(
            boxed_rows(rows)._replace(state=aside), np.array([0, 1], dtype=np.int64),
            np.array(chunk.start, dtype=np.float64), np.zeros((frames, 6), dtype=np.uint8), np.full((2, 6), -math.inf),
            np.full((2, 6), math.inf), Extents(low, high, index, index.copy()), room_beyond(0), np.zeros((0, 2)),
        )  # fmt: skip
        before, befores = chunk.start_frames(), chunk.starts()
        for frame in occurring(rows["frame"][open_]):
            if not known[frame] and high[2 * frame, 0] >= low[2 * frame, 0]:
                self._open.widen(number, frame, low[2 * frame, :3], high[2 * frame, :3])
        for frame in occurring(before[open_]):
            starts = befores[open_ & (before == frame), :3]
            self._open.widen(number, frame, starts.min(axis=0), starts.max(axis=0))
        # A known frame that meets an unknown one needs its own extent beyond the same face, arcs their bulge as well.
        for row in np.flatnonzero(open_ & known[rows["frame"]]).tolist():
            self._open.widen(number, int(rows["frame"][row]), *row_box(rows, row, befores[row]))

    def conditions(self, given: Ranges) -> tuple[Condition, ...]:
        """What keeps the rest of the path clear of the zone; given: what is required of offsets anyway."""
        if not self._open.low or self.errors:
            return ()
        found = self._open.best_face(given)
        if found is not None:
            return found
        assert self._symbolic is not None
        if self._open.has_lost and self._is_told():
            self.is_open = True
            return ()
        cause, where = ", ".join(self._open.causes()), self._blocked or self._symbolic
        if self._change:
            self.findings.add(codes.TOOL_CHANGE_AREA_UNKNOWN.at(where, cause=cause))
        else:
            self.findings.add(codes.KEEP_OUT_UNKNOWN.at(where, name=self.area.name, cause=cause))
        return ()


def row_box(rows: Columns, row: int, start: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """((3,), (3,)): what one row reaches of X, Y and Z, its start left out."""
    end, center = _point(rows["to"][row]), _point(rows["center"][row])
    low, high = list(end), list(end)
    if int(rows["op"][row]) == Op.ARC:
        u, v = IN_PLANE[Plane(int(rows["plane"][row]))]
        found = arc_extreme(
            float(start[u]) - center[u], float(start[v]) - center[v], end[u] - center[u], end[v] - center[v],
            int(rows["turns"][row]),
        )  # fmt: skip
        low[u], high[u] = center[u] + found[0], center[u] + found[1]
        low[v], high[v] = center[v] + found[2], center[v] + found[3]
    return np.array(low), np.array(high)


def _point(values: object, shift: Point = (0.0, 0.0, 0.0)) -> Point:
    x, y, z = (float(v) for v in values[:3])  # type: ignore[index]
    return x - shift[0], y - shift[1], z - shift[2]
