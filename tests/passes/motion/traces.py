"""Traces and machines made by hand, for tests of the motion passes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np

from gproof.ir.columns import Columns, concatenate
from gproof.ir.machine import AXIS_NAMES, Axis, AxisKind, Board, Controller, Machine, Slave
from gproof.ir.setup import Setup
from gproof.ir.stream import StepStream
from gproof.ir.trace import TRACE_ROW, Edge, Frame, Op, PathMode, Plane, State, Trace, TraceSection, Wait
from gproof.verify import stream as stream_checker
from gproof.verify.explain.stream_report import StreamReport

RAD = math.pi / 180.0


def machine(
    *, velocity: float = 100.0, acceleration: float = 500.0, steps: Fraction | int | None = 320, axes: str = "xyza",
    laf_angle: float | None = 3.0, max_step_frequency: float | None = 125_000.0, spindle_ramp_time: float = 0.0,
    board: Board | None = None, slaves: int = 0,
) -> Machine:  # fmt: skip
    """A machine whose axes are all alike; angles count as mm."""
    made = tuple(
        Axis(
            name=n, kind=AxisKind.LINEAR if n in "xyz" else AxisKind.ROTARY, max_velocity=velocity,
            max_acceleration=acceleration, steps_per_unit=None if steps is None else Fraction(steps),
            slaves=(Slave(),) * slaves if n == "x" else (),
        )
        for n in axes
    )  # fmt: skip
    controller = Controller(
        laf_angle=laf_angle, max_step_frequency=max_step_frequency, spindle_ramp_time=spindle_ramp_time
    )
    result = Machine(name="test", axes=made, controller=controller, board=board or Board())
    result.verify()
    return result


class Path:
    """Rows of a trace, one call a row; positions by axis letter, what is not named stays."""

    def __init__(self, **start: float) -> None:
        self.trace = Trace(files=["test.cnc"], states=[State()])
        self._state = 0
        self._frame = 0
        self._rows: list[dict[str, object]] = []
        self.place = [start.get(n, 0.0) + 0.0 for n in AXIS_NAMES]
        self._start = tuple(self.place)
        self._start_frame = 0

    def _add(self, op: Op, **values: object) -> Path:
        row: dict[str, object] = {
            "op": int(op), "file": 0, "line": len(self._rows) + 1, "call": 0, "to": list(self.place),
            "frame": self._frame, "state": self._state, "feed": 0.0, "center": [0.0] * 3, "turns": 0, "plane": 0,
            "arg": [0.0, 0.0], "text": 0,
        }  # fmt: skip
        row.update(values)
        self._rows.append(row)
        return self

    def _go(self, to: dict[str, float]) -> None:
        for name, value in to.items():
            self.place[AXIS_NAMES.index(name)] = float(value) + 0.0  # never -0.0

    def traverse(self, **to: float) -> Path:
        self._go(to)
        return self._add(Op.TRAVERSE)

    def feed(self, feed: float, **to: float) -> Path:
        self._go(to)
        return self._add(Op.FEED, feed=float(feed))

    def probe(self, feed: float, **to: float) -> Path:
        self._go(to)
        return self._add(Op.PROBE, feed=float(feed))

    def arc(
        self, feed: float, turns: int, center: Sequence[float], plane: Plane = Plane.XY, **to: float
    ) -> Path:  # fmt: skip
        """center: the two coordinates in the plane, in the order of its right-handed pair."""
        first = {Plane.XY: 0, Plane.XZ: 2, Plane.YZ: 1}[plane]
        full = [self.place[0], self.place[1], self.place[2]]
        full[first], full[(first + 1) % 3] = center
        self._go(to)
        return self._add(Op.ARC, feed=float(feed), turns=turns, plane=int(plane), center=full)

    def dwell(self, seconds: float) -> Path:
        return self._add(Op.DWELL, arg=[seconds, 0.0])

    def spindle(self, direction: int, rpm: float = 1000.0) -> Path:
        return self._add(Op.SPINDLE, arg=[float(direction), rpm])

    def other(self, op: Op, *arg: float) -> Path:
        return self._add(op, arg=[*arg, 0.0, 0.0][:2])

    def state(self, **values: object) -> Path:
        """Rows after this one have a changed state."""
        self.trace.states.append(State(**values))  # type: ignore[arg-type]
        self._state = len(self.trace.states) - 1
        return self

    def mode(self, mode: PathMode, laf_angle: float = math.nan) -> Path:
        return self.state(path_mode=mode, laf_angle=laf_angle)

    def frame(self, *unknown: str) -> Path:
        """Rows after this one stand in a frame with these unknown offsets (symbols such as ``work.1.x``)."""
        forms = [tuple(sorted((s, 1) for s in unknown if s[-1] == n or s == "?")) for n in AXIS_NAMES]
        self.trace.frames.append((forms[0], forms[1], forms[2], forms[3], forms[4], forms[5]))
        self._frame = len(self.trace.frames) - 1
        if not self._rows:
            self._start_frame = self._frame
        return self

    def end_section(self) -> Path:
        arrays = TRACE_ROW.empty(len(self._rows))
        for at, row in enumerate(self._rows):
            for name, value in row.items():
                arrays[name][at] = value
        self.trace.sections.append(
            TraceSection(
                number=len(self.trace.sections), start=self._start, start_frame=self._start_frame,
                rows=Columns(TRACE_ROW, arrays),
            )
        )  # fmt: skip
        self._rows = []
        self._start, self._start_frame = tuple(self.place), self._frame
        return self

    def done(self) -> Trace:
        if self._rows or not self.trace.sections:
            self.end_section()
        self.trace.verify()
        return self.trace

    def whole(self) -> Trace:
        """As a run needs it: the last section ends the program."""
        self.other(Op.END)
        trace = self.done()
        trace.sections[-1].edges = (Edge(wait=Wait.END, outcome="end", target=-1),)
        return trace


def ended(trace: Trace) -> Trace:
    """A copy as a run needs it: sections without edges follow one another, the last one ends the program."""
    sections = [replace(section) for section in trace.sections]
    for number, section in enumerate(sections):
        if section.edges:
            continue
        target = number + 1 if number + 1 < len(sections) else -1
        section.edges = (Edge(wait=Wait.OPERATOR if target > 0 else Wait.END, outcome="go on", target=target),)
        if target < 0 and not (section.rows["op"] == Op.END).any():
            last = TRACE_ROW.empty(1)
            rows = section.rows
            last["op"][:], last["to"][:] = Op.END, rows["to"][-1:] if len(rows) else np.array([section.start])
            last["frame"][:] = rows["frame"][-1:] if len(rows) else section.start_frame
            last["state"][:] = rows["state"][-1:] if len(rows) else 0
            section.rows = concatenate(TRACE_ROW, [rows, Columns(TRACE_ROW, last)])
    return replace(trace, sections=sections)


def validate(stream: StepStream, trace: Trace, on: Machine, setup: Setup, **more: Any) -> StreamReport:
    """The checker's answer for a path that ends the program."""
    return stream_checker.validate(stream, ended(trace), on, setup, **more)


def known(frame: Frame) -> bool:
    return all(not form for form in frame)
