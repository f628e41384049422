"""What legalising is given, what it says of itself, and a work zero as it knows it."""

from __future__ import annotations

from collections.abc import Mapping

from gproof.ir.finding import Span
from gproof.ir.record import field, record


@record(frozen=True, slots=True, kw_only=True)
class Options:
    """chord_tolerance: mm that chords may be off an arc. coolant, tool_change: see ``TranslationMap``; block_delete,
    optional_stop: whether the switch is on, None: not known; values: variables whose values are stated; axes: names of
    those that both machines have: the job may leave a zero on one that it does not move; lengths: mm of tools of the
    target, for one that has no tool lengths; measured_tools: a tool's length counts from its change on;
    zeros_end_contours: motion with feed stops where the zero changes; straight_rapids: rapids of several axes must be
    straight, and are not on one side: ``source``, where nothing can be done, or ``target``; rapid_rates: by axis the
    mm/min that the target's axes can go at."""

    chord_tolerance: float = 0.01
    coolant: Mapping[str, str] = field(default_factory=dict)
    tool_change: str = ""
    block_delete: bool | None = None
    optional_stop: bool | None = None
    values: Mapping[int, float] = field(default_factory=dict)
    axes: frozenset[str] = frozenset()
    lengths: Mapping[int, float] = field(default_factory=dict)
    measured_tools: bool = False
    zeros_end_contours: bool = False
    straight_rapids: str = ""
    rapid_rates: Mapping[str, float] = field(default_factory=dict)


@record(frozen=True, slots=True)
class Lowered:
    """A pattern that was used. times: how often, from the line of ``span`` on."""

    pattern: str
    feature: str
    span: Span


@record(frozen=True, slots=True)
class Zero:
    """The work zero in force. offset: number of the work offset, 0: none of them, but ``places``: by axis (work offset,
    mm or degrees from it; 0: from machine zero), of axes where that is known."""

    offset: int = 0
    places: Mapping[str, tuple[int, float]] = field(default_factory=dict)

    def place(self, axis: str) -> tuple[int, float] | None:
        """Of one axis; None where it is not known."""
        return (self.offset, 0.0) if self.offset else self.places.get(axis)
