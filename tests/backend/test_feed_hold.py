"""Feed hold: comes to rest along the path within the axes' accelerations, and goes on."""

import pytest
from backend.streams import FREQUENCY, machine, merged, motors_of, planned, steps_of, windows_hold
from hypothesis import given, settings
from hypothesis import strategies as st

from gproof.backend.feed_hold import MARGINS, Hold, hold
from gproof.backend.retime import Spacing, retime
from gproof.ir.machine import Machine
from gproof.ir.stream import StreamSection

REST = 250_000


def held(section: StreamSection, of: Machine, tick: int, **more: float) -> tuple[Hold, StreamSection]:
    found = hold(section, motors_of(of), of, FREQUENCY, tick=tick, rest=REST, **more)
    return found, retime(section, found.times, Spacing.of(of, FREQUENCY))


points = st.lists(
    st.tuples(st.floats(-15, 15), st.floats(-15, 15)).map(lambda p: (round(p[0], 2), round(p[1], 2))),
    min_size=1,
    max_size=4,
)


@settings(max_examples=40)
@given(points, st.floats(0, 1), st.sampled_from(MARGINS))
def test_a_hold_keeps_order_and_limits(way: list[tuple[float, ...]], when: float, margin: float) -> None:
    of = machine()
    section = planned(way, of)
    tick = int(when * section.duration)
    found, late = held(section, of, tick, margin=margin)
    assert [(m, d) for _, m, d in merged(late)] == [(m, d) for _, m, d in merged(section)]
    assert late.end() == section.end()
    assert windows_hold(late, of) == []
    begins = found.rest_begins
    assert begins >= tick
    assert not [t for t, _, _ in merged(late) if begins < t <= begins + REST]
    assert late.duration >= section.duration + REST
    for old, new in zip(section.runs, late.runs, strict=True):
        early = [s for s in steps_of(old) if s[0] <= tick]
        assert steps_of(new)[: len(early)] == early


def test_a_hold_in_full_motion_takes_about_the_shortest_way() -> None:
    of = machine(acceleration=600.0)
    section = planned([(60.0, 0.0)], of, feed=60.0)
    found, late = held(section, of, 500_000)
    assert 0.1 * FREQUENCY <= found.rest_begins - 500_000 < 0.12 * FREQUENCY
    lost = late.duration - section.duration - REST
    assert lost < 0.12 * FREQUENCY


def test_a_hold_while_braking_at_full_acceleration_waits_for_the_stop() -> None:
    of = machine()
    section = planned([(20.0, 0.0)], of)
    tick = section.duration - 60_000
    found, late = held(section, of, tick)
    assert tick < found.rest_begins <= section.duration + 1000
    assert windows_hold(late, of) == []


def test_a_hold_after_the_last_step_only_waits() -> None:
    of = machine()
    section = planned([(5.0, 0.0)], of)
    section.duration += 100_000
    found, late = held(section, of, section.duration - 10)
    assert late.runs == section.runs
    assert found.rest_begins == section.duration - 10
    assert late.duration == section.duration + REST


@pytest.mark.parametrize("way", ["same", "longer"])
def test_the_length_of_the_rest_changes_nothing_before_it(way: str) -> None:
    of = machine()
    section = planned([(20.0, 8.0), (3.0, 1.0)], of)
    spacing = Spacing.of(of, FREQUENCY)
    both = []
    for rest in (1000, 1000 if way == "same" else 10**9):
        found = hold(section, motors_of(of), of, FREQUENCY, tick=200_000, rest=rest)
        late = retime(section, found.times, spacing)
        both.append([s for s in merged(late) if s[0] <= found.rest_begins])
    assert both[0] == both[1]


def test_holds_follow_one_another() -> None:
    of = machine()
    section = planned([(30.0, 8.0), (3.0, 1.0)], of)
    late = section
    for tick in (100_000, 160_000, 700_000, 710_000):
        _, late = held(late, of, tick)
        assert windows_hold(late, of) == []
    assert [(m, d) for _, m, d in merged(late)] == [(m, d) for _, m, d in merged(section)]
    assert late.duration >= section.duration + 4 * REST
