"""Between what the tip of a tool is where its place is only bounded, and whether anything there may meet a body.

A start, an offset or a length that the setup gives as a range, a probe's contact, the path of homing moves: the tip may
be anywhere in a box then. Takes such boxes in the coordinates of a body (``placing.Placing.span``) and the pieces of a
tool; what it calls clear is clear for every path within the box.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence

from gproof.ir.machine import AXIS_NAMES, Machine
from gproof.ir.workpiece import Body, extent
from gproof.passes.checks.tooling.tool_shape import Piece

Pair = tuple[float, float]
Span = tuple[Pair, Pair, Pair]
EVERYWHERE = (-math.inf, math.inf)
NOWHERE_KNOWN: Span = (EVERYWHERE, EVERYWHERE, EVERYWHERE)


def hull(one: Span, other: Span) -> Span:
    """The box around two."""
    x, y, z = ((min(a[0], b[0]), max(a[1], b[1])) for a, b in zip(one, other, strict=True))
    return x, y, z


def may_meet(pieces: Iterable[Piece], bodies: Sequence[Body], tips: Span, room: float) -> bool:
    """Whether a tool whose tip is somewhere in a box may come nearer than ``room`` to the box around some body."""
    return any(_near(piece, body, tips, room) for piece in pieces for body in bodies)


def _near(piece: Piece, body: Body, tips: Span, room: float) -> bool:
    around = max(radius for radius, _ in piece.rims) + piece.rounding + room
    below, above = piece.tip - room, piece.rims[-1][1] + piece.rounding + room
    ends = extent(body)
    reach = (-around, around), (-around, around), (below, above)
    return all(
        low + less < ends[axis + 3] and high + more > ends[axis]
        for axis, ((low, high), (less, more)) in enumerate(zip(tips, reach, strict=True))
    )


def homed_together(machine: Machine, names: Sequence[str]) -> Iterator[list[int]]:
    """Columns of X, Y, Z among homed axes, group after group where the machine's file has an order."""
    left = [name for name in names if name in AXIS_NAMES[:3]]
    for line in machine.settings.homing:
        these = [name for name, _ in line.distances if name in left]
        left = [name for name in left if name not in these]
        yield [AXIS_NAMES.index(name) for name in these]
    yield [AXIS_NAMES.index(name) for name in left]


def homing(machine: Machine, names: Sequence[str], start: Span, shift: Sequence[float | None]) -> Iterator[Span]:
    """Where the tip may be while axes home: anywhere along those that do, one group after the other.

    shift: what machine positions have more than ``start`` counts, None where that is not known.
    """
    spans = list(start)
    for axes in homed_together(machine, names):
        for axis in axes:
            spans[axis] = EVERYWHERE
        if axes:
            yield spans[0], spans[1], spans[2]
        for axis in axes:
            home, by = machine.axis(AXIS_NAMES[axis]), shift[axis]
            if home is not None and home.home_place is not None and by is not None:
                spans[axis] = (home.home_place - by,) * 2
