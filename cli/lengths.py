"""Lengths of text reports in the shop's unit; JSON reports and artefacts stay in millimetres.

A report speaks the unit of the machine file; without one, that of the job's first change of the unit; ``--units`` says
otherwise. Angles stay degrees, rates are not converted.
"""

from __future__ import annotations

import re
from decimal import ROUND_CEILING, ROUND_FLOOR, Decimal

from gproof.ir.finding import Finding
from gproof.ir.record import record

IN_MESSAGES = frozenset((
    "reached", "over", "limit", "extent", "room", "wanted", "value",
    "start", "end", "off", "allowed", "chord", "radius",
))  # fmt: skip
"""Names of values that are lengths in messages of the properties limits and arcs."""


_BETWEEN = re.compile(r"(-?\d+\.\d{4}) and (-?\d+\.\d{4}) mm\b")
"""How an assumption names two bounds."""


@record(frozen=True, slots=True)
class LengthUnit:
    """name: as printed; mm: exact, in one of it; places: decimals of positions; rough: of lengths of paths."""

    name: str
    mm: Decimal
    places: int
    rough: int

    def of(self, millimetres: float, axis_unit: str = "mm") -> float:
        """A number of an axis that counts in ``axis_unit`` (mm or deg), in this unit or degrees."""
        return millimetres if axis_unit != "mm" or self.mm == 1 else millimetres / float(self.mm)

    def named(self, axis_unit: str) -> str:
        """The name of the unit in which such an axis is printed."""
        return self.name if axis_unit == "mm" else axis_unit

    def place(self, millimetres: float, axis_unit: str = "mm") -> str:
        """A position, as ``12.700``."""
        places = self.places if axis_unit == "mm" else 3
        return f"{round(self.of(millimetres, axis_unit), places) + 0.0:.{places}f}"

    def path(self, millimetres: float) -> str:
        """The length of a path, with its unit."""
        return f"{self.of(millimetres):.{self.rough}f} {self.name}"

    def inward(self, millimetres: float, axis_unit: str, *, up: bool) -> str:
        """A bound, rounded to the side on which it still holds; behind nine decimals there is noise of arithmetic."""
        exact = round(Decimal(repr(millimetres)), 9) / (self.mm if axis_unit == "mm" else 1)
        return str(exact.quantize(Decimal("0.0001"), ROUND_CEILING if up else ROUND_FLOOR))

    def sentence(self, assumption: str) -> str:
        """An assumption, the bounds that it names in this unit."""
        if self.mm == 1:
            return assumption

        def bounds(found: re.Match[str]) -> str:
            low, high = (self.of(float(number)) for number in found.groups())
            return f"{low:.4f} and {high:.4f} {self.name}"

        return _BETWEEN.sub(bounds, assumption)

    def message(self, finding: Finding) -> str:
        """The message of a finding, its lengths in this unit where it names theirs."""
        values = dict(finding.values)
        if self.mm == 1 or values.get("unit") != "mm" or finding.code.decides not in ("limits", "arcs"):
            return finding.message
        lengths = {
            name: self.of(value) for name, value in values.items() if name in IN_MESSAGES and isinstance(value, float)
        }
        return finding.code.template.format(**(values | lengths | {"unit": self.name}))


MM = LengthUnit("mm", Decimal(1), 3, 1)
INCH = LengthUnit("inch", Decimal("25.4"), 4, 2)
CHOICES = {"mm": MM, "inch": INCH}


def unit_of(mm: float) -> LengthUnit:
    """The unit for a controller whose numbers count so many millimetres; mm but for inches."""
    return INCH if mm == float(INCH.mm) else MM
