"""The Eding CPU by hand: 16 MHz, segments of 5 ms (80,000 ticks)."""

from __future__ import annotations

import itertools
from pathlib import Path

import pytest
from backend.boards.models.waveform import read, steps
from backend.streams import machine as machine_of
from backend.streams import runs_of

from gproof.backend.boards.board import BoardError, BoardState, Capabilities, Known
from gproof.backend.boards.models.segment_cpu import SegmentCpu
from gproof.backend.boards.simulated import HostDelay
from gproof.ir.trace import Op

FREQUENCY = 16_000_000
SEGMENT = 80_000
FAR = [(1000, 1_000_000, 0, 1)]
"""16,000 steps a second."""


def made(**more) -> SegmentCpu:
    is_ = Capabilities(
        name="cpu", motors=1, tick_frequency=FREQUENCY, fifo_runs=64, step_pulse=32, direction_setup=80,
        min_interval=128, real_time=False,
    )  # fmt: skip
    return SegmentCpu(is_, **{"segment": SEGMENT, "places": 50, **more})


def started(board: SegmentCpu, rows: list[tuple[int, int, int, int]], commit: int | None) -> int:
    board.open()
    base = board.start_section(0, (0,), 0)
    board.queue_runs(0, runs_of(rows))
    board.commit(commit)
    return base


@pytest.mark.parametrize(("promised", "whole"), [(79_999, 0), (80_000, 1), (159_999, 1), (400_000, 5)])
def test_a_segment_that_is_not_whole_is_not_made(promised: int, whole: int) -> None:
    board = made()
    base = started(board, FAR, promised)
    board.wait(base + 10 * SEGMENT)
    status = board.status()
    assert status.state is BoardState.UNDERRUN
    assert "FIFO underrun" in status.reason
    assert status.stopped_at == base + whole * SEGMENT
    assert status.position == (whole * 80,)
    # It ends at speed, unless nothing has moved yet.
    assert status.known is (Known.UNKNOWN if whole else Known.EXACT)


@pytest.mark.parametrize(("places", "held_up", "ends"), [(2, 239_900, None), (2, 239_901, 3), (50, 51, 51)])
def test_a_host_that_is_held_up_has_the_fifo(places: int, held_up: int, ends: int | None) -> None:
    # At tick 100 the first segment is being made; behind it there are as many as there are places.
    late = held_up if held_up > 1000 else held_up * SEGMENT
    board = made(places=places, delay=HostDelay(hiccup=late, every=1))
    base = started(board, FAR, 100 * SEGMENT)
    board.wait(base + 100)
    status = board.status()
    if ends is None:
        assert status.state is BoardState.RUNNING
    else:
        assert (status.state, status.stopped_at) == (BoardState.UNDERRUN, base + ends * SEGMENT)
        assert status.position == (ends * 80,)


def test_what_is_left_is_a_segment_too() -> None:
    board = made()
    base = started(board, [(1000, 85, 0, 1)], 85_000)
    board.finish_section(90_000)
    board.wait(base + 90_000)
    assert (board.status().state, board.status().position) == (BoardState.IDLE, (85,))


def test_a_rest_empties_the_fifo_and_is_no_underrun() -> None:
    board = made(places=2)
    base = started(board, [(1000, 85, 0, 1)], None)
    board.wait(base + 100 * SEGMENT)
    assert (board.status().state, board.status().position) == (BoardState.RUNNING, (85,))
    # Goes on: what it was told nothing of is not there already.
    board.queue_runs(0, runs_of([(100 * SEGMENT, 300, 0, 1)]))
    board.commit(101 * SEGMENT)
    board.wait(base + 110 * SEGMENT)
    assert board.status().stopped_at == base + 101 * SEGMENT


def test_a_quick_stop_loses_the_position_of_a_motor_that_moves() -> None:
    for tick, known in ((400_500, Known.UNKNOWN), (4_000_000, Known.EXACT)):
        board = made()
        base = started(board, [(1000, 1000, 0, 1), (8_000_000, 1, 0, 1)], None)
        board.wait(base + tick)
        board.emergency_stop()
        status = board.status()
        assert (status.state, status.known) == (BoardState.STOPPED, known)
        assert status.position == (min(1000, tick // 1000),)
    board = made()
    base = started(board, FAR, None)
    board.trigger("estop", base + 500_000)
    board.wait(base + 600_000)
    assert (board.status().stopped_at, board.status().known) == (base + 500_000, Known.UNKNOWN)
    with pytest.raises(ValueError, match="no input"):
        board.trigger("door")


def test_a_smooth_stop_slows_down_and_loses_nothing(tmp_path: Path) -> None:
    # 16,000 steps/s at 160,000 steps/s²: 0.1 s, in which the path comes 0.05 s further: 800 steps.
    board = made(accelerations=[160_000.0])
    board.record_vcd(tmp_path / "a.vcd")
    base = started(board, FAR, 10_000_000)
    at = base + 1_600_000
    board.trigger("error", at)
    board.wait(at)
    status = board.status()
    board.close()
    assert (status.state, status.known) == (BoardState.STOPPED, Known.EXACT)
    assert status.position == (1600 + 800,)
    assert (status.stopped_at, board.at_rest) == (at + 800_000, at + 1_600_000)
    found = [tick - at for tick, _ in steps(read(tmp_path / "a.vcd", FREQUENCY), "STEP1", "DIR1")][1600:]
    assert len(found) == 800
    # Half of the path, 400,000 ticks, after 1,600,000 · (1 - √½).
    assert found[399] == 468_630
    # Speed over 20 steps falls by no more than the acceleration allows.
    speeds = [(20 * FREQUENCY / (found[k + 20] - found[k]), (found[k + 20] + found[k]) / 2) for k in range(0, 760, 20)]
    for (v, t), (w, u) in itertools.pairwise(speeds):
        assert 0.9 * 160_000 < (v - w) / (u - t) * FREQUENCY < 1.1 * 160_000


@pytest.mark.parametrize(("acceleration", "commit"), [(None, 10_000_000), (160_000.0, 1_760_000)])
def test_a_smooth_stop_that_is_not_possible_is_a_quick_one(acceleration: float | None, commit: int) -> None:
    board = made(accelerations=[acceleration])
    base = started(board, FAR, commit)
    board.trigger("error", base + 1_600_000)
    board.wait(base + 1_600_000)
    status = board.status()
    assert (status.state, status.known, status.position) == (BoardState.STOPPED, Known.UNKNOWN, (1600,))


def test_outputs(tmp_path: Path) -> None:
    board = made()
    board.record_vcd(tmp_path / "a.vcd")
    board.open()
    base = board.start_section(0, (0,), 0)
    for tick, op, first, second in (
        (1000, Op.SPINDLE, 1, 9000), (2000, Op.COOLANT, 0, 1), (3000, Op.OUTPUT, 7, 1), (4000, Op.SPINDLE, -1, 9000),
        (5000, Op.COOLANT, 1, 0), (6000, Op.SPINDLE, 0, 0),
    ):  # fmt: skip
        board.queue_event(tick, 0, int(op), (first * 1000, second * 1000))
    board.finish_section(7000)
    board.wait(base + 7000)
    board.close()
    wave = read(tmp_path / "a.vcd", FREQUENCY)
    switched = {
        pin: [(t - base, to) for t, to in wave.changes[pin]] for pin in ("TOOL", "TOOL_DIR", "MIST", "FLOOD", "AUX7")
    }
    assert switched == {
        "TOOL": [(1000, 1), (6000, 0)], "TOOL_DIR": [(4000, 1), (6000, 0)], "MIST": [(5000, 1)],
        "FLOOD": [(2000, 1), (5000, 0)], "AUX7": [(3000, 1)],
    }  # fmt: skip


def test_a_cpu_of_a_machine_file() -> None:
    board = SegmentCpu.for_machine(machine_of("xy", acceleration=600.0), 2)
    found = board.open()
    # 200 steps/mm; 1 MHz: segments of 5,000 ticks, 50 of them; 100 kHz: 10 ticks, of which rounding may take one.
    assert (board.segment, board.places, board.accelerations) == (5000, 50, (120_000.0, 120_000.0))
    assert found.min_interval == 9
    with pytest.raises(BoardError, match="at least 40000 ticks"):
        made(segment=39_999)
