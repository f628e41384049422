"""What all modelled boards hold: pins are the stream, nothing is counted that no pin showed."""

from __future__ import annotations

import tempfile
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from backend.boards.models.waveform import Waveform, read, steps, turns
from backend.streams import events_of, merged, runs_of, sections, steps_of
from hypothesis import given
from hypothesis import strategies as st
from support.campaigns import examples

from gproof.backend.boards.board import BoardState, Capabilities
from gproof.backend.boards.models import pin_kernels as pk
from gproof.backend.boards.models.apci import ApciSpooler
from gproof.backend.boards.models.model import ModelBoard
from gproof.backend.boards.models.pci7200 import Pci7200
from gproof.backend.boards.models.pins import PinNames, Pins
from gproof.backend.boards.models.segment_cpu import SegmentCpu
from gproof.backend.boards.models.vcd import time_unit
from gproof.ir.stream import StreamSection

FREQUENCY = 16_000_000
PULSE, SETUP, LEAST = 32, 80, 112


def is_(motors: int, **more) -> Capabilities:
    usual = {"tick_frequency": FREQUENCY, "fifo_runs": 1024, "step_pulse": PULSE, "direction_setup": SETUP}
    return Capabilities(name="model", motors=motors, **{**usual, "min_interval": LEAST, "real_time": False, **more})


def pci(motors: int, **more) -> Pci7200:
    return Pci7200(is_(motors), **more)


def cpu(motors: int, **more) -> SegmentCpu:
    return SegmentCpu(is_(motors), **{"segment": 80_000, "places": 50, **more})


def apci(motors: int, **more) -> ApciSpooler:
    return ApciSpooler(is_(motors), **more)


MAKERS = {"pci7200": pci, "cpu": cpu, "apci": apci}


def load(board: ModelBoard, section: StreamSection, lead: int = 400) -> int:
    """Everything of a section at once."""
    base = board.start_section(section.number, section.start, lead)
    for motor, runs in enumerate(section.runs):
        board.queue_runs(motor, runs)
    for tick, row, op, arg in section.events.rows():
        board.queue_event(tick, row, op, tuple(arg))
    board.finish_section(section.duration)
    return base


def seen(board: ModelBoard, wave: Waveform) -> list[list[tuple[int, int]]]:
    """Steps by motor, as drives see them."""
    names = board.pins.names
    found = []
    for step, way in zip(names.step, names.direction, strict=True):
        active, forward = int(step not in names.low), int(way not in names.low)
        found.append(steps(wave, step, way, active=active, forward=forward))
    return found


def due(section: StreamSection, base: int, grid: int, until: int = 2**62) -> list[list[tuple[int, int]]]:
    """What the stream says, at counts of the timer."""
    return [
        [(-(-(base + tick) // grid) * grid, way) for tick, way in steps_of(runs) if base + tick <= until]
        for runs in section.runs
    ]


def widths(wave: Waveform, board: ModelBoard) -> set[int]:
    """Lengths of all pulses."""
    found = set()
    for step in board.pins.names.step:
        active = int(step not in board.pins.names.low)
        on, off = wave.edges(step, active), wave.edges(step, 1 - active)
        found |= {b - a for a, b in zip(on, off, strict=True)}
    return found


@pytest.mark.parametrize("name", MAKERS)
@examples(12, 2000)
@given(section=sections(least=LEAST, most=6000), pauses=st.lists(st.integers(1, 9000), max_size=8))
def test_pins_are_the_stream(name: str, section: StreamSection, pauses: list[int]) -> None:
    with tempfile.TemporaryDirectory() as folder:
        board = MAKERS[name](len(section.runs))
        board.record_vcd(Path(folder) / "pins.vcd")
        board.open()
        base = load(board, section)
        for pause in pauses:
            board.wait(board.status().tick + pause)
        board.wait(base + section.duration)
        status = board.status()
        board.close()
        wave = read(Path(folder) / "pins.vcd", FREQUENCY)
    assert status.state is BoardState.IDLE, status.reason
    assert status.position == section.end()
    assert sum(status.steps) == len(merged(section)) == sum(board.pins.steps)
    grid = board.pins.form.grid
    assert seen(board, wave) == due(section, base, grid)
    assert widths(wave, board) <= {PULSE}
    for step, way in zip(board.pins.names.step, board.pins.names.direction, strict=True):
        rises = wave.edges(step, int(step not in board.pins.names.low))
        for turn, _ in wave.changes[way]:
            after = min((tick for tick in rises if tick > turn), default=turn + SETUP)
            assert after - turn >= SETUP - grid, "the direction is set in time"


@pytest.mark.parametrize("name", MAKERS)
@examples(12, 2000)
@given(section=sections(least=LEAST, most=6000), tick=st.integers(0, 60_000))
def test_a_stop_leaves_the_steps_that_the_pins_had(name: str, section: StreamSection, tick: int) -> None:
    with tempfile.TemporaryDirectory() as folder:
        board = MAKERS[name](len(section.runs))
        board.record_vcd(Path(folder) / "pins.vcd")
        board.open()
        base = load(board, section)
        board.wait(base + tick)
        board.emergency_stop()
        status = board.status()
        board.wait(base + tick + 10_000)
        board.close()
        wave = read(Path(folder) / "pins.vcd", FREQUENCY)
    stopped = status.stopped_at if status.stopped_at is not None else base + section.duration
    grid = board.pins.form.grid
    assert seen(board, wave) == due(section, base, grid, stopped)
    assert 0 <= stopped - (base + tick) < grid or tick >= section.duration
    assert widths(wave, board) <= {PULSE}
    for m, found in enumerate(seen(board, wave)):
        assert status.position[m] == section.start[m] + sum(way for _, way in found)
        assert status.steps[m] == len(found)


@examples(12, 2000)
@given(section=sections(least=LEAST, most=6000), pauses=st.lists(st.integers(1, 9000), max_size=8))
def test_quadrature_is_the_stream(section: StreamSection, pauses: list[int]) -> None:
    with tempfile.TemporaryDirectory() as folder:
        board = pci(len(section.runs), quadrature=True)
        board.record_vcd(Path(folder) / "pins.vcd")
        board.open()
        base = load(board, section)
        for pause in pauses:
            board.wait(board.status().tick + pause)
        board.wait(base + section.duration)
        board.close()
        wave = read(Path(folder) / "pins.vcd", FREQUENCY)
    for m, motor in enumerate(due(section, base, 4)):
        assert turns(wave, f"P0S{m}", f"P0D{m}") == motor


@examples(20, 1000)
@given(sections(motors=2, least=LEAST), st.lists(st.integers(1, 9000), min_size=1, max_size=6), st.booleans())
def test_the_kernel_is_the_same_in_both_speeds(section: StreamSection, pauses: list[int], quadrature: bool) -> None:
    rings = np.zeros((2, 16, 4), dtype=np.int64)
    form = pk.Form(PULSE, SETUP, 4, int(quadrature))
    pins = Pins(PinNames(step=("A", "B"), direction=("C", "D")), form)
    for m, runs in enumerate(section.runs):
        for k, row in enumerate(runs.rows()):
            rings[m, (k + 11) % 16] = row
        pins.motors[m, pk.HEAD], pins.motors[m, pk.SIZE] = 11, len(runs)
    slow, fast, now = pins.motors.copy(), pins.motors.copy(), 0
    rooms = [pk.Edges(*(np.zeros(50, dtype=np.int64) for _ in range(3))) for _ in range(2)]
    for pause in pauses:
        now += pause
        counts = [
            pk.edges.python(rings, slow, now, 0, form, rooms[0]),
            pk.edges.compiled()(rings, fast, now, 0, form, rooms[1]),
        ]
        assert counts[0] == counts[1]
        assert np.array_equal(slow, fast)
        assert all(np.array_equal(a[: counts[0]], b[: counts[0]]) for a, b in zip(*rooms, strict=True))


@pytest.mark.parametrize("name", MAKERS)
def test_steps_that_the_board_cannot_make_are_refused(name: str) -> None:
    board = MAKERS[name](1)
    board.open()
    board.start_section(0, (0,), 400)
    board.queue_runs(0, runs_of([(10, 1, 0, 1), (LEAST, 2, 0, 1), (LEAST - 1, 1, 0, 1)]))
    assert board.status().state is BoardState.FAULT
    assert f"{LEAST - 1} ticks apart" in board.status().reason
    board.open()
    board.start_section(0, (0,), 400)
    board.queue_runs(0, runs_of([(10, 1, 0, 1), (LEAST, 2, 0, 1)]))  # the first from the section's start
    assert board.status().state is BoardState.RUNNING


@pytest.mark.parametrize(
    ("frequency", "unit", "ticks"),
    [(16_000_000, "100 ps", 625), (1_000_000, "1 us", 1), (4_000_000, "10 ns", 25), (20, "10 ms", 5)],
)
def test_a_tick_is_whole_in_the_unit_of_the_dump(frequency: int, unit: str, ticks: int) -> None:
    assert time_unit(frequency) == (unit, Fraction(ticks))


def test_a_clock_that_no_unit_fits_is_read_back_too(tmp_path: Path) -> None:
    # A third of 10 MHz: 300 ns, and 3 MHz: 333.3 ns.
    board = Pci7200(is_(1, tick_frequency=3_000_000, step_pulse=3, direction_setup=3, min_interval=6))
    board.record_vcd(tmp_path / "pins.vcd")
    board.open()
    section = StreamSection(
        number=0, start=(0,), runs=(runs_of([(1000, 500, 1, 1)]),), events=events_of([]), duration=700_000
    )
    base = load(board, section)
    board.wait(base + section.duration)
    board.close()
    assert seen(board, read(tmp_path / "pins.vcd", 3_000_000)) == due(section, base, 1)
