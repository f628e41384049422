"""Steps that come too fast for a board: by hand, and against all times between two steps."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import pytest
from backend.jobs import job
from backend.streams import merged, runs_of, section_of, sections
from hypothesis import given
from hypothesis import strategies as st
from support.campaigns import examples

from gproof.backend.boards.virtual import VirtualBoard
from gproof.backend.runtime import RunRefused, walk
from gproof.backend.step_rate import TooFast, too_fast
from gproof.ir.stream import StreamSection

KHZ = 1000
"""Ticks a second of these tests."""


def by_hand(section: StreamSection, rate: int) -> tuple[int, int] | None:
    """The tick and motor of the first step that is too many: any time between two steps is looked at."""
    steps, motors = merged(section), len(section.runs)
    for j, (tick, motor, _) in enumerate(steps):
        for who, most in ((motor, 1), (-1, motors)):
            ticks = [t for t, m, _ in steps[: j + 1] if who in (-1, m)]
            for k, begin in enumerate(ticks):
                if len(ticks) - k > most + Fraction(1, 4) + Fraction(rate * (tick - begin), KHZ):
                    return tick, who
    return None


def test_motors_may_step_at_one_moment_and_no_faster_than_the_rate_on_the_whole() -> None:
    """At 100 steps a second in ticks of a millisecond: one motor each 10 ms, two each 20 ms."""
    assert too_fast(section_of([runs_of([(10, 200, 0, 1)])]), 100, KHZ) is None
    assert too_fast(section_of([runs_of([(20, 100, 0, 1)])] * 2), 100, KHZ) is None
    assert too_fast(section_of([runs_of([(9, 1, 0, 1), (11, 1, 0, 1), (8, 1, 0, 1)])]), 100, KHZ) is None
    # 7.5 ms are the least for a step that is rounded: 7 are too few.
    assert too_fast(section_of([runs_of([(10, 2, 0, 1), (7, 1, 0, 1)])]), 100, KHZ) == TooFast(
        tick=27, motor=0, begin=20, steps=2
    )
    # Pairs 19 ms apart: 2.25 and 1.9 more for each pair may come; 6 are not more than 6.05, but 8 are than 7.95.
    assert too_fast(section_of([runs_of([(19, 100, 0, 1)])] * 2), 100, KHZ) == TooFast(
        tick=76, motor=-1, begin=19, steps=8
    )
    assert too_fast(section_of([runs_of([]), runs_of([])]), 100, KHZ) is None


@examples(30, 3000)
@given(section=sections(least=1, most=60, rows=2), rate=st.integers(20, 2000))
def test_every_time_between_two_steps_counts(section: StreamSection, rate: int) -> None:
    found, wanted = too_fast(section, rate, KHZ), by_hand(section, rate)
    assert (None if found is None else (found.tick, found.motor)) == wanted


def test_long_runs_and_rests_do_not_overflow() -> None:
    table = runs_of([(2**61, 1, 0, 1), (800, 2**20, 0, 1)])
    section = replace(section_of([runs_of([])]), runs=(table,), duration=2**62)
    assert too_fast(section, 20_000, 16_000_000) is None
    table["interval"][1] = 799
    found = too_fast(section, 20_000, 16_000_000)
    assert found is not None and found.begin == 2**61 and found.tick == 2**61 + 200 * 799 + 799


def test_a_board_that_is_too_slow_is_given_nothing() -> None:
    class Slow(VirtualBoard):
        def open(self):
            return replace(super().open(), step_rate=15_000)

    one = job([(6.0, 5.0)])
    board = Slow.for_machine(one.machine, 2)
    with pytest.raises(RunRefused) as refusal:
        walk(one, board)
    (finding,) = refusal.value.findings
    assert finding.code.label == "GP842"
    assert "steps in" in finding.message and "15000 steps a second" in finding.message
    assert board.status().state.value == "closed"
