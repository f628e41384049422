"""Straight rapids of several axes -> feed moves as fast as the axes that move allow.

Where the target's rapids of several axes are not straight, and straight ones are asked for (``--rapids straight``).

The feed in force before is said again after each, as F is modal.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from gproof.ir.columns import Array, Columns
from gproof.ir.finding import Span
from gproof.ir.job import MM, MOVE, RAPID, AxisPlace, DrillHole, Feed, Moves, MoveTo, Node, Quantity, SetFeed
from gproof.ir.machine import AXIS_NAMES
from gproof.ir.program import Number
from gproof.passes.legalize.context import Context
from gproof.passes.legalize.feeds import FeedInForce, goes_on
from gproof.passes.legalize.pattern import Pattern
from gproof.passes.legalize.patterns.machine_moves import NEEDED
from gproof.passes.legalize.row_places import positions

FEED_MOVE = RAPID + 1
DIGITS = 4
"""After the point, of rates."""
ASSUMED = "rapids that are written as feed moves may be as slow as the operator's override for feeds makes them"


def as_feed(node: Node, feature: str, context: Context) -> list[Node] | None:
    """A rapid, or those of a table."""
    if not _is_possible(context):
        return None
    if context.feed_lost and goes_on(node):
        context.why = "which feed is in force here is not known, and a rapid before it became a feed move: say F here"
        return None
    if isinstance(node, Moves):
        return _table(node, context)
    if not isinstance(node, MoveTo):
        return None
    if node.frame == "machine" and not _has_machine_feed(context):
        context.why = "moves in machine coordinates are rapids there, which are not straight: move one axis at a time"
        return None
    unit = next((place.at.unit for place in node.to if place.at.unit in MM), "mm")
    rate = _rate(
        [place.axis for place in node.to if node.frame == "machine" or not rests(place, context)], unit, context
    )
    if rate is None:
        return None
    before = context.feed
    if node.feed is not None:  # F of a rapid line counts from there on
        value = context.value(node.feed.amount.value)
        before = None if value is None else (value, node.feed.amount.unit, node.feed.per)
    after = _again(before, node.span, context)
    if after is None:
        return None
    context.assume(ASSUMED)
    move = replace(node, kind="feed", feed=Feed(Quantity(Number(rate, node.span), unit)))
    if before is None:
        context.losing.append(move)
    return [move, *after]


def rests(place: AxisPlace, context: Context) -> bool:
    """Whether an axis stays where it is on its way to a place of the frame in force."""
    value = context.mm(place.at)
    return value is not None and value == (0.0 if place.relative else context.place.get(place.axis))


def _has_machine_feed(context: Context) -> bool:
    """Whether the target has moves with feed in machine coordinates, or a zero that is put there and back."""
    legal = context.target.legal
    return "machine_feed" in legal or all(one in legal for one in NEEDED)


def _is_possible(context: Context) -> bool:
    if context.options.straight_rapids == "target":
        return True
    context.why = (
        "its path is not known to be straight on the controller that the job is for: move one axis at a time, "
        "or use G1, or leave out --rapids straight"
    )
    return False


def _rate(axes: list[str], unit: str, context: Context) -> float | None:
    """The fastest that all these axes can go, in a unit a minute."""
    for axis in axes:
        if axis not in context.options.rapid_rates:
            is_linear = axis in "xyz"
            what = f"the machine file gives no velocity of {axis.upper()}" if is_linear else "a rotary axis moves along"
            context.why = f"its rapids are not straight, and {what}: move one axis at a time"
            return None
    return float(np.floor(min(context.options.rapid_rates[axis] for axis in axes) / MM[unit] * 10**DIGITS) / 10**DIGITS)


def _again(before: FeedInForce | None, span: Span, context: Context) -> list[Node] | None:
    """The feed in force before, said again; nothing where there was none yet, or where it is not known."""
    if before is None or np.isnan(before[0]):
        return []
    value, unit, per = before
    if per != "minute":
        context.why = "its rapids are not straight, and feeds are no feeds a minute here"
        return None
    return [SetFeed(feed=Feed(Quantity(Number(value, span), unit), per), span=span)]


def _table(node: Moves, context: Context) -> list[Node] | None:
    rows = node.rows
    if node.per != "minute":
        context.why = "its rapids are not straight, and feeds are no feeds a minute here"
        return None
    found = straight_rows(node, context)
    rates = np.array([context.options.rapid_rates.get(axis, np.nan) for axis in AXIS_NAMES])
    moving = moving_axes(node, context)
    most = np.where(moving, rates, np.inf).min(axis=1)
    if np.isnan(most[found]).any():
        row = moving[found][np.isnan(most[found])][0]
        _rate([AXIS_NAMES[column] for column in np.flatnonzero(row).tolist()], node.unit, context)
        return None
    # The feed in force at each row: the last one that was given, in the table or before it.
    feed: Array = rows["feed"].copy()
    given = np.where(np.isnan(feed), -1, np.arange(len(rows)))
    np.maximum.accumulate(given, out=given)
    changed = np.cumsum(found)
    fed = np.flatnonzero(rows["kind"] != RAPID)
    lost = fed[changed[fed] > np.concatenate([[0], changed[fed][:-1]])] if len(fed) else fed
    ends_lost = bool(changed[-1] > (changed[fed[-1]] if len(fed) else 0))
    start, is_open = np.nan, False
    if (given[lost] < 0).any() or (ends_lost and given[-1] < 0):
        again = _again(context.feed, node.span, context)
        is_open = context.feed is None
        if again is None or (is_open and (given[lost] < 0).any()):
            context.why = context.why or "its rapids are not straight, and which feed counts after one is not known"
            return None
        if again and context.feed is not None:
            start = context.feed[0] * MM[context.feed[1]] / MM[node.unit]
    in_force = np.where(given >= 0, feed[np.maximum(given, 0)], start)
    feed[lost] = in_force[lost]
    rapid = np.floor(most / MM[node.unit] * 10**DIGITS) / 10**DIGITS
    kind = np.where(found, np.uint8(FEED_MOVE), rows["kind"])
    arrays = dict(rows.arrays) | {"kind": kind, "feed": np.where(found, rapid, feed)}
    context.assume(ASSUMED)
    table = replace(node, rows=Columns(MOVE, arrays))
    if is_open and ends_lost:
        context.losing.append(table)
    if not ends_lost or np.isnan(in_force[-1]):
        return [table]
    back = Feed(Quantity(Number(float(in_force[-1]), node.span), node.unit))
    return [table, SetFeed(feed=back, span=node.span)]


def moving_axes(node: Moves, context: Context) -> Array:
    """(rows, 6): whether a row may move an axis."""
    rows = node.rows
    named = np.array([(rows["axes"] & np.uint8(1 << column)) != 0 for column in range(len(AXIS_NAMES))]).T
    if node.relative:
        found: Array = named & (rows["to"] != 0.0)
        return found
    before, after = positions(node, context.place)
    found = named & ~(before == after)
    return found


def straight_rows(node: Moves, context: Context) -> Array:
    """The rows that are rapids of several axes."""
    found: Array = (node.rows["kind"] == RAPID) & (moving_axes(node, context).sum(axis=1) > 1)
    return found


def to_the_hole(node: Node, feature: str, context: Context) -> list[Node] | None:
    """The way of a cycle to its hole as a move before it, at the height at which the cycle goes there."""
    if not isinstance(node, DrillHole) or not _is_possible(context):
        return None
    if node.repeats is not None or node.top.relative or any(place.relative for place in node.at):
        return None
    top, before = context.mm(node.top.at), context.place.get(node.top.axis)
    if top is None or before is None or any(context.mm(place.at) is None for place in node.at):
        context.why = "its rapids are not straight, and from which height it moves to its hole is not known"
        return None
    there: list[Node] = [MoveTo(to=node.at, kind="rapid", span=node.span)]
    if before < top:
        scale = MM[node.top.at.unit]
        lift = AxisPlace(node.top.axis, Quantity(Number(top / scale, node.span), node.top.at.unit))
        there.insert(0, MoveTo(to=(lift,), kind="rapid", span=node.span))
    return [*there, node]


PATTERNS = (
    Pattern(
        name="drilling cycle -> a move to the hole before it", removes=("cycle_straight",), apply=to_the_hole,
        unrolls=True,
    ),
    Pattern(name="straight rapid -> feed move", removes=("rapid_straight",), apply=as_feed),
)  # fmt: skip
