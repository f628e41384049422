"""Tools and bodies of stock for random jobs: as the table and the setup have them, and what is true of them."""

from __future__ import annotations

import math
import random
from collections.abc import Callable

import numpy as np
from passes.checks.stock.stock_solid import Floats, Piece, Truth

from gproof.ir.columns import Columns
from gproof.ir.machine import Tool
from gproof.ir.workpiece import TRIANGLES, Box, Cylinder, Mesh
from gproof.ir.workpiece import Body as Stock
from passes.checks.stock import stock_solid as solid

Corner = tuple[float, float, float]
Both = tuple[Stock, solid.Body]


def side_of(kind: str, radius: float, corner: float, flat: float, angle: float) -> Callable[[Floats], Floats]:
    """The lower side of a cutter by the distance from its axis."""

    def side(r: Floats) -> Floats:
        if kind == "flat":
            return np.zeros_like(r)
        if kind in ("ball", "bull"):
            over = np.maximum(r - (radius - corner), 0.0)
            return corner - np.sqrt(np.maximum(corner * corner - over * over, 0.0))
        return np.maximum(r - flat, 0.0) / math.tan(math.radians(angle / 2.0))

    return side


def flange(low: float, high: float, height: float, up: float) -> Piece:
    """A part of a holder, wider or narrower upwards."""
    if high <= low:
        return Piece("holder", low, np.zeros_like, up + 1e-9 if high < low else up + height, up, level=True)
    return Piece("holder", high, lambda r: np.maximum(r - low, 0.0) * (height / (high - low)), up + height, up)


def random_tool(rng: random.Random, number: int) -> tuple[Tool, Truth]:
    """An entry of the table, and a tool that it may stand for."""

    def n(a: float, b: float) -> float:
        return round(rng.uniform(a, b), 3)

    kind = rng.choice(("flat", "flat", "ball", "bull", "vee", "drill"))
    diameter = n(1, 10)
    radius = diameter / 2.0
    corner, flat, angle = (radius if kind == "ball" else 0.0), 0.0, rng.choice((60.0, 90.0, 118.0, 140.0))
    flutes = n(2, 15)
    if kind == "bull":
        corner = rng.choice((radius, round(radius * rng.random(), 3), 0.0))
    if kind == "vee" and rng.random() < 0.5:
        flat = round(diameter * 0.1, 3) / 2.0
    if kind in ("ball", "bull"):
        flutes = max(flutes, corner)
    if kind in ("vee", "drill"):
        flutes = round(max(flutes, (radius - flat) / math.tan(math.radians(angle / 2)) + 0.01), 3)
    shank = round(diameter * rng.choice((1.0, 0.7, 1.5)), 3)
    stickout = round(flutes + rng.choice((0.0, n(1, 15))), 3)
    holder, others, at = [], [], stickout
    if stickout > flutes:
        others.append(Piece("shank", shank / 2.0, np.zeros_like, stickout, flutes, level=True))
    sizes = [(round(diameter * rng.uniform(1, 5), 3), round(diameter * rng.uniform(1, 6), 3), n(2, 20))]
    for low, high, height in (*sizes, (30.0, 30.0, 500.0)):
        holder.append((low, high, height))
        others.append(flange(low / 2.0, high / 2.0, height, at))
        at = round(at + height, 4)
    depth = rng.choice((None, None, n(0.5, 6)))
    known: dict[str, object] = {
        "flute_length": flutes,
        "shank_diameter": shank,
        "stickout": stickout,
        "holder": tuple(holder),
    }
    silent = rng.random()
    if silent < 0.05:
        known["holder"] = ()
    elif silent < 0.1:
        known["shank_diameter"] = None
    elif silent < 0.15:
        known.update(stickout=None, holder=())
    bare = kind == "drill" and rng.random() < 0.5
    tool = Tool(
        number=number, shape=kind, diameter=diameter, length=n(5, 15), max_depth=depth,
        corner_radius=corner if kind == "bull" else None, tip_diameter=2.0 * flat if kind == "vee" and flat else None,
        tip_angle=angle if kind in ("vee", "drill") and not bare else None, **known,
    )  # type: ignore[arg-type]  # fmt: skip
    cutter = Piece("cutter", radius, side_of(kind, radius, corner, flat, angle), flutes, level=kind == "flat")
    return tool, Truth(number, cutter, tuple(others), flutes, math.inf if depth is None else depth)


def mesh(triangles: list[tuple[Corner, Corner, Corner]]) -> Mesh:
    a, b, c = (np.array([t[k] for t in triangles], dtype=np.float64) for k in range(3))
    return Mesh(triangles=Columns(TRIANGLES, {"a": a, "b": b, "c": c}), closed=True)


def wedge(wide: float, deep: float, floor: float, heights: tuple[float, float]) -> tuple[Mesh, solid.Body]:
    """A block whose upper side is one slope along X."""
    x = (0.0, wide)
    low = [(p, q, floor) for q in (0.0, deep) for p in x]
    high = [(p, q, heights[k]) for q in (0.0, deep) for k, p in enumerate(x)]
    a, b, c, d = low
    e, f, g, h = high
    quads = ((a, c, d, b), (e, f, h, g), (a, b, f, e), (c, g, h, d), (a, e, g, c), (b, d, h, f))
    triangles = [t for p, q, r, s in quads for t in ((p, q, r), (p, r, s))]

    def body(points: Floats) -> tuple[Floats, Floats]:
        inside = ((points >= 0.0) & (points <= (wide, deep))).all(axis=1)
        top = heights[0] + (heights[1] - heights[0]) * points[:, 0] / wide
        return np.full(len(points), floor), np.where(inside, top, -math.inf)

    return mesh(triangles), body


def steps(wide: float, deep: float, floor: float, at: float, left: float, right: float) -> tuple[Mesh, solid.Body]:
    """A block of two heights, left of a wall and right of it."""
    ring = [(0.0, floor), (wide, floor), (wide, right), (at, right), (at, left), (0.0, left)]
    fan = (
        [(3, 4, 5), (3, 5, 0), (3, 0, 1), (3, 1, 2)] if left >= right else [(4, 5, 0), (4, 0, 1), (4, 1, 2), (4, 2, 3)]
    )
    front = [(x, 0.0, z) for x, z in ring]
    back = [(x, deep, z) for x, z in ring]
    triangles = [(front[i], front[j], front[k]) for i, j, k in fan]
    triangles += [(back[i], back[k], back[j]) for i, j, k in fan]
    for k in range(6):
        n = (k + 1) % 6
        triangles += [(front[n], front[k], back[k]), (front[n], back[k], back[n])]

    def body(points: Floats) -> tuple[Floats, Floats]:
        inside = ((points >= 0.0) & (points <= (wide, deep))).all(axis=1)
        top = np.where(points[:, 0] < at, left, right)
        return np.full(len(points), floor), np.where(inside, top, -math.inf)

    return mesh(triangles), body


def lump(rng: random.Random, wide: float, deep: float, floor: float, top: float) -> tuple[Mesh, solid.Body]:
    """A convex body, overhanging here and there."""
    points = np.array([(rng.uniform(0, wide), rng.uniform(0, deep), rng.uniform(floor, top)) for _ in range(9)])
    points[:3, 2] = floor
    middle = points.mean(axis=0)
    triangles = []
    for i in range(9):
        for j in range(i + 1, 9):
            for k in range(j + 1, 9):
                normal = np.cross(points[j] - points[i], points[k] - points[i])
                beside = (points - points[i]) @ normal
                if (beside <= 1e-9).all() or (beside >= -1e-9).all():
                    ring = (i, j, k) if (points[i] - middle) @ normal > 0 else (i, k, j)
                    triangles.append(tuple(tuple(points[m].tolist()) for m in ring))

    def body(at: Floats) -> tuple[Floats, Floats]:
        low, high = np.full(len(at), -math.inf), np.full(len(at), math.inf)
        inside = np.ones(len(at), dtype=np.bool_)
        for a, b, c in (np.array(t) for t in triangles):
            normal = np.cross(b - a, c - a)
            if abs(normal[2]) < 1e-12:
                inside &= (at - a[:2]) @ normal[:2] <= 0
                continue
            z = a[2] - ((at - a[:2]) @ normal[:2]) / normal[2]
            if normal[2] > 0:
                high = np.minimum(high, z)
            else:
                low = np.maximum(low, z)
        return low, np.where(inside & (high > low), high, -math.inf)

    return mesh(triangles), body


def random_stock(rng: random.Random, size: tuple[float, float, float, float]) -> list[Both]:
    """One or two bodies from the origin to (width, depth), between two heights."""
    wide, deep, floor, top = size

    def box(low: Corner, high: Corner) -> Both:
        def body(points: Floats) -> tuple[Floats, Floats]:
            inside = ((points >= low[:2]) & (points <= high[:2])).all(axis=1)
            return np.full(len(points), low[2]), np.where(inside, high[2], -math.inf)

        return Box(low=low, high=high), body

    kind = rng.choice(("box", "box", "two", "round", "wedge", "steps", "lump"))
    if kind == "box":
        return [box((0.0, 0.0, floor), (wide, deep, top))]
    if kind == "two":
        at = round(rng.uniform(3, wide - 3), 3)
        return [
            box((0.0, 0.0, floor), (at, deep, top)),
            box((at, 0.0, floor), (wide, deep, round(top - rng.choice((0.0, 2.0)), 3))),
        ]
    if kind == "round":
        x, y, radius = wide / 2, deep / 2, min(wide, deep) / 2

        def disc(points: Floats) -> tuple[Floats, Floats]:
            inside = np.hypot(points[:, 0] - x, points[:, 1] - y) <= radius
            return np.full(len(points), floor), np.where(inside, top, -math.inf)

        return [(Cylinder(x=x, y=y, radius=radius, low=floor, high=top), disc)]
    lower = round(floor + (top - floor) * rng.uniform(0.2, 0.9), 3)
    if kind == "wedge":
        return [wedge(wide, deep, floor, rng.choice(((top, lower), (lower, top))))]
    if kind == "steps":
        return [steps(wide, deep, floor, round(rng.uniform(3, wide - 3), 3), *rng.choice(((top, lower), (lower, top))))]
    return [lump(rng, wide, deep, floor, top)]
