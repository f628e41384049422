"""Arcs -> arcs that the target has, or chords."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from gproof.ir.columns import Array, Columns
from gproof.ir.job import (
    ARC_CCW,
    ARC_CW,
    MM,
    MOVE,
    STRAIGHT,
    ArcTo,
    AxisPlace,
    Moves,
    Node,
    Quantity,
)
from gproof.ir.job_features import row_features
from gproof.ir.machine import AXIS_NAMES
from gproof.ir.program import Number
from gproof.passes.legalize.context import Context
from gproof.passes.legalize.pattern import Pattern
from gproof.passes.legalize.row_places import positions

COLUMNS = {"xy": (0, 1), "xz": (0, 2), "yz": (1, 2)}
"""Columns of the axes of a plane, in the order of its name."""
HANDED = {"xy": 1.0, "xz": -1.0, "yz": 1.0}
"""Sense of a counter-clockwise arc in the coordinates of the plane as its name orders them: X to Z turns the other way
round than Z to X, which is counter-clockwise seen from +Y."""


def centers(start: Array, end: Array, radius: Array, clockwise: Array, plane: str) -> Array:
    """Centres of arcs by their radius, (rows, 2), NaN where no circle has it through both places.

    start, end: (rows, 2); radius: negative for more than half a circle.
    """
    middle, chord = (start + end) / 2.0, end - start
    length = np.hypot(chord[:, 0], chord[:, 1])
    with np.errstate(invalid="ignore", divide="ignore"):
        square = radius**2 - (length / 2.0) ** 2
        # A chord that is longer than the diameter by rounding is the diameter.
        square = np.where((square < 0.0) & (square > -1e-6 * radius**2), 0.0, square)
        height = np.sqrt(square) / length
    side = np.where(clockwise, -1.0, 1.0) * np.where(radius < 0.0, -1.0, 1.0) * HANDED[plane]
    # Counter-clockwise and less than half a circle: the centre is left of the chord.
    normal = np.stack([-chord[:, 1], chord[:, 0]], axis=1)
    found: Array = middle + normal * (height * side)[:, None]
    return found


def by_center(node: Node, feature: str, context: Context) -> list[Node] | None:
    """Arcs by their radius, as arcs by their centre, where it is known where they start."""
    if isinstance(node, Moves):
        return _table_by_center(node, context)
    if not isinstance(node, ArcTo) or node.radius is None:
        return None
    first, second = (AXIS_NAMES[column] for column in COLUMNS[node.plane])
    start = [context.place.get(first), context.place.get(second)]
    radius = context.mm(node.radius)
    if None in start or radius is None:
        return None
    end = dict(zip((first, second), start, strict=True))
    for place in node.to:
        value = context.mm(place.at)
        if value is None:
            return None
        if place.axis in end:
            end[place.axis] = value + (end[place.axis] or 0.0 if place.relative else 0.0)
    ends = np.array([[end[first], end[second]]], np.float64)
    starts = np.array([start], np.float64)
    found = centers(starts, ends, np.array([radius]), np.array([node.clockwise]), node.plane)
    if np.isnan(found).any():
        return None
    offset = (found - starts)[0]
    scale = MM[node.radius.unit]
    center = tuple(
        AxisPlace(axis, Quantity(Number(float(by) / scale, node.span), node.radius.unit), True)
        for axis, by in zip((first, second), offset, strict=True)
    )
    return [replace(node, center=center, radius=None)]


def _table_by_center(node: Moves, context: Context) -> list[Node] | None:
    rows = node.rows
    which = np.flatnonzero(rows["radius"] != 0.0)
    before, after = positions(node, context.place)
    pair = list(COLUMNS[node.plane])
    start, end = before[which][:, pair], after[which][:, pair]
    clockwise = rows["kind"][which] == ARC_CW
    found = centers(start, end, rows["radius"][which], clockwise, node.plane)
    if np.isnan(found).any():
        return None
    arrays = {name: array.copy() for name, array in rows.arrays.items()}
    for place, column in enumerate(pair):
        arrays["center"][which, column] = found[:, place] - start[:, place]
        arrays["centred"][which] |= np.uint8(1 << column)
    arrays["radius"][which] = 0.0
    return [replace(node, rows=Columns(MOVE, arrays))]


START_OPEN = "it has to name its end, and where it starts is not known"


def named_end(node: Node, feature: str, context: Context) -> list[Node] | None:
    """A full circle that names no place, as one that ends by name where it starts."""
    if isinstance(node, Moves):
        return _table_with_named_ends(node, context)
    if not isinstance(node, ArcTo) or node.radius is not None:
        return None
    unit = next((place.at.unit for place in node.center if place.at.unit in MM), "mm")
    ends = []
    for column in COLUMNS[node.plane]:
        here = context.place.get(AXIS_NAMES[column])
        if here is None:
            context.why = START_OPEN
            return None
        ends.append(AxisPlace(AXIS_NAMES[column], Quantity(Number(here / MM[unit], node.span), unit)))
    if any(place.relative for place in node.to):
        ends = [replace(end, at=Quantity(Number(0.0, node.span), unit), relative=True) for end in ends]
    return [replace(node, to=(*ends, *node.to))]


def _table_with_named_ends(node: Moves, context: Context) -> list[Node] | None:
    rows = node.rows
    which = np.flatnonzero(row_features(node)["arc_full"])
    before, _ = positions(node, context.place)
    arrays = {name: array.copy() for name, array in rows.arrays.items()}
    for column in COLUMNS[node.plane]:
        here = np.zeros(len(which)) if node.relative else before[which, column]
        if np.isnan(here).any() or (rows["radius"][which] != 0.0).any():
            context.why = START_OPEN
            return None
        arrays["to"][which, column] = here
        arrays["axes"][which] |= np.uint8(1 << column)
    return [replace(node, rows=Columns(MOVE, arrays))]


def chords(node: Node, feature: str, context: Context) -> list[Node] | None:
    """Arcs as chords within the tolerance, where it is known where they start."""
    if isinstance(node, Moves):
        return _table_in_chords(node, feature, context)
    if not isinstance(node, ArcTo) or node.radius is not None or node.turns is not None:
        return None
    rows = _as_row(node, context)
    return None if rows is None else chords(rows, feature, context)


def _as_row(node: ArcTo, context: Context) -> Moves | None:
    """An arc with known numbers as a table of one row."""
    arrays = MOVE.empty(1)
    unit = next((place.at.unit for place in (*node.to, *node.center) if place.at.unit in MM), "mm")
    for place in node.to:
        value, column = context.mm(place.at), AXIS_NAMES.index(place.axis)
        if value is None or place.relative:
            return None
        arrays["to"][0, column] = value / (MM[unit] if column < 3 else 1.0)
        arrays["axes"][0] |= np.uint8(1 << column)
    for place in node.center:
        value, column = context.mm(place.at), AXIS_NAMES.index(place.axis)
        start = 0.0 if place.relative else context.place.get(place.axis)
        if value is None or start is None:
            return None
        arrays["center"][0, column] = (value - start) / MM[unit]
        arrays["centred"][0] |= np.uint8(1 << column)
    arrays["kind"][0] = ARC_CW if node.clockwise else ARC_CCW
    arrays["line"][0] = node.span.line
    feed = None if node.feed is None else context.value(node.feed.amount.value)
    arrays["feed"][0] = np.nan if feed is None else feed
    return Moves(rows=Columns(MOVE, arrays), unit=unit, span=node.span, plane=node.plane)


def _table_in_chords(node: Moves, feature: str, context: Context) -> list[Node] | None:
    rows = node.rows
    which = row_features(node).get(feature)
    if which is None or node.relative or node.per == "move":
        return None
    before, after = positions(node, context.place)
    columns = COLUMNS[node.plane]
    tolerance = context.options.chord_tolerance / MM[node.unit]
    parts: list[dict[str, Array]] = []
    last = 0
    for row in np.flatnonzero(which).tolist():
        made = _chords_of(rows, row, before[row], after[row], columns, node.plane, tolerance)
        if made is None:
            return None
        parts += [{name: array[last:row] for name, array in rows.arrays.items()}, made]
        context.spend(len(made["line"]))
        last = row + 1
    parts.append({name: array[last:] for name, array in rows.arrays.items()})
    arrays = {column.name: np.concatenate([part[column.name] for part in parts]) for column in MOVE.columns}
    return [replace(node, rows=Columns(MOVE, arrays))]


def _chords_of(
    rows: Columns, row: int, start: Array, end: Array, columns: tuple[int, int], plane: str, tolerance: float
) -> dict[str, Array] | None:
    """Rows for the chords of one arc; None where it is not known where it starts or ends."""
    a, b = columns
    moving = [column for column in range(6) if column in columns or rows["axes"][row] & (1 << column)]
    if np.isnan(start[moving]).any() or np.isnan(end[moving]).any() or rows["radius"][row] != 0.0:
        return None
    center = start[[a, b]] + rows["center"][row][[a, b]]
    radius = math.dist(start[[a, b]], center)
    sense = (1.0 if rows["kind"][row] == ARC_CCW else -1.0) * HANDED[plane]
    begin = math.atan2(start[b] - center[1], start[a] - center[0])
    sweep = (math.atan2(end[b] - center[1], end[a] - center[0]) - begin) * sense
    sweep %= 2.0 * math.pi
    if sweep < 1e-12:
        sweep = 2.0 * math.pi
    # The sagitta of a chord; a tenth less than the tolerance leaves room for rounding.
    step = 2.0 * math.acos(max(-1.0, 1.0 - 0.9 * tolerance / radius)) if radius > 0.0 else math.pi
    count = max(1, math.ceil(sweep / step))
    arrays = MOVE.empty(count)
    part = np.arange(1, count + 1) / count
    angle = begin + sense * sweep * part
    arrays["to"][:] = start + (end - start) * part[:, None]
    arrays["to"][:, a] = center[0] + radius * np.cos(angle)
    arrays["to"][:, b] = center[1] + radius * np.sin(angle)
    arrays["to"][-1] = end
    arrays["axes"][:] = rows["axes"][row] | np.uint8(1 << a) | np.uint8(1 << b)
    fixed = [column for column in range(6) if column not in moving]
    arrays["to"][:, fixed] = 0.0
    arrays["kind"][:] = STRAIGHT
    arrays["file"][:], arrays["line"][:] = rows["file"][row], rows["line"][row]
    arrays["feed"][:] = np.nan
    arrays["feed"][0] = rows["feed"][row]
    return arrays


def from_start(node: Node, feature: str, context: Context) -> list[Node] | None:
    """A centre that is a place, as a distance from the start, where that is known."""
    if not isinstance(node, ArcTo):
        return None
    center = []
    for place in node.center:
        start, at = context.place.get(place.axis), context.mm(place.at)
        if not place.relative:
            if start is None or at is None:
                return None
            by = Number((at - start) / MM[place.at.unit], place.at.value.span)
            place = AxisPlace(place.axis, Quantity(by, place.at.unit), True)
        center.append(place)
    return [replace(node, center=tuple(center))]


PATTERNS = (
    Pattern(name="centre at a place -> from the start", removes=("arc_place",), apply=from_start),
    Pattern(name="radius -> centre", removes=("arc_radius",), apply=by_center),
    Pattern(name="full circle -> its end by name", removes=("arc_full",), apply=named_end),
    Pattern(
        name="arc -> chords", removes=("arc", "arc_xz", "arc_yz", "arc_helix", "arc_full"), apply=chords
    ),
)  # fmt: skip
