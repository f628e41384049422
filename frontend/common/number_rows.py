"""Text files of numbers in rows, ``;`` or ``#`` before a comment: correction tables, height maps."""

from __future__ import annotations

import re
from collections.abc import Iterator
from fractions import Fraction

from gproof.frontend.common.exact_numbers import LARGEST, exact_ratio


def number_rows(text: str, count: int) -> Iterator[tuple[int, tuple[Fraction, ...] | None]]:
    """(line, ``count`` exact numbers) of each line that is not empty; None for the numbers of one that has others."""
    for number, line in enumerate(text.splitlines(), 1):
        words = re.split(r"[;#]", line, maxsplit=1)[0].split()
        if not words:
            continue
        values = [exact_ratio(word) for word in words if "/" not in word]
        known = tuple(value for value in values if value is not None and abs(value) <= LARGEST)
        yield number, known if len(words) == len(known) == count else None
