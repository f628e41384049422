"""Arrays of rows and columns -> the cells one after the other, with a rapid to each."""

from __future__ import annotations

from gproof.ir.job import (
    AxisPlace,
    Choice,
    MoveTo,
    Node,
    Nodes,
    Quantity,
    Remark,
    RepeatGrid,
    RunRoutine,
    SetFrame,
    walk,
)
from gproof.ir.program import Number
from gproof.passes.legalize.context import Context
from gproof.passes.legalize.pattern import Pattern


def cells(node: Node, feature: str, context: Context) -> list[Node] | None:
    """The cells of an array whose distances are numbers, and whose first place is known."""
    if not isinstance(node, RepeatGrid):
        return None
    dx, dy = context.mm(node.dx), context.mm(node.dy)
    start = _start_after(node, context)
    if dx is None or dy is None or start is None:
        return None
    names, x, y = start
    many = [(row, column) for row in range(node.rows) for column in range(node.columns)]
    if not node.by_rows:
        many.sort(key=lambda cell: (cell[1], cell[0]))
    found: list[Node] = []
    before = (0, 0)
    for row, column in [*many, *([(0, 0)] if node.back else [])]:
        last = len(found) and (row, column) == (0, 0)
        if found and len(many) > 1:
            if x is None or y is None:
                return None
            # A cell that names its own start is where the next one counts from.
            from_row, from_column = before if names else (0, 0)
            to = (_at("x", x + (column - from_column) * dx, node), _at("y", y + (row - from_row) * dy, node))
            found.append(MoveTo(to=to, kind="rapid", span=node.span))
        if not last:
            found += node.body
            before = row, column
    context.spend(len(found))
    return found


def _start_after(node: RepeatGrid, context: Context) -> tuple[bool, float | None, float | None] | None:
    """(whether each cell names its start, X and Y of a cell's start in the numbers that are in force after the cell);
    None where the cell moves the zero otherwise."""
    here = {"x": context.place.get("x"), "y": context.place.get("y")}
    names = False
    for place, one in enumerate(_operations(node.body)):
        if isinstance(one, RunRoutine | Choice) and _moves_zero(one, context):
            return None
        if not isinstance(one, SetFrame):
            continue
        values = {p.axis: context.mm(p.at) for p in one.places if p.axis in here}
        if one.action == "local_here" and place == 0 and set(values) == {"x", "y"}:
            names = True
            here = values
        elif one.action == "zero_shift" and all(value is not None for value in values.values()):
            for axis, value in values.items():
                before = here[axis]
                here[axis] = None if before is None or value is None else before - value
        else:
            return None
    return names, here["x"], here["y"]


def _operations(body: Nodes) -> list[Node]:
    return [one for one in body if not isinstance(one, Remark)]


def _moves_zero(node: Node, context: Context) -> bool:
    """Whether an operation, or what it runs, may move the zero."""
    nodes = context.routine_nodes(node.name) if isinstance(node, RunRoutine) else walk((node,))
    return any(isinstance(one, SetFrame) or (isinstance(one, RunRoutine) and one is not node) for one in nodes)


def _at(axis: str, mm: float, node: RepeatGrid) -> AxisPlace:
    return AxisPlace(axis, Quantity(Number(mm, node.span), "mm"))


PATTERNS: tuple[Pattern, ...] = (Pattern(name="array -> its cells", removes=("grid",), apply=cells, unrolls=True),)
