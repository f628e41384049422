"""How operators of Eding CNC group: what its manual states, and what it leaves open.

The frontend builds trees by these tables and the printer sets brackets by them.
Source: sections 3.2.2.3 (groups of operators) and 4.2 (further operators, only listed).
"""

from __future__ import annotations

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
"""Stands for a sign before something that is no number, where an operator is asked for."""

_UNSTATED = frozenset("band bor bxor << >> > >= < <= == <>".split())
"""Operators that section 4.2 lists and to which no section gives a precedence."""
_ASSOCIATIVE = frozenset(("band", "bor", "bxor"))


def is_doubtful(operator: str, inner: str) -> bool:
    """Whether the manual leaves open how ``operator`` and an unbracketed neighbour group.

    inner: the neighbour's outermost operator, ``SIGN``, or "" when it has none or stands in brackets.
    """
    if not inner or (operator == inner and inner in _ASSOCIATIVE):
        return False
    if inner == SIGN:
        return operator in ("**", "mod")  # the sign of a number is stated (3.2.2.1), that of other values not
    return operator in _UNSTATED or inner in _UNSTATED
