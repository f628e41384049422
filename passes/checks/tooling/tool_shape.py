"""A tool as a stack of convex bodies of revolution about Z, its tip at the origin; bodies within and around them.

Takes a table entry (``ir.machine.Tool``); gives ``Piece``s from the tip upwards: cutter, shank, parts of the holder,
and ``unstated``: all of space above what the table tells, which is how far the unknown rest may at most extend.
Lengths in mm. docs/gouges.md draws them.
"""

from __future__ import annotations

import itertools
import math

from gproof.ir.machine import Tool
from gproof.ir.record import record

Rim = tuple[float, float]
"""Radius and height."""

CUTTER, SHANK, HOLDER, UNSTATED = range(4)
PARTS = ("cutter", "shank", "holder", "unknown part above its given length")
WIDE = 1e4
"""Radius of what is unknown: wider than any machine."""
HIGH = 1e4
"""How far up the last piece goes."""


@record(frozen=True, slots=True, kw_only=True)
class Piece:
    """All points within ``rounding`` of the convex body of revolution between rims.

    part: one of CUTTER, SHANK, HOLDER, UNSTATED; rims: two or three, rising, each within the line of its neighbours.
    joint: of a piece that is across the joint of two others, and inside them, the height of the joint.
    """

    part: int
    rims: tuple[Rim, ...]
    rounding: float = 0.0
    joint: float | None = None

    @property
    def tip(self) -> float:
        """The height of its lowest point."""
        return self.rims[0][1] - self.rounding


ANYTHING = Piece(part=UNSTATED, rims=((WIDE, 0.0), (WIDE, WIDE)))
"""All of space above the tip: of a tool whose shape is unknown."""


@record(frozen=True, slots=True, kw_only=True)
class Shape:
    """A tool's pieces, the tip at the origin; problem: why there are none; assumed: what was taken in their place."""

    pieces: tuple[Piece, ...] = ()
    problem: str = ""
    assumed: tuple[str, ...] = ()

    def of(self, *parts: int) -> tuple[Piece, ...]:
        """The pieces of some parts."""
        return tuple(piece for piece in self.pieces if piece.part in parts)


def shape_of(tool: Tool) -> Shape:
    """The pieces of a tool.

    What the table leaves open is taken at its widest: a drill without a tip angle is flat, a tool without a flute
    length cuts along its whole stated length, and above what is stated all of space may be tool.
    """
    number = tool.number
    if tool.shape is None or tool.diameter is None:
        missing = " and ".join(n for n, v in (("shape", tool.shape), ("diameter", tool.diameter)) if v is None)
        return Shape(problem=f"the machine file gives no {missing} of tool {number}")
    radius = tool.diameter / 2.0
    if not (radius > 0.0 and math.isfinite(radius)):
        return Shape(problem=f"tool {number} has a diameter of {tool.diameter:g} mm")
    stated = tool.flute_length if tool.flute_length is not None else tool.stickout
    assumed = []
    if tool.flute_length is None:
        assumed.append(
            f"tool {number} is assumed to cut along all of its length: its flute length is not in the machine file"
        )
    top = HIGH if stated is None else stated
    if tool.stickout is not None:
        top = min(top, tool.stickout)
    cutter = _cutter(tool, radius, top)
    if isinstance(cutter, str):
        return Shape(problem=cutter)
    if tool.shape == "drill" and tool.tip_angle is None:
        assumed.append(f"tool {number} is assumed to have a flat end: its tip angle is not in the machine file")
    stack = [cutter]
    known = 0.0 if stated is None else top
    if stated is not None and tool.stickout is not None and tool.stickout > top:
        if tool.shank_diameter is not None:
            shank = tool.shank_diameter / 2.0
            stack.append(Piece(part=SHANK, rims=((shank, top), (shank, tool.stickout))))
            known = tool.stickout
    elif tool.stickout is not None:
        known = tool.stickout
    if tool.stickout is not None and known == tool.stickout:
        for below, above, height in tool.holder:
            if height > 0.0:
                stack.append(Piece(part=HOLDER, rims=((below / 2.0, known), (above / 2.0, known + height))))
                known += height
    bridges = [b for low, high in itertools.pairwise(stack) if (b := _bridge(low, high)) is not None]
    rest = Piece(part=UNSTATED, rims=((WIDE, known), (WIDE, known + HIGH)))
    return Shape(pieces=(*stack, *bridges, rest), assumed=tuple(assumed))


def _cutter(tool: Tool, radius: float, top: float) -> Piece | str:
    """The cutting part. A rounded one is rounded at its upper end too, above ``top``: never too small."""
    number = tool.number
    match tool.shape:
        case "flat":
            return Piece(part=CUTTER, rims=((radius, 0.0), (radius, top)))
        case "ball":
            return Piece(part=CUTTER, rims=((0.0, radius), (0.0, max(radius, top))), rounding=radius)
        case "bull":
            corner = tool.corner_radius
            if corner is None:
                return f"the machine file gives no corner radius of tool {number}"
            if not 0.0 <= corner <= radius:
                return f"tool {number} has a corner radius of {corner:g} mm on a radius of {radius:g} mm"
            inner = radius - corner
            return Piece(part=CUTTER, rims=((inner, corner), (inner, max(corner, top))), rounding=corner)
        case "vee" | "drill":
            angle = tool.tip_angle
            if angle is None:
                if tool.shape == "drill":
                    return Piece(part=CUTTER, rims=((radius, 0.0), (radius, top)))
                return f"the machine file gives no tip angle of tool {number}"
            if not 0.0 < angle <= 180.0:
                return f"tool {number} has a tip angle of {angle:g} degrees"
            flat = min(radius, (tool.tip_diameter or 0.0) / 2.0) if tool.shape == "vee" else 0.0
            cone = (radius - flat) / math.tan(math.radians(angle) / 2.0) if angle < 180.0 else 0.0
            if cone <= 0.0:
                return Piece(part=CUTTER, rims=((radius, 0.0), (radius, top)))
            if cone >= top:
                return Piece(part=CUTTER, rims=((flat, 0.0), (flat + (radius - flat) * top / cone, top)))
            return Piece(part=CUTTER, rims=((flat, 0.0), (radius, cone), (radius, top)))
    return f"tool {number} has the shape {tool.shape!r}"


def _bridge(low: Piece, high: Piece) -> Piece | None:
    """A cylinder inside both across their joint, so that what is there is not near a face of the tool."""
    z = high.rims[0][1]
    radius = min(*(r for r, _ in high.rims), *(r + low.rounding for r, _ in low.rims[-2:]))
    bottom, top = low.rims[-2][1], high.rims[-1][1]
    if radius <= 0.0 or not bottom < z < top:
        return None
    return Piece(part=high.part, rims=((radius, bottom), (radius, top)), joint=z)


def grown(piece: Piece, by: float) -> tuple[tuple[Rim, ...], float] | None:
    """Rims and rounding of all points within ``by`` of a piece; by < 0: of all that lie that deep inside it.

    None when nothing is that deep. Exact: the parallel body of a convex body is the meeting of its half spaces moved
    by that much.
    """
    if by >= -piece.rounding:
        return piece.rims, piece.rounding + by
    depth = -by - piece.rounding
    bottom, top = piece.rims[0][1] + depth, piece.rims[-1][1] - depth
    flanks: list[tuple[float, float]] = []  # radius at height 0, rise of the radius a mm
    for (r0, z0), (r1, z1) in zip(piece.rims, piece.rims[1:], strict=False):
        if z1 > z0:
            slope = (r1 - r0) / (z1 - z0)
            flanks.append((r0 - slope * z0 - depth * math.sqrt(1.0 + slope * slope), slope))
    for at, slope in flanks:
        if slope > 0.0:
            bottom = max(bottom, -at / slope)
        elif slope < 0.0:
            top = min(top, -at / slope)
        elif at < 0.0:
            return None
    if bottom > top:
        return None
    heights = [bottom, top]
    if len(flanks) == 2 and flanks[0][1] != flanks[1][1]:
        (a0, s0), (a1, s1) = flanks
        cross = (a1 - a0) / (s0 - s1)
        if bottom < cross < top:
            heights.insert(1, cross)
    rims = tuple((max(0.0, min(at + slope * z for at, slope in flanks)), z) for z in heights)
    return rims, 0.0
