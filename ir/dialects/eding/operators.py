"""How operators of Eding CNC group: what its manual states, and what it leaves open.

The frontend builds trees by these tables and the printer sets brackets by them.
Source: sections 3.2.2.3 (groups of operators) and 4.2 (further operators, only listed).
"""

from __future__ import annotations

import functools
import itertools

LEVELS = (
    "> >= < <= == <>",  # only listed in 4.2: weaker than all that 3.2.2.3 groups
    "<< >>",  # only listed in 4.2
    "+ - and or xor band bor bxor",  # third group of 3.2.2.3, and the bit operations of 4.2
    "* / mod",  # second group
    "**",  # first group
)
"""Binary operators, weakest first; within a level the one on the left is performed first (3.2.2.3)."""

LEVEL = {operator: number for number, level in enumerate(LEVELS) for operator in level.split()}
"""Operator -> its level; the higher one is performed first."""

SIGN = "sign"
"""Stands for a sign before something that is no number, where an operator is required."""

_UNSTATED = frozenset("band bor bxor << >> > >= < <= == <>".split())
"""Operators that section 4.2 lists and to which no section gives a precedence."""
_ASSOCIATIVE = frozenset(("band", "bor", "bxor"))


def is_doubtful(operator: str, inner: str) -> bool:
    """Whether the manual leaves open how ``operator`` and an unbracketed neighbour group.

    inner: the neighbour's outermost operator, ``SIGN``, or "" when it has none or is in brackets.
    """
    if not inner or (operator == inner and inner in _ASSOCIATIVE):
        return False
    if inner == SIGN:
        return operator in ("**", "mod")  # the sign of a number is stated (3.2.2.1), that of other values not
    return operator in _UNSTATED or inner in _UNSTATED


# ---- the groupings that the manual leaves open

_USUAL = "and or xor, band bor bxor, > >= < <= == <>, << >>, + -, * / mod, **"
"""Weakest first, as most languages of the kind have it; the first of ``groupings``, which a shop can accept."""
_STATED = {op: float(level) for level, ops in ((2, "+ - and or xor"), (4, "* / mod"), (6, "**")) for op in ops.split()}
_CLASSES = ("== <>", "> >= < <=", "<< >>", "band", "bxor", "bor")
_MERGED = ("== <> > >= < <=", "<< >>", "band bxor bor")
"""Operators that are surely of one level; where three or more occur, those of one kind are."""
_SIGN_LEVELS = (8.0, 5.0, 3.0)
"""A sign binds tightest, or weaker than ``**``, or than products too."""

Tree = int | tuple["int | str", "Tree", "Tree"]
"""A value by its place, ``~place`` for it without its sign; (operator by its place, left, right); (SIGN, place, what
the sign before it belongs to)."""

MOST_OPERATORS = 12


@functools.lru_cache(maxsize=1024)
def groupings(operators: tuple[str, ...], signs: tuple[bool, ...]) -> tuple[Tree, ...]:
    """Every way to group values with these operators that 3.2.2.3 allows, the usual one first; none: too many.

    operators: between the values, in order; signs: whether a value has a sign before it that is no number's.
    """
    classes = _classes_of(operators, _CLASSES)
    if len(classes) > 2:
        classes = _classes_of(operators, _MERGED)
    if len(classes) > 2 or len(operators) > MOST_OPERATORS:
        return ()
    slots = [level + 0.5 * k for level in (1, 3, 5, 7) for k in range(max(1, len(classes)))] + [2.0, 4.0, 6.0]
    usual = {op: float(level) for level, ops in enumerate(_USUAL.split(",")) for op in ops.split()}
    found: dict[Tree, None] = {_Grouping(operators, signs, usual, _SIGN_LEVELS[0]).tree(): None}
    sign_levels = _SIGN_LEVELS if any(signs) and not {"**", "mod"}.isdisjoint(operators) else _SIGN_LEVELS[:1]
    for places in itertools.product(slots, repeat=len(classes)):
        levels = dict(_STATED)
        for names, place in zip(classes, places, strict=True):
            levels |= dict.fromkeys(names.split(), place)
        for sign_level in sign_levels:
            found[_Grouping(operators, signs, levels, sign_level).tree()] = None
    return tuple(found)


def _classes_of(operators: tuple[str, ...], classes: tuple[str, ...]) -> list[str]:
    return [names for names in classes if not set(names.split()).isdisjoint(operators)]


class _Grouping:
    """One reading of a chain: operators of higher levels first, within a level from left to right."""

    def __init__(
        self, operators: tuple[str, ...], signs: tuple[bool, ...], levels: dict[str, float], sign_level: float
    ) -> None:
        self.operators = operators
        self.signs = signs
        self.levels = [levels[operator] for operator in operators]
        self.sign_level = sign_level
        self.at = 0

    def tree(self) -> Tree:
        """The whole chain."""
        return self._from(-1.0)

    def _from(self, least: float) -> Tree:
        """What starts with the next value and has operators of at least this level."""
        place = self.at
        left: Tree = place
        if self.signs[place]:
            inner = self._go_on(~place, self.sign_level + 0.1)
            left = place if inner == ~place else (SIGN, place, inner)
        return self._go_on(left, least)

    def _go_on(self, left: Tree, least: float) -> Tree:
        while self.at < len(self.operators) and self.levels[self.at] >= least:
            operator = self.at
            self.at += 1
            left = (operator, left, self._from(self.levels[operator] + 0.1))
        return left
