"""Which constructs of a job the target has as they are: the part of the report that names what was not rewritten."""

from __future__ import annotations

from collections import Counter

from gproof.ir.job import Moves, Node
from gproof.ir.job_features import features, row_features

NOT_NAMED = frozenset((
    "unit_mm", "unit_inch", "unit_cm", "relative", "feed_alone", "comment", "expression", "variable", "operator",
    "end", "end_rests", "end_reset",
))  # fmt: skip
"""Features of how something is written, which nobody looks for in a report."""


def count_kept(node: Node, kept: Counter[str]) -> None:
    """Add the features of an operation that stays as it is; each row of a table of moves counts."""
    rows = row_features(node) if isinstance(node, Moves) else {}
    for name, which in rows.items():
        if which.any():
            kept[name] += int(which.sum())
    for name in features(node) - rows.keys() - NOT_NAMED:
        kept[name] += 1
