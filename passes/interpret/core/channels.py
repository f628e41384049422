"""Channels and registers by number, whose values are known or not: (number, value) in the order of the numbers."""

from __future__ import annotations

from gproof.ir.symbolic import Value

Pairs = tuple[tuple[int, Value], ...]


def with_pair(pairs: Pairs, number: int, value: Value) -> Pairs:
    """One channel changed."""
    return tuple(sorted((*((n, v) for n, v in pairs if n != number), (number, value)), key=lambda pair: pair[0]))


def value_of(pairs: Pairs, number: int) -> Value | None:
    """The state of a channel; None where it is not known."""
    return next((value for n, value in pairs if n == number), None)
