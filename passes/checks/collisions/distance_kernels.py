"""Which convex surfaces a convex body of revolution comes near while it moves along a straight line.

One question decides clearances and gouges: does the body, moved along a segment, come within ``r`` of a facet? It does
exactly when facet minus segment, which is convex too, comes within ``r`` of the body that stands still. ``separation``
asks that of the two support functions (Gilbert, Johnson, Keerthi 1988) and answers only with a proof: a direction in
which they are further apart than ``r``, or two points that are nearer than ``r + gap``.
A facet is a flat polygon of up to four corners, or a line with all points within ``disc`` of it horizontally.
"""

from __future__ import annotations

import math
from typing import Any

from gproof.ir.kernel import kernel

ROUNDING = 1e-9
"""mm: more than what float64 loses in these sums at coordinates below 1e5 mm."""
TURNS = 300
"""So many steps a proof may take; those that are needed are nearly always below ten."""


@kernel()
def _segment(points: Any, i: int, j: int, weights: Any) -> float:
    """Weights of the point of an edge that is nearest to the origin; its squared distance."""
    ax, ay, az = points[i, 0], points[i, 1], points[i, 2]
    ex, ey, ez = points[j, 0] - ax, points[j, 1] - ay, points[j, 2] - az
    length = ex * ex + ey * ey + ez * ez
    t = 0.0
    if length > 0.0:
        t = min(1.0, max(0.0, -(ax * ex + ay * ey + az * ez) / length))
    for k in range(4):
        weights[k] = 0.0
    weights[i] = 1.0 - t
    weights[j] = t
    x, y, z = ax + t * ex, ay + t * ey, az + t * ez
    return float(x * x + y * y + z * z)


@kernel()
def _triangle(points: Any, i: int, j: int, k: int, weights: Any) -> float:
    """The same for a triangle, by the regions that belong to its corners, edges and inside."""
    ax, ay, az = points[i, 0], points[i, 1], points[i, 2]
    bx, by, bz = points[j, 0], points[j, 1], points[j, 2]
    cx, cy, cz = points[k, 0], points[k, 1], points[k, 2]
    ux, uy, uz = bx - ax, by - ay, bz - az
    vx, vy, vz = cx - ax, cy - ay, cz - az
    nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    nn = nx * nx + ny * ny + nz * nz
    if nn > 0.0:
        # Barycentric coordinates of the origin's projection, each the volume next to one corner.
        la = (bx * (cy * nz - cz * ny) + by * (cz * nx - cx * nz) + bz * (cx * ny - cy * nx)) / nn
        lb = (cx * (ay * nz - az * ny) + cy * (az * nx - ax * nz) + cz * (ax * ny - ay * nx)) / nn
        lc = (ax * (by * nz - bz * ny) + ay * (bz * nx - bx * nz) + az * (bx * ny - by * nx)) / nn
        if la > 0.0 and lb > 0.0 and lc > 0.0:
            total = la + lb + lc
            la, lb, lc = la / total, lb / total, lc / total
            for m in range(4):
                weights[m] = 0.0
            weights[i], weights[j], weights[k] = la, lb, lc
            x, y, z = la * ax + lb * bx + lc * cx, la * ay + lb * by + lc * cy, la * az + lb * bz + lc * cz
            return float(x * x + y * y + z * z)
    d0 = _segment(points, i, j, weights)
    w0, w1 = weights[i], weights[j]
    best, first, second = d0, i, j
    d1 = _segment(points, j, k, weights)
    if d1 < best:
        best, first, second, w0, w1 = d1, j, k, weights[j], weights[k]
    d2 = _segment(points, k, i, weights)
    if d2 < best:
        best, first, second, w0, w1 = d2, k, i, weights[k], weights[i]
    for m in range(4):
        weights[m] = 0.0
    weights[first] = w0
    weights[second] = w1
    return best


@kernel()
def _volume(points: Any, i: int, j: int, k: int) -> float:
    """Six times the signed volume of a triangle and the origin."""
    ax, ay, az = points[i, 0], points[i, 1], points[i, 2]
    bx, by, bz = points[j, 0], points[j, 1], points[j, 2]
    cx, cy, cz = points[k, 0], points[k, 1], points[k, 2]
    return float(ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx))


@kernel()
def _nearest(points: Any, count: int, weights: Any, spare: Any) -> int:
    """Weights of the point nearest to the origin in the hull of up to four points; 1 when the origin is inside."""
    for m in range(4):
        weights[m] = 0.0
    if count == 1:
        weights[0] = 1.0
        return 0
    if count == 2:
        _segment(points, 0, 1, weights)
        return 0
    if count == 3:
        _triangle(points, 0, 1, 2, weights)
        return 0
    w0, w1 = _volume(points, 1, 2, 3), -_volume(points, 0, 2, 3)
    w2, w3 = _volume(points, 0, 1, 3), -_volume(points, 0, 1, 2)
    total = w0 + w1 + w2 + w3
    size = 0.0
    for m in range(4):
        for axis in range(3):
            size = max(size, abs(points[m, axis]))
    if abs(total) > 1e-12 * size * size * size:
        w0, w1, w2, w3 = w0 / total, w1 / total, w2 / total, w3 / total
        if w0 > 0.0 and w1 > 0.0 and w2 > 0.0 and w3 > 0.0:
            weights[0], weights[1], weights[2], weights[3] = w0, w1, w2, w3
            return 1
    best = -1.0
    for face in range(4):
        i = 1 if face == 0 else 0
        j = 2 if face <= 1 else 1
        k = 2 if face == 3 else 3
        d = _triangle(points, i, j, k, spare)
        if best < 0.0 or d < best:
            best = d
            for m in range(4):
                weights[m] = spare[m]
    return 0


@kernel(seconds_per_unit=3e-4, compile_seconds=4.0)
def separation(
    corners: Any,
    facet: int,
    disc: float,
    p: Any,
    d: Any,
    rims: Any,
    count: int,
    r: float,
    gap: float,
    boxed: int,
    points: Any,
    weights: Any,
    spare: Any,
    witness: Any,
) -> int:
    """Whether a body of revolution that moves by ``d`` from ``p`` comes within ``r`` of a facet.

    corners: (n, 12) of facets; disc: mm around them, horizontally; rims: (>= count, 2) radius and height of the
    body's rims. boxed: 1 where the path from ``p`` to ``p + d`` may be any within the box of the two. points: (4, 9),
    weights, spare: (4,) to work in. witness: (7,) place on the way, less ``p``, point of the facet, distance, for 1.
    Returns -1: everywhere further than r, proved; 1: nearer than r + gap, by the witness; 0: open.
    """
    px, py, pz = p[0], p[1], p[2]
    dx, dy, dz = d[0], d[1], d[2]
    sx = sy = sz = 0.0
    for k in range(4):
        sx += corners[facet, 3 * k]
        sy += corners[facet, 3 * k + 1]
        sz += corners[facet, 3 * k + 2]
    vx, vy, vz = 0.25 * sx - px - 0.5 * dx, 0.25 * sy - py - 0.5 * dy, 0.25 * sz - pz - 0.5 * dz
    vz -= min(max(vz, rims[0, 1]), rims[count - 1, 1])
    if vx == 0.0 and vy == 0.0 and vz == 0.0:
        vz = -1.0
    n = 0
    size = 0.0
    done = False
    for _ in range(TURNS):
        # The point of (facet - segment) - body that is furthest against v.
        flat = math.sqrt(vx * vx + vy * vy)
        best, corner = 0.0, 0
        for k in range(4):
            along = vx * corners[facet, 3 * k] + vy * corners[facet, 3 * k + 1] + vz * corners[facet, 3 * k + 2]
            if k == 0 or along < best:
                best, corner = along, k
        fx, fy, fz = corners[facet, 3 * corner], corners[facet, 3 * corner + 1], corners[facet, 3 * corner + 2]
        if disc > 0.0 and flat > 0.0:
            fx -= disc * (vx / flat)
            fy -= disc * (vy / flat)
        tx = ty = tz = 0.0
        if boxed == 1:
            tx = dx if vx * dx > 0.0 else 0.0
            ty = dy if vy * dy > 0.0 else 0.0
            tz = dz if vz * dz > 0.0 else 0.0
        elif vx * dx + vy * dy + vz * dz > 0.0:
            tx, ty, tz = dx, dy, dz
        reach, rim = 0.0, 0
        for k in range(count):
            along = rims[k, 0] * flat + rims[k, 1] * vz
            if k == 0 or along > reach:
                reach, rim = along, k
        bx, by, bz = 0.0, 0.0, rims[rim, 1]
        if flat > 0.0:
            bx, by = rims[rim, 0] * (vx / flat), rims[rim, 0] * (vy / flat)
        wx, wy, wz = fx - px - tx - bx, fy - py - ty - by, fz - pz - tz - bz
        size = math.sqrt(vx * vx + vy * vy + vz * vz)
        if (vx * wx + vy * wy + vz * wz) / size > r + ROUNDING:
            return -1
        if n > 0 and size < r + gap - ROUNDING:
            done = True
            break
        for k in range(n):
            if points[k, 0] == wx and points[k, 1] == wy and points[k, 2] == wz:
                return 0
        points[n, 0], points[n, 1], points[n, 2] = wx, wy, wz
        points[n, 3], points[n, 4], points[n, 5] = tx, ty, tz
        points[n, 6], points[n, 7], points[n, 8] = fx, fy, fz
        n += 1
        within = _nearest(points, n, weights, spare)
        kept = 0
        for k in range(n):
            if weights[k] > 0.0:
                if kept < k:
                    weights[kept] = weights[k]
                    for m in range(9):
                        points[kept, m] = points[k, m]
                kept += 1
        n = kept
        vx = vy = vz = 0.0
        for k in range(n):
            vx += weights[k] * points[k, 0]
            vy += weights[k] * points[k, 1]
            vz += weights[k] * points[k, 2]
        if within == 1:
            # Weights of a tetrahedron that is nearly flat may be wrong: what they give is the witness.
            size = math.sqrt(vx * vx + vy * vy + vz * vz)
            if size >= r + gap - ROUNDING:
                return 0
            done = True
            break
        if vx == 0.0 and vy == 0.0 and vz == 0.0:
            size = 0.0
            done = True
            break
    if not done:
        return 0
    witness[6] = size
    for m in range(6):
        witness[m] = 0.0
        for k in range(n):
            witness[m] += weights[k] * points[k, 3 + m]
    return 1
