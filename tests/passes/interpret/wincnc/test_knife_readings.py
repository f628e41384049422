"""Every reading of the manual stays within the places that the trace gives a knife: random jobs, walked by hand.

The walker below knows nothing of the passes: it takes one reading of each open question (docs/dialects/wincnc.md, Knife
and saw) and says where the vertical axis and the knife go, line by line.
"""

from __future__ import annotations

import math
import random
from dataclasses import dataclass
from pathlib import Path

import pytest
from passes.interpret.wincnc.test_knife import bad, opened, rows_of

LIFT, PLUNGE, ANGLE = 5.0, -2.0, 30.0
NEAR = 1e-4


@dataclass
class Line:
    """A line of a job: G0 to G3 to a place, Z where it has one, the centre of an arc."""

    code: int
    x: float
    y: float
    z: float | None = None
    center: tuple[float, float] | None = None

    def text(self, at: tuple[float, float]) -> str:
        words = f"G{self.code}"
        if (self.x, self.y) != at:
            words += f" X{self.x!r} Y{self.y!r}"
        if self.center is not None:
            words += f" I{self.center[0] - at[0]!r} J{self.center[1] - at[1]!r}"
        return words if self.z is None else f"{words} Z{self.z!r}"


@dataclass
class Reading:
    """One answer to each question that the manual leaves open."""

    automatic: bool
    target: bool
    lifts_in_arcs: bool
    rng: random.Random

    def __post_init__(self) -> None:
        rng = self.rng
        self.by_itself = self.automatic and rng.random() < 0.5
        self.back_to_plunge = rng.random() < 0.5
        self.shift = rng.choice([0.0, 1.0])
        self.corner_of_arc = rng.random() < 0.5
        self.turns_in_rapids = self.target and rng.random() < 0.5
        self.corrects = rng.random() < 0.5

    def maybe(self) -> bool:
        return self.rng.random() < 0.5


def nearest(at: float, direction: float) -> float:
    turn = (direction - at + 180.0) % 360.0 - 180.0
    return at + (180.0 if turn == -180.0 else turn)


class Walker:
    """Where (Z, knife) go in machine places; local: where the local zero of Z lies."""

    def __init__(self, reading: Reading, z: float, local: float) -> None:
        self.r, self.z, self.c, self.at, self.local = reading, z, 0.0, (0.0, 0.0), local
        self.top, self.bottom = LIFT + reading.shift * local, PLUNGE + reading.shift * local
        self.seen: list[tuple[float, float]] = []

    def here(self) -> None:
        self.seen.append((self.z, self.c))

    def go(self, z: float) -> None:
        self.z = z
        self.here()

    def raise_(self) -> None:
        if self.z < self.top or self.r.maybe():
            self.go(self.top)

    def switched(self) -> None:
        if self.r.by_itself and self.r.maybe():
            self.go(self.top)

    def line(self, line: Line) -> None:
        moves = (line.x, line.y) != self.at or line.center is not None
        wanted = None if line.z is None else line.z + self.local
        if line.code == 0:
            if self.r.by_itself:
                self.go(self.top)
            if moves and self.r.turns_in_rapids:
                self.turn_some(self.direction(line)[0])
            self.go(self.z if wanted is None else self.top if self.r.by_itself and self.r.maybe() else wanted)
        elif not moves:
            assert wanted is not None
            self.go(self.bottom if self.r.by_itself and self.r.maybe() else wanted)
        else:
            self.cut(line, wanted)
        self.at = line.x, line.y

    def direction(self, line: Line) -> tuple[float, float]:
        (x, y), arc = self.at, line.center
        if arc is None:
            return math.degrees(math.atan2(line.y - y, line.x - x)), 0.0
        sign = 1 if line.code == 3 else -1
        first, last = math.atan2(y - arc[1], x - arc[0]), math.atan2(line.y - arc[1], line.x - arc[0])
        sweep = (last - first) * sign % (2 * math.pi) or 2 * math.pi
        return math.degrees(first) + 90 * sign, math.degrees(sweep) * sign

    def turn_some(self, direction: float) -> None:
        self.c += self.r.rng.choice([0.0, 1.0, self.r.rng.random()]) * (nearest(self.c, direction) - self.c)
        self.here()

    def cut(self, line: Line, wanted: float | None) -> None:
        direction, along = self.direction(line)
        arc, before, r = line.center is not None, self.z, self.r
        to = nearest(self.c, direction)
        lifts = abs(to - self.c) > ANGLE + 1e-9
        if (arc and not r.lifts_in_arcs and not r.corner_of_arc) or (r.target and not r.corrects):
            lifts = False
        if lifts:
            self.raise_()
        if not r.target or (lifts and r.maybe()):
            self.c = to
            self.here()
        if r.by_itself or (lifts and r.back_to_plunge):
            self.go(self.bottom)
        elif lifts:
            self.go(before)
        if wanted is not None and not (r.by_itself and r.maybe()):
            end = wanted
        else:
            end = self.z
        if r.target:
            self.turn_some(direction + (along if r.maybe() else 0.0) if along else direction)
        if arc and r.lifts_in_arcs and r.maybe():
            down = self.z
            self.raise_()
            self.go(down)
        if not r.target:
            self.c += along
        self.go(end)


def job(rng: random.Random) -> list[Line]:
    lines, at = [], (0.0, 0.0)
    for _ in range(9):
        kind = rng.random()
        to = round(rng.uniform(-40, 40), 2), round(rng.uniform(-40, 40), 2)
        if kind < 0.2:
            lines.append(Line(0, *to, z=rng.choice([None, None, 1.0, 6.0])))
        elif kind < 0.35:
            to = at
            lines.append(Line(rng.choice([0, 1]), *at, z=rng.choice([-2.0, -1.0, 3.0, 7.0])))
        elif kind < 0.6:
            # Half a circle, or a part of one about a centre from which both ends are as far.
            middle, way = ((at[0] + to[0]) / 2, (at[1] + to[1]) / 2), rng.choice([0.0, 0.5, -1.0])
            center = middle[0] - way * (to[1] - at[1]), middle[1] + way * (to[0] - at[0])
            lines.append(Line(rng.choice([2, 3]), *to, center=center))
        else:
            if rng.random() < 0.5 and lines:
                turn = math.radians(rng.choice([5, -20, 29, 45, -100]))
                to = round(at[0] + 9 * math.cos(turn), 3), round(at[1] + 9 * math.sin(turn), 3)
            lines.append(Line(1, *to, z=rng.choice([None, None, None, -2.0, -3.0])))
        at = to
    return lines


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("automatic", [False, True])
@pytest.mark.parametrize("target", [False, True])
@pytest.mark.parametrize("lifts_in_arcs", [False, True])
def test_every_reading_is_inside(seed: int, automatic: bool, target: bool, lifts_in_arcs: bool, tmp_path: Path) -> None:
    rng = random.Random(seed)
    lines = job(rng)
    local = rng.choice([0.0, -20.0, 0.5])
    text, at = f"G90\nG0 Z{local!r}\nG92 Z0\nG1 Z-2\nL30\n", (0.0, 0.0)
    for line in lines:
        text += line.text(at) + "\n"
        at = line.x, line.y
    knife = f"t{target:d} a30 n3 z5 p-2 m{automatic:d} r{lifts_in_arcs:d}"
    session = opened(tmp_path, text + "L31\n", knife)
    rows = rows_of(session)
    assert bad(session) == {}, text
    boxes: dict[int, list[tuple[float, float, float, float]]] = {}
    before = (0.0, 0.0, 0.0, 0.0)
    for row in rows:
        if "at" in row:
            boxes.setdefault(row["line"], [before]).append(now := (*row["at"]["z"], *row["at"]["c"]))
            before = now
    for n in range(40):
        reading = Reading(automatic, target, lifts_in_arcs, random.Random(1000 * seed + n))
        walker = Walker(reading, local - 2.0, local)
        places: list[tuple[int, float, float]] = []
        for number, line in enumerate([None, *lines, None], 5):
            walker.seen = []
            walker.switched() if line is None else walker.line(line)
            places += [(number, *place) for place in walker.seen]
        for number, z, c in places:
            found = boxes.get(number) or [[box for at, seen in boxes.items() if at < number for box in seen[-1:]][-1]]
            low, high = min(box[0] for box in found), max(box[1] for box in found)
            left, right = min(box[2] for box in found), max(box[3] for box in found)
            said = f"{text}\nline {number}: Z{z} C{c}, not in {low} to {high}, {left} to {right}; {vars(reading)}"
            assert low - NEAR <= z <= high + NEAR and left - NEAR <= c <= right + NEAR, said
