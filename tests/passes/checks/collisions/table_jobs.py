"""Random jobs in front of random things on the table, and what is true of them.

Nothing of the checks is used. A piece of a tool is a polygon with rounded corners turned about Z; a body is a stack of
prisms. Of all points at one height the one nearest to the tool's axis is the worst, so that the distance of tool and
prism is a function of the height alone, and convex: its least value is closed in on. Along a move it is looked for at
many places, and more closely beside the best ones.
"""

from __future__ import annotations

import itertools
import math
import random
import struct
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import shapely
import shapely.affinity
import shapely.geometry
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Way = Callable[[Floats], Floats]


@dataclass
class Piece:
    """A convex outline (r, z) from the axis outwards, mm over the tip, and the radius that rounds it."""

    name: str
    outline: list[tuple[float, float]]
    corner: float = 0.0

    def distance(self, r: Floats, z: Floats) -> Floats:
        """Signed distance of points (r from the axis, z over the tip): less than 0 inside."""
        mirrored = [(-x, y) for x, y in reversed(self.outline)]
        points: list[tuple[float, float]] = []
        for point in [*self.outline, *mirrored]:
            if not points or math.dist(points[-1], point) > 1e-12:
                points.append(point)
        if len(points) > 1 and math.dist(points[0], points[-1]) <= 1e-12:
            points.pop()
        near = np.full(r.shape, np.inf)
        deep = np.full(r.shape, -np.inf if len(points) > 1 else np.inf)
        for (ax, ay), (bx, by) in zip(points, [*points[1:], points[0]], strict=True):
            dx, dy = bx - ax, by - ay
            length = math.hypot(dx, dy)
            if length == 0.0:
                near = np.minimum(near, np.hypot(r - ax, z - ay))
                continue
            t = np.clip(((r - ax) * dx + (z - ay) * dy) / length**2, 0.0, 1.0)
            near = np.minimum(near, np.hypot(r - ax - t * dx, z - ay - t * dy))
            deep = np.maximum(deep, ((r - ax) * dy - (z - ay) * dx) / length)
        return np.where(deep < 0.0, -near, near) - self.corner


@dataclass
class Prism:
    """What stands on an area between two heights; the area is a polygon, or a circle (x, y, radius)."""

    area: shapely.Polygon | tuple[float, float, float]
    bottom: float
    top: float

    def away(self, x: Floats, y: Floats) -> Floats:
        if isinstance(self.area, tuple):
            cx, cy, radius = self.area
            return np.maximum(np.hypot(x - cx, y - cy) - radius, 0.0)
        return np.asarray(shapely.distance(self.area, shapely.points(x, y)), dtype=float)

    def least(self, piece: Piece, tip: Floats, enough: float) -> Floats:
        """For each place of the tip the least signed distance of the prism to the piece, inf above `enough`."""
        wide = max(r for r, _ in piece.outline) + piece.corner
        under = min(z for _, z in piece.outline) - piece.corner
        over = max(z for _, z in piece.outline) + piece.corner
        gap = np.maximum(self.bottom - tip[:, 2] - over, under - (self.top - tip[:, 2]))
        out = np.full(len(tip), np.inf)
        index = np.flatnonzero(gap <= enough)
        if not len(index):
            return out
        r = self.away(tip[index, 0], tip[index, 1])
        kept = r - wide <= enough
        index, r = index[kept], r[kept]
        if not len(index):
            return out
        low, high = self.bottom - tip[index, 2], self.top - tip[index, 2]
        first = np.minimum(piece.distance(r, low), piece.distance(r, high))
        low, high = np.minimum(np.maximum(low, under - 1.0), high), np.maximum(np.minimum(high, over + 1.0), low)
        turn = (math.sqrt(5.0) - 1.0) / 2.0
        a, b = high - turn * (high - low), low + turn * (high - low)
        at_a, at_b = piece.distance(r, a), piece.distance(r, b)
        for _ in range(42):
            left = at_a <= at_b
            high, low = np.where(left, b, high), np.where(left, low, a)
            a, b = np.where(left, high - turn * (high - low), b), np.where(left, a, low + turn * (high - low))
            new = piece.distance(r, np.where(left, a, b))
            at_a, at_b = np.where(left, new, at_b), np.where(left, at_a, new)
        out[index] = np.minimum(first, np.minimum(at_a, at_b))
        return out


def least_on(ways: list[tuple[Way, int]], bodies: list[Prism], piece: Piece, enough: float) -> float:
    """The least signed distance over moves: never less than what is true; inf where there is none below `enough`."""
    best = math.inf
    times = [np.linspace(0.0, 1.0, places) for _, places in ways]
    tips = np.concatenate([way(t) for (way, _), t in zip(ways, times, strict=True)])
    edges = np.cumsum([0, *(len(t) for t in times)])
    for body in bodies:
        value = body.least(piece, tips, enough + 3.0 * piece_step(tips))
        for at in np.argsort(value)[:3]:
            if not np.isfinite(value[at]):
                break
            best = min(best, float(value[at]))
            number = int(np.searchsorted(edges, at, side="right")) - 1
            way, t = ways[number][0], times[number]
            place = int(at - edges[number])
            low, high = t[max(place - 1, 0)], t[min(place + 1, len(t) - 1)]
            for _ in range(4):
                finer = np.linspace(low, high, 25)
                found = body.least(piece, way(finer), math.inf)
                spot = int(found.argmin())
                best = min(best, float(found[spot]))
                low, high = finer[max(spot - 1, 0)], finer[min(spot + 1, 24)]
    return best


def piece_step(tips: Floats) -> float:
    """How far two neighbouring places are apart, at most, but for jumps between moves."""
    return float(np.quantile(np.abs(np.diff(tips, axis=0)).max(axis=1), 0.97)) if len(tips) > 1 else 0.0


@dataclass
class ToolOf:
    number: int
    lines: list[str]
    cutter: Piece
    others: list[Piece]
    length: float
    diameter: float


def num(rng: random.Random, low: float, high: float, digits: int = 3) -> float:
    return round(rng.uniform(low, high), digits)


def a_tool(rng: random.Random, number: int, scale: float) -> ToolOf:
    kind = rng.choice(["flat", "ball", "bull", "vee", "drill"])
    d = max(round(num(rng, 0.5, 12.0) * scale, 6), 1e-3)
    radius = d / 2.0
    flute = round(max(num(rng, 0.2, 4.0) * d, 1e-3), 6)
    lines = [f"[tools.{number}]", f'shape = "{kind}"', f"diameter = {d}"]
    corner = 0.0
    if kind == "flat":
        outline = [(0.0, 0.0), (radius, 0.0), (radius, flute), (0.0, flute)]
    elif kind in ("ball", "bull"):
        corner = radius
        if kind == "bull":
            corner = rng.choice([radius, round(radius * rng.random(), 6), 0.0, round(radius * 0.999, 6)])
            lines.append(f"corner_radius = {corner}")
        flute = round(max(flute, corner), 6)
        outline = [(0.0, corner), (radius - corner, corner), (radius - corner, flute), (0.0, flute)]
    else:
        angle = rng.choice([60.0, 90.0, 118.0, 150.0, 20.0, num(rng, 15, 170)])
        tip = 0.0
        if kind == "vee":
            tip = rng.choice([0.0, round(d * rng.random(), 6), round(d * 0.1, 6)])
            if tip:
                lines.append(f"tip_diameter = {tip}")
        lines.append(f"tip_angle = {angle}")
        rise = (radius - tip / 2.0) / math.tan(math.radians(angle / 2.0))
        if flute > rise:
            outline = [(0.0, 0.0), (tip / 2.0, 0.0), (radius, rise), (radius, flute), (0.0, flute)]
        else:
            wide = tip / 2.0 + flute * math.tan(math.radians(angle / 2.0))
            outline = [(0.0, 0.0), (tip / 2.0, 0.0), (wide, flute), (0.0, flute)]
    cutter = Piece("cutter", outline, corner)
    shank = round(d * rng.choice([1.0, rng.uniform(0.3, 1.0), rng.uniform(1.0, 3.0)]), 6)
    stick = round(flute * rng.choice([1.0, rng.uniform(1.0, 3.0), 1.0 + rng.random() * 0.2]), 6)
    stick = max(stick, flute)
    others = []
    if stick > flute:
        others.append(Piece("shank", [(0.0, flute), (shank / 2, flute), (shank / 2, stick), (0.0, stick)]))
    at, holder = stick, []
    for _ in range(rng.randint(1, 3)):
        below, above = (max(round(d * rng.uniform(0.5, 5.0), 6), 1e-3) for _ in range(2))
        if rng.random() < 0.4:
            above = below
        high = max(round(d * rng.uniform(0.2, 4.0), 6), 1e-3)
        holder.append([below, above, high])
        others.append(Piece("holder", [(0.0, at), (below / 2, at), (above / 2, at + high), (0.0, at + high)]))
        at += high
    roof = [round(2.0 * d, 6), round(3.0 * d, 6), 1000.0 * scale]
    holder.append(roof)
    others.append(Piece("holder", [(0.0, at), (roof[0] / 2, at), (roof[1] / 2, at + roof[2]), (0.0, at + roof[2])]))
    length = round(num(rng, 10, 80) * scale, 6)
    lines += [f"flute_length = {flute}", f"shank_diameter = {shank}", f"stickout = {stick}", f"holder = {holder}"]
    lines += [f"length = {length}"]
    return ToolOf(number, lines, cutter, others, length, d)


@dataclass
class Thing:
    lines: list[str]
    prisms: list[Prism]


def stl_of(polygon: shapely.Polygon, bottom: float, top: float) -> bytes:
    """A closed mesh of a prism: constrained triangles of the polygon below and above, walls between."""
    facets: list[list[tuple[float, float, float]]] = []
    for triangle in shapely.constrained_delaunay_triangles(polygon).geoms:
        points = list(shapely.geometry.polygon.orient(triangle).exterior.coords)[:3]
        facets.append([(x, y, top) for x, y in points])
        facets.append([(x, y, bottom) for x, y in reversed(points)])
    oriented = shapely.geometry.polygon.orient(polygon)
    for ring in [oriented.exterior, *oriented.interiors]:
        around = list(ring.coords)
        for (ax, ay), (bx, by) in itertools.pairwise(around):
            facets.append([(ax, ay, bottom), (bx, by, bottom), (bx, by, top)])
            facets.append([(ax, ay, bottom), (bx, by, top), (ax, ay, top)])
    out = b"\0" * 80 + struct.pack("<I", len(facets))
    for facet in facets:
        out += struct.pack("<3f", 0, 0, 0) + b"".join(struct.pack("<3f", *p) for p in facet) + b"\0\0"
    return out


def star(rng: random.Random, x: float, y: float, size: float, corners: int) -> list[list[float]]:
    angles = sorted(rng.uniform(0, 2 * math.pi) for _ in range(corners))
    return [
        [
            round(x + size * rng.uniform(0.4, 1.0) * math.cos(a), 6),
            round(y + size * rng.uniform(0.4, 1.0) * math.sin(a), 6),
        ]
        for a in angles
    ]


def a_thing(rng: random.Random, kind: str, centre: Floats, size: float, folder: Path, name: str) -> Thing:
    x, y, z = (round(float(v), 6) for v in centre)
    wide, deep, high = (max(round(size * rng.choice([1.0, rng.random(), 0.02]), 6), 1e-3) for _ in range(3))
    head = [f"[[{kind}]]", f'name = "{name}"']
    shape = rng.choice(["box", "box", "cylinder", "polygon", "stl", "pockets"])
    if shape == "box":
        top = [round(x + wide, 6), round(y + deep, 6), round(z + high, 6)]
        area = shapely.box(x, y, top[0], top[1])
        return Thing([*head, f"box = [[{x}, {y}, {z}], {top}]"], [Prism(area, z, top[2])])
    if shape == "cylinder":
        top = round(z + high, 6)
        line = f"cylinder = {{ x = {x}, y = {y}, diameter = {wide}, bottom = {z}, top = {top} }}"
        return Thing([*head, line], [Prism((x, y, wide / 2), z, top)])
    for _ in range(50):
        ring = star(rng, x, y, size, rng.randint(3, 9))
        polygon = shapely.Polygon(ring)
        if polygon.is_valid and polygon.area > 0.02 * size * size:
            break
    else:
        ring = [[x, y], [x + size, y], [x, y + size]]
        polygon = shapely.Polygon(ring)
    top = round(z + high, 6)
    if shape == "stl":
        ring = [[float(np.float32(v)) for v in p] for p in ring]
        polygon = shapely.Polygon(ring)
        z, top = float(np.float32(z)), float(np.float32(top))
        if not polygon.is_valid or top <= z:
            return a_thing(rng, kind, centre, size, folder, name)
        (folder / f"{name}.stl").write_bytes(stl_of(polygon, z, top))
        return Thing([*head, f'stl = "{name}.stl"'], [Prism(polygon, z, top)])
    lines = [*head, f"polygon = {ring}", f"bottom = {z}", f"top = {top}"]
    prisms = [Prism(polygon, z, top)]
    if shape == "pockets" or rng.random() < 0.3:
        inner = polygon.buffer(-0.1 * size)
        if not inner.is_empty and inner.geom_type == "Polygon":
            cx, cy = inner.representative_point().coords[0]
            r = round(min(0.09 * size + shapely.distance(inner.exterior, shapely.Point(cx, cy)), 0.6 * size) * 0.9, 6)
            cx, cy, r = round(float(cx), 6), round(float(cy), 6), float(r)
            small = [[round(cx - r * 0.6, 6), round(cy - r * 0.6, 6)], [round(cx + r * 0.6, 6), round(cy - r * 0.5, 6)],
                     [cx, round(cy + r * 0.7, 6)]]  # fmt: skip
            if polygon.contains(shapely.Polygon(small)):
                if shape == "pockets":
                    floor = round(z + (top - z) * rng.random(), 6)
                    lines.append(f"pockets = [{{ polygon = {small}, floor = {floor} }}]")
                    prisms = [Prism(polygon, z, floor), Prism(polygon.difference(shapely.Polygon(small)), floor, top)]
                else:
                    lines.append(f"holes = [{small}]")
                    prisms = [Prism(polygon.difference(shapely.Polygon(small)), z, top)]
    if rng.random() < 0.25:
        degrees = rng.choice([90.0, num(rng, -180, 180)])
        shift = [num(rng, -1, 1) * size for _ in range(3)]
        lines += [f"rotate = {degrees}", f"shift = {shift}"]
        moved = []
        for prism in prisms:
            assert not isinstance(prism.area, tuple)
            area = shapely.affinity.translate(shapely.affinity.rotate(prism.area, degrees, (0, 0)), shift[0], shift[1])
            moved.append(Prism(area, prism.bottom + shift[2], prism.top + shift[2]))
        prisms = moved
    return Thing(lines, prisms)


@dataclass
class Job:
    text: list[str] = field(default_factory=list)
    ways: list[tuple[ToolOf, Way, int, str]] = field(default_factory=list)
    at: Floats = field(default_factory=lambda: np.zeros(3))
    plain: bool = True


def straight(a: Floats, b: Floats) -> Way:
    return lambda t: a + np.outer(t, b - a)


def turning(
    centre: Floats, r: float, first: float, sweep: float, axes: tuple[int, int, int], rise: tuple[float, float]
) -> Way:
    def way(t: Floats) -> Floats:
        out = np.empty((len(t), 3))
        angle = first + sweep * t
        out[:, axes[0]] = centre[axes[0]] + r * np.cos(angle)
        out[:, axes[1]] = centre[axes[1]] + r * np.sin(angle)
        out[:, axes[2]] = rise[0] + (rise[1] - rise[0]) * t
        return out

    return way


class Scene:
    """One job, its machine and its setup."""

    def __init__(self, seed: int, folder: Path) -> None:
        rng = random.Random(seed)
        self.seed, self.folder, self.rng = seed, folder, rng
        scale = rng.choice([1.0, 1.0, 1.0, 1.0, 0.01, 100.0])
        self.scale = scale
        self.far = np.array([rng.choice([0.0, 0.0, 0.0, num(rng, -1e4, 1e4)]) for _ in range(3)])
        self.tools = [a_tool(rng, n, scale) for n in (1, 2)]
        self.tolerance = rng.choice([0.001, 0.01, 0.1, 1.0])
        self.clearance = rng.choice([0.0, 0.0, 0.5, 1.0, 3.0]) * scale
        self.inch = rng.random() < 0.15
        self.unit = 25.4 if self.inch else 1.0
        self.shift2 = np.array([num(rng, -20, 20) for _ in range(3)]) * scale
        self.stated = rng.random() < 0.5
        self.slack = 0.0
        self.job = Job()
        self.program()
        self.bodies()

    def say(self, line: str) -> None:
        self.job.text.append(line)

    def n(self, value: float) -> str:
        return f"{value / self.unit:.6f}"

    def program(self) -> None:
        rng, job, s = self.rng, self.job, self.scale
        self.tool = self.tools[0]
        self.zero = np.zeros(3)
        self.relative = False
        self.say(f"{'G20' if self.inch else 'G21'} G17 G90 G94 G54 G40 G49 G80")
        if rng.random() < 0.3:
            p = rng.choice([0.0, 0.05, 0.5]) * min(s, 1.0)
            self.slack = p
            self.say("G61" if rng.random() < 0.3 else f"G64 P{self.n(p)}")
            if job.text[-1] == "G61":
                self.slack = 0.0
        else:
            self.say("G61")
        self.say("T1 M6")
        self.say("G43 H1")
        self.say("M3 S12000")
        self.say(f"F{self.n(600)}")
        job.at = self.quantised(self.far + np.array([num(rng, -30, 30) * s, num(rng, -30, 30) * s, 40.0 * s]))
        self.say(f"G0 X{self.n(job.at[0])} Y{self.n(job.at[1])} Z{self.n(job.at[2])}")
        job.ways.append((self.tool, straight(job.at, job.at), 1, self.job.text[-1]))
        for _ in range(rng.randint(2, 14)):
            self.step()
        if self.relative:
            self.say("G90")
        self.say("M5")
        self.say("M30")

    def quantised(self, place: Floats) -> Floats:
        return np.array([float(self.n(v - z)) * self.unit + z for v, z in zip(place, self.zero, strict=True)])

    def words(self, target: Floats, axes: str = "XYZ") -> tuple[str, Floats]:
        """Axis words to the target, and where they lead."""
        end = self.job.at.copy()
        out = []
        for name in axes:
            k = "XYZ".index(name)
            given = target[k] - (self.job.at[k] if self.relative else self.zero[k])
            text = self.n(given)
            out.append(f"{name}{text}")
            end[k] = float(text) * self.unit + (self.job.at[k] if self.relative else self.zero[k])
        return " ".join(out), end

    def somewhere(self) -> Floats:
        rng, s = self.rng, self.scale
        return self.far + np.array([num(rng, -30, 30), num(rng, -30, 30), num(rng, -15, 30)]) * s

    def line(self, target: Floats, axes: str, word: str, prefix: str = "") -> None:
        text, end = self.words(target, axes)
        self.say(f"{prefix}{word} {text}")
        self.job.ways.append((self.tool, straight(self.job.at.copy(), end), 60, self.job.text[-1]))
        self.job.at = end

    def step(self) -> None:
        rng, job, s = self.rng, self.job, self.scale
        what = rng.choice(
            ["line"] * 6 + ["z", "z", "none", "arc", "arc", "arc", "tool", "zero", "drill", "relative", "loop", "near"]
        )
        if what == "line":
            axes = "".join(a for a in "XYZ" if rng.random() < 0.6) or "X"
            self.line(self.somewhere(), axes, rng.choice(["G0", "G1", "G1"]))
        elif what == "z":
            self.line(self.somewhere(), "Z", rng.choice(["G0", "G1"]))
        elif what == "near":
            self.line(job.at + np.array([num(rng, -1, 1) for _ in range(3)]) * 0.01 * s, "XYZ", "G1")
        elif what == "none":
            self.line(job.at, "XYZ", "G1")
        elif what == "relative":
            self.relative = not self.relative
            self.say("G91" if self.relative else "G90")
        elif what == "tool":
            self.line(self.far + np.array([0, 0, 40.0 * s]), "Z", "G0")
            before = self.tool
            self.tool = rng.choice(self.tools)
            job.at = job.at - np.array([0.0, 0.0, self.tool.length - before.length])
            self.say(f"T{self.tool.number} M6")
            self.say(f"G43 H{self.tool.number}")
            self.say(next(line for line in job.text if line.startswith(("G61", "G64"))))
        elif what == "zero":
            self.stated = True
            second = rng.random() < 0.5
            self.zero = self.shift2 if second else np.zeros(3)
            self.say("G55" if second else "G54")
        elif what == "arc":
            self.arc()
        elif what == "drill":
            self.drill()
        elif what == "loop":
            self.loop()

    def arc(self) -> None:
        rng, job, s = self.rng, self.job, self.scale
        axes, plane, letters = rng.choice(
            [((0, 1, 2), "G17", "IJ"), ((2, 0, 1), "G18", "KI"), ((1, 2, 0), "G19", "JK")]
        )
        r = num(rng, 0.2, 25.0) * s
        first = rng.uniform(-math.pi, math.pi)
        offset = [float(self.n(-r * math.cos(first))) * self.unit, float(self.n(-r * math.sin(first))) * self.unit]
        centre = job.at.copy()
        centre[axes[0]] += offset[0]
        centre[axes[1]] += offset[1]
        r = math.hypot(*offset)
        first = math.atan2(-offset[1], -offset[0])
        sense = rng.choice([1, -1])
        full = rng.random() < 0.2
        sweep = 2 * math.pi if full else rng.uniform(0.05, 2 * math.pi - 0.05)
        sweep *= sense
        target = job.at.copy()
        if not full:
            target[axes[0]] = centre[axes[0]] + r * math.cos(first + sweep)
            target[axes[1]] = centre[axes[1]] + r * math.sin(first + sweep)
        if rng.random() < 0.5:
            target[axes[2]] = job.at[axes[2]] + num(rng, -10, 10) * s
        text, end = self.words(target)
        if full:
            end[axes[0]], end[axes[1]] = job.at[axes[0]], job.at[axes[1]]
        centres = " ".join(f"{letter}{self.n(v)}" for letter, v in zip(letters, offset, strict=True))
        self.say(f"{plane} {'G3' if sense > 0 else 'G2'} {text} {centres}")
        way = turning(centre, r, first, sweep, axes, (float(job.at[axes[2]]), float(end[axes[2]])))
        job.ways.append((self.tool, way, 240, job.text[-1]))
        job.at = end
        self.say("G17")

    def drill(self) -> None:
        rng, job, s = self.rng, self.job, self.scale
        if self.relative:
            self.relative = False
            self.say("G90")
        code = rng.choice(["G81", "G83"])
        back = float(self.n(self.far[2] + num(rng, 0, 20) * s - self.zero[2])) * self.unit + self.zero[2]
        deep = float(self.n(back - num(rng, 1, 20) * s - self.zero[2])) * self.unit + self.zero[2]
        first_z = float(job.at[2])
        low = max(first_z, back)
        retract = rng.choice(["G98", "G99"])
        top = low if retract == "G98" else back
        for number in range(rng.randint(1, 3)):
            text, end = self.words(self.somewhere(), "XY")
            step = f" Q{self.n(num(rng, 2, 8) * s)}" if code == "G83" else ""
            if number == 0:
                self.say(f"{retract} {code} {text} Z{self.n(deep - self.zero[2])} R{self.n(back - self.zero[2])}{step}")
            else:
                self.say(text)
            stops = [job.at.copy()]
            if job.at[2] < back:
                stops.append(np.array([job.at[0], job.at[1], back]))
            stops.append(np.array([end[0], end[1], stops[-1][2]]))
            stops.append(np.array([end[0], end[1], deep]))
            stops.append(np.array([end[0], end[1], top]))
            for a, b in itertools.pairwise(stops):
                job.ways.append((self.tool, straight(a, b), 60, job.text[-1]))
            job.at = stops[-1]
        self.say("G80")

    def loop(self) -> None:
        """Steps to one side, as often as a loop says."""
        rng, job, s = self.rng, self.job, self.scale
        if self.relative:
            self.relative = False
            self.say("G90")
        count = rng.randint(1, 4)
        step = float(self.n(num(rng, -4, 4) * s)) * self.unit
        begin = job.at.copy()
        axis = rng.choice("XYZ")
        k = "XYZ".index(axis)
        base = float(self.n(begin[k] - self.zero[k])) * self.unit
        self.say("#100 = 0")
        self.say(f"while [#100 < {count}]")
        self.say(f"  G1 {axis}[{self.n(base)} + #100 * {self.n(step)}]")
        self.say("  #100 = [#100 + 1]")
        self.say("endwhile")
        for number in range(count):
            end = job.at.copy()
            end[k] = base + number * step + self.zero[k]
            job.ways.append((self.tool, straight(job.at.copy(), end), 60, job.text[-3]))
            job.at = end

    def bodies(self) -> None:
        """Things near to the path, as near as a random offset makes them."""
        rng = self.rng
        self.part: list[Prism] = []
        self.fixtures: list[Prism] = []
        self.setup_lines: list[str] = []
        calm = rng.random() < 0.6
        lowest = min(float(way(np.linspace(0.0, 1.0, 50))[:, 2].min()) for _, way, _, _ in self.job.ways)
        for kind in ("part", "fixtures"):
            for number in range(rng.randint(1, 3)):
                tool, way, _, _ = rng.choice(self.job.ways)
                near = way(np.array([rng.random()]))[0]
                size = max(num(rng, 0.3, 20.0) * self.scale, 0.002)
                offset = np.array([rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1)])
                offset *= rng.choice([0.0, tool.diameter, 2 * tool.diameter, 20 * self.scale])
                if rng.random() < 0.6:
                    offset[2] -= size
                where = near + offset
                if calm:
                    where[2] = (
                        lowest - size - rng.choice([0.0, 0.002, -0.002, self.clearance, self.clearance + 0.002, 1.0])
                    )
                thing = a_thing(rng, kind, where, size, self.folder, f"{kind}{number}")
                self.setup_lines += thing.lines
                (self.part if kind == "part" else self.fixtures).extend(thing.prisms)
                if rng.random() < 0.2 and thing.lines[2].startswith("box"):
                    again = thing.prisms[0]
                    assert not isinstance(again.area, tuple)
                    x0, y0, x1, y1 = again.area.bounds
                    wide = round(x1 + (x1 - x0), 6)
                    self.setup_lines += [
                        f"[[{kind}]]", f'name = "{kind}{number}b"',
                        f"box = [[{x1}, {y0}, {again.bottom}], [{wide}, {y1}, {again.top}]]",
                    ]  # fmt: skip
                    prism = Prism(shapely.box(x1, y0, wide, y1), again.bottom, again.top)
                    (self.part if kind == "part" else self.fixtures).append(prism)

    def write(self) -> list[str]:
        machine = ['schema = "gproof-machine/1"', 'units = "mm"', "[axes.x]", "[axes.y]", "[axes.z]"]
        machine += ["[controller]", "straight_traverse = true"]
        for tool in self.tools:
            machine += tool.lines
        setup = ['schema = "gproof-setup/1"', "active_work = 1"]
        if self.stated:
            base = np.array([num(self.rng, -500, 500) for _ in range(3)])
            for name, values in (("work.1", base), ("work.2", base + self.shift2), ("g92", np.zeros(3))):
                setup += [f"[{name}]", *(f"{axis} = {float(v)!r}" for axis, v in zip("xyz", values, strict=True))]
        setup += ["[workpiece]", f"tolerance = {self.tolerance}", f"clearance = {self.clearance}", *self.setup_lines]
        (self.folder / "machine.toml").write_text("\n".join(machine) + "\n")
        (self.folder / "setup.toml").write_text("\n".join(setup) + "\n")
        (self.folder / "job.cnc").write_text("\n".join(self.job.text) + "\n")
        words = [str(self.folder / "job.cnc"), "--machine", str(self.folder / "machine.toml")]
        words += ["--setup", str(self.folder / "setup.toml"), "--dialect", "eding"]
        return ["check", *words, "--also", "gouges", "--also", "collisions", "--format", "json"]

    def across(self) -> float:
        """How much room shank and holder have beside the part, two of their pieces at a time as wide as the narrower.

        What lies in both together is deeper than in each alone; just below the shank it is the cutter's.
        """
        room = math.inf
        for tool in self.tools:
            ways = [(way, places) for used, way, places, _ in self.job.ways if used is tool]
            for low, high in itertools.pairwise([tool.cutter, *tool.others]):
                joint, top = high.outline[0][1], high.outline[-1][1]
                bottom = joint - self.tolerance if low is tool.cutter else low.outline[0][1]
                wide = min(max(r for r, _ in one.outline) + one.corner for one in (low, high))
                piece = Piece("both", [(0.0, bottom), (wide, bottom), (wide, top), (0.0, top)])
                if ways:
                    room = min(room, least_on(ways, self.part, piece, 0.05 - self.tolerance) + self.tolerance)
        return room

    def truth(self) -> dict[str, float]:
        """How much room there is beside what is asked, mm: less than 0 is a finding."""
        room = {"gouges": math.inf, "collisions": math.inf}
        for tool in self.tools:
            ways = [(way, places) for used, way, places, _ in self.job.ways if used is tool]
            if not ways:
                continue
            found = least_on(ways, self.part, tool.cutter, 0.05 - self.tolerance)
            room["gouges"] = min(room["gouges"], found + self.tolerance)
            for piece in tool.others:
                found = least_on(ways, self.part, piece, 0.05 - self.tolerance)
                room["collisions"] = min(room["collisions"], found + self.tolerance)
            for piece in [tool.cutter, *tool.others]:
                found = least_on(ways, self.fixtures, piece, 0.05 + self.clearance)
                room["collisions"] = min(room["collisions"], found - self.clearance)
        return room
