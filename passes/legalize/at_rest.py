"""Outputs that do not stop motion, next to a dwell or a stop: the axes rest there anyway, so that they may stop it."""

from __future__ import annotations

from dataclasses import replace

from gproof.ir.job import (
    Choice,
    CountLoop,
    DwellFor,
    Job,
    LoopWhile,
    Node,
    Nodes,
    OptionalPart,
    PauseJob,
    Remark,
    RepeatGrid,
    SetVariable,
    ShowText,
    SwitchOutput,
    WaitFor,
)

_QUIET = (Remark, SwitchOutput, SetVariable, ShowText)
"""What moves nothing, and takes no time."""
_RESTS = (DwellFor, PauseJob, WaitFor)


def at_rest(job: Job) -> Job:
    """The job with outputs that stop motion where it is at rest."""
    routines = {name: replace(one, body=_list(one.body)) for name, one in job.routines.items()}
    return Job(source=job.source, files=job.files, body=_list(job.body), routines=routines)


def _list(nodes: Nodes) -> Nodes:
    return tuple(_one(nodes, place) for place in range(len(nodes)))


def _one(nodes: Nodes, place: int) -> Node:
    node = nodes[place]
    if isinstance(node, Choice):
        return replace(node, then=_list(node.then), otherwise=_list(node.otherwise))
    if isinstance(node, OptionalPart | LoopWhile | CountLoop | RepeatGrid):
        return replace(node, body=_list(node.body))
    if isinstance(node, SwitchOutput) and node.moving and (_next(nodes, place, 1) or _next(nodes, place, -1)):
        return replace(node, moving=False)
    return node


def _next(nodes: Nodes, place: int, step: int) -> bool:
    """Whether the first operation that counts, before or after, is one for which the axes rest."""
    at = place + step
    while 0 <= at < len(nodes) and isinstance(nodes[at], _QUIET):
        at += step
    return 0 <= at < len(nodes) and isinstance(nodes[at], _RESTS)
