"""Relative places rounded so that what each leaves out is made up for by the next one.

A number has only so many decimals. Printed one by one, relative places would take the axes further from where the job
goes with every move, by half of the last digit each time; here a place is never further off than that. What an
absolute place leaves out is made up for by the relative one after it. In a loop or a subprogram, which may start
anywhere and comes again, nothing is carried in, and places have more digits.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from gproof.backend.emit.job_numbers import decimals_of
from gproof.ir.columns import Columns
from gproof.ir.job import (
    MM,
    MOVE,
    ArcTo,
    AxisPlace,
    Choice,
    CountLoop,
    DrillHole,
    HomeAxes,
    Job,
    LoopWhile,
    Mark,
    Moves,
    MoveTo,
    Node,
    Nodes,
    OptionalPart,
    ParkAt,
    Quantity,
    RepeatGrid,
    RunRoutine,
    walk,
)
from gproof.ir.machine import AXIS_NAMES
from gproof.ir.program import Number
from gproof.ir.target import Style

MOST_DECIMALS = 8
"""With more, a sum of float64 has no more digits than what is printed."""

Rest = dict[str, float]
"""By axis the mm or degrees that the printed places are short of those of the job."""


def carried(job: Job, style: Style) -> Job:
    """The job with relative places as they are to be printed. Absolute ones are left to the printer."""
    if max(style.decimals_mm, style.decimals_inch, style.decimals_deg) > MOST_DECIMALS or not _is_relative(job):
        return job
    routines = {name: replace(one, body=_body(one.body, {}, style, again=True)) for name, one in job.routines.items()}
    return replace(job, body=_body(job.body, {}, style, again=False), routines=routines)


def _is_relative(job: Job) -> bool:
    for body in (job.body, *(routine.body for routine in job.routines.values())):
        for node in walk(body):
            if isinstance(node, Moves) and node.relative:
                return True
            if isinstance(node, MoveTo | ArcTo) and any(place.relative for place in node.to):
                return True
    return False


def _body(nodes: Nodes, rest: Rest, style: Style, *, again: bool) -> Nodes:
    """A list of operations; ``rest`` is that before it, and then that after it. again: they may be run again."""
    found: list[Node] = []
    for node in nodes:
        if isinstance(node, Moves):
            found.append(_moves(node, rest, style, again=again))
        elif isinstance(node, MoveTo | ArcTo):
            found.append(replace(node, to=tuple(_place(place, rest, style, again=again) for place in node.to)))
        elif isinstance(node, Choice):
            ways = []
            rests = [dict(rest), dict(rest)]
            for way, own in zip((node.then, node.otherwise), rests, strict=True):
                ways.append(_body(way, own, style, again=again))
            found.append(replace(node, then=ways[0], otherwise=ways[1]))
            rest.clear()
            rest.update({axis: by for axis, by in rests[0].items() if rests[1].get(axis) == by})
        elif isinstance(node, OptionalPart | LoopWhile | CountLoop | RepeatGrid):
            found.append(
                replace(node, body=_body(node.body, {}, style, again=not isinstance(node, OptionalPart) or again))
            )
            rest.clear()
        else:
            if isinstance(node, RunRoutine | Mark | HomeAxes | ParkAt | DrillHole):
                rest.clear()
            found.append(node)
    return tuple(found)


def _place(place: AxisPlace, rest: Rest, style: Style, *, again: bool) -> AxisPlace:
    value, unit = place.at.value, place.at.unit
    if not isinstance(value, Number):
        if not place.relative:
            rest.pop(place.axis, None)
        return place
    scale, decimals = MM.get(unit, 1.0), decimals_of(style, unit, summed=again and place.relative)
    short = rest.get(place.axis, 0.0) / scale if place.relative else 0.0
    # What does not move an axis stays so: a full circle ends where it starts.
    printed = float(np.round(value.value + short, decimals)) + 0.0 if value.value or not place.relative else 0.0
    rest[place.axis] = (value.value + short - printed) * scale
    if not place.relative:
        return place
    return AxisPlace(place.axis, Quantity(Number(printed, value.span), unit), relative=True)


def _moves(node: Moves, rest: Rest, style: Style, *, again: bool) -> Moves:
    to = node.rows["to"]
    new = to.copy() if node.relative else to
    for column, axis in enumerate(AXIS_NAMES):
        named = np.flatnonzero(node.rows["axes"] & np.uint8(1 << column))
        if not len(named):
            continue
        unit = node.unit if column < 3 else "deg"
        scale, decimals = MM.get(unit, 1.0), decimals_of(style, unit, summed=again and node.relative)
        if not node.relative:
            last = float(to[named[-1], column])
            rest[axis] = (last - float(np.round(last, decimals))) * scale
            continue
        short = rest.get(axis, 0.0) / scale
        exact = np.cumsum(to[named, column])
        printed = np.where(exact == 0.0, 0.0, np.round(exact + short, decimals))
        new[named, column] = np.round(np.diff(printed, prepend=0.0), decimals) + 0.0
        rest[axis] = float(exact[-1] + short - printed[-1]) * scale
    return replace(node, rows=Columns(MOVE, node.rows.arrays | {"to": new})) if node.relative else node
