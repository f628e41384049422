"""Small whole jobs: trace, machine, setup and a stream that the validator accepts."""

from __future__ import annotations

import numpy as np
from backend.streams import FREQUENCY, events_of, machine, motors_of, planned

from gproof.backend.job import CertifiedJob
from gproof.ir.columns import Columns
from gproof.ir.setup import ZERO
from gproof.ir.stream import StepStream
from gproof.ir.trace import TRACE_ROW, Edge, Op, State, Trace, TraceSection, Wait

FEED = 60.0

ROWS = {Wait.END: Op.END, Wait.OPERATOR: Op.STOP, Wait.TOOL_CHANGE: Op.TOOL_CHANGE, Wait.INPUT: Op.INPUT_WAIT}
"""The row that waits before each edge."""


def rows_of(points: list[tuple[float, ...]], ops: list[tuple[Op, float]], at: tuple[float, ...]) -> Columns:
    """Feed rows to the points, then rows that stay there."""
    n = len(points) + len(ops)
    rows = TRACE_ROW.empty(n)
    for k, point in enumerate(points):
        rows["op"][k], rows["line"][k], rows["feed"][k] = Op.FEED, k + 1, FEED * 60
        rows["to"][k, : len(point)] = at = point
    for k, (op, arg) in enumerate(ops, start=len(points)):
        rows["op"][k], rows["line"][k], rows["arg"][k, 0] = op, k + 1, arg
        rows["to"][k, : len(at)] = at
    return Columns(TRACE_ROW, rows)


def job(
    *ways: list[tuple[float, ...]], waits: tuple[Wait, ...] = (), axes: str = "xy", overrides: bool = True
) -> CertifiedJob:
    """One section for each way (points from 0), joined by waits; every section ends switching the coolant."""
    of = machine(axes)
    trace = Trace(files=["job.cnc"], states=[State(overrides=overrides)])
    stream = StepStream(tick_frequency=FREQUENCY, motors=motors_of(of))
    place: tuple[float, ...] = (0.0,) * len(axes)
    for number, way in enumerate(ways):
        last = number + 1 == len(ways)
        wait = Wait.END if last else (waits[number] if number < len(waits) else Wait.OPERATOR)
        edge = Edge(wait=wait, outcome="on", target=-1 if last else number + 1, line=len(way) + 2)
        relative = [tuple(p - q for p, q in zip(point, place, strict=True)) for point in way]
        section = planned(relative, of, feed=FEED)
        section.number = number
        section.start = stream.sections[-1].end() if number else (0,) * len(axes)
        rows = rows_of(way, [(Op.COOLANT, 1.0), (ROWS[wait], 0.0)], place)
        events = [(section.duration, len(way), int(Op.COOLANT), (1000, 0))]
        if wait is not Wait.END:
            events.append((section.duration, len(way) + 1, int(ROWS[wait]), (0, 0)))
        section.events = events_of(events)
        section.duration += 1000
        stream.sections.append(section)
        start = (*place, *(0.0,) * (6 - len(axes)))
        trace.sections.append(TraceSection(number=number, start=start, start_frame=0, rows=rows, edges=(edge,)))
        place = way[-1] if way else place
    trace.verify()
    stream.verify()
    certificate = bytes(np.arange(32, dtype=np.uint8)).hex()
    return CertifiedJob(name="job.cnc", certificate=certificate, trace=trace, machine=of, setup=ZERO, stream=stream)
