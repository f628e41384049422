"""The path as a picture: SVG, top view and front view, limits, areas, where the first findings are, the verdict."""

from __future__ import annotations

import math
import os
import tempfile
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np

from gproof.cli.judge import Judgement
from gproof.cli.session import Session
from gproof.ir.finding import Severity
from gproof.ir.machine import Machine
from gproof.ir.trace import Chunk, Op, Plane
from gproof.ir.verdict import Verdict

WIDTH, MARGIN, GAP = 900.0, 40.0, 30.0
MAX_POINTS = 60_000
_COLOURS = {"feed": "#1565c0", "traverse": "#9e9e9e", "limit": "#616161", "area": "#ef6c00", "finding": "#d50000"}
_BADGE = {Verdict.SAFE: "#2e7d32", Verdict.UNSAFE: "#c62828", Verdict.UNKNOWN: "#6a1b9a"}
_ARC_STEP = math.radians(6)


class Drawing:
    """Collects the path while the job streams by; ``write`` draws it."""

    def __init__(self) -> None:
        self._points: list[np.ndarray] = []
        self._feed: list[np.ndarray] = []
        self._lines: list[np.ndarray] = []

    def add(self, chunk: Chunk) -> None:
        """Remember the chunk's motion; arcs as short chords, for the eye only."""
        rows = chunk.rows
        op = rows["op"]
        moving = op < Op.DWELL
        if not moving.any():
            return
        if not self._points:
            self._points.append(np.array([chunk.start[:3]], dtype=np.float32))
            self._feed.append(np.zeros(1, dtype=bool))
            self._lines.append(rows["line"][:1])
        if not (op == Op.ARC).any():
            self._points.append(rows["to"][moving, :3].astype(np.float32))
            self._feed.append(op[moving] != Op.TRAVERSE)
            self._lines.append(rows["line"][moving])
            return
        starts = chunk.starts()
        for i in np.flatnonzero(moving).tolist():
            if op[i] == Op.ARC:
                points = _arc(starts[i, :3], rows["to"][i, :3], rows["center"][i], int(rows["turns"][i]),
                              Plane(int(rows["plane"][i])))  # fmt: skip
            else:
                points = rows["to"][i : i + 1, :3]
            self._points.append(points.astype(np.float32))
            self._feed.append(np.full(len(points), op[i] != Op.TRAVERSE))
            self._lines.append(np.full(len(points), rows["line"][i]))

    def write(self, path: Path, session: Session, judgement: Judgement) -> None:
        """Draw and write the file, whole or not at all."""
        points = np.concatenate(self._points) if self._points else np.zeros((1, 3), dtype=np.float32)
        feed = np.concatenate(self._feed) if self._feed else np.zeros(1, dtype=bool)
        lines = np.concatenate(self._lines) if self._lines else np.zeros(1, dtype=np.int64)
        text = _svg(points, feed, lines, session, judgement)
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(dir=path.parent, suffix=".svg")
        try:
            with os.fdopen(handle, "w", encoding="utf-8") as out:
                out.write(text)
            os.chmod(name, 0o644)
            os.replace(name, path)
        except BaseException:
            os.unlink(name)
            raise


def _arc(start: np.ndarray, end: np.ndarray, center: np.ndarray, turns: int, plane: Plane) -> np.ndarray:
    u, v = {Plane.XY: (0, 1), Plane.XZ: (2, 0), Plane.YZ: (1, 2)}[plane]
    a0 = math.atan2(start[v] - center[v], start[u] - center[u])
    a1 = math.atan2(end[v] - center[v], end[u] - center[u])
    sign = 1 if turns > 0 else -1
    sweep = ((a1 - a0) * sign) % (2 * math.pi)
    if sweep < 1e-9:
        sweep = 2 * math.pi
    sweep += (abs(turns) - 1) * 2 * math.pi
    count = max(2, math.ceil(sweep / _ARC_STEP))
    t = np.linspace(0, 1, count + 1)[1:]
    angle = a0 + sign * sweep * t
    radius = math.hypot(start[u] - center[u], start[v] - center[v])
    out = start + np.outer(t, end - start)
    out[:, u], out[:, v] = center[u] + radius * np.cos(angle), center[v] + radius * np.sin(angle)
    return out


class _View:
    """Machine coordinates of two axes to the page."""

    def __init__(self, low: np.ndarray, high: np.ndarray, axes: tuple[int, int], scale: float, top: float) -> None:
        self.low, self.high, self.axes, self.scale, self.top = low, high, axes, scale, top

    @property
    def height(self) -> float:
        v = self.axes[1]
        return float(self.high[v] - self.low[v]) * self.scale

    def at(self, x: float, y: float) -> tuple[float, float]:
        u, v = self.axes
        return MARGIN + (x - float(self.low[u])) * self.scale, self.top + (float(self.high[v]) - y) * self.scale

    def path(self, points: np.ndarray) -> str:
        u, v = self.axes
        x = MARGIN + (points[:, u] - self.low[u]) * self.scale
        y = self.top + (self.high[v] - points[:, v]) * self.scale
        return "M" + "L".join(f"{a:.1f} {b:.1f}" for a, b in zip(x.tolist(), y.tolist(), strict=True))


def _extent(points: np.ndarray, machine: Machine) -> tuple[np.ndarray, np.ndarray]:
    low, high = points.min(axis=0).astype(float), points.max(axis=0).astype(float)
    for axis in machine.axes[:3]:
        if axis.index < 3 and axis.lower is not None and axis.upper is not None:
            low[axis.index] = min(low[axis.index], axis.lower)
            high[axis.index] = max(high[axis.index], axis.upper)
    return low, np.maximum(high, low + 1.0)


def _svg(points: np.ndarray, feed: np.ndarray, lines: np.ndarray, session: Session, judgement: Judgement) -> str:
    low, high = _extent(points, session.machine)
    scale = (WIDTH - 2 * MARGIN) / float(high[0] - low[0])
    scale = min(scale, 700.0 / float(high[1] - low[1]))
    top = _View(low, high, (0, 1), scale, 70.0)
    front = _View(low, high, (0, 2), scale, 70.0 + top.height + GAP)
    page = front.top + front.height + MARGIN + 20
    root = ET.Element("svg", xmlns="http://www.w3.org/2000/svg", viewBox=f"0 0 {WIDTH:.0f} {page:.0f}",
                      width=f"{WIDTH:.0f}", height=f"{page:.0f}")  # fmt: skip
    root.set("font-family", "sans-serif")
    ET.SubElement(root, "rect", width="100%", height="100%", fill="#ffffff")
    _heading(root, session, judgement)
    bad = {f.span.line for f in judgement.findings.kept if f.severity is Severity.ERROR}
    keep = np.linspace(0, len(points) - 1, min(len(points), MAX_POINTS)).astype(int)
    points, feed, lines = points[keep], feed[keep], lines[keep]
    for view, name in ((top, "top view, X Y"), (front, "front view, X Z")):
        _limits(root, view, session.machine)
        _runs(root, view, points, feed)
        _marks(root, view, points, lines, bad)
        x, y = view.at(float(low[0]), float(high[view.axes[1]]))
        ET.SubElement(root, "text", x=f"{x:.1f}", y=f"{y - 5:.1f}", fill="#616161").text = name
        root[-1].set("font-size", "11")
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + ET.tostring(root, encoding="unicode") + "\n"


def _heading(root: ET.Element, session: Session, judgement: Judgement) -> None:
    text = ET.SubElement(root, "text", x=f"{MARGIN}", y="32", fill=_BADGE[judgement.verdict])
    text.set("font-size", "22")
    text.set("font-weight", "bold")
    text.text = judgement.verdict.value
    name = ET.SubElement(root, "text", x=f"{MARGIN + 130}", y="32", fill="#212121")
    name.set("font-size", "14")
    parts = [f"{r.name} {r.verdict.value}" for r in judgement.properties]
    name.text = f"{session.job.parent.name}/{session.job.name} on {session.machine.name}: " + ", ".join(parts)


def _limits(root: ET.Element, view: _View, machine: Machine) -> None:
    u, v = (next((a for a in machine.axes if a.index == k), None) for k in view.axes)
    if u and v and None not in (u.lower, u.upper, v.lower, v.upper):
        _box(root, view, (u.lower, u.upper), (v.lower, v.upper), _COLOURS["limit"], "soft limits", 0.0)  # type: ignore[arg-type]
    if machine.tool_change_area is not None:
        box = machine.tool_change_area.box
        _box(root, view, box[view.axes[0]], box[view.axes[1]], _COLOURS["area"], "tool change area", 0.15)


def _box(
    root: ET.Element, view: _View, x: tuple[float, float], y: tuple[float, float], colour: str, title: str, fill: float
) -> None:
    u, v = view.axes
    x = max(x[0], float(view.low[u])), min(x[1], float(view.high[u]))
    y = max(y[0], float(view.low[v])), min(y[1], float(view.high[v]))
    left, up = view.at(x[0], y[1])
    rect = ET.SubElement(root, "rect", x=f"{left:.1f}", y=f"{up:.1f}", width=f"{max(0.0, x[1] - x[0]) * view.scale:.1f}",
                         height=f"{max(0.0, y[1] - y[0]) * view.scale:.1f}", stroke=colour)  # fmt: skip
    rect.set("fill", colour)
    rect.set("fill-opacity", str(fill))
    rect.set("stroke-dasharray", "6 3")
    ET.SubElement(rect, "title").text = title


def _runs(root: ET.Element, view: _View, points: np.ndarray, feed: np.ndarray) -> None:
    """One path element for each run of feed or traverse moves."""
    edges = np.flatnonzero(feed[1:] != feed[:-1]) + 1
    begin = 1
    for stop in [*edges.tolist(), len(points)]:
        if stop <= begin:
            continue
        kind = "feed" if feed[begin] else "traverse"
        path = ET.SubElement(root, "path", d=view.path(points[begin - 1 : stop]), fill="none", stroke=_COLOURS[kind])
        path.set("stroke-width", "1.2" if kind == "feed" else "0.6")
        if kind == "traverse":
            path.set("stroke-dasharray", "3 3")
        begin = stop


def _marks(root: ET.Element, view: _View, points: np.ndarray, lines: np.ndarray, bad: set[int]) -> None:
    """A ring where a line with an error ends."""
    if not bad:
        return
    hits = np.flatnonzero(np.isin(lines, np.array(sorted(bad))))
    for i in hits[:200].tolist():
        x, y = view.at(float(points[i, view.axes[0]]), float(points[i, view.axes[1]]))
        mark = ET.SubElement(
            root, "circle", cx=f"{x:.1f}", cy=f"{y:.1f}", r="5", fill="none", stroke=_COLOURS["finding"]
        )
        mark.set("stroke-width", "2")
        ET.SubElement(mark, "title").text = f"line {int(lines[i])}"
