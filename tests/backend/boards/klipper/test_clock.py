"""The clock's bounds hold for any rate that a board may have, whatever the line does."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gproof.backend.boards.klipper.clock import BoardClock, ClockError

FREQUENCY = 16_000_000
DELAYS = st.lists(st.tuples(st.floats(0.01, 20), st.floats(0.0002, 0.05), st.floats(0, 1)), min_size=2, max_size=30)


@given(st.floats(-5000, 5000), st.floats(-100, 100), st.integers(0, 2**40), DELAYS)
def test_bounds_hold_and_wraps_are_counted(
    ppm: float, wander: float, origin: int, waits: list[tuple[float, float, float]]
) -> None:
    clock, now = BoardClock(FREQUENCY), 1000.0
    true, at = float(origin), now
    for k, (wait, delay, share) in enumerate(waits):
        rate = FREQUENCY * (1 + (ppm + (wander if k % 2 else -wander)) * 1e-6)
        asked = now + wait
        made, answered = asked + share * delay, asked + delay
        if k:
            for second in (now, (now + asked) / 2, asked):
                shown = true + (second - at) * rate
                assert clock.lower(second) <= shown + 1
                assert clock.upper(second) >= shown
            tick = clock.last.tick + 8_000_000
            assert clock.lower(clock.host_second(tick) + 1e-6) >= tick - 1
        true, at = true + (made - at) * rate, made
        if k:
            clock.read_word(asked, answered, int(true) % 2**32)
        else:
            clock.read(asked, answered, int(true))
        assert clock.last.tick == int(true)
        now = answered


def test_the_line_finds_the_rate_and_the_bounds_close_in() -> None:
    clock, rate = BoardClock(FREQUENCY), FREQUENCY * (1 + 150e-6)
    for k in range(200):
        clock.read(k * 0.5, k * 0.5 + 0.002, int((k * 0.5 + 0.001) * rate))
    assert clock.rate == pytest.approx(rate, rel=2e-6)
    assert clock.upper(100.2) - clock.lower(100.2) < 0.003 * FREQUENCY


def test_another_clock_is_told() -> None:
    for tick in (100, 3 * FREQUENCY):
        clock = BoardClock(FREQUENCY)
        clock.read(0.0, 0.001, 2**35)
        with pytest.raises(ClockError):
            clock.read(1.0, 1.001, tick)
    clock = BoardClock(FREQUENCY)
    clock.read(0.0, 0.001, 0)
    with pytest.raises(ClockError):
        clock.read(10.0, 10.001, int(10 * FREQUENCY * 1.05))
    assert clock.stale(100.0)
    assert not clock.stale(60.0)
