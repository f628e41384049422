"""The virtual board against a reference that gives one pulse at a time."""

from itertools import pairwise

import numpy as np
import pytest
from backend.streams import FREQUENCY, events_of, merged, runs_of, sections, steps_of
from hypothesis import given
from hypothesis import strategies as st

from gproof.backend.boards import run_kernels as rk
from gproof.backend.boards import simulated
from gproof.backend.boards.board import BoardError, BoardState
from gproof.backend.boards.virtual import HostDelay, VirtualBoard
from gproof.ir.machine import Board as BoardData
from gproof.ir.machine import Machine
from gproof.ir.stream import StreamSection


def load(board: VirtualBoard, section: StreamSection, lead: int = 5) -> int:
    """Everything of a section at once."""
    base = board.start_section(section.number, section.start, lead)
    for motor, runs in enumerate(section.runs):
        board.queue_runs(motor, runs)
    for tick, row, op, arg in section.events.rows():
        board.queue_event(tick, row, op, tuple(arg))
    board.finish_section(section.duration)
    return base


def reference(section: StreamSection, tick: int) -> tuple[int, ...]:
    return tuple(
        start + sum(d for t, d in steps_of(runs) if t <= tick)
        for start, runs in zip(section.start, section.runs, strict=True)
    )


@given(sections(), st.lists(st.integers(1, 5000), max_size=20))
def test_positions_are_exact_at_every_tick_asked(section: StreamSection, pauses: list[int]) -> None:
    board = VirtualBoard(len(section.runs), tick_frequency=FREQUENCY)
    board.open()
    base = load(board, section)
    for pause in pauses:
        board.wait(board.status().tick + pause)
        status = board.status()
        assert status.position == reference(section, status.tick - base)
    board.wait(base + section.duration)
    status = board.status()
    assert status.state is BoardState.IDLE
    assert status.position == section.end()
    assert sum(status.steps) == len(merged(section))
    assert status.accepted == tuple(len(r) for r in section.runs)
    assert status.free == 1024
    done = [(e.tick - base, e.row) for e in board.take_events()]
    assert done == [(t, r) for t, r, _, _ in section.events.rows()]


@given(sections(), st.integers(0, 40_000))
def test_emergency_stop_leaves_exactly_the_steps_due(section: StreamSection, tick: int) -> None:
    board = VirtualBoard(len(section.runs), tick_frequency=FREQUENCY)
    board.open()
    base = load(board, section)
    board.wait(base + tick)
    board.emergency_stop()
    board.wait(base + section.duration + 10)
    board.queue(0, 10, 1, 0, 1)
    status = board.status()
    assert status.position == reference(section, tick)
    if tick < section.duration:
        assert status.state is BoardState.STOPPED
        assert status.stopped_at == base + tick
        assert status.accepted == tuple(len(r) for r in section.runs)


@given(sections(most=300), st.integers(1, 60), st.integers(0, 120))
def test_pulses_are_measured_exactly(section: StreamSection, pulse: int, setup: int) -> None:
    board = VirtualBoard(len(section.runs), tick_frequency=FREQUENCY, step_pulse=pulse, direction_setup=setup)
    board.open()
    base = load(board, section)
    board.wait(base + section.duration // 3)
    board.wait(base + section.duration)
    seen = board.observed()
    for m, runs in enumerate(section.runs):
        steps = steps_of(runs)
        gaps = [(b[0] - a[0], a[1] != b[1]) for a, b in pairwise(steps)]
        assert seen.min_interval[m] == min((g for g, _ in gaps), default=0)
        assert seen.overlaps[m] == sum(g < 2 * pulse for g, _ in gaps)
        assert seen.setups[m] == sum(turn and g < setup for g, turn in gaps)
    assert seen.clean == (not any(seen.overlaps) and not any(seen.setups))


@given(sections(motors=2), st.lists(st.integers(1, 9000), min_size=1, max_size=8))
def test_the_kernel_is_the_same_in_both_speeds(section: StreamSection, pauses: list[int]) -> None:
    rings = np.zeros((2, 16, 4), dtype=np.int64)
    state = np.zeros((2, rk.FIELDS), dtype=np.int64)
    for m, runs in enumerate(section.runs):
        for k, row in enumerate(runs.rows()):
            rings[m, (k + 11) % 16] = row
        state[m, rk.HEAD], state[m, rk.SIZE] = 11, len(runs)
    slow, fast, now = state.copy(), state.copy(), 0
    for pause in pauses:
        now += pause
        rk.advance.python(rings, slow, now, 20, 30)
        rk.advance.compiled()(rings, fast, now, 20, 30)
        assert np.array_equal(slow, fast)


def test_an_unguarded_board_notices_an_underrun_when_the_late_run_arrives() -> None:
    board = VirtualBoard(2, guarded=False)
    board.open()
    base = board.start_section(0, (0, 0), 0)
    board.queue(0, 10, 10, 0, 1)
    board.queue(1, 10, 50, 0, 1)
    board.wait(base + 105)
    assert board.status().position == (10, 10)
    board.queue(0, 10, 10, 0, 1)  # due at 110: in time
    board.wait(base + 300)
    board.queue(0, 10, 10, 0, 1)  # due at 210: late
    status = board.status()
    assert status.state is BoardState.UNDERRUN
    assert status.stopped_at == base + 300
    assert status.position == (20, 30)
    assert "210" in status.reason
    board.wait(base + 900)
    assert board.status().position == (20, 30)


def test_a_guarded_board_stops_all_motors_together_at_the_promise() -> None:
    board = VirtualBoard(2)
    board.open()
    base = board.start_section(0, (0, 0), 0)
    board.queue(0, 10, 10, 0, 1)
    board.queue(1, 10, 50, 0, 1)
    board.commit(109)
    board.wait(base + 300)
    status = board.status()
    assert status.state is BoardState.UNDERRUN
    assert status.stopped_at == base + 109
    assert status.position == (10, 10)
    assert status.tick == base + 300


def test_a_late_host_is_late() -> None:
    board = VirtualBoard(1, delay=HostDelay(latency=7, hiccup=100, every=2))
    board.open()
    board.wait(10)
    assert board.status().tick == 17
    board.wait(20)
    assert board.status().tick == 127


def test_the_host_breaking_the_protocol_is_a_fault() -> None:
    board = VirtualBoard(1, fifo_runs=3)
    with pytest.raises(BoardError):
        board.queue(0, 1, 1, 0, 1)
    board.open()
    with pytest.raises(BoardError):
        board.queue(0, 1, 1, 0, 1)
    board.start_section(0, (4,), 0)
    board.queue_runs(0, runs_of([(5, 1, 0, 1)] * 4))
    assert board.status().state is BoardState.FAULT
    assert "overflow" in board.status().reason
    for bad in [(0, 1, 0, 1), (5, 3, -3, 1), (5, 0, 0, 1), (5, 1, 0, 2), (2**60, 2**60, 0, 1)]:
        board.open()
        board.start_section(0, (4,), 0)
        board.queue(0, *bad)
        assert board.status().state is BoardState.FAULT, bad
        assert board.status().position == (4,)


def test_a_section_must_start_where_the_board_is() -> None:
    board = VirtualBoard(1)
    board.open()
    section = StreamSection(number=0, start=(3,), runs=(runs_of([(5, 2, 0, 1)]),), events=events_of([]), duration=20)
    base = load(board, section)
    with pytest.raises(BoardError, match="running"):
        board.start_section(1, (5,), 0)
    board.wait(base + 20)
    with pytest.raises(BoardError, match="starts at"):
        board.start_section(1, (3,), 0)
    board.start_section(1, (5,), 0)
    other = VirtualBoard(2)
    other.open()
    with pytest.raises(BoardError, match="positions"):
        other.start_section(0, (1,), 0)


class Clock:
    """The clock that the board sees; it stands still but for sleep."""

    now = 1000.0

    def monotonic(self) -> float:
        return self.now

    def sleep(self, seconds: float) -> None:
        self.now += seconds


def test_real_time_follows_the_clock(monkeypatch: pytest.MonkeyPatch) -> None:
    clock = Clock()
    monkeypatch.setattr(simulated, "time", clock)
    board = VirtualBoard(1, tick_frequency=FREQUENCY, real_time=True, speed=2.0)
    board.open()
    base = board.start_section(0, (0,), 1_000_000)
    board.queue(0, 1000, 200, 0, 1)
    board.finish_section(200_000)
    board.wait(base + 200_000)
    assert clock.now - 1000.0 == pytest.approx(1_200_000 / FREQUENCY / 2.0)
    assert board.status().position == (200,)


def test_a_board_is_made_from_the_machine_file() -> None:
    machine = Machine(name="m", axes=(), board=BoardData(tick_frequency=1000, step_pulse=0.0025, direction_setup=0.004))
    is_ = VirtualBoard.for_machine(machine, 3).open()
    assert (is_.motors, is_.tick_frequency, is_.step_pulse, is_.direction_setup) == (3, 1000, 3, 4)
    with pytest.raises(ValueError, match="needs motors"):
        VirtualBoard(0)
