"""Random jobs that turn, scale and shift their coordinates, call subprograms, pass blocks over, and follow contours
with compensation of the radius; parts from drawings with islands and several floors. What is true of them is found as
in ``table_jobs``: by where every word leads in the plane, and by distances of shapes alone.
"""

from __future__ import annotations

import itertools
import math
import random
from pathlib import Path

import ezdxf
import numpy as np
import shapely
import shapely.geometry

from .table_jobs import Floats, Prism, Scene, Thing, num, star, straight, turning


def a_drawing(rng: random.Random, kind: str, centre: Floats, size: float, folder: Path, name: str) -> Thing:
    """A plate with a pocket that has an island, a second floor, holes: outlines on layers, and a stack of prisms."""
    x, y, z = (round(float(v), 4) for v in centre)
    inch = rng.random() < 0.3
    unit = 25.4 if inch else 1.0
    top = round(z + max(size * rng.random(), 0.01), 4)
    drawing = ezdxf.new("R2010")
    drawing.units = 1 if inch else 4
    space = drawing.modelspace()

    def ring_on(layer: str, points: list[tuple[float, float]]) -> None:
        scaled = [(u / unit, v / unit) for u, v in points]
        around = list(zip(scaled, [*scaled[1:], scaled[0]], strict=True))
        if rng.random() < 0.5:
            space.add_lwpolyline(scaled, close=True, dxfattribs={"layer": layer})
            return
        rng.shuffle(around)
        for a, b in around:
            space.add_line(*((a, b) if rng.random() < 0.5 else (b, a)), dxfattribs={"layer": layer})

    def circle_on(layer: str, at: tuple[float, float], radius: float) -> shapely.Polygon:
        space.add_circle((at[0] / unit, at[1] / unit), radius / unit, dxfattribs={"layer": layer})
        return shapely.Point(at).buffer(radius, quad_segs=512)

    for _ in range(50):
        outline = [(u, v) for u, v in star(rng, x, y, size, rng.randint(4, 9))]
        plate = shapely.Polygon(outline)
        if plate.is_valid and plate.area > 0.1 * size * size:
            break
    else:
        outline = [(x, y), (x + size, y), (x + size, y + size), (x, y + size)]
        plate = shapely.Polygon(outline)
    ring_on("OUTLINE", outline)
    layers = [f"OUTLINE = {{ bottom = {z}, top = {top} }}"]
    cuts: list[tuple[float, shapely.Polygon]] = []
    for layer in ("POCKET", "STEP")[: rng.randint(0, 2)]:
        cx, cy = (float(v) for v in plate.representative_point().coords[0])
        cx, cy = cx + num(rng, -0.2, 0.2) * size, cy + num(rng, -0.2, 0.2) * size
        wide = rng.uniform(0.1, 0.6) * size
        box = [(cx - wide, cy - wide), (cx + wide, cy - wide), (cx + wide, cy + wide), (cx - wide, cy + wide)]
        ring_on(layer, box)
        region = shapely.Polygon(box)
        if rng.random() < 0.6:
            region = region.difference(circle_on(layer, (cx, cy), wide * rng.uniform(0.2, 0.9)))
        floor = round(z + (top - z) * rng.choice([0.0, rng.random()]), 4)
        if not z <= floor < top:
            floor = z
        layers.append(f"{layer} = {{ floor = {floor} }}")
        cuts.append((floor, region))
    edges = sorted({z, top, *(floor for floor, _ in cuts)})
    prisms = []
    for low, high in itertools.pairwise(edges):
        left: shapely.Geometry = plate
        for floor, region in cuts:
            if floor <= low:
                left = left.difference(region)
        for piece in getattr(left, "geoms", [left]):
            if isinstance(piece, shapely.Polygon) and piece.area > 1e-9:
                prisms.append(Prism(piece, low, high))
    drawing.saveas(folder / f"{name}.dxf")
    lines = [f"[[{kind}]]", f'name = "{name}"', f'dxf = "{name}.dxf"', f"layers = {{ {', '.join(layers)} }}"]
    return Thing(lines, prisms)


class Framed(Scene):
    """One job whose coordinates are turned, scaled and shifted on its way."""

    def program(self) -> None:
        self.matrix = np.eye(2)
        self.point = np.zeros(2)
        self.framed = ""
        self.called: list[tuple[str, Floats]] = []
        self.offset = np.zeros(3)
        self.deleted = self.rng.choice(["true", "false"])
        super().program()
        at = next(k for k, line in enumerate(self.job.text) if line.startswith("T1"))
        subs: list[str] = []
        for number, (word, way) in enumerate(self.called):
            words = " ".join(f"{a}{self.n(v)}" for a, v in zip("XYZ", way, strict=True))
            back = " ".join(f"{a}{self.n(-v)}" for a, v in zip("XYZ", way, strict=True))
            subs += [f"sub dent{number}", "  G91", f"  {word} {words}", f"  {word} {back}", "  G90", "endsub"]
        self.job.text[at:at] = subs

    # ---- where a word leads

    def forward(self, p: Floats) -> Floats:
        """A place of the program in the coordinates of the table."""
        xy = self.zero[:2] + self.point + self.matrix @ (p[:2] - self.point)
        return np.array([xy[0], xy[1], self.zero[2] + p[2]])

    def back(self, place: Floats) -> Floats:
        """A place of the table in the program's coordinates."""
        xy = self.point + np.linalg.solve(self.matrix, place[:2] - self.zero[:2] - self.point)
        return np.array([xy[0], xy[1], place[2] - self.zero[2]])

    def words(self, target: Floats, axes: str = "XYZ") -> tuple[str, Floats]:
        now, then = self.back(self.job.at), self.back(target)
        out, end = [], now.copy()
        for name in axes:
            k = "XYZ".index(name)
            text = self.n(then[k] - (now[k] if self.relative else 0.0))
            out.append(f"{name}{text}")
            end[k] = float(text) * self.unit + (now[k] if self.relative else 0.0)
        place = self.forward(end)
        # A word that is left out leaves its axis where it is, to the last bit.
        if not self.framed:
            for name in "XYZ":
                if name not in axes:
                    place["XYZ".index(name)] = self.job.at["XYZ".index(name)]
        elif "Z" not in axes:
            place[2] = self.job.at[2]
        return " ".join(out), place

    # ---- what a job does

    def step(self) -> None:
        rng = self.rng
        what = rng.choice(["old"] * 6 + ["turn", "scale", "plain", "here", "call", "call", "slash", "half", "contour"])
        if what == "old":
            self.plain_step()
        elif what in ("turn", "scale") and not self.framed and not self.relative:
            self.frame(what)
        elif what == "plain" and self.framed:
            self.unframe()
        elif what == "here" and not self.framed and not self.relative:
            self.here()
        elif what == "call" and not self.relative:
            self.call()
        elif what == "slash":
            self.slash()
        elif what == "half":
            self.short_arc()
        elif what == "contour" and not self.framed and not self.relative:
            self.contour()

    def plain_step(self) -> None:
        # Another coordinate system would keep a G92 offset: one thing at a time.
        if not self.framed and not self.offset.any():
            super().step()
        elif self.framed and self.rng.random() < 0.3 and self.round_:
            self.arc_in_plane()
        else:
            axes = "".join(axis for axis in "XYZ" if self.rng.random() < 0.6) or "Y"
            self.line(self.somewhere(), axes, self.rng.choice(["G0", "G1"]))

    @property
    def round_(self) -> bool:
        """Whether circles stay circles."""
        m = self.matrix
        return bool(abs(abs(np.linalg.det(m)) - m[0] @ m[0]) < 1e-9 and np.linalg.det(m) > 0.0)

    def frame(self, what: str) -> None:
        rng, s = self.rng, self.scale
        here = self.back(self.job.at)
        self.point = np.array([float(self.n(here[k] + num(rng, -20, 20) * s)) * self.unit for k in range(2)])
        at = [self.n(v) for v in self.point]
        if what == "turn":
            angle = rng.choice([90.0, 180.0, -90.0, 45.0, num(rng, -180, 180)])
            a = math.radians(angle)
            self.matrix = np.array([[math.cos(a), -math.sin(a)], [math.sin(a), math.cos(a)]])
            self.say(f"G68 R{angle} X{at[0]} Y{at[1]}")
            self.framed = "G69"
            return
        f = rng.choice([2.0, 0.5, -1.0, num(rng, 0.2, 3)])
        if rng.random() < 0.5:
            g = rng.choice([-f, f, 1.0])
            self.matrix = np.diag([f, g])
            self.say(f"G51 X{f} Y{g} I{at[0]} J{at[1]}")
        else:
            self.matrix = np.diag([f, f])
            self.say(f"G51 X{f} Y{f} I{at[0]} J{at[1]}")
        self.framed = "G50"

    def unframe(self) -> None:
        if self.framed:
            self.say(self.framed)
            self.matrix, self.point, self.framed = np.eye(2), np.zeros(2), ""

    def here(self) -> None:
        """G92: the program's coordinates of where it is; or back to none."""
        rng, job, s = self.rng, self.job, self.scale
        if self.offset.any():
            self.say("G92.1")
            self.zero = self.zero - self.offset
            self.offset = np.zeros(3)
            return
        place = np.array([float(self.n(num(rng, -30, 30) * s)) * self.unit for _ in range(3)])
        self.say("G92 " + " ".join(f"{a}{self.n(v)}" for a, v in zip("XYZ", place, strict=True)))
        new = job.at - place
        self.offset = self.offset + (new - self.zero)
        self.zero = new

    def call(self) -> None:
        """A subprogram of increments, several times."""
        rng, s = self.rng, self.scale
        if not self.called or rng.random() < 0.5:
            way = np.array([float(self.n(num(rng, -6, 6) * s)) * self.unit for _ in range(3)])
            self.called.append((rng.choice(["G1", "G0"]), way))
        number = rng.randrange(len(self.called))
        for _ in range(rng.randint(1, 3)):
            self.say(f"gosub dent{number}")
            way = self.called[number][1]
            for sign in (1.0, -1.0):
                end = self.forward(self.back(self.job.at) + sign * way)
                self.job.ways.append((self.tool, straight(self.job.at.copy(), end), 60, self.job.text[-1]))
                self.job.at = end
            if rng.random() < 0.5:
                self.line(self.somewhere(), "XY", "G0")

    def slash(self) -> None:
        """A block that the switch passes over."""
        if self.deleted == "true":
            text, _ = self.words(self.somewhere(), "XYZ")
            self.say(f"/ G1 {text}")
        else:
            self.line(self.somewhere(), "XYZ", "G1", "/ ")

    def arc_in_plane(self) -> None:
        """An arc of the X-Y plane with a centre, in coordinates that are turned or scaled."""
        rng, job, s = self.rng, self.job, self.scale
        r, first, turn = num(rng, 0.2, 20.0) * s, rng.uniform(-math.pi, math.pi), rng.uniform(0.1, 6.0)
        middle = self.back(job.at)[:2]
        ij = [float(self.n(-r * math.cos(first))) * self.unit, float(self.n(-r * math.sin(first))) * self.unit]
        sense = rng.choice([1, -1])
        centre = middle + np.array(ij)
        end = self.back(job.at)
        end[0] = centre[0] + math.hypot(*ij) * math.cos(math.atan2(-ij[1], -ij[0]) + sense * turn)
        end[1] = centre[1] + math.hypot(*ij) * math.sin(math.atan2(-ij[1], -ij[0]) + sense * turn)
        rise = num(rng, -5, 5) * s if rng.random() < 0.4 else 0.0
        text, place = self.words(self.forward(end) + np.array([0.0, 0.0, rise]))
        self.say(f"{'G3' if sense > 0 else 'G2'} {text} I{self.n(ij[0])} J{self.n(ij[1])}")
        c = self.forward(np.array([centre[0], centre[1], 0.0]))
        out = job.at[:2] - c[:2]
        way = turning(
            np.array([c[0], c[1], 0.0]), float(np.hypot(*out)), math.atan2(out[1], out[0]), sense * turn, (0, 1, 2),
            (float(job.at[2]), float(place[2])),
        )  # fmt: skip
        job.ways.append((self.tool, way, 240, job.text[-1]))
        job.at = place

    def short_arc(self) -> None:
        """An arc by its radius: the shorter one, or with a negative one the longer one."""
        rng, job, s = self.rng, self.job, self.scale
        if not self.round_:
            return
        target = (
            job.at + np.array([num(rng, 1, 15) * rng.choice([-1, 1]), num(rng, 1, 15) * rng.choice([-1, 1]), 0.0]) * s
        )
        text, end = self.words(target)
        half = 0.5 * float(np.hypot(*(end - job.at)[:2]))
        size = math.sqrt(abs(float(np.linalg.det(self.matrix))))
        wanted = half * rng.choice([1.02, 1.3, 2.0, 6.0])
        shown = self.n(wanted / size)
        radius = float(shown) * self.unit * size
        if radius <= half * 1.01:
            return
        sense, long = rng.choice([1, -1]), rng.random() < 0.4
        self.say(f"{'G3' if sense > 0 else 'G2'} {text} R{'-' if long else ''}{shown}")
        along = (end - job.at)[:2] / (2.0 * half)
        left = np.array([-along[1], along[0]])
        # Counter-clockwise by less than half a turn: the centre is to the left of the way.
        side = sense * (-1 if long else 1)
        away = math.sqrt(radius * radius - half * half)
        centre = 0.5 * (job.at + end)[:2] + side * away * left
        out = job.at[:2] - centre
        sweep = 2.0 * math.asin(min(1.0, half / radius))
        sweep = (2.0 * math.pi - sweep if long else sweep) * sense
        way = turning(
            np.array([centre[0], centre[1], 0.0]), radius, math.atan2(out[1], out[0]), sweep, (0, 1, 2),
            (float(job.at[2]), float(end[2])),
        )  # fmt: skip
        job.ways.append((self.tool, way, 240, job.text[-1]))
        job.at = end

    def contour(self) -> None:
        """Around a convex outline with the radius on its outside: lines beside the sides, arcs about the corners."""
        rng, job, s = self.rng, self.job, self.scale
        r = self.tool.diameter / 2.0
        count = rng.randint(3, 7)
        size, phase = num(rng, 2, 15) * s + 4.0 * r, rng.uniform(0.0, 6.0)
        cx, cy = self.somewhere()[:2]
        clockwise = rng.random() < 0.5
        corners = []
        for k in range(count):
            a = phase + (-1 if clockwise else 1) * 2.0 * math.pi * k / count
            place = self.quantised(np.array([cx + size * math.cos(a), cy + size * math.sin(a), job.at[2]]))
            corners.append(place[:2])
        before = self.quantised(
            np.array([*(corners[0] + (corners[0] - corners[1]) * rng.uniform(0.3, 1.0) + 0.0), job.at[2]])
        )
        if float(np.hypot(*(before[:2] - corners[0]))) < 1.5 * r:
            return
        self.line(before, "XY", "G0")
        down = self.somewhere()
        self.line(down, "Z", "G1")
        z = float(job.at[2])
        self.say(f"{'G41' if clockwise else 'G42'} D{self.tool.number}")
        side = 1.0 if clockwise else -1.0  # G41: to the left of the way
        tool_at = job.at[:2].copy()

        def go(to: Floats) -> None:
            nonlocal tool_at
            job.ways.append((
                self.tool, straight(np.array([*tool_at, z]), np.array([*to, z])), 60, job.text[-1]
            ))  # fmt: skip
            tool_at = to.copy()

        def left_of(a: Floats, b: Floats) -> Floats:
            way = (b - a) / float(np.hypot(*(b - a)))
            return side * np.array([-way[1], way[0]])

        start = tool_at.copy()
        for k, q in enumerate([*corners, corners[0]]):
            self.say(f"G1 X{self.n(q[0] - self.zero[0])} Y{self.n(q[1] - self.zero[1])}")
            if k == 0:
                # Entry: the right angle of the triangle over the way from T to Q, r from Q on its side.
                distance = float(np.hypot(*(q - start)))
                lean = math.asin(r / distance)
                out = (start - q) / distance
                a = side * -(math.pi / 2.0 - lean)
                turn = np.array([[math.cos(a), -math.sin(a)], [math.sin(a), math.cos(a)]])
                go(q + r * (turn @ out))
                continue
            p = corners[k - 1]
            normal = left_of(p, q)
            here = tool_at - p
            first, last = math.atan2(here[1], here[0]), math.atan2(normal[1], normal[0])
            sweep = math.remainder(last - first, 2.0 * math.pi)
            if abs(sweep) > 1e-9:
                job.ways.append((
                    self.tool,
                    turning(np.array([p[0], p[1], 0.0]), r, first, sweep, (0, 1, 2), (z, z)), 120, job.text[-1],
                ))  # fmt: skip
                tool_at = p + r * np.array([math.cos(last), math.sin(last)])
            go(q + r * normal)
        self.say("G40")
        job.at = np.array([*tool_at, z])
        self.line(self.far + np.array([0, 0, 40.0 * s]), "Z", "G0")
        # Where the tool is, is no round number: the next words name all.
        self.line(self.somewhere(), "XYZ", "G0")

    def bodies(self) -> None:
        super().bodies()
        rng = self.rng
        if rng.random() < 0.7:
            _, way, _, _ = rng.choice(self.job.ways)
            near = way(np.array([rng.random()]))[0]
            size = max(num(rng, 3.0, 20.0) * self.scale, 0.5)
            lowest = min(float(way(np.linspace(0.0, 1.0, 20))[:, 2].min()) for _, way, _, _ in self.job.ways)
            if rng.random() < 0.5:
                near[2] = lowest - size
            thing = a_drawing(rng, "part", near, size, self.folder, "drawn")
            self.setup_lines += thing.lines
            self.part.extend(thing.prisms)

    def write(self) -> list[str]:
        words = super().write()
        path = self.folder / "setup.toml"
        path.write_text(
            path.read_text().replace("active_work = 1\n", f"active_work = 1\nblock_delete = {self.deleted}\n")
        )
        return words
