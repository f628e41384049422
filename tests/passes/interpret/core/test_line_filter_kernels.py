"""What is asked of plain lines around the kernel that runs them, in both speeds, against the same in numpy."""

from __future__ import annotations

import numpy as np
import pytest

from gproof.ir.trace import Op
from gproof.passes.interpret.core import line_filter_kernels as k
from gproof.passes.interpret.core.line_decoder_kernels import SLOTS, WordColumns, letter_slots


@pytest.mark.parametrize("pairs", [0, 1])
def test_cold_lines(pairs: int) -> None:
    rng = np.random.default_rng(pairs)
    for count in (0, 1, 7, 400):
        line = np.sort(rng.integers(1, 1 + count // 2 + 1, count)).astype(np.int32)
        letter = rng.choice(np.frombuffer(b"XYZIJGFQ", np.uint8), count, p=[0.2, 0.2, 0.1, 0.15, 0.15, 0.1, 0.08, 0.02])
        value = rng.choice([0.0, -0.0, 1.0, 2.0, 3.0, 3.5, 4.0, -1.0, np.inf, -np.inf, np.nan], count)
        value[letter != ord("G")] = 7.5
        hot = np.array([chr(n) in "XYZIJGF" for n in range(256)], np.uint8)
        cold = (hot[letter] == 0) | ((letter == ord("G")) & ~np.isin(value, (0.0, 1.0, 2.0, 3.0)))
        expected = set(line[cold].tolist())
        if pairs:
            expected |= set(np.setxor1d(line[letter == ord("I")], line[letter == ord("J")]).tolist())
        columns = (line, letter, value, np.zeros(count, np.uint8))
        slots = letter_slots({"X": 0, "Y": 1, "Z": 2}, "IJGF")
        for run, words, table in (
            (k.cold_lines, WordColumns(*(c.tolist() for c in columns)), slots),
            (k.cold_lines.compiled(), WordColumns(*columns), np.array(slots)),
        ):
            lines, firsts = np.empty(count, np.int64), np.empty(count, np.int64)
            found = run(words, count, table, np.zeros(SLOTS), pairs, lines, firsts)
            assert lines[:found].tolist() == sorted(expected)
            assert firsts[:found].tolist() == [int(np.argmax(line == number)) for number in sorted(expected)]


def test_judge_moves() -> None:
    rng = np.random.default_rng(3)
    for count, begin in ((1, 0), (3000, 17)):
        to = rng.choice(
            [0.0, 1.0, 1.0 + 5e-13, 1.0 + 1e-8, 1.01, 5e-324, np.nan], (count + begin, 6), p=[0.01] + [0.165] * 6
        )
        to[:, 2:] = rng.choice([1.0, 1.0 + 1e-13], (count + begin, 1))
        op = rng.choice([Op.TRAVERSE, Op.FEED, Op.ARC], count + begin).astype(np.uint8)
        center = rng.uniform(0.0, 2.0, (count + begin, 3))
        start, same, allowed = np.full(6, 1.0), 1e-9, 0.3
        rows, kinds = to[begin:], op[begin:]
        before = np.vstack([start, rows[:-1]])
        way = np.abs(rows - before).max(axis=1)
        still = np.flatnonzero((way < np.where(kinds == Op.TRAVERSE, 5e-324, same)) & (kinds != Op.ARC)).tolist()
        first, last = (np.hypot(*(p[:, :2] - center[begin:, :2]).T) for p in (before, rows))
        off = np.flatnonzero((kinds == Op.ARC) & (np.abs(last - first) > allowed)).tolist()
        assert count == 1 or (len(still) > 20 and len(off) > 20)
        results = []
        for run in (k.judge_moves, k.judge_moves.compiled()):
            stills, offs, radii = np.empty(count, np.int64), np.empty(count, np.int64), np.zeros((count, 2))
            counts = run(op, to, center, begin, begin + count, start, same, 5e-324, allowed, stills, offs, radii)
            assert tuple(counts) == (len(still), len(off), int((kinds == Op.ARC).sum()))
            assert stills[: len(still)].tolist() == still
            assert offs[: len(off)].tolist() == off
            np.testing.assert_allclose(radii[: len(off)], np.stack([first[off], last[off]], axis=1), rtol=1e-15)
            results.append(radii.tobytes())
        assert results[0] == results[1]
