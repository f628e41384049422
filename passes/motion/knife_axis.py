"""Tangential knife: an axis that follows the direction of X-Y moves; Trace rows in, Trace rows out.

Eding CNC manual 2.1.9. While the knife is on, G1, G2 and G3 have it point along them. Where a move starts in another
direction than the knife has: by more than the knife angle, Z goes up by the lift distance (G0), the knife turns
(G0), Z goes down again (G1); by less, the knife turns without Z; a move that is shorter than the blend distance and
turns by less than the blend angle turns it on its way. Along an arc it turns with the arc. Readings where the manual
is open are in docs/kinematics.md: at 0 the knife points along +X, it turns counter-clockwise seen from +Z, the shorter
way, and does not follow G0.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterable, Iterator

import numpy as np

from gproof.ir import codes
from gproof.ir.columns import Columns
from gproof.ir.finding import Findings
from gproof.ir.machine import Knife, Machine
from gproof.ir.trace import KNIFE, TRACE_ROW, Chunk, Op, Plane
from gproof.ir.trace_rows import row_span

SAME = 1e-6
"""Degrees: a turn that is none."""

_STILL = 1e-9
"""mm: a move of X and Y that has no direction."""


def follow_knife(chunks: Iterable[Chunk], machine: Machine, findings: Findings) -> Iterator[Chunk]:
    """The same chunks, with the knife's turns and lifts in them from where it is first switched on."""
    if machine.knife is None or machine.axis(machine.knife.axis) is None:
        yield from chunks
        return
    follower = _Follower(machine.knife, findings)
    for chunk in chunks:
        with findings.within(chunk.section):
            turned = follower.chunk(chunk)
        yield turned


class _Follower:
    """The knife along the graph of sections.

    at: where it is; said: where the program has its axis; added: rows that this section has more.
    """

    def __init__(self, knife: Knife, findings: Findings) -> None:
        self.knife = knife
        self.index = {"a": 3, "b": 4, "c": 5}[knife.axis]
        self.findings = findings
        self.used = False
        self.told: set[str] = set()
        self.arrivals: dict[int, tuple[float, float]] = {}
        self.at = self.said = 0.0
        self.added = 0

    def chunk(self, chunk: Chunk) -> Chunk:
        """One chunk with the knife in it."""
        self.used = self.used or any(KNIFE in state.following for state in chunk.trace.states)
        if not self.used:
            return chunk
        if chunk.begin == 0:
            said = chunk.start[self.index]
            self.at, self.said = self.arrivals.get(chunk.section, (said, said))[0], said
            self.added = 0
        start = list(chunk.start)
        start[self.index] = self.at
        begin = chunk.begin + self.added
        rows = self._rows(chunk)
        for edge in chunk.edges:
            if edge.target >= 0:
                known = self.arrivals.setdefault(edge.target, (self.at, self.said))
                if abs(known[0] - self.at) > SAME:
                    self._tell(chunk, len(chunk.rows) - 1, "its direction depends on the path through the program")
        return dataclasses.replace(chunk, rows=rows, start=tuple(start), begin=begin)

    def _tell(self, chunk: Chunk, row: int, what: str) -> None:
        """GP323, once for each reason."""
        if what not in self.told and len(chunk.rows):
            self.told.add(what)
            self.findings.add(codes.KNIFE_UNKNOWN.at(row_span(chunk.trace, chunk.rows, max(0, row)), what=what))

    def _rows(self, chunk: Chunk) -> Columns:
        """The chunk's rows with the knife's position, and the rows that it needs before them."""
        rows, trace = chunk.rows, chunk.trace
        on = np.array([KNIFE in state.following for state in trace.states], dtype=bool)
        knows = np.array([frame[self.index] == () for frame in trace.frames], dtype=bool)
        before, frames = chunk.starts(), chunk.start_frames()
        place: list[int] = []
        extra: dict[int, list[tuple[Op, float, float]]] = {}
        turned = np.empty(len(rows))
        for row in range(len(rows)):
            to = float(rows["to"][row, self.index])
            if to != self.said:
                if on[rows["state"][row]]:
                    self._tell(chunk, row, f"the program turns {self.knife.axis.upper()} itself")
                self.at = self.said = to
            follows = rows["op"][row] in (Op.FEED, Op.ARC) and bool(on[rows["state"][row]])
            if follows and trace.states[int(rows["state"][row])].compensation:
                self._tell(chunk, row, "with cutter radius compensation, which it does not support")
            if follows and not (knows[rows["frame"][row]] and knows[frames[row]]):
                self._tell(chunk, row, f"the position of {self.knife.axis.upper()} when it starts to follow is unknown")
            elif follows:
                found = self._turn(chunk, row, before[row], int(frames[row]))
                if found:
                    extra[row] = found
            turned[row] = self.at
            place += [row] * (1 + len(extra.get(row, ())))
        arrays = {c.name: rows[c.name][place].copy() for c in TRACE_ROW.columns}
        last = np.cumsum([1 + len(extra.get(row, ())) for row in range(len(rows))]) - 1
        arrays["to"][last, self.index] = turned
        for row, inserted in extra.items():
            for k, (op, z, angle) in enumerate(inserted, int(last[row]) - len(inserted)):
                arrays["op"][k] = op
                arrays["to"][k] = before[row]
                arrays["to"][k, 2] = z
                arrays["to"][k, self.index] = angle
                arrays["frame"][k] = frames[row]
                arrays["feed"][k] = rows["feed"][row] if op is Op.FEED else 0.0
                for name in ("center", "turns", "plane", "arg", "text"):
                    arrays[name][k] = 0
        self.added += len(place) - len(rows)
        return Columns(TRACE_ROW, arrays)

    def _turn(
        self, chunk: Chunk, row: int, begin: np.ndarray, frame: int
    ) -> list[tuple[Op, float, float]]:  # fmt: skip
        """What comes before a feed row: (function, Z, knife) each; moves ``at`` to the row's end."""
        rows, forms = chunk.rows, chunk.trace.frames
        here = forms[int(rows["frame"][row])]
        arc = rows["op"][row] == Op.ARC
        if forms[frame][:2] != here[:2]:
            self._tell(chunk, row, "the direction of a move depends on unknown offsets")
            return []
        if arc and rows["plane"][row] != Plane.XY:
            self._tell(chunk, row, "an arc outside the X-Y plane")
            return []
        (x0, y0), (x1, y1) = begin[:2].tolist(), rows["to"][row, :2].tolist()
        if arc:
            cx, cy = rows["center"][row, :2].tolist()
            turns = int(rows["turns"][row])
            sign = 1 if turns > 0 else -1
            first, last = math.atan2(y0 - cy, x0 - cx), math.atan2(y1 - cy, x1 - cx)
            sweep = (last - first) * sign % (2 * math.pi) or 2 * math.pi
            if (x0, y0) == (x1, y1):
                sweep = 2 * math.pi
            sweep += (abs(turns) - 1) * 2 * math.pi
            direction, along = math.degrees(first) + 90.0 * sign, math.degrees(sweep) * sign
            length = sweep * math.hypot(x0 - cx, y0 - cy)
        else:
            length = math.hypot(x1 - x0, y1 - y0)
            if length < _STILL:
                return []
            direction, along = math.degrees(math.atan2(y1 - y0, x1 - x0)), 0.0
        angle = (direction - self.at + 180.0) % 360.0 - 180.0
        if angle == -180.0:
            angle = 180.0
        old, z = self.at, float(begin[2])
        self.at = old + angle + along
        if abs(angle) <= SAME:
            return []
        if abs(angle) > self.knife.angle:
            up = z + self.knife.lift
            return [(Op.TRAVERSE, up, old), (Op.TRAVERSE, up, old + angle), (Op.FEED, z, old + angle)]
        if abs(angle) < self.knife.blend_angle and length < self.knife.blend_distance:
            return []
        return [(Op.TRAVERSE, z, old + angle)]
