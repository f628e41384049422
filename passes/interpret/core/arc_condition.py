"""How well an arc's words determine it: what the rounding of their last digits can do.

Eding CNC manual 3.4.3.1: an arc given by its radius is badly determined near a half circle and near a full one; those
up to 165 degrees, and from 195 to 345, are said to be fine.
"""

from __future__ import annotations

import math

from gproof.ir import codes
from gproof.ir.finding import Finding, Span

ROUNDING = 0.0005
"""mm by which a number of three decimals may have been rounded; with inches, of four decimals: ``ROUNDING_INCH``."""
ROUNDING_INCH = 0.00005 * 25.4
WELL_BELOW, WELL_ABOVE, NEARLY_FULL = 165.0, 195.0, 345.0
HINT = "program its centre with I and J (K), or split the arc"


def sweep_of(chord: float, radius: float) -> float:
    """Degrees of an arc by its radius, negative for the long way round, between ends so far apart."""
    half = math.degrees(math.asin(min(1.0, chord / (2.0 * abs(radius)))))
    return 360.0 - 2.0 * half if radius < 0 else 2.0 * half


def badly_determined(degrees: float) -> bool:
    """Whether a radius arc is one that 3.4.3.1 warns of."""
    return WELL_BELOW < degrees < WELL_ABOVE or degrees > NEARLY_FULL


def centre_error(chord: float, radius: float, rounding: float) -> float:
    """How far the centre can be from where it was meant when the end's coordinates and R are rounded; lengths alike.

    A bound: the end moves by ``rounding`` in either coordinate, R by as much. The centre is at the height
    sqrt(R^2 - (chord / 2)^2) above the middle of the chord, whose direction turns with its end.
    """
    size = abs(radius)
    moved = rounding * math.sqrt(2.0)
    height = _height(size, chord)
    highest = _height(size + rounding, max(0.0, chord - moved))
    lowest = _height(max(0.0, size - rounding), chord + moved)
    turned = 2.0 * size if moved >= chord else highest * moved / (chord - moved)
    return moved / 2.0 + max(highest - height, height - lowest) + turned


def _height(size: float, chord: float) -> float:
    return math.sqrt(max(0.0, size * size - chord * chord / 4.0))


def radius_arc_warning(span: Span, chord: float, radius: float, inches: bool) -> Finding | None:
    """GP406 for an arc by its radius that rounding moves; None for one that is well determined. Lengths in mm."""
    degrees = sweep_of(chord, radius)
    if not badly_determined(degrees):
        return None
    rounding = ROUNDING_INCH if inches else ROUNDING
    error = centre_error(chord, radius, rounding)
    return codes.ARC_ILL_CONDITIONED.at(
        span, degrees=degrees, off=error, factor=error / rounding, digits="4" if inches else "3", unit="mm", hint=HINT
    )
