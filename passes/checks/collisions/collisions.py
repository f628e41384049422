"""Whether a tool comes too near to the part or to fixtures: exact distances along every move.

Takes rows of the Trace, the tool table and the setup's workpiece; decides the properties ``gouges`` (the cutter and the
part) and ``collisions`` (shank and holder and the part, everything and fixtures). docs/gouges.md says what is judged,
docs/verification.md with which bounds; ``distance_kernels`` has the proofs.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from gproof.ir import codes
from gproof.ir.finding import Code, Findings, Severity, Span, fixed
from gproof.ir.machine import Machine
from gproof.ir.program import Program
from gproof.ir.setup import Setup
from gproof.ir.trace import Chunk, Op, State
from gproof.ir.trace_rows import row_span
from gproof.ir.verdict import PropertyResult, Verdict
from gproof.ir.workpiece import Mesh, Placed, Workpiece
from gproof.passes.checks.base import Check, ZeroAt
from gproof.passes.checks.collisions.facets import surface_of
from gproof.passes.checks.collisions.scene import CHORD, Scene, Stretch
from gproof.passes.checks.collisions.sweep_kernels import chords
from gproof.passes.checks.tooling.tip_position import Placing, Reason, Tips
from gproof.passes.checks.tooling.tip_ranges import NOWHERE_KNOWN, homing, hull, may_meet
from gproof.passes.checks.tooling.tool_shape import ANYTHING, CUTTER, HOLDER, PARTS, SHANK, UNSTATED, Shape, shape_of
from gproof.passes.geometry.arc_tolerance import chord_error, small_arcs
from gproof.passes.geometry.off_path import BACKLASH, NO_TOLERANCE, blends_by_nothing, off_path

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

_SEGMENTS = 1 << 15
"""Segments at a time."""
NO_TOOL = "no tool is in the spindle"
HOMING = "the unknown part of a tool, above its known lengths, hits nothing while axes home"
FIRST_WAY = "the path from the start position of the axes hits nothing"
_LARGER = "state in tolerance of [workpiece] of the setup file how far the tool may cut into the part"
PROBES = "probing moves stop where they touch and do no harm"


_PART = "state [[part]] in the setup file, as boxes, polygons, a DXF drawing or a mesh"
_BODIES = "state [stock], [[part]] and [[fixtures]] in the setup file"


class Distance(Check):
    """The properties ``gouges`` and ``collisions`` as far as part and fixtures are concerned."""

    def __init__(
        self, name: str, program: Program, machine: Machine, setup: Setup, findings: Findings, zero: ZeroAt
    ) -> None:
        super().__init__(machine, setup, findings)
        self.name = name
        self.unknown = codes.GOUGE_UNKNOWN if name == "gouges" else codes.COLLISION_UNKNOWN
        self.placing = Placing(machine, setup, zero)
        given = setup.workpiece or Workpiece()
        self.given = given
        part: tuple[int, ...] = (CUTTER,) if name == "gouges" else (SHANK, HOLDER, UNSTATED)
        everything: tuple[int, ...] = (CUTTER, SHANK, HOLDER, UNSTATED)
        self.scenes = [Scene(w, part, -given.tolerance, surface_of(b)) for w, b in _by_zero(given.part)]
        if name == "collisions":
            self.scenes += [Scene(w, everything, given.clearance, surface_of(b)) for w, b in _by_zero(given.fixtures)]
        # Bodies that homing moves may meet, with the part of a tool that counts, by the zeros that they count from.
        self._homed = [(part, bodies) for part, bodies in ((part, _by_zero(given.part)),) if bodies]
        if name == "collisions":
            self._homed += [(everything, those) for those in map(_by_zero, (given.fixtures, given.stock)) if those]
        # What is stated as a range is where the first move may come from; what is not stated at all, an assumption.
        self._free_start = all(ends.exact for ends in setup.start.values())
        self._shapes: dict[int, Shape] = {}
        self._slack = np.zeros(0)
        self._loose = False
        self._behind: list[tuple[int, Floats] | None] = [None] * len(self.scenes)
        self._told: set[tuple[int, int]] = set()
        self._assumed: dict[str, None] = {}
        self._files: list[str] = []
        self._errors = 0
        self._bow = chord_error(machine)
        stated = machine.controller.straight_traverse
        self._straight = bool(program.rules.straight_traverse if stated is None else stated)

    def shape(self, tool: int) -> Shape:
        """What is known of the shape of a tool, by its key."""
        if tool not in self._shapes:
            entry = self.placing.tools.entry(tool)
            if tool < 0:
                made = Shape(problem="the tool in the spindle is unknown")
            elif entry.tool is None:
                number = entry.number
                made = Shape(problem=f"tool {number} is not in the tool table" if number else NO_TOOL)
            else:
                made = Shape(problem=entry.doubt) if entry.doubt else shape_of(entry.tool)
            self._shapes[tool] = made
            if not made.problem:
                self._assumed.update(dict.fromkeys(made.assumed))
        return self._shapes[tool]

    def feed(self, chunk: Chunk) -> None:
        """Look at the moves of a chunk."""
        self._files = chunk.trace.files
        if not len(chunk.rows):
            return
        if self._homed and (chunk.rows["op"] == Op.HOME).any():
            self._homing(chunk)
        if not self.scenes:
            return
        have = len(self._slack)
        new = [self._deviation(state) for state in chunk.trace.states[have:]]
        self._slack = np.concatenate([self._slack, np.array(new, dtype=np.float64)])
        tips: dict[int, Tips] = {}
        for number, scene in enumerate(self.scenes):
            if scene.work not in tips:
                tips[scene.work] = self.placing.tips(chunk, scene.work)
            self._look(chunk, number, scene, tips[scene.work])

    def _deviation(self, state: State) -> float:
        """mm that the tool may be off the programmed path (``passes/geometry/off_path.py``)."""
        if blends_by_nothing(state):
            self._assumed[NO_TOLERANCE] = None
        beside = off_path(self.machine, state)
        self._loose = self._loose or BACKLASH in beside.causes
        return beside.distance

    def _look(self, chunk: Chunk, number: int, scene: Scene, tips: Tips) -> None:
        rows = chunk.rows
        moves = rows["op"] < Op.DWELL
        probes = rows["op"] == Op.PROBE
        if probes.any():
            self._assumed[PROBES] = None
            moves &= ~probes
        self._unplaced(chunk, scene, tips, np.flatnonzero(moves & ~tips.known))
        # Of a path from an unknown place, at least its end is known.
        at = np.flatnonzero(moves & tips.end_known.all(axis=1))
        if not len(at):
            return
        tool = tips.tool[at]
        slack = self._slack[rows["state"][at]]
        cuts = [0, *(np.flatnonzero(tool[1:] != tool[:-1]) + 1).tolist(), len(at)]
        for low, high in itertools.pairwise(cuts):
            self._moves(chunk, number, scene, tips, at[low:high], int(tool[low]), slack[low:high])

    def _moves(
        self, chunk: Chunk, number: int, scene: Scene, tips: Tips, at: Ints, tool: int, slack: Floats
    ) -> None:  # fmt: skip
        """Moves of one tool."""
        rows, shape = chunk.rows, self.shape(tool)
        known, end = tips.known[at], tips.end[at]
        start = np.where(known[:, None], tips.start[at], end)
        source = rows["file"][at].astype(np.int64) << 32 | rows["line"][at].astype(np.int64)
        place = np.stack([source, chunk.begin + at, np.zeros(len(at), dtype=np.int64)], axis=1)
        joined = np.ones(len(at), dtype=np.bool_)
        joined[1:] = (start[1:] == end[:-1]).all(axis=1)
        behind = self._behind[number]
        joined[0] = behind is not None and behind[0] == tool and bool((behind[1] == start[0]).all())
        for k in np.flatnonzero(~joined).tolist():
            self._begins(scene, tool, shape, start[k], int(place[k, 0]))
        self._behind[number] = (tool, end[-1].copy())
        op = rows["op"][at]
        arcs = (op == Op.ARC) & known
        op = np.where(known, op, np.uint8(Op.FEED))
        if not self._straight:
            # Any way to the end, and the end itself, which is certain.
            place[:, 2] = (op == Op.TRAVERSE) & ((start != end).sum(axis=1) > 1)
            twice = np.flatnonzero(place[:, 2])
            again = np.sort(np.concatenate([np.arange(len(at)), twice]))
            ends = np.zeros(len(again), dtype=np.bool_)
            ends[1:] = again[1:] == again[:-1]
            at, op, arcs, start, end, slack, place = (
                column[again] for column in (at, op, arcs, start, end, slack, place)
            )
            start[ends], place[ends, 2] = end[ends], 0
        if not arcs.any():
            scene.sweep(tool, shape, start, end, slack, np.zeros(len(at)), place)
            return
        center, turns, plane = tips.center[at], rows["turns"][at], rows["plane"][at]
        slack = slack + np.where(arcs, self._bow + small_arcs(self.machine, start, center, plane), 0.0)
        room, begin = _SEGMENTS, 0
        places = np.zeros(1, dtype=np.int64)
        while begin < len(at):
            points, sag, of = np.zeros((room, 6)), np.zeros(room), np.zeros(room, dtype=np.int64)
            made = chords.pick(len(at) - begin)(
                op, start, end, center, turns, plane, CHORD, begin, places, points, sag, of
            )
            if places[0] < 0:
                room = int(-places[0])
                continue
            begin = int(places[0])
            of, sag = of[:made], sag[:made]
            scene.sweep(tool, shape, points[:made, :3], points[:made, 3:], slack[of] + sag, sag, place[of])

    def _homing(self, chunk: Chunk) -> None:
        """Homing moves go anywhere along their axes, as in zones (``ZoneCheck._homing``)."""
        rows = chunk.rows
        self._assumed[HOMING] = None
        for row in np.flatnonzero(rows["op"] == Op.HOME).tolist():
            names = chunk.trace.texts[int(rows["text"][row])].split()
            for parts, by_zero in self._homed:
                for work, bodies in by_zero:
                    key = int(self.placing.tips(chunk, work).tool[row])
                    shape = self.shape(key)
                    pieces = (ANYTHING,) if shape.problem else shape.of(*(p for p in parts if p != UNSTATED))
                    lost = int(self.placing.tips(chunk, work).reason[row]) >= Reason.HEIGHT_MAP
                    start = NOWHERE_KNOWN if lost else self.placing.span(chunk, row, work, behind=False)
                    shift = self.placing.machine_shift(chunk, row, work)
                    room = self.given.clearance + self._deviation(chunk.trace.states[int(rows["state"][row])])
                    for body in bodies:
                        if any(
                            may_meet(pieces, (body.body,), spans, room)
                            for spans in homing(self.machine, names, start, shift)
                        ):
                            cause = f"homing moves may hit {body.name}: their path is unknown"
                            self.findings.add(self.unknown.at(row_span(chunk.trace, rows, row), cause=cause))

    def _unplaced(self, chunk: Chunk, scene: Scene, tips: Tips, at: Ints) -> None:
        """Moves at a place that is not known: clear where their height tells so, else a finding."""
        rows = chunk.rows
        summit = scene.surface.high[2] + float(scene.surface.grid[4])
        for k in at.tolist():
            reason = Reason(int(tips.reason[k]))
            tool = int(tips.tool[k])
            if rows["op"][k] == Op.ARC or reason >= Reason.HEIGHT_MAP:
                # What turns, or follows another thing, is not where these numbers are.
                spans = NOWHERE_KNOWN
            else:
                spans = hull(*(self.placing.span(chunk, k, scene.work, behind=end) for end in (False, True)))
            if spans != NOWHERE_KNOWN and not scene.may_meet(
                tool, self.shape(tool), spans, float(self._slack[rows["state"][k]]) + self._bow
            ):
                continue
            if self._free_start and reason is Reason.START and rows["op"][k] == Op.TRAVERSE and not tips.axes[k, 2]:
                self._assumed[FIRST_WAY] = None
                continue
            if tips.axes[k, 2] and int(rows["plane"][k]) < 2:
                lowest = min(float(tips.start[k, 2]), float(tips.end[k, 2])) - self._slack[rows["state"][k]] - self._bow
                if lowest + scene.lowest(tool, self.shape(tool)) > summit:
                    continue
            if (scene.work, int(reason)) in self._told:
                self.findings.counts[self.unknown.number] = self.findings.counts.get(self.unknown.number, 0) + 1
                continue
            self._told.add((scene.work, int(reason)))
            cause = f"where the tool is next to the bodies is unknown: {self.placing.cause(chunk, k, scene.work)}"
            self.findings.add(self.unknown.at(row_span(chunk.trace, rows, k), cause=cause))

    def _begins(self, scene: Scene, tool: int, shape: Shape, tip: Floats, place: int) -> None:
        """A tool that is inside a body before it moves."""
        for body, part, inside in scene.within(tool, shape, tip):
            name = scene.surface.bodies[body].name
            if inside:
                self._errors += 1
                code = codes.GOUGE_INSIDE if self.name == "gouges" else codes.COLLISION_INSIDE
                x, y, z = tip.tolist()
                number = self._number(tool)
                self.findings.add(
                    code.at(self._span(place), tool=number, part=PARTS[part], name=f'"{name}"', x=x, y=y, z=z)
                )
            else:
                whose = f"the {PARTS[part]} of tool {self._number(tool)}"
                what = f"{whose} may start inside {name}: its surface is not closed"
                self.findings.add(self.unknown.at(self._span(place), cause=what))

    def _number(self, tool: int) -> int:
        return self.placing.tools.entry(tool).number

    def _span(self, place: int) -> Span:
        return Span(self._files[place >> 32], max(1, place & 0xFFFFFFFF))

    def finish(self) -> PropertyResult:
        """UNSAFE with something that is certainly too near, UNKNOWN with something that may be, else SAFE."""
        first = Span(self._files[0] if self._files else "", 1)
        if self.name == "gouges" and not self.given.part:
            self.findings.add(self.unknown.at(first, cause="the setup file gives no finished part", hint=_PART))
        elif self.name == "collisions" and not (self.given.part or self.given.fixtures or self.given.stock):
            self.findings.add(
                self.unknown.at(first, cause="the setup file gives no fixtures, part or stock", hint=_BODIES)
            )
        elif self.name == "collisions" and not self.given.fixtures:
            self._assumed["the setup file gives no fixtures: what holds the work is not checked"] = None
        for scene in self.scenes:
            for stretch in scene.stretches():
                self._tell(scene, stretch)
            if scene.left_out:
                self.findings.counts[self.unknown.number] = (
                    self.findings.counts.get(self.unknown.number, 0) + scene.left_out
                )
        verdict = Verdict.SAFE
        if self._errors or self.findings.has(Severity.ERROR, (self.name,)):
            verdict = Verdict.UNSAFE
        elif self.findings.has(Severity.UNKNOWN, (self.name,)):
            verdict = Verdict.UNKNOWN
        assumptions = (*self.placing.assumptions, *self._assumed) if self.scenes else ()
        return PropertyResult(name=self.name, verdict=verdict, assumptions=tuple(assumptions))

    def _tell(self, scene: Scene, stretch: Stretch) -> None:
        """A finding for a stretch of moves, at its first line."""
        placed, span = scene.surface.bodies[stretch.body], self._span(stretch.place)
        name = placed.name
        source = placed.body.source if isinstance(placed.body, Mesh) else ""
        if source and source not in name:
            name = f"{name} ({source})"
        shape, number = self.shape(stretch.tool), self._number(stretch.tool)
        if stretch.part == UNSTATED:
            top = stretch.first[2][2] + min(0.0, float(stretch.first[3][2]))
            known = scene.ladder(stretch.tool, shape).pieces[stretch.first[1]].tip
            cause = shape.problem or (
                f"{PARTS[UNSTATED]} {number} may hit {name}, which ends "
                f"{scene.surface.high[2] - top:.3f} mm above the tip; the shape of the tool is unknown from "
                f"{known:.3f} mm above the tip"
            )
            hint = "; ".join(filter(None, (_where_stated(self.machine, number), _moves(stretch))))
            self.findings.add(self.unknown.at(span, cause=cause, hint=hint))
            return
        distance, tip, _ = scene.nearest(stretch)
        facet, slack = stretch.worst[0], stretch.worst[4]
        x, y, z = tip.tolist()
        values: dict[str, Any] = {
            "tool": number, "part": PARTS[stretch.part], "name": f'"{name}"', "x": x, "y": y, "z": z,
            "allowed": _allowed(scene.limit), "depth" if distance < 0.0 else "distance": abs(distance),
        }  # fmt: skip
        hint = _moves(stretch)
        if stretch.certain:
            self._errors += 1
            self.findings.add(self._code(scene, distance).at(span, hint=hint, **values))
            return
        doubts = [
            f"{text} {fixed(mm, 3)} mm closer"
            for text, mm in (
                (self._who(), slack), ("the drawing may be", float(scene.surface.beside[facet]))
            )
            if mm > 0.0
        ]  # fmt: skip
        if stretch.boxed:
            doubts.append("a rapid move of this controller may not be a straight line")
        doubt = ", and ".join(doubts) or "not proved either way"
        if self._loose and slack > 0.0:
            hint = "; ".join(filter(None, (hint, _LARGER if scene.limit < 0.0 else "")))
        hit, near = (
            (codes.GOUGE_POSSIBLE, codes.GOUGE_POSSIBLE_NEAR)
            if self.name == "gouges"
            else (codes.COLLISION_POSSIBLE, codes.COLLISION_POSSIBLE_NEAR)
        )
        self.findings.add((hit if distance < 0.0 else near).at(span, doubt=doubt, hint=hint, **values))

    def _who(self) -> str:
        """What brings the tool nearer than its path."""
        return f"the controller{' and axis backlash' if self._loose else ''} may bring it"

    def _code(self, scene: Scene, distance: float) -> Code:
        hit, near = codes.COLLISION, codes.COLLISION_NEAR
        if self.name == "gouges":
            hit, near = codes.GOUGE, codes.GOUGE_NEAR
        elif CUTTER not in scene.parts:
            hit, near = codes.HOLDER_IN_PART, codes.HOLDER_NEAR_PART
        return hit if distance < 0.0 else near


def _by_zero(bodies: Sequence[Placed]) -> list[tuple[int, list[Placed]]]:
    """Bodies by the zero that they count from."""
    works = dict.fromkeys(placed.work for placed in bodies)
    return [(work, [placed for placed in bodies if placed.work == work]) for work in works]


def _allowed(limit: float) -> str:
    return f"tolerance {abs(limit):g} mm" if limit <= 0.0 else f"required clearance {limit:g} mm"


def _where_stated(machine: Machine, tool: int) -> str:
    """Where what is missing of a tool is stated."""
    if tool < 0:
        return "state tool = ... in the setup file, or program a tool change before"
    if machine.tool(tool) is None:
        return (
            f"state [tools.{tool}] in the machine file"
            if tool
            else "program a tool change before it, or state tool = ... in the setup file"
        )
    return "state flute_length, shank_diameter, stickout and holder of the tool in the machine file"


def _moves(stretch: Stretch) -> str:
    """What a finding says of the moves of its stretch after the first; "" where there are none."""
    if stretch.moves == 1:
        return ""
    worst = "this one is the worst"
    if stretch.deepest != stretch.place:
        worst = f"the worst is in line {stretch.deepest & 0xFFFFFFFF}"
    more = stretch.moves - 1
    return f"check {more} more move{'s' if more > 1 else ''} after it; {worst}"
