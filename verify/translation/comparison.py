"""What a comparison of two Traces gives: codes and numbers; ``words.py`` makes sentences of them."""

from __future__ import annotations

from gproof.ir.record import field, record
from gproof.ir.verdict import Verdict

Place = tuple[str, int]
"""File and line."""
Places = tuple[Place | None, Place | None]
"""Those of source and target."""

MOST_KEPT = 20
"""Differences, and likewise open points, that are kept."""


@record(frozen=True, slots=True, kw_only=True)
class Divergence:
    """Where two programs part, or where nobody can say whether they do.

    kind: a key of ``words.DIFFERENT`` or ``words.OPEN``; numbers, names: what the sentence has, first of the source,
    then of the target; source, target: places in both programs, None where one has no such line.
    """

    kind: str
    source: Place | None = None
    target: Place | None = None
    numbers: tuple[float, ...] = ()
    names: tuple[str, ...] = ()


def divergence(
    kind: str, places: Places, *, names: tuple[str, ...] = (), numbers: tuple[float, ...] = ()
) -> Divergence:  # fmt: skip
    """A divergence at places of both sides."""
    return Divergence(kind=kind, source=places[0], target=places[1], names=names, numbers=numbers)


@record(slots=True, kw_only=True)
class Comparison:
    """The answer. SAFE: the same in every respect of docs/translation-proof.md, under ``assumptions``; UNSAFE:
    ``differences``; UNKNOWN: ``unknown`` and no difference.

    rows: motion rows of source and target; sections: pairs of sections; drift: the largest distance of places that
    belong together, mm and degrees.
    """

    verdict: Verdict = Verdict.UNKNOWN
    differences: list[Divergence] = field(default_factory=list)
    unknown: list[Divergence] = field(default_factory=list)
    assumptions: list[str] = field(default_factory=list)
    rows: tuple[int, int] = (0, 0)
    sections: int = 0
    drift: tuple[float, float] = (0.0, 0.0)

    def differs(self, found: Divergence) -> None:
        """Keep a difference."""
        if len(self.differences) < MOST_KEPT and found not in self.differences:
            self.differences.append(found)

    def open(self, found: Divergence) -> None:
        """Keep what could not be decided."""
        if len(self.unknown) < MOST_KEPT and found not in self.unknown:
            self.unknown.append(found)

    def assume(self, sentence: str) -> None:
        """Keep what the answer rests on, once."""
        if sentence not in self.assumptions:
            self.assumptions.append(sentence)

    def concluded(self) -> Comparison:
        """The same with its verdict: a difference outweighs what is open."""
        self.verdict = Verdict.UNSAFE if self.differences else Verdict.UNKNOWN if self.unknown else Verdict.SAFE
        return self
