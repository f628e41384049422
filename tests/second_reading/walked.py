"""What the three readings share, and nothing that a controller means: sampled points, limits, open questions.

A reading walks a program and leaves points in machine coordinates (mm, degrees), each piece with the limits that held.
Where a manual has two readings the interpreter asks `Questions`; `every_reading` runs it once for each answer.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field

Point = dict[str, float]
Limits = Mapping[str, tuple[float | None, float | None]]
MOST_READINGS = 96
STEP_OF_ARC = math.radians(1.0)


class NotRead(Exception):
    """The reading does not do this: it makes no statement about the program."""


class Refused(Exception):
    """The controller stops here with an error, as its manual says; what ran before has run."""


@dataclass
class Over:
    """A limit exceeded: which axis and side, by how much, mm or degrees, and the line of the move."""

    axis: str
    side: str
    by: float
    line: int


@dataclass
class Walk:
    """The way of a program so far. at: where the machine is; limits: those in force now."""

    at: Point
    limits: Limits
    points: list[Point] = field(default_factory=list)
    over: dict[tuple[str, str], Over] = field(default_factory=dict)
    line: int = 0
    refused: str = ""
    answers: dict[str, int] = field(default_factory=dict)
    """Which reading of each question that came up."""
    most: int = 200_000
    """Points; a program with more is not read."""

    def visit(self, point: Point) -> None:
        """One sample: kept, and held against the limits in force."""
        self.points.append(point)
        if len(self.points) > self.most:
            raise NotRead("too many points")
        for axis, (low, high) in self.limits.items():
            value = point[axis]
            if low is not None and value < low:
                self._exceeded(axis, "lower", low - value)
            if high is not None and value > high:
                self._exceeded(axis, "upper", value - high)

    def _exceeded(self, axis: str, side: str, by: float) -> None:
        if by > 1e-12 and ((axis, side) not in self.over or self.over[axis, side].by < by):
            self.over[axis, side] = Over(axis, side, by, self.line)

    def go(self, target: Mapping[str, float]) -> None:
        """A straight move of all axes together; axes that target does not name stay."""
        start = self.at
        end = {**start, **target}
        if any(not math.isfinite(v) for v in end.values()):
            raise NotRead("a place that is no number")
        # What lies between is no further out than an end, and the start was held against the limits of its time: a way
        # back from outside of limits that came later exceeds none.
        self.points += [{axis: start[axis] + part * (end[axis] - start[axis]) for axis in start} for part in (0.0, 0.5)]
        self.visit(end)
        self.at = end

    def turn(
        self, plane: tuple[str, str], centre: tuple[float, float], angle: float, target: Mapping[str, float]
    ) -> None:
        """An arc about a centre in a plane by an angle, radians, positive from the first axis to the second.

        The other axes run evenly. Where the radii at start and end differ a little, the radius goes evenly from one to
        the other.
        """
        start = self.at
        end = {**start, **target}
        one, two = plane
        first = math.atan2(start[two] - centre[1], start[one] - centre[0])
        begins = math.hypot(start[two] - centre[1], start[one] - centre[0])
        ends = math.hypot(end[two] - centre[1], end[one] - centre[0])
        count = max(2, math.ceil(abs(angle) / STEP_OF_ARC))
        for n in range(count):
            part = n / count
            radius = begins + part * (ends - begins)
            point = {axis: start[axis] + part * (end[axis] - start[axis]) for axis in start}
            point[one] = centre[0] + radius * math.cos(first + part * angle)
            point[two] = centre[1] + radius * math.sin(first + part * angle)
            self.visit(point)
        self.visit(end)
        self.at = end


def swept(
    start: tuple[float, float], end: tuple[float, float], centre: tuple[float, float], *, clockwise: bool
) -> float:
    """The angle of an arc about a centre, radians, negative clockwise; a full circle where start and end are one."""
    angle = math.atan2(end[1] - centre[1], end[0] - centre[0]) - math.atan2(start[1] - centre[1], start[0] - centre[0])
    if math.dist(start, end) < 1e-9:
        return -math.tau if clockwise else math.tau
    angle %= math.tau
    return angle - math.tau if clockwise else angle


def centre_of(
    start: tuple[float, float], end: tuple[float, float], radius: float, *, clockwise: bool
) -> tuple[float, float]:
    """The centre of the arc with a radius: at most half a turn where it is positive, at least where negative."""
    apart = math.dist(start, end)
    half = math.sqrt(max(0.0, radius * radius - apart * apart / 4))
    side = 1.0 if clockwise == (radius < 0) else -1.0
    away = ((end[1] - start[1]) / apart * side, -(end[0] - start[0]) / apart * side)
    return (start[0] + end[0]) / 2 - half * away[0], (start[1] + end[1]) / 2 - half * away[1]


class Questions:
    """Answers to what a manual leaves open, one for each name in one reading."""

    def __init__(self, script: tuple[int, ...], settled: Mapping[str, int]) -> None:
        self.script, self.settled = script, settled
        self.asked: list[tuple[str, int, int]] = []
        self.known: dict[str, int] = {}

    def pick(self, name: str, count: int = 2) -> int:
        """Which of `count` readings of `name` this one follows."""
        if name in self.settled:
            return self.settled[name]
        if name not in self.known:
            place = len(self.asked)
            answer = self.script[place] if place < len(self.script) else 0
            self.asked.append((name, answer, count))
            self.known[name] = answer
        return self.known[name]


def every_reading(run: Callable[[Questions], Walk], settled: Mapping[str, int] | None = None) -> Iterator[Walk]:
    """The program walked once for each combination of answers to the questions that come up."""
    script: tuple[int, ...] = ()
    for _ in range(MOST_READINGS):
        questions = Questions(script, settled or {})
        walk = run(questions)
        walk.answers = dict(questions.known)
        yield walk
        answers = [(answer, count) for _, answer, count in questions.asked]
        while answers and answers[-1][0] + 1 == answers[-1][1]:
            answers.pop()
        if not answers:
            return
        script = (*(answer for answer, _ in answers[:-1]), answers[-1][0] + 1)
    raise NotRead("too many readings")
