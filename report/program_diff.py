"""Where two programs part: text, JSON and a picture from above."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from itertools import islice
from typing import TYPE_CHECKING, Any

import numpy as np

from gproof.ir.trace import Op, Plane, Trace
from gproof.ir.verdict import Verdict
from gproof.report.escape import program_line
from gproof.verify.translation.comparison import Divergence, Place
from gproof.verify.translation.words import sentence, where

if TYPE_CHECKING:
    from gproof.driver.program_diff import ProgramDiff

SHOWN = 5
"""Differences that the text shows; the first is the one that counts."""
SIZE, MARGIN = 800.0, 40.0
MOST = 50_000
"""Points of a path in the picture."""
COLOURS = ("#1f6feb", "#e36209")


def diff_lines(done: ProgramDiff) -> list[str]:
    """The answer, then each difference with both lines below one another."""
    first, second = (str(session.job) for session in done.sessions)
    said = {
        Verdict.SAFE: "do the same, wherever the work zero is",
        Verdict.UNSAFE: "do not do the same",
        Verdict.UNKNOWN: "may not do the same: something is unknown",
    }[done.verdict]
    lines = [f"{first} and {second} {said}"]
    if done.comparison is None:
        return lines
    for found in islice(done.comparison.differences, SHOWN):
        lines += _both(done, found, is_open=False)
    for found in islice(done.comparison.unknown, SHOWN):
        lines += _both(done, found, is_open=True)
    lines += [f"  open: {one.span.file}:{one.span.line}: {one.code.label} {one.message}" for one in done.findings.kept]
    lines += [f"  assumed: {text}" for text in done.assumed]
    if done.verdict is Verdict.SAFE:
        mm, degrees = done.comparison.drift
        moves = done.comparison.rows
        lines.append(
            f"  compared: {moves[0]} and {moves[1]} moves; largest difference {mm:.2g} mm, {degrees:.2g} degrees"
        )
    return lines


def _both(done: ProgramDiff, found: Divergence, *, is_open: bool) -> list[str]:
    lines = [f"  {sentence(found, is_open=is_open)}"]
    for place, session in zip((found.source, found.target), done.sessions, strict=True):
        lines.append(f"    {where(place)}: {_written(place, session)}")
    return lines


def _written(place: Place | None, session: Any) -> str:
    if place is None or session.program is None:
        return ""
    source = next((one for one in session.program.files if one.name == place[0]), None)
    if source is None:
        return ""
    rows = bytes(source.data).split(b"\n")
    text = rows[place[1] - 1] if 0 < place[1] <= len(rows) else b""
    return program_line(text.decode("utf-8", "replace").strip())


def diff_json(done: ProgramDiff) -> dict[str, Any]:
    """The same for programs."""
    found = done.comparison
    return {
        "schema": "gproof-diff/1",
        "verdict": done.verdict.value,
        "exit_code": done.verdict.exit_code,
        "programs": [str(session.job) for session in done.sessions],
        "differences": [] if found is None else [_one(one, is_open=False) for one in found.differences],
        "unknown": [] if found is None else [_one(one, is_open=True) for one in found.unknown],
        "assumed": done.assumed,
        "moves": None if found is None else list(found.rows),
    }


def _one(found: Divergence, *, is_open: bool) -> dict[str, Any]:
    places = [None if one is None else {"file": one[0], "line": one[1]} for one in (found.source, found.target)]
    return {"what": sentence(found, is_open=is_open), "first": places[0], "second": places[1]}


def picture_of(done: ProgramDiff) -> str:
    """Both paths from above, numbers from their work zeros, and a ring where they part."""
    paths = [] if done.traces is None else [_points(trace) for trace in done.traces]
    drawn = [path[:, :2] for path, _ in paths if len(path)]
    low = np.min([path.min(axis=0) for path in drawn], axis=0) if drawn else np.zeros(2)
    high = np.max([path.max(axis=0) for path in drawn], axis=0) if drawn else np.ones(2)
    scale = (SIZE - 2 * MARGIN) / max(float((high - low).max()), 1e-9)

    def at(point: Any) -> tuple[float, float]:
        x, y = (point[:2] - low) * scale
        return MARGIN + float(x), SIZE - MARGIN - float(y)

    root = ET.Element(
        "svg", xmlns="http://www.w3.org/2000/svg", viewBox=f"0 0 {SIZE:g} {SIZE + 50:g}", width=f"{SIZE:g}",
        height=f"{SIZE + 50:g}", attrib={"font-family": "sans-serif", "font-size": "14"},
    )  # fmt: skip
    ET.SubElement(root, "rect", width="100%", height="100%", fill="white")
    for number, (path, _) in enumerate(paths):
        text = " ".join(f"{x:.1f},{y:.1f}" for x, y in map(at, path))
        style = {"stroke-dasharray": "5 4"} if number else {}
        ET.SubElement(root, "polyline", points=text, fill="none", stroke=COLOURS[number], attrib=style)
    _parting(root, done, paths, at)
    for number, session in enumerate(done.sessions):
        y = SIZE + 10 + 20 * number
        ET.SubElement(root, "text", x=f"{MARGIN:g}", y=f"{y:g}", fill=COLOURS[number]).text = str(session.job)
    return ET.tostring(root, encoding="unicode") + "\n"


def _parting(root: ET.Element, done: ProgramDiff, paths: list[Any], at: Any) -> None:
    """A ring at the first difference, on each path that has its line."""
    if done.comparison is None or not done.comparison.differences:
        return
    found = done.comparison.differences[0]
    for number, place in enumerate((found.source, found.target)):
        points, lines = paths[number]
        rows: list[int] = np.flatnonzero(lines == place[1]).tolist() if place is not None else []
        if len(rows):
            x, y = at(points[rows[0]])
            ET.SubElement(
                root, "circle", cx=f"{x:.1f}", cy=f"{y:.1f}", r=f"{9 + 4 * number}", fill="none", stroke="#d1242f",
                attrib={"stroke-width": "2.5"},
            )  # fmt: skip


def _points(trace: Trace) -> tuple[Any, Any]:
    """(points, lines) of a path from above, arcs as short chords, thinned to what an eye can see."""
    points: list[Any] = []
    lines: list[int] = []
    for section in trace.sections:
        rows = section.rows
        last = np.array(section.start[:3])
        moving = np.flatnonzero(rows["op"] < Op.DWELL)
        step = max(1, len(moving) // MOST)
        for row in moving[::step].tolist():
            to = rows["to"][row][:3]
            if rows["op"][row] == Op.ARC and rows["plane"][row] == Plane.XY and step == 1:
                points += _chords(last, to, rows["center"][row], int(rows["turns"][row]))
                lines += [int(rows["line"][row])] * (len(points) - len(lines))
            points.append(to)
            lines.append(int(rows["line"][row]))
            last = to
    return np.array(points).reshape(-1, 3), np.array(lines)


def _chords(start: Any, end: Any, center: Any, turns: int) -> list[Any]:
    a0 = math.atan2(start[1] - center[1], start[0] - center[0])
    a1 = math.atan2(end[1] - center[1], end[0] - center[0])
    sign = 1 if turns > 0 else -1
    sweep = ((a1 - a0) * sign) % (2 * math.pi) or 2 * math.pi
    radius = math.hypot(start[0] - center[0], start[1] - center[1])
    count = max(2, math.ceil(sweep / math.radians(5)))
    return [
        np.array([
            center[0] + radius * math.cos(a0 + sign * sweep * k / count),
            center[1] + radius * math.sin(a0 + sign * sweep * k / count), end[2],
        ])
        for k in range(1, count)
    ]  # fmt: skip
