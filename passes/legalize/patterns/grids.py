"""Arrays of rows and columns -> the cells one after the other, with a rapid to each."""

from __future__ import annotations

from gproof.ir.job import AxisPlace, MoveTo, Node, Quantity, RepeatGrid
from gproof.ir.program import Number
from gproof.passes.legalize.context import Context
from gproof.passes.legalize.pattern import Pattern


def cells(node: Node, feature: str, context: Context) -> list[Node] | None:
    """The cells of an array whose distances are numbers, and whose first place is known."""
    if not isinstance(node, RepeatGrid):
        return None
    dx, dy = context.mm(node.dx), context.mm(node.dy)
    x, y = context.place.get("x"), context.place.get("y")
    if dx is None or dy is None:
        return None
    many = [(row, column) for row in range(node.rows) for column in range(node.columns)]
    if not node.by_rows:
        many.sort(key=lambda cell: (cell[1], cell[0]))
    found: list[Node] = []
    for row, column in [*many, *([(0, 0)] if node.back else [])]:
        last = len(found) and (row, column) == (0, 0)
        if found and len(many) > 1:
            if x is None or y is None:
                return None
            to = (_at("x", x + column * dx, node), _at("y", y + row * dy, node))
            found.append(MoveTo(to=to, kind="rapid", span=node.span))
        if not last:
            found += node.body
    context.spend(len(found))
    return found


def _at(axis: str, mm: float, node: RepeatGrid) -> AxisPlace:
    return AxisPlace(axis, Quantity(Number(mm, node.span), "mm"))


PATTERNS: tuple[Pattern, ...] = (Pattern(name="array -> its cells", removes=("grid",), apply=cells, unrolls=True),)
