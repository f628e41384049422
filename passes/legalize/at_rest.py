"""Outputs that motion does not stop for, at places where the axes rest all the same -> outputs that it stops for.

There both are the same, and a target may have only one of them, or want a motion after the other. The axes rest at the
start and the end of a job and at operations that stop motion, in some languages also where the zero changes after a
move with feed.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from gproof.ir.finding import Span
from gproof.ir.job import (
    RAPID,
    ArcTo,
    ChangeTool,
    Choice,
    CountLoop,
    DrillHole,
    DwellFor,
    EndJob,
    GoTo,
    HomeAxes,
    Job,
    LeaveRoutine,
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
    Routine,
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
    walk,
)
from gproof.ir.record import record

_RESTS = (DwellFor, PauseJob, ChangeTool, SwitchCoolant, WaitFor, HomeAxes, EndJob)
_QUIET = (Remark, SetFeed, SetVariable, ShowText)
"""Operations that neither move an axis nor stop one."""


_ZEROS = {"select", "zero_at", "zero_shift", "zero_recall"}
"""Actions of ``SetFrame`` that change the zero; a mirror does not."""

Zeros = frozenset[Span] | None
"""Where the source changes the zero, in a language in which motion with feed stops there."""


def zero_changes(job: Job) -> frozenset[Span]:
    """Where a job changes the zero."""
    bodies_of = (job.body, *(routine.body for routine in job.routines.values()))
    return frozenset(
        node.span for body in bodies_of for node in walk(body) if isinstance(node, SetFrame) and node.action in _ZEROS
    )


def at_rest(job: Job, *, before: bool, zeros: Zeros) -> Job:
    """The job with such outputs. before: also where the axes rest before the output and move after it, which the target
    does all the same where an operation stops motion, but not where ``zeros`` alone does."""
    plan = _Plan(zeros, before, job.routines)
    routines = {name: replace(one, body=plan.list(one.body)) for name, one in job.routines.items()}
    return Job(source=job.source, files=job.files, body=plan.list(job.body, whole=True), routines=routines)


@record(frozen=True, slots=True)
class _Plan:
    """zeros, before: see ``at_rest``; routines: of the job."""

    zeros: Zeros
    before: bool
    routines: dict[str, Routine]

    def list(self, nodes: Nodes, *, whole: bool = False) -> Nodes:
        """A list of operations; whole: the axes rest at its start and its end."""
        found = [self.inside(node) for node in nodes]
        zeros = frozenset() if self.zeros is None else self.zeros
        fed = _after_feed(found, False, self.routines) if zeros else [False] * len(found)
        for order, wanted in ((reversed(range(len(found))), True), (iter(range(len(found))), self.before)):
            rests: bool | None = whole and wanted
            for place in order if wanted or zeros else ():
                node = found[place]
                if isinstance(node, SwitchOutput) and node.moving:
                    found[place] = replace(node, moving=False) if rests else node
                elif not isinstance(node, _QUIET) and not _is_speed(node):
                    changes = isinstance(node, SetFrame) and node.span in zeros
                    rests = (wanted and _stops(node)) or (changes and fed[place])
        return tuple(found)

    def inside(self, node: Node) -> Node:
        """An operation with the lists within it."""
        if isinstance(node, Choice):
            return replace(node, then=self.list(node.then), otherwise=self.list(node.otherwise))
        if isinstance(node, OptionalPart | LoopWhile | CountLoop | RepeatGrid):
            return replace(node, body=self.list(node.body))
        return node


def _after_feed(nodes: Sequence[Node], fed: bool | None, routines: Mapping[str, Routine]) -> list[bool | None]:
    """For each operation, and after the last, whether the last motion before it was certainly one with feed; None: on
    some ways alone. fed: the same before the first."""
    found = [fed]
    for node in nodes:
        if isinstance(node, Moves):
            fed = int(node.rows["kind"][-1]) != RAPID
        elif isinstance(node, MoveTo):
            fed = node.kind == "feed"
        elif isinstance(node, ArcTo):
            fed = True
        elif bodies(node) and not isinstance(node, RepeatGrid):
            # What is in a loop runs perhaps not at all, perhaps again and again.
            ways = [_after_feed(way, fed, routines)[-1] for way in bodies(node)]
            before = ways[0] if isinstance(node, Choice) else fed
            fed = before if all(way == before for way in ways) else None
        elif isinstance(node, RunRoutine):
            body = routines[node.name].body
            ends_once = not any(isinstance(one, LeaveRoutine | GoTo) for one in walk(body))
            fed = ends_once and _after_feed(body, fed, routines)[-1]
        elif isinstance(node, RepeatGrid | DrillHole | Mark | ParkAt | HomeAxes):
            fed = False
        found.append(fed)
    return found


def _is_speed(node: Node) -> bool:
    return isinstance(node, TurnSpindle) and node.direction == "speed"


def _stops(node: Node) -> bool:
    """Whether the axes rest at an operation."""
    if isinstance(node, _RESTS):
        return True
    return isinstance(node, TurnSpindle) or (isinstance(node, SwitchOutput) and not node.moving)
