"""What is asked of plain lines before and after the kernel of straight-line code runs them."""

from __future__ import annotations

import math
from typing import Any

from gproof.ir.kernel import kernel

G, I_WORD, J_WORD = 71, 73, 74
"""Letters."""
TRAVERSE, ARC = 1, 3
"""Ops of ir/trace.py; din_plain.py asserts it."""


@kernel(seconds_per_unit=2e-7, compile_seconds=0.5)
def cold_lines(
    line: Any, letter: Any, value: Any, count: int, hot: Any, pairs: int, out_line: Any, out_word: Any
) -> int:  # fmt: skip
    """Lines that the kernel of straight-line code certainly hands back: their numbers and their first words.

    line, letter, value: WORD columns of ``count`` words; hot: (256,) 1 for letters that the kernel takes, G only with
    0 to 3; pairs: 1 when I and J mean something else one without the other. Returns how many lines.
    """
    found = 0
    word = 0
    while word < count:
        here = line[word]
        first = word
        cold = False
        centers = 0
        while word < count and line[word] == here:
            code = letter[word]
            if hot[code] == 0:
                cold = True
            elif code == G:
                number = value[word]
                if not (0.0 <= number <= 3.0 and number == math.floor(number)):
                    cold = True
            elif code == I_WORD:
                centers |= 1
            elif code == J_WORD:
                centers |= 2
            word += 1
        if cold or (pairs == 1 and centers in (1, 2)):
            out_line[found] = here
            out_word[found] = first
            found += 1
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
