"""Mistakes for the neutral job of a program, as a wrong raising would make them."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any

import numpy as np

from gproof.ir import job as j
from gproof.ir.columns import Columns
from gproof.ir.program import Number

Mistake = Callable[[Any], Any]
"""A node as a wrong raising has it; the node itself where the mistake does not touch it; None: it is lost."""


def planted(job: j.Job, mistake: Mistake) -> j.Job:
    """A job with a mistake wherever it fits."""
    routines = {
        name: dataclasses.replace(routine, body=_all(routine.body, mistake)) for name, routine in job.routines.items()
    }
    return dataclasses.replace(job, body=_all(job.body, mistake), routines=routines)


def _all(nodes: tuple[Any, ...], mistake: Mistake) -> tuple[Any, ...]:
    found = []
    for node in nodes:
        inside = {
            name: _all(value, mistake)
            for name in ("body", "then", "otherwise")
            if isinstance(value := getattr(node, name, None), tuple)
        }
        made = mistake(dataclasses.replace(node, **inside) if inside else node)
        if made is not None:
            found.append(made)
    return tuple(found)


def _rows(node: j.Moves, **columns: Callable[[Any], Any]) -> j.Moves:
    arrays = dict(node.rows.arrays)
    for name, change in columns.items():
        arrays[name] = change(arrays[name].copy())
    return dataclasses.replace(node, rows=Columns(j.MOVE, arrays))


def _turned(kind: Any) -> Any:
    return np.where(kind == j.ARC_CW, j.ARC_CCW, np.where(kind == j.ARC_CCW, j.ARC_CW, kind)).astype(np.uint8)


def other_sense(node: Any) -> Any:
    if isinstance(node, j.ArcTo):
        return dataclasses.replace(node, clockwise=not node.clockwise)
    return _rows(node, kind=_turned) if isinstance(node, j.Moves) and (node.rows["kind"] >= j.ARC_CW).any() else node


def dwell_a_thousand_times(node: Any) -> Any:
    if not isinstance(node, j.DwellFor) or node.time.unit != "s" or not isinstance(node.time.value, Number):
        return node
    return dataclasses.replace(node, time=dataclasses.replace(node.time, unit="ms"))


def dwell_lost(node: Any) -> Any:
    return None if isinstance(node, j.DwellFor) else node


def places_for_distances(node: Any) -> Any:
    if isinstance(node, j.Moves):
        return dataclasses.replace(node, relative=not node.relative)
    if isinstance(node, j.MoveTo | j.ArcTo):
        to = tuple(dataclasses.replace(place, relative=not place.relative) for place in node.to)
        return dataclasses.replace(node, to=to)
    return node


def inches(node: Any) -> Any:
    if isinstance(node, j.Moves):
        return dataclasses.replace(node, unit="inch" if node.unit == "mm" else "mm")
    if isinstance(node, j.MoveTo | j.ArcTo):
        to = tuple(
            dataclasses.replace(place, at=dataclasses.replace(place.at, unit="inch" if place.at.unit == "mm" else "mm"))
            for place in node.to
        )
        return dataclasses.replace(node, to=to)
    return node


def frame_lost(node: Any) -> Any:
    return None if isinstance(node, j.SetFrame) else node


def frame_sign(node: Any) -> Any:
    if not isinstance(node, j.SetFrame) or not node.places:
        return node
    places = tuple(
        dataclasses.replace(place, at=dataclasses.replace(place.at, value=Number(-place.at.value.value, node.span)))
        if isinstance(place.at.value, Number)
        else place
        for place in node.places
    )
    return dataclasses.replace(node, places=places)


def machine_for_work(node: Any) -> Any:
    if not isinstance(node, j.MoveTo):
        return node
    return dataclasses.replace(node, frame="work" if node.frame == "machine" else "machine")


def rapid_for_feed(node: Any) -> Any:
    if isinstance(node, j.MoveTo) and node.kind == "feed":
        return dataclasses.replace(node, kind="rapid", feed=None)
    if isinstance(node, j.MoveTo) and node.kind == "rapid":
        return dataclasses.replace(node, kind="feed")
    return node


def feed_sixty_times(node: Any) -> Any:
    if isinstance(node, j.Moves):
        return _rows(node, feed=lambda feed: feed * 60.0)
    feed = getattr(node, "feed", None)
    if feed is None or not isinstance(feed.amount.value, Number):
        return node
    amount = dataclasses.replace(feed.amount, value=Number(feed.amount.value.value * 60.0, node.span))
    return dataclasses.replace(node, feed=dataclasses.replace(feed, amount=amount))


def next_channel(node: Any) -> Any:
    if not isinstance(node, j.SwitchOutput | j.WaitFor) or not isinstance(node.channel, Number):
        return node
    return dataclasses.replace(node, channel=Number(node.channel.value + 1.0, node.span))


def off_for_on(node: Any) -> Any:
    if not isinstance(node, j.SwitchOutput) or not isinstance(node.value, Number):
        return node
    return dataclasses.replace(node, value=Number(1.0 - node.value.value, node.span))


def in_motion_for_at_rest(node: Any) -> Any:
    return dataclasses.replace(node, moving=not node.moving) if isinstance(node, j.SwitchOutput) else node


def output_lost(node: Any) -> Any:
    return None if isinstance(node, j.SwitchOutput) else node


def other_way_round(node: Any) -> Any:
    if not isinstance(node, j.TurnSpindle) or node.direction not in {"cw", "ccw"}:
        return node
    return dataclasses.replace(node, direction="ccw" if node.direction == "cw" else "cw")


def mist_for_flood(node: Any) -> Any:
    return dataclasses.replace(node, mist=node.flood, flood=node.mist) if isinstance(node, j.SwitchCoolant) else node


def stop_lost(node: Any) -> Any:
    return None if isinstance(node, j.PauseJob) else node


def tool_lost(node: Any) -> Any:
    return None if isinstance(node, j.ChangeTool) else node


def branches_exchanged(node: Any) -> Any:
    return dataclasses.replace(node, then=node.otherwise, otherwise=node.then) if isinstance(node, j.Choice) else node


def hole_back_elsewhere(node: Any) -> Any:
    if not isinstance(node, j.DrillHole):
        return node
    return dataclasses.replace(node, back="top" if node.back == "before" else "before")


def moves_lost(node: Any) -> Any:
    return None if isinstance(node, j.MoveTo | j.ArcTo | j.DrillHole) else node


MISTAKES: dict[str, Mistake] = {
    one.__name__.replace("_", "-"): one
    for one in (
        other_sense, dwell_a_thousand_times, dwell_lost, places_for_distances, inches, frame_lost, frame_sign,
        machine_for_work, rapid_for_feed, feed_sixty_times, next_channel, off_for_on, in_motion_for_at_rest,
        output_lost, other_way_round, mist_for_flood, stop_lost, tool_lost, branches_exchanged, hole_back_elsewhere,
        moves_lost,
    )
}  # fmt: skip
