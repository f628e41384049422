"""The axes that a job, or an operation, moves."""

from __future__ import annotations

import numpy as np

from gproof.ir.job import (
    ArcTo,
    DrillHole,
    DwellFor,
    Job,
    Moves,
    MoveTo,
    Node,
    ParkAt,
    Remark,
    SetFeed,
    SetFrame,
    SetVariable,
    SwitchCoolant,
    SwitchOutput,
    TurnSpindle,
    walk,
)
from gproof.ir.machine import AXIS_NAMES


def axes_of(job: Job) -> tuple[str, ...]:
    """The axes that a job moves, in their order."""
    found: set[str] = set()
    for body in (job.body, *(routine.body for routine in job.routines.values())):
        for node in walk(body):
            if isinstance(node, Moves):
                bits = int(np.bitwise_or.reduce(node.rows["axes"]))
                found |= {axis for column, axis in enumerate(AXIS_NAMES) if bits & (1 << column)}
            elif isinstance(node, MoveTo | ArcTo | ParkAt):
                found |= {place.axis for place in node.to}
            elif isinstance(node, DrillHole):
                found |= {node.top.axis, *(place.axis for place in node.at)}
    return tuple(axis for axis in AXIS_NAMES if axis in found)


def moved_by(node: Node) -> set[str]:
    """The axes that an operation may move."""
    if isinstance(node, MoveTo | ArcTo):
        return {place.axis for place in node.to}
    if isinstance(node, Moves):
        bits = int(np.bitwise_or.reduce(node.rows["axes"]))
        return {axis for column, axis in enumerate(AXIS_NAMES) if bits & (1 << column)}
    if isinstance(node, DrillHole):
        return {node.top.axis, *(place.axis for place in node.at)}
    quiet = (Remark, SetFeed, DwellFor, SwitchOutput, SwitchCoolant, TurnSpindle, SetFrame, SetVariable)
    return set() if isinstance(node, quiet) else set(AXIS_NAMES)
