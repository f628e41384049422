"""Places as a number and unknowns, and the zeros of a controller of the RS274 family."""

from __future__ import annotations

from collections.abc import Mapping

from gproof.ir.drives import AXES, AXIS_NAMES
from gproof.ir.record import field, record
from gproof.ir.trace import Affine


@record(frozen=True, slots=True)
class Place:
    """mm or degrees and a sum of unknowns."""

    value: float = 0.0
    form: Affine = ()

    def plus(self, other: Place, times: int = 1) -> Place:
        """The sum; times -1: the difference."""
        total = dict(self.form)
        for symbol, count in other.form:
            total[symbol] = total.get(symbol, 0) + times * count
        form = tuple(sorted((symbol, count) for symbol, count in total.items() if count))
        return Place(self.value + times * other.value, form)


def unknown(symbol: str) -> Place:
    """A place that is one unknown."""
    return Place(0.0, ((symbol, 1),))


@record(slots=True)
class Zeros:
    """Zero of work coordinates = work offset in force + axis offset (G92) + tool length.

    work: number of the work offset in force; table: offsets that the program has set, by (number, column); local: axis
    offsets in force, none at the start; stored: those that G92.3 brings back, None: not known; length: of the tool,
    along Z; lengths: mm of tools that the machine file has.
    """

    work: int
    lengths: Mapping[int, float]
    table: dict[tuple[int, int], Place] = field(default_factory=dict)
    local: list[Place] = field(default_factory=lambda: [Place()] * AXES)
    stored: list[Place] | None = None
    length: Place = field(default_factory=lambda: unknown("tool.0.z"))

    def offset(self, number: int, axis: int) -> Place:
        """A work offset of an axis."""
        return self.table.get((number, axis), unknown(f"work.{number}.{AXIS_NAMES[axis]}"))

    def zero(self, axis: int) -> Place:
        """The machine place of work coordinate 0."""
        found = self.offset(self.work, axis).plus(self.local[axis])
        return found.plus(self.length) if axis == 2 else found

    def set_offset(self, number: int, axis: int, place: Place) -> None:
        """G10 L2."""
        self.table[number, axis] = place

    def call_here(self, number: int, axis: int, here: Place, value: float) -> None:
        """G10 L20: the present place is called ``value`` in a work offset."""
        tool = self.length if axis == 2 else Place()
        self.table[number, axis] = here.plus(tool, -1).plus(self.local[axis], -1).plus(Place(value), -1)

    def name_here(self, axis: int, here: Place, value: float) -> None:
        """G92: the present place is called ``value``."""
        tool = self.length if axis == 2 else Place()
        self.local[axis] = here.plus(tool, -1).plus(self.offset(self.work, axis), -1).plus(Place(value), -1)

    def keep_local(self) -> None:
        """After G92: what G92.3 would bring back."""
        self.stored = list(self.local)

    def local_off(self, *, forget: bool) -> None:
        """G92.1, G92.2."""
        self.local = [Place()] * AXES
        if forget:
            self.stored = list(self.local)

    def tool_length(self, number: int) -> Place:
        """The length of a tool: of the machine file, else an unknown."""
        if number == 0:
            return Place()
        if number in self.lengths:
            return Place(self.lengths[number])
        return unknown(f"tool.{number}.z")
