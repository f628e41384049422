"""What of a tool a keep-out zone looks at, from the tip upwards: its cutter, and where the table states them, a shank
and parts of a holder that are wider.

Takes what is known of the tool in the spindle (``spindle_tool.Entry``). Heights are mm above the tip. What the table
does not place is not there: a shank without a flute length, a holder without a stickout; but the cutter goes on above
the stated lengths, perhaps as wide (docs/machine-files.md, Keep-out zones). Of a tool that is in no table, or has no
diameter there, only its tip is certain, and all of space above it may be tool. Tool 0 is none: a point.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from gproof.ir.finding import Span
from gproof.ir.machine import Tool
from gproof.ir.record import record
from gproof.passes.checks.tooling.spindle_tool import Entry

Pair = tuple[float, float]

CUTTER = 0
"""Number of the part that every tool has; the others follow upwards."""
ANYWHERE = (0.0, math.inf)
TIP = (0.0, 0.0)


@record(frozen=True, slots=True)
class Part:
    """A stretch of a tool. heights: above the tip; width: least and greatest diameter; sure: heights that it has for
    certain with its least diameter, None where nothing is certain; doubt: why there is more than that, "" where there
    is not."""

    name: str
    heights: Pair
    width: Pair
    sure: Pair | None
    doubt: str = ""


def parts(tool: Tool) -> tuple[Part, ...]:
    """What is above the cutter and is wider than it, from below."""
    out = []
    cutter = tool.diameter or 0.0
    flute, stickout, shank = tool.flute_length, tool.stickout, tool.shank_diameter
    if flute is not None and shank is not None and shank > cutter:
        # Without a stickout its height is unknown, but it is there.
        heights = (flute, max(flute, stickout or 0.0))
        out.append(Part("shank", heights, (shank, shank), heights))
    at = stickout
    for below, above, height in tool.holder if at is not None else ():
        assert at is not None
        if height > 0.0 and max(below, above) > cutter:
            width = min(below, above), max(below, above)
            doubt = "" if width[0] == width[1] else "where its holder tapers"
            out.append(Part("holder", (at, at + height), width, (at, at + height), doubt))
        at += height
    return tuple(out)


def most_parts(tools: Sequence[Tool]) -> int:
    """The greatest number of parts above the cutter that some tool has."""
    return max((len(parts(tool)) for tool in tools), default=0)


def part_of(those: Sequence[Entry], part: int, *, known: bool) -> Part | None:
    """A part of the tool in the spindle, None where it has none. known: it is the only one of ``those``, else any."""
    if part == CUTTER:
        found = [_cutter(entry) for entry in those]
    else:
        found = [own[part - 1] for entry in those if entry.tool is not None and part <= len(own := parts(entry.tool))]
    if known:
        return found[0] if found else None
    doubt = "the tool in the spindle"
    if not found:
        return Part("cutter", ANYWHERE, ANYWHERE, TIP, doubt) if part == CUTTER else None
    names = dict.fromkeys(one.name for one in found)
    heights = min(one.heights[0] for one in found), max(one.heights[1] for one in found)
    widest = max(one.width[1] for one in found)
    return Part(" or ".join(names), heights, (0.0, widest), TIP if part == CUTTER else None, doubt)


def _cutter(entry: Entry) -> Part:
    """From the tip up to where the table says what it is, and beyond, perhaps, as wide."""
    tool, number = entry.tool, entry.number
    if number == 0 and tool is None:
        return Part("cutter", TIP, TIP, TIP)
    if entry.ends is None:
        doubt = entry.doubt or f"the width of tool {number}, which is not in the tool table"
        return Part("cutter", ANYWHERE, ANYWHERE, TIP, doubt)
    assert tool is not None
    least, most = entry.ends
    high = tool.flute_length or 0.0
    if tool.stickout is not None and (tool.shank_diameter is None or tool.shank_diameter >= most):
        high = max(high, tool.stickout)
    if least != most:
        return Part("cutter", ANYWHERE, entry.ends, (0.0, high), entry.doubt)
    doubt = f"the width of tool {number} above {high:g} mm from its tip"
    return Part("cutter", ANYWHERE, entry.ends, (0.0, high), doubt)


class Told:
    """Lines of which one part of the tool has been reported: the others say no more of them."""

    def __init__(self) -> None:
        self._told: set[tuple[str, int, bool]] = set()

    def again(self, span: Span, *, certain: bool) -> bool:
        """Whether it was reported, for certain where this is; notes it."""
        keys = {(span.file, span.line, True), (span.file, span.line, certain)}
        if not keys.isdisjoint(self._told):
            return True
        self._told.add((span.file, span.line, certain))
        return False
