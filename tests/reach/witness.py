"""A witness: a program in which a stated fact can be seen, as the answers differ when it changes.

The program and the world are chosen so that the fact matters; what the answers change to is no expectation here, only
that they change, and in which targets.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from reach.changes import Path
from reach.worlds import World


class Witness(NamedTuple):
    """A program in a world, the path of a fact there, another value for it, and the row of docs/reach.md."""

    row: str
    world: World
    program: str
    path: Path
    value: Any


class Witnesses(list[Witness]):
    """Called with what a witness has: one more."""

    def __call__(self, row: str, world: World, program: str, path: str, value: Any) -> None:
        """Lines of the program are parted by ``; ``; the path is dotted: ``machine.axes.0.lower``."""
        self.append(Witness(row, world, program.replace("; ", "\n") + "\n", steps(path), value))


def steps(path: str) -> Path:
    """Numbers are places in a tuple."""
    return tuple(int(step) if step.isdigit() else step for step in path.split("."))


def m(*changes: tuple[str, Any]) -> tuple[tuple[Path, Any], ...]:
    """Changes of a world by dotted paths."""
    return tuple((steps(path), value) for path, value in changes)
