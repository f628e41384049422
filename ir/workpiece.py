"""What is on the table: stock, the part that is to be left, fixtures. Lengths in mm.

Bodies are upright: Z is the spindle's axis, and X and Y are those of the machine, whatever turns or scales what a
program says. Where a body counts from is its ``work``: a coordinate system of the program, with its zero where it is at
the start of the job, local offsets (G92) included, or machine coordinates, in which heights are those of a tool's tip
with no length offset in force.
docs/setup-files.md defines the tables.
"""

from __future__ import annotations

import numpy as np

from gproof.ir.columns import Column, Columns, Schema
from gproof.ir.record import record

Point = tuple[float, float]

TRIANGLES = Schema("triangles", Column("a", "f8", 3), Column("b", "f8", 3), Column("c", "f8", 3))
"""One row for each triangle of a mesh: its corners, counter-clockwise as seen from outside."""

MACHINE = 0
"""``Placed.work`` of a body in machine coordinates."""
ACTIVE = -1
"""``Placed.work`` of a body that counts from the zero in force when the job starts, whichever system that is of."""


@record(frozen=True, slots=True, kw_only=True)
class Box:
    """Everything between two corners; sides parallel to the axes."""

    low: tuple[float, float, float]
    high: tuple[float, float, float]


@record(frozen=True, slots=True, kw_only=True)
class Cylinder:
    """An upright cylinder between two heights."""

    x: float
    y: float
    radius: float
    low: float
    high: float


@record(frozen=True, slots=True, kw_only=True)
class Prism:
    """What is between two heights inside an outline and outside its holes.

    outline, holes: simple polygons without a repeated last point; outlines turn counter-clockwise, holes clockwise.
    error: mm that the polygon may be off what was drawn (arcs and splines of a DXF file).
    """

    outline: tuple[Point, ...]
    holes: tuple[tuple[Point, ...], ...] = ()
    low: float
    high: float
    error: float = 0.0


@record(frozen=True, slots=True, kw_only=True)
class Mesh:
    """A closed surface; triangles: ``TRIANGLES``; source: the file it came from; closed: a body with an inside."""

    triangles: Columns
    source: str = ""
    closed: bool = True


Body = Box | Cylinder | Prism | Mesh


@record(frozen=True, slots=True, kw_only=True)
class Placed:
    """A body and where it counts from: coordinate system 1 to 9, ``ACTIVE`` or ``MACHINE``."""

    name: str
    body: Body
    work: int = 1


@record(frozen=True, slots=True, kw_only=True)
class Workpiece:
    """What a job cuts, and what it must not touch.

    stock: what is there before the job; part: what has to be left of it; fixtures: what holds it; each the union of
    its bodies. tolerance: how deep a tool may cut into the part; clearance: how near it may come to a fixture, and a
    traverse to stock; cell: of the height fields that say which stock is still there.
    """

    stock: tuple[Placed, ...] = ()
    part: tuple[Placed, ...] = ()
    fixtures: tuple[Placed, ...] = ()
    tolerance: float = 0.01
    clearance: float = 0.0
    cell: float = 0.5


def extent(body: Body) -> tuple[float, float, float, float, float, float]:
    """Low X Y Z, high X Y Z."""
    if isinstance(body, Box):
        return (*body.low, *body.high)
    if isinstance(body, Cylinder):
        x, y, r = body.x, body.y, body.radius
        return x - r, y - r, body.low, x + r, y + r, body.high
    if isinstance(body, Prism):
        xs, ys = [p[0] for p in body.outline], [p[1] for p in body.outline]
        off = body.error
        return min(xs) - off, min(ys) - off, body.low, max(xs) + off, max(ys) + off, body.high
    corners = np.concatenate([body.triangles[name] for name in "abc"])
    low, high = corners.min(axis=0), corners.max(axis=0)
    return float(low[0]), float(low[1]), float(low[2]), float(high[0]), float(high[1]), float(high[2])
