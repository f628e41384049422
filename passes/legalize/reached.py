"""Operations with those of the routines that they run."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from gproof.ir.job import Node, Nodes, Routine, RunRoutine, walk


def reached(body: Nodes, routines: Mapping[str, Routine], seen: set[str]) -> Iterator[Node]:
    """Operations of a body, and of a routine where it is run first. seen: routines that are left out; it grows."""
    for node in walk(body):
        yield node
        if isinstance(node, RunRoutine) and node.name not in seen:
            seen.add(node.name)
            yield from reached(routines[node.name].body, routines, seen)
