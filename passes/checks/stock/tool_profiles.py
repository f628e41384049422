"""Tools as the height fields of stock see them: a profile that cuts, and what is above it that must not touch.

Takes entries of the tool table (``ir.machine.Tool``). A tool without a flute length cuts along all of its stated
length. A drill without a tip angle touches what a flat one would, and takes nothing away for certain. Of what is above
the last stated part nothing is known: stock that is higher than that over the tip may touch it.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from gproof.ir.machine import SHAPES, Tool
from gproof.passes.checks.stock.entry_kernels import HOLDER, SHANK
from gproof.passes.checks.stock.tool_side_kernels import BALL, BULL, CONE, FLAT

Floats = npt.NDArray[np.float64]

COLUMNS = 11
"""Of a tool: family, radius, c, k, 0, flutes, greatest depth, height from which on nothing is known, height up to which
it cuts, height from which on it is thinner than its cutter, radius within which its lower side is certain."""
PART_COLUMNS = 6
NOT_KNOWN = (-1.0, 0.0, 0.0, 0.0, 0.0, math.inf, math.inf, math.inf, math.inf, math.inf, 0.0)
AXIS = 1e-8
"""mm around the axis of a drill with an unknown tip: there its tip is."""
Row = tuple[float, ...]


def problem_of(tool: Tool | None, number: int) -> str:
    """What the table would have to say of a tool before anybody knows what it cuts; "" when it says enough."""
    if number < 0:
        return "the tool in the spindle is unknown"
    if tool is None:
        return f"there is no tool {number} in the tool table"
    missing = [n for n, v in (("shape", tool.shape), ("diameter", tool.diameter)) if v is None]
    if tool.shape == "bull" and tool.corner_radius is None:
        missing.append("corner radius")
    if tool.shape == "vee" and tool.tip_angle is None:
        missing.append("tip angle")
    if missing:
        return f"the machine file gives no {' and no '.join(missing)} of tool {number}"
    assert tool.diameter is not None
    sane = tool.shape in SHAPES and 0.0 < tool.diameter < math.inf
    if tool.shape == "bull":
        sane = sane and 0.0 <= (tool.corner_radius or 0.0) <= tool.diameter / 2.0
    if tool.shape in ("vee", "drill"):
        sane = sane and (tool.tip_angle is None or 0.0 < tool.tip_angle <= 180.0)
    return "" if sane else f"the data of tool {number} do not make a tool"


def profile(tool: Tool) -> Row:
    """(family, radius, c, k) of a tool without a problem."""
    assert tool.diameter is not None
    radius = tool.diameter / 2.0
    if tool.shape == "ball":
        return BALL, radius, radius, 0.0
    if tool.shape == "bull" and tool.corner_radius:
        if tool.corner_radius == radius:
            return BALL, radius, radius, 0.0
        return BULL, radius, tool.corner_radius, 0.0
    if tool.shape in ("vee", "drill"):
        flat = min(radius, (tool.tip_diameter or 0.0) / 2.0) if tool.shape == "vee" else 0.0
        wide = math.tan(math.radians(180.0 if tool.tip_angle is None else tool.tip_angle) / 2.0)
        if flat < radius and wide < 1e9:
            top = min([each for each in (tool.flute_length, tool.stickout) if each is not None], default=math.inf)
            # A cone that ends before it is as wide as the tool.
            radius = min(radius, flat + top * wide)
            return CONE, radius, flat, wide
    return FLAT, radius, 0.0, 0.0


def rows_of(tool: Tool) -> tuple[Row, list[Row]]:
    """The row of a tool, and those of its shank and holder: (family, radius, c, k, height, column of the report)."""
    family, radius, c, k = profile(tool)
    flutes, stickout = tool.flute_length, tool.stickout
    stated = [each for each in (flutes, stickout) if each is not None]
    known = min(stated, default=0.0)
    reach = min(stated, default=math.inf)
    parts: list[Row] = []
    thinner = math.inf
    if flutes is not None and stickout is not None and stickout > flutes and tool.shank_diameter is not None:
        shank = tool.shank_diameter / 2.0
        parts.append((FLAT, shank, 0.0, 0.0, flutes, SHANK))
        known = stickout
        if shank < radius:
            thinner = flutes
    if stickout is not None and known == stickout:
        at = stickout
        for below, above, height in tool.holder:
            low, high = below / 2.0, above / 2.0
            if high > low and height > 0.0:
                parts.append((CONE, high, low, (high - low) / height, at, HOLDER))
            else:
                parts.append((FLAT, max(low, high) if height <= 0.0 else low, 0.0, 0.0, at, HOLDER))
            if min(low, high) < radius:
                thinner = min(thinner, at)
            at += height
        known = at
    depth = math.inf if tool.max_depth is None else tool.max_depth
    certain = AXIS if tool.shape == "drill" and tool.tip_angle is None else radius
    deepest = math.inf if flutes is None else flutes
    return (family, radius, c, k, 0.0, deepest, depth, known, reach, thinner, certain), parts


def assumed(tool: Tool) -> tuple[str, ...]:
    """What the answer takes for granted of a tool."""
    out = []
    if tool.flute_length is None and tool.stickout is not None:
        out.append(f"tool {tool.number} cuts along all of its length: its flute length is not in the machine file")
    if tool.shape == "drill" and tool.tip_angle is None:
        said = (
            "is assumed to have a flat end, and to leave all that its tip may leave: its tip angle is not in the "
            "machine file"
        )
        out.append(f"tool {tool.number} {said}")
    return tuple(out)
