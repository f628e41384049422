"""Tools swept along lines and arcs as closed meshes, by manifold3d, between one that is too small and one too large.

Nothing of the checks is used. A piece of a tool is a convex outline (r, z) with a rounding, turned about Z. What a
convex body passes on its way along a line is the hull of the body at both ends, which is no approximation. Circles are
one: the corners of a ``Solid`` lie on the circle, so that it is too small, or outside of it, so that it is too large.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from manifold3d import Manifold, Mesh64
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Pair = tuple[float, float]
NOTHING = 1e-15
"""mm3 that may come of rounding alone."""


def within_half_planes(points: Sequence[Pair], depth: float) -> list[Pair]:
    """A convex polygon (counter-clockwise), each of its sides moved inwards: clipped by one after the other."""
    left = list(points)
    for (ax, ay), (bx, by) in zip(points, [*points[1:], points[0]], strict=True):
        size = math.hypot(bx - ax, by - ay)
        nx, ny = (ay - by) / size, (bx - ax) / size
        side = [nx * (x - ax) + ny * (y - ay) - depth for x, y in left]
        kept: list[Pair] = []
        for (p, a), (q, b) in itertools.pairwise([*zip(left, side, strict=True), (left[0], side[0])]):
            if a >= 0.0:
                kept.append(p)
            if (a < 0.0) != (b < 0.0):
                t = a / (a - b)
                kept.append((p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])))
        left = kept
        if len(left) < 3:
            return []
    return left


def hull_of(points: Sequence[Pair]) -> list[Pair]:
    """The convex polygon around points, counter-clockwise; one or two points where it has no area."""
    found = sorted(set(points))
    if len(found) < 3:
        return found
    sides: list[list[Pair]] = []
    for way in (found, found[::-1]):
        side: list[Pair] = []
        for p in way:
            while (
                len(side) > 1
                and (
                    (side[-1][0] - side[-2][0]) * (p[1] - side[-2][1])
                    - (side[-1][1] - side[-2][1]) * (p[0] - side[-2][0])
                )
                <= 0.0
            ):
                side.pop()
            side.append(p)
        sides.append(side[:-1])
    return sides[0] + sides[1]


@dataclass(frozen=True)
class Solid:
    """Bodies of revolution as points whose hull they are. steps: of a circle; outside: too large, not too small."""

    steps: int = 192
    outside: bool = False

    def points(self, outline: Sequence[Pair], rounding: float, by: float) -> Floats | None:
        """(n, 3): all within ``by`` of the rounded outline, or that lies so deep in it for by < 0; None for nothing."""
        base = hull_of([(s * r, z) for r, z in outline for s in (-1.0, 1.0)])
        radius = rounding + by
        if radius < 0.0:
            base = within_half_planes(base, -radius) if len(base) > 2 else []
            radius = 0.0
        if not base:
            return None
        rim = base
        if radius > 0.0:
            wide = radius / math.cos(math.pi / self.steps) if self.outside else radius
            turns = [2.0 * math.pi * (k + 0.5) / self.steps for k in range(self.steps)]
            # Axis-parallel ends of the rounding are corners too: what is flat stays flat.
            ends = [(radius, 0.0), (-radius, 0.0), (0.0, radius), (0.0, -radius)]
            round_ = [(wide * math.cos(t), wide * math.sin(t)) for t in turns] + ends
            rim = hull_of([(x + u, z + v) for x, z in base for u, v in round_])
        side = [(max(r, 0.0), z) for r, z in rim if r > -1e-9]
        wider = 1.0 / math.cos(math.pi / self.steps) if self.outside else 1.0
        angle = 2.0 * np.pi * np.arange(self.steps) / self.steps
        rows = []
        for r, z in side:
            if r < 1e-12:
                rows.append(np.array([[0.0, 0.0, z]]))
                continue
            rows.append(
                np.stack([wider * r * np.cos(angle), wider * r * np.sin(angle), np.full(self.steps, z)], axis=1)
            )
        return np.concatenate(rows)


def swept(points: Floats, start: Floats, end: Floats) -> Manifold:
    """What a convex body passes along a line."""
    return Manifold.hull_points(np.concatenate([points + start, points + end]))


def meets(body: Manifold, part: Manifold) -> float:
    """mm3 that two bodies have in common."""
    a, b = body.bounding_box(), part.bounding_box()
    if any(a[k] > b[3 + k] or b[k] > a[3 + k] for k in range(3)):
        return 0.0
    return float((body ^ part).volume())


def solid_of(corners: Floats) -> Manifold:
    """The body of (n, 3, 3) triangles whose corners are shared exactly."""
    places, index = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
    made = Manifold(Mesh64(np.ascontiguousarray(places), index.reshape(-1, 3).astype(np.uint64)))
    assert not made.is_empty(), made.status()
    return made


def triangles_of(body: Manifold) -> Floats:
    """(n, 3, 3) corners of its surface, each as an STL file keeps it."""
    mesh = body.to_mesh64()
    places = np.asarray(mesh.vert_properties)[:, :3].astype(np.float32).astype(np.float64)
    corners: Floats = places[np.asarray(mesh.tri_verts).astype(np.int64)]
    return corners
