"""What the walk over a section works on: the section's arrays, and what changes along the path.

Some arrays have fixed places for numbers, because compiled code reads them fastest so: path_kernels.py and
walk_kernels.py name them.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

Ints = npt.NDArray[np.int64]
Floats = npt.NDArray[np.float64]
Bytes = npt.NDArray[np.uint8]


class Rows(NamedTuple):
    """Columns of a trace section; guard: 1 where the soft limits are off (one more row than the others); slack: steps
    that a row adds to the tolerance."""

    op: Bytes
    to: Floats
    center: Floats
    turns: Ints
    plane: Bytes
    feed: Floats
    guard: Bytes
    slack: Floats


class Motors(NamedTuple):
    """By motor; speed, acceleration: (3, motors) greatest counts within the windows of ``SPANS``; knots: of all pitch
    tables, motor m has those from first_knot[m] to first_knot[m + 1]; slack: steps from the flank at which the axis
    comes from below to the other one, signed as they are counted; patience: ticks for which the axis may lag
    the path after the motor turned round."""

    axis: Ints
    spu: Floats
    low: Ints
    high: Ints
    travel_low: Ints
    travel_high: Ints
    speed: Floats
    acceleration: Floats
    knots: Floats
    first_knot: Ints
    slack: Ints
    patience: Ints


class Runs(NamedTuple):
    """All motors' runs one after another, length in steps; motor m has those from first[m] to first[m + 1]."""

    interval: Ints
    length: Ints
    add: Ints
    direction: Ints
    first: Ints


class Events(NamedTuple):
    """Event rows: tick, row, ticks for which the motors stand still."""

    tick: Ints
    row: Ints
    still: Ints


class Times(NamedTuple):
    """Ticks between steps, between steps that must not merge, before a turn, in one window; section's length;
    seconds at full feed that pass in one tick."""

    interval: int
    pulse: int
    setup: int
    grid: int
    duration: int
    seconds: float


class Window(NamedTuple):
    """Pieces of path. line: (pieces, motors, 3) ``BEGIN``, ``EXTENT``, ``INVERSE``; reach: (pieces, 5) FROM, TO: the
    reachable interval, BEFORE, SECONDS: at full feed before the piece and in it, SLACK: what rounding and chords add
    to the tolerance; top: (pieces, motors) of a reachable piece up to where each motor is near; row: of the trace."""

    line: Floats
    top: Floats
    reach: Floats
    row: Ints


class Walk(NamedTuple):
    """What changes along the path. place: (PLACES, 6) positions; turns: (6, motors) last direction and number of
    reversals since the last rest, of the path and of the axis; the same of a motor with backlash, the number first."""

    ints: Ints
    reals: Floats
    place: Floats
    turns: Ints


class Backlash(NamedTuple):
    """By motor. at: the step of the axis that it drives; until: the tick up to which it may lag, or -1."""

    at: Ints
    until: Ints


class Cursor(NamedTuple):
    """How far a section has been followed. By motor: n: its step; near: from ``surround``; at, until: ``Backlash``;
    run: the one it is in; due: tick of its next step; gap: before it; left: steps of the run; last: tick of the last
    step; way: its direction. positions, progress: the rings of ``sample``; now: OVER; ``began``: seconds at full feed
    up to the last rest."""

    n: Ints
    near: Floats
    at: Ints
    until: Ints
    run: Ints
    due: Ints
    gap: Ints
    left: Ints
    last: Ints
    way: Ints
    positions: Ints
    progress: Floats
    now: Ints
    began: Floats


class Problems(NamedTuple):
    """counts by kind; the first KEPT of each: (kind, motor, tick, row) and two numbers."""

    counts: Ints
    found: Ints
    numbers: Floats
