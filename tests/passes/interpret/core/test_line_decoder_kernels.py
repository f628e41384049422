"""The one decoder of lines in both speeds, against the same line by line in plain words."""

from __future__ import annotations

import math

import numpy as np
import pytest

from gproof.ir.kernel import kernel
from gproof.ir.program import FLAG_BARE, FLAG_POINT
from gproof.passes.interpret.core import line_decoder_kernels as k
from gproof.passes.interpret.core.line_decoder_kernels import read_line

SLOTS = k.letter_slots({"X": 0, "Y": 1, "W": 5})
BITS = {0.0: k.HAS_G, 1.0: k.HAS_G, 2.0: k.HAS_G, 3.0: k.HAS_G, 90.0: k.HAS_DISTANCE, 91.0: k.HAS_DISTANCE}


@kernel()
def read_all(
    words: k.WordColumns, count: int, slots: object, values: object, motion: int, absolute: int, out: np.ndarray
) -> int:
    """Every line, one row of ``out`` each."""
    line, letter, value, flags = words
    word = n = 0
    while word < count:
        word, seen, motion, absolute, some, every = read_line(
            line, letter, value, flags, count, word, slots, motion, absolute, values
        )
        out[n, 0], out[n, 1], out[n, 2] = word, seen, motion
        out[n, 3], out[n, 4], out[n, 5] = absolute, some, every
        n += 1
    return n


def in_words(letters: str, numbers: list[float], flags: list[int], motion: int, absolute: int) -> list[int]:
    """What ``read_line`` says of a line."""
    seen, some, every = 0, 0, 255
    for letter, number, flag in zip(letters, numbers, flags, strict=True):
        slot = SLOTS[ord(letter)]
        bit = k.OTHER if slot < 0 else 1 << slot
        if letter == "G":
            bit = BITS.get(number, 1 << k.DWELL if number == 4.0 else k.OTHER)
            motion = int(number) + 1 if bit == k.HAS_G else motion
            absolute = int(number == 90.0) if bit == k.HAS_DISTANCE else absolute
        seen |= bit | (k.REPEATED if seen & bit else 0) | (k.OVER if abs(number) > k.LARGEST else 0)
        some |= flag
        every &= flag if letter in "XYW" else 255
    return [seen, motion, absolute, some, every]


@pytest.mark.parametrize("seed", range(4))
def test_lines(seed: int) -> None:
    rng = np.random.default_rng(seed)
    count = 3000
    line = np.sort(rng.integers(1, 1200, count)).astype(np.int32)
    letter = rng.choice(np.frombuffer(b"XYWIJKRFGPQ", np.uint8), count)
    value = rng.choice([0.0, -0.0, 1.0, 2.5, -3.0, 1e12, 1.1e12, -2e12, math.inf, math.nan], count)
    codes = letter == ord("G")
    value[codes] = rng.choice([0.0, -0.0, 1.0, 2.0, 3.0, 4.0, 90.0, 91.0, 17.0, 90.1, math.nan], codes.sum())
    flags = rng.choice(np.array([0, FLAG_BARE, FLAG_POINT], np.uint8), count)
    expected, motion, absolute = [], 2, 1
    for number in np.unique(line):
        at = np.flatnonzero(line == number)
        said = in_words(letter[at].tobytes().decode(), value[at].tolist(), flags[at].tolist(), motion, absolute)
        motion, absolute = said[1], said[2]
        expected.append([int(at[-1]) + 1, *said])
    columns = k.WordColumns(line, letter, value, flags)
    kept = []
    for run, words, slots in (
        (read_all.python, k.WordColumns(*(c.tolist() for c in columns)), SLOTS),
        (read_all.compiled(), columns, np.array(SLOTS)),
    ):
        values, out = np.zeros(k.SLOTS), np.zeros((len(expected), 6), np.int64)
        assert run(words, count, slots, values, 2, 1, out) == len(expected)
        assert out.tolist() == expected
        kept.append(values.tobytes())
    assert kept[0] == kept[1]


def test_letters() -> None:
    """Axes come before all else; a letter that nobody named has no slot."""
    slots = k.letter_slots({"X": 0, "I": 3}, "IJP")
    assert {chr(n): slot for n, slot in enumerate(slots) if slot >= 0} == {"X": 0, "I": 3, "J": k.J, "P": k.TIME}
    assert slots[ord("F")] == -1
