"""How many bytes runs take on the line at most, from their numbers: what a section needs is known before it moves."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from gproof.backend.boards.klipper.messages import Message
from gproof.backend.boards.klipper.outbox import FROM_BASE, REBASE
from gproof.backend.boards.klipper.vlq import encoded
from gproof.backend.runs import Ints
from gproof.ir.columns import Columns

BLOCK, PAYLOAD = 64, 59
"""Bytes of a full block, and those of its messages; 5 are for length, sequence, check and end (Protocol.md)."""

MOST_COUNT, MOST_ADD, LONGEST = (1 << 16) - 1, (1 << 15) - 1, (1 << 31) - 1
"""Numbers that ``queue_step`` holds."""


def holds(interval: int, count: int, add: int, direction: int) -> bool:
    """Whether ``queue_step`` holds a run, one of a single step whatever its interval."""
    last = interval + add * (count - 1)
    fits = 1 <= count <= MOST_COUNT and abs(add) <= MOST_ADD and min(interval, last) >= 1
    return fits and abs(direction) == 1 and (count == 1 or max(interval, last) <= LONGEST)


def number_bytes(values: Ints) -> Ints:
    """Bytes of numbers as VLQ; a uint32 travels as the int32 with its bits."""
    signed = np.where(values >= 1 << 31, values - (1 << 32), values)
    found = np.ones(len(signed), dtype=np.int64)
    for groups in range(1, 5):
        found += ~((signed >= -(1 << (7 * groups - 2))) & (signed < 3 << (7 * groups - 2)))
    return found


def run_bytes(motor: int, runs: Columns, commands: Mapping[str, Message]) -> Ints:
    """Of each run: the step command, a change of direction, a new clock base after a long rest. Messages are never
    parted, so that a block may be short by one byte less than the longest."""
    head = len(encoded(motor))
    interval, direction = runs["interval"].astype(np.int64), runs["direction"]
    rests = interval >= REBASE
    found = number_bytes(np.where(rests, FROM_BASE, interval)) + number_bytes(runs["count"]) + number_bytes(runs["add"])
    found += head + len(encoded(commands["queue_step"].number))
    longest = int(found.max(initial=0))
    turned = np.concatenate(([True], direction[1:] != direction[:-1])) if len(runs) else np.zeros(0, dtype=bool)
    found += np.where(turned, head + 1 + len(encoded(commands["set_next_step_dir"].number)), 0)
    found += np.where(rests, head + 5 + len(encoded(commands["reset_step_clock"].number)), 0)
    filled = PAYLOAD - max(0, longest - 1)
    return -(-found * BLOCK // filled)
