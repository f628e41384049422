"""The APCI-8001 by hand: limits, emergency input, contours, lag error; 16 MHz, 16,000 steps a second."""

from __future__ import annotations

from pathlib import Path

import pytest
from backend.boards.models.waveform import read
from backend.streams import machine as machine_of
from backend.streams import runs_of

from gproof.backend.boards.board import BoardError, BoardState, Capabilities, Known
from gproof.backend.boards.models.apci import ApciSpooler
from gproof.ir.trace import Op

FAR = [(1000, 10_000, 0, 1)]


def made(motors: int = 1, **more) -> ApciSpooler:
    is_ = Capabilities(
        name="apci", motors=motors, tick_frequency=16_000_000, fifo_runs=64, step_pulse=32, direction_setup=80,
        min_interval=128, real_time=False,
    )  # fmt: skip
    return ApciSpooler(is_, **more)


def started(board: ApciSpooler, *rows: list[tuple[int, int, int, int]], start: int = 0) -> int:
    board.open()
    base = board.start_section(0, (start,) * len(rows), 0)
    for motor, runs in enumerate(rows):
        if runs:
            board.queue_runs(motor, runs_of(runs))
    return base


def test_the_first_step_past_a_limit_is_not_made() -> None:
    board = made(2, limits=[(None, 500), (-20, None)])
    base = started(board, FAR, [(7000, 1000, 0, 1)])
    board.finish_section(20_000_000)
    board.wait(base + 20_000_000)
    status = board.status()
    assert (status.state, status.stopped_at) == (BoardState.FAULT, base + 501_000 - 1)
    assert status.position == (500, 71)
    assert "axis 1 right (error 8)" in status.reason
    # A run that comes later, and goes the other way.
    board = made(limits=[(-20, 500)])
    base = started(board, [(1000, 100, 0, 1)])
    board.queue_runs(0, runs_of([(2000, 100, 10, -1), (500, 1000, 0, -1)]))
    board.finish_section(20_000_000)
    board.wait(base + 20_000_000)
    # 100 · 1000, then 100 · 2000 + 10 · 4950, then 21 · 500.
    assert board.status().stopped_at == base + 100_000 + 249_500 + 10_500 - 1
    assert board.status().position == (-20,)
    assert "axis 1 left (error 8)" in board.status().reason


def test_limits_hold_once_referenced_and_let_a_motor_come_back() -> None:
    board = made(limits=[(-20, 500)], referenced=False)
    base = started(board, FAR)
    board.finish_section(11_000_000)
    board.trigger("limit", base + 100)
    board.wait(base + 11_000_000)
    assert (board.status().state, board.status().position) == (BoardState.IDLE, (10_000,))
    board = made(limits=[(-20, 500)])
    base = started(board, [(1000, 100, 0, -1)], start=550)
    board.finish_section(200_000)
    board.wait(base + 200_000)
    assert (board.status().state, board.status().position) == (BoardState.IDLE, (450,))
    board = made(limits=[(-20, 500)])
    base = started(board, [(1000, 100, 0, -1), (1000, 100, 0, 1)], start=550)
    board.finish_section(300_000)
    board.wait(base + 300_000)
    assert (board.status().position, board.status().stopped_at) == ((500,), base + 151_000 - 1)


def test_a_hardware_limit_switch_ends_the_program() -> None:
    board = made()
    base = started(board, FAR)
    board.finish_section(11_000_000)
    board.trigger("limit", base + 123_456)
    board.wait(base + 11_000_000)
    assert (board.status().state, board.status().stopped_at) == (BoardState.FAULT, base + 123_456)
    assert "error 4" in board.status().reason


def test_the_emergency_input_keeps_the_program_from_starting_again() -> None:
    board = made()
    base = started(board, FAR)
    board.finish_section(11_000_000)
    board.trigger("eo", base + 500_000)
    board.wait(base + 600_000)
    status = board.status()
    assert (status.state, status.position, status.known) == (BoardState.STOPPED, (500,), Known.UNKNOWN)
    board.open()
    with pytest.raises(BoardError, match="emergency input is active"):
        board.start_section(1, (500,), 0)
    board.release_eo()
    # Referenced anew: the host tells it where the motor is.
    board.start_section(1, (0,), 0)
    still = made()
    base = started(still, [])
    still.commit(None)
    still.wait(base + 1000)
    still.emergency_stop()
    assert (still.status().known, still.status().state) == (Known.EXACT, BoardState.STOPPED)


def test_a_command_that_is_not_spooled_needs_a_rest() -> None:
    # At 160,000 steps/s² two steps around a standstill are at least √(2 / 160,000) s = 56,569 ticks apart.
    for rest, state in ((60_000, BoardState.IDLE), (1000, BoardState.FAULT)):
        board = made(accelerations=[160_000.0])
        base = started(board, [(1000, 100, 0, 1), (rest, 1, 0, 1), (1000, 100, 0, 1)])
        board.queue_event(100_500, 7, int(Op.SPINDLE), (1000, 9_000_000))
        board.finish_section(400_000)
        board.wait(base + 400_000)
        status = board.status()
        assert status.state is state, status.reason
        if state is BoardState.FAULT:
            assert (status.position, status.known) == ((100,), Known.UNKNOWN)
            assert "row 7 ends the contour while axis 1 moves" in status.reason
            assert board.take_events() == []
        else:
            assert (board.contours, status.position) == (2, (201,))


def test_an_output_is_spooled(tmp_path: Path) -> None:
    board = made(2, accelerations=[160_000.0, 160_000.0])
    board.record_vcd(tmp_path / "a.vcd")
    base = started(board, FAR, [])
    for tick, output, on in ((100_500, 203, 1), (200_500, 203, 0), (300_000, 100, 1)):
        board.queue_event(tick, 0, int(Op.OUTPUT), (output * 1000, on * 1000))
    board.finish_section(10_000_000)
    board.wait(base + 10_000_000)
    assert (board.status().state, board.contours) == (BoardState.IDLE, 1)
    board.close()
    wave = read(tmp_path / "a.vcd", 16_000_000)
    assert wave.changes["O203"] == [(base + 100_500, 1), (base + 200_500, 0)]
    assert not any(wave.changes[f"O1{n:02}"] for n in range(1, 9))


@pytest.mark.parametrize("at", [0, 100_500])
def test_a_motor_that_does_not_follow_is_a_lag_error(at: int) -> None:
    board = made(most_lag=[50])
    base = started(board, FAR)
    board.finish_section(11_000_000)
    board.block(0, base + at)
    board.wait(base + 120_000)
    assert board.status().state is BoardState.RUNNING or at == 0
    board.wait(base + 11_000_000)
    status = board.status()
    # 50 steps of lag are allowed; with the 51st it ends.
    assert (status.state, status.stopped_at) == (BoardState.FAULT, base + (at // 1000 + 51) * 1000)
    assert "lag error, axis 1 (error 2)" in status.reason
    assert status.known is Known.UNKNOWN


def test_a_board_of_a_machine_file() -> None:
    board = ApciSpooler.for_machine(machine_of("xy"), 2)
    # ±1000 mm at 200 steps/mm, and a step for rounding.
    assert board.limits == ((-200_001, 200_001), (-200_001, 200_001))
    assert board.accelerations == (120_000.0, 120_000.0)
    assert ApciSpooler.for_machine(machine_of("xy"), 3).limits == ((None, None),) * 3
