"""Verdicts: three-valued answers, each with the assumptions it holds under."""

from __future__ import annotations

import enum
from collections.abc import Iterable

from gproof.ir.record import record


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

    assumptions: sentences the answer stands on; conditions: bounds on unknown offsets, enforced later; needed: bounds
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

    terms: ((symbol, coefficient), ...) such as (("work.1.x", 1),); sorted by symbol.
    """

    terms: tuple[tuple[str, int], ...]
    low: float
    high: float

    @property
    def empty(self) -> bool:
        """True when no value satisfies it."""
        return not self.low <= self.high


DEFAULT_POLICY = ("language", "limits", "areas", "arcs")
"""The properties that a job must satisfy to be SAFE, unless the user says otherwise."""
