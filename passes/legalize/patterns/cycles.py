"""Drilling cycles -> cycles that the target has, or the moves that they make."""

from __future__ import annotations

from dataclasses import replace

from gproof.ir.finding import Span
from gproof.ir.job import (
    MM,
    AxisPlace,
    DrillHole,
    DwellFor,
    MoveTo,
    Node,
    Quantity,
    SetFeed,
    TurnSpindle,
)
from gproof.ir.program import Number
from gproof.passes.legalize.context import Context
from gproof.passes.legalize.pattern import Pattern

MOST_PECKS = 1000
SAME_DEPTH = 1e-9
"""mm."""


def single_holes(node: Node, feature: str, context: Context) -> list[Node] | None:
    """A hole that repeats, as so many holes."""
    if not isinstance(node, DrillHole) or node.repeats is None:
        return None
    count = context.value(node.repeats)
    if count is None or count != round(count) or count < 1:
        return None
    context.spend(round(count))
    if not node.top.relative:
        return [replace(node, repeats=None)] * round(count)
    # The heights stay those of the first one.
    top, depth = _at(node.top, context), context.mm(node.bottom.at)
    if top is None or depth is None:
        return None
    bottom = top + depth if node.bottom.relative else depth
    hole = replace(node, repeats=None, top=_place(node.top, top), bottom=_place(node.bottom, bottom))
    return [hole] * round(count)


def absolute_hole(node: Node, feature: str, context: Context) -> list[Node] | None:
    """Relative places of a hole as absolute ones."""
    if not isinstance(node, DrillHole):
        return None
    at = []
    for place in node.at:
        value = _at(place, context)
        if value is None:
            return None
        at.append(_place(place, value))
    top, depth = _at(node.top, context), context.mm(node.bottom.at)
    if top is None or depth is None:
        return None
    bottom = top + depth if node.bottom.relative else depth
    return [replace(node, at=tuple(at), top=_place(node.top, top), bottom=_place(node.bottom, bottom))]


def _at(place: AxisPlace, context: Context) -> float | None:
    value = context.mm(place.at)
    if value is None or not place.relative:
        return value
    before = context.place.get(place.axis)
    return None if before is None else before + value


def _place(place: AxisPlace, value: float) -> AxisPlace:
    scale = MM.get(place.at.unit, 1.0)
    return AxisPlace(place.axis, Quantity(Number(value / scale, place.at.value.span), place.at.unit))


def back_to_the_top(node: Node, feature: str, context: Context) -> list[Node] | None:
    """A hole that ends at its top, and from there to the height before it, where that is known."""
    if not isinstance(node, DrillHole) or node.top.relative or node.repeats is not None:
        return None
    top, before = context.mm(node.top.at), context.place.get(node.top.axis)
    if top is None or before is None:
        return None
    hole = replace(node, back="top")
    if before > top and node.kind == "peck":
        # Between pecks the tool is at the height that the cycle goes back to.
        return None
    if before > top and node.kind == "bore_stop":
        return None  # the spindle starts again at the height before the hole
    if before > top:
        kind = "feed" if node.kind in {"bore", "bore_dwell"} else "rapid"
        return [hole, MoveTo(to=(_place(node.top, before),), kind=kind, span=node.span)]
    if before < top:
        # The cycle lifts to its top before it goes to the hole.
        return [MoveTo(to=(_place(node.top, top),), kind="rapid", span=node.span), hole]
    return [hole]


def moves(node: Node, feature: str, context: Context) -> list[Node] | None:
    """The moves of a cycle whose heights are known."""
    if not isinstance(node, DrillHole) or node.repeats is not None or node.kind.startswith("tap"):
        return None
    if node.top.relative or any(place.relative for place in node.at):
        return None
    top, bottom = context.mm(node.top.at), context.mm(node.bottom.at)
    before = context.place.get(node.top.axis)
    if top is None or bottom is None:
        return None
    if before is None or (node.kind == "bore_stop" and context.spindle not in {"cw", "ccw"}):
        return None
    clear = top if node.back == "top" else max(before, top)
    maker = _Hole(node, context, top, bottom, clear)
    if before < top:
        maker.rapid(top)
        before = top
    if node.at:
        maker.found.append(MoveTo(to=node.at, kind="rapid", span=node.span))
    if before != top:
        maker.rapid(top)
    if not maker.down():
        return None
    maker.up()
    if node.feed is not None:
        maker.found.insert(0, SetFeed(feed=node.feed, span=node.span))
    return maker.found


class _Hole:
    """The moves of one hole. top, bottom: mm; clear: where the tool is after it, and between pecks."""

    def __init__(self, node: DrillHole, context: Context, top: float, bottom: float, clear: float) -> None:
        self.node = node
        self.context = context
        self.top = top
        self.bottom = bottom
        self.clear = clear
        self.found: list[Node] = []
        self.span: Span = node.span

    def rapid(self, height: float) -> None:
        """Along the axis of the hole."""
        self.found.append(MoveTo(to=(_place(self.node.top, height),), kind="rapid", span=self.span))

    def feed(self, height: float) -> None:
        """The same with feed."""
        self.found.append(MoveTo(to=(_place(self.node.top, height),), kind="feed", span=self.span))

    def down(self) -> bool:
        """From the top to the bottom; whether the kind and its numbers are known."""
        node = self.node
        if node.kind in {"peck", "chip_break"}:
            return self._pecks()
        self.feed(self.bottom)
        if node.kind in {"dwell", "bore_dwell", "bore_stop"}:
            if node.dwell is None:
                return False
            self.found.append(DwellFor(time=node.dwell, span=self.span))
        return True

    def _pecks(self) -> bool:
        peck = None if self.node.peck is None else self.context.mm(self.node.peck)
        clearance = None if self.node.clearance is None else self.context.mm(self.node.clearance)
        if peck is None or peck <= 0.0 or clearance is None:
            return False
        lift = None if self.node.lift is None else self.context.mm(self.node.lift)
        if self.node.lift is not None and lift is None:
            return False
        clearance = min(clearance, peck)
        depth, count = self.top, 0
        while True:
            # A bottom that whole pecks reach in decimals is reached, whatever binary fractions say.
            depth = depth - peck if depth - peck > self.bottom + SAME_DEPTH else self.bottom
            self.feed(depth)
            count += 1
            if depth <= self.bottom or count > MOST_PECKS:
                break
            near = min(depth + clearance, self.top)
            if self.node.kind == "peck":
                self.rapid(self.clear)
            elif lift is not None and min(depth + lift, self.top) != near:
                self.rapid(min(depth + lift, self.top))
            self.rapid(near)
        self.context.spend(3 * count)
        if self.node.dwell is not None:
            self.found.append(DwellFor(time=self.node.dwell, span=self.span))
        return count <= MOST_PECKS

    def up(self) -> None:
        """Out of the hole."""
        node = self.node
        if node.kind in {"bore", "bore_dwell"}:
            self.feed(self.clear)
        elif node.kind == "bore_stop":
            self.found.append(TurnSpindle(direction="off", span=self.span))
            self.rapid(self.clear)
            self.found.append(TurnSpindle(direction=self.context.spindle, span=self.span))
        else:
            self.rapid(self.clear)


_ALL = (
    "cycle_return", "cycle_straight", "cycle_peck_dwell", "cycle_plane", "cycle_relative", "cycle_clearance",
    "cycle_drill", "cycle_dwell", "cycle_peck", "cycle_chip_break",
    "cycle_bore", "cycle_bore_dwell", "cycle_bore_stop",
)  # fmt: skip

PATTERNS = (
    Pattern(name="repeated hole -> single holes", removes=("cycle_repeats",), apply=single_holes),
    Pattern(name="relative hole -> absolute hole", removes=("cycle_relative",), apply=absolute_hole),
    Pattern(name="hole that returns -> hole, and back", removes=("cycle_return",), apply=back_to_the_top),
    Pattern(name="drilling cycle -> moves", removes=_ALL, apply=moves),
)
