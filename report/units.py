"""Lengths of text reports in the shop's unit; JSON reports and artefacts stay in millimetres.

A report speaks the unit of the machine file; without one, that of the job's first change of the unit; ``--units`` says
otherwise. Angles stay degrees. Texts name each length with its unit after it, so that the unit can be changed.
"""

from __future__ import annotations

import re
from decimal import ROUND_CEILING, ROUND_FLOOR, Decimal

from gproof.ir import codes
from gproof.ir.finding import Finding, filled, fixed
from gproof.ir.record import record

IN_MESSAGES = frozenset((
    "reached", "over", "limit", "extent", "room", "wanted", "value", "start", "end", "off", "allowed", "chord",
    "radius", "x", "y", "z", "depth", "under", "clear", "distance", "least", "arc", "needed", "below", "feed", "jump",
    "velocity", "pitch",
))  # fmt: skip
"""Names of numbers that are lengths, or lengths a minute, in messages that speak of mm."""
NO_LENGTHS = {codes.STEP_FREQUENCY.number: frozenset(("needed", "allowed"))}
"""Those that are not, by code: steps a second."""

_NUMBER = r"-?\d+(?:\.\d+)?"
_LENGTHS = re.compile(
    rf"(?<![\w.#$-])((?:[XYZ]{_NUMBER},? )*[XYZ]?{_NUMBER}"
    r"|-?\d+\.\d{3,4} (?:and|to|\.\.\.) -?\d+\.\d{3,4}) mm(?![\w])"
)
"""Lengths in texts: ``1.5 mm``, ``40 mm/min``, ``X1.0 Y2.0 mm``, ``1.0000 and 2.0000 mm``, ``1.000 ... 2.000 mm``."""
_PLACE = re.compile(rf"(?<!\w)([XYZ])({_NUMBER})(?![\w.])")
"""A place in texts called ``where``."""
_LITERAL = re.compile(r"(?<=\}) mm\b")
"""The unit after a number of a template."""
_FINE = re.compile(r"\.3f\}")
"""How a template prints a length."""


@record(frozen=True, slots=True)
class LengthUnit:
    """name: as printed; mm: exact, in one of it; places: decimals of positions; rough: of lengths of paths."""

    name: str
    mm: Decimal
    places: int
    rough: int

    def of(self, millimetres: float, axis_unit: str = "mm") -> float:
        """A number of an axis whose unit is ``axis_unit`` (mm or deg), in this unit or degrees."""
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
        """A bound, rounded to the side on which it still holds; after nine decimals there is noise of arithmetic."""
        exact = round(Decimal(repr(millimetres)), 9) / (self.mm if axis_unit == "mm" else 1)
        return str(exact.quantize(Decimal("0.0001"), ROUND_CEILING if up else ROUND_FLOOR))

    def sentence(self, text: str) -> str:
        """A text, the lengths that it names in this unit."""
        if self.mm == 1:
            return text
        return _LENGTHS.sub(lambda found: f"{re.sub(_NUMBER, self._number, found[1])} {self.name}", text)

    def _number(self, found: re.Match[str]) -> str:
        """A number of mm within a text, with four decimals, or more where these would leave nothing of it."""
        written = found[0]
        text = fixed(self.of(float(written)), 4)
        return text if len(written.partition(".")[2]) >= 3 else text.rstrip("0").rstrip(".")

    def message(self, finding: Finding) -> str:
        """The message of a finding, its lengths in this unit."""
        values, template = dict(finding.values), finding.code.template
        if self.mm == 1:
            return finding.message
        if not values:
            return self.sentence(finding.message)
        speaks = "{unit}" in template or " mm" in template or "X{x:" in template
        in_mm = speaks and values.get("unit", "mm") == "mm"
        names = IN_MESSAGES - NO_LENGTHS.get(finding.code.number, frozenset()) if in_mm else frozenset[str]()
        told = {name: self._value(name, value, names) for name, value in values.items()}
        if in_mm:
            told["unit"] = self.name
            template = _FINE.sub(f".{self.places}f}}", _LITERAL.sub(f" {self.name}", template))
        return filled(template, told, self.places)

    def _value(self, name: str, value: object, lengths: frozenset[str]) -> object:
        """A value of a message in this unit."""
        if isinstance(value, str):
            text = self.sentence(value)
            return _PLACE.sub(lambda at: f"{at[1]}{self.of(float(at[2])):.4f}", text) if name == "where" else text
        return self.of(value) if name in lengths and isinstance(value, float) else value


MM = LengthUnit("mm", Decimal(1), 3, 1)
INCH = LengthUnit("inch", Decimal("25.4"), 4, 2)
CHOICES = {"mm": MM, "inch": INCH}


def unit_of(mm: float) -> LengthUnit:
    """The unit for a controller whose numbers count so many millimetres; mm but for inches."""
    return INCH if mm == float(INCH.mm) else MM
