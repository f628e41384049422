"""What the work zero of one controller is on the other, for a translation that holds wherever it is.

RS274 controllers and WinCNC add a local offset (G92) to the work offset; McuWIN has one zero, which G92 replaces
(manual of V 2.5.3.133, 3.26). The same place of the material is set up on both: the one zero is the sum of the others.
"""

from __future__ import annotations

from collections.abc import Iterable

from gproof.ir.machine import AXIS_NAMES
from gproof.ir.record import record
from gproof.ir.translation_terms import SymbolMeaning

ONE_ZERO = "mcuwin"
"""The controller that has no offset besides the work offset in force."""
OFFSETS = range(1, 6)
"""Its records: G54 to G58 (3.19)."""
NO_LOCAL = "no local offset (G92) of an earlier job is in force when the job starts"


@record(frozen=True, slots=True)
class Zeros:
    """source, target: what unknowns of each side are; assumed: what that rests on."""

    source: tuple[SymbolMeaning, ...] = ()
    target: tuple[SymbolMeaning, ...] = ()
    assumed: tuple[str, ...] = ()


def zeros(source: str, target: str, lowered: Iterable[str]) -> Zeros:
    """For two controllers by name; lowered: features of the source that were rewritten.

    A job that moves or ends the local offset itself has another zero after that: then none may be there before it.
    """
    if (source == ONE_ZERO) == (target == ONE_ZERO):
        return Zeros()
    if any(feature.startswith("frame_local_") for feature in lowered):
        gone = tuple(SymbolMeaning(symbol=f"g92.{axis}") for axis in AXIS_NAMES)
        return Zeros(source=gone, assumed=(NO_LOCAL,))
    sums = tuple(
        SymbolMeaning(symbol=f"work.{n}.{axis}", form=((f"g92.{axis}", 1), (f"work.{n}.{axis}", 1)))
        for n in OFFSETS for axis in AXIS_NAMES
    )  # fmt: skip
    return Zeros(target=sums) if target == ONE_ZERO else Zeros(source=sums)
