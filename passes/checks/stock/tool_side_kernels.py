"""The lower side of a tool, and where it is at its lowest over a point while the tip moves along a straight line.

The lower side is a function f of the distance r from the axis, convex and never falling up to the tool's radius. Where
the tip moves on a straight line, the height of that side over a point is convex in point and time together, so that its
least value over the move, the envelope, is convex in the point: over a cell that the move covers whole it is greatest
at a corner.

Families of shapes (family, R, c, k): 0 flat; 1 ball; 2 bull with corners of radius c; 3 cone with a flat of radius c
at the tip and k mm outwards for each mm upwards (vee, drill).
"""

from __future__ import annotations

import math
from typing import Any

from gproof.ir.kernel import kernel

FLAT, BALL, BULL, CONE = 0, 1, 2, 3


@kernel(compile_seconds=0.2)
def lower_side(family: int, radius: float, c: float, k: float, r: float) -> float:
    """Height of the tool's lower side over its tip at distance r from the axis, r at most its radius."""
    if family == 0:
        return 0.0
    if family == 1:
        return radius - math.sqrt(max(radius * radius - r * r, 0.0))
    if family == 2:
        over = r - (radius - c)
        return 0.0 if over <= 0.0 else c - math.sqrt(max(c * c - over * over, 0.0))
    return max(r - c, 0.0) / k


@kernel(compile_seconds=0.2)
def smaller(family: int, radius: float, c: float, k: float, by: float) -> tuple[int, float, float, float]:
    """(family, radius, c, tip up): a tool within the given one wherever it is up to ``by`` away from it in X-Y."""
    if family == 0:
        return 0, radius - by, 0.0, 0.0
    if family == 1:
        return 1, radius - by, radius - by, by
    if family == 2:
        if c > by:
            return 2, radius - by, c - by, by
        return 0, radius - by, 0.0, c
    if c >= by:
        return 3, radius - by, c - by, 0.0
    return 3, radius - by, 0.0, (by - c) / k


@kernel(compile_seconds=0.2)
def wider(family: int, radius: float, c: float, by: float) -> tuple[float, float, float]:
    """(radius, c, tip down) of a tool of that family that holds the given one wherever that is ``by`` away."""
    if family == 0:
        return radius + by, 0.0, 0.0
    if family == 3:
        return radius + by, c + by, 0.0
    return radius + by, c + by, by


@kernel(compile_seconds=0.5)
def envelope(family: int, radius: float, c: float, k: float, s: float, q: float, length: float, slope: float) -> float:
    """Least height of the tool's lower side, over the tip at the move's start, over a point.

    s, q: the point along and across the move; slope: of the tip, mm up for each mm along; the move covers the point.
    Any place of the tool on its way bounds the least height from above; the one taken is the best.
    """
    q2 = q * q
    a = math.sqrt(max(radius * radius - q2, 0.0))
    w = 0.0
    if slope != 0.0:
        if family == 0:
            w = a
        elif family == 1:
            w = abs(slope) * a / math.sqrt(1.0 + slope * slope)
        elif family == 2:
            w = bull_shift(radius, c, q2, a, abs(slope))
        else:
            steep = abs(slope) * k
            w = a
            if steep < 1.0:
                w = max(steep * abs(q) / math.sqrt(1.0 - steep * steep), math.sqrt(max(c * c - q2, 0.0)))
                w = min(w, a)
        if slope > 0.0:
            w = -w
    at = min(max(s + w, 0.0), length)
    away = s - at
    return slope * at + lower_side(family, radius, c, k, math.sqrt(away * away + q2))


@kernel(compile_seconds=0.3)
def bull_shift(radius: float, c: float, q2: float, a: float, slope: float) -> float:
    """How far after a point the lowest place of a bull on a slope is: where its side is as steep as the slope."""
    flat = radius - c
    low = math.sqrt(max(flat * flat - q2, 0.0))
    high = a
    for _ in range(44):
        w = 0.5 * (low + high)
        r = math.sqrt(q2 + w * w)
        over = r - flat
        # f'(r) w / r against the slope, without dividing.
        if over * w < slope * r * math.sqrt(max(c * c - over * over, 0.0)):
            low = w
        else:
            high = w
    return low


@kernel(compile_seconds=0.8)
def side_line(
    family: int, radius: float, c: float, k: float, s: float, step_s: float, q: float, step_q: float, length: float,
    slope: float, up: float, out: Any,
) -> None:  # fmt: skip
    """``up`` and the envelope at points in a row: s, q of the first and what they change by; simple loops are fast."""
    if family == 1:
        square = radius * radius
        shift = slope / math.sqrt(1.0 + slope * slope)
        up += radius
        for i in range(len(out)):
            across = q + i * step_q
            along = s + i * step_s
            left = square - across * across
            at = min(max(along - shift * math.sqrt(max(left, 0.0)), 0.0), length)
            away = along - at
            out[i] = up + slope * at - math.sqrt(max(left - away * away, 0.0))
    elif family == 0 and slope == 0.0:
        out[:] = up
    else:
        for i in range(len(out)):
            out[i] = up + envelope(family, radius, c, k, s + i * step_s, q + i * step_q, length, slope)
