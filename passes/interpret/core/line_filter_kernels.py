"""What is asked of plain lines before and after the kernel of straight-line code runs them."""

from __future__ import annotations

import math
from typing import Any

from gproof.ir.kernel import kernel
from gproof.passes.interpret.core.line_decoder_kernels import (
    DWELL_WORDS,
    HAS_DISTANCE,
    OTHER,
    I,
    J,
    WordColumns,
    read_line,
)

COLD = OTHER | HAS_DISTANCE | DWELL_WORDS
"""What no line holds that the kernel runs: of G codes it takes 0 to 3 alone."""
BOTH = 1 << I | 1 << J
TRAVERSE, ARC = 1, 3
"""Ops of ir/trace.py; din_plain.py asserts it."""


@kernel(seconds_per_unit=2e-7, compile_seconds=0.5)
def cold_lines(
    words: WordColumns, count: int, slots: Any, values: Any, pairs: int, out_line: Any, out_word: Any
) -> int:  # fmt: skip
    """Lines that the kernel of straight-line code certainly hands back: their numbers and their first words.

    words: ``count`` of them; slots: see ``read_line``, of the letters that the kernel takes; values: (SLOTS,) room;
    pairs: 1 when I and J mean something else one without the other. Returns how many lines.
    """
    line, letter, value, flags = words
    found = 0
    word = 0
    while word < count:
        end, seen, _, _, _, _ = read_line(line, letter, value, flags, count, word, slots, 0, 0, values)
        centers = seen & BOTH
        if seen & COLD or (pairs == 1 and centers != 0 and centers != BOTH):  # noqa: PLR1714
            out_line[found] = line[word]
            out_word[found] = word
            found += 1
        word = end
    return found


@kernel(seconds_per_unit=4e-6, compile_seconds=0.5)
def judge_moves(
    op: Any, to: Any, center: Any, begin: int, end: int, start: Any, shortest: float, traverse: float, allowed: float,
    still: Any, off: Any, radii: Any,
) -> tuple[int, int, int]:  # fmt: skip
    """Of the rows ``begin`` to ``end``: those that go nowhere, and arcs in X and Y whose end is not on their circle.

    start: (6,) before the first of them; shortest, traverse: less on every axis is no way, of feeds and of
    traverses; allowed: mm between an arc's radii at its two ends. still, off: row numbers counted from ``begin``, room
    for all; radii: (n, 2), of ``off``. Returns how many of each, and how many arcs there are.
    """
    stills = offs = arcs = 0
    p0, p1, p2, p3, p4, p5 = start[0], start[1], start[2], start[3], start[4], start[5]
    for row in range(begin, end):
        t0, t1, t2, t3, t4, t5 = to[row, 0], to[row, 1], to[row, 2], to[row, 3], to[row, 4], to[row, 5]
        if op[row] == ARC:
            arcs += 1
            u0, v0 = p0 - center[row, 0], p1 - center[row, 1]
            u1, v1 = t0 - center[row, 0], t1 - center[row, 1]
            first, last = math.sqrt(u0 * u0 + v0 * v0), math.sqrt(u1 * u1 + v1 * v1)
            if abs(last - first) > allowed:
                off[offs] = row - begin
                radii[offs, 0] = first
                radii[offs, 1] = last
                offs += 1
        else:
            least = traverse if op[row] == TRAVERSE else shortest
            if (
                abs(t0 - p0) < least
                and abs(t1 - p1) < least
                and abs(t2 - p2) < least
                and abs(t3 - p3) < least
                and abs(t4 - p4) < least
                and abs(t5 - p5) < least
            ):
                still[stills] = row - begin
                stills += 1
        p0, p1, p2, p3, p4, p5 = t0, t1, t2, t3, t4, t5
    return stills, offs, arcs
