"""A neutral job as short lines, so that a test can say by hand what each line of a program must become."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from typing import Any

from gproof.ir.drives import AXIS_NAMES
from gproof.ir.job import ArcTo, AxisPlace, Feed, Job, Moves, MoveTo, NotRaised, Quantity, bodies
from gproof.ir.program import Binary, Input, Number, Text, Unary, Variable

KINDS = ("", "rapid", "line", "cw", "ccw")
_BODIES = {"body", "then", "otherwise"}


def shown(value: Any) -> str:
    """An operand: numbers with their unit, axes with ``=`` or, relative, ``+``."""
    if isinstance(value, Number):
        return f"{value.value:g}"
    if isinstance(value, Variable):
        return "$" + (value.name or shown(value.number))
    if isinstance(value, Input):
        return f"{value.kind} {shown(value.number)}"
    if isinstance(value, Unary):
        return f"{value.operator}({shown(value.operand)})"
    if isinstance(value, Binary):
        return f"({shown(value.left)} {value.operator} {shown(value.right)})"
    if isinstance(value, Text):
        return value.value
    if isinstance(value, Quantity):
        return shown(value.value) + value.unit
    if isinstance(value, AxisPlace):
        return f"{value.axis}{'+' if value.relative else '='}{shown(value.at)}"
    if isinstance(value, Feed):
        return shown(value.amount) + ("" if value.per == "minute" else f" per {value.per}")
    if isinstance(value, tuple):
        return " ".join(shown(one) for one in value)
    return str(value)


def _rows(moves: Moves) -> Iterator[str]:
    rows = moves.rows
    sign = "+" if moves.relative else "="
    for n in range(len(rows)):
        words = [KINDS[rows["kind"][n]]]
        named = [c for c in range(len(AXIS_NAMES)) if rows["axes"][n] >> c & 1]
        words += [f"{AXIS_NAMES[c]}{sign}{rows['to'][n][c]:g}{moves.unit if c < 3 else 'deg'}" for c in named]
        words += [f"{'ijk'[c]}{rows['center'][n][c]:g}" for c in range(3) if rows["centred"][n] >> c & 1]
        if rows["radius"][n]:
            words.append(f"r{rows['radius'][n]:g}")
        if rows["feed"][n] == rows["feed"][n]:
            words.append(f"f{rows['feed'][n]:g}")
        yield " ".join(words)


def _path(node: MoveTo | ArcTo) -> str:
    """As a row of a table, so that it is all the same which of the two it is."""
    if isinstance(node, MoveTo):
        words = [{"feed": "line"}.get(node.kind, node.kind), shown(node.to)]
        words = ["machine", *words] if node.frame == "machine" else words
    else:
        words = ["cw" if node.clockwise else "ccw", *([node.plane] if node.plane != "xy" else []), shown(node.to)]
        words += [f"{'ijk'['xyz'.index(one.axis)]}{shown(one.at.value)}" for one in node.center]
        words += [f"r{shown(node.radius.value)}"] if node.radius is not None else []
        words += [f"turns {shown(node.turns)}"] if node.turns is not None else []
    if node.feed is not None:
        per = "" if node.feed.per == "minute" else f" per {node.feed.per}"
        words.append(f"f{shown(node.feed.amount.value)}{per}")
    return " ".join(word for word in words if word)


def lines_of(body: tuple[Any, ...], indent: str = "") -> list[str]:
    """A list of operations, one a line, those within others indented."""
    found: list[str] = []
    for node in body:
        if isinstance(node, Moves):
            found += [indent + row for row in _rows(node)]
            continue
        if isinstance(node, NotRaised):
            found.append(f"{indent}NotRaised {node.construct}")
            continue
        if isinstance(node, MoveTo | ArcTo):
            found.append(indent + _path(node))
            continue
        words = [type(node).__name__]
        for one in dataclasses.fields(node):
            value = getattr(node, one.name)
            if one.name != "span" and one.name not in _BODIES and value != one.default:
                words.append(f"{one.name}: {shown(value)}")
        found.append(indent + " ".join(words))
        for n, part in enumerate(bodies(node)):
            if n:
                found.append(indent + "else")
            found += lines_of(part, indent + "  ")
        if found[-1] == indent + "else":
            found.pop()
    return found


def job_lines(job: Job) -> list[str]:
    """A whole job; each routine after ``== name``."""
    found = lines_of(job.body)
    for routine in job.routines.values():
        found += [f"== {routine.name}{' ' + shown(routine.parameters) if routine.parameters else ''}"]
        found += lines_of(routine.body, "  ")
    return found
