"""Which of spindle and coolant a list of operations switches on some ways alone."""

from __future__ import annotations

from collections.abc import Mapping

from gproof.ir.job import (
    Choice,
    Node,
    Nodes,
    OptionalPart,
    Routine,
    RunRoutine,
    SwitchCoolant,
    TurnSpindle,
    bodies,
    used_routines,
    walk,
)


def switched_perhaps(
    body: Nodes, routines: Mapping[str, Routine], seen: frozenset[str] = frozenset()
) -> set[str]:  # fmt: skip
    """``spindle`` and ``coolant``, where a command for it is on one way of a choice and not on the other; loops count
    as if they ran. routines: of the job, seen: those that are looked at already."""
    found = set[str]()
    for node in body:
        for inner in bodies(node):
            found |= switched_perhaps(inner, routines, seen)
        if isinstance(node, Choice | OptionalPart):
            then, otherwise = (_switched(inner, routines) for inner in (*bodies(node), ())[:2])
            found |= then ^ otherwise
        if isinstance(node, RunRoutine) and node.name not in seen:
            found |= switched_perhaps(routines[node.name].body, routines, seen | {node.name})
    return found


def _switched(body: Nodes, routines: Mapping[str, Routine]) -> set[str]:
    """Which of both these operations switch, with those of the routines that they run."""
    every = (body, *(routine.body for routine in used_routines(body, dict(routines)).values()))
    return {_device(node) for one in every for node in walk(one)} - {""}


def _device(node: Node) -> str:
    if isinstance(node, TurnSpindle) and node.direction != "speed":
        return "spindle"
    return "coolant" if isinstance(node, SwitchCoolant) else ""
