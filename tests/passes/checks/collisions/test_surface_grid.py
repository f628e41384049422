"""The grid over facets: of facets that each reach across everything it does not grow with their number squared."""

from __future__ import annotations

import numpy as np
from support.guarded import alarm, memory

from gproof.ir.columns import Columns
from gproof.ir.workpiece import MACHINE, TRIANGLES, Mesh, Placed
from gproof.passes.checks.collisions.facets import Surface

COUNT = 40_000
SEED = 7


def test_facets_across_everything() -> None:
    """Every facet is listed over each point that its box covers."""
    rng = np.random.default_rng(SEED)
    corners = rng.uniform(0.0, 100.0, (COUNT, 3, 3))
    table = Columns(TRIANGLES, {name: corners[:, n] for n, name in enumerate("abc")})
    with alarm(10), memory(1 << 30):
        surface = Surface([Placed(name="all", body=Mesh(triangles=table, closed=False), work=MACHINE)])
    x0, y0, cell = surface.grid[:3]
    nx = int(surface.size[0])
    for x, y in rng.uniform(1.0, 99.0, (20, 2)):
        at = int((y - y0) / cell) * nx + int((x - x0) / cell)
        end = surface.first[at + 1] if at + 1 < len(surface.first) else len(surface.items)
        listed = set(surface.items[surface.first[at] : end].tolist())
        box = surface.box
        inside = (box[:, 0] <= x) & (x <= box[:, 1]) & (box[:, 2] <= y) & (y <= box[:, 3])
        exact = {k for k in np.flatnonzero(inside).tolist() if covers(corners[k], x, y)}
        assert exact <= listed
        assert max(corners[k][:, 2].max() for k in exact) <= surface.top[at]


def covers(corners: np.ndarray, x: float, y: float) -> bool:
    """Whether the point lies under the triangle."""
    (ax, ay), (bx, by), (cx, cy) = corners[:, :2]
    sides = [
        (bx - ax) * (y - ay) - (by - ay) * (x - ax), (cx - bx) * (y - by) - (cy - by) * (x - bx),
        (ax - cx) * (y - cy) - (ay - cy) * (x - cx),
    ]  # fmt: skip
    return all(side > 0 for side in sides) or all(side < 0 for side in sides)
