"""``fit --picture``: where the work zero may be (SVG), from above, and from the front where Z does not fit.

A panel for each coordinate system and, near zones, for each layer of heights: soft limits, zones, the region of the
zero, the zero that is stated and the nearest place for it, and what the job reaches from there. All numbers are machine
coordinates in the machine's own unit. The same inputs give the same bytes.
"""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from pathlib import Path

from gproof.driver.files import write_text
from gproof.driver.fit.answer import Range
from gproof.driver.fit.fitting import Fitted
from gproof.driver.fit.zones import Beside
from gproof.ir.machine import AXIS_NAMES, Area
from gproof.ir.record import record
from gproof.ir.trace import Affine
from gproof.ir.verdict import Verdict
from gproof.passes.checks.zones.offset_boxes import outline
from gproof.passes.checks.zones.offset_regions import FAR
from gproof.report.fit_report import headline
from gproof.report.picture.words import wrapped

Pair = tuple[float, float]
Ring = list[list[float]]

WIDTH, EDGE, RULER, PANEL, TALLEST, GAP = 1000.0, 22.0, 40.0, 400.0, 420.0, 76.0
LAYERS = 4
"""Layers of a region that are drawn, the highest first."""
ABOVE, FRONT = (0, 1), (0, 2)
"""Axes to the right and up."""
_INK, _SOFT, _GRID, _LIMIT, _AREA = "#212121", "#546e7a", "#eceff1", "#37474f", "#ef6c00"
_ZERO, _JOB, _NOW = "#2e7d32", "#0d47a1", "#c62828"
_BADGE = {Verdict.SAFE: _ZERO, Verdict.UNSAFE: _NOW, Verdict.UNKNOWN: "#6a1b9a"}


@record(frozen=True, slots=True, kw_only=True)
class _Panel:
    """What one panel shows. rings: of the region; reach: of the job from the zero; now, nearest: places of the zero.

    axes: (0, 1) seen from above, (0, 2) from the front.
    """

    title: str
    rings: list[Ring]
    reach: tuple[Pair, Pair] | None
    now: Pair | None
    fits: bool
    nearest: Pair | None
    axes: tuple[int, int] = (0, 1)


def draw(fitted: Fitted, path: Path) -> None:
    """Write the picture, whole or not at all."""
    root = ET.Element("svg", xmlns="http://www.w3.org/2000/svg")
    root.set("font-family", "DejaVu Sans, Verdana, Arial, sans-serif")
    page = ET.SubElement(root, "rect", width="100%", height="100%", fill="#ffffff")
    verdict = fitted.fit.verdict
    _say(root, EDGE, 40, verdict.value, 21, _BADGE[verdict], bold=True)
    job = fitted.session.job
    name = f"{job.parent.name}/{job.name}".lstrip("/")
    y = _lines(root, EDGE + 130, 32, f"{name}: {headline(fitted.fit)}", 15, _INK, bold=True)
    panels = list(_panels(fitted))
    front = " and from the front" if any(panel.axes == FRONT for panel in panels) else ""
    where = f"where the work zero can be on {fitted.session.machine.name}, from above{front}"
    y = _lines(root, EDGE + 130, y, where, 13, _SOFT)
    top = bottom = max(100.0, y + 28)
    for row in _pairs(panels):
        for column, panel in enumerate(row):
            left = EDGE + RULER + column * (PANEL + RULER + 38)
            bottom = max(bottom, _panel(root, fitted, panel, left, top))
        top = bottom + GAP
    if not panels:
        _say(root, EDGE, top, "There is no region in X and Y to draw.", 14, _SOFT)
        bottom = top + 20
    bottom = _legend(root, bottom + 56)
    for element in (root, page):
        element.set("width", f"{WIDTH:.0f}")
        element.set("height", f"{bottom:.0f}")
    root.set("viewBox", f"0 0 {WIDTH:.0f} {bottom:.0f}")
    ET.indent(root, " ")
    write_text(
        path, '<?xml version="1.0" encoding="UTF-8"?>\n' + ET.tostring(root, encoding="unicode") + "\n", "picture"
    )


def _pairs(panels: list[_Panel]) -> Iterator[tuple[_Panel, ...]]:
    for k in range(0, len(panels), 2):
        yield tuple(panels[k : k + 2])


def _panels(fitted: Fitted) -> Iterator[_Panel]:
    """Regions layer by layer; then pairs of ranges of X and Y that no region has."""
    fit = fitted.fit
    seen: set[Affine] = set()
    for one in fit.zones:
        seen.update(one.place.terms)
        yield from _layers(fitted, one)
    flat = {one.terms: one for one in fit.ranges if one.terms not in seen}
    for terms, x in flat.items():
        partner = tuple((symbol[:-1] + "y", count) for symbol, count in terms)
        y = flat.get(partner)
        if not all(symbol.endswith(".x") for symbol, _ in terms) or y is None:
            continue
        yield _flat(fitted, x, y, ABOVE)
        z = flat.get(tuple((symbol[:-1] + "z", count) for symbol, count in terms))
        if z is not None and z.fits is False:
            yield _flat(fitted, x, z, FRONT)


def _flat(fitted: Fitted, right: Range, up: Range, axes: tuple[int, int]) -> _Panel:
    """Two ranges as a rectangle."""
    sides = [(max(r.low, -FAR), min(r.high, FAR)) for r in (right, up)]
    exact = right.now is not None and up.now is not None and right.now.exact and up.now.exact
    now = (right.now.low, up.now.low) if exact and right.now is not None and up.now is not None else None
    fits = bool(right.fits and up.fits)
    goal = None if now is None or fits else [min(max(v, a), b) for v, (a, b) in zip(now, sides, strict=True)]
    return _Panel(
        title=_title(right.name, up.name, axes), rings=[_box(*sides)], now=now, fits=fits, axes=axes,
        reach=_reach(fitted, right.terms, up.terms, axes), nearest=None if goal is None else (goal[0], goal[1]),
    )  # fmt: skip


def _title(right: str, up: str, axes: tuple[int, int]) -> str:
    return f"{right}, {up}{', from the front' if axes == FRONT else ''}"


def _layers(fitted: Fitted, one: Beside) -> Iterator[_Panel]:
    terms = one.place.terms
    if not terms[0] or not terms[1]:
        return
    mm = fitted.session.machine.unit
    layers = sorted(one.place.region.layers, key=lambda layer: -layer.z[1])[:LAYERS]
    for layer in layers:
        said = f"{one.names[0]}, {one.names[1]}"
        if terms[2]:
            low, high = ("any" if abs(v) >= FAR else f"{v / mm:.4g}" for v in layer.z)
            said += f", with {one.names[2]} {low} ... {high}"
        goal = one.nearest if one.inside is False else None
        goal = goal if goal is None or not terms[2] or layer.z[0] <= goal[2] <= layer.z[1] else None
        yield _Panel(
            title=said, rings=[ring for polygon in outline(layer) for ring in polygon],
            reach=_reach(fitted, terms[0], terms[1], ABOVE), now=None if one.now is None else (one.now[0], one.now[1]),
            fits=one.inside is True, nearest=None if goal is None else (goal[0], goal[1]),
        )  # fmt: skip
    if terms[2] and one.inside is False and one.nearest is not None and one.now is not None:
        x, y, z = one.nearest
        yield _Panel(
            title=f"{_title(one.names[0], one.names[2], FRONT)}, at {one.names[1]} {y / mm:.4g}",
            rings=list(_slices(one, y)), reach=_reach(fitted, terms[0], terms[2], FRONT), now=(one.now[0], one.now[2]),
            fits=False, nearest=(x, z), axes=FRONT,
        )  # fmt: skip


def _slices(one: Beside, y: float) -> Iterator[Ring]:
    """The region at a value of Y, seen from the front: rectangles, one above the other."""
    import shapely

    line = shapely.LineString([(-2.0 * FAR, y), (2.0 * FAR, y)])
    for layer in one.place.region.layers:
        cut = shapely.intersection(layer.left, line)
        for part in getattr(cut, "geoms", [cut]):
            low, _, high, _ = part.bounds
            if high > low:
                yield _box((low, high), layer.z)


def _reach(fitted: Fitted, x: Affine, y: Affine, axes: tuple[int, int]) -> tuple[Pair, Pair] | None:
    """What the job reaches from a zero."""
    sides: list[Pair] = []
    for axis, form in zip(axes, (x, y), strict=True):
        ends = [(a, b) for index, f, a, b in fitted.judgement.summary.extents if index == axis and f == form]
        if not ends:
            return None
        sides.append((min(a for a, _ in ends), max(b for _, b in ends)))
    return sides[0], sides[1]


def _panel(root: ET.Element, fitted: Fitted, panel: _Panel, left: float, top: float) -> float:
    """Draw one; returns where it ends."""
    machine = fitted.session.machine
    limits: list[Pair] = []
    shown: list[Pair] = []
    for axis in range(2):
        known = machine.axis(AXIS_NAMES[panel.axes[axis]])
        values = [point[axis] for ring in panel.rings for point in ring if abs(point[axis]) < FAR] or [0.0]
        low, high = (None, None) if known is None else (known.lower, known.upper)
        # A limit that is unknown is outside of what is shown.
        limits.append((-math.inf if low is None else low, math.inf if high is None else high))
        values += [v for v in (low, high, None if panel.now is None else panel.now[axis]) if v is not None]
        shown.append((min(values), max(values)))
    pad = 0.04 * max(shown[0][1] - shown[0][0], shown[1][1] - shown[1][0], 1.0)
    (x0, x1), (y0, y1) = ((low - pad, high + pad) for low, high in shown)
    scale = min(PANEL / (x1 - x0), TALLEST / (y1 - y0))

    def at(x: float, y: float) -> str:
        x, y = min(max(x, x0 - 2 * pad), x1 + 2 * pad), min(max(y, y0 - 2 * pad), y1 + 2 * pad)
        return f"{left + (x - x0) * scale:.1f} {top + (y1 - y) * scale:.1f}"

    def shape(rings: list[Ring], into: ET.Element, **style: str) -> None:
        path = "".join("M" + "L".join(at(x, y) for x, y in ring) + "Z" for ring in rings)
        element = ET.SubElement(into, "path", d=path)
        for key, value in style.items():
            element.set(key.replace("_", "-"), value)

    wide, tall = (x1 - x0) * scale, (y1 - y0) * scale
    title = wrapped(panel.title, 13, PANEL, bold=True)
    for n, line in enumerate(reversed(title)):
        _say(root, left, top - 12 - 17 * n, line, 13, _INK, bold=True)
    for n, (low, high, length) in enumerate(((x0, x1, wide), (y0, y1, tall))):
        unit = machine.unit
        step = _step((high - low) / unit * (56 if n == 0 else 30) / length)
        for k in range(math.ceil(low / unit / step), math.floor(high / unit / step) + 1):
            x, y = (float(v) for v in (at(k * step * unit, y0) if n == 0 else at(x0, k * step * unit)).split())
            line = f"M{x:.1f} {y:.1f}v{-tall:.1f}" if n == 0 else f"M{x:.1f} {y:.1f}h{wide:.1f}"
            ET.SubElement(root, "path", d=line, stroke=_GRID)
            where = (x, y + 14) if n == 0 else (x - 5, y + 4)
            _say(root, *where, f"{k * step:g}", 11, _SOFT, anchor="middle" if n == 0 else "end")
    number = len(root)
    clip = ET.SubElement(ET.SubElement(root, "clipPath", id=f"panel{number}"), "rect", x=f"{left:.1f}", y=f"{top:.1f}")
    clip.set("width", f"{wide:.1f}")
    clip.set("height", f"{tall:.1f}")
    group = ET.SubElement(root, "g")
    group.set("clip-path", f"url(#panel{number})")
    for area in _areas(fitted):
        rings = [_box(area.box[panel.axes[0]], area.box[panel.axes[1]])]
        if area.rings and panel.axes == ABOVE:
            rings = [[[x, y] for x, y in ring] for ring in area.rings]
        shape(rings, group, fill="#ffe0b2", stroke=_AREA, fill_rule="evenodd")
    shape(panel.rings, group, fill=_ZERO, fill_opacity="0.25", stroke=_ZERO, fill_rule="evenodd")
    shape([_box(*limits)], group, fill="none", stroke=_LIMIT, stroke_dasharray="9 4", stroke_width="1.6")
    for place, colour in ((panel.nearest, _JOB), (panel.now, _ZERO if panel.fits else _NOW)):
        if place is None:
            continue
        if panel.reach is not None:
            (a, b), (c, d) = panel.reach
            around = _box((place[0] + a, place[0] + b), (place[1] + c, place[1] + d))
            shape([around], group, fill="none", stroke=colour, stroke_dasharray="3 3")
        x, y = (float(v) for v in at(*place).split())
        ET.SubElement(group, "path", d=f"M{x - 7:.1f} {y:.1f}h14m-7 -7v14", stroke=colour).set("stroke-width", "2")
        ET.SubElement(group, "circle", cx=f"{x:.1f}", cy=f"{y:.1f}", r="4", fill="none", stroke=colour)
    ET.SubElement(root, "rect", x=f"{left:.1f}", y=f"{top:.1f}", fill="none", stroke="#cfd8dc",
                  width=f"{wide:.1f}", height=f"{tall:.1f}")  # fmt: skip
    return top + tall


def _areas(fitted: Fitted) -> list[Area]:
    """Zones that lie still on the machine."""
    machine, setup = fitted.session.machine, fitted.session.setup
    change = () if machine.tool_change_area is None else (machine.tool_change_area,)
    return [area for area in (*change, *machine.keep_out, *setup.keep_out) if not area.work]


def _box(x: Pair, y: Pair) -> Ring:
    return [[x[0], y[0]], [x[1], y[0]], [x[1], y[1]], [x[0], y[1]]]


def _legend(root: ET.Element, y: float) -> float:
    x = EDGE
    for said, style in (
        ("work zero can be here", {"stroke": "#a5d6a7", "stroke-width": "10"}),
        ("zones", {"stroke": "#ffcc80", "stroke-width": "10"}),
        ("soft limits", {"stroke": _LIMIT, "stroke-width": "1.6", "stroke-dasharray": "9 4"}),
        ("work zero now, and what the job reaches", {"stroke": _NOW, "stroke-dasharray": "3 3"}),
        ("the nearest place", {"stroke": _JOB, "stroke-dasharray": "3 3"}),
    ):
        ET.SubElement(root, "path", {"d": f"M{x:.0f} {y - 4:.0f}h26", "fill": "none", **style})
        _say(root, x + 32, y, said, 12, _INK)
        x += 60 + 6.6 * len(said)
    return y + 24


def _lines(root: ET.Element, x: float, y: float, text: str, size: float, colour: str, *, bold: bool = False) -> float:
    """Write a text in as many lines as it needs; returns where the next one goes."""
    for line in wrapped(text, size, WIDTH - EDGE - x, bold):
        _say(root, x, y, line, size, colour, bold=bold)
        y += size + 5
    return y


def _say(
    root: ET.Element, x: float, y: float, text: str, size: float, colour: str, *, bold: bool = False,
    anchor: str = "start",
) -> None:  # fmt: skip
    element = ET.SubElement(root, "text", x=f"{x:.1f}", y=f"{y:.1f}", fill=colour)
    element.set("font-size", f"{size:g}")
    if bold:
        element.set("font-weight", "bold")
    if anchor != "start":
        element.set("text-anchor", anchor)
    element.text = "".join(c if c.isprintable() else "?" for c in text)


def _step(least: float) -> float:
    """1, 2 or 5 times a power of ten, not below ``least``."""
    power = 10.0 ** math.floor(math.log10(least))
    return next(power * m for m in (1, 2, 5, 10) if power * m >= least * (1 - 1e-9))
