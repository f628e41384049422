"""Bodies that a tool must stay clear of, and where it does not: the kernels of distance with their columns.

Takes surfaces and moves in the coordinates of one zero; gives ``Stretch``es of moves that come too near.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from gproof.ir.record import record
from gproof.passes.checks.collisions.distance_kernels import separation
from gproof.passes.checks.collisions.facets import Surface
from gproof.passes.checks.collisions.sweep_kernels import Facets, Rungs, Segments, Stretches, sweep
from gproof.passes.checks.tooling.tip_ranges import Span, may_meet
from gproof.passes.checks.tooling.tool_shape import ANYTHING, CUTTER, UNSTATED, Piece, Shape, grown

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

GAP = 1e-6
"""mm between "nearer than allowed, proved" and "not, proved"."""
CHORD = 2e-4
"""mm that an arc may be off its chords; twice that at most."""
_LEVELS = 600
_RATIO = 1.03
_FIRST = 1e-5
"""mm: the first step of the levels, which grow by the ratio: how well the deepest place of a stretch is known."""
_ROOM = 64
_SLIT = 1e-5
"""mm: more than what the gap leaves open between two pieces of a tool."""


@record(frozen=True, slots=True, eq=False)
class Ladder:
    """Bodies that must stay clear, for each piece of a tool, and smaller ones inside them to tell how deep it got.

    rims: (pieces, levels, 3, 2), counts, rounds: (pieces, levels), levels, part: (pieces,); offsets: (levels,) signed
    distance to the piece that each level stands for, the first is the limit; sure: the first level that is further in
    than any arc is off its chords; pieces: as they are.
    """

    rims: Floats
    counts: Ints
    rounds: Floats
    levels: Ints
    part: Ints
    offsets: Floats
    sure: int
    pieces: tuple[Piece, ...]


def ladder_of(pieces: Sequence[Piece], limit: float) -> Ladder:
    """limit: mm of clearance, or less 0: of how deep the pieces may go into something."""
    offsets = np.array([limit, *(limit - _FIRST * _RATIO**k for k in range(_LEVELS - 1))])
    n = len(pieces)
    rims, counts = np.zeros((n, _LEVELS, 3, 2)), np.zeros((n, _LEVELS), dtype=np.int64)
    rounds, levels = np.zeros((n, _LEVELS)), np.zeros(n, dtype=np.int64)
    for j, piece in enumerate(pieces):
        for level, offset in enumerate(offsets.tolist()):
            body = grown(piece, offset - GAP)
            if body is None:
                break
            counts[j, level] = len(body[0])
            rims[j, level, : len(body[0])] = body[0]
            rounds[j, level] = body[1]
            levels[j] = level + 1
    part = np.array([piece.part for piece in pieces], dtype=np.int64)
    sure = int(np.argmax(offsets <= limit - 2.1 * CHORD))
    return Ladder(rims, counts, rounds, levels, part, offsets, sure, tuple(pieces))


@record(frozen=True, slots=True)
class Stretch:
    """Successive moves that come too near to a body with a part of the tool.

    certain: not only when the controller or the drawing takes what it may. place: file and line of the first; deepest:
    of the move that comes nearest; moves: how many rows. boxed: the path
    of the first is not known to be straight. Of first and deepest (facet, piece, tip before, way, slack).
    """

    body: int
    part: int
    certain: bool
    tool: int
    boxed: bool
    place: int
    deepest: int
    moves: int
    first: tuple[int, int, Floats, Floats, float]
    worst: tuple[int, int, Floats, Floats, float]


def _across(piece: Piece, below: float, above: float) -> Piece:
    """A piece across a joint, no further from it than that: what is further away belongs to one of the two alone."""
    if piece.joint is None:
        return piece
    (radius, bottom), (_, top) = piece.rims
    ends = max(bottom, piece.joint - below), min(top, piece.joint + above)
    return dataclasses.replace(piece, rims=((radius, ends[0]), (radius, ends[1])))


class Scene:
    """Bodies that count from one zero, what may come how near to them, and what did."""

    def __init__(self, work: int, parts: tuple[int, ...], limit: float, surface: Surface) -> None:
        self.work = work
        self.parts = parts
        self.limit = limit
        self.surface = surface
        self._ladders: dict[int, Ladder] = {}
        keys = 8 * len(surface.bodies)
        self._now = np.zeros(3, dtype=np.int64)
        self._seen, self._opened = np.zeros(keys, dtype=np.int64), np.full(keys, -2, dtype=np.int64)
        self._whole, self._real = np.zeros((_ROOM, 12), dtype=np.int64), np.zeros((_ROOM, 14))
        self._stamp = np.zeros(len(surface.corners), dtype=np.int64)
        self._scratch = np.zeros(60)
        self._by: list[int] = []
        self._tool: int | None = None

    def ladder(self, tool: int, shape: Shape) -> Ladder:
        """What of a tool must stay clear of these bodies."""
        if tool not in self._ladders:
            pieces = (ANYTHING,) if shape.problem else shape.of(*self.parts)
            # What is deeper than allowed in both together, but in neither alone; without depth there is none.
            depth = max(-self.limit, 0.0)
            reach = 2.0 * depth + _SLIT
            cutter = next((piece.joint for piece in shape.pieces if piece.joint is not None), None)
            pieces = tuple(
                # Below the joint with a cutter that is not asked about, what is met is the cutter's.
                _across(piece, depth if piece.joint == cutter and CUTTER not in self.parts else reach, reach)
                for piece in pieces
                if piece.joint is None or self.limit <= GAP
            )
            self._ladders[tool] = ladder_of(pieces, self.limit)
        return self._ladders[tool]

    def sweep(
        self, tool: int, shape: Shape, start: Floats, end: Floats, slack: Floats, sag: Floats, place: Ints
    ) -> None:
        """Look at moves along segments; see the kernel."""
        ladder, s = self.ladder(tool, shape), self.surface
        before = int(self._now[2])
        if tool != self._tool:
            self._opened[:] = -2
            self._tool = tool
        sweep.pick(len(start) * self._facets_met(ladder))(
            Segments(start, end, slack, sag, place),
            Facets(
                s.corners, s.disc, s.planes, s.beside, s.body, s.box, s.grid, s.size, s.first, s.items, s.top,
                self._stamp,
            ),
            Rungs(ladder.rims, ladder.counts, ladder.rounds, ladder.levels, ladder.part, ladder.sure),
            GAP,
            Stretches(self._now, self._seen, self._opened, self._whole, self._real),
            self._scratch,
        )  # fmt: skip
        self._by += [tool] * (int(self._now[2]) - before)

    def _facets_met(self, ladder: Ladder) -> float:
        """About how many facets a move looks at, for the choice between the kernel's speeds."""
        s, met = self.surface, 1.0
        cell = float(s.grid[2])
        for piece in ladder.pieces:
            if piece.part != UNSTATED:
                wide = 2.0 * (max(r for r, _ in piece.rims) + piece.rounding) + cell
                met += min(len(s.items), wide * wide / (cell * cell) * len(s.items) / len(s.top)) / 20.0
        return met

    def stretches(self) -> list[Stretch]:
        """What was found."""
        out = []
        for s in range(min(len(self._by), _ROOM)):
            w, x = self._whole[s], self._real[s]
            first = (int(w[3]), int(w[4]), x[0:3].copy(), x[3:6].copy(), float(x[6]))
            worst = (int(w[7]), int(w[8]), x[7:10].copy(), x[10:13].copy(), float(x[13])) if w[7] >= 0 else first
            deepest = int(w[5]) if w[7] >= 0 else int(w[1])
            key = int(w[0])
            out.append(
                Stretch(
                    key // 8, key // 2 % 4, key % 2 == 1, self._by[s], w[11] == 1, int(w[1]), deepest, int(w[10]),
                    first, worst,
                )
            )  # fmt: skip
        return out

    @property
    def left_out(self) -> int:
        """Stretches beyond the first ones."""
        return max(0, len(self._by) - _ROOM)

    def lowest(self, tool: int, shape: Shape) -> float:
        """How far the tip has to be below the highest body before anything of the tool may be too near, mm."""
        ladder = self.ladder(tool, shape)
        bottoms = [piece.tip for piece in ladder.pieces]
        return min(bottoms, default=np.inf) - max(self.limit, 0.0)

    def may_meet(self, tool: int, shape: Shape, tips: Span, slack: float) -> bool:
        """Whether what of a tool must stay clear may come too near where its tip is somewhere in a box."""
        pieces = self.ladder(tool, shape).pieces
        room = max(self.limit, 0.0) + slack + float(self.surface.grid[4])
        return may_meet(pieces, [placed.body for placed in self.surface.bodies], tips, room)

    def within(self, tool: int, shape: Shape, tip: Floats) -> list[tuple[int, int, bool | None]]:
        """(body, part, whether) of the bodies that hold a part of the tool, or may, at one place of its tip."""
        ladder = self.ladder(tool, shape)
        out: list[tuple[int, int, bool | None]] = []
        for j, piece in enumerate(ladder.pieces):
            if not ladder.levels[j] or piece.part == UNSTATED:
                continue
            rims = ladder.rims[j, 0]
            middle = 0.5 * (float(rims[0, 1]) + float(rims[ladder.counts[j, 0] - 1, 1]))
            point = (float(tip[0]), float(tip[1]), float(tip[2]) + middle)
            if not all(
                low < at < high for low, at, high in zip(self.surface.low, point, self.surface.high, strict=True)
            ):
                continue
            for body in range(len(self.surface.bodies)):
                inside = self.surface.holds(body, point)
                if inside is not False:
                    out.append((body, piece.part, inside))
        return out

    def nearest(self, stretch: Stretch) -> tuple[float, Floats, Floats]:
        """(signed distance, tip of the tool, point of the body) where the worst move comes nearest, as programmed.

        Less than 0: so deep. Correct to ``2 * GAP`` for the facet; others of the stretch are at most 3 % further in.
        """
        facet, j, tip, way, slack = stretch.worst
        boxed = int(stretch.boxed)
        piece, s = self._ladders[stretch.tool].pieces[j], self.surface
        witness, work = np.zeros(7), (np.zeros((4, 9)), np.zeros(4), np.zeros(4))
        rims = np.zeros((3, 2))
        ask = separation.pick(1)

        def met(offset: float) -> bool:
            body = grown(piece, offset - GAP)
            if body is None:
                return False
            rims[: len(body[0])] = body[0]
            return (
                ask(s.corners, facet, s.disc[facet], tip, way, rims, len(body[0]), body[1], GAP, boxed, *work, witness)
                == 1
            )

        high = self.limit + slack + float(s.beside[facet]) + GAP
        step = 0.01
        low = high - step
        while met(low):
            high, step = low, 2.0 * step
            low = high - step
        while high - low > GAP:
            middle = 0.5 * (low + high)
            if met(middle):
                high = middle
            else:
                low = middle
        met(high)
        return high, tip + witness[:3], witness[3:6].copy()
