"""Whole jobs by the runtime on modelled boards: the pins are the job, records are those of the job."""

from __future__ import annotations

import os
import time
from pathlib import Path

import pytest
from backend.boards.models.waveform import read
from backend.jobs import job
from backend.streams import FREQUENCY, steps_of
from corpus.jobs import all_jobs, compiled
from support.campaigns import SOAK

from gproof.backend import runtime
from gproof.backend.boards.models.model import ModelBoard
from gproof.backend.boards.registry import BOARDS
from gproof.backend.job import CertifiedJob, RunRefused
from gproof.backend.record import ExecutionRecord, Result, problems
from gproof.backend.runtime import Hold
from gproof.ir.machine import Board as BoardData
from gproof.ir.trace import Wait

MODELS = ("pci7200", "eding-cpu", "apci8001")
OF_DIALECT = {"eding": "eding-cpu", "wincnc": "pci7200", "mcuwin": "apci8001"}
SAMPLE = ("eding/nested-parts", "mcuwin/engraver/one-axis-first", "wincnc/knife-twohead/coupled-heads")
PATHS = [(0.0, 0.0), (4.0, 2.0), (4.0, -3.0), (0.0, 0.0)]


def model(what: CertifiedJob, name: str) -> ModelBoard:
    board = BOARDS[name](what.machine, len(what.stream.motors), False)
    assert isinstance(board, ModelBoard)
    return board


def made_by_pins(board: ModelBoard, path: Path, frequency: int) -> list[list[int]]:
    """Directions of the steps that drives saw, by motor."""
    wave, names, found = read(path, frequency), board.pins.names, []
    for step, way in zip(names.step, names.direction, strict=True):
        forward, facing = int(way not in names.low), wave.first[way]
        merged = [(tick, 1, to) for tick, to in wave.changes[step] if to == int(step not in names.low)]
        merged += [(tick, 0, to) for tick, to in wave.changes[way]]
        ways: list[int] = []
        for _, is_step, level in sorted(merged):
            if is_step:
                ways.append(1 if facing == forward else -1)
            else:
                facing = level
        found.append(ways)
    return found


def in_the_record(what: CertifiedJob, record: ExecutionRecord) -> list[list[int]]:
    """Directions of the steps that the stream has in the sections of a record, as far as they were made."""
    found: list[list[int]] = [[] for _ in what.stream.motors]
    for done in record.sections:
        for m, runs in enumerate(what.stream.sections[done.number].runs):
            found[m] += [way for _, way in steps_of(runs)][: done.steps[m]]
    return found


@pytest.mark.parametrize("name", MODELS)
def test_holds_overrides_and_stops(name: str, tmp_path: Path) -> None:
    what = job(PATHS, [(2.0, 2.0)], waits=(Wait.OPERATOR,))
    whole = None
    for number, more in enumerate(
        ({}, {"override": 0.4}, {"hold_at": Hold(at=100_000, rest=500_000)}, {"estop_at": 150_000}, {"estop_at": 2000})
    ):
        board, path = model(what, name), tmp_path / f"{number}.vcd"
        board.record_vcd(path)
        record = runtime.walk(what, board, **more)
        assert list(problems(record, what)) == [], more
        assert made_by_pins(board, path, FREQUENCY) == in_the_record(what, record)
        assert record.observed.clean
        if "estop_at" in more:
            assert record.result is Result.EMERGENCY_STOP
            # In full motion only the PCI-7200 counts what it made as where the motor is.
            moving = more["estop_at"] == 150_000
            assert (record.position is None) == (moving and name != "pci7200")
        else:
            assert record.result is Result.COMPLETED
            whole = whole or record.position
            assert record.position == whole


def test_a_job_that_the_board_is_too_slow_for_is_refused_before_it_moves(tmp_path: Path) -> None:
    what = job([(1.0, 1.0)])
    slow = BoardData(tick_frequency=FREQUENCY, step_pulse=200e-6, direction_setup=5e-6)
    object.__setattr__(what.machine, "board", slow)
    with pytest.raises(RunRefused) as refused:
        runtime.walk(what, model(what, "pci7200"))
    assert any("ticks apart, and the board needs 400" in finding.message for finding in refused.value.findings)


def run_of_the_corpus(name: str, path: Path) -> None:
    what = compiled(name)
    if what is None:
        return
    board = model(what, OF_DIALECT[name.split("/", maxsplit=1)[0]])
    board.record_vcd(path)
    record = runtime.walk(what, board)
    assert record.result in (Result.COMPLETED, Result.STOPPED), record.reason
    assert list(problems(record, what)) == []
    assert record.observed.clean
    assert board.pins.steps == record.steps
    if sum(record.steps) < 2_000_000:
        assert made_by_pins(board, path, what.stream.tick_frequency) == in_the_record(what, record)
    path.unlink()


@pytest.mark.parametrize("name", SAMPLE)
def test_jobs_of_the_corpus(name: str, tmp_path: Path) -> None:
    run_of_the_corpus(name, tmp_path / "pins.vcd")


@pytest.mark.soak
@pytest.mark.parametrize("name", all_jobs() if SOAK else [])
def test_all_jobs_of_the_corpus_on_models(name: str, tmp_path: Path) -> None:
    run_of_the_corpus(name, tmp_path / "pins.vcd")


@pytest.mark.soak
@pytest.mark.parametrize("recorded", [False, True])
@pytest.mark.parametrize("name", MODELS)
def test_simulated_time_is_fast(name: str, recorded: bool, tmp_path: Path) -> None:
    """At least 50 times as fast as the machine, by the time of the processor."""
    what = compiled("eding/raster-surface")
    assert what is not None
    board = model(what, name)
    if recorded:
        board.record_vcd(tmp_path / "pins.vcd")
    began, cpu = time.perf_counter(), time.process_time()
    record = runtime.walk(what, board)
    wall, cpu = time.perf_counter() - began, time.process_time() - cpu
    machine = sum(section.ticks for section in record.sections) / what.stream.tick_frequency
    size = os.path.getsize(tmp_path / "pins.vcd") / 1e6 if recorded else 0.0
    print(
        f"{name}: {machine:.0f} s in {wall:.2f} s ({cpu:.2f} s of processor, {machine / cpu:.0f} times), {size:.0f} MB"
    )
    assert machine / cpu > 50
