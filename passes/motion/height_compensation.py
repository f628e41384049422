"""The path that motors follow: the Trace's rows with the height map's height added to Z.

Where the map is flat under a row, the row is raised as it is; elsewhere it becomes straight rows that stay within
0.05 steps of what Z (and on arcs X and Y) does there, docs/stream.md says how. ``plan`` and ``step`` work on these
rows; what they report and what a stream names are rows of the Trace, through ``Followed.origin``. Where Z would have to
jump, at the edge of the measured range or where the map is switched, there is no such path: GP521.
Eding CNC manual 2.2.5.5; docs/kinematics.md has the readings.
"""

from __future__ import annotations

import dataclasses

import numpy as np
import numpy.typing as npt

from gproof.ir import codes
from gproof.ir.columns import Columns, occurring
from gproof.ir.finding import Findings, Refusal, Span
from gproof.ir.machine import Machine
from gproof.ir.plan import Plan
from gproof.ir.record import record
from gproof.ir.setup import HeightMap, Setup
from gproof.ir.stream import StepStream
from gproof.ir.trace import HEIGHT_MAP, TRACE_ROW, Op, Plane, State, Trace, TraceSection
from gproof.ir.trace_rows import row_span
from gproof.passes.motion import height_compensation_kernels as k
from gproof.passes.motion.cylinder import on_surface, with_machines_motors
from gproof.passes.motion.plan_kernels import arc_shapes
from gproof.passes.motion.refusal_hints import ON_ITS_CONTROLLER

assert (Op.ARC, Op.DWELL) == (k.ARC, k.DWELL)

MOST_ROWS = 1 << 25
"""Straight rows of one section, at most: a map so fine is refused."""

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Bytes = npt.NDArray[np.uint8]


@record(frozen=True, slots=True, kw_only=True)
class Followed:
    """trace: what motors follow, never with a height map; machine: with the motors of Y and A exchanged where Y is
    mapped onto A; by section, origin: the row of the job's Trace that each of its rows is part of; joined: 1 where a
    row goes on with the one before it. Without a height map origin and joined are empty, and without either the trace
    and the machine are the job's own."""

    trace: Trace
    machine: Machine
    origin: tuple[Ints, ...] = ()
    joined: tuple[Bytes, ...] = ()

    def on_machine(self, stream: StepStream, machine: Machine) -> StepStream:
        """A stream of this trace with the motors of the job's machine."""
        return stream if self.machine is machine else with_machines_motors(stream, machine)

    def of_job(self, plan: Plan) -> Plan:
        """A plan of this trace with the rows of the job's Trace: those that were cut occur once for each part."""
        if not self.origin:
            return plan
        sections = []
        for section in plan.sections:
            columns = {c.name: section.rows[c.name] for c in section.rows.schema.columns}
            columns["row"] = self.origin[section.number][columns["row"]]
            sections.append(dataclasses.replace(section, rows=Columns(section.rows.schema, columns)))
        return Plan(sections=sections)


def follow(trace: Trace, setup: Setup, machine: Machine, findings: Findings) -> Followed | None:
    """The path of the motors; None after a finding GP520 or GP521."""
    lifts = _lifting(trace.states)
    height_map = setup.height_map
    on_at_start = height_map is not None and height_map.on
    try:
        if setup.cylinder is not None:
            if lifts.any() or on_at_start:
                where = findings.where("setup.height_map", Span(trace.files[0], 1))
                raise Refusal(
                    codes.NOT_STEPPED.at(where, what="a height map is followed on a cylinder", hint=ON_ITS_CONTROLLER)
                )
            where = findings.where("setup.cylinder", Span(trace.files[0], 1))
            trace, machine = on_surface(trace, machine, setup, where)
            return Followed(trace=trace, machine=machine)
        if height_map is None or not (lifts.any() or on_at_start):
            return Followed(trace=trace, machine=machine)
        if not _known(trace):
            return Followed(trace=trace, machine=machine)  # plan and step say what is missing
        return _Lift(trace, height_map, machine).followed()
    except Refusal as refusal:
        findings.add(refusal.finding)
        return None


def _known(trace: Trace) -> bool:
    """True when X, Y and Z are known wherever the job is."""
    used = {section.start_frame for section in trace.sections}
    for section in trace.sections:
        used.update(occurring(section.rows["frame"]))
    return all(trace.frames[frame][:3] == ((), (), ()) for frame in used)


def _lifting(states: list[State]) -> Bytes:
    """By state, 1 where the map is on."""
    return np.array([HEIGHT_MAP in state.following for state in states], dtype=np.uint8)


def _without(state: State) -> State:
    return dataclasses.replace(state, following=tuple(name for name in state.following if name != HEIGHT_MAP))


class _Lift:
    """What all sections share."""

    def __init__(self, trace: Trace, height_map: HeightMap, machine: Machine) -> None:
        self.trace = trace
        self.machine = machine
        self.lifts = _lifting(trace.states)
        absolute = np.array(height_map.heights, dtype=np.float64)
        self.heights: Floats = np.ascontiguousarray(absolute - absolute[0, 0])
        size = height_map.size
        steep_x, steep_y = np.diff(self.heights, axis=1), np.diff(self.heights, axis=0)
        self.grid: Floats = np.array([
            height_map.x, height_map.y, size, np.abs(steep_x).max() / size, np.abs(steep_y).max() / size,
            np.abs(np.diff(steep_x, axis=0)).max() / size / size,
        ])  # fmt: skip
        self.scale: Floats = np.zeros(3)
        for axis in machine.axes:
            if axis.index < 3:
                rates = [abs(float(d.steps_per_unit)) for d in axis.drives() if d.steps_per_unit is not None]
                self.scale[axis.index] = max(rates, default=0.0)
        self.start_on = self._start_on(height_map.on)

    def _start_on(self, first: bool) -> list[bool]:
        """By section, whether the map is on at its start: as a section before it left it."""
        before: list[bool | None] = [None] * len(self.trace.sections)
        before[:1] = [first]
        for section in self._in_order():
            on = bool(before[section.number])
            if len(section.rows):
                on = bool(self.lifts[section.rows["state"][-1]])
            for edge in section.edges:
                if edge.target >= 0 and before[edge.target] is None:
                    before[edge.target] = on
        return [bool(on) for on in before]

    def _in_order(self) -> list[TraceSection]:
        """Sections in an order in which a section comes after one that leads to it."""
        order, seen = [0] if self.trace.sections else [], {0}
        for number in order:
            for edge in self.trace.sections[number].edges:
                if edge.target >= 0 and edge.target not in seen:
                    seen.add(edge.target)
                    order.append(edge.target)
        return [self.trace.sections[number] for number in order]

    def followed(self) -> Followed:
        """All sections."""
        done = [self._section(section) for section in self.trace.sections]
        states = [_without(state) for state in self.trace.states]
        made = dataclasses.replace(self.trace, states=states, sections=[section for section, _, _ in done])
        return Followed(
            trace=made, machine=self.machine, origin=tuple(o for _, o, _ in done), joined=tuple(j for _, _, j in done)
        )

    def _section(self, section: TraceSection) -> tuple[TraceSection, Ints, Bytes]:
        rows, start = section.rows, np.array(section.start, dtype=np.float64)
        on = np.ascontiguousarray(self.lifts[rows["state"]])
        begin = start.copy()
        if self.start_on[section.number]:
            begin[2] += k.lift_at(float(start[0]), float(start[1]), self.grid, self.heights)
        out_to, origin, chord = self._lines(section, on)
        columns = {c.name: rows[c.name][origin] for c in TRACE_ROW.columns}
        arcs = columns["op"] == Op.ARC
        columns["center"][arcs, 2] += out_to[arcs, 2] - columns["to"][arcs, 2]
        columns["to"] = out_to
        cut = chord == 1
        columns["op"][cut] = Op.FEED
        columns["center"][cut] = 0.0
        columns["turns"][cut] = 0
        columns["plane"][cut] = Plane.NONE
        joined = np.zeros(len(origin), dtype=np.uint8)
        joined[1:] = origin[1:] == origin[:-1]
        made = dataclasses.replace(section, start=tuple(begin.tolist()), rows=Columns(TRACE_ROW, columns))
        return made, origin, joined

    def _lines(self, section: TraceSection, on: Bytes) -> tuple[Floats, Ints, Bytes]:
        """(n, 6) ends, (n,) rows of the section, (n,) 1 for chords of arcs."""
        rows = section.rows
        place = np.zeros((2, 6))
        place[0] = section.start
        kept = np.zeros(k.KEPT_WIDTH, dtype=np.int64)
        kept[k.K_ON] = self.start_on[section.number]
        jump = np.zeros(1)
        size = 2 * len(rows) + 64
        out_to, out_row, out_chord = np.empty((size, 6)), np.empty(size, np.int64), np.empty(size, np.uint8)
        shapes = self._shapes(section)
        lift_rows = k.lift_rows.pick(self._vertices(section, shapes, on))
        while True:
            lift_rows(
                rows["op"], rows["to"], rows["center"], rows["plane"], on, shapes, self.grid, self.heights,
                self.scale, place, kept, jump, out_to, out_row, out_chord,
            )  # fmt: skip
            at, used = int(kept[k.K_ROW]), int(kept[k.K_USED])
            if kept[k.K_JUMPED]:
                where = row_span(self.trace, rows, at)
                hint = "move Z up before the map is switched, or to where the map is 0"
                raise Refusal(codes.HEIGHT_JUMP.at(where, jump=abs(float(jump[0])), hint=hint))
            if not kept[k.K_FULL]:
                return out_to[:used], out_row[:used], out_chord[:used]
            kept[k.K_FULL] = 0
            size = 2 * len(out_row)
            if size > MOST_ROWS:
                what = "Z follows a height map that is too fine here"
                where, hint = row_span(self.trace, rows, at), "use a map with a larger mesh"
                raise Refusal(codes.NOT_STEPPED.at(where, what=what, hint=hint))
            out_to, out_row, out_chord = (
                np.concatenate([column[:used], np.empty((size - used, *column.shape[1:]), column.dtype)])
                for column in (out_to, out_row, out_chord)
            )

    def _vertices(self, section: TraceSection, shapes: Floats, on: Bytes) -> float:
        """About how many vertices there will be, for the choice of kernels."""
        rows = section.rows
        at = on[rows["op"] == Op.ARC] == 1
        rough = 2.0 * np.sqrt(shapes[at, k.RADIUS] * self.scale.max() / (8.0 * k.ROUND))
        ways = np.abs(np.diff(rows["to"][:, :2], axis=0)).sum() / float(self.grid[k.G_SIZE])
        return len(rows) + float(ways) + float((np.abs(shapes[at, k.SWEEP]) * rough).sum())

    def _shapes(self, section: TraceSection) -> Floats:
        """(arcs, 4): start angle, sweep, start radius, end radius."""
        rows = section.rows
        at = np.flatnonzero(rows["op"] == Op.ARC)
        shapes = np.zeros((len(at), 4))
        if len(at):
            before = np.vstack([np.array(section.start).reshape(1, -1), rows["to"]])
            arc_shapes.pick(len(at))(
                np.ascontiguousarray(before[at]), np.ascontiguousarray(rows["to"][at]), rows["center"][at],
                rows["turns"][at], rows["plane"][at], shapes,
            )  # fmt: skip
        return shapes
