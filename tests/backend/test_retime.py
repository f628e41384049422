"""Retimed sections: the same steps in the same order, where the map puts them."""

from fractions import Fraction

import numpy as np
import pytest
from backend.streams import (
    FREQUENCY,
    events_of,
    machine,
    merged,
    planned,
    run_rows,
    runs_of,
    sections,
    steps_of,
    windows_hold,
)
from backend.test_time_map import maps
from hypothesis import given
from hypothesis import strategies as st

import gproof.backend.retime as module
from gproof.backend.retime import Spacing, retime, slow_map
from gproof.backend.retime_kernels import fit, reach
from gproof.backend.time_map import TimeMap
from gproof.ir.columns import Columns
from gproof.ir.stream import StreamSection
from gproof.ir.trace import Op

EXACT = Spacing(gap=1, setup=1, tolerance=0)
LOOSE = Spacing(gap=10, setup=25, tolerance=40)


def order(section: StreamSection) -> list[tuple[int, int]]:
    return [(m, d) for _, m, d in merged(section)]


@given(sections(), maps())
def test_exact_retiming_puts_every_step_on_its_mapped_tick(section: StreamSection, times: TimeMap) -> None:
    late = retime(section, times, EXACT)
    for before, after in zip(section.runs, late.runs, strict=True):
        source, ways = zip(*steps_of(before), strict=True) if len(before) else ((), ())
        want = times.at(np.array(source, dtype=np.int64)).tolist()
        assert steps_of(after) == list(zip(want, ways, strict=True))
    assert order(late) == order(section)
    assert late.end() == section.end()
    assert late.events["tick"].tolist() == times.at(section.events["tick"]).tolist()
    assert late.duration == times.after(section.duration)


@given(sections(), maps(), st.sampled_from([1 << 19, 20]))
def test_loose_retiming_keeps_order_intervals_and_tolerance(section: StreamSection, times: TimeMap, chunk: int) -> None:
    kept, module.CHUNK = module.CHUNK, chunk
    try:
        late = retime(section, times, LOOSE)
    finally:
        module.CHUNK = kept
    assert order(late) == order(section)
    for before, after in zip(section.runs, late.runs, strict=True):
        old, new = steps_of(before), steps_of(after)
        want = times.at(np.array([t for t, _ in old], dtype=np.int64)).tolist()
        for k, ((tick, way), exact) in enumerate(zip(new, want, strict=True)):
            assert abs(tick - exact) <= 40
            if k:
                need = 25 if way != new[k - 1][1] else 10
                assert tick - new[k - 1][0] >= min(need, exact - want[k - 1])
                assert abs(tick - exact) <= max(0, exact - want[k - 1]) // 64
    for tick, at in zip(late.events["tick"].tolist(), section.events["tick"].tolist(), strict=True):
        done = [sum(t <= at for t, _ in steps_of(r)) for r in section.runs]
        assert [sum(t <= tick for t, _ in steps_of(r)) for r in late.runs] == done


@given(sections(), maps())
def test_what_lies_before_the_first_change_keeps_its_runs(section: StreamSection, times: TimeMap) -> None:
    late = retime(section, times, LOOSE)
    change = next((a for a, b in zip(times.source, times.target, strict=True) if a != b), None)
    slower = np.flatnonzero(times.source != times.target)
    begin = int(times.source[max(0, int(slower[0]) - 1)]) if len(slower) else section.duration
    assert change is None or begin <= change
    for before, after in zip(section.runs, late.runs, strict=True):
        same = [s for s in steps_of(before) if s[0] <= begin]
        assert steps_of(after)[: len(same)] == same


@given(st.lists(run_rows(least=4), min_size=1, max_size=8).map(runs_of), st.integers(0, 30))
def test_kernels_are_the_same_in_both_speeds(runs: Columns, room: int) -> None:
    steps = steps_of(runs)
    at = np.array([t for t, _ in steps], dtype=np.int64)
    ways = np.array([d for _, d in steps], dtype=np.int8)
    gaps = np.diff(at, prepend=0)
    slack = np.minimum(room, np.minimum(gaps, np.append(gaps[1:], 10**9)) // 2 - 1).clip(0)
    low, high = at - slack, at + slack
    outs = []
    for run in (fit.python, fit.compiled()):
        out = np.zeros((len(at), 4), dtype=np.int64)
        outs.append(out[: run(low, high, ways, 0, out)])
    assert np.array_equal(*outs)
    found = steps_of(runs_of([tuple(row) for row in outs[0].tolist()]))
    assert [d for _, d in found] == ways.tolist()
    assert all(lo <= t <= hi for (t, _), lo, hi in zip(found, low.tolist(), high.tolist(), strict=True))
    for add in (-3, 0, 5):
        both = [f(low, high, 0, len(at), 0, add) for f in (reach.python, reach.compiled())]
        assert tuple(map(int, both[0])) == tuple(map(int, both[1]))


@pytest.mark.parametrize("factor", [Fraction(1, 2), Fraction(7, 10), Fraction(1, 10), Fraction(1)])
def test_an_override_scales_the_whole_section(factor: Fraction) -> None:
    of = machine()
    section = planned([(12.0, 0.0), (12.0, 9.0), (0.0, 0.0)], of)
    late = retime(section, slow_map(section, FREQUENCY, factor), Spacing.of(of, FREQUENCY))
    assert order(late) == order(section)
    assert late.end() == section.end()
    assert abs(late.duration * factor - section.duration) < 10
    assert windows_hold(late, of) == []
    assert sum(map(len, late.runs)) < sum(map(len, section.runs)) or factor == 1
    if factor == 1:
        assert late.runs == section.runs


def test_an_override_leaves_dwells_alone() -> None:
    section = StreamSection(
        number=0,
        start=(0,),
        runs=(runs_of([(1000, 10, 0, 1), (30_000, 1, 0, 1)]),),
        events=events_of([(12_000, 3, int(Op.DWELL), (20, 0)), (39_000, 4, int(Op.COOLANT), (0, 0))]),
        duration=50_000,
    )
    late = retime(section, slow_map(section, FREQUENCY, Fraction(1, 2)), EXACT)
    assert late.events["tick"].tolist() == [24_000, 24_000 + 20_000 + 14_000]
    assert steps_of(late.runs[0])[-1][0] == 24_000 + 20_000 + 16_000
    assert late.duration == 44_000 + 36_000


@pytest.mark.parametrize("factor", [Fraction(1, 11), Fraction(11, 10), Fraction(0)])
def test_an_override_has_a_range(factor: Fraction) -> None:
    with pytest.raises(ValueError, match="override"):
        slow_map(planned([(1.0, 0.0)], machine()), FREQUENCY, factor)


def test_spacing_comes_from_the_machine() -> None:
    spacing = Spacing.of(machine(), FREQUENCY)
    assert (spacing.gap, spacing.setup, spacing.tolerance) == (10, 10, 1)
    assert Spacing.of(machine(), FREQUENCY, exact=True).tolerance == 0
