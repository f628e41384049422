"""Whether conditions on unknown offsets can hold together: Fourier-Motzkin elimination over exact fractions."""

from __future__ import annotations

import math
from collections.abc import Iterable
from fractions import Fraction

from gproof.ir.verdict import Condition

SLACK = Fraction(1, 10**8)
"""mm or degrees by which each end of a condition may be missed: rounding is no contradiction."""
MOST = 500
"""So many inequalities are compared; beyond that nothing is said."""

Inequality = tuple[tuple[tuple[str, Fraction], ...], Fraction]
"""Sum of coefficient * symbol, sorted by symbol, is at most the number."""


def contradiction(conditions: Iterable[Condition]) -> float:
    """0 where some values may satisfy all conditions, else by how much they miss each other at least."""
    left = {inequality for condition in conditions for inequality in _inequalities(condition)}
    for symbol in sorted({symbol for terms, _ in left for symbol, _ in terms}):
        missed = _missed(left)
        if missed:
            return missed
        ups = [one for one in left if _of(one, symbol) > 0]
        downs = [one for one in left if _of(one, symbol) < 0]
        rest = left.difference(ups, downs)
        if len(rest) + len(ups) * len(downs) > MOST:
            return 0.0
        left = rest.union(_without(symbol, up, down) for up in ups for down in downs)
    return _missed(left)


def _inequalities(condition: Condition) -> list[Inequality]:
    out: list[Inequality] = []
    terms = tuple((symbol, Fraction(count)) for symbol, count in condition.terms)
    if condition.high < math.inf:
        out.append((terms, Fraction(condition.high) + SLACK))
    if condition.low > -math.inf:
        out.append((tuple((symbol, -count) for symbol, count in terms), SLACK - Fraction(condition.low)))
    return out


def _of(inequality: Inequality, symbol: str) -> Fraction:
    return dict(inequality[0]).get(symbol, Fraction(0))


def _missed(inequalities: Iterable[Inequality]) -> float:
    """By how much one without symbols is broken."""
    return max((float(-bound) for terms, bound in inequalities if not terms and bound < 0), default=0.0)


def _without(symbol: str, up: Inequality, down: Inequality) -> Inequality:
    """The sum of two in which the symbol falls out."""
    one, other = -_of(down, symbol), _of(up, symbol)
    found: dict[str, Fraction] = {}
    for times, (terms, _) in ((one, up), (other, down)):
        for name, count in terms:
            found[name] = found.get(name, Fraction(0)) + times * count
    terms = tuple(sorted((name, count) for name, count in found.items() if count))
    return terms, one * up[1] + other * down[1]
