"""Keep-out zones and limits of whole jobs against a reckoning of their own, in all three dialects.

What of a random job's path (`support.made_jobs`) lies in a zone is found by shapely and by ever denser samples. Whoever
is inside for certain is UNSAFE; what only the free way of a traverse may enter is UNKNOWN (McuWIN manual 3.1; WinCNC's
says nothing of G0); all else is SAFE.
"""

from __future__ import annotations

import cmath
import math
import random
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
import shapely
import shapely.affinity
from support.campaigns import seeds
from support.judging import UNBOUNDED, answer
from support.made_jobs import LENGTH, MAKERS, Made, Move, Points, machine_of, opened

from gproof.driver.judge import judge
from gproof.driver.session import Running
from gproof.ir.verdict import Verdict

SURELY, NEARLY = 1e-6, 1e-3


@dataclass
class Zone:
    """What is kept out of. work: the system that it counts from."""

    region: shapely.Polygon
    z: tuple[float, float]
    work: int = 0

    def text(self) -> str:
        rings = [[list(p) for p in list(ring.coords)[:-1]] for ring in (self.region.exterior, *self.region.interiors)]
        low, high = (repr(v) for v in self.z)
        out = f'[[keep_out]]\nname = "clamp"\npolygon = {rings[0]}\nholes = {rings[1:]}\nz = [{low}, {high}]\n'
        return out + (f"work = {self.work}\n" if self.work else "")


def zone_near(rng: random.Random, made: Made, tool: Tool) -> Zone:
    """A box or a polygon, with a hole now and then, whose edge lies near a place of the path."""
    work = rng.choice((0, 0, *made.zeros))
    move = rng.choice(made.moves)
    below, above, diameter, _ = rng.choice([part for part in tool.parts(move, work) if math.isfinite(part[1])])
    spot = move.at(np.array([rng.random()]))[0] - np.array([0.0, 0.0, move.length])
    if work:
        spot = spot - np.array(made.zeros[work])
    size = rng.choice((0.5, 6.0, 25.0)) * rng.uniform(0.6, 1.4)
    gap = rng.choice((0.0, 1e-4, 0.02, 1.0, -0.02, -1.0)) + diameter / 2
    side = cmath.exp(1j * rng.uniform(-math.pi, math.pi))
    corner = spot[:2] + np.array([side.real, side.imag]) * (gap + rng.choice((0.0, size / 2)))
    if rng.random() < 0.4:
        region = shapely.box(corner[0], corner[1], corner[0] + size, corner[1] + size * rng.uniform(0.3, 2.0))
    else:
        shape = rng.choice((
            [(0, 0), (2, 0), (2, 0.5), (0.7, 0.8), (0.4, 2), (0, 2)], [(0, 0), (1, 0.2), (0.4, 1.3)],
            [(0, 0), (1.2, -0.3), (1.5, 1.0), (0.8, 0.3), (-0.2, 1.1)],
        ))  # fmt: skip
        turn = cmath.exp(1j * rng.uniform(-math.pi, math.pi)) * size
        ends = [complex(*corner) + turn * complex(*p) for p in shape]
        region = shapely.Polygon([(p.real, p.imag) for p in ends])
    if rng.random() < 0.25:
        hole = shapely.affinity.scale(region, 0.4, 0.4, origin=region.representative_point())
        if region.buffer(-1e-3).contains(hole):
            region = shapely.Polygon(region.exterior.coords, [hole.exterior.coords])
    low = spot[2] + above - rng.choice((0.01, 5.0, 40.0, -0.01)) * rng.uniform(0.2, 1.0)
    high = spot[2] + below + rng.choice((0.01, 5.0, 40.0, -0.01)) * rng.uniform(0.2, 1.0)
    high = max(high, low + 0.1)
    return Zone(region, (float("-inf") if rng.random() < 0.3 else float(low), float(high)), work)


# -- what is true


Part = tuple[float, float, float, float]
"""Heights above the tip, least and greatest diameter."""


@dataclass
class Tool:
    """An entry of the tool table. holder: its parts, (diameter below, above, height)."""

    diameter: float = 0.0
    flute: float | None = None
    shank: float | None = None
    stickout: float | None = None
    holder: tuple[tuple[float, float, float], ...] = ()

    def text(self) -> str:
        keys = {"diameter": self.diameter or None, "flute_length": self.flute, "shank_diameter": self.shank}
        keys["stickout"] = self.stickout
        out = "".join(f"{key} = {value!r}\n" for key, value in keys.items() if value is not None)
        rows = f"holder = {[list(row) for row in self.holder]}\n" if self.holder else ""
        return f"[tools.1]\nlength = {LENGTH}\n{out}{rows}"

    @property
    def high(self) -> float:
        """How far up it is at least as wide as its cutter."""
        if self.stickout is not None and (self.shank is None or self.shank >= self.diameter):
            return max(self.flute or 0.0, self.stickout)
        return self.flute or 0.0

    def parts(self, move: Move, work: int) -> list[Part]:
        """What is looked at: beside a zone of the machine from the tip up to the controlled point, and no less.

        Above what is stated the tool goes on, perhaps as wide; of one without a diameter only the tip is certain.
        """
        top = self.high if work else max(self.high, move.length)
        if self.diameter:
            out = [(0.0, top, self.diameter, self.diameter), (0.0, math.inf, -math.inf, self.diameter)]
        else:
            out = [(0.0, 0.0 if work else move.length, 0.0, 0.0), (0.0, math.inf, -math.inf, math.inf)]
        if self.flute is not None and self.shank is not None and self.shank > self.diameter:
            out.append((self.flute, max(self.flute, self.stickout or 0.0), self.shank, self.shank))
        at = self.stickout
        for below, above, height in self.holder:
            assert at is not None
            if max(below, above) > self.diameter:
                out.append((at, at + height, min(below, above), max(below, above)))
            at += height
        return out


def tool_of(rng: random.Random) -> Tool:
    """One of which nobody knows the width, a plain cutter, or one with a shank and a holder."""
    diameter = rng.choice((0.0, 1.0, 3.0, 3.0, 12.5, 12.5))
    if rng.random() < 0.5:
        return Tool(diameter, rng.choice((None, 60.0)))
    flute = rng.choice((None, 4.0, 11.0))
    stickout = rng.choice((None, 11.0, 20.0))
    holder = ((20.0, 20.0, 6.0), (20.0, 30.0, 5.0), (30.0, 30.0, 9.0))[: rng.randrange(4)] if stickout else ()
    return Tool(diameter, flute, rng.choice((None, 3.0, 16.0)), stickout, holder)


def deepest(made: Made, zone: Zone, tool: Tool) -> tuple[float, float]:
    """mm that some move goes into the zone for certain, and that some may at most; less than 0: beside it."""
    sure = possible = -math.inf
    for move in made.moves:
        shift = np.array([0.0, 0.0, move.length])
        if zone.work:
            shift += np.array(made.zeros[zone.work])
        for below, above, least, most in tool.parts(move, zone.work):
            low, high = zone.z[0] - above, zone.z[1] - below
            if move.free:
                possible = max(possible, in_box(zone, low, high, most, move.ends - shift))
                sure = max(sure, float(depths(zone, low, high, least, move.ends - shift).max()))
            else:
                sure = max(sure, searched(zone, low, high, least, move, shift))
                if most > least:
                    possible = max(possible, searched(zone, low, high, most, move, shift))
    return sure, max(sure, possible)


def in_box(zone: Zone, low: float, high: float, diameter: float, ends: Points) -> float:
    """For any way between two places."""
    (x0, y0, z0), (x1, y1, z1) = ends
    box = shapely.box(min(x0, x1), min(y0, y1), max(x0, x1), max(y0, y1))
    across = diameter / 2 - zone.region.distance(box)
    if zone.region.intersects(box):
        across = max(across, diameter / 2 + inner(zone.region, box))
    return min(across, max(z0, z1) - low, high - min(z0, z1))


def searched(zone: Zone, low: float, high: float, diameter: float, move: Move, shift: Points) -> float:
    """By ever denser samples around the deepest ones."""
    best = -math.inf
    t, step = np.linspace(0.0, 1.0, 801), 1 / 800
    for _ in range(5):
        found = depths(zone, low, high, diameter, move.at(t) - shift)
        best = max(best, float(found.max()))
        if best < -1.0 - 800 * step * 100.0:
            break
        chosen = t[np.argsort(-found)[:8]]
        t = np.clip((chosen[:, None] + np.linspace(-step, step, 41)).ravel(), 0.0, 1.0)
        step /= 20
    return best


def inner(region: shapely.Polygon, box: shapely.Polygon) -> float:
    """About how deep a box reaches into a region: never more than it does."""
    common = shapely.intersection(region, box)
    if common.area <= 0.0 and common.length <= 0.0:
        return 0.0
    spot = common.representative_point()
    return float(region.exterior.distance(spot)) if not region.interiors else float(region.boundary.distance(spot))


def depths(zone: Zone, low: float, high: float, diameter: float, points: Points) -> Points:
    spots = shapely.points(points[:, :2])
    away = shapely.distance(zone.region, spots)
    inside = shapely.contains(zone.region, spots)
    depth = np.where(inside, shapely.distance(zone.region.boundary, spots), -away) + diameter / 2
    found: Points = np.minimum(np.minimum(depth, points[:, 2] - low), high - points[:, 2])
    return found


@pytest.mark.parametrize("name", MAKERS)
@pytest.mark.parametrize("seed", seeds(1, 60))
def test_verdicts_are_what_the_path_does(name: str, seed: int, tmp_path: Path) -> None:
    seen: set[Verdict] = set()
    for case in range(25):
        rng = random.Random(f"{name} {seed} {case}")
        made = MAKERS[name](rng)
        tool = tool_of(rng)
        zone = zone_near(rng, made, tool)
        points = made.points()
        room = np.array([[rng.choice((2e-6, 1e-3, 1.0, 30.0, 30.0, 30.0)) for _ in "xyz"] for _ in range(2)])
        if rng.random() < 0.3:
            room[rng.randrange(2), rng.randrange(3)] = -rng.choice((2e-6, 1e-3, 1.0))
        low, high = points.min(axis=0) - room[0], points.max(axis=0) + room[1]
        limits = np.array([low, np.maximum(high, low + 1.0)])
        machine = machine_of(made, limits, tool.text() + zone.text())
        judgement = judge(opened(tmp_path, made, machine), running=Running(UNBOUNDED))
        told = "".join(f"{f.span.line}: {f.code.label} {f.message}\n" for f in judgement.findings.kept)
        where = f"{name} seed {seed} case {case}\n{made.program}{machine}{made.setup}{told}"
        assert answer(judgement, "language").verdict is Verdict.SAFE, where
        assert answer(judgement, "arcs").verdict is Verdict.SAFE, where
        verdict = answer(judgement, "areas").verdict
        sure, possible = deepest(made, zone, tool)
        where = f"{sure} mm inside, {possible} perhaps\n{where}"
        if sure > SURELY:
            assert verdict is Verdict.UNSAFE, where
        elif possible > SURELY:
            assert verdict is not Verdict.SAFE, where
        if verdict is Verdict.UNSAFE:
            assert sure > -NEARLY, where
        if verdict is Verdict.UNKNOWN:
            assert possible > -NEARLY, where
        seen.add(verdict)
        beyond = float(np.maximum(limits[0] - points, points - limits[1]).max())
        inside = answer(judgement, "limits").verdict
        if beyond > SURELY:
            assert inside is Verdict.UNSAFE, f"{beyond} beyond\n{where}"
        if inside is not Verdict.SAFE:
            assert beyond > -NEARLY, f"{beyond} beyond\n{where}"
    assert {Verdict.SAFE, Verdict.UNSAFE} <= seen
