"""Assumptions of the stream in the words of earlier versions, as packages hold them: the same ones in today's words."""

from __future__ import annotations

import re

EARLIER = tuple((re.compile(then), now) for then, now in (
    (r"(\w+) stands at the start as when it came from below, with a backlash of (\S+)",
     r"\1 reached its start position from below (backlash \2)"),
    (r"axis (\w+) needs no limit where the machine file states none",
     r"axis \1 needs no limit: the machine file gives none"),
    (r"the machine file states no greatest step frequency", r"the machine file gives no maximum step frequency"),
    (r"no board carries out (.+): who runs the stream sees to it",
     r"no board executes \1: whoever runs the stream has to do it"),
    (r"(\w+) leaves the machine where the trace goes on", r"\1 leaves the machine where the trace continues"),
))  # fmt: skip
"""A sentence as it was, and as it is. A sentence of ``assumed`` that changes gets a row: tests hold older packages."""


def in_todays_words(said: str) -> str:
    """What says the same as an assumption of an earlier version; others stay."""
    for then, now in EARLIER:
        found = then.fullmatch(said)
        if found:
            return found.expand(now)
    return said
