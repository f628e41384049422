"""Cutter radius compensation: its state, and the path of the tool's centre from the programmed contour.

The rules are those of the Eding CNC manual 4.01, chapter 5, and of the RS274/NGC interpreter that it describes: each
move is compensated when its line is read, from nothing but the tool's place and the programmed point.

All points are (u, v) in a right-handed pair of the plane, (X, Y) or (Z, X), in mm. side: +1 the tool is left of the
path, -1 right; sense: +1 counter-clockwise, -1 clockwise. A path is a list of ``Piece``; what the manual calls an
error comes back as a ``Fault`` with a path that leads on after it.
"""

from __future__ import annotations

import enum
import math
from dataclasses import replace

from gproof.ir.record import record
from gproof.ir.symbolic import Position
from gproof.ir.trace import Plane
from gproof.passes.interpret.core import cutter_compensation_kernels as k
from gproof.passes.interpret.core.cutter_compensation_kernels import HAIR, TWO_PI

PAIR = {Plane.XY: (0, 1), Plane.XZ: (2, 0)}
"""The axes of a plane's right-handed pair."""

Point = tuple[float, float]


class Trouble(enum.Enum):
    """What the manual calls an error (5.4) while a move is compensated."""

    CONCAVE_CORNER = "concave corner"
    GOUGING = "gouging"
    ARC_TOO_SMALL = "arc too small"
    ENTRY_ARC = "entry arc"


@record(frozen=True, slots=True)
class Fault:
    """An error and its numbers: degrees of a corner, mm of distances and radii."""

    trouble: Trouble
    number: float
    other: float = 0.0


@record(frozen=True, slots=True)
class Piece:
    """One stretch of the path: a line, or with a centre an arc. corner: goes around a convex corner."""

    end: Point
    center: Point | None = None
    turns: int = 0
    corner: bool = False


Path = tuple[list[Piece], Fault | None]


@record(frozen=True, slots=True, kw_only=True)
class Compensation:
    """Compensation while it is on.

    side: of the path in the right-handed pair, the sign of the diameter taken in; radius: mm, not negative, None when
    it is not stated; shift: from the centre of the tool's nose to the controlled point, in the pair (turning, 3.1.2.1);
    programmed: the point the program is at, along the pair's axes in machine coordinates, None until the first move;
    placed: the tool touches the contour there; left: where the axes were when the contour was left off, None when
    that does not matter.
    """

    side: int
    radius: float | None
    plane: Plane = Plane.XY
    shift: Point = (0.0, 0.0)
    programmed: tuple[Position, Position] | None = None
    placed: bool = False
    left: tuple[Position, Position] | None = None

    @property
    def axes(self) -> tuple[int, int]:
        """The two axes that are compensated, as a right-handed pair."""
        return PAIR[self.plane]

    def at(self, u: Position, v: Position, *, placed: bool) -> Compensation:
        """The same with the program at another point."""
        return replace(self, programmed=(u, v), placed=placed, left=None)


def entry_line(tool: Point, end: Point, side: int, radius: float) -> Path:
    """The first move, straight (5.4, figure A-6).

    From the tool to the programmed end is the hypotenuse of a triangle with its right angle where the tool goes.
    """
    u, v = tool[0] - end[0], tool[1] - end[1]
    distance = math.hypot(u, v)
    if distance <= radius + HAIR:
        normal = (0.0, float(side)) if distance == 0.0 else (side * v / distance, -side * u / distance)
        return [Piece(_moved(end, normal, radius))], Fault(Trouble.GOUGING, distance)
    cos = radius / distance
    sin = math.sqrt(1.0 - cos * cos)
    u, v = u / distance, v / distance
    return [Piece(_moved(end, (u * cos + side * v * sin, v * cos - side * u * sin), radius))], None


def line(tool: Point, start: Point, end: Point, side: int, radius: float, placed: bool) -> Path:
    """A straight move along the contour, around the corner before it if that is convex."""
    begins, u, v, angle = k.line_start(*tool, *start, *end, side)
    if begins == k.REST:
        return [Piece(tool)], None
    normal = u, v
    stop = Piece(_moved(end, normal, radius))
    if not placed or begins == k.SMOOTH:
        return [stop], None
    if begins == k.CONCAVE:
        return [stop], Fault(Trouble.CONCAVE_CORNER, _degrees(angle))
    return [_around(start, normal, side, radius), stop], None


def entry_arc(tool: Point, end: Point, center: Point, sense: int, side: int, radius: float, tolerance: float) -> Path:
    """The first move, an arc with a given centre (5.4, figure A-7).

    The auxiliary arc about the centre through the programmed end must touch the tool where it is. tolerance: mm by
    which it may miss.
    """
    inward = side * sense > 0
    arc_radius = math.dist(end, center)
    normal = _radial(end, center, -1.0 if inward else 1.0)
    stop = _moved(end, normal, radius)
    if math.dist(tool, end) <= radius + HAIR:
        return [Piece(stop)], Fault(Trouble.GOUGING, math.dist(tool, end))
    if inward and arc_radius <= radius + HAIR:
        return [Piece(stop)], Fault(Trouble.ARC_TOO_SMALL, arc_radius)
    wanted = arc_radius - radius if inward else arc_radius + radius
    there = math.dist(tool, center)
    if abs(there - wanted) > tolerance:
        return [Piece(stop)], Fault(Trouble.ENTRY_ARC, there, wanted)
    return [Piece(stop, center, sense)], None


def entry_arc_center(tool: Point, end: Point, arc_radius: float, sense: int, side: int, radius: float) -> Point | Fault:
    """The centre of the first move, an arc with a given radius (negative: the long way).

    It is ``arc_radius`` from the programmed end and that much, less or more a tool radius, from the tool.
    """
    big = abs(arc_radius)
    inward = side * sense > 0
    distance = math.dist(tool, end)
    if distance <= radius + HAIR:
        return Fault(Trouble.GOUGING, distance)
    if inward and big <= radius + HAIR:
        return Fault(Trouble.ARC_TOO_SMALL, big)
    from_tool = big - radius if inward else big + radius
    along = (from_tool * from_tool + distance * distance - big * big) / (2.0 * distance)
    beside = from_tool * from_tool - along * along
    if distance > big + from_tool or beside < 0.0:
        return Fault(Trouble.ENTRY_ARC, distance, big + from_tool)
    u, v = (end[0] - tool[0]) / distance, (end[1] - tool[1]) / distance
    # The centre of the shorter counter-clockwise arc is left of its chord.
    off = math.sqrt(beside) * (sense if arc_radius > 0 else -sense)
    return tool[0] + u * along - v * off, tool[1] + v * along + u * off


def arc(
    tool: Point, start: Point, end: Point, center: Point, sense: int, side: int, radius: float, placed: bool,
    tolerance: float,
) -> Path:  # fmt: skip
    """An arc along the contour, around the corner before it if that is convex.

    tolerance: mm by which the two radii of an arc may differ; a corner within ``CORNER`` that would throw the arc
    further off its circle than that counts as one.
    """
    inward = side * sense > 0
    outward = -1.0 if inward else 1.0
    begins, nu, nv, angle = k.arc_start(*tool, *start, *center, outward, side, radius, tolerance)
    first, last = (nu, nv), _radial(end, center, outward)
    begin, stop = _moved(start, first, radius), _moved(end, last, radius)
    small = min(k.distance(*start, *center), k.distance(*end, *center))
    if inward and small <= radius + HAIR:
        return [Piece(stop)], Fault(Trouble.ARC_TOO_SMALL, small)
    sweep = _sweep(start, end, center, sense)
    if start == end:
        stop = begin
    if not placed:
        return [Piece(begin), _arc_piece(begin, stop, center, sense, sweep)], None
    if begins == k.CONCAVE:
        pieces = [Piece(begin), _arc_piece(begin, stop, center, sense, sweep)]
        return pieces, Fault(Trouble.CONCAVE_CORNER, _degrees(angle))
    if begins == k.SMOOTH:
        ahead = k.between(*begin, *tool, *center) * sense
        return [_arc_piece(tool, stop, center, sense, sweep - ahead)], None
    return [_around(start, first, side, radius), _arc_piece(begin, stop, center, sense, sweep)], None


def path_length(tool: Point, pieces: list[Piece], rise: float) -> float:
    """mm along pieces, the last of which also goes ``rise`` across the plane."""
    length, at = 0.0, tool
    for n, piece in enumerate(pieces):
        flat = math.dist(at, piece.end)
        if piece.center is not None:
            sense = 1 if piece.turns > 0 else -1
            sweep = _sweep(at, piece.end, piece.center, sense) + (abs(piece.turns) - 1) * TWO_PI
            flat = sweep * (math.dist(at, piece.center) + math.dist(piece.end, piece.center)) / 2.0
        length += math.hypot(flat, rise if n == len(pieces) - 1 else 0.0)
        at = piece.end
    return length


def _moved(point: Point, direction: Point, distance: float) -> Point:
    return point[0] + direction[0] * distance, point[1] + direction[1] * distance


def _radial(point: Point, center: Point, sign: float) -> Point:
    return k.radial(*point, *center, sign)


def _around(corner: Point, normal: Point, side: int, radius: float) -> Piece:
    """The arc of the tool's radius around a convex corner."""
    return Piece(_moved(corner, normal, radius), corner, -side, corner=True)


def _sweep(start: Point, end: Point, center: Point, sense: int) -> float:
    return k.swept(*start, *end, *center, sense)


def _arc_piece(start: Point, stop: Point, center: Point, sense: int, sweep: float) -> Piece:
    """The arc of about ``sweep`` radians; a line where it is so short that its ends changed their order."""
    u, v, turns = k.arc_turns(*start, *stop, *center, sense, sweep)
    return Piece((u, v), center, turns) if turns else Piece(stop)


def _degrees(angle: float) -> float:
    """How far a concave corner turns towards the tool."""
    return math.degrees(TWO_PI - angle if angle > math.pi else -angle)
