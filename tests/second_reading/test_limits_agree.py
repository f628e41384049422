"""gproof never says SAFE where a second reading of the manual, written apart from it, goes past a limit or into a zone.

The readings are plain interpreters (`eding`, `wincnc`, `mcuwin`) that share no code with gproof and sample positions;
`*_jobs` make random programs with machines and setups that state all they rest on; `comparing` holds both answers
against each other. `make soak ONLY=second_reading` runs all of it and prints the figures, false alarms by finding code
among them. A failure prints its seed and files that can be pasted.
"""

from __future__ import annotations

import random
from collections.abc import Callable
from typing import Any

import pytest
from second_reading import comparing, eding_jobs, mcuwin_jobs, wincnc_jobs
from support.campaigns import SOAK, sizes

MAKERS: dict[str, Callable[[random.Random], comparing.Job]] = {
    "eding": eding_jobs.job,
    "wincnc": wincnc_jobs.job,
    "mcuwin": mcuwin_jobs.job,
}
MOST = {
    # shares of the programs: false alarms, unknown though inside, not read by the second reading
    "eding": (0.01, 0.08, 0.14),
    "wincnc": (0.012, 0.11, 0.14),
    "mcuwin": (0.004, 0.008, 0.15),
}
"""About half as much again as was counted when this was written: a rise fails."""


@pytest.mark.parametrize("count", sizes(30, 10_000))
@pytest.mark.parametrize("name", MAKERS)
def test_safe_means_inside(name: str, count: int, record_property: Callable[[str, Any], None]) -> None:
    figures = comparing.Figures()
    wrong = []
    for number in range(count):
        seed = f"{name} {number}"
        rng = random.Random(seed)
        one = comparing.compared(seed, MAKERS[name](rng), rng)
        figures.add(one)
        if one.kind in {"wrong SAFE", "error not found"}:
            wrong.append(f"{one.kind}: {one.text}")
    lines = figures.lines(name)
    if SOAK:
        record_property("figures", "\n".join(lines))
    assert not wrong, f"{len(wrong)} wrong answers\n" + "\n\n".join(wrong[:5])
    for kind, share in zip(("false alarm", "unknown, inside", "not read"), MOST[name], strict=True):
        expected = share * count
        assert figures.kinds[kind] <= expected + 3 * expected**0.5 + 1, "\n".join(lines)
    assert figures.verdicts["SAFE"] > count / 4
    assert figures.verdicts["UNSAFE"] > count / 4
