"""The modes that raising follows, and the words of a line."""

from __future__ import annotations

from dataclasses import fields, replace
from typing import Any

from gproof.ir.finding import Span
from gproof.ir.program import Expr, Number
from gproof.ir.record import record

UNKNOWN_MODE = "?"
"""In place of a mode's value: it depends on the way that the program took."""


@record(frozen=True, slots=True, kw_only=True)
class Modes:
    """What the meaning of words depends on; each may be UNKNOWN_MODE.

    motion: tenths of the code that a line without one goes on with, -1 for none; unit: of LENGTHS; per: of feeds;
    back: where cycles go to (``DrillHole.back``); sticky: words that stay for the next line (letter, value);
    once: what a dialect needs besides, as sorted pairs.
    """

    motion: int | str = -1
    unit: str = "mm"
    relative: bool | str = False
    plane: str = "xy"
    per: str = "minute"
    back: str = "before"
    sticky: tuple[tuple[str, Expr], ...] | str = ()
    more: tuple[tuple[str, object], ...] | str = ()

    def joined(self, other: Modes | None) -> Modes:
        """What is known on both ways; None: a way that nobody takes."""
        if other is None or other == self:
            return self
        lost: dict[str, Any] = {
            f.name: UNKNOWN_MODE for f in fields(self) if getattr(self, f.name) != getattr(other, f.name)
        }
        if "more" in lost and UNKNOWN_MODE not in (self.more, other.more):
            one, two = dict(self.more), dict(other.more)  # type: ignore[arg-type]
            lost["more"] = tuple(
                (name, one[name] if name in one and name in two and one[name] == two[name] else UNKNOWN_MODE)
                for name in sorted(one.keys() | two.keys())
            )
        return replace(self, **lost)

    def own(self, name: str, usual: object = None) -> object:
        """A mode of the dialect's own."""
        if self.more == UNKNOWN_MODE:
            return UNKNOWN_MODE
        assert not isinstance(self.more, str)
        return dict(self.more).get(name, usual)

    def with_own(self, name: str, value: object) -> Modes:
        """The same with a mode of the dialect's own."""
        known = {} if isinstance(self.more, str) else dict(self.more)
        return replace(self, more=tuple(sorted((known | {name: value}).items(), key=lambda pair: pair[0])))


@record(frozen=True, slots=True)
class LineWord:
    """A word of a line: letter, value, place, and whether it has no number."""

    letter: str
    value: Expr
    span: Span
    bare: bool = False

    @property
    def number(self) -> float | None:
        """Its literal value."""
        return self.value.value if isinstance(self.value, Number) else None
