"""The loop behind ``run_sums``: CRC-32 of executed runs, step by step through a table of runs.

Source: docs/boards.md, "The certification extension", *CRC* and *Merging*; CRC-32: ISO-HDLC, reflected 0xEDB88320.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from gproof.ir.kernel import kernel

Ints = npt.NDArray[np.int64]

WORD = 0xFFFFFFFF
BASE, RUN = 0x42, 0x52

HAS, FIRST, MADE, GROWS, LEVEL = 0, 1, 2, 3, 4
"""The open record: whether there is one, its first interval, its steps, its add, its direction pin."""


@kernel(seconds_per_unit=1e-7, compile_seconds=0.3)
def hashed(crc: int, number: int, size: int, table: Ints) -> int:
    """The register after ``size`` bytes of a number, the lowest first."""
    for k in range(size):
        crc = table[(crc ^ (number >> (8 * k))) & 0xFF] ^ (crc >> 8)
    return crc


@kernel(seconds_per_unit=1e-6, compile_seconds=0.3)
def closed(crc: int, record: Ints, table: Ints) -> int:
    """The register after the open record, if there is one."""
    if record[HAS] == 0:
        return crc
    crc = hashed(crc, RUN, 1, table)
    crc = hashed(crc, record[FIRST] & WORD, 4, table)
    crc = hashed(crc, record[MADE] & WORD, 4, table)
    crc = hashed(crc, record[GROWS] & 0xFFFF, 2, table)
    return hashed(crc, record[LEVEL], 1, table)


@kernel(seconds_per_unit=2e-5, compile_seconds=1.0)
def summed(
    interval: Ints, count: Ints, add: Ints, level: Ints, limit: int, rest: int, lead: int, crc: int, table: Ints,
    out: Ints,
) -> None:  # fmt: skip
    """Write steps made, register, register with the clock base of the next step (-1: none) to ``out``.

    limit: steps that are taken; level: of the direction pin, by run; rest: ticks of rest from which a step has a clock
    base of its own, ``lead`` ticks before it (0: never); crc: the register at the start.
    """
    record = np.zeros(5, dtype=np.int64)
    tick = 0
    made = 0
    rows = len(interval)
    row = 0
    within = 0
    based = -1
    while row < rows and made < limit:
        grows = add[row]
        first = interval[row] + within * grows
        alone = rest > 0 and first >= rest
        steps = count[row] - within
        if rest > 0 and not alone and first + grows * (steps - 1) >= rest:
            # Up to the step that has a base of its own.
            steps = (rest - first + grows - 1) // grows
        if alone:
            steps = 1
        steps = min(steps, limit - made)
        given = first
        if alone:
            crc = closed(crc, record, table)
            record[HAS] = 0
            crc = hashed(hashed(crc, BASE, 1, table), (tick + first - lead) & WORD, 4, table)
            given = lead
        follows = record[HAS] == 1 and record[LEVEL] == level[row] and record[GROWS] == grows
        if follows and ((record[FIRST] + record[MADE] * grows - given) & WORD) == 0:
            record[MADE] += steps
        else:
            crc = closed(crc, record, table)
            record[HAS] = 1
            record[FIRST] = given
            record[MADE] = steps
            record[GROWS] = grows
            record[LEVEL] = level[row]
        tick += steps * first + grows * (steps * (steps - 1) // 2)
        made += steps
        within += steps
        if within == count[row]:
            row += 1
            within = 0
    if row < rows and rest > 0:
        first = interval[row] + within * add[row]
        if first >= rest:
            based = hashed(hashed(closed(crc, record, table), BASE, 1, table), (tick + first - lead) & WORD, 4, table)
    out[0] = made
    out[1] = closed(crc, record, table)
    out[2] = based
