"""Units, and relative places."""

from __future__ import annotations

from dataclasses import fields, replace
from typing import Any

import numpy as np

from gproof.ir.columns import Columns
from gproof.ir.job import (
    LENGTHS,
    MM,
    MOVE,
    ArcTo,
    AxisPlace,
    Feed,
    Moves,
    MoveTo,
    Node,
    Quantity,
)
from gproof.ir.program import Binary, Expr, Number
from gproof.passes.legalize.context import Context
from gproof.passes.legalize.pattern import Pattern
from gproof.passes.legalize.row_places import positions


def _other_unit(context: Context) -> str:
    """The unit of the target that counts in its stead: mm, unless it has inches alone."""
    return "mm" if "unit_mm" in context.target.legal else "inch"


def _scaled(value: Expr, factor: float) -> Expr:
    if isinstance(value, Number):
        return Number(value.value * factor, value.span)
    return Binary("*", value, Number(factor, value.span), value.span)


def _converted(value: Any, old: str, new: str) -> Any:
    factor = MM[old] / MM[new]
    if isinstance(value, Quantity):
        return Quantity(_scaled(value.value, factor), new) if value.unit == old else value
    if isinstance(value, AxisPlace):
        return AxisPlace(value.axis, _converted(value.at, old, new), value.relative)
    if isinstance(value, Feed):
        return Feed(_converted(value.amount, old, new), value.per)
    if isinstance(value, tuple):
        return tuple(_converted(one, old, new) if isinstance(one, AxisPlace) else one for one in value)
    return value


def other_unit(node: Node, feature: str, context: Context) -> list[Node] | None:
    """Numbers in a unit that the target does not have, in one that it has."""
    old = feature.removeprefix("unit_")
    new = _other_unit(context)
    if new == old or old not in LENGTHS or f"unit_{new}" not in context.target.legal:
        return None
    if isinstance(node, Moves):
        factor = MM[old] / MM[new]
        arrays = dict(node.rows.arrays)
        to = arrays["to"].copy()
        to[:, :3] *= factor
        arrays |= {"to": to, "center": arrays["center"] * factor, "radius": arrays["radius"] * factor}
        if node.per != "move":
            arrays["feed"] = arrays["feed"] * factor
        return [replace(node, rows=Columns(MOVE, arrays), unit=new)]
    return [replace(node, **{f.name: _converted(getattr(node, f.name), old, new) for f in fields(node)})]


def absolute(node: Node, feature: str, context: Context) -> list[Node] | None:
    """Relative places as absolute ones, where it is known from where they count."""
    if isinstance(node, Moves):
        _, after = positions(node, context.place)
        named = np.array([(node.rows["axes"] & np.uint8(1 << column)) != 0 for column in range(6)]).T
        if np.isnan(after[named]).any():
            return None
        arrays = dict(node.rows.arrays)
        arrays["to"] = np.where(named, after, 0.0)
        return [replace(node, rows=Columns(MOVE, arrays), relative=False)]
    if not isinstance(node, MoveTo | ArcTo):
        return None
    places = []
    for place in node.to:
        if place.relative:
            before, by = context.place.get(place.axis), context.mm(place.at)
            if before is None or by is None:
                return None
            scale = MM.get(place.at.unit, 1.0)
            at = Quantity(Number((before + by) / scale, node.span), place.at.unit)
            places.append(AxisPlace(place.axis, at))
        else:
            places.append(place)
    return [replace(node, to=tuple(places))]


PATTERNS = (
    Pattern(name="unit -> another unit", removes=("unit_cm", "unit_inch"), apply=other_unit),
    Pattern(name="relative places -> absolute places", removes=("relative",), apply=absolute),
)
