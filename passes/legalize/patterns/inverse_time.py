"""Inverse time feed -> a feed a minute for each move: so many times a minute its length."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from gproof.ir.columns import Array, Columns
from gproof.ir.job import ARC_CCW, ARC_CW, MM, MOVE, RAPID, ArcTo, AxisPlace, Feed, Moves, MoveTo, Node, Quantity
from gproof.ir.machine import AXIS_NAMES
from gproof.ir.program import Number
from gproof.passes.legalize.context import Context
from gproof.passes.legalize.pattern import Pattern
from gproof.passes.legalize.patterns.arcs import COLUMNS, HANDED
from gproof.passes.legalize.row_places import positions

ROTARY_COLUMNS = range(3, 6)
DIGITS = 6
"""After the point, of feeds that are worked out."""


def feed_a_move(node: Node, feature: str, context: Context) -> list[Node] | None:
    """Moves whose lengths are known, of axes with lengths alone."""
    if isinstance(node, Moves):
        return _table(node, context)
    if not isinstance(node, MoveTo | ArcTo) or node.feed is None or node.feed.per != "move":
        return None
    row = _as_row(node, context)
    found = None if row is None else _table(row, context)
    if not found:
        return None
    assert isinstance(found[0], Moves)
    feed = float(found[0].rows["feed"][0])
    unit = found[0].unit
    changed = None if math.isnan(feed) else Feed(Quantity(Number(feed, node.span), unit))
    return [replace(node, feed=changed)]


def _as_row(node: MoveTo | ArcTo, context: Context) -> Moves | None:
    """A move with known numbers as a table of one row."""
    center: tuple[AxisPlace, ...] = node.center if isinstance(node, ArcTo) else ()
    if isinstance(node, ArcTo) and (node.radius is not None or node.turns is not None):
        return None
    if (isinstance(node, MoveTo) and node.frame != "work") or any(not place.relative for place in center):
        return None
    arrays = MOVE.empty(1)
    unit = next((place.at.unit for place in (*node.to, *center) if place.at.unit in MM), "mm")
    for places, name, bits in ((node.to, "to", "axes"), (center, "center", "centred")):
        for place in places:
            value, column = context.mm(place.at), AXIS_NAMES.index(place.axis)
            if value is None or column in ROTARY_COLUMNS:
                return None
            arrays[name][0, column] = value / MM[unit]
            arrays[bits][0] |= np.uint8(1 << column)
    assert node.feed is not None
    feed = context.value(node.feed.amount.value)
    if feed is None or len({place.relative for place in node.to}) > 1:
        return None
    clockwise = isinstance(node, ArcTo) and node.clockwise
    arrays["kind"][0] = (ARC_CW if clockwise else ARC_CCW) if isinstance(node, ArcTo) else RAPID + 1
    arrays["feed"][0] = feed
    plane = node.plane if isinstance(node, ArcTo) else "xy"
    relative = any(place.relative for place in node.to)
    return Moves(rows=Columns(MOVE, arrays), unit=unit, span=node.span, plane=plane, relative=relative, per="move")


def _table(node: Moves, context: Context) -> list[Node] | None:
    rows = node.rows
    cutting = rows["kind"] != RAPID
    fed = ~np.isnan(rows["feed"])
    if (cutting & ~fed).any() or (rows["radius"] != 0.0).any():
        return None
    lengths = _lengths(node, context)
    if np.isnan(lengths[cutting]).any():
        return None
    arrays = dict(rows.arrays)
    feeds = np.round(np.where(cutting & (lengths > 0.0), rows["feed"] * lengths, np.nan), DIGITS)
    return [replace(node, rows=Columns(MOVE, arrays | {"feed": feeds}), per="minute")]


def _lengths(node: Moves, context: Context) -> Array:
    """Of each row, in the unit of the table; NaN where it is not known."""
    rows = node.rows
    before, after = positions(node, context.place)
    ways = np.zeros((len(rows), 3))
    for column in range(3):
        named = (rows["axes"] & np.uint8(1 << column)) != 0
        way = rows["to"][:, column] if node.relative else after[:, column] - before[:, column]
        ways[:, column] = np.where(named, way, 0.0)
    lengths = np.sqrt((ways**2).sum(axis=1))
    turned = (rows["axes"] & np.uint8(0b111000)) != 0
    lengths[turned] = np.nan
    a, b = COLUMNS[node.plane]
    third = 3 - a - b
    for row in np.flatnonzero(rows["kind"] >= ARC_CW).tolist():
        start = -rows["center"][row][[a, b]]
        end = start + ways[row][[a, b]]
        sense = (1.0 if rows["kind"][row] == ARC_CCW else -1.0) * HANDED[node.plane]
        sweep = (math.atan2(end[1], end[0]) - math.atan2(start[1], start[0])) * sense % (2.0 * math.pi)
        if sweep < 1e-9 or not (ways[row][a] or ways[row][b]):
            sweep = 2.0 * math.pi
        lengths[row] = math.hypot(sweep * math.hypot(*start), ways[row][third])
    found: Array = lengths
    return found


PATTERNS = (Pattern(name="inverse time -> a feed a move", removes=("inverse_time",), apply=feed_a_move),)
