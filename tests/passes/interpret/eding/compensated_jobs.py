"""What the tests of cutter radius compensation share: running a program, its rows as plain geometry, contours."""

from __future__ import annotations

import dataclasses
import math
import random
from dataclasses import dataclass
from pathlib import Path

from gproof.driver.running import execute
from gproof.frontend.eding.load import load_program
from gproof.ir.finding import Findings
from gproof.ir.machine import NO_MACHINE, Controller, Machine, Tool
from gproof.ir.setup import ZERO, Setup
from gproof.ir.trace import Op, Plane, Trace

Point = tuple[float, float]
HEAD = "G21 G17 G90 G94 G54 G40 G49 G80 F600\n"
PAIRS = {Plane.XY: (0, 1), Plane.XZ: (2, 0)}


def machine(*tools: Tool, view: str | None = None) -> Machine:
    return dataclasses.replace(NO_MACHINE, tools=tools, controller=Controller(xz_seen_from=view))


MILL = machine(
    Tool(number=1, diameter=6.0), Tool(number=2, diameter=1.0), Tool(number=3, diameter=-0.4), Tool(number=4),
    Tool(number=5, diameter=0.0),
)  # fmt: skip


def run(folder: Path, text: str, setup: Setup = ZERO, on: Machine = MILL) -> tuple[Trace, list[str], Findings]:
    """The trace, the codes of errors and unknowns with their lines, all findings."""
    job = folder / "job.cnc"
    job.write_text(text)
    findings = Findings()
    program = load_program(job, findings)
    assert program is not None
    trace = execute(program, setup, on, findings)
    trace.verify()
    told = [f"{f.code.label}:{f.span.line}" for f in findings.kept if f.severity.value in ("error", "unknown")]
    return trace, told, findings


@dataclass(frozen=True)
class Move:
    """A row in the pair of its plane: begin and end, centre and turns of an arc."""

    op: Op
    line: int
    begin: Point
    end: Point
    center: Point | None
    turns: int
    to: tuple[float, ...]
    feed: float
    programmed: Point
    compensation: int

    def points(self, count: int = 24) -> list[Point]:
        """Along the row, ends included."""
        if self.center is None:
            steps = [k / count for k in range(count + 1)]
            (a, b), (c, d) = self.begin, self.end
            return [(a + (c - a) * t, b + (d - b) * t) for t in steps]
        u, v = self.begin[0] - self.center[0], self.begin[1] - self.center[1]
        turned = self.sweep()
        out = []
        for k in range(count + 1):
            cos, sin = math.cos(turned * k / count), math.sin(turned * k / count)
            out.append((self.center[0] + u * cos - v * sin, self.center[1] + u * sin + v * cos))
        return out

    def sweep(self) -> float:
        """Signed radians, as docs/trace.md defines turns."""
        assert self.center is not None
        a = math.atan2(self.begin[1] - self.center[1], self.begin[0] - self.center[0])
        b = math.atan2(self.end[1] - self.center[1], self.end[0] - self.center[0])
        sense = 1 if self.turns > 0 else -1
        angle = (b - a) * sense % (2 * math.pi)
        if self.begin == self.end or angle == 0.0:
            angle = 2 * math.pi
        return sense * (angle + 2 * math.pi * (abs(self.turns) - 1))


def moves(trace: Trace, plane: Plane = Plane.XY) -> list[Move]:
    a, b = PAIRS[plane]
    out = []
    for section in trace.sections:
        rows = section.rows
        at = section.start
        for k in range(len(rows)):
            to = tuple(rows["to"][k].tolist())
            op = Op(int(rows["op"][k]))
            if op < Op.DWELL:
                center = tuple(rows["center"][k].tolist())
                programmed = tuple(rows["arg"][k].tolist())
                out.append(
                    Move(
                        op, int(rows["line"][k]), (at[a], at[b]), (to[a], to[b]),
                        (center[a], center[b]) if op is Op.ARC else None, int(rows["turns"][k]), to,
                        float(rows["feed"][k]), (programmed[0], programmed[1]),
                        trace.states[int(rows["state"][k])].compensation,
                    )
                )  # fmt: skip
            at = to
    return out


@dataclass(frozen=True)
class Stretch:
    """A line or an arc of a programmed contour; sense 0: a line."""

    begin: Point
    end: Point
    center: Point = (0.0, 0.0)
    sense: int = 0

    def text(self, before: Point | None = None) -> str:
        """As a line of the program; before: the programmed point, for G91."""
        base = before or (0.0, 0.0)
        words = f"X{self.end[0] - base[0]:.9f} Y{self.end[1] - base[1]:.9f}"
        if not self.sense:
            return f"G1 {words}\n"
        i, j = self.center[0] - self.begin[0], self.center[1] - self.begin[1]
        return f"{'G3' if self.sense > 0 else 'G2'} {words} I{i:.9f} J{j:.9f}\n"

    def mirrored(self) -> Stretch:
        """In the line x = 0."""
        (a, b), (c, d), (e, f) = self.begin, self.end, self.center
        return Stretch((-a, b), (-c, d), (-e, f), -self.sense)

    def reversed(self) -> Stretch:
        return Stretch(self.end, self.begin, self.center, -self.sense)

    def away(self, p: Point) -> float:
        """How far a point is from the whole line or circle that the stretch is a part of."""
        if self.sense:
            return abs(math.dist(p, self.center) - math.dist(self.begin, self.center))
        u, v = _unit(self.begin, self.end)
        return abs(u * (p[1] - self.begin[1]) - v * (p[0] - self.begin[0]))

    def distance(self, p: Point) -> tuple[float, float]:
        """How far a point is, and on which side: > 0 left of the way along the stretch, 0 beyond its ends."""
        if not self.sense:
            u, v = self.end[0] - self.begin[0], self.end[1] - self.begin[1]
            length = math.hypot(u, v)
            along = ((p[0] - self.begin[0]) * u + (p[1] - self.begin[1]) * v) / length
            if 0 <= along <= length:
                left = (u * (p[1] - self.begin[1]) - v * (p[0] - self.begin[0])) / length
                return abs(left), left
        else:
            a = math.atan2(self.begin[1] - self.center[1], self.begin[0] - self.center[0])
            b = math.atan2(self.end[1] - self.center[1], self.end[0] - self.center[0])
            at = math.atan2(p[1] - self.center[1], p[0] - self.center[0])
            if (at - a) * self.sense % (2 * math.pi) <= (b - a) * self.sense % (2 * math.pi):
                inside = math.dist(self.begin, self.center) - math.dist(p, self.center)
                return abs(inside), inside * self.sense
        return min(math.dist(p, self.begin), math.dist(p, self.end)), 0.0


def contour(rng: random.Random, side: int, radius: float, sharp: bool) -> list[Stretch]:
    """A random contour from left to right with rounded corners; sharp: those that the tool goes around are not."""
    points = [(0.0, 0.0)]
    for _ in range(rng.randint(2, 7)):
        angle, length = math.radians(rng.uniform(-65, 65)), rng.uniform(45, 90)
        points.append((points[-1][0] + length * math.cos(angle), points[-1][1] + length * math.sin(angle)))
    out: list[Stretch] = []
    at = points[0]
    for k in range(1, len(points) - 1):
        before, corner, after = points[k - 1], points[k], points[k + 1]
        u = _unit(before, corner)
        w = _unit(corner, after)
        cross = u[0] * w[1] - u[1] * w[0]
        turn = abs(math.atan2(cross, u[0] * w[0] + u[1] * w[1]))
        if turn < math.radians(3.5):
            # Hardly a corner: straight on.
            points[k + 1] = (corner[0] + u[0] * 60, corner[1] + u[1] * 60)
            continue
        if sharp and cross * side < 0:
            out.append(Stretch(at, corner))
            at = corner
            continue
        sense = 1 if cross > 0 else -1
        fillet = rng.uniform(1.05, 3.0) * radius if cross * side > 0 else rng.uniform(0.2, 3.0) * radius
        back = fillet * math.tan(turn / 2)
        first = (corner[0] - u[0] * back, corner[1] - u[1] * back)
        last = (corner[0] + w[0] * back, corner[1] + w[1] * back)
        center = (first[0] - sense * u[1] * fillet, first[1] + sense * u[0] * fillet)
        out += [Stretch(at, first), Stretch(first, last, center, sense)]
        at = last
    out.append(Stretch(at, points[-1]))
    return out


def _unit(a: Point, b: Point) -> Point:
    length = math.dist(a, b)
    return (b[0] - a[0]) / length, (b[1] - a[1]) / length
