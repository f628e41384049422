"""From the sections' rows to the arrays of the walk; what cannot be followed is refused here, nothing is corrected."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from fractions import Fraction
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from gproof.ir.columns import joined
from gproof.ir.drives import AXES, Drive, Drives
from gproof.ir.stream import StepStream
from gproof.ir.trace import TRACE_ROW, Op, Plane, Trace, TraceSection
from gproof.verify.kernel.motor_map import motor_at
from gproof.verify.kernel.path_kernels import ARC_OP, EXACT, LAST_MOTION_OP
from gproof.verify.kernel.proof import Proof
from gproof.verify.kernel.stream_numbers import Why
from gproof.verify.kernel.walk_state import Floats, Rows

MOTION_OPS = (Op.TRAVERSE, Op.FEED, Op.ARC, Op.PROBE)
assert ARC_OP == Op.ARC and LAST_MOTION_OP == Op.PROBE == max(MOTION_OPS)

MOVES = np.zeros(256, np.bool_)
MOVES[list(MOTION_OPS)] = True
"""By op, whether it is one of these."""

PAIRS = {Plane.XY: (0, 1), Plane.XZ: (2, 0), Plane.YZ: (1, 2)}
"""The axes of an arc, in the order of a right-handed frame."""

Z = 2
"""The axis that a height map raises."""

GUARD = "machine_area"
"""The guard that stands for the soft limits in ``State.guards_off``."""

FARTHEST = 1 << 28
"""Steps: positions and lengths of arcs up to this keep float64's rounding far below ``ROUNDING``."""

_SURELY = 0.499
"""Steps: what float64 makes of a distance below this is below ``EXACT`` exactly too."""


class Tables(NamedTuple):
    """What all sections share. driven: axes with a motor; reach: (6,) steps per unit of each; known: by frame, whether
    the driven axes are known in it; off: by state, 1 where the soft limits are off; idle: axes without a motor; planes:
    (256,) 0 no plane, 1 one whose axes have motors, 2 another one."""

    driven: list[int]
    reach: Floats
    known: npt.NDArray[np.bool_]
    off: npt.NDArray[np.uint8]
    idle: npt.NDArray[np.intp]
    planes: npt.NDArray[np.uint8]


def tables_of(stream: StepStream, trace: Trace) -> Tables:
    """For ``row_arrays``."""
    driven = sorted({motor.axis for motor in stream.motors})
    reach = np.zeros(AXES)
    for motor in stream.motors:
        reach[motor.axis] = abs(float(motor.steps_per_unit))
    planes = np.zeros(256, np.uint8)
    for plane, pair in PAIRS.items():
        planes[int(plane)] = 1 if set(pair) <= set(driven) else 2
    return Tables(
        driven=driven,
        reach=reach,
        known=np.array([all(frame[a] == () for a in driven) for frame in trace.frames], dtype=bool),
        off=np.array([GUARD in state.guards_off for state in trace.states], dtype=np.uint8),
        idle=np.array([a for a in range(AXES) if a not in driven], dtype=np.intp),
        planes=planes,
    )


def row_arrays(section: TraceSection, tables: Tables, proof: Proof) -> Rows | None:
    """The section's rows for the kernel, when each of them can be followed."""
    problems: list[tuple[int, Why]] = []
    rows = rows_of([section], tables, problems)
    for row, why in problems:
        proof.refute("stream-form", why[0], section.number, row, *why[1:])
    return None if rows is None else rows[0]


def rows_of(sections: Sequence[TraceSection], tables: Tables, problems: list[tuple[int, Why]]) -> list[Rows] | None:
    """Each section's rows for the kernel; None, with the problems of one section (row, what), when one cannot be
    followed. Of several sections they have no places."""
    known, reach, idle = tables.known, tables.reach, tables.idle
    if not known[[section.start_frame for section in sections]].all():
        problems.append((-1, ("row.start-unknown",)))
    if any(section.rows.schema is not TRACE_ROW for section in sections):
        problems.append((-1, ("row.table",)))
        return None
    rows = joined(TRACE_ROW, [section.rows for section in sections])
    sizes = [len(section.rows) for section in sections]
    first = np.cumsum([0, *sizes])
    n = len(rows)
    to = np.ascontiguousarray(rows["to"], dtype=np.float64)
    starts = np.array([section.start for section in sections], dtype=np.float64).reshape(-1, AXES)
    if not np.isfinite(starts).all():
        problems.append((-1, ("row.start-not-finite",)))
        return None
    before = np.empty((n, AXES))
    before[1:] = to[: max(0, n - 1)]
    there = np.flatnonzero(sizes)
    before[first[there]] = starts[there]
    of = np.repeat(np.arange(len(sections)), sizes) if len(sections) > 1 else np.zeros(1, np.intp)
    op = rows["op"]
    motion = MOVES[op]
    arcs = op == Op.ARC
    planes = tables.planes[rows["plane"]]
    extent = np.abs(to) * reach
    moved = (to != before).any(axis=1)
    needs_feed = motion & (op != Op.TRAVERSE) & (moved | arcs)
    for bad, what in (
        (~known[rows["frame"]], ("row.unknown",)),
        (moved & ~motion, ("row.jump",)),
        ((to[:, idle] != starts[:, idle][of]).any(axis=1), ("row.no-motor",)),
        (arcs & (planes == 2), ("row.arc-without-motor",)),
        ((extent > FARTHEST).any(axis=1), ("row.far", FARTHEST)),
        (arcs & (planes == 0), ("row.no-plane",)),
        (needs_feed & ~(np.isfinite(rows["feed"]) & (rows["feed"] > 0)), ("row.no-feed",)),
    ):
        if bad.any():
            problems.append((int(np.argmax(bad)), what))
    if (np.abs(starts) * reach > FARTHEST).any():
        problems.append((-1, ("row.far-start", FARTHEST)))
    if problems:
        return None
    for plane, pair in PAIRS.items():
        here = np.flatnonzero(arcs & (rows["plane"] == plane))
        problem = _arc_problems(rows["center"][here][:, pair], before[here][:, pair], to[here][:, pair],
                            rows["turns"][here], float(reach[list(pair)].max()))  # fmt: skip
        if problem is not None:
            problems.append((int(here[problem[0]]), problem[1]))
    if problems:
        return None
    guard = np.zeros(n + len(sections), np.uint8)
    if n:
        guard[np.arange(n) + of] = tables.off[rows["state"]]
    whole = Rows(
        op=np.ascontiguousarray(op, dtype=np.uint8),
        to=to,
        center=np.ascontiguousarray(rows["center"], dtype=np.float64),
        turns=rows["turns"].astype(np.int64),
        plane=np.ascontiguousarray(rows["plane"], dtype=np.uint8),
        feed=np.ascontiguousarray(rows["feed"], dtype=np.float64),
        guard=guard,
        slack=np.zeros(n),
    )
    ends = first.tolist()
    return [
        Rows(
            whole.op[a:b], to[a:b], whole.center[a:b], whole.turns[a:b], whole.plane[a:b], whole.feed[a:b],
            guard[a + k : b + k + 1], whole.slack[a:b],
        )
        for k, (a, b) in enumerate(itertools.pairwise(ends))
    ]  # fmt: skip


def _arc_problems(
    center: Floats, start: Floats, to: Floats, turns: Floats, steps_per_mm: float
) -> tuple[int, Why] | None:
    """The first arc that cannot be followed, and why; positions in the arcs' plane."""
    if not len(center):
        return None
    radii = np.hypot(*(start - center).T), np.hypot(*(to - center).T)
    small, large = np.minimum(*radii), np.maximum(*radii)
    length = (large * (np.abs(turns.astype(np.float64)) + 1) * 2 * math.pi + np.abs(center).max(axis=1)) * steps_per_mm
    for bad, what in (
        (~(small > 0), ("row.no-radius",)),
        (~(length <= FARTHEST), ("row.long-arc", FARTHEST)),
    ):
        if bad.any():
            return int(np.argmax(bad)), what
    return None


def start_problems(
    stream: StepStream, trace: Trace, drives: Drives, known: Sequence[Drive], number: int, raised: float, proof: Proof
) -> bool:
    """Refuse unless the section starts at the steps nearest to its traced start, and that where it is stated.

    known: the motors' drives; raised: what a height map adds to Z there.
    """
    section, place = stream.sections[number], trace.sections[number].start
    good = True
    for motor, drive, steps in zip(stream.motors, known, section.start, strict=True):
        at = place[motor.axis] + (raised if motor.axis == Z else 0.0)
        if drive.pitch is None and abs(steps - at * float(motor.steps_per_unit)) < _SURELY and abs(steps) < FARTHEST:
            continue
        exact = motor_at(drive.pitch, at) * motor.steps_per_unit
        if abs(steps - exact) > Fraction(EXACT):
            good = False
            proof.refute("stream-end", "start.step", number, 0, motor.name, steps, at, float(exact))
    if number == 0:
        for axis in sorted({motor.axis for motor in stream.motors}):
            stated = drives.start[axis]
            if stated is not None and not stated.low <= place[axis] <= stated.high:
                good = False
                proof.refute("stream-end", "start.stated", 0, 0, axis, place[axis], stated.low, stated.high)
    return good
