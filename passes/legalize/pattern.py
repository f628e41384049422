"""What a pattern is: a rule that rewrites an operation which the target does not have."""

from __future__ import annotations

from collections.abc import Callable

from gproof.ir.job import Node
from gproof.ir.record import record
from gproof.passes.legalize.context import Context


@record(frozen=True, slots=True, kw_only=True)
class Pattern:
    """name: as reports have it, what becomes of what; removes: features. apply: (operation, feature, context) -> what
    stands for it, None where the pattern does not fit. unrolls: what it gives may have the same feature again."""

    name: str
    removes: tuple[str, ...]
    apply: Callable[[Node, str, Context], list[Node] | None]
    unrolls: bool = False
