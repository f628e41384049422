"""What tools leave of stock, computed another way: the height over a point by looking at all places of a move.

Nothing of the kernels is used: the side of a tool from its shape, the least height over a fine row of places, narrowed
down around the best ones. ``Moves`` hands the same moves to the kernel.
"""

from __future__ import annotations

import math
import random
from dataclasses import dataclass
from typing import Any

import numpy as np

from gproof.passes.checks.stock import entry_kernels
from gproof.passes.checks.stock import follow_kernels as kernels
from gproof.passes.checks.stock.tool_side_kernels import BALL, BULL, CONE, FLAT

INF = math.inf
PLANES = {1: (0, 1, 2), 2: (2, 0, 1), 3: (1, 2, 0)}


@dataclass
class Shape:
    """flat, ball, bull (corner) or cone (flat at the tip, degrees between its flanks)."""

    name: str
    radius: float
    corner: float = 0.0
    angle: float = 90.0

    def side(self, r: Any) -> Any:
        """Height of its lower side over the tip at distances r; inf beyond its radius."""
        inside = np.minimum(r, self.radius)
        if self.name == "flat":
            height = np.zeros_like(inside)
        elif self.name == "ball":
            height = self.radius - np.sqrt(self.radius**2 - inside**2)
        elif self.name == "bull":
            height = self.corner - np.sqrt(self.corner**2 - np.maximum(inside - self.radius + self.corner, 0.0) ** 2)
        else:
            height = np.maximum(inside - self.corner, 0.0) / math.tan(math.radians(self.angle / 2))
        return np.where(r <= self.radius, height, INF)

    def row(self) -> list[float]:
        """As the kernel has it."""
        if self.name == "cone":
            first = [CONE, self.radius, self.corner, math.tan(math.radians(self.angle / 2))]
        else:
            family = {"flat": FLAT, "ball": BALL, "bull": BULL}[self.name]
            first = [family, self.radius, self.radius if self.name == "ball" else self.corner, 0.0]
        return [*first, 0.0, INF, INF, INF, INF, INF, self.radius]


@dataclass
class Move:
    """A line or an arc of the tip; center, turns and plane of arcs as in the Trace."""

    op: int
    start: tuple[float, float, float]
    end: tuple[float, float, float]
    center: tuple[float, float, float] = (0.0, 0.0, 0.0)
    turns: int = 0
    plane: int = 0

    def at(self, t: Any) -> Any:
        """(..., 3): places at parameters from 0 to 1."""
        a, b, c = np.array(self.start), np.array(self.end), np.array(self.center)
        t = np.asarray(t)
        if not self.plane:
            return a + t[..., None] * (b - a)
        u, v, w = PLANES[self.plane]
        sign = 1 if self.turns > 0 else -1
        a0, a1 = math.atan2(a[v] - c[v], a[u] - c[u]), math.atan2(b[v] - c[v], b[u] - c[u])
        sweep = (sign * (a1 - a0)) % (2 * math.pi)
        if sweep == 0.0:
            sweep = 2 * math.pi
        sweep = sign * (sweep + 2 * math.pi * (abs(self.turns) - 1))
        r0, r1 = math.hypot(a[u] - c[u], a[v] - c[v]), math.hypot(b[u] - c[u], b[v] - c[v])
        r = r0 + (r1 - r0) * t
        out = np.zeros((*t.shape, 3))
        out[..., u], out[..., v] = c[u] + r * np.cos(a0 + sweep * t), c[v] + r * np.sin(a0 + sweep * t)
        out[..., w] = a[w] + (b[w] - a[w]) * t
        return out


def height_left(shape: Shape, moves: list[Move], points: Any, top: float) -> Any:
    """(n,): how high stock of that height still stands over points (n, 2)."""
    left = np.full(len(points), top)
    for move in moves:
        if move.op == kernels.TRAVERSE:
            continue
        low, high = np.zeros(len(points)), np.ones(len(points))
        count = 1500 if move.plane else 300
        for _ in range(6):
            t = low[:, None] + (high - low)[:, None] * np.linspace(0.0, 1.0, count)
            place = move.at(t)
            away = np.hypot(place[..., 0] - points[:, None, 0], place[..., 1] - points[:, None, 1])
            height = place[..., 2] + shape.side(away)
            best = height.argmin(axis=1)
            left = np.minimum(left, height.min(axis=1))
            step = (high - low) / (count - 1)
            middle = low + step * best
            low, high = np.maximum(middle - step, 0.0), np.minimum(middle + step, 1.0)
            count = 40
    return left


@dataclass
class Swept:
    """A field behind some moves, and what was told of each."""

    upper: Any
    lower: Any
    grid: Any
    told: Any
    amount: Any


def sweep(
    shape: Shape, moves: list[Move], *, size: tuple[float, float] = (12.0, 10.0), top: float = 0.0,
    floor: float = -10.0, cell: float = 0.5, run: Any = None, beside: float = 1e-9, tool: list[float] | None = None,
    pieces: int = 0, clearance: float = 0.0,
) -> Swept:  # fmt: skip
    """The kernel over a block from the origin; run: the function, the compiled one by default."""
    nx, ny = math.ceil(size[0] / cell), math.ceil(size[1] / cell)
    grid = np.array([0.0, 0.0, size[0] / nx, size[1] / ny, floor, top])
    upper = np.full((ny, nx), top)
    lower = upper.copy()
    n = len(moves)
    told, amount = np.zeros((n, entry_kernels.KINDS), dtype=np.int64), np.zeros((n, entry_kernels.KINDS))
    memory, places, lines = np.zeros(kernels.MEMORY), np.full((16, 5), math.nan), np.full((16, 8), math.nan)
    run = run or kernels.follow.compiled()
    tools, parts = np.array([tool or shape.row()], dtype=np.float64), np.zeros((1, 0, 6))
    op = np.array([m.op for m in moves], dtype=np.uint8)
    start, end, center = (np.array([getattr(m, k) for m in moves]) for k in ("start", "end", "center"))
    turns = np.array([m.turns for m in moves], dtype=np.int32)
    plane = np.array([m.plane for m in moves], dtype=np.uint8)
    whole = np.full(n, 3, dtype=np.int64)
    nothing = np.zeros(n, dtype=np.int64)
    off = np.full(n, beside)
    step = pieces or n
    for k in range(0, n, step):
        s = slice(k, k + step)
        columns = (op, start, end, center, turns, plane, whole, nothing, off, 0.0 * off, nothing)
        rows = kernels.TipRows(*(column[s] for column in columns))
        field = kernels.FieldAhead(upper, lower, grid, memory, places, lines)
        run(rows, kernels.ToolTables(tools, parts), clearance, field, told[s], amount[s])
    return Swept(upper, lower, grid, told, amount)


SHAPES = (
    Shape("flat", 2.0), Shape("ball", 1.7), Shape("bull", 2.2, 0.8), Shape("cone", 1.5, 0.2, 60.0),
    Shape("cone", 2.5, 0.0, 118.0), Shape("flat", 0.3), Shape("bull", 1.0, 1.0), Shape("ball", 0.4),
)  # fmt: skip


def random_moves(rng: random.Random, count: int) -> list[Move]:
    """A path of lines, plunges, ramps, arcs and helices over the block."""
    at = (rng.uniform(0, 12), rng.uniform(0, 10), rng.uniform(-4, 1))
    out = []
    for _ in range(count):
        kind = rng.random()
        to = (rng.uniform(-3, 15), rng.uniform(-3, 13), rng.uniform(-6, 1))
        if kind < 0.25:
            to = (at[0] + rng.uniform(-1, 1), at[1] + rng.uniform(-1, 1), at[2] + rng.uniform(-0.5, 0.5))
        elif kind < 0.4:
            to = (at[0], at[1], to[2])
        elif kind < 0.5:
            to = (to[0], at[1], at[2]) if rng.random() < 0.5 else (at[0], to[1], to[2])
        if kind < 0.75:
            out.append(Move(kernels.FEED, at, to))
            at = to
            continue
        plane = rng.choice((1, 1, 1, 2, 3))
        u, v, w = PLANES[plane]
        center = [0.0, 0.0, 0.0]
        radius, angle = rng.uniform(0.2, 5.0), rng.uniform(0, 2 * math.pi)
        center[u], center[v], center[w] = at[u] + radius * math.cos(angle), at[v] + radius * math.sin(angle), at[w]
        other, big = rng.uniform(0, 2 * math.pi), radius + rng.choice((0.0, rng.uniform(-0.01, 0.01)))
        end = [0.0, 0.0, 0.0]
        end[u], end[v] = center[u] + big * math.cos(other), center[v] + big * math.sin(other)
        end[w] = at[w] + rng.choice((0.0, rng.uniform(-2, 2)))
        turns = rng.choice((1, -1, 1, -1, 2, -3))
        out.append(Move(kernels.ARC, at, (end[0], end[1], end[2]), (center[0], center[1], center[2]), turns, plane))
        at = out[-1].end
    return out
