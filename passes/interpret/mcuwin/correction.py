"""What is known of a radius correction that is on (McuWIN 2.7, 3.4)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gproof.ir.record import record
from gproof.ir.symbolic import Position
from gproof.passes.interpret.mcuwin.contour import Element

if TYPE_CHECKING:
    pass


Corner = tuple[tuple[float, float], tuple[float, float]]
"""Least and most of both axes of the plane, mm from a point of the contour."""


@record(frozen=True, slots=True, kw_only=True)
class Correction:
    """The correction that is on, or of which places are left after G40.

    side: 1 left, -1 right; radius: mm; name: of record, side and radius, ``2xy+1,5``, in symbols; last: the element of
    the contour that ends where the tool is now, None: at the start; at: where that is. own: what the symbols of the
    last line's places have after ``name``, "" for those of all; ``begin``: where the tool may be around the corner at
    the start of that line; forks: outcomes followed when the line came.
    """

    side: int
    radius: float
    name: str
    last: Element | None = None
    at: tuple[Position, Position] | None = None
    own: str = ""
    begin: Corner | None = None
    forks: int = 0
