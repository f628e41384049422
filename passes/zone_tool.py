"""What of a tool a keep-out zone looks at, from the tip upwards: its cutter, and where the table states them, a shank
and parts of a holder that are wider.

Takes entries of the tool table (``ir.machine.Tool``). Heights are mm above the tip. What the table does not place is
not there: a shank without a flute length, a holder without a stickout (docs/machine-files.md, Keep-out zones).
"""

from __future__ import annotations

from collections.abc import Sequence

from gproof.ir.finding import Span
from gproof.ir.machine import Tool
from gproof.ir.record import record

Pair = tuple[float, float]

CUTTER = 0
"""Number of the part that every tool has; the others follow upwards."""


@record(frozen=True, slots=True)
class Part:
    """A stretch of a tool. heights: above the tip; width: least and greatest diameter, of which a taper has two."""

    name: str
    heights: Pair
    width: Pair


def parts(tool: Tool) -> tuple[Part, ...]:
    """What stands above the cutter and is wider than it, from below."""
    out = []
    cutter = tool.diameter or 0.0
    flute, stickout, shank = tool.flute_length, tool.stickout, tool.shank_diameter
    if flute is not None and shank is not None and shank > cutter:
        # How high it goes without a stickout nobody says; that it is there, it says.
        out.append(Part("shank", (flute, max(flute, stickout or 0.0)), (shank, shank)))
    at = stickout
    for below, above, height in tool.holder if at is not None else ():
        assert at is not None
        if height > 0.0 and max(below, above) > cutter:
            out.append(Part("holder", (at, at + height), (min(below, above), max(below, above))))
        at += height
    return tuple(out)


def most_parts(tools: Sequence[Tool]) -> int:
    """The greatest number of parts above the cutter that some tool has."""
    return max((len(parts(tool)) for tool in tools), default=0)


def part_of(tools: Sequence[Tool], number: int, part: int) -> tuple[Part | None, bool]:
    """The part of the tool in the spindle (0: none, -1: not known), None where it has none; whether that is certain.

    Of a tool that nobody states, all that any tool of the table has there.
    """
    if part == CUTTER:
        return _cutter(tools, number)
    if number != -1:
        own = next((parts(tool) for tool in tools if tool.number == number), ())
        return (own[part - 1] if part <= len(own) else None), True
    those = [found[part - 1] for tool in tools if part <= len(found := parts(tool))]
    if not those:
        return None, True
    names = dict.fromkeys(one.name for one in those)
    low, high = min(one.heights[0] for one in those), max(one.heights[1] for one in those)
    return Part(" or ".join(names), (low, high), (0.0, max(one.width[1] for one in those))), False


def _cutter(tools: Sequence[Tool], number: int) -> tuple[Part, bool]:
    """Of the tool, a point where the table does not say; of all where it may be any. How high it surely goes."""
    if number == -1:
        return Part("cutter", (0.0, 0.0), (0.0, max((tool.diameter or 0.0 for tool in tools), default=0.0))), False
    tool = next((tool for tool in tools if tool.number == number), None)
    if tool is None:
        return Part("cutter", (0.0, 0.0), (0.0, 0.0)), True
    own = tool.diameter or 0.0
    high = tool.flute_length or 0.0
    shank = own if tool.shank_diameter is None else tool.shank_diameter
    if tool.stickout is not None and shank >= own:
        high = max(high, tool.stickout)
    return Part("cutter", (0.0, high), (own, own)), True


class Told:
    """Lines of which one part of the tool has been told: the others say no more of them."""

    def __init__(self) -> None:
        self._told: set[tuple[str, int, bool]] = set()

    def again(self, span: Span, *, certain: bool) -> bool:
        """Whether it was told, for certain where this is; notes it."""
        keys = {(span.file, span.line, True), (span.file, span.line, certain)}
        if not keys.isdisjoint(self._told):
            return True
        self._told.add((span.file, span.line, certain))
        return False
