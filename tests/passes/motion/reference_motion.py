"""Where the axes are at a time of a plan, written from the definitions of Trace and Plan, and random paths.

Shares no code with the passes: angles come from complex numbers, the profile is integrated piece by piece.
"""

from __future__ import annotations

import cmath
import math
from bisect import bisect_right

from hypothesis import note
from hypothesis import strategies as st
from passes.motion.traces import Path

from gproof.ir.columns import Columns
from gproof.ir.plan import PlanSection
from gproof.ir.stream import StepStream
from gproof.ir.text import print_ir
from gproof.ir.trace import Op, PathMode, Plane, Trace, TraceSection

PAIRS = {Plane.XY: (0, 1), Plane.XZ: (2, 0), Plane.YZ: (1, 2)}


class Motion:
    """Positions of a planned section over time."""

    def __init__(self, section: TraceSection, planned: PlanSection) -> None:
        self.section = section
        names = ("row", "begin", "duration", "length", "entry", "cruise", "exit", "acceleration")
        self.lines = list(zip(*(planned.rows[name].tolist() for name in names), strict=True))
        self.begins = [line[1] for line in self.lines]
        self.duration = planned.duration

    def path(self, t: float) -> tuple[int, float]:
        """(row, share of its path that is done) at a time; row -1 before the first one."""
        at = bisect_right(self.begins, t) - 1
        if at < 0:
            return -1, 1.0
        row, begin, duration, length, u, v, w, a = self.lines[at]
        if length == 0:
            return row, 1.0
        t = min(max(t - begin, 0.0), duration)
        up = (v - u) / a
        down = (v - w) / a
        level = duration - up - down
        if t < up:
            s = u * t + 0.5 * a * t * t
        elif t < up + level:
            s = u * up + 0.5 * a * up * up + v * (t - up)
        else:
            rest = duration - t
            s = length - (w * rest + 0.5 * a * rest * rest)
        return row, min(max(s / length, 0.0), 1.0)

    def at(self, t: float) -> list[float]:
        """Axis positions at a time."""
        row, share = self.path(t)
        return list(self.section.start) if row < 0 else point(self.section, row, share)


def point(section: TraceSection, row: int, share: float) -> list[float]:
    """The point of a row's path at a share of its length."""
    rows: Columns = section.rows
    begin = list(section.start) if row == 0 else rows["to"][row - 1].tolist()
    end = rows["to"][row].tolist()
    now = [a + (b - a) * share for a, b in zip(begin, end, strict=True)]
    if rows["op"][row] == Op.ARC:
        p, q = PAIRS[Plane(int(rows["plane"][row]))]
        center = complex(rows["center"][row][p], rows["center"][row][q])
        first, last = complex(begin[p], begin[q]) - center, complex(end[p], end[q]) - center
        turns = int(rows["turns"][row])
        sweep = math.atan2(last.imag, last.real) - math.atan2(first.imag, first.real)
        while turns > 0 and sweep <= 0:
            sweep += 2 * math.pi
        while turns < 0 and sweep >= 0:
            sweep -= 2 * math.pi
        sweep += 2 * math.pi * (turns - (1 if turns > 0 else -1))
        radius = abs(first) + (abs(last) - abs(first)) * share
        place = center + cmath.rect(radius, cmath.phase(first) + sweep * share)
        now[p], now[q] = place.real, place.imag
    return now


def expand(stream: StepStream, section: int, motor: int) -> list[tuple[int, int]]:
    """(tick, direction) of every step."""
    out, tick = [], 0
    for interval, count, add, direction in stream.sections[section].runs[motor].rows():
        for _ in range(count):
            tick += interval
            interval += add
            out.append((tick, direction))
    return out


# Coordinates on grids and off them; a grid of 0.0015625 mm puts ends onto half steps of 320 steps/mm.
places = st.one_of(
    st.floats(-40, 40).map(lambda x: round(x, 3)),
    st.floats(-40, 40),
    st.integers(-2000, 2000).map(lambda n: n / 640),
)
small = st.one_of(st.floats(-0.3, 0.3).map(lambda x: round(x, 3)), st.floats(-0.3, 0.3), st.just(0.0))
feeds = st.sampled_from([60.0, 600.0, 2345.6, 6000.0, 60000.0])


@st.composite
def paths(draw: st.DrawFn, *, events: bool = True, most: int = 8) -> Trace:
    """Traces of lines, arcs with drifting radius, dense curves, rotary moves, events, changes of the path mode."""
    path = Path(x=draw(places), y=draw(places), z=draw(places), a=draw(places))
    kinds = ["line", "line", "short", "arc", "arc", "curve", "rotary", "traverse", "back", "mode", "tiny"]
    if events:
        kinds += ["dwell", "spindle", "coolant", "plunge"]
    for kind in draw(st.lists(st.sampled_from(kinds), min_size=1, max_size=most)):
        x, y, z = path.place[:3]
        if kind == "line":
            names = draw(st.sets(st.sampled_from("xyza"), min_size=1))
            path.feed(draw(feeds), **{n: draw(places) for n in sorted(names)})
        elif kind == "short":
            for _ in range(draw(st.integers(1, 6))):
                x, y, z = path.place[:3]
                path.feed(draw(feeds), x=x + draw(small), y=y + draw(small), z=z + draw(small))
        elif kind == "arc":
            _arc(draw, path)
        elif kind == "curve":
            radius, step = draw(st.floats(0.5, 20.0)), draw(st.floats(0.01, 0.2))
            feed = draw(feeds)
            for n in range(1, draw(st.integers(2, 25))):
                path.feed(feed, x=x + radius * math.sin(n * step), y=y + radius * (1 - math.cos(n * step)))
        elif kind == "rotary":
            path.feed(draw(feeds), a=draw(places))
        elif kind == "traverse":
            path.traverse(x=draw(places), z=draw(places))
        elif kind == "back":
            path.feed(draw(feeds), x=x + draw(small)).feed(draw(feeds), x=x)
        elif kind == "tiny":
            path.feed(600, x=x + draw(st.sampled_from([1e-10, 1e-13, -1e-11, 2e-9])))
        elif kind == "mode":
            mode = draw(st.sampled_from(list(PathMode)))
            path.mode(mode, draw(st.sampled_from([math.nan, 0.0, 10.0, 60.0, 180.0])))
        elif kind == "dwell":
            path.dwell(draw(st.sampled_from([0.0, 0.001, 0.1, 1 / 3])))
        elif kind == "spindle":
            path.spindle(draw(st.sampled_from([-1, 0, 1])))
        elif kind == "coolant":
            path.other(Op.COOLANT, 1.0)
        else:
            path.feed(300, z=z + draw(small))
    trace = path.done()
    note(print_ir(trace))
    return trace


def _arc(draw: st.DrawFn, path: Path) -> None:
    plane = draw(st.sampled_from([Plane.XY, Plane.XZ, Plane.YZ]))
    p, q = PAIRS[plane]
    radius, angle = draw(st.floats(0.02, 30.0)), draw(st.floats(-math.pi, math.pi))
    center = complex(path.place[p], path.place[q]) + cmath.rect(radius, angle)
    sweep = draw(st.one_of(st.floats(-7, 7), st.floats(-0.05, 0.05), st.just(0.0)))
    drift = draw(st.one_of(st.just(0.0), st.floats(-0.002, 0.002)))
    end = center + cmath.rect(max(radius + drift, 0.01), angle + math.pi + sweep)
    if sweep == 0.0:
        end = complex(path.place[p], path.place[q])
    turns = draw(st.sampled_from([1, -1, 1, -1, 2, -3]))
    to = {"xyz"[p]: end.real, "xyz"[q]: end.imag}
    if draw(st.booleans()):
        to["xyz"[3 - p - q]] = draw(places)
    if draw(st.booleans()):
        to["a"] = draw(places)
    path.arc(draw(feeds), turns, (center.real, center.imag), plane, **to)
