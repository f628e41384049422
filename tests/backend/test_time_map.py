"""Time maps: never sooner, never nearer, in the same order."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gproof.backend.time_map import MapBuilder, TimeMap


@st.composite
def maps(draw: st.DrawFn, *, most: int = 20_000) -> TimeMap:
    build = MapBuilder()
    for _ in range(draw(st.integers(0, 6))):
        width = draw(st.integers(1, most))
        kind = draw(st.sampled_from(["shift", "slow", "line", "rest"]))
        end = build.source[-1] + width
        if kind == "shift":
            build.shift(end)
        elif kind == "slow":
            build.slow(end, Fraction(draw(st.integers(1, 10)), 10))
        elif kind == "line":
            build.to(end, build.target[-1] + width + draw(st.integers(0, 3 * width)))
        else:
            build.rest(draw(st.integers(1, most)))
    return build.done()


@given(maps(), st.lists(st.integers(0, 200_000), max_size=50))
def test_ticks_never_come_nearer_or_change_places(times: TimeMap, ticks: list[int]) -> None:
    before = np.unique(np.array(ticks, dtype=np.int64))
    after = times.at(before)
    assert (after >= before).all()
    assert (np.diff(after) >= np.diff(before)).all()


@given(maps())
def test_breakpoints_are_met(times: TimeMap) -> None:
    for k, (source, target) in enumerate(zip(times.source, times.target, strict=True)):
        if not k or times.source[k - 1] != source:
            assert times.at(np.array([source]))[0] == target
        if k + 1 == len(times.source) or times.source[k + 1] != source:
            assert times.after(int(source)) == target


@given(maps(), st.integers(0, 200_000))
def test_pieces_cover_everything_once(times: TimeMap, end: int) -> None:
    pieces = times.pieces(end)
    at = 0
    for begin, stop, shifted in pieces:
        assert begin == at
        assert stop > begin
        at = stop
        inside = np.arange(begin + 1, min(stop, begin + 500) + 1)
        late = times.at(inside) - inside
        if shifted:
            assert (late == late[0]).all()
            assert late[0] == times.after(begin) - begin
    assert at == max(end, int(times.source[-1]))


def test_a_slow_stretch_is_rounded_towards_slower_and_cells_stay_short() -> None:
    build = MapBuilder()
    build.slow(10**10, Fraction(3, 10))
    times = build.done()
    assert 0 <= times.after(10**10) * 3 - 10**11 < 3 * len(times.source)
    assert np.diff(times.source).max() == 2**28


def test_bad_maps_are_refused() -> None:
    for source, target in [([0, 5], [0, 4]), ([1], [0]), ([0, 5, 4], [0, 5, 6]), ([0, 2**29], [0, 2**30])]:
        with pytest.raises(ValueError, match="time map"):
            TimeMap(np.array(source), np.array(target)).verify()
