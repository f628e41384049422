"""Corners of a contour next to which a tool moves: which of them the usual strategies take near the contour.

Source: APCI-8001 G-code manual 2.7, which describes neither corners nor what inside corners need; open questions:
docs/dialects/mcuwin.md, Tool radius correction. Lengths mm, coordinates those of the plane, right-handed.
"""

from __future__ import annotations

import math

from gproof.ir.finding import fixed
from gproof.ir.record import record
from gproof.passes.interpret.core.line_kernels import distance

REACH = 4.0
"""Tool radii from a corner to where the offset lines meet, at most: beyond, strategies differ without bound."""
TANGENTIAL = 0.01
"""rad: a corner at an arc that is none."""
_SLACK = 1e-9
"""mm, rad: rounding."""

Point = tuple[float, float]


@record(frozen=True, slots=True)
class Element:
    """A line or an arc of the contour in its plane.

    center: of an arc, turns: as of the Trace, 0: a line. taken: mm along it that its first corner takes away from the
    path of the tool on the left and on the right.
    """

    start: Point
    end: Point
    center: Point | None = None
    turns: int = 0
    taken: tuple[float, float] = (0.0, 0.0)

    @property
    def sense(self) -> int:
        """1 counter-clockwise, -1 clockwise."""
        return 1 if self.turns > 0 else -1

    @property
    def radius(self) -> float:
        """Of an arc."""
        assert self.center is not None
        return distance(self.start[0] - self.center[0], self.start[1] - self.center[1])

    @property
    def length(self) -> float:
        """mm, of one turn at most."""
        if self.center is None:
            return distance(self.end[0] - self.start[0], self.end[1] - self.start[1])
        if abs(self.turns) > 1 or self.start == self.end:
            return 2.0 * math.pi * self.radius
        first, last = _angle(self.start, self.center), _angle(self.end, self.center)
        return self.radius * ((last - first) * self.sense % (2.0 * math.pi) or 2.0 * math.pi)

    def direction(self, *, at_end: bool) -> Point:
        """Unit vector along the contour."""
        if self.center is None:
            length = self.length
            return (self.end[0] - self.start[0]) / length, (self.end[1] - self.start[1]) / length
        at = self.end if at_end else self.start
        out = at[0] - self.center[0], at[1] - self.center[1]
        length = distance(*out)
        return -out[1] * self.sense / length, out[0] * self.sense / length

    def beside(self, side: int, tool: float) -> float:
        """Radius of the arc on which the tool goes; not positive: there is none."""
        return self.radius - side * self.sense * tool

    def along(self, point: Point, *, at_end: bool) -> float:
        """mm from an end of the contour's element inwards, to what is next to ``point``; negative: outside of it."""
        at = self.end if at_end else self.start
        if self.center is None:
            dx, dy = self.direction(at_end=at_end)
            way = (point[0] - at[0]) * dx + (point[1] - at[1]) * dy
        else:
            turn = (_angle(point, self.center) - _angle(at, self.center)) * self.sense
            way = self.radius * math.remainder(turn, 2.0 * math.pi)
        return -way if at_end else way


def _angle(point: Point, center: Point) -> float:
    return math.atan2(point[1] - center[1], point[0] - center[0])


def meet(one: Element, other: Element, side: int, tool: float) -> tuple[str, float, float]:
    """(what is not known of the corner between two elements or "", mm that it takes of each of them).

    side: 1 the tool is on the left, -1 on the right; tool: its radius.
    """
    (ax, ay), (bx, by) = one.direction(at_end=True), other.direction(at_end=False)
    cross, dot = ax * by - ay * bx, ax * bx + ay * by
    if (1.0 + dot) * REACH * REACH < 2.0:
        return f"a corner of {math.degrees(math.atan2(abs(cross), -dot)):.1f} degrees", 0.0, 0.0
    inside = cross * side > 0.0
    if one.center is None and other.center is None:
        taken = tool * abs(cross) / (1.0 + dot) if inside else 0.0
        return "", taken, taken
    if abs(cross) < TANGENTIAL and dot > 0.0:
        return "", 0.0, 0.0
    at = one.end
    ways = [(one.along(p, at_end=True), other.along(p, at_end=False), distance(p[0] - at[0], p[1] - at[1]))
            for p in _crossings(one, other, side, tool)]  # fmt: skip
    if inside:
        fitting = [(a, b) for a, b, _ in ways if a > -_SLACK and b > -_SLACK]
        if not fitting:
            return "an inside corner where the paths next to an arc do not meet", 0.0, 0.0
        first, second = min(fitting, key=sum)
        return "", max(first, 0.0), max(second, 0.0)
    if not ways:
        return "", 0.0, 0.0
    first, second, far = min(ways, key=lambda way: way[2])
    if far > REACH * tool:
        return "a corner after an arc where the paths next to it meet far away", 0.0, 0.0
    return "", max(first, 0.0), max(second, 0.0)


def _crossings(one: Element, other: Element, side: int, tool: float) -> list[Point]:
    """Where the paths next to two elements meet, prolonged as lines and circles; at least one is a circle."""
    if one.center is None:
        one, other = other, one
        straight, at_end = other, True
    else:
        straight, at_end = other, False
    assert one.center is not None
    cx, cy = one.center
    radius = one.beside(side, tool)
    if straight.center is None:
        dx, dy = straight.direction(at_end=at_end)
        px, py = straight.end[0] - side * tool * dy, straight.end[1] + side * tool * dx
        foot = (cx - px) * dx + (cy - py) * dy
        px, py = px + foot * dx, py + foot * dy
        off = distance(px - cx, py - cy)
        if off > radius:
            return []
        half = math.sqrt(radius * radius - off * off)
        return [(px - half * dx, py - half * dy), (px + half * dx, py + half * dy)]
    run, ey = straight.center
    between = distance(run - cx, ey - cy)
    second = straight.beside(side, tool)
    if between < _SLACK or between > radius + second or between < abs(radius - second):
        return []
    along = (between * between + radius * radius - second * second) / (2.0 * between)
    half = math.sqrt(max(radius * radius - along * along, 0.0))
    ux, uy = (run - cx) / between, (ey - cy) / between
    mx, my = cx + along * ux, cy + along * uy
    return [(mx - half * uy, my + half * ux), (mx + half * uy, my - half * ux)]


def judge(last: Element | None, new: Element, sides: tuple[int, ...], tool: float) -> tuple[str, Element]:
    """(what is not known of the path next to ``new`` and of the corner before it or "", ``new`` with what it loses)."""
    if new.center is not None and any(new.beside(side, tool) <= _SLACK for side in sides):
        return f"the inside of an arc of radius {new.radius:g} mm with a tool of radius {tool:g} mm", new
    taken = [0.0, 0.0]
    for side in sides if last is not None else ():
        assert last is not None
        problem, before, behind = meet(last, new, side, tool)
        n = 0 if side > 0 else 1
        if problem:
            return problem, new
        if last.taken[n] + before > last.length + _SLACK or behind > new.length + _SLACK:
            short = min(last.length - last.taken[n] - before, new.length - behind)
            return f"an inside corner with an element {fixed(-short, 3)} mm too short for it", new
        taken[n] = behind
    return "", Element(new.start, new.end, new.center, new.turns, (taken[0], taken[1]))
