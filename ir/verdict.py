"""Verdicts: three-valued answers, each with the assumptions it holds under."""

from __future__ import annotations

import enum
from collections.abc import Iterable
from typing import TYPE_CHECKING

from gproof.ir.record import field, record

if TYPE_CHECKING:
    from gproof.ir.finding import Span


class Verdict(enum.Enum):
    """SAFE: proved under the printed assumptions. UNSAFE: refuted. UNKNOWN: neither."""

    SAFE = "SAFE"
    UNSAFE = "UNSAFE"
    UNKNOWN = "UNKNOWN"

    @property
    def exit_code(self) -> int:
        """0 SAFE, 1 UNSAFE, 2 UNKNOWN (3 is for commands that could not run)."""
        return {"SAFE": 0, "UNSAFE": 1, "UNKNOWN": 2}[self.value]


def worst(verdicts: Iterable[Verdict]) -> Verdict:
    """UNSAFE over UNKNOWN over SAFE; nothing judged is UNKNOWN."""
    seen = set(verdicts)
    if Verdict.UNSAFE in seen:
        return Verdict.UNSAFE
    if Verdict.UNKNOWN in seen or not seen:
        return Verdict.UNKNOWN
    return Verdict.SAFE


@record(frozen=True, slots=True, kw_only=True)
class PropertyResult:
    """The answer for one property.

    assumptions: sentences the answer depends on; conditions: bounds on unknown offsets, enforced later; needed: bounds
    outside of which the property is refuted for certain, wider than the conditions or the same.
    """

    name: str
    verdict: Verdict
    assumptions: tuple[str, ...] = ()
    conditions: tuple[Condition, ...] = ()
    needed: tuple[Condition, ...] = ()


@record(frozen=True, slots=True, kw_only=True)
class Condition:
    """low <= sum(coefficient * symbol) <= high, in mm or degrees, over unknown offsets.

    terms: ((symbol, coefficient), ...) such as (("work.1.x", 1),); sorted by symbol; places: the moves that require
    ``low`` and for ``high``, None where none is known; no part of what it states.
    """

    terms: tuple[tuple[str, int], ...]
    low: float
    high: float
    places: tuple[Span | None, Span | None] = field(default=(None, None), compare=False, repr=False)

    @property
    def empty(self) -> bool:
        """True when no value satisfies it."""
        return not self.low <= self.high

    def within(self, other: Condition) -> Condition:
        """Both at once, of the same terms; where they require the same, the place of the other one."""
        below, above = self.low > other.low, self.high < other.high
        return Condition(
            terms=self.terms, low=self.low if below else other.low, high=self.high if above else other.high,
            places=((self if below else other).places[0], (self if above else other).places[1]),
        )  # fmt: skip


DEFAULT_POLICY = ("language", "limits", "areas", "arcs")
"""The properties that a job must satisfy to be SAFE, unless the user says otherwise."""
