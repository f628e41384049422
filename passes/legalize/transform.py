"""Rotated, scaled and mirrored coordinates -> numbers: what stands for an operation once they are in force.

A transform maps places of the work, mm from the work zero, to places of the work: new = matrix @ old + shift, for X and
Y; Z and the rest only have factors and shifts of their own.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from gproof.ir.columns import Columns
from gproof.ir.job import (
    ARC_CCW,
    ARC_CW,
    MM,
    MOVE,
    ArcTo,
    AxisPlace,
    DrillHole,
    Moves,
    MoveTo,
    Node,
    ParkAt,
    Quantity,
    SetFrame,
)
from gproof.ir.machine import AXIS_NAMES
from gproof.ir.program import Number
from gproof.ir.record import field, record
from gproof.passes.legalize.row_places import positions


@record(frozen=True, slots=True)
class Transform:
    """x, y: rows of the matrix; shift: by axis, mm or degrees; factors: of axes other than X and Y."""

    x: tuple[float, float] = (1.0, 0.0)
    y: tuple[float, float] = (0.0, 1.0)
    shift: dict[str, float] = field(default_factory=dict)
    factors: dict[str, float] = field(default_factory=dict)

    @property
    def turned(self) -> bool:
        """X of the result depends on Y of the program, or the reverse."""
        return self.x[1] != 0.0 or self.y[0] != 0.0

    @property
    def scale(self) -> float | None:
        """By what lengths in the plane of X and Y grow; None where that depends on their direction."""
        first, second = math.hypot(self.x[0], self.y[0]), math.hypot(self.x[1], self.y[1])
        square = abs(self.x[0] * self.x[1] + self.y[0] * self.y[1]) < 1e-12
        return first if square and abs(first - second) < 1e-12 * max(first, 1.0) else None

    @property
    def mirrored(self) -> bool:
        """The sense of arcs in X and Y turns round."""
        return self.x[0] * self.y[1] - self.x[1] * self.y[0] < 0.0


SAME = Transform()


def before(by: Transform, place: dict[str, float]) -> dict[str, float]:
    """Where a program is whose place behind a transform is ``place``."""
    found: dict[str, float] = {}
    if "x" in place and "y" in place:
        matrix = np.array([by.x, by.y])
        at = np.array([place["x"] - by.shift.get("x", 0.0), place["y"] - by.shift.get("y", 0.0)])
        if abs(float(np.linalg.det(matrix))) > SINGULAR:
            x, y = np.linalg.solve(matrix, at)
            found |= {"x": float(x), "y": float(y)}
    elif not by.turned:
        for axis, factor in (("x", by.x[0]), ("y", by.y[1])):
            if axis in place and factor:
                found[axis] = (place[axis] - by.shift.get(axis, 0.0)) / factor
    for axis in AXIS_NAMES[2:]:
        factor = by.factors.get(axis, 1.0)
        if axis in place and factor:
            found[axis] = (place[axis] - by.shift.get(axis, 0.0)) / factor
    return found


SINGULAR = 1e-12


def rotation(angle: float, x: float, y: float) -> Transform:
    """Counter-clockwise by degrees about a place."""
    c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    return Transform((c, -s), (s, c), {"x": x - c * x + s * y, "y": y - s * x - c * y})


def factors(by: dict[str, float], about: dict[str, float]) -> Transform:
    """Each axis times its factor, about a place."""
    shift = {axis: about.get(axis, 0.0) * (1.0 - factor) for axis, factor in by.items()}
    rest = {axis: factor for axis, factor in by.items() if axis not in "xy"}
    return Transform((by.get("x", 1.0), 0.0), (0.0, by.get("y", 1.0)), shift, rest)


def joined(inner: Transform, outer: Transform) -> Transform:
    """First ``inner``, then ``outer``."""
    a, b = np.array([inner.x, inner.y]), np.array([outer.x, outer.y])
    both = b @ a
    at = b @ np.array([inner.shift.get("x", 0.0), inner.shift.get("y", 0.0)])
    shift = {"x": float(at[0]) + outer.shift.get("x", 0.0), "y": float(at[1]) + outer.shift.get("y", 0.0)}
    rest = {}
    for axis in AXIS_NAMES[2:]:
        one, other = inner.factors.get(axis, 1.0), outer.factors.get(axis, 1.0)
        if one * other != 1.0:
            rest[axis] = one * other
        by = inner.shift.get(axis, 0.0) * other + outer.shift.get(axis, 0.0)
        if by:
            shift[axis] = by
    x, y = (tuple(float(v) for v in row) for row in both)
    return Transform((x[0], x[1]), (y[0], y[1]), shift, rest)


def applied(node: Node, by: Transform, place: dict[str, float]) -> Node | None:
    """An operation in the coordinates behind the transform; None where a number that it needs is not known.

    place: mm by axis, of the program, before the transform, of axes where it is known.
    """
    if isinstance(node, Moves):
        return _table(node, by, place)
    if isinstance(node, MoveTo):
        if node.frame == "machine":
            return node
        to = _places(node.to, by, place)
        return None if to is None else replace(node, to=to)
    if isinstance(node, ArcTo):
        return _arc(node, by, place)
    if isinstance(node, DrillHole):
        axis = node.top.axis
        if axis in by.factors or axis in by.shift or node.plane != "xy":
            return None
        at = _places(node.at, by, place)
        return None if at is None else replace(node, at=at)
    if isinstance(node, ParkAt):
        return None if node.to else node
    return None if isinstance(node, SetFrame) else node


def _places(places: tuple[AxisPlace, ...], by: Transform, place: dict[str, float]) -> tuple[AxisPlace, ...] | None:
    given: dict[str, float] = {}
    relative = {one.relative for one in places}
    if len(relative) > 1:
        return None
    is_relative = relative == {True}
    for one in places:
        if not isinstance(one.at.value, Number):
            return None
        given[one.axis] = one.at.value.value * MM.get(one.at.unit, 1.0)
    if by.turned and ("x" in given) != ("y" in given):
        other = "y" if "x" in given else "x"
        if not is_relative and other not in place:
            return None
        given[other] = 0.0 if is_relative else place[other]
    found = []
    unit = next((one.at.unit for one in places if one.at.unit in MM), "mm")
    span = places[0].at.value.span if places else None
    for axis in AXIS_NAMES:
        if axis not in given or span is None:
            continue
        if axis in "xy":
            row = by.x if axis == "x" else by.y
            value = row[0] * given.get("x", 0.0) + row[1] * given.get("y", 0.0)
        else:
            value = given[axis] * by.factors.get(axis, 1.0)
        value += 0.0 if is_relative else by.shift.get(axis, 0.0)
        in_unit = unit if axis in "xyz" else "deg"
        found.append(AxisPlace(axis, Quantity(Number(value / MM.get(in_unit, 1.0), span), in_unit), is_relative))
    return tuple(found)


def _arc(node: ArcTo, by: Transform, place: dict[str, float]) -> Node | None:
    to = _places(node.to, by, place)
    if to is None or node.plane != "xy" or by.scale is None:
        return None
    offset = {"x": 0.0, "y": 0.0}
    for one in node.center:
        if not isinstance(one.at.value, Number):
            return None
        offset[one.axis] = one.at.value.value * MM[one.at.unit]
    radius = node.radius
    if radius is not None:
        if not isinstance(radius.value, Number):
            return None
        radius = Quantity(Number(radius.value.value * by.scale, node.span), radius.unit)
    center = tuple(
        AxisPlace(axis, Quantity(Number(row[0] * offset["x"] + row[1] * offset["y"], node.span), "mm"), True)
        for axis, row in (("x", by.x), ("y", by.y))
    )
    clockwise = node.clockwise != by.mirrored
    return replace(node, to=to, center=center if radius is None else (), radius=radius, clockwise=clockwise)


def _table(node: Moves, by: Transform, place: dict[str, float]) -> Node | None:
    rows = node.rows
    arcs = rows["kind"] >= ARC_CW
    scale = by.scale
    if node.relative or (arcs.any() and (node.plane != "xy" or scale is None)):
        return None
    arrays = {name: array.copy() for name, array in rows.arrays.items()}
    unit = MM[node.unit]
    _, after = positions(node, place)
    bit = np.uint8(3)
    moved = (rows["axes"] & bit) != 0
    needed = by.turned & moved
    if by.turned:
        if np.isnan(after[needed][:, :2]).any():
            return None
        arrays["axes"][needed] |= bit
    x, y = np.nan_to_num(after[:, 0]), np.nan_to_num(after[:, 1])
    arrays["to"][:, 0] = by.x[0] * x + by.x[1] * y + by.shift.get("x", 0.0) / unit
    arrays["to"][:, 1] = by.y[0] * x + by.y[1] * y + by.shift.get("y", 0.0) / unit
    for column in range(2, len(AXIS_NAMES)):
        axis = AXIS_NAMES[column]
        shift = by.shift.get(axis, 0.0) / (unit if column < 3 else 1.0)
        arrays["to"][:, column] = rows["to"][:, column] * by.factors.get(axis, 1.0) + shift
    for column in range(len(AXIS_NAMES)):
        named = (arrays["axes"] & np.uint8(1 << column)) != 0
        arrays["to"][~named, column] = 0.0
    if arcs.any():
        i, j = rows["center"][:, 0], rows["center"][:, 1]
        arrays["center"][:, 0] = np.where(arcs, by.x[0] * i + by.x[1] * j, 0.0)
        arrays["center"][:, 1] = np.where(arcs, by.y[0] * i + by.y[1] * j, 0.0)
        by_center = arcs & (rows["radius"] == 0.0)
        arrays["centred"][by_center] |= bit
        arrays["radius"] = rows["radius"] * (scale or 1.0)
        if by.mirrored:
            kind = rows["kind"]
            arrays["kind"] = np.where(arcs, np.where(kind == ARC_CW, ARC_CCW, ARC_CW), kind).astype(np.uint8)
    return replace(node, rows=Columns(MOVE, arrays))
