"""A plotter's language as a target of translation: rapids and straight moves in millimetres, comments and an end.

A table and a printer are all that it needs; passes/legalize/ brings jobs down to it.
"""

from __future__ import annotations

import numpy as np

from gproof.ir.job import RAPID, EndJob, Job, Moves, MoveTo, Node, Remark
from gproof.ir.machine import AXIS_NAMES, Machine
from gproof.ir.target import Style, Target

TARGET = Target(
    name="toy",
    title="the toy plotter",
    legal=dict.fromkeys(("rapid", "straight", "unit_mm", "feed_alone", "comment", "end", "end_reset"), "its only page"),
    style=Style(extension=".toy", decimals_mm=5),
    axes=("x", "y", "z"),
)


def write(job: Job, target: Target, machine: Machine, style: Style) -> dict[str, bytes]:
    """``rapid x1 y2``, ``cut z-1 f200``, ``# comment``, ``end``: a line each, all places absolute."""
    lines = [line for node in job.body for line in _lines(node, style.decimals_mm)]
    return {"": "".join(f"{line}{style.newline}" for line in lines).encode()}


def _lines(node: Node, decimals: int) -> list[str]:
    if isinstance(node, Remark):
        return [f"# {node.text}"]
    if isinstance(node, EndJob):
        return ["end"]
    if isinstance(node, MoveTo):
        to = {place.axis: place.at.number for place in node.to}
        return [_line(node.kind == "rapid", to, node.feed.amount.number if node.feed else None, decimals)]
    assert isinstance(node, Moves)
    found = []
    for row in range(len(node.rows)):
        bits, to, feed = (node.rows[name][row] for name in ("axes", "to", "feed"))
        named = {axis: float(to[n]) for n, axis in enumerate(AXIS_NAMES) if bits & (1 << n)}
        kind = node.rows["kind"][row] == RAPID
        found.append(_line(bool(kind), named, None if np.isnan(feed) else float(feed), decimals))
    return found


def _line(is_rapid: bool, to: dict[str, float | None], feed: float | None, decimals: int) -> str:
    words = [f"{axis}{value:.{decimals}f}" for axis, value in to.items()]
    return " ".join(["rapid" if is_rapid else "cut", *words, *([] if feed is None else [f"f{feed:.{decimals}f}"])])
