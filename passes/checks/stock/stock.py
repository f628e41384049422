"""Stock that is still there: traverses, shanks and holders that meet it, and cuts that are too deep.

What is left of each body of stock is known between two height fields (``stock_fields``), which the moves of the trace
lower while the job streams by (``stock_kernels``). A traverse that is surely in stock is an error, one that is proved
to stay above what may be left is none, and in between it is UNKNOWN; so it is with all else that is asked here. Fields
belong to a way through the graph of sections: where ways come together, more may be left than on any of them
(``_Left.join``), and a section that was judged before has to have been judged with at least as much.

Setup.workpiece gives stock, cells and clearance; docs/gouges.md says what is proved.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from gproof.ir import codes
from gproof.ir.columns import Columns
from gproof.ir.finding import Code, Findings, Severity, Span
from gproof.ir.machine import Machine
from gproof.ir.program import Program
from gproof.ir.setup import Setup
from gproof.ir.trace import Chunk, Op
from gproof.ir.trace_rows import row_span
from gproof.ir.verdict import PropertyResult, Verdict
from gproof.ir.workpiece import Mesh, Placed
from gproof.passes.checks.base import Check, Remains, ZeroAt
from gproof.passes.checks.stock.entry_kernels import (
    DEPTH,
    FLUTES,
    FROM_START,
    HOLDER,
    KINDS,
    MAYBE,
    NO_PLACE,
    NO_SHAPE,
    SHANK,
    SURE,
    THROUGH,
)
from gproof.passes.checks.stock.follow_kernels import (
    END,
    HEIGHT,
    MEMORY,
    PLACE,
    START,
    FieldAhead,
    TipRows,
    ToolTables,
    follow,
)
from gproof.passes.checks.stock.height_fields import MOST_CELLS, Field, field_of, remains_of
from gproof.passes.checks.stock.tool_profiles import COLUMNS, NOT_KNOWN, PART_COLUMNS, Row, assumed, problem_of, rows_of
from gproof.passes.checks.tooling.tip_position import Placing, Reason, Tips
from gproof.passes.checks.tooling.tip_ranges import hull, may_meet
from gproof.passes.checks.tooling.tool_shape import ANYTHING, Shape, shape_of
from gproof.passes.geometry.arc_tolerance import chord_error, small_arcs
from gproof.passes.geometry.off_path import off_path

Floats = npt.NDArray[np.float64]

PLACES = 256
"""Plunges, and lines of feeds, that are remembered: back in a hole, and back along a slot, a tool is free."""
WAITING_CELLS = 32_000_000
"""Of fields that wait for their section: 512 MB. What is beyond that starts from whole stock, of which none is sure."""
TOLD = 2000
"""Findings of a code that are made; more are only counted."""
ROUNDING = 1e-9

SURELY: dict[int, Code] = {
    THROUGH: codes.TRAVERSE_IN_STOCK, FLUTES: codes.DEEPER_THAN_FLUTES, DEPTH: codes.DEEPER_THAN_ALLOWED,
    SHANK: codes.HOLDER_IN_STOCK, HOLDER: codes.HOLDER_IN_STOCK,
}  # fmt: skip
PERHAPS: dict[int, Code] = {
    THROUGH: codes.TRAVERSE_NEAR_STOCK, FLUTES: codes.DEPTH_OPEN, DEPTH: codes.DEPTH_OPEN,
    SHANK: codes.HOLDER_NEAR_STOCK, HOLDER: codes.HOLDER_NEAR_STOCK,
}  # fmt: skip
PARTS = {SHANK: "the shank", HOLDER: "the holder"}
LIMITS = {FLUTES: "its flute length", DEPTH: "its maximum depth of cut"}

WIDE_CUTS = "the depth of cut is compared with flute length and maximum depth where a cut is at least one cell wide"
FREE_WAY = "the path from the start position of the axes to the first known place is free"
STATE = (
    "what the machine file does not give for a tool (flute_length, shank_diameter, stickout, holder) can be anything"
)
WEIGHT = np.array([0, 2, 5, 4, 3, 1])
"""Of what is reported for a row, the worst of several bodies counts."""


class _Left:
    """What is left of a body on one way through the job, and where its tool was."""

    def __init__(self, field: Field) -> None:
        self.field = field
        self.memory = np.zeros(MEMORY)
        self.places = np.full((PLACES, 5), math.nan)
        self.lines = np.full((PLACES, 8), math.nan)

    def copy(self) -> _Left:
        """Another one that goes its own way."""
        other = _Left(self.field.copy())
        other.memory, other.places, other.lines = self.memory.copy(), self.places.copy(), self.lines.copy()
        return other

    def join(self, other: _Left) -> None:
        """Either way may have been taken: as much may be left as on one, as little is sure as on the other."""
        np.maximum(self.field.upper, other.field.upper, out=self.field.upper)
        np.minimum(self.field.lower, other.field.lower, out=self.field.lower)
        self.memory[:] = 0.0
        self.places[:], self.lines[:] = math.nan, math.nan


class StockLeft(Check):
    """The property ``collisions``, as far as it is about stock."""

    name = "collisions"

    def __init__(self, program: Program, machine: Machine, setup: Setup, findings: Findings, zero: ZeroAt) -> None:
        super().__init__(machine, setup, findings)
        self._job = program.files[0].name if program.files else ""
        self.placing = Placing(machine, setup, zero)
        self.bodies: tuple[Placed, ...] = () if setup.workpiece is None else setup.workpiece.stock
        self._left: list[_Left] = []
        self._ended: list[_Left] = []
        self._waiting: dict[int, list[_Left]] = {}
        self._section = -1
        self._from: dict[int, set[int]] = {}
        self._seen: set[int] = set()
        self._lost: set[int] = set()
        self._numbers: dict[int, int] = {}
        self._tools: list[Row] = []
        self._parts: list[list[Row]] = []
        self._problems: list[str] = []
        self._assumptions: dict[str, None] = {}
        self._counts: dict[int, int] = {}
        stated = machine.controller.straight_traverse
        self._straight = program.rules.straight_traverse if stated is None else stated
        self._ranged = any(not ends.exact for ends in setup.start.values())

    @property
    def fields(self) -> list[Field]:
        """What is left of each body where the job is."""
        return [left.field for left in self._left]

    def remains(self) -> tuple[Remains, ...]:
        """What is left of each body where the job ended last."""
        if not self._ended:
            return ()
        assert self.setup.workpiece is not None
        whole = [field_of(placed.body, self.setup.workpiece.cell, MOST_CELLS) for placed in self.bodies]
        return tuple(remains_of(n, a, b.field) for n, (a, b) in enumerate(zip(whole, self._ended, strict=True)))

    def feed(self, chunk: Chunk) -> None:
        """Cut with some rows, and tell what they meet."""
        if not self.bodies:
            return
        if chunk.section != self._section:
            self._enter(chunk.section)
        if len(chunk.rows):
            self._follow(chunk)
        if chunk.last:
            self._leave(chunk)

    def _fresh(self) -> list[_Left]:
        assert self.setup.workpiece is not None
        cell = self.setup.workpiece.cell
        out = []
        for placed in self.bodies:
            if isinstance(placed.body, Mesh) and not placed.body.closed:
                where = Span(placed.body.source or self._job, 1)
                self.findings.add(codes.STOCK_UNKNOWN.at(where, cause=f"{placed.name} is not closed"))
            field = field_of(placed.body, cell, MOST_CELLS)
            said = f"the remaining stock of {placed.name} is known in cells of {field.cell:.4g} mm"
            if field.cell > cell * (1 + 1e-9):
                said += f"; {cell:g} mm would need more than {MOST_CELLS} of them"
            self._assumptions[said] = None
            out.append(_Left(field))
        return out

    def _enter(self, section: int) -> None:
        """Start a section with what the branches to it have left."""
        first = self._section < 0
        self._section = section
        found = self._waiting.pop(section, None)
        if found is None or section in self._lost:
            found = self._fresh()
            for left in found if not first else ():
                # A way that is not known: whole stock is the most there can be, and nothing is sure.
                left.field.lower[:] = -math.inf
        self._left = found
        self._seen.add(section)

    def _leave(self, chunk: Chunk) -> None:
        """Hand what is left on to the sections that follow."""
        edges = {edge.target: edge for edge in reversed(chunk.edges) if edge.target >= 0}
        if any(edge.target < 0 for edge in chunk.edges):
            self._ended = [left.copy() for left in self._left] if edges else self._left
        size = sum(left.field.upper.size for left in self._left)
        for target, edge in edges.items():
            self._from.setdefault(target, set()).add(chunk.section)
            if target in self._seen:
                if not self._always_through(target, chunk.section):
                    where = Span(chunk.trace.files[edge.file] if chunk.trace.files else "", max(1, edge.line))
                    cause = "what follows was checked with the stock that another path to it has left"
                    self.findings.add(codes.STOCK_UNKNOWN.at(where, cause=cause))
            elif target in self._waiting:
                for one, other in zip(self._waiting[target], self._left, strict=True):
                    one.join(other)
            else:
                self._waiting[target] = [left.copy() for left in self._left] if len(edges) > 1 else self._left
            if target not in self._seen and len(self._waiting) > 1 and size * len(self._waiting) > WAITING_CELLS:
                self._waiting.pop(target, None)
                self._lost.add(target)

    def _always_through(self, section: int, to: int) -> bool:
        """Whether every way to a section leads through another: then no more is left there than was."""
        todo, done = [to], {section}
        while todo:
            at = todo.pop()
            if at in done:
                continue
            done.add(at)
            before = self._from.get(at)
            if not before:
                return False
            todo += before
        return True

    def _follow(self, chunk: Chunk) -> None:
        assert self.setup.workpiece is not None
        rows, n = chunk.rows, len(chunk.rows)
        told, amount = np.zeros((n, KINDS), dtype=np.int64), np.zeros((n, KINDS))
        whole = {placed.work: self.placing.tips(chunk, placed.work) for placed in self.bodies}
        beside = self._beside(chunk)
        for placed, left in zip(self.bodies, self._left, strict=True):
            tips = whole[placed.work]
            tool_of = self._tool_rows(tips)
            tools, parts = self._tables()
            bow, known = self._beside_arcs(rows, tips), self._bits(chunk, placed, tips)
            straight = np.full(n, 0 if self._straight else 1, dtype=np.int64)
            said, by = np.zeros((n, KINDS), dtype=np.int64), np.zeros((n, KINDS))
            field = left.field
            at = TipRows(
                rows["op"], tips.start, tips.end, tips.center, rows["turns"], rows["plane"], known, tool_of, beside,
                bow, straight,
            )  # fmt: skip
            ahead = FieldAhead(field.upper, field.lower, field.grid, left.memory, left.places, left.lines)
            follow.pick(_work(tips, tools[tool_of, 1], field))(
                at, ToolTables(tools, parts), self.setup.workpiece.clearance, ahead, said, by
            )
            worse = WEIGHT[said] > WEIGHT[told]
            more = (said == told) & (by > amount)
            told, amount = np.where(worse, said, told), np.where(worse | more, by, amount)
        self._tell(chunk, whole, told, amount)

    def _bits(self, chunk: Chunk, placed: Placed, tips: Tips) -> npt.NDArray[np.int64]:
        """By row the bits HEIGHT, PLACE, START and END.

        What comes from the start is taken to be free, or, where a range is stated for that, is free where all of the
        range is.
        """
        known = tips.axes[:, 2] * HEIGHT + (tips.axes[:, 0] & tips.axes[:, 1]) * PLACE
        start = tips.reason == Reason.START
        for row in np.flatnonzero(start).tolist() if self._ranged else ():
            start[row] = not self._may_meet(chunk, row, placed, int(tips.tool[row]))
        known += start * START + tips.end_known.all(axis=1) * END
        found: npt.NDArray[np.int64] = known.astype(np.int64)
        return found

    def _may_meet(self, chunk: Chunk, row: int, placed: Placed, key: int) -> bool:
        """Whether a move may come to a body, wherever in the stated range it starts."""
        assert self.setup.workpiece is not None
        entry = self.placing.tools.entry(key)
        shape = Shape(problem="?") if entry.tool is None or entry.doubt else shape_of(entry.tool)
        spans = hull(*(self.placing.span(chunk, row, placed.work, behind=end) for end in (False, True)))
        room = self.setup.workpiece.clearance + float(self._beside(chunk)[row])
        return may_meet((ANYTHING,) if shape.problem else shape.pieces, (placed.body,), spans, room)

    def _beside(self, chunk: Chunk) -> Floats:
        """By row: mm that the tool may be off the programmed path (``passes/geometry/off_path.py``)."""
        out = [ROUNDING + off_path(self.machine, state).distance for state in chunk.trace.states]
        beside: Floats = np.array(out, dtype=np.float64)[chunk.rows["state"]]
        return beside

    def _beside_arcs(self, rows: Columns, tips: Tips) -> Floats:
        """By row: mm that the controller's own path along an arc may be off it."""
        arcs = rows["op"] == Op.ARC
        if not arcs.any():
            return np.zeros(len(rows))
        lines = small_arcs(self.machine, tips.start, tips.center, rows["plane"])
        beside: Floats = np.where(arcs & tips.known, chord_error(self.machine) + lines, 0.0)
        return beside

    def _tool_rows(self, tips: Tips) -> npt.NDArray[np.int64]:
        """By row: the index of its tool in the tables, by keys, which grow."""
        numbers, index = np.unique(tips.tool, return_inverse=True)
        for number in numbers.tolist():
            if number not in self._numbers:
                self._numbers[number] = len(self._tools)
                entry = self.placing.tools.entry(number)
                tool = entry.tool
                problem = entry.doubt or problem_of(tool, entry.number)
                row, parts = (NOT_KNOWN, []) if problem or tool is None else rows_of(tool)
                self._tools.append(row)
                self._parts.append(parts)
                self._problems.append(problem)
                if tool is not None and not problem:
                    self._assumptions.update(dict.fromkeys(assumed(tool)))
        found: npt.NDArray[np.int64] = np.array([self._numbers[number] for number in numbers.tolist()])[index]
        return found

    def _tables(self) -> tuple[Floats, Floats]:
        """(t, COLUMNS) tools and (t, p, PART_COLUMNS) their parts."""
        parts = np.zeros((len(self._tools), max(map(len, self._parts)), PART_COLUMNS))
        for n, each in enumerate(self._parts):
            for m, part in enumerate(each):
                parts[n, m] = part
        return np.array(self._tools, dtype=np.float64).reshape(-1, COLUMNS), parts

    def _tell(
        self, chunk: Chunk, whole: dict[int, Tips], told: npt.NDArray[np.int64], amount: Floats
    ) -> None:  # fmt: skip
        if not told.any():
            return
        if (told == FROM_START).any():
            self._assumptions[FREE_WAY] = None
        cells = max(left.field.cell for left in self._left)
        for row, kind in np.argwhere((told != 0) & (told != FROM_START)).tolist():
            answer, by = int(told[row, kind]), float(amount[row, kind])
            code = codes.STOCK_UNKNOWN
            if answer in (SURE, MAYBE):
                code = (SURELY if answer == SURE else PERHAPS)[kind]
            self._counts[code.number] = self._counts.get(code.number, 0) + 1
            if self._counts[code.number] > TOLD:
                self.findings.counts[code.number] += 1
                continue
            span = row_span(chunk.trace, chunk.rows, row)
            work = self.bodies[0].work
            key = int(whole[work].tool[row])
            number = self.placing.tools.entry(key).number
            if answer == NO_PLACE:
                work = next(w for w, tips in whole.items() if not tips.known[row])
                self.findings.add(code.at(span, cause=self.placing.cause(chunk, row, work)))
            elif answer == NO_SHAPE:
                self.findings.add(code.at(span, cause=self._problems[self._numbers[key]]))
            elif kind == THROUGH:
                hint = f"try smaller cells than {cells:.4g} mm" if answer == MAYBE else ""
                self.findings.add(code.at(span, depth=by, hint=hint))
            elif kind in PARTS:
                hint = STATE if answer == MAYBE else ""
                self.findings.add(code.at(span, part=PARTS[kind], tool=number, depth=by, hint=hint))
            else:
                self.findings.add(code.at(span, tool=number, over=by, limit=LIMITS[kind]))

    def finish(self) -> PropertyResult:
        """SAFE under what is listed, UNSAFE, or UNKNOWN."""
        if not self.bodies:
            return self._without_stock()
        verdict = Verdict.SAFE
        if self.findings.has(Severity.ERROR, (self.name,)):
            verdict = Verdict.UNSAFE
        elif self.findings.has(Severity.UNKNOWN, (self.name,)):
            verdict = Verdict.UNKNOWN
        if any(tool.flute_length is not None or tool.max_depth is not None for tool in self.machine.tools):
            self._assumptions[WIDE_CUTS] = None
        assumptions = (*self._assumptions, *self.placing.assumptions)
        return PropertyResult(name=self.name, verdict=verdict, assumptions=assumptions)

    def _without_stock(self) -> PropertyResult:
        given = self.setup.workpiece
        if given is None or not (given.part or given.fixtures):
            # What is left open then is reported for fixtures, part and stock together
            # (passes/checks/collisions/collisions.py).
            return PropertyResult(name=self.name, verdict=Verdict.UNKNOWN)
        if given.fixtures:
            said = "the setup file gives no stock: moves through stock are not checked"
            return PropertyResult(name=self.name, verdict=Verdict.SAFE, assumptions=(said,))
        self.findings.add(
            codes.STOCK_UNKNOWN.at(
                Span(self._job, 1), cause="the setup file gives no stock", hint="state [stock] in the setup file"
            )
        )
        return PropertyResult(name=self.name, verdict=Verdict.UNKNOWN)


def _work(tips: Tips, radius: Floats, field: Field) -> float:
    """About how many cells the tool passes."""
    low = np.minimum(tips.start[:, 2], tips.end[:, 2])
    cuts = tips.known & (low < field.grid[5])
    way = np.hypot(tips.end[cuts, 0] - tips.start[cuts, 0], tips.end[cuts, 1] - tips.start[cuts, 1])
    wide = radius[cuts]
    return len(low) + float(((2.0 * way + 3.0 * wide) * wide).sum() / (field.grid[2] * field.grid[3]))
