"""Counts and CRCs of executed runs, against the vector of docs/boards.md and against a walk over single steps."""

from __future__ import annotations

import random
import struct
import zlib

import numpy as np
import pytest
from support.campaigns import sizes

from gproof.ir.columns import Columns
from gproof.ir.stream import RUN
from gproof.verify.execution import run_sums as module
from gproof.verify.execution.run_sums import Given, run_sums
from gproof.verify.execution.sum_kernels import summed

Row = tuple[int, int, int, int]

IDENTITY = bytes(range(32))
USUAL = Given(level=1, rest=1 << 30, lead=1 << 16, most_add=32767, longest=2**31 - 1)
VECTOR = [(2000, 3, 10, 1), (2030, 2, 10, 1), (5000, 1, 0, -1)]


def table(rows: list[Row]) -> Columns:
    return Columns(RUN, {c.name: np.array([r[k] for r in rows], dtype=c.dtype) for k, c in enumerate(RUN.columns)})


def told(rows: list[Row], steps: int, given: Given = USUAL, section: int = 7) -> set[int]:
    found = run_sums(table(rows), steps, given, identity=IDENTITY, section=section)
    assert found.steps == min(steps, sum(row[1] for row in rows))
    return set(found.crcs)


def test_the_vector_of_the_extension() -> None:
    assert told(VECTOR, 0) == {0x24CED456, 0x90ADB27D}
    assert told(VECTOR, 2) == {0x8028D150}
    assert told(VECTOR, 5) == {0x458FEFDE}
    assert told(VECTOR, 6) == told(VECTOR, 99) == {0x8E12422E}
    assert told(VECTOR, 6, section=8) != told(VECTOR, 6)


def by_hand(rows: list[Row], steps: int, given: Given) -> set[int]:
    """The text of the extension, a record of (interval, count, add, level) or a base at a time."""
    parts: list[tuple[int, ...]] = [(0,)]
    tick = made = 0
    pending = False
    for interval, count, add, direction in rows:
        last = interval + add * (count - 1)
        grows = 0 if max(interval, last) > given.longest or abs(add) > given.most_add else add
        for k in range(count):
            wait = interval + k * add
            if made == steps:
                pending = wait >= given.rest
                break
            here = wait
            if wait >= given.rest:
                parts.append(((tick + wait - given.lead) % 2**32,))
                here = given.lead
            level = given.level if direction > 0 else 1 - given.level
            before = parts[-1]
            if len(before) == 4 and before[2:] == (grows, level) and before[0] + before[1] * grows == here:
                parts[-1] = (before[0], before[1] + 1, grows, level)
            else:
                parts.append((here, 1, grows, level))
            tick += wait
            made += 1
            next_base = tick
        else:
            continue
        break
    texts = [parts]
    if pending:
        texts.append([*parts, ((next_base if made else 0) + wait - given.lead,)])
    if not made:
        texts.append([])
    found = set()
    for text in texts:
        data = IDENTITY + struct.pack("<I", 7)
        for part in text:
            if len(part) == 1:
                data += b"B" + struct.pack("<I", part[0] % 2**32)
            else:
                data += b"R" + struct.pack("<IIhB", part[0] % 2**32, part[1], part[2], part[3])
        found.add(zlib.crc32(data))
    return found


def made_up(chance: random.Random) -> list[Row]:
    rows: list[Row] = []
    for _ in range(chance.randrange(1, 6)):
        interval = chance.choice([1, 200, 5000, 2**29, 2**30 - 2, 2**30, 2**30 + 9, 2**31 - 1, 2**31 + 5])
        count = chance.choice([1, 1, 2, 3, 7])
        add = chance.choice([0, 0, 1, -1, 30, 32767, -20, 40_000])
        if interval + add * (count - 1) < 1:
            add = 0
        direction = chance.choice([1, -1])
        if rows and chance.random() < 0.4:
            before = rows[-1]
            interval, add, direction = max(1, before[0] + before[1] * before[2]), before[2], before[3]
            if interval + add * (count - 1) < 1:
                count = 1
        rows.append((interval, count, add, direction))
    return rows


@pytest.mark.parametrize("many", sizes(400, 20_000))
def test_random_runs_step_by_step(many: int) -> None:
    for seed in range(many):
        chance = random.Random(seed)
        rows = made_up(chance)
        given = Given(level=chance.randrange(2), rest=1 << 30, lead=1 << 16, most_add=32767, longest=2**31 - 1)
        for steps in range(sum(row[1] for row in rows) + 1):
            assert told(rows, steps, given) == by_hand(rows, steps, given), (seed, rows, steps)


def test_it_does_not_matter_where_runs_are_cut() -> None:
    for seed in range(200):
        chance = random.Random(seed)
        rows = [row for row in made_up(chance) if row[0] < 2**29 and abs(row[2]) < 40_000]
        cut: list[Row] = []
        for interval, count, add, direction in rows:
            k = chance.randrange(count + 1)
            cut += [(i, n, add, direction) for i, n in ((interval, k), (interval + k * add, count - k)) if n]
        whole = sum(row[1] for row in rows)
        assert told(rows, whole) == told(cut, whole), (seed, rows)


def test_compiled_and_plain_give_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    rows = [row for seed in range(30) for row in made_up(random.Random(seed))]
    plain = told(rows, 10**6)

    class Always:
        @staticmethod
        def pick(_: float) -> object:
            return summed.pick(1e9)

    monkeypatch.setattr(module, "summed", Always)
    assert told(rows, 10**6) == plain


def test_an_identity_has_32_bytes() -> None:
    with pytest.raises(ValueError, match="31 bytes"):
        run_sums(table(VECTOR), 1, USUAL, identity=IDENTITY[1:], section=7)
