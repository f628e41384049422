"""Runs as edges of step and direction pins, in the order in which they come.

``rings[motor, place]`` holds (interval, count, add, direction) as of ``run_kernels``; ``pins[motor]`` the columns
below. Pin 2m is the step pin of motor m, pin 2m + 1 its direction pin; levels are 1 for a pulse and for counting up. In
quadrature they are the channels A and B: A leads where the motor counts up.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from gproof.ir.kernel import kernel

HEAD = 0  # place of the oldest run in the ring
SIZE = 1  # runs in the ring
DONE = 2  # steps made of the oldest run
LAST = 3  # tick from which the next interval counts
FACING = 4  # direction that the pin shows
DUE = 5  # tick of the next step's edge, NEVER: none is known
EXACT = 6  # tick of that step in the stream
TURN = 7  # tick at which the direction changes before it
FALL = 8  # tick at which the pulse ends
NEXT = 9  # the first of DUE, TURN and FALL
RISE = 10  # tick of the last step's edge
PHASE = 11  # of quadrature: 0 to 3
SHORT = 12  # direction changes nearer to their step than the set-up time
STEPS = 13  # steps made
FIELDS = 14

NEVER = 2**62

Ints = npt.NDArray[np.int64]


class Form(NamedTuple):
    """How steps look, ticks. grid: edges come at its multiples, never early; quadrature: 1 for two channels."""

    pulse: int
    setup: int
    grid: int
    quadrature: int


class Edges(NamedTuple):
    """Room for edges: tick, pin, level."""

    tick: Ints
    pin: Ints
    level: Ints


@kernel(seconds_per_unit=2e-6, compile_seconds=1.0)
def look_ahead(rings: Ints, pins: Ints, m: int, since: int, form: Form) -> None:
    """Work out the next step of a motor, unless it is known; nothing of it comes before ``since``."""
    if pins[m, DUE] == NEVER and pins[m, SIZE] > 0:
        head = pins[m, HEAD]
        exact = pins[m, LAST] + rings[m, head, 0] + rings[m, head, 2] * pins[m, DONE]
        due = (exact + form.grid - 1) // form.grid * form.grid
        pins[m, EXACT] = exact
        if form.quadrature == 0 and rings[m, head, 3] != pins[m, FACING]:
            turn = max(due - form.setup, pins[m, RISE] + form.grid, since)
            if turn > due - form.setup and (turn == since or due - pins[m, RISE] < form.setup):
                pins[m, SHORT] += 1
            pins[m, TURN] = turn
            due = max(due, turn)
        pins[m, DUE] = max(due, since)
    pins[m, NEXT] = min(pins[m, FALL], pins[m, TURN], pins[m, DUE])


@kernel(seconds_per_unit=8e-6, compile_seconds=3.0)
def edges(rings: Ints, pins: Ints, until: int, since: int, form: Form, out: Edges) -> int:
    """The edges of all motors up to ``until``, as many as there is room for; how many. Those of one tick by motor."""
    motors = rings.shape[0]
    depth = rings.shape[1]
    room = out.tick.shape[0]
    for m in range(motors):
        look_ahead(rings, pins, m, since, form)
    n = 0
    while n < room:
        m = 0
        for k in range(1, motors):
            if pins[k, NEXT] < pins[m, NEXT]:
                m = k
        tick = pins[m, NEXT]
        if tick > until:
            break
        out.tick[n] = tick
        if tick == pins[m, FALL]:
            out.pin[n] = 2 * m
            out.level[n] = 0
            pins[m, FALL] = NEVER
        elif tick == pins[m, TURN]:
            pins[m, FACING] = -pins[m, FACING]
            out.pin[n] = 2 * m + 1
            out.level[n] = 1 if pins[m, FACING] > 0 else 0
            pins[m, TURN] = NEVER
        else:
            head = pins[m, HEAD]
            if form.quadrature == 0:
                out.pin[n] = 2 * m
                out.level[n] = 1
                pins[m, FALL] = tick + form.pulse
            else:
                # States 0 to 3 are A B = 00, 10, 11, 01: between an even one and the next A changes, else B.
                way = rings[m, head, 3]
                phase = pins[m, PHASE]
                changed = phase if way > 0 else (phase + 3) % 4
                phase = (phase + way + 4) % 4
                pins[m, PHASE] = phase
                pins[m, FACING] = way
                if changed % 2 == 0:
                    out.pin[n] = 2 * m
                    out.level[n] = 1 if 1 <= phase <= 2 else 0
                else:
                    out.pin[n] = 2 * m + 1
                    out.level[n] = 1 if phase >= 2 else 0
            pins[m, STEPS] += 1
            pins[m, RISE] = tick
            pins[m, LAST] = pins[m, EXACT]
            pins[m, DONE] += 1
            if pins[m, DONE] == rings[m, head, 1]:
                pins[m, DONE] = 0
                pins[m, HEAD] = (head + 1) % depth
                pins[m, SIZE] -= 1
            pins[m, DUE] = NEVER
        look_ahead(rings, pins, m, since, form)
        n += 1
    return n
