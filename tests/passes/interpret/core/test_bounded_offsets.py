"""Offsets that are set to a number of which only bounds are known: an answer for all of them (3.4.5, 3.4.23).

What a dialog will give, or a variable that the setup bounds, is as good as a work offset that is only bounded: the job
is SAFE when it is SAFE for both ends, and its positions lie between those of the ends.
"""

from __future__ import annotations

import random
from dataclasses import replace
from pathlib import Path

import pytest
from metamorphic.jobs import Job, run

from gproof.ir.verdict import Verdict

HEAD = "G21 G90 G17 G40 G49 G80 G94 G98 G69 G50 G54\n"
SETTERS = (
    "G92 X{0}", "G10 L2 P1 X{0}", "G10 L20 P1 X{0}", "G0 X7\nG92 X{0}\nG0 X3\nG92 X{0}", "G20\nG92 X[{0} / 20]\nG21",
    "G10 L2 P2 X{0}\nG55", "G92 X[0 - {0}]\nG92.2\nG92.3", "G10 L20 P2 X[{0} * 2]\nG55", "G10 L2 P1 X{0}\nG92 X#5221",
)  # fmt: skip


@pytest.mark.parametrize("setter", SETTERS)
def test_an_offset_within_bounds_is_judged_for_both_ends(setter: str, tmp_path: Path) -> None:
    rng = random.Random(setter)
    verdicts = set()
    for _ in range(12):
        low = rng.randrange(-320, 320) / 16
        ends = low, low + rng.randrange(1, 160) / 16
        program = f"{HEAD}{setter.format('#4000')}\nG0 X10\nG0 X-5\nM2\n"
        edge = rng.randrange(10, 50) * 1.0
        limits = {"x": (-edge, edge), "y": (-1.0, 1.0), "z": (-1.0, 1.0), "a": (-1.0, 1.0)}
        job = Job(program, limits, start=dict.fromkeys("xyza", 0.0))
        exact = [run(tmp_path, replace(job, parameters={4000: value})).verdict for value in ends]
        bounded = run(tmp_path, replace(job, parameters={4000: ends}))
        where = f"{ends}\n{program}{edge}\n{exact}\n{bounded.told()}"
        assert (bounded.verdict is Verdict.SAFE) == (set(exact) == {Verdict.SAFE}), where
        if bounded.verdict is Verdict.UNSAFE:
            assert set(exact) == {Verdict.UNSAFE}, where
        verdicts.add(bounded.verdict)
    assert verdicts >= {Verdict.SAFE}
    assert verdicts - {Verdict.SAFE}


def test_without_bounds_it_is_unknown(tmp_path: Path) -> None:
    limits = dict.fromkeys("xyza", (-1e6, 1e6))
    for setter in SETTERS:
        program = f"{HEAD}{setter.format('#4000')}\nG0 X10\nM2\n"
        assert run(tmp_path, Job(program, limits)).verdict is Verdict.UNKNOWN, setter
