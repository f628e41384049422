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
from support.made_jobs import LENGTH, MAKERS, Made, Points, machine_of, opened

from gproof.cli.judge import judge
from gproof.cli.session import Running
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


def zone_near(rng: random.Random, made: Made, diameter: float) -> Zone:
    """A box or a polygon, with a hole now and then, whose edge lies near a place of the path."""
    work = rng.choice((0, 0, *made.zeros))
    move = rng.choice(made.moves)
    spot = move.at(np.array([rng.random()]))[0]
    length = 0.0
    if work:
        spot = spot - np.array(made.zeros[work]) - np.array([0.0, 0.0, move.length])
    else:
        length = move.length
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
    low = spot[2] - rng.choice((0.01, 5.0, 40.0)) * rng.uniform(0.2, 1.0)
    high = spot[2] - length + rng.choice((0.01, 5.0, 40.0, -0.01)) * rng.uniform(0.2, 1.0)
    high = max(high, low + 0.1)
    return Zone(region, (float("-inf") if rng.random() < 0.3 else float(low), float(high)), work)


# -- what is true


def deepest(made: Made, zone: Zone, diameter: float) -> tuple[float, float]:
    """mm that some move goes into the zone for certain, and that some may at most; less than 0: beside it."""
    sure = possible = -math.inf
    for move in made.moves:
        low, high = zone.z
        shift = np.zeros(3)
        if zone.work:
            shift = np.array(made.zeros[zone.work]) + np.array([0.0, 0.0, move.length])
        else:
            high += move.length
        if move.free:
            (x0, y0, z0), (x1, y1, z1) = move.ends - shift
            box = shapely.box(min(x0, x1), min(y0, y1), max(x0, x1), max(y0, y1))
            across = diameter / 2 - zone.region.distance(box)
            if zone.region.intersects(box):
                across = max(across, diameter / 2 + inner(zone.region, box))
            up = min(max(z0, z1) - low, high - min(z0, z1))
            possible = max(possible, min(across, up))
            sure = max(sure, float(depths(zone, low, high, diameter, move.ends - shift).max()))
            continue
        t, step = np.linspace(0.0, 1.0, 801), 1 / 800
        for _ in range(5):
            found = depths(zone, low, high, diameter, move.at(t) - shift)
            sure = max(sure, float(found.max()))
            chosen = t[np.argsort(-found)[:8]]
            t = np.clip((chosen[:, None] + np.linspace(-step, step, 41)).ravel(), 0.0, 1.0)
            step /= 20
    return sure, max(sure, possible)


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
@pytest.mark.parametrize("seed", seeds(2, 60))
def test_verdicts_are_what_the_path_does(name: str, seed: int, tmp_path: Path) -> None:
    seen: set[Verdict] = set()
    for case in range(25):
        rng = random.Random(f"{name} {seed} {case}")
        made = MAKERS[name](rng)
        diameter = rng.choice((0.0, 0.0, 3.0, 12.5))
        zone = zone_near(rng, made, diameter)
        points = made.points()
        room = np.array([[rng.choice((2e-6, 1e-3, 1.0, 30.0, 30.0, 30.0)) for _ in "xyz"] for _ in range(2)])
        if rng.random() < 0.3:
            room[rng.randrange(2), rng.randrange(3)] = -rng.choice((2e-6, 1e-3, 1.0))
        low, high = points.min(axis=0) - room[0], points.max(axis=0) + room[1]
        limits = np.array([low, np.maximum(high, low + 1.0)])
        tool = f"[tools.1]\nlength = {LENGTH}\n" + (f"diameter = {diameter!r}\n" if diameter else "")
        machine = machine_of(made, limits, tool + zone.text())
        judgement = judge(opened(tmp_path, made, machine), running=Running(UNBOUNDED))
        told = "".join(f"{f.span.line}: {f.code.label} {f.message}\n" for f in judgement.findings.kept)
        where = f"{name} seed {seed} case {case}\n{made.program}{machine}{made.setup}{told}"
        assert answer(judgement, "language").verdict is Verdict.SAFE, where
        assert answer(judgement, "arcs").verdict is Verdict.SAFE, where
        verdict = answer(judgement, "areas").verdict
        sure, possible = deepest(made, zone, diameter)
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
