"""States as keys: equal where all that follows is the same; and copies of them, for the outcomes of a branch."""

from __future__ import annotations

import copy
import re
from typing import TypeVar

from gproof.ir.setup import Interval
from gproof.ir.symbolic import Position, Value
from gproof.ir.trace import (
    UNKNOWN,
    Affine,
)

_ARISING = re.compile(r"\b((?:probe|value|home)\.\d+\.[a-z])\b")
"""Unknowns that arise in a run (``Run.unknown_place``)."""
_CONSTANT = (
    "fixed",
    "texts",
    "rules",
    "setup",
    "machine",
    "axis_there",
    "linear",
    "ranges",
    "_tool_table",
    "zero_lengths",
)
_OTHER = frozenset((*_CONSTANT, "parameters"))
_OTHER_OR_PROBED = _OTHER | {"probed", "probed_work", "probe_hit"}
NO_NUMBERS = frozenset[int]()


K = TypeVar("K", bound="Keyed")


class StateKey:
    """A part of a key that is hashed once."""

    __slots__ = ("_hash", "parts")

    def __init__(self, parts: tuple[object, ...]) -> None:
        self.parts = parts
        self._hash = hash(parts)

    def __hash__(self) -> int:
        return self._hash

    def __eq__(self, other: object) -> bool:
        return isinstance(other, StateKey) and self._hash == other._hash and self.parts == other.parts


class Keyed:
    """What a state needs to be copied and compared. fixed, texts: parts of its keys, with what they were made of."""

    parameters: dict[int, Value]
    ranges: dict[str, Interval]
    fixed: dict[str, tuple[object, object]]
    texts: dict[str, tuple[object, list[str]]]

    def copy(self: K) -> K:
        """An independent copy; values are immutable, containers are copied one level deep."""
        other = copy.copy(self)
        for name, value in vars(self).items():
            if isinstance(value, dict | list | set) and name not in _CONSTANT:
                setattr(other, name, value.copy())
        return other

    def key(
        self, *, parameters: bool = True, probed: bool = True, position: bool = True,
        without: frozenset[int] = NO_NUMBERS,
    ) -> object:  # fmt: skip
        """Equal for equal states: all that can change in a run, in a fixed order; with or without (some of) the
        variables, what the last probing move has left, and where the axes are.

        Unknowns that arose in the run, each between the same ends, may have other names: what follows is the same.
        """
        left_out = _OTHER if probed else _OTHER_OR_PROBED
        left_out = left_out if position else left_out | {"position"}
        named = [(name, self._fixed(name, value)) for name, value in sorted(vars(self).items()) if name not in left_out]
        names: dict[str, str] = {}
        found = [self._renamed(name, value, names) for name, value in named]
        if parameters:
            for number in sorted(self.parameters):
                if number not in without:
                    found += (number, self.parameters[number])
        return StateKey(tuple(found))

    def _fixed(self, name: str, value: object) -> object:
        """A field as something that can be a part of a key: the same object for as long as it does not change."""
        if not isinstance(value, dict | list | set):
            return value
        known = self.fixed.get(name)
        if known is not None and known[0] == value:
            return known[1]
        made = _fixed(value)
        self.fixed[name] = value.copy(), made
        return made

    def spread(self, place: Position) -> tuple[Affine, float, float] | None:
        """Unknown offsets that a place rests on, and the range of what it is without them (mm or degrees) by the
        bounds of the unknowns that arose in the run; None where one of these has no bounds."""
        low = high = place.value
        rest = []
        for symbol, coefficient in place.form:
            ends = self.ranges.get(symbol)
            if ends is None:
                if _ARISING.fullmatch(symbol) or (symbol, coefficient) in UNKNOWN:
                    return None
                rest.append((symbol, coefficient))
                continue
            low += min(ends.low * coefficient, ends.high * coefficient)
            high += max(ends.low * coefficient, ends.high * coefficient)
        return tuple(rest), low, high

    def _renamed(self, name: str, value: object, names: dict[str, str]) -> object:
        """A field with the unknowns that arose in the run counted as they come; as it is where there are none."""
        known = self.texts.get(name)
        if known is None or known[0] is not value:
            # The order in a set is not always the same.
            text = repr(sorted(map(repr, value))) if isinstance(value, frozenset) else repr(value)
            known = self.texts[name] = value, _ARISING.split(text)
        parts = known[1]
        if len(parts) == 1:
            return value
        out = parts.copy()
        for n in range(1, len(parts), 2):
            kind, _, axis = parts[n].split(".")
            out[n] = names.setdefault(parts[n], f"{kind} {len(names)} {axis} {self.ranges.get(parts[n])!r}")
        return "".join(out)


def _fixed(value: object) -> object:
    """A container as something that can be a key."""
    if isinstance(value, dict):
        return frozenset(value.items())
    if isinstance(value, set):
        return frozenset(value)
    return tuple(value) if isinstance(value, list) else value
