"""The PCI-7200 by hand: 16 MHz ticks, a timer of 4 MHz (4 ticks a count), 5 µs (80 ticks) of pulse and set-up."""

from __future__ import annotations

import itertools
from pathlib import Path

import pytest
from backend.boards.models.waveform import Waveform, read, steps
from backend.streams import runs_of

from gproof.backend.boards.board import BoardError, BoardState, Capabilities, Known
from gproof.backend.boards.models.pci7200 import AxisSpec, Pci7200
from gproof.ir.machine import Axis, AxisKind, Board, Controller, Machine
from gproof.ir.trace import Op

FREQUENCY = 16_000_000
IS = Capabilities(
    name="pci7200", motors=2, tick_frequency=FREQUENCY, fifo_runs=64, step_pulse=80, direction_setup=80,
    min_interval=160, real_time=False,
)  # fmt: skip


def ran(board: Pci7200, path: Path, rows: list[list[tuple[int, int, int, int]]], duration: int) -> tuple[int, Waveform]:
    """A section of these runs from base on: the base, and the pins."""
    board.record_vcd(path)
    board.open()
    base = board.start_section(0, (0,) * len(rows), 400)
    for motor, runs in enumerate(rows):
        board.queue_runs(motor, runs_of(runs))
    board.finish_section(duration)
    board.wait(base + duration)
    board.close()
    return base, read(path, FREQUENCY)


def test_pulse_and_set_up(tmp_path: Path) -> None:
    # Steps at 1001 and 1801: counts of the timer at 1004 and 1804. E0: a step is a falling edge. O1: up is high.
    base, wave = ran(Pci7200(IS), tmp_path / "a.vcd", [[(1001, 1, 0, 1), (800, 1, 0, -1)], [(1002, 1, 0, -1)]], 3000)
    assert base == 400
    assert (wave.first["P0S0"], wave.first["P0D0"], wave.first["P0S1"]) == (1, 0, 1)
    assert wave.changes["P0D0"] == [(base + 924, 1), (base + 1724, 0)]
    assert wave.changes["P0S0"] == [(base + 1004, 0), (base + 1084, 1), (base + 1804, 0), (base + 1884, 1)]
    # In the same image as the first motor's; it counts down, and its direction pin is low from the start.
    assert wave.changes["P0S1"] == [(base + 1004, 0), (base + 1084, 1)]
    assert wave.changes["P0D1"] == []


def test_bits_and_levels_of_axisspec(tmp_path: Path) -> None:
    specs = [AxisSpec(step=4, direction=2, forward=0, rising=True), AxisSpec(step=0, direction=5)]
    base, wave = ran(Pci7200(IS, specs), tmp_path / "a.vcd", [[(1000, 1, 0, 1)], [(2000, 1, 0, 1)]], 3000)
    assert wave.changes["P0D2"] == [(base + 920, 0)]
    assert wave.changes["P0S4"] == [(base + 1000, 1), (base + 1080, 0)]
    assert wave.changes["P0D5"] == [(base + 1920, 1)]
    assert wave.changes["P0S0"] == [(base + 2000, 0), (base + 2080, 1)]


@pytest.mark.parametrize("specs", [[(6, 0), (1, 1)], [(0, 0), (0, 1)], [(0, 3), (1, 3)]])
def test_bits_that_the_port_does_not_have(specs: list[tuple[int, int]]) -> None:
    with pytest.raises(BoardError, match="port 0 has one of each"):
        Pci7200(IS, [AxisSpec(step=s, direction=d) for s, d in specs])
    with pytest.raises(BoardError, match="6 step outputs"):
        Pci7200(
            Capabilities(name="p", motors=7, tick_frequency=FREQUENCY, fifo_runs=64, step_pulse=1, direction_setup=1)
        )


def test_quadrature(tmp_path: Path) -> None:
    # Up: A, B, A, B change, A first. Down: B again, then A.
    base, wave = ran(Pci7200(IS, quadrature=True), tmp_path / "a.vcd", [[(1000, 5, 0, 1), (1000, 2, 0, -1)], []], 9000)
    assert wave.changes["P0S0"] == [(base + 1000, 1), (base + 3000, 0), (base + 5000, 1), (base + 6000, 0)]
    assert wave.changes["P0D0"] == [(base + 2000, 1), (base + 4000, 0), (base + 7000, 1)]


def test_an_output_of_auxout(tmp_path: Path) -> None:
    board = Pci7200(IS)
    board.record_vcd(tmp_path / "a.vcd")
    board.open()
    base = board.start_section(0, (0, 0), 400)
    for tick, channel, on in ((1001, 3, 1), (2000, 40, 1), (3000, 3, 0)):
        board.queue_event(tick, 0, int(Op.OUTPUT), (channel * 1000, on * 1000))
    board.finish_section(4000)
    board.wait(base + 4000)
    board.close()
    wave = read(tmp_path / "a.vcd", FREQUENCY)
    assert wave.changes["AUX3"] == [(base + 1004, 1), (base + 3000, 0)]
    assert len(board.take_events()) == 3
    assert not any(wave.changes[f"AUX{n}"] for n in range(1, 33) if n != 3)


@pytest.mark.parametrize("how", ["stop", "esc", "limit"])
def test_a_stop_runs_on_for_its_cushion(how: str, tmp_path: Path) -> None:
    # 10,000 steps/s (1,600 ticks) of one motor, half of that of the other: 200 more steps are 100 of the other.
    board = Pci7200(IS, esc_step=200, lim_step=200)
    board.record_vcd(tmp_path / "a.vcd")
    board.open()
    base = board.start_section(0, (0, 0), 400)
    board.queue_runs(0, runs_of([(1600, 5000, 0, 1)]))
    board.queue_runs(1, runs_of([(3200, 2500, 0, -1)]))
    board.finish_section(1600 * 5001)
    if how != "stop":
        board.trigger(how, base + 1_600_000)
    board.wait(base + 1_600_000)
    if how == "stop":
        board.emergency_stop()
    status = board.status()
    board.close()
    assert status.state is (BoardState.FAULT if how == "limit" else BoardState.STOPPED)
    assert status.position == (1000 + 200, -500 - 100)
    assert status.known is Known.EXACT
    assert status.stopped_at == base + 1_600_000 + 320_000
    # From full speed to rest: twice as long as at full speed.
    assert board.at_rest == base + 1_600_000 + 640_000
    wave = read(tmp_path / "a.vcd", FREQUENCY)
    first = [tick - base - 1_600_000 for tick, _ in steps(wave, "P0S0", "P0D0", active=0)][1000:]
    assert len(first) == 200
    # After t of T the path has come to t - t²/2T: its middle, 160,000, at 640,000 · (1 - √½).
    assert first[99] == pytest.approx(187_452, abs=4)
    assert 640_000 - 4 <= first[-1] <= 640_000
    gaps = [b - a for a, b in itertools.pairwise(first)]
    assert all(b >= a - 8 for a, b in itertools.pairwise(gaps))
    assert [way for _, way in steps(wave, "P0S1", "P0D1", active=0)] == [-1] * 600


def test_a_cushion_is_no_longer_than_the_path_that_is_known() -> None:
    board = Pci7200(IS, esc_step=200)
    board.open()
    base = board.start_section(0, (0, 0), 400)
    board.queue_runs(0, runs_of([(1600, 1050, 0, 1)]))
    board.commit(1600 * 1050)
    board.wait(base + 1_600_000)
    board.emergency_stop()
    assert board.status().position == (1050, 0)
    calm = Pci7200(IS)
    calm.open()
    base = calm.start_section(0, (0, 0), 400)
    calm.queue_runs(0, runs_of([(1600, 1050, 0, 1)]))
    calm.commit(1600 * 1050)
    calm.wait(base + 1_600_000)
    calm.emergency_stop()
    assert calm.status().position == (1000, 0)


def test_a_board_of_a_machine_file() -> None:
    axes = (Axis(name="x", kind=AxisKind.LINEAR),)
    machine = Machine(
        name="m", axes=axes, board=Board(step_pulse=5e-6, direction_setup=5e-6),
        controller=Controller(max_step_frequency=75_000.0),
        kept=(("esc_step", "200"), ("lim_step=", "100"), ("quadmode", "1"), ("pwm", "F75")),
    )  # fmt: skip
    board = Pci7200.for_machine(machine, 1)
    found = board.open()
    assert (board.esc_step, board.lim_step, board.pins.form.quadrature) == (200, 100, 1)
    # 16,000,000 / 75,000 = 213.3: one tick less than 214, as rounded steps may be.
    assert (found.step_pulse, found.direction_setup, found.min_interval) == (80, 80, 213)
