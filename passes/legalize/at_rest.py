"""Outputs that motion does not stop for, at places where the axes rest all the same -> outputs that it stops for.

There both are the same, and a target may have only one of them, or want a motion after the other. The axes rest at the
start and the end of a job and at operations that stop motion, in some languages also where the zero changes after a
move with feed.
"""

from __future__ import annotations

from dataclasses import replace

from gproof.ir.job import (
    RAPID,
    ArcTo,
    ChangeTool,
    Choice,
    CountLoop,
    DrillHole,
    DwellFor,
    EndJob,
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
    PauseJob,
    Remark,
    RepeatGrid,
    RunRoutine,
    SetFeed,
    SetFrame,
    SetVariable,
    ShowText,
    SwitchCoolant,
    SwitchOutput,
    TurnSpindle,
    WaitFor,
    bodies,
)

_RESTS = (DwellFor, PauseJob, ChangeTool, SwitchCoolant, WaitFor, HomeAxes, EndJob)
_QUIET = (Remark, SetFeed, SetVariable, ShowText)
"""Operations that neither move an axis nor stop one."""


def at_rest(job: Job, *, before: bool, zeros: bool) -> Job:
    """The job with such outputs. before: also where the axes rest before the output and move after it, which the target
    does all the same where an operation stops motion, but not where ``zeros`` alone does: motion with feed stops where
    the zero changes."""
    routines = {name: replace(one, body=_list(one.body, zeros, before)) for name, one in job.routines.items()}
    body = _list(job.body, zeros, before, whole=True)
    return Job(source=job.source, files=job.files, body=body, routines=routines)


def _list(nodes: Nodes, zeros: bool, before: bool, *, whole: bool = False) -> Nodes:
    found = [_inside(node, zeros, before) for node in nodes]
    fed = _after_feed(found) if zeros else [False] * len(found)
    for order, wanted in ((reversed(range(len(found))), True), (iter(range(len(found))), before)):
        rests = whole and wanted
        for place in order if wanted or zeros else ():
            node = found[place]
            if isinstance(node, SwitchOutput) and node.moving:
                found[place] = replace(node, moving=False) if rests else node
            elif not isinstance(node, _QUIET) and not _is_speed(node):
                rests = (wanted and _stops(node)) or (fed[place] and isinstance(node, SetFrame))
    return tuple(found)


def _after_feed(nodes: list[Node]) -> list[bool]:
    """For each operation whether the last motion before it was certainly one with feed."""
    found, fed = [], False
    for node in nodes:
        found.append(fed)
        if isinstance(node, Moves):
            fed = int(node.rows["kind"][-1]) != RAPID
        elif isinstance(node, MoveTo):
            fed = node.kind == "feed"
        elif isinstance(node, ArcTo):
            fed = True
        elif bodies(node) or isinstance(node, DrillHole | RunRoutine | Mark | ParkAt | HomeAxes):
            fed = False
    return found


def _is_speed(node: Node) -> bool:
    return isinstance(node, TurnSpindle) and node.direction == "speed"


def _stops(node: Node) -> bool:
    """Whether the axes rest at an operation."""
    if isinstance(node, _RESTS):
        return True
    return isinstance(node, TurnSpindle) or (isinstance(node, SwitchOutput) and not node.moving)


def _inside(node: Node, zeros: bool, before: bool) -> Node:
    if isinstance(node, Choice):
        then, otherwise = (_list(part, zeros, before) for part in (node.then, node.otherwise))
        return replace(node, then=then, otherwise=otherwise)
    if isinstance(node, OptionalPart | LoopWhile | CountLoop | RepeatGrid):
        return replace(node, body=_list(node.body, zeros, before))
    return node
