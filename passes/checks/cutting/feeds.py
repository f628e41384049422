"""The property feeds: every feed is stated, and is one that the tool is. Wanted by ``--also feeds``.

Rows carry their effective feed in mm/min whatever its mode (per minute, per revolution, inverse time) and with the
override that the program set; moves of rotary axes alone (degrees a minute) and moves that follow the spindle's turns
(threads, taps: their pitch decides) have no feed of the tool's. What goes down counts as plunge: the part of a feed
along Z. GP501 (more than the axes allow: the controller goes slower) is said here as in ``compile``; unknown feeds that
lines themselves report (GP239, GP270, GP518) and velocities of 0 (GP505) decide with them.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from gproof.ir import codes
from gproof.ir.finding import Code, Findings
from gproof.ir.machine import Machine
from gproof.ir.program import Program
from gproof.ir.setup import Setup
from gproof.ir.trace import OTHER_UNIT, Chunk, Op, Plane, State
from gproof.ir.trace_rows import row_span
from gproof.ir.verdict import PropertyResult
from gproof.passes.checks.aggregate import Causes, answer
from gproof.passes.checks.base import Check
from gproof.passes.checks.tooling.cutting_rows import (
    SOMEWHERE,
    Bools,
    CutRows,
    Floats,
    Guarded,
    StateColumn,
    tool_column,
)
from gproof.passes.motion.plan import MotionEstimate
from gproof.passes.motion.plan_kernels import arc_shapes
from gproof.passes.motion.refusal_hints import ARCS_FEED

SLACK = 1e-9
"""Of a feed: what rounding may add to it."""
KNOB = "feeds are as programmed: the override is at 100 percent at the start and is not turned up"
_TOLD = (codes.FEED_UNKNOWN, codes.SPINDLE_UNKNOWN, codes.OVERRIDE_FACTOR)


_OPEN = frozenset({"L5", OTHER_UNIT})
"""After these a feed of the trace is not what counts, or need not be."""


class Feeds(Check):
    """See the module's text."""

    name = "feeds"

    def __init__(self, program: Program, machine: Machine, setup: Setup, findings: Findings) -> None:
        super().__init__(machine, setup, findings)
        self._rows = CutRows(program)
        self._axes = MotionEstimate(machine, findings)
        self._feed = tool_column(machine, lambda tool: tool.max_feed)
        self._plunge = tool_column(machine, lambda tool: tool.max_plunge)
        self._tool = StateColumn(lambda state: float(state.tool))
        self._free = StateColumn(_follows)
        self._contoured = StateColumn(lambda state: float(not _OPEN.isdisjoint(state.retimed)))
        self._limited = any(t.max_feed is not None or t.max_plunge is not None for t in machine.tools)
        self._causes, self._held = Causes(findings), Causes(findings)
        self._guarded = Guarded()
        controls = machine.settings
        self._arcs_open = program.rules.arcs_keep_feed and controls.arcs_share_feed is None

    def feed(self, chunk: Chunk) -> None:
        """Some successive rows."""
        self._axes.feed(chunk)
        rows = chunk.rows
        moves: Bools = (rows["op"] == Op.FEED) | (rows["op"] == Op.ARC)
        if not moves.any():
            return
        feed: Floats = rows["feed"]
        open_ = moves & (np.isnan(feed) | (self._contoured.rows(chunk) != 0.0)) & (self._free.rows(chunk) == 0.0)
        if open_.any():
            on_arcs = self._arcs_open and not (open_ & (rows["op"] == Op.FEED)).any()
            self._tell(self._causes, chunk, open_, codes.FEED_NOT_TOLD, 0, ARCS_FEED if on_arcs else "")
        if not self._limited:
            return
        way = self._rows.ways(chunk)
        cut, held, again = self._guarded.split(chunk, self._rows.cuts(chunk, way) & (self._free.rows(chunk) == 0.0))
        if again:
            self._held.clear()
        for mine, causes in ((cut, self._causes), (held, self._held)):
            if mine.any():
                self._judge(chunk, mine, way, causes)

    def _judge(self, chunk: Chunk, cut: Bools, way: Floats, causes: Causes) -> None:
        """Cuts by what their tool is."""
        feed: Floats = chunk.rows["feed"]
        self._tell(causes, chunk, cut & (self._tool.rows(chunk) < 0), codes.FEED_TOOL_NOT_TOLD, 0)
        length, down = _lengths(chunk, way)
        linear = cut & ~(length < SOMEWHERE)
        self._over(causes, chunk, linear, feed, 60.0 * self._feed.rows(chunk), codes.FEED_OVER_TOOL)
        plunge = 60.0 * self._plunge.rows(chunk)
        # Of a way whose slope is not known, one slower than the limit for plunges is fine whatever it is.
        open_ = linear & np.isnan(down) & (feed > plunge * (1.0 + SLACK))
        self._tell(causes, chunk, open_, codes.PLUNGE_NOT_KNOWN, 0)
        self._over(causes, chunk, linear & ~np.isnan(down), feed * down, plunge, codes.PLUNGE_OVER_TOOL)

    def finish(self) -> PropertyResult:
        """The answer, after the last chunk."""
        self._causes.take_over(self._held)
        if any(self.findings.counts.get(code.number) for code in _TOLD):
            # The line that has such a feed is reported already, with what it depends on.
            self._causes.forget(codes.FEED_NOT_TOLD)
        self._causes.report()
        return answer(self.name, self.findings, (KNOB,) if self._limited else ())

    def _over(self, causes: Causes, chunk: Chunk, rows: Bools, feed: Floats, allowed: Floats, code: Code) -> None:
        over = rows & (feed > allowed * (1.0 + SLACK))
        for tool in np.unique(self._tool.rows(chunk)[over]).tolist():
            mine = over & (self._tool.rows(chunk) == tool)
            top = int(np.argmax(np.where(mine, feed, -math.inf)))
            most, limit = float(feed[top]), float(allowed[top])
            values: dict[str, Any] = {"tool": int(tool), "feed": most, "over": most - limit, "allowed": limit}
            self._tell(causes, chunk, mine, code, int(tool), **values)
            causes.worse(code, int(tool), "feed", most, **values)

    def _tell(
        self, causes: Causes, chunk: Chunk, rows: Bools, code: Code, key: int, hint: str = "", **values: Any
    ) -> None:
        found = np.flatnonzero(rows)
        if not found.size:
            return
        first, last = (row_span(chunk.trace, chunk.rows, int(found[at])) for at in (0, -1))
        causes.add(code, key, first, last, found.size, hint or _HINTS[code.number], **values)


_HINTS = {
    codes.FEED_NOT_TOLD.number: "program F as a plain number before the first of them, after the last change of unit",
    codes.FEED_TOOL_NOT_TOLD.number: "program T and its tool change before, or state tool = ... in the setup file",
    codes.FEED_OVER_TOOL.number: "program a lower F, or change max_feed of this tool in the machine file",
    codes.PLUNGE_NOT_KNOWN.number: "state in the setup file what the move counts from: the offset changes on its path",
    codes.PLUNGE_OVER_TOOL.number: "program a lower F for the plunge, or change max_plunge of this tool in the "
    "machine file",
}


def _follows(state: State) -> float:
    return float(state.synchronised)


def _lengths(chunk: Chunk, way: Floats) -> tuple[Floats, Floats]:
    """(n,), (n,): mm along each row, and the most that a mm of it goes down (0 to 1); NaN where an end is not known."""
    rows = chunk.rows
    length: Floats = np.sqrt((way[:, :3] ** 2).sum(axis=1))
    with np.errstate(invalid="ignore", divide="ignore"):
        down: Floats = np.where(length == 0.0, 0.0, np.maximum(-way[:, 2], 0.0) / length)
    at = np.flatnonzero((rows["op"] == Op.ARC) & ~np.isnan(length))
    if not at.size:
        return length, down
    plane = rows["plane"][at]
    shapes = np.empty((at.size, 4))
    arc_shapes.pick(len(at))(
        rows["to"][at] - way[at], rows["to"][at], rows["center"][at], rows["turns"][at], plane, shapes
    )
    begin, sweep = shapes[:, 0], shapes[:, 1]
    along = np.choose(plane - 1, [way[at, 2], way[at, 1], way[at, 0]])
    flat = 0.5 * (shapes[:, 2] + shapes[:, 3]) * np.abs(sweep)
    length[at] = whole = np.maximum(np.sqrt(flat**2 + along**2), SOMEWHERE)
    # Z is the radius times the cosine of the angle in ZX and its sine in YZ: how steep it falls turns with the angle.
    turned = np.where(plane == Plane.XZ, 0.0, -0.5 * np.pi) + np.where(sweep < 0.0, np.pi, 0.0)
    one, other = begin + turned, begin + sweep + turned
    steepest = _most_sine(np.minimum(one, other), np.maximum(one, other))
    down[at] = np.where(plane == Plane.XY, np.maximum(-along, 0.0), flat * np.maximum(steepest, 0.0)) / whole
    return length, down


def _most_sine(low: Floats, high: Floats) -> Floats:
    """The largest sine of the angles between each two."""
    tops = np.floor((low - 0.5 * np.pi) / (2 * np.pi)) != np.floor((high - 0.5 * np.pi) / (2 * np.pi))
    most: Floats = np.where(tops, 1.0, np.maximum(np.sin(low), np.sin(high)))
    return most
