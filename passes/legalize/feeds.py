"""The feed in force at a place of a job, as far as it is known."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from gproof.ir.job import RAPID, ArcTo, DrillHole, Feed, Moves, MoveTo, Node
from gproof.passes.legalize.constants import constant

FeedInForce = tuple[float, str, str]
"""Number, unit, and per what it is."""
NO_FEED: FeedInForce = (math.nan, "mm", "minute")
"""None was given yet."""


def gives_feed(node: Node) -> bool:
    """Whether an operation gives a feed, which counts after it."""
    if isinstance(node, Moves):
        return not np.isnan(node.rows["feed"]).all()
    return getattr(node, "feed", None) is not None


def goes_on(node: Node) -> bool:
    """Whether an operation moves with the feed that was in force before it."""
    if isinstance(node, Moves):
        with_feed = np.flatnonzero(node.rows["kind"] != RAPID)
        return bool(len(with_feed)) and bool(np.isnan(node.rows["feed"][: with_feed[0] + 1]).all())
    is_cut = isinstance(node, ArcTo | DrillHole) or (isinstance(node, MoveTo) and node.kind != "rapid")
    return is_cut and not gives_feed(node)


def feed_after(node: Node, before: FeedInForce | None, values: Mapping[int, float]) -> FeedInForce | None:
    """The feed after an operation; None where it is not known. values: of variables that are known."""
    if not gives_feed(node):
        return before
    if isinstance(node, Moves):
        given = node.rows["feed"][~np.isnan(node.rows["feed"])]
        return float(given[-1]), node.unit, node.per
    feed = getattr(node, "feed", None)
    assert isinstance(feed, Feed)
    value = constant(feed.amount.value, values)
    return None if value is None else (value, feed.amount.unit, feed.per)
