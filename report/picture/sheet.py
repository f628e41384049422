"""``check --picture``: the job as a drawing (SVG): what it cuts, where on the machine that is, what is wrong with it.

Left the cut from above and from the front, at one scale, with holes and grooves as wide as the tool where the tool
table gives diameters; below, what is left of stock, where ``collisions`` is requested. Right the same on the whole
machine with soft limits, tool change area and keep-out zones. All
numbers are machine coordinates; where a work zero is not known, the cut is relative to it, and the machine shows
where that zero may be. Rotary axes are not drawn. The same inputs give the same bytes.
"""

from __future__ import annotations

import itertools
import math
import os
import tempfile
import xml.etree.ElementTree as ET
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from gproof.driver.conditions import conditions_of, word, word_of
from gproof.driver.judge import Judgement
from gproof.driver.session import Session
from gproof.ir.codes import CODES
from gproof.ir.finding import Severity
from gproof.ir.machine import AXIS_NAMES, Machine
from gproof.ir.record import record
from gproof.ir.symbols import describe
from gproof.ir.trace import Chunk
from gproof.ir.verdict import Verdict
from gproof.report.picture.path_points import PathPoints
from gproof.report.picture.relief import draw, legend
from gproof.report.picture.scene import WEIGHT, Mark, Pair, Scene, by_weight, scene_of
from gproof.report.picture.words import wide, wrapped
from gproof.report.summary import condition_text, unit_of_report
from gproof.report.units import CHOICES, LengthUnit
from gproof.report.zones import outline, placed

WIDTH, EDGE, RULER, GAP = 1000.0, 22.0, 46.0, 26.0
CUT_WIDTH, CUT_HEIGHT, CUT_FRONT, CUT_LEAST = 540.0, 500.0, 240.0, 70.0
RING = 11.0  # pixels between two rings at least
CUT_SCALE = 80.0  # pixels per mm at most
MACHINE_HEIGHT, MACHINE_FRONT = 330.0, 300.0
MACHINE_WIDTH = WIDTH - 2 * EDGE - 2 * RULER - GAP - CUT_WIDTH
_INK, _SOFT, _GRID = "#212121", "#546e7a", "#eceff1"
_FEED, _CUT, _TRAVERSE, _LIMIT, _AREA, _ZERO = "#0d47a1", "#d6e6f7", "#90a4ae", "#37474f", "#ef6c00", "#2e7d32"
_ZONE, _ZONE_FILL = "#6d4c41", "#d7ccc8"
_BODIES = {"stock": ("#fff8e1", "#bcaaa4"), "part": ("#e0f2f1", "#00897b"), "fixtures": ("#e1bee7", "#7b1fa2")}
"""Fill and stroke by role."""
_BADGE = {Verdict.SAFE: "#2e7d32", Verdict.UNSAFE: "#c62828", Verdict.UNKNOWN: "#6a1b9a"}
_LABELS, _LISTED = 8, 4


class Drawing:
    """Collects the path while the job streams by; ``write`` draws it."""

    def __init__(self, machine: Machine) -> None:
        self._path = PathPoints(machine)

    def add(self, chunk: Chunk) -> None:
        """Remember the chunk's motion."""
        self._path.add(chunk)

    def write(self, path: Path, session: Session, judgement: Judgement, units: str | None = None) -> None:
        """Draw and write the file, whole or not at all; units: of lengths, None: those of the machine file."""
        unit = unit_of_report(session, judgement) if units is None else CHOICES[units]
        text = _Sheet(scene_of(self._path, session, judgement), session, judgement, unit).text()
        handle, name = tempfile.mkstemp(dir=path.parent, suffix=".svg")
        try:
            with os.fdopen(handle, "w", encoding="utf-8") as out:
                out.write(text)
            os.chmod(name, 0o644)
            os.replace(name, path)
        except BaseException:
            Path(name).unlink(missing_ok=True)
            raise


@record(frozen=True, slots=True, kw_only=True)
class _View:
    """A window on two axes: what it spans, where it is on the page, pixels per mm."""

    name: str
    axes: tuple[int, int]
    low: Pair
    high: Pair
    left: float
    top: float
    scale: float
    shift: Pair = (0.0, 0.0)
    relief: bool = False

    @property
    def width(self) -> float:
        return (self.high[0] - self.low[0]) * self.scale

    @property
    def height(self) -> float:
        return (self.high[1] - self.low[1]) * self.scale

    def at(self, x: float, y: float) -> Pair:
        return self.left + (x - self.low[0]) * self.scale, self.top + (self.high[1] - y) * self.scale

    def page(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Page coordinates of (n, 3) points."""
        u, v = self.axes
        x = self.left + (points[:, u] + self.shift[0] - self.low[0]) * self.scale
        y = self.top + (self.high[1] - points[:, v] - self.shift[1]) * self.scale
        return x, y


class _Sheet:
    """The page."""

    def __init__(self, scene: Scene, session: Session, judgement: Judgement, unit: LengthUnit) -> None:
        self.scene, self.session, self.judgement, self.length = scene, session, judgement, unit
        self.machine = session.machine
        self.root = ET.Element("svg", xmlns="http://www.w3.org/2000/svg")
        self.root.set("font-family", "DejaVu Sans, Verdana, Arial, sans-serif")
        self.used: set[str] = set()
        self.taken: list[tuple[float, float, float, float]] = []

    def text(self) -> str:
        """The whole document."""
        background = ET.SubElement(self.root, "rect", width="100%", height="100%", fill="#ffffff")
        top = self._heading()
        bottom = top
        for n, view in enumerate(views := self._views(top)):
            self._view(view, n)
            bottom = max(bottom, view.top + view.height + 40)
        if not views:
            self._say(EDGE, bottom + 20, "There is no motion to draw.", 14, _SOFT)
            bottom += 40
        bottom = self._footer(bottom + 12)
        for element in (self.root, background):
            element.set("width", f"{WIDTH:.0f}")
            element.set("height", f"{bottom:.0f}")
        self.root.set("viewBox", f"0 0 {WIDTH:.0f} {bottom:.0f}")
        ET.indent(self.root, " ")
        return '<?xml version="1.0" encoding="UTF-8"?>\n' + ET.tostring(self.root, encoding="unicode") + "\n"

    # Text

    def _say(
        self, x: float, y: float, text: str, size: float, colour: str, *, bold: bool = False, anchor: str = "start",
        parent: ET.Element | None = None,
    ) -> float:  # fmt: skip
        """Write a line; returns about how wide it is."""
        text = "".join(c if c.isprintable() else "?" for c in text)
        element = ET.SubElement(
            self.root if parent is None else parent, "text", x=f"{x:.1f}", y=f"{y:.1f}", fill=colour
        )
        element.set("font-size", f"{size:g}")
        if bold:
            element.set("font-weight", "bold")
        if anchor != "start":
            element.set("text-anchor", anchor)
        element.text = text
        return wide(text, size, bold)

    def _lines(self, x: float, y: float, text: str, size: float, colour: str, *, bold: bool = False) -> float:
        """Write a text in as many lines as it needs up to the right edge; returns where the next one goes."""
        for line in wrapped(text, size, WIDTH - EDGE - x, bold):
            self._say(x, y, line, size, colour, bold=bold)
            y += size + 7
        return y

    def _heading(self) -> float:
        verdict, said = self.judgement.verdict, word(self.judgement)
        width = 28 + wide(said, 21, bold=True)
        badge = ET.SubElement(self.root, "rect", x=f"{EDGE:.0f}", y="18", width=f"{width:.0f}", height="42", rx="6",
                              fill=_BADGE[verdict])  # fmt: skip
        self._say(EDGE + width / 2, 46, said, 21, "#ffffff", bold=True, anchor="middle")
        left = EDGE + width + 16
        badge.set("stroke", "none")
        job = self.session.job
        y = self._lines(left, 36, f"{job.parent.name}/{job.name}".lstrip("/"), 18, _INK, bold=True)
        y = self._lines(left, y - 4, f"on {self.machine.name}", 13, _SOFT)
        x, y = float(EDGE), max(84.0, y + 7)
        for result in self.judgement.properties:
            name, answer = wide(result.name, 13) + 5, wide(word_of(result), 13, bold=True)
            if x > EDGE and x + name + answer > WIDTH - EDGE:
                x, y = float(EDGE), y + 20
            self._say(x, y, result.name, 13, _SOFT)
            self._say(x + name, y, word_of(result), 13, _BADGE[result.verdict], bold=True)
            x += name + answer + 18
        for asks, conditions in conditions_of(self.judgement).items():
            for condition in conditions:
                text = f"if {condition_text(self.session, condition, self.length)} ({asks})"
                y = self._lines(EDGE, y + 20, text, 13, _INK) - 20
        return y + 16

    # Views

    def _views(self, top: float) -> list[_View]:
        """The cut and the machine side by side, each from above and from the front."""
        if not len(self.scene.points):
            return []
        rows = [[v for v in pair if v is not None] for pair in zip(self._cut(), self._whole(), strict=True)]
        out, at = [], top + 24
        for row in rows:
            out += [replace(view, top=at) for view in row]
            at += max((view.height + 64 for view in row), default=0)
        if self.scene.reliefs:
            said = "What is left of the stock, at most"
            out.append(replace(rows[0][0], name=said, top=at, relief=True))
        return out

    def _cut(self) -> tuple[_View, _View]:
        """At one scale and with X lined up."""
        low, high = self.scene.low, self.scene.high
        size = np.maximum(high - low, 1e-3)
        pad = 0.06 * max(float(size[0]), float(size[1]), 4.0)
        rooms = (CUT_WIDTH, CUT_HEIGHT, CUT_FRONT)
        scale = min(CUT_SCALE, *(room / (float(s) + 2 * pad) for room, s in zip(rooms, size, strict=True)))
        x, y, z = (
            _widened(float(low[k]) - pad, float(high[k]) + pad, least / scale)
            for k, least in enumerate((CUT_WIDTH, CUT_LEAST, CUT_LEAST))
        )
        mm, unit = self._unit()
        places = (1, 2) if unit == "mm" else (2, 3)
        sizes = " x ".join(f"{v:.{places[v < 10]}f}" for v in ((high - low)[:2] / mm).tolist())
        said, left = f"The cut from above ({sizes} {unit})", EDGE + RULER
        return (
            _View(name=said, axes=(0, 1), low=(x[0], y[0]), high=(x[1], y[1]), left=left, top=0.0, scale=scale),
            _View(name="The cut from the front", axes=(0, 2), low=(x[0], z[0]), high=(x[1], z[1]), left=left, top=0.0,
                  scale=scale),
        )  # fmt: skip

    def _unit(self) -> tuple[float, str]:
        """The unit of lengths: mm in it, its name."""
        return float(self.length.mm), self.length.name

    def _whole(self) -> tuple[_View | None, _View | None]:
        """On the whole machine, as far as its limits and the place of the job are known."""
        spans: list[Pair | None] = []
        for k in range(3):
            axis, shift = self.machine.axis(AXIS_NAMES[k]), self.scene.shift[k]
            if axis is None or axis.lower is None or axis.upper is None or shift is None:
                spans.append(None)
                continue
            low = min(axis.lower, float(self.scene.low[k]) + shift)
            high = max(axis.upper, float(self.scene.high[k]) + shift)
            spans.append((low, high))
        x, y, z = spans
        if x is None:
            return None, None
        sizes = [s[1] - s[0] for s in (x, y or (0.0, 1.0), z or (0.0, 1.0))]
        pad = 0.04 * max(sizes[0], sizes[1], 1.0)
        rooms = (MACHINE_WIDTH, MACHINE_HEIGHT, MACHINE_FRONT)
        scale = min(room / (size + 2 * pad) for room, size in zip(rooms, sizes, strict=True))

        def view(name: str, k: int, span: Pair | None) -> _View | None:
            if span is None:
                return None
            return _View(
                name=f"On the machine, {name}", axes=(0, k), low=(x[0] - pad, span[0] - pad),
                high=(x[1] + pad, span[1] + pad), left=WIDTH - EDGE - MACHINE_WIDTH, top=0.0, scale=scale,
                shift=(self.scene.shift[0] or 0.0, self.scene.shift[k] or 0.0),
            )  # fmt: skip

        return view("from above", 1, y), view("from the front", 2, z)

    def _view(self, view: _View, number: int) -> None:
        whole = view.name.startswith("On")
        self._say(view.left, view.top - 8, view.name, 13, _INK, bold=True)
        self._rulers(view)
        clip = ET.SubElement(ET.SubElement(self.root, "clipPath", id=f"view{number}"), "rect")
        for element in (clip, ET.SubElement(self.root, "rect", fill="none", stroke="#cfd8dc")):
            for name, value in (("x", view.left), ("y", view.top), ("width", view.width), ("height", view.height)):
                element.set(name, f"{value:.1f}")
        group = ET.SubElement(self.root, "g")
        group.set("clip-path", f"url(#view{number})")
        group.set("fill", "none")
        group.set("stroke-linejoin", "round")
        group.set("stroke-linecap", "round")
        if view.relief:
            self._relief(group, view)
            return
        known = whole or not any(self.scene.forms[k] for k in view.axes)
        self._areas(group, view, known, whole)
        self._bodies(group, view)
        if view.axes == (0, 1):
            self._widths(group, view)
        self._moves(group, view, whole)
        if view.axes == (0, 1) and not whole:
            self._holes(group, view)
        if known:
            self._limits(group, view)
        self._findings(group, view)

    def _relief(self, group: ET.Element, view: _View) -> None:
        """What is left of stock, and the outline of the part; what the colours mean at the right."""
        for relief in self.scene.reliefs:
            draw(group, relief, view.at)
        for body in self.scene.bodies:
            if body.role == "part":
                self._outline(group, view, body.rings, "none", _BODIES["part"][1])
        left, y = WIDTH - EDGE - MACHINE_WIDTH, view.top + 12
        for colour, said in legend(self.scene.reliefs, *self._unit()):
            box = ET.SubElement(self.root, "rect", x=f"{left:.1f}", y=f"{y - 11:.1f}", fill=colour, stroke="#bcaaa4")
            box.set("width", "22")
            box.set("height", "14")
            self._say(left + 30, y, said, 12, _INK)
            y += 21

    def _rulers(self, view: _View) -> None:
        """Grid and numbers along the left and the bottom, in the machine's own unit."""
        unit, unit_name = self._unit()
        for n, k in enumerate(view.axes):
            length = view.width if n == 0 else view.height
            step = _nice((view.high[n] - view.low[n]) / unit * (56 if n == 0 else 30) / length)
            first = math.ceil(view.low[n] / unit / step - 1e-9)
            last = math.floor(view.high[n] / unit / step + 1e-9)
            for i in range(first, last + 1):
                value = i * step
                x, y = view.at(value * unit, view.low[1]) if n == 0 else view.at(view.low[0], value * unit)
                line = ET.SubElement(self.root, "path", stroke=_GRID)
                line.set(
                    "d", f"M{x:.1f} {y:.1f}v{-view.height:.1f}" if n == 0 else f"M{x:.1f} {y:.1f}h{view.width:.1f}"
                )
                label = f"{value:g}" if abs(value) >= step / 2 else "0"
                if n == 0:
                    self._say(x, y + 14, label, 11, _SOFT, anchor="middle")
                else:
                    self._say(x - 5, y + 4, label, 11, _SOFT, anchor="end")
            name = f"{AXIS_NAMES[k].upper()} {unit_name}"
            if n == 0:
                self._say(view.left + view.width, view.top + view.height + 28, name, 11, _INK, bold=True, anchor="end")
            else:
                self._say(view.left - 40, view.top - 8, name, 11, _INK, bold=True)

    def _limits(self, group: ET.Element, view: _View) -> None:
        u, v = (self.machine.axis(AXIS_NAMES[k]) for k in view.axes)
        if u is None or v is None:
            return
        low_u, high_u, low_v, high_v = u.lower, u.upper, v.lower, v.upper
        if low_u is None or high_u is None or low_v is None or high_v is None:
            return
        self._box(group, view, (low_u, high_u), (low_v, high_v), stroke=_LIMIT, dash="9 4", width="1.6")
        self.used.add("limits")

    def _areas(self, group: ET.Element, view: _View, known: bool, whole: bool) -> None:
        """What is beneath the path: the tool change area, and where an unknown zero may be."""
        area = self.machine.tool_change_area
        if area is not None and known:
            x, y = area.box[view.axes[0]], area.box[view.axes[1]]
            if x[1] >= view.low[0] and x[0] <= view.high[0] and y[1] >= view.low[1] and y[0] <= view.high[1]:
                self._box(group, view, x, y, stroke=_AREA, fill="#ffe0b2", width="1.2")
                self.used.add("area")
        for zone in placed(self.session) if known else ():
            rings = outline(zone, view.axes, view.low, view.high)
            if rings:
                corners = [[view.at(*point) for point in ring] for ring in rings]
                lines = ["M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in ring) + "z" for ring in corners]
                shape = ET.SubElement(group, "path", d="".join(lines), fill=_ZONE_FILL, stroke=_ZONE)
                shape.set("fill-rule", "evenodd")
                shape.set("stroke-width", "1.2")
                self.used.add("zone")
        if whole and any(self.scene.zero[k] for k in view.axes):
            pairs = [self.scene.zero[k] or (view.low[n], view.high[n]) for n, k in enumerate(view.axes)]
            self._box(group, view, pairs[0], pairs[1], stroke=_ZERO, fill="#e8f5e9", width="1.2", dash="2 3")
            self.used.add("zero")

    def _bodies(self, group: ET.Element, view: _View) -> None:
        """Stock, part and fixtures: from above their outlines, from the front their boxes."""
        for body in self.scene.bodies:
            (x0, _, z0), (x1, _, z1) = body.low, body.high
            if view.axes == (0, 1):
                rings = [list(ring) for ring in body.rings]
            elif math.isnan(z0):
                continue
            else:
                rings = [[(x0, z0), (x1, z0), (x1, z1), (x0, z1)]]
            corners = [[view.at(u + view.shift[0], v + view.shift[1]) for u, v in ring] for ring in rings]
            (left, right), (top, bottom) = ((min(c), max(c)) for c in zip(*corners[0], strict=True))
            box = (view.left, view.top, view.left + view.width, view.top + view.height)
            if not _overlap((left, top, right, bottom), box):
                continue
            self._outline(group, view, rings, *_BODIES[body.role])
            self.used.add(body.role)

    def _outline(
        self, group: ET.Element, view: _View, rings: Sequence[Sequence[Pair]], fill: str, stroke: str
    ) -> None:  # fmt: skip
        """One body as a path, with its holes."""
        corners = [[view.at(u + view.shift[0], v + view.shift[1]) for u, v in ring] for ring in rings]
        lines = ["M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in ring) + "z" for ring in corners]
        shape = ET.SubElement(group, "path", d="".join(lines), fill=fill, stroke=stroke)
        shape.set("fill-rule", "evenodd")
        shape.set("stroke-width", "1")

    def _box(
        self, group: ET.Element, view: _View, x: Pair, y: Pair, *, stroke: str, fill: str = "none", width: str = "1",
        dash: str = "",
    ) -> None:  # fmt: skip
        """A box in machine coordinates; sides beyond the view lie just outside of it."""
        x = max(x[0], view.low[0] - 9 / view.scale), min(x[1], view.high[0] + 9 / view.scale)
        y = max(y[0], view.low[1] - 9 / view.scale), min(y[1], view.high[1] + 9 / view.scale)
        left, top = view.at(x[0], y[1])
        box = ET.SubElement(group, "rect", x=f"{left:.1f}", y=f"{top:.1f}", fill=fill, stroke=stroke)
        box.set("width", f"{max(0.0, x[1] - x[0]) * view.scale:.1f}")
        box.set("height", f"{max(0.0, y[1] - y[0]) * view.scale:.1f}")
        box.set("stroke-width", width)
        if dash:
            box.set("stroke-dasharray", dash)

    def _widths(self, group: ET.Element, view: _View) -> None:
        """The tool's width along the cut, beneath the path."""
        p = self.scene.points
        drawn = self.scene.joined & p.feed & (p.diameter > 0)
        for begin, stop in _runs(drawn, p.diameter):
            width = float(p.diameter[begin]) * view.scale
            if width < 1.5:
                continue
            path = ET.SubElement(group, "path", d=self._line(view, begin, stop), stroke=_CUT)
            path.set("stroke-width", f"{width:.1f}")
            self.used.add("cut")

    def _moves(self, group: ET.Element, view: _View, whole: bool) -> None:
        """One path element for each run of feed or traverse moves; traverses beneath."""
        p = self.scene.points
        for feed, colour, width in ((False, _TRAVERSE, 0.8), (True, _FEED, 1.0 if whole else 1.4)):
            for begin, stop in _runs(self.scene.joined & (p.feed == feed), p.feed):
                path = ET.SubElement(group, "path", d=self._line(view, begin, stop), stroke=colour)
                path.set("stroke-width", f"{width:g}")
                if not feed:
                    path.set("stroke-dasharray", "4 3")
                self.used.add("feed" if feed else "traverse")

    def _line(self, view: _View, begin: int, stop: int) -> str:
        """The moves to points ``begin ... stop - 1``; points closer than a tenth of a pixel are left out."""
        x, y = view.page(self.scene.points.at[begin - 1 : stop].astype(float))
        texts = [f"{a:.1f} {b:.1f}" for a, b in zip(x.tolist(), y.tolist(), strict=True)]
        kept = texts[:1] + [b for a, b in itertools.pairwise(texts) if a != b]
        return "M" + "L".join(kept if len(kept) > 1 else kept * 2)

    def _holes(self, group: ET.Element, view: _View) -> None:
        """A circle with a cross where the tool goes straight down, as wide as the tool."""
        for x, y, diameter in self.scene.plunges:
            cx, cy = view.at(x, y)
            r = max(diameter / 2 * view.scale, 2.5)
            d, arm = 2 * r, r + 3
            circle = f"M{cx - r:.1f} {cy:.1f}a{r:.1f} {r:.1f} 0 1 0 {d:.1f} 0a{r:.1f} {r:.1f} 0 1 0 {-d:.1f} 0"
            cross = f"M{cx - arm:.1f} {cy:.1f}h{2 * arm:.1f}M{cx:.1f} {cy - arm:.1f}v{2 * arm:.1f}"
            hole = ET.SubElement(group, "path", d=circle + cross, stroke=_FEED, fill=_CUT if diameter else "none")
            hole.set("stroke-width", "0.8")
            self.used.add("plunge")

    def _findings(self, group: ET.Element, view: _View) -> None:
        """Moves with findings painted over, rings where they are, and labels as long as there is room."""
        rings: list[tuple[float, float, Mark]] = []
        for mark in self.scene.marks:
            chosen = np.zeros(len(self.scene.points), dtype=bool)
            chosen[mark.moves] = True
            for begin, stop in _runs(chosen, chosen):
                path = ET.SubElement(group, "path", d=self._line(view, begin, stop), stroke=mark.colour)
                path.set("stroke-width", "2.4")
            x, y = (float(c[0]) for c in view.page(np.array([mark.at])))
            self.used.add("finding" if mark.colour == WEIGHT[Severity.ERROR] else "open")
            if all(math.hypot(x - other[0], y - other[1]) > RING for other in rings):
                rings.append((x, y, mark))
        for x, y, mark in rings:
            ring = ET.SubElement(group, "circle", cx=f"{x:.1f}", cy=f"{y:.1f}", r="6", stroke=mark.colour)
            ring.set("stroke-width", "2")
            self.taken.append((x - 7, y - 7, x + 7, y + 7))
        for x, y, mark in rings[:_LABELS]:
            self._label(view, x, y, mark)

    def _label(self, view: _View, x: float, y: float, mark: Mark) -> None:
        width = wide(mark.text, 12, bold=True)
        for dx, dy in (
            (11, -9),
            (11, 19),
            (-11 - width, -9),
            (-11 - width, 19),
            (11, -26),
            (-11 - width, -26),
            (11, 36),
        ):
            box = (x + dx - 2, y + dy - 12, x + dx + width + 2, y + dy + 4)
            inside = box[0] >= view.left and box[2] <= view.left + view.width
            inside = inside and box[1] >= view.top and box[3] <= view.top + view.height
            if inside and not any(_overlap(box, other) for other in self.taken):
                self.taken.append(box)
                back = ET.SubElement(self.root, "rect", x=f"{box[0]:.1f}", y=f"{box[1]:.1f}", rx="3", fill="#ffffff")
                back.set("width", f"{box[2] - box[0]:.1f}")
                back.set("height", f"{box[3] - box[1]:.1f}")
                back.set("fill-opacity", "0.85")
                self._say(x + dx, y + dy, mark.text, 12, mark.colour, bold=True)
                return

    # Below the views

    def _footer(self, top: float) -> float:
        x, y = EDGE, top + 10
        for key, said, style in _LEGEND:
            if key not in self.used:
                continue
            if x + 40 + wide(said, 12) > WIDTH - EDGE:
                x, y = EDGE, y + 22
            shape = "m7 0a6 6 0 1 0 12 0a6 6 0 1 0 -12 0m-3 0h18m-9 -9v18" if key == "plunge" else "h26"
            ET.SubElement(self.root, "path", {"d": f"M{x:.0f} {y - 4:.0f}{shape}", "fill": "none", **style})
            x += 32 + self._say(x + 32, y, said, 12, _INK) + 20
        y += 24
        for note in self._notes():
            y = self._lines(EDGE, y, note, 13, _SOFT)
        findings = self.judgement.findings
        judged = sorted((f for f in findings.kept if f.severity in WEIGHT), key=by_weight)
        places = [f" line {f.span.line}" if f.span.line else "" for f in judged]
        weighty = {f"{f.code.label}{at}: {self.length.message(f)}": f for f, at in zip(judged, places, strict=True)}
        for said, f in list(weighty.items())[:_LISTED]:
            y = self._lines(EDGE, y, said, 13, WEIGHT[f.severity])
        more = len(weighty) - _LISTED + sum(findings.hidden(c) for c in CODES.values() if c.severity in WEIGHT)
        if more > 0:
            self._say(EDGE, y, f"and {more} more", 13, _SOFT)
            y += 20
        return y

    def _notes(self) -> list[str]:
        """What the drawing leaves open or leaves out."""
        unknown = [f"{AXIS_NAMES[k].upper()} from {describe(f)}" for k, f in enumerate(self.scene.forms) if f]
        out = [f"Numbers next to the cut are {', '.join(unknown)}."] if unknown else []
        if self.scene.tools > 1:
            beside = "; stock, part and fixtures as for the first tool that cuts" if self.scene.bodies else ""
            out.append(f"Z is the machine position: with a longer tool the axis is higher{beside}.")
        turning = sorted({axis.upper() for axis, *_ in self.judgement.summary.box if axis not in "xyz"})
        if turning:
            out.append(f"Rotation of {', '.join(turning)} is not drawn.")
        return out


_LEGEND: tuple[tuple[str, str, dict[str, str]], ...] = (
    ("feed", "feed", {"stroke": _FEED, "stroke-width": "2"}),
    ("cut", "as wide as the tool", {"stroke": _CUT, "stroke-width": "10"}),
    ("traverse", "rapid", {"stroke": _TRAVERSE, "stroke-width": "1.4", "stroke-dasharray": "4 3"}),
    ("plunge", "straight down", {"stroke": _FEED, "stroke-width": "0.8", "fill": _CUT}),
    ("limits", "soft limits", {"stroke": _LIMIT, "stroke-width": "1.6", "stroke-dasharray": "9 4"}),
    ("area", "tool change area", {"stroke": "#ffcc80", "stroke-width": "10"}),
    ("zone", "keep-out zone", {"stroke": _ZONE_FILL, "stroke-width": "10"}),
    ("stock", "stock", {"stroke": "#ffe082", "stroke-width": "10"}),
    ("part", "part", {"stroke": "#80cbc4", "stroke-width": "10"}),
    ("fixtures", "fixture", {"stroke": "#ce93d8", "stroke-width": "10"}),
    ("zero", "work zero can be here", {"stroke": "#c8e6c9", "stroke-width": "10"}),
    ("finding", "not safe", {"stroke": WEIGHT[Severity.ERROR], "stroke-width": "2.4"}),
    ("open", "not known", {"stroke": WEIGHT[Severity.UNKNOWN], "stroke-width": "2.4"}),
)


def _widened(low: float, high: float, least: float) -> Pair:
    """The range, grown about its middle to at least ``least``."""
    more = max(0.0, least - (high - low)) / 2
    return low - more, high + more


def _nice(least: float) -> float:
    """1, 2 or 5 times a power of ten, not below ``least``."""
    power = 10.0 ** math.floor(math.log10(least))
    return next(power * m for m in (1, 2, 5, 10) if power * m >= least * (1 - 1e-9))


def _overlap(a: tuple[float, float, float, float], b: tuple[float, float, float, float]) -> bool:
    return a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]


def _runs(drawn: np.ndarray, kind: np.ndarray) -> list[tuple[int, int]]:
    """``(begin, stop)`` of maximal stretches of moves that are drawn and of one kind."""
    if not len(drawn):
        return []
    change = np.flatnonzero((drawn[1:] != drawn[:-1]) | (kind[1:] != kind[:-1])) + 1
    edges = [0, *change.tolist(), len(drawn)]
    return [(a, b) for a, b in itertools.pairwise(edges) if drawn[a] and b > a]
