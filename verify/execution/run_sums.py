"""Counts and CRCs that a board states of what it executed, derived again from the runs of a section.

Takes run tables of ``ir.stream`` as they were sent, and how the board was given them; shares no code with the host
(``backend/boards/klipper``) nor with the emulator. Source: docs/boards.md, "The certification extension".
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from gproof.ir.columns import Columns
from gproof.ir.record import record
from gproof.verify.execution.sum_kernels import BASE, WORD, hashed, summed

Ints = npt.NDArray[np.int64]

IDENTITY_BYTES = 32


@record(frozen=True, slots=True, kw_only=True)
class Given:
    """How a board gets runs.

    level: of the direction pin for steps that count up, 0 or 1; rest: ticks of rest from which a step gets a new clock
    base, ``lead`` ticks before it (0: never); most_add, longest: the greatest add, signs aside, and interval that it
    takes in a run of several steps, ticks.
    """

    level: int
    rest: int
    lead: int
    most_add: int
    longest: int


@record(frozen=True, slots=True)
class RunSums:
    """steps: made, at most those that the runs have; crcs: each that a board may state then: it may have taken the
    clock base of the next step, and before the first step not even that of the section."""

    steps: int
    crcs: tuple[int, ...]


def run_sums(runs: Columns, steps: int, given: Given, *, identity: bytes, section: int) -> RunSums:
    """What a motor's count and CRC are after ``steps`` of these runs; identity: 32 bytes, as presented to the board."""
    if len(identity) != IDENTITY_BYTES:
        raise ValueError(f"an identity of {len(identity)} bytes")
    table = _table()
    columns = _as_given(runs, given)
    register = WORD
    for byte in identity:
        register = hashed(register, byte, 1, table)
    bare = hashed(register, section & WORD, 4, table)
    register = hashed(hashed(bare, BASE, 1, table), 0, 4, table)
    out = np.zeros(3, dtype=np.int64)
    kernel = summed.pick(float(min(steps, len(columns[0]))))
    kernel(*columns, max(0, steps), given.rest, given.lead, register, table, out)
    made, crc, based = (int(value) for value in out)
    registers = [value for value in (crc, based) if value >= 0] + ([] if made else [bare])
    return RunSums(made, tuple(value ^ WORD for value in registers))


def _as_given(runs: Columns, given: Given) -> tuple[Ints, Ints, Ints, Ints]:
    """Intervals, counts, adds and levels, step by step where a run has numbers that the board does not take."""
    interval, count, add = (runs[name].astype(np.int64) for name in ("interval", "count", "add"))
    up = runs["direction"] > 0
    level = np.where(up, given.level, 1 - given.level).astype(np.int64)
    last = interval + add * (count - 1)
    alone = (np.maximum(interval, last) > given.longest) | ((np.abs(add) > given.most_add) & (count > 1))
    parts = np.where(alone, count, 1)
    place = np.arange(int(parts.sum()), dtype=np.int64) - np.repeat(np.cumsum(parts) - parts, parts)
    interval = np.repeat(interval, parts) + place * np.repeat(add, parts)
    lost = alone | (np.abs(add) > given.most_add)
    return (
        interval,
        np.repeat(np.where(alone, 1, count), parts),
        np.repeat(np.where(lost, 0, add), parts),
        np.repeat(level, parts),
    )


def _table() -> Ints:
    """Of CRC-32 for a byte."""
    table = np.arange(256, dtype=np.int64)
    for _ in range(8):
        table = np.where(table & 1, (table >> 1) ^ 0xEDB88320, table >> 1)
    return table
