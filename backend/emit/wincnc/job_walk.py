"""Jobs as a printer of WinCNC walks them: the feed that a file starts with, zeros that the end of a file brings back.

Manual: M Codes: M98; L Codes: L92; G Codes: G92.3.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import Protocol

import numpy as np

from gproof.backend.emit.printer import Unprintable
from gproof.ir.job import (
    AxisPlace,
    Choice,
    CountLoop,
    EndJob,
    Feed,
    Job,
    LoopWhile,
    Moves,
    MoveTo,
    Node,
    Nodes,
    Remark,
    RepeatGrid,
    RunRoutine,
    SetFrame,
    walk,
)
from gproof.ir.machine import AXIS_NAMES
from gproof.ir.program import Expr, Number

ZERO = ("local_here", "zero_at", "zero_shift", "zero_keep", "zero_recall")
Rate = tuple[float, str, str]
"""A feed: number, unit, what it is per."""
OPEN_FEED: Rate = (-1.0, "", "")
"""In place of a feed that depends on the way that the program took."""


class Walked(Protocol):
    """entries: the feed that each routine starts with; exits: the one after it, by both."""

    job: Job
    entries: dict[str, Rate | None]
    exits: dict[tuple[str, Rate | None], Rate | None]


def number(value: Expr) -> float:
    """The number of a literal; Unprintable for an expression."""
    if isinstance(value, Number):
        return value.value
    raise Unprintable("an expression")


def bits(places: Iterable[AxisPlace]) -> int:
    """The columns of places as bits."""
    return sum(1 << AXIS_NAMES.index(place.axis) for place in places)


def rate_of(feed: Feed) -> Rate:
    """A feed as numbers."""
    return number(feed.amount.value), feed.amount.unit, feed.per


def own_zero(body: Nodes) -> tuple[Nodes, bool]:
    """(a body without what the end of a file does by itself, whether it leaves a zero behind) [L92]."""
    found = [node for node in walk(body) if isinstance(node, SetFrame) and node.action in ZERO]
    if not found:
        return body, False
    last = max((place for place, node in enumerate(body) if not isinstance(node, Remark | EndJob)), default=0)
    end = body[last]
    if isinstance(end, SetFrame) and end.action == "zero_recall" and end.number is not None and number(end.number) < 0:
        return (*body[:last], *body[last + 1 :]), False
    first = body[0]
    if not (isinstance(first, SetFrame) and first.action == "zero_keep" and first.number is not None):
        return body, True
    kept = number(first.number)

    def is_back(node: Node) -> bool:
        recall = isinstance(node, SetFrame) and node.action == "zero_recall" and node.number is not None
        return recall and isinstance(node, SetFrame) and number(node.number or Number(-1.0, node.span)) == kept

    backs = [node for node in walk(body) if is_back(node)]
    if len(backs) == 1 and is_back(body[last]):
        return (*body[1:last], *body[last + 1 :]), False
    return body, True


def kept_before(body: Nodes) -> Nodes:
    """A body in which G92.3 puts the zero away before the job moves it, where it is brought back later (number -1)."""
    found: list[Node] = []
    moved: int | None = None
    for node in body:
        if isinstance(node, SetFrame) and node.action in ZERO:
            back = node.action == "zero_recall" and node.number is not None and number(node.number) < 0
            if back and moved is not None:
                found.insert(moved, SetFrame(action="zero_keep", number=node.number, span=found[moved].span))
            if moved is None and not back:
                moved = len(found)
            moved = None if back else moved
        found.append(node)
    return tuple(found)


def shifted_back(body: Nodes, job: Job) -> Nodes:
    """A body in which a zero that is kept and stays in force comes back by the shifts that it had: G92.3 takes the zero
    that it puts away out of force. Unprintable where it had others."""
    found = list(body)
    for place, node in enumerate(body):
        if not _is_plain(node, "zero_keep"):
            continue
        end = next((n for n in range(place + 1, len(body)) if _is_plain(body[n], "zero_recall")), None)
        between = [one for one in body[place + 1 : end] if isinstance(one, SetFrame) and one.action in ZERO]
        if end is None or (between and between[0].action == "zero_at"):
            continue
        if _all_zeros(body[place + 1 : end], job) > len(between) or any(one.action != "zero_shift" for one in between):
            raise Unprintable("a work zero that is kept and stays in force")
        found[place] = found[end] = Remark(text="", span=node.span)
        back = [replace(one, at=replace(one.at, value=_minus(one.at.value))) for zero in between for one in zero.places]
        if back:
            found[end] = SetFrame(action="zero_shift", places=_summed(back), span=body[end].span)
    return tuple(node for node in found if not (isinstance(node, Remark) and not node.text))


def _is_plain(node: Node, action: str) -> bool:
    return isinstance(node, SetFrame) and node.action == action and node.number is None


def _minus(value: Expr) -> Expr:
    return Number(-number(value), value.span)


def _summed(places: Iterable[AxisPlace]) -> tuple[AxisPlace, ...]:
    """One place for each axis; Unprintable for two units of one axis."""
    found: dict[str, AxisPlace] = {}
    for place in places:
        before = found.get(place.axis)
        if before is None:
            found[place.axis] = place
        elif before.at.unit != place.at.unit:
            raise Unprintable("shifts of the work zero in two units")
        else:
            value = Number(number(before.at.value) + number(place.at.value), place.at.value.span)
            found[place.axis] = replace(place, at=replace(place.at, value=value))
    return tuple(found.values())


def _all_zeros(nodes: Nodes, job: Job) -> int:
    """How many operations on the zero are in these, and in the routines that they run."""
    count, seen, todo = 0, set[str](), [nodes]
    while todo:
        for node in walk(todo.pop()):
            count += isinstance(node, SetFrame) and node.action in ZERO
            if isinstance(node, RunRoutine) and node.name not in seen:
                seen.add(node.name)
                todo.append(job.routines[node.name].body)
    return count


def zeros_for_a_while(nodes: Nodes) -> list[Node]:
    """Zeros at machine places of some axes, between a zero that is kept and brought back, while no other axis moves:
    for these it does not matter that G92.3 puts their zeros away too."""
    found: list[Node] = []
    kept = False
    start: SetFrame | None = None
    for node in nodes:
        if isinstance(node, SetFrame) and node.action in ZERO:
            if start is not None and node.action == "zero_recall":
                found.append(start)
            start = node if kept and node.action == "zero_at" else None
            kept = node.action == "zero_keep"
        elif start is not None and not isinstance(node, Remark) and not _moves_only(node, bits(start.places)):
            start = None
    return found


def _moves_only(node: Node, columns: int) -> bool:
    """Whether an operation moves axes of these columns, and no others."""
    if isinstance(node, Moves):
        return not int(np.bitwise_or.reduce(node.rows["axes"])) & ~columns
    return isinstance(node, MoveTo) and not bits(node.to) & ~columns


def feed_after(body: Nodes, feed: Rate | None, writer: Walked) -> Rate | None:
    """The feed in force after operations; what routines start with is noted. None: the program has given none yet."""
    for node in body:
        if isinstance(node, Moves):
            given = np.flatnonzero(~np.isnan(node.rows["feed"]))
            if len(given):
                feed = float(node.rows["feed"][int(given[-1])]), node.unit, node.per
        elif isinstance(node, RunRoutine):
            known = writer.entries.get(node.name, feed)
            writer.entries[node.name] = feed if known == feed else OPEN_FEED
            key = node.name, feed
            if key not in writer.exits:
                writer.exits[key] = None
                writer.exits[key] = feed_after(writer.job.routines[node.name].body, feed, writer)
            feed = writer.exits[key]
        elif isinstance(node, Choice):
            ways = {feed_after(part, feed, writer) for part in (node.then, node.otherwise)}
            feed = ways.pop() if len(ways) == 1 else OPEN_FEED
        elif isinstance(node, RepeatGrid | LoopWhile | CountLoop):
            after = feed_after(node.body, feed, writer)
            if after != feed:
                feed_after(node.body, OPEN_FEED, writer)
                feed = OPEN_FEED
        else:
            own = getattr(node, "feed", None)
            if isinstance(own, Feed):
                feed = rate_of(own)
    return feed
